/* SPDX-License-Identifier: MIT */
/*
 * Appends never fail at once: an answer that found no memory remembers it and is replaced by one
 * error line at its end. So the code that composes answers has no error paths, and a client never
 * sees half an answer as a whole one.
 */
#include "control/answer.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "control/command.h"

/*
 * Bytes of one line, with the leading space and the end; longer ones are cut. A command line is as
 * long.
 */
enum { LINE_SIZE = 1024 };

void rb_answer_put(struct rb_answer *answer, const char *bytes, size_t size)
{
	RB_ASSERT(answer->size <= answer->capacity);
	if (answer->lost ||
	    !rb_memory_reserve(&answer->text, &answer->capacity, answer->size + size, 1)) {
		answer->lost = true;
		return;
	}
	memcpy(answer->text + answer->size, bytes, size);
	answer->size += size;
}

/*
 * Replaces whatever is not printable by '?': a text that is not ours, such as a body's name, must
 * neither end a line nor steer a terminal.
 */
static void clean(char *text)
{
	while (*text) {
		const size_t one = rb_command_character(text);
		if (one == 0 || *text == '\t')
			*text = '?';
		text += one > 0 ? one : 1;
	}
}

void rb_answer_line(struct rb_answer *answer, const char *format, ...)
{
	char line[LINE_SIZE];
	va_list arguments;

	line[0] = ' ';
	va_start(arguments, format);
	vsnprintf(line + 1, sizeof line - 2, format, arguments);
	va_end(arguments);
	clean(line);
	strcat(line, "\n");
	rb_answer_put(answer, line, strlen(line));
}

void rb_answer_end(struct rb_answer *answer, enum rb_status status, const struct rb_error *err)
{
	static const char out_of_memory[] = "error out of memory\n";
	char line[RB_ERROR_TEXT_SIZE + 16] = "ok";

	RB_ASSERT(status == RB_OK || err);
	if (answer->lost) {
		/* room for it was there when the answer began, or is now */
		answer->lost = false;
		rb_answer_put(answer, out_of_memory, strlen(out_of_memory));
		return;
	}
	if (status)
		snprintf(line, sizeof line - 1, "error %s",
		         *err->text ? err->text : rb_status_name(status));
	clean(line);
	strcat(line, "\n");
	rb_answer_put(answer, line, strlen(line));
}

void rb_answer_release(struct rb_answer *answer)
{
	rb_memory_free(answer->text);
	*answer = (struct rb_answer){0};
}
