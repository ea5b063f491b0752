/* SPDX-License-Identifier: MIT */
/*
 * The table is a counting sort of the boxes by bucket. Runs of RUN cells along x share one hash
 * and lie in neighbouring buckets, so that the two or three cells of a row that a query needs are
 * one stretch of memory; longer runs would let a regular line of bodies fall into few buckets.
 *
 *   row (level, iy, iz), run ix / RUN --hash--> 64-bit key --high half--> first bucket; + ix % RUN
 *
 * Different rows may share buckets; the key tells their boxes apart. Should two keys of one query
 * be equal by chance, a pair is found twice, and rb_grid_sort drops the copy.
 */
#include "geom/grid.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/team.h"

enum {
	RUN_BITS = 4,
	RUN = 1 << RUN_BITS,
	/* Fewer boxes than this are tested all against all: cheaper than any table. */
	FEW = 32,
	/* Levels are exponents of 2: cells of 2^level m. Cells finer than the lowest make no
	 * sense where coordinates could be anything, and their inverse must be finite. */
	LEVEL_LOWEST = -1000,
	LEVEL_HIGHEST = 1026,
	LEVEL_COUNT = LEVEL_HIGHEST - LEVEL_LOWEST + 1,
	/* A box's level is at least such that its cell numbers stay below 2^CELL_BITS: they then
	 * are exact integers, and rounding is far less than the margin below. */
	CELL_BITS = 40
};

/*
 * Cells. Coordinates below 2^40 cells round to 2^-13 cells; "low corner minus the largest extent"
 * rounds a few times that.
 */
static const double margin = 0x1p-10;

struct rb_grid_item {
	rb_aabb box;
	uint64_t key;
	int index;
	int rank; /* of its level among those in use */
};

struct rb_grid_place {
	uint64_t key;
	uint32_t bucket;
	int level;
};

/* Those in use, ascending. */
struct level {
	double inverse; /* 1 / cell size, 1/m */
	double reach;   /* cells that the largest box of the level covers, and the margin */
	uint64_t salt;
};

struct rb_grid_levels {
	int used;
	int lowest, highest; /* of all boxes, less LEVEL_LOWEST */
	struct level level[LEVEL_COUNT];
	int rank[LEVEL_COUNT];
	double half_max[LEVEL_COUNT]; /* m; below 0: level not in use */
};

/* What one worker has found, in any order: pairs are sorted. */
struct rb_grid_found {
	struct rb_pair *pairs; /* owned */
	size_t count, capacity;
	uint64_t tests;
	bool failed; /* memory is out */
};

struct query {
	const struct rb_grid *grid;
	const struct rb_grid_boxes *boxes;
	uint64_t mask;
	struct rb_grid_found *found;
};

enum { ITEMS_PER_BLOCK = 256 };

void rb_grid_init(struct rb_grid *grid)
{
	*grid = (struct rb_grid){0};
}

void rb_grid_release(struct rb_grid *grid)
{
	rb_memory_free(grid->pairs);
	rb_memory_free(grid->levels);
	rb_arena_release(&grid->own);
	for (int k = 0; k < grid->found_count; k++)
		rb_memory_free(grid->found[k].pairs);
	rb_memory_free(grid->found);
	*grid = (struct rb_grid){0};
}

static enum rb_status out_of_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the table of boxes");
}

/* Appends a pair, lower index first. */
static inline void emit(struct rb_grid_found *found, int a, int b)
{
	RB_ASSERT_COSTLY(a >= 0 && b >= 0 && a != b);

	if (found->count == found->capacity &&
	    !rb_memory_reserve(&found->pairs, &found->capacity, found->count + 1,
	                       sizeof *found->pairs)) {
		found->failed = true;
		return;
	}
	found->pairs[found->count++] = a < b ? (struct rb_pair){a, b} : (struct rb_pair){b, a};
}

