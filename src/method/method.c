/* SPDX-License-Identifier: MIT */
/*
 * A frame is run by the scene's method. `auto` locates. If events become too dense, it steps from
 * there; if locating fails, the world is rolled back to the beginning of the frame (of the step, if
 * there are callbacks, which cannot be undone) and stepped. The number of steps before the next
 * attempt to locate grows with each failure: exponential back-off bounds the share of time lost to
 * failed attempts.
 */
#include "method/method.h"

#include "base/error.h"
#include "base/memory.h"
#include "located/crowd.h"
#include "located/engine.h"
#include "located/engine_create.h"
#include "located/located_invariants.h"
#include "method/loads.h"
#include "method/numbers.h"
#include "model/center.h"
#include "model/descriptor.h"
#include "classic/stage_list.h"
#include "world/invariants.h"
#include "world/joint_state.h"

#include <float.h>
#include <string.h>

/* Steps between two polls for an interruption within a frame. */
enum { STEPS_PER_POLL = 1024 };

/* ---- creating a world ---- */

/* State at time 0: centres of mass from the shapes' origins. */
static void start_state(struct rb_world *world)
{
	const struct rb_model *model = world->model;
	struct rb_state *state = &world->state;

	for (int i = 0; i < model->body_count; i++) {
		const struct rb_body_def *body = &model->scene->bodies[model->id_of[i]];
		const rb_vec3 center = rb_model_center(model, i, model->position[i],
		                                       model->orientation[i]);

		rb_vec3_to(state->position + 3 * (size_t)i, center);
		rb_vec3_to(state->velocity + 3 * (size_t)i, body->velocity);
		if (state->orientation) {
			rb_quat_to(state->orientation + 4 * (size_t)i, model->orientation[i]);
			rb_vec3_to(state->spin + 3 * (size_t)i, body->angular_velocity);
		}
	}
}

/* Row of the world's method. */
static const struct rb_method *method_of(const struct rb_world *world)
{
	return rb_model_method_row(world->model);
}

static enum rb_status prepare_steps(struct rb_world *world, struct rb_error *err)
{
	return method_of(world)->steps->prepare(world, err);
}

/* Prepares the steps and hands the located motion over to them. */
static enum rb_status change_to_steps(struct rb_world *world, struct rb_error *err)
{
	const struct rb_stepper *const steps = method_of(world)->steps;
	const enum rb_status status = steps->prepare(world, err);

	return status == RB_OK && steps->take_over ? steps->take_over(world, err) : status;
}

/*
 * Clears the forces that callbacks applied, which last for one step, and keeps a copy for reports
 * after it.
 */
static void clear_pushes(struct rb_world *world)
{
	const size_t n = 3 * (size_t)world->model->body_count;

	if (!world->state.push)
		return;
	world->has_held = world->pushed;
	if (!world->pushed)
		return;
	memcpy(world->held, world->state.push, n * sizeof(double));
	memcpy(world->held + n, world->state.twist, n * sizeof(double));
	memset(world->state.push, 0, n * sizeof(double));
	memset(world->state.twist, 0, n * sizeof(double));
	world->pushed = false;
}

/*
 * Allocates that copy, and decides whether mean contact forces are kept: any function of the scene
 * may read them.
 */
