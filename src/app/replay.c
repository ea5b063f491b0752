/* SPDX-License-Identifier: MIT */
/*
 * Simulates the recorded scene again and compares each recorded frame, bit by bit, as it comes; the
 * callbacks of the script are called as in the run, because they may change bodies. The run may
 * have been cut short; then only what was recorded is compared, and the state hash, which is that
 * of a run's end, only where the run was complete.
 */
#include "app/replay.h"

#include <inttypes.h>
#include <string.h>

#include "app/common.h"
#include "app/json.h"
#include "app/recorded.h"
#include "app/simulate.h"
#include "base/error.h"
#include "base/log.h"
#include "base/visible.h"
#include "flow/frame.h"
#include "model/joints.h"
#include "script/hooks.h"
#include "sink/module.h"

enum { COLUMN_COUNT = 12 };
static const struct {
	const char *name;
	int width;
	size_t offset; /* of the column in struct rb_frame */
	bool of_joints;
} columns[COLUMN_COUNT] = {
	{"position", 3, offsetof(struct rb_frame, position), false},
	{"orientation", 4, offsetof(struct rb_frame, orientation), false},
	{"velocity", 3, offsetof(struct rb_frame, velocity), false},
	{"angular_velocity", 3, offsetof(struct rb_frame, angular_velocity), false},
	{"acceleration", 3, offsetof(struct rb_frame, acceleration), false},
	{"angular_acceleration", 3, offsetof(struct rb_frame, angular_acceleration), false},
	{"force", 3, offsetof(struct rb_frame, force), false},
	{"torque", 3, offsetof(struct rb_frame, torque), false},
	{"joints' angle", 1, offsetof(struct rb_frame, joint_value), true},
	{"joints' speed", 1, offsetof(struct rb_frame, joint_speed), true},
	{"joints' force", 3, offsetof(struct rb_frame, joint_force), true},
	{"joints' torque", 3, offsetof(struct rb_frame, joint_torque), true},
};

struct replay {
	const char *path;
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const struct rb_reading *reading;
	struct rb_loaded loaded;
	struct rb_world *world;
	struct rb_frame frame; /* of the run */
	uint64_t row;          /* of the recording: the next one */
	bool differs, hash_differs;
	uint64_t first; /* frame that differs */
	char what[200]; /* body and column there */
	uint64_t state_hash;
};

/* A column of a frame, NULL: it has none. */
static const double *column_of(const struct rb_frame *frame, int column)
{
	const double *values;

	RB_ASSERT(column >= 0 && column < COLUMN_COUNT);
	memcpy(&values, (const char *)frame + columns[column].offset, sizeof values);
	return values;
}

/*
 * Whether a value is the recorded one, to the bit, and after rounding where it was recorded in
 * single precision.
 */
static bool same(const struct replay *replay, double now, double then)
{
	if (replay->loaded.scene.record.single_precision)
		now = (double)(float)now;
	return memcmp(&now, &then, sizeof now) == 0;
}

/* Compares the columns that both frames have; notes the first difference. */
static void compare(struct replay *replay, const struct rb_frame *then)
{
	char label[96];

	for (int c = 0; c < COLUMN_COUNT; c++) {
		const double *const a = column_of(&replay->frame, c), *const b = column_of(then, c);
		const int rows = columns[c].of_joints ? then->joint_count : then->body_count;
		const int count = rows * columns[c].width;

		for (int i = 0; a && b && i < count; i++) {
			if (same(replay, a[i], b[i]))
				continue;
			const int row = i / columns[c].width;
			replay->differs = true;
			replay->first = then->index;
			if (columns[c].of_joints)
				rb_joint_label(&replay->loaded.scene, row, label);
			else
				rb_scene_body_label(&replay->loaded.scene,
				                    replay->loaded.model->id_of[row], label);
			snprintf(replay->what, sizeof replay->what,
			         "%s of '%s': %.17g recorded, %.17g now", columns[c].name, label,
			         b[i], a[i]);
			return;
		}
	}
}

/* Compares the scene's probes; NAN is the same as NAN, for all are recorded in one form. */
static void compare_probes(struct replay *replay, const struct rb_frame *then)
{
	const int count = then->probe_count < replay->frame.probe_count ? then->probe_count
	                                                                : replay->frame.probe_count;

	for (int i = 0; i < count && !replay->differs; i++) {
		const double now = replay->frame.probes[i], was = then->probes[i];

		if (memcmp(&now, &was, sizeof now) == 0)
			continue;
		replay->differs = true;
		replay->first = then->index;
		snprintf(replay->what, sizeof replay->what,
		         "probe '%.60s': %.17g recorded, %.17g now",
		         replay->loaded.scene.probes[i].name, was, now);
	}
}

/* Whether what the script's callback of this frame does shows in what is compared later. */
static bool goes_on(const struct replay *replay)
{
	return replay->row < replay->reading->frame_count ||
	       strcmp(replay->reading->status, "complete") == 0;
}

/*
 * Compares the frame of the run with the next row, if that is of it, and calls the script's
 * callbacks. After the last row of a run that has failed they may be what it has failed by.
 */
static enum rb_status look(struct replay *replay, struct rb_error *err)
{
	struct rb_frame then;
	const uint64_t k = rb_world_frame(replay->world);
	enum rb_status status = rb_world_fill_frame(replay->world, &replay->frame, err);

	if (!status && replay->frame.probes)
		status = rb_script_probes(replay->loaded.script, replay->world,
		                          replay->frame.probes, err);
	if (!status)
		status = replay->module->reader_frame(replay->reader, replay->row, &then, err);
	if (!status && then.index == k) {
		compare(replay, &then);
		compare_probes(replay, &then);
		replay->row++;
	}
	if (!status && goes_on(replay))
		status = rb_script_on_frame(replay->loaded.script, replay->world,
		                            rb_world_time(replay->world), k, err);
	return status;
}

