/* SPDX-License-Identifier: MIT */
/*
 * Types of shapes: one constant row (struct rb_shape_type) and one file in shape/ each.
 *
 * The row's keys make the call of the scene language, the entry of a union's `shapes` and their
 * tables in rbsim-scene(5); its functions are what mass properties, contacts, films and messages
 * ask. All types stand in one table, shape/shape_types, by their number in recordings. Contacts of
 * spheres, planes and rectangles with each other have paths of their own in the methods; every
 * other pair meets as convex cores with a radius (geom/core).
 *
 * A type whose bodies are polyhedra only makes a solid of its corners (`make`); all else then
 * follows from the solid.
 */
#ifndef RB_MODEL_SHAPE_H
#define RB_MODEL_SHAPE_H

#include <rbsim/scene.h>

#include "geom/core.h"
#include "model/scene_keys.h"

/* How a shape, or a part of one, is drawn. */
enum rb_shape_form {
	RB_FORM_SURFACE, /* without a volume: planes and rectangles */
	RB_FORM_BALL,
	RB_FORM_BOX,        /* faces, size[] */
	RB_FORM_CAPSULE,    /* about local z: radius, size[2] */
	RB_FORM_CYLINDER,   /* the same */
	RB_FORM_POLYHEDRON, /* faces of its solid */
	RB_FORM_UNION       /* parts of its solid */
};

/* Which numbers of struct rb_shape a type has; others are never read. */
enum {
	RB_SHAPE_READS_RADIUS = 1,
	RB_SHAPE_READS_SIZE_X = 2,
	RB_SHAPE_READS_SIZE_Y = 4,
	RB_SHAPE_READS_SIZE_Z = 8,
	RB_SHAPE_READS_SIZES = 2 + 4 + 8,
	RB_SHAPE_READS_SOLID = 16
};

enum { RB_SHAPE_FAULT_SIZE = 160, RB_SHAPE_KEYS_MAX = 5 };

struct rb_shape_type {
	const char *name;   /* the call: "sphere" */
	const char *plural; /* "spheres" */
	enum rb_shape_form form;
	unsigned reads;           /* RB_SHAPE_READS_... */
	const struct rb_row *key; /* of the call, into struct rb_body_def; all are required */
	int key_count;            /* <= RB_SHAPE_KEYS_MAX; 0: the call reads them itself */
	const char *texture;      /* where neither body nor material names one; may be NULL */
	bool is_part;             /* may be one of a union's `shapes` */

	/* What is wrong with its numbers, true and the text, or false. NULL: nothing can be. */
	bool (*fault)(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE]);
	/* Makes the solid of a type that is read by its keys. NULL: it has none. */
	enum rb_status (*make)(struct rb_scene *scene, struct rb_shape *shape,
	                       struct rb_error *err);

	/* What the functions of the same names below return. NULL: as of its solid. */
	double (*volume)(const struct rb_shape *shape);
	rb_mat3 (*inertia)(const struct rb_shape *shape, double mass);
	double (*reach)(const struct rb_shape *shape);
	double (*half_width)(const struct rb_shape *shape);
	/* The convex core of one that is no union; its polytope is the caller's. */
	enum rb_status (*core)(const struct rb_shape *shape, rb_core *core, struct rb_error *err);
	/* m: half lengths of the box round it, local axes; of those with a volume. */
	rb_vec3 (*half)(const struct rb_shape *shape);
	/* m: from a point in object coordinates, negative inside; of those with a volume. */
	double (*distance)(const struct rb_shape *shape, rb_vec3 point);
};

/* All types (shape/shape_types), by their kind. */
extern const struct rb_shape_type *const rb_shape_types[RB_SHAPE_KIND_COUNT];

static inline const struct rb_shape_type *rb_shape_type(const struct rb_shape *shape)
{
	return rb_shape_types[shape->kind];
}
static inline bool rb_shape_reads(const struct rb_shape *shape, unsigned what)
{
	return (rb_shape_type(shape)->reads & what) != 0;
}

/* In scene.solids; -1: its type has none. */
static inline int rb_shape_solid(const struct rb_shape *shape)
{
	return rb_shape_reads(shape, RB_SHAPE_READS_SOLID) ? shape->solid : -1;
}

/* `solids` are those of the scene, which shapes refer to (NULL where it has none). */

/*
 * m^3, that weighs: of a union each part times its share; 0 for planes and rectangles, which have
 * none.
 */
double rb_shape_volume(const struct rb_solid *solids, const struct rb_shape *shape);

/* m, object coordinates. */
rb_vec3 rb_shape_centroid(const struct rb_solid *solids, const struct rb_shape *shape);

/* kg m^2 about the centroid, object axes, uniform density; zero for planes and rectangles. */
rb_mat3 rb_shape_inertia(const struct rb_solid *solids, const struct rb_shape *shape, double mass);

/* m: no point is farther from the object's origin; 0 for planes and rectangles. */
double rb_shape_reach(const struct rb_solid *solids, const struct rb_shape *shape);

/*
 * m: radius, half-edge, half of a hull's smallest extent, whichever is least; INFINITY for planes
 * and rectangles.
 */
double rb_shape_half_width(const struct rb_solid *solids, const struct rb_shape *shape);

/* The convex core of one that is no union; its polytope is the caller's. */
RB_CHECKED enum rb_status rb_shape_core(const struct rb_solid *solids, const struct rb_shape *shape,
                                        rb_core *core, struct rb_error *err);

/*
 * Weight, centroid, inertia, reach and half width of a union from its parts; where these overlap,
 * mass counts twice.
 */
void rb_shape_measure_union(struct rb_solid *solid, const struct rb_solid *solids);

/* Its own keys and numbers: "capsule 0.5 2", "hull 8", "plane"; texts are cut to the room. */
void rb_shape_text(const struct rb_solid *solids, const struct rb_shape *shape, char out[160]);

#endif
