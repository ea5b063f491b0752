/* SPDX-License-Identifier: MIT */
/* Memory for points and triangles is Lua's: a height that raises an error may then jump. */
#include "script/meshes.h"

#include <math.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/vec3.h"
#include "script/assets.h"
#include "script/fields.h"
#include "script/values.h"

/*
 * What finding neighbours and the tree of boxes does with a triangle, as instructions of Lua; bytes
 * that a facet takes in the model, a polytope of its own (65,522 triangles: 190 MB measured).
 */
enum { WORK_A_TRIANGLE = 200, BYTES_A_TRIANGLE = 2900 };

/* Any bytes: they are checked when they are read. */
static bool any_bytes(const struct rb_call *call, const char *key, const char *name,
                      const char *bytes, size_t size)
{
	(void)call, (void)key, (void)name, (void)bytes, (void)size;
	return true;
}

const struct rb_source_file *rb_mesh_file(struct rb_call *call, int text,
                                          enum rb_meshfile_kind *kind, double *scale)
{
	lua_State *const L = call->L;
	const char *const name = lua_type(L, text) == LUA_TSTRING ? lua_tostring(L, text) : "";
	char found[80];

	*kind = rb_meshfile_kind(name);
	*scale = 1;
	if (*kind == RB_MESHFILE_NONE) {
		rb_call_mistake(call, "'file' must name an STL or OBJ file, \"part.stl\" (got %s)",
		                rb_describe(L, text, found));
		return NULL;
	}
	if (rb_call_push(call, "scale") != LUA_TNIL &&
	    !rb_call_value(call, rb_row_find(call->table, "scale", NULL), -1, scale))
		return NULL;
	return rb_asset_take(call, "file", name, any_bytes);
}

/* Memory that lies on Lua's stack. */
static void *take(lua_State *L, size_t count, size_t size)
{
	return lua_newuserdatauv(L, count * size + 1, 0);
}

/* Reads the file that `file` names; false: a mistake was noted. */
static bool read_file(struct rb_call *call, struct rb_meshfile_triangles *mesh)
{
	lua_State *const L = call->L;
	enum rb_meshfile_kind kind;
	struct rb_error err;
	double scale;

	rb_call_push(call, "file");
	const int text = lua_gettop(L);
	const struct rb_source_file *const file = rb_mesh_file(call, text, &kind, &scale);
	if (!file)
		return false;
	const size_t corners_max = rb_meshfile_corners_max(kind, file->size_bytes);
	rb_sandbox_charge(L, 40 * corners_max); /* their sorting */
	mesh->points = take(L, 2 * corners_max, sizeof *mesh->points);
	mesh->corners = take(L, RB_TERRAIN_MAX, sizeof *mesh->corners);
	if (rb_meshfile_read_triangles(kind, file->text, file->size_bytes, mesh, &err)) {
		rb_call_mistake(call, "'file': '%s': %s", lua_tostring(L, text), err.text);
		return false;
	}
	for (size_t i = 0; i < mesh->count; i++)
		mesh->points[i] = rb_vec3_scale(scale, mesh->points[i]);
	return true;
}

/* Reads a key that has no place in the definition; false: a mistake was noted, or it is missing. */
static bool read_key(struct rb_call *call, const char *key, void *value)
{
	const bool given = rb_call_push(call, key) != LUA_TNIL;
	const bool right = given &&
	                   rb_call_value(call, rb_row_find(call->table, key, NULL), -1, value);

	lua_pop(call->L, 1);
	if (!given && !call->unknown)
		rb_call_mistake(call, "'height' needs '%s'", key);
	return right;
}

/* Height at a corner of the grid, by the function on top of the stack; false: a mistake. */
static bool ask(struct rb_call *call, rb_vec3 *point)
{
	lua_State *const L = call->L;
	char found[80];

	lua_pushvalue(L, -1);
	lua_pushnumber(L, point->x);
	lua_pushnumber(L, point->y);
	lua_call(L, 2, 1);
	const bool right = lua_type(L, -1) == LUA_TNUMBER && isfinite(lua_tonumber(L, -1));
	if (right)
		point->z = lua_tonumber(L, -1);
	else
		rb_call_mistake(call, "'height' must return a finite number (got %s at %g, %g)",
		                rb_describe(L, -1, found), point->x, point->y);
	lua_pop(L, 1);
	return right;
}

