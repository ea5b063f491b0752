/* SPDX-License-Identifier: MIT */
#include "stepped/solve.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "stepped/direct.h"
#include "stepped/energy.h"
#include "stepped/even.h"
#include "stepped/sweeper.h"

/* Rows from which on a group is solved by all workers; rows of small groups that one block of work has at least. */
enum { LARGE_ROWS = 2048, BLOCK_ROWS = 256 };

/* Sweeps before factors are tried, and at most. */
enum { SWEEPS_FIRST = 200, SWEEPS_MOST = 1000, SWEEPS_QUIET = 64 };
/* The same where rows are in packs, and may be held; of spheres, most that stall are held sooner. */
enum { WIDE_FIRST = 60, WIDE_MOST = 400, CENTRAL_MOST = 140, WIDE_HOLD = 100 };
/* Turns of pushes and friction before a group is given up; sweeps of both in each. */
enum { TURNS_MOST = 6, TURN_SWEEPS = 100 };
/* Times that open pushes are made even, with sweeps after each. */
enum { EVEN_MOST = 4 };
/* Why factors are tried, and how many at most. */
enum purpose { STIFF, STANDING, STALLED, QUIET };
enum { FACTORS_STIFF = 400, FACTORS_STANDING = 120, FACTORS_STALLED = 30, FACTORS_QUIET = 12 };

/*
 * Multiplications that one factorization may take, for each row and at most: some twenty sweeps. All of those of a large
 * group that has stalled, of which few come to an end, some two hundred.
 */
static const double factor_share = 4e3, factors_most = 1e8, stalled_share = 4e2;

/* Of the tolerance, what sweeps may leave of a gap's closing in one step. */
static const double sweep_share = 0.25, direct_share = 1e-2, close_share = 1e-7;
/* Of the tolerance, gaps and overlaps that count as closed where bodies stand. */
static const double let_share = 1.0 / 32;
static const double stiff_ratio = 30, hold_slack = 16;
/*
 * Of what forces change a velocity by in a step, what sweeps may leave in a small group: by much more than this, stacks
 * that ought to come to stand are kept swaying.
 */
static const double pull_share = 1e-3;

enum rb_status rb_solver_create(struct rb_solver *solver, const struct rb_model *model,
                                struct rb_error *err)
{
	const size_t n = (size_t)model->body_count + 1;

	*solver = (struct rb_solver){.body_count = model->body_count};
	solver->dense.body = rb_memory_take(n, sizeof *solver->dense.body);
	solver->free = rb_memory_take(n, sizeof *solver->free);
	solver->parent = rb_memory_take(n, sizeof *solver->parent);
	solver->island_of = rb_memory_take(n, sizeof *solver->island_of);
	solver->member = rb_memory_take(n, sizeof *solver->member);
	solver->local = rb_memory_take(n, sizeof *solver->local);
	solver->reach = rb_memory_take(n, sizeof *solver->reach);
	solver->pushed = rb_memory_take(n, 1);
	solver->rests = rb_memory_take(n, 1);
	solver->stays = rb_memory_take(n, 1);
	solver->left = rb_memory_take(n, sizeof *solver->left);
	solver->rest_pull = rb_memory_take(6 * n, sizeof *solver->rest_pull);
	if (model->features & RB_FEATURE_GYROSCOPIC)
		solver->tensor = rb_memory_take(n, sizeof *solver->tensor);
	solver->dense.tensor = solver->tensor;
	if (solver->dense.body && solver->free && solver->parent && solver->island_of &&
	    solver->member && solver->local && solver->reach && solver->pushed && solver->rests &&
	    solver->stays && solver->left && solver->rest_pull &&
	    (solver->tensor || !(model->features & RB_FEATURE_GYROSCOPIC))) {
		for (int i = 0; i < model->body_count; i++)
			solver->reach[i] = rb_model_reach(model, i);
		for (int k = 0; k < model->material_count * model->material_count; k++)
			if (model->pair_materials[k].restitution > 0)
				solver->bounces = true;
			else
				solver->mixed = true;
		solver->mixed = solver->mixed && solver->bounces;
		return RB_OK;
	}
	rb_solver_release(solver);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the solver of %zu bodies", n - 1);
}

