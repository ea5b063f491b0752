/* SPDX-License-Identifier: MIT */
/*
 * Local rollback: when a step has failed for some bodies, these go back and take shorter steps, the
 * others keep theirs.
 *
 * Each body has a box for the step that its origin should not leave (swept bounds): the bounding
 * box of its path in the attempt, or of its free path if the attempt failed for it, padded by an
 * eighth of its size. Bodies whose boxes overlap, or that a spring or joint connects, form a group;
 * groups cannot touch each other. A group with a failed body goes back as a whole. If a body leaves
 * its box, the box grows, groups are formed again, and those that have changed begin the step
 * again. The result of a group depends on nothing but the group.
 */
#ifndef RB_STEPPED_LOCAL_ROLLBACK_H
#define RB_STEPPED_LOCAL_ROLLBACK_H

#include <math.h>

#include "stepped/stepped_state.h"

/*
 * Completes a step after an attempt over the whole of dt_s that succeeded for some bodies
 * (rb_stepped's `bad`; reaches of `all.candidates` are the attempt's), with contacts, impulses and
 * counts; impacts are collected in rb_stepped's `reported`. After RB_ERR_PHYSICS the state is that
 * of the beginning.
 */
RB_CHECKED enum rb_status rb_local_rollback_step(struct rb_world *world, double start_s,
                                                 double dt_s,
                                                 const struct rb_attempt_outcome *outcome,
                                                 struct rb_error *err);
void rb_local_rollback_destroy(struct rb_local_rollback *local); /* NULL is fine */

/* After a step of all bodies: frees what none has needed for long. */
void rb_local_rollback_unused(struct rb_stepped *stepped);

/* Limit of halvings of a step: in a row, and below the whole step. */
enum { RB_HALVINGS_MAX = 24, RB_HALVINGS_IN_ALL = 32 };

/*
 * Whether a failed part of dt_s is not halved again, after `in_a_row` halvings in a row. The second
 * limit ends steps in which short parts succeed now and then but nothing longer.
 */
static inline bool rb_halvings_end(int in_a_row, double h_s, double dt_s)
{
	return in_a_row >= RB_HALVINGS_MAX || !(h_s > ldexp(dt_s, -RB_HALVINGS_IN_ALL));
}

/*
 * Length of the next part of dt_s, of which left_s remain, s. A remainder too short for an attempt
 * is merged: sums of parts are rounded, and quantities per time from such a remainder are noise.
 */
static inline double rb_next_part(double h_s, double left_s, double dt_s)
{
	return left_s - h_s > ldexp(dt_s, -RB_HALVINGS_IN_ALL) ? h_s : left_s;
}

#endif
