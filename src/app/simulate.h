/* SPDX-License-Identifier: MIT */
/*
 * One run from frame 0 to its end: world, ring, recorder, films and progress thread.
 *
 * The calling thread becomes the simulator's: it owns world and script until rb_simulate returns.
 * The threads of recorder and films (flow/pump) and the thread of signals and progress
 * (app/progress) live inside the call.
 */
#ifndef RB_APP_SIMULATE_H
#define RB_APP_SIMULATE_H

#include <stdbool.h>

#include <rbsim/world.h>

#include "app/balance.h"
#include "app/common.h"
#include "app/films.h"
#include "app/listen.h"
#include "app/measured.h"
#include "app/resume.h"
#include "base/field_list.h"
#include "flow/run_info.h"
#include "script/hooks.h"

/* What a run tells of itself; filled as far as it came. */
/* Sums and extremes of all frames so far. Drifts: largest |x(t) - x(0)|; NAN: some was none. */
#define RB_RUN_SUM_FIELDS(X)                                                                 \
	X(uint64_t, frames, , "", "made", RB_ANY_BITS)                                       \
	X(double, time_s, , "s", "reached", RB_NUMBER)                                       \
	X(double, wall_before_s, , "s", "taken by the processes before this one", RB_NUMBER) \
	X(double, kinetic_max_j, , "J", "largest kinetic energy", RB_NUMBER)                 \
	X(double, max_penetration_m, , "m", "largest overlap", RB_NUMBER)                    \
	X(double, gravitation_error, , "", "largest one", RB_NUMBER)                         \
	X(double, gravitation_energy_error, , "", "largest one", RB_NUMBER)                  \
	X(double, energy_drift_j, , "J", "drift", RB_NUMBER)                                 \
	X(double, momentum_drift, , "kg m/s", "drift", RB_NUMBER)                            \
	X(double, angular_momentum_drift, , "kg m^2/s", "drift", RB_NUMBER)                  \
	X(double, center_drift_m, , "m", "of the centre of mass from its straight way", RB_NUMBER)
struct rb_run_result {
	enum rb_status
		status; /* of the simulation and its recording; films and expectations apart */
	struct rb_error error; /* when status is not RB_OK */
	int signal;            /* that ended it, 0: none */
	bool restart;          /* it is to begin anew: status is RB_ERR_INTERRUPT then */
	enum rb_status
		film_status; /* of the films; the run and its recording are as if there were none */
	struct rb_error film_error;
	enum rb_status expect_status; /* RB_ERR_SCENE: an expectation is broken, as told here */
	struct rb_error expect_error;

	/* what a run that goes on from a checkpoint continues */
	RB_RUN_SUM_FIELDS(RB_FIELD_MEMBER)

	uint64_t frame_count;     /* of the whole run */
	double wall_s;            /* taken, by all processes that it took */
	uint64_t memory_bytes;    /* largest resident set of the process */
	uint64_t recording_bytes; /* size of the file */
	struct rb_checkpoints_tally checkpoints;
	bool recorder_failed; /* then the file may hold fewer frames than were made */
	bool recorded_known;
	uint64_t recorded_frames; /* in the file, where it is known */
	uint64_t state_hash;

	struct rb_frame_numbers first, last; /* of frame 0 and of the last one made */
	struct rb_balance balance;
	struct rb_frame_numbers totals; /* counts of the whole run */
	struct rb_world_work work;

	struct rb_expect_result
		*expects; /* owned; [expect_count] of the scene, NULL: not reached */
	int expect_count, expect_failures;
	struct rb_measured measured; /* results and probes */
};

/* What the recording says of the run. `texts` is released with rb_run_texts_release in any case. */
RB_CHECKED enum rb_status rb_simulate_info(struct rb_run_info *info, struct rb_run_texts *texts,
                                           const struct rb_loaded *loaded,
                                           const struct rb_options *options, struct rb_error *err);
void rb_run_texts_release(struct rb_run_texts *texts);

/* Threads that the options ask for. */
int rb_simulate_threads(const struct rb_options *options);

/*
 * An existing file that may not be replaced, nor gone on with, is refused before anything starts.
 */
RB_CHECKED enum rb_status rb_simulate_check_output(const struct rb_loaded *loaded,
                                                   const struct rb_options *options,
                                                   struct rb_error *err);

/* What may be missing: NULL. */
struct rb_simulate_parts {
	struct rb_films *films;   /* none are made */
	struct rb_listen *listen; /* nobody commands the run */
	struct rb_resume *resume; /* from the beginning */
	bool again;               /* ... over what the recording has, from its first frame on */
};

/* The status is also in the result, which is to be released in any case. */
enum rb_status rb_simulate(struct rb_run_result *result, struct rb_loaded *loaded,
                           const struct rb_options *options, const struct rb_run_info *info,
                           const struct rb_simulate_parts *parts);
void rb_run_result_release(struct rb_run_result *result);

#endif
