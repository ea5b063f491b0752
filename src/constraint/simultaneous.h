/* SPDX-License-Identifier: MIT */
/*
 * Simultaneous contacts, solved together: impacts, and the forces of lasting contacts.
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
 *         |               impulse space by energy (constraint/eccentric; Stronge 1990), with the
 *         |               effective mass of what joints hold (constraint/jointed_impact)
 *     several -----> the cone problem on bodies' velocities (constraint/cone),
 *                    by Newton steps on the faces of cones (constraint/coulomb),
 *                    rounds of compression and restitution until nothing approaches
 *
 * After the maximal number of rounds (512 plus 16 per contact), endless series of impacts with
 * 0 < e < 1 have fallen to 1e-13 of the first approach.
 *
 * The problem is plain data: bodies, and contacts between them. The result does not depend, to the
 * bit, on the order of bodies or contacts, on which body of a contact is called a, or on mirroring
 * in the coordinate planes: sums over the contacts of a body and over all contacts are exact before
 * they are rounded once (constraint/exact_sum), and iterations are simultaneous (no sweep uses its
 * own results). If a linkage has to be eliminated (constraint/joint_factor), this holds only to
 * rounding.
 */
#ifndef RB_CONSTRAINT_SIMULTANEOUS_H
#define RB_CONSTRAINT_SIMULTANEOUS_H

#include <stdbool.h>

#include <rbsim/error.h>

#include "constraint/cone.h"
#include "constraint/contact_row.h"

enum rb_solver_mode { RB_SOLVER_STICK, RB_SOLVER_SLIDE };

/*
 * A contact as input of the laws of impacts and forces; the rows (rb_cone_row) of a round are made
 * from its active contacts.
 */
struct rb_solver_contact {
	int a, b;             /* bodies of the problem */
	rb_vec3 normal;       /* unit, from a to b */
	rb_vec3 arm_a, arm_b; /* m, centres of mass to the contact point */
	double friction, restitution;
	double noise; /* m/s: rounding of the normal velocity; slower contacts do not approach */
	/* impacts only: the bodies as the caller counts them: `a` and `b` may be copies of one */
	int pair[2];

	/* forces only */
	enum rb_solver_mode
		/* stick: has no slip, may begin to; slide: friction opposite to `slip` */
		mode;
	rb_vec3 slip; /* unit, tangential: direction of the velocity of b relative to a */
	/* m/s^2: relative acceleration of the contact points besides linear + angular x arm */
	rb_vec3 bias;

	/* out */
	/* on b: N s (impacts: summed over the rounds) or N (forces; in: a guess, or zero) */
	rb_vec3 impulse;
	double approach; /* impacts: m/s at the first impact of this contact, 0: it had none */
	bool slipping;   /* forces: friction at its limit, and the contact slips or begins to */
};

struct rb_simultaneous {
	struct rb_solver_body *body;
	const rb_mat3 *root; /* by body: roots of inverse inertias; NULL: no body needs one */
	int body_count;
	struct rb_solver_contact *contact;
	int contact_count;
	/*
	 * Joints: FREE and INTERVAL rows, whose velocity plus bias is kept at the target in every
	 * round, without restitution. INTERVAL [0, inf), limits and ropes, are active in rounds
	 * like contacts, and have restitution. Out: base.impulse, for impacts the sum over the
	 * rounds; approach.
	 */
	struct rb_cone_row *joint_row;
	int joint_count;
	struct rb_arena *arena; /* scratch, restored before returning */
	/* out: matrix-vector products, each a pass over all contacts */
	long products;
	double tolerance; /* impacts: speed below which approaches are ignored, m/s; 0: rounding */
	bool blocked; /* out: impacts: no impulses end the approaches; velocities are of no use */
	bool probes;  /* forces: only a solution near the guess, by the whole law, is of use */
	long products_max; /* limit of `products`, beyond which the result is of no use; 0: none */
	/* borrowed, NULL: none; once it is set, the result is of no use */
	struct rb_interrupt *interrupt;
};

