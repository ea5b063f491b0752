/* SPDX-License-Identifier: MIT */
#include "constraint/simultaneous.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/forest.h"
#include "constraint/contact_row.h"
#include "constraint/coulomb.h"
#include "constraint/effective_mass.h"
#include "constraint/impulse.h"
#include "constraint/jointed_impact.h"

enum {
	ROUNDS = 512, /* plus 16 per contact; then the rest is done without restitution */
	ROUNDS_PER_CONTACT = 16,
	/* rounds in turn that fail and leave as fast an approach: no impulses end it */
	ROUNDS_BLOCKED = 16
};

/* Share of the first approaches below which restitution ends: the tail of an infinite series. */
static const double tail_share = 1e-13;
/* Violation, relative to the speeds, above which a result is not accepted as a solution. */
static const double failed_share = 1e-9;
/* Difference of normals, and of points as a share of the size, that rounding may cause. */
static const double same_share = 1e-9;

static rb_vec3 relative_velocity(const struct rb_simultaneous *problem,
                                 const struct rb_solver_contact *c)
{
	return rb_vec3_sub(rb_solver_point_velocity(&problem->body[c->b], c->arm_b),
	                   rb_solver_point_velocity(&problem->body[c->a], c->arm_a));
}

/* --- a single contact --- */

/*
 * Adds the body's part of K; false if it is eccentric: normal and tangent are coupled, or tangents
 * differ.
 */
static bool add_inverse_mass(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                             struct rb_link *link)
{
	const struct rb_solver_body *const body = &bodies->body[i];
	const rb_vec3 lever = rb_vec3_cross(arm, link->normal);

	rb_effective_mass_add(bodies, i, arm, rb_effective_mass_world,
	                      &link->inverse_effective_mass);
	link->normal_inverse_mass += rb_effective_mass_along(bodies, i, lever);
	if (body->inverse_inertia == 0) {
		link->tangent_inverse_mass += body->inverse_mass;
		return true;
	}
	link->tangent_inverse_mass += body->inverse_mass +
	                              body->inverse_inertia * rb_vec3_dot(arm, arm);
	return !isnan(body->inverse_inertia) &&
	       rb_vec3_length(lever) <= 16 * DBL_EPSILON * rb_vec3_length(arm);
}

static struct rb_link link_of(const struct rb_simultaneous *problem,
                              const struct rb_solver_contact *c)
{
	const struct rb_solver_bodies bodies = rb_simultaneous_bodies(problem);
	const struct rb_solver_body *const a = &problem->body[c->a], *const b =
									     &problem->body[c->b];
	struct rb_link link = {.a = c->a,
	                       .b = c->b,
	                       .normal = c->normal,
	                       .arm_a = c->arm_a,
	                       .arm_b = c->arm_b,
	                       .friction = c->friction,
	                       .restitution = c->restitution,
	                       .inverse_mass_a = a->inverse_mass,
	                       .inverse_mass_b = b->inverse_mass,
	                       .inverse_inertia_a = a->inverse_inertia,
	                       .inverse_inertia_b = b->inverse_inertia};
	/* separate sums, then added: the result must not depend on which body is called a */
	struct rb_link other = link;
	const bool central_a = add_inverse_mass(&bodies, c->a, c->arm_a, &link);
	const bool central_b = add_inverse_mass(&bodies, c->b, c->arm_b, &other);

	link.central = central_a && central_b;
	link.normal_inverse_mass += other.normal_inverse_mass;
	link.tangent_inverse_mass += other.tangent_inverse_mass;
	for (int i = 0; i < 9; i++)
		link.inverse_effective_mass.m[i / 3][i % 3] +=
			other.inverse_effective_mass.m[i / 3][i % 3];
	if (!link.central)
		link.tangent_inverse_mass = rb_effective_mass_tangent(&link.inverse_effective_mass,
		                                                      link.normal);
	return link;
}

