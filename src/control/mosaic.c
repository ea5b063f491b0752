/* SPDX-License-Identifier: MIT */
/*
 * A cell is about twice as high as wide, so the upper-half block with two colours gives two square
 * pixels. Colours are found by arithmetic in the fixed palettes of 256 colours, and by search in
 * the small ones; dithering is ordered, not error diffusion, because diffusion makes still areas
 * flicker when something moves elsewhere.
 */
#include "control/mosaic.h"

#include <stdlib.h>

#include "base/error.h"

/*
 * UPPER_HALF: the block U+2580. CUBE, GREYS: first numbers of the colour cube and the greys of
 * xterm's 256 colours. DITHER: side of the dither matrix.
 */
enum { UPPER_HALF = 0x2580, CUBE = 16, GREYS = 232, DITHER = 4 };

/* The 16 colours as xterm shows them; other terminals differ, and none can be asked reliably. */
static const uint8_t ansi[16][3] = {
	{0, 0, 0},       {205, 0, 0},   {0, 205, 0},   {205, 205, 0},
	{0, 0, 238},     {205, 0, 205}, {0, 205, 205}, {229, 229, 229},
	{127, 127, 127}, {255, 0, 0},   {0, 255, 0},   {255, 255, 0},
	{92, 92, 255},   {255, 0, 255}, {0, 255, 255}, {255, 255, 255},
};

/*
 * Squared distance in sRGB, weighted by 2, 4, 3: the eye sees green best, and a hue that is wrong
 * disturbs more than a lightness that is.
 */
static int distance(const uint8_t a[3], const int b[3])
{
	const int red = a[0] - b[0], green = a[1] - b[1], blue = a[2] - b[2];

	return 2 * red * red + 4 * green * green + 3 * blue * blue;
}

/* Number of the nearest of the first `count` colours. */
static int32_t nearest_ansi(const uint8_t rgb[3], int count)
{
	int best = 0, least = -1;

	RB_ASSERT(count > 0 && count <= 16);
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

/*
 * Number of the nearest colour of the cube or the greys. The cube's levels are 0, 95, 135, ...,
 * 255, the greys 8, 18, ..., 238 (xterm's 256colres.h); 48 and 115 are the middles between levels.
 */
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

/*
 * Adds the threshold of Bayer's 4x4 matrix at x, y to a colour: the pattern stands still where the
 * picture does. The amplitude is 80 of 255, about half the distance between the colours of a
 * palette of 8.
 */
static void dither(uint8_t out[3], const uint8_t rgb[3], int x, int y)
{
	static const int bayer[DITHER][DITHER] = {
		{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
	const int shift = 5 * (bayer[y % DITHER][x % DITHER] - 8) + 2;

	RB_ASSERT_COSTLY(x >= 0 && y >= 0);
	for (int i = 0; i < 3; i++) {
		const int value = rgb[i] + shift;
		out[i] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
	}
}

/*
 * A character as dark as the colour, for terminals without colours. Rec. 709 weights on sRGB
 * values; what is darker gets less ink, on a dark screen.
 */
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
