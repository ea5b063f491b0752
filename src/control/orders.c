/* SPDX-License-Identifier: MIT */
/*
 * Each command is a function with the same signature in a table by kind. A command acts on the
 * view, on the run, or on both: with a run attached, play and pause are for all clients, while what
 * concerns only one's own view (seek, speed, camera) never leaves this process. Results and errors
 * become lines of the log.
 */
#include "control/orders.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/visible.h"
#include "film/pixmap.h"
#include "math/vec3.h"
#include "script/load.h"
#include "script/nearest.h"

/* One command at work; all borrowed. */
struct order {
	struct rb_viewer *viewer;
	const struct rb_command *command;
	const char *line; /* as it was given */
	uint64_t now_ns;
	struct rb_error *err;
};

typedef enum rb_status execute(const struct order *order);

/* State of the source as it was last asked. */
static const struct rb_source_status *source_of(const struct order *order)
{
	return rb_source_status(order->viewer->options.source);
}

/* Hands a line to the run and, with `say`, its answer to the log. */
static enum rb_status tell(const struct order *order, const char *line, bool say)
{
	const char *answer;
	const enum rb_status status = rb_source_tell(order->viewer->options.source, line, &answer,
	                                             order->err);

	while (!status && say && *answer) {
		const size_t size = strcspn(answer, "\n");
		rb_viewer_say(order->viewer, "%.*s", (int)size, answer);
		answer += size + (answer[size] == '\n');
	}
	return status;
}

/* ---- going on ---- */

static enum rb_status execute_play(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_source_status *const status = source_of(order);
	enum rb_status told = RB_OK;

	/* also to one that is still making steps, after which it would stand */
	if (status->is_run)
		told = tell(order, "play", false);
	if (!status->grows && rb_viewer_at_end(viewer) && status->row_count > 1)
		rb_viewer_go(viewer, 0, order->now_ns);
	viewer->playing = true;
	rb_viewer_pace(viewer, order->now_ns);
	return told;
}

static enum rb_status execute_pause(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;

	/* the view stops where it is; one that stays with the run does so until that stands */
	if (!(source_of(order)->is_run && viewer->live))
		viewer->playing = false;
	viewer->starved = false;
	return source_of(order)->is_run ? tell(order, "pause", false) : RB_OK;
}

static enum rb_status execute_toggle(const struct order *order)
{
	const struct rb_viewer *const viewer = order->viewer;
	const struct rb_source_status *const status = source_of(order);

	/* steps that somebody else has asked for may have come to their end just now */
	rb_source_ask(viewer->options.source);
	const bool stands = !viewer->playing ||
	                    (status->is_run && status->paused && rb_viewer_at_end(viewer));

	return stands ? execute_play(order) : execute_pause(order);
}

static enum rb_status execute_step(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_source_status *const status = source_of(order);
	const uint64_t by = (uint64_t)order->command->number;
	const uint64_t last = status->row_count > 0 ? status->row_count - 1 : 0;
	const uint64_t to = viewer->row + by;
	char line[64];

	viewer->playing = false;
	if (to <= last || !status->is_run) {
		rb_viewer_go(viewer, to, order->now_ns);
		if (to > last)
			rb_viewer_say(viewer, "that is the last frame");
		return status->is_run && !status->paused ? tell(order, "pause", false) : RB_OK;
	}
	/* the frames that exist are shown from where they are; only the rest is computed */
	snprintf(line, sizeof line, "step %" PRIu64, to - last);
	const enum rb_status told = tell(order, line, false);
	viewer->has_goal = !told;
	viewer->goal = to;
	return told;
}

static enum rb_status execute_back(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const uint64_t by = (uint64_t)order->command->number;

	viewer->playing = false;
	if (by > viewer->row)
		rb_viewer_say(viewer, "that is the first frame");
	rb_viewer_go(viewer, by < viewer->row ? viewer->row - by : 0, order->now_ns);
	return RB_OK;
}

/*
 * The last row that is not after a time but for rounding: the time of a row, computed as a sum of
 * steps, may miss it by an ulp.
 */
static uint64_t row_for(const struct rb_source *source, double time_s)
{
	static const double rounding = 1e-6; /* of the time from row to row */
	const uint64_t row = rb_source_row_at(source, time_s);
	const double next_s = rb_source_time(source, row + 1);

	return next_s - time_s <= rounding * (next_s - rb_source_time(source, row)) ? row + 1 : row;
}