static void resolve_alone(struct rb_simultaneous *problem, struct rb_solver_contact *c)
{
	const struct rb_solver_bodies bodies = rb_simultaneous_bodies(problem);
	const struct rb_link link = link_of(problem, c);
	const rb_vec3 u = relative_velocity(problem, c);
	const double approach = -rb_vec3_dot(u, c->normal);

	if (!(link.normal_inverse_mass > 0))
		return;
	const rb_vec3 impulse = rb_link_impact(&link, u, c->restitution * approach);
	rb_solver_apply(&bodies, c->a, c->arm_a, rb_vec3_neg(impulse));
	rb_solver_apply(&bodies, c->b, c->arm_b, impulse);
	c->impulse = rb_vec3_add(c->impulse, impulse);
	if (c->approach == 0)
		c->approach = approach;
}

/* --- several contacts --- */

struct rounds {
	struct rb_simultaneous *problem;
	bool *active; /* [contact_count]: active in this round */
	int *same;    /* [contact_count]: an earlier contact that this one is, or -1 */
	/* [body_count]: by leader: active contacts, and 2 for each limit or row with bounds */
	int *degree;
	/*
	 * [contact_count + joint_count]: contact or joint row of each cone row; contacts first,
	 * contact_rows of them
	 */
	int *source;
	int contact_rows;
	bool *stops;    /* [joint_count]: a limit or rope that is active */
	int *leader;    /* [body_count]: lowest index of the bodies that joints connect with it */
	bool *joined;   /* [body_count]: by leader: joints act on its bodies */
	bool *involved; /* [body_count]: by leader: its bodies are involved in this round */
	double first;   /* m/s: largest approach in the first round */
	double largest; /* m/s: largest approach in this round */
	bool failed;    /* not even impulses without friction have ended this round's approaches */
	bool blocked;   /* and these prove that none can */
	double scale;   /* m/s: largest speed of the bodies involved */
	struct rb_cone cone;
};

/* Is it a limit or a rope, which only pushes? */
static bool is_stop(const struct rb_cone_row *row)
{
	return rb_constraint_side(&row->base) > 0;
}

/* The largest of the speeds whose difference is the velocity of a limit or rope, m/s. */
static double stop_scale(const struct rb_simultaneous *problem, const struct rb_cone_row *row)
{
	const struct rb_solver_body *a = &problem->body[row->base.a],
				    *b = &problem->body[row->base.b];
	const double bias = rb_vec3_length(row->bias);

	if (row->base.couple)
		return fmax(bias, row->base.arm_a.x * fmax(rb_vec3_length(a->angular),
		                                           rb_vec3_length(b->angular)));
	return fmax(bias, fmax(rb_solver_speed_bound(a, row->base.arm_a),
	                       rb_solver_speed_bound(b, row->base.arm_b)));
}

/* Does a joint's row act on bodies that are involved in this round? */
static bool is_involved(const struct rounds *all, const struct rb_cone_row *row)
{
	return all->involved[all->leader[row->base.a]] || all->involved[all->leader[row->base.b]];
}

/*
 * Largest speed among the rows of this round: the speed of bodies that a shock has sent off would
 * hide the residual of the others.
 */
static double largest_speed(const struct rounds *all)
{
	const struct rb_simultaneous *const problem = all->problem;
	double largest = 0;

	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];

		if (all->active[k] || all->involved[all->leader[c->a]])
			largest = fmax(largest,
			               rb_solver_speed_bound(&problem->body[c->a], c->arm_a));
		if (all->active[k] || all->involved[all->leader[c->b]])
			largest = fmax(largest,
			               rb_solver_speed_bound(&problem->body[c->b], c->arm_b));
	}
	for (int k = 0; k < problem->joint_count; k++)
		if (is_stop(&problem->joint_row[k]) && is_involved(all, &problem->joint_row[k]))
			largest = fmax(largest, stop_scale(problem, &problem->joint_row[k]));
	return largest;
}

/* Resets the impulses of all rows to zero, and the bodies to `before`. */
static void reset(struct rounds *all, const struct rb_solver_body *before)
{
	memcpy(all->cone.bodies.body, before, (size_t)all->cone.body_count * sizeof *before);
	for (int k = 0; k < all->cone.row_count; k++)
		all->cone.row[k].base.impulse = (rb_along_across){0, {0, 0, 0}};
}

/*
 * Ends all approach, with friction; without it if that does not converge (a body jammed between
 * others). `velocity`: of the rows before it.
 */
