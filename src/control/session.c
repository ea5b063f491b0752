/* SPDX-License-Identifier: MIT */
/*
 * One lock makes lines atomic: an answer describes one state, and two clients cannot interleave.
 * The simulator's thread never takes it; it hands frames to the history and requests come to it
 * through the player, so a slow answer costs the run nothing. Attaching and detaching take the
 * lock, which is why nothing of a run is used after it was detached.
 *
 * The log of events has a lock of its own, taken last, because any thread may add to it, also while
 * a line is executed. The last frame that was encoded is cached: many clients ask for the same one.
 */
#include "control/session.h"

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"
#include "control/history.h"
#include "control/wire.h"
#include "flow/frame.h"
#include "model/shape.h"
#include "script/load.h"
#include "script/nearest.h"

/*
 * EVENTS_KEPT: the last ones, for clients that ask now and then; events have no bound over a run.
 * EVENT_SIZE: bytes of a text, longer ones are cut.
 */
enum { EVENTS_KEPT = 256, EVENT_SIZE = 200 };

struct event {
	double time_s;
	char text[EVENT_SIZE];
};

/* The last frame that was asked for, as text: many who watch want the same one. */
struct cached {
	bool valid, all;
	uint64_t index;
	char *text; /* owned */
	size_t size, capacity;
};

struct rb_session {
	/* set before any thread starts, then only read */
	struct rb_player *player;

	/* changed by attaching and detaching, under the lock */
	const struct rb_run_info *info; /* NULL: detached */
	const char *recording;
	struct rb_history
		*history; /* owned; the simulator's thread keeps frames without the lock */

	/* protected by lock: one line at a time */
	pthread_mutex_t lock;
	struct rb_frame frame; /* a copy that is looked at */
	struct cached cached;
	struct rb_session_set *sets; /* owned: [RB_SESSION_SETS_MAX] */
	int set_count;

	/* protected by log_lock, which is taken last */
	pthread_mutex_t log_lock;
	struct event *events; /* owned: [EVENTS_KEPT], number n in [n % EVENTS_KEPT] */
	uint64_t event_count;
};

/* A line being executed. */
struct line {
	struct rb_session *session;
	const char *who;
	struct rb_answer *answer;
	struct rb_error *err;
};

/* ---- life ---- */

enum rb_status rb_session_create(struct rb_session **session, struct rb_player *player,
                                 struct rb_error *err)
{
	struct rb_session *const s = rb_memory_take(1, sizeof *s);

	*session = NULL;
	if (s) {
		s->player = player;
		s->sets = rb_memory_take(RB_SESSION_SETS_MAX, sizeof *s->sets);
		s->events = rb_memory_take(EVENTS_KEPT, sizeof *s->events);
		pthread_mutex_init(&s->lock, NULL);
		pthread_mutex_init(&s->log_lock, NULL);
	}
	if (!s || !s->sets || !s->events) {
		rb_session_destroy(s);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot take commands: out of memory");
	}
	*session = s;
	return RB_OK;
}

void rb_session_destroy(struct rb_session *session)
{
	if (!session)
		return;
	rb_session_detach(session);
	rb_frame_release(&session->frame);
	rb_memory_free(session->cached.text);
	rb_memory_free(session->sets);
	rb_memory_free(session->events);
	pthread_mutex_destroy(&session->lock);
	pthread_mutex_destroy(&session->log_lock);
	rb_memory_free(session);
}

enum rb_status rb_session_attach(struct rb_session *session, const struct rb_run_info *info,
                                 const char *recording, struct rb_error *err)
{
	struct rb_history *history;
	const enum rb_status status = rb_history_create(&history, info->model, err);

	if (status)
		return status;
	pthread_mutex_lock(&session->lock);
	RB_ASSERT(!session->info);
	session->info = info;
	session->recording = recording;
	session->history = history;
	session->cached.valid = false;
	rb_frame_release(&session->frame);
	pthread_mutex_unlock(&session->lock);
	return RB_OK;
}

void rb_session_detach(struct rb_session *session)
{
	pthread_mutex_lock(&session->lock);
	session->info = NULL;
	session->recording = NULL;
	rb_history_destroy(session->history);
	session->history = NULL;
	pthread_mutex_unlock(&session->lock);
}

