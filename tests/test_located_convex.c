/* SPDX-License-Identifier: MIT */
/* The located method: impacts of convex bodies that fly and turn: when they come, and what they do. */
#include <math.h>

#include "solids.h"
#include "worlds.h"

#include "force/drag.h"
#include "located/approach.h"
#include "located/convex_contact.h"
#include "world/world.h"

static struct rb_body_def solid_def(enum rb_shape_kind kind, double x, double y, double z)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = rb_shape_name(kind);
	def.shape.kind = kind;
	if (kind == RB_SHAPE_BOX) {
		def.shape.size[0] = x;
		def.shape.size[1] = y;
		def.shape.size[2] = z;
	} else { /* radius, length */
		def.shape.radius = x;
		def.shape.size[2] = y;
	}
	def.mass = 1;
	return def;
}

static rb_vec3 random_vector(uint64_t series, double most)
{
	return (rb_vec3){solids_random(series, 10, -most, most),
	                 solids_random(series, 11, -most, most),
	                 solids_random(series, 12, -most, most)};
}

static double energy(const struct lab *lab, int bodies)
{
	double sum = 0;

	for (int id = 0; id < bodies; id++)
		sum += rb_world_kinetic_energy(lab->world, id);
	return sum;
}

static void a_flat_drop_stays_flat_on_every_ground(void **slot)
{
	const double h = 1, g = 9.81;

	(void)slot;
	for (int ground = 0; ground < 3; ground++)
		for (int e = 0; e <= 2; e++)
			for (int yaw = 0; yaw < 3; yaw++) {
				struct bench bench;
				struct rb_body_def floor = solid_def(RB_SHAPE_BOX, 5, 4, 1);

				bench_open(&bench, 0.6, 10);
				lab_surface(&bench.lab, 0.5, 0.5 * e);
				struct rb_body_def def = solid_def(RB_SHAPE_BOX, 1, 0.5, 0.25);
				def.position = (rb_vec3){0.1, 0.2, 0.125 + h};
				def.orientation = rb_quat_from_turn((rb_vec3){0, 0, 0.7 * yaw});
				const int id = lab_add(&bench.lab, &def);
				floor.position.z = -0.5;
				floor.is_static = true;
				if (ground == 0)
					lab_plane(&bench.lab, (rb_vec3){0, 0, 0},
					          (rb_vec3){0, 0, 1});
				else if (ground == 1)
					lab_rectangle(&bench.lab, (rb_vec3){0, 0, 0},
					              (rb_vec3){0, 0, 1}, 6, 5);
				else
					lab_add(&bench.lab, &floor);
				bench_seal(&bench);
				lab_run(&bench.lab);
				const struct rb_event *hit = bench_event(&bench, RB_EVENT_COLLISION,
				                                         0);
				const double v = sqrt(2 * g * h);
				assert_near(hit->time_s, sqrt(2 * h / g), 1e-15);
				assert_vector(rb_world_angular_velocity(bench.lab.world, id),
				              ((rb_vec3){0, 0, 0}), 1e-13);
				const double left = 0.6 - sqrt(2 * h / g);
				const double up = e == 0 ? 0
				                         : 0.5 * e * v * left -
				                                   0.5 * g * left * left;
				assert_near(rb_world_position(bench.lab.world, id).z, 0.125 + up,
				            1e-13);
				bench_close(&bench);
			}
}

