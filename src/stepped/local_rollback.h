/* SPDX-License-Identifier: MIT */
/*
 * A step that has failed for some bodies: these are taken back and go on in shorter steps, the
 * others keep theirs.
 *
 * Each body has a territory for the step: the box of the way that it would fly, or has flown if all
 * was well with it, and an eighth of its size to all sides. Bodies of which the territories meet,
 * or that a spring joins, are a group; groups cannot touch each other. A group in which something
 * has failed goes back as a whole. Should somebody leave the territory, it grows, groups are formed
 * anew, and those that have changed begin the step again. What becomes of a group depends on
 * nothing but the group.
 */
#ifndef RB_STEPPED_LOCAL_ROLLBACK_H
#define RB_STEPPED_LOCAL_ROLLBACK_H

#include <math.h>

#include "stepped/stepped_state.h"

/*
 * From a try over the whole of dt_s that was good for some (rb_stepped's `bad`; reaches of
 * `all.candidates` are the try's) to the end of the step, with contacts, impulses and counts;
 * impacts are told, not handed on. After RB_ERR_PHYSICS the state is that of the beginning.
 */
RB_CHECKED enum rb_status rb_local_rollback_step(struct rb_world *world, double start_s,
                                                 double dt_s,
                                                 const struct rb_attempt_outcome *outcome,
                                                 struct rb_error *err);
void rb_local_rollback_destroy(struct rb_local_rollback *local); /* NULL is fine */

/* Bytes that it takes for a body, and for a candidate pair, beside contacts. */
size_t rb_local_rollback_body_bytes(const struct rb_model *model);
size_t rb_local_rollback_pair_bytes(void);

/* Why no step is short enough. */
enum rb_status rb_local_rollback_give_up(const struct rb_world *world, double start_s,
                                         const struct rb_attempt_outcome *outcome,
                                         struct rb_error *err);

/* Halvings of a step before it is given up: in a row, and of the whole step. */
enum { RB_HALVINGS_MAX = 24, RB_HALVINGS_IN_ALL = 32 };

/*
 * Is a part of dt_s that has failed, after so many halvings in a row, not to be halved again? Parts
 * that hold now and then in between come to no end where nothing holds beyond a moment.
 */
static inline bool rb_halvings_end(int in_a_row, double h_s, double dt_s)
{
	return in_a_row >= RB_HALVINGS_MAX || !(h_s > ldexp(dt_s, -RB_HALVINGS_IN_ALL));
}

/*
 * s: the next part of dt_s, of which left_s are left. A rest too short to be tried is no part of
 * its own: sums of parts are rounded, and what is known per time from such a rest is noise.
 */
static inline double rb_next_part(double h_s, double left_s, double dt_s)
{
	return left_s - h_s > ldexp(dt_s, -RB_HALVINGS_IN_ALL) ? h_s : left_s;
}

#endif
