/* SPDX-License-Identifier: MIT */
/*
 * Texts are drawn by FreeType into the finished picture rather than by OpenGL, since it is one line
 * a picture and needs exact blending in linear light. A dark rim keeps letters readable on any
 * background. Digits have one width, so that running numbers do not jitter.
 */
#include "film/overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <ft2build.h>
#include FT_FREETYPE_H

#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"

enum {
	GLYPHS_MAX = 256,   /* drawn ones that are kept */
	LETTERS_MAX = 400,  /* in a line */
	RIM_MAX = 32,       /* px: the work for a letter grows with its square */
	LINEAR_STEPS = 4096 /* of linear light, fine enough for every sRGB value to come back */
};

/*
 * Size of letters as a share of the picture's height, at least so many px, which can still be read;
 * of wide pictures only 9/16 of the width counts as height.
 */
static const double size_part = 1.0 / 24, size_min_px = 9, height_most = 9.0 / 16;
/* Shares of the letters' size: rim, distance from the edge, line spacing, thickness of a bar. */
static const double rim_part = 0.14, margin_part = 0.6, line_part = 1.35, bar_part = 0.12,
		    stroke_part = 0.05;
static const double rim_strength = 0.92; /* share of the background that the rim takes */
/* The letters, in linear light. */
static const float ink = 0.96f;

static const uint32_t figure_space = 0x2007, ellipsis = 0x2026, replacement = 0xfffd;

static const char *const font_files[] = {
	"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
	"/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
	"/usr/share/fonts/dejavu/DejaVuSans.ttf",
	"/usr/share/fonts/TTF/DejaVuSans.ttf",
	"/usr/local/share/fonts/dejavu/DejaVuSans.ttf",
};

/* A letter and its rim, which reaches `rim` pixels further on all sides. */
struct glyph {
	uint32_t code;
	unsigned index; /* in the font */
	int left, top;  /* of the letter's pixels, from the pen, up */
	int width, height;
	int advance_26_6;
	uint8_t *letter, *rim; /* owned, one block; NULL: nothing to draw */
};

struct letter {
	const struct glyph *glyph;
	int x; /* of the pen, px from the line's beginning */
};

struct rb_overlay {
	FT_Library library;
	FT_Face face;
	double size_px;
	int rim, margin, line_height;
	double darkness[RIM_MAX + 1][RIM_MAX + 1]; /* of the rim, so far from a letter's pixel */
	int digit_advance_26_6;
	struct glyph glyph[GLYPHS_MAX];
	int glyph_count;
	/* of one line of text, grown as needed */
	uint8_t *mask; /* letters, then rims */
	size_t mask_size;
	float to_linear[256];
	uint8_t to_srgb[LINEAR_STEPS + 1];
};

/* ---- font ---- */

/* RBSIM_FONT, else DejaVu Sans where distributions put it. */
static enum rb_status open_font(struct rb_overlay *overlay, struct rb_error *err)
{
	const char *const wanted = getenv("RBSIM_FONT");

	if (wanted && *wanted) {
		if (FT_New_Face(overlay->library, wanted, 0, &overlay->face) == 0)
			return RB_OK;
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot read the font '%s' that RBSIM_FONT names", wanted);
	}
	for (size_t i = 0; i < sizeof font_files / sizeof *font_files; i++)
		if (FT_New_Face(overlay->library, font_files[i], 0, &overlay->face) == 0)
			return RB_OK;
	return RB_FAIL(
		err, RB_ERR_MISSING,
		"cannot find the font 'DejaVuSans.ttf' for texts in pictures: looked for "
		"'%s' and the like (install fonts-dejavu-core, or name a font in RBSIM_FONT)",
		font_files[0]);
}

/* Advance of a character, 1/64 px. */
static int advance_of(struct rb_overlay *overlay, uint32_t code)
{
	if (FT_Load_Char(overlay->face, code, FT_LOAD_TARGET_LIGHT) != 0)
		return 0;
	return (int)overlay->face->glyph->advance.x;
}

