/* SPDX-License-Identifier: MIT */
#include "stepped/dual.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "stepped/blocks.h"

/* Rounds of pivoting, all violations at once at first, then one at a time; refinements in each. */
enum { ROUNDS_MAX = 48, ROUNDS_TOGETHER = 8, REFINEMENTS_MAX = 10 };

/* Refinements that make targets consistent: a relative compliance e is then reduced to e cubed. */
enum { CONSISTENCY_PASSES = 3 };

/* Largest mean number of blocks that share a body with a block; more are not tried. */
enum { NEIGHBOURS_MAX = 96 };

/*
 * A row is redundant if its pivot is at most this fraction of its diagonal: far above rounding and
 * the effect of drift on geometry, 1e-15, and below that of a link between two bodies of a million
 * times its mass, 1e-6.
 */
static const double redundant_share = 1e-10;
/*
 * Compliance of a row, relative to its diagonal: where rows are almost redundant, as those of a
 * taut chain, which sags within the tolerance, second-order drift would otherwise be amplified to
 * velocities as many times larger. Other rows drift by this fraction of the change of their
 * impulses in a step.
 */
static const double compliance_share = 1e-9;
/*
 * Damping of a bounded row in the factors, relative to its diagonal. Refinement removes its effect
 * where possible: it only makes the matrix regular with several bounded rows on one coordinate. If
 * these have different target speeds, their impulses then grow against each other until all but one
 * are at a bound. Several times the share of redundancy: no row without bounds is taken for one
 * that depends on bounded rows.
 */
static const double damping_share = 5e-10;
/*
 * A row may depend on others if its pivot is at most this fraction of its diagonal: the others'
 * compliance contributes to it.
 */
static const double dependent_share = 1e-6;
/* Refinement ends if the residual stays above this fraction of the previous one. */
static const double progress_share = 0.5;

enum bound { INSIDE, AT_LOW, AT_HIGH };

/* One direction of a row. */
struct unknown {
	int row;
	rb_vec3 along;              /* direction of its impulse */
	rb_vec3 linear;             /* `along`; 0 for couples */
	rb_vec3 torque_a, torque_b; /* of a unit impulse, on a and b */
	rb_vec3 turn_a, turn_b;     /* spins due to it */
	double diagonal;            /* K_ii, softness, and compliance or damping, 1/kg */
	double compliance;          /* 1/kg */
	/* has that compliance in the solution, too; unilateral rows have not */
	bool is_compliant;
	enum bound bound;
	/*
	 * `changed`: unilateral, and its target was changed for consistency; `dropped`: it left the
	 * active set with that target, and does not return
	 */
	bool changed, dropped;
	bool is_violated; /* violates its bound, or wants to leave it, in this round */
};

struct system {
	const struct rb_dual *dual;
	const struct rb_row_system *dense;
	struct unknown *unknown;
	int count;
	int *block, *place; /* [count]: block, and index in it */
	int (*ends)[2];     /* [blocks]: bodies */
	int *first;         /* [blocks + 1]: unknowns */
	int block_count;
	int (*pair)[2]; /* blocks that share a dynamic body */
	int pair_count;
	/* [rows]: impulses at the start and at the start of a round */
	rb_along_across *initial, *round_start;
	rb_along_across *original_target;    /* [rows]: original targets */
	struct rb_solver_body *initial_body; /* [2 blocks]: bodies at the start */
	struct rb_blocks blocks;
	double *change, *scratch; /* [6 blocks] */
	double *pivot_min;        /* [6 blocks] */
	bool is_rigid;            /* compliance counts as residual */
};

/* ---- unknowns ---- */

/* Whether a row is bilateral and rigid. Motors, limits and springs are never redundant. */
static bool is_bilateral(const struct rb_constraint *row)
{
	return row->set == RB_CONSTRAINT_FREE ||
	       (row->softness == 0 && isinf(row->low) && isinf(row->high));
}

/*
 * Whether a row is unilateral, as limits and ropes are: while active it may be redundant as
 * bilateral rows are.
 */
static bool is_unilateral(const struct rb_constraint *row)
{
	return rb_constraint_side(row) != 0 && isinf(row->high - row->low);
}

