/* SPDX-License-Identifier: MIT */
/* Common properties of the contact points of one face of a pair, as rows are filled. */
#ifndef RB_STEPPED_FACE_H
#define RB_STEPPED_FACE_H

#include "stepped/contact_points.h"
#include "stepped/pivot.h"

static inline bool rb_face_is_pair(const struct rb_step_point *p, const struct rb_step_point *q)
{
	return p->a == q->a && p->b == q->b;
}

/* Points of one face of a pair have bit for bit the same normal and are adjacent. */
static inline bool rb_face_is_shared(const struct rb_step_point *p, const struct rb_step_point *q)
{
	return rb_face_is_pair(p, q) && p->normal.x == q->normal.x && p->normal.y == q->normal.y &&
	       p->normal.z == q->normal.z;
}

/* The point with the smallest gap among those of the same face. */
static inline const struct rb_step_point *rb_face_nearest(const struct rb_step_points *points,
                                                          int number)
{
	const struct rb_step_point *const point = &points->row[number], *const first = points->row;
	const struct rb_step_point *const end = first + points->count, *nearest = point;

	for (const struct rb_step_point *p = point; p-- > first && rb_face_is_shared(p, point);)
		nearest = p->gap + p->bend <= nearest->gap + nearest->bend ? p : nearest;
	for (const struct rb_step_point *p = point + 1; p < end && rb_face_is_shared(p, point); p++)
		nearest = p->gap + p->bend < nearest->gap + nearest->bend ? p : nearest;
	return nearest;
}

/* Common properties of points of one face. */
struct rb_face {
	const struct rb_step_point *last;    /* last point of rb_face_take; NULL: none */
	const struct rb_step_point *nearest; /* point with the smallest gap */
	bool pivots;
	rb_pivot mean; /* mean of arms over the step */
};

/* Sets the properties for a point; to be called in the order of points. */
static inline void rb_face_take(struct rb_face *face, const struct rb_step_points *points,
                                int number, const struct rb_world *world, double h_s)
{
	const struct rb_step_point *const point = &points->row[number];
	const bool is_same_face = face->last && face->last + 1 == point && !face->last->central &&
	                          rb_face_is_shared(face->last, point);

	face->last = point;
	if (is_same_face)
		return;
	face->nearest = rb_face_nearest(points, number);
	const double angle = rb_pivot_angle(world, point->a, point->b, point->normal, h_s);
	face->pivots = angle != 0;
	if (face->pivots)
		face->mean = rb_pivot_mean(angle);
}

#endif
