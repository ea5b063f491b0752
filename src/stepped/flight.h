/* SPDX-License-Identifier: MIT */
/*
 * Where bodies are within a step, and when they touch: from the velocities that the step before has
 * left, with the forces of this one for what nothing has held, and with what impacts have done
 * meanwhile.
 *
 * Spheres meet where they are; all else is seen along the normals of its points. Scratch of a try.
 */
#ifndef RB_STEPPED_FLIGHT_H
#define RB_STEPPED_FLIGHT_H

#include "stepped/stepped_state.h"

struct rb_flight {
	const struct rb_world
		*world; /* at the beginning of the step, with the velocities that its forces make */
	const unsigned char *held; /* [bodies] a contact had a force on it in the step before */
	double h_s;
	double tolerance; /* m/s: what a solution may leave */
	bool mixed; /* impacts without restitution matter, since they are passed on to others */
};

/*
 * Whether an impact that gives nothing back matters for itself, by what is known of the point as
 * the step begins: a solution lets the gap close by the end, and of an impact in the middle of the
 * step gives one part now, and the other one in the next step. Friction of two parts, each in a
 * cone of its own and against the slip that is left after it, is not that of the whole, by as much
 * as it is itself, however short the step. Without friction each part would be told alone. What
 * forces alone bring about in some steps is no impact, nor what the solution before may have left.
 */
bool rb_flight_splits(const struct rb_flight *flight, const struct rb_step_point *point);

/* Whether it may be an impact in the step: by approach and gap. */
bool rb_flight_could_touch(const struct rb_flight *flight, const struct rb_step_point *point);
/* Marks them among all, and what rims roll to; whether there is one. */
bool rb_flight_find_possible(const struct rb_flight *flight, struct rb_step_points *points,
                             unsigned char *could);

/* A point of a body, and what it does; without the forces of the step: `pull`, m/s^2. */
struct rb_flight_motion {
	rb_vec3 velocity, external, shift;
};

struct rb_flight_motion rb_flight_of(const struct rb_flight *flight, int i, rb_vec3 arm);

/* The velocity at `t` seconds after the beginning. */
static inline rb_vec3 rb_flight_velocity(const struct rb_flight_motion *motion, double t)
{
	return rb_vec3_add_scaled(motion->velocity, t, motion->external);
}

/* How a body turns, as impacts so far have left it, without what forces of the step do. */
struct rb_flight_turning {
	rb_quat orientation;
	rb_vec3 spin; /* rad/s */
};

/* At `t` seconds, as without torque. */
struct rb_flight_turning rb_flight_turning(const struct rb_flight *flight, int i, double t);

/* rad/s: what the forces of the step add in all, where it stands like that. */
rb_vec3 rb_flight_forced_spin(const struct rb_flight *flight, int i, rb_quat orientation);

/*
 * An impact at `t`, where it turns like that, changes its motion. From then on it moves and turns
 * as one that has come with the new velocities: angular momentum and energy are those after it.
 */
void rb_flight_kick(const struct rb_flight *flight, int i, double t,
                    const struct rb_flight_turning *at, const struct rb_solver_body *more);

/* The step goes on from where the body would have come with what impacts have left. */
void rb_flight_turn_from(const struct rb_flight *flight, struct rb_state *state, int i);

/* Two spheres about their centres of mass. */
bool rb_flight_is_plain(const struct rb_flight *flight, const struct rb_step_point *point);

/* m: the gap at `t`, and the normal there. */
double rb_flight_gap(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                     rb_vec3 *normal);

/* m/s: approach along the normal, without the forces of the step. */
double rb_flight_approach(const struct rb_flight *flight, const struct rb_step_point *point,
                          rb_vec3 normal);

/*
 * Whether a point that has just been dealt with at `t` is done with: what the impact has left of
 * its approach is within `noise`, m/s, with the forces that have acted until then, which the
 * impact counts, or without them.
 */
bool rb_flight_is_done(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                       double noise);

/* m/s: what a step makes of the rounding of where a body is and of how large it is. */
double rb_flight_rounding(const struct rb_flight *flight, int i);

/*
 * m/s: slower approaches are no impacts: what the solution before may have left, and what forces
 * make in a step.
 */
double rb_flight_least(const struct rb_flight *flight, const struct rb_step_point *point,
                       rb_vec3 normal);

/* When they next touch with an impact, from `now` on, s; INFINITY: not within the step. */
double rb_flight_touches(const struct rb_flight *flight, const struct rb_step_point *point,
                         double now);

/*
 * The point becomes that at which an impact acts at `t`: its normal is the one there, and between
 * bodies that both yield, where angular momentum is to stay, it is where their arms meet. `arm`
 * becomes the arms there, m; `began`: the point's as the step began.
 */
void rb_flight_turn(const struct rb_flight *flight, struct rb_step_point *point, double t,
                    const rb_vec3 began[2], rb_vec3 arm[2]);

/* m: where that is; of one that nothing has turned, where a's arm has turned to. */
rb_vec3 rb_flight_place(const struct rb_flight *flight, const struct rb_step_point *point,
                        double t);

/*
 * Gap and normal become those under which nothing that flies past is in the way, the approach that
 * of where it is seen; `touched`: the normal is right already.
 */
void rb_flight_see(const struct rb_flight *flight, struct rb_step_point *point, bool touched);

#endif
