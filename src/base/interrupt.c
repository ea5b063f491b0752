/* SPDX-License-Identifier: MIT */
/*
 * Each thread counts for itself: a common counter would be written for every pair of bodies. The
 * thread that began may wait for the others, so all of them ask.
 */
#include "base/interrupt.h"

/* Of this thread, since it asked last; whom it asks then does not matter. */
static _Thread_local uint64_t done;

void rb_interrupt_begin(struct rb_interrupt *interrupt, bool (*asked)(void *user), void *user)
{
	interrupt->asked = asked;
	interrupt->user = user;
	atomic_store(&interrupt->is_asking, false);
	atomic_store(&interrupt->is_set, false);
	done = 0;
}

bool rb_interrupt_after(struct rb_interrupt *interrupt, uint64_t work)
{
	if (!interrupt || !interrupt->asked)
		return false;
	if (rb_interrupt_is_set(interrupt))
		return true;
	done += work;
	if (done < RB_INTERRUPT_WORK)
		return false;
	done = 0;
	if (atomic_exchange(&interrupt->is_asking, true))
		return false; /* another thread does */
	if (interrupt->asked(interrupt->user))
		atomic_store(&interrupt->is_set, true);
	atomic_store(&interrupt->is_asking, false);
	return rb_interrupt_is_set(interrupt);
}
