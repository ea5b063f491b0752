/* SPDX-License-Identifier: MIT */
/*
 * Which springs of a try are solved with the groups of their bodies (stepped/spring_rows), and how
 * far those miss. Forces give each spring that the step does not resolve its impulse as if its
 * bodies were free; that is right to rounding for two bodies and one spring. Springs that joints,
 * impacts or contacts hold, themselves or through other such springs, give theirs back and get
 * rows. Contacts hold what they push: whether a pair that does not meet is looked at follows from
 * boxes along the axes, and must not decide how a body moves.
 *
 * Springs that the step resolves get rows where joints alone hold them: such groups take impulses
 * in halves.
 *
 * Owned by the method's state (rb_solver's `spring`); simulator thread. Where the step resolves all
 * springs and there are no joints, all of it returns at once.
 */
#ifndef RB_STEPPED_SPRING_STEPS_H
#define RB_STEPPED_SPRING_STEPS_H

#include "stepped/stepped_state.h"

/* Forces, points and impacts of a try of h_s are known. */
RB_CHECKED enum rb_status rb_springs_join(struct rb_world *world, const struct rb_cohort *cohort,
                                          double h_s, struct rb_error *err);
/* It is solved: what springs that contacts push now join is solved again. */
RB_CHECKED enum rb_status rb_springs_join_pushed(struct rb_world *world, struct rb_cohort *cohort,
                                                 struct rb_error *err);

/* Where bodies stand at the end of a try: marks groups of springs that are not as foreseen; any. */
bool rb_springs_mark(struct rb_world *world, unsigned char *of_group);
/* What the springs of marked groups have missed is added to their bends. */
void rb_springs_bend(struct rb_world *world, const unsigned char *of_group);

/* Bodies have moved for the last time: what has been missed, of which the second is told. */
void rb_springs_measure(struct rb_world *world);
/* Blames bodies of springs that are off by more than the tolerance: ends have turned too far. */
void rb_springs_blame(struct rb_world *world);

/* Their impulses, for the ledger. */
void rb_springs_note(struct rb_world *world);

#endif
