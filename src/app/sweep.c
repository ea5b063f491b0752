/* SPDX-License-Identifier: MIT */
#include "app/sweep.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/common.h"
#include "app/json.h"
#include "app/overview.h"
#include "base/memory.h"
#include "base/team.h"
#include "sink/module.h"
#include "sweep/slurm.h"
#include "sweep/status.h"

/* Values of an axis that are held against the scene before anything runs; runs check their own. */
enum { CHECKED_MOST = 1000, LOADED_MOST = 100, WORD_SIZE = 48 };

/* All of one call of the verb. */
struct sweep {
	const struct rb_options *options;
	const char *shown;     /* the folder as the user calls it; borrowed */
	char folder[PATH_MAX]; /* absolute */
	struct rb_plan plan;
	bool goes_on; /* the folder was there before */

	/* while it is planned */
	struct rb_loaded loaded;      /* with the defaults of its parameters */
	struct rb_source_file *files; /* owned, names and texts too */
	int file_count;
	const char **words; /* owned: for every run; they point into `text` and the command line */
	int word_count;
	char *text; /* owned */
	bool films;
};

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot plan the sweep: out of memory");
}

/* ---- options that every run gets ---- */

static const void *field_of(const struct rb_options *options, const struct rb_option_row *row)
{
	return (const char *)options + row->offset;
}

/* Whether a row is one that sweeps hand on; what says how to talk is not. */
static bool is_handed_on(const struct rb_option_row *row)
{
	static const char *const own[] = {"quiet", "json",    "debug",
	                                  "help",  "version", "print-tables"};
	const unsigned both = 1u << RB_VERB_RUN | 1u << RB_VERB_SWEEP;

	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if (strcmp(row->name, own[i]) == 0)
			return false;
	return (row->verbs & both) == both;
}

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

/* --name=value */
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

static enum rb_status take_words(struct sweep *sweep, struct rb_error *err)
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

/* The files and films of a loaded scene, as far as they are new. */
static enum rb_status take_files(struct sweep *sweep, const struct rb_scene *scene,
                                 struct rb_error *err)
{
	for (int i = 0; i < scene->camera_count; i++)
		sweep->films |= scene->cameras[i].png || scene->cameras[i].video;
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

/* `param` NULL: the scene's defaults. */
static enum rb_status load(const struct sweep *sweep, struct rb_loaded *loaded, const char *param,
                           struct rb_error *err)
{
	struct rb_options options = *sweep->options;

