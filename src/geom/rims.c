/* SPDX-License-Identifier: MIT */
/*
 * A rim of centre c, axis u and radius r is farthest along a unit n at n.c + r sqrt(1 - (n.u)^2).
 * Against a line with direction e the best n is one across e, so there is an angle to be found;
 * against another rim it is anywhere on the sphere, near where it is looked for from. Derivatives
 * follow from that one formula.
 */
#include "geom/rims.h"

#include <float.h>

enum {
	NEWTON_MAX = 60,
	WIDEN_MAX = 4,
	UNCHANGED_MAX = 4, /* steps that are no smaller than the ones before */
	CHANGES_MAX = 3,   /* of the ends of two cylinders */
	TRUSTED_MAX =
		/*
		 * steps that gain less than can be seen: each has twice the digits of the one
		 * before
		 */
	3
};

/*
 * A turn, in radians, after which Newton's next is below rounding, unless bends change a million
 * times faster than turns.
 */
static const double small_step = 0x1p-36;

/* A cylinder and the sense (1 or -1) that turns directions from a to b into those away from it. */
typedef struct {
	const rb_placed *placed;
	rb_vec3 axis;
	double sense, round, half;
} drum;

static drum drum_of(const rb_placed *p, double sense)
{
	return (drum){p, rb_placed_axis(p), sense, p->core->round, p->core->half_height};
}

static void try_away(rb_axis *axis, const drum *d, rb_vec3 away)
{
	rb_axis_try(axis, rb_vec3_scale(d->sense, away));
}

/*
 * What directions n = c x + s y, with x, y and e across each other and c^2 + s^2 = 1, prove: n.w -
 * r |n x u|. The rim's axis has across n what it has along t, which is n a quarter turn on, and
 * along e.
 */
typedef struct {
	rb_vec3 x, y;
	double wx, wy, ux, uy, ue, r;
} family;

/* A turn, by cosine and sine. */
typedef struct {
	double c, s;
} turn;

static rb_vec3 direction(const family *f, turn at)
{
	const rb_vec3 n = rb_vec3_add_scaled(rb_vec3_scale(at.c, f->x), at.s, f->y);

	return rb_vec3_unit(n, f->x);
}

static double slope(const family *f, turn at, double *bend)
{
	const double nw = f->wx * at.c + f->wy * at.s, tw = f->wy * at.c - f->wx * at.s;
	const double nu = f->ux * at.c + f->uy * at.s, tu = f->uy * at.c - f->ux * at.s;
	/* 1 - nu^2 without cancellation */
	const double square = tu * tu + f->ue * f->ue, root = sqrt(square);

	if (!(root > 0)) {
		*bend = 0;
		return tw;
	}
	*bend = -nw + f->r * ((tu * tu - nu * nu) + nu * nu * tu * tu / square) / root;
	return tw + f->r * nu * tu / root;
}

/* By about this angle, exactly a turn: twice the arctangent of half of it. */
static turn turned(turn at, double angle)
{
	const double half = 0.5 * angle, per = 1 / (1 + half * half);
	const double c = (1 - half * half) * per, s = angle * per;

	return (turn){at.c * c - at.s * s, at.s * c + at.c * s};
}

/* Sine of the angle from a to b. */
static double between(turn a, turn b)
{
	return a.c * b.s - a.s * b.c;
}

static turn half_way(turn a, turn b)
{
	const double c = a.c + b.c, s = a.s + b.s, per = 1 / sqrt(c * c + s * s);

	return (turn){c * per, s * per};
}

