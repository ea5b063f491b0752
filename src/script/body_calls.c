/* SPDX-License-Identifier: MIT */
/*
 * A body's call goes: defaults of its type, the keys of the rows, the shape's solid, what several
 * keys say together, its name, the scene, its forces. Each step notes mistakes and goes on, so that
 * the handle that the scene gets back always stands for a body, and later uses of it do not fail
 * for a second reason.
 */
#include "script/body_calls.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "geom/mass.h"
#include "math/vec3.h"
#include "model/validate.h"
#include "script/fields.h"
#include "script/functions.h"
#include "script/handles.h"
#include "script/shapes.h"
#include "script/values.h"

void rb_name_take(const struct rb_call *call, const char *kind, const char *name)
{
	lua_State *L = call->L;
	char key[64];

	if (!name)
		return;
	if (name[0] == '\0') {
		rb_call_mistake(call, "'name' must not be empty");
		return;
	}
	snprintf(key, sizeof key, RB_NAMES_KEY "%s", kind);
	luaL_getsubtable(L, LUA_REGISTRYINDEX, key);
	if (lua_getfield(L, -1, name) != LUA_TNIL)
		rb_call_mistake(call, "name '%.60s' is taken by the %s of line %d", name, kind,
		                (int)lua_tointeger(L, -1));
	lua_pop(L, 1);
	lua_pushinteger(L, call->line);
	lua_setfield(L, -2, name);
	lua_pop(L, 1);
}

/* ---- forces ---- */

/* Reads one entry of `forces` and adds it to the body that was added last. */
static void add_force(struct rb_call *part)
{
	struct rb_force_def def = rb_force_def_default();
	static const struct rb_row_table *const table = &rb_rows_force;
	struct rb_error err;
	rb_vec3 direction = {0, 0, 0};
	double magnitude = 0;

	rb_call_read(part, &def);
	if (part->index == 0)
		return;
	const bool has_vector = rb_call_tried(part, "vector");
	const bool has_torque = rb_call_tried(part, "torque");
	const bool has_direction = rb_call_push(part, "direction") != LUA_TNIL;
	const bool has_magnitude = rb_call_push(part, "magnitude") != LUA_TNIL;
	const bool both = has_direction && has_magnitude,
		   neither = !has_direction && !has_magnitude;
	if (has_vector ? !neither : !both && !(has_torque && neither)) {
		rb_call_mistake(part,
		                has_vector ? "'vector' excludes 'direction' and 'magnitude'"
		                           : "needs 'vector', or 'direction' and 'magnitude', or "
		                             "'torque'");
	} else if (both) {
		const bool right = rb_call_value(part, rb_row_find(table, "direction", NULL), -2,
		                                 &direction);
		if (rb_call_value(part, rb_row_find(table, "magnitude", NULL), -1, &magnitude) &&
		    right)
			def.vector = rb_vec3_scale(magnitude, rb_vec3_unit(direction, direction));
	}
	lua_pop(part->L, 2);
	rb_sandbox_charge_bytes(part->L, sizeof def);
	rb_script_need(part->L, rb_scene_add_force(part->script->scene, &def, &err), &err);
}

/* Reads `forces`. `is_fixed`: nothing pushes the body. */
static void add_forces(struct rb_call *call, bool is_fixed)
{
	lua_State *L = call->L;
	char found[80];

	if (rb_call_push(call, "forces") == LUA_TNIL) {
		lua_pop(L, 1);
		return;
	}
	const int list = lua_gettop(L);
	const long long count = rb_list_length(L, list);
	if (count < 0) {
		rb_call_mistake(
			call, "'forces' must be a list of tables {{vector = {...}}, ...} (got %s)",
			rb_describe(L, list, found));
	} else {
		if (is_fixed && count > 0 && !rb_call_given(call, "motion"))
			rb_call_mistake(call, "'forces' of a static body: it never moves");
		for (long long i = 1; i <= count; i++) {
			lua_rawgeti(L, list, i);
			struct rb_call part = rb_call_part(call, &rb_rows_force, -1, (int)i);
			add_force(&part);
			lua_pop(L, 1);
		}
	}
	lua_settop(L, list - 1);
}

/* ---- particles ---- */

/*
 * Whether a key that a particle must have was given; notes it as missing, unless another key is
 * misspelt, which may be this one.
 */
static bool has_key(struct rb_call *part, const char *key)
{
	if (part->index > 0 && !part->unknown && !rb_call_tried(part, key))
		rb_call_mistake(part, "'%s' is missing", key);
	return rb_call_given(part, key);
}

