/* SPDX-License-Identifier: MIT */
/* How two bodies that touch move relative to each other. */
#ifndef RB_LOCATED_CLOSING_H
#define RB_LOCATED_CLOSING_H

#include "located/convex_contact.h"

/* Beyond rounding. What neither closes nor opens rests on each other or begins to close. */
enum rb_closing { RB_CLOSING_PARTS, RB_CLOSING_RESTS, RB_CLOSING_BEGINS, RB_CLOSING_CLOSES };

/* The most urgent of the points that touch. */
enum rb_closing rb_closing_of(const struct rb_located *l, const struct rb_touch_pair *pair);

#endif
