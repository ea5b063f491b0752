/* SPDX-License-Identifier: MIT */
/*
 * Support functions. Every direction is taken into the body's axes first, so that each costs one
 * transposed product, whatever the number of vertices, and boxes and cylinders have closed forms.
 */
#include "geom/core.h"

#include <float.h>

#include "base/error.h"

/* Share of a body's size within which a point is at one of its corners. */
static const double at_corner = 1e-9;

rb_core rb_core_of_polytope(const struct rb_polytope *polytope, double radius)
{
	RB_ASSERT(polytope->vertex_count > 0 && radius >= 0);

	return (rb_core){.kind = RB_CORE_POLYTOPE,
	                 .radius = radius,
	                 .reach = polytope->reach,
	                 .polytope = polytope};
}

rb_core rb_core_of_cylinder(double radius, double half_height)
{
	RB_ASSERT(radius >= 0 && half_height >= 0);

	return (rb_core){.kind = RB_CORE_CYLINDER,
	                 .reach = rb_vec3_length((rb_vec3){radius, half_height, 0}),
	                 .round = radius,
	                 .half_height = half_height};
}

rb_core rb_core_of_half_space(void)
{
	return (rb_core){.kind = RB_CORE_HALF_SPACE};
}

int rb_core_face_count(const rb_core *core)
{
	switch (core->kind) {
	case RB_CORE_CYLINDER:
		return 2;
	case RB_CORE_POLYTOPE:
		return core->polytope->face_count;
	default:
		return 0;
	}
}

rb_vec3 rb_placed_face_normal(const rb_placed *p, int face)
{
	const rb_vec3 local = p->core->kind == RB_CORE_CYLINDER
	                              ? (rb_vec3){0, 0, face ? -1 : 1}
	                              : p->core->polytope->faces[face].normal;

	RB_ASSERT_COSTLY(face >= 0 && face < rb_core_face_count(p->core));
	return rb_mat3_apply(&p->turn, local);
}

int rb_placed_corner_at(const rb_placed *p, rb_vec3 point, rb_vec3 direction)
{
	const struct rb_polytope *const polytope = p->core->polytope;
	/* far from the origin places round by more */
	const double within = fmax(at_corner * (polytope->reach + p->core->radius),
	                           16 * DBL_EPSILON * rb_vec3_length(point));

	RB_ASSERT_COSTLY(p->core->kind == RB_CORE_POLYTOPE);
	for (int v = 0; v < polytope->vertex_count; v++) {
		const rb_vec3 away = rb_vec3_sub(rb_placed_point(p, polytope->vertices[v]), point);

		if (rb_vec3_length(rb_vec3_reject(away, direction)) <= within)
			return v;
	}
	return -1;
}

double rb_placed_height(const rb_placed *p, rb_vec3 direction)
{
	const rb_core *core = p->core;
	const rb_vec3 n = rb_mat3_apply_transposed(&p->turn, direction);

	if (core->kind == RB_CORE_HALF_SPACE)
		return n.x == 0 && n.y == 0 && n.z >= 0 ? 0 : (double)INFINITY;
	if (core->kind == RB_CORE_CYLINDER)
		return core->round * sqrt(n.x * n.x + n.y * n.y) + core->half_height * fabs(n.z);
	if (core->polytope->box) {
		const rb_vec3 h = core->polytope->half;
		return h.x * fabs(n.x) + h.y * fabs(n.y) + h.z * fabs(n.z);
	}
	return rb_vec3_dot(n, core->polytope->vertices[rb_polytope_support(core->polytope, n)]);
}

rb_vec3 rb_placed_support(const rb_placed *p, rb_vec3 direction)
{
	const rb_core *core = p->core;
	const rb_vec3 n = rb_mat3_apply_transposed(&p->turn, direction);

	if (core->kind == RB_CORE_POLYTOPE)
		return rb_placed_point(
			p, core->polytope->vertices[rb_polytope_support(core->polytope, n)]);
	RB_ASSERT_COSTLY(core->kind == RB_CORE_CYLINDER);
	const double across = sqrt(n.x * n.x + n.y * n.y);
	/* along the axis every point of the end is outermost: its centre, which is symmetric */
	const double s = across > 0 ? core->round / across : 0;
	return rb_placed_point(p, (rb_vec3){s * n.x, s * n.y, copysign(core->half_height, n.z)});
}
