/* SPDX-License-Identifier: MIT */
#include "stepped/sweeper.h"

#include <stdint.h>
#include <string.h>

enum { COLOURS_MAX = 64, BEARS = 128 };

/* ---- colours ---- */

/*
 * Rows in order of colours: none has two rows on one body that yields, unless the last is a tail of
 * what is left over.
 */
struct colours {
	int *first; /* [count + 1]: where each begins in `order` */
	int *other; /* [count]: the same of those that bear nothing to begin with */
	int *order; /* [rows] */
	int count;
	bool tail;
};

/* Places of a row's bodies among those that yield; -1: it does not. */
struct ends {
	int a, b;
};

/* What is known of the rows before they are swept, by several threads where there are. */
struct preparation {
	const struct rb_sweeper *sweeper;
	struct colours *colours;
	struct ends *ends;     /* [rows] */
	uint64_t *taken;       /* [members]: colours of a body's rows, as bits */
	unsigned char *colour; /* [rows]; and BEARS, of those that bear something to begin with */
	bool other, eccentric; /* somewhere there is no contact, or one that is not central */
};

enum { ROWS_PER_BLOCK = 1024 };

static void share_out(struct preparation *preparation, rb_team_part *part)
{
	const size_t count = (size_t)preparation->sweeper->dense->row_count;

	if (preparation->sweeper->team)
		rb_team_share(preparation->sweeper->team, count, ROWS_PER_BLOCK, part, preparation);
	else
		part(preparation, 0, count);
}

static int place_of(const struct rb_sweeper *sweeper, int body)
{
	return sweeper->dense->bodies.body[body].inverse_mass > 0 ? sweeper->local[body] : -1;
}

static void find_ends(void *user, size_t first, size_t end)
{
	const struct preparation *preparation = user;
	const struct rb_sweeper *sweeper = preparation->sweeper;

	for (size_t k = first; k < end; k++) {
		const struct rb_constraint *row = &sweeper->dense->row[k];

		preparation->ends[k] = (struct ends){place_of(sweeper, row->a),
		                                     place_of(sweeper, row->b)};
		preparation->colour[k] = row->impulse.n > 0 ? BEARS : 0;
	}
}

static void choose(const struct preparation *preparation)
{
	struct colours *const colours = preparation->colours;
	uint64_t *const taken = preparation->taken;

	for (int k = 0; k < preparation->sweeper->dense->row_count; k++) {
		const struct ends ends = preparation->ends[k];
		const uint64_t left = ~((ends.a < 0 ? 0 : taken[ends.a]) |
		                        (ends.b < 0 ? 0 : taken[ends.b]));
		const int c = left ? __builtin_ctzll(left) : COLOURS_MAX - 1;
		/* a tail's order counts */
		const bool bears = preparation->colour[k] || c == COLOURS_MAX - 1;

		preparation->colour[k] = (unsigned char)(bears ? BEARS | c : c);
		colours->tail = colours->tail || c == COLOURS_MAX - 1;
		colours->count = c + 1 > colours->count ? c + 1 : colours->count;
		colours->first[c + 1]++;
		colours->other[c] += bears;
		if (ends.a >= 0)
			taken[ends.a] |= (uint64_t)1 << c;
		if (ends.b >= 0)
			taken[ends.b] |= (uint64_t)1 << c;
	}
}

/*
 * Rows by colour; of one colour first those that bear something to begin with, then the others, as
 * they stood. The order within a colour changes no number, but packs of rows that bear nothing are
 * soon done with: of turned boxes half of the points stay open.
 */
static void colour_rows(const struct preparation *preparation)
{
	const struct colours *const colours = preparation->colours;
	int *const first = colours->first, *const other = colours->other;
	int *const next[2] = {other, first};

	choose(preparation);
	for (int c = 0; c < colours->count; c++) {
		other[c] += first[c];
		first[c + 1] += first[c];
	}
	for (int k = 0; k < preparation->sweeper->dense->row_count; k++) {
		const int colour = preparation->colour[k];

		colours->order[next[colour >= BEARS][colour % BEARS]++] = k;
	}
	/* all others have come to where the next colour begins */
	for (int c = colours->count; c > 0; c--)
		first[c] = other[c - 1];
	first[0] = 0;
}

/* Colours do not ask for velocities, nor what makes these for colours. */
static void colour_or_warm(void *user, int block, int worker)
{
	const struct preparation *preparation = user;

	(void)worker;
	if (block == 0)
		colour_rows(preparation);
	else
		rb_sweep_warm(preparation->sweeper->dense);
}

