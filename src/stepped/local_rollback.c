/* SPDX-License-Identifier: MIT */
/*
 * Selective rollback: after an attempt of the whole step that failed for some bodies, groups with a
 * failed body return to the beginning and take adaptive substeps (halved on failure, doubled on
 * success), the others keep the attempt. Groups are independent as long as bodies stay in their
 * swept boxes; if one leaves, its box grows, groups are formed again, and only groups that have
 * changed start over. A box at least doubles each time, so this ends.
 *
 * Results of finished groups are collected in lists with the body that they belong to, and joined
 * once at the end, sorted by body: the outcome does not depend on the order in which groups were
 * run. Compare the time-warp scheme of Mirtich (2000).
 */
#include "stepped/local_rollback.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "stepped/attempt.h"
#include "stepped/contact_records.h"
#include "stepped/depth.h"
#include "stepped/driven_bodies.h"
#include "stepped/step_ledger.h"
#include "stepped/joint_records.h"
#include "stepped/joint_steps.h"
#include "stepped/judge.h"
#include "stepped/sleep.h"
#include "stepped/swept_bounds.h"

/* Of the steps of a group that were kept. */
struct rb_group_sums {
	struct rb_entries entries; /* for the ledger */
	struct rb_counts counts;   /* without those of bodies and steps: `steps` */
	int body;                  /* one of the group's */
};

struct rb_local_rollback {
	struct rb_swept_bounds swept;
	struct rb_state begin;
	int *steps; /* owned, by body: number of steps that were kept */
	int *body;  /* owned: bodies of the current group, then driven ones */
	/* of the group's last two steps; of finished groups */
	struct rb_contacts last, before, kept;
	struct rb_contacts shown; /* for frames: of finished groups, averaged over the whole step */
	struct rb_mean_forces means;      /* of the current group */
	struct rb_named_impulse *impulse; /* owned: of finished groups */
	size_t impulse_count, impulse_capacity;
	struct rb_event_of *event; /* owned: impacts of finished groups */
	size_t event_count, event_capacity;
	struct rb_group_sums now;   /* of the current group */
	struct rb_group_sums *sums; /* owned: of finished groups */
	size_t sums_count, sums_capacity;
	bool has_no_step; /* the current group has not taken a step yet */
	int unused_steps; /* since the last one that failed for some bodies */
};

/* An impact and a dynamic body of it. */
struct rb_event_of {
	struct rb_event event;
	int body;
};

/* Allocated when a step fails for the first time. */
static enum rb_status create(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const size_t n = (size_t)model->body_count;
	struct rb_local_rollback *made = rb_memory_take(1, sizeof *made);
	enum rb_status status = RB_OK;

	if (made) {
		made->steps = rb_memory_take(n, sizeof *made->steps);
		made->body = rb_memory_take(n, sizeof *made->body);
	}
	if (!made || !made->steps || !made->body)
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of a step");
	if (status == RB_OK)
		status = rb_swept_bounds_create(&made->swept, model, err);
	if (status == RB_OK)
		status = rb_state_init(&made->begin, model->body_count, model->features, err);
	if (status != RB_OK) {
		rb_local_rollback_destroy(made);
		return status;
	}
	world->stepped->local = made;
	return RB_OK;
}

void rb_local_rollback_destroy(struct rb_local_rollback *local)
{
	if (!local)
		return;
	rb_swept_bounds_release(&local->swept);
	rb_state_release(&local->begin);
	rb_memory_free(local->steps);
	rb_memory_free(local->body);
	rb_contacts_release(&local->last);
	rb_contacts_release(&local->before);
	rb_contacts_release(&local->kept);
	rb_mean_forces_release(&local->means);
	rb_contacts_release(&local->shown);
	rb_memory_free(local->impulse);
	rb_memory_free(local->event);
	rb_memory_free(local->sums);
	rb_memory_free(local);
}

/* ---- results, and those to be repeated ---- */

