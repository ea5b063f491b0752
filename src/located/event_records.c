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

/* Bodies so heavy and fast that no double holds what they exert on each other. */
static void fail_impulse(struct rb_located *l, double t, const struct rb_contact_point *m)
{
	const struct rb_scene *const scene = l->model->scene;
	const int id = l->model->id_of[m->a];
	char a[64], b[64], source[96];

	if (l->status == RB_OK)
		l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
		                    "%sthe impulse of '%s' and '%s' is not finite at t = %.9g s",
		                    rb_scene_body_source(scene, id, source),
		                    rb_scene_body_label(scene, id, a),
		                    rb_scene_body_label(scene, l->model->id_of[m->b], b), t);
}

void rb_record_impact(struct rb_located *l, double t, const struct rb_contact_point *m,
                      rb_vec3 impulse, double approach)
{
	RB_ASSERT(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	RB_ASSERT_COSTLY(approach >= 0);
	if (!rb_vec3_finite(impulse)) {
		fail_impulse(l, t, m);
		return;
	}
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
