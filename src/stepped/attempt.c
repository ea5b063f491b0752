/* SPDX-License-Identifier: MIT */
/*
 * One attempt of a step, in the order of the figure in stepped.h: driven bodies, forces, contact
 * points, impacts, solution, motion, relinearization where rotation has made overlaps, rebound. The
 * same code serves all bodies (`all`) and a group that takes substeps (`part`). Nothing is
 * committed here: on failure the caller copies the mark back.
 *
 * Bodies without contact impulses move with the mean of the old and the new velocity, which is
 * exact for constant forces (a parabola); bodies in contact move with the solved velocity, since
 * gaps were closed for it (Moreau; Anitescu and Potra 1997).
 */
#include "stepped/attempt.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "step/flow.h"
#include "stepped/find_points.h"
#include "stepped/relinearize.h"
#include "stepped/driven_bodies.h"
#include "stepped/force.h"
#include "stepped/impact_pass.h"
#include "stepped/joint_steps.h"
#include "stepped/nets.h"
#include "stepped/sleep.h"
#include "stepped/spring_steps.h"
#include "stepped/strategies.h"
#include "stepped/tally.h"

/*
 * Limit of relinearizations of a step, which are Newton steps. The first leaves errors of higher
 * order in the angle, and the projection closes them. Further ones serve heaps that would be rolled
 * back, and the nonlinear part of joints' motion: each reduces the error by about the angle of a
 * step, and a pendulum takes one or none.
 */
enum { INSPECTIONS_MAX = 6 };

/*
 * A gap below this share of the approach in a whole step counts as closed. An impact must exceed
 * the speed that forces make in IMPACT_STEPS steps.
 */
static const double closed_share = 1e-3;
enum { IMPACT_STEPS = 4 };
/* Cost of sweeping a row, and of its part of a factorization, in multiplications. */
enum { SWEEP_COST = 100, FACTOR_COST = 250 };

struct flow {
	struct rb_world *world;
	const struct rb_cohort *cohort;
	double h_s;
};

/*
 * Free rotation of a body with unequal moments of inertia: without torque in closed form
 * (math/top); where contacts or impacts have changed its spin in this step, by the integrator that
 * conserves energy and angular momentum. False: the inertia is a scalar, and rotation about the
 * present axis is exact.
 */
static bool turn_freely(struct rb_world *world, int i, double h)
{
	const struct rb_stepped *s = world->stepped;
	struct rb_state *state = &world->state;
	const rb_vec3 before = rb_vec3_add(rb_world_row3(world->mark.spin, i),
	                                   rb_impacts_spin(s, i));
	const rb_vec3 none = {0, 0, 0};
	rb_quat orientation = rb_quat_from(state->orientation + 4 * (size_t)i);
	rb_vec3 spin = rb_world_row3(state->spin, i);

	if (!s->top || s->top[i].kind == RB_TOP_CONSTANT)
		return false;
	if (s->solver.loaded[i] || rb_vec3_max_abs(rb_vec3_sub(before, spin)) > 0) {
		rb_top_step(&s->top[i], h, &orientation, &spin);
	} else {
		struct rb_top top = rb_top_start(&s->top[i], orientation, spin, none);

		rb_top_at(&top, h, &orientation, &spin);
	}
	rb_quat_to(state->orientation + 4 * (size_t)i, orientation);
	rb_vec3_to(state->spin + 3 * (size_t)i, spin);
	return true;
}

/*
 * Mean of the velocities before and after, for a body without contact impulses, m/s. `varied` adds
 * the other half of forces that depend on position or velocity: their impulse moves the body in
 * full, as in symplectic Euler, since the half would make springs gain energy.
 */
static rb_vec3 free_velocity(const struct rb_world *world, int i)
{
	const struct rb_stepped *s = world->stepped;
	rb_vec3 sum = rb_vec3_add(rb_world_row3(world->state.velocity, i),
	                          rb_world_row3(world->mark.velocity, i));

	if (s->varied)
		sum = rb_vec3_add(sum, rb_world_row3(s->varied, i));
	return rb_vec3_scale(0.5, sum);
}

