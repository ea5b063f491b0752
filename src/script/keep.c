/* SPDX-License-Identifier: MIT */
/*
 * One format written and read by base/pack: a tag for each value, then its bytes. Tables are
 * numbered in the order in which they are met, by which shared ones and circles are found again.
 * The walk needs no memory of its own: it lives on Lua's stack and in one table, since an error may
 * jump out of it at any call.
 *
 * Loading fills the tables that the scene made for `state`, if they are plain ones: functions of
 * the scene hold them as upvalues, and must see the restored values. Bytes come from a file, so
 * every count is checked against what is left before anything is made.
 */
#include "script/keep.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/field_list.h"
#include "script/call.h"
#include "script/handles.h"
#include "script/joint_handles.h"
#include "script/vector.h"

/*
 * How deep tables may stand in each other (C's stack: some hundred bytes a level), and how long the
 * name of a value gets in a message.
 */
enum { DEPTH_MOST = 100, NAME_SIZE = 160 };

/* Kinds of values; the numbers are part of the format. */
enum tag {
	TAG_NIL,
	TAG_FALSE,
	TAG_TRUE,
	TAG_INTEGER,
	TAG_NUMBER,
	TAG_TEXT,
	TAG_TABLE,  /* a new one; it gets the next number */
	TAG_VECTOR, /* the same with the vectors' metatable */
	TAG_AGAIN,  /* the table of that number */
	TAG_BODY,
	TAG_JOINT,
	TAG_COUNT
};

/* A walk through `state`. Lives beside the protected call, owns nothing. */
struct walk {
	struct rb_pack *pack;
	size_t tables;        /* numbered so far, from 1 */
	char name[NAME_SIZE]; /* of the value at hand */
	int body_count;
};

/* ---- both ways: one byte, one number ---- */

/* One tag, both ways; an unknown one fails the pack. */
static int pack_tag(struct walk *walk, int tag)
{
	rb_pack_int(walk->pack, &tag, 0, TAG_COUNT - 1);
	return tag;
}

/* Raises an error if the pack has failed: what it reads then is nothing to go on with. */
static void need(lua_State *L, const struct walk *walk)
{
	if (walk->pack->failed)
		luaL_error(L, "the table 'state' in the checkpoint can't be right");
}

/* ---- saving ---- */

static void save_value(lua_State *L, struct walk *walk, int index, int seen, int depth);

/* Appends ".key" or "[3]" to the name at hand; returns the length before, to cut it again. */
static size_t enter(lua_State *L, struct walk *walk, int key)
{
	const size_t before = strlen(walk->name);
	char *const to = walk->name + before;
	const size_t room = sizeof walk->name - before;

	if (lua_type(L, key) == LUA_TSTRING)
		snprintf(to, room, ".%.40s", lua_tostring(L, key));
	else if (lua_isinteger(L, key))
		snprintf(to, room, "[%lld]", (long long)lua_tointeger(L, key));
	else
		snprintf(to, room, "[...]");
	return before;
}

/* Raises an error that names the value. */
static int refuse(lua_State *L, const struct walk *walk, const char *what)
{
	return luaL_error(L, "%s: %s can't be kept in a checkpoint", walk->name, what);
}