static struct rb_grid_found begin_with(const struct rb_grid *grid)
{
	return (struct rb_grid_found){
		.pairs = grid->pairs, .count = grid->pair_count, .capacity = grid->pair_capacity};
}

/* The pairs, which may have got another place. */
static enum rb_status end_with(struct rb_grid *grid, const struct rb_grid_found *found,
                               struct rb_error *err)
{
	grid->pairs = found->pairs;
	grid->pair_count = found->count;
	grid->pair_capacity = found->capacity;
	grid->tests += found->tests;
	return found->failed ? out_of_memory(err) : RB_OK;
}

enum rb_status rb_grid_add_pair(struct rb_grid *grid, int a, int b, struct rb_error *err)
{
	struct rb_grid_found found = begin_with(grid);

	emit(&found, a, b);
	return end_with(grid, &found, err);
}

/* True if at least one of the two moves and their collision filters admit each other. */
static inline bool wanted(const struct rb_grid_boxes *boxes, int a, int b)
{
	if (a >= boxes->moving_count && b >= boxes->moving_count)
		return false;
	return !boxes->group_bit || ((boxes->collides[a] & boxes->group_bit[b]) != 0 &&
	                             (boxes->collides[b] & boxes->group_bit[a]) != 0);
}

static inline const rb_aabb *box_of(const struct rb_grid_boxes *boxes, int index)
{
	return index < boxes->moving_count ? &boxes->moving[index]
	                                   : &boxes->fixed[index - boxes->moving_count];
}

/* All against all, for few boxes: already in the order of (a, b). */
static enum rb_status find_all_pairs(struct rb_grid *grid, const struct rb_grid_boxes *boxes,
                                     struct rb_error *err)
{
	const int count = boxes->moving_count + boxes->fixed_count;
	struct rb_grid_found found = begin_with(grid);

	for (int a = 0; a < boxes->moving_count; a++) {
		const rb_aabb box = boxes->moving[a];

		for (int b = a + 1; b < count; b++)
			if (rb_aabb_overlap(&box, box_of(boxes, b)) && wanted(boxes, a, b))
				emit(&found, a, b);
		found.tests += (uint64_t)(count - a - 1);
	}
	return end_with(grid, &found, err);
}

/* Least e with x < 2^e; for 0 and subnormal x some value below LEVEL_LOWEST. */
static inline int exponent_above(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return (int)(bits >> 52 & 0x7ff) - 1022;
}

/* Largest half extent and largest |coordinate|; false where the box is not finite. */
static inline bool measure(const rb_aabb *box, double *half, double *largest)
{
	/* halves first: the difference of two finite numbers may overflow */
	const double x = 0.5 * box->high.x - 0.5 * box->low.x;
	const double y = 0.5 * box->high.y - 0.5 * box->low.y;
	const double z = 0.5 * box->high.z - 0.5 * box->low.z;
	const double ax = fabs(box->low.x) > fabs(box->high.x) ? fabs(box->low.x)
	                                                       : fabs(box->high.x);
	const double ay = fabs(box->low.y) > fabs(box->high.y) ? fabs(box->low.y)
	                                                       : fabs(box->high.y);
	const double az = fabs(box->low.z) > fabs(box->high.z) ? fabs(box->low.z)
	                                                       : fabs(box->high.z);

	*half = x > y ? x : y;
	*half = *half > z ? *half : z;
	*largest = ax > ay ? ax : ay;
	*largest = *largest > az ? *largest : az;
	/* NaN fails each of these */
	return x >= 0 && y >= 0 && z >= 0 && *largest <= DBL_MAX;
}

/* Level of each box; which levels are in use, and how large their boxes get. */
static enum rb_status choose_levels(struct rb_grid *grid, const struct rb_grid_boxes *boxes,
                                    struct rb_error *err)
{
	struct rb_grid_levels *levels = grid->levels;
	const int count = boxes->moving_count + boxes->fixed_count;

