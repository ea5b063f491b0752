/* SPDX-License-Identifier: MIT */
/*
 * Bounds on acceleration and rotation over an arc or piece, for conservative advancement. With
 * linear drag, the initial acceleration is the largest. Free rotation is bounded by the conserved
 * energy and angular momentum, pieces by the sum of their Legendre coefficients (|P_k| <= 1 on
 * [0, 1]).
 */
#include "located/bounds.h"

#include "base/error.h"

#include <float.h>

/* Bound on the rate of three rows of a piece, the sum of the rows' bounds. */
static double rates_max(const struct rb_gauss_piece *p, int first)
{
	return rb_gauss_rate_bound(p, first) + rb_gauss_rate_bound(p, first + 1) +
	       rb_gauss_rate_bound(p, first + 2);
}

/*
 * Bound on their second rate, by |P_k'| <= k (k + 1) on [0, 1] (Markov), with a margin for
 * rounding.
 */
static double second_rates_max(const struct rb_gauss_piece *p, int first)
{
	double sum = 0;

	for (int k = RB_GAUSS_NODES - 1; k > 0; k--)
		for (int m = 0; m < 3; m++)
			sum += k * (k + 1) * fabs(p->coefficient[k * p->n + first + m]);
	return sum * (1 + 64 * DBL_EPSILON) / (p->length_s * p->length_s);
}

/*
 * Bounds for an axis of a body on a piece: tight for one that spins about it, as when it rolls. The
 * axis u turns with w x u; while it is within `off` of where it began, that is at most |w| off plus
 * the components of w across its beginning, so that `off` grows as exp(|w| t) - 1 does.
 */
static void piece_axis_rates(const struct rb_piece_of *p, struct rb_bounds *max)
{
	const double *const start = p->piece.start + p->first;
	const rb_quat q = rb_quat_from(start + RB_PIECE_ORIENTATION);
	const rb_vec3 u = rb_quat_rotate(q, max->axis);
	const double turned = max->turn * p->piece.length_s;
	double across = 0;

	if (!(turned < 1))
		return;
	for (int k = RB_GAUSS_NODES - 1; k >= 0; k--) {
		const double *const rate = p->piece.coefficient + (size_t)k * (size_t)p->piece.n +
		                           p->first + RB_PIECE_SPIN;

		across += rb_vec3_length(rb_vec3_reject(rb_vec3_from(rate), u));
	}
	/* 1.001: a margin above rounding */
	const double turning = 1.001 * across / p->piece.length_s;
	const double spin = 1.001 * (rb_vec3_length(rb_vec3_reject(
					     rb_vec3_from(start + RB_PIECE_SPIN), u)) +
	                             across);
	const double off = max->turn > 0 ? spin * expm1(turned) / max->turn : 0;

	max->axis_turn = fmin(max->turn, max->turn * off + spin);
	max->axis_bend = fmin(max->axis_bend,
	                      max->turning * off + turning + max->turn * max->axis_turn);
}

/* Components, moments and invariants of a free body's rotation in principal axes. */
struct spinning {
	double w[3], moment[3];
	double energy, momentum, square; /* twice the energy; squares of momentum and spin */
};

static struct spinning spinning_of(const struct rb_top_body *body, const struct rb_top *top)
{
	const rb_vec3 local = rb_quat_rotate_back(body->principal,
	                                          rb_quat_rotate_back(top->orientation, top->spin));
	struct spinning s = {{local.x, local.y, local.z},
	                     {body->moments.x, body->moments.y, body->moments.z},
	                     0,
	                     0,
	                     0};

	for (int k = 0; k < 3; k++) {
		s.energy += s.moment[k] * s.w[k] * s.w[k];
		s.momentum += s.moment[k] * s.moment[k] * s.w[k] * s.w[k];
		s.square += s.w[k] * s.w[k];
	}
	return s;
}

/*
 * Bound on the spin of a free top. With energy T and momentum L, the squares x_k of its components
 * satisfy sum I_k x_k = 2 T and sum I_k^2 x_k = L^2, so the largest sum x_k has one of them at
 * zero. If two moments are nearly equal, the energy alone bounds it. For its rate: |I_j - I_k| <=
 * I_i in Euler's equations, and the root of the sum of squares of the three products of two
 * components is at most the squared length over the root of three.
 */
static void free_spin(const struct spinning *s, struct rb_bounds *max)
{
	double square = s->square;

	for (int i = 0; i < 3; i++) {
		const double p = s->moment[i], q = s->moment[(i + 1) % 3];
		const double x = (s->momentum - q * s->energy) / (p * (p - q));
		const double y = (s->momentum - p * s->energy) / (q * (q - p));

		if (fabs(p - q) <= 1e-3 * p)
			square = fmax(square, s->energy / fmin(p, q));
		else if (x >= 0 && y >= 0)
			square = fmax(square, x + y);
	}
	/* 1.001 here and below: a margin above rounding, which costs a thousandth of a step */
	max->turn = 1.001 * sqrt(square);
	max->turning = square / sqrt(3.0);
}

