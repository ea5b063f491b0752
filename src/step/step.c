/* SPDX-License-Identifier: MIT */
#include "step/step.h"

#include "base/memory.h"
#include "base/sort.h"
#include "event/engine.h"
#include "step/groups.h"
#include "step/numbers.h"
#include "step/rollback.h"
#include "step/verdict.h"

#include <float.h>
#include <string.h>

/* Work is cut into blocks of this size, whatever the number of workers. */
enum { ALONE_PER_BLOCK = 256, GROUPS_PER_BLOCK = 8 };

/* A frame of very many steps can be stopped within. */
enum { STEPS_PER_POLL = 1024 };

/* ---- making a world ---- */

static void start_state(struct rb_world *world)
{
	const struct rb_model *model = world->model;
	struct rb_state *state = &world->state;

	for (int i = 0; i < model->body_count; i++) {
		const struct rb_body_def *body = &model->scene->bodies[model->id_of[i]];
		rb_vec3 center = model->position[i];

		if (model->center_of_mass)
			center = rb_vec3_add(center, rb_quat_rotate(model->orientation[i],
			                                            model->center_of_mass[i]));
		rb_vec3_to(state->position + 3 * (size_t)i, center);
		rb_vec3_to(state->velocity + 3 * (size_t)i, body->velocity);
		if (state->orientation) {
			rb_quat_to(state->orientation + 4 * (size_t)i, model->orientation[i]);
			rb_vec3_to(state->spin + 3 * (size_t)i, body->angular_velocity);
		}
	}
}

enum rb_status rb_world_create(struct rb_world **made, const struct rb_model *model,
                               const struct rb_world_options *options,
                               const struct rb_world_hooks *hooks, struct rb_error *err)
{
	struct rb_world *world = rb_memory_take(1, sizeof *world);
	enum rb_status status = RB_OK;

	*made = NULL;
	if (!world)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a world");
	world->model = model;
	world->options = *options;
	if (hooks)
		world->hooks = *hooks;
	world->frame_counts = world->total_counts = rb_counts_none;
	world->worker_count = options->threads > 1 ? options->threads : 1;
	world->arena = rb_memory_take((size_t)world->worker_count, sizeof *world->arena);
	world->kept = rb_memory_take((size_t)world->worker_count, sizeof *world->kept);
	world->plan = rb_memory_take(1, sizeof *world->plan);
	if (!world->arena || !world->kept || !world->plan)
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for a world");
	if (status == RB_OK)
		status = rb_state_init(&world->state, model->body_count, model->features, err);
	if (status == RB_OK)
		status = rb_state_init(&world->start, model->body_count, model->features, err);
	const bool classic = model->method == RB_METHOD_CLASSIC;
	if (status == RB_OK && classic && (model->features & RB_FEATURE_CONTACT))
		status = rb_state_init(&world->mark, model->body_count, model->features, err);
	if (status == RB_OK)
		status = rb_team_create(&world->team, world->worker_count, err);
	if (status == RB_OK && classic)
		status = rb_groups_create(&world->groups, model, err);
	if (status == RB_OK && classic && (model->features & RB_FEATURE_CONTACT))
		status = rb_broadphase_create(&world->broadphase, model, err);
	if (status == RB_OK) {
		rb_plan_build(world->plan, model->features);
		start_state(world);
	}
	if (status == RB_OK && !classic)
		status = rb_engine_create(&world->located, world, err);
	if (status != RB_OK) {
		rb_world_destroy(world);
		return status;
	}
	*made = world;
	return RB_OK;
}

void rb_world_destroy(struct rb_world *world)
{
	if (!world)
		return;
	rb_team_destroy(world->team);
	rb_engine_destroy(world->located);
	for (int k = 0; world->arena && k < world->worker_count; k++)
		rb_arena_release(&world->arena[k]);
	for (int k = 0; world->kept && k < world->worker_count; k++)
		rb_arena_release(&world->kept[k]);
	rb_memory_free(world->arena);
	rb_memory_free(world->kept);
	rb_memory_free(world->plan);
	rb_state_release(&world->state);
	rb_state_release(&world->start);
	rb_state_release(&world->mark);
	rb_contacts_release(&world->contacts);
	rb_contacts_release(&world->next_contacts);
	rb_memory_free(world->events.row);
	rb_groups_destroy(world->groups);
	rb_broadphase_destroy(world->broadphase);
	rb_memory_free(world);
}

/* ---- one step ---- */

