/* SPDX-License-Identifier: MIT */
/* src/film/film.c, src/film/press.c: frames by hand, the real painter, real files */
#include "filmset.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/place.h"
#include "film/png.h"
#include "film/press.h"

#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>

enum { FILE_MAX = 1 << 18 };

static struct rb_film_options options_of(const struct set *set)
{
	return (struct rb_film_options){.model = set->lab.model,
	                                .camera = &set->camera,
	                                .number = 3,
	                                .end_s = 2,
	                                .encoder_threads = 2};
}

static void begin_with(struct set *set, const struct rb_film_options *options)
{
	struct rb_error err;

	assert_ok(rb_film_check(options, &err));
	assert_ok(rb_film_create(&set->film, &set->sink, options, &err));
	assert_ok(set->sink.open(set->sink.self, &err));
}

static void begin(struct set *set)
{
	const struct rb_film_options options = options_of(set);

	begin_with(set, &options);
}

/* The ball at 2 m/s from x = -2 m at time 0. */
static enum rb_status show(struct set *set, uint64_t k, struct rb_error *err)
{
	set->frame.index = k;
	set->frame.time_s = (double)k / rate;
	set->frame.position[0] = -2 + 2 * set->frame.time_s;
	if (set->frame.orientation)
		set->frame.orientation[0] = 1;
	return set->sink.frame(set->sink.self, &set->frame, err);
}

static struct rb_film_tally end(struct set *set)
{
	const struct rb_outcome outcome = {.reason = ""};
	struct rb_error err;

	assert_ok(set->sink.close(set->sink.self, &outcome, &err));
	return rb_film_tally(set->film);
}

static int count_files(const char *folder)
{
	DIR *opened = opendir(folder);
	int count = 0;

	if (!opened)
		return -1;
	for (struct dirent *entry; (entry = readdir(opened)) != NULL;)
		count += entry->d_name[0] != '.';
	closedir(opened);
	return count;
}

static size_t load(const char *path, uint8_t bytes[FILE_MAX])
{
	FILE *stream = fopen(path, "rb");

	if (!stream)
		fail_msg("no file '%s'", path);
	const size_t size = fread(bytes, 1, FILE_MAX, stream);
	fclose(stream);
	return size;
}

static bool holds(const uint8_t *bytes, size_t size, const char *text)
{
	for (size_t i = 0; i + strlen(text) <= size; i++)
		if (memcmp(bytes + i, text, strlen(text)) == 0)
			return true;
	return false;
}

/* Where the ball is, m: its pixels are those that differ from the picture without it, here the sky's corner column. */
static double ball_in(const struct rb_pixmap *pixmap)
{
	double sum = 0, count = 0;
	const double px_per_m = H / 2.0 / tan(0.5 * rb_camera_def_default().fov) / 8;

	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			const uint8_t *p = pixmap->rgba + 4 * (y * W + x);
			const uint8_t *sky = pixmap->rgba + 4 * (y * W + W - 1);
			int differs = 0;
			for (int c = 0; c < 3; c++)
				differs += abs(p[c] - sky[c]);
			if (differs > 40) {
				sum += x + 0.5;
				count++;
			}
		}
	assert_true(count > 10);
	return (sum / count - W / 2.0) / px_per_m;
}

static void name_picture(char path[400], const struct set *set, int picture)
{
	snprintf(path, 400, "%.255s/pictures/%03d.png", set->folder, picture);
}

static double ball_at(const struct set *set, int picture)
{
	static uint8_t bytes[FILE_MAX];
	struct rb_pixmap pixmap;
	struct rb_error err;
	char path[400];

	name_picture(path, set, picture);
	const size_t size = load(path, bytes);
	assert_ok(rb_png_decode(&pixmap, path, bytes, size, &err));
	const double x = ball_in(&pixmap);
	rb_pixmap_release(&pixmap);
	return x;
}

