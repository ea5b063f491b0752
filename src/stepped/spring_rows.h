/* SPDX-License-Identifier: MIT */
/*
 * Springs as rows of the groups of bodies that joints hold, or contacts if the step does not
 * resolve the spring: these yield otherwise than free bodies, for which an impulse has a closed
 * form (stepped/force). With x the stretch, T the tension, l the length, u what the ends part with,
 * at the end of the step:
 *
 *     along the spring   INTERVAL, soft   p = -h (k (x + h u + bend) + c (u + bend / h))
 *     across it, twice   INTERVAL, soft   p = -h (T / l) (h u + bend)
 *
 * The latter only where it is taut and the step does not resolve that either. `bend` is by how much
 * it gets longer in the step than its rate says, since ways of points are bent: what is found to be
 * left of it is added in another look at the step, as of joints (stepped/joint_constraints). So the
 * stiffest spring is a rod.
 *
 * In groups that take impulses in halves the first half is that with h / 2 for the time that it
 * acts; the second one, from the poses that this has led to, looks ahead by h / 2. Both damp what
 * the step does not resolve; what holds still against other forces does so in both.
 *
 * What is resolved, as joints let bodies yield, keeps its oscillation. In halves its tension is the
 * mean of those at both ends of the step, k (x + (h u + bend) / 2) + c (u + bend / h), and the
 * second half repeats it along the spring as it is then: second order, and reversible. Elsewhere it
 * is the tension as the step begins.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_SPRING_ROWS_H
#define RB_STEPPED_SPRING_ROWS_H

#include "constraint/row.h"
#include "math/pose.h"
#include "math/quat.h"
#include "model/element.h"

/* When the tension is taken of which its rows are. */
enum rb_spring_time { RB_SPRING_AT_END, RB_SPRING_AT_MEAN, RB_SPRING_AT_BEGIN };

/* Of a try, in world axes as the step begins; in a second half as it has led to. */
struct rb_step_spring {
	int row, number;           /* among springs, and among all elements between bodies */
	int end[2];                /* bodies of the model */
	rb_vec3 arm[2], local[2];  /* m, from the centres of mass; the same in body axes */
	rb_vec3 way[2];            /* m: that the centres of mass have gone */
	rb_vec3 along;             /* unit, from the first end to the second */
	double stiffness, damping; /* N/m, N s/m */
	double across;             /* N/m: T / l, of both rows across it; 0: it has none */
	double rest, stretch;      /* m */
	double tension;            /* N, as the step begins */
	bool resolved;             /* even if its bodies were free */
	enum rb_spring_time time;  /* of the try; of resolved ones that are not joined: not set */
	rb_vec3 bend, missed;      /* m: missed in the last look */
	/* N s, on the second end: as if bodies were free, then as solved last */
	rb_vec3 impulse;
	struct rb_wrench on[2]; /* N s, N m s about the centres as the step began: all of it */
	bool joined;            /* it is solved with its group */
	int first_row;          /* -1: it has none, the group rests */
};

/* How rows are asked for. */
struct rb_spring_query {
	const struct rb_solver_bodies *bodies;
	int fixed; /* the body for all that stands still */
	double lasts_s, ahead_s;
	rb_vec3 shift; /* m: of the second end from the first one, by impacts within the step */
	bool repeats;  /* the impulse that it has is given again */
};

/*
 * 1/kg: how its ends yield along it, of what rows that hold (FREE, or INTERVAL without bounds), of
 * joints of its two bodies, leave. Others are taken to be free: a bound of how they yield in the
 * group.
 */
double rb_step_spring_gives(const struct rb_spring_query *query,
                            const struct rb_step_spring *spring,
                            const struct rb_constraint *const *held, int count);

/* How many rows it has: fixed for the step. */
static inline int rb_step_spring_row_count(const struct rb_step_spring *spring)
{
	return spring->across > 0 ? 3 : 1;
}

/* The end whose group it belongs to. */
static inline int rb_step_spring_owner(const struct rb_step_spring *spring,
                                       const struct rb_solver_bodies *bodies, int fixed)
{
	const int first = spring->end[0];

	return first < fixed && bodies->body[first].inverse_mass > 0 ? first : spring->end[1];
}

/* Fills its rows with the impulse that it has. */
void rb_step_spring_fill(const struct rb_spring_query *query, const struct rb_step_spring *spring,
                         struct rb_constraint *row);

/* Adds what rows have come to, or another impulse on the second end, to all that ends get. */
void rb_step_spring_store(const struct rb_spring_query *query, struct rb_step_spring *spring,
                          const struct rb_constraint *row);
void rb_step_spring_add(struct rb_step_spring *spring, rb_vec3 impulse);

/* m: how it stretches, and turns where it has rows across it, on the way to these poses. */
rb_vec3 rb_step_spring_way(const struct rb_step_spring *spring, const struct rb_pose pose[2]);
/* m: the same of ends that part with u for h_s. */
rb_vec3 rb_step_spring_straight(const struct rb_step_spring *spring, rb_vec3 u, double h_s);

/* For a second half: it stands as these poses have it, which have gone these ways. */
void rb_step_spring_turn(struct rb_step_spring *spring, const struct rb_pose pose[2],
                         const rb_vec3 way[2]);

#endif
