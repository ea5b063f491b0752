/* SPDX-License-Identifier: MIT */
/*
 * Writes one JSON value to a stream, commas and escapes included. Names are NULL inside arrays.
 *
 * Owned by the caller, one thread. Numbers that are not finite become null; bytes that are not
 * UTF-8 become U+FFFD.
 */
#ifndef RB_APP_JSON_H
#define RB_APP_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct rb_json {
	FILE *file;
	bool follows; /* a value stands before the next one in this object or array */
};

void rb_json_open(struct rb_json *json, const char *name, char bracket);      /* '{' or '[' */
void rb_json_close(struct rb_json *json, char bracket);                       /* '}' or ']' */
void rb_json_text(struct rb_json *json, const char *name, const char *value); /* NULL: null */
void rb_json_number(struct rb_json *json, const char *name, double value);
void rb_json_count(struct rb_json *json, const char *name, uint64_t value);
void rb_json_bool(struct rb_json *json, const char *name, bool value);
void rb_json_vector(struct rb_json *json, const char *name, const double *value, int count);

#endif
