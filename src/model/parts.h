/* SPDX-License-Identifier: MIT */
/*
 * The convex parts of every body of a scene, as geometry wants them: a core with a radius and where
 * it is in the body's own axes. A sphere is a point with a radius, a capsule a segment, a finite
 * plane a flat polytope, an infinite one a half space; all but unions have one part.
 *
 * Made once from a scene whose shapes have been checked, then constant and read by any thread;
 * equal shapes share what they are made of. Owner: the model (or whoever made it), with all
 * polytopes.
 */
#ifndef RB_MODEL_PARTS_H
#define RB_MODEL_PARTS_H

#include <rbsim/model.h>

#include "geom/convex.h"
#include "geom/triangles.h"
#include "math/quat.h"

struct rb_body_part {
	enum rb_shape_kind kind; /* of the part: never a union */
	rb_core core;
	rb_vec3 at;     /* m, object coordinates */
	rb_mat3 turn;   /* from the part's axes to those of the object */
	bool is_placed; /* `at` and `turn` are not those of the object itself */
};

/* What bodies of one shape have. */
struct rb_body_parts {
	const struct rb_body_part *part; /* [count] */
	int count;
	const struct rb_terrain *terrain; /* of one: its facets are the parts, in this order */
};

struct rb_parts_table {
	struct rb_body_parts *shape; /* [shape_count] */
	int *shape_of;               /* [bodies of the scene], by id */
	struct rb_body_part *parts;  /* all of them */
	struct rb_terrain **terrain; /* [shape_count], owned; NULL where a shape is none */
	int shape_count, part_count;
};

/* *table is NULL where a scene has nothing but spheres and planes, which do without. */
enum rb_status rb_parts_table_create(struct rb_parts_table **table, const struct rb_scene *scene,
                                     struct rb_error *err);
void rb_parts_table_destroy(struct rb_parts_table *table); /* NULL is fine */

static inline const struct rb_body_parts *rb_parts_of(const struct rb_parts_table *table, int id)
{
	return &table->shape[table->shape_of[id]];
}

/* Not where model->parts is NULL. */
static inline const struct rb_body_parts *rb_model_parts(const struct rb_model *model, int index)
{
	return rb_parts_of(model->parts, model->id_of[index]);
}

/*
 * Parts of a body that may touch what lies in a ball: those of a terrain that come near it, all of
 * others. `within`, m, may be reduced on the way.
 */
struct rb_near_parts {
	int count, next;             /* of no terrain */
	bool far;                    /* of a terrain: `walk` */
	struct rb_terrain_walk walk; /* not set otherwise */
};

/* All parts, wherever they are; of no terrain. */
static inline void rb_near_parts_all(struct rb_near_parts *near, const struct rb_body_parts *parts)
{
	near->count = parts->count;
	near->next = 0;
	near->far = false;
}

/* A body of which these are the parts stands there; `centre` in the same axes. */
static inline void rb_near_parts_begin(struct rb_near_parts *near,
                                       const struct rb_body_parts *parts, rb_vec3 position,
                                       rb_quat orientation, rb_vec3 centre, double within)
{
	near->count = parts->count;
	near->next = 0;
	near->far = parts->terrain != NULL;
	if (near->far)
		rb_terrain_walk_begin(
			&near->walk, parts->terrain,
			rb_quat_rotate_back(orientation, rb_vec3_sub(centre, position)), within);
}

static inline int rb_near_parts_next(struct rb_near_parts *near) /* -1: no more */
{
	if (near->far)
		return rb_terrain_walk_next(&near->walk);
	return near->next < near->count ? near->next++ : -1;
}

/* Those farther away need not be seen. */
static inline void rb_near_parts_limit(struct rb_near_parts *near, double within)
{
	if (near->far && within < near->walk.within)
		near->walk.within = within;
}

/*
 * m: signed gap of two bodies of the scene where they are at the start, of which one is no plane,
 * nor rectangle.
 */
double rb_parts_gap_at_start(const struct rb_parts_table *table, const struct rb_scene *scene,
                             int a, int b);

/*
 * A part of a body whose object stands there. What the result refers to lives as long as the table.
 */
rb_placed rb_body_part_place(const struct rb_body_part *part, rb_vec3 origin, rb_quat orientation);

#endif
