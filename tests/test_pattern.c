/* SPDX-License-Identifier: MIT */
/* src/script/pattern.c: it matches as Lua does, and stops when its steps are used up */
#include "support.h"

#include <lauxlib.h>
#include <lualib.h>

#include "math/random.h"
#include "script/pattern.h"

enum { TEXT_MAX = 12, PATTERN_MAX = 9 };

struct found {
	bool wrong, found;
	ptrdiff_t first, end;
	int captures;
	/* first and size; a position has -1 for its size */
	ptrdiff_t at[RB_PATTERN_CAPTURES][2];
};

static struct found find_ours(const char *text, size_t size, const char *pattern,
                              size_t pattern_size)
{
	const size_t anchor = pattern_size > 0 && *pattern == '^';
	struct found found = {0};
	struct rb_match match;

	rb_match_start(&match, text, size, pattern, pattern_size, 1000000);
	for (const char *at = text; at <= text + size; at++) {
		const char *end = rb_match_at(&match, at, pattern + anchor);

		found.wrong = match.mistake != NULL;
		if (end) {
			found.found = true;
			found.first = at - text;
			found.end = end - text;
			found.captures = match.capture_count;
		}
		if (end || found.wrong || anchor)
			break;
	}
	for (int i = 0; i < found.captures; i++) {
		if (match.capture[i].size == RB_CAPTURE_OPEN)
			found.wrong = true; /* Lua says so when it hands them out */
		found.at[i][0] = match.capture[i].start - text;
		found.at[i][1] = match.capture[i].size == RB_CAPTURE_POSITION
		                         ? -1
		                         : match.capture[i].size;
	}
	return found;
}

/* Matches of Lua's string.find against ours, place and captures; whether something was found. */
static bool assert_as_lua(lua_State *L, const char *text, size_t size, const char *pattern,
                          size_t pattern_size)
{
	const struct found ours = find_ours(text, size, pattern, pattern_size);
	bool plain = true; /* find then looks for it as it is, even for a lone ')' */

	for (size_t i = 0; i < pattern_size; i++)
		plain = plain && !(pattern[i] && strchr("^$*+?.([%-", pattern[i]));
	if (plain)
		return false;
	lua_settop(L, 0);
	lua_getglobal(L, "string");
	lua_getfield(L, 1, "find");
	lua_pushlstring(L, text, size);
	lua_pushlstring(L, pattern, pattern_size);
	const bool right = lua_pcall(L, 2, LUA_MULTRET, 0) == LUA_OK;
	if (right == ours.wrong)
		fail_msg("'%s' for '%s': Lua says %s", text, pattern,
		         right ? "nothing against it" : lua_tostring(L, -1));
	if (!right)
		return false;
	const bool found = !lua_isnil(L, 2);
	if (found != ours.found)
		fail_msg("'%s' for '%s': Lua %s it", text, pattern, found ? "finds" : "misses");
	if (!found)
		return false;
	if (lua_tointeger(L, 2) != ours.first + 1 || lua_tointeger(L, 3) != ours.end ||
	    lua_gettop(L) - 3 != ours.captures)
		fail_msg("'%s' for '%s': found elsewhere", text, pattern);
	for (int i = 0; i < ours.captures; i++) {
		size_t length;

		if (lua_isinteger(L, 4 + i)) {
			assert_int_equal(lua_tointeger(L, 4 + i), ours.at[i][0] + 1);
			assert_int_equal(ours.at[i][1], -1);
			continue;
		}
		const char *capture = lua_tolstring(L, 4 + i, &length);
		assert_int_equal(ours.at[i][1], length);
		assert_memory_equal(capture, text + ours.at[i][0], length);
	}
	return true;
}

static lua_State *open_lua(void)
{
	lua_State *L = luaL_newstate();

	assert_non_null(L);
	luaL_requiref(L, "string", luaopen_string, 1);
	return L;
}

