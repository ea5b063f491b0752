/* SPDX-License-Identifier: MIT */
/*
 * Each level has one or two grids: of the bodies of that level (natives) and of smaller ones
 * (guests), since a guest's candidates on a level are its natives only. A body's position on a
 * level, an entry, is three integers that change only when it crosses a wall: they are not computed
 * from the position again, so rounding cannot lose a body.
 *
 * Walls have hysteresis: a body leaves its cell at `hysteresis` x edge behind the wall, and returns
 * after twice that distance, so a body that stops or reverses at a wall does not cross it without
 * end. The edge is increased accordingly: bodies that touch are in neighbouring cells as long as
 * each is in its own or within `hysteresis` of it,
 *     r_a + r_b <= 2 r_max < edge (1 - 2 hysteresis),
 * and the remaining difference covers the rounding of coordinates up to 1e12 edges. A body whose
 * motion is only bounded is checked at the earliest time at which it could reach the wall, and
 * crosses from half of `hysteresis` behind the boundary between the cells on: farther from the wall
 * the next check is some time away.
 *
 * A cell is a block of three bodies and a tail: a walk over 27 cells reads nine short ranges of
 * memory without following pointers and, because a block is copied as a whole, without
 * unpredictable branches. Further members go to further blocks; all blocks of a cell are full
 * except the most recent one. So c > SLOTS bodies need fewer than c / SLOTS further blocks, and all
 * that can ever be needed are allocated beforehand. Measured in a gas against lists through the
 * bodies (a fifth slower) and copying slot by slot (a walk takes twice as long).
 */
#include "located/cells.h"

#include "located/cells_inside.h"
#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum {
	/*
	 * number of bodies up to which all are candidates, since 27 cells would hold no more, and
	 * there are no walls
	 */
	CELLS_MIN_BODIES = 16,
	SMALLEST_SIDE = 4,
};

static const double slack = 0x1p-6; /* minimum of edge / (2 r_max) - 1; above 2 x hysteresis */
/*
 * Bodies per cell for small, evenly distributed bodies. In a gas 0.25 to 0.7 are equally good:
 * smaller cells are crossed more often, larger ones hold more candidates.
 */
static const double load = 0.5;
static const double crowded =
	6; /* mean number of bodies in a body's own cell above which cells are halved */

/* ---- members of a cell ---- */

/* Removes a member; the last one of the open block fills the gap. */
static void remove_member(struct rb_cells *cells, struct block *cell, int32_t body)
{
	struct block *open = open_block(cells, cell);
	const int32_t last = open->member[members_in(open) - 1];

	for (struct block *block = cell; last != body; block = next_block(cells, block)) {
		uint32_t i = 0;

		RB_ASSERT(block);
		while (i < members_in(block) && block->member[i] != body)
			i++;
		if (i < members_in(block)) {
			block->member[i] = last;
			break;
		}
	}
	open->tail--;
	if (open != cell && members_in(open) == 0) {
		const uint32_t index_tail = cell->tail & ~3u;

		cell->tail = open->tail | members_in(cell);
		open->tail = cells->free_tail;
		cells->free_tail = index_tail;
	}
}

/* ---- walks ---- */

/* A walk over neighbouring cells: up to three offsets along each axis. */
struct walk {
	size_t place[3][3];
	int count[3];
};

/* The 27 cells around `at`, wrapped by masks. */
static void walk_around(const struct level *level, const int64_t at[3], struct walk *walk)
{
	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 3; i++)
			walk->place[k][i] = (size_t)((at[k] + i - 1) & level->mask[k]) *
			                    level->stride[k];
		walk->count[k] = 3;
	}
}

/*
 * Copies a chain of blocks member by member: for cells with further blocks, or if little room is
 * left.
 */
__attribute__((noinline, cold)) static int copy_cell(const struct rb_cells *cells,
                                                     const struct block *block, int *out, int count)
{
	for (; block; block = next_block(cells, block)) {
		const int here = (int)members_in(block);

		memcpy(out + count, block->member, (size_t)here * sizeof *out);
		count += here;
	}
	return count;
}

/* Copies a cell of one block as a whole if there is room, as nearly always. */
static inline int copy_block(const struct rb_cells *cells, const struct block *block, int *out,
                             int count, int roomy)
{
	if ((block->tail > 3) | (count > roomy))
		return copy_cell(cells, block, out, count);
	memcpy(out + count, block, sizeof *block);
	return count + (int)block->tail;
}

