/* SPDX-License-Identifier: MIT */
/*
 * A finished recording without the room that its growing took: columns that are as long as they
 * will ever be, headers and indices where there is space for them. One thread.
 */
#ifndef RB_SINK_H5COMPACT_H
#define RB_SINK_H5COMPACT_H

#include <stddef.h>

#include <hdf5.h>

#include <rbsim/error.h>

/* Only files of at most so many bytes are compacted: in larger ones it is a small part. */
enum { RB_COMPACT_MOST = 1 << 21 };

/*
 * The image of a file with all that is in the open `file`: groups and links in their order,
 * attributes, data to the bit. Scales of axes are made anew (h5scales.h), none where `time` is
 * NULL. To be freed by rb_memory_free. RB_ERR_MEMORY, RB_ERR_IO: it could not be read.
 */
RB_CHECKED enum rb_status rb_compact_image(hid_t file, const char *name, const char *time,
                                           unsigned char **image, size_t *size,
                                           struct rb_error *err);

#endif
