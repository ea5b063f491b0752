/* SPDX-License-Identifier: MIT */
/*
 * A bump allocator in one block with a chain of overflow blocks. An overflow block is as large as
 * all blocks before it, hence their number grows with the logarithm of what a step takes, and the
 * reset replaces all of them by one block that holds the largest total seen. Growing in place was
 * rejected: pointers into the arena would move. A mark is the fill level of the newest block and of
 * the first.
 */
#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

/* A cache line, also enough for any vector register; four pages, below which malloc is cheap. */
enum { ALIGNMENT = 64, SMALLEST_BLOCK = 16384 };

/*
 * From so many bytes on, where base/memory maps blocks, there is room for twice what was needed:
 * only what is written to takes memory.
 */
enum { ROOMY = 1 << 17 };

/*
 * A block taken when the first was full; the newest stands first and is the only one that is
 * filled.
 */
struct rb_arena_overflow {
	struct rb_arena_overflow *older;
	unsigned char *block; /* owned */
	size_t size, used;
};

/* Bytes in use of all blocks; overflows are few, so the sum is not kept. */
static size_t total_used(const struct rb_arena *arena)
{
	size_t total = arena->used;

	for (const struct rb_arena_overflow *o = arena->overflow; o; o = o->older)
		total += o->used;
	return total;
}

/* Prepends a block with room for `bytes`; NULL when memory is out, and the arena is as it was. */
static struct rb_arena_overflow *add_overflow(struct rb_arena *arena, size_t bytes)
{
	/* As much again as there is, so that few blocks are taken until the next reset. */
	size_t size = arena->size;
	for (const struct rb_arena_overflow *o = arena->overflow; o; o = o->older)
		size += o->size;
	if (size < SMALLEST_BLOCK)
		size = SMALLEST_BLOCK;
	if (size < bytes)
		size = bytes;

	struct rb_arena_overflow *overflow = rb_memory_take(1, sizeof *overflow);
	unsigned char *block = rb_memory_take(size, 1);
	if (!overflow || !block) {
		rb_memory_free(overflow);
		rb_memory_free(block);
		return NULL;
	}
	/* what earlier parts of the step have left in the first block is not there beside it */
	if (!arena->overflow && arena->block)
		rb_memory_discard(arena->block, arena->used);
	*overflow = (struct rb_arena_overflow){
		.older = arena->overflow, .block = block, .size = size};
	arena->overflow = overflow;
	return overflow;
}

void *rb_arena_take(struct rb_arena *arena, size_t count, size_t size)
{
	size_t bytes;

	if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 4) {
		arena->failed = true;
		return NULL;
	}
	bytes = bytes ? (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT : ALIGNMENT;

	unsigned char *taken;
	if (!arena->overflow && bytes <= arena->size - arena->used) {
		taken = arena->block + arena->used;
		arena->used += bytes;
	} else {
		struct rb_arena_overflow *overflow = arena->overflow;
		if (!overflow || bytes > overflow->size - overflow->used)
			overflow = add_overflow(arena, bytes);
		if (!overflow) {
			arena->failed = true;
			return NULL;
		}
		taken = overflow->block + overflow->used;
		overflow->used += bytes;
	}
	RB_ASSERT_COSTLY((uintptr_t)taken % ALIGNMENT == 0);
	/* what was here may be what is wanted: whoever reads it unset is to get NaN, or -1 */
	if (RB_IS_CHECKED_BUILD)
		memset(taken, 0xff, bytes);
	RB_ASSERT_COSTLY(arena->used <= arena->size);
	const size_t total = total_used(arena);
	if (total > arena->high_water)
		arena->high_water = total;
	return taken;
}

rb_arena_mark rb_arena_here(const struct rb_arena *arena)
{
	return (rb_arena_mark){
		.used = arena->used,
		.overflow = arena->overflow,
		.overflow_used = arena->overflow ? arena->overflow->used : 0,
	};
}

/* Frees the newest overflow block, which there must be. */
static void drop_newest(struct rb_arena *arena)
{
	RB_ASSERT(arena->overflow && arena->overflow->used <= arena->overflow->size);

	struct rb_arena_overflow *overflow = arena->overflow;

	arena->overflow = overflow->older;
	rb_memory_free(overflow->block);
	rb_memory_free(overflow);
}

void rb_arena_back(struct rb_arena *arena, rb_arena_mark mark)
{
	while (arena->overflow != mark.overflow) {
		RB_ASSERT(arena->overflow); /* else the mark is older than the last reset */
		drop_newest(arena);
	}
	if (arena->overflow)
		arena->overflow->used = mark.overflow_used;
	RB_ASSERT(!arena->overflow || mark.overflow_used <= arena->overflow->size);
	RB_ASSERT(mark.used <= arena->used);
	arena->used = mark.used;
}

void rb_arena_reset(struct rb_arena *arena)
{
	while (arena->overflow)
		drop_newest(arena);
	arena->used = 0;
	arena->failed = false;
	if (arena->high_water <= arena->size)
		return;

	/*
	 * Somewhat more than was needed: the next steps resemble the last ones, but are not equal
	 * to them.
	 */
	const size_t more = arena->high_water < ROOMY ? arena->high_water / 4 : arena->high_water;
	const size_t wanted = (arena->high_water + more + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
	unsigned char *block = rb_memory_take(wanted, 1);
	if (!block)
		return; /* the smaller block still serves, with overflows */
	rb_memory_free(arena->block);
	arena->block = block;
	arena->size = wanted;
}

void rb_arena_release(struct rb_arena *arena)
{
	while (arena->overflow)
		drop_newest(arena);
	rb_memory_free(arena->block);
	*arena = (struct rb_arena){0};
}
