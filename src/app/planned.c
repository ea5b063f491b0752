/* SPDX-License-Identifier: MIT */
/*
 * From a command line to a plan in a folder, or from a folder to its plan. Options that every run
 * gets are taken from the table of options itself, as those that both `run` and `sweep` take, so
 * that a new one needs no code here. Values are checked against the scene before anything is
 * written, as far as that does not take long.
 *
 * What files a scene requires may depend on its parameters; it is therefore loaded once with each
 * value of those that are texts or booleans.
 */
#include "app/planned.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"
#include "sink/module.h"

/* Values of an axis that are held against the scene before anything runs; runs check their own. */
enum { CHECKED_MOST = 1000, LOADED_MOST = 100, WORD_SIZE = 48 };

/* Fails. */
static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot plan the sweep: out of memory");
}

/* ---- options that every run gets ---- */

/* Where the value of a row is in the options. */
static const void *field_of(const struct rb_options *options, const struct rb_option_row *row)
{
	return (const char *)options + row->offset;
}

/*
 * Whether a row is one that the plan hands on: not what says how to talk, nor what leaves no trace
 * in a recording.
 */
static bool is_handed_on(const struct rb_option_row *row)
{
	static const char *const own[] = {"quiet",   "json",         "debug",           "help",
	                                  "version", "print-tables", "checkpoint-every"};
	const unsigned both = 1u << RB_VERB_RUN | 1u << RB_VERB_SWEEP;

	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if (strcmp(row->name, own[i]) == 0)
			return false;
	return (row->verbs & both) == both;
}

/* Whether the command line has given it; rows of other types are handled by name. */
static bool is_given(const struct rb_options *options, const struct rb_option_row *row)
{
	const void *const field = field_of(options, row);

	switch (row->type) {
	case RB_OPTION_FLAG:
		return *(const bool *)field;
	case RB_OPTION_TEXT:
	case RB_OPTION_CHOICE:
		return *(const char *const *)field != NULL;
	case RB_OPTION_NUMBER:
		return !isnan(*(const double *)field);
	case RB_OPTION_INTEGER:
		return *(const int *)field > 0;
	case RB_OPTION_SEED:
	case RB_OPTION_LIST:
	case RB_OPTION_WORDS:
		break;
	}
	return false;
}

/* Writes --NAME=VALUE as snprintf does. */
static int put_word(const struct rb_options *options, const struct rb_option_row *row, char *out,
                    size_t size)
{
	const void *const field = field_of(options, row);

	switch (row->type) {
	case RB_OPTION_TEXT:
	case RB_OPTION_CHOICE:
		return snprintf(out, size, "--%s=%s", row->name, *(const char *const *)field);
	case RB_OPTION_NUMBER:
		return snprintf(out, size, "--%s=%.17g", row->name, *(const double *)field);
	case RB_OPTION_INTEGER:
		return snprintf(out, size, "--%s=%d", row->name, *(const int *)field);
	default:
		return snprintf(out, size, "--%s", row->name);
	}
}

/* Collects the options that every run gets. */
static enum rb_status take_words(struct rb_planned *sweep, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	size_t size = (size_t)rb_option_row_count * WORD_SIZE, used = 0;

	for (int i = 0; i < options->argc; i++)
		size += strlen(options->argv[i]);
	sweep->text = rb_memory_take(size, 1);
	sweep->words = rb_memory_take((size_t)rb_option_row_count, sizeof *sweep->words);
	if (!sweep->text || !sweep->words)
		return no_memory(err);
	for (int i = 0; i < rb_option_row_count; i++) {
		const struct rb_option_row *const row = &rb_option_rows[i];
		if (!is_handed_on(row) || !is_given(options, row))
			continue;
		sweep->words[sweep->word_count++] = sweep->text + used;
		used += (size_t)put_word(options, row, sweep->text + used, size - used) + 1;
	}
	return RB_OK;
}

/* ---- the scene ---- */

/* Adds the files and films of a loaded scene, as far as they are new. */
static enum rb_status take_files(struct rb_planned *sweep, const struct rb_scene *scene,
                                 struct rb_error *err)
{
	for (int i = 0; i < scene->camera_count; i++)
		sweep->films |= scene->cameras[i].png || scene->cameras[i].video;
	sweep->films |= scene->film_count > 0;
	for (int i = 0; i < scene->file_count; i++) {
		const struct rb_source_file *const from = &scene->files[i];
		bool known = false;
		for (int k = 0; k < sweep->file_count && !known; k++)
			known = strcmp(sweep->files[k].name, from->name) == 0;
		if (known)
			continue;
		struct rb_source_file *const grown = rb_memory_grow(
			sweep->files, (size_t)sweep->file_count, (size_t)sweep->file_count + 1,
			sizeof *grown);
		if (!grown)
			return no_memory(err);
		sweep->files = grown;
		struct rb_source_file *const to = &grown[sweep->file_count++];
		char *const text = rb_memory_take(from->size_bytes + 1, 1);
		*to = *from;
		to->name = rb_memory_copy_text(from->name);
		to->text = text;
		if (!to->name || !text)
			return no_memory(err);
		memcpy(text, from->text, from->size_bytes);
	}
	return RB_OK;
}

