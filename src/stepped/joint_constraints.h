/* SPDX-License-Identifier: MIT */
/*
 * Joints as rows of constraint: made in each step from where bodies stand, solved with contacts.
 *
 *     part of a joint                     row                              target
 *     three rows of a point               one FREE, at the middle of both  -(C + bend) / h
 *     every other row of the linkage      INTERVAL (-inf, inf)             -(C + bend) / h
 *     a rope                              INTERVAL (-inf, 0]               -(C + bend) / h
 *     limits of the free coordinate q     INTERVAL [0, inf), (-inf, 0]     (limit - q) / h
 *     motor                               INTERVAL [-h most, h most]       speed; see below
 *     friction                            INTERVAL [-h most, h most]       0
 *     spring and damper                   INTERVAL (-inf, inf), soft       constraint/row
 *
 * C is the error of the row (geom/linkage), all of which is taken back in one step, as gaps are.
 * `bend` is by how much it gets larger in the step than its velocity says, since ways of points are
 * bent; the directions of a step's impulses are those of its beginning, so that with the right bend
 * this is SHAKE (Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327), which neither
 * damps nor drives what swings. A bend is foreseen to be that of the step before (where impulses
 * come in halves, on a straight line through the last two, as they were measured), and found by
 * looking at the step again (stepped/relinearize). Of a rope at right angles to all that moves the
 * error is a square, (d + x)^2 / (2 L) with d what it is off across: steps of these looks reach its
 * root, which is double, from one side alone, and grow without end on the other one. A rope that a
 * look has found farther off than the look before is not drawn back in that try.
 *
 * Groups that need no rows at all: stepped/reduced_islands.
 *
 * SHAKE's velocities are half a step late. A group that nothing but joints, springs with rows of
 * their own (spring_rows) and constant forces acts on takes its impulses in two halves, at both
 * ends of the step: RATTLE (Andersen, J. Comput. Phys. 52 (1983) 24), which is of second order and
 * reversible. The first half is the table above with h / 2 for the time of an impulse; the second
 * one, at the poses that it has led to, gives the rows of the linkage the target 0, motors the
 * speed at the end of the step, and repeats what springs and dampers, taken at the middle of the
 * step, gave in the first. Springs of joints that the step does not resolve act in the first half
 * alone, at the end of the step as in other groups, and motor and friction of these joints with
 * them: halves of theirs at the end would be of a motion that the spring takes back in each step.
 *
 * A motor that follows is asked for (wanted - q) / h, but where it is further off than it can brake
 * within the step. There it is asked to come back on a parabola, as located (located/follow.h):
 * with d what it is off as the step begins, a the deceleration and f' the mean rate of what it
 * follows,
 *
 *     q' = f' + sqrt(2 a d) - a h / 2, and at the end of the step f' + sqrt(2 a d) - a h,
 *
 * which repeated is that parabola to rounding. Until it has to brake, a is half of what all of the
 * motor against its motion would give, which follows from how the last change of its force has
 * changed the acceleration (`answer`); from then on it is what the parabola has.
 *
 * Rows that only turn are couples with the size of the joint as lever: their errors, in m, compare
 * with those of points. A body that is not dynamic is the second of a row, whatever it is of the
 * joint.
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
	RB_JOINT_SPRING, /* the others depend on whether it is late */
	RB_JOINT_MOTOR,
	RB_JOINT_FRICTION,
	RB_JOINT_PARTS
};

/* What of a joint the next step starts from. */
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

/* For the ledger: what a joint has done in a try. */
struct rb_joint_work {
	/*
	 * J: by the motor; taken by friction; taken by limits and ropes, and of velocities that
	 * were set so that they do not fit; by spring and damper
	 */
	double motor, friction, impacts, spring;
	/* J: by what holds it, next to nothing where the step resolves its motion; N s: impulses */
	double held, pushed;
	/* on what is dynamic, by a body that is not: N s, N m s about the origin; J */
	rb_vec3 linear, angular;
	double driven;
};

