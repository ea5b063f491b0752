/* SPDX-License-Identifier: MIT */
/*
 * One HDF5 file over many recordings: tables, and virtual datasets with a row for each recording,
 * which hold no data of their own. Recordings that are missing, shorter or of fewer bodies leave
 * NAN.
 */
#ifndef RB_SINK_H5COLLECT_H
#define RB_SINK_H5COLLECT_H

#include "sink/module.h"

RB_CHECKED enum rb_status rb_h5_collect(const struct rb_collection *collection, uint64_t *linked,
                                        struct rb_error *err);
/* A column of numbers of such a file; see sink/module.h. */
RB_CHECKED enum rb_status rb_h5_column(const struct rb_column_name *column, double **values,
                                       uint64_t *count, char *units, struct rb_error *err);

#endif
