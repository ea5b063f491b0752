/* SPDX-License-Identifier: MIT */
/*
 * Along any direction n, the separation of the two bodies is a lower bound of their gap. So n may
 * move with a face, with two edges, or stay: heights of corners along it have a value, a rate and
 * bounded second derivatives, and the gap stays above the lowest of these parabolas. Where the
 * bound follows the true gap to first order the steps converge like Newton's. Where it does not
 * (round rims, silhouettes that n does not describe), the search takes tiny steps, over which an
 * overlap that is missed is below the rounding of sizes.
 */
#include "located/approach.h"

#include "located/crowd.h"

#include "base/error.h"

#include <float.h>
#include <stddef.h>

#include "located/bounds.h"
#include "located/closing.h"
#include "located/extent.h"
#include "located/feature.h"
#include "model/parts.h"

/*
 * Steps before the search is continued in another event; iterations for the lowest parabola;
 * halvings of a bracket, more than a double has bits; depth of a dip that need not be found, ulp;
 * steps of a rotation's series that a search covers.
 */
enum { STEPS_MAX = 64, CORNER_ITERATIONS = 32, HALVINGS = 200, DIP_ULP = 4, SERIES_MAX = 4096 };

/*
 * Smallest steps, as a share of the size travelled: a dip between their ends is at most the square
 * of it deep (2^-40 to 2^-26 of the size). They double, up to the last, while nothing is found.
 */
static const double min_share_first = 0x1p-20, min_share_last = 0x1p-13;
/* Step of the difference quotient for a direction's rate, as a share of the size travelled. */
static const double moment_share = 0x1p-20;

/*
 * Typical number of facets of a terrain that a search examines; only the counted cost depends on
 * it.
 */
enum { FACETS_NEAR = 8 };

/* The pair under search: what holds for the whole search, then what holds at the present time. */
struct search_state {
	const struct rb_located *l;
	struct rb_touch_pair pair; /* at pair.t */
	struct rb_bounds of_a, of_b;
	struct rb_extent a, b;
	double size; /* m: size of the smaller body that has one */
	bool flies;  /* both on parabolas: `external` is their relative acceleration */
	rb_vec3 external;
	double external_max; /* m/s^2: bound of one centre's acceleration relative to the other */
	bool decays_alike; /* on arcs of equal drag, or fixed: relative accelerations decay alike */

	/* at the present time */
	double speed; /* m/s: bound of the relative speed of any two points, with rotation */
	double noise, band;
	double horizon_s; /* time for which the bounds hold */
	double turn_a, turn_b, turning_a, turning_b;
	/* m/s^2: of a point, due to rotation; the same of what rb_extent calls centres */
	double bend_a, bend_b, swing_a, swing_b;
};

/* Bounds and extents, which hold for the whole search. */
static void start(struct search_state *c, const struct rb_located *l, int a, int b)
{
	*c = (struct search_state){.l = l, .pair = {.a = a, .b = b}};
	c->of_a = rb_bounds_of(l, a);
	c->of_b = rb_bounds_of(l, b);
	c->a = rb_extent_of(l, a, c->of_a.axis);
	c->b = rb_extent_of(l, b, c->of_b.axis);
	c->size = fmin(c->a.ball, c->b.ball);
	c->flies = !rb_located_on_piece(l, a) && !rb_located_on_piece(l, b) &&
	           !(rb_arc_decay(l, a) > 0) && !(rb_arc_decay(l, b) > 0);
	c->decays_alike = !rb_located_on_piece(l, a) && !rb_located_on_piece(l, b) &&
	                  (a >= l->n || b >= l->n || rb_arc_decay(l, a) == rb_arc_decay(l, b));
	c->external_max = c->of_a.own_external + c->of_b.own_external;
	if (c->flies) {
		c->external = rb_vec3_sub(rb_arc_acceleration(l, b, 0),
		                          rb_arc_acceleration(l, a, 0));
		c->external_max = rb_vec3_length(c->external);
	}
}

/* Lever arm of the body's points, m; for a rotating plane, as far out as the other body is. */
static double arm_of(const struct search_state *c, double ball, double other)
{
	if (isfinite(ball))
		return ball;
	return other + rb_vec3_length(rb_pose_between(&c->pair.pose_a, &c->pair.pose_b));
}