static bool prepare_loads(struct rb_world *world)
{
	const struct rb_scene *scene = world->model->scene;

	world->keeps_means = world->options.keep_contacts || scene->hooks != 0 ||
	                     scene->expect_count > 0 || (scene->record.fields & RB_FIELD_LOADS);
	if (!world->state.push)
		return true;
	world->held = rb_memory_take(6 * (size_t)world->model->body_count, sizeof *world->held);
	return world->held != NULL;
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
	world->gravitation = rb_memory_take(1, sizeof *world->gravitation);
	world->late = rb_memory_take(1, sizeof *world->late);
	if (!world->arena || !world->kept || !world->plan || !world->gravitation || !world->late)
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for a world");
	if (status == RB_OK)
		status = rb_gravitation_create(world->gravitation, model, err);
	if (status == RB_OK)
		status = rb_state_init(&world->state, model->body_count, model->features, err);
	if (status == RB_OK)
		status = rb_state_init(&world->start, model->body_count, model->features, err);
	if (status == RB_OK)
		status = rb_joint_states_create(world, err);
	if (status == RB_OK && !prepare_loads(world))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for a world");
	if (status == RB_OK)
		status = rb_team_create(&world->team, world->worker_count, err);
	if (status == RB_OK && !method_of(world)->locates)
		status = prepare_steps(world, err);
	if (status == RB_OK) {
		rb_stage_list_build(world->plan, model->features);
		start_state(world);
		rb_joint_states_see(world);
	}
	if (status == RB_OK && method_of(world)->locates)
		status = rb_engine_create(&world->located, world, err);
	if (status == RB_OK && model->driven)
		status = rb_loads_start_driven(world, err);
	if (status == RB_OK && model->keeps_ledger)
		rb_numbers_start_ledger(world);
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
	rb_loads_destroy(world->loads);
	rb_memory_free(world->held);
	rb_memory_free(world->joint);
	rb_memory_free(world->joint_load);
	rb_engine_destroy(world->located);
	for (int k = 0; world->arena && k < world->worker_count; k++)
		rb_arena_release(&world->arena[k]);
	for (int k = 0; world->kept && k < world->worker_count; k++)
		rb_arena_release(&world->kept[k]);
	rb_memory_free(world->arena);
	rb_memory_free(world->kept);
	rb_memory_free(world->plan);
	rb_memory_free(world->late);
	if (world->gravitation)
		rb_gravitation_release(world->gravitation);
	rb_memory_free(world->gravitation);
	rb_state_release(&world->state);
	rb_state_release(&world->start);
	rb_state_release(&world->mark);
	rb_state_release(&world->frame_state);
	rb_contacts_release(&world->frame_contacts);
	rb_contacts_release(&world->contacts);
	rb_contacts_release(&world->next_contacts);
	rb_contacts_release(&world->shown);
	rb_memory_free(world->events.row);
	for (int k = 0; k < RB_METHOD_KIND_COUNT; k++)
		if (!rb_methods[k]->locates && rb_methods[k]->steps->release)
			rb_methods[k]->steps->release(world);
	rb_broadphase_destroy(world->broadphase);
	rb_memory_free(world);
}

/*
 * Steps taken before locating is tried again: RB_DENSE_STEPS_FIRST, and RB_DENSE_STEPS_MORE times
 * as many after each failure, up to this.
 */
enum { DENSE_STEPS_MAX = 4096 };

static void increase_dense_steps(struct rb_world *world)
{
	if (world->dense_steps < DENSE_STEPS_MAX)
		world->dense_steps = world->dense_steps > 0
		                             ? RB_DENSE_STEPS_MORE * world->dense_steps
		                             : RB_DENSE_STEPS_FIRST;
}

/* Clears the counts of work of the present series of steps. */
static void clear_dense_work(struct rb_world *world)
{
	world->dense_work = world->dense_body_steps = 0;
	world->dense_s = 0;
}

/*
 * Begins a series of steps after locating has stopped. If more than RB_DENSE_STEPS_MORE times the
 * length of the last series was located before, this is another crowd, and the back-off begins
 * anew.
 */
static void begin_dense_steps(struct rb_world *world)
{
	const double before_s = (double)world->dense_steps * world->model->time_step_s;

	if (rb_engine_located_time(world->located) > RB_DENSE_STEPS_MORE * before_s)
		world->dense_steps = 0;
	increase_dense_steps(world);
	world->dense_left = world->dense_steps;
	clear_dense_work(world);
}

/*
 * Largest acceleration by gravity, gravity_force, fields and gravitation of any body that is not
 * driven, m/s^2.
 */
