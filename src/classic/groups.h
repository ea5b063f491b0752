/* SPDX-License-Identifier: MIT */
/*
 * Candidate pairs -> independent groups of bodies: the unit of rollback and of parallel work.
 *
 * Two levels. Boxes fat enough for several steps give candidate pairs, which hold until a body
 * could leave its box. In each step, the candidates within reach of each other (how far each body
 * can get in this step) connect bodies to groups. A body of a group may come out of an impact
 * faster than its reach foresaw; it is then looked at again with the path it really took, and where
 * that meets a body of another group the two groups become one and are run again from the beginning
 * of the step. Nobody else is.
 */
#ifndef RB_CLASSIC_GROUPS_H
#define RB_CLASSIC_GROUPS_H

#include "step/stage.h"

/* Bodies that may meet in this step, and what came out of running them. */
struct rb_group {
	int member_first, member_count; /* in rb_groups.member */
	int touch_first, touch_count;   /* in rb_groups.touch */
	bool dead;                      /* merged into another */
	struct rb_pass pass;   /* as it ended; its touches and events live in the step's arenas */
	struct rb_error error; /* status RB_OK: it went well */
};

struct rb_groups {
	int body_count;
	const struct rb_pair *candidate; /* borrowed from the broadphase */
	size_t candidate_count;
	bool valid; /* the candidates hold */

	/* by body */
	rb_vec3 *built_at; /* centre of the shape when the boxes were made, m */
	double *margin;    /* how far it may get from there, m */
	double *reach;     /* how far it can get in this step, m */
	/* how far it has been from its start at the end of a substep, m; of group members */
	double *travelled;
	unsigned char *held; /* scratch of classic/contact: has a lasting contact */
	int *parent;         /* union-find; the root is the smallest member */
	int *group_of;       /* -1: alone */
	rb_aabb *box;
	double *acceleration; /* bound, m/s^2 */

	int *alone, alone_count;
	int *member; /* of all groups; room for twice the bodies, a merge appends */
	size_t member_count, member_capacity;
	struct rb_group *group;
	size_t group_count, group_capacity;
	struct rb_touch *touch; /* of all groups, each group's sorted by pair */
	size_t touch_count, touch_capacity;
	struct rb_pair *active; /* candidates within reach in this step, sorted */
	size_t active_count, active_capacity;
	struct rb_pair *missed; /* scratch of a merge */
	size_t missed_count, missed_capacity;
};

RB_CHECKED enum rb_status rb_groups_create(struct rb_groups **groups, const struct rb_model *model,
                                           struct rb_error *err);
void rb_groups_destroy(struct rb_groups *groups); /* NULL is fine */

/*
 * Groups of this step, of length dt_s; none has run yet. With global rollback all bodies are one
 * group.
 */
RB_CHECKED enum rb_status rb_groups_form(struct rb_world *world, double dt_s, struct rb_error *err);

/*
 * After the groups from `first` on have run: merges those that met in truth. New groups stand at
 * the end of the list and must run, the rows of their members are back at the beginning of the
 * step; `*again` says how many.
 */
RB_CHECKED enum rb_status rb_groups_merge(struct rb_world *world, size_t *again,
                                          struct rb_error *err);

/* A callback has moved bodies: look for candidates anew. */
void rb_groups_forget(struct rb_groups *groups);

#endif
