/* SPDX-License-Identifier: MIT */
/*
 * What motors follow: a function of time, as polynomial pieces (located/driven), or a constant
 * value that a callback has set; and the way back to it.
 *
 * While the motor keeps its joint there, that is a row of constraint whose right side depends on
 * time (rheonomic): q = f(t), q' = f'(t), q'' = f''(t). Where that needs more than the motor has,
 * it exerts all of it, towards f. The way back is a parabola, which the motor follows like f: with
 * e = q - f and its rate e' at its beginning,
 *
 *     q = f + e (1 - s/T)^2,  T = -2 e/e': e = e' = 0 at T, and until then e'' = e'^2/(2 e),
 *
 * and it begins at the moment when braking like that needs the share rb_follow_brake of what the
 * motor has beside the force that keeps e' as it is. A later one would leave nothing against loads
 * that change, and pushing until e = 0 would not arrive at all, but swing to and fro. What cannot
 * be braked like that is braked with all until e' = 0.
 */
#ifndef RB_LOCATED_FOLLOW_H
#define RB_LOCATED_FOLLOW_H

#include "located/driven.h"
#include "world/joint_state.h"

/* Share of its bound, beside the load, with which a motor begins to brake on its way back. */
static const double rb_follow_brake = 0.5;

/* What is kept of a joint's motor. */
#define RB_FOLLOW_FIELDS(X)                                                                       \
	X(double, origin_s, , "s", "beginning of the piece", RB_FINITE)                           \
	X(double, until_s, , "s", "its end", RB_FINITE)                                           \
	X(double, back_s, , "s", "when the way back began; NAN: there is none", RB_NUMBER)        \
	X(double, back_length_s, , "s", "how long it takes", RB_FINITE)                           \
	X(double, back_off, , "rad, m", "how far it was off then", RB_FINITE)                     \
	X(double, target, , "rad, m", "its value when it was begun; NAN: function", RB_NUMBER)    \
	X(struct rb_driven *, own, , "", "owned: of the function; NULL: never asked", RB_BY_HAND) \
	X(const struct rb_gauss_piece *, piece, , "", "of `own`", RB_BY_HAND)
struct rb_follow {
	RB_FOLLOW_FIELDS(RB_FIELD_MEMBER)
};

/* l->follow, where the scene has motors; false: no memory. */
bool rb_follow_create(struct rb_located *l);
void rb_follow_release(struct rb_located *l);
void rb_follow_pack(struct rb_located *l, struct rb_pack *pack);

/* Has the joint a motor that follows? */
static inline bool rb_follow_has(const struct rb_located *l, int joint)
{
	return rb_joint_state_follows(&l->world->joint[joint]);
}

/* Is it on its way back? */
bool rb_follow_is_back(const struct rb_located *l, int joint);

/* Does it follow what may change, or is it on its way back? */
bool rb_follow_moves(const struct rb_located *l, int joint);

/* A moment of what is followed. */
struct rb_follow_point {
	double value;        /* rad, m */
	double rate;         /* rad/s, m/s */
	double acceleration; /* rad/s^2, m/s^2 */
	double speed_max;    /* rad/s, m/s: a bound over the piece, without the way back */
	double noise;        /* rad/s, m/s: rounding of the rate */
};

/*
 * What is known from `t` on, for pieces that begin then: the next piece of the function where the
 * last one has ended, the end of a way back. True: it does not go on smoothly from what was known
 * until then, as at a kink, or where a callback has changed it. A failure sets l->status.
 */
bool rb_follow_begin(struct rb_located *l, int joint, double t);

/* At a moment of what is known. `back`: on the way back, where there is one. */
struct rb_follow_point rb_follow_at(const struct rb_located *l, int joint, double t, bool back);

/* Until when what is known holds, if that is after `soon`; HUGE_VAL: for ever. */
double rb_follow_end(const struct rb_located *l, int joint, double soon);

/* Does what is off come back at that rate? By their signs: where both are tiny, a product is 0. */
static inline bool rb_follow_comes_back(double off, double rate)
{
	return (off < 0 && rate > 0) || (off > 0 && rate < 0);
}

/* The way back begins at t, from `off` with the rate of it, of the other sign. */
void rb_follow_go_back(struct rb_located *l, int joint, double t, double off, double rate);

/* There is none, or no more. */
void rb_follow_stray(struct rb_located *l, int joint);

#endif
