/* SPDX-License-Identifier: MIT */
/*
 * Lists of the fields of a struct: what of it decides the future, in one line a field.
 *
 *   #define RB_THING_FIELDS(X)                                                        \
 *           X(int, a, , "", "index of a body", RB_UP_TO(RB_LIMIT_BODY))               \
 *           X(double, way, [3], "m", "how far it has come", RB_FINITE)                \
 *           X(double *, room, , "", "of the step under way", RB_DERIVED)
 *   struct rb_thing {
 *           RB_THING_FIELDS(RB_FIELD_MEMBER)
 *   };
 *   RB_FIELDS_DECLARE(rb_thing_fields);                                  in the header
 *   RB_FIELDS_DEFINE(rb_thing_fields, struct rb_thing, RB_THING_FIELDS); in the source
 *
 * X(type, name, [dimensions], unit, what, range). The struct's members come from the list, so there
 * is none that the list has not; and each states a range, so what is not saved says why. What is
 * loaded is hostile: each field is checked to be in its range. Ranges that depend on the model name
 * a limit, whose value the caller passes in.
 *
 * Objects are saved as runs of neighbouring fields, without padding: members that are packed should
 * stand together, by falling size. Constant; any thread.
 */
#ifndef RB_BASE_FIELD_LIST_H
#define RB_BASE_FIELD_LIST_H

#include <limits.h>
#include <stddef.h>
#include <stdint.h>

#include "base/pack.h"

enum rb_field_kind {
	RB_FIELD_DERIVED, /* not packed */
	RB_FIELD_FLAG,    /* bool */
	RB_FIELD_INT,     /* int, enum: low .. high, or .. the limit */
	RB_FIELD_LONG,    /* int64_t: low .. high */
	RB_FIELD_BITS,    /* integers of any value */
	RB_FIELD_FINITE,  /* double, and what consists of doubles: neither NAN nor infinite */
	RB_FIELD_TIME,    /* the same: no NAN; INFINITY: never */
	RB_FIELD_NUMBER   /* the same: any */
};

struct rb_field {
	const char *name;
	size_t offset, size; /* bytes, of all its elements */
	enum rb_field_kind kind;
	int64_t low, high;
	int limit; /* > 0: instead of `high` the caller's value of that name */
};

struct rb_fields {
	size_t size; /* of the struct */
	const struct rb_field *row;
	int count;
};

/* ---- ranges ---- */

/* Follows from the rest, or is scratch. */
#define RB_DERIVED RB_FIELD_DERIVED, 0, 0, 0
/* Saved by hand beside the list: it has a length of its own, or another owner. */
#define RB_BY_HAND RB_FIELD_DERIVED, 0, 0, 0
#define RB_FLAG RB_FIELD_FLAG, 0, 1, 0
#define RB_WITHIN(low, high) RB_FIELD_INT, low, high, 0
#define RB_UP_TO(limit) RB_FIELD_INT, 0, 0, limit
#define RB_NONE_UP_TO(limit) RB_FIELD_INT, -1, 0, limit
#define RB_LONG_WITHIN(low, high) RB_FIELD_LONG, low, high, 0
#define RB_ANY_BITS RB_FIELD_BITS, 0, 0, 0
#define RB_FINITE RB_FIELD_FINITE, 0, 0, 0
#define RB_TIME RB_FIELD_TIME, 0, 0, 0
#define RB_NUMBER RB_FIELD_NUMBER, 0, 0, 0

/* ---- lists ---- */

#define RB_FIELD_MEMBER(type, name, dimensions, ...) type name dimensions;
#define RB_FIELD_ROW(type, name, dimensions, unit, what, ...) \
	{#name, offsetof(rb_owner, name), sizeof(((rb_owner *)NULL)->name), __VA_ARGS__},

#define RB_FIELDS_DECLARE(list) const struct rb_fields *list(void)
/* Of some members of a struct, which has others that are no state. */
#define RB_FIELDS_DEFINE_PART(list, owner, FIELDS)                                           \
	const struct rb_fields *list(void)                                                   \
	{                                                                                    \
		typedef owner rb_owner;                                                      \
		static const struct rb_field row[] = {FIELDS(RB_FIELD_ROW)};                 \
		static const struct rb_fields fields = {sizeof(rb_owner), row,               \
		                                        sizeof row / sizeof *row};           \
		return &fields;                                                              \
	}                                                                                    \
	_Static_assert(sizeof(owner) >= sizeof(struct {FIELDS(RB_FIELD_MEMBER)}), "no such " \
	                                                                          "members")
/* Of all members: a struct that does not take them from the list must have no others. */
#define RB_FIELDS_DEFINE(list, owner, FIELDS)                                     \
	RB_FIELDS_DEFINE_PART(list, owner, FIELDS);                               \
	_Static_assert(sizeof(owner) == sizeof(struct {FIELDS(RB_FIELD_MEMBER)}), \
	               "a member that the list of fields has not")

/* ---- objects ---- */

/* Bytes that an object takes among those saved. */
size_t rb_fields_bytes(const struct rb_fields *fields);

/*
 * `count` objects, one after the other, to bytes and back; `limit`: highest values, by name of the
 * limit (NULL: no field has one). Members that are not packed stay as they are.
 */
void rb_fields_pack(const struct rb_fields *fields, void *objects, size_t count, const int *limit,
                    struct rb_pack *pack);

/*
 * The first field that is out of its range in one of the objects, NULL: none; `which`, or NULL:
 * the object.
 */
const struct rb_field *rb_fields_bad(const struct rb_fields *fields, const void *objects,
                                     size_t count, const int *limit, size_t *which);

/* The first field in whose bits objects differ, NULL: none. */
const struct rb_field *rb_fields_differ(const struct rb_fields *fields, const void *objects,
                                        const void *others, size_t count);

/* Of all bits that would be saved. */
uint64_t rb_fields_hash(const struct rb_fields *fields, const void *objects, size_t count,
                        uint64_t seed);

#endif
