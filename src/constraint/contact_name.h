/* SPDX-License-Identifier: MIT */
/*
 * Persistent names of contact points, common to all methods, so that data of a point (its force,
 * whether it sticks) can be passed from one method to another. Values.
 *
 *     pair    body indices, a < b, whichever of them moves
 *     parts   for unions: part of a in the upper half, of b in the lower; 0 for bodies of one part
 *     key     features that touch, from geom/manifold: a's in the upper half, b's in the lower; 0
 *             for spheres on spheres and planes, which have a single point
 *     half    located only: for a rim that has come to lie flat, or has tilted from there
 *
 * (pair, parts, key) are the same in every method and unique among the points of a pair. The
 * located method, which follows points as they move, adds to this: the four highest bits of a key
 * are the face in which two edges cross (RB_CONTACT_KEY_MARK), and a rim is followed from a
 * direction in its own axes, from which up to four points are counted. rb_contact_name_shared
 * removes these additions.
 */
#ifndef RB_CONSTRAINT_CONTACT_NAME_H
#define RB_CONSTRAINT_CONTACT_NAME_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/math.h>

struct rb_contact_name {
	int a, b;
	uint32_t parts;
	uint64_t key;
	rb_vec3 half; /* see rb_feature_half */
};

/* The bits of a key from here on are a mark of the located method (located/feature). */
enum { RB_CONTACT_KEY_MARK = 60 };

/* Order of names: by (a, b, parts, key, half). < 0, 0, > 0 as for qsort. */
int rb_contact_name_compare(const struct rb_contact_name *x, const struct rb_contact_name *y);
/* Do they name the same point? Points on opposite halves of a rim are two. */
bool rb_contact_name_is(const struct rb_contact_name *x, const struct rb_contact_name *y);

/* Returns the name with the bodies interchanged, for callers that order them otherwise. */
struct rb_contact_name rb_contact_name_swapped(const struct rb_contact_name *name);

/*
 * Returns the name as other methods use it, without mark and half. Points counted from a half have
 * no counterpart among the quarters of a rim: they become RB_CONTACT_ALL_ROUND.
 */
struct rb_contact_name rb_contact_name_shared(const struct rb_contact_name *name);

/* The place on a rim (geom/patch) that means any place. */
enum { RB_CONTACT_ALL_ROUND = 7 };

/*
 * Returns the key common to all points at which this rim touches the same feature, with the place
 * RB_CONTACT_ALL_ROUND; 0: the key has no rim. For callers that do not find a point's own name:
 * quarters are counted from where a rim lies, and only the located method distinguishes the two
 * points at which a line may touch it.
 */
uint64_t rb_contact_key_all_round(uint64_t key);

#endif
