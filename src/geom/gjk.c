/* SPDX-License-Identifier: MIT */
/*
 * Gilbert, Johnson, Keerthi, IEEE J. Robotics and Automation 4 (1988) 193. The point nearest to the
 * origin of a simplex within the Minkowski difference b - a is an upper bound of the distance; the
 * support plane across it is a lower one. The simplex keeps the points that span the nearest one
 * and takes the support point of that direction, until both bounds agree to rounding.
 *
 * Every vertex, edge and triangle with the newest point is evaluated and the nearest wins. That
 * takes a few products more than Johnson's recursion or signed volumes, but no sign that rounding
 * could flip decides anything.
 */
#include "geom/gjk.h"

#include <float.h>

#include "base/error.h"

/* Of a distance, what may be left of it where only its direction is asked for. */
static const double coarse_share = 0x1p-6;
enum {
	ROUNDS_MAX = 200, /* polytopes take some ten, round cores some tens */
	UNCHANGED_MAX = 3 /* rounds in which neither bound moves by `noise`: stalled by rounding */
};

/* Points of the Minkowski difference b - a, the newest last. */
typedef struct {
	rb_vec3 w[4];
	int count;
} simplex;

/* Point of a simplex nearest to the origin, its squared length, and the points that span it. */
typedef struct {
	rb_vec3 v;
	double square;
	simplex part;
} nearest;

/* Nearest candidate so far; bit i of `points` is set if w[i] spans it. */
typedef struct {
	rb_vec3 v;
	double square;
	unsigned points;
} offers;

static void offer(offers *best, rb_vec3 v, unsigned points)
{
	const double square = rb_vec3_dot(v, v);

	if (square < best->square)
		*best = (offers){v, square, points};
}

/*
 * The foot of the origin on the edge i-last if it lies strictly within; the ends are offers
 * themselves.
 */
static void offer_edge(offers *best, const rb_vec3 *w, int i, int last)
{
	const rb_vec3 a = w[i], ab = rb_vec3_sub(w[last], a);
	const double square = rb_vec3_dot(ab, ab), t = -rb_vec3_dot(a, ab);

	if (t > 0 && t < square)
		offer(best, rb_vec3_add_scaled(a, t / square, ab), 1u << i | 1u << last);
}

/* The foot on the triangle if it lies strictly within, by signs of the barycentric coordinates. */
static void offer_triangle(offers *best, const rb_vec3 *w, int i, int j, int last)
{
	const rb_vec3 a = w[i], b = w[j], c = w[last];
	const rb_vec3 n = rb_vec3_cross(rb_vec3_sub(b, a), rb_vec3_sub(c, a));
	const double square = rb_vec3_dot(n, n);

	if (!(square > 0) || rb_vec3_dot(n, rb_vec3_cross(b, c)) <= 0 ||
	    rb_vec3_dot(n, rb_vec3_cross(c, a)) <= 0 || rb_vec3_dot(n, rb_vec3_cross(a, b)) <= 0)
		return;
	offer(best, rb_vec3_scale(rb_vec3_dot(n, a) / square, n), 1u << i | 1u << j | 1u << last);
}

/* Six times the signed volume of a tetrahedron. */
static double volume(rb_vec3 a, rb_vec3 b, rb_vec3 c, rb_vec3 d)
{
	return rb_vec3_dot(rb_vec3_sub(d, a), rb_vec3_cross(rb_vec3_sub(b, a), rb_vec3_sub(c, a)));
}

/*
 * True if the origin is strictly inside of the tetrahedron: replacing a vertex by it keeps the sign
 * of the volume. A flat tetrahedron holds nothing.
 */
static bool holds_origin(const simplex *s)
{
	const rb_vec3 o = {0, 0, 0}, *w = s->w;
	const double whole = volume(w[0], w[1], w[2], w[3]);
	const double part[4] = {volume(o, w[1], w[2], w[3]), volume(w[0], o, w[2], w[3]),
	                        volume(w[0], w[1], o, w[3]), volume(w[0], w[1], w[2], o)};

	for (int i = 0; i < 4; i++)
		if (!(whole > 0 ? part[i] > 0 : part[i] < 0))
			return false;
	return whole != 0;
}

/*
 * Point of the simplex nearest to the origin among the parts that contain the newest point w[count
 * - 1]: the nearest point of the others was the last result already.
 */
