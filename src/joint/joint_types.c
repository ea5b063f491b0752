/* SPDX-License-Identifier: MIT */
/*
 * The table of joint kinds in the order of enum rb_joint_kind, whose numbers recordings keep, from
 * one list of names.
 */
#include "joint/joint_types.h"

#include <stdio.h>

#define ROW(kind, name) [RB_JOINT_##kind] = &rb_joint_type_##name,
const struct rb_joint_type *const rb_joint_types[RB_JOINT_KIND_COUNT] = {RB_JOINT_TYPES(ROW)};

const struct rb_coordinate_words rb_coordinate_words[] = {
	[RB_COORDINATE_ANGLE] = {"angle", "torque", "rad/s"},
	[RB_COORDINATE_WAY] = {"way", "force", "m/s"},
	[RB_COORDINATE_LENGTH] = {"length", NULL, "m/s"},
};

/* ---- which kinds have a key, by their rows ---- */

static bool has_axis(int kind)
{
	return rb_joint_type(kind)->has_axis;
}

static bool has_axis_b(int kind)
{
	return rb_joint_type(kind)->has_axis_b;
}

static bool is_centered(int kind)
{
	return rb_joint_type(kind)->is_centered;
}

static bool has_impacts(int kind)
{
	return rb_joint_is_free(kind) || rb_joint_type(kind)->linkage.one_sided;
}

static bool has_point(int kind)
{
	return !rb_joint_is_line(kind);
}

const struct rb_joint_key rb_joint_keys[] = {
	{"at", has_point, is_centered, false},        {"axis", has_axis, has_axis, true},
	{"axis_b", has_axis_b, has_axis_b, true},     {"length", rb_joint_is_line, NULL, false},
	{"limits", rb_joint_is_free, NULL, false},    {"restitution", has_impacts, NULL, false},
	{"friction", rb_joint_is_free, NULL, false},  {"motor", rb_joint_is_free, NULL, false},
	{"stiffness", rb_joint_is_free, NULL, false}, {"damping", rb_joint_is_free, NULL, false},
	{"rest", rb_joint_is_free, NULL, false},
};
const int rb_joint_key_count = sizeof rb_joint_keys / sizeof *rb_joint_keys;

int rb_joint_list_kinds(bool (*has)(int kind), const char *last, char out[RB_JOINT_KINDS_SIZE])
{
	size_t used = 0;
	int count = 0, left = 0;

	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++)
		left += has(kind);
	out[0] = '\0';
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		if (!has(kind))
			continue;
		const char *const before = count == 0 ? "" : left == 1 ? last : ", ";

		used += (size_t)snprintf(out + used, RB_JOINT_KINDS_SIZE - used, "%s%s", before,
		                         rb_joint_type(kind)->name);
		RB_ASSERT(used < RB_JOINT_KINDS_SIZE);
		count++;
		left--;
	}
	return count;
}
