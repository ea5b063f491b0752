/* SPDX-License-Identifier: MIT */
/*
 * Gauss-Legendre collocation, 8 nodes on [0, 1].
 *
 * Nothing here depends on the sign of a component: mirrored problems give mirrored bits.
 */
#include "math/gauss.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"
#include "math/gauss_error.h"
#include "math/gauss_newton.h"
#include "math/gauss_tables.h"
#include "math/lanes.h"

enum { NODES = RB_GAUSS_NODES, SWEEPS_MAX = 40, SWEEPS_MANY = 14, MISSED_TAILS = 8 };

/*
 * Range of a guess in lengths of its polynomial, beyond which that grows more than it is accurate;
 * the guess is of the same motion if its error of the rates at the beginning is below this share of
 * scale.
 */
static const double guess_reach = 3, guess_misses = 0x1p-10;
/* Error of a smooth guess there, in tolerances. */
static const double guess_smooth = 2048;
/* After a guess with smaller changes than this the second visit may be the last. */
static const double guess_near = 0x1p-20;

/*
 * Up to four consecutive rows of the same kind: rates that `rates` computes, with `rate` equal to
 * `first`, or rows whose rates are the rows from `rate` on.
 */
struct group {
	uint32_t first, rate;
	uint16_t count;
	bool is_rate;
};
_Static_assert(sizeof(struct group) <= 2 * sizeof(double), "room in scratch");

/*
 * State of an attempt; `g` are rates times the step's length, g[0] at its start, g[1 + i] at node
 * i. For rows whose rate is a row they are stored for the first guess only.
 */
struct attempt {
	const struct rb_gauss_problem *problem;
	struct rb_gauss_guess guess;
	double time_s, h_s;
	const struct group *group, *group_end; /* all rows, in scratch */
	double *start, *rest; /* copies in scratch, because four are read at a time */
	double *first, *value, *size, *g[1 + NODES];
	uint64_t *calls;
	bool shows;   /* problem->visited is called */
	bool guesses; /* values at later nodes are extrapolated from earlier ones */
	struct rb_gauss_newton newton;
	struct rb_error *err;
};

size_t rb_gauss_scratch_size(int n)
{
	/* four at a time extend beyond the last row */
	return (size_t)(NODES + 9) * (size_t)n + RB_LANES;
}

static int rate_row(const struct rb_gauss_problem *problem, size_t i)
{
	return problem->rate_row ? problem->rate_row[i] : -1;
}

/* Fills the groups; returns the end of them. */
static struct group *find_groups(const struct rb_gauss_problem *p, struct group *to)
{
	for (int i = 0, v; i < p->n; i += to++->count) {
		v = rate_row(p, (size_t)i);
		*to = (struct group){(uint32_t)i, (uint32_t)(v < 0 ? i : v), 1, v < 0};
		while (to->count < RB_LANES && i + to->count < p->n) {
			const int next = rate_row(p, (size_t)(i + to->count));

			if (v < 0 ? next >= 0 : next != v + to->count)
				break;
			to->count++;
		}
	}
	return to;
}

/*
 * Changes of rates are measured by their effect on values, also on those whose second derivatives
 * they are.
 */
static void find_sizes(const struct attempt *a)
{
	const struct rb_gauss_problem *p = a->problem;

	memcpy(a->size, p->scale, (size_t)p->n * sizeof(double));
	for (size_t i = 0; i < (size_t)p->n; i++) {
		const int v = rate_row(p, i);

		if (v >= 0)
			a->size[v] = fmin(a->size[v], p->scale[i] / a->h_s);
	}
}

/*
 * Loads the first `count` of four, and the first one for the others. One by one: values just stored
 * like that can be read as four only after a stall.
 */
RB_LANES_INLINE void load(const double *from, size_t count, rb_lanes *x)
{
	*x = (rb_lanes){from[0], from[count > 1 ? 1 : 0], from[count > 2 ? 2 : 0],
	                from[count > 3 ? 3 : 0]};
}

