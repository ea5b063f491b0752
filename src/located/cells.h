/* SPDX-License-Identifier: MIT */
/*
 * Who is near a body that moves on its own clock: cells that bodies are moved between as they cross
 * their walls.
 *
 * A level per octave of sizes that occurs: cells of level l have edge `edge(l)` >= 2 x the largest
 * radius of it, and larger where that would leave most cells empty. A body is listed in its own
 * level and in every coarser level that is occupied. Cells are a torus: cell (x, y, z) is found at
 * (x mod nx, y mod ny, z mod nz), with nx, ny, nz powers of two and at least 4, so space has no
 * end; a neighbour that is listed for that reason alone is only one more candidate. Each candidate
 * is listed once. Owned by one thread; what comes out does not depend on threads, and its order is
 * fixed by the history of moves only (callers must not depend on it).
 */
#ifndef RB_LOCATED_CELLS_H
#define RB_LOCATED_CELLS_H

#include <stdbool.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

#include "base/pack.h"

struct rb_cells;

/*
 * Bodies 0 .. count-1 of these radii (> 0; INFINITY: near all others, and never leaving anything)
 * at these positions ([count][3], m). All memory is taken here.
 */
RB_CHECKED enum rb_status rb_cells_create(struct rb_cells **cells, int count, const double *radius,
                                          const double *position, struct rb_error *err);
void rb_cells_destroy(struct rb_cells *cells); /* NULL is fine */

/* 0: so few bodies that all are near each other always, and nobody ever leaves a cell. */
int rb_cells_level_count(const struct rb_cells *cells);

/*
 * Every body whose surface could be within reach of this one's without either leaving its present
 * cells: all that the 27 cells around it hold, on its own level (bodies of this and finer levels
 * listed there) and on each coarser level (bodies of that level). Without itself. Written to `out`,
 * which has room for `rb_cells_max` numbers; returns how many.
 */
int rb_cells_near(const struct rb_cells *cells, int body, int *out);
int rb_cells_max(const struct rb_cells *cells); /* the number of bodies */

/*
 * Hints that change nothing: the body's place will be asked for soon; where it is known, who is
 * near it will be.
 */
void rb_cells_prefetch(const struct rb_cells *cells, int body);
void rb_cells_prefetch_near(const struct rb_cells *cells, int body);

/*
 * When, from now on, a body at `position` with `velocity` and constant `acceleration` first leaves
 * one of its cells (own level and coarser ones): seconds from now, >= 0, INFINITY: never. `*wall`
 * says which wall, for rb_cells_cross;
 * -1: none. Walls are crossed a little late and must be crossed back as much further, so 0, for a
 * body that is behind a
 * wall already, can't come again and again at one moment: each crossing goes on in the direction of
 * the motion. Beyond 1e12 edges from the origin contacts may be missed for lack of digits; beyond
 * 1e15 a body does not change its cell.
 */
double rb_cells_leaves(const struct rb_cells *cells, int body, rb_vec3 position, rb_vec3 velocity,
                       rb_vec3 acceleration, int *wall);

/*
 * Of a body of which only a bound on its acceleration along each axis is known (`acceleration_max`,
 * m/s^2, 0 or more): for so long it does not leave its cells, and `*wall` is what it could come to
 * first. Then rb_cells_is_at_wall says whether it goes through, or this is to be asked again, which
 * brings it nearer by a share of the way each time.
 */
double rb_cells_time_inside(const struct rb_cells *cells, int body, rb_vec3 position,
                            rb_vec3 velocity, rb_vec3 acceleration_max, int *wall);
bool rb_cells_is_at_wall(const struct rb_cells *cells, int body, int wall, rb_vec3 position);

/*
 * The body has come to that wall: it is moved to the cell behind it. Writes those who are near it
 * now and were not before (the 9 cells on the far side on that level) to `out`, which has room as
 * above; returns how many.
 */
int rb_cells_cross(struct rb_cells *cells, int body, int wall, int *out);

/* Walls of all cells of the body have numbers below this one. */
int rb_cells_wall_count(const struct rb_cells *cells, int body);

/* Who is where, in the order in which it will be listed, between cells made for the same bodies. */
void rb_cells_pack(struct rb_cells *cells, struct rb_pack *pack);

/* The body is somewhere else altogether. Afterwards rb_cells_near says who is near. */
void rb_cells_place(struct rb_cells *cells, int body, rb_vec3 position);

#endif
