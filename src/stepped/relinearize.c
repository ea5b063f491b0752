/* SPDX-License-Identifier: MIT */
/*
 * Relinearization. The constraint is on the gap at the end of the step, linearized at its
 * beginning; rotation by an angle t about an arm r leaves an error of r t^2 / 2 in it. Where that
 * makes an overlap beyond what the projection may close, the islands concerned get contact points
 * from the poses at the end, with gaps such that the linear model is exact there, and are solved
 * again from warm impulses: one Newton step on the nonlinear gap.
 *
 * Other islands keep their solution, and candidates of bodies that are not concerned keep their
 * points; lists are merged pair by pair in the order of candidates.
 */
#include "stepped/relinearize.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/team.h"
#include "stepped/find_points.h"
#include "stepped/impact_pass.h"
#include "stepped/joint_steps.h"
#include "stepped/projection.h"
#include "stepped/spring_steps.h"
#include "stepped/strategies.h"

/* Bodies and candidate pairs of the islands that are solved again. */
struct view {
	unsigned char *again; /* by body: its island is solved again */
	/*
	 * By body: at least one body of an inspected pair is marked. In a heap, those that overlap:
	 * inspection is for what would reject the step, and the rest has come out well.
	 */
	unsigned char *near;
	int *body; /* bodies solved again, then driven ones */
	int count;
	uint32_t *pair; /* of the candidates */
	size_t pair_count;
};

/* Islands and bodies to be solved again. All in the arena. */
struct marks {
	unsigned char *of_group; /* by island */
	unsigned char *alone;    /* by body: in no island */
};

/* Island of a body in the cohort; -1: no contacts, or asleep. */
static int group_of(const struct rb_world *world, int i)
{
	const struct rb_stepped *s = world->stepped;

	return rb_stepped_is_dynamic(world, i) && !s->sleep.sleeps[i] ? s->solver.island_of[i] : -1;
}

/*
 * Depth beyond which overlaps of an island are relinearized, m. In a heap one pair causes another
 * solution of the whole heap, while the projection moves a few bodies: only what would reject the
 * step is relinearized, and as often as allowed, since shorter steps cost more. For small islands
 * projection and rejection are cheaper than a second relinearization.
 */
static double max_of(const struct rb_world *world, const struct rb_deep *deep, int g,
                     int inspections)
{
	const struct rb_solver *solver = &world->stepped->solver;

	/* its points have not acted on it yet */
	if (solver->island[g].reduced)
		return 0;
	if (solver->island[g].row_count >= RB_STRATEGY_HEAP_ROWS)
		return rb_projection_reject_depth(world, deep, solver->h_s);
	return inspections == 0 ? rb_projection_max(world, deep, solver->h_s) : (double)INFINITY;
}

static bool is_heap(const struct rb_world *world, int g)
{
	return world->stepped->solver.island[g].row_count >= RB_STRATEGY_HEAP_ROWS;
}

/*
 * Marks islands with an overlap that the projection may not close; false: there are none. The
 * island of a body that overlaps with a heap is solved with it: never one body of a pair alone.
 */
static bool mark_groups(const struct rb_world *world, const struct rb_depths *found,
                        int inspections, const struct marks *marks)
{
	bool any = false;

	for (size_t k = 0; k < found->deep_count; k++) {
		const struct rb_deep *deep = &found->deep[k];
		const int ends[2] = {deep->a, deep->b};
		bool joins = false;

		for (int e = 0; e < 2; e++) {
			const int g = group_of(world, ends[e]);

			if (g < 0 || !(deep->depth > max_of(world, deep, g, inspections)))
				continue;
			marks->of_group[g] = 1;
			joins = joins || is_heap(world, g);
			any = true;
		}
		for (int e = 0; e < 2 && joins; e++) {
			const int g = group_of(world, ends[e]);

			if (g >= 0)
				marks->of_group[g] = 1;
			else if (rb_stepped_is_dynamic(world, ends[e]) &&
			         !world->stepped->sleep.sleeps[ends[e]])
				marks->alone[ends[e]] = 1;
		}
	}
	return any;
}

/*
 * Whether both bodies of a pair are in islands that are solved again, or one is and the other is
 * not dynamic.
 */
static bool is_seen(const struct rb_world *world, const struct view *view, struct rb_pair pair)
{
	const bool is_dynamic = rb_stepped_is_dynamic(world, pair.b);

	return view->again[pair.a] && (!is_dynamic || view->again[pair.b]) &&
	       (view->near[pair.a] || (is_dynamic && view->near[pair.b]));
}