/*
 * Asks for heights over the grid; each cell is two triangles, divided along x = y; false: a mistake
 * was noted.
 */
static bool read_height(struct rb_call *call, struct rb_meshfile_triangles *mesh)
{
	lua_State *const L = call->L;
	double size[2];
	int cells[2];
	char found[80];

	if (!read_key(call, "size", size) || !read_key(call, "cells", cells))
		return false;
	if ((double)cells[0] * cells[1] * 2 > RB_TERRAIN_MAX) {
		rb_call_mistake(call,
		                "'cells': %d x %d cells of two triangles are too many "
		                "(wanted at most %d)",
		                cells[0], cells[1], RB_TERRAIN_MAX / 2);
		return false;
	}
	const size_t nx = (size_t)cells[0], ny = (size_t)cells[1];
	mesh->points = take(L, (nx + 1) * (ny + 1), sizeof *mesh->points);
	mesh->corners = take(L, 2 * nx * ny, sizeof *mesh->corners);
	if (rb_call_push(call, "height") != LUA_TFUNCTION) {
		rb_call_mistake(call, "'height' must be a function (got %s)",
		                rb_describe(L, -1, found));
		return false;
	}
	for (size_t j = 0; j <= ny; j++)
		for (size_t i = 0; i <= nx; i++) {
			rb_vec3 *const point = &mesh->points[mesh->count++];
			*point = (rb_vec3){size[0] * ((double)i / (double)nx - 0.5),
			                   size[1] * ((double)j / (double)ny - 0.5), 0};
			if (!ask(call, point))
				return false;
		}
	for (size_t j = 0; j < ny; j++)
		for (size_t i = 0; i < nx; i++) {
			const int low = (int)(j * (nx + 1) + i), high = low + (int)nx + 1;
			int(*const to)[3] = mesh->corners + mesh->triangle_count;
			to[0][0] = to[1][0] = low;
			to[0][1] = low + 1;
			to[0][2] = to[1][1] = high + 1;
			to[1][2] = high;
			mesh->triangle_count += 2;
		}
	return true;
}

/* Reads either; false: a mistake was noted. */
static bool read_mesh(struct rb_call *call, struct rb_meshfile_triangles *mesh)
{
	const bool of_file = rb_call_tried(call, "file"), of_height = rb_call_tried(call, "height");
	static const char *const others[2][2] = {{"size", "cells"}, {"scale", "scale"}};

	if (of_file == of_height) {
		if (of_file)
			rb_call_mistake(call, "'file' and 'height' exclude each other");
		else if (!call->unknown && call->index)
			rb_call_mistake(call, "'file' or 'height' is missing");
		return false;
	}
	for (int k = 0; k < 2; k++)
		if (rb_call_tried(call, others[of_height][k])) {
			rb_call_mistake(call, "'%s' is of a '%s'", others[of_height][k],
			                of_height ? "file" : "height");
			return false;
		}
	return of_file ? read_file(call, mesh) : read_height(call, mesh);
}

bool rb_terrain_read(struct rb_call *call, struct rb_shape *shape)
{
	struct rb_scene *const scene = call->script->scene;
	const int top = lua_gettop(call->L);
	struct rb_meshfile_triangles mesh = {.triangles_max = RB_TERRAIN_MAX};
	struct rb_error err;
	bool right = read_mesh(call, &mesh);

	if (right) {
		rb_sandbox_charge(call->L, mesh.triangle_count * WORK_A_TRIANGLE);
		rb_sandbox_charge_bytes(call->L, mesh.triangle_count * BYTES_A_TRIANGLE);
		const struct rb_terrain_def def = {mesh.points, (const int(*)[3])mesh.corners,
		                                   mesh.count, mesh.triangle_count};
		const enum rb_status status = rb_scene_add_terrain(scene, &def, &shape->solid,
		                                                   &err);
		right = status == RB_OK;
		if (status == RB_ERR_SCENE)
			rb_call_mistake(call, "'%s': %s",
			                rb_call_tried(call, "file") ? "file" : "height", err.text);
		else
			rb_script_need(call->L, status, &err);
	}
	lua_settop(call->L, top);
	return right;
}
