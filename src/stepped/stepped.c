/* SPDX-License-Identifier: MIT */
#include "stepped/stepped.h"

#include <string.h>

#include "base/memory.h"
#include "math/top.h"
#include "step/flow.h"
#include "step/forces.h"
#include "step/plan.h"
#include "step/verdict.h"
#include "stepped/solve.h"

enum { BODIES_PER_BLOCK = 512, HALVINGS_MOST = 24, CLOSINGS_MOST = 12 };

/* Overlap after a step that moving positions may close, over the smallest size; more is taken back. */
static const double closable_share = 0.01;

struct rb_stepped {
	struct rb_near near;
	struct rb_points points;
	struct rb_points closing; /* of the last projection; its `last` stays empty */
	struct rb_solver solver;
	struct rb_top_body *top; /* owned; NULL: no body needs one */
	int *all;                /* owned: 0 .. bodies - 1 */
	double *aside;           /* owned: [6 bodies] velocities while positions are moved */
	rb_vec3 *rebound;        /* owned, by point */
	size_t rebound_capacity;
};

enum rb_status rb_stepped_prepare(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const size_t n = (size_t)model->body_count;
	struct rb_stepped *made;
	enum rb_status status = RB_OK;

	if (world->stepped)
		return RB_OK;
	made = world->stepped = rb_memory_take(1, sizeof *made);
	if (!made)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	made->all = rb_memory_take(n, sizeof *made->all);
	made->aside = rb_memory_take(6 * n, sizeof *made->aside);
	if (!made->all || !made->aside)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
	for (size_t i = 0; i < n; i++)
		made->all[i] = (int)i;
	if (model->features & RB_FEATURE_GYROSCOPIC) {
		made->top = rb_memory_take(n, sizeof *made->top);
		if (!made->top)
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the stepped method");
		for (size_t i = 0; i < n; i++)
			if (model->inverse_mass[i] > 0)
				made->top[i] = rb_top_body_of(&model->inertia[i]);
	}
	if (!world->mark.block)
		status = rb_state_init(&world->mark, model->body_count, model->features, err);
	if (status == RB_OK && (model->features & RB_FEATURE_CONTACT) && !world->broadphase)
		status = rb_broadphase_create(&world->broadphase, model, err);
	if (status == RB_OK)
		status = rb_near_create(&made->near, model, err);
	if (status == RB_OK)
		status = rb_points_create(&made->points, model, err);
	if (status == RB_OK)
		status = rb_points_create(&made->closing, model, err);
	if (status == RB_OK)
		status = rb_solver_create(&made->solver, model, err);
	return status;
}

void rb_stepped_destroy(struct rb_stepped *stepped)
{
	if (!stepped)
		return;
	rb_near_release(&stepped->near);
	rb_points_release(&stepped->points);
	rb_points_release(&stepped->closing);
	rb_solver_release(&stepped->solver);
	rb_memory_free(stepped->top);
	rb_memory_free(stepped->all);
	rb_memory_free(stepped->aside);
	rb_memory_free(stepped->rebound);
	rb_memory_free(stepped);
}

/* ---- forces and flow ---- */

struct flow {
	struct rb_world *world;
	double start_s, h_s;
	const struct rb_stage *const *stage;
	int stage_count;
};

static void run_stages(void *user, int block, int worker)
{
	const struct flow *flow = user;
	const int first = block * BODIES_PER_BLOCK;
	const int rest = flow->world->model->body_count - first;
	struct rb_pass pass = {.world = flow->world,
	                       .arena = &flow->world->arena[worker],
	                       .member = flow->world->stepped->all + first,
	                       .member_count = rest < BODIES_PER_BLOCK ? rest : BODIES_PER_BLOCK,
	                       .start_s = flow->start_s,
	                       .dt_s = flow->h_s,
	                       .h_s = flow->h_s};

	for (int k = 0; k < flow->stage_count; k++)
		if (rb_plan_has(flow->stage[k], flow->world->model->features))
			flow->stage[k]->run(&pass);
}

