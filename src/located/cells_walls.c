/* SPDX-License-Identifier: MIT */
/* When bodies leave their cells: the walls of located/cells, with their hysteresis. */
#include "located/cells.h"

#include "located/cells_inside.h"
#include "base/error.h"

#include <math.h>

/*
 * Time of leaving a cell along one axis, s; `*high` is 1 at the upper wall. x is the distance from
 * the cell's middle, and the body leaves at |x| = reach. With u the speed, b the acceleration in
 * the direction of motion and d > 0 the distance ahead, u t + b t^2 / 2 = d has the first root 2 d
 * / (u + sqrt(u^2 + 2 b d)); if there is none, the body reverses and reaches the wall behind it, at
 * -c, at the second root of u t + b t^2 / 2 = -c, which is (u + sqrt(u^2 - 2 b c)) / -b. All sums
 * are of numbers of one sign, except under the first root: there rounding decides whether a body
 * that almost reverses at the wall leaves, and either is right.
 */
static double exit_time(double reach, double x, double v, double a, int *high)
{
	const double sign = copysign(1, v == 0 ? a : v);
	const double ahead = reach - sign * x, u = fabs(v), b = sign * a;

	*high = sign > 0;
	if (a == 0)
		return (ahead > 0 ? ahead : 0) / u;
	if (ahead <= 0)
		return 0;
	const double square = u * u + 2 * b * ahead;

	if (square >= 0)
		return 2 * ahead / (u + sqrt(square));
	*high = sign < 0;
	return (u + sqrt(fmax(0, u * u - 2 * b * (reach + sign * x)))) / -b;
}

/* The earliest wall so far: seconds until then, and its number; -1: none. */
struct exit {
	double s;
	int wall;
};

/* True in the outermost cells, which bodies do not leave. */
static bool is_last(int64_t at)
{
	return (at <= -farthest) | (at >= farthest);
}

/* Distance of x from the middle of a cell along one axis, m. */
static inline double off_middle(const struct level *level, int64_t at, double x)
{
	return x - ((double)at + 0.5) * level->edge;
}

/* Offers the walls of one axis to a body with acceleration. */
static void offer_accelerated(struct exit *exit, const struct level *level, int64_t at,
                              const double xva[3], int wall)
{
	const double off = off_middle(level, at, xva[0]);
	int high;
	const double s = exit_time(level->reach, off, xva[1], xva[2], &high);

	if (s < exit->s && !is_last(at))
		*exit = (struct exit){s, wall + high};
}

/* Time to the wall ahead without acceleration, s. */
static inline double straight_time(const struct level *level, int64_t at, double x, double v)
{
	const double off = off_middle(level, at, x);
	const double ahead = level->reach - copysign(1, v) * off;

	return (ahead > 0 ? ahead : 0) / fabs(v); /* 0 / 0 is never */
}

/*
 * Offers all walls to a body without acceleration, the most frequent case in a gas. Branch-free:
 * directions are random, and a mispredicted branch costs more than all of this.
 */
static inline void offer_straight(struct exit *exit, const struct level *level,
                                  const struct entry *entry, const double x[3], const double v[3],
                                  int number)
{
	const double never = (double)INFINITY;
	const double s0 = straight_time(level, entry->at[0], x[0], v[0]);
	const double s1 = straight_time(level, entry->at[1], x[1], v[1]);
	const double s2 = straight_time(level, entry->at[2], x[2], v[2]);
	const double first = s0 < never ? s0 : never;
	const bool second = s1 < first;
	const double both = s1 < first ? s1 : first;
	const bool third = s2 < both;
	const double all = s2 < both ? s2 : both;
	const int axis = 2 * third + (second & !third);
	const int high = (v[0] > 0) | (v[1] > 0) << 1 | (v[2] > 0) << 2;

	if (all < exit->s)
		*exit = (struct exit){all, number + 2 * axis + (high >> axis & 1)};
}

