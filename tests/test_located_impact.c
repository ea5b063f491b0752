/* SPDX-License-Identifier: MIT */
/* src/event: impacts against closed forms. */
#include "worlds.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const rb_vec3 earth = {0, 0, -9.81};
static const double pi = 3.14159265358979323846, g = 9.81;

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

/* ---- one ball on a floor ---- */

/* Height above the floor of a ball with e = 1 dropped from `h`, and how many impacts it has had. */
static double bounce_height(double h, double t, int *count)
{
	const double half = sqrt(2 * h / g), s = fmod(t + half, 2 * half) - half;

	*count = (int)floor((t + half) / (2 * half));
	return h - 0.5 * g * s * s;
}

static uint64_t thousand_bounces(double time_step, enum rb_method_kind method)
{
	const double h = 4.9, half = sqrt(2 * h / g), t = 2001.3 * half;
	struct lab lab;
	int count;

	lab_open(&lab, t, 0.5);
	lab.scene.world.method = method;
	lab.scene.world.time_step_s = time_step;
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0, 1);
	const int ball = lab_sphere(&lab, 0.1, 10, at(0, 0, h + 0.1), origin);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	const struct rb_frame_numbers start = rb_world_totals(lab.world);
	lab_run(&lab);
	const struct rb_frame_numbers end = rb_world_totals(lab.world);
	const double energy = start.potential_energy - 10 * g * 0.1;
	assert_near((end.kinetic_energy + end.potential_energy - start.potential_energy) / energy,
	            0, 1e-11);
	const double height = bounce_height(h, rb_world_time(lab.world), &count);
	assert_int_equal(end.collisions, count);
	assert_int_equal(count, 1001);
	/* how late: by the speed there */
	const double v = rb_world_velocity(lab.world, ball).z;
	assert_near((rb_world_position(lab.world, ball).z - 0.1 - height) / v, 0, 1e-9);
	const uint64_t hash = rb_world_hash(lab.world);
	lab_close(&lab);
	return hash;
}

static void a_thousand_elastic_bounces_keep_energy_and_phase(void **slot)
{
	(void)slot;
	const uint64_t hash = thousand_bounces(1e-1, RB_METHOD_LOCATED);

	for (double dt = 1e-4; dt < 0.1; dt *= 10)
		assert_true(thousand_bounces(dt, RB_METHOD_LOCATED) == hash);
	assert_true(thousand_bounces(1e-2, RB_METHOD_AUTO) == hash);
}

/* Rest times of a drop by 1 m: sqrt(2h/g) (1 + e)/(1 - e), as seen by on_transition. */
static void a_bouncing_ball_rests_in_time(void **slot)
{
	const double restitution[] = {0.1, 0.5, 0.8, 0.9, 0.99};

	(void)slot;
	for (int k = 0; k < 5; k++) {
		const double e = restitution[k];
		const double rest = sqrt(2 / g) * (1 + e) / (1 - e);
		const struct rb_world_options options = {.threads = 1};
		struct lab lab;
		struct lab_log log;
		const struct rb_world_hooks hooks = lab_log_open(&log);

		lab_open_located(&lab, 1.1 * rest, 10 / rest);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0.3, e);
		const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 1.1), origin);
		lab_plane(&lab, origin, up);
		lab_seal_with(&lab, &options, &hooks);
		lab_run(&lab);
		const struct rb_event *event = lab_log_find(&log, RB_EVENT_REST, 0);
		assert_non_null(event);
		assert_near(event->time_s / rest, 1, 1e-9);
		assert_int_equal(event->a, 0);
		assert_int_equal(event->b, 1);
		assert_int_equal(lab_log_count(&log, RB_EVENT_MERGE), 1);
		assert_true(rb_vec3_length(rb_world_velocity(lab.world, ball)) == 0);
		assert_near(rb_world_position(lab.world, ball).z, 0.1, 1e-12);
		assert_true(lab_log_count(&log, RB_EVENT_COLLISION) < 100000);
		assert_near(lab_log_find(&log, RB_EVENT_COLLISION, 0)->time_s, sqrt(2 / g), 1e-15);
		lab_log_close(&log);
		lab_close(&lab);
	}
}

