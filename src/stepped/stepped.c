/* SPDX-License-Identifier: MIT */
/*
 * Top level of the stepped method: memory, the loop of attempts and halvings, commit, and the
 * checkpoint. Equations and the course of one attempt are in stepped.h; around it:
 *
 *     step h: attempt (attempt) ---> verdict (judge), for each body
 *                                       |
 *       all good -----------------------+--> commit: contacts, events, ledger, joints, sleep
 *       some bad, rollback selective ---+--> commit the groups without bad bodies, the others
 *                                       |    take h / 2, and so on (local_rollback)
 *       some bad, rollback global ------+--> all back, h / 2; doubled after each success
 *       not finite, rollback none ------+--> all back, h / 2; other failures are kept
 *
 * Until commit, world->mark holds the beginning of the step; every error copies it back, so that a
 * failed step leaves the world as it was.
 */
#include "stepped/stepped.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "model/shape.h"
#include "stepped/attempt.h"
#include "stepped/contact_records.h"
#include "stepped/energy.h"
#include "stepped/step_ledger.h"
#include "stepped/impact_pass.h"
#include "stepped/joint_records.h"
#include "stepped/joint_steps.h"
#include "stepped/judge.h"
#include "stepped/local_rollback.h"
#include "stepped/sleep.h"
#include "stepped/stepped_invariants.h"
#include "stepped/strategies.h"
#include "stepped/wide.h"

/* ---- storage ---- */

/* List of bodies: dynamic ones ascending, then driven ones ascending. */
static enum rb_status take_bodies(struct rb_stepped *s, const struct rb_model *model,
                                  struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	s->body = rb_memory_take(n, sizeof *s->body);
	s->saved_velocity = rb_memory_take(6 * n, sizeof *s->saved_velocity);
	s->bad = rb_memory_take(n, 1);
	if (!s->body || !s->saved_velocity || !s->bad)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	for (int i = 0; i < model->body_count; i++)
		if (model->inverse_mass[i] > 0)
			s->body[s->member_count++] = i;
	for (int i = 0; i < model->body_count; i++)
		if (!(model->inverse_mass[i] > 0))
			s->body[s->member_count + s->driven_count++] = i;
	s->driven_end = rb_memory_take((size_t)s->driven_count, sizeof *s->driven_end);
	if (!s->driven_end)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %d driven bodies",
		               s->driven_count);
	rb_sleep_gather(s);
	s->all.candidates = &s->candidates;
	s->all.divides = model->rollback == RB_ROLLBACK_SELECTIVE;
	return RB_OK;
}

/* Arrays for springs, fields and drag. */
static enum rb_status take_forces(struct rb_stepped *s, const struct rb_model *model,
                                  struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	if (model->features & RB_FEATURES_VARIED) {
		s->varied = rb_memory_take(3 * n, sizeof *s->varied);
		if (!s->varied)
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	}
	if (model->features & RB_FEATURE_DRAG) {
		s->undragged = rb_memory_take(n, sizeof *s->undragged);
		if (!s->undragged)
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	}
	return RB_OK;
}

/* Principal axes for bodies with unequal moments of inertia. */
static enum rb_status take_tops(struct rb_stepped *s, const struct rb_model *model,
                                struct rb_error *err)
{
	if (!(model->features & RB_FEATURE_GYROSCOPIC))
		return RB_OK;
	s->top = rb_memory_take((size_t)model->body_count, sizeof *s->top);
	if (!s->top)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	for (int i = 0; i < model->body_count; i++)
		if (model->inverse_mass[i] > 0)
			s->top[i] = *rb_model_top(model, i);
	return RB_OK;
}

/*
 * Allocates once, on the first step or when a checkpoint is loaded; a failure leaves a partial
 * structure that rb_stepped_destroy releases.
 */
