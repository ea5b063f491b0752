/* SPDX-License-Identifier: MIT */
/*
 * Modes of motors, friction and stops of joints, which determine the rows of located/joint_rows:
 * decided at the beginning of a piece, by the poses, then by the multipliers of a solution.
 */
#ifndef RB_LOCATED_JOINT_DRIVES_H
#define RB_LOCATED_JOINT_DRIVES_H

#include "located/joint_rows.h"

/*
 * Before modes are decided, at the start and after a callback has set velocities: removes the
 * velocities that joints do not allow, by impulses of the joints alone. Motors and friction, whose
 * forces are bounded, give no impulse, nor do stops before they are reached.
 */
void rb_joint_drives_fit(struct rb_joint_rows *rows, double t, struct rb_pose *pose);

/*
 * Decides by the poses whether motors and friction hold their speeds, and stops hold; before the
 * rows are filled. `jumped`: velocities have jumped, with a rounding of `slack`, m/s.
 */
void rb_joint_drives_begin(const struct rb_joint_rows *rows, double t, bool jumped, double slack);

/*
 * After drift correction at velocities that have jumped (`moved`): impulses of joints may have
 * taken a coordinate past the speed of a drive at its bound, whose force then reverses.
 */
void rb_joint_drives_turn(struct rb_joint_rows *rows, double t, bool moved);

/* Does a stop of the joint hold? Then the rate of its free coordinate is rounding. */
bool rb_joint_drives_stopped(const struct rb_located *l, int joint);

/* Rounding of the rate of the joint's free coordinate, rad/s or m/s. */
double rb_joint_drives_noise(const struct rb_joint_rows *rows, int joint, double t);

/*
 * Rate, relative to its speed, from which the drive alone reaches its speed within rounding of
 * sizes, rad/s or m/s. `impulse`, unless NULL: the impulse that this takes, N s.
 */
double rb_joint_drives_soon(const struct rb_located *l, int joint, int kind, double *impulse);

/*
 * Like rb_joint_drives_begin, after an impact whose rebounds end: true if there are drives that
 * hold although they differ from their speed, by less than they would correct within rounding of
 * sizes.
 */
bool rb_joint_drives_end(const struct rb_joint_rows *rows, double t, double slack);

/*
 * Updates modes from the multipliers of a solution: releases drives at their bounds, and stops that
 * do not push.
 */
void rb_joint_drives_decide(const struct rb_joint_rows *rows, const double *multiplier, double t);

/*
 * Deviation of a joint's free coordinate from the motion that its motor follows (located/follow).
 */
struct rb_joint_off {
	double value, rate;  /* rad or m, per s */
	double band, noise;  /* rounding of these */
	double reach, speed; /* sizes of the terms that they are differences of */
	double lever;        /* m per unit of the coordinate */
};
struct rb_joint_off rb_joint_drives_off(const struct rb_joint_rows *rows, int joint, double t);

/* Does a motor at a bound, LOW or HIGH, neither push towards the followed motion nor brake? */
static inline bool rb_joint_off_ends(const struct rb_joint_off *off, int mode)
{
	return mode * off->value > off->band && mode * off->rate > 0;
}

#endif
