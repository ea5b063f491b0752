/* SPDX-License-Identifier: MIT */
/*
 * Counter-based generator: number = f(seed, stream, index), no state to save and no order to keep.
 */
#ifndef RB_MATH_RANDOM_H
#define RB_MATH_RANDOM_H

#include <stdint.h>

#include "base/hash.h"

/* Two rounds of the splitmix64 finalizer over the three counters. */
static inline uint64_t rb_random_bits(uint64_t seed, uint64_t stream, uint64_t index)
{
	return rb_hash_mix(rb_hash_mix(seed + 0x9e3779b97f4a7c15u * (stream + 1)) +
	                   0x9e3779b97f4a7c15u * (index + 1));
}

/* Uniform in [0, 1), 53 bits. */
static inline double rb_random_unit(uint64_t seed, uint64_t stream, uint64_t index)
{
	return (double)(rb_random_bits(seed, stream, index) >> 11) * 0x1p-53;
}

#endif