/*
 * Bounds of one body's rotation over the horizon: *turn, angular speed; *bend, *swing: acceleration
 * of its points and centres. Returns the largest speed of its points, m/s.
 */
static double bound_rotation(struct search_state *c, bool is_a, double *turn, double *bend,
                             double *swing)
{
	struct rb_bounds *max = is_a ? &c->of_a : &c->of_b;
	const struct rb_extent *own = is_a ? &c->a : &c->b, *other = is_a ? &c->b : &c->a;
	const struct rb_pose *pose = is_a ? &c->pair.pose_a : &c->pair.pose_b;

	if (max->growing > 0) {
		max->turn = rb_vec3_length(pose->spin) + max->growing * c->horizon_s;
		max->axis_turn = max->turn;
		max->axis_bend = max->turn * max->turn + max->turning;
	}
	*turn = max->turn;
	const double quick = *turn * *turn + max->turning;
	*bend = *swing = 0;
	if (!(quick > 0))
		return 0;
	if (!isfinite(own->ball)) {
		const double arm = arm_of(c, own->ball, other->ball);

		*bend = *swing = quick * arm;
		return *turn * arm;
	}
	*bend = rb_extent_bend(&own->points, max);
	*swing = rb_extent_bend(&own->centres, max);
	return fmin(max->axis_turn * own->points.along + *turn * own->points.across,
	            *turn * own->points.core);
}

/* Moves the pair to time t and updates what depends on it. */
static void place(struct search_state *c, double t, double until)
{
	RB_ASSERT_COSTLY(t <= until);

	const struct rb_located *l = c->l;

	c->pair.t = t;
	c->pair.pose_a = rb_arc_pose(l, c->pair.a, t);
	c->pair.pose_b = rb_arc_pose(l, c->pair.b, t);
	c->turning_a = c->of_a.turning;
	c->turning_b = c->of_b.turning;
	/*
	 * a growing spin is bounded over the time in which it doubles or, from rest, turns by a
	 * radian
	 */
	const double growing = fmax(c->of_a.growing, c->of_b.growing);
	const double fastest = fmax(rb_vec3_length(c->pair.pose_a.spin),
	                            rb_vec3_length(c->pair.pose_b.spin));
	c->horizon_s = until - t;
	if (growing > 0)
		c->horizon_s = fmin(c->horizon_s, fmax(fastest / growing, sqrt(1 / growing)));
	const double turning = bound_rotation(c, true, &c->turn_a, &c->bend_a, &c->swing_a) +
	                       bound_rotation(c, false, &c->turn_b, &c->bend_b, &c->swing_b);
	const rb_vec3 w = rb_vec3_sub(c->pair.pose_b.velocity, c->pair.pose_a.velocity);
	const double surface = rb_vec3_length(c->pair.pose_a.spin) *
	                               arm_of(c, c->a.ball, c->b.ball) +
	                       rb_vec3_length(c->pair.pose_b.spin) *
	                               arm_of(c, c->b.ball, c->a.ball);
	c->speed = rb_vec3_length(w) + turning;
	c->noise = 8 * DBL_EPSILON *
	           (rb_vec3_max_abs(c->pair.pose_a.velocity) +
	            rb_vec3_max_abs(c->pair.pose_b.velocity) + surface +
	            sqrt(2 * l->weight * c->size));
	struct rb_contact_point resting = {
		.a = c->pair.a, .b = c->pair.b, .pose_a = c->pair.pose_a, .pose_b = c->pair.pose_b};
	c->band = rb_contact_point_band(l, &resting, t);
}

/* ---- bounding balls ---- */

/* First time at which gap + rate s + bend s^2 / 2 falls below zero, s; INFINITY: never. */
static double falls_after(double gap, double rate, double bend)
{
	const double square = rate * rate - 2 * bend * gap;

	if (!(gap > 0))
		return 0;
	if (square < 0 || (rate >= 0 && bend >= 0))
		return HUGE_VAL;
	return rate < 0 ? 2 * gap / (sqrt(square) - rate) : (rate + sqrt(square)) / -bend;
}