/* sRGB to linear light and back (IEC 61966-2-1). */
static void make_curves(struct rb_overlay *overlay)
{
	for (int i = 0; i < 256; i++) {
		const double v = i / 255.0;
		overlay->to_linear[i] = (float)(v <= 0.04045 ? v / 12.92
		                                             : pow((v + 0.055) / 1.055, 2.4));
	}
	for (int i = 0; i <= LINEAR_STEPS; i++) {
		const double l = (double)i / LINEAR_STEPS;
		const double v = l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
		overlay->to_srgb[i] = (uint8_t)lrint(255 * v);
	}
}

/* Radius of the rim, and its darkness by distance: a parabola. */
static void make_rim(struct rb_overlay *overlay)
{
	overlay->rim = (int)fmin(ceil(overlay->size_px * rim_part), RIM_MAX);
	for (int y = 0; y <= overlay->rim; y++)
		for (int x = 0; x <= overlay->rim; x++) {
			const double far = sqrt((double)(x * x + y * y)) / (overlay->rim + 1);
			overlay->darkness[y][x] = fmax(1 - far * far, 0);
		}
}

static enum rb_status set_up(struct rb_overlay *overlay, int width_px, int height_px,
                             struct rb_error *err)
{
	if (FT_Init_FreeType(&overlay->library) != 0) {
		overlay->library = NULL;
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot start FreeType");
	}
	const enum rb_status status = open_font(overlay, err);
	if (status)
		return status;
	overlay->size_px = fmax(size_min_px, fmin(height_px, width_px * height_most) * size_part);
	if (FT_Set_Char_Size(overlay->face, 0, (FT_F26Dot6)lrint(64 * overlay->size_px), 72, 72) !=
	    0)
		return RB_FAIL(err, RB_ERR_MISSING, "the font '%s' has no letters of any size",
		               overlay->face->family_name ? overlay->face->family_name : "");
	make_rim(overlay);
	overlay->margin = (int)lrint(overlay->size_px * margin_part);
	overlay->line_height = (int)lrint(overlay->size_px * line_part);
	for (uint32_t digit = '0'; digit <= '9'; digit++) {
		const int advance = advance_of(overlay, digit);
		if (advance > overlay->digit_advance_26_6)
			overlay->digit_advance_26_6 = advance;
	}
	make_curves(overlay);
	return RB_OK;
}

enum rb_status rb_overlay_create(struct rb_overlay **overlay, int width_px, int height_px,
                                 struct rb_error *err)
{
	*overlay = rb_memory_take(1, sizeof **overlay);
	if (!*overlay)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare texts: out of memory");
	const enum rb_status status = set_up(*overlay, width_px, height_px, err);
	if (status) {
		rb_overlay_destroy(*overlay);
		*overlay = NULL;
	}
	return status;
}

/* Empties the cache. */
static void forget_glyphs(struct rb_overlay *overlay)
{
	for (int i = 0; i < overlay->glyph_count; i++)
		rb_memory_free(overlay->glyph[i].letter);
	overlay->glyph_count = 0;
}

void rb_overlay_destroy(struct rb_overlay *overlay)
{
	if (!overlay)
		return;
	forget_glyphs(overlay);
	if (overlay->face)
		FT_Done_Face(overlay->face);
	if (overlay->library)
		FT_Done_FreeType(overlay->library);
	rb_memory_free(overlay->mask);
	rb_memory_free(overlay);
}

/* ---- letters ---- */

/*
 * True if a pixel and its four neighbours are fully covered: whatever it darkens is nearer to one
 * of these.
 */
