/* SPDX-License-Identifier: MIT */
#include "base/field_list.h"

#include "base/error.h"
#include "base/hash.h"

#include <math.h>

enum { RUNS_MAX = 16 };

/* Neighbouring fields that are packed: one copy. */
struct run {
	size_t offset, size;
};

struct plan {
	struct run run[RUNS_MAX];
	int count;
	size_t bytes; /* of an object */
};

static struct plan plan_of(const struct rb_fields *fields)
{
	struct plan plan;
	size_t end = SIZE_MAX;

	plan.count = 0;
	plan.bytes = 0;
	for (const struct rb_field *row = fields->row; row < fields->row + fields->count; row++) {
		if (row->kind == RB_FIELD_DERIVED)
			continue;
		if (row->offset != end) {
			RB_ASSERT(plan.count < RUNS_MAX);
			plan.run[plan.count++] = (struct run){row->offset, 0};
		}
		plan.run[plan.count - 1].size += row->size;
		plan.bytes += row->size;
		end = row->offset + row->size;
	}
	return plan;
}

size_t rb_fields_bytes(const struct rb_fields *fields)
{
	return plan_of(fields).bytes;
}

/* ---- ranges ---- */

_Static_assert(sizeof(int) == sizeof(int32_t) && sizeof(bool) == 1, "what is saved of them");

/*
 * Elements are read as bytes: what has been loaded into a bool or an enum may be no value of its
 * type.
 */
static bool is_good(const struct rb_field *row, int64_t high, const unsigned char *at)
{
	const unsigned char *const end = at + row->size;
	double number;
	int64_t large;
	int32_t small;

	switch (row->kind) {
	case RB_FIELD_DERIVED:
	case RB_FIELD_BITS:
	case RB_FIELD_NUMBER:
		return true;
	case RB_FIELD_FLAG:
		for (; at < end; at++)
			if (*at > 1)
				return false;
		return true;
	case RB_FIELD_INT:
		for (; at < end; at += sizeof small) {
			memcpy(&small, at, sizeof small);
			if (small < row->low || small > high)
				return false;
		}
		return true;
	case RB_FIELD_LONG:
		for (; at < end; at += sizeof large) {
			memcpy(&large, at, sizeof large);
			if (large < row->low || large > high)
				return false;
		}
		return true;
	case RB_FIELD_FINITE:
	case RB_FIELD_TIME:
		for (; at < end; at += sizeof number) {
			memcpy(&number, at, sizeof number);
			if (row->kind == RB_FIELD_FINITE ? !isfinite(number) : isnan(number))
				return false;
		}
		return true;
	}
	return false;
}

const struct rb_field *rb_fields_bad(const struct rb_fields *fields, const void *objects,
                                     size_t count, const int *limit, size_t *which)
{
	for (const struct rb_field *row = fields->row; row < fields->row + fields->count; row++) {
		const unsigned char *at = (const unsigned char *)objects + row->offset;
		const int64_t high = row->limit > 0 ? limit[row->limit] : row->high;

		for (size_t k = 0; row->kind != RB_FIELD_DERIVED && k < count;
		     k++, at += fields->size) {
			if (is_good(row, high, at))
				continue;
			if (which)
				*which = k;
			return row;
		}
	}
	return NULL;
}

static const char *why_bad(const struct rb_field *row)
{
	switch (row->kind) {
	case RB_FIELD_FLAG:
		return "neither true nor false";
	case RB_FIELD_FINITE:
		return "a number that is not finite";
	case RB_FIELD_TIME:
		return "not a number";
	default:
		return "a number out of its range";
	}
}

/* ---- to bytes and back ---- */

static void save(const struct rb_fields *fields, const struct plan *plan,
                 const unsigned char *object, size_t count, struct rb_pack *pack)
{
	unsigned char *to = rb_pack_room(pack, plan->bytes * count);

	if (!to)
		return;
	if (plan->bytes == fields->size) {
		memcpy(to, object, plan->bytes * count);
		return;
	}
	for (size_t k = 0; k < count; k++, object += fields->size)
		for (int r = 0; r < plan->count; r++) {
			memcpy(to, object + plan->run[r].offset, plan->run[r].size);
			to += plan->run[r].size;
		}
}

/* From NULL: zeros. */
static void load(const struct rb_fields *fields, const struct plan *plan, unsigned char *object,
                 size_t count, const unsigned char *from)
{
	for (size_t k = 0; k < count; k++, object += fields->size)
		for (int r = 0; r < plan->count; r++) {
			if (!from) {
				memset(object + plan->run[r].offset, 0, plan->run[r].size);
				continue;
			}
			memcpy(object + plan->run[r].offset, from, plan->run[r].size);
			from += plan->run[r].size;
		}
}

void rb_fields_pack(const struct rb_fields *fields, void *objects, size_t count, const int *limit,
                    struct rb_pack *pack)
{
	const struct plan plan = plan_of(fields);
	const struct rb_field *bad;

	if (count == 0)
		return;
	RB_ASSERT(count <= SIZE_MAX / fields->size);
	if (!pack->loading) {
		save(fields, &plan, objects, count, pack);
		return;
	}
	load(fields, &plan, objects, count, rb_pack_room(pack, plan.bytes * count));
	if (pack->failed)
		return;
	bad = rb_fields_bad(fields, objects, count, limit, NULL);
	if (!bad) {
		if (pack->loaded)
			pack->loaded(pack->loaded_user, fields, objects, count);
		return;
	}
	rb_pack_fail_at(pack, bad->name, why_bad(bad));
	load(fields, &plan, objects, count, NULL);
}

/* ---- bits ---- */

const struct rb_field *rb_fields_differ(const struct rb_fields *fields, const void *objects,
                                        const void *others, size_t count)
{
	const unsigned char *a = objects, *b = others;

	for (size_t k = 0; k < count; k++, a += fields->size, b += fields->size)
		for (int r = 0; r < fields->count; r++) {
			const struct rb_field *const row = &fields->row[r];

			if (row->kind != RB_FIELD_DERIVED &&
			    memcmp(a + row->offset, b + row->offset, row->size) != 0)
				return row;
		}
	return NULL;
}

uint64_t rb_fields_hash(const struct rb_fields *fields, const void *objects, size_t count,
                        uint64_t seed)
{
	const struct plan plan = plan_of(fields);
	const unsigned char *object = objects;

	for (size_t k = 0; k < count; k++, object += fields->size)
		for (int r = 0; r < plan.count; r++)
			seed = rb_hash_bytes(object + plan.run[r].offset, plan.run[r].size, seed);
	return seed;
}
