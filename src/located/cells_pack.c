/* SPDX-License-Identifier: MIT */
/* Packs cells. Loaded bytes are hostile until checked. */
#include "located/cells.h"
#include "located/cells_inside.h"

#include "base/memory.h"

#include <string.h>

static RB_FIELDS_DECLARE(entry_fields);
static RB_FIELDS_DEFINE(entry_fields, struct entry, ENTRY_FIELDS);

/*
 * Writes the members of a cell in an order that, when added one by one to an empty cell, reproduces
 * its blocks.
 */
static int in_order(const struct rb_cells *cells, const struct block *cell, int32_t *out)
{
	int count = (int)members_in(cell);
	const struct block *block = next_block(cells, cell);
	int further = 0;

	memcpy(out, cell->member, (size_t)count * sizeof *out);
	for (; block; block = next_block(cells, block))
		further += (int)members_in(block);
	int at = count + further;
	count = at;
	for (block = next_block(cells, cell); block; block = next_block(cells, block)) {
		at -= (int)members_in(block);
		memcpy(out + at, block->member, (size_t)members_in(block) * sizeof *out);
	}
	return count;
}

static void save_grid(const struct rb_cells *cells, const struct level *level,
                      const struct grid *grid, int32_t *order, struct rb_pack *pack)
{
	int count = 0;

	for (size_t cell = 0; grid->cells && cell < level->cell_count; cell++)
		if (grid->cells[cell].tail != 0)
			count += in_order(cells, &grid->cells[cell], order + count);
	rb_pack_bytes(pack, order, (size_t)count * sizeof *order);
}

/* Loads as many members as the grid has, each body of it once, into the cell of its entry. */
static void load_grid(struct rb_cells *cells, int l, bool native, unsigned char *seen,
                      struct rb_pack *pack)
{
	const struct level *level = &cells->levels[l];
	const struct grid *grid = native ? &level->natives : &level->guests;
	int count = 0;

	for (int body = 0; body < cells->count; body++) {
		count += native ? own_level(cells, body) == l : own_level(cells, body) < l;
		seen[body] = 0;
	}
	for (int k = 0; k < count; k++) {
		int body = 0;

		rb_pack_int(pack, &body, 0, cells->count - 1);
		const int own = own_level(cells, body);
		if (!rb_pack_check(pack, !seen[body] && (native ? own == l : own < l),
		                   "a body in two cells"))
			return;
		seen[body] = 1;
		const struct entry *entry = entries_of(cells, body) + (l - own);
		add_member(cells, &grid->cells[cell_at(level, entry->at)], body);
	}
}

static size_t entry_count_of(const struct rb_cells *cells)
{
	size_t count = 0;

	for (int body = 0; body < cells->count; body++)
		count += (size_t)(cells->level_count - own_level(cells, body));
	return count;
}

static void free_blocks(struct rb_cells *cells)
{
	cells->free_tail = 0;
	for (size_t i = entry_count_of(cells) / SLOTS; i-- > 0;) {
		cells->blocks[i] = (struct block){.tail = cells->free_tail};
		cells->free_tail = (uint32_t)(i + 1) << 2;
	}
}

static void clear_grid(const struct level *level, const struct grid *grid)
{
	if (grid->cells)
		memset(grid->cells, 0, level->cell_count * sizeof *grid->cells);
}

void rb_cells_pack(struct rb_cells *cells, struct rb_pack *pack)
{
	const size_t entries = cells->level_count > 0 ? entry_count_of(cells) : 0;
	int32_t *const order = rb_memory_take((size_t)cells->count, sizeof *order);

	if (!order) {
		rb_pack_fail_memory(pack);
		return;
	}
	rb_fields_pack(entry_fields(), cells->entries, entries, NULL, pack);
	if (pack->loading && cells->level_count > 0) {
		for (int l = 0; l < cells->level_count; l++) {
			clear_grid(&cells->levels[l], &cells->levels[l].natives);
			clear_grid(&cells->levels[l], &cells->levels[l].guests);
		}
		free_blocks(cells);
	}
	for (int l = 0; l < cells->level_count && !pack->failed; l++) {
		const struct level *level = &cells->levels[l];

		if (pack->loading) {
			load_grid(cells, l, true, (unsigned char *)order, pack);
			load_grid(cells, l, false, (unsigned char *)order, pack);
		} else {
			save_grid(cells, level, &level->natives, order, pack);
			save_grid(cells, level, &level->guests, order, pack);
		}
	}
	rb_memory_free(order);
}
