/* SPDX-License-Identifier: MIT */
/*
 * One thread does two things that must not disturb the simulation: it draws the bar, and it is the
 * only one that takes the signals of rb_thread_stops, by sigtimedwait, so there are no handlers at
 * all. The simulator stores the time that it has reached in an atomic; a double goes through its
 * bits.
 *
 * The first signal is only noted, for the simulator to see at its next frame; a second SIGINT ends
 * the process without waiting for anything.
 */
#include "app/progress.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/thread.h"

/* BAR_FROM_MS: shorter runs show no bar. LINE_EVERY_MS: in a log. LINE_SIZE: bytes of a line. */
enum { BAR_FROM_MS = 500, BAR_EVERY_MS = 100, LINE_EVERY_MS = 60000, LINE_SIZE = 256 };

struct rb_progress {
	/* set before the thread starts, then only read */
	double duration_s;
	bool quiet, redraw;
	uint64_t start_ns;
	void (*heed)(void *user, int signal);
	void *heed_user;
	void (*leave)(void *user);
	void *leave_user;
	sigset_t signals, mask_before;
	pthread_t thread;

	atomic_uint_fast64_t time_bits; /* of a double: the simulated time reached */
	atomic_uint_fast64_t paused_ns;
	_Atomic(const char *) awaited;
	atomic_int signal;
	atomic_bool stop;

	/* the thread's */
	bool bar_shown;
	struct rb_pace_window window;
};

bool rb_terminal_is_capable(int descriptor)
{
	const char *term = getenv("TERM");

	return isatty(descriptor) && term && *term && strcmp(term, "dumb") != 0;
}

void rb_progress_duration(char *text, size_t size, double seconds)
{
	if (seconds > 0 && seconds < 0.05)
		snprintf(text, size, "%.0f ms", ceil(1e3 * seconds));
	else if (seconds < 9.95)
		snprintf(text, size, "%.1f s", seconds);
	else if (seconds < 99.5)
		snprintf(text, size, "%.0f s", seconds);
	else if (seconds < 3600)
		snprintf(text, size, "%d:%02d min", (int)seconds / 60, (int)seconds % 60);
	else if (seconds < 3.6e8)
		snprintf(text, size, "%d:%02d:%02d h", (int)seconds / 3600, (int)seconds / 60 % 60,
		         (int)seconds % 60);
	else
		snprintf(text, size, "ages");
}

double rb_progress_left(struct rb_pace_window *window, double time_s, double duration_s,
                        double wall_s)
{
	const double rest_s = fmax(0, duration_s - time_s);

	RB_ASSERT(wall_s >= 0);
	/* the middle becomes the beginning when it is a quarter of the time ago */
	if (wall_s - window->middle_wall_s > wall_s / 4) {
		window->begin_wall_s = window->middle_wall_s;
		window->begin_s = window->middle_s;
		window->middle_wall_s = wall_s;
		window->middle_s = time_s;
	}
	const double way_s = time_s - window->begin_s, took_s = wall_s - window->begin_wall_s;

	return way_s > 0 ? rest_s * took_s / way_s : (double)NAN;
}