void rb_solver_release(struct rb_solver *solver)
{
	rb_memory_free(solver->dense.body);
	rb_memory_free(solver->dense.row);
	rb_memory_free(solver->tensor);
	rb_memory_free(solver->free);
	rb_memory_free(solver->parent);
	rb_memory_free(solver->island_of);
	rb_memory_free(solver->member);
	rb_memory_free(solver->local);
	rb_memory_free(solver->reach);
	rb_memory_free(solver->pushed);
	rb_memory_free(solver->rests);
	rb_memory_free(solver->stays);
	rb_memory_free(solver->left);
	rb_memory_free(solver->rest_pull);
	rb_memory_free(solver->island);
	*solver = (struct rb_solver){0};
}

double rb_solver_enough(const struct rb_model *model, double h)
{
	return sweep_share * model->tolerance_m / h;
}

/* ---- one group ---- */

static struct rb_dense rows_of(const struct rb_solver *solver, const struct rb_island *island)
{
	struct rb_dense dense = solver->dense;

	dense.row += island->first_row;
	dense.row_count = island->row_count;
	return dense;
}

/* Velocities are what the impulses make of them. */
static void apply_again(const struct rb_solver *solver, const struct rb_island *island,
                        const struct rb_dense *dense)
{
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		dense->body[i] = solver->free[i];
	}
	rb_sweep_warm(dense);
}

/* Factors; false where they are too many or do not come to an end: where sweeps stalled, the impulses are then as they were. */
static bool try_factors(const struct rb_solver *solver, struct rb_island *island,
                        const struct rb_dense *dense, enum purpose purpose, struct rb_arena *arena)
{
	static const int steps_most[] = {[STIFF] = FACTORS_STIFF,
	                                 [STANDING] = FACTORS_STANDING,
	                                 [STALLED] = FACTORS_STALLED,
	                                 [QUIET] = FACTORS_QUIET};
	const double share = purpose == STALLED && dense->row_count >= RB_WIDE_ROWS ? stalled_share
	                                                                            : factor_share;
	const struct rb_direct direct = {
		.dense = dense,
		.free = solver->free,
		.member = solver->member + island->first_member,
		.member_count = island->member_count,
		.local = solver->local,
		.enough = (purpose == QUIET || purpose == STANDING ? close_share : direct_share) *
	                  solver->enough,
		.holds = purpose == STANDING,
		.steps_most = steps_most[purpose],
		.enough_slip = solver->enough,
		.most = fmin(share * (double)dense->row_count, factors_most),
		.arena = arena};
	struct rb_dense_row *kept = rb_arena_take(arena, (size_t)dense->row_count, sizeof *kept);

	if (!kept)
		return false;
	memcpy(kept, dense->row, (size_t)dense->row_count * sizeof *kept);
	const struct rb_direct_result result = rb_direct_solve(&direct);
	island->factors += result.steps;
	if (result.tried && result.residual <= solver->enough) {
		island->residual = result.residual;
		return true;
	}
	/* of stiff groups, what factors have come to is better than what there was */
	if (!result.tried || (purpose != STALLED && purpose != STANDING))
		return false;
	memcpy(dense->row, kept, (size_t)dense->row_count * sizeof *kept);
	apply_again(solver, island, dense);
	return false;
}

static struct rb_sweeper sweeper_of(const struct rb_solver *solver, const struct rb_island *island,
                                    const struct rb_dense *dense, struct rb_team *team)
{
	return (struct rb_sweeper){.dense = dense,
	                           .still = solver->body_count,
	                           .member = solver->member + island->first_member,
	                           .member_count = island->member_count,
	                           .local = solver->local,
	                           .team = team};
}

