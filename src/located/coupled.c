/* SPDX-License-Identifier: MIT */
#include "located/coupled.h"

#include <string.h>

#include "base/error.h"
#include "located/external_force.h"

/*
 * What has to be left of a row for factors without pivots: its square root is the least sine of the
 * angle between a row and those before it.
 */
static const double independent = 0x1p-26;

typedef double pair __attribute__((vector_size(2 * sizeof(double))));

bool rb_coupled_reserve(struct rb_coupled *system, int max)
{
	struct rb_arena *const arena = system->l->arena;

	RB_ASSERT(max >= 0 && system->body_count >= 0);
	system->max = max;
	system->count = 0;
	system->row = rb_arena_take(arena, (size_t)max + 1, sizeof *system->row);
	system->first = rb_arena_take(arena, (size_t)system->body_count + 2, sizeof *system->first);
	system->of = rb_arena_take(arena, 2 * (size_t)max + 1, sizeof *system->of);
	system->inverse_inertia = rb_arena_take(arena, (size_t)system->body_count + 1,
	                                        sizeof *system->inverse_inertia);
	struct rb_envelope *const e = &system->factor;

	e->block = rb_arena_take(arena, (size_t)max + 1, sizeof *e->block);
	e->of = rb_arena_take(arena, (size_t)max + 1, sizeof *e->of);
	e->inverse = rb_arena_take(arena, (size_t)max + 1, sizeof *e->inverse);
	return system->row && system->first && system->of && system->inverse_inertia && e->block &&
	       e->of && e->inverse;
}

bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max)
{
	const size_t n = (size_t)max;

	dense->matrix = rb_arena_take(arena, rb_envelope_size_max(max) + 1, sizeof *dense->matrix);
	dense->right = rb_arena_take(arena, 3 * n + 1, sizeof *dense->right);
	dense->last = rb_arena_take(arena, 6 * n + 1, sizeof *dense->last);
	if (!dense->matrix || !dense->right || !dense->last)
		return false;
	dense->size = dense->right + n;
	dense->found = dense->size + n;
	dense->down = dense->last + n;
	dense->pivot = dense->down + n;
	dense->from = dense->pivot + n;
	dense->order = dense->from + n;
	return true;
}

void rb_coupled_turn(const struct rb_coupled *system)
{
	const struct rb_located *l = system->l;

	for (int p = 0; l->top && p < system->body_count; p++) {
		const rb_mat3 *const own = &l->model->inverse_inertia[system->body[p]];
		const double scalar = l->model->inverse_inertia_scalar[system->body[p]];
		rb_mat3 *const to = &system->inverse_inertia[p];

		*to = rb_mat3_diagonal(scalar, scalar, scalar);
		if (!isnan(scalar))
			continue;
		const rb_mat3 turn = rb_quat_to_mat3(system->pose[p].orientation);
		const rb_mat3 half = rb_mat3_multiply(&turn, own), back = rb_mat3_transposed(&turn);
		*to = rb_mat3_multiply(&half, &back);
	}
}

static rb_vec3 turned_by(const struct rb_coupled *system, int place, rb_vec3 torque)
{
	if (!system->l->top)
		return (rb_vec3){0, 0, 0};
	if (!system->inverse_inertia) /* a row on its own */
		return rb_inverse_inertia_apply(system->l, system->body[place],
		                                system->pose[place].orientation, torque);
	return rb_mat3_apply(&system->inverse_inertia[place], torque);
}

struct rb_coupled_row rb_coupled_row(int a, int b, const struct rb_coupled_wrench *asked,
                                     const struct rb_coupled_wrench *unit)
{
	return (struct rb_coupled_row){
		.a = a,
		.b = b,
		.is_couple = rb_vec3_max_abs(asked->linear) == 0,
		.side = {{rb_vec3_neg(asked->linear), asked->angular_a, rb_vec3_neg(unit->linear),
	                  unit->angular_a},
	                 {asked->linear, asked->angular_b, unit->linear, unit->angular_b}}};
}

void rb_coupled_respond(const struct rb_coupled *system, struct rb_coupled_row *row)
{
	const double *const inverse = system->l->model->inverse_mass;

	for (int e = 0; e < 2; e++) {
		const int place = e == 0 ? row->a : row->b;
		struct rb_coupled_side *const side = &row->side[e];

		if (place < 0)
			continue;
		side->linear = rb_vec3_scale(inverse[system->body[place]], side->linear);
		side->angular = turned_by(system, place, side->angular);
	}
}

void rb_coupled_sort(struct rb_coupled *system)
{
	struct rb_envelope *const factor = &system->factor;
	int *const next = system->first + 1;

	memset(system->first, 0, ((size_t)system->body_count + 2) * sizeof *system->first);
	factor->n = system->count;
	factor->block_count = 0;
	for (int k = 0; k < system->count; k++) {
		const struct rb_coupled_row *row = &system->row[k];
		struct rb_envelope_block *const block = &factor->block[factor->block_count];

		RB_ASSERT_COSTLY(row->a < system->body_count && row->b < system->body_count);
		if (row->a >= 0)
			next[row->a + 1]++;
		if (row->b >= 0)
			next[row->b + 1]++;
		if (k > 0 && row->a == row[-1].a && row->b == row[-1].b &&
		    block[-1].count < RB_ENVELOPE_BLOCK) {
			block[-1].count++;
		} else {
			*block = (struct rb_envelope_block){.begin = k, .count = 1};
			factor->block_count++;
		}
	}
	for (int p = 0; p < system->body_count; p++)
		next[p + 1] += next[p];
	for (int k = 0; k < system->count; k++) {
		const struct rb_coupled_row *row = &system->row[k];

		if (row->a >= 0)
			system->of[next[row->a]++] = (struct rb_coupled_at){&row->side[0], k};
		if (row->b >= 0)
			system->of[next[row->b]++] = (struct rb_coupled_at){&row->side[1], k};
	}
}