static void add_unknown(struct system *s, int row_number, rb_vec3 along)
{
	const struct rb_constraint *row = &s->dense->row[row_number];
	const struct rb_solver_bodies *bodies = &s->dense->bodies;
	struct unknown *u = &s->unknown[s->count++];

	*u = (struct unknown){.row = row_number, .along = along};
	if (row->couple) {
		u->torque_a = u->torque_b = rb_vec3_scale(row->arm_a.x, along);
	} else {
		u->linear = along;
		u->torque_a = rb_vec3_cross(rb_constraint_arm_a(row), along);
		u->torque_b = rb_vec3_cross(rb_constraint_arm_b(row), along);
	}
	if (bodies->body[row->a].inverse_inertia != 0)
		u->turn_a = rb_solver_turn(bodies, row->a, u->torque_a);
	if (bodies->body[row->b].inverse_inertia != 0)
		u->turn_b = rb_solver_turn(bodies, row->b, u->torque_b);
	u->diagonal = row->softness + rb_vec3_dot(u->torque_a, u->turn_a) +
	              rb_vec3_dot(u->torque_b, u->turn_b);
	if (!row->couple)
		u->diagonal += bodies->body[row->a].inverse_mass +
		               bodies->body[row->b].inverse_mass;
	RB_ASSERT_COSTLY(u->diagonal > 0);
	if (is_bilateral(row) || is_unilateral(row)) {
		u->compliance = compliance_share * u->diagonal;
		u->is_compliant = is_bilateral(row);
		u->diagonal += u->compliance;
	} else {
		u->diagonal += damping_share * u->diagonal;
	}
	if (row->set != RB_CONSTRAINT_INTERVAL)
		return;
	u->bound = row->impulse.n > row->low && row->impulse.n < row->high ? INSIDE
	           : row->impulse.n <= row->low                            ? AT_LOW
	                                                                   : AT_HIGH;
}

/* Rows of one pair of bodies share a block as long as they fit. */
static void list_unknowns(struct system *s)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

	for (int k = 0; k < s->dense->row_count; k++) {
		const struct rb_constraint *row = &s->dense->row[k];
		const int size = row->set == RB_CONSTRAINT_FREE ? 3 : 1;
		const int last = s->block_count - 1;

		if (last < 0 || s->ends[last][0] != row->a || s->ends[last][1] != row->b ||
		    s->count - s->first[last] + size > RB_BLOCK) {
			s->ends[s->block_count][0] = row->a;
			s->ends[s->block_count][1] = row->b;
			s->first[s->block_count++] = s->count;
		}
		for (int c = 0; c < size; c++) {
			s->block[s->count] = s->block_count - 1;
			s->place[s->count] = s->count - s->first[s->block_count - 1];
			add_unknown(s, k, size == 3 ? axis[c] : row->normal);
		}
	}
	s->first[s->block_count] = s->count;
}

/* ---- coupled blocks ---- */

/* Lists pairs of blocks by body, by a counting sort; false: too many, or no memory. */
static bool list_pairs(struct system *s, int bodies)
{
	struct rb_arena *arena = s->dual->arena;
	const size_t n = (size_t)bodies + 2;
	int *const first = rb_arena_take(arena, n, sizeof *first);
	int *const of = rb_arena_take(arena, 2 * (size_t)s->block_count, sizeof *of);
	size_t pairs = 0;

	if (!first || !of)
		return false;
	memset(first, 0, n * sizeof *first);
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			if (rb_solver_is_dynamic(&s->dense->bodies.body[s->ends[k][e]]))
				first[s->ends[k][e] + 2]++;
	for (size_t i = 2; i < n; i++) {
		pairs += (size_t)first[i] * (size_t)first[i];
		first[i] += first[i - 1];
	}
	if (pairs > (size_t)NEIGHBOURS_MAX * (size_t)s->block_count)
		return false;
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			if (rb_solver_is_dynamic(&s->dense->bodies.body[s->ends[k][e]]))
				of[first[s->ends[k][e] + 1]++] = k;
	s->pair = rb_arena_take(arena, pairs + 1, sizeof *s->pair);
	for (int i = 0; s->pair && i < bodies; i++)
		for (int x = first[i]; x < first[i + 1]; x++)
			for (int y = x + 1; y < first[i + 1]; y++) {
				s->pair[s->pair_count][0] = of[x];
				s->pair[s->pair_count++][1] = of[y];
			}
	return s->pair != NULL;
}

