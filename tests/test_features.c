/* SPDX-License-Identifier: MIT */
/* src/model/features.c: which features a scene uses */
#include "worlds.h"

#include "model/features.h"

/* The features of a scene with materials that have neither friction nor restitution, unless told otherwise. */
static rb_features of(struct lab *lab, double friction, double restitution)
{
	const struct rb_pair_material pair = {friction, restitution};

	return rb_features_of(&lab->scene, &pair);
}

static void open_empty(struct lab *lab)
{
	lab_open(lab, 1, 10);
	lab->scene.record.fields = 0; /* no events */
}

static int ball(struct lab *lab, double x)
{
	return lab_sphere(lab, 0.1, 1, (rb_vec3){x, 0, 0}, (rb_vec3){0, 0, 0});
}

static void a_ball_alone_in_empty_space_uses_none(void **state)
{
	struct lab lab;

	(void)state;
	open_empty(&lab);
	ball(&lab, 0);
	assert_int_equal(of(&lab, 0.5, 0.5), 0);
	lab.scene.world.gravity = (rb_vec3){0, 0, -1e-300};
	assert_int_equal(of(&lab, 0.5, 0.5), RB_FEATURE_GRAVITY);
	lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	lab.scene.world.gravity_force = (rb_vec3){0, 1, 0};
	assert_int_equal(of(&lab, 0.5, 0.5), RB_FEATURE_GRAVITY_FORCE);
	lab_close(&lab);
}

/* What acts on nobody is not there. */
static void where_nothing_moves_there_is_no_gravity(void **state)
{
	struct lab lab;

	(void)state;
	open_empty(&lab);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	assert_int_equal(of(&lab, 0.5, 0.5), 0);
	lab_close(&lab);
}

static void two_that_could_touch_bring_what_their_materials_have(void **state)
{
	struct lab lab;

	(void)state;
	open_empty(&lab);
	ball(&lab, 0);
	ball(&lab, 1);
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_CONTACT);
	assert_int_equal(of(&lab, 0, 0.5), RB_FEATURE_CONTACT | RB_FEATURE_RESTITUTION);
	/* friction turns balls */
	assert_int_equal(of(&lab, 0.5, 0),
	                 RB_FEATURE_CONTACT | RB_FEATURE_FRICTION | RB_FEATURE_ROTATION);
	lab_close(&lab);
}

static void those_that_filters_keep_apart_cannot_touch(void **state)
{
	struct lab lab;

	(void)state;
	open_empty(&lab);
	const int a = ball(&lab, 0), b = ball(&lab, 1);
	for (int i = 0; i < 2; i++) {
		struct rb_body_def *const body = &lab.scene.bodies[i ? b : a];

		body->filters = true;
		body->group = i;
		body->collides_with = UINT64_C(1) << i; /* its own kind alone */
	}
	const rb_features found = of(&lab, 0.5, 0.5);
	assert_true(found & RB_FEATURE_FILTERS);
	assert_false(found & (RB_FEATURE_CONTACT | RB_FEATURE_FRICTION | RB_FEATURE_RESTITUTION));
	lab.scene.bodies[a].collides_with = lab.scene.bodies[b].collides_with = 3;
	assert_true(of(&lab, 0.5, 0.5) & RB_FEATURE_CONTACT);
	lab_close(&lab);
}

/* A spin alone needs orientations; unequal moments wander, equal ones do not. */
static void turning_bodies_wander_where_their_moments_are_unequal(void **state)
{
	struct lab lab;

	(void)state;
	open_empty(&lab);
	const int id = ball(&lab, 0);
	lab.scene.bodies[id].angular_velocity = (rb_vec3){0, 1, 0};
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_ROTATION);
	lab.scene.bodies[id].inertia = &(rb_mat3){{{1, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_ROTATION | RB_FEATURE_GYROSCOPIC);
	lab.scene.bodies[id].angular_velocity = (rb_vec3){0, 0, 0};
	assert_int_equal(of(&lab, 0, 0), 0); /* it cannot come to turn */
	lab_close(&lab);
}

static void a_force_off_the_centre_turns_and_one_at_it_does_not(void **state)
{
	struct rb_force_def force = rb_force_def_default();
	struct lab lab;

	(void)state;
	open_empty(&lab);
	ball(&lab, 0);
	force.vector = (rb_vec3){1, 0, 0};
	assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_FORCES);
	lab.scene.forces[0].point = (rb_vec3){0, 0, 0}; /* the centre of mass by another name */
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_FORCES);
	lab.scene.forces[0].point = (rb_vec3){0, 0.1, 0};
	assert_int_equal(of(&lab, 0, 0), RB_FEATURE_FORCES | RB_FEATURE_ROTATION);
	lab_close(&lab);
}

static void every_bit_has_one_row_in_order(void **state)
{
	int count;
	const struct rb_feature_row *const row = rb_feature_rows(&count);

	(void)state;
	for (int k = 0; k < count; k++) {
		assert_int_equal(row[k].bit, 1u << k);
		assert_true(*row[k].name && *row[k].help && *row[k].absent && row[k].present);
		for (int j = 0; j < k; j++)
			assert_string_not_equal(row[j].name, row[k].name);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_alone_in_empty_space_uses_none),
		cmocka_unit_test(where_nothing_moves_there_is_no_gravity),
		cmocka_unit_test(two_that_could_touch_bring_what_their_materials_have),
		cmocka_unit_test(those_that_filters_keep_apart_cannot_touch),
		cmocka_unit_test(turning_bodies_wander_where_their_moments_are_unequal),
		cmocka_unit_test(a_force_off_the_centre_turns_and_one_at_it_does_not),
		cmocka_unit_test(every_bit_has_one_row_in_order),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
