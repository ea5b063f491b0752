/* SPDX-License-Identifier: MIT */
/* base/visible: texts that are not ours, on their way to people. */
#include "support.h"

#include "base/visible.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* What rb_print writes, in memory of the C library's. */
#define PRINTS(wanted, ...)                                       \
	do {                                                      \
		char *said = NULL;                                \
		size_t said_size = 0;                             \
		FILE *stream = open_memstream(&said, &said_size); \
		rb_print(stream, __VA_ARGS__);                    \
		fclose(stream);                                   \
		assert_string_equal(said, wanted);                \
		free(said);                                       \
	} while (0)

static void texts_are_made_visible_and_formats_are_not(void **state)
{
	(void)state;
	PRINTS("\033[1ma\\nb\\x1b[31m\tc\\x0d\\x7f\n", "\033[1m%s\n", "a\nb\033[31m\tc\r\x7f");
	PRINTS("\\u{9b}\\u{202e}\\u{2066}", "%s", "\xc2\x9b\xe2\x80\xae\xe2\x81\xa6");
	PRINTS("\\xff\\xc0\\x80\\xed\\xa0\\x80\\xe2\\x82", "%s",
	       "\xff\xc0\x80\xed\xa0\x80\xe2\x82");
	PRINTS("\xc3\xa9\xe2\x82\xac\xf0\x9f\x8e\xb1", "%s",
	       "\xc3\xa9\xe2\x82\xac\xf0\x9f\x8e\xb1");
}

static void widths_and_precisions_are_those_of_printf(void **state)
{
	(void)state;
	PRINTS("[ab   |   cd|ef|h   ]", "[%-5s|%5s|%.2s|%-*.*s]", "ab", "cd", "efg", 4, 1, "hi");
	PRINTS("[    1|2    |00003|+4|ff|0000000000000abc]",
	       "[%5d|%-5d|%05d|%+d|%x|%016" PRIx64 "]", 1, 2, 3, 4, 255u, UINT64_C(0xabc));
	PRINTS("1 -5 6 18446744073709551615 x%", "%zu %lld %llu %" PRIu64 " %c%%", sizeof(char),
	       -5LL, 6ULL, UINT64_MAX, 'x');
	PRINTS("0.5 0.10000000000000001 +2   3.14 1.000000e+00", "%g %.17g %+.3g %6.2f %e", 0.5,
	       0.1, 2.0, 3.14159, 1.0);
}

static void long_texts_come_out_whole(void **state)
{
	char text[9001];

	(void)state;
	memset(text, 'a', sizeof text - 1);
	text[sizeof text - 1] = '\0';
	PRINTS(text, "%s", text);
}

static void lines_stay_lines_and_nothing_else_gets_through(void **state)
{
	char *text = NULL;
	size_t size = 0;

	(void)state;
	FILE *file = open_memstream(&text, &size);
	rb_print_lines(file, "a\nb\033c\nd", 7);
	fclose(file);
	assert_string_equal(text, "a\nb\\x1bc\nd\n");
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(texts_are_made_visible_and_formats_are_not),
		cmocka_unit_test(widths_and_precisions_are_those_of_printf),
		cmocka_unit_test(long_texts_come_out_whole),
		cmocka_unit_test(lines_stay_lines_and_nothing_else_gets_through),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