static enum rb_status prepare(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	struct rb_stepped *made;

	if (world->stepped)
		return RB_OK;
	made = world->stepped = rb_memory_take(1, sizeof *made);
	if (!made)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	enum rb_status status = take_bodies(made, model, err);
	if (status == RB_OK)
		status = rb_gravitation_plant(world->gravitation, err);
	if (status == RB_OK)
		status = take_forces(made, model, err);
	if (status == RB_OK)
		status = take_tops(made, model, err);
	if (status == RB_OK && !world->mark.block)
		status = rb_state_init(&world->mark, model->body_count, model->features, err);
	if (status == RB_OK && (model->features & RB_FEATURE_CONTACT) && !world->broadphase)
		status = rb_broadphase_create(&world->broadphase, model, err);
	if (world->broadphase) {
		rb_broadphase_borrow(world->broadphase, &world->arena[0]);
		rb_broadphase_share(world->broadphase, world->team);
	}
	if (status == RB_OK)
		status = rb_candidates_create(&made->candidates, model, err);
	if (status == RB_OK)
		status = rb_sleep_create(&made->sleep, model, err);
	if (status == RB_OK)
		status = rb_step_points_create(&made->all.points, model, err);
	if (status == RB_OK)
		status = rb_step_points_create(&made->part.points, model, err);
	if (status == RB_OK)
		status = rb_step_points_create(&made->closing, model, err);
	if (status == RB_OK)
		status = rb_solver_create(&made->solver, model, err);
	made->solver.divides = made->all.divides;
	made->solver.undragged = made->undragged;
	if (status == RB_OK && world->broadphase)
		status = rb_impacts_create(made, model, err);
	if (status == RB_OK)
		status = rb_tally_create(made, model, err);
	/* sleep is detected by contacts */
	made->sleep.off = !world->broadphase;
	return status;
}

void rb_stepped_destroy(struct rb_stepped *stepped)
{
	if (!stepped)
		return;
	rb_candidates_release(&stepped->candidates);
	rb_sleep_release(&stepped->sleep);
	rb_step_points_release(&stepped->all.points);
	rb_step_points_release(&stepped->part.points);
	rb_step_points_release(&stepped->closing);
	rb_solver_release(&stepped->solver);
	rb_local_rollback_destroy(stepped->local);
	rb_impacts_release(stepped);
	rb_tally_release(stepped);
	rb_memory_free(stepped->all.rebound);
	rb_memory_free(stepped->part.rebound);
	rb_memory_free(stepped->all.closing_impulse);
	rb_memory_free(stepped->part.closing_impulse);
	rb_memory_free(stepped->all.impact);
	rb_memory_free(stepped->part.impact);
	rb_mean_forces_release(&stepped->means);
	rb_contacts_release(&stepped->part_contacts);
	rb_contacts_release(&stepped->all.transmitted);
	rb_contacts_release(&stepped->part.transmitted);
	rb_memory_free(stepped->all.ledger_impact);
	rb_memory_free(stepped->part.ledger_impact);
	rb_memory_free(stepped->top);
	rb_memory_free(stepped->body);
	rb_memory_free(stepped->driven_end);
	rb_memory_free(stepped->saved_velocity);
	rb_memory_free(stepped->varied);
	rb_memory_free(stepped->undragged);
	rb_memory_free(stepped->bad);
	rb_memory_free(stepped->reported.row);
	rb_memory_free(stepped);
}

/*
 * Contacts per body of a heap, each shared by two bodies: as many as remove its degrees of freedom,
 * at which heaps stop giving way; with friction each contact removes three of a sphere's six.
 * Enlarged boxes overlap those of neighbours, of which equal spheres have 12.
 */
enum { SPHERE_POINTS = 3, ROUGH_SPHERE_POINTS = 2, BODY_POINTS = 6, HEAP_PAIRS = 12 };
/* Steps for which the boxes of falling bodies are enlarged, at most by the body's size. */
enum { FALLING_STEPS = 8 };

