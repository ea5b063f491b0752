/* SPDX-License-Identifier: MIT */
/*
 * These calls are the hottest path into Lua: a field is asked for every body at every step. So all
 * that does not change is prepared once: the vectors for x and v are two tables that are
 * overwritten, and the closures hold them and the functions as upvalues; a call makes no garbage of
 * ours.
 *
 * A motion decides at time 0 whether it gives an orientation, a velocity, an angular velocity; it
 * must do so always, because the solver has chosen by then what to derive numerically.
 */
#include "script/functions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/quat.h"
#include "model/joints.h"
#include "model/validate.h"
#include "script/call.h"
#include "script/globals.h"
#include "script/handles.h"
#include "script/joint_handles.h"
#include "script/vector.h"

/* Registry: [id + 1] = bits of what the scene gave: a position, an orientation. */
static const char placed_key[] = "rbsim.placed";
enum { PLACED_POSITION = 1, PLACED_ORIENTATION = 2 };

/*
 * Relative: how far what the scene says of a body and what its motion says at time 0 may differ.
 * Far above the rounding of any formula, far below what one would mean.
 */
static const double agreement = 1e-6;

/*
 * What a call from outside hands to the closure that serves it. `placed` also gets, two bits
 * higher, whether the motion gave an orientation.
 */
struct request {
	double time_s;
	rb_vec3 position, velocity, value[2]; /* of a field without, with a potential */
	double energy;
	int id, placed;
	bool starts; /* the first call: whether it turns is not known yet */
	struct rb_driven_pose pose;
	double way[2]; /* that a motor follows, and its rate; `id` is the joint's number then */
};

/* Values below the results of a function: what the closures have as upvalues. */
enum { UPVALUE_POSITION = 1, UPVALUE_VELOCITY, UPVALUE_FIRST_FIELD };

/* Pushes "scene.lua:12: " for the function of this number. */
static void push_place(lua_State *L, int function)
{
	lua_Debug at;

	rb_script_push_function(L, function);
	lua_getinfo(L, ">S", &at);
	lua_pushfstring(L, "%s:%d: ", at.source + (at.source[0] == '@' || at.source[0] == '='),
	                at.linedefined);
}

int rb_function_refuse(lua_State *L, int function, const char *word, const char *wanted, int index)
{
	char found[80];

	rb_describe(L, index, found);
	push_place(L, function);
	lua_pushfstring(L, "'%s' must return %s (got %s)", word, wanted, found);
	lua_concat(L, 2);
	return lua_error(L);
}

/* Three finite numbers. Keys beside them are not looked for: this runs a million times. */
static bool read_vector(lua_State *L, int index, rb_vec3 *value)
{
	double numbers[3];

	if (lua_type(L, index) != LUA_TTABLE || lua_rawlen(L, index) != 3)
		return false;
	for (int i = 0; i < 3; i++) {
		if (lua_rawgeti(L, index, i + 1) != LUA_TNUMBER) {
			lua_pop(L, 1);
			return false;
		}
		numbers[i] = lua_tonumber(L, -1);
		lua_pop(L, 1);
	}
	*value = rb_vec3_from(numbers);
	return rb_vec3_finite(*value);
}

/*
 * Pushes the vector of an upvalue with new numbers in it. The scene must not keep it; a copy is
 * vec3(v).
 */
static void push_reused(lua_State *L, int upvalue, rb_vec3 v)
{
	const int index = lua_upvalueindex(upvalue);

	lua_pushnumber(L, v.x);
	lua_rawseti(L, index, 1);
	lua_pushnumber(L, v.y);
	lua_rawseti(L, index, 2);
	lua_pushnumber(L, v.z);
	lua_rawseti(L, index, 3);
	lua_pushvalue(L, index);
}

/* Pushes the body for a function that asks for it; how many values. */
static int push_body(lua_State *L, bool asks, int id)
{
	if (asks)
		rb_handle_push(L, id);
	return asks;
}

/*
 * Sum of all fields. Upvalues: a vector for x, one for v, the table of the fields' functions in
 * their order.
 */
static int serve_field(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	const struct rb_scene *scene = rb_script_of(L)->scene;
	rb_vec3 force;

	for (int i = 0; i < scene->field_count; i++) {
		rb_vec3 *const sum = &request->value[scene->fields[i].has_potential];

		lua_rawgeti(L, lua_upvalueindex(UPVALUE_FIRST_FIELD), i + 1);
		lua_pushnumber(L, request->time_s);
		push_reused(L, UPVALUE_POSITION, request->position);
		push_reused(L, UPVALUE_VELOCITY, request->velocity);
		lua_call(L, 3 + push_body(L, scene->fields[i].asks_body, request->id), 1);
		if (!read_vector(L, -1, &force))
			return rb_function_refuse(L, scene->fields[i].function, "field",
			                          "a finite force {x, y, z}", -1);
		*sum = rb_vec3_add(*sum, force);
		lua_pop(L, 1);
	}
	return 0;
}

