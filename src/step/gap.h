/* SPDX-License-Identifier: MIT */
/*
 * Signed gaps of pairs, by a table of shape kinds.
 *
 * A new shape adds its row to the tables in gap.c. `a` is the lower body index, hence a moving
 * body.
 */
#ifndef RB_STEP_GAP_H
#define RB_STEP_GAP_H

#include "step/stage.h"

/* Present gap of two bodies. */
struct rb_gap rb_gap_of(const struct rb_world *world, const struct rb_state *state, int a, int b);
/* The same with the origin of `a` at `center`. */
struct rb_gap rb_gap_at(const struct rb_world *world, const struct rb_state *state, int a,
                        rb_vec3 center, int b);

/*
 * The touching band of a pair: 8 ulp of the larger of coordinate and size (the model's only rest
 * rule; see rbsim-scene(5), "Touching and at rest"), m.
 */
double rb_gap_band(const struct rb_world *world, const struct rb_state *state, int a, int b);
enum { RB_TOUCHING_ULP = 8 };

/* Radius of curvature at the contact, m: sum of the radii, INFINITY if a body is flat. */
double rb_gap_radius(const struct rb_model *model, int a, int b);

/*
 * Fills pass->next and finds the pair that violates the tolerance most, at the end of the substep
 * or, where bodies would have passed through each other, within it: pass->worst and worst_gap.
 *
 * Lasting contacts may use the whole tolerance; new ones half of it, which leaves room for
 * residuals. A pair that is deeper for that reason and separates is accepted.
 */
extern const struct rb_stage rb_stage_gap;

#endif
