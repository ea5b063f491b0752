/* SPDX-License-Identifier: MIT */
/*
 * Nothing but running tells how long a scene takes, so `check` runs it: at the real settings for
 * the first two seconds of processor time; if that does not reach the end, a coarse world is
 * carried through the whole time at low cost, and at six moments its state is handed to a world
 * with the real settings, which is timed for a quarter of a second. Each trial is a forked process,
 * because memory is measured too and a world keeps what it has taken.
 */
#include "app/estimate.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"
#include "method/method.h"
#include "model/descriptor.h"
#include "script/hooks.h"
#include "stepped/stepped.h"
#include "world/world.h"

/*
 * MOMENTS of the rest are tried. Seconds of the processor that each kind of trial may take: the
 * parent's warm-up, the first trial, the coarse world, a moment until it has settled, and the
 * measurement of a moment. A coarse state has left what it owes to its tolerance behind after a
 * part of the time.
 */
enum { MOMENTS = 6 };
static const double warm_up_s = 0.02, first_s = 2, coarse_s = 4, settle_s = 0.5, measure_s = 0.25;
/*
 * Part of the smallest size: overlaps that a coarse step leaves. They are halved at each step
 * (stepped/drift).
 */
static const double coarse_overlap = 0.02;
/* Steps after which a moment counts as settled, by its own time step. */
enum { SETTLE_STEPS = 96 };

/* What a trial tells: of the run so far, or of one moment. */
struct report {
	double reached_s; /* simulated time */
	double wall_s;    /* that it has taken; of a moment for each simulated second */
	uint64_t frames;
	uint64_t grown_bytes; /* see grown() */
	uint64_t made_bytes;  /* of the world before its first step */
	bool whole;           /* it has come to the end */
	bool stands;          /* it has come further at all */
};

struct trial {
	const struct rb_loaded *loaded;
	struct rb_world *world;
	struct rb_frame frame;
	double settled_s; /* simulated: it has settled at the latest then */
	uint64_t settled_ns, deadline_ns, allowed_ns; /* by the processor's time of this thread */
	uint64_t from_ns; /* wall: when it had settled, 0: not yet, and where it was then */
	double from_s;
	uint64_t code_bytes; /* pages of program and libraries that `check` has */
	/* own pages before the warm-up: what that has left behind is used again */
	uint64_t begin_bytes;
	int threads;
};

/* rb_world_options.stop: ends the trial when its time is over; notes when it has settled. */
static bool is_up(void *user)
{
	struct trial *trial = user;
	const uint64_t cpu_ns = rb_clock_cpu_ns();

	if (trial->from_ns == 0 && trial->world &&
	    (cpu_ns > trial->settled_ns || rb_world_time(trial->world) > trial->settled_s)) {
		trial->from_ns = rb_clock_now_ns();
		trial->from_s = rb_world_time(trial->world);
		trial->deadline_ns = cpu_ns + trial->allowed_ns;
	}
	return trial->from_ns > 0 && cpu_ns > trial->deadline_ns;
}

/*
 * Begins a trial's time: `settle` s of processor time at most until it is measured, then `seconds`.
 */
static void allow(struct trial *trial, double settle, double seconds)
{
	const uint64_t cpu_ns = rb_clock_cpu_ns();

	trial->from_ns = 0;
	trial->settled_ns = cpu_ns + (uint64_t)(1e9 * settle);
	trial->allowed_ns = (uint64_t)(1e9 * seconds);
}

/* Makes a world as a run would. */
static enum rb_status make_world(struct trial *trial, const struct rb_model *model, int threads,
                                 const struct rb_world_hooks *hooks)
{
	const struct rb_loaded *loaded = trial->loaded;
	const unsigned fields = loaded->output ? loaded->scene.record.fields : 0;
	const struct rb_world_options options = {.threads = threads,
	                                         .keep_events = fields & RB_FIELD_EVENTS,
	                                         .keep_contacts = fields & RB_FIELD_CONTACTS,
	                                         .stop = is_up,
	                                         .stop_user = trial};

	return rb_world_create(&trial->world, model, &options, hooks, NULL);
}

