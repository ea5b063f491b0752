/* SPDX-License-Identifier: MIT */
/*
 * What impacts and forces of contacts do, for the ledger. An impulse P between two points does the work P . u, where u is the
 * mean of their relative velocities before and after it, exactly, however many others act with it: the kinetic energy is
 * quadratic in the velocities and the impulses are linear in them.
 */
#ifndef RB_EVENT_WORK_H
#define RB_EVENT_WORK_H

#include "event/modes.h"
#include "event/pull.h"

/* An impact: `impulse` on b at the meeting, relative velocities of its points before and after. */
void rb_work_impact(struct rb_located *l, const struct rb_meet *m, rb_vec3 impulse, rb_vec3 before,
                    rb_vec3 after);

/*
 * Velocities of a body that became others at a contact without an impulse that is known: a series of impacts has come to
 * its end, or a slip. What it lost, `cause` has taken (RB_ENERGY_CAUSES: nobody says so). `partner`: the fixed body that
 * took or gave the momentum, -1: none.
 */
struct rb_work_change {
	int body, partner;
	enum rb_ledger_energy cause;
	rb_vec3 point;                 /* m: of the contact */
	rb_vec3 linear[2], angular[2]; /* m/s, rad/s: before and after */
};
void rb_work_change(struct rb_located *l, const struct rb_pose *pose,
                    const struct rb_work_change *change);

/* Power and force by cause of all that acts on a cluster at a moment of its piece, from its last evaluation. */
void rb_work_rates(const struct rb_modes *w, const struct rb_pull_parts *parts, double t,
                   struct rb_entries *rate);

#endif
