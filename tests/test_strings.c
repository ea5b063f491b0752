/* SPDX-License-Identifier: MIT */
/* src/script/strings.c: find, match, gmatch and gsub against those of Lua, and what they cost */
#include "support.h"

#include <lauxlib.h>
#include <lualib.h>

#include "math/random.h"
#include "script/sandbox.h"
#include "script/strings.h"

/*
 * `ours` beside Lua's own `string`; same(name, ...) calls both and stops where results differ, or
 * where only one fails; same_all does so for what gmatch goes through.
 */
static const char prelude[] =
	"local function pack(...) return {n = select('#', ...), ...} end\n"
	"function told(name, ...)\n"
	"  local text = name\n"
	"  for i = 1, select('#', ...) do text = text .. ' [' .. tostring((select(i, ...))) .. ']' "
	"end\n"
	"  return text\n"
	"end\n"
	"local function compare(name, a, b, ...)\n"
	"  if a[1] ~= b[1] then error(told(name, ...) .. ': Lua ' .. tostring(a[2]) .. ', ours ' "
	".. tostring(b[2])) end\n"
	"  if not a[1] then return 0 end\n"
	"  if a.n ~= b.n then error(told(name, ...) .. ': ' .. a.n .. ' and ' .. b.n .. ' "
	"results') end\n"
	"  for i = 2, a.n do if a[i] ~= b[i] or math.type(a[i]) ~= math.type(b[i]) then\n"
	"    error(told(name, ...) .. ': ' .. tostring(a[i]) .. ' and ' .. tostring(b[i])) end "
	"end\n"
	"  return a[2] ~= nil and 1 or 0\n"
	"end\n"
	"function same(name, ...)\n"
	"  return compare(name, pack(pcall(string[name], ...)), pack(pcall(ours[name], ...)), "
	"...)\n"
	"end\n"
	"local function collect(gmatch, ...)\n"
	"  local all, n = {}, 0\n"
	"  for a, b in gmatch(...) do\n"
	"    n = n + 1 all[n] = tostring(a) .. '|' .. tostring(b)\n"
	"    if n > 50 then break end\n"
	"  end\n"
	"  return table.concat(all, ';')\n"
	"end\n"
	"function same_all(...)\n"
	"  return compare('gmatch', pack(pcall(collect, string.gmatch, ...)),\n"
	"                 pack(pcall(collect, ours.gmatch, ...)), ...)\n"
	"end\n";

static void run(struct rb_sandbox *sandbox, const char *text, uint64_t instructions,
                const char *wanted)
{
	struct rb_error err = {0};

	assert_int_equal(luaL_loadstring(sandbox->L, text), LUA_OK);
	const enum rb_status status = rb_sandbox_call(sandbox, 0, 0, instructions, &err);
	if (wanted ? status != RB_ERR_SCENE || !strstr(err.text, wanted) : status != RB_OK)
		fail_msg("'%.200s': '%s'", text, err.text);
}

static void open_state(struct rb_sandbox *sandbox)
{
	struct rb_error err;
	lua_State *L;

	assert_ok(rb_sandbox_init(sandbox, (size_t)64 << 20, false, &err));
	L = sandbox->L;
	luaL_requiref(L, "_G", luaopen_base, 1);
	luaL_requiref(L, "string", luaopen_string, 1);
	luaL_requiref(L, "table", luaopen_table, 1);
	luaL_requiref(L, "math", luaopen_math, 1);
	lua_newtable(L);
	rb_strings_open(L);
	lua_setglobal(L, "ours");
	lua_settop(L, 0);
	run(sandbox, prelude, 100000, NULL);
}

