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

enum {
	ROUNDS = 512, /* and 16 per contact: then the rest is done without restitution */
	ROUNDS_PER_CONTACT = 16
};

/*
 * Approaches below this share of the first round's end without restitution: what is left of an
 * infinite series.
 */
static const double tail_share = 1e-13;
/* Violation, as a share of the speeds, above which a solution is not taken for one. */
static const double failed_share = 1e-9;

static rb_vec3 relative(const struct rb_simultaneous *joint, const struct rb_solver_contact *c)
{
	return rb_vec3_sub(rb_solver_point_velocity(&joint->body[c->b], c->arm_b),
	                   rb_solver_point_velocity(&joint->body[c->a], c->arm_a));
}

static double speed_bound(const struct rb_solver_body *body, rb_vec3 arm)
{
	return rb_vec3_length(body->linear) + rb_vec3_length(body->angular) * rb_vec3_length(arm);
}

/* The largest speed that a contact's velocity is a difference of. */
static double speeds_of(const struct rb_simultaneous *joint, const struct rb_solver_contact *c)
{
	return fmax(speed_bound(&joint->body[c->a], c->arm_a),
	            speed_bound(&joint->body[c->b], c->arm_b));
}

/* --- one contact on its own --- */

/*
 * Adds the body's part of K; false where it is eccentric: normal and tangent meddle, or tangents
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

static struct rb_link link_of(const struct rb_simultaneous *joint,
                              const struct rb_solver_contact *c)
{
	const struct rb_solver_bodies bodies = rb_simultaneous_bodies(joint);
	const struct rb_solver_body *const a = &joint->body[c->a], *const b = &joint->body[c->b];
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
	/* each on its own and then together: which is called a must not matter */
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

static void hit_alone(struct rb_simultaneous *joint, struct rb_solver_contact *c)
{
	const struct rb_solver_bodies bodies = rb_simultaneous_bodies(joint);
	const struct rb_link link = link_of(joint, c);
	const rb_vec3 u = relative(joint, c);
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

/* --- several --- */

struct rounds {
	struct rb_simultaneous *joint;
	bool *active; /* [contact_count]: takes part in this round */
	int *crowd;   /* [body_count]: contacts of this round that a body has */
	/*
	 * [contact_count + joint_count]: of the rows, those of contacts first; and how many of
	 * these
	 */
	int *which;
	int contact_rows;
	bool *stops;  /* [joint_count]: row of a joint that only pushes and takes part */
	int *leader;  /* [body_count]: the first of the bodies that joints connect with it */
	bool *near;   /* [body_count]: leaders of those that take part in this round */
	double first; /* m/s: largest approach of the first round */
	double scale; /* m/s: largest speed of those that take part */
	struct rb_cone cone;
};

static struct rb_cone_row row_of(const struct rb_solver_contact *c)
{
	return (struct rb_cone_row){
		.base = rb_contact_row(c->a, c->b, c->normal, c->arm_a, c->arm_b, c->friction)};
}

/* A limit or a rope: it only pushes. */
static bool is_stop(const struct rb_cone_row *row)
{
	return rb_constraint_side(&row->base) > 0;
}

/* m/s: the largest that the velocity of a limit or a rope is a difference of. */
static double stop_speeds(const struct rb_simultaneous *joint, const struct rb_cone_row *row)
{
	const struct rb_solver_body *a = &joint->body[row->base.a], *b = &joint->body[row->base.b];
	const double bias = rb_vec3_length(row->bias);

	if (row->base.couple)
		return fmax(bias, row->base.arm_a.x * fmax(rb_vec3_length(a->angular),
		                                           rb_vec3_length(b->angular)));
	return fmax(bias, fmax(speed_bound(a, row->base.arm_a), speed_bound(b, row->base.arm_b)));
}

/* Whether a row of a joint has to do with what takes part in this round. */
static bool is_near(const struct rounds *all, const struct rb_cone_row *row)
{
	return all->near[all->leader[row->base.a]] || all->near[all->leader[row->base.b]];
}

/*
 * Of what takes part in this round: the speed of others, which a shock has sent off, would hide
 * what is left of it here.
 */
static double largest_speed(const struct rounds *all)
{
	const struct rb_simultaneous *const joint = all->joint;
	double largest = 0;

	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];

		if (all->active[k] || all->near[all->leader[c->a]])
			largest = fmax(largest, speed_bound(&joint->body[c->a], c->arm_a));
		if (all->active[k] || all->near[all->leader[c->b]])
			largest = fmax(largest, speed_bound(&joint->body[c->b], c->arm_b));
	}
	for (int k = 0; k < joint->joint_count; k++)
		if (is_stop(&joint->joint_row[k]) && is_near(all, &joint->joint_row[k]))
			largest = fmax(largest, stop_speeds(joint, &joint->joint_row[k]));
	return largest;
}

