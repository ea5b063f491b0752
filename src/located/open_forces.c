/* SPDX-License-Identifier: MIT */
/*
 * Forces within all cones are found as a common point of convex sets: each round enters all cones
 * that are still violated at once, by the smallest change, a little beyond their surface, so that
 * rounds end if the sets have a common interior.
 */
#include "located/open_forces.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "located/coupled.h"

enum { ROUNDS_MAX = 32 };
/* Relaxation factor: a round moves by this multiple of the distance to a cone's surface. */
static const double over_relaxation = 1.5;
/*
 * Largest effect of a kernel vector on a body, relative to its forces: only rounding, by which
 * different forces for the same motion may differ as well.
 */
static const double negligible = 1e-10;

/* Share of a kernel vector below which a part of it is rounding. */
static const double rounded_share = 0x1p-26;

/* Removes the component of v along `direction`, by the unknowns from `first` on. */
static void remove_component(double *v, const double *direction, size_t first, size_t n)
{
	double along = 0, square = 0;

	for (size_t i = first; i < n; i++) {
		along += v[i] * direction[i];
		square += direction[i] * direction[i];
	}
	for (size_t i = 0; i < n && square > 0; i++)
		v[i] -= along / square * direction[i];
}

/*
 * Kernel vectors, by which forces may differ, one for each open unknown, [n] each; NULL: out of
 * memory.
 */
static double *kernel_of(const struct rb_open_forces *open, size_t *count)
{
	const size_t n = (size_t)open->dense->n;
	size_t found = 0;

	*count = 0;
	for (int k = 0; k < open->dense->n; k++)
		found += rb_dense_is_open(open->dense, k);
	double *const direction = rb_arena_take(open->arena, found * n + 1, sizeof *direction);
	for (int k = 0; direction && k < open->dense->n; k++) {
		if (!rb_dense_is_open(open->dense, k))
			continue;
		rb_dense_opened(open->dense, k);
		memcpy(direction + n * (*count)++, open->dense->right, n * sizeof *direction);
	}
	return direction;
}

static double square_of(const double *v, size_t first, size_t n)
{
	double sum = 0;

	for (size_t i = first; i < n; i++)
		sum += v[i] * v[i];
	return sum;
}

/* Removes kernel vectors by the unknowns from `first` on; returns how many have none, put first. */
static size_t remove_kernel(double *direction, size_t count, size_t first, size_t n,
                            double *unknown)
{
	size_t left = 0;

	/* modified Gram-Schmidt; those removed so far are the last */
	for (size_t k = 0; k < count; k++) {
		double *const own = direction + n * k;

		for (size_t j = left; j < k; j++)
			remove_component(own, direction + n * j, first, n);
		if (square_of(own, first, n) >
		    rounded_share * rounded_share * square_of(own, 0, n)) {
			remove_component(unknown, own, first, n);
			continue;
		}
		for (size_t i = 0; i < n; i++) {
			const double other = direction[n * left + i];

			direction[n * left + i] = own[i];
			own[i] = other;
		}
		left++;
	}
	return left;
}

