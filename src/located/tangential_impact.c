/* SPDX-License-Identifier: MIT */
/*
 * Painleve's paradox (1895): with large friction a sliding contact may have no finite force. The
 * solver then reports less friction than the material's, and the slip is stopped here by an impulse
 * (impact without collision): for a single pair by constraint/eccentric, for several by
 * located/painleve.
 */
#include "located/tangential_impact.h"

#include <float.h>

#include "base/forest.h"
#include "located/painleve.h"
#include "located/mechanics.h"
#include "located/event_records.h"
#include "located/work.h"

/* Share of friction that is missing where the solver has reduced it; above its residual. */
static const double reduced_share = 1e-9;

/* True for a member of the set. */
static bool is_dynamic(const struct rb_resolution *s, int body)
{
	return body < s->l->n && s->l->place[body] >= 0;
}

/* Part that contact k belongs to. */
static int part_of(const struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];

	return rb_forest_root(s->root, s->l->place[is_dynamic(s, m->a) ? m->a : m->b]);
}

/* True if it slips with less than its friction, because no force satisfies the law. */
static bool lacks_solution(const struct rb_resolution *s, int k)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);
	const double friction_impulse = rb_vec3_length(rb_vec3_reject(c->impulse, c->normal));

	return c->mode == RB_SOLVER_SLIDE && normal_impulse > 0 &&
	       friction_impulse < c->friction * normal_impulse * (1 - reduced_share);
}

/* True if no other pair presses in this part. */
static bool is_alone(const struct rb_resolution *s, int k)
{
	int first;
	const int end = rb_slips_pair(s, k, &first);

	for (int other = 0; other < s->contact_point_count; other++)
		if ((other < first || other >= end) && rb_slips_press(s, other) &&
		    part_of(s, other) == part_of(s, k))
			return false;
	return true;
}

/* The points of a pair as one, at the centre of their normal forces. */
static struct rb_contact_point middle_of(struct rb_resolution *s, int k)
{
	int first;
	const int end = rb_slips_pair(s, k, &first);
	rb_vec3 *const force = rb_slips_take(s, end - first, sizeof *force);

	for (int i = first; i < end && force; i++)
		force[i - first] = s->problem.contact[i].impulse;
	return force ? rb_painleve_middle(s->l, &s->contact_point[first], force, end - first)
	             : s->contact_point[k];
}

/* Applies an impulse to a member. */
static void apply(struct rb_resolution *s, int body, const struct rb_pose *pose, rb_vec3 arm,
                  rb_vec3 impulse)
{
	if (!is_dynamic(s, body))
		return;
	struct rb_pose *const own = &s->pose[s->l->place[body]];

	const struct rb_mechanics_change change = rb_mechanics_change(s->l, body, pose->orientation,
	                                                              arm, impulse);

	own->velocity = rb_vec3_add(own->velocity, change.linear);
	own->spin = rb_vec3_add(own->spin, change.angular);
}

/* Stops the slip at one point; false: no impulse does. */
static bool stop_at_point(struct rb_resolution *s, const struct rb_contact_point *m)
{
	rb_vec3 change;
	const rb_vec3 impulse = rb_painleve_impulse(s->l, m, &change);

	if (!(rb_vec3_dot(impulse, m->normal) > 0))
		return false;
	apply(s, m->a, &m->pose_a, m->arm_a, rb_vec3_neg(impulse));
	apply(s, m->b, &m->pose_b, m->arm_b, impulse);
	rb_work_impact(s->l, m, impulse, m->velocity, rb_vec3_add(m->velocity, change));
	rb_record_impact(s->l, s->t, m, impulse, 0);
	return true;
}

/*
 * Stops all pressing contacts of a part, or (`first_only`) reduces slips until the first one ends;
 * false: impulses within friction cannot.
 */
