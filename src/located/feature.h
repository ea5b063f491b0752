/* SPDX-License-Identifier: MIT */
/*
 * One contact point of two convex parts by the features that touch there: gap, normal, point and
 * their rates, as smooth functions of the parts' poses. Closed forms, no search. Pure functions of
 * values.
 *
 *   corner, end of a segment, rim        the normal is that of the surface
 *     on a face, end or plane
 *   edge or mantle across                the normal is perpendicular to both, or that of the face
 *     an edge or mantle                  in which they lie (rb_feature_name)
 *   round corner on an edge, mantle,     the normal points from one to the other
 *     rim or another corner
 *
 * Rims on edges, mantles and rims have no closed form: Newton's method from a nearby point. Sharp
 * corners on corners and edges are not supported here.
 */
#ifndef RB_LOCATED_FEATURE_H
#define RB_LOCATED_FEATURE_H

#include "constraint/contact_name.h"
#include "located/feature_side.h"
#include "geom/manifold.h"

/* The contact point named by a manifold's key. False: no closed form, *out is not set. */
bool rb_feature_contact(struct rb_feature_point *out, const struct rb_feature_side *a,
                        const struct rb_feature_side *b, uint64_t key);

/*
 * The direction to the lowest point of a rim over a surface, perpendicular to the rim's axis, in
 * its core's axes; for a rim that is flat within rounding, to the point that will be lowest. False:
 * the key names no such point. When a rim passes through the flat position, its lowest point jumps
 * to the opposite side; with this as the side's `half` the point stays on its half, and the new
 * lowest point is another contact.
 */
bool rb_feature_half(const struct rb_feature_side *a, const struct rb_feature_side *b, uint64_t key,
                     rb_vec3 *half);

/*
 * How a flat rim lands: the first contact point of the rim of a quarter that lies on a surface. If
 * the rim turns faster than `least` (m/s between opposite points), the point that closes fastest;
 * else, if it closes and slips faster than that, the foremost point in the direction of slip, about
 * which friction turns it; else, if it closes, the point nearest to `middle`, which takes the load
 * first. False: none of these, all quarters are alike.
 */
struct rb_feature_fall {
	uint64_t key;
	double least;   /* m/s */
	rb_vec3 middle; /* m, from the sides' reference: weighted mean of both centres of mass */
};
struct rb_feature_rim {
	rb_vec3 direction; /* to that point, as in rb_feature_half */
	bool turns;
};
bool rb_feature_landing(const struct rb_feature_side *a, const struct rb_feature_side *b,
                        const struct rb_feature_fall *fall, struct rb_feature_rim *out);
/*
 * The key of that point or, with `aside`, of one a quarter turn on, if the side's `half` is
 * `direction`; of the opposite points if it is -direction.
 */
uint64_t rb_feature_of_rim(const struct rb_feature_rim *rim, uint64_t quarter, bool aside);

/*
 * True if the key names a quarter of a flat rim; and the rim of such a quarter on a surface (false:
 * it names none).
 */
bool rb_feature_is_quarter(uint64_t key);
bool rb_feature_flat_rim(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         uint64_t key, struct rb_feature_flat_rim *out);

/*
 * The features that take over beyond the nearest end of the key's, as a manifold's key; 0: a search
 * must find them.
 */
uint64_t rb_feature_beyond(const struct rb_feature_side *a, const struct rb_feature_side *b,
                           uint64_t key, const struct rb_feature_point *p);

/*
 * The contact point of two rims, or of a rim and an edge or mantle, which have no closed form: by
 * Newton's method from a point `near` it, relative to the reference; rates by the implicit function
 * theorem. False: other features, or no convergence.
 */
bool rb_feature_curves(struct rb_feature_point *out, const struct rb_feature_side *a,
                       const struct rb_feature_side *b, uint64_t key, rb_vec3 near);

/*
 * The key of a point of the parts' manifold of that `depth`, m, extended so that features alone
 * determine the point: by a mark if two edges cross within a face (whose, and which of the two
 * faces at its edge), and, for a rim and an edge or mantle, which cross twice, by the number of the
 * crossing.
 */
uint64_t rb_feature_name(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         const rb_manifold *manifold, int point, double depth);

#endif
