/* SPDX-License-Identifier: MIT */
/* src/stepped: one step of dense groups, from the outside. */
#include "patience.h"
#include "sanitized.h"
#include "solids.h"
#include "worlds.h"

#include "base/pack.h"
#include "method/save.h"
#include "world/world.h"

static const double g = 9.81;

static void open_stepped(struct lab *lab, double duration, double frame_rate, double time_step)
{
	lab_open(lab, duration, frame_rate);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = time_step;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
}

static int add_cube(struct lab *lab, double mass, rb_vec3 position)
{
	return lab_box(lab, (rb_vec3){1, 1, 1}, mass, position, (rb_quat){1, 0, 0, 0});
}

/* ---- one body ---- */

static void free_fall_is_exact_for_any_step(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 1, 10, 0.1);
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 100}, (rb_vec3){3, 0, 4});
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_vector(rb_world_position(lab.world, ball), ((rb_vec3){3, 0, 104 - 0.5 * g}), 1e-12);
	lab_close(&lab);
}

/*
 * A ball and a cube fall past what they do not meet, and past each other: near is a matter of boxes
 * along the axes, and decides nothing.
 */
static void what_is_near_and_is_not_met_changes_no_fall(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 0.5, 10, 0.05);
	lab_plane(&lab, (rb_vec3){0.30625, 0, 0}, (rb_vec3){-1, 0, 0});
	const int ball = lab_sphere(&lab, 0.25, 1, (rb_vec3){0, 0, 10}, (rb_vec3){0, 0, 2});
	const int cube = add_cube(&lab, 2, (rb_vec3){-0.78, 0, 10});
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_vector(rb_world_position(lab.world, ball), ((rb_vec3){0, 0, 11 - 0.125 * g}), 1e-12);
	assert_vector(rb_world_position(lab.world, cube), ((rb_vec3){-0.78, 0, 10 - 0.125 * g}),
	              1e-12);
	lab_close(&lab);
}

/*
 * A large ball hits a wall. It blocks the way of a small one below it, and not that of the one that
 * it would have met without the wall: that falls on a parabola, whichever of the two comes first.
 */
static void what_is_pushed_blocks_where_it_is_only(void **state)
{
	const double h = 0.05, slope = sqrt(0.5);

	(void)state;
	for (int order = 0; order < 2; order++) {
		struct lab lab;
		int beside = 0;

		open_stepped(&lab, h, 1 / h, h);
		lab_surface(&lab, 0, 0);
		lab_plane(&lab, (rb_vec3){1 + 1e-4, 0, 0}, (rb_vec3){-1, 0, 0});
		lab_sphere(&lab, 1, 100, (rb_vec3){0, 0, 0}, (rb_vec3){1, 0, 0});
		for (int k = 0; k < 2; k++)
			if (k == order)
				lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, -1.105},
				           (rb_vec3){0, 0.5, 0});
			else
				beside = lab_sphere(&lab, 0.1, 1,
				                    (rb_vec3){1.11 * slope, 0, 1.11 * slope},
				                    (rb_vec3){0, 0.5, 0});
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_vector(rb_world_position(lab.world, beside),
		              ((rb_vec3){1.11 * slope, 0.5 * h, 1.11 * slope - 0.5 * g * h * h}),
		              1e-12);
		lab_close(&lab);
	}
}

/* Height of the first apex after a drop from 1 m with e = 0.8 */
static double apex(double time_step)
{
	struct lab lab;
	double top = 0;

	open_stepped(&lab, 0.9, 1000, time_step);
	lab_surface(&lab, 0, 0.8);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 1.1}, (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		if (rb_world_time(lab.world) > 0.5)
			top = fmax(top, rb_world_position(lab.world, ball).z - 0.1);
	}
	lab_close(&lab);
	return top;
}

static void the_error_of_a_bounce_is_bounded_by_the_step(void **state)
{
	(void)state;
	/* the impact is up to a step late or early: v g h of energy per mass, and e^2 of it in the apex */
	const double speed = sqrt(2 * g);

	for (double h = 1e-3; h > 1e-5; h *= 0.25)
		assert_near(apex(h), 0.64, 2 * speed * h);
}

