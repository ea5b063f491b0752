/* SPDX-License-Identifier: MIT */
/*
 * Groups of bodies that may meet within a step: each body gets a box that its origin should not
 * leave, overlaps of the boxes are found by the broad phase, and union-find joins them to groups.
 * As long as all stay in their boxes, groups are independent and can take different substeps; that
 * is checked afterwards (rb_swept_bounds_left), not assumed.
 *
 * The root of a group is its smallest body, and groups are numbered in that order, so that
 * numbering does not depend on the order of pairs.
 */
#include "stepped/swept_bounds.h"

#include "base/forest.h"
#include "base/memory.h"

/*
 * Padding of a box as a share of the body's size: an eighth. Less makes bodies leave their boxes
 * more often, and each time the group starts again; more joins groups that would not meet.
 */
static const double clearance_share = 0.125;

enum rb_status rb_swept_bounds_create(struct rb_swept_bounds *swept, const struct rb_model *model,
                                      struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	*swept = (struct rb_swept_bounds){0};
	swept->bounds = rb_memory_take(n, sizeof *swept->bounds);
	swept->group_of = rb_memory_take(n, sizeof *swept->group_of);
	swept->was_group = rb_memory_take(n, sizeof *swept->was_group);
	swept->parent = rb_memory_take(n, sizeof *swept->parent);
	swept->member = rb_memory_take(n, sizeof *swept->member);
	swept->failed = rb_memory_take(n, 1);
	swept->finished = rb_memory_take(n, 1);
	if (!swept->bounds || !swept->group_of || !swept->was_group || !swept->parent ||
	    !swept->member || !swept->failed || !swept->finished)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the territories of %zu bodies",
		               n);
	return rb_candidates_create(&swept->candidates, model, err);
}

void rb_swept_bounds_release(struct rb_swept_bounds *swept)
{
	rb_candidates_release(&swept->candidates);
	rb_memory_free(swept->bounds);
	rb_memory_free(swept->group_of);
	rb_memory_free(swept->was_group);
	rb_memory_free(swept->parent);
	rb_memory_free(swept->member);
	rb_memory_free(swept->failed);
	rb_memory_free(swept->finished);
	rb_memory_free(swept->group);
	rb_memory_free(swept->pair);
	*swept = (struct rb_swept_bounds){0};
}

void rb_swept_bounds_discard(const struct rb_swept_bounds *swept, size_t bytes)
{
	const struct rb_candidates *const candidates = &swept->candidates;
	void *const list[] = {swept->group,
	                      swept->pair,
	                      candidates->own,
	                      candidates->own_depth,
	                      candidates->own_clearance,
	                      candidates->own_first_cache,
	                      candidates->cache};

	for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
		rb_memory_discard(list[k], bytes);
}

/* ---- boxes ---- */

static rb_vec3 lower(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)};
}

