/* SPDX-License-Identifier: MIT */
/*
 * Small charts and the time line, as characters. Values; knows no terminal. Any thread.
 */
#ifndef RB_CONTROL_CHARTS_H
#define RB_CONTROL_CHARTS_H

#include <stdbool.h>
#include <stdint.h>

/*
 * A column a value, low values low: eighths of blocks with `blocks`, else characters that are more
 * or less dark. NAN leaves a gap. Where `low` and `high` are the same, all is low.
 */
void rb_chart_spark(uint32_t *glyphs, const double *values, int count, double low, double high,
                    bool blocks);

/* The range of `values`, NAN passed over; 0 to 0 where there are none. */
void rb_chart_range(const double *values, int count, double *low, double *high);

/*
 * `width` columns for the times from 0 to the end of a run: where the view stands (0 to 1), how far
 * there are frames (0 to 1), and `mark_count` parts of the whole in which there were collisions or
 * not.
 */
struct rb_timeline {
	double position, available;
	const uint64_t *marks;
	int mark_count;
};
void rb_chart_timeline(uint32_t *glyphs, int width, const struct rb_timeline *line, bool blocks);
/* The share of the run that a column stands for. */
double rb_chart_timeline_at(int width, int column);

#endif