static enum rb_status execute_seek(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_source_status *const status = source_of(order);
	const double value = order->command->number;
	const double time_s = order->command->is_percent ? 0.01 * value * status->duration_s
	                                                 : value;

	/* to the nearest there is; then why it was not reached */
	rb_viewer_go(viewer, row_for(viewer->options.source, time_s), order->now_ns);
	if (time_s > status->duration_s)
		rb_viewer_say(viewer, "the run is %.6g s long", status->duration_s);
	else if (time_s > status->end_s && status->grows)
		rb_viewer_say(viewer, "frames reach to %.6g s so far", status->end_s);
	return RB_OK;
}

static enum rb_status execute_speed(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;

	/* far from where one would see anything, and numbers would overflow */
	viewer->speed = fmin(fmax(order->command->number, 1e-12), 1e12);
	viewer->live = false;
	rb_viewer_pace(viewer, order->now_ns);
	rb_viewer_say(viewer, "speed %.4g", viewer->speed);
	return RB_OK;
}

static enum rb_status execute_restart(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;

	if (source_of(order)->is_run)
		return tell(order, "restart", false);
	if (!viewer->options.run)
		return RB_FAIL(order->err, RB_ERR_USAGE,
		               "'restart' needs a run that goes on, this is a recording");
	viewer->wish = RB_VIEWER_RESTARTS;
	return RB_OK;
}

static enum rb_status execute_stop(const struct order *order)
{
	order->viewer->stops = order->command->is_on;
	rb_viewer_say(order->viewer, "stop at collision %s", order->command->is_on ? "on" : "off");
	return source_of(order)->is_run ? tell(order, order->line, false) : RB_OK;
}

static enum rb_status execute_next(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const bool forward = order->command->kind == RB_COMMAND_NEXT;
	uint64_t row;

	if (!rb_source_collision(viewer->options.source, viewer->row, forward, &row))
		return RB_FAIL(order->err, RB_ERR_USAGE, "there is no collision %s this frame",
		               forward ? "after" : "before");
	viewer->playing = false;
	rb_viewer_go(viewer, row, order->now_ns);
	rb_viewer_say(viewer, "%" PRIu64 " %s before frame %" PRIu64,
	              viewer->frame.numbers.collisions,
	              viewer->frame.numbers.collisions == 1 ? "collision" : "collisions",
	              viewer->frame.index);
	return RB_OK;
}

static enum rb_status execute_view(const struct order *order)
{
	order->viewer->playing = order->command->is_on;
	rb_viewer_pace(order->viewer, order->now_ns);
	return RB_OK;
}

/* ---- bodies ---- */

