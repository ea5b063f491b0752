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

/* Bodies that a world may count in all, beyond those that time allows. */
uint64_t rb_crowd_world_max(int bodies);

/* Counts what a step has cost: `before` are the world's counts before it. */
void rb_crowd_count_step(const struct rb_located *l, const struct rb_counts *before);

/* Whether the steps taken have cost several times what bringing bodies to their contacts does. */
bool rb_crowd_may_try(const struct rb_located *l);

/* Locating begins: nobody has dealt with anybody yet. */
void rb_crowd_begin(struct rb_located *l);

/* Time has paid for all: crowds begin anew. */
void rb_crowd_end(struct rb_located *l);

/* What is loaded: false if that is no forest. */
RB_CHECKED bool rb_crowd_complete(struct rb_located *l);

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
