/* SPDX-License-Identifier: MIT */
/*
 * A single-threaded loop: fill free places with due points, wait for a signal, see to bounds, reap,
 * repeat. All signals are blocked and taken by sigtimedwait, so there are no handlers, and SIGCHLD
 * cannot be missed between looking and waiting. Children are waited for one by one by their number,
 * because the program may have others.
 *
 * What a run computes is never passed back through memory: each child writes its result to its
 * file, and the state of a point is derived from there (sweep/point). So a killed sweep loses
 * nothing. A point is guarded by a lock on its log, which the child inherits: it holds while any of
 * both lives.
 */
#include "sweep/jobs.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/place.h"
#include "base/program.h"
#include "base/thread.h"
#include "sweep/usage.h"

enum { DUE = 1, ELSEWHERE };
/*
 * Exit status stored for a run that was ended because it took too long, as timeout(1) has it, or
 * too much disk.
 */
enum { EXIT_OVERDUE = 124 };
/* s: from asking a run to end, which leaves time to write a checkpoint, to killing it. */
static const double overdue_s = 30;
/*
 * s: between two looks at what runs have taken of the disk; a look reads the folder of the sweep.
 */
static const double look_s = 1;

/* A run under way; free where process is 0. */
struct place {
	pid_t process; /* 0: free */
	uint64_t index;
	int log; /* keeps the lock */
	uint64_t start_ns, warned_ns;
	int warned;     /* signals sent because it takes too long, or too much */
	bool too_large; /* it is the disk that it has taken too much of */
};

struct jobs {
	const struct rb_jobs_order *order;
	struct rb_jobs_tally *tally;
	struct place *places;
	unsigned char
		*due;  /* by number within the share: DUE, or ELSEWHERE: another process has it */
	uint64_t next; /* number of the first that may be due */
	const char **words; /* of one run's command line */
	char *text;         /* what is made of them */
	size_t text_size;
	sigset_t signals;
	uint64_t start_ns, ticked_ns, looked_ns;
};

/* ---- signals ---- */

void rb_jobs_hold_signals(sigset_t *mask_before)
{
	const sigset_t signals = rb_thread_stops();

	sigprocmask(SIG_BLOCK, &signals, mask_before);
}

/* ---- what is due ---- */

/* Index in the plan of the point that has this number within our share. */
static uint64_t index_of(const struct jobs *jobs, uint64_t number)
{
	RB_ASSERT(number < jobs->tally->total);
	return jobs->order->share + number * jobs->order->shares;
}

/* Reports a point to the caller, who may not want to know. */
static void tell(const struct jobs *jobs, uint64_t index, const struct rb_point *point)
{
	if (jobs->order->told)
		jobs->order->told(jobs->order->user, index, point);
}

/* True if a run that ended with this status lacked something that the machine has to give. */
static bool lacked(int exit_code)
{
	return exit_code == rb_status_exit_code(RB_ERR_MISSING) ||
	       exit_code == rb_status_exit_code(RB_ERR_MEMORY) ||
	       exit_code == rb_status_exit_code(RB_ERR_CREATE) ||
	       exit_code == rb_status_exit_code(RB_ERR_IO);
}

/* Counts a point that is done or has failed. Which one names the lack does not depend on time. */
static void count(struct rb_jobs_tally *tally, uint64_t index, const struct rb_point *point)
{
	tally->done += point->state == RB_POINT_DONE;
	if (point->state != RB_POINT_FAILED)
		return;
	tally->failed++;
	if (lacked(point->exit_code) && (tally->lack == 0 || index < tally->lacking)) {
		tally->lack = point->exit_code;
		tally->lacking = index;
	}
}

/*
 * Looks at all points of the share and counts them. Failed points that stay so are reported here,
 * so that a sweep that goes on lists all failures, not only new ones.
 */