void rb_session_keep(struct rb_session *session, const struct rb_frame *frame)
{
	RB_ASSERT(session->history != NULL);
	(void)!rb_history_keep(session->history, frame, NULL);
}

/* ---- events ---- */

void rb_session_tell(struct rb_session *session, const char *format, ...)
{
	const struct rb_player_status status = rb_player_status(session->player);
	va_list arguments;

	pthread_mutex_lock(&session->log_lock);
	struct event *const event = &session->events[session->event_count++ % EVENTS_KEPT];
	event->time_s = status.time_s;
	va_start(arguments, format);
	vsnprintf(event->text, sizeof event->text, format, arguments);
	va_end(arguments);
	pthread_mutex_unlock(&session->log_lock);
}

/* Answers with the events from number `from` on that are still kept. */
static void list_events(struct rb_session *session, uint64_t from, struct rb_answer *answer)
{
	pthread_mutex_lock(&session->log_lock);
	const uint64_t count = session->event_count;
	const uint64_t first = count > EVENTS_KEPT ? count - EVENTS_KEPT : 0;
	for (uint64_t n = from > first ? from : first; n < count; n++) {
		const struct event *const event = &session->events[n % EVENTS_KEPT];
		rb_answer_line(answer, "%" PRIu64 " %.9g %s", n, event->time_s, event->text);
	}
	pthread_mutex_unlock(&session->log_lock);
}

/* ---- what is answered ---- */

/* RB_OK while a run is attached. */
static enum rb_status need_run(const struct line *line)
{
	if (line->session->info)
		return RB_OK;
	return RB_FAIL(line->err, RB_ERR_USAGE, "the run is restarting or has ended: try again");
}

void rb_session_title(struct rb_session *session, char out[128])
{
	pthread_mutex_lock(&session->lock);
	const char *title = session->info ? session->info->scene->world.title : "";
	size_t size = 0;
	while (title && title[size] && title[size] != '\t') {
		const size_t one = rb_command_character(title + size);
		if (one == 0 || size + one > 120)
			break;
		size += one;
	}
	snprintf(out, 128, "%.*s", (int)size, title ? title : "");
	pthread_mutex_unlock(&session->lock);
}

/*
 * Answers with the state of the run, one "key value" a line; keys are only ever added, clients skip
 * those they do not know.
 */
static void answer_status(struct line *line)
{
	struct rb_session *const session = line->session;
	struct rb_answer *const answer = line->answer;
	const struct rb_player_status s = rb_player_status(session->player);
	uint64_t first, last;
	struct stat file;

	rb_answer_line(answer, "state %s",
	               s.ended     ? "ended"
	               : s.paused  ? "paused"
	               : s.pausing ? "pausing"
	                           : "playing");
	rb_answer_line(answer, "frame %" PRIu64, s.frame);
	rb_answer_line(answer, "frames %" PRIu64, s.frame_count);
	rb_answer_line(answer, "time %.17g", s.time_s);
	rb_answer_line(answer, "duration %.17g", s.duration_s);
	rb_answer_line(answer, "wall-time %.3f", s.wall_s);
	rb_answer_line(answer, "paused-time %.3f", s.paused_s);
	rb_answer_line(answer, "real-time-factor %.4g", s.wall_s > 0 ? s.time_s / s.wall_s : 0);
	rb_answer_line(answer, "stop-at-collision %s", s.stops_at_collision ? "on" : "off");
	rb_answer_line(answer, "film %s", !s.has_films ? "none" : s.filming ? "on" : "off");
	rb_answer_line(answer, "restarts %" PRIu64, s.restarts);
	rb_answer_line(answer, "collisions %" PRIu64, s.collisions);
	rb_answer_line(answer, "rollbacks %" PRIu64, s.rollbacks);
	rb_answer_line(answer, "smallest-step %.9g", s.smallest_step_s);
	rb_answer_line(answer, "max-penetration %.9g", s.max_penetration_m);
	rb_answer_line(answer, "kinetic-energy %.17g", s.kinetic_energy);
	rb_answer_line(answer, "potential-energy %.17g", s.potential_energy);
	rb_answer_line(answer, "ring %d %d", s.ring_used, s.ring_slots);
	if (session->history && rb_history_range(session->history, &first, &last))
		rb_answer_line(answer, "kept %" PRIu64 " %" PRIu64, first, last);
	if (session->recording && stat(session->recording, &file) == 0)
		rb_answer_line(answer, "recording-bytes %" PRIu64, (uint64_t)file.st_size);
	for (int i = 0; i < session->set_count; i++)
		rb_answer_line(answer, "set %s", session->sets[i].text);
}

