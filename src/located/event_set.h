/* SPDX-License-Identifier: MIT */
/*
 * The bodies that one event involves: l->set, and the index of each in l->place. One set at a time.
 * Simulator's thread.
 */
#ifndef RB_LOCATED_EVENT_SET_H
#define RB_LOCATED_EVENT_SET_H

#include "located/pair_contacts.h"

/* Adds a body unless it is fixed or already in the set. */
void rb_event_set_add(struct rb_located *l, int i);
/* Adds the bodies at the other ends of the body's force elements. */
void rb_event_set_add_partners(struct rb_located *l, int i);
void rb_event_set_clear(struct rb_located *l);

/*
 * Writes all moving bodies that could touch this one (all others, or those in the cells around it)
 * to l->near; returns their number.
 */
int rb_event_set_near(const struct rb_located *l, int i);
/* Those of them that list each pair once, for one of the two bodies. */
int rb_event_set_near_once(const struct rb_located *l, int i);

/*
 * True if the sphere touches a body other than `except`, or is near one for which only a search
 * could decide. Always false for a fixed body.
 */
bool rb_event_set_touches_another(const struct rb_located *l, int i, int except, double t);

/* First point of the pair's lasting contact, the others follow it; NULL if it has none. */
const struct rb_held *rb_event_set_held(const struct rb_located *l, int a, int b);
/* One past the last point of the pair of `first`. */
const struct rb_held *rb_event_set_held_end(const struct rb_located *l,
                                            const struct rb_held *first);
/*
 * The held contact that this point continues, by its features or, where features have ended, by its
 * place; NULL: none.
 */
const struct rb_held *rb_event_set_continued(const struct rb_located *l,
                                             const struct rb_contact_point *m);

/* What steps have left of a contact that is not held yet. */
struct rb_event_set_left {
	rb_vec3 force; /* N, on b: initial guess */
	bool sticks;   /* friction was within the cone */
	rb_vec3 slip;  /* unit: else the direction of slip, opposite to friction; 0 without it */
};
/*
 * Returns false, without setting *left, if steps have left nothing for the point. For a point of a
 * flat rim whose quarters steps count from another start: the mean.
 */
bool rb_event_set_left_of(const struct rb_located *l, const struct rb_contact_point *m,
                          struct rb_event_set_left *left);

/* True if the pair can touch at one point only: a sphere with a sphere or a plane. */
static inline bool rb_event_set_is_single(const struct rb_located *l, int a, int b)
{
	const enum rb_shape_kind x = l->model->shape[a].kind, y = l->model->shape[b].kind;

	return x <= RB_SHAPE_RECTANGLE && y <= RB_SHAPE_RECTANGLE;
}

static inline struct rb_contact_name rb_event_set_name(const struct rb_held *held)
{
	return (struct rb_contact_name){held->a, held->b, held->parts, held->key, held->half};
}

/* Contact point of a held contact with its bodies on their arcs at t. */
struct rb_contact_point rb_event_set_contact_point(const struct rb_located *l,
                                                   const struct rb_held *held, double t);
/* True if the point has left its features beyond rounding. */
bool rb_event_set_has_left(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * Slip speed below which the slip creeps, m/s: its direction is taken as that in which forces
 * across it balance. The true direction turns towards it at a rate of friction over speed, so it
 * differs by no more than speed / (friction g) times the rate at which the balance turns;
 * integrating that would take steps of this length.
 */
double rb_event_set_creep(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * True if the slip is below that speed, and `rate`, at which the speed changes, m/s^2, is small
 * beside the deceleration that a friction of `force`, N, could cause.
 */
bool rb_event_set_is_slow(const struct rb_located *l, const struct rb_contact_point *m, double rate,
                          rb_vec3 force);
/*
 * Gap at the opposite side of a rim that rolls on this point, m, if it closes and is within what
 * integration leaves of positions, or if the rim wobbles within the run's tolerance: ever faster as
 * it is lower, and without end where nothing slips; else 0.
 */
double rb_event_set_landing_gap(const struct rb_located *l, const struct rb_contact_point *m);
/* True if these are the same point of the pair, though with other features. */
bool rb_event_set_is_same_place(const struct rb_located *l, const struct rb_contact_point *x,
                                const struct rb_contact_point *y);

/*
 * The same for points of two pairs with a body in common. Rounding separates points of adjacent
 * features by no more.
 */
bool rb_event_set_is_shared_place(const struct rb_located *l, const struct rb_contact_point *x,
                                  const struct rb_contact_point *y);

/* Decides whether a pair that touches, or is held, joins the set. */
typedef bool rb_event_set_joins(const struct rb_located *l, const struct rb_contact_point *m,
                                double t, double slack);

/*
 * Grows the set by all bodies joined to it by clusters, force elements, joints and touching pairs
 * that `joins` accepts. Writes the contacts between its bodies, and between them and fixed bodies,
 * to the arena: *found, sorted by (a, b, parts, key). Returns their number; -1: no memory.
 */
int rb_event_set_grow(struct rb_located *l, double t, double slack, rb_event_set_joins *joins,
                      struct rb_contact_point **found);

/* Accepts all touching pairs, whether they approach or separate. */
bool rb_event_set_touching(const struct rb_located *l, const struct rb_contact_point *m, double t,
                           double slack);
/* Accepts touching pairs that do not separate. */
bool rb_event_set_lasting(const struct rb_located *l, const struct rb_contact_point *m, double t,
                          double slack);

#endif
