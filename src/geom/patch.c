/* SPDX-License-Identifier: MIT */
/*
 * Which vertices lie within the depth decides the kind of patch: one is a point, two a segment, all
 * from one face a polygon in the face's own order, and vertices of several faces the hull of their
 * projections. Faces are preferred to hulls because their plane is exact and their features keep
 * their identity from step to step (warm start).
 */
#include "geom/patch.h"

#include <string.h>

#include "base/error.h"
#include "geom/boxes.h"

/*
 * 1 - cos(pi / 4): height of a rim an eighth of a turn from its lowest point, over its radius times
 * the sine of its tilt.
 */
static const double eighth_rise = 0.29289321881345254;

/* The edge between two vertices, or a diagonal where they have none. */
static rb_part edge_between(const struct rb_polytope *p, int v, int w)
{
	const int edge = rb_polytope_edge(p, v, w);

	return edge >= 0 ? rb_part_of(RB_PART_EDGE, edge) : rb_part_of(RB_PART_DIAGONAL, v);
}

/*
 * Heights of a polytope's vertices along n, those of the first ones kept: they are asked for
 * several times.
 */
enum { HEIGHTS_MAX = 32 };
struct heights {
	const struct rb_polytope *p;
	rb_vec3 n;
	double kept[HEIGHTS_MAX];
};

static void heights_of(struct heights *heights, const struct rb_polytope *p, rb_vec3 n)
{
	const int count = p->vertex_count < HEIGHTS_MAX ? p->vertex_count : HEIGHTS_MAX;

	heights->p = p;
	heights->n = n;
	for (int i = 0; i < count; i++)
		heights->kept[i] = rb_vec3_dot(n, p->vertices[i]);
}

static double height_of(const struct heights *heights, int i)
{
	return i < HEIGHTS_MAX ? heights->kept[i]
	                       : rb_vec3_dot(heights->n, heights->p->vertices[i]);
}

/* Vertices no lower than `low`, at most RB_PATCH_MAX; `*all` counts all of them. */
static int outermost(const struct heights *heights, double low, int vertex[RB_PATCH_MAX], int *all)
{
	int count = 0;

	*all = 0;
	for (int i = 0; i < heights->p->vertex_count; i++) {
		if (!(height_of(heights, i) >= low))
			continue;
		if (count < RB_PATCH_MAX)
			vertex[count++] = i;
		++*all;
	}
	return count;
}

/* Face whose normal is most along n. */
static int best_face(const struct rb_polytope *p, rb_vec3 n)
{
	int best = 0;
	double max = -2;

	for (int f = 0; f < p->face_count; f++) {
		const double along = rb_vec3_dot(n, p->faces[f].normal);
		if (along > max) {
			max = along;
			best = f;
		}
	}
	return best;
}

/*
 * Vertices of one face no lower than `low`, in its order, thinned to RB_PATCH_MAX by a stride;
 * `*met` counts all of them.
 */
static int from_face(const struct heights *heights, int face, double low, int vertex[RB_PATCH_MAX],
                     int *met)
{
	const struct rb_polytope *const p = heights->p;
	const rb_polytope_face *f = &p->faces[face];
	const int stride = (f->count + RB_PATCH_MAX - 1) / RB_PATCH_MAX;
	int count = 0;

	*met = 0;
	for (int i = 0; i < f->count; i++) {
		const int v = p->loop[f->first + i];
		if (!(height_of(heights, v) >= low))
			continue;
		if ((*met)++ % stride == 0)
			vertex[count++] = v;
	}
	return count;
}

/*
 * Removes vertices that are higher above another than they are beside it; at least one remains. The
 * body has to turn by 45 degrees before such a vertex touches, and seen along n it may hide what
 * lies below. Returns the number left; `*low` is the height of the innermost.
 */
