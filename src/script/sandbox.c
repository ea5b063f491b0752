/* SPDX-License-Identifier: MIT */
/*
 * Three budgets, each enforced where Lua can be interrupted: memory in the allocator, instructions
 * in the count hook and in rb_sandbox_charge, time in script/overtime. A budget that is used up
 * stays so until the outermost call returns, because scripts can catch errors.
 *
 * The allocator is ours for two reasons: to count, and because a state that was left by a jump
 * cannot be closed: its blocks are then freed from our own lists. Blocks up to 512 bytes come from
 * chunks with one free list for each size; they are most of what a script takes, and never given
 * back before the end.
 */
#include "script/sandbox.h"

#include <stdio.h>
#include <string.h>

#include <lauxlib.h>
#include <lualib.h>

#include "base/error.h"
#include "base/memory.h"

enum {
	/*
	 * GRAIN: bytes, the alignment that Lua's values need. CHUNK_BYTES: some hundred objects.
	 * HOOK_COUNT: instructions between two looks at the budget; its cost is then not
	 * measurable. BYTES_PER_INSTRUCTION: what allocating costs, roughly that of clearing.
	 * TRACEBACK_MAX: bytes that are kept of one.
	 */
	GRAIN = 16,
	SMALL_MAX = GRAIN * RB_SANDBOX_CLASSES,
	CHUNK_BYTES = 32768,
	HOOK_COUNT = 4000,
	BYTES_PER_INSTRUCTION = 16,
	TRACEBACK_MAX = 16000,
	BODY_BYTES =
		1024 /* of a body's keys and handle, those that wait for the collector included */
};

struct rb_sandbox_chunk {
	struct rb_sandbox_chunk *next;
	_Alignas(16) unsigned char bytes[CHUNK_BYTES];
};

/*
 * Stands before each block that is no part of a chunk: a state that was lost can't give its blocks
 * back itself.
 */
struct rb_sandbox_large {
	struct rb_sandbox_large *next, *before;
};
_Static_assert(sizeof(struct rb_sandbox_large) % GRAIN == 0, "blocks keep their alignment");

/*
 * A block of class `class`, (class + 1) * GRAIN bytes; NULL: no memory. Small blocks are cut from
 * chunks: base/memory zeroes, aligns and counts each block, which is too dear for the millions that
 * a script takes.
 */
static void *small_take(struct rb_sandbox *sandbox, size_t class)
{
	void *block = sandbox->free_list[class];

	RB_ASSERT_COSTLY(class < RB_SANDBOX_CLASSES);
	if (block) {
		memcpy(&sandbox->free_list[class], block, sizeof(void *));
		return block;
	}
	const size_t size = (class + 1) * GRAIN;
	if (!sandbox->chunks || sandbox->chunk_used + size > CHUNK_BYTES) {
		struct rb_sandbox_chunk *chunk = rb_memory_take(1, sizeof *chunk);
		if (!chunk)
			return NULL;
		chunk->next = sandbox->chunks;
		sandbox->chunks = chunk;
		sandbox->chunk_used = 0;
	}
	block = sandbox->chunks->bytes + sandbox->chunk_used;
	sandbox->chunk_used += size;
	return block;
}

/* A block of its own with a list's head before it; NULL: no memory. */
static void *large_take(struct rb_sandbox *sandbox, size_t size)
{
	struct rb_sandbox_large *head = NULL;

	if (size <= SIZE_MAX - sizeof *head)
		head = rb_memory_take(1, sizeof *head + size);
	if (!head)
		return NULL;
	head->next = sandbox->large;
	if (head->next)
		head->next->before = head;
	sandbox->large = head;
	return head + 1;
}

/* Frees a block of large_take. */
static void large_give(struct rb_sandbox *sandbox, void *block)
{
	struct rb_sandbox_large *head = (struct rb_sandbox_large *)block - 1;

	if (head->next)
		head->next->before = head->before;
	if (head->before)
		head->before->next = head->next;
	else
		sandbox->large = head->next;
	rb_memory_free(head);
}

