/* SPDX-License-Identifier: MIT */
/* src/step: the classic method against closed forms, and its promises. tests/test_located_*.c: the located one. */
#include "sanitized.h"
#include "worlds.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const rb_vec3 earth = {0, 0, -9.81};

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

/* What this file is about, whatever the default is. */
static void open_classic(struct lab *lab, double duration, double frame_rate)
{
	lab_open(lab, duration, frame_rate);
	lab->scene.world.method = RB_METHOD_CLASSIC;
}

/* origin.md, row "from (-5, 2.5, 0) m at (3, 0, -1) m/s for 2 s" */
static void free_motion_is_uniform(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 2, 60);
	const int ball = lab_sphere(&lab, 0.1, 1, at(-5, 2.5, 0), at(3, 0, -1));
	lab_seal(&lab, 1);
	lab_run(&lab);
	const rb_vec3 p = rb_world_position(lab.world, ball);
	assert_near(p.x, 1, 1e-12);
	assert_near(p.y, 2.5, 1e-12);
	assert_near(p.z, -2, 1e-12);
	lab_close(&lab);
}

/* Semi-implicit Euler falls by g t (t + dt) / 2: the error halves with the step. */
static double fall_error(double time_step)
{
	struct lab lab;

	open_classic(&lab, 1, 10);
	lab.scene.world.gravity = earth;
	lab.scene.world.time_step_s = time_step;
	const int ball = lab_sphere(&lab, 0.1, 1, origin, origin);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const double error = rb_world_position(lab.world, ball).z + 0.5 * 9.81;
	lab_close(&lab);
	return error;
}

static void the_error_of_free_fall_halves_with_the_step(void **slot)
{
	(void)slot;
	const double coarse = fall_error(0.01), fine = fall_error(0.005);

	assert_near(coarse, -0.5 * 9.81 * 0.01, 1e-9);
	assert_near(coarse / fine, 2, 1e-6);
}

/* Apex after the first bounce of a drop by h: e^2 h above the floor. */
static double apex_error(double time_step)
{
	struct lab lab;
	double apex = 0;

	open_classic(&lab, 1.1, 1000);
	lab.scene.world.gravity = earth;
	lab.scene.world.time_step_s = time_step;
	lab_surface(&lab, 0, 0.8);
	const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 1.1), origin);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		if (rb_world_time(lab.world) > 0.46) /* first impact at 0.4515 s */
			apex = fmax(apex, rb_world_position(lab.world, ball).z - 0.1);
	}
	lab_close(&lab);
	return apex - 0.64;
}

static void the_error_of_a_bounce_shrinks_with_the_step(void **slot)
{
	(void)slot;
	const double coarse = fabs(apex_error(1e-3)), fine = fabs(apex_error(2.5e-4));

	assert_true(coarse < 0.64 * 9.81 * 1e-3 * 4);
	assert_true(fine < 0.35 * coarse);
}

/* origin.md: 19 kg, 2.5 cm sphere at (-1, -2) m/s, mu = 0.25, e = 1: leaves at (-5/7, 2), spinning at 28.571 rad/s */
static void an_oblique_impact_sticks_and_spins(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 0.1, 100);
	lab_surface(&lab, 0.25, 1);
	const int ball = lab_sphere(&lab, 0.025, 19, at(0, 0, 0.1), at(-1, 0, -2));
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const rb_vec3 v = rb_world_velocity(lab.world, ball),
		      w = rb_world_angular_velocity(lab.world, ball);
	assert_near(v.x, -5.0 / 7, 1e-12);
	assert_near(v.y, 0, 1e-15);
	assert_near(v.z, 2, 1e-12);
	assert_near(fabs(w.y), 28.571428571428573, 1e-9);
	assert_near(w.x, 0, 1e-12);
	assert_near(w.z, 0, 1e-12);
	assert_int_equal(rb_world_totals(lab.world).collisions, 1);
	lab_close(&lab);
}

