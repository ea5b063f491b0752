/* SPDX-License-Identifier: MIT */
#include "constraint/coulomb.h"

#include <float.h>
#include <string.h>

#include "constraint/cone_faces.h"
#include "constraint/exact_sum.h"

enum {
	FIRST_STEPS = 2, /* simultaneous steps before the first Newton step */
	STEPS_LIMIT = 64,
	ROUNDS_LIMIT = 400,
	RAISE_ROUNDS = 32 /* Newton steps at each value of friction */
};

/* Violation, relative to the speeds, above which a result is not accepted as a solution. */
static const double failed_share = 1e-9;
/* A round of a probe that leaves more than this share of the residual does not change it. */
static const double constant_share = 0.99;
/* Energy beyond which there is no way out, as a multiple of that at hand: 1e4 times the speeds. */
static const double way_out_max = 1e8;

/*
 * Continuation in the friction coefficient: the first value, for which the frictionless solution is
 * a good enough start; the largest factor from value to value; and the factor at which the
 * continuation is abandoned (there is no solution with more friction).
 */
static const double first_friction = 0.125, largest_factor = 2, smallest_factor = 1.0001;

/* Tangential part of a row's step, for the normal impulse after the step. */
static void find_friction_step(const struct rb_cone *cone, struct rb_cone_row *row,
                               double normal_impulse, rb_along_across *step)
{
	const rb_along_across *const j = &row->base.impulse;
	const double limit = cone->held ? row->limit : row->base.friction * normal_impulse;

	row->friction_impulse = RB_CONE_KNOWN;
	step->t = rb_vec3_neg(j->t);
	if (row->slide) {
		const double before = cone->held ? limit : row->base.friction * j->n;
		const double more = cone->held ? 0 : row->base.friction * step->n;

		/* avoids a difference of large forces */
		step->t = rb_vec3_neg(rb_vec3_add_scaled(
			rb_vec3_add_scaled(j->t, before, row->slip), more, row->slip));
		if (!cone->held && row->closed)
			row->friction_impulse = RB_CONE_FOLLOW;
		return;
	}
	if (!(row->base.friction > 0) || (!cone->held && !row->given && !row->closed))
		return;
	const rb_vec3 back = rb_vec3_scale(-1 / row->bound_t, row->u.t);
	const rb_vec3 trial = rb_vec3_add(j->t, back);
	const double length = rb_vec3_length(trial);
	row->friction_impulse = RB_CONE_STICK;
	step->t = back;
	if (length <= limit)
		return;
	row->friction_impulse = RB_CONE_SLIP;
	row->along = rb_vec3_scale(1 / length, trial);
	row->share = limit / length;
	step->t = rb_vec3_sub(rb_vec3_scale(limit, row->along), j->t);
}

/* The normal impulse nearest to n that the row's set allows. */
static double nearest(const struct rb_cone_row *row, double n)
{
	if (row->base.set == RB_CONSTRAINT_FREE)
		return n;
	if (row->base.set == RB_CONSTRAINT_INTERVAL)
		return fmin(fmax(n, row->base.low), row->base.high);
	return n > 0 ? n : 0;
}

/*
 * Determines the row's state and the step that would solve it alone: the negative of the function
 * whose zeros are the solutions (Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353).
 * Avoids computing increments as differences.
 */
static rb_along_across step_of(const struct rb_cone *cone, struct rb_cone_row *row)
{
	const rb_along_across *const j = &row->base.impulse;
	rb_along_across step = {0, {0, 0, 0}};
	double normal_impulse = j->n;

	row->closed = false;
	row->friction_impulse = RB_CONE_KNOWN;
	if (!(row->bound_n > 0)) /* no dynamic body */
		return step;
	if (row->base.set == RB_CONSTRAINT_FREE) {
		row->closed = true;
		row->friction_impulse = RB_CONE_STICK;
		return (rb_along_across){-row->u.n / row->bound_n,
		                         rb_vec3_scale(-1 / row->bound_t, row->u.t)};
	}
	if (row->base.set == RB_CONSTRAINT_INTERVAL && row->given)
		return step;
	if (row->base.set == RB_CONSTRAINT_INTERVAL) {
		const double trial = j->n - row->u.n / row->bound_n;

		row->closed = trial >= row->base.low && trial <= row->base.high;
		step.n = row->closed ? -row->u.n / row->bound_n : nearest(row, trial) - j->n;
		return step;
	}
	if (!row->given) {
		step.n = -row->u.n / row->bound_n;
		normal_impulse = j->n + step.n;
		row->closed = normal_impulse >= 0;
		if (!row->closed) {
			normal_impulse = 0;
			step.n = -j->n;
		}
	}
	find_friction_step(cone, row, normal_impulse, &step);
	return step;
}