/* Whether a text has a part, regardless of upper and lower case of ASCII. */
static bool holds(const char *text, const char *part)
{
	const size_t size = strlen(part);

	for (; *text; text++) {
		size_t i = 0;
		while (i < size &&
		       tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
			i++;
		if (i == size)
			return true;
	}
	return false;
}

int rb_order_find_body(const struct rb_viewer *viewer, const char *name, bool part)
{
	const struct rb_scene *const scene = viewer->options.model->scene;

	for (int id = 0; id < scene->body_count; id++)
		if (scene->bodies[id].name && strcmp(scene->bodies[id].name, name) == 0)
			return id;
	if (name[0] == '#' && name[1] && name[1 + strspn(name + 1, "0123456789")] == '\0' &&
	    strlen(name) < 10 && atoi(name + 1) < scene->body_count)
		return atoi(name + 1);
	for (int id = 0; part && *name && id < scene->body_count; id++)
		if (scene->bodies[id].name && holds(scene->bodies[id].name, name))
			return id;
	return -1;
}

/* Id of the body that the command names; RB_ERR_USAGE with the nearest name where there is none. */
static enum rb_status need_body(const struct order *order, int *id)
{
	const struct rb_scene *const scene = order->viewer->options.model->scene;
	struct rb_nearest nearest = rb_nearest_to(order->command->text);
	char hint[96];

	*id = rb_order_find_body(order->viewer, order->command->text, false);
	if (*id >= 0)
		return RB_OK;
	for (int i = 0; i < scene->body_count; i++)
		if (scene->bodies[i].name)
			rb_nearest_offer(&nearest, scene->bodies[i].name,
			                 strlen(scene->bodies[i].name));
	return RB_FAIL(order->err, RB_ERR_USAGE, "there is no body '%.80s'%s", order->command->text,
	               nearest.best[0] ? rb_nearest_hint(&nearest, hint) : "");
}

/* A vector in columns, so that the numbers of several lines stand below each other. */
static void print_vector(char out[96], const char *name, const double *v, const char *unit)
{
	snprintf(out, 96, "%-8s %8.3g %8.3g %8.3g %s", name, v[0], v[1], v[2], unit);
}

bool rb_order_body_line(const struct rb_viewer *viewer, int id, int line, char out[96])
{
	const struct rb_model *const model = viewer->options.model;
	const struct rb_frame *const frame = &viewer->frame;
	const int index = model->index_of[id];
	const bool moves = index < model->body_count;
	double at[3];
	char label[64];

	RB_ASSERT(id >= 0 && id < viewer->options.model->scene->body_count);
	out[0] = '\0';
	switch (line) {
	case 0:
		snprintf(out, 96, "%s  %s, %s", rb_scene_body_label(model->scene, id, label),
		         model->scene->bodies[id].call,
		         !moves                                  ? "at rest for good"
		         : model->driven && model->driven[index] ? "driven"
		                                                 : "moving");
		return true;
	case 1:
		rb_vec3_to(at, rb_steer_body(model, frame, id));
		print_vector(out, "position", at, "m");
		return true;
	case 2:
		if (moves && frame->velocity)
			print_vector(out, "velocity", frame->velocity + 3 * index, "m/s");
		return moves;
	case 3:
		if (moves && frame->angular_velocity)
			print_vector(out, "turning", frame->angular_velocity + 3 * index, "rad/s");
		return moves;
	case 4:
		if (moves && isfinite(model->mass[index]))
			snprintf(out, 96, "%-8s %8.4g kg", "mass", model->mass[index]);
		return moves;
	default:
		return false;
	}
}

static enum rb_status execute_body(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	int id;
	const enum rb_status status = need_body(order, &id);
	char line[96];

	if (status)
		return status;
	viewer->inspected = id;
	viewer->picture++;
	for (int i = 0; rb_order_body_line(viewer, id, i, line); i++)
		if (*line)
			rb_viewer_say(viewer, "%s", line);
	return RB_OK;
}

static enum rb_status execute_follow(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_stand stand = rb_viewer_stand(viewer);
	int id = -1;

	if (order->command->text[0]) {
		const enum rb_status status = need_body(order, &id);
		if (status)
			return status;
	}
	rb_steer_follow(&viewer->camera, &stand, id);
	viewer->followed = id;
	viewer->camera_moved = true;
	rb_viewer_aim(viewer);
	return RB_OK;
}

/* ---- cameras ---- */

/* Takes the camera of the scene that the command names. */
static enum rb_status name_camera(const struct order *order)
{
	const struct rb_scene *const scene = order->viewer->options.model->scene;
	struct rb_nearest nearest = rb_nearest_to(order->command->text);
	char hint[96];

	for (int i = 0; i < scene->camera_count; i++) {
		const char *const name = scene->cameras[i].name;
		if (name && strcmp(name, order->command->text) == 0) {
			rb_viewer_take_camera(order->viewer, i);
			return RB_OK;
		}
		if (name)
			rb_nearest_offer(&nearest, name, strlen(name));
	}
	return RB_FAIL(order->err, RB_ERR_USAGE, "there is no camera '%.80s'%s",
	               order->command->text,
	               nearest.best[0] ? rb_nearest_hint(&nearest, hint) : "");
}

static enum rb_status execute_camera(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_command *const command = order->command;
	const struct rb_stand stand = rb_viewer_stand(viewer);
	enum rb_status status = RB_OK;
	rb_vec3 at = {0, 0, 0};
	int id = -1;

	switch (command->action) {
	case RB_CAMERA_NAMED:
		return name_camera(order);
	case RB_CAMERA_ALL:
		rb_viewer_show_all(viewer);
		return RB_OK;
	case RB_CAMERA_MOVE:
		rb_steer_move(&viewer->camera, &stand, rb_vec3_from(command->vector));
		break;
	case RB_CAMERA_ORBIT:
		rb_steer_orbit(&viewer->camera, &stand, command->vector[0], command->vector[1]);
		break;
	case RB_CAMERA_ZOOM:
		rb_steer_zoom(&viewer->camera, &stand, command->number);
		break;
	case RB_CAMERA_MOUNT:
	default:
		if (command->text[0])
			status = need_body(order, &id);
		if (status)
			return status;
		if (id >= 0)
			at = rb_steer_body(viewer->options.model, &viewer->frame, id);
		rb_steer_mount(&viewer->camera, &stand, id, at);
		break;
	}
	viewer->camera_moved = true;
	rb_viewer_aim(viewer);
	return RB_OK;
}

/* ---- pictures ---- */

static enum rb_status execute_snapshot(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_film_module *film;
	struct rb_camera_def camera = viewer->camera;
	struct rb_take *take = NULL;
	struct rb_pixmap picture;
	char path[RB_COMMAND_TEXT_SIZE];
	size_t bytes;

	snprintf(path, sizeof path, "%s", order->command->text);
	if (!*path)
		snprintf(path, sizeof path, "snapshot-%06" PRIu64 ".png", viewer->frame.index);
	camera.trail_count = 0; /* which take the frames before this one */
	enum rb_status status = rb_module_film(&film, order->err);
	if (status)
		return status;
	status = film->take_create(&take, viewer->options.model, &camera, order->err);
	if (!status)
		status = film->take_draw(take, &viewer->frame,
		                         viewer->has_shot ? &viewer->shot : NULL, &picture,
		                         order->err);
	if (!status)
		status = film->png_write(path, false, &picture, NULL, &bytes, order->err);
	if (take)
		film->take_destroy(take);
	if (!status)
		rb_viewer_say(viewer, "%s: %d x %d pixels, %zu bytes", path, camera.size_px[0],
		              camera.size_px[1], bytes);
	return status;
}

/* ---- telling ---- */

/* Hands a command that only a run can serve to it, or says that there is none. */
static enum rb_status execute_for_run(const struct order *order)
{
	if (!source_of(order)->is_run)
		return RB_FAIL(order->err, RB_ERR_USAGE, "'%s' needs a run that goes on, %s",
		               rb_commands[order->command->kind].name,
		               order->viewer->options.run ? "this one has ended"
		                                          : "this is a recording");
	return tell(order, order->line, true);
}

/*
 * A run of one's own may have ended before the value is typed, or end before it is started again:
 * the value is kept here, too.
 */
static enum rb_status execute_set(const struct order *order)
{
	const struct rb_command *const command = order->command;
	struct rb_viewer_run *const run = order->viewer->options.run;
	const bool goes_on = source_of(order)->is_run;
	enum rb_status status = RB_OK;

	if (goes_on || !run)
		status = execute_for_run(order);
	else
		status = rb_script_check_param(order->viewer->options.model->scene, command->text,
		                               command->value, order->err);
	if (status || !run)
		return status;
	const char *const kept = rb_session_keep_set(run->sets, &run->set_count, command->text,
	                                             command->value, order->err);
	if (!kept)
		return RB_ERR_USAGE;
	if (!goes_on)
		rb_viewer_say(order->viewer, "%s from the next restart on", kept);
	return RB_OK;
}

static enum rb_status execute_status(const struct order *order)
{
	struct rb_viewer *const viewer = order->viewer;
	const struct rb_source_status *const status = source_of(order);
	const struct rb_lateness *const late = &viewer->lateness;

	rb_viewer_say(viewer,
	              "%s, %s at speed %.4g: t = %.6g s, frame %" PRIu64 " of %" PRIu64 ", %" PRIu64
	              " %s drawn",
	              status->state, rb_viewer_state(viewer), viewer->speed, viewer->frame.time_s,
	              viewer->frame.index, status->frame_count > 0 ? status->frame_count - 1 : 0,
	              viewer->drawn_count,
	              rb_text_plural(viewer->drawn_count, "picture", "pictures"));
	char step[48] = "";
	if (status->smallest_step_s > 0)
		snprintf(step, sizeof step, "smallest step %.3g s, ", status->smallest_step_s);
	rb_viewer_say(viewer, "%" PRIu64 " %s, %" PRIu64 " %s, %soverlap up to %.3g m",
	              status->collisions,
	              rb_text_plural(status->collisions, "collision", "collisions"),
	              status->rollbacks, rb_text_plural(status->rollbacks, "rollback", "rollbacks"),
	              step, status->max_penetration_m);
	rb_viewer_say(
		viewer,
		"%" PRIu64 " %s shown, %" PRIu64
		" passed over; late %.2f ms on average, 99 %% within %.1f ms, drift %.3f ms/s",
		late->count, rb_text_plural(late->count, "frame", "frames"), late->skipped,
		1e3 * rb_lateness_mean(late), 1e3 * rb_lateness_within(late, 0.99),
		1e3 * rb_lateness_drift(late));
	return RB_OK;
}

static enum rb_status execute_help(const struct order *order)
{
	const struct rb_command_row *row = NULL;

	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++)
		if (strcmp(rb_commands[i].name, order->command->text) == 0)
			row = &rb_commands[i];
	if (row)
		rb_viewer_say(order->viewer, "%s%s%s: %s", row->name, *row->arguments ? " " : "",
		              row->arguments, row->help);
	order->viewer->wants_help = !row;
	return RB_OK;
}