/* Entries `first` to `last` of a row of a matrix, `stride` apart. */
struct strip {
	double *to;
	size_t stride;
	int first, last;
};

/* Of a side of a row, what its body feels of the unknowns that act on it. */
static void fill_side(const struct rb_coupled *system, int place,
                      const struct rb_coupled_side *side, const struct strip *strip)
{
	if (place < 0)
		return;
	const struct rb_coupled_at *at = system->of + system->first[place];
	const struct rb_coupled_at *const end = system->of + system->first[place + 1];
	const rb_vec3 l = side->asked_linear, m = side->asked_angular;
	const pair x = {l.x, l.y}, y = {l.z, m.x}, z = {m.y, m.z};

	for (; at < end && at->row <= strip->last; at++) {
		const rb_vec3 linear = at->side->linear, angular = at->side->angular;
		const pair sum = x * (pair){linear.x, linear.y} + y * (pair){linear.z, angular.x} +
		                 z * (pair){angular.y, angular.z};

		strip->to[(size_t)(at->row - strip->first) * strip->stride] += sum[0] + sum[1];
	}
}

static void fill_strip(const struct rb_coupled *system, int k, const struct strip *strip)
{
	const struct rb_coupled_row *const row = &system->row[k];

	fill_side(system, row->a, &row->side[0], strip);
	fill_side(system, row->b, &row->side[1], strip);
}

/* Widens the ends of a row to all that act on the body at `place`. */
static void reach(const struct rb_coupled *system, int place, int *first, int *last)
{
	if (place < 0)
		return;
	const int begin = system->of[system->first[place]].row;
	const int end = system->of[system->first[place + 1] - 1].row;

	*first = begin < *first ? begin : *first;
	*last = end > *last ? end : *last;
}

/* Factors; false: rows may depend on each other. */
static bool factor(struct rb_coupled *system, struct rb_dense *dense)
{
	struct rb_envelope *const f = &system->factor;

	f->value = dense->matrix;
	dense->products = 0;
	for (int i = 0; i < f->block_count; i++) {
		struct rb_envelope_block *const block = &f->block[i];
		const long width = block->begin + block->count - dense->first[block->begin];

		block->first = dense->first[block->begin];
		dense->products += block->count * width * (width + 3) / 2;
	}
	memset(f->value, 0, rb_envelope_lay_out(f) * sizeof *f->value);
	for (int k = 0; k < f->n; k++) {
		struct strip strip = {.first = f->block[f->of[k]].first, .last = k};

		strip.to = rb_envelope_row(f, k, &strip.stride);
		fill_strip(system, k, &strip);
	}
	dense->open = false;
	dense->late = 0;
	return rb_envelope_factor(f, independent);
}

void rb_coupled_fill(struct rb_coupled *system, struct rb_dense *dense)
{
	const int n = system->count;
	int *const first = dense->order + n, *const last = dense->last;

	RB_ASSERT_COSTLY(dense->n == n);
	for (int k = n; k-- > 0;) {
		/* no later row begins before */
		first[k] = k + 1 < n && first[k + 1] < k ? first[k + 1] : k;
		last[k] = k;
		reach(system, system->row[k].a, &first[k], &last[k]);
		reach(system, system->row[k].b, &first[k], &last[k]);
	}
	dense->first = first;
	system->is_factored = system->is_symmetric && factor(system, dense);
	for (int k = 0; k < n && !system->is_factored; k++) {
		const struct strip strip = {.to = dense->matrix + (size_t)k * (size_t)n + first[k],
		                            .stride = 1,
		                            .first = first[k],
		                            .last = last[k]};

		memset(strip.to, 0, (size_t)(last[k] + 1 - first[k]) * sizeof *strip.to);
		fill_strip(system, k, &strip);
	}
}

void rb_coupled_solve(const struct rb_coupled *system, struct rb_dense *dense)
{
	if (system->is_factored)
		rb_envelope_solve(&system->factor, dense->right);
	else
		rb_dense_solve(dense);
}

void rb_coupled_again(const struct rb_coupled *system, struct rb_dense *dense)
{
	if (system->is_factored)
		rb_envelope_solve(&system->factor, dense->right);
	else
		rb_dense_again(dense);
}

double rb_coupled_felt(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular)
{
	double sum = 0;

	for (int e = 0; e < 2; e++) {
		const int place = e == 0 ? row->a : row->b;
		const struct rb_coupled_side *const side = &row->side[e];

		if (place < 0)
			continue;
		sum += rb_vec3_dot(side->asked_angular, angular[place]);
		if (!row->is_couple)
			sum += rb_vec3_dot(side->asked_linear, linear[place]);
	}
	return sum;
}

void rb_coupled_add(const struct rb_coupled_row *row, double share, rb_vec3 *linear,
                    rb_vec3 *angular)
{
	for (int e = 0; e < 2; e++) {
		const int place = e == 0 ? row->a : row->b;
		const struct rb_coupled_side *const side = &row->side[e];

		if (place < 0)
			continue;
		linear[place] = rb_vec3_add_scaled(linear[place], share, side->linear);
		angular[place] = rb_vec3_add_scaled(angular[place], share, side->angular);
	}
}
