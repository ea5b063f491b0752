/* SPDX-License-Identifier: MIT */
#include "stepped/ball_gap.h"

#include "stepped/pair_motion.h"
#include "stepped/step_closing.h"

/* A displacement beyond this share of the radius is followed to find the normal at the touch. */
static const double far_share = 0.1;
/* Iterations for it: where the path only grazes, each halves the distance; twice those of a gap. */
enum { APPROACH_ROUNDS = 32 };

struct rb_gap rb_ball_gap_ahead(const struct rb_world *world, struct rb_pair pair, double h_s)
{
	const struct rb_state *state = &world->state;
	struct rb_gap g = rb_gap_of(world, state, pair.a, pair.b);
	const rb_vec3 d = rb_step_closing_displacement(world, pair, h_s);
	const double size = world->model->shape[pair.a].radius;
	double t = 0, closing;

	if (!(rb_vec3_dot(d, d) > far_share * far_share * size * size) || g.gap <= 0)
		return g;
	/*
	 * the distance is convex along a straight path: Newton's method approaches from one side
	 * without overshoot, until rounding of the path leaves it where it is
	 */
	const rb_vec3 origin = rb_world_origin_at(world, state, pair.a);
	for (int round = 0;; round++) {
		closing = -rb_vec3_dot(g.normal, d);
		const double next = t + (closing > 0 ? g.gap / closing : 1);

		if (round == APPROACH_ROUNDS || next >= 1 || next == t || g.gap <= 1e-12 * size)
			break;
		t = next;
		g = rb_gap_at(world, state, pair.a, rb_vec3_add_scaled(origin, -t, d), pair.b);
	}
	/* of a linear model from the start */
	g.gap += t * closing;
	return g;
}

bool rb_ball_gap_is_beside(const struct rb_world *world, struct rb_pair pair, double h_s, bool held)
{
	const struct rb_model *model = world->model;
	const double tolerance = model->stepped_tolerance_m;

	if (model->shape[pair.b].kind != RB_SHAPE_RECTANGLE)
		return false;
	const struct rb_gap g = rb_gap_of(world, &world->state, pair.a, pair.b);
	const rb_quat turn = pair.b < model->body_count
	                             ? rb_quat_from(world->state.orientation + 4 * (size_t)pair.b)
	                             : model->orientation[pair.b];
	const rb_vec3 origin = rb_world_origin_at(world, &world->state, pair.a);
	const rb_vec3 local = rb_quat_rotate_back(
		turn, rb_vec3_sub(origin, rb_world_origin_at(world, &world->state, pair.b)));
	const double *const size = model->shape[pair.b].size;

	if (fabs(local.x) <= 0.5 * size[0] && fabs(local.y) <= 0.5 * size[1])
		return false;
	const rb_vec3 up = rb_quat_rotate(turn, (rb_vec3){0, 0, local.z < 0 ? -1 : 1});
	const rb_vec3 low = rb_vec3_add_scaled(origin, -model->shape[pair.a].radius, up);
	const double height = fabs(local.z) - model->shape[pair.a].radius;
	const rb_vec3 arm_a = rb_vec3_sub(origin, rb_pair_motion_center(world, pair.a));
	const rb_vec3 arm_b = rb_vec3_sub(low, rb_pair_motion_center(world, pair.b));
	const rb_vec3 before = rb_vec3_sub(
		rb_pair_motion_velocity(world, &world->mark, pair.a, arm_a),
		rb_pair_motion_velocity(world, &world->mark, pair.b, arm_b));
	const rb_vec3 forced = rb_vec3_sub(
		rb_pair_motion_velocity(world, &world->state, pair.a, arm_a),
		rb_pair_motion_velocity(world, &world->state, pair.b, arm_b));
	const bool by_itself = height <= tolerance || held;

	return height >= -tolerance && h_s * rb_vec3_dot(before, g.normal) > g.gap &&
	       height + h_s * rb_vec3_dot(by_itself ? before : forced, up) >= -tolerance;
}
