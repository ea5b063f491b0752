/* SPDX-License-Identifier: MIT */
/*
 * The cases of `rbsim verify`: scenes in a folder, and the runs that each asks for.
 *
 * A case says so by its parameters (lua/rbsim/verify.lua declares them): of a variation (time_step,
 * frame_rate, turn, shift, harmless, zero_field) every value but the default is a run of its own;
 * of any other parameter with choices every value is a base that all variations start from. A
 * variation with one choice is left out, and its help says why.
 *
 * Main thread; the caller releases.
 */
#ifndef RB_APP_CASES_H
#define RB_APP_CASES_H

#include <stdbool.h>

#include <rbsim/error.h>

#include "app/options.h"

struct rb_case_run {
	char *label;         /* "base", "e=0.9 turn=2" */
	const char **params; /* owned, and the texts: K=V */
	int param_count;
};

struct rb_case {
	char *path, *name, *title; /* scenes/verify/S03_zeno.lua, S03_zeno, the scene's */
	char *left_out;            /* "turn: why; shift: why", "" when nothing is */
	double limit_s;            /* wall time of a run */
	struct rb_case_run *runs;
	int run_count;
};

struct rb_cases {
	struct rb_case *cases; /* by name */
	int count;
};

/*
 * Those that the words of the command line mean, all without any. RB_ERR_USAGE for a word that no
 * case begins with, RB_ERR_INPUT without a folder or a case in it.
 */
RB_CHECKED enum rb_status rb_cases_init(struct rb_cases *cases, const struct rb_options *options,
                                        struct rb_error *err);
void rb_cases_release(struct rb_cases *cases); /* safe on a zeroed one */

#endif