static int most_of(const struct rb_sweeper *sweeper)
{
	if (!sweeper->wide)
		return SWEEPS_MOST;
	return sweeper->many.central ? CENTRAL_MOST : WIDE_MOST;
}

static bool sweep_more(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                       struct rb_island *island, double enough, int most)
{
	const struct rb_sweep_result result = rb_sweeper_run(sweeper, enough, most);

	island->sweeps += result.sweeps;
	island->residual = result.residual;
	if (rb_sweeper_went_far(sweeper))
		apply_again(solver, island, sweeper->dense);
	return result.residual <= enough;
}

/*
 * Friction in a jammed heap may not come to an end: pushes of many contacts creep on together until one of them slips or
 * opens, which may take thousands of sweeps. What acts across the normals is then left as it is, if it is nearly right, and
 * pushes alone see to it that no gap closes.
 */
static bool hold(struct rb_sweeper *sweeper, struct rb_island *island, double enough, int most)
{
	if (!sweeper->wide || !(island->residual <= hold_slack * enough))
		return false;
	const struct rb_sweep_result result = rb_sweeper_hold(sweeper, enough, most);

	island->sweeps += result.sweeps;
	if (!(result.residual <= enough))
		return false;
	island->slip = island->residual / RB_SLIP_SHARE;
	island->residual = result.residual;
	return true;
}

/*
 * Where friction is not nearly right either, pushes are put right for it and it goes on from there, in turns: pushes and
 * friction that are far from each other's make sweeps of both swing. For large groups, of which a lost step costs most:
 * small ones are sooner done with shorter steps.
 */
static bool take_turns(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                       struct rb_island *island, double enough)
{
	for (int turn = 0; turn < TURNS_MOST; turn++) {
		if (island->residual <= hold_slack * enough)
			return false;
		island->sweeps += rb_sweeper_hold(sweeper, enough, WIDE_HOLD).sweeps;
		if (sweep_more(solver, sweeper, island, enough, TURN_SWEEPS))
			return true;
	}
	return false;
}

static double larger(double a, double b)
{
	return a > b ? a : b;
}

