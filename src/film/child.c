/* SPDX-License-Identifier: MIT */
/*
 * A child process with pipes, watched for signs of life: output, growing files, processor time.
 * fork and exec rather than posix_spawn, because the child needs a group of its own, a death signal
 * and closed descriptors. A pipe that closes on exec reports whether exec succeeded (the errno is
 * written to it only if it failed).
 */
#include "film/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"

/*
 * Sizes of the pipe to its input; of one read, and reads in a row; longest pause between two looks.
 */
enum { PIPE_SIZE = 1 << 20, CHUNK_SIZE = 4096, CHUNKS_MAX = 16, PAUSE_MS = 50 };

/* Processor time, ns, that counts as a sign of life: less is used by waking up. */
static const uint64_t busy_least_ns = 10000000;
/* After SIGKILL, s: a process in uninterruptible sleep on a disk ends only when that answers. */
static const double kill_timeout_s = 5;

/* ---- start ---- */

static void close_end(int *end)
{
	if (*end >= 0)
		close(*end);
	*end = -1;
}

void rb_child_init(struct rb_child *child)
{
	*child = (struct rb_child){.in = -1, .out = -1, .complaints = -1, .files = {-1, -1}};
}

/*
 * A pipe with both ends above the standard descriptors, which are replaced one by one in the child.
 */
static bool make_pipe(int ends[2])
{
	if (pipe2(ends, O_CLOEXEC) != 0)
		return false;
	for (int i = 0; i < 2; i++) {
		if (ends[i] > 2)
			continue;
		const int moved = fcntl(ends[i], F_DUPFD_CLOEXEC, 3);
		close(ends[i]);
		ends[i] = moved;
	}
	if (ends[0] >= 0 && ends[1] >= 0)
		return true;
	close_end(&ends[0]);
	close_end(&ends[1]);
	return false;
}

/* The child's ends of pipes, -1 for none, and further descriptors that it keeps, ended by -1. */
struct ends {
	int in, out, complaints, report;
	const int *kept;
};

/* Makes `from` (or /dev/null) the descriptor `to`. */
static void redirect(int from, int to, int flags)
{
	if (from < 0)
		from = open("/dev/null", flags);
	if (from != to)
		(void)dup2(from, to);
}

/* Closes the descriptors from..to - 1 except one. */
static void close_between(int from, int to, int except)
{
	for (int descriptor = from; descriptor < to; descriptor++)
		if (descriptor != except)
			close(descriptor);
}

/* In the child, where only async-signal-safe functions may be called until exec. */
static _Noreturn void become(char *const *arguments, const struct ends *ends, pid_t parent)
{
	const struct sigaction usual = {.sa_handler = SIG_DFL};
	sigset_t none;

	/* its own process group: ctrl-C at the terminal is for us, and the film is then finished */
	(void)setpgid(0, 0);
	(void)prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent) /* the parent ended before the death signal was set */
		_exit(127);
	for (int number = 1; number < NSIG; number++)
		(void)sigaction(number, &usual, NULL);
	redirect(ends->in, 0, O_RDONLY);
	redirect(ends->out, 1, O_WRONLY);
	(void)dup2(ends->complaints, 2);
	/* whatever other libraries have opened without asking for close-on-exec */
	int next = STDERR_FILENO + 1;
	for (const int *kept = ends->kept; kept && *kept >= 0; next = *kept++ + 1) {
		close_between(next, *kept, ends->report);
		(void)fcntl(*kept, F_SETFD, 0);
	}
	if (ends->report >= next) {
		close_between(next, ends->report, -1);
		next = ends->report + 1;
	}
	closefrom(next);
	sigemptyset(&none);
	(void)sigprocmask(SIG_SETMASK, &none, NULL);
	(void)execvp(arguments[0], arguments);
	const int number = errno;
	const ssize_t told = write(ends->report, &number, sizeof number);
	(void)told;
	_exit(127);
}

/* Forks; 0, or errno of the failure. */
static int launch(struct rb_child *child, const char *const *arguments, const struct ends *ends)
{
	const pid_t parent = getpid();
	sigset_t all, before;
	char *const *list;

	/* execvp's prototype lacks a const that it honours */
	memcpy(&list, &arguments, sizeof list);
	/* no handler of ours may run in the child */
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	const pid_t pid = fork();
	const int failed = errno;
	if (pid == 0)
		become(list, ends, parent);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (pid < 0)
		return failed;
	child->pid = pid;
	return 0;
}

/* errno of a failed exec; 0: it runs. */
static int read_report(struct rb_child *child, int report)
{
	int number = 0;
	ssize_t size;

	do
		size = read(report, &number, sizeof number);
	while (size < 0 && errno == EINTR);
	if (size != (ssize_t)sizeof number)
		return 0;
	while (waitpid(child->pid, NULL, 0) < 0 && errno == EINTR)
		;
	return number;
}

