/* SPDX-License-Identifier: MIT */
/*
 * Joints as constraint rows: made in each step from the poses of bodies, solved with contacts.
 *
 *     part of a joint                     row                              target
 *     three rows of a point               one FREE, midway between both    -(C + bend) / h
 *     every other row of the linkage      INTERVAL (-inf, inf)             -(C + bend) / h
 *     a rope                              INTERVAL (-inf, 0]               -(C + bend) / h
 *     limits of the free coordinate q     INTERVAL [0, inf), (-inf, 0]     (limit - q) / h
 *     motor                               INTERVAL [-h max, h max]         speed; see below
 *     friction                            INTERVAL [-h max, h max]         0
 *     spring and damper                   INTERVAL (-inf, inf), soft       constraint/row
 *
 * C is the error of the row (geom/linkage), all of which is corrected in one step, as gaps are.
 * `bend` is the change of the error in the step beyond its velocity, since paths of points are
 * curved; the directions of a step's impulses are those at its beginning, so that with the right
 * bend this is SHAKE (Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327), which neither
 * damps nor drives oscillations. A bend is predicted to be that of the step before (with impulses
 * in halves, extrapolated linearly from the last two measured ones), and corrected by repeating the
 * step (stepped/relinearize). For a rope at right angles to all that can move, the error is a
 * square, (d + x)^2 / (2 L) with d the offset across: Newton's iteration over these repetitions
 * reaches its double root from one side only, and diverges on the other one. A rope whose error a
 * repetition has increased is not drawn back in that attempt.
 *
 * Islands that need no rows at all: stepped/reduced_islands.
 *
 * SHAKE's velocities are half a step late. An island on which only joints, springs with rows of
 * their own (spring_rows) and constant forces act takes its impulses in two halves, at both ends of
 * the step: RATTLE (Andersen, J. Comput. Phys. 52 (1983) 24), which is of second order and
 * reversible. The first half is the table above with h / 2 for the time of an impulse; the second
 * one, at the poses that result, gives the rows of the linkage the target 0, motors the speed at
 * the end of the step, and repeats the impulses of springs and dampers, which the first half took
 * at the middle of the step. Springs of joints that the step does not resolve act in the first half
 * alone, at the end of the step as in other islands, and motor and friction of these joints with
 * them: halves of theirs at the end would belong to a motion that the spring reverses in each step.
 *
 * A motor that follows a target has the target speed (wanted - q) / h, unless it is further off
 * than it can brake within the step. Then it approaches on a parabola, as in the located method
 * (located/follow.h): with d the distance as the step begins, a the deceleration and f' the mean
 * rate of the target,
 *
 *     q' = f' + sqrt(2 a d) - a h / 2, and at the end of the step f' + sqrt(2 a d) - a h,
 *
 * which repeated gives that parabola to rounding. Until it has to brake, a is half of the
 * deceleration by the full motor, which follows from the change of acceleration by the last change
 * of its force (`answer`); from then on it is that of the parabola.
 *
 * Rows that act on rotation only are couples with the size of the joint as lever: their errors, in
 * m, compare with those of points. A body that is not dynamic is the second of a row, whichever end
 * of the joint it is.
 *
 * Owned by the method's state; rows of different joints may be filled by different threads.
 */
#ifndef RB_STEPPED_JOINT_CONSTRAINTS_H
#define RB_STEPPED_JOINT_CONSTRAINTS_H

#include "constraint/row.h"
#include "model/joints.h"
#include "world/joint_state.h"
#include "world/world.h"

/* Parts of a joint: the rows of its linkage, then these. */
enum {
	RB_JOINT_LOW = RB_LINKAGE_ROWS_MAX,
	RB_JOINT_HIGH,
	RB_JOINT_SPRING, /* precedes motor and friction, which depend on whether it is late */
	RB_JOINT_MOTOR,
	RB_JOINT_FRICTION,
	RB_JOINT_PARTS
};

/* State of a joint from which the next step starts. */
#define RB_JOINT_MEMORY_FIELDS(X)                                                             \
	X(double, force, [RB_JOINT_PARTS], "N, N m", "of each part, on b", RB_FINITE)         \
	X(double, curve, [RB_LINKAGE_ROWS_MAX], "m/s^2, rad/s^2", "bend over h^2", RB_FINITE) \
	X(double, trend, [RB_LINKAGE_ROWS_MAX], "m/s^3, rad/s^3", "its rate", RB_FINITE)      \
	X(double, curve_s, , "s", "step that it is of; 0: not of halves", RB_FINITE)          \
	X(double, way, , "m, rad", "free coordinate, turns counted", RB_FINITE)               \
	X(rb_vec3, reaction, , "N", "on b", RB_FINITE)                                        \
	X(rb_vec3, twist, , "N m", "on b, about its point", RB_FINITE)                        \
	X(double, rate, , "m/s, rad/s", "of the free coordinate as it began", RB_FINITE)      \
	X(double, length_s, , "s", "of it; 0: there was none", RB_FINITE)                     \
	X(double, answer, , "1/kg, 1/(kg m^2)", "of the rate to the motor", RB_FINITE)        \
	X(double, motor, , "N, N m", "what the motor gave in the step before", RB_FINITE)     \
	X(double, acceleration, , "m/s^2, rad/s^2", "what came of that", RB_NUMBER)           \
	X(double, brakes, , "m/s^2, rad/s^2", "with which it comes back", RB_FINITE)
