/* SPDX-License-Identifier: MIT */
/*
 * Two quadrangles, or one and a segment, in axes across the normal: which side of which line each
 * corner is on decides both who lies within whom and which sides cross. geom/patch_overlap has the
 * same rules for all shapes.
 */
#include "geom/box_overlay.h"

#include <float.h>

#include "geom/boxes.h"
#include "math/lanes.h"

enum { CORNERS = RB_LANES, POINTS_MAX = 12 };

/* Outermost corners of a box; lanes beyond `count` are the first one. */
typedef struct {
	const struct rb_polytope *polytope;
	int count, vertex[CORNERS], face;
	rb_vec3 up;              /* in its own axes: the normal, outward */
	rb_lanes x, y, z;        /* m: in the axes across n, and along it */
	rb_lanes rx, ry;         /* m: from each corner to the next */
	double length[CORNERS];  /* m: of these */
	double sense;            /* 1: anticlockwise about n, -1: clockwise */
	double slope_x, slope_y; /* of the face */
	rb_part feature;
} flat;

typedef struct {
	double x, y, z, gap; /* m: z on a */
	rb_part a, b;
} flat_point;

typedef struct {
	const flat *a, *b;
	double aside, along, past;
	int count;
	flat_point point[POINTS_MAX];
	bool full;
} table;

static int next_of(const flat *f, int i)
{
	return i + 1 < f->count ? i + 1 : 0;
}

static rb_part side_of(const flat *f, int i)
{
	const int v = f->vertex[i],
		  edge = rb_polytope_edge(f->polytope, v, f->vertex[next_of(f, i)]);

	return edge >= 0 ? rb_part_of(RB_PART_EDGE, edge) : rb_part_of(RB_PART_DIAGONAL, v);
}

static double along(rb_vec3 axis, const rb_mat3 *turn, int k)
{
	return axis.x * turn->m[0][k] + axis.y * turn->m[1][k] + axis.z * turn->m[2][k];
}

/* A length along an axis of the box, to the sides of it on which the corners are. */
RB_LANES_INLINE void to_sides(double length, const rb_lanes_mask *side, rb_lanes *to)
{
	const rb_lanes all = {length, length, length, length};

	*to = (rb_lanes)((rb_lanes_mask)all ^ *side);
}

/* Where the corners are along an axis; `side`: signs along those of the box. */
static void project(const rb_lanes_mask side[3], const rb_placed *p, rb_vec3 axis, rb_lanes *to)
{
	const rb_vec3 half = p->core->polytope->half;
	rb_lanes x, y, z;

	to_sides(along(axis, &p->turn, 0) * half.x, &side[0], &x);
	to_sides(along(axis, &p->turn, 1) * half.y, &side[1], &y);
	to_sides(along(axis, &p->turn, 2) * half.z, &side[2], &z);
	*to = rb_vec3_dot(axis, p->at) + (x + y + z);
}

/* Which corners are outermost; false: they are not all of one face. */
static bool choose(flat *f, const rb_placed *p, rb_vec3 outward, double depth, double tilt)
{
	f->polytope = p->core->polytope;
	f->up = rb_mat3_apply_transposed(&p->turn, outward);
	f->count = rb_box_outermost(f->polytope, f->up, depth, tilt, f->vertex, &f->face);
	return f->count > 0;
}

/* Where they are; sense: 1 where the normal is outward, -1: inward. */
static void place(flat *f, const rb_placed *p, const rb_vec3 axis[3], double sense)
{
	for (int i = f->count; i < CORNERS; i++)
		f->vertex[i] = f->vertex[0];
	const rb_lanes_mask v = {f->vertex[0], f->vertex[1], f->vertex[2], f->vertex[3]};
	/* bits of a vertex as signs */
	const rb_lanes_mask side[3] = {v << 63, v >> 1 << 63, v >> 2 << 63};

	project(side, p, axis[0], &f->x);
	project(side, p, axis[1], &f->y);
	project(side, p, axis[2], &f->z);
	f->sense = sense;
	f->feature = rb_part_of(RB_PART_VERTEX, f->vertex[0]);
	if (f->count == 1)
		return;
	for (int i = 0; i < f->count; i++) {
		const int next = next_of(f, i);

		f->rx[i] = f->x[next] - f->x[i];
		f->ry[i] = f->y[next] - f->y[i];
		f->length[i] = sqrt(f->rx[i] * f->rx[i] + f->ry[i] * f->ry[i]);
	}
	f->feature = f->count == 2 ? side_of(f, 0) : rb_part_of(RB_PART_FACE, f->face);
	if (f->count == 2)
		return;
	const int k = f->face >> 1;
	const double rise = sense * (k == 0 ? f->up.x : k == 1 ? f->up.y : f->up.z);

	f->slope_x = -along(axis[0], &p->turn, k) / rise;
	f->slope_y = -along(axis[1], &p->turn, k) / rise;
}

