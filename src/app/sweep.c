/* SPDX-License-Identifier: MIT */
#include "app/sweep.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/common.h"
#include "app/json.h"
#include "app/overview.h"
#include "app/planned.h"
#include "app/progress.h"
#include "app/sweep_needs.h"
#include "base/team.h"
#include "base/visible.h"
#include "sweep/slurm.h"
#include "sweep/status.h"

/* ---- what becomes of it ---- */

/* Prints what all points will take. */
static void print_needs(const struct rb_planned *sweep, const struct rb_sweep_needs *needs)
{
	const char *const how = needs->at_least ? "at least" : "about";
	char time[32], shortest[32], longest[32], bytes[32], run_bytes[32];

	rb_progress_duration(time, sizeof time, needs->wall_s);
	rb_progress_duration(shortest, sizeof shortest, needs->shortest_s);
	rb_progress_duration(longest, sizeof longest, needs->longest_s);
	rb_print(stdout,
	         "  time        %s %s, %d at a time: a run takes %s to %s (tried: %" PRIu64
	         " of %" PRIu64 " points)\n",
	         how, time, needs->jobs, shortest, longest, needs->tried, sweep->plan.count);
	rb_print(stdout, "  memory      %s, a run at most %s, without films\n",
	         rb_text_bytes(needs->memory_bytes, bytes),
	         rb_text_bytes(needs->run_bytes, run_bytes));
	if (sweep->plan.records)
		rb_print(stdout, "  disk        %s of recordings\n",
		         rb_text_bytes(needs->disk_bytes, bytes));
	else
		rb_print(stdout, "  disk        nothing is recorded\n");
}

/* Serves --plan. */
static enum rb_status tell_plan(const struct rb_planned *sweep, struct rb_error *err)
{
	const struct rb_plan *const plan = &sweep->plan;
	struct rb_sweep_needs needs = {.wall_s = (double)NAN};
	struct rb_json json = {.file = stdout};

	if (sweep->loaded.model && (sweep->options->json || !sweep->options->quiet)) {
		const enum rb_status status = rb_sweep_needs_take(&needs, sweep, err);
		if (status)
			return status;
	}
	if (sweep->options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", sweep->shown);
		rb_json_text(&json, "scene", plan->scene);
		rb_json_count(&json, "points", plan->count);
		rb_json_count(&json, "tried_points", needs.tried);
		rb_json_count(&json, "jobs", (uint64_t)needs.jobs);
		rb_json_number(&json, "seconds", needs.wall_s);
		rb_json_bool(&json, "at_least", needs.at_least);
		rb_json_number(&json, "shortest_run_seconds", needs.shortest_s);
		rb_json_number(&json, "longest_run_seconds", needs.longest_s);
		rb_json_count(&json, "memory_bytes", needs.memory_bytes);
		rb_json_count(&json, "run_memory_bytes", needs.run_bytes);
		rb_json_count(&json, "disk_bytes", needs.disk_bytes);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!sweep->options->quiet) {
		rb_print(stdout, "%s: %" PRIu64 " %s of %s, listed in %s/" RB_FOLDER_PLAN "\n",
		         sweep->shown, plan->count, rb_text_plural(plan->count, "point", "points"),
		         plan->scene, sweep->shown);
		if (needs.tried > 0)
			print_needs(sweep, &needs);
	}
	return RB_OK;
}

/* A failed point as an object. */
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

/*
 * Where failed points are reported while the status is taken: the array of the JSON object, or
 * lines.
 */
struct failures {
	const struct rb_planned *sweep;
	struct rb_json *json; /* NULL: lines */
};

/* rb_status_wish.failed. */
static void tell_failure(void *user, uint64_t index, const struct rb_point *point)
{
	const struct failures *const failures = user;
	const struct rb_plan *const plan = &failures->sweep->plan;
	char label[160];

	if (failures->json)
		json_point(failures->json, plan, index, point);
	else if (!failures->sweep->options->quiet)
		rb_print(stdout, "  failed      %" PRIu64 " (%s), exit status %d: %s\n", index,
		         rb_plan_label(plan, index, label, sizeof label), point->exit_code,
		         *point->reason ? point->reason : "it gave no reason");
}

/* Prints how many points are in which state, and what is left. */
static void print_status(const struct rb_planned *sweep, const struct rb_sweep_status *status,
                         uint64_t tasks)
{
	static const enum rb_point_state order[] = {
		RB_POINT_DONE, RB_POINT_RUNNING, RB_POINT_FAILED, RB_POINT_BEGUN, RB_POINT_MISSING};
	const char *comma = "";

	rb_print(stdout, "%s: %" PRIu64 " %s of %s: ", sweep->shown, sweep->plan.count,
	         rb_text_plural(sweep->plan.count, "point", "points"), sweep->plan.scene);
	for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
		if (status->points[order[i]] == 0 && order[i] != RB_POINT_DONE)
			continue;
		rb_print(stdout, "%s%" PRIu64 " %s", comma, status->points[order[i]],
		         rb_point_state_names[order[i]]);
		comma = ", ";
	}
	putchar('\n');
	if (status->due > 0)
		rb_print(stdout,
		         "  to be run   %" PRIu64 ": 'rbsim sweep %s', or of %" PRIu64
		         " %s --array=%s\n",
		         status->due, sweep->shown, tasks, rb_text_plural(tasks, "task", "tasks"),
		         status->array);
}