static void a_needle_that_lands_on_its_tip_gets_the_impulse_of_the_formula(void **slot)
{
	(void)slot;
	for (int k = 0; k < 12; k++) {
		const double e = 0.25 * (k % 4), tilt = 0.3 + 0.1 * k, speed = 2;
		const double radius = k % 2 ? 1e-6 : 1e-3;
		struct bench bench;

		bench_open(&bench, 1, 10);
		bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		lab_surface(&bench.lab, 0, e);
		struct rb_body_def def = solid_def(RB_SHAPE_CAPSULE, radius, 1, 0);
		def.mass = 3;
		def.position.z = 1;
		def.velocity.z = -speed;
		def.orientation = rb_quat_from_turn((rb_vec3){0.1, tilt, 0});
		lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		bench_seal(&bench);
		const rb_vec3 axis = rb_quat_rotate(def.orientation, (rb_vec3){0, 0, 0.5});
		const double lever = sqrt(axis.x * axis.x + axis.y * axis.y);
		const double inertia = rb_model_inertia(bench.lab.model, 0)->m[0][0];
		const double wanted = (1 + e) * speed / (1 / def.mass + lever * lever / inertia);
		lab_run(&bench.lab);
		const struct rb_event *hit = bench_event(&bench, RB_EVENT_COLLISION, 0);
		assert_near(fabs(hit->impulse.z) / wanted, 1, 1e-12);
		assert_near(hit->time_s, (1 - fabs(axis.z) - radius) / speed, 1e-15);
		bench_close(&bench);
	}
}

static void a_spinning_rod_hits_at_the_moment_at_which_its_corner_comes_down(void **slot)
{
	(void)slot;
	for (int k = 0; k < 20; k++) {
		const double spin = 3 + 40 * k, fall = 0.3, half = 0.5, thin = 0.01;
		struct bench bench;

		bench_open(&bench, 4, 10);
		bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		lab_surface(&bench.lab, 0, 0.5);
		struct rb_body_def def = solid_def(RB_SHAPE_BOX, 2 * half, 0.3, 2 * thin);
		def.position.z = 1;
		def.velocity.z = -fall;
		def.angular_velocity.y = spin;
		lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		bench_seal(&bench);
		lab_run(&bench.lab);
		const double t = bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s;
		const double phi = spin * t;
		const double gap = 1 - fall * t - half * fabs(sin(phi)) - thin * fabs(cos(phi));
		/* an ulp of the angle turns its tip by spin t half eps */
		assert_near(gap, 0, 4e-16 * (4 + spin * t));
		/* and not one turn later: nothing was below the plane before */
		for (int i = 0; i < 100000; i++) {
			const double s = t * i / 100000, a = spin * s;
			assert_true(1 - fall * s - half * fabs(sin(a)) - thin * fabs(cos(a)) > 0);
		}
		bench_close(&bench);
	}
}

static void a_thin_fast_stick_never_passes_a_wall(void **slot)
{
	(void)slot;
	for (int k = 0; k < 8; k++) {
		struct bench bench;

		bench_open(&bench, 1, 100);
		bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		lab_surface(&bench.lab, 0.2 * (k % 3), 1);
		struct rb_body_def def = k % 2 ? solid_def(RB_SHAPE_CAPSULE, 1e-6, 1, 0)
		                               : solid_def(RB_SHAPE_BOX, 1e-3, 1e-3, 1);
		def.position = (rb_vec3){0.1, 0.05, 0};
		def.velocity = (rb_vec3){5, 3, 40 + k};
		def.angular_velocity = (rb_vec3){900, 100 * k, 30};
		const int id = lab_add(&bench.lab, &def);
		lab_rectangle(&bench.lab, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 1}, 40, 40);
		lab_rectangle(&bench.lab, (rb_vec3){0, 0, -1}, (rb_vec3){0, 0, 1}, 40, 40);
		bench_seal(&bench);
		while (rb_world_frame(bench.lab.world) + 1 <
		       rb_world_frame_count(bench.lab.world)) {
			lab_step(&bench.lab);
			const double z = rb_world_position(bench.lab.world, id).z;
			const rb_vec3 tip = rb_quat_rotate(
				rb_world_orientation(bench.lab.world, id), (rb_vec3){0, 0, 0.5});
			assert_true(fabs(z) + fabs(tip.z) <= 1 + 1e-9);
		}
		assert_true(lab_log_count(&bench.log, RB_EVENT_COLLISION) > 5);
		bench_close(&bench);
	}
}