/* Appends the members of the walk's cells to `out`; returns the new count. */
static int copy_members(const struct rb_cells *cells, const struct grid *grid,
                        const struct walk *walk, int *out, int count)
{
	const int roomy = cells->count - (int)(sizeof(struct block) / sizeof *out);
	const size_t first = walk->place[0][0], second = walk->place[0][1];
	const size_t third = walk->place[0][2];

	for (int z = 0; z < walk->count[2]; z++) {
		const struct block *sheet = grid->cells + walk->place[2][z];

		for (int y = 0; y < walk->count[1]; y++) {
			const struct block *row = sheet + walk->place[1][y];

			count = copy_block(cells, row + first, out, count, roomy);
			if (walk->count[0] == 1)
				continue;
			count = copy_block(cells, row + second, out, count, roomy);
			count = copy_block(cells, row + third, out, count, roomy);
		}
	}
	return count;
}

/* Removes `body`, which must be in the list. */
static int remove_from(int *out, int count, int body)
{
	int i = 0;

	while (out[i] != body)
		i++;
	out[i] = out[--count];
	return count;
}

/* Lists all other bodies. */
static int list_all(const struct rb_cells *cells, int body, int *out)
{
	int count = 0;

	for (int other = 0; other < cells->count; other++) {
		out[count] = other;
		count += other != body;
	}
	return count;
}

int rb_cells_near(const struct rb_cells *cells, int body, int *out)
{
	RB_ASSERT(body >= 0 && body < cells->count);
	const struct entry *entry = entries_of(cells, body);
	const int own = own_level(cells, body);
	struct walk walk;
	int count = 0;

	if (own == cells->level_count)
		return list_all(cells, body, out);
	for (int l = own; l < cells->level_count; l++) {
		const struct level *level = &cells->levels[l];

		walk_around(level, entry++->at, &walk);
		count = copy_members(cells, &level->natives, &walk, out, count);
		if (l > own)
			continue;
		count = remove_from(out, count, body);
		if (level->guests.cells)
			count = copy_members(cells, &level->guests, &walk, out, count);
	}
	for (int k = 0; k < cells->endless_count; k++)
		out[count++] = cells->endless[k];
	return count;
}

/* Restricts a walk to one of its three offsets, -1 to 1, along an axis. */
static void restrict_walk(struct walk *walk, int axis, int offset)
{
	walk->place[axis][0] = walk->place[axis][1 + offset];
	walk->count[axis] = 1;
}

/* Removes bodies up to `body` from those listed at `from` and behind. */
static int keep_higher(int *out, int from, int count, int body)
{
	int kept = from;

	for (int k = from; k < count; k++)
		if (out[k] > body)
			out[kept++] = out[k];
	return kept;
}

/*
 * Of the 27 cells around a body those ahead: of two neighbours each is ahead of the other along z,
 * in one layer along y, in one row along x; in its own cell, bodies of higher index.
 */
static int copy_ahead(const struct rb_cells *cells, const struct grid *grid,
                      const struct walk *around, int body, int *out)
{
	struct walk walk = *around;

	restrict_walk(&walk, 2, 1);
	int count = copy_members(cells, grid, &walk, out, 0);
	walk = *around;
	restrict_walk(&walk, 2, 0);
	restrict_walk(&walk, 1, 1);
	count = copy_members(cells, grid, &walk, out, count);
	walk.place[1][0] = around->place[1][1];
	restrict_walk(&walk, 0, 1);
	count = copy_members(cells, grid, &walk, out, count);
	walk.place[0][0] = around->place[0][1];
	const int from = count;

	count = copy_members(cells, grid, &walk, out, count);
	return keep_higher(out, from, count, body);
}

int rb_cells_near_once(const struct rb_cells *cells, int body, int *out)
{
	RB_ASSERT(body >= 0 && body < cells->count);
	const struct entry *entry = entries_of(cells, body);
	const int own = own_level(cells, body);
	struct walk walk;
	int count = 0;

	if (own == cells->level_count) {
		const int all = cells->level_count > 0 ? cells->endless_count : cells->count;

		for (int k = 0; k < all; k++)
			out[count++] = cells->level_count > 0 ? cells->endless[k] : k;
		return keep_higher(out, 0, count, body);
	}
	for (int l = own; l < cells->level_count; l++) {
		const struct grid *grid = &cells->levels[l].natives;

		walk_around(&cells->levels[l], entry++->at, &walk);
		count = l > own ? copy_members(cells, grid, &walk, out, count)
		                : copy_ahead(cells, grid, &walk, body, out);
	}
	for (int k = 0; k < cells->endless_count; k++)
		out[count++] = cells->endless[k];
	return count;
}

