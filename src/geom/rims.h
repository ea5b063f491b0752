/* SPDX-License-Identifier: MIT */
/*
 * Directions that can prove the gap of a cylinder and another core, besides the ends of cylinders
 * and faces (these are in geom/facets). Where a rim is concerned the best of a family of directions
 * is found by Newton's method on what each proves, which goes smoothly from apart to overlapping.
 * Pure functions.
 */
#ifndef RB_GEOM_RIMS_H
#define RB_GEOM_RIMS_H

#include "geom/facets.h"

/* One or both of the cores are cylinders. `guide`: a direction not far from the best, unit. */
void rb_rims(rb_axis *axis, const rb_slab *slab, rb_vec3 guide);

#endif
