/* SPDX-License-Identifier: MIT */
#include "math/gauss_newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "math/gauss_error.h"
#include "math/gauss_tables.h"

enum { NODES = RB_GAUSS_NODES, PAIRS = NODES / 2, SYSTEMS = PAIRS + 1 };
/* Newton steps of an attempt; steps after which the Jacobian is that of its middle; failures. */
enum { SOLUTIONS_MAX = 14, SOLUTIONS_BEFORE = 3, FAILURES_MAX = 3 };

/*
 * Change of a row by another within a step, relative to scale, below which visits converge as fast.
 */
static const double slight = 0x1p-6;
/* Displacement of values for difference quotients, relative to scale: the root of an ulp. */
static const double moved = 0x1p-26;

size_t rb_gauss_newton_size(int n)
{
	const size_t m = (size_t)n;

	/* each index takes the room of a double */
	return (1 + 2 * SYSTEMS) * m * m + (2 + 2 * PAIRS + NODES) * m + (1 + SYSTEMS) * m;
}

void rb_gauss_newton_begin(struct rb_gauss_newton *newton, const struct rb_gauss_problem *problem)
{
	const size_t n = (size_t)problem->n;
	double *at = problem->newton;

	RB_ASSERT(problem->n > 0 && problem->n <= RB_GAUSS_NEWTON_LIMIT);
	*newton = (struct rb_gauss_newton){.problem = problem, .jacobian = at};
	at += n * n;
	for (size_t k = 0; k < SYSTEMS; k++, at += 2 * n * n)
		newton->lu[k] = (struct rb_gauss_complex *)at;
	newton->solution = (struct rb_gauss_complex *)at;
	newton->base = at += 2 * PAIRS * n;
	newton->base_rate = at += n;
	at += n;
	for (size_t i = 0; i < NODES; i++, at += n)
		newton->residual[i] = at;
	newton->row = (int *)at;
	for (size_t k = 0; k < SYSTEMS; k++)
		newton->pivot[k] = (int *)(at + (1 + k) * n);
}

static int rate_row(const struct rb_gauss_problem *p, int i)
{
	return p->rate_row ? p->rate_row[i] : -1;
}

/* Entry of J_a (`twice` false) or J_b; `column` is a row whose rate is not a row. */
static double entry(const struct rb_gauss_newton *newton, int row, int column, bool twice)
{
	const struct rb_gauss_problem *p = newton->problem;
	const double *const of = newton->jacobian + (size_t)row * (size_t)p->n;
	double sum = 0;

	if (!twice)
		return of[column];
	for (int x = 0; p->rate_row && x < p->n; x++)
		if (p->rate_row[x] == column)
			sum += of[x];
	return sum;
}

/* Is the row coupled with another one? */
static bool is_stiff(const struct rb_gauss_newton *newton, int i, double h)
{
	const struct rb_gauss_problem *p = newton->problem;

	for (int k = 0; k < p->n; k++) {
		if (rate_row(p, k) >= 0)
			continue;
		const double ratio = p->scale[k] / p->scale[i], other = p->scale[i] / p->scale[k];

		for (int twice = 0; twice < 2; twice++) {
			const double part = twice ? h * h : h;

			if (!(part * ratio * fabs(entry(newton, i, k, twice)) < slight) ||
			    !(part * other * fabs(entry(newton, k, i, twice)) < slight))
				return true;
		}
	}
	return false;
}

typedef struct rb_gauss_complex number;

