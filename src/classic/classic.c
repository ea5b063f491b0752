/* SPDX-License-Identifier: MIT */
/*
 * The step of the classic method; its equations and a drawing are in the header. Work is divided by
 * data: blocks of bodies that fly alone, blocks of groups. Each group writes its own rows of the
 * state, its own touches, events and counts, and the commit joins these in orders that do not
 * depend on workers: contacts by pair, events by time and pair, ledger entries by group.
 */
#include "classic/classic.h"

#include "base/error.h"
#include "base/sort.h"
#include "base/memory.h"
#include "classic/classic_ledger.h"
#include "classic/groups.h"
#include "classic/stage_list.h"
#include "classic/rollback.h"
#include "step/verdict.h"

#include <string.h>

/*
 * Bodies and groups of a block, whatever the number of workers: results of a block must not depend
 * on how many there are, and a block must outweigh the atomic counter that hands it out.
 */
enum { ALONE_PER_BLOCK = 256, GROUPS_PER_BLOCK = 8 };

/*
 * Shared by the workers of a step; set before they start, then only read, except for each block's
 * own row.
 */
struct step_work {
	struct rb_world *world;
	double start_s, dt_s;
	size_t first_group;
	int blocks; /* of bodies alone */
	int *bad;   /* [blocks of bodies alone]: a body that is not finite, else -1 */
	struct rb_entries *entries; /* [blocks of bodies alone] */
};

/* One block of bodies without any pair: a single substep of the whole step. */
static void fly_block(void *user, int block, int worker)
{
	const struct step_work *work = user;
	struct rb_world *world = work->world;
	const struct rb_groups *groups = world->groups;
	const int first = block * ALONE_PER_BLOCK;
	const int rest = groups->alone_count - first;
	RB_ASSERT(rest > 0);
	struct rb_pass pass = {.world = world,
	                       .arena = &world->arena[worker],
	                       .member = groups->alone + first,
	                       .member_count = rest < ALONE_PER_BLOCK ? rest : ALONE_PER_BLOCK,
	                       .start_s = work->start_s,
	                       .dt_s = work->dt_s,
	                       .h_s = work->dt_s};

	rb_stage_list_run(world->plan, &pass);
	rb_classic_ledger_substep(&pass, &world->start);
	work->entries[block] = pass.entries;
	work->bad[block] = -1;
	for (int k = 0; k < pass.member_count && work->bad[block] < 0; k++)
		if (!rb_verdict_finite(&world->state, pass.member[k]))
			work->bad[block] = pass.member[k];
}

/* Runs the blocks; RB_ERR_PHYSICS names the first body in order that is not finite. */
static enum rb_status fly_alone(struct rb_world *world, struct step_work *work,
                                struct rb_error *err)
{
	const struct rb_groups *groups = world->groups;
	const int blocks = (groups->alone_count + ALONE_PER_BLOCK - 1) / ALONE_PER_BLOCK;

	if (blocks == 0)
		return RB_OK;
	work->bad = rb_arena_take(&world->arena[0], (size_t)blocks, sizeof *work->bad);
	work->entries = rb_arena_take(&world->arena[0], (size_t)blocks, sizeof *work->entries);
	if (!work->bad || !work->entries)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	rb_team_run(world->team, blocks, fly_block, work);
	work->blocks = blocks;
	world->frame_counts.substeps++;
	world->frame_counts.body_steps += (uint64_t)groups->alone_count;
	world->frame_counts.smallest_step_s = fmin(world->frame_counts.smallest_step_s, work->dt_s);
	for (int b = 0; b < blocks; b++)
		if (work->bad[b] >= 0)
			return rb_verdict_fail_finite(world->model, work->bad[b], work->start_s,
			                              err);
	return RB_OK;
}