/* Answers with what does not change over a run. */
static enum rb_status answer_hello(struct line *line)
{
	const struct rb_session *const session = line->session;
	const enum rb_status status = need_run(line);
	char folder[1024];

	if (status)
		return status;
	const struct rb_run_info *const info = session->info;
	rb_answer_line(line->answer, "protocol %d", RB_SESSION_PROTOCOL);
	rb_answer_line(line->answer, "version %s", info->version);
	rb_answer_line(line->answer, "process %ld", (long)getpid());
	rb_answer_line(line->answer, "host %s", info->host);
	rb_answer_line(line->answer, "started %s", info->started);
	rb_answer_line(line->answer, "scene-file %s", info->scene->file);
	if (getcwd(folder, sizeof folder))
		rb_answer_line(line->answer, "folder %s", folder);
	if (session->recording)
		rb_answer_line(line->answer, "recording %s", session->recording);
	rb_answer_line(line->answer, "method %s", info->method);
	rb_answer_line(line->answer, "bodies %d", info->model->body_count);
	rb_answer_line(line->answer, "statics %d", info->model->static_count);
	rb_answer_line(line->answer, "title %s", info->scene->world.title);
	return RB_OK;
}

/*
 * Adds the line " KEY BASE64 BASE64" of two texts that may hold anything; `b` may be empty, which
 * is "-".
 */
static enum rb_status answer_texts(struct line *line, const char *key, const char *a, const char *b,
                                   size_t b_size)
{
	const size_t a_size = strlen(a);
	const size_t a_text = rb_wire_base64_size(a_size), b_text = rb_wire_base64_size(b_size);
	char *const text = rb_memory_take(a_text + b_text + 8, 1);

	if (!text)
		return RB_FAIL(line->err, RB_ERR_MEMORY, "cannot send the scene: out of memory");
	size_t size = 0;
	rb_wire_base64_write(text, a, a_size);
	size += a_text;
	text[size++] = ' ';
	rb_wire_base64_write(text + size, b, b_size);
	size += b_text;
	if (b_size == 0)
		text[size++] = '-';
	text[size++] = '\n';
	rb_answer_put(line->answer, " ", 1);
	rb_answer_put(line->answer, key, strlen(key));
	rb_answer_put(line->answer, " ", 1);
	rb_answer_put(line->answer, text, size);
	rb_memory_free(text);
	return RB_OK;
}

/*
 * Answers with all that is needed to load the scene elsewhere as this run did: numbers, parameters
 * and the texts of its files.
 */
static enum rb_status answer_scene(struct line *line)
{
	enum rb_status status = need_run(line);

	if (status)
		return status;
	const struct rb_scene *const scene = line->session->info->scene;
	const struct rb_model *const model = line->session->info->model;
	rb_answer_line(line->answer, "bodies %d %d", model->body_count, model->static_count);
	rb_answer_line(line->answer, "duration %.17g", model->duration_s);
	rb_answer_line(line->answer, "frame-rate %.17g", model->frame_rate);
	rb_answer_line(line->answer, "time-step %.17g", model->time_step_s);
	rb_answer_line(line->answer, "tolerance %.17g", model->tolerance_m);
	rb_answer_line(line->answer, "stepped-tolerance %.17g", model->stepped_tolerance_m);
	rb_answer_line(line->answer, "seed %" PRIu64, scene->world.seed);
	for (int i = 0; !status && i < scene->param_count; i++)
		status = answer_texts(line, "param", scene->params[i].name,
		                      scene->params[i].value_text,
		                      strlen(scene->params[i].value_text));
	for (int i = 0; !status && i < scene->file_count; i++)
		status = answer_texts(line, "file", scene->files[i].name, scene->files[i].text,
		                      scene->files[i].size_bytes);
	return status;
}