static void a_box_in_a_room_keeps_its_energy_through_a_hundred_impacts(void **slot)
{
	const rb_vec3 ways[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
	                         {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
	struct bench bench;

	(void)slot;
	bench_open(&bench, 30, 10);
	bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	lab_surface(&bench.lab, 0, 1);
	struct rb_body_def def = solid_def(RB_SHAPE_BOX, 0.3, 0.2, 0.4);
	def.velocity = (rb_vec3){3, 2, 1.5};
	def.angular_velocity = (rb_vec3){2, 3, 1};
	lab_add(&bench.lab, &def);
	for (int k = 0; k < 6; k++)
		lab_plane(&bench.lab, ways[k], rb_vec3_neg(ways[k]));
	bench_seal(&bench);
	const double before = energy(&bench.lab, 1);
	while (lab_log_count(&bench.log, RB_EVENT_COLLISION) < 100)
		lab_step(&bench.lab);
	assert_near(energy(&bench.lab, 1) / before, 1, 1e-12);
	bench_close(&bench);
}

static struct rb_body_def random_solid(struct lab *lab, uint64_t series)
{
	static const enum rb_shape_kind kinds[4] = {RB_SHAPE_BOX, RB_SHAPE_CAPSULE,
	                                            RB_SHAPE_CYLINDER, RB_SHAPE_HULL};
	const enum rb_shape_kind kind = kinds[(int)solids_random(series, 20, 0, 3.999)];
	const double x = solids_random(series, 21, 0.01, 0.5);
	const double y = solids_random(series, 22, 0.05, 0.8);
	struct rb_body_def def = solid_def(kind, x, y, solids_random(series, 23, 0.02, 1));

	if (kind == RB_SHAPE_HULL) {
		rb_vec3 points[12];
		for (uint64_t k = 0; k < 12; k++)
			points[k] = random_vector(1000 * series + k, 0.5);
		assert_int_equal(
			rb_scene_add_hull(&lab->scene, points, 12, &def.shape.solid, &lab->error),
			RB_OK);
		def.center_of_mass = lab->scene.solids[def.shape.solid].centroid;
	}
	def.orientation = solids_turn(series);
	def.angular_velocity = random_vector(series + 500000, 20);
	def.mass = exp(solids_random(series, 24, -4, 4));
	return def;
}

static rb_vec3 momentum(const struct lab *lab, int bodies)
{
	rb_vec3 sum = {0, 0, 0};

	for (int id = 0; id < bodies; id++)
		sum = rb_vec3_add_scaled(sum, lab->model->mass[lab->model->index_of[id]],
		                         rb_world_velocity(lab->world, id));
	return sum;
}

/* A pair that meets, for a second or until its first impact. Did it come? */
static bool never_gains(uint64_t k, bool goes_on, double tolerance)
{
	struct bench bench;

	bench_open(&bench, 1, goes_on ? 40 : 400);
	bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	lab_surface(&bench.lab, solids_random(k, 1, 0, 1.5), solids_random(k, 2, 0, 1));
	struct rb_body_def a = random_solid(&bench.lab, 3 * k + 7);
	struct rb_body_def b = random_solid(&bench.lab, 3 * k + 8);
	b.position.z = 3;
	b.velocity = rb_vec3_add((rb_vec3){0, 0, -6}, random_vector(k, 0.5));
	lab_add(&bench.lab, &a);
	lab_add(&bench.lab, &b);
	bench_seal(&bench);
	const rb_vec3 pushed = momentum(&bench.lab, 2);
	const double start = energy(&bench.lab, 2);
	double before = start;
	while (rb_world_frame(bench.lab.world) + 1 < rb_world_frame_count(bench.lab.world) &&
	       (goes_on || lab_log_count(&bench.log, RB_EVENT_COLLISION) < 1)) {
		lab_step(&bench.lab);
		const double now = energy(&bench.lab, 2);
		assert_true(now <= before + tolerance * start);
		before = now;
	}
	assert_vector(momentum(&bench.lab, 2), pushed, tolerance * rb_vec3_length(pushed));
	const bool hit = lab_log_count(&bench.log, RB_EVENT_COLLISION) > 0;
	bench_close(&bench);
	return hit;
}

static void impacts_of_random_bodies_never_gain_energy(void **slot)
{
	int hits = 0;

	(void)slot;
	for (uint64_t k = 0; k < 300; k++)
		hits += never_gains(k, false, 1e-12);
	assert_true(hits > 100);
}

/* Series of impacts that end, slip, rolling and parting included. */
static void what_follows_random_impacts_gains_none_either(void **slot)
{
	(void)slot;
	for (uint64_t k = 300; k < 340; k++)
		never_gains(k, true, 1e-9);
}

static void edges_that_cross_exchange_velocities(void **slot)
{
	struct bench bench;

	(void)slot;
	bench_open(&bench, 1, 10);
	bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	lab_surface(&bench.lab, 0.5, 1);
	/* both on an edge, their lowest and highest edges across each other */
	struct rb_body_def low = solid_def(RB_SHAPE_BOX, 1, 0.5, 0.5), high = low;
	const double half = 0.25 * sqrt(2);
	low.orientation = rb_quat_from_turn((rb_vec3){atan(1), 0, 0});
	high.orientation = rb_quat_multiply(rb_quat_from_turn((rb_vec3){0, 0, 2 * atan(1)}),
	                                    low.orientation);
	high.position.z = 2 * half + 1;
	high.velocity.z = -2;
	lab_add(&bench.lab, &low);
	lab_add(&bench.lab, &high);
	bench_seal(&bench);
	lab_run(&bench.lab);
	assert_int_equal(lab_log_count(&bench.log, RB_EVENT_COLLISION), 1);
	assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s, 0.5, 1e-15);
	assert_vector(rb_world_velocity(bench.lab.world, 0), ((rb_vec3){0, 0, -2}), 1e-14);
	assert_vector(rb_world_velocity(bench.lab.world, 1), ((rb_vec3){0, 0, 0}), 1e-14);
	assert_vector(rb_world_angular_velocity(bench.lab.world, 0), ((rb_vec3){0, 0, 0}), 1e-13);
	bench_close(&bench);
}

static void a_ball_meets_every_feature_of_a_box(void **slot)
{
	const rb_vec3 from[3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}};

	(void)slot;
	for (int k = 0; k < 3; k++) {
		struct bench bench;

		bench_open(&bench, 2, 10);
		bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		lab_surface(&bench.lab, 0.3, 0.5);
		struct rb_body_def crate = solid_def(RB_SHAPE_BOX, 1, 1, 1);
		const rb_vec3 n = rb_vec3_unit(from[k], (rb_vec3){0, 0, 1});
		/* towards the middle: over a face, an edge, a corner */
		const double half = 0.5 * sqrt(1.0 + k);
		lab_add(&bench.lab, &crate);
		lab_sphere(&bench.lab, 0.25, 1, rb_vec3_scale(half + 0.25 + 1, n),
		           rb_vec3_scale(-2, n));
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s, 0.5, 2e-15);
		assert_vector(rb_world_velocity(bench.lab.world, 0), rb_vec3_scale(-1.5, n), 1e-13);
		assert_vector(rb_world_velocity(bench.lab.world, 1), rb_vec3_scale(-0.5, n), 1e-13);
		bench_close(&bench);
	}
}

