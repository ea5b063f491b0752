/* SPDX-License-Identifier: MIT */
#include "stepped/local_rollback.h"

#include <string.h>

#include "base/memory.h"
#include "base/sort.h"
#include "stepped/attempt.h"
#include "stepped/depth.h"
#include "stepped/driven_bodies.h"
#include "stepped/enter.h"
#include "stepped/judge.h"
#include "stepped/swept_bounds.h"
#include "stepped/sleep.h"
#include "stepped/contact_records.h"

struct rb_local_rollback {
	struct rb_swept_bounds swept;
	struct rb_state begin;
	int *steps; /* owned, by body: that were taken and not taken back */
	int *body;  /* owned: a group's, with driven ones */
	struct rb_contacts last, before, kept; /* of a group's last step; of settled groups */
	struct rb_contacts shown;   /* for the frames: of settled groups, over the whole step */
	struct rb_means means;      /* of the group under way */
	struct rb_named_push *push; /* owned: of settled groups */
	size_t push_count, push_capacity;
	struct rb_event_of *event; /* owned: impacts of settled groups */
	size_t event_count, event_capacity;
	struct rb_entries entries;  /* for the ledger: of the group under way */
	struct rb_entries_of *book; /* owned: of settled groups */
	size_t book_count, book_capacity;
	bool fresh; /* the group under way has not taken a step yet */
};

/* An impact, and a body that yields in it. */
struct rb_event_of {
	struct rb_event event;
	int body;
};

/* A group's entries of the ledger, and one of its bodies. */
struct rb_entries_of {
	struct rb_entries entries;
	int body;
};

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
	world->stepped->apart = made;
	return RB_OK;
}

void rb_local_rollback_destroy(struct rb_local_rollback *apart)
{
	if (!apart)
		return;
	rb_swept_bounds_release(&apart->swept);
	rb_state_release(&apart->begin);
	rb_memory_free(apart->steps);
	rb_memory_free(apart->body);
	rb_contacts_release(&apart->last);
	rb_contacts_release(&apart->before);
	rb_contacts_release(&apart->kept);
	rb_means_release(&apart->means);
	rb_contacts_release(&apart->shown);
	rb_memory_free(apart->push);
	rb_memory_free(apart->event);
	rb_memory_free(apart->book);
	rb_memory_free(apart);
}

/* ---- what has been found, and is to be found again ---- */

static void forget_contacts(const struct rb_world *world, struct rb_contacts *contacts)
{
	const unsigned char *settled = world->stepped->apart->swept.settled;
	size_t kept = 0;

	for (size_t k = 0; k < contacts->count; k++) {
		const struct rb_contact *contact = &contacts->row[k];

		if (settled[rb_stepped_is_dynamic(world, contact->a) ? contact->a : contact->b])
			contacts->row[kept++] = *contact;
	}
	contacts->count = kept;
}

/* Of groups that were settled and have changed nothing is left. */
static void forget_unsettled(struct rb_world *world)
{
	struct rb_local_rollback *apart = world->stepped->apart;
	size_t pushes = 0, events = 0, books = 0;

	forget_contacts(world, &apart->kept);
	forget_contacts(world, &apart->shown);
	for (size_t k = 0; k < apart->push_count; k++)
		if (apart->swept.settled[apart->push[k].a])
			apart->push[pushes++] = apart->push[k];
	for (size_t k = 0; k < apart->event_count; k++)
		if (apart->swept.settled[apart->event[k].body])
			apart->event[events++] = apart->event[k];
	for (size_t k = 0; k < apart->book_count; k++)
		if (apart->swept.settled[apart->book[k].body])
			apart->book[books++] = apart->book[k];
	apart->book_count = books;
	apart->push_count = pushes;
	apart->event_count = events;
}

/* Marks by body as groups have them now; counts what is taken back. */
static void mark_bodies(struct rb_world *world)
{
	struct rb_local_rollback *apart = world->stepped->apart;
	struct rb_counts *counts = &world->frame_counts;

	for (size_t g = 0; g < apart->swept.group_count; g++) {
		struct rb_swept_group *group = &apart->swept.group[g];

		group->settled = group->settled && group->failed;
		if (!group->failed || group->settled)
			continue;
		counts->rollbacks++;
		for (int k = 0; k < group->count; k++) {
			const int i = apart->swept.member[group->first + k];

			counts->discarded_body_steps += (uint64_t)apart->steps[i];
			apart->swept.failed[i] = 1;
			apart->swept.settled[i] = 0;
			apart->steps[i] = 0;
		}
	}
	for (int k = 0; k < world->stepped->member_count; k++)
		apart->swept.was_group[world->stepped->body[k]] =
			apart->swept.group_of[world->stepped->body[k]];
}