static enum rb_status survey(struct jobs *jobs, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;
	struct rb_jobs_tally *const tally = jobs->tally;
	struct rb_point point;

	for (uint64_t k = 0; k < tally->total; k++) {
		const uint64_t index = index_of(jobs, k);
		const enum rb_status status = rb_point_look(order->folder, order->plan, index,
		                                            order->module, &point, err);
		if (status)
			return status;
		const bool due = rb_point_is_due(&point, order->retry);
		jobs->due[k] = point.state == RB_POINT_RUNNING ? ELSEWHERE : due ? DUE : 0;
		tally->due += due;
		tally->elsewhere += point.state == RB_POINT_RUNNING;
		if (due)
			continue;
		count(tally, index, &point);
		if (point.state == RB_POINT_FAILED)
			tell(jobs, index, &point);
	}
	return RB_OK;
}

/* ---- one run ---- */

/*
 * Appends a word, borrowed, to the command line; prepare has reserved room for 16 besides those of
 * the plan.
 */
static void add_word(struct jobs *jobs, int *count, const char *word)
{
	jobs->words[(*count)++] = word;
}

/*
 * Composes the command line of a point in jobs->words and jobs->text, valid until the next call.
 * Paths are relative to the folder where the run works: the sweep's, or the point's own, one level
 * below, where it makes films.
 */
static void command_of(struct jobs *jobs, uint64_t index, bool goes_on)
{
	const struct rb_plan *const plan = jobs->order->plan;
	const char *const up = plan->films ? "../" : "";
	char number[RB_AXIS_NUMBER_SIZE], path[RB_FOLDER_PATH_SIZE];
	char *at = jobs->text;
	char *const end = at + jobs->text_size;
	int count = 0;

	RB_ASSERT(index < plan->count);
	add_word(jobs, &count, "rbsim");
	add_word(jobs, &count, "run");
	add_word(jobs, &count, "--json");
	add_word(jobs, &count, goes_on ? "--resume" : "--force");
	for (int i = 0; i < plan->word_count; i++)
		add_word(jobs, &count, plan->words[i]);
#define ADD(...) \
	(add_word(jobs, &count, at), at += snprintf(at, (size_t)(end - at), __VA_ARGS__) + 1)
	ADD("--threads=%d", jobs->order->threads);
	if (!isnan(jobs->order->checkpoint_every_s))
		ADD("--checkpoint-every=%.17g", jobs->order->checkpoint_every_s);
	ADD("--seed=%" PRIu64, rb_plan_seed(plan, index));
	for (int i = 0; i < plan->axis_count; i++)
		ADD("--param=%s=%s", plan->axes[i].name, rb_plan_value(plan, index, i, number));
	if (plan->records)
		ADD("--output=%s%s", up, rb_folder_path(plan, NULL, index, ".h5", path));
	add_word(jobs, &count, "--");
	ADD("%sscene/%s", up, plan->scene);
	RB_ASSERT(at <= end);
#undef ADD
	add_word(jobs, &count, NULL);
}

/*
 * The child after fork: connects the standard descriptors, enters the folder and becomes the run.
 * Only async-signal-safe calls. `folder`, `result`, `log`: descriptors. The exit statuses are those
 * of a shell: 126 cannot execute, 127 not found.
 */
static _Noreturn void become_run(const struct jobs *jobs, int folder, int result, int log,
                                 pid_t parent)
{
	const int nothing = open("/dev/null", O_RDONLY);
	/* no file alone may be larger, whatever grows between two looks at all of them */
	const double most = jobs->order->point_disk_bytes;
	const struct rlimit disk = {.rlim_cur = isnan(most) ? 0 : (rlim_t)most,
	                            .rlim_max = isnan(most) ? 0 : (rlim_t)most};

	/*
	 * a group of its own, so that Ctrl-C at the terminal reaches the run only through pass_on
	 */
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (!isnan(most) && setrlimit(RLIMIT_FSIZE, &disk) != 0)
		_exit(126);
	if (getppid() != parent) /* it ended before that was set */
		_exit(143);
	if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(result, STDOUT_FILENO) < 0 ||
	    dup2(log, STDERR_FILENO) < 0 || fchdir(folder) != 0)
		_exit(126);
	sigprocmask(SIG_SETMASK, &jobs->order->mask_before, NULL);
	execv(RB_PROGRAM_AGAIN, (char *const *)(uintptr_t)jobs->words);
	_exit(127);
}

