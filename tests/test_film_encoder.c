/* SPDX-License-Identifier: MIT */
/* src/film/encoder.c, with the real ffmpeg where it is installed */
#include "sanitized.h"

#include "base/clock.h"
#include "base/memory.h"
#include "film/encoder.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

enum { FRAMES = 12, BYTES_MAX = 1 << 22 };

static bool has_ffmpeg(void)
{
	return system("ffmpeg -version >/dev/null 2>&1") == 0;
}

/* Corners of four colours, and a white bar that goes from left to right: whatever is flipped or swapped shows. */
static void draw(struct rb_pixmap *pixmap, int frame)
{
	static const uint8_t colors[4][3] = {
		{200, 40, 40}, {40, 180, 60}, {50, 60, 210}, {120, 120, 120}};

	for (int y = 0; y < pixmap->height; y++)
		for (int x = 0; x < pixmap->width; x++) {
			const int corner = 2 * (2 * y >= pixmap->height) + (2 * x >= pixmap->width);
			const int bar = (frame + 1) * pixmap->width / (FRAMES + 2);
			uint8_t *p = pixmap->rgba + 4 * (y * pixmap->width + x);
			memcpy(p, colors[corner], 3);
			if (x >= bar - 4 && x < bar + 4)
				memset(p, 250, 3);
			p[3] = 7; /* must not matter */
		}
}

static struct rb_encoder_options options_of(const char *path, int width, int height, double fps)
{
	return (struct rb_encoder_options){.path = path,
	                                   .width = width,
	                                   .height = height,
	                                   .fps = fps,
	                                   .title = "A \"test\"; $HOME"};
}

static uint64_t encode(const struct rb_encoder_options *options)
{
	struct rb_encoder *encoder;
	struct rb_pixmap pixmap;
	struct rb_error err;
	uint64_t bytes = 0;

	assert_ok(rb_pixmap_init(&pixmap, options->width, options->height, &err));
	assert_ok(rb_encoder_check(options, &err));
	assert_ok(rb_encoder_create(&encoder, options, &err));
	for (int i = 0; i < FRAMES; i++) {
		draw(&pixmap, i);
		assert_ok(rb_encoder_picture(encoder, &pixmap, &err));
	}
	assert_ok(rb_encoder_finish(encoder, false, &bytes, &err));
	rb_encoder_destroy(encoder);
	rb_pixmap_release(&pixmap);
	return bytes;
}

/* Output of a command; its size. */
static size_t run(const char *command, uint8_t *bytes)
{
	FILE *stream = popen(command, "r");

	assert_non_null(stream);
	const size_t size = fread(bytes, 1, BYTES_MAX, stream);
	assert_int_equal(pclose(stream), 0);
	return size;
}

static double value(const char *path, const char *entry)
{
	char command[600];
	uint8_t text[BYTES_MAX / 64];
	static uint8_t all[BYTES_MAX];

	snprintf(command, sizeof command,
	         "ffprobe -v error -count_frames -show_entries %s -of csv=p=0 '%s'", entry, path);
	const size_t size = run(command, all);
	memcpy(text, all, size < sizeof text ? size : sizeof text - 1);
	text[size < sizeof text ? size : sizeof text - 1] = '\0';
	char *rest;
	const double number = strtod((char *)text, &rest);
	return *rest == '/' ? number / strtod(rest + 1, NULL) : number;
}

/* Every decoded picture against the one that went in: mean difference of the channels, and of each corner. */
static void compare(const char *path, int width, int height, int frames, double tolerance)
{
	static uint8_t bytes[BYTES_MAX];
	struct rb_pixmap pixmap;
	char command[600];

	snprintf(command, sizeof command,
	         "ffmpeg -v error -i '%s' -f rawvideo -pix_fmt rgba -vf "
	         "scale=in_color_matrix=auto,crop=%d:%d:0:0 -fps_mode passthrough -",
	         path, width, height);
	const size_t size = run(command, bytes), one = 4 * (size_t)(width * height);
	assert_int_equal(size, one * (size_t)frames);
	assert_int_equal(rb_pixmap_init(&pixmap, width, height, NULL), RB_OK);
	for (int i = 0; i < frames; i++) {
		long sum = 0;
		draw(&pixmap, i * FRAMES / frames);
		for (size_t k = 0; k < one; k++)
			if (k % 4 != 3)
				sum += abs(bytes[one * (size_t)i + k] - pixmap.rgba[k]);
		const double mean = (double)sum / (3.0 * width * height);
		if (!(mean <= tolerance))
			fail_msg("'%s', picture %d: %g on average", path, i, mean);
	}
	rb_pixmap_release(&pixmap);
}

