/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: any bytes as a texture. What must hold: decoding says RB_OK with a picture of a possible size or RB_ERR_SCENE
 * with a reason, and everything taken is given back. The sums of chunks are made right first, or hardly any input
 * would get past them.
 */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "film/png.h"

enum { HEAD = 8, FRAME = 12, MOST = 1 << 16 };

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

static void mend_sums(unsigned char *bytes, size_t size)
{
	for (size_t at = HEAD; at + FRAME <= size;) {
		const size_t length = (size_t)bytes[at] << 24 | (size_t)bytes[at + 1] << 16 |
		                      (size_t)bytes[at + 2] << 8 | bytes[at + 3];
		unsigned sum = 0xffffffff;
		if (length > size - at - FRAME)
			return;
		for (size_t i = at + 4; i < at + 8 + length; i++) {
			sum ^= bytes[i];
			for (int bit = 0; bit < 8; bit++)
				sum = sum & 1 ? 0xedb88320 ^ sum >> 1 : sum >> 1;
		}
		sum = ~sum;
		for (int i = 0; i < 4; i++)
			bytes[at + 8 + length + (size_t)i] = (unsigned char)(sum >> (24 - 8 * i));
		at += FRAME + length;
	}
}

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	static unsigned char mended[MOST];
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_pixmap pixmap;
	struct rb_error err = {0};

	if (size > MOST)
		return 0;
	memcpy(mended, bytes, size);
	if (size > HEAD && size % 8 != 0)
		mend_sums(mended, size);
	const enum rb_status status = rb_png_decode(&pixmap, "fuzz.png", mended, size, &err);
	if (status == RB_OK) {
		if (pixmap.width < 1 || pixmap.width > RB_TEXTURE_SIDE_MAX || pixmap.height < 1 ||
		    pixmap.height > RB_TEXTURE_SIDE_MAX)
			abort();
	} else if (status != RB_ERR_SCENE || pixmap.rgba || err.text[0] == '\0') {
		abort();
	}
	rb_pixmap_release(&pixmap);
	const struct rb_memory_counts after = rb_memory_counts();
	if (after.taken - after.freed != before.taken - before.freed)
		abort();
	return 0;
}
