/* SPDX-License-Identifier: MIT */
#include "constraint/coulomb.h"

#include <float.h>
#include <string.h>

#include "constraint/cone_faces.h"
#include "constraint/exact_sum.h"

enum {
	FIRST_STEPS = 2, /* of all rows at once, before the first Newton step */
	STEPS_LIMIT = 64,
	ROUNDS_LIMIT = 400,
	RAISE_ROUNDS = 32 /* of Newton, at a friction */
};

/* Violation, as a share of the speeds, above which a solution is not taken for one. */
static const double failed_share = 1e-9;

/*
 * Friction that a solution without any is near enough to, and factors by which it is raised: the
 * largest, and the one at which it is given up (there is no solution with more).
 */
static const double first_friction = 0.125, friction_step = 2, least_step = 1.0001;

/* Across the normal, at a push that the step leads to. */
static void friction_impulse_of(const struct rb_cone *cone, struct rb_cone_row *row,
                                double normal_impulse, rb_along_across *step)
{
	const rb_along_across *const j = &row->base.impulse;
	const double limit = cone->held ? row->limit : row->base.friction * normal_impulse;

	row->friction_impulse = RB_CONE_KNOWN;
	step->t = rb_vec3_neg(j->t);
	if (row->slide) {
		const double before = cone->held ? limit : row->base.friction * j->n;
		const double more = cone->held ? 0 : row->base.friction * step->n;

		/* not as a difference of large forces */
		step->t = rb_vec3_neg(rb_vec3_add_scaled(
			rb_vec3_add_scaled(j->t, before, row->slip), more, row->slip));
		if (!cone->held && row->closed)
			row->friction_impulse = RB_CONE_FOLLOW;
		return;
	}
	if (!(row->base.friction > 0) || (!cone->held && !row->given && !row->closed))
		return;
	const rb_vec3 back = rb_vec3_scale(-1 / row->bound_t, row->u.t);
	const rb_vec3 wanted = rb_vec3_add(j->t, back);
	const double length = rb_vec3_length(wanted);
	row->friction_impulse = RB_CONE_STICK;
	step->t = back;
	if (length <= limit)
		return;
	row->friction_impulse = RB_CONE_SLIP;
	row->along = rb_vec3_scale(1 / length, wanted);
	row->share = limit / length;
	step->t = rb_vec3_sub(rb_vec3_scale(limit, row->along), j->t);
}

/* Of the normal impulses that the row's set allows. */
static double nearest(const struct rb_cone_row *row, double n)
{
	if (row->base.set == RB_CONSTRAINT_FREE)
		return n;
	if (row->base.set == RB_CONSTRAINT_INTERVAL)
		return fmin(fmax(n, row->base.low), row->base.high);
	return n > 0 ? n : 0;
}

/*
 * Where the row stands and the step that would solve it alone: the negative of the function whose
 * zeros are the solutions (Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353).
 * Increments are not taken as differences where they need not be.
 */
static rb_along_across step_of(const struct rb_cone *cone, struct rb_cone_row *row)
{
	const rb_along_across *const j = &row->base.impulse;
	rb_along_across step = {0, {0, 0, 0}};
	double normal_impulse = j->n;

	row->closed = false;
	row->friction_impulse = RB_CONE_KNOWN;
	if (!(row->bound_n > 0)) /* between bodies that do not yield */
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
		const double wanted = j->n - row->u.n / row->bound_n;

		row->closed = wanted >= row->base.low && wanted <= row->base.high;
		step.n = row->closed ? -row->u.n / row->bound_n : nearest(row, wanted) - j->n;
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
	friction_impulse_of(cone, row, normal_impulse, &step);
	return step;
}

/* All rows' velocities, faces and steps; the largest violation in units of u. */
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
 * The share `s` of x, changed such that impulse + x is within the cone and, where it slips, on it.
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
		const rb_vec3 wanted = rb_vec3_add(j->t, kept[k].t);
		const double length = rb_vec3_length(wanted);
		if (length > limit ||
		    (s == 1 && row->friction_impulse == RB_CONE_SLIP && length > 0))
			kept[k].t = rb_vec3_sub(rb_vec3_scale(limit / length, wanted), j->t);
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

