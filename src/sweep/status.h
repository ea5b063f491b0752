/* SPDX-License-Identifier: MIT */
/* How far a sweep is, and which tasks of a job array have something left to do. */
#ifndef RB_SWEEP_STATUS_H
#define RB_SWEEP_STATUS_H

#include "sweep/point.h"

/* "done", "running", ... */
extern const char *const rb_point_state_names[RB_POINT_STATE_COUNT];

struct rb_sweep_status {
	uint64_t points[RB_POINT_STATE_COUNT];
	uint64_t due; /* what another call of the sweep would run */
	/*
	 * owned: the tasks with points that are due, as job arrays want them: "3,7-9"; "" without
	 * any
	 */
	char *array;
	uint64_t tasks; /* how many are in it */
};

/* What is asked; all borrowed. */
struct rb_status_wish {
	const char *folder;
	const struct rb_plan *plan;
	const struct rb_hdf5_module *module; /* as for rb_point_look */
	uint64_t tasks;                      /* shares of the array; 0: each point is a task */
	bool retry;                          /* failed points are due */
	void (*failed)(void *user, uint64_t index, const struct rb_point *point); /* may be NULL */
	void *user;
};

/* Released in any case. */
RB_CHECKED enum rb_status rb_status_take(struct rb_sweep_status *status,
                                         const struct rb_status_wish *wish, struct rb_error *err);
void rb_status_release(struct rb_sweep_status *status); /* safe on a zeroed one */

#endif
