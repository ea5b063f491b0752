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

/* l on b's velocity and -l on a's, m_a and m_b on spins: signs as in geom/linkage. */
struct rb_coupled_wrench {
	rb_vec3 linear, angular_a, angular_b;
};

struct rb_coupled_row {
	int a, b; /* places of bodies that yield, -1: it does not */
	struct rb_coupled_wrench asked, unit;
	/* what a unit of the unknown adds to velocities of a and b */
	rb_vec3 linear_a, turn_a, linear_b, turn_b;
};

struct rb_coupled {
	struct rb_located *l;
	const struct rb_pose *pose; /* by place */
	const int *body;            /* by place: of the model */
	int body_count;             /* of places */
	struct rb_coupled_row *row; /* [max] */
	int count, max;
	int *first, *of; /* [body_count + 2], [2 max]: rows of a body */
};

/* Rooms for so many rows; false: no memory. */
bool rb_coupled_reserve(struct rb_coupled *system, int max);
/* Arrays of a dense system of so many unknowns; false: no memory. */
bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max);

/* What the row's unknown does to its bodies, from a, b, unit. */
void rb_coupled_respond(const struct rb_coupled *system, struct rb_coupled_row *row);

/* Lists of rows by body, once all rows are there. */
void rb_coupled_sort(struct rb_coupled *system);

/* The matrix of all rows, and where it is zero; rb_coupled_sort was called. */
void rb_coupled_fill(const struct rb_coupled *system, struct rb_dense *dense);

/* J V of a row, without what bodies do that do not yield; by place. */
double rb_coupled_felt(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular);

/* Adds `share` times a row's unknown to velocities, by place. */
void rb_coupled_add(const struct rb_coupled_row *row, double share, rb_vec3 *linear,
                    rb_vec3 *angular);

#endif
