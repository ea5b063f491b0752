/* SPDX-License-Identifier: MIT */
/*
 * Contact points and joints of a step -> islands (connected groups of bodies) and their rows; and
 * the results back.
 *
 * Bodies, points and rows are processed in blocks by all workers. Islands are numbered by their
 * smallest bodies; their rows are in the order of points, then of joints, then of springs. An
 * island that is still at rest as it was found gets no rows. Owned by the method's state; arrays
 * are kept from step to step.
 */
#ifndef RB_STEPPED_ISLANDS_H
#define RB_STEPPED_ISLANDS_H

#include "base/interrupt.h"
#include "constraint/row.h"
#include "stepped/contact_points.h"
#include "stepped/joint_constraints.h"
#include "stepped/levers.h"
#include "stepped/spring_rows.h"

#include <float.h>

struct rb_island {
	int first_row, row_count;
	int contact_count; /* the first of these rows; joints follow, then springs */
	int spring_count;  /* the last of these rows */
	int first_member, member_count;
	bool rebounds;
	bool is_driven;   /* a body or motor that is not dynamic moves at it */
	bool rests;       /* at rest: it has no rows */
	bool kept;        /* keeps the solution of an earlier pass over the step */
	bool has_springs; /* some of its rows are springs */
	bool reduced;     /* stepped in reduced coordinates: it has no rows (reduced_islands) */
	/*
	 * only joints, springs with rows and constant forces act: impulses in two halves, at both
	 * ends of the step (RATTLE)
	 */
	bool halves;
	/* s: time of the first impact of a mechanism within the step; INFINITY: none */
	double impact_s;
	/*
	 * J: twice the energy that its contacts have dissipated in the step; bounds what a rebound
	 * gives back
	 */
	double energy_budget;
	double share;        /* fraction of the rebound that respects that bound */
	int sweeps, factors; /* of the last solution */
	double residual;     /* m/s */
	/* m/s: approximate tangential residual where friction was held fixed; 0: it was not */
	double slip;
};

/* Effect of impacts within the step on a body. */
struct rb_kick {
	rb_vec3 linear, angular; /* m/s, rad/s */
	/*
	 * m, rad: displacement in addition to that by its velocities at the end; `turn` to first
	 * order
	 */
	rb_vec3 shift, turn;
	/*
	 * if `turns`: orientation and spin as the step began that would have led to its present
	 * rotation
	 */
	rb_quat orientation;
	rb_vec3 spin;
	int body;
	bool turns;
};

/* Kicks of an attempt, in the order in which bodies first got one; most bodies have none. */
struct rb_kicks {
	/*
	 * owned: [bodies + 2]; the first belongs to no body, and is zero; what has never been used
	 * takes no memory
	 */
	struct rb_kick *row;
	int *place; /* owned: [bodies + 1] index in `row`, 0: none. NULL: nothing rebounds */
	int count;
};

static inline const struct rb_kick *rb_kick_of(const struct rb_kicks *kicks, int i)
{
	return &kicks->row[kicks->place[i]];
}

static inline bool rb_kicks_have(const struct rb_kicks *kicks, int i)
{
	return kicks && kicks->count > 0 && kicks->place[i] > 0;
}

/* Motion of a body in a step without rows (stepped/reduced_islands). */
struct rb_reduced_motion {
	/*
	 * at the first body of an island, in this attempt: members if it has been stepped so, minus
	 * that if it needs rows, 0 if it was not tried
	 */
	int members;
	rb_vec3 position;
	rb_quat orientation;
	rb_vec3 velocity, spin;
	rb_vec3 place, turning; /* m, rad/s: means of position and spin over the step */
	/* of drag: N s, N m s about the origin; J, energy dissipated */
	struct rb_wrench dragged;
	double lost;
};

/*
 * Whether a body of an island moves as a free one: MAYBE if no row of it has an impulse, BLOCKED if
 * the path of a free body would come too near.
 */
enum rb_clear { RB_CLEAR_NO = 0, RB_CLEAR_MAYBE = 1, RB_CLEAR_BLOCKED = 2 };

struct rb_solver;

/* Contact points of an island. */
struct rb_group_points {
	const struct rb_step_point *row; /* all of the step */
	const int *number;               /* [count]: indices into `row` */
	int count;
};

/*
 * Steps an island in reduced coordinates, on any worker; false: not possible, rows are needed. Its
 * points have no impulses yet.
 */
