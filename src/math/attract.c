/* SPDX-License-Identifier: MIT */
/*
 * Four points at a time are attracted by one after the other: each lane sums for its own point, so
 * that lanes exchange nothing and the result does not depend on their number. Action and reaction
 * are computed separately, which costs twice the roots of a pair but no scattered sums.
 */
#include "math/attract.h"

#include <math.h>

#include "base/error.h"
#include "math/lanes.h"

/* Sum and what rounding has left of it. */
struct sum {
	rb_lanes value, rest;
};

RB_LANES_INLINE void add(struct sum *sum, const rb_lanes *term)
{
	const rb_lanes value = sum->value + *term, back = value - sum->value;

	sum->rest += (sum->value - (value - back)) + (*term - back);
	sum->value = value;
}

/* One coordinate of four points. */
struct coordinate {
	rb_lanes x, rest;
};

RB_LANES_INLINE void load(const struct rb_attract *all, int m, const int point[RB_LANES],
                          struct coordinate *c)
{
	for (int lane = 0; lane < RB_LANES; lane++) {
		c->x[lane] = all->x[m][point[lane]];
		c->rest[lane] = all->rest[m][point[lane]];
	}
}

RB_LANES_INLINE void store(const struct sum *sum, int count, double *to)
{
	for (int lane = 0; lane < RB_LANES && lane < count; lane++)
		to[lane] = sum->value[lane] + sum->rest[lane];
}

/*
 * Four points, of which `count` are asked for, to acceleration[3][first ..]. Coordinates are
 * written out, so that sums stay in registers.
 */
RB_LANES_INLINE void run_four(const struct rb_attract *all, const int point[RB_LANES], int count,
                              double *const acceleration[3], int first)
{
	const double *const px = all->x[0], *const py = all->x[1], *const pz = all->x[2];
	const double *const rx = all->rest[0], *const ry = all->rest[1], *const rz = all->rest[2];
	const double *const mu = all->mu, softening2 = all->softening2;
	struct coordinate x, y, z;
	struct sum sx = {0}, sy = {0}, sz = {0};

	load(all, 0, point, &x);
	load(all, 1, point, &y);
	load(all, 2, point, &z);
	for (int j = 0; j < all->count; j++) {
		const rb_lanes dx = (px[j] - x.x) + (rx[j] - x.rest);
		const rb_lanes dy = (py[j] - y.x) + (ry[j] - y.rest);
		const rb_lanes dz = (pz[j] - z.x) + (rz[j] - z.rest);
		const rb_lanes square = dx * dx + dy * dy + dz * dz;
		/* the point itself, and what is at the same place: no force */
		const rb_lanes_mask distinct = (rb_lanes_mask)(square > 0);
		const rb_lanes soft = square + softening2;
		rb_lanes distance;

		rb_lanes_root(&soft, &distance);
		const rb_lanes all_factor = mu[j] / (soft * distance);
		const rb_lanes factor = (rb_lanes)((rb_lanes_mask)all_factor & distinct);
		const rb_lanes ax = factor * dx, ay = factor * dy, az = factor * dz;

		add(&sx, &ax);
		add(&sy, &ay);
		add(&sz, &az);
	}
	store(&sx, count, acceleration[0] + first);
	store(&sy, count, acceleration[1] + first);
	store(&sz, count, acceleration[2] + first);
}

/* Points listed, or without a list from `first` on, to acceleration[3][first ..]. */
RB_LANES_INLINE void run(const struct rb_attract *all, const int *list, int first, int count,
                         double *const acceleration[3])
{
	for (int k = 0; k < count; k += RB_LANES) {
		int point[RB_LANES];

		for (int lane = 0; lane < RB_LANES; lane++) {
			/* the last one fills up what is left of the lanes */
			const int at = k + lane < count ? k + lane : count - 1;

			point[lane] = list ? list[at] : first + at;
		}
		run_four(all, point, count - k, acceleration, first + k);
	}
}

RB_LANES_AVX2 static void run_avx2(const struct rb_attract *all, const int *list, int first,
                                   int count, double *const acceleration[3])
{
	run(all, list, first, count, acceleration);
}

static void run_any(const struct rb_attract *all, const int *list, int first, int count,
                    double *const acceleration[3])
{
	RB_ASSERT(all->softening2 >= 0);
	if (rb_lanes_avx2())
		run_avx2(all, list, first, count, acceleration);
	else
		run(all, list, first, count, acceleration);
}

void rb_attract_some(const struct rb_attract *all, int first, int end,
                     double *const acceleration[3])
{
	RB_ASSERT(first >= 0 && end <= all->count);
	run_any(all, NULL, first, end - first, acceleration);
}

void rb_attract_listed(const struct rb_attract *all, const int *list, int count,
                       double *const acceleration[3])
{
	run_any(all, list, 0, count, acceleration);
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
