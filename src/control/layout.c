/* SPDX-License-Identifier: MIT */
/*
 * Fixed heights and a few thresholds instead of proportions: every panel has a known number of
 * lines, and the picture takes all that is left. The thresholds are the widths at which the
 * transport line, and a side column with readable numbers, fit; below 80 columns there is no side
 * column.
 */
#include "control/layout.h"

#include "base/error.h"

/* Rows of the side panels: a title and the lines that control/panels prints. */
enum { NUMBERS = 9, CHARTS = 5, BODY = 6 };

/*
 * Divides the column beside the picture: what is most asked for first, as far as there are rows;
 * panels without rows get no width either.
 */
static void fill_side(struct rb_layout *layout, rb_area side)
{
	rb_area *const parts[] = {&layout->numbers, &layout->charts, &layout->body};
	static const int heights[] = {NUMBERS, CHARTS, BODY};
	int y = side.y, left = side.height;

	RB_ASSERT(side.height >= 0);
	for (int i = 0; i < 3; i++) {
		const int height = heights[i] < left ? heights[i] : left;
		*parts[i] = (rb_area){side.x, y, height > 0 ? side.width : 0, height};
		y += height;
		left -= height;
	}
}

struct rb_layout rb_layout_of(int width, int height)
{
	struct rb_layout layout = {.fits = width >= RB_LAYOUT_WIDTH_MIN &&
	                                   height >= RB_LAYOUT_HEIGHT_MIN};
	const int transport = width < 76 ? 2 : 1;
	const int log = height >= 30 ? 4 : height >= 20 ? 2 : 1;
	const int side = width >= 100 ? 42 : width >= 80 ? 36 : 0;
	const int middle = height - transport - 1 - log - 1;

	if (!layout.fits)
		return layout;
	layout.transport = (rb_area){0, 0, width, transport};
	layout.picture = (rb_area){0, transport, width - side - (side > 0), middle};
	if (side > 0)
		fill_side(&layout, (rb_area){width - side, transport, side, middle});
	layout.timeline = (rb_area){0, transport + middle, width, 1};
	RB_ASSERT(middle > 0);
	layout.log = (rb_area){0, transport + middle + 1, width, log};
	layout.bottom = (rb_area){0, height - 1, width, 1};
	return layout;
}
