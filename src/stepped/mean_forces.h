/* SPDX-License-Identifier: MIT */
/*
 * Mean contacts over a step that was taken in parts: each point's force is the mean over the step,
 * with the mean point and normal of the parts' impulses.
 *
 * Simulator thread.
 */
#ifndef RB_STEPPED_MEAN_FORCES_H
#define RB_STEPPED_MEAN_FORCES_H

#include <stdbool.h>

#include "world/contacts.h"

struct rb_mean_force {
	struct rb_contact contact; /* as in the last part that contained it */
	/* N s, on b: along the normals of parts, and across */
	rb_vec3 normal_impulse, friction_impulse;
	rb_vec3 moment; /* N s m: points weighted by normal impulses */
	double weight;  /* N s: sum of normal impulses */
	bool lasts;     /* the last part contained it */
};

struct rb_mean_forces {
	struct rb_mean_force *row; /* owned; sorted by name */
	size_t count, capacity;
	struct rb_mean_force *spare; /* owned: the other buffer */
	size_t spare_capacity;
};

void rb_mean_forces_release(struct rb_mean_forces *means);

/* Adds the contacts of a part of h_s, and sorts them by name. */
RB_CHECKED enum rb_status rb_mean_forces_add(struct rb_mean_forces *means, struct rb_contacts *part,
                                             double h_s, struct rb_error *err);

/*
 * Appends to `to`, which is then unsorted, the contacts over a step of h_s: those that carried
 * force in it or exist at its end.
 */
RB_CHECKED enum rb_status rb_mean_forces_record(const struct rb_mean_forces *means, double h_s,
                                                struct rb_contacts *to, struct rb_error *err);

#endif