/*
 * Velocity of the centre of mass through the step, m/s: the solved one for a body with contact
 * impulses.
 */
static rb_vec3 moving_velocity(const struct rb_world *world, int i)
{
	return rb_solver_is_free(&world->stepped->solver, i) || rb_nets_of(world->stepped, i) >= 0
	               ? free_velocity(world, i)
	               : rb_world_row3(world->state.velocity, i);
}

/* ---- bodies without impulses of rows ---- */

static unsigned char clear_of(const struct rb_solver *solver, int i)
{
	return __atomic_load_n(&solver->clear[i], __ATOMIC_RELAXED);
}

/* Difference between the free displacement of a body and that by its solved velocity, m. */
static rb_vec3 free_shift(const struct rb_world *world, int i, double h)
{
	const struct rb_solver *solver = &world->stepped->solver;

	if (i >= solver->body_count || clear_of(solver, i) == RB_CLEAR_NO)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_scale(
		h, rb_vec3_sub(free_velocity(world, i), rb_world_row3(world->state.velocity, i)));
}

/* Gap of a point at the end of the step by the linear model of the solution, m. */
static double solved_gap(const struct rb_solver *solver, const struct rb_step_point *point,
                         double h)
{
	const struct rb_solver_body *body = solver->dense.bodies.body;
	const struct rb_solver_body *a = &body[point->a];
	const struct rb_solver_body *b =
		&body[point->b < solver->body_count ? point->b : solver->body_count];
	rb_vec3 v = rb_vec3_sub(b->linear, a->linear);

	if (!point->central)
		v = rb_vec3_add(v, rb_vec3_sub(rb_vec3_cross(b->angular, point->arm_b),
		                               rb_vec3_cross(a->angular, point->arm_a)));
	return point->gap + h * rb_vec3_dot(v, point->normal) + point->bend;
}

enum { UNPUSHED, CLEAR, CLEAR_PHASES };

struct clear {
	struct rb_world *world;
	const struct rb_cohort *cohort;
	double h_s;
	bool any; /* some body may be free; written by all workers */
};

/* Marks bodies of islands that may be free: without impulse from a row or an impact. */
static void find_unpushed(struct clear *clear, int i)
{
	const struct rb_solver *solver = &clear->world->stepped->solver;
	const int g = solver->island_of[i];

	solver->clear[i] = RB_CLEAR_NO;
	if (g < 0 || solver->loaded[i] || solver->island[g].kept || solver->island[g].reduced ||
	    solver->rests[i] || rb_kicks_have(solver->kicks, i))
		return;
	solver->clear[i] = RB_CLEAR_MAYBE;
	__atomic_store_n(&clear->any, true, __ATOMIC_RELAXED);
}

/*
 * Marks a candidate as not free. Others stay as they are: nobody else sets driven bodies, and the
 * result for a body must not depend on the order of its points.
 */
static void block(const struct rb_solver *solver, int i)
{
	if (clear_of(solver, i) != RB_CLEAR_NO)
		__atomic_fetch_or(&solver->clear[i], RB_CLEAR_BLOCKED, __ATOMIC_RELAXED);
}

/*
 * Blocks both bodies if the point would close on the free path too, whatever the other body does.
 */
static void find_blocked(const struct clear *clear, const struct rb_step_point *point)
{
	const struct rb_solver *solver = &clear->world->stepped->solver;
	const double h = clear->h_s;
	const bool has_b = point->b < solver->body_count;

	if (clear_of(solver, point->a) == RB_CLEAR_NO &&
	    (!has_b || clear_of(solver, point->b) == RB_CLEAR_NO))
		return;
	const double a = rb_vec3_dot(free_shift(clear->world, point->a, h), point->normal);
	const double b = rb_vec3_dot(free_shift(clear->world, point->b, h), point->normal);
	if (solved_gap(solver, point, h) - fmax(a, 0) + fmin(b, 0) > 0)
		return;
	block(solver, point->a);
	if (has_b)
		block(solver, point->b);
}

