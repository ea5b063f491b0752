/* SPDX-License-Identifier: MIT */
#include "stepped/spring_steps.h"

#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "force/spring.h"
#include "model/joints.h"
#include "stepped/nets.h"
#include "stepped/tally.h"
#include "world/joint_state.h"

/*
 * As for joints (stepped/joint_steps): share of the tolerance, and reduction since the last
 * relinearization.
 */
static const double inspect_share = 1.0 / 16, gain_share = 0.5;

/* ---- selection ---- */

/* Why the bodies of a tree are held. */
enum { BY_JOINTS = 1, BY_PUSHES = 2 };

/* Trees of bodies connected by springs that may get rows. */
struct web {
	int *parent;         /* [bodies]: union-find of the step's bodies */
	unsigned char *held; /* [bodies]: flags BY_... at roots */
};

static bool is_held_by_joints(const struct rb_world *world, int i)
{
	const struct rb_joints *joints = world->model->joints;

	for (int e = joints ? joints->first[i] : 0; joints && e < joints->first[i + 1]; e++)
		if (!world->joint[joints->of[e]].released)
			return true;
	return false;
}

/* Whether anything may hold a body. */
static bool may_hold(const struct rb_world *world, const struct rb_cohort *cohort)
{
	bool any = world->model->joints || world->stepped->kicks.count > 0;

	for (size_t k = 0; k < cohort->points.count && !any; k++)
		any = cohort->points.row[k].normal_impulse > 0;
	return any;
}

static void mark_held(struct web *web, int i, unsigned char by)
{
	web->held[rb_forest_root(web->parent, i)] |= by;
}

/* Whether the step moves the body: dynamic and not asleep. */
static bool is_solved(const struct rb_world *world, const struct web *web, int i)
{
	return rb_stepped_is_dynamic(world, i) && web->parent[i] >= 0;
}

static bool may_join(const struct rb_world *world, const struct web *web,
                     const struct rb_step_spring *spring)
{
	for (int e = 0; e < 2; e++)
		if (rb_stepped_is_dynamic(world, spring->end[e]) &&
		    !is_solved(world, web, spring->end[e]))
			return false;
	return true;
}

static void link_ends(const struct rb_world *world, const struct web *web,
                      const struct rb_step_spring *spring)
{
	if (!may_join(world, web, spring) || !rb_stepped_is_dynamic(world, spring->end[0]) ||
	    !rb_stepped_is_dynamic(world, spring->end[1]))
		return;
	const int a = rb_forest_root(web->parent, spring->end[0]);
	const int b = rb_forest_root(web->parent, spring->end[1]);

	web->parent[a > b ? a : b] = a > b ? b : a;
}

static enum rb_status build_web(struct rb_world *world, const struct rb_cohort *cohort,
                                struct web *web, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;
	const size_t n = (size_t)world->model->body_count;

	web->parent = rb_arena_take(&world->arena[0], n, sizeof *web->parent);
	web->held = rb_arena_take(&world->arena[0], n, 1);
	if (!web->parent || !web->held)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the springs of a step");
	memset(web->held, 0, n);
	for (size_t i = 0; i < n; i++)
		web->parent[i] = -1;
	for (int k = 0; k < cohort->member_count; k++)
		web->parent[cohort->body[k]] = cohort->body[k];
	for (int k = 0; k < s->solver.spring_count; k++)
		link_ends(world, web, &s->solver.spring[k]);
	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k];

		if (is_held_by_joints(world, i))
			mark_held(web, i, BY_JOINTS);
		if (rb_kicks_have(&s->kicks, i))
			mark_held(web, i, BY_PUSHES);
	}
	for (size_t k = 0; k < cohort->points.count; k++) {
		const struct rb_step_point *point = &cohort->points.row[k];

		if (!(point->normal_impulse > 0))
			continue;
		if (is_solved(world, web, point->a))
			mark_held(web, point->a, BY_PUSHES);
		if (is_solved(world, web, point->b))
			mark_held(web, point->b, BY_PUSHES);
	}
	return RB_OK;
}