/* Seconds until the bounding balls can touch; < 0: too near for this bound. */
static double ball_time(const struct search_state *c)
{
	const struct rb_located *l = c->l;
	const bool a_is_plane = !isfinite(c->a.ball);
	const rb_vec3 d = rb_pose_between(&c->pair.pose_a, &c->pair.pose_b);
	const rb_vec3 w = rb_vec3_sub(c->pair.pose_b.velocity, c->pair.pose_a.velocity);
	double span;
	rb_vec3 n;

	if (a_is_plane || !isfinite(c->b.ball)) {
		const int plane = a_is_plane ? c->pair.a : c->pair.b;
		if (plane < l->n) /* a driven plane may rotate */
			return -1;
		n = a_is_plane ? l->plane_normal[plane - l->n]
		               : rb_vec3_neg(l->plane_normal[plane - l->n]);
		span = rb_vec3_dot(n, d) - (a_is_plane ? c->b.ball : c->a.ball);
	} else {
		const double length = rb_vec3_length(d);
		span = length - (c->a.ball + c->b.ball);
		n = rb_vec3_scale(1 / length, d);
		const double b = rb_vec3_dot(d, w), square = rb_vec3_dot(w, w);
		const double sum = 1.001 * (c->a.ball + c->b.ball);
		/* on straight lines that pass each other */
		if (span > 0.01 * c->size && c->flies && c->external_max == 0 &&
		    (b >= 0 || b * b < square * (length - sum) * (length + sum)))
			return HUGE_VAL;
	}
	if (!(span > 0.1 * c->size))
		return -1;
	return falls_after(span, rb_vec3_dot(n, w),
	                   c->flies ? rb_vec3_dot(n, c->external) : -c->external_max);
}

/* ---- along one direction ---- */

/* A moving direction from a to b along which heights are measured, with bounds on its rates. */
struct axis {
	rb_vec3 n, rate;
	double rate_max, bend_max; /* 1/s, 1/s^2 */
	/*
	 * rims are nearly perpendicular to it, and |u x n| is bounded by its rate; else |u x n|
	 * must stay away from zero
	 */
	bool polar;
};

struct height {
	double value, rate; /* m, m/s */
};

/* Height of a rim's outermost point along the axis, and its rate. */
static struct height rim_height(const struct rb_feature_side *s, const struct axis *axis,
                                double sign)
{
	const rb_core *core = s->core;
	const rb_vec3 u = {s->turn.m[0][2], s->turn.m[1][2], s->turn.m[2][2]};
	const rb_vec3 u_rate = rb_vec3_cross(s->spin, u);
	const rb_vec3 across = rb_vec3_cross(u, axis->n);
	const rb_vec3 across_rate = rb_vec3_add(rb_vec3_cross(u_rate, axis->n),
	                                        rb_vec3_cross(u, axis->rate));
	const double sine = rb_vec3_length(across);
	const rb_vec3 arm = rb_vec3_scale(sign * core->half_height, u);
	const rb_vec3 x = rb_vec3_add(s->at, arm);
	const rb_vec3 v = rb_vec3_add(s->velocity, rb_vec3_cross(s->spin, arm));
	/* |u x n| grows no faster than u x n itself changes */
	const double swell = axis->polar || !(sine > 0) ? rb_vec3_length(across_rate)
	                                                : rb_vec3_dot(across, across_rate) / sine;

	return (struct height){rb_vec3_dot(axis->n, x) + core->round * sine,
	                       rb_vec3_dot(axis->n, v) + rb_vec3_dot(axis->rate, x) +
	                               core->round * swell};
}

/*
 * Bound, m/s^2, on the second derivative of a rim's term r |u x n| for s <= *max, which may be
 * lowered. The derivative is at most |w''| + |w'|^2 / |w| with w = u x n; away from the pole, |w|
 * stays above half of its present value.
 */
static double rim_bend(const struct rb_feature_side *side, const struct rb_bounds *bounds,
                       const struct axis *axis, double *max)
{
	const rb_vec3 u = {side->turn.m[0][2], side->turn.m[1][2], side->turn.m[2][2]};
	const double sine = rb_vec3_length(rb_vec3_cross(u, axis->n));
	/* the rim's axis is the body's z, as that of the bounds usually is */
	const bool own = fabs(bounds->axis.z) > 1 - 1e-12;
	const double turn = own ? bounds->axis_turn : bounds->turn;
	const double bend = own ? bounds->axis_bend : turn * turn + bounds->turning;
	const double both = turn + axis->rate_max;
	double more = bend + 2 * turn * axis->rate_max + axis->bend_max;

	if (side->core->kind != RB_CORE_CYLINDER)
		return 0;
	if (!axis->polar && sine > 0 && both > 0) {
		*max = fmin(*max, 0.5 * sine / both);
		more += 2 * both * both / sine;
	}
	return side->core->round * more;
}

