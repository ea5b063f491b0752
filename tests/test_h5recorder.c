/* SPDX-License-Identifier: MIT */
/* src/sink/recorder.c with all it stands on: what is written can be read, whatever happens meanwhile. */
#include "own_folder.h"

#include "h5support.h"

#include "sink/h5estimate.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <hdf5.h>
#include <limits.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

static bool exists(const char *path)
{
	struct stat found;

	return lstat(path, &found) == 0;
}

/* Unfinished files of `path`; those of others, whose processes were killed, may stay. */
static int partial_count(const char *path)
{
	char pattern[600];
	glob_t found;

	snprintf(pattern, sizeof pattern, "%s.partial-*", path);
	if (glob(pattern, GLOB_NOESCAPE, NULL, &found) != 0)
		return 0;
	const int count = (int)found.gl_pathc;
	globfree(&found);
	return count;
}

static void assert_column(const double *column, uint64_t k, int bodies, int number, int width,
                          bool single)
{
	for (size_t i = 0; i < (size_t)bodies; i++)
		for (int axis = 0; axis < width; axis++) {
			const double wanted = fake_value(k, i, number, axis);
			const double is = column[i * (size_t)width + (size_t)axis];
			if (is != (single ? (double)(float)wanted : wanted))
				fail_msg("frame %llu, body %zu, column %d, axis %d: %.17g, wanted "
				         "%.17g",
				         (unsigned long long)k, i, number, axis, is, wanted);
		}
}

/* Every frame of a recording of a fake run, to the bit. Gives their number. */
static uint64_t assert_right(const char *path, const char *status, bool single)
{
	struct rb_reader *reader;
	struct rb_error err;
	struct rb_frame frame;

	assert_ok(rb_reader_open(&reader, path, &err));
	const struct rb_reading *const reading = rb_reader_reading(reader);
	if (status)
		assert_string_equal(reading->status, status);
	for (uint64_t row = 0; row < reading->frame_count; row++) {
		assert_ok(rb_reader_frame(reader, row, &frame, &err));
		const uint64_t k = frame.index;
		assert_true(frame.time_s == (double)k / 60);
		assert_column(frame.position, k, reading->body_count, 0, 3, single);
		assert_column(frame.velocity, k, reading->body_count, 2, 3, single);
		if (reading->fields & RB_FIELD_ORIENTATION) {
			assert_column(frame.orientation, k, reading->body_count, 1, 4, single);
			assert_column(frame.angular_velocity, k, reading->body_count, 3, 3, single);
		}
		assert_true(frame.numbers.kinetic_energy == (double)k &&
		            frame.numbers.momentum.z == (double)k);
		if (reading->fields & RB_FIELD_CONTACTS) {
			assert_int_equal(frame.contact_count, k % 4);
			for (int i = 0; i < frame.contact_count; i++)
				assert_true(frame.contacts[i].a == i && frame.contacts[i].b == 7 &&
				            frame.contacts[i].force.z == (double)k &&
				            frame.contacts[i].gap == -1e-9 * i);
		}
	}
	const uint64_t count = reading->frame_count;
	rb_reader_close(reader);
	return count;
}

static void every_frame_comes_back_to_the_bit(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;
	struct rb_reader *reader;
	struct rb_frame frame;

	(void)slot;
	in_folder(path, "bits.h5");
	fake_init(&fake, 7, 5000, true);
	fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
	assert_ok(fake_record(&fake, path, &err));
	assert_int_equal(assert_right(path, "complete", false), 5000);

	assert_ok(rb_reader_open(&reader, path, &err));
	for (uint64_t k = 4990; k-- > 4000;) { /* backwards, too */
		assert_ok(rb_reader_frame(reader, k, &frame, &err));
		assert_int_equal(frame.event_count, k % 3);
		for (int i = 0; i < frame.event_count; i++)
			assert_true(frame.events[i].a == i &&
			            frame.events[i].kind ==
			                    (k + (uint64_t)i) % RB_EVENT_KIND_COUNT &&
			            frame.events[i].impulse.z == (double)k &&
			            frame.events[i].approach_speed == (double)(i + 1));
		assert_int_equal(frame.numbers.collisions, k % 3);
		assert_int_equal(frame.numbers.substeps, 4);
	}
	assert_int_equal(rb_reader_reading(reader)->event_count,
	                 4999); /* 1666 times 1 + 2, and one */
	rb_reader_close(reader);
	assert_int_equal(partial_count(path), 0);
	fake_release(&fake);
}

