/* SPDX-License-Identifier: MIT */
/*
 * A flat end that lands on a surface touches at a point of its rim, then along all of it. A rolling
 * rim is followed by the half that contains its lowest point; when the gap of the opposite half is
 * within rounding, the contact becomes an impact of the whole rim.
 */
#include "located/rim_landing.h"

#include "located/event_set.h"

/* Sets the half of held rims that have begun to roll. */
static void set_halves(struct rb_modes *w)
{
	const struct rb_located *l = w->l;
	const rb_vec3 none = {0, 0, 0};

	for (int k = 0; k < w->c->held_count; k++) {
		struct rb_held *const held = &w->c->held[k];

		if (rb_event_set_is_single(l, held->a, held->b))
			continue;
		struct rb_held now = *held;
		now.half = none;
		const struct rb_contact_point m = rb_event_set_contact_point(l, &now, w->origin_s);
		/* a point counted from a half keeps it */
		if (rb_touch_half(l, &m, &now.half))
			held->half = now.half;
	}
}

bool rb_rim_landing_begin(struct rb_modes *w)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	const rb_vec3 none = {0, 0, 0};
	int contact = -1;

	set_halves(w);
	for (int k = 0; k < c->held_count && contact < 0; k++) {
		const struct rb_contact_point m = rb_event_set_contact_point(l, &c->held[k],
		                                                             w->origin_s);

		if (rb_event_set_landing_gap(l, &m) > 0)
			contact = k;
	}
	if (contact < 0)
		return false;
	for (int k = 0; k < c->member_count; k++) {
		const struct rb_pose pose = rb_arc_pose(l, c->member[k], w->origin_s);

		rb_arc_anchor(l, c->member[k], w->origin_s, &pose, none, none);
	}
	c->integrated = false;
	c->has_jumped = c->hits = true;
	c->hit_a = c->held[contact].a;
	c->hit_b = c->held[contact].b;
	return true;
}
