/* SPDX-License-Identifier: MIT */
#include "stepped/driven.h"

/* The turn, as a vector, that leads from one orientation to another the short way. */
static rb_vec3 turn_between(rb_quat from, rb_quat to)
{
	rb_quat d = rb_quat_multiply(to, (rb_quat){from.w, -from.x, -from.y, -from.z});

	if (d.w < 0)
		d = (rb_quat){-d.w, -d.x, -d.y, -d.z};
	const rb_vec3 axis = {d.x, d.y, d.z};
	const double sine = rb_vec3_length(axis);

	/* below that the angle is twice the sine to rounding */
	return rb_vec3_scale(sine > 1e-9 ? 2 * atan2(sine, d.w) / sine : 2, axis);
}

enum rb_status rb_drive_begin(struct rb_world *world, double start, double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_world_hooks *hooks = &world->hooks;
	struct rb_state *state = &world->state;

	for (int k = 0; k < s->driven_count; k++) {
		const int i = s->body[s->member_count + k];
		const size_t row = 3 * (size_t)i;
		struct rb_driven_pose pose = {.position = rb_world_row3(state->position, i),
		                              .orientation = world->model->orientation[i]};
		const enum rb_status status = hooks->motion ? hooks->motion(hooks->user,
		                                                            world->model->id_of[i],
		                                                            start + h, &pose, err)
		                                            : RB_OK;

		if (status != RB_OK)
			return status;
		const rb_vec3 v = rb_vec3_scale(
			1 / h, rb_vec3_sub(pose.position, rb_world_row3(state->position, i)));
		s->ride[k] = (struct rb_ride){.position = pose.position,
		                              .velocity = pose.has_velocity ? pose.velocity : v,
		                              .orientation = pose.orientation};
		rb_vec3_to(state->velocity + row, v);
		rb_vec3_to(world->mark.velocity + row, v);
		if (!state->spin)
			continue;
		const rb_vec3 w = rb_vec3_scale(
			1 / h, turn_between(rb_quat_from(state->orientation + 4 * (size_t)i),
		                            pose.orientation));
		s->ride[k].spin = pose.has_angular_velocity ? pose.angular_velocity : w;
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

		rb_vec3_to(state->position + 3 * i, s->ride[k].position);
		rb_vec3_to(state->velocity + 3 * i, s->ride[k].velocity);
		if (!state->spin)
			continue;
		rb_quat_to(state->orientation + 4 * i, s->ride[k].orientation);
		rb_vec3_to(state->spin + 3 * i, s->ride[k].spin);
	}
}
