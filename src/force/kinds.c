/* SPDX-License-Identifier: MIT */
/*
 * All kinds of force elements, a line each. A new kind is a line here and a file beside this one.
 */
#include "force/drag.h"
#include "force/spring.h"

const struct rb_element_kind *const rb_element_kinds[] = {&rb_force_spring, &rb_force_drag};
const int rb_element_kind_count = sizeof rb_element_kinds / sizeof rb_element_kinds[0];

_Static_assert(sizeof rb_element_kinds / sizeof rb_element_kinds[0] <= RB_ELEMENT_KINDS_MAX,
               "room in struct rb_scene");
