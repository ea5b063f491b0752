/* SPDX-License-Identifier: MIT */
#include "script/marks.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "flow/quantity.h"
#include "script/fields.h"
#include "script/nearest.h"
#include "script/values.h"

/* What stands in lists: the call's label names the entry. */
static const struct rb_row body_row = {.key = "", .type = RB_ROW_BODY};
static const struct rb_row text_row = {.key = "", .type = RB_ROW_TEXT};

/* Keys of the tables that may stand there instead. */
#define AT(type, member) offsetof(struct type, member)
static const struct rb_row caption_rows[] = {
	{.key = "at",
         .type = RB_ROW_NUMBERS,
         .range = RB_RANGE_UNIT,
         .count = 2,
         .at = AT(rb_caption_def, at)},
	{.key = "size",
         .type = RB_ROW_NUMBER,
         .range = RB_RANGE_SHARE,
         .at = AT(rb_caption_def, size)},
};
static const struct rb_row plot_rows[] = {
	{.key = "at",
         .type = RB_ROW_NUMBERS,
         .range = RB_RANGE_UNIT,
         .count = 2,
         .at = AT(rb_plot_def, at)},
	{.key = "size",
         .type = RB_ROW_NUMBERS,
         .range = RB_RANGE_SHARE,
         .count = 2,
         .at = AT(rb_plot_def, size)},
};
static const struct rb_row arrows_rows[] = {
	{.key = "bodies", .type = RB_ROW_LIST, .at = RB_ROW_BY_HAND},
	{.key = "scale",
         .type = RB_ROW_NUMBER,
         .range = RB_RANGE_POSITIVE,
         .at = AT(rb_arrows_def, scale)},
};
static const struct rb_row_table caption_table = {"text", caption_rows, 2, NULL};
static const struct rb_row_table plot_table = {"plots", plot_rows, 2, NULL};
static const struct rb_row_table arrows_table = {"vectors", arrows_rows, 2, NULL};
static const struct rb_row_table label_table = {"labels", NULL, 0, NULL};

/*
 * Begins to read the entry at the top of the stack: a value, or a table that begins with `values`
 * of them and may have keys. `number` 0: it stands at the key itself, without a list.
 */
static struct rb_call begin_entry(const struct rb_call *call, const struct rb_row_table *table,
                                  int number, int values)
{
	const bool has_keys = lua_type(call->L, -1) == LUA_TTABLE;
	struct rb_call entry = *call;

	if (number > 0 || has_keys)
		entry = rb_call_entry(call, table->name, number);
	entry.table = table;
	entry.index = has_keys ? lua_gettop(call->L) : 0;
	entry.values = values;
	return entry;
}

/* Pushes the k-th value of the entry at the top of the stack; `one` is what mistakes in it name. */
static void push_value(const struct rb_call *entry, int k, struct rb_call *one)
{
	*one = entry->index ? rb_call_entry(entry, "", k) : *entry;
	if (entry->index)
		lua_rawgeti(entry->L, entry->index, k);
	else
		lua_pushvalue(entry->L, -1);
}

/* Reads bodies, or their names; returns how many, -1 if there is no list. */
static int read_bodies(struct rb_call *call, const char *key, int ids[RB_CAMERA_TRAILS_MAX])
{
	const int count = rb_call_push_list(call, key, "bodies", RB_CAMERA_TRAILS_MAX);

	for (int i = 0; i < count; i++) {
		struct rb_call entry = rb_call_entry(call, key, i + 1);

		lua_rawgeti(call->L, -1, i + 1);
		(void)rb_call_value(&entry, &body_row, -1, &ids[i]);
		lua_pop(call->L, 1);
	}
	if (count >= 0)
		lua_pop(call->L, 1);
	return count;
}

/* Reads `labels`: bodies, or {body, "text"}. Texts live as long as the call's table. */
static void read_labels(struct rb_call *call, struct rb_camera_def *def)
{
	const int count = rb_call_push_list(call, "labels", "bodies", RB_CAMERA_LABELS_MAX);

	for (int i = 0; i < count; i++) {
		struct rb_label_def *const label = &def->labels[i];
		struct rb_call one;

		lua_rawgeti(call->L, -1, i + 1);
		struct rb_call entry = begin_entry(call, &label_table, i + 1, 2);
		rb_call_read(&entry, label);
		push_value(&entry, 1, &one);
		(void)rb_call_value(&one, &body_row, -1, &label->body);
		lua_pop(call->L, 1);
		if (entry.index) {
			push_value(&entry, 2, &one);
			(void)rb_call_value(&one, &text_row, -1, &label->text);
			lua_pop(call->L, 1);
		}
		lua_pop(call->L, 1);
	}
	if (count >= 0) {
		def->label_count = count;
		lua_pop(call->L, 1);
	}
}

/* ---- one, or a list ---- */

static const struct rb_row *row_of(const char *key)
{
	const struct rb_row *row = rb_rows_camera.rows;

	while (strcmp(row->key, key) != 0)
		row++;
	return row;
}

/* The row of a key for its entry of that number: without the key where the label has it. */
static struct rb_row row_for(const char *key, const struct rb_call *entry, int number)
{
	struct rb_row row = *row_of(key);

	if (number > 0 || entry->index)
		row.key = "";
	return row;
}

