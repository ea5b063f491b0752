/* SPDX-License-Identifier: MIT */
/*
 * Closed forms where there are any, otherwise series about the points of a grid.
 *
 * Every result is a function of the anchor and of t alone: the grid point comes from t, and the
 * state there from walking the grid from the anchor (or from the cached point, which was found in
 * the same way). Mirroring in a coordinate plane flips signs in the results and changes no bit:
 * sums only mix terms of the same sign pattern, and decisions depend on sizes only.
 */
#include "math/top.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "base/error.h"

RB_FIELDS_DEFINE(rb_top_fields, struct rb_top, RB_TOP_FIELDS);

static const double pi = 3.14159265358979323846;

enum { ORDER = 32 }; /* largest order of a series; grid_of and steady_point choose steps for it */

/* Smallest term of a series, as a share of its sum: 1/128 of an ulp. */
static const double negligible = 0x1p-60;
static const double grid_points_max = 0x1p53; /* beyond it doubles skip integers */
/*
 * Grid points beyond which whole periods are skipped by one precession: 2^16 series of a few
 * microseconds are a tenth of a second, and near the anchor the walk is exact while a period is
 * rounded.
 */
static const double leap_from = 0x1p16;

static rb_quat conjugate(rb_quat q)
{
	return (rb_quat){q.w, -q.x, -q.y, -q.z};
}

static bool is_zero(rb_vec3 a)
{
	return a.x == 0 && a.y == 0 && a.z == 0;
}

/*
 * Rotation for `t` seconds at the constant rate `spin`, accurate to rounding for any number of
 * turns: the length of the spin and its product with t are carried with their rounding errors.
 */
static rb_quat turn(rb_vec3 spin, double t)
{
	const double square = rb_vec3_dot(spin, spin);

	if (!(square > 1e-200 && square < 1e200))
		return rb_quat_from_turn(rb_vec3_scale(t, spin));
	const double length = sqrt(square);
	/* rounding errors of the sum of squares, term by term; those of additions as by Knuth */
	const double xx = spin.x * spin.x, yy = spin.y * spin.y, zz = spin.z * spin.z;
	const double xy = xx + yy, xy_part = xy - xx, z_part = square - xy;
	const double lost = fma(spin.x, spin.x, -xx) + fma(spin.y, spin.y, -yy) +
	                    fma(spin.z, spin.z, -zz) + ((xx - (xy - xy_part)) + (yy - xy_part)) +
	                    ((xy - (square - z_part)) + (zz - z_part));
	const double more = (fma(-length, length, square) + lost) / (2 * length);
	const double angle = length * t;
	const double half_more = 0.5 * (fma(length, t, -angle) + more * t);
	const double s = sin(0.5 * angle), c = cos(0.5 * angle);
	const double along = (s + c * half_more) / length;

	return (rb_quat){c - s * half_more, along * spin.x, along * spin.y, along * spin.z};
}

/* ---- the body ---- */

/* Equal to rounding: a moment of inertia results from some ten operations, covered by 16 ulp. */
static bool same(double a, double b)
{
	return fabs(a - b) <= 16 * DBL_EPSILON * fmax(fabs(a), fabs(b));
}

/*
 * One Jacobi rotation (Jacobi 1846) that makes a[p][q] zero; `frame` has the axes in its columns.
 */
static void jacobi(rb_mat3 *a, rb_mat3 *frame, int p, int q)
{
	const double off = a->m[p][q], theta = (a->m[q][q] - a->m[p][p]) / (2 * off);
	/*
	 * the smaller rotation; for equal moments its sign is that of `off`, which mirroring flips
	 */
	const double sign = theta == 0 ? copysign(1, off) : copysign(1, theta);
	const double t = sign / (fabs(theta) + hypot(theta, 1));
	const double c = 1 / hypot(t, 1), s = t * c;
	const int r = 3 - p - q;
	const double rp = a->m[r][p], rq = a->m[r][q];

	a->m[p][p] -= t * off;
	a->m[q][q] += t * off;
	a->m[p][q] = a->m[q][p] = 0;
	a->m[r][p] = a->m[p][r] = c * rp - s * rq;
	a->m[r][q] = a->m[q][r] = s * rp + c * rq;
	for (int i = 0; i < 3; i++) {
		const double ip = frame->m[i][p], iq = frame->m[i][q];

		frame->m[i][p] = c * ip - s * iq;
		frame->m[i][q] = s * ip + c * iq;
	}
}

