/* SPDX-License-Identifier: MIT */
/*
 * One function for each type of row. Each either writes the value and returns true, or notes one
 * mistake with what was wanted and what was found; it never raises an error. Comparisons are
 * written so that NAN is refused.
 */
#include "script/values.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "geom/mass.h"
#include "math/quat.h"
#include "script/disk.h"
#include "script/nearest.h"
#include "script/textures.h"
#include "script/vector.h"

/* Whether a number lies in a range; false for NAN. */
static bool in_range(enum rb_row_range range, double value)
{
	switch (range) {
	case RB_RANGE_POSITIVE: /* and not so small that its inverse is infinite */
		return value >= DBL_MIN;
	case RB_RANGE_NOT_NEGATIVE:
		return value >= 0;
	case RB_RANGE_UNIT:
		return value >= 0 && value <= 1;
	case RB_RANGE_SHARE:
		return value > 0 && value <= 1;
	case RB_RANGE_DIGIT:
		return value >= 0 && value <= 9;
	case RB_RANGE_PIXELS:
		return value >= 1 && value <= 16384;
	case RB_RANGE_SAMPLES:
		return value >= 1 && value <= 64;
	case RB_RANGE_COUNT:
		return value >= 1;
	case RB_RANGE_FOV:
		return value > 0 && value < 3.14159265358979323846;
	default:
		return true;
	}
}

/* "'KEY'" and what follows it; of an entry of a list, which the call's label names, "". */
static const char *named(const struct rb_row *row, const char *behind, char out[80])
{
	out[0] = '\0';
	if (*row->key)
		snprintf(out, 80, "'%s'%s", row->key, behind);
	return out;
}

bool rb_call_wrong(struct rb_call *call, const struct rb_row *row, int index, const char *wanted)
{
	char found[80], name[80];

	rb_call_mistake(call, "%smust be %s (got %s)", named(row, " ", name), wanted,
	                rb_describe(call->L, index, found));
	return false;
}

/* The same for a number that is not in the row's range. */
static bool out_of_range(struct rb_call *call, const struct rb_row *row, int index)
{
	const char *range = rb_range_text(row->range);
	char wanted[64];

	/* "must lie in [0, 1]", "must be positive" */
	if (strncmp(range, "in [", 4) == 0) {
		char found[80];
		rb_call_mistake(call, "'%s' must lie %s (got %s)", row->key, range,
		                rb_describe(call->L, index, found));
		return false;
	}
	/* a positive number may be too small */
	const bool tiny = row->range == RB_RANGE_POSITIVE && lua_tonumber(call->L, index) > 0;
	snprintf(wanted, sizeof wanted, "%s%s", range, tiny ? ", and not below 2.3e-308" : "");
	return rb_call_wrong(call, row, index, wanted);
}

static bool read_number(struct rb_call *call, const struct rb_row *row, int index, double *value)
{
	if (lua_type(call->L, index) != LUA_TNUMBER)
		return rb_call_wrong(call, row, index, "a number");
	const double number = lua_tonumber(call->L, index);
	if (!isfinite(number))
		return rb_call_wrong(call, row, index, "finite");
	if (!in_range(row->range, number))
		return out_of_range(call, row, index);
	*value = number;
	return true;
}

static bool read_integer(struct rb_call *call, const struct rb_row *row, int index, int *value)
{
	int whole = 0;
	const lua_Integer number = lua_tointegerx(call->L, index, &whole);

	if (lua_type(call->L, index) != LUA_TNUMBER || !whole)
		return rb_call_wrong(call, row, index, "a whole number");
	if (!in_range(row->range, (double)number))
		return out_of_range(call, row, index);
	if (number < INT32_MIN || number > INT32_MAX)
		return rb_call_wrong(call, row, index, "less than 2^31");
	*value = (int)number;
	return true;
}

static bool read_seed(struct rb_call *call, const struct rb_row *row, int index, uint64_t *value)
{
	int whole = 0;
	const lua_Integer number = lua_tointegerx(call->L, index, &whole);

	if (lua_type(call->L, index) != LUA_TNUMBER || !whole || number < 0)
		return rb_call_wrong(call, row, index, "a whole number, 0 or more");
	*value = (uint64_t)number;
	return true;
}