/* origin.md: B 18 kg at 2 m/s into A 2 kg at -1 m/s, e = 1: 1.4 and 4.4 m/s */
static void a_head_on_impact_exchanges_momentum(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 1, 50);
	lab_surface(&lab, 0, 1);
	const int a = lab_sphere(&lab, 0.1, 2, at(1, 0, 0), at(-1, 0, 0));
	const int b = lab_sphere(&lab, 0.1, 18, at(-1, 0, 0), at(2, 0, 0));
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_velocity(lab.world, a).x, 4.4, 1e-13);
	assert_near(rb_world_velocity(lab.world, b).x, 1.4, 1e-13);
	lab_close(&lab);
}

/* origin.md: touching, moving apart: nothing happens, 60 J before and after */
static void separating_bodies_are_left_alone(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 0.5, 50);
	lab_surface(&lab, 0.3, 1);
	lab_sphere(&lab, 5, 18, at(0, 5, 0), at(-2, 0, -1));
	lab_sphere(&lab, 2.5, 3, at(5 * sqrt(2), 2.5, 0), at(1, 0, 3));
	lab_seal(&lab, 1);
	assert_near(rb_world_totals(lab.world).kinetic_energy, 60, 1e-12);
	lab_run(&lab);
	assert_near(rb_world_totals(lab.world).kinetic_energy, 60, 1e-12);
	assert_int_equal(rb_world_totals(lab.world).collisions, 0);
	lab_close(&lab);
}

/* A ball at rest on a plane stays: with e = 1 too, it must not bounce on g dt. */
static void a_resting_ball_rests(void **slot)
{
	(void)slot;
	for (int e = 0; e <= 1; e++) {
		struct lab lab;

		open_classic(&lab, 10, 60);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, 0.5, e);
		const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.1), origin);
		lab_plane(&lab, origin, up);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_near(rb_world_position(lab.world, ball).z, 0.1, 1e-15);
		assert_true(rb_world_totals(lab.world).kinetic_energy <= 1e-20);
		assert_int_equal(rb_world_totals(lab.world).collisions, 0);
		assert_int_equal(rb_world_totals(lab.world).contacts, 1);
		lab_close(&lab);
	}
}

/* origin.md: a ball dropped on a resting one must not lose energy by the order of processing. */
static void a_ball_dropped_on_a_resting_one_keeps_the_energy(void **slot)
{
	(void)slot;
	for (int order = 0; order < 2; order++) {
		struct lab lab;
		int low, high;

		open_classic(&lab, 0.8, 60);
		lab.scene.world.gravity = earth;
		lab.scene.world.time_step_s = 1e-3;
		lab_surface(&lab, 0, 1);
		if (order == 0)
			lab_plane(&lab, origin, up);
		high = order == 0 ? lab_sphere(&lab, 0.1, 1, at(0, 0, 1.3), origin) : -1;
		low = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.1), origin);
		if (order == 1) {
			high = lab_sphere(&lab, 0.1, 1, at(0, 0, 1.3), origin);
			lab_plane(&lab, origin, up);
		}
		lab_seal(&lab, 1);
		const struct rb_frame_numbers start = rb_world_totals(lab.world);
		lab_run(&lab);
		const struct rb_frame_numbers end = rb_world_totals(lab.world);
		/* fall of 1 m takes 0.45 s; the impact loses nothing, the method g dt / 2 of speed at most */
		const double bound = 4 * 9.81 * 1e-3 * sqrt(2 * 9.81);
		assert_near(end.kinetic_energy + end.potential_energy,
		            start.kinetic_energy + start.potential_energy, bound);
		assert_near(rb_world_position(lab.world, low).z, 0.1, 1e-6);
		assert_true(rb_world_velocity(lab.world, high).z > 0);
		lab_close(&lab);
	}
}

