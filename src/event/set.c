/* SPDX-License-Identifier: MIT */
#include "event/set.h"

#include <stdlib.h>
#include <string.h>

void rb_set_add(struct rb_located *l, int i)
{
	if (rb_located_fixed(l, i) || l->place[i] >= 0)
		return;
	l->place[i] = l->set_count;
	l->set[l->set_count++] = i;
}

void rb_set_clear(struct rb_located *l)
{
	for (int k = 0; k < l->set_count; k++)
		l->place[l->set[k]] = -1;
	l->set_count = 0;
}

int rb_set_near(const struct rb_located *l, int i)
{
	int count = 0;

	if (l->cells)
		return rb_cells_near(l->cells, i, l->near);
	for (int j = 0; j < l->n; j++)
		if (j != i)
			l->near[count++] = j;
	return count;
}

const struct rb_held *rb_set_held(const struct rb_located *l, int a, int b)
{
	const int mover = a < l->n && l->cluster_of[a] >= 0 ? a : b;

	if (mover >= l->n || l->cluster_of[mover] < 0)
		return NULL;
	const struct rb_cluster *c = &l->cluster[l->cluster_of[mover]];
	const int low_a = a < b ? a : b, high_b = a < b ? b : a;
	int low = 0, high = c->held_count;

	while (low < high) {
		const int middle = low + (high - low) / 2;
		const struct rb_held *h = &c->held[middle];

		if (h->a < low_a || (h->a == low_a && h->b < high_b))
			low = middle + 1;
		else
			high = middle;
	}
	return low < c->held_count && c->held[low].a == low_a && c->held[low].b == high_b
	               ? &c->held[low]
	               : NULL;
}

bool rb_set_touching(const struct rb_located *l, const struct rb_meet *m, double t, double slack)
{
	(void)slack;
	return m->gap <= rb_meet_band(l, m, t);
}

bool rb_set_lasting(const struct rb_located *l, const struct rb_meet *m, double t, double slack)
{
	const double rate = rb_vec3_dot(m->velocity, m->normal);
	const double still = rb_meet_noise(l, m) + slack;

	/* impacts have been dealt with; but not those that another method has left to come */
	return m->gap <= rb_meet_band(l, m, t) && rate <= still && (!l->starting || rate >= -still);
}

struct pairs {
	double t, slack;
	rb_set_joins *joins;
	struct rb_meet *row; /* in the arena */
	int count, capacity;
	bool failed;
};

static void keep(struct rb_located *l, struct pairs *pairs, const struct rb_meet *m)
{
	if (pairs->count == pairs->capacity) {
		const int capacity = pairs->capacity > 0 ? 2 * pairs->capacity : 8;
		struct rb_meet *const grown = rb_arena_take(l->arena, (size_t)capacity,
		                                            sizeof *grown);

		if (!grown) {
			pairs->failed = true;
			return;
		}
		if (pairs->count > 0)
			memcpy(grown, pairs->row, (size_t)pairs->count * sizeof *grown);
		pairs->row = grown;
		pairs->capacity = capacity;
	}
	pairs->row[pairs->count++] = *m;
}

/* A pair whose far side is not yet dealt with. */
static void look(struct rb_located *l, struct pairs *pairs, int i, int j)
{
	if (!rb_meet_can(l, i, j))
		return;
	const bool come = (i == l->come_a && j == l->come_b) || (i == l->come_b && j == l->come_a);
	const bool held = rb_set_held(l, i, j) != NULL;
	if (!come && !held && rb_meet_is_far(l, i, j, pairs->t, pairs->t))
		return;
	struct rb_meet m = rb_meet_at(l, i < j ? i : j, i < j ? j : i, pairs->t);
	/* those whose touch has been located do touch, whatever rounding makes of their gap */
	if (come)
		m.gap = fmin(m.gap, 0);
	if (!held && !pairs->joins(l, &m, pairs->t, pairs->slack))
		return;
	keep(l, pairs, &m);
	rb_set_add(l, j);
}

static void add_springs(struct rb_located *l, int i)
{
	const struct rb_scene *scene = l->model->scene;
	const int id = l->model->id_of[i];

	for (int k = 0; k < scene->spring_count; k++) {
		if (scene->springs[k].a == id)
			rb_set_add(l, l->model->index_of[scene->springs[k].b]);
		if (scene->springs[k].b == id)
			rb_set_add(l, l->model->index_of[scene->springs[k].a]);
	}
}

static int by_pair(const void *left, const void *right)
{
	const struct rb_meet *x = left, *y = right;

	if (x->a != y->a)
		return x->a < y->a ? -1 : 1;
	return (x->b > y->b) - (x->b < y->b);
}

int rb_set_grow(struct rb_located *l, double t, double slack, rb_set_joins *joins,
                struct rb_meet **found)
{
	struct pairs pairs = {.t = t, .slack = slack, .joins = joins};

	for (int k = 0; k < l->set_count && !pairs.failed; k++) {
		const int i = l->set[k];

		if (l->cluster_of[i] >= 0) {
			const struct rb_cluster *c = &l->cluster[l->cluster_of[i]];

			for (int m = 0; m < c->member_count; m++)
				rb_set_add(l, c->member[m]);
		}
		add_springs(l, i);
		if (!(l->model->features & RB_FEATURE_CONTACT))
			continue;
		const int near = rb_set_near(l, i);
		for (int m = 0; m < near; m++) {
			const int j = l->near[m];

			/* each pair once: from the one that came into the set first */
			if (rb_located_driven(l, j) || l->place[j] < 0 || l->place[j] > k)
				look(l, &pairs, i, j);
		}
		for (int j = l->n; j < l->n + l->model->static_count; j++)
			look(l, &pairs, i, j);
	}
	if (pairs.failed)
		return -1;
	if (pairs.count > 1)
		qsort(pairs.row, (size_t)pairs.count, sizeof *pairs.row, by_pair);
	*found = pairs.row;
	return pairs.count;
}
