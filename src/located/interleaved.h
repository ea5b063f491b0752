/* SPDX-License-Identifier: MIT */
/*
 * Jams: bodies that collide with several others alternately, in interleaved series without closed
 * form, such as a ball between a wall, the floor and a neighbour.
 *
 * Each of these series may be infinite, and each impact of one restarts another: a pair's series
 * down to rounding (located/bounces) takes place for each impact of the next pair, and with three
 * such pairs there is no end. So a body counts impacts with a different partner than before, or
 * with several at once, within the time of a fall by its own size; in free flight it forgets them.
 * From `first_impacts` on, rebounds end that are higher than rounding, twice as high for each
 * `impacts_per_doubling` more, up to the drift allowed relative to the size; and contacts with
 * tangential velocities as slow stick: the bodies come to rest together.
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

/* Speed of rest after this many impacts, m/s; 0: rounding. */
double rb_interleaved_speed(const struct rb_located *l, const struct rb_contact_point *m,
                            double count);

#endif
