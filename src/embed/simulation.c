/* SPDX-License-Identifier: MIT */
/*
 * Simulations of <rbsim.h>: what app/simulate does, without its threads, films, checkpoints and
 * signals. The recorder is called as a function, on the caller's thread, before a step returns.
 */
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rbsim/world.h>

#include "base/memory.h"
#include "base/place.h"
#include "embed/handle.h"
#include "flow/frame.h"
#include "flow/run_info.h"
#include "script/hooks.h"
#include "script/load.h"
#include "sink/module.h"

struct rbsim_simulation {
	/* all owned */
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_mistakes mistakes;
	struct rb_model *model;
	struct rb_world *world;
	double *results; /* [result_count]; NULL: none, or the run is not over */

	struct rb_run_info info;
	struct rb_run_texts texts;
	const struct rb_hdf5_module *module; /* NULL: it is not recorded */
	struct rb_recorder *recorder;        /* owned; NULL: none, or finished */
	struct rb_sink sink;                 /* the recorder's */
	bool sink_open;

	struct rb_frame frame;    /* as it is filled */
	struct rb_frame whole;    /* the columns that are shown, of the last that was filled */
	struct rbsim_frame shown; /* of `whole` */
	uint64_t state_hash;      /* after it */
	struct rb_error failure;  /* of the step that failed, or of the first frame */
	bool recording_ended;     /* no more steps */
};

/* ---- loading ---- */

/* Folders of shipped helpers, relative to this library: build tree, installation, multiarch. */
static const char *const beside[] = {"../../lua", "../share/rbsim/lua", "../../share/rbsim/lua"};
enum { FOLDER_COUNT = sizeof beside / sizeof *beside };
struct folders {
	char path[FOLDER_COUNT][PATH_MAX];
	const char *list[FOLDER_COUNT];
};

/*
 * Where helpers are looked for: 0 where RBSIM_LUA_PATH says it, or nothing is known of this
 * library's file, which means beside the program.
 */
static int find_folders(struct folders *folders)
{
	const char *const given = getenv("RBSIM_LUA_PATH");
	Dl_info about;

	if ((given && *given) || !dladdr((const void *)beside, &about) || !about.dli_fname ||
	    !strchr(about.dli_fname, '/'))
		return 0;
	const int size = (int)(strrchr(about.dli_fname, '/') - about.dli_fname);
	for (int i = 0; i < FOLDER_COUNT; i++) {
		snprintf(folders->path[i], PATH_MAX, "%.*s/%s", size, about.dli_fname, beside[i]);
		folders->list[i] = folders->path[i];
	}
	return FOLDER_COUNT;
}

static enum rb_status load_scene(struct rbsim_simulation *made, const char *path,
                                 const struct rbsim_options *options, struct rb_error *err)
{
	struct folders *const folders = rb_memory_take(1, sizeof *folders);

	if (!folders)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory", path);
	const struct rb_script_options script_options = {
		.path = path,
		.params = options->params,
		.param_count = options->param_count,
		.has_seed = options->has_seed,
		.seed = options->seed,
		.lua_folder_count = find_folders(folders),
		.lua_folders = folders->list,
	};
	enum rb_status status = rb_script_load(&made->script, &made->scene, &made->mistakes,
	                                       &script_options, err);
	rb_memory_free(folders);
	if (!status && options->has_seed)
		made->scene.world.seed = options->seed;
	return status ? status : rb_model_create(&made->model, &made->scene, &made->mistakes, err);
}

/* ---- recording ---- */

static enum rb_status start_recording(struct rbsim_simulation *made,
                                      const struct rbsim_options *options, struct rb_error *err)
{
	const struct rb_recorder_options recorder_options = {
		.path = options->record, .how = options->replace ? RB_PLACE_REPLACE : 0};
	enum rb_status status = rb_module_hdf5(&made->module, err);

	rb_run_info_init(&made->info, &made->texts, made->model);
	rb_build_text(made->texts.build, sizeof made->texts.build);
	made->info.version = RBSIM_VERSION;
	made->info.build = made->texts.build;
	made->info.command = "librbsim";
	made->info.threads = options->threads > 0 ? options->threads : 1;
	if (!status)
		status = made->module->recorder_create(&made->recorder, &made->sink, &made->info,
		                                       &recorder_options, err);
	if (!status)
		status = made->sink.open(made->sink.self, err);
	made->sink_open = status == RB_OK;
	return status;
}

/* Closes the recording with what has become of the run. */
static enum rb_status end_recording(struct rbsim_simulation *simulation, struct rb_error *err)
{
	char reason[80];
	struct rb_outcome outcome = {
		.reason = "", .state_hash = simulation->state_hash, .results = simulation->results};
	enum rb_status status = RB_OK;

