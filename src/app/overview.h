/* SPDX-License-Identifier: MIT */
/*
 * What a sweep on this machine says while it runs: one line that is redrawn on a terminal, now and
 * then a line elsewhere, and a line for each of the first points that fail. On standard error. Main
 * thread.
 */
#ifndef RB_APP_OVERVIEW_H
#define RB_APP_OVERVIEW_H

#include "sweep/jobs.h"

struct rb_overview {
	const struct rb_plan *plan; /* borrowed */
	const char *folder;         /* borrowed: as the user calls it */
	bool quiet, redraw, shown;
	uint64_t failures; /* told so far */
};

void rb_overview_init(struct rb_overview *overview, const struct rb_plan *plan, const char *folder,
                      bool quiet);
/* How often rb_overview_tick is wanted; 0: never. */
int rb_overview_tick_ms(const struct rb_overview *overview);
/* For struct rb_jobs_order; `overview` is the struct. */
void rb_overview_tick(void *overview, const struct rb_jobs_tally *tally);
void rb_overview_told(void *overview, uint64_t index, const struct rb_point *point);
/* The last lines. */
void rb_overview_end(struct rb_overview *overview, const struct rb_jobs_tally *tally, int jobs);

/*
 * "312 of 1000 done, 2 running, 3 failed, 4:10 min left" behind a bar, of at most `width` columns.
 */
void rb_overview_line(char *line, size_t size, int width, const struct rb_jobs_tally *tally);

#endif