static void clear_block(void *user, int phase, int block, int worker)
{
	struct clear *clear = user;
	const struct rb_cohort *cohort = clear->cohort;
	const size_t count = phase == CLEAR ? cohort->points.count : (size_t)cohort->member_count;
	const size_t first = (size_t)block * RB_BODIES_PER_BLOCK;
	const size_t end = first + RB_BODIES_PER_BLOCK < count ? first + RB_BODIES_PER_BLOCK
	                                                       : count;

	(void)worker;
	for (size_t k = first; phase == UNPUSHED && k < end; k++)
		find_unpushed(clear, cohort->body[k]);
	for (size_t k = first; phase == CLEAR && clear->any && k < end; k++)
		find_blocked(clear, &cohort->points.row[k]);
}

/*
 * Finds the bodies of islands that move as free ones: without impulse, and clear of all candidates
 * on the free path too, whatever the other body of a pair does. Whether a pair that does not meet
 * is inspected follows from axis-aligned boxes, and must not decide how a body moves.
 */
static void find_clear(struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	const int per_block = RB_BODIES_PER_BLOCK;
	struct clear clear = {.world = world, .cohort = cohort, .h_s = h};
	const int blocks[CLEAR_PHASES] = {
		[UNPUSHED] = (cohort->member_count + per_block - 1) / per_block,
		[CLEAR] = ((int)cohort->points.count + per_block - 1) / per_block};

	rb_team_run_phases(world->team, blocks, CLEAR_PHASES, clear_block, &clear);
}

static bool swings(const struct rb_world *world, int i)
{
	const struct rb_solver *const solver = &world->stepped->solver;

	return solver->island_of[i] >= 0 && solver->island[solver->island_of[i]].reduced;
}

/* Moves a body of a group in reduced coordinates to where its joints have led it. */
static void move_reduced(struct rb_world *world, int i)
{
	const struct rb_reduced_motion *const swung = &world->stepped->solver.reduced_motion[i];

	rb_vec3_to(world->state.position + 3 * (size_t)i, swung->position);
	rb_quat_to(world->state.orientation + 4 * (size_t)i, swung->orientation);
}

/* Moves one block of the cohort's bodies; blocks write disjoint rows. */
static void move_block(void *user, int block, int worker)
{
	const struct flow *flow = user;
	struct rb_world *world = flow->world;
	const int first = block * RB_BODIES_PER_BLOCK, n = flow->cohort->member_count;
	const int end = first + RB_BODIES_PER_BLOCK < n ? first + RB_BODIES_PER_BLOCK : n;
	struct rb_pass pass = {.world = world,
	                       .arena = &world->arena[worker],
	                       .member_count = 1,
	                       .h_s = flow->h_s};

	for (int k = first; k < end; k++) {
		const int i = flow->cohort->body[k];
		const rb_vec3 v = moving_velocity(world, i);

		if (swings(world, i)) {
			move_reduced(world, i);
			continue;
		}
		rb_vec3_to(
			world->state.position + 3 * (size_t)i,
			rb_vec3_add_scaled(rb_world_row3(world->state.position, i), flow->h_s, v));
		rb_impacts_shift(world->stepped, &world->state, i);
		if (!world->state.spin || rb_nets_turn(world, i) ||
		    rb_vec3_max_abs(rb_world_row3(world->state.spin, i)) == 0 ||
		    turn_freely(world, i, flow->h_s))
			continue;
		pass.member = flow->cohort->body + k;
		rb_stage_rotate.run(&pass);
	}
}

static void move(struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	struct flow flow = {world, cohort, h};

	rb_team_run(world->team,
	            (cohort->member_count + RB_BODIES_PER_BLOCK - 1) / RB_BODIES_PER_BLOCK,
	            move_block, &flow);
}

/*
 * Whether a body of the island moved at the beginning of the step. One that did not may be known to
 * rest, on which nothing may depend (method/method).
 */
