/* SPDX-License-Identifier: MIT */
/*
 * Broad phase for bodies that each move on their own clock: a hierarchical grid of cells, between
 * which bodies are moved as they cross cell walls.
 *
 * There is a level per octave of sizes that occurs: cells of level l have edge `edge(l)` >= 2 x its
 * largest radius, and larger where that would leave most cells empty. A body is listed in its own
 * level and in every coarser level that is occupied. Cells are a torus: cell (x, y, z) is stored at
 * (x mod nx, y mod ny, z mod nz), with nx, ny, nz powers of two and at least 4, so space is
 * unbounded; a neighbour due to wrapping is only one more candidate. Each candidate is listed once.
 * Owned by one thread; results do not depend on threads, and their order depends on the history of
 * moves only (callers must not depend on it).
 */
#ifndef RB_LOCATED_CELLS_H
#define RB_LOCATED_CELLS_H

#include <stdbool.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

#include "base/pack.h"

struct rb_cells;

/*
 * Bodies 0 .. count-1 with these radii (> 0; INFINITY: near all others, never leaves a cell) at
 * these positions ([count][3], m). All memory is allocated here.
 */
RB_CHECKED enum rb_status rb_cells_create(struct rb_cells **cells, int count, const double *radius,
                                          const double *position, struct rb_error *err);
void rb_cells_destroy(struct rb_cells *cells); /* NULL is fine */

/* Number of levels; 0: so few bodies that all are always candidates and there are no walls. */
int rb_cells_level_count(const struct rb_cells *cells);

/*
 * Candidate pairs of a body: all bodies in the 27 cells around it, on its own level (bodies of this
 * and finer levels listed there) and on each coarser level (bodies of that level), without itself.
 * Bodies beyond cannot touch it until one of the two leaves its cells. Written to `out`, which has
 * room for `rb_cells_max` numbers; returns their number.
 */
int rb_cells_near(const struct rb_cells *cells, int body, int *out);
int rb_cells_max(const struct rb_cells *cells); /* the number of bodies */
/* Those of them that list each pair once, for one of the two bodies. */
int rb_cells_near_once(const struct rb_cells *cells, int body, int *out);

/*
 * Prefetch hints without effect on results: the body's cells will be read soon; after that, its
 * candidates.
 */
void rb_cells_prefetch(const struct rb_cells *cells, int body);
void rb_cells_prefetch_near(const struct rb_cells *cells, int body);

/*
 * Time until a body at `position` with `velocity` and constant `acceleration` first leaves one of
 * its cells (own level and coarser ones): s, >= 0, INFINITY: never. `*wall` is the number of the
 * wall for rb_cells_cross; -1: none. A wall is crossed a little beyond it and must be crossed back
 * as far on the other side, so the result 0, for a body that is already behind a wall, cannot
 * repeat without end at one time: each crossing follows the direction of motion. Beyond 1e12 edges
 * from the origin contacts may be missed for lack of digits; beyond 1e15 a body does not change its
 * cell.
 */
double rb_cells_leaves(const struct rb_cells *cells, int body, rb_vec3 position, rb_vec3 velocity,
                       rb_vec3 acceleration, int *wall);

/*
 * The same for a body of which only a bound on the acceleration along each axis is known
 * (`acceleration_max`, m/s^2, >= 0): a time for which it certainly stays in its cells, and in
 * `*wall` the wall that it could reach first. After that time rb_cells_is_at_wall tells whether it
 * crosses; if not, call this again: each time the rest of the way shrinks by a factor.
 */
double rb_cells_time_inside(const struct rb_cells *cells, int body, rb_vec3 position,
                            rb_vec3 velocity, rb_vec3 acceleration_max, int *wall);
bool rb_cells_is_at_wall(const struct rb_cells *cells, int body, int wall, rb_vec3 position);

/*
 * Moves a body that has reached that wall to the cell behind it. Writes its new candidates (from
 * the 9 cells on the far side on that level) to `out`, which has room as above; returns their
 * number.
 */
int rb_cells_cross(struct rb_cells *cells, int body, int wall, int *out);

/* Upper bound of the wall numbers of a body. */
int rb_cells_wall_count(const struct rb_cells *cells, int body);

/* Packs the cells' members, in order; loading needs cells created for the same bodies. */
void rb_cells_pack(struct rb_cells *cells, struct rb_pack *pack);

/* Moves a body to any position; its candidates are then those of rb_cells_near. */
void rb_cells_place(struct rb_cells *cells, int body, rb_vec3 position);

#endif
