/* SPDX-License-Identifier: MIT */
#include "located/extent.h"

#include <math.h>

#include "model/parts.h"

/* Extends e by the point p, from the centre of mass. */
static void extend(struct rb_extent *e, rb_vec3 p, rb_vec3 axis)
{
	e->core = fmax(e->core, rb_vec3_length(p));
	e->along = fmax(e->along, fabs(rb_vec3_dot(p, axis)));
	e->across = fmax(e->across, rb_vec3_length(rb_vec3_reject(p, axis)));
}

struct rb_extent rb_extent_of(const struct rb_located *l, int i, rb_vec3 axis)
{
	const struct rb_shape *shape = &l->model->shape[i];
	const struct rb_body_parts *parts = rb_model_parts(l->model, i);
	rb_vec3 centre = {0, 0, 0};
	struct rb_extent e = {0};

	if (shape->kind == RB_SHAPE_PLANE)
		return (struct rb_extent){(double)INFINITY, (double)INFINITY, (double)INFINITY,
		                          (double)INFINITY};
	if (i < l->n && l->model->center_of_mass)
		centre = l->model->center_of_mass[i];
	e.ball = rb_vec3_length(centre) + (shape->kind == RB_SHAPE_RECTANGLE
	                                           ? 0.5 * (shape->size[0] + shape->size[1])
	                                           : rb_model_reach(l->model, i));
	/* a terrain does not rotate: the extents of its core are not used */
	if (parts->terrain)
		return (struct rb_extent){e.ball, e.ball, e.ball, e.ball};
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
			struct rb_extent ends = {0};

			extend(&ends, rb_vec3_add(at, half), axis);
			extend(&ends, rb_vec3_sub(at, half), axis);
			e.core = fmax(e.core, ends.core + core->round);
			e.along = fmax(e.along, ends.along + off * core->round);
			e.across = fmax(e.across, ends.across + core->round);
			continue;
		}
		for (int v = 0; v < core->polytope->vertex_count; v++)
			extend(&e,
			       rb_vec3_add(at,
			                   rb_mat3_apply(&part->turn, core->polytope->vertices[v])),
			       axis);
	}
	return e;
}
