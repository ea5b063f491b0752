/* SPDX-License-Identifier: MIT */
/*
 * Boxes -> pairs of boxes that overlap, by a hierarchical grid.
 *
 * Owned by whoever made it, one thread at a time. Each box is kept in one cell: of the level whose
 * cells are just larger than it, at its low corner. A pair is looked for from the smaller box, in
 * the few cells of its own and each coarser level in use that could hold a partner, so that neither
 * a mix of sizes nor a box over very many small cells costs anything. Pairs are kept until the next
 * call; all else lies in an arena.
 */
#ifndef RB_GEOM_GRID_H
#define RB_GEOM_GRID_H

#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

#include "base/arena.h"

/* Indices of two bodies, a < b. */
struct rb_pair {
	int a, b;
};

/*
 * Moving boxes have the indices [0, moving_count), fixed ones follow; two fixed ones are no pair.
 * Boxes are finite with low <= high. Filters (may be NULL) are by index: a pair needs both
 * collides[a] & group_bit[b] and collides[b] & group_bit[a].
 */
struct rb_grid_boxes {
	const rb_aabb *moving, *fixed;
	int moving_count, fixed_count;
	const uint64_t *group_bit, *collides;
};

struct rb_team;

struct rb_grid {
	struct rb_team *team; /* borrowed, set by whoever made it; NULL: in one thread */
	/* pairs, unsorted until rb_grid_sort */
	struct rb_pair *pairs; /* owned */
	size_t pair_count;
	uint64_t tests; /* of box against box, so far */
	/* borrowed, left as it was found; NULL: the grid's own */
	struct rb_arena *arena;

	/* private, owned */
	size_t pair_capacity;
	struct rb_grid_levels *levels;
	struct rb_arena own;
	/* of a call, in the arena */
	struct rb_grid_item *items;   /* by bucket */
	struct rb_grid_place *places; /* by index */
	uint32_t *start;              /* of each bucket in items, one more at the end */
	struct rb_grid_found *found;  /* of each worker but the first */
	int found_count;
};

void rb_grid_init(struct rb_grid *grid);
void rb_grid_release(struct rb_grid *grid);

/* Empties the pairs and finds those of `boxes`; touching boxes overlap. */
RB_CHECKED enum rb_status rb_grid_find(struct rb_grid *grid, const struct rb_grid_boxes *boxes,
                                       struct rb_error *err);

/* A pair from elsewhere, to be sorted with the others. */
RB_CHECKED enum rb_status rb_grid_add_pair(struct rb_grid *grid, int a, int b,
                                           struct rb_error *err);

/* By (a, b), both below `index_count`. */
RB_CHECKED enum rb_status rb_grid_sort(struct rb_grid *grid, int index_count, struct rb_error *err);

/* Closed intervals. */
static inline int rb_aabb_overlap(const rb_aabb *a, const rb_aabb *b)
{
	/* without branches: in a grid the outcome is a coin toss for the predictor */
	return (a->low.x <= b->high.x) & (b->low.x <= a->high.x) & (a->low.y <= b->high.y) &
	       (b->low.y <= a->high.y) & (a->low.z <= b->high.z) & (b->low.z <= a->high.z);
}

#endif