/* Takes back an impulse of forces, as reduced by drag. */
static void revert_impulse(struct rb_world *world, int i, rb_vec3 impulse, rb_vec3 arm)
{
	struct rb_stepped *s = world->stepped;
	const size_t row = 3 * (size_t)i;
	const double left = s->undragged ? s->undragged[i] : 1;

	if (!rb_stepped_is_dynamic(world, i))
		return;
	rb_vec3_to(world->state.velocity + row,
	           rb_vec3_add_scaled(rb_vec3_from(world->state.velocity + row),
	                              -left * world->model->inverse_mass[i], impulse));
	if (world->state.spin)
		rb_vec3_to(world->state.spin + row,
		           rb_vec3_sub(rb_vec3_from(world->state.spin + row),
		                       rb_world_turn(world, &world->state, i,
		                                     rb_vec3_cross(arm, impulse))));
	if (s->tally && left != 1)
		s->tally->body[i].drag = rb_vec3_add_scaled(s->tally->body[i].drag, 1 - left,
		                                            impulse);
}

/* Whether a spring without rows must get them: one that is resolved only where halves are taken. */
static bool is_due(const struct rb_world *world, struct web *web,
                   const struct rb_step_spring *spring)
{
	const int first = spring->end[0];

	if (spring->joined || !may_join(world, web, spring))
		return false;
	const unsigned char held = web->held[rb_forest_root(
		web->parent, rb_stepped_is_dynamic(world, first) ? first : spring->end[1])];
	return spring->resolved ? held == BY_JOINTS : held != 0;
}

static bool any_due(const struct rb_world *world, struct web *web)
{
	const struct rb_solver *solver = &world->stepped->solver;
	bool any = false;

	for (int k = 0; k < solver->spring_count && !any; k++)
		any = is_due(world, web, &solver->spring[k]);
	return any;
}

/* Nonlinear part of a spring's displacement, m, as its ends move and rotate before forces act. */
static rb_vec3 predict_bend(const struct rb_world *world, const struct rb_step_spring *spring,
                            double h)
{
	struct rb_pose pose[2];
	rb_vec3 v[2];

	for (int e = 0; e < 2; e++) {
		const bool moves = rb_stepped_is_dynamic(world, spring->end[e]);

		pose[e] = rb_world_pose(world, moves ? &world->mark : &world->state,
		                        spring->end[e]);
		v[e] = rb_vec3_add(pose[e].velocity, rb_vec3_cross(pose[e].spin, spring->arm[e]));
		pose[e].position = rb_vec3_add_scaled(pose[e].position, h, pose[e].velocity);
		pose[e].orientation = rb_quat_turned(pose[e].orientation,
		                                     rb_vec3_scale(h, pose[e].spin));
	}
	return rb_vec3_sub(rb_step_spring_way(spring, pose),
	                   rb_step_spring_straight(spring, rb_vec3_sub(v[1], v[0]), h));
}

/* Sets what only a spring's rows need. */
static void prepare_rows(const struct rb_world *world, struct rb_step_spring *spring, double h)
{
	const struct rb_elements *springs = rb_model_elements(world->model, &rb_force_spring);
	const struct rb_spring_def *def = rb_elements_row(springs, spring->row);
	const rb_vec3 at[2] = {def->at_a, def->at_b};

	for (int e = 0; e < 2; e++)
		spring->local[e] = rb_element_arm(world->model, spring->end[e], rb_quat_identity,
		                                  at[e]);
	spring->bend = predict_bend(world, spring, h);
}

