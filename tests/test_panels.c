/* SPDX-License-Identifier: MIT */
/* src/control/panels.c: what stands where, on a screen that is an array. Source and viewer are what the test says. */
#include "support.h"

#include <rbsim/model.h>

#include "control/orders.h"
#include "control/panels.h"

enum { WIDTH = 60, HEIGHT = 40 };

struct rb_screen {
	char cell[HEIGHT][WIDTH];
	enum rb_style style[HEIGHT][WIDTH];
	bool blocks;
};

static struct rb_source_status source_status;
static struct rb_source_bins source_bins;
static int body_lines;

bool rb_screen_blocks(const struct rb_screen *screen)
{
	return screen->blocks;
}

void rb_screen_glyph(struct rb_screen *screen, int x, int y, uint32_t glyph, enum rb_style style)
{
	assert_in_range(x, 0, WIDTH - 1);
	assert_in_range(y, 0, HEIGHT - 1);
	screen->cell[y][x] = (char)glyph;
	screen->style[y][x] = style;
}

void rb_screen_text(struct rb_screen *screen, rb_area area, int row, enum rb_style style,
                    const char *text)
{
	assert_in_range(row, 0, area.height - 1);
	for (int i = 0; i < area.width; i++)
		rb_screen_glyph(screen, area.x + i, area.y + row, (uint32_t)(*text ? *text++ : ' '),
		                style);
}

const struct rb_source_status *rb_source_status(const struct rb_source *source)
{
	(void)source;
	return &source_status;
}

const struct rb_source_bins *rb_source_bins(const struct rb_source *source)
{
	(void)source;
	return &source_bins;
}

const char *rb_viewer_state(const struct rb_viewer *viewer)
{
	return viewer->playing ? "playing" : "paused";
}

bool rb_order_body_line(const struct rb_viewer *viewer, int id, int line, char out[96])
{
	(void)viewer;
	snprintf(out, 96, "body %d line %d", id, line);
	return line < body_lines;
}

/* A screen full of what nobody writes, and a viewer of nothing. */
static const char untouched = 1;

static struct rb_viewer *clean(struct rb_screen *screen)
{
	static struct rb_viewer viewer;

	memset(screen, 0, sizeof *screen);
	memset(screen->cell, untouched, sizeof screen->cell);
	memset(&source_bins, 0, sizeof source_bins);
	source_status = (struct rb_source_status){.state = "complete", .duration_s = 8, .end_s = 8};
	viewer = (struct rb_viewer){.inspected = -1, .speed = 1};
	viewer.options.name = "run.h5";
	return &viewer;
}

static void assert_row(const struct rb_screen *screen, rb_area area, int row, const char *wanted)
{
	char found[WIDTH + 1] = {0};

	memcpy(found, &screen->cell[area.y + row][area.x], (size_t)area.width);
	for (int i = area.width; i > 0 && found[i - 1] == ' '; i--)
		found[i - 1] = '\0';
	assert_string_equal(found, wanted);
}

/* Nothing is drawn outside of the panel, and nothing of it is left as it was. */
static void assert_filled(const struct rb_screen *screen, rb_area area)
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const bool inside = x >= area.x && x < area.x + area.width && y >= area.y &&
			                    y < area.y + area.height;
			if (!inside)
				assert_int_equal(screen->cell[y][x], untouched);
			else if (screen->cell[y][x] == untouched)
				fail_msg("column %d of row %d was left as it was", x, y);
		}
}

static void the_transport_says_where_the_view_is(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area two = {2, 3, 50, 2}, one = {0, 5, 60, 1};

	(void)state;
	source_status.frame_count = 81;
	viewer->frame.time_s = 2.5, viewer->frame.index = 25;
	viewer->speed = 1.0 / 3;
	rb_panel_transport(&screen, two, viewer);
	assert_row(&screen, two, 0, " paused      t 2.5000 of 8 s  speed 1/3");
	assert_row(&screen, two, 1, " frame 25 of 80  run.h5: complete");
	assert_filled(&screen, two);
	assert_int_equal(screen.style[4][2], RB_STYLE_PLAIN);

	viewer->playing = viewer->starved = source_status.stops_at_collision = true;
	viewer->speed = 0.3;
	rb_panel_transport(&screen, two, viewer);
	assert_row(&screen, two, 0, " playing     t 2.5000 of 8 s  speed 0.3");
	assert_row(&screen, two, 1, " frame 25 of 80  cannot keep up  stops at collisio");
	assert_int_equal(screen.style[4][2], RB_STYLE_WARNING);

	clean(&screen)->live = true;
	rb_panel_transport(&screen, one, viewer);
	assert_row(&screen, one, 0, " paused      t 0.0000 of 8 s  newest frames  frame 0 of 0  r");
	assert_filled(&screen, one);
}