/* Sum of the fields' potentials; upvalues as those of serve_field. */
static int serve_potential(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	const struct rb_scene *scene = rb_script_of(L)->scene;

	for (int i = 0; i < scene->field_count; i++) {
		if (!scene->fields[i].has_potential)
			continue;
		lua_rawgeti(L, lua_upvalueindex(UPVALUE_FIRST_FIELD), i + 1);
		lua_pushnumber(L, request->time_s);
		push_reused(L, UPVALUE_POSITION, request->position);
		lua_call(L, 2 + push_body(L, scene->fields[i].potential_asks_body, request->id), 1);
		const double energy = lua_tonumber(L, -1);
		if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(energy))
			return rb_function_refuse(L, scene->fields[i].potential, "potential",
			                          "a finite number of joules", -1);
		request->energy += energy;
		lua_pop(L, 1);
	}
	return 0;
}

/*
 * Takes the second result of a motion, at index 3; raises an error for what is none or was not
 * announced.
 */
static void read_orientation(lua_State *L, const struct rb_body_def *body, struct request *request)
{
	struct rb_turn_found found;
	const int index = 3;

	if (lua_isnil(L, index)) {
		if (body->motion_turns && !request->starts)
			rb_function_refuse(L, body->motion, "motion",
			                   "an orientation always or never", index);
		return;
	}
	if (!body->motion_turns && !request->starts)
		rb_function_refuse(L, body->motion, "motion",
		                   "an orientation always or never: it gave none at time 0", index);
	switch (rb_vector_turn(L, index, &request->pose.orientation, &found)) {
	case RB_TURN_RIGHT:
		break;
	case RB_TURN_NO_LIST:
		rb_function_refuse(
			L, body->motion, "motion",
			"an orientation {w, x, y, z} or {axis = {x, y, z}, angle = radians}",
			index);
		break;
	case RB_TURN_NOT_FINITE:
		rb_function_refuse(L, body->motion, "motion", "a finite orientation", index);
		break;
	case RB_TURN_NOT_UNIT:
		rb_function_refuse(L, body->motion, "motion",
		                   "an orientation of length 1, within 1e-3", index);
		break;
	case RB_TURN_NO_AXIS:
		rb_function_refuse(L, body->motion, "motion",
		                   "an orientation whose axis has a length", index);
		break;
	}
	if (request->starts)
		request->placed |= PLACED_ORIENTATION << 2;
}

/*
 * Calls the motion of a body. Stack afterwards: the request, then position, orientation, velocity,
 * angular velocity.
 */
static int serve_motion(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	const struct rb_body_def *body = &rb_script_of(L)->scene->bodies[request->id];
	struct rb_driven_pose *pose = &request->pose;

	lua_rawgeti(L, lua_upvalueindex(1), body->motion);
	lua_pushnumber(L, request->time_s);
	lua_call(L, 1, 4);
	*pose = (struct rb_driven_pose){.orientation = body->orientation};
	if (!read_vector(L, 2, &pose->position))
		return rb_function_refuse(L, body->motion, "motion",
		                          "a finite position {x, y, z} first", 2);
	read_orientation(L, body, request);
	pose->has_velocity = !lua_isnil(L, 4);
	if (!request->starts && pose->has_velocity != body->motion_gives_velocity)
		return rb_function_refuse(L, body->motion, "motion", "a velocity always or never",
		                          4);
	if (pose->has_velocity && !read_vector(L, 4, &pose->velocity))
		return rb_function_refuse(L, body->motion, "motion",
		                          "a finite velocity {x, y, z} third", 4);
	pose->has_angular_velocity = !lua_isnil(L, 5);
	if (!request->starts && pose->has_angular_velocity != body->motion_gives_angular_velocity)
		return rb_function_refuse(L, body->motion, "motion",
		                          "an angular velocity always or never", 5);
	if (pose->has_angular_velocity && !read_vector(L, 5, &pose->angular_velocity))
		return rb_function_refuse(L, body->motion, "motion",
		                          "a finite angular velocity {x, y, z} fourth", 5);
	if (pose->has_angular_velocity && lua_isnil(L, 3) &&
	    rb_vec3_max_abs(pose->angular_velocity) > 0)
		return rb_function_refuse(
			L, body->motion, "motion",
			"an orientation as well where it returns an angular velocity", 5);
	if (request->starts) {
		luaL_getsubtable(L, LUA_REGISTRYINDEX, placed_key);
		lua_rawgeti(L, -1, request->id + 1);
		request->placed |= (int)lua_tointeger(L, -1);
	}
	return 0;
}