/* Loads the scene with one parameter (NULL: its defaults). */
static enum rb_status load(const struct rb_planned *sweep, struct rb_loaded *loaded,
                           const char *param, struct rb_error *err)
{
	struct rb_options options = *sweep->options;

	options.params = &param;
	options.param_count = param != NULL;
	options.output = NULL;
	options.no_record = true;
	return rb_loaded_init(loaded, &options, err);
}

/* The type of a parameter; of one that the scene lacks, any. */
static enum rb_param_type type_of(const struct rb_scene *scene, const char *name)
{
	for (int i = 0; i < scene->param_count; i++)
		if (strcmp(scene->params[i].name, name) == 0)
			return scene->params[i].type;
	return RB_PARAM_NUMBER;
}

/*
 * Loads the scene with each value that could change what it requires, and takes its files. Values
 * with which it does not load are for its runs to report.
 */
static enum rb_status load_variants(struct rb_planned *sweep, const struct rb_plan *draft,
                                    struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < draft->axis_count && !status; i++) {
		const struct rb_axis *const axis = &draft->axes[i];
		const enum rb_param_type type = type_of(&sweep->loaded.scene, axis->name);
		if (type != RB_PARAM_TEXT && type != RB_PARAM_BOOLEAN)
			continue;
		const size_t size = strlen(axis->name) + axis->room + 2;
		char *const param = rb_memory_take(size, 1);
		if (!param)
			return no_memory(err);
		for (uint64_t k = 0; k < axis->count && k < LOADED_MOST && !status; k++) {
			char number[RB_AXIS_NUMBER_SIZE];
			struct rb_loaded loaded;
			snprintf(param, size, "%s=%s", axis->name, rb_axis_value(axis, k, number));
			if (!load(sweep, &loaded, param, NULL))
				status = take_files(sweep, &loaded.scene, err);
			rb_loaded_release(&loaded);
		}
		rb_memory_free(param);
	}
	return status;
}

/*
 * Checks values against the scene's parameters, the first CHECKED_MOST of each axis and the last.
 */
static enum rb_status check_values(const struct rb_scene *scene, const struct rb_plan *plan,
                                   struct rb_error *err)
{
	char number[RB_AXIS_NUMBER_SIZE];
	enum rb_status status = RB_OK;

	for (int i = 0; i < plan->axis_count && !status; i++) {
		const struct rb_axis *const axis = &plan->axes[i];
		const uint64_t count = plan->sample_count > 0 ? plan->sample_count : axis->count;
		for (uint64_t k = 0; k < count && k < CHECKED_MOST && !status; k++) {
			/* the last one always: ranges are left at their end */
			const uint64_t at = k + 1 == CHECKED_MOST ? count - 1 : k;
			const char *const value = plan->sample_count > 0
			                                  ? rb_plan_value(plan, at * plan->seeds, i,
			                                                  number)
			                                  : rb_axis_value(axis, at, number);
			status = rb_script_check_param(scene, axis->name, value, err);
		}
	}
	return status;
}

/* ---- the plan ---- */

/* Plans a sweep of a scene. */
static enum rb_status plan_scene(struct rb_planned *sweep, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	const char *const slash = strrchr(options->operand[0], '/');
	struct rb_plan_wish wish = {.version = RB_VERSION,
	                            .scene = slash ? slash + 1 : options->operand[0],
	                            .params = options->params,
	                            .param_count = options->param_count,
	                            .sample = options->sample,
	                            .seeds = options->seeds > 0 ? (uint64_t)options->seeds : 1,
	                            .words = sweep->words,
	                            .word_count = sweep->word_count,
	                            .records = !options->no_record};
	struct rb_plan draft = {0};

	wish.base_seed = options->has_seed ? options->seed : sweep->loaded.scene.world.seed;
	enum rb_status status = rb_plan_init(&draft, &wish, NULL, 0, err);
	if (!status)
		status = check_values(&sweep->loaded.scene, &draft, err);
	if (!status)
		status = take_files(sweep, &sweep->loaded.scene, err);
	if (!status)
		status = load_variants(sweep, &draft, err);
	wish.films = sweep->films && !options->no_render;
	if (!status)
		status = rb_plan_init(&sweep->plan, &wish, sweep->files, sweep->file_count, err);
	rb_plan_release(&draft);
	return status;
}