/*
 * Bounds for the axis of the smallest moment, or for a symmetric top's own, which moves less than
 * other points. With a, b the components of the spin perpendicular to it and c along it, Euler's
 * equations give e'' = (a L_3 / I_2 + a c (1 - I_1 / I_2)) e_1 + (b L_3 / I_1 + b c (1 - I_2 /
 * I_1)) e_2 - (a^2 + b^2) e for the axis e; momentum bounds a and b.
 */
static void axis_rates(const struct rb_top_body *body, const struct spinning *s,
                       struct rb_bounds *max)
{
	int k = 2;

	if (body->kind != RB_TOP_SYMMETRIC)
		for (int i = 0; i < 2; i++)
			if (s->moment[i] < s->moment[k])
				k = i;
	const double p = s->moment[(k + 1) % 3], q = s->moment[(k + 2) % 3];
	const double least = fmin(p, q);
	double across = sqrt(s->momentum) / least, along = sqrt(s->momentum);

	max->axis = rb_quat_rotate(body->principal, (rb_vec3){k == 0, k == 1, k == 2});
	if (body->kind == RB_TOP_SYMMETRIC) {
		across = sqrt(s->w[0] * s->w[0] + s->w[1] * s->w[1]);
		along = fabs(s->w[2]) * s->moment[2];
	}
	max->axis_turn = 1.001 * fmin(across, max->turn);
	max->axis_bend = 1.001 * across * (across + (along + max->turn * fabs(p - q)) / least);
}

/* Bounds for a body without torque whose moments differ. */
static void free_top(const struct rb_top_body *body, const struct rb_top *top,
                     struct rb_bounds *max)
{
	const struct spinning s = spinning_of(body, top);

	if (body->kind == RB_TOP_SYMMETRIC) { /* the spin of a symmetric top keeps its length */
		const double across = sqrt(s.w[0] * s.w[0] + s.w[1] * s.w[1]);

		max->turning = across * fabs(s.w[2]) * fabs(s.moment[2] - s.moment[0]) /
		               s.moment[0];
	} else {
		free_spin(&s, max);
	}
	axis_rates(body, &s, max);
}

struct rb_bounds rb_bounds_of(const struct rb_located *l, int i)
{
	struct rb_bounds max = {.axis = {0, 0, 1}};
	double turning_rate = 0;
	bool is_free = false;

	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (i >= l->n)
		return max;
	if (rb_located_on_piece(l, i)) {
		const struct rb_piece_of *p = &l->piece[i];

		max.external = p->acceleration_max;
		max.jerk = second_rates_max(&p->piece, p->first + RB_PIECE_VELOCITY);
		if (l->top) {
			const double *spin = p->piece.start + p->first + RB_PIECE_SPIN;

			max.turning = rates_max(&p->piece, p->first + RB_PIECE_SPIN);
			max.turn = rb_vec3_length(rb_vec3_from(spin)) +
			           p->piece.length_s * max.turning;
			turning_rate = second_rates_max(&p->piece, p->first + RB_PIECE_SPIN);
		}
	} else {
		max.external = rb_arc_acceleration_max(l, i);
		max.jerk = rb_arc_decay(l, i) * max.external;
		if (l->top) {
			max.turn = rb_vec3_length(l->top[i].spin);
			max.growing = max.turning = rb_vec3_length(l->top[i].acceleration);
			is_free = l->top_body[i].kind != RB_TOP_CONSTANT;
			if (is_free) {
				free_top(&l->top_body[i], &l->top[i], &max);
				turning_rate = 2 * max.turn * max.turning;
			}
		}
	}
	max.own_external = max.external;
	if (!is_free) {
		max.axis_turn = max.turn;
		max.axis_bend = max.turn * max.turn + max.turning;
		if (l->top && rb_located_on_piece(l, i))
			piece_axis_rates(&l->piece[i], &max);
	}
	if (l->model->center_of_mass) {
		const double arm = rb_vec3_length(l->model->center_of_mass[i]), w = max.turn;

		max.external += arm * (w * w + max.turning);
		max.jerk += arm * (w * w * w + 3 * w * max.turning + turning_rate);
	}
	return max;
}

double rb_bounds_along(const struct rb_located *l, int i, rb_vec3 n, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (!rb_located_on_piece(l, i)) {
		const double now = rb_vec3_dot(n, rb_arc_acceleration(l, i, t));

		return rb_arc_decay(l, i) > 0 ? fmax(now, 0) : now;
	}
	const struct rb_piece_of *p = &l->piece[i];
	double max = 0;

	/* Legendre polynomials are within [-1, 1], and the first of them is 1 */
	for (int k = 0; k < RB_GAUSS_NODES; k++) {
		const double *const row = p->piece.coefficient + (size_t)k * (size_t)p->piece.n +
		                          p->first + RB_PIECE_VELOCITY;
		const double along = rb_vec3_dot(n, rb_vec3_from(row));

		max += k > 0 ? fabs(along) : along;
	}
	return max / p->piece.length_s;
}
