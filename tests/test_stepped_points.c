/* SPDX-License-Identifier: MIT */
/*
 * src/stepped/candidates, src/stepped/contact_points: what was far apart is not looked at again
 * until it could be near.
 */
#include "sanitized.h"
#include "turns.h"
#include "worlds.h"

#include "base/memory.h"
#include "stepped/end_points.h"
#include "stepped/clearance.h"
#include "stepped/find_points.h"
#include "stepped/projection.h"
#include "stepped/stepped_state.h"
#include "stepped/stepped.h"
#include "world/world.h"

static int add_box(struct lab *lab, rb_vec3 size, rb_vec3 at, rb_vec3 velocity, rb_vec3 spin)
{
	struct rb_body_def def = lab_box_def(size, 1, at);

	def.velocity = velocity;
	def.angular_velocity = spin;
	return lab_add(lab, &def);
}

static void open_weightless(struct lab *lab, double duration)
{
	lab_open(lab, duration, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 240;
	lab_surface(lab, 0.3, 0);
}

static void run_within_tolerance(struct lab *lab)
{
	lab_seal(lab, 1);
	lab_run(lab);
	assert_true(rb_world_totals(lab->world).max_penetration <= lab->model->tolerance_m);
}

static const rb_vec3 none = {0, 0, 0};

/* Only its turning brings it there: its centre stays where it is. */
static void a_stick_that_turns_hits_what_its_tip_reaches(void **state)
{
	struct lab lab;

	(void)state;
	open_weightless(&lab, 3);
	add_box(&lab, (rb_vec3){4, 0.1, 0.1}, none, none, (rb_vec3){0, 0, 1});
	const int hit = add_box(&lab, (rb_vec3){0.2, 0.2, 0.2}, (rb_vec3){0, 1.8, 0}, none, none);
	run_within_tolerance(&lab);
	/* a quarter of a turn, less what both are wide, takes about 1.5 s */
	assert_true(rb_world_velocity(lab.world, hit).x < -0.2);
	lab_close(&lab);
}

/*
 * Seen far apart for long, and between others: nobody meets it but the wall, and then whom it had
 * left.
 */
static void what_comes_back_is_met(void **state)
{
	struct lab lab;

	(void)state;
	open_weightless(&lab, 3);
	lab.scene.materials[0].restitution = 1;
	lab_plane(&lab, (rb_vec3){1, 0, 0}, (rb_vec3){-1, 0, 0});
	const int stays = add_box(&lab, (rb_vec3){0.5, 0.5, 0.5}, (rb_vec3){-0.3, 0, 0}, none,
	                          none);
	add_box(&lab, (rb_vec3){0.5, 0.5, 0.5}, (rb_vec3){0.21, 0, 0}, (rb_vec3){0.5, 0, 0}, none);
	run_within_tolerance(&lab);
	assert_near(rb_world_velocity(lab.world, stays).x, -0.5, 1e-6);
	lab_close(&lab);
}

/* Many boxes that turn, and come to lie in one heap. */
static void open_heap(struct lab *lab, double duration)
{
	open_weightless(lab, duration);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 4; k++) {
		const rb_vec3 n = {k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0, 0};

		lab_plane(lab, rb_vec3_scale(-1, n), n);
	}
	for (int k = 0; k < 36; k++)
		add_box(lab, (rb_vec3){0.5, 0.3, 0.2},
		        (rb_vec3){0.6 * (k % 3 - 1), 0.6 * (k / 3 % 3 - 1), 0.4 + 0.6 * (k / 9)},
		        none, (rb_vec3){sin(k), 2 * cos(3.0 * k), sin(5.0 * k)});
}

/* What each pair is known to be apart must not be more than it is. */
static void a_heap_of_boxes_that_turn_stays_within_the_tolerance(void **state)
{
	struct lab lab;

	(void)state;
	open_heap(&lab, 1.5);
	run_within_tolerance(&lab);
	for (int i = 0; i < lab.model->body_count; i++)
		assert_true(lab.world->stepped->candidates.path[i] > 0.3);
	assert_true(rb_world_work(lab.world).rows > 0);
	lab_close(&lab);
}

