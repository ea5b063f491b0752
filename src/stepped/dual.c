/* SPDX-License-Identifier: MIT */
#include "stepped/dual.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "stepped/blocks.h"

/* Changes of who is at a bound, all at once at first, then one at a time; refinements of each. */
enum { ROUNDS_MAX = 48, ROUNDS_TOGETHER = 8, REFINEMENTS_MAX = 10 };

/*
 * Refinements after which targets are those that agree: a share e of compliance to what a row
 * answers has then become e cubed.
 */
enum { AGREEMENTS = 3 };

/* Blocks that share a body with a block, in the mean: more are not tried. */
enum { NEIGHBOURS_MAX = 96 };

/*
 * Of its diagonal, the pivot up to which a row is redundant: far above rounding and what drift
 * makes of geometry, 1e-15, and below that of a link between two bodies of a million times its
 * mass, 1e-6.
 */
static const double redundant_share = 1e-10;
/*
 * Of its diagonal, what a row gives way by: where rows are redundant but for next to nothing, as
 * those of a chain that is held taut, which sags within the tolerance, drift of second order would
 * else make velocities that are as many times larger. Others drift by this share of what they
 * change in a step, beyond the impulses that they begin with.
 */
static const double compliance_share = 1e-9;
/*
 * Of its diagonal, by how much the factors take a bounded row to give way. Refinement takes it back
 * where that can be: it only makes factors exist for several bounded rows on one coordinate. Where
 * these want different speeds their impulses then grow against each other until all but one of them
 * are at a bound. Several times the share of what is redundant: no row without bounds is taken for
 * one that depends on those with bounds.
 */
static const double damping_share = 5e-10;
/*
 * Of its diagonal, the pivot up to which a row may depend on others: what those give way by is in
 * it.
 */
static const double suspect_share = 1e-6;
/* A refinement that leaves more than this of what was off is the last one. */
static const double progress_share = 0.5;

enum bound { INSIDE, AT_LOW, AT_HIGH };

/* One direction of a row. */
struct unknown {
	int row;
	rb_vec3 along;              /* of its impulse */
	rb_vec3 linear;             /* along, or 0 of couples */
	rb_vec3 torque_a, torque_b; /* of a unit impulse, on a and b */
	rb_vec3 turn_a, turn_b;     /* spin that it makes */
	double diagonal;            /* K_ii, softness, and compliance or damping, 1/kg */
	double compliance;          /* 1/kg */
	bool gives_way;             /* by that, in truth; what holds one way does not */
	enum bound bound;
	/* it holds one way, and others did not let it have what it wants; it is not asked again */
	bool changed, dropped;
	bool is_wrong; /* where it is, as found by the round under way */
};

struct system {
	const struct rb_dual *dual;
	const struct rb_row_system *dense;
	struct unknown *unknown;
	int count;
	int *block, *place; /* [count]: which, and where in it */
	int (*ends)[2];     /* [blocks]: bodies */
	int *first;         /* [blocks + 1]: unknowns */
	int block_count;
	int (*pair)[2]; /* blocks that share a body that yields */
	int pair_count;
	rb_along_across *begun, *was; /* [rows]: impulses as it and as a round began */
	rb_along_across *wanted;      /* [rows]: targets */
	struct rb_solver_body *end;   /* [2 blocks]: as it began */
	struct rb_blocks blocks;
	double *change, *scratch; /* [6 blocks] */
	double *least;            /* [6 blocks] */
	bool stiff;               /* rows are off by what they give way by, too */
};

/* ---- unknowns ---- */

/* Motors, limits and springs are redundant to nothing. */
static bool is_held(const struct rb_constraint *row)
{
	return row->set == RB_CONSTRAINT_FREE ||
	       (row->softness == 0 && isinf(row->low) && isinf(row->high));
}

