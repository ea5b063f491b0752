/* SPDX-License-Identifier: MIT */
/*
 * Every key that a scene can write, one row each: type, range, default, unit, help, and where its
 * value goes.
 *
 * Checks (script/fields), messages and the tables of rbsim-scene(5) all come from these rows; those
 * of force elements stand with their kinds (force/).
 */
#ifndef RB_SCRIPT_ROWS_H
#define RB_SCRIPT_ROWS_H

#include <stdio.h>

#include "model/scene_keys.h"

enum { RB_ROWS_MAX = 64 }; /* of a table and what it shares */

extern const struct rb_row_table rb_rows_world, rb_rows_material, rb_rows_contact_pair,
	rb_rows_body, rb_rows_sphere, rb_rows_plane, rb_rows_box, rb_rows_capsule, rb_rows_cylinder,
	rb_rows_hull, rb_rows_union, rb_rows_part, rb_rows_force, rb_rows_particle, rb_rows_camera,
	rb_rows_light, rb_rows_record, rb_rows_param;

/* NULL when there is no such key; *index (may be NULL) counts through `more`. */
const struct rb_row *rb_row_find(const struct rb_row_table *table, const char *key, int *index);

/* What a range asks for: "positive", "in [0, 1]"; "" for RB_RANGE_ANY. */
const char *rb_range_text(enum rb_row_range range);

/* Text of the k-th name in "a, b, c", not terminated: its size, or 0 beyond the last. */
size_t rb_choice_at(const char *choices, int k, const char **name);

/* All tables as the mdoc lists that rbsim-scene(5) has between its marks. */
void rb_fields_print(FILE *file);

#endif