static void single_precision_and_compression_come_back(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	for (int compression = 0; compression <= 9; compression += 9)
		for (int single = 0; single < 2; single++) {
			in_folder(path, "packed.h5");
			unlink(path);
			fake_init(&fake, 300, 200, true);
			fake.scene.record.single_precision = single;
			fake.scene.record.compression = compression;
			assert_ok(fake_record(&fake, path, &err));
			assert_int_equal(assert_right(path, "complete", single), 200);
			fake_release(&fake);
		}
}

/* What changes little from frame to frame is packed over many frames, however many bodies there are. */
static void compressed_chunks_span_frames(void **slot)
{
	static const char *const paths[] = {"/particles/bodies/position/value",
	                                    "/particles/bodies/velocity/value"};
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	for (int bodies = 10; bodies <= 4000; bodies *= 20) {
		in_folder(path, "packed.h5");
		unlink(path);
		fake_init(&fake, bodies, 40, false);
		fake.scene.record.compression = 1;
		assert_ok(fake_record(&fake, path, &err));
		fake_release(&fake);
		const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
		for (int k = 0; k < 2; k++) {
			const hid_t dataset = H5Dopen2(file, paths[k], H5P_DEFAULT);
			const hid_t properties = H5Dget_create_plist(dataset);
			hsize_t chunk[3] = {0, 0, 0};
			assert_int_equal(H5Pget_chunk(properties, 3, chunk), 3);
			assert_in_range(chunk[0], 16, 40);
			assert_int_equal(chunk[1], bodies);
			H5Pclose(properties);
			H5Dclose(dataset);
		}
		H5Fclose(file);
	}
}

static void bodies_split_among_chunks_come_back(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	in_folder(path, "many.h5");
	fake_init(&fake, 100001, 3, false);
	assert_ok(fake_record(&fake, path, &err));
	assert_int_equal(assert_right(path, "complete", false), 3);
	unlink(path);
	fake_release(&fake);
}

static void every_third_frame_and_the_last_are_recorded_and_counts_add_up(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;
	struct rb_reader *reader;
	struct rb_frame frame;

	(void)slot;
	for (int interrupted = 0; interrupted < 2; interrupted++) {
		in_folder(path, interrupted ? "third-i.h5" : "third.h5");
		fake_init(&fake, 2, 12, true);
		fake.scene.record.every = 3;
		fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
		assert_ok(fake_open(&fake, path, false, &err));
		assert_ok(fake_push(&fake, 0, interrupted ? 9 : 12, &err));
		assert_ok(fake_close(&fake, interrupted ? RB_ERR_INTERRUPT : RB_OK, &err));
		/* 0, 3, 6 and 9, 11; or 0, 3, 6 and the last one that came, 8 */
		assert_int_equal(
			assert_right(path, interrupted ? "interrupted" : "complete", false),
			interrupted ? 4 : 5);
		assert_ok(rb_reader_open(&reader, path, &err));
		assert_ok(rb_reader_frame(reader, 1, &frame, &err));
		assert_int_equal(frame.index, 3);
		assert_int_equal(frame.numbers.substeps, 12);
		assert_int_equal(frame.numbers.collisions, 1 + 2 + 0);
		assert_int_equal(frame.event_count, 1 + 2 + 0);
		assert_true(frame.numbers.smallest_step == 0.25);
		assert_ok(rb_reader_frame(reader, interrupted ? 3 : 4, &frame, &err));
		assert_int_equal(frame.index, interrupted ? 8 : 11);
		assert_int_equal(frame.numbers.substeps, 8);
		rb_reader_close(reader);
		fake_release(&fake);
	}
}

static void a_scene_that_cannot_turn_has_one_fixed_orientation(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;
	double orientation[4 * 3];

	(void)slot;
	in_folder(path, "fixed.h5");
	fake_init(&fake, 3, 10, false);
	fake.model.features = 0;
	assert_ok(fake_record(&fake, path, &err));
	assert_int_equal(assert_right(path, "complete", false), 10);
	const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	const hid_t dataset = H5Dopen2(file, "/particles/bodies/orientation", H5P_DEFAULT);
	assert_true(dataset >= 0);
	assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
	                    orientation) >= 0);
	assert_true(orientation[0] == 1 && orientation[8] == 1 && orientation[9] == 0);
	assert_true(H5Lexists(file, "/particles/bodies/angular_velocity", H5P_DEFAULT) == 0);
	H5Dclose(dataset);
	H5Fclose(file);
	fake_release(&fake);
}

