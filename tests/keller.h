/* SPDX-License-Identifier: MIT */
/*
 * One impact with friction by an integration that shares nothing with the program: Keller's equations in long double,
 * from masses, moments, arms and velocities, by the Gragg-Bulirsch-Stoer method (Hairer, Norsett, Wanner, "Solving
 * Ordinary Differential Equations I", II.9) in a time t with dp = |slip| dt. Sticking and slip that sets in anew are told
 * by looking round the whole circle for a direction that keeps itself and grows.
 */
#ifndef RB_TESTS_KELLER_H
#define RB_TESTS_KELLER_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "math/quat.h"

typedef long double real;

struct keller_body {
	double inverse_mass; /* 1/kg; 0: fixed */
	double moment[3];    /* kg m^2, about the principal axes */
	rb_quat orientation; /* of those */
	rb_vec3 arm, linear, angular;
};

struct keller_impact {
	struct keller_body body[2]; /* a, b */
	rb_vec3 normal;             /* from a to b */
	double friction, restitution;
};

/* In the frame of normal and tangents. */
struct keller {
	real axis[3][3]; /* normal, two tangents */
	real k[3][3], u[3];
	real friction, restitution;
	real unit;
	/* slip (2), normal velocity, work, normal impulse, friction's impulse (2) */
	real y[7];
	real taken;
	bool compressing, over;
	int slips_ended, steps; /* what happened */
	bool stuck, jammed;
};

enum { KELLER_N = 7, KELLER_COLUMNS = 9 };