static void numbers_that_are_not_known_are_dashes(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area area = {20, 1, 30, 10};

	(void)state;
	source_status.real_time_factor = (double)NAN;
	source_status.collisions = 12, source_status.rollbacks = 34;
	source_status.smallest_step_s = 0; /* none was taken */
	viewer->frame.numbers.contacts = 56;
	rb_panel_numbers(&screen, area, viewer);
	static const char *const bare[] = {"recording",     "real time  -",  "collisions 12",
	                                   "contacts   56", "rollbacks  34", "least step -",
	                                   "buffer     -",  "disk       -",  ""};
	for (int i = 0; i < 9; i++)
		assert_row(&screen, area, i, bare[i]);
	assert_filled(&screen, area);

	source_status.is_run = true;
	source_status.real_time_factor = 2.5;
	source_status.smallest_step_s = 0.001;
	source_status.ring_used = 3, source_status.ring_slots = 16;
	static const struct {
		uint64_t bytes;
		const char *text;
	} sizes[] = {{999, "disk       999 bytes"},   {1000, "disk       1 kB"},
	             {1234567, "disk       1.23 MB"}, {99949999, "disk       99.9 MB"},
	             {999600000, "disk       1 GB"},  {5000000000000000, "disk       5e+03 TB"}};
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		source_status.bytes = sizes[i].bytes;
		rb_panel_numbers(&screen, area, viewer);
		assert_row(&screen, area, 7, sizes[i].text);
	}
	assert_row(&screen, area, 0, "run");
	assert_row(&screen, area, 1, "real time  2.5 x");
	assert_row(&screen, area, 5, "least step 0.001 s");
	assert_row(&screen, area, 6, "buffer     3 of 16 frames");
}

static void the_time_line_ends_where_the_run_is(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area area = {5, 7, 41, 1};

	(void)state;
	source_status.end_s = 6;
	viewer->frame.time_s = 2;
	source_bins.collisions[RB_SOURCE_BINS / 2] = 3;
	rb_panel_timeline(&screen, area, viewer);
	assert_row(&screen, area, 0, "==========O---------!----------..........");
	assert_filled(&screen, area);
}

/*
 * Kinetic energy rises from 0 to 10 J, potential energy makes it 10 J in all, overlap has one peak; 3/4 of it exist. A column
 * of 40 stands for ten bins and shows the last, so column x is at (x + 0.9) / 30.9 of the chart's height.
 */
static void charts_are_empty_where_nothing_has_been_simulated(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area area = {1, 2, 19 + 40, 5};

	(void)state;
	source_status.end_s = 6;
	for (int i = 0; i < RB_SOURCE_BINS; i++) {
		source_bins.kinetic[i] = 10.0 * i / RB_SOURCE_BINS;
		source_bins.potential[i] = 10 - source_bins.kinetic[i];
	}
	source_bins.penetration[155] = 0.25;
	rb_panel_charts(&screen, area, viewer);
	assert_row(&screen, area, 0, "energy (J), overlap (m)");
	assert_row(&screen, area, 1, "kinetic   ___....::::----====++++****####          7.72");
	assert_row(&screen, area, 2, "total     ###############################          10");
	assert_row(&screen, area, 3, "overlap   _______________#________________________ 0.25");
	assert_row(&screen, area, 4, "");
	assert_filled(&screen, area);

	/* of a run of few frames the bins in between show what was there before them */
	for (int i = 0; i < RB_SOURCE_BINS; i++)
		source_bins.kinetic[i] = i == 0 ? 1 : i == 100 ? 2 : (double)NAN;
	source_status.end_s = 8;
	rb_panel_charts(&screen, area, viewer);
	assert_row(&screen, area, 1, "kinetic   ==========############################## 2");
}

static void a_panel_without_a_body_says_how_one_is_found(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area area = {3, 3, 40, 4};

	(void)state;
	rb_panel_body(&screen, area, viewer);
	assert_row(&screen, area, 0, "/ looks for a body");
	assert_row(&screen, area, 1, "");
	assert_filled(&screen, area);
	viewer->inspected = 7;
	for (body_lines = 2; body_lines < 9; body_lines += 5) {
		rb_panel_body(&screen, area, viewer);
		assert_row(&screen, area, 0, "body 7 line 0");
		assert_row(&screen, area, 1, "body 7 line 1");
		assert_row(&screen, area, 3, body_lines > 3 ? "body 7 line 3" : "");
		assert_filled(&screen, area);
	}
}

