/* SPDX-License-Identifier: MIT */
/*
 * Convex parts that pass beside each other. Where bodies lie flush, what slides or rolls over them
 * meets the side of the next one in a line only: it is apart from that side, but as well from the
 * face that it goes on to. Of two directions in which parts are apart, that in which they stay so
 * decides.
 */
#ifndef RB_STEPPED_INTERNAL_EDGES_H
#define RB_STEPPED_INTERNAL_EDGES_H

#include "geom/manifold.h"
#include "math/quat.h"

/* Of a, as b sees it, within a step. */
struct rb_internal_edge_motion {
	rb_vec3 way;  /* m, of the origin of a's part */
	rb_quat turn; /* about that */
};

struct rb_internal_edge {
	struct rb_internal_edge_motion before,
		forced;   /* without the forces of the step, and with them */
	bool held;        /* what forces would do, contacts have prevented in the step before */
	double tolerance; /* m: two parts that overlap by no more touch */
};

/*
 * Whether points within a band, m, may be those of parts beside each other: they lie in a line, by
 * what the band may put aside. Else faces lie over each other along the normal.
 */
bool rb_internal_edge_may(const rb_manifold *manifold, double band, double tolerance);

/*
 * Whether some face is between a and b, now, other than one whose normal is theirs: else they are
 * not beside each other, whatever way they go.
 */
bool rb_internal_edge_has_face(const rb_placed *a, const rb_placed *b, rb_vec3 normal,
                               double tolerance);

/*
 * Whether such a manifold, of a and b along its normal, is none of this step: a face of one keeps
 * them apart, over which the other does not lie.
 */
bool rb_internal_edge(const struct rb_internal_edge *beside, const rb_placed *a, const rb_placed *b,
                      const rb_manifold *manifold);

#endif