/*
 * An impact within a step may begin a turn as well as end it: what the contacts were solved for
 * bends either way.
 */
static void what_may_be_closed_follows_the_faster_turn(void **state)
{
	static const double spins[][2] = {{0, 0}, {0, 3}, {3, 0}, {3, 3}, {3, -1}};
	double most[5];
	struct lab lab;

	(void)state;
	open_weightless(&lab, 1);
	for (int k = 0; k < 2; k++)
		add_box(&lab, (rb_vec3){1, 1, 1}, (rb_vec3){2.0 * k, 0, 0}, none, none);
	lab_seal(&lab, 1);
	lab_step(&lab);
	for (int k = 0; k < 5; k++)
		for (int body = 0; body < 2; body++) {
			const struct rb_deep deep = {0, 1, 0};

			memset(lab.world->state.spin, 0, 6 * sizeof(double));
			memset(lab.world->mark.spin, 0, 6 * sizeof(double));
			lab.world->mark.spin[3 * body + 1] = spins[k][0];
			lab.world->state.spin[3 * body + 2] = spins[k][1];
			const double here = rb_projection_max(lab.world, &deep, 1e-3);
			assert_true(body == 0 || here == most[k]);
			most[k] = here;
		}
	assert_true(most[1] > most[0]);
	for (int k = 2; k < 5; k++)
		assert_true(most[k] == most[1]);
	lab_close(&lab);
}

/*
 * About any axis, from any orientation: no point of it has gone farther than its size times the
 * angle, and some as far.
 */
static void what_turns_in_place_has_gone_its_size_times_its_angle(void **state)
{
	(void)state;
	for (int k = 0; k < 6; k++) {
		const rb_vec3 axis = {k % 3 == 0, k % 3 == 1, k % 3 == 2};
		struct rb_body_def def = rb_body_def_default();
		struct lab lab;

		open_weightless(&lab, 1);
		def.call = "box";
		def.shape.kind = RB_SHAPE_BOX;
		def.mass = 1;
		rb_vec3_to(def.shape.size, (rb_vec3){1, 1, 1});
		def.orientation = k < 3 ? rb_quat_identity
		                        : rb_quat_from_turn((rb_vec3){2, -1, 0.5});
		def.angular_velocity = axis;
		lab_add(&lab, &def);
		add_box(&lab, (rb_vec3){1, 1, 1}, (rb_vec3){1.9, 0, 0}, none, none);
		lab_seal(&lab, 1);
		lab_step(&lab);
		const struct rb_candidates *const candidates = &lab.world->stepped->candidates;
		const double before = candidates->path[0], since = rb_world_time(lab.world);
		for (int n = 0; n < 20; n++)
			lab_step(&lab);
		/* 2 sin(t / 2) for an angle t of a step falls short by t^2 / 24, 1e-6 of it */
		assert_near(candidates->path[0] - before,
		            candidates->size[0] * (rb_world_time(lab.world) - since), 1e-5);
		lab_close(&lab);
	}
}

/* Steps begin with the forces that locating has left; a driven body comes second in their pairs. */
static void steps_take_over_what_was_located(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	lab.scene.world.method = RB_METHOD_AUTO;
	lab.scene.world.time_step_s = 1.0 / 240;
	lab.scene.world.gravity = (rb_vec3){0, 0, -10};
	lab_surface(&lab, 0.5, 0);
	const int low = add_box(&lab, (rb_vec3){1, 1, 1}, (rb_vec3){0, 0, 0.5}, none, none);
	const int high = add_box(&lab, (rb_vec3){1, 1, 1}, (rb_vec3){0, 0, 1.5}, none, none);
	const int floor = lab_plane(&lab, none, (rb_vec3){0, 0, 1});
	lab_seal(&lab, 1);
	lab_step(&lab);
	struct rb_world *world = lab.world;
	assert_true(world->contacts.count >= 2);
	assert_int_equal(rb_stepper_stepped.prepare(world, &lab.error), RB_OK);
	assert_int_equal(rb_stepper_stepped.take_over(world, &lab.error), RB_OK);
	const struct rb_step_points *points = &world->stepped->all.points;
	const int *at = world->model->index_of;

	assert_int_equal(points->last_count, world->contacts.count);
	for (size_t k = 0; k < points->last_count; k++) {
		const struct rb_named_impulse *impulse = &points->last[k];
		size_t found = 0;

		assert_int_equal(impulse->a, impulse->b == at[floor] ? at[low]
		                             : at[low] < at[high]    ? at[low]
		                                                     : at[high]);
		for (size_t c = 0; c < world->contacts.count; c++) {
			const struct rb_contact *contact = &world->contacts.row[c];

			if (contact->a != impulse->a || contact->b != impulse->b ||
			    contact->parts != impulse->parts || contact->key != impulse->key)
				continue;
			assert_true(impulse->force == contact->normal_force);
			found++;
		}
		assert_int_equal(found, 1);
	}
	assert_int_equal(rb_stepper_stepped.step(world, world->state.time_s, 1.0 / 240, &lab.error),
	                 RB_OK);
	assert_true(rb_vec3_max_abs(rb_world_velocity(world, high)) < 1e-9);
	lab_close(&lab);
}