/*
 * Opens where a point's run works, and an empty file for its result: an older result is removed
 * first, so that a run that is killed leaves none. On success both descriptors are the caller's.
 */
static enum rb_status open_point(const struct rb_jobs_order *order, uint64_t index, int *folder,
                                 int *result, struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	struct rb_place top, point;

	enum rb_status status = rb_place_open(
		&top, rb_folder_path(order->plan, order->folder, index, ".json", path), 0, err);
	if (status)
		return status;
	rb_place_remove(&top, top.name);
	*result = rb_place_reach(&top, top.name, O_WRONLY | O_CREAT | O_EXCL);
	if (*result < 0)
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", path,
		                 strerror(errno));
	rb_place_release(&top);
	if (status)
		return status;
	/* films of a point have a folder of their own */
	rb_folder_path(order->plan, order->folder, index, order->plan->films ? "/film" : "", path);
	status = rb_place_open(&point, path, RB_PLACE_MAKE | RB_PLACE_BELOW(strlen(order->folder)),
	                       err);
	*folder = status ? -1 : fcntl(point.folder, F_DUPFD_CLOEXEC, 0);
	if (!status && *folder < 0)
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot open '%s': %s", order->folder,
		                 strerror(errno));
	rb_place_release(&point);
	if (status)
		close(*result);
	return status;
}

/*
 * Starts a process for the point of a place that is locked. On success the child holds all
 * descriptors but the log, which both hold.
 */
static enum rb_status start_run(struct jobs *jobs, struct place *place, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;
	const pid_t parent = getpid();
	int folder, result;

	RB_ASSERT(place->process == 0 && place->log >= 0);
	const enum rb_status status = open_point(order, place->index, &folder, &result, err);
	if (status)
		return status;
	place->process = fork();
	if (place->process == 0)
		become_run(jobs, folder, result, place->log, parent);
	close(result);
	close(folder);
	if (place->process < 0) {
		place->process = 0;
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a process: %s", strerror(errno));
	}
	setpgid(place->process, place->process); /* whoever comes first */
	place->start_ns = rb_clock_now_ns();
	jobs->tally->started++;
	jobs->tally->running++;
	return RB_OK;
}

/*
 * Whether the run continues from its checkpoint. Not if the run before has refused it (usage or
 * input error): every later run would refuse it again; it then starts anew.
 */
static bool goes_on(const struct rb_point *point)
{
	const int code = point->state == RB_POINT_FAILED ? point->exit_code : 0;

	return point->has_checkpoint && code != rb_status_exit_code(RB_ERR_USAGE) &&
	       code != rb_status_exit_code(RB_ERR_INPUT);
}

/* Marks the point with that number within the share as run by another process. */
static void leave_elsewhere(struct jobs *jobs, uint64_t number)
{
	RB_ASSERT(number < jobs->tally->total);
	jobs->due[number] = ELSEWHERE;
	jobs->tally->elsewhere++;
}

/*
 * At the end, counts what has become of the points that other processes had; those that still run
 * stay counted as elsewhere.
 */
static enum rb_status look_elsewhere(struct jobs *jobs, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;
	struct rb_jobs_tally *const tally = jobs->tally;
	enum rb_status status = RB_OK;

	for (uint64_t number = 0; number < tally->total && !status; number++) {
		struct rb_point point;
		if (jobs->due[number] != ELSEWHERE)
			continue;
		status = rb_point_look(order->folder, order->plan, index_of(jobs, number),
		                       order->module, &point, err);
		if (status || (point.state != RB_POINT_DONE && point.state != RB_POINT_FAILED))
			continue;
		RB_ASSERT(tally->elsewhere > 0);
		tally->elsewhere--;
		count(tally, index_of(jobs, number), &point);
	}
	return status;
}

/*
 * Takes the next due point into a free place, unless another process has taken or ended it since
 * the survey: it is looked at again, then locked, so that of two sweeps that reach it only one runs
 * it. Leaves the place free where there is nothing to start.
 */
