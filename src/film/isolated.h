/* SPDX-License-Identifier: MIT */
/*
 * Which spheres share no point with another one: their order in depth is that of anything inside
 * them.
 *
 * One thread. Arrays are kept from call to call.
 */
#ifndef RB_FILM_ISOLATED_H
#define RB_FILM_ISOLATED_H

#include <stdbool.h>

#include "geom/grid.h"

struct rb_apart_ball {
	rb_vec3 centre;
	double radius;
	bool cuts; /* out: it overlaps another one; what was set stays */
};

struct rb_apart {
	struct rb_grid grid;
	rb_aabb *box; /* owned */
	size_t capacity;
};

void rb_apart_init(struct rb_apart *apart);
void rb_apart_release(struct rb_apart *apart); /* safe on a zeroed one */

/* Overlaps that nobody could see, of a thousandth of a radius, are none. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_apart_find(struct rb_apart *apart, struct rb_apart_ball *balls,
                                        int count, struct rb_error *err);

/* Does a sphere cut the parallelogram from `corner` along two edges? */
bool rb_apart_cuts_rectangle(const struct rb_apart_ball *ball, rb_vec3 corner, rb_vec3 u,
                             rb_vec3 v);
/* What of a radius counts. */
extern const double rb_apart_part;

#endif
