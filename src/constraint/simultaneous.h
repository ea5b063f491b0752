/* SPDX-License-Identifier: MIT */
/*
 * Several contacts at one moment, solved together: impacts, and the forces of lasting contacts.
 *
 * Equations. With bodies' masses M, rows J of the contacts and impulses p on body b:
 *
 *     v' = v + M^-1 J^T p,  u = J v'
 *     inelastic:     0 <= p_n  perpendicular to  u_n >= 0,  |p_t| <= mu p_n against u_t
 *     restitution:   p_n grows by e p_n, friction is solved again within the grown cones
 *     forces:        the same with accelerations for velocities, forces for impulses
 *
 * Which solver:
 *
 *     one contact ---- central or frictionless? --yes--> closed form
 *         |                   |no
 *         |               impulse space by energy (constraint/eccentric; Stronge 1990)
 *     several -----> the cone problem on bodies' velocities (constraint/cone),
 *                    by Newton steps on the faces of cones (constraint/coulomb),
 *                    rounds of compression and restitution until nothing approaches
 *
 * Counts of rounds (512 and 16 for each contact) are where series of impacts with 0 < e < 1 that do
 * not end have fallen to 1e-13 of the first approach.
 *
 * A small problem in plain data: `bodies` that yield, `contacts` between them. What comes out does
 * not depend on the order of bodies or of contacts, nor on which body of a contact is called a, and
 * mirror images in the coordinate planes come out to the bit: sums over the contacts of a body and
 * over all contacts are exact before they are rounded once (constraint/exact_sum), iterations are
 * simultaneous (no sweep uses what it has just found). Only where a linkage has to be eliminated
 * (constraint/joint_factor) do they come out to rounding.
 */
#ifndef RB_CONSTRAINT_SIMULTANEOUS_H
#define RB_CONSTRAINT_SIMULTANEOUS_H

#include <stdbool.h>

#include <rbsim/error.h>

#include "constraint/cone.h"

enum rb_solver_mode { RB_SOLVER_STICK, RB_SOLVER_SLIDE };

/*
 * A contact as the law of impacts and of forces takes it; its rows (rb_cone_row) are made from it
 * in each round, of those contacts alone that the round has.
 */
struct rb_solver_contact {
	int a, b;             /* bodies of the problem */
	rb_vec3 normal;       /* unit, from a to b */
	rb_vec3 arm_a, arm_b; /* m, centres of mass to the contact point */
	double friction, restitution;
	double noise; /* m/s: rounding of the normal velocity; below it nothing approaches */

	/* forces only */
	enum rb_solver_mode
		/* stick: may stay without slip or begin to slip; slide: friction against `slip` */
		mode;
	rb_vec3 slip; /* unit, across the normal: direction of the velocity of b relative to a */
	/* m/s^2: relative acceleration of the contact points that is not linear + angular x arm */
	rb_vec3 bias;

	/* out */
	/* on b: N s (impacts: summed over the rounds) or N (forces; in: a guess, or zero) */
	rb_vec3 impulse;
	double approach; /* impacts: m/s at the first impact of this contact, 0: it had none */
	bool slipping;   /* forces: friction at its limit, and the contact slips or begins to */
};

struct rb_simultaneous {
	struct rb_solver_body *body;
	const rb_mat3 *root; /* by body: of inverse inertias; NULL: no body needs one */
	int body_count;
	struct rb_solver_contact *contact;
	int contact_count;
	/*
	 * Joints: FREE and INTERVAL rows, whose velocity (and bias, of forces and of impacts) is
	 * held at the target in every round, without restitution; INTERVAL [0, inf), limits and
	 * ropes, are in rounds as contacts are, and have restitution. Out: base.impulse, of
	 * impacts the sum over the rounds; approach.
	 */
	struct rb_cone_row *joint_row;
	int joint_count;
	struct rb_arena *arena; /* scratch, given back */
	/* out: of vectors with the problem's matrix, each once through all contacts */
	long products;
	double tolerance;  /* m/s: impacts: what is not to be resolved; 0: only rounding is not */
	bool probes;       /* forces: of use is only a solution near the guess, by the whole law */
	long products_max; /* of them, beyond which what is found is of no use; 0: no limit */
	/* borrowed, NULL: none; once it is set, what is found is of no use */
	struct rb_interrupt *interrupt;
};

