/* SPDX-License-Identifier: MIT */
/*
 * Both patches are projected onto the plane across the normal. Their intersection has as corners
 * the corners of one inside of the other and the crossings of their borders; all tests are against
 * the tolerance `aside`, so that corners on a border belong to both. Clipping (Sutherland, Hodgman
 * 1974) is not used: it loses which features made a corner, and these keys find a contact again in
 * the next step.
 */
#include "geom/patch_overlap.h"

#include <float.h>
#include <stddef.h>

#include "base/error.h"

/* Working state: the inputs and the points so far. */
typedef struct {
	const rb_patch *a, *b;
	const rb_overlay_def *def;
	rb_vec3 x, y; /* unit, across n: the axes of the projection */
	rb_overlay_point *out;
	int count;
} table;

/* Projection of a patch, relative to a's first point. */
typedef struct {
	int count; /* 1 of a disc */
	double x[RB_PATCH_MAX], y[RB_PATCH_MAX];
	double length[RB_PATCH_MAX]; /* of the side from here */
	double sense;                /* 1 anticlockwise, -1 clockwise */
} outline;

/* Height of p above the patch along n, m: p minus this times n lies on the patch. */
static double above(const rb_patch *patch, rb_vec3 p, rb_vec3 n)
{
	const rb_vec3 from = rb_vec3_sub(p, patch->point[0]);

	if (patch->kind == RB_PATCH_POINT)
		return rb_vec3_dot(from, n);
	if (patch->kind == RB_PATCH_SEGMENT) {
		const rb_vec3 r = rb_vec3_sub(patch->point[1], patch->point[0]);
		const rb_vec3 across = rb_vec3_reject(r, n);
		const double square = rb_vec3_dot(across, across);
		const double s = square > 0 ? rb_vec3_dot(from, across) / square : 0;
		return rb_vec3_dot(rb_vec3_add_scaled(from, -fmin(fmax(s, 0), 1), r), n);
	}
	/* a face can tilt so much within the depth only if it is tiny: its first point's height */
	const double along = rb_vec3_dot(patch->normal, n);
	if (fabs(along) < 0.5)
		return rb_vec3_dot(from, n);
	return rb_vec3_dot(from, patch->normal) / along;
}

/*
 * Adds a point unless one lies beside it within `aside` in projection: then the first stays, or the
 * lower one if it is lower by more, since a deep patch may have corners above each other. Two
 * points of one feature always count as two: a body may be narrower than `aside`.
 */
static void put(table *t, rb_overlay_point p)
{
	const double near = t->def->aside;

	for (int i = 0; i < t->count; i++) {
		const rb_vec3 d = rb_vec3_sub(p.on_a, t->out[i].on_a);
		if (p.a == t->out[i].a || p.b == t->out[i].b ||
		    !(fabs(rb_vec3_dot(d, t->x)) <= near && fabs(rb_vec3_dot(d, t->y)) <= near))
			continue;
		if (p.gap < t->out[i].gap - near)
			t->out[i] = p;
		return;
	}
	if (t->count < RB_OVERLAY_MAX)
		t->out[t->count++] = p;
}

/*
 * Adds the point p of one patch with its projection along n onto the other; `over` is the other's
 * feature.
 */
static void put_over(table *t, bool from_a, rb_vec3 p, rb_part id, rb_part over)
{
	const rb_vec3 n = t->def->n;
	const double height = above(from_a ? t->b : t->a, p, n);
	const rb_vec3 there = rb_vec3_add_scaled(p, -height, n);

	put(t, from_a ? (rb_overlay_point){p, there, -height, id, over}
	              : (rb_overlay_point){there, p, height, over, id});
}

/* As put_over, onto the other patch as a whole. */
static void put_from(table *t, bool from_a, rb_vec3 p, rb_part id)
{
	put_over(t, from_a, p, id, from_a ? t->b->feature : t->a->feature);
}

/* Every point of one patch, onto the other. */
static void put_points(table *t, bool from_a)
{
	const rb_patch *patch = from_a ? t->a : t->b;

	for (int i = 0; i < patch->count; i++)
		put_from(t, from_a, patch->point[i], patch->id[i]);
}