static enum rb_status largest_external(const struct rb_world *world, double t, double *max,
                                       struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const struct rb_world_def *def = &model->scene->world;
	const bool field = (model->features & RB_FEATURE_FIELD) && world->hooks.field;
	enum rb_status status = RB_OK;

	const bool attracts = (model->features & RB_FEATURE_GRAVITATION) != 0;

	*max = rb_vec3_length(def->gravity);
	if (!field && !attracts && !(model->features & RB_FEATURE_GRAVITY_FORCE))
		return RB_OK;
	if (attracts) {
		rb_world_place_attracted(world, &world->state);
		rb_gravitation_find(world->gravitation);
	}
	for (int i = 0; i < model->body_count && status == RB_OK; i++) {
		if (model->driven && model->driven[i])
			continue;
		const rb_vec3 at[2] = {rb_world_row3(world->state.position, i),
		                       rb_world_row3(world->state.velocity, i)};
		rb_vec3 fields[2] = {{0, 0, 0}, {0, 0, 0}};

		if (field)
			status = world->hooks.field(world->hooks.user, model->id_of[i], t, at,
			                            fields, err);
		rb_vec3 force = rb_vec3_add(fields[0], def->gravity_force);
		if (world->hooks.potential)
			force = rb_vec3_add(force, fields[1]);
		if (attracts)
			force = rb_vec3_add_scaled(force, model->mass[i],
			                           rb_gravitation_found(world->gravitation, i));
		*max = fmax(*max, rb_vec3_length(rb_vec3_add_scaled(
					  def->gravity, model->inverse_mass[i], force)));
	}
	return status;
}

enum { STEPS_PER_FALL = 8 };

/*
 * Longest step of `auto`, s: an eighth of the time in which a body of the mean size falls by its
 * size. A time_step chosen for locating may be far too long for steps; the smallest body would
 * shorten the steps of all others.
 */
static enum rb_status longest_step(const struct rb_world *world, double t, double *step,
                                   struct rb_error *err)
{
	double external;

	*step = HUGE_VAL;
	if (!method_of(world)->changes)
		return RB_OK;
	const enum rb_status status = largest_external(world, t, &external, err);

	if (external > 0)
		*step = sqrt(2 * world->model->size_mean_m / external) / STEPS_PER_FALL;
	return status;
}

/* Steps of an interval beyond which a run takes hours: as of a frame (model/validate). */
static const double steps_max = 1e9;

/* Steps from `start`, the time of the state, to `stop`. */
static enum rb_status run_steps(struct rb_world *world, double start, double stop,
                                struct rb_error *err)
{
	double max;

	RB_ASSERT(stop > start);
	world->has_shown = false;
	enum rb_status status = longest_step(world, start, &max, err);
	if (status == RB_OK && stop - start > steps_max * max)
		return RB_FAIL(
			err, RB_ERR_PHYSICS,
			"steps after t = %.9g s are too short to reach %.9g s: in %.3g s what "
			"acts moves bodies by their size",
			start, stop, STEPS_PER_FALL * max);
	const int64_t count = stop - start > max ? rb_step_count(stop - start, max) : 1;

	for (int64_t k = 0; k < count && status == RB_OK; k++) {
		const double from = k > 0 ? world->state.time_s : start;
		const double to = k + 1 < count ? start + (stop - start) *
		                                                  ((double)(k + 1) / (double)count)
		                                : stop;

		const struct rb_counts before = world->frame_counts;

		if (!(to > from)) /* parts of an ulp of the time */
			continue;
		status = method_of(world)->steps->step(world, from, to - from, err);
		if (status != RB_OK)
			break;
		world->state.time_s = to;
		world->frame_counts.stepped_s += to - from;
		if (world->located)
			rb_crowd_count_step(world->located, &before, to - from);
	}
	if (status == RB_OK)
		clear_pushes(world);
	return status;
}

/* ---- changes of method after a failure ---- */

/* Snapshot for a rollback of the world, besides state and contacts. */
struct snapshot {
	struct rb_counts counts;
	struct rb_ledger ledger;
	size_t event_count;
	int64_t dense_steps, dense_left;
	uint64_t dense_work, dense_body_steps;
	double dense_s;
	uint64_t called;
	bool is_known;
};

/* True for `auto` if the scene can also be stepped. */
static bool can_change_method(const struct rb_world *world)
{
	return rb_model_may_change_method(world->model) && world->located &&
	       rb_engine_wants_steps(world->located);
}

