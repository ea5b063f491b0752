/* SPDX-License-Identifier: MIT */
/*
 * Values are written as they come; the only state is whether a comma is due. What is not finite
 * becomes null, since JSON has no NAN; numbers are printed with 17 digits, so that they read back
 * to the bit. There is no white space between keys and values: sweep/point_report finds keys by
 * that.
 */
#include "app/json.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/visible.h"

/* A character as JSON's escapes, of which one beyond 16 bits takes two. */
static void put_code(FILE *file, uint32_t code)
{
	if (code > 0xffff) {
		fprintf(file, "\\u%04x", (unsigned)(0xd7c0 + (code >> 10)));
		code = 0xdc00 | (code & 0x3ff);
	}
	fprintf(file, "\\u%04x", (unsigned)code);
}

/*
 * A text in quotes. Bytes that are no UTF-8 become U+FFFD, one each, because a reader would reject
 * the whole object. What would steer a terminal or turn the order of letters is escaped, because
 * JSON is read there, too.
 */
static void put_text(FILE *file, const char *text)
{
	const unsigned char *s = (const unsigned char *)text;

	putc('"', file);
	while (*s) {
		const size_t length = rb_utf8_size((const char *)s);
		if (length == 0) {
			fputs("\\ufffd", file);
			s++;
			continue;
		}
		if (*s == '"' || *s == '\\')
			fprintf(file, "\\%c", *s);
		else if (*s == '\n')
			fputs("\\n", file);
		else if (rb_visible_size((const char *)s) == 0)
			put_code(file, rb_utf8_code((const char *)s, length));
		else
			fwrite(s, 1, length, file);
		s += length;
	}
	putc('"', file);
}

/* What comes before any value: a comma where one is due, and the name (NULL: within an array). */
static void begin(struct rb_json *json, const char *name)
{
	if (json->follows)
		putc(',', json->file);
	json->follows = true;
	if (name) {
		put_text(json->file, name);
		putc(':', json->file);
	}
}

void rb_json_open(struct rb_json *json, const char *name, char bracket)
{
	RB_ASSERT(bracket == '{' || bracket == '[');
	begin(json, name);
	putc(bracket, json->file);
	json->follows = false;
}

void rb_json_close(struct rb_json *json, char bracket)
{
	RB_ASSERT(bracket == '}' || bracket == ']');
	putc(bracket, json->file);
	json->follows = true;
}

void rb_json_text(struct rb_json *json, const char *name, const char *value)
{
	begin(json, name);
	if (value)
		put_text(json->file, value);
	else
		fputs("null", json->file);
}

void rb_json_number(struct rb_json *json, const char *name, double value)
{
	begin(json, name);
	if (isfinite(value))
		fprintf(json->file, "%.17g", value);
	else
		fputs("null", json->file);
}

void rb_json_count(struct rb_json *json, const char *name, uint64_t value)
{
	begin(json, name);
	fprintf(json->file, "%" PRIu64, value);
}

void rb_json_bool(struct rb_json *json, const char *name, bool value)
{
	begin(json, name);
	fputs(value ? "true" : "false", json->file);
}

void rb_json_vector(struct rb_json *json, const char *name, const double *value, int count)
{
	RB_ASSERT(count >= 0);
	rb_json_open(json, name, '[');
	for (int i = 0; i < count; i++)
		rb_json_number(json, NULL, value[i]);
	rb_json_close(json, ']');
}
