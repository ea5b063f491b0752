/* SPDX-License-Identifier: MIT */
#include "located/coupled.h"

#include <string.h>

#include "base/error.h"
#include "located/external_force.h"

bool rb_coupled_reserve(struct rb_coupled *system, int max)
{
	struct rb_arena *const arena = system->l->arena;

	RB_ASSERT(max >= 0 && system->body_count >= 0);
	system->max = max;
	system->count = 0;
	system->row = rb_arena_take(arena, (size_t)max + 1, sizeof *system->row);
	system->first = rb_arena_take(arena, (size_t)system->body_count + 2, sizeof *system->first);
	system->of = rb_arena_take(arena, 2 * (size_t)max + 1, sizeof *system->of);
	return system->row && system->first && system->of;
}

bool rb_coupled_reserve_dense(struct rb_arena *arena, struct rb_dense *dense, int max)
{
	const size_t n = (size_t)max;

	dense->matrix = rb_arena_take(arena, n * n + 1, sizeof *dense->matrix);
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

static rb_vec3 turned_by(const struct rb_coupled *system, int place, rb_vec3 torque)
{
	const struct rb_located *l = system->l;

	if (!l->top)
		return (rb_vec3){0, 0, 0};
	return rb_inverse_inertia_apply(l, system->body[place], system->pose[place].orientation,
	                                torque);
}

void rb_coupled_respond(const struct rb_coupled *system, struct rb_coupled_row *row)
{
	const double *const inverse = system->l->model->inverse_mass;
	const rb_vec3 none = {0, 0, 0};

	row->linear_a = row->turn_a = row->linear_b = row->turn_b = none;
	if (row->a >= 0) {
		row->linear_a = rb_vec3_scale(-inverse[system->body[row->a]], row->unit.linear);
		row->turn_a = turned_by(system, row->a, row->unit.angular_a);
	}
	if (row->b >= 0) {
		row->linear_b = rb_vec3_scale(inverse[system->body[row->b]], row->unit.linear);
		row->turn_b = turned_by(system, row->b, row->unit.angular_b);
	}
}

void rb_coupled_sort(struct rb_coupled *system)
{
	int *const next = system->first + 1;

	memset(system->first, 0, ((size_t)system->body_count + 2) * sizeof *system->first);
	for (int k = 0; k < system->count; k++) {
		const struct rb_coupled_row *row = &system->row[k];

		RB_ASSERT_COSTLY(row->a < system->body_count && row->b < system->body_count);
		if (row->a >= 0)
			next[row->a + 1]++;
		if (row->b >= 0)
			next[row->b + 1]++;
	}
	for (int p = 0; p < system->body_count; p++)
		next[p + 1] += next[p];
	for (int k = 0; k < system->count; k++) {
		if (system->row[k].a >= 0)
			system->of[next[system->row[k].a]++] = k;
		if (system->row[k].b >= 0)
			system->of[next[system->row[k].b]++] = k;
	}
}

/* Of row i, what its body at that place feels of unknown j. */
static double entry(const struct rb_coupled_row *i, bool i_is_b, const struct rb_coupled_row *j,
                    int place)
{
	const bool j_is_b = j->b == place;
	const rb_vec3 linear = j_is_b ? j->linear_b : j->linear_a;
	const rb_vec3 turn = j_is_b ? j->turn_b : j->turn_a;
	const double along = rb_vec3_dot(i->asked.linear, linear);

	return (i_is_b ? along : -along) +
	       rb_vec3_dot(i_is_b ? i->asked.angular_b : i->asked.angular_a, turn);
}

static void fill_side(const struct rb_coupled *system, const struct rb_coupled_row *row, bool is_b,
                      double *to)
{
	const int place = is_b ? row->b : row->a;

	for (int e = place >= 0 ? system->first[place] : 0;
	     place >= 0 && e < system->first[place + 1]; e++)
		to[system->of[e]] += entry(row, is_b, &system->row[system->of[e]], place);
}

/* Widens the ends of a row to all that act on the body at `place`. */
static void reach(const struct rb_coupled *system, int place, int *first, int *last)
{
	if (place < 0)
		return;
	const int begin = system->of[system->first[place]];
	const int end = system->of[system->first[place + 1] - 1];

	*first = begin < *first ? begin : *first;
	*last = end > *last ? end : *last;
}

void rb_coupled_fill(const struct rb_coupled *system, struct rb_dense *dense)
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
	for (int k = 0; k < n; k++) {
		double *const to = dense->matrix + (size_t)k * (size_t)n;

		memset(to + first[k], 0, (size_t)(last[k] + 1 - first[k]) * sizeof *to);
		fill_side(system, &system->row[k], false, to);
		fill_side(system, &system->row[k], true, to);
	}
	dense->first = first;
}

double rb_coupled_felt(const struct rb_coupled_row *row, const rb_vec3 *linear,
                       const rb_vec3 *angular)
{
	double sum = 0;

	if (row->a >= 0)
		sum = rb_vec3_dot(row->asked.angular_a, angular[row->a]) -
		      rb_vec3_dot(row->asked.linear, linear[row->a]);
	if (row->b >= 0)
		sum += rb_vec3_dot(row->asked.linear, linear[row->b]) +
		       rb_vec3_dot(row->asked.angular_b, angular[row->b]);
	return sum;
}

void rb_coupled_add(const struct rb_coupled_row *row, double share, rb_vec3 *linear,
                    rb_vec3 *angular)
{
	if (row->a >= 0) {
		linear[row->a] = rb_vec3_add_scaled(linear[row->a], share, row->linear_a);
		angular[row->a] = rb_vec3_add_scaled(angular[row->a], share, row->turn_a);
	}
	if (row->b >= 0) {
		linear[row->b] = rb_vec3_add_scaled(linear[row->b], share, row->linear_b);
		angular[row->b] = rb_vec3_add_scaled(angular[row->b], share, row->turn_b);
	}
}
