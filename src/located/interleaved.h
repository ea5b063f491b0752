/* SPDX-License-Identifier: MIT */
/*
 * Jams: bodies that hit one and another in turn, in series that have no formula, as a ball does
 * between a wall, the floor and a neighbour.
 *
 * Each of these series may be infinite, and each impact of one begins another anew: what one pair
 * does to rounding (located/bounces) takes as many impacts for each of the next one, and three such
 * pairs do not come to an end. So impacts count, of a body that meets another one than before or
 * several at once, within the time in which it falls by its own size; a body that flies on forgets
 * them. From FROM of them on, rebounds end that are higher than rounding, twice as high after each
 * DOUBLES more, up to the share of the size that drift may have; and what is as slow along contacts
 * sticks: they stand still together.
 *
 * Simulator's thread.
 */
#ifndef RB_LOCATED_INTERLEAVED_H
#define RB_LOCATED_INTERLEAVED_H

#include "located/contact_point.h"
#include "located/located.h"

/*
 * Counts an impact at t for both bodies, with others at that moment or without; returns the larger
 * of their counts.
 */
double rb_interleaved_note(struct rb_located *l, const struct rb_contact_point *m, double t,
                           bool others);

/* m/s: what is no faster is at rest after so many impacts; 0: nothing but rounding is. */
double rb_interleaved_speed(const struct rb_located *l, const struct rb_contact_point *m,
                            double met);

#endif
