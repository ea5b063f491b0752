/* SPDX-License-Identifier: MIT */
/*
 * The inside of a running world: model + state + scratch, and who may touch it when.
 *
 * Between steps everything belongs to the simulator thread. While groups run, a worker touches only
 * the state rows of its group's bodies and its own arena; all else is read only until the team has
 * come back.
 */
#ifndef RB_WORLD_WORLD_H
#define RB_WORLD_WORLD_H

#include <rbsim/world.h>

#include "base/arena.h"
#include "base/interrupt.h"
#include "base/team.h"
#include "force/gravitation.h"
#include "math/quat.h"
#include "model/element.h"
#include "world/contacts.h"
#include "world/ledger.h"
#include "world/state.h"

#include <math.h>

struct rb_broadphase;
struct rb_stage_list;
struct rb_groups;
struct rb_located;
struct rb_stepped;
struct rb_loads;
struct rb_joint_state;
struct rb_late;

/*
 * Counts since some moment: sums and extremes, so the order of adding does not matter, to rounding
 * of the seconds and joules.
 */
#define RB_COUNTS_SUMS(X)                                                                       \
	X(uint64_t, collisions, , "", "impacts", RB_ANY_BITS)                                   \
	X(uint64_t, rollbacks, , "", "tries taken back", RB_ANY_BITS)                           \
	X(uint64_t, substeps, , "", "kept", RB_ANY_BITS)                                        \
	X(uint64_t, body_steps, , "", "of all substeps", RB_ANY_BITS)                           \
	X(uint64_t, discarded_body_steps, , "", "of tries taken back", RB_ANY_BITS)             \
	X(uint64_t, plastic_ends, , "",                                                         \
	  "clusters of impacts that had not settled after all rounds: ended with e = 0",        \
	  RB_ANY_BITS)                                                                          \
	X(uint64_t, crowded_impacts, , "",                                                      \
	  "stepped: impacts of groups too large for the law of lone ones", RB_ANY_BITS)         \
	X(uint64_t, rows, , "", "stepped: contact points of steps", RB_ANY_BITS)                \
	X(uint64_t, row_sweeps, , "", "stepped: times that one was swept", RB_ANY_BITS)         \
	X(uint64_t, factors, , "", "stepped: factorizations", RB_ANY_BITS)                      \
	X(uint64_t, closings, , "", "stepped: moves of positions only", RB_ANY_BITS)            \
	X(uint64_t, solving, , "", "stepped: products of solutions of what moves", RB_ANY_BITS) \
	X(double, crowded_energy_j, , "J", "of the approach of crowded impacts", RB_NUMBER)     \
	X(double, stepped_s, , "s", "simulated by steps: classic or stepped", RB_FINITE)
#define RB_COUNTS_SMALLEST(X) X(double, smallest_step_s, , "s", "HUGE_VAL: no step yet", RB_TIME)
#define RB_COUNTS_LARGEST(X)                                                                     \
	X(double, residual_m, , "m", "stepped: largest that a solution left of a gap's closing", \
	  RB_FINITE)                                                                             \
	X(double, slip_m, , "m", "stepped: largest left of friction's where that was held",      \
	  RB_FINITE)                                                                             \
	X(double, max_penetration_m, , "m", "largest overlap", RB_FINITE)
#define RB_COUNTS_FIELDS(X) RB_COUNTS_SUMS(X) RB_COUNTS_SMALLEST(X) RB_COUNTS_LARGEST(X)
struct rb_counts {
	RB_COUNTS_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_counts_fields);

static const struct rb_counts rb_counts_none = {.smallest_step_s = HUGE_VAL};

static inline void rb_counts_add(struct rb_counts *to, const struct rb_counts *from)
{
#define RB_COUNTS_SUM(type, name, ...) to->name += from->name;
#define RB_COUNTS_SMALLER(type, name, ...) to->name = fmin(to->name, from->name);
#define RB_COUNTS_LARGER(type, name, ...) to->name = fmax(to->name, from->name);
	RB_COUNTS_SUMS(RB_COUNTS_SUM)
	RB_COUNTS_SMALLEST(RB_COUNTS_SMALLER)
	RB_COUNTS_LARGEST(RB_COUNTS_LARGER)
#undef RB_COUNTS_SUM
#undef RB_COUNTS_SMALLER
#undef RB_COUNTS_LARGER
}