static int block_count(const struct rb_world *world)
{
	return (world->model->body_count + BODIES_PER_BLOCK - 1) / BODIES_PER_BLOCK;
}

static void add_forces(struct rb_world *world, double start, double h)
{
	static const struct rb_stage *const stages[] = {&rb_stage_gravity, &rb_stage_gravity_force,
	                                                &rb_stage_applied, &rb_stage_pushes};
	struct flow flow = {world, start, h, stages, sizeof stages / sizeof stages[0]};

	rb_team_run(world->team, block_count(world), run_stages, &flow);
}

/* A body that nothing touches or turns: closed form or a series to rounding. */
static bool turn_freely(struct rb_world *world, int i, double h)
{
	const struct rb_stepped *s = world->stepped;
	struct rb_state *state = &world->state;
	const rb_vec3 before = rb_world_row3(world->mark.spin, i);
	const rb_vec3 none = {0, 0, 0};
	rb_quat orientation;
	rb_vec3 spin;

	if (!s->top || s->solver.pushed[i] || s->top[i].kind == RB_TOP_CONSTANT ||
	    rb_vec3_max_abs(rb_vec3_sub(before, rb_world_row3(state->spin, i))) > 0)
		return false;
	struct rb_top top = rb_top_start(
		&s->top[i], rb_quat_from(state->orientation + 4 * (size_t)i), before, none);
	rb_top_at(&top, h, &orientation, &spin);
	rb_quat_to(state->orientation + 4 * (size_t)i, orientation);
	rb_vec3_to(state->spin + 3 * (size_t)i, spin);
	return true;
}

/* Bodies with points move at the velocities that were solved for; all others fly a parabola. */
static void move_block(void *user, int block, int worker)
{
	const struct flow *flow = user;
	struct rb_world *world = flow->world;
	const struct rb_solver *solver = &world->stepped->solver;
	const int first = block * BODIES_PER_BLOCK, n = world->model->body_count;
	const int end = first + BODIES_PER_BLOCK < n ? first + BODIES_PER_BLOCK : n;
	struct rb_pass pass = {.world = world,
	                       .arena = &world->arena[worker],
	                       .member_count = 1,
	                       .h_s = flow->h_s};

	for (int i = first; i < end; i++) {
		rb_vec3 v = rb_world_row3(world->state.velocity, i);

		if (solver->island_of[i] < 0)
			v = rb_vec3_scale(0.5,
			                  rb_vec3_add(v, rb_world_row3(world->mark.velocity, i)));
		rb_vec3_to(
			world->state.position + 3 * (size_t)i,
			rb_vec3_add_scaled(rb_world_row3(world->state.position, i), flow->h_s, v));
		if (!world->state.spin ||
		    rb_vec3_max_abs(rb_world_row3(world->state.spin, i)) == 0 ||
		    turn_freely(world, i, flow->h_s))
			continue;
		pass.member = world->stepped->all + i;
		flow->stage[0]->run(&pass);
	}
}

static void move(struct rb_world *world, double h)
{
	const bool unequal = world->model->features & RB_FEATURE_GYROSCOPIC;
	const struct rb_stage *const stage = unequal ? &rb_stage_rotate_gyroscopic
	                                             : &rb_stage_rotate;
	struct flow flow = {world, 0, h, &stage, 1};

	rb_team_run(world->team, block_count(world), move_block, &flow);
}

/* ---- overlap that linearization has left ---- */

/* Moves positions by what the solver's velocities have become. */
static void shift(struct rb_world *world)
{
	const struct rb_solver *solver = &world->stepped->solver;

	for (int i = 0; i < world->model->body_count; i++) {
		if (solver->island_of[i] < 0)
			continue;
		const struct rb_dense_body *body = &solver->dense.body[i];
		double *const at = world->state.position + 3 * (size_t)i;

		rb_vec3_to(at, rb_vec3_add(rb_vec3_from(at), body->linear));
		if (!world->state.spin)
			continue;
		double *const q = world->state.orientation + 4 * (size_t)i;
		rb_quat_to(q, rb_quat_unit(rb_quat_multiply(rb_quat_from_turn(body->angular),
		                                            rb_quat_from(q))));
	}
}

