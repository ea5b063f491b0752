/* SPDX-License-Identifier: MIT */
#include "stepped/second_half.h"

#include "base/error.h"
#include "stepped/energy.h"

static int first_member(const struct rb_solver *solver, const struct rb_island *island)
{
	return solver->member[island->first_member];
}

bool rb_second_half_is_due(const struct rb_solver *solver, const struct rb_island *island)
{
	return island->halves && !solver->rests[first_member(solver, island)];
}

static struct rb_island *island_of_joint(const struct rb_solver *solver,
                                         const struct rb_world *world, int joint)
{
	const int owner = rb_step_joint_rows_owner(world->model,
	                                           &world->model->joints->joint[joint]);

	return &solver->island[solver->island_of[owner]];
}

/* The step data of a joint if its island has a second half; else NULL. */
static struct rb_step_joint *joint_due(const struct rb_solver *solver, const struct rb_world *world,
                                       int joint)
{
	struct rb_step_joint *const of = &solver->joint[joint];

	return of->first_row >= 0 &&
	                       rb_second_half_is_due(solver, island_of_joint(solver, world, joint))
	               ? of
	               : NULL;
}

/*
 * Repeats the change of velocity by the first half of forces; for spin, the change of angular
 * momentum, since the body has turned.
 */
static void begin_body(struct rb_solver *solver, const struct rb_world *world, int i)
{
	const struct rb_state *before = solver->before;
	struct rb_solver_body *const body = &solver->dense.bodies.body[i];
	const rb_vec3 solved_spin = body->angular;
	struct rb_solver_body force = solver->free[i], momentum = {0};

	force.linear = rb_vec3_sub(force.linear, rb_world_row3(before->velocity, i));
	if (before->spin)
		force.angular = rb_vec3_sub(force.angular, rb_world_row3(before->spin, i));
	if (rb_vec3_max_abs(force.angular) > 0)
		momentum = rb_energy_momentum_of(solver, i, &force);
	rb_islands_fill_body(solver, world, i);
	solver->after_forces[i] = *body;
	solver->after_forces[i].angular = rb_vec3_scale(0.5,
	                                                rb_vec3_add(solved_spin, body->angular));
	body->linear = rb_vec3_add(body->linear, force.linear);
	if (rb_vec3_max_abs(force.angular) > 0)
		body->angular = rb_vec3_add(
			body->angular, rb_world_turn(world, &world->state, i, momentum.angular));
	solver->free[i] = *body;
}

static bool is_driven(const struct rb_solver *solver, int i)
{
	return solver->dense.bodies.body[i].inverse_mass == 0;
}

/* Query for rows of a second half. */
static struct rb_joint_query query_of(const struct rb_solver *solver, const struct rb_world *world)
{
	struct rb_joint_query query = rb_islands_joints(solver, world);

	query.before = &world->state;
	query.at_end = true;
	query.lasts_s = 0.5 * solver->h_s;
	return query;
}

/* The island of a spring with rows, if it takes halves; else NULL. */
static const struct rb_island *island_in_halves(const struct rb_solver *solver,
                                                const struct rb_step_spring *spring)
{
	if (!spring->joined || spring->first_row < 0)
		return NULL;
	const int owner = rb_step_spring_owner(spring, &solver->dense.bodies, solver->body_count);
	const struct rb_island *const island = &solver->island[solver->island_of[owner]];

	return island->halves ? island : NULL;
}

static struct rb_spring_query query_of_spring(const struct rb_solver *solver,
                                              const struct rb_step_spring *spring)
{
	struct rb_spring_query query = rb_islands_springs(solver, spring);

	query.ahead_s = query.lasts_s;
	query.repeats = spring->time != RB_SPRING_AT_END;
	return query;
}

