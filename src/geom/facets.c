/* SPDX-License-Identifier: MIT */
/*
 * The Minkowski difference of two polytopes has three kinds of faces: a face of either against a
 * vertex of the other, and an edge of both. For overlapping bodies the gap is attained on one of
 * its face normals (separating axis theorem); apart, the nearest features may also be a vertex
 * against a vertex or an edge, whose direction is the way between them.
 *
 * An edge pair makes a face only where the arcs that the edges have on the Gauss map cross
 * (Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013); pairs that fail are
 * skipped before any support function is evaluated. EPA is not used: its answer depends on the
 * path of the expansion, and near-parallel faces leave it with slivers.
 */
#include "geom/facets.h"

#include <float.h>

#include "base/error.h"
#include "geom/boxes.h"

/* Faces above which a point that leaves few of them to try costs less than it saves. */
enum { FACES_MANY = 16 };
enum { BLOCK = 32 }; /* arcs of b transformed at a time: 3 KiB of stack, reused for all of a */

/*
 * Cosine of about 1.4 mrad: a face so near to the direction of a distance is tried all the same;
 * one tried needlessly costs time only.
 */
static const double nearly_along = 1 - 1e-6;
/*
 * Arcs adjoin, so a direction outside by this sine is still tried against rounding at their ends;
 * one tried needlessly costs time only.
 */
static const double arc_slack = 1e-9;

/* An rb_polytope_arc in the world with a point of its edge. */
typedef struct {
	rb_vec3 along, inner[2], point;
} arc;

/*
 * Gap along the normal of the face that faces `middle`, the middle of the other body. No face
 * proves more than its distance to any point of that: `near`, its nearest along this normal, leaves
 * few faces to try. Points in p's frame.
 */
static double facing_gap(const rb_axis *axis, const rb_placed *p, double sense, rb_vec3 middle,
                         rb_vec3 *near)
{
	const struct rb_polytope *const polytope = p->core->polytope;
	const rb_placed *const other = sense > 0 ? axis->b : axis->a;
	int facing = 0;

	for (int f = 1; f < polytope->face_count; f++)
		if (rb_core_over_face(p->core, f, middle) >
		    rb_core_over_face(p->core, facing, middle))
			facing = f;
	const rb_vec3 inwards = rb_mat3_apply(&p->turn,
	                                      rb_vec3_neg(polytope->faces[facing].normal));

	*near = rb_placed_local(p, rb_placed_support(other, inwards));
	return rb_core_over_face(p->core, facing, *near);
}

/* Tries the outward normals of p's faces; `sense` is -1 for b, whose normals point towards a. */
static void faces_of(rb_axis *axis, const rb_placed *p, double sense, const rb_vec3 *guide)
{
	rb_vec3 local = {0, 0, 0};

	if (guide)
		local = rb_mat3_apply_transposed(&p->turn, rb_vec3_scale(sense, *guide));
	if (p->core->kind == RB_CORE_CYLINDER) {
		const rb_vec3 u = rb_placed_axis(p);
		if (!guide || local.z >= nearly_along)
			rb_axis_try(axis, rb_vec3_scale(sense, u));
		if (!guide || local.z <= -nearly_along)
			rb_axis_try(axis, rb_vec3_scale(-sense, u));
		return;
	}
	const struct rb_polytope *polytope = p->core->polytope;
	const rb_vec3 middle = rb_placed_local(p, rb_placed_middle(sense > 0 ? axis->b : axis->a));
	rb_vec3 near = middle;
	double known = -(double)INFINITY;

	if (!guide && polytope->face_count > FACES_MANY)
		known = facing_gap(axis, p, sense, middle, &near);
	for (int f = 0; f < polytope->face_count; f++) {
		const rb_vec3 n = polytope->faces[f].normal;
		const double least = fmax(axis->gap, known) - 8 * axis->noise;

		if (rb_core_over_face(p->core, f, near) < least ||
		    rb_core_over_face(p->core, f, middle) < least)
			continue;
		if (!guide || rb_vec3_dot(n, local) >= nearly_along)
			rb_axis_try(axis, rb_vec3_scale(sense, rb_mat3_apply(&p->turn, n)));
	}
}

int rb_facets_ties(const rb_axis *axis, double least, rb_vec3 *normal, int max)
{
	RB_ASSERT_COSTLY(max >= 0 && axis->found);

	int count = 0;

	for (int k = 0; k < 2; k++) {
		const rb_placed *p = k ? axis->b : axis->a;
		const bool round = p->core->kind == RB_CORE_CYLINDER;
		const int faces = round ? 2 : p->core->polytope->face_count;

		for (int f = 0; f < faces && count < max; f++) {
			const rb_vec3 local = round ? (rb_vec3){0, 0, f ? -1 : 1}
			                            : p->core->polytope->faces[f].normal;
			const rb_vec3 n = rb_vec3_scale(k ? -1 : 1, rb_mat3_apply(&p->turn, local));

			if (rb_axis_gap(axis, n) >= least)
				normal[count++] = n;
		}
	}
	return count;
}

