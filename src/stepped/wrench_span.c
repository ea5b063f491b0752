/* SPDX-License-Identifier: MIT */
#include "stepped/wrench_span.h"

#include "base/error.h"

/* Subtracts from v its projection on the span; the non-zero range `range` of v may grow. */
static void reject(const struct rb_wrench_span *span, double *v, struct rb_wrench_span_part *range)
{
	for (int k = 0; k < span->count; k++) {
		const double *const unit = span->unit + (size_t)k * (size_t)span->n;
		const struct rb_wrench_span_part part = span->part[k];
		const struct rb_wrench_span_part both = {
			part.first > range->first ? part.first : range->first,
			part.end < range->end ? part.end : range->end};
		const double along = rb_wrench_span_dot(span, v, unit, both);

		/* the bodies of both share no row */
		if (along == 0)
			continue;
		for (int i = part.first; i < part.end; i++)
			v[i] -= along * unit[i];
		range->first = part.first < range->first ? part.first : range->first;
		range->end = part.end > range->end ? part.end : range->end;
	}
}

/*
 * Adds the direction of v, which is overwritten, unless the span contains it already. A vector that
 * keeps most of its length is orthogonal to rounding after one pass (Daniel, Gragg, Kaufman,
 * Stewart 1976).
 */
static void extend(struct rb_wrench_span *span, double *v, struct rb_wrench_span_part part)
{
	const double size = rb_wrench_span_dot(span, v, v, part);

	RB_ASSERT_COSTLY(span->count < span->n);
	reject(span, v, &part);
	double remaining = rb_wrench_span_dot(span, v, v, part);
	if (!(remaining > 0.5 * size)) {
		reject(span, v, &part);
		remaining = rb_wrench_span_dot(span, v, v, part);
	}
	if (!(remaining > RB_WRENCH_SPAN_OWN_SHARE * RB_WRENCH_SPAN_OWN_SHARE * size))
		return;
	span->part[span->count] = part;
	double *const unit = span->unit + (size_t)span->count++ * (size_t)span->n;
	const double length = sqrt(remaining);
	for (int i = part.first; i < part.end; i++)
		unit[i] = v[i] / length;
}

static double component(rb_vec3 v, int k)
{
	return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/*
 * Row of the matrix A: component `which` (0 to 2 force, 3 to 5 torque) of the wrench on a body per
 * unit of each impulse; v is [n]. Returns its non-zero range.
 */
static struct rb_wrench_span_part load(struct rb_constraint *const *selected, int n, int body,
                                       int which, double *v)
{
	struct rb_wrench_span_part part = {n, 0};

	for (int i = 0; i < n; i++) {
		const struct rb_constraint *row = selected[i];
		const bool is_a = row->a == body;
		const rb_vec3 arm = is_a ? row->arm_a : row->arm_b;

		v[i] = 0;
		if (!is_a && row->b != body)
			continue;
		const double size = which < 3
		                            ? component(row->normal, which)
		                            : component(rb_vec3_cross(arm, row->normal), which - 3);
		v[i] = is_a ? -size : size;
		part.first = i < part.first ? i : part.first;
		part.end = i + 1;
	}
	return part;
}

void rb_wrench_span_loads(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                          struct rb_wrench_span *span, double *scratch)
{
	/* for a single pair, the load on one body is the opposite of that on the other */
	const bool single = rb_wrench_span_is_pair(selected[0], selected[span->n - 1]);
	const int count = single && rows->bodies.body[selected[0]->a].inverse_mass != 0 ? 1 : 2;

	for (int k = 0; k < span->n; k++) {
		const int ends[2] = {selected[k]->a, selected[k]->b};

		for (int e = rb_wrench_span_continues_pair(selected, k) ? count : 0; e < count;
		     e++) {
			bool seen = rows->bodies.body[ends[e]].inverse_mass == 0;

			for (int i = 0; i < k && !seen; i++)
				seen = selected[i]->a == ends[e] || selected[i]->b == ends[e];
			for (int which = 0; which < 6 && !seen; which++) {
				if (span->count == span->n)
					return;
				const struct rb_wrench_span_part part = load(
					selected, span->n, ends[e], which, scratch);
				extend(span, scratch, part);
			}
		}
	}
}

/* ---- joints ---- */

/*
 * Motions of bodies that joints connect: for each body's six unit motions a row with the velocities
 * that it produces along the `held` directions of joints, then along the contact normals.
 * Eliminating the former leaves the motions that joints allow.
 */
struct motions {
	double *row;       /* [count][held + n] */
	int *body;         /* [count / 6], dynamic ones */
	double *pivot_max; /* [held]: initial largest magnitude of each column */
	int count, held, n;
};

static bool is_listed(const struct motions *motions, int body)
{
	for (int k = 0; 6 * k < motions->count; k++)
		if (motions->body[k] == body)
			return true;
	return false;
}

/* Number of directions that a joint's row constrains: none if it is soft or at its bound. */
static int held_by(const struct rb_constraint *row)
{
	if (row->set == RB_CONSTRAINT_FREE)
		return 3;
	return row->set == RB_CONSTRAINT_INTERVAL && row->softness == 0 &&
	       row->impulse.n > row->low && row->impulse.n < row->high;
}

static void list_bodies(const struct rb_row_system *rows, struct motions *motions)
{
	for (int k = 0; k < rows->row_count; k++) {
		const int ends[2] = {rows->row[k].a, rows->row[k].b};

		motions->held += held_by(&rows->row[k]);
		for (int e = 0; e < 2; e++) {
			if (rows->bodies.body[ends[e]].inverse_mass == 0 ||
			    is_listed(motions, ends[e]))
				continue;
			motions->body[motions->count / 6] = ends[e];
			motions->count += 6;
		}
	}
}

/*
 * Velocity along a row's direction due to motion `which` of a body: translation at 1 m/s, or
 * rotation scaled to the same units.
 */
static double velocity_by(const struct rb_row_system *rows, const struct rb_constraint *row,
                          rb_vec3 along, int body, int which)
{
	const rb_vec3 unit = {which % 3 == 0, which % 3 == 1, which % 3 == 2};
	const bool is_a = row->a == body;
	const double sign = is_a ? -1 : 1;

	if (!is_a && row->b != body)
		return 0;
	if (which < 3)
		return row->couple ? 0 : sign * rb_vec3_dot(unit, along);
	const rb_vec3 turn = rb_solver_turn(&rows->bodies, body, unit);
	const double per_m = sqrt(rb_vec3_dot(turn, unit) / rows->bodies.body[body].inverse_mass);
	if (row->couple)
		return sign * per_m * row->arm_a.x * rb_vec3_dot(unit, along);
	const rb_vec3 arm = is_a ? rb_constraint_arm_a(row) : rb_constraint_arm_b(row);
	return sign * per_m * rb_vec3_dot(rb_vec3_cross(unit, arm), along);
}

static void fill_motion(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                        struct motions *motions, int number)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const int body = motions->body[number / 6], which = number % 6;
	double *const v = motions->row + (size_t)number * (size_t)(motions->held + motions->n);
	int column = 0;

	for (int k = 0; k < rows->row_count; k++) {
		const struct rb_constraint *row = &rows->row[k];
		const int count = held_by(row);

		for (int c = 0; c < count; c++, column++) {
			v[column] = velocity_by(rows, row, count == 3 ? axis[c] : row->normal, body,
			                        which);
			motions->pivot_max[column] = fmax(motions->pivot_max[column],
			                                  fabs(v[column]));
		}
	}
	for (int i = 0; i < motions->n; i++)
		v[column + i] = velocity_by(rows, selected[i], selected[i]->normal, body, which);
}

