/* SPDX-License-Identifier: MIT */
/*
 * Which contact point of which two bodies: one naming for every method, so that what one of them
 * knows of a point (its force, whether it sticks) is found by the next one. Values.
 *
 *     pair    body indices, a < b, whichever of them moves
 *     parts   of unions: part of a in the upper half, of b in the lower; 0 of bodies with one part
 *     key     features that touch, as geom/manifold finds them: a's in the upper half, b's in the
 *             lower; 0 of spheres on spheres and planes, which have one point
 *     half    located only: of a rim that has come to lie flat or is tilted from there
 *
 * (pair, parts, key) are the same in every method, and no two points of a pair share them. The
 * located method, which follows points as they move, says more: the four highest bits of a key have
 * the face in which two edges cross (RB_CONTACT_KEY_MARK), and a rim is followed from a direction
 * in its own axes, from which it counts up to four points. rb_contact_name_shared takes that off.
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

/* Bits of a key from here on are a mark of the located method's (located/feature). */
enum { RB_CONTACT_KEY_MARK = 60 };

/* Order of names: by (a, b, parts, key, half). < 0, 0, > 0 as for qsort. */
int rb_contact_name_compare(const struct rb_contact_name *x, const struct rb_contact_name *y);
/* Do they name the same point? Points on opposite halves of a rim are two. */
bool rb_contact_name_is(const struct rb_contact_name *x, const struct rb_contact_name *y);

/* The same with the bodies interchanged, for who counts them the other way. */
struct rb_contact_name rb_contact_name_swapped(const struct rb_contact_name *name);

/*
 * As other methods have it: without mark and half. Points that are counted from a half have no
 * counterpart among quarters of a rim: they become RB_CONTACT_ALL_ROUND of it.
 */
struct rb_contact_name rb_contact_name_shared(const struct rb_contact_name *name);

/* The place on a rim (geom/patch) that stands for any other. */
enum { RB_CONTACT_ALL_ROUND = 7 };

/*
 * The key for all points at which this one's rim meets the same feature, with the place
 * RB_CONTACT_ALL_ROUND; 0: it is of no rim. For who does not find a point's own name: quarters are
 * counted from where a rim lies, and of a line that meets it in one point only the located method
 * says which of two it is.
 */
uint64_t rb_contact_key_all_round(uint64_t key);

#endif
