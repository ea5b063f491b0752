/* SPDX-License-Identifier: MIT */
/*
 * A text with a cursor, edited in bytes of UTF-8: positions always are between characters, and
 * deletions take whole ones. The commonest keys of GNU readline are understood. The history is a
 * ring of lines; the line under way is not part of it until it is finished.
 */
#include "control/prompt.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "control/keys.h"

void rb_prompt_open(struct rb_prompt *prompt, char lead, const char *text)
{
	prompt->open = true;
	prompt->lead = lead;
	snprintf(prompt->text, sizeof prompt->text, "%s", text);
	prompt->size = prompt->at = strlen(prompt->text);
	prompt->browsed = prompt->count;
}

/* Inserts bytes at the cursor and moves it behind them; nothing happens where they do not fit. */
static void insert(struct rb_prompt *prompt, const char *bytes, size_t size)
{
	RB_ASSERT(prompt->at <= prompt->size);
	if (prompt->size + size >= sizeof prompt->text)
		return;
	memmove(prompt->text + prompt->at + size, prompt->text + prompt->at,
	        prompt->size - prompt->at + 1);
	memcpy(prompt->text + prompt->at, bytes, size);
	prompt->size += size;
	prompt->at += size;
}

/* Inserts a code point as UTF-8 (RFC 3629). */
static void insert_character(struct rb_prompt *prompt, uint32_t c)
{
	char bytes[4];
	size_t size = 1;

	RB_ASSERT(c < 0x110000);
	if (c < 0x80) {
		bytes[0] = (char)c;
	} else {
		size = c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
		for (size_t i = size - 1; i > 0; i--, c >>= 6)
			bytes[i] = (char)(0x80 | (c & 0x3f));
		bytes[0] = (char)((size == 2 ? 0xc0u : size == 3 ? 0xe0u : 0xf0u) | c);
	}
	insert(prompt, bytes, size);
}

/* Whether the byte continues a character of UTF-8. */
static bool is_inside(char c)
{
	return ((unsigned char)c & 0xc0) == 0x80;
}

/* Where the character before `at` begins; 0 at the beginning. */
static size_t before(const struct rb_prompt *prompt, size_t at)
{
	RB_ASSERT(at <= prompt->size);
	do
		at -= at > 0;
	while (at > 0 && is_inside(prompt->text[at]));
	return at;
}

/* Where the character at `at` ends; the size at the end. */
static size_t behind(const struct rb_prompt *prompt, size_t at)
{
	RB_ASSERT(at <= prompt->size);
	do
		at += at < prompt->size;
	while (at < prompt->size && is_inside(prompt->text[at]));
	return at;
}

/* Removes the bytes of [from, to); the cursor is where they were. */
static void erase(struct rb_prompt *prompt, size_t from, size_t to)
{
	RB_ASSERT(from <= to && to <= prompt->size);
	memmove(prompt->text + from, prompt->text + to, prompt->size - to + 1);
	prompt->size -= to - from;
	prompt->at = from;
}

/* Appends the line to the history, unless it is empty or the same as the last one. */
static void keep(struct rb_prompt *prompt)
{
	const char *const last = prompt->count > 0
	                                 ? prompt->history[(prompt->count - 1) % RB_PROMPT_HISTORY]
	                                 : "";

	if (prompt->size == 0 || strcmp(last, prompt->text) == 0)
		return;
	memcpy(prompt->history[prompt->count++ % RB_PROMPT_HISTORY], prompt->text,
	       sizeof prompt->text);
}

/* Fetches an earlier line (by -1) or a later one (1); behind the last one an empty line. */
static void browse(struct rb_prompt *prompt, int by)
{
	const uint64_t first = prompt->count > RB_PROMPT_HISTORY ? prompt->count - RB_PROMPT_HISTORY
	                                                         : 0;

	RB_ASSERT(by == -1 || by == 1);
	if (by < 0 ? prompt->browsed <= first : prompt->browsed >= prompt->count)
		return;
	prompt->browsed += by < 0 ? (uint64_t)-1 : 1;
	const char *const line = prompt->browsed < prompt->count
	                                 ? prompt->history[prompt->browsed % RB_PROMPT_HISTORY]
	                                 : "";
	snprintf(prompt->text, sizeof prompt->text, "%s", line);
	prompt->size = prompt->at = strlen(prompt->text);
}

