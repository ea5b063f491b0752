/* SPDX-License-Identifier: MIT */
/*
 * The table maps a status to the exit code of sysexits.h(3) where it has a fitting one (64 to 76)
 * and to 128 + signal for an interruption, as shells report it; scripts of a sweep decide by it
 * whether to retry. Messages are formatted into the record itself, of fixed size, because an error
 * of memory must be reported without memory.
 */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

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

enum rb_status rb_error_set(struct rb_error *err, enum rb_status status, const char *file, int line,
                            const char *format, ...)
{
	if (!err)
		return status;

	/* Into a buffer of its own: the text may quote the record it replaces ("%s: %s"). */
	char text[RB_ERROR_TEXT_SIZE];
	va_list arguments;
	va_start(arguments, format);
	const int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);

	*err = (struct rb_error){.status = status, .file = file, .line = line};
	if (length < 0)
		return status;
	size_t end = 0;
	for (; text[end]; end++)
		err->text[end] = text[end];
	if ((size_t)length < sizeof text)
		return status;
	/* Cut: not inside a UTF-8 character, and visibly. */
	end = sizeof text - 4;
	while (end > 0 && ((unsigned char)err->text[end] & 0xc0) == 0x80)
		end--;
	for (int i = 0; i < 3; i++)
		err->text[end++] = '.';
	err->text[end] = '\0';
	return status;
}

_Noreturn void rb_bug(const char *file, int line, const char *what)
{
	fprintf(stderr, "rbsim: bug at %s:%d: %s\n", file, line, what);
	abort();
}