static inline struct rb_solver_bodies rb_simultaneous_bodies(const struct rb_simultaneous *joint)
{
	return (struct rb_solver_bodies){.body = joint->body, .root = joint->root};
}

static inline bool rb_simultaneous_is_over(const struct rb_simultaneous *joint)
{
	return (joint->products_max > 0 && joint->products > joint->products_max) ||
	       rb_interrupt_is_set(joint->interrupt);
}

/*
 * Impacts. Generalized reflections (Smith, Kaufman, Vouga, Tamstorf, Grinspun, "Reflections on
 * simultaneous impact", ACM TOG 31(4):106 (2012)) blended with the perfectly inelastic solution for
 * e < 1, in rounds until nothing approaches, with one rule for contacts of different e and for
 * friction. Of each round:
 *
 *   1. It has the contacts that approach, and with them the touching ones of e = 0. Others are not
 *      felt: what a shock does to them is seen in the next round, as if there were a gap.
 *   2. Compression: the impulses that end all approach, at once, with Coulomb friction: the
 *      perfectly inelastic solution (the smallest change of velocity in the metric of kinetic
 *      energy, where there is no friction).
 *   3. Restitution: every normal impulse grows by e times what it is, each contact by its own e.
 *      With one e for all and no friction that is (1 - e) times the inelastic solution and e times
 *      the reflection. With different e it could give back more energy than compression took; then
 *      all these additions shrink by one factor.
 *   4. Friction is solved again, within the cones of the grown impulses; that takes energy or
 *      leaves it.
 *
 * Joints are rows of every round, without restitution: u = 0 after compression, after restitution
 * (for which they get the largest e of the round, then what is left of their u is taken away, the
 * smallest change in the metric of kinetic energy) and after friction. All that is said of energy
 * then holds in the space of velocities that they allow; a contact on a jointed body is never
 * solved alone. Limits and ropes are contacts without friction that may be couples.
 *
 * So a touching cradle does what one with vanishing gaps does, for every e, and e = 0 everywhere is
 * one round. Series of rounds that do not end (0 < e < 1: inelastic collapse) are followed to 1e-13
 * of the first approach, then e = 0. A contact that shares no yielding body with another of its
 * round is solved alone. Where friction jams a body between others so that no solution with the
 * whole of it is found, it gets less: see constraint/cone.
 *
 * Afterwards: kinetic energy of what yields is not above before (in the frame of bodies that do not
 * yield; a driven body may add to it), friction impulses are within their cones, no contact
 * approaches by more than its noise, linear and angular momentum are what they were to rounding.
 * One contact alone is Newton's law with Coulomb friction (for eccentric contacts with friction the
 * energetic law of constraint/impulse). Returns false when the rounds (512 and 16 per contact)
 * ended without settling and the rest was done with e = 0, or when memory is out; `*rounds` may be
 * NULL.
 */
bool rb_simultaneous_impact(struct rb_simultaneous *joint, int *rounds);

/*
 * Forces of lasting contacts and joints, whose impulses are guesses: relative normal acceleration
 * >= 0, force >= 0, one of them zero; a sticking contact has no relative tangential acceleration
 * unless its friction is at the cone (then against that acceleration); a sliding one has friction *
 * force against its slip. Bodies' accelerations become those with the forces. Unique accelerations
 * come out to about 1e-13 of the largest acceleration in the problem, also where forces are not
 * unique (touching lattices). Returns the largest violation that is left, m/s^2; INFINITY when
 * memory is out. Where no solution with the whole friction is found (jammed bodies, mostly friction
 * near 1 and above), what slips gets less.
 */
double rb_simultaneous_forces(struct rb_simultaneous *joint);

#endif
