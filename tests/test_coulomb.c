/* SPDX-License-Identifier: MIT */
#include "piles.h"

#include "base/hash.h"
#include "math/quat.h"
#include "math/random.h"

/*
 * A face on a plane, with more points than its three freedoms, which differ in acceleration by little. Forces that hold all of
 * them do not exist; what comes nearest is found by Newton steps, each of a few products for each row, and not again and again.
 */
static void points_of_a_face_that_contradict_each_other_are_given_up_soon(void **state)
{
	const rb_vec3 gravity = {0.3, 0.1, -9.81};
	const double contradiction = 1e-10;

	(void)state;
	for (int points = 4; points < 12; points++) {
		struct pile p;

		pile_open(&p, 1, points);
		ball(&p, 1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
		for (int k = 0; k < points; k++) {
			struct rb_solver_contact *c = plane(&p, 1, (rb_vec3){0, 0, 1}, 0, 0);

			c->arm_a = (rb_vec3){cos(k), sin(k), -1};
			c->bias = (rb_vec3){0, 0, contradiction * sin(k * k)};
		}
		assert_true(load(&p, gravity) <= 2 * contradiction);
		assert_true(p.joint.products <= 32 * points * points);
		pile_close(&p);
	}
}

/* Two rows of a joint that carry the same: as they are guessed to share it, within their bounds. */
static void forces_of_joints_begin_with_a_guess(void **state)
{
	struct rb_cone_row row[2];
	struct pile p;

	(void)state;
	pile_open(&p, 1, 0);
	ball(&p, 1, 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	for (int k = 0; k < 2; k++) {
		row[k] = (struct rb_cone_row){.base = {.b = 1,
		                                       .set = RB_CONSTRAINT_INTERVAL,
		                                       .normal = {0, 0, 1},
		                                       .low = -7,
		                                       .high = 7}};
		row[k].base.impulse.n = k == 0 ? 9 : 3;
	}
	p.joint.joint_row = row;
	p.joint.joint_count = 2;
	assert_true(load(&p, (rb_vec3){0, 0, -5}) <= 1e-14);
	assert_near(row[0].base.impulse.n, 7, 1e-14);
	assert_near(row[1].base.impulse.n, 3, 1e-14);
	pile_close(&p);
}

/* Of -1 to 1. */
static double drawn(uint64_t seed, uint64_t *index)
{
	return 2 * rb_random_unit(seed, 0, (*index)++) - 1;
}

/* Does what is left of the friction's law vanish: no slip, or friction at the cone against it? */
static bool slips_as_the_law_says(const struct pile *p, double scale)
{
	for (int k = 0; k < p->joint.contact_count; k++) {
		const struct rb_solver_contact *c = &p->joint.contact[k];
		const rb_vec3 u = rb_vec3_reject(
			rb_vec3_add(rb_vec3_sub(point_velocity(p, c->b, c->arm_b),
		                                point_velocity(p, c->a, c->arm_a)),
		                    c->bias),
			c->normal);
		const rb_vec3 t = rb_vec3_reject(c->impulse, c->normal);
		const double n = rb_vec3_dot(c->impulse, c->normal), speed = rb_vec3_length(u);

		if (n > 0 && speed > 1e-7 * scale &&
		    rb_vec3_length(rb_vec3_add_scaled(t, c->friction * n / speed, u)) >
		            1e-7 * c->friction * n)
			return false;
	}
	return true;
}

/*
 * A body on a floor that begins to slip there: its friction goes against the way that it goes, which follows from the friction.
 * With less than 1 / mu of the weight as the normal force, next to nothing of the problem says which way that is.
 */
static void a_large_friction_is_found_that_a_small_one_leads_to(void **state)
{
	static const double frictions[] = {1, 10, 100, 1e3, 1e6};

	(void)state;
	for (int i = 0; i < 5; i++) {
		int wrong = 0;

		for (uint64_t seed = 1; seed <= 1000; seed++) {
			uint64_t index = 0;
			struct pile p;

			pile_open(&p, 1, 1);
			ball(&p, 1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
			struct rb_solver_contact *c = plane(&p, 1, (rb_vec3){0, 0, 1}, frictions[i],
			                                    0);

			p.joint.body[1].inverse_inertia = 2 + 20 * rb_random_unit(seed, 0, index++);
			c->arm_a = (rb_vec3){drawn(seed, &index), drawn(seed, &index),
			                     drawn(seed, &index)};
			c->bias = rb_vec3_scale(10,
			                        (rb_vec3){drawn(seed, &index), drawn(seed, &index),
			                                  drawn(seed, &index)});
			load(&p, (rb_vec3){0, 0, -9.81});
			wrong += !slips_as_the_law_says(&p, 10);
			pile_close(&p);
		}
		/* two have no solution, or one that friction jumps to */
		assert_true(wrong <= 2);
	}
}

/* Reproducible numbers in [0, 1). */
static double chance(uint64_t *seed)
{
	*seed = rb_hash_mix(*seed + 0x9e3779b97f4a7c15u);
	return (double)(*seed >> 11) * 0x1p-53;
}

/* A box on the four corners of its face, sliding, in axes turned by `q`. */
static void open_landing(struct pile *p, rb_quat q, uint64_t *seed)
{
	const rb_vec3 half = {0.02 + 0.1 * chance(seed), 0.02 + 0.1 * chance(seed),
	                      0.02 + 0.1 * chance(seed)};
	const double mass = 2;
	const rb_mat3 turn = rb_quat_to_mat3(q), back = rb_mat3_transposed(&turn);
	rb_vec3 v, w;

	pile_open(p, 1, 4);
	v = (rb_vec3){2 * chance(seed) - 1, 2 * chance(seed) - 1, -chance(seed)};
	w = (rb_vec3){2 * chance(seed) - 1, 2 * chance(seed) - 1, 4 * chance(seed) - 2};
	ball(p, 1, mass, (rb_vec3){0, 0, 0}, rb_quat_rotate(q, v));
	p->joint.body[1].angular = rb_quat_rotate(q, w);
	p->joint.body[1].inverse_inertia = (double)NAN;
	const rb_mat3 root = rb_mat3_diagonal(
		sqrt(3 / (mass * (half.y * half.y + half.z * half.z))),
		sqrt(3 / (mass * (half.x * half.x + half.z * half.z))),
		sqrt(3 / (mass * (half.x * half.x + half.y * half.y))));
	p->root[1] = rb_mat3_multiply(&root, &back);
	for (int k = 0; k < 4; k++) {
		const rb_vec3 corner = {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y,
		                        -half.z};

		add_contact(p, (struct rb_solver_contact){
				       .a = 0,
				       .b = 1,
				       .normal = rb_quat_rotate(q, (rb_vec3){0, 0, 1}),
				       .arm_b = rb_quat_rotate(q, corner),
				       .friction = 0.3});
	}
}

/*
 * Forces at four corners are not unique, and with friction what they do is not. The solver takes a
 * billionth of the speeds for nothing, and moves along what is not unique by more: spins by 1e-5,
 * since arms are a tenth. (With steps that depended on the axes: 2e-4, and 2e-6 m/s.)
 */
static void a_sliding_box_lands_alike_in_any_axes(void **state)
{
	uint64_t seed = 5;

	(void)state;
	for (int round = 0; round < 40; round++) {
		const rb_quat q = rb_quat_unit((rb_quat){chance(&seed) - 0.5, chance(&seed) - 0.5,
		                                         chance(&seed) - 0.5, chance(&seed) - 0.5});
		uint64_t first = seed;
		struct pile p, turned;

		open_landing(&p, (rb_quat){1, 0, 0, 0}, &first);
		open_landing(&turned, q, &seed);
		assert_true(hit(&p, NULL) && hit(&turned, NULL));
		const rb_vec3 v = velocity(&p, 1), w = p.joint.body[1].angular;
		assert_true(rb_vec3_length(rb_vec3_sub(rb_quat_rotate_back(q, velocity(&turned, 1)),
		                                       v)) <= 1e-7);
		assert_true(rb_vec3_length(rb_vec3_sub(
				    rb_quat_rotate_back(q, turned.joint.body[1].angular), w)) <=
		            3e-5);
		pile_close(&p);
		pile_close(&turned);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_of_a_face_that_contradict_each_other_are_given_up_soon),
		cmocka_unit_test(forces_of_joints_begin_with_a_guess),
		cmocka_unit_test(a_large_friction_is_found_that_a_small_one_leads_to),
		cmocka_unit_test(a_sliding_box_lands_alike_in_any_axes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
