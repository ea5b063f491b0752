/* SPDX-License-Identifier: MIT */
/* src/constraint/simultaneous.c, cone.c, exact_sum.h */
#include "patience.h"
#include "piles.h"
#include "sanitized.h"

#include "base/hash.h"
#include "base/memory.h"
#include "constraint/exact_sum.h"

#include <float.h>

static const rb_vec3 still = {0, 0, 0}, up = {0, 0, 1}, gravity = {0, 0, -9.81};

/* Reproducible numbers in [0, 1). */
static double chance(uint64_t *seed)
{
	*seed = rb_hash_mix(*seed + 0x9e3779b97f4a7c15u);
	return (double)(*seed >> 11) * 0x1p-53;
}

static void assert_vec(rb_vec3 a, double x, double y, double z, double tolerance)
{
	assert_near(a.x, x, tolerance);
	assert_near(a.y, y, tolerance);
	assert_near(a.z, z, tolerance);
}

static void a_sum_does_not_depend_on_order_and_is_odd(void **state)
{
	uint64_t seed = 1;

	(void)state;
	for (int round = 0; round < tried(2000, 500, 500); round++) {
		double term[64] = {0}, other[64];
		const int count = 1 + (int)(chance(&seed) * 64);

		for (int i = 0; i < count; i++)
			term[i] = ldexp(chance(&seed) - 0.5, (int)(chance(&seed) * 80) - 40);
		const double sum = rb_exact_sum(term, count);
		memcpy(other, term, sizeof term);
		for (int i = count - 1; i > 0; i--) {
			const int k = (int)(chance(&seed) * (i + 1));
			const double swap = other[i];

			other[i] = other[k];
			other[k] = swap;
		}
		assert_true(rb_exact_sum(other, count) == sum);
		for (int i = 0; i < count; i++)
			other[i] = -other[i];
		assert_true(rb_exact_sum(other, count) == -sum);
		long double wide = 0;
		for (int i = 0; i < count; i++)
			wide += (long double)term[i];
		assert_near(sum, (double)wide, DBL_EPSILON * fabs(sum) + 1e-5);
	}
	assert_true(rb_exact_sum((double[]){1e16, 1, -1e16, 1e-16}, 4) == 1);
	assert_true(rb_exact_sum((double[]){0, 0, 0}, 3) == 0);
}

static void open_cradle(struct pile *p, int count, int moving, double restitution)
{
	pile_open(p, count, count);
	for (int i = 0; i < count; i++) {
		ball(p, 1, 1, (rb_vec3){2 * i, 0, 0}, (rb_vec3){i < moving, 0, 0});
		if (i > 0)
			touch(p, i, i + 1, 0, restitution);
	}
}

static void a_touching_cradle_passes_on_as_many_as_come(void **state)
{
	(void)state;
	for (int count = 2; count <= 200; count = count < 8 ? count + 1 : 5 * count) {
		for (int moving = 1; moving < count && moving <= 3; moving++) {
			struct pile p;

			open_cradle(&p, count, moving, 1);
			assert_true(hit(&p, NULL));
			for (int i = 1; i <= count; i++)
				assert_vec(velocity(&p, i), i > count - moving, 0, 0, 1e-14);
			pile_close(&p);
		}
	}
}

/* As if there were gaps: u is restitution times what it was, and there are as many impacts as it takes. */
static void three_balls_with_half_restitution_are_hit_in_turn(void **state)
{
	struct pile p;

	(void)state;
	open_cradle(&p, 3, 1, 0.5);
	assert_true(hit(&p, NULL));
	assert_vec(velocity(&p, 1), 0.203125, 0, 0, 1e-15);
	assert_vec(velocity(&p, 2), 0.234375, 0, 0, 1e-15);
	assert_vec(velocity(&p, 3), 0.5625, 0, 0, 1e-15);
	assert_near(p.joint.contact[0].approach, 1, 0);
	assert_near(p.joint.contact[1].approach, 0.75, 1e-15);
	pile_close(&p);
	open_cradle(&p, 3, 1, 0);
	assert_true(hit(&p, NULL));
	for (int i = 1; i <= 3; i++)
		assert_near(velocity(&p, i).x, 1.0 / 3, 1e-15);
	pile_close(&p);
}

