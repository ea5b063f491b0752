/* SPDX-License-Identifier: MIT */
/*
 * Joints of bodies that are solved together: their rows at the bodies' poses, and solutions for
 * joints alone.
 *
 * Couples are multiplied by the joint's size: all errors are lengths and all multipliers forces, so
 * that redundant joints share their load in proportion to forces.
 */
#ifndef RB_LOCATED_JOINT_ROWS_H
#define RB_LOCATED_JOINT_ROWS_H

#include "located/coupled.h"
#include "model/joints.h"
#include "world/joint_state.h"
#include "world/world.h"

/* A row at the poses. */
struct rb_joint_row {
	int joint, row; /* joint of the model; row of geom/linkage */
	int drive;      /* enum rb_joint_part of a held drive or stop; -1: a joint's own row */
	int a, b;       /* places of the ends; -1: not among the dynamic bodies */
	struct rb_coupled_wrench wrench;
	double scale;    /* 1; for a couple the joint's size, m */
	double error;    /* m */
	double velocity; /* m/s: rate of the error */
	double bias;     /* m/s^2: includes accelerations of ends that are not dynamic */
	/* stops: rounding of the velocity, m/s; restitution of impacts */
	double noise, restitution;
	/* drives: target speed, m/s; largest impulse in an impact, N s */
	double speed, impulse_max;
};

struct rb_joint_rows {
	struct rb_located *l;
	const int *body;            /* by place */
	const struct rb_pose *pose; /* by place */
	int body_count;
	int *joint, joint_count; /* joints with an end among the bodies */
	struct rb_joint_row *row;
	int count;     /* 0: no body has a joint that holds */
	bool sprung;   /* one has a spring, a damper, a motor or friction */
	bool touching; /* stops that touch have rows, held or not, for impacts */
	bool bare;     /* no rows of drives and stops */
};

/* Is it the row of a limit or a rope? It only pushes, away from the stop: multipliers >= 0. */
static inline bool rb_joint_rows_is_stop(const struct rb_joint_row *row)
{
	return row->drive >= RB_STOP_LOW;
}

/* A limit of a free coordinate, or a rope, at the poses. */
struct rb_joint_stop {
	double gap;                /* m or rad, >= 0 to rounding */
	double rate;               /* of the gap, m/s or rad/s */
	double band;               /* rounding of the gap */
	double noise;              /* rounding of the rate */
	struct rb_linkage_row row; /* of the gap: a positive multiplier widens it */
};

/* Does the joint have that stop, RB_STOP_LOW or RB_STOP_HIGH (a rope's length is the latter)? */
static inline bool rb_joint_rows_has_stop(const struct rb_joint *joint, int stop)
{
	if (joint->link.type->one_sided)
		return stop == RB_STOP_HIGH;
	return rb_linkage_has_free(&joint->link) &&
	       isfinite(stop == RB_STOP_LOW ? joint->low : joint->high);
}

struct rb_joint_stop rb_joint_rows_stop(const struct rb_joint_rows *rows, int joint, int stop,
                                        double t);

/* Distance by which a stop is moved away, m or rad. */
double rb_joint_rows_eased(const struct rb_located *l, int joint, int stop);

/* Motor or friction of a joint at present. */
static inline struct rb_joint_drive rb_joint_rows_drive_now(const struct rb_located *l, int joint,
                                                            int kind)
{
	return rb_joint_state_drive(&l->world->joint[joint], &l->model->joints->joint[joint], kind);
}

/* Does the joint have a motor or friction? */
static inline bool rb_joint_rows_has_drive(const struct rb_located *l, int joint)
{
	return rb_joint_rows_drive_now(l, joint, RB_DRIVE_MOTOR).max > 0 ||
	       rb_joint_rows_drive_now(l, joint, RB_DRIVE_FRICTION).max > 0;
}

/* Does the joint hold, that is, was it not released? */
static inline bool rb_joint_rows_holds(const struct rb_located *l, int joint)
{
	return !l->world->joint[joint].released;
}

/* Does the body have a joint that holds? */
static inline bool rb_joint_rows_hold(const struct rb_located *l, int body)
{
	const struct rb_joints *joints = l->model->joints;
	bool held = false;

	for (int e = joints ? joints->first[body] : 0;
	     joints && !held && e < joints->first[body + 1]; e++)
		held = rb_joint_rows_holds(l, joints->of[e]);
	return held;
}

/* Poses of a joint's ends: rows->pose at their places, otherwise on their arcs. */
void rb_joint_rows_ends(const struct rb_joint_rows *rows, int joint, double t,
                        struct rb_pose end[2]);

/* Does a joint connect the two bodies? */
bool rb_joint_rows_joined(const struct rb_located *l, int a, int b);

/*
 * Finds the joints of rows->body, whose places are l->place, and takes arrays for their rows;
 * false: out of memory.
 */
bool rb_joint_rows_collect(struct rb_joint_rows *rows);

