/* SPDX-License-Identifier: MIT */
/*
 * A pose tells the angle of a hinge up to whole turns, so the last one is kept: the present one is
 * that which is nearest to it plus the mean speed times the time, which is wrong only where the
 * speed was off that mean by half a turn in that time.
 */
#include "world/joint_state.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "world/world.h"

RB_FIELDS_DEFINE_PART(rb_joint_state_fields, struct rb_joint_state, RB_JOINT_STATE_FIELDS);

static int count_of(const struct rb_world *world)
{
	return world->model->joints ? world->model->joints->count : 0;
}

enum rb_status rb_joint_states_create(struct rb_world *world, struct rb_error *err)
{
	const int count = count_of(world);

	if (count == 0)
		return RB_OK;
	world->joint = rb_memory_take((size_t)count, sizeof *world->joint);
	world->joint_load = rb_memory_take((size_t)count, sizeof *world->joint_load);
	if (!world->joint || !world->joint_load)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for joints");
	for (int k = 0; k < count; k++) {
		const struct rb_joint *joint = &world->model->joints->joint[k];

		world->joint[k] = (struct rb_joint_state){.motor_speed = joint->motor_speed,
		                                          .motor_angle = (double)NAN,
		                                          .motor_max = joint->motor_max,
		                                          .has_motor = joint->has_motor,
		                                          .was_set = true};
		for (int i = 0; i < RB_JOINT_NOTED; i++)
			world->joint[k].noted[i] = -1;
	}
	return RB_OK;
}

/* The pose of one end; -1: the world. */
static struct rb_pose end_of(const struct rb_world *world, int index)
{
	return index < 0 ? rb_linkage_world() : rb_world_pose(world, &world->state, index);
}

/* The free coordinate at the state's poses. */
static struct rb_linkage_free free_of(const struct rb_world *world, int k)
{
	const struct rb_joint *joint = &world->model->joints->joint[k];
	const struct rb_joint_state *state = &world->joint[k];
	const struct rb_pose a = end_of(world, joint->a), b = end_of(world, joint->b);
	struct rb_linkage_free free = rb_linkage_free(&joint->link, &a, &b);

	free.value = rb_joint_state_angle(state, &joint->link, world->state.time_s, &free);
	return free;
}

void rb_joint_states_see(struct rb_world *world)
{
	for (int k = 0; k < count_of(world); k++) {
		if (!rb_linkage_has_free(&world->model->joints->joint[k].link))
			continue;
		const struct rb_linkage_free free = free_of(world, k);

		world->joint[k].angle = free.value;
		world->joint[k].speed = free.rate;
		world->joint[k].seen_s = world->state.time_s;
	}
}

double rb_joint_states_energy(const struct rb_world *world)
{
	double sum = 0;

	for (int k = 0; k < count_of(world); k++) {
		const struct rb_joint *joint = &world->model->joints->joint[k];

		if (!(joint->stiffness > 0) || world->joint[k].released)
			continue;
		const double stretch = free_of(world, k).value - joint->rest;

		sum += 0.5 * joint->stiffness * stretch * stretch;
	}
	return sum;
}

void rb_joint_states_pack(struct rb_world *world, struct rb_pack *pack)
{
	rb_fields_pack(rb_joint_state_fields(), world->joint, (size_t)count_of(world), NULL, pack);
}

void rb_joint_states_fit(struct rb_world *world)
{
	for (int k = 0; k < count_of(world); k++)
		world->joint[k].was_set = false;
}

uint64_t rb_joint_states_hash(const struct rb_world *world, uint64_t hash)
{
	return count_of(world) > 0 ? rb_fields_hash(rb_joint_state_fields(), world->joint,
	                                            (size_t)count_of(world), hash)
	                           : hash;
}

/* ---- what callers read and callbacks change ---- */

struct rb_joint_reading rb_joint_state_now(const struct rb_world *world, int k)
{
	struct rb_joint_reading now = {.released = false};

	RB_ASSERT(k >= 0 && k < count_of(world));
	const struct rb_joint *joint = &world->model->joints->joint[k];
	now.released = world->joint[k].released;
	if (rb_linkage_has_free(&joint->link)) {
		const struct rb_linkage_free free = free_of(world, k);

		now.angle = free.value;
		now.speed = free.rate;
	} else if (joint->link.type->coordinate == RB_COORDINATE_LENGTH) {
		const struct rb_pose a = end_of(world, joint->a), b = end_of(world, joint->b);
		struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];

		rb_linkage_rows(&joint->link, &a, &b, row);
		now.angle = rb_vec3_length(rb_vec3_sub(rb_linkage_point_b(&joint->link, &b),
		                                       rb_linkage_point_a(&joint->link, &a)));
		now.speed = rb_linkage_row_velocity(&row[0], &a, &b);
	}
	return now;
}

double rb_world_joint_gap(const struct rb_world *world, int k, double *allowed)
{
	RB_ASSERT(k >= 0 && k < count_of(world));
	const struct rb_joint *const joint = &world->model->joints->joint[k];
	const struct rb_pose a = end_of(world, joint->a), b = end_of(world, joint->b);
	const rb_vec3 p_a = rb_linkage_point_a(&joint->link, &a);
	const rb_vec3 p_b = rb_linkage_point_b(&joint->link, &b);
	double gap = rb_linkage_gap(&joint->link, &a, &b);

	*allowed = rb_joint_allowed(joint->size, p_a, p_b);
	if (world->joint[k].released)
		return 0;
	if (joint->link.type->coordinate == RB_COORDINATE_WAY) {
		const double way = rb_linkage_free(&joint->link, &a, &b).value;

		gap = fmax(gap, fmax(joint->low - way, way - joint->high));
	}
	return gap;
}

void rb_world_joint_set_motor(struct rb_world *world, int k, double speed, double max)
{
	RB_ASSERT(k >= 0 && k < count_of(world) && !(max < 0) && world->joint[k].has_motor);
	struct rb_joint_state *const state = &world->joint[k];

	world->moment++;
	if (!isnan(speed)) {
		state->motor_speed = speed;
		state->motor_angle = (double)NAN;
	}
	if (!isnan(max))
		state->motor_max = max;
	world->joints_changed = true;
}

void rb_world_joint_follow(struct rb_world *world, int k, double angle)
{
	RB_ASSERT(k >= 0 && k < count_of(world) && world->joint[k].has_motor);
	RB_ASSERT(!isnan(angle) || world->model->joints->joint[k].motor_function >= 0);

	world->moment++;
	world->joint[k].motor_speed = (double)NAN;
	world->joint[k].motor_angle = angle;
	world->joints_changed = true;
}

void rb_world_joint_release(struct rb_world *world, int k)
{
	RB_ASSERT(k >= 0 && k < count_of(world));
	world->moment++;
	world->joint[k].released = true;
	world->joint_load[k] = (struct rb_wrench){{0, 0, 0}, {0, 0, 0}};
	world->joints_changed = true;
}
