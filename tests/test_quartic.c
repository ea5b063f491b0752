/* SPDX-License-Identifier: MIT */
#include "math/quartic.h"

#include <math.h>

#include "math/random.h"
#include "support.h"

/* (t - a)(t - b)(t - c)(t - d) times `scale`. */
static void from_roots(double scale, const double root[4], double c[5])
{
	c[0] = scale;
	for (int k = 1; k < 5; k++)
		c[k] = 0;
	for (int n = 0; n < 4; n++) {
		for (int k = n + 1; k > 0; k--)
			c[k] = c[k - 1] - root[n] * c[k];
		c[0] *= -root[n];
	}
}

static void the_first_fall_of_known_roots_is_found(void **state)
{
	static const double root[4] = {1, 2, 3, 4}, parting[4] = {0, 2, 3, 4};
	double c[5];

	(void)state;
	from_roots(1, root, c); /* above before 1 */
	assert_true(fabs(rb_quartic_falls(c, 10) - 1) < 1e-14);
	from_roots(-1, parting, c); /* it starts from zero, upwards */
	assert_true(fabs(rb_quartic_falls(c, 10) - 2) < 1e-13);
	from_roots(1, root, c);
	assert_true(isinf(rb_quartic_falls(c, 0.5)));
}

static void a_double_root_is_no_fall_and_a_line_is_one(void **state)
{
	static const double touch[4] = {2, 2, -1, -1};
	static const double line[5] = {3, -1.5, 0, 0, 0};
	static const double rising[5] = {0, 1, 0, 0, 0};
	static const double thrown[5] = {0, 1, -0.25, 0, 0};
	double c[5];

	(void)state;
	from_roots(1, touch, c);
	c[0] += 1e-9; /* it stays above by what rounding cannot hide */
	assert_true(isinf(rb_quartic_falls(c, 10)));
	assert_true(rb_quartic_falls(line, 10) == 2);
	assert_true(isinf(rb_quartic_falls(rising, 10)));
	assert_true(fabs(rb_quartic_falls(thrown, 10) - 4) < 1e-14);
}

static void roots_many_decades_apart_are_found(void **state)
{
	static const double root[4] = {1e-9, 1, 1e5, -1};
	double c[5];

	(void)state;
	from_roots(-1, root, c); /* signs: + before the first */
	const double found = rb_quartic_falls(c, 1e6);
	assert_true(fabs(found - 1e-9) < 1e-20);
	c[0] = 0;
	c[1] = c[2] = 0;
	c[3] = 1;
	c[4] = -1e-12;
	assert_true(fabs(rb_quartic_falls(c, 1e13) / 1e12 - 1) < 1e-12);
}

static void no_sample_of_random_polynomials_is_below_before_the_fall(void **state)
{
	(void)state;
	for (uint64_t n = 0; n < 2000; n++) {
		double c[5];

		for (int k = 0; k < 5; k++)
			c[k] = 2 * rb_random_unit(7, n, (uint64_t)k) - 1;
		c[0] = fabs(c[0]);
		const double fall = rb_quartic_falls(c, 8);
		const double end = isinf(fall) ? 8 : fall;

		for (int k = 1; k < 400; k++) {
			const double t = end * k / 400;
			const double p = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])));
			assert_true(p > -1e-12);
		}
	}
}

/* Polynomials that only just fall, and only just do not, between two turns. */
static void a_dip_is_a_fall_however_shallow(void **state)
{
	(void)state;
	for (uint64_t n = 0; n < 500; n++) {
		const double at = 0.01 + 7.9 * rb_random_unit(3, n, 0), wide = 1e-6;
		const double sharp = 1e-3 + rb_random_unit(3, n, 1);
		const double dip[2] = {at - wide, at + wide};
		/* ((t - at)^2 -+ wide^2) (sharp t^2 + 1) */
		for (int sign = -1; sign <= 1; sign += 2) {
			const double square = dip[0] * dip[1] + (sign > 0 ? 2 * wide * wide : 0);
			const double c[5] = {square, -2 * at, 1 + sharp * square, -2 * at * sharp,
			                     sharp};
			const double fall = rb_quartic_falls(c, 8);

			assert_true(sign > 0 ? isinf(fall) : fabs(fall - dip[0]) < 1e-8);
		}
	}
}

static void spheres_meet_at_any_size_and_speed(void **state)
{
	(void)state;
	static const double size[] = {1e-200, 1e-60, 1, 1e60, 1e200};

	for (int i = 0; i < 5; i++) {
		for (int j = 0; j < 5; j++) {
			const double d = size[i], v = size[j];

			if (fabs(log10(d / v)) > 300)
				continue;
			const double met = rb_touch_time((rb_vec3){5 * d, 0, 0},
			                                 (rb_vec3){-v, 0, 0}, 2 * d);
			assert_true(fabs(met / (3 * (d / v)) - 1) < 1e-15);
			assert_true(isinf(rb_touch_time((rb_vec3){5 * d, 3 * d, 0},
			                                (rb_vec3){-v, 0, 0}, 2 * d)));
			assert_true(isinf(
				rb_touch_time((rb_vec3){5 * d, 0, 0}, (rb_vec3){v, 0, 0}, 2 * d)));
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_first_fall_of_known_roots_is_found),
		cmocka_unit_test(a_double_root_is_no_fall_and_a_line_is_one),
		cmocka_unit_test(roots_many_decades_apart_are_found),
		cmocka_unit_test(a_dip_is_a_fall_however_shallow),
		cmocka_unit_test(spheres_meet_at_any_size_and_speed),
		cmocka_unit_test(no_sample_of_random_polynomials_is_below_before_the_fall),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