/* Stores the first `count` of four. */
RB_LANES_INLINE void store(const rb_lanes *x, size_t count, double *to)
{
	if (count == RB_LANES) {
		*(rb_lanes *)to = *x;
		return;
	}
	to[0] = (*x)[0];
	if (count > 1)
		to[1] = (*x)[1];
	if (count > 2)
		to[2] = (*x)[2];
}

/* The largest change of the rows of a group, or `max`; NaN if one is. */
static double largest(const rb_lanes *off, const rb_lanes *next, size_t count, double max)
{
	for (size_t m = 0; m < count; m++) {
		double size = fabs((*off)[m]);

		/* divided by a tiny scale it may still overflow */
		if (size > DBL_MAX && isfinite((*next)[m]))
			size = DBL_MAX;
		max = rb_gauss_worse(size, max);
	}
	return max;
}

/* Stores rates into `row`; returns the largest change of an entry, or `max` if that is larger. */
RB_LANES_INLINE double taken(const struct attempt *a, const double *rate, double *row, double max)
{
	static const rb_lanes_mask used[RB_LANES + 1] = {
		{0}, {-1}, {-1, -1}, {-1, -1, -1}, {-1, -1, -1, -1}};
	static const rb_lanes_mask sign = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
	rb_lanes peak = {0, 0, 0, 0};
	const rb_lanes finite_max = {DBL_MAX, DBL_MAX, DBL_MAX, DBL_MAX};

	for (const struct group *group = a->group; group < a->group_end; group++) {
		const size_t first = group->first;
		rb_lanes next, before;

		if (!group->is_rate && !a->guesses)
			continue;
		load(group->is_rate ? rate + first : a->value + group->rate, group->count, &next);
		next *= a->h_s;
		before = *(const rb_lanes *)(row + first);
		store(&next, group->count, row + first);
		if (!group->is_rate)
			continue;
		const rb_lanes off = (next - before) / *(const rb_lanes *)(a->size + first);
		const rb_lanes size = (rb_lanes)((rb_lanes_mask)off & ~sign & used[group->count]);
		const rb_lanes_mask finite = size <= finite_max, more = size > peak;

		if (finite[0] & finite[1] & finite[2] & finite[3])
			peak = (rb_lanes)(((rb_lanes_mask)size & more) |
			                  ((rb_lanes_mask)peak & ~more));
		else
			max = largest(&off, &next, group->count, max);
	}
	for (size_t m = 0; m < RB_LANES; m++)
		if (peak[m] > max)
			max = peak[m];
	return max;
}

RB_LANES_AVX2 static double taken_avx2(const struct attempt *a, const double *rate, double *row,
                                       double max)
{
	return taken(a, rate, row, max);
}

/*
 * Calls the rates at `value` and stores them into `row`; `*change` is the largest change of an
 * entry. Not called at values that a too long step has made infinite: that might be taken for an
 * error in the rates.
 */
static enum rb_status rates_at(const struct attempt *a, double part, double *row, double *rate,
                               double *change)
{
	const struct rb_gauss_problem *p = a->problem;
	const double *const value = a->value;
	rb_lanes zeros = {0, 0, 0, 0};
	double none = 0;
	int i = 0;

	for (; i + RB_LANES <= p->n; i += RB_LANES)
		zeros += 0 * *(const rb_lanes *)(value + i);
	for (; i < p->n; i++)
		none += 0 * value[i];
	none += rb_lanes_sum(&zeros);
	if (none != 0) { /* NaN: a value is not finite */
		*change = (double)INFINITY;
		return RB_OK;
	}
	++*a->calls;
	const enum rb_status status = p->rates(p->user, a->time_s + part * a->h_s, a->value, rate,
	                                       a->err);
	if (status != RB_OK)
		return status;
	*change = rb_lanes_avx2() ? taken_avx2(a, rate, row, *change)
	                          : taken(a, rate, row, *change);
	return RB_OK;
}

/* The first guess of a node, from the rates at the beginning and at earlier nodes. */
static void extrapolate_value(const struct attempt *a, int at)
{
	for (int i = 0; i < a->problem->n; i++) {
		double sum = 0;

		for (int j = 0; j <= at; j++)
			sum += ahead[at][j] * a->g[j][i];
		a->value[i] = a->start[i] + (a->rest[i] + sum);
	}
}

