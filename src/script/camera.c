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
#include "script/nearest.h"
#include "script/values.h"
#include "script/vector.h"

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

/* The text at the top of the stack, or NULL and a mistake. */
static const char *take_text(struct rb_call *call, const char *key, const char *wanted, int at)
{
	char found[80];

	if (lua_type(call->L, -1) == LUA_TSTRING)
		return lua_tostring(call->L, -1);
	rb_call_mistake(call, "'%s' must be %s (got %s at %d)", key, wanted,
	                rb_describe(call->L, -1, found), at);
	return NULL;
}

/* Reads `labels`: bodies, or {body, "text"}. Texts live as long as the call's table. */
static void read_labels(struct rb_call *call, struct rb_camera_def *def)
{
	static const char wanted[] = "a list of bodies, or {body, \"text\"}";
	lua_State *const L = call->L;
	const int count = push_list(call, "labels", "bodies", RB_CAMERA_LABELS_MAX);
	char found[80];

	for (int i = 0; i < count; i++) {
		struct rb_label_def *const label = &def->labels[i];
		lua_rawgeti(L, -1, i + 1);
		label->body = rb_handle_id(L, -1);
		if (label->body < 0 && lua_type(L, -1) == LUA_TTABLE && lua_rawlen(L, -1) == 2) {
			lua_rawgeti(L, -1, 1);
			label->body = rb_handle_id(L, -1);
			lua_rawgeti(L, -2, 2);
			label->text = take_text(call, "labels", wanted, i + 1);
			lua_pop(L, 2);
		}
		if (label->body < 0)
			rb_call_mistake(call, "'labels' must be %s (got %s at %d)", wanted,
			                rb_describe(L, -1, found), i + 1);
		lua_pop(L, 1);
	}
	if (count >= 0) {
		def->label_count = count;
		lua_pop(L, 1);
	}
}

/* `at` and `size` of the table at the top of the stack; false: they are wrong, or there is more. */
static bool read_place(lua_State *L, struct rb_caption_def *caption)
{
	bool right = true;

	for (lua_pushnil(L); right && lua_next(L, -2); lua_pop(L, 1)) {
		const char *const key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";

		if (strcmp(key, "at") == 0) {
			right = rb_vector_numbers(L, -1, 2, caption->at, NULL) &&
			        caption->at[0] >= 0 && caption->at[0] <= 1 && caption->at[1] >= 0 &&
			        caption->at[1] <= 1;
		} else if (strcmp(key, "size") == 0) {
			caption->size = lua_tonumber(L, -1);
			right = lua_type(L, -1) == LUA_TNUMBER && caption->size > 0 &&
			        caption->size <= 1;
		} else {
			right = lua_isinteger(L, -2) && lua_tointeger(L, -2) == 1;
		}
		if (!right)
			lua_pop(L, 1);
	}
	return right;
}

/* Reads one text of `text`, at the top of the stack: a text, a function, or a table of it. */
static void read_caption(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	struct rb_caption_def *const caption = &def->texts[def->text_count++];
	const bool table = lua_type(L, -1) == LUA_TTABLE;
	char found[80];

	*caption = (struct rb_caption_def){
		.function = -1, .at = {(double)NAN, (double)NAN}, .size = (double)NAN};
	const bool placed = !table || read_place(L, caption);
	if (table)
		lua_rawgeti(L, -1, 1);
	if (lua_type(L, -1) == LUA_TFUNCTION)
		caption->function = rb_script_keep_function(L, -1);
	else if (lua_type(L, -1) == LUA_TSTRING)
		caption->text = lua_tostring(L, -1);
	if (table)
		lua_pop(L, 1);
	if (!placed || (!caption->text && caption->function < 0)) {
		rb_call_mistake(
			call,
			"'text' must be a text, a function or {text, at = {x, y}, size = s} "
			"with shares in [0, 1], or a list of these (got %s)",
			rb_describe(L, -1, found));
		caption->text = "";
	}
}

static bool has_key(lua_State *L, const char *key)
{
	const bool has = lua_getfield(L, -1, key) != LUA_TNIL;

	lua_pop(L, 1);
	return has;
}

