/* SPDX-License-Identifier: MIT */
/*
 * The renderer is optional twice: the module may be absent, and it may find no way to OpenGL. Both
 * are noticed once, remembered with the reason, and answered with a sketch, which needs neither. A
 * take is bound to a size and a camera of the scene; moving the camera by hand only changes its
 * numbers.
 */
#include "control/picture.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/error.h"
#include "control/sketch.h"

/* Samples for each pixel: a cell of the terminal averages few pixels, so edges need no more. */
enum { SAMPLES = 4 };

/* Destroys the take, if there is one. */
static void drop_take(struct rb_picture *picture)
{
	if (picture->take)
		picture->film->take_destroy(picture->take);
	picture->take = NULL;
}

void rb_picture_release(struct rb_picture *picture)
{
	drop_take(picture);
	rb_memory_free(picture->sketch.rgba);
	*picture = (struct rb_picture){0};
}

/* Loads the renderer, once. */
static void look(struct rb_picture *picture)
{
	struct rb_error err;

	picture->looked = true;
	/*
	 * Mesa's own threads would take from the simulation what so small a picture does not need
	 */
	setenv("LP_NUM_THREADS", "0", 0);
	if (rb_module_film(&picture->film, &err))
		snprintf(picture->failure, sizeof picture->failure, "%s", err.text);
}

/*
 * Sets the camera for the next picture; makes a new take for what cannot be changed in one: the
 * size, or another camera of the scene. Trails and all that is written are left out: they would be
 * unreadable in cells, and cover the bodies.
 */
static enum rb_status aim(struct rb_picture *picture, const struct rb_viewer *viewer, int width,
                          int height, struct rb_error *err)
{
	const bool other = !picture->take || picture->camera_index != viewer->camera_index ||
	                   picture->camera.size_px[0] != width ||
	                   picture->camera.size_px[1] != height;

	if (other)
		drop_take(picture);
	picture->camera = viewer->camera;
	picture->camera.size_px[0] = width;
	picture->camera.size_px[1] = height;
	picture->camera.samples = SAMPLES;
	picture->camera.overlay = 0;
	picture->camera.trail_count = 0;
	picture->camera.label_count = 0;
	picture->camera.text_count = 0;
	picture->camera.plot_count = 0;
	picture->camera_index = viewer->camera_index;
	return other ? picture->film->take_create(&picture->take, viewer->options.model,
	                                          &picture->camera, err)
	             : RB_OK;
}

/* Draws without a renderer into the picture's own pixels, which are kept while the size stays. */
static enum rb_status sketch(struct rb_picture *picture, const struct rb_viewer *viewer, int width,
                             int height, struct rb_error *err)
{
	const struct rb_stand stand = rb_viewer_stand(viewer);

	RB_ASSERT(width > 0 && height > 0);
	if (picture->sketch.width != width || picture->sketch.height != height) {
		rb_memory_free(picture->sketch.rgba);
		picture->sketch = (struct rb_pixmap){
			width, height, rb_memory_take((size_t)width * (size_t)height, 4)};
	}
	if (!picture->sketch.rgba) {
		picture->sketch = (struct rb_pixmap){0};
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	}
	return rb_sketch_draw(&picture->sketch, viewer->options.model, &viewer->camera, &stand,
	                      &viewer->frame, err);
}

enum rb_status rb_picture_draw(struct rb_picture *picture, const struct rb_viewer *viewer,
                               int width, int height, const struct rb_pixmap **pixels,
                               struct rb_error *err)
{
	struct rb_pixmap drawn;

	RB_ASSERT(width > 0 && height > 0);
	*pixels = &picture->sketch;
	if (!picture->looked)
		look(picture);
	if (!picture->film)
		return sketch(picture, viewer, width, height, err);
	enum rb_status status = aim(picture, viewer, width, height, err);
	if (status) {
		/* no OpenGL after all: what can be said without is still something */
		snprintf(picture->failure, sizeof picture->failure, "%s", err->text);
		picture->film = NULL;
		return sketch(picture, viewer, width, height, err);
	}
	status = picture->film->take_draw(picture->take, &viewer->frame,
	                                  viewer->has_shot ? &viewer->shot : NULL, &drawn, err);
	if (status)
		return status;
	picture->drawn = drawn;
	*pixels = &picture->drawn;
	return RB_OK;
}