	if (simulation->failure.status) {
		outcome.status = simulation->failure.status;
		outcome.reason = simulation->failure.text;
	} else if (!rbsim_is_over(simulation)) {
		snprintf(reason, sizeof reason, "closed by its program at %g s",
		         simulation->frame.time_s);
		outcome.status = RB_ERR_INTERRUPT;
		outcome.reason = reason;
	}
	if (simulation->sink_open)
		status = simulation->sink.close(simulation->sink.self, &outcome, err);
	simulation->module->recorder_destroy(simulation->recorder);
	simulation->recorder = NULL;
	simulation->recording_ended = true;
	return status;
}

/* ---- frames ---- */

/* The results of a run that has come to its end. */
static enum rb_status take_results(struct rbsim_simulation *simulation, struct rb_error *err)
{
	const size_t count = (size_t)simulation->scene.result_count;

	if (count == 0 || rb_world_frame(simulation->world) + 1 < simulation->model->frame_count)
		return RB_OK;
	simulation->results = rb_memory_take(count, sizeof *simulation->results);
	if (!simulation->results)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep results: out of memory");
	return rb_script_results(simulation->script, simulation->world, simulation->results, err);
}

static void copy_column(double *to, const double *from, size_t count)
{
	if (to && count > 0)
		memcpy(to, from, count * sizeof *to);
}

/* Shows the frame, which is whole. */
static void show(struct rbsim_simulation *simulation)
{
	const struct rb_frame *const frame = &simulation->frame;
	struct rb_frame *const whole = &simulation->whole;
	const size_t count = (size_t)frame->body_count;

	copy_column(whole->position, frame->position, 3 * count);
	copy_column(whole->orientation, frame->orientation, 4 * count);
	copy_column(whole->velocity, frame->velocity, 3 * count);
	copy_column(whole->angular_velocity, frame->angular_velocity, 3 * count);
	whole->index = frame->index;
	whole->time_s = frame->time_s;
	whole->numbers = frame->numbers;
	rb_handle_show(&simulation->shown, whole);
}

/* The frame of this moment, to the recorder and the script, in the order of app/simulate. */
static enum rb_status emit(struct rbsim_simulation *simulation, struct rb_error *err)
{
	struct rb_frame *const frame = &simulation->frame;
	struct rb_world *const world = simulation->world;
	enum rb_status status = rb_world_fill_frame(world, frame, err);

	if (!status && frame->probes)
		status = rb_script_probes(simulation->script, world, frame->probes, err);
	if (status)
		return status;
	show(simulation);
	if (simulation->recorder)
		status = simulation->sink.frame(simulation->sink.self, frame, err);
	if (!status)
		status = rb_script_on_frame(simulation->script, world, rb_world_time(world),
		                            rb_world_frame(world), err);
	simulation->state_hash = rb_world_hash(world);
	return status ? status : take_results(simulation, err);
}

static enum rb_status make(struct rbsim_simulation *made, const char *path,
                           const struct rbsim_options *options, struct rb_error *err)
{
	enum rb_status status = load_scene(made, path, options, err);

	if (!status && options->record)
		status = start_recording(made, options, err);
	if (status)
		return status;
	const unsigned fields = RB_FIELD_DEFAULT | made->sink.fields;
	const struct rb_world_hooks hooks = rb_script_hooks(made->script);
	const struct rb_world_options world_options = {
		.threads = options->threads,
		.keep_events = fields & RB_FIELD_EVENTS,
		.keep_contacts = fields & RB_FIELD_CONTACTS,
	};
	status = rb_world_create(&made->world, made->model, &world_options, &hooks, err);
	if (!status)
		status = rb_frame_init(&made->frame, made->model, fields, err);
	if (!status)
		status = rb_frame_init(&made->whole, made->model, RB_FIELD_DEFAULT, err);
	return status ? status : emit(made, err);
}

enum rbsim_status rbsim_open(struct rbsim_simulation **simulation, const char *scene,
                             const struct rbsim_options *options, struct rbsim_error *error)
{
	struct rbsim_options known = {.size = sizeof known};
	struct rb_error err;

	if (simulation)
		*simulation = NULL;
	if (!simulation || !scene)
		return rb_handle_refuse(error, __func__,
		                        "'simulation' and 'scene' must not be NULL");
	if (options && (options->size < sizeof options->size || options->size > sizeof known))
		return rb_handle_refuse(error, __func__,
		                        "'options->size' must be sizeof (struct rbsim_options)");
	if (options)
		memcpy(&known, options, options->size);
	if (known.param_count < 0 || (known.param_count > 0 && !known.params) || known.threads < 0)
		return rb_handle_refuse(error, __func__,
		                        "'param_count' and 'threads' must not be negative, nor "
		                        "'params' NULL where there are any");
	for (int i = 0; i < known.param_count; i++)
		if (!known.params[i])
			return rb_handle_refuse(error, __func__, "a parameter is NULL");

	struct rbsim_simulation *const made = rb_memory_take(1, sizeof *made);
	const enum rb_status status = made ? make(made, scene, &known, &err)
	                                   : RB_FAIL(&err, RB_ERR_MEMORY,
	                                             "cannot open '%s': out of memory", scene);
	if (status && made)
		made->failure = err;
	if (status)
		rbsim_close(made);
	else
		*simulation = made;
	return rb_handle_pass(error, status, &err);
}

