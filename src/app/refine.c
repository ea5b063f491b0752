/* SPDX-License-Identifier: MIT */
/*
 * A reference is found by runs at steps that shrink by half a decade, each compared with the one
 * before. Two successive differences give the ratio of a geometric series, whose rest estimates the
 * error of the finest run. If differences stop falling before the error is small, the motion is
 * chaotic or the method does not converge; a twin run with a nudge of rounding size tells which: if
 * the twin departs, no reference can exist beyond the time up to which they agree.
 */
#include "app/refine.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "app/common.h"
#include "base/error.h"
#include "method/method.h"

/* Half a decade, as the ladders of converge. */
static const double refinement = 3.1622776601683795;
/* Part of the wanted error that the reference may have. */
static const double share = 0.1;
/* An order of 1 divides differences by 3.2; above this they do not fall. */
static const double falls = 0.7;
/*
 * RUNS_MOST: eight decades of the time step, more than a double allows. STALLS_MOST: differences
 * that do not fall in a row before the search gives up.
 */
enum { RUNS_MOST = 16, STALLS_MOST = 2 };

/* Under way. */
struct search {
	const struct rb_refine_order *order;
	struct rb_refined *refined;
	struct rb_path path[2];
	int last;          /* of the two, the one that holds the finest run; -1: none */
	double difference; /* of the last two runs; NAN: there are no two */
	double rounding;   /* below that, differences say nothing */
	double agree_s, last_wall_s;
	double growth; /* expected of the next run */
	int stalls;
};

/* The order for a run at this step, compared with the finest run so far. */
static struct rb_rung_order rung(const struct search *search, double time_step_s)
{
	const struct rb_refine_order *const order = search->order;

	return (struct rb_rung_order){
		.options = order->options,
		.method = order->method,
		.time_step_s = time_step_s,
		.tolerance_m = order->tolerance_m,
		.runs = 1,
		.deadline_s = fmax(order->budget_s - search->refined->spent_s, 1),
		.against = search->last >= 0 ? &search->path[search->last] : NULL,
		.until_s = (double)INFINITY,
		.agree_quantity = order->quantity,
		.agree = order->error,
	};
}

/*
 * The error of the finest run from the last two differences: the rest of a geometric series with
 * their ratio. Where they hardly fall, the last difference itself.
 */
static double estimate(double before, double now)
{
	return now > 0 && before > 1.5 * now ? now / (before / now - 1) : now;
}

/* Takes the deviation of a run from the one before it. */
static void take_difference(struct search *search, const struct rb_rung_result *result)
{
	const struct rb_deviation *const of = &result->of[search->order->quantity];
	struct rb_refined *const refined = search->refined;
	const double now = of->max, before = search->difference;

	search->rounding = 64 * DBL_EPSILON * of->largest;
	search->agree_s = result->agree_s;
	refined->estimate = fmax(isnan(before) ? now : estimate(before, now),
	                         DBL_EPSILON * of->largest);
	if (isnan(now) || (!isnan(before) && now > falls * before && now > search->rounding))
		search->stalls++;
	else
		search->stalls = 0;
	refined->agrees = refined->estimate <= fmax(share * search->order->error, search->rounding);
	search->difference = now;
}

/* Whether the reference is good enough, or no better one can be had. */
static bool finished(const struct search *search, double time_step_s)
{
	const struct rb_refined *const refined = search->refined;

	return search->stalls >= STALLS_MOST ||
	       (refined->agrees && time_step_s <= search->order->fine_s * (1 + 1e-9));
}

/* Runs at one step, and makes it the finest so far if it came to its end. */
static enum rb_status run(struct search *search, double time_step_s, struct rb_error *err)
{
	struct rb_refined *const refined = search->refined;
	struct rb_rung_order order = rung(search, time_step_s);
	struct rb_rung_result result;
	const int to = search->last == 0 ? 1 : 0;

	order.store = &search->path[to];
	if (search->order->tell)
		search->order->tell(time_step_s, search->order->user);
	const enum rb_status status = rb_rung_run(&result, &order, err);
	if (status)
		return status;
	refined->runs++;
	refined->spent_s += result.spent_s;
	if (search->last_wall_s > 0)
		search->growth = fmin(fmax(result.spent_s / search->last_wall_s, 1), refinement);
	search->last_wall_s = result.spent_s;
	if (result.state != RB_RUNG_OK) {
		snprintf(refined->text, sizeof refined->text, "%s", result.text);
		return RB_OK;
	}
	if (order.against)
		take_difference(search, &result);
	search->last = to;
	refined->time_step_s = time_step_s;
	return RB_OK;
}

/*
 * Runs the finest step again with speeds and gravity changed by a few roundings: how far that leads
 * is what no refinement can remove.
 */
static enum rb_status run_twin(struct search *search, struct rb_error *err)
{
	struct rb_refined *const refined = search->refined;
	struct rb_rung_order order = rung(search, refined->time_step_s);
	struct rb_rung_result result;

	order.nudge = true;
	order.deadline_s = fmax(order.deadline_s, 2 * search->last_wall_s);
	const enum rb_status status = rb_rung_run(&result, &order, err);
	if (status)
		return status;
	refined->runs++;
	refined->spent_s += result.spent_s;
	const double distance = result.state == RB_RUNG_OK ? result.of[search->order->quantity].max
	                                                   : (double)INFINITY;
	/* one run alone says nothing of its error, however little rounding does to it */
	refined->estimate = rb_larger(refined->estimate, distance);
	if (!(distance <= search->order->error)) {
		refined->diverges = true;
		refined->agrees = false;
		search->agree_s = result.state == RB_RUNG_OK
		                          ? -rb_larger(-search->agree_s, -result.agree_s)
		                          : (double)NAN;
	}
	return RB_OK;
}

enum rb_status rb_refine(struct rb_refined *refined, const struct rb_refine_order *order,
                         const struct rb_model *model, struct rb_error *err)
{
	struct search search = {.order = order,
	                        .refined = refined,
	                        .last = -1,
	                        .difference = (double)NAN,
	                        .agree_s = (double)INFINITY,
	                        .growth = order->growth};
	int64_t steps = rb_step_count(order->interval_s, order->time_step_s);
	enum rb_status status = rb_path_create(&search.path[0], model, err);

	RB_ASSERT(order->interval_s > 0 && order->time_step_s > 0);
	*refined = (struct rb_refined){.estimate = (double)NAN, .horizon_s = (double)INFINITY};
	if (!status)
		status = rb_path_create(&search.path[1], model, err);
	for (int k = 0; k < RUNS_MOST && !status; k++) {
		const double time_step_s = order->interval_s / (double)steps;
		/* the twin is to come as well */
		const double next_s = 2 * search.growth * search.last_wall_s;
		if (k > 0 && refined->spent_s + next_s > order->budget_s)
			break;
		status = run(&search, time_step_s, err);
		if (!status && finished(&search, time_step_s))
			break;
		steps = (int64_t)ceil((double)steps * refinement);
	}
	refined->found = !status && search.last >= 0;
	if (refined->found)
		status = run_twin(&search, err);
	if (refined->found && search.stalls >= STALLS_MOST)
		refined->diverges = true;
	if (refined->diverges)
		refined->horizon_s = search.agree_s;
	if (refined->found) {
		refined->path = search.path[search.last];
		search.path[search.last] = (struct rb_path){0};
	}
	rb_path_destroy(&search.path[0]);
	rb_path_destroy(&search.path[1]);
	return status;
}

void rb_refined_release(struct rb_refined *refined)
{
	rb_path_destroy(&refined->path);
}