static enum rb_status close_once(struct rb_world *world, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = rb_points_find(&s->closing, world, &s->near, 1, err);

	for (size_t k = 0; k < s->closing.count; k++)
		s->closing.row[k].friction = 0;
	if (status == RB_OK)
		status = rb_solver_step(&s->solver, world, NULL, &s->closing, 1, err);
	if (status == RB_OK)
		shift(world);
	return status;
}

/* Velocities are put aside: the solver's are ways. */
static enum rb_status close_overlap(struct rb_world *world, double *overlap, int pair[2],
                                    struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const size_t row = 3 * (size_t)world->model->body_count * sizeof(double);
	double *const spin_aside = s->aside + 3 * (size_t)world->model->body_count;
	enum rb_status status = RB_OK;

	memcpy(s->aside, world->state.velocity, row);
	if (world->state.spin)
		memcpy(spin_aside, world->state.spin, row);
	for (int round = 0; round < CLOSINGS_MOST && status == RB_OK; round++) {
		memset(world->state.velocity, 0, row);
		if (world->state.spin)
			memset(world->state.spin, 0, row);
		status = close_once(world, err);
		world->frame_counts.closings++;
		*overlap = rb_points_overlap(world, &s->near, pair);
		if (*overlap <= world->model->tolerance_m)
			break;
	}
	memcpy(world->state.velocity, s->aside, row);
	if (world->state.spin)
		memcpy(world->state.spin, spin_aside, row);
	return status;
}

/* ---- one try ---- */

/* What has become of a try. */
struct outcome {
	bool good;
	int pair[2];     /* that overlaps, -1: none */
	int body;        /* that is not finite, -1: none */
	double overlap;  /* m */
	double residual; /* m: what the solution has left of a gap's closing */
};

static bool all_finite(const struct rb_world *world, int *body)
{
	for (int i = 0; i < world->model->body_count; i++)
		if (!rb_verdict_finite(&world->state, i)) {
			*body = i;
			return false;
		}
	return true;
}

/* A body that impacts have thrown farther than its box foresaw, by more than half its size, may have passed others. */
static bool went_too_far(const struct rb_world *world)
{
	const struct rb_near *near = &world->stepped->near;

	for (int i = 0; i < world->model->body_count; i++) {
		const rb_vec3 d = rb_vec3_sub(rb_world_origin_at(world, &world->state, i),
		                              rb_world_origin_at(world, &world->mark, i));

		if (!(rb_vec3_length(d) <=
		      near->reach[i] + near->margin[i] + 0.5 * rb_model_reach(world->model, i)))
			return true;
	}
	return false;
}

static enum rb_status judge(struct rb_world *world, double h, struct outcome *outcome,
                            struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_model *model = world->model;
	enum rb_status status = RB_OK;

	/* written so that NaN is not good */
	outcome->good = all_finite(world, &outcome->body) &&
	                outcome->residual <= model->tolerance_m;
	if (!outcome->good || !world->broadphase)
		return RB_OK;
	if (!rb_near_holds(&s->near, world)) {
		outcome->good = !went_too_far(world);
		s->near.valid = false;
		if (outcome->good)
			status = rb_near_find(&s->near, world, &world->state, h, err);
		if (!outcome->good || status != RB_OK)
			return status;
	}
	outcome->overlap = rb_points_overlap(world, &s->near, outcome->pair);
	if (outcome->overlap > model->tolerance_m &&
	    outcome->overlap <= closable_share * model->size_min_m)
		status = close_overlap(world, &outcome->overlap, outcome->pair, err);
	outcome->good = outcome->overlap <= model->tolerance_m;
	return status;
}