bool rb_open_forces_close(struct rb_open_forces *open, size_t first, double *unknown)
{
	const size_t n = (size_t)open->dense->n;
	const rb_arena_mark here = rb_arena_here(open->arena);
	size_t count;
	double *const direction = kernel_of(open, &count);

	if (!direction)
		return false;
	RB_ASSERT_COSTLY(first <= n);
	const size_t left = remove_kernel(direction, count, first, n, unknown);
	if (left > 0)
		remove_kernel(direction, left, 0, n, unknown);
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

/* Does a kernel vector have no effect on bodies, and on unknowns other than those of contacts? */
static bool has_no_effect(const struct rb_open_forces *open, const double *direction, rb_vec3 *sum)
{
	double forces = 0, torques = 0, force = 0, torque = 0, known = 0, all = 0;

	memset(sum, 0, 2 * (size_t)open->bodies * sizeof *sum);
	for (int k = 0; k < open->contacts; k++) {
		const struct rb_open_contact *c = &open->contact[k];
		const rb_vec3 f = force_of(c, direction);
		const double arm = fmax(c->a < 0 ? 0 : rb_vec3_length(c->arm_a),
		                        c->b < 0 ? 0 : rb_vec3_length(c->arm_b));

		press(c->a, c->arm_a, rb_vec3_neg(f), sum);
		press(c->b, c->arm_b, f, sum);
		forces = fmax(forces, rb_vec3_length(f));
		torques = fmax(torques, arm * rb_vec3_length(f));
		for (int r = 0; r < (c->slips ? 1 : 3); r++)
			known += direction[c->row + r] * direction[c->row + r];
	}
	for (int k = 0; k < open->dense->n; k++)
		all += direction[k] * direction[k];
	for (int k = 0; k < open->bodies; k++) {
		force = fmax(force, rb_vec3_length(sum[2 * k]));
		torque = fmax(torque, rb_vec3_length(sum[2 * k + 1]));
	}
	return all - known <= negligible * negligible * all && force <= negligible * forces &&
	       torque <= negligible * torques;
}

/*
 * Orthonormalizes the kernel vectors, or only those without effect, at the beginning of
 * `direction`; returns their number.
 */
static size_t orthonormalize(const struct rb_open_forces *open, bool moves, double *direction,
                             size_t count, rb_vec3 *sum)
{
	const size_t n = (size_t)open->dense->n;
	size_t kept = 0;

	for (size_t k = 0; k < count; k++) {
		double *const own = direction + n * kept;
		double square = 0;

		if (!moves && !has_no_effect(open, direction + n * k, sum))
			continue;
		memmove(own, direction + n * k, n * sizeof *own);
		for (size_t j = 0; j < kept; j++)
			remove_component(own, direction + n * j, 0, n);
		for (size_t i = 0; i < n; i++)
			square += own[i] * own[i];
		for (size_t i = 0; i < n && square > 0; i++)
			own[i] /= sqrt(square);
		kept += square > 0;
	}
	return kept;
}

/* Distance of a contact's force outside its cone, N, and the outward direction, by its unknowns. */
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

/*
 * Finds contacts outside their cones, with the components of the outward directions along the
 * kernel vectors; returns their number.
 */
static int outside_cones(const struct rb_open_forces *open, const double *unknown,
                         const double *direction, size_t count, double *excess, double *along)
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
			const double *const own = direction + n * j + c->row;

			along[(size_t)found * count + j] = c->slips
			                                           ? out.x * own[0]
			                                           : rb_vec3_dot(out,
			                                                         rb_vec3_from(own));
		}
		excess[found++] = by;
	}
	return found;
}

/* The smallest change along the kernel vectors that enters all these cones at once. */
static void enter(struct rb_dense *gram, const double *excess, const double *along, size_t count,
                  int found, double *step)
{
	gram->n = found;
	gram->first = NULL;
	for (int i = 0; i < found; i++) {
		gram->right[i] = -over_relaxation * excess[i];
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

bool rb_open_forces_keep_law(struct rb_open_forces *open, bool moves, double *unknown)
{
	const size_t n = (size_t)open->dense->n, contacts = (size_t)open->contacts;
	const rb_arena_mark here = rb_arena_here(open->arena);
	struct rb_dense gram = {.n = 0};
	size_t count;
	double *const direction = kernel_of(open, &count);
	rb_vec3 *const sum = rb_arena_take(open->arena, 2 * (size_t)open->bodies + 1, sizeof *sum);
	double *const now = rb_arena_take(open->arena, n + count + 1, sizeof *now);
	double *const excess = rb_arena_take(open->arena, contacts + 1, sizeof *excess);
	double *const along = rb_arena_take(open->arena, contacts * count + 1, sizeof *along);
	int outside_count = 1;

	if (!direction || !sum || !now || !excess || !along ||
	    !rb_coupled_reserve_dense(open->arena, &gram, open->contacts))
		return false;
	double *const step = now + n;
	count = orthonormalize(open, moves, direction, count, sum);
	memcpy(now, unknown, n * sizeof *now);
	for (int round = 0; round < ROUNDS_MAX && outside_count > 0 && count > 0; round++) {
		outside_count = outside_cones(open, now, direction, count, excess, along);
		if (outside_count == 0)
			break;
		enter(&gram, excess, along, count, outside_count, step);
		for (size_t k = 0; k < count; k++)
			for (size_t i = 0; i < n; i++)
				now[i] += step[k] * direction[n * k + i];
		open->dense->products += (long)(count * n + (size_t)outside_count *
		                                                    (size_t)outside_count * count);
	}
	if (outside_count == 0)
		memcpy(unknown, now, n * sizeof *now);
	rb_arena_back(open->arena, here);
	return true;
}
