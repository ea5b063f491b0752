/* SPDX-License-Identifier: MIT */
/*
 * Connected components of the graph of pairs within reach, by union-find with the smallest body as
 * root, which makes groups and their order independent of the order of pairs. Candidates come from
 * fat boxes (Verlet lists) that hold for several steps; the exact reach is tested in each step.
 *
 * Speculation is verified afterwards: a body that came out of an impact faster than predicted is
 * tested against what its real path could have met, and groups that met are merged and run again. A
 * group never sees another one's rows, so the result does not depend on which ran first.
 */
#include "classic/groups.h"

#include "base/error.h"
#include "base/forest.h"
#include "base/memory.h"
#include "base/sort.h"
#include "step/force_stages.h"
#include "step/gap.h"

/* Steps that a fat box is meant to last; it affects the cost only. */
enum { STEPS_PER_BOX = 8 };

enum rb_status rb_groups_create(struct rb_groups **made, const struct rb_model *model,
                                struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;
	struct rb_groups *groups = rb_memory_take(1, sizeof *groups);

	*made = NULL;
	if (!groups)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of %zu bodies", n);
	groups->body_count = model->body_count;
	groups->member_capacity = 2 * n + 1;
	groups->built_at = rb_memory_take(n, sizeof *groups->built_at);
	groups->margin = rb_memory_take(n, sizeof *groups->margin);
	groups->reach = rb_memory_take(n, sizeof *groups->reach);
	groups->travelled = rb_memory_take(n, sizeof *groups->travelled);
	groups->held = rb_memory_take(n, sizeof *groups->held);
	groups->parent = rb_memory_take(n, sizeof *groups->parent);
	groups->group_of = rb_memory_take(n, sizeof *groups->group_of);
	groups->box = rb_memory_take(n, sizeof *groups->box);
	groups->acceleration = rb_memory_take(n, sizeof *groups->acceleration);
	groups->alone = rb_memory_take(n, sizeof *groups->alone);
	groups->member = rb_memory_take(groups->member_capacity, sizeof *groups->member);
	if (!groups->built_at || !groups->margin || !groups->reach || !groups->travelled ||
	    !groups->held || !groups->parent || !groups->group_of || !groups->box ||
	    !groups->acceleration || !groups->alone || !groups->member) {
		rb_groups_destroy(groups);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of %zu bodies", n);
	}
	*made = groups;
	return RB_OK;
}

void rb_groups_destroy(struct rb_groups *groups)
{
	if (!groups)
		return;
	rb_memory_free(groups->built_at);
	rb_memory_free(groups->margin);
	rb_memory_free(groups->reach);
	rb_memory_free(groups->travelled);
	rb_memory_free(groups->held);
	rb_memory_free(groups->parent);
	rb_memory_free(groups->group_of);
	rb_memory_free(groups->box);
	rb_memory_free(groups->acceleration);
	rb_memory_free(groups->alone);
	rb_memory_free(groups->member);
	rb_memory_free(groups->group);
	rb_memory_free(groups->touch);
	rb_memory_free(groups->active);
	rb_memory_free(groups->missed);
	rb_memory_free(groups);
}

void rb_groups_forget(struct rb_groups *groups)
{
	groups->valid = false;
}

/*
 * Bound on the distance that a shape's centre moves in `time` without impacts, m; an eccentric
 * shape also swings about its centre of mass, at most by the diameter 2 arm.
 */
static double distance_in(const struct rb_world *world, int i, double acceleration, double time)
{
	const struct rb_model *model = world->model;
	double distance = (rb_vec3_length(rb_world_row3(world->state.velocity, i)) +
	                   acceleration * time) *
	                  time;

	if (model->center_of_mass) {
		const double arm = rb_vec3_length(model->center_of_mass[i]);
		const double turn = rb_vec3_length(rb_world_row3(world->state.spin, i)) * time;

		const bool twisted = world->state.twist &&
		                     rb_vec3_max_abs(rb_world_row3(world->state.twist, i)) > 0;

		distance += arm * (acceleration > 0 || twisted ? 2 : fmin(turn, 2));
	}
	return distance;
}

