/* SPDX-License-Identifier: MIT */
/*
 * Texts that are not ours (titles, names, file names, messages of scripts) on their way to people.
 * What would steer a terminal, end a line or turn the order of letters is written as letters: \n,
 * \x1b, \u{202e}. Any thread.
 */
#ifndef RB_BASE_VISIBLE_H
#define RB_BASE_VISIBLE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <rbsim/error.h>

/*
 * Bytes of the UTF-8 character at `at`, 0 where there is none (RFC 3629: no surrogates, no overlong
 * forms) or the text ends. Looks at no byte behind a zero.
 */
size_t rb_utf8_size(const char *at);
/* Number of the character at `at`, which rb_utf8_size() says has `size` bytes. */
uint32_t rb_utf8_code(const char *at, size_t size);
/*
 * The same, but 0 too where the character is a control, C0 or C1, or turns or hides text: marks,
 * embeddings, overrides and isolates of direction, separators of lines and paragraphs, the byte
 * order mark, tags.
 */
size_t rb_visible_size(const char *at);
/*
 * What stands for the byte or character at `at`, which is not visible; returns how many bytes of
 * the text it stands for.
 */
size_t rb_visible_escape(const char *at, char out[16]);

/* The word for so many of a kind. */
static inline const char *rb_text_plural(uint64_t count, const char *one, const char *many)
{
	return count == 1 ? one : many;
}

/*
 * printf, but every text given for a %s is made visible; tabs stay. What stands in `format` itself
 * is ours. Knows d i u x c s f e g a, their flags, widths and sizes. One write where the text is
 * short. The only way in which `app` writes for people.
 */
void rb_print(FILE *file, const char *format, ...) RB_PRINTF(2, 3);
/* A text of several lines, ended: they stay lines. */
void rb_print_lines(FILE *file, const char *text, size_t size);

#endif
