/* SPDX-License-Identifier: MIT */
/*
 * One contact point of two convex parts by the features that meet there: gap, normal, point and how
 * they change, as smooth functions of where the parts are. Closed forms, no search. Pure functions
 * of values.
 *
 *   corner, end of a segment, rim  on a face, an end, a plane   the normal is the face's
 *   edge, mantle  across an edge, a mantle     the normal is across both, or that
 *                                  of the face in which
 *                                                               they lie (rb_feature_name)
 *   round corner  on an edge, mantle, rim, or another corner: the normal follows
 *                                  from one to the other
 *
 * Rims on edges, mantles and rims have none: Newton's method, from a place near them. Sharp corners
 * on corners and edges are not known here.
 */
#ifndef RB_LOCATED_FEATURE_H
#define RB_LOCATED_FEATURE_H

#include "constraint/contact_name.h"
#include "located/feature_side.h"
#include "geom/manifold.h"

/* Of a manifold's key. False: no closed form, *out is not set. */
bool rb_feature_contact(struct rb_feature_point *out, const struct rb_feature_side *a,
                        const struct rb_feature_side *b, uint64_t key);

/*
 * The way to the point of a rim that lies lowest over a surface, across its axis, in its core's
 * axes; of one that lies flat within rounding, to that which will. False: the key names no such
 * point. A rim that comes to lie flat, and goes on, has its lowest point on the other side at once;
 * with this as the side's `half`, the point stays where it was, and what has come to be below it is
 * another one.
 */
bool rb_feature_half(const struct rb_feature_side *a, const struct rb_feature_side *b, uint64_t key,
                     rb_vec3 *half);

/*
 * Of one of a flat rim's quarters that lie on a surface, how it lands: which point of the rim is
 * first. If it turns by more than `least`, m/s between opposite points, that which closes fastest;
 * else, if it closes and slips by more than that, that which slips ahead of the others, about which
 * friction turns it; else, if it closes, that nearest to `middle`, the centre of mass, which takes
 * the load first. False: it does none of these, and all quarters are alike.
 */
struct rb_feature_fall {
	uint64_t key;
	double least;   /* m/s */
	rb_vec3 middle; /* m, as the sides are: of the mass of both, as far as they yield */
};
struct rb_feature_rim {
	rb_vec3 way; /* to that point, as in rb_feature_half */
	bool turns;
};
bool rb_feature_landing(const struct rb_feature_side *a, const struct rb_feature_side *b,
                        const struct rb_feature_fall *fall, struct rb_feature_rim *out);
/*
 * The key of that point, or of one a quarter turn on, where the side's `half` is the way; of those
 * across, where it is -way.
 */
uint64_t rb_feature_of_rim(const struct rb_feature_rim *rim, uint64_t quarter, bool aside);

/* Of one of a flat rim's quarters that lie on a surface: the rim. False: it is none. */
bool rb_feature_is_quarter(uint64_t key);
bool rb_feature_flat_rim(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         uint64_t key, struct rb_feature_flat_rim *out);

/*
 * The features that take over where those of the key end next, as a manifold's key; 0: to be
 * searched for.
 */
uint64_t rb_feature_beyond(const struct rb_feature_side *a, const struct rb_feature_side *b,
                           uint64_t key, const struct rb_feature_point *p);

/*
 * The same of two rims, or a rim and an edge or mantle, which have no closed form: from a place
 * near the point, seen from the reference, by Newton's method; the rates by the implicit function.
 * False: it is none of these, or does not converge.
 */
bool rb_feature_curves(struct rb_feature_point *out, const struct rb_feature_side *a,
                       const struct rb_feature_side *b, uint64_t key, rb_vec3 near);

/*
 * The key of a point of a manifold of these two, of that `depth`, m, made such that features alone
 * say where it is: with a mark where two edges cross within a face: whose, and which of the two
 * faces at its edge; and of a rim and an edge or mantle, which meet twice, which of the two it is.
 */
uint64_t rb_feature_name(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         const rb_manifold *manifold, int point, double depth);

#endif