/* A sliding solid sphere rolls after 2 v0 / (7 mu g) at 5/7 v0 and goes on so. */
static double rolling_error(double time_step)
{
	struct lab lab;

	open_classic(&lab, 1, 50);
	lab.scene.world.gravity = earth;
	lab.scene.world.time_step_s = time_step;
	lab_surface(&lab, 0.3, 0);
	const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.1), at(2, 0, 0));
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const double v = rb_world_velocity(lab.world, ball).x;
	assert_near(v, 10.0 / 7, 1e-9);
	assert_near(rb_world_angular_velocity(lab.world, ball).y, v / 0.1, 1e-8);
	const double t = 2 * 2 / (7 * 0.3 * 9.81);
	const double exact = 2 * t - 0.5 * 0.3 * 9.81 * t * t + (1 - t) * 10 / 7;
	const double error = rb_world_position(lab.world, ball).x - exact;
	lab_close(&lab);
	return error;
}

static void sliding_turns_into_rolling(void **slot)
{
	(void)slot;
	const double coarse = fabs(rolling_error(4e-3)), fine = fabs(rolling_error(1e-3));

	assert_true(coarse <= 4e-3 * 2);
	assert_true(fine <= 0.4 * coarse);
}

/* mu >= 2/7 tan: a = 5/7 g sin; else g (sin - mu cos). */
static void a_ball_rolls_or_slides_down_a_slope(void **slot)
{
	const double angle = 0.5;
	const double friction[2] = {0.4, 0.05};

	(void)slot;
	for (int k = 0; k < 2; k++) {
		struct lab lab;
		const rb_vec3 normal = {sin(angle), 0, cos(angle)};

		open_classic(&lab, 1, 50);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, friction[k], 0);
		const int ball = lab_sphere(&lab, 0.1, 1, at(0.1 * normal.x, 0, 0.1 * normal.z),
		                            origin);
		lab_plane(&lab, origin, normal);
		lab_seal(&lab, 1);
		lab_run(&lab);
		const rb_vec3 v = rb_world_velocity(lab.world, ball);
		const double speed = k == 0 ? 5.0 / 7 * 9.81 * sin(angle)
		                            : 9.81 * (sin(angle) - 0.05 * cos(angle));
		assert_near(v.x, speed * cos(angle), 1e-6);
		assert_near(v.z, -speed * sin(angle), 1e-6);
		assert_near(v.y, 0, 1e-12);
		lab_close(&lab);
	}
}

/* A touching row passes the impact on. */
static void a_touching_row_passes_the_impact_on(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 0.5, 50);
	lab_surface(&lab, 0, 1);
	const int first = lab_sphere(&lab, 0.5, 1, at(-2, 0, 0), at(4, 0, 0));
	for (int k = 0; k < 4; k++)
		lab_sphere(&lab, 0.5, 1, at(k, 0, 0), origin);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_velocity(lab.world, first).x, 0, 1e-13);
	for (int k = 1; k <= 3; k++)
		assert_near(rb_world_velocity(lab.world, k).x, 0, 1e-13);
	assert_near(rb_world_velocity(lab.world, 4).x, 4, 1e-12);
	lab_close(&lab);
}

/* Equal spheres, e = 1: cue -v0/5, targets 2 sqrt(3)/5 v0 at +-30 degrees. */
static void a_symmetric_break_stays_symmetric(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 1, 50);
	lab_surface(&lab, 0, 1);
	const int cue = lab_sphere(&lab, 0.5, 1, at(-2, 0, 0), at(2, 0, 0));
	const int left = lab_sphere(&lab, 0.5, 1, at(0.5 * sqrt(3), 0.5, 0), origin);
	const int right = lab_sphere(&lab, 0.5, 1, at(0.5 * sqrt(3), -0.5, 0), origin);
	lab_seal(&lab, 1);
	lab_run(&lab);
	/* the contact is found within the tolerance of 5e-7 m: its angle is off by as much */
	assert_near(rb_world_velocity(lab.world, cue).x, -0.4, 1e-5);
	assert_near(rb_world_velocity(lab.world, left).x, 1.2, 1e-5);
	assert_near(rb_world_velocity(lab.world, left).y, 2 * 0.2 * sqrt(3), 1e-5);
	assert_near(rb_world_velocity(lab.world, right).y, -rb_world_velocity(lab.world, left).y,
	            1e-12);
	lab_close(&lab);
}

