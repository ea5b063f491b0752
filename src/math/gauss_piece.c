/* SPDX-License-Identifier: MIT */
#include "math/gauss_piece.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "math/gauss_tables.h"
#include "math/lanes.h"

enum { NODES = RB_GAUSS_NODES };

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

/* Sums the small coefficients first; they are n apart. */
static inline double series(const double w[NODES], const double *c, size_t n)
{
	return 0.0 + w[7] * c[7 * n] + w[6] * c[6 * n] + w[5] * c[5 * n] + w[4] * c[4 * n] +
	       w[3] * c[3 * n] + w[2] * c[2 * n] + w[1] * c[n] + w[0] * c[0];
}

static double part_of(const struct rb_gauss_piece *piece, double t)
{
	return piece->length_s > 0 ? t / piece->length_s : 0;
}

RB_LANES_INLINE double sum_of(const struct rb_gauss_piece *piece, size_t i,
                              const double weight[NODES])
{
	return series(weight, piece->coefficient + i, (size_t)piece->n);
}

RB_LANES_INLINE double value_of(const struct rb_gauss_piece *piece, size_t i,
                                const double weight[NODES])
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

/* A sum and its rounding error (Dekker, Numer. Math. 18 (1971) 224). */
struct sum {
	double high, low;
};

RB_LANES_INLINE void add(struct sum *s, double x)
{
	const double sum = s->high + x, part = sum - s->high;

	s->low += (s->high - (sum - part)) + (x - part);
	s->high = sum;
}

RB_LANES_INLINE void add_product(struct sum *s, double a, double b)
{
	const double product = a * b;

	add(s, product);
	s->low += fma(a, b, -product);
}

/* Rounding error of component i where the polynomials are `weight`. */
RB_LANES_INLINE double rounding_error(const struct rb_gauss_piece *piece, size_t i, int rate_row,
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

RB_LANES_INLINE void rests(const struct rb_gauss_piece *piece, int first, int count,
                           const int *rate_row, const double weight[NODES], double *rest)
{
	for (int i = 0; i < count; i++)
		rest[i] = rounding_error(piece, (size_t)(first + i), rate_row[i], weight);
}

RB_LANES_AVX2 static void rests_avx2(const struct rb_gauss_piece *piece, int first, int count,
                                     const int *rate_row, const double weight[NODES], double *rest)
{
	rests(piece, first, count, rate_row, weight, rest);
}

void rb_gauss_rests(const struct rb_gauss_piece *piece, int first, int count, const int *rate_row,
                    double t, double *rest)
{
	double weight[NODES];

	integrals(part_of(piece, t), weight);
	if (rb_lanes_avx2())
		rests_avx2(piece, first, count, rate_row, weight, rest);
	else
		rests(piece, first, count, rate_row, weight, rest);
}

void rb_gauss_polynomials(int count, double x, double *weight)
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
	rb_gauss_polynomials(NODES, x, rate);
}

double rb_gauss_rate(const struct rb_gauss_piece *piece, int i, double t)
{
	double weight[NODES];

	rb_gauss_polynomials(NODES, part_of(piece, t), weight);
	return sum_of(piece, (size_t)i, weight) / piece->length_s;
}

void rb_gauss_some_rates(const struct rb_gauss_piece *piece, int first, int count, double t,
                         double *rate)
{
	double weight[NODES];

	rb_gauss_polynomials(NODES, part_of(piece, t), weight);
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

double rb_gauss_node(int k)
{
	return node[k];
}

void rb_gauss_lagrange(double x, double weight[NODES])
{
	double polynomial[NODES];

	rb_gauss_polynomials(NODES, x, polynomial);
	for (int j = 0; j < NODES / 2; j++) {
		double even = 0, odd = 0;

		for (int k = 0; k < NODES; k += 2) {
			even += legendre[k][j] * polynomial[k];
			odd += legendre[k + 1][j] * polynomial[k + 1];
		}
		weight[j] = even + odd;
		weight[NODES - 1 - j] = even - odd;
	}
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
