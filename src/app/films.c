/* SPDX-License-Identifier: MIT */
#include "app/films.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "app/films_inside.h"
#include "app/recorded.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/place.h"
#include "base/team.h"
#include "flow/frame.h"
#include "flow/framing.h"

/* Whether a film is made now: with the run, or behind it. */
static bool works(const struct rb_films *films, const struct film *film)
{
	return film->late == films->late;
}

int rb_films_count(const struct rb_films *films)
{
	return films ? films->count : 0;
}

static struct rb_film_options options_of(const struct rb_films *films, int number,
                                         const struct rb_films_wish *wish)
{
	const int spare = rb_team_processors() / films->count;

	return (struct rb_film_options){
		.model = films->loaded->model,
		.camera = &films->film[number].camera,
		.cells = films->film[number].cells,
		.cell_count = films->film[number].cell_count,
		.still = wish->still,
		.number = number,
		.end_s = wish->end_s,
		.patience_s = wish->patience_s,
		.how = (wish->replace ? RB_PLACE_REPLACE : 0) |
	               (wish->output || wish->trust ? 0 : RB_PLACE_BENEATH),
		.encoder_threads = spare > 1 ? spare : 1,
	};
}

/*
 * Each film has a thread that draws; Mesa's own threads help it where there are more processors
 * than films. Mesa reads this once, when the first context is made; what the user has set holds.
 */
static void share_processors(const struct rb_films *films)
{
	const int processors = rb_team_processors();
	const int each = films->count < processors ? processors / films->count : 0;
	char text[16];

	snprintf(text, sizeof text, "%d", each > 8 ? 8 : each);
	setenv("LP_NUM_THREADS", text, 0);
}

static enum rb_status prepare(struct rb_films *films, const struct rb_films_wish *wish,
                              struct rb_error *err)
{
	enum rb_status status = rb_film_choice(films, wish, err);

	if (status || films->count == 0)
		return status;
	if (wish->runs && !wish->names && !rb_module_has_film()) {
		rb_log(RB_LOG_WARNING, "this program was built without films (WITH_FILM=0): the "
		                       "scene's cameras make none");
		films->count = 0;
		return RB_OK;
	}
	status = rb_film_choice_check_outputs(films, wish, err);
	if (!status)
		status = rb_module_film(&films->module, err);
	if (status)
		return status;
	share_processors(films);
	for (int i = 0; i < films->count; i++) {
		const struct rb_film_options options = options_of(films, i, wish);
		struct film *const film = &films->film[i];
		status = films->module->film_check(&options, err);
		if (!status)
			status = films->module->film_create(&film->film, &film->sink, &options,
			                                    err);
		if (status)
			return status;
	}
	return RB_OK;
}

enum rb_status rb_films_create(struct rb_films **films, struct rb_loaded *loaded,
                               const struct rb_films_wish *wish, struct rb_error *err)
{
	*films = rb_memory_take(1, sizeof **films);
	if (!*films)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare films: out of memory");
	(*films)->loaded = loaded;
	const enum rb_status status = prepare(*films, wish, err);
	if (status || (*films)->count == 0) {
		rb_films_destroy(*films);
		*films = NULL;
	}
	return status;
}

enum rb_status rb_films_one_camera(struct rb_camera_def *camera, struct rb_film_cell **cells,
                                   int *cell_count, struct rb_loaded *loaded,
                                   const struct rb_films_wish *wish, struct rb_error *err)
{
	struct rb_films films = {.loaded = loaded};
	const enum rb_status status = rb_film_choice(&films, wish, err);

	*cells = NULL;
	*cell_count = 0;
	if (!status) {
		*camera = films.film[0].camera;
		camera->speed_varies = false; /* its pictures are chosen by time */
		camera->picture_s = NULL;
		camera->picture_count = 0;
		*cells = films.film[0].cells;
		*cell_count = films.film[0].cell_count;
		films.film[0].cells = NULL;
	}
	for (int c = 0; c < *cell_count; c++)
		rb_camera_take_speed(&(*cells)[c].camera, camera);
	for (int i = 0; i < films.count; i++)
		rb_film_choice_forget(&films.film[i]);
	rb_memory_free(films.film);
	return status;
}

