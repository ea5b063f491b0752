/* SPDX-License-Identifier: MIT */
/*
 * Velocity updates of semi-implicit Euler, one stage for each kind of external force. A stated
 * force acts for the exact part of the substep that lies within its duration, so its impulse does
 * not depend on the steps.
 */
#include "step/force_stages.h"

#include "base/error.h"

static void gravity(struct rb_pass *pass)
{
	const rb_vec3 dv = rb_vec3_scale(pass->h_s, pass->world->model->scene->world.gravity);
	double *const velocity = pass->world->state.velocity;

	for (int k = 0; k < pass->member_count; k++) {
		double *const v = velocity + 3 * (size_t)pass->member[k];

		v[0] += dv.x;
		v[1] += dv.y;
		v[2] += dv.z;
	}
}

static void gravity_force(struct rb_pass *pass)
{
	const struct rb_model *model = pass->world->model;
	const rb_vec3 dp = rb_vec3_scale(pass->h_s, model->scene->world.gravity_force);
	double *const velocity = pass->world->state.velocity;

	for (int k = 0; k < pass->member_count; k++) {
		const int i = pass->member[k];
		double *const v = velocity + 3 * (size_t)i;

		v[0] += model->inverse_mass[i] * dp.x;
		v[1] += model->inverse_mass[i] * dp.y;
		v[2] += model->inverse_mass[i] * dp.z;
	}
}

/* Applies an impulse, N s, and an angular impulse about the centre of mass, N m s. */
static void push(struct rb_world *world, int i, rb_vec3 impulse, rb_vec3 angular_impulse)
{
	RB_ASSERT_COSTLY(i >= 0 && i < world->model->body_count);

	struct rb_state *state = &world->state;
	const rb_vec3 v = rb_world_row3(state->velocity, i);

	rb_vec3_to(state->velocity + 3 * (size_t)i,
	           rb_vec3_add_scaled(v, world->model->inverse_mass[i], impulse));
	if (!state->spin)
		return;
	const rb_vec3 w = rb_world_row3(state->spin, i);
	rb_vec3_to(state->spin + 3 * (size_t)i,
	           rb_vec3_add(w, rb_world_turn(world, state, i, angular_impulse)));
}

/* Time within [from, from + h] in which the force acts, s. */
static double acting_s(const struct rb_force_def *force, double from, double h)
{
	const double begin = fmax(from, force->start_s);
	const double end = fmin(from + h, force->start_s + force->duration_s);

	/* h itself if it acts throughout: end - begin would be rounded */
	return begin <= from && end >= from + h ? h : fmax(0, end - begin);
}

struct rb_force_impulse rb_forces_stated(const struct rb_pass *pass, const struct rb_state *state,
                                         int index, int f)
{
	const struct rb_world *world = pass->world;
	const struct rb_scene *scene = world->model->scene;
	const struct rb_body_def *body = &scene->bodies[world->model->id_of[index]];
	RB_ASSERT_COSTLY(f >= 0 && f < body->force_count);
	const struct rb_force_def *force = &scene->forces[body->force_first + f];
	const double span = acting_s(force, pass->start_s + pass->done_s, pass->h_s);
	struct rb_force_impulse out = {.cause = RB_MOMENTUM_APPLIED};
	rb_vec3 arm = {0, 0, 0};

	if (!(span > 0))
		return out;
	const rb_quat q = rb_world_orientation_at(world, state, index);
	const rb_vec3 newton = force->frame == RB_FORCE_BODY ? rb_quat_rotate(q, force->vector)
	                                                     : force->vector;
	if (!isnan(force->point.x)) {
		arm = force->point;
		if (world->model->center_of_mass)
			arm = rb_vec3_sub(arm, world->model->center_of_mass[index]);
		arm = rb_quat_rotate(q, arm);
	}
	out.impulse = rb_vec3_scale(span, newton);
	out.turn = rb_vec3_add_scaled(
		rb_vec3_cross(arm, out.impulse), span,
		force->frame == RB_FORCE_BODY ? rb_quat_rotate(q, force->torque) : force->torque);
	return out;
}

/* Each body's list of forces. */
static void applied(struct rb_pass *pass)
{
	struct rb_world *world = pass->world;
	const struct rb_scene *scene = world->model->scene;

	for (int k = 0; k < pass->member_count; k++) {
		const int i = pass->member[k];

		for (int f = 0; f < scene->bodies[world->model->id_of[i]].force_count; f++) {
			const struct rb_force_impulse force = rb_forces_stated(pass, &world->state,
			                                                       i, f);

			push(world, i, force.impulse, force.turn);
		}
	}
}

struct rb_force_impulse rb_forces_pushed(const struct rb_pass *pass, int index)
{
	const struct rb_state *state = &pass->world->state;

	return (struct rb_force_impulse){
		.impulse = rb_vec3_scale(pass->h_s, rb_world_row3(state->push, index)),
		.turn = rb_vec3_scale(pass->h_s, rb_world_row3(state->twist, index)),
		.cause = RB_MOMENTUM_CALLBACKS};
}

static void pushes(struct rb_pass *pass)
{
	for (int k = 0; k < pass->member_count; k++) {
		const struct rb_force_impulse force = rb_forces_pushed(pass, pass->member[k]);

		push(pass->world, pass->member[k], force.impulse, force.turn);
	}
}

double rb_forces_bound(const struct rb_world *world, int index)
{
	const struct rb_model *model = world->model;
	const struct rb_scene *scene = model->scene;
	const struct rb_body_def *body = &scene->bodies[model->id_of[index]];
	double newton = rb_vec3_length(scene->world.gravity_force);

	for (int f = 0; f < body->force_count; f++)
		newton += rb_vec3_length(scene->forces[body->force_first + f].vector);
	if (world->state.push)
		newton += rb_vec3_length(rb_world_row3(world->state.push, index));
	return rb_vec3_length(scene->world.gravity) + newton * model->inverse_mass[index];
}

const struct rb_stage rb_stage_gravity = {"gravity", "the acceleration of the world",
                                          RB_FEATURE_GRAVITY, gravity};
const struct rb_stage rb_stage_gravity_force = {"gravity_force", "the same force on every body",
                                                RB_FEATURE_GRAVITY_FORCE, gravity_force};
const struct rb_stage rb_stage_applied = {"forces", "each body's list of forces", RB_FEATURE_FORCES,
                                          applied};
const struct rb_stage rb_stage_pushes = {"pushes", "forces applied by callbacks", RB_FEATURE_PUSHES,
                                         pushes};