/* Off what the faces exclude, so that the linear problem starts on them. */
static void snap(struct rb_cone *cone, rb_along_across *step)
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
	rb_cone_apply_normal(cone, step);
}

/* Steps on the faces as they are. */
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

/*
 * Twice the change of energy since `before` (velocities) and cone->kept, which must be what `keep`
 * has kept.
 */
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

/* Are rows on the faces on which a step was found, and is the problem linear there? */
static bool is_linear_there(const struct rb_cone *cone)
{
	for (int k = 0; k < cone->row_count; k++)
		if (cone->row[k].closed != cone->faces[k].closed ||
		    cone->row[k].friction_impulse != cone->faces[k].friction_impulse ||
		    cone->row[k].friction_impulse == RB_CONE_SLIP)
			return false;
	return true;
}

/*
 * One Newton step from where `look` has just been, along it as far as it helps; false, and all as
 * it was, where it does not. What it must lower: the energy where the problem is convex, else the
 * residual. `ends`: where it has led, another one leads no further.
 */
static bool newton(struct rb_cone *cone, bool convex, bool *ends)
{
	const double before = rb_cone_weighted(cone, cone->residual, cone->residual);
	bool better = false;

	keep(cone);
	for (int k = 0; k < cone->row_count; k++)
		cone->before[k] = cone->row[k].u;
	snap(cone, cone->residual);
	steps_on_faces(cone, cone->residual);
	const bool solved = rb_cone_faces_solve(cone, cone->change);
	memcpy(cone->faces, cone->row, (size_t)cone->row_count * sizeof *cone->row);
	memcpy(cone->snapped, cone->bodies.body,
	       (size_t)cone->body_count * sizeof *cone->bodies.body);
	double share = 1;
	for (int attempt = 0; attempt < (convex ? 10 : 5) && !better; attempt++, share *= 0.3) {
		if (attempt > 0) {
			memcpy(cone->row, cone->faces, (size_t)cone->row_count * sizeof *cone->row);
			memcpy(cone->bodies.body, cone->snapped,
			       (size_t)cone->body_count * sizeof *cone->bodies.body);
		}
		keep_cone(cone, share, cone->change, cone->residual);
		rb_cone_apply_normal(cone, cone->residual);
		residual_of(cone, cone->residual);
		const double after = rb_cone_weighted(cone, cone->residual, cone->residual);
		better = after < 0.99 * before || (convex && energy_change(cone, cone->before) < 0);
		*ends = solved && attempt == 0 && is_linear_there(cone);
	}
	if (!better)
		restore(cone);
	return better;
}

/*
 * Steps of all rows at once, with the momentum of Nesterov's method, which begins anew where it
 * leads uphill (O'Donoghue, Candes, Found. Comput. Math. 15 (2015) 715). Begins and ends where
 * `look` has just been.
 */
static double walk(struct rb_cone *cone, int steps, double left, double tolerance)
{
	const int n = cone->row_count;
	rb_along_across *const moved = cone->change;
	int since = 0;

	for (int round = 0; round < steps && left > tolerance; round++) {
		if (rb_interrupt_is_set(cone->interrupt))
			break;
		if (since > 0) {
			const double momentum = since / (since + 3.0);

			for (int k = 0; k < n; k++)
				moved[k] = (rb_along_across){momentum * moved[k].n,
				                             rb_vec3_scale(momentum, moved[k].t)};
			rb_cone_apply_normal(cone, moved);
			residual_of(cone, cone->residual);
			if (rb_cone_weighted(cone, moved, cone->residual) < 0)
				since = 0;
		}
		rb_cone_apply_normal(cone, cone->residual);
		for (int k = 0; k < n; k++) {
			if (since == 0)
				moved[k] = cone->residual[k];
			else
				moved[k] = (rb_along_across){
					moved[k].n + cone->residual[k].n,
					rb_vec3_add(moved[k].t, cone->residual[k].t)};
		}
		since++;
		left = residual_of(cone, cone->residual);
	}
	return left;
}