/* No time step lets a fast body through, not even a sheet without thickness. */
static void nothing_tunnels(void **slot)
{
	(void)slot;
	for (int kind = 0; kind < 3; kind++) {
		struct lab lab;

		open_classic(&lab, 0.1, 10);
		lab_surface(&lab, 0, 1);
		const int bullet = lab_sphere(&lab, 1e-3, 1e-3, at(-50, 2e-4, 1e-4), at(1e4, 0, 0));
		if (kind == 0)
			lab_rectangle(&lab, origin, at(-1, 0, 0), 1, 1);
		else if (kind == 1)
			lab_plane(&lab, origin, at(-1, 0, 0));
		else
			lab_sphere(&lab, 1e-3, 1e9, origin, origin);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_true(rb_world_velocity(lab.world, bullet).x < 0);
		assert_near(rb_vec3_length(rb_world_velocity(lab.world, bullet)), 1e4, 1e-6);
		lab_close(&lab);
	}
}

/* A ball rolls over the rim of a finite plane and falls. */
static void a_ball_falls_off_an_edge(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 2, 60);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.5, 0);
	const int ball = lab_sphere(&lab, 0.1, 1, at(0, 0, 0.1), at(1, 0, 0));
	lab_rectangle(&lab, origin, up, 2, 2);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_position(lab.world, ball).x > 1);
	assert_true(rb_world_position(lab.world, ball).z < -1);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	lab_close(&lab);
}

static void fill_box(struct lab *lab, int n, double spacing, double radius)
{
	const double half = 0.5 * n * spacing;

	for (int k = 0; k < n * n * n; k++) {
		const double x = (k % n + 0.5) * spacing - half,
			     y = (k / n % n + 0.5) * spacing - half;
		const double z = (k / n / n + 0.5) * spacing;
		const rb_vec3 v = {sin(1.0 + k), cos(2.0 * k), sin(3.0 * k + 1)};

		lab_sphere(lab, radius, 1, at(x, y, z), v);
	}
	lab_plane(lab, at(-half, 0, 0), at(1, 0, 0));
	lab_plane(lab, at(half, 0, 0), at(-1, 0, 0));
	lab_plane(lab, at(0, -half, 0), at(0, 1, 0));
	lab_plane(lab, at(0, half, 0), at(0, -1, 0));
	lab_plane(lab, origin, up);
	lab_plane(lab, at(0, 0, 2 * half), at(0, 0, -1));
}

static void a_gas_keeps_energy_and_tolerance(void **slot)
{
	(void)slot;
	for (int kind = 0; kind <= 1; kind++) {
		struct lab lab;

		open_classic(&lab, 5, 60);
		lab_surface(&lab, 0, 1);
		lab.scene.world.rollback = kind == 0 ? RB_ROLLBACK_SELECTIVE : RB_ROLLBACK_GLOBAL;
		fill_box(&lab, 4, 0.3, 0.05);
		lab_seal(&lab, 1);
		const double before = rb_world_totals(lab.world).kinetic_energy;
		lab_run(&lab);
		const struct rb_frame_numbers end = rb_world_totals(lab.world);
		assert_near(end.kinetic_energy / before, 1, 1e-12);
		assert_true(end.max_penetration <= lab.model->tolerance_m);
		assert_true(end.collisions > 100);
		lab_close(&lab);
	}
}

static uint64_t heap_hash(int threads, double restitution)
{
	struct lab lab;

	open_classic(&lab, tried(1.5, 1.5, 0.5), 60);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.4, restitution);
	fill_box(&lab, 3, 0.25, 0.1);
	lab_seal(&lab, threads);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	const uint64_t hash = rb_world_hash(lab.world);
	lab_close(&lab);
	return hash;
}

static void any_number_of_threads_gives_the_same_bits(void **slot)
{
	static const int threads[] = {3, 1, 2, 8};

	(void)slot;
	const uint64_t one = compares_threads ? heap_hash(1, 0.3) : 0;

	for (int k = 0; k < tried(4, 2, 1); k++) {
		const uint64_t hash = heap_hash(threads[k], 0.3);

		assert_true(!compares_threads || hash == one);
	}
	assert_true(!compares_threads || heap_hash(1, 0.4) != one);
}

