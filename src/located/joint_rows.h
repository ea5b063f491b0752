/* SPDX-License-Identifier: MIT */
/*
 * Joints of the bodies that are dealt with together: their rows at these bodies' poses, and what
 * multipliers of them alone do.
 *
 * Rows that are couples are multiplied by the joint's size: all errors are lengths, all multipliers
 * forces, so that redundant joints share what they carry in proportion to forces.
 */
#ifndef RB_LOCATED_JOINT_ROWS_H
#define RB_LOCATED_JOINT_ROWS_H

#include "located/coupled.h"
#include "model/joints.h"
#include "world/joint_state.h"
#include "world/world.h"

/* A row at the poses. */
struct rb_joint_row {
	int joint, row; /* in the model's, of geom/linkage */
	int drive;      /* enum rb_joint_part of one that is held; -1: a joint's own */
	int a, b;       /* places of the ends that yield; -1: it does not */
	struct rb_coupled_wrench wrench;
	double scale;    /* 1, or the joint's size, m, of a couple */
	double error;    /* m */
	double velocity; /* m/s: of the error */
	double bias;     /* m/s^2: with accelerations of ends that do not yield */
	/* of stops: m/s, rounding of the velocity; of impacts */
	double noise, restitution;
	/* of drives: m/s, what it keeps; N s, the most that it gives in an impact */
	double speed, impulse_max;
};

struct rb_joint_rows {
	struct rb_located *l;
	const int *body;            /* by place */
	const struct rb_pose *pose; /* by place */
	int body_count;
	int *joint, joint_count; /* those with an end among the bodies */
	struct rb_joint_row *row;
	int count;     /* 0: none of the bodies has a joint, or none holds */
	bool sprung;   /* one has a spring, a damper, a motor or friction */
	bool touching; /* stops that touch have rows, held or not, as in impacts */
	bool bare;     /* joints have no rows of drives and stops */
};

/* Is the row that of a limit or a rope? It only pushes, away from the stop: multipliers >= 0. */
static inline bool rb_joint_rows_is_stop(const struct rb_joint_row *row)
{
	return row->drive >= RB_STOP_LOW;
}

/* A limit of a free coordinate, or a rope, at the poses. */
struct rb_joint_stop {
	double gap;                /* m or rad, >= 0 apart from rounding */
	double rate;               /* of it, m/s or rad/s */
	double band;               /* rounding of the gap */
	double noise;              /* rounding of the rate */
	struct rb_linkage_row row; /* of the gap: a multiplier >= 0 widens it */
};

/* Has the joint that stop, RB_STOP_LOW or RB_STOP_HIGH (which a rope's length is)? */
static inline bool rb_joint_rows_has_stop(const struct rb_joint *joint, int stop)
{
	if (joint->link.type->one_sided)
		return stop == RB_STOP_HIGH;
	return rb_linkage_has_free(&joint->link) &&
	       isfinite(stop == RB_STOP_LOW ? joint->low : joint->high);
}

struct rb_joint_stop rb_joint_rows_stop(const struct rb_joint_rows *rows, int joint, int stop,
                                        double t);

/* m or rad: by how much the stop is taken to be further off than it is said to be. */
double rb_joint_rows_eased(const struct rb_located *l, int joint, int stop);

/* Motor or friction of a joint as it is now. */
static inline struct rb_joint_drive rb_joint_rows_drive_now(const struct rb_located *l, int joint,
                                                            int kind)
{
	return rb_joint_state_drive(&l->world->joint[joint], &l->model->joints->joint[joint], kind);
}

/* Has it a motor or friction? */
static inline bool rb_joint_rows_has_drive(const struct rb_located *l, int which)
{
	return rb_joint_rows_drive_now(l, which, RB_DRIVE_MOTOR).max > 0 ||
	       rb_joint_rows_drive_now(l, which, RB_DRIVE_FRICTION).max > 0;
}

/* Does the joint of that number hold: was it not released? */
static inline bool rb_joint_rows_holds(const struct rb_located *l, int joint)
{
	return !l->world->joint[joint].released;
}

/* Has the body a joint that holds? */
static inline bool rb_joint_rows_hold(const struct rb_located *l, int body)
{
	const struct rb_joints *joints = l->model->joints;
	bool held = false;

	for (int e = joints ? joints->first[body] : 0;
	     joints && !held && e < joints->first[body + 1]; e++)
		held = rb_joint_rows_holds(l, joints->of[e]);
	return held;
}

/* Poses of a joint's ends: of their places, else on their arcs. */
void rb_joint_rows_ends(const struct rb_joint_rows *rows, int joint, double t,
                        struct rb_pose end[2]);

/* Is there a joint between the two? */
bool rb_joint_rows_joined(const struct rb_located *l, int a, int b);

/*
 * Finds the joints of rows->body, whose places are l->place, and makes room for their rows; false:
 * no memory.
 */
