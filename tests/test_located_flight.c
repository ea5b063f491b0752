/* SPDX-License-Identifier: MIT */
/* src/event: motion between impacts against closed forms. */
#include "worlds.h"

#include "force/drag.h"
#include "force/spring.h"
#include "located/located.h"

#include "runge.h"

#include <float.h>

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const rb_vec3 earth = {0, 0, -9.81};
static const double pi = 3.14159265358979323846;

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

static void add_force(struct lab *lab, struct rb_force_def force)
{
	assert_int_equal(rb_scene_add_force(&lab->scene, &force, &lab->error), RB_OK);
}

/* Position, velocity, spin and orientation of a body as 13 numbers. */
static void take_row(const struct lab *lab, int id, double row[13])
{
	const rb_quat q = rb_world_orientation(lab->world, id);

	rb_vec3_to(row, rb_world_position(lab->world, id));
	rb_vec3_to(row + 3, rb_world_velocity(lab->world, id));
	rb_vec3_to(row + 6, rb_world_angular_velocity(lab->world, id));
	memcpy(row + 9, (double[4]){q.w, q.x, q.y, q.z}, 4 * sizeof *row);
}

/* ---- frames ---- */

enum { MOVERS = 6, SECONDS = 3 };

/* One of each kind of motion. */
static void add_movers(struct lab *lab, bool integrated)
{
	struct rb_force_def force = rb_force_def_default();
	struct rb_body_def def;

	def = lab_sphere_def(0.1, 2, at(0, 0, 5), at(1, 2, 3));
	def.angular_velocity = at(3, -1, 2);
	lab_add(lab, &def);
	force.vector = at(0.3, -1, 2);
	force.start_s = 0.123456;
	force.duration_s = 1.7777;
	add_force(lab, force);
	def = lab_sphere_def(0.1, 1, at(10, 0, 5), at(0.5, 0, 0));
	def.inertia = &(rb_mat3){{{0.002, 0, 0}, {0, 0.003, 0}, {0, 0, 0.004}}};
	def.angular_velocity = at(1, 5, 0.2);
	lab_add(lab, &def);
	lab_sphere(lab, 0.1, 1, at(20, 0, 1.1), at(0.3, 0, 0));   /* bounces */
	lab_sphere(lab, 0.1, 1, at(30, 0, 0.1), at(2, 0.5, 0));   /* slides, then rolls */
	lab_sphere(lab, 0.1, 1, at(40, 0, 0.3), at(0, 0, 0.123)); /* comes to rest */
	def = lab_sphere_def(0.1, 1, at(50, 0, 20), at(0, 1, 0));
	def.angular_velocity = at(0, 0, 3);
	lab_add(lab, &def);
	force = rb_force_def_default();
	force.vector = at(2, 0, 0);
	force.frame = RB_FORCE_BODY;
	if (integrated)
		add_force(lab, force);
	lab_plane(lab, origin, up);
}

static void run_movers(double frame_rate, double rows[SECONDS][MOVERS][13])
{
	struct lab lab;

	lab_open_located(&lab, SECONDS, frame_rate);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.3, 0.6);
	add_movers(&lab, true);
	lab_seal(&lab, 1);
	for (int second = 0; second < SECONDS; second++) {
		for (int k = 0; k < (int)frame_rate; k++)
			lab_step(&lab);
		for (int id = 0; id < MOVERS; id++)
			take_row(&lab, id, rows[second][id]);
	}
	lab_close(&lab);
}

/* Who looks, and when, changes nothing. */
static void frames_do_not_change_a_bit_of_the_motion(void **slot)
{
	static double wanted[SECONDS][MOVERS][13], found[SECONDS][MOVERS][13];
	const double rates[] = {7, 60, 1000};

	(void)slot;
	run_movers(1, wanted);
	for (int r = 0; r < 3; r++) {
		run_movers(rates[r], found);
		for (int second = 0; second < SECONDS; second++)
			for (int id = 0; id < MOVERS; id++)
				for (int k = 0; k < 13; k++)
					if (found[second][id][k] != wanted[second][id][k])
						fail_msg("%g frames/s, t = %d s, body %d, column "
						         "%d: "
						         "%.17g, not %.17g",
						         rates[r], second + 1, id, k,
						         found[second][id][k],
						         wanted[second][id][k]);
	}
}

