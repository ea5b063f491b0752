/* SPDX-License-Identifier: MIT */
/* src/constraint/eccentric: against an integration of its own (tests/keller.h), and what holds for every impact. */
#include "support.h"

#include "impacts.h"
#include "constraint/eccentric.h"

/*
 * What goes in is rounded, K in some fifty operations: a hundred times its last digit, times the condition. The largest of
 * 8,000 (tests/bench/impact.sh) is 9e-16.
 */
static void impulses_are_those_of_the_integration(void **slot)
{
	enum { EACH = 40 };

	(void)slot;
	for (int shape = 0; shape < IMPACTS_SHAPES; shape++)
		for (uint64_t k = 0; k < EACH; k++) {
			struct impacts_check check = {0};

			assert_true(impacts_check(shape, k, 2, &check));
			assert_near(check.error / check.condition, 0, 100 * DBL_EPSILON);
			assert_true(check.gain <= 64 * DBL_EPSILON);
		}
}

static rb_mat3 yield_of(const struct keller_impact *impact)
{
	rb_mat3 inverse_effective_mass;

	for (int j = 0; j < 3; j++) {
		const real axis[3] = {j == 0, j == 1, j == 2};
		real of_a[3], of_b[3];

		keller_answer(&impact->body[0], axis, of_a);
		keller_answer(&impact->body[1], axis, of_b);
		for (int i = 0; i < 3; i++)
			inverse_effective_mass.m[i][j] = (double)(of_a[i] + of_b[i]);
	}
	return inverse_effective_mass;
}

static struct rb_eccentric contact_of(const struct keller_impact *impact)
{
	return (struct rb_eccentric){yield_of(impact), impact->normal, impact->friction,
	                             impact->restitution, 0};
}

/* Mirrored in a coordinate plane; which body is a and which b. */
static void mirror_images_and_exchanged_bodies_come_out_to_the_bit(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 400; k++) {
		const struct keller_impact impact = impacts_pick((int)(k % 4), k);
		const struct rb_eccentric contact = contact_of(&impact);
		const rb_vec3 u = impacts_velocity(&impact);
		const rb_vec3 plain = rb_eccentric_impulse(&contact, u);

		for (int axis = 0; axis < 3; axis++) {
			const double sign[3] = {axis == 0 ? -1 : 1, axis == 1 ? -1 : 1,
			                        axis == 2 ? -1 : 1};
			struct rb_eccentric image = contact;

			for (int i = 0; i < 9; i++)
				image.inverse_effective_mass.m[i / 3][i % 3] *= sign[i / 3] *
				                                                sign[i % 3];
			image.normal = (rb_vec3){sign[0] * contact.normal.x,
			                         sign[1] * contact.normal.y,
			                         sign[2] * contact.normal.z};
			const rb_vec3 mirrored = rb_eccentric_impulse(
				&image, (rb_vec3){sign[0] * u.x, sign[1] * u.y, sign[2] * u.z});
			assert_true(mirrored.x == sign[0] * plain.x &&
			            mirrored.y == sign[1] * plain.y &&
			            mirrored.z == sign[2] * plain.z);
		}
		struct rb_eccentric other = contact;
		other.normal = rb_vec3_neg(contact.normal);
		const rb_vec3 back = rb_eccentric_impulse(&other, rb_vec3_neg(u));
		assert_true(back.x == -plain.x && back.y == -plain.y && back.z == -plain.z);
	}
}

/* The law goes on where slip comes just not to its end, just to it, or starts from just nothing. */
static void a_small_change_of_slip_changes_little(void **slot)
{
	const double share = 1e-10;

	(void)slot;
	for (uint64_t k = 0; k < 2000; k++) {
		const struct keller_impact impact = impacts_pick((int)(k % 4),
		                                                 8 * k + 1 + 2 * (k % 2));
		const struct rb_eccentric contact = contact_of(&impact);
		struct impacts_series r = {.stream = k};
		const rb_vec3 u = impacts_velocity(&impact);
		const rb_vec3 plain = rb_eccentric_impulse(&contact, u);
		const rb_vec3 near = rb_eccentric_impulse(
			&contact,
			rb_vec3_add_scaled(u, share * rb_vec3_length(u),
		                           rb_vec3_reject(impacts_vector(&r), contact.normal)));

		/* the largest of these is some hundred times the change: where compression hardly ends */
		assert_true(rb_vec3_length(rb_vec3_sub(near, plain)) <=
		            1e4 * share * rb_vec3_length(plain));
	}
}

