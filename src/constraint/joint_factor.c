/* SPDX-License-Identifier: MIT */
#include "constraint/joint_factor.h"

#include <math.h>
#include <string.h>

/*
 * Share of a diagonal entry that must remain for its row to be independent. Far above rounding; a
 * preconditioner needs no more accuracy.
 */
static const double independent = 0x1p-36;

int rb_joint_factor_width(const struct rb_cone_row *row)
{
	const struct rb_constraint *const base = &row->base;

	if (!(row->bound_n > 0))
		return 0;
	if (base->set == RB_CONSTRAINT_FREE)
		return 3;
	return base->set == RB_CONSTRAINT_INTERVAL && !row->given &&
	       base->low == -(double)INFINITY && base->high == (double)INFINITY;
}

static rb_vec3 direction_of(const struct rb_cone_row *row, int e)
{
	if (row->base.set == RB_CONSTRAINT_INTERVAL)
		return row->base.normal;
	return (rb_vec3){e == 0, e == 1, e == 2};
}

struct wrench {
	rb_vec3 force, torque;
};

/* Wrench of a unit impulse of a row on the body at one of its sides. */
static struct wrench wrench_of(const struct rb_cone_row *row, int side, int e)
{
	const double sign = side == 0 ? -1 : 1;
	const rb_vec3 d = rb_vec3_scale(sign, direction_of(row, e));

	if (row->base.couple)
		return (struct wrench){{0, 0, 0}, rb_vec3_scale(row->base.arm_a.x, d)};
	return (struct wrench){d, rb_vec3_cross(side == 0 ? row->base.arm_a : row->base.arm_b, d)};
}

/*
 * Determines each unknown's first column from the rows of the bodies that it acts on; returns the
 * total size of the rows.
 */
static size_t lay_out(const struct rb_cone *cone, struct rb_joint_factor *f, double *products)
{
	int *const lowest = f->place; /* [body_count]: used before the rows' places are filled */
	size_t size = 0;

	for (int i = 0; i < cone->body_count; i++)
		lowest[i] = f->count;
	*products = 0;
	for (int pass = 0; pass < 2; pass++) {
		int at = 0;

		for (int k = 0; k < cone->row_count; k++) {
			const struct rb_constraint *const base = &cone->row[k].base;
			const int width = rb_joint_factor_width(&cone->row[k]);
			int first = at;

			for (int side = 0; side < 2 && width > 0; side++) {
				const int body = side == 0 ? base->a : base->b;

				if (!rb_solver_is_dynamic(&cone->bodies.body[body]))
					continue;
				lowest[body] = lowest[body] < at ? lowest[body] : at;
				first = lowest[body] < first ? lowest[body] : first;
			}
			for (int e = 0; e < width && pass == 1; e++, at++) {
				f->first[at] = first;
				f->start[at] = size;
				size += (size_t)(at + 1 - first);
				*products += 0.5 * (at + 1.0 - first) * (at + 1.0 - first);
			}
			at += pass == 0 ? width : 0;
		}
	}
	return size;
}

/* Adds, for one body of row k, the responses of rows up to k to unknown e. */
static void fill_side(const struct rb_cone *cone, struct rb_joint_factor *f, int k, int e, int side)
{
	const struct rb_cone_row *const row = &cone->row[k];
	const int body = side == 0 ? row->base.a : row->base.b, at = f->place[k] + e;
	double *const to = f->value + f->start[at];

	if (!rb_solver_is_dynamic(&cone->bodies.body[body]))
		return;
	const struct wrench own = wrench_of(row, side, e);
	const rb_vec3 linear = rb_vec3_scale(cone->bodies.body[body].inverse_mass, own.force);
	const rb_vec3 angular = cone->bodies.body[body].inverse_inertia != 0
	                                ? rb_solver_turn(&cone->bodies, body, own.torque)
	                                : (rb_vec3){0, 0, 0};
	for (int n = cone->first[body]; n < cone->first[body + 1]; n++) {
		const int code = cone->entry[n], other = code / 2;

		if (other > k)
			continue;
		for (int c = 0;
		     c < rb_joint_factor_width(&cone->row[other]) && f->place[other] + c <= at;
		     c++) {
			const struct wrench response = wrench_of(&cone->row[other], code % 2, c);

			to[f->place[other] + c - f->first[at]] += rb_vec3_dot(response.force,
			                                                      linear) +
			                                          rb_vec3_dot(response.torque,
			                                                      angular);
		}
	}
}

