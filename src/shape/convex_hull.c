/* SPDX-License-Identifier: MIT */
/*
 * The convex hull of points, stated or of a file: a solid that the call makes of them
 * (script/shapes).
 */
#include "shape/shape_types.h"

static const struct rb_row keys[] = {
	{"points", RB_ROW_LIST, 0, 0, RB_ROW_BY_HAND, NULL, "required, or file", "m",
         "{{x, y, z}, ...}, 4 to 65536, in object coordinates"},
	{"file", RB_ROW_TEXT, 0, 0, RB_ROW_BY_HAND, NULL, "none", "",
         "an STL or OBJ file in the scene's folder, whose corners are the points"},
	{"scale", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, RB_ROW_BY_HAND, NULL, "1", "",
         "multiplies the coordinates of the file: 0.001 for one in millimetres"},
};

const struct rb_shape_type rb_shape_hull = {
	.name = "hull",
	.plural = "hulls",
	.form = RB_FORM_POLYHEDRON,
	.reads = RB_SHAPE_READS_SOLID,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
	.is_part = true,
};
