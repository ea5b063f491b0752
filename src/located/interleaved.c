/* SPDX-License-Identifier: MIT */
#include "located/interleaved.h"

#include "base/error.h"

#include <float.h>

#include "located/drift.h"

/*
 * Impacts before it is a jam, and for each doubling of the height: those of bounces of e = 0.88
 * from the size down to RB_SMALLEST_CORNER_ULP of it, and those of e = 0.99 that halve a height.
 * The greatest height, rb_drift_correct of sizes, is reached 515 impacts later.
 */
static const double first_impacts = 128, impacts_per_doubling = 32;

static double note(struct rb_located *l, int i, int with, double natural_s, double t, bool others)
{
	struct rb_bounces *const series = &l->bounces[i];

	if ((others || series->met_with != with) && !(series->met_s == t)) {
		const double forgotten = fmin(1, (t - series->met_s) / natural_s);

		series->met = 1 + series->met * (1 - forgotten);
		series->met_s = t;
	}
	/* with several, the last partner would depend on order */
	series->met_with = others ? -1 : with;
	return series->met;
}

double rb_interleaved_note(struct rb_located *l, const struct rb_contact_point *m, double t,
                           bool others)
{
	double count = 0;

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (!(l->weight > 0))
		return 0;
	const double natural_s = sqrt(2 * rb_contact_point_size(l, m) / l->weight);

	if (!rb_located_fixed(l, m->a))
		count = note(l, m->a, m->b, natural_s, t, others);
	if (!rb_located_fixed(l, m->b))
		count = fmax(count, note(l, m->b, m->a, natural_s, t, others));
	return count;
}

double rb_interleaved_speed(const struct rb_located *l, const struct rb_contact_point *m,
                            double count)
{
	if (!(count > first_impacts))
		return 0;
	const double share = RB_SMALLEST_CORNER_ULP * DBL_EPSILON *
	                     exp2((count - first_impacts) / impacts_per_doubling);

	return sqrt(2 * l->weight * fmin(share, rb_drift_correct) * rb_contact_point_size(l, m));
}
