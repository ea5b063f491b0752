/* SPDX-License-Identifier: MIT */
/*
 * Each block lies between a head of 64 bytes (origin and size) and a fence of 8 bytes, which free
 * checks. The head makes the counts of bytes exact without malloc_usable_size, and the alignment of
 * 64 lets arrays of columns be read with aligned vector loads. realloc is not used: it cannot keep
 * that alignment, and a failing growth must leave the old block as it was.
 *
 * Large blocks are mappings of their own. What nobody has written to takes no memory, so capacity
 * to spare is free; a growing block moves its pages and is never there twice; and what is freed
 * goes back to the system at once. malloc would keep it, and would write zeroes to all of what it
 * hands out again.
 */
#include "base/memory.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/error.h"

enum { ALIGNMENT = 64 }; /* a cache line */

/*
 * Bytes behind each block by which free detects a write beyond the end. None under
 * AddressSanitizer, which detects it at the write if the block ends where the system's block ends.
 */
#if defined(__SANITIZE_ADDRESS__)
enum { FENCE = 0 };
#else
enum { FENCE = 8 };
#endif
static const unsigned char fence[8] = {0xb5, 0x1e, 0xa7, 0x5c, 0xf3, 0x6d, 0x92, 0xc9};

/*
 * Bytes from which on a block is a mapping; below, its last page would be too large a share of it.
 * None under sanitizers: posix_memalign gives a block of exact size, so that they see the first
 * byte beyond the end.
 */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const size_t mapped_bytes = SIZE_MAX;
#else
static const size_t mapped_bytes = (size_t)1 << 17;
#endif

/* Lies in the ALIGNMENT bytes before each block. */
struct head {
	void *origin; /* what the system gave */
	size_t size;  /* bytes asked for */
};
_Static_assert(sizeof(struct head) <= ALIGNMENT,
               "the head must not move the block off its alignment");

static atomic_uint_fast64_t taken, freed, bytes_now, bytes_peak;
static atomic_uint_fast64_t attempts, fail_from; /* fail_from 0: nothing fails */
static pthread_once_t environment_read = PTHREAD_ONCE_INIT;

static void read_environment(void)
{
	const char *text = getenv("RBSIM_FAIL_ALLOCATION");

	if (text)
		atomic_store(&fail_from, strtoull(text, NULL, 10));
}

void rb_memory_fail_at(uint64_t k)
{
	pthread_once(&environment_read, read_environment);
	atomic_store(&fail_from, k == 0 ? 0 : atomic_load(&attempts) + k);
}

/* Counts this attempt; true where rb_memory_fail_at asked for its failure. */
static bool must_fail(void)
{
	pthread_once(&environment_read, read_environment);
	const uint64_t attempt = atomic_fetch_add(&attempts, 1) + 1;
	const uint64_t from = atomic_load(&fail_from);
	return from != 0 && attempt >= from;
}

static struct head *head_of(void *block)
{
	return (struct head *)(void *)((unsigned char *)block - ALIGNMENT);
}

/* The peak is raised by compare-and-swap: another thread may have raised it meanwhile. */
static void count_taken(size_t size)
{
	const uint64_t now = atomic_fetch_add(&bytes_now, size) + size;
	uint64_t peak = atomic_load(&bytes_peak);

	while (now > peak && !atomic_compare_exchange_weak(&bytes_peak, &peak, now))
		;
	atomic_fetch_add(&taken, 1);
}

/* Bytes of the mapping of such a block; the kernel rounds them up to pages. */
static size_t mapping_of(size_t bytes)
{
	return ALIGNMENT + bytes + FENCE;
}

/* Writes head and fence of a new block, and counts it. */
static void *begin_block(unsigned char *block, void *origin, size_t bytes)
{
	RB_ASSERT_COSTLY((uintptr_t)block % ALIGNMENT == 0);
	memcpy(block + bytes, fence, FENCE);
	*head_of(block) = (struct head){.origin = origin, .size = bytes};
	count_taken(bytes);
	return block;
}

/* False: the product overflows, or no block can be so large. */
static bool bytes_of(size_t count, size_t size, size_t *bytes)
{
	return !__builtin_mul_overflow(count, size, bytes) && *bytes <= SIZE_MAX / 2;
}

