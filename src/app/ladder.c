/* SPDX-License-Identifier: MIT */
/*
 * A rung is one setting (method, time step, tolerance) run in a child process: a crash, a lack of
 * memory or a run without end is a result like any other. The child sends a struct through a pipe;
 * paths go through shared memory (deviation). What is timed is the simulation without the
 * comparison: the stopwatch is halted meanwhile.
 */
#include "app/ladder.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/common.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "flow/frame.h"
#include "math/vec3.h"
#include "script/hooks.h"

const struct rb_ladder_method rb_ladder_methods[] = {
	{"classic", "classic", "selective"},     {"classic-global", "classic", "global"},
	{"classic-none", "classic", "none"},     {"located", "located", "selective"},
	{"located-global", "located", "global"}, {"stepped", "stepped", "selective"},
};
const int rb_ladder_method_count = sizeof rb_ladder_methods / sizeof *rb_ladder_methods;

/* 2^-50, four units of rounding: what happens to it shows what happens to rounding. */
static const double nudge = 0x1p-50;

const char *rb_rung_state_name(enum rb_rung_state state)
{
	static const char *const names[] = {[RB_RUNG_OK] = "ok",
	                                    [RB_RUNG_FAILED] = "failed",
	                                    [RB_RUNG_TOO_LONG] = "too long",
	                                    [RB_RUNG_CRASHED] = "crashed"};

	RB_ASSERT(state <= RB_RUNG_CRASHED);
	return names[state];
}

/* ---- in the child ---- */

