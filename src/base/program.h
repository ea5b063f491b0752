/* SPDX-License-Identifier: MIT */
/* Where the running program is, as /proc says it: what is shipped beside it is found from there. */
#ifndef RB_BASE_PROGRAM_H
#define RB_BASE_PROGRAM_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/*
 * A name for exec(3) that starts the running program again, even where its file was replaced or
 * removed.
 */
#define RB_PROGRAM_AGAIN "/proc/self/exe"

/*
 * Writes the path of the program's file. RB_ERR_MISSING where /proc is missing or something else is
 * in its place.
 */
enum rb_status rb_program_path(char path[PATH_MAX], struct rb_error *err);

/*
 * Writes the path of `name`, relative to the folder of the program's file, into `size` bytes. False
 * where that folder is unknown, as above, or the path is too long; then nothing is written.
 */
bool rb_program_beside(const char *name, char *path, size_t size);

#endif
