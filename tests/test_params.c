/* SPDX-License-Identifier: MIT */
/* src/script/params.c: parameters of scenes, from the command line and while a run goes on */
#include "loaded.h"

#include <rbsim/model.h>

#include "math/random.h"
#include "script/load.h"
#include "script/params.h"

static void must_load_with(struct loaded *it, const char *text, const char *param)
{
	const char *const params[4] = {param};

	load_with(it, text, params);
	if (it->status != RB_OK)
		fail_msg("'%s' with '%s': %s", text, param ? param : "", it->err.text);
}

/* One mistake, with that status and text. */
static void assert_wrong(const char *text, const char *param, enum rb_status status,
                         const char *part)
{
	const char *const params[4] = {param};
	struct loaded it;

	load_with(&it, text, params);
	assert_int_equal(it.status, status);
	assert_int_equal(it.mistakes.count, 1);
	if (!strstr(it.mistakes.line[0], part))
		fail_msg("'%s' with '%s': '%s' has no '%s'", text, param ? param : "",
		         it.mistakes.line[0], part);
	unload(&it);
}

static void a_value_of_the_command_line_takes_the_place_of_the_default(void **state)
{
	static const struct {
		const char *declared, *given, *check;
		enum rb_param_type type;
		const char *default_text, *value_text;
		double value;
	} cases[] = {
		{"2", "p=5", "p == 5 and math.type(p) == 'integer'", RB_PARAM_INTEGER, "2", "5", 5},
		{"2", "p=1e3", "p == 1000 and math.type(p) == 'integer'", RB_PARAM_INTEGER, "2",
	         "1000", 1000},
		{"2", "p= 0x10 ", "p == 16", RB_PARAM_INTEGER, "2", "16", 16},
		{"2", NULL, "p == 2", RB_PARAM_INTEGER, "2", "2", 2},
		{"2.0", "p=5", "p == 5 and math.type(p) == 'float'", RB_PARAM_NUMBER, "2", "5", 5},
		{"0.1", "p=0.3", "p == 0.3", RB_PARAM_NUMBER, "0.1", "0.3", 0.3},
		{"0.1", "p=-1e-300", "p == -1e-300", RB_PARAM_NUMBER, "0.1", "-1e-300", -1e-300},
		{"true", "p=false", "p == false", RB_PARAM_BOOLEAN, "true", "false", 0},
		{"false", "p=true", "p == true", RB_PARAM_BOOLEAN, "false", "true", 1},
		{"'up'", "p=down", "p == 'down'", RB_PARAM_TEXT, "up", "down", 0},
		{"'up'", "p=", "p == ''", RB_PARAM_TEXT, "up", "", 0},
		{"'up'", "p=a=b", "p == 'a=b'", RB_PARAM_TEXT, "up", "a=b", 0},
		{"'up'", "p=7", "p == '7'", RB_PARAM_TEXT, "up", "7", 7},
	};
	struct loaded it;
	char text[200];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, "local p = param('p', %s, 'help') assert(%s)",
		         cases[i].declared, cases[i].check);
		must_load_with(&it, text, cases[i].given);
		assert_int_equal(it.scene.param_count, 1);
		const struct rb_param_def *def = &it.scene.params[0];
		assert_string_equal(def->name, "p");
		assert_string_equal(def->help, "help");
		assert_int_equal(def->type, cases[i].type);
		assert_string_equal(def->default_text, cases[i].default_text);
		assert_string_equal(def->value_text, cases[i].value_text);
		if (def->type != RB_PARAM_TEXT)
			assert_near(def->value, cases[i].value, 0);
		assert_true(isnan(def->min) && isnan(def->max) && !def->choices);
		unload(&it);
	}
}