/* Updates all rows' velocities, faces and steps; returns the largest violation in units of u. */
static double residual_of(struct rb_cone *cone, rb_along_across *step)
{
	double largest = 0;

	for (int k = 0; k < cone->row_count; k++) {
		struct rb_cone_row *row = &cone->row[k];

		row->u = rb_cone_velocity(cone, row);
		step[k] = step_of(cone, row);
		largest = fmax(largest, row->bound_n * fabs(step[k].n));
		largest = fmax(largest, row->bound_t * rb_vec3_length(step[k].t));
	}
	return largest;
}

/*
 * Computes `kept`: s x, changed such that impulse + kept is within the cone and, if it slips, on
 * it.
 */
static void keep_cone(struct rb_cone *cone, double s, const rb_along_across *x,
                      rb_along_across *kept)
{
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];
		const rb_along_across *const j = &row->base.impulse;
		double normal_impulse = j->n + s * x[k].n;

		kept[k] = (rb_along_across){s * x[k].n, rb_vec3_scale(s, x[k].t)};
		const bool leaves = row->base.set == RB_CONSTRAINT_CONE
		                            ? !(normal_impulse > 0)
		                            : nearest(row, normal_impulse) != normal_impulse;
		if (row->closed && leaves) {
			normal_impulse = nearest(row, normal_impulse);
			kept[k].n = normal_impulse - j->n;
		}
		if (row->base.set != RB_CONSTRAINT_CONE)
			continue;
		const double limit = cone->held ? row->limit : row->base.friction * normal_impulse;
		if (row->friction_impulse == RB_CONE_FOLLOW)
			kept[k].t = rb_vec3_scale(-row->base.friction * kept[k].n, row->slip);
		if (row->friction_impulse != RB_CONE_STICK && row->friction_impulse != RB_CONE_SLIP)
			continue;
		const rb_vec3 trial = rb_vec3_add(j->t, kept[k].t);
		const double length = rb_vec3_length(trial);
		if (length > limit ||
		    (s == 1 && row->friction_impulse == RB_CONE_SLIP && length > 0))
			kept[k].t = rb_vec3_sub(rb_vec3_scale(limit / length, trial), j->t);
	}
}

static void keep(struct rb_cone *cone)
{
	memcpy(cone->kept, cone->bodies.body, (size_t)cone->body_count * sizeof *cone->kept);
	for (int k = 0; k < cone->row_count; k++)
		cone->best[k] = cone->row[k].base.impulse;
}

static void restore(struct rb_cone *cone)
{
	memcpy(cone->bodies.body, cone->kept, (size_t)cone->body_count * sizeof *cone->kept);
	for (int k = 0; k < cone->row_count; k++)
		cone->row[k].base.impulse = cone->best[k];
}

/* Moves the impulses onto the faces, where the linear problem starts. */
static void move_onto_faces(struct rb_cone *cone, rb_along_across *step)
{
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		if (row->closed)
			step[k].n = 0;
		if (row->friction_impulse == RB_CONE_FOLLOW)
			step[k].t = rb_vec3_neg(rb_vec3_add_scaled(
				row->base.impulse.t, row->base.friction * row->base.impulse.n,
				row->slip));
		else if (row->friction_impulse != RB_CONE_KNOWN)
			step[k].t = (rb_vec3){0, 0, 0};
	}
	rb_cone_apply(cone, step);
}