enum rb_status rb_films_frame_camera(struct rb_camera_def *camera, const struct rb_model *model,
                                     const struct rb_hdf5_module *module, struct rb_reader *reader,
                                     const char *label, struct rb_error *err)
{
	const uint64_t count = module->reader_reading(reader)->frame_count;
	struct rb_framing framing;
	struct rb_frame frame;
	char left_out[160];
	uint64_t row = 0;
	enum rb_status status = rb_framing_init(&framing, model, err);

	if (!status)
		status = rb_recorded_row_at(module, reader, camera->from_s, &row, err);
	for (; !status && row < count; row++) {
		status = module->reader_frame(reader, row, &frame, err);
		if (!status)
			(void)rb_framing_see(&framing, &frame);
		if (!status && frame.time_s >= camera->to_s)
			break;
	}
	if (!status && rb_framing_aim(&framing, camera, left_out, sizeof left_out) > 0)
		rb_log(RB_LOG_WARNING, "%s leaves out what flies off: %s", label, left_out);
	rb_framing_release(&framing);
	return status;
}

enum rb_status rb_films_frame(struct rb_films *films, const struct rb_hdf5_module *module,
                              struct rb_reader *reader, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < rb_films_count(films) && !status; i++) {
		struct film *const film = &films->film[i];
		for (int c = 0; c < rb_film_camera_count(film) && !status; c++) {
			struct rb_camera_def *const camera = rb_film_camera(film, c);
			struct rb_camera_def seen = *camera;
			if (!camera->framed || !works(films, film))
				continue;
			seen.from_s = film->span.from_s;
			seen.to_s = film->span.to_s;
			status = rb_films_frame_camera(&seen, films->loaded->model, module, reader,
			                               film->label, err);
			camera->position = seen.position;
			camera->height = seen.height;
			camera->look_at = seen.look_at;
		}
	}
	return status;
}

bool rb_films_begin_late(struct rb_films *films)
{
	bool any = false;

	for (int i = 0; i < rb_films_count(films); i++)
		any |= films->film[i].late;
	if (any)
		films->late = true;
	if (any)
		films->has_last = false;
	return any;
}

void rb_films_destroy(struct rb_films *films)
{
	if (!films)
		return;
	for (int i = 0; i < films->count; i++)
		if (films->film[i].film)
			films->module->film_destroy(films->film[i].film);
	rb_frame_release(&films->last);
	rb_between_release(&films->between);
	for (int i = 0; films->film && i < films->count; i++)
		rb_film_choice_forget(&films->film[i]);
	rb_memory_free(films->switched);
	rb_steering_release(&films->steering);
	rb_memory_free(films->film);
	rb_memory_free(films);
}

unsigned rb_films_fields(const struct rb_films *films)
{
	unsigned fields = 0;

	for (int i = 0; i < rb_films_count(films); i++)
		if (works(films, &films->film[i]))
			fields |= films->film[i].sink.fields;
	if (films && films->shoots) /* handles show all of a frame */
		fields |= RB_FIELD_POSITION | RB_FIELD_ORIENTATION | RB_FIELD_VELOCITY |
		          RB_FIELD_ANGULAR_VELOCITY;
	return fields;
}

unsigned rb_films_missing(const struct rb_model *model, unsigned wanted, unsigned fields)
{
	return model->body_count > 0 ? rb_frame_fields(model, wanted) & ~fields : 0;
}

void rb_films_tell_missing(const struct rb_model *model, const char *name, unsigned wanted,
                           unsigned fields)
{
	static const struct {
		unsigned field;
		const char *what, *then;
	} rows[] = {
		{RB_FIELD_POSITION, "positions", "no film can be made of it"},
		{RB_FIELD_ORIENTATION, "orientations", "films of it show bodies unturned"},
		{RB_FIELD_VELOCITY, "velocities",
	         "films of it show no arrows, and straight lines between frames"},
		{RB_FIELD_ANGULAR_VELOCITY, "angular velocities",
	         "films of it turn bodies the shortest way between frames"},
		{RB_FIELD_CONTACTS, "contacts", "films of it do not show their arrows"},
		{RB_FIELD_JOINTS, "joints", "films of it do not show their forces"},
		{RB_FIELD_EVENTS, "events", "films of it show straight lines between frames"},
	};
	const unsigned missing = rb_films_missing(model, wanted, fields);

	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (missing & rows[i].field)
			rb_log(RB_LOG_WARNING, "'%s' holds no %s ('fields' of record): %s", name,
			       rows[i].what, rows[i].then);
}

