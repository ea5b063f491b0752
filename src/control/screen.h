/* SPDX-License-Identifier: MIT */
/*
 * The terminal: curses, its colours, its keys, and giving it back whatever happens. Part of
 * rbsim-console.so.
 *
 * One at a time in a process, one thread. While it is open standard error goes to memory, if it was
 * the terminal, and is told when the screen is closed; a signal that ends the process gives the
 * terminal back first.
 */
#ifndef RB_CONTROL_SCREEN_H
#define RB_CONTROL_SCREEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

#include "control/layout.h"
#include "control/mosaic.h"

struct rb_screen;

enum rb_style { RB_STYLE_PLAIN, RB_STYLE_STRONG, RB_STYLE_FAINT, RB_STYLE_BAR, RB_STYLE_WARNING };

/* RB_ERR_MISSING: this terminal can't be written to anywhere but at the cursor, or is not known. */
RB_CHECKED enum rb_status rb_screen_open(struct rb_screen **screen, struct rb_error *err);
void rb_screen_close(struct rb_screen *screen); /* NULL is fine */

/* "ncurses 6.4.20221231" */
void rb_screen_library(char *out, size_t size);

void rb_screen_size(const struct rb_screen *screen, int *width, int *height);
enum rb_palette rb_screen_palette(const struct rb_screen *screen);
bool rb_screen_blocks(const struct rb_screen *screen); /* it shows more than ASCII */

/* Nothing is shown before rb_screen_flush. */
void rb_screen_cell(struct rb_screen *screen, int x, int y, rb_cell cell);
void rb_screen_glyph(struct rb_screen *screen, int x, int y, uint32_t glyph, enum rb_style style);
/* UTF-8, cut and filled up to the width of `area` in its row `row`. */
void rb_screen_text(struct rb_screen *screen, rb_area area, int row, enum rb_style style,
                    const char *text);
void rb_screen_clear(struct rb_screen *screen);
/* The whole screen is sent anew with the next flush. */
void rb_screen_redraw(struct rb_screen *screen);
/* Sends what has changed. The cursor is at x, y; x < 0: nowhere. */
void rb_screen_flush(struct rb_screen *screen, int x, int y);

/* What the left button does; moved: while it is held. */
enum rb_mouse { RB_MOUSE_OTHER, RB_MOUSE_PRESSED, RB_MOUSE_MOVED, RB_MOUSE_RELEASED };

/* A key (control/keys.h) or a character. */
struct rb_input_key {
	uint32_t key;
	int x, y;  /* of RB_KEY_MOUSE */
	int wheel; /* -1 up, 1 down, 0: the left button */
	enum rb_mouse mouse;
};
/* False: none has come. */
bool rb_screen_key(struct rb_screen *screen, struct rb_input_key *key);
/* Until a key comes, a signal, or this moment of base/clock. */
void rb_screen_wait(struct rb_screen *screen, uint64_t until_ns);
/* The signal that asked for an end, 0: none. */
int rb_screen_signal(const struct rb_screen *screen);

#endif