void rb_cells_prefetch(const struct rb_cells *cells, int body)
{
	__builtin_prefetch(entries_of(cells, body));
}

void rb_cells_prefetch_near(const struct rb_cells *cells, int body)
{
	const struct entry *entry = entries_of(cells, body);
	struct walk walk;

	if (own_level(cells, body) == cells->level_count)
		return;
	const struct level *level = &cells->levels[own_level(cells, body)];

	walk_around(level, entry->at, &walk);
	for (int z = 0; z < 3; z++) {
		for (int y = 0; y < 3; y++) {
			const struct block *row = level->natives.cells + walk.place[2][z] +
			                          walk.place[1][y];

			__builtin_prefetch(row + walk.place[0][0]);
			__builtin_prefetch(row + walk.place[0][2]);
		}
	}
}

int rb_cells_max(const struct rb_cells *cells)
{
	return cells->count;
}

int rb_cells_level_count(const struct rb_cells *cells)
{
	return cells->level_count;
}

/* ---- moving ---- */

int rb_cells_cross(struct rb_cells *cells, int body, int wall, int *out)
{
	RB_ASSERT(body >= 0 && body < cells->count && wall >= 0);
	const int own = own_level(cells, body), l = own + wall / WALLS;
	const int axis = wall % WALLS / 2, step = wall % 2 ? 1 : -1;

	RB_ASSERT(l < cells->level_count);
	const struct level *level = &cells->levels[l];
	const struct grid *grid = l == own ? &level->natives : &level->guests;
	struct entry *entry = entries_of(cells, body) + (l - own);
	struct walk walk;
	int count;

	remove_member(cells, &grid->cells[cell_at(level, entry->at)], body);
	entry->at[axis] += step;
	add_member(cells, &grid->cells[cell_at(level, entry->at)], body);

	walk_around(level, entry->at, &walk);
	restrict_walk(&walk, axis, step);
	count = copy_members(cells, &level->natives, &walk, out, 0);
	if (l == own && level->guests.cells)
		count = copy_members(cells, &level->guests, &walk, out, count);
	return count;
}

/* Cell of a position, clamped to the outermost. */
static struct entry find_entry(const struct level *level, const double position[3])
{
	struct entry entry;

	for (int k = 0; k < 3; k++) {
		const double at = floor(position[k] * level->inverse);

		entry.at[k] = (int64_t)fmax(-(double)farthest, fmin((double)farthest, at));
	}
	return entry;
}

void rb_cells_place(struct rb_cells *cells, int body, rb_vec3 position)
{
	RB_ASSERT(body >= 0 && body < cells->count);
	const double x[3] = {position.x, position.y, position.z};
	const int own = own_level(cells, body);
	struct entry *entry = entries_of(cells, body);

	for (int l = own; l < cells->level_count; l++, entry++) {
		const struct level *level = &cells->levels[l];
		const struct grid *grid = l == own ? &level->natives : &level->guests;

		remove_member(cells, &grid->cells[cell_at(level, entry->at)], body);
		*entry = find_entry(level, x);
		add_member(cells, &grid->cells[cell_at(level, entry->at)], body);
	}
}

int rb_cells_wall_count(const struct rb_cells *cells, int body)
{
	return WALLS * (cells->level_count - own_level(cells, body));
}

/* ---- creation ---- */

struct extent {
	double size[3]; /* m, of the box around the centres of those listed on a level */
	int count;
};

/* Box of the centres listed on a level. */
static struct extent find_extent(const struct rb_cells *cells, int l, const double *position)
{
	double low[3], high[3];
	struct extent extent = {.count = 0};

	for (int body = 0; body < cells->count; body++) {
		if (own_level(cells, body) > l)
			continue;
		for (int k = 0; k < 3; k++) {
			const double x = position[3 * (size_t)body + (size_t)k];

			low[k] = extent.count == 0 ? x : fmin(low[k], x);
			high[k] = extent.count == 0 ? x : fmax(high[k], x);
		}
		extent.count++;
	}
	for (int k = 0; k < 3; k++)
		extent.size[k] = high[k] - low[k];
	return extent;
}

