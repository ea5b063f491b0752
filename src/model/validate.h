/* SPDX-License-Identifier: MIT */
/*
 * Is the scene possible? What can only be known from all of it together, named with file, line,
 * body and key.
 *
 * Pure functions of a scene, main thread, before anything is sealed. Also here: masses that the
 * checks and the model must agree on.
 */
#ifndef RB_MODEL_VALIDATE_H
#define RB_MODEL_VALIDATE_H

#include <rbsim/model.h>

/* The bit of bodies that are in no group; groups have those below. */
#define RB_NO_GROUP (UINT64_C(1) << 63)

static inline uint64_t rb_body_group_bit(const struct rb_body_def *body)
{
	return body->group >= 0 ? UINT64_C(1) << body->group : RB_NO_GROUP;
}

/* Without a filter a body collides with all, whether they are in a group or not. */
static inline uint64_t rb_body_collides(const struct rb_body_def *body)
{
	return body->filters ? body->collides_with : UINT64_MAX;
}

/* Without a volume: nothing can push it. */
static inline bool rb_shape_is_flat(const struct rb_shape *shape)
{
	return shape->kind == RB_SHAPE_PLANE || shape->kind == RB_SHAPE_RECTANGLE ||
	       shape->kind == RB_SHAPE_TERRAIN;
}

/* Both must want it, and one of them must be moved by it. */
static inline bool rb_bodies_can_touch(const struct rb_body_def *a, const struct rb_body_def *b)
{
	return (rb_body_is_free(a) || rb_body_is_free(b)) &&
	       (rb_body_collides(a) & rb_body_group_bit(b)) != 0 &&
	       (rb_body_collides(b) & rb_body_group_bit(a)) != 0;
}

/* kg, of a free body, as given or from density and volume; not checked. */
double rb_body_mass(const struct rb_scene *scene, const struct rb_body_def *body);
/*
 * kg, what it attracts others by: as given, or its mass; 0 where nothing is attracted by it or by
 * anything.
 */
double rb_body_attracts_by(const struct rb_scene *scene, const struct rb_body_def *body);
/* kg m^2 about the centre of mass, as given or of the uniform shape; not checked. */
rb_mat3 rb_body_inertia(const struct rb_scene *scene, const struct rb_body_def *body, double mass);

/*
 * Adds every mistake to `mistakes`. `turns`: some body can turn, so that inertia matters.
 * RB_ERR_SCENE with the first mistake in `err`, or RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_scene_check(const struct rb_scene *scene, bool turns,
                                         struct rb_mistakes *mistakes, struct rb_error *err);

#endif