static bool is_inside(const struct glyph *glyph, int x, int y)
{
	const uint8_t *const at = glyph->letter + y * glyph->width + x;

	return x > 0 && y > 0 && x < glyph->width - 1 && y < glyph->height - 1 && at[0] == 255 &&
	       at[-1] == 255 && at[1] == 255 && at[-glyph->width] == 255 && at[glyph->width] == 255;
}

/* Darkens around a pixel of the letter. */
static void darken(const struct rb_overlay *overlay, const struct glyph *glyph, int x, int y,
                   int cover)
{
	const int reach = overlay->rim, width = glyph->width + 2 * reach;

	for (int dy = -reach; dy <= reach; dy++)
		for (int dx = -reach; dx <= reach; dx++) {
			const int dark = (int)(cover * overlay->darkness[abs(dy)][abs(dx)]);
			uint8_t *const at = glyph->rim + (y + reach + dy) * width + x + reach + dx;
			if (dark > *at)
				*at = (uint8_t)dark;
		}
}

/* Each rim pixel is as dark as the letter's pixels near it, less with distance. */
static void draw_rim(const struct rb_overlay *overlay, const struct glyph *glyph)
{
	const int reach = overlay->rim, width = glyph->width + 2 * reach;

	for (int y = 0; y < glyph->height; y++)
		for (int x = 0; x < glyph->width; x++) {
			const int cover = glyph->letter[y * glyph->width + x];
			if (is_inside(glyph, x, y))
				glyph->rim[(y + reach) * width + x + reach] = 255;
			else if (cover > 0)
				darken(overlay, glyph, x, y, cover);
		}
}

/* Renders a letter and its rim; false: not possible. */
static bool draw_glyph(struct rb_overlay *overlay, struct glyph *glyph)
{
	glyph->index = FT_Get_Char_Index(overlay->face, glyph->code);
	if (FT_Load_Glyph(overlay->face, glyph->index, FT_LOAD_TARGET_LIGHT | FT_LOAD_RENDER) != 0)
		return false;
	const FT_GlyphSlot slot = overlay->face->glyph;
	const FT_Bitmap *const bitmap = &slot->bitmap;
	const bool tabular = (glyph->code >= '0' && glyph->code <= '9') ||
	                     glyph->code == figure_space;
	glyph->left = slot->bitmap_left;
	glyph->top = slot->bitmap_top;
	glyph->advance_26_6 = tabular ? overlay->digit_advance_26_6 : (int)slot->advance.x;
	if (glyph->code == figure_space || bitmap->width == 0 || bitmap->rows == 0 ||
	    bitmap->pixel_mode != FT_PIXEL_MODE_GRAY)
		return true;
	glyph->width = (int)bitmap->width;
	glyph->height = (int)bitmap->rows;
	const size_t letter_size = (size_t)glyph->width * (size_t)glyph->height;
	const size_t rim_size = (size_t)(glyph->width + 2 * overlay->rim) *
	                        (size_t)(glyph->height + 2 * overlay->rim);
	glyph->letter = rb_memory_take(letter_size + rim_size, 1);
	if (!glyph->letter)
		return false;
	glyph->rim = glyph->letter + letter_size;
	for (int y = 0; y < glyph->height; y++)
		memcpy(glyph->letter + y * glyph->width, bitmap->buffer + y * bitmap->pitch,
		       (size_t)glyph->width);
	draw_rim(overlay, glyph);
	return true;
}

/* Cached glyph; NULL: it cannot be drawn or the cache is full. */
static const struct glyph *glyph_of(struct rb_overlay *overlay, uint32_t code)
{
	for (int i = 0; i < overlay->glyph_count; i++)
		if (overlay->glyph[i].code == code)
			return &overlay->glyph[i];
	if (overlay->glyph_count == GLYPHS_MAX)
		return NULL;
	struct glyph *const glyph = &overlay->glyph[overlay->glyph_count];
	*glyph = (struct glyph){.code = code};
	if (!draw_glyph(overlay, glyph))
		return NULL;
	overlay->glyph_count++;
	return glyph;
}

