/* SPDX-License-Identifier: MIT */
/*
 * Driven (kinematic) bodies: their motion is a function in the scene. For the step each moves with
 * the constant velocity (x(t + h) - x(t)) / h and the constant spin that leads from one orientation
 * to the other, so that contacts use its exact displacement. At the end it gets the velocity that
 * the function states, or that of the parabola through the pose in between: the mean of the step
 * would be half a step late, and so would be the action of joints at its end.
 *
 * Orientations do not determine whole turns; these follow from the stated angular velocity.
 */
#include "stepped/driven_bodies.h"

#include "step/motion.h"

static const double full_turn = 6.28318530717958647692;
/*
 * Relative difference up to which stated velocities and finite differences of poses agree:
 * constants in scenes are often written with seven digits, and a difference of 1e-6 of the
 * displacement is far below the tolerance of a step.
 */
static const double agreement = 1e-6;

/*
 * Rotation vector (rad, world axes) from one orientation to another, with the number of whole turns
 * for which its component along `expected` is closest to that of `expected`.
 */
static rb_vec3 turn_between(rb_quat from, rb_quat to, rb_vec3 expected)
{
	rb_quat d = rb_quat_multiply(to, (rb_quat){from.w, -from.x, -from.y, -from.z});

	if (d.w < 0)
		d = (rb_quat){-d.w, -d.x, -d.y, -d.z};
	const rb_vec3 axis = {d.x, d.y, d.z};
	const double sine = rb_vec3_length(axis), angle = 2 * atan2(sine, d.w);

	/* below that the angle is twice the sine to rounding */
	if (!(sine > 1e-9))
		return rb_vec3_scale(2, axis);
	const double along = rb_vec3_dot(expected, axis) / sine;
	const double whole = nearbyint((along - angle) / full_turn);

	return rb_vec3_scale((angle + full_turn * whole) / sine, axis);
}

/*
 * Evaluates the scene's function at the end of the step and in its middle, with the checks of
 * step/motion in between.
 */
static enum rb_status ask(const struct rb_world *world, int i, double start, double h,
                          struct rb_driven_pose pose[2], struct rb_error *err)
{
	const struct rb_state *state = &world->state;
	const struct rb_model *model = world->model;
	const struct rb_body_def *def = &model->scene->bodies[model->id_of[i]];
	struct rb_motion motion = {.world = world,
	                           .i = i,
	                           .from_s = start,
	                           .to_s = start + h,
	                           .begin = {.position = rb_world_row3(state->position, i),
	                                     .orientation = model->orientation[i],
	                                     .has_velocity = def->motion_gives_velocity,
	                                     .velocity = rb_world_row3(state->velocity, i)},
	                           .coarse = model->stepped_tolerance_m / model->size_min_m,
	                           .agreement = agreement,
	                           .middle = &pose[1]};

	if (state->spin) {
		motion.begin.orientation = rb_quat_from(state->orientation + 4 * (size_t)i);
		motion.begin.has_angular_velocity = def->motion_gives_angular_velocity;
		motion.begin.angular_velocity = rb_world_row3(state->spin, i);
	}
	enum rb_status status = rb_motion_ask(world, i, motion.to_s, motion.begin.orientation,
	                                      &motion.end, err);
	if (status == RB_OK)
		status = rb_motion_watch(&motion, err);
	pose[0] = motion.end;
	return status;
}

/* Extrapolates to the end of two equal time spans from their means. */
static rb_vec3 at_end(rb_vec3 first, rb_vec3 second)
{
	return rb_vec3_add_scaled(second, 0.5, rb_vec3_sub(second, first));
}

/* Velocities at the end of the step of h that the function does not state. */
static void find_end(const struct rb_world *world, int i, double h,
                     const struct rb_driven_pose *middle, const struct rb_driven_pose *end,
                     struct rb_driven_end *driven_end)
{
	const struct rb_state *state = &world->state;
	const rb_vec3 from = rb_world_row3(state->position, i), none = {0, 0, 0};
	const double each = 2 / h;

	if (!end->has_velocity)
		driven_end->velocity = at_end(
			rb_vec3_scale(each, rb_vec3_sub(middle->position, from)),
			rb_vec3_scale(each, rb_vec3_sub(end->position, middle->position)));
	if (!state->spin || end->has_angular_velocity)
		return;
	const rb_quat turned = rb_quat_from(state->orientation + 4 * (size_t)i);

	driven_end->spin = at_end(
		rb_vec3_scale(each, turn_between(turned, middle->orientation, none)),
		rb_vec3_scale(each, turn_between(middle->orientation, end->orientation, none)));
}

enum rb_status rb_drive_begin(struct rb_world *world, double start, double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_state *state = &world->state;

	for (int k = 0; k < s->driven_count; k++) {
		const int i = s->body[s->member_count + k];
		const size_t row = 3 * (size_t)i;
		struct rb_driven_pose at[2] = {{.has_velocity = false}};
		const enum rb_status status = ask(world, i, start, h, at, err);
		const struct rb_driven_pose pose = at[0];

		if (status != RB_OK)
			return status;
		const rb_vec3 v = rb_vec3_scale(
			1 / h, rb_vec3_sub(pose.position, rb_world_row3(state->position, i)));
		s->driven_end[k] = (struct rb_driven_end){.position = pose.position,
		                                          .velocity = pose.velocity,
		                                          .orientation = pose.orientation,
		                                          .spin = pose.angular_velocity};
		find_end(world, i, h, &at[1], &pose, &s->driven_end[k]);
		const rb_vec3 expected = rb_vec3_scale(pose.has_angular_velocity ? h : 0,
		                                       pose.angular_velocity);
		rb_vec3_to(state->velocity + row, v);
		rb_vec3_to(world->mark.velocity + row, v);
		if (!state->spin)
			continue;
		const rb_vec3 w = rb_vec3_scale(
			1 / h, turn_between(rb_quat_from(state->orientation + 4 * (size_t)i),
		                            pose.orientation, expected));
		rb_vec3_to(state->spin + row, w);
		rb_vec3_to(world->mark.spin + row, w);
	}
	return RB_OK;
}

void rb_drive_end(struct rb_world *world)
{
	const struct rb_stepped *s = world->stepped;
	struct rb_state *state = &world->state;

	for (int k = 0; k < s->driven_count; k++) {
		const size_t i = (size_t)s->body[s->member_count + k];

		rb_vec3_to(state->position + 3 * i, s->driven_end[k].position);
		rb_vec3_to(state->velocity + 3 * i, s->driven_end[k].velocity);
		if (!state->spin)
			continue;
		rb_quat_to(state->orientation + 4 * i, s->driven_end[k].orientation);
		rb_vec3_to(state->spin + 3 * i, s->driven_end[k].spin);
	}
}
