/* SPDX-License-Identifier: MIT */
/*
 * Most rules of a camera are about keys that go together, which rows cannot state; they are checked
 * after all keys were read, by whether a key was tried, so that a key with a wrong value does not
 * also count as missing.
 */
#include "script/camera.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/vec3.h"
#include "script/body_calls.h"
#include "script/fields.h"
#include "script/values.h"

/*
 * Pushes the list at `key`, and returns its length; -1 with nothing pushed when there is none, or a
 * mistake was noted because it is no list.
 */
static int push_list(struct rb_call *call, const char *key, const char *of, int most)
{
	lua_State *L = call->L;
	char found[80];
	lua_Integer keys = 0;

	if (rb_call_push(call, key) == LUA_TNIL) {
		lua_pop(L, 1);
		return -1;
	}
	if (lua_type(L, -1) == LUA_TTABLE) {
		for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
			keys++;
		if (keys == (lua_Integer)lua_rawlen(L, -1) && keys <= most)
			return (int)keys;
	}
	rb_call_mistake(call, "'%s' must be a list of at most %d %s (got %s)", key, most, of,
	                rb_describe(L, -1, found));
	lua_pop(L, 1);
	return -1;
}

/* Which keys the kinds of lights have beside those of all: 1 may have, 2 must have. */
static const struct {
	const char *key;
	char of[4]; /* by enum rb_light_kind */
} light_keys[] = {
	{"position", {2, 0, 2, 0}}, {"direction", {0, 2, 0, 0}}, {"look_at", {0, 0, 2, 0}},
	{"angle", {0, 0, 1, 0}},    {"softness", {0, 0, 1, 0}},
};

/* Reads one light and checks the keys of its kind. */
static void read_light(struct rb_call *part, struct rb_light_def *light)
{
	static const char *const names[] = {"a lamp", "a sun", "a spot", "an ambient light"};

	*light = (struct rb_light_def){
		.angle = acos(sqrt(0.75)), .softness = 0.2, .color = {1, 1, 1}, .intensity = 1};
	rb_call_read(part, light);
	if (part->index == 0)
		return;
	if (!rb_call_tried(part, "kind")) {
		if (rb_call_tried(part, "position") == rb_call_tried(part, "direction")) {
			rb_call_mistake(part,
			                "needs a 'kind', or one of 'position' and 'direction'");
			return;
		}
		light->kind = rb_call_tried(part, "position") ? RB_LIGHT_LAMP : RB_LIGHT_SUN;
	} else if (!rb_call_given(part, "kind")) {
		return;
	}
	for (size_t k = 0; k < sizeof light_keys / sizeof *light_keys; k++) {
		const bool given = rb_call_tried(part, light_keys[k].key);
		if (given && light_keys[k].of[light->kind] == 0)
			rb_call_mistake(part, "%s has no '%s'", names[light->kind],
			                light_keys[k].key);
		if (!given && light_keys[k].of[light->kind] == 2)
			rb_call_mistake(part, "%s needs '%s'", names[light->kind],
			                light_keys[k].key);
	}
	if (light->kind == RB_LIGHT_SPOT && rb_call_given(part, "position") &&
	    rb_call_given(part, "look_at") &&
	    !(rb_vec3_length(rb_vec3_sub(light->position, light->look_at)) > 0))
		rb_call_mistake(part, "'look_at' is where the spot is");
}

/* Reads `lights`. */
static void read_lights(struct rb_call *call, struct rb_camera_def *def)
{
	const int count = push_list(call, "lights", "tables", RB_CAMERA_LIGHTS_MAX);

	for (int i = 0; i < count; i++) {
		lua_rawgeti(call->L, -1, i + 1);
		struct rb_call part = rb_call_part(call, &rb_rows_light, -1, i + 1);
		read_light(&part, &def->lights[i]);
		lua_pop(call->L, 1);
	}
	if (count >= 0) {
		def->light_count = count;
		lua_pop(call->L, 1);
	}
}

/* Reads `trails`: bodies by handle. */
static void read_trails(struct rb_call *call, struct rb_camera_def *def)
{
	const int count = push_list(call, "trails", "bodies", RB_CAMERA_TRAILS_MAX);
	char found[80];

	for (int i = 0; i < count; i++) {
		lua_rawgeti(call->L, -1, i + 1);
		def->trails[i] = rb_handle_id(call->L, -1);
		if (def->trails[i] < 0)
			rb_call_mistake(call, "'trails' must be a list of bodies (got %s at %d)",
			                rb_describe(call->L, -1, found), i + 1);
		lua_pop(call->L, 1);
	}
	if (count >= 0) {
		def->trail_count = count;
		lua_pop(call->L, 1);
	}
}

bool rb_camera_is_numbered(const char *pattern)
{
	int numbers = 0;

	RB_ASSERT(pattern != NULL);
	for (const char *p = pattern; *p; p++) {
		if (*p != '%')
			continue;
		p++;
		if (*p == '%')
			continue;
		if (*p == '0')
			p++;
		if (*p >= '1' && *p <= '9')
			p++;
		if (*p != 'd')
			return false;
		numbers++;
	}
	return numbers == 1;
}

