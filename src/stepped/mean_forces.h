/* SPDX-License-Identifier: MIT */
/*
 * Contacts over a step that was taken in parts: each point's force is the mean over the step, and
 * acts where, and along which normal, the impulses of the parts have acted in the mean.
 *
 * Simulator thread.
 */
#ifndef RB_STEPPED_MEAN_FORCES_H
#define RB_STEPPED_MEAN_FORCES_H

#include <stdbool.h>

#include "world/contacts.h"

struct rb_mean_force {
	struct rb_contact contact; /* as the last part had it that had it */
	rb_vec3 normal_impulse,
		friction_impulse; /* N s, on b: along the normals of parts, and across them */
	rb_vec3 moment;           /* N s m: points times the normal impulses */
	double weight;            /* N s: those added up */
	bool lasts;               /* the last part had it */
};

struct rb_mean_forces {
	struct rb_mean_force *row; /* owned; by name */
	size_t count, capacity;
	struct rb_mean_force *spare; /* owned: the other buffer for them */
	size_t spare_capacity;
};

void rb_mean_forces_release(struct rb_mean_forces *means);

/* Adds the contacts of a part of h_s, which are left in the order of names. */
RB_CHECKED enum rb_status rb_mean_forces_add(struct rb_mean_forces *means, struct rb_contacts *part,
                                             double h_s, struct rb_error *err);

/*
 * Adds to `to`, which is then no longer in order, the contacts over a step of h_s: those that
 * carried force in it, or last.
 */
RB_CHECKED enum rb_status rb_mean_forces_record(const struct rb_mean_forces *means, double h_s,
                                                struct rb_contacts *to, struct rb_error *err);

#endif
