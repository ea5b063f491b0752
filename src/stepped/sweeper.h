/* SPDX-License-Identifier: MIT */
/*
 * Sweeps over the rows of one group: packs of rows (stepped/wide) in an order of colours where
 * there are enough and all are contacts, else one row at a time (stepped/gauss_seidel). Made for
 * one solution; memory is the arena's.
 */
#ifndef RB_STEPPED_SWEEPER_H
#define RB_STEPPED_SWEEPER_H

#include "stepped/wide.h"

/*
 * Rows from which on a group is solved in packs: of spheres, and of bodies of other shapes, of
 * which stacks of a few come to an end far sooner by a mixture of sweeps.
 */
enum { RB_WIDE_CENTRAL_ROWS = 32, RB_WIDE_ROWS = 128 };

struct rb_sweeper {
	const struct rb_row_system *dense;
	int fixed;         /* a body that does not yield */
	const int *member; /* bodies that yield */
	int member_count;
	int *local;           /* by body: scratch, -1 for what does not yield */
	struct rb_team *team; /* of packs; NULL: in one thread */
	bool warms;           /* bodies do not feel the rows' impulses yet: `take` makes them */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	/* rb_sweeper_take */
	bool wide, central; /* central: of spheres alone */
	struct rb_sweep one;
	double (*impulses)[2]; /* [members]: scratch of `one` */
	struct rb_wide many;
};

/* Once what stands first is known; false: no memory. */
bool rb_sweeper_take(struct rb_sweeper *sweeper, struct rb_arena *arena);

struct rb_sweep_result rb_sweeper_run(struct rb_sweeper *sweeper, double tolerance, int max);
/*
 * From where that has ended, nothing having changed: wide ones keep the way that they go, and with
 * a slack (see rb_wide) end where they only creep.
 */
struct rb_sweep_result rb_sweeper_go_on(struct rb_sweeper *sweeper, double tolerance, int max,
                                        double slack);
/* Wide ones only: so, and led on as far as that goes, however little changes. */
struct rb_sweep_result rb_sweeper_press_on(struct rb_sweeper *sweeper, double tolerance, int max);
/*
 * Velocities have rounding beyond that of the impulses: to be made of these anew. Never of wide
 * ones.
 */
bool rb_sweeper_went_far(const struct rb_sweeper *sweeper);
/* Wide ones only: with what acts across the normals as it is. */
struct rb_sweep_result rb_sweeper_hold(struct rb_sweeper *sweeper, double tolerance, int max);

#endif