/* What holds one way, as limits and ropes do: where it holds it is as redundant as what is held. */
static bool holds_one_way(const struct rb_constraint *row)
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
	if (is_held(row) || holds_one_way(row)) {
		u->compliance = compliance_share * u->diagonal;
		u->gives_way = is_held(row);
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

/* Rows of one pair of bodies fill a block as long as they fit into it. */
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

/* ---- which blocks meet ---- */

/* Pairs of blocks by body: blocks sorted by counting; false: too many, or no memory. */
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
	s->begun = rb_arena_take(arena, rows, sizeof *s->begun);
	s->was = rb_arena_take(arena, rows, sizeof *s->was);
	s->wanted = rb_arena_take(arena, rows, sizeof *s->wanted);
	s->end = rb_arena_take(arena, 2 * (size_t)s->block_count, sizeof *s->end);
	s->change = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count, sizeof *s->change);
	s->scratch = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count, sizeof *s->scratch);
	s->least = rb_arena_take(arena, RB_BLOCK * (size_t)s->block_count, sizeof *s->least);
	return s->begun && s->was && s->wanted && s->end && s->change && s->scratch && s->least &&
	       rb_blocks_plan(&s->blocks, s->block_count, (const int(*)[2])s->pair, s->pair_count,
	                      s->dual->max, arena);
}

/* ---- factors ---- */

/* A body that two blocks share: which end it is of either. */
struct shared {
	double inverse_mass;
	bool a_x, a_y;
};

/* Those that yield, in the order of block i's ends; returns their number. */
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

/* K_ij by one body: torques on it, signs of impulses on it. */
static double answer_by(const struct shared *by, const struct unknown *x, const struct unknown *y)
{
	const double sum = by->inverse_mass * rb_vec3_dot(x->linear, y->linear) +
	                   rb_vec3_dot(by->a_x ? x->torque_a : x->torque_b,
	                               by->a_y ? y->turn_a : y->turn_b);

	return by->a_x == by->a_y ? sum : -sum;
}

static double *least_of(const struct system *s, int x)
{
	return &s->least[RB_BLOCK * s->blocks.place[s->block[x]] + s->place[x]];
}

static void fill_block(struct system *s, int i, int j)
{
	bool turned;
	rb_block *const block = rb_blocks_at(&s->blocks, i, j, &turned);
	struct shared shared[2];
	const int count = find_shared(s, i, j, shared);

	for (int x = s->first[i]; x < s->first[i + 1]; x++)
		for (int y = s->first[j]; y < s->first[j + 1]; y++) {
			const struct unknown *of_x = &s->unknown[x], *of_y = &s->unknown[y];
			const int r = turned ? s->place[y] : s->place[x];
			const int c = turned ? s->place[x] : s->place[y];
			double sum = x == y ? of_x->diagonal : 0;

			if (x != y && of_x->bound == INSIDE && of_y->bound == INSIDE)
				for (int e = 0; e < count; e++)
					sum += answer_by(&shared[e], of_x, of_y);
			block->m[r][c] = sum;
		}
	for (int k = s->first[i + 1] - s->first[i]; i == j && k < RB_BLOCK; k++)
		block->m[k][k] = 1;
}

static bool factor(struct system *s)
{
	rb_blocks_clear(&s->blocks);
	memset(s->least, 0, RB_BLOCK * (size_t)s->block_count * sizeof *s->least);
	for (int x = 0; x < s->count; x++)
		*least_of(s, x) = s->unknown[x].compliance > 0
		                          ? (redundant_share + compliance_share) *
		                                    s->unknown[x].diagonal
		                          : 0;
	s->blocks.least = s->least;
	for (int k = 0; k < s->block_count; k++)
		fill_block(s, k, k);
	for (int k = 0; k < s->pair_count; k++)
		fill_block(s, s->pair[k][0], s->pair[k][1]);
	return rb_blocks_factor(&s->blocks);
}

/* ---- refinement ---- */

/* What a row is short of, m/s. */
static double short_of(const struct system *s, const struct unknown *x)
{
	const struct rb_constraint *row = &s->dense->row[x->row];
	const rb_vec3 u = rb_constraint_velocity(&s->dense->bodies, row);
	const rb_vec3 off = rb_vec3_sub(rb_constraint_joined(row, row->target), u);
	const rb_vec3 begun = rb_constraint_joined(row, s->begun[x->row]);

	return rb_vec3_dot(off, x->along) - row->softness * row->impulse.n -
	       (s->stiff || !x->gives_way ? 0 : x->compliance) *
	               rb_vec3_dot(rb_vec3_sub(rb_constraint_impulse(row), begun), x->along);
}

static void give(struct system *s, const struct unknown *x, double impulse)
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