/* Point at share s of the side from point i, from the nearer end for the digits. */
static rb_vec3 lerp(const rb_patch *patch, int i, double s)
{
	const rb_vec3 p = patch->point[i], q = patch->point[i + 1 < patch->count ? i + 1 : 0];

	return s < 0.5 ? rb_vec3_add_scaled(p, s, rb_vec3_sub(q, p))
	               : rb_vec3_add_scaled(q, s - 1, rb_vec3_sub(q, p));
}

/* Feature of the side from point i. */
static rb_part side_of(const rb_patch *patch, int i)
{
	return patch->kind == RB_PATCH_SEGMENT ? patch->feature : patch->side[i];
}

/*
 * Projects a patch; the orientation of a polygon may be either, since both are seen along one
 * normal.
 */
static outline outline_of(const table *t, const rb_patch *patch)
{
	/* not initialised: clearing it would cost more than all else here */
	outline o;
	double area = 0;

	o.count = patch->count;
	o.sense = 1;
	for (int i = 0; i < o.count; i++) {
		const rb_vec3 d = rb_vec3_sub(patch->point[i], t->a->point[0]);
		o.x[i] = rb_vec3_dot(d, t->x);
		o.y[i] = rb_vec3_dot(d, t->y);
	}
	for (int i = 0; i < o.count; i++) {
		const int next = i + 1 < o.count ? i + 1 : 0;
		const double rx = o.x[next] - o.x[i], ry = o.y[next] - o.y[i];
		o.length[i] = sqrt(rx * rx + ry * ry);
	}
	for (int i = 1; i + 1 < o.count; i++)
		area += (o.x[i] - o.x[0]) * (o.y[i + 1] - o.y[0]) -
		        (o.y[i] - o.y[0]) * (o.x[i + 1] - o.x[0]);
	if (area < 0)
		o.sense = -1;
	return o;
}

/* True within a polygon, or on a segment, with the tolerance `aside`. */
static bool inside(const outline *o, double x, double y, double aside)
{
	for (int i = 0; i < o->count; i++) {
		const int next = i + 1 < o->count ? i + 1 : 0;
		const double rx = o->x[next] - o->x[i], ry = o->y[next] - o->y[i];
		const double px = x - o->x[i], py = y - o->y[i];
		const double length = o->length[i];
		const double cross = rx * py - ry * px, along = rx * px + ry * py;
		if (o->count > 2 ? o->sense * cross < -aside * length
		                 : fabs(cross) > aside * length || along < -aside * length)
			return false;
		/* a segment along the normal has no direction to tell by */
		if (o->count == 2 && length == 0 && px * px + py * py > aside * aside)
			return false;
	}
	return true;
}

/*
 * Where the lines of side i of a and side j of b cross, as shares of their lengths; false where
 * they are parallel to rounding.
 */
static bool crossing_of_lines(const outline *a, int i, const outline *b, int j, double at[2])
{
	const int i1 = i + 1 < a->count ? i + 1 : 0, j1 = j + 1 < b->count ? j + 1 : 0;
	const double rx = a->x[i1] - a->x[i], ry = a->y[i1] - a->y[i];
	const double sx = b->x[j1] - b->x[j], sy = b->y[j1] - b->y[j];
	const double dx = b->x[j] - a->x[i], dy = b->y[j] - a->y[i];
	const double cross = rx * sy - ry * sx;

	if (!(fabs(cross) > 4 * DBL_EPSILON * sqrt((rx * rx + ry * ry) * (sx * sx + sy * sy))))
		return false;
	at[0] = (dx * sy - dy * sx) / cross;
	at[1] = (dx * ry - dy * rx) / cross;
	return true;
}

/*
 * True if both ends of a's side are within `aside` of the line of b's: the sides coincide, and
 * their shared corners are ends, which are found as such.
 */