/* Highest point along the axis s seconds from now, if all points moved at constant velocity. */
static struct height highest(const struct rb_feature_side *side, const struct axis *axis, double s)
{
	const rb_core *core = side->core;
	struct height best = {-(double)INFINITY, 0};

	if (core->kind == RB_CORE_HALF_SPACE)
		return (struct height){rb_vec3_dot(axis->n, side->at),
		                       rb_vec3_dot(axis->n, side->velocity) +
		                               rb_vec3_dot(axis->rate, side->at)};
	if (core->kind == RB_CORE_CYLINDER) {
		const struct height up = rim_height(side, axis, 1);
		const struct height down = rim_height(side, axis, -1);
		return up.value + s * up.rate >= down.value + s * down.rate ? up : down;
	}
	/* in the body's axes: n.(v + w x r) + n'.r = n.v + r.(n x w + n') */
	const rb_vec3 local = rb_mat3_apply_transposed(&side->turn, axis->n);
	const rb_vec3 local_rate = rb_mat3_apply_transposed(
		&side->turn, rb_vec3_add(rb_vec3_cross(axis->n, side->spin), axis->rate));
	const double base = rb_vec3_dot(axis->n, side->at);
	const double base_rate = rb_vec3_dot(axis->n, side->velocity) +
	                         rb_vec3_dot(axis->rate, side->at);
	for (int i = 0; i < core->polytope->vertex_count; i++) {
		const rb_vec3 r = core->polytope->vertices[i];
		const double value = base + rb_vec3_dot(local, r);
		const double rate = base_rate + rb_vec3_dot(local_rate, r);
		if (value + s * rate > best.value + s * best.rate || !isfinite(best.value))
			best = (struct height){value, rate};
	}
	return best;
}

static struct axis reversed(const struct axis *axis)
{
	return (struct axis){rb_vec3_neg(axis->n), rb_vec3_neg(axis->rate), axis->rate_max,
	                     axis->bend_max, axis->polar};
}

/*
 * Seconds until the gap of two points may be closed. For a pair in contact that is zero unless it
 * separates faster than rounding.
 */
static double closed_after(const struct search_state *c, struct height a, struct height b,
                           double radii, double bend)
{
	double gap = -(a.value + b.value) - radii, rate = -(a.rate + b.rate);

	if (gap > c->band)
		return falls_after(gap, rate, -bend);
	if (rate < -c->noise)
		return 0;
	if (rate <= c->noise) /* half of the band may be used up */
		return bend > 0 ? sqrt(c->band / bend) : HUGE_VAL;
	return bend > 0 ? 2 * rate / bend : HUGE_VAL;
}

/*
 * Bound, m/s^2, on the acceleration of the centres towards each other along a fixed direction, over
 * the horizon. A body that falls along a wall which it touches does not accelerate towards it.
 */
static double external_along(const struct search_state *c, rb_vec3 n)
{
	const struct rb_located *l = c->l;
	const int a = c->pair.a, b = c->pair.b;
	const double closes =
		c->decays_alike ? rb_vec3_dot(n, rb_vec3_sub(rb_arc_acceleration(l, a, c->pair.t),
	                                                     rb_arc_acceleration(l, b, c->pair.t)))
				: rb_bounds_along(l, a, n, c->pair.t) +
					  rb_bounds_along(l, b, rb_vec3_neg(n), c->pair.t);

	return fmin(fmax(closes, 0), c->external_max);
}

/* Bound on the second derivative of the distance of any two points along the axis, m/s^2. */
static double bend_max(const struct search_state *c, const struct axis *axis,
                       const struct rb_feature_side *a, const struct rb_feature_side *b, double *s)
{
	/* a rim's own part is that of rim_bend */
	double bend = (axis->rate_max > 0 ? c->external_max : external_along(c, axis->n)) +
	              c->swing_a + c->swing_b;

	bend += rim_bend(a, &c->of_a, axis, s) + rim_bend(b, &c->of_b, axis, s);

	if (axis->rate_max > 0) {
		const double arms = arm_of(c, c->a.ball, c->b.ball) +
		                    arm_of(c, c->b.ball, c->a.ball);
		const rb_vec3 d = rb_pose_between(&c->pair.pose_a, &c->pair.pose_b);
		const double distance_max = rb_vec3_length(d) + arms + c->speed * *s;

		bend += 2 * axis->rate_max * (c->speed + c->external_max * *s) +
		        axis->bend_max * distance_max;
	}
	return bend;
}

