/* SPDX-License-Identifier: MIT */
/*
 * A contact along n is judged as follows: in the step the parts would come near enough along n to
 * touch. If a face with normal m separates them, now and at the end of the step, they do not meet,
 * unless forces move them through its plane. Forces do not where the parts are flush, to the
 * tolerance, or where contacts balanced them in the last step: other contacts hold the bodies.
 *
 * Where the parts overlap in projection along m, that is no reason: two nearly parallel faces both
 * separate a stack. The reason holds if the parts are separated across m, in the direction of n, to
 * the tolerance; or if their extreme features along m do not overlap in projection, as of a ball
 * beside a seam, which may overhang it. Then only a part that approaches by its own motion is
 * suppressed: one that rolls off an edge leaves it.
 */
#include "stepped/internal_edges.h"

#include <float.h>

#include "geom/boxes.h"
#include "geom/patch_overlap.h"

/* As in geom/boxes: a normal that equals a face's, to rounding, has no component across. */
static const double parallel = 16 * DBL_EPSILON;

/* Both parts, relative to the origin of the first. */
struct parts {
	rb_placed a, b;
	double radii; /* m, of both together */
};

/* Support height of the core along `n`, of any length, m. */
static double height(const rb_placed *p, rb_vec3 n)
{
	return rb_vec3_dot(n, p->at) + rb_placed_height(p, n);
}

/* Gap along n, from a to b, m. */
static double gap_along(const struct parts *parts, rb_vec3 n)
{
	return -height(&parts->a, n) - height(&parts->b, rb_vec3_neg(n)) - parts->radii;
}

/* The same after the motion of a, m. */
static double gap_after(const struct parts *parts, rb_vec3 n,
                        const struct rb_internal_edge_motion *motion)
{
	return -height(&parts->a, rb_quat_rotate_back(motion->turn, n)) -
	       rb_vec3_dot(n, motion->displacement) - height(&parts->b, rb_vec3_neg(n)) -
	       parts->radii;
}

/* The same, with n fixed to a, m. */
static double gap_after_fixed_to_a(const struct parts *parts, rb_vec3 n,
                                   const struct rb_internal_edge_motion *motion)
{
	const rb_vec3 turned = rb_quat_rotate(motion->turn, n);

	return -height(&parts->a, n) - rb_vec3_dot(turned, motion->displacement) -
	       height(&parts->b, rb_vec3_neg(turned)) - parts->radii;
}

bool rb_internal_edge_possible(const rb_manifold *manifold, double band, double tolerance)
{
	const rb_vec3 from = manifold->point[0].on_b;
	rb_vec3 along = {0, 0, 0};
	double far = 0, low = 0, high = 0;

	if (!(manifold->gap >= -tolerance) || manifold->count == 0)
		return false;
	for (int k = 1; k < manifold->count; k++) {
		const rb_vec3 d = rb_vec3_sub(manifold->point[k].on_b, from);

		if (!(rb_vec3_dot(d, d) > far))
			continue;
		far = rb_vec3_dot(d, d);
		along = d;
	}
	if (far == 0)
		return true;
	const rb_vec3 across = rb_vec3_unit(rb_vec3_cross(manifold->normal, along),
	                                    (rb_vec3){0, 0, 0});
	for (int k = 1; k < manifold->count; k++) {
		const double aside = rb_vec3_dot(across,
		                                 rb_vec3_sub(manifold->point[k].on_b, from));

		low = fmin(low, aside);
		high = fmax(high, aside);
	}
	return high - low <= 2 * band + tolerance;
}

/* Whether the extreme features of both, along n from a to b, do not overlap in projection. */
static bool misses(const struct parts *parts, rb_vec3 n, double depth)
{
	const rb_overlay_def def = {n, 0, 0, 0};
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_patch a, b;

	rb_patch_of(&a, &parts->a, n, depth, 0);
	rb_patch_of(&b, &parts->b, rb_vec3_neg(n), depth, 0);
	return rb_overlay(&a, &b, &def, point) == 0;
}

/* Gap along a direction fixed to the owner of a face, after the motion of a, m. */
static double gap_after_for_owner(const struct parts *parts, rb_vec3 n,
                                  const struct rb_internal_edge_motion *motion, bool of_a)
{
	return of_a ? gap_after_fixed_to_a(parts, n, motion) : gap_after(parts, n, motion);
}

/* Closing along a face that parts pass, as a share of that along the normal, that is allowed. */
static const double past_share = 0.5;

/*
 * Whether a face separates the parts through the step; n from a to b. `normal`: along which they
 * approach. As the displacement of a step may be less than the tolerance, parts that approach the
 * face as much count as meeting it.
 */
static bool separates(const struct rb_internal_edge *beside, const struct parts *parts,
                      rb_vec3 normal, rb_vec3 n, bool of_a)
{
	const double gap = gap_along(parts, n);
	const struct rb_internal_edge_motion *const motion =
		beside->held || gap <= beside->tolerance ? &beside->before : &beside->forced;
	const double then = gap_after_for_owner(parts, n, motion, of_a);
	const double closing = gap_along(parts, normal) -
	                       gap_after_for_owner(parts, normal, motion, of_a);

	return then >= -beside->tolerance && gap - then <= past_share * fmax(closing, 0);
}

