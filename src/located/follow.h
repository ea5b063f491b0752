/* SPDX-License-Identifier: MIT */
/*
 * Targets of motors: a function of time, as polynomial pieces (located/driven), or a constant value
 * set by a callback; and the return of a joint to its target.
 *
 * While the motor holds its joint at the target, that is a constraint row whose right side depends
 * on time (rheonomic): q = f(t), q' = f'(t), q'' = f''(t). If that exceeds the motor's bound, it
 * exerts its bound, towards f. The return is a parabola, which the motor follows like f: with
 * e = q - f and its rate e' at the beginning of the return,
 *
 *     q = f + e (1 - s/T)^2,  T = -2 e/e': e = e' = 0 at T, and until then e'' = e'^2/(2 e),
 *
 * and it begins when this deceleration needs the share rb_follow_brake of what the motor's bound
 * leaves beyond the force that keeps e' constant. A later beginning would leave no reserve for
 * loads that change, and full force until e = 0 would overshoot and oscillate. If the deceleration
 * exceeds the bound, the motor brakes with its bound until e' = 0.
 *
 * Owned by l; simulator's thread.
 */
#ifndef RB_LOCATED_FOLLOW_H
#define RB_LOCATED_FOLLOW_H

#include "located/driven.h"
#include "world/joint_state.h"

/* Share of a motor's bound, beyond the load, with which it brakes during a return. */
static const double rb_follow_brake = 0.5;

/* Target of a joint's motor. */
#define RB_FOLLOW_FIELDS(X)                                                               \
	X(double, origin_s, , "s", "beginning of the piece", RB_FINITE)                   \
	X(double, until_s, , "s", "end of the piece", RB_FINITE)                          \
	X(double, back_s, , "s", "beginning of the return; NAN: none", RB_NUMBER)         \
	X(double, back_length_s, , "s", "duration of the return", RB_FINITE)              \
	X(double, back_off, , "rad, m", "error at its beginning", RB_FINITE)              \
	X(double, target, , "rad, m", "value at the last rb_follow_begin; NAN: function", \
	  RB_NUMBER)                                                                      \
	X(struct rb_driven *, own, , "", "owned: of the function; NULL: not called yet",  \
	  RB_BY_HAND)                                                                     \
	X(const struct rb_gauss_piece *, piece, , "", "of `own`", RB_BY_HAND)
struct rb_follow {
	RB_FOLLOW_FIELDS(RB_FIELD_MEMBER)
};

/* Creates l->follow if the scene has motors; false: no memory. */
bool rb_follow_create(struct rb_located *l);
void rb_follow_release(struct rb_located *l);
void rb_follow_pack(struct rb_located *l, struct rb_pack *pack);

/* True if the joint has a motor with a target. */
static inline bool rb_follow_has(const struct rb_located *l, int joint)
{
	return rb_joint_state_follows(&l->world->joint[joint]);
}

/* True if the joint is returning to its target. */
bool rb_follow_is_returning(const struct rb_located *l, int joint);

/* True if the target is a function, or the joint is returning to it. */
bool rb_follow_moves(const struct rb_located *l, int joint);

/* The target at one time. */
struct rb_follow_point {
	double value;        /* rad, m */
	double rate;         /* rad/s, m/s */
	double acceleration; /* rad/s^2, m/s^2 */
	double speed_max;    /* rad/s, m/s: bound over the piece, without the return */
	double noise;        /* rad/s, m/s: rounding of the rate */
};

/*
 * Prepares the target for pieces that begin at `t`: takes the next piece of the function if the
 * last one has ended, and ends a return that is complete. True if the target does not continue
 * smoothly, as at a kink, or because a callback has changed it. A failure sets l->status.
 */
bool rb_follow_begin(struct rb_located *l, int joint, double t);

/* The target at t. `back`: including the return, if there is one. */
struct rb_follow_point rb_follow_at(const struct rb_located *l, int joint, double t, bool back);

/* End of the present piece or return, if that is after `soon`, s; HUGE_VAL: none. */
double rb_follow_end(const struct rb_located *l, int joint, double soon);

/*
 * True if an error shrinks at that rate. Compares signs, since the product of two tiny numbers is
 * 0.
 */
static inline bool rb_follow_converges(double off, double rate)
{
	return (off < 0 && rate > 0) || (off > 0 && rate < 0);
}

/* Begins a return at t from the error `off` with its rate `rate`, of opposite sign. */
void rb_follow_begin_return(struct rb_located *l, int joint, double t, double off, double rate);

/* Ends the return, if there is one. */
void rb_follow_end_return(struct rb_located *l, int joint);

#endif
