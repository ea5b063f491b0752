/* SPDX-License-Identifier: MIT */
#include "app/ctl.h"

#include <stdio.h>
#include <string.h>

#include "app/common.h"
#include "app/json.h"
#include "base/memory.h"
#include "base/visible.h"
#include "control/client.h"
#include "control/command.h"

/* s: to find a run that is busy starting; for an answer, longer than any frame should take. */
static const double connect_s = 5, answer_s = 30;

/*
 * Composes the words as one line. A single word is a line already; of several, those with spaces
 * are quoted.
 */
static enum rb_status join(char line[RB_COMMAND_LINE_SIZE + 1], const struct rb_options *options,
                           struct rb_error *err)
{
	const int count = options->word_count - 1;
	size_t used = 0;

	line[0] = '\0';
	for (int i = 0; i < count; i++) {
		const char *const word = options->words[1 + i];
		const bool quoted = count > 1 && (!*word || strpbrk(word, " \t"));
		if (quoted && strchr(word, '"'))
			return RB_FAIL(err, RB_ERR_USAGE,
			               "'%.60s' holds a quote and spaces: no command can say that",
			               word);
		if (used <= RB_COMMAND_LINE_SIZE)
			used += (size_t)snprintf(line + used, RB_COMMAND_LINE_SIZE + 1 - used,
			                         "%s%s%s%s", i > 0 ? " " : "", quoted ? "\"" : "",
			                         word, quoted ? "\"" : "");
	}
	if (used > RB_COMMAND_LINE_SIZE)
		return RB_FAIL(err, RB_ERR_USAGE, "a command of %zu bytes, wanted at most %d", used,
		               RB_COMMAND_LINE_SIZE);
	return RB_OK;
}

/* The whole answer as one object; its lines as an array. */
static void print_json(const struct rb_options *options, const char *line, const char *lines,
                       const struct rb_error *err)
{
	struct rb_json json = {.file = stdout};
	char *const all = rb_memory_copy_text(lines);

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "socket", options->words[0]);
	rb_json_text(&json, "command", line);
	rb_json_text(&json, "status", err->status ? "error" : "ok");
	rb_json_text(&json, "error", err->status ? err->text : NULL);
	rb_json_count(&json, "exit_status", (uint64_t)rb_status_exit_code(err->status));
	rb_json_open(&json, "lines", '[');
	for (char *at = all, *end; at && (end = strchr(at, '\n')); at = end + 1) {
		*end = '\0';
		rb_json_text(&json, NULL, at);
	}
	rb_json_close(&json, ']');
	rb_json_close(&json, '}');
	putchar('\n');
	rb_memory_free(all);
}

int rb_ctl_main(const struct rb_options *options)
{
	struct rb_client *client = NULL;
	struct rb_error err = {0};
	char line[RB_COMMAND_LINE_SIZE + 1];
	const char *lines = "";
	size_t size = 0;
	enum rb_status status = join(line, options, &err);

	if (!status)
		status = rb_client_connect(&client, options->words[0], connect_s, &err);
	if (!status)
		status = rb_client_request(client, line, answer_s, &lines, &size, &err);
	if (options->json)
		print_json(options, line, lines, &err);
	else
		rb_print_lines(stdout, lines,
		               size); /* rb_app_finish looks whether it was written */
	const int exit_code = status ? rb_app_fail(options, &err) : 0;
	rb_client_close(client);
	return rb_app_finish(options, exit_code);
}
