/* SPDX-License-Identifier: MIT */
/*
 * Diagrams, drawn by gnuplot in a child process that no shell stands between.
 *
 * Everything is borrowed for the time of the call.
 */
#ifndef RB_APP_PLOT_H
#define RB_APP_PLOT_H

#include <stdbool.h>
#include <stdio.h>

#include <rbsim/error.h>

struct rb_plot_series {
	const char *name;    /* in the key */
	const double *x, *y; /* points that are not finite are left out */
	int count;
	bool crosses; /* single crosses instead of a marked line */
	bool plain;   /* a line without marks */
	int like;     /* index of the series whose colour this one takes; its own: a new colour */
};

struct rb_plot {
	const char *title, *x_label, *y_label;
	bool x_log, y_log;
	double x_low, x_high, y_low, y_high; /* NAN: as the points need */
	const struct rb_plot_series *series;
	int series_count;
};

enum rb_plot_kind { RB_PLOT_TEXT, RB_PLOT_SVG, RB_PLOT_PNG };

/*
 * RB_ERR_MISSING where no gnuplot is in PATH; the message ends in what the caller can do instead,
 * "": nothing.
 */
RB_CHECKED enum rb_status rb_plot_available(const char *instead, struct rb_error *err);

/*
 * Characters of a text, pixels of a picture; `color` of a text. RB_ERR_MISSING with gnuplot's words
 * when it fails.
 */
struct rb_plot_size {
	int width, height;
	bool color;
};
/* As large as the terminal on standard output; a page of text where there is none. */
struct rb_plot_size rb_plot_text_size(void);

RB_CHECKED enum rb_status rb_plot_draw(const struct rb_plot *plot, enum rb_plot_kind kind,
                                       struct rb_plot_size size, FILE *to, struct rb_error *err);

#endif