/* Seconds for which the axis proves that two parts do not touch. */
static double proved_along(const struct search_state *c, const struct axis *axis,
                           const struct rb_feature_side *a, const struct rb_feature_side *b)
{
	const struct axis back = reversed(axis);
	const double radii = a->core->radius + b->core->radius;
	double s = 0, max = c->horizon_s;

	if (axis->rate_max > 0)
		max = fmin(max, 1 / axis->rate_max);
	const double bend = bend_max(c, axis, a, b, &max);
	for (int k = 0; k < CORNER_ITERATIONS; k++) {
		const struct height on_a = highest(a, axis, s);
		const struct height on_b = highest(b, &back, s);
		const double next = fmin(closed_after(c, on_a, on_b, radii, bend), max);
		/* at the root of one parabola, the lowest one has an earlier root */
		if (k > 0 && !(next < s))
			break;
		s = next;
		if (s == 0)
			break;
	}
	return s;
}

/* ---- a step ---- */

/* True for features with a normal of their own. */
static bool is_face(rb_part part)
{
	const rb_part_kind kind = (rb_part_kind)(part >> 24 & 15);

	return kind == RB_PART_FACE || kind == RB_PART_SEVERAL || kind == RB_PART_END ||
	       kind == RB_PART_SURFACE;
}

/*
 * The rotating normal of a plane. A plane is unbounded, so only its own normal proves a separation;
 * the bounds are those of its rotation.
 */
static struct axis axis_of_plane(const struct search_state *c, bool is_a, rb_vec3 n,
                                 const struct rb_feature_side *plane)
{
	const double turn = is_a ? c->turn_a : c->turn_b;

	return (struct axis){.n = n,
	                     .rate = rb_vec3_cross(plane->spin, n),
	                     .rate_max = turn,
	                     .bend_max = turn * turn + (is_a ? c->turning_a : c->turning_b)};
}

/*
 * The present separating direction, continued: with the face that it belongs to, else by a
 * difference quotient. n + n' s, normalized, turns at a rate of at most |n'|, with a second
 * derivative of at most 1.2 |n'|^2.
 */
static struct axis axis_of(const struct search_state *c, const rb_convex_touch *touch,
                           const struct rb_feature_side *a, const struct rb_feature_side *b)
{
	struct axis axis = {.n = touch->normal};

	if (a->core->kind == RB_CORE_HALF_SPACE)
		return axis_of_plane(c, true, touch->normal, a);
	if (b->core->kind == RB_CORE_HALF_SPACE)
		return axis_of_plane(c, false, touch->normal, b);
	if (is_face(touch->b)) {
		axis.rate = rb_vec3_cross(b->spin, touch->normal);
	} else if (is_face(touch->a)) {
		axis.rate = rb_vec3_cross(a->spin, touch->normal);
	} else if (c->speed > 0) {
		const double moment = moment_share * c->size / c->speed;
		const struct rb_feature_side next_a = rb_feature_later(a, moment);
		const struct rb_feature_side next_b = rb_feature_later(b, moment);
		const rb_placed at_a = rb_feature_placed(&next_a);
		const rb_placed at_b = rb_feature_placed(&next_b);
		const rb_vec3 n = rb_separation_of(&at_a, &at_b).normal;

		axis.rate = rb_vec3_reject(rb_vec3_scale(1 / moment, rb_vec3_sub(n, touch->normal)),
		                           touch->normal);
	}
	axis.rate_max = rb_vec3_length(axis.rate);
	axis.bend_max = 1.2 * axis.rate_max * axis.rate_max;
	return axis;
}

/*
 * Seconds for which two parts certainly do not touch; *gap is their gap, or a lower bound of it if
 * they are far apart. A bound beyond `tolerance` seconds needs no search.
 */
