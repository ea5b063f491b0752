/* SPDX-License-Identifier: MIT */
/* src/base/error.c */
#include "support.h"

#include "base/error.h"

static void failing_returns_the_status_and_fills_the_record(void **state)
{
	struct rb_error err = {0};

	(void)state;
	const int line = __LINE__ + 1;
	const enum rb_status status = RB_FAIL(&err, RB_ERR_INPUT, "no '%s': %d", "a.lua", 2);
	assert_int_equal(status, RB_ERR_INPUT);
	assert_int_equal(err.status, RB_ERR_INPUT);
	assert_string_equal(err.text, "no 'a.lua': 2");
	assert_int_equal(err.line, line);
	assert_non_null(strstr(err.file, "test_error.c"));
}

static void a_record_is_not_needed(void **state)
{
	(void)state;
	assert_int_equal(RB_FAIL(NULL, RB_ERR_IO, "unseen"), RB_ERR_IO);
}

static void a_long_text_is_cut_visibly_and_never_overruns(void **state)
{
	struct {
		struct rb_error err;
		unsigned char after[16];
	} record;
	char text[1000];

	(void)state;
	memset(record.after, 0xa5, sizeof record.after);
	memset(text, 'x', sizeof text - 1);
	text[sizeof text - 1] = '\0';
	(void)RB_FAIL(&record.err, RB_ERR_SCENE, "cannot open '%s': No such file", text);
	assert_int_equal(strlen(record.err.text), RB_ERROR_TEXT_SIZE - 1);
	assert_non_null(strstr(record.err.text, "x...x"));
	/* what failed and why stay */
	assert_ptr_equal(strstr(record.err.text, "cannot open 'xxx"), record.err.text);
	assert_string_equal(record.err.text + RB_ERROR_TEXT_SIZE - 18, "xx': No such file");
	for (size_t i = 0; i < sizeof record.after; i++)
		assert_int_equal(record.after[i], 0xa5);
}

static void a_text_that_just_fits_is_not_cut(void **state)
{
	struct rb_error err;
	char text[RB_ERROR_TEXT_SIZE];

	(void)state;
	memset(text, 'y', sizeof text - 1);
	text[sizeof text - 1] = '\0';
	(void)RB_FAIL(&err, RB_ERR_SCENE, "%s", text);
	assert_string_equal(err.text, text);
}

static void cutting_does_not_split_a_character(void **state)
{
	struct rb_error err;
	char text[400] = "";

	(void)state;
	/* two-byte characters, shifted by one and by none: one of them would be split at any place */
	for (int shift = 0; shift < 2; shift++) {
		strcpy(text, shift ? "z" : "");
		for (int i = 0; i < 150; i++)
			strcat(text, "\xc3\xa9");
		(void)RB_FAIL(&err, RB_ERR_SCENE, "%s", text);
		assert_true(strlen(err.text) >= RB_ERROR_TEXT_SIZE - 3);
		const char *const cut = strstr(err.text, "...");
		assert_non_null(cut);
		assert_int_equal((unsigned char)cut[-1], 0xa9);
		assert_int_equal((unsigned char)cut[3], 0xc3);
	}
}

/* One that is longer than any message is has no end to be kept. */
static void an_endless_text_is_cut_between_characters(void **state)
{
	static char text[20002];
	struct rb_error err;

	(void)state;
	for (int offset = 0; offset < 2; offset++) {
		memset(text, 'a', (size_t)offset);
		for (int i = 0; i < 10000; i++)
			memcpy(text + offset + 2 * i, "\xc3\xa9", 3);
		(void)RB_FAIL(&err, RB_ERR_SCENE, "%s", text);
		const size_t length = strlen(err.text);
		assert_string_equal(err.text + length - 3, "...");
		assert_int_equal((unsigned char)err.text[length - 4], 0xa9);
	}
}

static void a_place_keeps_the_end_of_a_long_name(void **state)
{
	char out[24];

	(void)state;
	assert_string_equal(rb_error_place("a.lua", 12, out, sizeof out), "a.lua:12: ");
	assert_string_equal(rb_error_place("a.lua", 0, out, sizeof out), "a.lua: ");
	assert_string_equal(rb_error_place("12345678901234567.lua", 7, out, sizeof out),
	                    "...678901234567.lua:7: ");
}

static void a_record_may_be_quoted_in_its_successor(void **state)
{
	struct rb_error err;

	(void)state;
	(void)RB_FAIL(&err, RB_ERR_IO, "disk full");
	(void)RB_FAIL(&err, RB_ERR_IO, "frame %d: %s", 7, err.text);
	assert_string_equal(err.text, "frame 7: disk full");
}

static void exit_codes_are_those_of_the_manual(void **state)
{
	static const int expected[RB_STATUS_COUNT] = {0,  1,  64, 65, 66, 69,  70,
	                                              71, 73, 74, 75, 76, 130, 143};

	(void)state;
	for (int s = 0; s < RB_STATUS_COUNT; s++) {
		assert_int_equal(rb_status_exit_code((enum rb_status)s), expected[s]);
		assert_true(strlen(rb_status_name((enum rb_status)s)) > 0);
	}
	assert_int_equal(rb_status_exit_code((enum rb_status)RB_STATUS_COUNT), 70);
	assert_string_equal(rb_status_name((enum rb_status)1000), rb_status_name(RB_ERR_BUG));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(failing_returns_the_status_and_fills_the_record),
		cmocka_unit_test(a_record_is_not_needed),
		cmocka_unit_test(a_long_text_is_cut_visibly_and_never_overruns),
		cmocka_unit_test(a_text_that_just_fits_is_not_cut),
		cmocka_unit_test(cutting_does_not_split_a_character),
		cmocka_unit_test(an_endless_text_is_cut_between_characters),
		cmocka_unit_test(a_place_keeps_the_end_of_a_long_name),
		cmocka_unit_test(a_record_may_be_quoted_in_its_successor),
		cmocka_unit_test(exit_codes_are_those_of_the_manual),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