/* Speed after a fall from the height of the highest body to that of the lowest, m/s. */
static double falling_speed(const struct rb_model *model)
{
	const rb_vec3 gravity = model->scene->world.gravity;
	double low = (double)INFINITY, high = -(double)INFINITY;

	/* potential energy per mass, m^2/s^2 */
	for (int i = 0; i < model->body_count + model->static_count; i++) {
		const double height = -rb_vec3_dot(gravity, model->position[i]);

		low = fmin(low, height);
		high = fmax(high, height);
	}
	return high > low ? sqrt(2 * (high - low)) : 0;
}

/*
 * Candidate pairs of all bodies once they lie in a heap. The smaller a body's share of its bounding
 * sphere, the more neighbours' boxes overlap its own; while it falls, boxes are up to twice as
 * wide. At most all pairs, a bound that long rods and thin plates would exceed.
 */
static double heap_pairs(const struct rb_model *model)
{
	const double sphere = 4 * acos(-1) / 3;
	const double travel = FALLING_STEPS * model->time_step_s * falling_speed(model);
	const double bodies = model->body_count, statics = model->static_count;
	const double all = bodies * (0.5 * (bodies - 1) + statics);
	double sum = 0;

	for (int i = 0; i < model->body_count; i++) {
		if (!(model->inverse_mass[i] > 0))
			continue;
		const double reach = rb_model_reach(model, i);
		const double volume = rb_shape_volume(model->scene->solids, &model->shape[i]);
		const double widening = 0.5 * (1 + fmin(1, travel / reach));
		const double share = sphere * reach * reach * reach / volume * widening * widening *
		                     widening;

		sum += HEAP_PAIRS * fmax(1, share);
	}
	return fmin(sum, all);
}

size_t rb_stepped_heap_bytes(const struct rb_model *model, int threads)
{
	const bool central = !model->parts;
	const bool tensors = (model->features & RB_FEATURE_GYROSCOPIC) != 0;
	const size_t contact = sizeof(struct rb_contact) + sizeof(struct rb_named_impulse);
	/*
	 * rotating bodies: points also in the list of the position projection or of
	 * relinearization (what groups that take substeps use is given back)
	 */
	const size_t again = central ? 0 : sizeof(struct rb_step_point);
	/*
	 * rotating bodies: factors too, in blocks of 6 by 6; about as many as points, for bodies,
	 * touching pairs and fill-in
	 */
	const size_t factors = central ? 0 : 4 * sizeof(rb_mat3);
	const size_t scratch = rb_wide_row_bytes(central, tensors) + sizeof(struct rb_saved_row) +
	                       factors;
	/* pairs that come close have cached axes, no more than points */
	const size_t axis_cache = central ? 0 : sizeof(struct rb_axis_cache);
	const size_t point = sizeof(struct rb_step_point) + sizeof(struct rb_constraint) +
	                     2 * sizeof(int) + contact + again + scratch + axis_cache;
	const size_t pair = sizeof(struct rb_pair) + sizeof(float) + sizeof(uint32_t) +
	                    (central ? 0 : sizeof(double) + sizeof(uint32_t));
	const double pairs = central ? HEAP_PAIRS * (double)model->body_count : heap_pairs(model);
	const bool rough = (model->features & RB_FEATURE_FRICTION) != 0;
	const int points = !central ? BODY_POINTS : rough ? ROUGH_SPHERE_POINTS : SPHERE_POINTS;
	/* of further threads: points that they find, and rows of groups that each solves alone */
	const size_t rows = (size_t)points * (size_t)model->body_count;
	const size_t group = rows < RB_STRATEGY_LARGE_ROWS ? rows : RB_STRATEGY_LARGE_ROWS;
	const size_t others = (size_t)(threads - 1) * group *
	                      (sizeof(struct rb_step_point) + scratch);

	RB_ASSERT(threads > 0);
	return rows * point + others + (size_t)(pairs * (double)pair);
}

/* ---- the step ---- */

/*
 * Space for the contacts and warm-start impulses of an accepted attempt; those of the step before
 * stay. `*space` of the arena is for rb_step_points_keep_in.
 */
