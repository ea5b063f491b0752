/* SPDX-License-Identifier: MIT */
#include "located/relative.h"

#include <float.h>

#include "base/error.h"

bool rb_relative_is(const struct rb_located *l, int a, int b)
{
	return rb_located_gravitates(l) && !l->model->center_of_mass && rb_located_on_piece(l, a) &&
	       rb_located_on_piece(l, b) &&
	       l->piece[a].piece.coefficient == l->piece[b].piece.coefficient;
}

/* Difference of the k-th coefficients of three rows. */
static rb_vec3 coefficient_of(const struct rb_located *l, int a, int b, int row, int k)
{
	const struct rb_gauss_piece *const p = &l->piece[a].piece;
	const double *const c = p->coefficient + (size_t)k * (size_t)p->n;

	return rb_vec3_sub(rb_vec3_from(c + l->piece[b].first + row),
	                   rb_vec3_from(c + l->piece[a].first + row));
}

/* Difference of three rows at the beginning. */
static rb_vec3 start_of(const struct rb_located *l, int a, int b, int row)
{
	const double *const start = l->piece[a].piece.start;

	return rb_vec3_sub(rb_vec3_from(start + l->piece[b].first + row),
	                   rb_vec3_from(start + l->piece[a].first + row));
}

/* From a's centre to b's at the beginning. */
static rb_vec3 began_at(const struct rb_located *l, int a, int b)
{
	return rb_vec3_add(rb_vec3_sub(l->piece[b].base, l->piece[a].base),
	                   start_of(l, a, b, RB_PIECE_POSITION));
}

void rb_relative_bounds(const struct rb_located *l, int a, int b, double *external, double *jerk)
{
	const double length = l->piece[a].piece.length_s;
	rb_vec3 sum = {0, 0, 0};
	double rates = 0;

	RB_ASSERT_COSTLY(rb_relative_is(l, a, b));
	/* |P_k| <= 1 and |P_k'| <= k (k + 1) on [0, 1] */
	for (int k = RB_GAUSS_NODES - 1; k >= 0; k--) {
		const rb_vec3 c = coefficient_of(l, a, b, RB_PIECE_VELOCITY, k);
		const rb_vec3 size = {fabs(c.x), fabs(c.y), fabs(c.z)};

		sum = rb_vec3_add(sum, size);
		rates += k * (k + 1) * (size.x + size.y + size.z);
	}
	const double margin = 1 + 64 * DBL_EPSILON;
	*external = margin * rb_vec3_length(sum) / length;
	*jerk = margin * rates / (length * length);
}

bool rb_relative_began_far(const struct rb_located *l, int a, int b, double until, double least)
{
	const double age = until - l->piece[a].origin_s;
	const rb_vec3 d = began_at(l, a, b), w = start_of(l, a, b, RB_PIECE_VELOCITY);
	double external, jerk;

	rb_relative_bounds(l, a, b, &external, &jerk);
	const double way = age * (rb_vec3_length(w) + 0.5 * external * age);
	/* 1e-12 is far above the rounding of positions, speeds and time */
	return rb_vec3_length(d) >
	       1.001 * (least + way) + 1e-12 * (rb_vec3_max_abs(l->piece[a].base) +
	                                        rb_vec3_max_abs(l->piece[b].base));
}

/* The squared distance is a polynomial of degree 16 in time, which this many points determine. */
enum { POINTS = 18 };
/*
 * Zeros of the Chebyshev polynomial of that degree: cos(pi (2 j + 1)/36); the others mirror these.
 */
static const double zeros[POINTS / 2] = {
	0.99619469809174553, 0.96592582628906829, 0.90630778703664996,
	0.81915204428899180, 0.70710678118654752, 0.57357643635104610,
	0.42261826174069944, 0.25881904510252076, 0.08715574274765817};

/* Squared distance less that of `least`, m^2, at a fraction of the piece. */
static double excess(const rb_vec3 coefficient[RB_GAUSS_NODES], rb_vec3 d, double part,
                     double least)
{
	double value[RB_GAUSS_NODES], rate[RB_GAUSS_NODES];

	rb_gauss_basis(part, value, rate);
	for (int k = RB_GAUSS_NODES - 1; k >= 0; k--)
		d = rb_vec3_add_scaled(d, value[k], coefficient[k]);
	const double length = rb_vec3_length(d);
	return (length - least) * (length + least);
}

