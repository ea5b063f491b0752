/* SPDX-License-Identifier: MIT */
/*
 * Work and momentum for the ledger. Energy is entered by cause; momentum where it leaves the
 * dynamic bodies, at static and driven ones. The work of an impulse is exactly its product with the
 * mean of the velocities before and after.
 */
#include "located/work.h"

#include "base/error.h"
#include "located/articulated.h"

/* Cause of momentum for a fixed body. */
static enum rb_ledger_momentum cause_of(const struct rb_located *l, int body)
{
	return rb_located_driven(l, body) ? RB_MOMENTUM_DRIVEN : RB_MOMENTUM_STATIC;
}

/* Enters the impulse or force of a fixed body on a dynamic one, at a point with that velocity. */
static void add_fixed(const struct rb_located *l, int body, rb_vec3 impulse, rb_vec3 point,
                      rb_vec3 velocity, struct rb_entries *e)
{
	if (!rb_located_fixed(l, body))
		return;
	rb_entries_impulse(e, cause_of(l, body), impulse, point);
	if (rb_located_driven(l, body))
		rb_entries_energy(e, RB_ENERGY_DRIVEN, rb_vec3_dot(impulse, velocity));
}

/* Velocity of a body's point. */
static rb_vec3 velocity_at(const struct rb_pose *pose, rb_vec3 arm)
{
	return rb_vec3_add(pose->velocity, rb_vec3_cross(pose->spin, arm));
}

/* Enters both sides of a contact; `on_b` is the force or impulse on b. */
static void add_sides(const struct rb_located *l, const struct rb_contact_point *m, rb_vec3 on_b,
                      struct rb_entries *e)
{
	/* at the point of the dynamic body: with a gap, that of the other one is elsewhere */
	add_fixed(l, m->a, on_b, rb_vec3_add(m->pose_b.position, m->arm_b),
	          velocity_at(&m->pose_a, m->arm_a), e);
	add_fixed(l, m->b, rb_vec3_neg(on_b), rb_vec3_add(m->pose_a.position, m->arm_a),
	          velocity_at(&m->pose_b, m->arm_b), e);
}

void rb_work_impact(struct rb_located *l, const struct rb_contact_point *m, rb_vec3 impulse,
                    rb_vec3 before, rb_vec3 after)
{
	struct rb_entries e = {0};
	const rb_vec3 mean = rb_vec3_scale(0.5, rb_vec3_add(before, after));

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (!l->account_s)
		return;
	const double all = rb_vec3_dot(impulse, mean);
	const double along = rb_vec3_dot(impulse, m->normal) * rb_vec3_dot(mean, m->normal);

	rb_entries_energy(&e, RB_ENERGY_IMPACTS, -along);
	rb_entries_energy(&e, RB_ENERGY_IMPACT_FRICTION, along - all);
	add_sides(l, m, impulse, &e);
	rb_ledger_enter(&l->world->ledger, &e);
}

/* Angular momentum by rotation, N m s. */
static rb_vec3 turning_momentum(const struct rb_located *l, int i, const struct rb_pose *pose)
{
	const rb_quat q = pose->orientation;

	return l->top ? rb_quat_rotate(q, rb_mat3_apply(rb_model_inertia(l->model, i),
	                                                rb_quat_rotate_back(q, pose->spin)))
	              : (rb_vec3){0, 0, 0};
}

void rb_work_moved(struct rb_located *l, const struct rb_pose *from, const struct rb_pose *to)
{
	const rb_vec3 gravity = l->model->scene->world.gravity;
	struct rb_entries e = {0};
	rb_vec3 twist = {0, 0, 0};
	double lost = 0;

	if (!l->account_s)
		return;
	for (int k = 0; k < l->set_count; k++) {
		const int i = l->set[k];
		const double mass = l->model->mass[i];
		const rb_vec3 way = rb_pose_between(&from[k], &to[k]);
		const rb_vec3 change = rb_vec3_sub(turning_momentum(l, i, &to[k]),
		                                   turning_momentum(l, i, &from[k]));

		lost += mass * rb_vec3_dot(gravity, way) - 0.5 * rb_vec3_dot(change, to[k].spin);
		twist = rb_vec3_add(
			twist,
			rb_vec3_add(change,
		                    rb_vec3_cross(way, rb_vec3_scale(mass, to[k].velocity))));
	}
	rb_entries_energy(&e, RB_ENERGY_IMPACTS, lost);
	rb_entries_twist(&e, RB_MOMENTUM_STATIC, twist);
	rb_ledger_enter(&l->world->ledger, &e);
}

