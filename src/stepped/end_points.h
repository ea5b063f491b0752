/* SPDX-License-Identifier: MIT */
/*
 * Points of a step as they stand at its end, where positions are moved to close overlaps. Geometry
 * is asked about the pairs that overlap; their neighbours in a heap only hold against, and where,
 * the points that the step was solved with say well enough, carried along with both bodies: what
 * turning makes of their gaps is of the second order. All depths are measured afterwards, and
 * geometry is asked about a pair that overlaps then.
 *
 * In the arena of the step; simulator thread.
 */
#ifndef RB_STEPPED_END_POINTS_H
#define RB_STEPPED_END_POINTS_H

#include "stepped/stepped_state.h"

struct rb_end_points {
	const struct rb_world *world;
	const struct rb_step_points *points;
	const struct rb_candidates *candidates;
	/* [bodies and statics]: of a large group that is under way, or no group can move it */
	unsigned char *heap;
	unsigned char *exact; /* [pairs]: geometry is to be asked from now on */
	uint32_t *first;      /* [pairs]: 1 + the first point of each; 0: it has none */
	bool any;
};

/* Before the solver has become that of closing. */
RB_CHECKED enum rb_status rb_end_points_begin(struct rb_end_points *carried, struct rb_world *world,
                                              const struct rb_cohort *cohort, struct rb_error *err);

/* Whether a candidate's points will do, as deep as it was measured last. */
static inline bool rb_end_points_has(struct rb_end_points *carried, size_t pair)
{
	const struct rb_pair of = carried->candidates->pair[pair];

	if (!carried->any || !carried->heap[of.a] || !carried->heap[of.b])
		return false;
	/* written so that NaN is not known */
	if (!(carried->candidates->depth[pair] <= carried->world->model->stepped_tolerance_m))
		carried->exact[pair] = 1;
	return !carried->exact[pair];
}

/* Whether a pair has any. */
static inline bool rb_end_points_is_near(const struct rb_end_points *carried, size_t pair)
{
	return carried->first[pair] > 0;
}

/* Adds those no farther apart than `max`, m, without impulses; false: no memory. */
bool rb_end_points_add(const struct rb_end_points *carried, size_t pair, double max,
                       struct rb_step_points *to);

#endif
