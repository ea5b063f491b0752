/* SPDX-License-Identifier: MIT */
#include "script/marks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "flow/quantity.h"
#include "script/fields.h"
#include "script/nearest.h"
#include "script/values.h"
#include "script/vector.h"

/* Id of the body that the value at the top of the stack is or names; -1: it is none. */
static int take_body(lua_State *L)
{
	char hint[96];

	return lua_type(L, -1) == LUA_TSTRING ? rb_body_named(L, lua_tostring(L, -1), hint)
	                                      : rb_handle_id(L, -1);
}

/* Reads `trails`: bodies, or their names. */
static void read_trails(struct rb_call *call, struct rb_camera_def *def)
{
	const int count = rb_call_push_list(call, "trails", "bodies", RB_CAMERA_TRAILS_MAX);
	char found[80];

	for (int i = 0; i < count; i++) {
		lua_rawgeti(call->L, -1, i + 1);
		def->trails[i] = take_body(call->L);
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
	const int count = rb_call_push_list(call, "labels", "bodies", RB_CAMERA_LABELS_MAX);
	char found[80];

	for (int i = 0; i < count; i++) {
		struct rb_label_def *const label = &def->labels[i];
		lua_rawgeti(L, -1, i + 1);
		label->body = take_body(L);
		if (label->body < 0 && lua_type(L, -1) == LUA_TTABLE && lua_rawlen(L, -1) == 2) {
			lua_rawgeti(L, -1, 1);
			label->body = take_body(L);
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
	const int count = rb_call_push_list(call, "text", "texts", RB_CAMERA_TEXTS_MAX);
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
				arrows->bodies[k] = take_body(L);
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
	const int count = rb_call_push_list(call, "vectors", "names", RB_VECTORS_COUNT);
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

/* Whether the text before its last point is this name, or this kind of thing by its number. */
static bool is_subject(const char *text, size_t size, const char *name, const char *kind,
                       int number)
{
	char numbered[32];

	snprintf(numbered, sizeof numbered, "%s#%d", kind, number);
	return (name && strlen(name) == size && memcmp(name, text, size) == 0) ||
	       (strlen(numbered) == size && memcmp(numbered, text, size) == 0);
}

/* Finds a part of a body or a joint; false: there is none of that name. */
static bool find_part(const struct rb_scene *scene, struct rb_plot_def *plot)
{
	const char *const dot = strrchr(plot->name, '.');
	const size_t size = dot ? (size_t)(dot - plot->name) : 0;

	plot->of = RB_PLOT_BODY;
	plot->part = dot ? rb_body_part_named(dot + 1) : -1;
	for (int k = 0; plot->part >= 0 && k < scene->body_count; k++) {
		plot->subject = k;
		if (is_subject(plot->name, size, scene->bodies[k].name, "", k))
			return true;
	}
	plot->of = RB_PLOT_JOINT;
	plot->part = dot ? rb_joint_part_named(dot + 1) : -1;
	for (int k = 0; plot->part >= 0 && k < scene->joint_count; k++) {
		plot->subject = k;
		if (is_subject(plot->name, size, scene->joints[k].name, "joint", k) &&
		    rb_joint_part_is_of(plot->part, scene->joints[k].kind))
			return true;
	}
	return false;
}

/* Finds what a plot shows; false: a mistake was noted. The scene's own names go first. */
static bool find_quantity(struct rb_call *call, struct rb_plot_def *plot)
{
	const struct rb_scene *const scene = call->script->scene;
	struct rb_nearest nearest = rb_nearest_to(plot->name);
	const char *const dot = strrchr(plot->name, '.');
	char hint[96], meant[RB_MEASURE_NAME_MAX * 4];

	plot->of = RB_PLOT_PROBE;
	for (int k = 0; k < scene->probe_count; k++) {
		plot->subject = k;
		if (strcmp(scene->probes[k].name, plot->name) == 0)
			return true;
		rb_nearest_offer(&nearest, scene->probes[k].name, strlen(scene->probes[k].name));
	}
	plot->of = RB_PLOT_WORLD;
	plot->part = rb_world_part_named(plot->name);
	if (plot->part >= 0)
		return true;
	for (int k = 0; rb_world_part_name(k); k++)
		rb_nearest_offer(&nearest, rb_world_part_name(k), strlen(rb_world_part_name(k)));
	rb_sandbox_charge(call->L, (uint64_t)scene->body_count + (uint64_t)scene->joint_count);
	if (find_part(scene, plot)) {
		if (plot->of != RB_PLOT_BODY || !scene->bodies[plot->subject].is_static)
			return true;
		rb_call_mistake(call, "'plots': the body of '%.60s' never moves", plot->name);
		return false;
	}
	for (int k = 0; dot && k < scene->body_count; k++) {
		const char *const name = scene->bodies[k].name;
		const int size = name ? snprintf(meant, sizeof meant, "%s%s", name, dot) : -1;

		if (size > 0 && size < (int)sizeof meant && rb_body_part_named(dot + 1) >= 0)
			rb_nearest_offer(&nearest, meant, (size_t)size);
	}
	rb_call_mistake(call,
	                "'plots': there is no probe or quantity '%.60s' so far%s "
	                "(wanted: a probe, energy, momentum, BODY.z, .vz, .speed, JOINT.angle, "
	                ".force, and more)",
	                plot->name, rb_nearest_hint(&nearest, hint));
	return false;
}

/* Reads `plots`: names, or {name, at =, size =}. */
static void read_plots(struct rb_call *call, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	const int count = rb_call_push_list(call, "plots", "names", RB_CAMERA_PLOTS_MAX);
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
			rb_call_mistake(
				call,
				"'plots' must be names of quantities, or {NAME, at = {x, y}, "
				"size = {w, h}} with shares in [0, 1] (got %s at %d)",
				rb_describe(L, -1, found), i + 1);
		else
			def->plot_count += find_quantity(call, plot);
		lua_pop(L, 1);
	}
	if (count >= 0)
		lua_pop(L, 1);
}

void rb_marks_read(struct rb_call *call, struct rb_camera_def *def)
{
	read_trails(call, def);
	read_labels(call, def);
	read_texts(call, def);
	read_vectors(call, def);
	read_plots(call, def);
}
