/* SPDX-License-Identifier: MIT */
/*
 * Work of impacts and contact forces, for the ledger. An impulse P between two points does exactly
 * the work P . u, where u is the mean of their relative velocities before and after it, regardless
 * of other simultaneous impulses: the kinetic energy is quadratic in the velocities and the
 * impulses are linear in them.
 */
#ifndef RB_LOCATED_WORK_H
#define RB_LOCATED_WORK_H

#include "located/modes.h"
#include "located/external_force.h"

/*
 * Enters an impact: `impulse` on b at the contact point, relative velocities of its points before
 * and after.
 */
void rb_work_impact(struct rb_located *l, const struct rb_contact_point *m, rb_vec3 impulse,
                    rb_vec3 before, rb_vec3 after);

/*
 * Enters what corrections have changed of the set's bodies, from poses `from` to `to` of equal
 * velocities: potential and kinetic energy, which impacts take, and angular momentum about the
 * origin, as by static bodies.
 */
void rb_work_moved(struct rb_located *l, const struct rb_pose *from, const struct rb_pose *to);

/*
 * Computes power and force by cause on a cluster at a moment of its piece, from its last
 * evaluation.
 */
void rb_work_rates(const struct rb_modes *w, const struct rb_external_parts *parts, double t,
                   struct rb_entries *rate);

#endif
