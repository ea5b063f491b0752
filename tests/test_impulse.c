/* SPDX-License-Identifier: MIT */
/* src/constraint/impulse: single impacts, central and eccentric. */
#include "support.h"

#include "math/random.h"
#include "constraint/impulse.h"

static double pick(uint64_t stream, uint64_t k, double low, double high)
{
	return low + (high - low) * rb_random_unit(11, stream, k);
}

static rb_vec3 pick_vector(uint64_t stream, uint64_t k)
{
	return (rb_vec3){pick(stream, 3 * k, -1, 1), pick(stream, 3 * k + 1, -1, 1),
	                 pick(stream, 3 * k + 2, -1, 1)};
}

/* A random body, rod or box, met at a random point: K = 1/m - [r] I^-1 [r]. */
static struct rb_link random_link(uint64_t k)
{
	struct rb_link link = {.friction = pick(1, k, 0, 2), .restitution = pick(2, k, 0, 1)};
	const double mass = exp(pick(3, k, -3, 3));
	/* principal moments of a box of random edges, from needles to cubes */
	const double x = exp(pick(4, 3 * k, -4, 1)), y = exp(pick(4, 3 * k + 1, -4, 1)),
		     z = exp(pick(4, 3 * k + 2, -4, 1));
	const rb_vec3 inertia = {mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z),
	                         mass / 12 * (x * x + y * y)};
	const rb_vec3 corner = pick_vector(5, k);
	const rb_vec3 arm = {0.5 * x * corner.x, 0.5 * y * corner.y, 0.5 * z * corner.z};

	link.normal = rb_vec3_unit(pick_vector(6, k), (rb_vec3){0, 0, 1});
	for (int column = 0; column < 3; column++) {
		const rb_vec3 unit = {column == 0, column == 1, column == 2};
		const rb_vec3 torque = rb_vec3_cross(arm, unit);
		const rb_vec3 turn = {torque.x / inertia.x, torque.y / inertia.y,
		                      torque.z / inertia.z};
		const rb_vec3 dv = rb_vec3_add_scaled(rb_vec3_cross(turn, arm), 1 / mass, unit);

		link.inverse_effective_mass.m[0][column] = dv.x;
		link.inverse_effective_mass.m[1][column] = dv.y;
		link.inverse_effective_mass.m[2][column] = dv.z;
	}
	link.normal_inverse_mass = rb_vec3_dot(
		link.normal, rb_mat3_apply(&link.inverse_effective_mass, link.normal));
	link.tangent_inverse_mass = link.inverse_effective_mass.m[0][0] +
	                            link.inverse_effective_mass.m[1][1] +
	                            link.inverse_effective_mass.m[2][2];
	return link;
}

static void an_impact_never_raises_kinetic_energy(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 5000; k++) {
		const struct rb_link link = random_link(k);
		rb_vec3 u = pick_vector(7, k);

		if (rb_vec3_dot(u, link.normal) >= 0)
			u = rb_vec3_neg(u);
		const double approach = -rb_vec3_dot(u, link.normal);
		const rb_vec3 impulse = rb_link_impact(&link, u, link.restitution * approach);
		const rb_vec3 after = rb_vec3_add(
			u, rb_mat3_apply(&link.inverse_effective_mass, impulse));
		const double normal = rb_vec3_dot(impulse, link.normal);
		const rb_vec3 tangent = rb_vec3_add_scaled(impulse, -normal, link.normal);
		const double change = 0.5 * rb_vec3_dot(impulse, rb_vec3_add(u, after));

		assert_true(rb_vec3_finite(impulse));
		assert_true(change <= 1e-9 * rb_vec3_length(impulse) * rb_vec3_length(u));
		assert_true(rb_vec3_dot(after, link.normal) >= -1e-9 * rb_vec3_length(u));
		assert_true(rb_vec3_length(tangent) <= link.friction * normal * (1 + 1e-9) + 1e-12);
	}
}

/* Slender rod of length 2 a at 45 degrees, one end on a rough floor, falling straight: closed form of the planar
 * process. Frictionless limit: J = (1 + e) u / (1/m + r^2 / I) with r = a cos 45. */
