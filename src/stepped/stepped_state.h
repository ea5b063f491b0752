/* SPDX-License-Identifier: MIT */
/*
 * State of the stepped method, shared by its modules: the world's (`rb_stepped`), that of the
 * bodies that step together (`rb_cohort`), and the outcome of one attempt of a step.
 *
 * Owned by the world; simulator thread, except for rows that a pass lends to workers.
 */
#ifndef RB_STEPPED_STEPPED_STATE_H
#define RB_STEPPED_STEPPED_STATE_H

#include "math/top.h"
#include "stepped/depth.h"
#include "stepped/impact_queue.h"
#include "stepped/mean_forces.h"
#include "stepped/solve.h"

enum { RB_BODIES_PER_BLOCK = 512 };

/*
 * An impact resolved within the step; crowded: left to the end of the step, because its group is
 * too large.
 */
struct rb_step_impact {
	int a, b;
	bool crowded;
	bool plastic; /* simultaneous impacts converged only without restitution */
	double time_s;
	double approach;                /* m/s */
	double energy;                  /* J, if crowded: energy of the approach */
	double normal_impulse;          /* N s: sum over its points */
	rb_vec3 point, normal, impulse; /* impulse: N s, on b */
};

/* A contact that took part in an impact within the step, for the energy ledger. */
struct rb_ledger_impact {
	int a, b;
	double t_s;             /* after the step's beginning */
	rb_vec3 impulse, arm_a; /* N s, on b; m, from a's centre of mass */
	double along, across;   /* J: dissipated along the normal, across it */
	double driven;          /* J: work done by b, if it is driven */
};

/* Bodies that step together: all, or a group that cannot meet the others within the step. */
struct rb_cohort {
	const int *body; /* borrowed: dynamic bodies ascending, then all driven ones */
	int member_count, body_count;
	struct rb_candidates *candidates; /* borrowed: their candidate pairs, and reaches */
	bool divides; /* failed groups are rolled back alone; else one failure rejects the step */
	/* duration of the gravitation impulse that is given at the beginning of the attempt */
	double gravitation_s;
	struct rb_step_points points; /* of the attempt; `last`: of the step before */
	rb_vec3 *rebound; /* owned, by point: rebound impulse on b, N s; valid if `rebounds` */
	size_t rebound_capacity;
	bool rebounds; /* a point of this attempt may have a rebound */
	/*
	 * owned, by point: impulse on b by which projecting positions changed momenta, N s; valid
	 * if `has_closing_impulses` (stepped/projection_impulses)
	 */
	rb_vec3 *closing_impulse;
	size_t closing_impulse_capacity;
	bool has_closing_impulses;     /* position projection has changed momenta in this attempt */
	struct rb_step_impact *impact; /* owned: impacts of the attempt, in order of time */
	size_t impact_count, impact_capacity;
	struct rb_contacts transmitted; /* contacts that transmitted an impact: N s in place of N */
	/* owned: contacts in impacts of the attempt, if the ledger is kept */
	struct rb_ledger_impact *ledger_impact;
	size_t ledger_impact_count, ledger_impact_capacity;
	/* overlaps at the end of the attempt, if `has_depths`; borrowed from the arena */
	struct rb_depths depths;
	bool has_depths;
};

/* Rebound impulse of a point at the end of the attempt, N s on b. */
static inline rb_vec3 rb_cohort_rebound(const struct rb_cohort *cohort, size_t point)
{
	return cohort->rebounds ? cohort->rebound[point] : (rb_vec3){0, 0, 0};
}

/*
 * Impulse that is reported for a point beside the step's own: rebound and position projection, N s
 * on b.
 */
static inline rb_vec3 rb_cohort_extra_impulse(const struct rb_cohort *cohort, size_t point)
{
	const rb_vec3 rebound = rb_cohort_rebound(cohort, point);

	return cohort->has_closing_impulses ? rb_vec3_add(rebound, cohort->closing_impulse[point])
	                                    : rebound;
}

/* Outcome of an attempt; rb_stepped's `bad` marks the bodies that failed. */
struct rb_attempt_outcome {
	int pair[2];    /* the deepest overlapping pair, -1: none */
	int body;       /* one whose state is not finite, -1: none */
	int joint;      /* the joint of largest inadmissible drift, -1: none */
	bool broken;    /* the solution is none: a failure with RB_ROLLBACK_NONE, too */
	double drift;   /* m: of that joint */
	double overlap; /* m */
	/*
	 * s: time before the first impact of a mechanism, if neither values, residuals, joints,
	 * springs nor nets were wrong; else INFINITY. Bodies that are thrown, and partners in
	 * impacts, may be: they are judged again at the shorter step
	 */
	double clear_s;
	/* m: largest gap violation by the residual of an accepted solution */
	double residual;
	double slip; /* m: largest residual slip at points where friction holds */
};

