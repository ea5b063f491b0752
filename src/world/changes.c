/* SPDX-License-Identifier: MIT */
/*
 * What callbacks change in a world (rbsim/world.h). Each change is entered in the ledger as the
 * difference of energy and momentum before and after, which covers any kind of change, and reported
 * as an event; joints whose bodies it sets moving are told.
 */
#include "base/error.h"
#include "base/memory.h"
#include "model/joints.h"
#include "world/joint_state.h"
#include "world/world.h"

/* What a callback can change of a body, for the difference before and after. */
struct account {
	rb_vec3 position, momentum, spin_momentum; /* of its centre of mass, and about it */
	double energy;                             /* J; this and the next for the ledger alone */
	rb_vec3 angular;                           /* kg m^2/s, about the origin */
};

/*
 * Zeros for bodies without a mass of their own. Energy and angular momentum only if a ledger is
 * kept: the energy of force elements costs a sum over all of them.
 */
static struct account account_of(const struct rb_world *world, int id)
{
	const struct rb_world_def *def = &world->model->scene->world;
	struct account account = {0};

	if (!rb_world_is_dynamic(world, id))
		return account;
	account.position = rb_world_center_of_mass(world, id);
	account.momentum = rb_world_momentum(world, id);
	if (world->state.spin)
		account.spin_momentum = rb_world_spin_momentum(world, world->model->index_of[id]);
	if (!world->ledger.kept)
		return account;
	const rb_vec3 weight = rb_vec3_add_scaled(def->gravity_force, rb_world_mass(world, id),
	                                          def->gravity);

	account.energy = rb_world_kinetic_energy(world, id) -
	                 rb_vec3_dot(weight, account.position) +
	                 rb_world_element_energy(world, NULL);
	account.angular = rb_world_angular_momentum(world, id);
	return account;
}

/* Records a change; several of one kind to one body at one moment are added up in one event. */
static void report_change(struct rb_world *world, enum rb_event_kind kind, int id, rb_vec3 change)
{
	struct rb_events *const events = &world->events;
	struct rb_event event = {.time_s = world->state.time_s,
	                         .kind = kind,
	                         .a = id,
	                         .b = id,
	                         .point = rb_world_center_of_mass(world, id),
	                         .impulse = change};

	if (rb_vec3_dot(change, change) == 0)
		return;
	for (size_t k = events->count; k-- > 0 && events->row[k].a == id &&
	                               events->row[k].b == id &&
	                               events->row[k].time_s == event.time_s;) {
		if (events->row[k].kind != kind)
			continue;
		event.impulse = rb_vec3_add(events->row[k].impulse, change);
		events->row[k] = event;
		return;
	}
	if (rb_memory_reserve(&events->row, &events->capacity, events->count + 1,
	                      sizeof *events->row))
		events->row[events->count++] = event;
	else
		events->lost = true;
}

/* Enters the change since `before` in the ledger and the events, where these are kept. */
static void enter_change(struct rb_world *world, int id, const struct account *before)
{
	const struct account now = account_of(world, id);
	const rb_vec3 impulse = rb_vec3_sub(now.momentum, before->momentum);
	const struct rb_joints *joints = world->model->joints;
	const int i = world->model->index_of[id];
	struct rb_entries e = {0};

	for (int at = joints ? joints->first[i] : 0; joints && at < joints->first[i + 1]; at++)
		world->joint[joints->of[at]].was_set = true;
	if (world->options.keep_events) {
		report_change(world, RB_EVENT_IMPULSE, id, impulse);
		report_change(world, RB_EVENT_ANGULAR_IMPULSE, id,
		              rb_vec3_sub(now.spin_momentum, before->spin_momentum));
		report_change(world, RB_EVENT_DISPLACEMENT, id,
		              rb_vec3_sub(now.position, before->position));
	}
	if (!world->ledger.kept)
		return;
	rb_entries_energy(&e, RB_ENERGY_CALLBACKS, now.energy - before->energy);
	rb_entries_momentum(&e, RB_MOMENTUM_CALLBACKS, impulse,
	                    rb_vec3_sub(now.angular, before->angular));
	rb_ledger_enter(&world->ledger, &e);
}

void rb_world_apply_impulse(struct rb_world *world, int id, rb_vec3 impulse, rb_vec3 point)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const struct rb_model *model = world->model;
	const int i = model->index_of[id];
	const rb_vec3 arm = rb_vec3_sub(point, rb_world_row3(world->state.position, i));
	const rb_vec3 v = rb_world_row3(world->state.velocity, i);
	const struct account before = account_of(world, id);

	world->moment++;
	rb_contacts_drop(&world->contacts, i);
	rb_vec3_to(world->state.velocity + 3 * i,
	           rb_vec3_add_scaled(v, model->inverse_mass[i], impulse));
	if (world->state.spin) {
		const rb_vec3 w = rb_world_row3(world->state.spin, i);
		const rb_vec3 turn = rb_world_turn(world, &world->state, i,
		                                   rb_vec3_cross(arm, impulse));

		rb_vec3_to(world->state.spin + 3 * i, rb_vec3_add(w, turn));
	}
	enter_change(world, id, &before);
}

void rb_world_apply_force(struct rb_world *world, int id, rb_vec3 force, rb_vec3 point)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const int i = world->model->index_of[id];
	const rb_vec3 arm = rb_vec3_sub(point, rb_world_row3(world->state.position, i));

	if (!world->state.push)
		return;
	world->pushed = true;
	world->moment++;
	rb_vec3_to(world->state.push + 3 * i,
	           rb_vec3_add(rb_world_row3(world->state.push, i), force));
	rb_vec3_to(world->state.twist + 3 * i,
	           rb_vec3_add(rb_world_row3(world->state.twist, i), rb_vec3_cross(arm, force)));
}

void rb_world_apply_torque(struct rb_world *world, int id, rb_vec3 torque)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const int i = world->model->index_of[id];

	if (!world->state.twist)
		return;
	world->pushed = true;
	world->moment++;
	rb_vec3_to(world->state.twist + 3 * i,
	           rb_vec3_add(rb_world_row3(world->state.twist, i), torque));
}

void rb_world_set_velocity(struct rb_world *world, int id, rb_vec3 velocity)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const int i = world->model->index_of[id];
	const struct account before = account_of(world, id);

	world->moment++;
	rb_contacts_drop(&world->contacts, i);
	rb_vec3_to(world->state.velocity + 3 * i, velocity);
	enter_change(world, id, &before);
}

void rb_world_set_angular_velocity(struct rb_world *world, int id, rb_vec3 angular_velocity)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const int i = world->model->index_of[id];
	const struct account before = account_of(world, id);

	if (!world->state.spin)
		return;
	world->moment++;
	rb_contacts_drop(&world->contacts, i);
	rb_vec3_to(world->state.spin + 3 * i, angular_velocity);
	enter_change(world, id, &before);
}

void rb_world_set_position(struct rb_world *world, int id, rb_vec3 position)
{
	RB_ASSERT(!rb_world_is_static(world, id));

	const int i = world->model->index_of[id];
	const rb_vec3 shift = rb_vec3_sub(position, rb_world_origin_at(world, &world->state, i));

	const struct account before = account_of(world, id);

	world->moment++;
	rb_contacts_drop(&world->contacts, i);
	world->moved_by_hand = true;
	rb_vec3_to(world->state.position + 3 * i,
	           rb_vec3_add(rb_world_row3(world->state.position, i), shift));
	enter_change(world, id, &before);
}
