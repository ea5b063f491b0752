/* SPDX-License-Identifier: MIT */
/* How much disk the run of a point has taken. Main thread. */
#ifndef RB_SWEEP_USAGE_H
#define RB_SWEEP_USAGE_H

#include "sweep/folder.h"

/*
 * Bytes of all files of a point, films and those that are being written included; what cannot be
 * looked at counts nothing.
 */
double rb_usage_bytes(const char *folder, const struct rb_plan *plan, uint64_t index);

#endif