/*
 * Maximum number of cells of a level. Empty cells cost only address space, wrapping the torus costs
 * candidates; sides are powers of two, so a box may need eight times its cells.
 */
static size_t cells_max(const struct extent *extent)
{
	return 16 * (size_t)extent->count + 64;
}

/*
 * Sets the edge of a level's cells and the sides of its torus, which covers the box if that takes
 * no more than cells_max, else wraps.
 */
static void set_edge(struct level *level, const struct extent *extent, double edge)
{
	const size_t max = cells_max(extent);
	size_t side[3];

	level->edge = edge;
	level->inverse = 1 / edge;
	level->reach = edge * (0.5 + hysteresis);
	for (int k = 0; k < 3; k++) {
		side[k] = SMALLEST_SIDE;
		while ((double)side[k] < extent->size[k] / edge + 2 && side[k] < max)
			side[k] *= 2;
	}
	/* in doubles, since the product of sizes could overflow */
	while ((double)side[0] * (double)side[1] * (double)side[2] > (double)max) {
		const int longest = side[0] >= side[1] ? (side[0] >= side[2] ? 0 : 2)
		                                       : (side[1] >= side[2] ? 1 : 2);
		side[longest] /= 2;
	}
	for (int k = 0; k < 3; k++)
		level->mask[k] = (int64_t)side[k] - 1;
	level->stride[0] = 1;
	level->stride[1] = side[0];
	level->stride[2] = side[0] * side[1];
	level->cell_count = side[0] * side[1] * side[2];
}

/* Mean number of bodies in a body's own cell, itself included. `counts` has room for all cells. */
static double measure_crowd(const struct rb_cells *cells, int l, const double *position,
                            int32_t *counts)
{
	const struct level *level = &cells->levels[l];
	double sum = 0, listed = 0;

	memset(counts, 0, level->cell_count * sizeof *counts);
	for (int body = 0; body < cells->count; body++) {
		if (own_level(cells, body) > l)
			continue;
		const struct entry entry = find_entry(level, &position[3 * (size_t)body]);

		/* 1 + 3 + 5 + ... = n^2 */
		sum += 2 * counts[cell_at(level, entry.at)]++ + 1;
		listed++;
	}
	return sum / listed;
}

/*
 * Chooses the edge: first for bodies distributed evenly over their box, then halved while cells are
 * crowded. False: no memory.
 */
static bool choose_edge(struct rb_cells *cells, int l, const double *position)
{
	struct level *level = &cells->levels[l];
	const struct extent extent = find_extent(cells, l, position);
	const double least = 2 * level->largest * (1 + slack), *size = extent.size;
	double edge = fmax(least, fmax(size[0], fmax(size[1], size[2])));
	int32_t *counts;

	while (edge > least &&
	       fmax(1, size[0] / edge) * fmax(1, size[1] / edge) * fmax(1, size[2] / edge) <
	               extent.count / load)
		edge *= 0.9;
	edge = fmax(edge, least);
	set_edge(level, &extent, edge);

	counts = rb_memory_take(cells_max(&extent), sizeof *counts);
	if (!counts)
		return false;
	while (edge > least && measure_crowd(cells, l, position, counts) > crowded) {
		edge = fmax(edge / 2, least);
		set_edge(level, &extent, edge);
	}
	rb_memory_free(counts);
	return true;
}

/* Allocates zeroed cells. */
static bool take_grid(struct grid *grid, size_t cell_count)
{
	grid->cells = rb_memory_take(cell_count, sizeof *grid->cells);
	return grid->cells != NULL;
}

/*
 * Fills level_count, levels and own: a level for each octave of radii that occurs, counted from the
 * smallest.
 */