static void two_balls_on_a_wall_come_back(void **state)
{
	struct pile p;

	(void)state;
	pile_open(&p, 2, 2);
	ball(&p, 1, 1, still, (rb_vec3){1, 0, 0});
	ball(&p, 1, 1, (rb_vec3){2, 0, 0}, still);
	touch(&p, 1, 2, 0, 1);
	plane(&p, 2, (rb_vec3){-1, 0, 0}, 0, 1);
	assert_true(hit(&p, NULL));
	assert_vec(velocity(&p, 1), -1, 0, 0, 1e-15);
	assert_vec(velocity(&p, 2), 0, 0, 0, 1e-15);
	pile_close(&p);
}

static void a_symmetric_break_stays_symmetric(void **state)
{
	static const double restitutions[] = {0, 0.3, 0.9, 1};

	(void)state;
	for (int k = 0; k < 4; k++) {
		const double e = restitutions[k], target = 0.6 * (1 + e) / sqrt(3);
		struct pile p;

		pile_open(&p, 3, 3);
		ball(&p, 1, 1, still, (rb_vec3){1, 0, 0});
		ball(&p, 1, 1, (rb_vec3){sqrt(3), 1, 0}, still);
		ball(&p, 1, 1, (rb_vec3){sqrt(3), -1, 0}, still);
		touch(&p, 1, 2, 0, e);
		touch(&p, 1, 3, 0, e);
		touch(&p, 2, 3, 0, e);
		assert_true(hit(&p, NULL));
		assert_vec(velocity(&p, 1), 1 - 0.6 * (1 + e), 0, 0, 2e-15);
		assert_vec(velocity(&p, 2), target * sqrt(3) / 2, target / 2, 0, 2e-15);
		assert_true(velocity(&p, 1).y == 0);
		assert_true(velocity(&p, 2).x == velocity(&p, 3).x);
		assert_true(velocity(&p, 2).y == -velocity(&p, 3).y);
		pile_close(&p);
	}
}

static void a_ball_in_a_corner_turns_back(void **state)
{
	struct pile p;

	(void)state;
	for (int e = 0; e <= 1; e++) {
		pile_open(&p, 1, 3);
		ball(&p, 1, 2, (rb_vec3){1, 1, 1}, (rb_vec3){-1, -2, -3});
		plane(&p, 1, (rb_vec3){1, 0, 0}, 0, e);
		plane(&p, 1, (rb_vec3){0, 1, 0}, 0, e);
		plane(&p, 1, (rb_vec3){0, 0, 1}, 0, e);
		assert_true(hit(&p, NULL));
		assert_vec(velocity(&p, 1), e, 2 * e, 3 * e, 4e-15);
		pile_close(&p);
	}
}

/* Two planes at +-60 degrees to the vertical: straight down into the wedge. */
static void a_ball_in_a_wedge_turns_back(void **state)
{
	const rb_vec3 left = {0.5, 0, sqrt(0.75)}, right = {-0.5, 0, sqrt(0.75)};
	struct pile p;

	(void)state;
	for (int mu = 0; mu <= 1; mu++) {
		pile_open(&p, 1, 2);
		ball(&p, 1, 1, up, (rb_vec3){0, 0, -1});
		plane(&p, 1, left, mu, 0.5);
		plane(&p, 1, right, mu, 0.5);
		assert_true(hit(&p, NULL));
		assert_true(velocity(&p, 1).x == 0 && velocity(&p, 1).y == 0);
		assert_true(velocity(&p, 1).z >= 0 && velocity(&p, 1).z <= 0.5 + 1e-15);
		if (mu == 0)
			assert_near(velocity(&p, 1).z, 0.5, 1e-15);
		assert_true(rb_vec3_length(p.joint.body[1].angular) == 0);
		pile_close(&p);
	}
}

static void a_shock_goes_through_a_resting_ball(void **state)
{
	struct pile p;

	(void)state;
	pile_open(&p, 2, 2);
	ball(&p, 1, 1, up, still);
	ball(&p, 1, 1, (rb_vec3){0, 0, 3}, (rb_vec3){0, 0, -1});
	plane(&p, 1, up, 0.5, 1);
	touch(&p, 1, 2, 0.5, 1);
	assert_true(hit(&p, NULL));
	assert_vec(velocity(&p, 1), 0, 0, 0, 1e-15);
	assert_vec(velocity(&p, 2), 0, 0, 1, 1e-15);
	pile_close(&p);
}

