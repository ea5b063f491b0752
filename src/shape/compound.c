/* SPDX-License-Identifier: MIT */
/* Several shapes, rigidly joined: a solid of parts that the call makes of them (script/shapes). */
#include "shape/shape_types.h"

static const struct rb_row keys[] = {
	{"shapes", RB_ROW_LIST, 0, 0, RB_ROW_BY_HAND, NULL, "required", "",
         "a list of tables with the keys below"},
};

const struct rb_shape_type rb_shape_union = {
	.name = "union",
	.plural = "unions",
	.form = RB_FORM_UNION,
	.reads = RB_SHAPE_READS_SOLID,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
};
