/* SPDX-License-Identifier: MIT */
/* src/geom/patch_overlap.c: where two patches lie over each other */
#include "shapes.h"

#include "geom/patch_overlap.h"

static rb_overlay_point point[RB_OVERLAY_MAX];
static rb_patch low, high;

static const rb_overlay_def up = {{0, 0, 1}, 1e-9, 1e-9, 1e-9};

/* The top of one box and the bottom of another that stands `gap` above it, moved by x, y and turned about z. */
static int faces(double x, double y, double turn, double gap)
{
	shape s = shapes_box(1, 1, 1);
	const rb_placed a = {&s.core, {0, 0, -1}, shapes_upright};
	const rb_placed b = {&s.core, {x, y, 1 + gap}, shapes_turned((rb_vec3){0, 0, turn})};

	rb_patch_of(&low, &a, (rb_vec3){0, 0, 1}, 1e-9, 0);
	rb_patch_of(&high, &b, (rb_vec3){0, 0, -1}, 1e-9, 0);
	const int count = rb_overlay(&low, &high, &up, point);
	rb_polytope_destroy(s.polytope);
	return count;
}

/* The area of the convex hull of the points, by their angles about their mean. */
static double area_of(int count)
{
	rb_vec3 mean = {0, 0, 0};
	double angle[RB_OVERLAY_MAX], area = 0;
	int order[RB_OVERLAY_MAX];

	for (int i = 0; i < count; i++)
		mean = rb_vec3_add_scaled(mean, 1.0 / count, point[i].on_a);
	for (int i = 0; i < count; i++) {
		int k = i;

		angle[i] = atan2(point[i].on_a.y - mean.y, point[i].on_a.x - mean.x);
		for (; k > 0 && angle[order[k - 1]] > angle[i]; k--)
			order[k] = order[k - 1];
		order[k] = i;
	}
	for (int i = 0; i < count; i++) {
		const rb_vec3 p = point[order[i]].on_a, q = point[order[(i + 1) % count]].on_a;

		area += 0.5 * ((p.x - mean.x) * (q.y - mean.y) - (q.x - mean.x) * (p.y - mean.y));
	}
	return area;
}

static void two_squares_share_a_rectangle(void **state)
{
	(void)state;
	for (int k = 0; k < 40; k++) {
		const double x = 1.9 * sin(k), y = 1.9 * cos(3 * k);
		const int count = faces(x, y, 0, 0.25);

		assert_int_equal(count, 4);
		assert_near(area_of(count), (2 - fabs(x)) * (2 - fabs(y)), 1e-12);
		for (int i = 0; i < count; i++) {
			assert_near(point[i].gap, 0.25, 1e-14);
			assert_near(point[i].on_a.x, point[i].on_b.x, 1e-9);
			assert_near(point[i].on_a.y, point[i].on_b.y, 1e-9);
			assert_near(point[i].on_b.z - point[i].on_a.z, 0.25, 1e-14);
		}
	}
}

/* Of a square and one turned by 45 degrees about the same centre: a regular octagon, 8 (sqrt 2 - 1) for half sides of 1. */
static void a_square_and_one_turned_share_an_octagon(void **state)
{
	const int count = faces(0, 0, 0.78539816339744831, 0);

	(void)state;
	assert_int_equal(count, 8);
	assert_near(area_of(count), 8 * (sqrt(2) - 1), 1e-12);
}

/*
 * A stick along the normal, of which all is within the depth, is a point in projection: it shares
 * itself with what it is over, and nothing where it is beside.
 */
static void an_upright_stick_shares_itself(void **state)
{
	shape s = shapes_box(1, 1, 1), stick = shapes_capsule(0.2, 0.1);
	const rb_placed a = {&s.core, {0, 0, -1}, shapes_upright};

	(void)state;
	for (int k = 0; k < 40; k++) {
		const double x = 1.9 * sin(k), y = 1.9 * cos(3 * k), tilt = k % 2 ? 0 : 1e-14;
		const rb_placed b = {&stick.core, {x, y, 1}, shapes_turned((rb_vec3){tilt, 0, 0})};
		const int wanted = fabs(x) < 1 && fabs(y) < 1 ? 2 : 0;

		rb_patch_of(&low, &a, (rb_vec3){0, 0, 1}, 1, 0);
		rb_patch_of(&high, &b, (rb_vec3){0, 0, -1}, 1, 0);
		assert_int_equal(high.kind, RB_PATCH_SEGMENT);
		assert_int_equal(rb_overlay(&low, &high, &up, point), wanted);
		const rb_overlay_def below = {{0, 0, -1}, up.along, up.aside, up.past};
		assert_int_equal(rb_overlay(&high, &low, &below, point), wanted);
		for (int i = 0; i < wanted; i++) {
			assert_near(point[i].on_a.x, x, 1e-12);
			assert_near(point[i].on_a.y, y, 1e-12);
		}
	}
	rb_polytope_destroy(s.polytope);
	rb_polytope_destroy(stick.polytope);
}

static void what_lies_aside_shares_nothing(void **state)
{
	(void)state;
	assert_int_equal(faces(2.001, 0, 0, 0), 0);
	assert_int_equal(faces(1.72, 1.72, 0.78539816339744831, 0), 0);
	/* a corner at sqrt(2) and a side at 1 along the diagonal: 1.7 sqrt(2) is less than both */
	assert_int_equal(faces(1.7, 1.7, 0.78539816339744831, 0), 3);
	assert_int_equal(faces(0, -7, 0.3, 0), 0);
}

static void a_margin_is_the_way_to_the_border(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.5, 2), ground = rb_core_of_half_space();
	const rb_vec3 n = {0, 0, 1};

	(void)state;
	faces(0, 0, 0, 0);
	for (int k = 0; k < 40; k++) {
		const double x = 0.99 * sin(k), y = 0.99 * cos(3 * k);

		assert_near(rb_overlay_margin(&low, (rb_vec3){x, y, 5}, n),
		            fmin(1 - fabs(x), 1 - fabs(y)), 1e-14);
	}
	/* outside by no less than it says */
	const double out = rb_overlay_margin(&low, (rb_vec3){4, 5, 0}, n);
	assert_true(out < 0 && out >= -5);
	const rb_placed a = {&drum, {0, 0, 0}, shapes_upright},
			g = {&ground, {0, 0, 0}, shapes_upright};
	rb_patch_of(&low, &a, n, 1e-9, 0);
	assert_near(rb_overlay_margin(&low, (rb_vec3){0.3, 0, 0}, n), 0.2, 1e-15);
	assert_near(rb_overlay_margin(&low, (rb_vec3){0.3, 0.4, 0}, n), 0, 1e-15);
	rb_patch_of(&low, &g, n, 1e-9, 0);
	assert_true(rb_overlay_margin(&low, (rb_vec3){9, 9, 0}, n) > 1e300);
	/* a line has no inside */
	rb_patch_of(&low, &a, (rb_vec3){1, 0, 0}, 1e-9, 0);
	assert_true(isinf(rb_overlay_margin(&low, (rb_vec3){0.5, 0, 0}, (rb_vec3){1, 0, 0})));
	assert_true(rb_overlay_margin(&low, (rb_vec3){0.5, 0, 0}, (rb_vec3){1, 0, 0}) < 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(two_squares_share_a_rectangle),
		cmocka_unit_test(a_square_and_one_turned_share_an_octagon),
		cmocka_unit_test(an_upright_stick_shares_itself),
		cmocka_unit_test(what_lies_aside_shares_nothing),
		cmocka_unit_test(a_margin_is_the_way_to_the_border),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
