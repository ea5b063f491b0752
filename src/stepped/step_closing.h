/* SPDX-License-Identifier: MIT */
/* Bounds of how far two bodies may approach in a step: points with a larger gap are left out. */
#ifndef RB_STEPPED_STEP_CLOSING_H
#define RB_STEPPED_STEP_CLOSING_H

#include "geom/distance.h"
#include "stepped/candidates.h"

/* Relative displacement of b's origin within h_s at the present velocities, m. */
static inline rb_vec3 rb_step_closing_displacement(const struct rb_world *world,
                                                   struct rb_pair pair, double h_s)
{
	const rb_vec3 none = {0, 0, 0};
	const int n = world->model->body_count;
	const rb_vec3 a = pair.a < n ? rb_world_row3(world->state.velocity, pair.a) : none;
	const rb_vec3 b = pair.b < n ? rb_world_row3(world->state.velocity, pair.b) : none;

	return rb_vec3_sub(rb_vec3_scale(h_s, b), rb_vec3_scale(h_s, a));
}

/*
 * Approach by rotation of a driven plane, in proportion to the distance. Rotation about its own
 * normal causes none.
 */
static inline double rb_step_closing_by_plane(const struct rb_world *world,
                                              const struct rb_candidates *candidates,
                                              struct rb_pair pair)
{
	const enum rb_shape_kind kind = world->model->shape[pair.b].kind;
	const size_t at = (size_t)pair.b;

	if (pair.b >= world->model->body_count || !world->state.spin ||
	    (kind != RB_SHAPE_PLANE && kind != RB_SHAPE_RECTANGLE))
		return 0;
	const rb_vec3 normal = rb_plane_normal(rb_quat_from(world->state.orientation + 4 * at));
	const rb_vec3 now = rb_world_row3(world->state.spin, pair.b);
	const rb_vec3 before = rb_world_row3(world->mark.spin, pair.b);
	const double tilt = fmax(rb_vec3_length(rb_vec3_cross(now, normal)),
	                         rb_vec3_length(rb_vec3_cross(before, normal)));
	const rb_vec3 between = rb_vec3_sub(rb_world_origin_at(world, &world->state, pair.a),
	                                    rb_world_origin_at(world, &world->state, pair.b));

	return fmin(2, candidates->h_s * tilt) * rb_vec3_length(between);
}

/* Bound for two balls: the sum of both displacements, m. */
static inline double rb_step_closing_of_balls(const struct rb_world *world,
                                              const struct rb_candidates *candidates,
                                              struct rb_pair pair)
{
	const struct rb_model *model = world->model;
	const double *reach = candidates->reach;
	const double closing = reach[pair.a] + (pair.b < model->body_count ? reach[pair.b] : 0) +
	                       model->stepped_tolerance_m;

	return model->driven ? closing + rb_step_closing_by_plane(world, candidates, pair)
	                     : closing;
}

/*
 * The same for bodies that rotate. One may be stopped while the other moves on, but bodies that
 * move together do not approach by both displacements.
 */
static inline double rb_step_closing_of(const struct rb_world *world,
                                        const struct rb_candidates *candidates, struct rb_pair pair,
                                        double h_s)
{
	const struct rb_model *model = world->model;
	const double a = candidates->reach[pair.a];
	double b = 0, turning = candidates->ahead[pair.a] - a;

	if (pair.b < model->body_count) {
		b = candidates->reach[pair.b];
		turning += candidates->ahead[pair.b] - b;
	}
	const double between = rb_vec3_length(rb_step_closing_displacement(world, pair, h_s));
	const double least = a > b ? a : b, relative = between > least ? between : least;
	const double closing = (relative < a + b ? relative : a + b) + turning +
	                       model->stepped_tolerance_m;
	return model->driven ? closing + rb_step_closing_by_plane(world, candidates, pair)
	                     : closing;
}

/* Cheap upper bound of that, m, not for driven bodies. */
static inline double rb_step_closing_bound(const struct rb_world *world,
                                           const struct rb_candidates *candidates,
                                           struct rb_pair pair)
{
	return candidates->ahead[pair.a] + candidates->ahead[pair.b] +
	       world->model->stepped_tolerance_m;
}

#endif