/*
 * Principal moments on the diagonal of `a`, axes in the columns of `frame`, by cyclic Jacobi
 * sweeps, which converge quadratically (30 are never needed). Entries of rounding are not rotated,
 * so that a diagonal tensor keeps its axes bit for bit.
 */
static void principal_axes(rb_mat3 *a, rb_mat3 *frame)
{
	static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
	bool clean = false;

	*frame = rb_mat3_diagonal(1, 1, 1);
	for (int sweep = 0; sweep < 30 && !clean; sweep++) {
		clean = true;
		for (int k = 0; k < 3; k++) {
			const int p = pairs[k][0], q = pairs[k][1];
			const double size = sqrt(fabs(a->m[p][p])) * sqrt(fabs(a->m[q][q]));

			if (!(fabs(a->m[p][q]) > DBL_EPSILON * size))
				continue;
			clean = false;
			jacobi(a, frame, p, q);
		}
	}
}

/*
 * A rotation that takes z to the unit vector `axis`, or to its opposite: a permutation of axes,
 * which does not round, if possible.
 */
static rb_quat z_to(rb_vec3 axis)
{
	if (axis.y == 0 && axis.z == 0)
		return (rb_quat){0.5, 0.5, 0.5, 0.5};
	if (axis.x == 0 && axis.z == 0)
		return (rb_quat){0.5, -0.5, -0.5, -0.5};
	/* the shortest rotation, to the nearer end of the axis */
	if (axis.z < 0)
		axis = rb_vec3_neg(axis);
	return rb_quat_unit((rb_quat){1 + axis.z, -axis.y, axis.x, 0});
}

struct rb_top_body rb_top_body_of(const rb_mat3 *inertia)
{
	rb_mat3 a = *inertia, frame;

	principal_axes(&a, &frame);
	const double m[3] = {a.m[0][0], a.m[1][1], a.m[2][2]};
	struct rb_top_body body = {RB_TOP_FREE, rb_quat_identity, {m[0], m[1], m[2]}};

	if (same(m[0], m[1]) && same(m[0], m[2]) && same(m[1], m[2])) {
		body.kind = RB_TOP_CONSTANT;
		return body;
	}
	for (int k = 2; k >= 0; k--) {
		const int i = (k + 1) % 3, j = (k + 2) % 3;

		if (!same(m[i], m[j]))
			continue;
		body.kind = RB_TOP_SYMMETRIC;
		body.principal = z_to((rb_vec3){frame.m[0][k], frame.m[1][k], frame.m[2][k]});
		body.moments.x = body.moments.y = 0.5 * (m[i] + m[j]);
		body.moments.z = m[k];
		return body;
	}
	body.principal = rb_quat_from_mat3(&frame);
	return body;
}

/* a - b, but zero if that is only rounding: equal moments have no gyroscopic torque. */
static double difference(double a, double b)
{
	return same(a, b) ? 0 : a - b;
}

rb_mat3 rb_top_inverse_root(const struct rb_top_body *body, const rb_mat3 *inertia,
                            rb_quat orientation)
{
	const bool own = inertia->m[0][1] == 0 && inertia->m[0][2] == 0 && inertia->m[1][2] == 0;
	const rb_mat3 r = rb_quat_to_mat3(own ? orientation
	                                      : rb_quat_multiply(orientation, body->principal));
	const double moment[3] = {own ? inertia->m[0][0] : body->moments.x,
	                          own ? inertia->m[1][1] : body->moments.y,
	                          own ? inertia->m[2][2] : body->moments.z};
	rb_mat3 out;

	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			out.m[k][x] = r.m[x][k] / sqrt(moment[k]);
	return out;
}

