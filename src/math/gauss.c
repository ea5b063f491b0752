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
#include "math/gauss_tables.h"

enum { NODES = RB_GAUSS_NODES, SWEEPS_MAX = 40, SWEEPS_MANY = 14, MISSED_TAILS = 8 };

/*
 * A guess reaches so many lengths of its polynomial, beyond which that grows by more than it falls
 * off; and is of the same motion when it misses the rates at the beginning by less than this share
 * of scale.
 */
static const double guess_reach = 3, guess_misses = 0x1p-10;
/* What a smooth guess misses there, in tolerances. */
static const double guess_smooth = 2048;
/* Of the coefficients of a row, together. */
static const double rounding = DBL_EPSILON / 8;
/* The second visit after a guess that was as near as this may be the last. */
static const double guess_near = 0x1p-20;

/*
 * What an attempt works on; `g` are rates times the step's length, g[0] at its start, g[1 + i] at
 * node i. Of rows whose rate is a row they are kept for the first guess only.
 */
struct attempt {
	const struct rb_gauss_problem *problem;
	struct rb_gauss_guess guess;
	double time_s, h_s;
	const double *start, *rest;
	double *first, *value, *size, *g[1 + NODES];
	uint64_t *calls;
	bool shows;   /* problem->visited is called */
	bool guesses; /* values at nodes to come are guessed from those before */
	struct rb_error *err;
};

size_t rb_gauss_scratch_size(int n)
{
	return (size_t)(NODES + 6) * (size_t)n;
}

static int rate_row(const struct rb_gauss_problem *problem, size_t i)
{
	return problem->rate_row ? problem->rate_row[i] : -1;
}

/* Changes of rates count by what they do to values; also to those whose rates' rates they are. */
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
 * Calls the rates at `value` and puts them into `row`; `*change` is the largest change of a row's
 * entry. What a try that is too long has thrown to infinity is asked nothing: its rates might be
 * taken for a mistake in them.
 */
static enum rb_status rates_at(const struct attempt *a, double part, double *row, double *rate,
                               double *change)
{
	const struct rb_gauss_problem *p = a->problem;
	const double h = a->h_s, *const value = a->value, *const size = a->size;
	double max = *change;
	bool finite = true;

	for (int i = 0; i < p->n; i++)
		finite = finite && fabs(value[i]) <= DBL_MAX;
	if (!finite) {
		*change = (double)INFINITY;
		return RB_OK;
	}
	++*a->calls;
	const enum rb_status status = p->rates(p->user, a->time_s + part * a->h_s, a->value, rate,
	                                       a->err);
	if (status != RB_OK)
		return status;
	for (int i = 0; i < p->n; i++) {
		const int v = rate_row(p, (size_t)i);

		if (v >= 0) {
			if (a->guesses)
				row[i] = h * value[v];
			continue;
		}
		const double now = h * rate[i];
		double off = fabs(now - row[i]) / size[i];

		/* against a tiny scale it may overflow all the same */
		if (off > DBL_MAX && isfinite(now))
			off = DBL_MAX;
		if (!(off <= max)) /* NaN comes through */
			max = off;
		row[i] = now;
	}
	*change = max;
	return RB_OK;
}

/* The first guess of a node from the rates at the beginning and at the nodes before. */
static void value_ahead(const struct attempt *a, int at)
{
	for (int i = 0; i < a->problem->n; i++) {
		double sum = 0;

		for (int j = 0; j <= at; j++)
			sum += ahead[at][j] * a->g[j][i];
		a->value[i] = a->start[i] + (a->rest[i] + sum);
	}
}

/* Component i of all nodes, weighted: written out, since this is most of what a visit costs. */
static inline double weighted(const double w[NODES], const double *const g[NODES], size_t i)
{
	return 0.0 + w[0] * g[0][i] + w[1] * g[1][i] + w[2] * g[2][i] + w[3] * g[3][i] +
	       w[4] * g[4][i] + w[5] * g[5][i] + w[6] * g[6][i] + w[7] * g[7][i];
}