enum rb_status rb_child_start(struct rb_child *child, const char *const *arguments, bool feeds,
                              bool listens, const int *kept, struct rb_error *err)
{
	int in[2] = {-1, -1}, out[2] = {-1, -1}, complaints[2] = {-1, -1}, report[2] = {-1, -1};
	int failed = 0;

	rb_child_init(child);
	if ((feeds && !make_pipe(in)) || (listens && !make_pipe(out)) || !make_pipe(complaints) ||
	    !make_pipe(report))
		failed = errno;
	const struct ends ends = {in[0], out[1], complaints[1], report[1], kept};
	if (!failed)
		failed = launch(child, arguments, &ends);
	close_end(&in[0]);
	close_end(&out[1]);
	close_end(&complaints[1]);
	close_end(&report[1]);
	if (!failed)
		failed = read_report(child, report[0]);
	close_end(&report[0]);
	if (failed) {
		close_end(&in[1]);
		close_end(&out[0]);
		close_end(&complaints[0]);
		rb_child_init(child);
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot run '%s': %s (video needs ffmpeg: install it, or name it in "
		               "RBSIM_FFMPEG; PNG does not need it)",
		               arguments[0], strerror(failed));
	}
	child->in = in[1];
	child->out = out[0];
	child->complaints = complaints[0];
	if (child->in >= 0) {
		fcntl(child->in, F_SETFL, O_NONBLOCK);
		fcntl(child->in, F_SETPIPE_SZ, PIPE_SIZE); /* only faster, where it may */
	}
	fcntl(child->complaints, F_SETFL, O_NONBLOCK);
	return RB_OK;
}

/* ---- words ---- */

/* Appends to the ring of last words; the oldest are dropped. */
static void keep(struct rb_child *child, const char *text, size_t size)
{
	const size_t room = sizeof child->said - 1;

	if (size > room) {
		text += size - room;
		size = room;
	}
	if (child->said_size + size > room) {
		const size_t gone = child->said_size + size - room;
		memmove(child->said, child->said + gone, child->said_size - gone);
		child->said_size -= gone;
	}
	memcpy(child->said + child->said_size, text, size);
	child->said_size += size;
	child->said[child->said_size] = '\0';
	RB_ASSERT(child->said_size < sizeof child->said);
}

void rb_child_hear(struct rb_child *child)
{
	char chunk[CHUNK_SIZE];

	for (int i = 0; i < CHUNKS_MAX && child->complaints >= 0; i++) {
		const ssize_t size = read(child->complaints, chunk, sizeof chunk);
		if (size < 0 && errno == EINTR)
			continue;
		if (size < 0 && errno == EAGAIN)
			return;
		if (size <= 0) {
			close_end(&child->complaints);
			return;
		}
		child->heard += (uint64_t)size;
		keep(child, chunk, (size_t)size);
	}
}

const char *rb_child_last_words(struct rb_child *child)
{
	char *const said = child->said;
	size_t end = child->said_size;

	while (end > 0 && strchr("\r\n \t", said[end - 1]))
		end--;
	said[end] = '\0';
	while (end > 0 && said[end - 1] != '\n' && said[end - 1] != '\r')
		end--;
	return said[end] ? said + end : "it said nothing";
}

const char *rb_child_words(const struct rb_child *child, const char *text,
                           char line[RB_CHILD_SAID_SIZE])
{
	const char *last = NULL;

	for (const char *at = child->said; (at = strstr(at, text)) != NULL; at++)
		last = at;
	if (!last)
		return NULL;
	while (last > child->said && last[-1] != '\n' && last[-1] != '\r')
		last--;
	const size_t size = strcspn(last, "\r\n");
	memcpy(line, last, size);
	line[size] = '\0';
	return line;
}

/* ---- signs of life ---- */

/* Present signs of life: amount of output, a hash of what files and pipes show, processor time. */
static struct rb_child_signs look(const struct rb_child *child)
{
	struct rb_child_signs signs = {.said = child->heard};
	struct {
		uint64_t taken;
		int64_t file[RB_CHILD_FILES_MAX][3];
	} results = {.taken = child->taken};
	struct timespec used;
	clockid_t clock;