static int without_steep(const struct rb_polytope *p, rb_vec3 n, int vertex[RB_PATCH_MAX],
                         int count, double *low)
{
	bool steep[RB_PATCH_MAX];
	int kept = 0;

	for (int i = 0; i < count; i++) {
		const rb_vec3 here = p->vertices[vertex[i]];

		steep[i] = false;
		for (int k = 0; k < count && !steep[i]; k++) {
			const rb_vec3 d = rb_vec3_sub(p->vertices[vertex[k]], here);
			const double below = rb_vec3_dot(n, d);

			steep[i] = below > 0 && rb_vec3_dot(d, d) < 2 * below * below;
		}
	}
	*low = (double)INFINITY;
	for (int i = 0; i < count; i++) {
		if (steep[i])
			continue;
		*low = fmin(*low, rb_vec3_dot(n, p->vertices[vertex[i]]));
		vertex[kept++] = vertex[i];
	}
	return kept;
}

/* A vertex projected onto the plane across n. */
typedef struct {
	double x, y;
	int vertex;
} flat_point;

/* Twice the signed area of the triangle a, b, c. */
static double turn_of(const flat_point *a, const flat_point *b, const flat_point *c)
{
	return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/*
 * Convex hull of the projections, anticlockwise about n: Andrew's monotone chain, Inf. Proc. Lett.
 * 9 (1979) 216. Collinear points are dropped.
 */
static int round_up(const struct rb_polytope *p, rb_vec3 n, int vertex[RB_PATCH_MAX], int count)
{
	RB_ASSERT(count > 0 && count <= RB_PATCH_MAX);

	const rb_vec3 x = rb_vec3_across(n), y = rb_vec3_cross(n, x);
	flat_point point[RB_PATCH_MAX], hull[2 * RB_PATCH_MAX];
	int size = 0;

	for (int i = 0; i < count; i++) {
		const flat_point q = {rb_vec3_dot(x, p->vertices[vertex[i]]),
		                      rb_vec3_dot(y, p->vertices[vertex[i]]), vertex[i]};
		int at = i;
		for (; at > 0 &&
		       (point[at - 1].x > q.x || (point[at - 1].x == q.x && point[at - 1].y > q.y));
		     at--)
			point[at] = point[at - 1];
		point[at] = q;
	}
	for (int pass = 0; pass < 2; pass++) {
		const int start = size;
		for (int i = 0; i < count; i++) {
			const flat_point *q = &point[pass ? count - 1 - i : i];
			while (size >= start + 2 &&
			       turn_of(&hull[size - 2], &hull[size - 1], q) <= 0)
				size--;
			hull[size++] = *q;
		}
		size--;
	}
	for (int i = 0; i < size; i++)
		vertex[i] = hull[i].vertex;
	return size;
}

/* What a patch of so many vertices is called; `face` >= 0: all of them are of that face. */
static void name(rb_patch *patch, const rb_placed *placed, rb_vec3 n, const int *vertex, int count,
                 int face)
{
	const struct rb_polytope *p = placed->core->polytope;

	RB_ASSERT(count >= 1 && count <= RB_PATCH_MAX);
	patch->count = count;
	patch->normal = n;
	if (count <= 2) {
		patch->kind = count == 2 ? RB_PATCH_SEGMENT : RB_PATCH_POINT;
		patch->feature = count == 2 ? edge_between(p, vertex[0], vertex[1])
		                            : rb_part_of(RB_PART_VERTEX, vertex[0]);
		return;
	}
	patch->kind = RB_PATCH_POLYGON;
	if (face >= 0) {
		patch->normal = rb_mat3_apply(&placed->turn, p->faces[face].normal);
		patch->feature = rb_part_of(RB_PART_FACE, face);
	}
	for (int i = 0; i < count; i++)
		patch->side[i] = edge_between(p, vertex[i], vertex[i + 1 < count ? i + 1 : 0]);
}

/* Features and points of a patch of so many vertices. */
static void put_vertices(rb_patch *patch, const rb_placed *placed, rb_vec3 n, const int *vertex,
                         int count, int face)
{
	for (int i = 0; i < count; i++) {
		patch->point[i] = rb_placed_point(placed,
		                                  placed->core->polytope->vertices[vertex[i]]);
		patch->id[i] = rb_part_of(RB_PART_VERTEX, vertex[i]);
	}
	name(patch, placed, n, vertex, count, face);
}

/* Points of a patch of a box, whose vertices are sums of three. */
static void put_corners(rb_patch *patch, const rb_placed *placed, const int *vertex, int count)
{
	const rb_vec3 half = placed->core->polytope->half;
	const rb_mat3 *turn = &placed->turn;
	const double size[3] = {half.x, half.y, half.z};
	rb_vec3 side[3][2];

	for (int k = 0; k < 3; k++) {
		side[k][0] = (rb_vec3){turn->m[0][k] * size[k], turn->m[1][k] * size[k],
		                       turn->m[2][k] * size[k]};
		side[k][1] = rb_vec3_neg(side[k][0]);
	}
	for (int i = 0; i < count; i++) {
		const int v = vertex[i];
		const rb_vec3 xy = rb_vec3_add(side[0][v & 1], side[1][v >> 1 & 1]);

		patch->point[i] = rb_vec3_add(placed->at, rb_vec3_add(xy, side[2][v >> 2]));
	}
}

/* The same as below of a box; false where its vertices are not all of one face. */
static bool of_box(rb_patch *patch, const rb_placed *placed, rb_vec3 n, rb_vec3 local, double depth,
                   double tilt)
{
	int vertex[4], face;
	const int count = rb_box_outermost(placed->core->polytope, local, depth, tilt, vertex,
	                                   &face);

	if (count == 0)
		return false;
	for (int i = 0; i < count; i++)
		patch->id[i] = rb_part_of(RB_PART_VERTEX, vertex[i]);
	put_corners(patch, placed, vertex, count);
	name(patch, placed, n, vertex, count, face);
	return true;
}

/* Patch of a polytope; see the head of this file and rb_patch_of. */
static void of_polytope(rb_patch *patch, const rb_placed *placed, rb_vec3 n, double depth,
                        double tilt)
{
	const struct rb_polytope *p = placed->core->polytope;
	const rb_vec3 local = rb_mat3_apply_transposed(&placed->turn, n);
	int vertex[RB_PATCH_MAX] = {0}, all;
	struct heights heights;

	if (p->box && of_box(patch, placed, n, local, depth, tilt))
		return;
	heights_of(&heights, p, local);
	const double top = height_of(&heights, rb_polytope_support(p, local));
	double low = top - depth;
	int count = outermost(&heights, low, vertex, &all), of = -1;

	if (count == 0) /* NaN: no vertex compares; the first one keeps the patch well formed */
		count = all = 1;
	if ((all > 2 || tilt > depth) && p->face_count > 0) {
		const int face = best_face(p, local);
		int in_order[RB_PATCH_MAX], met;
		int ordered = from_face(&heights, face, low, in_order, &met);
		/* not all from the best face: without steep ones they may be */
		if (met < all) {
			all = count = without_steep(p, local, vertex, count, &low);
			ordered = from_face(&heights, face, low, in_order, &met);
		}
		const bool of_face = met == all;
		/* nearly flush: the whole face if none of it is deeper than `tilt` */
		if (of_face && tilt > depth) {
			int whole[RB_PATCH_MAX], whole_met;
			const int with_all = from_face(&heights, face, top - tilt, whole,
			                               &whole_met);
			if (whole_met == p->faces[face].count) {
				ordered = with_all;
				memcpy(in_order, whole, (size_t)with_all * sizeof *whole);
				all = whole_met;
			}
		}
		if (of_face && all > 2) {
			count = ordered;
			memcpy(vertex, in_order, (size_t)count * sizeof *vertex);
			of = face;
		} else if (all > 2) {
			count = round_up(p, local, vertex, count);
			patch->feature = rb_part_of(RB_PART_SEVERAL, face);
		}
	}
	put_vertices(patch, placed, n, vertex, count, of);
}

/*
 * Patch of a cylinder: an end (disc) where the axis is along n, a line of the mantle (segment)
 * where it is across, else the outermost point of a rim.
 */
static void of_cylinder(rb_patch *patch, const rb_placed *placed, rb_vec3 n, double depth,
                        double tilt)
{
	const rb_core *core = placed->core;
	const rb_vec3 u = rb_placed_axis(placed);
	/* in the body's axes, where the radial part is exact to the last digit */
	const rb_vec3 local = rb_mat3_apply_transposed(&placed->turn, n);
	const double along = local.z;
	const rb_vec3 radial = {local.x, local.y, 0};
	const double across = rb_vec3_length(radial);
	const int end = along < 0;
	const double half = end ? -core->half_height : core->half_height;
	const rb_vec3 out = rb_mat3_apply(&placed->turn, rb_vec3_unit(radial, (rb_vec3){1, 0, 0}));
	const rb_vec3 centre = rb_vec3_add_scaled(placed->at, half, u);

	patch->count = 1;
	patch->id[0] = rb_part_of(RB_PART_RIM, end);
	/* the rim's highest point is 2 r sin(tilt) above its lowest */
	const bool upright = across <= fabs(along) && 2 * core->round * across <= depth;
	const bool leans = tilt > 0 && across < 0.5 && eighth_rise * core->round * across <= depth;
	if (upright || leans) {
		patch->kind = RB_PATCH_DISC;
		if (tilt > 0 && core->round * across > tilt)
			patch->low = out;
		patch->feature = rb_part_of(RB_PART_END, end);
		patch->normal = end ? rb_vec3_neg(u) : u;
		patch->point[0] = centre;
		patch->round = core->round;
		return;
	}
	patch->normal = n;
	patch->point[0] = rb_vec3_add_scaled(centre, core->round, out);
	patch->kind = RB_PATCH_POINT;
	patch->feature = patch->id[0];
	if (2 * core->half_height * fabs(along) > depth)
		return;
	const rb_vec3 foot = rb_vec3_add_scaled(placed->at, core->round, out);
	patch->kind = RB_PATCH_SEGMENT;
	patch->feature = rb_part_of(RB_PART_MANTLE, 0);
	patch->count = 2;
	patch->curve = core->round;
	for (int i = 0; i < 2; i++) {
		patch->point[i] = rb_vec3_add_scaled(foot,
		                                     i ? -core->half_height : core->half_height, u);
		patch->id[i] = rb_part_of(RB_PART_MANTLE, 1 + i);
	}
}

void rb_patch_of(rb_patch *patch, const rb_placed *placed, rb_vec3 outward, double depth,
                 double tilt)
{
	/* points beyond `count` stay unset: clearing them would cost more than all else here */
	patch->kind = RB_PATCH_PLANE;
	patch->count = 1;
	patch->curve = patch->round = 0;
	patch->low = (rb_vec3){0, 0, 0};
	patch->feature = patch->id[0] = rb_part_of(RB_PART_SURFACE, 0);
	/*
	 * x, or y where x is mostly along the normal; 0.8 lies above 1 / sqrt(2), so at the
	 * change-over the other axis is a good reference
	 */
	const rb_mat3 *turn = &placed->turn;
	patch->axis = (rb_vec3){turn->m[0][0], turn->m[1][0], turn->m[2][0]};
	if (fabs(rb_vec3_dot(patch->axis, outward)) > 0.8)
		patch->axis = (rb_vec3){turn->m[0][1], turn->m[1][1], turn->m[2][1]};
	if (placed->core->kind == RB_CORE_HALF_SPACE) {
		patch->normal = rb_placed_axis(placed);
		patch->point[0] = placed->at;
	} else if (placed->core->kind == RB_CORE_CYLINDER) {
		of_cylinder(patch, placed, outward, depth, tilt);
	} else {
		of_polytope(patch, placed, outward, depth, tilt);
	}
	RB_ASSERT_COSTLY(patch->count >= 1 && patch->count <= RB_PATCH_MAX);
}
