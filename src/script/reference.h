/* SPDX-License-Identifier: MIT */
/*
 * The exact motion that a scene states with `reference`, at one time.
 *
 * Called from the thread that owns the script, as script/hooks. The caller owns the rows.
 */
#ifndef RB_SCRIPT_REFERENCE_H
#define RB_SCRIPT_REFERENCE_H

#include <rbsim/world.h>

#include "script/types.h"

struct rb_script; /* script/load */

/* Of one body; what the scene does not state is zero. */
struct rb_reference_pose {
	unsigned known; /* RB_FIELD_POSITION, _ORIENTATION, _VELOCITY, _ANGULAR_VELOCITY */
	rb_vec3 position, velocity, angular_velocity; /* as in a frame */
	rb_quat orientation;                          /* of length 1 */
};

bool rb_script_has_reference(const struct rb_script *script);

/*
 * Fills `poses`, one row per body of the scene, by id. RB_ERR_SCENE where there is no reference, it
 * raises an error, returns something else than a table of bodies, or numbers that are not finite.
 */
RB_CHECKED enum rb_status rb_script_reference(struct rb_script *script, struct rb_world *world,
                                              double time_s, struct rb_reference_pose *poses,
                                              struct rb_error *err);

#endif
