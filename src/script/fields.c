/* SPDX-License-Identifier: MIT */
/*
 * Keys are read in the order of the rows, not of the table, so that the mistakes of a call come in
 * the same order in every run. `given` and `wrong` hold one bit for each row of all tables of the
 * call, counted through.
 */
#include "script/fields.h"

#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "script/advice.h"
#include "script/nearest.h"
#include "script/values.h"

/* The key of this call that a word of another program means; NULL: none. */
static const char *synonym_of(const struct rb_call *call, const char *word)
{
	const char *key;

	for (int k = 0; (key = rb_advice_synonym(word, k)) != NULL; k++)
		if (rb_row_find(call->table, key, NULL))
			return key;
	return NULL;
}

/* A key of a table on the stack, as C reads it; NULL: it is no text, or not one that C can read. */
static const char *key_at(lua_State *L, int at)
{
	size_t size;
	const char *const key = lua_type(L, at) == LUA_TSTRING ? lua_tolstring(L, at, &size) : NULL;

	return key && size > 0 && strlen(key) == size ? key : NULL;
}

/* Whether a key on the stack is the place of one of the values before the keys. */
static bool is_value(const struct rb_call *call, int at)
{
	return lua_isinteger(call->L, at) && lua_tointeger(call->L, at) >= 1 &&
	       lua_tointeger(call->L, at) <= call->values;
}

/*
 * One bit for each row whose key the call's table has; *others: it has something else too. Calls
 * state few of their rows, and the table holds no nil.
 */
static uint64_t find_stated(const struct rb_call *call, bool *others)
{
	lua_State *L = call->L;
	uint64_t stated = 0;

	*others = false;
	for (lua_pushnil(L); lua_next(L, call->index); lua_pop(L, 1)) {
		const char *const key = key_at(L, -2);
		int index;

		if (is_value(call, -2))
			continue;
		if (!key || !rb_row_find(call->table, key, &index)) {
			*others = true;
			continue;
		}
		stated |= (uint64_t)1 << index;
	}
	return stated;
}

/*
 * Notes the keys that no row knows, in the order of their names and at most 20, and what stands
 * without a key. Each pass over the table finds the next name, which needs no memory.
 */
static void note_unknown(struct rb_call *call)
{
	lua_State *L = call->L;
	char after[64] = "", next[64];
	bool unnamed = false;

	for (int noted = 0; noted < 20; noted++) {
		next[0] = '\0';
		for (lua_pushnil(L); lua_next(L, call->index); lua_pop(L, 1)) {
			const char *const key = key_at(L, -2);

			if (!key) {
				unnamed |= !is_value(call, -2);
				continue;
			}
			if (rb_row_find(call->table, key, NULL) ||
			    strncmp(key, after, sizeof after - 1) <= 0)
				continue;
			if (next[0] == '\0' || strcmp(key, next) < 0)
				snprintf(next, sizeof next, "%s", key);
		}
		if (next[0] == '\0')
			break;
		struct rb_nearest nearest = rb_nearest_to(next);
		for (const struct rb_row_table *table = call->table; table; table = table->more)
			for (int i = 0; i < table->count; i++)
				rb_nearest_offer(&nearest, table->rows[i].key,
				                 strlen(table->rows[i].key));
		char hint[96];
		const char *const synonym = synonym_of(call, next);
		const char *advice = rb_advice_for_key(next);
		call->unknown++;
		if (synonym)
			rb_call_mistake(call, "unknown key '%s' (did you mean '%s'?)", next,
			                synonym);
		else if (advice)
			rb_call_mistake(call, "unknown key '%s' (%s)", next, advice);
		else
			rb_call_mistake(call, "unknown key '%s'%s", next,
			                rb_nearest_hint(&nearest, hint));
		memcpy(after, next, sizeof after);
	}
	if (unnamed)
		rb_call_mistake(call, "a value without a name (write key = value)");
}

void rb_call_read(struct rb_call *call, void *definition)
{
	lua_State *L = call->L;
	bool others;
	int index = 0;

	RB_ASSERT(definition != NULL);
	if (call->index == 0)
		return;
	const uint64_t stated = find_stated(call, &others);

	for (const struct rb_row_table *table = call->table; table; table = table->more) {
		for (int i = 0; i < table->count; i++, index++) {
			const struct rb_row *row = &table->rows[i];
			bool right = true;

			RB_ASSERT(index < 64);
			if (!(stated >> index & 1))
				continue;
			lua_pushstring(L, row->key);
			(void)lua_rawget(L, call->index);
			if (row->at != RB_ROW_BY_HAND)
				right = rb_call_value(call, row, -1, (char *)definition + row->at);
			*(right ? &call->given : &call->wrong) |= (uint64_t)1 << index;
			lua_pop(L, 1);
		}
	}
	if (others)
		note_unknown(call);
}

/* The bit of a key in `given` and `wrong`; 0: no row has it. */
static uint64_t bit_of(const struct rb_call *call, const char *key)
{
	int index;

	return rb_row_find(call->table, key, &index) ? (uint64_t)1 << index : 0;
}

bool rb_call_given(const struct rb_call *call, const char *key)
{
	return (call->given & bit_of(call, key)) != 0;
}

bool rb_call_tried(const struct rb_call *call, const char *key)
{
	return ((call->given | call->wrong) & bit_of(call, key)) != 0;
}

int rb_call_push(const struct rb_call *call, const char *key)
{
	if (call->index == 0) {
		lua_pushnil(call->L);
		return LUA_TNIL;
	}
	lua_pushstring(call->L, key);
	return lua_rawget(call->L, call->index);
}

int rb_call_push_list(struct rb_call *call, const char *key, const char *of, int most)
{
	lua_State *L = call->L;
	char found[80];

	if (rb_call_push(call, key) == LUA_TNIL) {
		lua_pop(L, 1);
		return -1;
	}
	const long long count = rb_list_length(L, -1);
	if (count >= 0 && count <= most)
		return (int)count;
	if (count > most)
		rb_call_mistake(call, "'%s' must be a list of at most %d %s (got %lld)", key, most,
		                of, count);
	else
		rb_call_mistake(call, "'%s' must be a list of at most %d %s (got %s)", key, most,
		                of, rb_describe(L, -1, found));
	lua_pop(L, 1);
	return -1;
}