/* Impulses of all rows back to nothing, and the bodies with them. */
static void undo(struct rounds *all, const struct rb_solver_body *before)
{
	memcpy(all->cone.bodies.body, before, (size_t)all->cone.body_count * sizeof *before);
	for (int k = 0; k < all->cone.row_count; k++)
		all->cone.row[k].base.impulse = (rb_along_across){0, {0, 0, 0}};
}

/*
 * Stops what approaches, with friction; without it where that does not settle (a body jammed
 * between others).
 */
static void compress(struct rounds *all, const struct rb_solver_body *before)
{
	struct rb_cone *const cone = &all->cone;

	if (rb_cone_resolve(cone, all->scale) <= failed_share * all->scale)
		return;
	undo(all, before);
	for (int k = 0; k < cone->row_count; k++)
		cone->row[k].base.friction = 0;
	rb_cone_resolve(cone, all->scale);
}

/* Restitution of a row: 0 of those of joints that may pull. */
static double restitution_of(const struct rounds *all, int k)
{
	return k < all->contact_rows ? all->joint->contact[all->which[k]].restitution
	                             : all->cone.row[k].restitution;
}

/* Does a row rebound: is it a contact, a limit or a rope? */
static bool rebounds(const struct rounds *all, int k)
{
	return k < all->contact_rows || is_stop(&all->cone.row[k]);
}

/*
 * Gives back restitution times what compression took, along the normals, then lets friction stop
 * what it can within the cones of the whole. `spare` is twice the energy that compression took: the
 * normal impulses are made smaller together where they would give back more.
 */
static void restore(struct rounds *all, double spare, rb_along_across *back, rb_along_across *after)
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
			back[k] = (rb_along_across){restitution_of(all, k) * p.n, {0, 0, 0}};
		else
			back[k] = (rb_along_across){restitution_max * p.n,
			                            rb_vec3_scale(restitution_max, p.t)};
		after[k] = rb_cone_velocity(cone, &cone->row[k]);
	}
	struct rb_solver_body *const kept = cone->kept;
	memcpy(kept, cone->bodies.body, (size_t)cone->body_count * sizeof *kept);
	rb_cone_apply_normal(cone, back);
	for (int k = 0; k < cone->row_count; k++) {
		const rb_along_across u = rb_cone_velocity(cone, &cone->row[k]);

		after[k] = (rb_along_across){u.n - after[k].n,
		                             k < contacts ? (rb_vec3){0, 0, 0}
		                                          : rb_vec3_sub(u.t, after[k].t)};
	}
	const double needed = rb_cone_dot(cone, back, after);
	if (needed > spare * (1 + 64 * DBL_EPSILON)) {
		const double share = spare > 0 ? sqrt(spare / needed) : 0;

		memcpy(cone->bodies.body, kept, (size_t)cone->body_count * sizeof *kept);
		for (int k = 0; k < cone->row_count; k++) {
			struct rb_constraint *const row = &cone->row[k].base;

			row->impulse.n -= back[k].n;
			row->impulse.t = rb_vec3_sub(row->impulse.t, back[k].t);
			back[k].n *= share;
			back[k].t = rb_vec3_scale(share, back[k].t);
		}
		rb_cone_apply_normal(cone, back);
	}
	for (int k = 0; k < cone->row_count; k++) {
		cone->row[k].given = rebounds(all, k);
		any_friction = any_friction || (k < contacts && cone->row[k].base.friction > 0);
	}
	if (any_friction)
		rb_cone_resolve(cone, all->scale);
}