/* Far from the origin a touch is off by roundings: what leaves it falls from no height, and is back after 2 v / g. */
static void a_hop_from_a_touch_lasts_as_long_as_its_speed(void **slot)
{
	const double far = 1000, radius = 0.1, speed = 1e-7, ulp = 0x1p-43;

	(void)slot;
	for (int off = -8; off <= 8; off += 4)
		for (int flat = 0; flat < 2; flat++) {
			struct bench bench;

			bench_open(&bench, 1, 1);
			lab_surface(&bench.lab, 0, 0);
			lab_sphere(&bench.lab, radius, 1, at(0, 0, far + radius + off * ulp),
			           at(0, 0, speed));
			struct rb_body_def def = lab_sphere_def(1, 1, at(0, 0, far - 1), origin);
			def.is_static = true;
			if (flat)
				lab_plane(&bench.lab, at(0, 0, far), up);
			else
				lab_add(&bench.lab, &def);
			bench_seal(&bench);
			lab_run(&bench.lab);
			/* its speed is known to the rounding of a fall by its own size, 3e-8 of it */
			const double back_s = 2 * speed / g;
			assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s / back_s, 1,
			            1e-6);
			bench_close(&bench);
		}
}

/* A ball on the middle of a box that stands: bounces end where they are too small, whichever of the two comes first. */
static void a_ball_bounces_as_often_whoever_is_named_first(void **slot)
{
	int count[2];

	(void)slot;
	for (int way = 0; way < 2; way++) {
		struct bench bench;
		struct rb_body_def ball = lab_sphere_def(0.1, 1, at(0, 0, 1.1), origin);
		struct rb_body_def box = lab_sphere_def(0, 8, at(0, 0, -0.1), origin);

		bench_open(&bench, 3, 1);
		lab_surface(&bench.lab, 0.3, 0.5);
		box.call = "box";
		box.shape.kind = RB_SHAPE_BOX;
		rb_vec3_to(box.shape.size, at(1, 1, 0.2));
		lab_add(&bench.lab, way ? &box : &ball);
		lab_add(&bench.lab, way ? &ball : &box);
		lab_plane(&bench.lab, at(0, 0, -0.2), up);
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_near(rb_world_totals(bench.lab.world).kinetic_energy, 0, 1e-20);
		count[way] = lab_log_count(&bench.log, RB_EVENT_COLLISION);
		bench_close(&bench);
	}
	assert_true(count[0] > 10);
	assert_int_equal(count[0], count[1]);
}

/* It goes on sideways: by friction it rolls when the bouncing is over, and is told once. */
static void a_ball_thrown_sideways_ends_in_rolling(void **slot)
{
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;
	struct lab_log log;
	const struct rb_world_hooks hooks = lab_log_open(&log);

	(void)slot;
	lab_open_located(&lab, 6, 10);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.4, 0.7);
	const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.6), at(2, 1, 0));
	lab_plane(&lab, origin, up);
	lab_seal_with(&lab, &options, &hooks);
	lab_run(&lab);
	const rb_vec3 v = rb_world_velocity(lab.world, ball);
	/* whatever the impacts: friction at the point keeps v + 2/5 R w x n */
	assert_vector(v, at(10.0 / 7, 5.0 / 7, 0), 1e-12);
	assert_vector(rb_world_angular_velocity(lab.world, ball), at(-50.0 / 7, 100.0 / 7, 0),
	              1e-11);
	assert_int_equal(lab_log_count(&log, RB_EVENT_ROLL), 1);
	assert_int_equal(lab_log_count(&log, RB_EVENT_MERGE), 1);
	assert_near(lab_log_find(&log, RB_EVENT_ROLL, 0)->time_s, sqrt(1 / g) * 1.7 / 0.3, 1e-9);
	lab_log_close(&log);
	lab_close(&lab);
}

