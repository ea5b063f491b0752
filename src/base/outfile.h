/* SPDX-License-Identifier: MIT */
/*
 * An output file that appears under its name only when it is whole: until then it stands as
 * NAME.partial-NUMBER beside it. `how` is that of base/place, through which all of it goes; a bool
 * says whether a file that is there may be replaced.
 *
 * Owned by the caller, one thread at a time; several files may be made in several threads.
 */
#ifndef RB_BASE_OUTFILE_H
#define RB_BASE_OUTFILE_H

#include <stdbool.h>
#include <stdio.h>

#include <rbsim/error.h>

#include "base/place.h"

struct rb_outfile {
	FILE *file; /* to write to */
	struct rb_place place;
	char partial[RB_PLACE_NAME_SIZE]; /* the name in there until it is whole; "": none */
};

/*
 * RB_ERR_CREATE when the name is taken and may not be replaced, or is no regular file. Touches
 * nothing.
 */
RB_CHECKED enum rb_status rb_outfile_check(const char *name, unsigned how, struct rb_error *err);
/*
 * The same, and whether the file could be written, or its folder made where there is none. Leaves
 * nothing behind.
 */
RB_CHECKED enum rb_status rb_outfile_probe(const char *name, unsigned how, struct rb_error *err);
/* Makes the folders above the name that are not there yet. RB_ERR_CREATE. */
RB_CHECKED enum rb_status rb_outfile_folders(const char *name, unsigned how, struct rb_error *err);

RB_CHECKED enum rb_status rb_outfile_open(struct rb_outfile *out, const char *name, unsigned how,
                                          struct rb_error *err);
/*
 * Whole: under its name from here on, or an error. The file is closed and `out` released in any
 * case.
 */
RB_CHECKED enum rb_status rb_outfile_publish(struct rb_outfile *out, struct rb_error *err);
/* Nothing of it stays, unless it was published. Safe on a zeroed one. */
void rb_outfile_release(struct rb_outfile *out);

#endif
