/* SPDX-License-Identifier: MIT */
#include "stepped/find_points.h"

#include "base/memory.h"
#include "stepped/clearance.h"
#include "stepped/flush_surfaces.h"
#include "stepped/step_closing.h"

/* Cheap upper bound of the approach of a pair in the step, m; not for driven bodies. */
static double closing_bound(const struct rb_inspection *inspection, struct rb_pair pair)
{
	const double closing = rb_step_closing_bound(inspection->world, inspection->candidates,
	                                             pair);

	return closing < inspection->max ? closing : inspection->max;
}

/* Whether a pair may touch by that bound. */
static bool may_touch(const struct rb_inspection *inspection, struct rb_pair pair, double path)
{
	const struct rb_candidates *candidates = inspection->candidates;
	const struct rb_model *model = inspection->world->model;

	/* the bound does not hold for driven bodies, which may rotate */
	if (pair.b < model->body_count && model->driven && model->driven[pair.b])
		return true;
	return !rb_clearance_is_more(candidates, inspection->pair, path,
	                             closing_bound(inspection, pair));
}

/* ---- all pairs, by blocks ---- */

/*
 * Cost of a pair of spheres, and of a part of one body among those of another, in multiplications.
 */
enum { PAIR_WORK = 1 << 8, PART_WORK = 1 << 11 };

struct inspections {
	struct rb_inspection inspection; /* initial state of each block */
	struct rb_world *world;
	int first;                   /* first block of the wave */
	struct rb_inspection *block; /* [BLOCKS_PER_WAVE] results */
	bool borders;                /* of any */
};

/*
 * Blocks that are inspected before their points are gathered: enough for any number of workers, few
 * enough that points are not stored twice.
 */
enum { BLOCKS_PER_WAVE = 32 };

/* Counts the work of a pair with body `a`; true: the run is interrupted. */
static bool is_interrupted(const struct inspections *inspections, int a)
{
	const int parts = rb_candidates_part_count(inspections->inspection.candidates, a);

	return rb_interrupt_after(&inspections->world->interrupt, PART_WORK * (uint64_t)parts);
}

/*
 * Final index of a block's first point, if it is known and no copy is needed: for the first block,
 * and with one worker, who takes blocks in order. Else SIZE_MAX.
 */
static size_t place_of(const struct inspections *inspections, int block)
{
	size_t place = inspections->inspection.points->count;

	if (block > 0 && rb_team_workers(inspections->world->team) > 1)
		return SIZE_MAX;
	for (int b = 0; b < block; b++)
		place += inspections->block[b].all;
	return place;
}

static void inspect_block(void *user, int block, int worker)
{
	const struct inspections *inspections = user;
	struct rb_inspection inspection = inspections->inspection;
	struct rb_candidates *const candidates = inspection.candidates;
	const size_t first = (size_t)(inspections->first + block) * RB_PAIRS_PER_BLOCK,
		     end = rb_pairs_end(rb_candidates_live_count(candidates), first);

	const double max = inspection.max;
	const bool glances = candidates->clearance && !inspection.world->model->driven;
	inspection.arena = &inspection.world->arena[worker];
	const size_t place = place_of(inspections, block);
	if (place < inspection.points->capacity) {
		inspection.out = inspection.points->row + place;
		inspection.capacity = inspection.points->capacity - place;
		inspection.in_place = true;
	}
	bool more = !rb_interrupt_after(&inspections->world->interrupt, PAIR_WORK * (end - first));
	for (size_t at = first; at < end && more && !inspection.failed; at++) {
		const size_t k = rb_candidates_live(candidates, at);
		const struct rb_pair pair = candidates->pair[k];

		/* true for most pairs */
		if (glances &&
		    rb_clearance_was_more(candidates, k, rb_clearance_path(candidates, pair),
		                          closing_bound(&inspection, pair)))
			continue;
		inspection.pair = k;
		if (rb_pair_is_plain(inspection.world->model, pair.a, pair.b)) {
			rb_inspect_ball(
				&inspection, pair,
				rb_clearance_min(max, rb_step_closing_of_balls(inspection.world,
			                                                       candidates, pair)));
			continue;
		}
		const double path = rb_clearance_path(candidates, pair);
		rb_clearance_prefetch(candidates, k);
		if (!may_touch(&inspection, pair, path))
			continue;
		const double slack = rb_clearance_min(
			max, rb_step_closing_of(inspection.world, candidates, pair, inspection.h));
		candidates->clearance[k] = path +
		                           rb_inspect_parts(&inspection, pair, slack,
		                                            rb_candidates_caches(candidates, k));
		more = !is_interrupted(inspections, pair.a);
	}
	inspections->block[block] = inspection;
}

static void gather_block(void *user, int block, int worker)
{
	const struct inspections *inspections = user;
	const struct rb_inspection *inspection = &inspections->block[block];

	(void)worker;
	rb_inspection_gather(inspection, inspection->points->row + inspection->place);
}

/* Adds points of a wave of blocks; resets the arenas to `mark`. */
static enum rb_status add_wave(struct rb_step_points *points, struct inspections *inspections,
                               int blocks, const rb_arena_mark *mark, struct rb_error *err)
{
	struct rb_world *world = inspections->world;
	size_t count = points->count;
	bool good = true;
	enum rb_status status = RB_OK;

	inspections->block = rb_arena_take(&world->arena[0], (size_t)blocks,
	                                   sizeof *inspections->block);
	if (!inspections->block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	rb_team_run(world->team, blocks, inspect_block, inspections);
	for (int b = 0; b < blocks; b++) {
		inspections->block[b].place = count;
		count += inspections->block[b].all;
		good = good && !inspections->block[b].failed;
		inspections->borders = inspections->borders || inspections->block[b].borders;
	}
	if (rb_interrupt_is_set(&world->interrupt))
		status = RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	else if (!good ||
	         !rb_memory_reserve(&points->row, &points->capacity, count, sizeof *points->row))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	if (status == RB_OK) {
		rb_team_run(world->team, blocks, gather_block, inspections);
		points->count = count;
	}
	for (int k = 0; k < world->worker_count; k++)
		rb_arena_back(&world->arena[k], mark[k]);
	return status;
}

enum rb_status rb_step_points_add(struct rb_step_points *points, struct rb_world *world,
                                  struct rb_candidates *candidates, double h, double max,
                                  struct rb_error *err)
{
	const int blocks = rb_pairs_blocks(rb_candidates_live_count(candidates));
	const struct rb_inspection each = {.world = world,
	                                   .points = points,
	                                   .candidates = candidates,
	                                   .h = h,
	                                   .max = max,
	                                   .arena = &world->arena[0]};
	struct inspections inspections = {.inspection = each, .world = world};
	const size_t before = points->count;
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	rb_arena_mark *mark = rb_arena_take(&world->arena[0], (size_t)world->worker_count,
	                                    sizeof *mark);
	enum rb_status status = RB_OK;

	if (!mark)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	for (int k = 0; k < world->worker_count; k++)
		mark[k] = rb_arena_here(&world->arena[k]);
	for (int first = 0; first < blocks && status == RB_OK; first += BLOCKS_PER_WAVE) {
		const int left = blocks - first;

		inspections.first = first;
		status = add_wave(points, &inspections,
		                  left < BLOCKS_PER_WAVE ? left : BLOCKS_PER_WAVE, mark, err);
	}
	rb_arena_back(&world->arena[0], here);
	if (status == RB_OK && inspections.borders && !rb_flush_surfaces(points, before, &each))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	return status;
}