/* The small ones first. */
static void value_at(const struct attempt *a, int at)
{
	const struct rb_gauss_problem *const p = a->problem;
	const double *const start = a->start, *const rest = a->rest, h = a->h_s;
	const double *g[NODES];
	double *const value = a->value;

	memcpy(g, &a->g[1], sizeof g);
	for (size_t i = 0; i < (size_t)p->n; i++) {
		const int v = rate_row(p, i);

		if (v < 0) {
			value[i] = start[i] + (rest[i] + weighted(matrix[at], g, i));
			continue;
		}
		const double sum = weighted(square[at], g, (size_t)v), way = h * start[v];
		const double low = node_low[at] * way + h * (node[at] * rest[v] + sum);

		value[i] = start[i] + (rest[i] + (node[at] * way + low));
	}
}

/* Quick rates at all nodes, from values by the newest rates. */
static void quicken(const struct attempt *a, double *rate)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int j = 0; j < NODES && p->quick_rates; j++) {
		value_at(a, j);
		p->quick_rates(p->user, a->value, rate);
		for (size_t i = 0; i < (size_t)p->n; i++)
			if (rate_row(p, i) == RB_GAUSS_QUICK)
				a->g[1 + j][i] = a->h_s * rate[i];
	}
}

/* One visit of all nodes, each with the newest rates of the others. `rate` is scratch. */
static enum rb_status sweep(const struct attempt *a, bool first, double *rate, double *change)
{
	const bool shows = a->shows && a->problem->visited;