/* Of rows inside their bounds, into `change`; returns the largest but of redundant ones. */
static double residuals(struct system *s)
{
	double max = 0;

	memset(s->change, 0, RB_BLOCK * (size_t)s->block_count * sizeof *s->change);
	for (int k = 0; k < s->count; k++) {
		if (s->unknown[k].bound != INSIDE)
			continue;
		const double off = short_of(s, &s->unknown[k]);

		s->change[RB_BLOCK * s->block[k] + s->place[k]] = off;
		/* written so that NaN stays */
		if (!isinf(*least_of(s, k)))
			max = fabs(off) <= max ? max : fabs(off);
	}
	return max;
}

static void correct(struct system *s)
{
	rb_blocks_solve(&s->blocks, s->change, s->scratch);
	for (int x = 0; x < s->count; x++)
		if (s->unknown[x].bound == INSIDE)
			give(s, &s->unknown[x], s->change[RB_BLOCK * s->block[x] + s->place[x]]);
}

static double refine(struct system *s)
{
	double left = residuals(s);

	for (int k = 0; k < REFINEMENTS_MAX && left > s->dual->tolerance; k++) {
		const double before = left;

		correct(s);
		left = residuals(s);
		if (!(left <= progress_share * before))
			break;
	}
	return left;
}

/* ---- bounds ---- */

/* Impulses, targets, and velocities of what they act on, as it begins. */
static void keep_begin(struct system *s)
{
	const struct rb_row_system *dense = s->dense;

	for (int k = 0; k < dense->row_count; k++) {
		s->begun[k] = dense->row[k].impulse;
		s->wanted[k] = dense->row[k].target;
	}
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			s->end[2 * k + e] = dense->bodies.body[s->ends[k][e]];
}

static void keep_round(struct system *s)
{
	for (int k = 0; k < s->dense->row_count; k++)
		s->was[k] = s->dense->row[k].impulse;
}

/*
 * After a pivot: impulses within bounds go back to those that the round began with, and velocities
 * become what impulses make of them. Those that rows against each other came to were large, and so
 * was their rounding.
 */
static void go_back(struct system *s)
{
	const struct rb_row_system *dense = s->dense;

	for (int k = 0; k < s->count; k++)
		if (s->unknown[k].bound == INSIDE)
			dense->row[s->unknown[k].row].impulse = s->was[s->unknown[k].row];
	for (int k = 0; k < s->block_count; k++)
		for (int e = 0; e < 2; e++)
			/* what does not yield may be shared: not written to */
			if (rb_solver_is_dynamic(&dense->bodies.body[s->ends[k][e]]))
				dense->bodies.body[s->ends[k][e]] = s->end[2 * k + e];
	for (int k = 0; k < dense->row_count; k++) {
		const rb_vec3 begun = rb_constraint_joined(&dense->row[k], s->begun[k]);

		rb_constraint_apply(&dense->bodies, &dense->row[k],
		                    rb_vec3_sub(rb_constraint_impulse(&dense->row[k]), begun));
	}
}

/*
 * Whether an impulse is beyond a bound, or is at one that it should leave. Asked of all before any
 * is changed: where rows against each other come to large impulses, what is at a bound would else
 * be asked amid these.
 */
static bool is_wrong(const struct system *s, const struct unknown *x, double tolerance)
{
	const struct rb_constraint *row = &s->dense->row[x->row];

	if (row->set != RB_CONSTRAINT_INTERVAL)
		return false;
	if (x->bound == INSIDE)
		return row->impulse.n < row->low || row->impulse.n > row->high;
	if (x->dropped || row->low == row->high)
		return false;
	const double off = short_of(s, x);

	return x->bound == AT_LOW ? off > tolerance : off < -tolerance;
}

/* Brings an impulse that is beyond a bound there, or lets one go that should leave it. */
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
	give(s, x, (p < row->low ? row->low : row->high) - p);
	row->impulse.n = x->bound == AT_LOW ? row->low : row->high;
}

static bool pivot_all(struct system *s, bool together, double tolerance)
{
	bool any = false;

	for (int k = 0; k < s->count; k++) {
		s->unknown[k].is_wrong = (together || !any) &&
		                         is_wrong(s, &s->unknown[k], tolerance);
		any = any || s->unknown[k].is_wrong;
	}
	for (int k = 0; k < s->count; k++)
		if (s->unknown[k].is_wrong)
			pivot(s, &s->unknown[k]);
	return any;
}

/* ---- targets ---- */

