/* SPDX-License-Identifier: MIT */
/*
 * Pairs that could touch, from boxes fat enough for several steps.
 *
 * Owned by the method's state. The candidates hold until a body could leave its box; their boxes
 * decide cost only, but for the order in which ties are met, which is by pair. The first of a pair
 * yields; a driven one is always the second.
 */
#ifndef RB_STEPPED_CANDIDATES_H
#define RB_STEPPED_CANDIDATES_H

#include "geom/core.h"
#include "model/parts.h"
#include "step/broadphase.h"
#include "world/world.h"

#define RB_NO_CLUES UINT32_MAX

/* Numbers of poses go on from 0 after it. */
#define RB_PLACING_MAX 0x7fffffffu

/* What is known of two parts from the look before; decides cost only. */
struct rb_clue {
	rb_vec3 axis;      /* the direction in which it was told apart, or touches; zero: none */
	double gap, faces; /* m: if `is_known`, of rb_separation_of along the axis */
	unsigned placing_a : 31; /* of that pose */
	unsigned is_known : 1;
	unsigned placing_b : 31;
	unsigned is_close : 1; /* it was not told apart */
};

_Static_assert(sizeof(struct rb_clue) == 48, "there may be thirteen for each body");

struct rb_candidates {
	bool valid;
	rb_vec3 *built_at; /* [bodies] m: the objects' origins when the boxes were made */
	double *margin;    /* [bodies] m: how far each may get from there */
	rb_quat *
		built_turn; /* [bodies]: how driven planes were turned then; NULL: none is driven */
	double *turn_margin; /* [bodies] rad: by how much more these may be */
	/* [bodies] m: how far each gets in the step under way, if nothing touches it */
	double *reach;
	rb_aabb *box; /* [bodies] the arena's: while pairs are looked for */
	double h_s;   /* of that step */
	double share; /* of bodies that move: where these are few, their boxes are made to last */
	const struct rb_pair *pair; /* borrowed from the broadphase, or `own` */
	size_t pair_count;
	/* borrowed: of these pairs, ascending, those to be looked at; NULL: all */
	const uint32_t *live;
	size_t live_count;
	/*
	 * m: overlap of each pair when it was last measured, as `pair`; negative: it is no more
	 * than that; NAN: not measured yet, or not as it stands now
	 */
	double *depth, *own_depth;
	/*
	 * Of pairs with parts, m: as long as their bodies' `path` together is shorter, they are
	 * apart by the difference.
	 */
	double *clearance, *own_clearance;
	size_t depth_capacity, bounds_capacity;
	double resting_depth; /* m: the largest of pairs that are not live; NAN: not known */
	/*
	 * Of scenes with parts: what geometry is asked about. Whoever looks at a pair may write its
	 * clues.
	 */
	struct rb_clue *clue; /* of each two parts of the pairs that came close, as they did */
	uint32_t clue_count;  /* of these; counted by all */
	uint32_t *first_clue; /* [pair_count], as `pair`; RB_NO_CLUES: it has none yet */
	uint32_t *own_first_clue;
	size_t clue_capacity, first_clue_capacity;
	int *first_part;   /* [bodies and statics + 1] into `placed` */
	rb_placed *placed; /* where parts stand: rb_candidates_place */
	rb_vec3 *at;       /* [bodies and statics] m: their origins, as the parts stand */
	rb_quat *turn;     /* [bodies] so are they turned */
	/* [bodies and statics] number of that pose, of 31 bits, another one each time */
	uint32_t *placing;
	/* [bodies and statics] m: how far points of each have got at most, through all placings */
	double *path;
	/* [bodies and statics] m: no point is farther from there; infinite planes: INFINITY */
	double *size;
	/* [bodies and statics] m: how far points of each may get in the step, turning too */
	double *ahead;
	struct rb_pair *
		/*
		 * owned: rb_candidates_keep; where bodies are driven: pairs in which the first
		 * yields
		 */
		own;
	size_t own_capacity;
};