/* Corners that hardly leave and hardly touch: what rounding leaves of them once let the slab sink. */
static void a_slab_that_is_hit_clatters_without_overlap(void **slot)
{
	struct bench bench;

	(void)slot;
	bench_open(&bench, 1.3, 60);
	lab_surface(&bench.lab, 0.5, 0.4);
	lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	struct rb_body_def box = solid_def(RB_SHAPE_BOX, 0.3, 0.2, 0.4);
	box.mass = 24;
	box.position.z = 1;
	box.orientation = rb_quat_from_turn(
		rb_vec3_scale(0.7 / sqrt(1.13), (rb_vec3){1, 0.3, 0.2}));
	lab_add(&bench.lab, &box);
	struct rb_body_def slab = solid_def(RB_SHAPE_BOX, 1, 1, 0.2);
	slab.mass = 200;
	slab.position.z = 0.1;
	lab_add(&bench.lab, &slab);
	lab_sphere(&bench.lab, 0.1, 4, (rb_vec3){0.3, 0, 2}, (rb_vec3){0, 0, 0});
	bench_seal(&bench);
	/* a step fails where bodies overlap by more than the tolerance */
	while (rb_world_time(bench.lab.world) < 0.95)
		lab_step(&bench.lab);
	bench_close(&bench);
}