/* m: of a face or an edge at a place. */
static double height_at(const flat *f, double x, double y)
{
	const double dx = x - f->x[0], dy = y - f->y[0];

	if (f->count > 2)
		return f->z[0] + f->slope_x * dx + f->slope_y * dy;
	if (f->count == 1)
		return f->z[0];
	const double square = f->length[0] * f->length[0];
	const double s = square > 0 ? (dx * f->rx[0] + dy * f->ry[0]) / square : 0;
	return f->z[0] + (s < 0 ? 0 : s > 1 ? 1 : s) * (f->z[1] - f->z[0]);
}

/* As put() of geom/patch_overlap. */
static void put(table *t, flat_point p)
{
	for (int i = 0; i < t->count; i++) {
		flat_point *const q = &t->point[i];

		if (p.a == q->a || p.b == q->b ||
		    !(fabs(p.x - q->x) <= t->aside && fabs(p.y - q->y) <= t->aside))
			continue;
		if (p.gap < q->gap - t->aside)
			*q = p;
		return;
	}
	t->full = t->count == POINTS_MAX;
	if (!t->full)
		t->point[t->count++] = p;
}

/* m^2: off[i] of each corner of `p` from the line of side i of `f`, times its length. */
static void see(const flat *f, const flat *p, rb_lanes off[CORNERS])
{
	for (int i = 0; i < f->count; i++)
		off[i] = f->rx[i] * (p->y - f->y[i]) - f->ry[i] * (p->x - f->x[i]);
}

/* Where a corner is: past the border, past it by less than the tolerance, or over the other. */
enum place { PAST, BESIDE, OVER };

/* Where corner j of `p` is, seen from `f`. */
static enum place place_of(const table *t, const flat *f, const flat *p, int j,
                           const rb_lanes off[CORNERS])
{
	double past = 0; /* m */

	if (f->count == 2) {
		const double length = f->length[0];
		const double dx = p->x[j] - f->x[0], dy = p->y[j] - f->y[0];
		const double far = (dx * f->rx[0] + dy * f->ry[0]) / length;

		past = fmax(fabs(off[0][j]) / length, fmax(-far, far - length));
	}
	for (int i = 0; i < f->count && f->count > 2; i++)
		past = fmax(past, -f->sense * off[i][j] / f->length[i]);
	return past <= t->past ? OVER : past <= t->aside ? BESIDE : PAST;
}

/* Corners of one in that place of the other. */
static void put_corners(table *t, bool of_a, const rb_lanes off[CORNERS], enum place place)
{
	const flat *const own = of_a ? t->a : t->b, *const other = of_a ? t->b : t->a;

	for (int j = 0; j < own->count; j++) {
		if (place_of(t, other, own, j, off) != place)
			continue;
		const double there = height_at(other, own->x[j], own->y[j]);
		const rb_part corner = rb_part_of(RB_PART_VERTEX, own->vertex[j]);

		put(t, of_a ? (flat_point){own->x[j], own->y[j], own->z[j], there - own->z[j],
		                           corner, other->feature}
		            : (flat_point){own->x[j], own->y[j], there, own->z[j] - there,
		                           other->feature, corner});
	}
}

/* The point at shares of side i of a and j of b, of which one is the nearer end's. */
static flat_point between(const table *t, const int side[2], const double at[2])
{
	const flat *const a = t->a, *const b = t->b;
	const int i = side[0], j = side[1], i1 = next_of(a, i), j1 = next_of(b, j);
	const double s = at[0], z = a->z[i] + s * (a->z[i1] - a->z[i]);
	/* from the nearer end for the digits */
	const double x = s < 0.5 ? a->x[i] + s * a->rx[i] : a->x[i1] + (s - 1) * a->rx[i];
	const double y = s < 0.5 ? a->y[i] + s * a->ry[i] : a->y[i1] + (s - 1) * a->ry[i];

	return (flat_point){
		x, y, z, b->z[j] + at[1] * (b->z[j1] - b->z[j]) - z, side_of(a, i), side_of(b, j)};
}

/* m^2: of two sides; 0: they are parallel, to rounding. */
static double cross_of(const table *t, int i, int j)
{
	const double cross = t->a->rx[i] * t->b->ry[j] - t->a->ry[i] * t->b->rx[j];
	const double least = 4 * DBL_EPSILON * t->a->length[i] * t->b->length[j];

	return fabs(cross) > least ? cross : 0;
}

static bool straddles(double before, double after)
{
	return !(before > 0 && after > 0) && !(before < 0 && after < 0);
}

/*
 * Where side i of a and side j of b cross, within both, unless they lie along each other; to[i]: of
 * b's corners from sides of a, from[j]: of a's from those of b.
 */
static void put_crossing(table *t, int i, int j, const rb_lanes *to, const rb_lanes *from)
{
	const flat *const a = t->a, *const b = t->b;
	const int i1 = next_of(a, i), j1 = next_of(b, j);
	const double near_a = t->aside * a->length[i], near_b = t->aside * b->length[j];
	const double cross = cross_of(t, i, j);

	if (!straddles(from[j][i], from[j][i1]) || cross == 0 ||
	    (fabs(to[i][j]) <= near_a && fabs(to[i][j1]) <= near_a) ||
	    (fabs(from[j][i]) <= near_b && fabs(from[j][i1]) <= near_b))
		return;
	const double at[2] = {from[j][i] / cross, -to[i][j] / cross};
	if (at[0] > 0 && at[0] < 1 && at[1] > 0 && at[1] < 1)
		put(t, between(t, (const int[2]){i, j}, at));
}