static inline size_t rb_candidates_live_count(const struct rb_candidates *candidates)
{
	return candidates->live ? candidates->live_count : candidates->pair_count;
}

/* The pair that is the k-th of those to be looked at. */
static inline size_t rb_candidates_live(const struct rb_candidates *candidates, size_t k)
{
	return candidates->live ? candidates->live[k] : k;
}

RB_CHECKED enum rb_status rb_candidates_create(struct rb_candidates *candidates,
                                               const struct rb_model *model, struct rb_error *err);
void rb_candidates_release(struct rb_candidates *candidates);

/*
 * Reaches of these bodies: the world's velocities have the forces of the step in them, those of the
 * mark do not.
 */
void rb_candidates_reach(struct rb_candidates *candidates, const struct rb_world *world, double h_s,
                         const int *member, int count);

/*
 * Candidates of the whole world, whose reaches are known, if those of before do not hold for these
 * bodies; all others have not moved since. New ones are all live.
 */
RB_CHECKED enum rb_status rb_candidates_find(struct rb_candidates *candidates,
                                             struct rb_world *world, const int *body, int count,
                                             struct rb_error *err);

/* Whether each of these is still within its margin; NaN is not. */
bool rb_candidates_holds(const struct rb_candidates *candidates, const struct rb_world *world,
                         const int *body, int count);

/* Nothing is known of the pairs as they stand, in this order. */
RB_CHECKED enum rb_status rb_candidates_forget(struct rb_candidates *candidates,
                                               const struct rb_model *model, struct rb_error *err);

/* Room for those of a pair, about which nothing is known. */
void rb_candidates_add_clues(struct rb_candidates *candidates, size_t k);

static inline struct rb_clue *rb_candidates_clues(struct rb_candidates *candidates, size_t k)
{
	if (candidates->first_clue[k] == RB_NO_CLUES)
		rb_candidates_add_clues(candidates, k);
	return &candidates->clue[candidates->first_clue[k]];
}

static inline int rb_candidates_part_count(const struct rb_candidates *candidates, int i)
{
	return candidates->first_part[i + 1] - candidates->first_part[i];
}

/* Whether the parts of a body are searched anew each time: what is known of them is not kept. */
static inline bool rb_candidates_is_terrain(const struct rb_model *model, int i)
{
	return model->shape[i].kind == RB_SHAPE_TERRAIN;
}

/* Parts of a pair's second body that come within `within` of a part of the first, m. */
static inline void rb_candidates_near(struct rb_near_parts *near, const struct rb_model *model,
                                      int b, const rb_placed *part, double within)
{
	const struct rb_body_parts *const parts = rb_model_parts(model, b);

	/* others are all looked at, wherever they are */
	if (!parts->terrain)
		rb_near_parts_all(near, parts);
	else
		rb_near_parts_begin(near, parts, model->position[b], model->orientation[b],
		                    part->at, within + part->core->reach + part->core->radius);
}

/*
 * Parts of these bodies as they stand now, and what their turning may add: before touch is asked
 * about them.
 */
void rb_candidates_place(struct rb_candidates *candidates, struct rb_world *world, const int *body,
                         int count);

/* m: how far the object's origin gets at most in a step of h_s, at the speeds of that state. */
double rb_candidates_way(const struct rb_world *world, const struct rb_state *state, int i,
                         double h_s);
/* What `ahead` of a body becomes, if there are parts. */
void rb_candidates_turn(struct rb_candidates *candidates, const struct rb_world *world, int i);

/* Pairs that could touch while every body's origin stays within its room. */
RB_CHECKED enum rb_status rb_candidates_pairs(struct rb_candidates *candidates,
                                              struct rb_world *world, const rb_aabb *bounds,
                                              struct rb_error *err);

/* The candidates stay although the broadphase is asked for others; false: no memory. */
bool rb_candidates_keep(struct rb_candidates *candidates);

/* m: no point of a body that moves is farther from its origin; infinite planes: 0. */
double rb_candidates_size(const struct rb_model *model, int i);

#endif
