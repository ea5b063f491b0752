/* SPDX-License-Identifier: MIT */
#include "stepped/sweeper.h"

#include <stdint.h>
#include <string.h>

enum { COLOURS_MAX = 64, LOADED = 128 };

/* ---- colours ---- */

/*
 * Rows in order of colours: no colour has two rows on one dynamic body, unless the last is a tail
 * of the remaining rows.
 */
struct colours {
	int *first;    /* [count + 1]: start of each in `order` */
	int *unloaded; /* [count]: start of its rows without an initial impulse */
	int *order;    /* [rows] */
	int count;
	bool tail;
};

/* Indices of a row's bodies among the members; -1: not dynamic. */
struct ends {
	int a, b;
};

/* Properties of rows found before sweeps, by several threads if there are any. */
struct preparation {
	const struct rb_sweeper *sweeper;
	struct colours *colours;
	struct ends *ends;     /* [rows] */
	uint64_t *used;        /* [members]: bits of the colours of a body's rows */
	unsigned char *colour; /* [rows]; plus LOADED for rows with an initial impulse */
	bool other, eccentric; /* some row is no contact; some row is not central */
};

enum { ROWS_PER_BLOCK = 1024 };

static void run_blocks(struct preparation *preparation, rb_team_part *part)
{
	const size_t count = (size_t)preparation->sweeper->dense->row_count;

	if (preparation->sweeper->team)
		rb_team_share(preparation->sweeper->team, count, ROWS_PER_BLOCK, part, preparation);
	else
		part(preparation, 0, count);
}

static int member_of(const struct rb_sweeper *sweeper, int body)
{
	return sweeper->dense->bodies.body[body].inverse_mass > 0 ? sweeper->local[body] : -1;
}

static void find_ends(void *user, size_t first, size_t end)
{
	const struct preparation *preparation = user;
	const struct rb_sweeper *sweeper = preparation->sweeper;

	for (size_t k = first; k < end; k++) {
		const struct rb_constraint *row = &sweeper->dense->row[k];

		preparation->ends[k] = (struct ends){member_of(sweeper, row->a),
		                                     member_of(sweeper, row->b)};
		preparation->colour[k] = row->impulse.n > 0 ? LOADED : 0;
	}
}

static void choose_colours(const struct preparation *preparation)
{
	struct colours *const colours = preparation->colours;
	uint64_t *const used = preparation->used;

	for (int k = 0; k < preparation->sweeper->dense->row_count; k++) {
		const struct ends ends = preparation->ends[k];
		const uint64_t available = ~((ends.a < 0 ? 0 : used[ends.a]) |
		                             (ends.b < 0 ? 0 : used[ends.b]));
		const int c = available ? __builtin_ctzll(available) : COLOURS_MAX - 1;
		/* the order of a tail matters */
		const bool is_loaded = preparation->colour[k] || c == COLOURS_MAX - 1;

		preparation->colour[k] = (unsigned char)(is_loaded ? LOADED | c : c);
		colours->tail = colours->tail || c == COLOURS_MAX - 1;
		colours->count = c + 1 > colours->count ? c + 1 : colours->count;
		colours->first[c + 1]++;
		colours->unloaded[c] += is_loaded;
		if (ends.a >= 0)
			used[ends.a] |= (uint64_t)1 << c;
		if (ends.b >= 0)
			used[ends.b] |= (uint64_t)1 << c;
	}
}

/*
 * Sorts rows by colour, within a colour first those with an initial impulse, then the others, in
 * their previous order. The order within a colour changes no number, but packs of rows without
 * impulses are cheap: half of the points of rotated boxes stay open.
 */
static void colour_rows(const struct preparation *preparation)
{
	const struct colours *const colours = preparation->colours;
	int *const first = colours->first, *const unloaded = colours->unloaded;
	int *const next[2] = {unloaded, first};

	choose_colours(preparation);
	for (int c = 0; c < colours->count; c++) {
		unloaded[c] += first[c];
		first[c + 1] += first[c];
	}
	for (int k = 0; k < preparation->sweeper->dense->row_count; k++) {
		const int colour = preparation->colour[k];

		colours->order[next[colour >= LOADED][colour % LOADED]++] = k;
	}
	/* each `unloaded` has reached the start of the next colour */
	for (int c = colours->count; c > 0; c--)
		first[c] = unloaded[c - 1];
	first[0] = 0;
}

/* Colouring does not need velocities, nor warm starting colours: both run concurrently. */
static void colour_or_warm(void *user, int block, int worker)
{
	const struct preparation *preparation = user;

	(void)worker;
	if (block == 0)
		colour_rows(preparation);
	else
		rb_sweep_warm(preparation->sweeper->dense);
}

