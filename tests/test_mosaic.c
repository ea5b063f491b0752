/* SPDX-License-Identifier: MIT */
/* src/control/{mosaic,charts,layout,prompt,keys}.c: what a console is made of, without a terminal. */
#include "control/mosaic.h"

#include "control/charts.h"
#include "control/keys.h"
#include "control/layout.h"
#include "control/prompt.h"
#include "support.h"

/* ---- colours ---- */

static void colours_of_a_palette_are_themselves(void **state)
{
	static const int levels[] = {0, 95, 135, 175, 215, 255};

	(void)state;
	for (int r = 0; r < 6; r++)
		for (int g = 0; g < 6; g++)
			for (int b = 0; b < 6; b++) {
				const uint8_t rgb[3] = {(uint8_t)levels[r], (uint8_t)levels[g],
				                        (uint8_t)levels[b]};
				assert_int_equal(rb_palette_nearest(RB_PALETTE_256, rgb),
				                 16 + 36 * r + 6 * g + b);
			}
	for (int step = 0; step < 24; step++) {
		const uint8_t grey = (uint8_t)(8 + 10 * step);
		assert_int_equal(rb_palette_nearest(RB_PALETTE_256, (uint8_t[3]){grey, grey, grey}),
		                 232 + step);
	}
	assert_int_equal(rb_palette_nearest(RB_PALETTE_8, (uint8_t[3]){210, 10, 5}), 1);
	assert_int_equal(rb_palette_nearest(RB_PALETTE_16, (uint8_t[3]){250, 10, 5}), 9);
	assert_int_equal(rb_palette_nearest(RB_PALETTE_TRUE, (uint8_t[3]){0x12, 0x80, 0xff}),
	                 0x1080f8);
}

static void a_cell_holds_two_pixels_where_it_can(void **state)
{
	static const uint8_t white[3] = {255, 255, 255}, black[3] = {0, 0, 0};

	(void)state;
	rb_cell cell = rb_mosaic_cell(RB_PALETTE_256, true, white, black, 0, 0);
	assert_int_equal(cell.glyph, 0x2580);
	assert_int_equal(cell.fore, 231);
	assert_int_equal(cell.back, 16);
	cell = rb_mosaic_cell(RB_PALETTE_256, true, white, white, 0, 0);
	assert_int_equal(cell.glyph, ' ');
	assert_int_equal(cell.back, 231);
	/* without UTF-8 the mean of both, as a background */
	cell = rb_mosaic_cell(RB_PALETTE_256, false, white, black, 0, 0);
	assert_int_equal(cell.glyph, ' ');
	assert_int_equal(cell.back, 244);
}

static void every_cell_without_colours_is_printable_ascii(void **state)
{
	uint32_t last = 0;
	int changes = 0;

	(void)state;
	for (int grey = 0; grey < 256; grey++) {
		const uint8_t rgb[3] = {(uint8_t)grey, (uint8_t)grey, (uint8_t)grey};
		const rb_cell cell = rb_mosaic_cell(RB_PALETTE_NONE, true, rgb, rgb, 3, 5);
		assert_true(cell.glyph >= ' ' && cell.glyph < 0x7f);
		assert_true(cell.fore < 0 && cell.back < 0);
		changes += cell.glyph != last;
		last = cell.glyph;
	}
	assert_int_equal(changes, 10);
	assert_int_equal(last, '@');
}

/* A pattern of two colours comes as near to one between them as one can see from afar. */
static void few_colours_mix(void **state)
{
	static const uint8_t grey[3] = {178, 178, 178};
	int bright = 0;

	(void)state;
	for (int y = 0; y < 8; y++)
		for (int x = 0; x < 8; x++) {
			const rb_cell cell = rb_mosaic_cell(RB_PALETTE_16, true, grey, grey, x, y);
			bright += cell.glyph == ' ' ? 2 * (cell.back == 7) : 1;
		}
	assert_in_range(bright, 16, 112);
}

/* ---- charts ---- */

static void charts_show_low_values_low(void **state)
{
	const double values[] = {0, 1, 2, 4, 8, (double)NAN};
	uint32_t glyphs[6];
	double low, high;

	(void)state;
	rb_chart_range(values, 6, &low, &high);
	assert_near(low, 0, 0);
	assert_near(high, 8, 0);
	rb_chart_spark(glyphs, values, 6, low, high, true);
	assert_int_equal(glyphs[0], 0x2581);
	assert_int_equal(glyphs[3], 0x2585);
	assert_int_equal(glyphs[4], 0x2588);
	assert_int_equal(glyphs[5], ' ');
	rb_chart_spark(glyphs, values, 6, 0, 0, false);
	for (int i = 0; i < 5; i++)
		assert_int_equal(glyphs[i], '_');
}

