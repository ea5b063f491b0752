/* SPDX-License-Identifier: MIT */
#include "located/crowd.h"

#include <math.h>

#include "base/forest.h"
#include "model/parts.h"
#include "world/joint_state.h"

/*
 * Limits of work, in bodies, beyond what time allows. For a crowd: CROWD_BODY for each of its
 * bodies, CROWD_MORE, and shares that shrink with the number of bodies in the crowd and in the
 * world. A box that rocks takes 195 on its own, which is a fiftieth of a second, one that tips over
 * an edge 101, three that slide on each other 84, and twenty-six rollers that begin to slip
 * together 87 of 120; above that, steps would cost less. For the world: those of some crowds.
 */
enum { CROWD_BODY = 4, CROWD_MORE = 8, CROWD_SHARE = 128, FEW_SHARE = 128 };
enum { WORLD_BODY = 2, WORLD_MORE = 256 };

uint64_t rb_crowd_world_max(const struct rb_located *l)
{
	return rb_crowd_limit_factor(l) * (WORLD_BODY * (uint64_t)l->n + WORLD_MORE);
}

static uint64_t crowd_max(const struct rb_located *l, int bodies)
{
	return rb_crowd_limit_factor(l) *
	       (CROWD_BODY * (uint64_t)bodies + CROWD_MORE + CROWD_SHARE / (uint64_t)bodies +
	        FEW_SHARE / (uint64_t)l->n);
}

/* True if the body has a rim, on which a search finds the nearest point. */
static bool has_rim(const struct rb_body_parts *parts)
{
	for (int k = 0; k < parts->count && !parts->terrain; k++)
		if (parts->part[k].core.kind == RB_CORE_CYLINDER)
			return true;
	return false;
}

uint64_t rb_crowd_inspection(const struct rb_located *l, int i, int j, int facets)
{
	enum { SOLIDS = 3, RIMS = 10 };
	const struct rb_body_parts *const a = rb_model_parts(l->model, i);
	const struct rb_body_parts *const b = rb_model_parts(l->model, j);
	const int of_b = b->terrain ? facets : b->count;
	const uint64_t all = RB_LOCATED_SEARCH * (uint64_t)a->count * (uint64_t)of_b;

	if (a->part[0].core.kind == RB_CORE_HALF_SPACE ||
	    b->part[0].core.kind == RB_CORE_HALF_SPACE)
		return all;
	return all * (has_rim(a) || has_rim(b) ? RIMS : SOLIDS);
}

/* ---- steps ---- */

/*
 * Cost of a step of a body, and of one at rest, in products. Whether a body is asleep, which makes
 * its step cheap, is not saved with the state, so nothing may depend on it.
 */
enum { STEP_WORK = RB_LOCATED_PRODUCTS / RB_LOCATED_BODY_STEPS, IDLE_WORK = STEP_WORK / 32 };

static bool is_idle(const struct rb_state *state, int i)
{
	const rb_vec3 none = {0, 0, 0};

	return rb_vec3_max_abs(rb_world_row3(state->velocity, i)) == 0 &&
	       rb_vec3_max_abs(state->spin ? rb_world_row3(state->spin, i) : none) == 0;
}

/* True if the joint's bodies do not move or are static. */
static bool is_idle_joint(const struct rb_located *l, const struct rb_joint *joint)
{
	const struct rb_state *const state = &l->world->state;

	return (joint->a >= l->n || is_idle(state, joint->a)) &&
	       (joint->b < 0 || joint->b >= l->n || is_idle(state, joint->b));
}