static void every_frame_becomes_a_numbered_picture_of_its_moment(void **state)
{
	static uint8_t bytes[FILE_MAX];
	struct set set;
	char path[400];

	(void)state;
	open_set(&set);
	begin(&set);
	assert_true(set.sink.lossless && !set.sink.essential);
	for (uint64_t k = 0; k <= 10; k++)
		assert_int_equal(show(&set, k, NULL), RB_OK);
	const struct rb_film_tally tally = end(&set);
	assert_int_equal(tally.pictures, 11);
	assert_int_equal(tally.picture_count, 21);
	assert_int_equal(count_files(set.folder), 1);
	snprintf(path, sizeof path, "%s/pictures", set.folder);
	assert_int_equal(count_files(path), 11);
	for (int n = 0; n <= 10; n++)
		assert_near(ball_at(&set, n), -2 + 0.2 * n, 0.15);
	snprintf(path, sizeof path, "%s/pictures/003.png", set.folder);
	const size_t size = load(path, bytes);
	assert_true(holds(bytes, size, "0.3 s") && holds(bytes, size, "A ball") &&
	            holds(bytes, size, "main"));
	assert_true(tally.bytes > 11 * 200 && tally.png_ns > 0 && tally.draw_ns > 0);
	close_set(&set);
}

static void slow_motion_shows_what_lies_between_frames_and_time_lapse_leaves_out(void **state)
{
	static const struct {
		double from_s, to_s, fps, speed;
		int pictures;
	} cases[] = {{0, 0.5, 10, 0.25, 21},
	             {0.13, 0.61, 25, 1, 13},
	             {0, 2, 10, 5, 5},
	             {0.3, 0.3, (double)NAN, 1, 1}};

	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct set set;
		open_set(&set);
		set.camera.from_s = cases[k].from_s;
		set.camera.to_s = cases[k].to_s;
		set.camera.fps = cases[k].fps;
		set.camera.speed = cases[k].speed;
		begin(&set);
		for (uint64_t n = 0; n <= 20; n++)
			assert_int_equal(show(&set, n, NULL), RB_OK);
		const struct rb_film_tally tally = end(&set);
		assert_int_equal(tally.picture_count, cases[k].pictures);
		assert_int_equal(tally.pictures, cases[k].pictures);
		const double fps = isnan(cases[k].fps) ? rate : cases[k].fps;
		for (int n = 0; n < cases[k].pictures; n++) {
			const double t = cases[k].from_s + n * cases[k].speed / fps;
			assert_near(ball_at(&set, n), -2 + 2 * t, 0.15);
		}
		close_set(&set);
	}
}

/* Recordings may hold every third frame only, and end with the last one whatever its number. */
static void frames_that_are_far_apart_are_joined(void **state)
{
	static const uint64_t frames[] = {0, 3, 6, 9, 12, 15, 18, 20};
	struct set set;

	(void)state;
	open_set(&set);
	begin(&set);
	for (size_t k = 0; k < sizeof frames / sizeof *frames; k++)
		assert_int_equal(show(&set, frames[k], NULL), RB_OK);
	assert_int_equal(end(&set).pictures, 21);
	for (int n = 0; n <= 20; n++)
		assert_near(ball_at(&set, n), -2 + 0.2 * n, 0.15);
	close_set(&set);
}

static void a_film_needs_only_what_its_pictures_show(void **state)
{
	struct set set;
	struct rb_film_options options;

	(void)state;
	open_set(&set);
	options = options_of(&set);
	assert_int_equal(rb_film_create(&set.film, &set.sink, &options, NULL), RB_OK);
	assert_int_equal(set.sink.fields, RB_FIELD_POSITION | RB_FIELD_ORIENTATION);
	rb_film_destroy(set.film);
	set.camera.speed = 0.5;
	set.camera.vectors = RB_VECTORS_VELOCITY | RB_VECTORS_CONTACT;
	assert_int_equal(rb_film_create(&set.film, &set.sink, &options, NULL), RB_OK);
	assert_int_equal(set.sink.fields, RB_FIELD_POSITION | RB_FIELD_ORIENTATION |
	                                          RB_FIELD_VELOCITY | RB_FIELD_ANGULAR_VELOCITY |
	                                          RB_FIELD_CONTACTS | RB_FIELD_EVENTS);
	close_set(&set);
}

