/* SPDX-License-Identifier: MIT */
/*
 * A rim of centre c, axis u and radius r is farthest along a unit n at n.c + r sqrt(1 - (n.u)^2).
 * Against a line with direction e the best n is one across e, so there is an angle to be found;
 * against another rim it is anywhere on the sphere, near where it is looked for from. Derivatives
 * follow from that one formula.
 *
 * The gap is a minimum of concave-like pieces only on each family, so Newton's method is guarded: a
 * bracket in one dimension, a line search with a gradient fallback in two. Polynomial forms (the
 * distance of two circles is of degree 8) are not used because their coefficients lose half of the
 * digits near contact.
 */
#include "geom/rims.h"

#include <float.h>

#include "base/error.h"

enum {
	NEWTON_MAX = 60, /* as many as bisection would need; Newton takes about five */
	WIDEN_MAX = 4,
	UNCHANGED_MAX = 4, /* steps that are no smaller than the ones before */
	CHANGES_MAX = 3,   /* of the ends of two cylinders */
	TRUSTED_MAX =
		/* steps whose gain is below rounding; each doubles the correct digits */
	3
};

/*
 * Step in radians after which Newton's next one, about its square, is below rounding: its square is
 * 2^-72, a factor 2^20 below an ulp for ratios of third to second derivatives.
 */
static const double small_step = 0x1p-36;

/* Share of a cylinder's size by which its rim may be in a line and count as apart from it. */
static const double separate_share = 1e-4;

/* A cylinder; `sense` (1 of a, -1 of b) times a direction from a to b points away from it. */
typedef struct {
	const rb_placed *placed;
	rb_vec3 axis;
	double sense, round, half;
} drum;

static drum drum_of(const rb_placed *p, double sense)
{
	RB_ASSERT_COSTLY(p->core->kind == RB_CORE_CYLINDER);
	RB_ASSERT_COSTLY(sense == 1 || sense == -1);

	return (drum){p, rb_placed_axis(p), sense, p->core->round, p->core->half_height};
}

/* `max`: m, it proves no more, as points of both are no farther apart along it. */
static void try_away(rb_axis *axis, const drum *d, rb_vec3 away, double max)
{
	if (!(max <= axis->gap))
		rb_axis_try(axis, rb_vec3_scale(d->sense, away));
}

/*
 * Gaps that directions n = c x + s y with c^2 + s^2 = 1 prove of a rim against a line along e: n.w
 * - r
 * n x u|, where (x, y, e) is orthonormal and w leads from the rim's centre to the line. |n x u| is
 * formed from the components of u along t = dn/dangle and e, without cancellation.
 */
typedef struct {
	rb_vec3 x, y;
	double wx, wy, ux, uy, ue, r;
} family;

/* Cosine and sine of an angle; no trigonometric function is evaluated. */
typedef struct {
	double c, s;
} turn;

/* The unit vector of the family at a turn. */
static rb_vec3 direction(const family *f, turn at)
{
	const rb_vec3 n = rb_vec3_add_scaled(rb_vec3_scale(at.c, f->x), at.s, f->y);

	return rb_vec3_unit(n, f->x);
}

/* Derivative of the proven gap by the angle; `*bend` is the second derivative. */
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

/* Turns by 2 atan(angle / 2), which is exact as a rotation and close to the angle. */
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

/*
 * Maximum of the family within a quarter turn of {1, 0}: a bracket widened uphill, then Newton's
 * method, bisecting where a step leaves the bracket. False if there is none.
 */
static bool summit(const family *f, turn *out)
{
	static const double widths[WIDEN_MAX] = {0x1p-10, 0x1p-5, 0.25, 2}; /* a quarter turn */
	const turn none = {1, 0};
	double bend, last = 4;
	turn low = none, high = none, at = none;
	const double sense = slope(f, none, &bend) >= 0 ? 1 : -1;
	int unchanged = 0;

	/* bracket: uphill, up to a quarter turn */
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
		/* Converged; tested before the bracket, which rounding may have closed. */
		if (fabs(step) <= small_step || !(between(low, high) > 0))
			break;
		/* where only rounding is left, Newton's steps no longer shrink */
		unchanged = is_within && fabs(step) >= 0.5 * last ? unchanged + 1 : 0;
		last = is_within ? fabs(step) : 4;
	}
	*out = at;
	return true;
}

/*
 * Tries the directions between the line through `point` along the unit vector e and the cylinder:
 * each rim, the axis crossed with the line, and the mantle where the line is along it.
 */
