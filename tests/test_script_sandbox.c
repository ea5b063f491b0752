/* SPDX-License-Identifier: MIT */
/* src/script/sandbox, library, strings, pattern: what a scene can't do, and what stops it */
#include "support.h"

#include <lauxlib.h>

#include <rbsim/model.h>

#include "base/clock.h"
#include "base/log.h"
#include "script/load.h"
#include "script/pattern.h"
#include "script/sandbox.h"

static size_t memory_bytes = (size_t)8 << 20, bytes_held;
static uint64_t load_instructions = 3000000;

/* What loading ends with; budgets are small, so that running into them takes no time. */
static enum rb_status load(const char *text, bool trust, struct rb_error *err)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	const struct rb_script_options options = {.path = "t.lua",
	                                          .files = &file,
	                                          .file_count = 1,
	                                          .trust = trust,
	                                          .load_instructions = load_instructions,
	                                          .memory_bytes = memory_bytes};
	struct rb_script *script;
	struct rb_scene scene;

	*err = (struct rb_error){0};
	const enum rb_status status = rb_script_load(&script, &scene, NULL, &options, err);
	bytes_held = rb_memory_counts().bytes_now;
	rb_script_destroy(script);
	rb_scene_release(&scene);
	return status;
}

static void must_run(const char *text)
{
	struct rb_error err;

	if (load(text, false, &err) != RB_OK)
		fail_msg("'%s': %s", text, err.text);
}

static void must_fail(const char *text, const char *part)
{
	struct rb_error err;

	assert_int_equal(load(text, false, &err), RB_ERR_SCENE);
	if (!strstr(err.text, part))
		fail_msg("'%s': '%s' has no '%s'", text, err.text, part);
}

static int l_again(lua_State *L)
{
	struct rb_error err;

	if (luaL_loadstring(L, "for i = 1, 10 do end") != LUA_OK ||
	    rb_sandbox_call(rb_sandbox_of(L), 0, 0, 1000, &err) != RB_OK)
		return luaL_error(L, "the call within failed");
	return 0;
}

/* A callback can lead to a call of `field` or `motion`: its own budget must not end with that. */
static void a_call_within_a_call_shares_its_budget(void **state)
{
	struct rb_sandbox sandbox;
	struct rb_error err;

	(void)state;
	assert_int_equal(rb_sandbox_init(&sandbox, (size_t)8 << 20, false, &err), RB_OK);
	lua_register(sandbox.L, "again", l_again);
	for (int round = 0; round < 3; round++) {
		assert_int_equal(luaL_loadstring(sandbox.L, "again() again() while true do end"),
		                 LUA_OK);
		assert_int_equal(rb_sandbox_call(&sandbox, 0, 0, 100000, &err), RB_ERR_SCENE);
		assert_non_null(strstr(err.text, "longer than 100000 instructions"));
		assert_int_equal(lua_gettop(sandbox.L), 0);
		assert_int_equal(sandbox.depth, 0);
	}
	assert_int_equal(luaL_loadstring(sandbox.L, "again()"), LUA_OK);
	assert_int_equal(rb_sandbox_call(&sandbox, 0, 0, 100000, &err), RB_OK);
	rb_sandbox_release(&sandbox);
}

static void there_is_no_way_to_files_code_or_the_machine(void **state)
{
	static const char *const absent[] = {
		"io",         "os",      "debug",    "package",        "load",
		"loadstring", "dofile",  "loadfile", "collectgarbage", "warn",
		"newproxy",   "getfenv", "setfenv",  "string.dump",    "module"};
	char text[100];

	(void)state;
	for (size_t i = 0; i < sizeof absent / sizeof *absent; i++) {
		snprintf(text, sizeof text, "assert(%s == nil)", absent[i]);
		must_run(text);
	}
}

static void require_does_not_leave_its_folders(void **state)
{
	static const char *const names[] = {"../x",   "/etc/passwd", "..",  ".x",     "x.",
	                                    "a..b",   "a/b",         "",    "x.lua/", "rbsim/../x",
	                                    "a\\0.b", "rbsim..x",    "a b", "~root",  "%2e%2e",
	                                    "a\\nb",  "file:///"};
	char text[100];

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		snprintf(text, sizeof text, "require '%s'", names[i]);
		must_fail(text, "require '");
	}
	must_fail("require(5)", "require: expected a name");
}

