/* SPDX-License-Identifier: MIT */
#include "script/shapes.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "geom/meshfile.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/validate.h"
#include "script/assets.h"
#include "script/fields.h"
#include "script/meshes.h"
#include "script/values.h"
#include "script/vector.h"

/*
 * What Qhull does with a point, as instructions of Lua: 65,536 on a ball take it about half a
 * second.
 */
enum { WORK_A_POINT = 500 };

/* Stands for a shape that is wrong, so that what depends on the body can still be checked. */
static const struct rb_shape stand_in = {.kind = RB_SHAPE_SPHERE, .solid = -1, .radius = 1};

/*
 * Whether all keys of a type were given and right; notes those that are missing. False: a mistake
 * was noted, here or before.
 */
static bool has_keys(struct rb_call *call, const struct rb_shape_type *type)
{
	bool all = true;

	for (int k = 0; k < type->key_count; k++) {
		const char *key = type->key[k].key;

		if (strcmp(type->key[k].fallback, "required") != 0)
			continue;
		all = all && (rb_call_given(call, key) || call->index == 0);
		/* where a key is misspelt it may be this one: one message is enough */
		if (call->index && !call->unknown && !rb_call_tried(call, key))
			rb_call_mistake(call, "'%s' is missing", key);
	}
	return all && call->index;
}

/* ---- hulls ---- */

/*
 * Reads the points of the list at `list` into memory that Lua owns, which is left on the stack: an
 * error in between may then jump. False: a mistake was noted.
 */
static bool read_points(struct rb_call *call, int list, rb_vec3 **points, size_t *count)
{
	lua_State *L = call->L;
	char found[80];

	lua_pushnil(L); /* in place of the memory, where there is none */
	const long long listed = rb_list_length(L, list);
	if (listed < 0) {
		rb_call_mistake(call, "'points' must be a list of points {{x, y, z}, ...} (got %s)",
		                rb_describe(L, list, found));
		return false;
	}
	*count = (size_t)listed;
	if (*count > RB_HULL_POINTS_MAX) {
		rb_call_mistake(call, "'points': %zu points are too many (wanted at most %d)",
		                *count, RB_HULL_POINTS_MAX);
		return false;
	}
	rb_sandbox_charge(L, *count * WORK_A_POINT);
	lua_pop(L, 1);
	*points = lua_newuserdatauv(L, *count * sizeof **points + 1, 0);
	for (size_t i = 0; i < *count; i++) {
		double p[3];

		lua_rawgeti(L, list, (lua_Integer)i + 1);
		if (!rb_vector_numbers(L, -1, 3, p, NULL)) {
			rb_call_mistake(
				call, "'points' must be a list of points {x, y, z} (got %s at %zu)",
				rb_describe(L, -1, found), i + 1);
			lua_pop(L, 1);
			return false;
		}
		(*points)[i] = rb_vec3_from(p);
		lua_pop(L, 1);
	}
	return true;
}

/* Bytes that a solid takes, for the script's memory budget. */
static size_t bytes_of(const struct rb_solid *solid)
{
	const size_t loops = solid->face_count > 0 ? (size_t)solid->face_first[solid->face_count]
	                                           : 0;

	return sizeof *solid + (size_t)solid->vertex_count * sizeof *solid->vertices +
	       (loops + (size_t)solid->face_count + 1) * sizeof(int) +
	       (size_t)solid->edge_count * sizeof *solid->edges +
	       (size_t)solid->part_count * sizeof *solid->parts;
}

/*
 * A status of the scene's as what it is: RB_ERR_SCENE becomes a mistake (false), everything else
 * ends the loading.
 */
static bool take(struct rb_call *call, const char *key, enum rb_status status,
                 const struct rb_error *err)
{
	if (status == RB_ERR_SCENE) {
		rb_call_mistake(call, "'%s': %s", key, err->text);
		return false;
	}
	rb_script_need(call->L, status, err);
	return true;
}

