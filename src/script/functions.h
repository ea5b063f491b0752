/* SPDX-License-Identifier: MIT */
/*
 * Functions of a scene that a run asks for values, thousands of times in a simulated second:
 * `field`, `motion`, and what a motor follows. They depend on nothing but their arguments: what
 * they see of the world is the start.
 *
 * Same thread, errors and budget as the callbacks (script/hooks), of which they may be called from
 * within. An error is RB_ERR_SCENE with the place of the function, the body and the time.
 */
#ifndef RB_SCRIPT_FUNCTIONS_H
#define RB_SCRIPT_FUNCTIONS_H

#include <rbsim/world.h>

struct rb_script;
struct lua_State;

/*
 * Raises "scene.lua:12: 'motion' must return a position ... (got nothing)": what the function of
 * that number gave is at `index`.
 */
int rb_function_refuse(struct lua_State *L, int function, const char *word, const char *wanted,
                       int index);

/* In protected mode, when the scene has been read: what calls need is made once, not each time. */
void rb_functions_prepare(struct lua_State *L);

/* What `position` and `orientation` of a call said of a body that `motion` drives: to be remembered
 * until rb_functions_start. */
void rb_functions_placed(struct lua_State *L, int id, bool position, bool orientation);

/* Asks the motion of a driven body for time 0 and puts what it says into its definition. */
RB_CHECKED enum rb_status rb_functions_start(struct rb_script *script, int id,
                                             struct rb_error *err);

/*
 * Sums of all fields on the body of that id, at {position, velocity}: of those without a potential,
 * of those with one. And of the potentials, J.
 */
RB_CHECKED enum rb_status rb_functions_field(struct rb_script *script, int id, double time_s,
                                             const rb_vec3 at[2], rb_vec3 force[2],
                                             struct rb_error *err);
RB_CHECKED enum rb_status rb_functions_potential(struct rb_script *script, int id, double time_s,
                                                 rb_vec3 position, double *energy,
                                                 struct rb_error *err);

/* Pose of a driven body, by id. */
RB_CHECKED enum rb_status rb_functions_motion(struct rb_script *script, int id, double time_s,
                                              struct rb_driven_pose *pose, struct rb_error *err);

/*
 * The angle or way, rad or m, that the motor of a joint follows, by the joint's number, and its
 * rate, NAN where the function returns none.
 */
RB_CHECKED enum rb_status rb_functions_follow(struct rb_script *script, int joint, double time_s,
                                              double way[2], struct rb_error *err);

#endif
