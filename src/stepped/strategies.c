/* SPDX-License-Identifier: MIT */
#include "stepped/strategies.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "stepped/direct.h"
#include "stepped/dual.h"
#include "stepped/energy.h"
#include "stepped/redundant_contacts.h"
#include "stepped/sweeper.h"

/* Sweeps before factors are tried, in all, and when solving closely. */
enum { SWEEPS_FIRST = 200, SWEEPS_MAX = 1000, SWEEPS_CLOSE = 64 };
/* The same for rows in packs, where friction may be held; spheres that stall are held sooner. */
enum { WIDE_FIRST = 60, WIDE_MAX = 400, CENTRAL_MAX = 140, WIDE_HOLD = 100 };
/* Sweeps of large islands, where a rejected step costs as much as many sweeps. */
enum { LARGE_MAX = 800 };
/* Turns of normal impulses and friction before an island is given up; sweeps of both in each. */
enum { TURNS_MAX = 6, TURN_SWEEPS = 100 };
/*
 * Passes that make redundant normal impulses least in norm, with sweeps after each. Of 941,000
 * solutions of few rows in 40 random scenes 353 took one, 293 two, 102 three, 43 up to 15; 25 were
 * not at an end after 16.
 */
enum { REDUNDANT_PASSES_FEW = 16, REDUNDANT_PASSES = 4 };
/*
 * Rows of an island that is solved closely: faces of about four bodies. Doing so with all islands
 * below 128 rows would double the sweeps of a heap of 1,000 cubes.
 */
enum { FEW_ROWS = 16 };
/* Why factors are tried, and how many at most. */
enum purpose { STIFF, AT_REST, STALLED, CLOSE };
enum { FACTORS_STIFF = 400, FACTORS_AT_REST = 120, FACTORS_STALLED = 30, FACTORS_CLOSE = 12 };

/*
 * Multiplications allowed for one factorization, per row and in all: some twenty sweeps. Per row
 * for large islands that have stalled, few of which converge: some two hundred multiplications.
 */
static const double factor_share = 4e3, factors_max = 1e8, stalled_share = 4e2;

/*
 * The same per row for joints, whose redundant rows no other strategy detects: some seventy joints
 * on one body.
 */
static const double joints_share = 4e4;

static const double sweep_share = RB_STRATEGY_SWEEP_SHARE, direct_share = 1e-2,
		    close_share = RB_STRATEGY_CLOSE_SHARE;
static const double stiff_ratio = 30, hold_slack = 16;
/* Friction may be held in steps of at most the whole step over this number. */
static const double hold_parts = 8;
/*
 * Fraction of the velocity change by forces in a step that sweeps may leave in a small island: with
 * a much larger one, stacks that ought to come to rest keep swaying.
 */
static const double external_share = 1e-3;
/*
 * The same fraction of speeds: a tumbling island is not about to come to rest. For heaps, multiple
 * of the tolerance.
 */
static const double speed_share = 1e-2, heap_share = 2;

/* Recomputes the velocities from the impulses. */
static void reapply(const struct rb_solver *solver, const struct rb_island *island,
                    const struct rb_row_system *dense)
{
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		dense->bodies.body[i] = solver->free[i];
	}
	rb_sweep_warm(dense);
}

/*
 * Solves by factors; false if they are too large or do not reach `residual_max`, m/s: the impulses
 * are then as they were, except with STIFF.
 */
