/* SPDX-License-Identifier: MIT */
/* Conversion of joint rows to rows of a problem of constraint/simultaneous, and back. */
#ifndef RB_LOCATED_JOINT_PROBLEM_H
#define RB_LOCATED_JOINT_PROBLEM_H

#include "constraint/simultaneous.h"
#include "located/joint_rows.h"

/*
 * Converts the rows to those of a problem whose bodies are by place: at most rows->count rows. Ends
 * that are not dynamic are separate copies without velocity, from *bodies on, at most two for each
 * row. Biases are accelerations, or velocities due to ends that move on their own. Returns the
 * number of rows.
 */
int rb_joint_rows_pose_problem(const struct rb_joint_rows *rows, bool forces,
                               struct rb_cone_row *to, struct rb_solver_body *body, int *bodies);

/* Reads multipliers (or impulses), [count], from solved rows of that problem. */
void rb_joint_rows_read_problem(const struct rb_joint_rows *rows, bool forces,
                                const struct rb_cone_row *from, double *multiplier);

/* Sets guesses of the problem's rows from multipliers [rows->count]. */
void rb_joint_rows_guess(const struct rb_joint_rows *rows, bool forces, const double *multiplier,
                         struct rb_cone_row *to);

#endif