/*
 * Whether the parts do not overlap in projection along m, both from a to b. `closes`: they approach
 * along n by their own motion.
 */
static bool is_beside(const struct rb_internal_edge *beside, const struct parts *parts, rb_vec3 n,
                      rb_vec3 m, bool closes)
{
	const rb_vec3 none = {0, 0, 0};
	const rb_vec3 across = rb_vec3_unit(rb_vec3_add_scaled(n, -rb_vec3_dot(n, m), m), none);

	if (rb_vec3_max_abs(across) == 0)
		return false;
	return gap_along(parts, across) >= -beside->tolerance ||
	       (closes && misses(parts, m, beside->tolerance));
}

static struct parts parts_of(const rb_placed *a, const rb_placed *b)
{
	return (struct parts){{a->core, {0, 0, 0}, a->turn},
	                      {b->core, rb_vec3_sub(b->at, a->at), b->turn},
	                      a->core->radius + b->core->radius};
}

/* Iterator over faces that may separate parts. */
struct faces {
	const struct parts *parts;
	rb_vec3 normal;   /* along which the parts approach; faces with this normal are skipped */
	double tolerance; /* m */
	int of, face;     /* the next face: owner, index */
	bool boxes;
	unsigned open[2]; /* boxes: bits of the faces of a, of b, that may separate */
	/* else: a point of b in the axes of a, of a in those of b */
	rb_vec3 other[2];
	double least; /* m: gap that a face must prove */
};

/*
 * For two boxes the gap along each face is known, to rounding, and most do not separate. Faces 2 k
 * and 2 k + 1 are across axis k; the one towards the other box has the larger gap.
 */
static void open_faces(struct faces *faces)
{
	const struct parts *const parts = faces->parts;
	const double least = faces->least;
	rb_box_pair pair;

	rb_box_pair_set(&pair, &parts->a, &parts->b);
	for (int k = 0; k < 6; k++) {
		if (pair.face[k] < least)
			continue;
		const int of = k < 3 ? 0 : 1, axis = k < 3 ? k : k - 3;
		const double offset = of == 0 ? pair.from_a[axis] : -pair.from_b[axis];
		const bool both = !(pair.face[k] - 2 * fabs(offset) < least);

		faces->open[of] |= (both ? 3U : offset < 0 ? 2U : 1U) << 2 * axis;
	}
}

static struct faces faces_of(const struct parts *parts, rb_vec3 normal, double tolerance)
{
	const double noise = parallel * (parts->a.core->reach + parts->b.core->reach +
	                                 rb_vec3_length(parts->b.at) + parts->radii);
	struct faces faces = {.parts = parts,
	                      .normal = normal,
	                      .tolerance = tolerance,
	                      .least = parts->radii - tolerance - noise};

	faces.boxes = rb_box_is(&parts->a) && rb_box_is(&parts->b);
	if (faces.boxes) {
		open_faces(&faces);
	} else {
		faces.other[0] = rb_placed_local(&parts->a, rb_placed_middle(&parts->b));
		faces.other[1] = rb_placed_local(&parts->b, rb_placed_middle(&parts->a));
	}
	return faces;
}

/* Finds the next face that separates the parts now; m its normal, from a to b. */
static bool next_face(struct faces *faces, rb_vec3 *m, bool *of_a)
{
	for (; faces->of < 2; faces->of++, faces->face = 0) {
		const rb_placed *const owner = faces->of == 0 ? &faces->parts->a : &faces->parts->b;
		const int count = rb_core_face_count(owner->core);

		while (faces->face < count) {
			const int f = faces->face++;

			if (faces->boxes
			            ? !(faces->open[faces->of] >> f & 1)
			            : rb_core_over_face(owner->core, f, faces->other[faces->of]) <
			                      faces->least)
				continue;
			*m = rb_vec3_scale(faces->of == 0 ? 1 : -1,
			                   rb_placed_face_normal(owner, f));
			*of_a = faces->of == 0;
			if (rb_vec3_max_abs(rb_vec3_cross(*m, faces->normal)) > parallel &&
			    gap_along(faces->parts, *m) >= -faces->tolerance)
				return true;
		}
	}
	return false;
}

bool rb_internal_edge_has_face(const rb_placed *a, const rb_placed *b, rb_vec3 normal,
                               double tolerance)
{
	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE)
		return false;
	const struct parts parts = parts_of(a, b);
	struct faces faces = faces_of(&parts, normal, tolerance);
	rb_vec3 m;
	bool of_a;

	return next_face(&faces, &m, &of_a);
}

bool rb_internal_edge(const struct rb_internal_edge *beside, const rb_placed *a, const rb_placed *b,
                      const rb_manifold *manifold)
{
	const rb_vec3 n = manifold->normal;
	const struct parts parts = parts_of(a, b);
	rb_vec3 m;
	bool of_a;

	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE ||
	    !(gap_after(&parts, n, &beside->forced) < 0))
		return false;
	const bool closes = gap_after(&parts, n, &beside->before) < 0;
	struct faces faces = faces_of(&parts, n, beside->tolerance);

	while (next_face(&faces, &m, &of_a))
		if (separates(beside, &parts, n, m, of_a) &&
		    is_beside(beside, &parts, n, m, closes))
			return true;
	return false;
}