/*
 * Tries the faces of two boxes in the order of faces_of, so that ties resolve alike, but only those
 * within rounding of the best: six projections instead of twelve pairs of support functions.
 */
static void faces_of_boxes(rb_axis *axis)
{
	const rb_placed *box[2] = {axis->a, axis->b};
	const rb_vec3 d = rb_vec3_sub(axis->b->at, axis->a->at);
	/* the closed form and rb_axis_gap round differently, each by a few ulp of the sizes */
	const double noise_slack = 16 * axis->noise;
	double max = -(double)INFINITY;
	rb_box_pair pair;

	rb_box_pair_set(&pair, axis->a, axis->b);
	for (int k = 0; k < 6; k++)
		max = fmax(max, pair.face[k]);
	for (int k = 0; k < 6; k++) {
		const rb_mat3 *turn = &box[k / 3]->turn;
		const rb_vec3 n = {turn->m[0][k % 3], turn->m[1][k % 3], turn->m[2][k % 3]};
		const double along = rb_vec3_dot(n, d);

		if (!(pair.face[k] >= max - noise_slack))
			continue;
		/* b's faces look the other way */
		for (int s = 0; s < 2; s++) {
			const double sense = (s == 0) == (k < 3) ? 1 : -1;
			if (sense * along >= -noise_slack)
				rb_axis_try(axis, rb_vec3_scale(sense, n));
		}
	}
}

void rb_facets_faces(rb_axis *axis, const rb_vec3 *guide)
{
	if (!guide && rb_box_is(axis->a) && rb_box_is(axis->b)) {
		faces_of_boxes(axis);
		return;
	}
	faces_of(axis, axis->a, 1, guide);
	faces_of(axis, axis->b, -1, guide);
}

static arc arc_of(const rb_placed *p, const rb_polytope_arc *local)
{
	return (arc){rb_mat3_apply(&p->turn, local->along),
	             {rb_mat3_apply(&p->turn, local->inner[0]),
	              rb_mat3_apply(&p->turn, local->inner[1])},
	             rb_placed_point(p, p->core->polytope->vertices[local->vertex[0]])};
}

/* Transforms the next arcs of b with an end in the slab, from `*from` on; returns their number. */
static int next_arcs(const rb_placed *b, const rb_slab_local *slab, int *from, arc block[BLOCK])
{
	const struct rb_polytope *p = b->core->polytope;
	int count = 0;

	for (; *from < p->arc_count && count < BLOCK; ++*from) {
		const rb_polytope_arc *e = &p->arcs[*from];
		if (rb_slab_has(slab, p->vertices[e->vertex[0]]) ||
		    rb_slab_has(slab, p->vertices[e->vertex[1]]))
			block[count++] = arc_of(b, e);
	}
	return count;
}

/* True if n, across the edge, lies between the normals of its faces; `slack` is in units of n. */
static bool in_arc(const arc *e, rb_vec3 n, double slack)
{
	return rb_vec3_dot(n, e->inner[0]) >= -slack && rb_vec3_dot(n, e->inner[1]) >= -slack;
}

/*
 * Two edges make a face of the Minkowski difference where the direction across both lies on both
 * arcs, that is, their arcs on the Gauss map cross. Gregorius tests this with triple products; with
 * the cross product at hand it takes two products for each body.
 */
static void cross(rb_axis *axis, const arc *e, const arc *f)
{
	const rb_vec3 n = rb_vec3_cross(e->along, f->along);
	const double square = rb_vec3_dot(n, n);
	const double least = 16 * DBL_EPSILON;

	/* parallel to rounding: the direction across is noise, and faces cover that case */
	if (!(square > least * least))
		return;
	const double length = sqrt(square), slack = arc_slack * length;
	const rb_vec3 m = rb_vec3_neg(n);
	const bool forth = in_arc(e, n, slack) && in_arc(f, m, slack);
	const bool back = in_arc(e, m, slack) && in_arc(f, n, slack);
	const rb_vec3 between = rb_vec3_sub(f->point, e->point);
	if (forth && rb_vec3_dot(between, n) / length > axis->gap)
		rb_axis_try(axis, rb_vec3_unit(n, n));
	if (back && rb_vec3_dot(between, m) / length > axis->gap)
		rb_axis_try(axis, rb_vec3_unit(m, m));
}