	for (int i = levels->lowest; i <= levels->highest; i++)
		levels->half_max[i] = -1;
	levels->lowest = LEVEL_COUNT;
	levels->highest = -1;
	for (int i = 0; i < count; i++) {
		double half, largest;

		if (!measure(box_of(boxes, i), &half, &largest))
			return RB_FAIL(err, RB_ERR_PHYSICS,
			               "the box of body index %d is not finite", i);
		int level = exponent_above(half) + 1; /* 2 half < 2^level */
		const int far = exponent_above(largest) - CELL_BITS;
		level = level > far ? level : far;
		level = (level > LEVEL_LOWEST ? level : LEVEL_LOWEST) - LEVEL_LOWEST;
		grid->places[i].level = level;
		levels->half_max[level] = half > levels->half_max[level] ? half
		                                                         : levels->half_max[level];
		levels->lowest = level < levels->lowest ? level : levels->lowest;
		levels->highest = level > levels->highest ? level : levels->highest;
	}
	levels->used = 0;
	for (int i = levels->lowest; i <= levels->highest; i++) {
		if (levels->half_max[i] < 0)
			continue;
		struct level *level = &levels->level[levels->used];
		level->inverse = ldexp(1, -(i + LEVEL_LOWEST));
		level->reach = ldexp(levels->half_max[i], 1 - (i + LEVEL_LOWEST)) + margin;
		level->salt = (uint64_t)i * 0x9e3779b97f4a7c15u;
		levels->rank[i] = levels->used++;
	}
	return RB_OK;
}

/* Exact below 2^CELL_BITS, and much faster than a call of floor(). */
static inline int64_t cell(double x)
{
	const int64_t i = (int64_t)x;

	return i - (x < (double)i);
}

/*
 * Hash of a row of cells along x, before mixing: odd constants of published hashes (wyhash,
 * degski's mixer), none of which rb_hash_mix multiplies by.
 */
static inline uint64_t row_salt(const struct level *level, int64_t y, int64_t z)
{
	return level->salt + (uint64_t)y * 0xd6e8feb86659fd93u + (uint64_t)z * 0xa0761d6478bd642fu;
}

static inline uint64_t run_key(uint64_t row, int64_t x)
{
	return rb_hash_mix(row + (uint64_t)(x >> RUN_BITS) * 0xe7037ed1a0b428dbu);
}

/*
 * The high half of the key selects where a run of RUN buckets begins, the cell's number within it
 * the bucket.
 */
static inline uint32_t bucket_of(uint64_t key, uint64_t mask, int64_t x)
{
	return (uint32_t)((key >> 32 & mask) + (uint64_t)(x & (RUN - 1)));
}

/* Counting sort of the boxes by bucket: start[b] .. start[b + 1] are the items of bucket b. */
static void fill_table(struct rb_grid *grid, const struct rb_grid_boxes *boxes, uint64_t mask)
{
	RB_ASSERT(((mask + 1) & mask) == 0); /* buckets are selected by a bit mask */
	const int count = boxes->moving_count + boxes->fixed_count;
	const size_t buckets = (size_t)mask + RUN;
	uint32_t *start = grid->start;

	memset(start, 0, (buckets + 1) * sizeof *start);
	for (int i = 0; i < count; i++) {
		struct rb_grid_place *place = &grid->places[i];
		const rb_vec3 low = box_of(boxes, i)->low;
		const struct level *level = &grid->levels->level[grid->levels->rank[place->level]];
		const int64_t x = cell(low.x * level->inverse);
		const int64_t y = cell(low.y * level->inverse);
		const int64_t z = cell(low.z * level->inverse);

		place->key = run_key(row_salt(level, y, z), x);
		place->bucket = bucket_of(place->key, mask, x);
		RB_ASSERT_COSTLY(place->bucket < buckets);
		start[place->bucket]++;
	}
	/*
	 * sums to the end of each bucket, then back to its start while items are put down from the
	 * last: within a bucket they keep the order of their indices
	 */
	uint32_t sum = 0;
	for (size_t b = 0; b <= buckets; b++) {
		sum += start[b];
		start[b] = sum;
	}
	for (int i = count; i-- > 0;) {
		const struct rb_grid_place *place = &grid->places[i];

		grid->items[--start[place->bucket]] = (struct rb_grid_item){
			.box = *box_of(boxes, i),
			.key = place->key,
			.index = i,
			.rank = grid->levels->rank[place->level],
		};
	}
	RB_ASSERT(start[buckets] == (uint32_t)count && start[0] == 0);
}