static rb_vec3 upper(rb_vec3 a, rb_vec3 b)
{
	return (rb_vec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
}

/* Bounding box of the segment, grown by pad m to all sides. */
static rb_aabb box_of_path(rb_vec3 from, rb_vec3 to, double pad)
{
	const rb_vec3 all = {pad, pad, pad};

	return (rb_aabb){rb_vec3_sub(lower(from, to), all), rb_vec3_add(upper(from, to), all)};
}

static bool is_inside(const rb_aabb *box, rb_vec3 p)
{
	return p.x >= box->low.x && p.y >= box->low.y && p.z >= box->low.z && p.x <= box->high.x &&
	       p.y <= box->high.y && p.z <= box->high.z;
}

/*
 * After an impact the path has a kink: the body first moved with its old velocity. `shift` bounds
 * the distance between the two straight paths at the kink.
 */
static void add_kink(rb_aabb *bounds, rb_vec3 from, const struct rb_kick *kick,
                     rb_vec3 displacement, double pad)
{
	const double pads = pad + rb_vec3_length(kick->shift);
	const rb_aabb more = box_of_path(from, rb_vec3_add(from, displacement), pads);

	*bounds = (rb_aabb){lower(bounds->low, more.low), upper(bounds->high, more.high)};
}

void rb_swept_bounds_set(struct rb_swept_bounds *swept, const struct rb_world *world,
                         const struct rb_state *begin, double dt)
{
	const struct rb_stepped *s = world->stepped;

	for (int i = 0; i < world->model->body_count; i++) {
		const rb_vec3 from = rb_world_origin_at(world, begin, i);
		const rb_vec3 displacement = rb_vec3_scale(dt, rb_world_row3(begin->velocity, i));
		const double reach = world->broadphase ? s->candidates.reach[i] : 0;
		const double slack = clearance_share * rb_candidates_size(world->model, i);

		swept->candidates.built_at[i] = from;
		/* what forces add within the step is in the reach */
		swept->bounds[i] =
			s->bad[i]
				? box_of_path(from, rb_vec3_add(from, displacement),
		                              slack + fmax(0, reach - rb_vec3_length(displacement)))
				: box_of_path(from, rb_world_origin_at(world, &world->state, i),
		                              slack);
		if (rb_kicks_have(&s->kicks, i))
			add_kink(&swept->bounds[i], from, rb_kick_of(&s->kicks, i), displacement,
			         slack);
	}
}

/* ---- groups ---- */

/* Union of the groups of two dynamic bodies; a driven or static body joins nobody. */
static void join_bodies(const struct rb_world *world, int *parent, int a, int b)
{
	if (!rb_stepped_is_dynamic(world, a) || !rb_stepped_is_dynamic(world, b))
		return;
	a = rb_forest_root(parent, a);
	b = rb_forest_root(parent, b);
	parent[a > b ? a : b] = a > b ? b : a;
}

/*
 * Groups in order of their smallest body, members ascending (counting sort). A group stays finished
 * only if all of its members were finished as one group.
 */
static enum rb_status number_groups(struct rb_swept_bounds *swept, const struct rb_world *world,
                                    struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;
	int at = 0;

	swept->group_count = 0;
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k], root = rb_forest_root(swept->parent, i);

		if (root == i) {
			if (!rb_memory_reserve(&swept->group, &swept->group_capacity,
			                       swept->group_count + 1, sizeof *swept->group))
				return RB_FAIL(err, RB_ERR_MEMORY, "no memory for groups");
			swept->group_of[i] = (int)swept->group_count;
			swept->group[swept->group_count++] = (struct rb_swept_group){
				.finished = true};
		}
		swept->group_of[i] = swept->group_of[root];
		swept->group[swept->group_of[i]].count++;
	}
	for (size_t g = 0; g < swept->group_count; g++) {
		swept->group[g].first = at;
		at += swept->group[g].count;
		swept->group[g].count = 0;
	}
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k];
		struct rb_swept_group *group = &swept->group[swept->group_of[i]];

		swept->member[group->first + group->count++] = i;
		group->failed = group->failed || swept->failed[i];
		group->finished = group->finished && swept->finished[i] &&
		                  swept->was_group[i] ==
		                          swept->was_group[swept->member[group->first]];
	}
	return RB_OK;
}

/*
 * Counting sort of candidate pairs by group; stable, so that the order within a group does not
 * depend on other groups.
 */
static enum rb_status sort_pairs(struct rb_swept_bounds *swept, const struct rb_model *model,
                                 struct rb_error *err)
{
	struct rb_candidates *candidates = &swept->candidates;
	size_t at = 0;

	if (!rb_memory_reserve(&swept->pair, &swept->pair_capacity, candidates->pair_count + 1,
	                       sizeof *swept->pair))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++)
		swept->group[swept->group_of[candidates->pair[k].a]].pair_count++;
	for (size_t g = 0; g < swept->group_count; g++) {
		swept->group[g].pair = at;
		at += swept->group[g].pair_count;
		swept->group[g].pair_count = 0;
	}
	swept->pair_count = candidates->pair_count;
	for (size_t k = 0; k < candidates->pair_count; k++) {
		struct rb_swept_group *group =
			&swept->group[swept->group_of[candidates->pair[k].a]];

		swept->pair[group->pair + group->pair_count++] = candidates->pair[k];
	}
	candidates->pair = swept->pair;
	return rb_candidates_forget(candidates, model, err);
}