static void chosen_patterns_mean_what_lua_means(void **state)
{
	static const char *const cases[][2] = {{"hello world", "o w"},
	                                       {"hello", "l+"},
	                                       {"hello", "^l"},
	                                       {"key = 25 m", "(%w+)%s*=%s*(%d+)"},
	                                       {"f(a(b)c)d", "%b()"},
	                                       {"((", "%b()"},
	                                       {"THE (quick) fox", "%f[%a]%a+"},
	                                       {"abab", "(ab)%1"},
	                                       {"abac", "(ab)%1"},
	                                       {"x", "()"},
	                                       {"abc", "()b()"},
	                                       {"a-b", "[a%-]+"},
	                                       {"]]", "[]]+"},
	                                       {"^", "[%^]"},
	                                       {"a^", "[a^]+$"},
	                                       {"0x1F", "^0[xX](%x+)$"},
	                                       {"aXb", "%u"},
	                                       {"a.b", "%."},
	                                       {"abc", ".-c"},
	                                       {"aaa", "a-"},
	                                       {"", "^$"},
	                                       {"a", "[a-]"},
	                                       {"-", "[a-]"},
	                                       {"b", "[a-c]"},
	                                       {"tab\there", "%c"},
	                                       {"a b", "%S+$"},
	                                       {"x", "%"},
	                                       {"x", "[x"},
	                                       {"x", "(x"},
	                                       {"x", ".)"},
	                                       {"x", "%1"},
	                                       {"x", "%f"},
	                                       {"x", "%b"},
	                                       {"xx", "%bx"},
	                                       {"$", "$"},
	                                       {"a$b", "a$b"},
	                                       {"aa", "(a)(%1)"},
	                                       {"ab", "((a)(b))"},
	                                       {"ab", "(a%1)"}};
	lua_State *L = open_lua();
	int found = 0;

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		found += assert_as_lua(L, cases[i][0], strlen(cases[i][0]), cases[i][1],
		                       strlen(cases[i][1]));
	assert_true(found > 20);
	lua_close(L);
}

static void random_patterns_mean_what_lua_means(void **state)
{
	static const char text_bytes[] = "aab1 %-(]\0\xe9";
	static const char pattern_bytes[] = "aaabb1.%%%[[]]^$(())**+-?fbdswW-\0\xe9";
	lua_State *L = open_lua();
	int found = 0;

	(void)state;
	for (uint64_t k = 0; k < 60000; k++) {
		char text[TEXT_MAX + 1] = "", pattern[PATTERN_MAX + 1] = "";
		const size_t size = rb_random_bits(2, k, 0) % TEXT_MAX;
		const size_t pattern_size = 1 + rb_random_bits(2, k, 1) % (PATTERN_MAX - 1);

		for (size_t i = 0; i < size; i++)
			text[i] = text_bytes[rb_random_bits(3, k, i) % (sizeof text_bytes - 1)];
		for (size_t i = 0; i < pattern_size; i++)
			pattern[i] =
				pattern_bytes[rb_random_bits(4, k, i) % (sizeof pattern_bytes - 1)];
		found += assert_as_lua(L, text, size, pattern, pattern_size);
	}
	assert_true(found > 1500);
	lua_close(L);
}

static void classes_hold_the_characters_that_lua_puts_in_them(void **state)
{
	static const char classes[] = "acdglpsuwxACDGLPSUWXq.%";
	lua_State *L = open_lua();

	(void)state;
	for (size_t k = 0; k < sizeof classes - 1; k++) {
		for (int c = 0; c < 256; c++) {
			const char text = (char)c, pattern[] = {'%', classes[k]};
			const char set[] = {'[', '^', '%', classes[k], '\x40', '-', '\x7f', ']'};

			assert_as_lua(L, &text, 1, pattern, sizeof pattern);
			assert_as_lua(L, &text, 1, set, sizeof set);
		}
	}
	lua_close(L);
}

/* (.-)(.-)(.-)b on a text without b tries some n^3 / 6 places before it gives up. */
static void steps_are_counted_and_end_a_match(void **state)
{
	static const char pattern[] = "(.-)(.-)(.-)b";
	char text[300];
	struct rb_match match;

	(void)state;
	memset(text, 'a', sizeof text);
	rb_match_start(&match, text, sizeof text, pattern, sizeof pattern - 1, 100000);
	assert_null(rb_match_at(&match, text, pattern));
	assert_int_equal(match.steps, 0);
	assert_non_null(match.mistake);
	assert_non_null(strstr(match.mistake, "too many steps"));

	/* one step a character and one that says that the text ends */
	rb_match_start(&match, text, sizeof text, "a*", 2, sizeof text + 1);
	assert_ptr_equal(rb_match_at(&match, text, "a*"), text + sizeof text);
	assert_int_equal(match.steps, 0);
	assert_null(match.mistake);
	rb_match_start(&match, text, sizeof text, "a*", 2, sizeof text);
	assert_null(rb_match_at(&match, text, "a*"));
	assert_non_null(match.mistake);
}