static enum rb_status take_point(struct jobs *jobs, struct place *place, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;
	struct rb_jobs_tally *const tally = jobs->tally;
	struct rb_point point;

	RB_ASSERT(place->process == 0);
	while (jobs->next < tally->total && jobs->due[jobs->next] != DUE)
		jobs->next++;
	if (jobs->next >= tally->total)
		return RB_OK;
	*place = (struct place){.index = index_of(jobs, jobs->next++), .log = -1};
	RB_ASSERT(tally->due > 0);
	tally->due--;
	enum rb_status status = rb_point_look(order->folder, order->plan, place->index,
	                                      order->module, &point, err);
	if (!status && !rb_point_is_due(&point, order->retry)) {
		count(tally, place->index, &point);
		if (point.state == RB_POINT_RUNNING)
			leave_elsewhere(jobs, jobs->next - 1);
		if (point.state == RB_POINT_FAILED)
			tell(jobs, place->index, &point);
		return RB_OK;
	}
	if (!status)
		status = rb_point_lock(order->folder, order->plan, place->index, &place->log, err);
	if (status || place->log < 0) {
		if (!status)
			leave_elsewhere(jobs, jobs->next - 1);
		return status;
	}
	command_of(jobs, place->index, goes_on(&point));
	status = start_run(jobs, place, err);
	if (status)
		rb_point_unlock(place->log);
	return status;
}

/*
 * Writes the result that a run could not write itself (killed, or without a word), with the reason
 * as far as we know it, and fills the point alike.
 */
static enum rb_status tell_crash(const struct jobs *jobs, const struct place *place, int outcome,
                                 struct rb_point *point, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;

	*point = (struct rb_point){.state = RB_POINT_FAILED, .may_mend = true};
	if (place->warned > 0) {
		point->exit_code = EXIT_OVERDUE;
		if (place->too_large)
			snprintf(point->reason, sizeof point->reason,
			         "took more than %.17g bytes of disk", order->point_disk_bytes);
		else
			snprintf(point->reason, sizeof point->reason, "took longer than %g s",
			         order->point_time_s);
	} else if (WIFSIGNALED(outcome)) {
		point->exit_code = 128 + WTERMSIG(outcome);
		snprintf(point->reason, sizeof point->reason, "ended by signal %d",
		         WTERMSIG(outcome));
	} else {
		point->exit_code = WEXITSTATUS(outcome) ? WEXITSTATUS(outcome)
		                                        : rb_status_exit_code(RB_ERR_BUG);
		snprintf(point->reason, sizeof point->reason,
		         "ended with status %d and without a result", WEXITSTATUS(outcome));
	}
	return rb_point_tell(order->folder, order->plan, place->index, point->reason,
	                     point->exit_code, err);
}

/*
 * Accounts for a run that has ended with `outcome` (of wait4). The state comes from its files;
 * where these say "begun" although nobody asked it to stop, it has crashed.
 */