void rb_films_tell_unrecorded(const struct rb_loaded *loaded)
{
	const struct rb_scene *const scene = &loaded->scene;
	unsigned wanted = 0;

	for (int i = 0; i < scene->camera_count; i++)
		wanted |= rb_schedule_fields(&scene->cameras[i], loaded->model,
		                             loaded->model->duration_s);
	if (loaded->output)
		rb_films_tell_missing(loaded->model, loaded->output, wanted, scene->record.fields);
}

/* Trails, and the digits of energies, which suit the largest so far. */
static bool has_memory(struct film *film)
{
	bool has = false;

	for (int c = 0; c < rb_film_camera_count(film); c++) {
		const struct rb_camera_def *const camera = rb_film_camera(film, c);
		has |= camera->trail_count > 0 || camera->plot_count > 0 ||
		       camera->overlay & RB_OVERLAY_ENERGY;
	}
	return has;
}

double rb_films_first_s(const struct rb_films *films)
{
	double first_s = (double)INFINITY;

	for (int i = 0; i < rb_films_count(films); i++)
		if (works(films, &films->film[i]))
			first_s = fmin(first_s, has_memory(&films->film[i])
			                                ? 0
			                                : films->film[i].schedule.from_s);
	return first_s;
}

/* ---- at work ---- */

enum rb_status rb_films_start(struct rb_films *films, struct rb_ring *ring,
                              const struct rb_outcome *outcome, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < rb_films_count(films) && !status; i++)
		if (works(films, &films->film[i]))
			status = rb_pump_start(&films->film[i].pump, ring, &films->film[i].sink,
			                       outcome, err);
	return status;
}

/* A camera of a film. */
static struct rb_steering_film steered(const struct rb_films *films, int number, int cell)
{
	return (struct rb_steering_film){films->loaded, rb_film_camera(&films->film[number], cell),
	                                 number, cell};
}

/* The shots of a film's cameras at one of its pictures. */
static enum rb_status shoot_picture(struct rb_films *films, int number,
                                    const struct rb_frame *moment, struct rb_frame *frame,
                                    struct rb_error *err)
{
	struct film *const film = &films->film[number];
	const int cells = rb_film_camera_count(film);
	enum rb_status status = RB_OK;

	for (int c = 0; c < cells && !status; c++) {
		const struct rb_steering_film of = steered(films, number, c);
		struct rb_frame_shot shot = {.camera = number,
		                             .picture = film->next * (uint64_t)cells + (uint64_t)c};

		if (!rb_steering_is_wanted(&films->steering, &of))
			continue;
		status = rb_steering_shot(&films->steering, &of, moment, &shot, err);
		if (!status)
			status = rb_frame_add_shot(frame, &shot, err);
	}
	return status;
}

/* The shots of one film that fall after the frame before and not after this one. */
static enum rb_status shoot(struct rb_films *films, int number, struct rb_frame *frame,
                            struct rb_error *err)
{
	struct film *const film = &films->film[number];
	const uint64_t count = rb_schedule_count(&film->schedule);
	struct rb_frame plain = *frame; /* without shots, which would be copied for each of them */
	enum rb_status status = RB_OK;

	plain.shot_count = 0;
	for (; !status && film->next < count && !atomic_load(&films->cut); film->next++) {
		const double time_s = rb_schedule_time(&film->schedule, film->next);
		const struct rb_frame *moment = frame;
		if (time_s > frame->time_s)
			break;
		if (time_s < frame->time_s) {
			if (!films->has_last || time_s < films->last.time_s)
				continue; /* before the first frame, or before it was moved */
			status = rb_frame_between(&films->between, films->loaded->model,
			                          &films->last, &plain, time_s, err);
			moment = &films->between.frame;
		}
		if (!status)
			status = shoot_picture(films, number, moment, frame, err);
	}
	return status;
}

enum rb_status rb_films_shoot(struct rb_films *films, struct rb_frame *frame, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	frame->shot_count = 0;
	if (!films || (!films->shoots && films->steering.count == 0))
		return RB_OK;
	for (int i = 0; i < films->count && !status; i++) {
		bool wanted = false;
		if (!works(films, &films->film[i]))
			continue;
		for (int c = 0; c < rb_film_camera_count(&films->film[i]) && !status; c++) {
			const struct rb_steering_film of = steered(films, i, c);
			status = rb_steering_advance(&films->steering, &of, frame, err);
			wanted |= rb_steering_is_wanted(&films->steering, &of);
		}
		if (!status && wanted)
			status = shoot(films, i, frame, err);
	}
	struct rb_frame plain = *frame;
	plain.shot_count = 0;
	if (!status)
		status = rb_frame_copy(&films->last, &plain, err);
	films->has_last = true;
	return status;
}