static double safe_parts(const struct search_state *c, const struct rb_feature_side *a,
                         const struct rb_feature_side *b, double *gap, double tolerance)
{
	const rb_placed at_a = rb_feature_placed(a), at_b = rb_feature_placed(b);

	if (a->core->kind != RB_CORE_HALF_SPACE && b->core->kind != RB_CORE_HALF_SPACE) {
		const double span = rb_vec3_length(rb_vec3_sub(b->at, a->at)) -
		                    rb_convex_reach(a->core) - rb_convex_reach(b->core);
		const double s = falls_after(span, -c->speed, -c->external_max);
		if (s > tolerance && span > 0) {
			*gap = span;
			return s;
		}
	}
	const rb_convex_touch touch = rb_convex_gap(&at_a, &at_b);
	const rb_vec3 w = rb_vec3_sub(c->pair.pose_b.velocity, c->pair.pose_a.velocity);
	const double closing = -rb_vec3_dot(touch.normal, w);
	const struct axis fixed = {.n = touch.normal};
	struct axis moving = axis_of(c, &touch, a, b);
	const bool plane = a->core->kind == RB_CORE_HALF_SPACE ||
	                   b->core->kind == RB_CORE_HALF_SPACE;
	double safe = 0;

	*gap = touch.gap;
	if (!plane || !(moving.rate_max > 0)) {
		safe = rb_convex_safe_time(touch.gap, closing, c->speed - rb_vec3_length(w),
		                           c->external_max);
		if (safe >= c->horizon_s)
			return safe;
		safe = fmax(safe, proved_along(c, &fixed, a, b));
	}
	if (moving.rate_max > 0)
		safe = fmax(safe, proved_along(c, &moving, a, b));
	if (a->core->kind == RB_CORE_CYLINDER || b->core->kind == RB_CORE_CYLINDER) {
		moving.polar = true;
		safe = fmax(safe, proved_along(c, &moving, a, b));
	}
	return safe;
}

/* Bound on the relative distance travelled in s seconds, m. */
static double travel_in(const struct search_state *c, double s)
{
	return c->speed * s + 0.5 * c->external_max * s * s;
}

/*
 * The same for a body and a terrain. After the nearest facet of a part, the time is limited to what
 * twice its distance takes, so that few facets are examined.
 */
static double safe_over_terrain(const struct search_state *c, const struct rb_body_parts *terrain,
                                double *gap)
{
	const int of_a = rb_model_parts(c->l->model, c->pair.a)->count;
	const struct rb_pose *const here = &c->pair.pose_a, *const there = &c->pair.pose_b;
	struct rb_feature_side a, b;
	double safe = c->horizon_s;

	*gap = (double)INFINITY;
	for (int i = 0; i < of_a; i++) {
		struct rb_near_parts near;
		bool first = true;
		int j;

		rb_touch_side(c->l, c->pair.a, i, here, here, &a);
		const double reach = rb_convex_reach(a.core);
		rb_near_parts_begin(&near, terrain, there->position, there->orientation,
		                    rb_vec3_add(here->position, a.at),
		                    reach + c->band + travel_in(c, safe));
		while ((j = rb_near_parts_next(&near)) >= 0) {
			double between;

			rb_touch_side(c->l, c->pair.b, j, there, here, &b);
			const double own = safe_parts(c, &a, &b, &between, safe);
			if (first) {
				const double span = rb_vec3_length(rb_vec3_sub(b.at, a.at)) +
				                    reach + rb_convex_reach(b.core);
				safe = fmin(safe,
				            falls_after(2 * span, -c->speed, -c->external_max));
			}
			first = false;
			safe = fmin(safe, own);
			*gap = fmin(*gap, between);
			rb_near_parts_limit(&near, reach + c->band + travel_in(c, safe));
		}
	}
	return safe;
}

/* The same for two bodies: the minimum over all pairs of parts. */
static double safe_bodies(const struct search_state *c, double *gap)
{
	const struct rb_model *model = c->l->model;
	const int of_a = rb_model_parts(model, c->pair.a)->count;
	const int of_b = rb_model_parts(model, c->pair.b)->count;
	const struct rb_pose *const here = &c->pair.pose_a;
	struct rb_feature_side a, b;
	double safe = HUGE_VAL;

	if (rb_model_parts(model, c->pair.b)->terrain)
		return safe_over_terrain(c, rb_model_parts(model, c->pair.b), gap);
	*gap = (double)INFINITY;
	for (int i = 0; i < of_a; i++) {
		rb_touch_side(c->l, c->pair.a, i, &c->pair.pose_a, here, &a);
		for (int j = 0; j < of_b; j++) {
			double between;

			rb_touch_side(c->l, c->pair.b, j, &c->pair.pose_b, here, &b);
			safe = fmin(safe, safe_parts(c, &a, &b, &between, safe));
			*gap = fmin(*gap, between);
		}
	}
	return safe;
}