void rb_facets_edges(rb_axis *axis, const rb_slab *slab)
{
	RB_ASSERT_COSTLY(axis->a->core->kind == RB_CORE_POLYTOPE);
	RB_ASSERT_COSTLY(axis->b->core->kind == RB_CORE_POLYTOPE);

	const rb_placed *a = axis->a, *b = axis->b;
	const struct rb_polytope *p = a->core->polytope;
	const rb_slab_local in_a = rb_slab_of(a, slab->normal, slab->depth);
	const rb_slab_local in_b = rb_slab_of(b, rb_vec3_neg(slab->normal), slab->depth);
	arc block[BLOCK];

	if (!axis->found)
		axis->gap = -(double)INFINITY;
	for (int from = 0; from < b->core->polytope->arc_count;) {
		const int count = next_arcs(b, &in_b, &from, block);
		for (int i = 0; i < p->arc_count && count > 0; i++) {
			if (!rb_slab_has(&in_a, p->vertices[p->arcs[i].vertex[0]]) &&
			    !rb_slab_has(&in_a, p->vertices[p->arcs[i].vertex[1]]))
				continue;
			const arc e = arc_of(a, &p->arcs[i]);
			RB_ASSERT_COSTLY(count <= BLOCK);
			for (int j = 0; j < count; j++)
				cross(axis, &e, &block[j]);
		}
	}
}

/* Shortest vector so far; in the axes of the body with the edge, and at last of the world. */
typedef struct {
	double square;
	rb_vec3 way;
} shortest;

/* Offers the vectors from the vertex v to all edges of p in the slab; all in p's axes. */
static void to_edges(shortest *best, rb_vec3 v, const struct rb_polytope *p,
                     const rb_slab_local *slab)
{
	if (p->edge_count == 0) {
		const rb_vec3 way = rb_vec3_sub(p->vertices[0], v);
		const double square = rb_vec3_dot(way, way);
		if (square < best->square)
			*best = (shortest){square, way};
	}
	for (int i = 0; i < p->edge_count; i++) {
		const rb_vec3 c = p->vertices[p->edges[i][0]], d = p->vertices[p->edges[i][1]];
		if (!rb_slab_has(slab, c) && !rb_slab_has(slab, d))
			continue;
		const rb_vec3 cd = rb_vec3_sub(d, c);
		const double whole = rb_vec3_dot(cd, cd);
		const double t = rb_vec3_dot(rb_vec3_sub(v, c), cd);
		/* Measured from the nearer end, so that both ends have the same digits. */
		const rb_vec3 foot = 2 * t < whole ? rb_vec3_add_scaled(c, fmax(t, 0) / whole, cd)
		                                   : rb_vec3_add_scaled(
							     d, fmin(t - whole, 0) / whole, cd);
		rb_vec3 way = rb_vec3_sub(foot, v);
		/*
		 * Near contact the rounding of the foot along the edge would tilt a short vector:
		 * its component along the edge is removed.
		 */
		const bool within = t > 0 && t < whole;
		if (within)
			way = rb_vec3_add_scaled(way, -rb_vec3_dot(way, cd) / whole, cd);
		const double square = rb_vec3_dot(way, way);
		/*
		 * Close to a vertex the vector to it is as short but not quite perpendicular: the
		 * edge wins a tie.
		 */
		if ((within ? square * (1 - 8 * DBL_EPSILON) : square) < best->square)
			*best = (shortest){square, way};
	}
}

/* Shortest vector from the vertices of p to the edges of q, in world axes. */
static shortest corners_of(const rb_placed *p, const rb_placed *q, rb_vec3 normal, double depth)
{
	const rb_slab_local in_p = rb_slab_of(p, normal, depth);
	const rb_slab_local in_q = rb_slab_of(q, rb_vec3_neg(normal), depth);
	const struct rb_polytope *polytope = p->core->polytope;
	shortest best = {.square = (double)INFINITY};

	for (int i = 0; i < polytope->vertex_count; i++) {
		const rb_vec3 v = polytope->vertices[i];
		if (!rb_slab_has(&in_p, v))
			continue;
		const rb_vec3 there = rb_mat3_apply_transposed(
			&q->turn, rb_vec3_sub(rb_placed_point(p, v), q->at));
		to_edges(&best, there, q->core->polytope, &in_q);
	}
	best.way = rb_mat3_apply(&q->turn, best.way);
	return best;
}

void rb_facets_corners(rb_axis *axis, const rb_slab *slab)
{
	const bool point_a = axis->a->core->polytope->edge_count == 0;
	const bool point_b = !point_a && axis->b->core->polytope->edge_count == 0;
	const shortest none = {.way = {0, 0, 0}};
	/* what leads from a point leads to it */
	const shortest from_a = point_b ? none
	                                : corners_of(axis->a, axis->b, slab->normal, slab->depth);
	const shortest from_b = point_a ? none
	                                : corners_of(axis->b, axis->a, rb_vec3_neg(slab->normal),
	                                             slab->depth);
	const rb_vec3 forth = from_a.way, back = rb_vec3_neg(from_b.way);

	/*
	 * Both are tried: where one ends on a vertex close to the foot of the other they are
	 * equally long, but only one of the directions proves that length.
	 */
	if (rb_vec3_dot(forth, forth) > 0)
		rb_axis_try(axis, rb_vec3_unit(forth, forth));
	if (rb_vec3_dot(back, back) > 0)
		rb_axis_try(axis, rb_vec3_unit(back, back));
}
