/* SPDX-License-Identifier: MIT */
/*
 * Whether work under way is to be given up.
 *
 * Loops that may take long tell what they have done, in multiplications or what takes as long; for
 * each RB_INTERRUPT_WORK of a thread `asked` is asked once. From then on all threads are told to
 * end, until the next rb_interrupt_begin: what such a loop has come to is of no use, and whoever
 * called it ends with RB_ERR_INTERRUPT. How often it is asked follows from the work, never from
 * time. One that is zeroed, or NULL, never is. Owned by whoever begins it, before other threads
 * work on it.
 */
#ifndef RB_BASE_INTERRUPT_H
#define RB_BASE_INTERRUPT_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rb_interrupt {
	/* set before others work */
	bool (*asked)(void *user); /* called by any thread, one at a time; NULL: nobody asks */
	void *user;

	/* by all */
	atomic_bool is_asking, is_set;
};

/* About a millisecond. */
enum { RB_INTERRUPT_WORK = 1 << 20 };

/* Nothing is interrupted yet, and nothing done. */
void rb_interrupt_begin(struct rb_interrupt *interrupt, bool (*asked)(void *user), void *user);

/* After so much work of this thread: is it to end? */
bool rb_interrupt_after(struct rb_interrupt *interrupt, uint64_t work);

static inline bool rb_interrupt_is_set(const struct rb_interrupt *interrupt)
{
	return interrupt && atomic_load_explicit(&interrupt->is_set, memory_order_relaxed);
}

#endif