/*
 * Spheres that fly fast past each other: many pairs could meet within the steps of a list, few
 * touch. Looking for the points takes room for those that are found, and gives it back.
 */
static void memory_follows_the_points_and_not_the_pairs(void **state)
{
	enum { SIDE = 12, BODIES = SIDE * SIDE * SIDE };
	struct lab lab;

	(void)state;
	open_weightless(&lab, 1);
	lab_plane(&lab, (rb_vec3){0, 0, -0.61}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < BODIES; k++)
		lab_sphere(&lab, 0.5, 1,
		           (rb_vec3){1.2 * (k % SIDE), 1.2 * (k / SIDE % SIDE),
		                     1.2 * (k / SIDE / SIDE)},
		           (rb_vec3){0, 0, -20});
	lab_seal(&lab, 1);
	lab_step(&lab);
	struct rb_stepped *const s = lab.world->stepped;
	struct rb_arena *const arena = &lab.world->arena[0];
	const size_t pairs = s->candidates.pair_count;
	rb_arena_release(arena);
	s->closing.count = 0;
	assert_int_equal(rb_step_points_add(&s->closing, lab.world, &s->candidates, 1.0 / 240,
	                                    HUGE_VAL, &lab.error),
	                 RB_OK);
	assert_true(pairs > 4 * BODIES);
	assert_int_equal(arena->used, 0);
	assert_null(arena->overflow);
	/* of a block: what is told of it, and arrays of 16, 32, ... to twice what is found */
	const size_t blocks = pairs / RB_PAIRS_PER_BLOCK + 1;
	const size_t most = (4 * s->closing.count + 16 * blocks) * sizeof *s->closing.row +
	                    512 * (blocks + 1);
	print_message("%zu pairs, %zu points, %zu bytes\n", pairs, s->closing.count,
	              arena->high_water);
	assert_true(arena->high_water <= most);
	/* the same for their order, wherever they have stood: the second half before the first */
	const size_t count = s->closing.count, bytes = count * sizeof *s->closing.row;
	struct rb_step_point *const in_order = malloc(bytes);
	size_t half = count / 2;

	assert_non_null(in_order);
	memcpy(in_order, s->closing.row, bytes);
	while (in_order[half].pair == in_order[half - 1].pair)
		half++;
	memcpy(s->closing.row, in_order + half, (count - half) * sizeof *in_order);
	memcpy(s->closing.row + count - half, in_order, half * sizeof *in_order);
	rb_arena_release(arena);
	assert_true(rb_step_points_sort(&s->closing, arena, &lab.error) == RB_OK);
	assert_memory_equal(s->closing.row, in_order, bytes);
	assert_int_equal(arena->used, 0);
	assert_true(arena->high_water < bytes / 2);
	free(in_order);
	lab_close(&lab);
}