/* A joint while it is stepped. */
struct rb_step_joint {
	struct rb_joint_memory last;      /* as the step under way began */
	struct rb_joint_memory before;    /* as the step that was tried first began */
	int noted_before[RB_JOINT_NOTED]; /* as of rb_joint_state, then */
	int first_row; /* of the try; -1: its group rests, or is not asked about */
	/* m, rad: where a motor that follows is to be at the end of the step; NAN: it does not */
	double wanted;
	double wanted_before; /* m, rad: where it is to be as the step begins */
	double wanted_rate;   /* m/s, rad/s: how fast it is to be at the end */
	double motor_bound;   /* N s: bound of the motor's row in the first half */
	double end_rate;      /* m/s, rad/s: the same where it is on its way back; NAN: it is not */
	bool spring_is_late;  /* its spring is not resolved: the first half has all of the drives */
	double bend[RB_LINKAGE_ROWS_MAX]; /* m, rad */
	double miss[RB_LINKAGE_ROWS_MAX]; /* m, rad: errors when they were last measured */
	double left[RB_LINKAGE_ROWS_MAX]; /* m, rad: of errors, what is to be left at the end */
	/* m, rad: errors at the end, if they grew as fast as the solution says at the beginning */
	double straight[RB_LINKAGE_ROWS_MAX];
	bool is_measured; /* `miss` is that of the last solution */
	bool eases;   /* of the try: a rope that is not drawn back, since that led farther off */
	bool halves;  /* of the try: its group has taken impulses in halves */
	bool swings;  /* of the try: its group has no rows (swing) */
	double drift; /* m: the largest of these; INFINITY: not measured in this try */
	double rate;  /* m/s, rad/s: of the free coordinate as the step began; of a rope's length */
	double impulse[RB_JOINT_PARTS]; /* N s, N m s: of the try */
	rb_vec3 reaction, twist;        /* N s, N m s, on b, about its point: of the try */
	struct rb_joint_work work;      /* of the try */
	rb_vec3 sum[2];   /* N s, N m s: pull and twist of what is kept of the whole step */
	double elapsed_s; /* of it */
};

/* How many rows a joint has in every step: fixed by its kind and keys. */
int rb_step_joint_rows_count(const struct rb_joint *joint);

/* A body that forces move: its rows are those of this one's group. */
static inline int rb_step_joint_rows_owner(const struct rb_model *model,
                                           const struct rb_joint *joint)
{
	const int a = joint->a;

	return a >= 0 && a < model->body_count && model->inverse_mass[a] > 0 ? a : joint->b;
}

/* How rows are asked for. */
struct rb_joint_query {
	const struct rb_world *world; /* poses are of its state */
	/* velocities before the step; NULL: positions are moved, nothing but rows of the linkage */
	const struct rb_state *before;
	const struct rb_solver_bodies *bodies;
	int fixed; /* the body for all that stands still */
	double h_s;
	double whole_s; /* of the step that was tried first, if that was longer; or less */
	/* s: of forces, what an impulse lasts for: `h_s`, or half of it */
	double lasts_s;
	bool at_end; /* the second half: `before` is the state that the first one has led to */
	/*
	 * What has come of it: by body, velocities that impulses began from (NULL: those of
	 * `before`); and of the impulses the share that has been given.
	 */
	const struct rb_solver_body *from;
	double share;
};

/* Fills the rows of joint k, with impulses to begin with. */
void rb_step_joint_rows_fill(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                             struct rb_constraint *row);

/*
 * Adds what the rows have come to to the try's sums; without `from`, but in a second half, these
 * begin with it. Bodies of joints are never kicked within a step (stepped/impact_pass).
 */
void rb_step_joint_rows_store(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                              const struct rb_constraint *row);

/* Whether nothing of the joint but what holds on may push one way within the step of h_s. */
bool rb_step_joint_rows_are_smooth(const struct rb_joint_query *query, int k,
                                   const struct rb_step_joint *of);

/* What it has done in the first half of a step it does in the second half too: it rests. */
void rb_step_joint_rows_double(struct rb_step_joint *of);

/* Velocities only, after bodies have moved: rows keep what they have, or rebound. */
bool rb_step_joint_rows_rebound(const struct rb_joint_query *query, int k,
                                const struct rb_step_joint *of, struct rb_constraint *row,
                                double tolerance);

#endif
