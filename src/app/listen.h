/* SPDX-License-Identifier: MIT */
/*
 * What commands a run from outside: the socket of --listen, the lines of --commands, and what they
 * need of the run: its player, the last frames, and starting it anew.
 *
 * Owned by whoever owns the run, over all its restarts. The simulator's thread is the one that
 * creates it. NULL stands for a run that nobody commands: it pays nothing.
 */
#ifndef RB_APP_LISTEN_H
#define RB_APP_LISTEN_H

#include "app/common.h"
#include "control/player.h"
#include "flow/run_info.h"

struct rb_listen;

/*
 * `*listen` is NULL where the options ask for none. From here to rb_listen_destroy the signals of
 * rb_thread_stops are blocked, so that none is lost between a run and the next. Borrows the
 * options, and `info` with its scene until rb_listen_run_ends. RB_ERR_INPUT (the file of commands),
 * RB_ERR_CREATE (the socket).
 */
RB_CHECKED enum rb_status rb_listen_create(struct rb_listen **listen,
                                           const struct rb_options *options,
                                           struct rb_loaded *loaded, const struct rb_run_info *info,
                                           struct rb_error *err);
/* Says goodbye to all who watch and takes the socket away. NULL is fine. */
void rb_listen_destroy(struct rb_listen *listen);

/* ---- while the run goes on: the simulator's thread ---- */

/* RB_FIELD_* of frames that are to be kept; NULL is fine. */
unsigned rb_listen_fields(const struct rb_listen *listen);
/* A frame, before it is published. */
void rb_listen_frame(struct rb_listen *listen, const struct rb_frame *frame);
/* What the gate asks of the run. */
struct rb_listen_calls {
	bool (*stop)(void *user); /* whether a signal has ended it */
	void (*keep)(void *user); /* makes a checkpoint of this frame */
	void *user;
};
/*
 * After it was published: executes commands that are due, waits while the run is paused.
 * RB_PLAYER_RESTART: the scene was loaded anew and waits in rb_listen_next; where it could not be,
 * the run stays paused as it is and that is told.
 */
enum rb_player_verdict rb_listen_gate(struct rb_listen *listen, const struct rb_player_frame *frame,
                                      const struct rb_listen_calls *calls);
/* The run makes films; whether their pictures after this frame are wanted. True for NULL. */
void rb_listen_has_films(struct rb_listen *listen, bool has);
bool rb_listen_filming(const struct rb_listen *listen);
void rb_listen_film(struct rb_listen *listen, bool on);
/* A movement of a film's camera that commands ask for; false: none is left, or NULL. */
bool rb_listen_take_aim(struct rb_listen *listen, struct rb_player_aim *aim);
/* Wall time of the run that it stood still. */
double rb_listen_paused_s(const struct rb_listen *listen);
/* Takes the socket's name away, where the process is about to end at once. Any thread. */
void rb_listen_forget(void *listen);

/* ---- from one run to the next ---- */

/* Nobody may look at the scene any more, which can be released then. */
void rb_listen_run_ends(struct rb_listen *listen);
/* The scene for the next run, once; the caller's, to be released and freed (rb_memory_free). */
struct rb_loaded *rb_listen_next(struct rb_listen *listen);
/*
 * The options for the next run: with the parameters that were set, and replacing this run's own
 * outputs.
 */
const struct rb_options *rb_listen_options(const struct rb_listen *listen);
/* The next run begins. Borrows `info` as rb_listen_create does. */
RB_CHECKED enum rb_status rb_listen_begin_again(struct rb_listen *listen, struct rb_loaded *loaded,
                                                const struct rb_run_info *info,
                                                struct rb_error *err);

#endif
