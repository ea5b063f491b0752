/* SPDX-License-Identifier: MIT */
/*
 * How long a run will take and how much memory, from trials in processes of their own.
 *
 * The first trial is the run itself, as far as a second of the processor goes. Where that is not
 * the whole run, a second one goes on coarsely (steps at the frame rate, a larger tolerance) to
 * moments spread over the rest; from each of them a third goes on as the run would, for a quarter
 * of a second, and what it takes stands for the moments around. Trials call the scene's callbacks,
 * whose prints go nowhere; nothing of them stays.
 */
#ifndef RB_APP_ESTIMATE_H
#define RB_APP_ESTIMATE_H

#include "app/simulate.h"

struct rb_estimate {
	double run_s;          /* wall time of the simulator, s; NAN: unknown */
	bool at_least;         /* the trials did not come to the end */
	double reached_s;      /* simulated time that they have come to */
	uint64_t memory_bytes; /* largest resident set, without recorder and films */
	uint64_t tried_frames; /* of the first trial */
};

RB_CHECKED enum rb_status rb_estimate_run(const struct rb_loaded *loaded, int threads,
                                          struct rb_estimate *estimate, struct rb_error *err);

#endif