rb_vec3 rb_top_turning(const struct rb_top_body *body, const rb_mat3 *inertia, rb_quat orientation,
                       rb_vec3 spin)
{
	if (body->kind == RB_TOP_CONSTANT)
		return (rb_vec3){0, 0, 0};
	/* not by a permutation of axes unless necessary: it would mix signs */
	const bool own = inertia->m[0][1] == 0 && inertia->m[0][2] == 0 && inertia->m[1][2] == 0;
	const rb_quat axes = own ? orientation : rb_quat_multiply(orientation, body->principal);
	const rb_vec3 i = own ? (rb_vec3){inertia->m[0][0], inertia->m[1][1], inertia->m[2][2]}
	                      : body->moments;
	const rb_vec3 w = rb_quat_rotate_back(axes, spin);

	return rb_quat_rotate(axes, (rb_vec3){difference(i.y, i.z) / i.x * w.y * w.z,
	                                      difference(i.z, i.x) / i.y * w.z * w.x,
	                                      difference(i.x, i.y) / i.z * w.x * w.y});
}

/* ---- start of a motion ---- */

static bool is_identity(rb_quat q)
{
	return q.w == 1 && q.x == 0 && q.y == 0 && q.z == 0;
}

/*
 * The length of a free body's grid: a power of two, so that scaling by it and its multiples do not
 * round.
 *
 * With k = the largest of |I_i - I_j| / I_l, |w'| <= k |w|^2 / sqrt(3) bounds the series of w by
 * that of w0 / (1 - k w0 t / sqrt(3)), and that of the orientation by a power of the same. So steps
 * of w_max t <= 1/2 make the 32nd term smaller than 0.29^32 = 6e-18. Each component stays below
 * what energy and angular momentum allow: for moments a, b of the others, I_i (I_i - I_b) w_i^2 +
 * I_a (I_a - I_b) w_a^2 is constant.
 */
static double grid_of(rb_vec3 moments, rb_vec3 spin)
{
	const double i[3] = {moments.x, moments.y, moments.z}, w[3] = {spin.x, spin.y, spin.z};
	double square = 0, k = 1;
	int exponent;

	for (int n = 0; n < 3; n++) {
		const int a = (n + 1) % 3, b = (n + 2) % 3;
		double max = (double)INFINITY;

		k = fmax(k, fabs(i[a] - i[b]) / i[n]);
		for (int s = 0; s < 2; s++) {
			const int other = s ? b : a, third = s ? a : b;
			const double ratio = (i[other] - i[third]) / (i[n] - i[third]);

			if (ratio > 0)
				max = fmin(max, w[n] * w[n] + i[other] / i[n] * ratio *
				                                      (w[other] * w[other]));
		}
		square += max;
	}
	const double rate = k * sqrt(square);
	if (!(rate > 0) || !isfinite(rate))
		return rate > 0 ? 0 : (double)INFINITY;
	frexp(rate, &exponent); /* rate < 2^exponent */
	return ldexp(1, -exponent - 1);
}

/* Parallel to rounding: the deviation is at most that by rounding of the arguments. */
static bool parallel(rb_vec3 a, rb_vec3 b)
{
	return rb_vec3_length(rb_vec3_cross(a, b)) <=
	       4 * DBL_EPSILON * rb_vec3_length(a) * rb_vec3_length(b);
}