static bool has_moved(const struct rb_world *world, const struct rb_island *island)
{
	const int *const member = world->stepped->solver.member + island->first_member;
	const struct rb_state *const mark = &world->mark;
	bool moved = false;

	for (int k = 0; k < island->member_count && !moved; k++)
		moved = rb_vec3_max_abs(rb_world_row3(mark->velocity, member[k])) > 0 ||
		        (mark->spin && rb_vec3_max_abs(rb_world_row3(mark->spin, member[k])) > 0);
	return moved;
}

/* Adds up the work of the islands; the projection reuses the solver afterwards. */
static void count_work(struct rb_world *world)
{
	const struct rb_solver *solver = &world->stepped->solver;
	struct rb_counts *counts = &world->frame_counts;

	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];

		if (island->kept)
			continue;
		counts->row_sweeps += (uint64_t)island->sweeps * (uint64_t)island->row_count;
		counts->rows += (uint64_t)island->row_count;
		counts->factors += (uint64_t)island->factors;
		if (has_moved(world, island))
			counts->solving += (uint64_t)island->row_count *
			                   (SWEEP_COST * (uint64_t)island->sweeps +
			                    FACTOR_COST * (uint64_t)island->factors);
	}
}

/*
 * Moves bodies; where that makes overlaps that linearized rotation does not contain, the solution
 * is repeated from the poses at the end (relinearize.c).
 */
static enum rb_status move_and_inspect(struct rb_world *world, struct rb_cohort *cohort, double h,
                                       struct rb_error *err)
{
	bool again = true;
	enum rb_status status = RB_OK;

	cohort->has_depths = false;
	for (int inspections = 0; again && status == RB_OK; inspections++) {
		count_work(world);
		find_clear(world, cohort, h);
		move(world, cohort, h);
		rb_drive_end(world);
		again = false;
		if (inspections < INSPECTIONS_MAX && (world->broadphase || world->model->joints ||
		                                      world->stepped->solver.sprung_count > 0))
			status = rb_relinearize(world, cohort, inspections, &again, err);
	}
	return status;
}

/*
 * Finds the cohort's contact points within the reach of the step. Only the cohort of all bodies has
 * sleeping groups.
 */
static enum rb_status find_points(struct rb_world *world, struct rb_cohort *cohort, double start,
                                  double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = RB_OK;

	cohort->points.count = 0;
	if (!world->broadphase)
		return RB_OK;
	if (cohort == &s->all) {
		status = rb_sleep_points(world, start, h, err);
	} else {
		rb_candidates_reach(cohort->candidates, world, h, cohort->body, cohort->body_count);
		rb_candidates_place(cohort->candidates, world, cohort->body, cohort->body_count);
		status = rb_step_points_add(&cohort->points, world, cohort->candidates, h, HUGE_VAL,
		                            err);
	}
	return status;
}

/* Separation speed of a point along the normal after forces, m/s. */
static double separation_speed(const struct rb_solver *solver, const struct rb_step_point *point)
{
	const struct rb_solver_bodies bodies = {.body = solver->free, .tensor = solver->tensor};
	const struct rb_constraint row = rb_islands_row_of(solver, point);

	return rb_vec3_dot(rb_constraint_velocity(&bodies, &row), point->normal);
}

/*
 * Finds the first impact of each mechanism. The solution lets a gap close by the end of a step: of
 * an impact in the middle of it, it gives one part now and the other in the next step. For normal
 * impulses the sum is the same; friction in two parts, each in its own cone, differs from that of
 * the whole by as much as it is itself, however short the step. (Bodies without joints are handled
 * by impact_pass.) The step should be cut where the gap has closed. An approach that forces alone
 * make in a few steps is no impact.
 */