/* m^2/s^2: the fastest of a group as the step began, or after it, squared; one beyond `most` may be told instead. */
static double fastest(const struct rb_solver *solver, const struct rb_island *island, bool before,
                      double most)
{
	const struct rb_state *state = solver->before;
	double square = 0;

	for (int k = 0; k < island->member_count && square <= most; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_dense_body *body = &solver->dense.body[i];
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

/* m^2/s^2: the most that forces change a velocity of these bodies by, squared; no farther than to `enough`. */
static double pull_of(const struct rb_solver *solver, const int *member, int count, double enough)
{
	double pull = 0;

	for (int k = 0; k < count && pull < enough; k++) {
		const rb_vec3 v = rb_vec3_from(solver->before->velocity + 3 * (size_t)member[k]);
		const rb_vec3 more = rb_vec3_sub(solver->free[member[k]].linear, v);

		pull = larger(pull, rb_vec3_dot(more, more));
	}
	return pull;
}

/* Whether nothing moves much faster than the tolerance in a step, nor than its forces make it in one: it is quiet. */
static bool is_quiet(const struct rb_solver *solver, const struct rb_island *island, bool before)
{
	const double few = 4 * solver->enough / sweep_share;
	const double most = fmin(few * few, solver->pull);
	const double square = fastest(solver, island, before, most);

	return square <= most && square <= pull_of(solver, solver->member + island->first_member,
	                                           island->member_count, square);
}

/*
 * Whether the group is carried and nowhere slips by more than sweeps leave: it stands on what moves, and what is left would
 * add up to a way.
 */
static bool goes_along(const struct rb_solver *solver, const struct rb_island *island,
                       const struct rb_dense *dense)
{
	const double most = solver->enough / (sweep_share * RB_SLIP_SHARE);
	bool sticks = island->carried;

	for (int k = 0; k < dense->row_count && sticks; k++) {
		const struct rb_dense_row *row = &dense->row[k];
		const rb_vec3 u = rb_dense_velocity(dense, row);

		sticks = row->push == 0 || rb_vec3_length(rb_vec3_reject(u, row->normal)) <= most;
	}
	return sticks;
}

/* m/s: what the first sweeps may leave. Spheres do not sway. */
static double aim_of(const struct rb_solver *solver, const struct rb_island *island,
                     const struct rb_sweeper *sweeper)
{
	const int *member = solver->member + island->first_member;
	double pull = 0;

	if (solver->before && !sweeper->wide && !sweeper->central)
		pull = sqrt(pull_of(solver, member, island->member_count, (double)INFINITY));
	return pull > 0
	               ? fmin(fmax(pull_share * pull, close_share * solver->enough), solver->enough)
	               : solver->enough;
}

/* Whether the group was quiet when the step began, and nothing moves under it. */
static bool stood(const struct rb_solver *solver, const struct rb_island *island)
{
	return solver->before && !island->carried && is_quiet(solver, island, true);
}

/*
 * Gaps far below the tolerance count as closed where bodies stand: then standing still is among what is possible, however they
 * are wedged. So do all overlaps: what stands has nothing to push apart with.
 */
static void leave_alone(const struct rb_solver *solver, const struct rb_dense *dense)
{
	const double most = let_share * solver->enough / sweep_share;

	for (int k = 0; k < dense->row_count; k++)
		if (dense->row[k].leave >= -most)
			dense->row[k].leave = 0;
}

/* ---- coming to rest ---- */

static void stop(const struct rb_solver *solver, const struct rb_island *island)
{
	for (int k = 0; k < island->member_count; k++) {
		struct rb_dense_body *body =
			&solver->dense.body[solver->member[island->first_member + k]];

		body->linear = body->angular = (rb_vec3){0, 0, 0};
	}
}

/*
 * Solved closely, before the step and after it no faster than what solving closely leaves: it stands still. At that speed
 * a body would take two million steps for the tolerance.
 */
static void find_rest(const struct rb_solver *solver, const struct rb_island *island)
{
	const double close = close_share * solver->enough, still = 16 * close;
	bool rests = solver->before && island->residual <= close && !island->carried;

	for (int k = 0; rests && k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_dense_body *body = &solver->dense.body[i];
		const double reach = solver->reach[i];
		const size_t at = 3 * (size_t)i;

		rests = rb_vec3_max_abs(body->linear) <= still &&
		        rb_vec3_max_abs(body->angular) * reach <= still &&
		        rb_vec3_max_abs(rb_vec3_from(solver->before->velocity + at)) <= still &&
		        (!solver->before->spin ||
		         rb_vec3_max_abs(rb_vec3_from(solver->before->spin + at)) * reach <= still);
	}
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		solver->rests[i] = rests;
		rb_vec3_to(solver->rest_pull + 6 * (size_t)i,
		           rb_vec3_scale(1 / solver->h_s, solver->free[i].linear));
		rb_vec3_to(solver->rest_pull + 6 * (size_t)i + 3,
		           rb_vec3_scale(1 / solver->h_s, solver->free[i].angular));
	}
	if (rests)
		stop(solver, island);
}

/* ---- choosing ---- */

/* Masses so unequal that sweeps would take very many, and spoil the impulses to begin with. */
static bool is_stiff(const struct rb_solver *solver, const struct rb_island *island)
{
	double least = (double)INFINITY, most = 0;

	for (int k = 0; k < island->member_count; k++) {
		const struct rb_dense_body *body =
			&solver->dense.body[solver->member[island->first_member + k]];

		least = fmin(least, body->inverse_mass);
		most = fmax(most, body->inverse_mass);
	}
	return most > stiff_ratio * least;
}

/* ---- energy ---- */

/*
 * Without pushing apart, closely; then back to it, if it was a solution, as far as that gains nothing. What is between two
 * solutions is in the cones, and closes no gap that neither closes.
 */
static struct rb_energy push_less(const struct rb_solver *solver, struct rb_island *island,
                                  const struct rb_dense *dense, struct rb_arena *arena)
{
	const struct rb_energy none = {0};
	struct rb_sweeper sweeper = sweeper_of(solver, island, dense, NULL);
	struct rb_kept kept;
	const bool good = rb_energy_keep(solver, island, arena, &kept);
	const bool solved = island->residual <= solver->enough;

	for (int k = 0; good && k < dense->row_count; k++)
		dense->row[k].leave = fmin(dense->row[k].leave, 0);
	if (!good || !rb_sweeper_take(&sweeper, arena)) {
		island->residual = (double)INFINITY; /* no memory: taken back */
		return none;
	}
	if (!sweep_more(solver, &sweeper, island, aim_of(solver, island, &sweeper), SWEEPS_QUIET) &&
	    !(island->residual <= solver->enough))
		(void)try_factors(solver, island, dense, STALLED, arena);
	const struct rb_energy least = rb_energy_of(solver, island);
	const bool gains = rb_energy_gain(&least) > least.noise;
	const double share = gains || !solved ? 0
	                                      : rb_energy_between(solver, island, &least, &kept);
	rb_energy_mix(solver, island, &kept, share);
	return gains ? least : none;
}

/*
 * A group does not gain. What it would gain by pushing apart what overlaps is left for later; what is still left is taken from
 * all impulses. Where that lets gaps close by more than is good, the step is halved: without impulses nothing is gained, and
 * halves of it close less. Nor is in halves of a step a group pushed apart that cannot be: what is squeezed overlaps on both
 * sides, within the tolerance, and the shorter the step, the faster it would have to part.
 */
static void keep_energy(const struct rb_solver *solver, struct rb_island *island,
                        const struct rb_dense *dense, struct rb_arena *arena)
{
	island->room = 0;
	if (!rb_energy_pushes(dense, -(double)INFINITY))
		return;
	const bool squeezed = solver->h_s < solver->whole_s &&
	                      !(island->residual <= solver->enough);
	struct rb_energy energy = rb_energy_of(solver, island);
	if ((squeezed || rb_energy_gain(&energy) > energy.noise) && rb_energy_pushes(dense, 0))
		energy = push_less(solver, island, dense, arena);
	if (rb_energy_gain(&energy) > energy.noise)
		rb_energy_take(solver, island, rb_energy_share(&energy));
	else
		island->room = fmax(0, -2 * rb_energy_gain(&energy));
}

/*
 * Of small groups: sweeps leave open pushes as they come upon them, by the order of points; friction that follows them would turn
 * what lies evenly.
 */
static bool even_out(const struct rb_solver *solver, struct rb_sweeper *sweeper,
                     struct rb_island *island, struct rb_arena *arena)
{
	const double close = fmax(island->residual, close_share * solver->enough);
	const double aim = fmin(aim_of(solver, island, sweeper), close);
	bool good = true;

	for (int k = 0; k < EVEN_MOST && good; k++) {
		const rb_arena_mark here = rb_arena_here(arena);
		const bool changed = rb_even(sweeper->dense, close_share * solver->enough,
		                             factor_share * (double)island->row_count, arena);

		rb_arena_back(arena, here);
		if (!changed)
			break;
		good = sweep_more(solver, sweeper, island, aim, SWEEPS_QUIET) ||
		       sweep_more(solver, sweeper, island, solver->enough / sweep_share,
		                  SWEEPS_MOST);
	}
	return good;
}

/*
 * Where friction wedges what is to be pushed apart no impulses may do it: those of sweeps grow without end. Nothing is pushed
 * apart then; what is wedged all the same is looked at in shorter steps.
 */
static bool start_over(const struct rb_solver *solver, struct rb_island *island,
                       const struct rb_dense *dense, struct rb_arena *arena)
{
	struct rb_sweeper sweeper = sweeper_of(solver, island, dense, NULL);

	for (int k = 0; k < dense->row_count; k++) {
		struct rb_dense_row *row = &dense->row[k];

		rb_dense_clear(row);
		row->leave = fmin(row->leave, 0);
	}
	apply_again(solver, island, dense);
	const bool good = rb_sweeper_take(&sweeper, arena) &&
	                  sweep_more(solver, &sweeper, island, solver->enough / sweep_share,
	                             most_of(&sweeper));
	if (rb_energy_bounds(solver, island, dense, true))
		return good;
	island->residual = (double)INFINITY;
	return false;
}

/*
 * What stands is solved closely by factors at once, as if nothing slipped: towers, which sweeps would let creep. Else sweeps
 * first; factors where these do not come to an end soon and cost no more. What hardly moves is then solved far closer, a
 * little in each step, so that it comes to stand still. With a team: colours.
 */
static void solve_island(const struct rb_solver *solver, struct rb_island *island,
                         struct rb_team *team, struct rb_arena *arena)
{
	const struct rb_dense dense = rows_of(solver, island);
	const double enough = solver->enough, close = close_share * enough;
	struct rb_sweeper sweeper = sweeper_of(solver, island, &dense, team);
	bool good = false;

	island->sweeps = island->factors = 0;
	island->residual = island->slip = 0;
	if (island->rests) {
		stop(solver, island);
		return;
	}
	if (!rb_sweeper_take(&sweeper, arena)) {
		island->residual = (double)INFINITY; /* no memory: taken back */
		return;
	}
	rb_sweep_warm(&dense);
	const bool stiff = is_stiff(solver, island), standing = stood(solver, island);
	if (standing) {
		leave_alone(solver, &dense);
		good = try_factors(solver, island, &dense, STANDING, arena);
	}
	const bool closely = good;
	if (!good && stiff)
		good = try_factors(solver, island, &dense, STIFF, arena);
	if (!good)
		good = sweep_more(solver, &sweeper, island, aim_of(solver, island, &sweeper),
		                  sweeper.wide ? WIDE_FIRST : SWEEPS_FIRST);
	/* the last digit costs as much as all before: the whole tolerance will do, as the verdict will see */
	if (!good)
		good = sweep_more(solver, &sweeper, island, enough / sweep_share,
		                  most_of(&sweeper));
	if (!good)
		good = try_factors(solver, island, &dense, STALLED, arena);
	if (!good && solver->before && island->row_count >= LARGE_ROWS)
		good = take_turns(solver, &sweeper, island, enough / sweep_share);
	if (!good)
		good = hold(&sweeper, island, enough / sweep_share, WIDE_HOLD);
	if (!good && !sweeper.wide)
		good = sweep_more(solver, &sweeper, island, enough / sweep_share, SWEEPS_MOST);
	if (!rb_energy_bounds(solver, island, &dense, false))
		good = start_over(solver, island, &dense, arena);
	if (good && !closely && solver->before && island->residual > close &&
	    (is_quiet(solver, island, false) ||
	     (!sweeper.wide && goes_along(solver, island, &dense))) &&
	    (stiff || !sweep_more(solver, &sweeper, island, close, SWEEPS_QUIET)))
		(void)try_factors(solver, island, &dense, QUIET, arena);
	if (good && !closely && solver->before && !sweeper.wide)
		good = even_out(solver, &sweeper, island, arena);
	if (solver->before)
		keep_energy(solver, island, &dense, arena);
	find_rest(solver, island);
}

/* ---- all groups ---- */

struct work {
	struct rb_solver *solver;
	struct rb_world *world;
	const int *first; /* [blocks + 1]: groups of each block */
	bool rebound;
};

static bool is_due(const struct work *work, const struct rb_island *island)
{
	return work->rebound ? island->rebounds : !island->kept;
}

static void solve_block(void *user, int block, int worker)
{
	const struct work *work = user;

	for (int g = work->first[block]; g < work->first[block + 1]; g++) {
		struct rb_island *island = &work->solver->island[g];

		if (island->row_count >= LARGE_ROWS || !is_due(work, island))
			continue;
		struct rb_arena *arena = &work->world->arena[worker];
		const rb_arena_mark here = rb_arena_here(arena);
		solve_island(work->solver, island, NULL, arena);
		rb_arena_back(arena, here);
	}
}

static bool solve_all(struct work *work)
{
	struct rb_solver *solver = work->solver;
	struct rb_arena *arena = &work->world->arena[0];
	int *first = rb_arena_take(arena, solver->island_count + 1, sizeof *first);
	int blocks = 0, rows = 0;

	if (!first)
		return false;
	first[0] = 0;
	for (size_t g = 0; g < solver->island_count; g++) {
		if (solver->island[g].row_count < LARGE_ROWS && is_due(work, &solver->island[g]))
			rows += solver->island[g].row_count;
		if (rows < BLOCK_ROWS && g + 1 < solver->island_count)
			continue;
		rows = 0;
		first[++blocks] = (int)g + 1;
	}
	work->first = first;
	rb_team_run(work->world->team, blocks, solve_block, work);
	for (size_t g = 0; g < solver->island_count; g++) {
		const rb_arena_mark here = rb_arena_here(arena);

		if (solver->island[g].row_count >= LARGE_ROWS && is_due(work, &solver->island[g]))
			solve_island(solver, &solver->island[g], work->world->team, arena);
		rb_arena_back(arena, here);
	}
	return true;
}

enum rb_status rb_solver_step(struct rb_solver *solver, struct rb_world *world,
                              const struct rb_state *before, struct rb_points *points, double h,
                              struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world};
	enum rb_status status = RB_OK;

	solver->h_s = h;
	solver->before = before;
	solver->enough = rb_solver_enough(world->model, h);
	status = rb_islands_make(solver, world, points, err);
	if (status != RB_OK)
		return status;
	if (before)
		solver->pull = pull_of(solver, solver->active, solver->active_count,
		                       (double)INFINITY);
	if (!solve_all(&work))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	rb_islands_end(solver, world, points);
	return RB_OK;
}

