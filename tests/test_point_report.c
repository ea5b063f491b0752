/* SPDX-License-Identifier: MIT */
/* src/sweep/point_report.c: values read from what src/app/json.c has written */
#include "support.h"

#include "app/json.h"
#include "math/random.h"
#include "sweep/point_report.h"

/* What has been written so far, without the file. */
struct text {
	struct rb_json json;
	char *bytes;
	size_t size;
};

static void open_text(struct text *text)
{
	*text = (struct text){0};
	text->json.file = open_memstream(&text->bytes, &text->size);
	assert_non_null(text->json.file);
	rb_json_open(&text->json, NULL, '{');
}

static const char *finish(struct text *text)
{
	rb_json_close(&text->json, '}');
	fputc('\n', text->json.file);
	assert_int_equal(fclose(text->json.file), 0);
	return text->bytes;
}

static void what_json_has_written_is_read_back(void **state)
{
	static const double numbers[] = {0, -1.5, 1e-300, 0.1, 123456789012345680.0};
	struct text text;
	char out[80];

	(void)state;
	open_text(&text);
	rb_json_text(&text.json, "status", "complete");
	rb_json_text(&text.json, "said", "a \"b\"\\c\nd");
	for (int i = 0; i < 5; i++) {
		snprintf(out, sizeof out, "n%d", i);
		rb_json_number(&text.json, out, numbers[i]);
	}
	rb_json_number(&text.json, "nothing", (double)NAN);
	rb_json_number(&text.json, "endless", (double)INFINITY);
	rb_json_bool(&text.json, "yes", true);
	rb_json_bool(&text.json, "no", false);
	rb_json_count(&text.json, "count", 4294967296u);
	rb_json_text(&text.json, "none", NULL);
	const char *json = finish(&text);
	rb_point_report_text(json, "status", out, sizeof out);
	assert_string_equal(out, "complete");
	/* one line stays one line */
	rb_point_report_text(json, "said", out, sizeof out);
	assert_string_equal(out, "a \"b\"\\c d");
	for (int i = 0; i < 5; i++) {
		snprintf(out, sizeof out, "n%d", i);
		assert_true(rb_point_report_number(json, out) == numbers[i]);
	}
	assert_true(isnan(rb_point_report_number(json, "nothing")));
	assert_true(isnan(rb_point_report_number(json, "endless")));
	assert_true(rb_point_report_number(json, "yes") == 1 &&
	            rb_point_report_number(json, "no") == 0);
	assert_true(rb_point_report_number(json, "count") == 4294967296.0);
	rb_point_report_text(json, "none", out, sizeof out);
	assert_string_equal(out, "");
	free(text.bytes);
}

/* A scene that gives its texts such names cannot tell a lie about its run. */
static void keys_within_texts_are_not_found(void **state)
{
	struct text text;
	char out[80];

	(void)state;
	open_text(&text);
	rb_json_text(&text.json, "title", "\"exit_status\":0,\"status\":\"complete\"");
	rb_json_text(&text.json, "other", "\\\"exit_status\\\":0");
	rb_json_text(&text.json, "status", "failed");
	rb_json_count(&text.json, "exit_status", 76);
	rb_json_number(&text.json, "wall_time", 3);
	rb_json_number(&text.json, "time", 5);
	const char *json = finish(&text);
	rb_point_report_text(json, "status", out, sizeof out);
	assert_string_equal(out, "failed");
	assert_true(rb_point_report_number(json, "exit_status") == 76);
	assert_true(rb_point_report_number(json, "time") == 5);
	assert_null(rb_point_report_value(json, "exit"));
	assert_null(rb_point_report_value(json, "ime"));
	assert_null(rb_point_report_value(json, "Title"));
	free(text.bytes);
}

static void random_texts_come_back_as_far_as_there_is_room(void **state)
{
	static const char bytes[] = "ab\"\\n{}:,\xc3\xa9";

	(void)state;
	for (uint64_t k = 0; k < 2000; k++) {
		char said[40], out[40], wanted[40];
		const size_t size = rb_random_bits(1, k, 0) % 20,
			     room = 1 + rb_random_bits(1, k, 1) % 30;
		struct text text;
		size_t used = 0;

		for (size_t i = 0; i < size; i++) {
			const uint64_t choice = rb_random_bits(2, k, i) % (sizeof bytes - 2);

			said[used++] = bytes[choice];
			if (bytes[choice] == '\xc3')
				said[used++] = '\xa9';
		}
		said[used] = '\0';
		memcpy(wanted, said, used + 1);
		wanted[room - 1 < used ? room - 1 : used] = '\0';
		open_text(&text);
		rb_json_text(&text.json, "said", said);
		rb_point_report_text(finish(&text), "said", out, room);
		assert_string_equal(out, wanted);
		free(text.bytes);
	}
}