static void compress(struct rounds *all, const struct rb_solver_body *before,
                     const rb_along_across *velocity)
{
	struct rb_cone *const cone = &all->cone;

	if (rb_cone_resolve(cone, all->scale) <= failed_share * all->scale)
		return;
	reset(all, before);
	for (int k = 0; k < cone->row_count; k++)
		cone->row[k].base.friction = 0;
	all->failed = !(rb_cone_resolve(cone, all->scale) <= failed_share * all->scale);
	all->blocked = all->failed && rb_cone_is_blocked(cone, velocity, all->scale);
}

/* Restitution of a row; 0 for joints that may pull. */
static double restitution_of(const struct rounds *all, int k)
{
	return k < all->contact_rows ? all->problem->contact[all->source[k]].restitution
	                             : all->cone.row[k].restitution;
}

/* Is the row a contact, a limit or a rope, which may rebound? */
static bool rebounds(const struct rounds *all, int k)
{
	return k < all->contact_rows || is_stop(&all->cone.row[k]);
}

/*
 * Adds restitution times the impulses of compression along the normals, then solves friction within
 * the cones of the sums. `spare` is twice the energy that compression took: the additional impulses
 * are scaled down if they would return more.
 */
static void apply_restitution(struct rounds *all, double spare, rb_along_across *extra,
                              rb_along_across *change)
{
	struct rb_cone *const cone = &all->cone;
	const int contacts = all->contact_rows;
	bool any_friction = contacts < cone->row_count;
	double restitution_max = 0;

	for (int k = 0; k < cone->row_count; k++)
		if (rebounds(all, k) && cone->row[k].base.impulse.n > 0)
			restitution_max = fmax(restitution_max, restitution_of(all, k));
	for (int k = 0; k < cone->row_count; k++) {
		const rb_along_across p = cone->row[k].base.impulse;

		if (rebounds(all, k))
			extra[k] = (rb_along_across){restitution_of(all, k) * p.n, {0, 0, 0}};
		else
			extra[k] = (rb_along_across){restitution_max * p.n,
			                             rb_vec3_scale(restitution_max, p.t)};
		change[k] = rb_cone_velocity(cone, &cone->row[k]);
	}
	struct rb_solver_body *const kept = cone->kept;
	memcpy(kept, cone->bodies.body, (size_t)cone->body_count * sizeof *kept);
	rb_cone_apply(cone, extra);
	for (int k = 0; k < cone->row_count; k++) {
		const rb_along_across u = rb_cone_velocity(cone, &cone->row[k]);

		change[k] = (rb_along_across){u.n - change[k].n,
		                              k < contacts ? (rb_vec3){0, 0, 0}
		                                           : rb_vec3_sub(u.t, change[k].t)};
	}
	const double needed = rb_cone_dot(cone, extra, change);
	if (needed > spare * (1 + 64 * DBL_EPSILON)) {
		const double share = spare > 0 ? sqrt(spare / needed) : 0;

		memcpy(cone->bodies.body, kept, (size_t)cone->body_count * sizeof *kept);
		for (int k = 0; k < cone->row_count; k++) {
			struct rb_constraint *const row = &cone->row[k].base;

			row->impulse.n -= extra[k].n;
			row->impulse.t = rb_vec3_sub(row->impulse.t, extra[k].t);
			extra[k].n *= share;
			extra[k].t = rb_vec3_scale(share, extra[k].t);
		}
		rb_cone_apply(cone, extra);
	}
	for (int k = 0; k < cone->row_count; k++) {
		cone->row[k].given = rebounds(all, k);
		any_friction = any_friction || (k < contacts && cone->row[k].base.friction > 0);
	}
	if (any_friction)
		rb_cone_resolve(cone, all->scale);
}