static void a_parabola_is_exact_at_every_frame(void **slot)
{
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 100, 60);
	lab.scene.world.gravity = earth;
	const int ball = lab_sphere(&lab, 0.1, 1, at(1, 2, 3), at(3, -1, 4));
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double t = rb_world_time(lab.world);
		const rb_vec3 wanted = {1 + 3 * t, 2 - t, 3 + 4 * t - 0.5 * 9.81 * t * t};

		assert_vector(rb_world_position(lab.world, ball), wanted, 1e-15 * (5 + 5 * t * t));
	}
	lab_close(&lab);
}

/* ---- turning ---- */

static rb_vec3 body_spin(const struct lab *lab, int id)
{
	return rb_quat_rotate_back(rb_world_orientation(lab->world, id),
	                           rb_world_angular_velocity(lab->world, id));
}

/* The moments of a box of 3 x 2 x 1 m and 6 kg; a full period of its tumbling takes 12.9012460037936 s. */
static void a_tumbling_body_keeps_energy_momentum_and_phase(void **slot)
{
	const double period = 12.9012460037936, begin = 3.2;
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, begin + 100 * period, 1 / begin);
	struct rb_body_def def = lab_sphere_def(1, 6, origin, origin);
	def.inertia = &(rb_mat3){{{2.5, 0, 0}, {0, 5, 0}, {0, 0, 6.5}}};
	def.angular_velocity = at(0.01, 5, 0.01);
	const int body = lab_add(&lab, &def);
	lab_seal(&lab, 1);
	const double energy = rb_world_kinetic_energy(lab.world, body);
	const rb_vec3 momentum = rb_world_angular_momentum(lab.world, body);
	assert_near(energy, 62.50045, 1e-13);
	lab_step(&lab);
	const rb_vec3 first = body_spin(&lab, body);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		assert_near(rb_world_kinetic_energy(lab.world, body) / energy, 1, 1e-12);
		assert_vector(rb_world_angular_momentum(lab.world, body), momentum, 25 * 1e-12);
	}
	const rb_vec3 last = body_spin(&lab, body);
	/* Euler: I1 w1' = (I2 - I3) w2 w3, and so on */
	const rb_vec3 rate = {-1.5 / 2.5 * first.y * first.z, 4.0 / 5 * first.z * first.x,
	                      -2.5 / 6.5 * first.x * first.y};
	const double late = rb_vec3_dot(rb_vec3_sub(last, first), rate) / rb_vec3_dot(rate, rate);
	assert_true(rb_vec3_length(rate) > 0.1);
	assert_near(late, 0, 1e-6 * period);
	assert_vector(last, first, 1e-6 * period * rb_vec3_length(rate) + 1e-9);
	lab_close(&lab);
}

/* I1 = I2: the body rate of the axis is (I3 - I1)/I1 w3, and in space it goes round at |L|/I1. */
static void a_symmetric_top_wobbles_at_its_rate(void **slot)
{
	const double i1 = 0.004, i3 = 0.006, spin = 50, wobble = 3, t = 10;
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, t, 10);
	struct rb_body_def def = lab_sphere_def(0.1, 1, origin, origin);
	def.inertia = &(rb_mat3){{{i1, 0, 0}, {0, i1, 0}, {0, 0, i3}}};
	def.angular_velocity = at(wobble, 0, spin);
	const int body = lab_add(&lab, &def);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const double rate = (i3 - i1) / i1 * spin;
	assert_vector(body_spin(&lab, body),
	              at(wobble * cos(rate * t), wobble * sin(rate * t), spin), 1e-10);
	/* the axis: turned about L from where it began */
	const rb_vec3 momentum = {i1 * wobble, 0, i3 * spin};
	const double size = rb_vec3_length(momentum), angle = size / i1 * t;
	const rb_vec3 l = rb_vec3_scale(1 / size, momentum);
	const rb_vec3 part = rb_vec3_scale(l.z, l), rest = rb_vec3_sub(up, part);
	const rb_vec3 axis = rb_vec3_add(
		part, rb_vec3_add(rb_vec3_scale(cos(angle), rest),
	                          rb_vec3_scale(sin(angle), rb_vec3_cross(l, rest))));
	assert_vector(rb_quat_rotate(rb_world_orientation(lab.world, body), up), axis, 1e-11);
	lab_close(&lab);
}

