/* SPDX-License-Identifier: MIT */
/*
 * Contacts with internal edges, which are suppressed. Where bodies lie flush, a part that slides or
 * rolls over them meets the side of the next one in a line only: it is separated from that side,
 * but also from the face onto which it moves. Of two separating directions, the one in which the
 * parts stay separated decides.
 */
#ifndef RB_STEPPED_INTERNAL_EDGES_H
#define RB_STEPPED_INTERNAL_EDGES_H

#include "geom/manifold.h"
#include "math/quat.h"

/* Motion of a in b's frame within a step. */
struct rb_internal_edge_motion {
	rb_vec3 displacement; /* m: displacement of the origin of a's part */
	rb_quat turn;         /* rotation about that */
};

struct rb_internal_edge {
	/* motion without the forces of the step, and with them */
	struct rb_internal_edge_motion before, forced;
	bool held;        /* contacts balanced the forces in the last step */
	double tolerance; /* m: parts with less overlap count as touching */
};

/*
 * Whether the points of a manifold, chosen within a band, m, may be at an internal edge: they lie
 * in a line, up to the band. Else faces overlap along the normal.
 */
bool rb_internal_edge_possible(const rb_manifold *manifold, double band, double tolerance);

/*
 * Whether the plane of some face separates a and b now, other than one with this normal: else no
 * edge is internal, whatever their motion.
 */
bool rb_internal_edge_has_face(const rb_placed *a, const rb_placed *b, rb_vec3 normal,
                               double tolerance);

/*
 * Whether a manifold of a and b is at an internal edge in this step: a face of one separates them,
 * and the other does not lie over that face.
 */
bool rb_internal_edge(const struct rb_internal_edge *beside, const rb_placed *a, const rb_placed *b,
                      const rb_manifold *manifold);

#endif
