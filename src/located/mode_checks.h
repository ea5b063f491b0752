/* SPDX-License-Identifier: MIT */
/*
 * Checks of the modes of a cluster's contacts on its piece: does a mode end, when does the first
 * one end, is another solution possible?
 */
#ifndef RB_LOCATED_MODE_CHECKS_H
#define RB_LOCATED_MODE_CHECKS_H

#include "located/modes.h"

/* Excess relative to forces that may be the solver's residual, with the mode still holding. */
#define RB_CHECK_DOUBTFUL 1e-8

/* Excess of a contact's force over the limit of its mode, N; below zero: it is within. */
double rb_check_excess(const struct rb_modes *w, int k);

/*
 * Returns the time at which the first mode ends, s from the beginning of the piece; its whole
 * length if none does. `value`: scratch.
 */
double rb_check_change_within(struct rb_modes *w, double *value);

/* Does a slip that was assumed straight turn within [0, s]? */
bool rb_check_turns_aside(struct rb_modes *w, double s, double *value);

/*
 * A slip that has just begun turns towards its direction at a rate of friction over speed. That is
 * unbounded at its beginning, where no step is short enough if other slips turn, too: such a slip
 * is taken as straight while its turning is below noise. True: there are such slips, now straight.
 */
bool rb_check_begins_straight(struct rb_modes *w);

/*
 * Do contacts pull, or stick with more than their friction, by more than the solver's residual, for
 * all forces with the same motion of the bodies as that of the creeping slips? Or does a creeping
 * contact move opposite to the direction in which tangential forces balance?
 */
bool rb_check_creeping_breaks_laws(struct rb_modes *w);

/* Returns the time at which a joint reaches a limit or a rope becomes taut, at most `length` s. */
double rb_check_stops_within(struct rb_modes *w, double length, double *value);

/*
 * Returns the time, at most `length` s, at which a motor or friction of a joint leaves its bounds
 * or reaches its speed, or a stop that holds would pull.
 */
double rb_check_drives_within(struct rb_modes *w, double length, double *value);

#endif