/* The same for the file that the call names at `text`, with its scale. */
static bool read_file(struct rb_call *call, int text, rb_vec3 **points, size_t *count)
{
	lua_State *L = call->L;
	enum rb_meshfile_kind kind;
	struct rb_error err;
	double scale;

	const struct rb_source_file *const file = rb_mesh_file(call, text, &kind, &scale);
	if (!file)
		return false;
	const char *const name = lua_tostring(L, text);
	const size_t corners_max = rb_meshfile_corners_max(kind, file->size_bytes);
	rb_sandbox_charge(L, 20 * corners_max); /* their sorting */
	*points = lua_newuserdatauv(L, corners_max * sizeof **points, 0);
	if (rb_meshfile_read(kind, file->text, file->size_bytes, *points, count, &err)) {
		rb_call_mistake(call, "'file': '%s': %s", name, err.text);
		return false;
	}
	if (*count > RB_HULL_POINTS_MAX) {
		rb_call_mistake(call, "'file': '%s' has %zu corners (wanted at most %d)", name,
		                *count, RB_HULL_POINTS_MAX);
		return false;
	}
	rb_sandbox_charge(L, *count * WORK_A_POINT);
	for (size_t i = 0; i < *count; i++)
		(*points)[i] = rb_vec3_scale(scale, (*points)[i]);
	return true;
}

/* Reads the points of a hull, left on the stack, by whichever key; false: a mistake was noted. */
static bool read_either(struct rb_call *call, rb_vec3 **points, size_t *count)
{
	const bool listed = rb_call_tried(call, "points"), named = rb_call_tried(call, "file");

	if (listed && named) {
		rb_call_mistake(call, "'points' and 'file' exclude each other");
		return false;
	}
	if (!listed && !named) {
		if (!call->unknown && call->index)
			rb_call_mistake(call, "'points' or 'file' is missing");
		return false;
	}
	if (listed && rb_call_tried(call, "scale")) {
		rb_call_mistake(call, "'scale' is of a 'file'");
		return false;
	}
	rb_call_push(call, named ? "file" : "points");
	return named ? read_file(call, lua_gettop(call->L), points, count)
	             : read_points(call, lua_gettop(call->L), points, count);
}

/* Makes the hull of the points that the call was given; false: a mistake was noted. */
static bool read_hull(struct rb_call *call, struct rb_shape *shape)
{
	struct rb_scene *scene = call->script->scene;
	const int top = lua_gettop(call->L);
	struct rb_error err;
	rb_vec3 *points;
	size_t count;
	bool right = false;

	if (read_either(call, &points, &count)) {
		const enum rb_status status = rb_scene_add_hull(scene, points, count, &shape->solid,
		                                                &err);
		right = take(call, rb_call_tried(call, "file") ? "file" : "points", status, &err);
	}
	lua_settop(call->L, top);
	return right;
}

/*
 * Sets the centre of mass of a body that is pushed to the solid's centroid, if the scene does not
 * state one; of others the origin stays, which nothing uses.
 */
static void center(const struct rb_call *call, struct rb_body_def *def)
{
	if (rb_body_is_free(def) && !rb_call_tried(call, "center_of_mass"))
		def->center_of_mass = call->script->scene->solids[def->shape.solid].centroid;
}

/* ---- solids ---- */

/* Puts what the shape is made of into the scene; false: a mistake was noted. */
static bool make_solid(struct rb_call *call, struct rb_shape *shape)
{
	struct rb_scene *scene = call->script->scene;
	const struct rb_shape_type *const type = rb_shape_type(shape);
	const int before = scene->solid_count;
	char text[RB_SHAPE_FAULT_SIZE];
	struct rb_error err;

	if (shape->kind == RB_SHAPE_HULL || shape->kind == RB_SHAPE_TERRAIN) {
		const bool right = shape->kind == RB_SHAPE_HULL ? read_hull(call, shape)
		                                                : rb_terrain_read(call, shape);
		if (scene->solid_count > before)
			rb_sandbox_charge_bytes(call->L, bytes_of(&scene->solids[before]));
		return right;
	}
	if (!type->make)
		return true;
	if (type->fault && type->fault(shape, text)) {
		rb_call_mistake(call, "%s", text);
		return false;
	}
	const enum rb_status status = type->make(scene, shape, &err);
	if (status == RB_ERR_SCENE) {
		rb_call_mistake(call, "%s", err.text);
		return false;
	}
	rb_script_need(call->L, status, &err);
	if (scene->solid_count > before)
		rb_sandbox_charge_bytes(call->L, bytes_of(&scene->solids[before]));
	return true;
}

void rb_shapes_sized(struct rb_call *call, struct rb_body_def *def)
{
	if (!has_keys(call, rb_shape_type(&def->shape)) || !make_solid(call, &def->shape))
		def->shape = stand_in;
	else if (rb_shape_solid(&def->shape) >= 0)
		center(call, def);
}

/* ---- unions ---- */

