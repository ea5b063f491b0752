/* SPDX-License-Identifier: MIT */
#include "event/bounds.h"

#include <float.h>

/* Of three rows of a piece: the sums of bounds on their rates, and on the rates of these: |P_k'| <= k (k + 1). */
static double rates_most(const struct rb_gauss_piece *p, int first)
{
	return rb_gauss_rate_bound(p, first) + rb_gauss_rate_bound(p, first + 1) +
	       rb_gauss_rate_bound(p, first + 2);
}

static double second_rates_most(const struct rb_gauss_piece *p, int first)
{
	double sum = 0;

	for (int k = RB_GAUSS_NODES - 1; k > 0; k--)
		for (int m = 0; m < 3; m++)
			sum += k * (k + 1) * fabs(p->coefficient[k * p->n + first + m]);
	return sum * (1 + 64 * DBL_EPSILON) / (p->length_s * p->length_s);
}

/*
 * The spin of a free top. With energy T and momentum L, the squares x_k of its components have sum I_k x_k = 2 T and
 * sum I_k^2 x_k = L^2, so that the largest sum x_k has one of them at zero. Where two moments are too near each other to
 * tell, the energy alone bounds it. Its rate: |I_j - I_k| <= I_i in Euler's equations, and of three products of two
 * components the root of the sum of squares is at most the square of the length over the root of three.
 */
static void free_spin(const struct rb_top_body *body, const struct rb_top *top,
                      struct rb_bounds *most)
{
	const rb_vec3 local = rb_quat_rotate_back(body->principal,
	                                          rb_quat_rotate_back(top->orientation, top->spin));
	const double w[3] = {local.x, local.y, local.z};
	const double moment[3] = {body->moments.x, body->moments.y, body->moments.z};
	double energy = 0, momentum = 0, square = 0;

	for (int k = 0; k < 3; k++) {
		energy += moment[k] * w[k] * w[k];
		momentum += moment[k] * moment[k] * w[k] * w[k];
		square += w[k] * w[k];
	}
	if (body->kind == RB_TOP_SYMMETRIC) { /* it keeps its length */
		const double across = sqrt(w[0] * w[0] + w[1] * w[1]);

		most->turning = across * fabs(w[2]) * fabs(moment[2] - moment[0]) / moment[0];
		return;
	}
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3;
		const double p = moment[i], q = moment[j];
		const double x = (momentum - q * energy) / (p * (p - q));
		const double y = (momentum - p * energy) / (q * (q - p));

		if (fabs(p - q) <= 1e-3 * p)
			square = fmax(square, energy / fmin(p, q));
		else if (x >= 0 && y >= 0)
			square = fmax(square, x + y);
	}
	most->turn = 1.001 * sqrt(square);
	most->turning = square / sqrt(3.0);
}

struct rb_bounds rb_bounds_of(const struct rb_located *l, int i)
{
	struct rb_bounds most = {0};
	double turning_rate = 0;

	if (i >= l->n)
		return most;
	if (rb_located_on_piece(l, i)) {
		const struct rb_piece_of *p = &l->piece[i];

		most.pull = p->acceleration_most;
		most.jerk = second_rates_most(&p->piece, p->first + RB_ROW_VELOCITY);
		if (l->top) {
			const double *spin = p->piece.start + p->first + RB_ROW_SPIN;

			most.turning = rates_most(&p->piece, p->first + RB_ROW_SPIN);
			most.turn = rb_vec3_length(rb_vec3_from(spin)) +
			            p->piece.length_s * most.turning;
			turning_rate = second_rates_most(&p->piece, p->first + RB_ROW_SPIN);
		}
	} else {
		most.pull = rb_vec3_length(l->arc[i].acceleration);
		if (l->top) {
			most.turn = rb_vec3_length(l->top[i].spin);
			most.turning = rb_vec3_length(l->top[i].acceleration);
			if (l->top_body[i].kind != RB_TOP_CONSTANT) {
				free_spin(&l->top_body[i], &l->top[i], &most);
				turning_rate = 2 * most.turn * most.turning;
			}
		}
	}
	most.own_pull = most.pull;
	if (l->model->center_of_mass) {
		const double arm = rb_vec3_length(l->model->center_of_mass[i]), w = most.turn;

		most.pull += arm * (w * w + most.turning);
		most.jerk += arm * (w * w * w + 3 * w * most.turning + turning_rate);
	}
	return most;
}
