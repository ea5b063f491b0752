/* SPDX-License-Identifier: MIT */
/*
 * math/multipole and math/tree against sums over all pairs: fields of groups by long double, errors
 * and momentum of many points, teams, points that share a place, lack of memory.
 */
#include "math/tree.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "math/multipole.h"
#include "math/random.h"
#include "support.h"

enum { MOST = 3000, SAMPLE = 256 };

struct cloud {
	double x[3][MOST], rest[3][MOST], mu[MOST], a[3][MOST], potential[MOST];
	struct rb_attract all;
	double *to[4];
};

static struct cloud cloud;

static double draw(int stream, int i)
{
	return 2 * rb_random_unit(11, (uint64_t)stream, (uint64_t)i) - 1;
}

/*
 * `count` points of a cube about (size, 0, 0), every seventh without strength; dense: most of them
 * about its middle, where their density is that of 1/r^2.
 */
static void fill(struct cloud *c, int count, double size, bool dense)
{
	memset(c, 0, sizeof *c);
	for (int i = 0; i < count; i++) {
		const double share = dense ? fabs(draw(5, i)) : 1;

		for (int m = 0; m < 3; m++)
			c->x[m][i] = size * (share * draw(m, i) + (m == 0));
		c->mu[i] = i % 7 == 6 ? 0 : size * size * (1 + 0.5 * draw(4, i));
	}
	c->all = (struct rb_attract){.count = count, .mu = c->mu};
	for (int m = 0; m < 3; m++) {
		c->all.x[m] = c->x[m];
		c->all.rest[m] = c->rest[m];
		c->to[m] = c->a[m];
	}
	c->to[3] = c->potential;
}

static void attract(struct cloud *c, double opening, struct rb_team *team)
{
	struct rb_tree *tree;
	struct rb_error err;

	assert_int_equal(rb_tree_create(&tree, &err), RB_OK);
	assert_int_equal(rb_tree_attract(tree, &c->all, opening, team, c->to, &err), RB_OK);
	rb_tree_destroy(tree);
}

/* Potentials are right to a share; largest and median one by which the first accelerations differ from those of all pairs. */
static void errors(const struct cloud *c, double *median, double *largest, double of_potential)
{
	double exact[3][SAMPLE], share[SAMPLE];
	double *const to[3] = {exact[0], exact[1], exact[2]};

	rb_attract_some(&c->all, 0, SAMPLE, to);
	*largest = 0;
	for (int i = 0; i < SAMPLE; i++) {
		double difference = 0, size = 0, depth;
		int at = i;

		for (int m = 0; m < 3; m++) {
			difference += pow(c->a[m][i] - exact[m][i], 2);
			size += pow(exact[m][i], 2);
		}
		const double of_this = sqrt(difference / size);
		*largest = fmax(*largest, of_this);
		for (; at > 0 && share[at - 1] > of_this; at--)
			share[at] = share[at - 1];
		share[at] = of_this;
		(void)rb_attract_distance(&c->all, i, &depth);
		assert_true(fabs(c->potential[i] - depth) <= of_potential * depth);
	}
	*median = share[SAMPLE / 2];
}

/*
 * At distance R a group of radius r, felt over a ball of radius r, is wrong by about (2 r/R)^(P+1) of
 * its g, the first term that is cut off; moved from one centre to another, by rounding alone.
 */
