/* SPDX-License-Identifier: MIT */
#include "located/pair_impact.h"

#include "base/error.h"

#include <float.h>

#include "constraint/contact_row.h"
#include "geom/distance.h"
#include "located/account.h"
#include "located/bounces.h"
#include "located/event_records.h"
#include "located/external_force.h"
#include "located/interleaved.h"
#include "located/mechanics.h"
#include "located/work.h"

/* Height of the smallest rebound of spheres, in ulp of the size. */
enum { SMALLEST_ULP = 8 };

bool rb_pair_impact_ends(const struct rb_located *l, const struct rb_contact_point *m,
                         double target_velocity, double closing)
{
	const double ulp = rb_event_set_is_single(l, m->a, m->b) ? SMALLEST_ULP
	                                                         : RB_SMALLEST_CORNER_ULP;

	return closing > 0 && target_velocity * target_velocity <=
	                              2 * closing * ulp * DBL_EPSILON * rb_contact_point_size(l, m);
}

/* True if the body is not connected to others: it is in flight, or on a piece of its own. */
static bool is_alone(const struct rb_located *l, int i)
{
	if (l->cluster_of[i] < 0)
		return !rb_located_on_piece(l, i);
	const struct rb_cluster *const c = &l->cluster[l->cluster_of[i]];

	return c->integrated && c->member_count == 1 && c->held_count == 0 && !l->model->joints &&
	       !rb_located_gravitates(l);
}

/* True for a free sphere about its centre, or a fixed body. */
static bool is_plain(const struct rb_located *l, int i)
{
	if (i >= l->n)
		return true;
	return l->model->shape[i].kind == RB_SHAPE_SPHERE && is_alone(l, i) &&
	       !l->model->center_of_mass && (!l->top || l->top_body[i].kind == RB_TOP_CONSTANT);
}

/*
 * Applies an impulse: its normal part passes through the centre, so only the tangential part
 * changes the spin.
 */
static void kick(struct rb_located *l, int i, const rb_vec3 impulse[2], rb_vec3 arm,
                 struct rb_pose *pose)
{
	if (i >= l->n)
		return;
	pose->velocity = rb_vec3_add_scaled(pose->velocity, l->model->inverse_mass[i], impulse[0]);
	if (l->top)
		pose->spin = rb_vec3_add_scaled(pose->spin, l->model->inverse_inertia_scalar[i],
		                                rb_vec3_cross(arm, impulse[1]));
}

/* Inverse effective mass at the surface along a tangent. */
static double turn_inverse_mass(const struct rb_located *l, int i)
{
	if (i >= l->n)
		return 0;
	const double radius = l->model->shape[i].radius;

	return l->model->inverse_mass[i] +
	       (l->top ? radius * radius * l->model->inverse_inertia_scalar[i] : 0);
}

/* Counts the impact; true if its rebound is slower than the speed of rest of its jam. */
static bool ends_among_others(struct rb_located *l, const struct rb_contact_point *m,
                              double target_velocity, double t)
{
	return target_velocity <= rb_interleaved_speed(l, m, rb_interleaved_note(l, m, t, false));
}

/* ---- a pair in flight ---- */

/* True for a sphere on a parabola of gravity alone, in no cluster, without rotation. */
static bool flies(const struct rb_located *l, int i)
{
	return l->arc[i].plain_radius > 0 && l->cluster_of[i] < 0 && !l->top &&
	       !rb_located_on_piece(l, i) && !rb_located_driven(l, i);
}

/* New anchor with the same acceleration. */
static void fly_on(struct rb_located *l, int i, double t, rb_vec3 position, rb_vec3 velocity)
{
	struct rb_arc *arc = &l->arc[i];

	rb_account_arc(l, i, t);
	arc->anchor_s = t;
	arc->position = position;
	arc->velocity = velocity;
}

/*
 * The same as rb_pair_impact, bit for bit, if there are no spins, friction or differences of
 * acceleration; false: there are, or the rebound is slow.
 */