/* Notes names of files that no film can have. */
static void check_outputs(const struct rb_call *call, const struct rb_camera_def *def)
{
	if (def->png && !rb_camera_is_numbered(def->png))
		rb_call_mistake(call,
		                "'png' must hold one %%d for the number of the picture, like "
		                "'frames/%%05d.png' (got '%.60s')",
		                def->png);
	if (!def->video)
		return;
	const char *dot = strrchr(def->video, '.');
	if (!dot ||
	    (strcmp(dot, ".mp4") != 0 && strcmp(dot, ".webm") != 0 && strcmp(dot, ".gif") != 0))
		rb_call_mistake(call, "'video' must end in .mp4, .webm or .gif (got '%.60s')",
		                def->video);
}

/* Notes keys that belong to the other projection. */
static void check_projection(const struct rb_call *call, const struct rb_camera_def *def)
{
	if (!def->orthographic && rb_call_tried(call, "height") &&
	    rb_call_given(call, "projection") == rb_call_tried(call, "projection"))
		rb_call_mistake(call, "'height' goes with projection = \"orthographic\" (a "
		                      "perspective has 'fov')");
	if (def->orthographic && rb_call_tried(call, "fov"))
		rb_call_mistake(call, "an orthographic projection has no 'fov' (use 'height', m)");
	if (def->orthographic && !def->framed && !rb_call_tried(call, "height") &&
	    !rb_call_tried(call, "frustum"))
		rb_call_mistake(call, "an orthographic projection needs 'height', m");
}

/* Notes what no single key can tell, and sets what follows from several. */
static void check_camera(const struct rb_call *call, struct rb_camera_def *def)
{
	const bool mounted = rb_call_tried(call, "mount");

	if (!mounted && rb_call_tried(call, "offset"))
		rb_call_mistake(call, "'offset' goes with 'mount'");
	if (!mounted && rb_call_tried(call, "level"))
		rb_call_mistake(call, "'level' goes with 'mount'");
	if (mounted && rb_call_tried(call, "position"))
		rb_call_mistake(call, "'mount' and 'position' exclude each other (use 'offset')");
	def->framed = !mounted && !rb_call_tried(call, "position");
	def->aimed = rb_call_given(call, "look_at");
	def->has_frustum = rb_call_given(call, "frustum");
	if (def->has_frustum) {
		const double *f = def->frustum;
		if (rb_call_tried(call, "fov") || rb_call_tried(call, "height") ||
		    rb_call_tried(call, "near") || rb_call_tried(call, "far"))
			rb_call_mistake(call,
			                "'frustum' excludes 'fov', 'height', 'near' and 'far'");
		if (!(f[0] < f[1] && f[2] < f[3] && f[4] > 0 && f[4] < f[5]))
			rb_call_mistake(call, "'frustum' must be {left, right, bottom, top, near, "
			                      "far} with left < right, "
			                      "bottom < top and 0 < near < far");
	}
	check_projection(call, def);
	if (def->near >= def->far)
		rb_call_mistake(call, "'near' must be less than 'far' (got %.12g and %.12g)",
		                def->near, def->far);
	if (def->from_s > def->to_s)
		rb_call_mistake(call, "'from' must not be after 'to' (got %.12g and %.12g)",
		                def->from_s, def->to_s);
	const rb_vec3 up = def->up.value;
	if (def->position.source == RB_CAMERA_FIXED && def->look_at.source == RB_CAMERA_FIXED &&
	    !mounted && !def->framed) {
		const rb_vec3 sight = rb_vec3_sub(def->look_at.value, def->position.value);
		const double length = rb_vec3_length(sight);
		if (!(length > 0))
			rb_call_mistake(call,
			                "'position' and 'look_at' must not be the same point");
		else if (def->up.source == RB_CAMERA_FIXED &&
		         /* the sine of the angle between them: below it "right" is only rounding */
		         rb_vec3_length(rb_vec3_cross(sight, up)) <
		                 1e-9 * length * rb_vec3_length(up))
			rb_call_mistake(call, "'up' must not be along the line of sight");
	}
	check_outputs(call, def);
}

static int l_camera(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "camera", &rb_rows_camera, 1);
	struct rb_camera_def def = rb_camera_def_default();
	struct rb_error err;

	def.line = call.line;
	def.file = call.script->source;
	rb_call_read(&call, &def);
	read_lights(&call, &def);
	read_trails(&call, &def);
	check_camera(&call, &def);
	rb_name_take(&call, "camera", def.name);
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_camera(call.script->scene, &def, &err), &err);
	return 0;
}

void rb_camera_names(lua_State *L)
{
	const struct rb_scene *scene = rb_script_of(L)->scene;

	lua_createtable(L, 0, scene->camera_count);
	for (int i = 0; i < scene->camera_count; i++) {
		if (!scene->cameras[i].name)
			continue;
		lua_pushinteger(L, scene->cameras[i].line);
		lua_setfield(L, -2, scene->cameras[i].name);
	}
	lua_setfield(L, LUA_REGISTRYINDEX, RB_NAMES_KEY "camera");
}

void rb_camera_open(lua_State *L)
{
	lua_register(L, "camera", l_camera);
}
