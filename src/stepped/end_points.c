/* SPDX-License-Identifier: MIT */
#include "stepped/end_points.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "stepped/impact_pass.h"
#include "stepped/stillness.h"

/*
 * Marks bodies of large groups. Small groups cost little and get the narrow phase; bodies at rest
 * are treated as sleeping ones, which have no points. Points of bodies that impacts have moved
 * within the step refer to other moments.
 */
static bool find_heaps(struct rb_end_points *carried, const struct rb_cohort *cohort)
{
	const struct rb_solver *const solver = &carried->world->stepped->solver;
	bool any = false;

	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k], g = solver->island_of[i];
		const struct rb_island *const island = &solver->island[g < 0 ? 0 : g];

		carried->heap[i] = g >= 0 && island->row_count >= RB_STRATEGY_HEAP_ROWS &&
		                   !island->rests && !rb_kicks_have(solver->kicks, i);
		any = any || carried->heap[i];
	}
	return any;
}

/*
 * Finds the points of each pair, by its bodies: candidates may have been searched again since,
 * which must not matter.
 */
static void index_points(struct rb_end_points *carried)
{
	const struct rb_step_points *const points = carried->points;
	const struct rb_pair *const pair = carried->candidates->pair;
	const size_t pairs = carried->candidates->pair_count;
	size_t first = 0;

	for (size_t k = 0; k < points->count; k++) {
		const int a = points->row[k].a, b = points->row[k].b;

		if (k > 0 && points->row[k - 1].a == a && points->row[k - 1].b == b)
			continue;
		while (first < pairs && pair[first].a < a)
			first++;
		size_t at = first;
		while (at < pairs && pair[at].a == a && pair[at].b != b)
			at++;
		if (at < pairs && pair[at].a == a)
			carried->first[at] = (uint32_t)k + 1;
	}
}

enum rb_status rb_end_points_begin(struct rb_end_points *carried, struct rb_world *world,
                                   const struct rb_cohort *cohort, struct rb_error *err)
{
	struct rb_arena *const arena = &world->arena[0];
	const size_t n = (size_t)(world->model->body_count + world->model->static_count);
	const size_t pairs = cohort->candidates->pair_count;

	*carried = (struct rb_end_points){.world = world,
	                                  .points = &cohort->points,
	                                  .candidates = cohort->candidates,
	                                  .heap = rb_arena_take(arena, n, 1)};
	carried->exact = rb_arena_take(arena, pairs + 1, 1);
	carried->first = rb_arena_take(arena, pairs + 1, sizeof *carried->first);
	if (!carried->heap || !carried->exact || !carried->first)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	for (size_t i = 0; i < n; i++)
		carried->heap[i] = !rb_stepped_is_dynamic(world, (int)i);
	memset(carried->exact, 0, pairs + 1);
	memset(carried->first, 0, (pairs + 1) * sizeof *carried->first);
	/* with joints, or with joined arms, points are not where bodies touch */
	carried->any = !world->model->joints && !world->stepped->solver.joins_arms &&
	               find_heaps(carried, cohort);
	if (carried->any)
		index_points(carried);
	return RB_OK;
}

/* Displacement of a body in the step, m, and rotation to the first order, rad. */
struct motion {
	rb_vec3 displacement, turn;
};

static struct motion motion_of(const struct rb_world *world, int i)
{
	struct motion motion = {{0, 0, 0}, {0, 0, 0}};

	if (i >= world->model->body_count)
		return motion;
	motion.displacement = rb_vec3_sub(rb_world_row3(world->state.position, i),
	                                  rb_world_row3(world->mark.position, i));
	if (!world->state.spin)
		return motion;
	const rb_quat was = rb_quat_from(world->mark.orientation + 4 * (size_t)i);
	const rb_quat turn = rb_quat_multiply(
		rb_quat_from(world->state.orientation + 4 * (size_t)i),
		(rb_quat){was.w, -was.x, -was.y, -was.z});
	motion.turn = rb_vec3_scale(turn.w < 0 ? -2 : 2, (rb_vec3){turn.x, turn.y, turn.z});
	return motion;
}

/* A point moved with its bodies, with the gap by these motions. */
static struct rb_step_point moved_point(const struct rb_step_point *was, const struct motion *a,
                                        const struct motion *b)
{
	struct rb_step_point point = *was;
	rb_vec3 displacement = rb_vec3_sub(b->displacement, a->displacement);

	if (!point.central) {
		const rb_vec3 of_a = rb_vec3_cross(a->turn, point.arm_a);
		const rb_vec3 of_b = rb_vec3_cross(b->turn, point.arm_b);

		displacement = rb_vec3_add(displacement, rb_vec3_sub(of_b, of_a));
		point.arm_a = rb_vec3_add(point.arm_a, of_a);
		point.arm_b = rb_vec3_add(point.arm_b, of_b);
	}
	point.gap += point.bend + rb_vec3_dot(point.normal, displacement);
	point.bend = point.normal_impulse = 0;
	point.friction_impulse = (rb_vec3){0, 0, 0};
	point.from = 0;
	return point;
}

bool rb_end_points_add(const struct rb_end_points *carried, size_t pair, double max,
                       struct rb_step_points *to)
{
	const struct rb_step_point *const end = carried->points->row + carried->points->count;
	const struct rb_pair of = carried->candidates->pair[pair];
	double least = (double)INFINITY;
	size_t count = 0;

	RB_ASSERT_COSTLY(rb_end_points_is_near(carried, pair));
	const struct rb_step_point *const from = carried->points->row + carried->first[pair] - 1;
	while (from + count < end && from[count].a == of.a && from[count].b == of.b)
		count++;
	if (!rb_memory_reserve(&to->row, &to->capacity, to->count + count, sizeof *to->row))
		return false;
	const struct motion a = motion_of(carried->world, of.a),
			    b = motion_of(carried->world, of.b);
	struct rb_step_point *const row = to->row + to->count;
	for (size_t k = 0; k < count; k++) {
		row[k] = moved_point(&from[k], &a, &b);
		least = fmin(least, row[k].gap);
	}
	/*
	 * its overlap is known to be within the tolerance: raise all gaps so that none is negative
	 */
	const double more = fmax(0, -least);
	for (size_t k = 0; k < count; k++) {
		row[k].gap += more;
		if (row[k].gap <= max)
			to->row[to->count++] = row[k];
	}
	return true;
}
