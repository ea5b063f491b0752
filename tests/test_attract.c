/* SPDX-License-Identifier: MIT */
/* math/attract: sums of pairs against quadruple precision, lanes, twofold positions, energies. */
#include "math/attract.h"

#include <float.h>
#include <math.h>

#include "math/random.h"
#include "support.h"

enum { MOST = 23 };

struct cloud {
	double x[3][MOST], rest[3][MOST], mu[MOST], inertial[MOST], a[3][MOST];
	struct rb_attract all;
};

static void fill(struct cloud *c, int count, double far, double softening2)
{
	*c = (struct cloud){0};
	for (int i = 0; i < count; i++) {
		for (int m = 0; m < 3; m++) {
			const double x = rb_random_unit(7, (uint64_t)m, (uint64_t)i);

			c->x[m][i] = far + x;
			c->rest[m][i] = x - (c->x[m][i] - far);
		}
		c->mu[i] = i % 5 == 4 ? 0 : 1 + rb_random_unit(7, 3, (uint64_t)i);
		c->inertial[i] = c->mu[i] + (i % 5 == 4);
	}
	c->all = (struct rb_attract){
		.count = count, .mu = c->mu, .inertial = c->inertial, .softening2 = softening2};
	for (int m = 0; m < 3; m++) {
		c->all.x[m] = c->x[m];
		c->all.rest[m] = c->rest[m];
	}
}

static void find(struct cloud *c, int first, int end)
{
	double *const a[3] = {c->a[0], c->a[1], c->a[2]};

	rb_attract_some(&c->all, first, end, a);
}

/* By long double; coordinates with their rests fit into it. */
static void exactly(const struct cloud *c, int i, long double a[3])
{
	a[0] = a[1] = a[2] = 0;
	for (int j = 0; j < c->all.count; j++) {
		long double d[3], square = 0;

		if (j == i)
			continue;
		for (int m = 0; m < 3; m++) {
			d[m] = ((long double)c->x[m][j] - c->x[m][i]) +
			       ((long double)c->rest[m][j] - c->rest[m][i]);
			square += d[m] * d[m];
		}
		square += c->all.softening2;
		for (int m = 0; m < 3; m++)
			a[m] += c->mu[j] * d[m] / (square * sqrtl(square));
	}
}

/* Each term is right to some 8 roundings; the sum of their sizes is what rounding is relative to. */
static void sums_are_those_of_long_double_to_rounding(void **state)
{
	static const double far[2] = {0, 1e6}, soft[2] = {0, 0.01};
	struct cloud c;

	(void)state;
	for (int variant = 0; variant < 4; variant++) {
		fill(&c, MOST, far[variant % 2], soft[variant / 2]);
		find(&c, 0, MOST);
		for (int i = 0; i < MOST; i++) {
			long double a[3];
			double size = 0;

			exactly(&c, i, a);
			for (int j = 0; j < MOST; j++) {
				double factor;
				const rb_vec3 d = rb_attract_between(&c.all, i, j, &factor);

				size += j == i ? 0 : c.mu[j] * factor * rb_vec3_length(d);
			}
			for (int m = 0; m < 3; m++)
				assert_true(fabsl(a[m] - c.a[m][i]) <= 4 * DBL_EPSILON * size);
		}
	}
}

static void a_point_gets_the_same_bits_in_every_lane_and_company(void **state)
{
	struct cloud whole, part;

	(void)state;
	fill(&whole, MOST, 0, 0);
	find(&whole, 0, MOST);
	for (int first = 0; first < MOST; first++)
		for (int end = first + 1; end <= MOST; end += 3) {
			fill(&part, MOST, 0, 0);
			find(&part, first, end);
			for (int m = 0; m < 3; m++)
				for (int i = 0; i < MOST; i++)
					assert_true(part.a[m][i] ==
					            (i >= first && i < end ? whole.a[m][i] : 0));
		}
}

static void points_at_one_place_leave_each_other_alone(void **state)
{
	struct cloud c;

	(void)state;
	fill(&c, 2, 0, 0);
	for (int m = 0; m < 3; m++) {
		c.x[m][1] = c.x[m][0];
		c.rest[m][1] = c.rest[m][0];
	}
	find(&c, 0, 2);
	for (int m = 0; m < 3; m++)
		assert_true(c.a[m][0] == 0 && c.a[m][1] == 0);
	assert_true(rb_attract_energy(&c.all) == 0);
}

static void the_energy_of_a_pair_is_that_of_the_larger_force(void **state)
{
	struct cloud c;

	(void)state;
	fill(&c, 2, 0, 0);
	c.x[0][0] = c.x[1][0] = c.x[2][0] = 0;
	c.rest[0][0] = c.rest[1][0] = c.rest[2][0] = 0;
	c.x[0][1] = 3, c.x[1][1] = 4, c.x[2][1] = 0;
	c.rest[0][1] = c.rest[1][1] = c.rest[2][1] = 0;
	c.mu[0] = 6, c.inertial[0] = 2, c.mu[1] = 0, c.inertial[1] = 5;
	assert_true(rb_attract_energy(&c.all) == -6.0 * 5 / 5);
	c.inertial[0] = (double)INFINITY; /* held: the same */
	assert_true(rb_attract_energy(&c.all) == -6.0 * 5 / 5);
	c.inertial[1] = (double)INFINITY; /* nobody yields */
	assert_true(rb_attract_energy(&c.all) == 0);
	c.inertial[0] = 2, c.inertial[1] = 5, c.mu[1] = 15;
	assert_true(rb_attract_energy(&c.all) == -6.0 * 5 / 5); /* 2 times 15, too */
	c.all.softening2 = 144;
	assert_true(rb_attract_energy(&c.all) == -30.0 / 13);
}

static void the_strongest_says_how_far_it_bends(void **state)
{
	struct cloud c;
	double depth;

	(void)state;
	fill(&c, 3, 0, 0);
	for (int i = 0; i < 3; i++)
		for (int m = 0; m < 3; m++)
			c.x[m][i] = c.rest[m][i] = 0;
	c.x[0][1] = 1, c.x[0][2] = 1000;
	c.mu[0] = 0, c.mu[1] = 2, c.mu[2] = 2;
	assert_true(fabs(rb_attract_distance(&c.all, 0, &depth) - 1.001) < 1e-5);
	assert_true(fabs(depth - 2.002) < 1e-12);
	c.mu[1] = c.mu[2] = 0;
	assert_true(isinf(rb_attract_distance(&c.all, 0, &depth)));
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(sums_are_those_of_long_double_to_rounding),
		cmocka_unit_test(a_point_gets_the_same_bits_in_every_lane_and_company),
		cmocka_unit_test(points_at_one_place_leave_each_other_alone),
		cmocka_unit_test(the_energy_of_a_pair_is_that_of_the_larger_force),
		cmocka_unit_test(the_strongest_says_how_far_it_bends),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