static bool read_boolean(struct rb_call *call, const struct rb_row *row, int index, bool *value)
{
	if (lua_type(call->L, index) != LUA_TBOOLEAN)
		return rb_call_wrong(call, row, index, "true or false");
	*value = lua_toboolean(call->L, index);
	return true;
}

static bool read_text(struct rb_call *call, const struct rb_row *row, int index, const char **value)
{
	size_t size;

	if (lua_type(call->L, index) != LUA_TSTRING)
		return rb_call_wrong(call, row, index, "a text");
	const char *text = lua_tolstring(call->L, index, &size);
	if (strlen(text) != size)
		return rb_call_wrong(call, row, index, "a text without zero bytes");
	*value = text;
	return true;
}

static bool read_file(struct rb_call *call, const struct rb_row *row, int index, const char **value)
{
	const char *path;

	if (!read_text(call, row, index, &path))
		return false;
	if (!call->script->sandbox.trust && !rb_disk_path_stays(path))
		return rb_call_wrong(call, row, index,
		                     "a path within the output folder (--trust lifts this)");
	*value = path;
	return true;
}

/* Whether a text is one of the choices. */
static bool is_choice(const char *choices, const char *text)
{
	const char *name;
	size_t size;

	for (int k = 0; (size = rb_choice_at(choices, k, &name)) > 0; k++)
		if (size == strlen(text) && memcmp(name, text, size) == 0)
			return true;
	return false;
}

/* A built-in pattern's name, or a PNG file beside the scene. */
static bool read_texture(struct rb_call *call, const struct rb_row *row, int index,
                         const char **value)
{
	const char *text;

	if (!read_text(call, row, index, &text))
		return false;
	if (is_choice(row->choices, text)) {
		*value = text;
		return true;
	}
	const char *dot = strrchr(text, '.');
	if (!dot || (strcmp(dot, ".png") != 0 && strcmp(dot, ".PNG") != 0)) {
		struct rb_nearest nearest = rb_nearest_to(text);
		char hint[96];
		const char *name;
		size_t size;
		for (int k = 0; (size = rb_choice_at(row->choices, k, &name)) > 0; k++)
			rb_nearest_offer(&nearest, name, size);
		rb_call_mistake(
			call,
			"'%s' must be one of %s, or a PNG file beside the scene (got '%.60s')%s",
			row->key, row->choices, text, rb_nearest_hint(&nearest, hint));
		return false;
	}
	if (!call->script->sandbox.trust && !rb_disk_path_stays(text))
		return rb_call_wrong(call, row, index,
		                     "a path within the scene's folder (--trust lifts this)");
	if (!rb_texture_take(call, row->key, text))
		return false;
	*value = text;
	return true;
}

/* A list of row->count finite numbers in range. */
static bool read_numbers(struct rb_call *call, const struct rb_row *row, int index, double *values)
{
	double numbers[16];
	char wanted[48];
	int found;

	RB_ASSERT(row->count > 0 && row->count <= 16);
	if (!rb_vector_numbers(call->L, index, row->count, numbers, &found)) {
		if (row->type == RB_ROW_VECTOR || row->type == RB_ROW_SOURCE)
			return rb_call_wrong(call, row, index,
			                     row->type == RB_ROW_SOURCE
			                             ? "a vector {x, y, z}, a body or a function"
			                             : "a vector {x, y, z}");
		snprintf(wanted, sizeof wanted, "a list of %d numbers", row->count);
		return rb_call_wrong(call, row, index, wanted);
	}
	for (int i = 0; i < row->count; i++) {
		if (!isfinite(numbers[i]))
			return rb_call_wrong(call, row, index, "finite");
		if (!in_range(row->range, numbers[i]))
			return out_of_range(call, row, index);
	}
	memcpy(values, numbers, (size_t)row->count * sizeof *values);
	return true;
}

/* A vector; with RB_RANGE_NOT_ZERO one with a length that can be made 1. */
static bool read_vector(struct rb_call *call, const struct rb_row *row, int index, rb_vec3 *value)
{
	struct rb_row three = *row;
	double numbers[3];

	three.count = 3;
	if (!read_numbers(call, &three, index, numbers))
		return false;
	const rb_vec3 v = rb_vec3_from(numbers);
	if (row->range == RB_RANGE_NOT_ZERO && !(rb_vec3_max_abs(v) >= DBL_MIN))
		return rb_call_wrong(call, row, index, "a vector with a length");
	*value = v;
	return true;
}