double rb_cells_leaves(const struct rb_cells *cells, int body, rb_vec3 position, rb_vec3 velocity,
                       rb_vec3 acceleration, int *wall)
{
	RB_ASSERT(body >= 0 && body < cells->count);
	const double x[3] = {position.x, position.y, position.z};
	const double v[3] = {velocity.x, velocity.y, velocity.z};
	const double a[3] = {acceleration.x, acceleration.y, acceleration.z};
	const bool flies = (a[0] == 0) & (a[1] == 0) & (a[2] == 0);
	const struct entry *entry = entries_of(cells, body);
	const int own = own_level(cells, body);
	struct exit exit = {(double)INFINITY, -1};

	for (int l = own; l < cells->level_count; l++, entry++) {
		const struct level *level = &cells->levels[l];
		const int64_t *at = entry->at;
		const int number = WALLS * (l - own);

		if (flies && !((int)is_last(at[0]) | (int)is_last(at[1]) | (int)is_last(at[2]))) {
			offer_straight(&exit, level, entry, x, v, number);
			continue;
		}
		for (int k = 0; k < 3; k++)
			offer_accelerated(&exit, level, at[k], (double[]){x[k], v[k], a[k]},
			                  number + 2 * k);
	}
	*wall = exit.wall;
	return exit.s;
}

/*
 * Time for which |x| stays within `reach` along one axis under any acceleration up to `a_max`, s:
 * the root of u t + a_max t^2 / 2 = d for the wall at distance d, with u the speed towards it.
 */
static double time_inside_along(double reach, double x, double v, double a_max, int *high)
{
	double least = (double)INFINITY;

	for (int k = 0; k < 2; k++) {
		const double sign = k == 0 ? -1 : 1, u = sign * v;
		const double ahead = fmax(0, reach - sign * x);
		const double root = sqrt(u * u + 2 * a_max * ahead);
		double s = (double)INFINITY;

		if (u > 0)
			s = 2 * ahead / (u + root);
		else if (a_max > 0)
			s = (root - u) / a_max;
		if (s < least) {
			least = s;
			*high = k;
		}
	}
	return least;
}

double rb_cells_time_inside(const struct rb_cells *cells, int body, rb_vec3 position,
                            rb_vec3 velocity, rb_vec3 acceleration_max, int *wall)
{
	RB_ASSERT(body >= 0 && body < cells->count);
	const double x[3] = {position.x, position.y, position.z};
	const double v[3] = {velocity.x, velocity.y, velocity.z};
	const double a[3] = {acceleration_max.x, acceleration_max.y, acceleration_max.z};
	const struct entry *entry = entries_of(cells, body);
	const int own = own_level(cells, body);
	struct exit exit = {(double)INFINITY, -1};

	for (int l = own; l < cells->level_count; l++, entry++) {
		const struct level *level = &cells->levels[l];

		for (int k = 0; k < 3; k++) {
			const double off = off_middle(level, entry->at[k], x[k]);
			int high = 0;
			const double s = time_inside_along(level->reach, off, v[k], a[k], &high);

			if (s < exit.s && !is_last(entry->at[k]))
				exit = (struct exit){s, WALLS * (l - own) + 2 * k + high};
		}
	}
	*wall = exit.wall;
	return exit.s;
}

bool rb_cells_is_at_wall(const struct rb_cells *cells, int body, int wall, rb_vec3 position)
{
	RB_ASSERT(body >= 0 && body < cells->count && wall >= 0);
	const double x[3] = {position.x, position.y, position.z};
	const int own = own_level(cells, body), axis = wall % WALLS / 2;
	const struct level *level = &cells->levels[own + wall / WALLS];
	const struct entry *entry = entries_of(cells, body) + wall / WALLS;
	const double off = off_middle(level, entry->at[axis], x[axis]);

	return (wall % 2 ? off : -off) >= level->edge * (0.5 + 0.5 * hysteresis);
}
