/* SPDX-License-Identifier: MIT */
/* A meeting of two bodies as a contact of event/together. */
#ifndef RB_EVENT_MECHANICS_H
#define RB_EVENT_MECHANICS_H

#include "event/meet.h"
#include "event/together.h"

/* All but its bodies' places, mode, slip and impulse. */
struct rb_joint_contact rb_mechanics_contact(const struct rb_located *l, const struct rb_meet *m);

/* Inverse inertia in world axes, 1/(kg m^2). */
rb_mat3 rb_mechanics_tensor(const struct rb_located *l, int i, rb_quat orientation);

/* Angular acceleration of a body on a piece, rad/s^2; zero of any other. */
rb_vec3 rb_mechanics_turning(const struct rb_located *l, int i, double t);

#endif