/* Removes results of groups that have changed since they were finished. */
static void forget_changed(struct rb_world *world)
{
	struct rb_local_rollback *local = world->stepped->local;
	size_t impulses = 0, events = 0, sums = 0;

	rb_record_keep(world, &local->kept, local->swept.finished);
	rb_record_keep(world, &local->shown, local->swept.finished);
	for (size_t k = 0; k < local->impulse_count; k++)
		if (local->swept.finished[local->impulse[k].a])
			local->impulse[impulses++] = local->impulse[k];
	for (size_t k = 0; k < local->event_count; k++)
		if (local->swept.finished[local->event[k].body])
			local->event[events++] = local->event[k];
	for (size_t k = 0; k < local->sums_count; k++)
		if (local->swept.finished[local->sums[k].body])
			local->sums[sums++] = local->sums[k];
	local->sums_count = sums;
	local->impulse_count = impulses;
	local->event_count = events;
}

/*
 * Carries `failed` and `finished` from groups to bodies; groups that start over add to the counts
 * of discarded work.
 */
static void mark_bodies(struct rb_world *world)
{
	struct rb_local_rollback *local = world->stepped->local;
	struct rb_counts *counts = &world->frame_counts;

	for (size_t g = 0; g < local->swept.group_count; g++) {
		struct rb_swept_group *group = &local->swept.group[g];

		group->finished = group->finished && group->failed;
		if (!group->failed || group->finished)
			continue;
		counts->rollbacks++;
		for (int k = 0; k < group->count; k++) {
			const int i = local->swept.member[group->first + k];

			counts->discarded_body_steps += (uint64_t)local->steps[i];
			local->swept.failed[i] = 1;
			local->swept.finished[i] = 0;
			local->steps[i] = 0;
		}
	}
	for (int k = 0; k < world->stepped->member_count; k++)
		local->swept.was_group[world->stepped->body[k]] =
			local->swept.group_of[world->stepped->body[k]];
}

/* ---- one group ---- */

/* Sets the cohort `part` to the group's bodies, the driven ones, and the group's pairs. */
static void cohort_of(struct rb_world *world, const struct rb_swept_group *group)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *local = s->local;

	memcpy(local->body, local->swept.member + group->first, (size_t)group->count * sizeof(int));
	memcpy(local->body + group->count, s->body + s->member_count,
	       (size_t)s->driven_count * sizeof(int));
	rb_swept_bounds_restrict(&local->swept, group->pair, group->pair_count);
	s->part.body = local->body;
	s->part.member_count = group->count;
	s->part.body_count = group->count + s->driven_count;
	s->part.candidates = &local->swept.candidates;
}

/* Keeps an accepted substep: counts, events, ledger, contacts, warm-start impulses. */
static enum rb_status keep_step(struct rb_world *world, double time, double h,
                                const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *local = s->local;
	struct rb_cohort *part = &s->part;
	struct rb_counts *counts = &local->now.counts;
	const struct rb_counts others = world->frame_counts;
	const struct rb_contacts swapped = local->before;
	/* before the group's first step, the contacts of the world */
	const struct rb_contacts *before = local->has_no_step ? &world->contacts : &local->last;

	RB_ASSERT(h > 0 && outcome->residual >= 0);
	counts->smallest_step_s = fmin(counts->smallest_step_s, h);
	counts->max_penetration_m = fmax(counts->max_penetration_m, outcome->overlap);
	counts->residual_m = fmax(counts->residual_m, outcome->residual);
	counts->slip_m = fmax(counts->slip_m, outcome->slip);
	for (int k = 0; k < part->member_count; k++)
		local->steps[part->body[k]]++;
	s->reported.count = 0;
	/* what is recorded counts for the group alone, which may yet start over */
	world->frame_counts = *counts;
	enum rb_status status = rb_record_impacts(world, part, time, before, NULL, err);
	if (status == RB_OK)
		status = rb_joint_records_add(world, part, time, h, NULL, err);
	*counts = world->frame_counts;
	world->frame_counts = others;
	if (status == RB_OK &&
	    !rb_memory_reserve(&local->event, &local->event_capacity,
	                       local->event_count + s->reported.count + 1, sizeof *local->event))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	for (size_t k = 0; status == RB_OK && k < s->reported.count; k++) {
		const int a = world->model->index_of[s->reported.row[k].a];
		const int b = world->model->index_of[s->reported.row[k].b];

		local->event[local->event_count++] = (struct rb_event_of){
			s->reported.row[k], rb_stepped_is_dynamic(world, a) ? a : b};
	}
	if (status == RB_OK && s->tally) {
		const struct rb_entries e = rb_step_ledger_enter(world, part, &world->mark,
		                                                 time - h, h, NULL);
		rb_entries_add(&local->now.entries, 1, &e);
	}
	rb_joints_keep(world, part, h, NULL);
	local->has_no_step = false;
	local->before = local->last;
	local->last = swapped;
	local->last.count = 0;
	if (status == RB_OK)
		status = rb_step_points_choose(&part->points, world, -(double)INFINITY, err);
	if (status == RB_OK)
		status = rb_record_contacts(world, part, h, NULL, &local->last, err);
	if (status == RB_OK && world->keeps_means)
		status = rb_record_part(part, &local->last, h, &s->part_contacts, &local->means,
		                        err);
	rb_contacts_sort(&local->last);
	if (status == RB_OK)
		status = rb_step_points_keep(&part->points, world, h, s->solver.asleep, NULL, err);
	rb_step_points_index_members(&part->points, part->body, part->member_count);
	return status;
}