/* A list of whole numbers. */
static bool read_integers(struct rb_call *call, const struct rb_row *row, int index, int *values)
{
	double numbers[16];

	RB_ASSERT(row->count > 0 && row->count <= 16);
	if (!read_numbers(call, row, index, numbers))
		return false;
	for (int i = 0; i < row->count; i++)
		if (numbers[i] != floor(numbers[i]) || fabs(numbers[i]) > INT32_MAX)
			return rb_call_wrong(call, row, index, "whole numbers");
	for (int i = 0; i < row->count; i++)
		values[i] = (int)numbers[i];
	return true;
}

static bool read_orientation(struct rb_call *call, const struct rb_row *row, int index,
                             rb_quat *value)
{
	struct rb_turn_found found;
	const double *const n = found.numbers;

	switch (rb_vector_turn(call->L, index, value, &found)) {
	case RB_TURN_RIGHT:
		return true;
	case RB_TURN_NO_LIST:
		return rb_call_wrong(call, row, index,
		                     "{w, x, y, z} or {axis = {x, y, z}, angle = radians}");
	case RB_TURN_NOT_FINITE:
		if (!found.by_axis)
			return rb_call_wrong(call, row, index, "finite");
		rb_call_mistake(call,
		                "'%s': 'axis' and 'angle' must be finite (got {%.12g, %.12g, "
		                "%.12g} and %.12g)",
		                row->key, n[0], n[1], n[2], n[3]);
		return false;
	case RB_TURN_NOT_UNIT:
		rb_call_mistake(
			call,
			"'%s' must be a quaternion of length 1, within 1e-3 (got length %.12g)",
			row->key, rb_quat_length(rb_quat_from(n)));
		return false;
	case RB_TURN_NO_AXIS:
		rb_call_mistake(call, "'%s': 'axis' must have a length (got {0, 0, 0})", row->key);
		return false;
	}
	return false;
}

static int hex_digit(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
	                              : -1;
}

/* {r, g, b} in [0, 1] or "#rrggbb". */
static const char color_wanted[] = "a color {r, g, b} or '#rrggbb', like '#ff0000' for red";

static bool read_color(struct rb_call *call, const struct rb_row *row, int index, double *color)
{
	double values[3];

	if (lua_type(call->L, index) == LUA_TSTRING) {
		const char *text = lua_tostring(call->L, index);
		bool right = text[0] == '#' && strlen(text) == 7;
		for (int i = 0; right && i < 3; i++) {
			const int high = hex_digit(text[1 + 2 * i]),
				  low = hex_digit(text[2 + 2 * i]);
			right = high >= 0 && low >= 0;
			values[i] = (16 * high + low) / 255.0;
		}
		if (!right)
			return rb_call_wrong(call, row, index, color_wanted);
	} else if (!rb_vector_numbers(call->L, index, 3, values, NULL)) {
		return rb_call_wrong(call, row, index, color_wanted);
	}
	for (int i = 0; i < 3; i++)
		if (!(values[i] >= 0 && values[i] <= 1))
			return rb_call_wrong(call, row, index, "a color with parts in [0, 1]");
	memcpy(color, values, sizeof values);
	return true;
}

int rb_call_choice(struct rb_call *call, const struct rb_row *row, int index)
{
	struct rb_nearest nearest;
	const char *name;
	char hint[96], wanted[200], key[80];
	size_t size;

	if (lua_type(call->L, index) != LUA_TSTRING) {
		snprintf(wanted, sizeof wanted, "one of %s", row->choices);
		rb_call_wrong(call, row, index, wanted);
		return -1;
	}
	const char *text = lua_tostring(call->L, index);
	nearest = rb_nearest_to(text);
	for (int k = 0; (size = rb_choice_at(row->choices, k, &name)) > 0; k++) {
		if (size == strlen(text) && memcmp(name, text, size) == 0)
			return k;
		rb_nearest_offer(&nearest, name, size);
	}
	rb_call_mistake(call, "%smust be one of %s (got '%.60s')%s", named(row, " ", key),
	                row->choices, text, rb_nearest_hint(&nearest, hint));
	return -1;
}