/* A body off its centre of mass hits the floor: its first impact may not raise energy. */
static void an_eccentric_impact_never_raises_energy(void **slot)
{
	(void)slot;
	for (int k = 0; k < 100; k++) {
		struct lab lab;
		const double e = 0.1 + (k % 10) / 10.0, mu = 0.1 * (k % 17);

		open_classic(&lab, 0.2, 200);
		lab_surface(&lab, mu, fmin(e, 1));
		struct rb_body_def def = lab_sphere_def(0.1, 1, at(0, 0, 0.15),
		                                        at(sin(k), cos(3.0 * k), -1 - k % 5));
		def.center_of_mass = at(0.08 * sin(5.0 * k), 0.08 * cos(7.0 * k), 0.03);
		def.angular_velocity = at(20 * sin(2.0 * k), 10 * cos(k), 5);
		const int ball = lab_add(&lab, &def);
		lab_plane(&lab, origin, up);
		lab_seal(&lab, 1);
		const double energy = rb_world_kinetic_energy(lab.world, ball);
		while (rb_world_totals(lab.world).collisions == 0)
			lab_step(&lab);
		assert_true(rb_world_kinetic_energy(lab.world, ball) <= energy * (1 + 1e-12));
		assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
		lab_close(&lab);
	}
}

/* A strong force hardly reaches its speed within a step; a lone ball's impact is an impact all the same. */
static void a_lone_ball_pushed_hard_bounces(void **slot)
{
	struct lab lab;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	open_classic(&lab, 0.1, 60);
	lab_surface(&lab, 0, 0.5);
	lab_sphere(&lab, 0.05, 1, at(0, 0, 0.1), origin);
	force.vector = at(0, 0, -1e4);
	assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).collisions >= 2);
	lab_close(&lab);
}

/* Slow company keeps the boxes small: what an impact throws out of its box must still be found. */
static void a_body_thrown_by_an_impact_meets_the_next(void **slot)
{
	(void)slot;
	for (int kind = 0; kind <= 1; kind++) {
		struct lab lab;

		open_classic(&lab, 0.1, 60);
		lab_surface(&lab, 0, 1);
		lab.scene.world.rollback = kind == 0 ? RB_ROLLBACK_SELECTIVE : RB_ROLLBACK_GLOBAL;
		lab_sphere(&lab, 0.1, 1, at(-2, 0, 0), at(1000, 0, 0));
		const int thrown = lab_sphere(&lab, 0.1, 1, origin, origin);
		const int met = lab_sphere(&lab, 0.1, 1, at(1.2, 0, 0), origin);
		for (int k = 0; k < 300; k++)
			lab_sphere(&lab, 0.1, 1, at(k, 50, 0), origin);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_near(rb_world_velocity(lab.world, met).x, 1000, 1e-9);
		assert_near(rb_world_velocity(lab.world, thrown).x, 0, 1e-9);
		assert_int_equal(rb_world_totals(lab.world).collisions, 2);
		lab_close(&lab);
	}
}

static void an_overlap_within_the_tolerance_gives_no_energy(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 1, 60);
	lab.scene.world.tolerance_m = 1e-3;
	lab_surface(&lab, 0, 1);
	lab_sphere(&lab, 0.1, 1, origin, origin);
	lab_sphere(&lab, 0.1, 1, at(0.2 - 0.99e-3, 0, 0), origin);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_totals(lab.world).kinetic_energy, 0, 1e-20);
	lab_close(&lab);
}

/* A whole turn a step ends where it began: the straight path of the middle shows nothing. */
static void an_eccentric_body_in_whole_turns_still_hits(void **slot)
{
	struct lab lab;

	(void)slot;
	open_classic(&lab, 0.1, 240);
	lab.scene.world.time_step_s = 1.0 / 240;
	lab_surface(&lab, 0, 1);
	struct rb_body_def def = lab_sphere_def(0.1, 1, origin, origin);
	def.center_of_mass = at(-0.05, 0, 0);
	def.angular_velocity = at(0, 0, 2 * 3.14159265358979 * 240);
	lab_add(&lab, &def);
	lab_plane(&lab, at(-0.13, 0, 0), at(1, 0, 0));
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).collisions > 0);
	lab_close(&lab);
}