/*
 * Speed of a fall by the joint's size, m/s: rates below its rounding are rounding, however slow
 * everything else is.
 */
double rb_joint_rows_fall(const struct rb_located *l, int joint);

/* Largest multiplier of a drive's row, N; INFINITY for a stop. */
double rb_joint_rows_bound(const struct rb_joint_rows *rows, const struct rb_joint_row *row);

/* Is one of the rows that of a motor, friction or stop? */
bool rb_joint_rows_drive(const struct rb_joint_rows *rows);

/* Does the joint have more than its own rows: those of a motor, friction or a stop that holds? */
bool rb_joint_rows_adds(const struct rb_joint_rows *rows, int joint);

/* Fills the rows at the present poses; ends that are not dynamic are taken at `t`. */
void rb_joint_rows_fill(struct rb_joint_rows *rows, double t);

/* Spring and damper of a joint at a moment. */
struct rb_joint_spring_row {
	struct rb_joint_row row;       /* of the free coordinate */
	double multiplier;             /* N, or N m: includes motor and friction at their bounds */
	double dissipation;            /* W, >= 0: by the damper */
	double friction_power, drives; /* W: taken by friction, >= 0; supplied by the motor */
};

/* Finds those of the k-th joint of rows->joint at the poses; false: there are none. */
bool rb_joint_rows_spring(const struct rb_joint_rows *rows, int k, double t,
                          struct rb_joint_spring_row *spring);

/* Adds the accelerations by springs and dampers of the joints, by place. */
void rb_joint_rows_add_springs(const struct rb_joint_rows *rows, double t, rb_vec3 *linear,
                               rb_vec3 *angular);

/* Returns the row as one of a coupled system. */
struct rb_coupled_row rb_joint_rows_coupled(const struct rb_joint_row *row);

/*
 * Adds the accelerations, by place, by the multipliers that make the errors' accelerations zero.
 * False: out of memory.
 */
bool rb_joint_rows_accelerate(const struct rb_joint_rows *rows, rb_vec3 *linear, rb_vec3 *angular);

/* Joints that motions of bodies must respect, with their system eliminated once. */
struct rb_joint_hold {
	struct rb_joint_rows rows; /* count 0: no joints */
	struct rb_coupled system;
	struct rb_dense dense; /* right side: the last multipliers */
};

/*
 * Prepares the joints of the set's bodies (l->set) at these poses, by place. False: out of memory.
 */
bool rb_joint_hold_take(struct rb_joint_hold *hold, struct rb_located *l,
                        const struct rb_pose *pose, double t, bool bare);

/*
 * Makes motions of the bodies respect the joints, by the smallest change in the metric of kinetic
 * energy.
 */
void rb_joint_hold_apply(struct rb_joint_hold *hold, rb_vec3 *linear, rb_vec3 *angular);

/*
 * Corrects the drift of joints: positions by the smallest motion in the metric of kinetic energy
 * (two rounds), then velocities by impulses, which enter the ledger. `pose` is rows->pose; errors
 * of these beyond rb_joint_drift_max of the joint's size are a failure (l->status), unless bodies
 * were `moved` by hand.
 */
void rb_joint_rows_correct(struct rb_joint_rows *rows, double t, struct rb_pose *pose, bool moved);

/*
 * The same for poses at which rates are evaluated, which may have larger errors and do not affect
 * the ledger. False: see l->status.
 */
bool rb_joint_rows_project(struct rb_joint_rows *rows, double t, struct rb_pose *pose);

/* Do the joints form a loop, with all non-dynamic bodies as one link? Ropes do not count. */
bool rb_joint_rows_is_closed(const struct rb_joint_rows *rows);

/*
 * Computes the wrenches of joints on their body b, by multipliers, at the joint's point there,
 * [joints]: sets those of the rows' joints, and leaves the others.
 */
void rb_joint_rows_wrenches(const struct rb_joint_rows *rows, const double *multiplier, double t,
                            struct rb_wrench *wrench);

/*
 * Adds, by cause, the momentum that a multiplier (or impulse) of a row gives to dynamic bodies, and
 * the energy from a driven end, to rates (or sums).
 */
void rb_joint_rows_enter(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                         double multiplier, double t, struct rb_entries *e);

/*
 * Power (energy, by an impulse) that a motor's row supplies when it holds its speed or follows, W
 * (J).
 */
double rb_joint_rows_power(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                           double multiplier, double t);

/*
 * The same for springs, dampers, motors and friction, with the dissipation of dampers and friction
 * and the power of motors; multipliers of the rows are for motors that hold their speeds.
 */
void rb_joint_rows_enter_springs(const struct rb_joint_rows *rows, const double *multiplier,
                                 double t, struct rb_entries *rate);

/* Drift by integration that is allowed, relative to a joint's size. */
static const double rb_joint_drift_max = 1e-9;
/* Distance by which a stop is eased, relative to the size. */
static const double rb_joint_eased = 0.5 * 1e-9;

#endif
