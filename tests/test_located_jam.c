/* SPDX-License-Identifier: MIT */
/*
 * The located method: rods whose leading end digs in (Painleve), against an integration in the plane (tests/runge.h) after
 * an impulse by Keller's equations (tests/keller.h).
 */
#include <math.h>

#include "geom/mass.h"
#include "model/shape.h"
#include "keller.h"
#include "runge.h"
#include "worlds.h"

/* Its lower end is at -x of its centre before it is turned by `azimuth` about z; it slides to there at `speed`. */
struct rod {
	enum rb_shape_kind kind;
	double length, thick, mass, friction, restitution, degrees, speed, fall, spin, azimuth,
		slope;
};

/* In the plane: the arm to the contact is -(reach cos a, reach sin a + radius), a the angle of its lower half. */
struct plane {
	double reach, radius, mass, inertia, friction, gx, gz;
	int slip; /* 0: sticks, else the direction of its slip; 2: flies */
};

enum { X, Z, ANGLE, VX, VZ, SPIN, VALUES };

static struct rb_shape shape_of(const struct rod *rod)
{
	struct rb_shape shape = {.kind = rod->kind, .radius = 0.5 * rod->thick};

	shape.size[0] = shape.size[1] = rod->thick;
	shape.size[2] = rod->length;
	return shape;
}

static struct plane plane_of(const struct rod *rod, double *y)
{
	const struct rb_shape shape = shape_of(rod);
	const bool box = rod->kind == RB_SHAPE_BOX;
	const double angle = rod->degrees * M_PI / 180;
	const struct plane p = {.reach = 0.5 * (box ? hypot(rod->length, rod->thick) : rod->length),
	                        .radius = box ? 0 : shape.radius,
	                        .mass = rod->mass,
	                        .inertia = rb_shape_inertia(NULL, &shape, rod->mass).m[1][1],
	                        .friction = rod->friction,
	                        .gx = 9.81 * sin(rod->slope),
	                        .gz = -9.81 * cos(rod->slope)};

	y[X] = 0;
	y[ANGLE] = angle + (box ? atan2(rod->thick, rod->length) : 0);
	y[Z] = p.reach * sin(y[ANGLE]) + p.radius;
	y[SPIN] = rod->spin;
	/* the end's velocity along z is -fall */
	y[VX] = -rod->speed;
	y[VZ] = -rod->fall - rod->spin * p.reach * cos(y[ANGLE]);
	return p;
}

/* Normal force and friction of the mode. */
static void forces_of(const struct plane *p, const double *y, double *normal, double *friction)
{
	const double ax = -p->reach * cos(y[ANGLE]), az = -p->reach * sin(y[ANGLE]) - p->radius;
	const double w = y[SPIN], i = 1 / p->inertia, m = 1 / p->mass;
	/* accelerations of the end without them */
	const double down = -p->gz - p->reach * sin(y[ANGLE]) * w * w;
	const double aside = -p->gx - p->reach * cos(y[ANGLE]) * w * w;
	const double nn = m + ax * ax * i, cross = -ax * az * i, tt = m + az * az * i;

	*normal = *friction = 0;
	if (p->slip == 0) {
		const double determinant = nn * tt - cross * cross;

		*normal = (tt * down - cross * aside) / determinant;
		*friction = (nn * aside - cross * down) / determinant;
	} else if (p->slip != 2) {
		*normal = down / (nn - p->friction * p->slip * cross);
		*friction = -p->friction * p->slip * *normal;
	}
}

static void rates(const void *user, double t, const double *y, double *rate)
{
	const struct plane *p = user;
	const double ax = -p->reach * cos(y[ANGLE]), az = -p->reach * sin(y[ANGLE]) - p->radius;
	double normal, friction;

	(void)t;
	forces_of(p, y, &normal, &friction);
	rate[X] = y[VX];
	rate[Z] = y[VZ];
	rate[ANGLE] = -y[SPIN];
	rate[VX] = friction / p->mass + p->gx;
	rate[VZ] = normal / p->mass + p->gz;
	rate[SPIN] = (az * friction - ax * normal) / p->inertia;
}

