/* SPDX-License-Identifier: MIT */
/*
 * Sums over bodies in their order, in plain double precision: a frame's numbers are for users and
 * tests, and no decision depends on them. The ledger's residual is a difference of large numbers,
 * so its potential energies are relative to each body's initial position.
 */
#include "method/numbers.h"

#include "base/error.h"
#include "base/memory.h"
#include "step/broadphase.h"

#include <string.h>

/*
 * Adds the magnitudes of the bodies' own momenta to the scales with which residuals are compared,
 * kg m/s and kg m^2/s.
 */
static void measure_sizes(const struct rb_world *world, struct rb_ledger_values *values)
{
	const struct rb_model *model = world->model;

	for (int i = 0; i < model->body_count; i++) {
		if (model->driven && model->driven[i])
			continue;
		const double p = model->mass[i] *
		                 rb_vec3_length(rb_world_row3(world->state.velocity, i));

		values->momentum_scale[0] += p;
		values->momentum_scale[1] += p * rb_vec3_length(
							 rb_world_row3(world->state.position, i));
		if (!world->state.spin)
			continue;
		const double turning = rb_vec3_length(rb_world_spin_momentum(world, i));

		/* a rotor in bearings has no net momentum: those of its parts cancel */
		values->momentum_scale[0] += turning / rb_model_reach(model, i);
		values->momentum_scale[1] += turning;
	}
}

/*
 * The numbers with potential energies relative to each body's start rather than to the origin:
 * heavy bodies at rest then contribute no rounding.
 */
static struct rb_frame_numbers since_start(const struct rb_world *world,
                                           const struct rb_frame_numbers *numbers,
                                           double element_energy)
{
	const struct rb_model *model = world->model;
	const rb_vec3 gravity = model->scene->world.gravity;
	const rb_vec3 force = model->scene->world.gravity_force;
	struct rb_frame_numbers since = *numbers;

	since.potential_energy = element_energy;
	for (int i = 0; i < model->body_count; i++) {
		if (model->driven && model->driven[i])
			continue;
		const rb_vec3 way = rb_vec3_sub(rb_world_row3(world->state.position, i),
		                                model->position[i]);

		since.potential_energy -= model->mass[i] * rb_vec3_dot(gravity, way) +
		                          rb_vec3_dot(force, way);
	}
	return since;
}

/*
 * True if mutual attraction is the only force on the whole, so that it cannot accelerate its centre
 * of mass.
 */
static bool has_center(const struct rb_model *model)
{
	return (model->features & RB_FEATURE_GRAVITATION) && model->attracts_by_mass &&
	       model->center_count == 0 &&
	       !(model->features & (RB_FEATURE_GRAVITY | RB_FEATURE_GRAVITY_FORCE));
}

/* Mass and its centre, where has_center. */
static void measure_center(const struct rb_world *world, struct rb_frame_numbers *numbers)
{
	const struct rb_model *model = world->model;

	*numbers = (struct rb_frame_numbers){0};
	if (!has_center(model))
		return;
	for (int i = 0; i < model->body_count; i++) {
		if (model->driven && model->driven[i])
			continue;
		numbers->mass += model->mass[i];
		numbers->center_of_mass = rb_vec3_add_scaled(
			numbers->center_of_mass, model->mass[i],
			rb_world_row3(world->state.position, i));
	}
	if (numbers->mass > 0)
		numbers->center_of_mass = rb_vec3_scale(1 / numbers->mass, numbers->center_of_mass);
}

/*
 * Loops straight over the columns, since this runs for every recorded frame. Returns the energy of
 * force elements among it, J, which is computed once.
 */