static void a_ball_at_rest_with_restitution_rests(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 1, 60, 1.0 / 240);
	lab_surface(&lab, 0.5, 1);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	const int ball = lab_sphere(&lab, 0.5, 1, (rb_vec3){0, 0, 0.5}, (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_near(rb_world_position(lab.world, ball).z, 0.5, 1e-12);
	assert_near(rb_world_kinetic_energy(lab.world, ball), 0, 1e-20);
	lab_close(&lab);
}

static void sliding_turns_into_rolling(void **state)
{
	(void)state;
	for (int k = 0; k < 3; k++) {
		struct lab lab;

		open_stepped(&lab, 1, 60, 1.0 / (240 << k));
		lab_surface(&lab, 0.3, 0);
		lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const int ball = lab_sphere(&lab, 0.5, 2, (rb_vec3){0, 0, 0.5}, (rb_vec3){5, 0, 0});
		lab_seal(&lab, 1);
		lab_run(&lab);
		/* 5/7 of the speed from 2 v / (7 mu g) on, whatever the step */
		const double rolled = 5 * 5.0 / 7, until = 2 * 5 / (7 * 0.3 * g);
		const double way = 5 * until - 0.5 * 0.3 * g * until * until + rolled * (1 - until);
		assert_near(rb_world_velocity(lab.world, ball).x, rolled, 1e-4);
		assert_near(rb_world_angular_velocity(lab.world, ball).y, rolled / 0.5, 1e-3);
		assert_near(rb_world_position(lab.world, ball).x, way, 5 * 1.0 / (240 << k));
		lab_close(&lab);
	}
}

static void a_ball_passes_beside_another(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 0.1, 10, 0.1);
	lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	const int fast = lab_sphere(&lab, 0.5, 1, (rb_vec3){-5, 1.01, 0}, (rb_vec3){100, 0, 0});
	const int other = lab_sphere(&lab, 0.5, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_vector(rb_world_position(lab.world, fast), ((rb_vec3){5, 1.01, 0}), 1e-12);
	assert_vector(rb_world_velocity(lab.world, other), ((rb_vec3){0, 0, 0}), 0);
	lab_close(&lab);
}

/* ---- boxes ---- */

/* Where a box on a slope of 30 degrees is after a second along it, m. */
static double slide(double friction)
{
	const double angle = 0.5235987755982988;
	const rb_vec3 normal = {sin(angle), 0, cos(angle)}, down = {cos(angle), 0, -sin(angle)};
	const rb_quat turn = {cos(angle / 2), 0, sin(angle / 2), 0};
	struct lab lab;

	open_stepped(&lab, 1, 60, 1.0 / 240);
	lab_surface(&lab, friction, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, normal);
	const rb_vec3 at = rb_vec3_scale(0.5, normal);
	const int box = lab_box(&lab, (rb_vec3){2, 2, 1}, 3, at, turn);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const double way = rb_vec3_dot(down, rb_vec3_sub(rb_world_position(lab.world, box), at));
	lab_close(&lab);
	return way;
}

static void a_box_stands_on_a_slope_or_slides_as_coulomb_says(void **state)
{
	(void)state;
	const double angle = 0.5235987755982988;
	const double pull = g * (sin(angle) - 0.2 * cos(angle));

	assert_near(slide(0.7), 0, 1e-9);
	assert_near(slide(0.2), 0.5 * pull, pull / 240);
	assert_near(slide(0), 0.5 * g * sin(angle), g * sin(angle) / 240);
}

static void a_heavy_box_stands_on_light_ones(void **state)
{
	static const double ratios[] = {1, 1e3, 1e4, 1e6};
	enum { COUNT = 10 };

	(void)state;
	for (int r = 0; r < 4; r++) {
		struct lab lab;
		int top = 0;

		open_stepped(&lab, 0.5, 60, 1.0 / 60);
		lab_surface(&lab, 0.5, 0);
		lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		for (int k = 0; k < COUNT; k++)
			top = add_cube(&lab, k == COUNT - 1 ? ratios[r] : 1,
			               (rb_vec3){0, 0, 0.5 + k});
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_vector(rb_world_position(lab.world, top), ((rb_vec3){0, 0, COUNT - 0.5}),
		              1e-6);
		lab_close(&lab);
	}
}

static void an_impact_of_a_turned_box_never_raises_energy(void **state)
{
	(void)state;
	for (int k = 0; k < 40; k++) {
		struct lab lab;

		open_stepped(&lab, 0.5, 60, 1.0 / 240);
		lab_surface(&lab, 0.25 * (k % 4), 0.25 * (k % 5));
		lab.scene.world.gravity = (rb_vec3){0, 0, 0};
		lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const rb_quat turn = rb_quat_unit(
			(rb_quat){cos(k), sin(2.0 * k), cos(3.0 * k), sin(5.0 * k)});
		const int box = lab_box(&lab, (rb_vec3){2, 0.5, 0.25}, 1, (rb_vec3){0, 0, 1.5},
		                        turn);
		lab.scene.bodies[box].velocity = (rb_vec3){sin(k), cos(k), -5};
		lab_seal(&lab, 1);
		const double before = rb_world_kinetic_energy(lab.world, box);
		lab_run(&lab);
		const double after = rb_world_kinetic_energy(lab.world, box);
		if (!(after <= before * (1 + 1e-6)))
			fail_msg("case %d: %.17g J became %.17g J", k, before, after);
		assert_true(rb_world_totals(lab.world).collisions > 0);
		lab_close(&lab);
	}
}

/* A cylinder thrown on a floor: body-steps that are taken back in half a second. */
static uint64_t thrown_away(int series, double time_step)
{
	struct rb_body_def def = rb_body_def_default();
	struct lab lab;

	open_stepped(&lab, 0.5, 60, time_step);
	lab_surface(&lab, 0.4, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	def.call = "cylinder";
	def.shape.kind = RB_SHAPE_CYLINDER;
	def.shape.radius = 0.08;
	def.shape.size[2] = 0.08;
	def.mass = 1;
	def.position = (rb_vec3){0, 0, 0.3};
	def.orientation = solids_turn((uint64_t)series);
	def.velocity = (rb_vec3){1, 0, -4};
	def.angular_velocity = (rb_vec3){15 * sin(series), 15 * cos(series), 15};
	(void)lab_add(&lab, &def);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	const uint64_t away = rb_world_work(lab.world).discarded_body_steps;
	lab_close(&lab);
	return away;
}

/* What lies under a rim is another point after every turn: it is looked for where the step ends, too. */
static void what_tumbles_takes_whole_steps(void **state)
{
	uint64_t away = 0, coarse = 0;

	(void)state;
	for (int k = 0; k < 40; k++) {
		away += thrown_away(k, 1.0 / 240);
		coarse += thrown_away(k, 1.0 / 60);
	}
	assert_true(away <= 2);
	assert_true(coarse <= 3);
}

/* ---- heaps ---- */

static void lay_heap(struct lab *lab, int side, int layers, bool boxes)
{
	const double wall = 0.55 * side + 0.1;

	lab_surface(lab, 0.5, 0.2);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	lab_plane(lab, (rb_vec3){-wall, 0, 0}, (rb_vec3){1, 0, 0});
	lab_plane(lab, (rb_vec3){wall, 0, 0}, (rb_vec3){-1, 0, 0});
	lab_plane(lab, (rb_vec3){0, -wall, 0}, (rb_vec3){0, 1, 0});
	lab_plane(lab, (rb_vec3){0, wall, 0}, (rb_vec3){0, -1, 0});
	for (int k = 0; k < side * side * layers; k++) {
		const int x = k % side, y = k / side % side, z = k / (side * side);
		const rb_vec3 at = {1.1 * x - 0.55 * (side - 1) + 0.04 * sin(7.0 * k),
		                    1.1 * y - 0.55 * (side - 1) + 0.04 * cos(5.0 * k),
		                    0.55 + 1.02 * z};

		if (boxes && k % 2)
			add_cube(lab, 1, at);
		else
			lab_sphere(lab, 0.5, 1 + 0.5 * (k % 3), at, (rb_vec3){0, 0, -3});
	}
}

static uint64_t heap_after(int side, int layers, bool boxes, int threads)
{
	struct lab lab;

	open_stepped(&lab, 0.25, 60, 1.0 / 120);
	lay_heap(&lab, side, layers, boxes);
	lab_seal(&lab, threads);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	const uint64_t hash = rb_world_hash(lab.world);
	lab_close(&lab);
	return hash;
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
	(void)state;
	uint64_t small = 0, large = 0;

	for (int threads = compares_threads ? 1 : 2; threads <= tried(3, 2, 3); threads++) {
		const uint64_t few = heap_after(3, 3, true, threads),
			       many = heap_after(14, 4, false, threads);

		small = threads == 1 ? few : small;
		large = threads == 1 ? many : large;
		assert_true(!compares_threads || (few == small && many == large));
	}
}

static void a_heap_comes_to_rest_within_the_tolerance(void **state)
{
	struct lab lab;
	double fastest = 0;

	(void)state;
	open_stepped(&lab, 4, 60, 1.0 / 120);
	lay_heap(&lab, 2, 4, true);
	lab_seal(&lab, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	for (int id = 0; id < rb_world_id_count(lab.world); id++)
		fastest = fmax(fastest, rb_vec3_length(rb_world_velocity(lab.world, id)));
	assert_true(fastest < g / 120);
	lab_close(&lab);
}

static void a_heap_that_is_restored_goes_on_in_the_same_bits(void **state)
{
	struct rb_pack saved = {0};
	struct lab lab, again;

	(void)state;
	open_stepped(&lab, 0.5, 60, 1.0 / 120);
	lay_heap(&lab, 3, 2, true);
	lab_seal(&lab, 1);
	for (int k = 0; k < 15; k++)
		lab_step(&lab);
	assert_int_equal(rb_world_pack(lab.world, &saved, &lab.error), RB_OK);
	lab_run(&lab);
	open_stepped(&again, 0.5, 60, 1.0 / 120);
	lay_heap(&again, 3, 2, true);
	lab_seal(&again, 2);
	struct rb_pack pack = {.loading = true, .bytes = saved.bytes, .size = saved.size};
	assert_int_equal(rb_world_pack(again.world, &pack, &again.error), RB_OK);
	lab_run(&again);
	assert_true(rb_world_hash(again.world) == rb_world_hash(lab.world));
	lab_close(&again);
	lab_close(&lab);
	rb_pack_release(&saved);
}

/* Wherever within a step the run is to end: bodies are where a whole step has brought them. */
static void a_step_that_is_interrupted_moves_nothing(void **state)
{
	enum { STEPS = 12, MOMENTS = 5, SIZE = 8 * 8 * 4 * 3 };
	static double place[STEPS + 1][SIZE];

	(void)state;
	for (int boxes = 0; boxes <= 1; boxes++) {
		const int side = boxes ? 5 : 8;
		const size_t size = (size_t)(side * side * 4 * 3) * sizeof(double);
		int calls = 0;

		for (int k = 0; k < MOMENTS; k++) {
			struct patience patience = {.last = calls * k / MOMENTS};
			const struct rb_world_options options = {
				.threads = 1, .stop = count_calls, .stop_user = &patience};
			struct lab lab;

			open_stepped(&lab, 1, 60, 1.0 / 60);
			lay_heap(&lab, side, 4, boxes);
			lab_seal_with(&lab, &options, NULL);
			for (int n = 0; n <= STEPS && !rb_world_stopped(lab.world); n++) {
				if (k == 0)
					memcpy(place[n], lab.world->state.position, size);
				if (n < STEPS)
					lab_step(&lab);
			}
			assert_int_equal(rb_world_stopped(lab.world), k > 0);
			if (k == 0)
				calls = patience.calls;
			else
				assert_int_equal(patience.calls, patience.last);
			assert_true(calls > MOMENTS * STEPS);
			const int done = (int)(60 * lab.world->state.time_s + 0.5);
			assert_memory_equal(lab.world->state.position, place[done], size);
			lab_close(&lab);
		}
	}
}

/* What stands still is not solved again, until something touches it: then it is as if it always had been. */
static void a_stack_at_rest_costs_no_sweeps(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 4, 60, 1.0 / 60);
	lab_surface(&lab, 0.5, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 3; k++)
		add_cube(&lab, 1, (rb_vec3){0, 0, 0.5 + k});
	const int ball = lab_sphere(&lab, 0.25, 1, (rb_vec3){0, 0, 3.3 + 0.5 * g * 9},
	                            (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	for (int k = 0; k < 60; k++)
		lab_step(&lab);
	const struct rb_world_work before = rb_world_work(lab.world);
	for (int k = 0; k < 60; k++)
		lab_step(&lab);
	const struct rb_world_work after = rb_world_work(lab.world);
	assert_int_equal(after.row_sweeps, before.row_sweeps);
	assert_int_equal(after.factors, before.factors);
	assert_true(after.rows > before.rows);
	lab_run(&lab);
	assert_true(rb_world_work(lab.world).row_sweeps > after.row_sweeps);
	assert_near(rb_world_position(lab.world, ball).z, 3.25, 1e-6);
	lab_close(&lab);
}

/*
 * A block that rolls over its lower edge as it lands: its corners come down one after the other within one step, and what
 * turning asks of their slips must agree.
 */
static void an_edge_that_lands_askew_does_not_creep(void **state)
{
	(void)state;
	for (int k = 0; k < 6; k++) {
		const double tilt = 0.7 + 0.02 * k, askew = 1e-3 * (k + 1);
		const rb_vec3 spin = {12, 0, 0};
		const rb_vec3 edge = rb_vec3_scale(
			-0.5, (rb_vec3){0, cos(tilt) - sin(tilt), cos(tilt) + sin(tilt)});
		const rb_quat turn = rb_quat_multiply(rb_quat_from_turn((rb_vec3){0, askew, 0}),
		                                      rb_quat_from_turn((rb_vec3){tilt, 0, 0}));
		const double low = 0.5 * (sin(tilt) + cos(tilt)) * cos(askew) + 0.5 * sin(askew);
		struct lab lab;

		open_stepped(&lab, 1.0 / 60, 60, 1.0 / 60);
		lab.scene.world.rollback = RB_ROLLBACK_NONE; /* that one step */
		lab_surface(&lab, 0.8, 0);
		lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const int box = lab_box(&lab, (rb_vec3){1, 1, 1}, 1, (rb_vec3){0, 0, low}, turn);
		lab.scene.bodies[box].velocity = rb_vec3_add((rb_vec3){0, 0, -1},
		                                             rb_vec3_cross(edge, spin));
		lab.scene.bodies[box].angular_velocity = spin;
		lab_seal(&lab, 1);
		lab_run(&lab);
		const struct rb_world_work work = rb_world_work(lab.world);
		assert_int_equal(work.rows, 2);
		assert_int_equal(work.factors, 0);
		assert_true(work.row_sweeps < 200); /* of both; or hundreds of each */
		lab_close(&lab);
	}
}

/* Rows of cubes, each over the joints of those below; a single column. */
static int lay_bricks(struct lab *lab, int rows, bool pyramid)
{
	int top = 0;

	for (int row = 0; row < rows; row++)
		for (int k = 0; k < (pyramid ? rows - row : 1); k++)
			top = add_cube(
				lab, 1,
				(rb_vec3){(pyramid ? 0.5 * row : 0) + 1.001 * k, 0, 0.5 + row});
	return top;
}

/* Sweeps let what is tall creep, and throw away half of its steps. */
static void what_is_tall_stands_from_its_first_step(void **state)
{
	(void)state;
	for (int pyramid = 0; pyramid < 2; pyramid++) {
		const int rows = pyramid ? 12 : 50;
		struct lab lab;

		open_stepped(&lab, 2, 60, 1.0 / 60);
		lab_surface(&lab, 0.5, 0);
		lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		const int top = lay_bricks(&lab, rows, pyramid);
		lab_seal(&lab, 1);
		const rb_vec3 start = rb_world_position(lab.world, top);
		for (int k = 0; k < 10; k++)
			lab_step(&lab);
		const struct rb_world_work before = rb_world_work(lab.world);
		assert_int_equal(before.row_sweeps, 0);
		assert_int_equal(before.closings, 0);
		lab_run(&lab);
		assert_int_equal(rb_world_work(lab.world).factors, before.factors);
		assert_vector(rb_world_position(lab.world, top), start, 1e-12 * rows);
		lab_close(&lab);
	}
}

static void drop_columns(struct lab *lab, double duration, int count, int high)
{
	open_stepped(lab, duration, 60, 1.0 / 240);
	lab_surface(lab, 0.5, 0);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < high * count; k++)
		add_cube(lab, 1,
		         (rb_vec3){1.1 * (k / high % 3) + 0.04 * sin(7.0 * k),
		                   1.1 * (k / high / 3) + 0.04 * cos(5.0 * k),
		                   0.55 + 1.1 * (k % high)});
}

/*
 * A chain of rows, along which news of the floor must travel: 1.4 to 9 sweeps by masses that differ
 * in their last digits, since columns that hit the floor flat jump this way or that; 14 without
 * mixtures.
 */
static void columns_that_fall_stand_after_few_sweeps(void **state)
{
	struct lab lab;

	(void)state;
	drop_columns(&lab, 2, 9, 8);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const struct rb_world_work work = rb_world_work(lab.world);
	assert_true(work.row_sweeps < 10 * work.rows);
	lab_close(&lab);
}

/* What solutions leave of the forces must not shake them: gravity gives 0.04 m/s in a step, the tolerance lets by 0.3 m/s. */
static void columns_come_to_stand_whatever_the_tolerance(void **state)
{
	static const double tolerances[] = {5e-3, 5e-4, 5e-5};

	(void)state;
	for (int t = 0; t < 3; t++) {
		struct lab lab;

		drop_columns(&lab, 4, 6, 10);
		lab.scene.world.tolerance_m = tolerances[t];
		lab_seal(&lab, 1);
		lab_run(&lab);
		for (int i = 0; i < 3 * 60; i++) {
			assert_true(lab.world->state.velocity[i] == 0);
			assert_true(lab.world->state.spin[i] == 0);
		}
		lab_close(&lab);
	}
}

static void an_impact_is_told_once(void **state)
{
	struct lab lab;
	int count = 0;

	(void)state;
	open_stepped(&lab, 1, 60, 1.0 / 240);
	lab_surface(&lab, 0.5, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	add_cube(&lab, 2, (rb_vec3){0, 0, 1.5});
	lab_seal(&lab, 1);
	lab_run(&lab);
	count = (int)rb_world_totals(lab.world).collisions;
	assert_int_equal(count, 1);
	lab_close(&lab);
}

static void what_has_sunk_rises_again_from_rest(void **state)
{
	struct lab lab;

	(void)state;
	open_stepped(&lab, 0.1, 100, 0.01);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0.1}, (rb_vec3){0, 0, 0});
	lab_seal(&lab, 1);
	lab_step(&lab);
	/* a little more than the tolerance, as residuals within it add up to */
	const double tolerance = lab.world->model->tolerance_m;
	lab.world->state.position[2] = 0.1 - 1.01 * tolerance;
	lab_run(&lab);
	assert_near(rb_world_position(lab.world, ball).z, 0.1, tolerance);
	assert_near(rb_world_velocity(lab.world, ball).z, 0, 1e-12);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(free_fall_is_exact_for_any_step),
		cmocka_unit_test(what_is_near_and_is_not_met_changes_no_fall),
		cmocka_unit_test(what_is_pushed_blocks_where_it_is_only),
		cmocka_unit_test(the_error_of_a_bounce_is_bounded_by_the_step),
		cmocka_unit_test(a_ball_at_rest_with_restitution_rests),
		cmocka_unit_test(sliding_turns_into_rolling),
		cmocka_unit_test(a_ball_passes_beside_another),
		cmocka_unit_test(a_box_stands_on_a_slope_or_slides_as_coulomb_says),
		cmocka_unit_test(a_heavy_box_stands_on_light_ones),
		cmocka_unit_test(an_impact_of_a_turned_box_never_raises_energy),
		cmocka_unit_test(what_tumbles_takes_whole_steps),
		cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
		cmocka_unit_test(a_heap_comes_to_rest_within_the_tolerance),
		cmocka_unit_test(a_heap_that_is_restored_goes_on_in_the_same_bits),
		cmocka_unit_test(a_step_that_is_interrupted_moves_nothing),
		cmocka_unit_test(a_stack_at_rest_costs_no_sweeps),
		cmocka_unit_test(an_edge_that_lands_askew_does_not_creep),
		cmocka_unit_test(what_is_tall_stands_from_its_first_step),
		cmocka_unit_test(columns_that_fall_stand_after_few_sweeps),
		cmocka_unit_test(columns_come_to_stand_whatever_the_tolerance),
		cmocka_unit_test(an_impact_is_told_once),
		cmocka_unit_test(what_has_sunk_rises_again_from_rest),
	};

	return run_tests_of_threads(tests, "same_bits");
}
