/* SPDX-License-Identifier: MIT */
#include "stepped/solve.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "constraint/effective_mass.h"
#include "force/spring.h"
#include "stepped/energy.h"
#include "stepped/joined_rebound.h"
#include "stepped/second_half.h"
#include "stepped/strategies.h"
#include "stepped/reduced_islands.h"

/* Least number of rows of small islands in one block of work. */
enum { BLOCK_ROWS = 256 };

/* Allocates the step data of joints, and finds whether joints have restitution or springs. */
static enum rb_status create_joints(struct rb_solver *solver, const struct rb_model *model,
                                    struct rb_error *err)
{
	if (!model->joints)
		return RB_OK;
	const size_t count = (size_t)model->joints->count;

	solver->joint = rb_memory_take(count, sizeof *solver->joint);
	solver->active_joint = rb_memory_take(count, sizeof *solver->active_joint);
	solver->stiff = rb_memory_take((size_t)model->body_count, 1);
	solver->after_forces = rb_memory_take((size_t)model->body_count,
	                                      sizeof *solver->after_forces);
	solver->reduced_motion = rb_memory_take((size_t)model->body_count,
	                                        sizeof *solver->reduced_motion);
	if (!solver->joint || !solver->active_joint || !solver->stiff || !solver->after_forces ||
	    !solver->reduced_motion) {
		rb_solver_release(solver);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu joints", count);
	}
	for (size_t k = 0; k < count; k++) {
		solver->joint[k].first_row = -1;
		solver->joint[k].wanted = (double)NAN;
		solver->joints_bounce = solver->joints_bounce ||
		                        model->joints->joint[k].link.type->one_sided ||
		                        model->joints->joint[k].restitution > 0;
		solver->joints_store = solver->joints_store ||
		                       model->joints->joint[k].stiffness > 0;
	}
	return RB_OK;
}

/* Allocates for springs that a step does not resolve, as many as there may be. */
static enum rb_status create_springs(struct rb_solver *solver, const struct rb_model *model,
                                     struct rb_error *err)
{
	const struct rb_elements *springs = rb_model_elements(model, &rb_force_spring);

	if (!springs)
		return RB_OK;
	solver->spring = rb_memory_take((size_t)springs->count, sizeof *solver->spring);
	if (solver->spring)
		return RB_OK;
	rb_solver_release(solver);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %d springs", springs->count);
}

enum rb_status rb_solver_create(struct rb_solver *solver, const struct rb_model *model,
                                struct rb_error *err)
{
	const size_t n = (size_t)model->body_count + 1;

	*solver = (struct rb_solver){.body_count = model->body_count,
	                             .joins_arms = rb_levers_matter(model),
	                             .step_reduced = rb_reduced_islands_try};
	solver->dense.bodies.body = rb_memory_take(n, sizeof *solver->dense.bodies.body);
	solver->free = rb_memory_take(n, sizeof *solver->free);
	solver->parent = rb_memory_take(n, sizeof *solver->parent);
	solver->island_of = rb_memory_take(n, sizeof *solver->island_of);
	solver->member = rb_memory_take(n, sizeof *solver->member);
	solver->local = rb_memory_take(n, sizeof *solver->local);
	solver->reach = rb_memory_take(n, sizeof *solver->reach);
	solver->loaded = rb_memory_take(n, 1);
	solver->clear = rb_memory_take(n, 1);
	solver->rests = rb_memory_take(n, 1);
	solver->asleep = rb_memory_take(n, 1);
	solver->residual = rb_memory_take(n, sizeof *solver->residual);
	solver->rest_external = rb_memory_take(6 * n, sizeof *solver->rest_external);
	const bool tensors = model->joints || (model->features & RB_FEATURE_GYROSCOPIC);

