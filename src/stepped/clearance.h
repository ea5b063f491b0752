/* SPDX-License-Identifier: MIT */
/*
 * Quick rejection of candidates: each pair has a lower bound of its distance, valid until its
 * bodies have moved as far. For parts, in pairs of blocks of fixed size, whatever the number of
 * threads.
 */
#ifndef RB_STEPPED_CLEARANCE_H
#define RB_STEPPED_CLEARANCE_H

#include "geom/separation.h"
#include "stepped/candidates.h"

#include <float.h>

enum { RB_PAIRS_PER_BLOCK = 512 };

static inline size_t rb_pairs_end(size_t count, size_t first)
{
	return first + RB_PAIRS_PER_BLOCK < count ? first + RB_PAIRS_PER_BLOCK : count;
}

static inline int rb_pairs_blocks(size_t count)
{
	return (int)((count + RB_PAIRS_PER_BLOCK - 1) / RB_PAIRS_PER_BLOCK);
}

/* Minimum of two numbers; a if b is NaN. fmin and fmax are calls. */
static inline double rb_clearance_min(double a, double b)
{
	return b < a ? b : a;
}

static inline double rb_clearance_max(double a, double b)
{
	return b > a ? b : a;
}

/* Whether a pair is a sphere on a sphere or plane, which has a closed form. */
static inline bool rb_pair_is_plain(const struct rb_model *model, int a, int b)
{
	return model->shape[a].kind == RB_SHAPE_SPHERE && !rb_shape_has_parts(model->shape[b].kind);
}

/* Iterations over separating directions: for pairs that were apart, and for close ones. */
enum { RB_ROUNDS_SEPARATE = 12, RB_ROUNDS_CLOSE = 1 };

/* Two parts, relative to the origin of the first. */
struct rb_part_pair {
	rb_placed a, b;
	double radii; /* m, sum of both */
};

/* Prefetches cached axes of a pair, which are rarely in the processor's cache. */
static inline void rb_clearance_prefetch(const struct rb_candidates *candidates, size_t k)
{
	if (candidates->first_cache[k] != RB_NO_CACHES)
		__builtin_prefetch(&candidates->cache[candidates->first_cache[k]], 1);
}

/* Sum of the paths of both bodies, m. */
static inline double rb_clearance_path(const struct rb_candidates *candidates, struct rb_pair pair)
{
	return candidates->path[pair.a] + candidates->path[pair.b];
}

/*
 * Whether the bodies of a pair are certainly farther apart than `max`, m: their last distance
 * exceeded it by more than they have moved since. True for most pairs.
 */
static inline bool rb_clearance_was_more(const struct rb_candidates *candidates, size_t k,
                                         double path, double max)
{
	return candidates->clearance[k] - path > max + 4 * DBL_EPSILON * path;
}

/*
 * Whether the bodies of a pair are certainly farther apart than `max`, m: by their last distance,
 * or by bounding spheres.
 */
static inline bool rb_clearance_is_more(const struct rb_candidates *candidates, size_t k,
                                        double path, double max)
{
	if (rb_clearance_was_more(candidates, k, path, max))
		return true;
	const struct rb_pair pair = candidates->pair[k];
	const rb_vec3 d = rb_vec3_sub(candidates->at[pair.b], candidates->at[pair.a]);
	const double sizes = (candidates->size[pair.a] + candidates->size[pair.b]) * (1 + 1e-12);
	const double square = rb_vec3_dot(d, d), whole = (sizes + max) * (1 + 1e-12);

	if (!(whole > 0 && square > whole * whole))
		return false;
	candidates->clearance[k] = path + sqrt(square) * (1 - 1e-12) - sizes;
	return true;
}

/* Lower bound of the distance of two parts by bounding spheres, m, or -INFINITY. */
static inline double rb_clearance_of_spheres(const rb_placed *a, const rb_placed *b, double max)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);
	const double sizes = a->core->reach + b->core->reach + a->core->radius + b->core->radius;
	const double square = rb_vec3_dot(d, d), whole = (sizes + max) * (1 + 1e-12);

	/* a half space has no reach */
	return a->core->kind != RB_CORE_HALF_SPACE && b->core->kind != RB_CORE_HALF_SPACE &&
	                       whole > 0 && square > whole * whole
	               ? sqrt(square) * (1 - 1e-12) - sizes
	               : -(double)INFINITY;
}

static inline struct rb_part_pair rb_part_pair_of(const rb_placed *a, const rb_placed *b)
{
	return (struct rb_part_pair){{a->core, {0, 0, 0}, a->turn},
	                             {b->core, rb_vec3_sub(b->at, a->at), b->turn},
	                             a->core->radius + b->core->radius};
}

/* Numbers of the poses of a pair's bodies. */
struct rb_placings {
	uint32_t a, b;
};

static inline struct rb_placings rb_placings_of(const struct rb_candidates *candidates,
                                                struct rb_pair pair)
{
	return (struct rb_placings){candidates->placing[pair.a], candidates->placing[pair.b]};
}

static inline bool rb_axis_cache_knows(const struct rb_axis_cache *cache,
                                       struct rb_placings placings)
{
	return cache->is_known && cache->placing_a == placings.a && cache->placing_b == placings.b;
}

/* Separation of two parts at their present poses, kept in the cache. */
static inline rb_separation rb_clearance_separation(const struct rb_part_pair *parts,
                                                    struct rb_placings placings,
                                                    struct rb_axis_cache *cache)
{
	if (rb_axis_cache_knows(cache, placings))
		return (rb_separation){cache->axis, cache->gap,
		                       rb_separation_noise(&parts->a, &parts->b), cache->faces};
	const rb_separation found = rb_separation_of(&parts->a, &parts->b);

	cache->axis = found.normal;
	cache->gap = found.gap;
	cache->faces = found.faces;
	cache->placing_a = placings.a & RB_PLACING_MAX;
	cache->placing_b = placings.b & RB_PLACING_MAX;
	cache->is_known = true;
	return found;
}

/* Lower bound of the distance of two parts, if it is found to exceed `max`, m; else -INFINITY. */
static inline double rb_clearance_of_parts(const struct rb_part_pair *parts, double max,
                                           struct rb_axis_cache *cache)
{
	const int rounds = cache->is_close ? RB_ROUNDS_CLOSE : RB_ROUNDS_SEPARATE;

	cache->is_known = false; /* the axis may change */
	return rb_separation_beyond(&parts->a, &parts->b, max + parts->radii, rounds,
	                            &cache->axis) -
	       parts->radii;
}

#endif
