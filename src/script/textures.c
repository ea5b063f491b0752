/* SPDX-License-Identifier: MIT */
/*
 * A texture becomes a file of the scene, so that a recording holds it and can be filmed elsewhere.
 * Only the first bytes are looked at here: enough to refuse what is no PNG file or has more pixels
 * than any graphics library takes; decoding is left to film/, which checks everything.
 */
#include "script/textures.h"

#include <string.h>

#include "base/error.h"
#include "film/png.h"
#include "script/assets.h"

/*
 * Beginning of a PNG file: signature, length and name of the first chunk, width, height (PNG
 * specification, 5.2, 11.2.2).
 */
enum { SIGNATURE_SIZE = 8, WIDTH_AT = 16, HEIGHT_AT = 20, HEAD_SIZE = 33 };

/* Four bytes as PNG has them. */
static uint32_t big_endian(const char *bytes)
{
	uint32_t value = 0;

	for (int i = 0; i < 4; i++)
		value = value << 8 | (unsigned char)bytes[i];
	return value;
}

/* Whether the bytes begin with the signature of PNG. */
static bool is_png(const char *bytes, size_t size)
{
	return size >= SIGNATURE_SIZE && memcmp(bytes, "\x89PNG\r\n\x1a\n", SIGNATURE_SIZE) == 0;
}

/* Looks at bytes that nobody vouches for; false: a mistake was noted. */
static bool check(const struct rb_call *call, const char *key, const char *name, const char *bytes,
                  size_t size)
{
	static const char header[] = "\0\0\0\x0dIHDR";

	if (!is_png(bytes, size)) {
		rb_call_mistake(
			call,
			"'%s' must be a PNG file ('%s' is not one: it begins with other bytes)",
			key, name);
		return false;
	}
	if (size < HEAD_SIZE || memcmp(bytes + SIGNATURE_SIZE, header, sizeof header - 1) != 0) {
		rb_call_mistake(call, "'%s' must be a whole PNG file ('%s' is damaged or cut off)",
		                key, name);
		return false;
	}
	const uint32_t width = big_endian(bytes + WIDTH_AT), height = big_endian(bytes + HEIGHT_AT);
	if (width >= 1 && height >= 1 && width <= RB_TEXTURE_SIDE_MAX &&
	    height <= RB_TEXTURE_SIDE_MAX)
		return true;
	rb_call_mistake(call, "'%s' must have from 1 to %d pixels a side ('%s' has %lu x %lu)", key,
	                RB_TEXTURE_SIDE_MAX, name, (unsigned long)width, (unsigned long)height);
	return false;
}

bool rb_texture_take(struct rb_call *call, const char *key, const char *name)
{
	return rb_asset_take(call, key, name, check) != NULL;
}
