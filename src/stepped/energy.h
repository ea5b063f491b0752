/* SPDX-License-Identifier: MIT */
/*
 * Effect of an island's impulses on its energy: contacts dissipate, and never add.
 *
 * In one step forces change velocities by f, impulses by d, and positions move with the resulting
 * v0 + f + d. The gain of the island's kinetic energy, beyond the work of forces on that
 * displacement and of driven bodies at its contacts, is half of |d|^2 + 2 <v0, d> - |f|^2, with
 * masses and inertias as weights. Impulses that close no gap, separate no overlap and oppose slip
 * make it negative; residuals of solutions and separation may make it positive.
 */
#ifndef RB_STEPPED_ENERGY_H
#define RB_STEPPED_ENERGY_H

#include "stepped/islands.h"

/*
 * Sums over an island, J. For impulses that are s times those found, the gain is (s^2 square + 2 s
 * mixed - lost) / 2.
 */
struct rb_energy {
	double lost;   /* |f|^2 */
	double mixed;  /* <v0, d>, less the work of driven bodies */
	double square; /* |d|^2 */
	double noise;  /* of rounding: a gain below it is insignificant */
};

/*
 * Energy of the present solution relative to the velocities at the beginning of the step. `team`
 * NULL, here as below: on this thread.
 */
struct rb_energy rb_energy_of(const struct rb_solver *solver, const struct rb_island *island,
                              struct rb_team *team, struct rb_arena *arena);

static inline double rb_energy_gain(const struct rb_energy *energy)
{
	return 0.5 * (energy->square + 2 * energy->mixed - energy->lost);
}

/* Largest fraction of the impulses, up to 1, that gains no energy. */
double rb_energy_share(const struct rb_energy *energy);

/* Whether a unilateral row has an impulse. */
bool rb_energy_has_impulse(const struct rb_row_system *dense);
/* Whether overlapping contacts are being separated, or limits and ropes drawn back. */
bool rb_energy_has_separation(const struct rb_row_system *dense);
/* Sets the targets of these to zero. */
void rb_energy_clear_separation(const struct rb_row_system *dense);

/*
 * Whether the size of impulses is consistent with the island's momentum and its targets; held:
 * nothing is separated.
 */
bool rb_energy_bounds(const struct rb_solver *solver, const struct rb_island *island,
                      const struct rb_row_system *dense, bool held, struct rb_team *team,
                      struct rb_arena *arena);

/* Part of a row that solving changes. */
struct rb_saved_row {
	double target_n;
	rb_along_across impulse;
};

/* Saved rows and velocities of an island's solution; in the arena. */
struct rb_saved_solution {
	struct rb_saved_row *row;
	struct rb_solver_body *body; /* by member */
	double driven_work;          /* J */
};

/* False: no memory. */
bool rb_energy_save(const struct rb_solver *solver, const struct rb_island *island,
                    struct rb_arena *arena, struct rb_saved_solution *kept);

/*
 * Largest fraction, up to 1, of the interpolation from the present solution, with energy `now`,
 * back to the kept one that gains no energy.
 */
double rb_energy_interpolation_share(const struct rb_solver *solver, const struct rb_island *island,
                                     const struct rb_energy *now,
                                     const struct rb_saved_solution *kept);

/*
 * Interpolates back by this fraction; an interpolation of two solutions is within the cones, and
 * closes no gap that neither closes.
 */
void rb_energy_interpolate(const struct rb_solver *solver, const struct rb_island *island,
                           const struct rb_saved_solution *kept, double share);

/* Scales all impulses by this fraction; gaps that now close count as residual. */
void rb_energy_scale_impulses(const struct rb_solver *solver, struct rb_island *island,
                              double share);

/*
 * Change of a body's motion by a rebound. A rotating body has turned meanwhile, and keeps the
 * angular momentum that the rebound has given it.
 */
struct rb_solver_body rb_energy_rebound_change(const struct rb_solver *solver,
                                               const struct rb_world *world, int body);

/*
 * Fraction of an island's rebound that gives back no more energy than its contacts have dissipated:
 * friction at an arm could exceed it. The remainder becomes the new budget.
 */
double rb_energy_rebound(const struct rb_solver *solver, const struct rb_world *world,
                         struct rb_island *island);

/* Linear and angular momentum of a body at these velocities, in its pose as the step began. */
struct rb_solver_body rb_energy_momentum_of(const struct rb_solver *solver, int body,
                                            const struct rb_solver_body *motion);

/* Inner product of a momentum and a motion, J: twice the kinetic energy if they belong together. */
static inline double rb_energy_product(const struct rb_solver_body *momentum,
                                       const struct rb_solver_body *motion)
{
	return rb_vec3_dot(momentum->linear, motion->linear) +
	       rb_vec3_dot(momentum->angular, motion->angular);
}

#endif