	options.params = &param;
	options.param_count = param != NULL;
	options.output = NULL;
	options.no_record = true;
	return rb_loaded_init(loaded, &options, err);
}

static enum rb_param_type type_of(const struct rb_scene *scene, const char *name)
{
	for (int i = 0; i < scene->param_count; i++)
		if (strcmp(scene->params[i].name, name) == 0)
			return scene->params[i].type;
	return RB_PARAM_NUMBER;
}

/*
 * What a scene requires may depend on what it is to be: on its parameters that are texts or booleans. Values with which the
 * scene does not load are for its runs to tell.
 */
static enum rb_status load_variants(struct sweep *sweep, const struct rb_plan *draft,
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

/* May the scene's parameters have these values? */
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

static enum rb_status plan_scene(struct sweep *sweep, struct rb_error *err)
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

static enum rb_status settle_folder(struct sweep *sweep, struct rb_error *err)
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

/* What the plan of a folder has settled cannot be asked for again. */
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

static bool is_folder(const char *path)
{
	struct stat about;

	return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* Everything up to the first run. `*scene_failed`: the mistakes are those of the scene. */
static enum rb_status prepare(struct sweep *sweep, bool *scene_failed, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	enum rb_status status;

	if (is_folder(options->operand[0])) {
		sweep->shown = options->operand[0];
		sweep->goes_on = true;
		status = check_settled(options, err);
		if (!status && !rb_folder_has_plan(sweep->shown))
			status = RB_FAIL(err, RB_ERR_INPUT,
			                 "'%s' holds no sweep: there is no %s in it", sweep->shown,
			                 RB_FOLDER_PLAN);
		if (!status)
			status = rb_folder_load(sweep->shown, &sweep->plan, RB_VERSION, err);
		/* a task leaves that to whoever made the array: it would be done once for each */
		if (!status && options->task < 0)
			status = rb_folder_check(sweep->shown, &sweep->plan, true, err);
	} else {
		sweep->shown = options->output;
		if (!sweep->shown)
			return RB_FAIL(err, RB_ERR_USAGE, "'sweep' needs --output DIR");
		status = take_words(sweep, err);
		if (!status) {
			status = load(sweep, &sweep->loaded, NULL, err);
			*scene_failed = status != RB_OK;
		}
		if (!status)
			status = plan_scene(sweep, err);
		if (!status)
			status = settle_folder(sweep, err);
	}
	if (!status && !realpath(sweep->shown, sweep->folder))
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot use '%s'", sweep->shown);
	return status;
}

static void release(struct sweep *sweep)
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

/* ---- what becomes of it ---- */

static enum rb_status reader_of(const struct sweep *sweep, const struct rb_hdf5_module **module,
                                struct rb_error *err)
{
	*module = NULL;
	/* a sweep that has just been planned has nothing to be looked at */
	return sweep->plan.records && sweep->goes_on ? rb_module_hdf5(module, err) : RB_OK;
}

static int tell_plan(const struct sweep *sweep)
{
	const struct rb_plan *const plan = &sweep->plan;
	struct rb_json json = {.file = stdout};

	if (sweep->options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", sweep->shown);
		rb_json_text(&json, "scene", plan->scene);
		rb_json_count(&json, "points", plan->count);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!sweep->options->quiet) {
		printf("%s: %" PRIu64 " %s of %s, listed in %s/" RB_FOLDER_PLAN "\n", sweep->shown,
		       plan->count, rb_text_plural(plan->count, "point", "points"), plan->scene,
		       sweep->shown);
	}
	return 0;
}

static void json_point(struct rb_json *json, const struct rb_plan *plan, uint64_t index,
                       const struct rb_point *point)
{
	char number[RB_AXIS_NUMBER_SIZE];

	rb_json_open(json, NULL, '{');
	rb_json_count(json, "index", index);
	rb_json_open(json, "parameters", '{');
	for (int i = 0; i < plan->axis_count; i++)
		rb_json_text(json, plan->axes[i].name, rb_plan_value(plan, index, i, number));
	rb_json_close(json, '}');
	rb_json_count(json, "seed", rb_plan_seed(plan, index));
	rb_json_count(json, "exit_status", (uint64_t)point->exit_code);
	rb_json_text(json, "reason", point->reason);
	rb_json_close(json, '}');
}

/* A failed point, while the status is taken: into the array of the JSON object, or a line below the first one. */
struct failures {
	const struct sweep *sweep;
	struct rb_json *json; /* NULL: lines */
};

static void tell_failure(void *user, uint64_t index, const struct rb_point *point)
{
	const struct failures *const failures = user;
	const struct rb_plan *const plan = &failures->sweep->plan;
	char label[160];

	if (failures->json)
		json_point(failures->json, plan, index, point);
	else if (!failures->sweep->options->quiet)
		printf("  failed      %" PRIu64 " (%s), exit status %d: %s\n", index,
		       rb_plan_label(plan, index, label, sizeof label), point->exit_code,
		       *point->reason ? point->reason : "it gave no reason");
}

static void print_status(const struct sweep *sweep, const struct rb_sweep_status *status,
                         uint64_t tasks)
{
	static const enum rb_point_state order[] = {
		RB_POINT_DONE, RB_POINT_RUNNING, RB_POINT_FAILED, RB_POINT_BEGUN, RB_POINT_MISSING};
	const char *comma = "";

	printf("%s: %" PRIu64 " %s of %s: ", sweep->shown, sweep->plan.count,
	       rb_text_plural(sweep->plan.count, "point", "points"), sweep->plan.scene);
	for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
		if (status->points[order[i]] == 0 && order[i] != RB_POINT_DONE)
			continue;
		printf("%s%" PRIu64 " %s", comma, status->points[order[i]],
		       rb_point_state_names[order[i]]);
		comma = ", ";
	}
	putchar('\n');
	if (status->due > 0)
		printf("  to be run   %" PRIu64 ": 'rbsim sweep %s', or of %" PRIu64
		       " tasks --array=%s\n",
		       status->due, sweep->shown, tasks, status->array);
}

static enum rb_status tell_status(const struct sweep *sweep, int *exit_code, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	struct rb_json json = {.file = stdout};
	struct failures failures = {.sweep = sweep, .json = options->json ? &json : NULL};
	struct rb_status_wish wish = {.folder = sweep->folder,
	                              .plan = &sweep->plan,
	                              .tasks = (uint64_t)options->tasks,
	                              .retry = options->retry,
	                              .failed = tell_failure,
	                              .user = &failures};
	struct rb_sweep_status status = {0};

	*exit_code = 0;
	if (wish.tasks == 0)
		wish.tasks = rb_slurm_tasks(sweep->folder);
	if (wish.tasks == 0)
		wish.tasks = sweep->plan.count;
	enum rb_status failed = reader_of(sweep, &wish.module, err);
	if (failed)
		return failed;
	if (options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", sweep->shown);
		rb_json_text(&json, "scene", sweep->plan.scene);
		rb_json_count(&json, "points", sweep->plan.count);
		rb_json_open(&json, "failures", '[');
	}
	failed = rb_status_take(&status, &wish, err);
	if (options->json) {
		rb_json_close(&json, ']');
		for (int i = 0; i < RB_POINT_STATE_COUNT; i++)
			rb_json_count(&json, rb_point_state_names[i], status.points[i]);
		rb_json_count(&json, "due", status.due);
		rb_json_count(&json, "tasks", wish.tasks);
		rb_json_text(&json, "array", status.array);
		rb_json_text(&json, "error", failed ? err->text : NULL);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!failed) {
		print_status(sweep, &status, wish.tasks);
	}
	rb_status_release(&status);
	return failed;
}

static enum rb_status submit(const struct sweep *sweep, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	const uint64_t most = rb_slurm_tasks_max();
	struct rb_slurm_order order = {.folder = sweep->folder,
	                               .name = sweep->plan.scene,
	                               .tasks = sweep->plan.count < most ? sweep->plan.count : most,
	                               .jobs = options->jobs > 0 ? options->jobs : 1,
	                               .threads = options->threads > 0 ? options->threads : 1,
	                               .time = options->slurm_time,
	                               .memory = options->slurm_memory,
	                               .partition = options->slurm_partition,
	                               .options = options->slurm_options,
	                               .option_count = options->slurm_option_count};
	struct rb_status_wish wish = {
		.folder = sweep->folder, .plan = &sweep->plan, .retry = options->retry};
	struct rb_sweep_status left = {0};
	struct rb_json json = {.file = stdout};
	char id[RB_SLURM_ID_SIZE] = "";

	if ((uint64_t)options->tasks > most)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--tasks': %d is more than an array may have here (%" PRIu64
		               ")",
		               options->tasks, most);
	if (options->tasks > 0)
		order.tasks = (uint64_t)options->tasks;
	wish.tasks = order.tasks;
	enum rb_status status = reader_of(sweep, &wish.module, err);
	if (!status)
		status = rb_status_take(&left, &wish, err);
	if (!status)
		status = rb_slurm_write(&order, err);
	if (!status && left.due > 0)
		status = rb_slurm_submit(sweep->folder, left.array, id, err);
	if (!status && options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", sweep->shown);
		rb_json_text(&json, "job", *id ? id : NULL);
		rb_json_text(&json, "array", left.array);
		rb_json_count(&json, "tasks", order.tasks);
		rb_json_count(&json, "due", left.due);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!status) {
		if (*id)
			printf("%s\n", id);
		if (!options->quiet)
			fprintf(stderr, "rbsim: %s: %" PRIu64 " %s to be run%s%s\n", sweep->shown,
			        left.due, rb_text_plural(left.due, "point", "points"),
			        *id ? ", as tasks " : "", left.array);
	}
	rb_status_release(&left);
	return status;
}

/* ---- runs on this machine ---- */

/* 75: another call goes on. */
static int exit_code_of(const struct rb_jobs_tally *tally)
{
	if (tally->done + tally->failed < tally->total)
		return rb_status_exit_code(RB_ERR_AGAIN);
	return tally->failed > 0 ? rb_status_exit_code(RB_ERR_EXPECT) : 0;
}

/* The option of a version of rbsim that can go on with a run. */
static const char *resume_option(void)
{
	for (int i = 0; i < rb_option_row_count; i++)
		if (strcmp(rb_option_rows[i].name, "resume") == 0)
			return "--resume";
	return NULL;
}

/* Helpers that come with rbsim are looked for in the sweep's folder, from where the runs are. */
static void set_helpers(const struct rb_plan *plan)
{
	for (int i = 0; i < plan->file_count; i++)
		if (strncmp(plan->files[i].name, "rbsim.", 6) == 0)
			setenv("RBSIM_LUA_PATH", plan->films ? "../lua" : "lua", 1);
}

static void json_tally(const struct sweep *sweep, const struct rb_jobs_tally *tally, int exit_code)
{
	struct rb_json json = {.file = stdout};

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "sweep", sweep->shown);
	rb_json_text(&json, "scene", sweep->plan.scene);
	rb_json_count(&json, "points", tally->total);
	rb_json_count(&json, "done", tally->done);
	rb_json_count(&json, "failed", tally->failed);
	rb_json_count(&json, "running_elsewhere", tally->elsewhere);
	rb_json_count(&json, "runs", tally->ended);
	rb_json_number(&json, "wall_time", tally->wall_s);
	rb_json_number(&json, "processor_time", tally->cpu_s);
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_close(&json, '}');
	putchar('\n');
}