/* The order of rows by colour stays in the arena. False: no memory. */
static bool prepare_packs(struct preparation *preparation, struct rb_arena *arena)
{
	const struct rb_sweeper *sweeper = preparation->sweeper;
	struct colours *const colours = preparation->colours;
	const size_t count = (size_t)sweeper->dense->row_count;
	const size_t members = (size_t)sweeper->member_count;

	colours->first = rb_arena_take(arena, COLOURS_MAX + 2, sizeof *colours->first);
	colours->order = rb_arena_take(arena, count, sizeof *colours->order);
	const rb_arena_mark here = rb_arena_here(arena);
	colours->unloaded = rb_arena_take(arena, COLOURS_MAX, sizeof *colours->unloaded);
	preparation->ends = rb_arena_take(arena, count, sizeof *preparation->ends);
	preparation->used = rb_arena_take(arena, members, sizeof *preparation->used);
	preparation->colour = rb_arena_take(arena, count, 1);
	if (!preparation->ends || !preparation->used || !preparation->colour || !colours->first ||
	    !colours->unloaded || !colours->order)
		return false;
	for (int k = 0; k < sweeper->member_count; k++)
		sweeper->local[sweeper->member[k]] = k;
	memset(preparation->used, 0, members * sizeof *preparation->used);
	memset(colours->first, 0, (COLOURS_MAX + 2) * sizeof *colours->first);
	memset(colours->unloaded, 0, COLOURS_MAX * sizeof *colours->unloaded);
	run_blocks(preparation, find_ends);
	if (sweeper->team && sweeper->warms)
		rb_team_run(sweeper->team, 2, colour_or_warm, preparation);
	else
		colour_rows(preparation);
	rb_arena_back(arena, here);
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

static void find_kinds(void *user, size_t first, size_t end)
{
	struct preparation *preparation = user;
	const struct rb_constraint *const row = preparation->sweeper->dense->row;
	bool other = false, eccentric = false;

	for (size_t k = first; k < end && !(other && eccentric); k++) {
		other = other || row[k].set != RB_CONSTRAINT_CONE;
		eccentric = eccentric || !row[k].central;
	}
	if (other)
		__atomic_store_n(&preparation->other, true, __ATOMIC_RELAXED);
	if (eccentric)
		__atomic_store_n(&preparation->eccentric, true, __ATOMIC_RELAXED);
}

/* Applies the impulses of the rows, if requested. */
static void warm_start(const struct rb_sweeper *sweeper)
{
	if (sweeper->warms)
		rb_sweep_warm(sweeper->dense);
}

bool rb_sweeper_take(struct rb_sweeper *sweeper, struct rb_arena *arena)
{
	struct colours colours = {.count = 0};
	struct preparation preparation = {.sweeper = sweeper, .colours = &colours};

	if (sweeper->team)
		run_blocks(&preparation, find_kinds);
	else
		preparation.eccentric = !is_central(sweeper->dense);
	if (!sweeper->team && preparation.eccentric)
		preparation.other = !rb_row_system_is_of_contacts(sweeper->dense);
	sweeper->central = !preparation.eccentric;
	sweeper->wide = sweeper->dense->row_count >=
	                        (sweeper->central ? RB_WIDE_CENTRAL_ROWS : RB_WIDE_ROWS) &&
	                !preparation.other;
	if (!sweeper->wide) {
		sweeper->gauss_seidel = (struct rb_sweep){.dense = sweeper->dense,
		                                          .central = sweeper->central,
		                                          .interrupt = sweeper->interrupt};
		sweeper->impulses = rb_arena_take(arena, (size_t)sweeper->member_count + 1,
		                                  sizeof *sweeper->impulses);
		if (!sweeper->impulses || !rb_sweep_take(&sweeper->gauss_seidel, arena))
			return false;
		warm_start(sweeper);
		return true;
	}
	if (!prepare_packs(&preparation, arena))
		return false;
	sweeper->packs = (struct rb_wide){.dense = sweeper->dense,
	                                  .central = sweeper->central,
	                                  .order = colours.order,
	                                  .fixed = sweeper->fixed,
	                                  .member = sweeper->member,
	                                  .member_count = sweeper->member_count,
	                                  .team = sweeper->team,
	                                  .colour = colours.first,
	                                  .colour_count = colours.count,
	                                  .tail = colours.tail,
	                                  .interrupt = sweeper->interrupt};
	if (!rb_wide_take(&sweeper->packs, arena))
		return false;
	if (!sweeper->team)
		warm_start(sweeper);
	return true;
}

struct rb_sweep_result rb_sweeper_run(struct rb_sweeper *sweeper, double tolerance, int max)
{
	if (sweeper->wide)
		return rb_wide_solve(&sweeper->packs, tolerance, max, RB_WIDE_FRESH);
	sweeper->gauss_seidel.tolerance = tolerance;
	sweeper->gauss_seidel.max = max;
	return rb_sweep_solve(&sweeper->gauss_seidel);
}

struct rb_sweep_result rb_sweeper_continue(struct rb_sweeper *sweeper, double tolerance, int max,
                                           double slack)
{
	if (!sweeper->wide)
		return rb_sweeper_run(sweeper, tolerance, max);
	sweeper->packs.slack = slack;
	const struct rb_sweep_result result = rb_wide_solve(&sweeper->packs, tolerance, max,
	                                                    RB_WIDE_CONTINUE);
	sweeper->packs.slack = 0;
	return result;
}

bool rb_sweeper_lost_digits(const struct rb_sweeper *sweeper)
{
	if (sweeper->wide)
		return false;
	for (int k = 0; k < sweeper->member_count; k++)
		sweeper->local[sweeper->member[k]] = k;
	return rb_sweep_lost_digits(&sweeper->gauss_seidel, sweeper->local, sweeper->impulses,
	                            sweeper->member_count);
}

struct rb_sweep_result rb_sweeper_hold_friction(struct rb_sweeper *sweeper, double tolerance,
                                                int max)
{
	return rb_wide_solve(&sweeper->packs, tolerance, max, RB_WIDE_HOLD_FRICTION);
}

struct rb_sweep_result rb_sweeper_continue_undamped(struct rb_sweeper *sweeper, double tolerance,
                                                    int max)
{
	return rb_wide_solve(&sweeper->packs, tolerance, max, RB_WIDE_CONTINUE_UNDAMPED);
}
