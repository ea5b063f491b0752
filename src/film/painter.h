/* SPDX-License-Identifier: MIT */
/*
 * Draws what one camera sees of a frame, off-screen. The only rooms below that know OpenGL are
 * film/canvas, film/glsl and the painter's own.
 *
 * Created, used and destroyed by one thread; several painters work in several threads at once. The
 * same frame gives the same pixels, whatever was drawn before and whatever the number of threads.
 */
#ifndef RB_FILM_PAINTER_H
#define RB_FILM_PAINTER_H

#include <stdatomic.h>
#include <stdbool.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

#include "film/pixmap.h"
#include "film/trails.h"
#include "film/view.h"

struct rb_painter;

/*
 * Model (with its scene: shapes, colours, textures, statics) and camera (size, lights, samples,
 * style, vectors) are borrowed until the painter is destroyed. RB_ERR_MISSING: no OSMesa context of
 * the version that is needed; RB_ERR_SCENE: a texture that is no picture (scene file and line,
 * body, what was found); RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_painter_create(struct rb_painter **painter,
                                            const struct rb_model *model,
                                            const struct rb_camera_def *camera,
                                            struct rb_error *err);
void rb_painter_destroy(struct rb_painter *painter); /* NULL is fine; same thread */
/*
 * Once `cut` is set, by any thread, large pictures are given up half-way: RB_ERR_INTERRUPT.
 * Borrowed; NULL: never.
 */
void rb_painter_heed(struct rb_painter *painter, const atomic_bool *cut);

/*
 * The picture at a frame: poses, contacts and velocities are the frame's. `shot` is where a camera
 * with functions stands (NULL: the camera has none). `trails` may be NULL. `picture` borrows the
 * painter's memory and holds until the next call; its alpha is 255; what the overlay says is not in
 * it. RB_ERR_SCENE: the camera stands inside a body, or looks along its `up`, or its look_at is its
 * position at this moment (told with camera, time and body).
 */
RB_CHECKED enum rb_status rb_painter_draw(struct rb_painter *painter, const struct rb_frame *frame,
                                          const struct rb_frame_shot *shot,
                                          const struct rb_trails *trails, struct rb_pixmap *picture,
                                          struct rb_error *err);

/* What the last picture's camera saw; owned by the painter. Zeros before the first. */
const struct rb_view *rb_painter_view(const struct rb_painter *painter);

/* Wall time spent so far, ns. */
struct rb_painter_times {
	uint64_t draw_ns, read_ns; /* until GL has finished; copying the pixels out of it */
};
struct rb_painter_times rb_painter_times(const struct rb_painter *painter);

/* "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6"; owned by the painter */
const char *rb_painter_renderer(const struct rb_painter *painter);

#endif
