/* SPDX-License-Identifier: MIT */
/*
 * Energy balance of position projection: potential energy that it adds, paid by what contacts of
 * the group have dissipated in the step, then by the spin of bodies that have rotated into each
 * other.
 *
 * A point of a rotating body is off its straight path by w x (w x r) h^2 / 2, and projection lifts
 * the body by as much. In reality the point, which moves by w x r h, takes the contact impulse
 * along: it acts at another arm, and its torque slows the rotation by just the energy of the lift.
 * The payment is that torque. It leaves linear momentum alone, so that only contact forces have
 * changed it.
 *
 * Made for one step in its arena; simulator thread.
 */
#ifndef RB_STEPPED_PROJECTION_ENERGY_H
#define RB_STEPPED_PROJECTION_ENERGY_H

#include "stepped/stepped_state.h"

struct rb_projection_energy {
	int *parent; /* [bodies]: groups: the solution's islands, joined by projection */
	int *joined; /* [bodies]: union-find: bodies connected by impulses, joints and projection */
	double *energy_budget; /* [bodies], J, twice: dissipated by contacts, at a group's root */
	double *sunk;          /* [bodies], J: given by earlier steps, at the root of a group */
	double *displacement;  /* [6 bodies]: displacement, m; rotation times inertia, kg m^2 rad */
	double *turn;  /* [3 bodies]: torque impulse by the impulses of projection, kg m^2/s */
	double *swept; /* [3 bodies] kg m^2/s: angular momentum that displacements have added */
	unsigned char *moved;      /* [bodies] */
	unsigned char *has_driven; /* [bodies]: a driven body takes part in the group */
	unsigned char *has_static; /* [bodies]: a static one does */
	double *sum;               /* [6 bodies], J, at the root of a group */
	/* [bodies] kg m/s: change of momenta by rotation of groups and by payment */
	rb_vec3 *momentum_change;
	bool has_momentum_change; /* some momentum has changed */
};

/* To be called before the solver is used for the projection. */
RB_CHECKED enum rb_status rb_projection_energy_begin(struct rb_projection_energy *lift,
                                                     struct rb_world *world,
                                                     const struct rb_step_points *points,
                                                     double h_s, struct rb_error *err);

/* Joins the groups of two bodies of a point or joint; b may be driven or static. */
void rb_projection_energy_join(struct rb_projection_energy *lift, const struct rb_world *world,
                               int a, int b);

/*
 * Adds the torque of the projection's impulses at points that move with their bodies; before bodies
 * move by them.
 */
void rb_projection_energy_turn(struct rb_projection_energy *lift, const struct rb_world *world,
                               const struct rb_step_points *closing);

/* Records that a body moves by the solver's velocity; its saved spin rotates with it. */
void rb_projection_energy_add(struct rb_projection_energy *lift, struct rb_world *world, int i);

/*
 * Pays for the lift. Free groups get their angular momentum back by rotation as a whole, which
 * closes no gap and causes no slip. Then restored velocities pay; groups that cannot are blamed: in
 * shorter steps the lift is less, with the square of the rotation. `may_change_momentum`: where
 * spin does not suffice, motion along the displacements of the projection pays, else, if a static
 * body holds the group, all motion; stepped/projection_impulses reports the change as contact
 * impulses. A body at rest has nothing to pay with: it may rise by as much as it had sunk into the
 * overlap at the beginning of the step, which gave that energy when it was made.
 */
RB_CHECKED enum rb_status rb_projection_energy_pay(struct rb_projection_energy *lift,
                                                   struct rb_world *world, bool may_change_momentum,
                                                   struct rb_error *err);

#endif