static bool try_factors(const struct rb_solver *solver, struct rb_island *island,
                        const struct rb_row_system *dense, enum purpose purpose,
                        double residual_max, struct rb_arena *arena)
{
	static const int steps_max[] = {[STIFF] = FACTORS_STIFF,
	                                [AT_REST] = FACTORS_AT_REST,
	                                [STALLED] = FACTORS_STALLED,
	                                [CLOSE] = FACTORS_CLOSE};
	/* sweeps would make towers sway: factors go on until their residual is acceptable */
	const bool tower = purpose == AT_REST && dense->row_count < RB_STRATEGY_HEAP_ROWS;
	const double share = purpose == STALLED && dense->row_count >= RB_WIDE_ROWS ? stalled_share
	                                                                            : factor_share;
	/* errors in a stack add up: to n^2 / 2 of them at the top of n bodies */
	const double levers = (double)island->member_count * (double)island->member_count;
	const double close = close_share / (purpose == AT_REST ? levers : 1);
	/* polish_joints follows */
	const bool is_polished = purpose != CLOSE && island->contact_count > 0;
	const struct rb_direct direct = {
		.dense = dense,
		.free = solver->free,
		.member = solver->member + island->first_member,
		.member_count = island->member_count,
		.local = solver->local,
		.tolerance = (purpose == CLOSE || purpose == AT_REST ? close : direct_share) *
	                     solver->tolerance,
		.holds = purpose == AT_REST,
		.steps_max = tower ? FACTORS_STIFF : steps_max[purpose],
		.steps_few = tower ? steps_max[purpose] : 0,
		.acceptable = residual_max,
		.slip_tolerance = solver->tolerance,
		.joint_tolerance = is_polished ? solver->tolerance : 0,
		.max = fmin(share * (double)dense->row_count, factors_max),
		.interrupt = solver->interrupt,
		.arena = arena};
	rb_along_across *kept = rb_arena_take(arena, (size_t)dense->row_count, sizeof *kept);

	if (!kept)
		return false;
	for (int k = 0; k < dense->row_count; k++)
		kept[k] = dense->row[k].impulse;
	const struct rb_direct_result result = rb_direct_solve(&direct);
	island->factors += result.steps;
	if (result.tried && result.residual <= residual_max) {
		island->residual = result.residual;
		return true;
	}
	/* for stiff islands, the result of factors is better than the previous impulses */
	if (!result.tried || purpose == STIFF)
		return false;
	for (int k = 0; k < dense->row_count; k++)
		dense->row[k].impulse = kept[k];
	reapply(solver, island, dense);
	return false;
}

static struct rb_sweeper sweeper_of(const struct rb_solver *solver, const struct rb_island *island,
                                    const struct rb_row_system *dense, struct rb_team *team)
{
	return (struct rb_sweeper){.dense = dense,
	                           .fixed = solver->body_count,
	                           .member = solver->member + island->first_member,
	                           .member_count = island->member_count,
	                           .local = solver->local,
	                           .team = team,
	                           .interrupt = solver->interrupt};
}

static int max_of(const struct rb_sweeper *sweeper)
{
	if (!sweeper->wide)
		return SWEEPS_MAX;
	return sweeper->packs.central ? CENTRAL_MAX : WIDE_MAX;
}

static bool end_sweeps(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                       struct rb_island *island, double tolerance, struct rb_sweep_result result)
{
	island->sweeps += result.sweeps;
	island->residual = result.residual;
	if (rb_sweeper_lost_digits(sweeper)) {
		rb_row_system_reject_normals(sweeper->dense);
		reapply(solver, island, sweeper->dense);
	}
	return result.residual <= tolerance;
}

static bool sweep_more(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                       struct rb_island *island, double tolerance, int max)
{
	return end_sweeps(solver, sweeper, island, tolerance,
	                  rb_sweeper_run(sweeper, tolerance, max));
}

/*
 * Friction in a jammed heap may not converge: normal impulses of many contacts creep together until
 * one of them slips or opens, which may take thousands of sweeps. Tangential impulses are then held
 * as they are, if they are nearly right, and only normal impulses are solved so that no gap closes.
 */
static bool hold(struct rb_sweeper *sweeper, struct rb_island *island, double tolerance, int max)
{
	if (!sweeper->wide || !(island->residual <= hold_slack * tolerance))
		return false;
	const struct rb_sweep_result result = rb_sweeper_hold_friction(sweeper, tolerance, max);

	island->sweeps += result.sweeps;
	if (!(result.residual <= tolerance))
		return false;
	island->slip = island->residual / RB_SLIP_SHARE;
	island->residual = result.residual;
	return true;
}

/*
 * Where friction is not nearly right either, normal impulses alone are solved for it, then both, in
 * turns: sweeps of both oscillate if normal and friction impulses are far from consistent. For
 * large islands, for which a lost step costs most: small ones are cheaper in shorter steps.
 */
static bool take_turns(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                       struct rb_island *island, double tolerance)
{
	for (int turn = 0; turn < TURNS_MAX; turn++) {
		if (island->residual <= hold_slack * tolerance)
			return false;
		island->sweeps += rb_sweeper_hold_friction(sweeper, tolerance, WIDE_HOLD).sweeps;
		if (sweep_more(solver, sweeper, island, tolerance, TURN_SWEEPS))
			return true;
	}
	return false;
}

static double larger(double a, double b)
{
	return a > b ? a : b;
}