void rb_progress_line(char *line, int size, int width, const struct rb_progress_now *now)
{
	const double time_s = now->time_s, duration_s = now->duration_s;
	const double wall_s = now->wall_s, left_s = now->left_s;
	const double fraction = duration_s > 0 ? fmin(fmax(time_s / duration_s, 0), 1) : 1;
	char part[4][64] = {"", "", "", ""}, left[32];
	enum { BAR_MOST = 40, BAR_LEAST = 10 };

	RB_ASSERT(size > 0);
	/* Down, so that 100 % is said of the end alone. */
	snprintf(part[0], sizeof part[0], "%3d %%", (int)(100 * fraction));
	snprintf(part[1], sizeof part[1], "  %.4g of %.4g s", time_s, duration_s);
	if (wall_s > 0)
		snprintf(part[3], sizeof part[3], "  %.3g x real time", time_s / wall_s);
	if (left_s >= 0) {
		rb_progress_duration(left, sizeof left, left_s);
		snprintf(part[2], sizeof part[2], "  %s left", left);
	}

	/*
	 * What does not fit is left out from the end of this list; what remains of the width is
	 * the bar's.
	 */
	int kept = 0, used = 0;
	while (kept < 4 && used + (int)strlen(part[kept]) <= width)
		used += (int)strlen(part[kept++]);
	int bar = width - used - 3; /* a space and two brackets */
	if (bar > BAR_MOST)
		bar = BAR_MOST;
	char drawn[BAR_MOST + 4] = "";
	if (kept > 0 && bar >= BAR_LEAST) {
		const int filled = (int)(fraction * bar);
		drawn[0] = ' ';
		drawn[1] = '[';
		memset(drawn + 2, '=', (size_t)filled);
		memset(drawn + 2 + filled, ' ', (size_t)(bar - filled));
		drawn[2 + bar] = ']';
		drawn[3 + bar] = '\0';
	}
	snprintf(line, (size_t)size, "%s%s%s%s%s", kept > 0 ? part[0] : "", drawn,
	         kept > 1 ? part[1] : "", kept > 3 ? part[3] : "", kept > 2 ? part[2] : "");
}

/* s: the simulated time that the run has reached. */
static double time_reached(const struct rb_progress *progress)
{
	const uint64_t bits = atomic_load_explicit(&progress->time_bits, memory_order_relaxed);
	double time_s;

	memcpy(&time_s, &bits, sizeof time_s);
	return time_s;
}

/*
 * Writes a text to standard error in one write, so that lines of other threads do not end up
 * inside.
 */
static void say(const char *text)
{
	const ssize_t written = write(STDERR_FILENO, text, strlen(text));

	(void)written; /* nobody is left to be told */
}