static bool prepare(struct system *s)
{
	struct rb_arena *arena = s->dual->arena;
	const size_t rows = (size_t)s->dense->row_count, n = 3 * rows;
	int bodies = 0;

	s->unknown = rb_arena_take(arena, n, sizeof *s->unknown);
	s->block = rb_arena_take(arena, n, sizeof *s->block);
	s->place = rb_arena_take(arena, n, sizeof *s->place);
	s->ends = rb_arena_take(arena, rows, sizeof *s->ends);
	s->first = rb_arena_take(arena, rows + 1, sizeof *s->first);
	if (!s->unknown || !s->block || !s->place || !s->ends || !s->first)
		return false;
	list_unknowns(s);
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			bodies = s->ends[k][e] >= bodies ? s->ends[k][e] + 1 : bodies;
	if (!list_pairs(s, bodies))
		return false;
	s->initial = rb_arena_take(arena, rows, sizeof *s->initial);
	s->round_start = rb_arena_take(arena, rows, sizeof *s->round_start);
	s->original_target = rb_arena_take(arena, rows, sizeof *s->original_target);
	s->initial_body = rb_arena_take(arena, 2 * (size_t)s->block_count, sizeof *s->initial_body);
	s->change = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count, sizeof *s->change);
	s->scratch = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count, sizeof *s->scratch);
	s->pivot_min = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count,
	                             sizeof *s->pivot_min);
	return s->initial && s->round_start && s->original_target && s->initial_body && s->change &&
	       s->scratch && s->pivot_min &&
	       rb_blocks_plan(&s->blocks, s->block_count, (const int(*)[2])s->pair, s->pair_count,
	                      s->dual->max, arena);
}

/* ---- factors ---- */

/* A body that two blocks share; which end it is in each. */
struct shared {
	double inverse_mass;
	bool is_a_of_x, is_a_of_y;
};

/*
 * Finds the dynamic bodies that blocks share, in the order of block i's ends; returns their number.
 */
static int find_shared(const struct system *s, int i, int j, struct shared shared[2])
{
	int count = 0;

	for (int e = 0; e < 2; e++) {
		const int body = s->ends[i][e];
		const struct rb_solver_body *const of = &s->dense->bodies.body[body];

		if ((s->ends[j][0] == body || s->ends[j][1] == body) && rb_solver_is_dynamic(of))
			shared[count++] = (struct shared){of->inverse_mass, e == 0,
			                                  s->ends[j][0] == body};
	}
	return count;
}

/* K_ij through one body. */
static double response_by(const struct shared *by, const struct unknown *x, const struct unknown *y)
{
	const double sum = by->inverse_mass * rb_vec3_dot(x->linear, y->linear) +
	                   rb_vec3_dot(by->is_a_of_x ? x->torque_a : x->torque_b,
	                               by->is_a_of_y ? y->turn_a : y->turn_b);

	return by->is_a_of_x == by->is_a_of_y ? sum : -sum;
}

static double *pivot_min_of(const struct system *s, int x)
{
	return &s->pivot_min[RB_BLOCK * s->blocks.place[s->block[x]] + s->place[x]];
}

static void fill_block(struct system *s, int i, int j)
{
	bool transposed;
	rb_block *const block = rb_blocks_at(&s->blocks, i, j, &transposed);
	struct shared shared[2];
	const int count = find_shared(s, i, j, shared);

	for (int x = s->first[i]; x < s->first[i + 1]; x++)
		for (int y = s->first[j]; y < s->first[j + 1]; y++) {
			const struct unknown *of_x = &s->unknown[x], *of_y = &s->unknown[y];
			const int r = transposed ? s->place[y] : s->place[x];
			const int c = transposed ? s->place[x] : s->place[y];
			double sum = x == y ? of_x->diagonal : 0;

			if (x != y && of_x->bound == INSIDE && of_y->bound == INSIDE)
				for (int e = 0; e < count; e++)
					sum += response_by(&shared[e], of_x, of_y);
			block->m[r][c] = sum;
		}
	for (int k = s->first[i + 1] - s->first[i]; i == j && k < RB_BLOCK; k++)
		block->m[k][k] = 1;
}

