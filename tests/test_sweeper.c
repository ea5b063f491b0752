/* SPDX-License-Identifier: MIT */
/* stepped/sweeper, stepped/wide: what sweeps leave is what was asked for, in packs and one at a time, for any workers. */
#include "stepped/sweeper.h"

#include "stepped/direct.h"
#include "patience.h"
#include "support.h"

#include "math/random.h"

enum { SIDE = 8, LAYERS = 6, BODIES = SIDE * SIDE * LAYERS, ROWS_MOST = 4 * BODIES };

static const double friction = 0.5, step_s = 1.0 / 240;

/* Balls in a lattice on a floor, which touch and move at random: made anew by `make`. */
struct heap {
	struct rb_row_system dense;
	struct rb_solver_body body[BODIES + 1], free[BODIES + 1];
	struct rb_constraint row[ROWS_MOST];
	rb_mat3 tensor[BODIES + 1]; /* of bodies that are no balls */
	int member[BODIES], local[BODIES + 1];
	struct rb_arena arena;
};

static void add_row(struct heap *heap, int a, int b, rb_vec3 normal)
{
	struct rb_constraint *row = &heap->row[heap->dense.row_count];
	const struct rb_solver_body *p = &heap->body[a], *q = &heap->body[b];

	*row = (struct rb_constraint){.a = a,
	                              .b = b,
	                              .central = true,
	                              .normal = normal,
	                              .arm_a = {0.5, 0, 0},
	                              .arm_b = {b < BODIES ? -0.5 : 0, 0, 0},
	                              .friction = friction};
	row->inverse_mass_n = p->inverse_mass + q->inverse_mass;
	row->inverse_mass_t = row->inverse_mass_n +
	                      0.25 * (p->inverse_inertia + q->inverse_inertia);
	heap->dense.row_count++;
}

/* What a body gives way by to a unit impulse along n. */
static double yield_of(const struct heap *heap, int body, rb_vec3 arm, rb_vec3 n)
{
	const rb_vec3 turn = rb_solver_turn(&heap->dense.bodies, body, rb_vec3_cross(arm, n));

	return heap->body[body].inverse_mass + rb_vec3_dot(rb_vec3_cross(turn, arm), n);
}

/* Balls become bodies of three moments that touch beside the lines between their centres. */
static void spoil(struct heap *heap)
{
	static const rb_mat3 inverse = {
		{{0.02, 0.003, 0}, {0.003, 0.03, -0.002}, {0, -0.002, 0.025}}};

	heap->dense.bodies.tensor = heap->tensor;
	for (int i = 0; i < BODIES; i++) {
		heap->tensor[i] = inverse;
		heap->body[i].inverse_inertia = heap->free[i].inverse_inertia = (double)NAN;
	}
	for (int k = 0; k < heap->dense.row_count; k++) {
		struct rb_constraint *row = &heap->row[k];
		const rb_vec3 x = rb_vec3_across(row->normal), y = rb_vec3_cross(row->normal, x);
		const rb_vec3 aside = rb_vec3_add(rb_vec3_scale(0.2 * (k % 3 - 1), x),
		                                  rb_vec3_scale(0.1 * (k % 4), y));

		row->central = false;
		row->arm_a = rb_vec3_add_scaled(aside, 0.5, row->normal);
		row->arm_b = rb_vec3_add_scaled(aside, -0.5, row->normal);
		row->inverse_mass_n = yield_of(heap, row->a, row->arm_a, row->normal) +
		                      yield_of(heap, row->b, row->arm_b, row->normal);
		row->inverse_mass_t = 0;
		for (int e = 0; e < 2; e++) /* no less than the larger */
			row->inverse_mass_t += yield_of(heap, row->a, row->arm_a, e ? x : y) +
			                       yield_of(heap, row->b, row->arm_b, e ? x : y);
	}
}

static struct heap *make(double speed)
{
	struct heap *heap = calloc(1, sizeof *heap);

