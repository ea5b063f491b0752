/* SPDX-License-Identifier: MIT */
/*
 * Not a JSON parser: a search for keys in text that our own json.c has written, with no white space
 * between key, colon and value. This suffices because texts there escape their quotes, and it needs
 * no memory. Anything that is not as expected reads as absent.
 */
#include "sweep/told.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

const char *rb_told_value(const char *json, const char *key)
{
	char name[48];

	RB_ASSERT(strlen(key) + 4 <= sizeof name);
	snprintf(name, sizeof name, "\"%s\":", key);
	const char *const at = strstr(json, name);
	return at ? at + strlen(name) : NULL;
}

void rb_told_text(const char *json, const char *key, char *out, size_t size)
{
	const char *at = rb_told_value(json, key);
	size_t used = 0;

	RB_ASSERT(size > 0);
	if (at && *at == '"')
		for (at++; *at && *at != '"' && used + 1 < size; at++) {
			/*
			 * a line break becomes a space: the text goes into tables and one-line
			 * messages
			 */
			if (*at == '\\' && at[1] == 'n') {
				out[used++] = ' ';
				at++;
				continue;
			}
			if (*at == '\\' && at[1])
				at++;
			out[used++] = *at;
		}
	out[used] = '\0';
}

double rb_told_number(const char *json, const char *key)
{
	const char *const at = rb_told_value(json, key);
	char *end;

	if (!at)
		return (double)NAN;
	if (strncmp(at, "true", 4) == 0 || strncmp(at, "false", 5) == 0)
		return *at == 't';
	/* a number is never NAN here: json.c writes null for what is not finite */
	const double value = strtod(at, &end);
	return end == at || *at == 'n' ? (double)NAN : value;
}

const char *rb_told_expectation(const char *json, int k)
{
	static const char begin[] = "{\"text\":";
	const char *at = rb_told_value(json, "expectations");

	RB_ASSERT(k >= 0);
	for (at = at ? strstr(at, begin) : NULL; at && k > 0; k--)
		at = strstr(at + 1, begin);
	return at;
}