static void chosen_calls_do_what_those_of_lua_do(void **state)
{
	static const char text[] =
		"assert(same('find', 'hello', 'l') == 1 and same('find', 'hello', 'l', -2) == 1)\n"
		"same('find', 'a+b', '+', 1, true) same('find', '', '', 10) same('find', 'abc', "
		"'', 4)\n"
		"same('find', 'abc', 'b', math.mininteger) same('find', 'abc', 'b', "
		"math.maxinteger)\n"
		"same('find', 'a\\0b', '\\0b') same('find', 'x)', "
		"')')\n"
		"same('match', 'key = 25', '(%w+)%s*=%s*(%w+)') same('match', '  x', '^%s*()', 2)\n"
		"same('match', 2025, '%d') same('match', 'x') same('match', nil, 'x') same('find', "
		"{}, 'x')\n"
		"same('match', 'ab', '(a)(b)(c?)') same('match', 'ab', '(a') same('find', 'ab', "
		"'(a')\n"
		"same('gsub', 'hello world', 'o', '0', 1) same('gsub', 'abc', '', '-')\n"
		"same('gsub', 'abc', '%w', '%0%0') same('gsub', 'abc', '(a)(b)', '%2%1')\n"
		"same('gsub', 'abc', '%w', '%%') same('gsub', 'abc', '%w', '%2') same('gsub', "
		"'abc', 'b', '%x')\n"
		"same('gsub', 'abc', 'b', '%') same('gsub', 'abc', '^a', 'x') same('gsub', 'aaa', "
		"'^a', 'x')\n"
		"same('gsub', 'abc', '%w', {a = 1, b = true, c = false}) same('gsub', 'ab', "
		"'(a)()', '%2')\n"
		"same('gsub', 'abc', 'b', {b = false}) same('gsub', 'abc', 'b', {b = {}})\n"
		"same('gsub', 'abc def', '%w+', function(w) return w == 'abc' and w:upper() or nil "
		"end)\n"
		"same('gsub', 'abc', '(a)(b)', function(a, b) return b .. a end)\n"
		"same('gsub', 'abc', 'b', 5) same('gsub', 'abc', 'b', nil) same('gsub', 'abc', "
		"'b', true)\n"
		"same('gsub', 'abc', '.', 'x', 0) same('gsub', 'abc', '.', 'x', -1) same('gsub', "
		"'abc', 'b*', '-')\n"
		"same('gsub', 'abc', 'b', error) same('gsub', 'x', 'x', 'a\\0%0\\0')\n"
		"same_all('one two', '%a+') same_all('k=v, l=w', '(%w+)=(%w+)') same_all('abc', "
		"'')\n"
		"same_all('abc', '^a') same_all('^a^a', '^a') same_all('abc', '()', 2) "
		"same_all('abc', '.', -2)\n"
		"same_all('abc', '.', 9) same_all('aXb', 'X*') same_all('abc', '(') "
		"same_all('abc')\n";
	struct rb_sandbox sandbox;

	(void)state;
	open_state(&sandbox);
	run(&sandbox,
	    "string.find = string.find local f = ours.find assert(f('%z', '%z', 1, true))", 10000,
	    NULL);
	run(&sandbox, text, 1000000, NULL);
	rb_sandbox_release(&sandbox);
}

static void random_bytes(char *out, size_t size, const char *bytes, size_t count, uint64_t stream,
                         uint64_t k)
{
	for (size_t i = 0; i < size; i++)
		out[i] = bytes[rb_random_bits(stream, k, i) % count];
}

/* Calls same or same_all, below its arguments; 1 where something was found. */
static int call_found(struct rb_sandbox *sandbox, int count)
{
	struct rb_error err;

	if (rb_sandbox_call(sandbox, count, 1, 1000000, &err) != RB_OK)
		fail_msg("%s", err.text);
	const int found = (int)lua_tointeger(sandbox->L, -1);
	lua_pop(sandbox->L, 1);
	return found;
}

