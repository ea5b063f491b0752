/* SPDX-License-Identifier: MIT */
/* src/app/checkpoint.c: files that are whole, and all that are not */
#include "support.h"

#include <errno.h>
#include <fcntl.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>

#include <rbsim/model.h>

#include "app/checkpoint.h"
#include "base/memory.h"
#include "script/hooks.h"
#include "script/keep.h"
#include "script/load.h"

static const char source[] =
	"world { duration = 1, gravity = {0, 0, -9.81}, frame_rate = 10 }\n"
	"local m = material { name = 'm', density = 1000, restitution = 0.5 }\n"
	"plane { normal = {0, 0, 1}, material = m }\n"
	"sphere { radius = 0.1, position = {0, 0, 0.5}, material = m }\n"
	"state.a = {1, 2.5, 'x', {true, vec3(1, 2, 3)}}\n"
	"expect_always('yes', function() return true end)\n";

/* A loaded scene, its world, and a recording that holds whatever is asked for. */
struct bench {
	char folder[256], recording[300], name[320], before[320];
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_world *world;
	struct rb_error error;
	uint64_t told; /* what the run tells of itself */
	bool held;     /* the recording holds its frames */
	bool late;     /* the time of a signal is over */
};

static void pack_told(void *user, struct rb_pack *pack)
{
	struct bench *const bench = user;

	rb_pack_u64(pack, &bench->told);
}

static bool recorded(void *user, uint64_t frame)
{
	const struct bench *const bench = user;

	(void)frame;
	return bench->held;
}

static void make_world(struct bench *bench)
{
	const struct rb_source_file file = {
		.name = "s.lua", .text = source, .size_bytes = sizeof source - 1};
	const struct rb_script_options options = {.path = "s.lua", .files = &file, .file_count = 1};
	const struct rb_world_options world = {.threads = 1};
	struct rb_mistakes mistakes = {0};

	assert_int_equal(
		rb_script_load(&bench->script, &bench->scene, &mistakes, &options, &bench->error),
		RB_OK);
	assert_int_equal(rb_model_create(&bench->model, &bench->scene, &mistakes, &bench->error),
	                 RB_OK);
	const struct rb_world_hooks hooks = rb_script_hooks(bench->script);
	assert_int_equal(
		rb_world_create(&bench->world, bench->model, &world, &hooks, &bench->error), RB_OK);
	rb_mistakes_release(&mistakes);
}

static void lose_world(struct bench *bench)
{
	rb_world_destroy(bench->world);
	rb_model_destroy(bench->model);
	rb_script_destroy(bench->script);
	rb_scene_release(&bench->scene);
}

static void open_bench(struct bench *bench)
{
	*bench = (struct bench){.held = true};
	support_folder(bench->folder);
	snprintf(bench->recording, sizeof bench->recording, "%s/r.h5", bench->folder);
	snprintf(bench->name, sizeof bench->name, "%s.checkpoint", bench->recording);
	snprintf(bench->before, sizeof bench->before, "%s.checkpoint~", bench->recording);
	FILE *const file = fopen(bench->recording, "w");
	assert_non_null(file);
	fclose(file);
	make_world(bench);
}

static struct rb_checkpoint_parts parts_of(struct bench *bench)
{
	return (struct rb_checkpoint_parts){
		.world = bench->world, .script = bench->script, .pack = pack_told, .user = bench};
}

/* `count` checkpoints, a frame apart; how the last one went. */
static enum rb_status keep(struct bench *bench, int count, struct rb_checkpoints_tally *tally)
{
	const struct rb_checkpoints_options options = {
		.recording = bench->recording, .recorded = recorded, .user = bench};
	const struct rb_checkpoint_parts parts = parts_of(bench);
	struct rb_checkpoint_about about = {.run = 7, .started = "now"};
	struct rb_checkpoints *checkpoints;
	struct rb_frame frame = {0};
	enum rb_status status = RB_OK;

