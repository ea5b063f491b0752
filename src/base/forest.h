/* SPDX-License-Identifier: MIT */
/* Disjoint sets of numbers as trees: parent[i] == i for roots. */
#ifndef RB_BASE_FOREST_H
#define RB_BASE_FOREST_H

/* The root of i's tree, whose paths are halved on the way. */
static inline int rb_forest_root(int *parent, int i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

#endif