/*
 * Reach of each body in this step; a body that could leave its fat box invalidates the candidates.
 */
static void find_reaches(struct rb_world *world, double dt)
{
	struct rb_groups *groups = world->groups;

	for (int i = 0; i < groups->body_count; i++) {
		groups->acceleration[i] = rb_forces_bound(world, i);
		groups->reach[i] = distance_in(world, i, groups->acceleration[i], dt);
		groups->travelled[i] = 0;
		if (groups->valid) {
			const rb_vec3 moved = rb_vec3_sub(
				rb_world_origin_at(world, &world->state, i), groups->built_at[i]);

			/* NaN asks for new boxes */
			if (!(rb_vec3_length(moved) + groups->reach[i] <= groups->margin[i]))
				groups->valid = false;
		}
	}
}

/* New fat boxes and the candidate pairs of the broadphase. */
static enum rb_status find_candidates(struct rb_world *world, double dt, struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	const struct rb_model *model = world->model;
	const double span = STEPS_PER_BOX * dt;
	double mean_speed = 0;

	for (int i = 0; i < groups->body_count; i++)
		mean_speed += rb_vec3_length(rb_world_row3(world->state.velocity, i)) /
		              groups->body_count;
	for (int i = 0; i < groups->body_count; i++) {
		const rb_vec3 c = rb_world_origin_at(world, &world->state, i);
		const double size = rb_model_reach(model, i);

		groups->built_at[i] = c;
		/* at least the mean speed: a body at rest may be hit; and a share of its size */
		groups->margin[i] = fmax(distance_in(world, i, groups->acceleration[i], span),
		                         mean_speed * span) +
		                    size / 64;
		/* boxes include the tolerance, within which bodies count as touching */
		const double half = (size + groups->margin[i] + model->tolerance_m) * (1 + 1e-12);
		groups->box[i] = (rb_aabb){{c.x - half, c.y - half, c.z - half},
		                           {c.x + half, c.y + half, c.z + half}};
	}
	groups->valid = true;
	return rb_broadphase_find(world->broadphase, groups->box, &groups->candidate,
	                          &groups->candidate_count, err);
}

/*
 * True if the two could touch when their centres approach by `reach` from where they are in
 * `state`. NaN counts as true.
 */
static bool in_reach(const struct rb_world *world, const struct rb_state *state,
                     struct rb_pair pair, double reach)
{
	RB_ASSERT_COSTLY(pair.a >= 0 && pair.a < pair.b && pair.a < world->model->body_count);

	const struct rb_model *model = world->model;
	const double slack = reach + model->tolerance_m;

	if (pair.b < model->body_count) {
		/* the common case without a square root */
		const rb_vec3 d = rb_vec3_sub(rb_world_origin_at(world, state, pair.b),
		                              rb_world_origin_at(world, state, pair.a));
		const double max = (model->shape[pair.a].radius + model->shape[pair.b].radius +
		                    slack) *
		                   (1 + 1e-15);

		return !(rb_vec3_dot(d, d) > max * max);
	}
	return !(rb_gap_of(world, state, pair.a, pair.b).gap > slack);
}

/* Sum of a column over the moving bodies of a pair. */
static double pair_reach(const struct rb_groups *groups, const double *column, struct rb_pair pair)
{
	return column[pair.a] + (pair.b < groups->body_count ? column[pair.b] : 0);
}

/*
 * Joins two components; the smaller body stays the root, so that a group's place does not depend on
 * the order of joining.
 */
static void join(int *parent, int a, int b)
{
	a = rb_forest_root(parent, a);
	b = rb_forest_root(parent, b);
	if (a < b)
		parent[b] = a;
	else
		parent[a] = b;
}