/* A plate is next to nothing of the sphere round it, which does not make it meet more than there are. */
static void memory_foretold_for_a_heap_follows_its_pairs(void **unused)
{
	enum { BODIES = 16 };
	static const double thick[] = {0.5, 1e-3, 1e-12, 1e-40};

	(void)unused;
	for (size_t t = 0; t < sizeof thick / sizeof *thick; t++) {
		struct lab lab;

		open_weightless(&lab, 1);
		lab.scene.world.gravity = (rb_vec3){0, 0, -1};
		lab_plane(&lab, none, (rb_vec3){0, 0, 1});
		for (int k = 0; k < BODIES; k++)
			(void)add_box(&lab, (rb_vec3){1, 1, thick[t]}, (rb_vec3){2 * k, 0, 1}, none,
			              none);
		lab_seal(&lab, 1);
		/* what is there by body and by point, and a kilobyte for each pair */
		const size_t most = (32 << 10) * (size_t)BODIES +
		                    1024 * (size_t)(BODIES * (BODIES + 1) / 2);

		print_message("%zu bytes\n", rb_stepped_heap_bytes(lab.model, 1));
		assert_true(rb_stepped_heap_bytes(lab.model, 1) <= most);
		assert_true(rb_stepped_heap_bytes(lab.model, 1) > 0);
		lab_close(&lab);
	}
}

/* Of a pose it is known as if it had been asked for; of another one it is found. */
static void what_was_found_of_a_pose_is_not_that_of_another(void **state)
{
	struct lab lab;

	(void)state;
	open_weightless(&lab, 1);
	add_box(&lab, (rb_vec3){1, 1, 1}, none, none, none);
	add_box(&lab, (rb_vec3){1, 1, 1}, (rb_vec3){1.5, 0.2, 0.1}, none, (rb_vec3){0.1, 0.2, 0.3});
	lab_seal(&lab, 1);
	struct rb_candidates *const candidates = &lab.world->stepped->candidates;
	const struct rb_pair pair = {0, 1};
	struct rb_axis_cache cache = {.is_known = false};
	for (int frame = 0; frame < 4; frame++) {
		lab_step(&lab);
		rb_candidates_place(candidates, lab.world, (const int[]){0, 1}, 2);
		const struct rb_part_pair parts = rb_part_pair_of(&candidates->placed[0],
		                                                  &candidates->placed[1]);
		const rb_separation is = rb_separation_of(&parts.a, &parts.b);

		assert_false(rb_axis_cache_knows(&cache, rb_placings_of(candidates, pair)));
		for (int twice = 0; twice < 2; twice++) {
			const struct rb_placings placings = rb_placings_of(candidates, pair);
			const rb_separation found = rb_clearance_separation(&parts, placings,
			                                                    &cache);

			assert_near(found.gap, is.gap, 0);
			assert_near(found.noise, is.noise, 0);
			assert_vector(found.normal, is.normal, 0);
			rb_candidates_place(candidates, lab.world, (const int[]){0, 1}, 2);
			assert_true(rb_axis_cache_knows(&cache, rb_placings_of(candidates, pair)));
		}
	}
	/* a turn of which the square is no number any more is one, too */
	for (int k = 1; k <= 2; k++) {
		const struct rb_placings before = rb_placings_of(candidates, pair);

		rb_quat_to(lab.world->state.orientation + 4, (rb_quat){1, k * 1e-200, 0, 0});
		rb_candidates_place(candidates, lab.world, (const int[]){0, 1}, 2);
		assert_true(rb_placings_of(candidates, pair).b != before.b);
	}
	lab_close(&lab);
}

enum { PIT = 6, LAYERS = 8, PIT_FRAMES = 40, PIT_ROWS = 512 };

/* Bricks turned this way and that, which come down into a pit and press on each other. */
static void fill_pit(struct lab *lab, int threads, double tolerance)
{
	const struct rb_world_options options = {.threads = threads};

	lab_open(lab, 2, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 240;
	lab->scene.world.tolerance_m = tolerance;
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.3, 0);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 4; k++) {
		const double sign = k % 2 ? 1 : -1;
		const rb_vec3 n = {k < 2 ? sign : 0, k < 2 ? 0 : sign, 0};

		lab_plane(lab, rb_vec3_scale(-0.36 * PIT, n), n);
	}
	for (int k = 0; k < PIT * PIT * LAYERS; k++) {
		const rb_vec3 at = {0.7 * (k % PIT - 0.5 * (PIT - 1)),
		                    0.7 * (k / PIT % PIT - 0.5 * (PIT - 1)),
		                    0.4 + 0.66 * (k / PIT / PIT)};
		struct rb_body_def def = lab_box_def((rb_vec3){0.5, 0.4, 0.3}, 1, at);

		def.orientation = rb_quat_unit(
			(rb_quat){1, 0.4 * sin(3.0 * k), 0.4 * sin(5.0 * k), sin(7.0 * k)});
		lab_add(lab, &def);
	}
	lab_seal_with(lab, &options, NULL);
}

