/* SPDX-License-Identifier: MIT */
/*
 * Contacts in packs of rows that share no body, for stepped/wide: their arithmetic in numbers of 64
 * bits, four at a time, and of 32, eight at a time (stepped/pack_kernel has both from one source).
 *
 * Those of 32 bits take half of the memory, and sweeps of large groups wait for that. Their units
 * are powers of two of the problem's own, so that no masses, lengths or speeds are out of range,
 * and what comes out scales with all of them. Impulses that they end with are put within the cones,
 * and velocities made from them, in 64 bits: only how far a sweep gets is told in fewer digits.
 */
#ifndef RB_STEPPED_PACKS_H
#define RB_STEPPED_PACKS_H

#include "base/arena.h"
#include "base/team.h"
#include "constraint/row.h"

struct rb_wide;

/* What is done to every pack: what is loaded first is filled, too. */
enum rb_pack_task { RB_PACK_SWEEP, RB_PACK_LOAD, RB_PACK_LOAD_HELD, RB_PACK_STORE };

/* Packs of one kind of numbers, by colour; scratch. */
struct rb_packs {
	const struct rb_pack_kernel *kernel;
	void *pack, *turn; /* [packs], shared by both kinds; no `turn`: all rows are central */
	/* [packs]; NULL: all rows are central, or all inertias multiples of one */
	void *tensors;
	float (*body)[8]; /* bodies in 32 bits, and what they are turned and moved by; or NULL */
	int *first;       /* [colours + 1]: first pack of each colour */
	int *first_block; /* the same of blocks */
	int *phase;       /* [phase_count + 1]: first colour of each phase */
	int phase_count;
	int *blocks;     /* [2 phase_count]: of each phase, for two passes */
	double *partial; /* [blocks] */
	/* what numbers are multiplied by: powers of two; 1 in 64 bits */
	double per_mass, per_length, per_speed; /* of kg, m, m/s */
	bool filled;                            /* all that no sweep changes is there */
};

struct rb_pack_kernel {
	int width; /* rows of a pack */
	size_t pack_bytes, turn_bytes, tensors_bytes;
	/* Pack k, whose rows are `count` of the wide's order from `at` on; no SWEEP. */
	void (*carry)(const struct rb_wide *wide, const struct rb_packs *packs,
	              enum rb_pack_task task, int k, int at, int count);
	/*
	 * Leads on by this share at most, or, where it is 0, solves all; returns the square of the
	 * largest change of a row's velocity.
	 */
	double (*run)(const struct rb_wide *wide, const struct rb_packs *packs, double lead,
	              int first, int end);
};

extern const struct rb_pack_kernel rb_pack_double, rb_pack_single;

#endif
