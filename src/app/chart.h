/* SPDX-License-Identifier: MIT */
/* The report of error against run time as a picture, CSV and JSON. Main thread; owns nothing. */
#ifndef RB_APP_CHART_H
#define RB_APP_CHART_H

#include "app/plot.h"
#include "app/report.h"

/* Errors across, wall seconds up, both logarithmic; an error of 0 stands at the left edge. */
RB_CHECKED enum rb_status rb_chart_draw(FILE *file, const struct rb_report *report,
                                        enum rb_plot_kind kind, struct rb_plot_size size,
                                        struct rb_error *err);
void rb_chart_print_csv(FILE *file, const struct rb_report *report);
void rb_chart_print_json(FILE *file, const struct rb_report *report, int exit_code);

#endif