/* What the workers of a step share; set before they start, then only read, but for each block's own row. */
struct step_work {
	struct rb_world *world;
	double start_s, dt_s;
	size_t first_group;
	int *bad; /* [blocks of bodies alone]: a body that is not finite, else -1 */
};

static void fly_block(void *user, int block, int worker)
{
	const struct step_work *work = user;
	struct rb_world *world = work->world;
	const struct rb_groups *groups = world->groups;
	const int first = block * ALONE_PER_BLOCK;
	const int rest = groups->alone_count - first;
	struct rb_pass pass = {.world = world,
	                       .arena = &world->arena[worker],
	                       .member = groups->alone + first,
	                       .member_count = rest < ALONE_PER_BLOCK ? rest : ALONE_PER_BLOCK,
	                       .start_s = work->start_s,
	                       .dt_s = work->dt_s,
	                       .h_s = work->dt_s};

	rb_plan_run(world->plan, &pass);
	work->bad[block] = -1;
	for (int k = 0; k < pass.member_count && work->bad[block] < 0; k++)
		if (!rb_verdict_finite(&world->state, pass.member[k]))
			work->bad[block] = pass.member[k];
}

static enum rb_status fly_alone(struct rb_world *world, struct step_work *work,
                                struct rb_error *err)
{
	const struct rb_groups *groups = world->groups;
	const int blocks = (groups->alone_count + ALONE_PER_BLOCK - 1) / ALONE_PER_BLOCK;
	char label[64];

	if (blocks == 0)
		return RB_OK;
	work->bad = rb_arena_take(&world->arena[0], (size_t)blocks, sizeof *work->bad);
	if (!work->bad)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	rb_team_run(world->team, blocks, fly_block, work);
	world->frame_counts.substeps++;
	world->frame_counts.body_steps += (uint64_t)groups->alone_count;
	world->frame_counts.smallest_step_s = fmin(world->frame_counts.smallest_step_s, work->dt_s);
	for (int b = 0; b < blocks; b++)
		if (work->bad[b] >= 0)
			return RB_FAIL(err, RB_ERR_PHYSICS,
			               "the state of '%s' is not finite after t = %.9g s",
			               rb_scene_body_label(world->model->scene,
			                                   world->model->id_of[work->bad[b]],
			                                   label),
			               work->start_s);
	return RB_OK;
}

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

/* The groups from `first` on; the first failure in order of groups is the step's. */
static enum rb_status run_groups(struct rb_world *world, struct step_work *work, size_t first,
                                 struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	const size_t count = groups->group_count - first;

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

static bool keep_contacts(struct rb_world *world)
{
	struct rb_groups *groups = world->groups;
	size_t most = 0;

	for (size_t g = 0; g < groups->group_count; g++)
		most += groups->group[g].dead ? 0 : (size_t)groups->group[g].touch_count;
	if (rb_contacts_reserve(&world->next_contacts, most, NULL) != RB_OK)
		return false;

	/* groups are in no order of pairs: sorted by key at the end */
	struct rb_sort_item *item = rb_arena_take(&world->arena[0], 2 * most, sizeof *item);
	struct rb_contact *row = rb_arena_take(&world->arena[0], most, sizeof *row);
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
			                                   .normal = pass->now[k].normal,
			                                   .gap = pass->now[k].gap,
			                                   .normal_force = touch->normal_force,
			                                   .tangent_force = touch->tangent_force};
		}
	}
	rb_sort_by_key(item, item + most, count);
	for (size_t k = 0; k < count; k++)
		world->next_contacts.row[k] = row[item[k].value];
	world->next_contacts.count = count;
	const struct rb_contacts last = world->contacts;
	world->contacts = world->next_contacts;
	world->next_contacts = last;
	return true;
}

static struct rb_event with_ids(const struct rb_model *model, struct rb_event event)
{
	const int a = model->id_of[event.a], b = model->id_of[event.b];

	event.a = a;
	event.b = b;
	if (a >
	    b) { /* ids and indices need not be in the same order: statics come last among indices */
		event.a = b;
		event.b = a;
		event.normal = rb_vec3_neg(event.normal);
		event.impulse = rb_vec3_neg(event.impulse);
	}
	return event;
}

/* Appends the events of all groups in order of time and then of pair; `*first` is where they begin. */
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
	/* stable sorts, the last key first; times are not negative, so their bits sort like they do */
	rb_sort_by_key(item, item + count, count);
	for (size_t k = 0; k < count; k++)
		memcpy(&item[k].key, &event[item[k].value].time_s, sizeof item[k].key);
	rb_sort_by_key(item, item + count, count);
	for (size_t k = 0; k < count; k++)
		events->row[events->count++] = event[item[k].value];
	return true;
}