static enum rb_status end_run(struct jobs *jobs, struct place *place, int outcome,
                              const struct rusage *used, struct rb_error *err)
{
	const struct rb_jobs_order *const order = jobs->order;
	struct rb_jobs_tally *const tally = jobs->tally;
	struct rb_point point;
	const int code = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : -1;

	RB_ASSERT(place->process > 0 && jobs->tally->running > 0);
	/* before the look below, which would see the point as running */
	rb_point_unlock(place->log);
	place->process = 0;
	tally->running--;
	tally->ended++;
	tally->cpu_s += (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
	                1e-6 * (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec);
	enum rb_status status = rb_point_look(order->folder, order->plan, place->index, NULL,
	                                      &point, err);
	if (!status && point.state == RB_POINT_BEGUN && tally->signal == 0 &&
	    (place->warned > 0 || (code != 75 && code != 130 && code != 143)))
		status = tell_crash(jobs, place, outcome, &point, err);
	if (status)
		return status;
	count(tally, place->index, &point);
	tell(jobs, place->index, &point);
	return RB_OK;
}

/* ---- all of them ---- */

/* Sends a signal to every run under way. */
static void pass_on(struct jobs *jobs, int signal)
{
	for (int i = 0; i < jobs->order->jobs; i++)
		if (jobs->places[i].process > 0)
			kill(jobs->places[i].process, signal);
}

/*
 * Takes a request to stop: the first one asks the runs to end properly, a further SIGINT ends them
 * at once.
 */
static void heed(struct jobs *jobs, int signal)
{
	if (jobs->tally->signal == 0) {
		jobs->tally->signal = signal;
		/*
		 * SIGINT once more is what stops a run at once, so the first one is told in other
		 * words
		 */
		pass_on(jobs, signal == SIGINT ? SIGTERM : signal);
	} else if (signal == SIGINT) {
		pass_on(jobs, SIGINT);
	}
}

/* Calls the caller's `tick` if its time has come. */
static void tick(struct jobs *jobs)
{
	const struct rb_jobs_order *const order = jobs->order;
	const uint64_t now_ns = rb_clock_now_ns();

	jobs->tally->wall_s = (double)(now_ns - jobs->start_ns) * 1e-9;
	if (order->tick_ms == 0 || now_ns - jobs->ticked_ns < (uint64_t)order->tick_ms * 1000000)
		return;
	jobs->ticked_ns = now_ns;
	order->tick(order->user, jobs->tally);
}

/*
 * Asks a run to end, which makes it leave a checkpoint; kills it if it has not ended after
 * overdue_s.
 */
static void warn(struct place *place, uint64_t now_ns)
{
	RB_ASSERT(place->process > 0);
	if (place->warned > 0 && (double)(now_ns - place->warned_ns) * 1e-9 < overdue_s)
		return;
	kill(place->process, place->warned == 0 ? SIGTERM : SIGKILL);
	place->warned++;
	place->warned_ns = now_ns;
}

/*
 * Warns the runs that have taken more time or disk than they may. Comparisons with NAN (no bound)
 * are false.
 */
static void mind_bounds(struct jobs *jobs)
{
	const struct rb_jobs_order *const order = jobs->order;
	const uint64_t now_ns = rb_clock_now_ns();
	const bool looks = !isnan(order->point_disk_bytes) &&
	                   (double)(now_ns - jobs->looked_ns) * 1e-9 >= look_s;

	if (looks)
		jobs->looked_ns = now_ns;
	for (int i = 0; i < order->jobs; i++) {
		struct place *const place = &jobs->places[i];
		const double taken_s = (double)(now_ns - place->start_ns) * 1e-9;

		if (place->process <= 0)
			continue;
		if (looks && place->warned == 0)
			place->too_large = rb_usage_bytes(order->folder, order->plan,
			                                  place->index) > order->point_disk_bytes;
		if (place->warned > 0 || place->too_large || taken_s > order->point_time_s)
			warn(place, now_ns);
	}
}

/*
 * Waits for the end of a run, a signal, or the time of the next tick. With bounds at most 200 ms,
 * which is how exactly they are kept; else an hour, which stands for no limit.
 */
static void wait_for_some(struct jobs *jobs)
{
	const bool bounded = !isnan(jobs->order->point_time_s) ||
	                     !isnan(jobs->order->point_disk_bytes);
	const int most_ms = bounded ? 200 : 3600000;
	const int wait_ms = jobs->order->tick_ms > 0 && jobs->order->tick_ms < most_ms
	                            ? jobs->order->tick_ms
	                            : most_ms;
	const struct timespec wait = {wait_ms / 1000, wait_ms % 1000 * 1000000L};
	const int signal = sigtimedwait(&jobs->signals, NULL, &wait);

	if (signal > 0 && signal != SIGCHLD)
		heed(jobs, signal);
}

/* Accounts for all runs that have ended; does not wait. */
static enum rb_status reap(struct jobs *jobs, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < jobs->order->jobs && !status; i++) {
		struct place *const place = &jobs->places[i];
		struct rusage used;
		int outcome;
		if (place->process > 0 &&
		    wait4(place->process, &outcome, WNOHANG, &used) == place->process)
			status = end_run(jobs, place, outcome, &used, err);
	}
	return status;
}

/* Starts runs in all free places while there are points and nobody has asked to stop. */
static enum rb_status fill(struct jobs *jobs, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < jobs->order->jobs && !status; i++)
		while (!status && jobs->tally->signal == 0 && jobs->places[i].process == 0 &&
		       jobs->next < jobs->tally->total)
			status = take_point(jobs, &jobs->places[i], err);
	return status;
}