static void the_time_line_shows_place_reach_and_collisions(void **state)
{
	const uint64_t marks[4] = {0, 3, 0, 1};
	const struct rb_timeline line = {
		.position = 0, .available = 0.5, .marks = marks, .mark_count = 4};
	uint32_t glyphs[21];
	char text[22] = "";

	(void)state;
	rb_chart_timeline(glyphs, 21, &line, false);
	for (int i = 0; i < 21; i++)
		text[i] = (char)glyphs[i];
	assert_string_equal(text, "O-------!--.......!..");
	for (int i = 0; i < 21; i++)
		assert_near(rb_chart_timeline_at(21, i), i / 20.0, 1e-15);
	assert_near(rb_chart_timeline_at(21, 99), 1, 0);
}

/* ---- layout ---- */

static void put(unsigned char *cells, int width, int height, rb_area area)
{
	assert_true(area.x >= 0 && area.y >= 0);
	assert_true(area.x + area.width <= width && area.y + area.height <= height);
	for (int y = area.y; y < area.y + area.height; y++)
		for (int x = area.x; x < area.x + area.width; x++)
			assert_int_equal(cells[y * width + x]++, 0);
}

static void at_no_size_do_parts_overlap_or_leave_the_screen(void **state)
{
	(void)state;
	for (int width = 40; width <= 220; width += 3)
		for (int height = 12; height <= 80; height++) {
			const struct rb_layout l = rb_layout_of(width, height);
			const rb_area all[] = {l.transport, l.picture, l.numbers,  l.charts,
			                       l.body,      l.log,     l.timeline, l.bottom};
			unsigned char *cells = calloc((size_t)width * (size_t)height, 1);
			assert_true(l.fits);
			for (size_t i = 0; i < sizeof all / sizeof *all; i++)
				put(cells, width, height, all[i]);
			assert_true(l.picture.width >= 40 && l.picture.height >= 6);
			free(cells);
		}
	assert_false(rb_layout_of(39, 12).fits);
	assert_false(rb_layout_of(40, 11).fits);
	const struct rb_layout whole = rb_layout_of(100, 30);
	assert_true(whole.numbers.height > 0 && whole.charts.height > 3 && whole.body.height > 4);
}

/* ---- the line ---- */

static void type(struct rb_prompt *prompt, const char *text)
{
	for (; *text; text++)
		assert_int_equal(rb_prompt_key(prompt, (uint32_t)*text), RB_PROMPT_STAYS);
}

static void a_line_is_edited_between_characters(void **state)
{
	struct rb_prompt *p = calloc(1, sizeof *p);

	(void)state;
	rb_prompt_open(p, ':', "body ");
	(void)rb_prompt_key(p, 0xe4); /* an a with two dots */
	(void)rb_prompt_key(p, 0x1f600);
	type(p, "x");
	assert_string_equal(p->text, "body \xc3\xa4\xf0\x9f\x98\x80x");
	(void)rb_prompt_key(p, RB_KEY_LEFT);
	(void)rb_prompt_key(p, RB_KEY_LEFT);
	(void)rb_prompt_key(p, RB_KEY_BACKSPACE);
	assert_string_equal(p->text, "body \xf0\x9f\x98\x80x");
	(void)rb_prompt_key(p, RB_KEY_DELETE);
	assert_string_equal(p->text, "body x");
	(void)rb_prompt_key(p, RB_KEY_END);
	(void)rb_prompt_key(p, 23);
	assert_string_equal(p->text, "body ");
	(void)rb_prompt_key(p, 21);
	assert_string_equal(p->text, "");
	assert_int_equal(rb_prompt_key(p, RB_KEY_BACKSPACE), RB_PROMPT_LEFT);
	assert_false(p->open);
	free(p);
}

static void earlier_lines_come_back(void **state)
{
	struct rb_prompt *p = calloc(1, sizeof *p);

	(void)state;
	for (int i = 0; i < RB_PROMPT_HISTORY + 10; i++) {
		char line[32];
		snprintf(line, sizeof line, "seek %d", i);
		rb_prompt_open(p, ':', line);
		assert_int_equal(rb_prompt_key(p, RB_KEY_ENTER), RB_PROMPT_DONE);
	}
	rb_prompt_open(p, ':', "seek 73"); /* the same again is kept once */
	assert_int_equal(rb_prompt_key(p, RB_KEY_ENTER), RB_PROMPT_DONE);
	rb_prompt_open(p, ':', "");
	(void)rb_prompt_key(p, RB_KEY_UP);
	assert_string_equal(p->text, "seek 73");
	(void)rb_prompt_key(p, RB_KEY_UP);
	assert_string_equal(p->text, "seek 72");
	for (int i = 0; i < 100; i++)
		(void)rb_prompt_key(p, RB_KEY_UP);
	assert_string_equal(p->text, "seek 10");
	for (int i = 0; i < 100; i++)
		(void)rb_prompt_key(p, RB_KEY_DOWN);
	assert_string_equal(p->text, "");
	free(p);
}

