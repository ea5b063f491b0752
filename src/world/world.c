/* SPDX-License-Identifier: MIT */
/* What callers may read of a world. Ids are those of the scene; internally all is by index. */
#include "world/world.h"

#include "base/error.h"
#include "base/memory.h"

RB_FIELDS_DEFINE(rb_counts_fields, struct rb_counts, RB_COUNTS_FIELDS);
RB_FIELDS_DEFINE(rb_event_fields, struct rb_event, RB_EVENT_FIELDS);
RB_FIELDS_DEFINE_PART(rb_world_fields, struct rb_world, RB_WORLD_FIELDS);

/* True for a body that is not static. */
static bool moves(const struct rb_world *world, int id)
{
	RB_ASSERT_COSTLY(id >= 0 && id < world->model->body_count + world->model->static_count);

	return world->model->index_of[id] < world->model->body_count;
}

bool rb_world_is_dynamic(const struct rb_world *world, int id)
{
	return moves(world, id) &&
	       !(world->model->driven && world->model->driven[world->model->index_of[id]]);
}

int rb_world_id_count(const struct rb_world *world)
{
	return world->model->body_count + world->model->static_count;
}

bool rb_world_is_static(const struct rb_world *world, int id)
{
	return !moves(world, id);
}

bool rb_world_stopped(const struct rb_world *world)
{
	return world->stopped;
}

uint64_t rb_world_frame(const struct rb_world *world)
{
	return world->state.frame;
}

uint64_t rb_world_frame_count(const struct rb_world *world)
{
	return world->model->frame_count;
}

double rb_world_time(const struct rb_world *world)
{
	return world->state.time_s;
}

double rb_world_tolerance(const struct rb_world *world)
{
	return world->dense_steps > 0 ? world->model->stepped_tolerance_m
	                              : world->model->tolerance_m;
}

double rb_world_mass(const struct rb_world *world, int id)
{
	return world->model->mass[world->model->index_of[id]];
}

rb_mat3 rb_world_inertia(const struct rb_world *world, int id)
{
	const struct rb_model *model = world->model;

	return moves(world, id) && model->inertia ? *rb_model_inertia(model, model->index_of[id])
	                                          : (rb_mat3){{{0}}};
}

rb_vec3 rb_world_origin_beside(const struct rb_world *world, const struct rb_state *state,
                               int index)
{
	const rb_quat turn = rb_world_orientation_at(world, state, index);

	return rb_vec3_sub(rb_world_row3(state->position, index),
	                   rb_quat_rotate(turn, world->model->center_of_mass[index]));
}

rb_vec3 rb_world_position(const struct rb_world *world, int id)
{
	return rb_world_origin_at(world, &world->state, world->model->index_of[id]);
}

rb_quat rb_world_orientation(const struct rb_world *world, int id)
{
	return rb_world_orientation_at(world, &world->state, world->model->index_of[id]);
}

rb_vec3 rb_world_velocity(const struct rb_world *world, int id)
{
	const rb_vec3 none = {0, 0, 0};

	return moves(world, id) ? rb_world_row3(world->state.velocity, world->model->index_of[id])
	                        : none;
}

rb_vec3 rb_world_angular_velocity(const struct rb_world *world, int id)
{
	const rb_vec3 none = {0, 0, 0};

	return moves(world, id) && world->state.spin
	               ? rb_world_row3(world->state.spin, world->model->index_of[id])
	               : none;
}

rb_vec3 rb_world_center_of_mass(const struct rb_world *world, int id)
{
	return moves(world, id) ? rb_world_row3(world->state.position, world->model->index_of[id])
	                        : rb_world_position(world, id);
}

/*
 * Angular momentum about its centre of mass of a dynamic body by id; zero for those that cannot
 * turn.
 */
static rb_vec3 spin_momentum(const struct rb_world *world, int id)
{
	const rb_vec3 none = {0, 0, 0};

	return rb_world_is_dynamic(world, id) && world->state.spin
	               ? rb_world_spin_momentum(world, world->model->index_of[id])
	               : none;
}

double rb_world_kinetic_energy(const struct rb_world *world, int id)
{
	if (!rb_world_is_dynamic(world, id))
		return 0;
	const rb_vec3 v = rb_world_velocity(world, id);
	const rb_vec3 w = rb_world_angular_velocity(world, id);
	return 0.5 * rb_world_mass(world, id) * rb_vec3_dot(v, v) +
	       0.5 * rb_vec3_dot(w, spin_momentum(world, id));
}

