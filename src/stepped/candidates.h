/* SPDX-License-Identifier: MIT */
/*
 * Pairs that could touch, from boxes enlarged to last for several steps.
 *
 * Owned by the method's state. Candidates hold until a body could leave its box. Boxes decide cost
 * only, except for the order in which ties are processed, which is by pair. The first body of a
 * pair is dynamic; a driven one is always the second.
 */
#ifndef RB_STEPPED_CANDIDATES_H
#define RB_STEPPED_CANDIDATES_H

#include "geom/core.h"
#include "model/parts.h"
#include "step/broadphase.h"
#include "world/world.h"

#define RB_NO_CACHES UINT32_MAX

/* Largest number of a pose; the next is 0. */
#define RB_PLACING_MAX 0x7fffffffu

/* Result of the last inspection of two parts, as a cache; decides cost only. */
struct rb_axis_cache {
	rb_vec3 axis;      /* direction that separated them, or in which they touch; zero: none */
	double gap, faces; /* m: if `is_known`, result of rb_separation_of along the axis */
	unsigned placing_a : 31; /* of that pose */
	unsigned is_known : 1;
	unsigned placing_b : 31;
	unsigned is_close : 1; /* they were not separated */
};

_Static_assert(sizeof(struct rb_axis_cache) == 48, "there may be thirteen for each body");

struct rb_candidates {
	bool valid;
	rb_vec3 *built_at;   /* [bodies] m: the objects' origins when the boxes were built */
	double *margin;      /* [bodies] m: how far each may move from there */
	rb_quat *built_turn; /* [bodies]: orientation of driven planes then; NULL: none is driven */
	double *turn_margin; /* [bodies] rad: further rotation that these may make */
	/* [bodies] m: displacement of each in the current step, if nothing touches it */
	double *reach;
	rb_aabb *box; /* [bodies] in the arena, during a search for pairs */
	double h_s;   /* of the current step */
	double share; /* share of bodies that move: where it is small, boxes last longer */
	const struct rb_pair *pair; /* borrowed from the broadphase, or `own` */
	size_t pair_count;
	/* borrowed: indices of the pairs to be inspected, ascending; NULL: all */
	const uint32_t *live;
	size_t live_count;
	/*
	 * m, by pair: overlap when last measured; negative: the overlap is at most its magnitude;
	 * NAN: not measured at these poses, or beyond the tolerance
	 */
	float *depth, *own_depth;
	/*
	 * m, by pair with parts: distance when last measured plus their `path` then; while the sum
	 * of the bodies' `path` is smaller, they are apart by the difference.
	 */
	double *clearance, *own_clearance;
	size_t depth_capacity, bounds_capacity;
	double resting_depth; /* m: largest overlap of pairs that are not live; NAN: unknown */
	/*
	 * Scenes with parts: data for the narrow phase. Whoever inspects a pair may write its
	 * caches.
	 */
	struct rb_axis_cache
		*cache;        /* by pair of parts of the pairs that came close, in order of time */
	uint32_t cache_count;  /* number of these; incremented by all workers */
	uint32_t *first_cache; /* [pair_count], by pair; RB_NO_CACHES: none yet */
	uint32_t *own_first_cache;
	size_t cache_capacity, first_cache_capacity;
	int *first_part;   /* [bodies and statics + 1] into `placed` */
	rb_placed *placed; /* poses of parts: rb_candidates_place */
	rb_vec3 *at;       /* [bodies and statics] m: their origins at these poses */
	rb_quat *turn;     /* [bodies] their orientations at these poses */
	/* [bodies and statics] number of that pose, 31 bits, incremented each time */
	uint32_t *placing;
	/* [bodies and statics] m: upper bound of the path of each one's points, over all poses */
	double *path;
	/* [bodies and statics] m: radius about the origin; infinite planes: INFINITY */
	double *size;
	/*
	 * [bodies and statics] m: displacement of points in the step, including rotation, at most
	 */
	double *ahead;
	/* owned: for rb_candidates_keep; with driven bodies: pairs whose first body is dynamic */
	struct rb_pair *own;
	size_t own_capacity;
};