/*
 * m/s: by how much what the impulses do is rounded: of a light body between heavy ones, two large
 * changes that cancel.
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
 * Until the problem as it stands is solved or nothing helps any more: what rounding leaves, or rows
 * that contradict each other (those of a mechanism that is closed more than once, whose closure is
 * rounded), along which impulses could grow for ever. Points of two faces are more than independent
 * ones, and their accelerations may contradict each other by more than rounding: then each Newton
 * step ends where it began. What is left is taken for a solution once as many steps as there are
 * rows have not halved it, each of which could have opened one of them.
 */
static double relax(struct rb_cone *cone, bool convex, double tolerance, int rounds)
{
	/* tolerances are at least two roundings of the scale */
	const double small = failed_share / (2 * DBL_EPSILON) * tolerance;
	double left = residual_of(cone, cone->residual), least = left;
	int steps = FIRST_STEPS, stalled = 0, idle = 0;

	for (int round = 0;
	     round < rounds && left > tolerance && stalled < 4 && idle < 4 + cone->row_count;
	     round++) {
		if (rb_cone_is_over(cone))
			break;
		left = walk(cone, steps, left, tolerance);
		if (!(left > tolerance))
			break;
		bool ends = false;
		const bool better = newton(cone, convex, &ends);
		left = residual_of(cone, cone->residual);
		if (better)
			steps = steps > FIRST_STEPS ? steps / 2 : FIRST_STEPS;
		else
			steps = steps < STEPS_LIMIT ? 2 * steps : STEPS_LIMIT;
		if (left < 0.5 * least) {
			stalled = idle = 0;
		} else {
			stalled += ends || left < 256 * fmax(tolerance, rounding_of(cone));
			idle += left < small;
		}
		least = fmin(left, least);
	}
	return left;
}

/*
 * Bounds of friction from the pushes as they are; `never_more` lets them only shrink. True if one
 * had to change.
 */
static bool hold(struct rb_cone *cone, bool never_more)
{
	bool changed = false;

	for (int k = 0; k < cone->row_count; k++) {
		struct rb_cone_row *row = &cone->row[k];
		const double limit = row->base.friction * fmax(0, row->base.impulse.n);

		if (row->base.set != RB_CONSTRAINT_CONE)
			continue;
		if (!never_more) {
			row->limit = limit;
		} else if (rb_vec3_length(row->base.impulse.t) > limit * (1 + 4 * DBL_EPSILON)) {
			row->limit = fmin(0.9 * row->limit, limit);
			changed = true;
		}
	}
	return changed;
}

/*
 * Where the law finds no solution (a body that friction jams between others, Painleve): the bounds
 * of friction shrink until it is within the cones; what slips may then have less of it than the law
 * says, at worst none.
 */
static double give_way(struct rb_cone *cone, double tolerance, double scale)
{
	double left = 0;

	hold(cone, false);
	cone->held = true;
	for (int round = 0; round < 300; round++) {
		left = relax(cone, true, tolerance, 200);
		if (!hold(cone, true) || rb_cone_is_over(cone))
			break;
	}
	if (left > failed_share * scale) {
		for (int k = 0; k < cone->row_count; k++)
			cone->row[k].limit = 0;
		left = relax(cone, true, tolerance, ROUNDS_LIMIT);
	}
	cone->held = false;
	return left;
}

/* Friction of all rows, no more than `max` of a material's; false: that is all that they have. */
static bool bound_friction(struct rb_cone *cone, const double *whole, double max)
{
	bool less = false;

	for (int k = 0; k < cone->row_count; k++) {
		cone->row[k].base.friction = fmin(whole[k], max);
		less = less || whole[k] > max;
	}
	return less;
}

/* Newton steps alone: from near enough to a solution, others lead away from some. */
static double refine(struct rb_cone *cone, double tolerance)
{
	double left = residual_of(cone, cone->residual);
	bool better = true, ends = false;

	for (int round = 0; round < RAISE_ROUNDS && better && left > tolerance; round++) {
		better = !rb_cone_is_over(cone) && newton(cone, false, &ends);
		left = residual_of(cone, cone->residual);
	}
	return left;
}

