/* SPDX-License-Identifier: MIT */
/* src/model/joints.c: joints as the model has them, and what is wrong with one. */
#include "worlds.h"

#include <string.h>

#include "model/joints.h"
#include "step/broadphase.h"

static struct rb_body_def box(rb_vec3 position, rb_vec3 turn)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "box";
	def.shape.kind = RB_SHAPE_BOX;
	def.shape.size[0] = 1;
	def.shape.size[1] = 0.2;
	def.shape.size[2] = 0.3;
	def.mass = 2;
	def.center_of_mass = (rb_vec3){0.1, 0, -0.02};
	def.position = position;
	def.orientation = rb_quat_from_turn(turn);
	return def;
}

/* Two boxes and a static one between them in number. */
static void open_boxes(struct lab *lab)
{
	struct rb_body_def def = box((rb_vec3){1, 2, 3}, (rb_vec3){0.3, 1, 0});

	lab_open_located(lab, 1, 10);
	lab_add(lab, &def);
	def = box((rb_vec3){1.2, 2, 3}, (rb_vec3){0, -1, 2});
	def.is_static = true;
	lab_add(lab, &def);
	def = box((rb_vec3){3, 2, 3.5}, (rb_vec3){2, 0, 0.1});
	lab_add(lab, &def);
}

static struct rb_joint_def hinge(int a, int b)
{
	struct rb_joint_def def = rb_joint_def_default();

	def.kind = RB_JOINT_HINGE;
	def.a = a;
	def.b = b;
	def.at = (rb_vec3){2, 2.5, 3};
	def.axis = (rb_vec3){0, 3, 4};
	return def;
}

static void add(struct lab *lab, const struct rb_joint_def *def)
{
	assert_int_equal(rb_scene_add_joint(&lab->scene, def, NULL, &lab->error), RB_OK);
}

/* The pose of a body at the start, as methods have it. */
static struct rb_pose start_of(const struct rb_model *model, int index)
{
	struct rb_pose pose = {.orientation = model->orientation[index]};

	pose.position = rb_vec3_add(model->position[index],
	                            rb_quat_rotate(pose.orientation, model->center_of_mass[index]));
	return pose;
}

static void a_sealed_joint_closes_at_the_start(void **state)
{
	struct lab lab;

	(void)state;
	open_boxes(&lab);
	struct rb_joint_def def = hinge(2, 0);
	add(&lab, &def);
	def = hinge(0, -1);
	def.kind = RB_JOINT_UNIVERSAL;
	def.axis_b = (rb_vec3){0, 4, -3};
	add(&lab, &def);
	def = hinge(1, 0);
	def.kind = RB_JOINT_FIXED;
	add(&lab, &def);
	def = hinge(2, 0);
	def.kind = RB_JOINT_SLIDER;
	add(&lab, &def);
	def.kind = RB_JOINT_ROD;
	def.at = (rb_vec3){(double)NAN, 0, 0};
	add(&lab, &def);
	if (rb_model_create(&lab.model, &lab.scene, NULL, &lab.error) != RB_OK)
		fail_msg("%s", lab.error.text);
	const struct rb_joints *joints = lab.model->joints;

	assert_int_equal(joints->count, 5);
	assert_true(lab.model->features & RB_FEATURE_JOINTS);
	assert_true(lab.model->features & RB_FEATURE_ROTATION);
	for (int k = 0; k < joints->count; k++) {
		const struct rb_joint *joint = &joints->joint[k];
		const struct rb_pose a = start_of(lab.model, joint->a);
		const struct rb_pose b = joint->b < 0 ? rb_linkage_world()
		                                      : start_of(lab.model, joint->b);
		struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
		const int count = rb_linkage_rows(&joint->link, &a, &b, row);

		assert_int_equal(joint->def, k);
		for (int r = 0; r < count; r++)
			assert_near(row[r].error, 0, 4e-15);
		assert_true(joint->size > 0.5);
		if (rb_linkage_has_free(&joint->link))
			assert_near(rb_linkage_free(&joint->link, &a, &b).value, 0, 1e-15);
	}
	const struct rb_pose a = start_of(lab.model, joints->joint[0].a);
	const rb_vec3 axis = rb_linkage_axis(&joints->joint[0].link, &a);

	assert_near(rb_vec3_length(rb_vec3_sub(axis, (rb_vec3){0, 0.6, 0.8})), 0, 1e-15);
	lab_close(&lab);
}

