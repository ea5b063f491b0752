/* SPDX-License-Identifier: MIT */
/* src/step/gap.c: signed gaps of pairs */
#include "worlds.h"

#include <float.h>

#include "step/gap.h"
#include "world/world.h"

/* Balls 0 and 1, a plane and a rectangle. */
static void open_four(struct lab *lab)
{
	lab_open(lab, 1, 10);
	lab_sphere(lab, 0.5, 1, (rb_vec3){0, 0, 3}, (rb_vec3){0, 0, 0});
	lab_sphere(lab, 0.25, 1, (rb_vec3){3, 4, 3}, (rb_vec3){0, 0, 0});
	lab_plane(lab, (rb_vec3){7, 8, -1}, (rb_vec3){0, 0, 1});
	lab_rectangle(lab, (rb_vec3){0, 0, 10}, (rb_vec3){0, 0, 1}, 2, 2);
	lab_seal(lab, 1);
}

static void gaps_are_those_of_their_closed_forms(void **state)
{
	struct lab lab;

	(void)state;
	open_four(&lab);
	struct rb_state *const s = &lab.world->state;
	const struct rb_gap balls = rb_gap_of(lab.world, s, 0, 1);
	assert_near(balls.gap, 5 - 0.75, 1e-15);
	assert_vector(balls.normal, ((rb_vec3){0.6, 0.8, 0}), 1e-15);
	const struct rb_gap floor_gap = rb_gap_of(lab.world, s, 0, 2);
	assert_near(floor_gap.gap, 4 - 0.5, 1e-15);
	assert_vector(floor_gap.normal, ((rb_vec3){0, 0, -1}), 1e-15); /* from the ball to it */
	const struct rb_gap sheet = rb_gap_of(lab.world, s, 0, 3);
	assert_near(sheet.gap, 7 - 0.5, 1e-15);
	assert_vector(sheet.normal, ((rb_vec3){0, 0, 1}), 1e-15);
	/* beyond its border: that to the border, 3 aside and 4 below */
	const struct rb_gap aside = rb_gap_at(lab.world, s, 0, (rb_vec3){4, 0, 6}, 3);
	assert_near(aside.gap, 5 - 0.5, 1e-14);
	lab_close(&lab);
}

static void elsewhere_it_is_as_if_the_body_were_there(void **state)
{
	struct lab lab;

	(void)state;
	open_four(&lab);
	struct rb_state *const s = &lab.world->state;
	for (int b = 1; b < 4; b++) {
		const rb_vec3 there = {1.5, -0.5, 2.25}, here = rb_vec3_from(s->position);
		const struct rb_gap at = rb_gap_at(lab.world, s, 0, there, b);

		rb_vec3_to(s->position, there);
		const struct rb_gap of = rb_gap_of(lab.world, s, 0, b);
		assert_near(at.gap, of.gap, 0);
		assert_vector(at.normal, of.normal, 0);
		assert_vector(at.point, of.point, 0);
		rb_vec3_to(s->position, here);
	}
	lab_close(&lab);
}

static void an_overlap_is_a_negative_gap(void **state)
{
	struct lab lab;

	(void)state;
	open_four(&lab);
	assert_near(rb_gap_at(lab.world, &lab.world->state, 0, (rb_vec3){3, 4, 3.5}, 1).gap, -0.25,
	            1e-15);
	assert_near(rb_gap_at(lab.world, &lab.world->state, 0, (rb_vec3){0, 0, -2}, 2).gap, -1.5,
	            1e-15);
	lab_close(&lab);
}

/* Eight ulp of the larger of coordinate and size. */
static void the_band_follows_the_largest_of_coordinates_and_sizes(void **state)
{
	struct lab lab;

	(void)state;
	open_four(&lab);
	struct rb_state *const s = &lab.world->state;
	assert_near(rb_gap_band(lab.world, s, 0, 1), 8 * DBL_EPSILON * 4, 0);
	s->position[1] = -100;
	assert_near(rb_gap_band(lab.world, s, 0, 1), 8 * DBL_EPSILON * 100, 0);
	s->position[1] = s->position[2] = 0;
	s->position[3] = s->position[4] = s->position[5] = 0.1;
	assert_near(rb_gap_band(lab.world, s, 0, 1), 8 * DBL_EPSILON * 0.5, 0);
	lab_close(&lab);
}

static void radii_add_up_and_planes_are_flat(void **state)
{
	struct lab lab;

	(void)state;
	open_four(&lab);
	assert_near(rb_gap_radius(lab.model, 0, 1), 0.75, 0);
	assert_true(isinf(rb_gap_radius(lab.model, 0, 2)));
	assert_true(isinf(rb_gap_radius(lab.model, 1, 3)));
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gaps_are_those_of_their_closed_forms),
		cmocka_unit_test(elsewhere_it_is_as_if_the_body_were_there),
		cmocka_unit_test(an_overlap_is_a_negative_gap),
		cmocka_unit_test(the_band_follows_the_largest_of_coordinates_and_sizes),
		cmocka_unit_test(radii_add_up_and_planes_are_flat),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
