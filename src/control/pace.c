/* SPDX-License-Identifier: MIT */
/*
 * Two directions of the same line: from the clock to simulated time, and back to the moment at
 * which a frame is due. They are rounded apart by up to an ulp, so callers that need agreement
 * decide by moments alone. Lateness is kept as sums and a histogram: constant memory, and quantiles
 * exact to one bin.
 */
#include "control/pace.h"

#include <math.h>

#include "base/error.h"

/* s: a tenth of a millisecond, far below the period of any display. */
static const double bin_s = 1e-4;
/* ns: 317 years, still within uint64_t (1.8e19). */
static const double centuries_ns = 1e19;

rb_pace rb_pace_start(double time_s, double speed, uint64_t now_ns)
{
	RB_ASSERT(speed > 0);
	return (rb_pace){.start_s = time_s, .speed = speed, .start_ns = now_ns};
}

double rb_pace_time(const rb_pace *pace, uint64_t now_ns)
{
	if (now_ns <= pace->start_ns)
		return pace->start_s;
	return pace->start_s + pace->speed * 1e-9 * (double)(now_ns - pace->start_ns);
}

uint64_t rb_pace_due(const rb_pace *pace, double time_s)
{
	const double wait_ns = 1e9 * (time_s - pace->start_s) / pace->speed;

	if (!(wait_ns > 0))
		return pace->start_ns;
	if (wait_ns >= centuries_ns - (double)pace->start_ns)
		return UINT64_MAX;
	return pace->start_ns + (uint64_t)ceil(wait_ns);
}

void rb_lateness_add(struct rb_lateness *lateness, uint64_t due_ns, uint64_t shown_ns)
{
	if (lateness->count == 0)
		lateness->first_ns = due_ns;
	const double t = ((double)due_ns - (double)lateness->first_ns) * 1e-9;
	const double l = shown_ns > due_ns ? (double)(shown_ns - due_ns) * 1e-9 : 0;
	const double bin = fmin(floor(l / bin_s), RB_LATENESS_BINS - 1);

	lateness->count++;
	lateness->t += t;
	lateness->l += l;
	lateness->tt += t * t;
	lateness->tl += t * l;
	lateness->largest_s = fmax(lateness->largest_s, l);
	lateness->bin[(int)bin]++;
}

double rb_lateness_drift(const struct rb_lateness *lateness)
{
	const double n = (double)lateness->count;
	const double spread = n * lateness->tt - lateness->t * lateness->t;

	return n > 1 && spread > 0 ? (n * lateness->tl - lateness->t * lateness->l) / spread : 0;
}

double rb_lateness_mean(const struct rb_lateness *lateness)
{
	return lateness->count > 0 ? lateness->l / (double)lateness->count : 0;
}

double rb_lateness_within(const struct rb_lateness *lateness, double share)
{
	uint64_t count = 0;

	RB_ASSERT(share >= 0 && share <= 1);
	for (int i = 0; i < RB_LATENESS_BINS - 1; i++) {
		count += lateness->bin[i];
		if ((double)count >= share * (double)lateness->count)
			return count > 0 ? bin_s * (i + 1) : 0;
	}
	return lateness->largest_s;
}