bool rb_flags_add(lua_State *L, int index)
{
	if (lua_type(L, index) != LUA_TTABLE)
		return false;
	lua_rawgeti(L, index, 1);
	const bool adds = lua_type(L, -1) == LUA_TSTRING && strcmp(lua_tostring(L, -1), "+") == 0;
	lua_pop(L, 1);
	return adds;
}

/*
 * A text or a list of texts as bits by their place; a list that begins with "+" adds to the value
 * that is there.
 */
static bool read_flags(struct rb_call *call, const struct rb_row *row, int index, unsigned *value)
{
	lua_State *L = call->L;
	const bool adds = rb_flags_add(L, index);
	unsigned flags = adds ? *value : 0;

	if (lua_type(L, index) == LUA_TSTRING) {
		const int k = rb_call_choice(call, row, index);
		if (k >= 0)
			*value = 1u << k;
		return k >= 0;
	}
	const long long count = rb_list_length(L, index);
	if (count < 0 || count > 32)
		return rb_call_wrong(call, row, index, "a text or a list of texts");
	for (long long i = adds ? 2 : 1; i <= count; i++) {
		lua_rawgeti(L, index, i);
		const int k = rb_call_choice(call, row, lua_absindex(L, -1));
		lua_pop(L, 1);
		if (k < 0)
			return false;
		flags |= 1u << k;
	}
	*value = flags;
	return true;
}

int rb_call_material(struct rb_call *call, const char *key, int index)
{
	const struct rb_scene *scene = call->script->scene;
	const int *material = luaL_testudata(call->L, index, RB_MATERIAL_TYPE);
	char found[80], hint[96];

	if (material)
		return *material;
	if (lua_type(call->L, index) != LUA_TSTRING) {
		rb_call_mistake(call, "%s must be a material or the name of one (got %s)", key,
		                rb_describe(call->L, index, found));
		return -1;
	}
	const char *name = lua_tostring(call->L, index);
	struct rb_nearest nearest = rb_nearest_to(name);
	rb_sandbox_charge(call->L, (uint64_t)scene->material_count);
	for (int i = 0; i < scene->material_count; i++) {
		const char *candidate = scene->materials[i].name;
		if (candidate && strcmp(candidate, name) == 0)
			return i;
		if (candidate)
			rb_nearest_offer(&nearest, candidate, strlen(candidate));
	}
	rb_call_mistake(call, "%s: no material is named '%.60s' so far%s", key, name,
	                rb_nearest_hint(&nearest, hint));
	return -1;
}

int rb_body_named(lua_State *L, const char *name, char hint[96])
{
	const struct rb_scene *scene = rb_script_of(L)->scene;
	struct rb_nearest nearest = rb_nearest_to(name);

	rb_sandbox_charge(L, (uint64_t)scene->body_count);
	for (int i = 0; i < scene->body_count; i++) {
		const char *candidate = scene->bodies[i].name;
		if (candidate && strcmp(candidate, name) == 0)
			return i;
		if (candidate)
			rb_nearest_offer(&nearest, candidate, strlen(candidate));
	}
	rb_nearest_hint(&nearest, hint);
	return -1;
}

/* A body's handle, or the name of one that is there already. */
static bool read_body(struct rb_call *call, const struct rb_row *row, int index, int *value)
{
	int id = rb_handle_id(call->L, index);
	char hint[96], key[80];

	if (id < 0 && lua_type(call->L, index) != LUA_TSTRING)
		return rb_call_wrong(call, row, index, "a body or the name of one");
	if (id < 0) {
		const char *name = lua_tostring(call->L, index);
		id = rb_body_named(call->L, name, hint);
		if (id < 0) {
			rb_call_mistake(call, "%sno body is named '%.60s' so far%s",
			                named(row, ": ", key), name, hint);
			return false;
		}
	}
	*value = id;
	return true;
}

/* A function, kept under a number. */
static bool read_function(struct rb_call *call, const struct rb_row *row, int index, int *value)
{
	if (lua_type(call->L, index) != LUA_TFUNCTION)
		return rb_call_wrong(call, row, index, "a function");
	*value = rb_script_keep_function(call->L, index);
	return true;
}

/* A vector of a camera: fixed, a body, or a function of time. */
static bool read_source(struct rb_call *call, const struct rb_row *row, int index,
                        struct rb_camera_vector *value)
{
	struct rb_camera_vector source = {.body = -1, .function = -1};