/* Weighted sum of four rows of all nodes: unrolled, because this is most of the cost of a visit. */
RB_LANES_INLINE void weighted(const double w[NODES], double *const g[NODES], size_t i,
                              rb_lanes *sum)
{
#define RB_GAUSS_ROW(k) (w[k] * *(const rb_lanes *)(g[k] + i))
	*sum = 0.0 + RB_GAUSS_ROW(0) + RB_GAUSS_ROW(1) + RB_GAUSS_ROW(2) + RB_GAUSS_ROW(3) +
	       RB_GAUSS_ROW(4) + RB_GAUSS_ROW(5) + RB_GAUSS_ROW(6) + RB_GAUSS_ROW(7);
#undef RB_GAUSS_ROW
}

/* Values at a node, small terms first. `all`: including rows whose rates are rows. */
RB_LANES_INLINE void values_at(const struct attempt *a, int at, bool all)
{
	const double h = a->h_s, part = node[at], low_part = node_low[at];

	for (const struct group *group = a->group; group < a->group_end; group++) {
		const rb_lanes *const start = (const rb_lanes *)(a->start + group->first);
		const rb_lanes *const rest = (const rb_lanes *)(a->rest + group->first);
		rb_lanes sum;

		if (!group->is_rate && !all)
			continue;
		weighted(group->is_rate ? matrix[at] : square[at], &a->g[1], group->rate, &sum);
		if (!group->is_rate) {
			const rb_lanes displacement = h *
			                              *(const rb_lanes *)(a->start + group->rate);
			const rb_lanes lost = part * *(const rb_lanes *)(a->rest + group->rate);
			const rb_lanes low = low_part * displacement + h * (lost + sum);

			sum = part * displacement + low;
		}
		const rb_lanes value = *start + (*rest + sum);

		store(&value, group->count, a->value + group->first);
	}
}

RB_LANES_AVX2 static void values_at_avx2(const struct attempt *a, int at, bool all)
{
	values_at(a, at, all);
}

static void value_at(const struct attempt *a, int at, bool all)
{
	if (rb_lanes_avx2())
		values_at_avx2(a, at, all);
	else
		values_at(a, at, all);
}

/* Quick rates at all nodes, from values by the latest rates. */
static void update_quick_rates(const struct attempt *a, double *rate)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int j = 0; j < NODES && p->quick_rates; j++) {
		value_at(a, j, false);
		p->quick_rates(p->user, a->value, rate);
		for (const struct group *group = a->group; group < a->group_end; group++) {
			const size_t end = group->first + group->count;

			for (size_t i = group->first; i < end && group->is_rate; i++)
				if (p->rate_row[i] == RB_GAUSS_QUICK)
					a->g[1 + j][i] = a->h_s * rate[i];
		}
	}
}

/* One visit of all nodes, each with the latest rates of the others. `rate` is scratch. */
static enum rb_status sweep(const struct attempt *a, bool first, double *rate, double *change)
{
	const bool shows = a->shows && a->problem->visited;

	*change = 0;
	if (!first)
		update_quick_rates(a, rate);
	for (int i = 0; i < NODES; i++) {
		if (first) {
			extrapolate_value(a, i);
			memset(a->g[1 + i], 0, (size_t)a->problem->n * sizeof(double));
		} else {
			value_at(a, i, true);
		}
		const enum rb_status status = rates_at(a, node[i], a->g[1 + i], rate, change);
		if (status != RB_OK)
			return status;
		if (!isfinite(*change))
			return RB_OK;
		if (shows)
			a->problem->visited(a->problem->user, i);
	}
	return RB_OK;
}

/* Loads a guess's coefficients of four rates. */
RB_LANES_INLINE void guess_rows(const struct attempt *a, const struct group *group, rb_lanes *to)
{
	const size_t n = (size_t)a->problem->n;
	const double *const c = a->guess.coefficient + group->first;

	for (size_t k = 0; k < NODES; k++)
		load(c + k * n, group->count, &to[k]);
}

