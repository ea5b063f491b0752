/* SPDX-License-Identifier: MIT */
/*
 * One camera at work: a sink that takes frames, draws its pictures at their times, and writes them
 * as PNG files, as video, or both.
 *
 * The sink's calls come from the camera's own thread (flow/pump), in which the painter lives;
 * pictures are encoded by another thread of the film while the next one is drawn. Never essential:
 * a film that fails leaves the run alone.
 *
 * However a film ends, with its run, at a picture that fails, or cut short, its files get their
 * names with the pictures that were printed until then; only where its video cannot be finished
 * there is none.
 */
#ifndef RB_FILM_FILM_H
#define RB_FILM_FILM_H

#include "sink/module.h"

/* RB_ERR_SCENE also for a film of more than 10 million pictures. */
RB_CHECKED enum rb_status rb_film_check(const struct rb_film_options *options,
                                        struct rb_error *err);
RB_CHECKED enum rb_status rb_film_create(struct rb_film **film, struct rb_sink *sink,
                                         const struct rb_film_options *options,
                                         struct rb_error *err);
void rb_film_destroy(struct rb_film *film); /* NULL is fine */
/*
 * From any thread, at any time until it is destroyed: no picture after the one that is being drawn.
 */
void rb_film_cut(struct rb_film *film);
/*
 * Pictures of moments after `time_s` are left out, or drawn again. From the thread that publishes
 * frames, before it publishes one of a later moment. RB_ERR_MEMORY: all stays as it is.
 */
RB_CHECKED enum rb_status rb_film_switch(struct rb_film *film, double time_s, bool on,
                                         struct rb_error *err);
/* From any thread. */
struct rb_film_tally rb_film_tally(const struct rb_film *film);

#endif
