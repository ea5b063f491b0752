/* SPDX-License-Identifier: MIT */
#include "located/bounces.h"

#include <float.h>

#include "base/error.h"
#include "located/event_set.h"

/* Share of its duration by which a flight of a series may end early or late. */
static const double disturbed_share = 0.25;
/* Rounding of a gap, in ulp of the size, and of a time. */
enum { GAP_ULP = 2, TIME_ULP = 4 };

double rb_bounces_closing(const struct rb_located *l, const struct rb_contact_point *m, double t)
{
	const struct rb_held *held = rb_event_set_continued(l, m);

	if (held) /* the acceleration that its force has balanced */
		return fabs(rb_vec3_dot(held->force, m->normal)) *
		       (l->model->inverse_mass[m->a] + l->model->inverse_mass[m->b]);
	return -rb_contact_point_gap_acceleration(l, m, t);
}

void rb_bounces_note(struct rb_located *l, const struct rb_contact_point *m, double t, double u,
                     double closing, double e)
{
	struct rb_bounces *const series = &l->bounces[m->a];
	const double flight = 2 * u / closing, was = series->due_s - series->at_s;
	const double late = t - series->due_s;
	const bool follows = series->partner == m->b && was > 0 &&
	                     fabs(late) <= disturbed_share * was;

	RB_ASSERT(m->a < l->n && u > 0 && closing > 0 && e > 0 && e < 1);
	const double change = follows ? late / was : 0;
	const double limit = t + flight / (1 - e) + flight * change * e * e / (1 - e * e * e);
	/* each bounce shifts the following ones: the sum of their shares, twice that of the next */
	const double gap = GAP_ULP * DBL_EPSILON * rb_contact_point_size(l, m);
	const double error = follows ? (flight * fabs(change) + 2 * gap / (u * (1 - e))) / (1 - e) +
	                                       TIME_ULP * DBL_EPSILON * t
	                             : (double)INFINITY;
	const bool agrees = follows && fabs(limit - series->limit_s) <= error + series->error_s;

	if (!(agrees && series->error_s <= error)) {
		series->limit_s = limit;
		series->error_s = error;
	}
	series->at_s = t;
	series->due_s = t + flight;
	series->partner = m->b;
}

double rb_bounces_left(const struct rb_located *l, const struct rb_contact_point *m, double t)
{
	const struct rb_bounces *const series = &l->bounces[m->a];

	RB_ASSERT(series->partner == m->b && series->at_s == t);
	return fmax(0, series->limit_s - t);
}