/* One frame on, as a run goes; false: no further. */
static bool go_on(struct trial *trial)
{
	struct rb_world *world = trial->world;

	return rb_world_frame(world) + 1 < rb_world_frame_count(world) &&
	       rb_world_step_frame(world, NULL) == RB_OK && !rb_world_stopped(world) &&
	       rb_world_fill_frame(world, &trial->frame, NULL) == RB_OK &&
	       rb_script_on_frame(trial->loaded->script, world, rb_world_time(world),
	                          rb_world_frame(world), NULL) == RB_OK;
}

/*
 * Bytes that the trial has taken: own pages that have come, and pages of the program and of
 * libraries beyond those that the parent has, since a forked process has these only when it uses
 * them again.
 */
static uint64_t grown(const struct trial *trial)
{
	const uint64_t own = rb_process_bytes("RssAnon"), code = rb_process_bytes("RssFile");

	return (own > trial->begin_bytes ? own - trial->begin_bytes : 0) +
	       (code > trial->code_bytes ? code - trial->code_bytes : 0);
}

/* ---- a trial in a process of its own ---- */

typedef void trial_function(struct trial *trial, int to);

/* Sends a report; a trial that cannot tell has told nothing. */
static void send(int to, const struct report *report)
{
	const ssize_t sent = write(to, report, sizeof *report);

	(void)sent; /* a trial that cannot tell has told nothing */
}

/* Receives a report; false: the child has ended without one. */
static bool receive(int from, struct report *report)
{
	ssize_t got;

	do
		got = read(from, report, sizeof *report);
	while (got < 0 && errno == EINTR);
	return got == (ssize_t)sizeof *report;
}

/* Runs a trial in a forked process; -1: it cannot be. `from`: where its reports come. */
static pid_t begin(trial_function *function, struct trial *trial, int *from)
{
	int ends[2];

	if (pipe2(ends, O_CLOEXEC) != 0)
		return -1;
	const pid_t child = fork();
	if (child == 0) {
		const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);

		for (int fd = 0; fd <= STDERR_FILENO && nowhere >= 0; fd++)
			dup2(nowhere, fd);
		close(ends[0]);
		function(trial, ends[1]);
		_exit(0);
	}
	close(ends[1]);
	*from = ends[0];
	if (child < 0)
		close(ends[0]);
	return child;
}

/* Waits for a trial to end. */
static void end(pid_t child, int from)
{
	close(from);
	while (waitpid(child, NULL, 0) < 0 && errno == EINTR)
		;
}

/* ---- the three trials ---- */

/* The run from its beginning. */
static void try_run(struct trial *trial, int to)
{
	const struct rb_world_hooks hooks = rb_script_hooks(trial->loaded->script);
	const uint64_t begin_ns = rb_clock_now_ns();
	struct report report = {.stands = true};

	allow(trial, 0, first_s);
	const uint64_t before = rb_memory_counts().bytes_now;
	if (make_world(trial, trial->loaded->model, trial->threads, &hooks))
		return;
	report.made_bytes = rb_memory_counts().bytes_now - before;
	if (go_on(trial)) {
		/* columns that nothing writes to take no memory */
		const uint64_t grown_bytes = grown(trial);

		if (grown_bytes < report.made_bytes)
			report.made_bytes = grown_bytes;
		while (go_on(trial))
			;
	}
	report.wall_s = (double)(rb_clock_now_ns() - begin_ns) * 1e-9;
	report.frames = rb_world_frame(trial->world) + 1;
	report.whole = !rb_world_stopped(trial->world);
	report.reached_s = rb_world_time(trial->world);
	report.grown_bytes = grown(trial);
	send(to, &report);
}