void rb_swept_bounds_restrict(struct rb_swept_bounds *swept, size_t first, size_t count)
{
	struct rb_candidates *candidates = &swept->candidates;

	candidates->pair = swept->pair + first;
	candidates->pair_count = count;
	candidates->depth = candidates->own_depth + first;
	if (candidates->own_clearance)
		candidates->clearance = candidates->own_clearance + first;
	if (candidates->own_first_cache)
		candidates->first_cache = candidates->own_first_cache + first;
}

/*
 * Joins bodies that exchanged an impulse in the attempt of all: they go back together, or momentum
 * would be lost. By linearization of rotation such bodies may have boxes that do not overlap.
 */
static void join_impulses(struct rb_swept_bounds *swept, const struct rb_world *world)
{
	const struct rb_cohort *const all = &world->stepped->all;

	for (size_t k = 0; k < all->points.count; k++)
		if (all->points.row[k].normal_impulse > 0 ||
		    rb_vec3_max_abs(rb_cohort_rebound(all, k)) > 0)
			join_bodies(world, swept->parent, all->points.row[k].a,
			            all->points.row[k].b);
	for (size_t k = 0; k < all->impact_count; k++)
		if (!all->impact[k].crowded)
			join_bodies(world, swept->parent, all->impact[k].a, all->impact[k].b);
	for (size_t k = 0; k < all->transmitted.count; k++)
		join_bodies(world, swept->parent, all->transmitted.row[k].a,
		            all->transmitted.row[k].b);
}

enum rb_status rb_swept_bounds_form(struct rb_swept_bounds *swept, struct rb_world *world,
                                    struct rb_error *err)
{
	const struct rb_model *model = world->model;
	enum rb_status status = RB_OK;

	swept->candidates.pair_count = 0;
	if (world->broadphase)
		status = rb_candidates_pairs(&swept->candidates, world, swept->bounds, err);
	if (status != RB_OK)
		return status;
	for (int i = 0; i < model->body_count; i++)
		swept->parent[i] = i;
	for (size_t k = 0; k < swept->candidates.pair_count; k++)
		join_bodies(world, swept->parent, swept->candidates.pair[k].a,
		            swept->candidates.pair[k].b);
	join_impulses(swept, world);
	for (int k = 0; k < model->element_list_count; k++)
		for (int m = 0; model->elements[k].end && m < model->elements[k].count; m++)
			join_bodies(world, swept->parent, model->elements[k].end[m][0],
			            model->elements[k].end[m][1]);
	for (int k = 0; model->joints && k < model->joints->count; k++)
		if (model->joints->joint[k].b >= 0)
			join_bodies(world, swept->parent, model->joints->joint[k].a,
			            model->joints->joint[k].b);
	status = number_groups(swept, world, err);
	return status == RB_OK ? sort_pairs(swept, model, err) : status;
}

bool rb_swept_bounds_left(struct rb_swept_bounds *swept, const struct rb_world *world,
                          const struct rb_cohort *part, double rest_s)
{
	bool left = false;

	for (int k = 0; k < part->body_count; k++) {
		const int i = part->body[k];
		const rb_vec3 at = rb_world_origin_at(world, &world->state, i);
		rb_aabb *const bounds = &swept->bounds[i];

		if (is_inside(bounds, at))
			continue;
		const rb_vec3 displacement = rb_vec3_scale(fmax(0, rest_s),
		                                           rb_world_row3(world->state.velocity, i));
		const rb_vec3 from = swept->candidates.built_at[i];
		const rb_aabb more = box_of_path(at, rb_vec3_add(at, displacement),
		                                 clearance_share *
		                                         (rb_candidates_size(world->model, i) +
		                                          rb_vec3_length(rb_vec3_sub(at, from)) +
		                                          rb_vec3_length(displacement)));
		*bounds = (rb_aabb){lower(bounds->low, more.low), upper(bounds->high, more.high)};
		left = true;
	}
	return left;
}
