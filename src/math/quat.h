/* SPDX-License-Identifier: MIT */
/* Unit quaternions as rotations, scalar first. */
#ifndef RB_MATH_QUAT_H
#define RB_MATH_QUAT_H

#include "math/mat3.h"

static const rb_quat rb_quat_identity = {1, 0, 0, 0};

static inline rb_quat rb_quat_from(const double *p)
{
	return (rb_quat){p[0], p[1], p[2], p[3]};
}

static inline void rb_quat_to(double *p, rb_quat q)
{
	p[0] = q.w;
	p[1] = q.x;
	p[2] = q.y;
	p[3] = q.z;
}

static inline rb_quat rb_quat_multiply(rb_quat a, rb_quat b)
{
	return (rb_quat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
	                 a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
	                 a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
	                 a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

static inline double rb_quat_length(rb_quat q)
{
	return sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

static inline rb_quat rb_quat_unit(rb_quat q)
{
	const double length = rb_quat_length(q);

	return (rb_quat){q.w / length, q.x / length, q.y / length, q.z / length};
}

/* The rotation by |turn| radians about `turn`. */
static inline rb_quat rb_quat_from_turn(rb_vec3 turn)
{
	const double angle = rb_vec3_length(turn);
	/* sin(angle/2)/angle by its series where the division would lose digits */
	const double s = angle < 1e-4 ? 0.5 - angle * angle / 48 : sin(0.5 * angle) / angle;

	return (rb_quat){cos(0.5 * angle), s * turn.x, s * turn.y, s * turn.z};
}

/* Turned further by a rotation vector in world axes, rad; of unit length. */
static inline rb_quat rb_quat_turned(rb_quat q, rb_vec3 turn)
{
	return rb_quat_unit(rb_quat_multiply(rb_quat_from_turn(turn), q));
}

static inline rb_vec3 rb_quat_rotate(rb_quat q, rb_vec3 v)
{
	const rb_vec3 u = {q.x, q.y, q.z};
	const rb_vec3 t = rb_vec3_scale(2, rb_vec3_cross(u, v));

	return rb_vec3_add(rb_vec3_add_scaled(v, q.w, t), rb_vec3_cross(u, t));
}

static inline rb_vec3 rb_quat_rotate_back(rb_quat q, rb_vec3 v)
{
	return rb_quat_rotate((rb_quat){q.w, -q.x, -q.y, -q.z}, v);
}

static inline rb_mat3 rb_quat_to_mat3(rb_quat q)
{
	return (rb_mat3){{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z),
	                   2 * (q.x * q.z + q.w * q.y)},
	                  {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z),
	                   2 * (q.y * q.z - q.w * q.x)},
	                  {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x),
	                   1 - 2 * (q.x * q.x + q.y * q.y)}}};
}

/* From a rotation matrix; the branch with the largest denominator (Shepperd 1978). */
static inline rb_quat rb_quat_from_mat3(const rb_mat3 *r)
{
	const double xx = r->m[0][0], yy = r->m[1][1], zz = r->m[2][2];
	const double trace = xx + yy + zz;
	rb_quat q;

	if (trace >= xx && trace >= yy && trace >= zz)
		q = (rb_quat){1 + trace, r->m[2][1] - r->m[1][2], r->m[0][2] - r->m[2][0],
		              r->m[1][0] - r->m[0][1]};
	else if (xx >= yy && xx >= zz)
		q = (rb_quat){r->m[2][1] - r->m[1][2], 1 + xx - yy - zz, r->m[0][1] + r->m[1][0],
		              r->m[0][2] + r->m[2][0]};
	else if (yy >= zz)
		q = (rb_quat){r->m[0][2] - r->m[2][0], r->m[0][1] + r->m[1][0], 1 - xx + yy - zz,
		              r->m[1][2] + r->m[2][1]};
	else
		q = (rb_quat){r->m[1][0] - r->m[0][1], r->m[0][2] + r->m[2][0],
		              r->m[1][2] + r->m[2][1], 1 - xx - yy + zz};
	return rb_quat_unit(q);
}

#endif