static bool stop_part(struct rb_resolution *s, int part, bool first_only)
{
	struct rb_located *l = s->l;
	const int max = s->contact_point_count;
	struct rb_contact_point *const contact_point = rb_slips_take(s, max, sizeof *contact_point);
	rb_vec3 *const force = rb_slips_take(s, max, sizeof *force);
	double *const friction = rb_slips_take(s, max, sizeof *friction);
	struct rb_painleve painleve = {
		.l = l,
		.contact_point = contact_point,
		.force = force,
		.friction = friction,
		.pose = s->pose,
		.body_count = l->set_count,
		.impulse = rb_slips_take(s, max, sizeof *painleve.impulse),
		.linear = rb_slips_take(s, l->set_count, sizeof *painleve.linear),
		.angular = rb_slips_take(s, l->set_count, sizeof *painleve.angular),
		.scratch = rb_slips_take(s, 3 * max, sizeof *painleve.scratch)};

	if (l->status != RB_OK)
		return false;
	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];

		if (!rb_slips_press(s, k) || part_of(s, k) != part)
			continue;
		contact_point[painleve.count] = s->contact_point[k];
		friction[painleve.count] = c->friction;
		/* in the direction of the diverging forces */
		force[painleve.count] = rb_vec3_scale(
			rb_vec3_dot(c->impulse, c->normal),
			rb_vec3_add_scaled(c->normal, -c->friction, c->slip));
		painleve.count++;
	}
	if (!(first_only ? rb_painleve_slow(&painleve) : rb_painleve_stop(&painleve)))
		return false;
	for (int k = 0; k < l->set_count; k++) {
		s->pose[k].velocity = rb_vec3_add(s->pose[k].velocity, painleve.linear[k]);
		s->pose[k].spin = rb_vec3_add(s->pose[k].spin, painleve.angular[k]);
	}
	for (int k = 0; k < painleve.count; k++) {
		/* painleve.scratch: changes of velocity by the impulses */
		rb_work_impact(l, &contact_point[k], painleve.impulse[k], contact_point[k].velocity,
		               rb_vec3_add(contact_point[k].velocity, painleve.scratch[k]));
		rb_record_impact(l, s->t, &contact_point[k], painleve.impulse[k], 0);
	}
	return true;
}

/*
 * Stops contacts that an impulse has lifted by less than rounding of sizes (of corners, as for
 * rebounds): they would fall back, slip and be lifted again, without end.
 */
static void stop_small_lifts(struct rb_resolution *s)
{
	bool *const kept = rb_slips_take(s, s->contact_point_count, sizeof *kept);
	struct rb_drift drift = rb_slips_drift(s, kept);
	bool any = false;

	for (int k = 0; kept && k < s->contact_point_count; k++) {
		struct rb_contact_point *const m = &s->contact_point[k];

		rb_drift_point(s->l, s->pose, m);
		const double rate = rb_vec3_dot(m->velocity, m->normal);
		const double height = RB_SMALLEST_CORNER_ULP * DBL_EPSILON *
		                      rb_contact_point_size(s->l, m);

		kept[k] = rate * rate <= 2 * s->external_max * height;
		any = any || (kept[k] && rate > rb_contact_point_noise(s->l, m));
	}
	if (any)
		rb_drift_stop(&drift);
}

/*
 * Ends the slips of a part if all of its points are so slow that any force would stop them within
 * rounding of positions: individual impulses would leave others as slow. False: one is faster.
 */
static bool stop_slight_slips(struct rb_resolution *s, int part)
{
	bool *const kept = rb_slips_take(s, s->contact_point_count, sizeof *kept);
	struct rb_drift drift = rb_slips_drift(s, kept);

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_contact_point *const m = &s->contact_point[k];
		const double height = RB_SMALLEST_CORNER_ULP * DBL_EPSILON *
		                      rb_contact_point_size(s->l, m);
		const bool own = kept && part_of(s, k) == part;

		if (!kept ||
		    (own && rb_vec3_dot(m->velocity, m->velocity) > 2 * s->external_max * height))
			return false;
		kept[k] = own;
	}
	for (int k = 0; k < s->contact_point_count; k++) {
		if (!kept[k])
			continue;
		s->before[k].slipping = false;
		s->before[k].ending = true;
	}
	rb_drift_stop(&drift);
	return true;
}

bool rb_tangential_impact(struct rb_resolution *s)
{
	const rb_vec3 none = {0, 0, 0};
	bool any = false;

	for (int k = 0; k < s->contact_point_count && !any; k++) {
		if (!lacks_solution(s, k))
			continue;
		any = stop_slight_slips(s, part_of(s, k));
		if (any)
			break;
		const struct rb_solver_contact *c = &s->problem.contact[k];
		const bool alone = is_alone(s, k);
		const struct rb_contact_point middle = middle_of(s, k);
		int first;

		/*
		 * if the points of a pair can stop together, all are stopped, which is more than
		 * their centre
		 */
		any = (!alone ||
		       (rb_slips_pair(s, k, &first) > first + 1 && c->restitution == 0)) &&
		      stop_part(s, part_of(s, k), false);
		any = any || (alone && stop_at_point(s, &middle)) ||
		      stop_part(s, part_of(s, k), true);
	}
	if (any)
		stop_small_lifts(s);
	/* provisional: resolving again finds the forces */
	for (int k = 0; k < s->l->set_count && any; k++)
		rb_arc_anchor(s->l, s->l->set[k], s->t, &s->pose[k], none, none);
	return any;
}

int rb_tangential_impact_hit(const struct rb_resolution *s)
{
	double fastest = 0;
	int contact = -1;

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_contact_point *m = &s->contact_point[k];
		const double approach = -rb_vec3_dot(m->velocity, m->normal);
		const double noise = 4 * rb_contact_point_noise(s->l, m) + s->slack;

		if (!(approach > fmax(fastest, noise)) || rb_contact_point_passes(s->l, m, s->t))
			continue;
		fastest = approach;
		contact = k;
	}
	return contact;
}