/* Appends to a growing list; false when memory is out. */
static bool append_pair(struct rb_pair **list, size_t *count, size_t *capacity, struct rb_pair pair)
{
	if (!rb_memory_reserve(list, capacity, *count + 1, sizeof **list))
		return false;
	(*list)[(*count)++] = pair;
	return true;
}

/*
 * Pairs within reach and the components they make, in two passes: within reach of the bodies' own
 * motion, then with the largest reach of each component, since an impact may hand on its speed.
 */
static bool find_active(struct rb_world *world)
{
	struct rb_groups *groups = world->groups;
	const bool global = world->model->rollback == RB_ROLLBACK_GLOBAL;

	for (int i = 0; i < groups->body_count; i++)
		groups->parent[i] = global ? 0 : i;
	for (size_t k = 0; k < groups->candidate_count; k++) {
		const struct rb_pair pair = groups->candidate[k];

		if (pair.b < groups->body_count &&
		    in_reach(world, &world->state, pair, pair_reach(groups, groups->reach, pair)))
			join(groups->parent, pair.a, pair.b);
	}
	for (int i = 0; i < groups->body_count; i++) {
		const int root = rb_forest_root(groups->parent, i);

		groups->reach[root] = fmax(groups->reach[root], groups->reach[i]);
	}
	for (int i = 0; i < groups->body_count; i++)
		groups->reach[i] = groups->reach[rb_forest_root(groups->parent, i)];
	groups->active_count = 0;
	for (size_t k = 0; k < groups->candidate_count; k++) {
		const struct rb_pair pair = groups->candidate[k];

		if (!in_reach(world, &world->state, pair, pair_reach(groups, groups->reach, pair)))
			continue;
		if (!append_pair(&groups->active, &groups->active_count, &groups->active_capacity,
		                 pair))
			return false;
		if (pair.b < groups->body_count)
			join(groups->parent, pair.a, pair.b);
	}
	return true;
}

/* Appends an empty group with that root. */
static bool add_group(struct rb_groups *groups, int root)
{
	if (!rb_memory_reserve(&groups->group, &groups->group_capacity, groups->group_count + 1,
	                       sizeof *groups->group))
		return false;
	groups->group[groups->group_count] = (struct rb_group){0};
	groups->group_of[root] = (int)groups->group_count++;
	return true;
}

/*
 * Counting sort of members and pairs by group, for groups from `first` on: each group's are
 * contiguous and in order.
 */
static bool lay_out(struct rb_groups *groups, size_t first, const struct rb_pair *pair,
                    size_t pair_count)
{
	if (!rb_memory_reserve(&groups->touch, &groups->touch_capacity,
	                       groups->touch_count + pair_count, sizeof *groups->touch))
		return false;
	for (size_t g = 0; g < first; g++) { /* reallocation may have moved the lists */
		groups->group[g].pass.touch = groups->touch + groups->group[g].touch_first;
		groups->group[g].pass.member = groups->member + groups->group[g].member_first;
	}
	for (size_t k = 0; k < pair_count; k++)
		if (groups->group_of[pair[k].a] >= (int)first)
			groups->group[groups->group_of[pair[k].a]].touch_count++;
	for (size_t g = first; g < groups->group_count; g++) {
		struct rb_group *group = &groups->group[g];

		group->member_first = (int)groups->member_count;
		group->touch_first = (int)groups->touch_count;
		groups->member_count += (size_t)group->member_count;
		groups->touch_count += (size_t)group->touch_count;
		group->member_count = group->touch_count = 0;
	}
	for (int i = 0; i < groups->body_count; i++)
		if (groups->group_of[i] >= (int)first) {
			struct rb_group *group = &groups->group[groups->group_of[i]];

			groups->member[group->member_first + group->member_count++] = i;
		}
	for (size_t k = 0; k < pair_count; k++)
		if (groups->group_of[pair[k].a] >= (int)first) {
			struct rb_group *group = &groups->group[groups->group_of[pair[k].a]];

			groups->touch[group->touch_first + group->touch_count++] =
				(struct rb_touch){.a = pair[k].a, .b = pair[k].b};
		}
	return true;
}