void rb_crowd_count_step(const struct rb_located *l, const struct rb_counts *before, double dt_s)
{
	const struct rb_counts *now = &l->world->frame_counts;
	const int joint_count = l->model->joints ? l->model->joints->count : 0;
	uint64_t moved = now->body_steps - before->body_steps + now->discarded_body_steps -
	                 before->discarded_body_steps;
	uint64_t idle = 0;

	for (int i = 0; i < l->n; i++)
		idle += is_idle(&l->world->state, i);
	/* solving a joint takes about as long as a body */
	for (int k = 0; k < joint_count; k++) {
		if (l->world->joint[k].released)
			continue;
		moved++;
		idle += is_idle_joint(l, &l->model->joints->joint[k]);
	}
	l->world->dense_body_steps += moved;
	l->world->dense_s += dt_s;
	moved -= idle < moved ? idle : moved;
	l->world->dense_work += STEP_WORK * moved + IDLE_WORK * idle + now->solving -
	                        before->solving;
}

double rb_crowd_stepped_pace(const struct rb_located *l)
{
	const double bodies = (double)l->world->dense_body_steps / RB_LOCATED_BODY_STEPS;

	return l->world->dense_s > 0 ? bodies / l->world->dense_s : (double)INFINITY;
}

/* The next attempt may take 1/ATTEMPT_SHARE of the work of steps. */
enum { ATTEMPT_SHARE = 8 };

/*
 * Lower limit of an attempt, in bodies: few bodies may take more than their steps allow, which is
 * little.
 */
static uint64_t attempt_least(const struct rb_located *l)
{
	return l->n > 32 ? (uint64_t)l->n : 32;
}

/* Limit of an attempt after these steps, in bodies. */
static uint64_t attempt_next(const struct rb_located *l)
{
	return l->world->dense_work / (ATTEMPT_SHARE * (uint64_t)RB_LOCATED_PRODUCTS);
}

/* A group of bodies connected by contacts. */
struct group {
	int contacts;
	bool moves;
};

/* Connects bodies in contact; counts the contacts of each group at its root. */
static void gather_groups(const struct rb_located *l, int *parent, struct group *group)
{
	const struct rb_contacts *const contacts = &l->world->contacts;

	for (int i = 0; i < l->n; i++) {
		parent[i] = i;
		group[i] = (struct group){0};
	}
	for (size_t k = 0; k < contacts->count; k++) {
		const int a = contacts->row[k].a, b = contacts->row[k].b;

		if (!rb_located_fixed(l, a) && !rb_located_fixed(l, b))
			rb_forest_join(parent, a, b, false);
	}
	for (size_t k = 0; k < contacts->count; k++) {
		const int a = contacts->row[k].a, b = contacts->row[k].b;
		const int i = rb_located_fixed(l, a) ? b : a;

		if (!rb_located_fixed(l, i))
			group[rb_forest_root(parent, i)].contacts++;
	}
	for (int i = 0; i < l->n; i++)
		if (!is_idle(&l->world->state, i))
			group[rb_forest_root(parent, i)].moves = true;
}

/*
 * Lower bound of the cost of all groups' forces, with which an attempt begins, in bodies; 0 if
 * there is no memory to compute it.
 */
static uint64_t forces_cost(const struct rb_located *l)
{
	struct rb_arena *const arena = l->arena;
	const rb_arena_mark here = rb_arena_here(arena);
	int *const parent = rb_arena_take(arena, (size_t)l->n, sizeof *parent);
	struct group *const group = rb_arena_take(arena, (size_t)l->n, sizeof *group);
	uint64_t sum = 0;

	if (parent && group) {
		gather_groups(l, parent, group);
		for (int i = 0; i < l->n; i++)
			sum += group[i].moves ? rb_located_cost(3.0 * group[i].contacts)
			                      : rb_located_rest_cost(group[i].contacts);
	}
	rb_arena_back(arena, here);
	return sum;
}

bool rb_crowd_may_attempt(const struct rb_located *l)
{
	if (l->world_max == UINT64_MAX)
		return true;
	const uint64_t least = attempt_least(l), next = attempt_next(l);

	return next >= (uint64_t)l->n && forces_cost(l) <= (next > least ? next : least);
}

/* ---- crowds ---- */

static void make_single(struct rb_located *l, int i)
{
	l->crowd_of[i] = (struct rb_crowd_of){.parent = i, .size = 1};
}

