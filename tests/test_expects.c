/* SPDX-License-Identifier: MIT */
/* src/script/expects.c: expectations as a scene states them, judged and remembered */
#include "loaded.h"

#include <lauxlib.h>

#include <rbsim/model.h>

#include "script/expects.h"
#include "script/load.h"

static void assert_refused(const char *text, const char *part)
{
	struct loaded it;

	load(&it, text);
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_int_equal(it.mistakes.count, 1);
	if (!strstr(it.mistakes.line[0], part))
		fail_msg("'%s': '%s' has no '%s'", text, it.mistakes.line[0], part);
	assert_int_equal(it.scene.expect_count, 0);
	assert_int_equal(it.scene.expect_refused, 0);
	unload(&it);
}

static void expectations_arrive_in_their_order_with_their_lines(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "world { duration = 1 }\n"
	               "expect('first', function() return true end)\n"
	               "expect_always('second', function() return 1, 2 end)\n\n"
	               "expect('', function() end)");
	assert_int_equal(it.scene.expect_count, 3);
	assert_string_equal(it.scene.expects[0].text, "first");
	assert_string_equal(it.scene.expects[1].text, "second");
	assert_string_equal(it.scene.expects[2].text, "");
	assert_int_equal(it.scene.expects[0].line, 2);
	assert_int_equal(it.scene.expects[1].line, 3);
	assert_int_equal(it.scene.expects[2].line, 5);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(it.scene.expects[i].always, i == 1);
		for (int k = 0; k < i; k++)
			assert_true(it.scene.expects[i].function != it.scene.expects[k].function);
	}
	assert_int_equal(it.scene.hooks, RB_HOOK_EXPECT_ALWAYS);
	unload(&it);
	must_load(&it, "expect('x', function() end)");
	assert_int_equal(it.scene.hooks, 0);
	unload(&it);
}

static void what_is_no_expectation_is_a_mistake(void **state)
{
	(void)state;
	assert_refused("expect(5, function() end)",
	               "t.lua:1: expect: expected a text and a function "
	               "(got 5 for the text)");
	assert_refused("expect('x', true)", "(got true for the function)");
	assert_refused("expect_always()",
	               "expect_always: expected a text and a function (got nothing");
	assert_refused("expect_refused(66.5)", "expected an exit status of rbsim(1) first");
	assert_refused("expect_refused('65')", "(got the text '65')");
	assert_refused("expect_refused(0)", "(got 0)");
	assert_refused("expect_refused(70)", "(got 70)"); /* a bug is never expected */
	assert_refused("expect_refused(65, 5)", "expected a pattern as a text (got 5)");
	assert_refused("reference(5)", "reference: expected a function of t (got 5)");
}

static void a_refusal_is_kept_with_its_pattern(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "expect_refused(76, 'over%a+') state.x = 1");
	assert_int_equal(it.scene.expect_refused, 76);
	assert_string_equal(it.scene.expect_refused_pattern, "over%a+");
	unload(&it);
	must_load(&it, "expect_refused(65)");
	assert_int_equal(it.scene.expect_refused, rb_status_exit_code(RB_ERR_SCENE));
	assert_null(it.scene.expect_refused_pattern);
	unload(&it);
	/* each status that a scene can end with, but success and a bug of ours */
	for (int s = RB_ERR_USAGE; s <= RB_ERR_PHYSICS; s++) {
		const int code = rb_status_exit_code((enum rb_status)s);
		char text[60];

		snprintf(text, sizeof text, "expect_refused(%d)", code);
		load(&it, text);
		const bool never = s == RB_ERR_BUG || s == RB_ERR_MEMORY || s == RB_ERR_AGAIN;
		assert_int_equal(it.status, never ? RB_ERR_SCENE : RB_OK);
		assert_int_equal(it.scene.expect_refused, never ? 0 : code);
		unload(&it);
	}
}

struct judged {
	struct rb_expect_def def;
	struct rb_expect_result result;
};

static int judge(lua_State *L)
{
	struct judged *judged = lua_touserdata(L, lua_upvalueindex(1));

	lua_settop(L, 2);
	rb_expect_judge(L, &judged->def, &judged->result);
	assert_int_equal(lua_gettop(L), 2);
	return 0;
}

/* Runs `judge(...)` in a sandbox with a script behind it. */
static enum rb_status judged_of(struct loaded *it, const char *values, struct judged *judged)
{
	struct rb_sandbox *sandbox = &it->script->sandbox;
	char text[100];

	judged->result = (struct rb_expect_result){0};
	lua_pushlightuserdata(sandbox->L, judged);
	lua_pushcclosure(sandbox->L, judge, 1);
	lua_setglobal(sandbox->L, "judge");
	snprintf(text, sizeof text, "judge(%s)", values);
	assert_int_equal(luaL_loadstring(sandbox->L, text), LUA_OK);
	return rb_sandbox_call(sandbox, 0, 0, 1000, &it->err);
}