/* A block of at least `size` bytes; NULL: no memory. */
static void *block_take(struct rb_sandbox *sandbox, size_t size)
{
	RB_ASSERT_COSTLY(size > 0);
	return size <= SMALL_MAX ? small_take(sandbox, (size - 1) / GRAIN)
	                         : large_take(sandbox, size);
}

/* Gives a block of block_take back; `size` as it was asked for. */
static void block_give(struct rb_sandbox *sandbox, void *block, size_t size)
{
	RB_ASSERT_COSTLY(block && size > 0);
	if (size > SMALL_MAX) {
		large_give(sandbox, block);
		return;
	}
	const size_t class = (size - 1) / GRAIN;
	memcpy(block, &sandbox->free_list[class], sizeof(void *));
	sandbox->free_list[class] = block;
}

static bool fits(const struct rb_sandbox *sandbox, size_t more)
{
	return more <= sandbox->bytes_max && sandbox->bytes <= sandbox->bytes_max - more;
}

/*
 * Whether the state may grow from old_size to new_size bytes; charges work for it. `text`: it is
 * for a string, which has a bound of its own.
 */
static bool within_budget(struct rb_sandbox *sandbox, size_t old_size, size_t new_size, bool text)
{
	if (new_size <= old_size || sandbox->trust)
		return true;
	sandbox->work += (new_size - old_size) / BYTES_PER_INSTRUCTION;
	if (text && new_size > RB_SANDBOX_TEXT_BYTES) {
		sandbox->spent = RB_SPENT_TEXT;
		return false;
	}
	/* Lua collects and asks again before it gives up: the verdict is made in `explain`. */
	return fits(sandbox, new_size - old_size);
}

static void count_hook(lua_State *L, lua_Debug *activation);

/*
 * Whether the state may have so many bytes on credit, of half as much as is allowed: at the next
 * instruction the hook asks for them back. What the allocator refuses has no place in the script,
 * because Lua calls nobody when it raises that error; what the hook raises has one.
 */
static bool overdraw(struct rb_sandbox *sandbox, size_t more)
{
	const size_t most = sandbox->bytes_max + sandbox->bytes_max / 2;

	if (sandbox->depth == 0 || more > most || sandbox->bytes > most - more)
		return false;
	sandbox->overdrawn = true;
	lua_sethook(sandbox->overtime.running, count_hook, LUA_MASKCOUNT, 1);
	return true;
}

/*
 * Keeps where the script was when a text was refused, for `explain`. Nothing else may be asked for
 * its place here: Lua may be amid moving its stack.
 */
static void keep_place(struct rb_sandbox *sandbox, bool text)
{
	lua_State *const L = sandbox->overtime.running;
	lua_Debug at;

	sandbox->place[0] = '\0';
	if (!text || sandbox->depth == 0)
		return;
	for (int level = 0; lua_getstack(L, level, &at); level++) {
		lua_getinfo(L, "Sl", &at);
		if (at.currentline > 0) {
			snprintf(sandbox->place, sizeof sandbox->place, "%s:%d: ", at.short_src,
			         at.currentline);
			return;
		}
	}
}