/* Reads the list below the top of the stack; false: a mistake was noted. */
static bool read_list(struct rb_call *call, struct rb_particle *particles, size_t count)
{
	bool right = true;

	for (size_t i = 0; i < count; i++) {
		lua_rawgeti(call->L, -2, (lua_Integer)i + 1);
		struct rb_call part = rb_call_part(call, &rb_rows_particle, -1, (int)i + 1);
		rb_call_read(&part, &particles[i]);
		const bool has_mass = has_key(&part, "mass");
		right = has_key(&part, "position") && has_mass && right;
		lua_pop(call->L, 1);
	}
	return right;
}

/* Takes mass, centre and inertia from `particles`, if there are any. */
static void read_particles(struct rb_call *call, struct rb_body_given *given)
{
	struct rb_body_def *const def = &given->def;
	static const char *const others[] = {"mass", "density", "center_of_mass", "inertia"};
	lua_State *L = call->L;
	const int top = lua_gettop(L);
	char found[80];

	if (rb_call_push(call, "particles") == LUA_TNIL) {
		lua_settop(L, top);
		return;
	}
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (rb_call_tried(call, others[i]))
			rb_call_mistake(call, "'particles' and '%s' exclude each other", others[i]);
	const long long listed = rb_list_length(L, -1);
	if (listed <= 0) {
		rb_call_mistake(call,
		                "'particles' must be a list of tables {{mass = ..., position = "
		                "{...}}, ...} (got %s)",
		                rb_describe(L, -1, found));
		lua_settop(L, top);
		return;
	}
	const size_t count = (size_t)listed;
	struct rb_particle *const particles = lua_newuserdatauv(L, count * sizeof *particles, 0);
	if (read_list(call, particles, count) && rb_body_is_free(def)) {
		const struct rb_particles all = rb_particles_measure(particles, count);

		def->mass = all.mass;
		given->inertia = all.inertia;
		def->inertia = &given->inertia;
		def->particle_count = count;
		/* at the shape's own centroid where only the rounding of sums says otherwise */
		if (rb_vec3_max_abs(rb_vec3_sub(all.center, def->center_of_mass)) >
		    all.center_error)
			def->center_of_mass = all.center;
	}
	lua_settop(L, top);
}

/* ---- groups ---- */

/*
 * The number of the group named by the value on top of the stack, which is taken off; -1: a mistake
 * was noted.
 */
static int group_of(struct rb_call *call, const char *key)
{
	struct rb_error err;
	char found[80];
	int group = -1;

	if (lua_type(call->L, -1) != LUA_TSTRING || lua_rawlen(call->L, -1) == 0) {
		rb_call_mistake(call, "'%s' must be the name of a group (got %s)", key,
		                rb_describe(call->L, -1, found));
	} else {
		const enum rb_status status = rb_scene_group(
			call->script->scene, lua_tostring(call->L, -1), &group, &err);
		if (status == RB_ERR_MEMORY)
			rb_script_need(call->L, status, &err);
		if (status != RB_OK) {
			rb_call_mistake(call, "'%s': %s", key, err.text);
			group = -1;
		}
	}
	lua_pop(call->L, 1);
	return group;
}

/* Reads `group` and `collides_with`. */
static void read_groups(struct rb_call *call, struct rb_body_def *def)
{
	lua_State *L = call->L;
	char found[80];

	if (rb_call_push(call, "group") != LUA_TNIL)
		def->group = group_of(call, "group");
	else
		lua_pop(L, 1);

	const int type = rb_call_push(call, "collides_with");
	if (type == LUA_TNIL) {
		lua_pop(L, 1);
		return;
	}
	def->filters = true;
	if (type == LUA_TSTRING) {
		const int group = group_of(call, "collides_with");
		if (group >= 0)
			def->collides_with = (uint64_t)1 << group;
		return;
	}
	const long long count = rb_list_length(L, -1);
	if (count < 0) {
		rb_call_mistake(call, "'collides_with' must be a list of names of groups (got %s)",
		                rb_describe(L, -1, found));
		lua_pop(L, 1);
		return;
	}
	for (long long i = 1; i <= count; i++) {
		lua_rawgeti(L, -1, i);
		const int group = group_of(call, "collides_with");
		if (group >= 0)
			def->collides_with |= (uint64_t)1 << group;
	}
	lua_pop(L, 1);
}

/* ---- bodies ---- */

