/* SPDX-License-Identifier: MIT */
/* src/located/feature_inside.h: values with their derivatives in time */
#include "shapes.h"

#include "located/feature_inside.h"

/* A vector and a number that are smooth functions of time, with their derivatives by hand. */
static vec moving(double t, int k)
{
	return (vec){{sin(t + k), 2 + cos(2 * t), t * t * k},
	             {cos(t + k), -2 * sin(2 * t), 2 * t * k}};
}

static num growing(double t)
{
	return (num){2 + sin(t), cos(t)};
}

/* What is to be tested: a number that is made of these. */
typedef num formula(double t);

static num of_dot(double t)
{
	return dot(moving(t, 1), moving(t, 2));
}

static num of_cross(double t)
{
	const vec c = cross(moving(t, 1), moving(t, 2));

	return dot(c, moving(t, 3));
}

static num of_plus(double t)
{
	return dot(plus(moving(t, 1), growing(t), moving(t, 2)), minus(moving(t, 3), moving(t, 4)));
}

static num of_quotient(double t)
{
	return quotient(of_dot(t), growing(t));
}

static num of_length(double t)
{
	vec unit;
	num length = {0, 0};

	assert_true(direction(moving(t, 2), &unit, &length));
	return length;
}

static num of_direction(double t)
{
	vec unit = {{0, 0, 0}, {0, 0, 0}};
	num length;

	assert_true(direction(moving(t, 2), &unit, &length));
	return dot(unit, moving(t, 5));
}

static num of_reject(double t)
{
	vec unit = {{0, 0, 0}, {0, 0, 0}};
	num length;

	assert_true(direction(moving(t, 2), &unit, &length));
	return dot(reject(moving(t, 1), unit), negative(moving(t, 3)));
}

/* Central differences of h = 1e-5: h^2 of a third derivative of some hundreds, and ulp / h. */
static void every_rate_is_the_derivative_of_its_value(void **state)
{
	static formula *const all[] = {of_dot,    of_cross,     of_plus,  of_quotient,
	                               of_length, of_direction, of_reject};
	const double h = 1e-5;

	(void)state;
	for (size_t f = 0; f < sizeof all / sizeof *all; f++)
		for (int k = 0; k < 20; k++) {
			const double t = 0.1 * k - 1;
			const double slope = (all[f](t + h).at - all[f](t - h).at) / (2 * h);

			assert_near(all[f](t).rate, slope, 1e-6);
		}
}

static void a_direction_needs_a_length(void **state)
{
	vec unit;
	num length;

	(void)state;
	assert_false(direction((vec){{0, 0, 0}, {1, 0, 0}}, &unit, &length));
	assert_false(direction((vec){{(double)NAN, 0, 0}, {1, 0, 0}}, &unit, &length));
	assert_true(direction((vec){{0, 0, 1e-300}, {0, 0, 0}}, &unit, &length));
}

static side some_side(const rb_core *core)
{
	return (side){.core = core,
	              .at = {1, -2, 0.5},
	              .turn = shapes_turn(3, 4),
	              .velocity = {0.3, 0.1, -0.7},
	              .spin = {1, -2, 0.5}};
}

/* Against where the side will be a moment later, which rb_feature_later says by turning it as a whole. */
static void points_of_a_body_move_as_the_body_does(void **state)
{
	const rb_core core = rb_core_of_cylinder(1, 2);
	const side now = some_side(&core);
	const double h = 1e-5;
	const side later = rb_feature_later(&now, h), before = rb_feature_later(&now, -h);

	(void)state;
	for (uint64_t k = 0; k < 20; k++) {
		const rb_vec3 local = shapes_vector(8, k, 2);
		const vec p = point_of(&now, local);
		const rb_vec3 slope = rb_vec3_scale(
			1 / (2 * h),
			rb_vec3_sub(point_of(&later, local).at, point_of(&before, local).at));

		assert_near(rb_vec3_length(rb_vec3_sub(p.rate, slope)), 0, 1e-8);
		/* seen from the body it stands still */
		const vec seen = in_body_axes(&now, p);
		assert_near(rb_vec3_length(rb_vec3_sub(seen.at, local)), 0, 2e-15);
		assert_near(rb_vec3_length(seen.rate), 0, 1e-14);
	}
}

static void a_point_that_stands_still_is_seen_to_move(void **state)
{
	const rb_core core = rb_core_of_cylinder(1, 2);
	const side now = some_side(&core);
	const double h = 1e-5;
	const side later = rb_feature_later(&now, h), before = rb_feature_later(&now, -h);
	const vec still = {{3, 4, 5}, {0, 0, 0}};

	(void)state;
	const rb_vec3 slope = rb_vec3_scale(
		1 / (2 * h),
		rb_vec3_sub(in_body_axes(&later, still).at, in_body_axes(&before, still).at));
	assert_near(rb_vec3_length(rb_vec3_sub(in_body_axes(&now, still).rate, slope)), 0, 1e-7);
}

static void lines_are_edges_and_mantles_and_nothing_else(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.5, 2);
	shape s = shapes_box(1, 2, 3);
	const side of_drum = some_side(&drum), of_box = some_side(&s.core);
	line e = {.length = 0};

	(void)state;
	assert_true(line_of(&of_drum, rb_part_of(RB_PART_MANTLE, 0), &e));
	assert_near(e.length, 4, 0);
	assert_near(e.radius, 0.5, 0);
	for (int k = 0; k < s.polytope->edge_count; k++) {
		assert_true(line_of(&of_box, rb_part_of(RB_PART_EDGE, k), &e));
		const rb_vec3 end = rb_vec3_add_scaled(e.from.at, e.length, e.along.at);
		const vec corner = point_of(&of_box, s.polytope->vertices[s.polytope->edges[k][1]]);

		assert_near(rb_vec3_length(rb_vec3_sub(end, corner.at)), 0, 4e-15);
		assert_true(e.length == 2 || e.length == 4 || e.length == 6);
	}
	/* what is not there, and what is no line */
	assert_false(line_of(&of_box, rb_part_of(RB_PART_EDGE, s.polytope->edge_count), &e));
	assert_false(line_of(&of_box, rb_part_of(RB_PART_VERTEX, 0), &e));
	assert_false(line_of(&of_box, rb_part_of(RB_PART_MANTLE, 0), &e));
	assert_false(line_of(&of_drum, rb_part_of(RB_PART_EDGE, 0), &e));
	rb_polytope_destroy(s.polytope);
}

static void the_nearest_ending_is_kept(void **state)
{
	ending end = endless;

	(void)state;
	limit_ending(&end, (num){3, 1}, FIRST, 30);
	limit_ending(&end, (num){2, 1}, SECOND, 20);
	limit_ending(&end, (num){5, 1}, FIRST, 50);
	limit_ending(&end, (num){(double)NAN, 1}, FIRST, 60);
	assert_true(end.margin.at == 2 && end.owner == SECOND && end.part == 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_rate_is_the_derivative_of_its_value),
		cmocka_unit_test(a_direction_needs_a_length),
		cmocka_unit_test(points_of_a_body_move_as_the_body_does),
		cmocka_unit_test(a_point_that_stands_still_is_seen_to_move),
		cmocka_unit_test(lines_are_edges_and_mantles_and_nothing_else),
		cmocka_unit_test(the_nearest_ending_is_kept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