/* Notes sizes that the part's type does not have. */
static void check_part(struct rb_call *call, const struct rb_shape_type *type)
{
	for (int i = 1; i < call->table->count; i++) { /* 0 is `shape` */
		const char *const key = call->table->rows[i].key;
		bool own = false;

		for (int k = 0; k < type->key_count; k++)
			own = own || strcmp(type->key[k].key, key) == 0;
		if (!own && rb_call_tried(call, key))
			rb_call_mistake(call, "'%s' of a %s: it has none", key, type->name);
	}
}

/* The k-th type of those that may be parts, as their names are counted in `shape`. */
static enum rb_shape_kind part_kind(int k)
{
	int kind = 0;

	RB_ASSERT(k >= 0);
	for (;; kind++)
		if (rb_shape_types[kind]->is_part && k-- == 0)
			return (enum rb_shape_kind)kind;
}

/*
 * Reads one entry of `shapes`, with the rows of bodies. `density` is that of the body, kg/m^3: a
 * part's share is relative to it. False: a mistake was noted.
 */
static bool read_part(struct rb_call *call, double density, struct rb_solid_part *part)
{
	struct rb_body_def def = rb_body_def_default();
	int place = -1;

	def.shape.radius = 0;
	*part = (struct rb_solid_part){.shape = stand_in, .orientation = {1, 0, 0, 0}, .share = 1};
	rb_call_read(call, &def);
	if (call->index == 0)
		return false;
	if (rb_call_push(call, "shape") != LUA_TNIL)
		(void)rb_call_value(call, rb_row_find(call->table, "shape", NULL), -1, &place);
	else if (!call->unknown)
		rb_call_mistake(call, "'shape' is missing");
	lua_pop(call->L, 1);
	if (place < 0)
		return false;
	def.shape.kind = part_kind(place);
	check_part(call, rb_shape_type(&def.shape));
	if (!has_keys(call, rb_shape_type(&def.shape)) || !make_solid(call, &def.shape))
		return false;
	part->shape = def.shape;
	part->position = def.position;
	part->orientation = def.orientation;
	if (!isnan(def.density))
		part->share = def.density / density;
	return true;
}

/*
 * Reads the list on top of the stack into memory that Lua owns, which is left there; NULL: a
 * mistake was noted.
 */
static struct rb_solid_part *read_parts(struct rb_call *call, double density, size_t *count)
{
	lua_State *L = call->L;
	const int list = lua_gettop(L);
	struct rb_part_rows rows;
	char found[80];
	bool right = true;

	const long long listed = rb_list_length(L, list);
	*count = listed > 0 ? (size_t)listed : 0;
	if (*count == 0 || *count > RB_UNION_PARTS_MAX) {
		rb_call_mistake(call,
		                "'shapes' must be a list of 1 to %d tables {{shape = 'box', size = "
		                "{...}}, ...} (got %s)",
		                RB_UNION_PARTS_MAX, rb_describe(L, list, found));
		return NULL;
	}
	rb_rows_part(&rows);
	struct rb_solid_part *parts = lua_newuserdatauv(L, *count * sizeof *parts, 0);
	for (size_t i = 0; i < *count; i++) {
		lua_rawgeti(L, list, (lua_Integer)i + 1);
		struct rb_call part = rb_call_part(call, &rows.table, -1, (int)i + 1);
		right = read_part(&part, density, &parts[i]) && right;
		lua_pop(L, 1);
	}
	return right ? parts : NULL;
}

void rb_shapes_union(struct rb_call *call, struct rb_body_def *def)
{
	struct rb_scene *scene = call->script->scene;
	const double density = isnan(def->density) ? scene->materials[def->material].density
	                                           : def->density;
	const int top = lua_gettop(call->L);
	struct rb_error err;
	size_t count;

	def->shape = stand_in;
	if (call->index == 0)
		return;
	if (rb_call_push(call, "shapes") == LUA_TNIL) {
		if (!call->unknown)
			rb_call_mistake(call, "'shapes' is missing");
		lua_settop(call->L, top);
		return;
	}
	const struct rb_solid_part *parts = read_parts(call, density, &count);
	if (parts) {
		struct rb_shape shape = {.kind = RB_SHAPE_UNION};
		const enum rb_status status = rb_scene_add_union(scene, parts, count, &shape.solid,
		                                                 &err);
		if (take(call, "shapes", status, &err)) {
			def->shape = shape;
			center(call, def);
			rb_sandbox_charge_bytes(call->L, bytes_of(&scene->solids[shape.solid]));
		}
	}
	lua_settop(call->L, top);
}