/* Chung & Ooi 2011, test 4: R = 2.5 mm, 3.9 m/s, mu = 0.092, e = 0.98, angle from the normal. */
static void oblique_impacts_follow_the_rigid_limit(void **slot)
{
	static const struct {
		double angle_deg, ratio, spin, rebound_deg;
	} table[] = {
		{10, 0.71428571, 193.49368, 0},         {30, 0.71428571, 557.14286, 0},
		{35, 0.73984856, 581.94527, 3.6577164}, {45, 0.81784, 502.34563, 20.296245},
		{60, 0.89482987, 355.212, 48.15894},    {80, 0.96788028, 123.36383, 78.983071},
		{85, 0.98406307, 61.917531, 84.811551},
	};
	const double mu = 0.092, e = 0.98, radius = 0.0025, speed = 3.9;

	(void)slot;
	for (int k = 0; k < 7; k++) {
		const double a = table[k].angle_deg * pi / 180;
		const double vn = speed * cos(a), vt = speed * sin(a);
		const double slip = mu * (1 + e) * vn;
		const bool sticks = vt <= 3.5 * slip;
		const double after = sticks ? 5.0 / 7 * vt : vt - slip;
		const double spin = sticks ? 5.0 / 7 * vt / radius : 2.5 * slip / radius;
		struct lab lab;

		lab_open_located(&lab, 0.01, 100);
		lab_surface(&lab, mu, e);
		const int ball = lab_sphere(&lab, radius, 1e-4, at(0, 0, 2 * radius),
		                            at(vt, 0, -vn));
		lab_plane(&lab, origin, up);
		lab_seal(&lab, 1);
		lab_run(&lab);
		const rb_vec3 v = rb_world_velocity(lab.world, ball);
		const rb_vec3 w = rb_world_angular_velocity(lab.world, ball);
		assert_vector(v, at(after, 0, e * vn), 1e-12 * speed);
		assert_vector(w, at(0, spin, 0), 1e-12 * speed / radius);
		assert_near(v.x / vt, table[k].ratio, 1e-8);
		assert_near(w.y, table[k].spin, 1e-5);
		assert_near(atan2(v.x - radius * w.y, v.z) * 180 / pi, table[k].rebound_deg, 1e-6);
		lab_close(&lab);
	}
}

/* Equal surface velocities at the point: no friction at all. */
static void gears_do_not_rub(void **slot)
{
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 2, 10);
	lab_surface(&lab, 0.4, 0.5);
	struct rb_body_def def = lab_sphere_def(0.1, 1, at(-0.2, 0, 0), at(0.2, 0, 0));
	def.angular_velocity = at(0, 0, 17.3);
	const int a = lab_add(&lab, &def);
	def.position.x = 0.2;
	def.velocity.x = -0.2;
	def.angular_velocity.z = -17.3;
	const int b = lab_add(&lab, &def);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_int_equal(rb_world_totals(lab.world).collisions, 1);
	assert_vector(rb_world_velocity(lab.world, a), at(-0.1, 0, 0), 1e-16);
	assert_vector(rb_world_velocity(lab.world, b), at(0.1, 0, 0), 1e-16);
	assert_true(rb_world_velocity(lab.world, a).y == 0);
	assert_true(rb_world_angular_velocity(lab.world, a).z == 17.3);
	assert_true(rb_world_angular_velocity(lab.world, b).z == -17.3);
	lab_close(&lab);
}

/* ---- two and three ---- */

static void slow_elastic_hits_exchange_velocities(void **slot)
{
	const double speed[] = {1e4, 1, 1e-3, 1e-6, 1e-12};

	(void)slot;
	for (int k = 0; k < 5; k++) {
		struct lab lab;

		lab_open_located(&lab, 2 / speed[k], speed[k]);
		lab_surface(&lab, 0, 1);
		const int a = lab_sphere(&lab, 0.1, 1, at(-0.7, 0, 0), at(speed[k], 0, 0));
		const int b = lab_sphere(&lab, 0.1, 1, origin, origin);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_near(rb_world_velocity(lab.world, a).x / speed[k], 0, 1e-14);
		assert_near(rb_world_velocity(lab.world, b).x / speed[k], 1, 1e-14);
		assert_near(rb_world_position(lab.world, b).x, 1.5, 1e-14);
		lab_close(&lab);
	}
}

static void a_mass_ratio_of_a_billion_is_exact(void **slot)
{
	(void)slot;
	for (int heavy_moves = 0; heavy_moves < 2; heavy_moves++)
		for (int k = 0; k < 3; k++) {
			const double e = 0.5 * k, M = 1e9, m = 1, v0 = 3;
			struct lab lab;

			lab_open_located(&lab, 1, 10);
			lab_surface(&lab, 0, e);
			const int heavy = lab_sphere(&lab, 1, M, at(-2, 0, 0),
			                             at(heavy_moves ? v0 : 0, 0, 0));
			const int light = lab_sphere(&lab, 0.1, m, origin,
			                             at(heavy_moves ? 0 : -v0, 0, 0));
			lab_seal(&lab, 1);
			const double before = M * rb_world_velocity(lab.world, heavy).x +
			                      m * rb_world_velocity(lab.world, light).x;
			lab_run(&lab);
			const double j = (1 + e) * v0 * (M / (M + m)) * m;
			const double v = rb_world_velocity(lab.world, light).x,
				     V = rb_world_velocity(lab.world, heavy).x;
			assert_near(v, (heavy_moves ? 0 : -v0) + j / m, 1e-14 * v0);
			assert_near(V, (heavy_moves ? v0 : 0) - j / M, 1e-14 * (fabs(V) + j / M));
			assert_near(M * V + m * v, before, 4 * 2.2e-16 * M * v0);
			lab_close(&lab);
		}
}