/* Four rates of a guess where its polynomials are `weight`, times the length. */
RB_LANES_INLINE void guessed(const struct attempt *a, const double *weight, const rb_lanes *row,
                             rb_lanes *to)
{
	rb_lanes sum = {0, 0, 0, 0};

	for (size_t k = NODES; k-- > 0;)
		sum += weight[k] * row[k];
	*to = a->h_s / a->guess.length_s * sum;
}

/*
 * Guesses rates at all nodes, corrected by the guess's error at the beginning; false: there is no
 * guess. If motion continues, that error is the part that the polynomial lacks, mostly P_8, which
 * is large at the nodes ahead; otherwise the size of a jump, where a force is added to those that
 * continue.
 */
RB_LANES_INLINE bool guess_any(const struct attempt *a)
{
	const struct rb_gauss_guess *from = &a->guess;
	const long long goes_on = from->from_s >= from->length_s ? -1 : 0;
	const rb_lanes ones = {1, 1, 1, 1};
	const double smooth = guess_smooth * a->problem->tolerance;
	double weight[1 + NODES][NODES + 1]; /* at the beginning, at nodes */
	rb_lanes row[NODES];

	if (!from->coefficient || !(from->from_s + a->h_s <= guess_reach * from->length_s))
		return false;
	for (int j = 0; j <= NODES; j++)
		rb_gauss_polynomials(NODES + 1,
		                     j == 0 ? from->from_s / from->length_s
		                            : (from->from_s + node[j - 1] * a->h_s) /
		                                      from->length_s,
		                     weight[j]);
	for (const struct group *group = a->group; group < a->group_end; group++) {
		rb_lanes value;

		if (!group->is_rate)
			continue;
		guess_rows(a, group, row);
		guessed(a, weight[0], row, &value);
		value = *(const rb_lanes *)(a->g[0] + group->first) - value;
		for (size_t i = 0; i < group->count; i++)
			if (!(fabs(value[i]) <= guess_misses * a->size[group->first + i]))
				return false;
		const rb_lanes max = smooth * *(const rb_lanes *)(a->size + group->first);
		const rb_lanes_mask same = goes_on & (rb_lanes_mask)(value <= max) &
		                           (rb_lanes_mask)(value >= -max);

		for (int j = 1; j <= NODES; j++) {
			const double share = weight[j][NODES] / weight[0][NODES];
			const rb_lanes shares = {share, share, share, share};
			rb_lanes rates;

			guessed(a, weight[j], row, &rates);
			rates += (rb_lanes)(((rb_lanes_mask)shares & same) |
			                    ((rb_lanes_mask)ones & ~same)) *
			         value;
			store(&rates, group->count, a->g[j] + group->first);
		}
	}
	return true;
}

RB_LANES_AVX2 static bool guess_avx2(const struct attempt *a)
{
	return guess_any(a);
}

static bool guess(const struct attempt *a)
{
	return rb_lanes_avx2() ? guess_avx2(a) : guess_any(a);
}

/*
 * Visits until the changes are below rounding or no longer decrease: `*residual` is then their
 * size. `*sweeps` is 0 if something is not finite or they do not converge. A change may increase
 * now and then (a chain q' = w, w' = f(q) that is not made of rows does so in every other visit),
 * so it gives up only after two visits that do not halve the smallest change so far.
 */
static enum rb_status converge(struct attempt *a, double *rate, int *sweeps, double *residual)
{
	const double negligible = 0x1p-4 * fmax(DBL_EPSILON, a->h_s * a->problem->rate_noise);
	double change, before, smallest;
	int stalled = 0;