/* One sphere on a plane, in closed form: v' and w' of Newton's law with Coulomb friction. */
static void one_contact_obeys_newton_and_coulomb(void **state)
{
	struct pile p;

	(void)state;
	for (int k = 0; k < 2; k++) {
		const double mu = k == 0 ? 0.1 : 2, e = 0.7;

		pile_open(&p, 1, 1);
		ball(&p, 0.5, 3, still, (rb_vec3){2, 0, -1});
		plane(&p, 1, up, mu, e);
		assert_true(hit(&p, NULL));
		/* slips: loses mu (1 + e); grips: 2/7 of the slip */
		const double lost = k == 0 ? mu * (1 + e) : 2 * 2.0 / 7;
		assert_vec(velocity(&p, 1), 2 - lost, 0, e, 1e-15);
		assert_near(p.joint.body[1].angular.y, 2.5 * lost / 0.5, 1e-14);
		assert_near(p.joint.contact[0].approach, 1, 0);
		pile_close(&p);
	}
}

static void open_column(struct pile *p, int count, double friction, double ratio)
{
	pile_open(p, count, count);
	for (int i = 0; i < count; i++) {
		ball(p, 1, i % 2 == 1 ? ratio : 1, (rb_vec3){0, 0, 1 + 2 * i}, still);
		if (i == 0)
			plane(p, 1, up, friction, 0);
		else
			touch(p, i, i + 1, friction, 0);
	}
}

static void inelastic_columns_stop_in_one_solve(void **state)
{
	static const double ratios[] = {1, 1e3, 1e9};

	(void)state;
	for (int k = 0; k < 3; k++) {
		const int count = ratios[k] < 1e9 ? 200 : 2;
		struct pile p;
		int rounds;

		open_column(&p, count, 0.5, ratios[k]);
		for (int i = 1; i <= count; i++)
			p.joint.body[i].linear.z = -1;
		assert_true(hit(&p, &rounds));
		assert_true(rounds <= 2);
		assert_true(fastest(&p) <= 1e-14);
		pile_close(&p);
	}
}

static void columns_stand_without_any_lateral_acceleration(void **state)
{
	static const double ratios[] = {1, 1e-3, 1e9};

	(void)state;
	for (int k = 0; k < 3; k++) {
		const int count = ratios[k] < 1e9 ? 200 : 3;
		struct pile p;
		double weight = 0;

		open_column(&p, count, 0.5, ratios[k]);
		assert_true(load(&p, gravity) <= 1e-14);
		assert_true(fastest(&p) <= 1e-12 * 9.81);
		for (int i = 1; i <= count; i++) {
			assert_true(velocity(&p, i).x == 0 && velocity(&p, i).y == 0);
			weight += 9.81 / p.joint.body[i].inverse_mass;
		}
		assert_near(-p.joint.contact[0].impulse.z, weight, 1e-12 * weight);
		pile_close(&p);
	}
}

static int cell(int n, int i, int j, int k)
{
	return 1 + i + n * (j + n * k);
}

/* n^3 balls that touch each other and the walls and the floor of a box without a lid. */
static void open_lattice(struct pile *p, int n, double friction)
{
	pile_open(p, n * n * n, 3 * n * n * (n + 1));
	for (int c = 0; c < n * n * n; c++)
		ball(p, 0.05, 1, (rb_vec3){0.1 * (c % n), 0.1 * (c / n % n), 0.1 * (c / n / n)},
		     still);
	for (int c = 0; c < n * n * n; c++) {
		const int at[3] = {c % n, c / n % n, c / n / n};

		for (int axis = 0; axis < 3; axis++) {
			const rb_vec3 inwards = {axis == 0, axis == 1, axis == 2};
			int next[3] = {at[0], at[1], at[2]};

			next[axis]++;
			if (at[axis] == 0)
				plane(p, c + 1, inwards, friction, 1);
			if (next[axis] < n)
				touch(p, c + 1, cell(n, next[0], next[1], next[2]), friction, 1);
			else if (axis < 2)
				plane(p, c + 1, rb_vec3_neg(inwards), friction, 1);
		}
	}
}

