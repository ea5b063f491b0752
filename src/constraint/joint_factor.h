/* SPDX-License-Identifier: MIT */
/*
 * Elimination of the bilateral joint rows of a problem of constraint/cone: rows that are FREE or
 * INTERVALs without bounds have the same unknowns whatever the contacts do, and their matrix
 * J M^-1 J^T is factored once. Long or closed linkages are so badly conditioned that conjugate
 * residuals do not converge; preconditioned by this inverse for the joints, and by nothing for the
 * other rows, they converge in about as many rounds as there are other rows. An elimination has an
 * order: by rounding, results depend on that of the rows.
 *
 * Rows that depend on earlier ones (closed plane linkages have many) are left out: the result is
 * the inverse for the others, symmetric and positive semidefinite, and valid for all motions of the
 * bodies.
 */
#ifndef RB_CONSTRAINT_JOINT_FACTOR_H
#define RB_CONSTRAINT_JOINT_FACTOR_H

#include "constraint/cone.h"

/* Number of unknowns of a row here: 3 for FREE, 1 for an INTERVAL without bounds, otherwise 0. */
int rb_joint_factor_width(const struct rb_cone_row *row);

/*
 * Factors the joints of an open cone, into its arena; once for each cone. False: that would take
 * more than `max` multiplications, memory is out, or there are no such rows.
 */
bool rb_joint_factor(struct rb_cone *cone, double max);

/*
 * Computes the steps of the joints' rows that cancel the residuals `r` (both in the units of
 * rb_cone's steps); for other rows copies r.
 */
void rb_joint_factor_solve(const struct rb_cone *cone, const rb_along_across *r,
                           rb_along_across *to);

#endif
