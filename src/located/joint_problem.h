/* SPDX-License-Identifier: MIT */
/*
 * Rows of joints as those of a problem of constraint/simultaneous, and back.
 */
#ifndef RB_LOCATED_JOINT_PROBLEM_H
#define RB_LOCATED_JOINT_PROBLEM_H

#include "constraint/simultaneous.h"
#include "located/joint_rows.h"

/*
 * The rows as those of a problem in which bodies are by place: at most rows->count of them, and
 * ends that do not yield as copies of their own, with no velocity, from *bodies on, at most two for
 * each row. Biases are those of accelerations, or of velocities by ends that move on their own.
 * Returns their number.
 */
int rb_joint_rows_pose_problem(const struct rb_joint_rows *rows, bool forces,
                               struct rb_cone_row *to, struct rb_solver_body *body, int *bodies);

/* Multipliers (or impulses), [count], from solved rows of that problem. */
void rb_joint_rows_read_problem(const struct rb_joint_rows *rows, bool forces,
                                const struct rb_cone_row *from, double *multiplier);

/* Multipliers [rows->count] that are next to what the problem's rows will be found to need. */
void rb_joint_rows_guess(const struct rb_joint_rows *rows, bool forces, const double *multiplier,
                         struct rb_cone_row *to);

#endif
