/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: any bytes as a command, as a line being typed, and as a frame from a socket. What must hold: a command is
 * understood or refused with a text of one line, continuations begin with what was typed, a frame that is taken is written
 * and read again as the same one, and everything taken is given back.
 */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "control/command.h"
#include "control/wire.h"
#include "flow/frame.h"

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

static void need(int holds)
{
	if (!holds)
		abort();
}

static const char *body_name(void *user, enum rb_command_kind kind, int index)
{
	static const char *const names[] = {"ball", "left ball", "#3"};

	(void)user, (void)kind;
	return index < 3 ? names[index] : NULL;
}

static void try_command(const char *line)
{
	const struct rb_command_names names = {.name = body_name};
	const char *out[8];
	struct rb_command command;
	struct rb_error err = {0};
	bool given = true;

	const enum rb_status status = rb_command_parse(&command, &given, line, &err);
	need(status == RB_OK || (status == RB_ERR_USAGE && !given && err.text[0]));
	need(!strpbrk(err.text, "\n\r\x1b"));
	if (given) {
		need(command.kind < RB_COMMAND_KIND_COUNT);
		need(strlen(command.text) < sizeof command.text);
		need(strlen(command.value) < sizeof command.value);
	}
	const int count = rb_command_complete(line, &names, out, 8);
	need(count >= 0 && count <= 8);
	for (int i = 0; i < count; i++)
		need(out[i] && strlen(out[i]) > 0);
}

static void try_frame(const char *line, size_t size)
{
	struct rb_frame frame = {0}, again = {0};
	char *text = NULL, *second = NULL;
	size_t capacity = 0, second_capacity = 0, text_size, second_size;
	const int bodies = size > 8 ? line[8] & 7 : 0;

	if (rb_wire_read_frame(&frame, bodies, line, size, NULL) == RB_OK) {
		need(rb_wire_write_frame(&text, &capacity, &text_size, &frame, NULL) == RB_OK);
		need(rb_wire_read_frame(&again, bodies, text, text_size, NULL) == RB_OK);
		need(rb_wire_write_frame(&second, &second_capacity, &second_size, &again, NULL) ==
		     RB_OK);
		need(text_size == second_size && memcmp(text, second, text_size) == 0);
	}
	rb_memory_free(text);
	rb_memory_free(second);
	rb_frame_release(&frame);
	rb_frame_release(&again);
}

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	const struct rb_memory_counts before = rb_memory_counts();
	char *const line = malloc(
		size + 1); /* of its exact size, so that the sanitizer sees who reads beyond it */

	need(line != NULL);
	if (size > 0)
		memcpy(line, bytes, size);
	line[size] = '\0';
	try_command(line);
	try_frame(line, size);
	free(line);
	const struct rb_memory_counts after = rb_memory_counts();
	need(after.taken - after.freed == before.taken - before.freed);
	return 0;
}
