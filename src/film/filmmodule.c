/* SPDX-License-Identifier: MIT */
/* The one object that rbsim-film.so exports (sink/module.h). */
#include "film/filmmodule.h"

#include <stdio.h>

#include <ft2build.h>
#include FT_FREETYPE_H
#include <png.h>

#include "base/error.h"
#include "film/canvas.h"
#include "film/film.h"
#include "film/png.h"
#include "film/take.h"

#ifdef RB_GL_EGL
#define WAY "EGL"
#else
#define WAY "OSMesa"
#endif

/* Only a context knows what draws in it: one is made, which also says whether one can be. */
static void libraries(char *out, size_t size)
{
	struct rb_canvas *canvas;
	struct rb_error err = {0};
	FT_Library freetype;
	FT_Int major = 0, minor = 0, patch = 0;

	if (FT_Init_FreeType(&freetype) == 0) {
		FT_Library_Version(freetype, &major, &minor, &patch);
		FT_Done_FreeType(freetype);
	}
	const enum rb_status status = rb_canvas_create(&canvas, 1, 1, 0, &err);
	snprintf(out, size, "libpng %s, FreeType %d.%d.%d, %s (%s)", png_get_libpng_ver(NULL),
	         (int)major, (int)minor, (int)patch, WAY,
	         status ? err.text : rb_canvas_renderer(canvas));
	if (!status)
		rb_canvas_destroy(canvas);
}

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
	.libraries = libraries,
};