	assert_non_null(heap);
	heap->dense = (struct rb_row_system){.bodies.body = heap->body, .row = heap->row};
	for (int i = 0; i < BODIES; i++) {
		double v[3];

		for (int k = 0; k < 3; k++)
			v[k] = speed * (2 * rb_random_unit(7, (uint64_t)k, (uint64_t)i) - 1);
		heap->body[i] = (struct rb_solver_body){
			.linear = {v[0], v[1], v[2] - 9.81 * step_s},
			.inverse_mass = 1.0 / 500,
			.inverse_inertia = 1.0 / 50};
		heap->member[i] = i;
	}
	for (int i = 0; i < BODIES; i++) {
		const int x = i % SIDE, y = i / SIDE % SIDE, z = i / (SIDE * SIDE);

		if (x + 1 < SIDE)
			add_row(heap, i, i + 1, (rb_vec3){1, 0, 0});
		if (y + 1 < SIDE)
			add_row(heap, i, i + SIDE, (rb_vec3){0, 1, 0});
		if (z + 1 < LAYERS)
			add_row(heap, i, i + SIDE * SIDE, (rb_vec3){0, 0, 1});
		if (z == 0)
			add_row(heap, i, BODIES, (rb_vec3){0, 0, -1});
	}
	heap->local[BODIES] = -1;
	memcpy(heap->free, heap->body, sizeof heap->free);
	return heap;
}

static void unmake(struct heap *heap)
{
	rb_arena_release(&heap->arena);
	free(heap);
}

static struct rb_sweeper take(struct heap *heap, struct rb_team *team)
{
	struct rb_sweeper sweeper = {.dense = &heap->dense,
	                             .fixed = BODIES,
	                             .member = heap->member,
	                             .member_count = BODIES,
	                             .local = heap->local,
	                             .team = team};

	assert_true(rb_sweeper_take(&sweeper, &heap->arena));
	return sweeper;
}

/* What the rows still ask for at the velocities that their impulses make, m/s; cones are kept. */
static void look_at(const struct heap *heap, double *closing, double *any)
{
	static struct heap again;

	again = *heap;
	again.dense = heap->dense;
	again.dense.bodies.body = again.body;
	again.dense.row = again.row;
	memcpy(again.body, heap->free, sizeof again.body);
	rb_sweep_warm(&again.dense);
	*closing = *any = 0;
	for (int k = 0; k < heap->dense.row_count; k++) {
		const struct rb_constraint *row = &again.row[k];
		const rb_vec3 u = rb_constraint_velocity(&again.dense.bodies, row);
		const double u_n = rb_vec3_dot(u, row->normal);
		const double push = fmax(0, row->impulse.n - u_n / row->inverse_mass_n);
		rb_vec3 friction_impulse = rb_vec3_add_scaled(
			row->impulse.t, -1 / row->inverse_mass_t, rb_vec3_reject(u, row->normal));
		const double size = rb_vec3_length(friction_impulse);

		assert_true(row->impulse.n >= 0);
		assert_true(rb_vec3_length(row->impulse.t) <=
		            friction * row->impulse.n * (1 + 1e-12));
		if (size > friction * push)
			friction_impulse = rb_vec3_scale(friction * push / size, friction_impulse);
		*closing = fmax(*closing, -u_n);
		*any = fmax(*any, fabs(push - row->impulse.n) * row->inverse_mass_n);
		*any = fmax(*any, rb_vec3_length(rb_vec3_sub(friction_impulse, row->impulse.t)) *
		                          row->inverse_mass_t);
	}
	/* bodies are what the impulses make of them, to rounding */
	for (int i = 0; i < BODIES; i++)
		assert_near(rb_vec3_length(rb_vec3_sub(heap->body[i].linear, again.body[i].linear)),
		            0, 1e-12);
}

static void packs_solve_a_heap_that_is_thrown_about(void **slot)
{
	struct heap *heap = make(0.1);
	struct rb_sweeper sweeper = take(heap, NULL);
	double closing, any;

	(void)slot;
	assert_true(sweeper.wide);
	const struct rb_sweep_result result = rb_sweeper_run(&sweeper, 1e-4, 1000);
	assert_true(result.residual <= 1e-4);
	look_at(heap, &closing, &any);
	assert_true(closing < 3e-4);
	assert_true(any < 1e-3);
	unmake(heap);
}

static struct rb_sweep_result run_with(double slack, double tolerance, int max)
{
	struct heap *heap = make(0.1);
	struct rb_sweeper sweeper = take(heap, NULL);