static void a_frictionless_rod_follows_newton(void **slot)
{
	struct rb_link link = {.normal = {0, 0, 1}, .restitution = 0.5};
	const double m = 1, a = 0.5, inertia = m * a * a / 3, rx = -a * sqrt(0.5),
		     rz = -a * sqrt(0.5);

	(void)slot;
	link.inverse_effective_mass = (rb_mat3){
		{{1 / m + rz * rz / inertia, 0, -rx * rz / inertia},
	         {0, 1 / m + (rx * rx + rz * rz) / inertia, 0},
	         {-rx * rz / inertia, 0, 1 / m + rx * rx / inertia}}};
	link.normal_inverse_mass = link.inverse_effective_mass.m[2][2];
	const rb_vec3 impulse = rb_link_impact(&link, (rb_vec3){0, 0, -2}, 1);
	assert_near(impulse.z, 3 / link.normal_inverse_mass, 1e-12);
	assert_near(impulse.x, 0, 1e-15);

	/* with much friction the end sticks: the process runs along K (n + x t) with no slip */
	link.friction = 10;
	link.tangent_inverse_mass = link.inverse_effective_mass.m[0][0];
	const rb_vec3 rough = rb_link_impact(&link, (rb_vec3){0, 0, -2}, 1);
	const double x = -link.inverse_effective_mass.m[0][2] / link.inverse_effective_mass.m[0][0];
	const double inverse_effective_mass = link.inverse_effective_mass.m[2][2] +
	                                      x * link.inverse_effective_mass.m[0][2];
	assert_near(rough.z, 3 / inverse_effective_mass, 1e-9);
	assert_near(rough.x, x * 3 / inverse_effective_mass, 1e-9);
}

/* Chung and Ooi's test 4 in the rigid limit (section 5 of Kharaz, Gorham, Salman 2001): sphere on wall, mu 0.092, e 0.98. */
static void an_oblique_sphere_sticks_or_slips_as_coulomb_says(void **slot)
{
	const struct {
		double degrees, ratio;
	} table[] = {{10, 0.71428571}, {30, 0.71428571}, {35, 0.73984856},
	             {45, 0.81784},    {60, 0.89482987}, {85, 0.98406307}};
	struct rb_link link = {.normal = {0, 0, 1},
	                       .central = true,
	                       .friction = 0.092,
	                       .restitution = 0.98,
	                       .normal_inverse_mass = 1,
	                       .tangent_inverse_mass = 3.5};

	(void)slot;
	for (size_t k = 0; k < sizeof table / sizeof table[0]; k++) {
		const double angle = table[k].degrees * 0.017453292519943295;
		const rb_vec3 u = {3.9 * sin(angle), 0, -3.9 * cos(angle)};
		const rb_vec3 impulse = rb_link_impact(&link, u, 0.98 * 3.9 * cos(angle));

		/* the velocity of the centre changes by J/m = impulse, of the contact by 3.5 of it */
		assert_near((u.x + impulse.x) / u.x, table[k].ratio, 1e-8);
		assert_near(u.z + impulse.z, 0.98 * 3.9 * cos(angle), 1e-12);
	}
}

/* The end of compression is met to rounding, from above or from below. */
static void every_impact_gives_back_what_compression_left(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 5000; k++) {
		struct rb_link link = random_link(k);
		rb_vec3 u = pick_vector(8, k);

		link.friction = 0.4;
		if (rb_vec3_dot(u, link.normal) >= 0)
			u = rb_vec3_neg(u);
		const double approach = -rb_vec3_dot(u, link.normal);
		const rb_vec3 impulse = rb_link_impact(&link, u, 0.5 * approach);
		const rb_vec3 after = rb_vec3_add(
			u, rb_mat3_apply(&link.inverse_effective_mass, impulse));

		assert_true(rb_vec3_dot(after, link.normal) > 0.1 * approach);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_impact_never_raises_kinetic_energy),
		cmocka_unit_test(every_impact_gives_back_what_compression_left),
		cmocka_unit_test(a_frictionless_rod_follows_newton),
		cmocka_unit_test(an_oblique_sphere_sticks_or_slips_as_coulomb_says),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
