/* SPDX-License-Identifier: MIT */
/*
 * Cameras of films that commands move while the run goes on. A movement counts from the frame after
 * it on, from where the camera stands there; until then it is kept as it was asked for, so that a
 * run that goes on from a checkpoint comes to the same pictures.
 *
 * Owned by the films; the simulator's thread.
 */
#ifndef RB_APP_STEERING_H
#define RB_APP_STEERING_H

#include "app/common.h"
#include "base/pack.h"
#include "control/player.h"

struct rb_steering {
	struct rb_steering_row *row; /* owned: in order of time */
	size_t count, capacity;
};

/* Whose camera: the film's number, which of its cameras, and as the scene has it. */
struct rb_steering_film {
	struct rb_loaded *loaded;
	const struct rb_camera_def *camera;
	int number, cell;
};

void rb_steering_release(struct rb_steering *steering);

/* A movement between the frame of `time_s` and the next one. */
RB_CHECKED enum rb_status rb_steering_add(struct rb_steering *steering,
                                          const struct rb_steering_film *film, double time_s,
                                          const struct rb_player_aim *aim, struct rb_error *err);

/* Makes the movements of a film that were asked for before this frame. */
RB_CHECKED enum rb_status rb_steering_advance(struct rb_steering *steering,
                                              const struct rb_steering_film *film,
                                              const struct rb_frame *frame, struct rb_error *err);

/* Whether shots say where a film's camera stands: by its functions, or by commands. */
bool rb_steering_is_wanted(const struct rb_steering *steering, const struct rb_steering_film *film);

/* Where it stands at a moment: fills all of `shot` but its numbers. */
RB_CHECKED enum rb_status rb_steering_shot(const struct rb_steering *steering,
                                           const struct rb_steering_film *film,
                                           const struct rb_frame *moment,
                                           struct rb_frame_shot *shot, struct rb_error *err);

/* All of it to bytes and back, for so many films. NULL: there are none. */
void rb_steering_pack(struct rb_steering *steering, int film_count, struct rb_pack *pack);

#endif
