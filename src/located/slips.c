/* SPDX-License-Identifier: MIT */
/*
 * Directions of slip. Forces and modes come from the simultaneous solver. Velocities give the
 * directions of slow slips only to rounding over speed: previous directions are kept while they are
 * consistent, and slips that begin or end are tested in the direction that they would have.
 */
#include "located/slips.h"

#include "base/error.h"
#include "constraint/simultaneous_forces.h"

#include <float.h>
#include <string.h>

#include "located/articulated.h"
#include "located/joint_problem.h"
#include "located/mechanics.h"

/*
 * Length of a slip that has ended, ulp of the size; rounding of transverse accelerations, ulp;
 * forces that are residuals of others, ulp of their effects.
 */
enum { SLIP_ULP = 1, STRAIGHT_ULP = 64, RESIDUE_ULP = 16 };
/* Cosine above which two normals are equal, to rounding. */
static const double same_direction = 1 - 1e-12;

struct rb_drift rb_slips_drift(const struct rb_resolution *s, bool *kept)
{
	return (struct rb_drift){.l = s->l,
	                         .t = s->t,
	                         .contact_point = s->contact_point,
	                         .before = s->before,
	                         .kept = kept,
	                         .count = s->contact_point_count,
	                         .pose = s->pose};
}

void *rb_slips_take(struct rb_resolution *s, int count, size_t size)
{
	void *const block = rb_arena_take(s->l->arena, (size_t)(count > 0 ? count : 1), size);

	if (!block && s->l->status == RB_OK)
		s->l->status = RB_FAIL(s->l->err, RB_ERR_MEMORY,
		                       "no memory for the contacts of %d bodies", s->l->set_count);
	return block;
}

int rb_slips_pair(const struct rb_resolution *s, int k, int *first)
{
	const struct rb_contact_point *m = s->contact_point;
	int end = k + 1;

	RB_ASSERT_COSTLY(k >= 0 && k < s->contact_point_count);
	*first = k;
	while (*first > 0 && m[*first - 1].a == m[k].a && m[*first - 1].b == m[k].b)
		--*first;
	while (end < s->contact_point_count && m[end].a == m[k].a && m[end].b == m[k].b)
		end++;
	return end;
}

double rb_slips_turn(const struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	const double turn = rb_vec3_length(rb_vec3_sub(m->pose_b.spin, m->pose_a.spin));

	return fmax(rb_vec3_length(m->velocity), turn * rb_contact_point_size(s->l, m));
}

double rb_slips_turn_rate(const struct rb_resolution *s, int k)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const rb_vec3 a = s->problem.body[c->a].angular, b = s->problem.body[c->b].angular;

	return rb_vec3_length(rb_vec3_sub(b, a)) *
	       rb_contact_point_size(s->l, &s->contact_point[k]);
}

/* ---- forces ---- */

/* Place of a member, or a copy of a fixed body's accelerations. */
static int body_of(struct rb_resolution *s, int body)
{
	const struct rb_located *l = s->l;

	if (body < l->n && l->place[body] >= 0)
		return l->place[body];
	s->problem.body[s->problem.body_count] = rb_mechanics_fixed(l, body, s->t);
	return s->problem.body_count++;
}

/* Members with their external accelerations. */
static void fill_bodies(struct rb_resolution *s, rb_mat3 *root)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++) {
		s->problem.body[k] = rb_mechanics_body(l, l->set[k], s->linear[k], s->angular[k]);
		root[k] = rb_mechanics_root(l, l->set[k], &s->pose[k]);
	}
	s->problem.root = root;
	s->problem.body_count = l->set_count;
}

/* True if a direction is given. */
static bool is_given(rb_vec3 slip)
{
	return rb_vec3_max_abs(slip) > 0;
}

/* Has it stuck until now, and needs more than its friction to continue? */
static bool stick_has_ended(const struct rb_held *before)
{
	return before->a >= 0 && !before->slipping && before->ending;
}

/*
 * Fills contact k of the problem, with its mode: stick, or slide in the given or present direction.
 */
