/* SPDX-License-Identifier: MIT */
/*
 * What hulls and unions are made of, in a recording: /rbsim/solids and the numbers in /rbsim/shapes
 * that name them (rbsim-recording(5)); and which shapes a recording has. A scene without hulls and
 * unions has none of it.
 */
#ifndef RB_SINK_H5SOLIDS_H
#define RB_SINK_H5SOLIDS_H

#include <rbsim/scene.h>

#include "sink/h5file.h"
#include "sink/h5input.h"

/* The text of an attribute that says what the numbers of kinds mean: "0 sphere, 1 plane, ...". */
void rb_solids_kinds(char out[160]);

void rb_solids_write(struct rb_h5 *h5, const struct rb_scene *scene);

/*
 * How many of `count` bodies have which shape; `kind` is room for as many. False: it cannot be
 * read.
 */
bool rb_solids_tally(const struct rb_input *input, size_t count, int *kind,
                     int counts[RB_SHAPE_KIND_COUNT]);

#endif