struct rb_top rb_top_start(const struct rb_top_body *body, rb_quat orientation, rb_vec3 spin,
                           rb_vec3 acceleration)
{
	struct rb_top top = {.kind = body->kind,
	                     .orientation = orientation,
	                     .spin = spin,
	                     .acceleration = acceleration,
	                     .principal = body->principal,
	                     .moments = body->moments,
	                     .grid_s = (double)INFINITY,
	                     .cached = orientation,
	                     .cached_spin = spin};

	if (top.kind == RB_TOP_CONSTANT && !is_zero(acceleration)) {
		top.kind = RB_TOP_STEADY;
		top.grid_s = parallel(spin, acceleration) ? (double)INFINITY : 0;
	}
	if (top.kind == RB_TOP_FREE) {
		if (!is_identity(body->principal))
			top.cached = rb_quat_multiply(orientation, body->principal);
		top.cached_spin = rb_quat_rotate_back(top.cached, spin);
		const rb_vec3 w = top.cached_spin;
		/* exactly about a principal axis the spin is constant */
		if ((w.x == 0) + (w.y == 0) + (w.z == 0) >= 2)
			top.kind = RB_TOP_CONSTANT;
		else
			top.grid_s = grid_of(body->moments, w);
		if (isinf(top.grid_s)) /* its square underflows: no rotation in any time */
			top.kind = RB_TOP_CONSTANT;
	}
	return top;
}

/* ---- steady: q' = (w + a t) q / 2, w and a in world axes ---- */

/*
 * Seconds from the anchor to grid point k, at which |w| t + |a| t^2 / 2, a bound on the angle, is
 * k: a radian for each step. Where the acceleration does all of it, terms fall like (t^2 / 2)^m /
 * (2^m m!), and the 32nd is below 1e-18. The root is in the form that does not cancel.
 */
static double steady_point(const struct rb_top *top, double k)
{
	const double w = rb_vec3_length(top->spin), a = rb_vec3_length(top->acceleration);

	return k > 0 ? 2 * k / (w + sqrt(w * w + 2 * a * k)) : 0;
}

static rb_vec3 steady_spin(const struct rb_top *top, double t)
{
	return rb_vec3_add_scaled(top->spin, t, top->acceleration);
}

/*
 * Taylor series of the orientation `t` seconds after `start`, where the spin is w: (n + 1) q_(n+1)
 * = (t w q_n + t^2 a q_(n-1)) / 2. Two small terms in a row end it, since each comes from the two
 * before; terms are summed from the smallest.
 */
static rb_quat steady_series(rb_quat start, rb_vec3 w, rb_vec3 acceleration, double t)
{
	const rb_quat turn1 = {0, 0.5 * t * w.x, 0.5 * t * w.y, 0.5 * t * w.z};
	const double t2 = 0.5 * t * t;
	const rb_quat turn2 = {0, t2 * acceleration.x, t2 * acceleration.y, t2 * acceleration.z};
	rb_quat term[ORDER + 1] = {start}, sum = {0, 0, 0, 0};
	int n = 0;

	for (double before = 1; n < ORDER; n++) {
		rb_quat next = rb_quat_multiply(turn1, term[n]);

		if (n > 0) {
			const rb_quat more = rb_quat_multiply(turn2, term[n - 1]);
			next = (rb_quat){next.w + more.w, next.x + more.x, next.y + more.y,
			                 next.z + more.z};
		}
		const double s = 1 / (double)(n + 1);
		term[n + 1] = (rb_quat){s * next.w, s * next.x, s * next.y, s * next.z};
		const double size = rb_quat_length(term[n + 1]);
		if (size < negligible && before < negligible)
			break;
		before = size;
	}
	for (; n >= 0; n--)
		sum = (rb_quat){sum.w + term[n].w, sum.x + term[n].x, sum.y + term[n].y,
		                sum.z + term[n].z};
	return rb_quat_unit(sum);
}

/* The last grid point not after `t`, as a double, which may exceed any integer type. */
static double steady_count(const struct rb_top *top, double t)
{
	const double w = rb_vec3_length(top->spin), a = rb_vec3_length(top->acceleration);

	return fmax(floor(t * (w + 0.5 * a * t)), 0);
}

/* Moves the cache to a grid point; backwards it starts again from the anchor. */
static void steady_walk(struct rb_top *top, uint64_t point)
{
	if (point < top->at) {
		top->at = 0;
		top->cached = top->orientation;
	}
	while (top->at < point) {
		const double here = steady_point(top, (double)top->at);
		const double there = steady_point(top, (double)(top->at + 1));

		top->cached = steady_series(top->cached, steady_spin(top, here), top->acceleration,
		                            there - here);
		top->at++;
	}
}

