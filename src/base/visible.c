/* SPDX-License-Identifier: MIT */
/*
 * Escapes by code point rather than by the terminal's own tables (iswprint), whose answer depends
 * on the locale and the C library: the same text is written the same way everywhere. The printf
 * subset reads the format itself, because only the conversion %s may be escaped while the format's
 * own newlines pass; numbers are formatted by snprintf. Output is collected in 2 KiB so that a
 * message is one write and lines of several threads do not mix.
 */
#include "base/visible.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/error.h"

size_t rb_utf8_size(const char *text)
{
	/* RFC 3629, section 4: first byte, second byte, size; further bytes are 80..bf */
	static const struct {
		unsigned char first_low, first_high, second_low, second_high, size;
	} forms[] = {
		{0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
		{0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3},
		{0xee, 0xef, 0x80, 0xbf, 3}, {0xf0, 0xf0, 0x90, 0xbf, 4},
		{0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
	};
	const unsigned char *const at = (const unsigned char *)text;

	if (at[0] < 0x80)
		return at[0] > 0;
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		if (at[0] < forms[i].first_low || at[0] > forms[i].first_high ||
		    at[1] < forms[i].second_low || at[1] > forms[i].second_high)
			continue;
		for (int k = 2; k < forms[i].size; k++)
			if (at[k] < 0x80 || at[k] > 0xbf)
				return 0;
		return forms[i].size;
	}
	return 0;
}

uint32_t rb_utf8_code(const char *at, size_t size)
{
	RB_ASSERT_COSTLY(size >= 1 && size <= 4);

	uint32_t code = size == 1 ? (unsigned char)*at : (unsigned char)*at & (0x7fu >> size);

	for (size_t i = 1; i < size; i++)
		code = code << 6 | ((unsigned char)at[i] & 0x3f);
	return code;
}

size_t rb_visible_size(const char *at)
{
	/*
	 * C0, DEL and C1, soft hyphen, Arabic letter mark, zero width space, direction marks,
	 * separators and embeddings, word joiner to deprecated formats, byte order mark,
	 * annotations, tags (Unicode, general categories Cc, Cf, Zl, Zp)
	 */
	static const struct {
		uint32_t low, high;
	} hidden[] = {
		{0, 0x1f},        {0x7f, 0x9f},     {0xad, 0xad},       {0x61c, 0x61c},
		{0x200b, 0x200b}, {0x200e, 0x200f}, {0x2028, 0x202e},   {0x2060, 0x206f},
		{0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe007f},
	};
	const size_t size = rb_utf8_size(at);
	const uint32_t code = rb_utf8_code(at, size > 0 ? size : 1);

	for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++)
		if (code >= hidden[i].low && code <= hidden[i].high)
			return 0;
	return size;
}

size_t rb_visible_escape(const char *at, char out[16])
{
	const size_t size = rb_utf8_size(at);

	if (*at == '\n')
		strcpy(out, "\\n");
	else if (size > 1)
		snprintf(out, 16, "\\u{%x}", (unsigned)rb_utf8_code(at, size));
	else
		snprintf(out, 16, "\\x%02x", (unsigned)(unsigned char)*at);
	return size > 0 ? size : 1;
}

/* ---- what goes out, in few writes ---- */

struct out {
	FILE *file;
	size_t used;
	char bytes[2048];
};

/* A failed write shows in ferror, which the program checks before it exits. */
static void flush(struct out *out)
{
	(void)!fwrite(out->bytes, 1, out->used, out->file);
	out->used = 0;
}

static void put(struct out *out, const char *bytes, size_t size)
{
	while (size > 0) {
		const size_t room = sizeof out->bytes - out->used;
		const size_t part = size < room ? size : room;
		memcpy(out->bytes + out->used, bytes, part);
		out->used += part;
		bytes += part;
		size -= part;
		if (out->used == sizeof out->bytes)
			flush(out);
	}
}

/*
 * Writes up to `most` bytes of the text, escaped, and returns the number of bytes written; with
 * `out` NULL only counts them. A character that `most` would cut is left out.
 */
static size_t put_visible(struct out *out, const char *text, size_t most)
{
	size_t at = 0, put_size = 0;

	while (at < most && text[at]) {
		char escape[16];
		const char *shown = text + at;
		size_t size = text[at] == '\t' ? 1 : rb_visible_size(text + at), shown_size = size;
		if (size == 0 || at + size > most) {
			size = rb_visible_escape(text + at, escape);
			shown = escape;
			shown_size = strlen(escape);
		}
		if (at + size > most) /* cut inside of a character */
			break;
		if (out)
			put(out, shown, shown_size);
		put_size += shown_size;
		at += size;
	}
	return put_size;
}

static void pad(struct out *out, size_t size)
{
	while (size-- > 0)
		put(out, " ", 1);
}

/* ---- printf ---- */

struct conversion {
	char text[32]; /* the conversion itself, widths filled in */
	bool left;
	int width, precision; /* precision < 0: none */
	int longs;            /* 1: l, z, j, t; 2: ll; all of 64 bits here */
	char kind;
};