/* Reads `text`: one, with a place or without, or a list. */
static void read_texts(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;

	if (rb_call_push(call, "text") == LUA_TNIL) {
		lua_pop(L, 1);
		return;
	}
	if (lua_type(L, -1) != LUA_TTABLE || has_key(L, "at") || has_key(L, "size")) {
		read_caption(call, def);
		lua_pop(L, 1);
		return;
	}
	lua_pop(L, 1);
	const int count = push_list(call, "text", "texts", RB_CAMERA_TEXTS_MAX);
	for (int i = 0; i < count; i++) {
		lua_rawgeti(L, -1, i + 1);
		read_caption(call, def);
		lua_pop(L, 1);
	}
	if (count >= 0)
		lua_pop(L, 1);
}

/* `bodies` and `scale` of the table at the top of the stack; false: they are wrong, or others. */
static bool read_arrows(lua_State *L, struct rb_arrows_def *arrows)
{
	bool right = true;

	for (lua_pushnil(L); right && lua_next(L, -2); lua_pop(L, 1)) {
		const char *const key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";

		if (strcmp(key, "scale") == 0) {
			arrows->scale = lua_tonumber(L, -1);
			right = lua_type(L, -1) == LUA_TNUMBER && arrows->scale > 0 &&
			        isfinite(arrows->scale);
		} else if (strcmp(key, "bodies") == 0) {
			const lua_Unsigned count = lua_type(L, -1) == LUA_TTABLE ? lua_rawlen(L, -1)
			                                                         : 0;
			right = count > 0 && count <= RB_CAMERA_TRAILS_MAX;
			for (lua_Unsigned k = 0; right && k < count; k++) {
				lua_rawgeti(L, -1, (lua_Integer)k + 1);
				arrows->bodies[k] = rb_handle_id(L, -1);
				right = arrows->bodies[k] >= 0;
				lua_pop(L, 1);
			}
			arrows->body_count = right ? (int)count : 0;
		} else {
			right = lua_isinteger(L, -2) && lua_tointeger(L, -2) == 1;
		}
		if (!right)
			lua_pop(L, 1);
	}
	return right;
}

static const struct rb_row *row_of(const char *key)
{
	const struct rb_row *row = rb_rows_camera.rows;

	while (strcmp(row->key, key) != 0)
		row++;
	return row;
}

/* Reads one entry of `vectors`, at the top of the stack: a name, or {name, bodies =, scale =}. */
static void read_vector(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	const struct rb_row *const row = row_of("vectors");
	const bool table = lua_type(L, -1) == LUA_TTABLE;
	struct rb_arrows_def arrows = {0};
	char found[80];

	if (table && !read_arrows(L, &arrows)) {
		rb_call_mistake(
			call,
			"'vectors' must be names, or {NAME, bodies = {body, ...}, scale = m "
			"per unit} with 1 to %d bodies and a positive scale (got %s)",
			RB_CAMERA_TRAILS_MAX, rb_describe(L, -1, found));
		return;
	}
	if (table)
		lua_rawgeti(L, -1, 1);
	const int kind = rb_call_choice(call, row, lua_absindex(L, -1));
	if (table)
		lua_pop(L, 1);
	if (kind < 0)
		return;
	def->vectors |= 1u << kind;
	def->arrows[kind] = arrows;
}

/* Reads `vectors`: one, or a list. */
static void read_vectors(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;

	if (rb_call_push(call, "vectors") == LUA_TNIL) {
		lua_pop(L, 1);
		return;
	}
	if (lua_type(L, -1) != LUA_TTABLE || has_key(L, "bodies") || has_key(L, "scale")) {
		read_vector(call, def);
		lua_pop(L, 1);
		return;
	}
	lua_pop(L, 1);
	const int count = push_list(call, "vectors", "names", RB_VECTORS_COUNT);
	for (int i = 0; i < count; i++) {
		lua_rawgeti(L, -1, i + 1);
		read_vector(call, def);
		lua_pop(L, 1);
	}
	if (count >= 0)
		lua_pop(L, 1);
}

/* `at` and `size` of the table at the top of the stack; false: they are wrong, or others. */
static bool read_frame(lua_State *L, struct rb_plot_def *plot)
{
	bool right = true;

	for (lua_pushnil(L); right && lua_next(L, -2); lua_pop(L, 1)) {
		const char *const key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
		const bool at = strcmp(key, "at") == 0;
		double *const pair = at ? plot->at : plot->size;

		if (at || strcmp(key, "size") == 0)
			right = rb_vector_numbers(L, -1, 2, pair, NULL) &&
			        (at ? pair[0] >= 0 && pair[1] >= 0 : pair[0] > 0 && pair[1] > 0) &&
			        pair[0] <= 1 && pair[1] <= 1;
		else
			right = lua_isinteger(L, -2) && lua_tointeger(L, -2) == 1;
		if (!right)
			lua_pop(L, 1);
	}
	return right;
}

