/* SPDX-License-Identifier: MIT */
/*
 * Corrects the drift of lasting contacts by rounding and integration: closes gaps by moving bodies,
 * and stops normal velocities and the slip of sticking contacts.
 *
 * Spheres are corrected contact by contact. Bodies with several points per pair are moved and
 * rotated together, by the smallest motion in the metric of kinetic energy that corrects all points
 * at once: one by one, each correction would undo the others. Velocities change by impulses at the
 * contacts, which enter the ledger like any others. Overlaps of a crowd are another problem:
 * constraint/row.
 */
#ifndef RB_LOCATED_DRIFT_H
#define RB_LOCATED_DRIFT_H

#include "located/event_set.h"

/* All arrays are the caller's; poses are those of the bodies of the set, by l->place. */
struct rb_drift {
	struct rb_located *l;
	double t;
	struct rb_contact_point *contact_point; /* [count]: corrected ones are updated */
	const struct rb_held *before;           /* [count]; NULL: their slip is unknown */
	const bool *kept;                       /* [count]: these are corrected */
	int count;
	struct rb_pose *pose;
	bool is_trial; /* do not enter the ledger: it may be undone */
};

/* Drift of held contacts allowed by integration, relative to sizes and speeds. */
static const double rb_drift_correct = 1e-9;

void rb_drift(struct rb_drift *drift);
/*
 * For bodies with several points per pair: corrects positions only, or normal velocities only,
 * however large.
 */
void rb_drift_places(struct rb_drift *drift);
void rb_drift_stop(struct rb_drift *drift);

/* Updates a contact point to the present poses of the set's bodies. */
void rb_drift_point(const struct rb_located *l, const struct rb_pose *pose,
                    struct rb_contact_point *m);

#endif