static void a_film_decodes_to_the_pictures_that_went_in(void **state)
{
	static const struct {
		const char *name;
		int width, height;
		double tolerance;
	} cases[] = {{"a.mp4", 320, 240, 3},
	             {"b.mp4", 161, 121, 4},
	             {"c.webm", 320, 240, 5},
	             {"d.gif", 160, 121, 6},
	             {"e 'x' %d:;$(id).mp4", 64, 48, 6},
	             {"-f.mp4", 64, 48, 6}};
	char folder[256], path[400], quoted[400];

	(void)state;
	if (!has_ffmpeg())
		skip();
	support_folder(folder);
	assert_int_equal(chdir(folder), 0);
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct stat found;
		snprintf(path, sizeof path, "%s", cases[k].name);
		const struct rb_encoder_options options = options_of(path, cases[k].width,
		                                                     cases[k].height, 24);
		const uint64_t bytes = encode(&options);
		assert_int_equal(stat(path, &found), 0);
		assert_int_equal(bytes, found.st_size);
		snprintf(quoted, sizeof quoted, "%zu%s", k, strrchr(cases[k].name, '.'));
		assert_int_equal(rename(path, quoted), 0);
		compare(quoted, cases[k].width, cases[k].height, FRAMES, cases[k].tolerance);
	}
	assert_int_equal(support_count_files("."), 6);
	assert_int_equal(chdir("/"), 0);
}

static void a_film_has_the_rate_the_duration_and_the_title_that_were_asked_for(void **state)
{
	static const double rates[] = {60, 59.94, 30, 12.5};
	static uint8_t text[BYTES_MAX];
	char folder[256], path[300], command[600];

	(void)state;
	if (!has_ffmpeg())
		skip();
	support_folder(folder);
	for (size_t k = 0; k < sizeof rates / sizeof *rates; k += tried(1, 3, 3)) {
		snprintf(path, sizeof path, "%s/%zu.mp4", folder, k);
		const struct rb_encoder_options options = options_of(path, 64, 48, rates[k]);
		(void)encode(&options);
		assert_near(value(path, "stream=avg_frame_rate"), rates[k], 1e-9);
		assert_near(value(path, "stream=nb_read_frames"), FRAMES, 0);
		assert_near(value(path, "format=duration"), FRAMES / rates[k], 2e-3);
	}
	snprintf(command, sizeof command,
	         "ffprobe -v error -show_entries "
	         "format_tags=title:stream=pix_fmt,color_space,color_range -of csv=p=0 '%s'",
	         path);
	text[run(command, text)] = '\0';
	assert_non_null(strstr((char *)text, "yuv420p,tv,bt709"));
	assert_non_null(strstr((char *)text, "A \"\"test\"\"; $HOME"));
	/* a browser begins to play before all of it has come: the index is in front */
	FILE *stream = fopen(path, "rb");
	const size_t size = fread(text, 1, 64, stream);
	fclose(stream);
	assert_int_equal(size, 64);
	assert_memory_equal(text + 4, "ftyp", 4);
	assert_memory_equal(text + text[3] + 4, "moov", 4);
}

/* 60 pictures a second are more than a gif can tell: every second one is left out. */
static void a_fast_gif_keeps_its_duration(void **state)
{
	char folder[256], path[300];

	(void)state;
	if (!has_ffmpeg())
		skip();
	snprintf(path, sizeof path, "%s/a.gif", support_folder(folder));
	const struct rb_encoder_options options = options_of(path, 96, 64, 60);
	(void)encode(&options);
	assert_near(value(path, "stream=nb_read_frames"), FRAMES / 2, 0);
	assert_near(value(path, "format=duration"), FRAMES / 60.0, 0.021);
	compare(path, 96, 64, FRAMES / 2, 6);
	assert_int_equal(support_count_files(folder), 1);
}