static inline size_t rb_candidates_live_count(const struct rb_candidates *candidates)
{
	return candidates->live ? candidates->live_count : candidates->pair_count;
}

/* The k-th pair to be inspected. */
static inline size_t rb_candidates_live(const struct rb_candidates *candidates, size_t k)
{
	return candidates->live ? candidates->live[k] : k;
}

RB_CHECKED enum rb_status rb_candidates_create(struct rb_candidates *candidates,
                                               const struct rb_model *model, struct rb_error *err);
void rb_candidates_release(struct rb_candidates *candidates);

/*
 * Sets the reaches of these bodies: the world's velocities include the forces of the step, those of
 * the mark do not.
 */
void rb_candidates_reach(struct rb_candidates *candidates, const struct rb_world *world, double h_s,
                         const int *member, int count);

/*
 * Finds candidates of the whole world, whose reaches are known, unless the present ones hold for
 * these bodies; all others have not moved since. New ones are all live.
 */
RB_CHECKED enum rb_status rb_candidates_find(struct rb_candidates *candidates,
                                             struct rb_world *world, const int *body, int count,
                                             struct rb_error *err);

/* Whether each of these is still within its margin; false for NaN. */
bool rb_candidates_holds(const struct rb_candidates *candidates, const struct rb_world *world,
                         const int *body, int count);

/* Clears all caches by pair, for the present pairs in their order. */
RB_CHECKED enum rb_status rb_candidates_forget(struct rb_candidates *candidates,
                                               const struct rb_model *model, struct rb_error *err);

/* Adds cleared caches for a pair. */
void rb_candidates_add_caches(struct rb_candidates *candidates, size_t k);

static inline struct rb_axis_cache *rb_candidates_caches(struct rb_candidates *candidates, size_t k)
{
	if (candidates->first_cache[k] == RB_NO_CACHES)
		rb_candidates_add_caches(candidates, k);
	return &candidates->cache[candidates->first_cache[k]];
}

static inline int rb_candidates_part_count(const struct rb_candidates *candidates, int i)
{
	return candidates->first_part[i + 1] - candidates->first_part[i];
}

/* Whether the near parts of a body are searched each time, without a cache. */
static inline bool rb_candidates_is_terrain(const struct rb_model *model, int i)
{
	return model->shape[i].kind == RB_SHAPE_TERRAIN;
}

/* Parts of a pair's second body that come within `within` of a part of the first, m. */
static inline void rb_candidates_near(struct rb_near_parts *near, const struct rb_model *model,
                                      int b, const rb_placed *part, double within)
{
	const struct rb_body_parts *const parts = rb_model_parts(model, b);

	/* other bodies: all parts are inspected, wherever they are */
	if (!parts->terrain)
		rb_near_parts_all(near, parts);
	else
		rb_near_parts_begin(near, parts, model->position[b], model->orientation[b],
		                    part->at, within + part->core->reach + part->core->radius);
}

/*
 * Sets poses of the parts of these bodies, and the bounds of their rotation: before contact
 * queries.
 */
void rb_candidates_place(struct rb_candidates *candidates, struct rb_world *world, const int *body,
                         int count);

/*
 * Bound of the displacement of the object's origin in a step of h_s at the speeds of that state, m.
 */
double rb_candidates_displacement(const struct rb_world *world, const struct rb_state *state, int i,
                                  double h_s);
/* Updates `ahead` of a body, if there are parts. */
void rb_candidates_turn(struct rb_candidates *candidates, const struct rb_world *world, int i);

/* Finds pairs that could touch while every body's origin stays within its bounds. */
RB_CHECKED enum rb_status rb_candidates_pairs(struct rb_candidates *candidates,
                                              struct rb_world *world, const rb_aabb *bounds,
                                              struct rb_error *err);

/* Copies the candidates so that they survive another search of the broadphase; false: no memory. */
bool rb_candidates_keep(struct rb_candidates *candidates);

/* Radius of a moving body about its origin, m; infinite planes: 0. */
double rb_candidates_size(const struct rb_model *model, int i);

#endif
