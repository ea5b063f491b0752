/* SPDX-License-Identifier: MIT */
/*
 * Three sources with the same functions, chosen at every call by what the script holds: a frame
 * goes before a world, a world before the start. All derived numbers (energy, momenta, points) are
 * computed once, from whatever the source knows, so that they mean the same everywhere.
 */
#include "script/moment.h"

#include <math.h>

#include <lauxlib.h>

#include "base/error.h"
#include "geom/mass.h"
#include "math/quat.h"
#include "model/validate.h"

/* What a kind of moment knows by itself; all else follows from it and from the definition. */
struct source {
	rb_vec3 (*position)(lua_State *L, int id);
	rb_quat (*orientation)(lua_State *L, int id);
	rb_vec3 (*velocity)(lua_State *L, int id); /* of the centre of mass */
	rb_vec3 (*angular_velocity)(lua_State *L, int id);
	struct rb_load (*load)(lua_State *L, int id, const char *name);
	double (*time)(lua_State *L);
	struct rb_frame_numbers (*numbers)(lua_State *L, const char *call, bool of_run);
	struct rb_joint_reading (*joint)(lua_State *L, int joint, const char *name);
};

/* The body's definition. */
static const struct rb_body_def *definition(lua_State *L, int id)
{
	RB_ASSERT(id >= 0 && id < rb_script_of(L)->scene->body_count);
	return &rb_script_of(L)->scene->bodies[id];
}

/* ---- the start ---- */

static rb_vec3 start_position(lua_State *L, int id)
{
	return definition(L, id)->position;
}

static rb_quat start_orientation(lua_State *L, int id)
{
	return definition(L, id)->orientation;
}

static rb_vec3 start_velocity(lua_State *L, int id)
{
	return definition(L, id)->velocity;
}

static rb_vec3 start_angular_velocity(lua_State *L, int id)
{
	return definition(L, id)->angular_velocity;
}

static struct rb_load start_load(lua_State *L, int id, const char *name)
{
	(void)id;
	luaL_error(L, "a body's '%s': only in callbacks and at the end of a run", name);
	return (struct rb_load){.force = {0, 0, 0}};
}

static double start_time(lua_State *L)
{
	(void)L;
	return 0;
}

static struct rb_frame_numbers start_numbers(lua_State *L, const char *call, bool of_run)
{
	(void)of_run;
	luaL_error(L, "%s: only in callbacks and at the end of a run", call);
	return (struct rb_frame_numbers){0};
}

static struct rb_joint_reading start_joint(lua_State *L, int joint, const char *name)
{
	(void)joint;
	luaL_error(L, "a joint's '%s': only in callbacks and at the end of a run", name);
	return (struct rb_joint_reading){0};
}

/* ---- the world ---- */

static rb_vec3 world_position(lua_State *L, int id)
{
	return rb_world_position(rb_script_of(L)->world, id);
}

static rb_quat world_orientation(lua_State *L, int id)
{
	return rb_world_orientation(rb_script_of(L)->world, id);
}

static rb_vec3 world_velocity(lua_State *L, int id)
{
	return rb_world_velocity(rb_script_of(L)->world, id);
}

static rb_vec3 world_angular_velocity(lua_State *L, int id)
{
	return rb_world_angular_velocity(rb_script_of(L)->world, id);
}

static struct rb_load world_load(lua_State *L, int id, const char *name)
{
	struct rb_load load;
	struct rb_error err;

	(void)name;
	rb_script_need(L, rb_world_load(rb_script_of(L)->world, id, &load, &err), &err);
	return load;
}

static double world_time(lua_State *L)
{
	return rb_world_time(rb_script_of(L)->world);
}

static struct rb_frame_numbers world_numbers(lua_State *L, const char *call, bool of_run)
{
	(void)call;
	(void)of_run;
	return rb_world_totals(rb_script_of(L)->world);
}