static void without_a_picture_or_where_it_is_given_up_nothing_is_left(void **state)
{
	static const char *const names[] = {"a.mp4", "a.gif"};
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_encoder *encoder;
	struct rb_pixmap pixmap;
	struct rb_error err;
	char folder[256], path[300];

	(void)state;
	if (!has_ffmpeg())
		skip();
	support_folder(folder);
	assert_ok(rb_pixmap_init(&pixmap, 64, 48, &err));
	for (int way = 0; way < 6; way++) {
		snprintf(path, sizeof path, "%s/%s", folder, names[way % 2]);
		const struct rb_encoder_options options = options_of(path, 64, 48, 30);
		assert_ok(rb_encoder_create(&encoder, &options, &err));
		for (int i = 0; i < 3 && way / 2 > 0; i++)
			assert_ok(rb_encoder_picture(encoder, &pixmap, &err));
		if (way / 2 < 2)
			assert_ok(rb_encoder_finish(encoder, way / 2 == 1, NULL, &err));
		rb_encoder_destroy(encoder);
		assert_int_equal(support_count_files(folder), 0);
	}
	assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
	rb_pixmap_release(&pixmap);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

/* ---- programs that are not ffmpeg ---- */

static const char listing[] =
	"case \"$*\" in *-encoders*) echo ' V....D libx264 x'; exit 0;; esac\n";

static void be_ffmpeg(const char *folder, const char *script)
{
	char path[300];

	snprintf(path, sizeof path, "%s/fake-ffmpeg", folder);
	FILE *stream = fopen(path, "w");
	assert_non_null(stream);
	fprintf(stream, "#!/bin/sh\n%s%s\n", listing, script);
	fclose(stream);
	assert_int_equal(chmod(path, 0755), 0);
	assert_int_equal(setenv("RBSIM_FFMPEG", path, 1), 0);
}

static enum rb_status film_with(const char *path, int pictures, double patience_s,
                                const atomic_bool *cut, struct rb_error *err)
{
	struct rb_encoder_options options = options_of(path, 320, 240, 30);
	struct rb_encoder *encoder;
	struct rb_pixmap pixmap;

	options.patience_s = patience_s;
	options.cut = cut;
	assert_int_equal(rb_pixmap_init(&pixmap, 320, 240, NULL), RB_OK);
	enum rb_status status = rb_encoder_create(&encoder, &options, err);
	for (int i = 0; i < pictures && !status; i++)
		status = rb_encoder_picture(encoder, &pixmap, err);
	if (!status)
		status = rb_encoder_finish(encoder, false, NULL, err);
	rb_encoder_destroy(encoder);
	rb_pixmap_release(&pixmap);
	return status;
}

static enum rb_status film_until_it_fails(const char *path, int pictures, struct rb_error *err)
{
	return film_with(path, pictures, 0, NULL, err);
}

static void an_ffmpeg_that_fails_is_told_with_what_it_said_last(void **state)
{
	static const struct {
		const char *script, *says[2];
		int pictures;
	} cases[] = {
		{"head -c 614400 >/dev/null; echo first >&2; echo 'no room: left' >&2; exit 3",
	         {"exit status 3: no room: left", "fake-ffmpeg"},
	         1000},
		{"cat >/dev/null; echo late >&2; exit 4", {"exit status 4: late", ""}, 5},
		{"head -c 614400 >/dev/null; kill -9 $$", {"signal 9", "it said nothing"}, 1000},
		{"exit 0", {"has ended before the film", ""}, 1000},
		/* talks more than a pipe holds before it reads */
		{"i=0; while [ $i -lt 4000 ]; do echo \"line $i of what nobody wants to know\" "
	         ">&2; "
	         "i=$((i+1)); done; cat >/dev/null; echo end >&2; exit 5",
	         {"exit status 5: end", ""},
	         20},
	};
	char folder[256], path[300];
	struct rb_error err;

	(void)state;
	support_folder(folder);
	snprintf(path, sizeof path, "%s/a.mp4", folder);
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		be_ffmpeg(folder, cases[k].script);
		assert_int_equal(film_until_it_fails(path, cases[k].pictures, &err),
		                 RB_ERR_MISSING);
		if (!strstr(err.text, cases[k].says[0]) || !strstr(err.text, cases[k].says[1]))
			fail_msg("'%s' lacks '%s'", err.text, cases[k].says[0]);
		assert_int_equal(support_count_files(folder), 1);
	}
	unsetenv("RBSIM_FFMPEG");
}

