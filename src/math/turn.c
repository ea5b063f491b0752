/* SPDX-License-Identifier: MIT */
/*
 * q' = w q / 2 with a polynomial w: a Taylor series over parts of the way, in each of which the
 * body turns by no more than a radian. That costs a small part of what collocation of q' = f(q)
 * does, which knows nothing of its being linear. About one axis it is the angle: a ball that rolls
 * on and on may turn thousands of times within a piece.
 */
#include "math/turn.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "base/error.h"

/*
 * Over a part the spin times half the length is below 1/2, so the terms fall at least like those of
 * exp(1/2) delayed by the degree of the spin; TERMS_MAX is never reached before they are rounding.
 */
enum { POWERS = RB_GAUSS_NODES + 1, TERMS_MAX = 64 };

/* Coefficients of a polynomial with values in the pure quaternions, lowest power first. */
struct spin {
	rb_vec3 power[POWERS];
};

/* p[k][i]: coefficient of u^i in P_k(u), by Bonnet's recursion. */
static void legendre(double p[POWERS][POWERS])
{
	for (int k = 0; k < POWERS; k++)
		for (int i = 0; i < POWERS; i++)
			p[k][i] = 0;
	p[0][0] = p[1][1] = 1;
	for (int k = 1; k + 1 < POWERS; k++)
		for (int i = 0; i < POWERS; i++)
			p[k + 1][i] = ((2 * k + 1) * (i > 0 ? p[k][i - 1] : 0) - k * p[k - 1][i]) /
			              (k + 1);
}

/*
 * The spin over the piece by powers of u = 2 t / length - 1, rad/s: a coefficient of a rate in the
 * basis P_k on [0, 1] contributes its integral from 0, (P_(k+1) - P_(k-1)) / (2 (2 k + 1)).
 */
static struct spin spin_of(const struct rb_gauss_piece *piece, int first)
{
	double p[POWERS][POWERS];
	struct spin w = {.power = {rb_vec3_from(piece->start + first)}};

	legendre(p);
	for (int k = RB_GAUSS_NODES - 1; k >= 0; k--) {
		const rb_vec3 c = rb_vec3_from(piece->coefficient + (size_t)k * (size_t)piece->n +
		                               first);

		for (int i = 0; i < POWERS; i++) {
			const double before = k > 0 ? -p[k - 1][i] : i == 0;

			w.power[i] = rb_vec3_add_scaled(
				w.power[i], (p[k + 1][i] + before) / (2 * (2 * k + 1)), c);
		}
	}
	return w;
}

/*
 * The same polynomial by powers of s in [0, 1] on the part that begins at u and is `length` long in
 * u: Taylor shift by repeated synthetic division (Horner), then scaling.
 */
static struct spin part_of(const struct spin *spin, double u, double length)
{
	struct spin w = *spin;
	double scale = 1;

	for (int i = 0; i < POWERS; i++) {
		for (int j = POWERS - 2; j >= i; j--)
			w.power[j] = rb_vec3_add_scaled(w.power[j], u, w.power[j + 1]);
	}
	for (int i = 0; i < POWERS; i++, scale *= length)
		w.power[i] = rb_vec3_scale(scale, w.power[i]);
	return w;
}

/*
 * Taylor series of q' = w q in s at s = 1, where w is half the spin times the part's length: the
 * Cauchy product (k + 1) q_(k+1) = sum over j of w_j q_(k-j).
 */
static rb_quat turned(const struct spin *w, rb_quat begin)
{
	rb_quat term[TERMS_MAX] = {begin}, sum = begin;
	int small = 0;

	for (int k = 0; k + 1 < TERMS_MAX && small < POWERS; k++) {
		rb_quat next = {0, 0, 0, 0};

		for (int j = 0; j < POWERS && j <= k; j++) {
			const rb_vec3 v = w->power[j];
			const rb_quat part = rb_quat_multiply((rb_quat){0, v.x, v.y, v.z},
			                                      term[k - j]);

			next = (rb_quat){next.w + part.w, next.x + part.x, next.y + part.y,
			                 next.z + part.z};
		}
		const double share = 1.0 / (k + 1);
		term[k + 1] = (rb_quat){share * next.w, share * next.x, share * next.y,
		                        share * next.z};
		sum = (rb_quat){sum.w + term[k + 1].w, sum.x + term[k + 1].x, sum.y + term[k + 1].y,
		                sum.z + term[k + 1].z};
		/*
		 * a term depends on the POWERS terms before it: only as many small ones in a row
		 * end the series
		 */
		small = rb_quat_length(term[k + 1]) < 0x1p-6 * DBL_EPSILON ? small + 1 : 0;
	}
	return rb_quat_unit(sum);
}

/*
 * True if the spin has one axis to rounding: then turns commute and the orientation follows from
 * the integral of the spin in closed form, for any number of turns.
 */
static bool is_about_one_axis(const struct spin *w)
{
	rb_vec3 largest = {0, 0, 0};
	double all = 0, off = 0;

	for (int i = 0; i < POWERS; i++) {
		all += rb_vec3_length(w->power[i]);
		if (rb_vec3_length(w->power[i]) > rb_vec3_length(largest))
			largest = w->power[i];
	}
	const rb_vec3 axis = rb_vec3_unit(largest, largest);
	for (int i = 0; i < POWERS; i++)
		off += rb_vec3_length(rb_vec3_cross(w->power[i], axis));
	return off <= 2 * DBL_EPSILON * all;
}

/* As `turned`, for a spin about one axis: the angle is the integral of the polynomial. */
static rb_quat turned_evenly(const struct spin *w, rb_quat begin)
{
	rb_vec3 half = {0, 0, 0};

	for (int i = 0; i < POWERS; i++)
		half = rb_vec3_add_scaled(half, 1.0 / (i + 1), w->power[i]);
	return rb_quat_turned(begin, rb_vec3_scale(2, half));
}

rb_quat rb_turn_through(const struct rb_gauss_piece *piece, int spin, rb_quat orientation, double t)
{
	RB_ASSERT(spin >= 0 && spin + 3 <= piece->n);

	rb_vec3 max = {0, 0, 0};

	if (!(t > 0))
		return orientation;
	struct spin w = spin_of(piece, spin);
	for (int i = 0; i < POWERS; i++) {
		max = rb_vec3_add(
			max, (rb_vec3){fabs(w.power[i].x), fabs(w.power[i].y), fabs(w.power[i].z)});
		w.power[i] = rb_vec3_scale(0.25 * piece->length_s, w.power[i]);
	}
	/* t times the sum of |coefficients| bounds the angle: a radian at most for each part */
	const bool even = is_about_one_axis(&w);
	const double parts = even ? 1 : ceil(rb_vec3_length(max) * t) + 1;
	const double length = 2 * (t / piece->length_s) / parts;

	for (double k = 0; k < parts; k++) {
		struct spin part = part_of(&w, -1 + k * length, length);

		for (int i = 0; i < POWERS; i++)
			part.power[i] = rb_vec3_scale(length, part.power[i]);
		orientation = even ? turned_evenly(&part, orientation) : turned(&part, orientation);
	}
	return orientation;
}