static inline struct rb_solver_bodies rb_simultaneous_bodies(const struct rb_simultaneous *problem)
{
	return (struct rb_solver_bodies){.body = problem->body, .root = problem->root};
}

static inline bool rb_simultaneous_is_over(const struct rb_simultaneous *problem)
{
	return (problem->products_max > 0 && problem->products > problem->products_max) ||
	       rb_interrupt_is_set(problem->interrupt);
}

/* Bound of the speed of a point of a body at this arm, in the unit of its velocities. */
static inline double rb_solver_speed_bound(const struct rb_solver_body *body, rb_vec3 arm)
{
	return rb_vec3_length(body->linear) + rb_vec3_length(body->angular) * rb_vec3_length(arm);
}

/* The largest of the speeds whose difference is the contact's velocity. */
static inline double rb_simultaneous_scale(const struct rb_simultaneous *problem,
                                           const struct rb_solver_contact *c)
{
	return fmax(rb_solver_speed_bound(&problem->body[c->a], c->arm_a),
	            rb_solver_speed_bound(&problem->body[c->b], c->arm_b));
}

/* The row of a contact. */
static inline struct rb_cone_row rb_simultaneous_row(const struct rb_solver_contact *c)
{
	return (struct rb_cone_row){
		.base = rb_contact_row(c->a, c->b, c->normal, c->arm_a, c->arm_b, c->friction)};
}

/*
 * Resolves impacts. Generalized reflections (Smith, Kaufman, Vouga, Tamstorf, Grinspun,
 * "Reflections on simultaneous impact", ACM TOG 31(4):106 (2012)) blended with the perfectly
 * inelastic solution for e < 1, in rounds until nothing approaches, with one rule for contacts of
 * different e and for friction. Each round:
 *
 *   1. Active contacts: those that approach, and the touching ones with e = 0. The others are left
 *      out: they react to the shock in the next round, as if there were a gap.
 *   2. Compression: impulses that end all approach at once, with Coulomb friction: the perfectly
 *      inelastic solution (without friction, the smallest change of velocity in the metric of
 *      kinetic energy).
 *   3. Restitution: every normal impulse increases by e times itself, with the contact's own e.
 *      With a common e and no friction the result is (1 - e) times the inelastic solution plus e
 *      times the reflection. With different e it could return more energy than compression took;
 *      then all increments are scaled down by one factor.
 *   4. Friction is solved again, within the cones of the increased impulses; this never adds
 *      energy.
 *
 * Joints are rows of every round, without restitution: u = 0 after compression, after restitution
 * (in which they have the largest e of the round; then their remaining u is removed by the smallest
 * change in the metric of kinetic energy) and after friction. The statements on energy then hold in
 * the space of velocities that the joints allow. Limits and ropes are contacts without friction
 * that may be couples.
 *
 * Hence a touching cradle behaves like one with vanishing gaps, for every e, and e = 0 everywhere
 * takes one round. Endless series of rounds (0 < e < 1: inelastic collapse) are followed to 1e-13
 * of the first approach and end with e = 0. A contact that shares no dynamic body, and no linkage,
 * with another of its round is solved alone; contacts of a body in one point and along one normal,
 * with another one or with bodies that nothing moves and that move alike, are one (facets of a
 * terrain each name a touch of their edge), and have equal parts in its impulse. Where friction
 * jams a body between others so that no solution with the whole friction is found, friction is
 * reduced: see constraint/coulomb.
 *
 * Guarantees: the kinetic energy of dynamic bodies does not increase (in the frame of the others;
 * driven bodies may add to it), friction impulses are within their cones, no contact approaches by
 * more than its noise, linear and angular momentum are conserved to rounding. A single contact
 * follows Newton's law with Coulomb friction (eccentric contacts with friction the energetic law of
 * constraint/impulse). Returns false if the rounds (512 plus 16 per contact) ended before all
 * approaches did and the rest was done with e = 0, or if out of memory; `rounds` may be NULL.
 */
bool rb_simultaneous_impact(struct rb_simultaneous *problem, int *rounds);

#endif