static nearest inspect(const simplex *s)
{
	RB_ASSERT_COSTLY(s->count >= 1 && s->count <= 4);

	const int last = s->count - 1;
	offers best = {s->w[last], rb_vec3_dot(s->w[last], s->w[last]), 1u << last};

	for (int i = 0; i < last; i++) {
		offer_edge(&best, s->w, i, last);
		for (int j = i + 1; j < last; j++)
			offer_triangle(&best, s->w, i, j, last);
	}
	nearest out; /* its points as far as `count` says */
	out.v = best.v;
	out.square = best.square;
	out.part.count = 0;
	for (int i = 0; i <= last; i++)
		if (best.points >> i & 1)
			out.part.w[out.part.count++] = s->w[i];
	return out;
}

/* A support point found before cannot bring the simplex nearer: the search has converged. */
static bool has(const simplex *s, rb_vec3 w)
{
	for (int i = 0; i < s->count; i++)
		if (s->w[i].x == w.x && s->w[i].y == w.y && s->w[i].z == w.z)
			return true;
	return false;
}

double rb_gjk_beyond(const rb_placed *a, const rb_placed *b, double limit, int rounds,
                     rb_vec3 *axis)
{
	rb_vec3 d = rb_vec3_dot(*axis, *axis) > 0 ? *axis : rb_vec3_sub(b->at, a->at);
	nearest now = {.square = (double)INFINITY};
	const double close = limit > 0 ? limit * limit : 0;

	for (int round = 0; round < rounds; round++) {
		const rb_vec3 n = rb_vec3_unit(d, (rb_vec3){0, 0, 1});
		const rb_vec3 w = rb_vec3_sub(rb_placed_support(b, rb_vec3_neg(n)),
		                              rb_placed_support(a, n));
		*axis = n;
		const double proved = rb_vec3_dot(w, n);
		if (proved > limit)
			return proved;
		if (round + 1 == rounds || has(&now.part, w))
			break;
		RB_ASSERT_COSTLY(now.part.count < 4);
		now.part.w[now.part.count++] = w;
		if (now.part.count == 4 && holds_origin(&now.part))
			break;
		const nearest next = inspect(&now.part);
		if (!(next.square < now.square) || next.square <= close)
			break;
		now = next;
		d = now.v;
	}
	return -(double)INFINITY;
}

/* Whether a distance is known to be small, or to a share of itself. */
static bool is_coarse(const rb_gjk *out, double small)
{
	const double doubt = out->upper - out->least;

	return isfinite(out->upper) &&
	       doubt <= (out->upper <= small ? small : coarse_share * out->upper);
}

rb_gjk rb_gjk_run(const rb_placed *a, const rb_placed *b, double scale, double small)
{
	const double noise = 4 * DBL_EPSILON * scale;
	rb_vec3 d = rb_vec3_sub(b->at, a->at);
	rb_gjk out = {.least = -(double)INFINITY, .upper = (double)INFINITY};
	nearest now = {.square = (double)INFINITY};
	int unchanged = 0;

	if (!(rb_vec3_dot(d, d) > 0))
		d = (rb_vec3){0, 0, 1};
	for (out.rounds = 1; out.rounds <= ROUNDS_MAX; out.rounds++) {
		const rb_vec3 n = rb_vec3_unit(d, (rb_vec3){0, 0, 1});
		const rb_vec3 w = rb_vec3_sub(rb_placed_support(b, rb_vec3_neg(n)),
		                              rb_placed_support(a, n));
		const double least = rb_vec3_dot(w, n);
		unchanged++;
		if (least > out.least) {
			unchanged = least > out.least + noise ? 0 : unchanged;
			out.least = least;
			out.normal = n;
		}
		if (out.upper - out.least <= noise || has(&now.part, w) ||
		    unchanged > UNCHANGED_MAX || (small > 0 && is_coarse(&out, small)))
			break;
		RB_ASSERT_COSTLY(now.part.count < 4);
		now.part.w[now.part.count++] = w;
		if (now.part.count == 4 && holds_origin(&now.part))
			return out;
		const nearest next = inspect(&now.part);
		if (!(next.square < now.square))
			break;
		now = next;
		if (sqrt(now.square) < out.upper - noise)
			unchanged = 0;
		out.upper = sqrt(now.square);
		/* within rounding of contact the direction to the origin has no digits left */
		if (out.upper <= 4 * noise)
			return out;
		d = now.v;
	}
	out.is_separate = out.least > 0;
	return out;
}