	*sweeps = 0;
	*residual = 0;
	enum rb_status status = RB_OK;
	const bool near = guess(a);
	a->guesses = !near;
	if (!near) {
		status = sweep(a, true, rate, &before);
		a->guesses = false;
		if (status != RB_OK || !isfinite(before))
			return status;
	}
	smallest = before = (double)INFINITY;
	a->shows = false;
	const int limit = a->newton.is_out ? SWEEPS_MAX : SWEEPS_MANY;
	for (int count = 1; count <= limit; count++) {
		status = sweep(a, false, rate, &change);
		if (status != RB_OK || !isfinite(change))
			return status;
		const double ratio = change / before;
		if (change == 0 || (count > 1 && (change < 0x1p-2 * DBL_EPSILON ||
		                                  (ratio < 0.5 && change * ratio < negligible)))) {
			*sweeps = count;
			return RB_OK;
		}
		stalled = change < 0.5 * smallest ? 0 : stalled + 1;
		/* at their present decrease, the next change may be small enough */
		a->shows = stalled > 0 || (count > 1 ? change * ratio * ratio < 0x1p14 * negligible
		                                     : near && change < guess_near);
		smallest = fmin(smallest, change);
		before = change;
		if (stalled == 2) {
			*sweeps = count;
			*residual = smallest;
			return RB_OK;
		}
	}
	return RB_OK;
}

static void any_value_at(const void *attempt, int at)
{
	value_at(attempt, at, true);
}

/*
 * The same; if visits do not converge, or only to the rounding of stiff rates, by Newton's method,
 * and if that does not converge either, by visits for the rest of the step.
 */
static enum rb_status converge_stiff(struct attempt *a, double *rate, int *sweeps, double *residual)
{
	enum rb_status status = converge(a, rate, sweeps, residual);

	a->newton.is_used = false;
	if (status != RB_OK || a->newton.is_out ||
	    (*sweeps > 0 && *residual <= a->problem->tolerance))
		return status;
	const struct rb_gauss_nodes nodes = {.attempt = a,
	                                     .value_at = any_value_at,
	                                     .time_s = a->time_s,
	                                     .h_s = a->h_s,
	                                     .value = a->value,
	                                     .rate = rate,
	                                     .size = a->size,
	                                     .g = a->g,
	                                     .err = a->err};

	status = rb_gauss_newton_prepare(&a->newton, &nodes, a->start, a->first);
	if (status == RB_OK && !a->newton.is_out)
		status = rb_gauss_newton_converge(&a->newton, &nodes, sweeps, residual);
	a->shows = false;
	if (status != RB_OK || *sweeps > 0 || !a->newton.is_out)
		return status;
	return converge(a, rate, sweeps, residual);
}

/*
 * The largest error of rates, times the length, relative to scale; errors of stiff rates are
 * converted to the far smaller ones of values.
 */
static double largest_error(const struct attempt *a, double *off)
{
	const struct rb_gauss_problem *p = a->problem;
	double worst = 0;

	if (a->newton.is_used)
		rb_gauss_newton_soften(&a->newton, off);
	for (size_t i = 0; i < (size_t)p->n; i++)
		if (rate_row(p, i) < 0)
			worst = rb_gauss_worse(worst, fabs(off[i]) / p->scale[i]);
	return worst;
}

/* Error of the polynomial's rates at the beginning; leaves its rates at the end. */
static double error_at_start(struct attempt *a, const double *coefficient, double *off)
{
	const struct rb_gauss_problem *p = a->problem;
	const size_t n = (size_t)p->n;

	for (size_t i = 0; i < n; i++) {
		double odd = 0, even = 0;

		off[i] = 0;
		if (rate_row(p, i) >= 0)
			continue;
		for (size_t k = NODES; k-- > 0;)
			*(k % 2 ? &odd : &even) += coefficient[k * n + i];
		a->g[0][i] = even + odd;
		off[i] = even - odd - a->h_s * a->first[i];
	}
	return largest_error(a, off);
}

/*
 * Error of the polynomial between an end and the nearest node, where no node sees a jump,
 * integrated, relative to scale; for rates without a jump it has the size of the tail.
 */
static double missed_at_ends(struct attempt *a, const double *coefficient, double *rate,
                             enum rb_status *status)
{
	const struct rb_gauss_problem *p = a->problem;
	const size_t n = (size_t)p->n;
	const double at_start = error_at_start(a, coefficient, rate);

