/* SPDX-License-Identifier: MIT */
#include "sweep/told.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *rb_told_value(const char *json, const char *key)
{
	char name[48];

	snprintf(name, sizeof name, "\"%s\":", key);
	const char *const at = strstr(json, name);
	return at ? at + strlen(name) : NULL;
}

void rb_told_text(const char *json, const char *key, char *out, size_t size)
{
	const char *at = rb_told_value(json, key);
	size_t used = 0;

	if (at && *at == '"')
		for (at++; *at && *at != '"' && used + 1 < size; at++) {
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
	const double value = strtod(at, &end);
	return end == at || *at == 'n' ? (double)NAN : value;
}

const char *rb_told_expectation(const char *json, int k)
{
	static const char begin[] = "{\"text\":";
	const char *at = rb_told_value(json, "expectations");

	for (at = at ? strstr(at, begin) : NULL; at && k > 0; k--)
		at = strstr(at + 1, begin);
	return at;
}
