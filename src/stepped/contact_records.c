/* SPDX-License-Identifier: MIT */
/*
 * Records for users from solved points: contacts with mean forces over the step, and collision
 * events. A point is reported either as a force or as an impact, never both. Lists are in order of
 * bodies; contacts of sleeping groups are not recomputed but merged in from the last step's list.
 */
#include "stepped/contact_records.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "world/joint_events.h"

/* Lever arm from the centre of mass of a to where the impulse acts, m. */
static rb_vec3 lever_of(const struct rb_step_point *point)
{
	return point->central ? rb_vec3_scale(point->arm_a.x, point->normal) : point->lever;
}

/*
 * Puts the lower index first, as in public records; within the method a driven body is always
 * second, so the pair may have to be swapped, with the signs of its vectors.
 */
static struct rb_contact in_order(struct rb_contact contact)
{
	const int a = contact.a;

	RB_ASSERT_COSTLY(contact.a != contact.b);
	if (a < contact.b)
		return contact;
	contact.a = contact.b;
	contact.b = a;
	contact.normal = rb_vec3_neg(contact.normal);
	contact.tangent_force = rb_vec3_neg(contact.tangent_force);
	return contact;
}

/*
 * Force = impulse / h, with the rebound at the end of the step; points reported as impacts have
 * none. A resting group keeps the numbers of the step that put it to rest: recomputing them from a
 * step of slightly different length would change the last bits.
 */
static struct rb_contact contact_of(const struct rb_world *world, const struct rb_cohort *cohort,
                                    size_t at, double h)
{
	const struct rb_step_points *points = &cohort->points;
	const struct rb_step_point *point = &points->row[at];
	const bool asleep = world->stepped->solver.asleep[point->a] && point->from > 0;
	struct rb_contact contact = {
		.a = point->a,
		.b = point->b,
		.point = rb_vec3_add(rb_world_row3(world->state.position, point->a),
	                             lever_of(point)),
		.normal = point->normal,
		.gap = point->gap,
		.parts = point->parts,
		.key = point->key,
	};

	RB_ASSERT_COSTLY(h > 0 && at < points->count);
	if (asleep) {
		contact.normal_force = points->last[point->from - 1].force;
		contact.tangent_force = points->last[point->from - 1].friction_impulse;
	} else if (!point->after_impact) {
		const rb_vec3 added = rb_cohort_extra_impulse(cohort, at);
		const double more = rb_vec3_dot(added, point->normal);

		contact.normal_force = (point->normal_impulse + more) / h;
		contact.tangent_force = rb_vec3_scale(
			1 / h, rb_vec3_add(point->friction_impulse,
		                           rb_vec3_add_scaled(added, -more, point->normal)));
	}
	/* relinearization, or the step that put it to rest, may have had another normal */
	contact.tangent_force = rb_vec3_reject(contact.tangent_force, contact.normal);
	return in_order(contact);
}

/* Number of points of the pair that begins at `first`; points of a pair are adjacent. */
static size_t pair_length(const struct rb_step_points *points, size_t first)
{
	size_t end = first + 1;

	while (end < points->count && points->row[end].a == points->row[first].a &&
	       points->row[end].b == points->row[first].b)
		end++;
	return end - first;
}

/*
 * Merges in the contacts of sleeping bodies from the last step's list that precede `before`;
 * returns the index at which the list continues.
 */
static size_t add_resting(const struct rb_world *world, size_t from, const unsigned char *skip,
                          const struct rb_contact *before, struct rb_contacts *to)
{
	const struct rb_contacts *last = &world->contacts;
	const unsigned char *sleeps = world->stepped->sleep.sleeps;

	for (; from < last->count; from++) {
		const struct rb_contact *contact = &last->row[from];
		const int i = rb_stepped_is_dynamic(world, contact->a) ? contact->a : contact->b;

		if (before &&
		    (contact->a > before->a || (contact->a == before->a && contact->b > before->b)))
			break;
		if (sleeps[i] && !(skip && skip[i]))
			to->row[to->count++] = *contact;
	}
	return from;
}

/* Whether the cohort includes sleeping bodies. */
static bool has_resting(const struct rb_world *world, const struct rb_cohort *cohort)
{
	return cohort == &world->stepped->all && world->stepped->sleep.count > 0;
}