/* The rows of one round, together. False when memory is out. */
static bool hit_together(struct rounds *all, bool with_restitution)
{
	struct rb_simultaneous *const joint = all->joint;
	struct rb_cone *const cone = &all->cone;
	const size_t rows = (size_t)cone->row_count, contacts = (size_t)all->contact_rows;
	const rb_arena_mark here = rb_arena_here(joint->arena);
	rb_along_across *const before = rb_arena_take(joint->arena, rows, sizeof *before);
	rb_along_across *const impulse = rb_arena_take(joint->arena, rows, sizeof *impulse);
	rb_along_across *const sum = rb_arena_take(joint->arena, rows, sizeof *sum);
	struct rb_solver_body *const kept = rb_arena_take(joint->arena, (size_t)joint->body_count,
	                                                  sizeof *kept);
	bool restitution = false;

	if (!before || !impulse || !sum || !kept || !rb_cone_open(cone)) {
		rb_arena_back(joint->arena, here);
		return false;
	}
	memcpy(kept, joint->body, (size_t)joint->body_count * sizeof *kept);
	for (size_t k = 0; k < rows; k++)
		before[k] = rb_cone_velocity(cone, &cone->row[k]);
	compress(all, kept);
	for (size_t k = 0; k < rows; k++) {
		const rb_along_across u = rb_cone_velocity(cone, &cone->row[k]);

		impulse[k] = cone->row[k].base.impulse;
		sum[k] = (rb_along_across){u.n + before[k].n, rb_vec3_add(u.t, before[k].t)};
		restitution = restitution || (rebounds(all, (int)k) && impulse[k].n > 0 &&
		                              restitution_of(all, (int)k) > 0);
	}
	/* change of kinetic energy: the sum of J.(u + u')/2 */
	const double spare = -rb_cone_dot(cone, impulse, sum);
	if (restitution && with_restitution)
		restore(all, spare, impulse, sum);
	for (size_t k = contacts; k < rows; k++) {
		struct rb_cone_row *const row = &joint->joint_row[all->which[k]];
		const rb_along_across p = cone->row[k].base.impulse;

		row->base.impulse.n += p.n;
		row->base.impulse.t = rb_vec3_add(row->base.impulse.t, p.t);
		if (is_stop(row) && p.n > 0 && row->approach == 0 && before[k].n < -row->noise)
			row->approach = -before[k].n;
	}
	for (size_t k = 0; k < contacts; k++) {
		struct rb_solver_contact *const c = &joint->contact[all->which[k]];
		const struct rb_cone_row *const row = &cone->row[k];

		c->impulse = rb_vec3_add(c->impulse, rb_constraint_impulse(&row->base));
		if (row->base.impulse.n > 0 && c->approach == 0 && before[k].n < -c->noise)
			c->approach = -before[k].n;
	}
	rb_arena_back(joint->arena, here);
	return true;
}

/*
 * Below it a contact does not approach: the caller's figure, and what this arithmetic can resolve.
 */
static double noise_of(const struct rb_simultaneous *joint, const struct rb_solver_contact *c)
{
	return fmax(fmax(c->noise, joint->tolerance), 4 * DBL_EPSILON * speeds_of(joint, c));
}

/* The same of limits and ropes; adds how many approach. */
static void find_active_stops(struct rounds *all, double *largest, double *restitution_max,
                              int *count)
{
	const struct rb_simultaneous *const joint = all->joint;

	for (int k = 0; k < joint->joint_count; k++) {
		const struct rb_cone_row *row = &joint->joint_row[k];

		all->stops[k] = false;
		if (!is_stop(row))
			continue;
		const double approach = -rb_cone_velocity(&all->cone, row).n;
		const double noise = fmax(fmax(row->noise, joint->tolerance),
		                          4 * DBL_EPSILON * stop_speeds(joint, row));
		all->stops[k] = row->restitution == 0 || approach > noise;
		if (!(approach > noise))
			continue;
		++*count;
		*largest = fmax(*largest, approach);
		*restitution_max = fmax(*restitution_max, row->restitution);
	}
}