/* Before the projection takes the solver for its own. */
static double count_work(struct rb_world *world, double h)
{
	const struct rb_solver *solver = &world->stepped->solver;
	struct rb_counts *counts = &world->frame_counts;
	double residual = 0;

	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];

		counts->row_sweeps += (uint64_t)island->sweeps * (uint64_t)island->row_count;
		counts->rows += (uint64_t)island->row_count;
		counts->factors += (uint64_t)island->factors;
		residual = fmax(residual, h * island->residual);
	}
	counts->residual_m = fmax(counts->residual_m, residual);
	return residual;
}

static enum rb_status attempt(struct rb_world *world, double start, double h,
                              struct outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	enum rb_status status = RB_OK;

	*outcome = (struct outcome){.pair = {-1, -1}, .body = -1};
	add_forces(world, start, h);
	s->points.count = 0;
	if (world->broadphase) {
		status = rb_near_find(&s->near, world, &world->mark, h, err);
		if (status == RB_OK)
			status = rb_points_find(&s->points, world, &s->near, h, err);
	}
	if (status == RB_OK)
		status = rb_solver_step(&s->solver, world, &world->mark, &s->points, h, err);
	if (status == RB_OK && !rb_memory_reserve(&s->rebound, &s->rebound_capacity,
	                                          s->points.count + 1, sizeof *s->rebound))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (status != RB_OK)
		return status;
	move(world, h);
	memset(s->rebound, 0, s->points.count * sizeof *s->rebound);
	s->solver.hands_over = world->located && world->dense_left == 1;
	status = rb_solver_rebound(&s->solver, world, &s->points, s->rebound, err);
	outcome->residual = count_work(world, h);
	return status == RB_OK ? judge(world, h, outcome, err) : status;
}

/* ---- commit ---- */

/* The points of one pair as one contact: forces add, at their middle. */
static struct rb_contact contact_of(const struct rb_world *world, const struct rb_point *point,
                                    size_t count, double h)
{
	struct rb_contact contact = {
		.a = point->a, .b = point->b, .normal = point->normal, .gap = point->gap};
	rb_vec3 sum = {0, 0, 0};
	double weight = 0;

	for (size_t k = 0; k < count; k++) {
		const rb_vec3 arm = point[k].central
		                            ? rb_vec3_scale(point[k].arm_a.x, point[k].normal)
		                            : point[k].arm_a;

		weight += point[k].push;
		sum = rb_vec3_add_scaled(sum, point[k].push, arm);
		contact.tangent_force = rb_vec3_add_scaled(contact.tangent_force, 1 / h,
		                                           point[k].rub);
		contact.gap = fmin(contact.gap, point[k].gap);
	}
	contact.normal_force = weight / h;
	contact.point = rb_vec3_add_scaled(rb_world_row3(world->state.position, point->a),
	                                   1 / weight, sum);
	return contact;
}

static size_t pair_length(const struct rb_points *points, size_t first)
{
	size_t end = first + 1;

	while (end < points->count && points->row[end].a == points->row[first].a &&
	       points->row[end].b == points->row[first].b)
		end++;
	return end - first;
}

static enum rb_status keep_contacts(struct rb_world *world, double h, struct rb_error *err)
{
	const struct rb_points *points = &world->stepped->points;
	struct rb_contacts *contacts = &world->contacts;
	size_t length;

	contacts->count = 0;
	for (size_t k = 0; k < points->count; k += length) {
		bool pushed = false;

		length = pair_length(points, k);
		for (size_t i = 0; i < length; i++)
			pushed = pushed || points->row[k + i].push > 0;
		if (!pushed)
			continue;
		if (contacts->count == contacts->capacity) {
			const enum rb_status status = rb_contacts_reserve(
				contacts, 2 * contacts->count + 64, err);

			if (status != RB_OK)
				return status;
		}
		contacts->row[contacts->count++] = contact_of(world, &points->row[k], length, h);
	}
	return RB_OK;
}

