/* SPDX-License-Identifier: MIT */
/* src/control/command.c */
#include "support.h"

#include "control/command.h"

static struct rb_command right(const char *line)
{
	struct rb_command command;
	struct rb_error err = {0};
	bool given;

	if (rb_command_parse(&command, &given, line, &err) != RB_OK || !given)
		fail_msg("'%s': %s", line, err.text);
	return command;
}

static void assert_wrong(const char *line, const char *message)
{
	struct rb_command command;
	struct rb_error err = {0};
	bool given = true;

	if (rb_command_parse(&command, &given, line, &err) != RB_ERR_USAGE || given)
		fail_msg("'%s' was accepted", line);
	if (!strstr(err.text, message))
		fail_msg("'%s': said \"%s\", wanted \"%s\"", line, err.text, message);
	if (strchr(err.text, '\n'))
		fail_msg("'%s': more than one line", line);
}

static void every_row_is_complete_and_every_command_is_known_by_its_name(void **state)
{
	(void)state;
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		const struct rb_command_row *row = &rb_commands[i];
		assert_non_null(row->name);
		assert_non_null(row->arguments);
		assert_true(strlen(row->help) > 3);
		if (*row->arguments == '\0')
			assert_int_equal(right(row->name).kind, i);
	}
}

static void counts_are_whole_numbers_and_one_by_default(void **state)
{
	(void)state;
	assert_near(right("step").number, 1, 0);
	assert_near(right("back 12").number, 12, 0);
	assert_int_equal(right("\t step  12 ").kind, RB_COMMAND_STEP);
	assert_wrong("step 0", "whole number from 1");
	assert_wrong("step -1", "'-1'");
	assert_wrong("step 1.5", "'1.5'");
	assert_wrong("step 1e3", "'1e3'");
	assert_wrong("step 9999999999999999999999", "whole number");
	assert_wrong("step 1 2", "unexpected '2' (usage: step [N])");
}

static void times_are_seconds_or_percentages(void **state)
{
	(void)state;
	assert_near(right("seek 1.25").number, 1.25, 0);
	assert_false(right("seek 1.25").is_percent);
	assert_near(right("seek 50%").number, 50, 0);
	assert_true(right("seek 50%").is_percent);
	assert_wrong("seek", "needs a time in seconds");
	assert_wrong("seek 101%", "'101%'");
	assert_wrong("seek -1", "'-1'");
	assert_wrong("seek nan", "'nan'");
	assert_wrong("seek inf", "'inf'");
	assert_wrong("seek 0x10", "'0x10'");
	assert_wrong("seek %", "'%'");
	assert_wrong("speed 0", "number above 0");
	assert_wrong("speed 1e999", "number above 0");
	assert_near(right("speed 0.25").number, 0.25, 0);
}

static void fixed_words_stand_where_they_must(void **state)
{
	(void)state;
	assert_true(right("stop at collision").is_on);
	assert_true(right("stop at collision on").is_on);
	assert_false(right("stop at collision off").is_on);
	assert_wrong("stop", "'at collision on'");
	assert_wrong("stop at", "'collision'");
	assert_wrong("stop at collision maybe", "'on' or 'off'");
	assert_int_equal(right("next collision").kind, RB_COMMAND_NEXT);
	assert_int_equal(right("previous").kind, RB_COMMAND_PREVIOUS);
	assert_wrong("next frame", "'frame'");
	assert_true(right("film on").is_on);
	assert_wrong("film", "'on', 'off', or move, orbit or zoom after a camera's name");
	assert_wrong("film main", "'on', 'off', or move");
	assert_wrong("film main turn", "move, orbit or zoom");
	assert_wrong("film zoom -1", "a number above 0");
	assert_string_equal(right("film main move 1 2 3").text, "main");
	assert_string_equal(right("film orbit 90 0").text, "");
	assert_true(right("film orbit 90 0").moves);
	assert_false(right("film off").moves);
	assert_false(right("view pause").is_on);
	assert_true(right("view play").is_on);
}

static void cameras_have_names_or_are_moved(void **state)
{
	struct rb_command command = right("camera move 1 -2 3e-1");

	(void)state;
	assert_int_equal(command.action, RB_CAMERA_MOVE);
	assert_near(command.vector[1], -2, 0);
	assert_near(command.vector[2], 0.3, 0);
	command = right("camera orbit 90 -45");
	assert_int_equal(command.action, RB_CAMERA_ORBIT);
	assert_near(command.vector[0], 1.5707963267948966, 1e-15);
	assert_near(command.vector[1], -0.7853981633974483, 1e-15);
	assert_near(right("camera zoom 2").number, 2, 0);
	assert_int_equal(right("camera mount ball").action, RB_CAMERA_MOUNT);
	assert_string_equal(right("camera mount").text, "");
	assert_int_equal(right("camera all").action, RB_CAMERA_ALL);
	assert_string_equal(right("camera main").text, "main");
	/* a camera may be called as an action is, in quotes */
	assert_int_equal(right("camera \"move\"").action, RB_CAMERA_NAMED);
	assert_wrong("camera", "the name of a camera");
	assert_wrong("camera move 1 2", "three numbers");
	assert_wrong("camera zoom -1", "above 0");
	assert_wrong("camera orbit 1 2 3", "unexpected '3'");
}

