/* SPDX-License-Identifier: MIT */
/*
 * Swept bounds: a box for each body's origin in a step, and groups of bodies whose boxes overlap.
 *
 * Owned by stepped/local_rollback. While every body stays within its box, bodies of different
 * groups cannot touch.
 */
#ifndef RB_STEPPED_SWEPT_BOUNDS_H
#define RB_STEPPED_SWEPT_BOUNDS_H

#include "stepped/stepped_state.h"

struct rb_swept_group {
	int first, count;        /* in `member` */
	size_t pair, pair_count; /* in `pair` */
	bool failed;             /* one of its bodies failed */
	bool finished; /* all of its bodies are finished, and were one group when they finished */
};

struct rb_swept_bounds {
	/* pairs that could touch; built_at: origins at the beginning of the step */
	struct rb_candidates candidates;
	rb_aabb *bounds;                    /* owned, by body: box of its origin */
	int *group_of, *was_group, *parent; /* owned, by body; was_group: set by the owner */
	unsigned char *failed, *finished;   /* owned, by body: set by the owner */
	int *member;                        /* owned: by group, ascending */
	struct rb_swept_group *group;       /* owned, in order of their smallest bodies */
	size_t group_count, group_capacity;
	struct rb_pair *pair; /* owned: pairs of `candidates` by group, in their order */
	size_t pair_count, pair_capacity;
};

/* To be released after a failure too. */
RB_CHECKED enum rb_status rb_swept_bounds_create(struct rb_swept_bounds *swept,
                                                 const struct rb_model *model,
                                                 struct rb_error *err);
void rb_swept_bounds_release(struct rb_swept_bounds *swept);

/*
 * Sets boxes after an attempt of the whole step of dt_s from `begin`: the bounding box of a body's
 * path in the attempt, or of its free path where this failed, padded by an eighth of its size.
 */
void rb_swept_bounds_set(struct rb_swept_bounds *swept, const struct rb_world *world,
                         const struct rb_state *begin, double dt_s);
/*
 * Forms groups by boxes, springs, joints and impulses of the attempt; only dynamic bodies connect.
 */
RB_CHECKED enum rb_status rb_swept_bounds_form(struct rb_swept_bounds *swept,
                                               struct rb_world *world, struct rb_error *err);
/* Restricts `candidates` to `count` of the pairs by group, from `first` on. */
void rb_swept_bounds_restrict(struct rb_swept_bounds *swept, size_t first, size_t count);
/* Pairs and groups are not needed any more: likewise rb_attempt_discard. */
void rb_swept_bounds_discard(const struct rb_swept_bounds *swept, size_t bytes);
/*
 * Whether any of these bodies, driven ones too, has left its box in the present state. Its box
 * grows: by the path in the rest of the step, padded in proportion to the distance.
 */
bool rb_swept_bounds_left(struct rb_swept_bounds *swept, const struct rb_world *world,
                          const struct rb_cohort *cohort, double rest_s);

#endif