static void metatables_lead_nowhere(void **state)
{
	(void)state;
	must_run("assert(getmetatable('') == 'string' and getmetatable(sphere { radius = 1 }) == "
	         "'body')");
	must_run("assert(getmetatable(vec3(1, 2, 3)) == 'vec3' and getmetatable(material {}) == "
	         "'material')");
	must_fail("setmetatable(vec3(1, 2, 3), {})", "protected");
	must_fail("setmetatable({}, { __gc = function() end })", "no '__gc'");
	/* what is put in later is not a finalizer either */
	must_run("local m = {} local t = setmetatable({}, m) m.__gc = function() error('ran') end "
	         "t = nil\n"
	         "for i = 1, 1000 do local garbage = {} end");
	must_fail("local b = sphere { radius = 1 } local i = rawget(b, 'x')", "table expected");
	/* a metamethod called with what it does not expect */
	must_fail("local v = vec3(1, 2, 3) return v + 5", "two vectors");
	must_fail("return sphere { radius = 1 } .. 'x'", "concatenate");
	/* an __index that lies beneath a table of keys is told, not passed over */
	must_fail("sphere(setmetatable({}, { __index = { radius = 1 } }))", "__index");
}

static void bodies_of_handles_cannot_be_forged(void **state)
{
	(void)state;
	must_fail("local b = sphere { radius = 1 } local point = b.point point(5)",
	          "expected a vector");
	must_fail("local b = sphere { radius = 1 } b.set_velocity({}, {1, 2, 3})",
	          "without its body");
	must_fail("camera { mount = {} }", "must be a body");
	must_fail("camera { mount = material {} }",
	          "must be a body or the name of one (got a material)");
}

static void addresses_do_not_show(void **state)
{
	(void)state;
	must_run("local t, u = {}, {} assert(tostring(t) == 'table: 1' and tostring(u) == 'table: "
	         "2' and tostring(t) == 'table: 1')");
	must_run("assert(tostring(print) == 'function: 1' and string.format('%s', print) == "
	         "'function: 1')");
	must_fail("string.format('%p', {})", "%p");
	must_fail("string.format('%-20p', 'x')", "%p");
	must_run("assert(string.format('%5.2f %d %q %%p', 1, 2, 'x') == ' 1.00 2 \"x\" %p')");
}

static void endless_loops_are_stopped_and_named(void **state)
{
	static const char message[] =
		"t.lua:2: the script ran longer than 3 million instructions (--trust lifts this)";

	(void)state;
	must_fail("\nwhile true do end", message);
	must_fail("\nwhile true do pcall(function() while true do end end) end", message);
	must_fail("\nlocal function f() pcall(f) while true do end end f()", message);
	must_fail("\ncoroutine.wrap(function() while true do end end)()", message);
	must_fail("\nwhile true do coroutine.resume(coroutine.create(function() while true do end "
	          "end)) end",
	          message);
	must_fail("\nwhile true do coroutine.resume(coroutine.create(function() for i = 1, 900 do "
	          "end end)) end",
	          message);
	must_fail("\nwhile true do xpcall(error, function() while true do end end) end", message);
	must_fail("\nlocal t <close> = setmetatable({}, { __close = function() while true do end "
	          "end })",
	          message);
	must_fail("\nfor _ in function() return 1 end do end", message);
	must_fail("\nlocal t = setmetatable({}, { __index = function(t, k) return t[k + 1] end }) "
	          "while true do pcall(function() return t[1] end) end",
	          "million instructions");
	/* where Lua itself would run on with its hooks off */
	must_fail("\nlocal loop = function() while true do end end\nxpcall(loop, loop)",
	          "t.lua:2: the script ran longer");
	must_fail("\nlocal m = { __close = function() while true do end end }\n"
	          "local co = coroutine.wrap(function() local x <close> = setmetatable({}, m) "
	          "while true do end end) co()",
	          "the script ran longer");
	must_fail("\nlocal m = { __close = function() while true do end end }\n"
	          "local co = coroutine.create(function() local x <close> = setmetatable({}, m) "
	          "while true do end end)\n"
	          "coroutine.resume(co) coroutine.close(co)",
	          "the script ran longer");
	must_fail("\nlocal m = { __close = function() while true do end end }\n"
	          "local co = coroutine.wrap(function() local x <close> = setmetatable({}, m) "
	          "table.sort({1, 2, 3}, function() while true do end end) end)\n"
	          "pcall(co) pcall(co)",
	          "the script ran longer");
	must_fail("\nlocal m = { __tostring = function() while true do end end "
	          "}\nerror(setmetatable({}, m))",
	          "the script ran longer");
	must_fail("\nwhile true do print('x') end", message);
	must_fail("\n::a:: goto a", message);
}