static void lattices_in_a_box_stay(void **state)
{
	(void)state;
	for (int n = 2; n <= tried(10, 6, 6); n += 4) {
		for (int rough = 0; rough <= 1; rough++) {
			struct pile p;

			open_lattice(&p, n, 0.5 * rough);
			assert_true(load(&p, gravity) <= 1e-13);
			assert_true(fastest(&p) <= 1e-12 * 9.81);
			assert_true(cone_excess(&p) <= 1e-15);
			pile_close(&p);
		}
	}
}

/* Layers of a face-centred cubic packing, in a box. */
static void a_face_centred_block_in_a_box_stays(void **state)
{
	enum { N = 4 };
	const double h = sqrt(2);
	struct pile p;

	(void)state;
	pile_open(&p, 4 * N * N * N, 64 * N * N * N);
	for (int i = 0; i < 2 * N; i++)
		for (int j = 0; j < 2 * N; j++)
			for (int k = 0; k < 2 * N; k++)
				if ((i + j + k) % 2 == 0)
					ball(&p, 1, 1, (rb_vec3){h * i, h * j, h * k}, still);
	for (int a = 1; a < p.joint.body_count; a++) {
		const rb_vec3 x = p.place[a];

		for (int b = a + 1; b < p.joint.body_count; b++)
			if (rb_vec3_length(rb_vec3_sub(p.place[b], x)) < 2.001)
				touch(&p, a, b, 0, 0);
		if (x.x < 0.1)
			plane(&p, a, (rb_vec3){1, 0, 0}, 0, 0);
		if (x.y < 0.1)
			plane(&p, a, (rb_vec3){0, 1, 0}, 0, 0);
		if (x.z < 0.1)
			plane(&p, a, up, 0, 0);
		if (x.x > h * (2 * N - 1.1))
			plane(&p, a, (rb_vec3){-1, 0, 0}, 0, 0);
		if (x.y > h * (2 * N - 1.1))
			plane(&p, a, (rb_vec3){0, -1, 0}, 0, 0);
	}
	assert_true(load(&p, gravity) <= 1e-13);
	assert_true(fastest(&p) <= 1e-12 * 9.81);
	pile_close(&p);
}

static void open_pyramid(struct pile *p, int n, double friction)
{
	pile_open(p, n * n * n, 8 * n * n * n);
	for (int k = 0; k < n; k++)
		for (int c = 0; c < (n - k) * (n - k); c++)
			ball(p, 1, 1,
			     (rb_vec3){2 * (c % (n - k)) + k, 2 * (c / (n - k)) + k,
			               sqrt(2) * k + 1},
			     still);
	for (int a = 1; a < p->joint.body_count; a++) {
		for (int b = a + 1; b < p->joint.body_count; b++)
			if (rb_vec3_length(rb_vec3_sub(p->place[b], p->place[a])) < 2.001)
				touch(p, a, b, friction, 0);
		if (a <= n * n)
			plane(p, a, up, friction, 0);
	}
}

static void pyramids_are_solved(void **state)
{
	(void)state;
	for (int k = 0; k < 3; k++) {
		struct pile p;

		open_pyramid(&p, 4, 0.3 * k);
		assert_true(load(&p, gravity) <= 1e-12);
		assert_true(cone_excess(&p) <= 1e-14);
		assert_true(fastest(&p) < 9.81);
		pile_close(&p);
	}
}

static void a_ball_in_a_corner_rests(void **state)
{
	struct pile p;

	(void)state;
	pile_open(&p, 1, 3);
	ball(&p, 1, 2, still, still);
	plane(&p, 1, (rb_vec3){1, 0, 0}, 0.5, 0);
	plane(&p, 1, (rb_vec3){0, 1, 0}, 0.5, 0);
	plane(&p, 1, up, 0.5, 0);
	assert_true(load(&p, (rb_vec3){-3, -4, -5}) <= 1e-14);
	assert_true(fastest(&p) <= 1e-14);
	for (int k = 0; k < 3; k++)
		assert_false(p.joint.contact[k].slipping);
	pile_close(&p);
}