/*
 * m^2/s^2: largest speed of a body's point in an island, squared, before the step or after it; any
 * value beyond `max` may be returned for a larger one.
 */
static double speed_squared(const struct rb_solver *solver, const struct rb_island *island,
                            bool before, double max)
{
	const struct rb_state *state = solver->before;
	double square = 0;

	for (int k = 0; k < island->member_count && square <= max; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body *body = &solver->dense.bodies.body[i];
		const size_t at = 3 * (size_t)i;
		rb_vec3 v = body->linear, w = body->angular;

		if (before) {
			v = rb_vec3_from(state->velocity + at);
			w = state->spin ? rb_vec3_from(state->spin + at) : (rb_vec3){0, 0, 0};
		}
		square = larger(square, rb_vec3_dot(v, v));
		square = larger(square, rb_vec3_dot(w, w) * solver->reach[i] * solver->reach[i]);
	}
	return square;
}

double rb_strategies_external(const struct rb_solver *solver, const int *member, int count,
                              double tolerance)
{
	double external = 0;

	for (int k = 0; k < count && external < tolerance; k++) {
		const rb_vec3 v = rb_vec3_from(solver->before->velocity + 3 * (size_t)member[k]);
		const rb_vec3 change = rb_vec3_sub(solver->free[member[k]].linear, v);

		external = larger(external, rb_vec3_dot(change, change));
	}
	return external;
}

/*
 * Whether nothing moves much faster than the tolerance in a step, or than forces accelerate it in
 * one.
 */
static bool hardly_moves(const struct rb_solver *solver, const struct rb_island *island,
                         bool before)
{
	const double slow = 4 * solver->tolerance / sweep_share;
	const double max = fmin(slow * slow, solver->external);
	const double square = speed_squared(solver, island, before, max);

	return square <= max &&
	       square <= rb_strategies_external(solver, solver->member + island->first_member,
	                                        island->member_count, square);
}

/*
 * Whether the island's support moves and no contact slips by more than sweeps leave: the body rests
 * on a moving support, and the residuals would add up to a displacement.
 */
static bool sticks_to_support(const struct rb_solver *solver, const struct rb_island *island,
                              const struct rb_row_system *dense)
{
	const double max = solver->tolerance / (sweep_share * RB_SLIP_SHARE);
	bool sticks = island->is_driven;

	for (int k = 0; k < dense->row_count && sticks; k++) {
		const struct rb_constraint *row = &dense->row[k];
		const rb_vec3 u = rb_constraint_velocity(&dense->bodies, row);

		sticks = row->impulse.n == 0 ||
		         rb_vec3_length(rb_vec3_reject(u, row->normal)) <= max;
	}
	return sticks;
}

/* m/s: aim of the first sweeps. Spheres and heaps do not sway: a multiple of the tolerance. */
static double aim_of(const struct rb_solver *solver, const struct rb_island *island,
                     const struct rb_sweeper *sweeper)
{
	const int *member = solver->member + island->first_member;
	double external = 0;

	if (solver->before && island->row_count < RB_STRATEGY_HEAP_ROWS && !sweeper->central)
		external = sqrt(rb_strategies_external(solver, member, island->member_count,
		                                       (double)INFINITY));
	if (external == 0)
		return heap_share * solver->tolerance;
	const double speed = sqrt(speed_squared(solver, island, true, (double)INFINITY));
	const double aim = fmax(external_share * external, speed_share * speed);
	return fmin(fmax(aim, close_share * solver->tolerance), solver->tolerance);
}

/* Whether contacts alone hold the island, and so few that solving them closely costs little. */
static bool is_few(const struct rb_island *island)
{
	return island->row_count == island->contact_count && island->row_count <= FEW_ROWS;
}

/*
 * m/s: the same where it is to be solved closely: residuals of sweeps over few rows would depend on
 * their order, turn a symmetric arrangement, and count as a gain of energy.
 */
static double aim_closely(const struct rb_solver *solver, const struct rb_island *island,
                          const struct rb_sweeper *sweeper)
{
	return is_few(island) ? close_share * solver->tolerance : aim_of(solver, island, sweeper);
}

/* Whether the island hardly moved when the step began, and its support does not move. */
static bool was_at_rest(const struct rb_solver *solver, const struct rb_island *island)
{
	return solver->before && !island->is_driven && hardly_moves(solver, island, true);
}

/* ---- choosing ---- */