/*
 * A flat end that is tilted so little that all of its rim counts as touching: the lowest point of the rim is what is told,
 * and not that of one of the points that hold it. By d of overlap and a tilt: d + r * tilt lower than the middle.
 */
static void the_overlap_that_is_told_is_that_of_the_lowest_point(void **state)
{
	static const double tilts[] = {1e-4, 1e-6, 1e-8};
	const double r = 0.1, length = 0.1, d = 5e-4;

	(void)state;
	for (int k = 0; k < 3; k++) {
		struct bench bench;
		const double tilt = tilts[k];
		const rb_quat q = {cos(tilt / 2), sin(tilt / 2) * cos(0.37),
		                   sin(tilt / 2) * sin(0.37), 0};

		bench_open(&bench, 0.1, 10);
		bench.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		bench.lab.scene.world.tolerance_m = 1e-3;
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		struct rb_body_def def = solid_def(RB_SHAPE_CYLINDER, r, length, 0);
		def.orientation = q;
		def.position.z = r * sin(tilt) + 0.5 * length * cos(tilt) - d;
		lab_add(&bench.lab, &def);
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_near(rb_world_totals(bench.lab.world).max_penetration, d, 1e-3 * r * tilt);
		bench_close(&bench);
	}
}

/* Across the seams of two crates, in a direction of its own; and over the border of the last one, where it is too fast to stay. */
static void a_ball_rolls_over_seams_and_flies_off_a_border(void **slot)
{
	const rb_vec3 v = {2, 0.7, 0};

	(void)slot;
	for (int fixed = 0; fixed < 2; fixed++) {
		struct bench bench;

		bench_open(&bench, 1, 10);
		lab_surface(&bench.lab, 0, 0.5);
		lab_plane(&bench.lab, (rb_vec3){0, 0, -1}, (rb_vec3){0, 0, 1});
		for (int k = -1; k <= 1; k++) {
			struct rb_body_def crate = solid_def(RB_SHAPE_BOX, 0.5, 4, 1);

			crate.mass = fixed ? crate.mass : 1000;
			crate.is_static = fixed;
			crate.position = (rb_vec3){0.5 * k, 0, -0.5};
			lab_add(&bench.lab, &crate);
		}
		struct rb_body_def ball = lab_sphere_def(0.1, 1, (rb_vec3){-0.7, 0, 0.1}, v);
		ball.angular_velocity = (rb_vec3){-v.y / 0.1, v.x / 0.1, 0};
		const int id = lab_add(&bench.lab, &ball);
		bench_seal(&bench);
		lab_run(&bench.lab);
		/* its centre is over the border at x = 0.75; told by a share of the crates' size late */
		const double s = 1 - 1.45 / v.x;
		assert_vector(rb_world_position(bench.lab.world, id),
		              ((rb_vec3){1.3, v.y, 0.1 - 0.5 * 9.81 * s * s}), 1e-9);
		assert_vector(rb_world_velocity(bench.lab.world, id),
		              ((rb_vec3){v.x, v.y, -9.81 * s}), 1e-9);
		assert_vector(rb_world_angular_velocity(bench.lab.world, id), ball.angular_velocity,
		              1e-9);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_COLLISION), 0);
		bench_close(&bench);
	}
}

static const double rim = 0.15; /* m: radius of a cylinder */

/*
 * Lets a cylinder go at rest, on its rim, tilted by this towards `yaw`; how it stands after a second. It falls about the point
 * of the rim, as friction is large, with (I + m(h^2 + R^2)) w^2 / 2 = m g (h cos tilt + R sin tilt - h), and lands flat.
 */
