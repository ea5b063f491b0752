/* SPDX-License-Identifier: MIT */
/* Value types of the mathematics: copied by assignment, SI units, right-handed axes. */
#ifndef RBSIM_MATH_H
#define RBSIM_MATH_H

typedef struct {
	double x, y, z;
} rb_vec3;

/* Unit quaternion of a rotation, scalar first: p_world = q p_local q*. */
typedef struct {
	double w, x, y, z;
} rb_quat;

/* Rows first: m[row][column]. */
typedef struct {
	double m[3][3];
} rb_mat3;

typedef struct {
	rb_vec3 low, high;
} rb_aabb;

#endif
