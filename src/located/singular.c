/* SPDX-License-Identifier: MIT */
#include "located/singular.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/error.h"
#include "located/rates.h"

/*
 * A singular position is within the step if a row's share at one node is below this part of the
 * largest at another.
 */
static const double singular_ratio = 0x1p-3;
/*
 * Rounding error allowed in a step, relative to scale; larger values only if a smaller one fails.
 */
static const double rounding_allowed[] = {0x1p-38, 0x1p-33, 0x1p-28};
/* Least rounding error, in ulp over the cube of the angle. */
static const double noise_ulp = 4;
/* Step lengths to try: sixteenths of the first one, from all down to half of it. */
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

/*
 * Stores the shares of the last evaluation, sorted, because rounding decides which of redundant
 * rows is eliminated last.
 */
static void keep_shares(const struct rb_modes *w, int node)
{
	rb_dense_shares(&w->dense, shares(w, node));
	qsort(shares(w, node), (size_t)w->joints.count, sizeof(double), compare);
}

/* Least ratio of a row's smallest share at one of the nodes to its largest. */
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
	return w->singular.evaluations > RB_GAUSS_NODES &&
	       least_share(w, RB_GAUSS_NODES) < singular_ratio;
}

static double noise(void *user, const double *coefficient)
{
	const struct rb_modes *w = user;
	const double by_field = w->l->model->features & RB_FEATURE_FIELD
	                                ? rb_rates_noise(user, coefficient)
	                                : 0;

	return fmax(by_field, is_near(w) ? w->singular.rounding_allowed : 0);
}

/* Can the step succeed? The first rates are those of its beginning. */
static bool is_worthwhile(const struct rb_modes *w)
{
	const double share = w->singular.evaluations > RB_GAUSS_NODES
	                             ? least_share(w, RB_GAUSS_NODES)
	                             : 0;

	return w->singular.evaluations <= RB_GAUSS_NODES ||
	       (share < singular_ratio &&
	        noise_ulp * DBL_EPSILON <= w->singular.rounding_allowed * share * sqrt(share));
}

static enum rb_status rates(void *user, double t, const double *value, double *rate,
                            struct rb_error *err)
{
	struct rb_modes *const w = user;
	const enum rb_status status = rb_rates_of(w)(w, t, value, rate, err);

	if (status != RB_OK)
		return status;
	keep_shares(w, w->singular.evaluations++ % RB_GAUSS_NODES);
	if (!is_worthwhile(w))
		return RB_FAIL(err, RB_ERR_PHYSICS, "a node is next to a singular position");
	return RB_OK;
}

/* Attempts a step of that length only. */
static enum rb_status attempt(struct rb_modes *w, const struct rb_gauss_problem *problem,
                              double length_s, double *try_s)
{
	*try_s = length_s;
	w->singular.evaluations = 0;
	return rb_gauss_step(problem, w->origin_s, try_s, 0.75 * length_s, &w->c->piece, w->l->err);
}

/*
 * Steps with projected poses and this rounding error allowed; takes the longest length that
 * succeeds.
 */
static enum rb_status step_projected(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                     double length_s, double allowed, double *try_s)
{
	enum rb_status status = RB_ERR_PHYSICS;

	struct rb_gauss_problem nearest = *problem;

	nearest.rates = rates;
	nearest.noise = noise;
	w->singular = (struct rb_singular_piece){.closed = true,
	                                         .share = w->singular.share,
	                                         .projects = true,
	                                         .rounding_allowed = allowed};
	for (int k = LENGTHS; k > LENGTHS / 2 && status == RB_ERR_PHYSICS; k--) {
		status = attempt(w, &nearest, length_s * k / LENGTHS, try_s);
		if (w->l->status != RB_OK || !is_near(w))
			break;
	}
	w->singular.projects = status != RB_ERR_PHYSICS;
	return status;
}

enum rb_status rb_singular_step(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                double least_s, double *try_s)
{
	const double length_s = *try_s;
	enum rb_status status;

	w->singular.projects = false;
	w->singular.closed = w->c->held_count == 0 && w->joints.count > 0 &&
	                     w->joints.count <= w->direct_max &&
	                     rb_joint_rows_is_closed(&w->joints);
	if (w->singular.closed && !w->singular.share)
		w->singular.share = rb_arena_take(
			w->l->arena, RB_GAUSS_NODES * (size_t)w->joints.count, sizeof(double));
	if (!w->singular.closed || !w->singular.share)
		return rb_gauss_step(problem, w->origin_s, try_s, least_s, &w->c->piece, w->l->err);
	status = attempt(w, problem, length_s, try_s);
	for (size_t m = 0; m < sizeof rounding_allowed / sizeof *rounding_allowed; m++)
		if (status == RB_ERR_PHYSICS && w->l->status == RB_OK)
			status = step_projected(w, problem, length_s, rounding_allowed[m], try_s);
	if (status != RB_ERR_PHYSICS || w->l->status != RB_OK)
		return status;
	*try_s = length_s;
	return rb_gauss_step(problem, w->origin_s, try_s, least_s, &w->c->piece, w->l->err);
}

/* Stores the shares at that time of the piece, at the nearest poses, as those of node `to`. */
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
	bool is_before_singular = false;

	if (!w->singular.closed || !w->singular.share)
		return length_s;
	w->singular.projects = true;
	if (shares_at(w, length_s, value, 0) && shares_at(w, 0.5 * length_s, value, 1))
		for (int k = 0; k < w->joints.count && !is_before_singular; k++)
			is_before_singular = shares(w, 0)[k] < singular_ratio * shares(w, 1)[k];
	w->singular.projects = projects;
	return is_before_singular ? 0.5 * length_s : length_s;
}