void rb_crowd_begin(struct rb_located *l)
{
	const uint64_t paid_for = attempt_next(l), least = attempt_least(l);
	const uint64_t left = paid_for > least ? paid_for : least;
	const bool is_limited = l->world->dense_steps > 0 && l->world_max != UINT64_MAX;

	/* after steps the count starts so high that only what they allow is left */
	l->crowd = is_limited && left < l->world_max ? l->world_max - left : 0;
	l->products = 0;
	l->crowd_max = l->world_max;
	for (int i = 0; i < l->n; i++)
		make_single(l, i);
	l->joined_count = 0;
}

void rb_crowd_end(struct rb_located *l)
{
	for (int k = 0; k < l->joined_count; k++)
		make_single(l, l->joined[k]);
	l->joined_count = 0;
}

static int root_of(struct rb_located *l, int i)
{
	struct rb_crowd_of *const of = l->crowd_of;

	for (; of[i].parent != i; i = of[i].parent)
		of[i].parent = of[of[i].parent].parent;
	return i;
}

bool rb_crowd_complete(struct rb_located *l)
{
	for (int i = 0; i < l->n; i++) {
		if (l->crowd_of[i].parent > i)
			return false;
		l->crowd_of[i].size = 0;
	}
	l->joined_count = 0;
	for (int i = 0; i < l->n; i++)
		l->crowd_of[root_of(l, i)].size++;
	for (int i = 0; i < l->n; i++)
		if (l->crowd_of[i].size != 1)
			l->joined[l->joined_count++] = i;
	return true;
}

void rb_crowd_compress(struct rb_located *l)
{
	for (int i = 0; i < l->n; i++)
		l->crowd_of[i].parent = root_of(l, i);
}

/* The root's crowd, its count reduced by what the elapsed time allows. */
static struct rb_crowd_of *updated(struct rb_located *l, int root)
{
	struct rb_crowd_of *const crowd = &l->crowd_of[root];
	const uint64_t pays = (rb_located_allowed(l, l->now_s) -
	                       rb_located_allowed(l, crowd->paid_s)) *
	                      RB_LOCATED_PRODUCTS;

	crowd->products -= pays < crowd->products ? pays : crowd->products;
	crowd->paid_s = l->now_s;
	return crowd;
}

void rb_crowd_join(struct rb_located *l, int i, int j)
{
	if (l->world_max == UINT64_MAX || rb_located_fixed(l, i) || rb_located_fixed(l, j))
		return;
	const int x = root_of(l, i), y = root_of(l, j);

	if (x == y)
		return;
	struct rb_crowd_of *const root = updated(l, x < y ? x : y), *const leaf = updated(
									    l, x < y ? y : x);

	if (root->size == 1)
		l->joined[l->joined_count++] = root->parent;
	if (leaf->size == 1)
		l->joined[l->joined_count++] = leaf->parent;
	leaf->parent = root->parent;
	root->size += leaf->size;
	root->products += leaf->products;
}

/* True if work of the body's events is counted. */
static bool is_counted(const struct rb_located *l, int i)
{
	return i >= 0 && l->world_max != UINT64_MAX && !rb_located_fixed(l, i);
}

void rb_crowd_limit(struct rb_located *l, int i)
{
	l->crowd_max = l->world_max;
	if (!is_counted(l, i))
		return;
	const struct rb_crowd_of *const crowd = updated(l, root_of(l, i));
	const uint64_t max = crowd_max(l, crowd->size), has = crowd->products / RB_LOCATED_PRODUCTS;
	const uint64_t all = l->event_from / RB_LOCATED_PRODUCTS + (max > has ? max - has : 0);

	l->crowd_max = all < l->world_max ? all : l->world_max;
}

void rb_crowd_event(struct rb_located *l, int i)
{
	l->event_from = rb_located_all_products(l);
	rb_crowd_limit(l, i);
}

void rb_crowd_count(struct rb_located *l, int i)
{
	if (is_counted(l, i))
		updated(l, root_of(l, i))->products += rb_located_all_products(l) - l->event_from;
}
