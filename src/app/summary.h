/* SPDX-License-Identifier: MIT */
/* What a run says at its end: lines for people, or one JSON object. Main thread. */
#ifndef RB_APP_SUMMARY_H
#define RB_APP_SUMMARY_H

#include <stdio.h>

#include "app/simulate.h"

/* A dozen lines; `color`: the file is a terminal that takes it. */
void rb_summary_print(FILE *file, const struct rb_run_result *result,
                      const struct rb_loaded *loaded, const struct rb_run_info *info, bool color);
/* The table of expectations alone, `failed_only`: without those that hold. */
void rb_summary_print_expects(FILE *file, const struct rb_run_result *result, bool failed_only,
                              bool color);
void rb_summary_print_json(FILE *file, const struct rb_run_result *result,
                           const struct rb_loaded *loaded, const struct rb_run_info *info,
                           const struct rb_films *films, int exit_code);

#endif