/* Marks, in heaps, bodies that overlap by more than the projection may close; elsewhere all. */
static void mark_near(const struct rb_world *world, const struct rb_depths *found,
                      struct view *view)
{
	for (int k = 0; k < view->count; k++) {
		const int i = view->body[k], g = group_of(world, i);

		view->near[i] = g >= 0 && !is_heap(world, g);
	}
	for (size_t k = 0; k < found->deep_count; k++) {
		const struct rb_deep *deep = &found->deep[k];

		if (!(deep->depth > rb_projection_max(world, deep, world->stepped->solver.h_s)))
			continue;
		view->near[deep->a] = 1;
		if (rb_stepped_is_dynamic(world, deep->b))
			view->near[deep->b] = 1;
	}
}

/* `found`: deep overlaps, or NULL: none. False: no memory. */
static bool take_view(struct rb_world *world, const struct rb_cohort *cohort,
                      const struct rb_depths *found, const struct marks *marks, struct view *view)
{
	const struct rb_solver *solver = &world->stepped->solver;
	const struct rb_candidates *candidates = cohort->candidates;
	struct rb_arena *arena = &world->arena[0];
	const size_t n = (size_t)world->model->body_count;

	*view = (struct view){.again = rb_arena_take(arena, n, 1),
	                      .near = rb_arena_take(arena, n, 1)};
	view->body = rb_arena_take(arena, n, sizeof *view->body);
	view->pair = rb_arena_take(arena, rb_candidates_live_count(candidates) + 1,
	                           sizeof *view->pair);
	if (!view->again || !view->near || !view->body || !view->pair)
		return false;
	memset(view->again, 0, n);
	memset(view->near, 0, n);
	for (int k = 0; k < cohort->body_count; k++) {
		const int i = cohort->body[k], g = solver->island_of[i];

		view->again[i] = k < cohort->member_count &&
		                 (g >= 0 ? marks->of_group[g] : marks->alone[i]);
		if (view->again[i] || k >= cohort->member_count)
			view->body[view->count++] = i;
	}
	if (found)
		mark_near(world, found, view);
	for (size_t k = 0; found && k < rb_candidates_live_count(candidates); k++)
		if (is_seen(world, view, candidates->pair[rb_candidates_live(candidates, k)]))
			view->pair[view->pair_count++] = (uint32_t)rb_candidates_live(candidates,
			                                                              k);
	return true;
}

/* Gives rows to groups that were stepped in reduced coordinates and now overlap. */
static void give_rows(const struct rb_world *world, const struct marks *marks)
{
	struct rb_solver *const solver = &world->stepped->solver;

	for (size_t g = 0; g < solver->island_count; g++)
		if (marks->of_group[g] && solver->island[g].reduced)
			rb_islands_revert_reduced(solver, world->model->joints, &solver->island[g]);
}

/*
 * Clears velocities: points are searched along the displacement of a step, and at its end none is
 * left.
 */
static void clear_velocities(struct rb_world *world, const struct view *view)
{
	for (int k = 0; k < view->count; k++) {
		const size_t row = 3 * (size_t)view->body[k], size = 3 * sizeof(double);

		memset(world->state.velocity + row, 0, size);
		if (world->state.spin)
			memset(world->state.spin + row, 0, size);
	}
}

/* ---- points ---- */

static bool is_same(const struct rb_step_point *x, const struct rb_step_point *y)
{
	return x->a == y->a && x->b == y->b && x->parts == y->parts && x->key == y->key;
}

/* Warm start: points with the same feature key take over the impulses. */
static void inherit(struct rb_step_point *fresh, size_t fresh_count,
                    const struct rb_step_point *old, size_t old_count)
{
	for (size_t k = 0; k < fresh_count; k++)
		for (size_t o = 0; o < old_count; o++) {
			if (!is_same(&fresh[k], &old[o]))
				continue;
			fresh[k].normal_impulse = old[o].normal_impulse;
			fresh[k].friction_impulse = old[o].friction_impulse;
			break;
		}
}

/*
 * A rolling point keeps the arms of the beginning of the step: an impulse at the point of the end
 * would change the approach of the next step.
 */
static void keep_arms(struct rb_step_point *fresh, const struct rb_step_point *old,
                      size_t old_count)
{
	for (size_t o = 0; o < old_count; o++) {
		if (!old[o].rolls || !is_same(fresh, &old[o]))
			continue;
		fresh->arm_a = old[o].arm_a;
		fresh->arm_b = old[o].arm_b;
		fresh->rolls = true;
		return;
	}
}

/* Moves arms and normal to where the impulse acts at the beginning of the step. */
static void move_point(const struct rb_world *world, rb_vec3 between, struct rb_step_point *point)
{
	const int of[2] = {point->a, point->b};
	rb_vec3 arm[2] = {point->arm_a, point->arm_b};

	if (point->central) {
		point->normal = rb_levers_normal(between, point->normal);
		return;
	}
	rb_levers_join(world, of, between, point->normal, arm);
	point->arm_a = arm[0];
	point->arm_b = arm[1];
}