static void random_calls_do_what_those_of_lua_do(void **state)
{
	static const char text_bytes[] = "aab1 %(", pattern_bytes[] = "aab1..%%[]^$()()**+-?aw";
	static const char new_bytes[] = "xy%%%0112a";
	static const char *const names[] = {"find", "match", "gsub"};
	struct rb_sandbox sandbox;
	int found = 0;

	(void)state;
	open_state(&sandbox);
	for (uint64_t k = 0; k < 6000; k++) {
		char text[12], pattern[8], new[6];
		const size_t size = rb_random_bits(1, k, 0) % sizeof text,
			     pattern_size = rb_random_bits(1, k, 1) % sizeof pattern,
			     new_size = rb_random_bits(1, k, 2) % sizeof new;
		const int start = (int)(rb_random_bits(1, k, 3) % 8) - 4;
		lua_State *L = sandbox.L;

		random_bytes(text, size, text_bytes, sizeof text_bytes - 1, 2, k);
		random_bytes(pattern, pattern_size, pattern_bytes, sizeof pattern_bytes - 1, 3, k);
		random_bytes(new, new_size, new_bytes, sizeof new_bytes - 1, 4, k);
		for (int i = 0; i < 4; i++) {
			lua_getglobal(L, i < 3 ? "same" : "same_all");
			if (i < 3)
				lua_pushstring(L, names[i]);
			lua_pushlstring(L, text, size);
			lua_pushlstring(L, pattern, pattern_size);
			if (i == 2)
				lua_pushlstring(L, new, new_size);
			else
				lua_pushinteger(L, start);
			found += call_found(&sandbox, i < 3 ? 4 : 3);
		}
	}
	assert_true(found > 5000);
	rb_sandbox_release(&sandbox);
}

/* Lua's own run on for as long as they like: it is C, where nothing counts. */
static void what_they_work_through_counts(void **state)
{
	static const char longer[] = "longer than 20000 instructions";
	struct rb_sandbox sandbox;

	(void)state;
	open_state(&sandbox);
	run(&sandbox, "text = ('a'):rep(10000) half = ('ab'):rep(5000)", 1000, NULL);
	run(&sandbox, "ours.find(text, 'a*b')", 20000, longer);
	run(&sandbox, "ours.match(text, '.-.-b')", 20000, longer);
	run(&sandbox, "ours.gsub(text, 'a*b', '')", 20000, longer);
	run(&sandbox, "for _ in ours.gmatch(text, 'a*b') do end", 20000, longer);
	run(&sandbox, "while true do ours.find(text, 'b', 1, true) end", 20000, longer);
	run(&sandbox, "while true do pcall(ours.find, text, '[^b]*b') end", 20000, longer);
	/* once through it is paid for */
	run(&sandbox, "assert(ours.find(half, 'b', 1, true) == 2)", 20000, NULL);
	run(&sandbox, "assert(ours.match(text, '^a*$') == text)", 20000, NULL);
	run(&sandbox, "assert(ours.find(text, 'b', 1, true) == nil)", 2000, NULL);
	rb_sandbox_release(&sandbox);
}

static void mistakes_in_patterns_are_told(void **state)
{
	struct rb_sandbox sandbox;

	(void)state;
	open_state(&sandbox);
	run(&sandbox, "ours.find('x', '[a')", 1000, "malformed pattern (missing ']')");
	run(&sandbox, "ours.find('x', 'x%')", 1000, "malformed pattern (ends with '%')");
	run(&sandbox, "ours.match('x', '(x')", 1000, "unfinished capture");
	run(&sandbox, "ours.match('x', 'x)')", 1000, "invalid pattern capture");
	run(&sandbox, "ours.match('x', '%1')", 1000, "invalid capture index");
	run(&sandbox, "ours.match('x', '%f')", 1000, "missing '[' after '%f'");
	run(&sandbox, "ours.gsub('x', 'x', '%1%2')", 1000, "invalid capture index %2");
	run(&sandbox, "ours.gsub('x', 'x', '%a')", 1000,
	    "invalid use of '%' in replacement string");
	run(&sandbox, "ours.gsub('x', 'x', print, {})", 1000, "number expected");
	run(&sandbox, "ours.gsub('x', 'x', function() return {} end)", 1000,
	    "invalid replacement value (a table)");
	run(&sandbox, "ours.gsub('x', 'x')", 1000, "string/function/table expected");
	run(&sandbox, "ours.find()", 1000, "string expected, got no value");
	rb_sandbox_release(&sandbox);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(chosen_calls_do_what_those_of_lua_do),
		cmocka_unit_test(random_calls_do_what_those_of_lua_do),
		cmocka_unit_test(what_they_work_through_counts),
		cmocka_unit_test(mistakes_in_patterns_are_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
