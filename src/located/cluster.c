/* SPDX-License-Identifier: MIT */
/*
 * Clusters are bodies in lasting contact, integrated together. They are kept in a growing array
 * with a free list, so that indices stay valid; the index is also that in the event queue.
 */
#include "located/cluster.h"

#include "base/error.h"

#include <string.h>

#include "base/memory.h"

int rb_cluster_take(struct rb_located *l, const int *member, int member_count, int held_count)
{
	int k = l->cluster_free - 1;

	RB_ASSERT(member_count > 0 && held_count >= 0);
	RB_ASSERT(!l->cluster_free || l->cluster_free <= l->cluster_count);
	if (k >= 0) {
		l->cluster_free = l->cluster[k].next_free;
	} else {
		k = l->cluster_count;
		if (!rb_memory_reserve(&l->cluster, &l->cluster_capacity, (size_t)k + 1,
		                       sizeof *l->cluster))
			return -1;
		l->cluster[k] = (struct rb_cluster){0};
		l->cluster_count++;
	}
	struct rb_cluster *c = &l->cluster[k];
	if (!rb_memory_reserve(&c->member, &c->member_capacity, (size_t)member_count,
	                       sizeof *c->member) ||
	    !rb_memory_reserve(&c->held, &c->held_capacity, (size_t)held_count, sizeof *c->held))
		return -1;
	memcpy(c->member, member, (size_t)member_count * sizeof *member);
	c->used = true;
	c->integrated = c->at_rest = c->is_cut = c->has_jumped = c->hits = false;
	c->member_count = member_count;
	c->held_count = 0;
	c->account.n = 0;
	c->rates = (struct rb_account_rates){0};
	for (int m = 0; m < member_count; m++)
		l->cluster_of[member[m]] = k;
	return k;
}

void rb_cluster_drop(struct rb_located *l, int cluster)
{
	struct rb_cluster *c = &l->cluster[cluster];

	RB_ASSERT(cluster >= 0 && cluster < l->cluster_count && l->cluster[cluster].used);
	for (int m = 0; m < c->member_count; m++)
		l->cluster_of[c->member[m]] = -1;
	rb_queue_set(l->queue, l->n + cluster, (double)INFINITY);
	c->used = false;
	c->member_count = c->held_count = 0;
	c->next_free = l->cluster_free;
	l->cluster_free = cluster + 1;
}

void rb_cluster_release_rows(struct rb_located *l)
{
	for (int k = 0; k < l->cluster_count; k++) {
		struct rb_cluster *const c = &l->cluster[k];

		RB_ASSERT(!c->used);
		rb_memory_free(c->member);
		rb_memory_free(c->held);
		rb_memory_free(c->block);
		rb_memory_free(c->account_block);
		c->member = NULL;
		c->held = NULL;
		c->block = c->account_block = NULL;
		c->member_capacity = c->held_capacity = c->block_capacity = 0;
	}
}

void rb_cluster_release_all(struct rb_located *l)
{
	for (int k = 0; k < l->cluster_count; k++)
		l->cluster[k].used = false;
	rb_cluster_release_rows(l);
	rb_memory_free(l->cluster);
	l->cluster = NULL;
	l->cluster_count = 0;
}