	sweeper.packs.slack = slack;
	const struct rb_sweep_result result = rb_sweeper_run(&sweeper, tolerance, max);
	unmake(heap);
	return result;
}

static void sweeps_that_creep_end_once_they_are_near(void **slot)
{
	(void)slot;
	assert_int_equal(run_with(0, 1e-5, 60).sweeps, 60);
	assert_int_equal(run_with(16, 1e-9, 60).sweeps, 60); /* not far from it */
	const struct rb_sweep_result near = run_with(1000, 1e-5, 60);
	assert_true(near.sweeps < 60 && near.residual > 1e-5 && near.residual <= 1e-2);
}

static void packs_solve_bodies_of_any_shape(void **slot)
{
	struct heap *heap = make(0.1);
	double closing, any;

	(void)slot;
	spoil(heap);
	struct rb_sweeper sweeper = take(heap, NULL);
	assert_true(sweeper.wide && !sweeper.packs.central);
	const struct rb_sweep_result result = rb_sweeper_run(&sweeper, 1e-4, 1000);
	assert_true(result.residual <= 1e-4);
	look_at(heap, &closing, &any);
	assert_true(closing < 5e-4);
	assert_true(any < 2e-3);
	unmake(heap);
}

/* The one solution that there is without friction: the velocities, not the impulses. */
static void packs_of_any_shape_end_where_single_rows_do(void **slot)
{
	struct heap *packs = make(0.1), *rows = make(0.1);
	struct rb_sweep one = {.dense = &rows->dense, .tolerance = 1e-8, .max = 5000};

	(void)slot;
	spoil(packs);
	spoil(rows);
	for (int k = 0; k < rows->dense.row_count; k++)
		packs->row[k].friction = rows->row[k].friction = 0;
	struct rb_sweeper sweeper = take(packs, NULL);
	assert_true(rb_sweeper_run(&sweeper, 1e-8, 5000).residual <= 1e-8);
	assert_true(rb_sweep_take(&one, &rows->arena));
	assert_true(rb_sweep_solve(&one).residual <= 1e-8);
	for (int i = 0; i < BODIES; i++) {
		assert_near(
			rb_vec3_length(rb_vec3_sub(packs->body[i].linear, rows->body[i].linear)), 0,
			1e-6);
		assert_near(
			rb_vec3_length(rb_vec3_sub(packs->body[i].angular, rows->body[i].angular)),
			0, 3e-6);
	}
	unmake(packs);
	unmake(rows);
}

/* Bodies of any shape with one moment of inertia: packs have no tensors, and the same numbers. */
static void packs_of_one_moment_are_as_those_of_its_tensor(void **slot)
{
	struct heap *one = make(0.1), *three = make(0.1);

	(void)slot;
	spoil(one);
	spoil(three);
	for (int i = 0; i < BODIES; i++) {
		three->tensor[i] = rb_mat3_diagonal(0.02, 0.02, 0.02);
		one->body[i].inverse_inertia = one->free[i].inverse_inertia = 0.02;
	}
	struct rb_sweeper of_one = take(one, NULL), of_three = take(three, NULL);
	assert_true(of_one.wide && !of_one.packs.packs[0].tensors &&
	            of_three.packs.packs[0].tensors);
	(void)rb_sweeper_run(&of_one, 0, 50);
	(void)rb_sweeper_run(&of_three, 0, 50);
	for (int i = 0; i < BODIES; i++) {
		const rb_vec3 v = rb_vec3_sub(one->body[i].linear, three->body[i].linear);
		const rb_vec3 w = rb_vec3_sub(one->body[i].angular, three->body[i].angular);

		assert_true(rb_vec3_length(v) == 0 && rb_vec3_length(w) == 0);
	}
	unmake(one);
	unmake(three);
}