static void the_number_of_threads_is_not_in_the_bytes(void **state)
{
	static uint8_t bytes[2][FILE_MAX];
	struct set set[2];
	char path[400];

	(void)state;
	for (int way = 0; way < 2; way++) {
		open_set(&set[way]);
		set[way].camera.overlay = RB_OVERLAY_TIME | RB_OVERLAY_TITLE | RB_OVERLAY_ENERGY;
		struct rb_film_options options = options_of(&set[way]);
		options.encoder_threads = way == 0 ? 1 : 5;
		begin_with(&set[way], &options);
		for (uint64_t n = 0; n <= 20; n++)
			assert_int_equal(show(&set[way], n, NULL), RB_OK);
		assert_int_equal(end(&set[way]).pictures, 21);
	}
	for (int n = 0; n <= 20; n++) {
		size_t size[2];
		for (int way = 0; way < 2; way++) {
			name_picture(path, &set[way], n);
			size[way] = load(path, bytes[way]);
		}
		assert_int_equal(size[0], size[1]);
		assert_memory_equal(bytes[0], bytes[1], size[0]);
	}
	close_set(&set[0]);
	close_set(&set[1]);
}

/* An interrupted run, or a picture that can't be drawn: the film has what came before. */
static void a_film_that_stops_early_holds_what_was_filmed(void **state)
{
	const struct rb_outcome outcome = {.status = RB_ERR_INTERRUPT, .reason = "interrupted"};
	struct set set;
	struct stat found;
	struct rb_error err;

	(void)state;
	if (system("ffmpeg -version >/dev/null 2>&1") != 0)
		skip();
	open_set(&set);
	set.camera.video = set.video;
	begin(&set);
	for (uint64_t n = 0; n <= 4; n++)
		assert_ok(show(&set, n, &err));
	assert_ok(set.sink.close(set.sink.self, &outcome, &err));
	const struct rb_film_tally tally = rb_film_tally(set.film);
	assert_int_equal(tally.pictures, 5);
	assert_true(tally.pipe_ns > 0 && tally.png_ns > 0);
	assert_int_equal(stat(set.video, &found), 0);
	assert_true((uint64_t)found.st_size < tally.bytes && found.st_size > 500);
	assert_int_equal(count_files(set.folder), 2);
	close_set(&set);

	open_set(&set);
	set.camera.video = set.video;
	set.camera.png = NULL;
	begin(&set);
	for (uint64_t n = 0; n <= 4; n++)
		assert_ok(show(&set, n, &err));
	set.frame.time_s = 0.5;
	set.frame.index = 5;
	set.frame.position[0] = 0, set.frame.position[1] = -8; /* the camera is inside now */
	assert_int_equal(set.sink.frame(set.sink.self, &set.frame, &err), RB_ERR_SCENE);
	assert_ok(set.sink.close(set.sink.self, &outcome, NULL));
	assert_int_equal(rb_film_tally(set.film).pictures, 5);
	assert_int_equal(count_files(set.folder), 1);
	close_set(&set);
}

static void *cut_soon(void *film)
{
	while (rb_film_tally(film).pictures < 2)
		usleep(10000);
	rb_film_cut(film);
	return NULL;
}

