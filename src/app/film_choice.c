/* SPDX-License-Identifier: MIT */
#include "app/film_choice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/memory.h"
#include "control/steer.h"
#include "flow/framing.h"
#include "flow/schedule.h"
#include "script/shots.h"

/* One slot of the ring's consumers is the recorder's. */
enum { FILMS_MAX = RB_RING_CONSUMERS_MAX - 1, NAME_SIZE = 4352 };

struct rb_films_wish rb_films_wish_of_run(const struct rb_loaded *loaded,
                                          const struct rb_options *options)
{
	return (struct rb_films_wish){
		.names = options->camera,
		.from_s = (double)NAN,
		.to_s = (double)NAN,
		.fps = (double)NAN,
		.speed = (double)NAN,
		.recording = loaded->output,
		.runs = true,
		.replace = options->force || options->resume,
		.trust = options->trust,
		.patience_s = options->film_timeout_s,
		.end_s = loaded->model->duration_s,
	};
}

static bool is_named(const char *names, const char *name)
{
	const size_t size = name ? strlen(name) : 0;

	for (const char *at = names; size > 0 && *at;) {
		at += strspn(at, ", ");
		const size_t one = strcspn(at, ",");
		if (one == size && memcmp(at, name, one) == 0)
			return true;
		at += one;
	}
	return false;
}

/* Which names of cameras there are, for who wished for another. */
static void list_names(const struct rb_scene *scene, char *out, size_t size)
{
	size_t used = 0;
	int nameless = 0;

	snprintf(out, size,
	         scene->camera_count > 0 ? "no camera of the scene has a name"
	                                 : "the scene has no camera");
	for (int i = 0; i < scene->camera_count + scene->film_count && used < size; i++) {
		const int film = i - scene->camera_count;
		const char *const name = film < 0 ? scene->cameras[i].name
		                                  : scene->films[film].camera.name;
		nameless += !name;
		if (name)
			used += (size_t)snprintf(out + used, size - used, "%s%s",
			                         used > 0 ? ", " : "there are ", name);
	}
	if (used > 0 && used < size && nameless > 0)
		snprintf(out + used, size - used, ", and %d without a name", nameless);
}

static enum rb_status check_names(const struct rb_scene *scene, const char *names,
                                  struct rb_error *err)
{
	char known[160];

	for (const char *at = names; at && *at;) {
		at += strspn(at, ", ");
		const size_t size = strcspn(at, ",");
		bool found = size == 0;
		for (int i = 0; i < scene->camera_count && !found; i++)
			found = scene->cameras[i].name && strlen(scene->cameras[i].name) == size &&
			        memcmp(scene->cameras[i].name, at, size) == 0;
		for (int i = 0; i < scene->film_count && !found; i++) {
			const char *const name = scene->films[i].camera.name;
			found = name && strlen(name) == size && memcmp(name, at, size) == 0;
		}
		if (!found) {
			list_names(scene, known, sizeof known);
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--camera': there is no camera '%.*s' (%s)",
			               (int)size, at, known);
		}
		at += size;
	}
	return RB_OK;
}

/*
 * Gives a camera a picture of another size. The edges of a frustum belong to the shape of its own
 * picture: in one of another shape two of them move outwards, so that nothing is drawn longer than
 * it is or cut off.
 */
static void resize(struct rb_camera_def *camera, int width, int height)
{
	double *const f = camera->frustum;
	const double wider = ((double)width / height) /
	                     ((double)camera->size_px[0] / camera->size_px[1]);
	const int low = wider > 1 ? 0 : 2; /* left and right, or bottom and top */
	const double middle = 0.5 * (f[low] + f[low + 1]);
	const double half = 0.5 * (f[low + 1] - f[low]) * (wider > 1 ? wider : 1 / wider);

	if (camera->has_frustum && wider != 1) {
		f[low] = middle - half;
		f[low + 1] = middle + half;
	}
	camera->size_px[0] = width;
	camera->size_px[1] = height;
}

static void apply(struct rb_camera_def *camera, const struct rb_films_wish *wish)
{
	camera->single = wish->still;
	camera->film_from_s = camera->from_s;
	camera->film_to_s = camera->to_s;
	if (!isnan(wish->from_s))
		camera->from_s = wish->from_s;
	if (!isnan(wish->to_s))
		camera->to_s = wish->to_s;
	if (!isnan(wish->fps))
		camera->fps = wish->fps;
	if (!isnan(wish->speed)) {
		camera->speed = wish->speed;
		camera->speed_varies = false;
	}
	if (wish->size_px[0] > 0)
		resize(camera, wish->size_px[0], wish->size_px[1]);
	if (!wish->output)
		return;
	const char *const dot = strrchr(wish->output, '.');
	const bool png = dot && strcmp(dot, ".png") == 0;
	camera->png = png ? wish->output : NULL;
	camera->video = png ? NULL : wish->output;
}