bool rb_relative_is_separated(const struct rb_located *l, int a, int b, double from, double until,
                              double least)
{
	const struct rb_piece_of *const p = &l->piece[a];
	const double begin = (from - p->origin_s) / p->piece.length_s;
	const double half = 0.5 * (until - from) / p->piece.length_s, middle = begin + half;
	rb_vec3 coefficient[RB_GAUSS_NODES];
	const rb_vec3 d = began_at(l, a, b);
	double sum[POINTS] = {0}, mean = 0, spread = 0;

	RB_ASSERT_COSTLY(rb_relative_is(l, a, b));
	for (int k = 0; k < RB_GAUSS_NODES; k++)
		coefficient[k] = coefficient_of(l, a, b, RB_PIECE_POSITION, k);
	for (int j = 0; j < POINTS; j++) {
		const double x = j < POINTS / 2 ? zeros[j] : -zeros[POINTS - 1 - j];
		const double f = excess(coefficient, d, middle + half * x, least);
		double before = 1, now = x;

		if (!(f > 0))
			return false;
		mean += f / POINTS;
		for (int k = 1; k < POINTS; k++) {
			const double next = 2 * x * now - before;

			sum[k] += f * now;
			before = now;
			now = next;
		}
	}
	for (int k = 1; k < POINTS; k++)
		spread += fabs(sum[k]) * 2 / POINTS;
	/* rounding of the sums, and of the square, which is that of coordinates */
	const double rounding = 64 * DBL_EPSILON *
	                        (mean + spread + least * (least + rb_vec3_max_abs(d)));
	return mean - spread > rounding;
}

/* ---- parabolas ---- */

struct rb_parabola rb_relative_parabola(const struct rb_located *l, int i, double from_s)
{
	const rb_vec3 none = {0, 0, 0};

	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (i >= l->n)
		return (struct rb_parabola){l->model->position[i], none, none, 0, 0};
	if (rb_arc_decay(l, i) > 0) {
		/* it decays from this value towards zero: half of it is within half of it */
		const rb_vec3 a = rb_vec3_scale(0.5, rb_arc_acceleration(l, i, from_s));

		return (struct rb_parabola){rb_arc_position(l, i, from_s),
		                            rb_arc_velocity(l, i, from_s), a, rb_vec3_length(a), 0};
	}
	if (!rb_located_on_piece(l, i))
		return (struct rb_parabola){rb_arc_position(l, i, from_s),
		                            rb_arc_velocity(l, i, from_s), l->arc[i].acceleration,
		                            0, 0};
	const struct rb_piece_of *const p = &l->piece[i];
	const struct rb_gauss_piece *const piece = &p->piece;
	const double *const start = piece->start + p->first;
	const double *c = piece->coefficient + p->first + RB_PIECE_VELOCITY;
	const double per_s = 1 / piece->length_s, age = from_s - p->origin_s;
	const rb_vec3 a = rb_vec3_scale(per_s, rb_vec3_from(c));
	const rb_vec3 v = rb_vec3_from(start + RB_PIECE_VELOCITY);
	const rb_vec3 way = rb_vec3_add_scaled(rb_vec3_from(start + RB_PIECE_POSITION), age,
	                                       rb_vec3_add_scaled(v, 0.5 * age, a));
	rb_vec3 off = none;

	/* the first coefficient is the mean; for the others |P_k| <= 1 */
	for (int k = 1; k < RB_GAUSS_NODES; k++) {
		c += piece->n;
		off = rb_vec3_add(off, (rb_vec3){fabs(c[0]), fabs(c[1]), fabs(c[2])});
	}
	return (struct rb_parabola){rb_vec3_add(p->base, way), rb_vec3_add_scaled(v, age, a), a,
	                            per_s * rb_vec3_length(off), age};
}

/* Bound on the distance of a body from its parabola up to h seconds later, m. */
static double deviation_max(const struct rb_parabola *p, double h)
{
	return 0.5 * p->off * (p->age + h) * (p->age + h);
}

/* Far above the rounding of positions, speeds and time. */
static const double rounding_share = 1e-12;

bool rb_relative_stay_separated(const struct rb_parabola *a, const struct rb_parabola *b, double h,
                                double least)
{
	const rb_vec3 d = rb_vec3_sub(b->position, a->position);
	const rb_vec3 w = rb_vec3_sub(b->velocity, a->velocity);
	const rb_vec3 bend = rb_vec3_sub(b->acceleration, a->acceleration);
	const double closing = -rb_vec3_dot(d, w), square = rb_vec3_dot(w, w);
	/* the time at which straight lines are nearest */
	double s = 0;

	if (closing > 0)
		s = closing < square * h ? closing / square : h;
	const double margin = least + 0.5 * h * h * rb_vec3_length(bend) + deviation_max(a, h) +
	                      deviation_max(b, h);

	return rb_vec3_length(rb_vec3_add_scaled(d, s, w)) >
	       1.001 * margin + rounding_share * (rb_vec3_max_abs(a->position) +
	                                          rb_vec3_max_abs(b->position) + s * sqrt(square));
}

bool rb_relative_remain_above(const struct rb_parabola *a, rb_vec3 point, rb_vec3 n, double h,
                              double least)
{
	const double gap = rb_vec3_dot(rb_vec3_sub(a->position, point), n);
	const double change = h * rb_vec3_dot(a->velocity, n);
	const double margin = least + 0.5 * h * h * fabs(rb_vec3_dot(a->acceleration, n)) +
	                      deviation_max(a, h);

	return gap + fmin(change, 0) >
	       1.001 * margin + rounding_share * (rb_vec3_max_abs(a->position) +
	                                          rb_vec3_max_abs(point) + fabs(change));
}
