/* SPDX-License-Identifier: MIT */
/*
 * Cameras with functions of time: where they stand at one of their pictures, and what it says.
 *
 * Same thread, errors and budget as the callbacks (script/hooks). The functions depend on nothing
 * but t and on handles, which show the frame that is being drawn, in a live run as in one that is
 * read from a recording.
 */
#ifndef RB_SCRIPT_SHOTS_H
#define RB_SCRIPT_SHOTS_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

struct rb_script;

/*
 * Calls the camera's functions for the time of `frame`; handles show that frame. Fills position,
 * look_at, up and texts of `shot` as far as they come from functions; the others stay. RB_ERR_SCENE
 * with the camera, the key, the time and what was wrong.
 */
RB_CHECKED enum rb_status rb_script_shot(struct rb_script *script, const struct rb_model *model,
                                         const struct rb_camera_def *camera,
                                         const struct rb_frame *frame, struct rb_frame_shot *shot,
                                         struct rb_error *err);

/*
 * Times of the pictures of a camera whose speed is a function: one after the other, each later by
 * the mean of the function over the time between them, divided by fps; from `from_s` on, none later
 * than `to_s`. Handles show the start. `picture_s` is the caller's: [count], for rb_memory_free.
 */
struct rb_picture_times {
	double fps, to_s;
	double *picture_s;
	uint64_t count;
};
RB_CHECKED enum rb_status rb_script_pictures(struct rb_script *script,
                                             const struct rb_camera_def *camera,
                                             struct rb_picture_times *times, struct rb_error *err);

#endif
