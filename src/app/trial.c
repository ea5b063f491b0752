/* SPDX-License-Identifier: MIT */
/*
 * A run in a forked process: crashes, endless runs and leaks stay there, and several can run at a
 * time. The result is a struct and an array of structs through a pipe; both ends are the same
 * program, so no format is needed. A result that is short is none.
 */
#include "app/trial.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/simulate.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"

/* Wall time that a run may take, as a multiple of its limit. */
enum { WALL_TIMES = 16 };

/* ---- in the process of the run ---- */

/* Writes all or gives up: the other end sees that something is missing. */
static void send(int fd, const void *bytes, size_t size)
{
	for (const char *at = bytes; size > 0;) {
		const ssize_t written = write(fd, at, size);
		if (written < 0 && errno == EINTR)
			continue;
		if (written <= 0)
			return;
		at += written;
		size -= (size_t)written;
	}
}

/* Sends one expectation; texts are cut to the struct's size. */
static void send_expect(int fd, const struct rb_expect_result *from)
{
	struct rb_trial_expect to = {.ok = from->ok,
	                             .has_numbers = from->has_numbers,
	                             .measured = from->measured,
	                             .bound = from->bound};

	snprintf(to.text, sizeof to.text, "%s", from->text);
	snprintf(to.message, sizeof to.message, "%s", from->message);
	send(fd, &to, sizeof to);
}

/* The exit status and reason that `rbsim run` would have. */
static void judge(struct rb_trial_result *result, const struct rb_loaded *loaded,
                  const struct rb_run_result *run, enum rb_status status,
                  const struct rb_error *err)
{
	if (!status) {
		status = run->expect_status;
		err = &run->expect_error;
	}
	if (status) {
		result->refused = rb_app_refused_as_expected(loaded, err);
		result->exit_code = result->refused ? 0 : rb_status_exit_code(status);
		snprintf(result->reason, sizeof result->reason, "%s", err->text);
	} else if (loaded->scene.expect_refused) {
		result->exit_code = rb_status_exit_code(RB_ERR_EXPECT);
		snprintf(result->reason, sizeof result->reason,
		         "expected to be refused with status %d, but was not",
		         loaded->scene.expect_refused);
	} else if (run->expect_failures > 0) {
		result->exit_code = rb_status_exit_code(RB_ERR_EXPECT);
	}
}

/* Loads and simulates, and sends the result; in the child. */
static void run_scene(const struct rb_trial_job *job, int fd)
{
	struct rb_options options = *job->options;
	struct rb_loaded loaded;
	struct rb_run_texts texts = {0};
	struct rb_run_info info;
	struct rb_run_result run = {0};
	struct rb_trial_result result = {0};
	struct rb_error err;

	RB_ASSERT(job->param_count >= 0);
	options.operand[0] = job->path;
	options.operand_count = 1;
	options.params = (const char **)(uintptr_t)job->params;
	options.param_count = job->param_count;
	options.no_record = options.quiet = options.keep_ledger = true;
	options.output = NULL;
	options.threads = 1;
	enum rb_status status = rb_loaded_init(&loaded, &options, &err);
	if (!status)
		status = rb_simulate_info(&info, &texts, &loaded, &options, &err);
	if (!status) {
		status = rb_simulate(&run, &loaded, &options, &info,
		                     &(struct rb_simulate_parts){0});
		err = run.error;
	}
	judge(&result, &loaded, &run, status, &err);
	result.frames = run.frames;
	result.state_hash = run.state_hash;
	result.collisions = run.totals.collisions;
	result.stepped_s = run.totals.stepped;
	result.balance = run.balance;
	result.expect_count = run.expect_count;
	send(fd, &result, sizeof result);
	for (int i = 0; i < run.expect_count; i++)
		send_expect(fd, &run.expects[i]);
	rb_run_result_release(&run);
	rb_run_texts_release(&texts);
	rb_loaded_release(&loaded);
}

/* ---- in the process of the verb ---- */

enum rb_status rb_trial_start(struct rb_trial *trial, const struct rb_trial_job *job,
                              struct rb_error *err)
{
	int ends[2];

	RB_ASSERT(job->limit_s > 0);
	*trial = (struct rb_trial){.fd = -1, .start_ns = rb_clock_now_ns()};
	trial->deadline_ns = trial->start_ns + (uint64_t)(job->limit_s * 1e9);
	if (pipe2(ends, O_CLOEXEC) != 0)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot make a pipe: %s", strerror(errno));
	fflush(NULL); /* or the child would write it once more */
	trial->process = fork();
	if (trial->process < 0) {
		const int why = errno;
		close(ends[0]);
		close(ends[1]);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a process: %s", strerror(why));
	}
	if (trial->process == 0) {
		close(ends[0]);
		(void)prctl(PR_SET_PDEATHSIG, SIGKILL); /* a run must not outlive the verb */
		rb_log_to(NULL, NULL, RB_LOG_WARNING);
		run_scene(job, ends[1]);
		_exit(0);
	}
	close(ends[1]);
	trial->fd = ends[0];
	(void)fcntl(trial->fd, F_SETFL, O_NONBLOCK);
	return RB_OK;
}