/* All points that are carried to where the last step has ended; false: there are none. */
static bool carry_all(struct rb_world *world, struct rb_step_points *to)
{
	const struct rb_cohort *const all = &world->stepped->all;
	struct rb_end_points carried;
	struct rb_error err;

	to->count = 0;
	assert_int_equal(rb_end_points_begin(&carried, world, all, &err), RB_OK);
	for (size_t k = 0; k < all->candidates->pair_count; k++) {
		all->candidates->depth[k] = 0;
		if (rb_end_points_has(&carried, k) && rb_end_points_is_near(&carried, k))
			assert_true(rb_end_points_add(&carried, k, 1, to));
		all->candidates->depth[k] = 1;
		assert_false(rb_end_points_has(&carried, k)); /* deep */
		all->candidates->depth[k] = 0;
	}
	return to->count > 0;
}

/* m: a body's way in the last step, and its turn at a distance of 1 m: twice that is above both. */
static double way_of(const struct rb_world *world, int i)
{
	double square = 0;

	for (int c = 0; i < world->model->body_count && c < 3; c++) {
		const double way = world->state.velocity[3 * i + c],
			     turn = world->state.spin[3 * i + c];

		square += (way * way + turn * turn) / (240.0 * 240);
	}
	return 2 * sqrt(square);
}

/* Their gaps are those of the pairs, but for what is of the second order. */
static void points_of_a_heap_are_carried_whatever_the_numbers_of_pairs(void **state)
{
	struct lab lab;
	struct rb_step_points was = {0}, is = {0};
	struct rb_error err;
	size_t numbers = 0;

	(void)state;
	fill_pit(&lab, 1, 5e-3);
	/* groups are those of the solution until overlaps have been closed */
	for (bool large = false; !large;) {
		const uint64_t closings = rb_world_work(lab.world).closings;

		lab_step(&lab);
		large = rb_world_work(lab.world).closings == closings && carry_all(lab.world, &was);
	}
	struct rb_stepped *const s = lab.world->stepped;
	rb_candidates_place(&s->candidates, lab.world, s->body, s->member_count);
	for (size_t k = 0; k < was.count; k++) {
		const struct rb_step_point *const p = &was.row[k];
		const int first = s->candidates.first_part[p->a];
		const struct rb_part_pair parts = rb_part_pair_of(
			&s->candidates.placed[first],
			&s->candidates.placed[s->candidates.first_part[p->b]]);
		const double way = way_of(lab.world, p->a) + way_of(lab.world, p->b);
		const double gap = rb_separation_of(&parts.a, &parts.b).gap;

		assert_true(p->normal_impulse == 0 && p->gap >= 0);
		/*
		 * Arms are 0.15 m and more; the normal of two edges turns faster than they do, by one over
		 * the sine of their angle, five times at most here. A term of first order would
		 * be off by the way itself, which is a tenth of that.
		 */
		assert_true(p->gap >= gap - way * way / 0.03);
	}
	s->candidates.valid = false;
	for (int i = 0; i < lab.world->model->body_count; i++)
		s->candidates.reach[i] *= 4;
	assert_int_equal(
		rb_candidates_find(&s->candidates, lab.world, s->body, s->member_count, &err),
		RB_OK);
	assert_true(carry_all(lab.world, &is));
	assert_int_equal(is.count, was.count);
	for (size_t k = 0; k < is.count; k++) {
		assert_int_equal(is.row[k].a, was.row[k].a);
		assert_int_equal(is.row[k].b, was.row[k].b);
		assert_near(is.row[k].gap, was.row[k].gap, 0);
		const struct rb_pair pair = s->candidates.pair[is.row[k].pair];
		numbers += pair.a != is.row[k].a || pair.b != is.row[k].b;
	}
	assert_true(numbers > 0);
	rb_memory_free(was.row);
	rb_memory_free(is.row);
	lab_close(&lab);
}

