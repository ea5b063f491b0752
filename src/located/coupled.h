/* SPDX-License-Identifier: MIT */
/*
 * Equations of constraints that share bodies: rows of joints, and contacts in their modes.
 *
 * Each row has a Jacobian J_i, a combination of its bodies' velocities (or accelerations), and an
 * unknown, which scales a wrench W_i on both bodies. The matrix J_i M^-1 W_j is filled through
 * lists of rows by body: entries of rows that share no body are zero, and skipped by math/dense.
 * Rows are in the order of their bodies' places; for a chain of consecutive bodies the matrix is a
 * band.
 *
 * All arrays are from the arena of the located method, or the caller's.
 */
#ifndef RB_LOCATED_COUPLED_H
#define RB_LOCATED_COUPLED_H

#include "located/located.h"
#include "math/dense.h"
#include "math/envelope.h"

/*
 * linear acts on b's velocity and its negative on a's, angular_a and angular_b on spins: signs as
 * in geom/linkage
 */
struct rb_coupled_wrench {
	rb_vec3 linear, angular_a, angular_b;
};

/* A row's Jacobian for one body, and the effect of its unknown on it. */
struct rb_coupled_side {
	rb_vec3 jacobian_linear, jacobian_angular; /* by velocity and spin */
	/* force and torque per unit; after rb_coupled_respond the changes of the velocities */
	rb_vec3 linear, angular;
};

/* A row in the list of a body. */
struct rb_coupled_at {
	const struct rb_coupled_side *side;
	int row;
};

struct rb_coupled_row {
	int a, b;                       /* places of the bodies; -1: not dynamic */
	bool is_couple;                 /* jacobian_linear is zero */
	struct rb_coupled_side side[2]; /* of a, b */
};

/*
 * Factors at the latest evaluation times, such as the nodes of a piece: at repeated visits poses
 * differ less and less, so that refinement with old factors converges as with new ones.
 */
enum { RB_COUPLED_KEPT = 8 };
struct rb_coupled_kept {
	double **block; /* the owner's, with its capacity: the slots, one after another */
	size_t *capacity, size;
	double time_s[RB_COUPLED_KEPT];
	bool used[RB_COUPLED_KEPT];
	bool has_pivots[RB_COUPLED_KEPT];
	struct rb_dense dense[RB_COUPLED_KEPT]; /* of slots with pivots */
	double least;                           /* rb_dense's, of these */
	bool depends;    /* rows depend on each other: do not try factors without pivots again */
	int next, slot;  /* next slot to use; slot in use */
	bool found;      /* the factors in use are from an earlier visit */
	double residual; /* m/s^2: largest residual with new factors */
};

struct rb_coupled {
	struct rb_located *l;
	const struct rb_pose *pose; /* by place */
	const int *body;            /* by place: index in the model */
	int body_count;             /* number of places */
	struct rb_coupled_row *row; /* [max] */
	int count, max;
	int *first;               /* [body_count + 2]: start of a body's list in `of` */
	struct rb_coupled_at *of; /* [2 max]: by body, then by row */
	rb_mat3 *inverse_inertia; /* [body_count]: world axes, at the poses; NULL: not kept */
	/* in: wrenches equal Jacobians, as for joints, but not for slipping contacts */
	bool is_symmetric;
	bool keeps_pivots;   /* in: keep factors of the dense system, too */
	struct rb_dense own; /* the dense system's own arrays, while it uses kept ones */
	bool is_factored; /* out of rb_coupled_fill: in `factor`, otherwise in the dense system */
	struct rb_envelope factor;
	/*
	 * [max], for the rows sorted last: bodies; first column of this and all later rows; their
	 * number
	 */
	int (*ends)[2], *reach, sorted;
	double *pivot;                /* [max]: for factors that are not kept */
	struct rb_coupled_kept *kept; /* NULL: none */
	double *kept_multiplier;      /* [count]: beside kept factors; NULL: there are none */
};

/* Takes arrays for this many rows; false: out of memory. */
bool rb_coupled_reserve(struct rb_coupled *system, int max);
/*
 * Takes the arrays of a dense system of this many unknowns; false: out of memory.
 * rb_coupled_reserve_right leaves out the matrix (NULL): rb_coupled_fill takes as much of it as it
 * needs, which is little for many rows that share few bodies.
 */
bool rb_coupled_reserve_right(struct rb_arena *arena, struct rb_dense *dense, int max);
bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max);

/* Updates inverse inertias after poses have changed; before rb_coupled_respond. */
void rb_coupled_turn(const struct rb_coupled *system);

/* Returns a row from its Jacobian and the wrench of a unit of its unknown. */
struct rb_coupled_row rb_coupled_row(int a, int b, const struct rb_coupled_wrench *jacobian,
                                     const struct rb_coupled_wrench *unit);

/* Computes the effect of the row's unknown on its bodies. */
void rb_coupled_respond(const struct rb_coupled *system, struct rb_coupled_row *row);

/*
 * Once all rows are set: makes lists of rows by body, and blocks of consecutive rows with the same
 * bodies. If their bodies differ from before, kept factors are dropped.
 */
void rb_coupled_sort(struct rb_coupled *system);

/*
 * For rows with the same bodies as those sorted last: uses the factors kept of that time, and fills
 * the multipliers [count] of its solution. False: there are none.
 */
bool rb_coupled_find(struct rb_coupled *system, struct rb_dense *dense, double t,
                     double *multiplier);

/*
 * After multipliers were found and refined: `residual`, m/s^2, is not below `rounding`. False: kept
 * factors have left a larger residual than new ones do; they are dropped.
 */
bool rb_coupled_accept(struct rb_coupled *system, const struct rb_dense *dense, double t,
                       const double *multiplier, double residual, double rounding);

/*
 * Fills the matrix of all rows at `t`, and its zero structure; rows are sorted. Symmetric systems
 * are factored at once, if all rows are independent by more than half of all digits. The dense
 * system has the same size, and the right side of both. False: no memory for the matrix.
 */
bool rb_coupled_fill(struct rb_coupled *system, struct rb_dense *dense, double t);

/* After rb_coupled_fill: rb_dense_solve, and rb_dense_again for another right side. */
void rb_coupled_solve(const struct rb_coupled *system, struct rb_dense *dense);
void rb_coupled_again(const struct rb_coupled *system, struct rb_dense *dense);

/* Returns J V of a row for the dynamic bodies' velocities V, by place. */
double rb_coupled_rate(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular);

/* Adds `share` times the effect of a row's unknown to velocities, by place. */
void rb_coupled_add(const struct rb_coupled_row *row, double share, rb_vec3 *linear,
                    rb_vec3 *angular);

#endif