/* Its own group, no descriptor but the film's, no blocked or ignored signals, arguments as they are. */
static void ffmpeg_gets_a_clean_start(void **state)
{
	char folder[256], path[300], line[300] = "";
	struct rb_error err;
	sigset_t block, before;

	(void)state;
	snprintf(path, sizeof path, "%s/a.mp4", support_folder(folder));
	be_ffmpeg(
		folder,
		"cd \"${0%/*}\"; cat >/dev/null; for last; do :; done; echo film "
		">\"${last#file:}\"\n"
		"sed -nE 's/^Sig(Blk|Ign):.*(.{7})$/\\2/p' /proc/self/status | tr -d '\\n' >said\n"
		"n=0; for f in 3 4 5 6 7 8 9 40; do [ -e /proc/$$/fd/$f ] && n=$((n+1)); done\n"
		"printf %d $n >>said\n"
		"ps -o pgid= -p $$ | grep -qw $$ && echo ' own' >>said; exit 0");
	const int left_open = dup2(0, 40);
	sigfillset(&block);
	pthread_sigmask(SIG_BLOCK, &block, &before);
	const enum rb_status status = film_until_it_fails(path, 3, &err);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	close(left_open);
	unsetenv("RBSIM_FFMPEG");
	assert_int_equal(status, RB_OK);
	snprintf(path, sizeof path, "%s/said", folder);
	FILE *stream = fopen(path, "r");
	assert_non_null(stream);
	assert_non_null(fgets(line, sizeof line, stream));
	fclose(stream);
	if (strcmp(line, "000000000000001 own\n") != 0)
		fail_msg("'%s'", line);
}

static double seconds_since(uint64_t begin)
{
	return (double)(rb_clock_now_ns() - begin) * 1e-9;
}

/* 20 pictures are six times what the pipe holds. */
static void an_ffmpeg_that_hangs_is_ended_and_told(void **state)
{
	static const struct {
		const char *script;
		int pictures;
		bool cut;
		double least_s, most_s; /* how long it is believed */
	} cases[] = {{"exec sleep 60", 20, true, 0.4, 55},
	             {"exec sleep 60", 1, false, 0.4, 55},
	             {"cat >/dev/null; exec sleep 60", 20, false, 0.4, 55},
	             {"exec sleep 60 2>&-", 1, false, 0.4, 55},
	             {"exec yes >&2", 20, true, 4, 55},
	             {"exec yes >&2", 1, false, 4, 55},
	             {"sleep 60 & exec sleep 60", 1, false, 0.4, 55}};
	char folder[256], path[300];
	struct rb_error err;

	(void)state;
	snprintf(path, sizeof path, "%s/a.mp4", support_folder(folder));
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		const atomic_bool cut = cases[k].cut;
		be_ffmpeg(folder, cases[k].script);
		const uint64_t begin = rb_clock_now_ns();
		assert_int_equal(film_with(path, cases[k].pictures, 0.4, &cut, &err),
		                 RB_ERR_MISSING);
		const double took_s = seconds_since(begin);
		if (!(took_s >= cases[k].least_s && took_s < cases[k].most_s))
			fail_msg("'%s': %g s", cases[k].script, took_s);
		if (!strstr(err.text, "made no progress for 0.4 s"))
			fail_msg("'%s': '%s'", cases[k].script, err.text);
		assert_int_equal(support_count_files(folder), 1);
		assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
	}
	unsetenv("RBSIM_FFMPEG");
}

