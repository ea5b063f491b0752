/* SPDX-License-Identifier: MIT */
/*
 * Maximum spanning forest of the step's contacts by impulse: in a tree each contact transmits the
 * sum of all changes beyond it, and nothing has to be solved.
 */
#include "stepped/projection_impulses.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "base/memory.h"

/* A contact of the tree; `next`: next edge of either end, index into `edge`. */
struct edge {
	size_t point;
	int end[2], next[2];
	double impulse; /* N s, along the normal */
	bool done;
};

struct tree {
	struct edge *edge;
	int count;
	int *parent; /* [bodies + 1]: union-find; the last one: all that are not dynamic */
	int *first;  /* [bodies + 1]: first edge, -1: none */
	int *degree; /* [bodies + 1]: edges left */
};

static int node_of(const struct rb_world *world, int i)
{
	return rb_stepped_is_dynamic(world, i) ? i : world->model->body_count;
}

/* The largest impulse first, then in the order of points. */
static int by_impulse(const void *left, const void *right)
{
	const struct edge *x = left, *y = right;

	if (x->impulse != y->impulse)
		return x->impulse > y->impulse ? -1 : 1;
	return (x->point > y->point) - (x->point < y->point);
}

/* Total impulse of a point on b, N s, without that by projection. */
static rb_vec3 impulse_of(const struct rb_cohort *cohort, size_t k)
{
	const struct rb_step_point *point = &cohort->points.row[k];

	return rb_vec3_add(
		rb_vec3_add_scaled(point->friction_impulse, point->normal_impulse, point->normal),
		rb_cohort_rebound(cohort, k));
}

/*
 * Part of an impulse within the friction cone. In a part of a step (`friction` INFINITY) only its
 * normal part is limited, along the normal at the end of the part: reported contacts of parts are
 * means over several normals.
 */
static rb_vec3 within_cone(double friction, rb_vec3 normal, rb_vec3 impulse)
{
	const double along = fmax(0, rb_vec3_dot(impulse, normal));
	const rb_vec3 across = rb_vec3_reject(impulse, normal);
	const double max = isinf(friction) ? friction : friction * along;

	return rb_vec3_add_scaled(rb_constraint_within(across, max), along, normal);
}

static void list_edges(const struct rb_world *world, const struct rb_cohort *cohort,
                       struct tree *tree)
{
	tree->count = 0;
	for (size_t k = 0; k < cohort->points.count; k++) {
		const struct rb_step_point *point = &cohort->points.row[k];
		const double impulse = rb_vec3_dot(impulse_of(cohort, k), point->normal);

		if (impulse > 0)
			tree->edge[tree->count++] = (struct edge){
				.point = k,
				.end = {point->a, node_of(world, point->b)},
				.impulse = impulse};
	}
	if (tree->count > 1)
		qsort(tree->edge, (size_t)tree->count, sizeof *tree->edge, by_impulse);
}

/* Kruskal's algorithm: keeps edges that connect two trees, the largest first. */
static void span(struct tree *tree, int nodes)
{
	int kept = 0;

	for (int i = 0; i < nodes; i++) {
		tree->parent[i] = i;
		tree->first[i] = -1;
		tree->degree[i] = 0;
	}
	for (int k = 0; k < tree->count; k++) {
		struct edge edge = tree->edge[k];

		if (rb_forest_root(tree->parent, edge.end[0]) ==
		    rb_forest_root(tree->parent, edge.end[1]))
			continue;
		rb_forest_join(tree->parent, edge.end[0], edge.end[1], false);
		for (int e = 0; e < 2; e++) {
			edge.next[e] = tree->first[edge.end[e]];
			tree->first[edge.end[e]] = kept;
			tree->degree[edge.end[e]]++;
		}
		tree->edge[kept++] = edge;
	}
	tree->count = kept;
}

/* The remaining edge of a leaf. */
static struct edge *edge_of(const struct tree *tree, int i)
{
	int k = tree->first[i];

	while (tree->edge[k].done)
		k = tree->edge[k].next[tree->edge[k].end[0] == i ? 0 : 1];
	return &tree->edge[k];
}

/* From the leaves inwards, transmits the change of each body's momentum. */
static void pass_on(const struct rb_world *world, const struct tree *tree, struct rb_cohort *cohort,
                    int i, rb_vec3 *owed)
{
	const int ground = world->model->body_count;
	const bool whole = cohort->candidates->h_s >= world->stepped->solver.whole_s;

	while (i != ground && tree->degree[i] == 1) {
		struct edge *const edge = edge_of(tree, i);
		const bool is_a = edge->end[0] == i;
		const int other = edge->end[is_a];
		const struct rb_step_point *point = &cohort->points.row[edge->point];
		const rb_vec3 now = impulse_of(cohort, edge->point);
		const rb_vec3 on_b = is_a ? rb_vec3_neg(owed[i]) : owed[i];
		/* an impact has the normal of its moment */
		const bool strict = whole || point->approach > world->stepped->solver.tolerance;
		const double friction = strict ? point->material->friction : (double)INFINITY;
		const rb_vec3 share = rb_vec3_sub(
			within_cone(friction, point->normal, rb_vec3_add(now, on_b)),
			within_cone(friction, point->normal, now));

		edge->done = true;
		tree->degree[i] = 0;
		tree->degree[other]--;
		cohort->closing_impulse[edge->point] = share;
		if (other != ground)
			owed[other] = rb_vec3_add_scaled(owed[other], is_a ? -1 : 1, share);
		i = other;
	}
}

enum rb_status rb_projection_impulses(struct rb_world *world, struct rb_cohort *cohort,
                                      rb_vec3 *owed, struct rb_error *err)
{
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	const size_t count = cohort->points.count;
	const int ground = world->model->body_count;
	const size_t nodes = (size_t)ground + 1;
	struct tree tree = {.edge = rb_arena_take(arena, count + 1, sizeof *tree.edge),
	                    .parent = rb_arena_take(arena, nodes, sizeof *tree.parent),
	                    .first = rb_arena_take(arena, nodes, sizeof *tree.first),
	                    .degree = rb_arena_take(arena, nodes, sizeof *tree.degree)};
	const bool good = tree.edge && tree.parent && tree.first && tree.degree &&
	                  rb_memory_reserve(&cohort->closing_impulse,
	                                    &cohort->closing_impulse_capacity, count + 1,
	                                    sizeof *cohort->closing_impulse);

	if (!good) {
		rb_arena_back(arena, here);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	}
	memset(cohort->closing_impulse, 0, (count + 1) * sizeof *cohort->closing_impulse);
	cohort->has_closing_impulses = true;
	list_edges(world, cohort, &tree);
	span(&tree, (int)nodes);
	for (int i = 0; i < ground; i++)
		pass_on(world, &tree, cohort, i, owed);
	rb_arena_back(arena, here);
	return RB_OK;
}