static enum rb_status execute_quit(const struct order *order)
{
	order->viewer->wish = RB_VIEWER_QUITS;
	return RB_OK;
}

/* What each kind does; the parser has no others. */
static execute *const executes[RB_COMMAND_KIND_COUNT] = {
	[RB_COMMAND_PLAY] = execute_play,     [RB_COMMAND_PAUSE] = execute_pause,
	[RB_COMMAND_TOGGLE] = execute_toggle, [RB_COMMAND_STEP] = execute_step,
	[RB_COMMAND_BACK] = execute_back,     [RB_COMMAND_SEEK] = execute_seek,
	[RB_COMMAND_SPEED] = execute_speed,   [RB_COMMAND_RESTART] = execute_restart,
	[RB_COMMAND_STOP] = execute_stop,     [RB_COMMAND_NEXT] = execute_next,
	[RB_COMMAND_PREVIOUS] = execute_next, [RB_COMMAND_FOLLOW] = execute_follow,
	[RB_COMMAND_CAMERA] = execute_camera, [RB_COMMAND_SNAPSHOT] = execute_snapshot,
	[RB_COMMAND_FILM] = execute_for_run,  [RB_COMMAND_CHECKPOINT] = execute_for_run,
	[RB_COMMAND_BODY] = execute_body,     [RB_COMMAND_SET] = execute_set,
	[RB_COMMAND_VIEW] = execute_view,     [RB_COMMAND_STATUS] = execute_status,
	[RB_COMMAND_HELP] = execute_help,     [RB_COMMAND_QUIT] = execute_quit,
};