/*
 * Masses so unequal that sweeps would take very many, and spoil the warm start; chains of joints
 * are as bad, and cost factors only in proportion to their length.
 */
static bool is_stiff(const struct rb_solver *solver, const struct rb_island *island)
{
	if (island->row_count > island->contact_count)
		return true;
	double least = (double)INFINITY, max = 0;

	for (int k = 0; k < island->member_count; k++) {
		const struct rb_solver_body *body =
			&solver->dense.bodies.body[solver->member[island->first_member + k]];

		least = fmin(least, body->inverse_mass);
		max = fmax(max, body->inverse_mass);
	}
	return max > stiff_ratio * least;
}

/* ---- joints ---- */

/* Clears impulses of bilateral rows: warm starting would keep self-stress of redundant joints. */
static void clear_bilateral(const struct rb_solver *solver, const struct rb_island *island,
                            const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (dense->row[k].set == RB_CONSTRAINT_FREE ||
		    (isinf(dense->row[k].low) && isinf(dense->row[k].high)))
			rb_constraint_clear(&dense->row[k]);
	reapply(solver, island, dense);
}

/*
 * Solves the rows of joints with the contacts' impulses fixed; returns the residual; INFINITY: not
 * tried.
 */
static double solve_joints(const struct rb_solver *solver, struct rb_island *island,
                           const struct rb_row_system *rows, struct rb_arena *arena)
{
	struct rb_row_system joints = *rows;

	joints.row += island->contact_count;
	joints.row_count -= island->contact_count;
	const struct rb_dual dual = {
		.dense = &joints,
		/* to rounding: that costs no more */
		.tolerance = close_share * solver->tolerance,
		.max = fmin(joints_share * (double)rows->row_count, factors_max),
		.interrupt = solver->interrupt,
		.arena = arena};

	/* a second half continues from the first one, which has cleared them */
	if (solver->before || !island->halves)
		clear_bilateral(solver, island, rows);
	const struct rb_dual_result result = rb_dual_solve(&dual);
	island->factors += result.steps;
	if (result.tried)
		reapply(solver, island, rows);
	return result.residual;
}

/* ---- energy ---- */

/* Heaps are solved to the whole tolerance: a residual within it is no sign of being squeezed. */
static bool is_solved(const struct rb_solver *solver, const struct rb_island *island)
{
	const bool heap = island->row_count >= RB_STRATEGY_HEAP_ROWS;

	return island->residual <= solver->tolerance / (heap ? sweep_share : 1);
}

/*
 * Solves closely without separating overlaps or drawing back gaps; then interpolates back to the
 * previous solution, if it was one, as far as that gains no energy. An interpolation of two
 * solutions is within the cones, and closes no gap that neither closes.
 */
static struct rb_energy reduce_separation(const struct rb_solver *solver, struct rb_island *island,
                                          const struct rb_row_system *dense, struct rb_team *team,
                                          struct rb_arena *arena)
{
	const struct rb_energy none = {0};
	struct rb_sweeper sweeper = sweeper_of(solver, island, dense, team);
	struct rb_saved_solution kept;
	const bool good = rb_energy_save(solver, island, arena, &kept);
	const bool solved = is_solved(solver, island);

	if (good)
		rb_energy_clear_separation(dense);
	if (!good || !rb_sweeper_take(&sweeper, arena)) {
		island->residual = (double)INFINITY; /* no memory: taken back */
		return none;
	}
	if (island->contact_count == 0)
		island->residual = solve_joints(solver, island, dense, arena);
	else if (!sweep_more(solver, &sweeper, island, aim_closely(solver, island, &sweeper),
	                     SWEEPS_CLOSE) &&
	         !(island->residual <= solver->tolerance))
		(void)try_factors(solver, island, dense, STALLED, solver->tolerance, arena);
	const struct rb_energy least = rb_energy_of(solver, island, team, arena);
	const bool gains = rb_energy_gain(&least) > least.noise;
	const double share = gains || !solved
	                             ? 0
	                             : rb_energy_interpolation_share(solver, island, &least, &kept);
	rb_energy_interpolate(solver, island, &kept, share);
	return gains ? least : none;
}

/*
 * Prevents energy gain of an island. A gain from separating overlaps is deferred to later steps; a
 * remaining gain is removed by scaling all impulses. Where that lets gaps close by more than the
 * tolerance, the step is halved: without impulses nothing is gained, and halves of it close less.
 * In parts of a step an island whose overlaps cannot be separated is not separated either: if it is
 * squeezed, it overlaps on both sides, within the tolerance, and the shorter the step, the higher
 * the separation velocity would be.
 */