/* px, between `count` cells, of which each is to have a pixel of `size`; `gap`, or what fits. */
static int fitting(int gap, int size, int count)
{
	const int room = count > 1 ? (size - count) / (count - 1) : gap;

	return room < 0 ? 0 : room < gap ? room : gap;
}

/*
 * Divides the picture of a film among its cameras: rows of one height, in each of which all have
 * one width, with a narrow gap between them.
 */
static bool divide(struct film *film, const struct rb_scene *scene, const struct rb_film_def *def)
{
	const int width = film->camera.size_px[0], height = film->camera.size_px[1];
	int gap = fitting(height / 240, height, def->row_count), cell = 0;

	film->cells = rb_memory_take((size_t)def->cell_count, sizeof *film->cells);
	if (!film->cells)
		return false;
	film->cell_count = def->cell_count;
	for (int r = 0; r < def->row_count; r++)
		gap = fitting(gap, width, def->columns[r]);
	for (int r = 0; r < def->row_count; r++) {
		const int columns = def->columns[r];
		const int top = (height + gap) * r / def->row_count;
		const int bottom = (height + gap) * (r + 1) / def->row_count - gap;
		for (int c = 0; c < columns; c++, cell++) {
			struct rb_film_cell *const part = &film->cells[cell];
			const int left = (width + gap) * c / columns;
			const int right = (width + gap) * (c + 1) / columns - gap;

			part->camera = scene->cameras[def->cells[cell]];
			part->at_px[0] = left;
			part->at_px[1] = top;
			resize(&part->camera, right > left ? right - left : 1,
			       bottom > top ? bottom - top : 1);
			part->camera.fps = film->camera.fps;
			rb_camera_take_speed(&part->camera, &film->camera);
			part->camera.from_s = film->camera.from_s;
			part->camera.to_s = film->camera.to_s;
			part->camera.single = film->camera.single;
			part->camera.film_from_s = film->camera.film_from_s;
			part->camera.film_to_s = film->camera.film_to_s;
		}
	}
	return true;
}

/* A camera that cannot know how bodies will move stands where it sees the start. */
static void frame_start(const struct rb_films *films, struct rb_camera_def *camera,
                        const char *label)
{
	struct rb_framing start;
	char left_out[1];

	if (rb_framing_init(&start, films->loaded->model, NULL) == RB_OK)
		(void)rb_framing_aim(&start, camera, left_out, sizeof left_out);
	rb_framing_release(&start);
	rb_log(RB_LOG_WARNING,
	       "%s has no 'position', and without a recording it cannot know where "
	       "bodies move: it shows the start",
	       label);
}

/* Asks for the times of the pictures, where the speed is a function. */
static enum rb_status list_pictures(struct rb_films *films, struct film *film,
                                    const struct rb_films_wish *wish, struct rb_error *err)
{
	struct rb_camera_def *const camera = &film->camera;
	const struct rb_schedule schedule = rb_schedule_of(camera, films->loaded->model->frame_rate,
	                                                   wish->end_s);

	if (!camera->speed_varies)
		return RB_OK;
	struct rb_picture_times times = {.fps = schedule.fps, .to_s = schedule.to_s};
	const enum rb_status status = rb_script_pictures(films->loaded->script, camera, &times,
	                                                 err);
	film->picture_s = times.picture_s;
	camera->picture_s = times.picture_s;
	camera->picture_count = times.count;
	return status;
}

void rb_film_choice_forget(struct film *film)
{
	rb_memory_free(film->cells);
	rb_memory_free(film->picture_s);
	*film = (struct film){0};
}

/* Adds a camera, or a film of several. */
static enum rb_status add(struct rb_films *films, const struct rb_camera_def *camera,
                          const struct rb_film_def *def, int number,
                          const struct rb_films_wish *wish, struct rb_error *err)
{
	struct film *const film = &films->film[films->count++];

	film->camera = *camera;
	apply(&film->camera, wish);
	const enum rb_status status = list_pictures(films, film, wish, err);
	if (status)
		return status;
	if (def && !divide(film, &films->loaded->scene, def))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare films: out of memory");
	film->span = rb_film_span_of(&film->camera, (double)INFINITY);
	if (camera->name)
		snprintf(film->label, sizeof film->label, "%s '%.60s'", def ? "film" : "camera",
		         camera->name);
	else
		snprintf(film->label, sizeof film->label, "%s %d", def ? "film" : "camera",
		         number + 1);
	film->schedule = rb_schedule_of(&film->camera, films->loaded->model->frame_rate,
	                                wish->end_s);
	if (rb_schedule_count(&film->schedule) == 0) {
		rb_log(RB_LOG_WARNING,
		       "%s begins at %.9g s, after the end at %.9g s: it makes no film",
		       film->label, film->schedule.from_s, wish->end_s);
		rb_film_choice_forget(film);
		films->count--;
		return RB_OK;
	}
	for (int c = 0; c < rb_film_camera_count(film); c++) {
		struct rb_camera_def *const one = rb_film_camera(film, c);
		film->late |= one->framed && wish->runs && wish->recording;
		if (one->framed && wish->runs && !wish->recording)
			frame_start(films, one, film->label);
		films->shoots |= rb_camera_has_functions(one);
	}
	return RB_OK;
}

