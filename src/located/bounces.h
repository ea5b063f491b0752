/* SPDX-License-Identifier: MIT */
/*
 * When an infinite series of bounces will be over, from all of its bounces.
 *
 * After a rebound at speed u under the acceleration a the flight takes T = 2 u / a, and the series
 * of a restitution e ends T / (1 - e) later. Said at a high bounce that is wrong by what a changes
 * by on the way; at a low one by what rounding moves the touch by, a few ulp of the size over u,
 * which doubles from bounce to bounce of e = 1/2. Under an attraction 1/r^2 from 1 m away the best
 * bounces are 1e-7 m high, where both are below 1e-11 s; the last one, of 8 ulp, misses by 1e-9 s.
 *
 * A flight that took (1 + q) T says how much a has changed; where it changes with the height, q
 * falls by e^2 from flight to flight, and the rest of them takes T q e^2 / (1 - e^3) more. Of
 * the estimates that later ones do not contradict the most exact one is kept, of spheres: one for
 * each body of lower index. A flight that something else has disturbed begins a new series.
 *
 * Simulator's thread.
 */
#ifndef RB_LOCATED_BOUNCES_H
#define RB_LOCATED_BOUNCES_H

#include "located/contact_point.h"
#include "located/located.h"

/* m/s^2: the acceleration that brings two separating bodies together again. */
double rb_bounces_closing(const struct rb_located *l, const struct rb_contact_point *m, double t);

/*
 * A rebound at t: at `rebound_m_s` under the acceleration `closing_m_s2`, both positive, with a
 * restitution between 0 and 1.
 */
void rb_bounces_note(struct rb_located *l, const struct rb_contact_point *m, double t,
                     double rebound_m_s, double closing_m_s2, double restitution);

/* s: from t, that of the bounce noted last, to the end of its series; 0 or more. */
double rb_bounces_left(const struct rb_located *l, const struct rb_contact_point *m, double t);

#endif