/* Where the slope falls through zero, near none; false: nowhere within a quarter turn. */
static bool summit(const family *f, turn *out)
{
	static const double widths[WIDEN_MAX] = {0x1p-10, 0x1p-5, 0.25, 2}; /* a quarter turn */
	const turn none = {1, 0};
	double bend, last = 4;
	turn low = none, high = none, at = none;
	const double sense = slope(f, none, &bend) >= 0 ? 1 : -1;
	int unchanged = 0;

	/* uphill, up to a quarter turn */
	for (int i = 0;; i++) {
		if (i == WIDEN_MAX)
			return false;
		const turn there = turned(none, sense * widths[i]);
		if (sense * slope(f, there, &bend) <= 0) {
			*(sense > 0 ? &high : &low) = there;
			break;
		}
		*(sense > 0 ? &low : &high) = there;
		at = there;
	}
	for (int i = 0; i < NEWTON_MAX && unchanged < UNCHANGED_MAX; i++) {
		const double value = slope(f, at, &bend);
		if (value > 0)
			low = at;
		else
			high = at;
		const double step = bend < 0 ? -value / bend : 4;
		const turn next = turned(at, step);
		const bool is_within = fabs(step) < 1 && between(low, next) >= 0 &&
		                       between(next, high) >= 0;
		at = is_within ? next : half_way(low, high);
		/*
		 * the next would be as small as its square; before the bracket, which rounding may
		 * have shut
		 */
		if (fabs(step) <= small_step || !(between(low, high) > 0))
			break;
		/* rounding: there Newton's steps no longer shrink */
		unchanged = is_within && fabs(step) >= 0.5 * last ? unchanged + 1 : 0;
		last = is_within ? fabs(step) : 4;
	}
	*out = at;
	return true;
}

/* The line through `point` along the unit e, against both rims. */
static void line(rb_axis *axis, const drum *d, rb_vec3 point, rb_vec3 e, rb_vec3 guide)
{
	const rb_vec3 away = rb_vec3_scale(d->sense, guide);
	const rb_vec3 way = rb_vec3_sub(point, d->placed->at);
	const rb_vec3 side = rb_vec3_cross(d->axis, e);
	/*
	 * a guide along the line says nothing, and what rounding leaves of it across need not be
	 * across
	 */
	const rb_vec3 left = rb_vec3_reject(away, e);
	const bool guided = rb_vec3_dot(left, left) > 0x1p-20;
	const rb_vec3 x = guided ? rb_vec3_unit(rb_vec3_reject(left, e), left) : rb_vec3_across(e);
	const rb_vec3 y = rb_vec3_cross(e, x);
	turn top;

	if (rb_vec3_dot(side, side) > 256 * DBL_EPSILON * DBL_EPSILON) {
		const rb_vec3 n = rb_vec3_unit(side, side);
		try_away(axis, d, n);
		try_away(axis, d, rb_vec3_neg(n));
	}
	for (int end = -1; end <= 1; end += 2) {
		const rb_vec3 w = rb_vec3_add_scaled(way, -end * d->half, d->axis);
		const family f = {x,
		                  y,
		                  rb_vec3_dot(w, x),
		                  rb_vec3_dot(w, y),
		                  rb_vec3_dot(d->axis, x),
		                  rb_vec3_dot(d->axis, y),
		                  rb_vec3_dot(d->axis, e),
		                  d->round};
		if (!summit(&f, &top))
			continue;
		/*
		 * where the other rim is farther out this one's summit is nearly one, hence worse
		 * than none
		 */
		const rb_vec3 n = direction(&f, top);
		if (end * rb_vec3_dot(n, d->axis) >= 0)
			try_away(axis, d, n);
	}
	/* a line along the mantle */
	const rb_vec3 straight = rb_vec3_reject(way, e);
	const double least = 0x1p-20 * rb_vec3_dot(way, way);
	if (rb_vec3_dot(straight, straight) > least)
		try_away(axis, d, rb_vec3_unit(straight, straight));
}

/*
 * A vertex: outside, the way to it from the nearest point; inside and near the mantle, out through
 * the mantle.
 */
static void vertex(rb_axis *axis, const drum *d, rb_vec3 point)
{
	const rb_vec3 between = rb_vec3_sub(point, d->placed->at);
	const double along = rb_vec3_dot(between, d->axis);
	const rb_vec3 local = rb_mat3_apply_transposed(&d->placed->turn, between);
	const rb_vec3 radial = {local.x, local.y, 0};
	const double distance = rb_vec3_length(radial);
	const rb_vec3 out = rb_mat3_apply(&d->placed->turn,
	                                  rb_vec3_unit(radial, (rb_vec3){1, 0, 0}));
	const double beyond = copysign(fmax(fabs(along) - d->half, 0), along);
	const double aside = fmax(distance - d->round, 0);

	if (aside > 0 || beyond != 0) {
		const rb_vec3 way = rb_vec3_add_scaled(rb_vec3_scale(aside, out), beyond, d->axis);
		try_away(axis, d, rb_vec3_unit(way, out));
	}
	try_away(axis, d, out);
}