static void fill_contact(struct rb_resolution *s, int k)
{
	struct rb_located *l = s->l;
	const struct rb_contact_point *m = &s->contact_point[k];
	const struct rb_held *before = &s->before[k];
	struct rb_solver_contact *c = &s->problem.contact[k];
	const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
	const double speed = rb_vec3_length(slip);
	const double rest_speed = 4 * rb_contact_point_noise(l, m) + s->slack;
	struct rb_event_set_left previous = {.sticks = false};
	const bool has_left = before->a < 0 && rb_event_set_left_of(l, m, &previous);
	const bool sticks = before->a >= 0 ? !before->slipping || before->ending : previous.sticks;
	const bool stuck = sticks && !rb_slips_is_after_impact(s, m);

	*c = rb_mechanics_contact(l, m);
	c->a = body_of(s, m->a);
	c->b = body_of(s, m->b);
	if (before->a >= 0)
		c->impulse = before->force;
	else if (has_left)
		c->impulse = previous.force;
	c->slip = s->slip[k];
	if (s->releases_friction && stick_has_ended(before))
		c->friction = 0;
	if (speed >
	    (stuck ? fmax(rest_speed, rb_drift_correct * (rb_vec3_length(m->pose_a.velocity) +
	                                                  rb_vec3_length(m->pose_b.velocity)))
	           : rest_speed)) {
		c->mode = RB_SOLVER_SLIDE;
		if (!is_given(c->slip))
			c->slip = rb_vec3_scale(1 / speed, slip);
	} else if (is_given(c->slip)) {
		c->mode = RB_SOLVER_SLIDE;
	}
}

bool rb_slips_press(const struct rb_resolution *s, int k)
{
	RB_ASSERT_COSTLY(k >= 0 && k < s->contact_point_count);
	return rb_vec3_dot(s->problem.contact[k].impulse, s->contact_point[k].normal) > 0;
}

/*
 * Shares loads: a contact that begins where another one carries the body, on a coplanar surface,
 * takes half of its load as the initial force, so that neither has precedence. The motion is the
 * same for any sharing.
 */
static void share_loads(struct rb_resolution *s)
{
	for (int k = 0; k < s->contact_point_count; k++)
		for (int i = 0; i < s->contact_point_count && s->before[k].a < 0; i++) {
			const struct rb_contact_point *const added = &s->contact_point[k],
							     *const other = &s->contact_point[i];
			const bool same = added->a == other->a || added->b == other->b;
			const double along = rb_vec3_dot(added->normal, other->normal);

			if (s->before[i].a < 0 || !rb_slips_press(s, i) ||
			    !rb_event_set_is_shared_place(s->l, added, other) ||
			    !((same ? along : -along) > same_direction))
				continue;
			const rb_vec3 half = rb_vec3_scale(0.5, s->problem.contact[i].impulse);
			s->problem.contact[i].impulse = half;
			s->problem.contact[k].impulse = same ? half : rb_vec3_neg(half);
			break;
		}
}

/* Adds a force to a member's load. */
static void add_load(struct rb_resolution *s, int body, double force)
{
	if (body < s->l->n && s->l->place[body] >= 0)
		s->load[s->l->place[body]] += s->l->model->inverse_mass[body] * force;
}

/* Sum of contact forces over mass for each member, m/s^2: the scale of rounding. */
static void find_loads(struct rb_resolution *s)
{
	for (int k = 0; k < s->l->set_count; k++)
		s->load[k] = 0;
	for (int k = 0; k < s->contact_point_count; k++) {
		const double force = rb_vec3_length(s->problem.contact[k].impulse);

		add_load(s, s->contact_point[k].a, force);
		add_load(s, s->contact_point[k].b, force);
	}
}

/* Is the force rounding of the other forces on the body? */
static bool is_residual(const struct rb_resolution *s, int body, double force)
{
	if (body >= s->l->n || s->l->place[body] < 0)
		return true;
	const int place = s->l->place[body];

	return s->l->model->inverse_mass[body] * force <=
	       RESIDUE_ULP * DBL_EPSILON * (s->load[place] + rb_vec3_length(s->linear[place]));
}

/*
 * Drops the solver's residual forces of contacts that only touch, for instance of a ball that falls
 * along a wall: they have no direction, and with them slips would begin backwards and end at once,
 * forever.
 */
static void drop_residuals(struct rb_resolution *s)
{
	for (int k = 0; k < s->contact_point_count; k++) {
		struct rb_solver_contact *const c = &s->problem.contact[k];
		const double force = rb_vec3_length(c->impulse);

		if (force > 0 && is_residual(s, s->contact_point[k].a, force) &&
		    is_residual(s, s->contact_point[k].b, force))
			c->impulse = (rb_vec3){0, 0, 0};
	}
}

bool rb_slips_are_too_many(const struct rb_resolution *s)
{
	const int count = s->contact_point_count;
	const uint64_t cost = s->moves ? rb_located_cost(3.0 * count) : rb_located_rest_cost(count);

	return cost > rb_located_left(s->l);
}

