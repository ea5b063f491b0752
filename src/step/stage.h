/* SPDX-License-Identifier: MIT */
/*
 * Stages of a substep and the pass that they work on.
 *
 * A substep is a list of stages, built once from the scene's features (classic/stage_list). Each
 * stage runs over a `struct rb_pass`: the bodies and touches of one group, on one worker. Bodies
 * that cannot meet others within the step run through the same stages in blocks, without touches.
 */
#ifndef RB_STEP_STAGE_H
#define RB_STEP_STAGE_H

#include "step/broadphase.h"
#include "world/world.h"

/* Signed distance of two bodies at one time. */
struct rb_gap {
	double gap;     /* m, negative: overlap */
	rb_vec3 normal; /* unit, from a to b */
	rb_vec3 point;  /* m, world: in the middle of gap or overlap */
};

/* Two bodies that may touch within the step. */
struct rb_touch {
	int a, b;
	bool lasting;
	double band;          /* m: gaps up to here count as touching */
	rb_vec3 force_normal; /* normal of the forces, from which the bodies may have moved since */
	double normal_force;  /* N, of the last substep; 0 unless lasting */
	rb_vec3 tangent_force; /* N, on b */
};

struct rb_pass {
	struct rb_world *world;
	struct rb_arena *arena; /* the worker's, for scratch */
	struct rb_arena *kept;  /* the worker's, for what the commit of the step needs */
	const int *member;      /* body indices, ascending */
	int member_count;
	struct rb_touch *touch; /* sorted by (a, b) */
	int touch_count;
	struct rb_gap *now, *next; /* [touch_count], at the beginning and the end of the substep */

	double start_s, dt_s; /* the whole step */
	double done_s;        /* of it, accepted */
	double h_s;           /* the current substep */

	/* for step/verdict: the touch that violates the tolerance most, -1: none */
	int worst;
	double worst_gap;

	struct rb_counts counts;
	struct rb_entries entries; /* ledger entries of accepted substeps */
	/* in the arena; `a`, `b` are body indices until they are committed */
	struct rb_event *event;
	int event_count, event_capacity;
	bool out_of_memory; /* set after a failed allocation from the arena */
};

typedef void rb_stage_run(struct rb_pass *pass);

struct rb_stage {
	const char *name;
	const char *what; /* for `rbsim check` */
	rb_features need; /* any of these features; 0: always */
	rb_stage_run *run;
};

static inline bool rb_stage_is_needed(const struct rb_stage *stage, rb_features features)
{
	return stage->need == 0 || (features & stage->need) != 0;
}

/* Memory for a pass from one of its arenas; NULL sets out_of_memory. */
static inline void *rb_pass_take(struct rb_pass *pass, struct rb_arena *arena, int count,
                                 size_t size)
{
	void *const block = rb_arena_take(arena, (size_t)count, size);

	if (!block)
		pass->out_of_memory = true;
	return block;
}

#endif