/* True if the scene has callbacks: they cannot be undone, so a step is repeated and not a frame. */
static bool has_callbacks(const struct rb_world *world)
{
	const struct rb_world_hooks *hooks = &world->hooks;

	return hooks->step || hooks->collision || hooks->transition;
}

static enum rb_status copy_contacts(struct rb_contacts *to, const struct rb_contacts *from,
                                    struct rb_error *err)
{
	to->count = 0;
	return rb_contacts_join(to, from, err);
}

/* Takes the snapshot if `known`. */
static enum rb_status take_snapshot(struct rb_world *world, bool known, struct snapshot *begin,
                                    struct rb_error *err)
{
	const struct rb_model *model = world->model;
	enum rb_status status = RB_OK;

	*begin = (struct snapshot){.is_known = known, .called = world->called};
	if (!begin->is_known)
		return RB_OK;
	if (!world->frame_state.block)
		status = rb_state_init(&world->frame_state, model->body_count, model->features,
		                       err);
	if (status == RB_OK)
		status = copy_contacts(&world->frame_contacts, &world->contacts, err);
	if (status != RB_OK)
		return status;
	rb_state_copy(&world->frame_state, &world->state);
	begin->counts = world->frame_counts;
	begin->ledger = world->ledger;
	rb_ledger_enter(&begin->ledger, &world->open);
	begin->event_count = world->events.count;
	begin->dense_steps = world->dense_steps;
	begin->dense_left = world->dense_left;
	begin->dense_work = world->dense_work;
	begin->dense_body_steps = world->dense_body_steps;
	begin->dense_s = world->dense_s;
	return RB_OK;
}

/*
 * Rolls the world back to the snapshot and changes the method: an interval that was located is
 * stepped, with a longer series of steps; one that was stepped from its beginning is located.
 */
static enum rb_status roll_back(struct rb_world *world, const struct snapshot *begin, int64_t steps,
                                struct rb_error *err)
{
	RB_ASSERT(begin->is_known && world->frame_state.block);

	const uint64_t bodies = (uint64_t)world->model->body_count;
	const enum rb_status status = copy_contacts(&world->contacts, &world->frame_contacts, err);

	if (status != RB_OK)
		return status;
	rb_state_copy(&world->state, &world->frame_state);
	world->pushed = true; /* callbacks may have applied forces before the snapshot */
	rb_engine_roll_back(world->located);
	const bool by_steps = world->dense_left > 0;
	world->frame_counts = begin->counts;
	world->ledger = begin->ledger;
	world->frame_counts.rollbacks++;
	world->frame_counts.discarded_body_steps += bodies;
	world->events.count = begin->event_count;
	world->moved_by_hand = true;
	world->dense_steps = begin->dense_steps;
	world->dense_work = begin->dense_work;
	world->dense_body_steps = begin->dense_body_steps;
	world->dense_s = begin->dense_s;
	world->dense_left = 0;
	if (begin->dense_left > 0 && by_steps)
		return RB_OK;
	increase_dense_steps(world);
	while (world->dense_steps < steps && world->dense_steps < DENSE_STEPS_MAX)
		world->dense_steps *= RB_DENSE_STEPS_MORE;
	world->dense_left = world->dense_steps > steps ? world->dense_steps : steps;
	clear_dense_work(world);
	return change_to_steps(world, err);
}

/* Locates from `start` to `stop`, or until the engine stops early. */
static enum rb_status attempt_located(struct rb_world *world, double start, double stop,
                                      struct rb_error *err)
{
	const bool pushes = world->model->features & RB_FEATURE_PUSHES;
	enum rb_status status = RB_OK;

	if (pushes)
		status = rb_engine_take_changes(world->located, start, err);
	if (status == RB_OK)
		status = rb_engine_advance(world->located, stop, err);
	if (status != RB_OK || !rb_engine_locates(world->located))
		return status;
	if (pushes) {
		rb_state_copy(&world->start, &world->state);
		clear_pushes(world);
	}
	return RB_OK;
}