static void moments_act_as_their_points_do(void **state)
{
	static const double far[2][3] = {{0, 0, 0}, {3, -2, 1}};
	double moment[2][RB_MULTIPOLE_TERMS] = {{0}}, field[RB_MULTIPOLE_TERMS] = {0};
	double part[RB_MULTIPOLE_TERMS] = {0}, lowered[RB_MULTIPOLE_TERMS] = {0};
	const double soft2 = 0.01;
	long double psi = 0, a[3] = {0, 0, 0};
	double sum = 0, center[3] = {0, 0, 0}, mu[9], x[9][3];
	const double at[3] = {3.1, -2.05, 1.1};

	(void)state;
	for (int i = 0; i < 9; i++) {
		mu[i] = 1 + 0.5 * draw(3, i);
		sum += mu[i];
		for (int m = 0; m < 3; m++) {
			x[i][m] = 0.2 * draw(m, i);
			center[m] += mu[i] * x[i][m];
		}
	}
	for (int m = 0; m < 3; m++)
		center[m] /= sum;
	for (int i = 0; i < 9; i++) {
		long double d[3], square = soft2;

		rb_multipole_add(
			moment[0], mu[i],
			(rb_vec3){center[0] - x[i][0], center[1] - x[i][1], center[2] - x[i][2]});
		rb_multipole_add(part, mu[i],
		                 (rb_vec3){0.5 - x[i][0], -0.25 - x[i][1], 0.125 - x[i][2]});
		for (int m = 0; m < 3; m++) {
			d[m] = (long double)x[i][m] - at[m];
			square += d[m] * d[m];
		}
		psi += mu[i] / sqrtl(square);
		for (int m = 0; m < 3; m++)
			a[m] += mu[i] * d[m] / (square * sqrtl(square));
	}
	rb_multipole_lift(moment[1], part,
	                  (rb_vec3){center[0] - 0.5, center[1] + 0.25, center[2] - 0.125});
	for (int n = 0; n < RB_MULTIPOLE_TERMS; n++)
		assert_true(fabs(moment[1][n] - moment[0][n]) <= 64 * DBL_EPSILON * sum);
	const double centers[1][3] = {{center[0], center[1], center[2]}};
	const struct rb_multipole_sources sources = {centers,
	                                             (const double(*)[RB_MULTIPOLE_TERMS])moment};
	const int list[1] = {0};
	rb_multipole_field(&sources, list, 1, soft2, far[1], field);
	rb_multipole_lower(lowered, field, (rb_vec3){0.05, -0.02, 0.04});
	for (int whole = 0; whole < 2; whole++) {
		double potential;
		const rb_vec3 found = whole ? rb_multipole_at(field, (rb_vec3){0.1, -0.05, 0.1},
		                                              &potential)
		                            : rb_multipole_at(lowered, (rb_vec3){0.05, -0.03, 0.06},
		                                              &potential);
		const double bound = pow(2 * 0.35 / sqrt(14), RB_MULTIPOLE_ORDER + 1);

		assert_true(fabs(potential - (double)psi) <= bound * (double)psi);
		assert_true(rb_vec3_length((rb_vec3){found.x - (double)a[0], found.y - (double)a[1],
		                                     found.z - (double)a[2]}) <=
		            RB_MULTIPOLE_ORDER * bound * sum / 14);
	}
}

/*
 * Bars of the default angle, twice as wide in a cusp (1.4e-4 measured): cells about its middle hold
 * most of their mass at one side. A smaller angle is better. Sizes are of galaxies and of atoms.
 */
static void accelerations_are_those_of_all_pairs_but_for_1e_4(void **state)
{
	static const double size[3] = {1, 1e17, 1e-12};

	(void)state;
	for (int k = 0; k < 3; k++)
		for (int dense = 0; dense < 2; dense++) {
			double median, largest, finer[2];

			fill(&cloud, MOST, size[k], dense);
			attract(&cloud, 0.5, NULL);
			errors(&cloud, &median, &largest, 1e-3);
			assert_true(median > 0 && median <= (dense ? 2e-4 : 1e-4));
			assert_true(largest <= 2e-2);
			attract(&cloud, 0.25, NULL);
			errors(&cloud, &finer[0], &finer[1], 1e-3);
			assert_true(finer[0] < 0.5 * median);
			attract(&cloud, 1, NULL);
			errors(&cloud, &median, &largest, 1e-2);
			assert_true(median < 0.1);
		}
}

/* With softening as much as the whole, too. */
static void forces_cancel_to_rounding(void **state)
{
	(void)state;
	for (int soft = 0; soft < 2; soft++) {
		double sum[3] = {0}, sizes = 0, median, largest;

		fill(&cloud, MOST, 1, soft);
		cloud.all.softening2 = soft;
		for (int i = 0; i < MOST; i++) /* what is attracted attracts */
			cloud.mu[i] = fmax(cloud.mu[i], 0.1);
		attract(&cloud, 0.8, NULL);
		for (int i = 0; i < MOST; i++)
			for (int m = 0; m < 3; m++) {
				sum[m] += cloud.mu[i] * cloud.a[m][i];
				sizes += fabs(cloud.mu[i] * cloud.a[m][i]);
			}
		for (int m = 0; m < 3; m++)
			assert_true(fabs(sum[m]) <= 16 * DBL_EPSILON * sizes);
		errors(&cloud, &median, &largest, 1e-2);
		assert_true(median <= 1e-2);
	}
}

