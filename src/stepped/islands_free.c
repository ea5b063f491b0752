/* SPDX-License-Identifier: MIT */
/*
 * Islands on which only joints and constant forces act: stepped without rows, or in halves. A
 * contact without impulse does not count.
 */
#include "stepped/islands.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "force/spring.h"

struct pass {
	struct rb_solver *solver;
	struct rb_world *world;
	const struct rb_step_points *points;
	/*
	 * In the arena. By island: where its points begin in `number`, and how many of them touch;
	 * NULL: no points, or no memory.
	 */
	int *first, *touching, *number;
};

static rb_vec3 mean(rb_vec3 x, rb_vec3 y)
{
	return rb_vec3_scale(0.5, rb_vec3_add(x, y));
}

static struct rb_island *island_of_joint(struct rb_solver *solver, const struct rb_world *world,
                                         int k)
{
	const int owner = rb_step_joint_rows_owner(world->model, &world->model->joints->joint[k]);

	return &solver->island[solver->island_of[owner]];
}

static bool is_joined(const struct rb_solver *solver, int row)
{
	int low = 0, end = solver->spring_count;

	while (low < end) {
		const int middle = (low + end) / 2;

		if (solver->spring[middle].row < row)
			low = middle + 1;
		else
			end = middle;
	}
	return low < solver->spring_count && solver->spring[low].row == row &&
	       solver->spring[low].joined;
}

/* Whether a spring without rows acts on the body. */
static bool is_pulled(const struct rb_solver *solver, const struct rb_elements *springs, int i)
{
	bool pulled = false;

	for (int e = springs ? springs->first[i] : 0; springs && e < springs->first[i + 1]; e++) {
		const struct rb_spring_def *def = rb_elements_row(springs, springs->of[e]);

		pulled = pulled || ((def->stiffness > 0 || def->damping > 0) &&
		                    !is_joined(solver, springs->of[e]));
	}
	return pulled;
}

bool rb_islands_forces_vary(const struct rb_world *world)
{
	return world->model->features & RB_FEATURES_VARIED & ~(rb_features)RB_FEATURE_SPRINGS;
}

/* Counting sort of points by island. */
static void sort_points(struct pass *pass, const int *group_of)
{
	const size_t islands = pass->solver->island_count, count = pass->points->count;
	struct rb_arena *const arena = &pass->world->arena[0];

	if (count == 0)
		return;
	pass->first = rb_arena_take(arena, islands + 1, sizeof *pass->first);
	pass->touching = rb_arena_take(arena, islands + 1, sizeof *pass->touching);
	pass->number = rb_arena_take(arena, count, sizeof *pass->number);
	if (!pass->first || !pass->touching || !pass->number) {
		pass->first = NULL;
		return;
	}
	memset(pass->touching, 0, (islands + 1) * sizeof *pass->touching);
	pass->first[0] = 0;
	for (size_t g = 0; g < islands; g++)
		pass->first[g + 1] = pass->first[g] + pass->solver->island[g].contact_count;
	for (size_t k = count; k-- > 0;) {
		const struct rb_step_point *const point = &pass->points->row[k];
		const int g = group_of[k];

		pass->touching[g] += point->normal_impulse > 0 || point->bend != 0;
		pass->number[--pass->first[g + 1]] = (int)k;
	}
	/* each has been moved to where its successor began */
	memmove(pass->first, pass->first + 1, islands * sizeof *pass->first);
	pass->first[islands] = (int)count;
}

/* Whether an island has no contacts, or joints and no contact with an impulse. */
static bool is_clear(const struct pass *pass, int group)
{
	const struct rb_island *const island = &pass->solver->island[group];

	return island->contact_count == 0 || (island->row_count > island->contact_count &&
	                                      pass->first && pass->touching[group] == 0);
}

/*
 * Tries to step an island in reduced coordinates if only joints, constant forces and drag act on
 * it.
 */
