/* SPDX-License-Identifier: MIT */
/*
 * Two boxes: which of the fifteen directions that may part them does, in closed form. Pure.
 *
 * Normals of three faces of each, and those across an edge of both (Gottschalk, Lin, Manocha,
 * OBBTree, SIGGRAPH 1996). Where this is sure, the answer is the one that geom/facets comes to by
 * looking at all features; where it is not, it says so.
 */
#ifndef RB_GEOM_BOXES_H
#define RB_GEOM_BOXES_H

#include "geom/axis_test.h"

typedef struct {
	double turn[3][3], size[3][3]; /* axis k of a along axis l of b, and its magnitude */
	double from_a[3], from_b[3];   /* m: the way from a to b, along the axes of either */
	double half_a[3], half_b[3];   /* m */
	double face[6];                /* m: the gap that faces across the axes of a and b prove */
} rb_box_pair;

static inline bool rb_box_is(const rb_placed *p)
{
	return p->core->kind == RB_CORE_POLYTOPE && p->core->polytope->box;
}

/*
 * Vertices of a box no deeper than `depth` below its outermost along `local`, in its own axes, or
 * the whole of a face no deeper than `tilt`: 1, 2 in their order, or 3, 4 in that of the face. 0:
 * they are not all of one face.
 */
int rb_box_outermost(const struct rb_polytope *box, rb_vec3 local, double depth, double tilt,
                     int vertex[4], int *face);

/* Both are boxes. */
void rb_box_pair_set(rb_box_pair *pair, const rb_placed *a, const rb_placed *b);

/*
 * Sets normal and gap of `axis`, and as the second what other faces prove at most, where no other
 * direction could prove as much; false: some might to rounding, or none of the fifteen proves the
 * whole distance.
 */
bool rb_boxes_decide(rb_axis *axis, const rb_box_pair *pair);

/*
 * A gap, m, that some direction proves, if one above `limit` is found, else -INFINITY, which says
 * nothing. Tries `*normal`, unless it is zero; with `all`, or without a normal, also the fifteen,
 * of which the best one becomes `*normal`. Of `axis` the boxes and the noise are read.
 */
double rb_boxes_beyond(const rb_axis *axis, double limit, bool all, rb_vec3 *normal);

#endif