enum rb_status rb_groups_form(struct rb_world *world, double dt, struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	enum rb_status status = RB_OK;
	bool good = true;

	if (!world->broadphase) { /* nobody can meet anybody */
		groups->alone_count = groups->body_count;
		for (int i = 0; i < groups->body_count; i++)
			groups->alone[i] = i;
		return RB_OK;
	}
	find_reaches(world, dt);
	if (!groups->valid)
		status = find_candidates(world, dt, err);
	if (status != RB_OK)
		return status;
	good = find_active(world);
	groups->group_count = groups->touch_count = groups->member_count = 0;
	groups->alone_count = 0;
	for (int i = 0; i < groups->body_count; i++)
		groups->group_of[i] = -1;
	/* a body with a pair is in a group, which its root stands for */
	for (size_t k = 0; good && k < groups->active_count; k++) {
		const int root = rb_forest_root(groups->parent, groups->active[k].a);

		if (groups->group_of[root] < 0)
			groups->group_of[root] = 0;
	}
	if (world->model->rollback == RB_ROLLBACK_GLOBAL && groups->body_count > 0)
		groups->group_of[0] = 0;
	for (int i = 0; good && i < groups->body_count; i++) {
		const int root = rb_forest_root(groups->parent, i);

		if (groups->group_of[root] < 0) {
			groups->alone[groups->alone_count++] = i;
			continue;
		}
		RB_ASSERT_COSTLY(root <= i);
		if (i == root)
			good = add_group(groups, root);
		groups->group_of[i] = groups->group_of[root];
		groups->group[groups->group_of[i]].member_count++;
	}
	if (!good || !lay_out(groups, 0, groups->active, groups->active_count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of a step");
	return RB_OK;
}

/* Binary search among the sorted active pairs. */
static bool has_active(const struct rb_groups *groups, struct rb_pair pair)
{
	size_t low = 0, high = groups->active_count;

	while (low < high) {
		const size_t middle = low + (high - low) / 2;
		const struct rb_pair at = groups->active[middle];

		if (at.a == pair.a && at.b == pair.b)
			return true;
		if (at.a < pair.a || (at.a == pair.a && at.b < pair.b))
			low = middle + 1;
		else
			high = middle;
	}
	return false;
}

/*
 * True if real paths could have brought this pair together and it was not considered in the step.
 */
static bool was_missed(const struct rb_world *world, struct rb_pair pair)
{
	const struct rb_groups *groups = world->groups;
	double reach = fmax(groups->reach[pair.a], groups->travelled[pair.a]);

	if (pair.b < groups->body_count)
		reach += fmax(groups->reach[pair.b], groups->travelled[pair.b]);
	return in_reach(world, &world->start, pair, reach) && !has_active(groups, pair);
}

/* Tests a body that has left its fat box against all others: the candidates do not hold for it. */
static bool find_missed_far(struct rb_world *world, int i)
{
	struct rb_groups *groups = world->groups;
	const struct rb_model *model = world->model;

	for (int j = 0; j < model->body_count + model->static_count; j++) {
		const struct rb_pair pair = {j < i ? j : i, j < i ? i : j};

		if (j == i || (model->group_bit && (!(model->group_bit[i] & model->collides[j]) ||
		                                    !(model->group_bit[j] & model->collides[i]))))
			continue;
		if (was_missed(world, pair) && !append_pair(&groups->missed, &groups->missed_count,
		                                            &groups->missed_capacity, pair))
			return false;
	}
	groups->valid = false;
	return true;
}

/* Lists the pairs to be considered after all; false when memory is out. */
static bool find_missed(struct rb_world *world, bool *any)
{
	struct rb_groups *groups = world->groups;
	bool leavers = false;

	groups->missed_count = 0;
	*any = false;
	if (!world->broadphase)
		return true;
	for (int i = 0; i < groups->body_count; i++) {
		if (!(groups->travelled[i] > 0)) /* a body alone has kept its margin */
			continue;
		leavers = leavers || groups->travelled[i] > groups->reach[i];
		const rb_vec3 start = rb_world_origin_at(world, &world->start, i);
		const double from_built = rb_vec3_length(rb_vec3_sub(start, groups->built_at[i]));

		if (from_built + groups->travelled[i] > groups->margin[i] &&
		    !find_missed_far(world, i))
			return false;
	}
	for (size_t k = 0; leavers && k < groups->candidate_count; k++) {
		const struct rb_pair pair = groups->candidate[k];
		const bool left = groups->travelled[pair.a] > groups->reach[pair.a] ||
		                  (pair.b < groups->body_count &&
		                   groups->travelled[pair.b] > groups->reach[pair.b]);

		if (left && was_missed(world, pair) &&
		    !append_pair(&groups->missed, &groups->missed_count, &groups->missed_capacity,
		                 pair))
			return false;
	}
	*any = groups->missed_count > 0;
	return true;
}

/* Sorts the active pairs and removes duplicates. */
static bool sort_active(struct rb_world *world)
{
	struct rb_groups *groups = world->groups;
	const size_t n = groups->active_count;
	struct rb_arena *arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	struct rb_sort_item *item = rb_arena_take(arena, 2 * n, sizeof *item);

	if (!item)
		return false;
	for (size_t k = 0; k < n; k++)
		item[k].key = (uint64_t)(uint32_t)groups->active[k].a << 32 |
		              (uint32_t)groups->active[k].b;
	rb_sort_by_key(item, item + n, n);
	groups->active_count = 0;
	for (size_t k = 0; k < n; k++)
		if (k == 0 || item[k].key != item[k - 1].key)
			groups->active[groups->active_count++] = (struct rb_pair){
				(int)(item[k].key >> 32), (int)(item[k].key & 0xffffffffu)};
	rb_arena_back(arena, here);
	return true;
}

/*
 * The bodies of missed pairs, with all of their groups, become new groups, whose members are reset
 * to the beginning of the step; the old groups are dead.
 */
static bool regroup(struct rb_world *world)
{
	struct rb_groups *groups = world->groups;
	const size_t first = groups->group_count;

	for (size_t k = 0; k < groups->missed_count; k++) {
		const struct rb_pair pair = groups->missed[k];

		if (pair.b < groups->body_count)
			join(groups->parent, pair.a, pair.b);
		if (!append_pair(&groups->active, &groups->active_count, &groups->active_capacity,
		                 pair))
			return false;
	}
	if (!sort_active(world))
		return false;
	for (size_t k = 0; k < groups->missed_count; k++) {
		const int root = rb_forest_root(groups->parent, groups->missed[k].a);

		if (groups->group_of[root] < (int)first && !add_group(groups, root))
			return false;
	}
	size_t members = groups->member_count;
	for (int i = 0; i < groups->body_count; i++) {
		const int group = groups->group_of[rb_forest_root(groups->parent, i)];

		if (group < (int)first)
			continue;
		groups->group_of[i] = group;
		groups->group[group].member_count++;
		groups->travelled[i] = 0;
		rb_state_copy_rows(&world->state, &world->start, &i, 1);
		members++;
	}
	for (size_t g = 0; g < first; g++)
		if (groups->group_of[groups->member[groups->group[g].member_first]] != (int)g)
			groups->group[g].dead = true;
	return rb_memory_reserve(&groups->member, &groups->member_capacity, members,
	                         sizeof *groups->member) &&
	       lay_out(groups, first, groups->active, groups->active_count);
}

enum rb_status rb_groups_merge(struct rb_world *world, size_t *again, struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	const size_t before = groups->group_count;
	bool any = false;

	*again = 0;
	if (!find_missed(world, &any) || (any && !regroup(world)))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of a step");
	*again = groups->group_count - before;
	return RB_OK;
}
