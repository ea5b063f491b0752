/* SPDX-License-Identifier: MIT */
/*
 * The only malloc. Blocks are zeroed, counted, aligned to 64 bytes, and the k-th allocation can be
 * made to fail (tests). Thread-safe. Released with rb_memory_free only, which aborts where the
 * bytes behind the block were written to.
 */
#ifndef RB_BASE_MEMORY_H
#define RB_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

/*
 * `count * size` zeroed bytes, or NULL when memory is out or the product overflows. 0 bytes give a
 * block too.
 */
void *rb_memory_take(size_t count, size_t size);

/*
 * Grows `block` (may be NULL) from `old_count` to `new_count` elements; the new part is zeroed. On
 * failure NULL, and the old block is as it was.
 */
void *rb_memory_grow(void *block, size_t old_count, size_t new_count, size_t size);

/*
 * Doubles `*capacity` until it holds `needed`; false when memory is out. `*block` and `*capacity`
 * are then unchanged.
 */
_Bool rb_memory_reserve(void *block_address, size_t *capacity, size_t needed, size_t size);

void rb_memory_free(void *block);

/*
 * Of `block` (NULL is fine), what lies from byte `first` on is not needed as it is: the system may
 * take its pages, which come again when they are written to. What it holds is then not known.
 */
void rb_memory_discard(void *block, size_t first);

char *rb_memory_copy_text(const char *text);

struct rb_memory_counts {
	uint64_t taken, freed; /* blocks since the start of the process */
	uint64_t bytes_now, bytes_peak;
};
struct rb_memory_counts rb_memory_counts(void);

/*
 * The k-th allocation from now on fails (1: the next), and all after it; 0: none. Also read once
 * from the environment variable RBSIM_FAIL_ALLOCATION.
 */
void rb_memory_fail_at(uint64_t k);

#endif