static void the_name_appears_with_the_first_frame_and_not_before(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	in_folder(path, "name.h5");
	fake_init(&fake, 3, 100, true);
	assert_ok(fake_open(&fake, path, false, &err));
	assert_false(exists(path));
	assert_int_equal(partial_count(path), 1);
	assert_ok(fake_push(&fake, 0, 1, &err));
	assert_true(exists(path));
	assert_int_equal(partial_count(path), 0);
	assert_ok(fake_close(&fake, RB_ERR_TERMINATE, &err));
	assert_int_equal(assert_right(path, "interrupted", false), 1);
	fake_release(&fake);

	/* none came: nothing is left */
	in_folder(path, "none.h5");
	fake_init(&fake, 3, 100, true);
	assert_ok(fake_open(&fake, path, false, &err));
	assert_ok(fake_close(&fake, RB_ERR_PHYSICS, &err));
	assert_false(exists(path));
	assert_int_equal(partial_count(path), 0);
	fake_release(&fake);
}

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static off_t size_of(const char *path)
{
	struct stat found;

	return stat(path, &found) == 0 ? found.st_size : -1;
}

static void what_exists_is_only_replaced_when_asked_and_then_by_a_frame(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	in_folder(path, "old.h5");
	write_text(path, "old");
	fake_init(&fake, 3, 100, true);
	assert_int_equal(fake_open(&fake, path, false, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "it exists (--force replaces it)"));
	assert_int_equal(size_of(path), 3);
	rb_recorder_destroy(fake.recorder);

	assert_ok(fake_open(&fake, path, true, &err));
	assert_int_equal(size_of(path), 3);
	assert_ok(fake_push(&fake, 0, 1, &err));
	assert_true(size_of(path) > 3);
	assert_ok(fake_close(&fake, RB_OK, &err));
	assert_int_equal(assert_right(path, "complete", false), 1);
	fake_release(&fake);

	/* somebody else takes the name meanwhile */
	in_folder(path, "taken.h5");
	fake_init(&fake, 3, 100, true);
	assert_ok(fake_open(&fake, path, false, &err));
	write_text(path, "theirs");
	assert_int_equal(fake_push(&fake, 0, 1, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "it exists"));
	assert_int_equal(fake_close(&fake, RB_ERR_CREATE, &err), RB_OK);
	assert_int_equal(size_of(path), 6);
	assert_int_equal(partial_count(path), 0);
	fake_release(&fake);
}

static void a_name_that_cannot_be_made_is_refused_at_once(void **slot)
{
	const struct {
		const char *name, *text;
	} cases[] = {{"no/such/run.h5", "No such file or directory"},
	             {".", "it is a folder"},
	             {"loop/run.h5", "Too many levels of symbolic links"},
	             {"pipe.h5", "it is not a regular file"}};
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	assert_int_equal(symlink("loop", in_folder(path, "loop")), 0);
	assert_int_equal(mkfifo(in_folder(path, "pipe.h5"), 0666), 0);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		fake_init(&fake, 1, 10, true);
		assert_int_equal(fake_open(&fake, in_folder(path, cases[i].name), true, &err),
		                 RB_ERR_CREATE);
		if (!strstr(err.text, cases[i].text))
			fail_msg("'%s' lacks '%s'", err.text, cases[i].text);
		fake_release(&fake);
	}
}

static void a_symbolic_link_is_replaced_and_what_it_points_to_stays(void **slot)
{
	char path[512], target[512];
	struct fake fake;
	struct rb_error err;
	struct stat found;

	(void)slot;
	in_folder(path, "link.h5");
	in_folder(target, "target.h5");
	assert_int_equal(symlink("target.h5", path), 0);
	fake_init(&fake, 1, 10, true);
	assert_int_equal(fake_open(&fake, path, false, &err), RB_ERR_CREATE);
	fake_release(&fake);
	fake_init(&fake, 1, 10, true);
	assert_ok(fake_open(&fake, path, true, &err));
	assert_ok(fake_push(&fake, 0, 10, &err));
	assert_ok(fake_close(&fake, RB_OK, &err));
	assert_int_equal(lstat(path, &found), 0);
	assert_true(S_ISREG(found.st_mode));
	assert_int_not_equal(lstat(target, &found), 0);
	assert_int_equal(assert_right(path, "complete", false), 10);
	fake_release(&fake);
}