/* ---- touching ---- */

/* The pair on its arcs at t. */
static struct rb_touch_pair pair_at(const struct rb_located *l, int a, int b, double t)
{
	return (struct rb_touch_pair){a, b, t, rb_arc_pose(l, a, t), rb_arc_pose(l, b, t)};
}

bool rb_approach_now(const struct rb_located *l, int a, int b, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	const struct rb_touch_pair pair = pair_at(l, a < b ? a : b, a < b ? b : a, t);

	return rb_closing_of(l, &pair) == RB_CLOSING_CLOSES;
}

/* Gap of the pair at another time, m. */
static double gap_at(const struct search_state *c, double t)
{
	const struct rb_touch_pair pair = pair_at(c->l, c->pair.a, c->pair.b, t);
	uint32_t parts;

	return rb_touch_gap(c->l, &pair, &parts);
}

/*
 * Root of the gap between two times with gaps above and below zero, to rounding: secants, with a
 * bisection every third iteration. While a point separates so slowly that it is within the band
 * throughout, it hides another one that comes to touch: the touch is later.
 */
static double crossing(const struct search_state *c, double low, double high)
{
	double above = gap_at(c, low), below = gap_at(c, high);

	for (int k = 0; k < HALVINGS && high - low > 2 * DBL_EPSILON * high; k++) {
		const bool halves = !(above > 0) || k % 3 == 2;
		double t = low + (high - low) * (halves ? 0.5 : above / (above - below));
		t = fmin(fmax(t, low + DBL_EPSILON * high), high - DBL_EPSILON * high);
		const double gap = gap_at(c, t);
		const struct rb_touch_pair pair = pair_at(c->l, c->pair.a, c->pair.b, t);
		const bool part = fabs(gap) <= c->band &&
		                  rb_closing_of(c->l, &pair) == RB_CLOSING_PARTS;

		if (!part && fabs(gap) <= 0.125 * c->band)
			return t;
		if (gap > 0 || part) {
			low = t;
			above = fmax(gap, 0);
		} else {
			high = t;
			below = gap;
		}
	}
	return high;
}

/*
 * Time of touch of a pair that overlaps by rounding, separates at `from` and closes now, which has
 * no gap to trace back. It is back where it began after twice the time to its reversal. Found
 * later, it would hit faster than it separated, and so rebound without end.
 */
static double returned(const struct search_state *c, double from)
{
	struct rb_touch_pair pair = pair_at(c->l, c->pair.a, c->pair.b, from);
	double low = from, high = c->pair.t;

	if (rb_closing_of(c->l, &pair) != RB_CLOSING_PARTS)
		return high;
	for (int k = 0; k < HALVINGS && high - low > 2 * DBL_EPSILON * high; k++) {
		const double t = low + 0.5 * (high - low);

		pair = pair_at(c->l, c->pair.a, c->pair.b, t);
		if (rb_closing_of(c->l, &pair) == RB_CLOSING_CLOSES)
			high = t;
		else
			low = t;
	}
	return fmin(from + 2 * (high - from), c->pair.t);
}

/* Moves a touch found within the band to the time of zero gap, to the resolution of time. */
static double refined(const struct search_state *c, double from, double until)
{
	struct rb_contact_point all[RB_CONTACT_POINTS_MAX];
	const int count = rb_touch_all(c->l, &c->pair, 0, all);
	const double t = c->pair.t;
	double sooner = HUGE_VAL;

	for (int k = 0; k < count; k++) {
		const double rate = rb_vec3_dot(all[k].velocity, all[k].normal);

		/* a point that hardly closes does so by acceleration */
		if (rate < -c->noise && all[k].gap > 0)
			sooner = fmin(sooner,
			              falls_after(all[k].gap, rate,
			                          -(c->external_max + c->bend_a + c->bend_b)));
		/*
		 * for sliding bodies that close by little more than rounding, gap over rate is
		 * meaningless
		 */
		else if (rate < -c->noise &&
		         (all[k].gap < -c->band ||
		          all[k].gap * c->speed >= min_share_first * c->size * rate))
			sooner = fmin(sooner, all[k].gap / -rate);
	}
	if (!isfinite(sooner))
		return t;
	/* not before the rebound from which it comes */
	return t + sooner > from ? fmin(t + sooner, until) : returned(c, from);
}

