/* SPDX-License-Identifier: MIT */
/* End of a step's solution: stores the results of rows in points, joints and bodies. */
#include "stepped/islands.h"

#include <string.h>

#include "base/error.h"

/*
 * A parallel pass over bodies, points or rows; each iteration writes only its own element, or a
 * mark that others write with the same value.
 */
struct pass {
	struct rb_solver *solver;
	struct rb_world *world;
	struct rb_step_points *points;
};

enum { PER_BLOCK = 512 };

static void run_blocks(struct pass *pass, size_t count, rb_team_part *part)
{
	rb_team_share(pass->world->team, count, PER_BLOCK, part, pass);
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

static void mark_loaded(struct rb_solver *solver, int i)
{
	if (!__atomic_load_n(&solver->loaded[i], __ATOMIC_RELAXED))
		__atomic_store_n(&solver->loaded[i], 1, __ATOMIC_RELAXED);
}

/*
 * Stores impulses of contacts; in a step (not in position projection) marks bodies with an impulse.
 */
static void store_rows(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_solver *solver = pass->solver;

	for (size_t k = first; k < end; k++) {
		const struct rb_constraint *row = &solver->dense.row[k];

		if (row->set != RB_CONSTRAINT_CONE)
			continue;
		struct rb_step_point *point = &pass->points->row[solver->point[k]];

		point->normal_impulse = row->impulse.n;
		point->friction_impulse = row->impulse.t;
		if (solver->before && row->impulse.n > 0) {
			mark_loaded(solver, row->a);
			mark_loaded(solver, row->b);
		}
	}
}

/* The island of a row. */
static const struct rb_island *island_of_row(const struct rb_solver *solver,
                                             const struct rb_constraint *row)
{
	return &solver->island[solver->island_of[row->a]];
}

static void store_joints(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	const struct rb_solver *const solver = pass->solver;
	struct rb_joint_query query = rb_islands_joints(solver, pass->world);

	for (size_t k = first; k < end; k++) {
		struct rb_step_joint *of = &solver->joint[solver->active_joint[k]];
		const struct rb_constraint *const row = solver->dense.row + of->first_row;

		/* rows of islands that keep an earlier solution have not been solved */
		if (of->first_row < 0 || island_of_row(solver, row)->kept)
			continue;
		query.lasts_s = rb_islands_impulse_time(solver, island_of_row(solver, row));
		rb_step_joint_rows_store(&query, solver->active_joint[k], of, row);
	}
}

/* Stores impulses of springs; at rest, those of the static tension. */
static void store_springs(struct rb_solver *solver)
{
	for (int k = 0; k < solver->spring_count; k++) {
		struct rb_step_spring *spring = &solver->spring[k];
		const struct rb_constraint *row = spring->first_row >= 0
		                                          ? solver->dense.row + spring->first_row
		                                          : NULL;

		if (!spring->joined || (row && island_of_row(solver, row)->kept))
			continue;
		const struct rb_spring_query query = rb_islands_springs(solver, spring);

		memset(spring->on, 0, sizeof spring->on);
		if (row)
			rb_step_spring_store(&query, spring, row);
		else
			rb_step_spring_add(spring, rb_vec3_scale(-solver->h_s * spring->stiffness *
			                                                 spring->stretch,
			                                         spring->along));
	}
}

/* Stores the residuals for the next step; clears the marks. */
static void store_residuals(void *user, size_t first, size_t end)
{
	struct rb_solver *solver = ((const struct pass *)user)->solver;

	for (size_t k = first; k < end; k++) {
		const int i = solver->active[k], g = solver->island_of[i];
		const double residual = g < 0 ? 0 : solver->island[g].residual;

		/* written so that NaN counts as the tolerance */
		solver->residual[i] = residual < solver->tolerance ? residual : solver->tolerance;
		solver->loaded[i] = 0;
	}
}

static bool all_have_rows(const struct rb_solver *solver)
{
	bool all = true;

	for (size_t g = 0; g < solver->island_count; g++)
		all = all && !rb_islands_has_no_rows(&solver->island[g]);
	return all;
}

/* Marks bodies with an impulse of a contact, if some islands have no rows. */
static void mark_contacts(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_solver *solver = pass->solver;

	for (size_t k = first; k < end; k++) {
		const struct rb_step_point *point = &pass->points->row[k];

		if (!(point->normal_impulse > 0))
			continue;
		mark_loaded(solver, point->a);
		mark_loaded(solver, point->b < solver->body_count ? point->b : solver->body_count);
	}
}

/* Marks bodies with joints and joined springs. */
static void mark_joints_and_springs(struct rb_solver *solver, const struct rb_joints *joints)
{
	for (int k = 0; k < solver->active_joint_count; k++) {
		const struct rb_joint *joint = &joints->joint[solver->active_joint[k]];
		const int ends[2] = {joint->a, joint->b};

		for (int e = 0; e < 2; e++)
			if (ends[e] >= 0 && is_dynamic(solver, ends[e]))
				solver->loaded[ends[e]] = 1;
	}
	for (int k = 0; k < solver->spring_count; k++)
		for (int e = 0; e < 2 && solver->spring[k].joined; e++)
			if (is_dynamic(solver, solver->spring[k].end[e]))
				solver->loaded[solver->spring[k].end[e]] = 1;
}

/*
 * A body whose impulses all ended at zero gets its free velocity back exactly: the sum has rounding
 * in it, and a torque-free top should take the closed form. Not after position projection, which
 * has no velocities.
 */
static void store_bodies(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;
	struct rb_solver *solver = pass->solver;

	for (size_t k = first; k < end; k++) {
		const int i = solver->active[k];

		if (solver->before && solver->island_of[i] >= 0 && !solver->loaded[i] &&
		    !solver->island[solver->island_of[i]].reduced)
			solver->dense.bodies.body[i] = solver->free[i];
		rb_islands_store_body(solver, pass->world, i);
	}
}

void rb_islands_end(struct rb_solver *solver, struct rb_world *world, struct rb_step_points *points)
{
	struct pass pass = {.solver = solver, .world = world, .points = points};

	RB_ASSERT_COSTLY(rb_row_system_is_sound(&solver->dense, solver->body_count + 1));
	if (solver->before)
		run_blocks(&pass, (size_t)solver->active_count, store_residuals);
	run_blocks(&pass, (size_t)solver->dense.row_count, store_rows);
	if (solver->before && solver->active_joint_count > 0) /* not in position projection */
		run_blocks(&pass, (size_t)solver->active_joint_count, store_joints);
	if (solver->before) {
		store_springs(solver);
		if (!all_have_rows(solver))
			run_blocks(&pass, points->count, mark_contacts);
		mark_joints_and_springs(solver, world->model->joints);
	}
	run_blocks(&pass, (size_t)solver->active_count, store_bodies);
}
