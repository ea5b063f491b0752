/* SPDX-License-Identifier: MIT */
/*
 * PolyData in time as the VTKHDF format has it (2.0): points, cells of one kind, and for each step
 * where its points, cells and values begin. What is the same in all steps stands there once, and
 * all steps point to it. `base` is the path of the group.
 */
#ifndef RB_SINK_H5POLYDATA_H
#define RB_SINK_H5POLYDATA_H

#include <stdbool.h>

#include "sink/h5file.h"

struct rb_polydata {
	const char *base;  /* borrowed, like what follows */
	const char *time;  /* path of the steps' times */
	const char *cells; /* "Vertices" or "Polygons": the only kind that there is */
	hsize_t steps;
};

/*
 * Makes the group with its steps. `index` is its place among the parts of a collection; -1: it
 * stands alone. `varies`: each step has a number of points and cells of its own; PartOffsets then
 * point to these.
 */
void rb_polydata_begin(struct rb_h5 *h5, const struct rb_polydata *data, int index, bool varies);
/* The cells, which are the same in all steps: how many there are, and how many corners of them. */
void rb_polydata_count(struct rb_h5 *h5, const struct rb_polydata *data, hsize_t points,
                       hsize_t cells, hsize_t corners);
/* Values of points ("PointData") or cells ("CellData") that are the same in all steps: offsets. */
void rb_polydata_fixed(struct rb_h5 *h5, const struct rb_polydata *data, const char *of,
                       const char *name);
/* ... that begin where the step's points begin. PointOffsets must be there. */
void rb_polydata_moving(struct rb_h5 *h5, const struct rb_polydata *data, const char *name);

/* A dataset below `base` that is never written: all of it reads as `value` and takes no room. */
void rb_polydata_constant(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                          rb_h5_shape shape, int64_t value);
/* value(i) = i * step, for i in [0, count). */
void rb_polydata_ramp(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                      hsize_t count, int64_t step);
/* Numbers below `base`, and a soft link, so that no header of before is changed. */
void rb_polydata_put(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                     enum rb_h5_kind kind, rb_h5_shape shape, const void *numbers);
void rb_polydata_link(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                      const char *to);

enum { RB_POLYDATA_PATH_SIZE = 96 };
/* base/name, written to `out`, which is returned. */
const char *rb_polydata_path(const struct rb_polydata *data, const char *name,
                             char out[RB_POLYDATA_PATH_SIZE]);

#endif
