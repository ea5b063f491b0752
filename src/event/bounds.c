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
			/* a free top's spin is bounded through its angular momentum and the moments */
			const struct rb_top_body *body = &l->top_body[i];
			const double low = fmin(body->moments.x,
			                        fmin(body->moments.y, body->moments.z));
			const double high = rb_vec3_max_abs(body->moments);

			most.turn = rb_vec3_length(l->top[i].spin);
			if (body->kind != RB_TOP_CONSTANT && low > 0) {
				most.turn *= high / low;
				most.turning = most.turn * most.turn;
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
