/* SPDX-License-Identifier: MIT */
/*
 * Lua's own functions are wrapped, not replaced, wherever they may stay: `metered` charges for what
 * they will go through and calls the original. Replaced are those whose results depend on addresses
 * (pairs, tostring), on a hidden state (random), or that cannot be bounded (patterns).
 *
 * pairs sorts all keys first, with a heap sort that needs no memory: the sorted list is one
 * userdata, and the keys that must stay alive are in a table beside it.
 */
#include "script/library.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include <lauxlib.h>
#include <lualib.h>

#include "base/log.h"
#include "math/random.h"
#include "script/sandbox.h"
#include "script/strings.h"

/* ---- tostring, print ---- */

/* The number of an object, in the order of first sight; the table's keys are weak. */
static lua_Integer object_number(lua_State *L, int index)
{
	index = lua_absindex(L, index);
	if (lua_getfield(L, LUA_REGISTRYINDEX, "rbsim.objects") == LUA_TNIL) {
		lua_pop(L, 1);
		lua_newtable(L);
		lua_newtable(L);
		lua_pushliteral(L, "k");
		lua_setfield(L, -2, "__mode");
		lua_setmetatable(L, -2);
		lua_pushvalue(L, -1);
		lua_setfield(L, LUA_REGISTRYINDEX, "rbsim.objects");
	}
	lua_pushvalue(L, index);
	if (lua_rawget(L, -2) == LUA_TNIL) {
		lua_pop(L, 1);
		lua_rawgeti(L, -1, 0);
		const lua_Integer number = lua_tointeger(L, -1) + 1;
		lua_pop(L, 1);
		lua_pushinteger(L, number);
		lua_rawseti(L, -2, 0);
		lua_pushvalue(L, index);
		lua_pushinteger(L, number);
		lua_rawset(L, -3);
		lua_pushinteger(L, number);
	}
	const lua_Integer number = lua_tointeger(L, -1);
	lua_pop(L, 2);
	return number;
}

const char *rb_library_text(lua_State *L, int index, size_t *size)
{
	const int type = lua_type(L, index);

	index = lua_absindex(L, index);
	if (type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA ||
	    type == LUA_TTHREAD || type == LUA_TLIGHTUSERDATA) {
		if (luaL_getmetafield(L, index, "__tostring") == LUA_TNIL) {
			lua_pushfstring(L, "%s: %I", luaL_typename(L, index),
			                (LUAI_UACINT)object_number(L, index));
			return lua_tolstring(L, -1, size);
		}
		lua_pop(L, 1);
	}
	if (type == LUA_TNUMBER && isnan(lua_tonumber(L, index))) {
		/* 0/0 has a sign on some processors, which would be printed */
		lua_pushliteral(L, "nan");
		return lua_tolstring(L, -1, size);
	}
	return luaL_tolstring(L, index, size);
}

static int l_tostring(lua_State *L)
{
	luaL_checkany(L, 1);
	rb_library_text(L, 1, NULL);
	return 1;
}

static int l_print(lua_State *L)
{
	const int count = lua_gettop(L);
	luaL_Buffer line;

	rb_sandbox_charge(L, 1000);
	luaL_checkstack(L, 2 * count + 4, NULL);
	for (int i = 1; i <= count; i++)
		rb_library_text(L, i, NULL);
	luaL_buffinit(L, &line);
	for (int i = 1; i <= count; i++) {
		if (i > 1)
			luaL_addchar(&line, '\t');
		lua_pushvalue(L, count + i);
		luaL_addvalue(&line);
	}
	luaL_pushresult(&line);
	/* line by line: what a line break within a message is, is not ours to show */
	const char *text = lua_tostring(L, -1);
	for (const char *end; (end = strchr(text, '\n')); text = end + 1)
		rb_log(RB_LOG_NOTE, "%.*s", (int)(end - text), text);
	rb_log(RB_LOG_NOTE, "%s", text);
	return 0;
}

