/* SPDX-License-Identifier: MIT */
/*
 * Springs as rows of islands with joints, or with contacts if the step does not resolve the spring:
 * the effective mass differs from that of free bodies, for which the impulse has a closed form
 * (stepped/force). With x the stretch, T the tension, l the length, u the relative velocity of the
 * ends, at the end of the step:
 *
 *     along the spring   INTERVAL, soft   p = -h (k (x + h u + bend) + c (u + bend / h))
 *     across it, twice   INTERVAL, soft   p = -h (T / l) (h u + bend)
 *
 * The latter only if it is taut and the step does not resolve that either. `bend` is the change of
 * length in the step beyond its rate, since paths of points are curved: its residual is added in
 * another pass over the step, as for joints (stepped/joint_constraints). So the stiffest spring is
 * a rod.
 *
 * In islands that take impulses in halves the first half is that with h / 2 for the time that it
 * acts; the second one, from the resulting poses, looks ahead by h / 2. Both damp what the step
 * does not resolve; static tensions act in both.
 *
 * A spring that is resolved with the effective mass that joints leave keeps its oscillation. In
 * halves its tension is the mean of those at both ends of the step, k (x + (h u + bend) / 2) + c (u
 * + bend / h), and the second half repeats it along the spring's new direction: second order, and
 * reversible. Otherwise it is the tension as the step begins.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_SPRING_ROWS_H
#define RB_STEPPED_SPRING_ROWS_H

#include "constraint/row.h"
#include "math/pose.h"
#include "math/quat.h"
#include "model/element.h"

/* Time within the step at which the tension of its rows is taken. */
enum rb_spring_time { RB_SPRING_AT_END, RB_SPRING_AT_MEAN, RB_SPRING_AT_BEGIN };

/* Of an attempt, in world axes as the step begins; in a second half, after the first. */
struct rb_step_spring {
	int row, number;           /* among springs, and among all elements between bodies */
	int end[2];                /* bodies of the model */
	rb_vec3 arm[2], local[2];  /* m, from the centres of mass; the same in body axes */
	rb_vec3 displacement[2];   /* m: displacement of the centres of mass */
	rb_vec3 along;             /* unit, from the first end to the second */
	double stiffness, damping; /* N/m, N s/m */
	/* N/m: T / l, stiffness of both rows across it; 0: no such rows */
	double across;
	double rest, stretch;     /* m */
	double tension;           /* N, as the step begins */
	bool resolved;            /* the step resolves it even with free bodies */
	enum rb_spring_time time; /* of the attempt; not set if resolved and not joined */
	rb_vec3 bend, missed;     /* m: residual in the last pass */
	/* N s, on the second end: with free bodies, then as last solved */
	rb_vec3 impulse;
	struct rb_wrench on[2]; /* N s, N m s about the centres as the step began: total */
	bool joined;            /* it is solved with its island */
	int first_row;          /* -1: none, the island is at rest */
};

/* Query for rows. */
struct rb_spring_query {
	const struct rb_solver_bodies *bodies;
	int fixed; /* the body for everything static */
	double lasts_s, ahead_s;
	/* m: displacement of the second end relative to the first by impacts within the step */
	rb_vec3 shift;
	bool repeats; /* repeats its present impulse */
};

/*
 * 1/kg: inverse effective mass along it that `held`, bilateral rows (FREE, or INTERVAL without
 * bounds) of joints of its two bodies, leave. Other bodies are assumed free: an upper bound in the
 * island.
 */
double rb_step_spring_inverse_mass(const struct rb_spring_query *query,
                                   const struct rb_step_spring *spring,
                                   const struct rb_constraint *const *held, int count);

/* Number of rows: fixed for the step. */
static inline int rb_step_spring_row_count(const struct rb_step_spring *spring)
{
	return spring->across > 0 ? 3 : 1;
}

/* The end to whose island it belongs. */
static inline int rb_step_spring_owner(const struct rb_step_spring *spring,
                                       const struct rb_solver_bodies *bodies, int fixed)
{
	const int first = spring->end[0];

	return first < fixed && bodies->body[first].inverse_mass > 0 ? first : spring->end[1];
}

/* Fills its rows with its present impulse. */
void rb_step_spring_fill(const struct rb_spring_query *query, const struct rb_step_spring *spring,
                         struct rb_constraint *row);

/* Adds the impulse of its rows, or another one on the second end, to the totals of its ends. */
void rb_step_spring_store(const struct rb_spring_query *query, struct rb_step_spring *spring,
                          const struct rb_constraint *row);
void rb_step_spring_add(struct rb_step_spring *spring, rb_vec3 impulse);

/* m: stretch, and displacement across it if it has rows there, on the way to these poses. */
rb_vec3 rb_step_spring_way(const struct rb_step_spring *spring, const struct rb_pose pose[2]);
/* m: the same for ends with relative velocity u over h_s. */
rb_vec3 rb_step_spring_straight(const struct rb_step_spring *spring, rb_vec3 u, double h_s);

/* For a second half: updates it to these poses, which are displaced by `way`. */
void rb_step_spring_turn(struct rb_step_spring *spring, const struct rb_pose pose[2],
                         const rb_vec3 displacement[2]);

#endif