/* The light one between the heavy one and a wall: floor(pi / atan(sqrt(m / M))) impacts. */
static void galperins_billiard_counts_the_digits_of_pi(void **slot)
{
	static const int wanted[] = {3, 31, 314, 3141, 31415};

	(void)slot;
	for (int k = 0; k <= 4; k++) {
		const double M = pow(100, k), angle = atan(1 / sqrt(M));
		struct lab lab;

		lab_open_located(&lab, 40, 1);
		lab_surface(&lab, 0, 1);
		lab_plane(&lab, origin, at(1, 0, 0));
		const int light = lab_sphere(&lab, 0.1, 1, at(1, 0, 0), origin);
		const int heavy = lab_sphere(&lab, 0.5, M, at(2.5, 0, 0), at(-1, 0, 0));
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_int_equal(rb_world_totals(lab.world).collisions, wanted[k]);
		/* the velocity turns by 2 atan(sqrt(m/M)) at each pair of impacts, in (sqrt(M) V, sqrt(m) v) */
		const int turns = (wanted[k] + 1) / 2;
		assert_near(rb_world_velocity(lab.world, heavy).x, -cos(2 * turns * angle), 1e-9);
		assert_near(fabs(rb_world_velocity(lab.world, light).x),
		            sqrt(M) * fabs(sin(2 * turns * angle)), 1e-9 * sqrt(M));
		lab_close(&lab);
	}
}

/* R = 0.1, x = 0.78 and 0.99, wall at 1.1: contacts at 0.005, 0.010 and 0.015 s. */
static void a_ball_hits_a_ball_before_a_wall(void **slot)
{
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;
	struct lab_log log;
	const struct rb_world_hooks hooks = lab_log_open(&log);

	(void)slot;
	lab_open_located(&lab, 0.02, 50);
	lab_surface(&lab, 0, 1);
	const int a = lab_sphere(&lab, 0.1, 1, at(0.78, 0, 0), at(2, 0, 0));
	const int b = lab_sphere(&lab, 0.1, 1, at(0.99, 0, 0), origin);
	lab_plane(&lab, at(1.1, 0, 0), at(-1, 0, 0));
	lab_seal_with(&lab, &options, &hooks);
	lab_run(&lab);
	assert_int_equal(lab_log_count(&log, RB_EVENT_COLLISION), 3);
	for (int k = 0; k < 3; k++)
		assert_near(log.row[k].time_s, 0.005 * (k + 1), 1e-15);
	assert_int_equal(log.row[1].a, b);
	assert_int_equal(log.row[1].b, 2);
	assert_vector(log.row[0].normal, at(1, 0, 0), 1e-15);
	assert_vector(log.row[0].impulse, at(2, 0, 0), 1e-14);
	assert_near(log.row[0].approach_speed, 2, 1e-14);
	assert_vector(log.row[0].point, at(0.89, 0, 0), 1e-14);
	assert_vector(rb_world_velocity(lab.world, a), at(-2, 0, 0), 1e-14);
	assert_vector(rb_world_velocity(lab.world, b), origin, 1e-14);
	lab_log_close(&log);
	lab_close(&lab);
}

/* Impact parameter 2 R (1 -+ 1e-12). */
static void a_grazing_pass_hits_or_misses_as_it_should(void **slot)
{
	(void)slot;
	for (int misses = 0; misses < 2; misses++) {
		const double b = 2 * (1 + (misses ? 1e-12 : -1e-12));
		struct lab lab;

		lab_open_located(&lab, 10, 1);
		lab_surface(&lab, 0, 1);
		const int a = lab_sphere(&lab, 1, 1, at(-5, b, 0), at(1, 0, 0));
		const int c = lab_sphere(&lab, 1, 1, origin, origin);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_int_equal(rb_world_totals(lab.world).collisions, misses ? 0 : 1);
		if (misses) {
			assert_true(rb_world_velocity(lab.world, a).x == 1);
			assert_true(rb_world_velocity(lab.world, a).y == 0);
		} else {
			/* cos of the normal to the velocity: sqrt(1 - b^2/4) = 1.4e-6, by differences of b to ulp */
			const double cosine = sqrt((1 - b / 2) * (1 + b / 2));
			assert_near(rb_world_velocity(lab.world, c).x, cosine * cosine, 1e-15);
			assert_near(-rb_world_velocity(lab.world, c).y, cosine * b / 2,
			            cosine * 1e-3);
		}
		assert_near(rb_world_totals(lab.world).kinetic_energy, 0.5, 1e-15);
		lab_close(&lab);
	}
}

