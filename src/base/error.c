/* SPDX-License-Identifier: MIT */
/*
 * The table maps a status to the exit code of sysexits.h(3) where it has a fitting one (64 to 76)
 * and to 128 + signal for an interruption, as shells report it; scripts of a sweep decide by it
 * whether to retry. Messages are formatted into the record itself, of fixed size, because an error
 * of memory must be reported without memory.
 */
#include "base/error.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of a message before it is cut: two names as long as can be, and what is said of them. */
enum { LONGEST = 9216 };
static const char left_out[] = "...";

static const struct {
	int exit_code;
	const char *name;
} status_table[RB_STATUS_COUNT] = {
	[RB_OK] = {0, "ok"},
	[RB_ERR_EXPECT] = {1, "expectation failed"},
	[RB_ERR_USAGE] = {64, "usage"},
	[RB_ERR_SCENE] = {65, "scene"},
	[RB_ERR_INPUT] = {66, "input"},
	[RB_ERR_MISSING] = {69, "missing"},
	[RB_ERR_BUG] = {70, "bug"},
	[RB_ERR_MEMORY] = {71, "memory"},
	[RB_ERR_CREATE] = {73, "create"},
	[RB_ERR_IO] = {74, "write"},
	[RB_ERR_AGAIN] = {75, "checkpointed"},
	[RB_ERR_PHYSICS] = {76, "physics"},
	[RB_ERR_INTERRUPT] = {130, "interrupted"},
	[RB_ERR_TERMINATE] = {143, "terminated"},
};

/* A status from outside the enum can only be ours. */
static enum rb_status known(enum rb_status status)
{
	return (unsigned)status < RB_STATUS_COUNT ? status : RB_ERR_BUG;
}

int rb_status_exit_code(enum rb_status status)
{
	return status_table[known(status)].exit_code;
}

const char *rb_status_name(enum rb_status status)
{
	return status_table[known(status)].name;
}

/* True for a byte of UTF-8 within a character. */
static bool is_inside(char byte)
{
	return ((unsigned char)byte & 0xc0) == 0x80;
}

/*
 * Copies a text; of one that is too long the middle is left out, visibly: it begins with what
 * failed and ends with the reason, and what is long is the name of a file between these.
 */
static void copy_cut(char out[RB_ERROR_TEXT_SIZE], const char *text)
{
	const size_t length = strlen(text), room = RB_ERROR_TEXT_SIZE - sizeof left_out;
	size_t head = room / 2, tail = length - (room - room / 2);

	if (length < RB_ERROR_TEXT_SIZE) {
		memcpy(out, text, length + 1);
		return;
	}
	while (head > 0 && is_inside(text[head]))
		head--;
	while (is_inside(text[tail]))
		tail++;
	memcpy(out, text, head);
	memcpy(out + head, left_out, sizeof left_out - 1);
	memcpy(out + head + sizeof left_out - 1, text + tail, length - tail + 1);
}

const char *rb_error_place(const char *file, int line, char *out, size_t size)
{
	char number[16] = "";
	size_t from = 0;

	if (line > 0)
		snprintf(number, sizeof number, ":%d", line);
	const size_t length = strlen(file), rest = strlen(number) + sizeof ": ";
	RB_ASSERT(size > rest + sizeof left_out);
	const bool cut = length + rest > size;
	if (cut)
		for (from = length + rest + sizeof left_out - 1 - size; is_inside(file[from]);)
			from++;
	snprintf(out, size, "%s%s%s: ", cut ? left_out : "", file + from, number);
	return out;
}

enum rb_status rb_error_set(struct rb_error *err, enum rb_status status, const char *file, int line,
                            const char *format, ...)
{
	if (!err)
		return status;

	/* Into a buffer of its own: the text may quote the record it replaces ("%s: %s"). */
	char text[LONGEST];
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);

	*err = (struct rb_error){.status = status, .file = file, .line = line};
	if (length >= (int)sizeof text) {
		size_t end = sizeof text - sizeof left_out;

		while (end > 0 && is_inside(text[end]))
			end--;
		memcpy(text + end, left_out, sizeof left_out);
	}
	if (length >= 0)
		copy_cut(err->text, text);
	return status;
}

_Noreturn void rb_bug(const char *file, int line, const char *what)
{
	fprintf(stderr, "rbsim: bug at %s:%d: %s\n", file, line, what);
	abort();
}