static void rock(struct bench *bench, int ground, double half, double tilt, double yaw,
                 double seconds)
{
	const rb_quat turn = rb_quat_from_turn((rb_vec3){tilt * cos(yaw), tilt * sin(yaw), 0});
	struct rb_body_def def = solid_def(RB_SHAPE_CYLINDER, rim, 2 * half, 0);
	struct rb_body_def floor = solid_def(RB_SHAPE_BOX, 5, 4, 1);

	bench_open(bench, seconds, 10);
	lab_surface(&bench->lab, 5, 0);
	def.position.z = half * cos(tilt) + rim * sin(tilt);
	def.orientation = turn;
	lab_add(&bench->lab, &def);
	floor.position.z = -0.5;
	floor.is_static = true;
	if (ground == 0)
		lab_plane(&bench->lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	else
		lab_add(&bench->lab, &floor);
	bench_seal(bench);
	lab_run(&bench->lab);
}

/* Of a thin one both sides are stopped, wherever it lands, and so is all of it. */
static void a_coin_that_rocks_on_to_its_face_stays_there(void **slot)
{
	const double half = 0.02, tilt = 0.1;

	(void)slot;
	for (int ground = 0; ground < 2; ground++)
		for (int k = 0; k < 12; k++) {
			const double yaw = 0.6 * k;
			/* the point of the rim that it falls about stays where it is */
			const double moved = rim * (1 - cos(tilt)) + half * sin(tilt);
			struct bench bench;

			rock(&bench, ground, half, tilt, yaw, 1);
			const rb_vec3 p = rb_world_position(bench.lab.world, 0);
			assert_near(fabs(p.x * sin(yaw) - p.y * cos(yaw)), moved, 1e-12);
			assert_near(p.x * cos(yaw) + p.y * sin(yaw), 0, 1e-12);
			assert_near(p.z, half, 1e-14); /* roundings of the floor's size */
			assert_vector(rb_world_velocity(bench.lab.world, 0), ((rb_vec3){0, 0, 0}),
			              0);
			assert_vector(rb_world_angular_velocity(bench.lab.world, 0),
			              ((rb_vec3){0, 0, 0}), 0);
			bench_close(&bench);
		}
}

/*
 * Of a long one the side that lands takes it up: by the angular momentum about it, w' = w (I + m(h^2 - R^2)) /
 * (I + m(h^2 + R^2)), and the other side leaves.
 */
static void a_long_cylinder_rocks_over_to_the_other_side(void **slot)
{
	const double half = 0.3, tilt = 0.1, g = 9.81;

	(void)slot;
	for (int k = 0; k < 12; k++) {
		struct bench bench;

		/* it takes 0.22 s to fall, and 0.14 s up to where it turns */
		rock(&bench, 0, half, tilt, 0.6 * k, 0.3);
		const double inertia = rb_model_inertia(bench.lab.model, 0)->m[0][0];
		const double far = inertia + half * half + rim * rim;
		const double near = inertia + half * half - rim * rim;
		const double fall = g * (half * cos(tilt) + rim * sin(tilt) - half);
		const double left = fall * near * near / (far * far);
		const double up = g * (rb_world_position(bench.lab.world, 0).z - half);

		assert_true(up > 0.1 * left);
		assert_near(energy(&bench.lab, 1) + up, left, 1e-12 * fall);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_COLLISION), 1);
		bench_close(&bench);
	}
}

/*
 * Without friction it tilts in one plane until both sides of its end are down at once, whichever way all of it is turned: of
 * its tilt rounding leaves a direction across as likely as one along. Lengths and the gravity scale alike.
 */