/* What was found of groups without a mark: bodies and results are put back when groups have been made anew. */
struct earlier {
	struct rb_dense_body *body; /* by body */
	struct rb_island *island;
	int *island_of;
};

static bool take_earlier(const struct rb_solver *solver, struct rb_arena *arena,
                         struct earlier *earlier)
{
	const size_t n = (size_t)solver->body_count + 1;

	earlier->body = rb_arena_take(arena, n, sizeof *earlier->body);
	earlier->island_of = rb_arena_take(arena, n, sizeof *earlier->island_of);
	earlier->island = rb_arena_take(arena, solver->island_count + 1, sizeof *earlier->island);
	if (!earlier->body || !earlier->island_of || !earlier->island)
		return false;
	memcpy(earlier->body, solver->dense.body, n * sizeof *earlier->body);
	memcpy(earlier->island_of, solver->island_of, n * sizeof *earlier->island_of);
	if (solver->island_count > 0)
		memcpy(earlier->island, solver->island,
		       solver->island_count * sizeof *earlier->island);
	return true;
}

static void put_back(struct rb_solver *solver, const struct earlier *earlier,
                     const unsigned char *again)
{
	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *island = &solver->island[g];
		const int *member = solver->member + island->first_member;

		if (again[member[0]])
			continue;
		const struct rb_island *was = &earlier->island[earlier->island_of[member[0]]];
		island->kept = true;
		island->sweeps = was->sweeps;
		island->factors = was->factors;
		island->residual = was->residual;
		island->slip = was->slip;
		island->room = was->room;
		for (int k = 0; k < island->member_count; k++)
			solver->dense.body[member[k]] = earlier->body[member[k]];
	}
}