/* Steps until a difference, or the end of what was recorded. */
static enum rb_status run(struct replay *replay, struct rb_error *err)
{
	enum rb_status status = look(replay, err);

	while (!status && !replay->differs && replay->row < replay->reading->frame_count &&
	       rb_world_frame(replay->world) + 1 < rb_world_frame_count(replay->world)) {
		status = rb_world_step_frame(replay->world, err);
		if (!status)
			status = look(replay, err);
	}
	return status;
}

/*
 * Compares the state at the end: only of a run that came to its end is the state known that the
 * hash is of.
 */
static void compare_hash(struct replay *replay)
{
	char text[24];

	replay->state_hash = rb_world_hash(replay->world);
	snprintf(text, sizeof text, "%016" PRIx64, replay->state_hash);
	replay->hash_differs = !replay->differs &&
	                       strcmp(replay->reading->status, "complete") == 0 &&
	                       strcmp(text, replay->reading->state_hash) != 0;
}

/* Compares the scene's results, of a run that came to its end. */
static enum rb_status compare_results(struct replay *replay, struct rb_error *err)
{
	const struct rb_scene *const scene = &replay->loaded.scene;
	double now[RB_MEASURES_MAX];

	if (replay->differs || replay->hash_differs || scene->result_count == 0 ||
	    scene->result_count != replay->reading->result_count ||
	    strcmp(replay->reading->status, "complete") != 0)
		return RB_OK;
	const enum rb_status status = rb_script_results(replay->loaded.script, replay->world, now,
	                                                err);
	for (int i = 0; !status && i < scene->result_count && !replay->differs; i++) {
		const double was = replay->reading->results[i];

		if (memcmp(&now[i], &was, sizeof was) == 0)
			continue;
		replay->differs = true;
		replay->first = rb_world_frame(replay->world);
		snprintf(replay->what, sizeof replay->what,
		         "result '%.60s': %.17g recorded, %.17g now", scene->results[i].name, was,
		         now[i]);
	}
	return status;
}

/* Opens the recording, loads its scene, makes the world. */
static enum rb_status prepare(struct replay *replay, const struct rb_options *options,
                              struct rb_error *err)
{
	const struct rb_world_options world = {.threads = rb_simulate_threads(options)};
	enum rb_status status = rb_recorded_open(&replay->module, &replay->reader, replay->path,
	                                         err);

	if (status)
		return status;
	replay->reading = replay->module->reader_reading(replay->reader);
	status = rb_recorded_load(&replay->loaded, replay->reading, replay->path, options->trust,
	                          err);
	if (status)
		return status;
	if (strcmp(replay->reading->version, RB_VERSION) != 0)
		rb_log(RB_LOG_NOTE, "'%s' was made by rbsim %s, this is %s", replay->path,
		       replay->reading->version, RB_VERSION);
	const struct rb_world_hooks hooks = rb_script_hooks(replay->loaded.script);
	status = rb_frame_init(&replay->frame, replay->loaded.model, replay->reading->fields, err);
	return status ? status
	              : rb_world_create(&replay->world, replay->loaded.model, &world, &hooks, err);
}

static void tell_json(const struct replay *replay, int exit_code)
{
	struct rb_json json = {.file = stdout};
	char text[24];

	snprintf(text, sizeof text, "%016" PRIx64, replay->state_hash);
	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "file", replay->path);
	rb_json_bool(&json, "same", exit_code == 0);
	rb_json_count(&json, "frames", replay->row);
	if (replay->differs)
		rb_json_count(&json, "first_difference", replay->first);
	rb_json_text(&json, "difference",
	             replay->differs        ? replay->what
	             : replay->hash_differs ? "state_hash"
	                                    : NULL);
	rb_json_text(&json, "state_hash", text);
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_close(&json, '}');
	putchar('\n');
}

/* Prints the outcome; the exit status. */
static int tell(const struct replay *replay, const struct rb_options *options)
{
	const bool differ = replay->differs || replay->hash_differs;
	const int exit_code = differ ? rb_status_exit_code(RB_ERR_EXPECT) : 0;

	if (options->json)
		tell_json(replay, exit_code);
	else if (options->quiet)
		return exit_code;
	else if (replay->differs)
		rb_print(stdout, "'%s' differs first at frame %" PRIu64 ": %s\n", replay->path,
		         replay->first, replay->what);
	else if (replay->hash_differs)
		rb_print(stdout,
		         "'%s' has the same %" PRIu64 " %s, but ends in another state: %s "
		         "recorded, %016" PRIx64 " now\n",
		         replay->path, replay->row, rb_text_plural(replay->row, "frame", "frames"),
		         replay->reading->state_hash, replay->state_hash);
	else
		rb_print(stdout, "the same to the bit: %" PRIu64 " %s, state hash %016" PRIx64 "\n",
		         replay->row, rb_text_plural(replay->row, "frame", "frames"),
		         replay->state_hash);
	return exit_code;
}

int rb_replay_main(const struct rb_options *options)
{
	struct replay replay = {.path = options->operand[0]};
	struct rb_error err;
	enum rb_status status = prepare(&replay, options, &err);

	if (!status)
		status = run(&replay, &err);
	if (!status) {
		compare_hash(&replay);
		status = compare_results(&replay, &err);
	}
	const int exit_code = status ? rb_app_refuse(options, &err) : tell(&replay, options);
	rb_world_destroy(replay.world);
	rb_frame_release(&replay.frame);
	rb_loaded_release(&replay.loaded);
	if (replay.reader)
		replay.module->reader_close(replay.reader);
	return rb_app_finish(options, exit_code);
}
