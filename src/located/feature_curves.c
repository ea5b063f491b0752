/* SPDX-License-Identifier: MIT */
/*
 * Rims against edges, mantles and rims: the nearest points of two curves, by Newton's method on the
 * two conditions that the vector between them is perpendicular to both. Rates follow from
 * differentiating the conditions (implicit function theorem).
 */
#include "located/feature.h"
#include "located/feature_inside.h"

/* A line or a circle: its point at a parameter (m; radians), and its first two derivatives. */
typedef struct {
	bool round;
	line straight;
	vec centre, x, y; /* of a circle: perpendicular radii, m */
	vec at, first, second;
} curve;

/* The curve of a part; false: it has none. */
static bool curve_of(const side *s, rb_part part, curve *out)
{
	const rb_core *core = s->core;

	*out = (curve){.round = kind_of(part) == RB_PART_RIM};
	if (!out->round)
		return line_of(s, part, &out->straight);
	if (core->kind != RB_CORE_CYLINDER)
		return false;
	const double half = index_of(part) & 1 ? -core->half_height : core->half_height;
	out->centre = point_of(s, (rb_vec3){0, 0, half});
	out->x = vector_of(s, (rb_vec3){core->round, 0, 0});
	out->y = vector_of(s, (rb_vec3){0, core->round, 0});
	out->straight.of = s;
	return true;
}

/* Parameter of the point nearest to a position. */
static double nearest_on(const curve *c, rb_vec3 near)
{
	if (!c->round)
		return rb_vec3_dot(rb_vec3_sub(near, c->straight.from.at), c->straight.along.at);
	const rb_vec3 d = rb_vec3_sub(near, c->centre.at);
	return atan2(rb_vec3_dot(d, c->y.at), rb_vec3_dot(d, c->x.at));
}

/* Evaluates the curve at parameter s. */
static void evaluate(curve *c, double s)
{
	const vec none = {{0, 0, 0}, {0, 0, 0}};

	if (!c->round) {
		c->at = plus_constant(c->straight.from, s, c->straight.along);
		c->first = c->straight.along;
		c->second = none;
		return;
	}
	const double co = cos(s), si = sin(s);
	const vec out = plus_constant(plus_constant(none, co, c->x), si, c->y);
	c->at = plus_constant(c->centre, 1, out);
	c->first = plus_constant(plus_constant(none, -si, c->x), co, c->y);
	c->second = negative(out);
}

/*
 * A point of a moving curve with its total rate; `rate`: of the parameter, `by`: derivative by it.
 */
static vec with_parameter_rate(vec p, double rate, vec by)
{
	p.rate = rb_vec3_add_scaled(p.rate, rate, by.at);
	return p;
}

/*
 * Residuals of r.a' = 0 and r.b' = 0 for r from a's point to b's, their rates, and their Jacobian
 * by the parameters.
 */
typedef struct {
	double residual[2], rate[2], m[2][2], determinant;
} foot_point;

static foot_point foot_of(const curve *a, const curve *b)
{
	const vec r = minus(b->at, a->at);
	const num on_a = dot(r, a->first), on_b = dot(r, b->first);
	foot_point f = {.residual = {on_a.at, on_b.at}, .rate = {on_a.rate, on_b.rate}};

	f.m[0][0] = rb_vec3_dot(r.at, a->second.at) - rb_vec3_dot(a->first.at, a->first.at);
	f.m[0][1] = rb_vec3_dot(b->first.at, a->first.at);
	f.m[1][0] = -f.m[0][1];
	f.m[1][1] = rb_vec3_dot(r.at, b->second.at) + rb_vec3_dot(b->first.at, b->first.at);
	f.determinant = f.m[0][0] * f.m[1][1] - f.m[0][1] * f.m[1][0];
	return f;
}

/* Solves the 2 x 2 system by Cramer's rule. */
static void solve(const foot_point *f, const double right[2], double out[2])
{
	out[0] = (right[0] * f->m[1][1] - right[1] * f->m[0][1]) / f->determinant;
	out[1] = (right[1] * f->m[0][0] - right[0] * f->m[1][0]) / f->determinant;
}

/* Outward direction at the curve. */
static rb_vec3 outward_of(const curve *c)
{
	if (!c->round)
		return outward(&c->straight);
	return rb_vec3_sub(c->at.at, c->straight.of->at);
}

/*
 * Limits of validity: of a line, its ends, and where its faces take over at the distance of the
 * other's surface; of a rim, the components of the outward normal along those of the end and the
 * mantle.
 */
static void within_curve(ending *end, const curve *c, const curve *other, num s, vec n,
                         side_index owner)
{
	const vec none = {{0, 0, 0}, {0, 0, 0}};

	if (!c->round) {
		within_line(end, &c->straight, s, owner);
		within_borders(end, &c->straight,
		               plus_constant(none, rb_vec3_length(other->x.at), n), owner);
		return;
	}
	const vec at = with_parameter_rate(c->at, s.rate, c->first);
	const vec radial = minus(at, c->centre);
	vec u = cross(c->x, c->y);
	if (rb_vec3_dot(u.at, rb_vec3_sub(c->centre.at, c->straight.of->at)) < 0)
		u = negative(u);
	const double per = 1 / rb_vec3_length(radial.at);
	const num on_end = dot(n, u), on_mantle = dot(n, radial);

	limit_ending(end, (num){on_end.at * per, on_end.rate * per}, owner, 0);
	limit_ending(end, on_mantle, owner, 0);
}

/*
 * Parameter near which a line crosses a circle, from the distance of the circle's centre, less a
 * mantle's radius.
 */
