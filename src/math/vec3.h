/* SPDX-License-Identifier: MIT */
/* Vectors of three doubles. */
#ifndef RB_MATH_VEC3_H
#define RB_MATH_VEC3_H

#include <math.h>
#include <stdbool.h>

#include <rbsim/math.h>

static inline rb_vec3 rb_vec3_of(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

static inline rb_vec3 rb_vec3_from(const double *p)
{
	return (rb_vec3){p[0], p[1], p[2]};
}

static inline void rb_vec3_to(double *p, rb_vec3 a)
{
	p[0] = a.x;
	p[1] = a.y;
	p[2] = a.z;
}

static inline rb_vec3 rb_vec3_add(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline rb_vec3 rb_vec3_sub(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/*
 * What rounding has left out of sum = a + b (Knuth, The Art of Computer Programming 2, 4.2.2,
 * theorem B).
 */
static inline rb_vec3 rb_vec3_lost(rb_vec3 a, rb_vec3 b, rb_vec3 sum)
{
	const rb_vec3 part = rb_vec3_sub(sum, a);

	return rb_vec3_add(rb_vec3_sub(a, rb_vec3_sub(sum, part)), rb_vec3_sub(b, part));
}

static inline rb_vec3 rb_vec3_scale(double s, rb_vec3 a)
{
	return (rb_vec3){s * a.x, s * a.y, s * a.z};
}

/* a + s b */
static inline rb_vec3 rb_vec3_add_scaled(rb_vec3 a, double s, rb_vec3 b)
{
	return (rb_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline rb_vec3 rb_vec3_neg(rb_vec3 a)
{
	return (rb_vec3){-a.x, -a.y, -a.z};
}

static inline double rb_vec3_dot(rb_vec3 a, rb_vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline rb_vec3 rb_vec3_cross(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Largest absolute coordinate. */
static inline double rb_vec3_max_abs(rb_vec3 a)
{
	const double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z);
	/* as fmax, of which NaN is neither; that would be two calls */
	const double yz = y > z || isnan(z) ? y : z;

	return x > yz || isnan(yz) ? x : yz;
}

/*
 * Without overflow or underflow for any finite vector: scaled only when the plain sum leaves the
 * safe range.
 */
static inline double rb_vec3_length(rb_vec3 a)
{
	const double square = rb_vec3_dot(a, a);

	if (square > 1e-280 && square < 1e280)
		return sqrt(square);
	if (isnan(square)) /* the largest coordinate would pass over it */
		return square;
	const double largest = rb_vec3_max_abs(a);
	if (!(largest > 0) || isinf(largest))
		return largest;
	const rb_vec3 scaled = {a.x / largest, a.y / largest, a.z / largest};
	return largest * sqrt(rb_vec3_dot(scaled, scaled));
}

/* Unit vector along `a`, of any finite size; `fallback` where a is zero. */
static inline rb_vec3 rb_vec3_unit(rb_vec3 a, rb_vec3 fallback)
{
	const double square = rb_vec3_dot(a, a);

	if (!(square > 1e-280 && square < 1e280)) {
		/*
		 * The length of a tiny vector has too few digits to divide by, that of a huge one
		 * may overflow.
		 */
		const double largest = rb_vec3_max_abs(a);
		if (!(largest > 0))
			return fallback;
		a = (rb_vec3){a.x / largest, a.y / largest, a.z / largest};
	}
	const double length = sqrt(rb_vec3_dot(a, a));
	return (rb_vec3){a.x / length, a.y / length, a.z / length};
}

static inline bool rb_vec3_finite(rb_vec3 a)
{
	return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* What of `a` is across the unit vector `n`. */
static inline rb_vec3 rb_vec3_reject(rb_vec3 a, rb_vec3 n)
{
	return rb_vec3_add_scaled(a, -rb_vec3_dot(a, n), n);
}

/* A unit vector across the unit vector `a` (the coordinate axis least along it, projected). */
static inline rb_vec3 rb_vec3_across(rb_vec3 a)
{
	rb_vec3 axis = {0, 0, 1};

	if (fabs(a.x) <= fabs(a.y) && fabs(a.x) <= fabs(a.z))
		axis = (rb_vec3){1, 0, 0};
	else if (fabs(a.y) <= fabs(a.z))
		axis = (rb_vec3){0, 1, 0};
	return rb_vec3_unit(rb_vec3_add_scaled(axis, -rb_vec3_dot(axis, a), a), axis);
}

#endif
