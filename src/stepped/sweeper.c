/* SPDX-License-Identifier: MIT */
#include "stepped/sweeper.h"

#include <stdint.h>
#include <string.h>

enum { COLOURS_MAX = 64 };

/* ---- colours ---- */

/*
 * Rows in order of colours: none has two rows on one body that yields, unless the last is a tail of
 * what is left over.
 */
struct colours {
	int *first; /* [count + 1]: where each begins in `order` */
	int *order; /* [rows] */
	int count;
	bool tail;
};

/* Where a body that yields keeps its colours, as bits; NULL: it does not yield. */
static uint64_t *taken_of(const struct rb_sweeper *sweeper, uint64_t *taken, int body)
{
	return sweeper->dense->bodies.body[body].inverse_mass > 0 ? &taken[sweeper->local[body]]
	                                                          : NULL;
}

static void choose(const struct rb_sweeper *sweeper, struct colours *colours, uint64_t *taken,
                   unsigned char *colour)
{
	for (int k = 0; k < sweeper->dense->row_count; k++) {
		const struct rb_constraint *row = &sweeper->dense->row[k];
		uint64_t *const of_a = taken_of(sweeper, taken, row->a);
		uint64_t *const of_b = taken_of(sweeper, taken, row->b);
		const uint64_t left = ~((of_a ? *of_a : 0) | (of_b ? *of_b : 0));
		const int c = left ? __builtin_ctzll(left) : COLOURS_MAX - 1;

		colour[k] = (unsigned char)c;
		colours->tail = colours->tail || c == COLOURS_MAX - 1;
		colours->count = c + 1 > colours->count ? c + 1 : colours->count;
		colours->first[c + 1]++;
		if (of_a)
			*of_a |= (uint64_t)1 << c;
		if (of_b)
			*of_b |= (uint64_t)1 << c;
	}
}

/* Rows by colour, those of one colour as they stood. False: no memory. */
static bool colour_rows(const struct rb_sweeper *sweeper, struct colours *colours,
                        struct rb_arena *arena)
{
	const size_t count = (size_t)sweeper->dense->row_count;
	const size_t members = (size_t)sweeper->member_count;
	uint64_t *taken = rb_arena_take(arena, members, sizeof *taken);
	unsigned char *colour = rb_arena_take(arena, count, 1);
	int *first = rb_arena_take(arena, COLOURS_MAX + 2, sizeof *first);
	int *order = rb_arena_take(arena, count, sizeof *order);

	if (!taken || !colour || !first || !order)
		return false;
	colours->first = first;
	colours->order = order;
	for (int k = 0; k < sweeper->member_count; k++)
		sweeper->local[sweeper->member[k]] = k;
	memset(taken, 0, members * sizeof *taken);
	memset(first, 0, (COLOURS_MAX + 2) * sizeof *first);
	choose(sweeper, colours, taken, colour);
	for (int c = 0; c < colours->count; c++)
		first[c + 1] += first[c];
	for (size_t k = 0; k < count; k++)
		order[first[colour[k]]++] = (int)k;
	for (int c = colours->count; c > 0; c--)
		first[c] = first[c - 1];
	first[0] = 0;
	return true;
}

/* ---- sweeps ---- */

static bool is_central(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (!dense->row[k].central)
			return false;
	return true;
}

bool rb_sweeper_take(struct rb_sweeper *sweeper, struct rb_arena *arena)
{
	struct colours colours = {.count = 0};

	sweeper->central = is_central(sweeper->dense);
	sweeper->wide = sweeper->dense->row_count >=
	                        (sweeper->central ? RB_WIDE_CENTRAL_ROWS : RB_WIDE_ROWS) &&
	                (sweeper->central || rb_row_system_is_of_contacts(sweeper->dense));
	if (!sweeper->wide) {
		sweeper->one = (struct rb_sweep){.dense = sweeper->dense,
		                                 .central = sweeper->central,
		                                 .interrupt = sweeper->interrupt};
		sweeper->impulses = rb_arena_take(arena, (size_t)sweeper->member_count + 1,
		                                  sizeof *sweeper->impulses);
		return sweeper->impulses && rb_sweep_take(&sweeper->one, arena);
	}
	if (!colour_rows(sweeper, &colours, arena))
		return false;
	sweeper->many = (struct rb_wide){.dense = sweeper->dense,
	                                 .central = sweeper->central,
	                                 .order = colours.order,
	                                 .fixed = sweeper->fixed,
	                                 .team = sweeper->team,
	                                 .colour = colours.first,
	                                 .colour_count = colours.count,
	                                 .tail = colours.tail,
	                                 .interrupt = sweeper->interrupt};
	return rb_wide_take(&sweeper->many, arena);
}

struct rb_sweep_result rb_sweeper_run(struct rb_sweeper *sweeper, double tolerance, int max)
{
	if (sweeper->wide)
		return rb_wide_solve(&sweeper->many, tolerance, max, false);
	sweeper->one.tolerance = tolerance;
	sweeper->one.max = max;
	return rb_sweep_solve(&sweeper->one);
}

bool rb_sweeper_went_far(const struct rb_sweeper *sweeper)
{
	if (sweeper->wide)
		return false;
	for (int k = 0; k < sweeper->member_count; k++)
		sweeper->local[sweeper->member[k]] = k;
	return rb_sweep_went_far(&sweeper->one, sweeper->local, sweeper->impulses,
	                         sweeper->member_count);
}

struct rb_sweep_result rb_sweeper_hold(struct rb_sweeper *sweeper, double tolerance, int max)
{
	return rb_wide_solve(&sweeper->many, tolerance, max, true);
}