/* ---- forces ---- */

static void forces_begin_and_end_at_odd_times(void **slot)
{
	const double start[3] = {0, 0.1234567, 0.7}, lasts[3] = {0.3333, 1.1, 0.01};
	const rb_vec3 vector[3] = {{2, 0, 0}, {-1, 3, 0.5}, {0, 0, 100}};
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 2, 7);
	lab.scene.world.gravity = earth;
	lab.scene.world.gravity_force = at(0, 0.5, 0);
	const int ball = lab_sphere(&lab, 0.1, 2, origin, at(1, 0, 0));
	for (int k = 0; k < 3; k++) {
		struct rb_force_def force = rb_force_def_default();

		force.vector = vector[k];
		force.start_s = start[k];
		force.duration_s = lasts[k];
		add_force(&lab, force);
	}
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double t = rb_world_time(lab.world);
		rb_vec3 x = {t, 0.5 * t * t * 0.25, -0.5 * 9.81 * t * t};
		rb_vec3 v = {1, 0.25 * t, -9.81 * t};

		for (int k = 0; k < 3; k++) {
			const double s = fmax(0, fmin(t - start[k], lasts[k]));
			const double after = fmax(0, t - start[k] - lasts[k]);

			x = rb_vec3_add_scaled(x, (0.5 * s * s + s * after) / 2, vector[k]);
			v = rb_vec3_add_scaled(v, s / 2, vector[k]);
		}
		assert_vector(rb_world_position(lab.world, ball), x, 2e-14);
		assert_vector(rb_world_velocity(lab.world, ball), v, 2e-14);
	}
	lab_close(&lab);
}

static void a_force_that_turns_with_the_body_drives_it_in_circles(void **slot)
{
	const double spin = 4, f = 3, m = 2;
	struct lab lab;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	lab_open_located(&lab, 5, 10);
	struct rb_body_def def = lab_sphere_def(0.1, m, origin, at(0.5, 0, 1));
	def.angular_velocity = at(0, 0, spin);
	const int ball = lab_add(&lab, &def);
	force.vector = at(f, 0, 0);
	force.frame = RB_FORCE_BODY;
	add_force(&lab, force);
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double t = rb_world_time(lab.world), a = f / m / spin;
		const rb_vec3 x = {0.5 * t + a * (1 - cos(spin * t)) / spin,
		                   a * (t - sin(spin * t) / spin), t};

		assert_vector(rb_world_position(lab.world, ball), x, 1e-12);
	}
	lab_close(&lab);
}

/* A force along x at a point of the body that turns about z: I phi'' = -r F sin(phi), a pendulum. */
static void pendulum(const void *user, double t, const double *y, double *rate)
{
	(void)t;
	rate[0] = y[1];
	rate[1] = -*(const double *)user * sin(y[0]);
}

static void a_force_off_the_centre_swings_the_body_like_a_pendulum(void **slot)
{
	const double m = 2, radius = 0.1, f = 0.5, arm = 0.08;
	const double square = arm * f / (0.4 * m * radius * radius);
	double y[2] = {0, 6};
	struct lab lab;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	lab_open_located(&lab, 5, 10);
	struct rb_body_def def = lab_sphere_def(radius, m, origin, origin);
	def.angular_velocity = at(0, 0, y[1]);
	const int ball = lab_add(&lab, &def);
	force.vector = at(f, 0, 0);
	force.point = at(arm, 0, 0);
	add_force(&lab, force);
	lab_seal(&lab, 1);
	lab_run(&lab);
	runge_solve(pendulum, &square, 2, y, 0, 5, 20000);
	const rb_vec3 x = rb_quat_rotate(rb_world_orientation(lab.world, ball), at(1, 0, 0));
	assert_near(rb_world_angular_velocity(lab.world, ball).z, y[1], 1e-10);
	assert_vector(x, at(cos(y[0]), sin(y[0]), 0), 1e-10);
	assert_near(rb_world_position(lab.world, ball).x, 0.5 * f / m * 25, 1e-11);
	lab_close(&lab);
}

