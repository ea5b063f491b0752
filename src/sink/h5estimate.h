/* SPDX-License-Identifier: MIT */
/*
 * How much room a recording will take. Any thread that has called rb_h5_quiet or lets this do so.
 */
#ifndef RB_SINK_H5ESTIMATE_H
#define RB_SINK_H5ESTIMATE_H

#include "flow/run_info.h"

/* Bytes; 0 when memory is out. With compression it is what the run would take without. */
uint64_t rb_h5_estimate(const struct rb_run_info *info);

#endif