/* Notes keys that say what pushes would do, of a body that is not pushed. */
static void check_driven(const struct rb_call *call, const struct rb_body_def *def)
{
	static const char *const pushed[] = {"mass",    "density",   "center_of_mass",
	                                     "inertia", "particles", "forces"};
	static const char *const moved[] = {"velocity", "angular_velocity"};

	if (def->is_static)
		rb_call_mistake(call, "'motion' of a static body: it never moves");
	for (size_t i = 0; i < sizeof pushed / sizeof *pushed; i++)
		if (rb_call_tried(call, pushed[i]))
			rb_call_mistake(call, "'%s' of a driven body: nothing pushes it",
			                pushed[i]);
	for (size_t i = 0; i < sizeof moved / sizeof *moved; i++)
		if (rb_call_tried(call, moved[i]))
			rb_call_mistake(call, "'%s' of a driven body: 'motion' says how it moves",
			                moved[i]);
}

/* Notes what no single key can tell. */
static void check_body(const struct rb_call *call, const struct rb_body_def *def)
{
	if (rb_call_tried(call, "mass") && rb_call_tried(call, "density"))
		rb_call_mistake(call, "'mass' and 'density' exclude each other");
	if (rb_body_is_driven(def))
		check_driven(call, def);
	if (!def->is_static)
		return;
	if (rb_vec3_max_abs(def->velocity) > 0)
		rb_call_mistake(call, "'velocity' of a static body: it never moves");
	if (rb_vec3_max_abs(def->angular_velocity) > 0)
		rb_call_mistake(call, "'angular_velocity' of a static body: it never moves");
}

/* Completes a body's call after its shape: adds the body and pushes its handle. */
static int finish_body(struct rb_call *call, struct rb_body_given *given)
{
	struct rb_body_def *const def = &given->def;
	struct rb_error err;
	int id;

	def->line = call->line;
	def->inertia = rb_call_given(call, "inertia") ? &given->inertia : NULL;
	read_particles(call, given);
	check_body(call, def);
	read_groups(call, def);
	rb_name_take(call, "body", def->name);
	rb_sandbox_charge_body(call->L, sizeof *def + (def->name ? strlen(def->name) : 0));
	rb_script_need(call->L, rb_scene_add_body(call->script->scene, def, &id, &err), &err);
	add_forces(call, def->is_static || rb_body_is_driven(def));
	if (rb_body_is_driven(def))
		rb_functions_placed(call->L, id,
		                    rb_call_given(call, "position") || rb_call_given(call, "point"),
		                    rb_call_given(call, "orientation") ||
		                            rb_call_given(call, "normal") ||
		                            rb_call_given(call, "axis"));
	rb_handle_push(call->L, id);
	return 1;
}

/*
 * Adds a body that stands for one that cannot be had, so that loading goes on; pushes its handle.
 */
static int stand_in(lua_State *L, const struct rb_call *call)
{
	struct rb_body_def def = rb_body_def_default();
	struct rb_error err;
	int id;

	def.shape.radius = 1;
	def.line = call->line;
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_body(call->script->scene, &def, &id, &err), &err);
	rb_handle_push(L, id);
	return 1;
}

/* Reads a key of planes that has no place in the definition; false: not given, or wrong. */
static bool read_vector(struct rb_call *call, const char *key, rb_vec3 *value)
{
	const bool given = rb_call_push(call, key) != LUA_TNIL;
	const bool right = given &&
	                   rb_call_value(call, rb_row_find(&rb_rows_plane, key, NULL), -1, value);

	lua_pop(call->L, 1);
	return right;
}

/* Sets position and orientation of a plane from its point, normal and axis. */
static void place_plane(struct rb_call *call, struct rb_body_def *def)
{
	rb_vec3 normal = {0, 0, 1};
	rb_vec3 axis = {(double)NAN, (double)NAN, (double)NAN};
	const bool has_normal = read_vector(call, "normal", &normal);
	const bool has_axis = read_vector(call, "axis", &axis);

	if (rb_call_tried(call, "normal") && rb_call_tried(call, "orientation"))
		rb_call_mistake(call, "'normal' and 'orientation' exclude each other");
	if (rb_call_tried(call, "point") && rb_call_tried(call, "position"))
		rb_call_mistake(call, "'point' and 'position' exclude each other");
	if (rb_call_tried(call, "axis") && !rb_call_tried(call, "size"))
		rb_call_mistake(call, "'axis' goes with 'size': an infinite plane has no sides");
	if (rb_call_tried(call, "axis") && rb_call_tried(call, "orientation"))
		rb_call_mistake(call, "'axis' and 'orientation' exclude each other");
	read_vector(call, "point", &def->position);
	if (rb_call_tried(call, "orientation"))
		return;
	if (has_axis) {
		const rb_vec3 across = rb_vec3_cross(rb_vec3_unit(normal, normal),
		                                     rb_vec3_unit(axis, axis));
		if (rb_vec3_length(across) < 1e-9) {
			rb_call_mistake(
				call,
				"'axis' must not be along the normal (got {%.12g, %.12g, %.12g})",
				axis.x, axis.y, axis.z);
			return;
		}
	}
	if (has_normal || has_axis)
		def->orientation = rb_plane_orientation(normal, axis);
}