	*change = 0;
	if (!first)
		quicken(a, rate);
	for (int i = 0; i < NODES; i++) {
		if (first) {
			value_ahead(a, i);
			memset(a->g[1 + i], 0, (size_t)a->problem->n * sizeof(double));
		} else {
			value_at(a, i);
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

static void polynomials(int count, double x, double *weight);

/* The small coefficients, which are n apart, first. */
static inline double series(const double w[NODES], const double *c, size_t n)
{
	return 0.0 + w[7] * c[7 * n] + w[6] * c[6 * n] + w[5] * c[5 * n] + w[4] * c[4 * n] +
	       w[3] * c[3 * n] + w[2] * c[2 * n] + w[1] * c[n] + w[0] * c[0];
}

/* Component i of the rates that a guess has where its polynomials are `weight`, x the length. */
static double guessed(const struct attempt *a, const double *weight, size_t i)
{
	return a->h_s / a->guess.length_s *
	       series(weight, a->guess.coefficient + i, (size_t)a->problem->n);
}

/*
 * Rates at all nodes as guessed, with what the guess misses at the beginning; false: it is none.
 * Where motion goes on that is what the polynomial does not have, P_8 above all, which at nodes
 * ahead is much; or else the size of a jump where one force joins those that go on.
 */
static bool guess(const struct attempt *a)
{
	const struct rb_gauss_problem *p = a->problem;
	const struct rb_gauss_guess *from = &a->guess;
	double weight[NODES + 1];

	if (!from->coefficient || !(from->from_s + a->h_s <= guess_reach * from->length_s))
		return false;
	polynomials(NODES + 1, from->from_s / from->length_s, weight);
	const double last = weight[NODES];
	for (size_t i = 0; i < (size_t)p->n; i++) {
		if (rate_row(p, i) >= 0)
			continue;
		a->value[i] = a->g[0][i] - guessed(a, weight, i);
		if (!(fabs(a->value[i]) <= guess_misses * a->size[i]))
			return false;
	}
	for (int j = 0; j < NODES; j++) {
		polynomials(NODES + 1, (from->from_s + node[j] * a->h_s) / from->length_s, weight);
		for (size_t i = 0; i < (size_t)p->n; i++) {
			if (rate_row(p, i) >= 0)
				continue;
			const bool jumps = !(fabs(a->value[i]) <=
			                     guess_smooth * p->tolerance * a->size[i]) ||
			                   !(from->from_s >= from->length_s);
			a->g[1 + j][i] = guessed(a, weight, i) +
			                 (jumps ? 1 : weight[NODES] / last) * a->value[i];
		}
	}
	return true;
}

/*
 * Visits until the changes are below rounding or no longer fall: `*left` is what they then are.
 * `*sweeps` is 0 when something is not finite or they go on without end. A change may grow now and
 * then (a chain q' = w, w' = f(q) that is none of rows shows it in every other visit), so that two
 * visits without halving the smallest change so far are wanted before giving up.
 */
static enum rb_status converge(struct attempt *a, double *rate, int *sweeps, double *left)
{
	double change, before, least;
	int stalled = 0;

	*sweeps = 0;
	*left = 0;
	enum rb_status status = RB_OK;
	const bool near = guess(a);
	a->guesses = !near;
	if (!near) {
		status = sweep(a, true, rate, &before);
		a->guesses = false;
		if (status != RB_OK || !isfinite(before))
			return status;
	}
	least = before = (double)INFINITY;
	a->shows = false;
	for (int count = 1; count <= SWEEPS_MAX; count++) {
		status = sweep(a, false, rate, &change);
		if (status != RB_OK || !isfinite(change))
			return status;
		const double ratio = change / before;
		if (change == 0 ||
		    (count > 1 && (change < 0x1p-2 * DBL_EPSILON ||
		                   (ratio < 0.5 && change * ratio < 0x1p-4 * DBL_EPSILON)))) {
			*sweeps = count;
			return RB_OK;
		}
		stalled = change < 0.5 * least ? 0 : stalled + 1;
		/* as the changes fall, the next one may be small enough */
		a->shows = stalled > 0 || (count > 1 ? change * ratio * ratio < 0x1p10 * DBL_EPSILON
		                                     : near && change < guess_near);
		least = fmin(least, change);
		before = change;
		if (stalled == 2) {
			*sweeps = count;
			*left = least;
			return RB_OK;
		}
	}
	return RB_OK;
}

/*
 * The largest part of the rates that the polynomial does not hold, integrated, relative to scale.
 * The missing coefficients are estimated from those that are there, in pairs (of functions that are
 * even or odd about the middle every other one is zero): the last pair falls on as the earlier ones
 * did, whichever fell less.
 */
static double tail(const struct rb_gauss_problem *problem, const double *coefficient)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double pair[3];

		for (size_t k = 0; k < 3; k++)
			pair[k] = fmax(fabs(coefficient[(2 * k + 2) * n + i]),
			               fabs(coefficient[(2 * k + 3) * n + i]));
		if (!(pair[2] > 0))
			continue;
		const double fall = fmin(fmax(pair[2] / pair[1], pair[1] / pair[0]), 1);
		/* the integral of P_8 is (P_9 - P_7)/34 on [0, 1] */
		const double missing = pair[2] * fall / (1 - fmin(fall, 0.75)) / 34;
		worst = fmax(worst, missing / problem->scale[i]);
	}
	return worst;
}

/*
 * What the rounding of coefficients makes, relative to scale or value: in a step so long that
 * nearly all of its motion comes from the acceleration little is left of that at its beginning,
 * where an event may cut it. The next one is not to be longer.
 */
static double rounded(const struct rb_gauss_problem *problem, const struct rb_gauss_piece *piece)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double sum = 0;

		for (size_t k = 0; k < NODES; k++)
			sum += fabs(piece->coefficient[k * n + i]);
		worst = fmax(worst,
		             rounding * sum / fmax(problem->scale[i], fabs(piece->start[i])));
	}
	return worst;
}

/*
 * What the polynomial misses between an end and the node next to it, where a jump is seen by no
 * node, integrated, relative to scale; of rates without one it is of the size of the tail.
 */
static double missed_at_ends(struct attempt *a, const double *coefficient, double *rate,
                             enum rb_status *status)
{
	const struct rb_gauss_problem *p = a->problem;
	const size_t n = (size_t)p->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		a->value[i] = a->start[i] + (a->rest[i] + coefficient[i]);
		if (rate_row(p, i) >= 0)
			continue;
		double odd = 0, even = 0;