/* Boxes end within a step: each lasts for as far as the body goes unless it is struck. */
static void trim_boxes(struct rb_world *world, double gravity)
{
	struct rb_candidates *const candidates = &world->stepped->candidates;
	const double h = 1.0 / 240;

	for (int i = 0; i < world->model->body_count; i++) {
		const rb_vec3 from = rb_vec3_sub(rb_world_row3(world->state.position, i),
		                                 candidates->built_at[i]);
		const double speed = rb_vec3_length(rb_world_row3(world->state.velocity, i));

		candidates->margin[i] = rb_vec3_length(from) + h * (speed + h * gravity);
	}
}

/* What overlaps by its turn is solved again, whether or not other bodies have left their boxes. */
static void a_heap_moves_in_the_same_bits_wherever_boxes_end(void **state)
{
	struct lab whole, ends;

	(void)state;
	fill_pit(&whole, 1, 1e-5);
	fill_pit(&ends, 1, 1e-5);
	for (int frame = 0; frame < PIT_FRAMES; frame++) {
		lab_step(&whole);
		lab_step(&ends);
		assert_true(rb_world_hash(whole.world) == rb_world_hash(ends.world));
		trim_boxes(ends.world, 10);
	}
	lab_close(&whole);
	lab_close(&ends);
}

/* What was known of pairs before a search is known of those found again. */
static void a_search_for_pairs_keeps_what_is_known_of_them(void **state)
{
	struct lab lab;
	size_t far = 0, close = 0;

	(void)state;
	fill_pit(&lab, 1, 5e-3);
	for (int frame = 0; frame < PIT_FRAMES; frame++)
		lab_step(&lab);
	struct rb_stepped *const s = lab.world->stepped;
	struct rb_candidates *const candidates = &s->candidates;
	const size_t count = candidates->pair_count;
	struct known {
		struct rb_pair pair;
		double clearance;
		struct rb_axis_cache cache;
	} *const was = rb_memory_take(count, sizeof *was);
	assert_non_null(was);
	for (size_t k = 0; k < count; k++) {
		was[k] = (struct known){.pair = candidates->pair[k],
		                        .clearance = candidates->clearance[k]};
		if (candidates->first_cache[k] != RB_NO_CACHES)
			was[k].cache = candidates->cache[candidates->first_cache[k]];
	}
	candidates->valid = false;
	for (int i = 0; i < lab.world->model->body_count; i++)
		candidates->reach[i] *= 1.5; /* pairs get other numbers */
	assert_int_equal(
		rb_candidates_find(candidates, lab.world, s->body, s->member_count, &lab.error),
		RB_OK);
	for (size_t k = 0, at = 0; k < candidates->pair_count; k++) {
		const struct rb_pair pair = candidates->pair[k];

		for (at = 0; at < count; at++)
			if (was[at].pair.a == pair.a && was[at].pair.b == pair.b)
				break;
		if (at == count)
			continue;
		assert_near(candidates->clearance[k], was[at].clearance, 0);
		far += isfinite(was[at].clearance) ? 1 : 0;
		if (!was[at].cache.is_close)
			continue;
		assert_true(candidates->first_cache[k] != RB_NO_CACHES);
		assert_memory_equal(&candidates->cache[candidates->first_cache[k]], &was[at].cache,
		                    sizeof was[at].cache);
		close++;
	}
	assert_true(far > 0 && close > 0);
	rb_memory_free(was);
	lab_close(&lab);
}

/*
 * Overlaps in a heap are closed with points of the step: whether pairs were found anew, and by how
 * many threads, is not in the bits.
 */