/* Saves everything but a table. */
static void save_plain(lua_State *L, struct walk *walk, int index)
{
	switch (lua_type(L, index)) {
	case LUA_TNIL:
		pack_tag(walk, TAG_NIL);
		break;
	case LUA_TBOOLEAN:
		pack_tag(walk, lua_toboolean(L, index) ? TAG_TRUE : TAG_FALSE);
		break;
	case LUA_TNUMBER:
		if (lua_isinteger(L, index)) {
			int64_t whole = lua_tointeger(L, index);
			pack_tag(walk, TAG_INTEGER);
			rb_pack_i64(walk->pack, &whole);
		} else {
			double number = lua_tonumber(L, index);
			pack_tag(walk, TAG_NUMBER);
			rb_pack_doubles(walk->pack, &number, 1);
		}
		break;
	case LUA_TSTRING: {
		size_t size;
		const char *const text = lua_tolstring(L, index, &size);
		pack_tag(walk, TAG_TEXT);
		rb_pack_count(walk->pack, &size, SIZE_MAX, 1);
		rb_pack_bytes(walk->pack, (void *)(uintptr_t)text, size);
		break;
	}
	default: {
		int id = rb_handle_id(L, index);
		const int *const joint = luaL_testudata(L, index, RB_JOINT_TYPE);
		if (joint) {
			id = *joint;
			pack_tag(walk, TAG_JOINT);
			rb_pack_int(walk->pack, &id, 0, rb_script_of(L)->scene->joint_count - 1);
			return;
		}
		if (id < 0) {
			refuse(L, walk,
			       lua_type(L, index) == LUA_TFUNCTION ? "a function"
			       : lua_type(L, index) == LUA_TTHREAD ? "a coroutine"
			                                           : "a material");
			return;
		}
		pack_tag(walk, TAG_BODY);
		rb_pack_int(walk->pack, &id, 0, walk->body_count - 1);
		break;
	}
	}
}

/* Whether a table has the vectors' metatable. */
static bool is_vector(lua_State *L, int index)
{
	if (!lua_getmetatable(L, index))
		return false;
	luaL_getmetatable(L, RB_VECTOR_TYPE);
	const bool is = lua_rawequal(L, -1, -2);
	lua_pop(L, 2);
	return is;
}

/* Saves a table that is met for the first time. */
static void save_table(lua_State *L, struct walk *walk, int index, int seen, int depth)
{
	const bool vector = is_vector(L, index);
	size_t pairs = 0, list = lua_rawlen(L, index);

	if (!vector && lua_getmetatable(L, index))
		refuse(L, walk, "a table with a metatable");
	if (depth > DEPTH_MOST)
		refuse(L, walk, "a table in more than 100 others");
	lua_pushvalue(L, index);
	lua_pushinteger(L, (lua_Integer)++walk->tables);
	lua_rawset(L, seen);
	pack_tag(walk, vector ? TAG_VECTOR : TAG_TABLE);
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
		pairs++;
	rb_pack_count(walk->pack, &pairs, SIZE_MAX, 2);
	rb_pack_count(walk->pack, &list, SIZE_MAX, 2);
	rb_sandbox_charge(L, pairs);
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
		const int key = lua_gettop(L) - 1;
		const size_t before = enter(L, walk, key);

		if (lua_type(L, key) == LUA_TTABLE)
			refuse(L, walk, "a table as a key");
		save_plain(L, walk, key);
		save_value(L, walk, key + 1, seen, depth + 1);
		walk->name[before] = '\0';
	}
}

/* Saves a value; `seen`: index of the numbers by table. */
static void save_value(lua_State *L, struct walk *walk, int index, int seen, int depth)
{
	luaL_checkstack(L, 8, "state");
	if (lua_type(L, index) != LUA_TTABLE) {
		save_plain(L, walk, index);
		return;
	}
	lua_pushvalue(L, index);
	if (lua_rawget(L, seen) == LUA_TNUMBER) {
		uint64_t number = (uint64_t)lua_tointeger(L, -1);
		pack_tag(walk, TAG_AGAIN);
		rb_pack_u64(walk->pack, &number);
		lua_pop(L, 1);
		return;
	}
	lua_pop(L, 1);
	save_table(L, walk, index, seen, depth);
}

/* In protected mode: saves the global `state`. */
static int save_state(lua_State *L)
{
	struct walk *const walk = lua_touserdata(L, 1);

	lua_settop(L, 1);
	lua_newtable(L); /* 2: seen */
	lua_getglobal(L, "state");
	save_value(L, walk, 3, 2, 0);
	return 0;
}

/* ---- loading ---- */

static void load_value(lua_State *L, struct walk *walk, int known, int old, int depth);