static bool along_line(const outline *a, int i, const outline *b, int j, double aside)
{
	const int i1 = i + 1 < a->count ? i + 1 : 0, j1 = j + 1 < b->count ? j + 1 : 0;
	const double sx = b->x[j1] - b->x[j], sy = b->y[j1] - b->y[j];
	const double off0 = (a->x[i] - b->x[j]) * sy - (a->y[i] - b->y[j]) * sx;
	const double off1 = (a->x[i1] - b->x[j]) * sy - (a->y[i1] - b->y[j]) * sx;
	const double max = aside * sqrt(sx * sx + sy * sy);

	return fabs(off0) <= max && fabs(off1) <= max;
}

/* True if the sides cross within both of them and do not coincide. */
static bool crossing(const table *t, const outline *a, int i, const outline *b, int j, double at[2])
{
	const double aside = t->def->aside;

	return crossing_of_lines(a, i, b, j, at) && at[0] > 0 && at[0] < 1 && at[1] > 0 &&
	       at[1] < 1 && !along_line(a, i, b, j, aside) && !along_line(b, j, a, i, aside);
}

/* Twice the signed area spanned with side i: its sign is the side of the line. */
static double side_of_line(const outline *o, int i, double x, double y)
{
	const int next = i + 1 < o->count ? i + 1 : 0;

	return (o->x[next] - o->x[i]) * (y - o->y[i]) - (o->y[next] - o->y[i]) * (x - o->x[i]);
}

/* Adds the crossing of two sides: a point on each, the gap between them along n. */
static void put_crossing(table *t, int i, int j, const double at[2])
{
	const rb_vec3 p = lerp(t->a, i, at[0]), q = lerp(t->b, j, at[1]);

	put(t, (rb_overlay_point){p, q, rb_vec3_dot(rb_vec3_sub(q, p), t->def->n), side_of(t->a, i),
	                          side_of(t->b, j)});
}

/* The corners of one patch that lie over the other, or else those beside its border. */
static void put_corners(table *t, bool from_a, const outline *own, const outline *other, bool over)
{
	const double aside = t->def->aside, past = fmin(t->def->past, aside);
	const rb_patch *const patch = from_a ? t->a : t->b;

	for (int i = 0; i < own->count; i++)
		if (inside(other, own->x[i], own->y[i], past) == over &&
		    (over || inside(other, own->x[i], own->y[i], aside)))
			put_from(t, from_a, patch->point[i], patch->id[i]);
}

/*
 * Two patches with sides, not both segments. What they share comes first: of points beside each
 * other the first stays, and one past a border touches nothing.
 */
static void polygons(table *t)
{
	const outline a = outline_of(t, t->a), b = outline_of(t, t->b);
	double at[2];

	put_corners(t, false, &b, &a, true);
	put_corners(t, true, &a, &b, true);
	const int a_sides = a.count > 2 ? a.count : 1, b_sides = b.count > 2 ? b.count : 1;
	for (int i = 0; i < a_sides; i++) {
		double before = side_of_line(&a, i, b.x[0], b.y[0]);
		for (int j = 0; j < b_sides; j++) {
			const int next = j + 1 < b.count ? j + 1 : 0;
			const double after = side_of_line(&a, i, b.x[next], b.y[next]);
			/* both ends on one side of the line: no crossing, the common case */
			const bool straddles = !(before > 0 && after > 0) &&
			                       !(before < 0 && after < 0);
			if (straddles && crossing(t, &a, i, &b, j, at))
				put_crossing(t, i, j, at);
			before = after;
		}
	}
	put_corners(t, false, &b, &a, false);
	put_corners(t, true, &a, &b, false);
}

/*
 * Adds an end of the shared stretch of two segments at shares a_at and b_at of their lengths;
 * a_end, b_end: which end of a, b it is, -1 for a point within.
 */
static void put_end(table *t, const double a_at, const double b_at, int a_end, int b_end)
{
	const rb_vec3 p = lerp(t->a, 0, a_at), q = lerp(t->b, 0, b_at);

	put(t, (rb_overlay_point){p, q, rb_vec3_dot(rb_vec3_sub(q, p), t->def->n),
	                          a_end >= 0 ? t->a->id[a_end] : t->a->feature,
	                          b_end >= 0 ? t->b->id[b_end] : t->b->feature});
}

