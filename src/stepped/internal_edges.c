/* SPDX-License-Identifier: MIT */
/*
 * A contact along n is judged by its side: the step would let the parts come as near along n as to
 * touch. If a face with normal m is a plane between them, now and at the end of the step, they do
 * not meet, unless forces move them through that plane. Forces do not where the parts are flush, to
 * the tolerance, or where contacts have held the bodies in the step before: others hold them.
 *
 * Where the parts lie over each other along m, that is no reason: two faces nearly parallel both
 * keep a stack apart. They do not if they are apart across m, in the direction in which n looks, to
 * the tolerance; or if what is outermost of both along m has no point in common, as of a ball
 * beside a seam, which may hang over it. Then only what comes near on its own is beside: what rolls
 * off an edge leaves it.
 */
#include "stepped/internal_edges.h"

#include <float.h>

#include "geom/boxes.h"
#include "geom/patch_overlap.h"

/* As geom/boxes has it: a normal that is that of a face, to rounding, has nothing across. */
static const double parallel = 16 * DBL_EPSILON;

/* Both parts, seen from the origin of the first. */
struct parts {
	rb_placed a, b;
	double radii; /* m, of both together */
};

/* m: height along `n`, of any length, of the farthest point of the core. */
static double height(const rb_placed *p, rb_vec3 n)
{
	return rb_vec3_dot(n, p->at) + rb_placed_height(p, n);
}

/* m: how far they are apart along n, from a to b. */
static double gap_along(const struct parts *parts, rb_vec3 n)
{
	return -height(&parts->a, n) - height(&parts->b, rb_vec3_neg(n)) - parts->radii;
}

/* m: the same when a has moved. */
static double gap_behind(const struct parts *parts, rb_vec3 n,
                         const struct rb_internal_edge_motion *motion)
{
	return -height(&parts->a, rb_quat_rotate_back(motion->turn, n)) -
	       rb_vec3_dot(n, motion->way) - height(&parts->b, rb_vec3_neg(n)) - parts->radii;
}

/* m: the same where n turns with a. */
static double gap_before(const struct parts *parts, rb_vec3 n,
                         const struct rb_internal_edge_motion *motion)
{
	const rb_vec3 turned = rb_quat_rotate(motion->turn, n);

	return -height(&parts->a, n) - rb_vec3_dot(turned, motion->way) -
	       height(&parts->b, rb_vec3_neg(turned)) - parts->radii;
}

bool rb_internal_edge_may(const rb_manifold *manifold, double band, double tolerance)
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

/* Whether what is outermost of both, along n from a to b, has no point in common. */
static bool misses(const struct parts *parts, rb_vec3 n, double depth)
{
	const rb_overlay_def def = {n, 0, 0};
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_patch a, b;

	rb_patch_of(&a, &parts->a, n, depth, 0);
	rb_patch_of(&b, &parts->b, rb_vec3_neg(n), depth, 0);
	return rb_overlay(&a, &b, &def, point) == 0;
}

/* m: gap along a direction that turns with the owner of a face, when a has moved. */
static double gap_then(const struct parts *parts, rb_vec3 n,
                       const struct rb_internal_edge_motion *motion, bool of_a)
{
	return of_a ? gap_before(parts, n, motion) : gap_behind(parts, n, motion);
}

/* Of what the step closes along the normal, what it may close along a face that parts go past. */
static const double past_share = 0.5;

/*
 * Whether a face keeps the parts apart through the step; n from a to b. `normal`: along which they
 * come near. The way of a step may be less than the tolerance, then what comes as near to the face
 * meets it all the same.
 */
static bool parts_them(const struct rb_internal_edge *beside, const struct parts *parts,
                       rb_vec3 normal, rb_vec3 n, bool of_a)
{
	const double gap = gap_along(parts, n);
	const struct rb_internal_edge_motion *const motion =
		beside->held || gap <= beside->tolerance ? &beside->before : &beside->forced;
	const double then = gap_then(parts, n, motion, of_a);
	const double closing = gap_along(parts, normal) - gap_then(parts, normal, motion, of_a);

	return then >= -beside->tolerance && gap - then <= past_share * fmax(closing, 0);
}

/*
 * Whether they do not lie over each other along m, both from a to b. `closes`: they come nearer
 * along n by themselves.
 */
static bool is_aside(const struct rb_internal_edge *beside, const struct parts *parts, rb_vec3 n,
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

/* Faces that may be between parts. */
struct faces {
	const struct parts *parts;
	rb_vec3 normal;   /* along which the parts come near: its own face has nothing across */
	double tolerance; /* m */
	int of, face;     /* the next one: of a, of b */
	bool boxes;
	unsigned open[2]; /* of boxes: bits of the faces of a, of b, that may prove something */
	/* of others: a point of b in the axes of a, of a in those of b */
	rb_vec3 other[2];
	double least; /* m: what faces are to prove */
};

/*
 * Of two boxes what a face proves is known, to rounding: most prove nothing. Faces 2 k and 2 k + 1
 * are across axis k, the one of them that is towards the other box proves the more.
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
		const double way = of == 0 ? pair.from_a[axis] : -pair.from_b[axis];
		const bool both = !(pair.face[k] - 2 * fabs(way) < least);

		faces->open[of] |= (both ? 3U : way < 0 ? 2U : 1U) << 2 * axis;
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

/* The next face that keeps the parts apart now; m its normal, from a to b. */
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
	    !(gap_behind(&parts, n, &beside->forced) < 0))
		return false;
	const bool closes = gap_behind(&parts, n, &beside->before) < 0;
	struct faces faces = faces_of(&parts, n, beside->tolerance);

	while (next_face(&faces, &m, &of_a))
		if (parts_them(beside, &parts, n, m, of_a) &&
		    is_aside(beside, &parts, n, m, closes))
			return true;
	return false;
}
