/* SPDX-License-Identifier: MIT */
/*
 * Springs of an attempt that are solved with the groups of their bodies (stepped/spring_rows), and
 * their linearization errors. The pass of forces gives each spring that the step does not resolve
 * its impulse as if its bodies were free; that is exact for two bodies and one spring. Springs that
 * joints, impacts or contacts hold, directly or through other such springs, take it back and get
 * rows. A contact holds a body if it has an impulse: whether a pair that does not meet is inspected
 * follows from axis-aligned boxes, and must not decide how a body moves.
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

/* Selects springs, after forces, points and impacts of an attempt of h_s. */
RB_CHECKED enum rb_status rb_springs_join(struct rb_world *world, const struct rb_cohort *cohort,
                                          double h_s, struct rb_error *err);
/*
 * After the solution: adds springs at bodies with contact impulses, and solves their groups again.
 */
RB_CHECKED enum rb_status rb_springs_join_pushed(struct rb_world *world, struct rb_cohort *cohort,
                                                 struct rb_error *err);

/*
 * At the end of an attempt: marks groups of springs with linearization errors; returns whether
 * there are any.
 */
bool rb_springs_mark(struct rb_world *world, unsigned char *of_group);
/* Adds the linearization errors of springs of marked groups to their nonlinear parts. */
void rb_springs_bend(struct rb_world *world, const unsigned char *of_group);

/* After the last motion of bodies: measures linearization errors, which rb_springs_blame reads. */
void rb_springs_measure(struct rb_world *world);
/* Blames bodies of springs whose error exceeds the tolerance: their ends have rotated too far. */
void rb_springs_blame(struct rb_world *world);

/* Records impulses of springs with rows for the ledger. */
void rb_springs_record(struct rb_world *world);

#endif