/* A hundred thousand pictures lie between two frames. */
static void a_film_that_is_cut_short_ends_with_what_was_printed(void **state)
{
	struct set set;
	pthread_t thread;
	struct rb_error err;

	(void)state;
	if (system("ffmpeg -version >/dev/null 2>&1") != 0)
		skip();
	open_set(&set);
	set.camera.png = NULL;
	set.camera.video = set.video;
	set.camera.speed = 1e-5;
	begin(&set);
	assert_ok(show(&set, 0, &err));
	assert_int_equal(pthread_create(&thread, NULL, cut_soon, set.film), 0);
	assert_ok(show(&set, 1, &err));
	assert_ok(show(&set, 2, &err));
	pthread_join(thread, NULL);
	const struct rb_film_tally tally = end(&set);
	assert_true(tally.pictures > 1 && tally.pictures < 50000);
	assert_int_equal(tally.picture_count, 2000001);
	assert_int_equal(count_files(set.folder), 1);
	close_set(&set);
}

static void a_film_of_too_many_pictures_is_refused(void **state)
{
	static const double speeds[] = {1e-6, 1e-300};
	struct set set;
	struct rb_error err;

	(void)state;
	open_set(&set);
	struct rb_film_options options = options_of(&set);
	for (int k = 0; k < 2; k++) {
		set.camera.speed = speeds[k];
		options.still = false;
		assert_int_equal(rb_film_check(&options, &err), RB_ERR_SCENE);
		assert_non_null(strstr(err.text, k ? "at most 10000000" : "of 20000001 pictures"));
		options.still = true;
		assert_ok(rb_film_check(&options, &err));
	}
	close_set(&set);
}

static void a_run_without_a_picture_leaves_no_file(void **state)
{
	struct set set;

	(void)state;
	open_set(&set);
	set.camera.from_s = 1;
	set.camera.png = NULL;
	set.camera.video = set.video;
	if (system("ffmpeg -version >/dev/null 2>&1") != 0)
		skip();
	begin(&set);
	for (uint64_t n = 0; n <= 5; n++)
		assert_int_equal(show(&set, n, NULL), RB_OK);
	assert_int_equal(end(&set).pictures, 0);
	assert_int_equal(count_files(set.folder), 0);
	close_set(&set);
}

static void a_printer_that_fails_stops_the_film_with_its_reason(void **state)
{
	struct set set;
	struct rb_error err;
	enum rb_status status = RB_OK;
	char path[400];

	(void)state;
	open_set(&set);
	begin(&set);
	/* somebody else's picture comes in the way */
	snprintf(path, sizeof path, "%s/pictures/002.png", set.folder);
	FILE *stream = fopen(path, "w");
	fclose(stream);
	for (uint64_t n = 0; n <= 20 && !status; n++)
		status = show(&set, n, &err);
	const struct rb_outcome outcome = {.status = status, .reason = "x"};
	if (!status) /* all were queued already */
		status = set.sink.close(set.sink.self, &outcome, &err);
	else
		assert_int_equal(set.sink.close(set.sink.self, &outcome, NULL), RB_ERR_CREATE);
	assert_int_equal(status, RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "002.png"));
	assert_true(rb_film_tally(set.film).pictures < 21);
	close_set(&set);
}

static void one_picture_is_written_under_its_own_name(void **state)
{
	struct set set;
	char path[300];

	(void)state;
	open_set(&set);
	snprintf(path, sizeof path, "%s/100%%.png", set.folder);
	set.camera.png = path;
	set.camera.from_s = 0.5;
	struct rb_film_options options = options_of(&set);
	options.still = true;
	begin_with(&set, &options);
	for (uint64_t n = 5; n <= 7; n++)
		assert_int_equal(show(&set, n, NULL), RB_OK);
	const struct rb_film_tally tally = end(&set);
	assert_true(tally.pictures == 1 && tally.picture_count == 1);
	assert_int_equal(count_files(set.folder), 1);
	assert_int_equal(access(path, R_OK), 0);
	close_set(&set);
}

