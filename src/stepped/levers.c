/* SPDX-License-Identifier: MIT */
#include "stepped/levers.h"

#include "base/error.h"

bool rb_levers_matter(const struct rb_model *model)
{
	return model->joints || (model->features & RB_FEATURE_GRAVITATION) ||
	       (model->static_count == 0 && !model->driven);
}

bool rb_levers_is_ball(const struct rb_world *world, int i)
{
	const struct rb_model *model = world->model;

	if (i >= model->body_count)
		return true;
	if (model->shape[i].kind != RB_SHAPE_SPHERE || (model->driven && model->driven[i]))
		return false;
	if (world->state.spin && isnan(model->inverse_inertia_scalar[i]))
		return false;
	return !model->center_of_mass || rb_vec3_max_abs(model->center_of_mass[i]) == 0;
}

void rb_levers_join(const struct rb_world *world, const int of[2], rb_vec3 between, rb_vec3 normal,
                    rb_vec3 arm[2])
{
	const rb_vec3 gap = rb_vec3_add(between, rb_vec3_sub(arm[1], arm[0]));
	const rb_vec3 across = rb_vec3_reject(gap, normal);
	const rb_vec3 along = rb_vec3_sub(gap, across);
	const bool ball[2] = {rb_levers_is_ball(world, of[0]), rb_levers_is_ball(world, of[1])};
	const double share = ball[0] == ball[1] ? 0.5 : ball[0] ? 0 : 1;

	RB_ASSERT_COSTLY(of[0] < world->model->body_count && of[1] < world->model->body_count);
	arm[0] = rb_vec3_add_scaled(rb_vec3_add_scaled(arm[0], 0.5, along), share, across);
	arm[1] = rb_vec3_add_scaled(rb_vec3_add_scaled(arm[1], -0.5, along), share - 1, across);
}

void rb_levers_join_row(const struct rb_world *world, rb_vec3 between, struct rb_constraint *row)
{
	const int of[2] = {row->a, row->b};
	rb_vec3 arm[2] = {row->arm_a, row->arm_b};

	if (row->central) {
		rb_constraint_join_arms(
			row, rb_vec3_add_scaled(between, row->arm_b.x - row->arm_a.x, row->normal));
		return;
	}
	rb_levers_join(world, of, between, row->normal, arm);
	row->arm_a = arm[0];
	row->arm_b = arm[1];
}

/* Moves an arm along the normal into the plane of the nearest point. */
static rb_vec3 level(rb_vec3 arm, rb_vec3 nearest, rb_vec3 normal)
{
	return rb_vec3_add_scaled(arm, rb_vec3_dot(rb_vec3_sub(nearest, arm), normal), normal);
}

void rb_levers_level(rb_vec3 nearest_a, rb_vec3 nearest_b, struct rb_constraint *row)
{
	row->arm_a = level(row->arm_a, nearest_a, row->normal);
	row->arm_b = level(row->arm_b, nearest_b, row->normal);
}
