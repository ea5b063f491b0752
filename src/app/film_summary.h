/* SPDX-License-Identifier: MIT */
/*
 * What is printed of films: before a run, by rbsim check, and after it, in summaries.
 *
 * NULL instead of films prints nothing, or an empty list. Thread of the owner of the films.
 */
#ifndef RB_APP_FILM_SUMMARY_H
#define RB_APP_FILM_SUMMARY_H

#include <stdio.h>

#include "app/films.h"
#include "app/json.h"

/* Before the start: a line for each film that will be made, as rbsim check has it. */
void rb_films_print_plan(FILE *file, const struct rb_films *films);
/* After the join: a line for each film, as in the summary. */
void rb_films_print(FILE *file, const struct rb_films *films);
void rb_films_print_json(struct rb_json *json, const struct rb_films *films);

#endif
