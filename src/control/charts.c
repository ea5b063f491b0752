/* SPDX-License-Identifier: MIT */
/*
 * Glyphs are Unicode code points, one for each column; the caller draws them in its own style.
 * Every chart has a plain ASCII form for terminals without UTF-8.
 */
#include "control/charts.h"

#include <math.h>

#include "base/error.h"

void rb_chart_range(const double *values, int count, double *low, double *high)
{
	bool any = false;

	*low = *high = 0;
	for (int i = 0; i < count; i++) {
		if (!isfinite(values[i]))
			continue;
		*low = any ? fmin(*low, values[i]) : values[i];
		*high = any ? fmax(*high, values[i]) : values[i];
		any = true;
	}
}

void rb_chart_spark(uint32_t *glyphs, const double *values, int count, double low, double high,
                    bool blocks)
{
	static const char ramp[] = "_.:-=+*#";
	enum { STEPS = 8, LOWEST = 0x2581 };

	RB_ASSERT(count >= 0);
	for (int i = 0; i < count; i++) {
		if (!isfinite(values[i])) {
			glyphs[i] = ' ';
			continue;
		}
		const double share = high > low ? (values[i] - low) / (high - low) : 0;
		const int step = (int)fmin(fmax(floor(share * STEPS), 0), STEPS - 1);
		glyphs[i] = blocks ? (uint32_t)(LOWEST + step) : (uint32_t)ramp[step];
	}
}

double rb_chart_timeline_at(int width, int column)
{
	return width > 1 ? fmin(fmax((double)column / (width - 1), 0), 1) : 0;
}

/* The column of a share of the run; shares outside 0 to 1 go to the edges. */
static int column_of(int width, double share)
{
	return (int)lround(fmin(fmax(share, 0), 1) * (width - 1));
}

void rb_chart_timeline(uint32_t *glyphs, int width, const struct rb_timeline *line, bool blocks)
{
	const uint32_t passed = blocks ? 0x2501 : '=', ahead = blocks ? 0x2500 : '-';
	const uint32_t collision = blocks ? 0x2534 : '!', here = blocks ? 0x25cf : 'O';
	const int at = column_of(width, line->position), last = column_of(width, line->available);

	RB_ASSERT(width >= 0 && line->mark_count >= 0);
	for (int i = 0; i < width; i++)
		glyphs[i] = i < at ? passed : i <= last ? ahead : blocks ? 0x00b7 : '.';
	for (int i = 0; i < line->mark_count; i++)
		if (line->marks[i] > 0)
			glyphs[column_of(width, (i + 0.5) / line->mark_count)] = collision;
	if (width > 0)
		glyphs[at] = here;
}
