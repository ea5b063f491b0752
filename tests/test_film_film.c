/* SPDX-License-Identifier: MIT */
/* src/film/film.c, src/film/press.c, src/film/take.c, src/film/trails.c: frames by hand, the real painter, real files */
#include "support.h"
#include "worlds.h"

#include "base/memory.h"
#include "film/film.h"
#include "film/png.h"
#include "film/press.h"
#include "film/take.h"
#include "flow/frame.h"

#include <dirent.h>
#include <signal.h>
#include <sys/stat.h>

enum { W = 64, H = 48, FILE_MAX = 1 << 18 };

static const double rate = 10; /* frames per second */

/* A ball that goes to the right, seen from the front, and a camera's film of it. */
struct set {
	struct lab lab;
	struct rb_camera_def camera;
	struct rb_frame frame;
	struct rb_film *film;
	struct rb_sink sink;
	char folder[256], png[300], video[300];
};

static void open_set(struct set *set)
{
	*set = (struct set){0};
	lab_open(&set->lab, 2, rate);
	set->lab.scene.world.title = rb_scene_text(&set->lab.scene, "A ball");
	set->lab.scene.world.gravity = (rb_vec3){0};
	lab_sphere(&set->lab, 0.5, 1, (rb_vec3){-2, 0, 0}, (rb_vec3){2, 0, 0});
	if (rb_model_create(&set->lab.model, &set->lab.scene, NULL, &set->lab.error) != RB_OK)
		fail_msg("model: %s", set->lab.error.text);
	set->camera = rb_camera_def_default();
	set->camera.name = "main";
	set->camera.size_px[0] = W;
	set->camera.size_px[1] = H;
	set->camera.position.value = (rb_vec3){0, -8, 0};
	set->camera.look_at.value = (rb_vec3){0, 0, 0};
	set->camera.overlay = 0;
	set->camera.shadows = false;
	assert_int_equal(rb_frame_init(&set->frame, set->lab.model, RB_FIELD_DEFAULT, NULL), RB_OK);
	support_folder(set->folder);
	snprintf(set->png, sizeof set->png, "%s/pictures/%%03d.png", set->folder);
	snprintf(set->video, sizeof set->video, "%s/film.mp4", set->folder);
	set->camera.png = set->png;
}

static void close_set(struct set *set)
{
	rb_film_destroy(set->film);
	rb_frame_release(&set->frame);
	lab_close(&set->lab);
}

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
	             {0.3, 0.3, NAN, 1, 1}};

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
	                                          RB_FIELD_CONTACTS);
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
	const struct rb_press_options options = {
		.png = png, .replace = true, .width = W, .height = H, .fps = 10, .png_threads = 2};
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
	struct rb_frame_shot shots[3] = {{.camera = 0, .picture = 0, .position = {0, 0, 0}},
	                                 {.camera = 3, .picture = 0, .position = {-2, -8, 0}},
	                                 {.camera = 3, .picture = 1, .position = {0, 0, 0}}};
	struct set set;
	struct rb_error err;

	(void)state;
	open_set(&set);
	set.camera.position.source = RB_CAMERA_FUNCTION;
	set.camera.look_at.source = RB_CAMERA_FUNCTION;
	shots[1].look_at = (rb_vec3){-2, 0, 0};
	begin(&set);
	set.frame.shots = shots;
	set.frame.shot_count = 3;
	assert_ok(show(&set, 0, &err));
	set.frame.shot_count = 0;
	assert_int_equal(show(&set, 1, &err), RB_ERR_BUG);
	set.frame.shots = NULL;
	assert_int_equal(end(&set).pictures, 1);
	assert_near(ball_at(&set, 0), 0, 0.15); /* in the middle: the camera looks at it */
	close_set(&set);
}

/* ---- what is written over a picture ---- */

/* Left, right, top and bottom of what an overlay changes in the picture at a time. */
static void written_at(struct set *set, unsigned overlay, double time_s, int box[4])
{
	struct rb_pixmap plain = {0}, picture;
	struct rb_take *take;
	struct rb_error err;

	set->frame.time_s = time_s;
	set->frame.numbers.kinetic_energy = 4.5;
	set->frame.numbers.potential_energy = 8;
	box[0] = box[2] = 1000, box[1] = box[3] = -1;
	for (int way = 0; way < 2; way++) {
		set->camera.overlay = way ? overlay : 0;
		assert_ok(rb_take_create(&take, set->lab.model, &set->camera, &err));
		rb_take_see(take, &set->frame);
		assert_ok(rb_take_draw(take, &set->frame, NULL, &picture, &err));
		if (way == 0) {
			assert_ok(rb_pixmap_init(&plain, picture.width, picture.height, &err));
			memcpy(plain.rgba, picture.rgba,
			       4 * (size_t)(picture.width * picture.height));
		}
		for (int i = 0; i < picture.width * picture.height; i++) {
			const int x = i % picture.width, y = i / picture.width;
			if (memcmp(plain.rgba + 4 * i, picture.rgba + 4 * i, 4) == 0)
				continue;
			box[0] = x < box[0] ? x : box[0], box[1] = x > box[1] ? x : box[1];
			box[2] = y < box[2] ? y : box[2], box[3] = y > box[3] ? y : box[3];
		}
		rb_take_destroy(take);
	}
	rb_pixmap_release(&plain);
}

