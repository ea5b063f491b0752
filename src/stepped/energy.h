/* SPDX-License-Identifier: MIT */
/*
 * What a group's impulses do to its energy: contact takes, and never gives.
 *
 * In one step forces change velocities by f, impulses by d, positions move with what that comes to,
 * v0 + f + d. What the group gains in kinetic energy, beyond the work of forces on that way and of
 * driven bodies at its contacts, is the half of
 * |d|^2 + 2 <v0, d> - |f|^2, with masses and inertias for weights. Impulses that close no gap, push
 * no overlap apart and
 * hold against slip make it negative; what solutions leave and pushing apart may not.
 */
#ifndef RB_STEPPED_ENERGY_H
#define RB_STEPPED_ENERGY_H

#include "stepped/islands.h"

/*
 * Sums over a group, J: of impulses that are s times those found, the gain is (s^2 square + 2 s
 * mixed - lost) / 2.
 */
struct rb_energy {
	double lost;   /* |f|^2 */
	double mixed;  /* <v0, d>, less the work of driven bodies */
	double square; /* |d|^2 */
	double noise;  /* of rounding: no gain below it is told from none */
};

/*
 * Of the velocities and impulses that have been solved for, beside those as the step began. `team`
 * NULL, here as below: on this thread.
 */
struct rb_energy rb_energy_of(const struct rb_solver *solver, const struct rb_island *island,
                              struct rb_team *team, struct rb_arena *arena);

static inline double rb_energy_gain(const struct rb_energy *energy)
{
	return 0.5 * (energy->square + 2 * energy->mixed - energy->lost);
}

/* The largest share of the impulses, up to 1, that gains nothing. */
double rb_energy_share(const struct rb_energy *energy);

/* Whether a row that pushes one way has an impulse. */
bool rb_energy_has_impulse(const struct rb_row_system *dense);
/* Whether contacts that overlap, or would, are pushed apart, or limits and ropes drawn back. */
bool rb_energy_has_separation(const struct rb_row_system *dense);
/* They are not any more. */
void rb_energy_clear_separation(const struct rb_row_system *dense);

/*
 * Whether impulses are of a size that the group's momentum, and what it is asked for, can explain;
 * held: nothing is pushed apart.
 */
bool rb_energy_bounds(const struct rb_solver *solver, const struct rb_island *island,
                      const struct rb_row_system *dense, bool held, struct rb_team *team,
                      struct rb_arena *arena);

/* What solving changes in a row. */
struct rb_kept_row {
	double target_n;
	rb_along_across impulse;
};

/* Rows and velocities that a group was solved to; the arena's. */
struct rb_kept {
	struct rb_kept_row *row;
	struct rb_solver_body *body; /* by member */
	double driven_work;          /* J */
};

/* False: no memory. */
bool rb_energy_keep(const struct rb_solver *solver, const struct rb_island *island,
                    struct rb_arena *arena, struct rb_kept *kept);

/*
 * The share, up to 1, of the way back from what is solved now, of that energy, up to which nothing
 * is gained.
 */
double rb_energy_between(const struct rb_solver *solver, const struct rb_island *island,
                         const struct rb_energy *now, const struct rb_kept *kept);

/*
 * Goes so far back; what is between two solutions is in the cones, and closes no gap that neither
 * closes.
 */
void rb_energy_mix(const struct rb_solver *solver, const struct rb_island *island,
                   const struct rb_kept *kept, double share);

/* Goes to so much of all impulses; gaps that now close are residual. */
void rb_energy_take(const struct rb_solver *solver, struct rb_island *island, double share);

/*
 * What a rebound adds to a body's motion: turning bodies have gone on meanwhile, and keep the
 * angular momentum that it has given them.
 */
struct rb_solver_body rb_energy_added(const struct rb_solver *solver, const struct rb_world *world,
                                      int body);

/*
 * Of a group's rebound, the share that does not take more than its contacts have taken: friction at
 * an arm could. The room becomes what is left of it.
 */
double rb_energy_rebound(const struct rb_solver *solver, const struct rb_world *world,
                         struct rb_island *island);

/* Momentum and angular momentum of a body at these velocities, as it stood when the step began. */
struct rb_solver_body rb_energy_weigh(const struct rb_solver *solver, int body,
                                      const struct rb_solver_body *motion);

/* Twice the kinetic energy of a momentum and a motion taken together, J. */
static inline double rb_energy_product(const struct rb_solver_body *momentum,
                                       const struct rb_solver_body *motion)
{
	return rb_vec3_dot(momentum->linear, motion->linear) +
	       rb_vec3_dot(momentum->angular, motion->angular);
}

#endif