		for (size_t k = NODES; k-- > 0;)
			*(k % 2 ? &odd : &even) += coefficient[k * n + i];
		/* at the end, for later */
		a->g[0][i] = even + odd;
		worst = fmax(worst, fabs(even - odd - a->h_s * a->first[i]) / p->scale[i]);
	}
	(*a->calls)++;
	*status = p->rates(p->user, a->time_s + a->h_s, a->value, rate, a->err);
	for (size_t i = 0; i < n && *status == RB_OK; i++)
		if (rate_row(p, i) < 0)
			worst = fmax(worst, fabs(a->g[0][i] - a->h_s * rate[i]) / p->scale[i]);
	return node[0] * worst;
}

/*
 * Where the last visit of the nodes was not foreseen, once more, and not counted; the values are as
 * accepted.
 */
static enum rb_status show(const struct attempt *a, double *rate)
{
	const struct rb_gauss_problem *p = a->problem;

	for (int i = 0; i < NODES && p->visited && !a->shows; i++) {
		value_at(a, i);
		const enum rb_status status = p->rates(p->user, a->time_s + node[i] * a->h_s,
		                                       a->value, rate, a->err);

		if (status != RB_OK)
			return status;
		p->visited(p->user, i);
	}
	return RB_OK;
}

/*
 * Of x' = v they follow from those of v' = f: the integral of P_k, k > 0, is (P_(k+1) - P_(k-1)) /
 * (2 (2k + 1)) on [0, 1], and what P_8 has of v is nothing at the nodes.
 */
static void integrated(const struct attempt *a, size_t i, size_t v, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;
	const double *const d = coefficient + v;

	coefficient[i] = a->h_s * a->start[v] + a->h_s * (a->rest[v] + (0.5 * d[0] - d[n] / 6));
	for (size_t k = 1; k < NODES; k++) {
		const double below = d[(k - 1) * n] / (double)(2 * (2 * k - 1));
		const double above = k + 1 < NODES ? d[(k + 1) * n] / (double)(2 * (2 * k + 3)) : 0;

		coefficient[k * n + i] = a->h_s * (below - above);
	}
}

static void coefficients(const struct attempt *a, double *coefficient)
{
	const size_t n = (size_t)a->problem->n;

	for (size_t i = 0; i < n; i++) {
		double both[2][NODES / 2], low[2] = {0, 0};

		if (rate_row(a->problem, i) >= 0)
			continue;
		/* from the ends to the middle, so that even and odd parts are not mixed */
		for (int j = 0; j < NODES / 2; j++) {
			both[0][j] = a->g[1 + j][i] + a->g[NODES - j][i];
			both[1][j] = a->g[1 + j][i] - a->g[NODES - j][i];
			low[0] += legendre_low[0][j] * both[0][j];
			low[1] += legendre_low[1][j] * both[1][j];
		}
		for (size_t k = 0; k < NODES; k++) {
			const double *const w = legendre[k], *const x = both[k % 2];

			coefficient[k * n + i] = 0.0 + w[0] * x[0] + w[1] * x[1] + w[2] * x[2] +
			                         w[3] * x[3] + (k < 2 ? low[k] : 0);
		}
	}
	for (size_t i = 0; i < n; i++)
		if (rate_row(a->problem, i) >= 0)
			integrated(a, i, (size_t)rate_row(a->problem, i), coefficient);
}

void rb_gauss_integrate(struct rb_gauss_piece *piece, double length_s, const double *rate)
{
	const size_t n = (size_t)piece->n;

	piece->length_s = length_s;
	memset(piece->start, 0, n * sizeof(double));
	for (size_t k = 0; k < NODES; k++)
		for (size_t i = 0; i < n; i++) {
			double sum = 0;

			for (size_t j = 0; j < NODES; j++)
				sum += legendre[k][j < NODES / 2 ? j : NODES - 1 - j] *
				       (k % 2 && j >= NODES / 2 ? -rate[j * n + i]
				                                : rate[j * n + i]);
			piece->coefficient[k * n + i] = length_s * sum;
		}
}

