/* SPDX-License-Identifier: MIT */
/*
 * Latin hypercube samples: of N points, each of N equal parts of every axis holds exactly one
 * (McKay, Beckman and Conover, Technometrics 21, 1979). The same seed gives the same sample.
 */
#ifndef RB_SWEEP_SAMPLE_H
#define RB_SWEEP_SAMPLE_H

#include <stdint.h>

#include <rbsim/error.h>

struct rb_sample {
	uint64_t seed, count;
	uint32_t *part; /* owned: [axis][point] */
};

/* `count` below 2^32. */
RB_CHECKED enum rb_status rb_sample_init(struct rb_sample *sample, uint64_t seed, uint64_t count,
                                         int axis_count, struct rb_error *err);
void rb_sample_release(struct rb_sample *sample); /* safe on a zeroed one */

/* Where a point lies on an axis: in [0, 1). */
double rb_sample_unit(const struct rb_sample *sample, int axis, uint64_t point);

/* The seed of a run: follows from the base seed and the run's index, fits a signed integer. */
uint64_t rb_sample_seed(uint64_t base, uint64_t index);

#endif