/* Tests `item` against those of items[from .. to) that have the key. */
static void scan(struct query *query, const struct rb_grid_item *item, uint64_t key, uint32_t from,
                 uint32_t to)
{
	const struct rb_grid_item *items = query->grid->items;

	for (uint32_t i = from; i < to; i++) {
		if (items[i].key != key)
			continue;
		query->found->tests++;
		if (rb_aabb_overlap(&item->box, &items[i].box) &&
		    wanted(query->boxes, item->index, items[i].index))
			emit(query->found, item->index, items[i].index);
	}
}

/* Cells x_first .. x_last of one row, run by run. */
static void scan_row(struct query *query, const struct rb_grid_item *item, uint64_t row,
                     int64_t x_first, int64_t x_last)
{
	const uint32_t *start = query->grid->start;

	while (x_first <= x_last) {
		const int64_t run_last = x_first | (RUN - 1);
		const int64_t last = run_last < x_last ? run_last : x_last;
		const uint64_t key = run_key(row, x_first);

		scan(query, item, key, start[bucket_of(key, query->mask, x_first)],
		     start[bucket_of(key, query->mask, last) + 1]);
		x_first = run_last + 1;
	}
}

/*
 * Partners of the item's own level. Half of the neighbourhood is enough: the cells that come after
 * its own by (z, y, x), and of its own those items that lie behind it.
 */
static void scan_own_level(struct query *query, uint32_t place)
{
	const struct rb_grid_item *item = &query->grid->items[place];
	const struct level *level = &query->grid->levels->level[item->rank];
	const double s = level->inverse, reach = level->reach;
	const int64_t x = cell(item->box.low.x * s), x_low = cell(item->box.low.x * s - reach);
	const int64_t x_high = cell(item->box.high.x * s);
	const int64_t y = cell(item->box.low.y * s), y_low = cell(item->box.low.y * s - reach);
	const int64_t y_high = cell(item->box.high.y * s);
	const int64_t z = cell(item->box.low.z * s), z_high = cell(item->box.high.z * s);
	const int64_t run_last = (x | (RUN - 1)) < x_high ? (x | (RUN - 1)) : x_high;
	const uint64_t row = row_salt(level, y, z);

	scan(query, item, item->key, place + 1,
	     query->grid->start[bucket_of(item->key, query->mask, run_last) + 1]);
	scan_row(query, item, row, run_last + 1, x_high);
	for (int64_t iz = z; iz <= z_high; iz++)
		for (int64_t iy = iz == z ? y + 1 : y_low; iy <= y_high; iy++)
			scan_row(query, item, row_salt(level, iy, iz), x_low, x_high);
}

/*
 * Partners in a level of larger cells: every cell whose boxes could reach the item. In that level
 * the item spans at most two cells along each axis.
 */
static void scan_coarser_level(struct query *query, const struct rb_grid_item *item,
                               const struct level *level)
{
	const double s = level->inverse, reach = level->reach;
	const int64_t x_low = cell(item->box.low.x * s - reach),
		      x_high = cell(item->box.high.x * s);
	const int64_t y_low = cell(item->box.low.y * s - reach),
		      y_high = cell(item->box.high.y * s);
	const int64_t z_low = cell(item->box.low.z * s - reach),
		      z_high = cell(item->box.high.z * s);

	for (int64_t z = z_low; z <= z_high; z++)
		for (int64_t y = y_low; y <= y_high; y++)
			scan_row(query, item, row_salt(level, y, z), x_low, x_high);
}