/* ---- pairs in an order that does not hang on addresses ---- */

/* Order of the kinds of keys; KEY_OTHER has no order within. */
enum key_rank { KEY_INTEGER, KEY_NUMBER, KEY_TEXT, KEY_BOOLEAN, KEY_OBJECT, KEY_OTHER };

struct key {
	enum key_rank rank;
	lua_Integer integer; /* and boolean; of an object its kind and number */
	lua_Number number;
	const char *text; /* kept alive by the list beside the keys */
	size_t size;
	lua_Integer place; /* of an object in that list */
};

static struct key key_at(lua_State *L, int index)
{
	struct key key = {.rank = KEY_OTHER};

	index = lua_absindex(L, index);
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		key.rank = lua_isinteger(L, index) ? KEY_INTEGER : KEY_NUMBER;
		key.integer = lua_isinteger(L, index) ? lua_tointeger(L, index) : 0;
		key.number = lua_tonumber(L, index);
		break;
	case LUA_TSTRING:
		key.rank = KEY_TEXT;
		key.text = lua_tolstring(L, index, &key.size);
		break;
	case LUA_TBOOLEAN:
		key.rank = KEY_BOOLEAN;
		key.integer = lua_toboolean(L, index);
		break;
	case LUA_TUSERDATA: /* bodies and materials have numbers; `__order` tells them apart */
		if (luaL_getmetafield(L, index, "__order") == LUA_TNUMBER) {
			int number;
			memcpy(&number, lua_touserdata(L, index), sizeof number);
			key.rank = KEY_OBJECT;
			key.integer = lua_tointeger(L, -1) * ((lua_Integer)1 << 32) + number;
			lua_pop(L, 1);
		}
		break;
	default:
		break;
	}
	return key;
}

/* -1, 0, 1; a total order of all keys but KEY_OTHER. Texts by their bytes, not by the locale. */
static int compare_keys(const struct key *a, const struct key *b)
{
	if (a->rank != b->rank)
		return a->rank < b->rank ? -1 : 1;
	if (a->rank == KEY_TEXT) {
		const int order = memcmp(a->text, b->text, a->size < b->size ? a->size : b->size);
		return order != 0 ? order : (a->size > b->size) - (a->size < b->size);
	}
	if (a->rank == KEY_NUMBER)
		return (a->number > b->number) - (a->number < b->number);
	return (a->integer > b->integer) - (a->integer < b->integer);
}

static void sift(struct key *keys, size_t top, size_t count)
{
	for (size_t child = 2 * top + 1; child < count; child = 2 * top + 1) {
		if (child + 1 < count && compare_keys(&keys[child], &keys[child + 1]) < 0)
			child++;
		if (compare_keys(&keys[top], &keys[child]) >= 0)
			return;
		const struct key swap = keys[top];
		keys[top] = keys[child];
		keys[child] = swap;
		top = child;
	}
}

/* In place, without memory of its own that a jump would leave; sorted keys cost one pass. */
static void sort_keys(struct key *keys, size_t count)
{
	bool sorted = true;

	for (size_t i = 1; i < count && sorted; i++)
		sorted = compare_keys(&keys[i - 1], &keys[i]) < 0;
	if (sorted)
		return;
	for (size_t i = count / 2; i-- > 0;)
		sift(keys, i, count);
	for (size_t end = count; end-- > 1;) {
		const struct key swap = keys[0];
		keys[0] = keys[end];
		keys[end] = swap;
		sift(keys, 0, end);
	}
}

static void push_key(lua_State *L, const struct key *key, int list)
{
	if (key->rank == KEY_INTEGER)
		lua_pushinteger(L, key->integer);
	else if (key->rank == KEY_NUMBER)
		lua_pushnumber(L, key->number);
	else if (key->rank == KEY_TEXT)
		lua_pushlstring(L, key->text, key->size);
	else if (key->rank == KEY_OBJECT)
		lua_rawgeti(L, list, key->place);
	else
		lua_pushboolean(L, (int)key->integer);
}