static enum rb_status run_points(const struct sweep *sweep, int *exit_code, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	const int threads = options->threads > 0 ? options->threads : 1;
	struct rb_overview overview;
	struct rb_jobs_tally tally;
	struct rb_jobs_order order = {.folder = sweep->folder,
	                              .plan = &sweep->plan,
	                              .jobs = options->jobs > 0 ? options->jobs
	                                                        : rb_team_processors() / threads,
	                              .threads = threads,
	                              .share = options->task >= 0 ? (uint64_t)options->task : 0,
	                              .shares = options->task >= 0 ? (uint64_t)options->tasks : 1,
	                              .retry = options->retry,
	                              .resume = resume_option(),
	                              .tick = rb_overview_tick,
	                              .told = rb_overview_told,
	                              .user = &overview};

	if (order.jobs < 1)
		order.jobs = 1;
	rb_overview_init(&overview, &sweep->plan, sweep->shown, options->quiet || options->json);
	order.tick_ms = rb_overview_tick_ms(&overview);
	set_helpers(&sweep->plan);
	enum rb_status status = reader_of(sweep, &order.module, err);
	if (status)
		return status;
	status = rb_jobs_run(&order, &tally, err);
	rb_overview_end(&overview, &tally, order.jobs);
	*exit_code = exit_code_of(&tally);
	if (!status && options->json)
		json_tally(sweep, &tally, *exit_code);
	return status;
}

