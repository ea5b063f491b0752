/* SPDX-License-Identifier: MIT */
/* src/script/rows.c: every key of the scene language has its own place, text and default */
#include "support.h"

#include <rbsim/scene.h>

#include "model/element.h"
#include "model/shape.h"
#include "script/rows.h"

static const struct {
	const struct rb_row_table *table;
	size_t size;
} tables[] = {
	{&rb_rows_world, sizeof(struct rb_world_def)},
	{&rb_rows_gravitation, sizeof(struct rb_gravitation_def)},
	{&rb_rows_material, sizeof(struct rb_material_def)},
	{&rb_rows_contact_pair, sizeof(struct rb_contact_pair_def)},
	{&rb_rows_body, sizeof(struct rb_body_given)},
	{&rb_rows_plane, sizeof(struct rb_body_given)},
	{&rb_rows_force, sizeof(struct rb_force_def)},
	{&rb_rows_particle, sizeof(double) + sizeof(rb_vec3)},
	{&rb_rows_camera, sizeof(struct rb_camera_def)},
	{&rb_rows_film, sizeof(struct rb_camera_def)},
	{&rb_rows_units, sizeof(struct rb_camera_def)},
	{&rb_rows_light, sizeof(struct rb_light_def)},
	{&rb_rows_record, sizeof(struct rb_record_def)},
	{&rb_rows_param, sizeof(struct rb_param_def)},
	{&rb_rows_measure, sizeof(struct rb_measure_def)},
	{&rb_rows_joint, sizeof(struct rb_joint_def)},
	{&rb_rows_motor, sizeof(struct rb_joint_def)},
	{&rb_rows_field, sizeof(struct rb_field_def)},
};
enum { TABLES = sizeof tables / sizeof *tables };

/* What a value of the row takes in the definition, by the comments of enum rb_row_type. */
static size_t size_of(const struct rb_row *row)
{
	switch (row->type) {
	case RB_ROW_NUMBER:
		return sizeof(double);
	case RB_ROW_SEED:
		return sizeof(uint64_t);
	case RB_ROW_BOOLEAN:
	case RB_ROW_SWITCH:
		return sizeof(bool);
	case RB_ROW_TEXT:
	case RB_ROW_FILE:
	case RB_ROW_TEXTURE:
		return sizeof(char *);
	case RB_ROW_VECTOR:
		return sizeof(rb_vec3);
	case RB_ROW_NUMBERS:
		return (size_t)row->count * sizeof(double);
	case RB_ROW_INTEGERS:
		return (size_t)row->count * sizeof(int);
	case RB_ROW_ORIENTATION:
		return sizeof(rb_quat);
	case RB_ROW_COLOR:
		return 3 * sizeof(double);
	case RB_ROW_SOURCE:
		return sizeof(struct rb_camera_vector);
	case RB_ROW_INERTIA:
		return sizeof(rb_mat3);
	default:
		return sizeof(int);
	}
}

/* The k-th key of a table and of those that it shares; NULL beyond the last. */
static const struct rb_row *row_at(const struct rb_row_table *table, int k)
{
	while (table && k >= table->count) {
		k -= table->count;
		table = table->more;
	}
	return table ? &table->rows[k] : NULL;
}

static void check_texts(const struct rb_row_table *table)
{
	const struct rb_row *row;
	int k = 0;

	for (; (row = row_at(table, k)); k++) {
		int index = -1;

		assert_ptr_equal(rb_row_find(table, row->key, &index), row); /* no name twice */
		assert_int_equal(index, k);
		assert_true(*row->key &&
		            strspn(row->key, "abcdefghijklmnopqrstuvwxyz_G") == strlen(row->key));
		assert_non_null(row->fallback);
		assert_true(*row->fallback);
		assert_non_null(row->unit);
		assert_non_null(row->help);
		assert_in_range(row->type, 0, RB_ROW_TYPE_COUNT - 1);
		assert_in_range(row->range, 0, RB_RANGE_KIND_COUNT - 1);
		if (row->type == RB_ROW_CHOICE || row->type == RB_ROW_SWITCH ||
		    row->type == RB_ROW_FLAGS)
			assert_non_null(row->choices);
		if (row->type == RB_ROW_LIST || row->type == RB_ROW_NAMES ||
		    row->type == RB_ROW_TABLE)
			assert_true(row->at == RB_ROW_BY_HAND);
		assert_int_equal(row->count > 0,
		                 row->type == RB_ROW_NUMBERS || row->type == RB_ROW_INTEGERS);
	}
	assert_in_range(k, 1, RB_ROWS_MAX);
	assert_null(rb_row_find(table, "no such key", NULL));
	assert_null(rb_row_find(table, "", NULL));
}