static void expectations_are_counted_from_nought(void **state)
{
	struct text text;
	char out[80];

	(void)state;
	open_text(&text);
	rb_json_text(&text.json, "title", "{\"text\":\"not one\"}");
	rb_json_open(&text.json, "expectations", '[');
	for (int k = 0; k < 3; k++) {
		snprintf(out, sizeof out, "number %d, {\"text\":", k);
		rb_json_open(&text.json, NULL, '{');
		rb_json_text(&text.json, "text", out);
		rb_json_bool(&text.json, "ok", k == 1);
		rb_json_number(&text.json, "measured", k + 0.5);
		rb_json_close(&text.json, '}');
	}
	rb_json_close(&text.json, ']');
	const char *json = finish(&text);
	for (int k = 0; k < 3; k++) {
		const char *one = rb_point_report_expectation(json, k);
		char wanted[40];

		assert_non_null(one);
		rb_point_report_text(one, "text", out, sizeof out);
		snprintf(wanted, sizeof wanted, "number %d, {\"text\":", k);
		assert_string_equal(out, wanted);
		assert_true(rb_point_report_number(one, "ok") == (k == 1));
		assert_true(rb_point_report_number(one, "measured") == k + 0.5);
	}
	assert_null(rb_point_report_expectation(json, 3));
	assert_null(rb_point_report_expectation("{\"a\":1}\n", 0));
	assert_null(rb_point_report_expectation("{\"expectations\":[]}\n", 0));
	free(text.bytes);
}

/* Files of a run that was killed: cut anywhere, read within what is there. */
static void what_is_cut_off_is_read_as_far_as_it_goes(void **state)
{
	static const char json[] = "{\"error\":\"so \\\"it\\\" went\",\"n\":25,\"ok\":true,"
				   "\"expectations\":[{\"text\":\"x\\\\\",\"ok\":false}]}\n";
	char out[40];

	(void)state;
	for (size_t size = 0; size < sizeof json; size++) {
		char *const cut = rb_memory_take(size + 1, 1); /* its end is watched */

		memcpy(cut, json, size);
		rb_point_report_text(cut, "error", out, sizeof out);
		assert_true(strlen(out) <= strlen("so \"it\" went"));
		const double n = rb_point_report_number(cut, "n");
		assert_true(isnan(n) || n == 2 || n == 25);
		(void)rb_point_report_number(cut, "ok");
		const char *one = rb_point_report_expectation(cut, 0);
		if (one)
			rb_point_report_text(one, "text", out, sizeof out);
		(void)rb_point_report_expectation(cut, 1);
		rb_memory_free(cut);
	}
	rb_point_report_text(json, "error", out, 1);
	assert_string_equal(out, "");
}

static void members_are_found_whatever_they_are_called(void **state)
{
	static const char json[] =
		"{\"time\":3,\"expectations\":[{\"text\":\"\\\"results\\\":{\"}],"
		"\"results\":{\"probes\":{\"value\":1,\"unit\":\"}\"},"
		"\"a \\\"}\\\" b\":{\"value\":null,\"unit\":\"m\"}},"
		"\"probes\":{\"time\":{\"last\":-2.5,\"unit\":\"\"}},\"films\":[]}";
	char name[32];
	(void)state;

	const char *at = rb_point_report_member(json, "results", NULL, name, sizeof name);
	assert_non_null(at);
	assert_string_equal(name, "probes");
	assert_true(rb_point_report_number(at, "value") == 1);
	at = rb_point_report_member(json, "results", at, name, sizeof name);
	assert_non_null(at);
	assert_string_equal(name, "a \"}\" b");
	assert_true(isnan(rb_point_report_number(at, "value")));
	assert_null(rb_point_report_member(json, "results", at, name, sizeof name));
	at = rb_point_report_member(json, "probes", NULL, name, sizeof name);
	assert_non_null(at);
	assert_string_equal(name, "time");
	assert_true(rb_point_report_number(at, "last") == -2.5);
	assert_null(rb_point_report_member(json, "probes", at, name, sizeof name));
}

static void what_is_cut_off_has_no_more_members(void **state)
{
	static const char json[] =
		"{\"results\":{\"first\":{\"value\":1},\"second\":{\"value\":2}}}";
	char part[sizeof json], name[16];
	(void)state;

	for (size_t size = 0; size < sizeof json; size++) {
		int count = 0;
		memcpy(part, json, size);
		part[size] = '\0';
		for (const char *at = NULL;
		     (at = rb_point_report_member(part, "results", at, name, sizeof name)) != NULL;)
			count++;
		assert_true(count <= 2 &&
		            (count == 2) == (size >= strlen("{\"results\":{\"first\":{"
		                                            "\"value\":1},\"second\":{")));
	}
	assert_null(rb_point_report_member("{\"results\":{}}", "results", NULL, name, sizeof name));
	assert_null(rb_point_report_member("{}", "results", NULL, name, sizeof name));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_json_has_written_is_read_back),
		cmocka_unit_test(keys_within_texts_are_not_found),
		cmocka_unit_test(random_texts_come_back_as_far_as_there_is_room),
		cmocka_unit_test(expectations_are_counted_from_nought),
		cmocka_unit_test(what_is_cut_off_is_read_as_far_as_it_goes),
		cmocka_unit_test(members_are_found_whatever_they_are_called),
		cmocka_unit_test(what_is_cut_off_has_no_more_members),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
