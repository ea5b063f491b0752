/* SPDX-License-Identifier: MIT */
/* src/app/options.c, src/app/help.c, src/app/json.c, and the line of src/app/progress.c */
#include "support.h"

#include "app/help.h"
#include "app/json.h"
#include "app/options.h"
#include "app/progress.h"
#include "base/memory.h"

enum { WORDS_MAX = 16 };

/* Parses "run a.lua -q", words parted by spaces; the texts live in `line`. */
static enum rb_status parse(struct rb_options *options, char *line, struct rb_error *err)
{
	static char *argv[WORDS_MAX + 2];
	int argc = 1;

	argv[0] = line; /* not looked at */
	for (char *word = strtok(line, " "); word && argc < WORDS_MAX; word = strtok(NULL, " "))
		argv[argc++] = word;
	argv[argc] = NULL;
	return rb_options_parse(options, argc, argv, err);
}

static struct rb_options right(const char *text)
{
	static char line[512];
	struct rb_options options;
	struct rb_error err;

	snprintf(line, sizeof line, "%s", text);
	if (parse(&options, line, &err) != RB_OK)
		fail_msg("'%s': %s", text, err.text);
	return options;
}

static void assert_wrong(const char *text, const char *message)
{
	char line[512];
	struct rb_options options;
	struct rb_error err;

	snprintf(line, sizeof line, "%s", text);
	if (parse(&options, line, &err) != RB_ERR_USAGE)
		fail_msg("'%s' was accepted", text);
	if (!strstr(err.text, message))
		fail_msg("'%s': said \"%s\", wanted \"%s\"", text, err.text, message);
	rb_options_release(&options);
}

static void a_scene_alone_is_run(void **state)
{
	struct rb_options options = right("scene.lua");

	(void)state;
	assert_int_equal(options.verb, RB_VERB_RUN);
	assert_false(options.verb_given);
	assert_string_equal(options.operand[0], "scene.lua");
	assert_true(isnan(options.duration_s));
	assert_null(options.output);
	assert_int_equal(options.threads, 0);
	rb_options_release(&options);
}

static void options_may_stand_anywhere_and_in_every_form(void **state)
{
	struct rb_options options = right("-qo a.h5 --param e=0.5 run --duration=2.5e1 scene.lua "
	                                  "-p name= --seed 7 --threads=3 --rollback global");

	(void)state;
	assert_true(options.verb_given);
	assert_true(options.quiet);
	assert_string_equal(options.output, "a.h5");
	assert_int_equal(options.param_count, 2);
	assert_string_equal(options.params[0], "e=0.5");
	assert_string_equal(options.params[1], "name=");
	assert_near(options.duration_s, 25, 0);
	assert_true(options.has_seed);
	assert_int_equal(options.seed, 7);
	assert_int_equal(options.threads, 3);
	assert_string_equal(options.rollback, "global");
	rb_options_release(&options);

	options = right("-oa.h5 scene.lua");
	assert_string_equal(options.output, "a.h5");
	rb_options_release(&options);
}

static void two_dashes_end_options_and_verbs(void **state)
{
	struct rb_options options = right("-q -- --odd.lua");

	(void)state;
	assert_string_equal(options.operand[0], "--odd.lua");
	rb_options_release(&options);
	options = right("-- check");
	assert_int_equal(options.verb, RB_VERB_RUN);
	assert_string_equal(options.operand[0], "check");
	rb_options_release(&options);
}

static void help_and_version_excuse_missing_operands(void **state)
{
	struct rb_options options = right("--help");

	(void)state;
	assert_true(options.help);
	rb_options_release(&options);
	options = right("diff -h");
	assert_int_equal(options.verb, RB_VERB_DIFF);
	rb_options_release(&options);
	options = right("-V");
	assert_true(options.version);
	rb_options_release(&options);
}

static void a_number_is_read_whole_finite_and_in_range(void **state)
{
	(void)state;
	assert_wrong("s.lua --duration 1x", "'1x' is not a finite number above 0");
	assert_wrong("render r.h5 --fps 1e15", "'1e15' is not a number above 0, at most 1000000");
	assert_wrong("s.lua --duration 0", "above 0");
	assert_wrong("s.lua --duration -1", "above 0");
	assert_wrong("s.lua --duration nan", "finite");
	assert_wrong("s.lua --duration inf", "finite");
	assert_wrong("s.lua --duration 1e999", "finite");
	assert_wrong("s.lua --duration=", "finite");
	assert_wrong("s.lua --time-step -3", "'-3'");
	assert_wrong("s.lua --threads 0", "whole number from 1 to 1024");
	assert_wrong("s.lua --threads 1.5", "whole number");
	assert_wrong("s.lua --threads 99999999999999999999", "whole number");
	assert_wrong("s.lua --seed -1", "from 0 to 9223372036854775807");
	assert_wrong("s.lua --seed 9223372036854775808", "whole number");
	assert_wrong("s.lua --seed 0x10", "whole number");
}

