/* SPDX-License-Identifier: MIT */
/*
 * Mutual gravitation of many points, in a time proportional to their number: cells of points act
 * on each other by their moments (math/multipole) where they are far from each other for their
 * size, and points pair by pair elsewhere (W. Dehnen, J. Comput. Phys. 179 (2002) 27). Who acts on
 * whom is decided for both at once, and what two cells give each other is opposite: momentum is
 * kept to rounding, unlike by trees of cells that act on points (J. Barnes and P. Hut, Nature 324
 * (1986) 446). Angular momentum is kept as well as forces are exact.
 *
 * Every cell collects what acts on it, in the order of a list, so that the result does not depend
 * on the team. Cells are octants of a cube about all points.
 */
#ifndef RB_MATH_TREE_H
#define RB_MATH_TREE_H

#include <rbsim/error.h>

#include "base/team.h"
#include "math/attract.h"

struct rb_tree; /* scratch for one thread's calls; whoever creates it owns it */

RB_CHECKED enum rb_status rb_tree_create(struct rb_tree **tree, struct rb_error *err);
void rb_tree_destroy(struct rb_tree *tree); /* NULL is fine */

/*
 * Accelerations of all points, m/s^2, to result[0 .. 2], and potentials -phi, m^2/s^2, to
 * result[3]. Two cells act as wholes if they do not overlap and their sizes together are less than
 * `opening`, in (0, 1], of the distance of their centres; size: 3/2 of the root mean square of the
 * distances of a cell's points to its centre (a full cube of edge h: 0.75 h). With 0.5 the median
 * error of accelerations is below 1e-4 of them in a cube and in a Plummer sphere, 1.4e-4 in a cusp
 * of density 1/r^2, and more in steeper ones. `team` may be NULL. RB_ERR_MEMORY; after the first
 * calls nothing is allocated.
 */
RB_CHECKED enum rb_status rb_tree_attract(struct rb_tree *tree, const struct rb_attract *all,
                                          double opening, struct rb_team *team,
                                          double *const result[4], struct rb_error *err);

#endif
