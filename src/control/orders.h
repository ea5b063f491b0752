/* SPDX-License-Identifier: MIT */
/*
 * What commands do to a viewer, whatever way they come in: what is about the view is done here,
 * what is about the run goes to it when there is one. Over a recording play, pause, step and the
 * like are about the view.
 */
#ifndef RB_CONTROL_ORDERS_H
#define RB_CONTROL_ORDERS_H

#include "control/viewer.h"

/*
 * One line; what it has to say goes to the viewer's log, also an error, which is returned besides.
 */
enum rb_status rb_order(struct rb_viewer *viewer, const char *line, uint64_t now_ns);

/*
 * Id of a body by name, or by "#3"; -1: there is none. `part`: the first one with it in its name
 * does, in any case of letters.
 */
int rb_order_find_body(const struct rb_viewer *viewer, const char *name, bool part);
/*
 * A body's numbers at the frame that is shown, line by line: 0 is the first, false behind the last.
 */
bool rb_order_body_line(const struct rb_viewer *viewer, int id, int line, char out[96]);
/* Names for rb_command_complete; `user` is the viewer. */
const char *rb_order_name(void *user, enum rb_command_kind kind, int index);

#endif