static int no_order(lua_State *L)
{
	return luaL_error(L, "pairs: a table with two keys or more that are tables or functions "
	                     "has no order that holds "
	                     "from run to run: keep a list beside it");
}

/*
 * Iterator of pairs: upvalues the sorted keys, how many, where it is, and the one key without an
 * order.
 */
static int pairs_step(lua_State *L)
{
	const struct key *keys = lua_touserdata(L, lua_upvalueindex(1));
	const lua_Integer count = lua_tointeger(L, lua_upvalueindex(2));
	lua_Integer at = lua_tointeger(L, lua_upvalueindex(3));

	lua_settop(L, 1);
	lua_getiuservalue(L, lua_upvalueindex(1), 1);
	for (; at <= count; at++) {
		if (at < count)
			push_key(L, &keys[at], 2);
		else
			lua_pushvalue(L, lua_upvalueindex(4));
		if (lua_isnil(L, -1))
			break;
		lua_pushvalue(L, -1);
		/* a key that was removed in the meantime is passed over */
		if (lua_rawget(L, 1) != LUA_TNIL) {
			lua_pushinteger(L, at + 1);
			lua_replace(L, lua_upvalueindex(3));
			return 2;
		}
		lua_settop(L, 2);
	}
	lua_pushinteger(L, count + 1);
	lua_replace(L, lua_upvalueindex(3));
	lua_pushnil(L);
	return 1;
}

static int l_pairs(lua_State *L)
{
	luaL_checkany(L, 1);
	if (luaL_getmetafield(L, 1, "__pairs") != LUA_TNIL) {
		lua_pushvalue(L, 1);
		lua_call(L, 1, 3);
		return 3;
	}
	luaL_checktype(L, 1, LUA_TTABLE);
	lua_settop(L, 1);

	size_t count = 0;
	for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
		count++;
	rb_sandbox_charge(L, 10 * count);
	struct key *keys = lua_newuserdatauv(L, (count ? count : 1) * sizeof *keys, 1);
	lua_pushnil(L); /* 3: the one without an order */
	lua_createtable(L, 0,
	                0); /* 4: texts and objects, which must live as long as the iterator */
	size_t filled = 0;
	lua_Integer kept = 0;
	for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) {
		struct key key = key_at(L, -2);
		if (key.rank == KEY_OTHER) {
			if (!lua_isnil(L, 3))
				return no_order(L);
			lua_pushvalue(L, -2);
			lua_replace(L, 3);
			continue;
		}
		if (key.rank == KEY_TEXT || key.rank == KEY_OBJECT) {
			lua_pushvalue(L, -2);
			lua_rawseti(L, 4, ++kept);
			key.place = kept;
		}
		keys[filled++] = key;
	}
	sort_keys(keys, filled);
	lua_setiuservalue(L, 2, 1);
	lua_pushinteger(L, (lua_Integer)filled);
	lua_insert(L, 3);
	lua_pushinteger(L, 0);
	lua_insert(L, 4);
	lua_pushcclosure(L, pairs_step, 4);
	lua_pushvalue(L, 1);
	lua_pushnil(L);
	return 3;
}

/* The smallest key above the one given, by looking at all: linear, and charged as such. */
static int l_next(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	lua_settop(L, 2);
	const bool first = lua_isnil(L, 2);
	const struct key after = key_at(L, 2);
	struct key best = {0};
	bool found = false;
	uint64_t count = 0;

	lua_pushnil(L); /* 3: best */
	for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) {
		const struct key key = key_at(L, -2);
		count++;
		if (key.rank == KEY_OTHER && !first && after.rank == KEY_OTHER) {
			if (!lua_rawequal(L, -2, 2))
				return no_order(L);
			continue;
		}
		if (!first && compare_keys(&key, &after) <= 0)
			continue;
		if (found && key.rank == KEY_OTHER && best.rank == KEY_OTHER)
			return no_order(L);
		if (!found || compare_keys(&key, &best) < 0) {
			best = key;
			found = true;
			lua_pushvalue(L, -2);
			lua_replace(L, 3);
		}
	}
	rb_sandbox_charge(L, 8 * count);
	lua_settop(L, 3);
	if (!found)
		return 1;
	lua_pushvalue(L, 3);
	lua_rawget(L, 1);
	return 2;
}