	assert_int_equal(rb_checkpoints_start(&checkpoints, &options, &bench->error), RB_OK);
	if (bench->late)
		rb_checkpoints_hurry(checkpoints, 1);
	for (int i = 0; i < count; i++) {
		assert_int_equal(rb_world_step_frame(bench->world, &bench->error), RB_OK);
		assert_int_equal(rb_world_fill_frame(bench->world, &frame, &bench->error), RB_OK);
		about.frame = rb_world_frame(bench->world);
		about.row_count = about.frame + 1;
		bench->told = 100 + about.frame;
		assert_int_equal(rb_checkpoints_take(checkpoints, &about, &parts, &bench->error),
		                 RB_OK);
		status = rb_checkpoints_wait(checkpoints, &bench->error);
	}
	*tally = rb_checkpoints_tally(checkpoints);
	rb_checkpoints_stop(checkpoints);
	rb_memory_free(frame.events);
	rb_memory_free(frame.contacts);
	return status;
}

static unsigned char *contents(const char *name, size_t *size)
{
	FILE *const file = fopen(name, "rb");
	struct stat about;

	assert_non_null(file);
	assert_int_equal(fstat(fileno(file), &about), 0);
	*size = (size_t)about.st_size;
	unsigned char *const bytes = rb_memory_take(*size + 1, 1);
	assert_non_null(bytes);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	fclose(file);
	return bytes;
}

