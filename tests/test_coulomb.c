/* SPDX-License-Identifier: MIT */
#include "piles.h"

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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_of_a_face_that_contradict_each_other_are_given_up_soon),
		cmocka_unit_test(forces_of_joints_begin_with_a_guess),
		cmocka_unit_test(a_large_friction_is_found_that_a_small_one_leads_to),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
