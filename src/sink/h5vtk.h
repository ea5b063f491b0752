/* SPDX-License-Identifier: MIT */
/*
 * /VTKHDF: the recording as VTK's readers want it (PolyData in time, VTKHDF 2.0), for ParaView and
 * others. The large columns are virtual datasets over those of the recording: not a byte of them is
 * copied.
 */
#ifndef RB_SINK_H5VTK_H
#define RB_SINK_H5VTK_H

#include <rbsim/model.h>

#include "sink/h5file.h"

/*
 * Adds the group for the first `frames` frames; `fields` are those stored per frame, `time` the
 * path of their times. The file must not be in SWMR mode. Nothing is made without positions, bodies
 * or frames.
 */
void rb_vtk_write(struct rb_h5 *h5, const struct rb_model *model, unsigned fields, uint64_t frames,
                  const char *time);

/* Most bytes that it takes. */
uint64_t rb_vtk_need(const struct rb_model *model, uint64_t frames);

#endif