/* False: no memory. */
static bool prepare_packs(struct preparation *preparation, struct rb_arena *arena)
{
	const struct rb_sweeper *sweeper = preparation->sweeper;
	struct colours *const colours = preparation->colours;
	const size_t count = (size_t)sweeper->dense->row_count;
	const size_t members = (size_t)sweeper->member_count;

	preparation->ends = rb_arena_take(arena, count, sizeof *preparation->ends);
	preparation->taken = rb_arena_take(arena, members, sizeof *preparation->taken);
	preparation->colour = rb_arena_take(arena, count, 1);
	colours->first = rb_arena_take(arena, COLOURS_MAX + 2, sizeof *colours->first);
	colours->other = rb_arena_take(arena, COLOURS_MAX, sizeof *colours->other);
	colours->order = rb_arena_take(arena, count, sizeof *colours->order);
	if (!preparation->ends || !preparation->taken || !preparation->colour || !colours->first ||
	    !colours->other || !colours->order)
		return false;
	for (int k = 0; k < sweeper->member_count; k++)
		sweeper->local[sweeper->member[k]] = k;
	memset(preparation->taken, 0, members * sizeof *preparation->taken);
	memset(colours->first, 0, (COLOURS_MAX + 2) * sizeof *colours->first);
	memset(colours->other, 0, COLOURS_MAX * sizeof *colours->other);
	share_out(preparation, find_ends);
	if (sweeper->team && sweeper->warms)
		rb_team_run(sweeper->team, 2, colour_or_warm, preparation);
	else
		colour_rows(preparation);
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

/* Velocities that the impulses of the rows make, if they are asked for. */
static void warm(const struct rb_sweeper *sweeper)
{
	if (sweeper->warms)
		rb_sweep_warm(sweeper->dense);
}

bool rb_sweeper_take(struct rb_sweeper *sweeper, struct rb_arena *arena)
{
	struct colours colours = {.count = 0};
	struct preparation preparation = {.sweeper = sweeper, .colours = &colours};

	if (sweeper->team)
		share_out(&preparation, find_kinds);
	else
		preparation.eccentric = !is_central(sweeper->dense);
	if (!sweeper->team && preparation.eccentric)
		preparation.other = !rb_row_system_is_of_contacts(sweeper->dense);
	sweeper->central = !preparation.eccentric;
	sweeper->wide = sweeper->dense->row_count >=
	                        (sweeper->central ? RB_WIDE_CENTRAL_ROWS : RB_WIDE_ROWS) &&
	                !preparation.other;
	if (!sweeper->wide) {
		sweeper->one = (struct rb_sweep){.dense = sweeper->dense,
		                                 .central = sweeper->central,
		                                 .interrupt = sweeper->interrupt};
		sweeper->impulses = rb_arena_take(arena, (size_t)sweeper->member_count + 1,
		                                  sizeof *sweeper->impulses);
		if (!sweeper->impulses || !rb_sweep_take(&sweeper->one, arena))
			return false;
		warm(sweeper);
		return true;
	}
	if (!prepare_packs(&preparation, arena))
		return false;
	sweeper->many = (struct rb_wide){.dense = sweeper->dense,
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
	if (!rb_wide_take(&sweeper->many, arena))
		return false;
	if (!sweeper->team)
		warm(sweeper);
	return true;
}

struct rb_sweep_result rb_sweeper_run(struct rb_sweeper *sweeper, double tolerance, int max)
{
	if (sweeper->wide)
		return rb_wide_solve(&sweeper->many, tolerance, max, RB_WIDE_FRESH);
	sweeper->one.tolerance = tolerance;
	sweeper->one.max = max;
	return rb_sweep_solve(&sweeper->one);
}

struct rb_sweep_result rb_sweeper_go_on(struct rb_sweeper *sweeper, double tolerance, int max,
                                        double slack)
{
	if (!sweeper->wide)
		return rb_sweeper_run(sweeper, tolerance, max);
	sweeper->many.slack = slack;
	const struct rb_sweep_result result = rb_wide_solve(&sweeper->many, tolerance, max,
	                                                    RB_WIDE_GOES_ON);
	sweeper->many.slack = 0;
	return result;
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
	return rb_wide_solve(&sweeper->many, tolerance, max, RB_WIDE_HOLDS);
}

struct rb_sweep_result rb_sweeper_press_on(struct rb_sweeper *sweeper, double tolerance, int max)
{
	return rb_wide_solve(&sweeper->many, tolerance, max, RB_WIDE_PRESSES_ON);
}
