/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: normal and friction forces in the contacts of a set of bodies, and
 * the directions of slips.
 *
 * The state of a resolution of contacts is in the world's arena until it ends; l->set and l->place
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
	double drift;      /* m/s: velocities of held contacts due to rounding of forces */
	bool moves;        /* a body of the set moves */
	bool after_impact; /* an impact has just happened */
	int hit;           /* lasting contact that approaches, -1: none */
	int hit_joint;     /* joint that has reached a limit, or taut rope, -1: none */
	struct rb_contact_point *contact_point;
	int contact_point_count;
	struct rb_held *before;    /* [contact_point_count]: its held contact before, a < 0: none */
	struct rb_pose *pose;      /* [set_count] */
	rb_vec3 *linear, *angular; /* [set_count]: accelerations without contacts, then with them */
	struct rb_joint_rows joints;    /* of the set, at `pose` */
	struct rb_simultaneous problem; /* bodies: the set, then the fixed partners */
	bool *constant;                 /* [set_count]: its external forces are constant */
	bool *constant_at_rest;         /* [set_count]: ... while all is at rest */
	int *root;                      /* union-find of connected parts */
	double external_max;            /* m/s^2: largest external acceleration */
	/* [set_count], m/s^2: largest accelerations of a body by single contact forces */
	double *load;
	/*
	 * [contact_point_count]: unit, prescribed directions of slips; 0: from velocities or forces
	 */
	rb_vec3 *slip;
	bool releases_friction; /* contacts whose stick has ended have no friction */
};

/*
 * Has an impact just changed the velocities of the contact's bodies? Gravitation also joins bodies
 * that the impact does not reach, which are still on their piece.
 */
static inline bool rb_slips_is_after_impact(const struct rb_resolution *s,
                                            const struct rb_contact_point *m)
{
	const int mover = rb_located_fixed(s->l, m->a) ? m->b : m->a;

	return s->after_impact &&
	       !(rb_located_gravitates(s->l) && rb_located_on_piece(s->l, mover));
}

/* Takes memory of the arena; NULL: none, in l->status. */
void *rb_slips_take(struct rb_resolution *s, int count, size_t size);
/*
 * Returns the drift problem of the contact points; `kept` [contact_point_count]: see struct
 * rb_drift.
 */
struct rb_drift rb_slips_drift(const struct rb_resolution *s, bool *kept);

/*
 * Fills `problem` and `load`. Ends slips that end within rounding, which changes poses' velocities.
 * False: see l->status; for instance too many contacts.
 */
bool rb_slips_solve(struct rb_resolution *s);
void rb_slips_too_many(const struct rb_resolution *s);

/*
 * Would steps cost less than these contacts? Moving bodies cost an elimination per evaluation;
 * bodies at rest one solution, and nothing afterwards.
 */
bool rb_slips_are_too_many(const struct rb_resolution *s);

/* The contacts of the pair of contact k: from *first to before the number returned. */
int rb_slips_pair(const struct rb_resolution *s, int k, int *first);

/*
 * For contact k, after solving: does it press; does a slip in this direction keep its direction
 * until it ends, to rounding?
 */
bool rb_slips_press(const struct rb_resolution *s, int k);
bool rb_slips_straight(const struct rb_resolution *s, int k, rb_vec3 slip);
/*
 * Speed of its bodies' motion at contact k, or of their relative rotation at their sizes, m/s; and
 * the change of the latter by their angular accelerations, m/s^2. If both are zero it rests,
 * otherwise it rolls.
 */
double rb_slips_turn(const struct rb_resolution *s, int k);
double rb_slips_turn_rate(const struct rb_resolution *s, int k);
/*
 * Is the direction of its slip given by balance of the tangential forces? True if the slip is slow
 * and changes its speed by much less than friction could; otherwise it has no time to turn there.
 */
bool rb_slips_creep(const struct rb_resolution *s, int k, const struct rb_held *held);

#endif
