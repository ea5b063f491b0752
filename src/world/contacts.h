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

#include "constraint/contact_name.h"
#include "world/limits.h"

/*
 * As of the end of the step, world axes. The name is that which methods share
 * (rb_contact_name_shared): another method finds the forces by it. Zero where the classic method
 * has it, whose pairs have one point.
 */
#define RB_CONTACT_FIELDS(X)                                                   \
	X(int, a, , "", "body index", RB_UP_TO(RB_LIMIT_BODY))                 \
	X(int, b, , "", "body index, > a", RB_UP_TO(RB_LIMIT_ANY_BODY))        \
	X(rb_vec3, point, , "m", "where they touch", RB_FINITE)                \
	X(rb_vec3, normal, , "1", "unit, from a to b", RB_FINITE)              \
	X(double, gap, , "m", "negative: overlap", RB_FINITE)                  \
	X(double, normal_force, , "N", ">= 0", RB_FINITE)                      \
	X(rb_vec3, tangent_force, , "N", "on b, across the normal", RB_FINITE) \
	X(uint32_t, parts, , "", "of its name", RB_ANY_BITS)                   \
	X(uint64_t, key, , "", "of its name", RB_ANY_BITS)
struct rb_contact {
	RB_CONTACT_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_contact_fields);

struct rb_contacts {
	struct rb_contact *row; /* owned */
	size_t count, capacity;
};

static inline struct rb_contact_name rb_contact_name_in(const struct rb_contact *contact)
{
	return (struct rb_contact_name){
		.a = contact->a, .b = contact->b, .parts = contact->parts, .key = contact->key};
}

RB_CHECKED enum rb_status rb_contacts_reserve(struct rb_contacts *contacts, size_t count,
                                              struct rb_error *err);
/* Adds them at the end, as they are. */
RB_CHECKED enum rb_status rb_contacts_join(struct rb_contacts *to, const struct rb_contacts *more,
                                           struct rb_error *err);
void rb_contacts_release(struct rb_contacts *contacts);

/* By pair, as all else here wants them. */
void rb_contacts_sort(struct rb_contacts *contacts);

/* The first contact of that pair in the order of rows, or NULL. */
const struct rb_contact *rb_contacts_first(const struct rb_contacts *contacts, int a, int b);
/* A contact of that pair, or NULL. */
const struct rb_contact *rb_contacts_find(const struct rb_contacts *contacts, int a, int b);
/* Forgets the contacts of a body: something other than the step has changed its motion. */
void rb_contacts_drop(struct rb_contacts *contacts, int index);
uint64_t rb_contacts_hash(const struct rb_contacts *contacts, uint64_t seed);

#endif