static void booleans_and_numbers_are_judged(void **state)
{
	static const struct {
		const char *values;
		bool ok, numbers;
		const char *message;
	} cases[] = {
		{"true", true, false, ""},
		{"false", false, false, "is false"},
		{"1, 2", true, true, ""},
		{"2, 2", true, true, ""},
		{"2.5, 2", false, true, "measured 2.5, bound 2"},
		{"-3, -4", false, true, "measured -3, bound -4"},
		{"0/0, 1", false, true, "measured nan, bound 1"},
		{"-(0/0), 1", false, true, "measured nan, bound 1"},
		{"1, 0/0", false, true, "measured 1, bound nan"},
		{"1, math.huge", true, true, ""},
		{"math.huge, 1", false, true, "measured inf, bound 1"},
	};
	struct judged judged = {.def = {.text = "it holds", .line = 7}};
	struct loaded it;

	(void)state;
	must_load(&it, "");
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		if (judged_of(&it, cases[i].values, &judged) != RB_OK)
			fail_msg("%s: %s", cases[i].values, it.err.text);
		assert_int_equal(judged.result.ok, cases[i].ok);
		assert_int_equal(judged.result.has_numbers, cases[i].numbers);
		assert_string_equal(judged.result.message, cases[i].message);
	}
	static const char *const wrong[] = {"",      "nil",   "1", "1, '2'", "true, false",
	                                    "{}, 1", "nil, 1"};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		assert_int_equal(judged_of(&it, wrong[i], &judged), RB_ERR_SCENE);
		assert_non_null(strstr(it.err.text, "t.lua:7: expect 'it holds': the function must "
		                                    "return a boolean, or measured and bound"));
	}
	judged.def.always = true;
	assert_int_equal(judged_of(&it, "1, true", &judged), RB_ERR_SCENE);
	assert_non_null(strstr(it.err.text, "expect_always 'it holds'"));
	assert_non_null(strstr(it.err.text, "(got 1 and true)"));
	unload(&it);
}

static struct rb_expect_result numbers(double measured, double bound)
{
	struct rb_expect_result now = {
		.has_numbers = true, .measured = measured, .bound = bound, .ok = measured <= bound};

	snprintf(now.message, sizeof now.message, now.ok ? "" : "too much");
	return now;
}

static void the_first_failure_and_the_worst_frame_are_remembered(void **state)
{
	static const double measured[] = {1, 3, 2.5, 5, 4, 6}, bound[] = {2, 3, 2, 4, 3, 9};
	const struct rb_expect_def def = {.text = "x", .line = 3, .always = true};
	struct rb_expect_state kept = {0};
	struct rb_expect_result result = rb_expect_recall(&kept, &def);

	(void)state;
	assert_false(result.ok);
	assert_string_equal(result.message, "no frame was looked at");
	for (int k = 0; k < 6; k++) {
		const struct rb_expect_result now = numbers(measured[k], bound[k]);

		rb_expect_remember(&kept, &now, k * 0.5);
		result = rb_expect_recall(&kept, &def);
		assert_int_equal(result.ok, k < 2);
		if (k < 2) {
			assert_true(isnan(result.failed_s));
			assert_string_equal(result.message, "");
		} else {
			assert_near(result.failed_s, 1, 0);
			assert_string_equal(result.message, "at t = 1 s: too much");
		}
	}
	/* 1 beyond the bound for the first time at frame 3; frame 4 is as far, and later */
	assert_near(result.measured, 5, 0);
	assert_near(result.bound, 4, 0);
	assert_string_equal(result.text, "x");
	assert_int_equal(result.line, 3);
	assert_true(result.always && result.has_numbers);
}

static void what_is_not_a_number_is_the_worst(void **state)
{
	const struct rb_expect_def def = {.text = "x", .always = true};
	struct rb_expect_state kept = {0};
	const struct rb_expect_result far = numbers(1e300, 0), nan = numbers((double)NAN, 1),
				      small = numbers(0, 1),
				      plain = {.ok = false, .message = "is false"};

	(void)state;
	rb_expect_remember(&kept, &far, 1);
	rb_expect_remember(&kept, &nan, 2);
	rb_expect_remember(&kept, &small, 3);
	struct rb_expect_result result = rb_expect_recall(&kept, &def);
	assert_true(isnan(result.measured));
	assert_near(result.failed_s, 1, 0);

	kept = (struct rb_expect_state){0};
	rb_expect_remember(&kept, &plain, 0.25);
	rb_expect_remember(&kept, &small, 0.5);
	result = rb_expect_recall(&kept, &def);
	assert_false(result.ok);
	assert_true(result.has_numbers);
	assert_near(result.measured, 0, 0);
	assert_string_equal(result.message, "at t = 0.25 s: is false");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(expectations_arrive_in_their_order_with_their_lines),
		cmocka_unit_test(what_is_no_expectation_is_a_mistake),
		cmocka_unit_test(a_refusal_is_kept_with_its_pattern),
		cmocka_unit_test(booleans_and_numbers_are_judged),
		cmocka_unit_test(the_first_failure_and_the_worst_frame_are_remembered),
		cmocka_unit_test(what_is_not_a_number_is_the_worst),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
