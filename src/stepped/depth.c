/* SPDX-License-Identifier: MIT */
/*
 * Penetration depths of the candidate pairs, in parallel blocks of pairs with one result per block;
 * blocks are joined in order, so that the result does not depend on the number of threads.
 *
 * Most pairs need no measurement. Only the maximum is reported, so a pair whose depth is provably
 * below the largest so far in its block gets the bound -least instead of a number; spheres are
 * compared by squares, and convex parts by the cached separating axis before GJK/EPA
 * (stepped/clearance). A negative entry in `depth` is such a bound, NAN requires a measurement.
 */
#include "stepped/depth.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "step/gap.h"
#include "stepped/clearance.h"

/* Input that workers share, read only, and results by block. */
struct depths {
	struct rb_world *world;
	struct rb_candidates *candidates; /* `depth` of a block's pairs is written by its worker */
	const unsigned char *skip, *moved;
	bool all; /* all pairs, not only live ones */
	double limit;
	struct rb_depths *block;
};

/*
 * Factor on a squared distance, 16 ulp, that covers the rounding of the squares and of the root
 * which is not taken.
 */
static const double rounding = 1 + 16 * DBL_EPSILON;

/* Cost of a pair, in multiplications. */
enum { PAIR_WORK = 1 << 10 };

/*
 * Depth in m of the deepest pair of convex parts; if that is provably at most `least` > 0, usually
 * -least. Updates the caches and the clearance of the pair, which spares the test while both bodies
 * move less than that.
 */
static double depth_of_parts(const struct rb_model *model, struct rb_candidates *candidates,
                             size_t k, double path, double least)
{
	const struct rb_pair pair = candidates->pair[k];
	struct rb_axis_cache *const caches = rb_candidates_caches(candidates, k);
	const int a = candidates->first_part[pair.a], b = candidates->first_part[pair.b];
	const int count_a = rb_candidates_part_count(candidates, pair.a);
	const int count_b = rb_candidates_part_count(candidates, pair.b);
	const struct rb_placings placings = rb_placings_of(candidates, pair);
	double depth = 0;
	double least_clearance = (double)INFINITY;
	bool bounded = false;

	/* NaN: of an attempt that fails, or came after one: it proves nothing apart */
	RB_ASSERT_COSTLY(!(path < 0) && pair.a != pair.b);
	for (int i = 0; i < count_a; i++) {
		const rb_placed *const pa = &candidates->placed[a + i];
		struct rb_near_parts near;
		int j;

		rb_candidates_near(&near, model, pair.b, pa, 0);
		/* parts that were not visited are at least so far away */
		if (near.far)
			least_clearance = rb_clearance_min(least_clearance, 0);
		while ((j = rb_near_parts_next(&near)) >= 0) {
			const rb_placed *const pb = &candidates->placed[b + j];
			struct rb_axis_cache none = {0};
			struct rb_axis_cache *const cache = near.far ? &none
			                                             : &caches[i * count_b + j];

			double clearance = rb_clearance_of_spheres(pa, pb, 0);
			const struct rb_part_pair parts = rb_part_pair_of(pa, pb);

			if (!(clearance > 0) && !rb_axis_cache_knows(cache, placings))
				clearance = rb_clearance_of_parts(
					&parts, -rb_clearance_max(depth, least), cache);
			if (clearance > -rb_clearance_max(depth, least)) {
				least_clearance = rb_clearance_min(least_clearance, clearance);
				bounded = bounded || (clearance < 0 && least > depth);
				continue;
			}
			const rb_separation s = rb_clearance_separation(&parts, placings, cache);
			depth = rb_clearance_max(depth, parts.radii - s.gap);
			least_clearance = rb_clearance_min(least_clearance,
			                                   s.gap - s.noise - parts.radii);
		}
	}
	candidates->clearance[k] = path + least_clearance;
	return bounded && depth < least ? -least : depth;
}

/* Depth of any pair in m; a negative value is a bound, as above. */
static double depth_of(const struct rb_world *world, struct rb_candidates *candidates, size_t k,
                       double least)
{
	const struct rb_model *model = world->model;
	const struct rb_pair pair = candidates->pair[k];

	if (!rb_pair_is_plain(model, pair.a, pair.b)) {
		const double path = rb_clearance_path(candidates, pair);

		rb_clearance_prefetch(candidates, k);
		if (rb_clearance_is_more(candidates, k, path, 0))
			return 0;
		/* its depth was at most `least` before, and it has hardly moved */
		if (least > 0 && rb_clearance_is_more(candidates, k, path, -least))
			return -least;
		return depth_of_parts(model, candidates, k, path, least);
	}
	if (model->shape[pair.b].kind == RB_SHAPE_SPHERE) {
		const rb_vec3 d = rb_vec3_sub(rb_world_origin_at(world, &world->state, pair.b),
		                              rb_world_origin_at(world, &world->state, pair.a));
		const double sum = model->shape[pair.a].radius + model->shape[pair.b].radius;
		const double square = rb_vec3_dot(d, d), deep = fmax(0, sum - least);

		if (square > sum * sum)
			return 0;
		if (square > rounding * deep * deep)
			return -least;
	}
	return fmax(0, -rb_gap_of(world, &world->state, pair.a, pair.b).gap);
}