/* One block of groups, each through rb_rollback_run. */
static void run_block(void *user, int block, int worker)
{
	const struct step_work *work = user;
	struct rb_world *world = work->world;
	struct rb_groups *groups = world->groups;
	const size_t first = work->first_group + (size_t)block * GROUPS_PER_BLOCK;
	const size_t end = first + GROUPS_PER_BLOCK < groups->group_count ? first + GROUPS_PER_BLOCK
	                                                                  : groups->group_count;

	for (size_t g = first; g < end; g++) {
		struct rb_group *group = &groups->group[g];

		group->pass = (struct rb_pass){.world = world,
		                               .arena = &world->arena[worker],
		                               .kept = &world->kept[worker],
		                               .member = groups->member + group->member_first,
		                               .member_count = group->member_count,
		                               .touch = groups->touch + group->touch_first,
		                               .touch_count = group->touch_count,
		                               .start_s = work->start_s,
		                               .dt_s = work->dt_s};
		group->error = (struct rb_error){0};
		group->error.status = rb_rollback_run(&group->pass, world->plan, &group->error);
	}
}

/* Runs the groups from `first` on. The first failure in the order of groups is the step's. */
static enum rb_status run_groups(struct rb_world *world, struct step_work *work, size_t first,
                                 struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	const size_t count = groups->group_count - first;

	RB_ASSERT(first <= groups->group_count);
	work->first_group = first;
	rb_team_run(world->team, (int)((count + GROUPS_PER_BLOCK - 1) / GROUPS_PER_BLOCK),
	            run_block, work);
	for (size_t g = first; g < groups->group_count; g++)
		if (groups->group[g].error.status != RB_OK) {
			if (err)
				*err = groups->group[g].error;
			return groups->group[g].error.status;
		}
	return RB_OK;
}

/* ---- commit ---- */

/* Lasting contacts of all live groups become the world's, sorted by pair. */
static bool keep_contacts(struct rb_world *world)
{
	struct rb_groups *groups = world->groups;
	size_t max = 0;

	for (size_t g = 0; g < groups->group_count; g++)
		max += groups->group[g].dead ? 0 : (size_t)groups->group[g].touch_count;
	if (rb_contacts_reserve(&world->next_contacts, max, NULL) != RB_OK)
		return false;

	/* groups are not ordered by pair: sorted by key below */
	struct rb_sort_item *item = rb_arena_take(&world->arena[0], 2 * max, sizeof *item);
	struct rb_contact *row = rb_arena_take(&world->arena[0], max, sizeof *row);
	size_t count = 0;

	if (!item || !row)
		return false;
	for (size_t g = 0; g < groups->group_count; g++) {
		const struct rb_pass *pass = &groups->group[g].pass;

		for (int k = 0; !groups->group[g].dead && k < pass->touch_count; k++) {
			const struct rb_touch *touch = &pass->touch[k];

			if (!touch->lasting)
				continue;
			item[count] = (struct rb_sort_item){
				(uint64_t)(uint32_t)touch->a << 32 | (uint32_t)touch->b, count};
			row[count++] = (struct rb_contact){.a = touch->a,
			                                   .b = touch->b,
			                                   .point = pass->now[k].point,
			                                   .normal = touch->normal_force > 0
			                                                     ? touch->force_normal
			                                                     : pass->now[k].normal,
			                                   .gap = pass->now[k].gap,
			                                   .normal_force = touch->normal_force,
			                                   .tangent_force = touch->tangent_force};
		}
	}
	rb_sort_by_key(item, item + max, count);
	for (size_t k = 0; k < count; k++)
		world->next_contacts.row[k] = row[item[k].value];
	RB_ASSERT(count <= max);
	world->next_contacts.count = count;
	const struct rb_contacts last = world->contacts;
	world->contacts = world->next_contacts;
	world->next_contacts = last;
	return true;
}

/* The event in ids of the scene, a < b; the normal points from a to b. */
static struct rb_event with_ids(const struct rb_model *model, struct rb_event event)
{
	const int a = model->id_of[event.a], b = model->id_of[event.b];

	event.a = a;
	event.b = b;
	/* ids and indices may be in different orders: static bodies have the last indices */
	if (a > b) {
		event.a = b;
		event.b = a;
		event.normal = rb_vec3_neg(event.normal);
		event.impulse = rb_vec3_neg(event.impulse);
	}
	return event;
}