/*
 * What takes part in a round: all that approaches, and with it the touching contacts that give
 * nothing back.
 */
static int find_active(struct rounds *all, bool *only_tail)
{
	struct rb_simultaneous *const joint = all->joint;
	double largest = 0, restitution_max = 0;
	int count = 0;

	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];
		const double approach = -rb_vec3_dot(relative(joint, c), c->normal);

		all->active[k] = approach > noise_of(joint, c) &&
		                 (rb_solver_is_dynamic(&joint->body[c->a]) ||
		                  rb_solver_is_dynamic(&joint->body[c->b]));
		if (!all->active[k])
			continue;
		count++;
		largest = fmax(largest, approach);
		restitution_max = fmax(restitution_max, c->restitution);
	}
	find_active_stops(all, &largest, &restitution_max, &count);
	if (all->first == 0)
		all->first = largest;
	*only_tail = restitution_max < 1 && largest <= tail_share * all->first;
	if (count == 0)
		return 0;
	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];

		if (!all->active[k] && c->restitution == 0 &&
		    (rb_solver_is_dynamic(&joint->body[c->a]) ||
		     rb_solver_is_dynamic(&joint->body[c->b]))) {
			all->active[k] = true;
			count++;
		}
	}
	return count;
}

/* Leaders of those that contacts, limits and ropes of this round act on. */
static void find_near(struct rounds *all)
{
	const struct rb_simultaneous *const joint = all->joint;

	memset(all->near, 0, (size_t)joint->body_count * sizeof *all->near);
	for (int k = 0; k < joint->contact_count; k++) {
		if (!all->active[k])
			continue;
		all->near[all->leader[joint->contact[k].a]] = true;
		all->near[all->leader[joint->contact[k].b]] = true;
	}
	for (int k = 0; k < joint->joint_count; k++) {
		const struct rb_constraint *const base = &joint->joint_row[k].base;

		if (!is_stop(&joint->joint_row[k]) || !all->stops[k])
			continue;
		all->near[all->leader[base->a]] = true;
		all->near[all->leader[base->b]] = true;
	}
}

/*
 * Those that share no body with another are done at once, the others together. False when memory is
 * out.
 */
static bool run_round(struct rounds *all, bool with_restitution)
{
	struct rb_simultaneous *const joint = all->joint;
	struct rb_cone *const cone = &all->cone;

	bool felt = false;

	memset(all->crowd, 0, (size_t)joint->body_count * sizeof *all->crowd);
	cone->row_count = 0;
	find_near(all);
	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];

		if (!all->active[k])
			continue;
		all->crowd[c->a] += rb_solver_is_dynamic(&joint->body[c->a]);
		all->crowd[c->b] += rb_solver_is_dynamic(&joint->body[c->b]);
	}
	for (int k = 0; k < joint->joint_count; k++) {
		if (is_stop(&joint->joint_row[k]) && !all->stops[k])
			continue;
		all->crowd[joint->joint_row[k].base.a] += 2;
		all->crowd[joint->joint_row[k].base.b] += 2;
	}
	for (int k = 0; k < joint->contact_count; k++) {
		struct rb_solver_contact *const c = &joint->contact[k];
		const bool alone = all->crowd[c->a] <= 1 && all->crowd[c->b] <= 1;

		if (!all->active[k])
			continue;
		if (with_restitution && alone) {
			if (-rb_vec3_dot(relative(joint, c), c->normal) > noise_of(joint, c))
				hit_alone(joint, c);
			continue;
		}
		all->which[cone->row_count] = k;
		cone->row[cone->row_count++] = row_of(c);
	}
	all->scale = largest_speed(all);
	all->contact_rows = cone->row_count;
	for (int k = 0; k < joint->joint_count; k++) {
		const bool stop = is_stop(&joint->joint_row[k]);

		felt = felt || (stop && all->stops[k]);
		if ((stop && !all->stops[k]) || !is_near(all, &joint->joint_row[k]))
			continue;
		struct rb_cone_row *const row = &cone->row[cone->row_count];

		all->which[cone->row_count++] = k;
		*row = joint->joint_row[k];
		rb_constraint_clear(&row->base);
	}
	/* joints alone have nothing to do */
	if (all->contact_rows == 0 && !felt)
		return true;
	return hit_together(all, with_restitution);
}

