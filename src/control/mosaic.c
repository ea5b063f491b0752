/* SPDX-License-Identifier: MIT */
#include "control/mosaic.h"

#include <stdlib.h>

enum { UPPER_HALF = 0x2580, CUBE = 16, GREYS = 232, DITHER = 4 };

/* Those of xterm; other terminals have others, none can be asked. */
static const uint8_t ansi[16][3] = {
	{0, 0, 0},       {205, 0, 0},   {0, 205, 0},   {205, 205, 0},
	{0, 0, 238},     {205, 0, 205}, {0, 205, 205}, {229, 229, 229},
	{127, 127, 127}, {255, 0, 0},   {0, 255, 0},   {255, 255, 0},
	{92, 92, 255},   {255, 0, 255}, {0, 255, 255}, {255, 255, 255},
};

/* The eye sees green best; a hue that is wrong is worse than a lightness that is. */
static int distance(const uint8_t a[3], const int b[3])
{
	const int red = a[0] - b[0], green = a[1] - b[1], blue = a[2] - b[2];

	return 2 * red * red + 4 * green * green + 3 * blue * blue;
}

static int32_t nearest_ansi(const uint8_t rgb[3], int count)
{
	int best = 0, least = -1;

	for (int i = 0; i < count; i++) {
		const int color[3] = {ansi[i][0], ansi[i][1], ansi[i][2]};
		const int d = distance(rgb, color);
		if (least < 0 || d < least) {
			least = d;
			best = i;
		}
	}
	return best;
}

/* The cube's levels are 0, 95, 135, ..., 255, the greys 8, 18, ..., 238 (xterm's 256colres.h). */
static int32_t nearest_256(const uint8_t rgb[3])
{
	int level[3], cube[3], grey[3];

	for (int i = 0; i < 3; i++) {
		level[i] = rgb[i] < 48 ? 0 : rgb[i] < 115 ? 1 : (rgb[i] - 35) / 40;
		cube[i] = level[i] == 0 ? 0 : 55 + 40 * level[i];
	}
	const int mean = (rgb[0] + rgb[1] + rgb[2]) / 3;
	const int step = mean < 8 ? 0 : mean > 238 ? 23 : (mean - 3) / 10;
	grey[0] = grey[1] = grey[2] = 8 + 10 * step;
	if (distance(rgb, grey) < distance(rgb, cube))
		return GREYS + step;
	return CUBE + 36 * level[0] + 6 * level[1] + level[2];
}

int32_t rb_palette_nearest(enum rb_palette palette, const uint8_t rgb[3])
{
	switch (palette) {
	case RB_PALETTE_8:
		return nearest_ansi(rgb, 8);
	case RB_PALETTE_16:
		return nearest_ansi(rgb, 16);
	case RB_PALETTE_256:
		return nearest_256(rgb);
	case RB_PALETTE_TRUE:
		return (rgb[0] & 0xf8) << 16 | (rgb[1] & 0xf8) << 8 | (rgb[2] & 0xf8);
	case RB_PALETTE_NONE:
	default:
		return 0;
	}
}

/* Ordered dithering with Bayer's matrix of 4x4: it stands still where the picture does. */
static void dither(uint8_t out[3], const uint8_t rgb[3], int x, int y)
{
	static const int bayer[DITHER][DITHER] = {
		{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
	const int shift = 5 * (bayer[y % DITHER][x % DITHER] - 8) + 2;

	for (int i = 0; i < 3; i++) {
		const int value = rgb[i] + shift;
		out[i] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
	}
}

/* Rec. 709 weights on sRGB values: what looks darker gets less ink on a dark screen. */
static rb_cell ink(const uint8_t rgb[3])
{
	static const char ramp[] = " .:-=+*#%@";
	const int luma = (54 * rgb[0] + 183 * rgb[1] + 19 * rgb[2]) / 256;
	const int step = luma * (int)(sizeof ramp - 1) / 256;

	return (rb_cell){(uint32_t)ramp[step], -1, -1};
}

rb_cell rb_mosaic_cell(enum rb_palette palette, bool blocks, const uint8_t above[3],
                       const uint8_t below[3], int x, int y)
{
	const bool few = palette == RB_PALETTE_8 || palette == RB_PALETTE_16;
	uint8_t mean[3], high[3], low[3];

	for (int i = 0; i < 3; i++) {
		mean[i] = (uint8_t)((above[i] + below[i] + 1) / 2);
		high[i] = blocks ? above[i] : mean[i];
		low[i] = blocks ? below[i] : mean[i];
	}
	if (palette == RB_PALETTE_NONE)
		return ink(mean);
	if (few) {
		dither(high, high, x, 2 * y);
		dither(low, low, x, blocks ? 2 * y + 1 : 2 * y);
	}
	const int32_t fore = rb_palette_nearest(palette, high);
	const int32_t back = rb_palette_nearest(palette, low);
	if (fore == back)
		return (rb_cell){' ', -1, back};
	return (rb_cell){UPPER_HALF, fore, back};
}
