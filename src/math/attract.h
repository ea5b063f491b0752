/* SPDX-License-Identifier: MIT */
/*
 * Mutual gravitation of points, pair by pair: attraction with Plummer's softening s (MNRAS 71
 * (1911) 460),
 *
 *     a_i = sum_j mu_j d_ij / (d_ij^2 + s^2)^(3/2),    phi_ij = -mu_j / (d_ij^2 + s^2)^(1/2)
 *
 * for mu = G m. Distances come from positions of twofold precision, and sums carry what rounding
 * leaves of them (Knuth's two-sum; Neumaier, ZAMM 54 (1974) 39): of many bodies they are as exact
 * as of two. Only operations that IEEE 754 rounds exactly, in an order that depends on the order
 * of the points alone: the same bits on every machine.
 *
 * Cost: about 2 ns a pair and direction with two lanes, half of that with four.
 */
#ifndef RB_MATH_ATTRACT_H
#define RB_MATH_ATTRACT_H

#include "math/vec3.h"

struct rb_attract {
	int count;              /* of points */
	double *x[3], *rest[3]; /* m, [count]: position, and what rounding has left of it */
	const double *mu;       /* m^3/s^2, [count], >= 0 */
	const double *inertial; /* kg, [count]: read by rb_attract_energy alone */
	double softening2;      /* m^2 */
};

/*
 * Accelerations of points `first` .. `end` - 1, m/s^2, by all points, themselves and those at the
 * same place left out. acceleration[3][count].
 */
void rb_attract_some(const struct rb_attract *all, int first, int end,
                     double *const acceleration[3]);

/* The same of those points that `list` names, in its order: acceleration[3][count]. */
void rb_attract_listed(const struct rb_attract *all, const int *list, int count,
                       double *const acceleration[3]);

/*
 * Distance at which the strongest of those that attract point i would act as all do, m: the mean of
 * distances, weighted by strength; INFINITY: nothing attracts it. `*depth`: m^2/s^2, its potential,
 * > 0.
 */
double rb_attract_distance(const struct rb_attract *all, int i, double *depth);

/*
 * J: the sum of inertial[i] mu_j phi over pairs of which one attracts. Inertial INFINITY: it does
 * not yield; a pair of two such has no energy. Where m_i mu_j and m_j mu_i differ, the larger
 * counts: as if the other were held.
 */
double rb_attract_energy(const struct rb_attract *all);

/* kg m^3/s^2: of points i and j, the strength of rb_attract_energy. */
double rb_attract_strength(const struct rb_attract *all, int i, int j);

/* d_ij, m; the factor 1/(d^2 + s^2)^(3/2), 0 at the same place. */
rb_vec3 rb_attract_between(const struct rb_attract *all, int i, int j, double *factor);

#endif