void rb_slips_too_many(const struct rb_resolution *s)
{
	s->l->status = RB_FAIL(s->l->err, RB_ERR_PHYSICS,
	                       "%d contacts together are too many to locate",
	                       s->contact_point_count);
}

/* Accelerations if there are only joints. */
static bool solve_joints(struct rb_resolution *s)
{
	const size_t count = (size_t)s->l->set_count;
	rb_vec3 *const linear = rb_slips_take(s, 2 * s->l->set_count, sizeof *linear);
	struct rb_joint_tree *tree = NULL;
	bool finite = true;

	if (!linear)
		return false;
	memcpy(linear, s->linear, count * sizeof *linear);
	memcpy(linear + count, s->angular, count * sizeof *linear);
	/* for moving bodies it only matters whether they accelerate */
	if (s->moves && !rb_articulated_take(&s->joints, &tree))
		return rb_slips_take(s, -1, SIZE_MAX / 2) != NULL;
	if (tree)
		rb_joint_tree_accelerate(tree, s->t, linear, linear + count);
	for (size_t k = 0; k < 2 * count; k++)
		finite = finite && rb_vec3_finite(linear[k]);
	if (tree && !finite) {
		memcpy(linear, s->linear, count * sizeof *linear);
		memcpy(linear + count, s->angular, count * sizeof *linear);
		tree = NULL;
	}
	if (!tree && !rb_joint_rows_accelerate(&s->joints, linear, linear + count))
		return false;
	for (size_t k = 0; k < count; k++) {
		s->problem.body[k].linear = linear[k];
		s->problem.body[k].angular = linear[count + k];
	}
	return true;
}

/* Solves forces and modes with the given directions. */
static bool solve(struct rb_resolution *s)
{
	s->problem.arena = s->l->arena;
	s->problem.body = rb_slips_take(
		s, s->l->set_count + 2 * s->contact_point_count + 2 * s->joints.count,
		sizeof *s->problem.body);
	s->problem.contact = rb_slips_take(s, s->contact_point_count, sizeof *s->problem.contact);
	rb_mat3 *const root = rb_slips_take(s, s->l->set_count, sizeof *root);
	if (s->l->status != RB_OK)
		return false;
	fill_bodies(s, root);
	for (int k = 0; k < s->contact_point_count; k++)
		fill_contact(s, k);
	share_loads(s);
	s->problem.contact_count = s->contact_point_count;
	s->problem.joint_row = rb_slips_take(s, s->joints.count, sizeof *s->problem.joint_row);
	if (!s->problem.joint_row)
		return false;
	s->problem.interrupt = &s->l->world->interrupt;
	s->problem.products_max = rb_located_products(s->l, s->contact_point_count);
	if (s->contact_point_count > 0 || rb_joint_rows_drive(&s->joints)) {
		s->problem.joint_count = rb_joint_rows_pose_problem(
			&s->joints, true, s->problem.joint_row, s->problem.body,
			&s->problem.body_count);
		rb_simultaneous_forces(&s->problem);
	} else if (s->joints.count > 0 && !solve_joints(s)) {
		return false;
	}
	rb_located_count(s->l, s->problem.products, s->contact_point_count);
	if (rb_simultaneous_is_over(&s->problem)) {
		rb_slips_too_many(s);
		return false;
	}
	find_loads(s);
	drop_residuals(s);
	return true;
}

/* ---- directions ---- */

/* Rate of the slip velocity, m/s^2, tangential. */
static rb_vec3 slip_rate(const struct rb_resolution *s, int k)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const struct rb_solver_body *a = &s->problem.body[c->a], *b = &s->problem.body[c->b];
	const rb_vec3 rate = rb_vec3_sub(
		rb_vec3_add(b->linear, rb_vec3_cross(b->angular, c->arm_b)),
		rb_vec3_add(a->linear, rb_vec3_cross(a->angular, c->arm_a)));

	return rb_vec3_reject(rb_vec3_add(rate, c->bias), c->normal);
}

bool rb_slips_straight(const struct rb_resolution *s, int k, rb_vec3 slip)
{
	const rb_vec3 rate = slip_rate(s, k);
	const double along = rb_vec3_dot(rate, slip);
	const double transverse = rb_vec3_length(rb_vec3_add_scaled(rate, -along, slip));
	const double speed = rb_vec3_length(
		rb_vec3_reject(s->contact_point[k].velocity, s->contact_point[k].normal));
	const double largest = rb_vec3_length(s->contact_point[k].pose_a.velocity) +
	                       rb_vec3_length(s->contact_point[k].pose_b.velocity);

	if (transverse <= STRAIGHT_ULP * DBL_EPSILON * s->external_max)
		return true;
	/* nor does it turn if it ends within the rounding of time */
	return along < 0 && (transverse * speed <= -along * 16 * DBL_EPSILON * largest ||
	                     speed <= -along * 16 * DBL_EPSILON * s->t);
}

