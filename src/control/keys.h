/* SPDX-License-Identifier: MIT */
/*
 * The keys of the console, one table row each: a key stands for a command of control/command, for
 * the beginning of one that is then typed on, or for something of the console itself. Help and
 * manual page read the same rows. Knows no terminal.
 */
#ifndef RB_CONTROL_KEYS_H
#define RB_CONTROL_KEYS_H

#include <stdint.h>
#include <stdio.h>

/* Keys without a character of their own, behind all of Unicode. */
enum {
	RB_KEY_LEFT = 0x110000,
	RB_KEY_RIGHT,
	RB_KEY_UP,
	RB_KEY_DOWN,
	RB_KEY_HOME,
	RB_KEY_END,
	RB_KEY_PAGE_UP,
	RB_KEY_PAGE_DOWN,
	RB_KEY_SHIFT_LEFT,
	RB_KEY_SHIFT_RIGHT,
	RB_KEY_ENTER,
	RB_KEY_TAB,
	RB_KEY_BACKSPACE,
	RB_KEY_DELETE,
	RB_KEY_ESCAPE,
	RB_KEY_RESIZE,
	RB_KEY_MOUSE
};

/* What a key of the console itself does. */
enum rb_key_action {
	RB_KEY_RUNS,    /* its line is a command */
	RB_KEY_TYPES,   /* its line is the beginning of one */
	RB_KEY_SEEKS,   /* its line is a share of the run, in percent, to go on by */
	RB_KEY_SCALES,  /* its line is a factor for the speed */
	RB_KEY_ENDS,    /* the last frame; of what goes on: whatever is the last one */
	RB_KEY_FOLLOWS, /* the body that is looked at, or none */
	RB_KEY_CAMERA,  /* the next camera */
	RB_KEY_TOGGLES_STOP,
	RB_KEY_TOGGLES_VIEW,
	RB_KEY_SEARCHES,
	RB_KEY_HELPS,
	RB_KEY_REDRAWS
};

struct rb_key_row {
	uint32_t key;
	const char *name; /* as it is told: "left" */
	enum rb_key_action action;
	const char *line;
	const char *help;
};
extern const struct rb_key_row rb_key_rows[];
extern const int rb_key_row_count;

/* NULL: the key stands for nothing. */
const struct rb_key_row *rb_key_find(uint32_t key);

/* All rows as an mdoc list, for the manual page (tools/check-manual). */
void rb_keys_print_manual(FILE *file);

#endif
