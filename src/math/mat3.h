/* SPDX-License-Identifier: MIT */
/* 3x3 matrices, rows first. */
#ifndef RB_MATH_MAT3_H
#define RB_MATH_MAT3_H

#include "math/vec3.h"

static inline rb_mat3 rb_mat3_diagonal(double x, double y, double z)
{
	return (rb_mat3){{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
}

static inline rb_vec3 rb_mat3_apply(const rb_mat3 *a, rb_vec3 v)
{
	return (rb_vec3){a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
	                 a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
	                 a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z};
}

/* Transpose times v. */
static inline rb_vec3 rb_mat3_apply_transposed(const rb_mat3 *a, rb_vec3 v)
{
	return (rb_vec3){a->m[0][0] * v.x + a->m[1][0] * v.y + a->m[2][0] * v.z,
	                 a->m[0][1] * v.x + a->m[1][1] * v.y + a->m[2][1] * v.z,
	                 a->m[0][2] * v.x + a->m[1][2] * v.y + a->m[2][2] * v.z};
}

static inline rb_mat3 rb_mat3_multiply(const rb_mat3 *a, const rb_mat3 *b)
{
	rb_mat3 c;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] +
			            a->m[i][2] * b->m[2][j];
	return c;
}

static inline rb_mat3 rb_mat3_transposed(const rb_mat3 *a)
{
	rb_mat3 t;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			t.m[i][j] = a->m[j][i];
	return t;
}

/*
 * By cofactors, after scaling to unit size; false (and `inverse` zero) where it is singular or not
 * finite.
 */
static inline bool rb_mat3_inverse(const rb_mat3 *a, rb_mat3 *inverse)
{
	double largest = 0;

	*inverse = (rb_mat3){{{0}}};
	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(a->m[i / 3][i % 3]));
	if (!(largest > 0) || !isfinite(largest))
		return false;
	rb_vec3 r[3];
	for (int i = 0; i < 3; i++)
		r[i] = (rb_vec3){a->m[i][0] / largest, a->m[i][1] / largest, a->m[i][2] / largest};
	const rb_vec3 c0 = rb_vec3_cross(r[1], r[2]);
	const rb_vec3 c1 = rb_vec3_cross(r[2], r[0]);
	const rb_vec3 c2 = rb_vec3_cross(r[0], r[1]);
	const double determinant = rb_vec3_dot(r[0], c0);
	if (determinant == 0 || !isfinite(determinant))
		return false;
	const double s = 1 / (determinant * largest);
	*inverse = (rb_mat3){{{s * c0.x, s * c1.x, s * c2.x},
	                      {s * c0.y, s * c1.y, s * c2.y},
	                      {s * c0.z, s * c1.z, s * c2.z}}};
	return true;
}

#endif