static void keep_energy(const struct rb_solver *solver, struct rb_island *island,
                        const struct rb_row_system *dense, struct rb_team *team,
                        struct rb_arena *arena)
{
	island->energy_budget = 0;
	/*
	 * the motion of one half is inconclusive; unilateral rows stay loaded, or are far from
	 * contact
	 */
	if (island->halves || !rb_energy_has_impulse(dense))
		return;
	const bool squeezed = solver->h_s < solver->whole_s && !is_solved(solver, island);
	struct rb_energy energy = rb_energy_of(solver, island, team, arena);
	if ((squeezed || rb_energy_gain(&energy) > energy.noise) && rb_energy_has_separation(dense))
		energy = reduce_separation(solver, island, dense, team, arena);
	if (rb_energy_gain(&energy) > energy.noise)
		rb_energy_scale_impulses(solver, island, rb_energy_share(&energy));
	else
		island->energy_budget = fmax(0, -2 * rb_energy_gain(&energy));
}

/*
 * For small islands: sweeps leave redundant normal impulses that depend on the order of points;
 * friction that follows them would turn a symmetric arrangement. Targets of the points of one pair
 * are made consistent starting from their original values each time, so that they do not drift.
 */
static bool solve_redundant(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                            struct rb_island *island, struct rb_arena *arena)
{
	const struct rb_row_system *const rows = sweeper->dense;
	const double close = close_share * solver->tolerance;
	const double aim = fmax(island->residual, close);
	/* in larger islands contacts without an impulse stay out of it, for their number */
	const double slack = is_few(island) ? solver->tolerance : -(double)INFINITY;
	const int passes = is_few(island) ? REDUNDANT_PASSES_FEW : REDUNDANT_PASSES;
	double *const target = rb_arena_take(arena, (size_t)rows->row_count, sizeof *target);
	bool good = target != NULL;

	for (int k = 0; k < rows->row_count && good; k++)
		target[k] = rows->row[k].target.n;
	for (int k = 0; k < passes && good; k++) {
		const rb_arena_mark here = rb_arena_here(arena);

		for (int i = 0; i < island->contact_count; i++)
			rows->row[i].target.n = target[i];
		const bool changed = rb_redundant_contacts(
			rows, close, slack, factor_share * (double)island->row_count, arena);
		rb_arena_back(arena, here);
		if (!changed)
			break;
		if (island->row_count > island->contact_count)
			(void)solve_joints(solver, island, rows, arena);
		good = sweep_more(solver, sweeper, island, aim, SWEEPS_CLOSE) ||
		       sweep_more(solver, sweeper, island, solver->tolerance / sweep_share,
		                  SWEEPS_MAX);
	}
	return good;
}

/*
 * Where friction wedges overlapping bodies, and where a rope pulls at right angles to all that can
 * move, no impulses may separate them: they grow without bound. Nothing is separated then; what
 * still overlaps is retried in shorter steps.
 */
static bool start_over(const struct rb_solver *solver, struct rb_island *island,
                       const struct rb_row_system *dense, struct rb_team *team,
                       struct rb_arena *arena)
{
	struct rb_sweeper sweeper = sweeper_of(solver, island, dense, team);
	const double aim = solver->tolerance / sweep_share;

	for (int k = 0; k < dense->row_count; k++)
		rb_constraint_clear(&dense->row[k]);
	rb_energy_clear_separation(dense);
	reapply(solver, island, dense);
	if (island->contact_count == 0)
		island->residual = solve_joints(solver, island, dense, arena);
	const bool good = island->contact_count == 0 ? island->residual <= aim
	                                             : rb_sweeper_take(&sweeper, arena) &&
	                                                       sweep_more(solver, &sweeper, island,
	                                                                  aim, max_of(&sweeper));
	if (rb_energy_bounds(solver, island, dense, true, team, arena))
		return good;
	island->residual = (double)INFINITY;
	return false;
}

/* ---- strategies ---- */

/* One island being solved. */
struct trial {
	const struct rb_solver *solver;
	struct rb_island *island;
	const struct rb_row_system *rows;
	struct rb_sweeper *sweeper;
	struct rb_arena *arena;
	bool at_rest, stiff;
};

static bool is_of_joints(const struct trial *trial)
{
	return trial->island->contact_count == 0;
}