/* Bodies that yield and are connected by joints get the smallest of them as their leader. */
static void find_leaders(struct rounds *all)
{
	const struct rb_simultaneous *const joint = all->joint;

	for (int i = 0; i < joint->body_count; i++)
		all->leader[i] = i;
	for (int k = 0; k < joint->joint_count; k++) {
		const struct rb_constraint *const base = &joint->joint_row[k].base;

		if (rb_solver_is_dynamic(&joint->body[base->a]) &&
		    rb_solver_is_dynamic(&joint->body[base->b]))
			rb_forest_join(all->leader, base->a, base->b, false);
	}
	for (int i = 0; i < joint->body_count; i++)
		all->leader[i] = rb_forest_root(all->leader, i);
}

static bool take_rounds(struct rounds *all)
{
	struct rb_simultaneous *const joint = all->joint;
	const size_t contacts = (size_t)joint->contact_count;

	all->cone = (struct rb_cone){.bodies = rb_simultaneous_bodies(joint),
	                             .body_count = joint->body_count,
	                             .arena = joint->arena,
	                             .tolerance = joint->tolerance,
	                             .max = joint->products_max,
	                             .interrupt = joint->interrupt};
	all->active = rb_arena_take(joint->arena, contacts, sizeof *all->active);
	all->which = rb_arena_take(joint->arena, contacts + (size_t)joint->joint_count,
	                           sizeof *all->which);
	all->stops = rb_arena_take(joint->arena, (size_t)joint->joint_count + 1,
	                           sizeof *all->stops);
	all->crowd = rb_arena_take(joint->arena, (size_t)joint->body_count, sizeof *all->crowd);
	all->leader = rb_arena_take(joint->arena, (size_t)joint->body_count, sizeof *all->leader);
	all->near = rb_arena_take(joint->arena, (size_t)joint->body_count, sizeof *all->near);
	all->cone.row = rb_arena_take(joint->arena, contacts + (size_t)joint->joint_count,
	                              sizeof *all->cone.row);
	if (!all->active || !all->which || !all->stops || !all->crowd || !all->leader ||
	    !all->near || !all->cone.row)
		return false;
	find_leaders(all);
	return true;
}

bool rb_simultaneous_impact(struct rb_simultaneous *joint, int *rounds)
{
	const rb_arena_mark here = rb_arena_here(joint->arena);
	struct rounds all = {.joint = joint};
	bool converged = take_rounds(&all), only_tail = false;
	int round = 0;

	for (int k = 0; k < joint->contact_count; k++) {
		joint->contact[k].impulse = (rb_vec3){0, 0, 0};
		joint->contact[k].approach = 0;
	}
	for (int k = 0; k < joint->joint_count; k++) {
		rb_constraint_clear(&joint->joint_row[k].base);
		joint->joint_row[k].approach = 0;
	}
	const int max = ROUNDS + ROUNDS_PER_CONTACT * joint->contact_count;
	while (converged && find_active(&all, &only_tail) > 0) {
		const bool last = only_tail || round == max;

		if (last) {
			memset(all.active, 1, (size_t)joint->contact_count * sizeof *all.active);
			memset(all.stops, 1, (size_t)joint->joint_count * sizeof *all.stops);
		}
		if (!run_round(&all, !last) || rb_cone_is_over(&all.cone))
			converged = false;
		round++;
		if (last) {
			converged = converged && only_tail;
			break;
		}
	}
	joint->products = all.cone.iterations;
	if (rounds)
		*rounds = round;
	rb_arena_back(joint->arena, here);
	return converged;
}

/* --- forces --- */