static bool factor(struct system *s)
{
	rb_blocks_clear(&s->blocks);
	memset(s->pivot_min, 0, RB_BLOCK * (size_t)s->block_count * sizeof *s->pivot_min);
	for (int x = 0; x < s->count; x++)
		*pivot_min_of(s, x) = s->unknown[x].compliance > 0
		                              ? (redundant_share + compliance_share) *
		                                        s->unknown[x].diagonal
		                              : 0;
	s->blocks.pivot_min = s->pivot_min;
	for (int k = 0; k < s->block_count; k++)
		fill_block(s, k, k);
	for (int k = 0; k < s->pair_count; k++)
		fill_block(s, s->pair[k][0], s->pair[k][1]);
	return rb_blocks_factor(&s->blocks);
}

/* ---- refinement ---- */

/* Residual of a row, target minus velocity, m/s. */
static double residual_of(const struct system *s, const struct unknown *x)
{
	const struct rb_constraint *row = &s->dense->row[x->row];
	const rb_vec3 u = rb_constraint_velocity(&s->dense->bodies, row);
	const rb_vec3 off = rb_vec3_sub(rb_constraint_joined(row, row->target), u);
	const rb_vec3 initial = rb_constraint_joined(row, s->initial[x->row]);

	return rb_vec3_dot(off, x->along) - row->softness * row->impulse.n -
	       (s->is_rigid || !x->is_compliant ? 0 : x->compliance) *
	               rb_vec3_dot(rb_vec3_sub(rb_constraint_impulse(row), initial), x->along);
}

static void add_impulse(struct system *s, const struct unknown *x, double impulse)
{
	struct rb_constraint *row = &s->dense->row[x->row];
	const rb_vec3 more = rb_vec3_scale(impulse, x->along);

	if (row->set == RB_CONSTRAINT_FREE) {
		const rb_along_across parts = rb_constraint_split(row, more);

		row->impulse.n += parts.n;
		row->impulse.t = rb_vec3_add(row->impulse.t, parts.t);
	} else {
		row->impulse.n += impulse;
	}
	rb_constraint_apply(&s->dense->bodies, row, more);
}

/*
 * Residuals of rows inside their bounds, into `change`; returns the largest one of non-redundant
 * rows.
 */
static double residuals(struct system *s)
{
	double max = 0;

	memset(s->change, 0, RB_BLOCK * (size_t)s->block_count * sizeof *s->change);
	for (int k = 0; k < s->count; k++) {
		if (s->unknown[k].bound != INSIDE)
			continue;
		const double off = residual_of(s, &s->unknown[k]);

		s->change[RB_BLOCK * s->block[k] + s->place[k]] = off;
		/* written so that NaN is kept */
		if (!isinf(*pivot_min_of(s, k)))
			max = fabs(off) <= max ? max : fabs(off);
	}
	return max;
}

static void correct(struct system *s)
{
	rb_blocks_solve(&s->blocks, s->change, s->scratch);
	for (int x = 0; x < s->count; x++)
		if (s->unknown[x].bound == INSIDE)
			add_impulse(s, &s->unknown[x],
			            s->change[RB_BLOCK * s->block[x] + s->place[x]]);
}

static double refine(struct system *s)
{
	double residual = residuals(s);

	for (int k = 0; k < REFINEMENTS_MAX && residual > s->dual->tolerance; k++) {
		const double before = residual;

		correct(s);
		residual = residuals(s);
		if (!(residual <= progress_share * before))
			break;
	}
	return residual;
}

/* ---- bounds ---- */

/* Saves impulses, targets, and velocities of the bodies involved. */
static void save_start(struct system *s)
{
	const struct rb_row_system *dense = s->dense;

	for (int k = 0; k < dense->row_count; k++) {
		s->initial[k] = dense->row[k].impulse;
		s->original_target[k] = dense->row[k].target;
	}
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			s->initial_body[2 * k + e] = dense->bodies.body[s->ends[k][e]];
}

