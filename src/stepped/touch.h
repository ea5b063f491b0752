/* SPDX-License-Identifier: MIT */
/*
 * Points at which bodies could touch within a step: of spheres among themselves and on planes by closed forms, of all else
 * through geom/manifold, part by part.
 *
 * A point has a name (pair, parts, features) by which the impulse of the step before is found again. Points come in order of
 * pairs, whatever the threads.
 */
#ifndef RB_STEPPED_TOUCH_H
#define RB_STEPPED_TOUCH_H

#include "stepped/near.h"

struct rb_point {
	int a, b; /* indices of the model, a < b: a moves */
	uint64_t key;
	bool central;
	rb_vec3 normal; /* unit, from a to b */
	rb_vec3 arm_a,
		arm_b; /* m, from the centres of mass; central: x is the length along the normal */
	double gap;    /* m, at the beginning of the step */
	double friction, restitution;
	double approach; /* m/s: towards each other at the beginning of the step, before its forces */
	double push;     /* N s */
	rb_vec3 rub;     /* N s, on b */
};

/* What of a point the next step starts from. */
struct rb_named_push {
	int a, b;
	uint64_t key;
	double force; /* N */
	rb_vec3 rub;  /* N */
};

struct rb_points {
	struct rb_point *row; /* owned */
	size_t count, capacity;
	struct rb_named_push *last; /* owned, in the order of points */
	size_t last_count, last_capacity;
	size_t *first_last; /* owned, [bodies + 1]: of each a in `last` */
};

RB_CHECKED enum rb_status rb_points_create(struct rb_points *points, const struct rb_model *model,
                                           struct rb_error *err);
void rb_points_release(struct rb_points *points);

/* Of the candidates, which hold; velocities as for rb_near_find. Warm impulses are for a step of h_s. */
RB_CHECKED enum rb_status rb_points_find(struct rb_points *points, struct rb_world *world,
                                         struct rb_near *near, double h_s, struct rb_error *err);

/* Keeps the impulses of a step that has been accepted. */
RB_CHECKED enum rb_status rb_points_keep(struct rb_points *points, const struct rb_model *model,
                                         double h_s, struct rb_error *err);

/* After `last` has changed. */
void rb_points_index(struct rb_points *points, const struct rb_model *model);

/* The largest overlap of the candidates in the present state, m, and whose; 0: none. */
double rb_points_overlap(struct rb_world *world, struct rb_near *near, int pair[2]);

#endif
