/* SPDX-License-Identifier: MIT */
#include "stepped/wide.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

#include "base/error.h"

/* Most packs in one block: several times the work of distributing it to threads. */
enum { BLOCK_CENTRAL_PACKS = 32, BLOCK_PACKS = 12 };

/*
 * Largest fraction of its last change by which a row is extrapolated, initially: with more, sliding
 * rows oscillate. Undamped: to the end.
 */
static const double momentum_first = 0.98, momentum_undamped = 0.995;

/*
 * Sweeps after which momentum is reduced, unless the largest change has fallen to this fraction
 * meanwhile. If it stays the same so many times in succession, impulses creep indefinitely.
 */
enum { SWEEPS_WATCHED = 24, SAME_MAX = 4 };
static const double fall_share = 0.9, damping_growth = 1.5, same_share = 0.01;

/* Sweeps over which the rate of convergence is measured. */
enum { SWEEPS_COMPARED = 8 };

/*
 * So many roundings in 32 bits, of the largest speed or impulse, are within the tolerance: a row is
 * swept some hundred times, and they are of either sign.
 */
static const double single_roundings = 256;

/*
 * Rows from which on packs in 32 bits are half as many. Fewer may be a stack, which comes to rest
 * only if it is solved closely.
 */
enum { SINGLE_ROWS = 512 };

/* ---- packs, by blocks ---- */

/* Rows of this colour share bodies: each has a pack of its own, and all are one block. */
static bool is_tail(const struct rb_wide *wide, int colour)
{
	return wide->tail && colour == wide->colour_count - 1;
}

static int width_of(const struct rb_wide *wide, const struct rb_packs *packs, int colour)
{
	return is_tail(wide, colour) ? 1 : packs->kernel->width;
}

struct work {
	const struct rb_wide *wide;
	const struct rb_packs *packs;
	enum rb_pack_task task;
	double momentum; /* of sweeps: first extrapolates by up to this fraction; 0: solves only */
};

/*
 * Loads or stores packs; the rows of a pack are those of its colour from `at` on, as far as there
 * are.
 */
static void transfer_packs(const struct work *work, int colour, int first, int end)
{
	const struct rb_wide *const wide = work->wide;
	const struct rb_packs *const packs = work->packs;
	const int width = width_of(wide, packs, colour);

	for (int k = first; k < end; k++) {
		const int at = wide->colour[colour] + width * (k - packs->first[colour]);
		const int remaining = wide->colour[colour + 1] - at;

		packs->kernel->transfer(wide, packs, work->task, k, at,
		                        remaining < width ? remaining : width);
	}
}

static double larger(double a, double b)
{
	return a > b ? a : b;
}

/* Maximum with the absolute coordinates of v: without branches, which follow no pattern here. */
static double larger_of(double a, rb_vec3 v)
{
	return larger(larger(a, fabs(v.x)), larger(fabs(v.y), fabs(v.z)));
}

/* Packs of a colour. */
static int packs_of(const struct rb_packs *packs, int colour)
{
	return packs->first[colour + 1] - packs->first[colour];
}

/*
 * Blocks of a colour: one, or an even number of about equal length, or threads would wait for the
 * one with the last of three, or the longer of two.
 */
static int blocks_of(const struct rb_wide *wide, const struct rb_packs *packs, int colour)
{
	const int max = wide->central ? BLOCK_CENTRAL_PACKS : BLOCK_PACKS;
	const int count = packs_of(packs, colour), least = (count + max - 1) / max;

	return is_tail(wide, colour) ? count > 0 : least <= 1 ? least : least + least % 2;
}

/* The first pack of a block of a colour. */
static int first_of(const struct rb_packs *packs, int colour, int block)
{
	const int blocks = packs->first_block[colour + 1] - packs->first_block[colour];

	return packs->first[colour] + (int)((int64_t)packs_of(packs, colour) * block / blocks);
}

static void run_colour(const struct work *work, int c, int block, double momentum)
{
	const struct rb_packs *const packs = work->packs;
	const int first = first_of(packs, c, block), end = first_of(packs, c, block + 1);

	if (work->task != RB_PACK_SWEEP) {
		transfer_packs(work, c, first, end);
		return;
	}
	const double change = packs->kernel->run(work->wide, packs, momentum, first, end);
	if (momentum == 0)
		packs->partial[packs->first_block[c] + block] = change;
}

/*
 * A phase is a colour, or several successive ones of one block each, between which threads need not
 * synchronize: phases that extrapolate come first, if any.
 */
