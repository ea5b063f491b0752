/* SPDX-License-Identifier: MIT */
/*
 * Broad phase: boxes -> sorted candidate pairs.
 *
 * Owned by the world; simulator thread only. A hierarchical grid: each box is stored in one cell of
 * the level whose cells are just as large as it, so that the pairs of a box are in a few cells of
 * each level in use, whatever the mix of sizes. Infinite planes are tested against every body,
 * rectangles are in the grid like bodies.
 */
#ifndef RB_STEP_BROADPHASE_H
#define RB_STEP_BROADPHASE_H

#include <stddef.h>
#include <stdint.h>

#include "geom/grid.h" /* struct rb_pair: body indices of the model, a < b; a is a moving body */

#include <rbsim/math.h>
#include <rbsim/model.h>

struct rb_broadphase;

RB_CHECKED enum rb_status rb_broadphase_create(struct rb_broadphase **broadphase,
                                               const struct rb_model *model, struct rb_error *err);
/* Searches with this team from now on, which must live as long; NULL: in one thread. */
void rb_broadphase_share(struct rb_broadphase *broadphase, struct rb_team *team);
void rb_broadphase_destroy(struct rb_broadphase *broadphase); /* NULL is fine */

/* Takes scratch memory of each call from this arena from now on; without one it keeps its own. */
void rb_broadphase_borrow(struct rb_broadphase *broadphase, struct rb_arena *arena);

/*
 * Finds all pairs whose boxes overlap (closed intervals), that the filters allow and of which at
 * least one moves, sorted by (a, b). `box` is [body_count], of the moving bodies, m; boxes must be
 * finite with low <= high. `*pairs` belongs to the broadphase until the next call. After the first
 * calls nothing is allocated.
 */
RB_CHECKED enum rb_status rb_broadphase_find(struct rb_broadphase *broadphase, const rb_aabb *box,
                                             const struct rb_pair **pairs, size_t *pair_count,
                                             struct rb_error *err);

/* The pairs last found are not needed any more; beyond so many bytes their memory may be taken. */
void rb_broadphase_discard(struct rb_broadphase *broadphase, size_t bytes);

/* Box-against-box (and box-against-plane) tests made so far. */
uint64_t rb_broadphase_tests(const struct rb_broadphase *broadphase);

#endif