/* Scratch of a call, from here on. */
static struct rb_arena *arena_of(struct rb_grid *grid)
{
	return grid->arena ? grid->arena : &grid->own;
}

/* The end of a call; its own arena joins its blocks. */
static void free_scratch(struct rb_grid *grid, rb_arena_mark here)
{
	grid->items = NULL;
	grid->places = NULL;
	grid->start = NULL;
	rb_arena_back(arena_of(grid), here);
	if (!grid->arena)
		rb_arena_reset(&grid->own);
}

/* Room for `count` boxes and `table` bucket starts; false when memory is out. */
static bool reserve(struct rb_grid *grid, size_t count, size_t table)
{
	if (!grid->levels) {
		grid->levels = rb_memory_take(1, sizeof *grid->levels);
		if (!grid->levels)
			return false;
		grid->levels->highest = LEVEL_COUNT -
		                        1; /* lowest is 0: all are cleared the first time */
	}
	grid->items = rb_arena_take(arena_of(grid), count, sizeof *grid->items);
	grid->places = rb_arena_take(arena_of(grid), count, sizeof *grid->places);
	grid->start = rb_arena_take(arena_of(grid), table, sizeof *grid->start);
	return grid->items && grid->places && grid->start;
}

/* What is looked for, and where each worker puts what it finds. */
struct search {
	struct query query;
	struct rb_grid_found *first; /* of the first worker */
	uint32_t count;
};

static void scan_block(void *user, int block, int worker)
{
	const struct search *search = user;
	const struct rb_grid *grid = search->query.grid;
	struct query query = search->query;
	const uint32_t first = (uint32_t)block * ITEMS_PER_BLOCK;
	const uint32_t left = search->count - first;
	const uint32_t end = first + (left < ITEMS_PER_BLOCK ? left : ITEMS_PER_BLOCK);

	struct rb_grid_found *const to = worker == 0 ? search->first : &grid->found[worker - 1];
	struct rb_grid_found found = *to; /* those of workers are neighbours in memory */

	query.found = &found;
	for (uint32_t i = first; i < end; i++) {
		const struct rb_grid_item *item = &grid->items[i];

		scan_own_level(&query, i);
		for (int rank = item->rank + 1; rank < grid->levels->used; rank++)
			scan_coarser_level(&query, item, &grid->levels->level[rank]);
	}
	*to = found;
}

/* By all workers; false: no memory for what they find. */
static bool scan_shared(struct rb_grid *grid, struct search *search, struct rb_grid_found *all)
{
	const int workers = rb_team_workers(grid->team);

	if (!grid->found) {
		grid->found = rb_memory_take((size_t)workers - 1, sizeof *grid->found);
		if (!grid->found)
			return false;
		grid->found_count = workers - 1;
	}
	for (int k = 0; k < grid->found_count; k++) {
		struct rb_grid_found *of = &grid->found[k];

		*of = (struct rb_grid_found){.pairs = of->pairs, .capacity = of->capacity};
	}
	rb_team_run(grid->team, (int)((search->count - 1) / ITEMS_PER_BLOCK + 1), scan_block,
	            search);
	for (int k = 0; k < grid->found_count; k++) {
		const struct rb_grid_found *of = &grid->found[k];

		all->failed = all->failed || of->failed;
		all->tests += of->tests;
		if (of->count == 0)
			continue;
		if (!rb_memory_reserve(&all->pairs, &all->capacity, all->count + of->count,
		                       sizeof *all->pairs))
			return false;
		memcpy(all->pairs + all->count, of->pairs, of->count * sizeof *of->pairs);
		all->count += of->count;
		rb_memory_discard(of->pairs, 0);
	}
	return true;
}

