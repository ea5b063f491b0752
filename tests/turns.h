/* SPDX-License-Identifier: MIT */
/* Vectors and rotations at random, by number, for the tests of math. */
#ifndef RB_TESTS_TURNS_H
#define RB_TESTS_TURNS_H

#include "support.h"

#include "math/quat.h"
#include "math/random.h"

static inline double between(double low, double high, uint64_t stream, uint64_t index)
{
	return low + (high - low) * rb_random_unit(1, stream, index);
}

static inline rb_vec3 some_vector(uint64_t index)
{
	return rb_vec3_of(between(-2, 2, 10, index), between(-2, 2, 11, index),
	                  between(-2, 2, 12, index));
}

static inline rb_quat some_rotation(uint64_t index)
{
	return rb_quat_unit((rb_quat){between(-1, 1, 20, index), between(-1, 1, 21, index),
	                              between(-1, 1, 22, index), between(-1, 1, 23, index)});
}

static inline void assert_same_vector(rb_vec3 a, rb_vec3 b, double tol)
{
	assert_near(a.x, b.x, tol);
	assert_near(a.y, b.y, tol);
	assert_near(a.z, b.z, tol);
}

#endif