static void find_impacts(const struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	const struct rb_solver *solver = &world->stepped->solver;
	const struct rb_step_points *points = &cohort->points;

	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *const island = &solver->island[g];
		const int *const member = solver->member + island->first_member;

		island->impact_s = (double)INFINITY;
		if (rb_islands_has_no_rows(island) || island->contact_count == 0 ||
		    island->row_count == island->contact_count + island->spring_count)
			continue;
		const double approach_min = IMPACT_STEPS * sqrt(rb_strategies_external(
								   solver, member,
								   island->member_count, HUGE_VAL));

		for (int k = 0; k < island->contact_count; k++) {
			const struct rb_step_point *const point =
				&points->row[solver->point[island->first_row + k]];
			const double approach = point->approach;
			const double more = -separation_speed(solver, point) - approach;

			if (!(point->normal_impulse > 0) || !(point->material->friction > 0) ||
			    (point->from > 0 && points->last[point->from - 1].force > 0) ||
			    !(approach > approach_min) ||
			    !(point->gap > closed_share * solver->whole_s * approach) ||
			    !(h * approach > world->model->stepped_tolerance_m))
				continue;
			/* gap = t (approach + more t / h) */
			const double root = sqrt(approach * approach +
			                         4 * fmax(0, more) / h * point->gap);

			island->impact_s = fmin(island->impact_s,
			                        2 * point->gap / (approach + root));
		}
	}
}

enum rb_status rb_attempt(struct rb_world *world, struct rb_cohort *cohort, double start, double h,
                          struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = rb_drive_begin(world, start, h, err);

	RB_ASSERT(h > 0 && cohort->member_count <= cohort->body_count);
	cohort->has_closing_impulses = false;
	if (status == RB_OK)
		status = rb_force_add(world, cohort, start, h, err);
	if (status == RB_OK)
		status = find_points(world, cohort, start, h, err);
	if (status == RB_OK)
		status = rb_joints_begin_attempt(world, cohort, start, h, err);
	if (status == RB_OK)
		status = rb_impacts_resolve(world, cohort, start, h, err);
	s->solver.active = cohort->body;
	s->solver.active_count = cohort->body_count;
	s->solver.kicks = s->kicks.count > 0 ? &s->kicks : NULL;
	if (status == RB_OK)
		status = rb_springs_join(world, cohort, h, err);
	if (status == RB_OK)
		status = rb_solver_step(&s->solver, world, &world->mark, &cohort->points, h, err);
	if (status == RB_OK)
		status = rb_springs_join_pushed(world, cohort, err);
	if (status != RB_OK)
		return status;
	status = move_and_inspect(world, cohort, h, err);
	rb_springs_measure(world);
	rb_nets_end(world);
	if (status == RB_OK && world->model->joints)
		find_impacts(world, cohort, h);
	if (status == RB_OK)
		status = rb_solver_end(&s->solver, world, err);
	if (status != RB_OK)
		return status;
	if (s->tally)
		rb_springs_record(world);
	if (s->tally)
		rb_tally_solved(world, cohort);
	if (cohort == &s->all) {
		rb_sleep_mark(world);
		world->frame_counts.rows += s->sleep.point_count;
	}
	s->solver.hands_over = world->located && world->dense_left == 1;
	cohort->rebounds = rb_solver_rebounds(&s->solver);
	if (!cohort->rebounds)
		return RB_OK;
	if (!rb_memory_reserve(&cohort->rebound, &cohort->rebound_capacity,
	                       cohort->points.count + 1, sizeof *cohort->rebound))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (cohort->points.count > 0)
		memset(cohort->rebound, 0, cohort->points.count * sizeof *cohort->rebound);
	return rb_solver_rebound(&s->solver, world, &cohort->points, cohort->rebound, err);
}

void rb_attempt_discard(const struct rb_cohort *cohort, size_t bytes)
{
	const struct rb_step_points *const points = &cohort->points;
	void *const list[] = {points->row,
	                      points->chosen,
	                      points->last,
	                      cohort->rebound,
	                      cohort->closing_impulse,
	                      cohort->impact,
	                      cohort->transmitted.row,
	                      cohort->ledger_impact};

	for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
		rb_memory_discard(list[k], bytes);
}