/* Answers with the collisions by parts of the run's time, as one digit each. */
static void answer_timeline(struct line *line)
{
	const struct rb_player_status s = rb_player_status(line->session->player);
	char marks[RB_PLAYER_PARTS + 1];

	/* one digit a part, of the number of binary digits that its count has */
	for (int i = 0; i < RB_PLAYER_PARTS; i++) {
		int bits = 0;
		for (uint64_t n = s.part[i]; n > 0; n >>= 1)
			bits++;
		marks[i] = (char)('0' + (bits < 9 ? bits : 9));
	}
	marks[RB_PLAYER_PARTS] = '\0';
	rb_answer_line(line->answer, "collisions %s", marks);
}

/* ---- frames ---- */

/* Answers with a frame, RB_HISTORY_NEWEST: the newest; without `all` without velocities. */
static enum rb_status answer_frame(struct line *line, uint64_t index, bool all)
{
	struct rb_session *const session = line->session;
	struct cached *const cached = &session->cached;
	uint64_t first, last;

	(void)rb_history_range(session->history, &first, &last);
	const uint64_t wanted = index == RB_HISTORY_NEWEST ? last : index;
	if (!cached->valid || cached->index != wanted || cached->all != all) {
		cached->valid = false;
		/* by now it may be gone: so the newest is asked for as such */
		enum rb_status status = rb_history_copy(session->history, index, &session->frame,
		                                        line->err);
		if (status)
			return status;
		struct rb_frame part = session->frame;
		if (!all)
			part.velocity = part.angular_velocity = NULL;
		status = rb_wire_write_frame(&cached->text, &cached->capacity, &cached->size, &part,
		                             line->err);
		if (status)
			return status;
		cached->valid = true;
		cached->index = part.index;
		cached->all = all;
	}
	rb_answer_put(line->answer, " ", 1);
	rb_answer_put(line->answer, cached->text, cached->size);
	rb_answer_put(line->answer, "\n", 1);
	return RB_OK;
}

/* A number of a frame or an event, of at most 18 digits. False: it is none. */
static bool whole(const char *text, uint64_t *value)
{
	if (!*text || text[strspn(text, "0123456789")] != '\0' || strlen(text) > 18)
		return false;
	*value = strtoull(text, NULL, 10);
	return true;
}

/*
 * The words frame [N] [all] and newer N [all]; `words` are those behind the first. newer answers at
 * once, with nothing where there is nothing newer.
 */
static enum rb_status serve_frame(struct line *line, bool newer, char *const *words, int count)
{
	enum rb_status status = need_run(line);
	const bool all = count > 0 && strcmp(words[count - 1], "all") == 0;
	const int numbers = count - all;
	uint64_t index = 0, first, last;

	if (status)
		return status;
	if (numbers > 1 || (newer && numbers < 1) || (numbers == 1 && !whole(words[0], &index)))
		return RB_FAIL(line->err, RB_ERR_USAGE, "'%s': usage: %s",
		               newer ? "newer" : "frame",
		               newer ? "newer N [all]" : "frame [N] [all]");
	const bool some = rb_history_range(line->session->history, &first, &last);
	if (newer && (!some || last == index))
		return RB_OK;
	return answer_frame(line, newer || numbers == 0 ? RB_HISTORY_NEWEST : index, all);
}

/* ---- bodies ---- */

/* Id of a body by name, or by "#3"; -1: there is none. */
static int find_body(const struct rb_scene *scene, const char *name)
{
	uint64_t id;

	for (int i = 0; i < scene->body_count; i++)
		if (scene->bodies[i].name && strcmp(scene->bodies[i].name, name) == 0)
			return i;
	if (name[0] == '#' && whole(name + 1, &id) && id < (uint64_t)scene->body_count)
		return (int)id;
	return -1;
}

/* Fails with the nearest name. */
static enum rb_status no_body(struct line *line, const char *name)
{
	const struct rb_scene *const scene = line->session->info->scene;
	struct rb_nearest nearest = rb_nearest_to(name);
	char hint[96];