/*
 * Appends the events of all groups in order of time and then of pair; `*first` is where they begin.
 */
static bool keep_events(struct rb_world *world, size_t *first)
{
	struct rb_groups *groups = world->groups;
	struct rb_events *events = &world->events;
	size_t count = 0, n = 0;

	*first = events->count;
	for (size_t g = 0; g < groups->group_count; g++)
		count += groups->group[g].dead ? 0 : (size_t)groups->group[g].pass.event_count;
	if (count == 0)
		return true;
	struct rb_sort_item *item = rb_arena_take(&world->arena[0], 2 * count, sizeof *item);
	struct rb_event *event = rb_arena_take(&world->arena[0], count, sizeof *event);
	if (!item || !event ||
	    !rb_memory_reserve(&events->row, &events->capacity, *first + count, sizeof *event))
		return false;
	for (size_t g = 0; g < groups->group_count; g++) {
		const struct rb_pass *pass = &groups->group[g].pass;

		for (int k = 0; !groups->group[g].dead && k < pass->event_count; k++) {
			event[n] = with_ids(world->model, pass->event[k]);
			item[n] = (struct rb_sort_item){
				(uint64_t)(uint32_t)event[n].a << 32 | (uint32_t)event[n].b, n};
			n++;
		}
	}
	/*
	 * Stable sorts, the least significant key first. Times are not negative, so their bits as
	 * integers have their order (IEEE 754).
	 */
	RB_ASSERT(n == count);
	rb_sort_by_key(item, item + count, count);
	for (size_t k = 0; k < count; k++)
		memcpy(&item[k].key, &event[item[k].value].time_s, sizeof item[k].key);
	rb_sort_by_key(item, item + count, count);
	for (size_t k = 0; k < count; k++)
		events->row[events->count++] = event[item[k].value];
	return true;
}

/* Joins counts, contacts and events of the groups and calls on_collision. */
static enum rb_status commit(struct rb_world *world, struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	size_t first = 0;

	for (size_t g = 0; g < groups->group_count; g++) {
		const struct rb_group *group = &groups->group[g];
		struct rb_counts counts = group->pass.counts;

		if (group->dead) { /* merged into another group: its work is discarded */
			counts = (struct rb_counts){
				.discarded_body_steps = counts.body_steps +
			                                counts.discarded_body_steps,
				.rollbacks = counts.rollbacks + 1,
				.smallest_step_s = counts.smallest_step_s};
		}
		rb_counts_add(&world->frame_counts, &counts);
	}
	if (!keep_contacts(world) || !keep_events(world, &first))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	return rb_world_report_events(world, first, err);
}

/* Enters the ledger in the order of blocks and groups. */
static void enter_all(struct rb_world *world, const struct step_work *work)
{
	const struct rb_groups *groups = world->groups;

	for (int b = 0; b < work->blocks; b++)
		rb_ledger_enter(&world->ledger, &work->entries[b]);
	for (size_t g = 0; g < groups->group_count; g++)
		if (!groups->group[g].dead)
			rb_ledger_enter(&world->ledger, &groups->group[g].pass.entries);
}

/* Forms groups and runs them until none meets another one's path. */
static enum rb_status solve_step(struct rb_world *world, double start, double dt,
                                 struct rb_error *err)
{
	struct step_work work = {.world = world, .start_s = start, .dt_s = dt};
	size_t again = 0;
	enum rb_status status = rb_groups_form(world, dt, err);

	if (status == RB_OK)
		status = fly_alone(world, &work, err);
	if (status == RB_OK)
		status = run_groups(world, &work, 0, err);
	while (status == RB_OK) {
		status = rb_groups_merge(world, &again, err);
		if (status != RB_OK || again == 0)
			break;
		status = run_groups(world, &work, world->groups->group_count - again, err);
	}
	if (status == RB_OK && world->ledger.kept)
		enter_all(world, &work);
	return status;
}

