/* SPDX-License-Identifier: MIT */
/* The one object that rbsim-film.so exports (sink/module.h). */
#include "film/filmmodule.h"

#include "film/film.h"
#include "film/png.h"
#include "film/take.h"

const struct rb_film_module rb_film_module = {
	.version = RB_FILM_MODULE_VERSION,
	.film_check = rb_film_check,
	.film_create = rb_film_create,
	.film_destroy = rb_film_destroy,
	.film_cut = rb_film_cut,
	.film_switch = rb_film_switch,
	.film_tally = rb_film_tally,
	.take_create = rb_take_create,
	.take_destroy = rb_take_destroy,
	.take_see = rb_take_see,
	.take_draw = rb_take_draw,
	.png_write = rb_png_write,
};