void *rb_memory_take(size_t count, size_t size)
{
	size_t bytes;

	if (must_fail() || !bytes_of(count, size, &bytes))
		return NULL;

	void *origin = NULL;
	if (bytes >= mapped_bytes) {
		origin = mmap(NULL, mapping_of(bytes), PROT_READ | PROT_WRITE,
		              MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
		if (origin == MAP_FAILED)
			return NULL;
	} else {
		if (posix_memalign(&origin, ALIGNMENT, mapping_of(bytes)) != 0)
			return NULL;
		memset((unsigned char *)origin + ALIGNMENT, 0, bytes);
	}
	return begin_block((unsigned char *)origin + ALIGNMENT, origin, bytes);
}

/* Ends a block that lives on elsewhere, or goes. */
static struct head end_block(void *block)
{
	const struct head head = *head_of(block);

	RB_ASSERT(memcmp((unsigned char *)block + head.size, fence, FENCE) == 0);
	RB_ASSERT(head.origin && (unsigned char *)head.origin < (unsigned char *)block);
	atomic_fetch_sub(&bytes_now, head.size);
	atomic_fetch_add(&freed, 1);
	return head;
}

/* A mapping made larger, of which so many bytes are in use; NULL: it is as it was. */
static void *grow_mapping(unsigned char *block, size_t used, size_t bytes)
{
	const struct head head = *head_of(block);
	void *origin = mremap(head.origin, mapping_of(head.size), mapping_of(bytes),
	                      MREMAP_MAYMOVE);

	if (origin == MAP_FAILED)
		return NULL;
	block = (unsigned char *)origin + ALIGNMENT;
	head_of(block)->origin = origin;
	(void)end_block(block);
	memset(block + used, 0,
	       head.size + FENCE < bytes ? head.size + FENCE - used : bytes - used);
	return begin_block(block, origin, bytes);
}

void *rb_memory_grow(void *block, size_t old_count, size_t new_count, size_t size)
{
	size_t bytes;

	RB_ASSERT(block || old_count == 0);
	if (block && head_of(block)->size >= mapped_bytes && bytes_of(new_count, size, &bytes) &&
	    bytes >= head_of(block)->size)
		return must_fail() ? NULL : grow_mapping(block, old_count * size, bytes);

	unsigned char *grown = rb_memory_take(new_count, size);

	if (!grown)
		return NULL;
	if (block)
		memcpy(grown, block, (old_count < new_count ? old_count : new_count) * size);
	rb_memory_free(block);
	return grown;
}

_Bool rb_memory_reserve(void *block_address, size_t *capacity, size_t needed, size_t size)
{
	if (needed <= *capacity)
		return true;

	size_t wanted = *capacity ? *capacity : 8;
	while (wanted < needed) {
		if (wanted > SIZE_MAX / 2)
			return false;
		wanted *= 2;
	}
	/*
	 * The caller's pointer may be of any type: its bytes are moved, it is not read as a void
	 * pointer.
	 */
	void *block;
	memcpy(&block, block_address, sizeof block);
	void *grown = rb_memory_grow(block, *capacity, wanted, size);
	if (!grown)
		return false;
	memcpy(block_address, &grown, sizeof grown);
	*capacity = wanted;
	return true;
}

void rb_memory_free(void *block)
{
	if (!block)
		return;
	const struct head head = end_block(block);

	if (head.size >= mapped_bytes)
		munmap(head.origin, mapping_of(head.size));
	else
		free(head.origin);
}

void rb_memory_discard(void *block, size_t first)
{
	if (!block)
		return;
	const struct head head = *head_of(block);

	if (head.size < mapped_bytes || first >= head.size)
		return;
	/* whole pages, and not the last one, which has the fence */
	const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
	const uintptr_t from = ((uintptr_t)block + first + page - 1) / page * page;
	const uintptr_t to = ((uintptr_t)block + head.size) / page * page;

	if (to > from)
		(void)madvise((void *)from, to - from, MADV_DONTNEED);
}

char *rb_memory_copy_text(const char *text)
{
	const size_t size = strlen(text) + 1;
	char *copy = rb_memory_take(size, 1);

	if (copy)
		memcpy(copy, text, size);
	return copy;
}

struct rb_memory_counts rb_memory_counts(void)
{
	return (struct rb_memory_counts){
		.taken = atomic_load(&taken),
		.freed = atomic_load(&freed),
		.bytes_now = atomic_load(&bytes_now),
		.bytes_peak = atomic_load(&bytes_peak),
	};
}
