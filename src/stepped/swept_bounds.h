/* SPDX-License-Identifier: MIT */
/*
 * Territories of bodies for a step, and groups of bodies of which the territories meet.
 *
 * Owned by stepped/local_rollback. While every body stays within its territory, bodies of different
 * groups cannot touch.
 */
#ifndef RB_STEPPED_SWEPT_BOUNDS_H
#define RB_STEPPED_SWEPT_BOUNDS_H

#include "stepped/stepped_state.h"

struct rb_swept_group {
	int first, count;        /* in `member` */
	size_t pair, pair_count; /* in `pair` */
	bool failed;             /* one of its bodies has */
	bool finished;           /* all of its bodies are, and were one group when they became it */
};

struct rb_swept_bounds {
	/* of pairs that could touch; built_at: origins at the beginning of the step */
	struct rb_candidates candidates;
	rb_aabb *bounds;                    /* owned, by body: where its origin may be */
	int *group_of, *was_group, *parent; /* owned, by body; was_group: set by the owner */
	unsigned char *failed, *finished;   /* owned, by body: set by the owner */
	int *member;                        /* owned: by group, ascending */
	struct rb_swept_group *group;       /* owned, in order of their smallest bodies */
	size_t group_count, group_capacity;
	struct rb_pair *pair; /* owned: those of `candidates` by group, in their order */
	size_t pair_count, pair_capacity;
};

/* What has failed to be made is to be released too. */
RB_CHECKED enum rb_status rb_swept_bounds_create(struct rb_swept_bounds *swept,
                                                 const struct rb_model *model,
                                                 struct rb_error *err);
void rb_swept_bounds_release(struct rb_swept_bounds *swept);

/*
 * Territories after a try of the whole step of dt_s from `begin`: the box of the way that a body
 * has flown, or would fly where the try was bad for it, and an eighth of its size to all sides.
 */
void rb_swept_bounds_set(struct rb_swept_bounds *swept, const struct rb_world *world,
                         const struct rb_state *begin, double dt_s);
/* Groups by territories, springs and impulses of the try; bodies that do not yield join nobody. */
RB_CHECKED enum rb_status rb_swept_bounds_form(struct rb_swept_bounds *swept,
                                               struct rb_world *world, struct rb_error *err);
/* Lends `candidates` so many of the pairs by group, from that one on. */
void rb_swept_bounds_show(struct rb_swept_bounds *swept, size_t first, size_t count);
/*
 * Whether some of these bodies, driven ones too, have left theirs in the present state. They get
 * more of it: for the way ahead in the rest of the step, and more the farther it is.
 */
bool rb_swept_bounds_left(struct rb_swept_bounds *swept, const struct rb_world *world,
                          const struct rb_cohort *cohort, double rest_s);

#endif