/* %s: width and precision count bytes of the shown text and of the source text, respectively. */
static void put_text(struct out *out, const struct conversion *c, const char *text)
{
	const size_t most = c->precision < 0 ? SIZE_MAX : (size_t)c->precision;
	const char *const shown = text ? text : "(none)";
	const size_t size = c->width > 0 ? put_visible(NULL, shown, most) : 0;
	const size_t gap = (size_t)c->width > size ? (size_t)c->width - size : 0;

	if (!c->left)
		pad(out, gap);
	put_visible(out, shown, most);
	if (c->left)
		pad(out, gap);
}

/*
 * Reads a decimal number of the format; digits beyond 99999 are skipped, not summed, against
 * overflow.
 */
static int digits(const char **at)
{
	int value = 0;

	for (; **at >= '0' && **at <= '9'; ++*at)
		value = value < 10000 ? 10 * value + (**at - '0') : value;
	return value;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral" /* pieces of formats that were checked */
static void put_value(struct out *out, const struct conversion *c, va_list *arguments)
{
	char text[512];
	int size;

	switch (c->kind) {
	case 'c':
		size = snprintf(text, sizeof text, c->text, va_arg(*arguments, int));
		break;
	case 'd':
	case 'i':
		size = c->longs == 0 ? snprintf(text, sizeof text, c->text, va_arg(*arguments, int))
		                     : snprintf(text, sizeof text, c->text,
		                                va_arg(*arguments, long long));
		break;
	case 'u':
	case 'x':
		size = c->longs == 0
		               ? snprintf(text, sizeof text, c->text, va_arg(*arguments, unsigned))
		               : snprintf(text, sizeof text, c->text,
		                          va_arg(*arguments, unsigned long long));
		break;
	default:
		RB_ASSERT(strchr("fega", c->kind));
		size = snprintf(text, sizeof text, c->text, va_arg(*arguments, double));
		break;
	}
	if (size > 0)
		put(out, text, (size_t)size < sizeof text ? (size_t)size : sizeof text - 1);
}
#pragma GCC diagnostic pop

/*
 * Parses one conversion after the '%' and returns the position behind it. All long arguments are
 * fetched as 64 bits: long, long long and size_t have one size here, as the assertion checks.
 */
static const char *read_conversion(const char *at, struct conversion *c, va_list *arguments)
{
	_Static_assert(sizeof(long) == sizeof(long long) && sizeof(size_t) == sizeof(long long),
	               "rb_print takes all long values as 64 bits");
	char flags[8] = "";
	size_t flag_count = 0;

	*c = (struct conversion){.precision = -1};
	for (; *at && strchr("-+ 0#", *at); at++)
		if (flag_count < sizeof flags - 1)
			flags[flag_count++] = *at;
	flags[flag_count] = '\0';
	c->left = strchr(flags, '-') != NULL;
	if (*at == '*') {
		c->width = va_arg(*arguments, int);
		at++;
	} else {
		c->width = digits(&at);
	}
	if (c->width < 0) {
		c->left = true;
		c->width = -c->width;
	}
	if (*at == '.') {
		at++;
		if (*at == '*') {
			c->precision = va_arg(*arguments, int);
			at++;
		} else {
			c->precision = digits(&at);
		}
	}
	for (; *at && strchr("lzjt", *at); at++)
		c->longs++;
	c->kind = *at;
	char width[12] = "", precision[13] = "";
	if (c->width > 0)
		snprintf(width, sizeof width, "%s%d", c->left && !strchr(flags, '-') ? "-" : "",
		         c->width);
	if (c->precision >= 0)
		snprintf(precision, sizeof precision, ".%d", c->precision % 1000);
	snprintf(c->text, sizeof c->text, "%%%s%.5s%.5s%s%c", flags, width, precision,
	         c->longs ? "ll" : "", c->kind);
	return *at ? at + 1 : at;
}

void rb_print(FILE *file, const char *format, ...)
{
	struct out out = {.file = file};
	va_list arguments;

	va_start(arguments, format);
	while (*format) {
		const size_t plain = strcspn(format, "%");
		struct conversion c;
		put(&out, format, plain);
		format += plain;
		if (*format == '\0')
			break;
		if (*++format == '%') {
			put(&out, format++, 1);
			continue;
		}
		format = read_conversion(format, &c, &arguments);
		if (c.kind == 's')
			put_text(&out, &c, va_arg(arguments, const char *));
		else
			put_value(&out, &c, &arguments);
	}
	va_end(arguments);
	flush(&out);
}

void rb_print_lines(FILE *file, const char *text, size_t size)
{
	struct out out = {.file = file};

	while (size > 0 && *text) {
		const char *const end = memchr(text, '\n', size);
		const size_t line = end ? (size_t)(end - text) : size;
		put_visible(&out, text, line);
		put(&out, "\n", 1);
		text += line + (end ? 1 : 0);
		size -= line + (end ? 1 : 0);
	}
	flush(&out);
}
