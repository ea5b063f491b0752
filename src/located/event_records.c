/* SPDX-License-Identifier: MIT */
/*
 * Events are kept with ids of the scene, a < b, only if a recording or a callback wants them;
 * collisions are always counted.
 */
#include "located/event_records.h"

#include "base/error.h"
#include "world/joint_events.h"

/* Adds an event with ids in order; the normal points from a to b. */
static void add_event(struct rb_located *l, struct rb_event event)
{
	const int a = l->model->id_of[event.a], b = l->model->id_of[event.b];

	event.a = a < b ? a : b;
	event.b = a < b ? b : a;
	if (a > b) {
		event.normal = rb_vec3_neg(event.normal);
		event.impulse = rb_vec3_neg(event.impulse);
	}
	const enum rb_status status = rb_world_add_event(l->world, &event, l->err);

	if (l->status == RB_OK)
		l->status = status;
}

void rb_record_impact(struct rb_located *l, double t, const struct rb_contact_point *m,
                      rb_vec3 impulse, double approach)
{
	RB_ASSERT(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	RB_ASSERT_COSTLY(rb_vec3_finite(impulse));
	RB_ASSERT_COSTLY(approach >= 0);
	add_event(l, (struct rb_event){.time_s = t,
	                               .kind = RB_EVENT_COLLISION,
	                               .a = m->a,
	                               .b = m->b,
	                               .point = m->point,
	                               .normal = m->normal,
	                               .impulse = impulse,
	                               .approach_speed = approach});
}

void rb_record_transition(struct rb_located *l, double t, enum rb_event_kind kind,
                          const struct rb_contact_point *m)
{
	RB_ASSERT(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	add_event(l, (struct rb_event){.time_s = t,
	                               .kind = kind,
	                               .a = m->a,
	                               .b = m->b,
	                               .point = m->point,
	                               .normal = m->normal});
}
