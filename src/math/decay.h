/* SPDX-License-Identifier: MIT */
/*
 * Motion x'' = g - k x' with constant g and k >= 0: linear drag. With z = k s,
 *
 *     v(s) = v_0 e^-z + s f_1(z) g             f_1(z) = (1 - e^-z) / z
 *     x(s) = x_0 + s f_1(z) v_0 + s^2 f_2(z) g f_2(z) = (1 - f_1(z)) / z,  f_3(z) = (1/2 - f_2) / z
 *
 * each from a sum without cancellation. Bodies with the same k and g move relative to each other on
 * straight lines, uniformly in tau = s f_1(z).
 */
#ifndef RB_MATH_DECAY_H
#define RB_MATH_DECAY_H

#include <math.h>

#include "math/vec3.h"

/* e^-z, f_1, f_2 and f_3: they are 1, 1, 1/2 and 1/6 at z = 0. */
struct rb_decay {
	double left, once, twice, thrice;
};

struct rb_decay rb_decay_at(double z);

/* x(s) - x_0 and v(s). */
rb_vec3 rb_decay_way(double k, double s, rb_vec3 v, rb_vec3 g);
rb_vec3 rb_decay_velocity(double k, double s, rb_vec3 v, rb_vec3 g);

/* Time at which tau = s f_1(k s) has this value, s; INFINITY: never. tau >= 0. */
static inline double rb_decay_time(double k, double tau)
{
	return k * tau < 1 ? -log1p(-k * tau) / k : HUGE_VAL;
}

/*
 * Returns the first s in (0, max] at which x(s) has fallen to zero, from x_0 > 0 or from 0 with v_0
 * > 0, possibly short of it by rounding; INFINITY: none. k > 0.
 */
double rb_decay_falls(double k, double x, double v, double g, double max);

#endif