static void every_key_of_a_call_is_there_once_with_its_texts(void **state)
{
	(void)state;
	for (int t = 0; t < TABLES; t++)
		check_texts(tables[t].table);
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		const struct rb_row_table table = rb_rows_shape(rb_shape_types[k]);

		assert_string_equal(table.name, rb_shape_types[k]->name);
		assert_ptr_equal(table.more, &rb_rows_body);
		check_texts(&table);
	}
	for (int k = 0; k < rb_element_kind_count; k++)
		check_texts(&rb_element_kinds[k]->keys);
}

/*
 * Only what stands in place of another key shares its place: a sun's direction, a lamp's position;
 * the way and force of a slider's motor, angle and torque of a hinge's.
 */
static void no_two_keys_write_to_one_place(void **state)
{
	(void)state;
	for (int t = 0; t < TABLES; t++) {
		const struct rb_row *a, *b;

		for (int i = 0; (a = row_at(tables[t].table, i)); i++) {
			if (a->at == RB_ROW_BY_HAND)
				continue;
			assert_true(a->at + size_of(a) <= tables[t].size);
			for (int j = 0; j < i; j++) {
				b = row_at(tables[t].table, j);
				if (b->at == RB_ROW_BY_HAND || strcmp(a->key, "direction") == 0 ||
				    (tables[t].table == &rb_rows_motor && a->at == b->at))
					continue;
				if (a->at < b->at + size_of(b) && b->at < a->at + size_of(a))
					fail_msg("%s: '%s' and '%s' share bytes",
					         tables[t].table->name, a->key, b->key);
			}
		}
	}
}

static void assert_choices(const struct rb_row_table *table, const char *key, int count,
                           const char *const *names)
{
	const struct rb_row *row = rb_row_find(table, key, NULL);
	const char *name;

	assert_non_null(row);
	for (int k = 0; k < count; k++) {
		const size_t size = rb_choice_at(row->choices, k, &name);

		assert_int_equal(size, strlen(names[k]));
		assert_memory_equal(name, names[k], size);
	}
	assert_int_equal(rb_choice_at(row->choices, count, &name), 0);
	assert_string_equal(name, "");
}

/* The number of a choice is that of the enum of rbsim/scene.h. */
static void choices_stand_in_the_order_of_their_numbers(void **state)
{
	static const char *const rollbacks[] = {[RB_ROLLBACK_SELECTIVE] = "selective",
	                                        [RB_ROLLBACK_GLOBAL] = "global",
	                                        [RB_ROLLBACK_NONE] = "none"};
	static const char *const methods[] = {[RB_METHOD_AUTO] = "auto",
	                                      [RB_METHOD_CLASSIC] = "classic",
	                                      [RB_METHOD_LOCATED] = "located",
	                                      [RB_METHOD_STEPPED] = "stepped"};
	static const char *const frames[] = {[RB_FORCE_WORLD] = "world", [RB_FORCE_BODY] = "body"};
	static const char *const lights[] = {[RB_LIGHT_LAMP] = "lamp",
	                                     [RB_LIGHT_SUN] = "sun",
	                                     [RB_LIGHT_SPOT] = "spot",
	                                     [RB_LIGHT_AMBIENT] = "ambient"};
	static const char *const fields[] = {
		"position", "orientation", "velocity",     "angular_velocity",
		"contacts", "events",      "acceleration", "angular_acceleration",
		"force",    "torque",      "joints",       "surfaces"};
	static const char *const joints[] = {
		[RB_JOINT_FIXED] = "fixed", [RB_JOINT_BALL] = "ball",
		[RB_JOINT_HINGE] = "hinge", [RB_JOINT_SLIDER] = "slider",
		[RB_JOINT_ROD] = "rod",     [RB_JOINT_CYLINDRICAL] = "cylindrical",
		[RB_JOINT_ROPE] = "rope",   [RB_JOINT_UNIVERSAL] = "universal"};
	static const char *const overlays[] = {"time", "title", "energy", "scale"};

	(void)state;
	assert_choices(&rb_rows_world, "rollback", 3, rollbacks);
	assert_choices(&rb_rows_world, "method", 4, methods);
	assert_choices(&rb_rows_force, "frame", 2, frames);
	assert_choices(&rb_rows_light, "kind", 4, lights);
	assert_choices(&rb_rows_record, "fields", 12, fields);
	assert_choices(&rb_rows_joint, "kind", RB_JOINT_KIND_COUNT, joints);
	for (int k = 0; k < RB_JOINT_KIND_COUNT; k++)
		assert_string_equal(rb_joint_kind_name(k), joints[k]);
	assert_choices(&rb_rows_camera, "overlay", 4, overlays);
	assert_int_equal(RB_FIELD_EVENTS, 1 << 5);
	assert_int_equal(RB_FIELD_TORQUE, 1 << 9);
	assert_int_equal(RB_FIELD_JOINTS, 1 << 10);
	assert_int_equal(RB_FIELD_SURFACES, 1 << 11);
	assert_int_equal(RB_OVERLAY_ENERGY, 1 << 2);
	assert_int_equal(RB_OVERLAY_SCALE, 1 << 3);
}