/* Restores the group's bodies and impulses to the beginning of the step. */
static enum rb_status begin_group(struct rb_world *world, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *local = s->local;

	RB_ASSERT(s->part.body_count > 0 && s->part.member_count > 0);
	rb_state_copy_rows(&world->state, &local->begin, s->part.body, s->part.body_count);
	if (!rb_step_points_reserve(&s->part.points, s->all.points.last_count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts",
		               s->all.points.last_count);
	rb_step_points_take_last(&s->part.points, &s->all.points, s->part.body,
	                         s->part.member_count);
	rb_joints_go_back(world, &s->part);
	rb_solver_forget_rest(&s->solver, s->part.body, s->part.member_count);
	local->has_no_step = true;
	local->now = (struct rb_group_sums){.counts = rb_counts_none, .body = s->part.body[0]};
	local->last.count = local->means.count = 0;
	return RB_OK;
}

/*
 * Appends the results of a group that has reached the end of the step to those of finished groups.
 */
static enum rb_status finish_group(struct rb_world *world, struct rb_swept_group *group, double dt,
                                   struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *local = s->local;
	const struct rb_step_points *points = &s->part.points;

	if (!rb_memory_reserve(&local->impulse, &local->impulse_capacity,
	                       local->impulse_count + points->last_count + 1,
	                       sizeof *local->impulse))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	if (points->last_count > 0)
		memcpy(local->impulse + local->impulse_count, points->last,
		       points->last_count * sizeof *points->last);
	local->impulse_count += points->last_count;
	enum rb_status status = rb_contacts_join(&local->kept, &local->last, err);
	if (status == RB_OK)
		status = rb_mean_forces_record(&local->means, dt, &local->shown, err);
	if (status != RB_OK)
		return status;
	if (!rb_memory_reserve(&local->sums, &local->sums_capacity, local->sums_count + 1,
	                       sizeof *local->sums))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the sums of a step");
	local->sums[local->sums_count++] = local->now;
	group->finished = true;
	for (int k = 0; k < group->count; k++)
		local->swept.finished[local->swept.member[group->first + k]] = 1;
	return RB_OK;
}

static void reset_arenas(struct rb_world *world)
{
	for (int k = 0; k < world->worker_count; k++)
		rb_arena_reset(&world->arena[k]);
}

/*
 * Forms groups again after a box has grown; returns whether this group overlaps no other. If so its
 * candidate pairs are replaced, and it continues from its present state.
 */
static bool is_separate(struct rb_world *world, struct rb_swept_group *group,
                        enum rb_status *status, struct rb_error *err)
{
	struct rb_local_rollback *local = world->stepped->local;
	const int first = local->swept.member[group->first], count = group->count;

	*status = rb_swept_bounds_form(&local->swept, world, err);
	if (*status != RB_OK)
		return false;
	/* no other box has changed: if this one overlaps none, all groups are as before */
	if (local->swept.group[local->swept.group_of[first]].count != count)
		return false;
	cohort_of(world, &local->swept.group[local->swept.group_of[first]]);
	return true;
}

/* Restores the beginning of the current substep. */
static void restore_substep(struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_cohort *part = &s->part;

	rb_state_copy_rows(&world->state, &world->mark, part->body, part->body_count);
	rb_solver_forget_rest(&s->solver, part->body, part->member_count);
	world->frame_counts.discarded_body_steps += (uint64_t)part->member_count;
}

/*
 * Takes adaptive substeps of one group over dt. `*left`: a body has left its box and the group has
 * met another; it must start over.
 *
 * The gravitation impulse of the whole step is given at its beginning, as for the other bodies
 * (symplectic Euler): the impulses of two bodies on each other are then opposite and collinear,
 * whichever takes substeps, which conserves linear and angular momentum.
 */
static enum rb_status run_group(struct rb_world *world, struct rb_swept_group *group, double start,
                                double dt, bool *left, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_cohort *part = &s->part;
	double done = 0, h = 0.5 * dt;
	int halvings = 1;

	RB_ASSERT(dt > 0 && group->count > 0);
	cohort_of(world, group);
	enum rb_status status = begin_group(world, err);
	while (status == RB_OK && done < dt) {
		struct rb_attempt_outcome outcome;

		if (rb_world_is_stopped(world))
			return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
		reset_arenas(world);
		rb_state_copy_rows(&world->mark, &world->state, part->body, part->body_count);
		part->gravitation_s = done > 0 ? 0 : dt;
		status = rb_attempt(world, part, start + done, h, err);
		if (status == RB_OK)
			status = rb_judge(world, part, h, &outcome, err);
		if (status == RB_OK && rb_stepped_lacks_memory(world))
			status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
		if (status != RB_OK)
			break;
		if (s->bad_count > 0) {
			restore_substep(world);
			world->frame_counts.rollbacks++;
			if (rb_halvings_end(halvings++, h, dt))
				return rb_judge_give_up(world, start + done, &outcome, err);
			h = outcome.clear_s < h ? outcome.clear_s : 0.5 * h;
			continue;
		}
		if (rb_swept_bounds_left(&s->local->swept, world, part, dt - done - h)) {
			restore_substep(world);
			*left = !is_separate(world, group, &status, err);
			if (*left)
				return status;
			continue;
		}
		done = h < dt - done ? done + h : dt;
		status = keep_step(world, start + done, h, &outcome, err);
		h = rb_next_part(2 * h, dt - done, dt);
		halvings = 0;
	}
	return status == RB_OK ? finish_group(world, group, dt, err) : status;
}

/* ---- the step ---- */

/* Runs all failed groups, and again after each regrouping. */
static enum rb_status run_groups(struct rb_world *world, double start, double dt,
                                 struct rb_error *err)
{
	struct rb_local_rollback *local = world->stepped->local;
	enum rb_status status = RB_OK;
	bool again = true;

	while (again && status == RB_OK) {
		again = false;
		reset_arenas(world);
		status = rb_swept_bounds_form(&local->swept, world, err);
		if (status != RB_OK)
			break;
		mark_bodies(world);
		forget_changed(world);
		for (size_t g = 0; g < local->swept.group_count && status == RB_OK; g++) {
			const size_t events = local->event_count;
			bool left = false;

			if (!local->swept.group[g].failed || local->swept.group[g].finished)
				continue;
			status = run_group(world, &local->swept.group[g], start, dt, &left, err);
			if (left)
				local->event_count = events;
			again = again || left;
		}
	}
	return status;
}

/* Results of the step, made before anything of the step before is replaced. */
struct made {
	struct rb_contacts contacts; /* in the arena, not sorted */
	size_t whole_count;          /* the first of these: of bodies that keep the whole step */
	/* in the arena: impulses of such bodies; all impulses; for their order */
	struct rb_named_impulse *whole, *all;
	struct rb_sort_item *item, *scratch;
};

/* Contacts of bodies that keep the whole step, and of finished groups; space for their lists. */
static enum rb_status make_contacts(struct rb_world *world, double dt, struct made *made,
                                    struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_local_rollback *local = s->local;
	struct rb_contacts *const contacts = &made->contacts;

	RB_ASSERT(dt > 0);
	enum rb_status status = rb_record_scratch(world, &s->all, local->kept.count, contacts, err);
	if (status == RB_OK)
		status = rb_record_contacts(world, &s->all, dt, local->swept.failed, contacts, err);
	made->whole_count = contacts->count;
	if (status == RB_OK && world->keeps_means)
		status = rb_contacts_reserve(
			&world->shown,
			contacts->count + s->all.transmitted.count + local->shown.count, err);
	if (status == RB_OK)
		status = rb_contacts_join(contacts, &local->kept, err);
	return status == RB_OK ? rb_contacts_reserve(&world->contacts, contacts->count, err)
	                       : status;
}

/* Contacts for output, averaged over dt. */
static enum rb_status show_contacts(struct rb_world *world, double dt,
                                    const struct rb_contacts *whole, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	world->shown.count = 0;
	enum rb_status status = rb_contacts_join(&world->shown, whole, err);
	if (status == RB_OK)
		status = rb_record_transmitted(&s->all, dt, s->local->swept.failed, &world->shown,
		                               err);
	if (status == RB_OK)
		status = rb_contacts_join(&world->shown, &s->local->shown, err);
	rb_contacts_sort(&world->shown);
	world->has_shown = true;
	return status;
}

/* They become those of the world, in space that is reserved. */
static enum rb_status keep_contacts(struct rb_world *world, double dt, struct made *made,
                                    struct rb_error *err)
{
	const struct rb_contacts whole = {.row = made->contacts.row, .count = made->whole_count};
	enum rb_status status = RB_OK;

	if (world->keeps_means)
		status = show_contacts(world, dt, &whole, err);
	rb_contacts_sort(&made->contacts);
	world->contacts.count = 0;
	return status == RB_OK ? rb_contacts_join(&world->contacts, &made->contacts, err) : status;
}

/* Ledger entries of the bodies that keep the whole step, then those of groups. */
static void enter_all(struct rb_world *world, double start, double dt)
{
	const struct rb_local_rollback *local = world->stepped->local;
	const struct rb_entries whole = rb_step_ledger_enter(
		world, &world->stepped->all, &local->begin, start, dt, local->swept.failed);

	rb_ledger_enter(&world->ledger, &whole);
	for (size_t k = 0; k < local->sums_count; k++)
		rb_ledger_enter(&world->ledger, &local->sums[k].entries);
}

/* Chooses the points of bodies that keep the whole step, and takes space for all impulses. */
static enum rb_status make_impulses(struct rb_world *world, struct made *made, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_step_points *points = &s->all.points;
	const unsigned char *const failed = s->local->swept.failed;
	const enum rb_status status = rb_step_points_choose(points, world, -(double)INFINITY, err);
	struct rb_arena *const arena = &world->arena[0];
	size_t kept = 0;

	if (status != RB_OK)
		return status;
	for (size_t c = 0; c < points->chosen_count; c++)
		if (!failed[points->row[points->chosen[c]].a])
			points->chosen[kept++] = points->chosen[c];
	points->chosen_count = kept;
	const size_t max = kept + points->last_count + s->local->impulse_count;
	made->whole = rb_step_points_space(points, world, true);
	made->item = rb_arena_take(arena, max + 1, sizeof *made->item);
	made->scratch = rb_arena_take(arena, max + 1, sizeof *made->scratch);
	made->all = rb_arena_take(arena, max + 1, sizeof *made->all);
	return made->whole && made->item && made->scratch && made->all &&
	                       rb_step_points_reserve(points, max)
	               ? RB_OK
	               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", max);
}

/* Warm-start impulses of both kinds, sorted by body. */
static void keep_impulses(struct rb_world *world, double dt, const struct made *made)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_local_rollback *local = s->local;
	struct rb_step_points *points = &s->all.points;

	rb_step_points_keep_in(points, world, dt, s->solver.asleep, s->sleep.sleeps, made->whole);
	const size_t count = points->last_count + local->impulse_count;
	if (points->last_count > 0)
		memcpy(made->all, points->last, points->last_count * sizeof *made->all);
	if (local->impulse_count > 0)
		memcpy(made->all + points->last_count, local->impulse,
		       local->impulse_count * sizeof *made->all);
	for (size_t k = 0; k < count; k++)
		made->item[k] = (struct rb_sort_item){(uint64_t)made->all[k].a, k};
	rb_sort_by_key(made->item, made->scratch, count);
	for (size_t k = 0; k < count; k++)
		points->last[k] = made->all[made->item[k].value];
	points->last_count = count;
	rb_step_points_index(points, world->model);
}

