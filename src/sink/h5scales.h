/* SPDX-License-Identifier: MIT */
/*
 * Dimension scales (HDF5's own convention, H5DS; netCDF's dimensions): each axis of what a
 * recording holds of frames, bodies, joints and tables names the dataset with its coordinates, so
 * that xarray, netCDF and h5py's `dims` find times, ids and axes by themselves. One thread.
 */
#ifndef RB_SINK_H5SCALES_H
#define RB_SINK_H5SCALES_H

#include <stdbool.h>

#include "sink/h5file.h"

/*
 * Makes the scales that are no data of the run (/axis, /axis_2, /quaternion, /limit, /joints/row)
 * and names those of all axes, in a file whose objects are all made. `time`: path of the times of
 * frames; NULL or absent: no axis is frames. To be called before other processes read the file.
 */
void rb_scales_write(struct rb_h5 *h5, const char *time);

/* Whether rb_scales_write makes this dataset, or this attribute. */
bool rb_scales_makes(const char *path);
bool rb_scales_makes_attribute(const char *name);

#endif