/* NaN beyond 2^53 radians, where the angle has no correct digit. */
static rb_quat steady_at(struct rb_top *top, double t)
{
	const double k = steady_count(top, t);

	if (!(k < grid_points_max))
		return (rb_quat){(double)NAN, (double)NAN, (double)NAN, (double)NAN};
	steady_walk(top, (uint64_t)k);
	const double here = steady_point(top, k);
	return steady_series(top->cached, steady_spin(top, here), top->acceleration, t - here);
}

bool rb_top_follow(struct rb_top *top, double t, uint64_t steps)
{
	RB_ASSERT_COSTLY(t >= 0 || isnan(t));

	const double k = top->kind == RB_TOP_STEADY && top->grid_s == 0 ? steady_count(top, t) : 0;

	if (!(k < grid_points_max) || k <= (double)top->at + (double)steps)
		return true;
	steady_walk(top, top->at + steps);
	return false;
}

double rb_top_step_s(const struct rb_top *top)
{
	if (top->kind == RB_TOP_FREE)
		return top->grid_s > 0 ? top->grid_s : HUGE_VAL;
	return top->kind == RB_TOP_STEADY && top->grid_s == 0 ? steady_point(top, 1) : HUGE_VAL;
}

/* ---- free: Euler's equations and q' = q w / 2, w in principal axes ---- */

struct motion {
	rb_quat q;   /* principal axes to world */
	double w[3]; /* principal axes, times the grid */
};

/*
 * Terms of order n + 1 from those up to n, by Cauchy products: w_x' = k_x w_y w_z and cyclic, q' =
 * q w / 2, with k = (I_y - I_z) / I_x and cyclic.
 */
static void free_term(const double k[3], double w[3][ORDER + 1], double q[4][ORDER + 1], int n)
{
	RB_ASSERT_COSTLY(n >= 0 && n < ORDER);

	double yz = 0, zx = 0, xy = 0, p[4] = {0, 0, 0, 0};

	for (int i = 0; i <= n; i++) {
		const int j = n - i;

		yz += w[1][i] * w[2][j];
		zx += w[2][i] * w[0][j];
		xy += w[0][i] * w[1][j];
		p[0] -= q[1][i] * w[0][j] + q[2][i] * w[1][j] + q[3][i] * w[2][j];
		p[1] += q[0][i] * w[0][j] + q[2][i] * w[2][j] - q[3][i] * w[1][j];
		p[2] += q[0][i] * w[1][j] - q[1][i] * w[2][j] + q[3][i] * w[0][j];
		p[3] += q[0][i] * w[2][j] + q[1][i] * w[1][j] - q[2][i] * w[0][j];
	}
	const double s = 1 / (double)(n + 1);
	w[0][n + 1] = s * k[0] * yz;
	w[1][n + 1] = s * k[1] * zx;
	w[2][n + 1] = s * k[2] * xy;
	for (int i = 0; i < 4; i++)
		q[i][n + 1] = 0.5 * s * p[i];
}

/* Sum of term[0..n] x^i. */
static double horner(const double *term, int n, double x)
{
	double sum = term[n];

	while (n-- > 0)
		sum = sum * x + term[n];
	return sum;
}

/* State `x` grid lengths after `from`, 0 <= x <= 1. */
static struct motion free_series(const struct motion *from, const double k[3], double x)
{
	double w[3][ORDER + 1], q[4][ORDER + 1];
	const double size = fmax(fabs(from->w[0]), fmax(fabs(from->w[1]), fabs(from->w[2])));
	int n = 0;

