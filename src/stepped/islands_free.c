/* SPDX-License-Identifier: MIT */
/*
 * Groups that nothing but joints and constant forces acts on: without rows, or in halves. What a
 * group only comes near does not act on it.
 */
#include "stepped/islands.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "force/spring.h"

struct asked {
	struct rb_solver *solver;
	struct rb_world *world;
	const struct rb_step_points *points;
	/*
	 * In the arena. By group: where its points begin in `number`, and how many of them touch;
	 * NULL: there are none, or no memory.
	 */
	int *first, *touching, *number;
};

static rb_vec3 mean(rb_vec3 x, rb_vec3 y)
{
	return rb_vec3_scale(0.5, rb_vec3_add(x, y));
}

static struct rb_island *group_of_joint(struct rb_solver *solver, const struct rb_world *world,
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

/* Whether a spring without rows pulls the body. */
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

/* Counting sort of points by group. */
static void sort_points(struct asked *asked, const int *group_of)
{
	const size_t groups = asked->solver->island_count, count = asked->points->count;
	struct rb_arena *const arena = &asked->world->arena[0];

	if (count == 0)
		return;
	asked->first = rb_arena_take(arena, groups + 1, sizeof *asked->first);
	asked->touching = rb_arena_take(arena, groups + 1, sizeof *asked->touching);
	asked->number = rb_arena_take(arena, count, sizeof *asked->number);
	if (!asked->first || !asked->touching || !asked->number) {
		asked->first = NULL;
		return;
	}
	memset(asked->touching, 0, (groups + 1) * sizeof *asked->touching);
	asked->first[0] = 0;
	for (size_t g = 0; g < groups; g++)
		asked->first[g + 1] = asked->first[g] + asked->solver->island[g].contact_count;
	for (size_t k = count; k-- > 0;) {
		const struct rb_step_point *const point = &asked->points->row[k];
		const int g = group_of[k];

		asked->touching[g] += point->normal_impulse > 0 || point->bend != 0;
		asked->number[--asked->first[g + 1]] = (int)k;
	}
	/* each has come to where the next one began */
	memmove(asked->first, asked->first + 1, groups * sizeof *asked->first);
	asked->first[groups] = (int)count;
}

/* Whether a group has joints, and no point of it has pushed. */
static bool is_clear(const struct asked *asked, int group)
{
	const struct rb_island *const island = &asked->solver->island[group];

	return island->contact_count == 0 || (island->row_count > island->contact_count &&
	                                      asked->first && asked->touching[group] == 0);
}

/* Groups that nothing but joints, constant forces and drag acts on may need no rows. */
static void swing(void *user, int group, int worker)
{
	const struct asked *const pass = user;
	struct rb_solver *const solver = pass->solver;
	struct rb_island *const island = &solver->island[group];
	const struct rb_elements *const springs = rb_model_elements(pass->world->model,
	                                                            &rb_force_spring);
	const bool varies = pass->world->model->features & RB_FEATURES_VARIED &
	                    ~(rb_features)(RB_FEATURE_SPRINGS | RB_FEATURE_DRAG);
	bool may = solver->before && solver->before->spin && !varies && !island->rests &&
	           !island->sprung && is_clear(pass, group);

	for (int k = 0; may && k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		may = !is_pulled(solver, springs, i) && !rb_kicks_have(solver->kicks, i);
	}
	if (!may)
		return;
	const int *const member = solver->member + island->first_member;
	struct rb_swung *const known = &solver->swung[member[0]];

	if (abs(known->members) == island->member_count) {
		island->swings = known->members > 0;
		for (int k = 0; island->swings && k < island->member_count; k++) {
			struct rb_solver_body *const body = &solver->dense.bodies.body[member[k]];

			body->linear = solver->swung[member[k]].velocity;
			body->angular = solver->swung[member[k]].spin;
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
	island->swings = solver->swing(solver, pass->world, island, &points, arena);
	known->members = island->swings ? island->member_count : -island->member_count;
	rb_arena_back(arena, here);
}

void rb_islands_swing(struct rb_solver *solver, struct rb_world *world,
                      const struct rb_step_points *points, const int *group_of)
{
	struct asked asked = {.solver = solver, .world = world, .points = points};
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);

	if (solver->before)
		sort_points(&asked, group_of);
	rb_team_run(world->team, (int)solver->island_count, swing, &asked);
	rb_arena_back(arena, here);
}

void rb_islands_unswing(struct rb_solver *solver, const struct rb_joints *joints,
                        const struct rb_island *island)
{
	const int *const member = solver->member + island->first_member;

	RB_ASSERT(island->swings);
	solver->swung[member[0]].members = -island->member_count;
	for (int k = 0; k < island->member_count; k++) {
		const int i = member[k];
		struct rb_solver_body *const body = &solver->dense.bodies.body[i];

		body->linear = rb_vec3_scale(
			1 / solver->h_s, rb_vec3_sub(solver->swung[i].position,
		                                     rb_world_row3(solver->before->position, i)));
		body->angular = solver->swung[i].turning;
		for (int e = joints->first[i]; e < joints->first[i + 1]; e++)
			solver->joint[joints->of[e]].swings = false;
	}
}

/*
 * Groups that take impulses in halves, since joints, springs with rows and constant forces alone
 * act on them within what the step resolves; of forces their bodies get one half now.
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

			/* what a spring joins to a mechanism may have been in an impact */
			island->halves = !solver->stiff[i] && !is_pulled(solver, springs, i) &&
			                 !rb_kicks_have(solver->kicks, i);
		}
	}
	for (int k = 0; k < solver->joined_count; k++) {
		const int number = solver->joined[k];
		struct rb_island *const island = group_of_joint(solver, world, number);

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
