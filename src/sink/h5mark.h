/* SPDX-License-Identifier: MIT */
/*
 * The marks at the beginning of an HDF5 file: whether somebody writes it, and where it ends.
 *
 * A process that is killed leaves the first one behind, and then nobody but SWMR readers get in.
 * Laid out as in the HDF5 File Format Specification, version 3.0, II.A "Superblock", versions 2 and
 * 3; its checksum is Bob Jenkins' lookup3.
 */
#ifndef RB_SINK_H5MARK_H
#define RB_SINK_H5MARK_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/error.h>

/*
 * Takes away the mark of a writer, if it is there (`*was`), and puts the end mark behind all that
 * the file holds: so nothing is given out twice. One small write. The caller knows that nobody
 * writes. RB_ERR_INPUT: no such file.
 */
RB_CHECKED enum rb_status rb_mark_clear(int fd, const char *name, bool *was, struct rb_error *err);

/*
 * Puts the marks into the image of a file in memory, of `size` bytes, 48 at least. The library,
 * asked for such an image, takes the writer's mark away and leaves the checksum as it was
 * (H5F_get_file_image in 1.10.8).
 */
void rb_mark_image(unsigned char *image, size_t size);

#endif
