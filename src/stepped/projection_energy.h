/* SPDX-License-Identifier: MIT */
/*
 * What closing overlaps by moving positions raises, and what pays for it: what contacts of the
 * group have taken in the step, then the spin of bodies that have turned into each other.
 *
 * A point of a body that turns is off its straight way by w x (w x r) h^2 / 2, and closing lifts
 * the body by as much. In truth the point, which goes along by w x r h, takes the contact's impulse
 * with it: the impulse acts at another arm, and the torque slows the turning by just what the lift
 * is worth. Payment is that torque. It leaves momentum alone, so the forces of contacts are what
 * has changed it.
 *
 * Made for one step in its arena; simulator thread.
 */
#ifndef RB_STEPPED_PROJECTION_ENERGY_H
#define RB_STEPPED_PROJECTION_ENERGY_H

#include "stepped/stepped_state.h"

struct rb_projection_energy {
	int *parent; /* [bodies]: groups: of the solution, joined by those that are closed */
	int *joined; /* [bodies]: those of them that impulses, joints and closing join */
	double *energy_budget; /* [bodies], J, twice: what contacts took, by the first of a group */
	double *sunk;  /* [bodies], J: that steps before have given, by the first of a group */
	double *way;   /* [6 bodies]: m; kg m^2 rad, as momentum */
	double *turn;  /* [3 bodies]: of the torque, by the impulses of closing, kg m^2/s */
	double *swept; /* [3 bodies] kg m^2/s: angular momentum that moving has made */
	unsigned char *moved; /* [bodies] */
	unsigned char *given; /* [bodies]: a driven body has pushed, by a body of the group */
	unsigned char *held;  /* [bodies]: so has a static one */
	double *sum;          /* [6 bodies], J, by the first of a group */
	rb_vec3 *owed;        /* [bodies] kg m/s: what turning and paying have changed of momenta */
	bool owes;            /* they have */
};

/* Before the solver has become that of closing. */
RB_CHECKED enum rb_status rb_projection_energy_begin(struct rb_projection_energy *lift,
                                                     struct rb_world *world,
                                                     const struct rb_step_points *points,
                                                     double h_s, struct rb_error *err);

/* These bodies are closed together; b may be driven or static. */
void rb_projection_energy_join(struct rb_projection_energy *lift, const struct rb_world *world,
                               int a, int b);

/* What points take along of the impulses that close them; before bodies move by these. */
void rb_projection_energy_turn(struct rb_projection_energy *lift, const struct rb_world *world,
                               const struct rb_step_points *closing);

/* A body moves by what the solver has for it; its spin, put aside, turns with it. */
void rb_projection_energy_add(struct rb_projection_energy *lift, struct rb_world *world, int i);

/*
 * Groups that nothing holds get their angular momentum back by turning as a whole: no gap closes
 * and nothing slips by that. Then velocities, given back, pay; groups that cannot are blamed: in
 * shorter steps turning leaves less to close, with its square. `anyhow`: where spin does not
 * suffice, motion along the ways of closing pays, else, with what stands still below, all motion;
 * stepped/projection_impulses has what contacts say of it. What stands still has nothing to pay
 * with: it may rise by as much as it has sunk into the overlap that the step has found, which gave
 * that energy when it was made.
 */
RB_CHECKED enum rb_status rb_projection_energy_pay(struct rb_projection_energy *lift,
                                                   struct rb_world *world, bool anyhow,
                                                   struct rb_error *err);

#endif
