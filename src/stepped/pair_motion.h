/* SPDX-License-Identifier: MIT */
/* Motion of a body in a step, and data common to the points of a pair. */
#ifndef RB_STEPPED_PAIR_MOTION_H
#define RB_STEPPED_PAIR_MOTION_H

#include "constraint/contact_row.h"
#include "stepped/pivot.h"

/* Centre of mass of a body, m. */
static inline rb_vec3 rb_pair_motion_center(const struct rb_world *world, int i)
{
	return i < world->model->body_count ? rb_world_row3(world->state.position, i)
	                                    : world->model->position[i];
}

/* Centre of mass after a step at the velocities of a state, m. */
static inline rb_vec3 rb_pair_motion_center_after(const struct rb_world *world,
                                                  const struct rb_state *state, int i, double h_s)
{
	const rb_vec3 center = rb_pair_motion_center(world, i);

	return i < world->model->body_count
	               ? rb_vec3_add_scaled(center, h_s, rb_world_row3(state->velocity, i))
	               : center;
}

/* Rotation in a step at these velocities. */
static inline rb_quat rb_pair_motion_turn(const struct rb_world *world,
                                          const struct rb_state *state, int i, double h_s)
{
	if (i >= world->model->body_count || !state->spin)
		return (rb_quat){1, 0, 0, 0};
	return rb_quat_from_turn(rb_vec3_scale(h_s, rb_world_row3(state->spin, i)));
}

/* Velocity of a body's point, m/s. */
static inline rb_vec3 rb_pair_motion_velocity(const struct rb_world *world,
                                              const struct rb_state *state, int i, rb_vec3 arm)
{
	if (i >= world->model->body_count)
		return (rb_vec3){0, 0, 0};
	const rb_vec3 v = rb_world_row3(state->velocity, i);
	return state->spin ? rb_vec3_add(v, rb_vec3_cross(rb_world_row3(state->spin, i), arm)) : v;
}

/* Data common to the points of a pair and normal. */
struct rb_pair_motion {
	const struct rb_pair_material *material;
	double approach; /* m/s: approach of the centres of mass at the beginning of the step */
	rb_vec3 spin_a, spin_b; /* rad/s */
	double angle;   /* rad: by which friction rotates with bodies that rotate together */
	bool pivots;    /* `pivot` is set: rb_pair_motion_turned */
	rb_pivot pivot; /* of the angle */
};

static inline rb_vec3 rb_pair_motion_spin(const struct rb_world *world, int i)
{
	return i < world->model->body_count && world->mark.spin ? rb_world_row3(world->mark.spin, i)
	                                                        : (rb_vec3){0, 0, 0};
}

static inline struct rb_pair_motion rb_pair_motion_of(const struct rb_world *world, double h_s,
                                                      int a, int b, rb_vec3 normal, bool central)
{
	const rb_vec3 none = {0, 0, 0};
	const rb_vec3 v_a = rb_pair_motion_velocity(world, &world->mark, a, none);
	const rb_vec3 v_b = rb_pair_motion_velocity(world, &world->mark, b, none);

	return (struct rb_pair_motion){.material = rb_contact_material(world->model, a, b),
	                               .approach = rb_vec3_dot(rb_vec3_sub(v_a, v_b), normal),
	                               .spin_a = central ? none : rb_pair_motion_spin(world, a),
	                               .spin_b = central ? none : rb_pair_motion_spin(world, b),
	                               .angle = central ? 0
	                                                : rb_pivot_angle(world, a, b, normal, h_s)};
}

/* Rotates an impulse of the last step with bodies that have rotated since. */
static inline rb_vec3 rb_pair_motion_turned(struct rb_pair_motion *common, rb_vec3 impulse,
                                            rb_vec3 normal)
{
	if (common->angle == 0)
		return impulse;
	if (!common->pivots)
		common->pivot = rb_pivot_of(common->angle);
	common->pivots = true;
	return rb_pivot_turn(impulse, normal, common->pivot);
}

#endif