bool rb_joint_rows_collect(struct rb_joint_rows *rows);

/*
 * m/s: what weight makes of what rests in a fall by the joint's size. Rates that are nothing beside
 * it are rounding, however slow all else is.
 */
double rb_joint_rows_fall(const struct rb_located *l, int joint);

/* N: the largest multiplier of a row of a drive; INFINITY of a stop. */
double rb_joint_rows_bound(const struct rb_joint_rows *rows, const struct rb_joint_row *row);

/* Is one of the rows that of a motor, of friction or of a stop? */
bool rb_joint_rows_drive(const struct rb_joint_rows *rows);

/* Has the joint other rows than its own: of a motor, of friction or of a stop that holds? */
bool rb_joint_rows_adds(const struct rb_joint_rows *rows, int joint);

/* Fills the rows at the poses as they are, and at `t` of ends that do not yield. */
void rb_joint_rows_fill(struct rb_joint_rows *rows, double t);

/* Spring and damper of a joint at a moment. */
struct rb_joint_spring_row {
	struct rb_joint_row row;       /* of the free coordinate */
	double multiplier;             /* N, or N m: with motor and friction that are at a bound */
	double dissipation;            /* W, >= 0: of the damper */
	double friction_power, drives; /* W, of friction and motor: >= 0; given */
};

/* Of the k-th joint of rows->joint at the poses; false: it has neither. */
bool rb_joint_rows_spring(const struct rb_joint_rows *rows, int k, double t,
                          struct rb_joint_spring_row *spring);

/* Adds to accelerations, by place, those by springs and dampers of the joints. */
void rb_joint_rows_add_springs(const struct rb_joint_rows *rows, double t, rb_vec3 *linear,
                               rb_vec3 *angular);

/* The row as one of a system of constraints. */
struct rb_coupled_row rb_joint_rows_coupled(const struct rb_joint_row *row);

/*
 * Adds to accelerations, by place, those by the multipliers that leave no acceleration of an error.
 * False: no memory.
 */
bool rb_joint_rows_accelerate(const struct rb_joint_rows *rows, rb_vec3 *linear, rb_vec3 *angular);

/* Joints that motions of bodies are to respect, with their system eliminated once. */
struct rb_joint_hold {
	struct rb_joint_rows rows; /* count 0: there are none */
	struct rb_coupled system;
	struct rb_dense dense; /* right: the last multipliers */
};

/* For the bodies of the set (l->set) at these poses, by place. False: no memory. */
bool rb_joint_hold_take(struct rb_joint_hold *hold, struct rb_located *l,
                        const struct rb_pose *pose, double t, bool bare);

/*
 * Changes motions of the bodies by the least, in the metric of kinetic energy, that makes them
 * respect the joints.
 */
void rb_joint_hold_apply(struct rb_joint_hold *hold, rb_vec3 *linear, rb_vec3 *angular);

/*
 * Puts right what joints have drifted: positions by the smallest motion in the metric of kinetic
 * energy (two rounds), then velocities by impulses, of which the ledger is told. `pose` is
 * rows->pose, of which errors beyond rb_joint_drift_max of the joint's size are a failure
 * (l->status), unless bodies were `moved` by hand.
 */
void rb_joint_rows_correct(struct rb_joint_rows *rows, double t, struct rb_pose *pose, bool moved);

/*
 * The same of poses at which rates are asked for, which may be off by more and of which the ledger
 * is not told. False: l->status.
 */
bool rb_joint_rows_project(struct rb_joint_rows *rows, double t, struct rb_pose *pose);

/* Is there a ring of joints, what does not yield being one of its links? Ropes are none. */
bool rb_joint_rows_is_closed(const struct rb_joint_rows *rows);

/*
 * What joints exert on their b by multipliers, at the joint's point there, [joints]: those of the
 * rows are set, others stay.
 */
void rb_joint_rows_wrenches(const struct rb_joint_rows *rows, const double *multiplier, double t,
                            struct rb_wrench *wrench);

/*
 * What a multiplier (or impulse) of a row does to the momentum of bodies that yield, and what a
 * driven end gives, added to rates (or sums) by cause.
 */
void rb_joint_rows_enter(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                         double multiplier, double t, struct rb_entries *e);

/* W (J by an impulse): what a row of a motor that keeps its speed, or follows, gives. */
double rb_joint_rows_power(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                           double multiplier, double t);

/*
 * The same of springs, dampers, motors and friction, with what dampers and friction take, and
 * motors give; multipliers of the rows are for motors that keep their speeds.
 */
void rb_joint_rows_enter_springs(const struct rb_joint_rows *rows, const double *multiplier,
                                 double t, struct rb_entries *rate);

/* Share of a joint's size by which integration may have let it drift. */
static const double rb_joint_drift_max = 1e-9;
/* The same that a stop is eased by. */
static const double rb_joint_eased = 0.5 * 1e-9;

#endif
