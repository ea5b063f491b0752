/* SPDX-License-Identifier: MIT */
/*
 * What all points of a sweep will take, from trials of some of them. Main thread, the only one of
 * the process.
 */
#ifndef RB_APP_SWEEP_NEEDS_H
#define RB_APP_SWEEP_NEEDS_H

#include "app/planned.h"

struct rb_sweep_needs {
	uint64_t tried;               /* points; 0: nothing is known */
	int jobs;                     /* runs at a time */
	double wall_s;                /* of all points, so many at a time */
	double shortest_s, longest_s; /* of those that were tried */
	bool at_least;                /* a trial did not come to its end */
	uint64_t run_bytes;           /* memory of one run at most, without films */
	uint64_t memory_bytes;        /* of all that go on at a time */
	uint64_t disk_bytes;          /* of all recordings */
};

/* Tries some points of a sweep whose scene is loaded. */
RB_CHECKED enum rb_status rb_sweep_needs_take(struct rb_sweep_needs *needs,
                                              const struct rb_planned *sweep, struct rb_error *err);

#endif