static void step_reduced(void *user, int group, int worker)
{
	const struct pass *const pass = user;
	struct rb_solver *const solver = pass->solver;
	struct rb_island *const island = &solver->island[group];
	const struct rb_elements *const springs = rb_model_elements(pass->world->model,
	                                                            &rb_force_spring);
	const bool varies = pass->world->model->features & RB_FEATURES_VARIED &
	                    ~(rb_features)(RB_FEATURE_SPRINGS | RB_FEATURE_DRAG);
	bool is_candidate = solver->before && solver->before->spin && !varies && !island->rests &&
	                    !island->has_springs && is_clear(pass, group);

	for (int k = 0; is_candidate && k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		is_candidate = !is_pulled(solver, springs, i) && !rb_kicks_have(solver->kicks, i);
	}
	if (!is_candidate)
		return;
	const int *const member = solver->member + island->first_member;
	struct rb_reduced_motion *const known = &solver->reduced_motion[member[0]];

	if (abs(known->members) == island->member_count) {
		island->reduced = known->members > 0;
		for (int k = 0; island->reduced && k < island->member_count; k++) {
			struct rb_solver_body *const body = &solver->dense.bodies.body[member[k]];

			body->linear = solver->reduced_motion[member[k]].velocity;
			body->angular = solver->reduced_motion[member[k]].spin;
		}
		return;
	}
	struct rb_arena *const arena = &pass->world->arena[worker];
	const rb_arena_mark here = rb_arena_here(arena);
	struct rb_group_points points = {.count = island->contact_count};

	if (points.count > 0) {
		points.row = pass->points->row;
		points.number = pass->number + pass->first[group];
	}
	island->reduced = solver->step_reduced(solver, pass->world, island, &points, arena);
	known->members = island->reduced ? island->member_count : -island->member_count;
	rb_arena_back(arena, here);
}

void rb_islands_step_reduced(struct rb_solver *solver, struct rb_world *world,
                             const struct rb_step_points *points, const int *group_of)
{
	struct pass pass = {.solver = solver, .world = world, .points = points};
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);

	if (solver->before)
		sort_points(&pass, group_of);
	rb_team_run(world->team, (int)solver->island_count, step_reduced, &pass);
	rb_arena_back(arena, here);
}

void rb_islands_revert_reduced(struct rb_solver *solver, const struct rb_joints *joints,
                               const struct rb_island *island)
{
	const int *const member = solver->member + island->first_member;

	RB_ASSERT(island->reduced);
	solver->reduced_motion[member[0]].members = -island->member_count;
	for (int k = 0; k < island->member_count; k++) {
		const int i = member[k];
		struct rb_solver_body *const body = &solver->dense.bodies.body[i];

		body->linear = rb_vec3_scale(
			1 / solver->h_s, rb_vec3_sub(solver->reduced_motion[i].position,
		                                     rb_world_row3(solver->before->position, i)));
		body->angular = solver->reduced_motion[i].turning;
		for (int e = joints->first[i]; e < joints->first[i + 1]; e++)
			solver->joint[joints->of[e]].reduced = false;
	}
}

/*
 * Marks islands that take impulses in halves, since only joints, springs with rows and constant
 * forces act on them within what the step resolves; gives their bodies one half of the forces now.
 */
void rb_islands_halve(struct rb_solver *solver, const struct rb_world *world)
{
	const struct rb_joint_query query = rb_islands_joints(solver, world);
	const struct rb_elements *springs = rb_model_elements(world->model, &rb_force_spring);
	const bool varies = rb_islands_forces_vary(world);

	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *const island = &solver->island[g];

		island->halves = solver->before && !varies && !rb_islands_has_no_rows(island) &&
		                 island->contact_count == 0;
		for (int k = 0; island->halves && k < island->member_count; k++) {
			const int i = solver->member[island->first_member + k];

			/* a body that a spring joins to a mechanism may have had an impact */
			island->halves = !solver->stiff[i] && !is_pulled(solver, springs, i) &&
			                 !rb_kicks_have(solver->kicks, i);
		}
	}
	for (int k = 0; k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		struct rb_island *const island = island_of_joint(solver, world, number);

		island->halves = island->halves && rb_step_joint_rows_are_smooth(
							   &query, number, &solver->joint[number]);
	}
	for (int k = 0; k < solver->active_count; k++) {
		const int i = solver->active[k], g = solver->island_of[i];
		struct rb_solver_body *const body = &solver->dense.bodies.body[i];

		if (g < 0 || !solver->island[g].halves)
			continue;
		body->linear = mean(body->linear, rb_world_row3(solver->before->velocity, i));
		if (solver->before->spin)
			body->angular = mean(body->angular, rb_world_row3(solver->before->spin, i));
		solver->free[i] = *body;
	}
}
