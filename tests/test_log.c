/* SPDX-License-Identifier: MIT */
/* src/base/log.c: levels and one sink */
#include "support.h"

#include "base/log.h"

struct heard {
	int count;
	enum rb_log_level level;
	char text[4096];
};

static void hear(enum rb_log_level level, const char *text, void *user)
{
	struct heard *const heard = user;

	heard->count++;
	heard->level = level;
	snprintf(heard->text, sizeof heard->text, "%s", text);
}

static void levels_above_the_most_are_left_out(void **state)
{
	static const enum rb_log_level levels[] = {RB_LOG_WARNING, RB_LOG_NOTE, RB_LOG_DEBUG};

	(void)state;
	for (int most = 0; most < 3; most++) {
		for (int level = 0; level < 3; level++) {
			struct heard heard = {0};

			rb_log_to(hear, &heard, levels[most]);
			rb_log(levels[level], "%d of %s", 3, "four");
			assert_int_equal(heard.count, level <= most);
			if (level <= most) {
				assert_string_equal(heard.text, "3 of four");
				assert_int_equal(heard.level, levels[level]);
			}
		}
	}
	rb_log_to(NULL, NULL, RB_LOG_WARNING);
}

static void without_a_sink_nothing_is_written(void **state)
{
	struct heard heard = {0};

	(void)state;
	rb_log_to(hear, &heard, RB_LOG_DEBUG);
	rb_log_to(NULL, &heard, RB_LOG_DEBUG);
	rb_log(RB_LOG_WARNING, "unheard");
	assert_int_equal(heard.count, 0);
}

static void a_long_text_is_cut_and_ends(void **state)
{
	struct heard heard = {0};
	char text[4000];

	(void)state;
	memset(text, 'x', sizeof text);
	text[sizeof text - 1] = '\0';
	rb_log_to(hear, &heard, RB_LOG_NOTE);
	rb_log(RB_LOG_NOTE, "begin %s", text);
	rb_log_to(NULL, NULL, RB_LOG_WARNING);
	assert_int_equal(heard.count, 1);
	assert_memory_equal(heard.text, "begin xxx", 9);
	assert_true(strspn(heard.text + 6, "x") == strlen(heard.text + 6));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(levels_above_the_most_are_left_out),
		cmocka_unit_test(without_a_sink_nothing_is_written),
		cmocka_unit_test(a_long_text_is_cut_and_ends),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
