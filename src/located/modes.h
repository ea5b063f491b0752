/* SPDX-License-Identifier: MIT */
/*
 * Forces of a cluster's contacts, each in its mode: they stick, slip along a direction, or creep
 * (rb_event_set_creep). An elimination for the forces that the modes ask for; where it is too
 * large, the solver of constraint/simultaneous.
 *
 * Joints of the members are in the same elimination: their rows come first (located/joint_rows).
 */
#ifndef RB_LOCATED_MODES_H
#define RB_LOCATED_MODES_H

#include "located/joint_rows.h"
#include "located/mechanics.h"

/* More unknowns are not eliminated. */
enum { RB_MODES_DENSE = 1536 };

/* What of a piece past a singular position (located/singular). */
struct rb_singular_piece {
	bool closed;    /* its joints are a closed mechanism, without contacts */
	bool projects;  /* rates are those at the nearest poses that joints allow */
	double *share;  /* [RB_GAUSS_NODES][joints.count]: what others left of rows at nodes */
	int seen;       /* how many so far */
	double granted; /* of scale: what rounding may make of a step */
};

/* One piece of a cluster under way. All arrays are in the arena; l->place is that of members. */
struct rb_modes {
	struct rb_located *l;
	struct rb_cluster *c;
	double origin_s;           /* of the piece */
	const double *scale;       /* of its rows: what errors are relative to */
	int row;                   /* values a member */
	struct rb_pose *pose;      /* [member_count] */
	rb_vec3 *base;             /* [member_count]: where positions are counted from */
	rb_vec3 *linear, *angular; /* [member_count] */
	struct rb_contact_point *contact_point; /* [held_count] */
	struct rb_solver_contact *contact;      /* [held_count] */
	bool *slow;              /* [held_count]: its slip begins slowly (rb_modes_is_slow) */
	rb_vec3 *force, *change; /* [held_count]: N on b; what refining adds */
	struct rb_dense dense;   /* for joints, and contacts in their modes */
	struct rb_joint_rows joints;
	struct rb_coupled coupled;         /* of joints and contacts, where there are joints */
	struct rb_coupled_kept kept;       /* at the nodes of the piece */
	double left;                       /* m/s^2: of the last solution, by rb_modes_refine */
	double *multiplier, *joint_change; /* [joints.count]: N; what refining adds */
	double *unknown;      /* of all rows, joints first: what multiplier and force are made of */
	bool balanced;        /* forces across slips that creep, by rb_modes_solve */
	bool slip_ends, hits; /* why `broken` said so */
	double force_max;     /* N: largest force at the beginning */
	double doubt;         /* N: what the modes at the beginning leave open */
	double max;           /* m/s^2: largest acceleration that forces are to balance */
	struct rb_singular_piece singular;
	struct rb_joint_tree *articulated; /* instead of rows; NULL: those (located/articulated) */
	bool goes_on;                      /* from a piece that nothing has cut */
	uint64_t *calls, counted;          /* of its rates, so far and at the last one */
	double time_s;                     /* of the last evaluation */
	struct rb_external_parts *parts; /* [member_count]: for the ledger; NULL: it is not kept */
	double *seen;                    /* [RB_GAUSS_NODES][RB_ENTRIES]: what acted there */
};

static inline int rb_modes_place(const struct rb_modes *w, int body)
{
	return body < w->l->n ? w->l->place[body] : -1;
}

/* Room in the arena for all arrays; false: no memory. */
bool rb_modes_reserve(struct rb_modes *w);

/* Within the piece, places are those of the members; NULL: no memory. Returns those of before. */
int *rb_modes_take_places(struct rb_located *l, const struct rb_cluster *c);
void rb_modes_give_back_places(struct rb_located *l, const struct rb_cluster *c, const int *kept);

/* Does a member move, at the poses as they are? */
bool rb_modes_move(const struct rb_modes *w);

/* How many a contact has in its mode. */
int rb_modes_unknowns(const struct rb_held *held);

/*
 * Fills w->force from poses, contact points, contacts and accelerations apart from them; false: too
 * many unknowns.
 */
bool rb_modes_solve(struct rb_modes *w, double t);

/*
 * Where all points of a pair creep they are to go one way, which is turned for all of them
 * together: each on its own would be one too many. True: there is such a pair. And back: those that
 * are straight then do not creep.
 */
bool rb_modes_join_slips(struct rb_modes *w);
void rb_modes_part_slips(struct rb_modes *w);

/* Is none of the forces outside its cone? */
bool rb_modes_are_lawful(const struct rb_modes *w);

/*
 * Accelerations by forces at the contacts, [held_count], and multipliers of joints, [joints.count].
 * False: no memory.
 */
bool rb_modes_press(struct rb_modes *w, const rb_vec3 *force, const double *multiplier);

/*
 * After rb_modes_solve and rb_modes_press: accelerations that are of the modes to the rounding of
 * accelerations. Forces round by the heaviest body that they carry, which to a light one below it
 * is no small thing. Nothing to do where nothing is left. False: no memory.
 */
bool rb_modes_refine(struct rb_modes *w, double t);

/* What the accelerations leave of the modes, the largest, m/s^2. */
double rb_modes_left(struct rb_modes *w, double t);

/*
 * After rb_modes_press: does a slip creep (rb_event_set_creep), and change its speed by little of
 * what friction could do?
 */
bool rb_modes_is_slow(const struct rb_modes *w, int contact, double t);

/*
 * Has a slip that was taken for straight turned aside, beyond rounding? Those at several points of
 * a pair also turn within what rounding makes of a slow slip: of their speed it has to be more, and
 * what begins slowly goes straight.
 */
bool rb_modes_turns_aside(const struct rb_modes *w, int contact);

/*
 * Where modes do not determine the forces: any that are lawful. `found`, if not NULL: how bodies
 * then move, by forces near the held ones; these may be none by the law.
 */
bool rb_modes_solve_any(struct rb_modes *w, double t, struct rb_solver_body **found);

/*
 * A field is asked at coordinates that are rounded, and answers with steps: what it changes along
 * the way of a member, for a rounding of the place. Far from the origin that is more than the
 * tolerance.
 */
double rb_modes_noise(void *user, const double *coefficient);

#endif