	for (size_t i = 0; i < n; i++)
		a->value[i] = a->start[i] + (a->rest[i] + coefficient[i]);
	(*a->calls)++;
	*status = p->rates(p->user, a->time_s + a->h_s, a->value, rate, a->err);
	if (*status != RB_OK)
		return 0;
	for (size_t i = 0; i < n; i++)
		rate[i] = a->g[0][i] - a->h_s * rate[i];
	return node[0] * rb_gauss_worse(at_start, largest_error(a, rate));
}

/*
 * The tail without the part of transients that stiff rates damp before the first node: if its size
 * is rounding, which such a step neither damps nor amplifies, the polynomial is as good with it.
 */
static double stiff_tail(struct attempt *a, const double *coefficient, double required,
                         double *scratch)
{
	const double all = rb_gauss_tail(a->problem, coefficient);
	const double transient = a->newton.is_used ? error_at_start(a, coefficient, scratch) : 0;

	return transient <= required / 8 ? fmax(all - 4 * transient, 0) : all;
}

/*
 * Visits the nodes once more, uncounted, if the last visit was not expected; with the values as
 * accepted.
 */
static enum rb_status show(const struct attempt *a, double *rate)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int i = 0; i < NODES && p->visited && !a->shows; i++) {
		value_at(a, i, true);
		const enum rb_status status = p->rates(p->user, a->time_s + node[i] * a->h_s,
		                                       a->value, rate, a->err);

		if (status != RB_OK)
			return status;
		p->visited(p->user, i);
	}
	return RB_OK;
}

/*
 * The coefficients of x' = v follow from those of v' = f: the integral of P_k, k > 0, is (P_(k+1) -
 * P_(k-1)) / (2 (2k + 1)) on [0, 1], and P_8 of v is zero at the nodes.
 */
RB_LANES_INLINE void integrated(const struct attempt *a, const struct group *group,
                                double *coefficient)
{
	const size_t n = (size_t)a->problem->n, count = group->count;
	const double h = a->h_s;
	rb_lanes d[NODES], own;

	for (size_t k = 0; k < NODES; k++)
		load(coefficient + k * n + group->rate, count, &d[k]);
	own = h * *(const rb_lanes *)(a->start + group->rate) +
	      h * (*(const rb_lanes *)(a->rest + group->rate) + (0.5 * d[0] - d[1] / 6));
	store(&own, count, coefficient + group->first);
	for (size_t k = 1; k < NODES; k++) {
		rb_lanes above = {0, 0, 0, 0};

		if (k + 1 < NODES)
			above = d[k + 1] / (double)(2 * (2 * k + 3));
		own = h * (d[k - 1] / (double)(2 * (2 * k - 1)) - above);
		store(&own, count, coefficient + k * n + group->first);
	}
}

RB_LANES_INLINE void coefficients_any(const struct attempt *a, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;

	for (const struct group *group = a->group; group < a->group_end; group++) {
		rb_lanes both[2][NODES / 2], low[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};

		if (!group->is_rate)
			continue;
		/* from the ends to the middle, so that even and odd parts do not mix */
		for (int j = 0; j < NODES / 2; j++) {
			const rb_lanes *const x = (const rb_lanes *)(a->g[1 + j] + group->first);
			const rb_lanes *const y = (const rb_lanes *)(a->g[NODES - j] +
			                                             group->first);

			both[0][j] = *x + *y;
			both[1][j] = *x - *y;
			low[0] += legendre_low[0][j] * both[0][j];
			low[1] += legendre_low[1][j] * both[1][j];
		}
		for (size_t k = 0; k < NODES; k++) {
			const double *const w = legendre[k];
			const rb_lanes *const x = both[k % 2];
			rb_lanes sum = 0.0 + w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3];

			sum += k < 2 ? low[k] : (rb_lanes){0, 0, 0, 0};
			store(&sum, group->count, coefficient + k * n + group->first);
		}
	}
	for (const struct group *group = a->group; group < a->group_end; group++)
		if (!group->is_rate)
			integrated(a, group, coefficient);
}

RB_LANES_AVX2 static void coefficients_avx2(const struct attempt *a, double *coefficient)
{
	coefficients_any(a, coefficient);
}