/* Releases the net of a spring: its springs act alone again. */
static void release_net(struct rb_world *world, const struct rb_step_spring *spring,
                        unsigned char *changed)
{
	const struct rb_nets *nets = world->stepped->nets;
	const int k = nets ? nets->of_spring[spring->row] : -1;

	if (k < 0 || nets->net[k].released)
		return;
	rb_nets_release(world, k);
	for (int b = 0; changed && b < nets->net[k].body_count; b++)
		changed[nets->net[k].body[b].index] = 1;
}

/* Gives rows to springs that are due; sets `changed`, if given, for their bodies. */
static void join_due(struct rb_world *world, struct web *web, double h, unsigned char *changed)
{
	struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < solver->spring_count; k++)
		if (is_due(world, web, &solver->spring[k]))
			release_net(world, &solver->spring[k], changed);
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];

		if (!is_due(world, web, spring))
			continue;
		spring->joined = true;
		prepare_rows(world, spring, h);
		solver->sprung_count++;
		revert_impulse(world, spring->end[0], rb_vec3_neg(spring->impulse), spring->arm[0]);
		revert_impulse(world, spring->end[1], spring->impulse, spring->arm[1]);
		for (int e = 0; changed && e < 2; e++)
			if (rb_stepped_is_dynamic(world, spring->end[e]))
				changed[spring->end[e]] = 1;
	}
}

enum rb_status rb_springs_join(struct rb_world *world, const struct rb_cohort *cohort, double h,
                               struct rb_error *err)
{
	struct web web;
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);

	if (world->stepped->solver.spring_count == 0 || !may_hold(world, cohort))
		return RB_OK;
	const enum rb_status status = build_web(world, cohort, &web, err);
	if (status == RB_OK)
		join_due(world, &web, h, NULL);
	rb_arena_back(&world->arena[0], here);
	return status;
}

/*
 * Whether an unresolved spring without rows ends at a body with a contact impulse: a quick check.
 */
static bool may_join_pushed(const struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		const struct rb_step_spring *spring = &solver->spring[k];

		for (int e = 0; e < 2 && !spring->joined && !spring->resolved; e++)
			if (spring->end[e] < solver->body_count && solver->loaded[spring->end[e]])
				return true;
	}
	return false;
}

/* Marks all bodies of groups with a changed one. */
static void mark_groups(const struct rb_solver *solver, const struct rb_cohort *cohort,
                        unsigned char *changed, unsigned char *of_group)
{
	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k], g = solver->island_of[i];

		if (changed[i] && g >= 0)
			of_group[g] = 1;
	}
	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k], g = solver->island_of[i];

		if (g >= 0 && of_group[g])
			changed[i] = 1;
	}
}

static enum rb_status join_pushed_once(struct rb_world *world, struct rb_cohort *cohort,
                                       bool *again, struct rb_error *err)
{
	struct rb_solver *solver = &world->stepped->solver;
	struct rb_arena *arena = &world->arena[0];
	const size_t n = (size_t)world->model->body_count;
	unsigned char *changed = rb_arena_take(arena, n, 1);
	unsigned char *of_group = rb_arena_take(arena, solver->island_count + 1, 1);
	struct web web;

	if (!changed || !of_group)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the springs of a step");
	memset(changed, 0, n);
	memset(of_group, 0, solver->island_count + 1);
	const enum rb_status status = build_web(world, cohort, &web, err);
	if (status != RB_OK)
		return status;
	*again = any_due(world, &web);
	if (!*again)
		return RB_OK;
	rb_solver_go_back(solver, world);
	join_due(world, &web, solver->h_s, changed);
	mark_groups(solver, cohort, changed, of_group);
	return rb_solver_again(solver, world, &cohort->points, changed, err);
}

enum rb_status rb_springs_join_pushed(struct rb_world *world, struct rb_cohort *cohort,
                                      struct rb_error *err)
{
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	enum rb_status status = RB_OK;
	bool again = true;

	while (again && status == RB_OK && may_join_pushed(&world->stepped->solver)) {
		again = false;
		status = join_pushed_once(world, cohort, &again, err);
		rb_arena_back(&world->arena[0], here);
	}
	return status;
}

