/* SPDX-License-Identifier: MIT */
/* src/method/method_table.c */
#include "model/descriptor.h"

#include "step/method_part.h"
#include "worlds.h"

static void every_kind_has_a_row_and_a_name_of_its_own(void **state)
{
	(void)state;
	for (int kind = 0; kind < RB_METHOD_KIND_COUNT; kind++) {
		const struct rb_method *const method = rb_methods[kind];

		assert_non_null(method);
		assert_int_equal(rb_method_find(method->name), kind);
		assert_string_equal(rb_method_name((enum rb_method_kind)kind), method->name);
		assert_true(*method->what && *method->good_for && *method->mind);
		assert_non_null(method->steps);
		assert_true(method->steps->prepare && method->steps->step && method->steps->pack);
		assert_true(!method->changes || method->locates);
	}
	assert_int_equal(rb_method_find("euler"), -1);
	assert_string_equal(rb_method_name((enum rb_method_kind)77), "unknown");
}

static void parts_have_names_of_their_own(void **state)
{
	(void)state;
	for (int kind = 0; kind < RB_METHOD_KIND_COUNT; kind++) {
		int count = 0;
		const struct rb_method_part *const part = rb_methods[kind]->parts
		                                                  ? rb_methods[kind]->parts(&count)
		                                                  : NULL;

		assert_true(!part || count > 3);
		for (int i = 0; i < count; i++)
			for (int j = 0; j < i; j++)
				assert_string_not_equal(part[i].name, part[j].name);
	}
}

/* Scenes and the command line choose from that text. */
static void the_text_of_choices_names_every_method_in_order(void **state)
{
	char text[256] = "";

	(void)state;
	for (int kind = 0; kind < RB_METHOD_KIND_COUNT; kind++) {
		strcat(text, kind > 0 ? ", " : "");
		strcat(text, rb_methods[kind]->name);
	}
	assert_string_equal(RB_METHOD_NAMES, text);
}

/* What a method lacks is refused by name: a row alone decides. */
static void a_method_refuses_what_its_row_says_that_it_lacks(void **state)
{
	(void)state;
	for (int kind = 0; kind < RB_METHOD_KIND_COUNT; kind++) {
		const struct rb_drag_def drag = {.linear = 1};
		struct rb_model *model = NULL;
		struct lab lab;

		lab_open(&lab, 1, 20);
		lab.scene.world.method = (enum rb_method_kind)kind;
		lab_sphere(&lab, 0.5, 1, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 0});
		assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
		const bool lacks = rb_methods[kind]->lacks & RB_FEATURE_DRAG;
		const enum rb_status status = rb_model_create(&model, &lab.scene, NULL, &lab.error);
		assert_int_equal(status, lacks ? RB_ERR_SCENE : RB_OK);
		if (lacks)
			assert_non_null(strstr(lab.error.text, rb_methods[kind]->name));
		rb_model_destroy(model);
		rb_scene_release(&lab.scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_kind_has_a_row_and_a_name_of_its_own),
		cmocka_unit_test(the_text_of_choices_names_every_method_in_order),
		cmocka_unit_test(parts_have_names_of_their_own),
		cmocka_unit_test(a_method_refuses_what_its_row_says_that_it_lacks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
