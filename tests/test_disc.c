/* SPDX-License-Identifier: MIT */
/* Discs and coins on their rims, which touch with their true lowest point: located, and by steps of falling length. */
#include "worlds.h"

static const double g = 9.81, radius = 0.04, half = 0.003, mass = 0.3;

static double inertia_across(void)
{
	return mass * (3 * radius * radius + 4 * half * half) / 12;
}

static double inertia_along(void)
{
	return mass * radius * radius / 2;
}

/* Its axis leans by `tilt` to x. */
static int add_disc(struct lab *lab, double tilt, rb_vec3 position, rb_vec3 velocity, rb_vec3 spin)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "disc";
	def.shape.kind = RB_SHAPE_CYLINDER;
	def.shape.radius = radius;
	def.shape.size[2] = 2 * half;
	def.mass = mass;
	def.position = position;
	def.velocity = velocity;
	def.angular_velocity = spin;
	def.orientation = (rb_quat){cos(tilt / 2), 0, sin(tilt / 2), 0};
	return lab_add(lab, &def);
}

/* Step zero: located. */
static void open_world(struct lab *lab, double duration, double step, double friction)
{
	lab_open(lab, duration, 50);
	lab->scene.world.method = step > 0 ? RB_METHOD_STEPPED : RB_METHOD_LOCATED;
	if (step > 0)
		lab->scene.world.time_step_s = step;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
	lab->scene.world.tolerance_m = 1e-6 * radius;
	lab_surface(lab, friction, 0);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
}

static double height_at(double tilt)
{
	return radius * sin(tilt) + half * cos(tilt);
}

/*
 * Steady rolling, the centre on a circle of radius `way`, at the rate Omega about z. With u the axis, r the contact from the
 * centre and omega = Omega z + s u: no slip gives s a = -Omega (way - r.x), where -r.x = -(a cos - c sin) as r leads outwards;
 * the torque of m g z - m Omega^2 way x about the centre is Omega z x L. Returns Omega; *s gets the spin about u.
 */
static double steady_rate(double tilt, double way, double *s)
{
	const double sine = sin(tilt), cosine = cos(tilt), a = radius, c = half;
	const double out = a * cosine - c * sine;
	const double square = mass * g * out /
	                      (mass * way * height_at(tilt) + inertia_across() * sine * cosine +
	                       inertia_along() * sine * (way - c * sine) / a);

	*s = -sqrt(square) * (way + out) / a;
	return sqrt(square);
}

/* m: how far from where it should be the centre comes within the time. */
static double rolling_error(double tilt, double way, double step)
{
	double s, worst = 0;
	const double rate = steady_rate(tilt, way, &s);
	const rb_vec3 axis = {sin(tilt), 0, cos(tilt)};
	struct lab lab;

	open_world(&lab, 0.5, step, 2);
	const int disc = add_disc(&lab, tilt, (rb_vec3){way, 0, height_at(tilt)},
	                          (rb_vec3){0, rate * way, 0},
	                          rb_vec3_add_scaled((rb_vec3){0, 0, rate}, s, axis));
	lab_seal(&lab, 1);
	for (uint64_t frame = 1; frame <= 25; frame++) {
		lab_step(&lab);
		const double angle = rate * rb_world_time(lab.world);
		const rb_vec3 wanted = {way * cos(angle), way * sin(angle), height_at(tilt)};
		worst = fmax(worst, rb_vec3_length(rb_vec3_sub(rb_world_position(lab.world, disc),
		                                               wanted)));
	}
	lab_close(&lab);
	return worst;
}

static void a_disc_rolls_round_on_its_edge_as_it_should(void **slot)
{
	static const double tilts[] = {0.3, 0.9, 1.3};

	(void)slot;
	for (int k = 0; k < 3; k++)
		for (int w = 0; w < 2; w++)
			assert_near(rolling_error(tilts[k], w ? 0.25 : 0.02, 0), 0, 1e-9);
}

static void by_steps_it_does_so_the_better_the_shorter_they_are(void **slot)
{
	double last = HUGE_VAL;

	(void)slot;
	for (int k = 0; k < 3; k++) {
		const double error = rolling_error(0.9, 0.1, ldexp(1e-3, -k));
		assert_true(error < 0.7 * last);
		last = error;
	}
}

/*
 * A coin let go while it leans turns about its lowest point where that holds, and falls straight down where nothing does: with
 * x = a cos - c sin how fast its height changes by the tilt, (A + m (a^2 + c^2)) or (A + m x^2) times rate^2 / 2 is the
 * loss of height. Returns the worst relative error of the rate.
 */
static double falling_error(double friction, double step)
{
	const double start = 1.4;
	double worst = 0;
	struct lab lab;

	open_world(&lab, 0.12, step, friction);
	const int coin = add_disc(&lab, start, (rb_vec3){0, 0, height_at(start)},
	                          (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	for (int frame = 1; frame <= 5; frame++) {
		lab_step(&lab);
		const rb_quat q = rb_world_orientation(lab.world, coin);
		const rb_vec3 axis = rb_quat_rotate(q, (rb_vec3){0, 0, 1});
		const double tilt = atan2(axis.x, axis.z),
			     x = radius * cos(tilt) - half * sin(tilt);
		const double arm = friction > 0 ? radius * radius + half * half : x * x;
		const double rate = sqrt(2 * mass * g * (height_at(start) - height_at(tilt)) /
		                         (inertia_across() + mass * arm));
		const double found = -rb_world_angular_velocity(lab.world, coin).y;
		worst = fmax(worst, fabs(found / rate - 1));
	}
	lab_close(&lab);
	return worst;
}

static void a_coin_falls_from_its_edge_at_the_right_rate(void **slot)
{
	(void)slot;
	assert_near(falling_error(5, 0), 0, 1e-10);
	assert_near(falling_error(0, 0), 0, 1e-10);
}

static void by_steps_it_falls_the_more_rightly_the_shorter_they_are(void **slot)
{
	(void)slot;
	for (int rough = 0; rough < 2; rough++) {
		double last = HUGE_VAL;
		for (int k = 0; k < 3; k++) {
			const double error = falling_error(rough ? 5 : 0, ldexp(1e-3, -k));
			assert_true(error < 0.7 * last);
			last = error;
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_disc_rolls_round_on_its_edge_as_it_should),
		cmocka_unit_test(by_steps_it_does_so_the_better_the_shorter_they_are),
		cmocka_unit_test(a_coin_falls_from_its_edge_at_the_right_rate),
		cmocka_unit_test(by_steps_it_falls_the_more_rightly_the_shorter_they_are),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