static bool hit(void *user)
{
	(void)user;
	return true;
}

static void a_stop_ends_the_run_at_a_frame(void **slot)
{
	struct lab lab;
	const struct rb_world_options options = {.threads = 1, .stop = hit};

	(void)slot;
	open_classic(&lab, 1, 10);
	lab_sphere(&lab, 0.1, 1, origin, at(1, 0, 0));
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	assert_int_equal(rb_world_create(&lab.world, lab.model, &options, NULL, &lab.error), RB_OK);
	lab_step(&lab);
	assert_true(rb_world_stopped(lab.world));
	assert_int_equal(rb_world_frame(lab.world), 1);
	lab_close(&lab);
}

/* A sphere squeezed between converging walls by a force that nothing can carry without overlap. */
static void what_cannot_be_resolved_is_said_with_names(void **slot)
{
	struct lab lab;
	enum rb_status status = RB_OK;

	(void)slot;
	open_classic(&lab, 10, 10);
	lab_surface(&lab, 0, 0);
	struct rb_body_def def = lab_sphere_def(0.1, 1, at(0, 0, 0.11), at(0, 0, 1e100));
	def.name = "runaway";
	lab_add(&lab, &def);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	while (status == RB_OK && rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		rb_world_apply_impulse(lab.world, 0, at(0, 0, 1e308), origin);
		status = rb_world_step_frame(lab.world, &lab.error);
	}
	assert_int_equal(status, RB_ERR_PHYSICS);
	assert_non_null(strstr(lab.error.text, "'runaway'"));
	lab_close(&lab);
}

/* Force with a start and a duration: the impulse is F times the time it acts, wherever the steps fall. */
static void a_timed_force_gives_its_whole_impulse(void **slot)
{
	struct lab lab;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	open_classic(&lab, 1, 10);
	const int ball = lab_sphere(&lab, 0.1, 2, origin, origin);
	force.vector = at(3, 0, 0);
	force.start_s = 0.1234;
	force.duration_s = 0.5;
	assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_velocity(lab.world, ball).x, 0.75, 1e-14);
	lab_close(&lab);
}

/* origin.md: 27.6 N at the rim of a 2.5 cm sphere: 0.69 N m */
static void a_force_off_the_centre_turns_the_body(void **slot)
{
	struct lab lab;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	open_classic(&lab, 1e-3, 1e4);
	const int ball = lab_sphere(&lab, 0.025, 19, origin, origin);
	force.vector = at(27.6, 0, 0);
	force.point = at(0, 0.025, 0);
	force.duration_s = 1e-3;
	assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const double inertia = 0.4 * 19 * 0.025 * 0.025;
	assert_near(rb_world_angular_velocity(lab.world, ball).z, -0.69 * 1e-3 / inertia, 1e-4);
	lab_close(&lab);
}

/* A ball of a million kg against one of 1 kg at a wall: 3,141 impacts in turn are more than are followed. It is told once. */
static void a_cluster_that_is_ended_is_told(void **slot)
{
	(void)slot;
	for (int heavy = 0; heavy < 2; heavy++) {
		struct lab lab;

		open_classic(&lab, 0.2, 100);
		lab.scene.world.gravity = origin;
		lab_surface(&lab, 0, 1);
		lab_plane(&lab, origin, at(1, 0, 0));
		lab_sphere(&lab, 0.5, 1, at(0.5, 0, 0), origin);
		lab_sphere(&lab, 0.5, heavy ? 1e6 : 1, at(1.6, 0, 0), at(-1, 0, 0));
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_int_equal(rb_world_work(lab.world).plastic_ends, heavy);
		lab_close(&lab);
	}
}