/* The list of struct rb_event (<rbsim/frame.h>). */
#define RB_EVENT_FIELDS(X)                                                               \
	X(double, time_s, , "s", "when", RB_FINITE)                                      \
	X(enum rb_event_kind, kind, , "", "what", RB_WITHIN(0, RB_EVENT_KIND_COUNT - 1)) \
	X(int, a, , "", "id", RB_UP_TO(RB_LIMIT_ID))                                     \
	X(int, b, , "", "id, >= a", RB_UP_TO(RB_LIMIT_ID))                               \
	X(rb_vec3, point, , "m", "where", RB_FINITE)                                     \
	X(rb_vec3, normal, , "1", "unit, from a to b", RB_FINITE)                        \
	X(rb_vec3, impulse, , "N s", "on b", RB_NUMBER)                                  \
	X(double, approach_speed, , "m/s", "> 0, along the normal", RB_FINITE)           \
	X(int, joint, , "", "1 + number of the joint, 0: none", RB_UP_TO(RB_LIMIT_NEXT_JOINT))
RB_FIELDS_DECLARE(rb_event_fields);

struct rb_events {
	struct rb_event *row; /* owned; `a`, `b` are ids */
	size_t count, capacity;
	bool lost; /* there was no memory for one of them: the frame cannot be filled */
};

/* Of a world, beside its state, its contacts and the states of methods. */
#define RB_WORLD_FIELDS(X)                                                                   \
	X(int64_t, dense_steps, , "", "auto: steps that another method takes",               \
	  RB_LONG_WITHIN(0, INT64_MAX))                                                      \
	X(int64_t, dense_left, , "", "auto: of these, still to take",                        \
	  RB_LONG_WITHIN(0, INT64_MAX))                                                      \
	X(uint64_t, dense_work, , "", "auto: products that these have cost", RB_ANY_BITS)    \
	X(uint64_t, dense_body_steps, , "", "auto: of all bodies, in these", RB_ANY_BITS)    \
	X(double, dense_s, , "s", "auto: that these have taken", RB_FINITE)                  \
	X(bool, has_shown, , "", "`shown` is of this frame", RB_FLAG)                        \
	X(bool, has_held, , "", "callbacks pushed in the step before, with `held`", RB_FLAG) \
	X(bool, moved_by_hand, , "", "a callback has set a position", RB_FLAG)

struct rb_world {
	/* set when it is made, then only read */
	const struct rb_model *model;
	struct rb_world_options options;
	struct rb_world_hooks hooks;
	struct rb_stage_list *plan; /* owned */

	/* simulator thread: what decides the future, listed; then all else */
	RB_WORLD_FIELDS(RB_FIELD_MEMBER)
	/* rows of `state` are lent to workers while groups run */
	struct rb_state state;
	struct rb_joint_state *joint; /* owned, [joints]: world/joint_state; NULL without */
	/* owned, [joints]: what each exerts on its b, as its method has found it last */
	struct rb_wrench *joint_load;
	bool joints_changed;   /* by a callback, since a method has looked */
	struct rb_state start; /* as it was at the beginning of the step */
	struct rb_state mark;  /* rows as they were at the beginning of the group's substep */
	struct rb_contacts contacts, next_contacts;
	struct rb_contacts
		shown; /* located: contacts with their forces at a frame, where frames keep them */
	struct rb_state frame_state;        /* auto: as the frame began */
	struct rb_contacts frame_contacts;  /* its contacts */
	struct rb_broadphase *broadphase;   /* owned; NULL without contact */
	struct rb_groups *groups;           /* owned; NULL without contact */
	struct rb_located *located;         /* owned; NULL: all is stepped */
	struct rb_stepped *stepped;         /* owned; NULL until it is first used */
	struct rb_gravitation *gravitation; /* owned: scratch of whoever sums now, and of a step */
	struct rb_late *late;               /* owned */
	struct rb_team *team;               /* owned */
	struct rb_arena *arena;             /* owned; [workers]: scratch of a pass */
	struct rb_arena *kept; /* owned; [workers]: what a pass leaves for the commit of the step */
	int worker_count;
	struct rb_counts frame_counts; /* since the frame before */
	struct rb_counts total_counts; /* of the run, without frame_counts */
	struct rb_events events;       /* since the frame before */
	struct rb_ledger ledger;
	struct rb_entries
		open; /* what is not yet entered, as of the state's time (located/account) */
	struct rb_loads *loads; /* owned; NULL until somebody asks what acts */
	uint64_t
		/* counts what may change that: steps, events, callbacks that set something */
		moment;
	/* somebody may ask for contact forces: those of steps are of whole ones */
	bool keeps_means;
	bool begun; /* a step has been taken, or is */
	bool in_step;
	bool pushed;  /* callbacks may have pushed since the step before */
	double *held; /* what they pushed with, N, N m; owned, [2][bodies][3]; NULL: none can */
	const double *push, *twist; /* those that hold now; NULL: none */
	uint64_t called; /* how often callbacks have been told of events by the located method */
	bool stopped;
	struct rb_interrupt interrupt; /* of the frame under way */
};