/* Pushes a value that is no table. */
static void load_plain(lua_State *L, struct walk *walk, int tag)
{
	struct rb_pack *const pack = walk->pack;
	int64_t whole = 0;
	double number = 0;
	size_t size = 0;
	int id = 0;

	RB_ASSERT(tag >= 0 && tag < TAG_COUNT);
	switch (tag) {
	case TAG_FALSE:
	case TAG_TRUE:
		lua_pushboolean(L, tag == TAG_TRUE);
		return;
	case TAG_INTEGER:
		rb_pack_i64(pack, &whole);
		lua_pushinteger(L, whole);
		break;
	case TAG_NUMBER:
		rb_pack_doubles(pack, &number, 1);
		lua_pushnumber(L, number);
		break;
	case TAG_TEXT:
		rb_pack_count(pack, &size, SIZE_MAX, 1);
		need(L, walk);
		lua_pushlstring(L, (const char *)pack->bytes + pack->at, size);
		pack->at += size;
		return;
	case TAG_BODY:
		rb_pack_int(pack, &id, 0, walk->body_count - 1);
		need(L, walk);
		rb_handle_push(L, id);
		return;
	case TAG_JOINT:
		rb_pack_int(pack, &id, 0, rb_script_of(L)->scene->joint_count - 1);
		need(L, walk);
		rb_joint_handle_push(L, id);
		return;
	default:
		lua_pushnil(L);
		return;
	}
	need(L, walk);
}

/*
 * Whether what the scene had at `old` is to be filled anew: a plain table that nobody has taken
 * yet.
 */
static bool can_take(lua_State *L, int known, int old)
{
	if (lua_type(L, old) != LUA_TTABLE)
		return false;
	if (lua_getmetatable(L, old)) {
		lua_pop(L, 1);
		return false;
	}
	lua_pushvalue(L, old);
	const bool taken = lua_rawget(L, known) != LUA_TNIL;
	lua_pop(L, 1);
	return !taken;
}

/* Pushes the table to fill, and makes it known: by its number, and by itself as taken. */
static void push_table(lua_State *L, struct walk *walk, bool vector, int known, int old)
{
	if (!vector && can_take(L, known, old))
		lua_pushvalue(L, old);
	else
		lua_newtable(L);
	if (vector)
		luaL_setmetatable(L, RB_VECTOR_TYPE);
	lua_pushvalue(L, -1);
	lua_rawseti(L, known, (lua_Integer)++walk->tables);
	lua_pushvalue(L, -1);
	lua_pushboolean(L, 1);
	lua_rawset(L, known);
}

/*
 * Moves all that is in the table on top to a new one, which is pushed. Two passes: a table must not
 * get new keys while it is gone through.
 */
static void empty(lua_State *L)
{
	const int table = lua_gettop(L);

	lua_newtable(L);
	for (lua_pushnil(L); lua_next(L, table);) {
		lua_pushvalue(L, -2);
		lua_insert(L, -2);
		lua_rawset(L, table + 1);
	}
	for (lua_pushnil(L); lua_next(L, table + 1); lua_pop(L, 1)) {
		lua_pushvalue(L, -2);
		lua_pushnil(L);
		lua_rawset(L, table);
	}
}

/* Raises an error unless the value on top can be a key. */
static void check_key(lua_State *L, struct walk *walk)
{
	const bool bad = lua_isnil(L, -1) || lua_type(L, -1) == LUA_TTABLE ||
	                 (lua_type(L, -1) == LUA_TNUMBER && isnan(lua_tonumber(L, -1)));

	(void)rb_pack_check(walk->pack, !bad, "a key that no table has");
	need(L, walk);
}