/* lua_Alloc. With block NULL, old_size is the kind of the object. */
static void *allocate(void *user, void *block, size_t old_size, size_t new_size)
{
	struct rb_sandbox *sandbox = user;
	const bool text = !block && old_size == LUA_TSTRING;

	if (!block)
		old_size = 0;
	if (new_size == 0) {
		if (old_size > 0)
			block_give(sandbox, block, old_size);
		sandbox->bytes -= old_size;
		return NULL;
	}
	if (!within_budget(sandbox, old_size, new_size, text) &&
	    ((text && new_size > RB_SANDBOX_TEXT_BYTES) ||
	     !overdraw(sandbox, new_size - old_size))) {
		keep_place(sandbox, text);
		return NULL;
	}
	const bool same_class = old_size > 0 && old_size <= SMALL_MAX && new_size <= SMALL_MAX &&
	                        (old_size - 1) / GRAIN == (new_size - 1) / GRAIN;
	if (!same_class) {
		void *fresh = block_take(sandbox, new_size);
		/* Lua relies on shrinking never to fail */
		if (!fresh && old_size >= new_size && old_size > SMALL_MAX && new_size > SMALL_MAX)
			fresh = block;
		if (!fresh) {
			sandbox->refused = true;
			return NULL;
		}
		if (old_size > 0 && fresh != block) {
			memcpy(fresh, block, old_size < new_size ? old_size : new_size);
			block_give(sandbox, block, old_size);
		}
		block = fresh;
	}
	sandbox->bytes += new_size - old_size;
	return block;
}

struct rb_sandbox *rb_sandbox_of(lua_State *L)
{
	struct rb_sandbox *sandbox;

	memcpy(&sandbox, lua_getextraspace(L), sizeof(void *));
	return sandbox;
}

#define MEMORY_TEXT "the script needs more than %d MiB of memory %s"
static const char lifted[] = "(--trust lifts this)";

/*
 * Raises the error of the budget that is used up. `level` of the Lua function to blame: 0 inside of
 * a hook, 1 inside of a C function.
 */
static void raise_spent(lua_State *L, int level)
{
	const struct rb_sandbox *sandbox = rb_sandbox_of(L);
	char seconds[32];

	/* each next instruction raises again, so that a pcall around this one is of no use */
	lua_sethook(L, count_hook, LUA_MASKCOUNT, 1);
	luaL_where(L, level);
	snprintf(seconds, sizeof seconds, "%.9g", rb_overtime_seconds());
	if (sandbox->spent == RB_SPENT_PATIENCE)
		lua_pushliteral(L, "the script was interrupted");
	else if (sandbox->spent == RB_SPENT_TIME)
		lua_pushfstring(L, "the script ran longer than %s seconds %s", seconds, lifted);
	else if (sandbox->spent == RB_SPENT_MEMORY)
		lua_pushfstring(L, MEMORY_TEXT, (int)(sandbox->bytes_max >> 20), lifted);
	else if (sandbox->work_max >= 1000000)
		lua_pushfstring(L, "the script ran longer than %d million instructions %s",
		                (int)(sandbox->work_max / 1000000), lifted);
	else
		lua_pushfstring(L, "the script ran longer than %d instructions %s",
		                (int)sandbox->work_max, lifted);
	lua_concat(L, 2);
	lua_error(L);
}

/* Raises the error if a budget is used up, or was before. */
static void verify(lua_State *L, int level)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	if (sandbox->trust)
		return;
	if (sandbox->spent == RB_SPENT_NOTHING || sandbox->spent == RB_SPENT_TEXT) {
		if (sandbox->stop && sandbox->stop(sandbox->stop_user))
			sandbox->spent = RB_SPENT_PATIENCE;
		else if (sandbox->work > sandbox->work_max)
			sandbox->spent = RB_SPENT_INSTRUCTIONS;
		else if (rb_overtime_is_up(&sandbox->overtime))
			sandbox->spent = RB_SPENT_TIME;
		else
			return;
	}
	raise_spent(L, level);
}

/*
 * Collects what was had on credit; raises an error if that does not suffice. A script that catches
 * it goes on: most often its memory is then free.
 */
static void pay_back(lua_State *L)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	sandbox->overdrawn = false;
	lua_sethook(L, count_hook, LUA_MASKCOUNT, HOOK_COUNT);
	lua_gc(L, LUA_GCCOLLECT, 0);
	if (fits(sandbox, 0))
		return;
	luaL_where(L, 0);
	lua_pushfstring(L, MEMORY_TEXT, (int)(sandbox->bytes_max >> 20), lifted);
	lua_concat(L, 2);
	lua_error(L);
}