static void the_estimate_is_within_a_tenth(void **slot)
{
	static const struct {
		int bodies;
		uint64_t frames;
	} cases[] = {{10, 100}, {10, 3000}, {1000, 30}, {1000, 300}, {10000, 5}, {10000, 40}};
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		in_folder(path, "estimate.h5");
		unlink(path);
		fake_init(&fake, cases[i].bodies, cases[i].frames, i % 2 == 0);
		const double estimate = (double)rb_h5_estimate(&fake.info);
		assert_ok(fake_record(&fake, path, &err));
		assert_near(estimate, (double)size_of(path), 0.1 * (double)size_of(path));
		fake_release(&fake);
	}
}

/* In a child: `what` gets a pipe to say how many frames are safe; the parent kills it after `after_us`. */
static uint64_t killed(void (*what)(int safe), long after_us)
{
	int ends[2], status;
	uint64_t safe = 0, next;

	assert_int_equal(pipe(ends), 0);
	const pid_t child = fork();
	if (child == 0) {
		close(ends[0]);
		what(ends[1]);
		_exit(0);
	}
	close(ends[1]);
	/* the clock starts when the first frame is there */
	if (read(ends[0], &next, sizeof next) == sizeof next)
		safe = next;
	nanosleep(&(struct timespec){after_us / 1000000, after_us % 1000000 * 1000}, NULL);
	kill(child, SIGKILL);
	waitpid(child, &status, 0);
	while (read(ends[0], &next, sizeof next) == sizeof next)
		safe = next;
	close(ends[0]);
	return safe;
}

static void say(int safe, uint64_t frames)
{
	if (write(safe, &frames, sizeof frames) != sizeof frames)
		_exit(1);
}

static int child_bodies;

static void record_on_and_on(int safe)
{
	char path[512];
	struct fake fake;

	fake_init(&fake, child_bodies, 1000000, true);
	fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
	if (fake_open(&fake, in_folder(path, "killed.h5"), true, NULL) != RB_OK)
		_exit(1);
	for (uint64_t k = 0; k < 1000000; k += 1 + k % 5) {
		for (uint64_t i = 0; i < 1 + k % 5; i++)
			if (fake_push(&fake, k + i, k + i + 1, NULL) != RB_OK)
				_exit(1);
		if (fake.sink.idle(fake.sink.self, NULL) != RB_OK)
			_exit(1);
		say(safe, k + 1 + k % 5);
	}
}

static void what_was_flushed_survives_kill_9(void **slot)
{
	static const int bodies[] = {5, 40, 3000};
	char path[512];

	(void)slot;
	srand(4711);
	in_folder(path, "killed.h5");
	for (int i = 0; i < (getenv("TEST_LONG") ? 300 : 24); i++) {
		child_bodies = bodies[i % 3];
		unlink(path);
		const uint64_t safe = killed(record_on_and_on, rand() % 60000);
		const uint64_t found = assert_right(path, "running", false);
		if (safe == 0 || found < safe)
			fail_msg("%llu frames were safe, %llu are there", (unsigned long long)safe,
			         (unsigned long long)found);
	}
}

static void record_and_close(int safe)
{
	char path[512];
	struct fake fake;

	fake_init(&fake, child_bodies, 500, true);
	if (fake_open(&fake, in_folder(path, "closing.h5"), true, NULL) != RB_OK ||
	    fake_push(&fake, 0, 500, NULL) != RB_OK ||
	    fake.sink.idle(fake.sink.self, NULL) != RB_OK)
		_exit(1);
	say(safe, 500);
	(void)fake_close(&fake, RB_OK, NULL);
}

static void a_kill_while_it_is_closed_loses_nothing(void **slot)
{
	char path[512];

	(void)slot;
	srand(1174);
	in_folder(path, "closing.h5");
	child_bodies = 20;
	for (int i = 0; i < (getenv("TEST_LONG") ? 1000 : 60); i++) {
		unlink(path);
		killed(record_and_close, rand() % 6000);
		assert_int_equal(assert_right(path, NULL, false), 500);
	}
}