static void put(const char *name, const unsigned char *bytes, size_t size)
{
	FILE *const file = fopen(name, "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
}

static void close_bench(struct bench *bench)
{
	rb_checkpoints_remove(bench->recording, 0);
	assert_int_not_equal(access(bench->name, F_OK), 0);
	assert_int_not_equal(access(bench->before, F_OK), 0);
	unlink(bench->recording);
	rmdir(bench->folder);
	lose_world(bench);
}

/* ---- tests ---- */

static enum rb_status load_again(struct rb_script *script, const unsigned char *bytes, size_t size)
{
	struct rb_pack pack = {.loading = true, .size = size};
	struct rb_error err;

	pack.bytes = rb_memory_take(size, 1);
	assert_non_null(pack.bytes);
	memcpy(pack.bytes, bytes, size);
	const enum rb_status status = rb_script_pack(script, &pack, &err);
	rb_memory_free(pack.bytes);
	return status;
}

/* Of two bodies the second is kept: the first one would be as good, a third one is none. */
static void a_body_that_there_is_not_is_refused(void **slot)
{
	static const char text[] = "world { duration = 1 }\n"
				   "sphere { radius = 0.1 }\n"
				   "state.b = sphere { radius = 0.1, position = {1, 0, 0} }\n";
	const struct rb_source_file file = {
		.name = "s.lua", .text = text, .size_bytes = sizeof text - 1};
	const struct rb_script_options options = {.path = "s.lua", .files = &file, .file_count = 1};
	struct rb_mistakes mistakes = {0};
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_error err;
	struct rb_pack saved = {0};
	int places = 0;

	(void)slot;
	assert_ok(rb_script_load(&script, &scene, &mistakes, &options, &err));
	assert_ok(rb_script_pack(script, &saved, &err));
	assert_int_equal(load_again(script, saved.bytes, saved.size), RB_OK);
	for (size_t i = 0; i + sizeof(int32_t) <= saved.size; i++) {
		int32_t id;
		memcpy(&id, saved.bytes + i, sizeof id);
		if (id != 1)
			continue;
		memcpy(saved.bytes + i, &(int32_t){0}, sizeof id);
		const bool first = load_again(script, saved.bytes, saved.size) == RB_OK;
		memcpy(saved.bytes + i, &(int32_t){2}, sizeof id);
		const enum rb_status third = load_again(script, saved.bytes, saved.size);
		memcpy(saved.bytes + i, &id, sizeof id);
		places += first && third == RB_ERR_INPUT;
	}
	assert_int_equal(places, 2); /* the other is how many entries the table has */
	rb_pack_release(&saved);
	rb_script_destroy(script);
	rb_scene_release(&scene);
	rb_mistakes_release(&mistakes);
}

static void what_was_kept_comes_back(void **state)
{
	struct rb_checkpoints_tally tally;
	struct rb_checkpoint checkpoint;
	struct bench bench;
	bool found;

	(void)state;
	open_bench(&bench);
	assert_int_equal(rb_checkpoint_read(&checkpoint, &found, bench.recording, 0, &bench.error),
	                 RB_OK);
	assert_false(found);
	assert_int_equal(keep(&bench, 3, &tally), RB_OK);
	assert_int_equal(tally.written, 3);
	assert_int_equal(tally.frame, 3);
	const uint64_t hash = rb_world_hash(bench.world);
	lose_world(&bench);
	make_world(&bench);
	bench.told = 0;
	const struct rb_checkpoint_parts parts = parts_of(&bench);
	assert_int_equal(rb_checkpoint_read(&checkpoint, &found, bench.recording, 0, &bench.error),
	                 RB_OK);
	assert_true(found);
	assert_int_equal(checkpoint.about.run, 7);
	assert_string_equal(checkpoint.about.started, "now");
	assert_int_equal(rb_checkpoint_restore(&checkpoint, &parts, &bench.error), RB_OK);
	assert_int_equal(rb_world_hash(bench.world), hash);
	assert_int_equal(rb_world_frame(bench.world), 3);
	assert_int_equal(bench.told, 103);
	rb_checkpoint_release(&checkpoint);
	close_bench(&bench);
}

static void a_byte_that_has_changed_is_told_wherever_it_is(void **state)
{
	struct rb_checkpoints_tally tally;
	struct bench bench;
	size_t size;

	(void)state;
	open_bench(&bench);
	assert_int_equal(keep(&bench, 1, &tally), RB_OK);
	unsigned char *const bytes = contents(bench.name, &size);
	assert_int_equal(tally.bytes, size);
	for (size_t at = 0; at < size; at++)
		for (int bit = 0; bit < 8; bit += 7) {
			struct rb_checkpoint checkpoint;
			unsigned char *const copy = rb_memory_take(size, 1);

			assert_non_null(copy);
			memcpy(copy, bytes, size);
			copy[at] ^= (unsigned char)(1 << bit);
			if (rb_checkpoint_parse(&checkpoint, copy, size, "it", &bench.error) !=
			    RB_ERR_INPUT)
				fail_msg("byte %zu of %zu, bit %d", at, size, bit);
			rb_checkpoint_release(&checkpoint);
		}
	rb_memory_free(bytes);
	close_bench(&bench);
}

static void a_file_that_ends_early_or_late_is_told(void **state)
{
	struct rb_checkpoints_tally tally;
	struct bench bench;
	size_t size;

	(void)state;
	open_bench(&bench);
	assert_int_equal(keep(&bench, 1, &tally), RB_OK);
	unsigned char *const bytes = contents(bench.name, &size);
	for (size_t length = 0; length <= size + 1; length++) {
		struct rb_checkpoint checkpoint;
		unsigned char *const copy = rb_memory_take(length + 1, 1);

		if (length == size) {
			rb_memory_free(copy);
			continue;
		}
		assert_non_null(copy);
		memcpy(copy, bytes, length < size ? length : size);
		if (rb_checkpoint_parse(&checkpoint, copy, length, "it", &bench.error) !=
		    RB_ERR_INPUT)
			fail_msg("%zu of %zu bytes", length, size);
		rb_checkpoint_release(&checkpoint);
	}
	rb_memory_free(bytes);
	close_bench(&bench);
}

static void the_one_before_is_taken_where_the_last_is_not_whole(void **state)
{
	struct rb_checkpoints_tally tally;
	struct rb_checkpoint checkpoint;
	struct bench bench;
	size_t size;
	bool found;

	(void)state;
	open_bench(&bench);
	assert_int_equal(keep(&bench, 2, &tally), RB_OK);
	unsigned char *const bytes = contents(bench.name, &size);
	bytes[size - 1] ^= 1;
	put(bench.name, bytes, size);
	rb_memory_free(bytes);
	assert_int_equal(rb_checkpoint_read(&checkpoint, &found, bench.recording, 0, &bench.error),
	                 RB_OK);
	assert_true(found);
	assert_int_equal(checkpoint.about.frame, 1);
	rb_checkpoint_release(&checkpoint);
	/* both */
	put(bench.before, (const unsigned char *)"x", 1);
	put(bench.name, (const unsigned char *)"", 0);
	assert_int_equal(rb_checkpoint_read(&checkpoint, &found, bench.recording, 0, &bench.error),
	                 RB_ERR_INPUT);
	assert_true(found);
	rb_checkpoint_release(&checkpoint);
	close_bench(&bench);
}

static void what_the_recording_will_not_hold_is_not_written(void **state)
{
	struct rb_checkpoints_tally tally;
	struct rb_checkpoint checkpoint;
	struct bench bench;
	bool found;

	(void)state;
	open_bench(&bench);
	assert_int_equal(keep(&bench, 1, &tally), RB_OK);
	bench.held = false;
	assert_int_equal(keep(&bench, 1, &tally), RB_ERR_IO);
	assert_int_equal(tally.written, 0);
	assert_int_equal(rb_checkpoint_read(&checkpoint, &found, bench.recording, 0, &bench.error),
	                 RB_OK);
	assert_true(found);
	assert_int_equal(checkpoint.about.frame, 1);
	rb_checkpoint_release(&checkpoint);
	close_bench(&bench);
}

/* In place of the C library's, for this program: the n-th call from now fails, with that error. */
static int syncs_before = -1, sync_error;

int fsync(int fd)
{
	(void)fd;
	if (syncs_before < 0 || syncs_before-- > 0)
		return 0;
	errno = sync_error;
	return -1;
}

/* First the recording is synced, then the checkpoint, then their folder, whose error only costs safety. */
static void what_cannot_be_synced_is_no_checkpoint(void **state)
{
	struct rb_checkpoints_tally tally;
	struct bench bench;

	(void)state;
	for (int k = 0; k < 6; k++) {
		const bool fails = k < 2;

		open_bench(&bench);
		syncs_before = k % 3;
		sync_error = k < 3 ? EIO : EINVAL;
		assert_int_equal(keep(&bench, 1, &tally), fails ? RB_ERR_IO : RB_OK);
		assert_int_equal(syncs_before, -1);
		assert_int_equal(tally.written, fails ? 0 : 1);
		assert_int_equal(access(bench.name, F_OK) == 0, !fails);
		close_bench(&bench);
	}
}

/* In place of the C library's, too: what is sent to the disk, and that nobody waits for it. */
static sem_t sent;
static atomic_llong sent_end;

int sync_file_range(int fd, off_t at, off_t size, unsigned flags)
{
	(void)fd;
	if (flags == SYNC_FILE_RANGE_WRITE && at == atomic_load(&sent_end)) {
		atomic_store(&sent_end, at + size);
		sem_post(&sent);
	}
	return 0;
}

static void a_recording_is_sent_to_the_disk_before_the_last_one(void **state)
{
	const off_t size = (off_t)100 << 20;
	struct rb_checkpoints *checkpoints;
	struct bench bench;

	(void)state;
	open_bench(&bench);
	assert_int_equal(truncate(bench.recording, size), 0);
	sem_init(&sent, 0, 0);
	const struct rb_checkpoints_options options = {
		.recording = bench.recording, .recorded = recorded, .user = &bench};
	assert_int_equal(rb_checkpoints_start(&checkpoints, &options, &bench.error), RB_OK);
	rb_checkpoints_hurry(checkpoints, 0);
	while (atomic_load(&sent_end) < size)
		sem_wait(&sent);
	assert_int_equal(rb_checkpoints_wait(checkpoints, &bench.error), RB_OK);
	assert_false(rb_checkpoints_busy(checkpoints));
	rb_checkpoints_stop(checkpoints);
	assert_int_equal(access(bench.name, F_OK), -1);
	sem_destroy(&sent);
	close_bench(&bench);
}

/* A disk that is slower than a signal's time: the checkpoint is there, and nothing has been waited for. */
static void what_comes_too_late_to_the_disk_is_not_waited_for(void **state)
{
	struct rb_checkpoints_tally tally;
	struct bench bench;

	(void)state;
	open_bench(&bench);
	bench.late = true;
	syncs_before = 0;
	sync_error = EIO;
	assert_int_equal(keep(&bench, 1, &tally), RB_OK);
	assert_int_equal(syncs_before, 0);
	assert_int_equal(tally.written, 1);
	assert_int_equal(access(bench.name, F_OK), 0);
	syncs_before = -1;
	close_bench(&bench);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_body_that_there_is_not_is_refused),
		cmocka_unit_test(what_was_kept_comes_back),
		cmocka_unit_test(a_byte_that_has_changed_is_told_wherever_it_is),
		cmocka_unit_test(a_file_that_ends_early_or_late_is_told),
		cmocka_unit_test(the_one_before_is_taken_where_the_last_is_not_whole),
		cmocka_unit_test(what_the_recording_will_not_hold_is_not_written),
		cmocka_unit_test(what_cannot_be_synced_is_no_checkpoint),
		cmocka_unit_test(a_recording_is_sent_to_the_disk_before_the_last_one),
		cmocka_unit_test(what_comes_too_late_to_the_disk_is_not_waited_for),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