/* ---- random numbers ---- */

static uint64_t random_bits(lua_State *L)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	sandbox->random_used = true;
	return rb_random_bits(sandbox->seed, sandbox->stream, sandbox->index++);
}

/* Uniform in [0, span] by rejection under the smallest mask that covers it: < 2 tries. */
static uint64_t random_below(lua_State *L, uint64_t span)
{
	uint64_t mask = span;

	for (int shift = 1; shift < 64; shift *= 2)
		mask |= mask >> shift;
	for (;;) {
		const uint64_t value = random_bits(L) & mask;
		if (value <= span)
			return value;
	}
}

static int l_random(lua_State *L)
{
	lua_Integer low = 1, high;

	switch (lua_gettop(L)) {
	case 0:
		lua_pushnumber(L, (lua_Number)(random_bits(L) >> 11) * 0x1p-53);
		return 1;
	case 1:
		high = luaL_checkinteger(L, 1);
		if (high == 0) {
			lua_pushinteger(L, (lua_Integer)random_bits(L));
			return 1;
		}
		break;
	case 2:
		low = luaL_checkinteger(L, 1);
		high = luaL_checkinteger(L, 2);
		break;
	default:
		return luaL_error(L, "wrong number of arguments");
	}
	luaL_argcheck(L, low <= high, lua_gettop(L), "interval is empty");
	const uint64_t offset = random_below(L, (uint64_t)high - (uint64_t)low);
	lua_pushinteger(L, (lua_Integer)((uint64_t)low + offset));
	return 1;
}

static int l_randomseed(lua_State *L)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);
	const lua_Number value = luaL_checknumber(L, 1);
	uint64_t bits;

	/* 1 and 1.0 are one stream */
	int is_whole;
	lua_pushnumber(L, value);
	const lua_Integer whole = lua_tointegerx(L, -1, &is_whole);
	if (is_whole)
		bits = (uint64_t)whole;
	else
		memcpy(&bits, &value, sizeof bits);
	sandbox->stream = rb_hash_mix(bits + 0x9e3779b97f4a7c15u);
	sandbox->index = 0;
	return 0;
}

/* ---- guards ---- */

static int l_setmetatable(lua_State *L)
{
	const int type = lua_type(L, 2);

	luaL_checktype(L, 1, LUA_TTABLE);
	luaL_argcheck(L, type == LUA_TNIL || type == LUA_TTABLE, 2, "nil or table expected");
	if (type == LUA_TTABLE && !rb_sandbox_of(L)->trust) {
		lua_pushliteral(L, "__gc");
		if (lua_rawget(L, 2) != LUA_TNIL)
			return luaL_error(L, "setmetatable: no '__gc' in a scene: when it would "
			                     "run is nobody's choice");
	}
	if (luaL_getmetafield(L, 1, "__metatable") != LUA_TNIL)
		return luaL_error(L, "cannot change a protected metatable");
	lua_settop(L, 2);
	lua_setmetatable(L, 1);
	return 1;
}

/*
 * Calls the original (upvalue 1, named by upvalue 2) after charging for what it goes through. The
 * position in a message of its own would be that of this function, which has none: it is put in
 * here.
 */