/*
 * The next character of UTF-8 text, which moves on; bytes that are none become U+FFFD, one by one.
 */
static uint32_t next_code(const char **text)
{
	static const uint32_t smallest[] = {0, 0x80, 0x800, 0x10000};
	const unsigned char *at = (const unsigned char *)*text;
	const unsigned char first = *at++;
	const int more = first < 0x80   ? 0
	                 : first < 0xc2 ? -1
	                 : first < 0xe0 ? 1
	                 : first < 0xf0 ? 2
	                                : 3;
	uint32_t code = more <= 0 ? first : first & (0x3fu >> more);

	const bool hidden = rb_visible_size(*text) == 0;
	*text += 1;
	if (hidden || more < 0 || first > 0xf4)
		return replacement;
	for (int i = 0; i < more; i++, at++) {
		if ((*at & 0xc0) != 0x80)
			return replacement;
		code = code << 6 | (*at & 0x3f);
	}
	if (code < smallest[more] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000))
		return replacement;
	*text += more;
	return code;
}

/* ---- lines ---- */

static bool is_digit(const struct glyph *glyph)
{
	return (glyph->code >= '0' && glyph->code <= '9') || glyph->code == figure_space;
}

/* Kerning, 1/64 px; none beside digits, which keep their places. */
static int kerning(struct rb_overlay *overlay, const struct glyph *a, const struct glyph *b)
{
	FT_Vector kern = {0};

	if (!a || is_digit(a) || is_digit(b) || !FT_HAS_KERNING(overlay->face))
		return 0;
	if (FT_Get_Kerning(overlay->face, a->index, b->index, FT_KERNING_DEFAULT, &kern) != 0)
		return 0;
	return (int)kern.x;
}

/*
 * Lays out as much of the text as fits into `room` px, with an ellipsis if it is cut; returns the
 * number of letters and sets the width, px.
 */
static int set_line(struct rb_overlay *overlay, struct letter letters[LETTERS_MAX],
                    const char *text, int room, int *width)
{
	const struct glyph *const dots = glyph_of(overlay, ellipsis);
	const struct glyph *before = NULL;
	const int dots_width = dots ? dots->advance_26_6 : 0;
	int count = 0, pen = 0;
	int fits = 0, fits_pen = 0; /* with an ellipsis behind */

	while (*text && count < LETTERS_MAX - 1) {
		const uint32_t code = next_code(&text);
		const struct glyph *const glyph = glyph_of(overlay, code < 0x20 ? ' ' : code);
		if (!glyph)
			continue;
		pen += kerning(overlay, before, glyph);
		letters[count++] = (struct letter){glyph, (pen + 32) >> 6};
		pen += glyph->advance_26_6;
		before = glyph;
		if (pen + dots_width <= 64 * room) {
			fits = count;
			fits_pen = pen;
		}
		if (pen > 64 * room) {
			count = fits;
			pen = fits_pen;
			if (dots && fits_pen + dots_width <= 64 * room) {
				letters[count++] = (struct letter){dots, (pen + 32) >> 6};
				pen += dots_width;
			}
			break;
		}
	}
	*width = (pen + 63) >> 6;
	return count;
}

/* Maximum of what is there and what is drawn: neighbours do not add up. */
static void stamp(uint8_t *mask, int width, int height, const uint8_t *from, const int box[4])
{
	for (int y = 0; y < box[3]; y++)
		for (int x = 0; x < box[2]; x++) {
			const int to_x = box[0] + x, to_y = box[1] + y;
			if (to_x < 0 || to_y < 0 || to_x >= width || to_y >= height)
				continue;
			uint8_t *const to = mask + (size_t)to_y * (size_t)width + (size_t)to_x;
			const uint8_t value = from[y * box[2] + x];
			if (value > *to)
				*to = value;
		}
}