static void run_block(void *user, int phase, int block, int worker)
{
	const struct work *work = user;
	const struct rb_packs *const packs = work->packs;
	const bool extrapolates = work->momentum > 0 && phase < packs->phase_count;
	const int p = work->momentum > 0 && !extrapolates ? phase - packs->phase_count : phase;

	(void)worker;
	for (int c = packs->phase[p]; c < packs->phase[p + 1]; c++)
		run_colour(work, c, block, extrapolates ? work->momentum : 0);
}

static void run_all(const struct rb_wide *wide, const struct rb_packs *packs,
                    enum rb_pack_task task, double momentum)
{
	struct work work = {.wide = wide, .packs = packs, .task = task, .momentum = momentum};
	const int phases = (momentum > 0 ? 2 : 1) * packs->phase_count;

	if (wide->team)
		rb_team_run_phases(wide->team, packs->blocks, phases, run_block, &work);
	else
		for (int p = 0; p < phases; p++)
			for (int b = 0; b < packs->blocks[p]; b++)
				run_block(&work, p, b, 0);
}

/*
 * Extrapolates, if `momentum` is positive, and solves all rows; returns the largest change of a
 * row's velocity, m/s.
 */
static double sweep_all(const struct rb_wide *wide, const struct rb_packs *packs, double momentum)
{
	double max = 0;

	run_all(wide, packs, RB_PACK_SWEEP, momentum);
	for (int b = 0; b < packs->first_block[wide->colour_count]; b++)
		max = larger(max, packs->partial[b]);
	return sqrt(max) / packs->per_speed;
}

size_t rb_wide_row_bytes(bool central, bool tensors)
{
	const struct rb_pack_kernel *const kernel = &rb_pack_double; /* the larger ones */
	const size_t bytes = kernel->pack_bytes + (central ? 0 : kernel->turn_bytes) +
	                     (!central && tensors ? kernel->tensors_bytes : 0);

	return bytes / (size_t)kernel->width;
}

/* Whether a body of a row has an inertia tensor that is not scalar. */
static bool has_tensors(const struct rb_row_system *dense)
{
	const struct rb_solver_body *const body = dense->bodies.body;
	bool any = false;

	for (int k = 0; dense->bodies.tensor && k < dense->row_count && !any; k++)
		any = isnan(body[dense->row[k].a].inverse_inertia) ||
		      isnan(body[dense->row[k].b].inverse_inertia);
	return any;
}

/* Groups colours into phases, once their blocks are known. */
static void group_phases(const struct rb_wide *wide, struct rb_packs *packs)
{
	int count = 0;

	for (int c = 0; c < wide->colour_count; c++) {
		const int blocks = packs->first_block[c + 1] - packs->first_block[c];
		const bool continues = count > 0 && blocks == 1 && packs->blocks[count - 1] == 1;

		if (continues)
			continue;
		packs->phase[count] = c;
		packs->blocks[count++] = blocks;
	}
	packs->phase[count] = wide->colour_count;
	packs->phase_count = count;
	memcpy(packs->blocks + count, packs->blocks, (size_t)count * sizeof *packs->blocks);
}

/* Plans packs by colour, without memory for them. */
static bool plan_packs(const struct rb_wide *wide, const struct rb_pack_kernel *kernel,
                       struct rb_packs *packs, struct rb_arena *arena)
{
	const size_t colours = (size_t)wide->colour_count;
	int count = 0, blocks = 0;

	*packs = (struct rb_packs){
		.kernel = kernel,
		.first = rb_arena_take(arena, colours + 1, sizeof *packs->first),
		.first_block = rb_arena_take(arena, colours + 1, sizeof *packs->first_block),
		.phase = rb_arena_take(arena, colours + 1, sizeof *packs->phase),
		.blocks = rb_arena_take(arena, 2 * colours, sizeof *packs->blocks),
		.per_mass = 1,
		.per_length = 1,
		.per_speed = 1};
	if (!packs->first || !packs->first_block || !packs->phase || !packs->blocks)
		return false;
	for (int c = 0; c < wide->colour_count; c++) {
		const int width = width_of(wide, packs, c);
		const int more = (wide->colour[c + 1] - wide->colour[c] + width - 1) / width;

		packs->first[c] = count;
		packs->first[c + 1] = count + more;
		packs->first_block[c] = blocks;
		blocks += blocks_of(wide, packs, c);
		count += more;
	}
	packs->first[colours] = count;
	packs->first_block[colours] = blocks;
	group_phases(wide, packs);
	packs->partial = rb_arena_take(arena, (size_t)blocks, sizeof *packs->partial);
	return packs->partial != NULL;
}

/*
 * Takes memory of so many bytes per pack of 64 bits, or of 32: only one kind is in use at a time.
 */