/* ---- more together ---- */

static void a_cradle_passes_the_ball_on(void **slot)
{
	const double gaps[] = {0, 1e-6, 1e-3};

	(void)slot;
	for (int k = 0; k < 3; k++)
		for (int in = 1; in <= 3; in++) {
			struct lab lab;

			lab_open_located(&lab, 0.5, 50);
			lab_surface(&lab, 0, 1);
			for (int ball = 0; ball < 5; ball++) {
				const bool comes = ball < in;

				lab_sphere(&lab, 0.05, 1,
				           at((0.1 + gaps[k]) * ball - (comes ? 0.2 : 0), 0, 0),
				           at(comes ? 2 : 0, 0, 0));
			}
			lab_seal(&lab, 1);
			lab_run(&lab);
			for (int ball = 0; ball < 5; ball++)
				assert_vector(rb_world_velocity(lab.world, ball),
				              at(ball >= 5 - in ? 2 : 0, 0, 0), 2e-12);
			lab_close(&lab);
		}
}

/* Equal spheres, e = 1: the cue goes back at v0/5, the others at 2 sqrt(3)/5 v0 at +-30 degrees. */
static void a_break_is_symmetric_to_the_bit(void **slot)
{
	static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
	                                {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
	double bits[3][6];

	(void)slot;
	for (int o = 0; o < 6; o++) {
		const rb_vec3 position[3] = {
			{-2, 0, 0}, {0.5 * sqrt(3), 0.5, 0}, {0.5 * sqrt(3), -0.5, 0}};
		const rb_vec3 velocity[3] = {{2, 0, 0}, {0, 0, 0}, {0, 0, 0}};
		struct lab lab;
		int id[3];

		lab_open_located(&lab, 2, 50);
		lab_surface(&lab, 0, 1);
		for (int k = 0; k < 3; k++)
			id[order[o][k]] = lab_sphere(&lab, 0.5, 1, position[order[o][k]],
			                             velocity[order[o][k]]);
		lab_seal(&lab, 1);
		lab_run(&lab);
		for (int k = 0; k < 3; k++) {
			double now[6];

			rb_vec3_to(now, rb_world_position(lab.world, id[k]));
			rb_vec3_to(now + 3, rb_world_velocity(lab.world, id[k]));
			if (o == 0)
				memcpy(bits[k], now, sizeof now);
			for (int m = 0; m < 6; m++)
				assert_true(now[m] == bits[k][m]);
		}
		lab_close(&lab);
	}
	assert_near(bits[0][3], -0.4, 1e-13);
	assert_true(bits[0][4] == 0);
	assert_near(bits[1][3], 2 * 0.6, 1e-13);
	assert_near(bits[1][4], 2 * 0.2 * sqrt(3), 1e-13);
	for (int m = 0; m < 6; m++)
		assert_true(bits[2][m] == (m % 3 == 1 ? -bits[1][m] : bits[1][m]));
}

/* Three on a line, e < 7 - 4 sqrt(3): infinitely many impacts in finite time. */
static void an_inelastic_collapse_ends(void **slot)
{
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;
	struct lab_log log;
	const struct rb_world_hooks hooks = lab_log_open(&log);

	(void)slot;
	lab_open_located(&lab, 5, 20);
	lab_surface(&lab, 0, 0.05);
	lab_sphere(&lab, 0.1, 1, at(-1, 0, 0), at(1, 0, 0));
	lab_sphere(&lab, 0.1, 1, origin, origin);
	lab_sphere(&lab, 0.1, 1, at(1, 0, 0), at(-0.9, 0, 0));
	lab_seal_with(&lab, &options, &hooks);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		assert_near(rb_world_totals(lab.world).momentum.x, 0.1, 1e-14);
		for (int k = 0; k < 2; k++)
			assert_true(rb_world_position(lab.world, k + 1).x -
			                    rb_world_position(lab.world, k).x >=
			            0.2 - 1e-15);
	}
	assert_true(lab_log_count(&log, RB_EVENT_COLLISION) >= 3);
	assert_true(log.count < 10000);
	assert_true(lab_log_count(&log, RB_EVENT_MERGE) >= 1);
	lab_log_close(&log);
	lab_close(&lab);
}

