/* SPDX-License-Identifier: MIT */
/*
 * As geom/patch and geom/patch_overlap have it, of two boxes: their outermost faces or edges as
 * few flat numbers, without a patch of any polytope. Pure.
 */
#ifndef RB_GEOM_BOX_OVERLAY_H
#define RB_GEOM_BOX_OVERLAY_H

#include "geom/patch_overlap.h"

/*
 * Points that both share, at most 12; patches of `depth` and with tilts as in rb_patch_of. -1: not
 * all of one face of each, edges along each other, or more points than that.
 */
int rb_box_overlay(const rb_placed *a, const rb_placed *b, double depth, const double tilt[2],
                   const rb_overlay_def *def, rb_overlay_point *out);

#endif