static void an_ffmpeg_that_is_slow_is_waited_for(void **state)
{
	static const char *const scripts[] = {
		/* reads nothing for a while */
		"sleep 0.3; cat >/dev/null; echo x >$out",
		/* a file grows */
		"cat >/dev/null; for i in 1 2 3 4 5 6 7; do sleep 0.4; echo x >>$out; done",
		/* works and says nothing */
		"cat >/dev/null; i=0; while [ $i -lt 3000000 ]; do i=$((i+1)); done; echo x >$out"};
	char folder[256], path[300], script[400];
	struct rb_error err;

	(void)state;
	snprintf(path, sizeof path, "%s/a.mp4", support_folder(folder));
	for (size_t k = 0; k < sizeof scripts / sizeof *scripts; k++) {
		snprintf(script, sizeof script, "for last; do :; done; out=\"${last#file:}\"; %s",
		         scripts[k]);
		be_ffmpeg(folder, script);
		/* seven of its pauses: a busy machine stretches them */
		assert_ok(film_with(path, 20, 3, NULL, &err));
		assert_int_equal(support_count_files(folder), 2);
		assert_int_equal(unlink(path), 0);
	}
	unsetenv("RBSIM_FFMPEG");
}

static void a_film_that_is_empty_or_whose_end_nobody_knows_is_a_failure(void **state)
{
	char folder[256], path[300];
	struct rb_error err;

	(void)state;
	snprintf(path, sizeof path, "%s/a.mp4", support_folder(folder));
	be_ffmpeg(folder, "cat >/dev/null; echo bored >&2; exit 0");
	assert_int_equal(film_until_it_fails(path, 3, &err), RB_ERR_MISSING);
	assert_non_null(strstr(err.text, "has written nothing: bored"));
	assert_int_equal(support_count_files(folder), 1);
	be_ffmpeg(folder, "cat >/dev/null; for last; do :; done; echo x >${last#file:}; exit 4");
	signal(SIGCHLD, SIG_IGN);
	const enum rb_status status = film_until_it_fails(path, 3, &err);
	signal(SIGCHLD, SIG_DFL);
	assert_int_equal(status, RB_ERR_MISSING);
	assert_int_equal(support_count_files(folder), 1);
	unsetenv("RBSIM_FFMPEG");
}

static void a_full_disk_is_told_as_such(void **state)
{
	static const char *const scripts[] = {
		"cat >/dev/null; echo 'write: No space left on device' >&2; echo Failed. >&2; exit "
		"1",
		"head -c 500000 >/dev/null; echo 'write: No space left on device' >&2; exit 1",
		("cat >/dev/null; for last; do :; done; echo x >${last#file:}\n"
	         "echo 'Error writing trailer: No space left on device' >&2; exit 0"),
		"cat >/dev/null; echo 'write: File too large' >&2; exit 1"};
	struct rlimit before, small;
	char folder[256], path[300];
	struct rb_error err;

	(void)state;
	snprintf(path, sizeof path, "%s/a.mp4", support_folder(folder));
	for (size_t k = 0; k < sizeof scripts / sizeof *scripts; k++) {
		be_ffmpeg(folder, scripts[k]);
		assert_int_equal(film_until_it_fails(path, 20, &err), RB_ERR_IO);
		if (!strstr(err.text, k < 3 ? "No space left" : "File too large"))
			fail_msg("'%s'", err.text);
		assert_int_equal(support_count_files(folder), 1);
	}
	unsetenv("RBSIM_FFMPEG");
	if (!has_ffmpeg())
		return;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	small = before;
	small.rlim_cur = 300;
	for (int k = 0; k < 3; k++) {
		snprintf(path, sizeof path, "%s/a.%s", folder,
		         (const char *[]){"mp4", "webm", "gif"}[k]);
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
		const enum rb_status status = film_until_it_fails(path, 20, &err);
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
		if (status != RB_ERR_IO)
			fail_msg("'%s': %d, '%s'", path, (int)status, err.text);
		assert_int_equal(support_count_files(folder), 1);
	}
}

