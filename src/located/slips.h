/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: which forces hold and rub in the contacts of a set of bodies, and
 * which way those slip that do.
 *
 * State of one resolution of contacts is in the world's arena until it ends; l->set and l->place
 * are those of its bodies.
 */
#ifndef RB_LOCATED_SLIPS_H
#define RB_LOCATED_SLIPS_H

#include "located/drift.h"
#include "located/joint_rows.h"
#include "located/event_set.h"
#include "constraint/simultaneous.h"

/* State of one resolution of contacts. */
struct rb_resolution {
	struct rb_located *l;
	double t, slack;
	double drift; /* m/s: what rounding of forces has added to velocities of held contacts */
	bool moves;   /* some body of it does */
	bool after_impact; /* an impact has just happened */
	int hit;           /* contact that approaches though it has lasted, -1: none */
	int hit_joint;     /* joint that has come to a limit, or its rope taut, -1: none */
	struct rb_contact_point *contact_point;
	int contact_point_count;
	struct rb_held *before; /* [contact_point_count]: what was held of each, a < 0: nothing */
	struct rb_pose *pose;   /* [set_count] */
	rb_vec3 *linear, *angular; /* [set_count]: accelerations without contacts, then with them */
	struct rb_joint_rows joints;  /* of the set, at `pose` */
	struct rb_simultaneous joint; /* bodies: the set, then the fixed partners */
	bool *constant;               /* [set_count]: its other forces are constant */
	bool *constant_at_rest;       /* [set_count]: ... while all is at rest */
	int *root;                    /* [set_count]: union-find over what stays together */
	double external_max;          /* m/s^2: largest acceleration that went in */
	/* [set_count], m/s^2: what contacts' forces on a body would do to it one by one */
	double *load;
	/* [contact_point_count]: unit, slips are to go this way; 0: as velocities or forces say */
	rb_vec3 *slip;
	bool lets_go; /* contacts whose stick has ended have no friction */
};

/*
 * Has an impact just given the contact's bodies their velocities? Gravitation joins bodies that it
 * does not reach: those are still on their piece.
 */
static inline bool rb_slips_is_after_impact(const struct rb_resolution *s,
                                            const struct rb_contact_point *m)
{
	const int mover = rb_located_fixed(s->l, m->a) ? m->b : m->a;

	return s->after_impact &&
	       !(rb_located_gravitates(s->l) && rb_located_on_piece(s->l, mover));
}

/* Room in the arena; NULL, and l->status says so: there is none. */
void *rb_slips_take(struct rb_resolution *s, int count, size_t size);
/* The drift of its contact points: `kept` [contact_point_count], see struct rb_drift. */
struct rb_drift rb_slips_drift(const struct rb_resolution *s, bool *kept);

/*
 * Fills `joint` and `load`. Slips that end within rounding are ended, which changes poses'
 * velocities. False: l->status says why, for one that these are too many contacts.
 */
bool rb_slips_solve(struct rb_resolution *s);
void rb_slips_too_many(const struct rb_resolution *s);

/*
 * Do steps cost less than what these contacts take? If bodies move, eliminations; at rest, one
 * solution, after which they cost nothing.
 */
bool rb_slips_are_too_many(const struct rb_resolution *s);

/* Those of the same pair as contact k: from *first to before the number returned. */
int rb_slips_pair(const struct rb_resolution *s, int k, int *first);

/*
 * Of contact k, once solved: does it press? Does a slip that goes this way keep its direction until
 * it ends, to rounding?
 */
bool rb_slips_press(const struct rb_resolution *s, int k);
bool rb_slips_straight(const struct rb_resolution *s, int k, rb_vec3 slip);
/*
 * m/s, m/s^2: how fast its bodies move at contact k, or turn against each other at their sizes; and
 * what their angular accelerations make of the latter. Neither, and it rests; else it rolls.
 */
double rb_slips_turn(const struct rb_resolution *s, int k);
double rb_slips_turn_rate(const struct rb_resolution *s, int k);
/*
 * Is the direction of its slip what balances the forces across it? Where the slip is slow and
 * changes its speed by much less than friction could: else it has no time to turn there.
 */
bool rb_slips_creep(const struct rb_resolution *s, int k, const struct rb_held *held);

#endif
