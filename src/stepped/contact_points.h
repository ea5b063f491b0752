/* SPDX-License-Identifier: MIT */
/*
 * Points at which bodies could touch within a step: spheres on spheres and planes in closed form,
 * all else by geom/manifold, part by part.
 *
 * A point's name (constraint/contact_name) finds the impulse of the last step, or the force that
 * another method has left. Points are in the order of pairs, whatever the number of threads.
 */
#ifndef RB_STEPPED_CONTACT_POINTS_H
#define RB_STEPPED_CONTACT_POINTS_H

#include "constraint/contact_name.h"
#include "stepped/candidates.h"
#include "stepped/levers.h"

struct rb_step_point {
	int a, b; /* indices of the model, a < b, except that a driven body is b: a is dynamic */
	uint32_t parts; /* as in its name: that of the lower index first */
	bool central;
	bool rolls;        /* the lowest point of a rim, which moves along it */
	bool rolls_to;     /* another point of that rim, which it reaches: no impact of its own */
	bool after_impact; /* the step's impulse was reported as an impact */
	uint64_t key;      /* as in its name */
	uint32_t pair;     /* index of the candidate pair */
	uint32_t from;     /* 1 + index in `last` of its warm-start impulse; 0: none */
	rb_vec3 normal;    /* unit, from a to b */
	/* m, from the centres of mass; central: x is the length along the normal */
	rb_vec3 arm_a, arm_b;
	double gap; /* m, at the beginning of the step */
	/* m: nonlinear part of the gap at the end of the step; 0 unless it was computed */
	double bend;
	const struct rb_pair_material *material; /* friction and restitution */
	/* m/s: approach speed at the beginning of the step, before its forces */
	double approach;
	double normal_impulse;    /* N s */
	rb_vec3 friction_impulse; /* N s, on b */
	/*
	 * m, from a's centre of mass: where the solution applied these impulses; central: not set
	 */
	rb_vec3 lever;
};

_Static_assert(sizeof(struct rb_step_point) == 192, "there may be ten for each body");

/* The warm start of a point for the next step; names as in struct rb_step_point. */
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
	int *chosen; /* owned: indices of points, see rb_step_points_choose */
	size_t chosen_count, chosen_capacity;
	struct rb_named_impulse *last; /* owned, in the order of points */
	size_t last_count, last_capacity;
	bool joins_arms;    /* angular momentum must be conserved: stepped/levers */
	size_t *first_last; /* owned, [bodies + 1]: index in `last` of each a */
	/*
	 * owned, [bodies]: whether contacts had forces on it in the last step, so that it is in
	 * `last`
	 */
	unsigned char *held;
	int body_count;
};

/* Its name, without `half`. */
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

/* Sorts points by pair, after several additions; the points of one pair were added at once. */
RB_CHECKED enum rb_status rb_step_points_sort(struct rb_step_points *points, struct rb_arena *arena,
                                              struct rb_error *err);

/*
 * Chooses the points with a normal impulse whose approach exceeds `approach`, m/s; -INFINITY: all
 * with an impulse. In their order.
 */
RB_CHECKED enum rb_status rb_step_points_choose(struct rb_step_points *points,
                                                struct rb_world *world, double approach,
                                                struct rb_error *err);

/*
 * Keeps the impulses of chosen points after an accepted step; to be indexed then. Bodies marked in
 * `asleep` keep the forces that they started from; those in `sleeps` (NULL: none) have no points
 * and keep their entries.
 */
RB_CHECKED enum rb_status rb_step_points_keep(struct rb_step_points *points,
                                              const struct rb_world *world, double h_s,
                                              const unsigned char *asleep,
                                              const unsigned char *sleeps, struct rb_error *err);
/*
 * The same in two parts, of which only the first can fail (NULL: no memory): space in the arena,
 * then its use.
 */
struct rb_named_impulse *rb_step_points_space(struct rb_step_points *points,
                                              const struct rb_world *world, bool sleeping);
void rb_step_points_keep_in(struct rb_step_points *points, const struct rb_world *world, double h_s,
                            const unsigned char *asleep, const unsigned char *sleeps,
                            struct rb_named_impulse *space);

/*
 * Takes the forces that another method has left as the warm start of the next step: each point has
 * the force of its own name. Points of a flat rim may be numbered differently: those without a name
 * there get the mean force of the rim's points.
 */
RB_CHECKED enum rb_status rb_step_points_take_over(struct rb_step_points *points,
                                                   struct rb_world *world, struct rb_error *err);

/* Builds the index by body after `last` has changed. */
void rb_step_points_index(struct rb_step_points *points, const struct rb_model *model);
/* The same for these bodies only, ascending; others are not looked up. */
void rb_step_points_index_members(struct rb_step_points *points, const int *member, int count);
/* Reserves `count` entries in `last`; false: no memory. */
bool rb_step_points_reserve(struct rb_step_points *points, size_t count);
/* Copies the warm-start impulses of these bodies, ascending; space has been reserved. */
void rb_step_points_take_last(struct rb_step_points *points, const struct rb_step_points *from,
                              const int *member, int count);

#endif
