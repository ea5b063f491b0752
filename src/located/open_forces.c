/* SPDX-License-Identifier: MIT */
/*
 * Forces within all cones are sought as a point of convex sets: in each round all that are left by
 * the last one are entered together, by the smallest change, a little further than to their
 * surface, so that rounds come to an end where the sets have an inside in common.
 */
#include "located/open_forces.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "located/coupled.h"

enum { ROUNDS_MAX = 32 };
/* Share of the way to a cone's surface that a round goes, beyond it. */
static const double beyond = 1.5;
/*
 * Share of its forces that a way may do to a body: it is nothing but rounding, in which different
 * forces for the same motion may differ as well.
 */
static const double nothing = 1e-10;

/* Removes the component of v along `way`. */
static void take_off(double *v, const double *way, size_t n)
{
	double along = 0, square = 0;

	for (size_t i = 0; i < n; i++) {
		along += v[i] * way[i];
		square += way[i] * way[i];
	}
	for (size_t i = 0; i < n && square > 0; i++)
		v[i] -= along / square * way[i];
}

/* What forces may differ by, one way for each open unknown, [n] each; NULL: no memory. */
static double *ways_of(const struct rb_open_forces *open, size_t *count)
{
	const size_t n = (size_t)open->dense->n;
	size_t found = 0;

	*count = 0;
	for (int k = 0; k < open->dense->n; k++)
		found += rb_dense_is_open(open->dense, k);
	double *const way = rb_arena_take(open->arena, found * n + 1, sizeof *way);
	for (int k = 0; way && k < open->dense->n; k++) {
		if (!rb_dense_is_open(open->dense, k))
			continue;
		rb_dense_opened(open->dense, k);
		memcpy(way + n * (*count)++, open->dense->right, n * sizeof *way);
	}
	return way;
}

bool rb_open_forces_close(struct rb_open_forces *open, double *least, double *change)
{
	const size_t n = (size_t)open->dense->n;
	const rb_arena_mark here = rb_arena_here(open->arena);
	size_t count;
	double *const way = ways_of(open, &count);

	if (!way)
		return false;
	/* modified Gram-Schmidt */
	for (size_t k = 0; k < count; k++) {
		double *const own = way + n * k;

		for (size_t j = 0; j < k; j++)
			take_off(own, way + n * j, n);
		take_off(least, own, n);
		take_off(change, own, n);
	}
	open->dense->products += (long)(n * count * (n + count));
	rb_arena_back(open->arena, here);
	return true;
}

/* ---- within the law ---- */

static rb_vec3 force_of(const struct rb_open_contact *c, const double *unknown)
{
	const double *const own = unknown + c->row;

	return c->slips ? rb_vec3_scale(own[0], c->unit) : rb_vec3_from(own);
}

static void press(int body, rb_vec3 arm, rb_vec3 force, rb_vec3 *sum)
{
	if (body < 0)
		return;
	sum[2 * body] = rb_vec3_add(sum[2 * body], force);
	sum[2 * body + 1] = rb_vec3_add(sum[2 * body + 1], rb_vec3_cross(arm, force));
}

/* Does a way leave all bodies alone, and other unknowns than those of contacts? */
static bool does_nothing(const struct rb_open_forces *open, const double *way, rb_vec3 *sum)
{
	double forces = 0, torques = 0, force = 0, torque = 0, known = 0, all = 0;

	memset(sum, 0, 2 * (size_t)open->bodies * sizeof *sum);
	for (int k = 0; k < open->contacts; k++) {
		const struct rb_open_contact *c = &open->contact[k];
		const rb_vec3 f = force_of(c, way);
		const double arm = fmax(c->a < 0 ? 0 : rb_vec3_length(c->arm_a),
		                        c->b < 0 ? 0 : rb_vec3_length(c->arm_b));

		press(c->a, c->arm_a, rb_vec3_neg(f), sum);
		press(c->b, c->arm_b, f, sum);
		forces = fmax(forces, rb_vec3_length(f));
		torques = fmax(torques, arm * rb_vec3_length(f));
		for (int r = 0; r < (c->slips ? 1 : 3); r++)
			known += way[c->row + r] * way[c->row + r];
	}
	for (int k = 0; k < open->dense->n; k++)
		all += way[k] * way[k];
	for (int k = 0; k < open->bodies; k++) {
		force = fmax(force, rb_vec3_length(sum[2 * k]));
		torque = fmax(torque, rb_vec3_length(sum[2 * k + 1]));
	}
	return all - known <= nothing * nothing * all && force <= nothing * forces &&
	       torque <= nothing * torques;
}

