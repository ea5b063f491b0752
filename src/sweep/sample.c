/* SPDX-License-Identifier: MIT */
/*
 * Both the permutations and the positions within the parts come from the counter-based generator of
 * math/random: any value can be computed from the seed and its place alone, so a sweep on several
 * machines draws the same sample without sharing a state.
 */
#include "sweep/sample.h"

#include "base/error.h"
#include "base/memory.h"
#include "math/random.h"

/*
 * Streams of the generator: 0 for the seeds of runs; for each axis 2 axis + 1 for its permutation
 * and 2 axis + 2 for the positions within parts.
 */
enum { SEEDS, PARTS, WITHIN };

static uint64_t stream_of(int axis, int which)
{
	return (uint64_t)(2 * axis + which);
}

enum rb_status rb_sample_init(struct rb_sample *sample, uint64_t seed, uint64_t count,
                              int axis_count, struct rb_error *err)
{
	RB_ASSERT(count > 0 && count <= UINT32_MAX);
	RB_ASSERT(axis_count >= 0);
	*sample = (struct rb_sample){.seed = seed, .count = count};
	sample->part = rb_memory_take((size_t)count * (size_t)axis_count, sizeof *sample->part);
	if (!sample->part)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot draw a sample of %llu points: out of memory",
		               (unsigned long long)count);
	for (int axis = 0; axis < axis_count; axis++) {
		uint32_t *const part = sample->part + (uint64_t)axis * count;
		/* Durstenfeld's shuffle (Algorithm 235, 1964), from the front */
		for (uint64_t i = 0; i < count; i++) {
			const uint64_t bits = rb_random_bits(seed, stream_of(axis, PARTS), i) >> 32;
			/*
			 * multiplication by the range instead of a remainder; bias below (i + 1) /
			 * 2^32
			 */
			const uint64_t other = bits * (i + 1) >> 32;
			part[i] = part[other];
			part[other] = (uint32_t)i;
		}
	}
	return RB_OK;
}

void rb_sample_release(struct rb_sample *sample)
{
	rb_memory_free(sample->part);
	*sample = (struct rb_sample){0};
}

double rb_sample_unit(const struct rb_sample *sample, int axis, uint64_t point)
{
	const double part = sample->part[(uint64_t)axis * sample->count + point];
	const double unit = (part + rb_random_unit(sample->seed, stream_of(axis, WITHIN), point)) /
	                    (double)sample->count;

	RB_ASSERT(axis >= 0 && point < sample->count);
	/* rounding may reach the next part, and 1 */
	const double below = (part + 1) / (double)sample->count * (1 - 0x1p-52);
	return unit < below ? unit : below;
}

uint64_t rb_sample_seed(uint64_t base, uint64_t index)
{
	/* without the top bit, so that it fits int64_t, as recordings and Lua store it */
	return rb_random_bits(base, SEEDS, index) >> 1;
}