static void *take_either(const struct rb_wide *wide, size_t double_bytes, size_t single_bytes,
                         struct rb_arena *arena)
{
	const struct rb_packs *const packs = wide->packs;
	const int colours = wide->colour_count;
	const size_t first = (size_t)packs[0].first[colours] * double_bytes;
	const size_t second = packs[1].first ? (size_t)packs[1].first[colours] * single_bytes : 0;

	return rb_arena_take(arena, first > second ? first : second, 1);
}

bool rb_wide_take(struct rb_wide *wide, struct rb_arena *arena)
{
	const struct rb_pack_kernel *const one = &rb_pack_double, *const other = &rb_pack_single;
	struct rb_packs *const packs = wide->packs, *const single = &packs[1];
	/* packs of spheres are small */
	const bool both = !wide->central && wide->dense->row_count >= SINGLE_ROWS;

	wide->single = false;
	*single = (struct rb_packs){0};
	if (!plan_packs(wide, one, &packs[0], arena) ||
	    (both && !plan_packs(wide, other, single, arena)))
		return false;
	const bool tensors = !wide->central && has_tensors(wide->dense);
	packs->pack = take_either(wide, one->pack_bytes, other->pack_bytes, arena);
	if (!wide->central)
		packs->turn = take_either(wide, one->turn_bytes, other->turn_bytes, arena);
	if (tensors)
		packs->tensors = take_either(wide, one->tensors_bytes, other->tensors_bytes, arena);
	if (!packs->pack || (!wide->central && !packs->turn) || (tensors && !packs->tensors))
		return false;
	if (!both)
		return true;
	single->pack = packs->pack;
	single->turn = packs->turn;
	single->tensors = packs->tensors;
	single->body = rb_arena_take(arena, (size_t)wide->fixed + 1, sizeof *single->body);
	return single->body != NULL;
}

/* ---- 32 bits ---- */

/* Power of two that scales x to [1, 2); 1 if there is none. */
static double unit_of(double x)
{
	return x > 0 && isfinite(x) ? ldexp(1, -ilogb(x)) : 1;
}

/* Speed of a body's point by its spin, squared, m^2/s^2. */
static double spin_square(const struct rb_wide *wide, int body, rb_vec3 arm)
{
	const rb_vec3 spin = wide->dense->bodies.body[body].angular;

	return rb_vec3_dot(spin, spin) * rb_vec3_dot(arm, arm);
}

/* Powers of two near the largest values of the rows. */
static void choose_units(const struct rb_wide *wide, struct rb_packs *packs, double tolerance)
{
	double arm = 0, inverse_mass = 0;

	for (int k = 0; k < wide->dense->row_count; k++) {
		const struct rb_constraint *const row = &wide->dense->row[k];

		arm = larger_of(larger_of(arm, row->arm_a), row->arm_b);
		inverse_mass = larger(inverse_mass, row->inverse_mass_n);
	}
	packs->per_mass = 1 / unit_of(inverse_mass);
	packs->per_length = unit_of(arm);
	packs->per_speed = unit_of(tolerance);
}

/*
 * Whether 32 bits resolve the tolerance at the largest speeds, and changes of speed by an impulse.
 * Each row for itself: the arm of a wall may be as long as it is wide, and the lightest body need
 * not bear the largest impulse. Units are chosen with the first packs.
 */
static bool may_be_single(const struct rb_wide *wide, struct rb_packs *packs, double tolerance)
{
	double speed = 0, square = 0;

	if (!packs->filled)
		choose_units(wide, packs, tolerance);
	for (int k = 0; k < wide->member_count; k++)
		speed = larger_of(speed, wide->dense->bodies.body[wide->member[k]].linear);
	for (int k = 0; k < wide->dense->row_count; k++) {
		const struct rb_constraint *const row = &wide->dense->row[k];

		speed = larger_of(larger(speed, row->impulse.n * row->inverse_mass_n),
		                  rb_vec3_scale(row->inverse_mass_t, row->impulse.t));
		square = larger(square, larger(spin_square(wide, row->a, row->arm_a),
		                               spin_square(wide, row->b, row->arm_b)));
	}
	return single_roundings * (double)FLT_EPSILON * larger(speed, sqrt(square)) <= tolerance;
}

static void convert_body(const struct rb_wide *wide, const struct rb_packs *packs, int i)
{
	const struct rb_solver_body *const body = &wide->dense->bodies.body[i];
	const double turning = packs->per_speed / packs->per_length;
	const double inertia = 1 / (packs->per_mass * packs->per_length * packs->per_length);
	float *const to = packs->body[i];

	to[0] = (float)(packs->per_speed * body->linear.x);
	to[1] = (float)(packs->per_speed * body->linear.y);
	to[2] = (float)(packs->per_speed * body->linear.z);
	to[3] = (float)(turning * body->angular.x);
	to[4] = (float)(turning * body->angular.y);
	to[5] = (float)(turning * body->angular.z);
	to[6] = (float)(body->inverse_mass / packs->per_mass);
	to[7] = (float)(inertia * body->inverse_inertia);
}