static double measure_bodies(const struct rb_world *world, struct rb_frame_numbers *numbers)
{
	const struct rb_model *model = world->model;
	const struct rb_state *state = &world->state;
	const rb_vec3 gravity = model->scene->world.gravity;
	const rb_vec3 force = model->scene->world.gravity_force;
	double twice_kinetic = 0, potential = 0;
	rb_vec3 momentum = {0, 0, 0}, angular = {0, 0, 0};

	measure_center(world, numbers);
	const struct rb_frame_numbers center = *numbers;
	for (int i = 0; i < model->body_count; i++) {
		if (model->driven && model->driven[i]) /* has no mass that counts */
			continue;
		const double mass = model->mass[i];
		const rb_vec3 at = rb_world_row3(state->position, i);
		const rb_vec3 v = rb_world_row3(state->velocity, i);
		const rb_vec3 p = rb_vec3_scale(mass, v);

		twice_kinetic += rb_vec3_dot(p, v);
		potential -= mass * rb_vec3_dot(gravity, at) + rb_vec3_dot(force, at);
		momentum = rb_vec3_add(momentum, p);
		angular = rb_vec3_add(angular, rb_vec3_cross(at, p));
		if (state->spin) {
			const rb_vec3 spin = rb_world_row3(state->spin, i);
			const rb_vec3 l = rb_world_spin_momentum(world, i);

			twice_kinetic += rb_vec3_dot(spin, l);
			angular = rb_vec3_add(angular, l);
		}
	}
	struct rb_gravitation_error error_found;
	const double element_energy = rb_world_element_energy(world, &error_found);

	*numbers = (struct rb_frame_numbers){.kinetic_energy = 0.5 * twice_kinetic,
	                                     .potential_energy = potential + element_energy,
	                                     .momentum = momentum,
	                                     .angular_momentum = angular,
	                                     .mass = center.mass,
	                                     .center_of_mass = center.center_of_mass,
	                                     .gravitation_error = error_found.acceleration,
	                                     .gravitation_energy_error = error_found.potential};
	return element_energy;
}

void rb_numbers_start_ledger(struct rb_world *world)
{
	struct rb_frame_numbers numbers;

	numbers = since_start(world, &numbers, measure_bodies(world, &numbers));
	rb_ledger_start(&world->ledger, &numbers);
	world->ledger.kept = true;
}

/* Entries and residual at this time, including those not yet entered (world->open). */
static void measure_ledger(const struct rb_world *world, struct rb_frame_numbers *numbers,
                           double element_energy)
{
	const struct rb_frame_numbers since = since_start(world, numbers, element_energy);
	struct rb_ledger ledger = world->ledger;

	rb_ledger_enter(&ledger, &world->open);
	numbers->has_ledger = true;
	numbers->ledger = rb_ledger_values(&ledger, &since);
	/* causes that cancel in angular momentum about the origin are not small */
	numbers->ledger.momentum_scale[1] += world->model->coordinate_max_m *
	                                     numbers->ledger.momentum_scale[0];
	measure_sizes(world, &numbers->ledger);
}

void rb_numbers_measure(const struct rb_world *world, struct rb_frame_numbers *numbers)
{
	const double element_energy = measure_bodies(world, numbers);

	if (world->ledger.kept)
		measure_ledger(world, numbers, element_energy);
}

void rb_numbers_count(struct rb_frame_numbers *numbers, const struct rb_counts *counts,
                      size_t contacts)
{
	numbers->contacts = contacts;
	numbers->collisions = counts->collisions;
	numbers->rollbacks = counts->rollbacks;
	numbers->substeps = counts->substeps;
	numbers->smallest_step = isfinite(counts->smallest_step_s) ? counts->smallest_step_s : 0;
	numbers->max_penetration = counts->max_penetration_m;
	numbers->stepped = counts->stepped_s;
}

struct rb_frame_numbers rb_world_totals(struct rb_world *world)
{
	struct rb_frame_numbers numbers;
	struct rb_counts counts = world->total_counts;

	rb_counts_add(&counts, &world->frame_counts);
	rb_numbers_measure(world, &numbers);
	rb_numbers_count(&numbers, &counts, world->contacts.count);
	return numbers;
}

struct rb_world_work rb_world_work(const struct rb_world *world)
{
	struct rb_counts counts = world->total_counts;

	rb_counts_add(&counts, &world->frame_counts);
	return (struct rb_world_work){
		.body_steps = counts.body_steps,
		.discarded_body_steps = counts.discarded_body_steps,
		.plastic_ends = counts.plastic_ends,
		.crowded_impacts = counts.crowded_impacts,
		.crowded_energy_j = counts.crowded_energy_j,
		.rows = counts.rows,
		.row_sweeps = counts.row_sweeps,
		.factors = counts.factors,
		.closings = counts.closings,
		.residual_m = counts.residual_m,
		.slip_m = counts.slip_m,
		.pair_tests = world->broadphase ? rb_broadphase_tests(world->broadphase) : 0};
}

