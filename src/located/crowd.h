/* SPDX-License-Identifier: MIT */
/*
 * Who belongs to a crowd: bodies that have dealt with each other, or with others that both have, in
 * events since time last had paid for all. Each crowd counts its events, and may count the less the
 * larger it is: few bodies are worth locating at a cost that is many times that of their steps, and
 * is small all the same. Simulator thread.
 */
#ifndef RB_LOCATED_CROWD_H
#define RB_LOCATED_CROWD_H

#include "located/located.h"

/*
 * How many times as much as others a world may take: a mechanism that nothing touches, whose motion
 * is smooth, and of which one looks at whether it closes after a turn; and few bodies, of which all
 * is little and the answers are asked for.
 */
static inline uint64_t rb_located_worth(const struct rb_located *l)
{
	enum { MECHANISM = 8, FEW = 32 };

	if (!(l->model->features & RB_FEATURE_CONTACT))
		return MECHANISM;
	return l->n > 0 && l->n < FEW ? FEW / (uint64_t)l->n : 1;
}

/*
 * Whether spheres that fly and collide count what it takes to find that: few are followed however
 * often they do.
 */
static inline bool rb_crowd_counts_spheres(const struct rb_located *l)
{
	enum { FEW = 8 };

	return l->model->parts || l->n > FEW;
}

/* Bodies that a world may count in all, beyond those that time allows. */
uint64_t rb_crowd_world_max(const struct rb_located *l);

/*
 * Products that a look at two solids in flight counts for: above a plane it is a closed form, for
 * each pair of other parts a search for their distance, and for faces, edges and rims along it. Of
 * a terrain so many `facets` are looked at.
 */
uint64_t rb_crowd_inspection(const struct rb_located *l, int i, int j, int facets);

/* Counts what a step of `dt_s` has cost: `before` are the world's counts before it. */
void rb_crowd_count_step(const struct rb_located *l, const struct rb_counts *before, double dt_s);

/*
 * Bodies that the steps taken have counted for in a second of them, 1/s, as if none had stood;
 * infinite before the first.
 */
double rb_crowd_stepped_pace(const struct rb_located *l);

/* Whether the steps taken have cost several times what bringing bodies to their contacts does. */
bool rb_crowd_may_try(const struct rb_located *l);

/* Locating begins: nobody has dealt with anybody yet. */
void rb_crowd_begin(struct rb_located *l);

/* Time has paid for all: crowds begin anew. */
void rb_crowd_end(struct rb_located *l);

/* What is loaded: false if that is no forest. */
RB_CHECKED bool rb_crowd_complete(struct rb_located *l);

/*
 * Lets each name its root: how long the ways to roots are depends on who has been asked for, and
 * what is saved must not.
 */
void rb_crowd_shorten(struct rb_located *l);

/* These two deal with each other; fixed bodies with nobody. */
void rb_crowd_join(struct rb_located *l, int i, int j);

/*
 * An event at l->now_s of the body, -1: of none. Sets l->crowd_max, again when its crowd has grown;
 * counts what the event has cost.
 */
void rb_crowd_event(struct rb_located *l, int i);
void rb_crowd_limit(struct rb_located *l, int i);
void rb_crowd_count(struct rb_located *l, int i);

#endif