/*
 * Sets the gap at the beginning of the step for which the linear model gives the gap found at its
 * end; the difference is `bend`.
 */
static void set_bend(const struct rb_world *world, struct rb_step_point *point)
{
	const struct rb_solver *const solver = &world->stepped->solver;

	if (rb_stepped_joins_arms(world, point->b))
		move_point(world,
		           rb_islands_between(solver, world->mark.position, point->a, point->b),
		           point);
	const struct rb_constraint row = rb_islands_row_of(solver, point);
	const double here = point->gap;

	RB_ASSERT_COSTLY(solver->h_s > 0);
	/* reported as open at the beginning, even if closed now */
	point->gap = fmax(0, here);
	point->bend = here - point->gap -
	              solver->h_s * rb_vec3_dot(rb_constraint_velocity(&solver->dense.bodies, &row),
	                                        row.normal);
}

/*
 * Whether a body has come out on the other side of its partner: the normal found there is wrong,
 * and the old one stays, with a deep overlap.
 */
static bool has_passed_through(const struct rb_step_point *old, size_t old_count,
                               const struct rb_step_point *fresh, size_t fresh_count)
{
	return old_count > 0 && fresh_count > 0 && !(rb_vec3_dot(old->normal, fresh->normal) > 0);
}

/* Points of two lists become one; both are in order of the candidates. */
struct merging {
	struct rb_world *world;
	const struct rb_pair *pair;
	const struct view *view;
	const struct rb_step_point *row, *fresh; /* points before; points of the inspected pairs */
	size_t count, fresh_count;
	struct rb_step_point *old, *to; /* copy of `row`; destination */
	size_t *length;                 /* by block: number of points, then offset */
};

enum { PAIRS_PER_BLOCK = 512 };

/* Points of one pair in both lists. */
struct both {
	const struct rb_step_point *old, *fresh;
	size_t old_count, fresh_count;
	bool uses_fresh;
};

