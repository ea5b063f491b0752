/* SPDX-License-Identifier: MIT */
/*
 * Which motors, friction and stops of joints hold, as modes of located/joint_rows: decided when a
 * piece begins, by the poses, then by the multipliers of a solution.
 */
#ifndef RB_LOCATED_JOINT_DRIVES_H
#define RB_LOCATED_JOINT_DRIVES_H

#include "located/joint_rows.h"

/*
 * Before that at the start, and where a callback has set velocities: what joints do not allow of
 * these is taken by impulses of the joints alone. Motors and friction, whose forces are bounded,
 * give none, and stops not before they are met.
 */
void rb_joint_drives_fit(struct rb_joint_rows *rows, double t, struct rb_pose *pose);

/*
 * Before the rows are filled at a moment when modes are decided: whether motors and friction keep
 * their speeds, and stops hold, by the poses. `anew`: velocities have jumped, and round by `slack`,
 * m/s.
 */
void rb_joint_drives_begin(const struct rb_joint_rows *rows, double t, bool anew, double slack);

/*
 * After rows were put right at velocities that have jumped (`moved`): impulses of joints may have
 * taken a coordinate past the speed of a drive at its bound, which then pushes the other way.
 */
void rb_joint_drives_turn(struct rb_joint_rows *rows, double t, bool moved);

/* Does a stop of the joint hold? Then what its free coordinate has of a rate is rounding. */
bool rb_joint_drives_stopped(const struct rb_located *l, int joint);

/* rad/s or m/s: rounding of the rate of the joint's free coordinate. */
double rb_joint_drives_noise(const struct rb_joint_rows *rows, int joint, double t);

/*
 * rad/s or m/s: a rate from which the drive alone would come to its speed within rounding of sizes.
 * `impulse`, unless NULL: N s, by which it does.
 */
double rb_joint_drives_soon(const struct rb_located *l, int joint, int kind, double *impulse);

/*
 * As rb_joint_drives_begin after an impact whose rebounds end: true if there are drives that hold
 * though they are off their speed, by less than what they would take back within rounding of sizes.
 */
bool rb_joint_drives_end(const struct rb_joint_rows *rows, double t, double slack);

/* From multipliers of a solution: those at their bounds, and stops that do not push, let go. */
void rb_joint_drives_decide(const struct rb_joint_rows *rows, const double *multiplier, double t);

/* How far the free coordinate of a joint is off what its motor follows (located/follow). */
struct rb_joint_off {
	double value, rate;  /* rad or m, per s */
	double band, noise;  /* rounding of these */
	double reach, speed; /* what they are differences of, for shares */
	double lever;        /* m of a way for a unit of it */
};
struct rb_joint_off rb_joint_drives_off(const struct rb_joint_rows *rows, int joint, double t);

/* Does a motor at a bound, LOW or HIGH, neither push towards what it follows nor brake? */
static inline bool rb_joint_off_ends(const struct rb_joint_off *off, int mode)
{
	return mode * off->value > off->band && mode * off->rate > 0;
}

#endif