void rb_films_cut(struct rb_films *films, int signal)
{
	for (int i = 0; i < rb_films_count(films); i++)
		if (films->film[i].film)
			films->module->film_cut(films->film[i].film);
	/* last: a frame that lacks shots is then read by nobody */
	if (films)
		atomic_store(&films->cut, signal);
}

enum rb_status rb_films_switch(struct rb_films *films, double time_s, bool on, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	if (rb_films_count(films) == 0 || rb_films_are_on(films) == on)
		return RB_OK;
	if (!rb_memory_reserve(&films->switched, &films->switch_capacity, films->switch_count + 1,
	                       sizeof *films->switched))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot switch films: out of memory");
	for (int i = 0; i < films->count && !status; i++)
		status = films->module->film_switch(films->film[i].film, time_s, on, err);
	if (!status)
		films->switched[films->switch_count++].time_s = time_s;
	return status;
}

/* Whether a command means what has this name; one without a name means all. */
static bool is_meant(const struct rb_player_aim *aim, const char *name)
{
	return !aim->camera[0] || (name && strcmp(name, aim->camera) == 0);
}

enum rb_status rb_films_steer(struct rb_films *films, double time_s,
                              const struct rb_player_aim *aim, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < rb_films_count(films) && !status; i++) {
		struct film *const film = &films->film[i];
		const bool whole = is_meant(aim, film->camera.name);

		for (int c = 0; works(films, film) && c < rb_film_camera_count(film) && !status;
		     c++) {
			const struct rb_steering_film of = steered(films, i, c);
			if (whole || is_meant(aim, of.camera->name))
				status = rb_steering_add(&films->steering, &of, time_s, aim, err);
		}
	}
	return status;
}

bool rb_films_are_on(const struct rb_films *films)
{
	return !films || films->switch_count % 2 == 0;
}

static RB_FIELDS_DEFINE(switch_fields, struct rb_film_switch, RB_FILM_SWITCH_FIELDS);

/* What is loaded is done again, for the films to know of it. */
void rb_films_pack(struct rb_films *films, struct rb_pack *pack)
{
	size_t count = films ? films->switch_count : 0;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(switch_fields()));
	for (size_t k = 0; k < count && !pack->failed; k++) {
		struct rb_film_switch one = {0};

		rb_fields_pack(switch_fields(), pack->loading ? &one : &films->switched[k], 1, NULL,
		               pack);
		if (pack->loading && !pack->failed &&
		    rb_films_switch(films, one.time_s, k % 2 == 1, NULL) != RB_OK)
			rb_pack_fail_memory(pack);
	}
	rb_steering_pack(films ? &films->steering : NULL, rb_films_count(films), pack);
}

/* Pictures are missing, and a signal is why. */
static enum rb_status tell_cut(const struct rb_films *films, struct rb_error *err)
{
	const int signal = films ? atomic_load(&films->cut) : 0;
	bool missing = false;

	for (int i = 0; i < rb_films_count(films); i++)
		missing |= works(films, &films->film[i]) &&
		           rb_film_is_cut_short(&films->film[i].tally);
	if (!signal || !missing)
		return RB_OK;
	return signal == SIGINT
	               ? RB_FAIL(err, RB_ERR_INTERRUPT,
	                         "interrupted by SIGINT: the films are cut short")
	               : RB_FAIL(err, RB_ERR_TERMINATE, "terminated: the films are cut short");
}

enum rb_status rb_films_join(struct rb_films *films, struct rb_error *err)
{
	enum rb_status first = RB_OK;

	for (int i = 0; i < rb_films_count(films); i++) {
		struct film *const film = &films->film[i];
		struct rb_error own = {0};
		if (!film->pump)
			continue;
		film->status = rb_pump_join(film->pump, &own);
		film->pump = NULL;
		film->tally = films->module->film_tally(film->film);
		if (film->status && !first)
			first = RB_FAIL(err, film->status, "%s%s%s",
			                strstr(own.text, ": camera ") ? "" : film->label,
			                strstr(own.text, ": camera ") ? "" : ": ", own.text);
	}
	return first ? first : tell_cut(films, err);
}
