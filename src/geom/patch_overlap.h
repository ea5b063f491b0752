/* SPDX-License-Identifier: MIT */
/*
 * Where two patches lie over each other, seen along a normal: the corners of what they share. Pure;
 * no allocation. The order of the points follows from the features alone.
 */
#ifndef RB_GEOM_PATCH_OVERLAP_H
#define RB_GEOM_PATCH_OVERLAP_H

#include "geom/patch.h"

typedef struct {
	rb_vec3 on_a, on_b; /* m, over each other along the normal up to `aside` */
	double gap;         /* m, along the normal */
	rb_part a, b;
} rb_overlay_point;

enum { RB_OVERLAY_MAX = 4 * RB_PATCH_MAX };

/*
 * `n`: unit, from a to b. Points that lie apart by no more than `aside` across n count as over each
 * other, and of two segments points by no more than `along`, the way by which parallel curved
 * bodies may be off (m). None: they share no point. Corners that are past the other's border by
 * more than `past` (m) do not count beside points that the patches share.
 */
typedef struct {
	rb_vec3 n;
	double aside, along, past;
} rb_overlay_def;

int rb_overlay(const rb_patch *a, const rb_patch *b, const rb_overlay_def *def,
               rb_overlay_point out[RB_OVERLAY_MAX]);

/*
 * How deep a point lies within a polygon, a disc or a plane, seen along `n`, unit: the way to the
 * border, m; negative: outside by no less than that; -INFINITY of points and segments.
 */
double rb_overlay_margin(const rb_patch *patch, rb_vec3 point, rb_vec3 n);

#endif
