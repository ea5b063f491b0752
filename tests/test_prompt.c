/* SPDX-License-Identifier: MIT */
/* src/control/prompt.c: the line in which commands are typed, and what was typed before */
#include "support.h"

#include "control/keys.h"
#include "control/prompt.h"
#include "math/random.h"

static struct rb_prompt prompt;

static void type(const char *text)
{
	for (; *text; text++)
		assert_int_equal(rb_prompt_key(&prompt, (unsigned char)*text), RB_PROMPT_STAYS);
}

static void press(uint32_t key)
{
	assert_int_equal(rb_prompt_key(&prompt, key), RB_PROMPT_STAYS);
}

static void assert_line(const char *text, size_t at)
{
	assert_string_equal(prompt.text, text);
	assert_int_equal(prompt.size, strlen(text));
	assert_int_equal(prompt.at, at);
}

static void open_with(const char *text)
{
	memset(&prompt, 0, sizeof prompt);
	rb_prompt_open(&prompt, ':', text);
	assert_true(prompt.open);
	assert_int_equal(prompt.lead, ':');
}

static void keys_edit_where_the_cursor_stands(void **state)
{
	(void)state;
	open_with("");
	type("sek 5");
	assert_line("sek 5", 5);
	press(RB_KEY_HOME);
	press(RB_KEY_RIGHT);
	press(RB_KEY_RIGHT);
	type("e");
	assert_line("seek 5", 3);
	press(RB_KEY_END);
	press(RB_KEY_LEFT);
	press(RB_KEY_DELETE);
	type("12%");
	assert_line("seek 12%", 8);
	press(RB_KEY_BACKSPACE);
	assert_line("seek 12", 7);
	press(RB_KEY_RIGHT); /* there is nothing */
	press(RB_KEY_DELETE);
	assert_line("seek 12", 7);
	press(23); /* ctrl-W: a word */
	assert_line("seek ", 5);
	press(23);
	assert_line("", 0);
	type("one two  three");
	press(RB_KEY_LEFT);
	press(23);
	assert_line("one two  e", 9);
	press(1); /* ctrl-A */
	press(RB_KEY_LEFT);
	assert_line("one two  e", 0);
	press(5); /* ctrl-E */
	press(RB_KEY_LEFT);
	press(21); /* ctrl-U */
	assert_line("e", 0);
}

static void characters_are_whole_whatever_their_bytes(void **state)
{
	static const uint32_t typed[] = {'a', 0xe9, 0x20ac, 0x1f600};

	(void)state;
	open_with("");
	for (int i = 0; i < 4; i++)
		press(typed[i]);
	assert_line("a\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80", 10);
	press(RB_KEY_LEFT);
	assert_int_equal(prompt.at, 6);
	press(RB_KEY_LEFT);
	assert_int_equal(prompt.at, 3);
	press(RB_KEY_BACKSPACE);
	assert_line("a\xe2\x82\xac\xf0\x9f\x98\x80", 1);
	press(RB_KEY_DELETE);
	assert_line("a\xf0\x9f\x98\x80", 1);
	press(RB_KEY_RIGHT);
	assert_int_equal(prompt.at, 5);
	/* these are no characters */
	static const uint32_t none[] = {0,          2,         31, 127, RB_KEY_RESIZE, RB_KEY_MOUSE,
	                                RB_KEY_TAB, UINT32_MAX};
	for (size_t i = 0; i < sizeof none / sizeof *none; i++)
		press(none[i]);
	assert_line("a\xf0\x9f\x98\x80", 5);
}

static void enter_keeps_a_line_and_escape_leaves(void **state)
{
	(void)state;
	open_with("step");
	assert_int_equal(rb_prompt_key(&prompt, RB_KEY_ENTER), RB_PROMPT_DONE);
	assert_false(prompt.open);
	assert_string_equal(prompt.text, "step");
	static const uint32_t leaves[] = {RB_KEY_ESCAPE, 3};
	for (int i = 0; i < 2; i++) {
		rb_prompt_open(&prompt, '/', "ba");
		assert_int_equal(prompt.lead, '/');
		assert_int_equal(rb_prompt_key(&prompt, leaves[i]), RB_PROMPT_LEFT);
		assert_false(prompt.open);
	}
	rb_prompt_open(&prompt, ':', "x");
	press(RB_KEY_BACKSPACE);
	assert_int_equal(rb_prompt_key(&prompt, RB_KEY_BACKSPACE), RB_PROMPT_LEFT);
	assert_int_equal(prompt.count, 1);
}

static void enter(const char *line)
{
	rb_prompt_open(&prompt, ':', line);
	assert_int_equal(rb_prompt_key(&prompt, RB_KEY_ENTER), RB_PROMPT_DONE);
}

