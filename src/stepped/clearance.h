/* SPDX-License-Identifier: MIT */
/*
 * Which candidates must be looked at: of each pair it is known how far apart it was and how far its
 * bodies have got since. Parts, in pairs of blocks of fixed size, whatever the threads.
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

/* Of two numbers, the second where it is not NaN: fmin and fmax are calls. */
static inline double rb_clearance_min(double a, double b)
{
	return b < a ? b : a;
}

static inline double rb_clearance_max(double a, double b)
{
	return b > a ? b : a;
}

/* A sphere on a sphere or plane: a closed form. */
static inline bool rb_pair_is_plain(const struct rb_model *model, int a, int b)
{
	return model->shape[a].kind == RB_SHAPE_SPHERE && !rb_shape_has_parts(model->shape[b].kind);
}

/* Directions to look along for pairs that were apart, and for those that were not. */
enum { RB_ROUNDS_SEPARATE = 12, RB_ROUNDS_CLOSE = 1 };

/* Two parts, seen from the origin of the first. */
struct rb_part_pair {
	rb_placed a, b;
	double radii; /* m, of both together */
};

/* Clues of a pair may be asked for: they come from afar, and what is asked first takes as long. */
static inline void rb_clearance_expect(const struct rb_candidates *candidates, size_t k)
{
	if (candidates->first_clue[k] != RB_NO_CLUES)
		__builtin_prefetch(&candidates->clue[candidates->first_clue[k]], 1);
}

/* m: how far both have got. */
static inline double rb_clearance_path(const struct rb_candidates *candidates, struct rb_pair pair)
{
	return candidates->path[pair.a] + candidates->path[pair.b];
}

/*
 * Whether the bodies of a pair are certainly farther apart than `max`, m, because they were, by
 * more than they have moved since. Of most pairs nothing else has to be looked at.
 */
static inline bool rb_clearance_was_more(const struct rb_candidates *candidates, size_t k,
                                         double path, double max)
{
	return candidates->clearance[k] - path > max + 4 * DBL_EPSILON * path;
}

/*
 * Whether the bodies of a pair are certainly farther apart than `most`, m: they were, by more than
 * they have moved since; or by spheres about them.
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

/* The same of two of their parts: how far, at least, or -INFINITY. */
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

/* Of a pair's bodies: where they are. */
struct rb_placings {
	uint32_t a, b;
};

static inline struct rb_placings rb_placings_of(const struct rb_candidates *candidates,
                                                struct rb_pair pair)
{
	return (struct rb_placings){candidates->placing[pair.a], candidates->placing[pair.b]};
}

static inline bool rb_clue_knows(const struct rb_clue *clue, struct rb_placings placings)
{
	return clue->is_known && clue->placing_a == placings.a && clue->placing_b == placings.b;
}

/* What has been found of two parts where they are now, or is found and remembered. */
static inline rb_separation rb_clearance_separation(const struct rb_part_pair *parts,
                                                    struct rb_placings placings,
                                                    struct rb_clue *clue)
{
	if (rb_clue_knows(clue, placings))
		return (rb_separation){clue->axis, clue->gap,
		                       rb_separation_noise(&parts->a, &parts->b), clue->faces};
	const rb_separation found = rb_separation_of(&parts->a, &parts->b);

	clue->axis = found.normal;
	clue->gap = found.gap;
	clue->faces = found.faces;
	clue->placing_a = placings.a & RB_PLACING_MAX;
	clue->placing_b = placings.b & RB_PLACING_MAX;
	clue->is_known = true;
	return found;
}

/* How far they are apart at least, if that is seen to be more than `most`, m; else -INFINITY. */
static inline double rb_clearance_of_parts(const struct rb_part_pair *parts, double max,
                                           struct rb_clue *clue)
{
	const int rounds = clue->is_close ? RB_ROUNDS_CLOSE : RB_ROUNDS_SEPARATE;

	clue->is_known = false; /* the axis may change */
	return rb_separation_beyond(&parts->a, &parts->b, max + parts->radii, rounds, &clue->axis) -
	       parts->radii;
}

#endif