/* Resolves the rows of one round together. False: out of memory. */
static bool resolve_together(struct rounds *all, bool with_restitution)
{
	struct rb_simultaneous *const problem = all->problem;
	struct rb_cone *const cone = &all->cone;
	const size_t rows = (size_t)cone->row_count, contacts = (size_t)all->contact_rows;
	const rb_arena_mark here = rb_arena_here(problem->arena);
	rb_along_across *const before = rb_arena_take(problem->arena, rows, sizeof *before);
	rb_along_across *const impulse = rb_arena_take(problem->arena, rows, sizeof *impulse);
	rb_along_across *const sum = rb_arena_take(problem->arena, rows, sizeof *sum);
	struct rb_solver_body *const kept = rb_arena_take(
		problem->arena, (size_t)problem->body_count, sizeof *kept);
	bool restitution = false;

	if (!before || !impulse || !sum || !kept || !rb_cone_open(cone)) {
		rb_arena_back(problem->arena, here);
		return false;
	}
	memcpy(kept, problem->body, (size_t)problem->body_count * sizeof *kept);
	for (size_t k = 0; k < rows; k++)
		before[k] = rb_cone_velocity(cone, &cone->row[k]);
	compress(all, kept, before);
	for (size_t k = 0; k < rows; k++) {
		const rb_along_across u = rb_cone_velocity(cone, &cone->row[k]);

		impulse[k] = cone->row[k].base.impulse;
		sum[k] = (rb_along_across){u.n + before[k].n, rb_vec3_add(u.t, before[k].t)};
		restitution = restitution || (rebounds(all, (int)k) && impulse[k].n > 0 &&
		                              restitution_of(all, (int)k) > 0);
	}
	/* change of kinetic energy: sum of J.(u + u')/2 */
	const double spare = -rb_cone_dot(cone, impulse, sum);
	if (restitution && with_restitution)
		apply_restitution(all, spare, impulse, sum);
	for (size_t k = contacts; k < rows; k++) {
		struct rb_cone_row *const row = &problem->joint_row[all->source[k]];
		const rb_along_across p = cone->row[k].base.impulse;

		row->base.impulse.n += p.n;
		row->base.impulse.t = rb_vec3_add(row->base.impulse.t, p.t);
		if (is_stop(row) && p.n > 0 && row->approach == 0 && before[k].n < -row->noise)
			row->approach = -before[k].n;
	}
	for (size_t k = 0; k < contacts; k++) {
		struct rb_solver_contact *const c = &problem->contact[all->source[k]];
		const struct rb_cone_row *const row = &cone->row[k];

		c->impulse = rb_vec3_add(c->impulse, rb_constraint_impulse(&row->base));
		if (row->base.impulse.n > 0 && c->approach == 0 && before[k].n < -c->noise)
			c->approach = -before[k].n;
	}
	rb_arena_back(problem->arena, here);
	return true;
}

/*
 * Speed below which a contact does not approach: the larger of the caller's noise and tolerance and
 * the resolution of this arithmetic.
 */
static double noise_of(const struct rb_simultaneous *problem, const struct rb_solver_contact *c)
{
	return fmax(fmax(c->noise, problem->tolerance),
	            4 * DBL_EPSILON * rb_simultaneous_scale(problem, c));
}

/* Finds the active limits and ropes; adds to the count those that approach. */
static void find_active_stops(struct rounds *all, double *largest, double *restitution_max,
                              int *count)
{
	const struct rb_simultaneous *const problem = all->problem;

	for (int k = 0; k < problem->joint_count; k++) {
		const struct rb_cone_row *row = &problem->joint_row[k];

		all->stops[k] = false;
		if (!is_stop(row))
			continue;
		const double approach = -rb_cone_velocity(&all->cone, row).n;
		const double noise = fmax(fmax(row->noise, problem->tolerance),
		                          4 * DBL_EPSILON * stop_scale(problem, row));
		all->stops[k] = row->restitution == 0 || approach > noise;
		if (!(approach > noise))
			continue;
		++*count;
		*largest = fmax(*largest, approach);
		*restitution_max = fmax(*restitution_max, row->restitution);
	}
}

/* Is it one with a contact that is active? */
static bool acts_as_other(const struct rounds *all, int k)
{
	return all->same[k] >= 0 && all->active[all->same[k]];
}

/*
 * Finds the active contacts of a round: all that approach, and the touching ones without
 * restitution.
 */
