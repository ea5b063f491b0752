/* SPDX-License-Identifier: MIT */
/*
 * The keys of joint { } are one table (script/rows); which of them a kind of joint has, and which
 * it must have, is another one (rb_joint_keys). A key that does not apply is refused by name,
 * because a scene that sets it expects an effect. What needs the geometry of the start is for
 * model/joints, once all bodies are placed.
 */
#include "script/joint_calls.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "model/joint_type.h"
#include "script/body_calls.h"
#include "script/fields.h"
#include "script/joint_handles.h"
#include "script/values.h"

/* ---- the call ---- */

/* Notes keys that a kind does not have, and those that are missing. */
static void check_keys(const struct rb_call *call, const struct rb_joint_def *def)
{
	char kinds[RB_JOINT_KINDS_SIZE];

	for (int k = 0; k < rb_joint_key_count; k++) {
		const struct rb_joint_key *const rule = &rb_joint_keys[k];
		const char *const key = rule->key;
		const bool has = rule->has(def->kind);

		if (rb_call_tried(call, key) && !has) {
			const int count = rb_joint_list_kinds(rule->has, " and ", kinds);

			rb_call_mistake(call, "'%s': a joint of kind '%s' has none (%s: %s)", key,
			                rb_joint_kind_name(def->kind),
			                count > 1 ? "kinds that have it" : "the kind that has it",
			                kinds);
		}
		if (!rb_call_tried(call, key) && has && rule->needed && !call->unknown)
			rb_call_mistake(call, "'%s' is missing: a joint of kind '%s' needs it", key,
			                rb_joint_kind_name(def->kind));
	}
}

/* Notes what is wrong with its bodies; one that is misspelt is not missed. */
static void check_bodies(const struct rb_call *call, const struct rb_joint_def *def)
{
	if (!rb_call_given(call, "a") || (!rb_call_given(call, "b") && rb_call_tried(call, "b")))
		return;

	const struct rb_scene *scene = call->script->scene;
	const bool a_free = rb_body_is_free(&scene->bodies[def->a]);
	const bool b_free = def->b >= 0 && rb_body_is_free(&scene->bodies[def->b]);

	if (def->a == def->b)
		rb_call_mistake(call, "'a' and 'b' are the same body");
	else if (!a_free && !b_free && !call->unknown)
		rb_call_mistake(call,
		                "nothing can move either end: 'a' or 'b' must be a body that is "
		                "neither static nor driven");
}

/* Notes what is wrong with its points. */
static void check_points(const struct rb_call *call, const struct rb_joint_def *def)
{
	const bool at = rb_call_tried(call, "at"), at_a = rb_call_tried(call, "at_a"),
		   at_b = rb_call_tried(call, "at_b");

	if (rb_joint_is_line(def->kind)) {
		if (def->b < 0 && !at_b && !rb_call_tried(call, "b") && !call->unknown)
			rb_call_mistake(
				call,
				"'at_b' is missing: the end of a %s in the world, which has "
				"no centre of mass (or is 'b' missing?)",
				rb_joint_kind_name(def->kind));
		return;
	}
	if (!at && !at_a && !at_b && !rb_joint_type(def->kind)->is_centered && !call->unknown)
		rb_call_mistake(call, "'at' is missing: the point that 'a' and 'b' share (or "
		                      "'at_a' or 'at_b')");
}

/* Axes of both bodies: at right angles, to the rounding of what a scene computes. */
static void check_axes(const struct rb_call *call, const struct rb_joint_def *def)
{
	if (!rb_joint_type(def->kind)->has_axis_b || !rb_call_given(call, "axis") ||
	    !rb_call_given(call, "axis_b"))
		return;
	const double cosine = rb_vec3_dot(rb_vec3_unit(def->axis, def->axis),
	                                  rb_vec3_unit(def->axis_b, def->axis_b));
	if (!(fabs(cosine) <= 1e-9))
		rb_call_mistake(
			call,
			"'axis_b' must be at right angles to 'axis', to 1e-9 (got an angle of "
			"%.12g rad)",
			acos(fmin(1, fmax(-1, cosine))));
}

