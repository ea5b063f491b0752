/* SPDX-License-Identifier: MIT */
/*
 * Every key that a scene can write, one row each: type, range, default, unit, help, and where its
 * value goes.
 *
 * Checks (script/fields), messages and the tables of rbsim-scene(5) all come from these rows; those
 * of shapes and of force elements stand with their types (shape/, force/).
 */
#ifndef RB_SCRIPT_ROWS_H
#define RB_SCRIPT_ROWS_H

#include <stdio.h>

#include "model/shape.h"

enum { RB_ROWS_MAX = 64 }; /* of a table and what it shares */

extern const struct rb_row_table rb_rows_world, rb_rows_gravitation, rb_rows_material,
	rb_rows_contact_pair, rb_rows_body, rb_rows_plane, rb_rows_force, rb_rows_particle,
	rb_rows_camera, rb_rows_film, rb_rows_units, rb_rows_light, rb_rows_record, rb_rows_param,
	rb_rows_field, rb_rows_measure, rb_rows_joint, rb_rows_motor;

/* What the rows of a body are read into. */
struct rb_body_given {
	struct rb_body_def def; /* of which `inertia` is not read */
	rb_mat3 inertia;
};

/* Keys of the call that makes bodies of one type: its own and those of all bodies. */
struct rb_row_table rb_rows_shape(const struct rb_shape_type *type);

/* Keys of an entry of a union's `shapes`: those of all types that may be parts, once each. */
enum { RB_PART_KEYS_MAX = 24 };
struct rb_part_rows {
	struct rb_row row[RB_PART_KEYS_MAX];
	int count;
	char choices[160], help[RB_PART_KEYS_MAX][160];
	struct rb_row_table table; /* of `row`, and of the keys that all parts have */
};
void rb_rows_part(struct rb_part_rows *rows); /* refers to itself: not to be copied */

/* NULL when there is no such key; *index (may be NULL) counts through `more`. */
const struct rb_row *rb_row_find(const struct rb_row_table *table, const char *key, int *index);

/* What a range asks for: "positive", "in [0, 1]"; "" for RB_RANGE_ANY. */
const char *rb_range_text(enum rb_row_range range);

/* Text of the k-th name in "a, b, c", not terminated: its size, or 0 beyond the last. */
size_t rb_choice_at(const char *choices, int k, const char **name);

/* All tables as the mdoc lists that rbsim-scene(5) has between its marks. */
void rb_fields_print(FILE *file);

#endif
