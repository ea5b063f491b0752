/* SPDX-License-Identifier: MIT */
/*
 * A convex core with a radius: all points no farther than `radius` from the core. Cores are
 * polytopes (solid, flat, segment, point), cylinders, which are round and no polygons, and half
 * spaces.
 *
 * Values; the polytope a core refers to belongs to whoever made it. Pure functions.
 */
#ifndef RB_GEOM_CORE_H
#define RB_GEOM_CORE_H

#include "geom/polytope.h"
#include "math/mat3.h"

typedef enum {
	RB_CORE_POLYTOPE,
	RB_CORE_CYLINDER,  /* about z, centred */
	RB_CORE_HALF_SPACE /* all z <= 0 */
} rb_core_kind;

typedef struct {
	rb_core_kind kind;
	double radius;             /* m: of the ball that goes round the core */
	double reach;              /* m: of the core, from the origin; a half space has none */
	double round, half_height; /* m: a cylinder's */
	const struct rb_polytope *polytope; /* a polytope's */
} rb_core;

/* A core where its body is. */
typedef struct {
	const rb_core *core;
	rb_vec3 at;   /* m: the body's origin */
	rb_mat3 turn; /* from the body's axes to those of the world */
} rb_placed;

rb_core rb_core_of_polytope(const struct rb_polytope *polytope, double radius);
rb_core rb_core_of_cylinder(double radius, double half_height);
rb_core rb_core_of_half_space(void);

static inline rb_vec3 rb_placed_point(const rb_placed *p, rb_vec3 local)
{
	return rb_vec3_add(p->at, rb_mat3_apply(&p->turn, local));
}

/* The body's z in the world. */
static inline rb_vec3 rb_placed_axis(const rb_placed *p)
{
	return (rb_vec3){p->turn.m[0][2], p->turn.m[1][2], p->turn.m[2][2]};
}

/* A point of the core. */
static inline rb_vec3 rb_placed_middle(const rb_placed *p)
{
	return p->core->kind == RB_CORE_POLYTOPE ? rb_placed_point(p, p->core->polytope->middle)
	                                         : p->at;
}

/* In the axes of the body: a point of the world. */
static inline rb_vec3 rb_placed_local(const rb_placed *p, rb_vec3 point)
{
	return rb_mat3_apply_transposed(&p->turn, rb_vec3_sub(point, p->at));
}

/*
 * m: how far a point, in the axes of the body, is over the plane of a face or end: whatever has
 * that point is no farther from there.
 */
static inline double rb_core_over_face(const rb_core *core, int face, rb_vec3 local)
{
	if (core->kind == RB_CORE_CYLINDER)
		return (face ? -local.z : local.z) - core->half_height;
	const rb_polytope_face *const f = &core->polytope->faces[face];
	return rb_vec3_dot(
		f->normal,
		rb_vec3_sub(local, core->polytope->vertices[core->polytope->loop[f->first]]));
}

/*
 * How far the core, without its radius, reaches from its own origin along a unit vector of the
 * world, m; INFINITY for a half space unless it is its normal.
 */
double rb_placed_height(const rb_placed *p, rb_vec3 direction);

/* Faces of a polytope, ends of a cylinder; their outward normals, unit, in the world. */
int rb_core_face_count(const rb_core *core);
rb_vec3 rb_placed_face_normal(const rb_placed *p, int face);

/*
 * The corner of a polytope, or end of a segment, that a point is over along a unit vector, to 1e-9
 * of the body's size or the rounding of its place: no other place of its own is as near. -1: none.
 */
int rb_placed_corner_at(const rb_placed *p, rb_vec3 point, rb_vec3 direction);

/* A point of the core that is farthest along `direction`. Not for half spaces. */
rb_vec3 rb_placed_support(const rb_placed *p, rb_vec3 direction);

#endif
