/* SPDX-License-Identifier: MIT */
/*
 * One contact point of two convex parts by the features that meet there: gap, normal, point and how they change, as smooth
 * functions of where the parts are. Closed forms, no search. Pure functions of values.
 *
 *   corner, end of a segment, rim  on a face, an end, a plane   the normal is the face's
 *   edge, mantle                   across an edge, a mantle     the normal is across both, or that of the face in which
 *                                                               they lie (rb_feature_in_face)
 *   round corner                   on an edge, mantle, rim, or another corner: the normal follows from one to the other
 *
 * Rims on edges, mantles and rims have none: Newton's method, from a place near them. Sharp corners on corners and edges
 * are not known here.
 */
#ifndef RB_EVENT_FEATURE_H
#define RB_EVENT_FEATURE_H

#include "geom/manifold.h"
#include "math/quat.h"

/* A part in motion; places from a point of reference, m; velocities in the world's frame. */
struct rb_feature_side {
	const rb_core *core;
	rb_vec3 at; /* of the core's origin */
	rb_mat3 turn;
	rb_vec3 velocity; /* m/s, of that origin */
	rb_vec3 spin;     /* rad/s */
};

struct rb_feature_point {
	double gap;                  /* m, between the surfaces */
	rb_vec3 normal, normal_rate; /* from a to b; 1/s */
	rb_vec3 point, point_rate; /* m, m/s, from the reference; of an edge on an edge, half way */
	double inside,
		inside_rate; /* m, m/s: how far from the end of the features; INFINITY, 0: they have none */
};

/* Of a manifold's key. False: no closed form, *out is not set. */
bool rb_feature_meet(struct rb_feature_point *out, const struct rb_feature_side *a,
                     const struct rb_feature_side *b, uint64_t key);

/*
 * The same of two rims, or a rim and an edge or mantle, which have no closed form: from a place near the point, seen from
 * the reference, by Newton's method; the rates by the implicit function. False: it is none of these, or does not settle.
 */
bool rb_feature_curves(struct rb_feature_point *out, const struct rb_feature_side *a,
                       const struct rb_feature_side *b, uint64_t key, rb_vec3 near);

/*
 * The key of a point of a manifold with normal `n`, with a mark where two edges cross within a face: whose, and which of
 * the two faces at its edge. `depth`: of the manifold, m.
 */
uint64_t rb_feature_in_face(const struct rb_feature_side *a, const struct rb_feature_side *b,
                            uint64_t key, rb_vec3 n, double depth);

/* Where a part will be in a moment, s, if it goes straight on. */
static inline struct rb_feature_side rb_feature_later(const struct rb_feature_side *side, double s)
{
	const rb_mat3 turn = rb_quat_to_mat3(
		rb_quat_unit(rb_quat_from_turn(rb_vec3_scale(s, side->spin))));
	struct rb_feature_side later = *side;

	later.at = rb_vec3_add_scaled(side->at, s, side->velocity);
	later.turn = rb_mat3_multiply(&turn, &side->turn);
	return later;
}

static inline rb_placed rb_feature_placed(const struct rb_feature_side *side)
{
	return (rb_placed){side->core, side->at, side->turn};
}

#endif