/* ---- the grid of time_step in a frame ---- */

struct grid {
	double begin_s, end_s;
	int64_t steps;
};

static double grid_moment(const struct grid *grid, int64_t k)
{
	return k < grid->steps ? grid->begin_s + (grid->end_s - grid->begin_s) *
	                                                 ((double)k / (double)grid->steps)
	                       : grid->end_s;
}

/* Index of the first time of the grid not before `t`, which lies in the frame. */
static int64_t grid_from(const struct grid *grid, double t)
{
	const double share = (t - grid->begin_s) / (grid->end_s - grid->begin_s);
	int64_t k = (int64_t)fmin(share * (double)grid->steps, (double)grid->steps);

	while (k > 0 && grid_moment(grid, k - 1) >= t)
		k--;
	while (k < grid->steps && grid_moment(grid, k) < t)
		k++;
	return k;
}

/* True if a callback's force acts in the next step. */
static bool is_pushed(const struct rb_world *world)
{
	const size_t n = 3 * (size_t)world->model->body_count;
	bool any = false;

	if (!world->pushed || !world->state.push)
		return false;
	for (size_t k = 0; k < n; k++)
		any = any || world->state.push[k] != 0 || world->state.twist[k] != 0;
	return any;
}

/*
 * True if the frame runs step by step. Located motion without callbacks and their forces runs the
 * whole frame at once: nothing would use the state at the steps in between.
 */
static bool needs_grid(const struct rb_world *world)
{
	return !world->located || world->dense_left > 0 || has_callbacks(world) || is_pushed(world);
}

/*
 * Locates a step, with a snapshot if there are callbacks: a step can be repeated as long as only
 * on_step has been called, whose effect is kept.
 */
static enum rb_status located(struct rb_world *world, const struct grid *grid, double start,
                              double stop, struct rb_error *err)
{
	struct snapshot before;
	const bool tries = !rb_engine_locates(world->located);
	enum rb_status status = take_snapshot(
		world, can_change_method(world) && has_callbacks(world), &before, err);

	if (status == RB_OK)
		status = attempt_located(world, start, stop, err);
	if (status == RB_OK && before.is_known && rb_engine_locates(world->located))
		status = rb_engine_check(world->located, err);
	if (status == RB_ERR_PHYSICS && before.is_known && world->called == before.called) {
		status = roll_back(world, &before, 0, err);
		return status == RB_OK ? run_steps(world, start, stop, err) : status;
	}
	if (status != RB_OK || rb_engine_locates(world->located))
		return status;
	/* too dense to locate: the rest of the interval, if any, and further steps are stepped */
	begin_dense_steps(world);
	/* an attempt that failed at once has changed no state of the steps */
	if (!tries || !world->stepped || rb_engine_located_time(world->located) > 0)
		status = change_to_steps(world, err);
	/* also if nothing has been located: the callback of that step has been called */
	const double now = world->state.time_s;
	const double next = grid_moment(grid, grid_from(grid, fmax(now, nextafter(start, stop))));
	if (status == RB_OK && now < next)
		return run_steps(world, now, next, err);
	world->has_shown = false;
	clear_pushes(world);
	return status;
}

/* Runs a step with the present method, after on_step. */
static enum rb_status run_step(struct rb_world *world, const struct grid *grid, double start,
                               double stop, struct rb_error *err)
{
	enum rb_status status;

	if (!world->located || world->dense_left > 0) {
		/* repeated until an attempt is due; the last step before it is solved for it */
		if (world->located && world->dense_left == 1 &&
		    !rb_crowd_may_attempt(world->located))
			world->dense_left += world->dense_steps;
		status = run_steps(world, start, stop, err);
		if (status == RB_OK && world->located)
			world->dense_left--;
		return status;
	}
	return located(world, grid, start, stop, err);
}

/* Runs from the grid's k-th time to a later one, with the step's callback. */
static enum rb_status step(struct rb_world *world, const struct grid *grid, int64_t k, int64_t to,
                           struct rb_error *err)
{
	const double start = grid_moment(grid, k), stop = grid_moment(grid, to);
	enum rb_status status = RB_OK;

