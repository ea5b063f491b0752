/* SPDX-License-Identifier: MIT */
/*
 * Per-body record of an attempt for the ledger: stepped/step_ledger makes entries of it if the step
 * is kept. Exists only where the ledger is kept (rb_stepped's `tally`); no solver reads it.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_TALLY_H
#define RB_STEPPED_TALLY_H

#include "stepped/stepped_state.h"

enum rb_tally_kind {
	RB_TALLY_FREE,   /* no contact impulses: parabolas */
	RB_TALLY_JOINED, /* solved: it moves with the velocity of the step's end */
	RB_TALLY_RESTS   /* at rest: its holder balances all forces */
};

/*
 * A body's record of its last attempt. Velocities of a free one only where forces other than weight
 * do work.
 */
struct rb_tally_body {
	enum rb_tally_kind kind;
	rb_vec3 begin[2]; /* m/s, rad/s: at the beginning of the step, after its impacts */
	rb_vec3 end[2];   /* as solved, before the rebound */
	rb_vec3 mean[2];  /* of both; with impulses in halves, that at which these act */
	rb_vec3 acted;    /* m: position at which impulses of the step act */
	bool swings;      /* of a group in reduced coordinates: means over its path */
	bool halves;      /* of a group that takes impulses in halves, at both ends of its path */
	rb_vec3 place;    /* m: position at the end of the step */
	rb_vec3 carry; /* m: free, with varying forces: displacement at which constant ones act */
	/* N s, N m s: varying forces without a potential, and with one; drag */
	struct rb_wrench varied, stored;
	double potential_change; /* J: by potentials that change with time */
	rb_vec3 drag;
	/* for a body in reduced coordinates: N m s about the origin; J, dissipated by drag */
	rb_vec3 drag_turn;
	double drag_lost;
	/* position projection, and payment for its energy */
	rb_vec3 closed[2]; /* kg m/s, kg m^2/s about the origin */
	double lifted;     /* J: work of driven bodies */
	double turned;     /* J: taken by restoring angular momentum, at its group's root */
	bool is_closed;
	enum rb_ledger_momentum closed_by; /* RB_MOMENTUM_CAUSES: by other dynamic bodies */
};

/* Impulses of a force element in its last step on the bodies at its ends, N s, N m s. */
struct rb_tally_element {
	struct rb_wrench on[2];
	double damped; /* J: dissipated by its damper; NAN: to be computed from its initial rate */
};

struct rb_tally {
	struct rb_tally_body *body;       /* owned, [bodies] */
	struct rb_tally_element *element; /* owned, elements with two ends, kind by kind */
	unsigned char *here;              /* owned, [bodies and statics]: scratch, 0 */
};

/* Creates the tally if the ledger is kept; else it stays NULL. */
RB_CHECKED enum rb_status rb_tally_create(struct rb_stepped *stepped, const struct rb_model *model,
                                          struct rb_error *err);
void rb_tally_release(struct rb_stepped *stepped);

/* Whether forces other than weights do work. */
bool rb_tally_works(const struct rb_model *model);

/* To be called before varying forces are added to these bodies. */
void rb_tally_begin(struct rb_world *world, const struct rb_cohort *cohort);
/* To be called after the attempt is solved and its bodies have moved, before the rebound. */
void rb_tally_solved(struct rb_world *world, const struct rb_cohort *cohort);

/*
 * Position projection of a body, or its payment: `begin` before, with its velocity and spin, once
 * per attempt (further calls do nothing); `end` after.
 */
void rb_tally_projection_begin(struct rb_world *world, int i, const rb_vec3 motion[2]);
void rb_tally_projection_end(struct rb_world *world, int i, enum rb_ledger_momentum by,
                             double lifted_j);

/* I w about the centre of mass, kg m^2/s. */
rb_vec3 rb_tally_spin(const struct rb_world *world, const struct rb_state *state, int i,
                      rb_vec3 spin);

#endif
