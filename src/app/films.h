/* SPDX-License-Identifier: MIT */
/*
 * The cameras that are filmed: which of a scene's, with what outputs, their sinks, and where those
 * that move by functions of time stand.
 *
 * Owned by the thread that fills the frames (the simulator's, or that of rbsim render), which alone
 * runs the scene's Lua. Each film works on a thread of its own from rb_films_start to
 * rb_films_join.
 */
#ifndef RB_APP_FILMS_H
#define RB_APP_FILMS_H

#include "app/common.h"
#include "app/film_choice.h"
#include "base/pack.h"
#include "control/player.h"
#include "flow/ring.h"
#include "sink/module.h"

/*
 * Chooses the cameras and checks that their films can be made, before anything is written or
 * simulated. `*films` is NULL where there is nothing to film. `loaded` is borrowed until
 * rb_films_destroy. RB_ERR_USAGE (a camera that is not there), RB_ERR_SCENE (two films with one
 * name), RB_ERR_MISSING, RB_ERR_CREATE.
 */
RB_CHECKED enum rb_status rb_films_create(struct rb_films **films, struct rb_loaded *loaded,
                                          const struct rb_films_wish *wish, struct rb_error *err);
/*
 * The one camera that is wished for, changed as wished, without looking at outputs; errors as
 * above. Of a film of several `*cells` are the caller's, for rb_memory_free; else NULL and 0.
 */
RB_CHECKED enum rb_status rb_films_one_camera(struct rb_camera_def *camera,
                                              struct rb_film_cell **cells, int *cell_count,
                                              struct rb_loaded *loaded,
                                              const struct rb_films_wish *wish,
                                              struct rb_error *err);
/*
 * Where a camera without a position stands: it sees what moves from one time to the other in a
 * recording. Whom it leaves out is told.
 */
RB_CHECKED enum rb_status rb_films_frame_camera(struct rb_camera_def *camera,
                                                const struct rb_model *model,
                                                const struct rb_hdf5_module *module,
                                                struct rb_reader *reader, const char *label,
                                                struct rb_error *err);
/* That of each film at work that has none. */
RB_CHECKED enum rb_status rb_films_frame(struct rb_films *films,
                                         const struct rb_hdf5_module *module,
                                         struct rb_reader *reader, struct rb_error *err);
/*
 * Films of a run whose cameras have no position are made from its recording when it has ended:
 * whether there are any; from then on they are those at work, all other functions know of no
 * others.
 */
bool rb_films_begin_late(struct rb_films *films);
void rb_films_destroy(struct rb_films *films); /* NULL is fine, for all below too */

int rb_films_count(const struct rb_films *films);
/* RB_FIELD_* that the films read. */
unsigned rb_films_fields(const struct rb_films *films);
/* What of `wanted` a recording of other fields lacks; nothing where nothing moves. */
unsigned rb_films_missing(const struct rb_model *model, unsigned wanted, unsigned fields);
/*
 * Warns of what of `wanted` films of `name`, a recording of other fields, lack, and what comes of
 * it.
 */
void rb_films_tell_missing(const struct rb_model *model, const char *name, unsigned wanted,
                           unsigned fields);
/*
 * Before a run: warns of what films of the scene's cameras would lack that are made from its
 * recording.
 */
void rb_films_tell_unrecorded(const struct rb_loaded *loaded);
/*
 * Simulated time of the first frame that the films want to see; what grows from frame to frame
 * wants all.
 */
double rb_films_first_s(const struct rb_films *films);

/* Starts every film; frames of the ring must have rb_films_fields. */
RB_CHECKED enum rb_status rb_films_start(struct rb_films *films, struct rb_ring *ring,
                                         const struct rb_outcome *outcome, struct rb_error *err);
/*
 * Adds to a frame, before it is published, where cameras with functions stand at their pictures
 * since the frame before.
 */
RB_CHECKED enum rb_status rb_films_shoot(struct rb_films *films, struct rb_frame *frame,
                                         struct rb_error *err);
/*
 * From any thread, between rb_films_create and rb_films_destroy: the films end with the pictures
 * that are printed, also where frames are still to come or many pictures lie before the next one;
 * the signal is why.
 */
void rb_films_cut(struct rb_films *films, int signal);
/*
 * Between two frames, of which the first is at `time_s`: pictures after it are left out, or drawn
 * again.
 */
RB_CHECKED enum rb_status rb_films_switch(struct rb_films *films, double time_s, bool on,
                                          struct rb_error *err);
bool rb_films_are_on(const struct rb_films *films);
/*
 * Likewise: a camera is moved, from where it stands at the second of these frames. Nothing where it
 * makes no film now.
 */
RB_CHECKED enum rb_status rb_films_steer(struct rb_films *films, double time_s,
                                         const struct rb_player_aim *aim, struct rb_error *err);
/*
 * When they were switched and moved, to bytes and back (base/pack): loading, before rb_films_start.
 */
void rb_films_pack(struct rb_films *films, struct rb_pack *pack);
/*
 * After the ring was closed: waits for all films to be whole. The first failure is told, with the
 * camera, or that they were cut.
 */
RB_CHECKED enum rb_status rb_films_join(struct rb_films *films, struct rb_error *err);

#endif
