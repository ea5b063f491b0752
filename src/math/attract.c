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

/* One coordinate of four points. */
struct coordinate {
	lanes x, rest;
};

ALWAYS void load(const struct rb_attract *all, int m, int first, int end, struct coordinate *c)
{
	for (int lane = 0; lane < WIDTH; lane++) {
		/* the last one fills up what is left of the lanes */
		const int i = first + lane < end ? first + lane : end - 1;

		c->x[lane] = all->x[m][i];
		c->rest[lane] = all->rest[m][i];
	}
}

ALWAYS void store(const struct sum *sum, int first, int end, double *to)
{
	for (int lane = 0; lane < WIDTH && first + lane < end; lane++)
		to[first + lane] = sum->value[lane] + sum->rest[lane];
}

/* Four points from `first` on. Coordinates are written out, so that sums stay in registers. */
ALWAYS void run_four(const struct rb_attract *all, int first, int end,
                     double *const acceleration[3])
{
	const double *const px = all->x[0], *const py = all->x[1], *const pz = all->x[2];
	const double *const rx = all->rest[0], *const ry = all->rest[1], *const rz = all->rest[2];
	const double *const mu = all->mu, softening2 = all->softening2;
	struct coordinate x, y, z;
	struct sum sx = {0}, sy = {0}, sz = {0};

	load(all, 0, first, end, &x);
	load(all, 1, first, end, &y);
	load(all, 2, first, end, &z);
	for (int j = 0; j < all->count; j++) {
		const lanes dx = (px[j] - x.x) + (rx[j] - x.rest);
		const lanes dy = (py[j] - y.x) + (ry[j] - y.rest);
		const lanes dz = (pz[j] - z.x) + (rz[j] - z.rest);
		const lanes square = dx * dx + dy * dy + dz * dz;
		/* the point itself, and what is at the same place: no force */
		const masks distinct = (masks)(square > 0);
		const lanes soft = square + softening2;
		lanes distance;

		root(&soft, &distance);
		const lanes all_factor = mu[j] / (soft * distance);
		const lanes factor = (lanes)((masks)all_factor & distinct);
		const lanes ax = factor * dx, ay = factor * dy, az = factor * dz;

		add(&sx, &ax);
		add(&sy, &ay);
		add(&sz, &az);
	}
	store(&sx, first, end, acceleration[0]);
	store(&sy, first, end, acceleration[1]);
	store(&sz, first, end, acceleration[2]);
}

ALWAYS void run(const struct rb_attract *all, int first, int end, double *const acceleration[3])
{
	for (int k = first; k < end; k += WIDTH)
		run_four(all, k, end, acceleration);
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
