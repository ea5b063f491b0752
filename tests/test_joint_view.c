/* SPDX-License-Identifier: MIT */
/* src/flow/joint_view.c: where joints are in a frame. */
#include "flow/joint_view.h"

#include "flow/frame.h"
#include "math/quat.h"
#include "worlds.h"

static struct rb_joint_def def_of(enum rb_joint_kind kind, int a, int b)
{
	struct rb_joint_def def = rb_joint_def_default();

	def.kind = (int)kind;
	def.a = a;
	def.b = b;
	return def;
}

static void add(struct lab *lab, const struct rb_joint_def *def)
{
	assert_int_equal(rb_scene_add_joint(&lab->scene, def, NULL, &lab->error), RB_OK);
}

/* Two balls on a rod, and one on a hinge of the world. */
static void open_lab(struct lab *lab, struct rb_frame *frame)
{
	const rb_vec3 none = {0, 0, 0};

	lab_open_located(lab, 1, 10);
	lab_sphere(lab, 0.1, 1, (rb_vec3){1, 0, 0}, none);
	lab_sphere(lab, 0.2, 1, (rb_vec3){3, 0, 0}, none);
	lab_sphere(lab, 0.1, 1, (rb_vec3){0, 5, 0}, none);
	struct rb_joint_def def = def_of(RB_JOINT_ROD, 0, 1);
	add(lab, &def);
	def = def_of(RB_JOINT_HINGE, 2, -1);
	def.at = (rb_vec3){1, 5, 0};
	def.axis = (rb_vec3){0, 0, 3};
	add(lab, &def);
	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
	assert_int_equal(rb_frame_init(frame, lab->model, RB_FIELD_DEFAULT, &lab->error), RB_OK);
	for (int i = 0; i < lab->model->body_count; i++) {
		rb_vec3_to(frame->position + 3 * i, lab->model->position[i]);
		rb_quat_to(frame->orientation + 4 * i, lab->model->orientation[i]);
	}
}

static void points_move_with_their_bodies(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_joint_place place;

	(void)state;
	open_lab(&lab, &frame);
	assert_true(rb_joint_place(lab.model, &frame, 0, &place));
	assert_vector(place.a, ((rb_vec3){1, 0, 0}), 1e-15);
	assert_vector(place.b, ((rb_vec3){3, 0, 0}), 1e-15);
	rb_vec3_to(frame.position + 3, (rb_vec3){1, 2, 0});
	assert_true(rb_joint_place(lab.model, &frame, 0, &place));
	assert_vector(place.b, ((rb_vec3){1, 2, 0}), 1e-15);
	assert_true(rb_joint_place(lab.model, &frame, 1, &place));
	assert_vector(place.a, ((rb_vec3){1, 5, 0}), 1e-15);
	assert_vector(place.axis_a, ((rb_vec3){0, 0, 1}), 1e-15);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void a_joint_whose_points_are_apart_is_not_seen(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_joint_place place;

	(void)state;
	open_lab(&lab, &frame);
	rb_vec3_to(frame.position + 3, (rb_vec3){3.5, 0, 0});
	assert_false(rb_joint_place(lab.model, &frame, 0, &place));
	rb_vec3_to(frame.position + 6, (rb_vec3){0, 5.5, 0});
	assert_false(rb_joint_place(lab.model, &frame, 1, &place));
	rb_vec3_to(frame.position + 6, (rb_vec3){0, 5, 0});
	assert_true(rb_joint_place(lab.model, &frame, 1, &place));
	lab.scene.joints[1].visible = false;
	assert_false(rb_joint_place(lab.model, &frame, 1, &place));
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void what_is_drawn_is_thinner_than_the_bodies_unless_stated(void **state)
{
	struct lab lab;
	struct rb_frame frame;

	(void)state;
	open_lab(&lab, &frame);
	assert_true(rb_joint_radius(lab.model, 0) > 0 && rb_joint_radius(lab.model, 0) < 0.1);
	assert_true(rb_joint_radius(lab.model, 1) > 0 && rb_joint_radius(lab.model, 1) < 0.1);
	lab.scene.joints[0].radius_m = 0.3;
	assert_true(rb_joint_radius(lab.model, 0) == 0.3);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static double length_of(const rb_vec3 point[RB_ROPE_PIECES + 1])
{
	double length = 0;

	for (int k = 0; k < RB_ROPE_PIECES; k++)
		length += rb_vec3_length(rb_vec3_sub(point[k + 1], point[k]));
	return length;
}

/* To the forty halvings of its sag: 2^-40 of the length, and slopes of at most 4. */
static void a_slack_rope_has_its_length_and_hangs_down(void **state)
{
	static const rb_vec3 ends[] = {{1, 0, 0}, {0.3, 0.2, 0.5}, {0, 0, 1}};
	const struct rb_joint_place taut = {.a = {0, 0, 0}, .b = {2, 0, 0}};
	rb_vec3 point[RB_ROPE_PIECES + 1];

	(void)state;
	for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
		const struct rb_joint_place place = {.a = {0, 0, 0}, .b = ends[k]};

		rb_joint_rope(&place, 2, (rb_vec3){0, 0, -9.81}, point);
		assert_near(length_of(point), 2, 1e-10);
		assert_vector(point[0], place.a, 0);
		assert_vector(point[RB_ROPE_PIECES], place.b, 1e-15);
		assert_true(point[RB_ROPE_PIECES / 2].z < 0.5 * ends[k].z - 0.1);
	}
	rb_joint_rope(&taut, 2, (rb_vec3){0, 0, 0}, point);
	assert_vector(point[RB_ROPE_PIECES / 2], ((rb_vec3){1, 0, 0}), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_move_with_their_bodies),
		cmocka_unit_test(a_joint_whose_points_are_apart_is_not_seen),
		cmocka_unit_test(what_is_drawn_is_thinner_than_the_bodies_unless_stated),
		cmocka_unit_test(a_slack_rope_has_its_length_and_hangs_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