static void the_recording_can_be_read_while_it_grows(void **slot)
{
	char path[512];
	int ends[2];
	uint64_t safe;
	struct rb_reader *reader;
	struct rb_frame frame;
	struct rb_error err;

	(void)slot;
	in_folder(path, "killed.h5");
	unlink(path);
	child_bodies = 5;
	assert_int_equal(pipe(ends), 0);
	const pid_t child = fork();
	if (child == 0) {
		record_on_and_on(ends[1]);
		_exit(0);
	}
	close(ends[1]);
	assert_int_equal(read(ends[0], &safe, sizeof safe), sizeof safe);
	assert_ok(rb_reader_open(&reader, path, &err));
	for (int i = 0; i < 50; i++) {
		for (int n = 0; n < 20; n++)
			assert_int_equal(read(ends[0], &safe, sizeof safe), sizeof safe);
		assert_ok(rb_reader_refresh(reader, &err));
		assert_true(rb_reader_reading(reader)->frame_count >= safe);
		assert_string_equal(rb_reader_reading(reader)->status, "running");
		assert_ok(rb_reader_frame(reader, safe - 1, &frame, &err));
		assert_column(frame.position, safe - 1, 5, 0, 3, false);
	}
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	rb_reader_close(reader);
	close(ends[0]);
}

/* Frames until one fails; then the close. Gives the frames that went through. */
static uint64_t record_until_failure(struct fake *fake, struct rb_error *err)
{
	uint64_t k = 0;

	while (k < fake->model.frame_count && fake_push(fake, k, k + 1, err) == RB_OK)
		k++;
	return k;
}

static void a_file_size_limit_ends_the_run_with_all_before_it_readable(void **slot)
{
	char path[512];
	struct fake fake;
	struct rb_error err;

	(void)slot;
	for (int compression = 0; compression < 2; compression++) {
		in_folder(path, "limit.h5");
		unlink(path);
		fflush(NULL);
		const pid_t child = fork();
		if (child == 0) {
			const struct rlimit limit = {3000000, 3000000};
			signal(SIGXFSZ, SIG_IGN);
			fake_init(&fake, 500, 5000, true);
			fake.scene.record.compression = compression;
			if (setrlimit(RLIMIT_FSIZE, &limit) || fake_open(&fake, path, false, &err))
				_exit(1);
			const uint64_t frames = record_until_failure(&fake, &err);
			if (frames < 10 || frames == 5000 || err.status != RB_ERR_IO ||
			    !strstr(err.text, "File too large") || !strstr(err.text, path))
				_exit(2);
			_exit(fake_close(&fake, err.status, &err) == RB_OK ? 0 : 3);
		}
		int status;
		waitpid(child, &status, 0);
		assert_int_equal(status, 0);
		assert_true(assert_right(path, "failed", false) > 5);
		assert_true(size_of(path) <= 3000000);
	}
}

static void a_full_disk_ends_the_run_with_all_before_it_readable(void **slot)
{
	char path[512], mount_point[512], copy[512];
	int status;

	(void)slot;
	in_folder(mount_point, "small");
	in_folder(copy, "small.h5");
	mkdir(mount_point, 0777);
	snprintf(path, sizeof path, "%.480s/full.h5", mount_point);
	fflush(NULL);
	const pid_t child = fork();
	if (child == 0) {
		struct fake fake;
		struct rb_error err;
		/* a disk of sixteen megabytes that only this process sees */
		if (unshare(CLONE_NEWNS) || mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) ||
		    mount("small", mount_point, "tmpfs", 0, "size=16m"))
			_exit(77);
		fake_init(&fake, 100, 100000, true);
		if (fake_open(&fake, path, false, &err))
			_exit(1);
		const uint64_t frames = record_until_failure(&fake, &err);
		if (frames < 10 || frames == 100000 || err.status != RB_ERR_IO ||
		    !strstr(err.text, "No space left on device"))
			_exit(2);
		if (fake_close(&fake, err.status, &err))
			_exit(3);
		char command[1200];
		snprintf(command, sizeof command, "cp '%s' '%s'", path, copy);
		const int copied = system(command);
		_exit(copied == 0 ? 0 : 4);
	}
	waitpid(child, &status, 0);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
		skip();
	assert_int_equal(status, 0);
	assert_true(assert_right(copy, "failed", false) > 10);
}