bool rb_slips_creep(const struct rb_resolution *s, int k, const struct rb_held *held)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	rb_vec3 friction = {0, 0, 0};
	int first;
	const int end = rb_slips_pair(s, k, &first);

	/* points of a pair slip together, independent of their shares of its load */
	for (int i = first; i < end; i++)
		friction = rb_vec3_add(friction, rb_vec3_reject(s->problem.contact[i].impulse,
		                                                s->contact_point[i].normal));
	return held->slipping && held->friction > 0 &&
	       rb_event_set_is_slow(s->l, m, rb_vec3_dot(slip_rate(s, k), held->slip), friction);
}

/*
 * Ends slips that would stop within rounding of sizes: with several points they may turn at the end
 * as fast as they slow down. True: there was one, and forces must be found again.
 */
static bool stop_slow_slips(struct rb_resolution *s)
{
	bool *const kept = rb_slips_take(s, s->contact_point_count, sizeof *kept);
	struct rb_drift drift = rb_slips_drift(s, kept);
	bool any = false;

	for (int k = 0; kept && k < s->contact_point_count; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];
		const struct rb_contact_point *m = &s->contact_point[k];
		const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
		const double deceleration = -rb_vec3_dot(slip_rate(s, k), c->slip);
		const bool slides = c->mode == RB_SOLVER_SLIDE;
		const bool ends = slides && rb_slips_press(s, k) && c->friction > 0 &&
		                  deceleration > 0 && !rb_event_set_is_single(s->l, m->a, m->b) &&
		                  rb_vec3_dot(slip, slip) <= 2 * deceleration * SLIP_ULP *
		                                                     DBL_EPSILON *
		                                                     rb_contact_point_size(s->l, m);

		/* contacts without force must not lift because of it */
		kept[k] = true;
		s->before[k].slipping = slides && !ends;
		s->before[k].ending = ends;
		any = any || ends;
	}
	if (any)
		rb_drift_stop(&drift);
	return any;
}

/* Direction in which it is known to have slipped until now; false: none. */
static bool previous_direction(const struct rb_resolution *s, int k, rb_vec3 *direction)
{
	const struct rb_held *before = &s->before[k];
	struct rb_event_set_left previous;

	if (rb_slips_is_after_impact(s, &s->contact_point[k]))
		return false;
	if (before->a < 0) {
		if (!rb_event_set_left_of(s->l, &s->contact_point[k], &previous))
			return false;
		*direction = previous.slip;
		return is_given(previous.slip);
	}
	*direction = before->slip;
	return before->slipping && !before->ending;
}

/*
 * Keeps directions of straight slips. A velocity gives the direction only to rounding over speed,
 * and friction in a direction wrong by that would reverse the transverse slip within speed /
 * (friction g), all along. True: there are some.
 */
static bool keep_directions(struct rb_resolution *s)
{
	bool any = false;

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_contact_point *m = &s->contact_point[k];
		const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
		const double speed = rb_vec3_length(slip);
		const double rest_speed = 4 * rb_contact_point_noise(s->l, m) + s->slack + s->drift;
		rb_vec3 direction;

		s->slip[k] = (rb_vec3){0, 0, 0};
		if (!previous_direction(s, k, &direction) ||
		    !(speed > 4 * rb_contact_point_noise(s->l, m) + s->slack))
			continue;
		const rb_vec3 now = rb_vec3_scale(1 / speed, slip);
		const rb_vec3 old = rb_vec3_unit(rb_vec3_reject(direction, m->normal), now);
		if (rb_vec3_length(rb_vec3_sub(now, old)) * speed > rest_speed)
			continue;
		s->slip[k] = old;
		any = true;
	}
	return any;
}

/*
 * Slips that begin at all points of a pair together: the direction of each friction is known only
 * to the root of rounding, so a common direction opposite to their sum is tried. True: there are
 * such pairs.
 */