static int find_active(struct rounds *all, bool *only_tail)
{
	struct rb_simultaneous *const problem = all->problem;
	double largest = 0, restitution_max = 0;
	int count = 0;

	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];
		const double approach = -rb_vec3_dot(relative_velocity(problem, c), c->normal);

		all->active[k] = approach > noise_of(problem, c) &&
		                 (rb_solver_is_dynamic(&problem->body[c->a]) ||
		                  rb_solver_is_dynamic(&problem->body[c->b])) &&
		                 !acts_as_other(all, k);
		if (!all->active[k])
			continue;
		count++;
		largest = fmax(largest, approach);
		restitution_max = fmax(restitution_max, c->restitution);
	}
	find_active_stops(all, &largest, &restitution_max, &count);
	all->largest = largest;
	if (all->first == 0)
		all->first = largest;
	*only_tail = restitution_max < 1 && largest <= tail_share * all->first;
	if (count == 0)
		return 0;
	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];

		if (!all->active[k] && c->restitution == 0 && !acts_as_other(all, k) &&
		    (rb_solver_is_dynamic(&problem->body[c->a]) ||
		     rb_solver_is_dynamic(&problem->body[c->b]))) {
			all->active[k] = true;
			count++;
		}
	}
	return count;
}

/* Marks the leaders of bodies on which contacts, limits and ropes of this round act. */
static void find_involved(struct rounds *all)
{
	const struct rb_simultaneous *const problem = all->problem;

	memset(all->involved, 0, (size_t)problem->body_count * sizeof *all->involved);
	for (int k = 0; k < problem->contact_count; k++) {
		if (!all->active[k])
			continue;
		all->involved[all->leader[problem->contact[k].a]] = true;
		all->involved[all->leader[problem->contact[k].b]] = true;
	}
	for (int k = 0; k < problem->joint_count; k++) {
		const struct rb_constraint *const base = &problem->joint_row[k].base;

		if (!is_stop(&problem->joint_row[k]) || !all->stops[k])
			continue;
		all->involved[all->leader[base->a]] = true;
		all->involved[all->leader[base->b]] = true;
	}
}

/* Counts active contacts and what else acts on the bodies of each leader. */
static void count_degrees(struct rounds *all)
{
	const struct rb_simultaneous *const problem = all->problem;

	memset(all->degree, 0, (size_t)problem->body_count * sizeof *all->degree);
	memset(all->joined, 0, (size_t)problem->body_count * sizeof *all->joined);
	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];
		const int a = all->leader[c->a], b = all->leader[c->b];

		if (!all->active[k])
			continue;
		all->degree[a] += rb_solver_is_dynamic(&problem->body[c->a]);
		all->degree[b] += rb_solver_is_dynamic(&problem->body[c->b]) && a != b;
	}
	for (int k = 0; k < problem->joint_count; k++) {
		const struct rb_cone_row *const row = &problem->joint_row[k];
		const int body[2] = {row->base.a, row->base.b};
		const bool stop = is_stop(row);

		if (stop && !all->stops[k])
			continue;
		for (int side = 0; side < 2; side++) {
			const int leader = all->leader[body[side]];

			all->joined[leader] = true;
			if (!rb_jointed_impact_is_bilateral(row))
				all->degree[leader] += 2;
		}
	}
}

/* Whether a row acts on a body of one of these linkages. */
static bool acts_on(const struct rounds *all, const struct rb_cone_row *row, int a, int b)
{
	const struct rb_solver_body *const body = all->problem->body;
	const int of[2] = {row->base.a, row->base.b};

	for (int side = 0; side < 2; side++) {
		const int leader = all->leader[of[side]];

		if (rb_solver_is_dynamic(&body[of[side]]) && (leader == a || leader == b))
			return true;
	}
	return false;
}

/*
 * Resolves the only contact of the linkages at its two sides. False: that is no case of
 * constraint/jointed_impact, or memory is out; nothing has changed.
 */