/* A clock in s. */
static double seconds_of(clockid_t clock)
{
	struct timespec now;

	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Wall and processor time, less the pauses. */
struct stopwatch {
	double wall_s, cpu_s;
};

/* Starts or continues. */
static void go(struct stopwatch *watch)
{
	watch->wall_s -= seconds_of(CLOCK_MONOTONIC);
	watch->cpu_s -= seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

/* Pauses. */
static void halt(struct stopwatch *watch)
{
	watch->wall_s += seconds_of(CLOCK_MONOTONIC);
	watch->cpu_s += seconds_of(CLOCK_PROCESS_CPUTIME_ID);
}

/*
 * Multiplies all speeds by 1 + nudge, once the world is there; gravity is changed in the scene
 * before.
 */
static void nudge_speeds(struct rb_world *world)
{
	for (int id = 0; id < rb_world_id_count(world); id++) {
		if (rb_world_is_static(world, id) || isinf(rb_world_mass(world, id)))
			continue;
		const rb_vec3 v = rb_world_velocity(world, id);
		if (rb_vec3_max_abs(v) > 0)
			rb_world_set_velocity(world, id, rb_vec3_scale(1 + nudge, v));
	}
}

/* One simulation in the child. */
struct flight {
	const struct rb_rung_order *order;
	struct rb_loaded *loaded;
	struct rb_world *world;
	struct rb_frame frame;
	struct rb_watch *watch; /* NULL: only the time counts */
	struct stopwatch time;
	struct rb_rung_result *result;
};

/* Steps through the run, compares, and calls the script's callbacks. */
static enum rb_status frames(struct flight *flight, struct rb_error *err)
{
	struct rb_script *const script = flight->loaded->script;
	const uint64_t count = rb_world_frame_count(flight->world);

	for (uint64_t k = 0; k < count; k++) {
		enum rb_status status = k > 0 ? rb_world_step_frame(flight->world, err) : RB_OK;
		if (!status)
			status = rb_world_fill_frame(flight->world, &flight->frame, err);
		if (status)
			return status;
		flight->result->max_penetration_m = rb_larger(
			flight->result->max_penetration_m, flight->frame.numbers.max_penetration);
		if (flight->watch) {
			halt(&flight->time);
			status = rb_watch_frame(flight->watch, flight->world, &flight->frame, err);
			go(&flight->time);
		}
		if (!status)
			status = rb_script_on_frame(script, flight->world,
			                            rb_world_time(flight->world), k, err);
		if (status)
			return status;
	}
	return RB_OK;
}

/* Makes a world and simulates to the end. */
static enum rb_status fly(struct flight *flight, struct rb_error *err)
{
	const struct rb_model *const model = flight->loaded->model;
	const struct rb_world_hooks hooks = rb_script_hooks(flight->loaded->script);
	const struct rb_world_options options = {
		.threads = flight->order->options->threads > 0 ? flight->order->options->threads
	                                                       : 1};
	enum rb_status status = rb_frame_init(&flight->frame, model,
	                                      flight->watch ? RB_FIELD_DEFAULT : 0, err);

	go(&flight->time);
	if (!status)
		status = rb_world_create(&flight->world, model, &options, &hooks, err);
	if (!status && flight->order->nudge)
		nudge_speeds(flight->world);
	if (!status)
		status = frames(flight, err);
	halt(&flight->time);
	if (!status) {
		const struct rb_frame_numbers totals = rb_world_totals(flight->world);
		const struct rb_world_work work = rb_world_work(flight->world);
		flight->result->events = totals.collisions;
		flight->result->rollbacks = totals.rollbacks;
		flight->result->body_steps = work.body_steps;
		flight->result->discarded_body_steps = work.discarded_body_steps;
	}
	rb_world_destroy(flight->world);
	rb_frame_release(&flight->frame);
	return status;
}

/* The command line with this setting in place of what it or the scene says. */
static struct rb_options options_of(const struct rb_rung_order *order)
{
	struct rb_options options = *order->options;

	options.method = order->method->method;
	options.rollback = order->method->rollback;
	options.time_step_s = order->time_step_s;
	options.tolerance_m = order->tolerance_m;
	options.output = NULL;
	options.no_record = true;
	return options;
}

/* Loads and simulates once. The first time it is compared as well; times are the least of all. */
static enum rb_status run_once(const struct rb_rung_order *order, bool first,
                               struct rb_rung_result *result, struct rb_error *err)
{
	const struct rb_options options = options_of(order);
	struct rb_loaded loaded;
	struct rb_watch watch = {.against = order->against,
	                         .store = order->store,
	                         .until_s = order->until_s,
	                         .agree_quantity = order->agree_quantity,
	                         .agree = order->agree};
	struct flight flight = {.order = order,
	                        .loaded = &loaded,
	                        .watch = first ? &watch : NULL,
	                        .result = result};
	enum rb_status status = rb_loaded_init(&loaded, &options, err);

	result->refused = status != RB_OK;
	if (!status && order->nudge)
		loaded.scene.world.gravity = rb_vec3_scale(1 + nudge, loaded.scene.world.gravity);
	if (order->by_reference)
		watch.script = loaded.script;
	if (!status && first)
		status = rb_watch_start(&watch, loaded.model, err);
	if (!status)
		status = fly(&flight, err);
	if (!status && first) {
		rb_watch_end(&watch);
		memcpy(result->of, watch.of, sizeof result->of);
		result->energy_drifts = watch.energy_drifts;
		result->agree_s = watch.agree_s;
		result->start = watch.start;
	}
	if (!status) {
		result->wall_s = first ? flight.time.wall_s
		                       : fmin(result->wall_s, flight.time.wall_s);
		result->cpu_s = first ? flight.time.cpu_s : fmin(result->cpu_s, flight.time.cpu_s);
		result->runs++;
	}
	rb_watch_release(&watch);
	rb_loaded_release(&loaded);
	return status;
}

/*
 * Repeats short runs while they fit into repeat_s: the least time is the one that other processes
 * disturbed least.
 */
static void run_all(const struct rb_rung_order *order, struct rb_rung_result *result)
{
	const double start_s = seconds_of(CLOCK_MONOTONIC);
	struct rb_error err;
	enum rb_status status = RB_OK;

	RB_ASSERT(order->runs >= 1);
	for (int i = 0; i < order->runs && !status; i++) {
		if (i > 0 &&
		    seconds_of(CLOCK_MONOTONIC) - start_s + result->wall_s > order->repeat_s)
			break;
		status = run_once(order, i == 0, result, &err);
	}
	if (status) {
		result->state = RB_RUNG_FAILED;
		result->exit_status = rb_status_exit_code(status);
		snprintf(result->text, sizeof result->text, "%s",
		         *err.text ? err.text : rb_status_name(status));
	}
}

/* The child. What a scene prints would stand here once for every run, so it goes nowhere. */
static _Noreturn void child(const struct rb_rung_order *order, int descriptor, pid_t parent)
{
	struct rb_rung_result result = {.state = RB_RUNG_OK};
	size_t sent = 0;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent) /* it ended before that was set */
		_exit(70);
	rb_log_to(NULL, NULL, RB_LOG_WARNING);
	run_all(order, &result);
	while (sent < sizeof result) {
		const ssize_t wrote = write(descriptor, (const char *)&result + sent,
		                            sizeof result - sent);
		if (wrote < 0 && errno == EINTR)
			continue;
		if (wrote <= 0)
			_exit(74);
		sent += (size_t)wrote;
	}
	_exit(0);
}

/* ---- in the parent ---- */

/* Receives the whole result, or false: the child has ended, or the time is up (*late). */
static bool receive(int descriptor, struct rb_rung_result *result, double deadline_s, bool *late)
{
	const double end_s = seconds_of(CLOCK_MONOTONIC) + deadline_s;
	size_t got = 0;

	while (got < sizeof *result) {
		struct pollfd wait = {.fd = descriptor, .events = POLLIN};
		const double left_s = end_s - seconds_of(CLOCK_MONOTONIC);
		const int ready = left_s > 0 ? poll(&wait, 1, (int)fmin(1000 * left_s + 1, 1e6))
		                             : 0;
		if (ready < 0 && errno != EINTR)
			return false;
		*late = left_s <= 0;
		if (*late)
			return false;
		if (ready <= 0)
			continue;
		const ssize_t more = read(descriptor, (char *)result + got, sizeof *result - got);
		if (more < 0 && errno == EINTR)
			continue;
		if (more <= 0)
			return false;
		got += (size_t)more;
	}
	return true;
}

/* The result of a child that has sent none. */
static void tell_end(struct rb_rung_result *result, int status, bool late, double deadline_s)
{
	*result = (struct rb_rung_result){
		.state = late ? RB_RUNG_TOO_LONG : RB_RUNG_CRASHED,
		.exit_status = rb_status_exit_code(late ? RB_ERR_PHYSICS : RB_ERR_BUG)};
	if (late)
		snprintf(result->text, sizeof result->text, "ended after %.3g s of wall time",
		         deadline_s);
	else if (WIFSIGNALED(status))
		snprintf(result->text, sizeof result->text, "ended by signal %d", WTERMSIG(status));
	else
		snprintf(result->text, sizeof result->text, "ended with status %d",
		         WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

enum rb_status rb_rung_run(struct rb_rung_result *result, const struct rb_rung_order *order,
                           struct rb_error *err)
{
	const double start_s = seconds_of(CLOCK_MONOTONIC);
	const pid_t parent = getpid();
	bool late = false;
	int ends[2], status = 0;

	RB_ASSERT(order->method && order->deadline_s > 0);
	if (pipe(ends) != 0)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot make a pipe: %s", strerror(errno));
	fflush(stdout);
	fflush(stderr);
	const pid_t pid = fork();
	if (pid == 0) {
		close(ends[0]);
		child(order, ends[1], parent);
	}
	close(ends[1]);
	if (pid < 0) {
		close(ends[0]);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a process: %s", strerror(errno));
	}
	const bool whole = receive(ends[0], result, order->deadline_s, &late);
	close(ends[0]);
	if (!whole && late)
		kill(pid, SIGKILL);
	while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
		continue;
	if (!whole)
		tell_end(result, status, late, order->deadline_s);
	result->spent_s = seconds_of(CLOCK_MONOTONIC) - start_s;
	return RB_OK;
}