static void say(struct rb_viewer *viewer, const char *text)
{
	snprintf(viewer->log[viewer->log_count++ % RB_VIEWER_LOG_LINES], RB_VIEWER_LOG_SIZE, "%s",
	         text);
}

static void the_log_shows_the_newest_lines_from_below(void **state)
{
	struct rb_screen screen;
	struct rb_viewer *const viewer = clean(&screen);
	const rb_area area = {0, 10, 10, 4}, one = {0, 20, 10, 1};

	(void)state;
	say(viewer, "first");
	rb_panel_log(&screen, area, viewer);
	assert_row(&screen, area, 0, "");
	assert_row(&screen, area, 3, "first");
	assert_filled(&screen, area);
	assert_int_equal(screen.style[13][0], RB_STYLE_PLAIN);

	/* a line goes on in the next row; of an older one without room for all, the end */
	say(viewer, "aaaaaaaaaabbbbbbbbbbccccccccccdddd");
	say(viewer, "0123456789abc");
	rb_panel_log(&screen, area, viewer);
	assert_row(&screen, area, 0, "cccccccccc");
	assert_row(&screen, area, 1, "dddd");
	assert_row(&screen, area, 2, "0123456789");
	assert_row(&screen, area, 3, "abc");
	assert_int_equal(screen.style[11][0], RB_STYLE_FAINT);
	/* of the newest its beginning, where nothing else has room */
	rb_panel_log(&screen, one, viewer);
	assert_row(&screen, one, 0, "0123456789");
	/* characters of more than one byte are one column */
	say(viewer,
	    "\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4");
	say(viewer, "end");
	rb_panel_log(&screen, area, viewer);
	assert_row(&screen, area, 3, "end");
	assert_row(&screen, area, 0, "0123456789");
	/* rows end behind words, and where a word is longer than a row within it */
	say(viewer, "  film run.mp4: 12345678901 of 20");
	rb_panel_log(&screen, area, viewer);
	assert_row(&screen, area, 0, "  film");
	assert_row(&screen, area, 1, "run.mp4:");
	assert_row(&screen, area, 2, "1234567890");
	assert_row(&screen, area, 3, "1 of 20");
	say(viewer, "ends where a row does: ");
	rb_panel_log(&screen, area, viewer);
	assert_row(&screen, area, 1, "ends where");
	assert_row(&screen, area, 2, "a row");
	assert_row(&screen, area, 3, "does:");
	/* what is too old to be kept is not shown */
	for (int i = 0; i < 2 * RB_VIEWER_LOG_LINES; i++)
		say(viewer, "again");
	rb_panel_log(&screen, area, viewer);
	for (int i = 0; i < 4; i++)
		assert_row(&screen, area, i, "again");
}

/* Every row of the help can be reached, none is longer than the panel, and beyond its end there is nothing. */
static void the_help_can_be_read_to_its_end(void **state)
{
	static const rb_area areas[] = {{0, 2, 34, 12}, {4, 0, 50, 30}};

	(void)state;
	for (int k = 0; k < 2; k++) {
		const rb_area area = areas[k];
		struct rb_screen screen;
		int first = -5, last = 1000000;
		bool commands = false;

		clean(&screen);
		rb_panel_help(&screen, area, &first);
		assert_int_equal(first, 0);
		assert_memory_equal(&screen.cell[area.y][area.x], "Keys (up, down: more; ?: back)",
		                    30);
		assert_filled(&screen, area);
		rb_panel_help(&screen, area, &last);
		assert_in_range(last, 1, 500);
		for (int at = 0; at <= last; at++) {
			int here = at;
			rb_panel_help(&screen, area, &here);
			assert_int_equal(here, at);
			char row[WIDTH + 1] = {0};
			memcpy(row, &screen.cell[area.y][area.x], (size_t)area.width);
			commands |= strncmp(row, "Commands, behind :", 18) == 0;
		}
		assert_true(commands);
		assert_filled(&screen, area);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_transport_says_where_the_view_is),
		cmocka_unit_test(numbers_that_are_not_known_are_dashes),
		cmocka_unit_test(the_time_line_ends_where_the_run_is),
		cmocka_unit_test(charts_are_empty_where_nothing_has_been_simulated),
		cmocka_unit_test(a_panel_without_a_body_says_how_one_is_found),
		cmocka_unit_test(the_log_shows_the_newest_lines_from_below),
		cmocka_unit_test(the_help_can_be_read_to_its_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
