/* SPDX-License-Identifier: MIT */
/* Who is asked whether work is to be given up: counts how often, and says yes from a time on. */
#ifndef RB_TESTS_PATIENCE_H
#define RB_TESTS_PATIENCE_H

#include <stdbool.h>

struct patience {
	int calls, last; /* last 0: never */
};

/* `asked` of rb_interrupt and `stop` of rb_world_options. */
static inline bool count_calls(void *user)
{
	struct patience *const patience = user;

	patience->calls++;
	return patience->last > 0 && patience->calls >= patience->last;
}

#endif