/* Seconds in which a dip gets no deeper than DIP_ULP ulp of the size. */
static double dip_time(const struct search_state *c)
{
	return sqrt(DIP_ULP * DBL_EPSILON * c->size / (c->external_max + c->bend_a + c->bend_b));
}

/* Step of the series for the body's rotation, s; INFINITY: none is needed. */
static double series_step(const struct rb_located *l, int i)
{
	return l->top && i < l->n && !rb_located_on_piece(l, i) ? rb_top_step_s(&l->top[i])
	                                                        : HUGE_VAL;
}

/* Counted cost of evaluating a body's rotation from its anchor to t, products. */
static uint64_t turning_cost(const struct rb_located *l, int i, double t)
{
	const double steps = (t - l->arc[i].anchor_s) / series_step(l, i);

	return (uint64_t)(RB_LOCATED_SERIES * fmin(fmax(steps, 0), 1e12));
}

/* Advances until a touch is found, nothing can touch before `until`, or steps run out. */
static void search(struct search_state *c, double from, double until, struct rb_approach *found)
{
	/* few facets of a terrain are near enough to be examined */
	const uint64_t inspection = rb_crowd_inspection(c->l, c->pair.a, c->pair.b, FACETS_NEAR);
	/*
	 * no farther than the rotation's series is soon evaluated: a body that spins a million
	 * times is searched again later
	 */
	const double limit_s = from + SERIES_MAX * fmin(series_step(c->l, c->pair.a),
	                                                series_step(c->l, c->pair.b));
	double t = from, min_share = min_share_first, gap;
	bool rests = false;

	for (int step = 0; step < STEPS_MAX; step++) {
		place(c, t, until);
		found->products += RB_LOCATED_FLIGHT;
		double s = ball_time(c);
		if (s < 0) {
			s = safe_bodies(c, &gap);
			found->products += inspection;
			if (gap <= c->band) {
				const enum rb_closing now = rb_closing_of(c->l, &c->pair);

				found->products += inspection;
				found->touching = found->touching || t == from;
				/*
				 * bodies that begin to rest on each other may share a load:
				 * reported once
				 */
				rests = rests || (t == from && now == RB_CLOSING_RESTS);
				if (now == RB_CLOSING_CLOSES ||
				    (now == RB_CLOSING_BEGINS && t > from) ||
				    (now == RB_CLOSING_RESTS && !rests)) {
					found->touch_s = t > from ? refined(c, from, until) : t;
					return;
				}
			}
			const double least = fmin(min_share * c->size / c->speed, dip_time(c));
			if (s < least && c->speed > 0) {
				/*
				 * a separating pair has a gap half way to where it may touch again;
				 * an overlapping pair has none
				 */
				const double low = gap > c->band ? t : t + 0.5 * s;
				const double high = fmin(t + least, until);
				if (t + s < high && gap_at(c, high) < 0 &&
				    (gap > c->band || gap_at(c, low) > 0)) {
					found->touch_s = crossing(c, low, high);
					return;
				}
				s = least;
				min_share = fmin(2 * min_share, min_share_last);
			} else {
				min_share = min_share_first;
			}
		}
		s = fmax(s, 2 * DBL_EPSILON * t);
		if (!(t + s <= until))
			return;
		if (!(t + s <= limit_s)) {
			t = limit_s;
			break;
		}
		t += s;
	}
	found->touch_s = t;
	found->unfinished = true;
}

struct rb_approach rb_approach_find(const struct rb_located *l, int a, int b, double from,
                                    double until)
{
	struct rb_approach found = {.touch_s = HUGE_VAL};
	struct search_state c;

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	RB_ASSERT_COSTLY(until >= from);
	start(&c, l, a < b ? a : b, a < b ? b : a);
	search(&c, from, until, &found);
	found.products += a < l->n ? turning_cost(l, a, c.pair.t) : 0;
	found.products += b < l->n ? turning_cost(l, b, c.pair.t) : 0;
	return found;
}