/* tan 30 = 0.577: friction above 2/7 of it rolls, below it slips. */
static void a_ball_on_a_slope_rolls_or_slips(void **state)
{
	const double g = 9.81, s = 0.5, c = sqrt(0.75);
	struct pile p;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double mu = k == 1 ? 0.1 : 0.5;

		pile_open(&p, 1, 1);
		ball(&p, 0.25, 2, still, still);
		struct rb_solver_contact *contact = plane(&p, 1, up, mu, 0);
		if (k == 2) { /* slides up: velocity of the plane relative to the ball */
			contact->mode = RB_SOLVER_SLIDE;
			contact->slip = (rb_vec3){1, 0, 0};
		}
		assert_true(load(&p, (rb_vec3){g * s, 0, -g * c}) <= 1e-14);
		const double push = k == 0 ? 2.0 / 7 * g * s : k == 1 ? mu * g * c : -mu * g * c;
		assert_vec(velocity(&p, 1), g * s - push, 0, 0, 4e-15);
		assert_near(p.joint.body[1].angular.y, 2.5 * push / 0.25, 4e-14);
		assert_true(contact->slipping == (k > 0));
		pile_close(&p);
	}
}

/*
 * A V groove along x of planes at 45 degrees, tilted: every plane carries N = m g' / sqrt(2) and rubs along the groove; in
 * rolling the axis to the contacts is r / sqrt(2), a = g_x / (1 + 2 k^2/r^2) with k^2 = 2/5 r^2.
 */
static void a_ball_in_a_groove_rolls_or_slips(void **state)
{
	const double across = sqrt(0.5), gx = 3, gz = 9;
	struct pile p;

	(void)state;
	for (int k = 0; k < 2; k++) {
		const double mu = k == 0 ? 0.9 : 0.05;

		pile_open(&p, 1, 2);
		ball(&p, 0.5, 3, still, still);
		plane(&p, 1, (rb_vec3){0, across, across}, mu, 0);
		plane(&p, 1, (rb_vec3){0, -across, across}, mu, 0);
		assert_true(load(&p, (rb_vec3){gx, 0, -gz}) <= 1e-14);
		const double a = k == 0 ? gx / 1.8 : gx - 2 * mu * gz * across;
		assert_vec(velocity(&p, 1), a, 0, 0, 1e-14);
		assert_near(p.joint.contact[0].impulse.z, -3 * gz / 2, 1e-13);
		assert_true(p.joint.contact[0].slipping == (k == 1));
		pile_close(&p);
	}
}

/* Balls of many sizes that touch as they please; `equal`: one friction and one restitution for all. */
static void open_random(struct pile *p, uint64_t *seed, double most_friction)
{
	const int count = 2 + (int)(chance(seed) * 8);
	const double spread = chance(seed) < 0.5 ? 1 : 7;
	const bool equal = chance(seed) < 0.3;
	const double e = chance(seed) < 0.5 ? 1 : chance(seed), mu = most_friction * chance(seed);

	pile_open(p, count, count * count);
	for (int i = 1; i <= count; i++) {
		const double radius = exp(chance(seed) - 0.5);
		const double mass = exp(spread * (2 * chance(seed) - 1));
		const double x = 4 * chance(seed), y = 4 * chance(seed), z = 3 * chance(seed);
		const double u = chance(seed) - 0.5, v = chance(seed) - 0.5, w = chance(seed) - 0.5;

		ball(p, radius, mass, (rb_vec3){x, y, z}, (rb_vec3){u, v, w});
		p->joint.body[i].angular = (rb_vec3){w - u, chance(seed) - 0.5, u * v};
	}
	for (int a = 1; a <= count; a++) {
		for (int b = a + 1; b <= count + 1; b++) {
			const double f = most_friction * chance(seed);
			double r = chance(seed);
			const bool floor = b > count;

			r = r < 0.15 ? 0 : r > 0.85 ? 1 : r;
			if (floor && p->place[a].z < 1)
				plane(p, a, up, equal ? mu : f, equal ? e : r);
			if (!floor && rb_vec3_length(rb_vec3_sub(p->place[b], p->place[a])) <
			                      1.3 * (p->radius[a] + p->radius[b]))
				touch(p, a, b, equal ? mu : f, equal ? e : r);
		}
	}
}