/* Whether what is at the top of the stack is no list: it has keys, or is no table. */
static bool is_one(lua_State *L)
{
	bool has_keys = false;

	if (lua_type(L, -1) != LUA_TTABLE)
		return true;
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
		has_keys |= lua_type(L, -2) == LUA_TSTRING;
	return has_keys;
}

typedef void entry_reader(struct rb_call *call, int number, struct rb_camera_def *def);

static void read_one_or_list(struct rb_call *call, const char *key, const char *of, int most,
                             entry_reader *read, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	const bool is_there = rb_call_push(call, key) != LUA_TNIL, one = is_one(L);

	if (is_there && one)
		read(call, 0, def);
	lua_pop(L, 1);
	if (!is_there || one)
		return;
	const int count = rb_call_push_list(call, key, of, most);
	for (int i = 0; i < count; i++) {
		lua_rawgeti(L, -1, i + 1);
		read(call, i + 1, def);
		lua_pop(L, 1);
	}
	if (count >= 0)
		lua_pop(L, 1);
}

/* Reads one text of `text`, at the top of the stack: a text, a function, or a table of it. */
static void read_caption(struct rb_call *call, int number, struct rb_camera_def *def)
{
	lua_State *const L = call->L;
	struct rb_caption_def *const caption = &def->texts[def->text_count++];
	struct rb_call entry = begin_entry(call, &caption_table, number, 1), one;
	const struct rb_row row = row_for("text", &entry, number);

	*caption = (struct rb_caption_def){
		.function = -1, .at = {(double)NAN, (double)NAN}, .size = (double)NAN};
	rb_call_read(&entry, caption);
	push_value(&entry, 1, &one);
	if (lua_type(L, -1) == LUA_TFUNCTION)
		caption->function = rb_script_keep_function(L, -1);
	else if (lua_type(L, -1) != LUA_TSTRING)
		(void)rb_call_wrong(&one, &row, -1,
		                    "a text or a function, or {TEXT, at = {x, y}, size = s}");
	else
		(void)rb_call_value(&one, &row, -1, &caption->text);
	lua_pop(L, 1);
}

/* Reads one entry of `vectors`, at the top of the stack: a name, or {name, bodies =, scale =}. */
static void read_vector(struct rb_call *call, int number, struct rb_camera_def *def)
{
	struct rb_call entry = begin_entry(call, &arrows_table, number, 1), one;
	const struct rb_row row = row_for("vectors", &entry, number);
	struct rb_arrows_def arrows = {0};

	rb_call_read(&entry, &arrows);
	const int bodies = read_bodies(&entry, "bodies", arrows.bodies);
	if (bodies == 0)
		rb_call_mistake(&entry, "'bodies' must not be empty (without it: all)");
	arrows.body_count = bodies > 0 ? bodies : 0;
	push_value(&entry, 1, &one);
	const int kind = rb_call_choice(&one, &row, lua_absindex(call->L, -1));
	lua_pop(call->L, 1);
	if (kind < 0)
		return;
	if (def->vectors & 1u << kind)
		rb_call_mistake(&one, "there are such arrows already");
	def->vectors |= 1u << kind;
	def->arrows[kind] = arrows;
}

/* ---- diagrams ---- */

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
		rb_call_mistake(call, "the body of '%.60s' never moves", plot->name);
		return false;
	}
	for (int k = 0; dot && k < scene->body_count; k++) {
		const char *const name = scene->bodies[k].name;
		const int size = name ? snprintf(meant, sizeof meant, "%s%s", name, dot) : -1;

		if (size > 0 && size < (int)sizeof meant && rb_body_part_named(dot + 1) >= 0)
			rb_nearest_offer(&nearest, meant, (size_t)size);
	}
	rb_call_mistake(call,
	                "there is no probe or quantity '%.60s' so far%s "
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

	for (int i = 0; i < count; i++) {
		struct rb_plot_def *const plot = &def->plots[def->plot_count];
		struct rb_call one;

		*plot = (struct rb_plot_def){.at = {(double)NAN, (double)NAN},
		                             .size = {(double)NAN, (double)NAN}};
		lua_rawgeti(L, -1, i + 1);
		struct rb_call entry = begin_entry(call, &plot_table, i + 1, 1);
		rb_call_read(&entry, plot);
		push_value(&entry, 1, &one);
		if (lua_type(L, -1) != LUA_TSTRING)
			(void)rb_call_wrong(&one, &text_row, -1,
			                    "the name of a quantity, or {NAME, at = {x, y}, size = "
			                    "{w, h}}");
		else if (rb_call_value(&one, &text_row, -1, &plot->name))
			def->plot_count += find_quantity(&one, plot);
		lua_pop(L, 2);
	}
	if (count >= 0)
		lua_pop(L, 1);
}

void rb_marks_read(struct rb_call *call, struct rb_camera_def *def)
{
	const int trails = read_bodies(call, "trails", def->trails);

	def->trail_count = trails > 0 ? trails : 0;
	read_labels(call, def);
	read_one_or_list(call, "text", "texts", RB_CAMERA_TEXTS_MAX, read_caption, def);
	read_one_or_list(call, "vectors", "names", RB_VECTORS_COUNT, read_vector, def);
	read_plots(call, def);
}