/* Closes the prompt. */
static enum rb_prompt_verdict leave(struct rb_prompt *prompt, enum rb_prompt_verdict verdict)
{
	prompt->open = false;
	return verdict;
}

enum rb_prompt_verdict rb_prompt_key(struct rb_prompt *prompt, uint32_t key)
{
	enum { CTRL_A = 1, CTRL_C = 3, CTRL_E = 5, CTRL_U = 21, CTRL_W = 23 };
	size_t from = prompt->at;

	switch (key) {
	case RB_KEY_ENTER:
		keep(prompt);
		return leave(prompt, RB_PROMPT_DONE);
	case RB_KEY_ESCAPE:
	case CTRL_C:
		return leave(prompt, RB_PROMPT_LEFT);
	case RB_KEY_BACKSPACE:
		if (prompt->size == 0)
			return leave(prompt, RB_PROMPT_LEFT);
		erase(prompt, before(prompt, prompt->at), prompt->at);
		break;
	case RB_KEY_DELETE:
		erase(prompt, prompt->at, behind(prompt, prompt->at));
		break;
	case RB_KEY_LEFT:
		prompt->at = before(prompt, prompt->at);
		break;
	case RB_KEY_RIGHT:
		prompt->at = behind(prompt, prompt->at);
		break;
	case RB_KEY_HOME:
	case CTRL_A:
		prompt->at = 0;
		break;
	case RB_KEY_END:
	case CTRL_E:
		prompt->at = prompt->size;
		break;
	case RB_KEY_UP:
		browse(prompt, -1);
		break;
	case RB_KEY_DOWN:
		browse(prompt, 1);
		break;
	case CTRL_U:
		erase(prompt, 0, prompt->at);
		break;
	case CTRL_W:
		while (from > 0 && prompt->text[from - 1] == ' ')
			from--;
		while (from > 0 && prompt->text[from - 1] != ' ')
			from--;
		erase(prompt, from, prompt->at);
		break;
	default:
		if (key >= ' ' && key != 0x7f && key < RB_KEY_LEFT)
			insert_character(prompt, key);
		break;
	}
	return RB_PROMPT_STAYS;
}

/* Bytes in which all candidates agree, cut between characters. */
static size_t common(const char *const *names, int count)
{
	size_t size = strlen(names[0]);

	RB_ASSERT(count > 0);
	for (int i = 1; i < count; i++) {
		size_t same = 0;
		while (same < size && names[i][same] == names[0][same])
			same++;
		size = same;
	}
	while (size > 0 && is_inside(names[0][size]))
		size--;
	return size;
}

int rb_prompt_complete(struct rb_prompt *prompt, const struct rb_command_names *names,
                       const char **out, int most)
{
	char line[RB_COMMAND_LINE_SIZE];

	snprintf(line, sizeof line, "%.*s", (int)prompt->at, prompt->text);
	const int offered = rb_command_complete(line, names, out, most);
	int count = 0;
	for (int i = 0; i < offered; i++)
		if (*out[i])
			out[count++] = out[i];
	if (count == 0)
		return 0;
	/* the word that has begun, with its quote */
	size_t begun = prompt->at;
	const bool quoted = memchr(line, '"', prompt->at) != NULL;
	while (begun > 0 && line[begun - 1] != (quoted ? '"' : ' '))
		begun--;
	RB_ASSERT(begun <= prompt->at);
	const size_t size = common(out, count), typed = prompt->at - begun;
	if (size < typed)
		return count;
	/* a name with spaces is put in quotes as soon as the space would be inserted */
	if (!quoted && strcspn(out[0], " ") < size) {
		erase(prompt, begun, prompt->at);
		insert(prompt, "\"", 1);
		insert(prompt, out[0], size);
		if (count == 1)
			insert(prompt, "\" ", 2);
		return count;
	}
	insert(prompt, out[0] + typed, size - typed);
	if (count == 1)
		insert(prompt, quoted ? "\" " : " ", quoted ? 2 : 1);
	return count;
}