static void random_clusters_keep_the_laws(void **state)
{
	uint64_t seed = 7;
	int unsettled = 0;

	(void)state;
	for (int round = 0; round < tried(600, 150, 150); round++) {
		struct pile p;

		open_random(&p, &seed, round % 4 == 0 ? 0 : 1.5);
		const double before = energy(&p);
		rb_vec3 sum = momentum(&p);
		const double fast = 10 * fastest(&p);
		unsettled += !hit(&p, NULL);
		assert_true(energy(&p) <= before * (1 + 1e-13));
		assert_true(largest_approach(&p) <= 1e-12 * fast);
		assert_true(cone_excess(&p) <= 1e-12);
		double size = 0;
		for (int k = 0; k < p.joint.contact_count; k++) {
			const struct rb_solver_contact *c = &p.joint.contact[k];

			size = fmax(size, rb_vec3_length(c->impulse));
			if (c->b == 0)
				sum = rb_vec3_sub(sum, c->impulse);
		}
		size = fmax(size, rb_vec3_length(sum));
		assert_true(rb_vec3_length(rb_vec3_sub(sum, momentum(&p))) <= 1e-12 * size);
		pile_close(&p);
	}
	assert_true(unsettled < 30);
}

static void random_clusters_find_their_forces(void **state)
{
	uint64_t seed = 8;

	(void)state;
	for (int round = 0; round < tried(200, 50, 50); round++) {
		struct pile p;

		open_random(&p, &seed, 0.7);
		for (int i = 1; i < p.joint.body_count; i++)
			p.joint.body[i].linear = p.joint.body[i].angular = still;
		assert_true(load(&p, gravity) <= 1e-9);
		assert_true(largest_approach(&p) <= 1e-9);
		assert_true(cone_excess(&p) <= 1e-12);
		pile_close(&p);
	}
}

/* Bodies and contacts in another order, contacts with a and b exchanged, all of it mirrored in plane `mirror` (or not: 3).
 * `place[i]` is where body i of the first went. */
static void open_image(struct pile *image, const struct pile *p, int mirror, uint64_t *seed,
                       int *body_at, int *contact_at)
{
	const int bodies = p->joint.body_count, contacts = p->joint.contact_count;
	const rb_vec3 s = {mirror == 0 ? -1 : 1, mirror == 1 ? -1 : 1, mirror == 2 ? -1 : 1};
	const double turned = mirror < 3 ? -1 : 1;

	pile_open(image, bodies, contacts);
	image->joint.body_count = bodies;
	image->joint.contact_count = contacts;
	for (int i = 0; i < bodies; i++)
		body_at[i] = i;
	for (int i = 0; i < contacts; i++)
		contact_at[i] = i;
	for (int i = bodies - 1; i > 1; i--) {
		const int k = 1 + (int)(chance(seed) * i), swap = body_at[i];

		body_at[i] = body_at[k];
		body_at[k] = swap;
	}
	for (int i = contacts - 1; i > 0; i--) {
		const int k = (int)(chance(seed) * (i + 1)), swap = contact_at[i];

		contact_at[i] = contact_at[k];
		contact_at[k] = swap;
	}
	for (int i = 0; i < bodies; i++) {
		struct rb_solver_body b = p->joint.body[i];

		b.linear = (rb_vec3){s.x * b.linear.x, s.y * b.linear.y, s.z * b.linear.z};
		b.angular = (rb_vec3){turned * s.x * b.angular.x, turned * s.y * b.angular.y,
		                      turned * s.z * b.angular.z};
		image->joint.body[body_at[i]] = b;
	}
	for (int k = 0; k < contacts; k++) {
		struct rb_solver_contact c = p->joint.contact[k];
		rb_vec3 *const v[] = {&c.normal, &c.arm_a, &c.arm_b, &c.slip};

		for (int i = 0; i < 4; i++)
			*v[i] = (rb_vec3){s.x * v[i]->x, s.y * v[i]->y, s.z * v[i]->z};
		c.a = body_at[c.a];
		c.b = body_at[c.b];
		if (k % 2 == 1) {
			const int a = c.a;
			const rb_vec3 arm = c.arm_a;

			c.a = c.b;
			c.b = a;
			c.arm_a = c.arm_b;
			c.arm_b = arm;
			c.normal = rb_vec3_neg(c.normal);
			c.slip = rb_vec3_neg(c.slip);
		}
		image->joint.contact[contact_at[k]] = c;
	}
}