static int metered(lua_State *L)
{
	const int count = lua_gettop(L);
	uint64_t work = 8;

	for (int i = 1; i <= count; i++) {
		const int type = lua_type(L, i);
		if (type == LUA_TSTRING)
			work += lua_rawlen(L, i) / 16;
		else if (type == LUA_TTABLE)
			work += 4 * lua_rawlen(L, i);
		if (type == LUA_TTABLE && luaL_getmetafield(L, i, "__len") != LUA_TNIL)
			return luaL_error(L, "%s: a table with '__len' is not accepted",
			                  lua_tostring(L, lua_upvalueindex(2)));
	}
	rb_sandbox_charge(L, work);
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	if (lua_pcall(L, count, LUA_MULTRET, 0) == LUA_OK)
		return lua_gettop(L);
	const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
	if (text && strcmp(text, "not enough memory") != 0 &&
	    (strncmp(text, "bad argument", 12) == 0 || !strchr(text, ':'))) {
		luaL_where(L, 1);
		lua_pushstring(L, luaL_gsub(L, text, "to '?'",
		                            lua_pushfstring(L, "to '%s'",
		                                            lua_tostring(L, lua_upvalueindex(2)))));
		lua_pushfstring(L, "%s%s", lua_tostring(L, -4), lua_tostring(L, -1));
	}
	return lua_error(L);
}

static int l_move(lua_State *L)
{
	const lua_Integer first = luaL_checkinteger(L, 2), last = luaL_checkinteger(L, 3);

	luaL_checktype(L, 1, LUA_TTABLE);
	if (last >= first)
		rb_sandbox_charge(L, (uint64_t)last - (uint64_t)first);
	return metered(L);
}

/* n log n comparisons; 60 covers the logarithm of any table that fits. */
static int l_sort(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	rb_sandbox_charge(L, 60 * (uint64_t)lua_rawlen(L, 1));
	return metered(L);
}

static int l_rep(lua_State *L)
{
	size_t size, gap;

	luaL_checklstring(L, 1, &size);
	const lua_Integer times = luaL_checkinteger(L, 2);
	luaL_optlstring(L, 3, "", &gap);
	if (size == 0 && gap == 0) { /* nothing, however often */
		lua_pushliteral(L, "");
		return 1;
	}
	if (times > 0 && !rb_sandbox_of(L)->trust &&
	    (uint64_t)times > RB_SANDBOX_TEXT_BYTES / (size + gap) + 1)
		return luaL_error(L, "string.rep: a text of more than %d MiB (--trust lifts this)",
		                  RB_SANDBOX_TEXT_BYTES >> 20);
	return metered(L);
}

/* string.format: %p shows an address; %s of a table would. */
static int l_format(lua_State *L)
{
	size_t size;
	const char *format = luaL_checklstring(L, 1, &size);
	const int count = lua_gettop(L);

	for (const char *p = format, *end = format + size; p < end; p++) {
		if (*p != '%')
			continue;
		for (p++; p < end && strchr("-+ #0.123456789", *p) && *p != '\0'; p++)
			;
		if (p < end && *p == 'p')
			return luaL_error(L, "string.format: no '%%p' in a scene: addresses differ "
			                     "from run to run");
	}
	for (int i = 2; i <= count; i++) {
		const int type = lua_type(L, i);
		if (type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA ||
		    type == LUA_TTHREAD) {
			rb_library_text(L, i, NULL);
			lua_replace(L, i);
		}
	}
	return metered(L);
}

/* ---- coroutines and xpcall ----
 *
 * Lua runs no hooks while a hook runs, and an error that the count hook raises leaves them off
 * until a protected call has unwound. Three things of the standard library let a script run before
 * that: the message handler of xpcall, and the closing of a coroutine that died of an error, by
 * coroutine.close and by coroutine.wrap. With a loop in the right place each would run for ever, so
 * they are done here in another way: the handler is called after unwinding, and the to-be-closed
 * variables of a coroutine that died are left alone.
 */

/* The end of xpcall, also after a yield: calls the handler after the error has unwound. */
static int finish_xpcall(lua_State *L, int status, lua_KContext context)
{
	(void)context;
	if (status == LUA_OK || status == LUA_YIELD) {
		lua_pushboolean(L, 1);
		lua_replace(L, 1);
		return lua_gettop(L);
	}
	/* 1: handler, top: error */
	lua_pushvalue(L, 1);
	lua_insert(L, -2);
	lua_call(L, 1, 1);
	lua_pushboolean(L, 0);
	lua_insert(L, -2);
	return 2;
}

