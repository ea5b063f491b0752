/* SPDX-License-Identifier: MIT */
#include "located/coupled.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "located/external_force.h"

/*
 * Share of a row that must be independent for factors without pivots: its square root is the least
 * sine of the angle between a row and the previous ones.
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
	e->pivot = rb_arena_take(arena, (size_t)max + 1, sizeof *e->pivot);
	system->pivot = e->pivot;
	system->ends = rb_arena_take(arena, (size_t)max + 1, sizeof *system->ends);
	system->reach = rb_arena_take(arena, (size_t)max + 1, sizeof *system->reach);
	system->sorted = 0;
	if (!system->ends || !system->reach)
		return false;
	return system->row && system->first && system->of && system->inverse_inertia && e->block &&
	       e->of && e->pivot;
}

bool rb_coupled_reserve_right(struct rb_arena *arena, struct rb_dense *dense, int max)
{
	const size_t n = (size_t)max;

	dense->matrix = NULL;
	dense->right = rb_arena_take(arena, 4 * n + 1, sizeof *dense->right);
	dense->last = rb_arena_take(arena, 5 * n + 1, sizeof *dense->last);
	if (!dense->right || !dense->last)
		return false;
	dense->size = dense->right + n;
	dense->noise = dense->size + n;
	dense->found = dense->noise + n;
	dense->down = dense->last + n;
	dense->pivot = dense->down + n;
	dense->from = dense->pivot + n;
	dense->order = dense->from + n;
	return true;
}

bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max)
{
	if (!rb_coupled_reserve_right(arena, dense, max))
		return false;
	dense->matrix = rb_arena_take(arena, rb_envelope_size_max(max) + 1, sizeof *dense->matrix);
	return dense->matrix != NULL;
}

void rb_coupled_turn(const struct rb_coupled *system)
{
	const struct rb_located *l = system->l;

	for (int p = 0; l->top && p < system->body_count; p++) {
		const rb_mat3 *const own = rb_model_inverse_inertia(l->model, system->body[p]);
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
	if (!system->inverse_inertia) /* a single row */
		return rb_inverse_inertia_apply(system->l, system->body[place],
		                                system->pose[place].orientation, torque);
	return rb_mat3_apply(&system->inverse_inertia[place], torque);
}