/* Accelerations and forces as they are; the guess is brought into the cone and applied. */
static void begin_forces(struct rb_simultaneous *joint, struct rb_cone *cone,
                         rb_along_across *guess)
{
	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *const c = &joint->contact[k];
		struct rb_cone_row *const row = &cone->row[k];
		const double known = fmax(0, rb_vec3_dot(c->impulse, c->normal));
		/* a slip's friction is no more than what is known: large forces would round */
		const double n = c->mode == RB_SOLVER_SLIDE && c->friction > 1
		                         ? fmin(known, rb_vec3_length(c->impulse) / c->friction)
		                         : known;
		rb_vec3 t = rb_vec3_add_scaled(c->impulse, -n, c->normal);

		*row = row_of(c);
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
	for (int k = 0; k < joint->joint_count; k++) {
		const struct rb_constraint *const base = &joint->joint_row[k].base;
		const double n = fmin(fmax(base->impulse.n, base->low), base->high);

		cone->row[joint->contact_count + k] = joint->joint_row[k];
		guess[joint->contact_count + k] = (rb_along_across){
			base->set == RB_CONSTRAINT_INTERVAL ? n : base->impulse.n, base->impulse.t};
	}
}

/* m/s^2: the largest that a row of a joint is a difference of. */
static double joint_scale(const struct rb_simultaneous *joint, const struct rb_cone_row *row)
{
	const struct rb_solver_body *a = &joint->body[row->base.a], *b = &joint->body[row->base.b];
	const rb_vec3 none = {0, 0, 0};

	if (row->base.couple)
		return fmax(rb_vec3_length(row->bias),
		            row->base.arm_a.x *
		                    fmax(rb_vec3_length(a->angular), rb_vec3_length(b->angular)));
	return fmax(fmax(rb_vec3_length(row->bias), speed_bound(a, none)), speed_bound(b, none));
}

double rb_simultaneous_forces(struct rb_simultaneous *joint)
{
	const rb_arena_mark here = rb_arena_here(joint->arena);
	const size_t contacts = (size_t)joint->contact_count;
	const size_t rows = contacts + (size_t)joint->joint_count;
	struct rb_cone cone = {.bodies = rb_simultaneous_bodies(joint),
	                       .body_count = joint->body_count,
	                       .row_count = (int)rows,
	                       .arena = joint->arena,
	                       .probes = joint->probes,
	                       .max = joint->products_max,
	                       .interrupt = joint->interrupt};
	rb_along_across *const guess = rb_arena_take(joint->arena, rows, sizeof *guess);
	double scale = 0;

	cone.row = rb_arena_take(joint->arena, rows, sizeof *cone.row);
	if (guess && cone.row)
		begin_forces(joint, &cone, guess);
	if (!guess || !cone.row || !rb_cone_open(&cone)) {
		rb_arena_back(joint->arena, here);
		return (double)INFINITY;
	}
	for (size_t k = 0; k < contacts; k++)
		scale = fmax(scale, fmax(speeds_of(joint, &joint->contact[k]),
		                         rb_vec3_length(joint->contact[k].bias)));
	for (int k = 0; k < joint->joint_count; k++) {
		rb_constraint_clear(&cone.row[contacts + (size_t)k].base);
		scale = fmax(scale, joint_scale(joint, &joint->joint_row[k]));
	}
	rb_cone_apply_normal(&cone, guess);
	const double left = rb_cone_resolve(&cone, scale);
	joint->products = cone.iterations;
	for (size_t k = 0; k < contacts; k++) {
		struct rb_solver_contact *const c = &joint->contact[k];
		const struct rb_cone_row *const row = &cone.row[k];

		c->impulse = rb_constraint_impulse(&row->base);
		c->slipping = row->base.impulse.n > 0 && row->friction_impulse != RB_CONE_STICK &&
		              rb_vec3_length(row->u.t) > 1e-12 * scale;
	}
	for (int k = 0; k < joint->joint_count; k++)
		joint->joint_row[k].base.impulse = cone.row[contacts + (size_t)k].base.impulse;
	rb_arena_back(joint->arena, here);
	return left;
}