static void a_team_finds_the_same_bits(void **state)
{
	static double alone[4][MOST];
	struct rb_team *team;
	struct rb_error err;

	(void)state;
	fill(&cloud, MOST, 1, true);
	attract(&cloud, 0.5, NULL);
	memcpy(alone, cloud.a, sizeof cloud.a);
	memcpy(alone[3], cloud.potential, sizeof alone[3]);
	assert_int_equal(rb_team_create(&team, 3, &err), RB_OK);
	attract(&cloud, 0.5, team);
	rb_team_destroy(team);
	assert_memory_equal(alone, cloud.a, sizeof cloud.a);
	assert_memory_equal(alone[3], cloud.potential, sizeof alone[3]);
}

/* More than a leaf takes at one place, and all of them there; with others near. */
static void points_at_one_place_do_not_attract_each_other(void **state)
{
	enum { SAME = 200 };

	(void)state;
	fill(&cloud, SAME + 1, 1, false);
	for (int i = 0; i < SAME; i++)
		for (int m = 0; m < 3; m++)
			cloud.x[m][i] = 0.5;
	cloud.x[0][SAME] = 1.5;
	cloud.x[1][SAME] = cloud.x[2][SAME] = 0.5;
	cloud.mu[SAME] = 2;
	attract(&cloud, 0.5, NULL);
	double sum = 0;
	for (int i = 0; i < SAME; i++) {
		assert_true(fabs(cloud.a[0][i] - 2) <= 1e-12);
		assert_true(fabs(cloud.potential[i] - 2) <= 1e-12);
		sum += cloud.mu[i];
	}
	assert_true(fabs(cloud.a[0][SAME] + sum) <= 1e-12 * sum);
	cloud.all.count = SAME;
	attract(&cloud, 0.5, NULL);
	for (int i = 0; i < SAME; i++)
		assert_true(cloud.a[0][i] == 0 && cloud.potential[i] == 0);
}

/* Closer than single precision has numbers for their squares: as near points are summed first. */
static void points_as_close_as_doubles_can_be_attract_each_other(void **state)
{
	(void)state;
	for (int exponent = -160; exponent <= -40; exponent++) {
		const double close = exp2(exponent);

		fill(&cloud, 66, 1, false);
		for (int i = 0; i < 64; i++)
			cloud.x[0][i] = i % 2 ? 1 : -1;
		for (int m = 0; m < 3; m++) {
			cloud.x[m][0] = 1;
			cloud.x[m][1] = -1;
			cloud.x[m][64] = 0;
			cloud.x[m][65] = m == 0 ? close : 0;
		}
		cloud.mu[64] = cloud.mu[65] = 1;
		attract(&cloud, 0.5, NULL);
		assert_true(fabs(cloud.a[0][64] * close * close - 1) <= 1e-13);
		assert_true(fabs(cloud.a[0][65] * close * close + 1) <= 1e-13);
		assert_true(fabs(cloud.potential[64] * close - 1) <= 1e-9);
	}
}

static void lack_of_memory_is_told(void **state)
{
	struct rb_tree *tree;
	struct rb_error err;

	(void)state;
	fill(&cloud, 300, 1, false);
	for (uint64_t k = 1;; k++) {
		rb_memory_fail_at(k);
		enum rb_status status = rb_tree_create(&tree, &err);
		if (status == RB_OK)
			status = rb_tree_attract(tree, &cloud.all, 0.5, NULL, cloud.to, &err);
		rb_memory_fail_at(0);
		rb_tree_destroy(tree);
		if (status == RB_OK) {
			assert_true(k > 10);
			return;
		}
		assert_int_equal(status, RB_ERR_MEMORY);
	}
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(moments_act_as_their_points_do),
		cmocka_unit_test(accelerations_are_those_of_all_pairs_but_for_1e_4),
		cmocka_unit_test(forces_cancel_to_rounding),
		cmocka_unit_test(a_team_finds_the_same_bits),
		cmocka_unit_test(points_at_one_place_do_not_attract_each_other),
		cmocka_unit_test(points_as_close_as_doubles_can_be_attract_each_other),
		cmocka_unit_test(lack_of_memory_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
