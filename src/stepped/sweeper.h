/* SPDX-License-Identifier: MIT */
/*
 * Sweeps over the rows of one island: packs of rows (stepped/wide) in an order of colours if there
 * are enough and all are contacts, else one row at a time (stepped/gauss_seidel). Created for one
 * solution; memory is in the arena.
 */
#ifndef RB_STEPPED_SWEEPER_H
#define RB_STEPPED_SWEEPER_H

#include "stepped/wide.h"

/*
 * Rows from which on an island is solved in packs: of spheres, and of bodies of other shapes, of
 * which small stacks converge far sooner by Anderson mixing.
 */
enum { RB_WIDE_CENTRAL_ROWS = 32, RB_WIDE_ROWS = 128 };

struct rb_sweeper {
	const struct rb_row_system *dense;
	int fixed;         /* a static body */
	const int *member; /* dynamic bodies */
	int member_count;
	int *local;           /* by body: scratch, -1 if not dynamic */
	struct rb_team *team; /* for packs; NULL: in one thread */
	/* velocities do not include the rows' impulses yet: `take` applies them */
	bool warms;
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	/* rb_sweeper_take */
	bool wide, central; /* central: of spheres alone */
	struct rb_sweep gauss_seidel;
	double (*impulses)[2]; /* [members]: scratch of `one` */
	struct rb_wide packs;
};

/* Takes memory, once the fields before are set; false: no memory. */
bool rb_sweeper_take(struct rb_sweeper *sweeper, struct rb_arena *arena);

struct rb_sweep_result rb_sweeper_run(struct rb_sweeper *sweeper, double tolerance, int max);
/*
 * Continues from where that has ended, with nothing changed: wide ones keep their momentum, and
 * with a slack (see rb_wide) end when they only creep.
 */
struct rb_sweep_result rb_sweeper_continue(struct rb_sweeper *sweeper, double tolerance, int max,
                                           double slack);
/* Wide ones only: continues likewise, with the largest momentum, however little changes. */
struct rb_sweep_result rb_sweeper_continue_undamped(struct rb_sweeper *sweeper, double tolerance,
                                                    int max);
/*
 * Whether velocities have rounding errors beyond those of the impulses, and must be recomputed from
 * these. Never for wide ones.
 */
bool rb_sweeper_lost_digits(const struct rb_sweeper *sweeper);
/* Wide ones only: with tangential impulses held as they are. */
struct rb_sweep_result rb_sweeper_hold_friction(struct rb_sweeper *sweeper, double tolerance,
                                                int max);

#endif
