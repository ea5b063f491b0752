/* SPDX-License-Identifier: MIT */
/*
 * What --help, --version and --print-tables options say, from the tables of app/options. Main
 * thread.
 */
#ifndef RB_APP_HELP_H
#define RB_APP_HELP_H

#include <stdio.h>

#include <rbsim/scene.h>

#include "app/options.h"

/* What the program is, its verbs, and an example of each. */
void rb_help_print_overview(FILE *file);
/* Of one verb; of the whole program when none was given by name. */
void rb_help_print(FILE *file, const struct rb_options *options);
/* The parameters that a scene declares: name, default, range or choices, help. */
void rb_help_print_params(FILE *file, const struct rb_scene *scene);
/* All options as the mdoc list that rbsim(1) has between its marks. */
void rb_help_print_options(FILE *file);
/* The completion script of a shell, "bash" or "zsh", as in tools/completion. */
void rb_help_print_completion(FILE *file, const char *shell);

#endif