static void what_works_in_c_is_stopped_too(void **state)
{
	const uint64_t start = rb_clock_cpu_ns();

	(void)state;
	must_fail("local s = ('a'):rep(30000) s:find('.-.-.-.-.-.-b')", "million instructions");
	must_fail("local s = ('a'):rep(30000) s:match('(.-)(.-)(.-)(.-)b')",
	          "million instructions");
	must_fail("local s = ('a'):rep(30000) s:gsub('.-.-.-.-b', '')", "million instructions");
	must_fail("local s = ('a'):rep(30000) for _ in s:gmatch('.-.-.-.-b') do end",
	          "million instructions");
	must_fail("while true do (('('):rep(60000)):find('%b()') end", "million instructions");
	must_fail("table.move({}, 1, 1e15, 2)", "million instructions");
	must_fail("table.concat(setmetatable({}, { __len = function() return 1e15 end }))",
	          "__len");
	must_fail("table.insert(setmetatable({}, { __len = function() return 1e15 end }), 1, 1)",
	          "__len");
	must_fail("local t = {} for i = 1, 2e5 do t[i] = i end while true do table.insert(t, 1, 0) "
	          "table.remove(t, 1) end",
	          "million instructions");
	must_fail("local t = {} for i = 1, 1e5 do t[i] = i end while true do table.sort(t) end",
	          "million instructions");
	must_fail("local t = {} for i = 1, 1e5 do t[i] = i end while true do for _ in pairs(t) do "
	          "break end end",
	          "million instructions");
	must_fail("local t = {} for i = 1, 1e5 do t[i] = i end while true do next(t) end",
	          "million instructions");
	must_fail("while true do ('x'):rep(1e6) end", "million instructions");
	must_run("assert(('').rep('', 1e18) == '')");
	/* a second or two in all, or something ran on */
	assert_true(rb_clock_cpu_ns() - start < 60000000000u);
}

/* 2^18 numbers are 4 MiB, which come to be where there were 2: what counts is what there is in the end. */
static void memory_that_grows_counts_once(void **state)
{
	static const char text[] = "local t = {} for i = 1, 2^18 do t[i] = i end";

	(void)state;
	memory_bytes = (size_t)5 << 20;
	must_run(text);
	memory_bytes = (size_t)3 << 20;
	must_fail(text, "needs more than 3 MiB of memory");
	memory_bytes = (size_t)8 << 20;
}

/* What a scene with so many hulls, all different, is allowed at least, to a 64th; to `held` what the program then holds. */
static double least_for_hulls(int count, double *held)
{
	double low = 1 << 16, high = 1 << 26;
	struct rb_error err;
	char text[400];

	snprintf(text, sizeof text,
	         "local p = {} for i = 1, 200 do p[i] = {0, 0, 0} end\n"
	         "for k = 1, %d do\n"
	         "  for i = 1, 200 do local z, a = i / 101 - 1, 2.4 * i + k local r = math.sqrt(1 "
	         "- z * z)\n"
	         "    p[i][1], p[i][2], p[i][3] = r * math.cos(a), r * math.sin(a), z end\n"
	         "  hull { points = p, mass = 1, position = {3 * k, 0, 0} } end",
	         count);
	while (high > low * (1 + 1.0 / 64)) {
		memory_bytes = (size_t)sqrt(low * high);
		if (load(text, false, &err) == RB_OK) {
			high = (double)memory_bytes;
			*held = (double)bytes_held;
		} else {
			if (!strstr(err.text, "of memory"))
				fail_msg("%s", err.text);
			low = (double)memory_bytes;
		}
	}
	memory_bytes = (size_t)8 << 20;
	return high;
}