/* Loads a table and pushes it. */
static void load_table(lua_State *L, struct walk *walk, bool vector, int known, int old, int depth)
{
	size_t pairs = 0, list = 0;

	if (depth > DEPTH_MOST)
		rb_pack_fail(walk->pack, "tables that stand too deep");
	rb_pack_count(walk->pack, &pairs, SIZE_MAX, 2);
	rb_pack_count(walk->pack, &list, SIZE_MAX, 2);
	need(L, walk);
	rb_sandbox_charge(L, pairs);
	push_table(L, walk, vector, known, old);
	const int table = lua_gettop(L);
	empty(L); /* at table + 1 */
	for (size_t k = 0; k < pairs; k++) {
		load_plain(L, walk, pack_tag(walk, 0));
		check_key(L, walk);
		lua_pushvalue(L, -1);
		lua_rawget(L, table + 1); /* at table + 3 */
		load_value(L, walk, known, table + 3, depth + 1);
		lua_remove(L, table + 3);
		lua_rawset(L, table);
	}
	lua_settop(L, table);
}

/*
 * Loads a value and pushes it. `known`: tables by number; `old`: index of what the scene had in its
 * place.
 */
static void load_value(lua_State *L, struct walk *walk, int known, int old, int depth)
{
	uint64_t number = 0;
	const int tag = pack_tag(walk, 0);

	luaL_checkstack(L, 12, "state");
	need(L, walk);
	if (tag == TAG_TABLE || tag == TAG_VECTOR) {
		load_table(L, walk, tag == TAG_VECTOR, known, old, depth);
	} else if (tag == TAG_AGAIN) {
		rb_pack_u64(walk->pack, &number);
		(void)rb_pack_check(walk->pack, number >= 1 && number <= walk->tables,
		                    "a table that is not there");
		need(L, walk);
		lua_rawgeti(L, known, (lua_Integer)number);
	} else {
		load_plain(L, walk, tag);
	}
}

/* In protected mode: loads the global `state`. */
static int load_state(lua_State *L)
{
	struct walk *const walk = lua_touserdata(L, 1);

	lua_settop(L, 1);
	lua_newtable(L); /* 2: known */
	lua_getglobal(L, "state");
	load_value(L, walk, 2, 3, 0);
	lua_setglobal(L, "state");
	return 0;
}

/* ---- the rest ---- */

static RB_FIELDS_DEFINE(expect_state_fields, struct rb_expect_state, RB_EXPECT_STATE_FIELDS);
static RB_FIELDS_DEFINE_PART(random_fields, struct rb_sandbox, RB_SANDBOX_RANDOM_FIELDS);

/* How expect_always have gone so far, both ways. */
static void pack_expects(struct rb_expect_state *states, int count, struct rb_pack *pack)
{
	rb_fields_pack(expect_state_fields(), states, (size_t)count, NULL, pack);
	for (int i = 0; i < count; i++)
		states[i].message[sizeof states[i].message - 1] = '\0';
}

enum rb_status rb_script_pack(struct rb_script *script, struct rb_pack *pack, struct rb_error *err)
{
	static const char what[] = "what the script remembers in the checkpoint";
	struct rb_sandbox *const sandbox = &script->sandbox;
	const int count = script->scene->expect_count;
	struct walk walk = {.pack = pack, .name = "state", .body_count = script->scene->body_count};
	int expects = count;

	RB_ASSERT(script->scene && pack);
	rb_fields_pack(random_fields(), sandbox, 1, NULL, pack);
	rb_pack_int(pack, &expects, count, count);
	if (script->expects && !pack->failed)
		pack_expects(script->expects, count, pack);
	if (pack->failed)
		return rb_pack_status(pack, what, err);
	/* what it does is no random number of the run */
	const uint64_t stream = sandbox->stream, index = sandbox->index;
	lua_pushcfunction(sandbox->L, pack->loading ? load_state : save_state);
	lua_pushlightuserdata(sandbox->L, &walk);
	const enum rb_status status = rb_sandbox_call(sandbox, 1, 0, script->callback_instructions,
	                                              err);
	sandbox->stream = stream;
	sandbox->index = index;
	return pack->failed ? rb_pack_status(pack, what, err) : status;
}
