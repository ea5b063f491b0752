/* SPDX-License-Identifier: MIT */
/*
 * Error against run time: orders, advice, and the table of both. app/chart has pictures and files.
 *
 * Plain data, filled by app/converge; main thread.
 */
#ifndef RB_APP_REPORT_H
#define RB_APP_REPORT_H

#include <stdio.h>

#include "app/ladder.h"

enum { RB_REPORT_NOTE_SIZE = 200 };

/* One point of the diagram. */
struct rb_report_row {
	int method; /* in the report's list */
	double time_step_s;
	double tolerance_m; /* NAN: the scene's */
	struct rb_rung_result result;
};

struct rb_report_method {
	const struct rb_ladder_method *method;
	double order;     /* error ~ dial^order; NAN: there is none to be told */
	int order_points; /* that it was fitted to */
	char order_note[RB_REPORT_NOTE_SIZE]; /* why there is none */
	char left_out[RB_REPORT_NOTE_SIZE];   /* settings that were not tried, "" without */
};

struct rb_report {
	const char *scene, *title; /* borrowed */
	int body_count;
	uint64_t frame_count;
	double duration_s;
	enum rb_quantity quantity;
	double error;      /* that is wanted */
	bool by_tolerance; /* the dial is the tolerance, not the time step */
	int threads;
	double budget_s, spent_s;

	/* what the errors are measured against */
	bool own_reference, energy_drifts;
	char reference[RB_REPORT_NOTE_SIZE]; /* a sentence on it */
	char warning[RB_REPORT_NOTE_SIZE];   /* what to mind of it, "" without */
	double reference_error;              /* its own, NAN: unknown */
	bool reference_agrees, diverges;
	double horizon_s; /* errors are measured up to here; INFINITY: the end */

	struct rb_report_method *methods; /* owned */
	int method_count;
	struct rb_report_row *rows; /* owned; by method, coarse to fine */
	int row_count;

	int advised; /* the row, -1: none */
	char advice[3 * RB_REPORT_NOTE_SIZE];
};

/* Of all work of a run, what was taken back: 0 to 1. */
double rb_report_discarded(const struct rb_rung_result *result);

/* The error that counts: the largest of the report's quantity; NAN where it is not known. */
double rb_report_error(const struct rb_report *report, const struct rb_report_row *row);

/*
 * The same, but not below what the reference itself is known to: a run has no error against itself.
 */
double rb_report_least_error(const struct rb_report *report, const struct rb_report_row *row);

/* Fits orders and finds the advice, from the rows. */
void rb_report_conclude(struct rb_report *report);

/* `width` in characters; columns that do not fit are left out. 0: all of them. */
RB_CHECKED enum rb_status rb_report_print(FILE *file, const struct rb_report *report, int width,
                                          struct rb_error *err);
void rb_report_print_end(FILE *file, const struct rb_report *report);
void rb_report_release(struct rb_report *report);

#endif