/*
 * Eliminates the largest element of the joint columns from the motions after `done`; false: none is
 * left, these motions are free.
 */
static bool eliminate_one(struct motions *motions, int done)
{
	const int width = motions->held + motions->n;
	double *const first = motions->row + (size_t)done * (size_t)width;
	double max = RB_WRENCH_SPAN_OWN_SHARE;
	int row = -1, column = 0;

	for (int k = done; k < motions->count; k++)
		for (int c = 0; c < motions->held; c++) {
			const double size = fabs(
				motions->row[(size_t)k * (size_t)width + (size_t)c]);

			if (!(size > max * motions->pivot_max[c]))
				continue;
			max = size / motions->pivot_max[c];
			row = k;
			column = c;
		}
	if (row < 0)
		return false;
	if (row != done)
		rb_wrench_span_swap(first, motions->row + (size_t)row * (size_t)width, width);
	for (int k = done + 1; k < motions->count; k++) {
		double *const v = motions->row + (size_t)k * (size_t)width;
		const double share = v[column] / first[column];

		for (int i = 0; share != 0 && i < width; i++)
			v[i] -= share * first[i];
		v[column] = 0;
	}
	return true;
}

bool rb_wrench_span_allowed(const struct rb_row_system *rows, struct rb_constraint *const *selected,
                            struct rb_wrench_span *span, double max, struct rb_arena *arena)
{
	struct motions motions = {.n = span->n};
	int done = 0;

	motions.body = rb_arena_take(arena, 2 * (size_t)rows->row_count, sizeof *motions.body);
	if (!motions.body)
		return false;
	list_bodies(rows, &motions);
	const int width = motions.held + motions.n;
	const double size = (double)motions.count * (double)width;
	if (size * fmin((double)motions.count, (double)motions.held) > max)
		return false;
	motions.row = rb_arena_take(arena, (size_t)motions.count * (size_t)width,
	                            sizeof *motions.row);
	motions.pivot_max = rb_arena_take(arena, (size_t)motions.held + 1,
	                                  sizeof *motions.pivot_max);
	if (!motions.row || !motions.pivot_max)
		return false;
	for (int c = 0; c < motions.held; c++)
		motions.pivot_max[c] = 0;
	for (int k = 0; k < motions.count; k++)
		fill_motion(rows, selected, &motions, k);
	while (done < motions.count && eliminate_one(&motions, done))
		done++;
	for (; done < motions.count && span->count < span->n; done++) {
		double *const v = motions.row + (size_t)done * (size_t)width + motions.held;
		const struct rb_wrench_span_part whole = {0, span->n};

		/* otherwise rounding: joints leave no motion there */
		if (rb_wrench_span_dot(span, v, v, whole) >
		    RB_WRENCH_SPAN_OWN_SHARE * RB_WRENCH_SPAN_OWN_SHARE)
			extend(span, v, whole);
	}
	return true;
}
