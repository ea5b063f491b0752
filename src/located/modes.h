/* SPDX-License-Identifier: MIT */
/*
 * Forces of a cluster's contacts, each in its mode: sticking, slipping along a direction, or
 * creeping (rb_event_set_creep). The forces come from an elimination; if that is too large, from
 * the solver of constraint/simultaneous.
 *
 * Joints of the members are in the same elimination: their rows come first (located/joint_rows).
 */
#ifndef RB_LOCATED_MODES_H
#define RB_LOCATED_MODES_H

#include "located/joint_rows.h"
#include "located/mechanics.h"

/* Maximal number of unknowns to eliminate. */
enum { RB_MODES_DENSE = 1536 };

/* Data of a piece that passes a singular position (located/singular). */
struct rb_singular_piece {
	bool closed;     /* its joints are a closed mechanism, without contacts */
	bool projects;   /* rates are evaluated at the nearest poses that joints allow */
	double *share;   /* [RB_GAUSS_NODES][joints.count]: independent shares of rows at nodes */
	int evaluations; /* so far */
	double rounding_allowed; /* rounding error allowed in a step, relative to scale */
};

/*
 * A piece of a cluster during its integration. All arrays are in the arena; l->place is that of the
 * members.
 */
struct rb_modes {
	struct rb_located *l;
	struct rb_cluster *c;
	double origin_s;           /* start of the piece */
	const double *scale;       /* sizes of its rows, to which errors are relative */
	int row;                   /* values per member */
	struct rb_pose *pose;      /* [member_count] */
	rb_vec3 *base;             /* [member_count]: origin of positions */
	rb_vec3 *linear, *angular; /* [member_count] */
	struct rb_contact_point *contact_point; /* [held_count] */
	struct rb_solver_contact *contact;      /* [held_count] */
	bool *slow;              /* [held_count]: its slip begins slowly (rb_modes_is_slow) */
	rb_vec3 *force, *change; /* [held_count]: N on b; refinement of it */
	struct rb_dense dense;   /* of joints, and contacts in their modes */
	/*
	 * largest number of unknowns to eliminate, for which there is memory; 0 where those of the
	 * joints without their drives are more than RB_MODES_DENSE
	 */
	int direct_max;
	struct rb_joint_rows joints;
	struct rb_coupled coupled;         /* of joints and contacts, where there are joints */
	struct rb_coupled_kept kept;       /* at the nodes of the piece */
	double residual;                   /* m/s^2: of the last solution, by rb_modes_refine */
	double *multiplier, *joint_change; /* [joints.count]: N; refinement of it */
	double *unknown;      /* of all rows, joints first: gives multiplier and force */
	bool balanced;        /* tangential forces of creeping slips, by rb_modes_solve */
	bool slip_ends, hits; /* reason found by `broken` */
	double force_max;     /* N: largest force at the beginning */
	double uncertainty;   /* N: of the forces at the beginning */
	double max;           /* m/s^2: largest acceleration that forces must balance */
	struct rb_singular_piece singular;
	struct rb_joint_tree *articulated; /* replaces rows, unless NULL (located/articulated) */
	bool goes_on;                      /* continues a piece that was not cut */
	uint64_t *calls, counted;        /* evaluations of its rates so far, and at the last one */
	double time_s;                   /* of the last evaluation */
	struct rb_external_parts *parts; /* [member_count]: for the ledger; NULL: there is none */
	double *node_entries;            /* [RB_GAUSS_NODES][RB_ENTRIES]: ledger entries there */
};

static inline int rb_modes_place(const struct rb_modes *w, int body)
{
	return body < w->l->n ? w->l->place[body] : -1;
}

/* Takes all arrays from the arena; false: out of memory. */
bool rb_modes_reserve(struct rb_modes *w);

/*
 * Sets places to those of the members, during the piece; returns the previous ones; NULL: out of
 * memory.
 */
int *rb_modes_take_places(struct rb_located *l, const struct rb_cluster *c);
void rb_modes_give_back_places(struct rb_located *l, const struct rb_cluster *c, const int *kept);

/* Does a member move, at the present poses? */
bool rb_modes_move(const struct rb_modes *w);

/* Number of unknowns of a contact in its mode. */
int rb_modes_unknowns(const struct rb_held *held);

/*
 * Fills w->force from poses, contact points, contacts and the accelerations without contact forces;
 * false: too many unknowns.
 */
bool rb_modes_solve(struct rb_modes *w, double t);

/*
 * If all points of a pair creep, gives them a common direction of slip, which is turned for all of
 * them together: individually they would be overdetermined. True: there is such a pair.
 * rb_modes_part_slips reverts this; joined slips that are straight then do not creep.
 */
bool rb_modes_join_slips(struct rb_modes *w);
void rb_modes_part_slips(struct rb_modes *w);

/* Are all forces within their cones? */
bool rb_modes_are_lawful(const struct rb_modes *w);

/*
 * Adds the accelerations by forces at the contacts, [held_count], and multipliers of joints,
 * [joints.count]. False: out of memory.
 */
bool rb_modes_press(struct rb_modes *w, const rb_vec3 *force, const double *multiplier);

/*
 * After rb_modes_solve and rb_modes_press, refines forces until accelerations satisfy the modes to
 * their own rounding: forces round relative to the heaviest body that they carry, which matters for
 * a light one below it. Does nothing if there is no residual. False: out of memory.
 */
bool rb_modes_refine(struct rb_modes *w, double t);

/* Largest residual acceleration of a mode, m/s^2; the residuals become the right side. */
double rb_modes_residual(struct rb_modes *w, double t);

/*
 * After rb_modes_press: does a slip creep (rb_event_set_creep) and change its speed by little of
 * what friction could cause?
 */
bool rb_modes_is_slow(const struct rb_modes *w, int contact, double t);

/*
 * Has a slip that was assumed straight turned, beyond rounding? If a pair has several points, slow
 * slips also turn within rounding: then the deviation must exceed a share of the speed, and a slip
 * that begins slowly counts as straight.
 */
bool rb_modes_turns_aside(const struct rb_modes *w, int contact);

/*
 * Finds admissible forces where the modes do not determine them. `found`, if not NULL: the bodies'
 * resulting accelerations, by forces near the held ones; these forces may violate the law.
 */
bool rb_modes_solve_any(struct rb_modes *w, double t, struct rb_solver_body **found);

#endif
