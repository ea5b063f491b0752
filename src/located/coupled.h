/* SPDX-License-Identifier: MIT */
/*
 * Equations of constraints that share bodies: rows of joints, and contacts in their modes.
 *
 * Of each row there is an unknown: a wrench on both of its bodies; and what is asked for: a
 * combination of their velocities (or accelerations). The matrix of what each unknown does to each
 * row, J_i M^-1 W_j, is filled through lists of rows by body: entries of rows that share none are
 * zero, which math/dense passes over. Rows come in the order of their bodies' places; of a chain
 * whose bodies follow each other that is a band.
 *
 * All arrays are of the arena of the located method, or the caller's.
 */
#ifndef RB_LOCATED_COUPLED_H
#define RB_LOCATED_COUPLED_H

#include "located/located.h"
#include "math/dense.h"
#include "math/envelope.h"

/* l on b's velocity and -l on a's, m_a and m_b on spins: signs as in geom/linkage. */
struct rb_coupled_wrench {
	rb_vec3 linear, angular_a, angular_b;
};

/* What a row asks of a body, and what its unknown does to it. */
struct rb_coupled_side {
	rb_vec3 asked_linear, asked_angular; /* for velocity and spin */
	/* force and torque of a unit; after rb_coupled_respond what these add to the velocities */
	rb_vec3 linear, angular;
};

/* One of those that act on a body. */
struct rb_coupled_at {
	const struct rb_coupled_side *side;
	int row;
};

struct rb_coupled_row {
	int a, b;                       /* places of bodies that yield, -1: it does not */
	bool is_couple;                 /* asks for nothing of velocities */
	struct rb_coupled_side side[2]; /* of a, b */
};

/*
 * Factors at the last moments that were asked about, as the nodes of a piece: visited again, poses
 * differ by less from visit to visit, so that refinement by old factors ends where new ones do.
 */
enum { RB_COUPLED_KEPT = 8 };
struct rb_coupled_kept {
	double **block; /* the owner's, with its capacity: all of a moment after another */
	size_t *capacity, size;
	double time_s[RB_COUPLED_KEPT];
	bool used[RB_COUPLED_KEPT];
	bool has_pivots[RB_COUPLED_KEPT];
	struct rb_dense dense[RB_COUPLED_KEPT]; /* of those that have pivots */
	double least;                           /* of these: rb_dense's */
	bool depends;   /* rows depend on each other: factors without pivots are not tried again */
	int next, slot; /* to be used; in use */
	bool found;     /* the factors in use are of an earlier visit */
	double left;    /* m/s^2: the most that new ones have left */
};

struct rb_coupled {
	struct rb_located *l;
	const struct rb_pose *pose; /* by place */
	const int *body;            /* by place: of the model */
	int body_count;             /* of places */
	struct rb_coupled_row *row; /* [max] */
	int count, max;
	int *first;               /* [body_count + 2]: in `of`, of a body */
	struct rb_coupled_at *of; /* [2 max]: by body, then by row */
	rb_mat3 *inverse_inertia; /* [body_count]: world axes, at the poses; NULL: not kept */
	/* in: units are what rows ask for, as those of joints, not of contacts that slip */
	bool is_symmetric;
	bool keeps_pivots;   /* in: factors of the dense system are kept as well */
	struct rb_dense own; /* the dense system's arrays, while it uses those that are kept */
	bool is_factored; /* out of rb_coupled_fill: `factor` is the system, else the dense one */
	struct rb_envelope factor;
	/* [max]: of the rows sorted last: bodies; where these and all after begin at first */
	int (*ends)[2], *reach, sorted; /* how many */
	double *pivot;                  /* [max]: of factors that are not kept */
	struct rb_coupled_kept *kept;   /* NULL: none */
	double *kept_multiplier; /* [count]: beside factors that are kept; NULL: they are not */
};

/* Rooms for so many rows; false: no memory. */
bool rb_coupled_reserve(struct rb_coupled *system, int max);
/*
 * Arrays of a dense system of so many unknowns; false: no memory. Without its matrix (NULL):
 * rb_coupled_fill takes as much of one as it needs, which of many rows that share few bodies is
 * little.
 */
bool rb_coupled_reserve_right(struct rb_arena *arena, struct rb_dense *dense, int max);
bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max);

/* At poses that have changed, before rows respond. */
void rb_coupled_turn(const struct rb_coupled *system);

/* A row from what it asks for and a unit of its unknown. */
struct rb_coupled_row rb_coupled_row(int a, int b, const struct rb_coupled_wrench *asked,
                                     const struct rb_coupled_wrench *unit);

/* What the row's unknown does to its bodies. */
void rb_coupled_respond(const struct rb_coupled *system, struct rb_coupled_row *row);

/*
 * Once all rows are there: lists of rows by body, and blocks of rows of the same bodies that follow
 * each other. Where they are of others than before, what is kept is dropped.
 */
void rb_coupled_sort(struct rb_coupled *system);

/*
 * For rows of the same bodies as those sorted last: uses the factors that are kept of that moment,
 * and fills the multipliers [count] that solved them. False: there are none.
 */
bool rb_coupled_find(struct rb_coupled *system, struct rb_dense *dense, double t,
                     double *multiplier);

/*
 * After multipliers were found, and refined as far as factors let them: `left`, m/s^2, is not below
 * `rounding`. False: kept ones have left more than new ones do; they are dropped.
 */
bool rb_coupled_accept(struct rb_coupled *system, const struct rb_dense *dense, double t,
                       const double *multiplier, double left, double rounding);

/*
 * The matrix of all rows at `t`, and where it is zero; they are sorted. Symmetric systems are
 * factored at once, where all rows are independent by more than half of all digits. The dense
 * system is as large; its right side is that of both. False: no memory for a matrix that is still
 * to be taken.
 */
bool rb_coupled_fill(struct rb_coupled *system, struct rb_dense *dense, double t);

/* Once filled: rb_dense_solve, and rb_dense_again for another right side. */
void rb_coupled_solve(const struct rb_coupled *system, struct rb_dense *dense);
void rb_coupled_again(const struct rb_coupled *system, struct rb_dense *dense);

/* J V of a row, without what bodies do that do not yield; by place. */
double rb_coupled_felt(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular);

/* Adds `share` times a row's unknown to velocities, by place. */
void rb_coupled_add(const struct rb_coupled_row *row, double share, rb_vec3 *linear,
                    rb_vec3 *angular);

#endif