static enum rb_status reserve_contacts(struct rb_world *world, struct rb_named_impulse **space,
                                       struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = rb_record_space(world, &s->all, err);

	if (status != RB_OK)
		return status;
	*space = rb_step_points_space(&s->all.points, world, s->sleep.count > 0);
	if (!*space)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts",
		               s->all.points.chosen_count);
	if (!world->keeps_means || s->all.transmitted.count == 0)
		return RB_OK;
	return rb_contacts_reserve(
		&world->shown,
		world->contacts.count + s->all.points.chosen_count + s->all.transmitted.count, err);
}

/* Contacts and warm-start impulses become those of the world, in that space. */
static enum rb_status keep_contacts(struct rb_world *world, double h,
                                    struct rb_named_impulse *space, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const unsigned char *const sleeps = s->sleep.count > 0 ? s->sleep.sleeps : NULL;
	enum rb_status status = RB_OK;

	RB_ASSERT(h > 0 && space);
	rb_record_in_place(world, &s->all, h); /* reads the impulses of the last step */
	rb_step_points_keep_in(&s->all.points, world, h, s->solver.asleep, sleeps, space);
	if (world->model->driven)
		rb_contacts_sort(&world->contacts);
	if (world->keeps_means && s->all.transmitted.count > 0) {
		world->shown.count = 0;
		status = rb_contacts_join(&world->shown, &world->contacts, err);
		if (status == RB_OK)
			status = rb_record_transmitted(&s->all, h, NULL, &world->shown, err);
		rb_contacts_sort(&world->shown);
		world->has_shown = true;
	}
	rb_step_points_index(&s->all.points, world->model);
	return status;
}

/* The state is that of the beginning of the attempt; nothing of the attempt may be relied on. */
static void take_back(struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;

	rb_state_copy(&world->state, &world->mark);
	rb_sleep_forget(s);
	rb_solver_forget_rest(&s->solver, s->body, s->member_count);
	s->candidates.valid = false;
}

/*
 * Makes an accepted attempt the state of the world. Everything that can fail precedes the first
 * change that cannot be undone.
 */
static enum rb_status commit(struct rb_world *world, double end, double h,
                             const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_counts *counts = &world->frame_counts;
	const struct rb_counts before = *counts;
	/* if everything sleeps and no awake body has a contact, the lists stay as they are */
	const bool listed = !(s->sleep.unchanged && s->all.points.count == 0);
	struct rb_named_impulse *space = NULL;

	RB_ASSERT(h > 0);
	counts->substeps++;
	counts->body_steps += (uint64_t)s->member_count;
	counts->smallest_step_s = fmin(counts->smallest_step_s, h);
	counts->max_penetration_m = fmax(counts->max_penetration_m, outcome->overlap);
	counts->residual_m = fmax(counts->residual_m, outcome->residual);
	counts->slip_m = fmax(counts->slip_m, outcome->slip);
	s->reported.count = 0;
	enum rb_status status = rb_record_impacts(world, &s->all, end, &world->contacts, NULL, err);
	if (status == RB_OK)
		status = rb_joint_records_add(world, &s->all, end, h, NULL, err);
	if (status == RB_OK && !rb_record_reserve(world, s->reported.count))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (status == RB_OK && listed)
		status = reserve_contacts(world, &space, err);
	if (status != RB_OK) {
		*counts = before;
		take_back(world);
		return status;
	}
	if (listed)
		status = keep_contacts(world, h, space, err);
	RB_ASSERT(status == RB_OK); /* in space that is reserved */
	if (s->tally) {
		const struct rb_entries e = rb_step_ledger_enter(world, &s->all, &world->mark,
		                                                 end - h, h, NULL);
		rb_ledger_enter(&world->ledger, &e);
	}
	rb_joints_keep(world, &s->all, h, NULL);
	rb_sleep_end(world, end, NULL);
	world->state.time_s = end;
	return rb_record_all(world, err);
}

static void reset_arenas(struct rb_world *world)
{
	for (int k = 0; k < world->worker_count; k++) {
		rb_arena_reset(&world->arena[k]);
		rb_arena_reset(&world->kept[k]);
	}
}

