/* SPDX-License-Identifier: MIT */
#include "located/singular.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/error.h"

/* Of the largest share of a row at nodes, the least one, where they pass such a position. */
static const double passes = 0x1p-3;
/* Of scale: what rounding may make of a step; more only where there is no better one. */
static const double granted[] = {0x1p-38, 0x1p-33, 0x1p-28};
/* What rounding makes of it at least, in ulp over the cube of that angle. */
static const double noise_ulp = 4;
/* Lengths that are tried: sixteenths of the first one, from all down to half of it. */
enum { LENGTHS = 16 };

static double *shares(const struct rb_modes *w, int node)
{
	return w->singular.share + (size_t)node * (size_t)w->joints.count;
}

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return x < y ? -1 : x > y;
}

/* Of the last evaluation, by size: which of redundant rows is left to the end rounding decides. */
static void keep_shares(const struct rb_modes *w, int node)
{
	rb_dense_shares(&w->dense, shares(w, node));
	qsort(shares(w, node), (size_t)w->joints.count, sizeof(double), compare);
}

/* Of what is left of a row at one of so many nodes the least, as a share of the most at another. */
static double least_share(const struct rb_modes *w, int nodes)
{
	double least = 1;

	for (int k = 0; k < w->joints.count; k++) {
		double low = HUGE_VAL, high = 0;

		for (int j = 0; j < nodes; j++) {
			low = fmin(low, shares(w, j)[k]);
			high = fmax(high, shares(w, j)[k]);
		}
		if (low < least * high)
			least = low / high;
	}
	return least;
}

static bool is_near(const struct rb_modes *w)
{
	return w->singular.seen > RB_GAUSS_NODES && least_share(w, RB_GAUSS_NODES) < passes;
}

static double noise(void *user, const double *coefficient)
{
	const struct rb_modes *w = user;
	const double by_field = w->l->model->features & RB_FEATURE_FIELD
	                                ? rb_modes_noise(user, coefficient)
	                                : 0;

	return fmax(by_field, is_near(w) ? w->singular.granted : 0);
}

/* Is a step worth going on? The first rates are those of its beginning. */
static bool is_worthwhile(const struct rb_modes *w)
{
	const double share = w->singular.seen > RB_GAUSS_NODES ? least_share(w, RB_GAUSS_NODES) : 0;

	return w->singular.seen <= RB_GAUSS_NODES ||
	       (share < passes &&
	        noise_ulp * DBL_EPSILON <= w->singular.granted * share * sqrt(share));
}

static enum rb_status rates(void *user, double t, const double *value, double *rate,
                            struct rb_error *err)
{
	struct rb_modes *const w = user;
	const enum rb_status status = rb_rates_of(w)(w, t, value, rate, err);

	if (status != RB_OK)
		return status;
	keep_shares(w, w->singular.seen++ % RB_GAUSS_NODES);
	if (!is_worthwhile(w))
		return RB_FAIL(err, RB_ERR_PHYSICS, "a node is next to a singular position");
	return RB_OK;
}

/* A step of that length and no other. */
static enum rb_status attempt(struct rb_modes *w, const struct rb_gauss_problem *problem,
                              double length_s, double *try_s)
{
	*try_s = length_s;
	w->singular.seen = 0;
	return rb_gauss_step(problem, w->origin_s, try_s, 0.75 * length_s, &w->c->piece, w->l->err);
}

/* Such poses, with so much rounding granted; the longest length that will do. */
static enum rb_status pass(struct rb_modes *w, const struct rb_gauss_problem *problem, double tried,
                           double grant, double *try_s)
{
	enum rb_status status = RB_ERR_PHYSICS;

	struct rb_gauss_problem nearest = *problem;

	nearest.rates = rates;
	nearest.noise = noise;
	w->singular = (struct rb_singular_piece){
		.closed = true, .share = w->singular.share, .projects = true, .granted = grant};
	for (int k = LENGTHS; k > LENGTHS / 2 && status == RB_ERR_PHYSICS; k--) {
		status = attempt(w, &nearest, tried * k / LENGTHS, try_s);
		if (w->l->status != RB_OK || !is_near(w))
			break;
	}
	w->singular.projects = status != RB_ERR_PHYSICS;
	return status;
}

enum rb_status rb_singular_step(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                double least_s, double *try_s)
{
	const double tried = *try_s;
	enum rb_status status;

	w->singular.projects = false;
	w->singular.closed = w->c->held_count == 0 && w->joints.count > 0 &&
	                     w->joints.count <= RB_MODES_DENSE &&
	                     rb_joint_rows_is_closed(&w->joints);
	if (w->singular.closed && !w->singular.share)
		w->singular.share = rb_arena_take(
			w->l->arena, RB_GAUSS_NODES * (size_t)w->joints.count, sizeof(double));
	if (!w->singular.closed || !w->singular.share)
		return rb_gauss_step(problem, w->origin_s, try_s, least_s, &w->c->piece, w->l->err);
	status = attempt(w, problem, tried, try_s);
	for (size_t m = 0; m < sizeof granted / sizeof *granted; m++)
		if (status == RB_ERR_PHYSICS && w->l->status == RB_OK)
			status = pass(w, problem, tried, granted[m], try_s);
	if (status != RB_ERR_PHYSICS || w->l->status != RB_OK)
		return status;
	*try_s = tried;
	return rb_gauss_step(problem, w->origin_s, try_s, least_s, &w->c->piece, w->l->err);
}

/* To shares of node `to` those at that time of the piece, at the nearest poses. */
static bool shares_at(struct rb_modes *w, double time_s, double *value, int to)
{
	rb_gauss_values(&w->c->piece, time_s, value);
	if (!rb_rates_evaluate(w, w->origin_s + time_s, value))
		return false;
	keep_shares(w, to);
	return true;
}

double rb_singular_keep(struct rb_modes *w, double length_s, double *value)
{
	const bool projects = w->singular.projects;
	bool ahead = false;

	if (!w->singular.closed || !w->singular.share)
		return length_s;
	w->singular.projects = true;
	if (shares_at(w, length_s, value, 0) && shares_at(w, 0.5 * length_s, value, 1))
		for (int k = 0; k < w->joints.count && !ahead; k++)
			ahead = shares(w, 0)[k] < passes * shares(w, 1)[k];
	w->singular.projects = projects;
	return ahead ? 0.5 * length_s : length_s;
}