static size_t contacts_max(const struct rb_world *world, const struct rb_cohort *cohort)
{
	return cohort->points.chosen_count +
	       (has_resting(world, cohort) ? world->contacts.count : 0);
}

enum rb_status rb_record_scratch(struct rb_world *world, struct rb_cohort *cohort, size_t more,
                                 struct rb_contacts *scratch, struct rb_error *err)
{
	const enum rb_status status = rb_step_points_choose(&cohort->points, world,
	                                                    -(double)INFINITY, err);
	const size_t max = contacts_max(world, cohort) + more;

	*scratch = (struct rb_contacts){.capacity = max};
	if (status != RB_OK)
		return status;
	scratch->row = rb_arena_take(&world->arena[0], max, sizeof *scratch->row);
	return scratch->row ? RB_OK
	                    : RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", max);
}

struct records {
	const struct rb_world *world;
	const struct rb_cohort *cohort;
	struct rb_contact *to;
	double h_s;
};

enum { RECORDS_PER_BLOCK = 256 };

static void record_chosen(void *user, size_t first, size_t end)
{
	const struct records *records = user;
	const int *const chosen = records->cohort->points.chosen;

	for (size_t c = first; c < end; c++)
		records->to[c] = contact_of(records->world, records->cohort, (size_t)chosen[c],
		                            records->h_s);
}

enum rb_status rb_record_contacts(struct rb_world *world, const struct rb_cohort *cohort, double h,
                                  const unsigned char *skip, struct rb_contacts *to,
                                  struct rb_error *err)
{
	const struct rb_step_points *points = &cohort->points;
	const bool all = has_resting(world, cohort);
	size_t old = 0;
	const enum rb_status status = rb_contacts_reserve(
		to, to->count + contacts_max(world, cohort), err);

	RB_ASSERT(h > 0);
	if (status != RB_OK)
		return status;
	if (!all && !skip) {
		struct records records = {world, cohort, to->row + to->count, h};

		rb_team_share(world->team, points->chosen_count, RECORDS_PER_BLOCK, record_chosen,
		              &records);
		to->count += points->chosen_count;
		return RB_OK;
	}
	for (size_t c = 0; c < points->chosen_count; c++) {
		const size_t k = (size_t)points->chosen[c];

		if (skip && skip[points->row[k].a])
			continue;
		const struct rb_contact contact = contact_of(world, cohort, k, h);
		if (all)
			old = add_resting(world, old, skip, &contact, to);
		to->row[to->count++] = contact;
	}
	if (all)
		(void)add_resting(world, old, skip, NULL, to);
	return RB_OK;
}

enum rb_status rb_record_space(struct rb_world *world, struct rb_cohort *cohort,
                               struct rb_error *err)
{
	const enum rb_status status = rb_step_points_choose(&cohort->points, world,
	                                                    -(double)INFINITY, err);

	return status == RB_OK
	               ? rb_contacts_reserve(&world->contacts, contacts_max(world, cohort), err)
	               : status;
}

void rb_record_keep(const struct rb_world *world, struct rb_contacts *contacts,
                    const unsigned char *of_body)
{
	size_t kept = 0;

	for (size_t k = 0; k < contacts->count; k++) {
		const struct rb_contact *contact = &contacts->row[k];

		if (of_body[rb_stepped_is_dynamic(world, contact->a) ? contact->a : contact->b])
			contacts->row[kept++] = *contact;
	}
	contacts->count = kept;
}

void rb_record_in_place(struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	struct rb_contacts *const contacts = &world->contacts;
	const struct rb_step_points *points = &cohort->points;

	RB_ASSERT(h > 0);
	if (has_resting(world, cohort))
		rb_record_keep(world, &world->contacts, world->stepped->sleep.sleeps);
	else
		contacts->count = 0;
	size_t old = contacts->count, end = old + points->chosen_count;
	RB_ASSERT(end <= contacts->capacity);
	contacts->count = end;
	if (old == 0) {
		struct records records = {world, cohort, contacts->row, h};

		rb_team_share(world->team, points->chosen_count, RECORDS_PER_BLOCK, record_chosen,
		              &records);
		return;
	}
	/* merge from the end, where there is space: both lists are sorted */
	for (size_t c = points->chosen_count; c-- > 0;) {
		const struct rb_contact contact = contact_of(world, cohort,
		                                             (size_t)points->chosen[c], h);

		while (old > 0 && (contacts->row[old - 1].a > contact.a ||
		                   (contacts->row[old - 1].a == contact.a &&
		                    contacts->row[old - 1].b > contact.b)))
			contacts->row[--end] = contacts->row[--old];
		contacts->row[--end] = contact;
	}
	RB_ASSERT(end == old);
}

