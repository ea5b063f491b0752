/* SPDX-License-Identifier: MIT */
/* src/force/drag.c */
#include "worlds.h"

#include "force/drag.h"

static rb_vec3 force_at(const struct rb_drag_def *drag, rb_vec3 velocity)
{
	const struct rb_pose pose = {.velocity = velocity, .spin = {1, 2, 3}};
	const struct rb_element_query query = {.model = NULL};
	struct rb_wrench out = {.torque = {9, 9, 9}};

	assert_true(rb_force_drag.act(&query, drag, 0, &pose, &out));
	assert_vector(out.torque, ((rb_vec3){0, 0, 0}), 0);
	return out.force;
}

static void it_acts_against_the_velocity_by_both_laws(void **state)
{
	(void)state;
	for (int k = 0; k < 60; k++) {
		const struct rb_drag_def drag = {.linear = k % 3, .quadratic = k % 5 * 0.25};
		const rb_vec3 v = {3 * sin(k), 2 * cos(3 * k), sin(7 * k)};
		const rb_vec3 force = force_at(&drag, v);
		const double speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);

		/* its size, then its direction */
		assert_near(rb_vec3_length(force),
		            drag.linear * speed + drag.quadratic * speed * speed, 1e-13);
		assert_vector(rb_vec3_cross(force, v), ((rb_vec3){0, 0, 0}), 1e-13);
		assert_true(rb_vec3_dot(force, v) <= 0);
	}
}

static void a_body_at_rest_feels_none(void **state)
{
	const struct rb_drag_def drag = {.linear = 3, .quadratic = 5};

	(void)state;
	assert_vector(force_at(&drag, (rb_vec3){0, 0, 0}), ((rb_vec3){0, 0, 0}), 0);
}

static void drag_that_does_nothing_does_not_matter(void **state)
{
	(void)state;
	assert_false(rb_force_drag.matters(&(struct rb_drag_def){0}));
	assert_true(rb_force_drag.matters(&(struct rb_drag_def){.linear = 1e-300}));
	assert_true(rb_force_drag.matters(&(struct rb_drag_def){.quadratic = 1e-300}));
	assert_null(rb_force_drag.ends);
	assert_null(rb_force_drag.energy); /* it gives nothing back */
	assert_true(rb_force_drag.is_drag);
}

static void coefficients_must_be_finite_and_not_negative(void **state)
{
	static const double wrong[] = {-1, -1e-300, (double)NAN, (double)INFINITY};
	char text[RB_ELEMENT_FAULT_SIZE];

	(void)state;
	assert_false(rb_force_drag.fault(NULL, &(struct rb_drag_def){0}, text));
	for (int k = 0; k < 4; k++) {
		const struct rb_drag_def linear = {.linear = wrong[k]},
					 quadratic = {.quadratic = wrong[k]};

		assert_true(rb_force_drag.fault(NULL, &linear, text));
		assert_true(rb_force_drag.fault(NULL, &quadratic, text));
		assert_non_null(strstr(text, "'linear' and 'quadratic' must be finite"));
	}
}

/* v' = -c v |v| / m: 1/v grows by c/m a second. */
static void a_ball_slows_down_as_its_law_says(void **state)
{
	struct rb_drag_def drag = {.quadratic = 0.8};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 2, 10);
	lab_sphere(&lab, 0.1, 2, (rb_vec3){0, 0, 0}, (rb_vec3){5, 0, 0});
	assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_velocity(lab.world, 0).x, 1 / (1 / 5.0 + 0.4 * 2), 1e-9);
	lab_close(&lab);
}

/*
 * A grain that drag brings to its final speed, c1 v + c2 v^2 = m g, within 1e-7 s. By pieces as long
 * as that it would take millions.
 */
static void a_grain_sinks_in_pieces_of_its_smooth_motion(void **state)
{
	struct rb_drag_def drag = {.linear = 0.2, .quadratic = 0.5};
	const double mass = 5e-10, weight = mass * 9.81;
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 0.2, 10);
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_sphere(&lab, 5e-5, mass, (rb_vec3){0, 0, 0}, (rb_vec3){0.4, 0, 0});
	assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
	lab_seal(&lab, 1);
	for (int frame = 0; frame < 2 && rb_world_work(lab.world).body_steps < 20000; frame++)
		lab_step(&lab);
	assert_true(rb_world_work(lab.world).body_steps < 20000);
	const double speed = 2 * weight /
	                     (drag.linear +
	                      sqrt(drag.linear * drag.linear + 4 * drag.quadratic * weight));
	assert_near(rb_world_velocity(lab.world, 0).z, -speed, 1e-14 * speed);
	assert_near(rb_world_velocity(lab.world, 0).x, 0, 1e-14 * speed);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_acts_against_the_velocity_by_both_laws),
		cmocka_unit_test(a_body_at_rest_feels_none),
		cmocka_unit_test(drag_that_does_nothing_does_not_matter),
		cmocka_unit_test(coefficients_must_be_finite_and_not_negative),
		cmocka_unit_test(a_ball_slows_down_as_its_law_says),
		cmocka_unit_test(a_grain_sinks_in_pieces_of_its_smooth_motion),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