static void what_cannot_be_filmed_is_known_before(void **state)
{
	struct set set;
	struct rb_error err;
	char path[400];

	(void)state;
	open_set(&set);
	const struct rb_film_options options = options_of(&set);
	set.camera.size_px[0] = 0;
	assert_int_equal(rb_film_check(&options, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "0 x 48"));
	set.camera.size_px[0] = W;
	set.camera.png = "frames/%s%n.png";
	assert_int_equal(rb_film_check(&options, &err), RB_ERR_SCENE);
	set.camera.png = "/proc/none/%d.png";
	assert_int_equal(rb_film_check(&options, &err), RB_ERR_CREATE);
	set.camera.png = set.png;
	assert_ok(rb_film_check(&options, &err));
	assert_int_equal(count_files(set.folder), 0);
	snprintf(path, sizeof path, "%s/pictures", set.folder);
	mkdir(path, 0777);
	snprintf(path, sizeof path, "%s/pictures/000.png", set.folder);
	fclose(fopen(path, "w"));
	assert_int_equal(rb_film_check(&options, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "000.png"));
	setenv("RBSIM_FFMPEG", "/nonexistent", 1);
	set.camera.png = NULL;
	set.camera.video = set.video;
	assert_int_equal(rb_film_check(&options, &err), RB_ERR_MISSING);
	unsetenv("RBSIM_FFMPEG");
	close_set(&set);
}

static void names_of_pictures_are_made_from_their_pattern(void **state)
{
	static const struct {
		const char *pattern, *name; /* NULL: it is no pattern */
	} cases[] = {{"a/%05d.png", "a/00042.png"},
	             {"%d", "42"},
	             {"%3d.png", " 42.png"},
	             {"100%%/%02d", "100%/42"},
	             {"%01d", "42"},
	             {"a.png", NULL},
	             {"%d%d", NULL},
	             {"%s", NULL},
	             {"%", NULL},
	             {"%5", NULL},
	             {"%%", NULL},
	             {"%n%d", NULL}};
	char name[64], tight[34];

	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		const bool good = rb_press_name(name, sizeof name, cases[k].pattern, 42);
		assert_int_equal(good, cases[k].name != NULL);
		if (good)
			assert_string_equal(name, cases[k].name);
	}
	assert_false(rb_press_name(tight, sizeof tight, "%d and a long name behind it", 42));
}

static void memory_that_runs_out_in_the_press_is_told_and_given_back(void **state)
{
	struct rb_pixmap pixmap;
	struct rb_press *press;
	char folder[256], png[300];
	int failures = 0;

	(void)state;
	snprintf(png, sizeof png, "%s/%%d.png", support_folder(folder));
	const struct rb_press_options options = {.png = png,
	                                         .how = RB_PLACE_REPLACE,
	                                         .width = W,
	                                         .height = H,
	                                         .fps = 10,
	                                         .png_threads = 2};
	assert_int_equal(rb_pixmap_init(&pixmap, W, H, NULL), RB_OK);
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1;; k++, failures++) {
		rb_memory_fail_at(k);
		enum rb_status status = rb_press_create(&press, &options, NULL);
		if (!status) {
			status = rb_press_print(press, &pixmap, 7, 0.7, NULL);
			const enum rb_status closed = rb_press_close(press, NULL);
			status = status ? status : closed;
			assert_int_equal(rb_press_tally(press).pictures, status ? 0 : 1);
		}
		rb_memory_fail_at(0);
		rb_press_destroy(press);
		if (!status)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_int_equal(count_files(folder), 0);
	}
	assert_true(failures > 8);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
	rb_pixmap_release(&pixmap);
}