/* Appends to an array in the worker's arena; grows by doubling, the old copy stays in the arena. */
static void add_deep(struct rb_depths *depths, struct rb_arena *arena, struct rb_deep deep)
{
	RB_ASSERT_COSTLY(deep.a >= 0 && deep.b >= 0 && deep.depth > 0);
	if (depths->deep_count == depths->deep_capacity) {
		const size_t capacity = depths->deep_capacity ? 2 * depths->deep_capacity : 16;
		struct rb_deep *more = rb_arena_take(arena, capacity, sizeof *more);

		if (!more) {
			depths->failed = true;
			return;
		}
		if (depths->deep_count > 0)
			memcpy(more, depths->deep, depths->deep_count * sizeof *more);
		depths->deep = more;
		depths->deep_capacity = capacity;
	}
	depths->deep[depths->deep_count++] = deep;
}

/* Index of the first live pair that is not before `pair` (binary search). */
static size_t first_live(const struct rb_candidates *candidates, size_t pair)
{
	size_t low = 0, high = candidates->live ? candidates->live_count : 0;

	while (low < high) {
		const size_t middle = low + (high - low) / 2;

		if (candidates->live[middle] < pair)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* Whether a body of the pair has a mark; statics have none. */
static bool is_marked(const struct rb_world *world, const unsigned char *mark, struct rb_pair pair)
{
	return mark && (mark[pair.a] || (pair.b < world->model->body_count && mark[pair.b]));
}

/* The largest number of 32 bits that is not larger. */
static double rounded_down(double depth)
{
	const float near = (float)depth;
	const float down = (double)near > depth ? near * (1 - FLT_EPSILON) : near;

	RB_ASSERT_COSTLY(depth >= 0);
	return down >= FLT_MIN ? (double)down : 0;
}

/*
 * A depth in half of the bytes. Most are bounds, which 32 bits hold; of the others below the limit
 * a bound is kept, and those beyond it are measured again.
 */
static float kept_of(double depth, double limit)
{
	const float near = (float)depth;

	if ((double)near == depth)
		return near;
	if (!(depth <= limit))
		return NAN;
	return near >= FLT_MIN ? -near * (1 + FLT_EPSILON) : -FLT_MIN;
}

/* Depths of one block of pairs: maxima, and the list of those beyond the tolerance. */
static void depth_block(void *user, int block, int worker)
{
	const struct depths *work = user;
	struct rb_candidates *candidates = work->candidates;
	const size_t first = (size_t)block * RB_PAIRS_PER_BLOCK;
	const size_t end = rb_pairs_end(
		work->all ? candidates->pair_count : rb_candidates_live_count(candidates), first);
	size_t live = work->all ? first_live(candidates, first) : 0;
	struct rb_depths depths = {0};
	/* all pairs are measured: those known to be apart need nothing else */
	const bool whole = candidates->clearance && !work->skip && !work->moved && !work->all;

	const bool more = !rb_interrupt_after(&work->world->interrupt, PAIR_WORK * (end - first));
	for (size_t at = first; at < end && more; at++) {
		const size_t k = work->all || !candidates->live ? at : candidates->live[at];
		const struct rb_pair pair = candidates->pair[k];

		if (whole &&
		    rb_clearance_was_more(candidates, k, rb_clearance_path(candidates, pair), 0)) {
			candidates->depth[k] = 0;
			continue;
		}
		const bool is_live = !work->all || !candidates->live ||
		                     (live < candidates->live_count && candidates->live[live] == k);

		live += is_live;
		if (is_marked(work->world, work->skip, pair)) {
			candidates->depth[k] = NAN;
			continue;
		}
		/* only maxima are reported: below them a bound suffices, which can be kept */
		const double least = rounded_down(is_live ? depths.max : depths.resting);
		const bool due = work->moved ? is_marked(work->world, work->moved, pair) : is_live;

		double depth = (double)candidates->depth[k];

		/* written so that NaN is measured */
		if (due || !(depth >= -least)) {
			depth = depth_of(work->world, candidates, k, least);
			candidates->depth[k] = kept_of(depth, work->limit);
		}

		if (depth > work->limit)
			add_deep(&depths, &work->world->arena[worker],
			         (struct rb_deep){pair.a, pair.b, depth});
		else if (depth > depths.max)
			depths.max = depth;
		if (!is_live)
			depths.resting = rb_clearance_max(depths.resting, depth);
	}
	work->block[block] = depths;
}

enum rb_status rb_depths_find(struct rb_world *world, struct rb_candidates *candidates,
                              const unsigned char *skip, const unsigned char *moved,
                              struct rb_depths *found, struct rb_error *err)
{
	struct depths work = {.world = world,
	                      .candidates = candidates,
	                      .skip = skip,
	                      .moved = moved,
	                      .all = moved || isnan(candidates->resting_depth),
	                      .limit = world->model->stepped_tolerance_m};
	const int blocks = rb_pairs_blocks(work.all ? candidates->pair_count
	                                            : rb_candidates_live_count(candidates));

	*found = (struct rb_depths){0};
	work.block = rb_arena_take(&world->arena[0], (size_t)blocks + 1, sizeof *work.block);
	if (!work.block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	rb_team_run(world->team, blocks, depth_block, &work);
	if (rb_interrupt_is_set(&world->interrupt))
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	for (int b = 0; b < blocks; b++) {
		found->failed = found->failed || work.block[b].failed;
		found->max = fmax(found->max, work.block[b].max);
		found->resting = fmax(found->resting, work.block[b].resting);
		for (size_t k = 0; k < work.block[b].deep_count; k++)
			add_deep(found, &world->arena[0], work.block[b].deep[k]);
	}
	if (work.all)
		candidates->resting_depth = found->resting;
	found->max = fmax(found->max, candidates->resting_depth);
	return found->failed ? RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step")
	                     : RB_OK;
}
