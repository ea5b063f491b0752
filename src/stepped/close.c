/* SPDX-License-Identifier: MIT */
#include "stepped/close.h"

#include <string.h>

#include "base/forest.h"
#include "base/memory.h"

/* Rounds; and by how many of the deepest overlaps a body may be moved, as one pushes the next. */
enum { CLOSINGS_MOST = 12, CHAIN_MOST = 16 };

/* Overlap after a step that moving positions may close, over the smallest size; more than that and the bends is taken back. */
static const double closable_share = 0.01;
/* A turn within a step whose bend is closed at most: a quarter of a radian, of which the bend is a thirty-second. */
static const double bend_turn_most = 0.25;

/* ---- which groups ---- */

/* Of all points those of groups that overlap and in which nobody is bad: the others are as they should be, or lost. */
static enum rb_status keep_points(struct rb_world *world, const struct rb_cohort *cohort,
                                  const struct rb_depths *found, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_points *points = &s->closing;
	const size_t n = (size_t)world->model->body_count;
	int *parent = rb_arena_take(&world->arena[0], n, sizeof *parent);
	signed char *moves = rb_arena_take(&world->arena[0], n, 1);
	size_t kept = 0;

	if (!parent || !moves)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	for (int k = 0; k < cohort->member_count; k++) {
		parent[cohort->body[k]] = cohort->body[k];
		moves[cohort->body[k]] = 0;
	}
	for (size_t k = 0; k < points->count; k++) {
		const struct rb_point *point = &points->row[k];

		if (!rb_stepped_yields(world, point->b))
			continue;
		const int a = rb_forest_root(parent, point->a),
			  b = rb_forest_root(parent, point->b);
		parent[a > b ? a : b] = a > b ? b : a;
	}
	for (size_t k = 0; k < found->deep_count; k++)
		moves[rb_forest_root(parent, found->deep[k].a)] = 1;
	for (int k = 0; s->bad_count > 0 && k < cohort->member_count; k++)
		if (s->bad[cohort->body[k]])
			moves[rb_forest_root(parent, cohort->body[k])] = -1;
	for (size_t k = 0; k < points->count; k++)
		if (moves[rb_forest_root(parent, points->row[k].a)] > 0)
			points->row[kept++] = points->row[k];
	points->count = kept;
	return RB_OK;
}

/* ---- moving ---- */

/* Moves positions by what the solver's velocities have become. */
static void shift(struct rb_world *world, const struct rb_cohort *cohort)
{
	const struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k];

		if (solver->island_of[i] < 0)
			continue;
		const struct rb_dense_body *body = &solver->dense.body[i];
		double *const at = world->state.position + 3 * (size_t)i;

		rb_vec3_to(at, rb_vec3_add(rb_vec3_from(at), body->linear));
		if (!world->state.spin)
			continue;
		double *const q = world->state.orientation + 4 * (size_t)i;
		rb_quat_to(q, rb_quat_unit(rb_quat_multiply(rb_quat_from_turn(body->angular),
		                                            rb_quat_from(q))));
	}
}

/* Velocities of the cohort to or from the rows that are put aside; while positions are moved, they are ways. */
static void put_aside(struct rb_world *world, const struct rb_cohort *cohort, bool back)
{
	double *const aside = world->stepped->aside;
	double *const spin_aside = aside + 3 * (size_t)world->model->body_count;

	for (int k = 0; k < cohort->body_count; k++) {
		const size_t row = 3 * (size_t)cohort->body[k], size = 3 * sizeof(double);

		memcpy(back ? world->state.velocity + row : aside + row,
		       back ? aside + row : world->state.velocity + row, size);
		if (world->state.spin)
			memcpy(back ? world->state.spin + row : spin_aside + row,
			       back ? spin_aside + row : world->state.spin + row, size);
	}
}

static void clear_velocities(struct rb_world *world, const struct rb_cohort *cohort)
{
	for (int k = 0; k < cohort->body_count; k++) {
		const size_t row = 3 * (size_t)cohort->body[k], size = 3 * sizeof(double);

		memset(world->state.velocity + row, 0, size);
		if (world->state.spin)
			memset(world->state.spin + row, 0, size);
	}
}

