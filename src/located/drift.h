/* SPDX-License-Identifier: MIT */
/*
 * What rounding and integration have let drift in lasting contacts, put right: gaps closed by
 * moving, normal velocities, and the slip of what does not slip, stopped.
 *
 * Spheres are moved one contact after the other. Bodies with several points a pair are moved and
 * turned together, by the smallest motion in the metric of kinetic energy that serves all points at
 * once: one by one each would undo the others. Velocities change by impulses at the contacts, which
 * the ledger is told like any others. Overlaps of a crowd are another problem: constraint/row.
 */
#ifndef RB_LOCATED_DRIFT_H
#define RB_LOCATED_DRIFT_H

#include "located/event_set.h"

/* All arrays are the caller's; poses are those of the bodies of the set, by l->place. */
struct rb_drift {
	struct rb_located *l;
	double t;
	struct rb_contact_point
		*contact_point;       /* [count]: those that are put right are found anew */
	const struct rb_held *before; /* [count]; NULL: nothing is known of their slip */
	const bool *kept;             /* [count]: these are put right */
	int count;
	struct rb_pose *pose;
	bool tries; /* the ledger is not told: it may be undone */
};

/* Share of sizes and speeds by which integration may have let a held contact drift. */
static const double rb_drift_correct = 1e-9;

void rb_drift(struct rb_drift *drift);
/*
 * Of bodies with several points a pair only: places alone, and normal velocities alone, whatever
 * they are.
 */
void rb_drift_places(struct rb_drift *drift);
void rb_drift_stop(struct rb_drift *drift);

/* A contact point with the poses that bodies of the set have been given since. */
void rb_drift_point(const struct rb_located *l, const struct rb_pose *pose,
                    struct rb_contact_point *m);

#endif