static void each_text_has_its_corner_and_does_not_move_as_time_goes_on(void **state)
{
	int title[4], early[4], late[4], slow[4], energy[4];
	struct set set;

	(void)state;
	open_set(&set);
	set.camera.size_px[0] = 480;
	set.camera.size_px[1] = 240;
	rb_model_destroy(set.lab.model);
	set.lab.scene.world.duration_s = 100;
	assert_int_equal(rb_model_create(&set.lab.model, &set.lab.scene, NULL, NULL), RB_OK);
	written_at(&set, RB_OVERLAY_TITLE, 1, title);
	assert_true(title[0] < 40 && title[1] < 240 && title[1] > 30 && title[3] < 60);
	written_at(&set, RB_OVERLAY_TIME, 1.25, early);
	written_at(&set, RB_OVERLAY_TIME, 98.75, late);
	assert_true(early[0] < 40 && early[1] < 240 && early[1] > 30 && early[2] > 180);
	assert_int_equal(early[1], late[1]);
	assert_int_equal(early[0], late[0]);
	written_at(&set, RB_OVERLAY_ENERGY, 1, energy);
	assert_true(energy[0] > 200 && energy[1] > 440 && energy[2] > 180);
	/* another speed is said beside the time */
	set.camera.speed = 0.25;
	written_at(&set, RB_OVERLAY_TIME, 1.25, slow);
	assert_true(slow[1] > early[1] + 50);
	close_set(&set);
}

/* ---- trails ---- */

static void a_path_stays_whole_and_bounded_however_long_the_run(void **state)
{
	struct set set;
	struct rb_trails trails;
	struct rb_error err;

	(void)state;
	open_set(&set);
	set.camera.trail_count = 1;
	set.camera.trails[0] = 0;
	assert_ok(rb_trails_init(&trails, set.lab.model, &set.camera, &err));
	assert_int_equal(trails.path_count, 1);
	for (int k = 0; k < 3 * RB_TRAIL_POINTS_MAX; k++) {
		set.frame.time_s = k / rate;
		set.frame.position[0] = k;
		rb_trails_add(&trails, &set.frame);
		assert_true(trails.point_count <= RB_TRAIL_POINTS_MAX);
	}
	assert_int_equal(trails.stride, 4);
	assert_int_equal(trails.point_count, 3 * RB_TRAIL_POINTS_MAX / 4);
	for (int i = 0; i < trails.point_count; i++) {
		assert_true(trails.points[0][i][0] == 4 * i);
		assert_true(trails.time_s[i] == 4 * i / rate);
	}
	rb_trails_release(&trails);
	rb_trails_release(&trails);
	close_set(&set);
}

static void a_trail_follows_the_centre_of_mass_and_skips_what_never_moves(void **state)
{
	struct set set;
	struct rb_trails trails;
	struct rb_error err;

	(void)state;
	open_set(&set);
	rb_model_destroy(set.lab.model);
	const int wall = lab_plane(&set.lab, (rb_vec3){0, 0, -9}, (rb_vec3){0, 0, 1});
	struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){3, 0, 0}, (rb_vec3){0});
	def.center_of_mass = (rb_vec3){0.1, 0, 0};
	def.angular_velocity = (rb_vec3){0, 0, 1};
	const int ball = lab_add(&set.lab, &def);
	assert_ok(rb_model_create(&set.lab.model, &set.lab.scene, NULL, &err));
	rb_frame_release(&set.frame);
	assert_ok(rb_frame_init(&set.frame, set.lab.model, RB_FIELD_DEFAULT, &err));
	set.camera.trail_count = 2;
	set.camera.trails[0] = wall;
	set.camera.trails[1] = ball;
	assert_ok(rb_trails_init(&trails, set.lab.model, &set.camera, &err));
	assert_int_equal(trails.path_count, 1);
	const int index = set.lab.model->index_of[ball];
	rb_vec3_to(set.frame.position + 3 * index, (rb_vec3){5, 6, 7});
	rb_quat_to(set.frame.orientation + 4 * index,
	           rb_quat_from_turn((rb_vec3){0, 0, 1.5707963267948966}));
	rb_trails_add(&trails, &set.frame);
	assert_near(trails.points[0][0][0], 5, 1e-15);
	assert_near(trails.points[0][0][1], 6.1, 1e-15);
	rb_trails_release(&trails);
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
		cmocka_unit_test(a_run_without_a_picture_leaves_no_file),
		cmocka_unit_test(a_printer_that_fails_stops_the_film_with_its_reason),
		cmocka_unit_test(one_picture_is_written_under_its_own_name),
		cmocka_unit_test(what_cannot_be_filmed_is_known_before),
		cmocka_unit_test(names_of_pictures_are_made_from_their_pattern),
		cmocka_unit_test(memory_that_runs_out_in_the_press_is_told_and_given_back),
		cmocka_unit_test(a_moving_camera_stands_where_its_shot_says),
		cmocka_unit_test(each_text_has_its_corner_and_does_not_move_as_time_goes_on),
		cmocka_unit_test(a_path_stays_whole_and_bounded_however_long_the_run),
		cmocka_unit_test(a_trail_follows_the_centre_of_mass_and_skips_what_never_moves),
	};

	signal(SIGPIPE, SIG_IGN); /* as the program does */
	return cmocka_run_group_tests_name("film_film", tests, NULL, NULL);
}
