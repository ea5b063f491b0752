/* SPDX-License-Identifier: MIT */
/* Data structures private to located/cells, which explains them, cells_walls and cells_pack. */
#ifndef RB_LOCATED_CELLS_INSIDE_H
#define RB_LOCATED_CELLS_INSIDE_H

#include "base/error.h"
#include "base/field_list.h"

#include <stddef.h>
#include <stdint.h>

/* WALLS: of a cell, numbered 2 x axis + (1: the one at the higher end). */
enum { SLOTS = 3, WALLS = 6 };

/* Hysteresis of walls, share of the edge: located/cells. */
static const double hysteresis = 0x1p-8;

/* The outermost cells: beyond them doubles cannot distinguish cells. */
#define FARTHEST_CELL (1ll << 50)
static const int64_t farthest = FARTHEST_CELL;

/*
 * The first members are valid. A cell's own block and all further ones are full, except the most
 * recent one, to which the own block points.
 */
struct block {
	int32_t member[SLOTS];
	uint32_t tail; /* number of members, plus 4 x (1 + index of a further block), 0 for none */
};
_Static_assert(SLOTS < 4, "the tail has two bits for the number of members");

struct grid {
	struct block *cells; /* NULL: always empty */
};

struct level {
	double edge, inverse; /* m, 1/m */
	double reach;         /* m, distance from a cell's middle at which bodies leave it */
	double largest;       /* m, radius */
	int64_t mask[3];      /* cells along each axis less 1 */
	size_t stride[3];     /* in cells */
	size_t cell_count;
	struct grid natives, guests;
};

#define ENTRY_FIELDS(X)                              \
	X(int64_t, at, [3], "", "cell, not wrapped", \
	  RB_LONG_WITHIN(-FARTHEST_CELL - 1, FARTHEST_CELL + 1))
struct entry {
	ENTRY_FIELDS(RB_FIELD_MEMBER)
};

struct rb_cells {
	int count, level_count;
	struct level *levels;  /* fine to coarse; 0: few bodies, no cells */
	struct entry *entries; /* of each body from its own level to the coarsest */
	/* level of each body, level_count for endless ones; NULL: there is one level */
	int32_t *own;
	int32_t *endless; /* bodies that are candidates of all */
	int endless_count;
	size_t *first;        /* index of each body's first entry; NULL: the body's index */
	struct block *blocks; /* further ones */
	uint32_t free_tail;   /* a tail without members that points to the free blocks */
};

static inline size_t cell_at(const struct level *level, const int64_t at[3])
{
	size_t cell = 0;

	for (int k = 0; k < 3; k++)
		cell += (size_t)(at[k] & level->mask[k]) * level->stride[k];
	return cell;
}

static inline uint32_t members_in(const struct block *block)
{
	return block->tail & 3;
}

/* NULL: none. */
static inline struct block *next_block(const struct rb_cells *cells, const struct block *block)
{
	return block->tail > 3 ? &cells->blocks[(block->tail >> 2) - 1] : NULL;
}

/* The block of a cell that is not full, if there is one. */
static inline struct block *open_block(const struct rb_cells *cells, struct block *cell)
{
	struct block *next = next_block(cells, cell);

	return next ? next : cell;
}

static inline void add_member(struct rb_cells *cells, struct block *cell, int32_t body)
{
	struct block *block = open_block(cells, cell);

	if (members_in(block) == SLOTS) {
		const uint32_t free_tail = cells->free_tail, further = cell->tail & ~3u;

		RB_ASSERT(free_tail != 0);
		block = &cells->blocks[(free_tail >> 2) - 1];
		cells->free_tail = block->tail;
		cell->tail = free_tail | members_in(cell);
		block->tail = further;
	}
	block->member[members_in(block)] = body;
	block->tail++;
}

static inline int own_level(const struct rb_cells *cells, int body)
{
	return cells->own ? cells->own[body] : 0;
}

static inline struct entry *entries_of(const struct rb_cells *cells, int body)
{
	return &cells->entries[cells->first ? cells->first[body] : (size_t)body];
}

#endif
