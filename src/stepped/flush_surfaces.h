/* SPDX-License-Identifier: MIT */
/*
 * Contact points of all pairs on surfaces that several parts make up (stepped/flush_points). The
 * points of a part that another one hides get the normal of the common face: what approaches such a
 * surface touches it as if it were of one piece.
 */
#ifndef RB_STEPPED_FLUSH_SURFACES_H
#define RB_STEPPED_FLUSH_SURFACES_H

#include "stepped/inspection.h"

/* For points from `first` on. `each`: as they were found, without a buffer. False: no memory. */
RB_CHECKED bool rb_flush_surfaces(struct rb_step_points *points, size_t first,
                                  const struct rb_inspection *each);

#endif