typedef bool rb_reduced_stepper(struct rb_solver *solver, const struct rb_world *world,
                                struct rb_island *island, const struct rb_group_points *points,
                                struct rb_arena *arena);

struct rb_solver {
	int body_count;
	struct rb_interrupt *interrupt; /* borrowed: the world's; NULL: none */
	const int *
		/* borrowed: bodies of the step, ascending: dynamic ones, then driven ones */
		active;
	int active_count;
	struct rb_row_system
		dense;   /* owned: body [bodies + 1], the last one for everything static */
	rb_mat3 *tensor; /* owned; NULL: no body needs one */
	struct rb_solver_body *free;              /* owned */
	int *parent, *island_of, *member, *local; /* owned, [bodies + 1] */
	double *reach;                            /* owned, m: as in the model */
	unsigned char *loaded; /* owned: a contact of the last step has an impulse on the body */
	unsigned char *clear;  /* owned: enum rb_clear; set by stepped/attempt */
	unsigned char *rests;  /* owned: 1 if the body is at rest */
	unsigned char *asleep; /* owned: 1 if it stays at rest because nothing has changed */
	/* owned, m/s: contact residual of the last solution of the body's island */
	double *residual;
	/*
	 * owned, [6 bodies] m/s^2, rad/s^2: accelerations by external forces in the step that found
	 * it at rest
	 */
	double *rest_external;
	/* owned, [rows]: index of its contact point in the step; -1: a joint or spring */
	int *point;
	struct rb_step_joint *joint; /* owned, by joint; NULL: the scene has none */
	/* owned, [bodies]: 1: rotational inertia has geometric stiffness of joints */
	unsigned char *stiff;
	/*
	 * owned, [bodies]: velocities after the step's forces, without stiffening and halving; once
	 * a step in halves is solved, the velocities that it has moved with; NULL: the scene has no
	 * joints
	 */
	struct rb_solver_body *after_forces;
	rb_reduced_stepper *step_reduced; /* tries to step an island in reduced coordinates */
	/* owned, [bodies]: of islands stepped in reduced coordinates; NULL: no joints */
	struct rb_reduced_motion *reduced_motion;
	int *active_joint; /* owned: joints of the bodies of the step, in order of their owners */
	int active_joint_count;
	/*
	 * owned: springs that the step does not resolve, with joints all that may have rows; NULL:
	 * the scene has no springs
	 */
	struct rb_step_spring *spring;
	int spring_count, sprung_count; /* the latter: of those that are joined */
	struct rb_island *island;       /* owned */
	size_t island_count, island_capacity, row_capacity, point_capacity;
	const struct rb_state
		*before; /* borrowed: at the beginning of the step; NULL: position projection */
	const struct rb_kicks *kicks; /* borrowed; NULL: no impacts so far */
	const double
		/* borrowed, [bodies]: fractions of velocities that drag has left; NULL: no drag */
		*undragged;
	double h_s, tolerance; /* of the step; m/s */
	double whole_s;     /* of the step that was tried first, set by the caller; 0: this one */
	bool divides;       /* islands for which a step fails take shorter ones on their own */
	double external;    /* m^2/s^2: largest change of velocity by its forces, squared */
	bool bounces;       /* some pairs of materials have restitution */
	bool joins_arms;    /* angular momentum is conserved: stepped/levers */
	bool mixed;         /* some pairs have restitution, others have none */
	bool joints_bounce; /* limits of joints have restitution, or there are ropes */
	bool joints_store;  /* joints have springs, which store energy */
	/* there are joints, and pairs with friction: constraint/jointed_impact */
	bool joined_friction;
	/*
	 * the last step before the located method continues: touching contacts end without approach
	 * velocity
	 */
	bool hands_over;
};

/* Whether a body moves as one without contacts. */
static inline bool rb_solver_is_free(const struct rb_solver *solver, int i)
{
	return solver->island_of[i] < 0 || solver->clear[i] == RB_CLEAR_MAYBE;
}

static inline bool rb_rest_same(const double *now, const double *then, double h)
{
	const double each = 1 / h, x = fabs(then[0]), y = fabs(then[1]), z = fabs(then[2]);
	const double xy = x > y ? x : y, max = 16 * DBL_EPSILON * (xy > z ? xy : z);

	return fabs(each * now[0] - then[0]) <= max && fabs(each * now[1] - then[1]) <= max &&
	       fabs(each * now[2] - then[2]) <= max;
}

