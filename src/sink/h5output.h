/* SPDX-License-Identifier: MIT */
/*
 * The file under a recording: its two names and its room on disk. No HDF5 in here.
 *
 * It is written as NAME.partial-NUMBER beside NAME and renamed when its first frame is in it; until
 * then nothing that stands under NAME is touched. Folder and file are held open, and the library
 * reaches them through that (base/place): whatever becomes of the names, it writes to this file.
 * Owned by one thread.
 */
#ifndef RB_SINK_H5OUTPUT_H
#define RB_SINK_H5OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

#include "base/place.h"

struct rb_output {
	struct rb_place place;
	char partial[RB_PLACE_NAME_SIZE]; /* the name in there until it is published; "": none */
	char library
		/* what the library is to open, or to make before rb_output_attach */
		[RB_PLACE_LINK_SIZE];
	bool published;          /* stands under its final name */
	int fd;                  /* owned; -1: none */
	uint64_t reserved_bytes; /* the disk has room up to here */
	bool cannot_reserve;     /* the file system has no such call */
};

/*
 * Checks that NAME may be made, and finds a new name under which the library can make it
 * (`library`); rb_output_attach then takes hold of it. `how` is that of base/place. RB_ERR_CREATE.
 */
RB_CHECKED enum rb_status rb_output_open(struct rb_output *output, const char *name, unsigned how,
                                         struct rb_error *err);

RB_CHECKED enum rb_status rb_output_attach(struct rb_output *output, struct rb_error *err);

/*
 * Tells other processes that this file is being written: the library's own lock (flock) does not
 * hold while readers are let in, and this kind has nothing to do with it. False: somebody else
 * writes it.
 */
bool rb_output_lock(const struct rb_output *output);

/*
 * A recording that stands under NAME already is to be written on. RB_ERR_CREATE where it can't be,
 * or where somebody else writes it.
 */
RB_CHECKED enum rb_status rb_output_reopen(struct rb_output *output, const char *name, unsigned how,
                                           struct rb_error *err);

/*
 * The partial file gets its final name; without `replace` never over another one. Once; then it
 * does nothing.
 */
RB_CHECKED enum rb_status rb_output_publish(struct rb_output *output, struct rb_error *err);

/*
 * Room for `need` bytes from `end` on, or the number of the system's error: before anything is
 * written.
 */
int rb_output_reserve(struct rb_output *output, uint64_t end, uint64_t need);

/* The file is at least `end` long from now on, as far as that can be had. */
void rb_output_lengthen(struct rb_output *output, uint64_t end);

/*
 * The final name means a new file of these bytes from now on, in one step; readers of the old one
 * keep it. An errno where that cannot be: then nothing has changed.
 */
int rb_output_replace(struct rb_output *output, const void *bytes, size_t size);

/* Does the final name still mean this file? Another run with --force may have taken it. */
bool rb_output_is_ours(const struct rb_output *output);

/*
 * Gives back what was reserved beyond the end. A file that was never published is removed. Safe on
 * a zeroed one.
 */
void rb_output_release(struct rb_output *output);

#endif
