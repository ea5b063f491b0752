/* SPDX-License-Identifier: MIT */
/*
 * Crowds: bodies connected by common events since elapsed time last covered all counted work. Each
 * crowd counts the work of its events, up to a limit that is relatively lower for larger crowds:
 * few bodies are worth locating at many times the cost of their steps, which is small all the same.
 * Simulator's thread.
 */
#ifndef RB_LOCATED_CROWD_H
#define RB_LOCATED_CROWD_H

#include "located/located.h"

/*
 * Factor by which the limits of a world are raised: for a mechanism without contacts, whose motion
 * is smooth and is often checked for closure after a turn; and for few bodies, whose total cost is
 * small.
 */
static inline uint64_t rb_crowd_limit_factor(const struct rb_located *l)
{
	enum { MECHANISM = 8, FEW = 32 };

	if (!(l->model->features & RB_FEATURE_CONTACT))
		return MECHANISM;
	return l->n > 0 && l->n < FEW ? FEW / (uint64_t)l->n : 1;
}

/*
 * True if searches for collisions of spheres are counted: few spheres are located however often
 * they collide.
 */
static inline bool rb_crowd_counts_spheres(const struct rb_located *l)
{
	enum { FEW = 8 };

	return l->model->parts || l->n > FEW;
}

/* Limit of a world's count, in bodies, beyond what time allows. */
uint64_t rb_crowd_world_max(const struct rb_located *l);

/*
 * Cost, in products, of inspecting two solids in flight: with a plane a closed form; otherwise, for
 * each pair of parts, a search for their distance, and for faces, edges and rims along it. For a
 * terrain, `facets` of them are inspected.
 */
uint64_t rb_crowd_inspection(const struct rb_located *l, int i, int j, int facets);

/* Counts the cost of a step of `dt_s`; `before` are the world's counts before it. */
void rb_crowd_count_step(const struct rb_located *l, const struct rb_counts *before, double dt_s);

/*
 * Cost of the steps taken per second of them, in bodies/s, as if no body had been at rest; infinite
 * before the first.
 */
double rb_crowd_stepped_pace(const struct rb_located *l);

/* True if the steps taken have cost several times what resolving all contacts would cost. */
bool rb_crowd_may_attempt(const struct rb_located *l);

/* Locating begins: every body is a crowd of its own. */
void rb_crowd_begin(struct rb_located *l);

/* Elapsed time covers all work: every body is a crowd of its own again. */
void rb_crowd_end(struct rb_located *l);

/* Completes the loaded forest; false if it is none. */
RB_CHECKED bool rb_crowd_complete(struct rb_located *l);

/*
 * Makes each body refer to its root: the lengths of paths depend on which roots were looked up, and
 * a checkpoint must not.
 */
void rb_crowd_compress(struct rb_located *l);

/* Joins the crowds of two bodies; fixed ones have none. */
void rb_crowd_join(struct rb_located *l, int i, int j);

/*
 * An event of body i at l->now_s (-1: of none): begins it and sets l->crowd_max; sets that again
 * after its crowd has grown; counts the work of the event.
 */
void rb_crowd_event(struct rb_located *l, int i);
void rb_crowd_limit(struct rb_located *l, int i);
void rb_crowd_count(struct rb_located *l, int i);

#endif