/* Lua's count hook. */
static void count_hook(lua_State *L, lua_Debug *activation)
{
	(void)activation;
	rb_sandbox_of(L)->work += HOOK_COUNT;
	verify(L, 0);
	if (rb_sandbox_of(L)->overdrawn)
		pay_back(L);
}

void rb_sandbox_charge(lua_State *L, uint64_t work)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	if (__builtin_add_overflow(sandbox->work, work, &sandbox->work))
		sandbox->work = UINT64_MAX / 2;
	if (sandbox->work > sandbox->work_max || rb_overtime_is_up(&sandbox->overtime) ||
	    (sandbox->stop && sandbox->stop(sandbox->stop_user)))
		verify(L, 1);
}

uint64_t rb_sandbox_left(lua_State *L)
{
	const struct rb_sandbox *sandbox = rb_sandbox_of(L);

	if (sandbox->trust)
		return UINT64_MAX / 2;
	return sandbox->work < sandbox->work_max ? sandbox->work_max - sandbox->work : 0;
}

void rb_sandbox_charge_bytes(lua_State *L, size_t bytes)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	bool within = within_budget(sandbox, 0, bytes, false);
	if (!within && sandbox->overdrawn) { /* what is garbage does not count */
		lua_gc(L, LUA_GCCOLLECT, 0);
		within = fits(sandbox, bytes);
	}
	if (!within) {
		sandbox->spent = RB_SPENT_MEMORY;
		raise_spent(L, 1);
	}
	/* the state's own release does not give these back: they are never asked for again */
	sandbox->bytes += bytes;
}

void rb_sandbox_charge_body(lua_State *L, size_t bytes)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);
	const size_t wanted = bytes + BODY_BYTES;
	const size_t left = sandbox->bytes_most > sandbox->bytes_max
	                            ? sandbox->bytes_most - sandbox->bytes_max
	                            : 0;

	sandbox->bytes_max += wanted < left ? wanted : left;
	rb_sandbox_charge_bytes(L, bytes);
}

/* A state that finds its sandbox; NULL: no memory. */
static lua_State *new_state(struct rb_sandbox *sandbox)
{
	lua_State *L = rb_lua_new(allocate, sandbox);

	if (L)
		memcpy(lua_getextraspace(L), &sandbox, sizeof(void *));
	return L;
}

enum rb_status rb_sandbox_init(struct rb_sandbox *sandbox, size_t bytes_max, bool trust,
                               struct rb_error *err)
{
	*sandbox = (struct rb_sandbox){
		.bytes_max = bytes_max, .bytes_most = bytes_max, .trust = trust, .seed = 1};
	sandbox->work_max = rb_sandbox_load_instructions;
	sandbox->L = new_state(sandbox);
	sandbox->spare = new_state(sandbox);
	if (!sandbox->L || !sandbox->spare) {
		rb_sandbox_release(sandbox);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a Lua state");
	}
	return RB_OK;
}

/*
 * Closes a state. Finalizers (files of trusted scripts) may run here, without end if they wish: not
 * ours to stop.
 */
static void close_state(lua_State *L)
{
	if (!L)
		return;
	lua_sethook(L, NULL, 0, 0);
	lua_close(L);
}

void rb_sandbox_release(struct rb_sandbox *sandbox)
{
	close_state(sandbox->L);
	close_state(sandbox->spare);
	while (sandbox->large) /* of a state that was lost */
		large_give(sandbox, sandbox->large + 1);
	while (sandbox->chunks) {
		struct rb_sandbox_chunk *next = sandbox->chunks->next;
		rb_memory_free(sandbox->chunks);
		sandbox->chunks = next;
	}
	rb_memory_free(sandbox->traceback);
	*sandbox = (struct rb_sandbox){0};
}

/* Pushes "scene.lua:12: " of the innermost function of Lua that runs, or "". */
static void push_where(lua_State *L)
{
	lua_Debug at;

	for (int level = 0; lua_getstack(L, level, &at); level++) {
		luaL_where(L, level);
		if (lua_rawlen(L, -1) > 0)
			return;
		lua_pop(L, 1);
	}
	lua_pushliteral(L, "");
}

