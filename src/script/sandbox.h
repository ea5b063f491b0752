/* SPDX-License-Identifier: MIT */
/*
 * A Lua state with a budget of memory, of instructions and of processor time.
 *
 * Budgets: every byte the state takes is counted, and what C functions work through is charged as
 * if it had been instructions (rb_sandbox_charge), because the count hook of Lua does not run
 * inside of them. A budget that is used up raises errors until the call from outside returns: a
 * script that catches one gets the next. What no error can end is left where it is, and the state
 * with it: further calls are then refused.
 *
 * Owned by one thread at a time. C functions called from Lua may be left by a jump at any call into
 * Lua: they own nothing; what must be released belongs to the state, to this struct or to the
 * scene.
 */
#ifndef RB_SCRIPT_SANDBOX_H
#define RB_SCRIPT_SANDBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lua.h>

#include <rbsim/error.h>

#include "base/field_list.h"
#include "script/overtime.h"

/* A state of any version of Lua that we know. */
static inline lua_State *rb_lua_new(lua_Alloc allocate, void *user)
{
#if LUA_VERSION_NUM >= 505
	/* the seed of tables of texts: the same in all runs */
	return lua_newstate(allocate, user, 0);
#else
	return lua_newstate(allocate, user);
#endif
}

enum rb_spent {
	RB_SPENT_NOTHING,
	RB_SPENT_INSTRUCTIONS,
	RB_SPENT_TIME,
	RB_SPENT_MEMORY,
	RB_SPENT_PATIENCE, /* of whoever stops it */
	RB_SPENT_TEXT
};

enum { RB_SANDBOX_CLASSES = 32 }; /* blocks of 16, 32, ... 512 bytes come from chunks */

/* State of math.random that a run continues from a checkpoint. */
#define RB_SANDBOX_RANDOM_FIELDS(X)                                                      \
	X(uint64_t, stream, , "", "chosen by math.randomseed, or by a camera's picture", \
	  RB_ANY_BITS)                                                                   \
	X(uint64_t, index, , "", "numbers drawn from the stream", RB_ANY_BITS)           \
	X(bool, random_used, , "", "some number was drawn", RB_FLAG)

struct rb_sandbox {
	lua_State *L; /* owned */
	/*
	 * owned: an empty one, which takes the place of one that was lost (script/overtime), so
	 * that whoever only pushes what a next call would want needs not ask
	 */
	lua_State *spare;
	bool lost;
	void *user; /* what rb_sandbox_user gives inside of C functions */
	bool trust;

	/* memory */
	size_t bytes, bytes_max;
	size_t bytes_most;           /* that bytes_max can come to by bodies */
	bool refused;                /* the system had no more: not the script's fault */
	bool overdrawn;              /* more than bytes_max was had: the hook collects it */
	char place[LUA_IDSIZE + 16]; /* "t.lua:3: " of the last text refused; "": not known */
	void *free_list[RB_SANDBOX_CLASSES];
	struct rb_sandbox_chunk *chunks; /* owned */
	struct rb_sandbox_large *large;  /* owned: blocks that are no part of a chunk */
	size_t chunk_used;

	/* work of the call that goes on */
	int closing; /* coroutines that are being closed in each other */
	int depth;   /* calls into the state that go on: a callback can lead to a further one */
	uint64_t work, work_max;
	struct rb_overtime overtime;
	enum rb_spent spent;
	bool (*stop)(void *user); /* whether to give up what goes on; NULL: never */
	void *stop_user;

	uint64_t seed; /* of math.random: number = f(seed, stream, index) */
	RB_SANDBOX_RANDOM_FIELDS(RB_FIELD_MEMBER)

	char *traceback; /* owned, NULL: none */
};

/* Defaults of rbsim-scene(5). */
static const uint64_t rb_sandbox_load_instructions = 2000000000;
static const uint64_t rb_sandbox_callback_instructions = 100000000;
static const size_t rb_sandbox_memory_bytes = (size_t)256 << 20;
enum { RB_SANDBOX_TEXT_BYTES = 16 << 20 };

/* An empty state: script/library fills it. `sandbox` must stay where it is. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_sandbox_init(struct rb_sandbox *sandbox, size_t bytes_max, bool trust,
                                          struct rb_error *err);
void rb_sandbox_release(struct rb_sandbox *sandbox); /* safe on a zeroed one */

struct rb_sandbox *rb_sandbox_of(lua_State *L);
static inline void *rb_sandbox_user(lua_State *L)
{
	return rb_sandbox_of(L)->user;
}

/*
 * Calls the function below its `argument_count` arguments on top of the stack, which takes them off
 * and pushes `result_count` results. RB_ERR_SCENE with Lua's message, RB_ERR_MEMORY; nothing is
 * then pushed and the traceback is kept. A call from within a call shares its budget.
 */
RB_CHECKED enum rb_status rb_sandbox_call(struct rb_sandbox *sandbox, int argument_count,
                                          int result_count, uint64_t instructions,
                                          struct rb_error *err);

/* Counts as so many instructions; raises a Lua error when the budget is used up. */
void rb_sandbox_charge(lua_State *L, uint64_t work);
/* What is left of the budget, in instructions. */
uint64_t rb_sandbox_left(lua_State *L);
/* Counts memory that a script makes us take outside of its state, for good; raises a Lua error
 * beyond the budget. */
void rb_sandbox_charge_bytes(lua_State *L, size_t bytes);
/*
 * The same for a body: the budget grows by what it takes, here and in the state, up to bytes_most.
 */
void rb_sandbox_charge_body(lua_State *L, size_t bytes);

#endif
