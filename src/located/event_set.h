/* SPDX-License-Identifier: MIT */
/*
 * The bodies that one event deals with together: l->set, and l->place for each of them. One set at
 * a time.
 */
#ifndef RB_LOCATED_EVENT_SET_H
#define RB_LOCATED_EVENT_SET_H

#include "located/pair_contacts.h"

/* Adds a body that yields; a fixed one and one that is in it already are left out. */
void rb_event_set_add(struct rb_located *l, int i);
void rb_event_set_clear(struct rb_located *l);

/*
 * Every moving body that could touch this one: all, or those in the cells around it. Writes to
 * l->near.
 */
int rb_event_set_near(const struct rb_located *l, int i);

/*
 * Does the sphere, which may be a fixed body that nobody asks about, touch another one than
 * `except`, or is it near one of which only a search could say?
 */
bool rb_event_set_touches_another(const struct rb_located *l, int i, int except, double t);

/* Is this pair held in a lasting contact? The first of its points; the others follow it. */
const struct rb_held *rb_event_set_held(const struct rb_located *l, int a, int b);
/* One past the last point of the pair that `first` is of. */
const struct rb_held *rb_event_set_held_end(const struct rb_located *l,
                                            const struct rb_held *first);
/*
 * The held contact that this contact goes on with, NULL: none. By its features; of those that have
 * come to an end there, by its place.
 */
const struct rb_held *rb_event_set_held_like(const struct rb_located *l,
                                             const struct rb_contact_point *m);

/* What steps have found of a contact that is not held yet. */
struct rb_event_set_left {
	rb_vec3 force; /* N, on b: a guess */
	bool sticks;   /* its friction was within the cone */
	rb_vec3 slip;  /* unit: else the way it slipped, against its friction; 0: it had none */
};
/*
 * False: nothing, *left is not set. Of a flat rim's point that steps count from elsewhere: the
 * mean.
 */
bool rb_event_set_left_of(const struct rb_located *l, const struct rb_contact_point *m,
                          struct rb_event_set_left *left);

/* Only ever one point: a sphere with a sphere or a plane. */
static inline bool rb_event_set_is_single(const struct rb_located *l, int a, int b)
{
	const enum rb_shape_kind x = l->model->shape[a].kind, y = l->model->shape[b].kind;

	return x <= RB_SHAPE_RECTANGLE && y <= RB_SHAPE_RECTANGLE;
}

static inline struct rb_contact_name rb_event_set_name(const struct rb_held *held)
{
	return (struct rb_contact_name){held->a, held->b, held->parts, held->key, held->half};
}

/* A held contact at a moment of its bodies' arcs. */
struct rb_contact_point rb_event_set_contact_point(const struct rb_located *l,
                                                   const struct rb_held *held, double t);
/* Has the point left the features that it is named by, beyond rounding? */
bool rb_event_set_has_left(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * m/s: slip below which its direction is that in which forces across it balance. It turns there at
 * a rate of friction over speed, so that it is this to within speed / (friction g) of how fast that
 * turns; followed as it turns it would take steps of that length.
 */
double rb_event_set_creep(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * Is a slip below it, and does it change its speed, at `rate` m/s^2, by little of what friction, of
 * `force` N, could do?
 */
bool rb_event_set_is_slow(const struct rb_located *l, const struct rb_contact_point *m, double rate,
                          rb_vec3 force);
/*
 * m: by how much the other side of a rim that rolls on this point is off touching, while it closes
 * and that is no more than what integration leaves of where things are; 0: it is none, or not so
 * near.
 */
double rb_event_set_landing_gap(const struct rb_located *l, const struct rb_contact_point *m);
/* Are these the same point of the pair, though by other features? */
bool rb_event_set_is_same_place(const struct rb_located *l, const struct rb_contact_point *x,
                                const struct rb_contact_point *y);

/*
 * ... or of two pairs with a body in common? Rounding parts features that follow each other by no
 * more.
 */
bool rb_event_set_is_shared_place(const struct rb_located *l, const struct rb_contact_point *x,
                                  const struct rb_contact_point *y);

/* Which pairs join: called with a pair that touches, or is held. */
typedef bool rb_event_set_joins(const struct rb_located *l, const struct rb_contact_point *m,
                                double t, double slack);

/*
 * Grows the set to all that is joined to it by clusters, force elements and touching pairs that
 * `joins`
 * accepts, and writes the contacts between its bodies, and between them and fixed bodies, to the
 * arena: *found, sorted by (a, b, parts, key). Returns how many; -1 when memory is out.
 */
int rb_event_set_grow(struct rb_located *l, double t, double slack, rb_event_set_joins *joins,
                      struct rb_contact_point **found);

/* All touching pairs, whichever way they move. */
bool rb_event_set_touching(const struct rb_located *l, const struct rb_contact_point *m, double t,
                           double slack);
/* Touching pairs that do not part. */
bool rb_event_set_lasting(const struct rb_located *l, const struct rb_contact_point *m, double t,
                          double slack);

#endif
