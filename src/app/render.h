/* SPDX-License-Identifier: MIT */
/* rbsim render: pictures and video from a recording. */
#ifndef RB_APP_RENDER_H
#define RB_APP_RENDER_H

#include "app/options.h"

/* The verb's exit status. */
int rb_render_main(const struct rb_options *options);

#endif