enum rb_status rb_trial_read(struct rb_trial *trial, bool *ended, struct rb_error *err)
{
	enum { PIECE = 16384 };

	*ended = false;
	for (;;) {
		if (!rb_memory_reserve(&trial->bytes, &trial->byte_capacity,
		                       trial->byte_count + PIECE, 1))
			return RB_FAIL(err, RB_ERR_MEMORY,
			               "cannot keep the results of a run: out of memory");
		const ssize_t size = read(trial->fd, trial->bytes + trial->byte_count, PIECE);
		if (size > 0) {
			trial->byte_count += (size_t)size;
			continue;
		}
		if (size < 0 && errno == EINTR)
			continue;
		*ended = size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
		return RB_OK;
	}
}

/* ns: processor time of a process that runs; the whole limit where that is not known. */
static uint64_t used_by(pid_t process, uint64_t limit_ns)
{
	struct timespec used;
	clockid_t clock;

	if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0)
		return limit_ns;
	return (uint64_t)used.tv_sec * 1000000000 + (uint64_t)used.tv_nsec;
}

/*
 * A busy machine is no fault of the run. It may take as long as the rest of its limit at least; and
 * what sleeps, or waits for others for ever, is late by the wall clock.
 */
bool rb_trial_is_over(struct rb_trial *trial, const struct rb_trial_job *job)
{
	const uint64_t now_ns = rb_clock_now_ns(), limit_ns = (uint64_t)(job->limit_s * 1e9);

	if (now_ns < trial->deadline_ns)
		return false;
	const uint64_t used_ns = used_by(trial->process, limit_ns);
	if (used_ns >= limit_ns || now_ns - trial->start_ns >= WALL_TIMES * limit_ns)
		return true;
	trial->deadline_ns = now_ns + (limit_ns - used_ns);
	return false;
}

/* Takes the result as it came through the pipe; false: not all of it is there. */
static bool unpack(const struct rb_trial *trial, struct rb_trial_result *result)
{
	const size_t head = sizeof *result;

	if (trial->byte_count < head)
		return false;
	memcpy(result, trial->bytes, head);
	const size_t count = (size_t)result->expect_count;
	result->expects = NULL;
	result->expect_count = 0;
	if (trial->byte_count != head + count * sizeof *result->expects)
		return false;
	result->expects = rb_memory_take(count, sizeof *result->expects);
	if (!result->expects)
		return false;
	memcpy(result->expects, trial->bytes + head, count * sizeof *result->expects);
	result->expect_count = (int)count;
	return true;
}

enum rb_status rb_trial_end(struct rb_trial *trial, const struct rb_trial_job *job,
                            struct rb_trial_result *result, struct rb_error *err)
{
	const bool late = rb_trial_is_over(trial, job);
	const uint64_t now_ns = rb_clock_now_ns();
	bool ended = false;
	int how = 0;

	RB_ASSERT(trial->process > 0);
	*result = (struct rb_trial_result){.exit_code = rb_status_exit_code(RB_ERR_BUG)};
	/* the result of a run that ended at the last moment counts */
	enum rb_status status = rb_trial_read(trial, &ended, err);
	if (!ended)
		(void)kill(trial->process, SIGKILL);
	while (waitpid(trial->process, &how, 0) < 0 && errno == EINTR)
		;
	close(trial->fd);
	if (!status && unpack(trial, result)) {
		/* nothing to add */
	} else if (!ended && late) {
		snprintf(result->reason, sizeof result->reason, "no end within %g s", job->limit_s);
	} else if (WIFSIGNALED(how)) {
		snprintf(result->reason, sizeof result->reason, "crashed: %s",
		         strsignal(WTERMSIG(how)));
	} else {
		snprintf(result->reason, sizeof result->reason, "ended without a result");
	}
	result->wall_s = (double)(now_ns - trial->start_ns) * 1e-9;
	rb_memory_free(trial->bytes);
	*trial = (struct rb_trial){.fd = -1};
	return status;
}

void rb_trial_result_release(struct rb_trial_result *result)
{
	rb_memory_free(result->expects);
	*result = (struct rb_trial_result){0};
}