static void a_smooth_cylinder_comes_down_flat_alike_in_every_direction(void **slot)
{
	static const double scales[] = {1, 0x1p-10, 0x1p10};
	const rb_quat first_way = {0.866, -0.307, 0.374, 0.127};
	rb_vec3 first = {0, 0, 0};

	(void)slot;
	for (int k = 0; k < 40; k++) {
		const double scale = scales[k % 3];
		const rb_quat all = rb_quat_from_turn(
			rb_vec3_scale(k > 0, random_vector((uint64_t)k, 3)));
		struct bench bench;
		struct rb_body_def def = solid_def(RB_SHAPE_CYLINDER, 0.081 * scale, 0.296 * scale,
		                                   0);

		bench_open(&bench, 0.9, 10);
		lab_surface(&bench.lab, 0, 0.5);
		bench.lab.scene.world.gravity = rb_quat_rotate(all, (rb_vec3){0, 0, -9.81 * scale});
		def.position = rb_quat_rotate(all, (rb_vec3){-0.01 * scale, 0, 0.5 * scale});
		def.velocity = rb_quat_rotate(all, (rb_vec3){0, 0.457 * scale, 0.168 * scale});
		def.orientation = rb_quat_unit(rb_quat_multiply(all, first_way));
		lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0},
		          rb_quat_rotate(all, (rb_vec3){0.31, 0, 0.951}));
		bench_seal(&bench);
		lab_run(&bench.lab);
		const rb_vec3 place = rb_quat_rotate_back(all,
		                                          rb_world_position(bench.lab.world, 0));

		first = k == 0 ? place : first;
		assert_vector(rb_vec3_scale(1 / scale, place), first, 1e-9);
		bench_close(&bench);
	}
}

/* Friction turns it over as it lands: about the point of its rim that is foremost, in whichever direction that is. */
static void a_cylinder_that_lands_flat_in_flight_trips_alike_in_every_direction(void **slot)
{
	const double height = 0.05;
	rb_vec3 first = {0, 0, 0}, spin = {0, 0, 0};

	(void)slot;
	for (int k = 0; k < 8; k++) {
		const rb_vec3 along = {cos(0.7 * k), sin(0.7 * k), 0};
		const rb_vec3 aside = {-along.y, along.x, 0};
		struct bench bench;
		struct rb_body_def def = solid_def(RB_SHAPE_CYLINDER, 0.2, 0.4, 0);

		bench_open(&bench, 0.15, 100);
		lab_surface(&bench.lab, 2, 0);
		def.position.z = 0.2 + height;
		def.velocity = rb_vec3_scale(4, along);
		lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		bench_seal(&bench);
		lab_run(&bench.lab);
		const rb_vec3 p = rb_world_position(bench.lab.world, 0);
		const rb_vec3 w = rb_world_angular_velocity(bench.lab.world, 0);
		const rb_vec3 place = {rb_vec3_dot(p, along), rb_vec3_dot(p, aside), p.z};
		const rb_vec3 turns = {rb_vec3_dot(w, along), rb_vec3_dot(w, aside), w.z};

		if (k == 0) {
			first = place;
			spin = turns;
			assert_true(spin.y > 0.1);
		}
		assert_vector(place, first, 1e-10);
		assert_vector(turns, spin, 1e-9);
		bench_close(&bench);
	}
}

/* Of unlike bodies in any order: a point that lies within its features' bounds is passed on to itself. */
static void a_point_within_its_features_is_passed_on_to_itself(void **slot)
{
	static const rb_vec3 size[] = {{0.5, 0.4, 0.3}, {0.2, 0.5, 0}, {0.3, 0.2, 0}};
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_BOX, RB_SHAPE_CAPSULE,
	                                           RB_SHAPE_CYLINDER};
	int seen = 0;

	(void)slot;
	for (int k = 0; k < 60; k++) {
		const int which[2] = {k % 3, k / 3 % 3};
		struct bench bench;

		bench_open(&bench, 1, 1);
		for (int i = 0; i < 2; i++) {
			struct rb_body_def def = solid_def(kinds[which[i]], size[which[i]].x,
			                                   size[which[i]].y, size[which[i]].z);

			def.position = (rb_vec3){1.5 * i, 0.1, 0};
			def.orientation = rb_quat_from_turn(
				random_vector((uint64_t)(2 * k + i), 3));
			lab_add(&bench.lab, &def);
		}
		bench_seal(&bench);
		const struct rb_located *const l = bench.lab.world->located;
		const struct rb_pose a = rb_arc_pose(l, 0, 0), b = rb_arc_pose(l, 1, 0);
		const struct rb_contact_point m = rb_touch_nearest(l, 0, 1, &a, &b);
		const struct rb_contact_point passed = rb_touch_passed_on(l, &m);
		if (m.inside >= 0) {
			seen++;
			assert_true(passed.key == m.key);
			assert_near(passed.gap, m.gap, 1e-15);
			assert_vector(passed.point, m.point, 1e-15);
		}
		bench_close(&bench);
	}
	assert_true(seen > 30);
}