static int add_spring(struct lab *lab, int a, int b, double stiffness, double damping, double rest)
{
	struct rb_spring_def spring = rb_spring_def_default();

	spring.a = a;
	spring.b = b;
	spring.stiffness = stiffness;
	spring.damping = damping;
	spring.rest_length_m = rest;
	assert_int_equal(rb_scene_add_spring(&lab->scene, &spring, &lab->error), RB_OK);
	return rb_scene_element_count(&lab->scene, &rb_force_spring) - 1;
}

/* A quarter after 100 periods the place says how late it is. */
static void a_spring_keeps_its_phase_for_100_periods(void **slot)
{
	(void)slot;
	for (int kind = 0; kind < 3; kind++) {
		const double m = 2, k = kind == 2 ? 1e9 : 50, amplitude = 0.5;
		/* to a fixed body; between two moving ones: reduced mass */
		const double w = sqrt(k / (kind == 1 ? m * 3 / (m + 3) : m));
		const double t = 100.25 * 2 * pi / w;
		struct lab lab;

		lab_open_located(&lab, t, 10 / t);
		struct rb_body_def def = lab_sphere_def(0.1, 3, origin, origin);
		def.is_static = kind != 1;
		const int anchor = lab_add(&lab, &def);
		const int ball = lab_sphere(&lab, 0.1, m, at(1 + amplitude, 0, 0), origin);
		add_spring(&lab, anchor, ball, k, 0, 1);
		lab_seal(&lab, 1);
		lab_run(&lab);
		const double x = rb_world_position(lab.world, ball).x -
		                 rb_world_position(lab.world, anchor).x - 1;
		const double v = rb_world_velocity(lab.world, ball).x -
		                 rb_world_velocity(lab.world, anchor).x;
		assert_near(v / (w * amplitude), -1, 1e-10);
		assert_near(x / amplitude / (2 * pi), 0, 1e-9); /* of a period */
		if (kind == 1)
			assert_near(rb_world_momentum(lab.world, ball).x +
			                    rb_world_momentum(lab.world, anchor).x,
			            0, 1e-12);
		lab_close(&lab);
	}
}

/* m x'' = -k x - c x': x = A e^(-d t) (cos w t + d/w sin w t), d = c/2m, w^2 = k/m - d^2 */
/* Coordinates round once, when they are read; places and speeds of a hundred pieces do not drift by it. */
static void a_spring_far_away_does_as_one_at_the_origin(void **slot)
{
	static const double away[3] = {0, 0x1p14, 0x1p20};
	double rows[3][2][13];

	(void)slot;
	for (int k = 0; k < 3; k++) {
		const rb_vec3 place = at(away[k], -0.5 * away[k], away[k]);
		struct lab lab;

		lab_open_located(&lab, 20, 1);
		const int a = lab_sphere(&lab, 0.125, 1, place, at(0, 1, 0));
		const int b = lab_sphere(&lab, 0.125, 3, rb_vec3_add(place, at(1.5, 0, 0)),
		                         at(0.25, -0.5, 0.5));
		add_spring(&lab, a, b, 100, 0, 1);
		lab_seal(&lab, 1);
		lab_run(&lab);
		take_row(&lab, a, rows[k][0]);
		take_row(&lab, b, rows[k][1]);
		lab_close(&lab);
		for (int body = 0; body < 2; body++) {
			const double *near = rows[0][body], *far = rows[k][body];

			assert_vector(rb_vec3_sub(rb_vec3_from(far), place), rb_vec3_from(near),
			              0.501 * DBL_EPSILON * away[k]);
			assert_vector(rb_vec3_from(far + 3), rb_vec3_from(near + 3), 1e-13);
		}
	}
}