static bool resolve_on_linkage(struct rounds *all, struct rb_solver_contact *c)
{
	struct rb_simultaneous *const problem = all->problem;
	const int a = all->leader[c->a], b = all->leader[c->b];
	const rb_arena_mark here = rb_arena_here(problem->arena);
	struct rb_cone cone = {.bodies = rb_simultaneous_bodies(problem),
	                       .body_count = problem->body_count,
	                       .arena = problem->arena,
	                       .max = problem->products_max,
	                       .interrupt = problem->interrupt};
	int *const source = rb_arena_take(problem->arena, (size_t)problem->joint_count,
	                                  sizeof *source);
	const rb_vec3 velocity = relative_velocity(problem, c);
	const struct rb_link link = {.a = c->a,
	                             .b = c->b,
	                             .normal = c->normal,
	                             .arm_a = c->arm_a,
	                             .arm_b = c->arm_b,
	                             .friction = c->friction,
	                             .restitution = c->restitution};
	rb_vec3 impulse;

	cone.row = rb_arena_take(problem->arena, (size_t)problem->joint_count, sizeof *cone.row);
	for (int k = 0; k < problem->joint_count && source && cone.row; k++) {
		const struct rb_cone_row *const row = &problem->joint_row[k];

		if (is_stop(row) || !acts_on(all, row, a, b))
			continue;
		source[cone.row_count] = k;
		cone.row[cone.row_count] = *row;
		rb_constraint_clear(&cone.row[cone.row_count++].base);
	}
	const bool solved = source && cone.row && rb_cone_open(&cone) &&
	                    rb_jointed_impact(&cone, &link, velocity, noise_of(problem, c),
	                                      &impulse);
	all->cone.iterations += cone.iterations;
	for (int r = 0; r < cone.row_count && solved; r++) {
		rb_along_across *const sum = &problem->joint_row[source[r]].base.impulse;
		const rb_along_across p = cone.row[r].base.impulse;

		*sum = (rb_along_across){sum->n + p.n, rb_vec3_add(sum->t, p.t)};
	}
	if (solved) {
		c->impulse = rb_vec3_add(c->impulse, impulse);
		if (c->approach == 0)
			c->approach = -rb_vec3_dot(velocity, c->normal);
		/* their joints take no part in what else is resolved in this round */
		all->involved[a] = all->involved[a] && !rb_solver_is_dynamic(&problem->body[c->a]);
		all->involved[b] = all->involved[b] && !rb_solver_is_dynamic(&problem->body[c->b]);
	}
	rb_arena_back(problem->arena, here);
	return solved;
}

/* Resolves a contact at once if no other acts on the bodies that move with it. */
static bool resolve_single(struct rounds *all, struct rb_solver_contact *c)
{
	struct rb_simultaneous *const problem = all->problem;
	const int a = all->leader[c->a], b = all->leader[c->b];

	if (all->degree[a] > 1 || all->degree[b] > 1)
		return false;
	if (!(-rb_vec3_dot(relative_velocity(problem, c), c->normal) > noise_of(problem, c)))
		return !all->joined[a] && !all->joined[b];
	if (all->joined[a] || all->joined[b])
		return resolve_on_linkage(all, c);
	resolve_alone(problem, c);
	return true;
}

/*
 * Resolves contacts that share no body or linkage with another one at once, the others together.
 * False: out of memory.
 */
static bool run_round(struct rounds *all, bool with_restitution)
{
	struct rb_simultaneous *const problem = all->problem;
	struct rb_cone *const cone = &all->cone;
	bool any_stop = false;

	cone->row_count = 0;
	find_involved(all);
	count_degrees(all);
	for (int k = 0; k < problem->contact_count; k++) {
		struct rb_solver_contact *const c = &problem->contact[k];

		if (!all->active[k] || (with_restitution && resolve_single(all, c)))
			continue;
		all->source[cone->row_count] = k;
		cone->row[cone->row_count++] = rb_simultaneous_row(c);
	}
	all->scale = largest_speed(all);
	all->contact_rows = cone->row_count;
	for (int k = 0; k < problem->joint_count; k++) {
		const bool stop = is_stop(&problem->joint_row[k]);

		any_stop = any_stop || (stop && all->stops[k]);
		if ((stop && !all->stops[k]) || !is_involved(all, &problem->joint_row[k]))
			continue;
		struct rb_cone_row *const row = &cone->row[cone->row_count];

		all->source[cone->row_count++] = k;
		*row = problem->joint_row[k];
		rb_constraint_clear(&row->base);
	}
	/* joints alone need no round */
	if (all->contact_rows == 0 && !any_stop)
		return true;
	return resolve_together(all, with_restitution);
}