	if (world->hooks.step)
		status = world->hooks.step(world->hooks.user, world, start, stop - start, err);
	if (status != RB_OK)
		return status;
	RB_ASSERT(!world->in_step);
	world->begun = world->in_step = true;
	rb_world_choose_pushes(world);
	status = run_step(world, grid, start, stop, err);
	world->in_step = false;
	world->moment++;
	return status;
}

int64_t rb_step_count(double interval, double time_step)
{
	RB_ASSERT(!(time_step < 0));

	const double quotient = interval / time_step;
	const double whole = nearbyint(quotient);
	const double count = fabs(quotient - whole) <= 8 * DBL_EPSILON * quotient ? whole
	                                                                          : ceil(quotient);

	return count >= 1 ? (int64_t)fmin(count, 0x1p62) : 1;
}

int64_t rb_frame_step_count(const struct rb_model *model, double begin, double end)
{
	/*
	 * the difference of two times has their rounding; that of a whole interval is known exactly
	 */
	const double interval = 1 / model->frame_rate;
	const bool whole = fabs(end - begin - interval) <= 4 * DBL_EPSILON * end;

	return rb_step_count(whole ? interval : end - begin, model->time_step_s);
}

/* Runs a frame in equal steps. */
static enum rb_status run_frame(struct rb_world *world, const struct grid *grid,
                                struct rb_error *err)
{
	RB_ASSERT(grid->steps >= 1);

	for (int64_t k = 0; k < grid->steps;) {
		const int64_t next = needs_grid(world) ? k + 1 : grid->steps;
		const enum rb_status status = step(world, grid, k, next, err);

		if (status != RB_OK && status != RB_ERR_INTERRUPT)
			return status;
		k = next == k + 1 ? next : grid_from(grid, world->state.time_s);
		const bool polls = k % STEPS_PER_POLL == 0 && k < grid->steps;
		if (status == RB_ERR_INTERRUPT || (polls && rb_world_is_stopped(world))) {
			world->stopped = true;
			return RB_OK;
		}
	}
	return world->located && world->dense_left == 0 ? rb_engine_inspect(world->located, err)
	                                                : RB_OK;
}

enum rb_status rb_world_validate(const struct rb_world *world, struct rb_error *err)
{
	enum rb_status status = rb_validate_state(world, err);

	if (status == RB_OK)
		status = rb_validate_contacts(world, &world->contacts, err);
	if (status == RB_OK && world->has_shown)
		status = rb_validate_contacts(world, &world->shown, err);
	if (status == RB_OK)
		status = rb_validate_records(world, err);
	if (status == RB_OK && world->located && world->dense_left == 0)
		status = rb_validate_located(world->located, err);
	const struct rb_stepper *const steps = method_of(world)->steps;
	if (status == RB_OK && steps->validate)
		status = steps->validate(world, err);
	return status;
}

enum rb_status rb_world_step_frame(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const double begin = rb_model_frame_time(model, world->state.frame);
	const double end = rb_model_frame_time(model, world->state.frame + 1);
	const bool by_steps = !world->located || rb_engine_wants_steps(world->located);
	const struct grid grid = {begin, end,
	                          by_steps ? rb_frame_step_count(model, begin, end) : 1};
	struct snapshot before;
	world->stopped = false;
	rb_interrupt_begin(&world->interrupt, world->options.stop, world->options.stop_user);
	enum rb_status status = take_snapshot(
		world, can_change_method(world) && !has_callbacks(world), &before, err);

	if (status == RB_OK)
		status = run_frame(world, &grid, err);
	if (status == RB_ERR_PHYSICS && before.is_known) {
		status = roll_back(world, &before, grid.steps, err);
		if (status == RB_OK)
			status = run_frame(world, &grid, err);
	}
	if (status != RB_OK || world->stopped)
		return status;
	world->state.frame++;
	rb_joint_states_see(world);
	world->stopped = rb_world_is_stopped(world);
	return RB_IS_CHECKED_BUILD ? rb_world_validate(world, err) : RB_OK;
}
