/* SPDX-License-Identifier: MIT */
/*
 * What stands around the picture of a console: transport, time line, numbers, charts, body, log,
 * help. Part of rbsim-console.so; one thread.
 */
#ifndef RB_CONTROL_PANELS_H
#define RB_CONTROL_PANELS_H

#include "control/screen.h"
#include "control/viewer.h"

void rb_panel_transport(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
void rb_panel_timeline(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
void rb_panel_numbers(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
void rb_panel_charts(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
void rb_panel_body(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
void rb_panel_log(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer);
/* From line `first` on, which is put right where it lies behind the last page. */
void rb_panel_help(struct rb_screen *screen, rb_area area, int *first);

#endif
