/* SPDX-License-Identifier: MIT */
/* rbsim render: pictures and video from a recording. */
#ifndef RB_APP_RENDER_H
#define RB_APP_RENDER_H

#include "app/common.h"
#include "app/films.h"
#include "app/options.h"

/* The verb's exit status. */
int rb_render_main(const struct rb_options *options);

/*
 * The films of a run that are made from its recording when it has ended (rb_films_begin_late); none
 * is no error.
 */
RB_CHECKED enum rb_status rb_render_late(struct rb_films *films, struct rb_loaded *loaded,
                                         const struct rb_options *options, struct rb_error *err);

#endif