/* Rim, then letter, in linear light. */
static void blend(const struct rb_overlay *overlay, uint8_t *pixel, uint8_t letter, uint8_t rim)
{
	const float cover = (float)letter / 255, keep = 1 - (float)(rim_strength * rim / 255);

	for (int c = 0; c < 3; c++) {
		const float behind = keep * overlay->to_linear[pixel[c]];
		const float light = behind + cover * (ink - behind);
		pixel[c] = overlay->to_srgb[(int)(light * LINEAR_STEPS + 0.5f)];
	}
}

/* Draws the letters into masks, then blends these into the picture. */
static void put_line(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                     const struct letter *letters, int count, const int box[4])
{
	const int width = box[2], height = box[3],
		  base = (int)lrint(overlay->size_px) + overlay->rim;
	const size_t plane = (size_t)width * (size_t)height;
	uint8_t *const inks = overlay->mask, *const rims = overlay->mask + plane;

	RB_ASSERT(2 * plane <= overlay->mask_size);
	memset(overlay->mask, 0, 2 * plane);
	for (int i = 0; i < count; i++) {
		const struct glyph *const glyph = letters[i].glyph;
		if (!glyph->letter)
			continue;
		const int x = overlay->rim + letters[i].x + glyph->left, y = base - glyph->top;
		stamp(inks, width, height, glyph->letter,
		      (const int[]){x, y, glyph->width, glyph->height});
		stamp(rims, width, height, glyph->rim,
		      (const int[]){x - overlay->rim, y - overlay->rim,
		                    glyph->width + 2 * overlay->rim,
		                    glyph->height + 2 * overlay->rim});
	}
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const int to_x = box[0] + x, to_y = box[1] + y;
			const size_t at = (size_t)y * (size_t)width + (size_t)x;
			if (to_x < 0 || to_y < 0 || to_x >= pixmap->width ||
			    to_y >= pixmap->height || rims[at] == 0)
				continue;
			blend(overlay,
			      pixmap->rgba +
			              4 * ((size_t)to_y * (size_t)pixmap->width + (size_t)to_x),
			      inks[at], rims[at]);
		}
}

/* Letters of one line, cut to `room` px. */
static int set_letters(struct rb_overlay *overlay, struct letter letters[LETTERS_MAX],
                       const char *text, int room, int *width)
{
	if (overlay->glyph_count > GLYPHS_MAX / 2)
		forget_glyphs(overlay); /* now all of this line fits into the cache */
	return set_line(overlay, letters, text, room, width);
}

/* Draws a line with its upper left corner, without the rim, at x, y. */
static void put_letters(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                        const struct letter *letters, int count, const int at[2], int text_width)
{
	const int rim = overlay->rim;

	if (count == 0)
		return;
	/* from above the highest letters to below the deepest, rims included */
	const int height = (int)lrint(1.3 * overlay->size_px) + 2 * rim,
		  width = text_width + 2 * rim;
	const size_t needed = 2 * (size_t)width * (size_t)height;
	if (!rb_memory_reserve(&overlay->mask, &overlay->mask_size, needed, 1))
		return; /* a picture without its text is better than none */
	put_line(overlay, pixmap, letters, count,
	         (const int[]){at[0] - rim, at[1] - rim, width, height});
}

void rb_overlay_write(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                      enum rb_overlay_corner corner, int line, const char *text)
{
	struct letter letters[LETTERS_MAX];
	const bool right = corner == RB_OVERLAY_TOP_RIGHT || corner == RB_OVERLAY_BOTTOM_RIGHT;
	const bool bottom = corner == RB_OVERLAY_BOTTOM_LEFT || corner == RB_OVERLAY_BOTTOM_RIGHT;
	const int margin = overlay->margin, down = margin + line * overlay->line_height;
	int text_width;

	const int count = set_letters(overlay, letters, text, pixmap->width - 2 * margin,
	                              &text_width);
	const int at[2] = {right ? pixmap->width - margin - text_width : margin,
	                   bottom ? pixmap->height - down - (int)lrint(1.25 * overlay->size_px)
	                          : down};
	put_letters(overlay, pixmap, letters, count, at, text_width);
}