/*
 * A face and another, or an edge. What they share comes first: of points beside each other the
 * first stays, and one past a border touches nothing.
 */
static void faces(table *t)
{
	const flat *const a = t->a, *const b = t->b;
	const int a_sides = a->count > 2 ? a->count : 1, b_sides = b->count > 2 ? b->count : 1;
	rb_lanes to[CORNERS], from[CORNERS];

	see(a, b, to);
	see(b, a, from);
	put_corners(t, false, to, OVER);
	put_corners(t, true, from, OVER);
	for (int i = 0; i < a_sides; i++)
		for (int j = 0; j < b_sides; j++)
			if (straddles(to[i][j], to[i][next_of(b, j)]))
				put_crossing(t, i, j, to, from);
	put_corners(t, false, to, BESIDE);
	put_corners(t, true, from, BESIDE);
}

/* A corner, over whatever the other one has, unless that is a face and it is past its border. */
static void corner(table *t, bool of_a)
{
	const flat *const own = of_a ? t->a : t->b, *const other = of_a ? t->b : t->a;
	rb_lanes off[CORNERS];

	if (other->count > 2) {
		see(other, own, off);
		put_corners(t, of_a, off, OVER);
		put_corners(t, of_a, off, BESIDE);
		return;
	}
	const double there = height_at(other, own->x[0], own->y[0]);

	put(t, of_a ? (flat_point){own->x[0], own->y[0], own->z[0], there - own->z[0], own->feature,
	                           other->feature}
	            : (flat_point){own->x[0], own->y[0], there, own->z[0] - there, other->feature,
	                           own->feature});
}

static double clamped(double s)
{
	return s < 0 ? 0 : s > 1 ? 1 : s;
}

/* Two edges: false where they lie along each other. */
static bool edges(table *t)
{
	const flat *const a = t->a, *const b = t->b;
	const double length = a->length[0], cross = cross_of(t, 0, 0);
	double far[2], off[2];

	for (int j = 0; j < 2; j++) {
		const double dx = b->x[j] - a->x[0], dy = b->y[j] - a->y[0];

		far[j] = (a->rx[0] * dx + a->ry[0] * dy) / length;
		off[j] = (a->rx[0] * dy - a->ry[0] * dx) / length;
	}
	const int first = far[0] <= far[1] ? 0 : 1;
	const double span = far[1 - first] - far[first];
	const double from = far[first] > 0 ? far[first] : 0;
	const double to = far[1 - first] < length ? far[1 - first] : length;
	const double drift = (off[1 - first] - off[first]) / span;
	const double near = t->along;

	/* written so that NaN is no crossing */
	if (!(length > 0 && span > 0 && cross != 0) ||
	    (to > from && fabs(off[first] + drift * (from - far[first])) <= near &&
	     fabs(off[first] + drift * (to - far[first])) <= near))
		return false;
	const double dx = b->x[0] - a->x[0], dy = b->y[0] - a->y[0];
	const double at[2] = {clamped((dx * b->ry[0] - dy * b->rx[0]) / cross),
	                      clamped((dx * a->ry[0] - dy * a->rx[0]) / cross)};

	put(t, between(t, (const int[2]){0, 0}, at));
	return true;
}

/* False: not done. */
static bool overlay(table *t)
{
	if (t->a->count == 1 || t->b->count == 1)
		corner(t, t->a->count == 1);
	else if (t->a->count == 2 && t->b->count == 2)
		return edges(t);
	else
		faces(t);
	return !t->full;
}

int rb_box_overlay(const rb_placed *a, const rb_placed *b, double depth, const double tilt[2],
                   const rb_overlay_def *def, rb_overlay_point *out)
{
	const rb_vec3 across = rb_vec3_across(def->n);
	const rb_vec3 axis[3] = {across, rb_vec3_cross(def->n, across), def->n};
	flat fa, fb;
	/* not initialised: clearing the points would cost as much as all else */
	table t;

	if (!choose(&fa, a, def->n, depth, tilt[0]) ||
	    !choose(&fb, b, rb_vec3_neg(def->n), depth, tilt[1]))
		return -1;
	place(&fa, a, axis, 1);
	place(&fb, b, axis, -1);
	t.a = &fa;
	t.b = &fb;
	t.aside = def->aside;
	t.along = def->along;
	t.past = fmin(def->past, def->aside);
	t.count = 0;
	t.full = false;
	if (!overlay(&t))
		return -1;
	for (int i = 0; i < t.count; i++) {
		const flat_point *const p = &t.point[i];
		rb_vec3 at = rb_vec3_scale(p->x, axis[0]);

		at = rb_vec3_add_scaled(rb_vec3_add_scaled(at, p->y, axis[1]), p->z, axis[2]);
		out[i] = (rb_overlay_point){at, rb_vec3_add_scaled(at, p->gap, axis[2]), p->gap,
		                            p->a, p->b};
	}
	return t.count;
}