/* Scene and body turned as one, with the force in either frame: the answer is turned, too. Steps, and the exact method. */
static void a_force_at_a_point_follows_the_body(void **slot)
{
	static const enum rb_method_kind methods[] = {RB_METHOD_CLASSIC, RB_METHOD_STEPPED,
	                                              RB_METHOD_LOCATED};
	const rb_vec3 newton = {3, -1, 2}, point = {0.1, 0.4, -0.2};
	const double h = 1e-4;

	(void)slot;
	for (int k = 0; k < 12; k++) {
		const rb_quat turn = rb_quat_from_turn(k < 6 ? at(1.2, -0.7, 2) : at(-2, 0.3, 0.4));
		struct rb_body_def def = lab_sphere_def(0.5, 2, at(0.3, 0.2, 0.1), origin);
		struct rb_force_def force = rb_force_def_default();
		struct lab lab;

		lab_open(&lab, h, 1 / h);
		lab.scene.world.time_step_s = h;
		lab.scene.world.method = methods[k % 3];
		lab.scene.world.gravity = origin;
		def.orientation = turn;
		const int ball = lab_add(&lab, &def);
		force.frame = k / 3 % 2 ? RB_FORCE_BODY : RB_FORCE_WORLD;
		force.vector = k / 3 % 2 ? newton : rb_quat_rotate(turn, newton);
		force.point = point;
		assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
		lab_seal(&lab, 1);
		lab_run(&lab);
		/* within the step it turns by half of spin h, 1e-5 rad */
		const double inertia = 0.4 * 2 * 0.5 * 0.5;
		const rb_vec3 spin = rb_vec3_scale(h / inertia, rb_vec3_cross(point, newton));
		assert_vector(rb_world_angular_velocity(lab.world, ball),
		              rb_quat_rotate(turn, spin), 1e-5 * rb_vec3_length(spin));
		assert_vector(rb_world_velocity(lab.world, ball),
		              rb_quat_rotate(turn, rb_vec3_scale(h / 2, newton)),
		              1e-5 * h * rb_vec3_length(newton));
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(free_motion_is_uniform),
		cmocka_unit_test(the_error_of_free_fall_halves_with_the_step),
		cmocka_unit_test(the_error_of_a_bounce_shrinks_with_the_step),
		cmocka_unit_test(an_oblique_impact_sticks_and_spins),
		cmocka_unit_test(a_head_on_impact_exchanges_momentum),
		cmocka_unit_test(separating_bodies_are_left_alone),
		cmocka_unit_test(a_resting_ball_rests),
		cmocka_unit_test(a_ball_dropped_on_a_resting_one_keeps_the_energy),
		cmocka_unit_test(sliding_turns_into_rolling),
		cmocka_unit_test(a_ball_rolls_or_slides_down_a_slope),
		cmocka_unit_test(a_touching_row_passes_the_impact_on),
		cmocka_unit_test(a_symmetric_break_stays_symmetric),
		cmocka_unit_test(nothing_tunnels),
		cmocka_unit_test(a_ball_falls_off_an_edge),
		cmocka_unit_test(a_gas_keeps_energy_and_tolerance),
		cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
		cmocka_unit_test(an_eccentric_impact_never_raises_energy),
		cmocka_unit_test(a_lone_ball_pushed_hard_bounces),
		cmocka_unit_test(a_body_thrown_by_an_impact_meets_the_next),
		cmocka_unit_test(an_overlap_within_the_tolerance_gives_no_energy),
		cmocka_unit_test(an_eccentric_body_in_whole_turns_still_hits),
		cmocka_unit_test(a_stop_ends_the_run_at_a_frame),
		cmocka_unit_test(what_cannot_be_resolved_is_said_with_names),
		cmocka_unit_test(a_timed_force_gives_its_whole_impulse),
		cmocka_unit_test(a_force_off_the_centre_turns_the_body),
		cmocka_unit_test(a_force_at_a_point_follows_the_body),
		cmocka_unit_test(a_cluster_that_is_ended_is_told),
	};

	return run_tests_of_threads(tests, "threads");
}