static void save_round(struct system *s)
{
	for (int k = 0; k < s->dense->row_count; k++)
		s->round_start[k] = s->dense->row[k].impulse;
}

/*
 * After a pivot: impulses inside their bounds are reset to the start of the round, and velocities
 * recomputed from the impulses. Rows acting against each other had large impulses, and so large
 * rounding errors.
 */
static void restore_round(struct system *s)
{
	const struct rb_row_system *dense = s->dense;

	for (int k = 0; k < s->count; k++)
		if (s->unknown[k].bound == INSIDE)
			dense->row[s->unknown[k].row].impulse = s->round_start[s->unknown[k].row];
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			/* static bodies may be shared: not written to */
			if (rb_solver_is_dynamic(&dense->bodies.body[s->ends[k][e]]))
				dense->bodies.body[s->ends[k][e]] = s->initial_body[2 * k + e];
	for (int k = 0; k < dense->row_count; k++) {
		const rb_vec3 initial = rb_constraint_joined(&dense->row[k], s->initial[k]);

		rb_constraint_apply(&dense->bodies, &dense->row[k],
		                    rb_vec3_sub(rb_constraint_impulse(&dense->row[k]), initial));
	}
}

/*
 * Whether an impulse is beyond a bound, or at one that it should leave. Evaluated for all rows
 * before any is changed: where rows act against each other with large impulses, rows at a bound
 * would otherwise be judged amid these.
 */
static bool is_violated(const struct system *s, const struct unknown *x, double tolerance)
{
	const struct rb_constraint *row = &s->dense->row[x->row];

	if (row->set != RB_CONSTRAINT_INTERVAL)
		return false;
	if (x->bound == INSIDE)
		return row->impulse.n < row->low || row->impulse.n > row->high;
	if (x->dropped || row->low == row->high)
		return false;
	const double off = residual_of(s, x);

	return x->bound == AT_LOW ? off > tolerance : off < -tolerance;
}

/* Sets an impulse that is beyond a bound to the bound, or releases one that should leave it. */
static void pivot(struct system *s, struct unknown *x)
{
	struct rb_constraint *row = &s->dense->row[x->row];
	const double p = row->impulse.n;

	if (x->bound != INSIDE) {
		x->bound = INSIDE;
		return;
	}
	x->dropped = x->changed;
	x->bound = p < row->low ? AT_LOW : AT_HIGH;
	add_impulse(s, x, (p < row->low ? row->low : row->high) - p);
	row->impulse.n = x->bound == AT_LOW ? row->low : row->high;
}

static bool pivot_all(struct system *s, bool together, double tolerance)
{
	bool any = false;

	for (int k = 0; k < s->count; k++) {
		s->unknown[k].is_violated = (together || !any) &&
		                            is_violated(s, &s->unknown[k], tolerance);
		any = any || s->unknown[k].is_violated;
	}
	for (int k = 0; k < s->count; k++)
		if (s->unknown[k].is_violated)
			pivot(s, &s->unknown[k]);
	return any;
}

/* ---- targets ---- */

/* Whether a row may depend on others; the system is factored. */
static bool has_dependent_rows(struct system *s)
{
	for (int x = 0; x < s->count; x++) {
		bool transposed;
		const struct unknown *const u = &s->unknown[x];
		const rb_block *const d = rb_blocks_at(&s->blocks, s->block[x], s->block[x],
		                                       &transposed);
		const double root = d->m[s->place[x]][s->place[x]];

		if (u->compliance > 0 &&
		    root * root <= dependent_share * s->blocks.scale * u->diagonal)
			return true;
	}
	return false;
}

/*
 * Deactivates motors, friction, springs, and inactive unilateral rows; returns whether that changes
 * the system.
 */
static bool exclude_bounded(struct system *s, enum bound *bound)
{
	bool any = false;

	for (int x = 0; x < s->count; x++) {
		struct unknown *const u = &s->unknown[x];

		bound[x] = u->bound;
		if (u->compliance > 0)
			continue;
		any = any || u->bound == INSIDE;
		u->bound = AT_LOW;
	}
	return any;
}