static void assert_image(const struct pile *p, const struct pile *image, int mirror,
                         const int *body_at)
{
	const rb_vec3 s = {mirror == 0 ? -1 : 1, mirror == 1 ? -1 : 1, mirror == 2 ? -1 : 1};
	const double turned = mirror < 3 ? -1 : 1;

	for (int i = 1; i < p->joint.body_count; i++) {
		const struct rb_solver_body *b = &p->joint.body[i],
					    *c = &image->joint.body[body_at[i]];

		assert_true(c->linear.x == s.x * b->linear.x);
		assert_true(c->linear.y == s.y * b->linear.y);
		assert_true(c->linear.z == s.z * b->linear.z);
		assert_true(c->angular.x == turned * s.x * b->angular.x);
		assert_true(c->angular.y == turned * s.y * b->angular.y);
		assert_true(c->angular.z == turned * s.z * b->angular.z);
	}
}

static void any_order_and_any_mirror_image_give_the_same_bits(void **state)
{
	uint64_t seed = 9;

	(void)state;
	for (int round = 0; round < tried(160, 40, 40); round++) {
		struct pile p, image;
		int body_at[16], contact_at[128];
		const int mirror = round % 4;
		const bool forces = round % 8 >= 4;

		open_random(&p, &seed, forces ? 0.6 : 1.2);
		for (int k = 0; forces && k < p.joint.contact_count; k += 3) {
			p.joint.contact[k].mode = RB_SOLVER_SLIDE;
			p.joint.contact[k].slip = rb_vec3_across(p.joint.contact[k].normal);
			p.joint.contact[k].friction *= 0.2;
		}
		open_image(&image, &p, mirror, &seed, body_at, contact_at);
		if (forces) {
			const rb_vec3 g = {1, 2, -9};
			const rb_vec3 h = {mirror == 0 ? -1 : 1, mirror == 1 ? -2 : 2,
			                   mirror == 2 ? 9 : -9};

			assert_true(load(&p, g) == load(&image, h));
		} else {
			int rounds, other;

			assert_true(hit(&p, &rounds) == hit(&image, &other));
			assert_int_equal(rounds, other);
		}
		assert_image(&p, &image, mirror, body_at);
		for (int k = 0; k < p.joint.contact_count; k++) {
			const struct rb_solver_contact *c = &p.joint.contact[k],
						       *d = &image.joint.contact[contact_at[k]];

			assert_true(d->approach == c->approach && d->slipping == c->slipping);
			assert_true(rb_vec3_dot(d->impulse, d->normal) ==
			            rb_vec3_dot(c->impulse, c->normal));
		}
		pile_close(&p);
		pile_close(&image);
	}
}

/* The inertia of a sphere, written as a tensor. */
static void as_tensor(struct pile *p, int which)
{
	struct rb_solver_body *const body = &p->joint.body[which];
	const double i = sqrt(body->inverse_inertia);

	p->root[which] = rb_mat3_diagonal(i, i, i);
	body->inverse_inertia = (double)NAN;
}

static void a_tensor_that_is_a_sphere_s_is_a_sphere(void **state)
{
	(void)state;
	for (int contacts = 1; contacts <= 3; contacts++) {
		struct pile p, q;

		for (int tensor = 0; tensor <= 1; tensor++) {
			struct pile *const r = tensor ? &q : &p;

			pile_open(r, 1, 3);
			ball(r, 0.5, 3, still, (rb_vec3){1, -2, -3});
			r->joint.body[1].angular = (rb_vec3){0.5, 2, 1};
			plane(r, 1, up, 0.2, 0.6);
			if (contacts > 1)
				plane(r, 1, (rb_vec3){0, 1, 0}, 0.3, 0.4);
			if (contacts > 2)
				plane(r, 1, (rb_vec3){-1, 0, 0}, 0.9, 1);
			if (tensor)
				as_tensor(r, 1);
			assert_true(hit(r, NULL));
		}
		/* one alone is the energetic law, which is integrated; for a sphere it is Newton's */
		const double tolerance = contacts == 1 ? 1e-6 : 1e-13;
		const rb_vec3 v = velocity(&p, 1), w = p.joint.body[1].angular;
		assert_vec(velocity(&q, 1), v.x, v.y, v.z, tolerance);
		assert_vec(q.joint.body[1].angular, w.x, w.y, w.z, 10 * tolerance);
		pile_close(&p);
		pile_close(&q);
	}
}

