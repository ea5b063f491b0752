/* SPDX-License-Identifier: MIT */
/* -(linear + quadratic |v|) v on every free body, at its centre of mass. */
#ifndef RB_FORCE_DRAG_H
#define RB_FORCE_DRAG_H

#include "model/element.h"

extern const struct rb_element_kind rb_force_drag; /* rows: struct rb_drag_def */

/*
 * N s/m and N s^2/m^2: the coefficients of all drag of the scene; zero: there is none.
 */
struct rb_drag_def rb_drag_of_all(const struct rb_model *model);

#endif