static void a_damped_spring_decays_as_it_should(void **slot)
{
	const double m = 2, k = 50, c = 1.5, d = c / 2 / m, w = sqrt(k / m - d * d);
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 5, 20);
	struct rb_body_def def = lab_sphere_def(0.1, 3, origin, origin);
	def.is_static = true;
	const int anchor = lab_add(&lab, &def);
	const int ball = lab_sphere(&lab, 0.1, m, at(0, 1.5, 0), origin);
	add_spring(&lab, ball, anchor, k, c, 1);
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double t = rb_world_time(lab.world);
		const double y = 1 + 0.5 * exp(-d * t) * (cos(w * t) + d / w * sin(w * t));

		assert_near(rb_world_position(lab.world, ball).y, y, 1e-12);
	}
	lab_close(&lab);
}

static void add_drag(struct lab *lab, double linear, double quadratic)
{
	const struct rb_drag_def drag = {.linear = linear, .quadratic = quadratic};

	assert_int_equal(rb_scene_add_drag(&lab->scene, &drag, &lab->error), RB_OK);
}

static void drag_slows_down_as_it_should(void **slot)
{
	const double m = 2, c = 3, v0 = 5, g = 9.81;

	(void)slot;
	for (int kind = 0; kind < 2; kind++) {
		struct lab lab;

		lab_open_located(&lab, 4, 10);
		if (kind == 0)
			lab.scene.world.gravity = earth;
		add_drag(&lab, kind == 0 ? c : 0, kind == 0 ? 0 : c);
		const int ball = lab_sphere(&lab, 0.1, m, origin, at(0.6 * v0, 0.8 * v0, 0));
		lab_seal(&lab, 1);
		while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
			lab_step(&lab);
			const double t = rb_world_time(lab.world);
			const double way = kind == 0 ? m / c * v0 * (1 - exp(-c * t / m))
			                             : m / c * log(1 + c * v0 * t / m);
			const double fall = kind == 0 ? -m * g / c *
			                                        (t - m / c * (1 - exp(-c * t / m)))
			                              : 0;

			assert_vector(rb_world_position(lab.world, ball),
			              at(0.6 * way, 0.8 * way, fall), 1e-12 * (1 + fabs(fall)));
		}
		lab_close(&lab);
	}
}

/* Of different masses, with friction and spins, in a box; or boxes that tumble. */
static void open_slowing(struct lab *lab, bool boxes, bool closed)
{
	lab_open_located(lab, 1.5, 10);
	lab_surface(lab, boxes ? 0 : 0.2, 0.9);
	lab->scene.world.gravity = at(0.5, 0, -2);
	for (int k = 0; k < 6; k++) {
		const double sign = k % 2 ? -1 : 1;

		lab_plane(lab, k % 2 ? at(2, 2, 2) : at(-2, -2, -2),
		          at(k / 2 == 0 ? sign : 0, k / 2 == 1 ? sign : 0, k / 2 == 2 ? sign : 0));
	}
	add_drag(lab, 0.3, 0);
	for (int k = 0; k < (boxes ? 2 : 8); k++) {
		struct rb_body_def def = lab_sphere_def(
			0.3, 1 + k % 3, at(k % 2 - 0.5, k / 2 % 2 - 0.5, k / 4 - 0.5 + 0.1 * k),
			at(3 * sin(7 * k), 3 * cos(5 * k), 2 * sin(3 * k + 1)));

		def.angular_velocity = at(k, 1, -k);
		if (boxes) {
			def.call = "box";
			def.shape = (struct rb_shape){.kind = RB_SHAPE_BOX,
			                              .size = {0.5, 0.4, 0.3}};
		}
		lab_add(lab, &def);
	}
	lab_seal(lab, 1);
	assert_true(lab->world->located->decays);
	lab->world->located->decays = closed;
}

/* By rounding, which each collision multiplies: three or four of each body. */
static void what_slows_down_in_closed_form_goes_as_integrated(void **slot)
{
	(void)slot;
	for (int boxes = 0; boxes < 2; boxes++) {
		struct lab closed, integrated;

		open_slowing(&closed, boxes, true);
		open_slowing(&integrated, boxes, false);
		lab_run(&closed);
		lab_run(&integrated);
		const struct rb_frame_numbers one = rb_world_totals(closed.world),
					      other = rb_world_totals(integrated.world);

		assert_int_equal(one.collisions, other.collisions);
		assert_in_range(one.collisions, boxes ? 2 : 12, 100);
		assert_null(closed.world->located->piece);
		assert_non_null(integrated.world->located->piece);
		for (int i = 0; i < (boxes ? 2 : 8); i++) {
			const int id = closed.model->id_of[i];

			assert_vector(rb_world_position(closed.world, id),
			              rb_world_position(integrated.world, id), 1e-11);
			assert_vector(rb_world_velocity(closed.world, id),
			              rb_world_velocity(integrated.world, id), 1e-10);
		}
		lab_close(&closed);
		lab_close(&integrated);
	}
}