static inline real keller_dot(const real *a, const real *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void keller_cross(const real *a, const real *b, real *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void keller_unit(real *a)
{
	const real length = sqrtl(keller_dot(a, a));

	for (int i = 0; i < 3; i++)
		a[i] /= length;
}

static inline void keller_vector(rb_vec3 v, real *out)
{
	out[0] = (real)v.x;
	out[1] = (real)v.y;
	out[2] = (real)v.z;
}

/* Rows: principal axes in world coordinates. */
static inline void keller_axes(rb_quat q, real axes[3][3])
{
	const real raw[4] = {(real)q.w, (real)q.x, (real)q.y, (real)q.z};
	const real length = sqrtl(raw[0] * raw[0] + raw[1] * raw[1] + raw[2] * raw[2] +
	                          raw[3] * raw[3]);
	const real w = raw[0] / length, x = raw[1] / length, y = raw[2] / length,
		   z = raw[3] / length;
	const real rows[3][3] = {
		{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
		{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
		{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};

	memcpy(axes, rows, sizeof rows);
}

/* Change of velocity of the body's point by an impulse on it there. */
static inline void keller_answer(const struct keller_body *body, const real *impulse, real *out)
{
	real axes[3][3], arm[3], torque[3], turn[3] = {0, 0, 0};

	for (int i = 0; i < 3; i++)
		out[i] = (real)body->inverse_mass * impulse[i];
	if (!(body->inverse_mass > 0))
		return;
	keller_axes(body->orientation, axes);
	keller_vector(body->arm, arm);
	keller_cross(arm, impulse, torque);
	for (int k = 0; k < 3; k++) {
		const real own = keller_dot(axes[k], torque) / (real)body->moment[k];

		for (int i = 0; i < 3; i++)
			turn[i] += own * axes[k][i];
	}
	real moved[3];
	keller_cross(turn, arm, moved);
	for (int i = 0; i < 3; i++)
		out[i] += moved[i];
}

static inline void keller_begin(struct keller *p, const struct keller_impact *impact)
{
	real velocity[3] = {0, 0, 0};

	*p = (struct keller){.friction = (real)impact->friction,
	                     .restitution = (real)impact->restitution};
	keller_vector(impact->normal, p->axis[0]);
	keller_unit(p->axis[0]);
	const real helper[2][3] = {{1, 0, 0}, {0, 1, 0}};
	keller_cross(p->axis[0], helper[fabsl(p->axis[0][0]) > 0.7L], p->axis[1]);
	keller_unit(p->axis[1]);
	keller_cross(p->axis[0], p->axis[1], p->axis[2]);
	for (int side = 0; side < 2; side++) {
		const struct keller_body *body = &impact->body[side];
		real arm[3], linear[3], angular[3], turned[3];

		keller_vector(body->arm, arm);
		keller_vector(body->linear, linear);
		keller_vector(body->angular, angular);
		keller_cross(angular, arm, turned);
		for (int i = 0; i < 3; i++)
			velocity[i] += (side ? 1 : -1) * (linear[i] + turned[i]);
		for (int j = 0; j < 3; j++) {
			real answer[3];

			keller_answer(body, p->axis[j], answer);
			for (int i = 0; i < 3; i++)
				p->k[i][j] += keller_dot(p->axis[i], answer);
		}
	}
	for (int i = 0; i < 3; i++)
		p->u[i] = keller_dot(p->axis[i], velocity);
	p->y[0] = p->u[1];
	p->y[1] = p->u[2];
	p->y[2] = p->u[0];
	p->unit = 1 / (fabsl(p->k[0][1]) + fabsl(p->k[0][2]) +
	               p->friction * (p->k[1][1] + p->k[2][2]) + p->k[0][0]);
	p->compressing = true;
}

static inline void keller_rates(const struct keller *p, const real *y, real *rate)
{
	const real slip = hypotl(y[0], y[1]), mu = p->friction;

	rate[0] = slip * p->k[1][0] - mu * (p->k[1][1] * y[0] + p->k[1][2] * y[1]);
	rate[1] = slip * p->k[2][0] - mu * (p->k[2][1] * y[0] + p->k[2][2] * y[1]);
	rate[2] = slip * p->k[0][0] - mu * (p->k[0][1] * y[0] + p->k[0][2] * y[1]);
	rate[3] = slip * y[2];
	rate[4] = slip;
	rate[5] = -mu * y[0];
	rate[6] = -mu * y[1];
	for (int i = 0; i < KELLER_N; i++)
		rate[i] *= p->unit;
}

/* Modified midpoint rule in n substeps. */
static inline void keller_midpoint(const struct keller *p, const real *start, real step, int n,
                                   real *out)
{
	real before[KELLER_N], now[KELLER_N], rate[KELLER_N];
	const real h = step / n;

	keller_rates(p, start, rate);
	for (int i = 0; i < KELLER_N; i++) {
		before[i] = start[i];
		now[i] = start[i] + h * rate[i];
	}
	for (int k = 1; k < n; k++) {
		keller_rates(p, now, rate);
		for (int i = 0; i < KELLER_N; i++) {
			const real next = before[i] + 2 * h * rate[i];

			before[i] = now[i];
			now[i] = next;
		}
	}
	keller_rates(p, now, rate);
	for (int i = 0; i < KELLER_N; i++)
		out[i] = (before[i] + now[i] + h * rate[i]) / 2;
}

/* By extrapolation, with an estimate of the error as a share of sizes. */
static inline real keller_try(const struct keller *p, real step, real *out)
{
	real table[KELLER_COLUMNS][KELLER_N], last[KELLER_N] = {0};
	const real slip = hypotl(p->y[0], p->y[1]), mu = p->friction;
	const real way = step * p->unit * slip;
	const real bend = way * (p->k[0][0] + mu * hypotl(p->k[0][1], p->k[0][2]));
	const real w = fabsl(p->y[2]) + bend;
	const real size[KELLER_N] = {slip,
	                             slip,
	                             w,
	                             fabsl(p->y[3]) + way * w,
	                             p->y[4] + way,
	                             mu * (p->y[4] + way),
	                             mu * (p->y[4] + way)};
	real error = 0;

	for (int k = 0; k < KELLER_COLUMNS; k++) {
		real fresh[KELLER_N];

		keller_midpoint(p, p->y, step, 2 * (k + 1), fresh);
		for (int i = 0; i < KELLER_N; i++) {
			real value = fresh[i];

			/* Neville, in squares of the substep; table[j] keeps column j of the row before */
			for (int j = 0; j < k; j++) {
				const real ratio = (real)(k + 1) / (k - j);
				const real better = value +
				                    (value - table[j][i]) / (ratio * ratio - 1);

				table[j][i] = value;
				last[i] = table[j][i];
				value = better;
			}
			table[k][i] = value;
			out[i] = value;
		}
	}
	for (int i = 0; i < KELLER_N; i++)
		error = fmaxl(error, fabsl(out[i] - last[i]) / size[i]);
	return error;
}

static inline real keller_owed(const struct keller *p)
{
	return p->restitution * p->restitution * p->taken;
}

/* > 0 beyond the end of the phase. */
static inline real keller_beyond(const struct keller *p, const real *y, bool work)
{
	if (p->compressing)
		return y[2];
	return work ? y[3] - keller_owed(p) : -y[2];
}

/* The step at which `beyond` is zero, below one at which it is more: Newton's method, or halves. */
static inline real keller_locate(struct keller *p, real step, bool work, real *out)
{
	real low = 0, high = step, t = step, before = step;

	for (int round = 0; round < 200; round++) {
		real rate[KELLER_N];

		keller_try(p, t, out);
		keller_rates(p, out, rate);
		const real off = keller_beyond(p, out, work);
		const real slope = work ? rate[3] : p->compressing ? rate[2] : -rate[2];
		*(off > 0 ? &high : &low) = t;
		real next = t - off / slope;
		if (!(next >= low && next <= high && fabsl(next - t) <= before / 2))
			next = (low + high) / 2;
		before = fabsl(next - t);
		if (before <= 2 * LDBL_EPSILON * t)
			break;
		t = next;
	}
	return t;
}

/* Does the normal acceleration change its sign, or have an extremum, between the two? */
static inline bool keller_bends(const struct keller *p, const real *from, const real *to)
{
	real rate[2][KELLER_N];

	/* a direction that keeps itself trembles by rounding */
	if (fabsl(from[0] * to[1] - from[1] * to[0]) <
	    1e-9L * hypotl(from[0], from[1]) * hypotl(to[0], to[1]))
		return false;
	keller_rates(p, from, rate[0]);
	keller_rates(p, to, rate[1]);
	return (rate[0][2] > 0) != (rate[1][2] > 0) ||
	       (from[0] * p->k[0][2] > from[1] * p->k[0][1]) !=
	               (to[0] * p->k[0][2] > to[1] * p->k[0][1]);
}

static inline void keller_turn_over(struct keller *p)
{
	if (p->compressing) {
		p->taken -= p->y[3];
		p->y[3] = 0;
		p->over = !(keller_owed(p) > 0);
	} else {
		/* drawn together again: what was given back is still counted against what is owed */
		p->taken -= p->y[3] / (p->restitution * p->restitution);
		p->y[3] = 0;
		p->jammed = true;
	}
	p->y[2] = 0;
	p->compressing = !p->compressing;
}

/* At constant rates per normal impulse, up to `most` of it. */
static inline void keller_straight(struct keller *p, real most, const real *along)
{
	const real rate = p->k[0][0] + p->k[0][1] * along[0] + p->k[0][2] * along[1];

	for (int k = 0; k < 8 && !p->over && most > 0; k++) {
		const real w = p->y[2];
		real step = most;
		int event = 0;

		if (p->compressing && rate > 0 && -w / rate < step) {
			step = -w / rate;
			event = 1;
		}
		if (!p->compressing) {
			const real rest = keller_owed(p) - p->y[3];
			const real root = w * w + 2 * rate * rest;

			if (root >= 0 && 2 * rest / (w + sqrtl(root)) < step) {
				step = 2 * rest / (w + sqrtl(root));
				event = 2;
			} else if (rate < 0 && -w / rate < step) {
				step = -w / rate;
				event = 1;
			}
		}
		p->y[3] += step * (w + rate * step / 2);
		p->y[2] += step * rate;
		p->y[4] += step;
		p->y[5] += step * along[0];
		p->y[6] += step * along[1];
		most -= step;
		if (event == 1)
			keller_turn_over(p);
		p->over = p->over || event == 2;
	}
}

/* Rate of turn (0) and of growth (1) of slip in this direction, per normal impulse. */
static inline real keller_way(const struct keller *p, real angle, int which)
{
	const real c = cosl(angle), s = sinl(angle);
	const real x = p->k[1][0] - p->friction * (p->k[1][1] * c + p->k[1][2] * s);
	const real y = p->k[2][0] - p->friction * (p->k[2][1] * c + p->k[2][2] * s);

	return which == 0 ? y * c - x * s : x * c + y * s;
}

static inline void keller_from_rest(struct keller *p)
{
	enum { LOOKS = 720 };
	const real turn = 2 * acosl(-1) / LOOKS;

	for (int k = 0; k < LOOKS; k++) {
		real low = k * turn + 0.1L, high = low + turn;
		const bool at_low = keller_way(p, low, 0) > 0;

		if (at_low == (keller_way(p, high, 0) > 0))
			continue;
		for (int round = 0; round < 80; round++) {
			const real middle = (low + high) / 2;

			*((keller_way(p, middle, 0) > 0) == at_low ? &low : &high) = middle;
		}
		if (keller_way(p, low, 1) > 0) {
			const real along[2] = {-p->friction * cosl(low), -p->friction * sinl(low)};

			keller_straight(p, HUGE_VALL, along);
			p->over = true;
			return;
		}
	}
	const real xx = p->k[1][1], yy = p->k[2][2], xy = p->k[1][2];
	const real x = -p->k[1][0], y = -p->k[2][0], determinant = xx * yy - xy * xy;
	const real along[2] = {(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant};
	p->stuck = true;
	keller_straight(p, HUGE_VALL, along);
	p->over = true;
}

/* The impulse on b; false: the integration did not come to its end. */
static inline bool keller_solve(struct keller *p, const struct keller_impact *impact, real *impulse)
{
	const real accuracy = 4096 * LDBL_EPSILON, most_turn = 0.25L;
	real step = 1;

	keller_begin(p, impact);
	const real speed = hypotl(hypotl(p->u[0], p->u[1]), p->u[2]);
	for (p->steps = 0; p->steps < 400000 && !p->over; p->steps++) {
		const real slip = hypotl(p->y[0], p->y[1]);
		real next[KELLER_N];

		if (slip < 1e-25L * speed) {
			p->slips_ended += p->steps > 0;
			keller_from_rest(p);
			break;
		}
		const real turn = fabsl(keller_way(p, atan2l(p->y[1], p->y[0]), 0)) * p->unit;
		step = fminl(fminl(step, 4), most_turn / turn);
		const real error = keller_try(p, step, next);
		if (error > accuracy && step > 1e-6L) {
			step *= fmaxl(0.3L, 0.8L * powl(accuracy / error, 1.0L / 17));
			continue;
		}
		/* what is monotone has one root: go up to where it is not, and hop over that */
		if (step > 1e-10L && keller_bends(p, p->y, next)) {
			step /= 2;
			continue;
		}
		const bool turns = p->compressing ? next[2] > 0 : next[2] < 0;
		if (turns)
			step = keller_locate(p, step, false, next);
		const bool work = !p->compressing && keller_beyond(p, next, true) > 0;
		if (work)
			keller_locate(p, step, true, next);
		memcpy(p->y, next, sizeof next);
		if (work)
			p->over = true;
		else if (turns)
			keller_turn_over(p);
		step *= 2;
	}
	for (int i = 0; i < 3; i++)
		impulse[i] = p->y[4] * p->axis[0][i] + p->y[5] * p->axis[1][i] +
		             p->y[6] * p->axis[2][i];
	return p->over;
}

#endif