static int l_xpcall(lua_State *L)
{
	luaL_checkany(L, 1);
	luaL_checktype(L, 2, LUA_TFUNCTION);
	/* handler, function, arguments */
	lua_pushvalue(L, 1);
	lua_pushvalue(L, 2);
	lua_replace(L, 1);
	lua_replace(L, 2);
	const int status = lua_pcallk(L, lua_gettop(L) - 2, LUA_MULTRET, 0, 0, finish_xpcall);
	return finish_xpcall(L, status, 0);
}

static lua_State *checked_coroutine(lua_State *L)
{
	lua_State *co = lua_tothread(L, 1);

	luaL_argexpected(L, co, 1, "coroutine");
	return co;
}

/*
 * Pushes a new coroutine. It counts its instructions by itself, from the start: the part below one
 * count is charged here.
 */
static lua_State *new_coroutine(lua_State *L)
{
	rb_sandbox_charge(L, 4000);
	luaL_checktype(L, 1, LUA_TFUNCTION);
	lua_State *co = lua_newthread(L);
	lua_pushvalue(L, 1);
	lua_xmove(L, co, 1);
	return co;
}

static int l_create(lua_State *L)
{
	new_coroutine(L);
	return 1;
}

static int wrapped(lua_State *L)
{
	lua_State *co = lua_tothread(L, lua_upvalueindex(1));
	struct rb_sandbox *const sandbox = rb_sandbox_of(L);
	const int count = lua_gettop(L);
	int results = 0;

	lua_Debug activation;
	if (lua_status(co) == LUA_OK &&
	    lua_getstack(co, 0, &activation)) /* it runs, and asks for itself */
		return luaL_error(L, "cannot resume non-suspended coroutine");
	if (lua_status(co) != LUA_YIELD && (lua_status(co) != LUA_OK || lua_gettop(co) == 0))
		return luaL_error(L, "cannot resume dead coroutine");
	if (!lua_checkstack(co, count))
		return luaL_error(L, "too many arguments to resume");
	lua_xmove(L, co, count);
	sandbox->overtime.running = co;
	const int status = lua_resume(co, L, count, &results);
	sandbox->overtime.running = L;
	if (status == LUA_OK || status == LUA_YIELD) {
		luaL_checkstack(L, results, "too many results to resume");
		lua_xmove(co, L, results);
		return results;
	}
	lua_xmove(co, L, 1);
	return lua_error(L);
}

static int l_wrap(lua_State *L)
{
	new_coroutine(L);
	lua_pushcclosure(L, wrapped, 1);
	return 1;
}

static int l_resume(lua_State *L)
{
	struct rb_sandbox *const sandbox = rb_sandbox_of(L);
	lua_State *const co = checked_coroutine(L);

	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	sandbox->overtime.running = co;
	const int status = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0);
	sandbox->overtime.running = L;
	return status == LUA_OK ? lua_gettop(L) : lua_error(L);
}

/*
 * Each level may hold Lua's own 200 nested calls, some kilobytes each: far below a stack of 8 MB.
 */
enum { CLOSING_MAX = 8 };

static int l_close(lua_State *L)
{
	lua_State *co = checked_coroutine(L);

	if (lua_status(co) != LUA_OK && lua_status(co) != LUA_YIELD) {
		lua_pushboolean(L, 0);
		lua_pushliteral(L, "died of an error");
		return 2;
	}
	/*
	 * Lua counts nested calls anew where one coroutine closes another: C's stack would end
	 * first
	 */
	struct rb_sandbox *const sandbox = rb_sandbox_of(L);
	if (sandbox->closing >= CLOSING_MAX)
		return luaL_error(L, "coroutines are closed in each other more than %d deep",
		                  CLOSING_MAX);
	lua_settop(L, 1);
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	sandbox->closing++;
	sandbox->overtime.running = co;
	const int status = lua_pcall(L, 1, LUA_MULTRET, 0);
	sandbox->overtime.running = L;
	sandbox->closing--;
	return status == LUA_OK ? lua_gettop(L) : lua_error(L);
}

