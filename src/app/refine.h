/* SPDX-License-Identifier: MIT */
/*
 * A reference for scenes that state none: one method, finer and finer, until two successive runs
 * agree.
 *
 * The difference of two runs says how far the coarser one is off. A last run whose speeds and
 * gravity differ by rounding says what rounding grows to: a method that lands its events to
 * rounding would otherwise agree with itself whatever the scene does to small errors.
 */
#ifndef RB_APP_REFINE_H
#define RB_APP_REFINE_H

#include "app/ladder.h"

struct rb_refine_order {
	const struct rb_options *options;
	const struct rb_ladder_method *method;
	double interval_s;  /* between frames */
	double time_step_s; /* to start at */
	double fine_s;      /* go at least as fine as this; INFINITY: no matter */
	double tolerance_m; /* NAN: the scene's */
	enum rb_quantity quantity;
	double error; /* of it, that is to be told from 0 */
	double budget_s;
	/* how much longer a step of half a decade less is expected to take, before that is known */
	double growth;
	void (*tell)(double time_step_s, void *user); /* before each run */
	void *user;
};

struct rb_refined {
	bool found;          /* there is a path; else `text` says why not */
	struct rb_path path; /* owned */
	double time_step_s;  /* of the run that made it */
	double estimate;     /* of its own error; NAN: unknown */
	bool agrees;         /* with the run before, within the wanted error */
	bool diverges;       /* finer steps, or rounding, do not come to one answer ... */
	double horizon_s;    /* ... beyond this time; NAN: not even at the start */
	int runs;
	double spent_s;
	char text[RB_ERROR_TEXT_SIZE];
};

/* Release in any case. Fails on what keeps us from trying. */
RB_CHECKED enum rb_status rb_refine(struct rb_refined *refined, const struct rb_refine_order *order,
                                    const struct rb_model *model, struct rb_error *err);
void rb_refined_release(struct rb_refined *refined);

#endif
