/* SPDX-License-Identifier: MIT */
/* src/control/keys.c: what each key stands for is there */
#include "support.h"

#include "control/command.h"
#include "control/keys.h"

static void every_key_is_found_and_none_twice(void **state)
{
	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *row = &rb_key_rows[i];

		assert_ptr_equal(rb_key_find(row->key), row);
		assert_true(*row->name && *row->help);
		assert_non_null(row->line);
		/* a character is told by itself, but for blanks and control characters */
		if (row->key > ' ' && row->key < 0x7f) {
			assert_int_equal(strlen(row->name), 1);
			assert_int_equal(*row->name, row->key);
		} else {
			assert_true(strlen(row->name) > 1);
		}
		for (int k = 0; k < i; k++)
			assert_string_not_equal(row->name, rb_key_rows[k].name);
	}
	assert_null(rb_key_find(0));
	assert_null(rb_key_find('z'));
	assert_null(rb_key_find(0x20ac));
	assert_null(rb_key_find(RB_KEY_MOUSE));
	assert_null(rb_key_find(UINT32_MAX));
}

static void lines_that_run_are_commands(void **state)
{
	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *row = &rb_key_rows[i];
		struct rb_command command;
		struct rb_error err;
		bool given = false;

		if (row->action != RB_KEY_RUNS)
			continue;
		if (rb_command_parse(&command, &given, row->line, &err) != RB_OK)
			fail_msg("'%s': '%s': %s", row->name, row->line, err.text);
		assert_true(given);
	}
}

/* What is typed behind them makes a command. */
static void lines_that_are_typed_on_begin_commands(void **state)
{
	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *row = &rb_key_rows[i];
		struct rb_command command;
		struct rb_error err;
		char line[80];
		bool given = false;

		if (row->action != RB_KEY_TYPES || !*row->line)
			continue;
		assert_int_equal(row->line[strlen(row->line) - 1], ' ');
		snprintf(line, sizeof line, "%s50%%", row->line);
		assert_int_equal(rb_command_parse(&command, &given, line, &err), RB_OK);
		assert_true(given);
	}
}

static void seeks_go_both_ways_and_speeds_undo_each_other(void **state)
{
	double sum = 0, product = 1;
	int seeks = 0, speeds = 0;

	(void)state;
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *row = &rb_key_rows[i];
		char *end;

		if (row->action != RB_KEY_SEEKS && row->action != RB_KEY_SCALES)
			continue;
		const double number = strtod(row->line, &end);
		assert_true(end != row->line && *end == '\0');
		if (row->action == RB_KEY_SEEKS) {
			assert_true(number != 0 && fabs(number) <= 100);
			sum += number;
			seeks++;
		} else {
			assert_true(number > 0 && number != 1);
			product *= number;
			speeds++;
		}
	}
	assert_true(seeks == 4 && speeds == 2);
	assert_near(sum, 0, 0);
	assert_near(product, 1, 0);
	assert_true(strtod(rb_key_find(RB_KEY_RIGHT)->line, NULL) > 0);
	assert_true(strtod(rb_key_find(RB_KEY_SHIFT_LEFT)->line, NULL) <
	            strtod(rb_key_find(RB_KEY_LEFT)->line, NULL));
}

static struct rb_command command_of(uint32_t key)
{
	struct rb_command command;
	struct rb_error err;
	bool given;

	assert_ok(rb_command_parse(&command, &given, rb_key_find(key)->line, &err));
	return command;
}

static void keys_do_what_their_places_say(void **state)
{
	(void)state;
	assert_int_equal(command_of(' ').kind, RB_COMMAND_TOGGLE);
	assert_int_equal(command_of('.').kind, RB_COMMAND_STEP);
	assert_int_equal(command_of(',').kind, RB_COMMAND_BACK);
	assert_int_equal(command_of('q').kind, RB_COMMAND_QUIT);
	assert_true(command_of('1').kind == RB_COMMAND_SPEED && command_of('1').number == 1);
	assert_true(command_of(RB_KEY_HOME).kind == RB_COMMAND_SEEK &&
	            command_of(RB_KEY_HOME).number == 0);
	/* h and l, k and j: as far in one direction as in the other */
	assert_true(command_of('h').vector[0] < 0 && command_of('k').vector[1] > 0);
	assert_near(command_of('h').vector[0] + command_of('l').vector[0], 0, 0);
	assert_near(command_of('k').vector[1] + command_of('j').vector[1], 0, 0);
	assert_near(command_of('+').number * command_of('-').number, 1, 1e-15);
	assert_true(command_of('+').number > 1);
}

static void the_manual_has_every_key(void **state)
{
	char *text = NULL, line[80];
	size_t size;
	int items = 0;
	FILE *file = open_memstream(&text, &size);

	(void)state;
	assert_non_null(file);
	rb_keys_print_manual(file);
	fclose(file);
	for (const char *at = text; (at = strstr(at, "\n.It ")); at++)
		items++;
	assert_int_equal(items, rb_key_row_count);
	for (int i = 0; i < rb_key_row_count; i++) {
		/* a full stop or a quote must not be taken for a request */
		snprintf(line, sizeof line, "\n.It Li \\&%s\n", rb_key_rows[i].name);
		assert_non_null(strstr(text, line));
		assert_non_null(strstr(text, rb_key_rows[i].help + 1));
	}
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_key_is_found_and_none_twice),
		cmocka_unit_test(lines_that_run_are_commands),
		cmocka_unit_test(lines_that_are_typed_on_begin_commands),
		cmocka_unit_test(seeks_go_both_ways_and_speeds_undo_each_other),
		cmocka_unit_test(keys_do_what_their_places_say),
		cmocka_unit_test(the_manual_has_every_key),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