/* ---- one group ---- */

static void cohort_of(struct rb_world *world, const struct rb_swept_group *group)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;

	memcpy(apart->body, apart->swept.member + group->first, (size_t)group->count * sizeof(int));
	memcpy(apart->body + group->count, s->body + s->member_count,
	       (size_t)s->driven_count * sizeof(int));
	rb_swept_bounds_show(&apart->swept, group->pair, group->pair_count);
	s->part.body = apart->body;
	s->part.member_count = group->count;
	s->part.body_count = group->count + s->driven_count;
	s->part.near = &apart->swept.near;
}

static enum rb_status keep_step(struct rb_world *world, double time, double h,
                                const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;
	struct rb_cohort *part = &s->part;
	struct rb_counts *counts = &world->frame_counts;
	const struct rb_contacts swapped = apart->before;
	/* before the group's first step those of all: it has none of its own */
	const struct rb_contacts *before = apart->fresh ? &world->contacts : &apart->last;

	counts->smallest_step_s = fmin(counts->smallest_step_s, h);
	counts->max_penetration_m = fmax(counts->max_penetration_m, outcome->overlap);
	counts->residual_m = fmax(counts->residual_m, outcome->residual);
	counts->slip_m = fmax(counts->slip_m, outcome->slip);
	for (int k = 0; k < part->member_count; k++)
		apart->steps[part->body[k]]++;
	s->reported.count = 0;
	enum rb_status status = rb_record_impacts(world, part, time, before, NULL, err);
	if (status == RB_OK &&
	    !rb_memory_reserve(&apart->event, &apart->event_capacity,
	                       apart->event_count + s->reported.count + 1, sizeof *apart->event))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	for (size_t k = 0; status == RB_OK && k < s->reported.count; k++) {
		const int a = world->model->index_of[s->reported.row[k].a];
		const int b = world->model->index_of[s->reported.row[k].b];

		apart->event[apart->event_count++] = (struct rb_event_of){
			s->reported.row[k], rb_stepped_is_dynamic(world, a) ? a : b};
	}
	if (status == RB_OK && s->tally) {
		const struct rb_entries e = rb_enter_step(world, part, &world->mark, time - h, h,
		                                          NULL);
		rb_entries_add(&apart->entries, 1, &e);
	}
	apart->fresh = false;
	apart->before = apart->last;
	apart->last = swapped;
	apart->last.count = 0;
	if (status == RB_OK)
		status = rb_record_contacts(world, part, h, NULL, &apart->last, err);
	if (status == RB_OK && world->keeps_means)
		status = rb_record_part(part, &apart->last, h, &s->part_contacts, &apart->means,
		                        err);
	rb_contacts_sort(&apart->last);
	if (status == RB_OK)
		status = rb_step_points_keep(&part->points, h, s->solver.stays, NULL, err);
	rb_step_points_index_members(&part->points, part->body, part->member_count);
	return status;
}