/* Whether some row may depend on others; the system is factored. */
static bool has_suspects(struct system *s)
{
	for (int x = 0; x < s->count; x++) {
		bool turned;
		const struct unknown *const u = &s->unknown[x];
		const rb_block *const d = rb_blocks_at(&s->blocks, s->block[x], s->block[x],
		                                       &turned);
		const double root = d->m[s->place[x]][s->place[x]];

		if (u->compliance > 0 &&
		    root * root <= suspect_share * s->blocks.scale * u->diagonal)
			return true;
	}
	return false;
}

/*
 * Leaves out motors, friction and springs, and what holds one way but does not now; whether that
 * changes the system.
 */
static bool without_bounded(struct system *s, enum bound *bound)
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

/* A row is to do what it does now. */
static void take_target(struct system *s, const struct unknown *x)
{
	struct rb_constraint *const row = &s->dense->row[x->row];
	const double off = short_of(s, x);

	if (row->set == RB_CONSTRAINT_FREE)
		row->target = rb_constraint_split(
			row,
			rb_vec3_add_scaled(rb_constraint_joined(row, row->target), -off, x->along));
	else
		row->target.n -= off;
}

/*
 * Rows that depend on each other get targets that do not contradict each other: those nearest to
 * what they want. Joints are off by something within the tolerance, and what rows give way by would
 * answer contradictions by forces of joints against each other, a thousand million times larger.
 * Refinement that takes back what rows give way by comes to what can be done, with impulses that
 * are of no use. Which rows depend on which is not asked: it changes as a mechanism moves.
 *
 * What holds one way is among them while it does: a rope beside a rod, or across slides. If it
 * would have to push all the same it is left to what others do.
 */
static bool agree(struct system *s)
{
	enum bound *const bound = rb_arena_take(s->dual->arena, (size_t)s->count, sizeof *bound);
	bool good = bound != NULL;

	if (!good)
		return false;
	const bool fewer = without_bounded(s, bound);
	good = !fewer || factor(s);
	s->stiff = true;
	for (int k = 0; good && k < AGREEMENTS; k++) {
		(void)residuals(s);
		correct(s);
	}
	for (int x = 0; good && x < s->count; x++) {
		struct unknown *const u = &s->unknown[x];

		if (u->bound != INSIDE || isinf(*least_of(s, x)))
			continue;
		take_target(s, u);
		u->changed = holds_one_way(&s->dense->row[u->row]) &&
		             fabs(s->dense->row[u->row].target.n - s->wanted[u->row].n) >
		                     s->dual->tolerance;
	}
	s->stiff = false;
	go_back(s);
	for (int x = 0; x < s->count; x++)
		s->unknown[x].bound = bound[x];
	return good && (!fewer || factor(s));
}

/* Whether targets are to agree anew: what holds one way has come or gone. */
static bool is_to_agree(struct system *s, int round, bool *one_way)
{
	const bool was = *one_way;

	*one_way = false;
	for (int x = 0; x < s->count && !*one_way; x++)
		*one_way = s->unknown[x].bound == INSIDE &&
		           holds_one_way(&s->dense->row[s->unknown[x].row]);
	if (round > 0 && !was && !*one_way)
		return false;
	for (int k = 0; k < s->dense->row_count; k++)
		s->dense->row[k].target = s->wanted[k];
	for (int x = 0; x < s->count; x++)
		s->unknown[x].changed = false;
	return has_suspects(s);
}

struct rb_dual_result rb_dual_solve(const struct rb_dual *dual)
{
	struct rb_dual_result result = {.residual = (double)INFINITY};
	struct system s = {.dual = dual, .dense = dual->dense};
	const rb_arena_mark here = rb_arena_here(dual->arena);

	RB_ASSERT(dual->tolerance > 0);
	if (dual->dense->row_count > 0 && prepare(&s)) {
		bool more = true, one_way = false;

		keep_begin(&s);
		result.tried = true;
		for (int round = 0; more && round < ROUNDS_MAX; round++) {
			result.steps++;
			keep_round(&s);
			if (!factor(&s) || (is_to_agree(&s, round, &one_way) && !agree(&s)) ||
			    rb_interrupt_after(dual->interrupt, (uint64_t)s.blocks.work))
				break;
			const double left = refine(&s);

			more = pivot_all(&s, round < ROUNDS_TOGETHER,
			                 fmax(dual->tolerance, 2 * left));
			result.residual = more ? (double)INFINITY : left;
			if (more)
				go_back(&s);
		}
	}
	rb_arena_back(dual->arena, here);
	return result;
}