/* Every write to the file fails from here on: all descriptors of it become ones for reading. */
static bool break_descriptors(const char *path)
{
	char link[64], target[512];
	bool broken = false;
	const int reading = open(path, O_RDONLY);

	for (int fd = 3; fd < 256; fd++) {
		snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
		const ssize_t size = readlink(link, target, sizeof target - 1);
		if (size <= 0)
			continue;
		target[size] = '\0';
		if (strcmp(target, path) == 0 && (fcntl(fd, F_GETFL) & O_ACCMODE) == O_RDWR)
			broken = dup2(reading, fd) >= 0;
	}
	return broken;
}

static void a_failing_disk_ends_the_run_without_a_crash(void **slot)
{
	char path[512], real[PATH_MAX];
	int status;

	(void)slot;
	assert_non_null(realpath(folder, real));
	snprintf(path, sizeof path, "%.500s/eio.h5", real);
	fflush(NULL);
	const pid_t child = fork();
	if (child == 0) {
		struct fake fake;
		struct rb_error err;
		fake_init(&fake, 100, 100000, true);
		if (fake_open(&fake, path, false, &err) || fake_push(&fake, 0, 500, &err) ||
		    fake.sink.idle(fake.sink.self, &err))
			_exit(1);
		if (!break_descriptors(path))
			_exit(4);
		if (fake_push(&fake, 500, 100000, &err) != RB_ERR_IO ||
		    !strstr(err.text, "Bad file descriptor"))
			_exit(2);
		(void)fake_close(&fake, RB_ERR_IO, &err);
		fake_release(&fake);
		exit(0); /* with all that runs at exit */
	}
	waitpid(child, &status, 0);
	assert_int_equal(status, 0);
	assert_int_equal(assert_right(path, "running", false), 500);
}

static void no_memory_is_an_error_and_leaves_nothing_behind(void **slot)
{
	char path[512];
	struct rb_error err;
	int successes = 0;

	(void)slot;
	in_folder(path, "memory.h5");
	for (uint64_t k = 1; successes == 0 && k < 2000; k++) {
		struct fake fake;
		fake_init(&fake, 3, 10, true);
		fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
		unlink(path);
		rb_memory_fail_at(k);
		const enum rb_status status = fake_record(&fake, path, &err);
		rb_memory_fail_at(0);
		if (status != RB_OK)
			assert_int_equal(status, RB_ERR_MEMORY);
		successes += status == RB_OK;
		assert_int_equal(partial_count(path), 0);
		fake_release(&fake);
	}
	assert_int_equal(successes, 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		/* those that fork come first, while this process has not started HDF5 */
		cmocka_unit_test(what_was_flushed_survives_kill_9),
		cmocka_unit_test(a_kill_while_it_is_closed_loses_nothing),
		cmocka_unit_test(the_recording_can_be_read_while_it_grows),
		cmocka_unit_test(a_file_size_limit_ends_the_run_with_all_before_it_readable),
		cmocka_unit_test(a_full_disk_ends_the_run_with_all_before_it_readable),
		cmocka_unit_test(a_failing_disk_ends_the_run_without_a_crash),
		cmocka_unit_test(every_frame_comes_back_to_the_bit),
		cmocka_unit_test(single_precision_and_compression_come_back),
		cmocka_unit_test(compressed_chunks_span_frames),
		cmocka_unit_test(bodies_split_among_chunks_come_back),
		cmocka_unit_test(every_third_frame_and_the_last_are_recorded_and_counts_add_up),
		cmocka_unit_test(a_scene_that_cannot_turn_has_one_fixed_orientation),
		cmocka_unit_test(the_name_appears_with_the_first_frame_and_not_before),
		cmocka_unit_test(what_exists_is_only_replaced_when_asked_and_then_by_a_frame),
		cmocka_unit_test(a_name_that_cannot_be_made_is_refused_at_once),
		cmocka_unit_test(a_symbolic_link_is_replaced_and_what_it_points_to_stays),
		cmocka_unit_test(the_estimate_is_within_a_tenth),
		cmocka_unit_test(no_memory_is_an_error_and_leaves_nothing_behind),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