/* Steps of all rows on the present faces. */
static void steps_on_faces(struct rb_cone *cone, rb_along_across *step)
{
	for (int k = 0; k < cone->row_count; k++) {
		struct rb_cone_row *row = &cone->row[k];

		row->u = rb_cone_velocity(cone, row);
		step[k] = (rb_along_across){-row->u.n / row->bound_n,
		                            rb_vec3_scale(-1 / row->bound_t, row->u.t)};
		if (row->friction_impulse != RB_CONE_SLIP)
			continue;
		const double normal_impulse = row->base.impulse.n + (row->closed ? step[k].n : 0);
		const double limit = cone->held ? row->limit : row->base.friction * normal_impulse;
		step[k].t = rb_vec3_sub(rb_vec3_scale(limit, row->along), row->base.impulse.t);
	}
}

/* Twice the change of energy since the call of `keep`, when velocities were `before`. */
static double energy_change(struct rb_cone *cone, const rb_along_across *before)
{
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];
		const rb_along_across *const j = &row->base.impulse, *const i = &cone->best[k];

		cone->term[k] = (j->n - i->n) * (row->u.n + before[k].n) +
		                rb_vec3_dot(rb_vec3_sub(j->t, i->t),
		                            rb_vec3_add(row->u.t, before[k].t));
	}
	return rb_exact_sum(cone->term, cone->row_count);
}

/*
 * Are the rows still on the faces for which the step was computed, and is the problem linear there?
 */
static bool remains_linear(const struct rb_cone *cone)
{
	for (int k = 0; k < cone->row_count; k++)
		if (cone->row[k].closed != cone->faces[k].closed ||
		    cone->row[k].friction_impulse != cone->faces[k].friction_impulse ||
		    cone->row[k].friction_impulse == RB_CONE_SLIP)
			return false;
	return true;
}

/*
 * One Newton step with line search from a point where residual_of has been evaluated; false, with
 * everything restored, if it does not decrease the energy (convex problems) or the residual
 * (others). `*ends`: further Newton steps would not change anything.
 */
static bool newton(struct rb_cone *cone, bool convex, bool *is_final)
{
	const double before = rb_cone_weighted(cone, cone->residual, cone->residual);
	bool improved = false;

	keep(cone);
	for (int k = 0; k < cone->row_count; k++)
		cone->before[k] = cone->row[k].u;
	move_onto_faces(cone, cone->residual);
	steps_on_faces(cone, cone->residual);
	const bool solved = rb_cone_faces_solve(cone, cone->change);
	memcpy(cone->faces, cone->row, (size_t)cone->row_count * sizeof *cone->row);
	memcpy(cone->snapped, cone->bodies.body,
	       (size_t)cone->body_count * sizeof *cone->bodies.body);
	double share = 1;
	for (int attempt = 0; attempt < (convex ? 10 : 5) && !improved; attempt++, share *= 0.3) {
		if (attempt > 0) {
			memcpy(cone->row, cone->faces, (size_t)cone->row_count * sizeof *cone->row);
			memcpy(cone->bodies.body, cone->snapped,
			       (size_t)cone->body_count * sizeof *cone->bodies.body);
		}
		keep_cone(cone, share, cone->change, cone->residual);
		rb_cone_apply(cone, cone->residual);
		residual_of(cone, cone->residual);
		const double after = rb_cone_weighted(cone, cone->residual, cone->residual);
		improved = after < 0.99 * before ||
		           (convex && energy_change(cone, cone->before) < 0);
		*is_final = solved && attempt == 0 && remains_linear(cone);
	}
	if (!improved)
		restore(cone);
	return improved;
}

/*
 * Simultaneous steps of all rows with Nesterov's momentum, restarted when it leads uphill
 * (O'Donoghue, Candes, Found. Comput. Math. 15 (2015) 715). Before and after, residual_of has just
 * been evaluated. Returns the residual.
 */
