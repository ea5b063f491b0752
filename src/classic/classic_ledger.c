/* SPDX-License-Identifier: MIT */
/*
 * Work of an impulse J on a point is J . (v + v') / 2, exactly its share of the change of kinetic
 * energy, whatever other impulses act at the same time. Gravity has a potential, so only its
 * momentum is entered.
 */
#include "classic/classic_ledger.h"

#include "step/force_stages.h"

/* Mean of a body's rows before and after. */
static rb_vec3 mean_row(const double *before, const double *after, int i)
{
	return rb_vec3_scale(0.5, rb_vec3_add(rb_world_row3(before, i), rb_world_row3(after, i)));
}

/* Enters an impulse at the centre of mass and an angular one, of a cause without potential. */
static void enter_force(struct rb_pass *pass, int i, const struct rb_state *before,
                        const struct rb_force_impulse *force)
{
	const struct rb_state *after = &pass->world->state;
	const bool pushed = force->cause == RB_MOMENTUM_CALLBACKS;
	double work = rb_vec3_dot(force->impulse, mean_row(before->velocity, after->velocity, i));

	if (after->spin)
		work += rb_vec3_dot(force->turn, mean_row(before->spin, after->spin, i));
	rb_entries_energy(&pass->entries, pushed ? RB_ENERGY_CALLBACKS : RB_ENERGY_APPLIED, work);
	rb_entries_impulse(&pass->entries, force->cause, force->impulse,
	                   rb_world_row3(before->position, i));
	rb_entries_twist(&pass->entries, force->cause, force->turn);
}

/* All external forces on a body in the substep. */
static void enter_forces(struct rb_pass *pass, int i, const struct rb_state *before)
{
	const struct rb_model *model = pass->world->model;
	const struct rb_world_def *def = &model->scene->world;
	const struct rb_body_def *body = &model->scene->bodies[model->id_of[i]];
	const rb_vec3 weight = rb_vec3_add_scaled(def->gravity_force, model->mass[i], def->gravity);

	rb_entries_impulse(&pass->entries, RB_MOMENTUM_APPLIED, rb_vec3_scale(pass->h_s, weight),
	                   rb_world_row3(before->position, i));
	for (int f = 0; f < body->force_count; f++) {
		const struct rb_force_impulse force = rb_forces_stated(pass, before, i, f);

		enter_force(pass, i, before, &force);
	}
	if (model->features & RB_FEATURE_PUSHES) {
		const struct rb_force_impulse force = rb_forces_pushed(pass, i);

		enter_force(pass, i, before, &force);
	}
}

/* Momentum that a static partner takes, at the point of the other body's arm. */
static void enter_static(struct rb_pass *pass, const struct rb_link *link, rb_vec3 impulse,
                         const struct rb_state *state)
{
	if (link->b < pass->world->model->body_count)
		return;
	rb_entries_impulse(&pass->entries, RB_MOMENTUM_STATIC, rb_vec3_neg(impulse),
	                   rb_vec3_add(rb_world_row3(state->position, link->a), link->arm_a));
}

/* Work and momentum of a lasting contact's reaction. */
static void enter_contact(struct rb_pass *pass, int k, const struct rb_state *before)
{
	const struct rb_touch *touch = &pass->touch[k];
	const struct rb_link link = rb_link_of(pass->world, before, touch, &pass->now[k]);
	const rb_vec3 impulse = rb_vec3_scale(
		pass->h_s,
		rb_vec3_add_scaled(touch->tangent_force, touch->normal_force, link.normal));
	const rb_vec3 mean = rb_vec3_scale(
		0.5, rb_vec3_add(rb_link_velocity(pass->world, before, &link),
	                         rb_link_velocity(pass->world, &pass->world->state, &link)));
	const double normal = rb_vec3_dot(impulse, link.normal) * rb_vec3_dot(mean, link.normal);

	/*
	 * work along the normal: a reaction that stops an approach is an impact without restitution
	 */
	rb_entries_energy(&pass->entries, RB_ENERGY_IMPACTS, -normal);
	rb_entries_energy(&pass->entries, RB_ENERGY_SLIDING, normal - rb_vec3_dot(impulse, mean));
	enter_static(pass, &link, impulse, before);
}

void rb_classic_ledger_substep(struct rb_pass *pass, const struct rb_state *before)
{
	if (!pass->world->ledger.kept)
		return;
	for (int k = 0; k < pass->member_count; k++)
		enter_forces(pass, pass->member[k], before);
	for (int k = 0; k < pass->touch_count; k++)
		if (pass->touch[k].lasting)
			enter_contact(pass, k, before);
}

void rb_classic_ledger_impact(struct rb_pass *pass, const struct rb_link *link, rb_vec3 impulse,
                              rb_vec3 before)
{
	if (!pass->world->ledger.kept)
		return;
	const rb_vec3 after = rb_link_velocity(pass->world, &pass->world->state, link);
	const rb_vec3 mean = rb_vec3_scale(0.5, rb_vec3_add(before, after));
	const double normal = rb_vec3_dot(impulse, link->normal) * rb_vec3_dot(mean, link->normal);

	rb_entries_energy(&pass->entries, RB_ENERGY_IMPACTS, -normal);
	rb_entries_energy(&pass->entries, RB_ENERGY_IMPACT_FRICTION,
	                  normal - rb_vec3_dot(impulse, mean));
	enter_static(pass, link, impulse, &pass->world->state);
}