/*
 * What to try next; the eighth root by square roots, which round the same everywhere. Rounded down
 * to 8 binary digits, so that the lengths of steps add up without error.
 */
static double next_length(double h_s, double tolerance, double error, int sweeps, bool halved)
{
	const double max = halved || sweeps > SWEEPS_MANY ? 1 : 4;
	double factor = max;
	int exponent;

	if (error > 0)
		factor = fmax(fmin(0.8 * sqrt(sqrt(sqrt(tolerance / error))), max), 0.25);
	const double digits = frexp(h_s * factor, &exponent);
	return ldexp(floor(digits * 0x1p8), exponent - 8);
}

enum rb_status rb_gauss_step(const struct rb_gauss_problem *problem, double time_s, double *try_s,
                             double least_s, struct rb_gauss_piece *piece, struct rb_error *err)
{
	const size_t n = (size_t)problem->n;
	double *const rate = problem->scratch, *const none = rate + n;
	struct attempt a = {.problem = problem,
	                    .guess = problem->guess,
	                    .time_s = time_s,
	                    .start = piece->start,
	                    .rest = piece->rest ? piece->rest : none,
	                    .first = rate + 2 * n,
	                    .value = rate + 3 * n,
	                    .size = rate + 4 * n,
	                    .calls = problem->calls,
	                    .err = err};
	double change = 0, left;
	int sweeps;

	a.guesses = true;
	for (size_t j = 0; j <= NODES; j++)
		a.g[j] = rate + (5 + j) * n;
	if (!(*try_s > 0) || !isfinite(*try_s))
		return RB_FAIL(err, RB_ERR_PHYSICS, "'step' is %g s, not a positive number",
		               *try_s);
	memset(none, 0, n * sizeof(double));
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
		status = converge(&a, rate, &sweeps, &left);
		if (status != RB_OK)
			return status;
		if (sweeps > 0) {
			coefficients(&a, piece->coefficient);
			const double error = tail(problem, piece->coefficient);
			const double asked = fmax(
				problem->tolerance,
				problem->noise ? problem->noise(problem->user, piece->coefficient)
					       : 0);
			const bool fits = error <= asked && left <= asked;
			const double missed = fits && problem->jumps
			                              ? missed_at_ends(&a, piece->coefficient, rate,
			                                               &status)
			                              : 0;
			if (status != RB_OK)
				return status;
			if (fits && missed <= MISSED_TAILS * asked) {
				status = show(&a, rate);
				piece->length_s = a.h_s;
				*try_s = next_length(a.h_s, asked,
				                     fmax(error, rounded(problem, piece)), sweeps,
				                     a.h_s < *try_s);
				return status;
			}
		}
		/* what was too long is the best guess of its half */
		a.guess = (struct rb_gauss_guess){
			.coefficient = sweeps > 0 ? piece->coefficient : NULL, .length_s = a.h_s};
		if (!(0.5 * a.h_s >= least_s) || !(0.5 * a.h_s > 0))
			return RB_FAIL(err, RB_ERR_PHYSICS,
			               "'step' at %g s would have to be shorter than %g s for an "
			               "error of %g",
			               time_s, least_s, problem->tolerance);
	}
}

/*
 * Integrals over [0, x] of P_k on [0, 1], x in [0, 1]: x for k = 0, else -2 x (1 - x) P'_k(2x - 1)
 * / (k (k + 1)), whose factors keep all digits near both ends. The P'_k are Gegenbauer's
 * polynomials for 3/2: n C_n = (2n + 1) u C_(n-1) - (n + 1) C_(n-2).
 */
static void integrals(double x, double weight[NODES])
{
	const double u = 2 * x - 1, ends = -2 * x * (1 - x);
	double older = 0, old = 1;

	weight[0] = x;
	for (int k = 1; k < NODES; k++) {
		weight[k] = ends * old / (k * (k + 1));
		const double next = ((2 * k + 1) * u * old - (k + 1) * older) / k;
		older = old;
		old = next;
	}
}

