/* SPDX-License-Identifier: MIT */
#include "world/joint_events.h"

#include "base/error.h"
#include "base/memory.h"

struct rb_event rb_joint_event(const struct rb_model *model, enum rb_event_kind kind,
                               const struct rb_joint_moment *moment, double impulse,
                               double approach)
{
	const struct rb_joint *joint = &model->joints->joint[moment->joint];
	const rb_vec3 p_a = rb_linkage_point_a(&joint->link, &moment->a);
	const rb_vec3 p_b = rb_linkage_point_b(&joint->link, &moment->b);
	const rb_vec3 axis = rb_linkage_axis(&joint->link, &moment->a);
	const bool length = joint->link.type->coordinate == RB_COORDINATE_LENGTH;
	const rb_vec3 way = length ? rb_vec3_unit(rb_vec3_sub(p_b, p_a), axis) : axis;
	const int a = model->id_of[joint->a], b = joint->b < 0 ? a : model->id_of[joint->b];
	struct rb_event event = {.time_s = moment->time_s,
	                         .kind = kind,
	                         .a = a < b ? a : b,
	                         .b = a < b ? b : a,
	                         .point = p_b,
	                         .normal = a > b ? rb_vec3_neg(way) : way,
	                         .approach_speed = approach,
	                         .joint = joint->def + 1};

	RB_ASSERT(kind >= RB_EVENT_LIMIT && kind <= RB_EVENT_SLIPS);
	RB_ASSERT_COSTLY(!(approach < 0));
	/* of a pair it is on the second one */
	event.impulse = rb_vec3_scale(a > b ? -impulse : impulse, way);
	return event;
}

bool rb_joint_event_notes(int noted[RB_JOINT_NOTED], int what, bool holds, enum rb_event_kind *kind)
{
	const int before = noted[what];

	RB_ASSERT(what >= 0 && what < RB_JOINT_NOTED);
	noted[what] = holds;
	if (what == RB_JOINT_TAUT)
		*kind = RB_EVENT_SLACK;
	else
		*kind = holds ? RB_EVENT_DRIVES : RB_EVENT_SLIPS;
	return before >= 0 && before != (int)holds && !(what == RB_JOINT_TAUT && holds);
}

enum rb_status rb_world_add_event(struct rb_world *world, const struct rb_event *event,
                                  struct rb_error *err)
{
	struct rb_events *const events = &world->events;
	const bool impact = rb_event_is_impact(event->kind);
	const bool heard = impact ? world->hooks.collision != NULL
	                          : world->hooks.transition != NULL;

	RB_ASSERT(event->a <= event->b);
	if (impact)
		world->frame_counts.collisions++;
	if (!world->options.keep_events && !heard)
		return RB_OK;
	if (!rb_memory_reserve(&events->row, &events->capacity, events->count + 1,
	                       sizeof *events->row))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu events", events->count + 1);
	events->row[events->count++] = *event;
	return RB_OK;
}