/* The program ends in the middle, without a chance to tidy up. */
static void ffmpeg_does_not_outlive_the_program(void **state)
{
	char folder[256], film[300], path[300], line[32] = "";
	struct rb_encoder *encoder;
	struct rb_error err;

	(void)state;
	snprintf(film, sizeof film, "%s/a.mp4", support_folder(folder));
	be_ffmpeg(folder,
	          "echo $$ >\"${0%/*}/new\"; mv \"${0%/*}/new\" \"${0%/*}/pid\"; exec sleep 60");
	const struct rb_encoder_options options = options_of(film, 320, 240, 30);
	snprintf(path, sizeof path, "%s/pid", folder);
	const pid_t program = fork();
	if (program == 0) {
		if (rb_encoder_create(&encoder, &options, &err) != RB_OK)
			_exit(1);
		while (access(path, R_OK) != 0)
			usleep(50000);
		_exit(0);
	}
	int outcome;
	assert_int_equal(waitpid(program, &outcome, 0), program);
	assert_int_equal(outcome, 0);
	FILE *stream = fopen(path, "r");
	assert_non_null(stream);
	assert_non_null(fgets(line, sizeof line, stream));
	fclose(stream);
	/* gone, or a zombie of whoever has inherited it */
	char command[64];
	snprintf(command, sizeof command, "ps -o stat= -p %d | grep -qv Z", atoi(line));
	bool runs = true;
	for (int i = 0; i < 1000 && (runs = system(command) == 0); i++)
		usleep(50000);
	if (runs)
		kill(atoi(line), SIGKILL);
	assert_false(runs);
	unsetenv("RBSIM_FFMPEG");
}

static void assert_check_fails(const char *path, enum rb_status expected, const char *says)
{
	const struct rb_encoder_options options = options_of(path, 64, 48, 30);
	struct rb_error err = {0};

	assert_int_equal(rb_encoder_check(&options, &err), expected);
	if (!strstr(err.text, says))
		fail_msg("'%s' lacks '%s'", err.text, says);
}

static void what_cannot_be_filmed_is_known_before(void **state)
{
	char folder[256], path[300];

	(void)state;
	support_folder(folder);
	snprintf(path, sizeof path, "%s/a.mp4", folder);
	setenv("RBSIM_FFMPEG", "/nonexistent/ffmpeg", 1);
	assert_check_fails(path, RB_ERR_MISSING, "'/nonexistent/ffmpeg': No such file");
	setenv("RBSIM_FFMPEG", "/bin/false", 1);
	assert_check_fails(path, RB_ERR_MISSING, "exit status 1");
	be_ffmpeg(folder, "");
	const struct rb_encoder_options fine = options_of(path, 64, 48, 30);
	const uint64_t begin = rb_clock_now_ns();
	assert_int_equal(rb_encoder_check(&fine, NULL), RB_OK);
	assert_true(seconds_since(begin) < 30); /* half of what a hanging one is given */
	assert_int_equal(support_count_files(folder), 1);
	snprintf(path, sizeof path, "%s/a.webm", folder);
	assert_check_fails(path, RB_ERR_MISSING, "no encoder 'libvpx-vp9'");
	snprintf(path, sizeof path, "%s/a.avi", folder);
	assert_check_fails(path, RB_ERR_SCENE, ".mp4, .webm or .gif");
	/* libavutil's bound is (width + 128) (height + 128) < 2^28 */
	const struct rb_encoder_options huge = options_of("a.mp4", 16384, 16256, 30);
	const struct rb_encoder_options large = options_of("a.mp4", 16256, 16255, 30);
	struct rb_error err = {0};
	assert_int_equal(rb_encoder_check(&huge, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "16384 x 16256"));
	assert_int_equal(rb_encoder_check(&large, NULL), RB_OK);
	snprintf(path, sizeof path, "%s/fake-ffmpeg/a.mp4", folder);
	assert_check_fails(path, RB_ERR_CREATE, "Not a directory");
	snprintf(path, sizeof path, "%s/a.mp4", folder);
	close(open(path, O_CREAT | O_WRONLY, 0600));
	assert_check_fails(path, RB_ERR_CREATE, "exists");
	if (geteuid() != 0) {
		chmod(folder, 0500);
		snprintf(path, sizeof path, "%s/b.mp4", folder);
		assert_check_fails(path, RB_ERR_CREATE, "Permission denied");
		chmod(folder, 0700);
	}
	unsetenv("RBSIM_FFMPEG");
}

