/* SPDX-License-Identifier: MIT */
#include "constraint/cone.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "constraint/effective_mass.h"
#include "constraint/exact_sum.h"

enum {
	WINDOW = 100, /* directions kept; fewer above MANY rows, to limit memory */
	WINDOW_MANY = 40,
	MANY = 400
};

/* Work of a product with the matrix per row, in multiplications, about: its sums are exact. */
enum { PRODUCT_WORK = 1 << 10 };

/*
 * Bound of the largest eigenvalue of the inverse inertia R^T R, from R R^T, which has the same
 * ones: that is in the body's axes, so that the bound does not depend on orientation. Where the
 * solution is not unique, steps decide which one is found.
 */
static double inverse_inertia_bound(const struct rb_solver_bodies *bodies, int i)
{
	double largest = 0;

	if (!isnan(bodies->body[i].inverse_inertia))
		return bodies->body[i].inverse_inertia;
	const rb_mat3 back = rb_mat3_transposed(&bodies->root[i]);
	const rb_mat3 tensor = rb_mat3_multiply(&bodies->root[i], &back);
	for (int r = 0; r < 3; r++)
		largest = fmax(largest,
		               fabs(tensor.m[r][0]) + fabs(tensor.m[r][1]) + fabs(tensor.m[r][2]));
	return largest;
}

/*
 * Adds a body's part of the bounds of a row. A body with d rows counts d-fold: then the sum of the
 * rows' inverse effective masses is an upper bound of the whole matrix, and simultaneous steps of
 * all rows converge ("mass splitting", Tonge, Benevolenski, Voroshilov, ACM TOG 31(4):105 (2012)).
 * Eccentric rows, whose normal and tangent are coupled, count twice.
 */
static void add_dynamic(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm, int rows,
                        struct rb_cone_row *row)
{
	const struct rb_solver_body *const body = &bodies->body[i];
	const double spin = inverse_inertia_bound(bodies, i);

	if (row->base.couple) {
		const double square = row->base.arm_a.x * row->base.arm_a.x;
		const rb_vec3 turn = rb_solver_turn(bodies, i, row->base.normal);

		row->bound_n += 2 * rows * square * rb_vec3_dot(row->base.normal, turn);
		row->bound_t += 2 * rows * square * spin;
		return;
	}
	const rb_vec3 lever = rb_vec3_cross(arm, row->base.normal);
	const double along = rb_vec3_dot(lever, lever), whole = rb_vec3_dot(arm, arm);
	const double count = rows * (isnan(body->inverse_inertia) || along > 1e-12 * whole ? 2 : 1);

	row->bound_n += count *
	                (body->inverse_mass + rb_vec3_dot(lever, rb_solver_turn(bodies, i, lever)));
	row->bound_t += count * (body->inverse_mass + spin * whole);
}

static bool take_scratch(struct rb_cone *cone, int largest)
{
	const size_t rows = (size_t)cone->row_count + 1, bodies = (size_t)cone->body_count + 1;
	const size_t terms = 6 * (size_t)largest > 4 * rows ? 6 * (size_t)largest : 4 * rows;

	const int widest = cone->row_count > MANY ? WINDOW_MANY : WINDOW;

	cone->window = 3 * cone->row_count + 1 < widest ? 3 * cone->row_count + 1 : widest;
	cone->linear = rb_arena_take(cone->arena, bodies, sizeof *cone->linear);
	cone->angular = rb_arena_take(cone->arena, bodies, sizeof *cone->angular);
	cone->kept = rb_arena_take(cone->arena, bodies, sizeof *cone->kept);
	cone->term = rb_arena_take(cone->arena, terms, sizeof *cone->term);
	cone->change = rb_arena_take(cone->arena, rows, sizeof *cone->change);
	cone->residual = rb_arena_take(cone->arena, rows, sizeof *cone->residual);
	cone->best = rb_arena_take(cone->arena, rows, sizeof *cone->best);
	cone->before = rb_arena_take(cone->arena, rows, sizeof *cone->before);
	cone->faces = rb_arena_take(cone->arena, rows, sizeof *cone->faces);
	cone->snapped = rb_arena_take(cone->arena, bodies, sizeof *cone->snapped);
	cone->direction = rb_arena_take(cone->arena, (size_t)cone->window * rows,
	                                sizeof *cone->direction);
	cone->image = rb_arena_take(cone->arena, (size_t)cone->window * rows, sizeof *cone->image);
	return cone->linear && cone->angular && cone->kept && cone->term && cone->change &&
	       cone->residual && cone->best && cone->before && cone->faces && cone->snapped &&
	       cone->direction && cone->image;
}

