/* SPDX-License-Identifier: MIT */
/*
 * The line in which commands are typed, with those that were typed before. Knows no terminal.
 * Values, one thread.
 */
#ifndef RB_CONTROL_PROMPT_H
#define RB_CONTROL_PROMPT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "control/command.h"

enum { RB_PROMPT_HISTORY = 64 };

/* Zeroed is a good start. */
struct rb_prompt {
	bool open;
	char lead;                       /* ':' a command, '/' a part of a body's name */
	char text[RB_COMMAND_LINE_SIZE]; /* UTF-8, zero-terminated */
	size_t size, at;                 /* bytes; the cursor, between characters */
	uint64_t count, browsed;         /* lines ever kept; which one is fetched, `count`: none */
	char history[RB_PROMPT_HISTORY][RB_COMMAND_LINE_SIZE];
};

enum rb_prompt_verdict { RB_PROMPT_STAYS, RB_PROMPT_DONE, RB_PROMPT_LEFT };

void rb_prompt_open(struct rb_prompt *prompt, char lead, const char *text);
/*
 * A key (control/keys.h or a character). After DONE the text is the line; it is closed then, as
 * after LEFT.
 */
enum rb_prompt_verdict rb_prompt_key(struct rb_prompt *prompt, uint32_t key);

/*
 * Continues the word before the cursor as far as all candidates agree; how many there are, the
 * first ones in `out`, which is to be told when there are several.
 */
int rb_prompt_complete(struct rb_prompt *prompt, const struct rb_command_names *names,
                       const char **out, int most);

#endif