/*
 * A box falls along a wall that it touches, or nearly: gravity does not take it there, nor does drag, whichever way the wall
 * stands. On an arc, on one that decays, and on a piece, as what turns under drag is.
 */
static void what_falls_along_a_wall_is_not_sought_step_by_step(void **slot)
{
	static const double gaps[] = {0, 1e-15, 1e-10}, drags[] = {0, 5, 5},
			    spins[] = {0, 0, 1e-15};

	(void)slot;
	for (int k = 0; k < 36; k++) {
		const rb_quat all = rb_quat_from_turn(k < 9 ? (rb_vec3){0, 0, 0}
		                                            : random_vector((uint64_t)k, 3));
		const rb_vec3 n = rb_quat_rotate(all, (rb_vec3){1, 0, 0});
		const struct rb_drag_def drag = {.linear = drags[k % 3]};
		struct bench bench;
		struct rb_body_def def = solid_def(RB_SHAPE_BOX, 0.2, 0.2, 0.2);

		bench_open(&bench, 1e-3, 1e4);
		bench.lab.scene.world.gravity = rb_quat_rotate(all, (rb_vec3){0, 0, -9.81});
		lab_surface(&bench.lab, 0, 0);
		def.position = rb_vec3_scale(0.1 + gaps[k / 3 % 3], n);
		def.orientation = all;
		def.velocity = rb_quat_rotate(all, (rb_vec3){0, 0.3, 0});
		def.angular_velocity = rb_vec3_scale(spins[k % 3], n);
		lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, (rb_vec3){0, 0, 0}, n);
		if (drag.linear > 0)
			assert_int_equal(
				rb_scene_add_drag(&bench.lab.scene, &drag, &bench.lab.error),
				RB_OK);
		bench_seal(&bench);
		lab_step(&bench.lab);
		const struct rb_approach found = rb_approach_find(bench.lab.world->located, 0, 1,
		                                                  1e-4, 1e-3);
		/* that is some 1e5 steps of 6e-9 s, or 50 of 2e-5 s; where rounding of the direction is all that is left, few */
		assert_false(found.unfinished);
		assert_true(found.touch_s > 1e-3);
		assert_true(found.products < 40 * (uint64_t)RB_LOCATED_SEARCH);
		bench_close(&bench);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_falls_along_a_wall_is_not_sought_step_by_step),
		cmocka_unit_test(a_point_within_its_features_is_passed_on_to_itself),
		cmocka_unit_test(a_flat_drop_stays_flat_on_every_ground),
		cmocka_unit_test(a_needle_that_lands_on_its_tip_gets_the_impulse_of_the_formula),
		cmocka_unit_test(a_spinning_rod_hits_at_the_moment_at_which_its_corner_comes_down),
		cmocka_unit_test(a_thin_fast_stick_never_passes_a_wall),
		cmocka_unit_test(a_box_in_a_room_keeps_its_energy_through_a_hundred_impacts),
		cmocka_unit_test(impacts_of_random_bodies_never_gain_energy),
		cmocka_unit_test(what_follows_random_impacts_gains_none_either),
		cmocka_unit_test(edges_that_cross_exchange_velocities),
		cmocka_unit_test(a_ball_meets_every_feature_of_a_box),
		cmocka_unit_test(a_slab_that_is_hit_clatters_without_overlap),
		cmocka_unit_test(the_overlap_that_is_told_is_that_of_the_lowest_point),
		cmocka_unit_test(a_ball_rolls_over_seams_and_flies_off_a_border),
		cmocka_unit_test(a_coin_that_rocks_on_to_its_face_stays_there),
		cmocka_unit_test(a_long_cylinder_rocks_over_to_the_other_side),
		cmocka_unit_test(a_smooth_cylinder_comes_down_flat_alike_in_every_direction),
		cmocka_unit_test(
			a_cylinder_that_lands_flat_in_flight_trips_alike_in_every_direction),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
