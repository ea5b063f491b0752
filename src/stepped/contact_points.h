/* SPDX-License-Identifier: MIT */
/*
 * Points at which bodies could touch within a step: of spheres among themselves and on planes by
 * closed forms, of all else through geom/manifold, part by part.
 *
 * A point has a name (constraint/contact_name) by which the impulse of the step before, or the
 * force that another method has found, is found again. Points come in order of pairs, whatever the
 * threads.
 */
#ifndef RB_STEPPED_CONTACT_POINTS_H
#define RB_STEPPED_CONTACT_POINTS_H

#include "constraint/contact_name.h"
#include "stepped/candidates.h"
#include "stepped/levers.h"

struct rb_step_point {
	int a, b;       /* indices of the model, a < b, but a driven body is b: a moves */
	uint32_t parts; /* as in its name, the body of the lower index first */
	bool central;
	bool rolls;        /* at the lowest point of a rim, which goes round it */
	bool rolls_to;     /* another point of that rim, to which it goes: no impact of its own */
	bool after_impact; /* what the step's solution has applied has been told as an impact */
	uint64_t key;      /* as in its name */
	uint32_t pair;     /* among the candidates */
	uint32_t from;     /* 1 + the place in `last` of what it started from; 0: of nothing */
	rb_vec3 normal;    /* unit, from a to b */
	rb_vec3 arm_a,
		arm_b; /* m, from the centres of mass; central: x is the length along the normal */
	double gap;    /* m, at the beginning of the step */
	/* m: more of a gap by the end than straight ways make it; 0 unless it was looked for */
	double bend;
	const struct rb_pair_material *material; /* of friction and restitution */
	/* m/s: towards each other at the beginning of the step, before its forces */
	double approach;
	double normal_impulse;    /* N s */
	rb_vec3 friction_impulse; /* N s, on b */
	/* m, from a's centre of mass: where the solution has applied these; central: not set */
	rb_vec3 lever;
};

_Static_assert(sizeof(struct rb_step_point) == 192, "there may be ten for each body");

/* What of a point the next step starts from; its name as of struct rb_step_point. */
#define RB_NAMED_IMPULSE_FIELDS(X)                                             \
	X(int, a, , "", "index of a body that moves", RB_UP_TO(RB_LIMIT_BODY)) \
	X(int, b, , "", "body index", RB_UP_TO(RB_LIMIT_ANY_BODY))             \
	X(uint32_t, parts, , "", "of its name", RB_ANY_BITS)                   \
	X(uint64_t, key, , "", "of its name", RB_ANY_BITS)                     \
	X(double, force, , "N", "along the normal", RB_FINITE)                 \
	X(rb_vec3, friction_impulse, , "N", "on b", RB_FINITE)
struct rb_named_impulse {
	RB_NAMED_IMPULSE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_named_impulse_fields);

struct rb_step_points {
	struct rb_step_point *row; /* owned */
	size_t count, capacity;
	int *chosen; /* owned: numbers of points, see rb_step_points_choose */
	size_t chosen_count, chosen_capacity;
	struct rb_named_impulse *last; /* owned, in the order of points */
	size_t last_count, last_capacity;
	bool joins_arms;    /* angular momentum is to stay: stepped/levers */
	size_t *first_last; /* owned, [bodies + 1]: of each a in `last` */
	/* owned, [bodies]: whether contacts had forces on it in the step before: it is in `last` */
	unsigned char *held;
	int body_count;
};

/* Its name, without half. */
static inline struct rb_contact_name rb_step_point_name(const struct rb_step_point *point)
{
	const bool in_order = point->a < point->b;

	return (struct rb_contact_name){.a = in_order ? point->a : point->b,
	                                .b = in_order ? point->b : point->a,
	                                .parts = point->parts,
	                                .key = point->key};
}

RB_CHECKED enum rb_status rb_step_points_create(struct rb_step_points *points,
                                                const struct rb_model *model, struct rb_error *err);
void rb_step_points_release(struct rb_step_points *points);

/*
 * Adds those of the candidates that are live; velocities as for rb_candidates_find. Warm impulses
 * are for a step of h_s. What is farther apart than `most`, m, is left out.
 */
RB_CHECKED enum rb_status rb_step_points_add(struct rb_step_points *points, struct rb_world *world,
                                             struct rb_candidates *candidates, double h_s,
                                             double max, struct rb_error *err);

/* In order of pairs, after several have been added; the points of one were added at once. */
RB_CHECKED enum rb_status rb_step_points_sort(struct rb_step_points *points, struct rb_arena *arena,
                                              struct rb_error *err);

/*
 * Chooses the points that bear something and have approached by more than this, m/s; -INFINITY:
 * all that bear something. In their order.
 */
RB_CHECKED enum rb_status rb_step_points_choose(struct rb_step_points *points,
                                                struct rb_world *world, double approach,
                                                struct rb_error *err);

/*
 * Keeps the impulses of the points chosen, in a step that has been accepted; to be indexed then.
 * Bodies, by mark: of those that stay, forces are the ones they started from; those that stand
 * (NULL: none do) have no points, and keep what they have.
 */
RB_CHECKED enum rb_status rb_step_points_keep(struct rb_step_points *points,
                                              const struct rb_world *world, double h_s,
                                              const unsigned char *asleep,
                                              const unsigned char *sleeps, struct rb_error *err);
/*
 * The same in two parts, of which only the first can fail (NULL: no memory): space for them in the
 * arena, and it is used.
 */
struct rb_named_impulse *rb_step_points_space(struct rb_step_points *points,
                                              const struct rb_world *world, bool sleeping);
void rb_step_points_keep_in(struct rb_step_points *points, const struct rb_world *world, double h_s,
                            const unsigned char *asleep, const unsigned char *sleeps,
                            struct rb_named_impulse *space);

/*
 * What the next step starts from is what another method has found: each point has the force of its
 * own name. Points of a rim that lies flat may be counted from elsewhere: each that has no name
 * there has the mean force of the rim's points.
 */
RB_CHECKED enum rb_status rb_step_points_take_over(struct rb_step_points *points,
                                                   struct rb_world *world, struct rb_error *err);

/* After `last` has changed. */
void rb_step_points_index(struct rb_step_points *points, const struct rb_model *model);
/* The same for what only these bodies, ascending, are asked about. */
void rb_step_points_index_members(struct rb_step_points *points, const int *member, int count);
/* Room for so many in `last`; false: no memory. */
bool rb_step_points_reserve(struct rb_step_points *points, size_t count);
/* Impulses of the step before of these bodies, ascending, for whose number there is room. */
void rb_step_points_take_last(struct rb_step_points *points, const struct rb_step_points *from,
                              const int *member, int count);

#endif
