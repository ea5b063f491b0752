/* SPDX-License-Identifier: MIT */
/* Points and numbers from which the tests of hulls and masses build. */
#ifndef RB_TESTS_SOLIDS_H
#define RB_TESTS_SOLIDS_H

#include "math/quat.h"
#include "math/random.h"

#include <rbsim/scene.h>

/* In [low, high), the k-th of a series. */
static inline double solids_random(uint64_t series, uint64_t k, double low, double high)
{
	return low + (high - low) * rb_random_unit(20261121, series, k);
}

static inline rb_quat solids_turn(uint64_t series)
{
	const rb_vec3 turn = {solids_random(series, 1, -3, 3), solids_random(series, 2, -3, 3),
	                      solids_random(series, 3, -3, 3)};

	return rb_quat_from_turn(turn);
}

/* The eight corners of a box, turned and moved. */
static inline void solids_box(rb_vec3 points[8], const double size[3], rb_quat turn, rb_vec3 at)
{
	for (int k = 0; k < 8; k++) {
		const rb_vec3 corner = {(k & 1 ? 0.5 : -0.5) * size[0],
		                        (k & 2 ? 0.5 : -0.5) * size[1],
		                        (k & 4 ? 0.5 : -0.5) * size[2]};

		points[k] = rb_vec3_add(at, rb_quat_rotate(turn, corner));
	}
}

#endif