/* 1 mm at 10 km/s through a room: the path unfolds to a straight line. */
static void a_fast_ball_in_a_room_unfolds(void **slot)
{
	const double half = 0.501, speed = 1e4, t = 0.1;
	const rb_vec3 d = {0.6, 0.48, 0.64}; /* of length 1 */
	const double *component = &d.x;
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, t, 60);
	lab_surface(&lab, 0, 1);
	const int ball = lab_sphere(&lab, 1e-3, 1e-6, origin, rb_vec3_scale(speed, d));
	for (int axis = 0; axis < 3; axis++)
		for (int side = -1; side <= 1; side += 2) {
			const rb_vec3 n = {axis == 0 ? side : 0, axis == 1 ? side : 0,
			                   axis == 2 ? side : 0};

			lab_plane(&lab, rb_vec3_scale(-half, n), n);
		}
	lab_seal(&lab, 1);
	lab_run(&lab);
	int hits = 0;
	double place[3];
	for (int axis = 0; axis < 3; axis++) {
		const double way = component[axis] * speed * t +
		                   0.5; /* from one wall, room of 1 m */
		const double folded = fmod(way, 2);

		hits += (int)floor(way);
		place[axis] = (folded < 1 ? folded : 2 - folded) - 0.5;
	}
	assert_int_equal(rb_world_totals(lab.world).collisions, hits);
	assert_vector(rb_world_position(lab.world, ball), rb_vec3_from(place), 1e-8);
	assert_near(rb_vec3_length(rb_world_velocity(lab.world, ball)) / speed, 1, 1e-12);
	lab_close(&lab);
}

/* A sheet without thickness, from every side: hit in time, never passed, never missed. */
static void a_thin_sheet_is_never_passed(void **slot)
{
	const double radius = 1e-3, speed = 1e4;

	(void)slot;
	for (int k = 0; k < 300; k++) {
		const double z = 1 - 2 * (k + 0.5) / 300, angle = 2.399963229728653 * k;
		const rb_vec3 n = {sqrt(1 - z * z) * cos(angle), sqrt(1 - z * z) * sin(angle), z};
		struct lab lab;

		lab_open_located(&lab, 0.01, 100);
		lab_surface(&lab, 0, 1);
		const int ball = lab_sphere(&lab, radius, 1e-3, rb_vec3_scale(-50, n),
		                            rb_vec3_scale(speed, n));
		lab_rectangle(&lab, origin, at(0.6, 0, 0.8), 1, 1);
		const double slope = fabs(n.x * 0.6 + n.z * 0.8);
		lab_seal(&lab, 1);
		lab_run(&lab);
		const rb_vec3 v = rb_world_velocity(lab.world, ball);
		assert_near(rb_vec3_length(v) / speed, 1, 1e-13);
		if (slope > 0.01) { /* else it comes to the rim first */
			/* mirrored: v - 2 (v.m) m, and from the time of touch on that way */
			const double side = n.x * 0.6 + n.z * 0.8;
			const double touch = (50 - radius / slope) / speed;
			const rb_vec3 away = rb_vec3_sub(n,
			                                 rb_vec3_scale(2 * side, at(0.6, 0, 0.8)));
			const rb_vec3 x = rb_vec3_add(rb_vec3_scale(speed * touch - 50, n),
			                              rb_vec3_scale(speed * (0.01 - touch), away));

			assert_int_equal(rb_world_totals(lab.world).collisions, 1);
			assert_vector(v, rb_vec3_scale(speed, away), 1e-12 * speed);
			assert_vector(rb_world_position(lab.world, ball), x, 1e-12 / slope);
		}
		lab_close(&lab);
	}
}

/* What lies where it touches has no energy to begin with, and gets none. */
static void touching_bodies_with_full_restitution_stay(void **slot)
{
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 100, 1);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0, 1);
	for (int k = 0; k < 64; k++)
		lab_sphere(&lab, 0.1, 1,
		           at(0.1 + 0.2 * (k % 4), 0.1 + 0.2 * (k / 4 % 4), 0.1 + 0.2 * (k / 16)),
		           origin);
	for (int side = 0; side < 2; side++) {
		const double place = side ? 0.8 : 0, way = side ? -1 : 1;

		lab_plane(&lab, at(place, 0, 0), at(way, 0, 0));
		lab_plane(&lab, at(0, place, 0), at(0, way, 0));
	}
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).kinetic_energy <= 64 * 1e-20);
	for (int k = 0; k < 64; k++)
		assert_near(rb_world_position(lab.world, k).z, 0.1 + 0.2 * (k / 16), 1e-14);
	lab_close(&lab);
}