static enum rb_status join_impacts(struct rb_world *world, double end, double dt,
                                   struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_local_rollback *local = s->local;

	s->reported.count = 0;
	enum rb_status status = rb_record_impacts(world, &s->all, end, &world->contacts,
	                                          local->swept.failed, err);
	if (status == RB_OK)
		status = rb_joint_records_add(world, &s->all, end, dt, local->swept.failed, err);
	if (status != RB_OK)
		return status;
	if (!rb_memory_reserve(&s->reported.row, &s->reported.capacity,
	                       s->reported.count + local->event_count + 1,
	                       sizeof *s->reported.row) ||
	    !rb_record_reserve(world, s->reported.count + local->event_count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	for (size_t k = 0; k < local->event_count; k++)
		s->reported.row[s->reported.count++] = local->event[k].event;
	return RB_OK;
}

/* Counts and largest overlap of the bodies that keep the whole step. */
static enum rb_status count_steps(struct rb_world *world, double dt,
                                  const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *local = s->local;
	struct rb_counts *counts = &world->frame_counts;
	struct rb_depths found = {0};
	enum rb_status status = RB_OK;
	bool any_whole = false;

	for (int k = 0; k < s->member_count; k++)
		counts->body_steps += (uint64_t)local->steps[s->body[k]];
	for (size_t k = 0; k < local->sums_count; k++)
		rb_counts_add(counts, &local->sums[k].counts);
	for (size_t g = 0; g < local->swept.group_count; g++) {
		const struct rb_swept_group *group = &local->swept.group[g];

		any_whole = any_whole || !group->failed;
		if (group->failed)
			counts->substeps += (uint64_t)
			                            local->steps[local->swept.member[group->first]];
	}
	if (!any_whole)
		return RB_OK;
	counts->substeps++;
	counts->smallest_step_s = fmin(counts->smallest_step_s, dt);
	counts->residual_m = fmax(counts->residual_m, outcome->residual);
	counts->slip_m = fmax(counts->slip_m, outcome->slip);
	rb_swept_bounds_restrict(&local->swept, 0, local->swept.pair_count);
	rb_candidates_place(&local->swept.candidates, world, s->body, world->model->body_count);
	if (world->broadphase)
		status = rb_depths_find(world, &local->swept.candidates, local->swept.failed, NULL,
		                        &found, err);
	counts->max_penetration_m = fmax(counts->max_penetration_m, found.max);
	return status;
}

/* Driven bodies were moved with each group's substeps; they end at the pose of the whole step. */
static enum rb_status end_drive(struct rb_world *world, double start, double dt,
                                struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	rb_state_copy_rows(&world->state, &s->local->begin, s->body + s->member_count,
	                   s->driven_count);
	const enum rb_status status = rb_drive_begin(world, start, dt, err);
	if (status == RB_OK)
		rb_drive_end(world);
	return status;
}

/* All of the step's results that can fail: nothing of the step before has been replaced. */
static enum rb_status make_step(struct rb_world *world, double start, double dt,
                                const struct rb_attempt_outcome *outcome, struct made *made,
                                struct rb_error *err)
{
	enum rb_status status = count_steps(world, dt, outcome, err);

	if (status == RB_OK)
		status = join_impacts(world, start + dt, dt, err);
	if (status == RB_OK)
		status = make_contacts(world, dt, made, err);
	return status == RB_OK ? make_impulses(world, made, err) : status;
}

/* Makes them those of the world. */
static enum rb_status keep_all(struct rb_world *world, double start, double dt, struct made *made,
                               struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const unsigned char *const failed = s->local->swept.failed;
	const enum rb_status status = keep_contacts(world, dt, made, err);

	RB_ASSERT(status == RB_OK); /* in space that is reserved */
	if (s->tally)
		enter_all(world, start, dt);
	rb_joints_keep(world, &s->all, dt, failed);
	keep_impulses(world, dt, made);
	rb_sleep_end(world, start + dt, failed);
	return status;
}

/* The state is that of the beginning of the step; nothing of the attempts may be relied on. */
static void take_back(struct rb_world *world, const struct rb_state *begin)
{
	struct rb_stepped *s = world->stepped;

	rb_state_copy(&world->state, begin);
	rb_sleep_gather(s);
	rb_joints_go_back(world, &s->all);
	rb_sleep_forget(s);
	rb_solver_forget_rest(&s->solver, s->body, s->member_count);
	s->candidates.valid = false;
}

/*
 * What groups have used is not needed by the next step, whose points and rows would come on top of
 * it. Most steps take few bodies back, whose lists stay.
 */
static void discard_groups(struct rb_world *world)
{
	enum { KEPT_BYTES = 1 << 16 };
	struct rb_stepped *const s = world->stepped;
	const struct rb_local_rollback *const local = s->local;
	void *const list[] = {s->part_contacts.row, local->last.row,  local->before.row,
	                      local->kept.row,      local->shown.row, local->means.row,
	                      local->means.spare,   local->impulse,   local->event,
	                      local->sums};

	for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
		rb_memory_discard(list[k], KEPT_BYTES);
	rb_attempt_discard(&s->part, KEPT_BYTES);
	rb_swept_bounds_discard(&local->swept, KEPT_BYTES);
	/* those of the whole step have been copied (rb_candidates_keep) */
	if (world->broadphase && s->candidates.pair == s->candidates.own)
		rb_broadphase_discard(world->broadphase, KEPT_BYTES);
}

/* Runs the groups and joins their results with those of the attempt; memory for it is there. */
static enum rb_status run_and_join(struct rb_world *world, double start, double dt,
                                   const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct made made = {.whole_count = 0};
	struct rb_local_rollback *local = s->local;
	enum rb_status status = RB_OK;

	rb_state_copy(&local->begin, &world->mark);
	rb_swept_bounds_set(&local->swept, world, &local->begin, dt);
	for (int i = 0; i < world->model->body_count; i++) {
		local->swept.failed[i] = s->bad[i];
		local->swept.finished[i] = 0;
		local->swept.was_group[i] = -1;
		local->steps[i] = 1;
	}
	local->kept.count = local->shown.count = local->impulse_count = local->event_count =
		local->sums_count = 0;
	if (!rb_candidates_keep(&s->candidates))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs",
		                 s->candidates.pair_count);
	if (status == RB_OK)
		status = run_groups(world, start, dt, err);
	if (status == RB_OK)
		status = end_drive(world, start, dt, err);
	const struct rb_counts before = world->frame_counts;
	reset_arenas(world);
	rb_sleep_wake(world, local->swept.failed);
	if (status == RB_OK)
		status = make_step(world, start, dt, outcome, &made, err);
	if (status == RB_OK)
		return keep_all(world, start, dt, &made, err);
	world->frame_counts = before;
	take_back(world, &local->begin);
	return status;
}

enum rb_status rb_local_rollback_step(struct rb_world *world, double start, double dt,
                                      const struct rb_attempt_outcome *outcome,
                                      struct rb_error *err)
{
	enum rb_status status = world->stepped->local ? RB_OK : create(world, err);

	RB_ASSERT(dt > 0 && world->stepped->bad_count > 0);
	if (status != RB_OK) {
		take_back(world, &world->mark);
		return status;
	}
	status = run_and_join(world, start, dt, outcome, err);
	discard_groups(world);
	world->stepped->local->unused_steps = 0;
	return status;
}

void rb_local_rollback_unused(struct rb_stepped *stepped)
{
	enum { STEPS_KEPT = 64 };

	if (!stepped->local || ++stepped->local->unused_steps < STEPS_KEPT)
		return;
	rb_local_rollback_destroy(stepped->local);
	stepped->local = NULL;
}