static void what_cannot_be_its_value_is_a_mistake_of_the_command_line(void **state)
{
	static const struct {
		const char *declared, *given, *part;
	} cases[] = {
		{"2", "p=x", "--param p: must be a whole number (got 'x')"},
		{"2", "p=2.5", "as its default 2 is one (write 2.0 in the scene for any number)"},
		{"2", "p=", "must be a whole number (got '')"},
		{"2.5", "p=nan", "must be a number (got 'nan')"},
		{"2.5", "p=1e999", "must be a number (got '1e999')"},
		{"2.5", "p=1,5", "must be a number (got '1,5')"},
		{"true", "p=1", "must be true or false (got '1')"},
		{"true", "p=True", "must be true or false"},
		{"2, '', {min = 1, max = 3}", "p=4", "must be in [1, 3] (got '4')"},
		{"2, '', {min = 1}", "p=0", "must be at least 1 (got '0')"},
		{"2.5, '', {max = 3}", "p=3.5", "must be at most 3 (got '3.5')"},
		{"'a', '', {choices = {'a', 'b'}}", "p=c", "must be one of a, b (got 'c')"},
		{"1, '', {choices = {1, 2, 4}}", "p=3", "must be one of 1, 2, 4 (got '3')"},
		{"2", "q=1", "--param q: the scene has no such parameter"},
		{"2", "p", "--param 'p': expected NAME=VALUE"},
		{"2", "=1", "--param '': expected NAME=VALUE"},
	};
	char text[200];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, "param('p', %s)", cases[i].declared);
		assert_wrong(text, cases[i].given, RB_ERR_USAGE, cases[i].part);
	}
	assert_wrong("param('radius', 1)", "radios=2", RB_ERR_USAGE, "(did you mean 'radius'?)");
	assert_wrong("", "p=1", RB_ERR_USAGE, "; it has none");
	/* a scene that did not come to its end may have declared it later */
	assert_wrong("error('first', 0) param('p', 1)", "p=2", RB_ERR_SCENE, "first");
}

static void of_two_values_the_last_holds(void **state)
{
	const char *const params[4] = {"p=1", "pp=7", "p=2"};
	struct loaded it;

	(void)state;
	load_with(&it, "assert(param('p', 0) == 2 and param('pp', 0) == 7)", params);
	assert_int_equal(it.status, RB_OK);
	unload(&it);
}

static void a_declaration_that_makes_no_sense_is_a_mistake_of_the_scene(void **state)
{
	static const char *const cases[][2] = {
		{"param()", "expected a name, a default, a help text (got nothing for the name)"},
		{"param('', 1)", "must not be empty nor hold '='"},
		{"param('a=b', 1)", "must not be empty nor hold '='"},
		{"param('a\\0b', 1)", "must not be empty"},
		{"param('p', {})", "param 'p': the default must be a number, a boolean or a text"},
		{"param('p', 0/0)", "the default must be finite (got nan)"},
		{"param('p', 1/0)", "the default must be finite (got inf)"},
		{"param('p', 'a\\0b')", "must not hold a zero byte"},
		{"param('p', 1, 5)", "the help must be a text (got 5)"},
		{"param('p', 1) param('p', 2)", "the parameter was declared before"},
		{"param('p', 'a', '', {min = 1})", "'min' and 'max' are for numbers"},
		{"param('p', 5, '', {max = 3})", "the default must be at most 3 (got 5)"},
		{"param('p', 5, '', {choices = {1, 2}})",
	         "the default must be one of 1, 2 (got 5)"},
		{"param('p', 5, '', {choices = {}})", "'choices' must be a list of numbers, texts"},
		{"param('p', 5, '', {choices = {5, {}}})", "'choices' must be a list"},
		{"param('p', 5, '', {choices = '5'})", "'choices' must be a list"},
		{"param('p', 5, '', {mini = 1})", "mini"},
		{"param('p', 5, '', 5)", "expected a table of keys"},
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_wrong(cases[i][0], NULL, RB_ERR_SCENE, cases[i][1]);
}

/* The shortest digits, and by them the same number. */
static void numbers_are_written_so_that_they_read_back(void **state)
{
	struct loaded it;
	char text[200], param[60];

	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const double x = ldexp(rb_random_unit(1, k, 0) - 0.5, (int)(k * 10) - 1000);

		snprintf(param, sizeof param, "p=%.17g", x);
		snprintf(text, sizeof text, "assert(param('p', 1.5) == %.17g)", x);
		must_load_with(&it, text, param);
		assert_true(strtod(it.scene.params[0].value_text, NULL) == x);
		assert_true(strlen(it.scene.params[0].value_text) <= strlen(param) - 2);
		assert_near(it.scene.params[0].value, x, 0);
		unload(&it);
	}
	must_load_with(&it, "param('p', 0.1)", NULL);
	assert_string_equal(it.scene.params[0].default_text, "0.1");
	unload(&it);
	must_load_with(&it, "param('p', math.mininteger)", NULL);
	assert_string_equal(it.scene.params[0].value_text, "-9223372036854775808");
	unload(&it);
}