/*
 * Whether forces that change velocities by these in a step of h_s from rest are those under which
 * the body was found at rest, up to rounding of the step's length. No spin: NULL.
 */
static inline bool rb_rest_holds(const struct rb_solver *solver, int i, const double *linear,
                                 const double *angular, double h_s)
{
	const double *then = solver->rest_external + 6 * (size_t)i;

	return solver->rests[i] && rb_rest_same(linear, then, h_s) &&
	       (!angular || rb_rest_same(angular, then + 3, h_s));
}

/*
 * Takes velocities after the step's forces from the world; `before`, `h_s` and `tolerance` are set.
 */
RB_CHECKED enum rb_status rb_islands_make(struct rb_solver *solver, struct rb_world *world,
                                          struct rb_step_points *points, struct rb_error *err);

/* Rows of an island. */
static inline struct rb_row_system rb_islands_rows(const struct rb_solver *solver,
                                                   const struct rb_island *island)
{
	struct rb_row_system rows = solver->dense;

	rows.row += island->first_row;
	rows.row_count = island->row_count;
	return rows;
}

/* Row with a contact point's bodies and arms, for its velocity; without masses. */
static inline struct rb_constraint rb_islands_row_of(const struct rb_solver *solver,
                                                     const struct rb_step_point *point)
{
	return (struct rb_constraint){
		.a = point->a,
		.b = point->b < solver->body_count ? point->b : solver->body_count,
		.central = point->central,
		.normal = point->normal,
		.arm_a = point->arm_a,
		.arm_b = point->arm_b,
	};
}

/*
 * m: from a's centre of mass to b's where the impulses of the step act; `position`: at its
 * beginning.
 */
rb_vec3 rb_islands_between(const struct rb_solver *solver, const double *position, int a, int b);

/*
 * Before rows are placed: marks islands that stay at rest, as the solution would be the same: they
 * get no rows. `group_of`: by point.
 */
void rb_islands_rest(struct rb_solver *solver, const struct rb_step_points *points,
                     const int *group_of, struct rb_arena *arena);

static inline bool rb_islands_has_no_rows(const struct rb_island *island)
{
	return island->rests || island->reduced;
}

/*
 * Before rows are placed: steps in reduced coordinates the islands that allow it. `group_of`: by
 * point.
 */
void rb_islands_step_reduced(struct rb_solver *solver, struct rb_world *world,
                             const struct rb_step_points *points, const int *group_of);

/*
 * Makes an island use rows in this attempt after all; until the step is restored, its bodies keep
 * the velocities that have moved them.
 */
void rb_islands_revert_reduced(struct rb_solver *solver, const struct rb_joints *joints,
                               const struct rb_island *island);

/* After that: marks islands that take impulses in halves. */
void rb_islands_halve(struct rb_solver *solver, const struct rb_world *world);

/* Whether forces other than springs vary within a step: no island takes impulses in halves then. */
bool rb_islands_forces_vary(const struct rb_world *world);

/* Query for the rows of a spring in the current step. */
struct rb_spring_query rb_islands_springs(const struct rb_solver *solver,
                                          const struct rb_step_spring *spring);

/* Query for the rows of joints in the current step. */
struct rb_joint_query rb_islands_joints(const struct rb_solver *solver,
                                        const struct rb_world *world);

/*
 * Copies the state of a body to the solver, and to `free`, the velocity without contacts; and back.
 */
void rb_islands_fill_body(struct rb_solver *solver, const struct rb_world *world, int body);
void rb_islands_store_body(const struct rb_solver *solver, struct rb_world *world, int body);

/* s: time over which impulses of an island act. */
static inline double rb_islands_impulse_time(const struct rb_solver *solver,
                                             const struct rb_island *island)
{
	return island->halves ? 0.5 * solver->h_s : solver->h_s;
}

/* Stores impulses in points and joints, velocities in the world. */
void rb_islands_end(struct rb_solver *solver, struct rb_world *world,
                    struct rb_step_points *points);

/*
 * m/s: slower approaches and rebounds of limits and ropes are ignored. For the step that was tried
 * first: limits are solved far more accurately, and in short parts of a step all speeds would be
 * below it.
 */
double rb_islands_joint_tolerance(const struct rb_solver *solver);

#endif