	for (int i = 0; i < scene->body_count; i++)
		if (scene->bodies[i].name)
			rb_nearest_offer(&nearest, scene->bodies[i].name,
			                 strlen(scene->bodies[i].name));
	return RB_FAIL(line->err, RB_ERR_USAGE, "there is no body '%.60s'%s", name,
	               rb_nearest_hint(&nearest, hint));
}

/*
 * Queues a movement of a film's camera for the simulator's thread. Only for cameras whose film is
 * drawn during the run.
 */
static enum rb_status move_film(const struct line *line, const struct rb_command *command)
{
	struct rb_player_movable movable = {.name = command->text,
	                                    .nearest = rb_nearest_to(command->text)};
	struct rb_player_aim aim = {.action = command->action, .factor = command->number};
	char hint[96];

	const struct rb_scene *const scene = line->session->info->scene;
	int films = scene->film_count;
	for (int i = 0; i < scene->camera_count; i++)
		films += scene->cameras[i].png || scene->cameras[i].video;
	rb_player_consider_films(&movable, scene);
	if (!command->text[0] && films != 1)
		return RB_FAIL(line->err, RB_ERR_USAGE,
		               "'film': %d cameras make films; name the one to move", films);
	if (!movable.found)
		return RB_FAIL(line->err, RB_ERR_USAGE, "'film': no camera '%.60s' makes one%s",
		               command->text, rb_nearest_hint(&movable.nearest, hint));
	if (!movable.early)
		return RB_FAIL(line->err, RB_ERR_USAGE,
		               "'film': camera '%.60s' has no 'position': its film is drawn when "
		               "the run has ended",
		               command->text);
	snprintf(aim.camera, sizeof aim.camera, "%s", command->text);
	memcpy(aim.vector, command->vector, sizeof aim.vector);
	if (!rb_player_aim(line->session->player, &aim))
		return RB_FAIL(line->err, RB_ERR_USAGE,
		               "'film': %d movements wait for the next frame already",
		               RB_PLAYER_AIMS_MAX);
	return RB_OK;
}

/* A line with three or four numbers in full. */
static void put_vector(struct rb_answer *answer, const char *key, const double *v, int count)
{
	RB_ASSERT(count == 3 || count == 4);
	if (count == 4)
		rb_answer_line(answer, "%s %.17g %.17g %.17g %.17g", key, v[0], v[1], v[2], v[3]);
	else
		rb_answer_line(answer, "%s %.17g %.17g %.17g", key, v[0], v[1], v[2]);
}

/* A line that describes a shape. */
static void put_shape(struct rb_answer *answer, const struct rb_solid *solids,
                      const struct rb_shape *shape)
{
	char text[160];

	rb_shape_text(solids, shape, text);
	rb_answer_line(answer, "shape %s", text);
}

/* Lines about a moving body at the session's frame. */
static void put_moving(struct line *line, int index)
{
	const struct rb_model *const model = line->session->info->model;
	const struct rb_frame *const frame = &line->session->frame;
	struct rb_answer *const answer = line->answer;
	const size_t i = (size_t)index;
	const bool driven = model->driven && model->driven[index];

	RB_ASSERT(index >= 0 && index < line->session->info->model->body_count);
	rb_answer_line(answer, "moves %s", driven ? "driven" : "yes");
	put_shape(answer, model->scene->solids, &model->shape[index]);
	if (!driven)
		rb_answer_line(answer, "mass %.17g", model->mass[index]);
	rb_answer_line(answer, "frame %" PRIu64, frame->index);
	rb_answer_line(answer, "time %.17g", frame->time_s);
	if (frame->position)
		put_vector(answer, "position", frame->position + 3 * i, 3);
	if (frame->orientation)
		put_vector(answer, "orientation", frame->orientation + 4 * i, 4);
	if (frame->velocity)
		put_vector(answer, "velocity", frame->velocity + 3 * i, 3);
	if (frame->angular_velocity)
		put_vector(answer, "angular-velocity", frame->angular_velocity + 3 * i, 3);
}

