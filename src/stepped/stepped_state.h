/* SPDX-License-Identifier: MIT */
/*
 * State of the stepped method, shared by its rooms, and what one try of a step is made of.
 *
 * Owned by the world; simulator thread, but for rows that a pass lends to workers.
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
 * An impact that was resolved within the step; crowded: one of a group that is too large for that.
 */
struct rb_step_impact {
	int a, b;
	bool crowded;
	bool plastic; /* the group's impacts did not settle but without restitution */
	double time_s;
	double approach;                /* m/s */
	double energy;                  /* J: crowded: of the approach */
	double normal_impulse;          /* N s: along the normals, of all its points */
	rb_vec3 point, normal, impulse; /* impulse: N s, on b */
};

/* A contact in an impact within the step, for the ledger. */
struct rb_ledger_impact {
	int a, b;
	double t_s;             /* after the step's beginning */
	rb_vec3 impulse, arm_a; /* N s, on b; m, from a's centre of mass */
	double along, across;   /* J: taken, along the normal and across it */
	double driven;          /* J: given by b, if that is driven */
};

/*
 * Bodies that step together: all of them, or a group that the others cannot meet within the step.
 */
struct rb_cohort {
	const int *body; /* borrowed: those that yield, ascending, then all driven ones */
	int member_count, body_count;
	struct rb_candidates *candidates; /* borrowed: candidates of theirs, reaches */
	bool divides;       /* what fails may be told apart: else one that fails takes all */
	double attracted_s; /* attraction gives its impulse of so long as the try begins */
	struct rb_step_points points; /* of the try; `last` of the step before */
	rb_vec3 *rebound;             /* owned, by point: N s on b; to be read if `rebounds` */
	size_t rebound_capacity;
	bool rebounds; /* something may have, in the try */
	/* owned, by point: N s on b; valid if `owes` (stepped/projection_impulses) */
	rb_vec3 *dues;
	size_t dues_capacity;
	bool owes;                  /* closing has changed linear momenta in the try */
	struct rb_step_impact *hit; /* owned: of the try, in order of time */
	size_t hit_count, hit_capacity;
	struct rb_contacts passed;     /* contacts that have passed impacts on, N s for N */
	struct rb_ledger_impact *blow; /* owned: of the try, where the ledger is kept */
	size_t blow_count, blow_capacity;
	struct rb_depths
		depths; /* where the try has ended, if they are known; borrowed from the arena */
	bool is_measured;
};

/* N s, on b: what a point has given back at the end of the try. */
static inline rb_vec3 rb_cohort_rebound(const struct rb_cohort *cohort, size_t point)
{
	return cohort->rebounds ? cohort->rebound[point] : (rb_vec3){0, 0, 0};
}

/* N s, on b: what a point is told to have done beside its impulse of the step. */
static inline rb_vec3 rb_cohort_more(const struct rb_cohort *cohort, size_t point)
{
	const rb_vec3 rebound = rb_cohort_rebound(cohort, point);

	return cohort->owes ? rb_vec3_add(rebound, cohort->dues[point]) : rebound;
}

/* What has become of a try: rb_stepped's `bad` says for whom. */
struct rb_attempt_outcome {
	int pair[2];    /* that overlaps, -1: none */
	int body;       /* that is not finite, -1: none */
	int joint;      /* that drifts most of those that do by too much, -1: none */
	double drift;   /* m: by how much */
	double overlap; /* m */
	/* s: up to when nothing is met, where that is all that is wrong; INFINITY: it is not */
	double clear_s;
	/* m: the largest that a solution which is good has left of a gap's closing */
	double residual;
	double slip; /* m: the largest that such a one left by holding friction */
};

/* A driven body at the end of the step. */
struct rb_driven_end {
	rb_vec3 position, velocity, spin;
	rb_quat orientation;
};

/* What stands still: stepped/sleep. */
struct rb_sleep {
	unsigned char *
		/* owned: [bodies] 1: nobody looks at it; of a driven one: it stays where it is */
		sleeps;
	unsigned char *mark; /* owned: [bodies] scratch, 0 */
	int *next;           /* owned: [bodies] the next one of its group, in a ring */
	/* owned: [bodies] of the step under way: the first of a group that rests, or -1 */
	int *group;
	int *points;     /* owned: [bodies] of its group, for the first of it */
	double *pose;    /* owned: [7 bodies] where it stands: position, orientation */
	int *body;       /* owned: those that yield and do not stand, ascending, then driven ones */
	int live_bodies; /* of those that yield */
	uint32_t *live;  /* owned: pairs of which one does not stand */
	size_t live_capacity;
	int count;          /* of bodies that stand */
	size_t point_count; /* of theirs */
	/* m: the largest overlap among them at the end of the step before; NAN: not known */
	double resting_depth;
	size_t contact_count; /* of the world's when the step before ended */
	double end_s;         /* of the step before */
	bool changed;         /* since the lists were made */
	bool unchanged;       /* in the step before nobody else had points, and nobody changed */
	bool off;             /* for tests: nothing stands */
};

struct rb_nets;

struct rb_stepped {
	struct rb_candidates candidates;
	struct rb_cohort all, part;
	struct rb_step_points closing; /* of the last projection; its `last` stays empty */
	struct rb_solver solver;
	struct rb_top_body *top; /* owned; NULL: no body needs one */
	int *body;               /* owned: those that yield, then driven ones */
	int member_count, driven_count;
	struct rb_sleep sleep;
	struct rb_driven_end *ride; /* owned, by driven body */
	double *aside;              /* owned: [6 bodies] velocities while positions are moved */
	double *varied; /* owned: [3 bodies] m/s by forces that vary within a step; NULL: none do */
	/* owned: [bodies] what drag leaves of a velocity in the step; NULL: there is none */
	double *undragged;
	struct rb_kicks kicks;      /* of the try */
	struct rb_nets *nets;       /* of the try, in the arena; NULL: none */
	struct rb_impact_queue due; /* scratch of stepped/impact_pass */
	unsigned char *bad;         /* owned: [bodies] 1: the try has failed for it */
	int bad_count;
	struct rb_events reported;       /* impacts of the step under way, not in order yet */
	struct rb_tally *tally;          /* owned; NULL: the ledger is not kept */
	struct rb_local_rollback *local; /* owned; NULL until a step has first failed for some */
	struct rb_mean_forces
		means; /* of a step that is halved for all, where frames keep contacts */
	struct rb_contacts part_contacts; /* scratch of rb_record_part */
};

/* Forces move it: no static, no driven one. */
static inline bool rb_stepped_is_dynamic(const struct rb_world *world, int i)
{
	return i < world->model->body_count && world->model->inverse_mass[i] > 0;
}

/* Whether the impulse of a point on b acts where both arms meet: stepped/levers. */
static inline bool rb_stepped_joins_arms(const struct rb_world *world, int b)
{
	return world->stepped->solver.joins_arms && rb_stepped_is_dynamic(world, b);
}

static inline void rb_stepped_blame(struct rb_stepped *s, int i)
{
	s->bad_count += !s->bad[i];
	s->bad[i] = 1;
}

#endif