/* Velocities are what the impulses make of them, and these are in the cones, to all digits. */
static void assert_whole(const struct heap *heap)
{
	static struct rb_solver_body body[BODIES + 1];
	const struct rb_row_system dense = {.bodies = {.body = body, .tensor = heap->tensor},
	                                    .row = (struct rb_constraint *)heap->row,
	                                    .row_count = heap->dense.row_count};

	memcpy(body, heap->free, sizeof body);
	rb_sweep_warm(&dense);
	for (int i = 0; i < BODIES; i++) {
		const rb_vec3 v = rb_vec3_sub(heap->body[i].linear, body[i].linear);
		const rb_vec3 w = rb_vec3_sub(heap->body[i].angular, body[i].angular);

		/* some forty impulses of less than 1 m/s each */
		assert_true(rb_vec3_length(v) <= 1e-13 && rb_vec3_length(w) <= 1e-12);
	}
	for (int k = 0; k < dense.row_count; k++) {
		const struct rb_constraint *row = &dense.row[k];
		const double across = rb_vec3_length(row->impulse.t);

		assert_true(row->impulse.n >= 0);
		assert_true(across <= row->friction * row->impulse.n * (1 + 1e-14));
		assert_true(fabs(rb_vec3_dot(row->impulse.t, row->normal)) <= 1e-14 * across);
	}
}

/* The tolerance allows for 32 bits: of any masses, and what comes out is whole in 64. */
static void packs_in_32_bits_leave_whole_impulses_of_any_masses(void **slot)
{
	const double unit = ldexp(1, 200), tolerance = 1e-4;
	struct heap *light = make(0.1), *heavy = make(0.1), *close = make(0.1);

	(void)slot;
	spoil(light);
	spoil(heavy);
	spoil(close);
	for (int i = 0; i < BODIES; i++) {
		heavy->body[i].inverse_mass = heavy->free[i].inverse_mass /= unit;
		for (int k = 0; k < 9; k++)
			heavy->tensor[i].m[k / 3][k % 3] /= unit;
	}
	for (int k = 0; k < heavy->dense.row_count; k++) {
		heavy->row[k].inverse_mass_n /= unit;
		heavy->row[k].inverse_mass_t /= unit;
	}
	struct rb_sweeper of_light = take(light, NULL), of_heavy = take(heavy, NULL);
	struct rb_sweeper of_close = take(close, NULL);
	assert_true(rb_sweeper_run(&of_light, tolerance, 1000).residual <= tolerance);
	assert_true(rb_sweeper_run(&of_heavy, tolerance, 1000).residual <= tolerance);
	assert_true(rb_sweeper_run(&of_close, 1e-9, 5000).residual <= 1e-9);
	assert_true(of_light.packs.single && of_heavy.packs.single && !of_close.packs.single);
	assert_whole(light);
	for (int k = 0; k < light->dense.row_count; k++)
		assert_true(heavy->row[k].impulse.n == unit * light->row[k].impulse.n);
	for (int i = 0; i < BODIES; i++) {
		const rb_vec3 v = rb_vec3_sub(light->body[i].linear, close->body[i].linear);

		assert_true(rb_vec3_length(rb_vec3_sub(light->body[i].linear,
		                                       heavy->body[i].linear)) == 0);
		/* errors of all layers add up */
		assert_true(rb_vec3_length(v) <= 10 * LAYERS * tolerance);
	}
	unmake(light);
	unmake(heavy);
	unmake(close);
}

/* The first ball gives no way, as what is not moved while overlaps are closed. */
static struct heap *make_held(int filling)
{
	struct heap *heap = make(0.1);
	const size_t bytes = (size_t)1 << 21;
	int kept = 0;

	/* what has been in its block before is nobody's business */
	for (int k = 0; k < 2; k++) {
		void *before = rb_arena_take(&heap->arena, bytes, 1);

		assert_non_null(before);
		memset(before, filling, bytes);
		rb_arena_reset(&heap->arena);
	}
	spoil(heap);
	heap->body[0] = heap->free[0] = (struct rb_solver_body){.inverse_mass = 0};
	heap->local[0] = -1;
	for (int k = 0; k < heap->dense.row_count; k++) {
		struct rb_constraint *row = &heap->row[k];

		if (row->a == 0 && row->b == BODIES)
			continue;
		heap->row[kept] = *row;
		kept++;
	}
	heap->dense.row_count = kept;
	return heap;
}

