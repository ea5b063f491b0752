/* SPDX-License-Identifier: MIT */
/*
 * The thread beside a simulation: takes the signals and says how far the run is.
 *
 * Owned by the simulator's thread, which starts and stops it. From start to stop the signals of
 * rb_thread_stops go to this thread alone: the first one asks the simulator to stop
 * (rb_progress_signal), a SIGINT after that ends the process at once with 130.
 */
#ifndef RB_APP_PROGRESS_H
#define RB_APP_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

struct rb_progress;

struct rb_progress_options {
	bool quiet;
	double duration_s; /* of the whole run, simulated */
	/*
	 * called with the first signal, in the thread beside the simulation; NULL: nothing is to be
	 * done
	 */
	void (*heed)(void *user, int signal);
	void *heed_user;
	/* called before the second SIGINT ends the process; NULL: nothing is to be done */
	void (*leave)(void *user);
	void *leave_user;
};

RB_CHECKED enum rb_status rb_progress_start(struct rb_progress **progress,
                                            const struct rb_progress_options *options,
                                            struct rb_error *err);
/*
 * Takes the bar off the screen and ends the thread; signals are as before. Gives the signal that
 * asked for an end, also one that came last; 0: none. NULL is fine.
 */
int rb_progress_stop(struct rb_progress *progress);

/* Simulator's thread: where it is. Cheap enough for every step. */
void rb_progress_at(struct rb_progress *progress, double time_s);
/* Any thread: who the run waits for, a text that stays; NULL: for nobody. */
void rb_progress_waits(struct rb_progress *progress, const char *awaited);
/* Any thread: how long the run has stood still so far, which does not count as its time. */
void rb_progress_paused(struct rb_progress *progress, double paused_s);
/* The signal that asked for an end, 0: none. From any thread. */
int rb_progress_signal(const struct rb_progress *progress);

/*
 * How long the rest will take, by what the latest part of the run took: `begin` and `middle` of a
 * window that is a quarter of the wall time so far, or somewhat more; zeros to begin with. NAN:
 * nobody knows yet.
 */
struct rb_pace_window {
	double begin_wall_s, begin_s, middle_wall_s, middle_s;
};
double rb_progress_left(struct rb_pace_window *window, double time_s, double duration_s,
                        double wall_s);

struct rb_progress_now {
	double time_s, duration_s; /* simulated */
	double wall_s, left_s;     /* left_s: may be NAN */
};
/* A progress line of at most `width` columns, for tests too. `line` has room for `size` bytes. */
void rb_progress_line(char *line, int size, int width, const struct rb_progress_now *now);

/* A duration for people: 0.4 s, 12 s, 3:07 min, 2:15:30 h. */
void rb_progress_duration(char *text, size_t size, double seconds);

/* Colour and redrawing make sense on this descriptor: a terminal that is not dumb. */
bool rb_terminal_is_capable(int descriptor);

#endif
