/* SPDX-License-Identifier: MIT */
/* Relative motion of two bodies in contact. Pure. */
#ifndef RB_LOCATED_CLOSING_H
#define RB_LOCATED_CLOSING_H

#include "located/convex_contact.h"

/*
 * Beyond rounding. Contacts that neither close nor separate rest, or begin to close by
 * acceleration.
 */
enum rb_closing { RB_CLOSING_PARTS, RB_CLOSING_RESTS, RB_CLOSING_BEGINS, RB_CLOSING_CLOSES };

/* The last of these that occurs among the points that touch. */
enum rb_closing rb_closing_of(const struct rb_located *l, const struct rb_touch_pair *pair);

#endif
