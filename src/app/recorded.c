/* SPDX-License-Identifier: MIT */
/*
 * A recording holds the texts of its scene; loading them again with the recorded parameters and
 * seed gives the same model. Numbers that the command line may have overridden (duration, time
 * step, ...) are then set as they were run. That it is the same scene is checked by the bodies: as
 * many, and the same ones move.
 */
#include "app/recorded.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "model/descriptor.h"

/* What script/load takes, borrowed from a reading but for the arrays. */
struct stored {
	struct rb_source_file *files; /* owned, [file_count] */
	char **params;                /* owned, each too: [param_count] */
	int param_count;
};

/* Frees the arrays; texts are the reading's. */
static void release(struct stored *stored)
{
	for (int i = 0; stored->params && i < stored->param_count; i++)
		rb_memory_free(stored->params[i]);
	rb_memory_free(stored->params);
	rb_memory_free(stored->files);
}

/*
 * Puts files and parameters into the form that script/load takes. False: no memory; `release` frees
 * what there is.
 */
static bool gather(struct stored *stored, const struct rb_reading *reading)
{
	RB_ASSERT(reading->file_count > 0);
	stored->files = rb_memory_take((size_t)reading->file_count, sizeof *stored->files);
	stored->params = rb_memory_take((size_t)reading->param_count + 1, sizeof *stored->params);
	if (!stored->files || !stored->params)
		return false;
	for (int i = 0; i < reading->file_count; i++) {
		stored->files[i].name = reading->file_names[i];
		stored->files[i].text = reading->file_texts[i];
		stored->files[i].size_bytes = reading->file_sizes[i];
	}
	for (int i = 0; i < reading->param_count; i++) {
		const size_t size = strlen(reading->param_names[i]) +
		                    strlen(reading->param_values[i]) + 2;
		stored->params[i] = rb_memory_take(size, 1);
		if (!stored->params[i])
			return false;
		stored->param_count++;
		snprintf(stored->params[i], size, "%s=%s", reading->param_names[i],
		         reading->param_values[i]);
	}
	return true;
}

enum rb_status rb_recorded_open(const struct rb_hdf5_module **module, struct rb_reader **reader,
                                const char *path, struct rb_error *err)
{
	enum rb_status status = rb_module_hdf5(module, err);

	if (!status)
		status = (*module)->reader_open(reader, path, err);
	if (status)
		return status;
	if ((*module)->reader_reading(*reader)->frame_count == 0)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' holds no frame", path);
	return RB_OK;
}

/* Fails unless the bodies are those of the recording. */
static enum rb_status compare(const struct rb_model *model, const struct rb_reading *reading,
                              const char *path, struct rb_error *err)
{
	bool same = model->body_count == reading->body_count &&
	            model->static_count == reading->static_count;

	for (int i = 0; same && i < model->body_count; i++)
		same = model->id_of[i] == reading->id[i];
	if (same)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_INPUT,
	               "the scene stored in '%s' gives %d moving and %d resting bodies, recorded "
	               "are %d and %d: they are not the same",
	               path, model->body_count, model->static_count, reading->body_count,
	               reading->static_count);
}

/* Loads the scene and makes the model. */
static enum rb_status load(struct rb_loaded *loaded, const struct rb_reading *reading,
                           const struct stored *stored, bool trust, struct rb_error *err)
{
	const struct rb_script_options options = {
		.path = reading->file_names[0],
		.params = (const char *const *)stored->params,
		.param_count = stored->param_count,
		.has_seed = true,
		.seed = reading->seed,
		.files = stored->files,
		.file_count = reading->file_count,
		.trust = trust,
	};
	enum rb_status status = rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes,
	                                       &options, err);

	if (status)
		return status;
	struct rb_world_def *const world = &loaded->scene.world;
	world->duration_s = reading->duration_s;
	world->frame_rate = reading->frame_rate;
	world->time_step_s = reading->time_step_s;
	world->tolerance_m = reading->tolerance_m;
	world->stepped_tolerance_m = reading->stepped_tolerance_m;
	if (rb_method_find(reading->method) >= 0)
		world->method = (enum rb_method_kind)rb_method_find(reading->method);
	for (int kind = RB_ROLLBACK_SELECTIVE; kind <= RB_ROLLBACK_NONE; kind++)
		if (strcmp(rb_rollback_name((enum rb_rollback_kind)kind), reading->rollback) == 0)
			world->rollback = (enum rb_rollback_kind)kind;
	return rb_model_create(&loaded->model, &loaded->scene, &loaded->mistakes, err);
}

/* Whether the command that made the recording had --trust. */
static bool was_trusted(const struct rb_reading *reading)
{
	static const char word[] = " --trust";
	const char *at = reading->command ? strstr(reading->command, word) : NULL;

	return at && (at[sizeof word - 1] == ' ' || at[sizeof word - 1] == '\0');
}

enum rb_status rb_recorded_load(struct rb_loaded *loaded, const struct rb_reading *reading,
                                const char *path, bool trust, struct rb_error *err)
{
	struct stored stored = {0};
	struct rb_error own;

	*loaded = (struct rb_loaded){0};
	if (reading->file_count == 0)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' holds no scene", path);
	if (!gather(&stored, reading)) {
		release(&stored);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load the scene of '%s': out of memory",
		               path);
	}
	enum rb_status status = load(loaded, reading, &stored, trust, &own);
	release(&stored);
	if (status == RB_ERR_SCENE || status == RB_ERR_USAGE || status == RB_ERR_INPUT)
		return RB_FAIL(
			err, RB_ERR_INPUT, "the scene stored in '%s' does not load here%s: %s",
			path,
			!trust && was_trusted(reading)
				? " without --trust, with which it was recorded (for your own)"
				: "",
			own.text);
	if (status) {
		if (err)
			*err = own;
		return status;
	}
	return compare(loaded->model, reading, path, err);
}

/*
 * The last row whose frame is not after `than`, by halving on a quantity that grows from row to
 * row; 0 where all are.
 */
static enum rb_status find_row(const struct rb_hdf5_module *module, struct rb_reader *reader,
                               bool (*is_after)(const struct rb_frame *frame, const void *than),
                               const void *than, uint64_t *row, struct rb_error *err)
{
	uint64_t low = 0, high = module->reader_reading(reader)->frame_count;
	struct rb_frame frame;

	while (high - low > 1) {
		const uint64_t middle = low + (high - low) / 2;
		const enum rb_status status = module->reader_frame(reader, middle, &frame, err);
		if (status)
			return status;
		if (is_after(&frame, than))
			high = middle;
		else
			low = middle;
	}
	*row = low;
	return RB_OK;
}

static bool is_later(const struct rb_frame *frame, const void *than)
{
	return frame->time_s > *(const double *)than;
}

static bool is_higher(const struct rb_frame *frame, const void *than)
{
	return frame->index > *(const uint64_t *)than;
}

enum rb_status rb_recorded_row_at(const struct rb_hdf5_module *module, struct rb_reader *reader,
                                  double time_s, uint64_t *row, struct rb_error *err)
{
	return find_row(module, reader, is_later, &time_s, row, err);
}

enum rb_status rb_recorded_row_of(const struct rb_hdf5_module *module, struct rb_reader *reader,
                                  uint64_t frame, uint64_t *row, struct rb_error *err)
{
	return find_row(module, reader, is_higher, &frame, row, err);
}
