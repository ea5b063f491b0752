/* SPDX-License-Identifier: MIT */
#include "located/extent.h"

#include <math.h>

#include "model/parts.h"

/* Extends e by the point p, from the centre of mass. */
static void extend(struct rb_extent_reach *e, rb_vec3 p, rb_vec3 axis)
{
	e->core = fmax(e->core, rb_vec3_length(p));
	e->along = fmax(e->along, fabs(rb_vec3_dot(p, axis)));
	e->across = fmax(e->across, rb_vec3_length(rb_vec3_reject(p, axis)));
}

static struct rb_extent_reach larger(struct rb_extent_reach a, struct rb_extent_reach b)
{
	return (struct rb_extent_reach){fmax(a.core, b.core), fmax(a.along, b.along),
	                                fmax(a.across, b.across)};
}

/* The extent of a body of which only that distance is known. */
static struct rb_extent extent_of_all(double ball)
{
	const struct rb_extent_reach all = {ball, ball, ball};

	return (struct rb_extent){.ball = ball, .points = all, .centres = all};
}

struct rb_extent rb_extent_of(const struct rb_located *l, int i, rb_vec3 axis)
{
	const struct rb_shape *shape = &l->model->shape[i];
	const struct rb_body_parts *parts = rb_model_parts(l->model, i);
	rb_vec3 centre = {0, 0, 0};
	struct rb_extent e = {0};

	if (shape->kind == RB_SHAPE_PLANE)
		return extent_of_all((double)INFINITY);
	if (i < l->n && l->model->center_of_mass)
		centre = l->model->center_of_mass[i];
	e.ball = rb_vec3_length(centre) + (shape->kind == RB_SHAPE_RECTANGLE
	                                           ? 0.5 * (shape->size[0] + shape->size[1])
	                                           : rb_model_reach(l->model, i));
	/* a terrain does not rotate: the extents of its core are not used */
	if (parts->terrain)
		return extent_of_all(e.ball);
	for (int k = 0; k < parts->count; k++) {
		const struct rb_body_part *part = &parts->part[k];
		const rb_core *core = &part->core;
		const rb_vec3 at = rb_vec3_sub(part->at, centre);

		if (core->kind == RB_CORE_CYLINDER) {
			/*
			 * a ring about its axis: its extent by that of its centre line, plus its
			 * radius
			 */
			const rb_vec3 u = rb_mat3_apply(&part->turn, (rb_vec3){0, 0, 1});
			const rb_vec3 half = rb_vec3_scale(core->half_height, u);
			const double off = rb_vec3_length(rb_vec3_cross(u, axis));
			struct rb_extent_reach ends = {0};

			extend(&ends, rb_vec3_add(at, half), axis);
			extend(&ends, rb_vec3_sub(at, half), axis);
			e.centres = larger(e.centres, ends);
			ends.core += core->round;
			ends.along += off * core->round;
			ends.across += core->round;
			e.points = larger(e.points, ends);
			continue;
		}
		struct rb_extent_reach corners = {0};

		for (int v = 0; v < core->polytope->vertex_count; v++)
			extend(&corners,
			       rb_vec3_add(at,
			                   rb_mat3_apply(&part->turn, core->polytope->vertices[v])),
			       axis);
		e.points = larger(e.points, corners);
		e.centres = larger(e.centres, corners);
	}
	return e;
}

double rb_extent_bend(const struct rb_extent_reach *reach, const struct rb_bounds *max)
{
	const double quick = max->turn * max->turn + max->turning;

	return fmin(max->axis_bend * reach->along + quick * reach->across, quick * reach->core);
}