static void what_gives_no_way_stands_in_packs_of_32_bits(void **slot)
{
	struct heap *zeros = make_held(0), *others = make_held(0x41);
	struct heap *const both[2] = {zeros, others};

	(void)slot;
	for (int h = 0; h < 2; h++) {
		struct rb_sweeper sweeper = {.dense = &both[h]->dense,
		                             .fixed = BODIES,
		                             .member = both[h]->member + 1,
		                             .member_count = BODIES - 1,
		                             .local = both[h]->local};

		assert_true(rb_sweeper_take(&sweeper, &both[h]->arena));
		assert_true(rb_sweeper_run(&sweeper, 1e-4, 1000).residual <= 1e-4);
		assert_true(sweeper.packs.single);
	}
	for (int i = 0; i < BODIES; i++) {
		const rb_vec3 v = rb_vec3_sub(zeros->body[i].linear, others->body[i].linear);

		assert_true(rb_vec3_length(v) == 0);
	}
	assert_true(rb_vec3_length(zeros->body[0].linear) == 0);
	unmake(zeros);
	unmake(others);
}

/* What does not fit into 32 bits holds all that pushes, as less does, and nothing that does not. */
static void packs_in_32_bits_know_any_friction(void **slot)
{
	const double tolerance = 1e-4;
	struct heap *large = make(0.1), *more = make(0.1);

	(void)slot;
	spoil(large);
	spoil(more);
	for (int k = 0; k < large->dense.row_count; k++) {
		large->row[k].friction = 1e30;
		more->row[k].friction = 1e300;
	}
	struct rb_sweeper of_large = take(large, NULL), of_more = take(more, NULL);
	const struct rb_sweep_result first = rb_sweeper_run(&of_large, tolerance, 100);
	assert_true(rb_sweeper_run(&of_more, tolerance, 100).residual == first.residual);
	assert_true(of_large.packs.single && of_more.packs.single);
	assert_whole(more);
	for (int i = 0; i < BODIES; i++)
		assert_true(rb_vec3_length(
				    rb_vec3_sub(large->body[i].linear, more->body[i].linear)) == 0);
	unmake(large);
	unmake(more);
}

/* A heap of spinning bodies, one of which is light, on a wide floor that turns at this rate. */
static struct heap *make_wide(double rate)
{
	const double light = 64;
	struct heap *heap = make(0.1);

	spoil(heap);
	heap->body[BODIES - 1].inverse_mass *= light; /* the last is above the others */
	for (int k = 0; k < 9; k++)
		heap->tensor[BODIES - 1].m[k / 3][k % 3] *= light;
	for (int i = 0; i < BODIES; i++) {
		heap->body[i].angular = (rb_vec3){0.3, -0.2, 0.4};
		heap->free[i] = heap->body[i];
	}
	heap->body[BODIES].angular = (rb_vec3){0, 0, rate};
	for (int k = 0; k < heap->dense.row_count; k++) {
		struct rb_constraint *row = &heap->row[k];

		row->impulse.n = 0.1 / row->inverse_mass_n;
		if (row->b == BODIES)
			row->arm_b = rb_vec3_add(row->arm_b, (rb_vec3){100, 50, 0});
		if (row->b != BODIES - 1)
			continue;
		row->impulse.n = 0;
		row->inverse_mass_n = yield_of(heap, row->a, row->arm_a, row->normal) +
		                      yield_of(heap, row->b, row->arm_b, row->normal);
		row->inverse_mass_t *= light;
	}
	return heap;
}

/* Speeds count, not the length of an arm that does not turn, nor what is pushed by another body. */
static void wide_floors_and_light_bodies_do_not_ask_for_64_bits(void **slot)
{
	const double tolerance = 1e-4;
	struct heap *heap = make_wide(0), *close = make_wide(0), *turns = make_wide(1);

	(void)slot;
	struct rb_sweeper sweeper = take(heap, NULL), of_close = take(close, NULL);
	struct rb_sweeper of_turns = take(turns, NULL);
	assert_true(rb_sweeper_run(&sweeper, tolerance, 1000).residual <= tolerance);
	assert_true(rb_sweeper_run(&of_close, 1e-6, 5000).residual <= 1e-6);
	(void)rb_sweeper_run(&of_turns, tolerance, 10);
	assert_true(sweeper.packs.single && !of_close.packs.single && !of_turns.packs.single);
	for (int i = 0; i < BODIES; i++)
		/* errors of all layers add up */
		assert_true(
			rb_vec3_length(rb_vec3_sub(heap->body[i].linear, close->body[i].linear)) <=
			10 * LAYERS * tolerance);
	unmake(heap);
	unmake(close);
	unmake(turns);
}