static void earlier_lines_are_fetched_back(void **state)
{
	char line[20];

	(void)state;
	open_with("");
	enter("first");
	enter("second");
	enter("second"); /* once is enough */
	enter("");
	assert_int_equal(prompt.count, 2);
	rb_prompt_open(&prompt, ':', "");
	press(RB_KEY_DOWN);
	assert_line("", 0);
	press(RB_KEY_UP);
	assert_line("second", 6);
	press(RB_KEY_UP);
	assert_line("first", 5);
	press(RB_KEY_UP);
	assert_line("first", 5);
	press(RB_KEY_DOWN);
	press(RB_KEY_DOWN);
	assert_line("", 0); /* behind the last one */
	/* the last 64, and no more */
	for (int i = 0; i < 200; i++) {
		snprintf(line, sizeof line, "line %d", i);
		enter(line);
	}
	rb_prompt_open(&prompt, ':', "");
	for (int i = 0; i < 100; i++)
		press(RB_KEY_UP);
	assert_line("line 136", 8);
	for (int i = 0; i < 10; i++)
		press(RB_KEY_DOWN);
	assert_line("line 146", 8);
}

/* Like a line with a cursor in it that is made of whole characters. */
static void random_keys_leave_a_line_in_order(void **state)
{
	static const uint32_t keys[] = {
		'a',         ' ',          0xe9,        0x20ac,     0x1f600,
		RB_KEY_LEFT, RB_KEY_RIGHT, RB_KEY_HOME, RB_KEY_END, RB_KEY_DELETE,
		RB_KEY_UP,   RB_KEY_DOWN,  23,          21,         RB_KEY_BACKSPACE,
		RB_KEY_ENTER};

	(void)state;
	open_with("");
	for (uint64_t k = 0; k < 100000; k++) {
		const uint64_t choice = rb_random_bits(1, 0, k) % (sizeof keys / sizeof *keys);

		if (!prompt.open || k % 5000 == 0)
			rb_prompt_open(&prompt, ':', prompt.text);
		(void)rb_prompt_key(&prompt, keys[choice]);
		assert_true(prompt.at <= prompt.size && prompt.size < sizeof prompt.text);
		assert_int_equal(strlen(prompt.text), prompt.size);
		bool on_character = prompt.at == 0;
		size_t at = 0;
		while (at < prompt.size) {
			const size_t one = rb_command_character(prompt.text + at);
			assert_true(one > 0);
			at += one;
			on_character = on_character || at == prompt.at;
		}
		assert_int_equal(at, prompt.size);
		assert_true(on_character);
	}
}

static void a_full_line_takes_no_more(void **state)
{
	(void)state;
	open_with("");
	for (int i = 0; i < 2000; i++)
		press(0x20ac);
	/* of three bytes each, with a zero behind */
	assert_int_equal(prompt.size, (RB_COMMAND_LINE_SIZE - 1) / 3 * 3);
	press(RB_KEY_HOME);
	for (int i = 0; i < 20; i++)
		press('x');
	assert_true(prompt.size < RB_COMMAND_LINE_SIZE);
	static char text[5000];
	memset(text, 'y', sizeof text - 1);
	rb_prompt_open(&prompt, ':', text);
	assert_int_equal(prompt.size, RB_COMMAND_LINE_SIZE - 1);
}

static const char *name_of(void *user, enum rb_command_kind kind, int index)
{
	static const char *const names[] = {"ball",
	                                    "ball two",
	                                    "balloon",
	                                    "r\xc3\xa9"
	                                    "d",
	                                    "r\xc3\xaa"
	                                    "d",
	                                    "",
	                                    "the one"};

	(void)user, (void)kind;
	return index < 7 ? names[index] : NULL;
}

static const struct rb_command_names names = {.name = name_of};

/* Tab behind the text; how many candidates, and the line then. */
static void assert_completed(const char *text, int count, const char *wanted)
{
	const char *out[40];

	open_with(text);
	assert_int_equal(rb_prompt_complete(&prompt, &names, out, 40), count);
	assert_line(wanted, strlen(wanted));
}

static void tab_continues_as_far_as_all_candidates_agree(void **state)
{
	const char *out[40];

	(void)state;
	assert_completed("ste", 1, "step ");
	assert_completed("s", 7, "s"); /* step, seek, speed, stop, snapshot, set, status */
	assert_completed("se", 2, "se");
	assert_completed("stop a", 1, "stop at ");
	assert_completed("stop at ", 1, "stop at collision ");
	assert_completed("stop at collision o", 2, "stop at collision o");
	assert_completed("follow the", 1, "follow \"the one\" ");
	assert_completed("follow \"the", 1, "follow \"the one\" ");
	assert_completed("follow ba", 3, "follow ball");
	assert_completed("follow \"ball", 3, "follow \"ball");
	assert_completed("follow \"ball t", 1, "follow \"ball two\" ");
	assert_completed("follow r", 2, "follow r"); /* never into a character */
	assert_completed("follow x", 0, "follow x");
	assert_completed("nothing x", 0, "nothing x");
	/* in the middle of a line what stands behind stays */
	open_with("ste 5");
	press(RB_KEY_LEFT);
	press(RB_KEY_LEFT);
	assert_int_equal(rb_prompt_complete(&prompt, &names, out, 40), 1);
	assert_line("step  5", 5);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keys_edit_where_the_cursor_stands),
		cmocka_unit_test(characters_are_whole_whatever_their_bytes),
		cmocka_unit_test(enter_keeps_a_line_and_escape_leaves),
		cmocka_unit_test(earlier_lines_are_fetched_back),
		cmocka_unit_test(random_keys_leave_a_line_in_order),
		cmocka_unit_test(a_full_line_takes_no_more),
		cmocka_unit_test(tab_continues_as_far_as_all_candidates_agree),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