/* Dynamic bodies connected by joints get the lowest index among them as their leader. */
static void find_leaders(struct rounds *all)
{
	const struct rb_simultaneous *const problem = all->problem;

	for (int i = 0; i < problem->body_count; i++)
		all->leader[i] = i;
	for (int k = 0; k < problem->joint_count; k++) {
		const struct rb_constraint *const base = &problem->joint_row[k].base;

		if (rb_solver_is_dynamic(&problem->body[base->a]) &&
		    rb_solver_is_dynamic(&problem->body[base->b]))
			rb_forest_join(all->leader, base->a, base->b, false);
	}
	for (int i = 0; i < problem->body_count; i++)
		all->leader[i] = rb_forest_root(all->leader, i);
}

/* m: from the centres of mass of what it moves. */
static double reach_of(const struct rb_simultaneous *problem, const struct rb_solver_contact *c)
{
	return fmax(rb_solver_is_dynamic(&problem->body[c->a]) ? rb_vec3_length(c->arm_a) : 0,
	            rb_solver_is_dynamic(&problem->body[c->b]) ? rb_vec3_length(c->arm_b) : 0);
}

/* Whether two contacts of a body are with others that nothing moves and that are as one here. */
static bool has_same_partner(const struct rb_simultaneous *problem,
                             const struct rb_solver_contact *x, const struct rb_solver_contact *y)
{
	const bool of_a = rb_solver_is_dynamic(&problem->body[x->a]);
	const struct rb_solver_body *const p = &problem->body[of_a ? x->b : x->a],
					   *const q = &problem->body[of_a ? y->b : y->a];
	const rb_vec3 slip = rb_vec3_sub(rb_solver_point_velocity(p, of_a ? x->arm_b : x->arm_a),
	                                 rb_solver_point_velocity(q, of_a ? y->arm_b : y->arm_a));
	return x->pair[!of_a] == y->pair[!of_a] && !rb_solver_is_dynamic(p) &&
	       !rb_solver_is_dynamic(q) && x->friction == y->friction &&
	       x->restitution == y->restitution &&
	       rb_vec3_length(slip) <= same_share * rb_simultaneous_scale(problem, x);
}

/* Whether they are one: of the same bodies, or of one with parts of a fixed surface. */
static bool is_same(const struct rb_simultaneous *problem, const struct rb_solver_contact *x,
                    const struct rb_solver_contact *y)
{
	const double within = same_share * reach_of(problem, x);
	const bool same_pair = x->pair[0] == y->pair[0] && x->pair[1] == y->pair[1];
	const bool at_a = same_pair || rb_solver_is_dynamic(&problem->body[x->a]);
	const bool at_b = same_pair || rb_solver_is_dynamic(&problem->body[x->b]);

	return (same_pair || has_same_partner(problem, x, y)) &&
	       (!at_a || rb_vec3_length(rb_vec3_sub(x->arm_a, y->arm_a)) <= within) &&
	       (!at_b || rb_vec3_length(rb_vec3_sub(x->arm_b, y->arm_b)) <= within) &&
	       rb_vec3_length(rb_vec3_sub(x->normal, y->normal)) <= same_share;
}

/* Finds contacts that are one; overwrites `degree` and `source`. */
static void find_same(struct rounds *all)
{
	const struct rb_simultaneous *const problem = all->problem;
	int *const last = all->degree, *const previous = all->source; /* contacts of a body */

	for (int i = 0; i < problem->body_count; i++)
		last[i] = -1;
	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *const c = &problem->contact[k];
		const int body = rb_solver_is_dynamic(&problem->body[c->a]) ? c->a : c->b;

		all->same[k] = -1;
		for (int i = last[body]; i >= 0 && all->same[k] < 0; i = previous[i])
			if (all->same[i] < 0 && is_same(problem, &problem->contact[i], c))
				all->same[k] = i;
		previous[k] = last[body];
		last[body] = k;
	}
}