/* ---- what is told, and which numbers are taken ---- */

/* Two balls in flight, or a ball and a plane, of materials with restitutions of their own; a short way where nobody is told. */
static void bounce_pair(const int material[2], double restitution, bool plane, bool told)
{
	const double mass[2] = {1, 3};
	const struct rb_world_options options = {.threads = 1, .keep_events = told};
	struct lab lab;
	int id[2];

	lab_open_located(&lab, 1, 1);
	lab_surface(&lab, 0, 0);
	for (int k = 0; k < 3; k++) {
		struct rb_material_def def = rb_material_def_default();

		def.friction = 0;
		def.restitution = 0.1 * k;
		assert_int_equal(rb_scene_add_material(&lab.scene, &def, NULL, &lab.error), RB_OK);
	}
	static const struct rb_contact_pair_def pairs[] = {
		{1, 2, 0, 0.6}, {1, 3, 0, 0.4}, {2, 3, 0, 0.8}};
	for (int k = 0; k < 3; k++)
		assert_int_equal(rb_scene_add_contact_pair(&lab.scene, &pairs[k], &lab.error),
		                 RB_OK);
	for (int k = 0; k < 2; k++) {
		struct rb_body_def def = lab_sphere_def(0.1, mass[k], at(k ? 0.5 : -0.5, 0, 0),
		                                        at(k ? 0 : 2, 0, 0));

		if (plane && k) {
			def = rb_body_def_default();
			def.call = "plane";
			def.shape.kind = RB_SHAPE_PLANE;
			def.orientation = rb_plane_orientation(at(-1, 0, 0), at((double)NAN, 0, 0));
			def.is_static = true;
		}
		def.material = material[k];
		id[k] = lab_add(&lab, &def);
	}
	lab_seal_with(&lab, &options, NULL);
	lab_run(&lab);
	assert_int_equal(rb_world_totals(lab.world).collisions, 1);
	if (plane) {
		assert_vector(rb_world_velocity(lab.world, id[0]), at(-2 * restitution, 0, 0),
		              1e-14);
	} else { /* of 2 m/s: a quarter is the centre's */
		assert_vector(rb_world_velocity(lab.world, id[0]),
		              at(0.5 - 1.5 * restitution, 0, 0), 1e-14);
		assert_vector(rb_world_velocity(lab.world, id[1]),
		              at(0.5 + 0.5 * restitution, 0, 0), 1e-14);
	}
	lab_close(&lab);
}

static void a_pair_has_its_own_restitution_in_either_order(void **slot)
{
	static const double wanted[4][4] = {
		{0}, {0, 0, 0.6, 0.4}, {0, 0.6, 0, 0.8}, {0, 0.4, 0.8, 0}};

	(void)slot;
	for (int a = 1; a < 4; a++)
		for (int b = 1; b < 4; b++)
			for (int way = 0; way < 4 && a != b; way++)
				bounce_pair((const int[2]){a, b}, wanted[a][b], way & 1, way & 2);
}

/* With v^2 > g R it leaves at once where the sheet ends, and falls freely; nowhere does it come back to the edge. */
static void a_ball_flies_off_every_edge_of_a_sheet(void **slot)
{
	const double v = 2, radius = 0.1, end = 0.75, size[2] = {1, 1.6};

	(void)slot;
	for (int way = 0; way < 4; way++) {
		const double sign = way & 1 ? -1 : 1, falls = end - 0.5 * size[way / 2] / v;
		struct lab lab;

		lab_open_located(&lab, end, 1 / end);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0, 0);
		lab_rectangle(&lab, origin, up, size[0], size[1]);
		const int ball = lab_sphere(&lab, radius, 1, at(0, 0, radius),
		                            way / 2 ? at(0, sign * v, 0) : at(sign * v, 0, 0));
		lab_seal(&lab, 1);
		/* the sheet's own axes: width along x, up to a turn about its normal by a half */
		const rb_vec3 along = rb_quat_rotate(
			rb_plane_orientation(up, at((double)NAN, 0, 0)), at(1, 0, 0));
		assert_near(fabs(along.x), 1, 1e-15);
		lab_run(&lab);
		const rb_vec3 p = rb_world_position(lab.world, ball);
		assert_near(way / 2 ? p.y : p.x, sign * v * end, 1e-13);
		assert_near(p.z, radius - 0.5 * g * falls * falls, 1e-12);
		lab_close(&lab);
	}
}

