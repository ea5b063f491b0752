/* SPDX-License-Identifier: MIT */
/*
 * Contacts in packs of rows that share no body, for stepped/wide: their arithmetic in numbers of 64
 * bits, four at a time, and of 32, eight at a time (stepped/pack_kernel has both from one source).
 *
 * Those of 32 bits take half of the memory, which limits the sweeps of large islands. Their units
 * are powers of two of the problem's own, so that no masses, lengths or speeds are out of range,
 * and results scale exactly with all of them. Final impulses are projected onto the cones, and
 * velocities computed from them, in 64 bits: only the convergence criterion has fewer digits.
 */
#ifndef RB_STEPPED_PACKS_H
#define RB_STEPPED_PACKS_H

#include "base/arena.h"
#include "base/team.h"
#include "constraint/row.h"

struct rb_wide;

/* Task for every pack; the first load also fills the constant data. */
enum rb_pack_task { RB_PACK_SWEEP, RB_PACK_LOAD, RB_PACK_LOAD_HELD, RB_PACK_STORE };

/* Packs of one kind of numbers, by colour; scratch. */
struct rb_packs {
	const struct rb_pack_kernel *kernel;
	void *pack, *turn; /* [packs], shared by both kinds; no `turn`: all rows are central */
	/* [packs]; NULL: all rows are central, or all inertias multiples of one */
	void *tensors;
	float (*body)[8]; /* bodies in 32 bits, with inverse mass and inertia; or NULL */
	int *first;       /* [colours + 1]: first pack of each colour */
	int *first_block; /* the same of blocks */
	int *phase;       /* [phase_count + 1]: first colour of each phase */
	int phase_count;
	int *blocks;     /* [2 phase_count]: of each phase, for two passes */
	double *partial; /* [blocks] */
	/* conversion factors to packs, powers of two; 1 in 64 bits */
	double per_mass, per_length, per_speed; /* of kg, m, m/s */
	bool filled;                            /* constant data are loaded */
};

struct rb_pack_kernel {
	int width; /* rows of a pack */
	size_t pack_bytes, turn_bytes, tensors_bytes;
	/*
	 * Loads or stores pack k, whose rows are `count` of the wide's order from `at` on; not
	 * SWEEP.
	 */
	void (*transfer)(const struct rb_wide *wide, const struct rb_packs *packs,
	                 enum rb_pack_task task, int k, int at, int count);
	/*
	 * Extrapolates by up to this fraction, or, if it is 0, solves all; returns the square of
	 * the largest change of a row's velocity.
	 */
	double (*run)(const struct rb_wide *wide, const struct rb_packs *packs, double momentum,
	              int first, int end);
};

extern const struct rb_pack_kernel rb_pack_double, rb_pack_single;

#endif