/* Pairs of boxes in a table of so many buckets. */
static enum rb_status find_in_table(struct rb_grid *grid, const struct rb_grid_boxes *boxes,
                                    size_t table, struct rb_error *err)
{
	const size_t count = (size_t)boxes->moving_count + (size_t)boxes->fixed_count;

	if (!reserve(grid, count, table + RUN + 1))
		return out_of_memory(err);
	const enum rb_status status = choose_levels(grid, boxes, err);
	if (status != RB_OK)
		return status;
	struct rb_grid_found found = begin_with(grid);
	struct search search = {.query = {.grid = grid, .boxes = boxes, .mask = table - 1},
	                        .first = &found,
	                        .count = (uint32_t)count};
	fill_table(grid, boxes, search.query.mask);
	if (grid->team && rb_team_workers(grid->team) > 1)
		found.failed = !scan_shared(grid, &search, &found) || found.failed;
	else
		for (uint32_t b = 0; b * ITEMS_PER_BLOCK < count; b++)
			scan_block(&search, (int)b, 0);
	return end_with(grid, &found, err);
}

enum rb_status rb_grid_find(struct rb_grid *grid, const struct rb_grid_boxes *boxes,
                            struct rb_error *err)
{
	RB_ASSERT(boxes->moving_count >= 0 && boxes->fixed_count >= 0);
	RB_ASSERT(!boxes->group_bit == !boxes->collides);

	const size_t count = (size_t)boxes->moving_count + (size_t)boxes->fixed_count;
	size_t table = 64;

	grid->pair_count = 0;
	if (count <= FEW)
		return find_all_pairs(grid, boxes, err);
	while (table < 2 * count)
		table *= 2;
	const rb_arena_mark here = rb_arena_here(arena_of(grid));
	const enum rb_status status = find_in_table(grid, boxes, table, err);
	free_scratch(grid, here);
	return status;
}

/* One pass of a counting sort, stable: column[k] is the next place of key k. */
static void sort_by(const struct rb_pair *from, struct rb_pair *to, size_t count, bool by_a,
                    uint32_t *column)
{
	for (size_t i = 0; i < count; i++)
		to[column[by_a ? from[i].a : from[i].b]++] = from[i];
}

/* Sets column[k] to the place of the first pair with key k. */
static void count_by(const struct rb_pair *from, size_t count, bool by_a, uint32_t *column,
                     size_t index_count)
{
	memset(column, 0, index_count * sizeof *column);
	for (size_t i = 0; i < count; i++)
		column[by_a ? from[i].a : from[i].b]++;
	uint32_t sum = 0;
	for (size_t i = 0; i < index_count; i++) {
		const uint32_t next = sum + column[i];

		column[i] = sum;
		sum = next;
	}
}

enum rb_status rb_grid_sort(struct rb_grid *grid, int index_count, struct rb_error *err)
{
	const size_t count = grid->pair_count, columns = (size_t)index_count;

	if (count < 2)
		return RB_OK;
	if (count > UINT32_MAX)
		return RB_FAIL(err, RB_ERR_PHYSICS, "%zu pairs of bodies may touch at once", count);
	const rb_arena_mark here = rb_arena_here(arena_of(grid));
	struct rb_pair *sorted = rb_arena_take(arena_of(grid), count, sizeof *sorted);
	uint32_t *column = rb_arena_take(arena_of(grid), columns, sizeof *column);
	const bool good = sorted && column;
	if (good) {
		/* by b, then stably by a: the order of (a, b) in linear time, whatever the pairs */
		count_by(grid->pairs, count, false, column, columns);
		sort_by(grid->pairs, sorted, count, false, column);
		count_by(sorted, count, true, column, columns);
		sort_by(sorted, grid->pairs, count, true, column);
	}
	free_scratch(grid, here);
	if (!good)
		return out_of_memory(err);

	size_t kept = 1;
	for (size_t i = 1; i < count; i++)
		if (grid->pairs[i].a != grid->pairs[kept - 1].a ||
		    grid->pairs[i].b != grid->pairs[kept - 1].b)
			grid->pairs[kept++] = grid->pairs[i];
	RB_ASSERT(kept <= count);
	grid->pair_count = kept;
	return RB_OK;
}