/* The first failure of a function asked where nothing can fail: told with the next frame. */
struct rb_late {
	enum rb_status status;
	struct rb_error error;
};

/* Whether the run is to end, which whoever may take long asks now and then. */
static inline bool rb_world_is_stopped(const struct rb_world *world)
{
	return world->options.stop && world->options.stop(world->options.stop_user);
}

static inline rb_vec3 rb_world_row3(const double *column, int index)
{
	return rb_vec3_from(column + 3 * (size_t)index);
}

RB_FIELDS_DECLARE(rb_world_fields);

/*
 * Calls on_collision or on_transition for each event from `first` on that there is by now
 * (callbacks may append changes of their own), in order. Nothing is left of the events where none
 * are kept.
 */
RB_CHECKED enum rb_status rb_world_report_events(struct rb_world *world, size_t first,
                                                 struct rb_error *err);

/*
 * What callbacks push with: in a step what the state has, else what they have pushed with in the
 * one before.
 */
static inline void rb_world_choose_pushes(struct rb_world *world)
{
	const size_t half = 3 * (size_t)world->model->body_count;

	world->push = world->in_step ? world->state.push : world->has_held ? world->held : NULL;
	world->twist = world->in_step    ? world->state.twist
	               : world->has_held ? world->held + half
	                                 : NULL;
}

/* Orientation of a body by index, moving or not. */
static inline rb_quat rb_world_orientation_at(const struct rb_world *world,
                                              const struct rb_state *state, int index)
{
	if (index < world->model->body_count && state->orientation)
		return rb_quat_from(state->orientation + 4 * (size_t)index);
	return world->model->orientation[index];
}

/* The same as rb_world_origin_at, of a body whose centre of mass is elsewhere. */
rb_vec3 rb_world_origin_beside(const struct rb_world *world, const struct rb_state *state,
                               int index);

/* Position of the object's origin, which is the centre of its shape. */
static inline rb_vec3 rb_world_origin_at(const struct rb_world *world, const struct rb_state *state,
                                         int index)
{
	const struct rb_model *model = world->model;

	if (index >= model->body_count)
		return model->position[index];
	if (!model->center_of_mass)
		return rb_world_row3(state->position, index);
	return rb_world_origin_beside(world, state, index);
}

/* I^-1 applied to an angular impulse, world axes; the body must be moving and able to turn. */
static inline rb_vec3 rb_world_turn(const struct rb_world *world, const struct rb_state *state,
                                    int index, rb_vec3 angular_impulse)
{
	const struct rb_model *model = world->model;
	const double scalar = model->inverse_inertia_scalar[index];

	if (!isnan(scalar))
		return rb_vec3_scale(scalar, angular_impulse);
	const rb_quat q = rb_quat_from(state->orientation + 4 * (size_t)index);
	return rb_quat_rotate(q, rb_mat3_apply(rb_model_inverse_inertia(model, index),
	                                       rb_quat_rotate_back(q, angular_impulse)));
}

/* Of any body, by index. */
struct rb_pose rb_world_pose(const struct rb_world *world, const struct rb_state *state, int index);

/* Moving bodies to world->gravitation, where the scene has it. */
void rb_world_place_attracted(const struct rb_world *world, const struct rb_state *state);

/*
 * J, of all force elements that have one, of springs zero at rest length; and of gravitation, zero
 * apart at infinity; and of fields, of those that state a potential. `*found`: what gravitation is
 * wrong by; may be NULL. NAN where something fails, which `late` then says.
 */
double rb_world_element_energy(const struct rb_world *world, struct rb_gravitation_error *found);

/* J, of springs in joints (world/joint_state). */
double rb_joint_states_energy(const struct rb_world *world);

/* By id. Neither static nor driven, so that its energy and momentum count. */
bool rb_world_is_dynamic(const struct rb_world *world, int id);

/* Angular momentum about its own centre of mass: of a moving body that can turn, with a spin. */
static inline rb_vec3 rb_world_weigh_spin(const struct rb_world *world,
                                          const struct rb_state *state, int index, rb_vec3 spin)
{
	const struct rb_model *model = world->model;

	if (!isnan(model->inverse_inertia_scalar[index]))
		return rb_vec3_scale(rb_model_inertia(model, index)->m[0][0], spin);
	const rb_quat q = rb_quat_from(state->orientation + 4 * (size_t)index);
	return rb_quat_rotate(
		q, rb_mat3_apply(rb_model_inertia(model, index), rb_quat_rotate_back(q, spin)));
}

/* The same with the spin that it has. */
static inline rb_vec3 rb_world_spin_momentum(const struct rb_world *world, int index)
{
	return rb_world_weigh_spin(world, &world->state, index,
	                           rb_world_row3(world->state.spin, index));
}

#endif
