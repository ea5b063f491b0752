/* SPDX-License-Identifier: MIT */
/* src/app/json.c: one JSON value */
#include "support.h"

#include "app/json.h"

/* What `write` writes, in static storage. */
static const char *written(void (*write)(struct rb_json *json))
{
	static char text[1024];
	char *made = NULL;
	size_t size = 0;
	struct rb_json json = {.file = open_memstream(&made, &size)};

	assert_non_null(json.file);
	write(&json);
	fclose(json.file);
	assert_true(size < sizeof text);
	memcpy(text, made, size);
	text[size] = '\0';
	free(made);
	return text;
}

static void write_nested(struct rb_json *json)
{
	rb_json_open(json, NULL, '{');
	rb_json_open(json, "empty", '{');
	rb_json_close(json, '}');
	rb_json_open(json, "list", '[');
	rb_json_count(json, NULL, UINT64_MAX);
	rb_json_open(json, NULL, '[');
	rb_json_close(json, ']');
	rb_json_bool(json, NULL, false);
	rb_json_close(json, ']');
	rb_json_bool(json, "yes", true);
	rb_json_vector(json, "v", (const double[]){1, -0.5, 0}, 3);
	rb_json_vector(json, "w", NULL, 0);
	rb_json_close(json, '}');
}

static void commas_stand_between_values_and_nowhere_else(void **state)
{
	(void)state;
	assert_string_equal(written(write_nested),
	                    "{\"empty\":{},\"list\":[18446744073709551615,[],false],\"yes\":true,"
	                    "\"v\":[1,-0.5,0],\"w\":[]}");
}

static double number;

static void write_number(struct rb_json *json)
{
	rb_json_number(json, NULL, number);
}

static void numbers_read_as_they_were_and_are_null_where_json_has_none(void **state)
{
	static const double some[] = {0.1,  1.0 / 3,  5e-324, 1.7976931348623157e308,
	                              -0.0, 123456789};

	(void)state;
	for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
		number = some[k];
		const double read = strtod(written(write_number), NULL);

		assert_memory_equal(&read, &some[k], sizeof read);
	}
	number = (double)NAN;
	assert_string_equal(written(write_number), "null");
	number = -(double)INFINITY;
	assert_string_equal(written(write_number), "null");
}

static const char *text;

static void write_text(struct rb_json *json)
{
	rb_json_text(json, NULL, text);
}

static void texts_are_escaped_and_always_utf_8(void **state)
{
	static const char *const some[][2] = {
		{"plain", "\"plain\""},
		{"a \"b\" \\c", "\"a \\\"b\\\" \\\\c\""},
		{"line\nnext\ttab\033[2J\177", "\"line\\nnext\\u0009tab\\u001b[2J\\u007f\""},
		{"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80",
	         "\"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80\""},
		{"", "\"\""},
	};
	/* cut short, overlong, a surrogate, beyond the last, a lone continuation: U+FFFD and then what follows */
	static const char *const wrong[] = {"\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80",
	                                    "\x80", "\xff"};

	(void)state;
	for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
		text = some[k][0];
		assert_string_equal(written(write_text), some[k][1]);
	}
	for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
		char with[32];
		const char *out;

		snprintf(with, sizeof with, "%s!", wrong[k]);
		text = with;
		out = written(write_text);
		assert_non_null(strstr(out, "\\ufffd"));
		assert_string_equal(out + strlen(out) - 2, "!\"");
		assert_null(strstr(out, wrong[k]));
	}
	text = NULL;
	assert_string_equal(written(write_text), "null");
}

static void write_named(struct rb_json *json)
{
	rb_json_open(json, NULL, '{');
	rb_json_text(json, "a \"name\"\n", "x");
	rb_json_close(json, '}');
}

static void names_are_escaped_too(void **state)
{
	(void)state;
	assert_string_equal(written(write_named), "{\"a \\\"name\\\"\\n\":\"x\"}");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(commas_stand_between_values_and_nowhere_else),
		cmocka_unit_test(numbers_read_as_they_were_and_are_null_where_json_has_none),
		cmocka_unit_test(texts_are_escaped_and_always_utf_8),
		cmocka_unit_test(names_are_escaped_too),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