/* All names of a contact have equal parts in its impulse, whichever was the first. */
static void share_impulses(const struct rounds *all)
{
	struct rb_solver_contact *const contact = all->problem->contact;
	const int contacts = all->problem->contact_count;
	int *const count = all->source; /* of names */

	for (int k = 0; k < contacts; k++) {
		const int first = all->same[k];

		count[k] = 1;
		if (first < 0)
			continue;
		count[first]++;
		contact[first].impulse = rb_vec3_add(contact[first].impulse, contact[k].impulse);
		contact[first].approach = fmax(contact[first].approach, contact[k].approach);
	}
	for (int k = 0; k < contacts; k++)
		contact[k].impulse = rb_vec3_scale(1.0 / count[k], contact[k].impulse);
	for (int k = 0; k < contacts; k++)
		if (all->same[k] >= 0) {
			contact[k].impulse = contact[all->same[k]].impulse;
			contact[k].approach = contact[all->same[k]].approach;
		}
}

static bool take_rounds(struct rounds *all)
{
	struct rb_simultaneous *const problem = all->problem;
	const size_t contacts = (size_t)problem->contact_count;

	all->cone = (struct rb_cone){.bodies = rb_simultaneous_bodies(problem),
	                             .body_count = problem->body_count,
	                             .arena = problem->arena,
	                             .tolerance = problem->tolerance,
	                             .max = problem->products_max,
	                             .interrupt = problem->interrupt};
	all->active = rb_arena_take(problem->arena, contacts, sizeof *all->active);
	all->same = rb_arena_take(problem->arena, contacts, sizeof *all->same);
	all->source = rb_arena_take(problem->arena, contacts + (size_t)problem->joint_count,
	                            sizeof *all->source);
	all->stops = rb_arena_take(problem->arena, (size_t)problem->joint_count + 1,
	                           sizeof *all->stops);
	all->degree = rb_arena_take(problem->arena, (size_t)problem->body_count,
	                            sizeof *all->degree);
	all->leader = rb_arena_take(problem->arena, (size_t)problem->body_count,
	                            sizeof *all->leader);
	all->joined = rb_arena_take(problem->arena, (size_t)problem->body_count,
	                            sizeof *all->joined);
	all->involved = rb_arena_take(problem->arena, (size_t)problem->body_count,
	                              sizeof *all->involved);
	all->cone.row = rb_arena_take(problem->arena, contacts + (size_t)problem->joint_count,
	                              sizeof *all->cone.row);
	if (!all->active || !all->same || !all->source || !all->stops || !all->degree ||
	    !all->leader || !all->joined || !all->involved || !all->cone.row)
		return false;
	find_leaders(all);
	find_same(all);
	return true;
}

bool rb_simultaneous_impact(struct rb_simultaneous *problem, int *rounds)
{
	const rb_arena_mark here = rb_arena_here(problem->arena);
	struct rounds all = {.problem = problem};
	bool converged = take_rounds(&all), only_tail = false;
	int round = 0;

	for (int k = 0; k < problem->contact_count; k++) {
		problem->contact[k].impulse = (rb_vec3){0, 0, 0};
		problem->contact[k].approach = 0;
	}
	for (int k = 0; k < problem->joint_count; k++) {
		rb_constraint_clear(&problem->joint_row[k].base);
		problem->joint_row[k].approach = 0;
	}
	const int max = ROUNDS + ROUNDS_PER_CONTACT * problem->contact_count;
	double slowest = HUGE_VAL; /* m/s: the least of the largest approaches so far */
	int failed = 0;

	problem->blocked = false;
	while (converged && find_active(&all, &only_tail) > 0) {
		const bool last = only_tail || round == max;

		failed = all.failed && all.largest >= slowest ? failed + 1 : 0;
		slowest = fmin(slowest, all.largest);
		all.failed = false;
		if (failed == ROUNDS_BLOCKED || all.blocked) {
			problem->blocked = true;
			converged = false;
			break;
		}
		if (last) {
			memset(all.active, 1, (size_t)problem->contact_count * sizeof *all.active);
			memset(all.stops, 1, (size_t)problem->joint_count * sizeof *all.stops);
		}
		if (!run_round(&all, !last) || rb_cone_is_over(&all.cone))
			converged = false;
		round++;
		if (last) {
			converged = converged && only_tail;
			break;
		}
	}
	if (converged || round > 0)
		share_impulses(&all);
	problem->products = all.cone.iterations;
	if (rounds)
		*rounds = round;
	rb_arena_back(problem->arena, here);
	return converged;
}