/* Allocates what only steps need; on the first call. */
static enum rb_status prepare(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	enum rb_status status = RB_OK;

	if (world->groups)
		return RB_OK;
	if (model->features & RB_FEATURE_CONTACT)
		status = rb_state_init(&world->mark, model->body_count, model->features, err);
	if (status == RB_OK)
		status = rb_groups_create(&world->groups, model, err);
	if (status == RB_OK && (model->features & RB_FEATURE_CONTACT))
		status = rb_broadphase_create(&world->broadphase, model, err);
	return status;
}

/* Advances from `start` by `dt`; on failure the state is that of the beginning. */
static enum rb_status step(struct rb_world *world, double start, double dt, struct rb_error *err)
{
	RB_ASSERT(dt > 0);

	enum rb_status status = RB_OK;

	for (int k = 0; k < world->worker_count; k++) {
		rb_arena_reset(&world->arena[k]);
		rb_arena_reset(&world->kept[k]);
	}
	if (world->moved_by_hand)
		rb_groups_forget(world->groups);
	world->moved_by_hand = false;
	rb_state_copy(&world->start, &world->state);
	status = solve_step(world, start, dt, err);
	if (status != RB_OK) {
		rb_state_copy(&world->state, &world->start);
		return status;
	}
	world->state.time_s = start + dt;
	return commit(world, err);
}

/* ---- checkpoints ---- */

/*
 * Boxes and margins: which pairs are examined, hence which bodies step together, follows from when
 * the boxes were made. The candidates follow from them and are found again.
 */
static void pack_groups(struct rb_world *world, struct rb_pack *pack)
{
	struct rb_groups *const groups = world->groups;
	const size_t n = (size_t)groups->body_count;

	rb_pack_bool(pack, &groups->valid);
	if (!groups->valid)
		return;
	if (!rb_pack_check(pack, world->broadphase != NULL, "boxes of bodies that never meet"))
		return;
	rb_pack_finite(pack, &groups->built_at[0].x, 3 * n);
	rb_pack_finite(pack, &groups->box[0].low.x, 6 * n);
	for (size_t i = 0; pack->loading && i < n; i++)
		(void)rb_pack_check(pack,
		                    groups->box[i].low.x <= groups->box[i].high.x &&
		                            groups->box[i].low.y <= groups->box[i].high.y &&
		                            groups->box[i].low.z <= groups->box[i].high.z,
		                    "a box that is inside out");
	rb_pack_finite(pack, groups->margin, n);
	if (pack->loading && !pack->failed &&
	    rb_broadphase_find(world->broadphase, groups->box, &groups->candidate,
	                       &groups->candidate_count, NULL) != RB_OK)
		rb_pack_fail_memory(pack);
}

static void pack_steps(struct rb_world *world, struct rb_pack *pack)
{
	bool prepared = world->groups != NULL;

	rb_pack_bool(pack, &prepared);
	/* no method that locates leaves the rest to these: a world has them from its beginning */
	(void)rb_pack_check(pack, prepared == (world->groups != NULL), "steps of another method");
	if (prepared && !pack->failed)
		pack_groups(world, pack);
}

static void release(struct rb_world *world)
{
	rb_groups_destroy(world->groups);
	world->groups = NULL;
}

static const struct rb_stepper steps = {.tolerance = 1e-6,
                                        .prepare = prepare,
                                        .step = step,
                                        .pack = pack_steps,
                                        .release = release};

const struct rb_method rb_method_classic = {
	.name = "classic",
	.what = "one step for all; a step that ends in an overlap is taken back and halved",
	.good_for = "lectures; a baseline for every other method",
	.mind = "errors fall with the first power of time_step; heaps cost much; contacts of "
		"spheres and planes only; no joints, springs, drag, fields, gravitation or driven "
		"bodies",
	.steps = &steps,
	.lacks = RB_FEATURES_VARIED | RB_FEATURE_DRIVEN | RB_FEATURE_JOINTS,
	.round_only = true,
};