enum rb_status rb_solver_again(struct rb_solver *solver, struct rb_world *world,
                               struct rb_points *points, const unsigned char *again,
                               struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world};
	struct earlier earlier;

	if (!take_earlier(solver, &world->arena[0], &earlier))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	const enum rb_status status = rb_islands_make(solver, world, points, err);
	if (status != RB_OK)
		return status;
	put_back(solver, &earlier, again);
	if (!solve_all(&work))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	rb_islands_end(solver, world, points);
	return RB_OK;
}

/* Whether restitution of this point shows beyond what the tolerance lets be. */
static bool rebounds(const struct rb_solver *solver, const struct rb_point *point)
{
	return point->push > 0 &&
	       (solver->hands_over || point->restitution * point->approach > solver->enough);
}

static void add_rebound(struct rb_solver *solver, struct rb_world *world)
{
	for (size_t g = 0; g < solver->island_count; g++)
		if (solver->island[g].rebounds)
			solver->island[g].share = rb_energy_rebound(solver, world,
			                                            &solver->island[g]);
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k];
		double *const v = world->state.velocity + 3 * (size_t)i;

		if (solver->island_of[i] < 0 || !solver->island[solver->island_of[i]].rebounds)
			continue;
		const double share = solver->island[solver->island_of[i]].share;
		const struct rb_dense_body more = rb_energy_added(solver, world, i);
		rb_vec3_to(v, rb_vec3_add_scaled(rb_vec3_from(v), share, more.linear));
		if (!world->state.spin)
			continue;
		double *const w = world->state.spin + 3 * (size_t)i;
		rb_vec3_to(w, rb_vec3_add_scaled(rb_vec3_from(w), share, more.angular));
	}
}