/* Reads `limits`: two numbers, of which one may be infinite. */
static void read_limits(struct rb_call *call, struct rb_joint_def *def)
{
	lua_State *L = call->L;
	const int top = lua_gettop(L);
	double limit[2] = {0, 0};
	char found[80];
	bool right = true;

	if (rb_call_push(call, "limits") == LUA_TNIL) {
		lua_settop(L, top);
		return;
	}
	right = rb_list_length(L, -1) == 2;
	for (int k = 0; right && k < 2; k++) {
		right = lua_rawgeti(L, top + 1, k + 1) == LUA_TNUMBER;
		limit[k] = right ? lua_tonumber(L, -1) : 0;
		right = right && !isnan(limit[k]);
		lua_pop(L, 1);
	}
	if (!right)
		rb_call_mistake(call, "'limits' must be {low, high} (got %s)",
		                rb_describe(L, top + 1, found));
	else if (!(limit[0] <= 0 && limit[1] >= 0))
		rb_call_mistake(
			call,
			"'limits' must have low <= 0 <= high, since the %s is 0 at the start "
			"(got {%.12g, %.12g})",
			rb_joint_way_name(def->kind), limit[0], limit[1]);
	else if (!(limit[0] < limit[1]))
		rb_call_mistake(call,
		                "'limits' {0, 0} leave nothing free (a fixed joint does that)");
	else
		for (int k = 0; k < 2; k++)
			def->limits[k] = isinf(limit[k]) ? (double)NAN : limit[k];
	lua_settop(L, top);
}

/* Notes keys of a motor that are of another kind of joint; whether all are right. */
static bool check_motor(const struct rb_call *part, const struct rb_joint_def *def)
{
	const char *const way = rb_joint_way_name(def->kind), *const max = rb_joint_max_name(
								      def->kind);
	const bool turns = rb_joint_type(def->kind)->linkage.coordinate == RB_COORDINATE_ANGLE;
	const struct rb_coordinate_words *const other =
		&rb_coordinate_words[turns ? RB_COORDINATE_WAY : RB_COORDINATE_ANGLE];
	const char *const other_way = other->name, *const other_max = other->load;
	const bool wrong_way = rb_call_tried(part, other_way),
		   wrong_max = rb_call_tried(part, other_max);
	const bool has_speed = rb_call_tried(part, "speed"), has_way = rb_call_tried(part, way);
	const char *const kind = rb_joint_kind_name(def->kind);

	if (wrong_way)
		rb_call_mistake(part, "'%s': a joint of kind '%s' has '%s'", other_way, kind, way);
	if (wrong_max)
		rb_call_mistake(part, "'%s': a joint of kind '%s' has '%s'", other_max, kind, max);
	if (has_speed && has_way)
		rb_call_mistake(part, "'speed' and '%s' exclude each other", way);
	if (!has_speed && !has_way && !wrong_way && !part->unknown)
		rb_call_mistake(part, "wants 'speed' or '%s'", way);
	if (!rb_call_tried(part, max) && !wrong_max && !part->unknown)
		rb_call_mistake(part, "'%s' is missing: the most that the motor exerts", max);
	return !wrong_way && !wrong_max && !(has_speed && has_way);
}

/* Reads `motor`. */
static void read_motor(struct rb_call *call, struct rb_joint_def *def)
{
	lua_State *L = call->L;

	if (rb_call_push(call, "motor") != LUA_TNIL) {
		struct rb_call part = rb_call_part(call, &rb_rows_motor, -1, 0);

		rb_call_read(&part, def);
		if (part.index > 0)
			check_motor(&part, def);
	}
	lua_pop(L, 1);
}

static int l_joint(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "joint", &rb_rows_joint, 1);
	struct rb_joint_def def = rb_joint_def_default();
	struct rb_error err;
	int index;

	def.line = call.line;
	rb_call_read(&call, &def);
	rb_name_take(&call, "joint", def.name);
	const bool has_kind = rb_call_given(&call, "kind");
	if (call.index > 0 && !call.unknown && !rb_call_tried(&call, "kind"))
		rb_call_mistake(&call, "'kind' is missing (one of %s)", RB_JOINT_KIND_NAMES);
	if (call.index > 0 && !call.unknown && !rb_call_tried(&call, "a"))
		rb_call_mistake(&call, "'a' is missing");
	check_bodies(&call, &def);
	if (has_kind) {
		check_keys(&call, &def);
		check_points(&call, &def);
		check_axes(&call, &def);
		if (rb_joint_is_free(def.kind)) {
			read_limits(&call, &def);
			read_motor(&call, &def);
		}
	}
	rb_sandbox_charge_bytes(L, sizeof def + (def.name ? strlen(def.name) : 0));
	/* one with mistakes too, so that the scene has a handle to go on with */
	rb_script_need(L, rb_scene_add_joint(call.script->scene, &def, &index, &err), &err);
	rb_joint_handle_push(L, index);
	return 1;
}

void rb_joints_open(lua_State *L)
{
	lua_register(L, "joint", l_joint);
}
