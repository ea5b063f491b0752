/* SPDX-License-Identifier: MIT */
#include "math/decay.h"

#include <float.h>

#include "base/error.h"

enum { ROUNDS_MAX = 128 };

/* sum (-z)^n / (n + 3)!; the omitted terms are below a quarter ulp: z^n 6 / (n + 3)! <= 2^-54. */
static double series(double z)
{
	static const double inverse[] = {
		1.0 / 6,
		1.0 / 24,
		1.0 / 120,
		1.0 / 720,
		1.0 / 5040,
		1.0 / 40320,
		1.0 / 362880,
		1.0 / 3628800,
		1.0 / 39916800,
		1.0 / 479001600,
		1.0 / 6227020800,
		1.0 / 87178291200,
		1.0 / 1307674368000,
		1.0 / 20922789888000,
		1.0 / 355687428096000,
		1.0 / 6402373705728000,
	};
	const int terms = z < 0x1p-16  ? 4
	                  : z < 0x1p-6 ? 8
	                               : (int)(sizeof inverse / sizeof *inverse);
	double sum = inverse[terms - 1];

	for (int n = terms - 2; n >= 0; n--)
		sum = inverse[n] - z * sum;
	return sum;
}

struct rb_decay rb_decay_at(double z)
{
	struct rb_decay d;

	if (z <= 1) {
		d.thrice = series(z);
		d.twice = 0.5 - z * d.thrice;
		d.once = 1 - z * d.twice;
		d.left = 1 - z * d.once;
		return d;
	}
	d.left = exp(-z);
	d.once = (1 - d.left) / z;
	d.twice = (1 - d.once) / z;
	d.thrice = (0.5 - d.twice) / z;
	return d;
}

rb_vec3 rb_decay_way(double k, double s, rb_vec3 v, rb_vec3 g)
{
	const struct rb_decay d = rb_decay_at(k * s);

	return rb_vec3_scale(s, rb_vec3_add_scaled(rb_vec3_scale(d.once, v), d.twice * s, g));
}

rb_vec3 rb_decay_velocity(double k, double s, rb_vec3 v, rb_vec3 g)
{
	const struct rb_decay d = rb_decay_at(k * s);

	return rb_vec3_add_scaled(rb_vec3_scale(d.left, v), d.once * s, g);
}

/* Time in which x + v t + a t^2 / 2, above zero at first, comes to zero; INFINITY: never. */
static double parabola_falls(double x, double v, double a)
{
	const double root = v * v - 2 * a * x;

	if (root < 0 || (v >= 0 && a >= 0))
		return HUGE_VAL;
	return v < 0 ? 2 * x / (sqrt(root) - v) : (v + sqrt(root)) / -a;
}

/*
 * Iterates from the left with functions that stay below the motion: where it falls faster than at
 * its final speed, its tangent; otherwise, since its acceleration decreases, the parabola with the
 * present one.
 */
double rb_decay_falls(double k, double x, double v, double g, double max)
{
	double s = 0;

	RB_ASSERT_COSTLY(k > 0 && (x > 0 || (x == 0 && v > 0)));
	for (int round = 0; round < ROUNDS_MAX; round++) {
		const struct rb_decay d = rb_decay_at(k * s);
		const double gap = x + s * (d.once * v + s * d.twice * g);
		const double rate = d.left * v + s * d.once * g;
		const double a = d.left * (g - k * v);
		const double more = parabola_falls(gap, rate, fmin(a, 0));

		if (round > 0 && gap <= 0)
			return s;
		if (!(s + more <= max))
			return HUGE_VAL;
		if (!(s + more > s))
			return s;
		s += more;
		/* each round doubles the digits */
		if (more <= 0x1p-30 * s)
			return s;
	}
	return s;
}