static double clamped(double s)
{
	return fmin(fmax(s, 0), 1);
}

/*
 * Two segments: the two ends of their shared stretch where they are within `along` of each other
 * over its length, else their crossing or nearest points. Lengths are measured along a's direction.
 */
static void segments(table *t)
{
	const outline a = outline_of(t, t->a), b = outline_of(t, t->b);
	const double rx = a.x[1] - a.x[0], ry = a.y[1] - a.y[0];
	const double length = sqrt(rx * rx + ry * ry);
	double along[2], aside[2], at[2];

	if (!(length > 0)) {
		put_end(t, 0.5, 0.5, -1, -1);
		return;
	}
	for (int j = 0; j < 2; j++) {
		const double dx = b.x[j] - a.x[0], dy = b.y[j] - a.y[0];
		along[j] = (rx * dx + ry * dy) / length;
		aside[j] = (rx * dy - ry * dx) / length;
	}
	const int first = along[0] <= along[1] ? 0 : 1;
	const double from = fmax(0, along[first]), to = fmin(length, along[1 - first]);
	const double span = along[1 - first] - along[first];
	const double drift = span > 0 ? (aside[1 - first] - aside[first]) / span : 0;
	const double off_from = aside[first] + drift * (from - along[first]);
	const double off_to = aside[first] + drift * (to - along[first]);
	const bool together = span > 0 && to > from && fabs(off_from) <= t->def->along &&
	                      fabs(off_to) <= t->def->along;
	if (!together) {
		/* End to end, or parallel at less than rounding: the middle between the ends. */
		if (!crossing_of_lines(&a, 0, &b, 0, at)) {
			const double middle = 0.5 * (from + to);
			at[0] = middle / length;
			at[1] = first ? 1 - (middle - along[first]) / span
			              : (middle - along[first]) / span;
		}
		at[0] = clamped(at[0]);
		at[1] = clamped(at[1]);
		put_crossing(t, 0, 0, at);
		return;
	}
	const double near = t->def->aside, ends[2] = {from, to};
	for (int k = 0; k < 2; k++) {
		const int b_end = k ? 1 - first : first;
		const double share = clamped((ends[k] - along[first]) / span);
		const bool of_a = fabs(ends[k] - (k ? length : 0)) <= near;
		const bool of_b = fabs(ends[k] - along[b_end]) <= near;
		put_end(t, clamped(ends[k] / length), first ? 1 - share : share, of_a ? k : -1,
		        of_b ? b_end : -1);
	}
}

/* Adds the rim's point in direction `way` if it lies over the other patch; `place` is its key. */
static void put_rim(table *t, bool of_a, rb_vec3 way, int place, const outline *within)
{
	const rb_patch *disc = of_a ? t->a : t->b, *other = of_a ? t->b : t->a;
	const rb_vec3 p = rb_vec3_add_scaled(disc->point[0], disc->round, way);
	const rb_vec3 d = rb_vec3_sub(p, t->a->point[0]);
	const double px = rb_vec3_dot(d, t->x), py = rb_vec3_dot(d, t->y);
	bool in = other->kind == RB_PATCH_PLANE;

	if (other->kind == RB_PATCH_DISC) {
		const double dx = px - within->x[0], dy = py - within->y[0];
		in = sqrt(dx * dx + dy * dy) <= other->round + t->def->aside;
	} else if (!in) {
		in = within->count > 2 && inside(within, px, py, t->def->aside);
	}
	if (in)
		put_from(t, of_a, p, disc->id[0] | (rb_part)place << 1);
}

/*
 * Adds the quarter points of a rim, counted from a direction of the other body so that they stay
 * when the disc spins; of a tilted disc its eighths, counted from its lowest point.
 */
