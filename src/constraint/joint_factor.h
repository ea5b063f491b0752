/* SPDX-License-Identifier: MIT */
/*
 * What joints hold from both sides, of a problem of constraint/cone, eliminated: rows that are FREE
 * or INTERVALs without bounds have the same unknowns whatever contacts do, and their matrix
 * J M^-1 J^T is factored once. Long or closed linkages make it so badly conditioned that conjugate
 * residuals do not end; with its inverse for the joints and none for the other rows they end after
 * about as many rounds as there are others. An elimination has an order: what comes out then
 * depends on that of the rows by rounding.
 *
 * Rows that follow from those before them (closed plane linkages have many) are left out: the
 * inverse is one of the others, symmetric and never negative, and right for whatever bodies can do.
 */
#ifndef RB_CONSTRAINT_JOINT_FACTOR_H
#define RB_CONSTRAINT_JOINT_FACTOR_H

#include "constraint/cone.h"

/* How many unknowns a row has here: 3 of FREE, 1 of an INTERVAL without bounds, else none. */
int rb_joint_factor_width(const struct rb_cone_row *row);

/*
 * Factors, unless that would take more than `max` multiplications, or memory is out, or no row is
 * one of these: false. From the cone's arena; open cones only. Once for a cone.
 */
bool rb_joint_factor(struct rb_cone *cone, double max);

/*
 * The steps of the held rows that undo residuals `r` (both in the units of rb_cone's steps); those
 * of the other rows are r.
 */
void rb_joint_factor_solve(const struct rb_cone *cone, const rb_along_across *r,
                           rb_along_across *to);

#endif