static bool collide_in_flight(struct rb_located *l, int a, int b, double t)
{
	const struct rb_model *model = l->model;
	const bool fixed = b >= l->n;
	rb_vec3 normal, other = {0, 0, 0}, position_b = {0, 0, 0};

	if (!flies(l, a))
		return false;
	const rb_vec3 position_a = rb_arc_position(l, a, t), velocity = rb_arc_velocity(l, a, t);
	if (fixed) {
		if (model->shape[b].kind != RB_SHAPE_PLANE ||
		    rb_vec3_max_abs(l->arc[a].acceleration) > 0)
			return false;
		normal = rb_vec3_neg(l->plane_normal[b - l->n]);
	} else {
		if (!flies(l, b))
			return false;
		other = rb_arc_velocity(l, b, t);
		position_b = rb_arc_position(l, b, t);
		rb_distance_sphere_sphere(position_a, 0, position_b, 0, &normal);
	}
	const rb_vec3 w = rb_vec3_sub(other, velocity);
	const double restitution = rb_contact_material(model, a, b)->restitution;
	const double approach = -rb_vec3_dot(w, normal), target_velocity = restitution * approach;
	const double noise = 8 * DBL_EPSILON * (rb_vec3_max_abs(velocity) + rb_vec3_max_abs(other));

	if (!(approach > noise) || !(target_velocity > noise) ||
	    !(target_velocity * target_velocity > DBL_EPSILON * rb_vec3_dot(w, w)))
		return false;
	const rb_vec3 arm = rb_vec3_scale(l->arc[a].plain_radius, normal);
	const struct rb_contact_point m = {.a = a,
	                                   .b = b,
	                                   .normal = normal,
	                                   .point = rb_vec3_add(position_a, arm),
	                                   .pose_a = {.position = position_a},
	                                   .arm_a = arm};
	if (l->weight > 0 && ends_among_others(l, &m, target_velocity, t))
		return false;
	const double inverse_a = model->inverse_mass[a];
	const double inverse_b = fixed ? 0 : model->inverse_mass[b];
	const double size = (1 + restitution) * approach /
	                    ((inverse_a + inverse_b) * rb_vec3_dot(normal, normal));
	const rb_vec3 impulse = rb_vec3_add_scaled((rb_vec3){0, 0, 0}, size, normal);

	if (l->account_s)
		rb_work_impact(l, &m, impulse, w,
		               rb_vec3_add_scaled(w, inverse_a + inverse_b, impulse));
	fly_on(l, a, t, position_a, rb_vec3_add_scaled(velocity, inverse_a, rb_vec3_neg(impulse)));
	if (!fixed)
		fly_on(l, b, t, position_b, rb_vec3_add_scaled(other, inverse_b, impulse));
	rb_record_impact(l, t, &m, impulse, approach);
	return true;
}

/* Velocity of b's point relative to a's, by the present poses. */
static rb_vec3 velocity_of(const struct rb_contact_point *m)
{
	return rb_vec3_sub(
		rb_vec3_add(m->pose_b.velocity, rb_vec3_cross(m->pose_b.spin, m->arm_b)),
		rb_vec3_add(m->pose_a.velocity, rb_vec3_cross(m->pose_a.spin, m->arm_a)));
}

/* A new arc under the same forces as before. */
static void go_on(struct rb_located *l, int i, double t, const struct rb_pose *pose)
{
	if (i >= l->n)
		return;
	const double decay = rb_arc_decay(l, i);

	rb_arc_anchor(l, i, t, pose,
	              decay > 0 ? l->arc[i].acceleration : rb_arc_acceleration(l, i, t),
	              rb_external_turning(l, i));
	rb_arc_set_drag(l, i, decay);
}

bool rb_pair_impact(struct rb_located *l, int a, int b, double t)
{
	RB_ASSERT(rb_located_is_body(l, a) && rb_located_is_body(l, b) && a != b);
	if (collide_in_flight(l, a, b, t))
		return true;
	if (!is_plain(l, a) || !is_plain(l, b))
		return false;
	struct rb_contact_point m = rb_contact_point_at(l, a, b, t);
	struct rb_solver_contact c = rb_mechanics_contact(l, &m);
	const double approach = -rb_vec3_dot(m.velocity, m.normal);
	const double target_velocity = c.restitution * approach;
	const double inverse_a = m.a < l->n ? l->model->inverse_mass[m.a] : 0;
	const double inverse_b = m.b < l->n ? l->model->inverse_mass[m.b] : 0;

	c.noise = rb_contact_point_noise(l, &m);
	if (!(approach > c.noise) || m.on_rim || !(target_velocity > c.noise))
		return false;
	const double closing = rb_bounces_closing(l, &m, t);
	if (rb_pair_impact_ends(l, &m, target_velocity, closing) ||
	    ends_among_others(l, &m, target_velocity, t))
		return false;
	if ((rb_located_on_piece(l, a) || rb_located_on_piece(l, b)) &&
	    (rb_event_set_touches_another(l, a, b, t) || rb_event_set_touches_another(l, b, a, t)))
		return false;
	if (closing > 0 && c.restitution < 1)
		rb_bounces_note(l, &m, t, target_velocity, closing, c.restitution);
	/*
	 * divided by n.n, which is 1 only to rounding: a wall may be hit a million times along one
	 * normal
	 */
	const double normal = (1 + c.restitution) * approach /
	                      ((inverse_a + inverse_b) * rb_vec3_dot(m.normal, m.normal));
	rb_vec3 tangent = {0, 0, 0};
	if (c.friction > 0) {
		const rb_vec3 slip = rb_vec3_reject(m.velocity, m.normal);
		const double speed = rb_vec3_length(slip);
		const double stop = speed / (turn_inverse_mass(l, m.a) + turn_inverse_mass(l, m.b));
		const double size = fmin(stop, c.friction * normal);

		if (speed > 0)
			tangent = rb_vec3_scale(-size / speed, slip);
	}
	c.impulse = rb_vec3_add_scaled(tangent, normal, m.normal);
	c.approach = approach;
	const rb_vec3 on_a[2] = {rb_vec3_neg(c.impulse), rb_vec3_neg(tangent)};
	const rb_vec3 on_b[2] = {c.impulse, tangent};
	kick(l, m.a, on_a, m.arm_a, &m.pose_a);
	kick(l, m.b, on_b, m.arm_b, &m.pose_b);
	if (l->account_s)
		rb_work_impact(l, &m, c.impulse, m.velocity, velocity_of(&m));
	go_on(l, m.a, t, &m.pose_a);
	go_on(l, m.b, t, &m.pose_b);
	rb_record_impact(l, t, &m, c.impulse, approach);
	return true;
}