static double crossing_of(const curve *circle, rb_part rim, const line *other)
{
	const rb_vec3 d = rb_vec3_sub(circle->centre.at, other->from.at);
	const double along = rb_vec3_dot(d, other->along.at);
	const double off = fmax(rb_vec3_length(rb_vec3_reject(d, other->along.at)) - other->radius,
	                        0);
	const double round = rb_vec3_length(circle->x.at);
	const double half = sqrt(fmax((round - off) * (round + off), 0));

	return index_of(rim) >> 1 == SECOND_CROSSING ? along + half : along - half;
}

static bool is_mantle(const curve *c)
{
	return !c->round && c->straight.of->core->kind == RB_CORE_CYLINDER;
}

/* The larger of two steps as a share of the size of its parameter: of a line in m. */
static double share_of(const curve c[2], const double step[2], const double s[2], double size)
{
	double share = 0;

	for (int k = 0; k < 2; k++)
		share = fmax(share, fabs(step[k]) / ((c[k].round ? 1 : size) + fabs(s[k])));
	return share;
}

/*
 * True if one curve is a mantle and the steps are within what rounding of the residuals causes,
 * which is more where the curves are nearly tangent. For an edge, which may then lie in a face with
 * the rim, the curves do not determine the normal, and a search must.
 */
static bool is_within_rounding(const curve c[2], const foot_point *f, const double step[2],
                               double size)
{
	const double left[2] = {rb_vec3_length(c[0].first.at), rb_vec3_length(c[1].first.at)};
	bool small = is_mantle(&c[0]) || is_mantle(&c[1]);

	for (int k = 0; k < 2; k++)
		small = small && fabs(step[k]) <= 4 * DBL_EPSILON * size *
		                                          (left[k] * fabs(f->m[1 - k][1 - k]) +
		                                           left[1 - k] * fabs(f->m[k][1 - k])) /
		                                          fabs(f->determinant);
	return small;
}

/* Start of Newton's method: the named crossing, else the point nearest to `near`. */
static void start_near(const curve c[2], const rb_part part[2], rb_vec3 near, double s[2])
{
	for (int k = 0; k < 2; k++) {
		const curve *circle = &c[k], *other = &c[1 - k];

		if (!circle->round || other->round || index_of(part[k]) >> 1 < FIRST_CROSSING)
			continue;
		s[1 - k] = crossing_of(circle, part[k], &other->straight);
		s[k] = nearest_on(circle, rb_vec3_add_scaled(other->straight.from.at, s[1 - k],
		                                             other->straight.along.at));
		return;
	}
	s[0] = nearest_on(&c[0], near);
	s[1] = nearest_on(&c[1], near);
}

bool rb_feature_curves(struct rb_feature_point *out, const struct rb_feature_side *a,
                       const struct rb_feature_side *b, uint64_t key, rb_vec3 near)
{
	enum { ROUNDS = 12, ROUNDS_MANTLE = 32 };
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	const rb_part part[2] = {part_a, part_b};
	double s[2], step[2], rate[2], before = HUGE_VAL;
	curve c[2];
	curve *const on_a = &c[0], *const on_b = &c[1];
	const double size = a->core->reach + b->core->reach;
	foot_point foot;
	vec n;
	num sine;
	ending end = endless;

	if ((kind_of(part_a) != RB_PART_RIM && kind_of(part_b) != RB_PART_RIM) ||
	    !curve_of(a, part_a, on_a) || !curve_of(b, part_b, on_b))
		return false;
	start_near(c, part, near, s);
	const int rounds = is_mantle(on_a) || is_mantle(on_b) ? ROUNDS_MANTLE : ROUNDS;
	for (int k = 0; k < rounds; k++) {
		evaluate(on_a, s[0]);
		evaluate(on_b, s[1]);
		foot = foot_of(on_a, on_b);
		if (!(fabs(foot.determinant) > 0))
			return false;
		solve(&foot, foot.residual, step);
		s[0] -= step[0];
		s[1] -= step[1];
		const double share = share_of(c, step, s, size);
		if (share <= 4 * DBL_EPSILON ||
		    (share > 0.5 * before && is_within_rounding(c, &foot, step, size)))
			break;
		before = share;
		if (k + 1 == rounds)
			return false;
	}
	solve(&foot, foot.rate, rate);
	rate[0] = -rate[0];
	rate[1] = -rate[1];
	const vec at_a = with_parameter_rate(on_a->at, rate[0], on_a->first);
	const vec at_b = with_parameter_rate(on_b->at, rate[1], on_b->first);
	const vec m = cross(with_parameter_rate(on_a->first, rate[0], on_a->second),
	                    with_parameter_rate(on_b->first, rate[1], on_b->second));
	if (!direction(m, &n, &sine) ||
	    sine.at < 1e-6 * rb_vec3_length(on_a->first.at) * rb_vec3_length(on_b->first.at))
		return false;
	if (rb_vec3_dot(n.at, outward_of(on_a)) - rb_vec3_dot(n.at, outward_of(on_b)) < 0)
		n = negative(n);
	const double radius_a = on_a->round ? 0 : on_a->straight.radius;
	const double radius_b = on_b->round ? 0 : on_b->straight.radius;
	const num separation = dot(n, minus(at_b, at_a));
	const vec surface_a = plus_constant(at_a, radius_a, n);
	const vec surface_b = plus_constant(at_b, -radius_b, n);
	within_curve(&end, on_a, on_b, (num){s[0], rate[0]}, n, FIRST);
	within_curve(&end, on_b, on_a, (num){s[1], rate[1]}, negative(n), SECOND);
	set_point(out, (num){separation.at - radius_a - radius_b, separation.rate}, n,
	          plus_constant(surface_a, 0.5, minus(surface_b, surface_a)), &end);
	return true;
}
