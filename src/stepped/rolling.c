/* SPDX-License-Identifier: MIT */
#include "stepped/rolling.h"

#include "step/flow.h"

/* Height of a point above the lowest of its rim that is allowed, as a share of the tolerance. */
static const double fine_share = 0.125;

/* A part of body i and its contact: outward is towards the other body. */
struct rim {
	const rb_placed *part;
	int i, end;           /* body; end of a cylinder */
	rb_vec3 outward, arm; /* unit; m, from the centre of mass */
	double h_s;
};

/* Support height of the rim about `middle` along `outward`, m. */
static double rim_height(const rb_core *core, rb_vec3 middle, rb_vec3 axis, rb_vec3 outward)
{
	return rb_vec3_dot(outward, middle) +
	       core->round * rb_vec3_length(rb_vec3_cross(axis, outward));
}

/* Largest rotation of a step, rad, for which the initial spin predicts the centre's path. */
static const double turn_max = 1;

double rb_rolling_bend_of_ball(const struct rb_world *world, int i, rb_vec3 middle, rb_vec3 outward,
                               double h)
{
	if (!world->state.spin || i >= world->model->body_count)
		return 0;
	const rb_vec3 spin = rb_vec3_from(world->state.spin + 3 * (size_t)i);
	const rb_vec3 turn = rb_flow_turn(world, i, h, spin);

	if (!(rb_vec3_dot(turn, turn) < turn_max * turn_max))
		return 0;
	const rb_vec3 moved = rb_quat_rotate(rb_quat_from_turn(turn), middle);
	const rb_vec3 deviation = rb_vec3_sub(rb_vec3_sub(moved, middle),
	                                      rb_vec3_scale(h, rb_vec3_cross(spin, middle)));

	return -rb_vec3_dot(outward, deviation);
}

/* The same at the end of a cylinder. */
static double bend_of_rim(const struct rb_world *world, const struct rim *rim)
{
	const rb_placed *const part = rim->part;
	const size_t row = 3 * (size_t)rim->i;
	const rb_vec3 spin = rb_vec3_from(world->state.spin + row);

	if (rb_vec3_max_abs(spin) == 0)
		return 0;
	const rb_vec3 axis = rb_placed_axis(part), outward = rim->outward;
	const rb_vec3 turn = rb_flow_turn(world, rim->i, rim->h_s, spin);
	const rb_vec3 middle = rb_vec3_add_scaled(
		rb_vec3_sub(part->at, rb_vec3_from(world->state.position + row)),
		rim->end == 0 ? part->core->half_height : -part->core->half_height, axis);
	const double before = rim_height(part->core, middle, axis, outward);
	const double fine = fine_share * world->model->stepped_tolerance_m;
	const double tilt = rb_vec3_length(rb_vec3_cross(axis, outward));

	/*
	 * a rim that lies flat has no lowest point; one whose tilt a step changes as much has no
	 * lasting one
	 */
	if (!(before - rb_vec3_dot(outward, rim->arm) <= fine) ||
	    !(2 * rb_vec3_length(rb_vec3_cross(turn, axis)) < tilt))
		return 0;
	const rb_quat q = rb_quat_from_turn(turn);
	const double after = rim_height(part->core, rb_quat_rotate(q, middle),
	                                rb_quat_rotate(q, axis), outward);
	const rb_vec3 straight = rb_vec3_cross(spin, rim->arm);
	return before - after + rim->h_s * rb_vec3_dot(outward, straight);
}

int rb_rolling_end(rb_part feature)
{
	const int index = (int)(feature & 0xffffff);

	switch ((rb_part_kind)(feature >> 24 & 15)) {
	case RB_PART_RIM:
		return index & 1;
	case RB_PART_MANTLE:
		return index - 1;
	default:
		return -1;
	}
}

/* Whether the feature determines the normal, which is then constant. */
static bool is_flat(rb_part feature)
{
	const rb_part_kind kind = (rb_part_kind)(feature >> 24 & 15);

	return kind == RB_PART_FACE || kind == RB_PART_SEVERAL || kind == RB_PART_END ||
	       kind == RB_PART_SURFACE;
}

static bool is_ball(const rb_core *core, rb_part feature)
{
	return core->kind == RB_CORE_POLYTOPE && core->radius > 0 &&
	       (feature >> 24 & 15) == RB_PART_VERTEX;
}

double rb_rolling_bend_of_round(const struct rb_world *world, const struct rb_rolling *rolling)
{
	const rb_part feature[2] = {(rb_part)(rolling->key >> 32), (rb_part)rolling->key};

	for (int e = 0; e < 2 && world->state.spin; e++) {
		const struct rim rim = {
			.part = rolling->part[e],
			.i = rolling->body[e],
			.end = rolling->part[e]->core->kind == RB_CORE_CYLINDER
		                       ? rb_rolling_end(feature[e])
		                       : -1,
			.outward = e == 0 ? rolling->normal : rb_vec3_neg(rolling->normal),
			.arm = rolling->arm[e],
			.h_s = rolling->h_s,
		};

		if (rim.i >= world->model->body_count || !is_flat(feature[!e]))
			continue;
		if (rim.end >= 0)
			return bend_of_rim(world, &rim);
		if (is_ball(rim.part->core, feature[e]))
			return rb_rolling_bend_of_ball(
				world, rim.i,
				rb_vec3_add_scaled(rim.arm, -rim.part->core->radius, rim.outward),
				rim.outward, rim.h_s);
	}
	return 0;
}
