/* SPDX-License-Identifier: MIT */
/*
 * Points and joints of a step -> groups of bodies that they join, and their rows; and back.
 *
 * Bodies, points and rows are gone through in blocks by all workers; groups are numbered by their
 * smallest bodies, their rows stand in the order of points, then of joints. What still stands as it
 * was found gets no rows. Owned by the method's state; arrays are kept from step to step.
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
	int contact_count; /* of these rows, the first ones; joints follow, then springs */
	int spring_count;  /* of these rows, the last ones */
	int first_member, member_count;
	bool rebounds;
	bool carried; /* what does not yield moves under or against it */
	bool rests;   /* still: it has no rows */
	bool kept;    /* as an earlier look at the step has solved it */
	bool sprung;  /* springs have rows in it */
	bool swings;  /* it has been stepped by its joints' freedoms: it has no rows (swing) */
	/* joints, springs with rows and constant forces act: in halves, at both ends */
	bool halves;
	/* s: when the first impact of a mechanism is due within the step; INFINITY: none is */
	double impact_s;
	/* J, twice: what its contacts have taken in the step; more than it no rebound gives back */
	double energy_budget;
	double share;        /* of the rebound, that keeps to it */
	int sweeps, factors; /* of the last solution */
	double residual;     /* m/s */
	/* m/s: about what was left across the normals where friction was held; 0: it was not */
	double slip;
};

/* What impacts within the step have done to a body. */
struct rb_kick {
	rb_vec3 linear, angular; /* m/s, rad/s */
	/* m, rad: where it is besides what its velocities at the end come to; `turn` to the first
	   order */
	rb_vec3 shift, turn;
	/* if `turns`: with what it would have come to turn as it does */
	rb_quat orientation;
	rb_vec3 spin;
	int body;
	bool turns;
};