	for (int i = 0; i < RB_CHILD_FILES_MAX; i++) {
		struct stat found;
		if (child->files[i] < 0 || fstat(child->files[i], &found) != 0)
			continue;
		results.file[i][0] = found.st_size;
		results.file[i][1] = found.st_mtim.tv_sec;
		results.file[i][2] = found.st_mtim.tv_nsec;
	}
	signs.results = rb_hash_bytes(&results, sizeof results, 0);
	if (clock_getcpuclockid(child->pid, &clock) == 0 && clock_gettime(clock, &used) == 0)
		signs.busy_ns = (uint64_t)used.tv_sec * 1000000000 + (uint64_t)used.tv_nsec;
	return signs;
}

/*
 * True if there was no sign of life for patience_s, or no result for a multiple of it. A wait
 * begins with `watched` unset.
 */
static bool is_hung(struct rb_child *child)
{
	const uint64_t now = rb_clock_now_ns();
	const struct rb_child_signs signs = look(child), last = child->signs;
	const bool result = !child->watched || signs.results != last.results;

	if (result)
		child->result_ns = now;
	if (result || signs.said != last.said || signs.busy_ns > last.busy_ns + busy_least_ns) {
		child->sign_ns = now;
		child->signs = signs;
	}
	child->watched = true;
	/* after an interruption patience is short */
	if (child->cut && atomic_load(child->cut) && child->patience_s > RB_CHILD_CUT_S)
		child->patience_s = RB_CHILD_CUT_S;
	return (double)(now - child->sign_ns) * 1e-9 > child->patience_s ||
	       (double)(now - child->result_ns) * 1e-9 > RB_CHILD_BUSY_TIMES * child->patience_s;
}

/* ---- its end ---- */

/* Collects the exit status without blocking; true if there is nothing to wait for any more. */
static bool reap(struct rb_child *child)
{
	RB_ASSERT(child->pid > 0);

	const pid_t ended = waitpid(child->pid, &child->outcome, WNOHANG);

	if (ended == 0 || (ended < 0 && errno == EINTR))
		return false;
	child->pid = 0;
	child->end = ended < 0             ? RB_CHILD_LOST
	             : child->outcome == 0 ? RB_CHILD_WELL
	                                   : RB_CHILD_FAILED;
	return true;
}

/* Sleeps and doubles the pause up to PAUSE_MS. */
static void pause_for(int *ms)
{
	const struct timespec pause = {.tv_nsec = *ms * 1000000L};

	nanosleep(&pause, NULL);
	*ms = 2 * *ms < PAUSE_MS ? 2 * *ms : PAUSE_MS;
}

/* Reads the last words and closes the pipes. */
static void let_go(struct rb_child *child)
{
	rb_child_hear(child);
	close_end(&child->complaints);
	close_end(&child->out);
	close_end(&child->in);
}

void rb_child_stop(struct rb_child *child)
{
	const uint64_t start = rb_clock_now_ns();
	int ms = 1;

	if (child->pid <= 0)
		return;
	kill(-child->pid, SIGKILL);
	kill(child->pid, SIGKILL);
	while (!reap(child)) {
		if ((double)(rb_clock_now_ns() - start) * 1e-9 > kill_timeout_s) {
			child->pid = 0;
			child->end = RB_CHILD_LOST;
			break;
		}
		pause_for(&ms);
	}
	let_go(child);
}

/* Kills a child that shows no signs of life. */
static void end_hung(struct rb_child *child)
{
	rb_child_stop(child);
	child->end = RB_CHILD_HUNG;
}

enum rb_child_end rb_child_wait(struct rb_child *child)
{
	int ms = 1;

	close_end(&child->in);
	child->watched = false;
	while (child->pid > 0 && !reap(child)) {
		struct pollfd wish = {.fd = child->complaints, .events = POLLIN};
		/* grandchildren may keep the pipe open after it has ended */
		if (child->complaints >= 0)
			poll(&wish, 1, PAUSE_MS);
		else
			pause_for(&ms);
		rb_child_hear(child);
		if (is_hung(child))
			end_hung(child);
	}
	let_go(child);
	return child->end;
}

/* Writes while reading: two processes that each wait for the other to read would block for ever. */
bool rb_child_feed(struct rb_child *child, const uint8_t *bytes, size_t size)
{
	child->watched = false;
	while (size > 0 && child->in >= 0) {
		const ssize_t sent = write(child->in, bytes, size);
		if (sent > 0) {
			bytes += sent;
			size -= (size_t)sent;
			child->taken += (uint64_t)sent;
			continue;
		}
		if (sent < 0 && errno != EAGAIN && errno != EINTR)
			return false;
		struct pollfd wishes[2] = {{.fd = child->in, .events = POLLOUT},
		                           {.fd = child->complaints, .events = POLLIN}};
		poll(wishes, 2, PAUSE_MS);
		if (wishes[1].revents)
			rb_child_hear(child);
		if (is_hung(child)) {
			end_hung(child);
			return false;
		}
	}
	return size == 0;
}