static void want_of_memory_is_reported_and_changes_nothing(void **state)
{
	(void)state;
	for (int forces = 0; forces <= 1; forces++) {
		struct pile p;

		open_cradle(&p, 3, 1, 0);
		rb_memory_fail_at(1);
		const bool reported = forces ? isinf(load(&p, still)) : !hit(&p, NULL);
		rb_memory_fail_at(0);
		assert_true(reported);
		for (int i = 1; i <= 3; i++)
			assert_vec(velocity(&p, i), i == 1, 0, 0, 0);
		pile_close(&p);
	}
}

/* One solution may take minutes: it asks as often as its work says, and ends when it is told to. */
static void a_solution_asks_by_its_work_whether_to_go_on(void **state)
{
	enum { ROW_WORK = 1 << 10 }; /* at least, of a product */
	struct patience patience = {0};
	struct rb_interrupt interrupt = {0};
	struct pile p;
	long products = 0;

	(void)state;
	for (int k = 0; k < 2; k++) {
		open_pyramid(&p, 6, 0.5);
		rb_interrupt_begin(&interrupt, count_calls, &patience);
		p.joint.interrupt = &interrupt;
		(void)load(&p, gravity);
		if (k == 0) {
			products = p.joint.products;
			const double work = (double)products * p.joint.contact_count * ROW_WORK;
			assert_true(work > 8.0 * RB_INTERRUPT_WORK);
			assert_true(patience.calls >= (int)(work / RB_INTERRUPT_WORK) - 1);
			assert_false(rb_simultaneous_is_over(&p.joint));
			patience = (struct patience){.last = 2};
		} else {
			assert_int_equal(patience.calls, patience.last);
			assert_true(rb_simultaneous_is_over(&p.joint));
			assert_true(p.joint.products < products / 2);
		}
		pile_close(&p);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sum_does_not_depend_on_order_and_is_odd),
		cmocka_unit_test(a_touching_cradle_passes_on_as_many_as_come),
		cmocka_unit_test(three_balls_with_half_restitution_are_hit_in_turn),
		cmocka_unit_test(two_balls_on_a_wall_come_back),
		cmocka_unit_test(a_symmetric_break_stays_symmetric),
		cmocka_unit_test(a_ball_in_a_corner_turns_back),
		cmocka_unit_test(a_ball_in_a_wedge_turns_back),
		cmocka_unit_test(a_shock_goes_through_a_resting_ball),
		cmocka_unit_test(one_contact_obeys_newton_and_coulomb),
		cmocka_unit_test(inelastic_columns_stop_in_one_solve),
		cmocka_unit_test(columns_stand_without_any_lateral_acceleration),
		cmocka_unit_test(lattices_in_a_box_stay),
		cmocka_unit_test(a_face_centred_block_in_a_box_stays),
		cmocka_unit_test(pyramids_are_solved),
		cmocka_unit_test(a_ball_in_a_corner_rests),
		cmocka_unit_test(a_ball_on_a_slope_rolls_or_slips),
		cmocka_unit_test(a_ball_in_a_groove_rolls_or_slips),
		cmocka_unit_test(a_tensor_that_is_a_sphere_s_is_a_sphere),
		cmocka_unit_test(want_of_memory_is_reported_and_changes_nothing),
		cmocka_unit_test(a_solution_asks_by_its_work_whether_to_go_on),
		cmocka_unit_test(random_clusters_keep_the_laws),
		cmocka_unit_test(random_clusters_find_their_forces),
		cmocka_unit_test(any_order_and_any_mirror_image_give_the_same_bits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