static void a_line_that_is_full_takes_no_more(void **state)
{
	struct rb_prompt *p = calloc(1, sizeof *p);

	(void)state;
	rb_prompt_open(p, ':', "");
	for (int i = 0; i < 3000; i++)
		(void)rb_prompt_key(p, 0x20ac);
	assert_true(p->size < RB_COMMAND_LINE_SIZE && p->size == strlen(p->text));
	assert_int_equal(p->size % 3, 0);
	free(p);
}

static const char *some_names(void *user, enum rb_command_kind kind, int index)
{
	static const char *const names[] = {"ball", "green ball", "green box", ""};

	(void)user;
	return kind == RB_COMMAND_BODY && index < 4 ? names[index] : NULL;
}

static void a_word_is_continued_as_far_as_it_is_sure(void **state)
{
	const struct rb_command_names names = {some_names, NULL};
	const char *out[16];
	struct rb_prompt *p = calloc(1, sizeof *p);

	(void)state;
	rb_prompt_open(p, ':', "see");
	assert_int_equal(rb_prompt_complete(p, &names, out, 16), 1);
	assert_string_equal(p->text, "seek ");
	rb_prompt_open(p, ':', "s");
	assert_true(rb_prompt_complete(p, &names, out, 16) > 3);
	assert_string_equal(p->text, "s");
	rb_prompt_open(p, ':', "body b");
	assert_int_equal(rb_prompt_complete(p, &names, out, 16), 1);
	assert_string_equal(p->text, "body ball ");
	/* names with spaces get their quotes */
	rb_prompt_open(p, ':', "body g");
	assert_int_equal(rb_prompt_complete(p, &names, out, 16), 2);
	assert_string_equal(p->text, "body \"green b");
	type(p, "o");
	assert_int_equal(rb_prompt_complete(p, &names, out, 16), 1);
	assert_string_equal(p->text, "body \"green box\" ");
	rb_prompt_open(p, ':', "nothing");
	assert_int_equal(rb_prompt_complete(p, &names, out, 16), 0);
	free(p);
}

/* ---- keys ---- */

static void every_key_that_is_a_command_is_one(void **state)
{
	struct rb_command command;
	struct rb_error err;
	bool given;

	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *row = &rb_key_rows[i];
		assert_ptr_equal(rb_key_find(row->key), row); /* no key twice */
		if (row->action == RB_KEY_RUNS)
			assert_ok(rb_command_parse(&command, &given, row->line, &err));
	}
}

/* What a key begins to type goes on to be a command. */
static void every_key_that_types_begins_a_command(void **state)
{
	const char *out[RB_COMMAND_KIND_COUNT];

	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		char name[32];
		if (rb_key_rows[i].action != RB_KEY_TYPES || !*rb_key_rows[i].line)
			continue;
		snprintf(name, sizeof name, "%.*s", (int)strcspn(rb_key_rows[i].line, " "),
		         rb_key_rows[i].line);
		assert_int_equal(rb_command_complete(name, NULL, out, RB_COMMAND_KIND_COUNT), 1);
		assert_string_equal(out[0], name);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(colours_of_a_palette_are_themselves),
		cmocka_unit_test(a_cell_holds_two_pixels_where_it_can),
		cmocka_unit_test(every_cell_without_colours_is_printable_ascii),
		cmocka_unit_test(few_colours_mix),
		cmocka_unit_test(charts_show_low_values_low),
		cmocka_unit_test(the_time_line_shows_place_reach_and_collisions),
		cmocka_unit_test(at_no_size_do_parts_overlap_or_leave_the_screen),
		cmocka_unit_test(a_line_is_edited_between_characters),
		cmocka_unit_test(earlier_lines_come_back),
		cmocka_unit_test(a_line_that_is_full_takes_no_more),
		cmocka_unit_test(a_word_is_continued_as_far_as_it_is_sure),
		cmocka_unit_test(every_key_that_is_a_command_is_one),
		cmocka_unit_test(every_key_that_types_begins_a_command),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
