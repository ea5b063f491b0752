/* SPDX-License-Identifier: MIT */
/*
 * Values to a block of bytes and back: one function for both ways, so that what is written and what is read can't
 * come apart.
 *
 *   struct rb_pack pack = {0};                          struct rb_pack pack = {.loading = true, .bytes = .., .size = ..};
 *   keep(&pack, &thing);   bytes = what `thing` is      keep(&pack, &thing);   `thing` = what the bytes say
 *
 * Saving, the block is owned and grows. Loading, it is borrowed and nobody vouches for it: what is out of its range,
 * and what would lie beyond the end, fails; the first failure sticks, and all that follows reads zeros. Numbers stand in
 * the machine's own order of bytes. One thread at a time.
 */
#ifndef RB_BASE_PACK_H
#define RB_BASE_PACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

struct rb_pack {
	bool loading;
	unsigned char *bytes; /* saving: owned */
	size_t size;          /* saving: so far; loading: in all */
	size_t capacity;      /* saving */
	size_t at;            /* loading */
	bool failed;
	bool no_memory;  /* ... for that reason */
	const char *why; /* ... else for this: static text */
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
/* Loading: fails unless it holds. Gives false once anything has failed. */
bool rb_pack_check(struct rb_pack *pack, bool holds, const char *why);

void rb_pack_bytes(struct rb_pack *pack, void *bytes, size_t size);
void rb_pack_u64(struct rb_pack *pack, uint64_t *value);
void rb_pack_u32(struct rb_pack *pack, uint32_t *value);
void rb_pack_i64(struct rb_pack *pack, int64_t *value);
void rb_pack_bool(struct rb_pack *pack, bool *value);
/* In [low, high]. */
void rb_pack_int(struct rb_pack *pack, int *value, int low, int high);
/* At most `most`, and no more than can stand in what is left at `each` bytes (0: no such limit). */
void rb_pack_count(struct rb_pack *pack, size_t *value, size_t most, size_t each);
/* Any. */
void rb_pack_doubles(struct rb_pack *pack, double *value, size_t count);
/* No NAN. */
void rb_pack_times(struct rb_pack *pack, double *value, size_t count);
/* Neither NAN nor infinite. */
void rb_pack_finite(struct rb_pack *pack, double *value, size_t count);

#endif