/* Indices: 0 and 1 are the moving ones (ids 0, 2), 2 is the static one (id 1). */
static void ends_are_listed_and_do_not_touch(void **state)
{
	struct lab lab;

	(void)state;
	open_boxes(&lab);
	struct rb_joint_def def = hinge(0, 1); /* they overlap: no mistake where they are joined */
	add(&lab, &def);
	def = hinge(2, -1);
	add(&lab, &def);
	def = hinge(2, 0);
	def.collides = true;
	add(&lab, &def);
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	const struct rb_joints *joints = lab.model->joints;

	assert_int_equal(joints->joint[0].b, 2);
	assert_int_equal(joints->joint[1].b, -1);
	assert_int_equal(joints->first[0], 0);
	assert_int_equal(joints->first[1], 2);
	assert_int_equal(joints->first[2], 4);
	assert_int_equal(joints->first[3], 5);
	assert_int_equal(joints->of[0], 0);
	assert_int_equal(joints->of[1], 2);
	assert_int_equal(joints->of[2], 1);
	assert_int_equal(joints->of[3], 2);
	assert_int_equal(joints->of[4], 0);
	assert_true(rb_model_joined(lab.model, 0, 2));
	assert_true(rb_model_joined(lab.model, 2, 0));
	assert_false(rb_model_joined(lab.model, 0, 1)); /* they collide */
	assert_false(rb_model_joined(lab.model, 1, 2));

	struct rb_broadphase *broadphase;
	const rb_aabb box[2] = {{{0, 0, 0}, {5, 5, 5}}, {{0, 0, 0}, {5, 5, 5}}};
	const struct rb_pair *pair;
	size_t count;

	assert_int_equal(rb_broadphase_create(&broadphase, lab.model, &lab.error), RB_OK);
	assert_int_equal(rb_broadphase_find(broadphase, box, &pair, &count, &lab.error), RB_OK);
	assert_int_equal((int)count, 2);
	assert_int_equal(pair[0].a, 0);
	assert_int_equal(pair[0].b, 1);
	assert_int_equal(pair[1].a, 1);
	assert_int_equal(pair[1].b, 2);
	rb_broadphase_destroy(broadphase);
	lab_close(&lab);
}

static void refused(struct rb_joint_def def, const char *what)
{
	struct lab lab;

	open_boxes(&lab);
	add(&lab, &def);
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_ERR_SCENE);
	if (!strstr(lab.error.text, what))
		fail_msg("'%s' says nothing of '%s'", lab.error.text, what);
	assert_non_null(strstr(lab.error.text, "joint: "));
	lab_close(&lab);
}

static void mistakes_are_named(void **state)
{
	struct rb_joint_def def;

	(void)state;
	refused(hinge(0, 0), "same body");
	refused(hinge(1, -1), "nothing can move");
	refused(hinge(-1, 0), "'a' must be a body");
	def = hinge(0, 2);
	def.axis.x = (double)NAN;
	refused(def, "'axis' must be given for kind 'hinge'");
	def = hinge(0, 2);
	def.axis = (rb_vec3){0, 0, 0};
	refused(def, "'axis' must be finite and not zero");
	def = hinge(0, 2);
	def.at_b = (rb_vec3){0.5, 0, 0};
	refused(def, "does not close at the start: the points of #0 and #2 are ");
	def = hinge(0, -1);
	def.kind = RB_JOINT_UNIVERSAL;
	refused(def, "'axis_b' must be given");
	def.axis_b = (rb_vec3){0, 1, 0};
	refused(def, "must be at right angles (the cosine of their angle is 0.6)");
	def = hinge(0, 2);
	def.kind = RB_JOINT_ROD;
	refused(def, "at one place");
	def.at.x = (double)NAN;
	def.length_m = 0.3;
	refused(def, "'length' is 0.3 m");
	def.length_m = -1;
	refused(def, "'length' must be positive");
	def = hinge(0, 2);
	def.restitution = 1.5;
	refused(def, "'restitution'");
	def = hinge(0, 2);
	def.stiffness = -1;
	refused(def, "'stiffness'");
	def = hinge(0, 2);
	def.kind = RB_JOINT_BALL;
	def.damping = 1;
	refused(def, "'damping' is of the angle or the way that a joint leaves free; kind 'ball'");
	/* by methods that have none */
	struct lab lab;

	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_CLASSIC;
	def = rb_joint_def_default();
	def.kind = RB_JOINT_ROD;
	def.a = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	def.b = lab_sphere(&lab, 0.1, 1, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
	add(&lab, &def);
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_ERR_SCENE);
	assert_non_null(strstr(lab.error.text, "'classic' has no joints"));
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sealed_joint_closes_at_the_start),
		cmocka_unit_test(ends_are_listed_and_do_not_touch),
		cmocka_unit_test(mistakes_are_named),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
