/* SPDX-License-Identifier: MIT */
/*
 * Checks of the modes of a cluster's contacts on its piece: does one end, where does it first, is
 * another solution possible?
 */
#ifndef RB_LOCATED_MODE_CHECKS_H
#define RB_LOCATED_MODE_CHECKS_H

#include "located/modes.h"

/* Share of accelerations by which two solutions for the same motion differ. */
#define RB_CHECK_OTHERWISE 1e-10

/* Share of forces up to which the solver's residue may be taken for a mode that holds. */
#define RB_CHECK_DOUBTFUL 1e-8

/*
 * Where modes leave forces open, those that were found may be outside the cones while others are
 * within: are there forces by the law that move all bodies as the modes do? They are then the
 * forces.
 */
bool rb_check_holds_otherwise(struct rb_modes *w, double t);

/* Excess of a contact's force over what its mode allows, N; below zero: it is allowed. */
double rb_check_excess(const struct rb_modes *w, int k);

/*
 * Where in the piece a mode ends first, seconds from its beginning; the whole length where none
 * does. `value`: scratch.
 */
double rb_check_change_within(struct rb_modes *w, double *value);

/* Does a slip that was taken for straight turn aside within [0, s]? */
bool rb_check_turns_aside(struct rb_modes *w, double s, double *value);

/*
 * A slip that has just begun turns towards where it goes at a rate of friction over speed. That is
 * without bound at its beginning, where no step is short enough if other slips turn beside it: it
 * goes straight for as long as noise hides what it turns by. True: there are such slips, which do.
 */
bool rb_check_begins_straight(struct rb_modes *w);

/*
 * Do contacts pull, or stick with more than their friction, by more than the solver's residue,
 * whatever forces move all as slips that creep do? Or go some that creep against the way in which
 * forces across them balance?
 */
bool rb_check_creeping_breaks_laws(struct rb_modes *w);

/* The same of joints that come to a limit, and ropes that come taut: within `length` seconds. */
double rb_check_stops_within(struct rb_modes *w, double length, double *value);

/*
 * The same of motors and friction of joints, within `length` seconds: until one leaves its bounds,
 * or comes to its speed; and of stops that hold, until one would pull. Returns how long that is.
 */
double rb_check_drives_within(struct rb_modes *w, double length, double *value);

#endif