/* Calls the function that a joint's motor follows: one finite number, and perhaps its rate. */
static int serve_follow(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	const struct rb_joint_def *joint = &rb_script_of(L)->scene->joints[request->id];
	const char *const way = rb_joint_way_name(joint->kind);

	lua_rawgeti(L, lua_upvalueindex(1), joint->motor_function);
	lua_pushnumber(L, request->time_s);
	lua_call(L, 1, 2);
	for (int k = 0; k < 2; k++) {
		const int at = k - 2;

		request->way[k] = lua_isnil(L, at) && k > 0 ? (double)NAN : lua_tonumber(L, at);
		if (lua_type(L, at) != LUA_TNUMBER ? k == 0 || !lua_isnil(L, at)
		                                   : !isfinite(request->way[k]))
			return rb_function_refuse(
				L, joint->motor_function, way,
				k == 0 ? "a finite number" : "a finite speed second, or none", at);
	}
	return 0;
}

/* Has the function on the stack more parameters than that, or any number of them? */
static bool asks_for_more(lua_State *L, int usual)
{
	lua_Debug about;

	lua_pushvalue(L, -1);
	lua_getinfo(L, ">u", &about);
	return about.nparams > usual || about.isvararg;
}

/* Pushes the list of the fields' functions, or potentials; notes which ask for bodies. */
static void push_fields(lua_State *L, bool potentials)
{
	struct rb_scene *scene = rb_script_of(L)->scene;

	lua_createtable(L, scene->field_count, 0);
	for (int i = 0; i < scene->field_count; i++) {
		struct rb_field_def *field = &scene->fields[i];

		if (potentials && !field->has_potential)
			continue;
		rb_script_push_function(L, potentials ? field->potential : field->function);
		*(potentials ? &field->potential_asks_body
		             : &field->asks_body) = asks_for_more(L, potentials ? 2 : 3);
		lua_rawseti(L, -2, i + 1);
	}
}

void rb_functions_prepare(lua_State *L)
{
	struct rb_script *script = rb_script_of(L);
	const rb_vec3 none = {0, 0, 0};

	for (int potentials = 0; potentials < 2; potentials++) {
		rb_vector_push(L, none);
		rb_vector_push(L, none);
		push_fields(L, potentials);
		lua_pushcclosure(L, potentials ? serve_potential : serve_field, 3);
		*(potentials ? &script->potential_closure
		             : &script->field_closure) = luaL_ref(L, LUA_REGISTRYINDEX);
	}
	rb_script_push_functions(L);
	lua_pushcclosure(L, serve_motion, 1);
	script->motion_closure = luaL_ref(L, LUA_REGISTRYINDEX);
	rb_script_push_functions(L);
	lua_pushcclosure(L, serve_follow, 1);
	script->follow_closure = luaL_ref(L, LUA_REGISTRYINDEX);
}

void rb_functions_placed(lua_State *L, int id, bool position, bool orientation)
{
	luaL_getsubtable(L, LUA_REGISTRYINDEX, placed_key);
	lua_pushinteger(L,
	                (position ? PLACED_POSITION : 0) | (orientation ? PLACED_ORIENTATION : 0));
	lua_rawseti(L, -2, id + 1);
	lua_pop(L, 1);
}

/*
 * One protected call of a closure. The world is taken away meanwhile: values may depend on nothing
 * but their arguments, though a callback may be what led here.
 */
static enum rb_status ask(struct rb_script *script, int closure, struct request *request,
                          struct rb_error *err)
{
	lua_State *L = script->sandbox.L;
	struct rb_world *const world = script->world;
	const enum rb_script_phase phase = script->phase;

	script->phase = RB_PHASE_LOOK;
	script->world = NULL;
	lua_rawgeti(L, LUA_REGISTRYINDEX, closure);
	lua_pushlightuserdata(L, request);
	const enum rb_status status = rb_sandbox_call(&script->sandbox, 1, 0,
	                                              script->callback_instructions, err);
	script->phase = phase;
	script->world = world;
	if (status != RB_OK)
		rb_globals_explain(script, err);
	return status;
}

