/* SPDX-License-Identifier: MIT */
/*
 * Contacts and other constraints between bodies as one complementarity problem: velocities (or
 * accelerations) and impulses (or forces).
 *
 * For every row, with u the relative velocity of its points plus its bias less its target, what
 * constraint/row says of its set. CONE: u_n >= 0, push >= 0, one of them zero; across the normal no
 * velocity, or friction at the cone against it (`slide`: against `slip`, whatever it is; `given`:
 * the push is what it is, and friction is bounded by it). FREE: u = 0, always closed and sticking.
 * INTERVAL: u_n = 0 while its impulse is between its bounds (`given`: it is what it is). The two
 * leave the problem convex.
 *
 * Solved on the bodies' velocities themselves, which only ever get increments, so that they are
 * right also where impulses nearly cancel (a light body between heavy ones). Arithmetic is free of
 * order and of handedness (constraint/exact_sum; nothing is used before all of it is found).
 *
 * All arrays are the caller's or from its arena; rb_cone_open fills the scratch, which ends with
 * the arena's mark.
 */
#ifndef RB_CONSTRAINT_CONE_H
#define RB_CONSTRAINT_CONE_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/*
 * What is asked of a row across its normal: the impulse is known; no slip; at the cone; push times
 * `slip`.
 */
enum rb_cone_apply_friction { RB_CONE_KNOWN, RB_CONE_STICK, RB_CONE_SLIP, RB_CONE_FOLLOW };

struct rb_cone_row {
	/* not central; impulse in: already in the bodies' velocities; its masses are not read */
	struct rb_constraint base;
	/* m/s^2, forces: of u what is not the bodies' accelerations at their points */
	rb_vec3 bias;
	rb_vec3 slip; /* slide: a unit vector */
	bool slide;   /* CONE */
	bool given;   /* CONE, INTERVAL: the normal impulse is what it is */
	/*
	 * Impacts, of an INTERVAL [0, inf): a limit or a rope. Below `noise`, m/s, it does not
	 * approach; out: m/s at its first impact, 0: it had none.
	 */
	double restitution, noise, approach;

	/* scratch */
	rb_along_across u;       /* less the target */
	double bound_n, bound_t; /* 1/kg: bounds that make simultaneous steps safe */
	double limit;            /* N s: of friction, while it is held fixed */
	bool closed;             /* the normal impulse is an unknown, u_n = 0 asked for */
	enum rb_cone_apply_friction friction_impulse;
	rb_vec3 along; /* slip: direction of the friction that is at its limit */
	double share;  /* slip: of the friction that was asked for, what the cone allows */
};

/* constraint/joint_factor: rows of the lower half of a matrix, from their first columns on: L. */
struct rb_joint_factor {
	bool tried, ready;
	int count;                   /* unknowns */
	int *place;                  /* [row_count + body_count]: of each row's first unknown */
	int *first;                  /* [count]: column that a row reaches back to */
	size_t *start;               /* [count]: of rows in `value` */
	double *value, *inverse, *x; /* L; [count]: of D, 0 where a row is left out; [count] */
};

struct rb_cone {
	struct rb_solver_bodies bodies; /* inverse inertias as roots */
	int body_count;
	struct rb_cone_row *row;
	int row_count;
	struct rb_arena *arena;

	/* scratch */
	int *first, *entry; /* [body_count + 1], [2 row_count]: rows of a body, 2 row + side */
	rb_vec3 *linear, *angular; /* [body_count]: increments */
	double *term;              /* [6 x largest number of rows of a body, or 4 row_count] */
	rb_along_across *change, *residual, *best, *before; /* [row_count] */
	struct rb_cone_row *faces;                          /* [row_count] */
	struct rb_solver_body *kept, *snapped;              /* [body_count] */
	rb_along_across *direction, *image;                 /* [window][row_count] */
	int window;
	struct rb_joint_factor joints;
	rb_along_across *undone, *weighed; /* [row_count], [window][row_count]: once it is ready */
	bool held; /* friction is bounded by `limit`, not by the cone: then the problem is convex */
	bool probes;   /* where steps from the guess find no solution, none is wanted */
	bool gave_way; /* friction was less than the law says, because the law found no solution */
	double tolerance; /* in the unit of u: what may be left; 0: rounding */
	long iterations;  /* products with the matrix, so far */
	long max;         /* of them, after which it ends with what it has; 0: no limit */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

static inline bool rb_cone_is_over(const struct rb_cone *cone)
{
	return (cone->max > 0 && cone->iterations > cone->max) ||
	       rb_interrupt_is_set(cone->interrupt);
}

/*
 * False when memory is out. Bodies and rows are filled; may be called again after rows have changed
 * their number.
 */
bool rb_cone_open(struct rb_cone *cone);

/* Relative velocity of the points of a row, plus its bias, less its target. */
rb_along_across rb_cone_velocity(const struct rb_cone *cone, const struct rb_cone_row *row);

/* Adds impulses to the bodies' velocities and to the rows; `u` of the rows is then out of date. */
void rb_cone_apply_normal(struct rb_cone *cone, const rb_along_across *impulse);

/* sum of a.b over the rows */
double rb_cone_dot(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b);

/*
 * The same in the metric in which a row's step is as large as what it does: rows of heavy and light
 * bodies compare.
 */
double rb_cone_weighted(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b);

/*
 * Increments of all bodies by impulses on all rows, into cone->linear and angular; and what those
 * do to a row.
 */
void rb_cone_respond(struct rb_cone *cone, const rb_along_across *impulse);
rb_along_across rb_cone_felt(const struct rb_cone *cone, const struct rb_cone_row *row);

#endif