/* What is allowed later is what was allowed at the start. */
static void a_value_is_checked_by_the_rules_of_the_command_line(void **state)
{
	static const struct {
		const char *name, *text, *part; /* NULL: it is right */
	} cases[] = {
		{"n", "3", NULL},
		{"n", "3.0", NULL},
		{"n", "3.5", "parameter 'n' must be a whole number, as its default 2 is one"},
		{"n", "11", "parameter 'n' must be in [0, 10] (got '11')"},
		{"n", "", "must be a whole number (got '')"},
		{"x", "1e-3", NULL},
		{"x", "inf", "parameter 'x' must be a number (got 'inf')"},
		{"b", "false", NULL},
		{"b", "0", "parameter 'b' must be true or false"},
		{"t", "anything at all", NULL},
		{"t", "", NULL},
		{"c", "up", NULL},
		{"c", "updown", NULL},
		{"c", "down", "parameter 'c' must be one of up, updown (got 'down')"},
		{"c", "u", "must be one of"},
		{"c", "p", "must be one of"},
		{"k", "2", NULL},
		{"k", "2.0", NULL},
		{"k", "3", "must be one of 1, 2, 12"},
		{"cc", "up", "the scene has no parameter 'cc'"},
		{"", "1", "the scene has no parameter ''; it has n, x, b, t, c, k"},
	};
	struct loaded it;

	(void)state;
	must_load_with(&it,
	               "param('n', 2, '', {min = 0, max = 10}) param('x', 0.5) param('b', true)\n"
	               "param('t', 'text') param('c', 'up', '', {choices = {'up', 'updown'}})\n"
	               "param('k', 1, '', {choices = {1, 2, 12}})",
	               NULL);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const enum rb_status status = rb_params_check_value(&it.scene, cases[i].name,
		                                                    cases[i].text, &it.err);

		if (!cases[i].part) {
			if (status != RB_OK)
				fail_msg("%s=%s: %s", cases[i].name, cases[i].text, it.err.text);
			continue;
		}
		assert_int_equal(status, RB_ERR_USAGE);
		if (!strstr(it.err.text, cases[i].part))
			fail_msg("%s=%s: '%s'", cases[i].name, cases[i].text, it.err.text);
	}
	/* without memory: told, and nothing is left */
	rb_memory_fail_at(1);
	const enum rb_status status = rb_params_check_value(&it.scene, "n", "3", &it.err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	unload(&it);
}

static void ten_names_are_told_and_the_others_are_counted(void **state)
{
	struct loaded it;

	(void)state;
	must_load_with(&it, "for i = 1, 13 do param(('x'):rep(60) .. i, i) end", NULL);
	assert_int_equal(rb_params_check_value(&it.scene, "no", "3", &it.err), RB_ERR_USAGE);
	assert_int_equal(it.scene.param_count, 13);
	unload(&it);
	must_load_with(&it, "for i = 1, 13 do param('p' .. i, i) end", NULL);
	assert_int_equal(rb_params_check_value(&it.scene, "zzz", "3", &it.err), RB_ERR_USAGE);
	assert_string_equal(it.err.text,
	                    "the scene has no parameter 'zzz'; it has p1, p2, p3, p4, p5, "
	                    "p6, p7, p8, p9, p10 and 3 more");
	unload(&it);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_value_of_the_command_line_takes_the_place_of_the_default),
		cmocka_unit_test(what_cannot_be_its_value_is_a_mistake_of_the_command_line),
		cmocka_unit_test(of_two_values_the_last_holds),
		cmocka_unit_test(a_declaration_that_makes_no_sense_is_a_mistake_of_the_scene),
		cmocka_unit_test(numbers_are_written_so_that_they_read_back),
		cmocka_unit_test(a_value_is_checked_by_the_rules_of_the_command_line),
		cmocka_unit_test(ten_names_are_told_and_the_others_are_counted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