static void choices_are_read_with_and_without_blanks(void **state)
{
	const char *name = NULL;

	(void)state;
	assert_int_equal(rb_choice_at("a,bc,  d", 1, &name), 2);
	assert_memory_equal(name, "bc", 2);
	assert_int_equal(rb_choice_at("a,bc,  d", 2, &name), 1);
	assert_string_equal(name, "d");
	assert_int_equal(rb_choice_at("a,bc,  d", 3, &name), 0);
	assert_int_equal(rb_choice_at("", 0, &name), 0);
	assert_int_equal(rb_choice_at(NULL, 0, &name), 0);
	assert_string_equal(name, "");
}

static void every_range_has_a_text_of_its_own(void **state)
{
	(void)state;
	assert_string_equal(rb_range_text(RB_RANGE_ANY), "");
	for (int i = 1; i < RB_RANGE_KIND_COUNT; i++) {
		const char *text = rb_range_text((enum rb_row_range)i);

		assert_non_null(text);
		for (int k = 0; k < i; k++)
			assert_string_not_equal(text, rb_range_text((enum rb_row_range)k));
	}
}

static void an_entry_of_a_union_has_the_keys_of_all_that_may_be_parts(void **state)
{
	struct rb_part_rows part;

	(void)state;
	memset(&part, 0x5a, sizeof part);
	rb_rows_part(&part);
	check_texts(&part.table);
	assert_string_equal(part.row[0].key, "shape");
	for (int k = 0, at = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		const struct rb_shape_type *type = rb_shape_types[k];
		const char *name;
		const size_t size = rb_choice_at(part.choices, at, &name);
		const bool chosen = size == strlen(type->name) && !memcmp(name, type->name, size);

		assert_int_equal(chosen, type->is_part);
		at += chosen;
		for (int i = 0; i < type->key_count && type->is_part; i++) {
			const struct rb_row *row = rb_row_find(&part.table, type->key[i].key, NULL);

			assert_non_null(row);
			assert_non_null(strstr(row->help, type->name));
			assert_int_equal(row->at, type->key[i].at);
		}
	}
	/* a union of unions there is not, and surfaces have no volume */
	assert_null(strstr(part.choices, rb_shape_types[RB_SHAPE_UNION]->name));
	assert_null(strstr(part.choices, rb_shape_types[RB_SHAPE_PLANE]->name));
	for (int i = 0; i < 3; i++) {
		static const char *const keys[] = {"position", "orientation", "density"};
		assert_non_null(rb_row_find(&part.table, keys[i], NULL));
	}
	assert_null(rb_row_find(&part.table, "velocity", NULL));
}

/* Between its first line and its last each table has an item for each of its keys. */
static void all_tables_are_printed_whole(void **state)
{
	char *text = NULL, table[64] = "", key[64];
	size_t size;
	int count = 0, items = 0, printed = 0;
	FILE *file = open_memstream(&text, &size);

	(void)state;
	assert_non_null(file);
	rb_fields_print(file);
	fclose(file);
	for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
		*end = '\0';
		if (sscanf(line, ".\\\" table %63s", table) == 1)
			printed++;
		else if (sscanf(line, ".It Ic %63s", key) == 1)
			items++;
		else if (strcmp(line, ".El") == 0)
			count++;
		else
			assert_true(line[0] != '.' || strncmp(line, ".Bl", 3) == 0 ||
			            strcmp(line, ".\\\" end") == 0);
	}
	assert_int_equal(count, printed);
	int wanted = 0, wanted_tables = TABLES;
	for (int t = 0; t < TABLES; t++)
		wanted += tables[t].table->count;
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		wanted += rb_shape_types[k]->key_count;
		wanted_tables += rb_shape_types[k]->key_count > 0;
	}
	for (int k = 0; k < rb_element_kind_count; k++)
		wanted += rb_element_kinds[k]->keys.count;
	struct rb_part_rows part;
	rb_rows_part(&part);
	int parts = 0;
	while (row_at(&part.table, parts))
		parts++;
	assert_int_equal(items, wanted + parts);
	assert_int_equal(printed, wanted_tables + 1 + rb_element_kind_count);
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_key_of_a_call_is_there_once_with_its_texts),
		cmocka_unit_test(no_two_keys_write_to_one_place),
		cmocka_unit_test(choices_stand_in_the_order_of_their_numbers),
		cmocka_unit_test(choices_are_read_with_and_without_blanks),
		cmocka_unit_test(every_range_has_a_text_of_its_own),
		cmocka_unit_test(an_entry_of_a_union_has_the_keys_of_all_that_may_be_parts),
		cmocka_unit_test(all_tables_are_printed_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
