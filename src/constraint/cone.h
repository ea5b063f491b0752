/* SPDX-License-Identifier: MIT */
/*
 * Contacts and other constraints between bodies as one complementarity problem: velocities (or
 * accelerations) and impulses (or forces).
 *
 * Each row satisfies the condition of its set (constraint/row), with u the relative velocity of its
 * points plus its bias minus its target. CONE: u_n >= 0, p_n >= 0, complementary; no tangential
 * velocity, or friction at the cone opposite to it (`slide`: opposite to `slip` whatever u is;
 * `given`: the normal impulse is fixed and bounds friction). FREE: u = 0, always closed and
 * sticking. INTERVAL: u_n = 0 while its impulse is between its bounds (`given`: it is fixed). FREE
 * and INTERVAL leave the problem convex.
 *
 * Solved in the bodies' velocities, which only receive increments, so that they are accurate even
 * where impulses nearly cancel (a light body between heavy ones). The arithmetic does not depend on
 * order or handedness (constraint/exact_sum; no result is used before all are computed).
 *
 * All arrays are the caller's or from its arena; rb_cone_open takes the scratch, which lives until
 * the arena is reset to its mark.
 */
#ifndef RB_CONSTRAINT_CONE_H
#define RB_CONSTRAINT_CONE_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/*
 * Condition of a row across its normal: known impulse; no slip; at the cone; `slip` times the
 * normal impulse.
 */
enum rb_cone_friction { RB_CONE_KNOWN, RB_CONE_STICK, RB_CONE_SLIP, RB_CONE_FOLLOW };

struct rb_cone_row {
	/* not central; impulse in: already applied to the bodies; effective masses are not read */
	struct rb_constraint base;
	/* forces: m/s^2, part of u that is not the bodies' accelerations at their points */
	rb_vec3 bias;
	rb_vec3 slip; /* slide: a unit vector */
	bool slide;   /* CONE */
	bool given;   /* CONE, INTERVAL: the normal impulse is fixed */
	/*
	 * Impacts, for an INTERVAL [0, inf), a limit or a rope. At a speed below `noise`, m/s, it
	 * does not approach. `approach`, out: m/s at its first impact, 0: it had none.
	 */
	double restitution, noise, approach;

	/* scratch */
	rb_along_across u;       /* minus the target */
	double bound_n, bound_t; /* 1/kg: bounds with which simultaneous steps converge */
	double limit;            /* N s: bound of friction, while it is held fixed */
	bool closed;             /* active: the normal impulse is an unknown of u_n = 0 */
	enum rb_cone_friction friction_impulse;
	rb_vec3 along; /* slip: direction of the friction at its limit */
	double share;  /* slip: share of the trial friction that the cone allows */
};

/* constraint/joint_factor: the lower triangle L by rows, each from its first non-zero column on. */
struct rb_joint_factor {
	bool attempted, ready;
	int count;     /* unknowns */
	int *place;    /* [row_count + body_count]: index of each row's first unknown */
	int *first;    /* [count]: first non-zero column of a row */
	size_t *start; /* [count]: start of a row in `value` */
	double *value, *inverse, *x; /* L; [count]: 1 / D, 0 for a row that is left out; [count] */
};

struct rb_cone {
	struct rb_solver_bodies bodies; /* inverse inertias by their roots */
	int body_count;
	struct rb_cone_row *row;
	int row_count;
	struct rb_arena *arena;

	/* scratch */
	int *first, *entry; /* [body_count + 1], [2 row_count]: a body's rows as 2 row + side */
	rb_vec3 *linear, *angular; /* [body_count]: increments */
	double *term;              /* [the larger of 6 x most rows of a body and 4 row_count] */
	rb_along_across *change, *residual, *best, *before; /* [row_count] */
	struct rb_cone_row *faces;                          /* [row_count] */
	struct rb_solver_body *kept, *snapped;              /* [body_count] */
	rb_along_across *direction, *image;                 /* [window][row_count] */
	int window;
	struct rb_joint_factor joints;
	/* [row_count], [window][row_count]: once `joints` is ready */
	rb_along_across *preconditioned, *preconditioned_image;
	bool held;   /* `limit` bounds friction, not the cone: then the problem is convex */
	bool probes; /* if steps from the guess find no solution, look no further */
	bool friction_reduced; /* no solution of the law was found */
	double tolerance;      /* in the unit of u: largest residual; 0: rounding */
	long iterations;       /* matrix-vector products so far */
	long max; /* limit of `iterations`, after which the best so far is kept; 0: none */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

static inline bool rb_cone_is_over(const struct rb_cone *cone)
{
	return (cone->max > 0 && cone->iterations > cone->max) ||
	       rb_interrupt_is_set(cone->interrupt);
}

/*
 * Prepares a problem whose bodies and rows are filled; may be called again after the number of rows
 * has changed. False: out of memory.
 */
bool rb_cone_open(struct rb_cone *cone);

/* Relative velocity of the points of a row, plus its bias, minus its target. */
rb_along_across rb_cone_velocity(const struct rb_cone *cone, const struct rb_cone_row *row);

/* Adds impulses to the bodies' velocities and to the rows; `u` of the rows is then out of date. */
void rb_cone_apply(struct rb_cone *cone, const rb_along_across *impulse);

/* Returns the sum of a.b over the rows. */
double rb_cone_dot(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b);

/*
 * The same, weighted by the rows' bounds: a step counts by the velocity that it changes, so that
 * rows of heavy and light bodies are comparable.
 */
double rb_cone_weighted(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b);

/*
 * Computes the velocity increments of all bodies by impulses on all rows, into cone->linear and
 * angular; and returns the change of a row's velocity by them.
 */
void rb_cone_respond(struct rb_cone *cone, const rb_along_across *impulse);
rb_along_across rb_cone_row_change(const struct rb_cone *cone, const struct rb_cone_row *row);

#endif