/* Serves --status. */
static enum rb_status tell_status(const struct rb_planned *sweep, int *exit_code,
                                  struct rb_error *err)
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
	enum rb_status failed = rb_planned_reader(sweep, &wish.module, err);
	if (options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", sweep->shown);
		rb_json_text(&json, "scene", sweep->plan.scene);
		rb_json_count(&json, "points", sweep->plan.count);
		rb_json_open(&json, "failures", '[');
	}
	if (!failed)
		failed = rb_status_take(&status, &wish, err);
	if (options->json) {
		rb_json_close(&json, ']');
		for (int i = 0; i < RB_POINT_STATE_COUNT; i++)
			rb_json_count(&json, rb_point_state_names[i], status.points[i]);
		rb_json_count(&json, "due", status.due);
		rb_json_count(&json, "tasks", wish.tasks);
		rb_json_text(&json, "array", status.array);
		rb_json_text(&json, "error", failed ? err->text : NULL);
		rb_json_count(&json, "exit_status", (uint64_t)rb_status_exit_code(failed));
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!failed) {
		print_status(sweep, &status, wish.tasks);
	}
	rb_status_release(&status);
	return failed;
}

/* Serves --slurm: writes the script and submits the tasks with something left to do. */
static enum rb_status submit(const struct rb_planned *sweep, struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	const uint64_t most = rb_slurm_tasks_max();
	struct rb_slurm_order order = {.folder = sweep->folder,
	                               .name = sweep->plan.scene,
	                               .tasks = sweep->plan.count < most ? sweep->plan.count : most,
	                               .jobs = options->jobs > 0 ? options->jobs : 1,
	                               .threads = options->threads > 0 ? options->threads : 1,
	                               .checkpoint_every_s = options->checkpoint_every_s,
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
	enum rb_status status = rb_planned_reader(sweep, &wish.module, err);
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
			rb_print(stdout, "%s\n", id);
		if (!options->quiet)
			rb_print(stderr, "rbsim: %s: %" PRIu64 " %s to be run%s%s\n", sweep->shown,
			         left.due, rb_text_plural(left.due, "point", "points"),
			         *id ? ", as tasks " : "", left.array);
	}
	rb_status_release(&left);
	return status;
}

/* ---- runs on this machine ---- */

/* 75: another call goes on; the status of a point that lacked something; 1: others failed. */
static int exit_code_of(const struct rb_jobs_tally *tally)
{
	if (tally->done + tally->failed < tally->total)
		return rb_status_exit_code(RB_ERR_AGAIN);
	if (tally->failed == 0)
		return 0;
	return tally->lack ? tally->lack : rb_status_exit_code(RB_ERR_EXPECT);
}

/* Makes runs look for helpers that come with rbsim in the sweep's folder, from where they work. */
static void set_helpers(const struct rb_plan *plan)
{
	for (int i = 0; i < plan->file_count; i++)
		if (strncmp(plan->files[i].name, "rbsim.", 6) == 0)
			setenv("RBSIM_LUA_PATH", plan->films ? "../lua" : "lua", 1);
}

/* Prints the outcome as an object. */
static void json_tally(const struct rb_planned *sweep, const struct rb_jobs_tally *tally,
                       int exit_code)
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

/* Runs the points on this machine. */
static enum rb_status run_points(const struct rb_planned *sweep, int *exit_code,
                                 struct rb_error *err)
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
	                              .checkpoint_every_s = options->checkpoint_every_s,
	                              .point_time_s = options->point_time_s,
	                              .point_disk_bytes = options->point_disk_bytes,
	                              .mask_before = sweep->mask_before,
	                              .tick = rb_overview_tick,
	                              .told = rb_overview_told,
	                              .user = &overview};

	if (order.jobs < 1)
		order.jobs = 1;
	rb_overview_init(&overview, &sweep->plan, sweep->shown, options->quiet || options->json);
	order.tick_ms = rb_overview_tick_ms(&overview);
	set_helpers(&sweep->plan);
	enum rb_status status = rb_planned_reader(sweep, &order.module, err);
	if (status)
		return status;
	status = rb_jobs_run(&order, &tally, err);
	rb_overview_end(&overview, &tally, order.jobs);
	*exit_code = exit_code_of(&tally);
	if (!status && options->json)
		json_tally(sweep, &tally, *exit_code);
	return status;
}

/* Refuses options that ask for different things. */
static enum rb_status check_options(const struct rb_options *options, struct rb_error *err)
{
	const char *const slurm = options->slurm_time               ? "time"
	                          : options->slurm_memory           ? "mem"
	                          : options->slurm_partition        ? "partition"
	                          : options->slurm_option_count > 0 ? "slurm-option"
	                                                            : NULL;

	if (options->sweep_status + options->sweep_plan + options->slurm + (options->task >= 0) > 1)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "only one of '--status', '--plan', '--slurm' and '--task' can be "
		               "asked for");
	if (options->task >= 0 && options->tasks == 0)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--task' needs '--tasks', the number of shares");
	if (options->task >= 0 && options->task >= options->tasks)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--task': %d is not one of %d shares, which count from 0",
		               options->task, options->tasks);
	if (options->tasks > 0 && options->task < 0 && !options->slurm && !options->sweep_status)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--tasks' needs '--task', the share to run, '--slurm' or "
		               "'--status'");
	if (slurm && !options->slurm)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--%s' needs '--slurm'", slurm);
	return RB_OK;
}

int rb_sweep_main(const struct rb_options *options)
{
	struct rb_planned sweep = {0};
	struct rb_error err;
	bool scene_failed = false;
	int exit_code = 0;
	enum rb_status status = check_options(options, &err);

	if (!status)
		status = rb_planned_init(&sweep, options, &scene_failed, &err);
	if (status && scene_failed) {
		exit_code = rb_app_refuse_scene(options, &sweep.loaded, &err);
	} else if (!status) {
		if (options->sweep_plan)
			status = tell_plan(&sweep, &err);
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
	rb_planned_release(&sweep);
	return rb_app_finish(options, exit_code);
}
