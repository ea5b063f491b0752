/* SPDX-License-Identifier: MIT */
/*
 * Shapes of bodies that have a volume, from the keys of their types' rows (shape/), and what a row
 * cannot say: hull { points }, body { shapes }. Where a key is a mistake the shape becomes a
 * sphere, so that loading can go on.
 */
#ifndef RB_SCRIPT_SHAPES_H
#define RB_SCRIPT_SHAPES_H

#include "script/call.h"

/* After its keys were read: is all there? Puts the solid of a hull, or what makes one, into the
 * scene. */
void rb_shapes_sized(struct rb_call *call, struct rb_body_def *def);
/* Reads `shapes`, and puts the solid into the scene. */
void rb_shapes_union(struct rb_call *call, struct rb_body_def *def);

#endif
