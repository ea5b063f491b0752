/* SPDX-License-Identifier: MIT */
/*
 * One setting of a method, simulated in a child process: how far off it is, and what it costs.
 *
 * A setting that fails, crashes or takes too long is a result like any other. The calling process
 * must have no threads besides its own.
 */
#ifndef RB_APP_LADDER_H
#define RB_APP_LADDER_H

#include "app/deviation.h"
#include "app/options.h"

struct rb_ladder_method {
	const char *name;              /* in --methods */
	const char *method, *rollback; /* as of --method and --rollback */
};
extern const struct rb_ladder_method rb_ladder_methods[];
extern const int rb_ladder_method_count;

enum rb_rung_state { RB_RUNG_OK, RB_RUNG_FAILED, RB_RUNG_TOO_LONG, RB_RUNG_CRASHED };
/* "ok", "failed", ... */
const char *rb_rung_state_name(enum rb_rung_state state);

/* What is to be run; all borrowed. */
struct rb_rung_order {
	const struct rb_options *options; /* the command line: scene, parameters, threads */
	const struct rb_ladder_method *method;
	double time_step_s, tolerance_m; /* NAN: the scene's */
	int runs;                        /* at most, the first one included */
	double repeat_s;                 /* no further run is begun after so much wall time */
	double deadline_s;               /* of all runs together */
	bool nudge; /* speeds and gravity differ by the rounding of a few operations */

	bool by_reference;             /* compare with the scene's own reference ... */
	const struct rb_path *against; /* ... or with this path; NULL: with nothing */
	struct rb_path *store;         /* NULL: nothing is kept */
	double until_s;
	enum rb_quantity agree_quantity;
	double agree;
};

struct rb_rung_result {
	enum rb_rung_state state;
	bool refused;                  /* the scene does not load with this method */
	int exit_status;               /* what rbsim run would end with; 0 when ok */
	char text[RB_ERROR_TEXT_SIZE]; /* why it is not ok, "" when it is */

	int runs;
	double wall_s,
		cpu_s;  /* least of all runs, without loading and without what comparing took */
	double spent_s; /* wall time of all runs together */

	struct rb_deviation of[RB_QUANTITY_COUNT];
	bool energy_drifts;
	double agree_s, start; /* as in struct rb_watch */
	double max_penetration_m;
	uint64_t events, rollbacks, body_steps, discarded_body_steps;
};

/* RB_OK whatever becomes of the setting; else what kept us from trying it. */
RB_CHECKED enum rb_status rb_rung_run(struct rb_rung_result *result,
                                      const struct rb_rung_order *order, struct rb_error *err);

#endif
