/* SPDX-License-Identifier: MIT */
/* src/script/overtime, sandbox: what no hook of Lua's ends, time does */
#include "support.h"

#include <signal.h>
#include <sys/wait.h>

#include <lauxlib.h>
#include <lualib.h>

#include "script/sandbox.h"

static const char cycle[] = "local t = {} setmetatable(t, t) t.__call = t t()";

static void begin(struct rb_sandbox *sandbox)
{
	struct rb_error err;

	assert_int_equal(rb_sandbox_init(sandbox, (size_t)64 << 20, false, &err), RB_OK);
	luaL_openlibs(sandbox->L);
}

static enum rb_status run(struct rb_sandbox *sandbox, const char *text, struct rb_error *err)
{
	assert_int_equal(luaL_loadstring(sandbox->L, text), LUA_OK);
	return rb_sandbox_call(sandbox, 0, 0, UINT64_MAX / 4, err);
}

static void must_be_left(struct rb_sandbox *sandbox, const char *text)
{
	struct rb_error err;

	assert_int_equal(run(sandbox, text, &err), RB_ERR_SCENE);
	assert_string_equal(
		err.text,
		"the script ran longer than 0.2 seconds within one operation (--trust lifts this)");
	assert_true(sandbox->lost);
}

static void the_hook_ends_what_it_sees(void **state)
{
	struct rb_sandbox sandbox;
	struct rb_error err;

	(void)state;
	begin(&sandbox);
	for (int round = 0; round < 2; round++) {
		assert_int_equal(run(&sandbox, "while true do pcall(error) end", &err),
		                 RB_ERR_SCENE);
		assert_non_null(strstr(err.text, "longer than 0.2 seconds (--trust"));
		assert_false(sandbox.lost);
	}
	assert_int_equal(run(&sandbox, "local x = 1", &err), RB_OK);
	rb_sandbox_release(&sandbox);
}

static void what_no_hook_ends_is_left_and_gives_its_memory_back(void **state)
{
	struct rb_sandbox sandbox;
	struct rb_error err;
	char text[300];

	(void)state;
	for (int round = 0; round < 3; round++) {
		begin(&sandbox);
		/* blocks of all kinds that the lost state still holds */
		snprintf(text, sizeof text,
		         "keep = {} for i = 1, 1000 do keep[i] = ('x'):rep(i) end %s", cycle);
		must_be_left(&sandbox, text);
		for (int again = 0; again < 3; again++) { /* refused, whatever is pushed first */
			lua_pushinteger(sandbox.L, 1);
			assert_int_equal(run(&sandbox, "return 1", &err), RB_ERR_SCENE);
			assert_non_null(strstr(err.text, "longer than 0.2 seconds within"));
			assert_int_equal(lua_gettop(sandbox.L), 0);
		}
		rb_sandbox_release(&sandbox);
	}
}

/* As `field` and `motion` are called while a callback goes on. */
static int l_within(lua_State *L)
{
	struct rb_sandbox *const sandbox = rb_sandbox_of(L);
	struct rb_error err;

	if (luaL_loadstring(sandbox->L, cycle) != LUA_OK ||
	    rb_sandbox_call(sandbox, 0, 0, 1000, &err) != RB_OK)
		return luaL_error(L, "the call within failed");
	return 0;
}

static void a_call_within_a_call_is_left_as_a_whole(void **state)
{
	struct rb_sandbox sandbox;

	(void)state;
	begin(&sandbox);
	lua_register(sandbox.L, "within", l_within);
	must_be_left(&sandbox, "coroutine.wrap(function() pcall(within) end)()");
	rb_sandbox_release(&sandbox);
}

static int l_stuck(lua_State *L)
{
	(void)L;
	for (volatile int forever = 1; forever;)
		;
	return 0;
}

/* Code of ours is not left in its midst: the process ends, with a status and a word. */
static void what_cannot_be_left_ends_the_process(void **state)
{
	struct rb_sandbox sandbox;
	int ends[2], how;
	char said[200] = "";

	(void)state;
	assert_int_equal(pipe(ends), 0);
	const pid_t child = fork();
	if (child == 0) {
		struct rb_error err;
		dup2(ends[1], STDERR_FILENO);
		begin(&sandbox);
		lua_register(sandbox.L, "stuck", l_stuck);
		_exit(run(&sandbox, "stuck()", &err) == RB_OK ? 1 : 2);
	}
	assert_true(child > 0);
	close(ends[1]);
	assert_int_equal(waitpid(child, &how, 0), child);
	assert_true(WIFEXITED(how));
	assert_int_equal(WEXITSTATUS(how), 65);
	assert_true(read(ends[0], said, sizeof said - 1) > 0);
	assert_string_equal(said, "rbsim: the script ran longer than 0.2 seconds and can't be "
	                          "stopped (--trust lifts this)\n");
	close(ends[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_hook_ends_what_it_sees),
		cmocka_unit_test(what_no_hook_ends_is_left_and_gives_its_memory_back),
		cmocka_unit_test(a_call_within_a_call_is_left_as_a_whole),
		cmocka_unit_test(what_cannot_be_left_ends_the_process),
	};

#if defined(__SANITIZE_THREAD__)
	return 0; /* it holds signals back until a function of the system's library is called */
#endif
	setenv("RBSIM_SCRIPT_SECONDS", "0.2", 1);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