static void edge(rb_axis *axis, const drum *d, const rb_placed *other, int i, rb_vec3 guide)
{
	const struct rb_polytope *p = other->core->polytope;
	const rb_vec3 v = p->vertices[p->edges[i][0]], w = p->vertices[p->edges[i][1]];
	const rb_vec3 e = rb_vec3_unit(rb_mat3_apply(&other->turn, rb_vec3_sub(w, v)),
	                               (rb_vec3){0, 0, 1});
	/* from a point of it that is near, for the digits */
	const rb_vec3 p0 = rb_placed_point(other, v);
	const double t = rb_vec3_dot(rb_vec3_sub(d->placed->at, p0), e);

	line(axis, d, rb_vec3_add_scaled(p0, t, e), e, guide);
}

/* The polytope's end of the slab. */
static rb_slab_local end_of(const drum *d, const rb_placed *other, const rb_slab *slab)
{
	return rb_slab_of(other, rb_vec3_scale(-d->sense, slab->normal), slab->depth);
}

/*
 * First the edges where the guide points, mostly the right ones, after which few others can matter.
 */
static void against_polytope(rb_axis *axis, const drum *d, const rb_placed *other,
                             const rb_slab *given, rb_vec3 guide)
{
	const struct rb_polytope *p = other->core->polytope;
	const rb_vec3 there = rb_mat3_apply_transposed(&other->turn,
	                                               rb_vec3_scale(-d->sense, guide));
	const int first = rb_polytope_support(p, there);
	rb_slab slab = *given;

	rb_slab_tighten(&slab, axis);
	rb_slab_local in = end_of(d, other, &slab);
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < p->edge_count; i++) {
			const int v = p->edges[i][0], w = p->edges[i][1];
			if ((v == first || w == first) != (pass == 0) ||
			    (!rb_slab_has(&in, p->vertices[v]) &&
			     !rb_slab_has(&in, p->vertices[w])))
				continue;
			const double before = axis->gap;
			edge(axis, d, other, i, guide);
			if (!(axis->gap > before))
				continue;
			rb_slab_tighten(&slab, axis);
			in = end_of(d, other, &slab);
		}
	}
	for (int i = 0; i < p->vertex_count; i++)
		if (rb_slab_has(&in, p->vertices[i]))
			vertex(axis, d, rb_placed_point(other, p->vertices[i]));
}

/*
 * What n proves of two rims, its gradient, and the second derivatives in the plane of x and y
 * across n.
 */
typedef struct {
	double value, gx, gy, xx, xy, yy;
} climb;

static climb climb_at(rb_vec3 between, const drum *const d[2], rb_vec3 n, rb_vec3 x, rb_vec3 y)
{
	climb c = {.value = rb_vec3_dot(n, between),
	           .gx = rb_vec3_dot(x, between),
	           .gy = rb_vec3_dot(y, between)};

	c.xx = c.yy = -c.value;
	for (int i = 0; i < 2; i++) {
		const rb_vec3 u = d[i]->axis;
		const double p = rb_vec3_dot(n, u), ux = rb_vec3_dot(x, u), uy = rb_vec3_dot(y, u);
		const double root = sqrt(ux * ux + uy * uy), r = d[i]->round;
		if (!(root > 0))
			continue;
		const double cube = r / (root * root * root), along = r * p * p / root;
		c.value -= r * root;
		c.gx += r * p * ux / root;
		c.gy += r * p * uy / root;
		c.xx += cube * ux * ux - along;
		c.xy += cube * ux * uy;
		c.yy += cube * uy * uy - along;
	}
	return c;
}

/*
 * Rim against rim: uphill from n by Newton's steps, shortened until they gain; where they do not,
 * by the gradient.
 */
