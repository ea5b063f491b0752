/* SPDX-License-Identifier: MIT */
#include "embed/handle.h"

#include <stdio.h>

enum rbsim_status rb_handle_pass(struct rbsim_error *to, enum rb_status status,
                                 const struct rb_error *from)
{
	const enum rbsim_status passed = (enum rbsim_status)rb_status_exit_code(status);

	if (!to)
		return passed;
	to->status = passed;
	snprintf(to->text, sizeof to->text, "%s",
	         !status       ? ""
	         : *from->text ? from->text
	                       : rb_status_name(status));
	return passed;
}

enum rbsim_status rb_handle_refuse(struct rbsim_error *to, const char *function, const char *what)
{
	struct rb_error error;
	const enum rb_status status = RB_FAIL(&error, RB_ERR_USAGE, "%s: %s", function, what);

	return rb_handle_pass(to, status, &error);
}

void rb_handle_show(struct rbsim_frame *shown, const struct rb_frame *frame)
{
	const struct rb_frame_numbers *const n = &frame->numbers;

	*shown = (struct rbsim_frame){
		.index = frame->index,
		.time_s = frame->time_s,
		.body_count = frame->body_count,
		.position = frame->position,
		.orientation = frame->orientation,
		.velocity = frame->velocity,
		.angular_velocity = frame->angular_velocity,
		.kinetic_energy = n->kinetic_energy,
		.potential_energy = n->potential_energy,
		.momentum = {n->momentum.x, n->momentum.y, n->momentum.z},
		.angular_momentum = {n->angular_momentum.x, n->angular_momentum.y,
	                             n->angular_momentum.z},
		.max_penetration = n->max_penetration,
		.contact_count = n->contacts,
		.collision_count = n->collisions,
	};
}