static void rim(table *t, bool of_a, const outline *within)
{
	const rb_patch *disc = of_a ? t->a : t->b, *other = of_a ? t->b : t->a;
	const bool tilts = rb_vec3_dot(disc->low, disc->low) > 0;
	const rb_vec3 from = tilts ? disc->low : rb_vec3_reject(other->axis, disc->normal);
	const rb_vec3 x = rb_vec3_unit(from, rb_vec3_across(disc->normal));
	/* counted about n for both bodies, in the disc's own plane */
	const rb_vec3 left = rb_vec3_cross(disc->normal, x);
	const rb_vec3 y = rb_vec3_dot(disc->normal, t->def->n) < 0 ? rb_vec3_neg(left) : left;
	const rb_vec3 way[4] = {x, y, rb_vec3_neg(x), rb_vec3_neg(y)};

	for (int k = 0; k < 4; k++)
		put_rim(t, of_a, way[k], (tilts ? 8 : 1) + k, within);
	for (int k = 0; k < 4 && tilts; k++) {
		const rb_vec3 between = rb_vec3_add(way[k], way[(k + 1) % 4]);
		put_rim(t, of_a, rb_vec3_scale(0.70710678118654752, between), 12 + k, within);
	}
}

/*
 * Is a side given against its own direction? That of an edge is from its lower vertex, that of a
 * mantle's line from the end at -z.
 */
static bool is_reversed(const rb_patch *patch, int i)
{
	const rb_part from = patch->id[i], to = patch->id[i + 1 < patch->count ? i + 1 : 0];

	return from >> 24 == RB_PART_MANTLE ? from < to : from > to;
}

/*
 * A polygon or segment over a disc. Of two crossings the first is that which a side comes to first.
 */
static void disc_and_sides(table *t, bool disc_is_a)
{
	const rb_patch *disc = disc_is_a ? t->a : t->b, *flat = disc_is_a ? t->b : t->a;
	const outline o = outline_of(t, flat), centre = outline_of(t, disc);
	const double r = disc->round, cx = centre.x[0], cy = centre.y[0];

	for (int i = 0; i < o.count; i++) {
		const double dx = o.x[i] - cx, dy = o.y[i] - cy;
		if (sqrt(dx * dx + dy * dy) <= r + t->def->aside)
			put_from(t, !disc_is_a, flat->point[i], flat->id[i]);
	}
	const int sides = o.count > 2 ? o.count : 1;
	for (int i = 0; i < sides; i++) {
		const int next = i + 1 < o.count ? i + 1 : 0;
		const double sx = o.x[next] - o.x[i], sy = o.y[next] - o.y[i];
		const double length = sqrt(sx * sx + sy * sy);
		const double dx = cx - o.x[i], dy = cy - o.y[i];
		const double foot = (dx * sx + dy * sy) / length;
		const double off = (dx * sy - dy * sx) / length;
		/*
		 * A side that grazes the rim does not cross it: its two crossings would move apart
		 * by the root of any displacement.
		 */
		if (!(length > 0 && fabs(off) < r - t->def->aside))
			continue;
		const double half = sqrt((r - off) * (r + off));
		for (int end = 0; end < 2; end++) {
			const double s = (end ? foot + half : foot - half) / length;
			const int place = is_reversed(flat, i) ? 6 - end : 5 + end;
			if (s > 0 && s < 1)
				put_over(t, !disc_is_a, lerp(flat, i, s), side_of(flat, i),
				         disc->id[0] | (rb_part)place << 1);
		}
	}
	rim(t, disc_is_a, &o);
}

/* Two discs: rim points of each over the other, and the two crossings of the rims. */
static void discs(table *t)
{
	const outline a = outline_of(t, t->a), b = outline_of(t, t->b);
	const double dx = b.x[0] - a.x[0], dy = b.y[0] - a.y[0];
	const double d = sqrt(dx * dx + dy * dy), p = t->a->round, q = t->b->round;

	rim(t, true, &b);
	rim(t, false, &a);
	if (!(d < p + q - t->def->aside && d > fabs(p - q) + t->def->aside))
		return;
	/* distance from a's centre to the radical line, (d^2 + p^2 - q^2) / 2d, factored */
	const double foot = 0.5 * (d + (p - q) * (p + q) / d);
	const double half = sqrt(fmax((p - foot) * (p + foot), 0));
	for (int k = 0; k < 2; k++) {
		const double side = k ? -half : half;
		const double x = (foot * dx - side * dy) / d, y = (foot * dy + side * dx) / d;
		rb_vec3 at = rb_vec3_add_scaled(t->a->point[0], x, t->x);
		at = rb_vec3_add_scaled(at, y, t->y);
		at = rb_vec3_add_scaled(at, -above(t->a, at, t->def->n), t->def->n);
		put_from(t, true, at, t->a->id[0] | (rb_part)(5 + k) << 1);
	}
}