static void rim_to_rim(rb_axis *axis, const drum *const d[2], rb_vec3 n)
{
	int trusted_steps = 0, changes = -1;
	double last_a = 0, last_b = 0, last_value = -(double)INFINITY;

	for (int i = 0; i < NEWTON_MAX && trusted_steps < TRUSTED_MAX; i++) {
		const rb_vec3 x = rb_vec3_across(n), y = rb_vec3_cross(n, x);
		const double end_a = copysign(d[0]->half, rb_vec3_dot(n, d[0]->axis));
		const double end_b = copysign(d[1]->half, -rb_vec3_dot(n, d[1]->axis));
		/*
		 * to and fro between ends: the best lies across an axis, where a mantle takes over
		 */
		changes += end_a != last_a || end_b != last_b;
		if (changes > CHANGES_MAX)
			break;
		last_a = end_a;
		last_b = end_b;
		rb_vec3 between = rb_vec3_sub(d[1]->placed->at, d[0]->placed->at);
		between = rb_vec3_add_scaled(between, -end_a, d[0]->axis);
		between = rb_vec3_add_scaled(between, end_b, d[1]->axis);
		const climb c = climb_at(between, d, n, x, y);
		const double determinant = c.xx * c.yy - c.xy * c.xy;
		double sx = c.gx, sy = c.gy;
		if (determinant > 0 && c.xx < 0) {
			sx = (c.xy * c.gy - c.yy * c.gx) / determinant;
			sy = (c.xy * c.gx - c.xx * c.gy) / determinant;
		} else {
			const double size = fabs(c.xx) + fabs(c.yy) + fabs(c.xy);
			sx /= size > 0 ? size : 1;
			sy /= size > 0 ? size : 1;
		}
		const double length = sqrt(sx * sx + sy * sy);
		/* a gain below rounding cannot be seen: the last steps are taken on trust */
		const bool trusted = determinant > 0 && c.xx < 0 &&
		                     c.gx * sx + c.gy * sy <= axis->noise;
		/*
		 * gains that should be seen, and are not: a peak, where an end or a mantle takes
		 * over
		 */
		if (!trusted && c.value <= last_value + axis->noise)
			break;
		last_value = c.value;
		trusted_steps += trusted;
		double share = fmin(1, 0.5 / length);
		rb_vec3 next = n;
		for (int half = 0; half < 40; half++, share *= 0.5) {
			next = rb_vec3_add_scaled(rb_vec3_add_scaled(n, share * sx, x), share * sy,
			                          y);
			next = rb_vec3_unit(next, n);
			if (trusted)
				break;
			const rb_vec3 p = rb_vec3_across(next);
			if (climb_at(between, d, next, p, rb_vec3_cross(next, p)).value >= c.value)
				break;
		}
		n = next;
		if (!(length * share > 4 * DBL_EPSILON))
			break;
	}
	rb_axis_try(axis, n);
}

static void against_cylinder(rb_axis *axis, const drum *const d[2], rb_vec3 guide)
{
	const rb_vec3 between = rb_vec3_sub(d[1]->placed->at, d[0]->placed->at);
	const rb_vec3 u = d[0]->axis, v = d[1]->axis;
	const double along_u = rb_vec3_dot(between, u), along_v = -rb_vec3_dot(between, v);

	/*
	 * mantle against rim: the axis as a line; its radius is the same for all directions across
	 * it
	 */
	line(axis, d[0], rb_vec3_add_scaled(d[1]->placed->at, along_v, v), v, guide);
	line(axis, d[1], rb_vec3_add_scaled(d[0]->placed->at, along_u, u), u, guide);
	rim_to_rim(axis, d, guide);
}

void rb_rims(rb_axis *axis, const rb_slab *slab, rb_vec3 guide)
{
	const bool a_is = axis->a->core->kind == RB_CORE_CYLINDER;
	const bool b_is = axis->b->core->kind == RB_CORE_CYLINDER;

	if (a_is && b_is) {
		const drum a = drum_of(axis->a, 1), b = drum_of(axis->b, -1);
		against_cylinder(axis, (const drum *const[2]){&a, &b}, guide);
	} else if (a_is) {
		const drum d = drum_of(axis->a, 1);
		against_polytope(axis, &d, axis->b, slab, guide);
	} else if (b_is) {
		const drum d = drum_of(axis->b, -1);
		against_polytope(axis, &d, axis->a, slab, guide);
	}
}