/* One attempt for all bodies and its verdict; after an error the state is that of the beginning. */
static enum rb_status attempt_all(struct rb_world *world, double start, double h,
                                  struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;

	if (rb_world_is_stopped(world))
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	reset_arenas(world);
	rb_sleep_gather(s);
	rb_state_copy(&world->mark, &world->state);
	s->solver.whole_s = s->all.gravitation_s = h;
	enum rb_status status = rb_attempt(world, &s->all, start, h, err);
	if (status == RB_OK)
		status = rb_judge(world, &s->all, h, outcome, err);
	if (status == RB_OK && rb_stepped_lacks_memory(world))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for a step");
	if (status != RB_OK)
		take_back(world);
	return status;
}

/* RB_ROLLBACK_SELECTIVE: bodies for which the whole step has failed take substeps. */
static enum rb_status step_locally(struct rb_world *world, double start, double dt,
                                   struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_attempt_outcome outcome;
	enum rb_status status = attempt_all(world, start, dt, &outcome, err);

	if (status != RB_OK)
		return status;
	if (s->bad_count == 0) {
		rb_local_rollback_unused(s);
		return commit(world, start + dt, dt, &outcome, err);
	}
	status = rb_local_rollback_step(world, start, dt, &outcome, err);
	if (status != RB_OK)
		return status;
	world->state.time_s = start + dt;
	return rb_record_all(world, err);
}

/* Contact forces averaged over the substeps of a step, for output. */
static enum rb_status show_means(struct rb_world *world, double dt, struct rb_error *err)
{
	world->shown.count = 0;
	const enum rb_status status = rb_mean_forces_record(&world->stepped->means, dt,
	                                                    &world->shown, err);

	rb_contacts_sort(&world->shown);
	world->has_shown = status == RB_OK;
	return status;
}

/*
 * Gravitation at the beginning of a step, constant during the step, also for bodies that take
 * substeps.
 */
static enum rb_status attract(struct rb_world *world, struct rb_error *err)
{
	if (!(world->model->features & RB_FEATURE_GRAVITATION))
		return RB_OK;
	rb_world_place_attracted(world, &world->state);
	return rb_gravitation_sum(world->gravitation, world->team, err);
}

/*
 * Substeps common to all bodies: halves the substep until the attempt is accepted, doubles it after
 * each success. With RB_ROLLBACK_NONE only what is no solution at all counts as failure.
 */
static enum rb_status step_together(struct rb_world *world, double start, double dt,
                                    struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const bool none = world->model->rollback == RB_ROLLBACK_NONE;
	double done = 0, h = dt;
	int halvings = 0, parts = 0;

	s->means.count = 0;
	while (done < dt) {
		struct rb_attempt_outcome outcome;
		enum rb_status status = attempt_all(world, start + done, h, &outcome, err);

		if (status != RB_OK)
			return status;
		if (s->bad_count == 0 || (none && !outcome.broken)) {
			done = h < dt - done ? done + h : dt;
			status = commit(world, start + done, h, &outcome, err);
			if (status == RB_OK && h < dt && world->keeps_means)
				status = rb_record_part(&s->all, &world->contacts, h,
				                        &s->part_contacts, &s->means, err);
			parts++;
			h = rb_next_part(2 * h, dt - done, dt);
			halvings = 0;
			if (status == RB_OK && done < dt)
				status = attract(world, err);
			if (status == RB_OK)
				continue;
			return status;
		}
		take_back(world);
		world->frame_counts.rollbacks++;
		world->frame_counts.discarded_body_steps += (uint64_t)s->member_count;
		if (rb_halvings_end(halvings++, h, dt))
			return rb_judge_give_up(world, start + done, &outcome, err);
		h *= 0.5;
	}
	return parts > 1 && world->keeps_means ? show_means(world, dt, err) : RB_OK;
}

static enum rb_status step(struct rb_world *world, double start, double dt, struct rb_error *err)
{
	const enum rb_status status = attract(world, err);