/* Functions of time stand in the frame; whose they are and which picture they are for matters. */
static void a_moving_camera_stands_where_its_shot_says(void **state)
{
	struct rb_frame_shot shots[4] = {{.camera = 0, .picture = 0, .position = {0, 0, 0}},
	                                 {.camera = 3, .picture = 0, .position = {-2, -8, 0}},
	                                 {.camera = 3, .picture = 1, .position = {0, 0, 0}},
	                                 {.camera = 4, .picture = 0, .position = {0, 0, 0}}};
	struct set set;
	struct rb_error err;

	(void)state;
	open_set(&set);
	set.camera.position.source = RB_CAMERA_FUNCTION;
	set.camera.look_at.source = RB_CAMERA_FUNCTION;
	shots[1].look_at = (rb_vec3){-2, 0, 0};
	begin(&set);
	set.frame.shots = shots;
	set.frame.shot_count = 4;
	assert_ok(show(&set, 0, &err));
	set.frame.shot_count = 0;
	assert_int_equal(show(&set, 1, &err), RB_ERR_BUG);
	set.frame.shots = NULL;
	assert_int_equal(end(&set).pictures, 1);
	assert_near(ball_at(&set, 0), 0, 0.15); /* in the middle: the camera looks at it */
	close_set(&set);
}

/* Between two frames the shots are those of the later one. */
static void a_moving_camera_in_slow_motion_has_a_shot_for_each_picture(void **state)
{
	enum { SHOTS = 8 };
	struct rb_frame_shot shots[3 * SHOTS];
	struct set set;
	struct rb_error err;

	(void)state;
	open_set(&set);
	set.camera.position.source = set.camera.look_at.source = RB_CAMERA_FUNCTION;
	set.camera.speed = 1.0 / SHOTS;
	begin(&set);
	for (uint64_t k = 0; k < 2; k++) {
		/* frame 0 has picture 0, frame 1 the next eight, of each of three cameras */
		const int count = k == 0 ? 1 : SHOTS;
		for (int i = 0; i < 3 * count; i++) {
			const int picture = (k == 0 ? 0 : 1) + i % count;
			/* the ball stays in the middle, but for what the camera goes ahead */
			const double x = -2 + 0.2 * picture / SHOTS - 0.1 * picture;
			shots[i] = (struct rb_frame_shot){.camera = 2 + i / count,
			                                  .picture = (uint64_t)picture,
			                                  .position = {x, -8, 0},
			                                  .look_at = {x, 0, 0}};
			if (shots[i].camera != 3)
				shots[i].position = shots[i].look_at = (rb_vec3){0};
		}
		set.frame.shots = shots;
		set.frame.shot_count = 3 * count;
		assert_ok(show(&set, k, &err));
	}
	set.frame.shots = NULL;
	set.frame.shot_count = 0;
	assert_int_equal(end(&set).pictures, SHOTS + 1);
	for (int n = 0; n <= SHOTS; n++)
		assert_near(ball_at(&set, n), 0.1 * n, 0.15);
	close_set(&set);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_frame_becomes_a_numbered_picture_of_its_moment),
		cmocka_unit_test(
			slow_motion_shows_what_lies_between_frames_and_time_lapse_leaves_out),
		cmocka_unit_test(frames_that_are_far_apart_are_joined),
		cmocka_unit_test(a_film_needs_only_what_its_pictures_show),
		cmocka_unit_test(the_number_of_threads_is_not_in_the_bytes),
		cmocka_unit_test(a_film_that_stops_early_holds_what_was_filmed),
		cmocka_unit_test(a_film_that_is_cut_short_ends_with_what_was_printed),
		cmocka_unit_test(a_film_of_too_many_pictures_is_refused),
		cmocka_unit_test(a_run_without_a_picture_leaves_no_file),
		cmocka_unit_test(a_printer_that_fails_stops_the_film_with_its_reason),
		cmocka_unit_test(one_picture_is_written_under_its_own_name),
		cmocka_unit_test(what_cannot_be_filmed_is_known_before),
		cmocka_unit_test(names_of_pictures_are_made_from_their_pattern),
		cmocka_unit_test(memory_that_runs_out_in_the_press_is_told_and_given_back),
		cmocka_unit_test(a_moving_camera_stands_where_its_shot_says),
		cmocka_unit_test(a_moving_camera_in_slow_motion_has_a_shot_for_each_picture),
	};

	signal(SIGPIPE, SIG_IGN); /* as the program does */
	return cmocka_run_group_tests_name("film_film", tests, NULL, NULL);
}