enum rb_status rb_solver_rebound(struct rb_solver *solver, struct rb_world *world,
                                 const struct rb_points *points, rb_vec3 *rebound,
                                 struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world, .rebound = true};
	bool any = false;

	if (!solver->bounces && !solver->hands_over)
		return RB_OK;
	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *island = &solver->island[g];

		island->rebounds = false;
		for (int k = 0; k < island->row_count && !island->rests; k++) {
			const struct rb_dense_row *row = &solver->dense.row[island->first_row + k];

			island->rebounds = island->rebounds ||
			                   rebounds(solver, &points->row[row->point]);
		}
		any = any || island->rebounds;
	}
	if (!any)
		return RB_OK;
	solver->before = NULL; /* who rebounds does not rest */
	for (int k = 0; k < solver->active_count; k++)
		solver->free[solver->active[k]] = solver->dense.body[solver->active[k]];
	for (int k = 0; k < solver->dense.row_count; k++) {
		struct rb_dense_row *row = &solver->dense.row[k];
		const struct rb_point *point = &points->row[row->point];
		const double now = rb_vec3_dot(rb_dense_velocity(&solver->dense, row), row->normal);

		/* what has not touched stays apart; what has, does not close faster than it was left to */
		row->leave = point->push > 0 ? fmin(now, 0) : -(double)INFINITY;
		if (rebounds(solver, point))
			row->leave = fmax(0, point->restitution * point->approach);
		rb_dense_clear(row);
	}
	if (!solve_all(&work))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	add_rebound(solver, world);
	for (int k = 0; k < solver->dense.row_count; k++) {
		const struct rb_dense_row *row = &solver->dense.row[k];
		const struct rb_island *island = &solver->island[solver->island_of[row->a]];

		if (island->rebounds)
			rebound[row->point] = rb_vec3_scale(island->share, rb_dense_impulse(row));
	}
	return RB_OK;
}