/* Whatever is finite: arms of 1e160 m, masses of 1e-300 kg, friction without bound, tensors that are none. */
static void every_impact_has_an_end_and_a_finite_impulse(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 20000; k++) {
		struct impacts_series r = {.stream = k};
		const double wide = k % 2 ? 300 : 20;
		struct keller_impact impact = impacts_pick((int)(k % 4), k / 4);
		struct rb_eccentric contact = contact_of(&impact);
		const double most = impacts_decades(&r, -wide, wide);

		for (int i = 0; i < 9; i++)
			contact.inverse_effective_mass.m[i / 3][i % 3] *=
				k % 3 ? most : most * impacts_decades(&r, -0.1 * wide, 0);
		contact.friction = impacts_decades(&r, -wide, wide);
		const double speed = impacts_decades(&r, -wide, wide);
		const rb_vec3 u = rb_vec3_scale(speed, impacts_velocity(&impact));
		const rb_vec3 impulse = rb_eccentric_impulse(&contact, u);
		const rb_vec3 after = rb_vec3_add(
			u, rb_mat3_apply(&contact.inverse_effective_mass, impulse));

		assert_true(rb_vec3_finite(impulse));
		/* where the products below are numbers */
		if (k % 3 && rb_vec3_finite(after) && fabs(log10(speed)) < 100 &&
		    fabs(log10(speed / most)) < 100)
			assert_true(rb_vec3_dot(impulse, u) + rb_vec3_dot(impulse, after) <=
			            1e-12 * rb_vec3_length(impulse) *
			                    (rb_vec3_length(u) + rb_vec3_length(after)));
	}
}

/*
 * Planar, by hand: a rod of length 2 (mass 1, I = 1/3) at 60 degrees, its lower end at rest but for slip -1 along the
 * floor; friction 2 is above (1/m + rx^2/I) / (rx rz / I), so there is no force that lets it slide on. Slip ends at the
 * impulse p with -1 + p g = 0, then the end sticks, and the normal velocity that this took is stopped.
 */
static void a_jam_ends_slip_without_an_approach(void **slot)
{
	const double rx = cos(1.0471975511965976), rz = sin(1.0471975511965976), inertia = 1.0 / 3;
	const double xx = 1 + rz * rz / inertia, nn = 1 + rx * rx / inertia;
	const double cross = rx * rz / inertia;

	(void)slot;
	for (int side = -1; side <= 1; side += 2)
		for (int e = 0; e <= 1; e++) {
			/* its arm points down to (side rx, -rz): slips towards side */
			const struct rb_eccentric contact = {
				{{{xx, 0, side * cross}, {0, 1, 0}, {side * cross, 0, nn}}},
				{0, 0, 1},
				2,
				e,
				0};
			const rb_vec3 impulse = rb_eccentric_impulse(&contact,
			                                             (rb_vec3){side, 0, 0});
			const double slow = cross - 2 * xx, fall = nn - 2 * cross;
			const double first = -1 / slow, w = first * fall, taken = -0.5 * first * w;
			const double rate = nn - cross * cross / xx, second = -w / rate;
			const double all = taken + 0.5 * rate * second * second;
			const double third = e * sqrt(2 * all / rate);

			assert_true(fall < 0);
			assert_near(impulse.z, first + second + third, 8e-15);
			assert_near(impulse.x, side * (-2 * first - cross / xx * (second + third)),
			            8e-15);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(impulses_are_those_of_the_integration),
		cmocka_unit_test(mirror_images_and_exchanged_bodies_come_out_to_the_bit),
		cmocka_unit_test(a_small_change_of_slip_changes_little),
		cmocka_unit_test(every_impact_has_an_end_and_a_finite_impulse),
		cmocka_unit_test(a_jam_ends_slip_without_an_approach),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