	if (tensors)
		solver->tensor = rb_memory_take(n, sizeof *solver->tensor);
	solver->dense.bodies.tensor = solver->tensor;
	if (solver->dense.bodies.body && solver->free && solver->parent && solver->island_of &&
	    solver->member && solver->local && solver->reach && solver->loaded && solver->clear &&
	    solver->rests && solver->asleep && solver->residual && solver->rest_external &&
	    (solver->tensor || !tensors)) {
		for (int i = 0; i < model->body_count; i++)
			solver->reach[i] = rb_model_reach(model, i);
		for (int k = 0; k < model->material_count * model->material_count; k++) {
			const struct rb_pair_material *const pair = &model->pair_materials[k];

			solver->joined_friction = solver->joined_friction ||
			                          (model->joints && pair->friction > 0);
			if (pair->restitution > 0)
				solver->bounces = true;
			else
				solver->mixed = true;
		}
		solver->mixed = solver->mixed && solver->bounces;
		const enum rb_status status = create_springs(solver, model, err);
		return status == RB_OK ? create_joints(solver, model, err) : status;
	}
	rb_solver_release(solver);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the solver of %zu bodies", n - 1);
}

void rb_solver_release(struct rb_solver *solver)
{
	rb_memory_free(solver->dense.bodies.body);
	rb_memory_free(solver->dense.row);
	rb_memory_free(solver->point);
	rb_memory_free(solver->tensor);
	rb_memory_free(solver->free);
	rb_memory_free(solver->parent);
	rb_memory_free(solver->island_of);
	rb_memory_free(solver->member);
	rb_memory_free(solver->local);
	rb_memory_free(solver->reach);
	rb_memory_free(solver->loaded);
	rb_memory_free(solver->clear);
	rb_memory_free(solver->rests);
	rb_memory_free(solver->asleep);
	rb_memory_free(solver->residual);
	rb_memory_free(solver->rest_external);
	rb_memory_free(solver->island);
	rb_memory_free(solver->joint);
	rb_memory_free(solver->active_joint);
	rb_memory_free(solver->stiff);
	rb_memory_free(solver->after_forces);
	rb_memory_free(solver->reduced_motion);
	rb_memory_free(solver->spring);
	*solver = (struct rb_solver){0};
}

double rb_solver_tolerance(const struct rb_model *model, double h)
{
	return RB_STRATEGY_SWEEP_SHARE * model->stepped_tolerance_m / h;
}

/* ---- all islands ---- */

struct work {
	struct rb_solver *solver;
	struct rb_world *world;
	const int *first; /* [blocks + 1]: first island of each block */
	bool second;
	/* points whose impacts rebound; NULL: no rebound in this pass */
	const struct rb_step_points *rebound;
};

static bool is_due(const struct work *work, const struct rb_island *island)
{
	if (work->second)
		return rb_second_half_is_due(work->solver, island);
	return work->rebound ? island->rebounds : !island->kept && !island->reduced;
}

static void solve_group(const struct work *work, struct rb_island *island, struct rb_team *team,
                        struct rb_arena *arena)
{
	const rb_arena_mark here = rb_arena_here(arena);

	if (!work->rebound ||
	    !rb_joined_rebound(work->solver, work->world, work->rebound, island, arena))
		rb_strategies_solve(work->solver, island, team, arena);
	rb_arena_back(arena, here);
}

static void solve_block(void *user, int block, int worker)
{
	const struct work *work = user;

	for (int g = work->first[block]; g < work->first[block + 1]; g++) {
		struct rb_island *island = &work->solver->island[g];

		if (island->row_count >= RB_STRATEGY_LARGE_ROWS || !is_due(work, island) ||
		    rb_interrupt_is_set(work->solver->interrupt))
			continue;
		solve_group(work, island, NULL, &work->world->arena[worker]);
	}
}

static enum rb_status solve_all(struct work *work, struct rb_error *err)
{
	struct rb_solver *solver = work->solver;
	struct rb_arena *arena = &work->world->arena[0];
	int *first = rb_arena_take(arena, solver->island_count + 1, sizeof *first);
	int blocks = 0, rows = 0;

