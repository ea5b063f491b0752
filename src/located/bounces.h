/* SPDX-License-Identifier: MIT */
/*
 * The time at which an infinite series of bounces ends, estimated from all of its bounces.
 *
 * After a rebound at speed u under the acceleration a the flight takes T = 2 u / a, and a series
 * with restitution e ends T / (1 - e) later. At a high bounce this estimate has an error due to
 * changes of a along the flight; at a low one, due to the rounding of the time of touch, a few ulp
 * of the size over u, which doubles from bounce to bounce for e = 1/2. Under an attraction 1/r^2
 * from 1 m away the best bounces are 1e-7 m high, where both errors are below 1e-11 s; that of the
 * last bounce, of 8 ulp, is 1e-9 s.
 *
 * A flight that took (1 + q) T measures the change of a; if a depends on the height, q falls by e^2
 * from flight to flight, and the remaining flights take T q e^2 / (1 - e^3) longer. The most
 * accurate estimate that later ones do not contradict is kept, for spheres: one for each body of
 * lower index. A flight disturbed by another event begins a new series.
 *
 * Simulator's thread.
 */
#ifndef RB_LOCATED_BOUNCES_H
#define RB_LOCATED_BOUNCES_H

#include "located/contact_point.h"
#include "located/located.h"

/* Acceleration that brings two separating bodies together again, m/s^2. */
double rb_bounces_closing(const struct rb_located *l, const struct rb_contact_point *m, double t);

/*
 * Notes a rebound at t with the speed `rebound_m_s` under the acceleration `closing_m_s2`, both
 * positive, and a restitution between 0 and 1.
 */
void rb_bounces_note(struct rb_located *l, const struct rb_contact_point *m, double t,
                     double rebound_m_s, double closing_m_s2, double restitution);

/* Time from t, that of the bounce noted last, to the end of its series, s; >= 0. */
double rb_bounces_left(const struct rb_located *l, const struct rb_contact_point *m, double t);

#endif