static void factor_row(struct rb_joint_factor *f, int i)
{
	double *const own = f->value + f->start[i] - f->first[i];
	const double whole = own[i];

	for (int j = f->first[i]; j < i; j++) {
		const double *const other = f->value + f->start[j] - f->first[j];
		double sum = own[j];

		for (int k = f->first[j] > f->first[i] ? f->first[j] : f->first[i]; k < j; k++)
			sum -= own[k] * other[k];
		own[j] = sum;
	}
	for (int j = f->first[i]; j < i; j++) {
		const double share = own[j] * f->inverse[j];

		own[i] -= share * own[j];
		own[j] = share;
	}
	f->inverse[i] = own[i] > independent * whole ? 1 / own[i] : 0;
	if (f->inverse[i] == 0)
		memset(own + f->first[i], 0, (size_t)(i - f->first[i]) * sizeof *own);
}

bool rb_joint_factor(struct rb_cone *cone, double max)
{
	struct rb_joint_factor *const f = &cone->joints;
	double products;

	f->attempted = true;
	f->count = 0;
	for (int k = 0; k < cone->row_count; k++)
		f->count += rb_joint_factor_width(&cone->row[k]);
	if (f->count == 0)
		return false;
	const size_t rows = (size_t)cone->row_count + (size_t)cone->body_count;
	const size_t count = (size_t)f->count;

	f->place = rb_arena_take(cone->arena, rows, sizeof *f->place);
	f->first = rb_arena_take(cone->arena, count, sizeof *f->first);
	f->start = rb_arena_take(cone->arena, count, sizeof *f->start);
	f->inverse = rb_arena_take(cone->arena, count, sizeof *f->inverse);
	f->x = rb_arena_take(cone->arena, count, sizeof *f->x);
	if (!f->place || !f->first || !f->start || !f->inverse || !f->x)
		return false;
	const size_t size = lay_out(cone, f, &products);
	if (products > max)
		return false;
	f->value = rb_arena_take(cone->arena, size, sizeof *f->value);
	if (!f->value)
		return false;
	memset(f->value, 0, size * sizeof *f->value);
	for (int k = 0, at = 0; k < cone->row_count; k++) {
		f->place[k] = at;
		at += rb_joint_factor_width(&cone->row[k]);
	}
	for (int k = 0; k < cone->row_count; k++)
		for (int e = 0; e < rb_joint_factor_width(&cone->row[k]); e++)
			for (int side = 0; side < 2; side++)
				fill_side(cone, f, k, e, side);
	for (int i = 0; i < f->count; i++) {
		if (rb_interrupt_after(cone->interrupt, (uint64_t)(products / f->count)))
			return false;
		factor_row(f, i);
	}
	f->ready = true;
	return true;
}

static void solve(const struct rb_joint_factor *f)
{
	for (int i = 0; i < f->count; i++) {
		const double *const own = f->value + f->start[i] - f->first[i];

		for (int k = f->first[i]; k < i; k++)
			f->x[i] -= own[k] * f->x[k];
	}
	for (int i = 0; i < f->count; i++)
		f->x[i] *= f->inverse[i];
	for (int i = f->count; i-- > 0;) {
		const double *const own = f->value + f->start[i] - f->first[i];

		for (int k = f->first[i]; k < i; k++)
			f->x[k] -= own[k] * f->x[i];
	}
}

void rb_joint_factor_solve(const struct rb_cone *cone, const rb_along_across *r,
                           rb_along_across *to)
{
	const struct rb_joint_factor *const f = &cone->joints;
	int at = 0;

	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *const row = &cone->row[k];
		const rb_along_across u = {row->bound_n * r[k].n,
		                           rb_vec3_scale(row->bound_t, r[k].t)};
		const rb_vec3 whole = rb_constraint_joined(&row->base, u);

		for (int e = 0, width = rb_joint_factor_width(row); e < width; e++)
			f->x[at++] = rb_vec3_dot(whole, direction_of(row, e));
	}
	solve(f);
	at = 0;
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *const row = &cone->row[k];
		const int width = rb_joint_factor_width(row);

		to[k] = r[k];
		if (width == 3)
			to[k] = rb_constraint_split(
				&row->base, (rb_vec3){f->x[at], f->x[at + 1], f->x[at + 2]});
		else if (width == 1)
			to[k] = (rb_along_across){f->x[at], {0, 0, 0}};
		at += width;
	}
}
