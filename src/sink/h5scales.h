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

/* The datasets of a file that is being made. Owned by who makes it. */
struct rb_scales;

/*
 * `time`: path of the times of frames, for as long as the result; NULL: not known yet, and no links
 * will be noted. NULL: no memory.
 */
struct rb_scales *rb_scales_create(const char *time);
void rb_scales_destroy(struct rb_scales *scales); /* NULL: nothing */

/*
 * Notes a dataset that has been made, of any kind, by its place in the file, which may be closed
 * and opened in between; its number. Failures are in `h5`.
 */
size_t rb_scales_note(struct rb_scales *scales, struct rb_h5 *h5, const char *path, hid_t dataset);
/* For rb_h5's `made`, the scales as its user: notes it if its path says that it is of use. */
void rb_scales_made(void *scales, struct rb_h5 *h5, const char *path, hid_t dataset);
/* Notes another path of the dataset with this number. */
void rb_scales_note_link(struct rb_scales *scales, struct rb_h5 *h5, const char *path,
                         size_t which);

/*
 * Makes the scales that are no data of the run (/axis, /axis_2, /quaternion, /limit, /joints/row)
 * and names those of all axes, in a file whose datasets are all made and noted. `time`: path of the
 * times of frames; NULL or absent: no axis is frames. To be called once, before other processes
 * read the file.
 */
void rb_scales_write(struct rb_scales *scales, struct rb_h5 *h5, const char *time);

/* Whether rb_scales_write makes this dataset, or this attribute. */
bool rb_scales_makes(const char *path);
bool rb_scales_makes_attribute(const char *name);

#endif