static bool find_levels(struct rb_cells *cells, const double *radius)
{
	enum { OCTAVES = 1025 };
	double smallest = (double)INFINITY, largest[OCTAVES] = {0};
	int rank[OCTAVES];

	cells->own = rb_memory_take((size_t)cells->count, sizeof *cells->own);
	cells->endless = rb_memory_take((size_t)cells->count, sizeof *cells->endless);
	if (!cells->own || !cells->endless)
		return false;
	for (int body = 0; body < cells->count; body++) {
		RB_ASSERT(radius[body] > 0);
		smallest = fmin(smallest, radius[body]);
	}
	for (int body = 0; body < cells->count; body++) {
		if (!isfinite(radius[body])) {
			cells->endless[cells->endless_count++] = body;
			continue;
		}
		const int octave = ilogb(fmin(radius[body] / smallest, 0x1p1023));

		RB_ASSERT(octave >= 0 && octave < OCTAVES);
		cells->own[body] = octave;
		largest[octave] = fmax(largest[octave], radius[body]);
	}
	for (int octave = 0; octave < OCTAVES; octave++) {
		rank[octave] = cells->level_count;
		cells->level_count += largest[octave] > 0;
	}
	cells->levels = rb_memory_take((size_t)cells->level_count + 1, sizeof *cells->levels);
	if (!cells->levels)
		return false;
	for (int octave = 0; octave < OCTAVES; octave++) {
		if (largest[octave] > 0)
			cells->levels[rank[octave]].largest = largest[octave];
	}
	for (int body = 0; body < cells->count; body++)
		cells->own[body] = isfinite(radius[body]) ? rank[cells->own[body]]
		                                          : cells->level_count;
	if (cells->level_count == 1 && cells->endless_count == 0) {
		rb_memory_free(cells->own);
		cells->own = NULL;
	}
	return true;
}

/* Allocates entries and all blocks that can ever be needed, as a free list. */
static bool take_entries(struct rb_cells *cells)
{
	size_t entry_count = (size_t)cells->count, block_count;

	if (cells->own) {
		cells->first = rb_memory_take((size_t)cells->count, sizeof *cells->first);
		if (!cells->first)
			return false;
		entry_count = 0;
		for (int body = 0; body < cells->count; body++) {
			cells->first[body] = entry_count;
			entry_count += (size_t)(cells->level_count - cells->own[body]);
		}
	}
	block_count = entry_count / SLOTS;
	cells->entries = rb_memory_take(entry_count, sizeof *cells->entries);
	cells->blocks = rb_memory_take(block_count, sizeof *cells->blocks);
	if (!cells->entries || !cells->blocks || block_count >= UINT32_MAX / 4)
		return false;
	for (size_t i = block_count; i-- > 0;) {
		cells->blocks[i].tail = cells->free_tail;
		cells->free_tail = (uint32_t)(i + 1) << 2;
	}
	return true;
}

/* Creates levels and grids, and puts each body into its cells. */
static bool fill(struct rb_cells *cells, const double *radius, const double *position)
{
	if (!find_levels(cells, radius) || !take_entries(cells))
		return false;
	for (int l = 0; l < cells->level_count; l++) {
		struct level *level = &cells->levels[l];

		if (!choose_edge(cells, l, position) ||
		    !take_grid(&level->natives, level->cell_count) ||
		    (l > 0 && !take_grid(&level->guests, level->cell_count)))
			return false;
	}
	for (int body = 0; body < cells->count; body++) {
		const int own = own_level(cells, body);
		struct entry *entry = entries_of(cells, body);

		for (int l = own; l < cells->level_count; l++, entry++) {
			const struct level *level = &cells->levels[l];
			const struct grid *grid = l == own ? &level->natives : &level->guests;

			*entry = find_entry(level, &position[3 * (size_t)body]);
			add_member(cells, &grid->cells[cell_at(level, entry->at)], body);
		}
	}
	return true;
}

enum rb_status rb_cells_create(struct rb_cells **cells, int count, const double *radius,
                               const double *position, struct rb_error *err)
{
	struct rb_cells *made = rb_memory_take(1, sizeof *made);

	*cells = NULL;
	if (made)
		made->count = count;
	if (!made || (count > CELLS_MIN_BODIES && !fill(made, radius, position))) {
		rb_cells_destroy(made);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the cells of %d bodies", count);
	}
	*cells = made;
	return RB_OK;
}

void rb_cells_destroy(struct rb_cells *cells)
{
	if (!cells)
		return;
	for (int l = 0; cells->levels && l < cells->level_count; l++) {
		rb_memory_free(cells->levels[l].natives.cells);
		rb_memory_free(cells->levels[l].guests.cells);
	}
	rb_memory_free(cells->levels);
	rb_memory_free(cells->entries);
	rb_memory_free(cells->own);
	rb_memory_free(cells->endless);
	rb_memory_free(cells->first);
	rb_memory_free(cells->blocks);
	rb_memory_free(cells);
}