/* A box falls flat on a plane, made before or after it: points lie on both, normals point from the lower id. */
static void an_impact_is_told_from_the_lower_id_at_its_points(void **slot)
{
	(void)slot;
	for (int way = 0; way < 4; way++) {
		const bool box_first = way & 1, located = way & 2;
		struct lab lab;
		struct lab_log log;
		rb_vec3 impulse = origin, mean = origin;

		lab_open_located(&lab, 0.5, 10);
		if (!located)
			lab.scene.world.method = RB_METHOD_STEPPED;
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0.5, 0);
		struct rb_body_def def = lab_sphere_def(0, 2, at(2, 3, 0.3), origin);
		def.call = "box";
		def.shape.kind = RB_SHAPE_BOX;
		rb_vec3_to(def.shape.size, at(1, 0.4, 0.2));
		if (box_first)
			lab_add(&lab, &def);
		lab_plane(&lab, origin, up);
		if (!box_first)
			lab_add(&lab, &def);
		const struct rb_world_hooks hooks = lab_log_open(&log);
		const struct rb_world_options options = {.threads = 1, .keep_events = true};
		lab_seal_with(&lab, &options, &hooks);
		lab_run(&lab);
		const double sign = box_first ? -1 : 1;
		double whole = 0;
		assert_true(log.count > 0);
		for (int k = 0; k < log.count; k++) {
			const struct rb_event *e = &log.row[k];

			if (e->kind != RB_EVENT_COLLISION)
				continue;
			assert_true(e->a == 0 && e->b == 1);
			assert_vector(e->normal, at(0, 0, sign), 1e-14);
			assert_true(sign * e->impulse.z > 0);
			assert_true(fabs(e->point.x - 2) <= 0.5 + 1e-9);
			assert_true(fabs(e->point.y - 3) <= 0.2 + 1e-9);
			assert_near(e->point.z, 0, located ? 1e-12 : 1e-3);
			impulse = rb_vec3_add(impulse, e->impulse);
			mean = rb_vec3_add_scaled(mean, sign * e->impulse.z, e->point);
			whole += sign * e->impulse.z;
		}
		/* the whole momentum of a fall by 0.2 m; steps add a step's weight or take it */
		assert_near(whole, 2 * sqrt(2 * g * 0.2), located ? 1e-12 : 0.1 * whole);
		assert_near(mean.x / whole, 2, 1e-6);
		assert_near(mean.y / whole, 3, 1e-6);
		lab_log_close(&log);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_thousand_elastic_bounces_keep_energy_and_phase),
		cmocka_unit_test(a_bouncing_ball_rests_in_time),
		cmocka_unit_test(a_hop_from_a_touch_lasts_as_long_as_its_speed),
		cmocka_unit_test(a_ball_bounces_as_often_whoever_is_named_first),
		cmocka_unit_test(a_ball_thrown_sideways_ends_in_rolling),
		cmocka_unit_test(oblique_impacts_follow_the_rigid_limit),
		cmocka_unit_test(gears_do_not_rub),
		cmocka_unit_test(slow_elastic_hits_exchange_velocities),
		cmocka_unit_test(a_mass_ratio_of_a_billion_is_exact),
		cmocka_unit_test(galperins_billiard_counts_the_digits_of_pi),
		cmocka_unit_test(a_ball_hits_a_ball_before_a_wall),
		cmocka_unit_test(a_grazing_pass_hits_or_misses_as_it_should),
		cmocka_unit_test(a_cradle_passes_the_ball_on),
		cmocka_unit_test(a_break_is_symmetric_to_the_bit),
		cmocka_unit_test(an_inelastic_collapse_ends),
		cmocka_unit_test(a_fast_ball_in_a_room_unfolds),
		cmocka_unit_test(a_thin_sheet_is_never_passed),
		cmocka_unit_test(touching_bodies_with_full_restitution_stay),
		cmocka_unit_test(a_pair_has_its_own_restitution_in_either_order),
		cmocka_unit_test(a_ball_flies_off_every_edge_of_a_sheet),
		cmocka_unit_test(an_impact_is_told_from_the_lower_id_at_its_points),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