/*
 * An impact is told where a pair that did not touch in the step before has come together, by more than the residual. The
 * whole impulse of the step counts.
 */
static bool is_impact(const struct rb_world *world, size_t first, size_t length,
                      struct rb_event *event)
{
	const struct rb_stepped *s = world->stepped;
	const struct rb_point *point = &s->points.row[first];
	double push = 0, approach = 0;

	if (rb_contacts_find(&world->contacts, point->a, point->b))
		return false;
	*event = (struct rb_event){
		.kind = RB_EVENT_COLLISION, .a = point->a, .b = point->b, .normal = point->normal};
	for (size_t k = 0; k < length; k++) {
		if (!(point[k].push > 0))
			continue;
		event->impulse = rb_vec3_add(
			event->impulse, rb_vec3_add(rb_vec3_add_scaled(point[k].rub, point[k].push,
		                                                       point[k].normal),
		                                    s->rebound[first + k]));
		push += point[k].push;
		approach = fmax(approach, point[k].approach);
		event->point = rb_vec3_add_scaled(
			event->point, point[k].push,
			point[k].central ? rb_vec3_scale(point[k].arm_a.x, point[k].normal)
					 : point[k].arm_a);
	}
	event->approach_speed = approach;
	if (!(push > 0 && approach > s->solver.enough))
		return false;
	event->point = rb_vec3_add_scaled(rb_world_row3(world->state.position, point->a), 1 / push,
	                                  event->point);
	return true;
}

static enum rb_status tell_impacts(struct rb_world *world, double time, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const struct rb_points *points = &world->stepped->points;
	struct rb_events *events = &world->events;
	size_t length;

	for (size_t k = 0; k < points->count; k += length) {
		struct rb_event event;

		length = pair_length(points, k);
		if (!is_impact(world, k, length, &event))
			continue;
		world->frame_counts.collisions++;
		if (!world->hooks.collision && !world->options.keep_events)
			continue;
		if (!rb_memory_reserve(&events->row, &events->capacity, events->count + 1,
		                       sizeof *events->row))
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
		event.time_s = time;
		const int a = model->id_of[event.a], b = model->id_of[event.b];
		if (a > b) {
			event.normal = rb_vec3_neg(event.normal);
			event.impulse = rb_vec3_neg(event.impulse);
		}
		event.a = a < b ? a : b;
		event.b = a < b ? b : a;
		events->row[events->count++] = event;
	}
	return RB_OK;
}

static enum rb_status call_hooks(struct rb_world *world, size_t first, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (size_t k = first; k < world->events.count && world->hooks.collision && status == RB_OK;
	     k++)
		status = world->hooks.collision(world->hooks.user, world, &world->events.row[k],
		                                err);
	if (!world->options.keep_events)
		world->events.count = 0;
	return status;
}

static enum rb_status commit(struct rb_world *world, double end, double h,
                             const struct outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_counts *counts = &world->frame_counts;
	const size_t first = world->events.count;

	counts->substeps++;
	counts->body_steps += (uint64_t)world->model->body_count;
	counts->smallest_step_s = fmin(counts->smallest_step_s, h);
	counts->max_penetration_m = fmax(counts->max_penetration_m, outcome->overlap);
	world->state.time_s = end;
	enum rb_status status = tell_impacts(world, end, err);
	if (status == RB_OK)
		status = keep_contacts(world, h, err);
	if (status == RB_OK)
		status = rb_points_keep(&s->points, world->model, h, err);
	return status == RB_OK ? call_hooks(world, first, err) : status;
}

/* ---- the step ---- */

static enum rb_status give_up(const struct rb_world *world, double start,
                              const struct outcome *outcome, struct rb_error *err)
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
	for (int k = 0; k < world->worker_count; k++) {
		rb_arena_reset(&world->arena[k]);
		rb_arena_reset(&world->kept[k]);
	}
}