static void coefficients(const struct attempt *a, double *coefficient)
{
	if (rb_lanes_avx2())
		coefficients_avx2(a, coefficient);
	else
		coefficients_any(a, coefficient);
}

enum rb_status rb_gauss_step(const struct rb_gauss_problem *problem, double time_s, double *try_s,
                             double least_s, struct rb_gauss_piece *piece, struct rb_error *err)
{
	const size_t n = (size_t)problem->n;
	double *const rate = problem->scratch;
	struct group *const group = (struct group *)(rate + 15 * n + RB_LANES);
	struct attempt a = {.problem = problem,
	                    .guess = problem->guess,
	                    .time_s = time_s,
	                    .group = group,
	                    .group_end = find_groups(problem, group),
	                    .start = rate + 14 * n,
	                    .rest = rate + n,
	                    .first = rate + 2 * n,
	                    .value = rate + 3 * n,
	                    .size = rate + 4 * n,
	                    .calls = problem->calls,
	                    .err = err};
	double change = 0, residual;
	int sweeps;

	a.guesses = true;
	a.newton.is_out = true;
	if (problem->newton)
		rb_gauss_newton_begin(&a.newton, problem);
	for (size_t j = 0; j <= NODES; j++)
		a.g[j] = rate + (5 + j) * n;
	if (!(*try_s > 0) || !isfinite(*try_s))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'step' is %g s, not a positive number",
		               *try_s);
	memcpy(a.start, piece->start, n * sizeof(double));
	/* read as the last of four: other bits might be denormal numbers, which are slow */
	memset(a.start + n, 0, RB_LANES * sizeof(double));
	if (piece->rest)
		memcpy(a.rest, piece->rest, n * sizeof(double));
	else
		memset(a.rest, 0, n * sizeof(double));
	memset(a.first, 0, n * sizeof(double));
	for (size_t i = 0; i < n; i++)
		a.value[i] = a.start[i] + a.rest[i];
	a.h_s = 1;
	find_sizes(&a);
	enum rb_status status = rates_at(&a, 0, a.first, rate, &change);
	if (status != RB_OK)
		return status;
	if (!isfinite(change))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'rates' at %g s are not finite", time_s);
	for (a.h_s = *try_s;; a.h_s *= 0.5) {
		for (size_t i = 0; i < n; i++)
			a.g[0][i] = a.h_s * a.first[i];
		find_sizes(&a);
		status = converge_stiff(&a, rate, &sweeps, &residual);
		if (status != RB_OK)
			return status;
		if (sweeps > 0) {
			coefficients(&a, piece->coefficient);
			const double noise = problem->noise ? problem->noise(problem->user,
			                                                     piece->coefficient)
			                                    : 0;
			const double required = rb_gauss_worse(problem->tolerance, noise);
			const double error = stiff_tail(&a, piece->coefficient, required, rate);
			const bool fits = isfinite(required) && error <= required &&
			                  residual <= required;
			const double missed = fits && problem->jumps
			                              ? missed_at_ends(&a, piece->coefficient, rate,
			                                               &status)
			                              : 0;
			if (status != RB_OK)
				return status;
			if (fits && missed <= MISSED_TAILS * required) {
				status = show(&a, rate);
				piece->length_s = a.h_s;
				*try_s = rb_gauss_next_length(
					a.h_s, required,
					fmax(error, rb_gauss_rounded(problem, piece)),
					sweeps <= SWEEPS_MANY && !(a.h_s < *try_s));
				return status;
			}
		}
		/* the too long step is the best guess for its half */
		a.guess = (struct rb_gauss_guess){
			.coefficient = sweeps > 0 ? piece->coefficient : NULL, .length_s = a.h_s};
		if (!(0.5 * a.h_s >= least_s) || !(0.5 * a.h_s > 0))
			return RB_FAIL(err, RB_ERR_PHYSICS,
			               "'step' at %g s would have to be shorter than %g s for an "
			               "error of %g",
			               time_s, least_s, problem->tolerance);
	}
}
