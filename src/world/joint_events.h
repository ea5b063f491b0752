/* SPDX-License-Identifier: MIT */
/*
 * Events of joints, for every method: what an impact at a limit or by a rope looks like to frames
 * and callbacks, and which changes of what lasts are told.
 *
 * Pure but for the state and world that are passed in; a method that works on several groups at a
 * time makes its events first and adds them in their order.
 */
#ifndef RB_WORLD_JOINT_EVENTS_H
#define RB_WORLD_JOINT_EVENTS_H

#include "world/joint_state.h"
#include "world/world.h"

/* A joint at the moment of an event. */
struct rb_joint_moment {
	int joint;
	double time_s;
	struct rb_pose a, b; /* of its ends; rb_linkage_world for the world */
};

/*
 * RB_EVENT_LIMIT, RB_EVENT_TAUT: `impulse` on b, N s or N m s, along the joint's axis (from a's
 * point to b's of a rope, where it is negative), `approach` > 0, m/s or rad/s. Other kinds: both 0.
 * Its point is that of b, its ids are in order.
 */
struct rb_event rb_joint_event(const struct rb_model *model, enum rb_event_kind kind,
                               const struct rb_joint_moment *moment, double impulse,
                               double approach);

/*
 * Notes in what is `noted` of a joint whether a drive holds it at its speed (of enum
 * rb_joint_drive_kind), or a rope is taut (RB_JOINT_TAUT). True: that has changed since it was
 * known, and is an event of *kind. That a rope has come taut is none: its impact is.
 */
bool rb_joint_event_notes(int noted[RB_JOINT_NOTED], int what, bool holds,
                          enum rb_event_kind *kind);

/*
 * Adds an event to the world's where frames or callbacks want its kind, and counts an impact. Ids
 * are in order. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_world_add_event(struct rb_world *world, const struct rb_event *event,
                                             struct rb_error *err);

#endif