/* ---- forces ---- */

/* Rates by external forces on a member. */
static void add_member(const struct rb_external_parts *parts, const struct rb_pose *pose,
                       rb_features features, struct rb_entries *rate)
{
	static const struct {
		enum rb_external_cause of;
		rb_features need;
		enum rb_ledger_momentum momentum;
		int energy; /* -1: it has a potential */
	} cause[] = {
		{RB_EXTERNAL_UNIFORM,
	         RB_FEATURE_GRAVITY | RB_FEATURE_GRAVITY_FORCE | RB_FEATURE_ELEMENTS |
	                 RB_FEATURE_FIELD,
	         RB_MOMENTUM_APPLIED, -1},
		{RB_EXTERNAL_STATED, RB_FEATURE_FORCES | RB_FEATURE_FIELD | RB_FEATURE_ELEMENTS,
	         RB_MOMENTUM_APPLIED, RB_ENERGY_APPLIED},
		{RB_EXTERNAL_CALLBACKS, RB_FEATURE_PUSHES, RB_MOMENTUM_CALLBACKS,
	         RB_ENERGY_CALLBACKS},
		{RB_EXTERNAL_DRAG, RB_FEATURE_DRAG, RB_MOMENTUM_DRAG, RB_ENERGY_DRAG},
	};

	for (size_t k = 0; k < sizeof cause / sizeof cause[0]; k++) {
		const rb_vec3 force = parts->force[cause[k].of],
			      torque = parts->torque[cause[k].of];

		if (!(features & cause[k].need))
			continue;
		rb_entries_momentum(rate, cause[k].momentum, force,
		                    rb_vec3_add(torque, rb_vec3_cross(pose->position, force)));
		if (cause[k].energy < 0)
			continue;
		const double power = rb_vec3_dot(force, pose->velocity) +
		                     rb_vec3_dot(torque, pose->spin);

		rb_entries_energy(rate, (enum rb_ledger_energy)cause[k].energy,
		                  rb_ledger_takes(cause[k].energy) ? -power : power);
	}
}

/* True for a body of this cluster. */
static bool is_member(const struct rb_modes *w, int body)
{
	return body < w->l->n && w->l->cluster_of[body] == (int)(w->c - w->l->cluster);
}

/* Rates at a fixed end of a force element. */
static void add_fixed_end(const struct rb_modes *w, const struct rb_elements *elements, int k,
                          int body, const struct rb_element_query *query, struct rb_entries *rate)
{
	const struct rb_located *l = w->l;
	struct rb_wrench on;

	if (!rb_located_fixed(l, body))
		return;
	const struct rb_pose pose = query->pose(query, body);
	if (!elements->kind->act(query, rb_elements_row(elements, k), body, &pose, &on))
		return;
	rb_entries_momentum(
		rate, cause_of(l, body), rb_vec3_neg(on.force),
		rb_vec3_neg(rb_vec3_add(on.torque, rb_vec3_cross(pose.position, on.force))));
	if (rb_located_driven(l, body))
		rb_entries_energy(rate, RB_ENERGY_DRIVEN,
		                  -(rb_vec3_dot(on.force, pose.velocity) +
		                    rb_vec3_dot(on.torque, pose.spin)));
}

/* Rates of elements between bodies; one end may be fixed. */
static void add_elements(const struct rb_modes *w, const struct rb_elements *elements, double t,
                         struct rb_entries *rate)
{
	const struct rb_force_query view = {.pose = w->pose, .time_s = t, .active_s = w->origin_s};
	const struct rb_element_view at = {w->l, &view};
	const struct rb_element_query query = rb_external_query(&at);

	for (int k = 0; k < elements->count; k++) {
		const int *const end = elements->end[k];

		/* places also exist for other bodies of the set */
		if (!is_member(w, end[0]) && !is_member(w, end[1]))
			continue;
		if (elements->kind->dissipation)
			rb_entries_energy(
				rate, RB_ENERGY_DAMPING,
				elements->kind->dissipation(&query, rb_elements_row(elements, k)));
		for (int e = 0; e < 2; e++)
			add_fixed_end(w, elements, k, end[e], &query, rate);
	}
}

/* Velocity of a moving body, a member or not. */
static rb_vec3 velocity_of(const struct rb_modes *w, int i, double t)
{
	return is_member(w, i) ? w->pose[w->l->place[i]].velocity : rb_arc_velocity(w->l, i, t);
}

