/* SPDX-License-Identifier: MIT */
/* Disjoint sets of numbers as trees: parent[i] == i for roots. */
#ifndef RB_BASE_FOREST_H
#define RB_BASE_FOREST_H

#include <stdbool.h>

/* The root of i's tree, whose paths are halved on the way. */
static inline int rb_forest_root(int *parent, int i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

/*
 * The same for threads that join trees at once: what another one has written since only takes a
 * path closer to its root.
 */
static inline int rb_forest_root_shared(int *parent, int i)
{
	for (;;) {
		const int up = __atomic_load_n(&parent[i], __ATOMIC_RELAXED);
		const int next = __atomic_load_n(&parent[up], __ATOMIC_RELAXED);

		if (up == next)
			return up;
		__atomic_store_n(&parent[i], next, __ATOMIC_RELAXED);
		i = next;
	}
}

/*
 * The smaller root stays one: whatever the order in which trees are joined, and by whom, the root
 * of each is its smallest number in the end. `shared`: other threads do the same now.
 */
static inline void rb_forest_join(int *parent, int a, int b, bool shared)
{
	for (bool joined = false; !joined;) {
		a = shared ? rb_forest_root_shared(parent, a) : rb_forest_root(parent, a);
		b = shared ? rb_forest_root_shared(parent, b) : rb_forest_root(parent, b);
		int root = a > b ? a : b;
		const int to = a > b ? b : a;

		if (root == to)
			return;
		if (!shared)
			parent[root] = to;
		/* else somebody may have hung it on another one meanwhile */
		joined = !shared || __atomic_compare_exchange_n(&parent[root], &root, to, false,
		                                                __ATOMIC_RELAXED, __ATOMIC_RELAXED);
	}
}

#endif