static double part_of(const struct rb_gauss_piece *piece, double t)
{
	return piece->length_s > 0 ? t / piece->length_s : 0;
}

static double sum_of(const struct rb_gauss_piece *piece, size_t i, const double weight[NODES])
{
	return series(weight, piece->coefficient + i, (size_t)piece->n);
}

static double value_of(const struct rb_gauss_piece *piece, size_t i, const double weight[NODES])
{
	const double sum = sum_of(piece, i, weight);

	return piece->start[i] + (piece->rest ? piece->rest[i] + sum : sum);
}

double rb_gauss_value(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	return value_of(piece, (size_t)i, weight);
}

void rb_gauss_some(const struct rb_gauss_piece *piece, int first, int count, double t,
                   double *value)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		value[i] = value_of(piece, (size_t)(first + i), weight);
}

void rb_gauss_values(const struct rb_gauss_piece *piece, double t, double *value)
{
	rb_gauss_some(piece, 0, piece->n, t, value);
}

/* A sum and what its rounding has left out (Dekker, Numer. Math. 18 (1971) 224). */
struct sum {
	double high, low;
};

static void add(struct sum *s, double x)
{
	const double sum = s->high + x, part = sum - s->high;

	s->low += (s->high - (sum - part)) + (x - part);
	s->high = sum;
}

static void add_product(struct sum *s, double a, double b)
{
	const double product = a * b;

	add(s, product);
	s->low += fma(a, b, -product);
}

/* What rounding leaves out of component i where the polynomials are `weight`. */
static double left_out(const struct rb_gauss_piece *piece, size_t i, int rate_row,
                       const double weight[NODES])
{
	const size_t n = (size_t)piece->n;
	const double *const c = piece->coefficient, h = piece->length_s;
	struct sum s = {piece->start[i], piece->rest ? piece->rest[i] : 0};

	for (size_t k = 0; k < NODES; k++)
		add_product(&s, weight[k], c[k * n + i]);
	if (rate_row >= 0) {
		const double *const v = c + rate_row;
		const double rest = piece->rest ? piece->rest[rate_row] : 0;
		struct sum lost = {-c[i], 0};

		add_product(&lost, h, piece->start[rate_row]);
		add_product(&lost, h, rest + (0.5 * v[0] - v[n] / 6));
		s.low += weight[0] * (lost.high + lost.low);
	}
	return (s.high - value_of(piece, i, weight)) + s.low;
}

void rb_gauss_rests(const struct rb_gauss_piece *piece, int first, int count, const int *rate_row,
                    double t, double *rest)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		rest[i] = left_out(piece, (size_t)(first + i), rate_row[i], weight);
}

/* P_0 .. P_(count - 1) on [0, 1] */
static void polynomials(int count, double x, double *weight)
{
	const double u = 2 * x - 1;

	weight[0] = 1;
	weight[1] = u;
	for (int k = 1; k + 1 < count; k++)
		weight[k + 1] = ((2 * k + 1) * u * weight[k] - k * weight[k - 1]) / (k + 1);
}

void rb_gauss_basis(double x, double value[NODES], double rate[NODES])
{
	integrals(x, value);
	polynomials(NODES, x, rate);
}

double rb_gauss_rate(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	polynomials(NODES, part_of(piece, t), weight);
	return sum_of(piece, (size_t)i, weight) / piece->length_s;
}

void rb_gauss_some_rates(const struct rb_gauss_piece *piece, int first, int count, double t,
                         double *rate)
{
	double weight[NODES];

	polynomials(NODES, part_of(piece, t), weight);
	for (int i = 0; i < count; i++)
		rate[i] = sum_of(piece, (size_t)(first + i), weight) / piece->length_s;
}

double rb_gauss_rate_bound(const struct rb_gauss_piece *piece, int i)
{
	double sum = 0;

	for (size_t k = NODES; k-- > 0;)
		sum += fabs(piece->coefficient[k * (size_t)piece->n + (size_t)i]);
	return sum * (1 + 16 * DBL_EPSILON) /
	       piece->length_s; /* the sum may have been rounded down */
}