/* Draws the bar, or prints a line where there is no terminal. */
static void show(struct rb_progress *progress)
{
	char line[LINE_SIZE], waits[LINE_SIZE] = "", text[2 * LINE_SIZE + 16];
	const char *const awaited = atomic_load(&progress->awaited);
	int width = 79;
	struct winsize window;

	if (progress->redraw && ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
		width = window.ws_col - 1; /* the last column would wrap on some terminals */
	const double wall_s = (double)(rb_clock_now_ns() - progress->start_ns -
	                               atomic_load(&progress->paused_ns)) *
	                      1e-9;
	if (awaited)
		snprintf(waits, sizeof waits, "  waits for %.100s", awaited);
	if (progress->redraw && (int)strlen(waits) > width)
		waits[0] = '\0';
	width -= (int)strlen(waits);
	const double time_s = time_reached(progress);
	const double left_s = rb_progress_left(&progress->window, time_s, progress->duration_s,
	                                       wall_s);
	rb_progress_line(line, sizeof line, progress->redraw ? width : 1000,
	                 &(struct rb_progress_now){time_s, progress->duration_s, wall_s, left_s});
	if (progress->redraw)
		snprintf(text, sizeof text, "\r\033[K%s%s", line, waits);
	else
		snprintf(text, sizeof text, "rbsim: %s%s\n", line, waits);
	say(text);
	progress->bar_shown = progress->redraw;
}

/* Clears the bar. */
static void hide(struct rb_progress *progress)
{
	if (progress->bar_shown)
		say("\r\033[K");
	progress->bar_shown = false;
}

/* Takes a signal: notes the first one; a further SIGINT ends the process. */
static void take_signal(struct rb_progress *progress, int signal)
{
	int none = 0;

	/* The terminal has written ^C behind whatever stands there. */
	if (progress->redraw && signal == SIGINT)
		progress->bar_shown = true;
	if (atomic_compare_exchange_strong(&progress->signal, &none, signal)) {
		if (progress->heed)
			progress->heed(progress->heed_user, signal);
		hide(progress);
		if (!progress->quiet)
			say("rbsim: finishing: outputs are being closed (interrupt again to stop "
			    "at once)\n");
	} else if (signal == SIGINT) {
		/* What is flushed is readable; nothing else can be promised from here. */
		hide(progress);
		if (progress->leave)
			progress->leave(progress->leave_user);
		_exit(rb_status_exit_code(RB_ERR_INTERRUPT));
	}
}

/* The thread. */
static void *watch(void *argument)
{
	struct rb_progress *const progress = argument;
	const uint64_t every_ms = progress->redraw ? BAR_EVERY_MS : LINE_EVERY_MS;
	const uint64_t from_ms = progress->redraw ? BAR_FROM_MS : LINE_EVERY_MS;
	uint64_t next_ns = progress->start_ns + from_ms * 1000000;

	rb_thread_name("progress");
	while (!atomic_load(&progress->stop)) {
		struct timespec wait = {.tv_sec = 3600};
		if (!progress->quiet) {
			const uint64_t now = rb_clock_now_ns();
			const uint64_t wait_ns = next_ns > now ? next_ns - now : 0;
			wait = (struct timespec){(time_t)(wait_ns / 1000000000),
			                         (long)(wait_ns % 1000000000)};
		}
		siginfo_t info = {0};
		const int signal = sigtimedwait(&progress->signals, &info, &wait);
		/* our own is that of rb_progress_stop */
		if (signal > 0 && info.si_pid == getpid() && atomic_load(&progress->stop))
			break;
		int none = 0;
		if (signal > 0 && atomic_load(&progress->stop)) {
			atomic_compare_exchange_strong(&progress->signal, &none, signal);
		} else if (signal > 0) {
			take_signal(progress, signal);
		} else if (errno == EAGAIN && !progress->quiet) {
			if (atomic_load(&progress->signal) == 0)
				show(progress);
			next_ns = rb_clock_now_ns() + every_ms * 1000000;
		}
	}
	hide(progress);
	return NULL;
}

enum rb_status rb_progress_start(struct rb_progress **progress,
                                 const struct rb_progress_options *options, struct rb_error *err)
{
	*progress = NULL;
	struct rb_progress *p = rb_memory_take(1, sizeof *p);
	if (!p)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot start the progress thread: out of memory");
	p->duration_s = options->duration_s;
	p->quiet = options->quiet;
	p->heed = options->heed;
	p->heed_user = options->heed_user;
	p->leave = options->leave;
	p->leave_user = options->leave_user;
	p->redraw = rb_terminal_is_capable(STDERR_FILENO);
	p->start_ns = rb_clock_now_ns();
	p->signals = rb_thread_stops();

	/*
	 * Blocked here and so in every thread that is started from here; only sigtimedwait takes
	 * them.
	 */
	pthread_sigmask(SIG_BLOCK, &p->signals, &p->mask_before);
	const int failed = rb_thread_start(&p->thread, watch, p);
	if (failed) {
		pthread_sigmask(SIG_SETMASK, &p->mask_before, NULL);
		rb_memory_free(p);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start the progress thread: %s",
		               strerror(failed));
	}
	*progress = p;
	return RB_OK;
}

int rb_progress_stop(struct rb_progress *progress)
{
	if (!progress)
		return 0;
	atomic_store(&progress->stop, true);
	/* Wakes the thread: one of the signals it waits for, sent to it alone. */
	pthread_kill(progress->thread, SIGUSR1);
	pthread_join(progress->thread, NULL);
	const int signal = rb_progress_signal(progress);
	pthread_sigmask(SIG_SETMASK, &progress->mask_before, NULL);
	rb_memory_free(progress);
	return signal;
}

void rb_progress_at(struct rb_progress *progress, double time_s)
{
	uint64_t bits;

	memcpy(&bits, &time_s, sizeof bits);
	atomic_store_explicit(&progress->time_bits, bits, memory_order_relaxed);
}

void rb_progress_waits(struct rb_progress *progress, const char *awaited)
{
	atomic_store(&progress->awaited, awaited);
}

void rb_progress_paused(struct rb_progress *progress, double paused_s)
{
	atomic_store(&progress->paused_ns, (uint64_t)(paused_s * 1e9));
}

int rb_progress_signal(const struct rb_progress *progress)
{
	return atomic_load_explicit(&progress->signal, memory_order_relaxed);
}