static double accelerated_steps(struct rb_cone *cone, int steps, double residual, double tolerance)
{
	const int n = cone->row_count;
	rb_along_across *const moved = cone->change;
	int since = 0;

	for (int round = 0; round < steps && residual > tolerance; round++) {
		if (rb_interrupt_is_set(cone->interrupt))
			break;
		if (since > 0) {
			const double momentum = since / (since + 3.0);

			for (int k = 0; k < n; k++)
				moved[k] = (rb_along_across){momentum * moved[k].n,
				                             rb_vec3_scale(momentum, moved[k].t)};
			rb_cone_apply(cone, moved);
			residual_of(cone, cone->residual);
			if (rb_cone_weighted(cone, moved, cone->residual) < 0)
				since = 0;
		}
		rb_cone_apply(cone, cone->residual);
		for (int k = 0; k < n; k++) {
			if (since == 0)
				moved[k] = cone->residual[k];
			else
				moved[k] = (rb_along_across){
					moved[k].n + cone->residual[k].n,
					rb_vec3_add(moved[k].t, cone->residual[k].t)};
		}
		since++;
		residual = residual_of(cone, cone->residual);
	}
	return residual;
}

/*
 * Rounding error of the velocities that the impulses cause, m/s: large for a light body between
 * heavy ones, where two large changes cancel.
 */
static double rounding_of(const struct rb_cone *cone)
{
	double largest = 0;

	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		largest = fmax(largest, row->bound_n * fabs(row->base.impulse.n));
		largest = fmax(largest, row->bound_t * rb_vec3_length(row->base.impulse.t));
	}
	return DBL_EPSILON * largest;
}

/*
 * Iterates until the problem is solved or stalls: by rounding, or by rows that contradict each
 * other (those of a mechanism with more than one loop, whose closure is rounded), along which
 * impulses could grow without bound. The points of two faces are more than the independent ones,
 * and their accelerations may contradict each other by more than rounding: then each Newton step
 * ends where it began. A small residual is accepted once it has not been halved in as many rounds
 * as there are rows, each of which could have opened one of them. A probe ends where its residual
 * does not change, whatever its size.
 */
static double relax(struct rb_cone *cone, bool convex, double tolerance, int rounds)
{
	/* tolerances are at least twice the rounding of the scale */
	const double accepted = failed_share / (2 * DBL_EPSILON) * tolerance;
	const bool probes = cone->probes && convex;
	double residual = residual_of(cone, cone->residual), smallest = residual;
	int steps = FIRST_STEPS, stalled = 0, idle = 0;

	for (int round = 0;
	     round < rounds && residual > tolerance && stalled < 4 && idle < 4 + cone->row_count;
	     round++) {
		if (rb_cone_is_over(cone))
			break;
		const double last = residual;
		residual = accelerated_steps(cone, steps, residual, tolerance);
		if (!(residual > tolerance))
			break;
		bool is_final = false;
		const bool improved = newton(cone, convex, &is_final);
		residual = residual_of(cone, cone->residual);
		if (improved)
			steps = steps > FIRST_STEPS ? steps / 2 : FIRST_STEPS;
		else
			steps = steps < STEPS_LIMIT ? 2 * steps : STEPS_LIMIT;
		if (residual < 0.5 * smallest) {
			stalled = idle = 0;
		} else {
			stalled += is_final || (probes && residual > constant_share * last) ||
			           residual < 256 * fmax(tolerance, rounding_of(cone));
			idle += residual < accepted || probes;
		}
		smallest = fmin(residual, smallest);
	}
	return residual;
}

/*
 * Sets the friction bounds from the present normal impulses; `only_shrink`: only decreases them.
 * True if one had to be decreased.
 */
static bool set_limits(struct rb_cone *cone, bool only_shrink)
{
	bool changed = false;

	for (int k = 0; k < cone->row_count; k++) {
		struct rb_cone_row *row = &cone->row[k];
		const double limit = row->base.friction * fmax(0, row->base.impulse.n);

		if (row->base.set != RB_CONSTRAINT_CONE)
			continue;
		if (!only_shrink) {
			row->limit = limit;
		} else if (rb_vec3_length(row->base.impulse.t) > limit * (1 + 4 * DBL_EPSILON)) {
			row->limit = fmin(0.9 * row->limit, limit);
			changed = true;
		}
	}
	return changed;
}