/* Lines about a body that never moves, which frames do not hold. */
static void put_static(struct line *line, int index)
{
	const struct rb_model *const model = line->session->info->model;
	const rb_vec3 p = model->position[index];
	const rb_quat q = model->orientation[index];

	RB_ASSERT(index >= line->session->info->model->body_count);
	rb_answer_line(line->answer, "moves no");
	put_shape(line->answer, model->scene->solids, &model->shape[index]);
	put_vector(line->answer, "position", (const double[]){p.x, p.y, p.z}, 3);
	put_vector(line->answer, "orientation", (const double[]){q.w, q.x, q.y, q.z}, 4);
}

/* Answers with the numbers of a body at the newest frame. */
static enum rb_status answer_body(struct line *line, const char *name)
{
	struct rb_session *const session = line->session;
	enum rb_status status = need_run(line);
	char label[64];

	if (status)
		return status;
	const struct rb_model *const model = session->info->model;
	const int id = find_body(session->info->scene, name);
	if (id < 0)
		return no_body(line, name);
	const int index = model->index_of[id];
	if (index < model->body_count) {
		status = rb_history_copy(session->history, RB_HISTORY_NEWEST, &session->frame,
		                         line->err);
		if (status)
			return status;
	}
	rb_answer_line(line->answer, "body #%d", id);
	rb_answer_line(line->answer, "name %s",
	               rb_scene_body_label(session->info->scene, id, label));
	if (index < model->body_count)
		put_moving(line, index);
	else
		put_static(line, index);
	return RB_OK;
}

/* ---- parameters ---- */

int rb_session_sets(struct rb_session *session, struct rb_session_set *out)
{
	pthread_mutex_lock(&session->lock);
	const int count = session->set_count;
	memcpy(out, session->sets, (size_t)count * sizeof *out);
	pthread_mutex_unlock(&session->lock);
	return count;
}

const char *rb_session_keep_set(struct rb_session_set *sets, int *count, const char *name,
                                const char *value, struct rb_error *err)
{
	const size_t size = strlen(name);
	int place = 0;

	RB_ASSERT(*count >= 0 && *count <= RB_SESSION_SETS_MAX);
	while (place < *count &&
	       (strncmp(sets[place].text, name, size) != 0 || sets[place].text[size] != '='))
		place++;
	if (place == RB_SESSION_SETS_MAX) {
		(void)!RB_FAIL(err, RB_ERR_USAGE, "%d parameters are set already: restart first",
		               place);
		return NULL;
	}
	snprintf(sets[place].text, sizeof sets[place].text, "%s=%s", name, value);
	if (place == *count)
		++*count;
	return sets[place].text;
}

/* Checks a parameter's value and keeps it for the next restart. */
static enum rb_status set_param(struct line *line, const struct rb_command *command)
{
	struct rb_session *const session = line->session;
	enum rb_status status = need_run(line);

	if (!status)
		status = rb_script_check_param(session->info->scene, command->text, command->value,
		                               line->err);
	if (status)
		return status;
	const char *const kept = rb_session_keep_set(session->sets, &session->set_count,
	                                             command->text, command->value, line->err);
	if (!kept)
		return RB_ERR_USAGE;
	rb_answer_line(line->answer, "%s from the next restart on", kept);
	return RB_OK;
}

/* ---- commands ---- */

enum rb_status rb_session_serves(enum rb_command_kind kind, struct rb_error *err)
{
	const struct rb_command_row *const row = &rb_commands[kind];

	RB_ASSERT(kind < RB_COMMAND_KIND_COUNT);
	if (row->needs & RB_NEEDS_VIEW)
		return RB_FAIL(err, RB_ERR_USAGE, "'%s' needs a console: a run shows nothing",
		               row->name);
	return RB_OK;
}

/* Answers with all commands, or the one of that name. */
static void answer_help(struct line *line, const char *name)
{
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		const struct rb_command_row *const row = &rb_commands[i];
		if (*name && strcmp(row->name, name) != 0)
			continue;
		rb_answer_line(line->answer, "%s%s%s: %s", row->name, *row->arguments ? " " : "",
		               row->arguments, row->help);
	}
}

/*
 * Executes a command of the command language. Those that change something are logged with who gave
 * them.
 */
static enum rb_status execute(struct line *line, const struct rb_command *command)
{
	struct rb_player *const player = line->session->player;
	enum rb_status status = rb_session_serves(command->kind, line->err);

