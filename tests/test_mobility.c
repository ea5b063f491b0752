/* SPDX-License-Identifier: MIT */
/* src/model/mobility.c: freedoms that joints leave, and rows that are redundant. */
#include "model/mobility.h"

#include "worlds.h"

static void add(struct lab *lab, enum rb_joint_kind kind, int a, int b, rb_vec3 at, rb_vec3 axis)
{
	struct rb_joint_def def = rb_joint_def_default();
	const bool has_axis = kind == RB_JOINT_HINGE || kind == RB_JOINT_SLIDER ||
	                      kind == RB_JOINT_CYLINDRICAL || kind == RB_JOINT_UNIVERSAL;

	def.kind = (int)kind;
	def.a = a;
	def.b = b;
	if (kind != RB_JOINT_ROD)
		def.at = at;
	if (has_axis)
		def.axis = axis;
	if (kind == RB_JOINT_UNIVERSAL)
		def.axis_b = rb_vec3_cross(axis, (rb_vec3){1, 2, 3});
	assert_int_equal(rb_scene_add_joint(&lab->scene, &def, NULL, &lab->error), RB_OK);
}

static void open_lab(struct lab *lab, int bodies)
{
	lab_open_located(lab, 1, 10);
	for (int k = 0; k < bodies; k++)
		lab_sphere(lab, 0.1, 1, (rb_vec3){k, 0, 0.1 * k * k}, (rb_vec3){0, 0, 0});
}

static struct rb_mobility seal(struct lab *lab)
{
	struct rb_mobility mobility;

	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
	assert_int_equal(rb_mobility_of(&mobility, lab->model, &lab->error), RB_OK);
	assert_true(mobility.counted);
	return mobility;
}

static void every_kind_leaves_what_it_says(void **state)
{
	static const int left[RB_JOINT_KIND_COUNT] = {0, 3, 1, 1, 2, 2, 5};

	(void)state;
	for (int kind = 0; kind < RB_JOINT_ROPE; kind++) {
		struct lab lab;

		open_lab(&lab, 2);
		lab.scene.bodies[0].angular_velocity = (rb_vec3){0, 0, 1}; /* so that it can turn */
		add(&lab, (enum rb_joint_kind)kind, 0, 1, (rb_vec3){0.4, 0.3, 0.2},
		    (rb_vec3){0, 1, 2});
		const struct rb_mobility mobility = seal(&lab);
		assert_int_equal(mobility.freedoms, 6 + left[kind]);
		assert_int_equal(mobility.redundant, 0);
		lab_close(&lab);
	}
}

/* In space a planar four-bar has three rows too many: 3 bodies, 4 hinges, one freedom is left. */
static void a_planar_four_bar_has_three_redundant_rows(void **state)
{
	const rb_vec3 y = {0, 1, 0};
	struct lab lab;

	(void)state;
	open_lab(&lab, 3);
	add(&lab, RB_JOINT_HINGE, 0, -1, (rb_vec3){0, 0, 0}, y);
	add(&lab, RB_JOINT_HINGE, 0, 1, (rb_vec3){0.2, 0, 1}, y);
	add(&lab, RB_JOINT_HINGE, 1, 2, (rb_vec3){1.7, 0, 1.3}, y);
	add(&lab, RB_JOINT_HINGE, 2, -1, (rb_vec3){2, 0, 0}, y);
	const struct rb_mobility mobility = seal(&lab);
	assert_int_equal(mobility.rows, 20);
	assert_int_equal(mobility.freedoms, 1);
	assert_int_equal(mobility.redundant, 3);
	lab_close(&lab);
}

/* Where nothing turns a body has three freedoms. */
static void rods_between_centres_leave_no_turning_to_count(void **state)
{
	struct lab lab;

	(void)state;
	open_lab(&lab, 2);
	lab.scene.materials[0].friction = 0;
	add(&lab, RB_JOINT_ROD, 0, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	const struct rb_mobility mobility = seal(&lab);
	assert_int_equal(mobility.freedoms,
	                 (lab.model->features & RB_FEATURE_ROTATION ? 12 : 6) - 1);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_kind_leaves_what_it_says),
		cmocka_unit_test(a_planar_four_bar_has_three_redundant_rows),
		cmocka_unit_test(rods_between_centres_leave_no_turning_to_count),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
