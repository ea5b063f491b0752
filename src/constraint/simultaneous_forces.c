/* SPDX-License-Identifier: MIT */
#include "constraint/simultaneous_forces.h"

#include <math.h>

#include "constraint/coulomb.h"

/* Fills the rows; brings the guessed forces into their sets. */
static void begin_forces(struct rb_simultaneous *problem, struct rb_cone *cone,
                         rb_along_across *guess)
{
	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *const c = &problem->contact[k];
		struct rb_cone_row *const row = &cone->row[k];
		const double known = fmax(0, rb_vec3_dot(c->impulse, c->normal));
		/*
		 * with large friction, n is limited by |force| / friction: large forces would round
		 */
		const double n = c->mode == RB_SOLVER_SLIDE && c->friction > 1
		                         ? fmin(known, rb_vec3_length(c->impulse) / c->friction)
		                         : known;
		rb_vec3 t = rb_vec3_add_scaled(c->impulse, -n, c->normal);

		*row = rb_simultaneous_row(c);
		row->bias = c->bias;
		row->slip = c->slip;
		row->slide = c->mode == RB_SOLVER_SLIDE;
		t = rb_vec3_add_scaled(t, -rb_vec3_dot(t, c->normal), c->normal);
		const double length = rb_vec3_length(t);
		if (row->slide)
			t = rb_vec3_scale(-c->friction * n, c->slip);
		else if (length > c->friction * n)
			t = rb_vec3_scale(c->friction * n / length, t);
		guess[k] = (rb_along_across){n, t};
	}
	for (int k = 0; k < problem->joint_count; k++) {
		const struct rb_constraint *const base = &problem->joint_row[k].base;
		const double n = fmin(fmax(base->impulse.n, base->low), base->high);

		cone->row[problem->contact_count + k] = problem->joint_row[k];
		guess[problem->contact_count + k] = (rb_along_across){
			base->set == RB_CONSTRAINT_INTERVAL ? n : base->impulse.n, base->impulse.t};
	}
}

/* The largest of the accelerations whose difference is that of a joint's row, m/s^2. */
static double joint_scale(const struct rb_simultaneous *problem, const struct rb_cone_row *row)
{
	const struct rb_solver_body *a = &problem->body[row->base.a],
				    *b = &problem->body[row->base.b];
	const rb_vec3 none = {0, 0, 0};

	if (row->base.couple)
		return fmax(rb_vec3_length(row->bias),
		            row->base.arm_a.x *
		                    fmax(rb_vec3_length(a->angular), rb_vec3_length(b->angular)));
	return fmax(fmax(rb_vec3_length(row->bias), rb_solver_speed_bound(a, none)),
	            rb_solver_speed_bound(b, none));
}

double rb_simultaneous_forces(struct rb_simultaneous *problem)
{
	const rb_arena_mark here = rb_arena_here(problem->arena);
	const size_t contacts = (size_t)problem->contact_count;
	const size_t rows = contacts + (size_t)problem->joint_count;
	struct rb_cone cone = {.bodies = rb_simultaneous_bodies(problem),
	                       .body_count = problem->body_count,
	                       .row_count = (int)rows,
	                       .arena = problem->arena,
	                       .probes = problem->probes,
	                       .max = problem->products_max,
	                       .interrupt = problem->interrupt};
	rb_along_across *const guess = rb_arena_take(problem->arena, rows, sizeof *guess);
	double scale = 0;

	cone.row = rb_arena_take(problem->arena, rows, sizeof *cone.row);
	if (guess && cone.row)
		begin_forces(problem, &cone, guess);
	if (!guess || !cone.row || !rb_cone_open(&cone)) {
		rb_arena_back(problem->arena, here);
		return (double)INFINITY;
	}
	for (size_t k = 0; k < contacts; k++)
		scale = fmax(scale, fmax(rb_simultaneous_scale(problem, &problem->contact[k]),
		                         rb_vec3_length(problem->contact[k].bias)));
	for (int k = 0; k < problem->joint_count; k++) {
		rb_constraint_clear(&cone.row[contacts + (size_t)k].base);
		scale = fmax(scale, joint_scale(problem, &problem->joint_row[k]));
	}
	rb_cone_apply(&cone, guess);
	const double residual = rb_cone_resolve(&cone, scale);
	problem->products = cone.iterations;
	for (size_t k = 0; k < contacts; k++) {
		struct rb_solver_contact *const c = &problem->contact[k];
		const struct rb_cone_row *const row = &cone.row[k];

		c->impulse = rb_constraint_impulse(&row->base);
		c->slipping = row->base.impulse.n > 0 && row->friction_impulse != RB_CONE_STICK &&
		              rb_vec3_length(row->u.t) > 1e-12 * scale;
	}
	for (int k = 0; k < problem->joint_count; k++)
		problem->joint_row[k].base.impulse = cone.row[contacts + (size_t)k].base.impulse;
	rb_arena_back(problem->arena, here);
	return residual;
}