	if (!first)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	first[0] = 0;
	for (size_t g = 0; g < solver->island_count; g++) {
		if (solver->island[g].row_count < RB_STRATEGY_LARGE_ROWS &&
		    is_due(work, &solver->island[g]))
			rows += solver->island[g].row_count;
		if (rows < BLOCK_ROWS && g + 1 < solver->island_count)
			continue;
		rows = 0;
		first[++blocks] = (int)g + 1;
	}
	RB_ASSERT(first[blocks] == (int)solver->island_count || blocks == 0);
	work->first = first;
	rb_team_run(work->world->team, blocks, solve_block, work);
	for (size_t g = 0; g < solver->island_count; g++)
		if (solver->island[g].row_count >= RB_STRATEGY_LARGE_ROWS &&
		    is_due(work, &solver->island[g]) && !rb_interrupt_is_set(solver->interrupt))
			solve_group(work, &solver->island[g], work->world->team, arena);
	return rb_interrupt_is_set(solver->interrupt)
	               ? RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted")
	               : RB_OK;
}

enum rb_status rb_solver_step(struct rb_solver *solver, struct rb_world *world,
                              const struct rb_state *before, struct rb_step_points *points,
                              double h, struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world};
	enum rb_status status = RB_OK;

	RB_ASSERT(h > 0 && isfinite(h));
	solver->interrupt = &world->interrupt;
	solver->h_s = h;
	solver->before = before;
	solver->tolerance = rb_solver_tolerance(world->model, h);
	for (int k = 0; solver->reduced_motion && k < solver->active_count; k++)
		solver->reduced_motion[solver->active[k]].members = 0;
	status = rb_islands_make(solver, world, points, err);
	if (status != RB_OK)
		return status;
	if (before)
		solver->external = rb_strategies_external(solver, solver->active,
		                                          solver->active_count, (double)INFINITY);
	status = solve_all(&work, err);
	if (status == RB_OK)
		rb_islands_end(solver, world, points);
	return status;
}

/* Earlier results of islands without a mark: restored when islands have been built anew. */
struct earlier {
	struct rb_solver_body *body; /* by body */
	struct rb_island *island;
	int *island_of;
	unsigned char *rests;
};

static bool take_earlier(const struct rb_solver *solver, struct rb_arena *arena,
                         struct earlier *earlier)
{
	const size_t n = (size_t)solver->body_count + 1;

	earlier->body = rb_arena_take(arena, n, sizeof *earlier->body);
	earlier->island_of = rb_arena_take(arena, n, sizeof *earlier->island_of);
	earlier->island = rb_arena_take(arena, solver->island_count + 1, sizeof *earlier->island);
	earlier->rests = rb_arena_take(arena, n, 1);
	if (!earlier->body || !earlier->island_of || !earlier->island || !earlier->rests)
		return false;
	memcpy(earlier->rests, solver->rests, (size_t)solver->body_count);
	memcpy(earlier->body, solver->dense.bodies.body, n * sizeof *earlier->body);
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

		RB_ASSERT(island->member_count > 0);
		if (again[member[0]])
			continue;
		RB_ASSERT(earlier->island_of[member[0]] >= 0);
		const struct rb_island *previous = &earlier->island[earlier->island_of[member[0]]];
		island->kept = true;
		island->sweeps = previous->sweeps;
		island->factors = previous->factors;
		island->residual = previous->residual;
		island->slip = previous->slip;
		island->energy_budget = previous->energy_budget;
		for (int k = 0; k < island->member_count; k++) {
			solver->dense.bodies.body[member[k]] = earlier->body[member[k]];
			solver->rests[member[k]] = earlier->rests[member[k]];
		}
	}
}

void rb_solver_forget_rest(struct rb_solver *solver, const int *body, int count)
{
	for (int k = 0; k < count; k++)
		solver->rests[body[k]] = solver->rests[body[k]] && solver->asleep[body[k]];
}

enum rb_status rb_solver_again(struct rb_solver *solver, struct rb_world *world,
                               struct rb_step_points *points, const unsigned char *again,
                               struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world};
	struct earlier earlier;

	if (!take_earlier(solver, &world->arena[0], &earlier))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	rb_solver_forget_rest(solver, solver->active, solver->active_count);
	enum rb_status status = rb_islands_make(solver, world, points, err);
	if (status != RB_OK)
		return status;
	put_back(solver, &earlier, again);
	status = solve_all(&work, err);
	if (status == RB_OK)
		rb_islands_end(solver, world, points);
	return status;
}