static enum rb_status find_depths(struct rb_world *world, struct rb_cohort *cohort,
                                  struct rb_depths *found, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	rb_near_place(cohort->near, world, cohort->body, cohort->body_count);
	return rb_points_depths(world, cohort->near, s->bad_count > 0 ? s->bad : NULL, found, err);
}

static double deepest(const struct rb_depths *found)
{
	double most = 0;

	for (size_t k = 0; k < found->deep_count; k++)
		most = fmax(most, found->deep[k].depth);
	return most;
}

static enum rb_status close_once(struct rb_world *world, struct rb_cohort *cohort,
                                 const struct rb_depths *found, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;

	clear_velocities(world, cohort);
	/* parts stand where their overlaps were found */
	const double most = CHAIN_MOST * deepest(found) + world->model->tolerance_m;
	enum rb_status status = rb_points_find(&s->closing, world, cohort->near, 1, most, err);
	if (status == RB_OK)
		status = keep_points(world, cohort, found, err);
	for (size_t k = 0; status == RB_OK && k < s->closing.count; k++)
		s->closing.row[k].friction = 0;
	if (status == RB_OK)
		status = rb_solver_step(&s->solver, world, NULL, &s->closing, 1, err);
	if (status == RB_OK)
		shift(world, cohort);
	return status;
}

static void blame(struct rb_world *world, const struct rb_deep *deep)
{
	rb_stepped_blame(world->stepped, deep->a);
	if (rb_stepped_yields(world, deep->b))
		rb_stepped_blame(world->stepped, deep->b);
}

/* m: how far points of a body that turns are off the straight ways that contacts were solved for, r (w h)^2 / 2. */
static double bend_of(const struct rb_world *world, int i, double h)
{
	if (!world->state.spin || i >= world->model->body_count)
		return 0;
	const double turn = fmin(bend_turn_most,
	                         h * fmax(rb_vec3_length(rb_world_row3(world->state.spin, i)),
	                                  rb_vec3_length(rb_world_row3(world->mark.spin, i))));
	return 0.5 * turn * turn * rb_near_size(world->model, i);
}

static void blame_unclosable(struct rb_world *world, const struct rb_cohort *cohort,
                             const struct rb_depths *found)
{
	const double h = cohort->near->h_s;

	for (size_t k = 0; k < found->deep_count; k++) {
		const struct rb_deep *deep = &found->deep[k];

		if (!(deep->depth <= closable_share * world->model->size_min_m +
		                             bend_of(world, deep->a, h) +
		                             bend_of(world, deep->b, h)))
			blame(world, deep);
	}
}

static bool all_is_lost(const struct rb_stepped *s, const struct rb_cohort *cohort)
{
	return s->bad_count > 0 && !cohort->divides;
}

enum rb_status rb_close_overlap(struct rb_world *world, struct rb_cohort *cohort,
                                struct rb_depths *found, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = find_depths(world, cohort, found, err);
	struct rb_depths last = *found;

	if (status != RB_OK || found->deep_count == 0)
		return status;
	blame_unclosable(world, cohort, found);
	if (all_is_lost(s, cohort))
		return RB_OK;
	put_aside(world, cohort, false);
	for (int round = 0; round < CLOSINGS_MOST && status == RB_OK && last.deep_count > 0;
	     round++) {
		status = close_once(world, cohort, &last, err);
		/* nothing moves: all that overlap are with somebody who is bad */
		if (status == RB_OK && s->closing.count == 0)
			break;
		world->frame_counts.closings++;
		if (status == RB_OK)
			status = find_depths(world, cohort, &last, err);
	}
	put_aside(world, cohort, true);
	for (size_t k = 0; k < last.deep_count; k++)
		blame(world, &last.deep[k]);
	if (last.deep_count > 0 || s->bad_count == 0)
		*found = last;
	else
		found->most = fmax(found->most, last.most);
	return status;
}