/* It is pulled down for long: the last digits are those of the place, not of the way without drag. */
static void stiff_drag_costs_no_digits(void **slot)
{
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 100, 1);
	lab.scene.world.gravity = at(0, 0, -1);
	add_drag(&lab, 1e4, 0);
	const int ball = lab_sphere(&lab, 0.1, 1, origin, at(3, 0, 0));
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_vector(rb_world_position(lab.world, ball), at(3e-4, 0, -1e-2 + 1e-8), 1e-17);
	assert_vector(rb_world_velocity(lab.world, ball), at(0, 0, -1e-4), 1e-19);
	lab_close(&lab);
}

enum field { FIELD_ZERO, FIELD_HARMONIC, FIELD_MAGNETIC, FIELD_TIME, FIELD_FAR };

static enum rb_status field(void *user, int id, double t, const rb_vec3 motion[2], rb_vec3 force[2],
                            struct rb_error *err)
{
	const rb_vec3 x = motion[0], v = motion[1];

	(void)id, (void)err;
	switch (*(enum field *)user) {
	case FIELD_ZERO:
		*force = origin;
		break;
	case FIELD_HARMONIC:
		*force = rb_vec3_scale(-5, x);
		break;
	case FIELD_FAR:
		*force = rb_vec3_scale(-5, rb_vec3_sub(x, at(0x1p27, 0, 0)));
		break;
	case FIELD_MAGNETIC:
		*force = rb_vec3_cross(v, at(0, 0, 5));
		break;
	case FIELD_TIME:
		*force = at(5 * cos(3 * t), 0, 0);
		break;
	}
	return RB_OK;
}

static void a_field_moves_bodies_as_it_should(void **slot)
{
	const double m = 2;

	(void)slot;
	for (enum field kind = FIELD_ZERO; kind <= FIELD_TIME; kind++) {
		const struct rb_field_def def = {.function = 0};
		const struct rb_world_hooks hooks = {.user = &kind, .field = field};
		const struct rb_world_options options = {.threads = 1};
		struct lab lab;

		lab_open_located(&lab, 10, 10);
		assert_int_equal(rb_scene_add_field(&lab.scene, &def, &lab.error), RB_OK);
		const int ball = lab_sphere(&lab, 0.1, m, origin, at(1, 0, 0.5));
		lab_seal_with(&lab, &options, &hooks);
		while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
			lab_step(&lab);
			const double t = rb_world_time(lab.world), w = sqrt(2.5), q = 2.5;
			const rb_vec3 wanted[] = {
				[FIELD_ZERO] = {t, 0, 0.5 * t},
				[FIELD_HARMONIC] = {sin(w * t) / w, 0, 0.5 * sin(w * t) / w},
				[FIELD_MAGNETIC] = {sin(q * t) / q, (cos(q * t) - 1) / q, 0.5 * t},
				[FIELD_TIME] = {t + 2.5 / 9 * (1 - cos(3 * t)), 0, 0.5 * t},
			};

			assert_vector(rb_world_position(lab.world, ball), wanted[kind], 1e-11);
		}
		lab_close(&lab);
	}
}

