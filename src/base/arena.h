/* SPDX-License-Identifier: MIT */
/*
 * Bump allocator for what lives as long as a step: take, mark, release to a mark. One thread each.
 * It grows by further blocks; rb_arena_reset joins them into one, so that after a few steps nothing
 * is allocated any more. Blocks are not zeroed.
 */
#ifndef RB_BASE_ARENA_H
#define RB_BASE_ARENA_H

#include <stddef.h>

struct rb_arena {
	unsigned char *block; /* owned */
	size_t size, used, high_water;
	struct rb_arena_overflow *overflow; /* owned: blocks taken since the last reset */
	_Bool failed;                       /* memory has been out since the last reset */
};

typedef struct {
	size_t used;
	struct rb_arena_overflow *overflow;
	size_t overflow_used;
} rb_arena_mark;

/* 64-byte aligned; NULL when memory is out. */
void *rb_arena_take(struct rb_arena *arena, size_t count, size_t size);
rb_arena_mark rb_arena_here(const struct rb_arena *arena);
void rb_arena_back(struct rb_arena *arena, rb_arena_mark mark);
void rb_arena_reset(struct rb_arena *arena);
void rb_arena_release(struct rb_arena *arena);

#endif