	q[0][0] = from->q.w;
	q[1][0] = from->q.x;
	q[2][0] = from->q.y;
	q[3][0] = from->q.z;
	for (int i = 0; i < 3; i++)
		w[i][0] = from->w[i];
	for (bool small = false; n < ORDER;) {
		double largest = 0;

		free_term(k, w, q, n++);
		for (int i = 0; i < 3; i++)
			largest = fmax(largest, fabs(w[i][n]) / size);
		for (int i = 0; i < 4; i++)
			largest = fmax(largest, fabs(q[i][n]));
		if (small && largest < negligible)
			break;
		small = largest < negligible;
	}
	struct motion to;
	for (int i = 0; i < 3; i++)
		to.w[i] = horner(w[i], n, x);
	to.q = rb_quat_unit((rb_quat){horner(q[0], n, x), horner(q[1], n, x), horner(q[2], n, x),
	                              horner(q[3], n, x)});
	return to;
}

/* The cached grid point, its spin times the grid length. */
static struct motion free_cached(const struct rb_top *top)
{
	const double g = top->grid_s;

	return (struct motion){
		top->cached,
		{g * top->cached_spin.x, g * top->cached_spin.y, g * top->cached_spin.z}};
}

static void free_keep(struct rb_top *top, const struct motion *m, uint64_t at)
{
	const double g = top->grid_s;

	top->at = at;
	top->cached = m->q;
	top->cached_spin = (rb_vec3){m->w[0] / g, m->w[1] / g, m->w[2] / g};
}

/* Resets the cache to the anchor. */
static void free_begin(struct rb_top *top)
{
	top->at = 0;
	top->cached = is_identity(top->principal)
	                      ? top->orientation
	                      : rb_quat_multiply(top->orientation, top->principal);
	top->cached_spin = rb_quat_rotate_back(top->cached, top->spin);
}

/* `t` seconds after the anchor, from grid point to grid point. */
static struct motion free_walk(struct rb_top *top, double t)
{
	const double i[3] = {top->moments.x, top->moments.y, top->moments.z};
	const double k[3] = {(i[1] - i[2]) / i[0], (i[2] - i[0]) / i[1], (i[0] - i[1]) / i[2]};
	const double steps = floor(t / top->grid_s);
	const uint64_t point = steps > 0 ? (uint64_t)steps : 0;

	if (point < top->at)
		free_begin(top);
	struct motion m = free_cached(top);
	if (top->at < point) {
		for (uint64_t n = top->at; n < point; n++)
			m = free_series(&m, k, 1);
		free_keep(top, &m, point);
	}
	return free_series(&m, k, t / top->grid_s - (double)point);
}

/* Arithmetic-geometric mean of two positive numbers (Abramowitz, Stegun, section 17.6). */
static double agm(double a, double b)
{
	for (int n = 0; n < 64 && fabs(a - b) > 4 * DBL_EPSILON * a; n++) {
		const double mean = 0.5 * (a + b);

		b = sqrt(a * b);
		a = mean;
	}
	return a;
}

/*
 * Period of the spin in the body's axes, s: 4 K(m) / p (Landau, Lifshitz, Mechanics, section 37),
 * about the axis of the largest moment or of the smallest, with differences of L^2 and 2 E I
 * written without cancellation. INFINITY on the border between the two.
 */
static double free_period(rb_vec3 moments, rb_vec3 spin)
{
	const double i[3] = {moments.x, moments.y, moments.z}, w[3] = {spin.x, spin.y, spin.z};
	int least = 0, max = 0;

	for (int n = 1; n < 3; n++) {
		least = i[n] < i[least] ? n : least;
		max = i[n] >= i[max] ? n : max;
	}
	RB_ASSERT(least != max);
	const int middle = 3 - least - max;
	const double low = i[middle] - i[least], high = i[max] - i[middle], all = i[max] - i[least];
	/* L^2 - 2 E I of the least and of the middle, 2 E I - L^2 of the largest */
	const double over = i[middle] * low * w[middle] * w[middle] +
	                    i[max] * all * w[max] * w[max];
	const double under = i[least] * all * w[least] * w[least] +
	                     i[middle] * high * w[middle] * w[middle];
	const double side = i[max] * high * w[max] * w[max] - i[least] * low * w[least] * w[least];
	const double rate = (side > 0 ? high * over : low * under);
	const double rest = all * fabs(side) / rate; /* 1 - m */
	const double product = i[least] * i[middle] * i[max];

	return rest > 0 ? 2 * pi / agm(1, sqrt(rest)) * sqrt(product / rate) : HUGE_VAL;
}