/* ---- linearization errors ---- */

/* Displacement of a spring as predicted by the solution, m, from the initial positions. */
static rb_vec3 predicted(const struct rb_solver *solver, const struct rb_step_spring *spring)
{
	const struct rb_spring_query query = rb_islands_springs(solver, spring);
	rb_vec3 v[2];

	for (int e = 0; e < 2; e++) {
		const int i = spring->end[e] < solver->body_count ? spring->end[e]
		                                                  : solver->body_count;

		v[e] = rb_solver_point_velocity(&solver->dense.bodies.body[i], spring->arm[e]);
	}
	return rb_vec3_add(
		spring->bend,
		rb_vec3_add(rb_step_spring_straight(spring, query.shift, 1),
	                    rb_step_spring_straight(spring, rb_vec3_sub(v[1], v[0]), solver->h_s)));
}

static int group_of(const struct rb_solver *solver, const struct rb_step_spring *spring)
{
	return solver->island_of[rb_step_spring_owner(spring, &solver->dense.bodies,
	                                              solver->body_count)];
}

/* Linearization error of a spring with rows at the present poses, m. */
static double measure_error(const struct rb_world *world, struct rb_step_spring *spring)
{
	const struct rb_pose pose[2] = {rb_world_pose(world, &world->state, spring->end[0]),
	                                rb_world_pose(world, &world->state, spring->end[1])};

	spring->missed = rb_vec3_sub(rb_step_spring_way(spring, pose),
	                             predicted(&world->stepped->solver, spring));
	return rb_vec3_length(spring->missed);
}

/*
 * Whether a spring has rows that predict the end of the step: one taken at the beginning has no
 * error.
 */
static bool has_rows(const struct rb_step_spring *spring)
{
	return spring->joined && spring->first_row >= 0 && spring->time != RB_SPRING_AT_BEGIN;
}

bool rb_springs_mark(struct rb_world *world, unsigned char *of_group)
{
	struct rb_solver *solver = &world->stepped->solver;
	const double tolerance = world->model->stepped_tolerance_m;
	bool any = false;

	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];

		if (!has_rows(spring))
			continue;
		const double before = rb_vec3_length(spring->missed);
		const double missed = measure_error(world, spring);

		if (missed <= inspect_share * tolerance ||
		    (missed <= tolerance && !(missed <= gain_share * before)))
			continue;
		of_group[group_of(solver, spring)] = 1;
		any = true;
	}
	return any;
}

void rb_springs_bend(struct rb_world *world, const unsigned char *of_group)
{
	struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];

		if (has_rows(spring) && of_group[group_of(solver, spring)])
			spring->bend = rb_vec3_add(spring->bend, spring->missed);
	}
}

void rb_springs_measure(struct rb_world *world)
{
	struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < solver->spring_count; k++)
		if (has_rows(&solver->spring[k]))
			(void)measure_error(world, &solver->spring[k]);
}

void rb_springs_blame(struct rb_world *world)
{
	const struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < solver->spring_count; k++) {
		const struct rb_step_spring *spring = &solver->spring[k];

		/* written so that NaN is not good */
		if (!has_rows(spring) ||
		    rb_vec3_length(spring->missed) <= world->model->stepped_tolerance_m)
			continue;
		for (int e = 0; e < 2; e++)
			if (rb_stepped_is_dynamic(world, spring->end[e]))
				rb_stepped_blame(world->stepped, spring->end[e]);
	}
}

/* ---- ledger ---- */

void rb_springs_record(struct rb_world *world)
{
	const struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < solver->spring_count; k++) {
		const struct rb_step_spring *spring = &solver->spring[k];
		struct rb_tally_element *element = &world->stepped->tally->element[spring->number];

		if (!spring->joined)
			continue;
		element->on[0] = spring->on[0];
		element->on[1] = spring->on[1];
	}
}