/* Twice as many hulls want as much more as they take. */
static void hulls_count_with_what_they_take(void **state)
{
	double held[2];

	(void)state;
	load_instructions = 1000000000;
	const double few = least_for_hulls(20, &held[0]), many = least_for_hulls(40, &held[1]);

	load_instructions = 3000000;
	/* both bounds to a 64th; the sandbox takes its small blocks in chunks of 32 KiB */
	assert_near(many - few, held[1] - held[0], (many + few) / 64 + 32768);
}

static void memory_is_bounded(void **state)
{
	static const char message[] =
		"t.lua:1: the script needs more than 8 MiB of memory (--trust lifts this)";

	(void)state;
	must_fail("local t = {} for i = 1, 1e9 do t[i] = i end", message);
	must_fail("local t = {}\nfor i = 1, 1e9 do\n\tt[i] = {}\nend", "t.lua:3: the script needs");
	must_fail("local f = coroutine.wrap(function()\nlocal t = {}\nwhile true do\nt[#t + 1] = "
	          "function() return t end end end)\nf()",
	          "t.lua:4: the script needs more than 8 MiB");
	must_fail("local t = {}\nfor i = 1, 1e9 do t[i] = tostring(i):rep(9)\nend",
	          "t.lua:2: the script needs more than 8 MiB");
	must_fail("local s = 'x' while true do s = s .. s end", message);
	must_fail("while true do local ok = pcall(function() local s = 'x' while true do s = s .. "
	          "s end end) end",
	          "million instructions");
	must_fail("string.rep('x', 1e10)", "a text of more than 16 MiB");
	must_fail("local s = 'x'\nwhile true do\ns = s .. s end", "t.lua:3: the script needs");
	must_fail("string.rep('x', 1e7)", "8 MiB");
	must_fail("local function f() return f() + 1 end f()", "");
	must_fail("for i = 1, 1e9 do sphere { radius = 1 } end", "8 MiB");
	must_fail("local name = ('x'):rep(1000) for i = 1, 1e9 do sphere { radius = 1, name = name "
	          ".. i } end",
	          "8 MiB");
	must_fail("for i = 1, 1e9 do camera {} end", "8 MiB");
	must_fail("for i = 1, 1e9 do param('p' .. i, 1, 'help') end", "");
	must_fail("string.format('%s', ('x'):rep(5e6)):upper():lower()", "8 MiB");
	must_run("for i = 1, 150 do local s = ('x'):rep(100000) end"); /* garbage is not counted */
}

static void trust_lifts_the_sandbox(void **state)
{
	struct rb_error err;

	(void)state;
	assert_int_equal(load("assert(io and os and debug and load and collectgarbage and "
	                      "string.dump and package)\n"
	                      "for i = 1, 5e6 do end local t = {} for i = 1, 1e6 do t[i] = i end\n"
	                      "assert(load('return 1')() == 1)\n"
	                      "local a = math.random(1000000) math.randomseed(1) local b = "
	                      "math.random(1000000)\n"
	                      "math.randomseed(1) assert(b == math.random(1000000)) record { file "
	                      "= '/tmp/x.h5' }",
	                      true, &err),
	                 RB_OK);
}

static void coroutines_and_xpcall_work_as_in_lua(void **state)
{
	(void)state;
	must_run("local f = coroutine.wrap(function(a) local b = coroutine.yield(a + 1) return b * "
	         "2 end)\n"
	         "assert(f(1) == 2 and f(5) == 10 and not pcall(f))\n"
	         "local co = coroutine.create(function() coroutine.yield(1) error('x', 0) end)\n"
	         "assert(select(2, coroutine.resume(co)) == 1 and select(2, coroutine.resume(co)) "
	         "== 'x')\n"
	         "assert(coroutine.status(co) == 'dead' and not coroutine.close(co))\n"
	         "local closed local s = coroutine.create(function() local x <close> = "
	         "setmetatable({}, { __close = function() closed = true end })\n"
	         "  coroutine.yield() end) coroutine.resume(s) assert(coroutine.close(s) and "
	         "closed)\n"
	         "local g g = coroutine.wrap(function() return pcall(g) end) local ok, why = g() "
	         "assert(not ok and why:find('non%-suspended'))\n"
	         "assert(select(2, xpcall(function(a, b) return a + b end, print, 2, 3)) == 5)\n"
	         "local ok, m = xpcall(error, function(e) return e .. '!' end, 'no', 0) assert(not "
	         "ok and m == 'no!')\n"
	         "local y = coroutine.wrap(function() return xpcall(function() return "
	         "coroutine.yield(1) end, print) end)\n"
	         "assert(y() == 1) local a, b = y('back') assert(a == true and b == 'back')\n"
	         "for i in coroutine.wrap(function() for i = 1, 3 do coroutine.yield(i) end end) "
	         "do state.last = i end assert(state.last == 3)");
}

