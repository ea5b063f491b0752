/* SPDX-License-Identifier: MIT */
/*
 * Reads single values from the JSON object that a run of this program has written. Inside of texts
 * quotes are escaped, so a key is never found in one; keys of the top level come before those of
 * objects within.
 */
#ifndef RB_SWEEP_POINT_REPORT_H
#define RB_SWEEP_POINT_REPORT_H

#include <stdbool.h>
#include <stddef.h>

/* Behind the first "KEY": from here on; NULL: there is none. */
const char *rb_point_report_value(const char *json, const char *key);
/* A text, cut where it does not fit; "" where there is none. */
void rb_point_report_text(const char *json, const char *key, char *out, size_t size);
/* A number, 1 and 0 for true and false; NAN where there is none. */
double rb_point_report_number(const char *json, const char *key);
/*
 * Objects by name in the object `KEY` ("results", "probes"): `at` is NULL at first, then what the
 * call before returned. The next one's name, cut where it does not fit, and where its values are;
 * NULL: there are no more.
 */
const char *rb_point_report_member(const char *json, const char *key, const char *at, char *name,
                                   size_t size);
/* The k-th expectation's object, from 0; NULL: there are fewer. */
const char *rb_point_report_expectation(const char *json, int k);

#endif
