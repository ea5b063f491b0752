/* SPDX-License-Identifier: MIT */
/*
 * Contacts (CONE rows) by iteration, four at a time: sweeps as in stepped/gauss_seidel over packs
 * of rows that share no body, each impulse extrapolated along its last change (Nesterov's momentum,
 * Soviet Math. Doklady 27 (1983) 372, for each row on its own: a row that reverses loses half of
 * its momentum, B. O'Donoghue and E. Candes, Found. Comput. Math. 15 (2015) 715).
 *
 * Jammed heaps have enough rows that some change between sticking, slipping and open in every
 * sweep; a mixture of earlier sweeps would have to be discarded as often, momentum need not be.
 * Blocks consist of packs, so results do not depend on the workers.
 */
#ifndef RB_STEPPED_WIDE_H
#define RB_STEPPED_WIDE_H

#include "base/team.h"
#include "stepped/gauss_seidel.h"
#include "stepped/packs.h"

struct rb_wide {
	const struct rb_row_system *dense;
	bool central;      /* all rows are central: packs are smaller */
	const int *order;  /* [rows]: indices by colour */
	int fixed;         /* a static body */
	const int *member; /* [member_count]: dynamic bodies */
	int member_count;
	struct rb_team *team; /* NULL: in one thread */
	const int *colour;    /* [colour_count + 1]: start of each in `order` */
	int colour_count;
	bool tail; /* rows of the last colour share bodies: solved one after the other */
	/* scratch, rb_wide_take */
	struct rb_packs packs[2]; /* in 64 bits, in 32 bits: one of them is filled */
	bool single;              /* the latter are in use */
	/*
	 * If positive: sweeps that would not reach the tolerance soon end once the residual is
	 * within so many tolerances; friction is held from there on.
	 */
	double slack;
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

/* Bytes of scratch for a row. */
size_t rb_wide_row_bytes(bool central, bool tensors);

/* Takes scratch, once the rest is set; false: no memory. */
bool rb_wide_take(struct rb_wide *wide, struct rb_arena *arena);

/*
 * Starts from the impulses of the rows, which the bodies' velocities include already. CONTINUE:
 * from where the call before ended, with its momentum. CONTINUE_UNDAMPED: likewise, with the
 * largest momentum to the end: where impulses creep together, little changes until one contact
 * slips or opens, and less momentum stalls before that. HOLD_FRICTION: tangential impulses stay as
 * they are, and no normal impulse falls below the one whose cone contains them.
 */
enum rb_wide_start {
	RB_WIDE_FRESH,
	RB_WIDE_CONTINUE,
	RB_WIDE_HOLD_FRICTION,
	RB_WIDE_CONTINUE_UNDAMPED
};
struct rb_sweep_result rb_wide_solve(struct rb_wide *wide, double tolerance, int max,
                                     enum rb_wide_start start);

#endif