/* Updates springs to the present poses; in islands at rest they repeat their impulse. */
static void make_springs(struct rb_solver *solver, const struct rb_world *world)
{
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *const spring = &solver->spring[k];
		const struct rb_island *const island = island_in_halves(solver, spring);
		struct rb_pose pose[2];
		rb_vec3 displacement[2];

		if (!island)
			continue;
		if (!rb_second_half_is_due(solver, island)) {
			rb_step_spring_add(spring, spring->impulse);
			continue;
		}
		for (int e = 0; e < 2; e++) {
			const struct rb_pose begin = rb_world_pose(world, solver->before,
			                                           spring->end[e]);

			pose[e] = rb_world_pose(world, &world->state, spring->end[e]);
			displacement[e] = rb_pose_between(&begin, &pose[e]);
		}
		const struct rb_spring_query query = query_of_spring(solver, spring);
		const double impulse = rb_vec3_dot(spring->impulse, spring->along);

		rb_step_spring_turn(spring, pose, displacement);
		/* with rest length 0 it has acted in all directions */
		if (query.repeats && spring->rest > 0)
			spring->impulse = rb_vec3_scale(impulse, spring->along);
		rb_step_spring_fill(&query, spring, solver->dense.row + spring->first_row);
	}
}

bool rb_second_half_make(struct rb_solver *solver, const struct rb_world *world)
{
	bool any = false;

	for (size_t g = 0; solver->joint && g < solver->island_count; g++)
		any = any || rb_second_half_is_due(solver, &solver->island[g]);
	for (int k = 0; solver->joint && k < solver->active_joint_count; k++) {
		const int joint = solver->active_joint[k];

		if (solver->joint[joint].first_row >= 0 &&
		    island_of_joint(solver, world, joint)->halves &&
		    !joint_due(solver, world, joint))
			rb_step_joint_rows_repeat_half(&solver->joint[joint]);
	}
	for (int k = 0; any && k < solver->active_count; k++) {
		const int i = solver->active[k], g = solver->island_of[i];
		struct rb_solver_body *const body = &solver->dense.bodies.body[i];

		if (is_driven(solver, i)) {
			body->linear = rb_world_row3(world->state.velocity, i);
			if (world->state.spin)
				body->angular = rb_world_row3(world->state.spin, i);
		} else if (g >= 0 && rb_second_half_is_due(solver, &solver->island[g])) {
			begin_body(solver, world, i);
		}
	}
	const struct rb_joint_query query = query_of(solver, world);
	for (int k = 0; any && k < solver->active_joint_count; k++) {
		struct rb_step_joint *const of = joint_due(solver, world, solver->active_joint[k]);

		if (of)
			rb_step_joint_rows_fill(&query, solver->active_joint[k], of,
			                        solver->dense.row + of->first_row);
	}
	make_springs(solver, world);
	return any;
}

void rb_second_half_end(struct rb_solver *solver, struct rb_world *world)
{
	const struct rb_joint_query query = query_of(solver, world);

	/*
	 * other islands have used the velocities of driven bodies during the step, as does their
	 * power
	 */
	for (int k = 0; k < solver->active_count; k++)
		if (is_driven(solver, solver->active[k]))
			solver->dense.bodies.body[solver->active[k]] =
				solver->free[solver->active[k]];
	for (int k = 0; k < solver->active_joint_count; k++) {
		struct rb_step_joint *const of = joint_due(solver, world, solver->active_joint[k]);

		if (!of)
			continue;
		rb_step_joint_rows_store(&query, solver->active_joint[k], of,
		                         solver->dense.row + of->first_row);
		of->halves = true;
	}
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *const spring = &solver->spring[k];
		const struct rb_island *const island = island_in_halves(solver, spring);

		if (!island || !rb_second_half_is_due(solver, island))
			continue;
		const struct rb_spring_query again = query_of_spring(solver, spring);

		rb_step_spring_store(&again, spring, solver->dense.row + spring->first_row);
	}
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k], g = solver->island_of[i];

		if (g >= 0 && rb_second_half_is_due(solver, &solver->island[g]))
			rb_islands_store_body(solver, world, i);
	}
}