/* A driven body at the end of the step. */
struct rb_driven_end {
	rb_vec3 position, velocity, spin;
	rb_quat orientation;
};

/* Sleeping bodies (stepped/sleep). */
struct rb_sleep {
	unsigned char *sleeps; /* owned: [bodies] 1: sleeps; a driven one: does not move */
	unsigned char *mark;   /* owned: [bodies] scratch, 0 */
	int *next;             /* owned: [bodies] next body of its sleeping group, in a ring */
	/* owned: [bodies] in the current step: first body of its group at rest, or -1 */
	int *group;
	int *points;     /* owned: [bodies] number of points of the group, at its first body */
	double *pose;    /* owned: [7 bodies] position and orientation when it fell asleep */
	int *body;       /* owned: awake dynamic bodies ascending, then driven ones */
	int live_bodies; /* awake dynamic bodies */
	uint32_t *live;  /* owned: pairs with an awake body */
	size_t live_capacity;
	int count;          /* sleeping bodies */
	size_t point_count; /* their points */
	/* m: largest overlap among them at the end of the last step; NAN: unknown */
	double resting_depth;
	size_t contact_count; /* contacts of the world at the end of the last step */
	double end_s;         /* of the last step */
	bool changed;         /* since the lists were built */
	bool unchanged; /* in the last step no awake body had points and none fell asleep or woke */
	bool off;       /* sleeping is disabled */
};

struct rb_nets;

struct rb_stepped {
	struct rb_candidates candidates;
	struct rb_cohort all, part;
	/* points of the last position projection; its `last` stays empty */
	struct rb_step_points closing;
	struct rb_solver solver;
	struct rb_top_body *top; /* owned; NULL: no body needs one */
	int *body;               /* owned: dynamic bodies, then driven ones */
	int member_count, driven_count;
	struct rb_sleep sleep;
	struct rb_driven_end *driven_end; /* owned, by driven body */
	double *saved_velocity; /* owned: [6 bodies] velocities, saved during position projection */
	/* owned: [3 bodies] m/s by forces that vary within a step; NULL: there are none */
	double *varied;
	/* owned: [bodies] share of a velocity that drag leaves in a step; NULL: no drag */
	double *undragged;
	struct rb_kicks kicks;               /* of the attempt */
	struct rb_nets *nets;                /* of the attempt, in the arena; NULL: none */
	struct rb_impact_queue impact_queue; /* scratch of stepped/impact_pass */
	unsigned char *bad;                  /* owned: [bodies] 1: the attempt failed for it */
	int bad_count;
	struct rb_events reported;        /* impacts of the current step, not sorted yet */
	struct rb_tally *tally;           /* owned; NULL: the ledger is not kept */
	struct rb_local_rollback *local;  /* owned; NULL until a step first fails for some bodies */
	struct rb_mean_forces means;      /* over a step halved for all, if frames keep contacts */
	struct rb_contacts part_contacts; /* scratch of rb_record_part */
};

/* Whether forces move the body: neither static nor driven. */
static inline bool rb_stepped_is_dynamic(const struct rb_world *world, int i)
{
	return i < world->model->body_count && world->model->inverse_mass[i] > 0;
}

/* Whether the impulse of a point acts at a common point of both lever arms: stepped/levers. */
static inline bool rb_stepped_joins_arms(const struct rb_world *world, int b)
{
	return world->stepped->solver.joins_arms && rb_stepped_is_dynamic(world, b);
}

/*
 * Whether memory was out for a pass of this attempt. Some go on without: their results are of other
 * solvers, and no step is to hang on how much memory there is.
 */
static inline bool rb_stepped_lacks_memory(const struct rb_world *world)
{
	bool lacks = false;

	for (int k = 0; k < world->worker_count; k++)
		lacks = lacks || world->arena[k].failed || world->kept[k].failed;
	return lacks;
}

static inline void rb_stepped_blame(struct rb_stepped *s, int i)
{
	s->bad_count += !s->bad[i];
	s->bad[i] = 1;
}

#endif
