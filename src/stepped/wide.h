/* SPDX-License-Identifier: MIT */
/*
 * Contacts (CONE rows) by iteration, four at a time: sweeps as in stepped/gauss_seidel over packs
 * of rows that share no body, each impulse then led on along the way it goes (Nesterov's momentum,
 * Soviet Math. Doklady 27 (1983) 372, for each row on its own: a row that turns round loses half of
 * what it has gathered, B. O'Donoghue and E. Candes, Found. Comput. Math. 15 (2015) 715).
 *
 * Jammed heaps have rows enough that change their face in every sweep; a mixture of earlier sweeps
 * has then to be forgotten as often, momentum has not. Blocks are of packs, so what comes out does
 * not depend on the workers.
 */
#ifndef RB_STEPPED_WIDE_H
#define RB_STEPPED_WIDE_H

#include "base/team.h"
#include "stepped/gauss_seidel.h"
#include "stepped/packs.h"

struct rb_wide {
	const struct rb_row_system *dense;
	bool central;      /* all rows are: packs are smaller */
	const int *order;  /* [rows]: these by colour */
	int fixed;         /* a body that does not yield */
	const int *member; /* [member_count]: bodies that do */
	int member_count;
	struct rb_team *team; /* NULL: in one thread */
	const int *colour;    /* [colour_count + 1]: where each begins in `order` */
	int colour_count;
	bool tail; /* rows of the last colour share bodies after all: one after the other */
	/* scratch, rb_wide_take */
	struct rb_packs packs[2]; /* in 64 bits, in 32 bits: one of them is filled */
	bool single;              /* the latter are under way */
	/*
	 * More than 0: sweeps that would not reach the tolerance soon are left once they are
	 * within so many tolerances, from where others (`holds`) go on.
	 */
	double slack;
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

/* Bytes of scratch for a row. */
size_t rb_wide_row_bytes(bool central, bool tensors);

/* Scratch, once the rest is known; false: no memory. */
bool rb_wide_take(struct rb_wide *wide, struct rb_arena *arena);

/*
 * From the impulses that the rows have, which the bodies feel already. GOES_ON: as the call before
 * has left them, with the way that it has gathered. PRESSES_ON: so, and rows are led on as far as
 * may be to the end: where impulses creep on together, little changes until one of them slips or
 * opens, and what is led on by less comes to a stop before. HOLDS: what acts across the normals
 * stays as it is, and no normal impulse falls below what holds it within the cone.
 */
enum rb_wide_start { RB_WIDE_FRESH, RB_WIDE_GOES_ON, RB_WIDE_HOLDS, RB_WIDE_PRESSES_ON };
struct rb_sweep_result rb_wide_solve(struct rb_wide *wide, double tolerance, int max,
                                     enum rb_wide_start start);

#endif