static void long_sets_and_captures_cost_their_length(void **state)
{
	char pattern[1003], text[1000];
	struct rb_match match;

	(void)state;
	memset(pattern, 'x', sizeof pattern);
	pattern[0] = '[';
	pattern[sizeof pattern - 1] = ']';
	rb_match_start(&match, "a", 1, pattern, sizeof pattern, 900);
	assert_null(rb_match_at(&match, match.subject, pattern));
	assert_non_null(match.mistake);
	rb_match_start(&match, "x", 1, pattern, sizeof pattern, 10000);
	assert_non_null(rb_match_at(&match, match.subject, pattern));
	assert_true(match.steps <= 10000 - 1001);

	memset(text, 'a', sizeof text);
	rb_match_start(&match, text, sizeof text, "(a*)%1", 6, 1400);
	assert_null(rb_match_at(&match, text, "(a*)%1"));
	assert_non_null(match.mistake);
	rb_match_start(&match, text, sizeof text, "(a*)%1$", 7, 1000000);
	assert_ptr_equal(rb_match_at(&match, text, "(a*)%1$"), text + sizeof text);
	assert_int_equal(match.capture_count, 1);
	assert_int_equal(match.capture[0].size, sizeof text / 2);
}

static void captures_and_depth_have_bounds(void **state)
{
	char pattern[700], text[300];
	struct rb_match match;

	(void)state;
	for (int i = 0; i < 33; i++)
		memcpy(pattern + 2 * i, "()", 2);
	rb_match_start(&match, "", 0, pattern, 64, 1000);
	assert_ptr_equal(rb_match_at(&match, match.subject, pattern), match.subject);
	assert_int_equal(match.capture_count, RB_PATTERN_CAPTURES);
	rb_match_start(&match, "", 0, pattern, 66, 1000);
	assert_null(rb_match_at(&match, match.subject, pattern));
	assert_string_equal(match.mistake, "too many captures");

	/* each '?' that finds something is a level of its own, as in Lua, where 200 are too many */
	memset(text, 'a', sizeof text);
	for (int i = 0; i < 300; i++)
		memcpy(pattern + 2 * i, "a?", 2);
	rb_match_start(&match, text, sizeof text, pattern, 600, 1000000);
	assert_null(rb_match_at(&match, text, pattern));
	assert_string_equal(match.mistake, "pattern too complex");
	rb_match_start(&match, text, sizeof text, pattern, 200, 1000000);
	assert_ptr_equal(rb_match_at(&match, text, pattern), text + 100);
}

static void a_call_that_is_over_ends_a_match(void **state)
{
	static struct rb_overtime overtime;
	struct rb_match match;

	(void)state;
	rb_match_start(&match, "aaa", 3, "a+", 2, 1000);
	match.overtime = &overtime;
	assert_non_null(rb_match_at(&match, match.subject, "a+"));
	overtime.ticks = RB_OVERTIME_TICKS + 1;
	assert_null(rb_match_at(&match, match.subject, "a+"));
	assert_non_null(match.mistake);
	assert_int_equal(match.steps, 0);
}

static void a_text_can_be_looked_for_without_a_state(void **state)
{
	(void)state;
	assert_true(rb_pattern_found("", ""));
	assert_true(rb_pattern_found("", "^$"));
	assert_true(rb_pattern_found("abc", "c$"));
	assert_false(rb_pattern_found("abc", "^b"));
	assert_true(rb_pattern_found("100%", "100%")); /* wrong as a pattern: as it is */
	assert_false(rb_pattern_found("100", "100%"));
	assert_true(rb_pattern_found("a^b", "%^"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(chosen_patterns_mean_what_lua_means),
		cmocka_unit_test(random_patterns_mean_what_lua_means),
		cmocka_unit_test(classes_hold_the_characters_that_lua_puts_in_them),
		cmocka_unit_test(steps_are_counted_and_end_a_match),
		cmocka_unit_test(long_sets_and_captures_cost_their_length),
		cmocka_unit_test(captures_and_depth_have_bounds),
		cmocka_unit_test(a_call_that_is_over_ends_a_match),
		cmocka_unit_test(a_text_can_be_looked_for_without_a_state),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
