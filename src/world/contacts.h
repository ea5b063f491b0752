/* SPDX-License-Identifier: MIT */
/*
 * The lasting contacts between two steps, sorted by pair. Their forces are state: the next step
 * starts its iteration from them, so a restored run needs them to come out in the same bits.
 */
#ifndef RB_WORLD_CONTACTS_H
#define RB_WORLD_CONTACTS_H

#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

struct rb_contact {
	int a, b;              /* body indices, a < b */
	rb_vec3 point, normal; /* m; unit, from a to b: as of the end of the step, world */
	double gap;            /* m, negative: overlap */
	double normal_force;   /* N, >= 0 */
	rb_vec3 tangent_force; /* N, on b, across the normal */
	uint64_t key;          /* stepped: its name among the points of the pair; no state */
};

struct rb_contacts {
	struct rb_contact *row; /* owned */
	size_t count, capacity;
};

RB_CHECKED enum rb_status rb_contacts_reserve(struct rb_contacts *contacts, size_t count,
                                              struct rb_error *err);
/* Adds them at the end, as they are. */
RB_CHECKED enum rb_status rb_contacts_join(struct rb_contacts *to, const struct rb_contacts *more,
                                           struct rb_error *err);
void rb_contacts_release(struct rb_contacts *contacts);

/* By pair, as all else here wants them. */
void rb_contacts_sort(struct rb_contacts *contacts);

/* The contact of that pair, or NULL. */
const struct rb_contact *rb_contacts_find(const struct rb_contacts *contacts, int a, int b);
/* Forgets the contacts of a body: something other than the step has changed its motion. */
void rb_contacts_drop(struct rb_contacts *contacts, int index);
uint64_t rb_contacts_hash(const struct rb_contacts *contacts, uint64_t seed);

#endif