/*
 * Holds back signals from here on where runs follow: a sweep that has its folder then reports how
 * it goes on.
 */
static void hold_signals(struct rb_planned *sweep)
{
	const struct rb_options *const options = sweep->options;

	if (!options->sweep_plan && !options->sweep_status && !options->slurm)
		rb_jobs_hold_signals(&sweep->mask_before);
}

/* Writes the plan, or checks that the one that is there is the same. */
static enum rb_status settle_folder(struct rb_planned *sweep, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	bool there = rb_folder_has_plan(sweep->shown);

	sweep->goes_on = there;
	if (!there)
		status = rb_folder_write(sweep->shown, &sweep->plan, sweep->files, &there, err);
	if (!status && there) {
		struct rb_plan found;
		status = rb_folder_check(sweep->shown, &sweep->plan, true, err);
		/* the copies too */
		if (!status)
			status = rb_folder_load(sweep->shown, &found, RB_VERSION, err);
		else
			return status;
		rb_plan_release(&found);
	}
	return status;
}

/* Refuses options that the plan of a folder has settled. */
static enum rb_status check_settled(const struct rb_options *options, struct rb_error *err)
{
	const char *name = options->param_count > 0 ? "param"
	                   : options->sample        ? "sample"
	                   : options->seeds > 0     ? "seeds"
	                   : options->has_seed      ? "seed"
	                   : options->output        ? "output"
	                                            : NULL;

	for (int i = 0; i < rb_option_row_count && !name; i++)
		if (is_handed_on(&rb_option_rows[i]) && is_given(options, &rb_option_rows[i]))
			name = rb_option_rows[i].name;
	if (!name)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_USAGE, "option '--%s' is settled by the plan in '%s'", name,
	               options->operand[0]);
}

/* Whether a name is that of a folder. */
static bool is_folder(const char *path)
{
	struct stat about;

	return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

enum rb_status rb_planned_open(struct rb_planned *sweep, const struct rb_options *options,
                               const char *folder, struct rb_error *err)
{
	RB_ASSERT(folder != NULL);
	*sweep = (struct rb_planned){.options = options, .shown = folder, .goes_on = true};
	if (!rb_folder_has_plan(folder))
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' holds no sweep: there is no %s in it",
		               folder, RB_FOLDER_PLAN);
	enum rb_status status = rb_folder_load(folder, &sweep->plan, RB_VERSION, err);
	/* a task leaves that to whoever made the array: it would be done once for each */
	if (!status && options->task < 0)
		status = rb_folder_check(folder, &sweep->plan, true, err);
	if (!status && !realpath(folder, sweep->folder))
		status = RB_FAIL(err, RB_ERR_INPUT, "cannot use '%s'", folder);
	return status;
}

enum rb_status rb_planned_init(struct rb_planned *sweep, const struct rb_options *options,
                               bool *scene_failed, struct rb_error *err)
{
	*sweep = (struct rb_planned){.options = options, .shown = options->output};
	if (is_folder(options->operand[0])) {
		const enum rb_status settled = check_settled(options, err);

		hold_signals(sweep);
		return settled ? settled
		               : rb_planned_open(sweep, options, options->operand[0], err);
	}
	if (access(options->operand[0], F_OK) != 0)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "cannot open '%s': %s (wanted: a scene, or the folder of a sweep)",
		               options->operand[0], strerror(errno));
	if (!sweep->shown)
		return RB_FAIL(err, RB_ERR_USAGE, "'sweep' needs --output DIR");
	enum rb_status status = take_words(sweep, err);
	if (!status) {
		status = load(sweep, &sweep->loaded, NULL, err);
		*scene_failed = status != RB_OK;
	}
	if (!status)
		status = plan_scene(sweep, err);
	hold_signals(sweep);
	if (!status)
		status = settle_folder(sweep, err);
	if (!status && !realpath(sweep->shown, sweep->folder))
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot use '%s'", sweep->shown);
	return status;
}

void rb_planned_release(struct rb_planned *sweep)
{
	for (int i = 0; i < sweep->file_count; i++) {
		rb_memory_free((void *)(uintptr_t)sweep->files[i].name);
		rb_memory_free((void *)(uintptr_t)sweep->files[i].text);
	}
	rb_memory_free(sweep->files);
	rb_memory_free(sweep->words);
	rb_memory_free(sweep->text);
	rb_plan_release(&sweep->plan);
	rb_loaded_release(&sweep->loaded);
}

enum rb_status rb_planned_reader(const struct rb_planned *sweep,
                                 const struct rb_hdf5_module **module, struct rb_error *err)
{
	*module = NULL;
	/* a sweep that has just been planned has nothing to be looked at */
	return sweep->plan.records && sweep->goes_on ? rb_module_hdf5(module, err) : RB_OK;
}
