/* SPDX-License-Identifier: MIT */
#include "located/other_forces.h"

#include <math.h>
#include <string.h>

#include "located/rates.h"

/*
 * Directs creeping slips opposite to all of their friction. The friction that turning has left
 * across them is far larger than the difference of two solutions for the same motion.
 */
static void oppose_creeping(struct rb_modes *w)
{
	for (int k = 0; k < w->c->held_count; k++) {
		const rb_vec3 friction = rb_vec3_reject(w->force[k], w->contact_point[k].normal);

		if (w->c->held[k].creeps)
			w->contact[k].slip = rb_vec3_unit(rb_vec3_neg(friction),
			                                  w->contact[k].slip);
	}
}

/*
 * Sets accelerations to those by admissible forces near the present ones; `*max`, m/s^2: by all
 * other forces. False: out of memory, or l->status.
 */
static bool solve(struct rb_modes *w, double t, double *max)
{
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	struct rb_solver_body *found = NULL;

	if (!rb_rates_external(w, t, max) || !rb_modes_solve_any(w, t, &found))
		return false;
	for (int k = 0; k < w->c->member_count; k++) {
		w->linear[k] = found[k].linear;
		w->angular[k] = found[k].angular;
	}
	rb_arena_back(w->l->arena, here);
	return true;
}

/*
 * Violations of the rows of joints and stops by the present accelerations, m/s^2: their sum, since
 * the forces share among all of them what an elimination leaves to one.
 */
static double violation_of(const struct rb_modes *w)
{
	double sum = 0;

	for (int k = 0; k < w->joints.count; k++) {
		const struct rb_joint_row *const row = &w->joints.row[k];
		const struct rb_coupled_row coupled = rb_joint_rows_coupled(row);
		const double rate = rb_coupled_rate(&coupled, w->linear, w->angular) + row->bias;

		sum += rb_joint_rows_is_stop(row) ? fmax(0, -rate) : fabs(rate);
	}
	return sum;
}

/* Are there stops that hold, and no rows besides those of joints, which hold without bounds? */
static bool stops_hold(const struct rb_modes *w)
{
	bool all = w->c->held_count == 0, any = false;

	for (int k = 0; k < w->joints.count; k++) {
		const bool stop = rb_joint_rows_is_stop(&w->joints.row[k]);

		all = all && (stop || w->joints.row[k].drive < 0);
		any = any || stop;
	}
	return all && any;
}

bool rb_other_forces_hold(struct rb_modes *w, double t)
{
	const size_t count = (size_t)w->c->member_count;
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	rb_vec3 *const before = rb_arena_take(w->l->arena, 2 * count, sizeof *before);
	double max = 0, off = 0;

	if (!before)
		return false;
	memcpy(before, w->linear, count * sizeof *before);
	memcpy(before + count, w->angular, count * sizeof *before);
	oppose_creeping(w);
	if (!solve(w, t, &max))
		return false;
	for (size_t k = 0; k < count; k++) {
		max = fmax(max, rb_vec3_max_abs(w->linear[k]));
		off = fmax(off, rb_vec3_max_abs(rb_vec3_sub(w->linear[k], before[k])));
		if (w->l->top)
			off = fmax(off, rb_model_reach(w->l->model, w->c->member[k]) *
			                        rb_vec3_max_abs(rb_vec3_sub(w->angular[k],
			                                                    before[count + k])));
	}
	rb_arena_back(w->l->arena, here);
	return off <= RB_OTHER_FORCES_SAME * max;
}

bool rb_other_forces_contradict(struct rb_modes *w, double t, const double *value)
{
	double max;

	if (!rb_rates_evaluate(w, t, value))
		return false;
	return w->dense.open && stops_hold(w) && w->residual > RB_OTHER_FORCES_SAME * w->max &&
	       solve(w, t, &max) && violation_of(w) > RB_OTHER_FORCES_SAME * fmax(max, w->max);
}
