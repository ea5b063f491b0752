/* SPDX-License-Identifier: MIT */
/* The table that the film part exports (sink/module.h). */
#ifndef RB_FILM_FILMMODULE_H
#define RB_FILM_FILMMODULE_H

#include "sink/module.h"

extern const struct rb_film_module rb_film_module;

#endif
