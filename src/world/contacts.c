/* SPDX-License-Identifier: MIT */
#include "world/contacts.h"

#include "base/hash.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

RB_FIELDS_DEFINE(rb_contact_fields, struct rb_contact, RB_CONTACT_FIELDS);

enum rb_status rb_contacts_reserve(struct rb_contacts *contacts, size_t count, struct rb_error *err)
{
	if (!rb_memory_reserve(&contacts->row, &contacts->capacity, count, sizeof contacts->row[0]))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	return RB_OK;
}

enum rb_status rb_contacts_join(struct rb_contacts *to, const struct rb_contacts *more,
                                struct rb_error *err)
{
	const enum rb_status status = rb_contacts_reserve(to, to->count + more->count, err);

	if (status != RB_OK)
		return status;
	if (more->count > 0)
		memcpy(to->row + to->count, more->row, more->count * sizeof *to->row);
	to->count += more->count;
	return RB_OK;
}

void rb_contacts_release(struct rb_contacts *contacts)
{
	rb_memory_free(contacts->row);
	*contacts = (struct rb_contacts){0};
}

static uint64_t pair_key(int a, int b)
{
	return (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
}

static int by_pair(const void *left, const void *right)
{
	const struct rb_contact *a = left, *b = right;
	const uint64_t x = pair_key(a->a, a->b), y = pair_key(b->a, b->b);

	return (x > y) - (x < y);
}

void rb_contacts_sort(struct rb_contacts *contacts)
{
	if (contacts->count > 1)
		qsort(contacts->row, contacts->count, sizeof contacts->row[0], by_pair);
}

const struct rb_contact *rb_contacts_find(const struct rb_contacts *contacts, int a, int b)
{
	const uint64_t wanted = pair_key(a, b);
	size_t low = 0, high = contacts->count;

	while (low < high) {
		const size_t middle = low + (high - low) / 2;
		const uint64_t key = pair_key(contacts->row[middle].a, contacts->row[middle].b);

		if (key == wanted)
			return &contacts->row[middle];
		if (key < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	return NULL;
}

const struct rb_contact *rb_contacts_first(const struct rb_contacts *contacts, int a, int b)
{
	const struct rb_contact *found = rb_contacts_find(contacts, a, b);

	while (found && found > contacts->row && found[-1].a == a && found[-1].b == b)
		found--;
	return found;
}

void rb_contacts_drop(struct rb_contacts *contacts, int index)
{
	size_t kept = 0;

	for (size_t i = 0; i < contacts->count; i++)
		if (contacts->row[i].a != index && contacts->row[i].b != index)
			contacts->row[kept++] = contacts->row[i];
	contacts->count = kept;
}

uint64_t rb_contacts_hash(const struct rb_contacts *contacts, uint64_t seed)
{
	/* member by member: padding has no defined bits */
	for (size_t i = 0; i < contacts->count; i++) {
		const struct rb_contact *c = &contacts->row[i];
		const double values[] = {c->a,
		                         c->b,
		                         c->gap,
		                         c->normal_force,
		                         c->normal.x,
		                         c->normal.y,
		                         c->normal.z,
		                         c->tangent_force.x,
		                         c->tangent_force.y,
		                         c->tangent_force.z};

		seed = rb_hash_bytes(values, sizeof values, seed);
	}
	return seed;
}
