/* SPDX-License-Identifier: MIT */
/*
 * A camera that is moved by hand: where it stands at a frame, and what commands make of it. Values,
 * any thread.
 */
#ifndef RB_CONTROL_STEER_H
#define RB_CONTROL_STEER_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

/* Where a camera stands at a frame. */
struct rb_stand {
	rb_vec3 eye, target;     /* m, world */
	rb_vec3 right, up, back; /* unit, world */
};

/* A body's origin, by its id. */
rb_vec3 rb_steer_body(const struct rb_model *model, const struct rb_frame *frame, int id);
/* A camera that sees all bodies at the start, for a scene that has none. */
struct rb_camera_def rb_steer_default(const struct rb_model *model);
/* `shot` is for what comes from functions, NULL: nothing does. */
struct rb_stand rb_steer_stand(const struct rb_model *model, const struct rb_camera_def *camera,
                               const struct rb_frame *frame, const struct rb_frame_shot *shot);

/*
 * What moves by a function or with a body stands still afterwards where it has to; a mounted camera
 * stays mounted. `by`: m to the right, up, forward. Angles: rad around the vertical through the
 * target, and over it, short of the pole.
 */
void rb_steer_move(struct rb_camera_def *camera, const struct rb_stand *stand, rb_vec3 by);
void rb_steer_orbit(struct rb_camera_def *camera, const struct rb_stand *stand, double around,
                    double over);
/* So many times nearer to the target. */
void rb_steer_zoom(struct rb_camera_def *camera, const struct rb_stand *stand, double factor);
/* On a body that is at `at`, standing where it is now; id -1: on none. */
void rb_steer_mount(struct rb_camera_def *camera, const struct rb_stand *stand, int id, rb_vec3 at);
/* A body in the middle of the picture; -1: what is there now. */
void rb_steer_follow(struct rb_camera_def *camera, const struct rb_stand *stand, int id);

#endif