static bool factors_of_joints(const struct trial *trial)
{
	trial->island->residual = solve_joints(trial->solver, trial->island, trial->rows,
	                                       trial->arena);
	return trial->island->residual <= direct_share * trial->solver->tolerance;
}

/*
 * Solves joints exactly for the contact impulses found, without the self-stress that iterations
 * have left. If contacts are then farther off than the tolerance, the previous impulses are
 * restored.
 */
static void polish_joints(const struct rb_solver *solver, struct rb_island *island,
                          const struct rb_row_system *rows, struct rb_arena *arena)
{
	struct rb_saved_solution kept;

	if (!rb_energy_save(solver, island, arena, &kept))
		return;
	double residual = solve_joints(solver, island, rows, arena);

	for (int k = 0; k < island->contact_count; k++)
		residual = fmax(residual, rb_sweep_residual_of(rows, &rows->row[k]));
	if (residual <= fmax(island->residual, solver->tolerance)) {
		island->residual = residual;
		return;
	}
	rb_energy_interpolate(solver, island, &kept, 1);
}

static bool is_at_rest(const struct trial *trial)
{
	return trial->at_rest;
}

static bool has_unequal_masses(const struct trial *trial)
{
	return trial->stiff;
}

static bool is_large(const struct trial *trial)
{
	return trial->solver->before && trial->sweeper->wide &&
	       trial->island->row_count >= RB_STRATEGY_LARGE_ROWS;
}

/*
 * In shorter steps friction need not be held; for spheres alone they cost several times as much,
 * though.
 */
static bool may_hold(const struct trial *trial)
{
	const struct rb_solver *solver = trial->solver;

	return trial->sweeper->central || !solver->before || !solver->divides ||
	       hold_parts * solver->h_s <= solver->whole_s;
}

static bool is_narrow(const struct trial *trial)
{
	return !trial->sweeper->wide;
}

/* Islands at rest must not be moved by as much as a large tolerance is in one step. */
static bool factors_at_rest(const struct trial *trial)
{
	const double residual_max = fmin(aim_of(trial->solver, trial->island, trial->sweeper),
	                                 trial->solver->tolerance);

	return try_factors(trial->solver, trial->island, trial->rows, AT_REST, residual_max,
	                   trial->arena);
}

static bool factors_of_unequal_masses(const struct trial *trial)
{
	return try_factors(trial->solver, trial->island, trial->rows, STIFF,
	                   trial->solver->tolerance, trial->arena);
}

static bool sweeps_to_the_aim(const struct trial *trial)
{
	return sweep_more(trial->solver, trial->sweeper, trial->island,
	                  aim_of(trial->solver, trial->island, trial->sweeper),
	                  trial->sweeper->wide ? WIDE_FIRST : SWEEPS_FIRST);
}

/*
 * The last digit costs as much as all before: the whole tolerance suffices, as the step's check
 * accepts it. Large islands jam: impulses creep together until some row slips or opens, and only
 * the accumulated momentum of the iteration brings that about soon. Momentum is kept, as no other
 * strategy helps them.
 */
static bool sweeps_to_the_tolerance(const struct trial *trial)
{
	const double tolerance = trial->solver->tolerance / sweep_share;
	struct rb_sweeper *const sweeper = trial->sweeper;
	const double slack = sweeper->central ? hold_slack : 0; /* for the rest, friction is held */
	const bool presses = is_large(trial) && !sweeper->central;
	return end_sweeps(
		trial->solver, sweeper, trial->island, tolerance,
		presses ? rb_sweeper_continue_undamped(sweeper, tolerance, LARGE_MAX)
			: rb_sweeper_continue(sweeper, tolerance, max_of(sweeper), slack));
}

static bool factors_after_stalling(const struct trial *trial)
{
	return try_factors(trial->solver, trial->island, trial->rows, STALLED,
	                   trial->solver->tolerance, trial->arena);
}

static bool normals_and_friction_in_turns(const struct trial *trial)
{
	return take_turns(trial->solver, trial->sweeper, trial->island,
	                  trial->solver->tolerance / sweep_share);
}

static bool held_friction(const struct trial *trial)
{
	return hold(trial->sweeper, trial->island, trial->solver->tolerance / sweep_share,
	            WIDE_HOLD);
}

static bool sweeps_to_the_limit(const struct trial *trial)
{
	return sweep_more(trial->solver, trial->sweeper, trial->island,
	                  trial->solver->tolerance / sweep_share, SWEEPS_MAX);
}