/* The impulse at the start, and the mode that follows; false: it is none of those that are tested. */
static bool jump(const struct rod *rod, struct plane *p, double *y)
{
	const double ax = -p->reach * cos(y[ANGLE]), az = -p->reach * sin(y[ANGLE]) - p->radius;
	struct keller_impact impact = {.normal = {0, 0, 1},
	                               .friction = rod->friction,
	                               .restitution = rod->restitution,
	                               .body[0].orientation = {1, 0, 0, 0}};
	struct keller k;
	real impulse[3];
	double normal, friction;

	impact.body[1] = (struct keller_body){.inverse_mass = 1 / p->mass,
	                                      .moment = {1, p->inertia, 1},
	                                      .orientation = {1, 0, 0, 0},
	                                      .arm = {ax, 0, az},
	                                      .linear = {y[VX], 0, y[VZ]},
	                                      .angular = {0, y[SPIN], 0}};
	if (rod->fall == 0) /* its rounding must not say that it leaves */
		impact.body[1].linear.z = y[SPIN] * ax - 1e-18;
	assert_true(keller_solve(&k, &impact, impulse));
	y[VX] += (double)(impulse[0] / (real)p->mass);
	y[VZ] += (double)(impulse[2] / (real)p->mass);
	y[SPIN] += (double)(((real)az * impulse[0] - (real)ax * impulse[2]) / (real)p->inertia);
	const double slip = y[VX] + az * y[SPIN], leave = y[VZ] - ax * y[SPIN];
	p->slip = leave > 1e-9 ? 2 : fabs(slip) < 1e-9 ? 0 : slip > 0 ? 1 : -1;
	forces_of(p, y, &normal, &friction);
	return p->slip == 2 || (normal > 0 && fabs(friction) <= p->friction * normal);
}

/* Does the mode last? */
static bool goes_on(const struct plane *p, const double *y)
{
	const double ax = -p->reach * cos(y[ANGLE]), az = -p->reach * sin(y[ANGLE]) - p->radius;
	double normal, friction;

	forces_of(p, y, &normal, &friction);
	if (p->slip == 2)
		return y[Z] + az > 0;
	if (!(normal > 0))
		return false;
	if (p->slip == 0)
		return fabs(friction) < 0.999 * p->friction * normal;
	(void)ax;
	return (y[VX] + az * y[SPIN]) * p->slip > 0;
}

static int add_rod(struct lab *lab, const struct rod *rod, const double *y)
{
	struct rb_body_def def = rb_body_def_default();
	const double lean = M_PI / 2 - rod->degrees * M_PI / 180;
	const rb_quat turn = rb_quat_from_turn((rb_vec3){0, 0, rod->azimuth});

	def.call = rb_shape_name(rod->kind);
	def.shape = shape_of(rod);
	def.mass = rod->mass;
	def.orientation = rb_quat_multiply(turn, rb_quat_from_turn((rb_vec3){0, lean, 0}));
	def.position = rb_quat_rotate(turn, (rb_vec3){y[X], 0, y[Z]});
	def.velocity = rb_quat_rotate(turn, (rb_vec3){y[VX], 0, y[VZ]});
	def.angular_velocity = rb_quat_rotate(turn, (rb_vec3){0, y[SPIN], 0});
	return lab_add(lab, &def);
}

/* After `time`: largest error, of length and of the speeds; < 0: the reference has no such motion. */
static double error_of(const struct rod *rod, double time)
{
	enum { STEPS = 4000 };
	struct bench bench;
	double y[VALUES];
	struct plane p = plane_of(rod, y);
	const rb_quat turn = rb_quat_from_turn((rb_vec3){0, 0, rod->azimuth});

	bench_open(&bench, time, 1 / time);
	lab_surface(&bench.lab, rod->friction, rod->restitution);
	bench.lab.scene.world.gravity = rb_quat_rotate(turn, (rb_vec3){p.gx, 0, p.gz});
	lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	const int id = add_rod(&bench.lab, rod, y);
	bool right = jump(rod, &p, y);
	for (int k = 0; k < STEPS && right; k++) {
		runge_solve(rates, &p, VALUES, y, time * k / STEPS, time * (k + 1) / STEPS, 1);
		right = goes_on(&p, y);
	}
	if (!right) {
		bench_close(&bench);
		return -1;
	}
	bench_seal(&bench);
	lab_run(&bench.lab);
	const struct rb_world *world = bench.lab.world;
	const rb_vec3 x = rb_quat_rotate_back(turn, rb_world_position(world, id));
	const rb_vec3 v = rb_quat_rotate_back(turn, rb_world_velocity(world, id));
	const rb_vec3 w = rb_quat_rotate_back(turn, rb_world_angular_velocity(world, id));
	const double speed = rod->speed + rod->fall + hypot(y[VX], y[VZ]);
	const double off_x = rb_vec3_length(rb_vec3_sub(x, (rb_vec3){y[X], 0, y[Z]})) / rod->length;
	const double off_v = rb_vec3_length(rb_vec3_sub(v, (rb_vec3){y[VX], 0, y[VZ]})) / speed;
	const double off_w = rb_vec3_length(rb_vec3_sub(w, (rb_vec3){0, y[SPIN], 0})) *
	                     rod->length / speed;
	bench_close(&bench);
	return fmax(off_x, fmax(off_v, off_w));
}