bool rb_cone_open(struct rb_cone *cone)
{
	int largest = 0;

	cone->first = rb_arena_take(cone->arena, (size_t)cone->body_count + 2, sizeof *cone->first);
	cone->entry = rb_arena_take(cone->arena, 2 * (size_t)cone->row_count + 1,
	                            sizeof *cone->entry);
	if (!cone->first || !cone->entry)
		return false;
	int *const first = cone->first;
	memset(first, 0, ((size_t)cone->body_count + 2) * sizeof *first);
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		RB_ASSERT_COSTLY(!row->base.central && row->base.softness == 0);
		RB_ASSERT_COSTLY(row->base.set == RB_CONSTRAINT_CONE ||
		                 (row->base.friction == 0 && !row->slide && !row->given));
		first[row->base.a + 2] += rb_solver_is_dynamic(&cone->bodies.body[row->base.a]);
		first[row->base.b + 2] += rb_solver_is_dynamic(&cone->bodies.body[row->base.b]);
	}
	for (int i = 2; i <= cone->body_count + 1; i++) {
		largest = first[i] > largest ? first[i] : largest;
		first[i] += first[i - 1];
	}
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		if (rb_solver_is_dynamic(&cone->bodies.body[row->base.a]))
			cone->entry[first[row->base.a + 1]++] = 2 * k;
		if (rb_solver_is_dynamic(&cone->bodies.body[row->base.b]))
			cone->entry[first[row->base.b + 1]++] = 2 * k + 1;
	}
	for (int k = 0; k < cone->row_count; k++) {
		struct rb_cone_row *row = &cone->row[k];

		row->bound_n = row->bound_t = 0;
		add_dynamic(&cone->bodies, row->base.a, row->base.arm_a,
		            first[row->base.a + 1] - first[row->base.a], row);
		double n = row->bound_n, t = row->bound_t;
		row->bound_n = row->bound_t = 0;
		add_dynamic(&cone->bodies, row->base.b, row->base.arm_b,
		            first[row->base.b + 1] - first[row->base.b], row);
		row->bound_n += n;
		row->bound_t += t;
		/* friction proportional to the normal impulse acts, too */
		if (row->slide && !row->given)
			row->bound_n *= fmax(1, row->base.friction);
	}
	cone->joints = (struct rb_joint_factor){.attempted = false};
	return take_scratch(cone, largest);
}

rb_along_across rb_cone_velocity(const struct rb_cone *cone, const struct rb_cone_row *row)
{
	const struct rb_solver_body *a = &cone->bodies.body[row->base.a],
				    *b = &cone->bodies.body[row->base.b];
	const rb_vec3 of_a = rb_solver_point_velocity(a, row->base.arm_a);
	const rb_vec3 of_b = rb_solver_point_velocity(b, row->base.arm_b);

	const rb_vec3 v = row->base.couple ? rb_constraint_velocity(&cone->bodies, &row->base)
	                                   : rb_vec3_sub(of_b, of_a);
	rb_along_across u = rb_constraint_split(&row->base, rb_vec3_add(v, row->bias));

	u.n -= row->base.target.n;
	if (row->base.set == RB_CONSTRAINT_FREE)
		u.t = rb_vec3_sub(u.t, row->base.target.t);
	return u;
}

