/* SPDX-License-Identifier: MIT */
#include "located/closing.h"

#include <float.h>

enum rb_closing rb_closing_of(const struct rb_located *l, const struct rb_touch_pair *pair)
{
	struct rb_contact_point all[RB_CONTACT_POINTS_MAX];
	const int count = rb_touch_all(l, pair, 0, all);
	enum rb_closing found = RB_CLOSING_PARTS;

	for (int k = 0; k < count; k++) {
		const double rate = rb_vec3_dot(all[k].velocity, all[k].normal);
		const double noise = rb_contact_point_noise(l, &all[k]);

		if (rate > noise || rb_contact_point_passes(l, &all[k], pair->t))
			continue;
		if (rate < -noise)
			return RB_CLOSING_CLOSES;
		/*
		 * neither closes nor opens: the relative acceleration decides, beyond its rounding
		 */
		const double max = rb_vec3_length(rb_arc_acceleration(l, pair->a, pair->t)) +
		                   rb_vec3_length(rb_arc_acceleration(l, pair->b, pair->t)) +
		                   rb_vec3_dot(pair->pose_a.spin, pair->pose_a.spin) *
		                           rb_vec3_length(all[k].arm_a) +
		                   rb_vec3_dot(pair->pose_b.spin, pair->pose_b.spin) *
		                           rb_vec3_length(all[k].arm_b);
		const double bend = rb_contact_point_gap_acceleration(l, &all[k], pair->t);
		const double least = 64 * DBL_EPSILON * max;

		if (bend <= least && found != RB_CLOSING_BEGINS)
			found = bend < -least ? RB_CLOSING_BEGINS : RB_CLOSING_RESTS;
	}
	return found;
}