static const double kept = 1e-9;

static int check(const struct rod *rod, double time)
{
	const double error = error_of(rod, time);

	if (error < 0)
		return 0;
	if (error > kept)
		print_error("%s %g x %g, %g kg, mu %g, e %g, %g degrees, %g m/s, falls %g, spins "
		            "%g, turned %g, slope %g\n",
		            rb_shape_name(rod->kind), rod->length, rod->thick, rod->mass,
		            rod->friction, rod->restitution, rod->degrees, rod->speed, rod->fall,
		            rod->spin, rod->azimuth, rod->slope);
	assert_near(error, 0, kept);
	return 1;
}

static const struct rod plain = {RB_SHAPE_CAPSULE, 1, 0.01, 1, 1.5, 0, 63, 1, 0, 0, 0, 0};

static void a_slip_that_no_force_allows_ends_at_once(void **slot)
{
	const double degrees[] = {50, 58, 63, 70}, friction[] = {1.4, 1.5, 2, 5};
	const double azimuth[] = {0, M_PI, 0.7, -2.1}, slope[] = {0, 0.1, -0.1, 0.4};
	int count = 0;

	(void)slot;
	for (int shape = 0; shape < 2; shape++)
		for (int k = 0; k < 4; k++)
			for (int n = 0; n < 4; n++) {
				struct rod rod = plain;

				rod.kind = shape ? RB_SHAPE_BOX : RB_SHAPE_CAPSULE;
				rod.degrees = degrees[k];
				rod.friction = friction[n];
				count += check(&rod, 0.05);
				rod.azimuth = azimuth[(k + n) % 4];
				rod.slope = slope[(k + 2 * n) % 4];
				rod.length = 1 + k;
				rod.thick = 0.05 * (1 + n);
				rod.mass = pow(10, k - n);
				rod.speed = 1 + n;
				count += check(&rod, 0.02);
			}
	assert_true(count >= 32);
}

static void it_bounces_by_the_work_of_the_impulse(void **slot)
{
	int count = 0;

	(void)slot;
	for (int k = 0; k < 8; k++) {
		struct rod rod = plain;

		rod.restitution = 0.125 * (k + 1);
		rod.friction = 1.5 + 0.3 * k;
		rod.azimuth = 0.9 * k;
		rod.speed = 0.5 + k;
		count += check(&rod, 0.001);
	}
	assert_int_equal(count, 8);
}

/* An impact that stops the end: it stands, and does not slide on without friction. */
static void an_end_that_an_impact_stops_stands(void **slot)
{
	int count = 0;

	(void)slot;
	for (int shape = 0; shape < 2; shape++)
		for (int k = 0; k < 12; k++) {
			struct rod rod = plain;

			rod.kind = shape ? RB_SHAPE_BOX : RB_SHAPE_CAPSULE;
			rod.degrees = 45 + 3 * k;
			rod.fall = 0.25 * (k + 1);
			rod.spin = 0.3 * (k % 5 - 2);
			rod.friction = 1.4 + 0.2 * (k % 4);
			rod.azimuth = k;
			count += check(&rod, 0.03);
		}
	assert_true(count >= 16);
}

