/* SPDX-License-Identifier: MIT */
/*
 * Motion of bodies within a step, and times of impact: from the velocities at the end of the last
 * step, with the forces of this one on bodies without contact forces, and with the impacts so far.
 *
 * Spheres meet at their actual positions; other contacts are predicted along the normals of their
 * points. Scratch of an attempt.
 */
#ifndef RB_STEPPED_FLIGHT_H
#define RB_STEPPED_FLIGHT_H

#include "stepped/stepped_state.h"

struct rb_flight {
	/* at the beginning of the step, with velocities after its forces */
	const struct rb_world *world;
	const unsigned char *held; /* [bodies] a contact had a force on it in the last step */
	double h_s;
	double tolerance; /* m/s: residual that a solution may have */
	bool mixed; /* resolve impacts without restitution too: others with it may transmit them */
};

/*
 * Whether an impact without restitution must be resolved on its own, by the state of the point at
 * the beginning of the step. The solution lets the gap close by the end: of an impact in the middle
 * of the step it gives one part now and the other in the next step. Friction in two parts, each in
 * its own cone and against the slip that remains after it, differs from that of the whole by as
 * much as it is itself, however short the step. Without friction, each part would be reported
 * alone. What forces alone cause in a few steps is no impact, nor is the residual of the last
 * solution.
 */
bool rb_flight_splits(const struct rb_flight *flight, const struct rb_step_point *point);

/* Whether a point may have an impact in the step, by approach and gap. */
bool rb_flight_could_touch(const struct rb_flight *flight, const struct rb_step_point *point);
/* Marks these points, and those to which rims roll; returns whether there is one. */
bool rb_flight_find_possible(const struct rb_flight *flight, struct rb_step_points *points,
                             unsigned char *could);

/* Motion of a point of a body; `external`: acceleration by the forces of the step, m/s^2. */
struct rb_flight_motion {
	rb_vec3 velocity, external, shift;
};

struct rb_flight_motion rb_flight_of(const struct rb_flight *flight, int i, rb_vec3 arm);

/* Velocity at `t` seconds after the beginning. */
static inline rb_vec3 rb_flight_velocity(const struct rb_flight_motion *motion, double t)
{
	return rb_vec3_add_scaled(motion->velocity, t, motion->external);
}

/* Rotation of a body with the impacts so far, without forces of the step. */
struct rb_flight_turning {
	rb_quat orientation;
	rb_vec3 spin; /* rad/s */
};

/* Torque-free rotation at `t` seconds. */
struct rb_flight_turning rb_flight_turning(const struct rb_flight *flight, int i, double t);

/* Change of spin by all forces of the step at that orientation, rad/s. */
rb_vec3 rb_flight_forced_spin(const struct rb_flight *flight, int i, rb_quat orientation);

/*
 * Applies an impact at `t`, where the body has rotation `at`: from then on it moves and rotates as
 * if it had arrived with the new velocities, with the angular momentum and energy after the impact.
 */
void rb_flight_kick(const struct rb_flight *flight, int i, double t,
                    const struct rb_flight_turning *at, const struct rb_solver_body *more);

/*
 * Sets orientation and spin from which the body would have arrived with its rotation after the
 * impacts.
 */
void rb_flight_turn_from(const struct rb_flight *flight, struct rb_state *state, int i);

/* Whether a point is between two spheres with their centres of mass at their centres. */
bool rb_flight_is_plain(const struct rb_flight *flight, const struct rb_step_point *point);

/* Gap at `t`, m, and its normal. */
double rb_flight_gap(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                     rb_vec3 *normal);

/* Approach speed along the normal without the forces of the step, m/s. */
double rb_flight_approach(const struct rb_flight *flight, const struct rb_step_point *point,
                          rb_vec3 normal);

/*
 * Whether a point of an impact at `t` needs no further one: its remaining approach is within
 * `noise`, m/s, with the forces until then, which the impact counts, or without them.
 */
bool rb_flight_is_done(const struct rb_flight *flight, const struct rb_step_point *point, double t,
                       double noise);

/* Rounding of a body's position and size over the step, m/s. */
double rb_flight_rounding(const struct rb_flight *flight, int i);

/*
 * Smallest approach speed of an impact, m/s: above the residual of the last solution and the effect
 * of forces in a step.
 */
double rb_flight_approach_min(const struct rb_flight *flight, const struct rb_step_point *point,
                              rb_vec3 normal);

/* Time of a point's next impact, from `now` on, s; INFINITY: not within the step. */
double rb_flight_touches(const struct rb_flight *flight, const struct rb_step_point *point,
                         double now);

/*
 * Moves the point to where an impact acts at `t`: its normal is that at `t`, and between two
 * dynamic bodies, where angular momentum is conserved, it is the common point of their arms. `arm`:
 * the arms there, m; `initial_arm`: the point's arms at the beginning of the step.
 */
void rb_flight_move_point(const struct rb_flight *flight, struct rb_step_point *point, double t,
                          const rb_vec3 initial_arm[2], rb_vec3 arm[2]);

/* Position of the impact, m; for a point that was not moved, a's arm is rotated. */
rb_vec3 rb_flight_place(const struct rb_flight *flight, const struct rb_step_point *point,
                        double t);

/*
 * Sets gap, normal and approach for the step's solution, so that bodies that pass each other do not
 * collide; `touched`: the normal is already right.
 */
void rb_flight_update_point(const struct rb_flight *flight, struct rb_step_point *point,
                            bool touched);

#endif
