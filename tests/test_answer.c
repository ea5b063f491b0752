/* SPDX-License-Identifier: MIT */
/* src/control/answer.c: lines of an answer, whatever is put into them */
#include "support.h"

#include "control/answer.h"
#include "control/command.h"
#include "math/random.h"

static void assert_text(const struct rb_answer *answer, const char *wanted)
{
	if (answer->size != strlen(wanted) || memcmp(answer->text, wanted, answer->size) != 0)
		fail_msg("'%.*s', wanted '%s'", (int)answer->size, answer->text, wanted);
}

static void lines_begin_with_a_space_and_the_last_one_does_not(void **state)
{
	struct rb_answer answer = {0};
	struct rb_error err = {.text = "no body is called 'x'"};

	(void)state;
	rb_answer_line(&answer, "frame %d of %s", 3, "12");
	rb_answer_line(&answer, "%s", "");
	rb_answer_end(&answer, RB_OK, &err);
	assert_text(&answer, " frame 3 of 12\n \nok\n");
	rb_answer_end(&answer, RB_ERR_USAGE, &err);
	assert_text(&answer, " frame 3 of 12\n \nok\nerror no body is called 'x'\n");
	rb_answer_release(&answer);
	rb_answer_release(&answer);
	err.text[0] = '\0';
	rb_answer_end(&answer, RB_ERR_INPUT, &err);
	assert_non_null(answer.text);
	assert_memory_equal(answer.text, "error ", 6);
	assert_true(answer.size > strlen("error \n"));
	rb_answer_release(&answer);
	rb_answer_put(&answer, "a\0\n", 3); /* as they are */
	assert_int_equal(answer.size, 3);
	assert_memory_equal(answer.text, "a\0\n", 3);
	rb_answer_release(&answer);
}

/* A body's name must not end a line, say "ok" in another, or steer a terminal. */
static void what_is_not_printable_becomes_a_question_mark(void **state)
{
	struct rb_answer answer = {0};
	struct rb_error err = {.text = "a\nok\x1b[2J"};

	(void)state;
	rb_answer_line(&answer, "%s", "a\nok\n");
	rb_answer_line(&answer, "%s", "\x1b[31m\tred\x7f");
	rb_answer_line(&answer, "%s", "\xc3\xa9 \xc3 \xe2\x82\xac \xc0\xaf \xed\xa0\x80 \xff");
	assert_text(&answer, " a?ok?\n ?[31m?red?\n \xc3\xa9 ? \xe2\x82\xac ?? ??? ?\n");
	rb_answer_release(&answer);
	rb_answer_end(&answer, RB_ERR_USAGE, &err);
	assert_text(&answer, "error a?ok?[2J\n");
	rb_answer_release(&answer);
}

/* Whatever the bytes, a line is one line of printable characters. */
static void random_bytes_give_one_printable_line(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 3000; k++) {
		struct rb_answer answer = {0};
		char bytes[60];
		const size_t size = rb_random_bits(1, k, 0) % sizeof bytes;

		for (size_t i = 0; i < size; i++)
			bytes[i] = (char)(1 + rb_random_bits(1, k, i + 1) % 255);
		rb_answer_line(&answer, "%.*s", (int)size, bytes);
		assert_int_equal(answer.text[0], ' ');
		assert_int_equal(answer.size, size + 2); /* each byte by one, or as it was */
		assert_int_equal(answer.text[answer.size - 1], '\n');
		answer.text[answer.size - 1] = '\0';
		for (const char *at = answer.text; *at;) {
			const size_t one = rb_command_character(at);
			assert_true(one > 0 && *at != '\t' && *at != '\n');
			at += one;
		}
		rb_answer_release(&answer);
	}
}

static void a_long_line_is_cut(void **state)
{
	struct rb_answer answer = {0};
	static char text[5000];

	(void)state;
	memset(text, 'x', sizeof text - 1);
	rb_answer_line(&answer, "%s", text);
	assert_in_range(answer.size, 1000, 1030);
	assert_int_equal(answer.text[answer.size - 1], '\n');
	assert_null(memchr(answer.text, '\0', answer.size));
	/* a character that is cut in two is none */
	rb_answer_release(&answer);
	for (size_t i = 0; i + 1 < sizeof text; i++)
		text[i] = i % 2 ? '\xa9' : '\xc3';
	for (int more = 0; more < 2; more++) {
		rb_answer_line(&answer, "%s%s", more ? "x" : "", text);
		const char last = answer.text[answer.size - 2];
		assert_true(last == '\xa9' || last == '?');
		rb_answer_release(&answer);
	}
}

static void what_memory_has_no_room_for_is_told_once(void **state)
{
	struct rb_answer answer = {0};

	(void)state;
	rb_answer_line(&answer, "first");
	const size_t size = answer.size;
	static char text[900];
	memset(text, 'x', sizeof text - 1);
	rb_memory_fail_at(1);
	rb_answer_line(&answer, "%s", text);
	rb_memory_fail_at(0);
	assert_true(answer.lost);
	assert_int_equal(answer.size, size);
	rb_answer_line(&answer, "this would have room, and the answer would have a hole");
	assert_int_equal(answer.size, size);
	rb_answer_end(&answer, RB_OK, NULL);
	assert_text(&answer, " first\nerror out of memory\n");
	/* the next answer is whole again */
	answer.size = 0;
	rb_answer_line(&answer, "second");
	rb_answer_end(&answer, RB_OK, NULL);
	assert_text(&answer, " second\nok\n");
	rb_answer_release(&answer);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lines_begin_with_a_space_and_the_last_one_does_not),
		cmocka_unit_test(what_is_not_printable_becomes_a_question_mark),
		cmocka_unit_test(random_bytes_give_one_printable_line),
		cmocka_unit_test(a_long_line_is_cut),
		cmocka_unit_test(what_memory_has_no_room_for_is_told_once),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