static void what_is_not_known_gets_the_nearest_name(void **state)
{
	(void)state;
	assert_wrong("s.lua --durration 1",
	             "unknown option '--durration' (did you mean '--duration'?)");
	assert_wrong("s.lua --xyzzyxyzzy",
	             "unknown option '--xyzzyxyzzy' (parameters of scenes are given "
	             "by --param NAME=VALUE)");
	assert_wrong("info a.h5 --xyzzyxyzzy", "unknown option '--xyzzyxyzzy'");
	assert_wrong("s.lua -z", "unknown option '-z'");
	assert_wrong("chekc s.lua", "unknown verb 'chekc' (did you mean 'check'?)");
	assert_wrong("s.lua --method clasic", "is not one of: auto, classic, located");
}

static void what_follows_the_socket_is_a_command(void **state)
{
	struct rb_options options = right("ctl -q s.sock camera move 1 -2 --json");

	(void)state;
	assert_int_equal(options.verb, RB_VERB_CTL);
	assert_true(options.quiet);
	assert_false(options.json);
	assert_int_equal(options.word_count, 6);
	assert_string_equal(options.words[0], "s.sock");
	assert_string_equal(options.words[4], "-2");
	rb_options_release(&options);
	assert_wrong("ctl", "'ctl' needs SOCKET COMMAND");
	assert_wrong("ctl s.sock", "'ctl' needs SOCKET COMMAND");
	options = right("s.lua --listen s.sock --commands -");
	assert_string_equal(options.listen, "s.sock");
	assert_string_equal(options.commands, "-");
	rb_options_release(&options);
	assert_wrong("check s.lua --listen s.sock", "does not belong to 'check'");
}

static void a_command_line_that_makes_no_sense_is_refused(void **state)
{
	(void)state;
	assert_wrong("", "'run' needs SCENE.lua");
	assert_wrong("diff a.h5", "two files");
	assert_wrong("diff a.h5 b.h5 c.h5", "unexpected operand 'c.h5'");
	assert_wrong("methods more", "unexpected operand 'more'");
	assert_wrong("s.lua -o", "needs a FILE");
	assert_wrong("s.lua --output=", "not empty");
	assert_wrong("s.lua --quiet=1", "takes no value");
	assert_wrong("s.lua --param e", "not of the form NAME=VALUE");
	assert_wrong("s.lua --param =3", "not of the form");
	assert_wrong("info a.h5 --seed 3", "option '--seed' does not belong to 'info'");
	assert_wrong("s.lua -o a.h5 --no-record", "contradicts");
}

static void every_option_stands_in_the_help_of_its_verbs(void **state)
{
	(void)state;
	for (int verb = 0; verb < RB_VERB_COUNT; verb++) {
		const struct rb_options options = {.verb = (enum rb_verb)verb, .verb_given = true};
		static char text[16384];
		FILE *file = fmemopen(text, sizeof text, "w");

		rb_help_print(file, &options);
		assert_int_equal(fclose(file), 0);
		assert_true(strstr(text, "Examples:") < strstr(text, "Options:"));
		for (int i = 0; i < rb_option_row_count; i++) {
			const struct rb_option_row *row = &rb_option_rows[i];
			char wanted[96];
			snprintf(wanted, sizeof wanted, "--%s%s%s ", row->name,
			         row->argument ? " " : "", row->argument ? row->argument : "");
			/* two rows may look the same there where no verb has both */
			bool shown = false;
			for (int k = 0; k < rb_option_row_count; k++) {
				const struct rb_option_row *other = &rb_option_rows[k];
				const bool same = strcmp(other->name, row->name) == 0 &&
				                  !other->argument == !row->argument &&
				                  (!row->argument ||
				                   strcmp(other->argument, row->argument) == 0);
				shown |= same && other->help && other->verbs & 1u << verb;
			}
			assert_true((strstr(text, wanted) != NULL) == shown);
		}
	}
}

static void a_failed_allocation_is_told(void **state)
{
	char line[] = "s.lua", *argv[] = {line, line, NULL};
	struct rb_options options;
	struct rb_error err;

	(void)state;
	rb_memory_fail_at(1);
	assert_int_equal(rb_options_parse(&options, 2, argv, &err), RB_ERR_MEMORY);
	rb_memory_fail_at(0);
	rb_options_release(&options);
}