struct rb_overlay_size rb_overlay_size_of(struct rb_overlay *overlay, const char *text)
{
	struct letter letters[LETTERS_MAX];
	struct rb_overlay_size size = {.height = overlay->line_height};

	(void)set_letters(overlay, letters, text, INT32_MAX / 64, &size.width);
	return size;
}

int rb_overlay_lines_px(const struct rb_overlay *overlay, int lines)
{
	return lines > 0 ? overlay->margin + lines * overlay->line_height : 0;
}

void rb_overlay_put(struct rb_overlay *overlay, struct rb_pixmap *pixmap, int x, int y, int room,
                    const char *text)
{
	struct letter letters[LETTERS_MAX];
	int text_width;

	const int count = set_letters(overlay, letters, text, room, &text_width);
	put_letters(overlay, pixmap, letters, count, (const int[]){x, y}, text_width);
}

/* Blends a box of the ink with a rim of so many px, sharp, since it has no slanted edges. */
static void put_box(struct rb_overlay *overlay, struct rb_pixmap *pixmap, const int box[4], int rim)
{
	for (int y = box[1] - rim; y < box[1] + box[3] + rim; y++)
		for (int x = box[0] - rim; x < box[0] + box[2] + rim; x++) {
			const bool inside = x >= box[0] && x < box[0] + box[2] && y >= box[1] &&
			                    y < box[1] + box[3];
			if (x < 0 || y < 0 || x >= pixmap->width || y >= pixmap->height)
				continue;
			uint8_t *const pixel = pixmap->rgba +
			                       4 * ((size_t)y * (size_t)pixmap->width + (size_t)x);
			blend(overlay, pixel, inside ? 255 : 0, inside ? 0 : 255);
		}
}

void rb_overlay_stroke(struct rb_overlay *overlay, struct rb_pixmap *pixmap, int x, int upper,
                       int lower)
{
	const int thick = (int)fmax(1, rint(stroke_part * overlay->size_px));

	if (upper < lower)
		put_box(overlay, pixmap, (const int[]){x - thick / 2, upper, thick, lower - upper},
		        thick);
}

void rb_overlay_bar(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                    enum rb_overlay_corner corner, int line, int length_px, const char *text)
{
	const bool right = corner == RB_OVERLAY_TOP_RIGHT || corner == RB_OVERLAY_BOTTOM_RIGHT;
	const bool bottom = corner == RB_OVERLAY_BOTTOM_LEFT || corner == RB_OVERLAY_BOTTOM_RIGHT;
	const int thick = (int)fmax(1, rint(overlay->size_px * bar_part));
	const int down = overlay->margin + (bottom ? line : line + 1) * overlay->line_height +
	                 (bottom ? 0 : overlay->line_height / 4);

	RB_ASSERT(length_px > 0);
	rb_overlay_write(overlay, pixmap, corner, bottom ? line + 1 : line, text);
	put_box(overlay, pixmap,
	        (const int[]){right ? pixmap->width - overlay->margin - length_px : overlay->margin,
	                      bottom ? pixmap->height - down - thick : down, length_px, thick},
	        overlay->rim);
}

bool rb_overlay_fits(struct rb_overlay *overlay, int width_px, const char *left, const char *right)
{
	struct letter letters[LETTERS_MAX];
	const int room = width_px - 2 * overlay->margin;
	int left_width, right_width;

	if (overlay->glyph_count > GLYPHS_MAX / 2)
		forget_glyphs(overlay);
	(void)set_line(overlay, letters, left, room, &left_width);
	(void)set_line(overlay, letters, right, room, &right_width);
	return left_width + right_width + lrint(overlay->size_px) <= room;
}