/* Packs stay as the sweeps before have left them, whatever numbers a fresh call would choose. */
static void what_presses_on_goes_on_in_the_same_packs(void **slot)
{
	struct heap *heap = make(0.1);

	(void)slot;
	spoil(heap);
	struct rb_sweeper sweeper = take(heap, NULL);
	(void)rb_sweeper_run(&sweeper, 1e-4, 10);
	assert_true(sweeper.packs.single);
	(void)rb_sweeper_continue_undamped(&sweeper, 1e-9, 10);
	assert_true(sweeper.packs.single);
	unmake(heap);
}

static void packs_carry_a_heap_at_rest_as_single_rows_do(void **slot)
{
	struct heap *packs = make(0), *rows = make(0);
	struct rb_sweeper sweeper = take(packs, NULL);
	struct rb_sweep one = {.dense = &rows->dense, .tolerance = 1e-9, .max = 3000};
	double weight = 0;

	(void)slot;
	assert_true(rb_sweeper_run(&sweeper, 1e-9, 3000).residual <= 1e-9);
	assert_true(rb_sweep_take(&one, &rows->arena));
	assert_true(rb_sweep_solve(&one).residual <= 1e-9);
	for (int i = 0; i < BODIES; i++) {
		assert_near(packs->body[i].linear.z, 0, 1e-7);
		assert_near(rows->body[i].linear.z, 0, 1e-7);
	}
	for (int k = 0; k < packs->dense.row_count; k++)
		if (packs->row[k].b == BODIES)
			weight += packs->row[k].impulse.n;
	assert_near(weight / (BODIES * 500 * 9.81 * step_s), 1, 1e-6);
	unmake(packs);
	unmake(rows);
}

/* Sweeps, then as many more from the impulses that these have left, as in the next step. */
static void sweep_twice(struct heap *heap, struct rb_team *team)
{
	struct rb_sweeper sweeper = take(heap, team);

	(void)rb_sweeper_run(&sweeper, 0, 50);
	memcpy(heap->body, heap->free, sizeof heap->body);
	sweeper.warms = true;
	assert_true(rb_sweeper_take(&sweeper, &heap->arena));
	(void)rb_sweeper_run(&sweeper, 0, 50);
}

static void any_number_of_workers_leaves_the_same_bits(void **slot)
{
	struct rb_error err;

	(void)slot;
	for (int spoilt = 0; spoilt < 2; spoilt++) {
		struct heap *first = make(0.1);

		if (spoilt)
			spoil(first);
		sweep_twice(first, NULL);
		for (int workers = 1; workers <= 3; workers++) {
			struct heap *heap = make(0.1);
			struct rb_team *team;

			if (spoilt)
				spoil(heap);
			assert_ok(rb_team_create(&team, workers, &err));
			sweep_twice(heap, team);
			assert_memory_equal(heap->body, first->body, sizeof heap->body);
			rb_team_destroy(team);
			unmake(heap);
		}
		unmake(first);
	}
}

static void taking_makes_the_velocities_of_the_impulses_if_asked(void **slot)
{
	struct heap *heap = make(0.1), *rows = make(0.1);
	struct rb_sweeper sweeper = take(heap, NULL);

	(void)slot;
	(void)rb_sweeper_run(&sweeper, 0, 5);
	memcpy(heap->body, heap->free, sizeof heap->body);
	memcpy(rows->row, heap->row, sizeof rows->row);
	rb_sweep_warm(&rows->dense);
	assert_true(rb_sweeper_take(&sweeper, &heap->arena));
	assert_memory_equal(heap->body, heap->free, sizeof heap->body);
	sweeper.warms = true;
	assert_true(rb_sweeper_take(&sweeper, &heap->arena));
	assert_memory_equal(heap->body, rows->body, sizeof heap->body);
	unmake(heap);
	unmake(rows);
}

