/* SPDX-License-Identifier: MIT */
/*
 * Mutual gravitation of a model's bodies: the rows that math/attract works on, of all bodies by
 * index, statics and driven ones too. Bodies attract and are attracted at their centres of mass,
 * whatever their shape: there is no torque.
 *
 * Whoever makes one owns it; one thread at a time.
 */
#ifndef RB_FORCE_GRAVITATION_H
#define RB_FORCE_GRAVITATION_H

#include <rbsim/model.h>

#include "base/team.h"
#include "math/attract.h"
#include "math/tree.h"

/*
 * Products of the numbers of those attracted and of those that attract, from which on steps use a
 * tree: that of 1536 bodies, for which it takes less than half of the time of all pairs.
 */
#define RB_GRAVITATION_PAIRS_MAX (1536.0 * 1536.0)

struct rb_gravitation {
	const struct rb_model *model;
	struct rb_attract all;   /* statics are placed, all others by rb_gravitation_place */
	double *acceleration[3]; /* m/s^2, by index: of rb_gravitation_find */
	double *block;           /* owned */
	/* of steps alone; NULL: pair by pair */
	struct rb_tree *tree;  /* owned */
	double *tree_block;    /* owned: the rows below */
	double *potential;     /* m^2/s^2, by index: of the tree's last sums */
	double *free_strength; /* m^3/s^2, by index: of those that yield */
	double *seen[3];       /* m/s^2, by index: accelerations of rb_gravitation_energy */
};

/* RB_ERR_MEMORY, or RB_OK: also where the model has no gravitation, and nothing is made. */
RB_CHECKED enum rb_status rb_gravitation_create(struct rb_gravitation *made,
                                                const struct rb_model *model, struct rb_error *err);
/* Safe on a zeroed one. */
void rb_gravitation_release(struct rb_gravitation *gravitation);

/* Is this moving body one that yields and is attracted by some other? */
static inline bool rb_gravitation_attracts(const struct rb_model *model, int i)
{
	return model->attraction && model->inverse_mass[i] > 0 &&
	       model->attractor_count > (model->attraction[i] > 0);
}

/* Centre of mass of a moving body, m, and what rounding has left of it. */
static inline void rb_gravitation_place(struct rb_gravitation *gravitation, int i, rb_vec3 position,
                                        rb_vec3 rest)
{
	struct rb_attract *const all = &gravitation->all;

	all->x[0][i] = position.x;
	all->x[1][i] = position.y;
	all->x[2][i] = position.z;
	all->rest[0][i] = rest.x;
	all->rest[1][i] = rest.y;
	all->rest[2][i] = rest.z;
}

static inline rb_vec3 rb_gravitation_position(const struct rb_gravitation *gravitation, int i)
{
	const struct rb_attract *const all = &gravitation->all;

	return (rb_vec3){all->x[0][i], all->x[1][i], all->x[2][i]};
}

/*
 * Do steps sum by a tree? With many bodies, unless 'opening_angle' is 0, and where every free body
 * attracts by its mass or not at all, so that there is an energy.
 */
bool rb_gravitation_by_tree(const struct rb_model *model);
/* Makes the tree, if there is to be one. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_gravitation_plant(struct rb_gravitation *gravitation,
                                               struct rb_error *err);

/* Accelerations of all moving bodies, from where all are, pair by pair. */
void rb_gravitation_find(struct rb_gravitation *gravitation);
/* The same for a step, by the tree if there is one; the result does not depend on the team. */
RB_CHECKED enum rb_status rb_gravitation_sum(struct rb_gravitation *gravitation,
                                             struct rb_team *team, struct rb_error *err);
/* The same, to the bit, by a team, which shares the bodies where there are many. */
void rb_gravitation_find_by(struct rb_gravitation *gravitation, struct rb_team *team);
/* Of one of them as found; m/s^2. */
static inline rb_vec3 rb_gravitation_found(const struct rb_gravitation *gravitation, int i)
{
	double *const *const a = gravitation->acceleration;

	return (rb_vec3){a[0][i], a[1][i], a[2][i]};
}

/* What a tree's sums are wrong by, from bodies for which all pairs are summed; else zeros. */
struct rb_gravitation_error {
	double acceleration; /* the largest difference as a share of the acceleration */
	double potential;    /* ... of the potential: an estimate of the energy's own */
};

/*
 * J: potential energy, zero apart at infinity (rb_attract_energy). By the tree if there is one:
 * then `*error` is of RB_GRAVITATION_SAMPLE bodies chosen at random by `draw`.
 */
enum { RB_GRAVITATION_SAMPLE = 64 };
RB_CHECKED enum rb_status rb_gravitation_energy(struct rb_gravitation *gravitation,
                                                struct rb_team *team, uint64_t draw, double *energy,
                                                struct rb_gravitation_error *error,
                                                struct rb_error *err);

/*
 * Forces of a pair beside those that its energy has (rb_attract_energy), on i, N: where what they
 * attract by is not their mass, action is not reaction. Zero otherwise.
 */
rb_vec3 rb_gravitation_surplus(const struct rb_gravitation *gravitation, int i, int j);

/* Acceleration on a body's surface by the strongest that could touch it, m/s^2: an upper bound. */
double rb_gravitation_weight(const struct rb_model *model);

#endif