static void json_escapes_what_must_not_stand_in_it(void **state)
{
	char text[512] = "";
	FILE *file = fmemopen(text, sizeof text, "w");
	struct rb_json json = {.file = file};

	(void)state;
	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "a", "q\" b\\ n\n e\033 \xc3\xa9 bad\xff\xc3");
	rb_json_number(&json, "b", (double)NAN);
	rb_json_number(&json, "c", 0.1);
	rb_json_open(&json, "d", '[');
	rb_json_bool(&json, NULL, true);
	rb_json_text(&json, NULL, NULL);
	rb_json_close(&json, ']');
	rb_json_open(&json, "e", '{');
	rb_json_close(&json, '}');
	rb_json_vector(&json, "f", (const double[]){1, -HUGE_VAL}, 2);
	rb_json_close(&json, '}');
	fclose(file);
	assert_string_equal(
		text, "{\"a\":\"q\\\" b\\\\ n\\n e\\u001b \xc3\xa9 bad\\ufffd\\ufffd\",\"b\":null,"
		      "\"c\":0.10000000000000001,\"d\":[true,null],\"e\":{},\"f\":[1,null]}");
}

static void a_progress_line_fits_its_terminal(void **state)
{
	(void)state;
	for (int width = 1; width < 200; width++) {
		char line[256];
		rb_progress_line(line, sizeof line, width,
		                 &(struct rb_progress_now){123.456, 1000, 7200, 51120});
		assert_true((int)strlen(line) <= width);
	}
	char line[256];
	rb_progress_line(line, sizeof line, 100, &(struct rb_progress_now){5, 10, 2, 2});
	assert_non_null(strstr(line, " 50 % [========"));
	assert_non_null(strstr(line, "5 of 10 s"));
	assert_non_null(strstr(line, "2.5 x real time"));
	assert_non_null(strstr(line, "2.0 s left"));
	rb_progress_line(line, sizeof line, 30, &(struct rb_progress_now){5, 10, 2, 2});
	assert_non_null(strstr(line, " 50 %"));
	rb_progress_line(line, sizeof line, 100,
	                 &(struct rb_progress_now){9.9999, 10, 2, (double)NAN});
	assert_null(strstr(line, "left"));
	assert_non_null(strstr(line, " 99 %"));
}

static void short_durations_are_not_told_as_none(void **state)
{
	static const struct {
		double seconds;
		const char *text;
	} cases[] = {{0, "0.0 s"},    {1e-9, "1 ms"},  {0.0123, "13 ms"}, {0.0499, "50 ms"},
	             {0.05, "0.1 s"}, {9.94, "9.9 s"}, {59, "59 s"},      {3599, "59:59 min"}};

	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		char text[32];

		rb_progress_duration(text, sizeof text, cases[k].seconds);
		assert_string_equal(text, cases[k].text);
	}
}

/* A run that takes a second for each tenth, and from the middle on ten. */
static void what_is_left_follows_the_latest_pace(void **state)
{
	struct rb_pace_window window = {0};
	double left_s = 0;

	(void)state;
	assert_true(isnan(rb_progress_left(&window, 0, 1, 0)));
	for (int k = 1; k <= 50; k++)
		left_s = rb_progress_left(&window, 0.01 * k, 1, 0.1 * k);
	assert_near(left_s, 5, 1e-9);
	for (int k = 1; k <= 25; k++)
		left_s = rb_progress_left(&window, 0.5 + 0.01 * k, 1, 5 + k);
	/* by the mean of the run it would be 10 */
	assert_near(left_s, 25, 1e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scene_alone_is_run),
		cmocka_unit_test(what_is_left_follows_the_latest_pace),
		cmocka_unit_test(short_durations_are_not_told_as_none),
		cmocka_unit_test(options_may_stand_anywhere_and_in_every_form),
		cmocka_unit_test(two_dashes_end_options_and_verbs),
		cmocka_unit_test(help_and_version_excuse_missing_operands),
		cmocka_unit_test(a_number_is_read_whole_finite_and_in_range),
		cmocka_unit_test(what_is_not_known_gets_the_nearest_name),
		cmocka_unit_test(what_follows_the_socket_is_a_command),
		cmocka_unit_test(a_command_line_that_makes_no_sense_is_refused),
		cmocka_unit_test(every_option_stands_in_the_help_of_its_verbs),
		cmocka_unit_test(a_failed_allocation_is_told),
		cmocka_unit_test(json_escapes_what_must_not_stand_in_it),
		cmocka_unit_test(a_progress_line_fits_its_terminal),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
