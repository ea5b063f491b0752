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
#include "flow/schedule.h"
#include "script/body_calls.h"
#include "script/fields.h"
#include "script/marks.h"
#include "script/nearest.h"
#include "script/values.h"
#include "script/vector.h"

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
	const int count = rb_call_push_list(call, "lights", "tables", RB_CAMERA_LIGHTS_MAX);

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

struct named_size {
	const char *key, *name; /* what a scene writes, and what a picture shows */
	double size;            /* m or s */
};

/* Radii: nominal ones of IAU 2015 B3 (of planets at the equator); of the Moon the mean one. */
static const struct named_size lengths[] = {
	{"nm", "nm", 1e-9},
	{"um", "\xc2\xb5m", 1e-6},
	{"mm", "mm", 1e-3},
	{"cm", "cm", 1e-2},
	{"m", "m", 1},
	{"km", "km", 1e3},
	{"R_moon", "R\xe2\x98\xbe", 1.7374e6},
	{"R_earth", "R\xe2\x8a\x95", 6.3781e6},
	{"R_jupiter", "R\xe2\x99\x83", 7.1492e7},
	{"R_sun", "R\xe2\x98\x89", 6.957e8},
	{"AU", "AU", 149597870700},
	{"ly", "ly", 9460730472580800},
	{"pc", "pc", 3.0856775814913673e16},
	{NULL, NULL, 0},
};

/* A year is 365.25 days. */
static const struct named_size times[] = {
	{"ns", "ns", 1e-9},
	{"us", "\xc2\xb5s", 1e-6},
	{"ms", "ms", 1e-3},
	{"s", "s", 1},
	{"min", "min", 60},
	{"h", "h", 3600},
	{"d", "d", 86400},
	{"yr", "yr", 31557600},
	{"kyr", "kyr", 31557600e3},
	{"Myr", "Myr", 31557600e6},
	{NULL, NULL, 0},
};

/* Notes a name that is none, with the nearest that is one. */
static void no_such_unit(const struct rb_call *part, const char *key, const char *word,
                         const struct named_size *known)
{
	struct rb_nearest nearest = rb_nearest_to(word);
	char hint[96];

	for (; known->key; known++)
		rb_nearest_offer(&nearest, known->key, strlen(known->key));
	rb_call_mistake(part, "'%s': unknown unit '%.40s'%s", key, word,
	                rb_nearest_hint(&nearest, hint));
}

/* Reads {NAME, SIZE}, which is at the top of the stack; false: it is none. */
static bool read_own_unit(lua_State *L, struct rb_unit_def *unit)
{
	enum { NAME_MOST = 16 };

	if (rb_list_length(L, -1) != 2)
		return false;
	lua_rawgeti(L, -1, 1);
	lua_rawgeti(L, -2, 2);
	const bool right = lua_type(L, -2) == LUA_TSTRING && lua_rawlen(L, -2) > 0 &&
	                   lua_rawlen(L, -2) <= NAME_MOST && lua_type(L, -1) == LUA_TNUMBER &&
	                   lua_tonumber(L, -1) > 0 && isfinite(lua_tonumber(L, -1));
	/* the text lives in the scene's table while the call lasts; the scene then copies it */
	if (right)
		*unit = (struct rb_unit_def){lua_tostring(L, -2), lua_tonumber(L, -1)};
	lua_pop(L, 2);
	return right;
}

/* Reads a unit by its name, or one of the scene's own. */
static void read_unit(struct rb_call *part, const char *key, const struct named_size *known,
                      struct rb_unit_def *unit)
{
	lua_State *const L = part->L;
	char found[80];
	const int type = rb_call_push(part, key);

	if (type == LUA_TSTRING) {
		const char *const word = lua_tostring(L, -1);
		const struct named_size *at = known;
		while (at->key && strcmp(at->key, word) != 0)
			at++;
		if (at->key)
			*unit = (struct rb_unit_def){at->name, at->size};
		else
			no_such_unit(part, key, word, known);
	} else if (type != LUA_TNIL && !read_own_unit(L, unit)) {
		rb_call_mistake(part, "'%s' must be the name of a unit, or {NAME, SIZE} (got %s)",
		                key, rb_describe(L, -1, found));
	}
	lua_pop(L, 1);
}

/* Reads `units`. */
static void read_units(struct rb_call *call, struct rb_camera_def *def)
{
	if (rb_call_push(call, "units") != LUA_TNIL) {
		struct rb_call part = rb_call_part(call, &rb_rows_units, -1, 0);

		rb_call_read(&part, def);
		if (lua_type(call->L, -1) == LUA_TTABLE) {
			read_unit(&part, "length", lengths, &def->length_unit);
			read_unit(&part, "time", times, &def->time_unit);
		}
	}
	lua_pop(call->L, 1);
}