/* Orthonormal ways that do nothing, the first of `way`; returns how many. */
static size_t keep_idle(const struct rb_open_forces *open, double *way, size_t count, rb_vec3 *sum)
{
	const size_t n = (size_t)open->dense->n;
	size_t kept = 0;

	for (size_t k = 0; k < count; k++) {
		double *const own = way + n * kept;
		double square = 0;

		if (!does_nothing(open, way + n * k, sum))
			continue;
		memmove(own, way + n * k, n * sizeof *own);
		for (size_t j = 0; j < kept; j++)
			take_off(own, way + n * j, n);
		for (size_t i = 0; i < n; i++)
			square += own[i] * own[i];
		for (size_t i = 0; i < n && square > 0; i++)
			own[i] /= sqrt(square);
		kept += square > 0;
	}
	return kept;
}

/* How far a contact's force is outside its cone, N, and the way out of it, by its unknowns. */
static double outside(const struct rb_open_contact *c, const double *unknown, rb_vec3 *out)
{
	const rb_vec3 f = force_of(c, unknown);
	const double along = rb_vec3_dot(f, c->normal);
	const rb_vec3 across = rb_vec3_reject(f, c->normal);
	const double size = rb_vec3_length(across), per = 1 / hypot(1, c->friction);

	if (c->slips) {
		*out = (rb_vec3){-1, 0, 0};
		return -unknown[c->row];
	}
	*out = rb_vec3_scale(-c->friction * per, c->normal);
	if (size > 0)
		*out = rb_vec3_add_scaled(*out, per / size, across);
	return (size - c->friction * along) * per;
}

/* Contacts outside their cones, with the components along the ways of the way out; how many. */
static int outside_cones(const struct rb_open_forces *open, const double *unknown,
                         const double *way, size_t count, double *excess, double *along)
{
	const size_t n = (size_t)open->dense->n;
	int found = 0;

	for (int k = 0; k < open->contacts; k++) {
		const struct rb_open_contact *c = &open->contact[k];
		rb_vec3 out;
		const double by = outside(c, unknown, &out);

		if (!(by > 0))
			continue;
		for (size_t j = 0; j < count; j++) {
			const double *const own = way + n * j + c->row;

			along[(size_t)found * count + j] = c->slips
			                                           ? out.x * own[0]
			                                           : rb_vec3_dot(out,
			                                                         rb_vec3_from(own));
		}
		excess[found++] = by;
	}
	return found;
}

/* The smallest change along the ways that enters so many cones at once. */
static void enter(struct rb_dense *gram, const double *excess, const double *along, size_t count,
                  int found, double *step)
{
	gram->n = found;
	gram->first = NULL;
	for (int i = 0; i < found; i++) {
		gram->right[i] = -beyond * excess[i];
		for (int j = 0; j < found; j++) {
			double sum = 0;

			for (size_t k = 0; k < count; k++)
				sum += along[(size_t)i * count + k] * along[(size_t)j * count + k];
			gram->matrix[i * found + j] = sum;
		}
	}
	rb_dense_solve(gram);
	for (size_t k = 0; k < count; k++) {
		step[k] = 0;
		for (int i = 0; i < found; i++)
			step[k] += gram->right[i] * along[(size_t)i * count + k];
	}
}

bool rb_open_forces_keep_law(struct rb_open_forces *open, double *unknown)
{
	const size_t n = (size_t)open->dense->n, contacts = (size_t)open->contacts;
	const rb_arena_mark here = rb_arena_here(open->arena);
	struct rb_dense gram = {.n = 0};
	size_t count;
	double *const way = ways_of(open, &count);
	rb_vec3 *const sum = rb_arena_take(open->arena, 2 * (size_t)open->bodies + 1, sizeof *sum);
	double *const now = rb_arena_take(open->arena, n + count + 1, sizeof *now);
	double *const excess = rb_arena_take(open->arena, contacts + 1, sizeof *excess);
	double *const along = rb_arena_take(open->arena, contacts * count + 1, sizeof *along);
	int left = 1;

	if (!way || !sum || !now || !excess || !along ||
	    !rb_coupled_reserve_dense(open->arena, &gram, open->contacts))
		return false;
	double *const step = now + n;
	count = keep_idle(open, way, count, sum);
	memcpy(now, unknown, n * sizeof *now);
	for (int round = 0; round < ROUNDS_MAX && left > 0 && count > 0; round++) {
		left = outside_cones(open, now, way, count, excess, along);
		if (left == 0)
			break;
		enter(&gram, excess, along, count, left, step);
		for (size_t k = 0; k < count; k++)
			for (size_t i = 0; i < n; i++)
				now[i] += step[k] * way[n * k + i];
		open->dense->products += (long)(count * n + (size_t)left * (size_t)left * count);
	}
	if (left == 0)
		memcpy(unknown, now, n * sizeof *now);
	rb_arena_back(open->arena, here);
	return true;
}