static int l_plane(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "plane", &rb_rows_plane, 1);
	struct rb_body_given given = {.def = rb_body_def_default()};
	struct rb_body_def *const def = &given.def;

	def->call = "plane";
	def->shape = (struct rb_shape){.kind = RB_SHAPE_PLANE};
	def->is_static = true;
	rb_call_read(&call, &given);
	if (rb_call_given(&call, "size"))
		def->shape.kind = RB_SHAPE_RECTANGLE;
	const bool driven = rb_call_tried(&call, "motion");
	if (driven && !rb_call_tried(&call, "static"))
		def->is_static = false;
	if (!driven && !def->is_static) {
		rb_call_mistake(&call,
		                "'static' = false: %s has no mass, so that nothing can push it "
		                "('motion' says how it moves)",
		                def->shape.kind == RB_SHAPE_RECTANGLE ? "a plane without thickness"
		                                                      : "an infinite plane");
		def->is_static = true;
	}
	place_plane(&call, def);
	return finish_body(&call, &given);
}

/* The call of a body with a volume. */
static int add_shape(lua_State *L, const char *word, enum rb_shape_kind kind)
{
	const struct rb_shape_type *const type = rb_shape_types[kind];
	const struct rb_row_table table = rb_rows_shape(type);
	struct rb_call call = rb_call_begin(L, word, &table, 1);
	struct rb_body_given given = {.def = rb_body_def_default()};
	struct rb_body_def *const def = &given.def;

	RB_ASSERT(kind < RB_SHAPE_KIND_COUNT);
	def->call = word;
	def->shape = (struct rb_shape){.kind = kind, .solid = -1};
	def->is_static = kind == RB_SHAPE_TERRAIN;
	rb_call_read(&call, &given);
	if (kind == RB_SHAPE_TERRAIN) {
		if (!def->is_static)
			rb_call_mistake(&call, "'static' = false: a terrain has no mass, so that "
			                       "nothing can push it");
		if (rb_call_tried(&call, "motion"))
			rb_call_mistake(&call, "'motion': a terrain stays where it is");
		def->is_static = true;
	}
	if (!def->texture && !call.script->scene->materials[def->material].texture)
		def->texture = type->texture;
	if (kind == RB_SHAPE_UNION)
		rb_shapes_union(&call, def);
	else
		rb_shapes_sized(&call, def);
	return finish_body(&call, &given);
}

/* The call of a type whose keys are in its row; upvalue: the kind. */
static int l_shape(lua_State *L)
{
	const enum rb_shape_kind kind = (enum rb_shape_kind)lua_tointeger(L, lua_upvalueindex(1));

	return add_shape(L, rb_shape_types[kind]->name, kind);
}

/* body "NAME" is a body that there is, at any time; body { ... } makes a union. */
static int l_body(lua_State *L)
{
	const bool named = lua_type(L, 1) == LUA_TSTRING;
	const char *name = named ? lua_tostring(L, 1) : NULL;
	char hint[96] = "", found[80];
	const int id = named ? rb_body_named(L, name, hint) : -1;

	if (id >= 0) {
		rb_handle_push(L, id);
		return 1;
	}
	if (lua_type(L, 1) == LUA_TTABLE)
		return add_shape(L, "body", RB_SHAPE_UNION);
	if (named && rb_script_of(L)->phase != RB_PHASE_LOAD)
		return luaL_error(L, "body: no body is named '%s'%s", name, hint);
	struct rb_call call = rb_call_begin(L, "body", NULL, 0);
	if (named)
		rb_call_mistake(&call, "no body is named '%.60s' so far%s", name, hint);
	else
		rb_call_mistake(&call, "expected the name of a body or a table of keys (got %s)",
		                rb_describe(L, 1, found));
	return stand_in(L, &call);
}

void rb_bodies_open(lua_State *L)
{
	lua_register(L, "body", l_body);
	lua_register(L, "plane", l_plane);
	for (int kind = 0; kind < RB_SHAPE_KIND_COUNT; kind++) {
		if (rb_shape_types[kind]->key_count == 0 || kind == RB_SHAPE_UNION)
			continue;
		lua_pushinteger(L, kind);
		lua_pushcclosure(L, l_shape, 1);
		lua_setglobal(L, rb_shape_types[kind]->name);
	}
}
