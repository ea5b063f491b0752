/* SPDX-License-Identifier: MIT */
#include "stepped/even.h"

#include "base/error.h"

/* Share of a cone's edge at which friction slides. */
static const double at_edge = 1 - 1e-9;

static bool slides(const struct rb_constraint *row)
{
	const double max = at_edge * row->friction * row->impulse.n;

	return row->impulse.n > 0 && row->friction > 0 &&
	       rb_vec3_dot(row->impulse.t, row->impulse.t) >= max * max;
}

static bool is_pair(const struct rb_constraint *x, const struct rb_constraint *y)
{
	return x->a == y->a && x->b == y->b;
}

/* Rows that bear, of pairs of which one slides and that touch at several; returns how many. */
static int take_rows(const struct rb_row_system *rows, struct rb_constraint **taken)
{
	int count = 0;

	for (int k = 0, end; k < rows->row_count; k = end) {
		struct rb_constraint *const row = &rows->row[k];
		bool slide = false;

		for (end = k; end < rows->row_count && is_pair(row, &rows->row[end]); end++)
			slide = slide || slides(&rows->row[end]);
		for (int i = k; i < end && slide && end - k > 1; i++)
			if (rows->row[i].impulse.n > 0)
				taken[count++] = &rows->row[i];
	}
	return count;
}

/*
 * For each triple of rows: loads are one and a half as many as rows, where bodies touch with faces;
 * two passes of two products.
 */
static const double multiplications = 6;

/* Share of a component that has to be left for it to be one of its own. */
static const double own_share = 1e-6;

/* What is spanned by so many orthogonal unit vectors of n entries. */
struct span {
	double *unit; /* [count][n] */
	int n, count;
};

static double dot(const double *x, const double *y, int n)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += x[i] * y[i];
	return sum;
}

/* Takes one more in, `v` being used up, if it is not spanned: Gram and Schmidt, twice. */
static void extend(struct span *span, double *v)
{
	const double size = dot(v, v, span->n);

	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < span->count; k++) {
			const double *const unit = span->unit + (size_t)k * (size_t)span->n;
			const double along = dot(v, unit, span->n);

			for (int i = 0; i < span->n; i++)
				v[i] -= along * unit[i];
		}
	RB_ASSERT_COSTLY(span->count <= span->n);
	const double left = dot(v, v, span->n);
	if (span->count == span->n || !(left > own_share * own_share * size))
		return;
	double *const unit = span->unit + (size_t)span->count++ * (size_t)span->n;
	for (int i = 0; i < span->n; i++)
		unit[i] = v[i] / sqrt(left);
}

static double component(rb_vec3 v, int k)
{
	return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/* One component of the force and torque that units of the pushes are on a body; [n]. */
static void load(struct rb_constraint *const *taken, int n, int body, int which, double *v)
{
	for (int i = 0; i < n; i++) {
		const struct rb_constraint *row = taken[i];
		const bool is_a = row->a == body;
		const rb_vec3 arm = is_a ? row->arm_a : row->arm_b;

		v[i] = 0;
		if (row->a != body && row->b != body)
			continue;
		const double part = which < 3
		                            ? component(row->normal, which)
		                            : component(rb_vec3_cross(arm, row->normal), which - 3);
		v[i] = is_a ? -part : part;
	}
}

/* All of what the pushes do to bodies. */
static void span_loads(const struct rb_row_system *rows, struct rb_constraint *const *taken,
                       struct span *span, double *scratch)
{
	for (int k = 0; k < span->n; k++) {
		const int ends[2] = {taken[k]->a, taken[k]->b};

		for (int e = 0; e < 2; e++) {
			bool seen = rows->bodies.body[ends[e]].inverse_mass == 0;

			for (int i = 0; i < k && !seen; i++)
				seen = taken[i]->a == ends[e] || taken[i]->b == ends[e];
			for (int which = 0; which < 6 && !seen; which++) {
				load(taken, span->n, ends[e], which, scratch);
				extend(span, scratch);
			}
		}
	}
}

/*
 * Goes to the push; friction at the cone's edge stays there. Returns how much it changes a
 * velocity, m/s.
 */
static double put(const struct rb_row_system *rows, struct rb_constraint *row, double push)
{
	RB_ASSERT_COSTLY(row->impulse.n > 0 && push >= 0);
	const double share = push / row->impulse.n, max = row->friction * push;
	const double square = rb_vec3_dot(row->impulse.t, row->impulse.t);
	rb_vec3 friction_impulse = row->impulse.t;

	if (slides(row))
		friction_impulse = rb_vec3_scale(share, friction_impulse);
	else if (square > max * max)
		friction_impulse = rb_vec3_scale(max / sqrt(square), friction_impulse);
	const rb_vec3 change = rb_vec3_add_scaled(rb_vec3_sub(friction_impulse, row->impulse.t),
	                                          push - row->impulse.n, row->normal);
	row->impulse.n = push;
	row->impulse.t = friction_impulse;
	rb_constraint_apply(&rows->bodies, row, change);
	return row->inverse_mass_n * rb_vec3_length(change);
}

bool rb_even(const struct rb_row_system *rows, double tolerance, double max, struct rb_arena *arena)
{
	const size_t all = (size_t)rows->row_count;
	struct rb_constraint **const taken = rb_arena_take(arena, all,
	                                                   sizeof(struct rb_constraint *));
	double share = 1, changed = 0;

	if (!taken)
		return false;
	const int n = take_rows(rows, taken);
	const size_t size = (size_t)n;
	if (n == 0 || multiplications * (double)(size * size * size) > max)
		return false;
	double *const store = rb_arena_take(arena, (size + 3) * size + 1, sizeof *store);
	if (!store)
		return false;
	struct span span = {.unit = store, .n = n};
	double *const scratch = store + size * size, *const push = scratch + n,
		      *const even = push + n;

	span_loads(rows, taken, &span, scratch);
	if (span.count == n)
		return false;
	for (int i = 0; i < n; i++) {
		push[i] = taken[i]->impulse.n;
		even[i] = 0;
	}
	for (int k = 0; k < span.count; k++) {
		const double *const unit = span.unit + (size_t)k * size;
		const double along = dot(push, unit, n);

		for (int i = 0; i < n; i++)
			even[i] += along * unit[i];
	}
	for (int i = 0; i < n; i++)
		if (even[i] < 0)
			share = fmin(share, push[i] / (push[i] - even[i]));
	for (int i = 0; i < n; i++)
		changed = fmax(changed,
		               put(rows, taken[i], fmax(0, push[i] + share * (even[i] - push[i]))));
	RB_ASSERT(share >= 0 && share <= 1);
	return changed > tolerance;
}