/* ---- putting it together ---- */

/* Puts `wrapper` around field `name` of the table on top of the stack. */
static void wrap(lua_State *L, const char *name, lua_CFunction wrapper)
{
	lua_getfield(L, -1, name);
	lua_pushstring(L, name);
	lua_pushcclosure(L, wrapper, 2);
	lua_setfield(L, -2, name);
}

static void drop(lua_State *L, const char *const *names)
{
	for (; *names; names++) {
		lua_pushnil(L);
		lua_setfield(L, -2, *names);
	}
}

static void open_sandboxed(lua_State *L)
{
	static const char *const not_basic[] = {"collectgarbage", "dofile", "load", "loadfile",
	                                        "require",        "warn",   NULL};
	static const char *const not_string[] = {"dump", NULL};
	static const struct {
		const char *name;
		lua_CFunction open;
	} libraries[] = {{LUA_GNAME, luaopen_base},        {LUA_MATHLIBNAME, luaopen_math},
	                 {LUA_STRLIBNAME, luaopen_string}, {LUA_TABLIBNAME, luaopen_table},
	                 {LUA_UTF8LIBNAME, luaopen_utf8},  {LUA_COLIBNAME, luaopen_coroutine}};

	for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++) {
		luaL_requiref(L, libraries[i].name, libraries[i].open, 1);
		lua_pop(L, 1);
	}
	lua_pushglobaltable(L);
	drop(L, not_basic);
	lua_pop(L, 1);

	lua_getglobal(L, LUA_STRLIBNAME);
	drop(L, not_string);
	rb_strings_open(L);
	wrap(L, "rep", l_rep);
	wrap(L, "format", l_format);
	lua_pop(L, 1);
	/* ("").x still finds the functions; getmetatable("") does not find the table that finds
	 * them */
	lua_pushliteral(L, "");
	lua_getmetatable(L, -1);
	lua_pushliteral(L, "string");
	lua_setfield(L, -2, "__metatable");
	lua_pop(L, 2);

	lua_getglobal(L, LUA_TABLIBNAME);
	static const char *const table_functions[] = {"insert", "remove", "concat", "unpack"};
	for (size_t i = 0; i < sizeof table_functions / sizeof *table_functions; i++)
		wrap(L, table_functions[i], metered);
	wrap(L, "move", l_move);
	wrap(L, "sort", l_sort);
	lua_pop(L, 1);

	lua_getglobal(L, LUA_COLIBNAME);
	wrap(L, "close", l_close);
	wrap(L, "resume", l_resume);
	lua_pushcfunction(L, l_create);
	lua_setfield(L, -2, "create");
	lua_pushcfunction(L, l_wrap);
	lua_setfield(L, -2, "wrap");
	lua_pop(L, 1);
	lua_register(L, "xpcall", l_xpcall);
}

void rb_library_open(lua_State *L)
{
	static const luaL_Reg basic[] = {{"pairs", l_pairs},
	                                 {"next", l_next},
	                                 {"tostring", l_tostring},
	                                 {"print", l_print},
	                                 {"setmetatable", l_setmetatable},
	                                 {NULL, NULL}};

	if (rb_sandbox_of(L)->trust)
		luaL_openlibs(L);
	else
		open_sandboxed(L);
	lua_pushglobaltable(L);
	luaL_setfuncs(L, basic, 0);
	lua_pop(L, 1);
	lua_getglobal(L, LUA_MATHLIBNAME);
	lua_pushcfunction(L, l_random);
	lua_setfield(L, -2, "random");
	lua_pushcfunction(L, l_randomseed);
	lua_setfield(L, -2, "randomseed");
	lua_pop(L, 1);
}
