/* SPDX-License-Identifier: MIT */
#include "located/interleaved.h"

#include "base/error.h"

#include <float.h>

#include "located/drift.h"

/*
 * Impacts before it is a jam, and for each doubling of the height: bounces of e = 0.9 on their way
 * to 8 ulp, and as many as halve a height thrice.
 */
static const double from = 128, doubles = 32;

static double note(struct rb_located *l, int i, int with, double natural_s, double t, bool others)
{
	struct rb_bounces *const series = &l->bounces[i];

	if ((others || series->met_with != with) && !(series->met_s == t)) {
		const double forgets = fmin(1, (t - series->met_s) / natural_s);

		series->met = 1 + series->met * (1 - forgets);
		series->met_s = t;
	}
	/* of several the order says who is the last */
	series->met_with = others ? -1 : with;
	return series->met;
}

double rb_interleaved_note(struct rb_located *l, const struct rb_contact_point *m, double t,
                           bool others)
{
	double met = 0;

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (!(l->weight > 0))
		return 0;
	const double natural_s = sqrt(2 * rb_contact_point_size(l, m) / l->weight);

	if (!rb_located_fixed(l, m->a))
		met = note(l, m->a, m->b, natural_s, t, others);
	if (!rb_located_fixed(l, m->b))
		met = fmax(met, note(l, m->b, m->a, natural_s, t, others));
	return met;
}

double rb_interleaved_speed(const struct rb_located *l, const struct rb_contact_point *m,
                            double met)
{
	if (!(met > from))
		return 0;
	const double share = RB_SMALLEST_CORNER_ULP * DBL_EPSILON * exp2((met - from) / doubles);

	return sqrt(2 * l->weight * fmin(share, rb_drift_correct) * rb_contact_point_size(l, m));
}