	if (status != RB_OK)
		return status;
	if (world->moved_by_hand || world->joints_changed) {
		world->stepped->candidates.valid = false;
		rb_sleep_forget(world->stepped);
		memset(world->stepped->solver.rests, 0, (size_t)world->model->body_count);
	}
	world->moved_by_hand = world->has_shown = world->joints_changed = false;
	rb_joints_begin(world);
	return world->model->rollback == RB_ROLLBACK_SELECTIVE
	               ? step_locally(world, start, dt, err)
	               : step_together(world, start, dt, err);
}

/* ---- checkpoint ---- */

/*
 * Warm-start impulses, sorted by first body because the index by body relies on it. A checkpoint
 * may be damaged, so the order is checked.
 */
static void pack_pushes(struct rb_world *world, struct rb_pack *pack)
{
	const struct rb_limits limits = rb_limits_of(world->model);
	struct rb_step_points *points = &world->stepped->all.points;
	size_t count = points->last_count;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(rb_named_impulse_fields()));
	if (pack->loading &&
	    !rb_memory_reserve(&points->last, &points->last_capacity, count, sizeof *points->last))
		rb_pack_fail_memory(pack);
	points->last_count = pack->failed ? 0 : count;
	rb_fields_pack(rb_named_impulse_fields(), points->last, points->last_count, limits.high,
	               pack);
	for (size_t k = 1; pack->loading && k < points->last_count; k++)
		(void)rb_pack_check(pack, points->last[k - 1].a <= points->last[k].a,
		                    "impulses that are not in order");
	if (pack->loading)
		rb_step_points_index(points, world->model);
}

/*
 * Bodies at rest, as columns by body, and their external accelerations; groups are put to sleep
 * again by the next step.
 */
static void pack_rests(struct rb_world *world, struct rb_pack *pack)
{
	struct rb_solver *solver = &world->stepped->solver;

	rb_pack_finite(pack, solver->residual, (size_t)world->model->body_count);
	for (int i = 0; i < world->model->body_count && !pack->failed; i++) {
		bool rests = solver->rests[i];

		rb_pack_bool(pack, &rests);
		solver->rests[i] = rests;
		if (rests)
			rb_pack_finite(pack, solver->rest_external + 6 * (size_t)i, 6);
	}
}

static enum rb_status take_over(struct rb_world *world, struct rb_error *err)
{
	rb_sleep_forget(world->stepped);
	rb_joints_start(world);
	return rb_step_points_take_over(&world->stepped->all.points, world, err);
}

static void pack_steps(struct rb_world *world, struct rb_pack *pack)
{
	bool prepared = world->stepped != NULL;

	rb_pack_bool(pack, &prepared);
	(void)rb_pack_check(pack, prepared || !world->stepped, "a world that was never stepped");
	if (!prepared || pack->failed)
		return;
	if (pack->loading && prepare(world, NULL) != RB_OK) {
		rb_pack_fail_memory(pack);
		return;
	}
	if (pack->loading)
		rb_sleep_forget(world->stepped);
	pack_pushes(world, pack);
	pack_rests(world, pack);
	for (int k = 0; world->model->joints && k < world->model->joints->count; k++) {
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		rb_fields_pack(rb_joint_memory_fields(), &of->kept, 1,
		               rb_limits_of(world->model).high, pack);
		of->last = of->kept;
	}
}

static void release(struct rb_world *world)
{
	rb_stepped_destroy(world->stepped);
	world->stepped = NULL;
}

/*
 * Default: in free fall a step h = 1/240 s has an error of g h^2 / 2 = 8.5e-5 m, 1e-3 of the sizes
 * for which such a step is chosen; a tenth of that takes twice as many sweeps.
 */
const struct rb_stepper rb_stepper_stepped = {
	.tolerance = 1e-4,
	.prepare = prepare,
	.take_over = take_over,
	.step = step,
	.pack = pack_steps,
	.validate = rb_validate_stepped,
	.release = release,
};