/* Slips that are not in the rod's plane: the impulse, in which they turn, against Keller's equations. */
static void a_slip_to_the_side_ends_by_the_law_of_impacts(void **slot)
{
	int seized = 0;

	(void)slot;
	for (int k = 0; k < 40; k++) {
		struct rod rod = plain;
		struct bench bench;
		struct keller p;
		real impulse[3];
		double y[VALUES];

		rod.friction = 1.6 + 0.4 * (k % 9);
		rod.restitution = k % 3 * 0.5;
		rod.thick = 0.01 * (1 + k % 4);
		const struct plane plane = plane_of(&rod, y);
		const double ax = -plane.reach * cos(y[ANGLE]);
		const double az = -plane.reach * sin(y[ANGLE]) - plane.radius;
		const struct rb_shape shape = shape_of(&rod);
		const rb_mat3 inertia = rb_shape_inertia(NULL, &shape, rod.mass);
		struct keller_impact impact = {
			.normal = {0, 0, 1},
			.friction = rod.friction,
			.restitution = rod.restitution,
			.body[0].orientation = {1, 0, 0, 0},
			.body[1] = {.inverse_mass = 1 / rod.mass,
		                    .moment = {inertia.m[0][0], inertia.m[1][1], inertia.m[2][2]},
		                    .orientation = rb_quat_from_turn(
					    (rb_vec3){0, M_PI / 2 - rod.degrees * M_PI / 180, 0}),
		                    .arm = {ax, 0, az},
		                    .linear = {-1, 0.2 * (k % 11 - 5), 0}}};

		bench_open(&bench, 1e-6, 1e6);
		lab_surface(&bench.lab, rod.friction, rod.restitution);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const int id = add_rod(&bench.lab, &rod, y);
		bench.lab.scene.bodies[id].velocity = impact.body[1].linear;
		impact.body[1].linear.z = -1e-18;
		assert_true(keller_solve(&p, &impact, impulse));
		if (impulse[2] < 1e-9L) { /* it yields */
			bench_close(&bench);
			continue;
		}
		seized++;
		bench_seal(&bench);
		lab_run(&bench.lab);
		const struct rb_event *hit = bench_event(&bench, RB_EVENT_COLLISION, 0);
		assert_near(hit->time_s, 0, 0);
		assert_near(hit->impulse.x, (double)impulse[0], 1e-12);
		assert_near(hit->impulse.y, (double)impulse[1], 1e-12);
		assert_near(hit->impulse.z, (double)impulse[2], 1e-12);
		bench_close(&bench);
	}
	assert_true(seized >= 30);
}

/* A box's edge has two points: whichever way it slips, and whatever it gives back, no energy comes of it, and it rubs. */
static void an_edge_that_digs_in_gains_nothing(void **slot)
{
	(void)slot;
	for (int k = 0; k < 24; k++) {
		struct bench bench;
		struct rod rod = plain;
		double y[VALUES];

		rod.kind = RB_SHAPE_BOX;
		rod.thick = 0.02 * (1 + k % 3);
		rod.friction = 1.6 + 0.2 * (k % 5);
		rod.restitution = k % 4 * 0.25;
		plane_of(&rod, y);
		bench_open(&bench, 0.05, 200);
		lab_surface(&bench.lab, rod.friction, rod.restitution);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const int id = add_rod(&bench.lab, &rod, y);
		bench.lab.scene.bodies[id].velocity.y = 0.1 * (k % 7 - 3);
		bench_seal(&bench);
		const double start = rb_world_kinetic_energy(bench.lab.world, id) +
		                     9.81 * rb_world_position(bench.lab.world, id).z;
		lab_run(&bench.lab);
		const double end = rb_world_kinetic_energy(bench.lab.world, id) +
		                   9.81 * rb_world_position(bench.lab.world, id).z;
		bench_event(&bench, RB_EVENT_COLLISION, 0);
		assert_true(end < start - 0.05);
		bench_close(&bench);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_slip_that_no_force_allows_ends_at_once),
		cmocka_unit_test(it_bounces_by_the_work_of_the_impulse),
		cmocka_unit_test(an_end_that_an_impact_stops_stands),
		cmocka_unit_test(a_slip_to_the_side_ends_by_the_law_of_impacts),
		cmocka_unit_test(an_edge_that_digs_in_gains_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