/*
 * Replaces an error object at index 1 that is no text by one with the place, which Lua puts
 * into texts only.
 */
static void error_to_text(lua_State *L)
{
	push_where(L);
	if (luaL_getmetafield(L, 1, "__tostring") != LUA_TNIL) {
		lua_pop(L, 1);
		luaL_tolstring(L, 1, NULL);
	} else if (lua_type(L, 1) == LUA_TNUMBER) {
		lua_pushvalue(L, 1);
		lua_tostring(L, -1);
	} else {
		lua_pushfstring(L, "(error object is a %s value)", luaL_typename(L, 1));
	}
	lua_concat(L, 2);
	lua_replace(L, 1);
}

/* Whether a function of the scene's is being called: what only C was in has no place to tell. */
static bool is_in_scene(lua_State *L)
{
	lua_Debug at;

	for (int level = 1; lua_getstack(L, level, &at); level++)
		if (lua_getinfo(L, "S", &at) && *at.what != 'C')
			return true;
	return false;
}

/*
 * Message handler: leaves the message, keeps the traceback in the registry. Without memory for it
 * there is none.
 */
static int keep_traceback(lua_State *L)
{
	if (lua_type(L, 1) != LUA_TSTRING)
		error_to_text(L);
	if (rb_sandbox_of(L)->spent != RB_SPENT_MEMORY && is_in_scene(L)) {
		luaL_traceback(L, L, lua_tostring(L, 1), 1);
		lua_setfield(L, LUA_REGISTRYINDEX, "rbsim.traceback");
	}
	return 1;
}

/* Begins the budget of an outermost call. */
static void start_budget(struct rb_sandbox *sandbox, uint64_t instructions)
{
	sandbox->work = 0;
	sandbox->work_max = instructions;
	sandbox->spent = RB_SPENT_NOTHING;
	sandbox->overtime.running = sandbox->L;
	sandbox->overtime.hook = count_hook;
	sandbox->refused = false;
	sandbox->overdrawn = false;
	sandbox->place[0] = '\0';
	rb_memory_free(sandbox->traceback);
	sandbox->traceback = NULL;
	if (!sandbox->trust)
		lua_sethook(sandbox->L, count_hook, LUA_MASKCOUNT, HOOK_COUNT);
}

/* In protected mode: takes the traceback out of the registry, cut. */
static int fetch_traceback(lua_State *L)
{
	struct rb_sandbox *sandbox = rb_sandbox_of(L);

	if (lua_getfield(L, LUA_REGISTRYINDEX, "rbsim.traceback") == LUA_TSTRING) {
		size_t size;
		const char *text = lua_tolstring(L, -1, &size);
		size = size < TRACEBACK_MAX ? size : TRACEBACK_MAX;
		rb_memory_free(sandbox->traceback);
		sandbox->traceback = rb_memory_take(size + 1, 1);
		if (sandbox->traceback)
			memcpy(sandbox->traceback, text, size);
	}
	lua_pushnil(L);
	lua_setfield(L, LUA_REGISTRYINDEX, "rbsim.traceback");
	return 0;
}

/*
 * Makes a status of Lua's error on top of the stack, which is taken off. Memory that the system
 * refused is not the scene's fault.
 */
static enum rb_status explain(struct rb_sandbox *sandbox, int status, struct rb_error *err)
{
	lua_State *L = sandbox->L;
	const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1)
	                                                  : "an error without a message";
	const bool memory = status == LUA_ERRMEM || strstr(text, "not enough memory");
	enum rb_status result;

	if (memory && sandbox->refused)
		result = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the scene's script");
	else if (memory && sandbox->spent == RB_SPENT_TEXT)
		result = RB_FAIL(err, RB_ERR_SCENE,
		                 "%sthe script makes a text of more than %d MiB %s", sandbox->place,
		                 RB_SANDBOX_TEXT_BYTES >> 20, lifted);
	else if (memory)
		result = RB_FAIL(err, RB_ERR_SCENE, "%s" MEMORY_TEXT, sandbox->place,
		                 (int)(sandbox->bytes_max >> 20), lifted);
	else
		result = RB_FAIL(err, RB_ERR_SCENE, "%s", text);
	lua_pop(L, 1);
	return result;
}

