/* SPDX-License-Identifier: MIT */
/*
 * A static surface of triangles, solid to both sides, without thickness: a solid that the call
 * makes of a file or a height (script/meshes).
 */
#include "shape/shape_types.h"

static const struct rb_row keys[] = {
	{"file", RB_ROW_TEXT, 0, 0, RB_ROW_BY_HAND, NULL, "required, or height", "",
         "an STL or OBJ file in the scene's folder, of at most 65536 triangles"},
	{"scale", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, RB_ROW_BY_HAND, NULL, "1", "",
         "multiplies the coordinates of the file: 0.001 for one in millimetres"},
	{"height", RB_ROW_FUNCTION, 0, 0, RB_ROW_BY_HAND, NULL, "none", "m",
         "function(x, y) that returns z, in object coordinates; with size and cells"},
	{"size", RB_ROW_NUMBERS, RB_RANGE_POSITIVE, 2, RB_ROW_BY_HAND, NULL, "required with height",
         "m", "{w, h}: x from -w/2 to w/2, y from -h/2 to h/2"},
	{"cells", RB_ROW_INTEGERS, RB_RANGE_COUNT, 2, RB_ROW_BY_HAND, NULL, "required with height",
         "",
         "{nx, ny}: of the grid, at whose corners the height is asked for; each is two triangles"},
};

const struct rb_shape_type rb_shape_terrain = {
	.name = "terrain",
	.plural = "terrains",
	.form = RB_FORM_POLYHEDRON,
	.reads = RB_SHAPE_READS_SOLID,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
};