/*
 * The loop. On a failure of ours (not of a run) what still runs is stopped properly; the first
 * failure is the one that is reported.
 */
static enum rb_status run_all(struct jobs *jobs, struct rb_error *err)
{
	enum rb_status status = fill(jobs, err);

	while (!status && jobs->tally->running > 0) {
		wait_for_some(jobs);
		mind_bounds(jobs);
		status = reap(jobs, err);
		if (!status)
			status = fill(jobs, err);
		tick(jobs);
	}
	if (!status)
		status = look_elsewhere(jobs, err);
	if (!status)
		return RB_OK;
	/* what still runs is stopped properly; the first failure is the one that is told */
	pass_on(jobs, SIGTERM);
	for (int i = 0; i < jobs->order->jobs; i++) {
		struct place *const place = &jobs->places[i];
		if (place->process > 0)
			while (waitpid(place->process, NULL, 0) < 0 && errno == EINTR)
				continue;
		if (place->process > 0)
			rb_point_unlock(place->log);
	}
	return status;
}

/*
 * Counts the share (indices share, share + shares, ...), takes memory for the longest command line
 * and blocks the signals.
 */
static enum rb_status prepare(struct jobs *jobs, struct rb_error *err)
{
	const struct rb_plan *const plan = jobs->order->plan;
	const uint64_t share = jobs->order->share, shares = jobs->order->shares;

	RB_ASSERT(share < shares && jobs->order->jobs > 0);
	jobs->tally->total = plan->count > share ? (plan->count - share - 1) / shares + 1 : 0;
	jobs->places = rb_memory_take((size_t)jobs->order->jobs, sizeof *jobs->places);
	jobs->due = rb_memory_take((size_t)jobs->tally->total + 1, 1);
	jobs->words = rb_memory_take((size_t)(plan->word_count + plan->axis_count) + 16,
	                             sizeof *jobs->words);
	jobs->text_size = plan->row_size + 16 * (size_t)plan->axis_count + strlen(plan->scene) +
	                  512;
	jobs->text = rb_memory_take(jobs->text_size, 1);
	if (!jobs->places || !jobs->due || !jobs->words || !jobs->text)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot run %" PRIu64 " points: out of memory",
		               jobs->tally->total);
	jobs->signals = rb_thread_stops();
	sigaddset(&jobs->signals, SIGCHLD);
	sigprocmask(SIG_BLOCK, &jobs->signals, NULL);
	return RB_OK;
}

/*
 * Takes the signals that came after the last wait, and restores the caller's mask: else they would
 * act only after the sweep had reported that nobody asked to stop.
 */
static void take_late_signals(struct jobs *jobs)
{
	const struct timespec none = {0};
	int signal;

	while ((signal = sigtimedwait(&jobs->signals, NULL, &none)) > 0 || errno == EINTR)
		if (signal > 0 && signal != SIGCHLD && jobs->tally->signal == 0)
			jobs->tally->signal = signal;
	sigprocmask(SIG_SETMASK, &jobs->order->mask_before, NULL);
}

enum rb_status rb_jobs_run(const struct rb_jobs_order *order, struct rb_jobs_tally *tally,
                           struct rb_error *err)
{
	struct jobs jobs = {.order = order, .tally = tally, .start_ns = rb_clock_now_ns()};
	char program[PATH_MAX];

	RB_ASSERT(order->jobs > 0 && order->threads > 0 && order->tick_ms >= 0);
	RB_ASSERT(order->tick_ms == 0 || order->tick);
	*tally = (struct rb_jobs_tally){0};
	jobs.ticked_ns = jobs.start_ns;
	enum rb_status status = rb_program_path(program, err); /* every run is this program again */
	if (!status)
		status = prepare(&jobs, err);
	if (!status) {
		status = survey(&jobs, err);
		if (!status)
			status = run_all(&jobs, err);
		take_late_signals(&jobs);
	}
	tally->wall_s = (double)(rb_clock_now_ns() - jobs.start_ns) * 1e-9;
	rb_memory_free(jobs.places);
	rb_memory_free(jobs.due);
	rb_memory_free(jobs.words);
	rb_memory_free(jobs.text);
	return status;
}