void rb_solver_go_back(const struct rb_solver *solver, struct rb_world *world)
{
	const struct rb_solver_body *given = solver->after_forces ? solver->after_forces
	                                                          : solver->free;

	rb_state_copy_rows(&world->state, &world->mark, solver->active, solver->active_count);
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k];

		rb_vec3_to(world->state.velocity + 3 * (size_t)i, given[i].linear);
		if (world->state.spin)
			rb_vec3_to(world->state.spin + 3 * (size_t)i, given[i].angular);
		if (solver->kicks && rb_kick_of(solver->kicks, i)->turns)
			rb_quat_to(world->state.orientation + 4 * (size_t)i,
			           rb_kick_of(solver->kicks, i)->orientation);
	}
}

enum rb_status rb_solver_end(struct rb_solver *solver, struct rb_world *world, struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world, .second = true};
	const struct rb_state *const before = solver->before;

	if (!rb_second_half_make(solver, world))
		return RB_OK;
	solver->before = NULL; /* velocities alone: no island comes to rest, no energy is checked */
	const enum rb_status status = solve_all(&work, err);

	solver->before = before;
	if (status == RB_OK)
		rb_second_half_end(solver, world);
	return status;
}

/* Whether restitution of this point gives a rebound faster than the tolerance. */
static bool rebounds(const struct rb_solver *solver, const struct rb_step_point *point)
{
	return point->normal_impulse > 0 &&
	       (solver->hands_over ||
	        point->material->restitution * point->approach > solver->tolerance);
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
		const struct rb_solver_body change = rb_energy_rebound_change(solver, world, i);
		rb_vec3_to(v, rb_vec3_add_scaled(rb_vec3_from(v), share, change.linear));
		if (!world->state.spin)
			continue;
		double *const w = world->state.spin + 3 * (size_t)i;
		rb_vec3_to(w, rb_vec3_add_scaled(rb_vec3_from(w), share, change.angular));
	}
}

/*
 * Sets targets of joint rows: the velocities that they have been solved for, or a rebound; returns
 * whether one rebounds.
 */
static bool joints_rebound(struct rb_solver *solver, const struct rb_world *world)
{
	const struct rb_joint_query query = rb_islands_joints(solver, world);
	const double tolerance = rb_islands_joint_tolerance(solver);
	bool any = false;

	for (int k = 0; k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		const struct rb_step_joint *of = &solver->joint[number];

		if (of->first_row < 0)
			continue;
		struct rb_constraint *const row = solver->dense.row + of->first_row;
		struct rb_island *const island = &solver->island[solver->island_of[row->a]];
		const bool back = rb_step_joint_rows_rebound(&query, number, of, row, tolerance);

		island->rebounds = island->rebounds || back;
		any = any || back;
	}
	return any;
}

/* Makes rows of springs inactive: they have acted already. */
static void disable_springs(struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		const struct rb_step_spring *spring = &solver->spring[k];
		struct rb_constraint *row = solver->dense.row + spring->first_row;

		for (int r = 0; spring->first_row >= 0 && r < rb_step_spring_row_count(spring);
		     r++) {
			rb_constraint_clear(&row[r]);
			row[r].low = row[r].high = row[r].softness = row[r].target.n = 0;
		}
	}
}

static void store_joints(struct rb_solver *solver, const struct rb_joint_query *joints)
{
	struct rb_joint_query query = *joints;

	query.from = solver->free;
	for (int k = 0; k < solver->active_joint_count; k++) {
		struct rb_step_joint *of = &solver->joint[solver->active_joint[k]];

		if (of->first_row < 0)
			continue;
		const struct rb_constraint *const row = solver->dense.row + of->first_row;
		const struct rb_island *island = &solver->island[solver->island_of[row->a]];

		query.share = island->share;
		if (island->rebounds)
			rb_step_joint_rows_store(&query, solver->active_joint[k], of, row);
	}
}