	if (lua_type(call->L, index) == LUA_TFUNCTION) {
		source.source = RB_CAMERA_FUNCTION;
		source.function = rb_script_keep_function(call->L, index);
	} else if (rb_handle_id(call->L, index) >= 0) {
		source.source = RB_CAMERA_BODY;
		source.body = rb_handle_id(call->L, index);
	} else if (!read_vector(call, row, index, &source.value)) {
		return false;
	}
	*value = source;
	return true;
}

/* Three principal moments, or a whole matrix, kg m^2, that a body can have. */
static bool read_inertia(struct rb_call *call, const struct rb_row *row, int index, rb_mat3 *value)
{
	static const char wanted[] = "{Ix, Iy, Iz} or three rows of three numbers";
	lua_State *L = call->L;
	double d[3];
	char found[80];
	rb_mat3 m = {{{0}}};

	if (rb_vector_numbers(L, index, 3, d, NULL)) {
		for (int i = 0; i < 3; i++) {
			if (!isfinite(d[i]))
				return rb_call_wrong(call, row, index, "finite");
			if (!(d[i] >= DBL_MIN))
				return rb_call_wrong(call, row, index, "positive");
			m.m[i][i] = d[i];
		}
	} else {
		if (rb_list_length(L, index) != 3)
			return rb_call_wrong(call, row, index, wanted);
		for (int i = 0; i < 3; i++) {
			lua_rawgeti(L, index, i + 1);
			const bool right = rb_vector_numbers(L, -1, 3, m.m[i], NULL);
			lua_pop(L, 1);
			if (!right)
				return rb_call_wrong(call, row, index, wanted);
			for (int j = 0; j < 3; j++)
				if (!isfinite(m.m[i][j]))
					return rb_call_wrong(call, row, index, "finite");
		}
	}
	const char *fault = rb_inertia_fault(&m);
	if (fault) {
		rb_call_mistake(call, "'%s' %s (got %s)", row->key, fault,
		                rb_describe(L, index, found));
		return false;
	}
	*value = m;
	return true;
}

bool rb_call_value(struct rb_call *call, const struct rb_row *row, int index, void *place)
{
	int k;

	RB_ASSERT(row && place);
	index = lua_absindex(call->L, index);
	switch (row->type) {
	case RB_ROW_NUMBER:
		return read_number(call, row, index, place);
	case RB_ROW_INTEGER:
		return read_integer(call, row, index, place);
	case RB_ROW_SEED:
		return read_seed(call, row, index, place);
	case RB_ROW_BOOLEAN:
		return read_boolean(call, row, index, place);
	case RB_ROW_TEXT:
		return read_text(call, row, index, place);
	case RB_ROW_FILE:
		return read_file(call, row, index, place);
	case RB_ROW_TEXTURE:
		return read_texture(call, row, index, place);
	case RB_ROW_VECTOR:
		return read_vector(call, row, index, place);
	case RB_ROW_NUMBERS:
		return read_numbers(call, row, index, place);
	case RB_ROW_INTEGERS:
		return read_integers(call, row, index, place);
	case RB_ROW_ORIENTATION:
		return read_orientation(call, row, index, place);
	case RB_ROW_COLOR:
		return read_color(call, row, index, place);
	case RB_ROW_CHOICE:
		k = rb_call_choice(call, row, index);
		if (k >= 0)
			memcpy(place, &k, sizeof k);
		return k >= 0;
	case RB_ROW_SWITCH:
		k = rb_call_choice(call, row, index);
		if (k >= 0)
			*(bool *)place = k == 1;
		return k >= 0;
	case RB_ROW_FLAGS:
		return read_flags(call, row, index, place);
	case RB_ROW_MATERIAL:
		k = rb_call_material(call, "'material'", index);
		if (k >= 0)
			*(int *)place = k;
		return k >= 0;
	case RB_ROW_BODY:
		return read_body(call, row, index, place);
	case RB_ROW_FUNCTION:
		return read_function(call, row, index, place);
	case RB_ROW_SOURCE:
		return read_source(call, row, index, place);
	case RB_ROW_INERTIA:
		return read_inertia(call, row, index, place);
	default:
		return true;
	}
}