/* From the state of `trial`, which is a coarse one, as the run would go on. */
static void try_moment(struct trial *trial, int to)
{
	const struct rb_world_hooks hooks = rb_script_hooks(trial->loaded->script);
	struct trial real = *trial;
	struct report report = {.reached_s = rb_world_time(trial->world)};
	struct rb_state state;

	/* one world at a time, for the memory that it takes */
	if (rb_state_init(&state, trial->world->state.body_count, trial->loaded->model->features,
	                  NULL))
		return;
	rb_state_copy(&state, &trial->world->state);
	rb_world_destroy(trial->world);
	real.world = NULL;
	allow(&real, settle_s, measure_s);
	real.settled_s = report.reached_s + SETTLE_STEPS * trial->loaded->model->time_step_s;
	if (make_world(&real, trial->loaded->model, trial->threads, &hooks) == RB_OK) {
		rb_state_copy(&real.world->state, &state);
		while (go_on(&real))
			;
		const double way_s = rb_world_time(real.world) - real.from_s;
		report.stands = real.from_ns > 0 && way_s > 0;
		report.wall_s = (double)(rb_clock_now_ns() - real.from_ns) * 1e-9 / way_s;
		report.grown_bytes = grown(&real);
	}
	send(to, &report);
}

/* Carries the coarse world to a time; false: it does not get there. */
static bool coarse_to(struct trial *trial, double time_s)
{
	bool goes = true;

	while (goes && rb_world_time(trial->world) < time_s)
		goes = go_on(trial);
	return goes || !(rb_world_time(trial->world) < time_s);
}

/* Tries the moments in the middle of equal parts of what the first trial has left. */
static void try_coarse(struct trial *trial, int to)
{
	const struct rb_world_hooks hooks = rb_script_hooks(trial->loaded->script);
	struct rb_model coarse = *trial->loaded->model;
	const double from_s = trial->from_s, part_s = (coarse.duration_s - from_s) / MOMENTS;

	coarse.tolerance_m = coarse.stepped_tolerance_m = fmax(coarse.stepped_tolerance_m,
	                                                       coarse_overlap * coarse.size_min_m);
	coarse.time_step_s = fmax(coarse.time_step_s, 1 / coarse.frame_rate);
	if (rb_model_method_row(&coarse)->locates)
		coarse.method = RB_METHOD_STEPPED;
	coarse.keeps_ledger = false;
	/* one thread: a process that is forked has no others */
	allow(trial, 0, coarse_s);
	if (make_world(trial, &coarse, 1, &hooks))
		return;
	for (int k = 0; k < MOMENTS; k++) {
		struct report report;
		int from;

		if (!coarse_to(trial, from_s + (k + 0.5) * part_s))
			return;
		const pid_t child = begin(try_moment, trial, &from);
		if (child < 0)
			return;
		if (receive(from, &report))
			send(to, &report);
		end(child, from);
	}
}

/* ---- what they say together ---- */

/*
 * Reduces the largest rate to the next where it is far beyond that: a state that was made coarsely
 * can hold bodies that are stuck in each other, and one such moment would stand for minutes.
 */
static void tame_largest(double *rate, int count)
{
	const double far_ratio = 8;
	int largest = 0;
	double next = 0;

	for (int k = 1; k < count; k++)
		largest = rate[k] > rate[largest] ? k : largest;
	for (int k = 0; k < count; k++)
		next = k != largest ? fmax(next, rate[k]) : next;
	if (count > 1 && rate[largest] > far_ratio * next)
		rate[largest] = next;
}

/*
 * Bytes that bodies take by steps once they lie in a heap, which trials that do not come to the end
 * may not have seen, beyond those of a world that has been made.
 */