static bool set_common_directions(struct rb_resolution *s)
{
	bool any = false;

	for (int k = 0, first, end; k < s->contact_point_count; k = end) {
		rb_vec3 friction_sum = {0, 0, 0};
		bool begin = true, straight = true;
		int count = 0;

		end = rb_slips_pair(s, k, &first);
		for (int i = k; i < end; i++) {
			const struct rb_solver_contact *c = &s->problem.contact[i];
			const rb_vec3 friction = rb_vec3_reject(c->impulse, c->normal);

			if (!rb_slips_press(s, i))
				continue;
			count++;
			begin = begin && c->slipping && c->mode == RB_SOLVER_STICK;
			straight = straight &&
			           rb_slips_straight(s, i,
			                             rb_vec3_unit(rb_vec3_neg(friction), c->slip));
			friction_sum = rb_vec3_add(friction_sum, friction);
		}
		for (int i = k; i < end; i++) {
			const rb_vec3 direction = rb_vec3_reject(rb_vec3_neg(friction_sum),
			                                         s->contact_point[i].normal);

			s->slip[i] = count > 1 && begin && !straight
			                     ? rb_vec3_unit(direction, s->slip[i])
			                     : (rb_vec3){0, 0, 0};
			any = any || is_given(s->slip[i]);
		}
	}
	return any;
}

/*
 * Contacts whose sticking has ended slip opposite to the friction that it would have needed. True:
 * there are some.
 */
static bool end_sticking(struct rb_resolution *s)
{
	bool any = false;

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_held *before = &s->before[k];

		if (before->a < 0 || before->slipping || !before->ending ||
		    rb_slips_is_after_impact(s, &s->contact_point[k]))
			continue;
		s->slip[k] = rb_vec3_unit(
			rb_vec3_reject(rb_vec3_neg(before->force), s->contact_point[k].normal),
			s->slip[k]);
		any = any || is_given(s->slip[k]);
	}
	return any;
}

/* True if they begin to slip in that direction. */
static bool sticking_has_ended(const struct rb_resolution *s)
{
	const double rounding = STRAIGHT_ULP * DBL_EPSILON * s->external_max;

	for (int k = 0; k < s->contact_point_count; k++)
		if (s->before[k].a >= 0 && !s->before[k].slipping && s->before[k].ending &&
		    is_given(s->slip[k]) &&
		    (!rb_slips_press(s, k) || rb_vec3_dot(slip_rate(s, k), s->slip[k]) < -rounding))
			return false;
	return true;
}

/* True if slips in given directions are straight and do not begin backwards. */
static bool are_consistent(const struct rb_resolution *s, bool begin)
{
	const double rounding = STRAIGHT_ULP * DBL_EPSILON * s->external_max;

	for (int k = 0; k < s->contact_point_count; k++)
		if (is_given(s->slip[k]) && rb_slips_press(s, k) &&
		    (!rb_slips_straight(s, k, s->slip[k]) ||
		     (begin && rb_vec3_dot(slip_rate(s, k), s->slip[k]) < -rounding)))
			return false;
	return true;
}

/* Clears all given directions. */
static void forget_directions(struct rb_resolution *s)
{
	for (int k = 0; k < s->contact_point_count; k++)
		s->slip[k] = (rb_vec3){0, 0, 0};
}

/*
 * Solves with kept directions; without them if they are inconsistent; then with common directions
 * of slips that begin.
 */
static bool solve_directions(struct rb_resolution *s)
{
	const bool keeps = keep_directions(s);

	if (!solve(s))
		return false;
	if (keeps && !are_consistent(s, false)) {
		forget_directions(s);
		if (!solve(s))
			return false;
	}
	if (!keeps && set_common_directions(s)) {
		const struct rb_simultaneous before = s->problem;

		if (!solve(s))
			return false;
		if (!are_consistent(s, true)) {
			s->problem = before;
			find_loads(s);
		}
	}
	return true;
}

/*
 * Contacts that neither stick nor slip opposite to their friction may separate: with jamming
 * friction, the normal force of sticking is one of two solutions, and vanishes without friction.
 * True: all such contacts separate without it.
 */
static bool releases_friction(struct rb_resolution *s)
{
	bool part = true;

	s->releases_friction = true;
	const bool solved = solve(s);
	s->releases_friction = false;
	for (int k = 0; k < s->contact_point_count && solved; k++)
		part = part && !(stick_has_ended(&s->before[k]) && rb_slips_press(s, k));
	return solved && part;
}

bool rb_slips_solve(struct rb_resolution *s)
{
	s->slip = rb_slips_take(s, s->contact_point_count, sizeof *s->slip);
	if (!s->slip)
		return false;
	forget_directions(s);
	const bool ends = end_sticking(s);

	if (ends && !solve(s))
		return false;
	if (!(ends && (sticking_has_ended(s) || releases_friction(s))) && !solve_directions(s))
		return false;
	if (s->contact_point_count == 0 || !stop_slow_slips(s))
		return true;
	forget_directions(s);
	return solve(s);
}