/* Impulses, and the bodies that have had them. */
struct mark {
	rb_along_across *impulse;
	struct rb_solver_body *body;
};

static bool take_mark(struct rb_cone *cone, struct mark *mark)
{
	mark->impulse = rb_arena_take(cone->arena, (size_t)cone->row_count, sizeof *mark->impulse);
	mark->body = rb_arena_take(cone->arena, (size_t)cone->body_count, sizeof *mark->body);
	return mark->impulse && mark->body;
}

static void set_mark(const struct rb_cone *cone, struct mark *mark)
{
	memcpy(mark->body, cone->bodies.body, (size_t)cone->body_count * sizeof *mark->body);
	for (int k = 0; k < cone->row_count; k++)
		mark->impulse[k] = cone->row[k].base.impulse;
}

static void back_to_mark(struct rb_cone *cone, const struct mark *mark)
{
	memcpy(cone->bodies.body, mark->body, (size_t)cone->body_count * sizeof *mark->body);
	for (int k = 0; k < cone->row_count; k++)
		cone->row[k].base.impulse = mark->impulse[k];
}

/*
 * The whole friction by steps, each from the solution with less of it, from none on, which always
 * has one: a large friction alone says from afar neither which way a contact slips nor how hard it
 * presses. False, and all as it was: it leads to no solution.
 */
static bool raise_friction(struct rb_cone *cone, double tolerance, double scale, double *left)
{
	const rb_arena_mark here = rb_arena_here(cone->arena);
	const bool tried = cone->joints.tried;
	double *const whole = rb_arena_take(cone->arena, (size_t)cone->row_count, sizeof *whole);
	struct mark start, good;
	double max = 0, step = friction_step;
	bool less = true, fails = false;

	if (!whole || !take_mark(cone, &start) || !take_mark(cone, &good)) {
		rb_arena_back(cone->arena, here);
		return false;
	}
	set_mark(cone, &start);
	for (int k = 0; k < cone->row_count; k++)
		whole[k] = cone->row[k].base.friction;
	(void)bound_friction(cone, whole, 0);
	*left = relax(cone, true, tolerance, ROUNDS_LIMIT);
	fails = *left > failed_share * scale;
	while (less && !fails && !rb_cone_is_over(cone)) {
		const double next = max > 0 ? max * step : first_friction;

		set_mark(cone, &good);
		less = bound_friction(cone, whole, next);
		*left = refine(cone, tolerance);
		if (*left <= failed_share * scale) {
			max = next;
			step = fmin(step * step, friction_step);
		} else {
			back_to_mark(cone, &good);
			less = true;
			step = sqrt(step);
			fails = !(step > least_step) || max == 0;
		}
	}
	(void)bound_friction(cone, whole, HUGE_VAL);
	if (less)
		back_to_mark(cone, &start);
	if (tried == cone->joints.tried) /* else their factors stand behind it, and are kept */
		rb_arena_back(cone->arena, here);
	return !less;
}

double rb_cone_resolve(struct rb_cone *cone, double scale)
{
	const double tolerance = fmax(2 * DBL_EPSILON * scale, cone->tolerance);
	bool convex = true;

	for (int k = 0; k < cone->row_count; k++)
		convex = convex && (cone->row[k].given || !(cone->row[k].base.friction > 0));
	cone->held = false;
	double left = relax(cone, convex, tolerance, convex ? ROUNDS_LIMIT : 16);
	for (int outer = 0; outer < 20 && !convex && left > 1e3 * tolerance; outer++) {
		if (rb_cone_is_over(cone))
			return left;
		hold(cone, false);
		cone->held = true;
		relax(cone, true, fmax(tolerance, 1e-3 * left), 20);
		cone->held = false;
		left = relax(cone, false, tolerance, 5);
	}
	if (convex || cone->probes || left <= failed_share * scale)
		return left;
	double raised;
	if (raise_friction(cone, tolerance, scale, &raised))
		return raised;
	if (rb_cone_is_over(cone))
		return left;
	cone->gave_way = true;
	return give_way(cone, tolerance, scale);
}
