/* SPDX-License-Identifier: MIT */
/*
 * The shapes of bodies that have a volume: box, capsule, cylinder, hull { points }, body { shapes
 * }. What their keys say goes into the definition; where that is a mistake the shape becomes a
 * sphere, so that loading can go on.
 */
#ifndef RB_SCRIPT_SHAPES_H
#define RB_SCRIPT_SHAPES_H

#include "script/call.h"

/* After the rows of a box, a capsule or a cylinder were read: is all there? */
void rb_shapes_need(struct rb_call *call, struct rb_body_def *def);

/* Read `points`, `shapes`, and put the solid into the scene. */
void rb_shapes_hull(struct rb_call *call, struct rb_body_def *def);
void rb_shapes_union(struct rb_call *call, struct rb_body_def *def);

#endif