enum rb_status rb_functions_potential(struct rb_script *script, int id, double time_s,
                                      rb_vec3 position, double *energy, struct rb_error *err)
{
	struct request request = {.id = id, .time_s = time_s, .position = position};
	struct rb_error own;
	const enum rb_status status = ask(script, script->potential_closure, &request, &own);

	*energy = request.energy;
	if (status != RB_OK)
		return RB_FAIL(err, status, "%s (potential at t = %.9g s)", own.text, time_s);
	return RB_OK;
}

enum rb_status rb_functions_field(struct rb_script *script, int id, double time_s,
                                  const rb_vec3 at[2], rb_vec3 force[2], struct rb_error *err)
{
	struct request request = {.id = id, .time_s = time_s, .position = at[0], .velocity = at[1]};
	struct rb_error own;
	const enum rb_status status = ask(script, script->field_closure, &request, &own);

	force[0] = request.value[0];
	force[1] = request.value[1];
	if (status != RB_OK)
		return RB_FAIL(err, status, "%s (field at t = %.9g s)", own.text, time_s);
	return RB_OK;
}

/* The error with the body and the time behind it. */
static enum rb_status tell(const struct rb_script *script, int id, double time_s,
                           enum rb_status status, const struct rb_error *own, struct rb_error *err)
{
	const char *call = script->scene->bodies[id].call;
	char label[64];

	rb_scene_body_label(script->scene, id, label);
	return RB_FAIL(err, status, "%s (%s %s%s%s at t = %.9g s)", own->text, call,
	               label[0] == '#' ? "" : "'", label, label[0] == '#' ? "" : "'", time_s);
}

enum rb_status rb_functions_motion(struct rb_script *script, int id, double time_s,
                                   struct rb_driven_pose *pose, struct rb_error *err)
{
	struct request request = {.time_s = time_s, .id = id};
	struct rb_error own;
	const enum rb_status status = ask(script, script->motion_closure, &request, &own);

	RB_ASSERT(pose && id >= 0 && id < script->scene->body_count);
	*pose = request.pose;
	return status == RB_OK ? RB_OK : tell(script, id, time_s, status, &own, err);
}

enum rb_status rb_functions_follow(struct rb_script *script, int joint, double time_s,
                                   double way[2], struct rb_error *err)
{
	struct request request = {.time_s = time_s, .id = joint};
	struct rb_error own;
	char label[96];

	RB_ASSERT(way && joint >= 0 && joint < script->scene->joint_count);
	const enum rb_status status = ask(script, script->follow_closure, &request, &own);
	way[0] = request.way[0];
	way[1] = request.way[1];
	if (status != RB_OK)
		return RB_FAIL(err, status, "%s (motor of %s at t = %.9g s)", own.text,
		               rb_joint_label(script->scene, joint, label), time_s);
	return RB_OK;
}

/* Name of what the scene states beside the motion and differs from it; NULL: nothing. */
static const char *disagreement(const struct rb_body_def *body, const struct request *request)
{
	const struct rb_driven_pose *pose = &request->pose;
	const double size = fmax(rb_vec3_max_abs(body->position), rb_vec3_max_abs(pose->position));
	const rb_vec3 apart = rb_vec3_sub(body->position, pose->position);

	if ((request->placed & PLACED_POSITION) && rb_vec3_max_abs(apart) > agreement * size)
		return "position";
	const rb_quat a = body->orientation, b = pose->orientation;
	const double cosine = fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
	if ((request->placed & PLACED_ORIENTATION) && cosine < 1 - agreement)
		return "orientation";
	return NULL;
}

enum rb_status rb_functions_start(struct rb_script *script, int id, struct rb_error *err)
{
	struct rb_body_def *body = &script->scene->bodies[id];
	struct request request = {.id = id, .starts = true};
	struct rb_error own;
	enum rb_status status = ask(script, script->motion_closure, &request, &own);

	RB_ASSERT(id >= 0 && id < script->scene->body_count);
	RB_ASSERT(rb_body_is_driven(&script->scene->bodies[id]));
	if (status != RB_OK)
		return tell(script, id, 0, status, &own, err);
	const char *what = disagreement(body, &request);
	if (what) {
		status = RB_FAIL(
			&own, RB_ERR_SCENE,
			"%s:%d: its %s and the one that 'motion' returns differ: leave one out",
			script->scene->file, body->line, what);
		return tell(script, id, 0, status, &own, err);
	}
	body->position = request.pose.position;
	body->orientation = request.pose.orientation;
	body->velocity = request.pose.velocity;
	body->angular_velocity = request.pose.angular_velocity;
	body->motion_turns = (request.placed & PLACED_ORIENTATION << 2) != 0;
	body->motion_gives_velocity = request.pose.has_velocity;
	body->motion_gives_angular_velocity = request.pose.has_angular_velocity;
	return RB_OK;
}
