/* SPDX-License-Identifier: MIT */
/* Memory of clusters: allocation, release, growth of their lists. Simulator's thread. */
#ifndef RB_LOCATED_CLUSTER_H
#define RB_LOCATED_CLUSTER_H

#include "located/located.h"

/*
 * Takes an unused cluster with room for these numbers, and sets cluster_of of its members; returns
 * its index, -1: no memory.
 */
int rb_cluster_take(struct rb_located *l, const int *member, int member_count, int held_count);
/* Frees a cluster; its members are in none afterwards. */
void rb_cluster_drop(struct rb_located *l, int cluster);
/* Frees the lists of all clusters, of which none is used. */
void rb_cluster_release_rows(struct rb_located *l);
void rb_cluster_release_all(struct rb_located *l);

#endif