/* In protected mode: raises the message of the budget that is used up. */
static int spent_text(lua_State *L)
{
	raise_spent(L, 1);
	return 0;
}

enum { STATUS_LOST = -1 };

/* lua_pcall, out of which script/overtime may jump: STATUS_LOST. */
static int timed_call(struct rb_sandbox *sandbox, int argument_count, int result_count, int handler)
{
	if (sigsetjmp(sandbox->overtime.way_out, 0) != 0)
		return STATUS_LOST;
	rb_overtime_begin(&sandbox->overtime);
	const int status = lua_pcall(sandbox->L, argument_count, result_count, handler);
	rb_overtime_end();
	return status;
}

/* The state of Lua was left in the midst of something: nobody touches it again. */
static void lose(struct rb_sandbox *sandbox)
{
	sandbox->lost = true;
	sandbox->L = sandbox->spare;
	sandbox->spare = NULL;
	sandbox->depth = sandbox->closing = 0;
	sandbox->work_max = UINT64_MAX;
}

/* Fails every call after the state was lost. */
static enum rb_status refuse_lost(struct rb_sandbox *sandbox, struct rb_error *err)
{
	lua_settop(sandbox->L, 0);
	return RB_FAIL(
		err, RB_ERR_SCENE,
		"the script ran longer than %.9g seconds within one operation (--trust lifts this)",
		rb_overtime_seconds());
}

enum rb_status rb_sandbox_call(struct rb_sandbox *sandbox, int argument_count, int result_count,
                               uint64_t instructions, struct rb_error *err)
{
	lua_State *L = sandbox->L;
	const int base = lua_gettop(L) - argument_count;
	const bool outermost = sandbox->depth == 0, timed = outermost && !sandbox->trust;

	RB_ASSERT(argument_count >= 0 && result_count >= 0);
	RB_ASSERT(sandbox->depth >= 0);
	if (sandbox->lost)
		return refuse_lost(sandbox, err);
	if (timed && rb_overtime_prepare(err) != RB_OK) {
		lua_settop(L, base - 1);
		return RB_ERR_IO;
	}
	sandbox->depth++;
	if (outermost)
		start_budget(sandbox, instructions);
	lua_pushcfunction(L, keep_traceback); /* allocates nothing: a light function */
	lua_insert(L, base);
	const int status = timed ? timed_call(sandbox, argument_count, result_count, base)
	                         : lua_pcall(L, argument_count, result_count, base);
	if (status == STATUS_LOST) {
		lose(sandbox);
		return refuse_lost(sandbox, err);
	}
	sandbox->depth--;
	if (outermost)
		lua_sethook(L, NULL, 0, 0);
	lua_remove(L, base);
	if (status == LUA_OK &&
	    (sandbox->spent == RB_SPENT_NOTHING || sandbox->spent == RB_SPENT_TEXT))
		return RB_OK;
	if (status == LUA_OK) { /* the error came to nothing in a coroutine or a pcall: it holds all
		                   the same */
		lua_settop(L, base - 1);
		lua_pushcfunction(L, spent_text);
		if (lua_pcall(L, 0, 1, 0) == LUA_OK)
			lua_pushnil(L); /* it raises always */
	}

	const enum rb_status result = explain(sandbox, status, err);
	if (outermost)
		sandbox->work_max = UINT64_MAX;
	lua_pushcfunction(L, fetch_traceback);
	if (lua_pcall(L, 0, 0, 0) != LUA_OK)
		lua_pop(L, 1);
	return result;
}
