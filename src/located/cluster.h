/* SPDX-License-Identifier: MIT */
/* The room of clusters: taking, giving back, growing their lists. */
#ifndef RB_LOCATED_CLUSTER_H
#define RB_LOCATED_CLUSTER_H

#include "located/located.h"

/*
 * An unused cluster with room for so many; -1 when memory is out. Its members are told so in
 * cluster_of.
 */
int rb_cluster_take(struct rb_located *l, const int *member, int member_count, int held_count);
/* Its members are in no cluster any more. */
void rb_cluster_drop(struct rb_located *l, int cluster);
void rb_cluster_release_all(struct rb_located *l);

#endif
