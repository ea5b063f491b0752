/* SPDX-License-Identifier: MIT */
/*
 * A picture as cells of a terminal: two pixels a cell, one above the other, in the colours that
 * there are.
 *
 * Values; knows no terminal. Any thread.
 */
#ifndef RB_CONTROL_MOSAIC_H
#define RB_CONTROL_MOSAIC_H

#include <stdbool.h>
#include <stdint.h>

/* What a terminal can show. */
enum rb_palette {
	RB_PALETTE_NONE, /* characters that are more or less dark */
	RB_PALETTE_8,    /* 0 to 7: black, red, green, yellow, blue, magenta, cyan, white */
	RB_PALETTE_16,   /* and their bright ones */
	RB_PALETTE_256,  /* and a cube of 6x6x6 from 16 on, greys from 232 on */
	RB_PALETTE_TRUE  /* 0xRRGGBB, five bits each: what changes less needs fewer bytes */
};

typedef struct {
	uint32_t glyph;     /* Unicode */
	int32_t fore, back; /* by the palette; -1: the terminal's own */
} rb_cell;

/* The nearest colour of a palette to one in sRGB; 0 for RB_PALETTE_NONE. */
int32_t rb_palette_nearest(enum rb_palette palette, const uint8_t rgb[3]);

/*
 * The cell of two pixels in sRGB; `x`, `y` say where the cell is, for the patterns that stand for
 * colours between those of a small palette. Without `blocks` (no UTF-8) a cell has one colour.
 */
rb_cell rb_mosaic_cell(enum rb_palette palette, bool blocks, const uint8_t above[3],
                       const uint8_t below[3], int x, int y);

#endif
