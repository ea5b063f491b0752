/* SPDX-License-Identifier: MIT */
/*
 * What of a joint changes in a run: whether it was released, its motor, the turns of a hinge.
 *
 * Owned by the world, rows by the joint's number; they are part of what decides the future: saved,
 * hashed, and put back where a frame is taken back.
 */
#ifndef RB_WORLD_JOINT_STATE_H
#define RB_WORLD_JOINT_STATE_H

#include <math.h>

#include <rbsim/world.h>

#include "base/field_list.h"
#include "base/pack.h"
#include "model/joints.h"

/* What lasts of a joint and is told when it changes: drives that hold, by kind; a taut rope. */
enum { RB_JOINT_TAUT = RB_JOINT_DRIVES, RB_JOINT_NOTED };

#define RB_JOINT_STATE_FIELDS(X)                                                                  \
	X(double, angle, , "rad, m", "free coordinate, turns counted, at `seen_s`", RB_FINITE)    \
	X(double, speed, , "rad/s, m/s", "of it then", RB_FINITE)                                 \
	X(double, seen_s, , "s", "when it was seen last", RB_FINITE)                              \
	X(double, motor_speed, , "rad/s, m/s", "NAN: the motor follows its function", RB_NUMBER)  \
	X(double, motor_angle, , "rad, m", "that it follows instead; NAN: none", RB_NUMBER)       \
	X(double, motor_max, , "N m, N", "most that it exerts, >= 0", RB_FINITE)                  \
	X(int, noted, [RB_JOINT_NOTED], "",                                                       \
	  "1, 0: what lasts does or does not, as was last told; -1: not known", RB_WITHIN(-1, 1)) \
	X(bool, has_motor, , "", "", RB_FLAG)                                                     \
	X(bool, released, , "", "it holds no more", RB_FLAG)                                      \
	X(bool, was_set, , "",                                                                    \
	  "velocities at it were set, by the scene or a callback, and may not fit it", RB_FLAG)
struct rb_joint_state {
	RB_JOINT_STATE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_joint_state_fields);

/* world->joint, as at the start; NULL without joints. Fails on memory only. */
RB_CHECKED enum rb_status rb_joint_states_create(struct rb_world *world, struct rb_error *err);

/*
 * Takes angles and speeds at the state's poses and time. A hinge is taken to have turned by about
 * the mean of its speeds since it was seen last, so that this may be long ago.
 */
void rb_joint_states_see(struct rb_world *world);

/* Velocities at all joints fit them: what did not has been taken and entered. */
void rb_joint_states_fit(struct rb_world *world);

void rb_joint_states_pack(struct rb_world *world, struct rb_pack *pack);

/* The free coordinate at a moment, turns counted. */
static inline double rb_joint_state_angle(const struct rb_joint_state *state,
                                          const struct rb_linkage *link, double time_s,
                                          const struct rb_linkage_free *free)
{
	const double turned = 0.5 * (state->speed + free->rate) * (time_s - state->seen_s);

	return rb_linkage_turns(link) ? rb_linkage_angle_near(free->value, state->angle + turned)
	                              : free->value;
}

/* The same, and it is what is known of it from then on. */
static inline void rb_joint_state_see(struct rb_joint_state *state, const struct rb_linkage *link,
                                      double time_s, const struct rb_linkage_free *free)
{
	state->angle = rb_joint_state_angle(state, link, time_s, free);
	state->speed = free->rate;
	state->seen_s = time_s;
}

/* Motor or friction as it is now (model/joints). */
static inline struct rb_joint_drive rb_joint_state_drive(const struct rb_joint_state *state,
                                                         const struct rb_joint *joint, int kind)
{
	const struct rb_joint_drive motor = {state->motor_speed,
	                                     state->has_motor ? state->motor_max : 0};

	return rb_joint_drive(joint, motor, kind);
}

/* Has it a motor that follows an angle or way, rather than one that keeps a speed? */
static inline bool rb_joint_state_follows(const struct rb_joint_state *state)
{
	return state->has_motor && isnan(state->motor_speed);
}

/* What its poses tell of a joint, with no force and torque. */
struct rb_joint_reading rb_joint_state_now(const struct rb_world *world, int joint);

/* `hash` itself where there are no joints. */
uint64_t rb_joint_states_hash(const struct rb_world *world, uint64_t hash);

#endif