/*
 * Finds the period and the precession over it: after a period the spin repeats in the body's axes,
 * so the orientation differs by a turn about the angular momentum only.
 */
static void free_learn(struct rb_top *top)
{
	free_begin(top);
	const rb_quat start = top->cached;
	const rb_vec3 w = top->cached_spin, i = top->moments;
	const rb_vec3 momentum = rb_quat_rotate(start, (rb_vec3){i.x * w.x, i.y * w.y, i.z * w.z});

	top->period_s = free_period(i, w);
	if (isinf(top->period_s))
		return;
	const rb_vec3 about = rb_vec3_scale(1 / rb_vec3_length(momentum), momentum);
	const rb_quat end = free_walk(top, top->period_s).q;
	const rb_quat d = rb_quat_multiply(end, conjugate(start));
	const double along = rb_vec3_dot((rb_vec3){d.x, d.y, d.z}, about);
	top->precession = rb_vec3_scale(2 * atan2(along, d.w), about);
}

static void free_at(struct rb_top *top, double t, rb_quat *orientation, rb_vec3 *spin)
{
	const double steps = t / top->grid_s;
	double periods = 0;

	/* as in steady_at: the orientation so far from the anchor has no correct digit */
	if (!(steps < grid_points_max)) {
		*orientation = (rb_quat){(double)NAN, (double)NAN, (double)NAN, (double)NAN};
		*spin = (rb_vec3){(double)NAN, (double)NAN, (double)NAN};
		return;
	}
	if (steps > leap_from) {
		if (!(top->period_s > 0))
			free_learn(top);
		periods = floor(t / top->period_s);
		if (periods > 0)
			t = fmax(fma(-periods, top->period_s, t), 0);
	}
	struct motion m = free_walk(top, t);
	if (periods > 0)
		m.q = rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(periods, top->precession)),
		                       m.q);
	const rb_vec3 w = {m.w[0] / top->grid_s, m.w[1] / top->grid_s, m.w[2] / top->grid_s};
	const bool turned = !is_identity(top->principal);
	*orientation = turned ? rb_quat_multiply(m.q, conjugate(top->principal)) : m.q;
	*spin = rb_quat_rotate(m.q, w);
}

/* ---- symmetric ---- */

/*
 * Precession about the angular momentum at the rate L / I1 after a turn about the symmetry axis at
 * the rate w_axis (I1 - I3) / I1 (Landau, Lifshitz, Mechanics, section 35). In the world frame the
 * precession vector is w - rate * axis.
 */
static void symmetric_at(const struct rb_top *top, double t, rb_quat *orientation, rb_vec3 *spin)
{
	const rb_vec3 axis = rb_quat_rotate(top->principal, (rb_vec3){0, 0, 1});
	const double along = rb_vec3_dot(rb_quat_rotate_back(top->orientation, top->spin), axis);
	const double rate = along * ((top->moments.x - top->moments.z) / top->moments.x);
	const rb_vec3 precession = rb_vec3_add_scaled(top->spin, -rate,
	                                              rb_quat_rotate(top->orientation, axis));
	const rb_quat about = turn(precession, t);

	*orientation = rb_quat_multiply(
		about, rb_quat_multiply(top->orientation, turn(rb_vec3_scale(rate, axis), t)));
	*spin = rb_quat_rotate(about, top->spin);
}