static void words_in_quotes_hold_spaces(void **state)
{
	const struct rb_command command = right("set title \"two words\"");

	(void)state;
	assert_string_equal(command.text, "title");
	assert_string_equal(command.value, "two words");
	assert_string_equal(right("set e \"\"").value, "");
	assert_string_equal(right("body \"left ball\"").text, "left ball");
	assert_wrong("body \"left", "no quote at its end");
	assert_wrong("body \"left\"ball", "wanted a space");
	assert_wrong("body \"\"", "the name of a body");
	assert_wrong("set e", "needs a value");
	assert_wrong("set e=1", "a parameter and a value");
	assert_wrong("\"play\"", "unknown command");
}

static void nothing_and_comments_are_no_commands(void **state)
{
	static const char *const lines[] = {"", "   ", "\t", "# play", "  # play"};
	struct rb_command command;
	bool given = true;

	(void)state;
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++, given = true) {
		assert_int_equal(rb_command_parse(&command, &given, lines[i], NULL), RB_OK);
		assert_false(given);
	}
}

static void unknown_commands_are_told_with_the_nearest_name(void **state)
{
	(void)state;
	assert_wrong("paus", "'paus' (did you mean 'pause'?)");
	assert_wrong("xyzzy", "help lists them");
	assert_wrong("help xyzzy", "unknown command 'xyzzy'");
	assert_wrong("play now", "'play': unexpected 'now' (usage: play)");
}

static void no_byte_is_trusted(void **state)
{
	char line[RB_COMMAND_LINE_SIZE + 400];

	(void)state;
	assert_wrong("body \x1b[31m", "0x1b");
	assert_wrong("body \x7f", "0x7f");
	assert_wrong("body \xff", "0xff");
	assert_wrong("body \xc0\xaf", "0xc0");         /* overlong */
	assert_wrong("body \xed\xa0\x80", "0xed");     /* a surrogate */
	assert_wrong("body \xf4\x90\x80\x80", "0xf4"); /* beyond U+10FFFF */
	assert_wrong("body \xc2\x9b", "0xc2"); /* a control character of one byte elsewhere */
	assert_wrong("body \xe2\x82", "0xe2"); /* cut */
	assert_string_equal(right("body \xc3\xa9\xe2\x82\xac\xf0\x9f\x8e\xb1").text,
	                    "\xc3\xa9\xe2\x82\xac\xf0\x9f\x8e\xb1");
	memset(line, 'a', sizeof line);
	line[sizeof line - 1] = '\0';
	assert_wrong(line, "longer than 1024 bytes");
	line[600] = '\0';
	assert_wrong(line, "a word of more than");
	line[RB_COMMAND_TEXT_SIZE - 1] = '\0';
	assert_wrong(line, "unknown command");
	assert_wrong("set a b c d e f g h", "one word too many");
}

static const char *name_of(void *user, enum rb_command_kind kind, int index)
{
	static const char *const bodies[] = {"ball", "bat", "floor"}, *const cameras[] = {"main"};

	(void)user;
	if (kind == RB_COMMAND_CAMERA)
		return index < 1 ? cameras[index] : NULL;
	return index < 3 ? bodies[index] : NULL;
}

/* Candidates for a line as one text. */
static const char *completed(const char *line, char out[512])
{
	const struct rb_command_names names = {.name = name_of};
	const char *found[32];
	const int count = rb_command_complete(line, &names, found, 32);
	int used = 0;

	out[0] = '\0';
	for (int i = 0; i < count; i++)
		used += snprintf(out + used, 512 - (size_t)used, "%s%s", i ? " " : "", found[i]);
	return out;
}

static void lines_that_are_typed_are_continued(void **state)
{
	char out[512];
	const char *one[1];

	(void)state;
	assert_string_equal(completed("pl", out), "play");
	assert_string_equal(completed("s", out), "step seek speed stop snapshot set status");
	assert_string_equal(completed("follow ba", out), "ball bat");
	assert_string_equal(completed("follow \"ba", out), "ball bat");
	assert_string_equal(completed("camera m", out), "move mount main");
	assert_string_equal(completed("camera mount f", out), "floor");
	assert_string_equal(completed("stop at ", out), "collision");
	assert_string_equal(completed("stop at collision o", out), "on off");
	assert_string_equal(completed("help sta", out), "status");
	assert_string_equal(completed("play ", out), "");
	assert_string_equal(completed("nonsense ", out), "");
	assert_int_equal(rb_command_complete("s", NULL, one, 1), 1);
	assert_int_equal(rb_command_complete("follow ", NULL, one, 1), 0);
}

static void help_and_manual_have_every_command(void **state)
{
	static char text[16384];
	FILE *file = fmemopen(text, sizeof text, "w");

	(void)state;
	assert_non_null(file);
	rb_command_print_help(file, NULL);
	rb_command_print_manual(file);
	fclose(file);
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		char line[64];
		snprintf(line, sizeof line, ".It Ic %s", rb_commands[i].name);
		assert_non_null(strstr(text, line));
		assert_non_null(strstr(text, rb_commands[i].help));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_row_is_complete_and_every_command_is_known_by_its_name),
		cmocka_unit_test(counts_are_whole_numbers_and_one_by_default),
		cmocka_unit_test(times_are_seconds_or_percentages),
		cmocka_unit_test(fixed_words_stand_where_they_must),
		cmocka_unit_test(cameras_have_names_or_are_moved),
		cmocka_unit_test(words_in_quotes_hold_spaces),
		cmocka_unit_test(nothing_and_comments_are_no_commands),
		cmocka_unit_test(unknown_commands_are_told_with_the_nearest_name),
		cmocka_unit_test(no_byte_is_trusted),
		cmocka_unit_test(lines_that_are_typed_are_continued),
		cmocka_unit_test(help_and_manual_have_every_command),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