static void a_harmless_pattern_is_no_bomb(void **state)
{
	(void)state;
	must_run("local s = ('word '):rep(2000) local n = 0 for w in s:gmatch('%a+') do n = n + 1 "
	         "end assert(n == 2000)");
	must_run("local s = ('x = 1\\n'):rep(200) assert(select(2, s:gsub('(%w+)%s*=%s*(%w+)', "
	         "'%2')) == 200)");
}

static void a_pattern_can_be_looked_for_without_lua(void **state)
{
	(void)state;
	assert_true(rb_pattern_found("sphere 'ball': unknown key", "unknown key"));
	assert_true(rb_pattern_found("overlaps by 0.25 m", "by %d+%.%d+ m$"));
	assert_false(rb_pattern_found("overlaps", "^laps"));
	assert_true(rb_pattern_found("a [b", "[b")); /* wrong as a pattern: taken as it is */
	assert_false(rb_pattern_found("abc", "[x"));
}

static char printed[4][200];
static int print_count;

static void keep_print(enum rb_log_level level, const char *text, void *user)
{
	(void)user;
	assert_int_equal(level, RB_LOG_NOTE);
	if (print_count < 4)
		snprintf(printed[print_count], sizeof printed[0], "%s", text);
	print_count++;
}

static void print_goes_to_the_log(void **state)
{
	(void)state;
	print_count = 0;
	rb_log_to(keep_print, NULL, RB_LOG_NOTE);
	must_run("print('a', 1, nil, vec3(1, 2, 3)) print()");
	rb_log_to(NULL, NULL, RB_LOG_WARNING);
	assert_int_equal(print_count, 2);
	assert_string_equal(printed[0], "a\t1\tnil\t{1.0, 2.0, 3.0}");
	assert_string_equal(printed[1], "");
}

static void errors_of_c_functions_have_their_place(void **state)
{
	(void)state;
	must_fail("\n\ntable.insert({1}, 5, 2)",
	          "t.lua:3: bad argument #2 to 'insert' (position out of bounds)");
	must_fail("\nstring.rep()", "t.lua:2: bad argument #1 to 'rep'");
	must_fail("\ntable.concat({{}})",
	          "t.lua:2: invalid value (table) at index 1 in table for 'concat'");
	must_fail("\n('x'):match('(')", "t.lua:2: unfinished capture");
	must_fail("error({})", ":1: (error object is a table value)");
	must_fail("error(setmetatable({}, { __tostring = function() return 'mine' end }))", "mine");
	must_fail("error()", ":1: (error object is a nil value)");
}

static void an_undefined_global_is_nil_in_a_stored_scene(void **state)
{
	(void)state;
	/* as that of a recording, which was run like this */
	must_run("world { duration = 1 } sphere { radius = 1, mass = nowhere }");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_undefined_global_is_nil_in_a_stored_scene),
		cmocka_unit_test(a_call_within_a_call_shares_its_budget),
		cmocka_unit_test(there_is_no_way_to_files_code_or_the_machine),
		cmocka_unit_test(require_does_not_leave_its_folders),
		cmocka_unit_test(metatables_lead_nowhere),
		cmocka_unit_test(bodies_of_handles_cannot_be_forged),
		cmocka_unit_test(addresses_do_not_show),
		cmocka_unit_test(endless_loops_are_stopped_and_named),
		cmocka_unit_test(what_works_in_c_is_stopped_too),
		cmocka_unit_test(memory_that_grows_counts_once),
		cmocka_unit_test(hulls_count_with_what_they_take),
		cmocka_unit_test(memory_is_bounded),
		cmocka_unit_test(trust_lifts_the_sandbox),
		cmocka_unit_test(coroutines_and_xpcall_work_as_in_lua),
		cmocka_unit_test(a_harmless_pattern_is_no_bomb),
		cmocka_unit_test(a_pattern_can_be_looked_for_without_lua),
		cmocka_unit_test(print_goes_to_the_log),
		cmocka_unit_test(errors_of_c_functions_have_their_place),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