/* Velocity increments of all bodies by impulses on all rows. */
void rb_cone_respond(struct rb_cone *cone, const rb_along_across *impulse)
{
	cone->iterations++;
	(void)rb_interrupt_after(cone->interrupt, PRODUCT_WORK * (uint64_t)cone->row_count);
	for (int i = 0; i < cone->body_count; i++) {
		const struct rb_solver_body *body = &cone->bodies.body[i];
		const int count = cone->first[i + 1] - cone->first[i];
		double *const term = cone->term;

		if (count == 0)
			continue;
		for (int e = 0; e < count; e++) {
			const int code = cone->entry[cone->first[i] + e];
			const struct rb_cone_row *row = &cone->row[code / 2];
			rb_vec3 j = rb_constraint_joined(&row->base, impulse[code / 2]);

			if (code % 2 == 0)
				j = rb_vec3_neg(j);
			const rb_vec3 arm = code % 2 == 0 ? row->base.arm_a : row->base.arm_b;
			const rb_vec3 torque = row->base.couple
			                               ? rb_vec3_scale(row->base.arm_a.x, j)
			                               : rb_vec3_cross(arm, j);
			if (row->base.couple)
				j = (rb_vec3){0, 0, 0};
			term[e] = j.x;
			term[e + count] = j.y;
			term[e + 2 * count] = j.z;
			term[e + 3 * count] = torque.x;
			term[e + 4 * count] = torque.y;
			term[e + 5 * count] = torque.z;
		}
		cone->linear[i] = rb_vec3_scale(body->inverse_mass,
		                                (rb_vec3){rb_exact_sum(term, count),
		                                          rb_exact_sum(term + count, count),
		                                          rb_exact_sum(term + 2 * count, count)});
		cone->angular[i] = (rb_vec3){0, 0, 0};
		if (body->inverse_inertia != 0)
			cone->angular[i] = rb_solver_turn(
				&cone->bodies, i,
				(rb_vec3){rb_exact_sum(term + 3 * count, count),
			                  rb_exact_sum(term + 4 * count, count),
			                  rb_exact_sum(term + 5 * count, count)});
	}
}

static void commit(struct rb_cone *cone)
{
	for (int i = 0; i < cone->body_count; i++) {
		struct rb_solver_body *body = &cone->bodies.body[i];

		if (cone->first[i + 1] == cone->first[i])
			continue;
		body->linear = rb_vec3_add(body->linear, cone->linear[i]);
		body->angular = rb_vec3_add(body->angular, cone->angular[i]);
	}
}

void rb_cone_apply(struct rb_cone *cone, const rb_along_across *impulse)
{
	rb_cone_respond(cone, impulse);
	commit(cone);
	for (int k = 0; k < cone->row_count; k++) {
		rb_along_across *const p = &cone->row[k].base.impulse;

		p->n += impulse[k].n;
		p->t = rb_vec3_add(p->t, impulse[k].t);
	}
}

/*
 * Change of velocity of body i at the arm, or of l times its spin for a couple, by the increments.
 */
static inline rb_vec3 change_at(const struct rb_cone *cone, const struct rb_constraint *row, int i,
                                rb_vec3 arm)
{
	if (!(cone->first[i + 1] > cone->first[i]))
		return (rb_vec3){0, 0, 0};
	if (row->couple)
		return rb_vec3_scale(row->arm_a.x, cone->angular[i]);
	return rb_vec3_add(cone->linear[i], rb_vec3_cross(cone->angular[i], arm));
}

rb_along_across rb_cone_row_change(const struct rb_cone *cone, const struct rb_cone_row *row)
{
	const struct rb_constraint *const own = &row->base;

	return rb_constraint_split(own, rb_vec3_sub(change_at(cone, own, own->b, own->arm_b),
	                                            change_at(cone, own, own->a, own->arm_a)));
}

double rb_cone_dot(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b)
{
	for (int k = 0; k < cone->row_count; k++)
		cone->term[k] = a[k].n * b[k].n + rb_vec3_dot(a[k].t, b[k].t);
	return rb_exact_sum(cone->term, cone->row_count);
}

double rb_cone_weighted(struct rb_cone *cone, const rb_along_across *a, const rb_along_across *b)
{
	for (int k = 0; k < cone->row_count; k++)
		cone->term[k] = cone->row[k].bound_n * (a[k].n * b[k].n) +
		                cone->row[k].bound_t * rb_vec3_dot(a[k].t, b[k].t);
	return rb_exact_sum(cone->term, cone->row_count);
}