/* Moves a row to where the impulse of a rebound acts, as bodies have moved since it was made. */
static void update_row(struct rb_solver *solver, const struct rb_world *world,
                       struct rb_constraint *row)
{
	if (row->b < solver->body_count && solver->dense.bodies.body[row->b].inverse_mass > 0) {
		const rb_vec3 d = rb_islands_between(solver, world->state.position, row->a, row->b);

		if (row->central)
			row->normal = rb_levers_normal(d, row->normal);
		rb_levers_join_row(world, d, row);
	}
	rb_effective_mass_fill(&solver->dense.bodies, row);
}

/* Whether impacts at an island's contacts need a rebound, or another law than the step's rows. */
static bool island_rebounds(const struct rb_solver *solver, const struct rb_world *world,
                            const struct rb_step_points *points, const struct rb_island *island)
{
	const int *const number = &solver->point[island->first_row];
	int touching = 0;
	bool due = false;

	if (rb_islands_has_no_rows(island))
		return false;
	/* as the law sees it: what touched before takes part, even if the impact lifts it */
	for (int k = 0; k < island->contact_count; k++)
		touching += points->row[number[k]].normal_impulse > 0 ||
		            points->row[number[k]].gap <= world->model->stepped_tolerance_m;
	for (int k = 0; k < island->contact_count && !due; k++)
		due = rebounds(solver, &points->row[number[k]]) ||
		      rb_joined_rebound_is_due(solver, world, points, &points->row[number[k]],
		                               touching == 1);
	return due;
}

bool rb_solver_rebounds(const struct rb_solver *solver)
{
	return solver->bounces || solver->joints_bounce || solver->joined_friction ||
	       solver->hands_over;
}

enum rb_status rb_solver_rebound(struct rb_solver *solver, struct rb_world *world,
                                 const struct rb_step_points *points, rb_vec3 *rebound,
                                 struct rb_error *err)
{
	struct work work = {.solver = solver, .world = world, .rebound = points};
	bool any = false;

	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *island = &solver->island[g];

		island->rebounds = island_rebounds(solver, world, points, island);
		any = any || island->rebounds;
	}
	any = joints_rebound(solver, world) || any;
	if (!any)
		return RB_OK;
	disable_springs(solver);
	RB_ASSERT(rebound != NULL);
	const struct rb_joint_query joints = rb_islands_joints(solver, world);
	solver->before = NULL; /* a rebounding body is not at rest */
	for (int k = 0; k < solver->active_count; k++)
		solver->free[solver->active[k]] = solver->dense.bodies.body[solver->active[k]];
	for (int k = 0; k < solver->dense.row_count; k++) {
		struct rb_constraint *row = &solver->dense.row[k];

		if (row->set != RB_CONSTRAINT_CONE)
			continue;
		const struct rb_step_point *point = &points->row[solver->point[k]];

		if (solver->joins_arms) /* bodies have moved since */
			update_row(solver, world, row);
		const double now = rb_vec3_dot(rb_constraint_velocity(&solver->dense.bodies, row),
		                               row->normal);

		/*
		 * rows without impulse stay inactive; the others do not close faster than they were
		 * left to
		 */
		row->target.n = point->normal_impulse > 0 ? fmin(now, 0) : -(double)INFINITY;
		if (rebounds(solver, point))
			row->target.n = fmax(0, point->material->restitution * point->approach);
		rb_constraint_clear(row);
	}
	const enum rb_status status = solve_all(&work, err);
	if (status != RB_OK)
		return status;
	add_rebound(solver, world);
	for (int k = 0; k < solver->dense.row_count; k++) {
		const struct rb_constraint *row = &solver->dense.row[k];
		const struct rb_island *island = &solver->island[solver->island_of[row->a]];

		if (island->rebounds && row->set == RB_CONSTRAINT_CONE)
			rebound[solver->point[k]] = rb_vec3_scale(island->share,
			                                          rb_constraint_impulse(row));
	}
	store_joints(solver, &joints);
	return RB_OK;
}