rb_vec3 rb_world_momentum(const struct rb_world *world, int id)
{
	const rb_vec3 none = {0, 0, 0};

	return rb_world_is_dynamic(world, id)
	               ? rb_vec3_scale(rb_world_mass(world, id), rb_world_velocity(world, id))
	               : none;
}

rb_vec3 rb_world_angular_momentum(const struct rb_world *world, int id)
{
	const rb_vec3 orbital = rb_vec3_cross(rb_world_center_of_mass(world, id),
	                                      rb_world_momentum(world, id));

	return rb_vec3_add(orbital, spin_momentum(world, id));
}

rb_vec3 rb_world_point(const struct rb_world *world, int id, rb_vec3 point_local)
{
	return rb_vec3_add(rb_world_position(world, id),
	                   rb_quat_rotate(rb_world_orientation(world, id), point_local));
}

struct rb_pose rb_world_pose(const struct rb_world *world, const struct rb_state *state, int index)
{
	RB_ASSERT_COSTLY(index >= 0 &&
	                 index < world->model->body_count + world->model->static_count);

	const struct rb_model *model = world->model;
	const bool moves_too = index < model->body_count;
	struct rb_pose pose = {.origin = rb_world_origin_at(world, state, index),
	                       .orientation = rb_world_orientation_at(world, state, index)};

	pose.position = moves_too ? rb_world_row3(state->position, index) : model->position[index];
	if (!moves_too)
		return pose;
	pose.velocity = rb_world_row3(state->velocity, index);
	if (state->spin)
		pose.spin = rb_world_row3(state->spin, index);
	return pose;
}

/* The pose that a force element sees: of the present state. */
static struct rb_pose pose_of(const struct rb_element_query *query, int index)
{
	const struct rb_world *world = query->user;

	return rb_world_pose(world, &world->state, index);
}

void rb_world_place_attracted(const struct rb_world *world, const struct rb_state *state)
{
	const rb_vec3 none = {0, 0, 0};

	for (int i = 0; i < state->body_count; i++)
		rb_gravitation_place(world->gravitation, i, rb_world_row3(state->position, i),
		                     none);
}

/* J: potentials of fields on all free bodies; NAN where a function fails, which `late` says. */
static double field_energy(const struct rb_world *world)
{
	const struct rb_model *model = world->model;
	double sum = 0;

	for (int i = 0; i < model->body_count && world->late->status == RB_OK; i++) {
		double energy = 0;

		if (model->driven && model->driven[i])
			continue;
		world->late->status = world->hooks.potential(
			world->hooks.user, model->id_of[i], world->state.time_s,
			rb_world_row3(world->state.position, i), &energy, &world->late->error);
		sum += energy;
	}
	return world->late->status == RB_OK ? sum : (double)NAN;
}

/* J: of gravitation; NAN where memory is out, which `late` says. */
static double gravitation_energy(const struct rb_world *world, struct rb_gravitation_error *found)
{
	double energy;

	rb_world_place_attracted(world, &world->state);
	const enum rb_status status = rb_gravitation_energy(world->gravitation, world->team,
	                                                    world->state.frame, &energy, found,
	                                                    &world->late->error);
	if (status == RB_OK)
		return energy;
	world->late->status = status;
	return (double)NAN;
}

double rb_world_element_energy(const struct rb_world *world, struct rb_gravitation_error *found)
{
	struct rb_gravitation_error error = {0, 0};

	const struct rb_element_query query = {.model = world->model,
	                                       .time_s = world->state.time_s,
	                                       .pose = pose_of,
	                                       .user = world};
	double energy = rb_elements_energy(&query) + rb_joint_states_energy(world);

	if (world->model->features & RB_FEATURE_GRAVITATION)
		energy += gravitation_energy(world, &error);
	if (world->hooks.potential)
		energy += field_energy(world);
	if (found)
		*found = error;
	return energy;
}

/* ---- events ---- */

enum rb_status rb_world_report_events(struct rb_world *world, size_t first, struct rb_error *err)
{
	const size_t count = world->events.count;
	enum rb_status status = RB_OK;

	for (size_t k = first; k < count && status == RB_OK; k++) {
		const struct rb_event event = world->events.row[k]; /* the rows may move */
		const struct rb_world_hooks *const hooks = &world->hooks;
		const bool impact = rb_event_is_impact(event.kind);

		if (!(impact ? hooks->collision : hooks->transition))
			continue;
		status = impact ? hooks->collision(hooks->user, world, &event, err)
		                : hooks->transition(hooks->user, world, &event, err);
		world->moment++;
	}
	if (!world->options.keep_events)
		world->events.count = 0;
	return status;
}
