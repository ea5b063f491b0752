/* SPDX-License-Identifier: MIT */
/*
 * Loads of contacts on bodies, as a subspace of R^n of their n normal impulses: the row space of
 * the map from these to wrenches (stepped/redundant_contacts). Memory is the caller's.
 */
#ifndef RB_STEPPED_WRENCH_SPAN_H
#define RB_STEPPED_WRENCH_SPAN_H

#include "base/arena.h"
#include "constraint/row.h"

/*
 * A vector is independent if this fraction of its length is orthogonal to the span: far above
 * rounding (1e-16 times the number of vectors), far below the ratio of lever arms in any scene.
 */
#define RB_WRENCH_SPAN_OWN_SHARE 1e-6

/* Non-zero range of a vector: [first, end). A load involves the rows of one body only. */
struct rb_wrench_span_part {
	int first, end;
};

/* Basis of a subspace of R^n, orthonormal on the active components. */
struct rb_wrench_span {
	double *unit;                     /* [count][n]; undefined outside its part */
	struct rb_wrench_span_part *part; /* [count] */
	const double *active;             /* [n]: 1 active, 0 not */
	int n, count;
};

static inline double rb_wrench_span_dot(const struct rb_wrench_span *span, const double *x,
                                        const double *y, struct rb_wrench_span_part part)
{
	double sum = 0;

	for (int i = part.first; i < part.end; i++)
		sum += span->active[i] * x[i] * y[i];
	return sum;
}

/* Rows of one pair of bodies; rows of a pair are adjacent. */
static inline bool rb_wrench_span_is_pair(const struct rb_constraint *x,
                                          const struct rb_constraint *y)
{
	return x->a == y->a && x->b == y->b;
}

/* Whether a row has the same bodies as the one before it. */
static inline bool rb_wrench_span_continues_pair(struct rb_constraint *const *selected, int i)
{
	return i > 0 && rb_wrench_span_is_pair(selected[i - 1], selected[i]);
}

/* Exchanges two rows of n. */
static inline void rb_wrench_span_swap(double *x, double *y, int n)
{
	for (int i = 0; i < n; i++) {
		const double previous = x[i];

		x[i] = y[i];
		y[i] = previous;
	}
}

/*
 * Spans the row space: six vectors for each dynamic body, each body once, until it is all of R^n.
 */
void rb_wrench_span_loads(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                          struct rb_wrench_span *span, double *scratch);

/*
 * With joints: spans the normal velocities that motions allowed by them produce; false: more than
 * `max` multiplications, or no memory.
 */
bool rb_wrench_span_allowed(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                            struct rb_wrench_span *span, double max, struct rb_arena *arena);

#endif
