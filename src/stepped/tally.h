/* SPDX-License-Identifier: MIT */
/*
 * What a try has done to each body, noted while it is known, for the ledger: stepped/step_ledger
 * makes entries of it if the step is kept. There only where the ledger is kept (rb_stepped's
 * `tally`), and nothing that is solved reads it.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_TALLY_H
#define RB_STEPPED_TALLY_H

#include "stepped/stepped_state.h"

enum rb_tally_kind {
	RB_TALLY_FREE,   /* it has no points: parabolas */
	RB_TALLY_JOINED, /* solved for: it moves with the velocity of the step's end */
	RB_TALLY_RESTS   /* it stands still: what holds it gives what forces take */
};

/*
 * Of a body, in the last try that it was part of. Velocities of a free one only where forces do
 * work that are not its weight.
 */
struct rb_tally_body {
	enum rb_tally_kind kind;
	rb_vec3 begin[2]; /* m/s, rad/s: as the step began, with the impacts in it */
	rb_vec3 end[2];   /* as solved, before what rebounds */
	rb_vec3 mean[2];  /* of both; of those that impulses in halves act at */
	rb_vec3 acted;    /* m: where impulses of the step act on it */
	bool swings;      /* of a group without rows: means are those of its way */
	bool halves;      /* of a group that takes impulses in halves: at both ends of its way */
	rb_vec3 place;    /* m: where the step has moved it */
	rb_vec3 carry; /* m: where forces vary, free: from where it was to where the others act */
	/* N s, N m s: of forces that vary, without a potential and with one; of drag */
	struct rb_wrench varied, stored;
	double fed; /* J: by potentials of fields that change with time */
	rb_vec3 drag;
	/* of one that swings: N m s about the origin; J, what it has taken */
	rb_vec3 drag_turn;
	double drag_lost;
	/* closing of overlaps, and what pays for it */
	rb_vec3 closed[2]; /* kg m/s, kg m^2/s about the origin */
	double lifted;     /* J: by driven bodies */
	double turned; /* J: taken as its group was turned back after closing, by its first body */
	bool is_closed;
	enum rb_ledger_momentum closed_by; /* RB_MOMENTUM_CAUSES: by other bodies that yield */
};

/* What a force element has done in its last step to the bodies at its ends, N s, N m s. */
struct rb_tally_element {
	struct rb_wrench on[2];
	double damped; /* J: that its damper has taken; NAN: from its rate as the step began */
};

struct rb_tally {
	struct rb_tally_body *body;       /* owned, [bodies] */
	struct rb_tally_element *element; /* owned, those with ends, kind by kind */
	unsigned char *here;              /* owned, [bodies and statics]: scratch, 0 */
};

/* Where the ledger is kept; else it stays NULL. */
RB_CHECKED enum rb_status rb_tally_create(struct rb_stepped *stepped, const struct rb_model *model,
                                          struct rb_error *err);
void rb_tally_release(struct rb_stepped *stepped);

/* Whether forces do work that are not weights. */
bool rb_tally_works(const struct rb_model *model);

/* Before forces that vary are added to these bodies. */
void rb_tally_begin(struct rb_world *world, const struct rb_cohort *cohort);
/* The try is solved and has moved its bodies; nothing has rebound yet. */
void rb_tally_solved(struct rb_world *world, const struct rb_cohort *cohort);

/*
 * Closing moves a body, or what pays for it slows it down: before that, with the velocity and spin
 * that it has, and after it. Again before the same try has ended: nothing.
 */
void rb_tally_close(struct rb_world *world, int i, const rb_vec3 motion[2]);
void rb_tally_closed(struct rb_world *world, int i, enum rb_ledger_momentum by, double lifted_j);

/* I w about the centre of mass, kg m^2/s. */
rb_vec3 rb_tally_spin(const struct rb_world *world, const struct rb_state *state, int i,
                      rb_vec3 spin);

#endif