enum rb_status rb_record_transmitted(const struct rb_cohort *cohort, double h,
                                     const unsigned char *skip, struct rb_contacts *to,
                                     struct rb_error *err)
{
	const struct rb_contacts *passed = &cohort->transmitted;
	const enum rb_status status = rb_contacts_reserve(to, to->count + passed->count, err);

	RB_ASSERT(h > 0);
	for (size_t k = 0; status == RB_OK && k < passed->count; k++) {
		struct rb_contact contact = passed->row[k];

		if (skip && skip[contact.a])
			continue;
		contact.normal_force /= h;
		contact.tangent_force = rb_vec3_scale(1 / h, contact.tangent_force);
		to->row[to->count++] = in_order(contact);
	}
	return status;
}

enum rb_status rb_record_part(const struct rb_cohort *cohort, const struct rb_contacts *contacts,
                              double h, struct rb_contacts *scratch, struct rb_mean_forces *means,
                              struct rb_error *err)
{
	scratch->count = 0;
	enum rb_status status = rb_contacts_join(scratch, contacts, err);
	if (status == RB_OK)
		status = rb_record_transmitted(cohort, h, NULL, scratch, err);
	return status == RB_OK ? rb_mean_forces_add(means, scratch, h, err) : status;
}

/*
 * Fills the event of a pair that was not in contact before the step and approached by more than the
 * solver's residual; false: no impulse. Its impulse is that of the whole step.
 */
static bool is_impact(const struct rb_world *world, const struct rb_cohort *cohort, size_t first,
                      size_t length, struct rb_event *event)
{
	const struct rb_step_point *point = &cohort->points.row[first];
	double normal_impulse = 0, approach = 0;

	*event = (struct rb_event){
		.kind = RB_EVENT_COLLISION, .a = point->a, .b = point->b, .normal = point->normal};
	for (size_t k = 0; k < length; k++) {
		const rb_vec3 added = rb_cohort_extra_impulse(cohort, first + k);
		const double along = point[k].normal_impulse + rb_vec3_dot(added, point[k].normal);

		if (!(along > 0))
			continue;
		event->impulse = rb_vec3_add(
			event->impulse,
			rb_vec3_add(rb_vec3_add_scaled(point[k].friction_impulse,
		                                       point[k].normal_impulse, point[k].normal),
		                    added));
		normal_impulse += along;
		approach = fmax(approach, point[k].approach);
		event->point = rb_vec3_add_scaled(event->point, along, lever_of(&point[k]));
	}
	event->approach_speed = approach;
	if (!(normal_impulse > 0))
		return false;
	event->point = rb_vec3_add_scaled(rb_world_row3(world->state.position, point->a),
	                                  1 / normal_impulse, event->point);
	return true;
}

/* Appends an event with public ids, the smaller first. */
static enum rb_status add_recorded(struct rb_world *world, struct rb_event event,
                                   struct rb_error *err)
{
	struct rb_events *reported = &world->stepped->reported;
	const int a = world->model->id_of[event.a], b = world->model->id_of[event.b];

	if (!rb_memory_reserve(&reported->row, &reported->capacity, reported->count + 1,
	                       sizeof *reported->row))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (a > b) {
		event.normal = rb_vec3_neg(event.normal);
		event.impulse = rb_vec3_neg(event.impulse);
	}
	event.a = a < b ? a : b;
	event.b = a < b ? b : a;
	reported->row[reported->count++] = event;
	return RB_OK;
}

/*
 * Records impacts resolved within the step; crowded ones, left to its end, enter only the counts.
 */
static enum rb_status record_resolved(struct rb_world *world, const struct rb_cohort *cohort,
                                      double time, const unsigned char *skip, struct rb_error *err)
{
	struct rb_counts *counts = &world->frame_counts;
	enum rb_status status = RB_OK;

	for (size_t k = 0; k < cohort->impact_count && status == RB_OK; k++) {
		const struct rb_step_impact *impact = &cohort->impact[k];

		if (skip && skip[impact->a])
			continue;
		counts->plastic_ends += impact->plastic;
		counts->crowded_impacts += impact->crowded;
		counts->crowded_energy_j += impact->energy;
		if (impact->crowded)
			continue;
		const struct rb_event event = {.kind = RB_EVENT_COLLISION,
		                               .time_s = fmin(impact->time_s, time),
		                               .a = impact->a,
		                               .b = impact->b,
		                               .point = impact->point,
		                               .normal = impact->normal,
		                               .impulse = impact->impulse,
		                               .approach_speed = impact->approach};
		status = add_recorded(world, event, err);
	}
	return status;
}