/* Sets the target of a row to its present velocity. */
static void target_present(struct system *s, const struct unknown *x)
{
	struct rb_constraint *const row = &s->dense->row[x->row];
	const double off = residual_of(s, x);

	if (row->set == RB_CONSTRAINT_FREE)
		row->target = rb_constraint_split(
			row,
			rb_vec3_add_scaled(rb_constraint_joined(row, row->target), -off, x->along));
	else
		row->target.n -= off;
}

/*
 * Replaces targets of rows that depend on each other by the nearest consistent ones. Joints have
 * errors within the tolerance, and the rows' compliance would answer contradictory targets by
 * self-stress of joints, 1e9 times larger. Refinement that removes the compliance converges to
 * feasible velocities, with impulses that are meaningless. Dependent rows are not identified: they
 * change as a mechanism moves.
 *
 * Unilateral rows are included while they are active: a rope beside a rod, or across slides. If one
 * would have to push after all, it is left to the others.
 */
static bool make_consistent(struct system *s)
{
	enum bound *const bound = rb_arena_take(s->dual->arena, (size_t)s->count, sizeof *bound);
	bool good = bound != NULL;

	if (!good)
		return false;
	const bool is_changed = exclude_bounded(s, bound);
	good = !is_changed || factor(s);
	s->is_rigid = true;
	for (int k = 0; good && k < CONSISTENCY_PASSES; k++) {
		(void)residuals(s);
		correct(s);
	}
	for (int x = 0; good && x < s->count; x++) {
		struct unknown *const u = &s->unknown[x];

		if (u->bound != INSIDE || isinf(*pivot_min_of(s, x)))
			continue;
		target_present(s, u);
		u->changed = is_unilateral(&s->dense->row[u->row]) &&
		             fabs(s->dense->row[u->row].target.n - s->original_target[u->row].n) >
		                     s->dual->tolerance;
	}
	s->is_rigid = false;
	restore_round(s);
	for (int x = 0; x < s->count; x++)
		s->unknown[x].bound = bound[x];
	return good && (!is_changed || factor(s));
}

/*
 * Whether targets are to be made consistent again: unilateral rows have become active or inactive.
 * Restores the original targets then.
 */
static bool needs_consistency(struct system *s, int round, bool *one_way)
{
	const bool had_one_way = *one_way;

	*one_way = false;
	for (int x = 0; x < s->count && !*one_way; x++)
		*one_way = s->unknown[x].bound == INSIDE &&
		           is_unilateral(&s->dense->row[s->unknown[x].row]);
	if (round > 0 && !had_one_way && !*one_way)
		return false;
	for (int k = 0; k < s->dense->row_count; k++)
		s->dense->row[k].target = s->original_target[k];
	for (int x = 0; x < s->count; x++)
		s->unknown[x].changed = false;
	return has_dependent_rows(s);
}

struct rb_dual_result rb_dual_solve(const struct rb_dual *dual)
{
	struct rb_dual_result result = {.residual = (double)INFINITY};
	struct system s = {.dual = dual, .dense = dual->dense};
	const rb_arena_mark here = rb_arena_here(dual->arena);

	RB_ASSERT(dual->tolerance > 0);
	if (dual->dense->row_count > 0 && prepare(&s)) {
		bool more = true, one_way = false;

		save_start(&s);
		result.tried = true;
		for (int round = 0; more && round < ROUNDS_MAX; round++) {
			result.steps++;
			save_round(&s);
			if (!factor(&s) ||
			    (needs_consistency(&s, round, &one_way) && !make_consistent(&s)) ||
			    rb_interrupt_after(dual->interrupt, (uint64_t)s.blocks.work))
				break;
			const double residual = refine(&s);

			more = pivot_all(&s, round < ROUNDS_TOGETHER,
			                 fmax(dual->tolerance, 2 * residual));
			result.residual = more ? (double)INFINITY : residual;
			if (more)
				restore_round(&s);
		}
	}
	rb_arena_back(dual->arena, here);
	return result;
}
