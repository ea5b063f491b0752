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

struct rb_gravitation {
	const struct rb_model *model;
	struct rb_attract all;   /* statics are placed, all others by rb_gravitation_place */
	double *acceleration[3]; /* m/s^2, by index: of rb_gravitation_find */
	double *block;           /* owned */
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

/* Accelerations of all moving bodies, from where all are. */
void rb_gravitation_find(struct rb_gravitation *gravitation);
/* The same, to the bit, by a team, which shares the bodies where there are many. */
void rb_gravitation_find_by(struct rb_gravitation *gravitation, struct rb_team *team);
/* Of one of them as found; m/s^2. */
static inline rb_vec3 rb_gravitation_found(const struct rb_gravitation *gravitation, int i)
{
	double *const *const a = gravitation->acceleration;

	return (rb_vec3){a[0][i], a[1][i], a[2][i]};
}

/*
 * Forces of a pair beside those that its energy has (rb_attract_energy), on i, N: where what they
 * attract by is not their mass, action is not reaction. Zero otherwise.
 */
rb_vec3 rb_gravitation_surplus(const struct rb_gravitation *gravitation, int i, int j);

/* Acceleration on a body's surface by the strongest that could touch it, m/s^2: an upper bound. */
double rb_gravitation_weight(const struct rb_model *model);

#endif