/* Fills the columns of a frame; positions are those of the shapes' origins. */
static void fill_poses(const struct rb_world *world, struct rb_frame *frame)
{
	const struct rb_model *model = world->model;
	const size_t n = (size_t)model->body_count;

	if (frame->position && !model->center_of_mass)
		memcpy(frame->position, world->state.position, 3 * n * sizeof(double));
	else if (frame->position)
		for (size_t i = 0; i < n; i++)
			rb_vec3_to(frame->position + 3 * i,
			           rb_world_origin_at(world, &world->state, (int)i));
	RB_ASSERT(!frame->orientation || world->state.orientation);
	RB_ASSERT(!frame->angular_velocity || world->state.spin);
	if (frame->orientation)
		memcpy(frame->orientation, world->state.orientation, 4 * n * sizeof(double));
	if (frame->velocity)
		memcpy(frame->velocity, world->state.velocity, 3 * n * sizeof(double));
	if (frame->angular_velocity)
		memcpy(frame->angular_velocity, world->state.spin, 3 * n * sizeof(double));
}

/* Copies the events since the last frame; false if there is, or was, no memory. */
static bool fill_events(struct rb_world *world, struct rb_frame *frame)
{
	size_t capacity = (size_t)frame->event_capacity;

	if (world->events.lost || !rb_memory_reserve(&frame->events, &capacity, world->events.count,
	                                             sizeof *frame->events))
		return false;
	frame->event_capacity = (int)capacity;
	frame->event_count = (int)world->events.count;
	if (world->events.count > 0)
		memcpy(frame->events, world->events.row,
		       world->events.count * sizeof *frame->events);
	return true;
}

/* Contacts with ids of the scene, a < b. */
static bool fill_contacts(struct rb_world *world, struct rb_frame *frame)
{
	const struct rb_contacts *contacts = world->has_shown ? &world->shown : &world->contacts;
	size_t capacity = (size_t)frame->contact_capacity;

	if (!rb_memory_reserve(&frame->contacts, &capacity, contacts->count,
	                       sizeof *frame->contacts))
		return false;
	frame->contact_capacity = (int)capacity;
	frame->contact_count = (int)contacts->count;
	for (size_t k = 0; k < contacts->count; k++) {
		const struct rb_contact *c = &contacts->row[k];
		RB_ASSERT_COSTLY(c->a >= 0 && c->a < world->model->body_count && c->b > c->a);
		struct rb_frame_contact *out = &frame->contacts[k];
		const int a = world->model->id_of[c->a], b = world->model->id_of[c->b];
		const double sign = a < b ? 1 : -1;

		*out = (struct rb_frame_contact){.a = a < b ? a : b,
		                                 .b = a < b ? b : a,
		                                 .point = c->point,
		                                 .normal = rb_vec3_scale(sign, c->normal),
		                                 .gap = c->gap};
		out->force = rb_vec3_scale(
			sign, rb_vec3_add_scaled(c->tangent_force, c->normal_force, c->normal));
	}
	return true;
}

enum rb_status rb_numbers_fill_frame(struct rb_world *world, struct rb_frame *frame,
                                     struct rb_error *err)
{
	frame->index = world->state.frame;
	frame->time_s = world->state.time_s;
	frame->body_count = world->model->body_count;
	fill_poses(world, frame);
	rb_numbers_measure(world, &frame->numbers);
	if (world->late->status != RB_OK)
		return RB_FAIL(err, world->late->status, "%s", world->late->error.text);
	rb_numbers_count(&frame->numbers, &world->frame_counts, world->contacts.count);
	frame->event_count = frame->contact_count = 0;
	frame->has_events = world->options.keep_events;
	if ((world->options.keep_events && !fill_events(world, frame)) ||
	    (world->options.keep_contacts && !fill_contacts(world, frame)))
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "no memory for %zu events and %zu contacts of a frame",
		               world->events.count, world->contacts.count);
	rb_counts_add(&world->total_counts, &world->frame_counts);
	world->frame_counts = rb_counts_none;
	world->events.count = 0;
	return RB_OK;
}