static number times(number a, number b)
{
	return (number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static double square_of(number a)
{
	return a.re * a.re + a.im * a.im;
}

static number over(number a, number b)
{
	const double size = fmax(fabs(b.re), fabs(b.im)), re = b.re / size, im = b.im / size;
	const double inverse = 1 / (size * (re * re + im * im));

	return (number){inverse * (a.re * re + a.im * im), inverse * (a.im * re - a.re * im)};
}

/* LU factorization with row pivots, in place; skips zeros. False: singular. */
static bool factor(number *lu, int *pivot, size_t n)
{
	for (size_t k = 0; k < n; k++) {
		size_t best = k;

		for (size_t i = k + 1; i < n; i++)
			if (square_of(lu[i * n + k]) > square_of(lu[best * n + k]))
				best = i;
		pivot[k] = (int)best;
		const number largest = lu[best * n + k];
		if (!(square_of(largest) > 0) || !isfinite(square_of(largest)))
			return false;
		for (size_t j = 0; best != k && j < n; j++) {
			const number other = lu[k * n + j];

			lu[k * n + j] = lu[best * n + j];
			lu[best * n + j] = other;
		}
		for (size_t i = k + 1; i < n; i++) {
			const number share = over(lu[i * n + k], largest);

			lu[i * n + k] = share;
			if (share.re == 0 && share.im == 0)
				continue;
			for (size_t j = k + 1; j < n; j++) {
				const number product = times(share, lu[k * n + j]);

				lu[i * n + j].re -= product.re;
				lu[i * n + j].im -= product.im;
			}
		}
	}
	return true;
}

static void solve(const number *lu, const int *pivot, size_t n, number *x)
{
	for (size_t k = 0; k < n; k++) {
		const number other = x[pivot[k]];

		x[pivot[k]] = x[k];
		x[k] = other;
	}
	for (size_t k = 0; k < n; k++)
		for (size_t j = 0; j < k; j++) {
			const number product = times(lu[k * n + j], x[j]);

			x[k].re -= product.re;
			x[k].im -= product.im;
		}
	for (size_t k = n; k-- > 0;) {
		for (size_t j = k + 1; j < n; j++) {
			const number product = times(lu[k * n + j], x[j]);

			x[k].re -= product.re;
			x[k].im -= product.im;
		}
		x[k] = over(x[k], lu[k * n + k]);
	}
}

/* Factors for that eigenvalue. */
static bool factors_of(struct rb_gauss_newton *newton, number z, number *lu, int *pivot)
{
	const size_t m = (size_t)newton->count;
	const number zz = times(z, z);

	for (size_t r = 0; r < m; r++)
		for (size_t c = 0; c < m; c++) {
			const double once = entry(newton, newton->row[r], newton->row[c], false);
			const double twice = entry(newton, newton->row[r], newton->row[c], true);

			lu[r * m + c] = (number){(r == c) - z.re * once - zz.re * twice,
			                         -z.im * once - zz.im * twice};
		}
	return factor(lu, pivot, m);
}

/* Factors for a step of that length. False: nothing in it is stiff, or a matrix is singular. */
static bool factors(struct rb_gauss_newton *newton, double h_s)
{
	const struct rb_gauss_problem *p = newton->problem;
	bool good = true;

	newton->count = 0;
	for (int i = 0; i < p->n; i++)
		if (rate_row(p, i) < 0 && is_stiff(newton, i, h_s))
			newton->row[newton->count++] = i;
	const size_t m = (size_t)newton->count;
	for (int k = 0; k < SYSTEMS && good && m > 0; k++) {
		const number z = {k < PAIRS ? h_s * pair_value[k][0] : h_s,
		                  k < PAIRS ? h_s * pair_value[k][1] : 0};

		good = factors_of(newton, z, newton->lu[k], newton->pivot[k]);
	}
	if (p->products)
		*p->products += SYSTEMS * 4 * m * m * m / 3;
	return good && m > 0;
}

/* Replaces the residuals at the nodes by the changes. */
static void solve_all(const struct rb_gauss_newton *newton)
{
	const size_t m = (size_t)newton->count;

	for (size_t k = 0; k < PAIRS; k++) {
		number *const x = newton->solution + k * m;

		for (size_t r = 0; r < m; r++) {
			x[r] = (number){0, 0};
			for (size_t i = 0; i < NODES; i++) {
				x[r].re += pair_from[k][0][i] * newton->residual[i][newton->row[r]];
				x[r].im += pair_from[k][1][i] * newton->residual[i][newton->row[r]];
			}
		}
		solve(newton->lu[k], newton->pivot[k], m, x);
	}
	for (size_t r = 0; r < m; r++)
		for (size_t i = 0; i < NODES; i++) {
			double sum = 0;

			for (size_t k = 0; k < PAIRS; k++) {
				const number x = newton->solution[k * m + r];

				sum += pair_to[k][0][i] * x.re - pair_to[k][1][i] * x.im;
			}
			newton->residual[i][newton->row[r]] = 2 * sum;
		}
}

/* Computes rates at nodes->value; false: a value is not finite, and rates are not evaluated. */
static bool rates_at(const struct rb_gauss_newton *newton, const struct rb_gauss_nodes *nodes,
                     double part, enum rb_status *status)
{
	const struct rb_gauss_problem *p = newton->problem;
	double zeros = 0;

	for (int i = 0; i < p->n; i++)
		zeros += 0 * nodes->value[i];
	if (zeros != 0)
		return false;
	++*p->calls;
	*status = p->rates(p->user, nodes->time_s + part * nodes->h_s, nodes->value, nodes->rate,
	                   nodes->err);
	return *status == RB_OK;
}

/*
 * Displacement of a value: in its direction of motion, so that results are mirrored with the
 * problem.
 */
static double move(const struct rb_gauss_newton *newton, int k)
{
	const struct rb_gauss_problem *p = newton->problem;
	const int v = rate_row(p, k);
	const double motion = newton->base[k] != 0 ? newton->base[k]
	                      : v >= 0             ? newton->base[v]
	                                           : newton->base_rate[k];

	return motion < 0 ? -moved * p->scale[k] : moved * p->scale[k];
}

/* Computes the Jacobian at newton->base. False with RB_OK in *status: there is none. */
static bool differentiate(struct rb_gauss_newton *newton, const struct rb_gauss_nodes *nodes,
                          double part, enum rb_status *status)
{
	const struct rb_gauss_problem *p = newton->problem;
	const size_t n = (size_t)p->n;

	*status = RB_OK;
	memcpy(nodes->value, newton->base, n * sizeof(double));
	for (size_t k = 0; k < n; k++) {
		nodes->value[k] = newton->base[k] + move(newton, (int)k);
		const double by = nodes->value[k] - newton->base[k];

		if (!(fabs(by) > 0) || !rates_at(newton, nodes, part, status))
			return false;
		for (size_t i = 0; i < n; i++)
			newton->jacobian[i * n + k] = (nodes->rate[i] - newton->base_rate[i]) / by;
		nodes->value[k] = newton->base[k];
	}
	return true;
}

enum rb_status rb_gauss_newton_prepare(struct rb_gauss_newton *newton,
                                       const struct rb_gauss_nodes *nodes, const double *start,
                                       const double *first)
{
	const size_t size = (size_t)newton->problem->n * sizeof(double);
	enum rb_status status = RB_OK;

	if (newton->is_known)
		return RB_OK;
	memcpy(newton->base, start, size);
	memcpy(newton->base_rate, first, size);
	newton->is_known = differentiate(newton, nodes, 0, &status);
	newton->is_out = !newton->is_known;
	return status;
}

/*
 * Replaces the Jacobian by that at the present middle of the step. False with RB_OK in *status:
 * there is none.
 */
static bool differentiate_again(struct rb_gauss_newton *newton, const struct rb_gauss_nodes *nodes,
                                enum rb_status *status)
{
	const size_t size = (size_t)newton->problem->n * sizeof(double);
	const int middle = NODES / 2;

	newton->is_known = false;
	nodes->value_at(nodes->attempt, middle);
	if (!rates_at(newton, nodes, node[middle], status))
		return false;
	memcpy(newton->base, nodes->value, size);
	memcpy(newton->base_rate, nodes->rate, size);
	return differentiate(newton, nodes, node[middle], status) && factors(newton, nodes->h_s);
}

/* Change of values by changes of rates at the nodes, relative to scale. */
static double value_change(const struct rb_gauss_newton *newton, const struct rb_gauss_nodes *nodes)
{
	const struct rb_gauss_problem *p = newton->problem;
	double max = 0;

	for (int j = 0; j < NODES; j++)
		for (int i = 0; i < p->n; i++) {
			double sum = 0;

			for (int k = 0; k < NODES; k++)
				sum += matrix[j][k] * newton->residual[k][i];
			max = rb_gauss_worse(fabs(sum) / nodes->size[i], max);
		}
	return max;
}

/* One Newton step; the largest change. */
static enum rb_status improve(const struct rb_gauss_newton *newton,
                              const struct rb_gauss_nodes *nodes, double *change)
{
	const struct rb_gauss_problem *p = newton->problem;
	enum rb_status status = RB_OK;

	*change = (double)INFINITY;
	for (int j = 0; j < NODES; j++) {
		nodes->value_at(nodes->attempt, j);
		if (!rates_at(newton, nodes, node[j], &status))
			return status;
		for (int i = 0; i < p->n; i++)
			newton->residual[j][i] = rate_row(p, i) < 0 ? nodes->h_s * nodes->rate[i] -
			                                                      nodes->g[1 + j][i]
			                                            : 0;
	}
	solve_all(newton);
	for (int j = 0; j < NODES; j++)
		for (int i = 0; i < p->n; i++)
			nodes->g[1 + j][i] += newton->residual[j][i];
	*change = value_change(newton, nodes);
	return RB_OK;
}

/* Newton steps until only rounding changes; *sweeps is 0 if they do not converge. */
static enum rb_status iterate(struct rb_gauss_newton *newton, const struct rb_gauss_nodes *nodes,
                              int *sweeps, double *residual)
{
	const struct rb_gauss_problem *p = newton->problem;
	double smallest = (double)INFINITY, before = (double)INFINITY, change;
	int stalled = 0;

	for (int j = 1; j <= NODES; j++)
		memset(nodes->g[j], 0, (size_t)p->n * sizeof(double));
	for (int count = 1; count <= SOLUTIONS_MAX; count++) {
		enum rb_status status = improve(newton, nodes, &change);

		if (status != RB_OK || !isfinite(change))
			return status;
		stalled = change < 0.5 * smallest ? 0 : stalled + 1;
		smallest = fmin(smallest, change);
		const bool rounds = stalled == 2 && smallest < p->tolerance;
		if (rounds || change < DBL_EPSILON ||
		    (count > 1 && change / before * change < 0x1p-4 * DBL_EPSILON)) {
			*sweeps = count;
			*residual = rounds ? smallest : 0;
			return RB_OK;
		}
		if (stalled == 2)
			return RB_OK;
		before = change;
		if (count == SOLUTIONS_BEFORE && !differentiate_again(newton, nodes, &status))
			return status;
	}
	return RB_OK;
}

enum rb_status rb_gauss_newton_converge(struct rb_gauss_newton *newton,
                                        const struct rb_gauss_nodes *nodes, int *sweeps,
                                        double *residual)
{
	enum rb_status status = RB_OK;

	*sweeps = 0;
	*residual = 0;
	if (factors(newton, nodes->h_s))
		status = iterate(newton, nodes, sweeps, residual);
	newton->is_used = *sweeps > 0;
	if (!newton->is_used)
		newton->is_out = ++newton->failures >= FAILURES_MAX;
	return status;
}

void rb_gauss_newton_soften(const struct rb_gauss_newton *newton, double *residual)
{
	const size_t m = (size_t)newton->count;
	number *const x = newton->solution;

	for (size_t r = 0; r < m; r++)
		x[r] = (number){residual[newton->row[r]], 0};
	solve(newton->lu[PAIRS], newton->pivot[PAIRS], m, x);
	for (size_t r = 0; r < m; r++)
		residual[newton->row[r]] = x[r].re;
}