/* Options that ask for different things. */
static enum rb_status check_options(const struct rb_options *options, struct rb_error *err)
{
	const char *const slurm = options->slurm_time               ? "time"
	                          : options->slurm_memory           ? "mem"
	                          : options->slurm_partition        ? "partition"
	                          : options->slurm_option_count > 0 ? "slurm-option"
	                                                            : NULL;

	if (options->sweep_status + options->sweep_plan + options->slurm + (options->task >= 0) > 1)
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"only one of '--status', '--plan', '--slurm' and '--task' can be asked for");
	if (options->task >= 0 && options->tasks == 0)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--task' needs '--tasks', the number of shares");
	if (options->task >= 0 && options->task >= options->tasks)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--task': %d is not one of %d shares, which count from 0",
		               options->task, options->tasks);
	if (options->tasks > 0 && options->task < 0 && !options->slurm && !options->sweep_status)
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--tasks' needs '--task', the share to run, '--slurm' or '--status'");
	if (slurm && !options->slurm)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--%s' needs '--slurm'", slurm);
	return RB_OK;
}

int rb_sweep_main(const struct rb_options *options)
{
	struct sweep sweep = {.options = options};
	struct rb_error err;
	bool scene_failed = false;
	int exit_code = 0;
	enum rb_status status = check_options(options, &err);

	if (!status)
		status = prepare(&sweep, &scene_failed, &err);
	if (status && scene_failed) {
		exit_code = rb_app_refuse_scene(options, &sweep.loaded, &err);
	} else if (!status) {
		if (options->sweep_plan)
			exit_code = tell_plan(&sweep);
		else if (options->sweep_status)
			status = tell_status(&sweep, &exit_code, &err);
		else if (options->slurm)
			status = submit(&sweep, &err);
		else
			status = run_points(&sweep, &exit_code, &err);
		if (status)
			exit_code = options->sweep_status ? rb_app_fail(options, &err)
			                                  : rb_app_refuse(options, &err);
	} else {
		exit_code = rb_app_refuse(options, &err);
	}
	release(&sweep);
	return rb_app_finish(options, exit_code);
}
