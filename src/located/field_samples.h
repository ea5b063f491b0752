/* SPDX-License-Identifier: MIT */
/*
 * What the scene's field does between the nodes of a piece, for so short a time, or in so small a
 * space, that no node sees it: the function alone is compared with its values at the nodes, at
 * samples of time that all pieces share. No contacts or joints are solved for that. Simulator's
 * thread.
 */
#ifndef RB_LOCATED_FIELD_SAMPLES_H
#define RB_LOCATED_FIELD_SAMPLES_H

#include "located/located.h"

/* The piece of a cluster, and the origins of its members' positions; NULL: those in l->piece. */
struct rb_field_samples {
	struct rb_located *l;
	struct rb_cluster *c;
	double origin_s;
	const rb_vec3 *base; /* [member_count] */
};

/* The first sample not before `t`, or after it; INFINITY: the scene has no field. */
double rb_field_samples_from(const struct rb_located *l, double t);
double rb_field_samples_after(const struct rb_located *l, double t);

/*
 * At the sample, is a force other than what its values at the nodes lead to, by more than an error
 * of the piece explains? Not asked of pieces whose nodes are as close as samples. Sets l->status if
 * the function fails.
 */
bool rb_field_samples_depart(const struct rb_field_samples *of, double sample_s);

/* Does a force change within `soon_s` of the beginning, where nothing has moved? */
bool rb_field_samples_jump(const struct rb_field_samples *of, double soon_s);

/*
 * Returns the next event and its time like rb_queue_first; -1: none until then, or l->status. Has
 * first looked ahead from each sample before it, `*seen_s`, to the next one: what pieces do not see
 * in between ends them at `*seen_s`.
 */
int rb_field_samples_next(struct rb_located *l, double until, double *seen_s, double *t);

#endif