void rb_top_at(struct rb_top *top, double t, rb_quat *orientation, rb_vec3 *spin)
{
	rb_quat q = top->orientation;
	rb_vec3 w = top->spin;

	if (t != 0) {
		switch (top->kind) {
		case RB_TOP_CONSTANT:
			if (!is_zero(w))
				q = rb_quat_multiply(turn(w, t), q);
			break;
		case RB_TOP_STEADY:
			w = steady_spin(top, t);
			if (isinf(top->grid_s))
				q = rb_quat_multiply(turn(steady_spin(top, 0.5 * t), t), q);
			else if (orientation)
				q = steady_at(top, t);
			break;
		case RB_TOP_SYMMETRIC:
			symmetric_at(top, t, &q, &w);
			break;
		case RB_TOP_FREE:
			free_at(top, t, &q, &w);
			break;
		}
		q = rb_quat_unit(q);
	}
	if (orientation)
		*orientation = q;
	if (spin)
		*spin = w;
}

/* ---- a step ---- */

/*
 * Largest angle of a step times the largest ratio of moments for which Newton's iteration converges
 * from the spin before; beyond it the exact solution is used.
 */
static const double step_turn_max = 0.25;

/*
 * The mean m of the spins before and after, in principal axes, of the implicit midpoint rule: m = w
 * + s k (m x m), with s half the step. Newton's steps square their error, which begins below 1/16.
 */
static rb_vec3 mean_spin(rb_vec3 k, rb_vec3 w, double s)
{
	enum { STEPS = 4 };
	const rb_vec3 a = rb_vec3_scale(s, k);
	rb_vec3 m = w;

	for (int n = 0; n < STEPS; n++) {
		const rb_vec3 f = {w.x + a.x * (m.y * m.z) - m.x, w.y + a.y * (m.z * m.x) - m.y,
		                   w.z + a.z * (m.x * m.y) - m.z};
		const rb_mat3 slope = {{{1, -a.x * m.z, -a.x * m.y},
		                        {-a.y * m.z, 1, -a.y * m.x},
		                        {-a.z * m.y, -a.z * m.x, 1}}};
		rb_mat3 inverse;

		if (!rb_mat3_inverse(&slope, &inverse))
			break;
		const rb_vec3 more = rb_mat3_apply(&inverse, f);
		m = rb_vec3_add(m, more);
		if (rb_vec3_max_abs(more) <= 1e-8 * rb_vec3_max_abs(m))
			break; /* the next one would be rounding */
	}
	return m;
}

/*
 * The midpoint rule conserves quadratic invariants: kinetic energy and |L|; the rotation by
 * Cayley's map of the same mean spin conserves L itself (Simo, Wong 1991). Both hold for any step
 * length; this one makes a constant spin rotate by w h.
 */
static void step_free(const struct rb_top_body *body, double h, rb_vec3 k, rb_quat *orientation,
                      rb_vec3 *spin)
{
	const bool turned = !is_identity(body->principal);
	const rb_quat axes = turned ? rb_quat_multiply(*orientation, body->principal)
	                            : *orientation;
	const rb_vec3 w = rb_quat_rotate_back(axes, *spin);
	const double half = 0.5 * h * rb_vec3_length(w);
	const double s = 0.5 * h * (half > 1e-4 ? tan(half) / half : 1 + half * half / 3);
	const rb_vec3 m = mean_spin(k, w, s);
	const rb_quat more = rb_quat_unit((rb_quat){1, s * m.x, s * m.y, s * m.z});
	const rb_quat end = rb_quat_unit(rb_quat_multiply(axes, more));

	*spin = rb_quat_rotate(end, rb_vec3_sub(rb_vec3_scale(2, m), w));
	*orientation = turned ? rb_quat_multiply(end, conjugate(body->principal)) : end;
}

void rb_top_step(const struct rb_top_body *body, double h, rb_quat *orientation, rb_vec3 *spin)
{
	RB_ASSERT_COSTLY(h >= 0);

	const rb_vec3 i = body->moments, none = {0, 0, 0};
	const rb_vec3 k = {(i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z};
	const double turn_angle = h * rb_vec3_length(*spin) * fmax(1, rb_vec3_max_abs(k));

	if (body->kind == RB_TOP_FREE && turn_angle <= step_turn_max) {
		step_free(body, h, k, orientation, spin);
		return;
	}
	struct rb_top top = rb_top_start(body, *orientation, *spin, none);
	rb_top_at(&top, h, orientation, spin);
}
