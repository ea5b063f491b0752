/* SPDX-License-Identifier: MIT */
/* The end of a step's solution: what rows have come to goes to points, joints and bodies. */
#include "stepped/islands.h"

#include <string.h>

#include "base/error.h"

/* A parallel pass over bodies, joints or rows; each writes only its own. */
struct pass {
	struct rb_solver *solver;
	struct rb_world *world;
	struct rb_step_points *points;
	int count;
};

enum { PER_BLOCK = 512 };

static int end_of(const struct pass *pass, int block)
{
	const int end = (block + 1) * PER_BLOCK;

	return end < pass->count ? end : pass->count;
}

static void run_pass(struct pass *pass, size_t count, rb_team_work *work)
{
	pass->count = (int)count;
	rb_team_run(pass->world->team, (pass->count + PER_BLOCK - 1) / PER_BLOCK, work, pass);
}

static bool is_dynamic(const struct rb_solver *solver, int i)
{
	return i < solver->body_count && solver->dense.bodies.body[i].inverse_mass > 0;
}

void rb_islands_store_body(const struct rb_solver *solver, struct rb_world *world, int i)
{
	rb_vec3_to(world->state.velocity + 3 * (size_t)i, solver->dense.bodies.body[i].linear);
	if (world->state.spin)
		rb_vec3_to(world->state.spin + 3 * (size_t)i, solver->dense.bodies.body[i].angular);
}

static void store_bodies_block(void *user, int block, int worker)
{
	const struct pass *pass = user;

	(void)worker;
	for (int k = block * PER_BLOCK; k < end_of(pass, block); k++)
		rb_islands_store_body(pass->solver, pass->world, pass->solver->active[k]);
}

static void store_rows_block(void *user, int block, int worker)
{
	const struct pass *pass = user;

	(void)worker;
	for (int k = block * PER_BLOCK; k < end_of(pass, block); k++) {
		const struct rb_constraint *row = &pass->solver->dense.row[k];

		if (row->set != RB_CONSTRAINT_CONE)
			continue;
		struct rb_step_point *point = &pass->points->row[pass->solver->point[k]];

		point->normal_impulse = row->impulse.n;
		point->friction_impulse = row->impulse.t;
	}
}

/* The group of a row. */
static const struct rb_island *group_of(const struct rb_solver *solver,
                                        const struct rb_constraint *row)
{
	return &solver->island[solver->island_of[row->a]];
}

static void store_joints_block(void *user, int block, int worker)
{
	const struct pass *pass = user;
	const struct rb_solver *const solver = pass->solver;
	struct rb_joint_query query = rb_islands_joints(solver, pass->world);

	(void)worker;
	for (int k = block * PER_BLOCK; k < end_of(pass, block); k++) {
		struct rb_step_joint *of = &solver->joint[solver->joined[k]];
		const struct rb_constraint *const row = solver->dense.row + of->first_row;

		/* of groups that keep what an earlier look has found, rows have not been solved */
		if (of->first_row < 0 || group_of(solver, row)->kept)
			continue;
		query.lasts_s = rb_islands_lasts(solver, group_of(solver, row));
		rb_step_joint_rows_store(&query, solver->joined[k], of, row);
	}
}

/* Of what rests it is the pull that it rests with. */
static void store_springs(struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];
		const struct rb_constraint *row = solver->dense.row + spring->first_row;

		if (!spring->joined || (spring->first_row >= 0 && group_of(solver, row)->kept))
			continue;
		const struct rb_spring_query query = rb_islands_springs(solver, spring);

		memset(spring->on, 0, sizeof spring->on);
		if (spring->first_row >= 0)
			rb_step_spring_store(&query, spring, row);
		else
			rb_step_spring_add(spring, rb_vec3_scale(-solver->h_s * spring->stiffness *
			                                                 spring->stretch,
			                                         spring->along));
	}
}

/* Marks bodies with an impulse on them. */
static void find_pushed(struct rb_solver *solver, const struct rb_joints *joints,
                        const struct rb_step_points *points)
{
	for (int k = 0; k < solver->active_count; k++)
		solver->pushed[solver->active[k]] = 0;
	for (size_t k = 0; k < points->count; k++) {
		const struct rb_step_point *point = &points->row[k];
		const int b = point->b < solver->body_count ? point->b : solver->body_count;

		if (point->normal_impulse > 0)
			solver->pushed[point->a] = solver->pushed[b] = 1;
	}
	for (int k = 0; k < solver->joined_count; k++) {
		const struct rb_joint *joint = &joints->joint[solver->joined[k]];
		const int ends[2] = {joint->a, joint->b};

		for (int e = 0; e < 2; e++)
			if (ends[e] >= 0 && is_dynamic(solver, ends[e]))
				solver->pushed[ends[e]] = 1;
	}
	for (int k = 0; k < solver->spring_count; k++)
		for (int e = 0; e < 2 && solver->spring[k].joined; e++)
			if (is_dynamic(solver, solver->spring[k].end[e]))
				solver->pushed[solver->spring[k].end[e]] = 1;
}

/*
 * A body whose impulses all ended at zero gets its free velocity back exactly: the sum has rounding
 * in it, and a top without torque should take the closed form.
 */
static void free_unpushed(struct rb_solver *solver)
{
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k];

		if (solver->island_of[i] >= 0 && !solver->pushed[i])
			solver->dense.bodies.body[i] = solver->free[i];
	}
}

/*
 * Residuals that the next step takes into account; not after the projection, which has no
 * velocities.
 */
static void note_left(struct rb_solver *solver)
{
	for (int k = 0; solver->before && k < solver->active_count; k++) {
		const int i = solver->active[k], g = solver->island_of[i];

		/* written so that NaN is not good */
		solver->left[i] = g < 0 ? 0
		                  : solver->island[g].residual < solver->tolerance
		                          ? solver->island[g].residual
		                          : solver->tolerance;
	}
}

void rb_islands_end(struct rb_solver *solver, struct rb_world *world, struct rb_step_points *points)
{
	struct pass pass = {.solver = solver, .world = world, .points = points};

	RB_ASSERT_COSTLY(rb_row_system_is_sound(&solver->dense, solver->body_count + 1));
	run_pass(&pass, (size_t)solver->dense.row_count, store_rows_block);
	if (solver->before && solver->joined_count > 0) /* else positions are moved */
		run_pass(&pass, (size_t)solver->joined_count, store_joints_block);
	if (solver->before)
		store_springs(solver);
	note_left(solver);
	if (solver->before) { /* else positions are moved */
		find_pushed(solver, world->model->joints, points);
		free_unpushed(solver);
	}
	run_pass(&pass, (size_t)solver->active_count, store_bodies_block);
}