/* The bodies and their impulses as they were before the step. */
static enum rb_status begin_group(struct rb_world *world, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;

	rb_state_copy_rows(&world->state, &apart->begin, s->part.body, s->part.body_count);
	if (!rb_step_points_reserve(&s->part.points, s->all.points.last_count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts",
		               s->all.points.last_count);
	rb_step_points_take_last(&s->part.points, &s->all.points, s->part.body,
	                         s->part.member_count);
	apart->fresh = true;
	apart->entries = (struct rb_entries){0};
	apart->last.count = apart->means.count = 0;
	return RB_OK;
}

static enum rb_status resolve(struct rb_world *world, struct rb_swept_group *group, double dt,
                              struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;
	const struct rb_step_points *points = &s->part.points;

	if (!rb_memory_reserve(&apart->push, &apart->push_capacity,
	                       apart->push_count + points->last_count + 1, sizeof *apart->push))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	if (points->last_count > 0)
		memcpy(apart->push + apart->push_count, points->last,
		       points->last_count * sizeof *points->last);
	apart->push_count += points->last_count;
	enum rb_status status = rb_contacts_join(&apart->kept, &apart->last, err);
	if (status == RB_OK)
		status = rb_means_record(&apart->means, dt, &apart->shown, err);
	if (status != RB_OK)
		return status;
	if (s->tally) {
		if (!rb_memory_reserve(&apart->book, &apart->book_capacity, apart->book_count + 1,
		                       sizeof *apart->book))
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the ledger of a step");
		apart->book[apart->book_count++] = (struct rb_entries_of){
			apart->entries, apart->swept.member[group->first]};
	}
	group->settled = true;
	for (int k = 0; k < group->count; k++)
		apart->swept.settled[apart->swept.member[group->first + k]] = 1;
	return RB_OK;
}

enum rb_status rb_local_rollback_give_up(const struct rb_world *world, double start,
                                         const struct rb_attempt_outcome *outcome,
                                         struct rb_error *err)
{
	const struct rb_scene *scene = world->model->scene;
	const int *id_of = world->model->id_of;
	char a[64], b[64];

	if (outcome->body >= 0)
		return RB_FAIL(err, RB_ERR_PHYSICS,
		               "the state of '%s' is not finite after t = %.9g s",
		               rb_scene_body_label(scene, id_of[outcome->body], a), start);
	if (outcome->pair[0] < 0)
		return RB_FAIL(err, RB_ERR_PHYSICS, "no step resolves the impacts after t = %.9g s",
		               start);
	return RB_FAIL(err, RB_ERR_PHYSICS,
	               "no step resolves the overlap of '%s' and '%s' after t = %.9g s (%.3g m "
	               "deep, the tolerance is %.3g m)",
	               rb_scene_body_label(scene, id_of[outcome->pair[0]], a),
	               rb_scene_body_label(scene, id_of[outcome->pair[1]], b), start,
	               outcome->overlap, world->model->tolerance_m);
}

static void reset_arenas(struct rb_world *world)
{
	for (int k = 0; k < world->worker_count; k++)
		rb_arena_reset(&world->arena[k]);
}

/*
 * With the territories as they are now: whether the group is still apart from all others. Its
 * candidates are new.
 */
static bool is_apart(struct rb_world *world, struct rb_swept_group *group, enum rb_status *status,
                     struct rb_error *err)
{
	struct rb_local_rollback *apart = world->stepped->apart;
	const int first = apart->swept.member[group->first], count = group->count;

	*status = rb_swept_bounds_form(&apart->swept, world, err);
	if (*status != RB_OK)
		return false;
	/*
	 * nobody else's territory has changed: if it has met none, all groups are those of before
	 */
	if (apart->swept.group[apart->swept.group_of[first]].count != count)
		return false;
	cohort_of(world, &apart->swept.group[apart->swept.group_of[first]]);
	return true;
}

/* Back to the beginning of the attempt under way. */
static void take_back(struct rb_world *world)
{
	const struct rb_cohort *part = &world->stepped->part;

	rb_state_copy_rows(&world->state, &world->mark, part->body, part->body_count);
	world->frame_counts.discarded_body_steps += (uint64_t)part->member_count;
}

/*
 * The whole step has failed for it: halves of it, and so on. `*left`: somebody has left the
 * territory and could meet others; there it stops.
 */
static enum rb_status run_group(struct rb_world *world, struct rb_swept_group *group, double start,
                                double dt, bool *left, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_cohort *part = &s->part;
	double done = 0, h = 0.5 * dt;
	int halvings = 1;

	cohort_of(world, group);
	enum rb_status status = begin_group(world, err);
	while (status == RB_OK && done < dt) {
		struct rb_attempt_outcome outcome;

		if (rb_world_is_stopped(world))
			return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
		reset_arenas(world);
		rb_state_copy_rows(&world->mark, &world->state, part->body, part->body_count);
		status = rb_attempt(world, part, start + done, h, err);
		if (status == RB_OK)
			status = rb_judge(world, part, h, &outcome, err);
		if (status != RB_OK)
			break;
		if (s->bad_count > 0) {
			take_back(world);
			world->frame_counts.rollbacks++;
			if (++halvings > RB_HALVINGS_MAX)
				return rb_local_rollback_give_up(world, start + done, &outcome,
				                                 err);
			h *= 0.5;
			continue;
		}
		if (rb_swept_bounds_left(&s->apart->swept, world, part, dt - done - h)) {
			take_back(world);
			*left = !is_apart(world, group, &status, err);
			if (*left)
				return status;
			continue;
		}
		done = h < dt - done ? done + h : dt;
		status = keep_step(world, start + done, h, &outcome, err);
		h = fmin(2 * h, dt - done);
		halvings = 0;
	}
	return status == RB_OK ? resolve(world, group, dt, err) : status;
}

/* ---- the step ---- */

/* Until nobody leaves the territory any more; it at least doubles each time. */
static enum rb_status run_groups(struct rb_world *world, double start, double dt,
                                 struct rb_error *err)
{
	struct rb_local_rollback *apart = world->stepped->apart;
	enum rb_status status = RB_OK;
	bool again = true;

	while (again && status == RB_OK) {
		again = false;
		reset_arenas(world);
		status = rb_swept_bounds_form(&apart->swept, world, err);
		if (status != RB_OK)
			break;
		mark_bodies(world);
		forget_unsettled(world);
		for (size_t g = 0; g < apart->swept.group_count && status == RB_OK; g++) {
			const size_t events = apart->event_count;
			bool left = false;

			if (!apart->swept.group[g].failed || apart->swept.group[g].settled)
				continue;
			status = run_group(world, &apart->swept.group[g], start, dt, &left, err);
			if (left)
				apart->event_count = events;
			again = again || left;
		}
	}
	return status;
}

/* For the frames, beside those that keep the whole step. */
static enum rb_status show_contacts(struct rb_world *world, double dt,
                                    const struct rb_contacts *whole, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	world->shown.count = 0;
	enum rb_status status = rb_contacts_join(&world->shown, whole, err);
	if (status == RB_OK)
		status = rb_record_passed(&s->all, dt, s->apart->swept.failed, &world->shown, err);
	if (status == RB_OK)
		status = rb_contacts_join(&world->shown, &s->apart->shown, err);
	rb_contacts_sort(&world->shown);
	world->has_shown = status == RB_OK;
	return status;
}

/* The world's contacts are those of both kinds. */
static enum rb_status join_contacts(struct rb_world *world, double dt, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;
	const struct rb_contacts before = world->contacts;
	struct rb_contacts *to = &world->next_contacts;

	to->count = 0;
	enum rb_status status = rb_record_contacts(world, &s->all, dt, apart->swept.failed, to,
	                                           err);
	if (status == RB_OK && world->keeps_means)
		status = show_contacts(world, dt, to, err);
	if (status == RB_OK)
		status = rb_contacts_join(to, &apart->kept, err);
	if (status != RB_OK)
		return status;
	rb_contacts_sort(to);
	world->contacts = *to;
	*to = before;
	return RB_OK;
}

/* Of those that keep the whole step, then of groups that took shorter ones. */
static void enter_all(struct rb_world *world, double start, double dt)
{
	const struct rb_local_rollback *apart = world->stepped->apart;
	const struct rb_entries whole = rb_enter_step(world, &world->stepped->all, &apart->begin,
	                                              start, dt, apart->swept.failed);

	rb_ledger_enter(&world->ledger, &whole);
	for (size_t k = 0; k < apart->book_count; k++)
		rb_ledger_enter(&world->ledger, &apart->book[k].entries);
}

/*
 * Impulses for the next step: of what was kept of the whole one, then of groups that took shorter
 * ones; by body.
 */
static enum rb_status join_pushes(struct rb_world *world, double dt, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;
	struct rb_step_points *points = &s->all.points;
	size_t kept = 0;

	for (size_t k = 0; k < points->count; k++)
		if (!apart->swept.failed[points->row[k].a])
			points->row[kept++] = points->row[k];
	points->count = kept;
	const enum rb_status status = rb_step_points_keep(points, dt, s->solver.stays,
	                                                  s->sleep.sleeps, err);
	if (status != RB_OK)
		return status;
	const size_t count = points->last_count + apart->push_count;
	struct rb_sort_item *item = rb_arena_take(&world->arena[0], count + 1, sizeof *item);
	struct rb_sort_item *scratch = rb_arena_take(&world->arena[0], count + 1, sizeof *scratch);
	struct rb_named_push *all = rb_arena_take(&world->arena[0], count + 1, sizeof *all);
	if (!item || !scratch || !all || !rb_step_points_reserve(points, count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	if (points->last_count > 0)
		memcpy(all, points->last, points->last_count * sizeof *all);
	if (apart->push_count > 0)
		memcpy(all + points->last_count, apart->push, apart->push_count * sizeof *all);
	for (size_t k = 0; k < count; k++)
		item[k] = (struct rb_sort_item){(uint64_t)all[k].a, k};
	rb_sort_by_key(item, scratch, count);
	for (size_t k = 0; k < count; k++)
		points->last[k] = all[item[k].value];
	points->last_count = count;
	rb_step_points_index(points, world->model);
	return RB_OK;
}

static enum rb_status join_impacts(struct rb_world *world, double end, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_local_rollback *apart = s->apart;

	s->reported.count = 0;
	const enum rb_status status = rb_record_impacts(world, &s->all, end, &world->contacts,
	                                                apart->swept.failed, err);
	if (status != RB_OK)
		return status;
	if (!rb_memory_reserve(&s->reported.row, &s->reported.capacity,
	                       s->reported.count + apart->event_count + 1,
	                       sizeof *s->reported.row) ||
	    !rb_record_reserve(world, s->reported.count + apart->event_count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	for (size_t k = 0; k < apart->event_count; k++)
		s->reported.row[s->reported.count++] = apart->event[k].event;
	return RB_OK;
}

/* What those have come to that keep the whole step, and how many steps all have taken. */
static enum rb_status count_steps(struct rb_world *world, double dt,
                                  const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_local_rollback *apart = s->apart;
	struct rb_counts *counts = &world->frame_counts;
	struct rb_depths found = {0};
	enum rb_status status = RB_OK;
	bool some = false;

	for (int k = 0; k < s->member_count; k++)
		counts->body_steps += (uint64_t)apart->steps[s->body[k]];
	for (size_t g = 0; g < apart->swept.group_count; g++) {
		const struct rb_swept_group *group = &apart->swept.group[g];

		some = some || !group->failed;
		if (group->failed)
			counts->substeps += (uint64_t)
			                            apart->steps[apart->swept.member[group->first]];
	}
	if (!some)
		return RB_OK;
	counts->substeps++;
	counts->smallest_step_s = fmin(counts->smallest_step_s, dt);
	counts->residual_m = fmax(counts->residual_m, outcome->residual);
	counts->slip_m = fmax(counts->slip_m, outcome->slip);
	rb_swept_bounds_show(&apart->swept, 0, apart->swept.pair_count);
	rb_candidates_place(&apart->swept.near, world, s->body, world->model->body_count);
	if (world->broadphase)
		status = rb_depths_find(world, &apart->swept.near, apart->swept.failed, NULL,
		                        &found, err);
	counts->max_penetration_m = fmax(counts->max_penetration_m, found.max);
	return status;
}

/* Driven bodies have gone with each group; they end where the step does. */
static enum rb_status end_drive(struct rb_world *world, double start, double dt,
                                struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	rb_state_copy_rows(&world->state, &s->apart->begin, s->body + s->member_count,
	                   s->driven_count);
	const enum rb_status status = rb_drive_begin(world, start, dt, err);
	if (status == RB_OK)
		rb_drive_end(world);
	return status;
}

enum rb_status rb_local_rollback_step(struct rb_world *world, double start, double dt,
                                      const struct rb_attempt_outcome *outcome,
                                      struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = s->apart ? RB_OK : create(world, err);

	if (status != RB_OK) {
		rb_state_copy(&world->state, &world->mark);
		return status;
	}
	struct rb_local_rollback *apart = s->apart;
	rb_state_copy(&apart->begin, &world->mark);
	rb_swept_bounds_set(&apart->swept, world, &apart->begin, dt);
	for (int i = 0; i < world->model->body_count; i++) {
		apart->swept.failed[i] = s->bad[i];
		apart->swept.settled[i] = 0;
		apart->swept.was_group[i] = -1;
		apart->steps[i] = 1;
	}
	apart->kept.count = apart->shown.count = apart->push_count = apart->event_count =
		apart->book_count = 0;
	if (!rb_candidates_keep(&s->near))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs", s->near.pair_count);
	if (status == RB_OK)
		status = run_groups(world, start, dt, err);
	if (status == RB_OK)
		status = end_drive(world, start, dt, err);
	reset_arenas(world);
	rb_sleep_wake(world, apart->swept.failed);
	if (status == RB_OK)
		status = count_steps(world, dt, outcome, err);
	if (status == RB_OK)
		status = join_impacts(world, start + dt, err);
	if (status == RB_OK)
		status = join_contacts(world, dt, err);
	if (status == RB_OK && s->tally)
		enter_all(world, start, dt);
	if (status == RB_OK)
		status = join_pushes(world, dt, err);
	if (status == RB_OK) {
		rb_sleep_end(world, start + dt, apart->swept.failed);
		return RB_OK;
	}
	rb_state_copy(&world->state, &apart->begin);
	rb_sleep_forget(s);
	return status;
}
