/* SPDX-License-Identifier: MIT */
/*
 * What contacts do to bodies, as a subspace of R^n of their n normal impulses: the row space of the
 * map from these to wrenches (stepped/redundant_contacts). Memory is the caller's.
 */
#ifndef RB_STEPPED_WRENCH_SPAN_H
#define RB_STEPPED_WRENCH_SPAN_H

#include "base/arena.h"
#include "constraint/row.h"

/*
 * A vector is independent if this share of its length is orthogonal to the span: far above rounding
 * (1e-16 times the number of vectors), far below the ratio of lever arms in any scene.
 */
#define RB_WRENCH_SPAN_OWN_SHARE 1e-6

/* What of a vector is not zero: first to end. A load is of the rows of one body only. */
struct rb_wrench_span_part {
	int first, end;
};

/* Basis of a subspace of R^n, orthonormal on the components that are `on`. */
struct rb_wrench_span {
	double *unit;                     /* [count][n]; beyond its part it is not set */
	struct rb_wrench_span_part *part; /* [count] */
	const double *on;                 /* [n]: 1 or 0 */
	int n, count;
};

static inline double rb_wrench_span_dot(const struct rb_wrench_span *span, const double *x,
                                        const double *y, struct rb_wrench_span_part part)
{
	double sum = 0;

	for (int i = part.first; i < part.end; i++)
		sum += span->on[i] * x[i] * y[i];
	return sum;
}

/* Rows of one pair of bodies; rows of a pair are adjacent. */
static inline bool rb_wrench_span_is_pair(const struct rb_constraint *x,
                                          const struct rb_constraint *y)
{
	return x->a == y->a && x->b == y->b;
}

/* Whether a row is of the same bodies as the one before it. */
static inline bool rb_wrench_span_goes_on(struct rb_constraint *const *taken, int i)
{
	return i > 0 && rb_wrench_span_is_pair(taken[i - 1], taken[i]);
}

/* Exchanges two rows of n. */
static inline void rb_wrench_span_swap(double *x, double *y, int n)
{
	for (int i = 0; i < n; i++) {
		const double was = x[i];

		x[i] = y[i];
		y[i] = was;
	}
}

/* Spans the row space: six rows for each dynamic body, each body once, until it is all of R^n. */
void rb_wrench_span_loads(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                          struct rb_wrench_span *span, double *scratch);

/*
 * Where joints connect bodies: spans what motions that these allow make of the normals; false: more
 * than `max` multiplications, or no memory.
 */
bool rb_wrench_span_allowed(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                            struct rb_wrench_span *span, double max, struct rb_arena *arena);

#endif