/* Search whether the pairs of chosen points were in contact before the step. */
struct lookup {
	const struct rb_step_points *points;
	const struct rb_contacts *before;
	bool *known; /* [chosen]: for the first point of each pair */
};

static void find_known(void *user, size_t first, size_t end)
{
	const struct lookup *lookup = user;
	const struct rb_step_points *points = lookup->points;

	for (size_t c = first; c < end; c++) {
		const struct rb_step_point *point = &points->row[points->chosen[c]];
		const int a = point->a, b = point->b;

		if (c > 0 && points->row[points->chosen[c - 1]].a == a &&
		    points->row[points->chosen[c - 1]].b == b)
			continue;
		lookup->known[c] = rb_contacts_find(lookup->before, a < b ? a : b, a < b ? b : a);
	}
}

enum rb_status rb_record_impacts(struct rb_world *world, struct rb_cohort *cohort, double time,
                                 const struct rb_contacts *before, const unsigned char *skip,
                                 struct rb_error *err)
{
	struct rb_step_points *points = &cohort->points;
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	enum rb_status status = record_resolved(world, cohort, time, skip, err);
	size_t end = 0;

	/* few points have approached: most are lasting contacts */
	if (status == RB_OK)
		status = rb_step_points_choose(points, world, world->stepped->solver.tolerance,
		                               err);
	if (status != RB_OK)
		return status;
	struct lookup lookup = {
		points, before,
		rb_arena_take(&world->arena[0], points->chosen_count + 1, sizeof *lookup.known)};
	if (!lookup.known)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	rb_team_share(world->team, points->chosen_count, RECORDS_PER_BLOCK, find_known, &lookup);
	for (size_t c = 0; status == RB_OK && c < points->chosen_count; c++) {
		size_t k = (size_t)points->chosen[c];
		const int i = points->row[k].a, j = points->row[k].b;
		struct rb_event event;

		if (k < end) /* of a pair that is done */
			continue;
		while (k > end && points->row[k - 1].a == i && points->row[k - 1].b == j)
			k--;
		end = k + pair_length(points, k);
		if ((skip && skip[i]) || lookup.known[c] ||
		    !is_impact(world, cohort, k, end - k, &event))
			continue;
		for (size_t p = k; p < end; p++)
			points->row[p].after_impact = true;
		event.time_s = time;
		status = add_recorded(world, event, err);
	}
	rb_arena_back(&world->arena[0], here);
	return status;
}

/*
 * Order by time, then by ids, joints and kinds: independent of the order in which groups were
 * solved.
 */
static int by_time(const void *left, const void *right)
{
	const struct rb_event *x = left, *y = right;

	if (x->time_s != y->time_s)
		return x->time_s < y->time_s ? -1 : 1;
	if (x->a != y->a)
		return x->a < y->a ? -1 : 1;
	if (x->b != y->b)
		return x->b < y->b ? -1 : 1;
	if (x->joint != y->joint)
		return x->joint < y->joint ? -1 : 1;
	return (x->kind > y->kind) - (x->kind < y->kind);
}

bool rb_record_reserve(struct rb_world *world, size_t count)
{
	struct rb_events *events = &world->events;

	return rb_memory_reserve(&events->row, &events->capacity, events->count + count + 1,
	                         sizeof *events->row);
}

enum rb_status rb_record_all(struct rb_world *world, struct rb_error *err)
{
	struct rb_events *reported = &world->stepped->reported, *events = &world->events;
	const size_t first = events->count, count = reported->count;

	enum rb_status status = RB_OK;

	reported->count = 0;
	if (count == 0)
		return RB_OK;
	qsort(reported->row, count, sizeof *reported->row, by_time);
	for (size_t k = 0; k < count && status == RB_OK; k++)
		status = rb_world_add_event(world, &reported->row[k], err);
	return status == RB_OK ? rb_world_report_events(world, first, err) : status;
}
