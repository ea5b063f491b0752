/* SPDX-License-Identifier: MIT */
/*
 * Contact points of a step, carried to its end for position projection. The narrow phase is run for
 * pairs that overlap; their neighbours in a heap only resist, for which the step's points, moved
 * with both bodies, are accurate enough: the error of their gaps by rotation is of second order.
 * All depths are measured afterwards, and the narrow phase is run for a pair that overlaps then.
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
	/* [bodies and statics]: in a large group in motion, or not dynamic */
	unsigned char *heap;
	unsigned char *exact; /* [pairs]: the narrow phase is required from now on */
	uint32_t *first;      /* [pairs]: 1 + index of its first point; 0: none */
	bool any;
};

/* To be called before the solver is used for the projection. */
RB_CHECKED enum rb_status rb_end_points_begin(struct rb_end_points *carried, struct rb_world *world,
                                              const struct rb_cohort *cohort, struct rb_error *err);

/* Whether a candidate's carried points are accurate enough, at its last measured depth. */
static inline bool rb_end_points_has(struct rb_end_points *carried, size_t pair)
{
	const struct rb_pair of = carried->candidates->pair[pair];

	if (!carried->any || !carried->heap[of.a] || !carried->heap[of.b])
		return false;
	/* written so that NaN requires the narrow phase */
	if (!((double)carried->candidates->depth[pair] <=
	      carried->world->model->stepped_tolerance_m))
		carried->exact[pair] = 1;
	return !carried->exact[pair];
}

/* Whether a pair has carried points. */
static inline bool rb_end_points_is_near(const struct rb_end_points *carried, size_t pair)
{
	return carried->first[pair] > 0;
}

/* Adds a pair's points with gaps up to `max`, m, without impulses; false: no memory. */
bool rb_end_points_add(const struct rb_end_points *carried, size_t pair, double max,
                       struct rb_step_points *to);

#endif