/*
 * Fallback where no solution of the law is found (a body jammed between others by friction,
 * Painleve): decreases the friction bounds until impulses are within the cones; slipping contacts
 * may then have less friction than the law says, at worst none.
 */
static double reduce_friction(struct rb_cone *cone, double tolerance, double scale)
{
	double residual = 0;

	set_limits(cone, false);
	cone->held = true;
	for (int round = 0; round < 300; round++) {
		residual = relax(cone, true, tolerance, 200);
		if (!set_limits(cone, true) || rb_cone_is_over(cone))
			break;
	}
	if (residual > failed_share * scale) {
		for (int k = 0; k < cone->row_count; k++)
			cone->row[k].limit = 0;
		residual = relax(cone, true, tolerance, ROUNDS_LIMIT);
	}
	cone->held = false;
	return residual;
}

/*
 * Sets the friction of all rows to that of their materials, at most `max`; false: none is limited
 * by it.
 */
static bool bound_friction(struct rb_cone *cone, const double *whole, double max)
{
	bool limited = false;

	for (int k = 0; k < cone->row_count; k++) {
		cone->row[k].base.friction = fmin(whole[k], max);
		limited = limited || whole[k] > max;
	}
	return limited;
}

/* Newton steps only: close to a solution, simultaneous steps may lead away from it. */
static double refine(struct rb_cone *cone, double tolerance)
{
	double residual = residual_of(cone, cone->residual);
	bool improved = true, is_final = false;

	for (int round = 0; round < RAISE_ROUNDS && improved && residual > tolerance; round++) {
		improved = !rb_cone_is_over(cone) && newton(cone, false, &is_final);
		residual = residual_of(cone, cone->residual);
	}
	return residual;
}

/* Saved impulses, and bodies with these applied. */
struct saved_state {
	rb_along_across *impulse;
	struct rb_solver_body *body;
};

static bool take_saved_state(struct rb_cone *cone, struct saved_state *saved)
{
	saved->impulse = rb_arena_take(cone->arena, (size_t)cone->row_count,
	                               sizeof *saved->impulse);
	saved->body = rb_arena_take(cone->arena, (size_t)cone->body_count, sizeof *saved->body);
	return saved->impulse && saved->body;
}

static void save_state(const struct rb_cone *cone, struct saved_state *saved)
{
	memcpy(saved->body, cone->bodies.body, (size_t)cone->body_count * sizeof *saved->body);
	for (int k = 0; k < cone->row_count; k++)
		saved->impulse[k] = cone->row[k].base.impulse;
}

static void restore_state(struct rb_cone *cone, const struct saved_state *saved)
{
	memcpy(cone->bodies.body, saved->body, (size_t)cone->body_count * sizeof *saved->body);
	for (int k = 0; k < cone->row_count; k++)
		cone->row[k].base.impulse = saved->impulse[k];
}

/*
 * Continuation from the frictionless solution, which always exists, to the whole friction: with a
 * large friction, a distant start says neither in which direction a contact slips nor how large its
 * normal impulse is. False, with everything restored: it does not reach a solution.
 */
static bool raise_friction(struct rb_cone *cone, double tolerance, double scale, double *residual)
{
	const rb_arena_mark here = rb_arena_here(cone->arena);
	const bool attempted = cone->joints.attempted;
	double *const whole = rb_arena_take(cone->arena, (size_t)cone->row_count, sizeof *whole);
	struct saved_state start, good;
	double max = 0, factor = largest_factor;
	bool limited = true, failed = false;

	if (!whole || !take_saved_state(cone, &start) || !take_saved_state(cone, &good)) {
		rb_arena_back(cone->arena, here);
		return false;
	}
	save_state(cone, &start);
	for (int k = 0; k < cone->row_count; k++)
		whole[k] = cone->row[k].base.friction;
	(void)bound_friction(cone, whole, 0);
	*residual = relax(cone, true, tolerance, ROUNDS_LIMIT);
	failed = *residual > failed_share * scale;
	while (limited && !failed && !rb_cone_is_over(cone)) {
		const double next = max > 0 ? max * factor : first_friction;

		save_state(cone, &good);
		limited = bound_friction(cone, whole, next);
		*residual = refine(cone, tolerance);
		if (*residual <= failed_share * scale) {
			max = next;
			factor = fmin(factor * factor, largest_factor);
		} else {
			restore_state(cone, &good);
			limited = true;
			factor = sqrt(factor);
			failed = !(factor > smallest_factor) || max == 0;
		}
	}
	(void)bound_friction(cone, whole, HUGE_VAL);
	if (limited)
		restore_state(cone, &start);
	/* otherwise the joints' factors have been allocated after it, and must be kept */
	if (attempted == cone->joints.attempted)
		rb_arena_back(cone->arena, here);
	return !limited;
}