enum rb_status rb_film_choice(struct rb_films *films, const struct rb_films_wish *wish,
                              struct rb_error *err)
{
	const struct rb_scene *const scene = &films->loaded->scene;
	enum rb_status status = check_names(scene, wish->names, err);
	char known[160];

	if (status)
		return status;
	films->film = rb_memory_take((size_t)scene->camera_count + (size_t)scene->film_count + 1,
	                             sizeof *films->film);
	if (!films->film)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare films: out of memory");
	for (int i = 0; i < scene->camera_count && !status; i++) {
		const struct rb_camera_def *const camera = &scene->cameras[i];
		const bool has_output = camera->png || camera->video || wish->output;
		if (has_output && (!wish->names || is_named(wish->names, camera->name)))
			status = add(films, camera, NULL, i, wish, err);
	}
	for (int i = 0; i < scene->film_count && !status; i++) {
		const struct rb_film_def *const def = &scene->films[i];
		if (!wish->names || is_named(wish->names, def->camera.name))
			status = add(films, &def->camera, def, i, wish, err);
	}
	if (!status && scene->camera_count == 0 && wish->fallback && wish->output) {
		const struct rb_camera_def camera = rb_steer_default(films->loaded->model);
		status = add(films, &camera, NULL, 0, wish, err);
	}
	if (status)
		return status;
	if (wish->output && films->count == 0)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--camera' chooses no camera");
	if (wish->output && films->count > 1) {
		list_names(scene, known, sizeof known);
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--output' names one film, and there are %d cameras: choose "
		               "one with --camera (%s)",
		               films->count, known);
	}
	if (films->count > FILMS_MAX)
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"cannot film with %d cameras at once: %d are possible (--camera chooses)",
			films->count, FILMS_MAX);
	return RB_OK;
}

/* A name without what says nothing: "./", double slashes, "%1d" for "%d". False: too long. */
static bool plain_name(const char *name, char out[NAME_SIZE])
{
	size_t used = 0;

	for (const char *at = name; *at; at++) {
		const bool begins = at == name || at[-1] == '/';
		if (begins && at[0] == '.' && at[1] == '/')
			at++;
		else if (begins && at != name && at[0] == '/')
			continue;
		else if (used + 1 < NAME_SIZE)
			out[used++] = *at;
		else
			return false;
		if (at[0] == '%' && at[1] == '1' && at[2] == 'd')
			at++;
	}
	out[used] = '\0';
	return true;
}

/* Where a name leads: the real folder, as far as it is there, and the last part. */
static bool settle_name(const char *name, char out[NAME_SIZE])
{
	char plain[NAME_SIZE];

	if (!plain_name(name, plain))
		return false;
	char *const slash = strrchr(plain, '/');
	const char *const base = slash ? slash + 1 : plain;
	if (slash)
		*slash = '\0';
	char *const real = realpath(slash ? plain : ".", NULL);
	const int size = snprintf(out, NAME_SIZE, "%s/%s", real ? real : plain, base);
	free(real);
	return size > 0 && size < NAME_SIZE;
}

static bool same(const char *a, const char *b)
{
	char settled[2][NAME_SIZE];

	return a && b && settle_name(a, settled[0]) && settle_name(b, settled[1]) &&
	       strcmp(settled[0], settled[1]) == 0;
}

enum rb_status rb_film_choice_check_outputs(const struct rb_films *films,
                                            const struct rb_films_wish *wish, struct rb_error *err)
{
	for (int i = 0; i < films->count; i++) {
		const struct rb_camera_def *const camera = &films->film[i].camera;
		if (same(camera->png, wish->recording) || same(camera->video, wish->recording))
			return RB_FAIL(err, RB_ERR_USAGE,
			               "%s writes to '%s', which is the recording",
			               films->film[i].label, wish->recording);
	}
	for (int i = 0; i < films->count; i++)
		for (int k = 0; k < i; k++) {
			const struct rb_camera_def *const a = &films->film[k].camera;
			const struct rb_camera_def *const b = &films->film[i].camera;
			if (same(a->png, b->png) || same(a->video, b->video))
				return RB_FAIL(err, RB_ERR_SCENE,
				               "%s:%d: %s writes to '%s', as %s does in line %d",
				               films->loaded->scene.file, b->line,
				               films->film[i].label,
				               same(a->png, b->png) ? b->png : b->video,
				               films->film[k].label, a->line);
		}
	return RB_OK;
}