static enum rb_status commit(struct rb_world *world, struct rb_error *err)
{
	struct rb_groups *groups = world->groups;
	size_t first = 0;

	for (size_t g = 0; g < groups->group_count; g++) {
		const struct rb_group *group = &groups->group[g];
		struct rb_counts counts = group->pass.counts;

		if (group->dead) { /* its work was in vain */
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
	if (!world->hooks.collision) {
		if (!world->options.keep_events)
			world->events.count = 0;
		return RB_OK;
	}
	for (size_t k = first; k < world->events.count; k++) {
		const enum rb_status status = world->hooks.collision(world->hooks.user, world,
		                                                     &world->events.row[k], err);

		if (status != RB_OK)
			return status;
	}
	if (!world->options.keep_events)
		world->events.count = 0;
	return RB_OK;
}

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
	return status;
}

/* What callbacks push with holds for one step. */
static void forget_pushes(struct rb_world *world)
{
	const size_t n = (size_t)world->model->body_count;

	if (!world->state.push)
		return;
	memset(world->state.push, 0, 3 * n * sizeof(double));
	memset(world->state.twist, 0, 3 * n * sizeof(double));
}

/* Of the located method: nothing but callbacks knows of steps. */
static enum rb_status step_located(struct rb_world *world, double start, double dt,
                                   struct rb_error *err)
{
	enum rb_status status = RB_OK;

	if (world->hooks.step)
		status = world->hooks.step(world->hooks.user, world, start, dt, err);
	if (status == RB_OK && (world->model->features & RB_FEATURE_PUSHES))
		status = rb_engine_take_changes(world->located, start, err);
	if (status == RB_OK)
		status = rb_engine_advance(world->located, start + dt, err);
	if (status == RB_OK && (world->model->features & RB_FEATURE_PUSHES)) {
		rb_state_copy(&world->start, &world->state);
		forget_pushes(world);
	}
	return status;
}

static enum rb_status step(struct rb_world *world, double start, double dt, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	if (world->located)
		return step_located(world, start, dt, err);
	for (int k = 0; k < world->worker_count; k++) {
		rb_arena_reset(&world->arena[k]);
		rb_arena_reset(&world->kept[k]);
	}
	if (world->hooks.step) {
		status = world->hooks.step(world->hooks.user, world, start, dt, err);
		if (status != RB_OK)
			return status;
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
	forget_pushes(world);
	return commit(world, err);
}

int64_t rb_step_count(double interval, double time_step)
{
	const double quotient = interval / time_step;
	const double whole = nearbyint(quotient);
	const double count = fabs(quotient - whole) <= 8 * DBL_EPSILON * quotient ? whole
	                                                                          : ceil(quotient);

	return count >= 1 ? (int64_t)fmin(count, 0x1p62) : 1;
}

static bool asked_to_stop(const struct rb_world *world)
{
	return world->options.stop && world->options.stop(world->options.stop_user);
}

enum rb_status rb_world_step_frame(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const double begin = rb_model_frame_time(model, world->state.frame);
	const double end = rb_model_frame_time(model, world->state.frame + 1);
	/* the difference of two times has their rounding: a whole interval is known better */
	const double interval = 1 / model->frame_rate;
	const bool whole = fabs(end - begin - interval) <= 4 * DBL_EPSILON * end;
	const bool by_steps = !world->located || (model->features & RB_FEATURE_PUSHES);
	const int64_t steps =
		by_steps ? rb_step_count(whole ? interval : end - begin, model->time_step_s) : 1;

	for (int64_t k = 0; k < steps; k++) {
		const double start = begin + (end - begin) * ((double)k / (double)steps);
		const double stop = k + 1 < steps ? begin + (end - begin) * ((double)(k + 1) /
		                                                             (double)steps)
		                                  : end;
		const enum rb_status status = step(world, start, stop - start, err);

		if (status != RB_OK && status != RB_ERR_INTERRUPT)
			return status;
		if (status == RB_OK)
			world->state.time_s = stop;
		const bool look = k % STEPS_PER_POLL == STEPS_PER_POLL - 1 && k + 1 < steps;
		if (status == RB_ERR_INTERRUPT || (look && asked_to_stop(world))) {
			world->stopped = true;
			return RB_OK;
		}
	}
	world->state.frame++;
	world->stopped = asked_to_stop(world);
	return RB_OK;
}
