/* SPDX-License-Identifier: MIT */
/*
 * One point of a sweep, as its files in the folder tell: has its run ended, how, does one go on?
 * And the lock that makes sure that no two processes run the same point.
 */
#ifndef RB_SWEEP_POINT_H
#define RB_SWEEP_POINT_H

#include "sink/module.h"
#include "sweep/folder.h"

enum rb_point_state {
	RB_POINT_MISSING, /* never begun */
	RB_POINT_BEGUN,   /* begun, not at its end */
	RB_POINT_RUNNING, /* by a process that is alive */
	RB_POINT_DONE,
	RB_POINT_FAILED,
	RB_POINT_STATE_COUNT
};

struct rb_point {
	enum rb_point_state state;
	int exit_code; /* of its run, where that has ended; 0 else */
	/*
	 * failed for a reason that another try may mend: memory, disk, a program that is missing, a
	 * crash
	 */
	bool may_mend;
	bool has_checkpoint;             /* beside its recording: it can go on from there */
	char state_hash[17];             /* "" where the run has told none */
	char reason[RB_ERROR_TEXT_SIZE]; /* why it has failed, "" else */
};

/*
 * `module` not NULL: a recording is opened too and must be complete, of this point's seed and
 * parameters, and end in the state that the run told; what is not as it must be counts as begun.
 */
RB_CHECKED enum rb_status rb_point_look(const char *folder, const struct rb_plan *plan,
                                        uint64_t index, const struct rb_hdf5_module *module,
                                        struct rb_point *point, struct rb_error *err);
/*
 * Whether a sweep that goes on has to run a point in this state; `retry`: failed ones, whatever
 * they failed of.
 */
bool rb_point_is_due(const struct rb_point *point, bool retry);

/*
 * Opens the log of a point to write at its end, which whoever holds it open (children too) has
 * locked. -1 in `*descriptor`: another process runs the point.
 */
RB_CHECKED enum rb_status rb_point_lock(const char *folder, const struct rb_plan *plan,
                                        uint64_t index, int *descriptor, struct rb_error *err);

/*
 * Closes the log; the lock goes at once, even if a process that is about to be another program
 * still has it open.
 */
void rb_point_unlock(int descriptor);

/* What the run could not say itself: it ended by a signal or without a word. */
RB_CHECKED enum rb_status rb_point_tell(const char *folder, const struct rb_plan *plan,
                                        uint64_t index, const char *reason, int exit_code,
                                        struct rb_error *err);

#endif
