/* SPDX-License-Identifier: MIT */
/*
 * Values to a block of bytes and back: one function for both ways, so that what is written and what
 * is read can't come apart.
 *
 *   struct rb_pack pack = {0};
 *   keep(&pack, &thing);           the bytes become what `thing` is
 *
 *   struct rb_pack pack = {.loading = true, .bytes = .., .size = ..};
 *   keep(&pack, &thing);           `thing` becomes what the bytes say
 *
 * Saving, the block is owned and grows. Loading, it is borrowed and nobody vouches for it: what is
 * out of its range, and what would lie beyond the end, fails; the first failure sticks, and all
 * that follows reads zeros. Numbers stand in the machine's own order of bytes. One thread at a
 * time.
 */
#ifndef RB_BASE_PACK_H
#define RB_BASE_PACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <rbsim/error.h>

struct rb_fields;

struct rb_pack {
	bool loading;
	unsigned char *bytes; /* saving: owned */
	size_t size;          /* saving: so far; loading: in all */
	size_t capacity;      /* saving */
	size_t at;            /* loading */
	bool failed;
	bool no_memory;    /* ... for that reason */
	const char *why;   /* ... else for this: static text */
	const char *where; /* ... in this field; NULL: in none that has a name */
	/*
	 * loading, for tests: called with objects that have been loaded by a list of fields
	 * (base/field_list), which it may change; NULL: nobody
	 */
	void (*loaded)(void *user, const struct rb_fields *fields, void *objects, size_t count);
	void *loaded_user;
};

/* Saving: gives the block back. */
void rb_pack_release(struct rb_pack *pack);
/* Saving: from the beginning, into the same memory. */
void rb_pack_restart(struct rb_pack *pack);
/* The failure as an error of `what`; RB_OK without one. */
RB_CHECKED enum rb_status rb_pack_status(const struct rb_pack *pack, const char *what,
                                         struct rb_error *err);

/* Fails for a reason, unless one stands already. */
void rb_pack_fail(struct rb_pack *pack, const char *why);
/* The same of a field of that name, static text. */
void rb_pack_fail_at(struct rb_pack *pack, const char *where, const char *why);
/* Fails for want of memory. */
void rb_pack_fail_memory(struct rb_pack *pack);
/* Loading: fails unless it holds. Gives false once anything has failed. */
static inline bool rb_pack_check(struct rb_pack *pack, bool holds, const char *why)
{
	if (pack->loading && !holds)
		rb_pack_fail(pack, why);
	return !pack->failed;
}

/*
 * What follows stands here so that saving is a copy where there is room: millions of values make a
 * checkpoint.
 */
/*
 * Saving: room for so many bytes, to be filled before anything else is packed; loading: the next so
 * many bytes, which they are to be taken from. NULL: it has failed.
 */
unsigned char *rb_pack_room(struct rb_pack *pack, size_t size);

void rb_pack_bytes_slowly(struct rb_pack *pack, void *bytes, size_t size);
static inline void rb_pack_bytes(struct rb_pack *pack, void *bytes, size_t size)
{
	if (pack->loading || pack->failed || pack->capacity - pack->size < size) {
		rb_pack_bytes_slowly(pack, bytes, size);
	} else if (size > 0) {
		memcpy(pack->bytes + pack->size, bytes, size);
		pack->size += size;
	}
}

static inline void rb_pack_u64(struct rb_pack *pack, uint64_t *value)
{
	rb_pack_bytes(pack, value, sizeof *value);
}

static inline void rb_pack_u32(struct rb_pack *pack, uint32_t *value)
{
	rb_pack_bytes(pack, value, sizeof *value);
}

static inline void rb_pack_i64(struct rb_pack *pack, int64_t *value)
{
	rb_pack_bytes(pack, value, sizeof *value);
}

void rb_pack_load_bool(struct rb_pack *pack, bool *value);
static inline void rb_pack_bool(struct rb_pack *pack, bool *value)
{
	unsigned char byte = *value;

	if (pack->loading)
		rb_pack_load_bool(pack, value);
	else
		rb_pack_bytes(pack, &byte, 1);
}

void rb_pack_load_int(struct rb_pack *pack, int *value, int low, int high);
/* In [low, high]. */
static inline void rb_pack_int(struct rb_pack *pack, int *value, int low, int high)
{
	int32_t number = *value;

	if (pack->loading)
		rb_pack_load_int(pack, value, low, high);
	else
		rb_pack_bytes(pack, &number, sizeof number);
}

/* At most `most`, and no more than can stand in what is left at `each` bytes (0: no such limit). */
void rb_pack_count(struct rb_pack *pack, size_t *value, size_t most, size_t each);
/* Any. */
void rb_pack_load_doubles(struct rb_pack *pack, double *value, size_t count);
static inline void rb_pack_doubles(struct rb_pack *pack, double *value, size_t count)
{
	if (pack->loading)
		rb_pack_load_doubles(pack, value, count);
	else
		rb_pack_bytes(pack, value, count * sizeof *value);
}

/* No NAN. */
void rb_pack_load_times(struct rb_pack *pack, double *value, size_t count);
static inline void rb_pack_times(struct rb_pack *pack, double *value, size_t count)
{
	if (pack->loading)
		rb_pack_load_times(pack, value, count);
	else
		rb_pack_bytes(pack, value, count * sizeof *value);
}

/* Neither NAN nor infinite. */
void rb_pack_load_finite(struct rb_pack *pack, double *value, size_t count);
static inline void rb_pack_finite(struct rb_pack *pack, double *value, size_t count)
{
	if (pack->loading)
		rb_pack_load_finite(pack, value, count);
	else
		rb_pack_bytes(pack, value, count * sizeof *value);
}

#endif