static struct rb_joint_reading world_joint(lua_State *L, int joint, const char *name)
{
	struct rb_joint_reading now;
	struct rb_error err;

	(void)name;
	rb_script_need(L, rb_world_joint(rb_script_of(L)->world, joint, &now, &err), &err);
	return now;
}

/* ---- a frame ---- */

/*
 * The numbers of a body in a column of the frame; NULL: it has none there, because it never moves.
 * Raises an error where the frame lacks the column.
 */
static const double *row_of(lua_State *L, int id, const double *column, int width, const char *name)
{
	const struct rb_script *script = rb_script_of(L);
	const int index = script->frame_model->index_of[id];

	if (index >= script->frame_model->body_count)
		return NULL;
	if (!column)
		luaL_error(L,
		           "a body's '%s' is not in the frames that are drawn (see 'fields' of "
		           "record)",
		           name);
	return column + (size_t)width * (size_t)index;
}

static rb_vec3 frame_position(lua_State *L, int id)
{
	const double *row = row_of(L, id, rb_script_of(L)->frame->position, 3, "position");

	return row ? rb_vec3_from(row) : start_position(L, id);
}

/* Whether frames of this model have orientations; without rotation they stay as at the start. */
static bool frame_turns(lua_State *L)
{
	return (rb_script_of(L)->frame_model->features & RB_FEATURE_ROTATION) != 0;
}

static rb_quat frame_orientation(lua_State *L, int id)
{
	const double *row = frame_turns(L) ? row_of(L, id, rb_script_of(L)->frame->orientation, 4,
	                                            "orientation")
	                                   : NULL;

	return row ? rb_quat_from(row) : start_orientation(L, id);
}

static rb_vec3 frame_velocity(lua_State *L, int id)
{
	const double *row = row_of(L, id, rb_script_of(L)->frame->velocity, 3, "velocity");

	return row ? rb_vec3_from(row) : (rb_vec3){0, 0, 0};
}

static rb_vec3 frame_angular_velocity(lua_State *L, int id)
{
	const double *row = frame_turns(L) ? row_of(L, id, rb_script_of(L)->frame->angular_velocity,
	                                            3, "angular_velocity")
	                                   : NULL;

	return row ? rb_vec3_from(row) : (rb_vec3){0, 0, 0};
}

static struct rb_load frame_load(lua_State *L, int id, const char *name)
{
	(void)id;
	luaL_error(L,
	           "a body's '%s' is not available in the function of a camera: frames do not "
	           "contain it",
	           name);
	return (struct rb_load){.force = {0, 0, 0}};
}

static double frame_time(lua_State *L)
{
	return rb_script_of(L)->frame->time_s;
}

static struct rb_frame_numbers frame_numbers(lua_State *L, const char *call, bool of_run)
{
	if (of_run)
		luaL_error(
			L,
			"%s is not available in the function of a camera: frames do not contain it",
			call);
	return rb_script_of(L)->frame->numbers;
}

static struct rb_joint_reading frame_joint(lua_State *L, int joint, const char *name)
{
	const struct rb_frame *frame = rb_script_of(L)->frame;

	if (!frame->joint_value)
		luaL_error(L,
		           "a joint's '%s' is not in the frames that are drawn (see 'fields' of "
		           "record)",
		           name);
	return (struct rb_joint_reading){
		.angle = frame->joint_value[joint],
		.speed = frame->joint_speed[joint],
		.force = rb_vec3_from(frame->joint_force + 3 * (size_t)joint),
		.torque = rb_vec3_from(frame->joint_torque + 3 * (size_t)joint),
	};
}

/* ---- whichever it is ---- */

/* What handles show now. */
static const struct source *source_of(lua_State *L)
{
	static const struct source start = {
		start_position, start_orientation, start_velocity, start_angular_velocity,
		start_load,     start_time,        start_numbers,  start_joint};
	static const struct source world = {
		world_position, world_orientation, world_velocity, world_angular_velocity,
		world_load,     world_time,        world_numbers,  world_joint};
	static const struct source frame = {
		frame_position, frame_orientation, frame_velocity, frame_angular_velocity,
		frame_load,     frame_time,        frame_numbers,  frame_joint};
	const struct rb_script *script = rb_script_of(L);

	return script->frame ? &frame : script->world ? &world : &start;
}