/* Finds what a plot shows; false: a mistake was noted. */
static bool find_quantity(struct rb_call *call, struct rb_plot_def *plot)
{
	static const char *const own[] = {"energy", "kinetic_energy", "potential_energy"};
	const struct rb_scene *const scene = call->script->scene;
	struct rb_nearest nearest = rb_nearest_to(plot->name);
	char hint[96];

	for (int k = 0; k < scene->probe_count; k++) {
		plot->quantity = k;
		if (strcmp(scene->probes[k].name, plot->name) == 0)
			return true;
		rb_nearest_offer(&nearest, scene->probes[k].name, strlen(scene->probes[k].name));
	}
	for (int k = 0; k < 3; k++) {
		plot->quantity = RB_PLOT_ENERGY + k;
		if (strcmp(own[k], plot->name) == 0)
			return true;
		rb_nearest_offer(&nearest, own[k], strlen(own[k]));
	}
	rb_call_mistake(call, "'plots': no probe is named '%.60s' so far%s", plot->name,
	                rb_nearest_hint(&nearest, hint));
	return false;
}

/* Reads `plots`: names, or {name, at =, size =}. */
static void read_plots(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	const int count = push_list(call, "plots", "names", RB_CAMERA_PLOTS_MAX);
	char found[80];

	for (int i = 0; i < count; i++) {
		struct rb_plot_def *const plot = &def->plots[def->plot_count];
		lua_rawgeti(L, -1, i + 1);
		const bool table = lua_type(L, -1) == LUA_TTABLE;
		*plot = (struct rb_plot_def){.at = {0.98, 0.03 + 0.35 * i}, .size = {0.3, 0.25}};
		const bool placed = !table || read_frame(L, plot);
		if (table)
			lua_rawgeti(L, -1, 1);
		if (lua_type(L, -1) == LUA_TSTRING)
			plot->name = lua_tostring(L, -1);
		if (table)
			lua_pop(L, 1);
		if (!placed || !plot->name)
			rb_call_mistake(call,
			                "'plots' must be names of probes, or {NAME, at = {x, y}, "
			                "size = {w, h}} with shares in [0, 1] (got %s at %d)",
			                rb_describe(L, -1, found), i + 1);
		else
			def->plot_count += find_quantity(call, plot);
		lua_pop(L, 1);
	}
	if (count >= 0)
		lua_pop(L, 1);
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

	if (lua_type(L, -1) != LUA_TTABLE || lua_rawlen(L, -1) != 2)
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
	read_labels(&call, &def);
	read_texts(&call, &def);
	read_vectors(&call, &def);
	read_plots(&call, &def);
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
		rb_call_mistake(call, "'rows': no camera is named '%.60s' so far%s", name,
		                rb_nearest_hint(&nearest, hint));
	else
		rb_call_mistake(call, "'rows' must be lists of names of cameras (got %s)",
		                rb_describe(call->L, -1, found));
	return -1;
}

/* Reads `rows`; false: it is wrong, or there is none. */
static bool read_rows(struct rb_call *call, struct rb_film_def *film)
{
	lua_State *const L = call->L;
	const int rows = push_list(call, "rows", "rows", RB_FILM_CELLS_MAX);
	char found[80];
	bool right = rows > 0;

	if (rows <= 0 && !(rows < 0 && rb_call_tried(call, "rows")))
		rb_call_mistake(call, "'rows' is missing: lists of names of cameras, like "
		                      "{{\"front\", \"top\"}}");
	for (int r = 0; r < rows && right; r++) {
		lua_rawgeti(L, -1, r + 1);
		const size_t columns = lua_type(L, -1) == LUA_TTABLE ? lua_rawlen(L, -1) : 0;
		right = columns > 0 && film->cell_count + (int)columns <= RB_FILM_CELLS_MAX &&
		        columns <= RB_FILM_CELLS_MAX;
		if (!right)
			rb_call_mistake(call,
			                "'rows' must be lists of names of cameras, %d in all at "
			                "most (got %s at %d)",
			                RB_FILM_CELLS_MAX, rb_describe(L, -1, found), r + 1);
		film->columns[film->row_count++] = (int)columns;
		for (size_t c = 0; c < columns && right; c++) {
			lua_rawgeti(L, -1, (lua_Integer)c + 1);
			const int camera = camera_named(call);
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
		def->speed = first->speed;
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
