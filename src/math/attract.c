/* SPDX-License-Identifier: MIT */
/*
 * Four points at a time are attracted by one after the other: each lane sums for its own point, so
 * that lanes exchange nothing and the result does not depend on their number. Action and reaction
 * are computed separately, which costs twice the roots of a pair but no scattered sums.
 */
#include "math/attract.h"

#include <math.h>

#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "base/error.h"

enum { WIDTH = 4 };
typedef double lanes __attribute__((vector_size(WIDTH * sizeof(double)), aligned(8)));
typedef long long masks __attribute__((vector_size(WIDTH * sizeof(long long)), aligned(8)));
#define ALWAYS static inline __attribute__((always_inline))

/* Vectors go by reference: how they would be passed depends on the processor. */
ALWAYS void root(const lanes *x, lanes *r)
{
#ifdef __SSE2__
	const __m128d low = _mm_sqrt_pd((__m128d){(*x)[0], (*x)[1]});
	const __m128d high = _mm_sqrt_pd((__m128d){(*x)[2], (*x)[3]});

	*r = (lanes){low[0], low[1], high[0], high[1]};
#else
	for (int i = 0; i < WIDTH; i++)
		(*r)[i] = sqrt((*x)[i]);
#endif
}

/* Sum and what rounding has left of it. */
struct sum {
	lanes value, rest;
};

ALWAYS void add(struct sum *sum, const lanes *term)
{
	const lanes value = sum->value + *term, back = value - sum->value;

	sum->rest += (sum->value - (value - back)) + (*term - back);
	sum->value = value;
}

/* Four points that are attracted. */
struct points {
	lanes x[3], rest[3];
	struct sum sum[3];
};

ALWAYS void attract(const struct rb_attract *all, struct points *p, int j)
{
	lanes d[3], square, distance, factor;

	for (int m = 0; m < 3; m++)
		d[m] = (all->x[m][j] - p->x[m]) + (all->rest[m][j] - p->rest[m]);
	square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	/* the point itself, and what is at the same place: no force */
	const masks apart = (masks)(square > 0);
	square += all->softening2;
	root(&square, &distance);
	factor = all->mu[j] / (square * distance);
	factor = (lanes)((masks)factor & apart);
	for (int m = 0; m < 3; m++) {
		const lanes term = factor * d[m];

		add(&p->sum[m], &term);
	}
}

ALWAYS void run(const struct rb_attract *all, int first, int end, double *const acceleration[3])
{
	for (int k = first; k < end; k += WIDTH) {
		struct points p = {0};

		for (int lane = 0; lane < WIDTH; lane++)
			for (int m = 0; m < 3; m++) {
				/* the last one fills up what is left of the lanes */
				const int i = k + lane < end ? k + lane : end - 1;

				p.x[m][lane] = all->x[m][i];
				p.rest[m][lane] = all->rest[m][i];
			}
		for (int j = 0; j < all->count; j++)
			if (all->mu[j] > 0)
				attract(all, &p, j);
		for (int lane = 0; lane < WIDTH && k + lane < end; lane++)
			for (int m = 0; m < 3; m++)
				acceleration[m][k + lane] = p.sum[m].value[lane] +
				                            p.sum[m].rest[lane];
	}
}

#if defined(__x86_64__) && !defined(__AVX2__)
__attribute__((target("avx2"))) static void run_avx2(const struct rb_attract *all, int first,
                                                     int end, double *const acceleration[3])
{
	run(all, first, end, acceleration);
}

static bool has_avx2(void)
{
	return __builtin_cpu_supports("avx2");
}
#else
static void run_avx2(const struct rb_attract *all, int first, int end,
                     double *const acceleration[3])
{
	run(all, first, end, acceleration);
}

static bool has_avx2(void)
{
	return false;
}
#endif

void rb_attract_some(const struct rb_attract *all, int first, int end,
                     double *const acceleration[3])
{
	RB_ASSERT(first >= 0 && end <= all->count);
	RB_ASSERT(all->softening2 >= 0);
	if (has_avx2())
		run_avx2(all, first, end, acceleration);
	else
		run(all, first, end, acceleration);
}

rb_vec3 rb_attract_between(const struct rb_attract *all, int i, int j, double *factor)
{
	rb_vec3 d;

	d.x = (all->x[0][j] - all->x[0][i]) + (all->rest[0][j] - all->rest[0][i]);
	d.y = (all->x[1][j] - all->x[1][i]) + (all->rest[1][j] - all->rest[1][i]);
	d.z = (all->x[2][j] - all->x[2][i]) + (all->rest[2][j] - all->rest[2][i]);
	const double square = d.x * d.x + d.y * d.y + d.z * d.z;
	const double soft = square + all->softening2;

	*factor = square > 0 ? 1 / (soft * sqrt(soft)) : 0;
	return d;
}

double rb_attract_distance(const struct rb_attract *all, int i, double *depth)
{
	double sum = 0, weight = 0;

	for (int j = 0; j < all->count; j++) {
		double factor;

		if (j == i || !(all->mu[j] > 0))
			continue;
		const rb_vec3 d = rb_attract_between(all, i, j, &factor);
		const double square = rb_vec3_dot(d, d) + all->softening2;

		sum += all->mu[j] * factor * square;
		weight += all->mu[j] * factor * sqrt(square);
	}
	*depth = sum;
	return weight > 0 ? sum / weight : (double)INFINITY;
}

double rb_attract_strength(const struct rb_attract *all, int i, int j)
{
	const bool fixed_i = isinf(all->inertial[i]), fixed_j = isinf(all->inertial[j]);

	if (fixed_i || fixed_j)
		return fixed_i && fixed_j ? 0
		       : fixed_i          ? all->inertial[j] * all->mu[i]
		                          : all->inertial[i] * all->mu[j];
	return fmax(all->inertial[i] * all->mu[j], all->inertial[j] * all->mu[i]);
}

double rb_attract_energy(const struct rb_attract *all)
{
	double sum = 0, rest = 0;

	for (int i = 0; i < all->count; i++)
		for (int j = 0; j < i; j++) {
			double factor;

			if (!(all->mu[i] > 0) && !(all->mu[j] > 0))
				continue;
			const rb_vec3 d = rb_attract_between(all, i, j, &factor);
			const double soft = sqrt(rb_vec3_dot(d, d) + all->softening2);
			const double term = soft > 0 ? -rb_attract_strength(all, i, j) / soft : 0;
			const double value = sum + term, back = value - sum;

			rest += (sum - (value - back)) + (term - back);
			sum = value;
		}
	return sum + rest;
}
