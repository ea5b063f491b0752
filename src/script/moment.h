/* SPDX-License-Identifier: MIT */
/*
 * Bodies and numbers at the moment that a scene sees: the start while nothing runs, the world in
 * callbacks, the frame that is drawn in functions of cameras. A frame goes before a world.
 *
 * Called from functions that Lua calls; they raise a Lua error where the moment does not know what
 * is asked for.
 */
#ifndef RB_SCRIPT_MOMENT_H
#define RB_SCRIPT_MOMENT_H

#include "script/script.h"

rb_vec3 rb_moment_position(lua_State *L, int id);
rb_quat rb_moment_orientation(lua_State *L, int id);
rb_vec3 rb_moment_velocity(lua_State *L, int id);
rb_vec3 rb_moment_angular_velocity(lua_State *L, int id);
/* Raises an error where it is not known, with the name of what was asked for. */
struct rb_load rb_moment_load(lua_State *L, int id, const char *name);
rb_vec3 rb_moment_point(lua_State *L, int id,
                        rb_vec3 point); /* world position of an object point */

/* The same of a joint, by its number. */
struct rb_joint_reading rb_moment_joint(lua_State *L, int joint, const char *name);

double rb_moment_mass(lua_State *L, int id);     /* INFINITY: nothing pushes it */
rb_mat3 rb_moment_inertia(lua_State *L, int id); /* object axes; 0: nothing pushes it */

double rb_moment_kinetic_energy(lua_State *L, int id);
rb_vec3 rb_moment_momentum(lua_State *L, int id);
rb_vec3 rb_moment_angular_momentum(lua_State *L, int id); /* about the world's origin */

double rb_moment_time(lua_State *L);
/*
 * `call` names who asks; `of_run`: for a number that counts since the start, which frames do not
 * have.
 */
struct rb_frame_numbers rb_moment_numbers(lua_State *L, const char *call, bool of_run);

#endif