/* Reads `speed`: a number, or a function of time. */
static void read_speed(struct rb_call *call, struct rb_camera_def *def)
{
	struct rb_row row = *rb_row_find(call->table, "speed", NULL);

	row.type = RB_ROW_NUMBER;
	const int type = rb_call_push(call, row.key);
	if (type == LUA_TFUNCTION) {
		def->speed_function = rb_script_keep_function(call->L, -1);
		def->speed_varies = true;
	} else if (type == LUA_TNUMBER) {
		(void)rb_call_value(call, &row, -1, &def->speed);
	} else if (type != LUA_TNIL) {
		char found[80];
		rb_call_mistake(call, "'speed' must be a number or a function (got %s)",
		                rb_describe(call->L, -1, found));
	}
	lua_pop(call->L, 1);
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
	read_speed(&call, &def);
	read_lights(&call, &def);
	rb_marks_read(&call, &def);
	read_units(&call, &def);
	check_camera(&call, &def);
	rb_name_take(&call, "camera", def.name);
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_camera(call.script->scene, &def, &err), &err);
	return 0;
}

/* Place of the camera that the top of the stack names; -1: a mistake was noted. */
static int camera_named(struct rb_call *call)
{
	const struct rb_scene *const scene = call->script->scene;
	const char *const name = lua_type(call->L, -1) == LUA_TSTRING ? lua_tostring(call->L, -1)
	                                                              : NULL;
	struct rb_nearest nearest = rb_nearest_to(name ? name : "");
	char found[80], hint[96];

	for (int i = 0; i < scene->camera_count; i++) {
		const char *const one = scene->cameras[i].name;
		if (one && name && strcmp(one, name) == 0)
			return i;
		if (one)
			rb_nearest_offer(&nearest, one, strlen(one));
	}
	if (name)
		rb_call_mistake(call, "no camera is named '%.60s' so far%s", name,
		                rb_nearest_hint(&nearest, hint));
	else
		rb_call_mistake(call, "must be the name of a camera (got %s)",
		                rb_describe(call->L, -1, found));
	return -1;
}

/* Reads `rows`; false: it is wrong, or there is none. */
static bool read_rows(struct rb_call *call, struct rb_film_def *film)
{
	lua_State *const L = call->L;
	const int rows = rb_call_push_list(call, "rows", "rows", RB_FILM_CELLS_MAX);
	char found[80];
	bool right = rows > 0;

	if (rows <= 0 && !(rows < 0 && rb_call_tried(call, "rows")))
		rb_call_mistake(call, "'rows' is missing: lists of names of cameras, like "
		                      "{{\"front\", \"top\"}}");
	for (int r = 0; r < rows && right; r++) {
		const struct rb_call row = rb_call_entry(call, "rows", r + 1);

		lua_rawgeti(L, -1, r + 1);
		const long long columns = rb_list_length(L, -1);
		right = columns > 0 && columns <= RB_FILM_CELLS_MAX - (long long)film->cell_count;
		if (!right)
			rb_call_mistake(&row,
			                "must be a list of names of cameras, %d in all rows at "
			                "most (got %s)",
			                RB_FILM_CELLS_MAX, rb_describe(L, -1, found));
		film->columns[film->row_count++] = (int)columns;
		for (long long c = 0; c < columns && right; c++) {
			lua_rawgeti(L, -1, c + 1);
			struct rb_call one = rb_call_entry(&row, "", (int)c + 1);
			const int camera = camera_named(&one);
			right = camera >= 0;
			film->cells[film->cell_count++] = camera;
			lua_pop(L, 1);
		}
		lua_pop(L, 1);
	}
	if (rows >= 0)
		lua_pop(L, 1);
	return right;
}

static int l_film(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "film", &rb_rows_film, 1);
	struct rb_film_def film = {.camera = rb_camera_def_default()};
	struct rb_camera_def *const def = &film.camera;
	struct rb_error err;

	if (call.index == 0)
		return 0;
	def->line = call.line;
	def->file = call.script->source;
	rb_call_read(&call, def);
	read_speed(&call, def);
	check_outputs(&call, def);
	if (!rb_call_tried(&call, "png") && !rb_call_tried(&call, "video"))
		rb_call_mistake(&call, "needs 'video' or 'png'");
	rb_name_take(&call, "camera", def->name);
	if (!read_rows(&call, &film))
		return 0;
	const struct rb_camera_def *const first = &call.script->scene->cameras[film.cells[0]];
	if (!rb_call_given(&call, "fps"))
		def->fps = first->fps;
	if (!rb_call_given(&call, "speed"))
		rb_camera_take_speed(def, first);
	if (!rb_call_given(&call, "from"))
		def->from_s = first->from_s;
	if (!rb_call_given(&call, "to"))
		def->to_s = first->to_s;
	if (def->from_s > def->to_s)
		rb_call_mistake(&call, "'from' must not be after 'to' (got %.12g and %.12g)",
		                def->from_s, def->to_s);
	rb_sandbox_charge_bytes(L, sizeof film);
	rb_script_need(L, rb_scene_add_film(call.script->scene, &film, &err), &err);
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
	lua_register(L, "film", l_film);
}