static void a_heap_is_closed_in_the_same_bits_whenever_pairs_are_found(void **state)
{
	struct lab once, anew;
	size_t most = 0;

	(void)state;
	fill_pit(&once, 1, 1e-5);
	fill_pit(&anew, 2, 1e-5);
	for (int frame = 0; frame < PIT_FRAMES; frame++) {
		const size_t count = once.world->stepped->all.points.count;

		anew.world->stepped->candidates.valid = false;
		lab_step(&once);
		lab_step(&anew);
		most = count > most ? count : most;
		assert_true(rb_world_hash(once.world) == rb_world_hash(anew.world));
	}
	assert_true(most > PIT_ROWS);
	assert_true(rb_world_work(once.world).closings > PIT_FRAMES);
	assert_true(rb_world_totals(once.world).max_penetration <= 1e-5);
	lab_close(&once);
	lab_close(&anew);
}

/* A new contact begins with no impulse, not with what its place in memory has last been used for. */
static void what_was_in_memory_decides_nothing(void **state)
{
	struct lab once, littered;

	(void)state;
	open_heap(&once, 0.5);
	open_heap(&littered, 0.5);
	lab_seal(&once, 1);
	lab_seal(&littered, 1);
	for (int k = 0; k < 30; k++) {
		struct rb_arena *const arena = littered.world->arena;

		if (arena->block)
			memset(arena->block + arena->used, 0x3f, arena->size - arena->used);
		lab_step(&once);
		lab_step(&littered);
		assert_true(rb_world_hash(once.world) == rb_world_hash(littered.world));
	}
	assert_true(rb_world_work(once.world).rows > 0);
	lab_close(&once);
	lab_close(&littered);
}

/*
 * Where coordinates round more coarsely than a small ball's gaps are resolved: on paths of 1 to
 * 1,000 m within one step to a plane 1 km from the origin.
 */
static void a_small_ball_far_away_stops_at_what_it_reaches(void **state)
{
	const double far = 1000, radius = 1e-3, h = 1.0 / 60;

	(void)state;
	for (uint64_t k = 0; k < 150; k++) {
		struct lab lab;
		const rb_vec3 n = rb_vec3_unit(some_vector(4 * k), (rb_vec3){0, 0, 1});
		const rb_vec3 across = rb_vec3_reject(some_vector(4 * k + 1), n);
		const double path = pow(10, (double)(k % 4)), share = between(0.3, 0.9, 7, k);
		const rb_vec3 along = rb_vec3_add_scaled(n, 0.2, across);

		lab_open(&lab, h, 60);
		lab.scene.world.method = RB_METHOD_STEPPED;
		lab.scene.world.time_step_s = h;
		lab_surface(&lab, 0, 0);
		const int ball = lab_sphere(&lab, radius, 1,
		                            rb_vec3_scale(far - radius - share * path, n),
		                            rb_vec3_scale(path / h, along));
		lab_plane(&lab, rb_vec3_scale(far, n), rb_vec3_neg(n));
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_near(rb_vec3_dot(rb_world_position(lab.world, ball), n), far - radius,
		            lab.model->stepped_tolerance_m);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_was_in_memory_decides_nothing),
		cmocka_unit_test(memory_foretold_for_a_heap_follows_its_pairs),
		cmocka_unit_test(memory_follows_the_points_and_not_the_pairs),
		cmocka_unit_test(steps_take_over_what_was_located),
		cmocka_unit_test(a_stick_that_turns_hits_what_its_tip_reaches),
		cmocka_unit_test(what_comes_back_is_met),
		cmocka_unit_test(a_small_ball_far_away_stops_at_what_it_reaches),
		cmocka_unit_test(what_turns_in_place_has_gone_its_size_times_its_angle),
		cmocka_unit_test(what_may_be_closed_follows_the_faster_turn),
		cmocka_unit_test(a_heap_of_boxes_that_turn_stays_within_the_tolerance),
		cmocka_unit_test(what_was_found_of_a_pose_is_not_that_of_another),
		cmocka_unit_test(points_of_a_heap_are_carried_whatever_the_numbers_of_pairs),
		cmocka_unit_test(a_heap_moves_in_the_same_bits_wherever_boxes_end),
		cmocka_unit_test(a_search_for_pairs_keeps_what_is_known_of_them),
		cmocka_unit_test(a_heap_is_closed_in_the_same_bits_whenever_pairs_are_found),
	};

	return run_tests_of_threads(tests, "closed_in_the_same_bits");
}