	if (status)
		return status;
	switch (command->kind) {
	case RB_COMMAND_PLAY:
		rb_player_play(player);
		break;
	case RB_COMMAND_PAUSE:
		rb_player_pause(player);
		break;
	case RB_COMMAND_TOGGLE:
		if (rb_player_status(player).pausing)
			rb_player_play(player);
		else
			rb_player_pause(player);
		break;
	case RB_COMMAND_STEP:
		rb_player_step(player, (uint64_t)command->number);
		break;
	case RB_COMMAND_STOP:
		rb_player_stop_at_collision(player, command->is_on);
		break;
	case RB_COMMAND_FILM:
		if (!rb_player_status(player).has_films)
			return RB_FAIL(line->err, RB_ERR_USAGE,
			               "'film': no camera of this run makes a film");
		if (command->moves)
			return move_film(line, command);
		rb_player_film(player, command->is_on);
		break;
	case RB_COMMAND_RESTART:
		rb_player_restart(player);
		break;
	case RB_COMMAND_CHECKPOINT:
		if (!line->session->recording)
			return RB_FAIL(line->err, RB_ERR_USAGE,
			               "'checkpoint': the run is not recorded");
		rb_player_keep(player);
		break;
	case RB_COMMAND_QUIT:
		rb_player_quit(player);
		break;
	case RB_COMMAND_BODY:
		return answer_body(line, command->text);
	case RB_COMMAND_SET:
		status = set_param(line, command);
		break;
	case RB_COMMAND_STATUS:
		answer_status(line);
		return RB_OK;
	case RB_COMMAND_HELP:
		answer_help(line, command->text);
		return RB_OK;
	default: /* refused above */
		return RB_FAIL(line->err, RB_ERR_USAGE, "'%s' needs a console",
		               rb_commands[command->kind].name);
	}
	if (!status)
		rb_session_tell(line->session, "%s: %s%s%s%s%.60s", line->who,
		                rb_commands[command->kind].name, *command->text ? " " : "",
		                command->text, *command->value ? " " : "", command->value);
	return status;
}

/* Serves the protocol's own words; false: the line begins with none of them, and is a command. */
static bool serve_word(struct line *line, const char *text, enum rb_status *status)
{
	enum { MOST = 4 };
	char copy[RB_COMMAND_LINE_SIZE + 1], *words[MOST] = {NULL}, *rest = copy;
	int count = 0;

	snprintf(copy, sizeof copy, "%s", text);
	while (count < MOST && (words[count] = strtok_r(rest, " \t", &rest)))
		count++;
	if (count == 0)
		return false;
	uint64_t from = 0;
	if (strcmp(words[0], "frame") == 0 || strcmp(words[0], "newer") == 0) {
		*status = serve_frame(line, words[0][0] == 'n', words + 1, count - 1);
	} else if (strcmp(words[0], "events") == 0) {
		if (count > 2 || (count == 2 && !whole(words[1], &from)))
			*status = RB_FAIL(line->err, RB_ERR_USAGE, "'events': usage: events [N]");
		else
			list_events(line->session, from, line->answer);
	} else if (count > 1) {
		return false;
	} else if (strcmp(words[0], "hello") == 0) {
		*status = answer_hello(line);
	} else if (strcmp(words[0], "scene") == 0) {
		*status = answer_scene(line);
	} else if (strcmp(words[0], "timeline") == 0) {
		answer_timeline(line);
	} else {
		return false;
	}
	return true;
}

bool rb_session_execute(struct rb_session *session, const char *line, const char *who,
                        struct rb_answer *answer)
{
	struct rb_error err = {0};
	struct line one = {.session = session, .who = who, .answer = answer, .err = &err};
	struct rb_command command;
	bool given;
	const size_t begin = answer->size;
	enum rb_status status = RB_OK;

	pthread_mutex_lock(&session->lock);
	if (!serve_word(&one, line, &status)) {
		status = rb_command_parse(&command, &given, line, &err);
		if (!status && given)
			status = execute(&one, &command);
	}
	pthread_mutex_unlock(&session->lock);
	if (status || answer->lost)
		answer->size = begin; /* half an answer is none */
	const bool right = !status && !answer->lost;
	rb_answer_end(answer, status, &err);
	return right;
}