rb_vec3 rb_moment_position(lua_State *L, int id)
{
	return source_of(L)->position(L, id);
}

rb_quat rb_moment_orientation(lua_State *L, int id)
{
	return source_of(L)->orientation(L, id);
}

rb_vec3 rb_moment_velocity(lua_State *L, int id)
{
	return source_of(L)->velocity(L, id);
}

rb_vec3 rb_moment_angular_velocity(lua_State *L, int id)
{
	return source_of(L)->angular_velocity(L, id);
}

struct rb_load rb_moment_load(lua_State *L, int id, const char *name)
{
	return source_of(L)->load(L, id, name);
}

struct rb_joint_reading rb_moment_joint(lua_State *L, int joint, const char *name)
{
	return source_of(L)->joint(L, joint, name);
}

rb_vec3 rb_moment_point(lua_State *L, int id, rb_vec3 point)
{
	return rb_vec3_add(rb_moment_position(L, id),
	                   rb_quat_rotate(rb_moment_orientation(L, id), point));
}

double rb_moment_mass(lua_State *L, int id)
{
	const struct rb_body_def *def = definition(L, id);

	return rb_body_is_free(def) ? rb_body_mass(rb_script_of(L)->scene, def) : (double)INFINITY;
}

rb_mat3 rb_moment_inertia(lua_State *L, int id)
{
	const struct rb_body_def *def = definition(L, id);

	return rb_body_is_free(def)
	               ? rb_body_inertia(rb_script_of(L)->scene, def, rb_moment_mass(L, id))
	               : (rb_mat3){{{0}}};
}

/* Angular momentum of a free body about its centre of mass, kg m^2/s, world axes. */
static rb_vec3 spin_momentum(lua_State *L, int id)
{
	const rb_mat3 inertia = rb_moment_inertia(L, id);
	const rb_vec3 spin = rb_moment_angular_velocity(L, id);

	if (rb_inertia_is_scalar(&inertia))
		return rb_vec3_scale(inertia.m[0][0], spin);
	const rb_quat turn = rb_moment_orientation(L, id);
	return rb_quat_rotate(turn, rb_mat3_apply(&inertia, rb_quat_rotate_back(turn, spin)));
}

double rb_moment_kinetic_energy(lua_State *L, int id)
{
	if (!rb_body_is_free(definition(L, id)))
		return 0;
	const rb_vec3 v = rb_moment_velocity(L, id), w = rb_moment_angular_velocity(L, id);
	return 0.5 * rb_moment_mass(L, id) * rb_vec3_dot(v, v) +
	       0.5 * rb_vec3_dot(w, spin_momentum(L, id));
}

rb_vec3 rb_moment_momentum(lua_State *L, int id)
{
	if (!rb_body_is_free(definition(L, id)))
		return (rb_vec3){0, 0, 0};
	return rb_vec3_scale(rb_moment_mass(L, id), rb_moment_velocity(L, id));
}

rb_vec3 rb_moment_angular_momentum(lua_State *L, int id)
{
	const struct rb_body_def *def = definition(L, id);

	if (!rb_body_is_free(def))
		return (rb_vec3){0, 0, 0};
	const rb_vec3 center = rb_moment_point(L, id, def->center_of_mass);
	return rb_vec3_add(rb_vec3_cross(center, rb_moment_momentum(L, id)), spin_momentum(L, id));
}

double rb_moment_time(lua_State *L)
{
	return source_of(L)->time(L);
}

struct rb_frame_numbers rb_moment_numbers(lua_State *L, const char *call, bool of_run)
{
	return source_of(L)->numbers(L, call, of_run);
}