/* Kicks of a try, in the order in which bodies have first got one; most have none. */
struct rb_kicks {
	/* owned: [bodies + 2] the first is nobody's, and zero; what has never been used takes no
	   memory */
	struct rb_kick *row;
	int *place; /* owned: [bodies + 1] in `row`; 0: none. NULL: nothing rebounds */
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

/* Where a body is after a step without rows (stepped/reduced_islands). */
struct rb_swung {
	/* of the group that it is the first of, in this try: members of one that has been stepped,
	   less than 0: that needs rows; 0: it was not asked about */
	int members;
	rb_vec3 position;
	rb_quat orientation;
	rb_vec3 velocity, spin;
	rb_vec3 place, turning; /* m, rad/s: means of place and spin over the step */
	/* by drag: N s, N m s about the origin; J, what it has taken */
	struct rb_wrench dragged;
	double lost;
};

/*
 * Whether a body of an island moves as a free one: MAYBE where no row of it has an impulse, BLOCKED
 * where the way of a free body would come too near.
 */
enum rb_clear { RB_CLEAR_NO = 0, RB_CLEAR_MAYBE = 1, RB_CLEAR_BLOCKED = 2 };

struct rb_solver;

/* Points of a group. */
struct rb_group_points {
	const struct rb_step_point *row; /* of the step */
	const int *number;               /* [count] in it */
	int count;
};

/*
 * Steps a group without rows, in any worker; false: it does not, and rows are needed. Its points
 * have no impulses yet.
 */
typedef bool rb_swing(struct rb_solver *solver, const struct rb_world *world,
                      struct rb_island *island, const struct rb_group_points *points,
                      struct rb_arena *arena);

struct rb_solver {
	int body_count;
	struct rb_interrupt *interrupt; /* borrowed: the world's; NULL: none */
	const int *
		/* borrowed: bodies of the step, those that yield ascending, then driven ones */
		active;
	int active_count;
	struct rb_row_system
		dense;   /* owned: body [bodies + 1], the last one for all that stands still */
	rb_mat3 *tensor; /* owned; NULL: no body needs one */
	struct rb_solver_body *free;              /* owned */
	int *parent, *island_of, *member, *local; /* owned, [bodies + 1] */
	double *reach;                            /* owned, m: as of the model */
	unsigned char *pushed; /* owned: a point of the last step's has an impulse on it */
	unsigned char *clear;  /* owned: enum rb_clear; set by stepped/attempt */
	unsigned char *rests;  /* owned: 1 where the body stands still */
	unsigned char *asleep; /* owned: 1 where it still stands, since nothing has changed */
	/* owned, m/s: what the last solution has left of the contacts of the body's group */
	double *left;
	/* owned, [6 bodies] m/s^2, rad/s^2: forces of the step that found it so */
	double *rest_external;
	int *point; /* owned, [rows]: its place among the points of the step; -1: of a joint */
	struct rb_step_joint *joint; /* owned, by joint; NULL: the scene has none */
	unsigned char *stiff;        /* owned, [bodies]: 1: turning is stiffened by joints */
	/*
	 * owned, [bodies]: as the step's forces have left it, not stiffened, not halved; once a
	 * step of halves is solved, what it has moved with; NULL: the scene has no joints
	 */
	struct rb_solver_body *given;
	rb_swing *swing;        /* tries to step a group without rows */
	struct rb_swung *swung; /* owned, [bodies]: of groups that swing; NULL: no joints */
	int *joined; /* owned: joints of the bodies of the step, in order of their owners */
	int joined_count;
	/*
	 * owned: those that the step does not resolve, with joints all that may have rows; NULL:
	 * the scene has no springs
	 */
	struct rb_step_spring *spring;
	int spring_count, sprung_count; /* of them that are joined */
	struct rb_island *island;       /* owned */
	size_t island_count, island_capacity, row_capacity, point_capacity;
	const struct rb_state
		*before; /* borrowed: at the beginning of the step; NULL: positions are closed */
	const struct rb_kicks *kicks; /* borrowed; NULL: there have been no impacts */
	const double
		*undragged; /* borrowed, [bodies]: shares of velocities that drag has left; NULL */
	double h_s, tolerance; /* of the step; m/s */
	double whole_s;  /* of the step that was tried first, set by the caller; 0: of this one */
	bool divides;    /* groups for which a step fails take shorter ones on their own */
	double external; /* m^2/s^2: the most that its forces change a velocity by, squared */
	bool bounces;    /* materials of the scene have restitution */
	bool joins_arms; /* angular momentum is to stay: stepped/levers */
	bool mixed;      /* some pairs of them have, others have none */
	bool joints_bounce; /* limits of joints have restitution, or there are ropes */
	bool joints_store;  /* they have springs, whose energy no body has */
	/* the last step before locating goes on: what touches is left without approach */
	bool hands_over;
};

/* Whether it moves as a body without contacts. */
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
 * Whether forces that make such velocities from none in a step of h_s are those under which the
 * body was found at rest, but for the rounding of the step's length. No spin: NULL.
 */
static inline bool rb_rest_holds(const struct rb_solver *solver, int i, const double *linear,
                                 const double *angular, double h_s)
{
	const double *then = solver->rest_external + 6 * (size_t)i;

	return solver->rests[i] && rb_rest_same(linear, then, h_s) &&
	       (!angular || rb_rest_same(angular, then + 3, h_s));
}

/* Takes velocities with the step's forces from the world; `before`, `h_s` and `enough` are set. */
RB_CHECKED enum rb_status rb_islands_make(struct rb_solver *solver, struct rb_world *world,
                                          struct rb_step_points *points, struct rb_error *err);

/* The rows of a group. */
static inline struct rb_row_system rb_islands_rows(const struct rb_solver *solver,
                                                   const struct rb_island *island)
{
	struct rb_row_system rows = solver->dense;

	rows.row += island->first_row;
	rows.row_count = island->row_count;
	return rows;
}

/* The bodies of a point and where it is: a row for its velocity, without masses. */
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

/* m: b's centre of mass from a's where the impulses of the step act; `position`: as it began. */
rb_vec3 rb_islands_between(const struct rb_solver *solver, const double *position, int a, int b);

/*
 * Before rows are placed: which groups go on resting, as the solution would be the same: they get
 * no rows. `group_of`: by point.
 */
void rb_islands_rest(struct rb_solver *solver, const struct rb_step_points *points,
                     const int *group_of, struct rb_arena *arena);

static inline bool rb_islands_has_no_rows(const struct rb_island *island)
{
	return island->rests || island->swings;
}

/* Before rows are placed: steps groups that need none. `group_of`: by point. */
void rb_islands_swing(struct rb_solver *solver, struct rb_world *world,
                      const struct rb_step_points *points, const int *group_of);

/* They need rows in this try after all; until it is gone back, bodies have what has moved them. */
void rb_islands_unswing(struct rb_solver *solver, const struct rb_joints *joints,
                        const struct rb_island *island);

/* After that: groups that take impulses in halves. */
void rb_islands_halve(struct rb_solver *solver, const struct rb_world *world);

/* Whether forces vary within a step that are not those of springs: no group takes halves. */
bool rb_islands_forces_vary(const struct rb_world *world);

/* How a spring of the step under way is asked for its rows. */
struct rb_spring_query rb_islands_springs(const struct rb_solver *solver,
                                          const struct rb_step_spring *spring);

/* How joints of the step under way are asked for their rows. */
struct rb_joint_query rb_islands_joints(const struct rb_solver *solver,
                                        const struct rb_world *world);

/* State of a body for the solver; `free` keeps the velocity without contacts. And back. */
void rb_islands_fill_body(struct rb_solver *solver, const struct rb_world *world, int body);
void rb_islands_store_body(const struct rb_solver *solver, struct rb_world *world, int body);

/* s: what impulses of a group last for. */
static inline double rb_islands_lasts(const struct rb_solver *solver,
                                      const struct rb_island *island)
{
	return island->halves ? 0.5 * solver->h_s : solver->h_s;
}

/* Impulses go to points and joints, velocities to the world. */
void rb_islands_end(struct rb_solver *solver, struct rb_world *world,
                    struct rb_step_points *points);

/*
 * m/s: approaches and rebounds of limits and ropes that are none. Of the step that was tried first:
 * they are solved far better, and in short parts of a step all of them would be below.
 */
double rb_islands_joint_tolerance(const struct rb_solver *solver);

#endif
