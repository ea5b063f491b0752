/* SPDX-License-Identifier: MIT */
/* The narrow phase of a pair: its contact points, added to those of its block. */
#ifndef RB_STEPPED_INSPECTION_H
#define RB_STEPPED_INSPECTION_H

#include "stepped/contact_points.h"

/* A filled buffer of a block's points. */
struct rb_inspection_piece {
	const struct rb_step_point *row;
	size_t count;
	const struct rb_inspection_piece *before;
};

/* Input that workers share, read only, then the state of the block that one of them inspects. */
struct rb_inspection {
	struct rb_world *world;
	const struct rb_step_points *points;
	/* cached axes of the pairs of a block are written by its worker */
	struct rb_candidates *candidates;
	double h, max; /* s; m: largest gap of a point */
	size_t pair;   /* the inspected one */
	/* the block's */
	struct rb_step_point *out;
	size_t count, capacity;
	const struct rb_inspection_piece *full; /* full buffers before `out`, the last first */
	size_t all;                             /* points, including those in `full` */
	size_t place;                           /* index of the block's first point among all */
	struct rb_arena *arena;
	bool in_place; /* the first buffer is the final place of the points */
	bool failed;
	bool borders; /* some point is on a border where another part may go on */
};

/* Copies the points of a block to their final place, in order. */
void rb_inspection_gather(const struct rb_inspection *inspection, struct rb_step_point *to);

/* Adds the point of a sphere and a body without parts, if its gap is no more than `slack`, m. */
void rb_inspect_ball(struct rb_inspection *inspection, struct rb_pair pair, double slack);

/*
 * Adds points of all pairs of parts. Returns a lower bound of their distance, m; -INFINITY:
 * unknown.
 */
double rb_inspect_parts(struct rb_inspection *inspection, struct rb_pair pair, double slack,
                        struct rb_axis_cache *caches);

/* Adds points of two parts, by index, along a normal, unit, from the first to the second. */
void rb_inspect_along(struct rb_inspection *inspection, struct rb_pair pair, const int part[2],
                      rb_vec3 normal, double slack);

/*
 * The same over the plane of a face of the part at one side, with this outward normal, as if it had
 * no border: those of its points that are on the face.
 */
void rb_inspect_plane(struct rb_inspection *inspection, struct rb_pair pair, const int part[2],
                      int side, rb_vec3 outward, double slack);

/* Whether contacts do not move a body: a static or driven one. */
static inline bool rb_inspection_is_fixed(const struct rb_model *model, int i)
{
	return i >= model->body_count || !(model->inverse_mass[i] > 0);
}

/* The part of a point's first or second body. */
static inline int rb_step_point_part(const struct rb_step_point *point, int side)
{
	return (int)((point->a < point->b) == (side == 0) ? point->parts >> 16
	                                                  : point->parts & 0xffff);
}

/* What of a point's first or second body touches, as in its key. */
static inline uint32_t rb_step_point_feature(const struct rb_step_point *point, int side)
{
	return (uint32_t)((point->a < point->b) == (side == 0) ? point->key >> 32 : point->key);
}

/*
 * Whether a part of a body may be flush with others that move with it: of the same body, or of
 * others that contacts do not move either. Those of a terrain know their neighbours.
 */
bool rb_inspection_may_go_on(const struct rb_model *model, int i);

#endif