/* Index of the first point of this pair or a later one. */
static size_t first_of(const struct rb_step_point *row, size_t count, size_t pair)
{
	size_t low = 0, high = count;

	while (low < high) {
		const size_t middle = low + (high - low) / 2;

		if (row[middle].pair < pair)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static size_t length_of(const struct rb_step_point *row, size_t count, size_t pair)
{
	size_t length = 0;

	while (length < count && row[length].pair == pair)
		length++;
	return length;
}

static struct both points_of_pair(const struct merging *merging, const struct rb_step_point *row,
                                  size_t at, size_t new_at, size_t pair)
{
	struct both both = {.old = row + at,
	                    .fresh = merging->fresh + new_at,
	                    .old_count = length_of(row + at, merging->count - at, pair),
	                    .fresh_count = length_of(merging->fresh + new_at,
	                                             merging->fresh_count - new_at, pair)};

	both.uses_fresh = is_seen(merging->world, merging->view, merging->pair[pair]) &&
	                  !has_passed_through(both.old, both.old_count, both.fresh,
	                                      both.fresh_count);
	return both;
}

/* Counts the merged points of these pairs, and copies the old ones. */
static void count_points(void *user, size_t first, size_t end)
{
	const struct merging *merging = user;
	const size_t begin = first_of(merging->row, merging->count, first);
	size_t at = begin, new_at = first_of(merging->fresh, merging->fresh_count, first);
	size_t length = 0;

	for (size_t k = first; k < end; k++) {
		const struct both both = points_of_pair(merging, merging->row, at, new_at, k);

		length += both.uses_fresh ? both.fresh_count : both.old_count;
		at += both.old_count;
		new_at += both.fresh_count;
	}
	if (at > begin)
		memcpy(merging->old + begin, merging->row + begin,
		       (at - begin) * sizeof *merging->old);
	merging->length[first / PAIRS_PER_BLOCK] = length;
}

static void merge_points(void *user, size_t first, size_t end)
{
	const struct merging *merging = user;
	size_t at = first_of(merging->old, merging->count, first);
	size_t new_at = first_of(merging->fresh, merging->fresh_count, first);
	struct rb_step_point *to = merging->to + merging->length[first / PAIRS_PER_BLOCK];

	for (size_t k = first; k < end; k++) {
		const struct both both = points_of_pair(merging, merging->old, at, new_at, k);
		const size_t count = both.uses_fresh ? both.fresh_count : both.old_count;

		if (count > 0)
			memcpy(to, both.uses_fresh ? both.fresh : both.old, count * sizeof *to);
		for (size_t p = 0; both.uses_fresh && p < count; p++) {
			keep_arms(&to[p], both.old, both.old_count);
			set_bend(merging->world, &to[p]);
			rb_impacts_update_approach(merging->world->stepped, &to[p]);
		}
		if (both.uses_fresh)
			inherit(to, count, both.old, both.old_count);
		to += count;
		at += both.old_count;
		new_at += both.fresh_count;
	}
}

/* Merges old and new points in the order of candidates; inspected pairs get new ones. */
static enum rb_status merge(struct rb_world *world, struct rb_cohort *cohort,
                            const struct view *view, struct rb_error *err)
{
	const struct rb_step_points *fresh = &world->stepped->closing;
	struct rb_step_points *points = &cohort->points;
	const size_t pairs = cohort->candidates->pair_count;
	const size_t max = points->count + fresh->count;
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	struct merging merging = {.world = world,
	                          .pair = cohort->candidates->pair,
	                          .view = view,
	                          .fresh = fresh->row,
	                          .count = points->count,
	                          .fresh_count = fresh->count,
	                          .old = rb_arena_take(arena, points->count, sizeof *merging.old),
	                          .length = rb_arena_take(arena, pairs / PAIRS_PER_BLOCK + 1,
	                                                  sizeof *merging.length)};

	if (!merging.old || !merging.length ||
	    !rb_memory_reserve(&points->row, &points->capacity, max, sizeof *points->row))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", max);
	merging.row = merging.to = points->row;
	rb_team_share(world->team, pairs, PAIRS_PER_BLOCK, count_points, &merging);
	points->count = 0;
	for (size_t b = 0; b * PAIRS_PER_BLOCK < pairs; b++) {
		const size_t length = merging.length[b];

		merging.length[b] = points->count;
		points->count += length;
	}
	rb_team_share(world->team, pairs, PAIRS_PER_BLOCK, merge_points, &merging);
	rb_arena_back(arena, here);
	return RB_OK;
}

/* Finds contact points of the groups at their present poses. */
static enum rb_status find_points(struct rb_world *world, struct rb_candidates *candidates,
                                  const struct view *view, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const uint32_t *const live = candidates->live;
	const size_t live_count = candidates->live_count;

	s->closing.count = 0;
	candidates->live = view->pair;
	candidates->live_count = view->pair_count;
	const enum rb_status status = rb_step_points_add(&s->closing, world, candidates,
	                                                 s->solver.h_s, HUGE_VAL, err);
	candidates->live = live;
	candidates->live_count = live_count;
	return status;
}

/* ---- top level ---- */

/* Measures overlaps of the cohort's candidates; marks islands with a deep one. */
static enum rb_status find_deep(struct rb_world *world, struct rb_cohort *cohort, int inspections,
                                const struct marks *marks, bool *deep, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_depths found;

	*deep = false;
	if (!world->broadphase)
		return RB_OK;
	/* else further pairs may overlap, for which the caller searches */
	const bool holds = cohort->candidates != &s->candidates ||
	                   rb_candidates_holds(&s->candidates, world, cohort->body,
	                                       cohort->body_count);
	rb_candidates_place(cohort->candidates, world, cohort->body, cohort->body_count);
	const enum rb_status status = rb_depths_find(world, cohort->candidates, NULL, NULL, &found,
	                                             err);

	if (status != RB_OK)
		return status;
	*deep = mark_groups(world, &found, inspections, marks);
	cohort->depths = found;
	cohort->has_depths = !*deep && holds;
	return RB_OK;
}

enum rb_status rb_relinearize(struct rb_world *world, struct rb_cohort *cohort, int inspections,
                              bool *again, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct view view;
	const size_t groups = s->solver.island_count + 1, n = (size_t)world->model->body_count;
	struct marks marks = {.of_group = rb_arena_take(&world->arena[0], groups, 1),
	                      .alone = rb_arena_take(&world->arena[0], n, 1)};
	enum rb_status status = RB_OK;
	bool deep = false;

	*again = false;
	if (!marks.of_group || !marks.alone)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of a step");
	memset(marks.of_group, 0, groups);
	memset(marks.alone, 0, n);
	status = find_deep(world, cohort, inspections, &marks, &deep, err);
	if (status != RB_OK)
		return status;
	const bool joints = rb_joints_mark(world, marks.of_group);
	const bool springs = rb_springs_mark(world, marks.of_group);
	if (!joints && !springs && !deep)
		return RB_OK;
	cohort->has_depths = false;
	if (!take_view(world, cohort, deep ? &cohort->depths : NULL, &marks, &view))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the points of a step");
	if (deep) {
		give_rows(world, &marks);
		clear_velocities(world, &view);
		status = find_points(world, cohort->candidates, &view, err);
		if (status == RB_OK)
			status = merge(world, cohort, &view, err);
	}
	if (status != RB_OK)
		return status;
	rb_joints_bend(world, marks.of_group);
	rb_springs_bend(world, marks.of_group);
	rb_solver_go_back(&s->solver, world);
	*again = true;
	status = rb_solver_again(&s->solver, world, &cohort->points, view.again, err);
	return status == RB_OK ? rb_springs_join_pushed(world, cohort, err) : status;
}
