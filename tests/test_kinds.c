/* SPDX-License-Identifier: MIT */
/* src/force/kinds.c: all kinds of force elements */
#include "worlds.h"

#include "model/element.h"

static void every_kind_has_a_name_a_place_and_keys_of_its_own(void **state)
{
	(void)state;
	assert_in_range(rb_element_kind_count, 2, RB_ELEMENT_KINDS_MAX);
	for (int k = 0; k < rb_element_kind_count; k++) {
		const struct rb_element_kind *const kind = rb_element_kinds[k];

		assert_int_equal(rb_element_place(kind), k);
		assert_true(*kind->name && *kind->plural && kind->feature && kind->act);
		assert_string_equal(kind->keys.name, kind->name);
		assert_in_range(kind->row_size, 1, RB_ELEMENT_ROW_MAX);
		assert_true(kind->line_at + sizeof(int) <= kind->row_size);
		assert_non_null(kind->defaults);
		/* a damper of one without ends has no body to take from; what gives back is no drag */
		assert_true(!kind->dissipation || kind->ends);
		assert_true(!kind->is_drag || !kind->energy);
		for (int j = 0; j < k; j++)
			assert_string_not_equal(rb_element_kinds[j]->name, kind->name);
	}
}

static void keys_lie_within_the_row_and_do_not_overlap(void **state)
{
	(void)state;
	for (int k = 0; k < rb_element_kind_count; k++) {
		const struct rb_element_kind *const kind = rb_element_kinds[k];

		for (int i = 0; i < kind->keys.count; i++) {
			const struct rb_row *const row = &kind->keys.rows[i];

			assert_true(*row->key && row->help);
			if (row->at == RB_ROW_BY_HAND)
				continue;
			assert_true(row->at < kind->row_size);
			assert_true(row->at != kind->line_at);
			for (int j = 0; j < i; j++) {
				assert_string_not_equal(kind->keys.rows[j].key, row->key);
				assert_true(kind->keys.rows[j].at != row->at);
			}
		}
	}
}

static void defaults_are_a_row_without_a_line(void **state)
{
	(void)state;
	for (int k = 0; k < rb_element_kind_count; k++) {
		int line = -1;

		memcpy(&line,
		       (const char *)rb_element_kinds[k]->defaults + rb_element_kinds[k]->line_at,
		       sizeof line);
		assert_int_equal(line, 0);
	}
}

static void elements_of_a_scene_are_counted_by_kind(void **state)
{
	const struct rb_drag_def drag = {.linear = 1};
	int counts[RB_ELEMENT_KINDS_MAX];
	struct rb_spring_def spring = rb_spring_def_default();
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	spring.a = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	spring.b = lab_sphere(&lab, 0.1, 1, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
	for (int i = 0; i < 3; i++)
		assert_int_equal(rb_scene_add_spring(&lab.scene, &spring, &lab.error), RB_OK);
	assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
	rb_scene_count_elements(&lab.scene, counts);
	for (int k = 0; k < rb_element_kind_count; k++) {
		const bool springs = strcmp(rb_element_kinds[k]->name, "spring") == 0;

		assert_int_equal(counts[k], springs ? 3 : 1);
		assert_int_equal(rb_scene_element_count(&lab.scene, rb_element_kinds[k]),
		                 counts[k]);
	}
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_kind_has_a_name_a_place_and_keys_of_its_own),
		cmocka_unit_test(keys_lie_within_the_row_and_do_not_overlap),
		cmocka_unit_test(defaults_are_a_row_without_a_line),
		cmocka_unit_test(elements_of_a_scene_are_counted_by_kind),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
