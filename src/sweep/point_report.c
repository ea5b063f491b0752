/* SPDX-License-Identifier: MIT */
/*
 * Not a JSON parser: a search for keys in text that our own json.c has written, with no white space
 * between key, colon and value. This suffices because texts there escape their quotes, and it needs
 * no memory. Anything that is not as expected reads as absent.
 */
#include "sweep/point_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

const char *rb_point_report_value(const char *json, const char *key)
{
	char name[48];

	RB_ASSERT(strlen(key) + 4 <= sizeof name);
	snprintf(name, sizeof name, "\"%s\":", key);
	const char *const at = strstr(json, name);
	return at ? at + strlen(name) : NULL;
}

/*
 * Copies the text behind the quote at `at`, as much as fits; the quote at its end, NULL: it has
 * none. A line break becomes a space: the text goes into tables and one-line messages.
 */
static const char *copy_text(const char *at, char *out, size_t size)
{
	size_t used = 0;

	RB_ASSERT(size > 0 && *at == '"');
	for (at++; *at && *at != '"'; at++) {
		const bool escaped = *at == '\\' && at[1];

		at += escaped;
		if (used + 1 < size)
			out[used++] = escaped && *at == 'n' ? ' ' : *at;
	}
	out[used] = '\0';
	return *at == '"' ? at : NULL;
}

void rb_point_report_text(const char *json, const char *key, char *out, size_t size)
{
	const char *const at = rb_point_report_value(json, key);

	out[0] = '\0';
	if (at && *at == '"')
		(void)copy_text(at, out, size);
}

/* The end of the flat object that begins at `at`; NULL: it has none. */
static const char *object_end(const char *at)
{
	bool inside = false; /* a text */

	for (; *at; at++) {
		if (inside && *at == '\\' && at[1])
			at++;
		else if (*at == '"')
			inside = !inside;
		else if (!inside && *at == '}')
			return at;
	}
	return NULL;
}

/* The member that begins at a quote: its name, and the object behind it; NULL: it has none. */
static const char *member_at(const char *at, char *name, size_t size)
{
	const char *const end = *at == '"' ? copy_text(at, name, size) : NULL;

	return end && end[1] == ':' && end[2] == '{' ? end + 2 : NULL;
}

const char *rb_point_report_member(const char *json, const char *key, const char *at, char *name,
                                   size_t size)
{
	if (at) {
		const char *const end = object_end(at);
		return end && end[1] == ',' ? member_at(end + 2, name, size) : NULL;
	}
	/* a result may be called "probes": it holds no objects */
	for (const char *from = json; (from = rb_point_report_value(from, key)) != NULL;) {
		const char *const first = *from == '{' ? member_at(from + 1, name, size) : NULL;
		if (first)
			return first;
	}
	return NULL;
}

double rb_point_report_number(const char *json, const char *key)
{
	const char *const at = rb_point_report_value(json, key);
	char *end;

	if (!at)
		return (double)NAN;
	if (strncmp(at, "true", 4) == 0 || strncmp(at, "false", 5) == 0)
		return *at == 't';
	/* a number is never NAN here: json.c writes null for what is not finite */
	const double value = strtod(at, &end);
	return end == at || *at == 'n' ? (double)NAN : value;
}

const char *rb_point_report_expectation(const char *json, int k)
{
	static const char begin[] = "{\"text\":";
	const char *at = rb_point_report_value(json, "expectations");

	RB_ASSERT(k >= 0);
	for (at = at ? strstr(at, begin) : NULL; at && k > 0; k--)
		at = strstr(at + 1, begin);
	return at;
}