/* Tried in this order until one succeeds. Each starts from the impulses of the one before. */
static const struct strategy {
	bool (*applies)(const struct trial *trial); /* NULL: always */
	bool (*solve)(const struct trial *trial);
} strategies[] = {
	{is_of_joints, factors_of_joints},
	{is_at_rest, factors_at_rest},
	{has_unequal_masses, factors_of_unequal_masses},
	{NULL, sweeps_to_the_aim},
	{NULL, sweeps_to_the_tolerance},
	{NULL, factors_after_stalling},
	{is_large, normals_and_friction_in_turns},
	{may_hold, held_friction},
	{is_narrow, sweeps_to_the_limit},
};
enum { STRATEGIES = sizeof strategies / sizeof *strategies, CLOSE_STRATEGIES = 2 };

/* Returns the index of the strategy that succeeded; STRATEGIES: none. */
static int choose(const struct trial *trial)
{
	int k = 0;

	while (k < STRATEGIES && !((!strategies[k].applies || strategies[k].applies(trial)) &&
	                           strategies[k].solve(trial)))
		k++;
	return k;
}

/*
 * Solves islands of few contacts, and those that hardly move, far below the tolerance: small
 * residuals in each step would keep them from coming to rest. Joints have been solved for their
 * contacts.
 */
static void solve_closely(const struct trial *trial)
{
	const struct rb_solver *const solver = trial->solver;
	struct rb_island *const island = trial->island;
	const double close = close_share * solver->tolerance;

	const bool is_small = !trial->sweeper->wide &&
	                      (is_few(island) || sticks_to_support(solver, island, trial->rows));

	if (island->residual > close &&
	    (is_small || (solver->before && hardly_moves(solver, island, false))) &&
	    (trial->stiff || !sweep_more(solver, trial->sweeper, island, close, SWEEPS_CLOSE)))
		(void)try_factors(solver, island, trial->rows, CLOSE, island->residual,
		                  trial->arena);
}

void rb_strategies_solve(const struct rb_solver *solver, struct rb_island *island,
                         struct rb_team *team, struct rb_arena *arena)
{
	const struct rb_row_system rows = rb_islands_rows(solver, island);
	struct rb_sweeper sweeper = sweeper_of(solver, island, &rows, team);

	RB_ASSERT(island->member_count > 0 && (island->rests || island->row_count > 0));
	island->sweeps = island->factors = 0;
	island->residual = island->slip = 0;
	if (island->rests) {
		rb_stillness_stop(solver, island);
		return;
	}
	const rb_arena_mark here = rb_arena_here(arena);
	sweeper.warms = true;
	if (!rb_sweeper_take(&sweeper, arena)) {
		island->residual = (double)INFINITY; /* no memory: taken back */
		return;
	}
	const struct trial trial = {.solver = solver,
	                            .island = island,
	                            .rows = &rows,
	                            .sweeper = &sweeper,
	                            .arena = arena,
	                            .stiff = is_stiff(solver, island),
	                            .at_rest = was_at_rest(solver, island)};
	if (trial.at_rest)
		rb_stillness_skip_gaps(solver, &rows);
	RB_ASSERT_COSTLY(rb_row_system_is_sound(&rows, solver->body_count + 1));
	if (island->contact_count > 0 && island->row_count > island->contact_count)
		(void)solve_joints(solver, island, &rows, arena);
	const int strategy = choose(&trial);
	const bool is_close = strategy < CLOSE_STRATEGIES;
	bool good = strategy < STRATEGIES;
	if (island->contact_count > 0 && island->row_count > island->contact_count)
		polish_joints(solver, island, &rows, arena);
	if (!rb_energy_bounds(solver, island, &rows, false, team, arena))
		good = start_over(solver, island, &rows, team, arena);
	if (good && !is_close) {
		solve_closely(&trial);
		if (!sweeper.wide)
			good = solve_redundant(solver, &sweeper, island, arena);
	}
	rb_arena_back(arena, here); /* the next sweeper is as large */
	if (solver->before)
		keep_energy(solver, island, &rows, team, arena);
	RB_ASSERT_COSTLY(rb_row_system_is_sound(&rows, solver->body_count + 1));
	RB_ASSERT(!(island->residual < 0) && island->energy_budget >= 0);
	rb_stillness_find(solver, island);
}
