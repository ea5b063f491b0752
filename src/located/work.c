/* SPDX-License-Identifier: MIT */
#include "located/work.h"

/* Whom the ledger names for a body that contacts do not move. */
static enum rb_ledger_momentum cause_of(const struct rb_located *l, int body)
{
	return rb_located_driven(l, body) ? RB_MOMENTUM_DRIVEN : RB_MOMENTUM_STATIC;
}

/* A fixed body acts on what moves, by an impulse or a force, where it has that velocity. */
static void add_fixed(const struct rb_located *l, int body, rb_vec3 impulse, rb_vec3 point,
                      rb_vec3 velocity, struct rb_entries *e)
{
	if (!rb_located_fixed(l, body))
		return;
	rb_entries_impulse(e, cause_of(l, body), impulse, point);
	if (rb_located_driven(l, body))
		rb_entries_energy(e, RB_ENERGY_DRIVEN, rb_vec3_dot(impulse, velocity));
}

static rb_vec3 velocity_at(const struct rb_pose *pose, rb_vec3 arm)
{
	return rb_vec3_add(pose->velocity, rb_vec3_cross(pose->spin, arm));
}

/* Both sides of a contact whose force or impulse on b is that. */
static void add_sides(const struct rb_located *l, const struct rb_contact_point *m, rb_vec3 on_b,
                      struct rb_entries *e)
{
	/* at the point of the body that moves: across a gap the other one is elsewhere */
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

	if (!l->account_s)
		return;
	const double all = rb_vec3_dot(impulse, mean);
	const double along = rb_vec3_dot(impulse, m->normal) * rb_vec3_dot(mean, m->normal);

	rb_entries_energy(&e, RB_ENERGY_IMPACTS, -along);
	rb_entries_energy(&e, RB_ENERGY_IMPACT_FRICTION, along - all);
	add_sides(l, m, impulse, &e);
	rb_ledger_enter(&l->world->ledger, &e);
}

/* ---- forces ---- */

static void add_member(const struct rb_external_parts *parts, const struct rb_pose *pose,
                       rb_features features, struct rb_entries *rate)
{
	static const struct {
		enum rb_external_cause of;
		rb_features need;
		enum rb_ledger_momentum momentum;
		int energy; /* -1: it has a potential */
	} cause[] = {
		{RB_EXTERNAL_UNIFORM, RB_FEATURE_GRAVITY | RB_FEATURE_GRAVITY_FORCE,
	         RB_MOMENTUM_APPLIED, -1},
		{RB_EXTERNAL_STATED, RB_FEATURE_FORCES | RB_FEATURE_FIELD, RB_MOMENTUM_APPLIED,
	         RB_ENERGY_APPLIED},
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

static bool is_member(const struct rb_modes *w, int body)
{
	return body < w->l->n && w->l->cluster_of[body] == (int)(w->c - w->l->cluster);
}

static void add_springs(const struct rb_modes *w, double t, struct rb_entries *rate)
{
	const struct rb_located *l = w->l;
	const struct rb_scene *scene = l->model->scene;
	const struct rb_force_query view = {.pose = w->pose, .time_s = t, .active_s = w->origin_s};

	for (int k = 0; k < scene->spring_count; k++) {
		const int a = l->model->index_of[scene->springs[k].a];
		const int b = l->model->index_of[scene->springs[k].b];
		struct rb_spring_force spring;

		/*
		 * one end may be fixed; places are also those of what is settled with this cluster
		 */
		if ((!is_member(w, a) && !is_member(w, b)) ||
		    !rb_spring_force_at(l, k, &view, &spring))
			continue;
		rb_entries_energy(rate, RB_ENERGY_DAMPING, spring.damping);
		/* what is fixed pulls at the spring's end */
		add_fixed(l, a, rb_vec3_neg(spring.force), spring.end_a, spring.speed_a, rate);
		add_fixed(l, b, spring.force, spring.end_b, spring.speed_b, rate);
	}
}

void rb_work_rates(const struct rb_modes *w, const struct rb_external_parts *parts, double t,
                   struct rb_entries *rate)
{
	*rate = (struct rb_entries){0};
	for (int k = 0; k < w->c->member_count; k++)
		add_member(&parts[k], &w->pose[k], w->l->model->features, rate);
	if (w->l->model->features & RB_FEATURE_SPRINGS)
		add_springs(w, t, rate);
	for (int k = 0; k < w->c->held_count; k++) {
		const struct rb_contact_point *m = &w->contact_point[k];

		rb_entries_energy(rate, RB_ENERGY_SLIDING, -rb_vec3_dot(w->force[k], m->velocity));
		add_sides(w->l, m, w->force[k], rate);
	}
}