static void holding_closes_no_gap_and_leaves_friction(void **slot)
{
	struct heap *heap = make(0.5);
	struct rb_sweeper sweeper = take(heap, NULL);
	double closing, any;

	(void)slot;
	(void)rb_sweeper_run(&sweeper, 0, 5);
	rb_vec3 *friction_impulse = calloc(ROWS_MOST, sizeof *friction_impulse);
	assert_non_null(friction_impulse);
	for (int k = 0; k < heap->dense.row_count; k++)
		friction_impulse[k] = heap->row[k].impulse.t;
	look_at(heap, &closing, &any);
	assert_true(closing > 1e-3);
	assert_true(rb_sweeper_hold_friction(&sweeper, 1e-6, 1000).residual <= 1e-6);
	look_at(heap, &closing, &any);
	assert_true(closing < 1e-5);
	for (int k = 0; k < heap->dense.row_count; k++)
		assert_near(
			rb_vec3_length(rb_vec3_sub(friction_impulse[k], heap->row[k].impulse.t)), 0,
			1e-9);
	free(friction_impulse);
	unmake(heap);
}

/* More rows on one ball than there are colours. */
static void a_ball_among_many_has_a_tail(void **slot)
{
	enum { AROUND = 150 };
	struct heap *heap = make(0);
	double closing, any;

	(void)slot;
	heap->dense.row_count = 0;
	for (int i = 1; i <= AROUND; i++) {
		const double turn = 2.4 * i, z = 1 - 2 * (i - 0.5) / AROUND;

		add_row(heap, 0, i,
		        (rb_vec3){sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z});
		heap->body[i].linear = rb_vec3_scale(-1, heap->row[i - 1].normal);
	}
	memcpy(heap->free, heap->body, sizeof heap->free);
	struct rb_sweeper sweeper = take(heap, NULL);
	assert_true(sweeper.wide && sweeper.packs.tail);
	assert_true(rb_sweeper_run(&sweeper, 1e-6, 3000).residual <= 1e-6);
	look_at(heap, &closing, &any);
	assert_true(any < 1e-4);
	assert_true(rb_vec3_length(heap->body[1].linear) < 0.01);
	unmake(heap);
}

/*
 * A ball between two walls that are both to be moved away from it. No impulses do that: each sweep adds
 * (0.1 + 0.3) m/s times the mass to both, and the sweeps are alike to rounding, of which a mixture without bounds made
 * 1e15 N s, to which velocities are any: with some directions it was called solved.
 */
static void what_is_squeezed_is_not_called_solved(void **slot)
{
	enum { SWEEPS = 100 };

	(void)slot;
	for (int turn = 0; turn < 8; turn++) {
		struct heap *heap = make(0);
		const rb_vec3 n = {cos(0.1 + turn), sin(0.1 + turn), 0};

		heap->dense.row_count = 0;
		heap->body[0].linear = (rb_vec3){0, 0, 0};
		heap->body[0].inverse_mass = 1.0 / 3;
		add_row(heap, 0, BODIES, n);
		add_row(heap, 0, BODIES, rb_vec3_neg(n));
		heap->row[0].target.n = 0.1;
		heap->row[1].target.n = 0.3;
		struct rb_sweeper sweeper = take(heap, NULL);
		assert_false(sweeper.wide);
		assert_true(rb_sweeper_run(&sweeper, 1e-9, SWEEPS).residual >= 0.2);
		for (int k = 0; k < 2; k++)
			assert_true(heap->row[k].impulse.n <= SWEEPS * 0.4 * 3 * (1 + 1e-9));
		unmake(heap);
	}
}

/* Nor do they take room by rows for what is not begun: of a heap that is most of what there is. */
static void factors_of_too_much_work_change_nothing(void **slot)
{
	struct heap *heap = make(0.1);
	const struct rb_direct direct = {.dense = &heap->dense,
	                                 .free = heap->free,
	                                 .member = heap->member,
	                                 .member_count = BODIES,
	                                 .local = heap->local,
	                                 .tolerance = 1e-6,
	                                 .slip_tolerance = 1e-6,
	                                 .steps_max = 1,
	                                 .max = 1e3,
	                                 .arena = &heap->arena};
	static struct rb_constraint row[ROWS_MOST];
	static struct rb_solver_body body[BODIES + 1];

	(void)slot;
	memcpy(row, heap->row, sizeof row);
	memcpy(body, heap->body, sizeof body);
	assert_false(rb_direct_solve(&direct).tried);
	assert_memory_equal(row, heap->row, sizeof row);
	assert_memory_equal(body, heap->body, sizeof body);
	/* the plan: some numbers for each body, and for each end of a row */
	print_message("%d rows, %zu bytes\n", heap->dense.row_count, heap->arena.high_water);
	assert_true(heap->arena.high_water < 32 * (size_t)heap->dense.row_count + 96 * BODIES);
	unmake(heap);
}