static void rates_that_a_format_cannot_tell_are_refused(void **state)
{
	static const struct {
		const char *name;
		double fps;
		bool good;
	} cases[] = {{"a.mp4", 1e-9, false}, {"a.mp4", 1e300, false}, {"a.mp4", 1000, true},
	             {"a.mp4", 1001, false}, {"a.webm", 1001, false}, {"a.webm", 0.001, true},
	             {"a.gif", 1e-3, false}, {"a.gif", 0.01, true},   {"a.gif", 2000, false},
	             {"a.gif", 240, true}};
	char folder[256], path[300];
	struct rb_error err;

	(void)state;
	be_ffmpeg(support_folder(folder),
	          "case \"$*\" in *-encoders*) printf ' V. libvpx-vp9 x\\n V. gif x\\n'; esac");
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		snprintf(path, sizeof path, "%s/%s", folder, cases[k].name);
		const struct rb_encoder_options options = options_of(path, 64, 48, cases[k].fps);
		err = (struct rb_error){0};
		const enum rb_status status = rb_encoder_check(&options, &err);
		if ((status == RB_ERR_SCENE) == cases[k].good)
			fail_msg("'%s' at %g: %s", cases[k].name, cases[k].fps, err.text);
		if (!cases[k].good && (!strstr(err.text, "to 1000") || !strstr(err.text, path)))
			fail_msg("'%s'", err.text);
	}
	unsetenv("RBSIM_FFMPEG");
}

/* At its ends, what is taken is what comes out. */
static void the_slowest_and_the_fastest_rate_are_kept(void **state)
{
	static const struct {
		const char *name;
		double fps, picture_s;
	} cases[] = {{"a.mp4", 0.001, 1000},  {"b.mp4", 1000, 0.001}, {"a.webm", 0.001, 1000},
	             {"b.webm", 1000, 0.001}, {"a.gif", 0.002, 500},  {"b.gif", 50, 0.02}};
	char folder[256], path[300];

	(void)state;
	if (!has_ffmpeg())
		skip();
	support_folder(folder);
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k += tried(1, 3, 3)) {
		snprintf(path, sizeof path, "%s/%s", folder, cases[k].name);
		const struct rb_encoder_options options = options_of(path, 64, 48, cases[k].fps);
		(void)encode(&options);
		assert_near(value(path, "stream=nb_read_frames"), FRAMES, 0);
		assert_near(value(path, "format=duration"), FRAMES * cases[k].picture_s,
		            0.02 * FRAMES * cases[k].picture_s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_film_decodes_to_the_pictures_that_went_in),
		cmocka_unit_test(
			a_film_has_the_rate_the_duration_and_the_title_that_were_asked_for),
		cmocka_unit_test(a_fast_gif_keeps_its_duration),
		cmocka_unit_test(without_a_picture_or_where_it_is_given_up_nothing_is_left),
		cmocka_unit_test(an_ffmpeg_that_fails_is_told_with_what_it_said_last),
		cmocka_unit_test(ffmpeg_gets_a_clean_start),
		cmocka_unit_test(an_ffmpeg_that_hangs_is_ended_and_told),
		cmocka_unit_test(an_ffmpeg_that_is_slow_is_waited_for),
		cmocka_unit_test(a_film_that_is_empty_or_whose_end_nobody_knows_is_a_failure),
		cmocka_unit_test(a_full_disk_is_told_as_such),
		cmocka_unit_test(ffmpeg_does_not_outlive_the_program),
		cmocka_unit_test(what_cannot_be_filmed_is_known_before),
		cmocka_unit_test(rates_that_a_format_cannot_tell_are_refused),
		cmocka_unit_test(the_slowest_and_the_fastest_rate_are_kept),
	};

	signal(SIGPIPE, SIG_IGN); /* as the program does */
	return cmocka_run_group_tests_name("film_encoder", tests, NULL, NULL);
}