enum rb_status rb_stepped_step(struct rb_world *world, double start, double dt,
                               struct rb_error *err)
{
	double done = 0, h = dt;
	int halvings = 0;

	if (world->moved_by_hand) {
		world->stepped->near.valid = false;
		memset(world->stepped->solver.rests, 0, (size_t)world->model->body_count);
	}
	world->moved_by_hand = false;
	while (done < dt) {
		struct outcome outcome;

		reset_arenas(world);
		rb_state_copy(&world->mark, &world->state);
		enum rb_status status = attempt(world, start + done, h, &outcome, err);

		if (status == RB_OK &&
		    (outcome.good ||
		     (world->model->rollback == RB_ROLLBACK_NONE && outcome.body < 0))) {
			done = h < dt - done ? done + h : dt;
			status = commit(world, start + done, h, &outcome, err);
			h = fmin(2 * h, dt - done);
			halvings = 0;
			if (status == RB_OK)
				continue;
			return status;
		}
		rb_state_copy(&world->state, &world->mark);
		world->stepped->near.valid = false;
		if (status != RB_OK)
			return status;
		world->frame_counts.rollbacks++;
		world->frame_counts.discarded_body_steps += (uint64_t)world->model->body_count;
		if (++halvings > HALVINGS_MOST)
			return give_up(world, start + done, &outcome, err);
		h *= 0.5;
	}
	return RB_OK;
}

/* ---- to bytes and back ---- */

enum { PUSH_SIZE = 48 };

static void pack_push(const struct rb_world *world, struct rb_named_push *push,
                      struct rb_pack *pack)
{
	double numbers[4] = {push->force, push->rub.x, push->rub.y, push->rub.z};

	rb_pack_int(pack, &push->a, 0, world->model->body_count - 1);
	rb_pack_int(pack, &push->b, 0, world->model->body_count + world->model->static_count - 1);
	rb_pack_u64(pack, &push->key);
	rb_pack_finite(pack, numbers, 4);
	push->force = numbers[0];
	push->rub = rb_vec3_from(numbers + 1);
}

static void pack_pushes(struct rb_world *world, struct rb_pack *pack)
{
	struct rb_points *points = &world->stepped->points;
	size_t count = points->last_count;

	rb_pack_count(pack, &count, INT32_MAX, PUSH_SIZE);
	if (pack->loading && !pack->failed &&
	    !rb_memory_reserve(&points->last, &points->last_capacity, count,
	                       sizeof *points->last)) {
		pack->failed = pack->no_memory = true;
		return;
	}
	points->last_count = pack->failed ? 0 : count;
	for (size_t k = 0; k < points->last_count && !pack->failed; k++) {
		pack_push(world, &points->last[k], pack);
		(void)rb_pack_check(pack, k == 0 || points->last[k - 1].a <= points->last[k].a,
		                    "impulses that are not in order");
	}
	rb_points_index(points, world->model);
}

static void pack_rests(struct rb_world *world, struct rb_pack *pack)
{
	struct rb_solver *solver = &world->stepped->solver;

	for (int i = 0; i < world->model->body_count && !pack->failed; i++) {
		bool rests = solver->rests[i];

		rb_pack_bool(pack, &rests);
		solver->rests[i] = rests;
		if (rests)
			rb_pack_finite(pack, solver->rest_pull + 6 * (size_t)i, 6);
	}
}

void rb_stepped_pack(struct rb_world *world, struct rb_pack *pack)
{
	bool prepared = world->stepped != NULL;

	rb_pack_bool(pack, &prepared);
	(void)rb_pack_check(pack, prepared || !world->stepped, "a world that was never stepped");
	if (!prepared || pack->failed)
		return;
	if (pack->loading && rb_stepped_prepare(world, NULL) != RB_OK) {
		pack->failed = pack->no_memory = true;
		return;
	}
	pack_pushes(world, pack);
	pack_rests(world, pack);
}