static uint64_t heap_bytes(const struct rb_model *model, int threads)
{
	const bool steps = model->method == RB_METHOD_STEPPED || model->method == RB_METHOD_AUTO;

	return steps && (model->features & RB_FEATURE_CONTACT) &&
	                       (model->features & RB_FEATURE_GRAVITY) && model->static_count > 0
	               ? rb_stepped_heap_bytes(model, threads)
	               : 0;
}

/* Adds the time of the rest, from the rates at its moments. */
static void add_moments(struct trial *trial, const struct report *first,
                        struct rb_estimate *estimate)
{
	const double part_s = (trial->loaded->model->duration_s - first->reached_s) / MOMENTS;
	double rate[MOMENTS]; /* s for each simulated second */
	double last = first->reached_s > 0 ? first->wall_s / first->reached_s : (double)NAN;
	uint64_t grown_bytes = first->grown_bytes;
	struct report report;
	int from, count = 0;

	trial->from_s = first->reached_s;
	const pid_t child = begin(try_coarse, trial, &from);
	while (child > 0 && count < MOMENTS && receive(from, &report)) {
		last = report.stands ? report.wall_s : last;
		rate[count++] = last;
		estimate->reached_s = report.reached_s;
		grown_bytes = report.grown_bytes > grown_bytes ? report.grown_bytes : grown_bytes;
	}
	if (child > 0)
		end(child, from);
	estimate->at_least = count < MOMENTS;
	const uint64_t heap = first->made_bytes + heap_bytes(trial->loaded->model, trial->threads);
	if (estimate->at_least && heap > grown_bytes)
		grown_bytes = heap;
	tame_largest(rate, count);
	estimate->run_s = first->wall_s;
	for (int k = 0; k < MOMENTS; k++)
		estimate->run_s += part_s * (k < count   ? rate[k]
		                             : count > 0 ? rate[count - 1]
		                                         : last);
	estimate->memory_bytes += grown_bytes - first->grown_bytes;
}

/*
 * The parent goes a little way itself, without callbacks: what a simulator needs of program and
 * libraries is then among its pages.
 */
static enum rb_status warm_up(struct trial *trial)
{
	const struct rb_world_hooks all = rb_script_hooks(trial->loaded->script);
	const struct rb_world_hooks hooks = rb_world_hooks_asked(&all);

	allow(trial, 0, warm_up_s);
	const enum rb_status status = make_world(trial, trial->loaded->model, 1, &hooks);
	if (status)
		return status;
	while (rb_world_frame(trial->world) + 1 < rb_world_frame_count(trial->world))
		if (rb_world_step_frame(trial->world, NULL) || rb_world_stopped(trial->world))
			break;
	rb_world_destroy(trial->world);
	trial->world = NULL;
	return status;
}

enum rb_status rb_estimate_run(const struct rb_loaded *loaded, int threads,
                               struct rb_estimate *estimate, struct rb_error *err)
{
	struct trial trial = {
		.loaded = loaded, .threads = threads, .begin_bytes = rb_process_bytes("RssAnon")};
	struct report first = {0};
	int from;

	RB_ASSERT(loaded->model && threads > 0);
	*estimate = (struct rb_estimate){.run_s = (double)NAN};
	if (warm_up(&trial))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory to try the run");
	const enum rb_status status = rb_frame_init(&trial.frame, loaded->model, 0, err);
	if (status)
		return status;
	trial.code_bytes = rb_process_bytes("RssFile");
	const pid_t child = begin(try_run, &trial, &from);
	const bool stands = child > 0 && receive(from, &first);
	if (child > 0)
		end(child, from);
	estimate->memory_bytes = trial.begin_bytes + trial.code_bytes + first.grown_bytes;
	estimate->tried_frames = first.frames;
	estimate->reached_s = first.reached_s;
	estimate->run_s = stands && first.whole ? first.wall_s : (double)NAN;
	if (stands && !first.whole)
		add_moments(&trial, &first, estimate);
	rb_frame_release(&trial.frame);
	return RB_OK;
}