/* Whether a command makes sense before anything is shown. */
static bool is_early(enum rb_command_kind kind)
{
	return kind == RB_COMMAND_PLAY || kind == RB_COMMAND_PAUSE || kind == RB_COMMAND_TOGGLE ||
	       kind == RB_COMMAND_HELP || kind == RB_COMMAND_QUIT || kind == RB_COMMAND_SPEED ||
	       kind == RB_COMMAND_STOP || kind == RB_COMMAND_RESTART;
}

enum rb_status rb_order(struct rb_viewer *viewer, const char *line, uint64_t now_ns)
{
	struct rb_command command;
	struct rb_error err;
	bool given;
	const struct order order = {viewer, &command, line, now_ns, &err};
	enum rb_status status = rb_command_parse(&command, &given, line, &err);

	if (!status && given && !viewer->has_frame && !is_early(command.kind))
		status = RB_FAIL(&err, RB_ERR_USAGE, "'%s': there is no frame yet",
		                 rb_commands[command.kind].name);
	RB_ASSERT(status || !given ||
	          (command.kind < RB_COMMAND_KIND_COUNT && executes[command.kind]));
	if (!status && given)
		status = executes[command.kind](&order);
	if (status)
		rb_viewer_say(viewer, "%s", err.text);
	return status;
}

const char *rb_order_name(void *user, enum rb_command_kind kind, int index)
{
	const struct rb_viewer *const viewer = user;
	const struct rb_scene *const scene = viewer->options.model->scene;
	const char *name = NULL;

	switch (kind) {
	case RB_COMMAND_BODY:
	case RB_COMMAND_FOLLOW:
		if (index < scene->body_count)
			name = scene->bodies[index].name ? scene->bodies[index].name : "";
		break;
	case RB_COMMAND_CAMERA:
		if (index < scene->camera_count)
			name = scene->cameras[index].name ? scene->cameras[index].name : "";
		break;
	case RB_COMMAND_SET:
		if (index < scene->param_count)
			name = scene->params[index].name;
		break;
	default:
		break;
	}
	return name;
}