static void line(rb_axis *axis, const drum *d, rb_vec3 point, rb_vec3 e, rb_vec3 guide)
{
	const rb_vec3 away = rb_vec3_scale(d->sense, guide);
	const rb_vec3 way = rb_vec3_sub(point, d->placed->at);
	const rb_vec3 side = rb_vec3_cross(d->axis, e);
	/*
	 * A guide along the line says nothing, and the rest that rounding leaves need not be across
	 * it; 2^-20 is the square of 1 mrad.
	 */
	const rb_vec3 left = rb_vec3_reject(away, e);
	const bool guided = rb_vec3_dot(left, left) > 0x1p-20;
	const rb_vec3 x = guided ? rb_vec3_unit(rb_vec3_reject(left, e), left) : rb_vec3_across(e);
	const rb_vec3 y = rb_vec3_cross(e, x);
	turn top;

	if (rb_vec3_dot(side, side) > 256 * DBL_EPSILON * DBL_EPSILON) {
		const rb_vec3 n = rb_vec3_unit(side, side);
		const double between = rb_vec3_dot(n, way);

		try_away(axis, d, n, between - d->round);
		try_away(axis, d, rb_vec3_neg(n), -between - d->round);
	}
	/* the rim on the side of the guide first */
	const int first = rb_vec3_dot(x, d->axis) < 0 ? -1 : 1;
	for (int k = 0; k < 2; k++) {
		const int end = k == 0 ? first : -first;
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
		 * where the other rim is farther out, the maximum of this one proves less than is
		 * proven already
		 */
		const rb_vec3 n = direction(&f, top);
		if (!(end * rb_vec3_dot(n, d->axis) >= 0))
			continue;
		const double max = rb_vec3_dot(n, w) -
		                   d->round * rb_vec3_length(rb_vec3_cross(n, d->axis));
		try_away(axis, d, n, max);
		/* what both rims prove is concave above zero: there is no other maximum */
		if (max > -separate_share * (d->round + d->half))
			break;
	}
	/*
	 * a line parallel to the axis: straight out; not defined where it passes through the centre
	 */
	const rb_vec3 straight = rb_vec3_reject(way, e);
	const double least = 0x1p-20 * rb_vec3_dot(way, way);
	if (rb_vec3_dot(straight, straight) > least)
		try_away(axis, d, rb_vec3_unit(straight, straight), rb_vec3_length(straight));
}

/*
 * Tries a vertex: outside, the vector from the nearest point of the cylinder; and the radial
 * direction, out through the mantle.
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
		try_away(axis, d, rb_vec3_unit(way, out), rb_vec3_length(way));
	}
	try_away(axis, d, out, distance - d->round);
}

/* Tries edge i of the polytope. */
static void edge(rb_axis *axis, const drum *d, const rb_placed *other, int i, rb_vec3 guide)
{
	const struct rb_polytope *p = other->core->polytope;
	const rb_vec3 v = p->vertices[p->edges[i][0]], w = p->vertices[p->edges[i][1]];
	const rb_vec3 e = rb_vec3_unit(rb_mat3_apply(&other->turn, rb_vec3_sub(w, v)),
	                               (rb_vec3){0, 0, 1});
	/* relative to the point of the edge nearest to the cylinder, for the digits */
	const rb_vec3 p0 = rb_placed_point(other, v);
	const double t = rb_vec3_dot(rb_vec3_sub(d->placed->at, p0), e);

	line(axis, d, rb_vec3_add_scaled(p0, t, e), e, guide);
}

/* The slab in the polytope's own axes. */
static rb_slab_local end_of(const drum *d, const rb_placed *other, const rb_slab *slab)
{
	return rb_slab_of(other, rb_vec3_scale(-d->sense, slab->normal), slab->depth);
}

/*
 * Edges at the vertex where the guide points come first: mostly the best is among them, and the
 * tightened slab then excludes nearly all others.
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

/* Gap that n proves of two rims with its gradient and Hessian in the tangent plane (x, y) at n. */
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
 * Maximum over the sphere from n on, by Newton's steps shortened until the value grows; by the
 * gradient where the Hessian is not negative definite.
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
		 * jumps between ends: the maximum lies across an axis, where the mantle is the
		 * feature
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
		/* gains below rounding cannot be measured: the last steps are not checked */
		const bool trusted = determinant > 0 && c.xx < 0 &&
		                     c.gx * sx + c.gy * sy <= axis->noise;
		/*
		 * a gain that should be measurable and is not: a ridge, where an end or a mantle
		 * takes over
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
	 * Mantle against rim: the axis as a line, since the radius is the same in all directions
	 * across it.
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