/* Rates by a force at a body's centre. */
static void add_attraction(const struct rb_modes *w, int i, enum rb_ledger_momentum cause,
                           rb_vec3 force, struct rb_entries *rate)
{
	rb_entries_impulse(rate, cause, force, rb_gravitation_position(&w->l->gravitation, i));
}

/*
 * Rates of gravitation: by bodies that are not dynamic, and by forces without reaction. Between
 * bodies that attract by their masses, energy and momentum are conserved.
 */
static void add_gravitation(const struct rb_modes *w, double t, struct rb_entries *rate)
{
	const struct rb_located *l = w->l;
	const struct rb_attract *const all = &l->gravitation.all;

	for (int i = 0; i < l->n; i++)
		for (int j = 0; j < all->count && !rb_located_fixed(l, i); j++) {
			double factor;

			if (j == i || (!is_member(w, i) && !is_member(w, j)))
				continue;
			if (!rb_located_fixed(l, j)) {
				const rb_vec3 more = rb_gravitation_surplus(&l->gravitation, i, j);

				add_attraction(w, i, RB_MOMENTUM_APPLIED, more, rate);
				rb_entries_energy(rate, RB_ENERGY_APPLIED,
				                  rb_vec3_dot(more, velocity_of(w, i, t)));
				continue;
			}
			const rb_vec3 d = rb_attract_between(all, i, j, &factor);
			const rb_vec3 on = rb_vec3_scale(factor * all->inertial[i] * all->mu[j], d);

			add_attraction(w, i, cause_of(l, j), on, rate);
			if (rb_located_driven(l, j))
				rb_entries_energy(rate, RB_ENERGY_DRIVEN,
				                  rb_vec3_dot(on, rb_arc_velocity(l, j, t)));
		}
}

/*
 * Rate of change with time of the potentials of fields at the members, W, by differences of fourth
 * order over a share of the piece. Functions that do not depend on time give the same number each
 * time, and so exactly zero.
 */
static void add_potentials(const struct rb_modes *w, double t, struct rb_entries *rate)
{
	static const double share = 1.0 / 64;
	static const double weight[4] = {1, -8, 8, -1}, at[4] = {-2, -1, 1, 2};
	const struct rb_world_hooks *hooks = &w->l->world->hooks;
	const double step = share * (w->c->try_s > 0 ? w->c->try_s : w->l->end_s);

	for (int k = 0; hooks->potential && k < w->c->member_count; k++) {
		const int id = w->l->model->id_of[w->c->member[k]];
		double sum = 0;

		for (int m = 0; m < 4 && w->l->status == RB_OK; m++) {
			double energy = 0;

			w->l->status = hooks->potential(hooks->user, id, t + at[m] * step,
			                                w->pose[k].position, &energy, w->l->err);
			sum += weight[m] * energy;
		}
		rb_entries_energy(rate, RB_ENERGY_APPLIED, sum / (12 * step));
	}
}

void rb_work_rates(const struct rb_modes *w, const struct rb_external_parts *parts, double t,
                   struct rb_entries *rate)
{
	*rate = (struct rb_entries){0};
	for (int k = 0; k < w->c->member_count; k++)
		add_member(&parts[k], &w->pose[k], w->l->model->features, rate);
	add_potentials(w, t, rate);
	for (int k = 0; k < w->l->model->element_list_count; k++)
		if (w->l->model->elements[k].end)
			add_elements(w, &w->l->model->elements[k], t, rate);
	if (rb_located_gravitates(w->l) &&
	    (w->l->model->center_count > 0 || !w->l->model->attracts_by_mass))
		add_gravitation(w, t, rate);
	for (int k = 0; k < w->c->held_count; k++) {
		const struct rb_contact_point *m = &w->contact_point[k];

		rb_entries_energy(rate, RB_ENERGY_SLIDING, -rb_vec3_dot(w->force[k], m->velocity));
		add_sides(w->l, m, w->force[k], rate);
	}
	if (w->articulated)
		rb_joint_tree_enter(w->articulated, rate);
	for (int k = 0; k < w->joints.count && !w->articulated; k++)
		rb_joint_rows_enter(&w->joints, &w->joints.row[k], w->multiplier[k], t, rate);
	rb_joint_rows_enter_springs(&w->joints, w->multiplier, t, rate);
}