struct rb_coupled_row rb_coupled_row(int a, int b, const struct rb_coupled_wrench *jacobian,
                                     const struct rb_coupled_wrench *unit)
{
	return (struct rb_coupled_row){
		.a = a,
		.b = b,
		.is_couple = rb_vec3_max_abs(jacobian->linear) == 0,
		.side = {{rb_vec3_neg(jacobian->linear), jacobian->angular_a,
	                  rb_vec3_neg(unit->linear), unit->angular_a},
	                 {jacobian->linear, jacobian->angular_b, unit->linear, unit->angular_b}}};
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

/* Do the rows have the same bodies as when they were sorted? */
static bool is_sorted(const struct rb_coupled *system)
{
	bool same = system->count == system->sorted;

	for (int k = 0; k < system->count && same; k++)
		same = system->row[k].a == system->ends[k][0] &&
		       system->row[k].b == system->ends[k][1];
	return same;
}

/* The first row that acts on the body at `place`, if it comes before `first`. */
static int reach_back(const struct rb_coupled *system, int place, int first)
{
	if (place < 0)
		return first;
	const int begin = system->of[system->first[place]].row;

	return begin < first ? begin : first;
}

/* Blocks of rows, and their first columns. */
static void lay_out(struct rb_coupled *system)
{
	struct rb_envelope *const factor = &system->factor;
	int first = system->count;

	for (int k = system->count; k-- > 0;) {
		/* no later row begins earlier */
		first = first < k ? first : k;
		first = reach_back(system, system->row[k].a, first);
		first = reach_back(system, system->row[k].b, first);
		system->reach[k] = first;
	}
	factor->n = system->count;
	factor->block_count = 0;
	for (int k = 0; k < system->count; k++) {
		const struct rb_coupled_row *row = &system->row[k];
		struct rb_envelope_block *const block = &factor->block[factor->block_count];

		if (k > 0 && row->a == row[-1].a && row->b == row[-1].b &&
		    block[-1].count < RB_ENVELOPE_BLOCK) {
			block[-1].count++;
			continue;
		}
		*block = (struct rb_envelope_block){
			.begin = k, .count = 1, .first = system->reach[k]};
		factor->block_count++;
	}
}

void rb_coupled_sort(struct rb_coupled *system)
{
	int *const next = system->first + 1;

	if (is_sorted(system))
		return;
	memset(system->first, 0, ((size_t)system->body_count + 2) * sizeof *system->first);
	for (int k = 0; k < system->count; k++) {
		const struct rb_coupled_row *row = &system->row[k];

		RB_ASSERT_COSTLY(row->a < system->body_count && row->b < system->body_count);
		system->ends[k][0] = row->a;
		system->ends[k][1] = row->b;
		if (row->a >= 0)
			next[row->a + 1]++;
		if (row->b >= 0)
			next[row->b + 1]++;
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
	system->sorted = system->count;
	lay_out(system);
	if (system->kept)
		memset(system->kept->used, 0, sizeof system->kept->used);
}

/* Uses the factors of a slot, and the multipliers beside them. */
static void use_slot(struct rb_coupled *system, int slot)
{
	struct rb_coupled_kept *const kept = system->kept;
	double *const at = *kept->block + (size_t)slot * kept->size;

	system->factor.pivot = at;
	system->kept_multiplier = at + system->count;
	system->factor.value = at + 2 * system->count;
}

/* The same for the dense system. */
static void use_pivots(struct rb_coupled *system, struct rb_dense *dense, int slot)
{
	const size_t n = (size_t)system->count;
	double *const at = *system->kept->block + (size_t)slot * system->kept->size;
	int *const place = (int *)(at + n + n * n);

	system->kept_multiplier = at;
	dense->matrix = at + n;
	dense->last = place;
	dense->down = place + n;
	dense->pivot = place + 2 * n;
	dense->from = place + 3 * n;
	dense->order = place + 4 * n;
}

bool rb_coupled_find(struct rb_coupled *system, struct rb_dense *dense, double t,
                     double *multiplier)
{
	struct rb_coupled_kept *const kept = system->kept;

	if (!kept || (!system->is_symmetric && !system->keeps_pivots))
		return false;
	for (int s = 0; s < RB_COUPLED_KEPT; s++)
		if (kept->used[s] && kept->time_s[s] == t && is_sorted(system) &&
		    (!kept->has_pivots[s] || kept->least == dense->least)) {
			if (kept->has_pivots[s]) {
				*dense = kept->dense[s];
				system->kept_multiplier = dense->matrix - system->count;
			} else {
				use_slot(system, s);
			}
			system->is_factored = !kept->has_pivots[s];
			kept->found = true;
			memcpy(multiplier, system->kept_multiplier,
			       (size_t)system->count * sizeof *multiplier);
			return true;
		}
	return false;
}

static void drop(struct rb_coupled *system, double t)
{
	for (int s = 0; s < RB_COUPLED_KEPT; s++)
		if (system->kept->time_s[s] == t)
			system->kept->used[s] = false;
}

bool rb_coupled_accept(struct rb_coupled *system, const struct rb_dense *dense, double t,
                       const double *multiplier, double residual, double rounding)
{
	struct rb_coupled_kept *const kept = system->kept;

	if (!system->kept_multiplier)
		return true;
	if (kept->found && !(residual <= 4 * fmax(rounding, kept->residual))) {
		drop(system, t);
		return false;
	}
	if (!kept->found)
		kept->residual = fmax(kept->residual, residual);
	if (!kept->found && !system->is_factored) {
		kept->dense[kept->slot] = *dense;
		kept->used[kept->slot] = true;
	}
	memcpy(system->kept_multiplier, multiplier, (size_t)system->count * sizeof *multiplier);
	return true;
}

/* Takes the oldest slot for factors of that size at `t`; false: none are kept. */
static bool take_slot(struct rb_coupled *system, size_t size, double t, bool has_pivots)
{
	struct rb_coupled_kept *const kept = system->kept;

	if (!kept || !rb_memory_reserve(kept->block, kept->capacity, RB_COUPLED_KEPT * size,
	                                sizeof **kept->block))
		return false;
	if (size != kept->size)
		memset(kept->used, 0, sizeof kept->used);
	kept->size = size;
	kept->slot = kept->next;
	kept->time_s[kept->slot] = t;
	kept->used[kept->slot] = !has_pivots; /* otherwise once they are found */
	kept->has_pivots[kept->slot] = has_pivots;
	kept->next = (kept->next + 1) % RB_COUPLED_KEPT;
	return true;
}

/*
 * Chooses the storage for factors of that size: the oldest slot, or that of the dense system; NULL:
 * out of memory.
 */
static void choose_values(struct rb_coupled *system, size_t size, double t)
{
	struct rb_coupled_kept *const kept = system->kept;

	system->factor.value = system->own.matrix;
	system->factor.pivot = system->pivot;
	system->kept_multiplier = NULL;
	if (kept)
		kept->found = false;
	if (take_slot(system, size + 2 * (size_t)system->count, t, false))
		use_slot(system, kept->slot);
	else if (!system->own.matrix)
		system->factor.value = rb_arena_take(system->l->arena, size + 1, sizeof(double));
}

/* The same for the matrix of the dense system. */
static void choose_pivots(struct rb_coupled *system, struct rb_dense *dense, double t)
{
	enum { PIVOTS_MAX = 1024 }; /* unknowns: eight matrices are 64 MB */
	struct rb_coupled_kept *const kept = system->kept;
	const size_t n = (size_t)system->count;

	if (!system->own.matrix)
		system->own.matrix = rb_arena_take(system->l->arena, n * n + 1, sizeof(double));
	dense->matrix = system->own.matrix;
	dense->last = system->own.last;
	dense->down = system->own.down;
	dense->pivot = system->own.pivot;
	dense->from = system->own.from;
	dense->order = system->own.order;
	system->kept_multiplier = NULL;
	if (!kept)
		return;
	drop(system, t);
	kept->found = false;
	if (!system->keeps_pivots || n > PIVOTS_MAX || !take_slot(system, n * (n + 4) + 1, t, true))
		return;
	kept->least = dense->least;
	use_pivots(system, dense, kept->slot);
}

/* Entries `first` to `last` of a row of a matrix, `stride` apart. */
struct strip {
	double *to;
	size_t stride;
	int first, last;
};

/* Adds, for one body of a row, its response to the unknowns that act on it. */
static void fill_side(const struct rb_coupled *system, int place,
                      const struct rb_coupled_side *side, const struct strip *strip)
{
	if (place < 0)
		return;
	const struct rb_coupled_at *at = system->of + system->first[place];
	const struct rb_coupled_at *const end = system->of + system->first[place + 1];
	const rb_vec3 l = side->jacobian_linear, m = side->jacobian_angular;
	/* a scalar product in each half, in the order of axes: terms that cancel do so exactly */
	const pair x = {l.x, m.x}, y = {l.y, m.y}, z = {l.z, m.z};

	for (; at < end && at->row <= strip->last; at++) {
		const rb_vec3 linear = at->side->linear, angular = at->side->angular;
		const pair sum = x * (pair){linear.x, angular.x} + y * (pair){linear.y, angular.y} +
		                 z * (pair){linear.z, angular.z};

		strip->to[(size_t)(at->row - strip->first) * strip->stride] += sum[0] + sum[1];
	}
}

static void fill_strip(const struct rb_coupled *system, int k, const struct strip *strip)
{
	const struct rb_coupled_row *const row = &system->row[k];

	fill_side(system, row->a, &row->side[0], strip);
	fill_side(system, row->b, &row->side[1], strip);
}

/* Factors the system; false: rows may depend on each other, or factor.value is NULL. */
static bool factor(struct rb_coupled *system, struct rb_dense *dense, double t)
{
	struct rb_envelope *const f = &system->factor;
	const size_t size = rb_envelope_lay_out(f);

	dense->products = 0;
	for (int i = 0; i < f->block_count; i++) {
		const struct rb_envelope_block *const block = &f->block[i];
		const long width = block->begin + block->count - block->first;

		dense->products += block->count * width * (width + 3) / 2;
	}
	choose_values(system, size, t);
	if (!f->value)
		return false;
	memset(f->value, 0, size * sizeof *f->value);
	for (int k = 0; k < f->n; k++) {
		struct strip strip = {.first = f->block[f->of[k]].first, .last = k};

		strip.to = rb_envelope_row(f, k, &strip.stride);
		fill_strip(system, k, &strip);
	}
	dense->open = false;
	dense->late = 0;
	return rb_envelope_factor(f, independent);
}

/* The last row that acts on the body at `place`, if it comes after `last`. */
static int reach_on(const struct rb_coupled *system, int place, int last)
{
	if (place < 0)
		return last;
	const int end = system->of[system->first[place + 1] - 1].row;

	return end > last ? end : last;
}

bool rb_coupled_fill(struct rb_coupled *system, struct rb_dense *dense, double t)
{
	const int n = system->count;
	struct rb_coupled_kept *const kept = system->kept;

	RB_ASSERT_COSTLY(dense->n == n && system->sorted == n);
	if (!system->own.matrix)
		system->own = *dense;
	dense->first = system->reach;
	/*
	 * with a single joint there is nothing to save, and pivots leave a smaller residual of
	 * balanced loads
	 */
	const bool tries = system->is_symmetric && system->factor.block_count > 1 &&
	                   !(kept && kept->depends);
	system->is_factored = tries && factor(system, dense, t);
	if (system->is_factored || (tries && !system->factor.value))
		return system->is_factored;
	if (kept && tries)
		kept->depends = true;
	choose_pivots(system, dense, t);
	if (!dense->matrix)
		return false;
	int *const last = dense->last;

	for (int k = 0; k < n; k++) {
		last[k] = reach_on(system, system->row[k].b, reach_on(system, system->row[k].a, k));
		const struct strip strip = {.to = dense->matrix + (size_t)k * (size_t)n +
		                                  dense->first[k],
		                            .stride = 1,
		                            .first = dense->first[k],
		                            .last = last[k]};

		memset(strip.to, 0, (size_t)(last[k] + 1 - strip.first) * sizeof *strip.to);
		fill_strip(system, k, &strip);
	}
	return true;
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

double rb_coupled_rate(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular)
{
	double sum = 0;

	for (int e = 0; e < 2; e++) {
		const int place = e == 0 ? row->a : row->b;
		const struct rb_coupled_side *const side = &row->side[e];

		if (place < 0)
			continue;
		sum += rb_vec3_dot(side->jacobian_angular, angular[place]);
		if (!row->is_couple)
			sum += rb_vec3_dot(side->jacobian_linear, linear[place]);
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