/* Its centre is where coordinates are steps of 3e-8 m, and so is what it answers. */
static void a_field_far_away_is_followed_as_far_as_it_can_be_told(void **slot)
{
	static const double away = 0x1p27;
	const struct rb_field_def def = {.function = 0};
	enum field kind = FIELD_FAR;
	const struct rb_world_hooks hooks = {.user = &kind, .field = field};
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 10, 10);
	assert_int_equal(rb_scene_add_field(&lab.scene, &def, &lab.error), RB_OK);
	const int ball = lab_sphere(&lab, 0.1, 2, at(away, 0, 0), at(1, 0, 0.5));
	lab_seal_with(&lab, &options, &hooks);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double w = sqrt(2.5), x = sin(w * rb_world_time(lab.world)) / w;

		assert_vector(rb_world_position(lab.world, ball), at(away + x, 0, 0.5 * x),
		              4 * DBL_EPSILON * away);
	}
	/* as many pieces as near: it was 1e5 a second and more */
	assert_true(rb_world_work(lab.world).body_steps < 20000);
	lab_close(&lab);
}

/* With a field that returns nothing the same ball goes through the integrator, and bounces where it did. */
static void a_field_of_zero_changes_a_bounce_by_rounding_only(void **slot)
{
	double z[2], x[2];

	(void)slot;
	for (int with = 0; with < 2; with++) {
		const struct rb_field_def def = {.function = 0};
		enum field kind = FIELD_ZERO;
		const struct rb_world_hooks hooks = {.user = &kind, .field = field};
		const struct rb_world_options options = {.threads = 1};
		struct lab lab;

		lab_open_located(&lab, 10, 10);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0, 0.9);
		if (with)
			assert_int_equal(rb_scene_add_field(&lab.scene, &def, &lab.error), RB_OK);
		const int ball = lab_sphere(&lab, 0.1, 2, at(0, 0, 1.1), at(1, 0, 0));
		lab_plane(&lab, origin, up);
		lab_seal_with(&lab, &options, &hooks);
		for (int k = 0; k < 83; k++) /* it rests after 8.6 s */
			lab_step(&lab);
		z[with] = rb_world_position(lab.world, ball).z;
		x[with] = rb_world_position(lab.world, ball).x;
		lab_run(&lab);
		assert_near(rb_world_position(lab.world, ball).z, 0.1, 1e-12);
		lab_close(&lab);
	}
	assert_near(z[1], z[0], 1e-9);
	assert_near(x[1], x[0], 1e-11);
}

static void bodies_that_overlap_at_the_start_are_refused_by_name(void **slot)
{
	(void)slot;
	for (int kind = 0; kind < 3; kind++) {
		const double apart[] = {0.1, 0, 0.2 - 1e-3};
		struct lab lab;

		lab_open_located(&lab, 1, 10);
		struct rb_body_def def = lab_sphere_def(0.1, 1, origin, origin);
		def.name = "inner";
		lab_add(&lab, &def);
		def.name = "outer";
		def.position.x = apart[kind];
		lab_add(&lab, &def);
		assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error),
		                 RB_ERR_SCENE);
		assert_non_null(strstr(lab.error.text, "'inner'"));
		assert_non_null(strstr(lab.error.text, "'outer'"));
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_do_not_change_a_bit_of_the_motion),
		cmocka_unit_test(a_parabola_is_exact_at_every_frame),
		cmocka_unit_test(a_tumbling_body_keeps_energy_momentum_and_phase),
		cmocka_unit_test(a_symmetric_top_wobbles_at_its_rate),
		cmocka_unit_test(forces_begin_and_end_at_odd_times),
		cmocka_unit_test(a_force_that_turns_with_the_body_drives_it_in_circles),
		cmocka_unit_test(a_force_off_the_centre_swings_the_body_like_a_pendulum),
		cmocka_unit_test(a_spring_keeps_its_phase_for_100_periods),
		cmocka_unit_test(a_spring_far_away_does_as_one_at_the_origin),
		cmocka_unit_test(a_damped_spring_decays_as_it_should),
		cmocka_unit_test(drag_slows_down_as_it_should),
		cmocka_unit_test(what_slows_down_in_closed_form_goes_as_integrated),
		cmocka_unit_test(stiff_drag_costs_no_digits),
		cmocka_unit_test(a_field_moves_bodies_as_it_should),
		cmocka_unit_test(a_field_far_away_is_followed_as_far_as_it_can_be_told),
		cmocka_unit_test(a_field_of_zero_changes_a_bounce_by_rounding_only),
		cmocka_unit_test(bodies_that_overlap_at_the_start_are_refused_by_name),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