struct rb_joint_memory {
	RB_JOINT_MEMORY_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_joint_memory_fields);

/* For the ledger: work of a joint in an attempt. */
struct rb_joint_work {
	/*
	 * J: of the motor; dissipated by friction; by limits and ropes, and by making velocities
	 * that were set consistent; of spring and damper
	 */
	double motor, friction, impacts, spring;
	/*
	 * J: of bilateral rows, almost zero where the step resolves its motion; N s: sum of
	 * impulses
	 */
	double held, pushed;
	/* on dynamic bodies by one that is not: N s, N m s about the origin; J */
	rb_vec3 linear, angular;
	double driven;
};

/* Data of a joint during steps. */
struct rb_step_joint {
	struct rb_joint_memory last;      /* of the attempt, which begins with `kept` */
	struct rb_joint_memory kept;      /* at the end of the last step that was kept */
	struct rb_joint_memory before;    /* at the beginning of the step that was tried first */
	int noted_before[RB_JOINT_NOTED]; /* of rb_joint_state, then */
	int noted[RB_JOINT_NOTED];        /* of rb_joint_state once the attempt is kept */
	int first_row; /* of the attempt; -1: its island is at rest, or not part of it */
	/* m, rad: target of a following motor at the end of the step; NAN: it does not follow */
	double wanted;
	double wanted_before; /* m, rad: target as the step begins */
	double wanted_rate;   /* m/s, rad/s: rate of the target at the end */
	double motor_bound;   /* N s: bound of the motor's row in the first half */
	/*
	 * m/s, rad/s: rate at the end while it approaches the target on a parabola; NAN: it does
	 * not
	 */
	double end_rate;
	/* its spring is not resolved: motor and friction act in the first half alone */
	bool spring_is_late;
	double bend[RB_LINKAGE_ROWS_MAX]; /* m, rad */
	double miss[RB_LINKAGE_ROWS_MAX]; /* m, rad: errors when they were last measured */
	double left[RB_LINKAGE_ROWS_MAX]; /* m, rad: parts of errors to be left at the end */
	/* m, rad: errors at the end if they grew at the solution's rates at the beginning */
	double straight[RB_LINKAGE_ROWS_MAX];
	bool is_measured; /* `miss` is that of the last solution */
	bool eases;   /* of the attempt: a rope is not drawn back, since that increased its error */
	bool halves;  /* of the attempt: its island has taken impulses in halves */
	bool reduced; /* of the attempt: its island was stepped in reduced coordinates */
	double drift; /* m: largest error; INFINITY: not measured in this attempt */
	double rate;  /* m/s, rad/s: of the free coordinate as the step began; of a rope's length */
	double impulse[RB_JOINT_PARTS]; /* N s, N m s: of the attempt */
	rb_vec3 reaction, twist;        /* N s, N m s, on b, about its point: of the attempt */
	struct rb_joint_work work;      /* of the attempt */
	/* N s, N m s: force and torque impulses accepted so far in the whole step */
	rb_vec3 sum[2];
	double elapsed_s; /* accepted time */
};

/* Number of rows of a joint in every step: fixed by its kind and keys. */
int rb_step_joint_rows_count(const struct rb_joint *joint);

/* Dynamic body of a joint to whose island its rows belong. */
static inline int rb_step_joint_rows_owner(const struct rb_model *model,
                                           const struct rb_joint *joint)
{
	const int a = joint->a;

	return a >= 0 && a < model->body_count && model->inverse_mass[a] > 0 ? a : joint->b;
}

/* Query for rows. */
struct rb_joint_query {
	const struct rb_world *world; /* poses are those of its state */
	/* velocities before the step; NULL: position projection, rows of the linkage only */
	const struct rb_state *before;
	const struct rb_solver_bodies *bodies;
	int fixed; /* the body for everything static */
	double h_s;
	double whole_s; /* of the step that was tried first, if longer; else any smaller value */
	/* s: time over which a force's impulse acts: `h_s`, or half of it */
	double lasts_s;
	bool at_end; /* the second half: `before` is the state after the first one */
	/*
	 * For results: by body, velocities before the impulses (NULL: those of `before`); fraction
	 * of the impulses that was applied.
	 */
	const struct rb_solver_body *from;
	double share;
};

/* Fills the rows of joint k, with warm-start impulses. */
void rb_step_joint_rows_fill(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                             struct rb_constraint *row);

/*
 * Adds the impulses of the rows to the attempt's sums, which start from zero without `from`, unless
 * in a second half. Bodies of joints have no impacts within a step (stepped/impact_pass).
 */
void rb_step_joint_rows_store(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                              const struct rb_constraint *row);

/* Whether no unilateral row of the joint can become active or inactive within the step of h_s. */
bool rb_step_joint_rows_are_smooth(const struct rb_joint_query *query, int k,
                                   const struct rb_step_joint *of);

/* Doubles the results of the first half of a step: at rest, the second one is the same. */
void rb_step_joint_rows_repeat_half(struct rb_step_joint *of);

/*
 * Velocities only, after bodies have moved: sets targets of rows to present velocities, or a
 * rebound; returns whether one rebounds.
 */
bool rb_step_joint_rows_rebound(const struct rb_joint_query *query, int k,
                                const struct rb_step_joint *of, struct rb_constraint *row,
                                double tolerance);

#endif