static bool has_sides(const rb_patch *patch)
{
	return patch->kind == RB_PATCH_SEGMENT || patch->kind == RB_PATCH_POLYGON;
}

double rb_overlay_margin(const rb_patch *patch, rb_vec3 point, rb_vec3 n)
{
	const double none = (double)INFINITY;
	double least = none, max = -none;

	if (patch->kind == RB_PATCH_PLANE)
		return none;
	if (patch->kind == RB_PATCH_DISC)
		return patch->round -
		       rb_vec3_length(rb_vec3_reject(rb_vec3_sub(point, patch->point[0]), n));
	if (patch->kind != RB_PATCH_POLYGON)
		return -none;
	for (int i = 0; i < patch->count; i++) {
		const rb_vec3 here = patch->point[i];
		const rb_vec3 side = rb_vec3_sub(patch->point[i + 1 < patch->count ? i + 1 : 0],
		                                 here);
		const rb_vec3 in = rb_vec3_cross(n, side);
		const double off = rb_vec3_dot(in, rb_vec3_sub(point, here)) / rb_vec3_length(in);

		least = fmin(least, off);
		max = fmax(max, off);
	}
	/* a polygon clockwise about n has all signs reversed */
	return fmax(least, -max);
}

/* True if a point patch lies past the border of a face: they share nothing. */
static bool misses(const rb_patch *point, const rb_patch *other, const rb_overlay_def *def)
{
	return point->kind == RB_PATCH_POINT &&
	       (other->kind == RB_PATCH_POLYGON || other->kind == RB_PATCH_DISC) &&
	       rb_overlay_margin(other, point->point[0], def->n) < -def->aside;
}

int rb_overlay(const rb_patch *a, const rb_patch *b, const rb_overlay_def *def,
               rb_overlay_point out[RB_OVERLAY_MAX])
{
	RB_ASSERT_COSTLY(a->count >= 1 && a->count <= RB_PATCH_MAX);
	RB_ASSERT_COSTLY(b->count >= 1 && b->count <= RB_PATCH_MAX);
	RB_ASSERT_COSTLY(!(def->aside < 0) && !(def->along < 0));
	const rb_vec3 x = rb_vec3_across(def->n);
	table t = {a, b, def, x, rb_vec3_cross(def->n, x), out, 0};

	if (misses(a, b, def) || misses(b, a, def))
		return 0;
	if (a->kind == RB_PATCH_POINT || (b->kind == RB_PATCH_PLANE && has_sides(a)))
		put_points(&t, true);
	else if (b->kind == RB_PATCH_POINT || (a->kind == RB_PATCH_PLANE && has_sides(b)))
		put_points(&t, false);
	else if (a->kind == RB_PATCH_PLANE || b->kind == RB_PATCH_PLANE)
		rim(&t, a->kind == RB_PATCH_DISC, NULL);
	else if (a->kind == RB_PATCH_DISC && b->kind == RB_PATCH_DISC)
		discs(&t);
	else if (a->kind == RB_PATCH_DISC || b->kind == RB_PATCH_DISC)
		disc_and_sides(&t, a->kind == RB_PATCH_DISC);
	else if (a->kind == RB_PATCH_SEGMENT && b->kind == RB_PATCH_SEGMENT)
		segments(&t);
	else
		polygons(&t);
	RB_ASSERT_COSTLY(t.count >= 0 && t.count <= RB_OVERLAY_MAX);
	return t.count;
}