double rb_cone_resolve(struct rb_cone *cone, double scale)
{
	const double tolerance = fmax(2 * DBL_EPSILON * scale, cone->tolerance);
	bool convex = true;

	for (int k = 0; k < cone->row_count; k++)
		convex = convex && (cone->row[k].given || !(cone->row[k].base.friction > 0));
	cone->held = false;
	double residual = relax(cone, convex, tolerance, convex ? ROUNDS_LIMIT : 16);
	for (int outer = 0; outer < 20 && !convex && residual > 1e3 * tolerance; outer++) {
		if (rb_cone_is_over(cone))
			return residual;
		set_limits(cone, false);
		cone->held = true;
		relax(cone, true, fmax(tolerance, 1e-3 * residual), 20);
		cone->held = false;
		residual = relax(cone, false, tolerance, 5);
	}
	if (convex || cone->probes || residual <= failed_share * scale)
		return residual;
	double raised;
	if (raise_friction(cone, tolerance, scale, &raised))
		return raised;
	if (rb_cone_is_over(cone))
		return residual;
	cone->friction_reduced = true;
	return reduce_friction(cone, tolerance, scale);
}

/*
 * Velocities v that end all approaches have u_n >= 0 in contacts and u = 0 in joints. For impulses
 * p with p_n >= 0 in contacts, p.u(v) >= 0 then, and p.u(v) = p.u + (H p).(v - v_now), where H p is
 * the change of momentum by p. Since |H p|^2 = p.(u - u_before) in the norm of kinetic energy, that
 * of v - v_now is at least (p.u)^2 / (2 p.(u - u_before)), which grows with p without a bound if
 * there are no such v.
 */
bool rb_cone_is_blocked(struct rb_cone *cone, const rb_along_across *before, double scale)
{
	const rb_arena_mark here = rb_arena_here(cone->arena);
	const size_t rows = (size_t)cone->row_count;
	rb_along_across *const impulse = rb_arena_take(cone->arena, 3 * rows + 1, sizeof *impulse);
	rb_along_across *const now = impulse + rows, *const change = now + rows;
	double at_hand = 0; /* kg m^2/s^2: twice the energy of what the rows act on, or more */
	bool proves = impulse != NULL;

	for (size_t k = 0; k < rows && proves; k++) {
		const struct rb_constraint *const row = &cone->row[k].base;
		const int body[2] = {row->a, row->b};

		/* rows with bounds, or soft ones, do not hold whatever the velocities */
		proves = row->set != RB_CONSTRAINT_INTERVAL ||
		         (row->softness == 0 && row->high == (double)INFINITY &&
		          (row->low == 0 || row->low == -(double)INFINITY));
		impulse[k] = row->impulse;
		now[k] = rb_cone_velocity(cone, &cone->row[k]);
		change[k] = (rb_along_across){now[k].n - before[k].n,
		                              rb_vec3_sub(now[k].t, before[k].t)};
		for (int side = 0; side < 2; side++) {
			const struct rb_solver_body *const b = &cone->bodies.body[body[side]];

			if (rb_solver_is_dynamic(b))
				at_hand += scale * scale / b->inverse_mass;
		}
	}
	if (proves) {
		const double closes = rb_cone_dot(cone, impulse, now);
		const double taken = rb_cone_dot(cone, impulse, change);

		proves = closes < 0 && closes * closes > way_out_max * at_hand * taken;
	}
	rb_arena_back(cone->arena, here);
	return proves;
}
