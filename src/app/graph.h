/* SPDX-License-Identifier: MIT */
/* `rbsim plot`. Main thread. */
#ifndef RB_APP_GRAPH_H
#define RB_APP_GRAPH_H

#include "app/common.h"

int rb_graph_main(const struct rb_options *options);

#endif