/* What takes long asks as often as its work says whether to go on, and ends when it is told to. */
static void sweeps_and_factors_ask_by_their_work(void **slot)
{
	enum { PACKS, ROWS, FACTORS, WAYS, SWEEPS = 400, STEPS = 8 };

	(void)slot;
	for (int k = 0; k < 2 * WAYS; k++) {
		const int way = k / 2;
		struct patience patience = {.last = k % 2 ? 2 : 0};
		struct rb_interrupt interrupt = {0};
		struct heap *heap = make(0.1);
		double work = 0;
		int done;

		rb_interrupt_begin(&interrupt, count_calls, &patience);
		if (way == PACKS) {
			struct rb_sweeper sweeper = take(heap, NULL);

			sweeper.packs.interrupt = &interrupt;
			done = rb_sweeper_run(&sweeper, 0, SWEEPS).sweeps;
		} else if (way == ROWS) {
			struct rb_sweep one = {
				.dense = &heap->dense, .max = SWEEPS, .interrupt = &interrupt};

			assert_true(rb_sweep_take(&one, &heap->arena));
			done = rb_sweep_solve(&one).sweeps;
		} else {
			const struct rb_direct direct = {.dense = &heap->dense,
			                                 .free = heap->free,
			                                 .member = heap->member,
			                                 .member_count = BODIES,
			                                 .local = heap->local,
			                                 .tolerance = 1e-300,
			                                 .slip_tolerance = 1e-300,
			                                 .steps_max = STEPS,
			                                 .max = 1e9,
			                                 .interrupt = &interrupt,
			                                 .arena = &heap->arena};

			done = rb_direct_solve(&direct).steps;
		}
		work = way == FACTORS ? 2.0 * RB_INTERRUPT_WORK /* far less than one takes */
		                      : (double)heap->dense.row_count * RB_SWEEP_WORK;
		if (patience.last == 0)
			assert_true(done > 3 &&
			            patience.calls >
			                    0.9 * done * fmin(1, work / RB_INTERRUPT_WORK));
		else
			assert_true(patience.calls == 2 &&
			            done <= 2 * RB_INTERRUPT_WORK / work + 2);
		unmake(heap);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(packs_solve_a_heap_that_is_thrown_about),
		cmocka_unit_test(sweeps_that_creep_end_once_they_are_near),
		cmocka_unit_test(packs_solve_bodies_of_any_shape),
		cmocka_unit_test(packs_of_any_shape_end_where_single_rows_do),
		cmocka_unit_test(packs_of_one_moment_are_as_those_of_its_tensor),
		cmocka_unit_test(packs_in_32_bits_leave_whole_impulses_of_any_masses),
		cmocka_unit_test(what_gives_no_way_stands_in_packs_of_32_bits),
		cmocka_unit_test(packs_in_32_bits_know_any_friction),
		cmocka_unit_test(wide_floors_and_light_bodies_do_not_ask_for_64_bits),
		cmocka_unit_test(what_presses_on_goes_on_in_the_same_packs),
		cmocka_unit_test(packs_carry_a_heap_at_rest_as_single_rows_do),
		cmocka_unit_test(any_number_of_workers_leaves_the_same_bits),
		cmocka_unit_test(taking_makes_the_velocities_of_the_impulses_if_asked),
		cmocka_unit_test(holding_closes_no_gap_and_leaves_friction),
		cmocka_unit_test(a_ball_among_many_has_a_tail),
		cmocka_unit_test(what_is_squeezed_is_not_called_solved),
		cmocka_unit_test(factors_of_too_much_work_change_nothing),
		cmocka_unit_test(sweeps_and_factors_ask_by_their_work),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
