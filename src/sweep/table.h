/* SPDX-License-Identifier: MIT */
/*
 * What all runs of a sweep have come to: a row for each point, a column for each parameter, number
 * and expectation. Points that are not done have NAN where they have no number. The struct itself
 * stands in sink/module.h, for the HDF5 part.
 */
#ifndef RB_SWEEP_TABLE_H
#define RB_SWEEP_TABLE_H

#include <stdio.h>

#include "sweep/point.h"

/* Released in any case. */
RB_CHECKED enum rb_status rb_table_init(struct rb_table *table, const char *folder,
                                        const struct rb_plan *plan, struct rb_error *err);
void rb_table_release(struct rb_table *table);
/* Comma-separated, with a row of names above; what is missing is an empty cell. */
void rb_table_print_csv(const struct rb_table *table, FILE *file);

/* A text as a cell of RFC 4180: quoted where it holds a separator, a quote or a line break. */
void rb_table_print_cell(FILE *file, const char *text);

#endif