void rbsim_close(struct rbsim_simulation *simulation)
{
	if (!simulation)
		return;
	if (simulation->recorder && simulation->world)
		(void)!end_recording(simulation, NULL);
	else if (simulation->recorder)
		simulation->module->recorder_destroy(simulation->recorder);
	rb_frame_release(&simulation->frame);
	rb_frame_release(&simulation->whole);
	rb_world_destroy(simulation->world);
	rb_model_destroy(simulation->model);
	rb_script_destroy(simulation->script);
	rb_scene_release(&simulation->scene);
	rb_mistakes_release(&simulation->mistakes);
	rb_memory_free(simulation->results);
	rb_memory_free(simulation);
}

enum rbsim_status rbsim_step(struct rbsim_simulation *simulation, struct rbsim_error *error)
{
	struct rb_error err;

	if (!simulation)
		return rb_handle_refuse(error, __func__, "'simulation' must not be NULL");
	if (simulation->failure.status)
		return rb_handle_pass(error, simulation->failure.status, &simulation->failure);
	if (simulation->recording_ended)
		return rb_handle_refuse(error, __func__, "its recording is finished");
	if (rbsim_is_over(simulation))
		return rb_handle_refuse(error, __func__, "the run is over");
	enum rb_status status = rb_world_step_frame(simulation->world, &err);
	if (!status)
		status = emit(simulation, &err);
	if (status)
		simulation->failure = err;
	return rb_handle_pass(error, status, &err);
}

/* ---- what is asked of it ---- */

const char *rbsim_version(void)
{
	return RBSIM_VERSION;
}

int rbsim_is_over(const struct rbsim_simulation *simulation)
{
	return !simulation || simulation->failure.status ||
	       rb_world_frame(simulation->world) + 1 >= simulation->model->frame_count;
}

uint64_t rbsim_frame_count(const struct rbsim_simulation *simulation)
{
	return simulation ? simulation->model->frame_count : 0;
}

const struct rbsim_frame *rbsim_frame(const struct rbsim_simulation *simulation)
{
	return simulation ? &simulation->shown : NULL;
}

static bool is_body(const struct rbsim_simulation *simulation, int body)
{
	return simulation && body >= 0 && body < simulation->model->body_count;
}

const char *rbsim_name(const struct rbsim_simulation *simulation, int body)
{
	const char *name = NULL;

	if (is_body(simulation, body))
		name = simulation->scene.bodies[simulation->model->id_of[body]].name;
	return name ? name : "";
}

int rbsim_find(const struct rbsim_simulation *simulation, const char *name)
{
	for (int body = 0; name && *name && is_body(simulation, body); body++)
		if (strcmp(rbsim_name(simulation, body), name) == 0)
			return body;
	return -1;
}

double rbsim_mass(const struct rbsim_simulation *simulation, int body)
{
	return is_body(simulation, body) ? simulation->model->mass[body] : (double)NAN;
}

enum rbsim_status rbsim_result(const struct rbsim_simulation *simulation, const char *name,
                               double *value, struct rbsim_error *error)
{
	struct rb_error err;

	if (value)
		*value = (double)NAN;
	if (!simulation || !name || !value)
		return rb_handle_refuse(error, __func__,
		                        "'simulation', 'name' and 'value' must not be NULL");
	for (int i = 0; i < simulation->scene.result_count; i++) {
		if (strcmp(simulation->scene.results[i].name, name) != 0)
			continue;
		if (!simulation->results)
			return rb_handle_refuse(error, __func__, "the run has not come to its end");
		*value = simulation->results[i];
		return rb_handle_pass(error, RB_OK, NULL);
	}
	const enum rb_status status = RB_FAIL(&err, RB_ERR_USAGE,
	                                      "%s: the scene has no result '%s'", __func__, name);
	return rb_handle_pass(error, status, &err);
}

enum rbsim_status rbsim_finish_recording(struct rbsim_simulation *simulation,
                                         struct rbsim_error *error)
{
	struct rb_error err;

	if (!simulation || !simulation->recorder)
		return rb_handle_refuse(error, __func__, "there is no recording to finish");
	return rb_handle_pass(error, end_recording(simulation, &err), &err);
}