static void convert_bodies(const struct rb_wide *wide, const struct rb_packs *packs)
{
	const struct rb_solver_body *const body = wide->dense->bodies.body;

	for (int k = 0; k < wide->member_count; k++)
		convert_body(wide, packs, wide->member[k]);
	if (packs->filled)
		return;
	convert_body(wide, packs, wide->fixed);
	/* driven bodies, and bodies held while others are moved, are no members */
	for (int k = 0; k < wide->dense->row_count; k++) {
		const int a = wide->dense->row[k].a, b = wide->dense->row[k].b;

		if (body[a].inverse_mass == 0)
			convert_body(wide, packs, a);
		if (b != wide->fixed && body[b].inverse_mass == 0)
			convert_body(wide, packs, b);
	}
}

/* Whether packs stay as the call before left them. */
static bool continues_last(enum rb_wide_start start)
{
	return start == RB_WIDE_CONTINUE || start == RB_WIDE_CONTINUE_UNDAMPED;
}

/* Chooses 64 or 32 bits and loads the packs; a call that continues keeps both. */
static const struct rb_packs *begin(struct rb_wide *wide, double tolerance,
                                    enum rb_wide_start start)
{
	struct rb_packs *const single = &wide->packs[1];

	if (!continues_last(start))
		wide->single = start != RB_WIDE_HOLD_FRICTION && single->body &&
		               may_be_single(wide, single, tolerance);
	struct rb_packs *const packs = &wide->packs[wide->single];
	wide->packs[!wide->single].filled = false; /* both share their memory */
	RB_ASSERT(packs->filled || !continues_last(start));
	if (wide->single)
		convert_bodies(wide, packs);
	if (!continues_last(start))
		run_all(wide, packs,
		        start == RB_WIDE_HOLD_FRICTION ? RB_PACK_LOAD_HELD : RB_PACK_LOAD, 0);
	packs->filled = true;
	return packs;
}

/* ---- sweeps ---- */

/* Least changes of the last SWEEPS_COMPARED sweeps, and of as many before them, m/s. */
struct fall {
	double least, before;
};

/*
 * Whether the residual is within the slack, and would still exceed the tolerance after half of the
 * remaining sweeps at the present rate of convergence.
 */
static bool creeps(const struct rb_wide *wide, struct fall *fall,
                   const struct rb_sweep_result *result, double tolerance, int max)
{
	fall->least = fmin(fall->least, result->residual);
	if (result->sweeps % SWEEPS_COMPARED != 0)
		return false;
	const double share = fall->least / fall->before; /* 0 to begin with */
	const bool is_near = fall->before < (double)INFINITY &&
	                     result->residual <= wide->slack * tolerance;
	double then = fall->least;

	for (int k = 0; is_near && k < (max - result->sweeps) / (2 * SWEEPS_COMPARED); k++)
		then *= share;
	*fall = (struct fall){(double)INFINITY, fall->least};
	return is_near && then > tolerance;
}

struct rb_sweep_result rb_wide_solve(struct rb_wide *wide, double tolerance, int max,
                                     enum rb_wide_start start)
{
	struct rb_sweep_result result = {0};
	const bool is_continued = continues_last(start);
	int same = 0;
	const bool is_undamped = start == RB_WIDE_CONTINUE_UNDAMPED;
	double momentum = is_undamped ? momentum_undamped : momentum_first,
	       least = (double)INFINITY, before = (double)INFINITY;
	struct fall fall = {(double)INFINITY, (double)INFINITY};

	const struct rb_packs *const packs = begin(wide, tolerance, start);

	while (result.sweeps < max) {
		result.residual = sweep_all(wide, packs,
		                            result.sweeps > 0 || is_continued ? momentum : 0);
		result.sweeps++;
		if (result.residual <= tolerance ||
		    rb_interrupt_after(wide->interrupt,
		                       RB_SWEEP_WORK * (uint64_t)wide->dense->row_count) ||
		    creeps(wide, &fall, &result, tolerance, max))
			break;
		least = fmin(least, result.residual);
		if (!is_undamped && result.sweeps % SWEEPS_WATCHED == 0) {
			if (least > fall_share * before)
				momentum = fmax(0, 1 - damping_growth * (1 - momentum));
			same = fabs(least - before) < same_share * before ? same + 1 : 0;
			if (same == SAME_MAX)
				break;
			before = least;
			least = (double)INFINITY;
		}
	}
	run_all(wide, packs, RB_PACK_STORE, 0);
	return result;
}
