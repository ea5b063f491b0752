/* SPDX-License-Identifier: MIT */
/*
 * Loading runs the scene in protected mode, then checks what only the whole tells: calls that were
 * overwritten, parameters never declared, where driven bodies are. All mistakes are noted on the
 * way and one status concludes. The same way serves files that may only add cameras; the phase says
 * what is allowed.
 *
 * Lua's messages about unknown globals are the commonest error of scenes; they are completed with
 * the nearest name or advice.
 */
#include "script/load.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/log.h"
#include "base/hash.h"
#include "base/memory.h"
#include "flow/schedule.h"
#include "model/element.h"
#include "model/joint_type.h"
#include "model/shape.h"
#include "model/validate.h"
#include "script/bind.h"
#include "script/call.h"
#include "script/camera.h"
#include "script/disk.h"
#include "script/expects.h"
#include "script/files.h"
#include "script/functions.h"
#include "script/globals.h"
#include "script/hooks.h"
#include "script/joint_handles.h"
#include "script/library.h"
#include "script/measures.h"
#include "script/nearest.h"
#include "script/advice.h"
#include "script/nearest.h"
#include "script/params.h"

/*
 * Calls that a scene makes for their effect, and how each is written. A scene that assigns to such
 * a name would run without what it wanted to say. Not those whose result one might keep under
 * their own name.
 */
static const struct {
	const char *name, *written;
} calls[] = {
	{"world", "world { ... }"},
	{"record", "record { ... }"},
	{"contact_pair", "contact_pair(a, b, { ... })"},
	{"force", "force { ... }"},
	{"on_step", "on_step(function(t, dt) ... end)"},
	{"on_frame", "on_frame(function(t, k) ... end)"},
	{"on_collision", "on_collision(function(c) ... end)"},
	{"on_transition", "on_transition(function(c) ... end)"},
	{"field", "field(function(t, x, v) ... end)"},
	{"expect", "expect(text, function() ... end)"},
	{"expect_always", "expect_always(text, function() ... end)"},
	{"expect_refused", "expect_refused(status, pattern)"},
	{"reference", "reference(function(t) ... end)"},
	{"result", "result(name, function() ... end)"},
	{"probe", "probe(name, function() ... end)"},
	{"sphere", "sphere { ... }"},
	{"plane", "plane { ... }"},
	{"material", "material { ... }"},
	{"camera", "camera { ... }"},
	{"film", "film { ... }"},
	{"joint", "joint { ... }"},
	{"light", "light { ... }"},
	{"param", "param(name, default, help)"},
};
enum { CALL_COUNT = sizeof calls / sizeof *calls };

/* Number of calls: those of the table, then the force elements. */
static int call_count(void)
{
	return CALL_COUNT + rb_element_kind_count;
}

/* Name of the i-th call. */
static const char *call_name(int i)
{
	RB_ASSERT(i >= 0 && i < call_count());
	return i < CALL_COUNT ? calls[i].name : rb_element_kinds[i - CALL_COUNT]->name;
}

static const char originals_key[] = "rbsim.calls";

/* Keeps the calls as they are before the scene runs. */
static void keep_originals(lua_State *L)
{
	lua_newtable(L);
	for (int i = 0; i < call_count(); i++) {
		lua_getglobal(L, call_name(i));
		lua_rawseti(L, -2, i + 1);
	}
	lua_setfield(L, LUA_REGISTRYINDEX, originals_key);
}

/* Whether a character may be within a name of Lua. */
static bool is_word(char c)
{
	return isalnum((unsigned char)c) || c == '_';
}

/* Whether the name at `at` is defined there: `function NAME` or `NAME =`, as a global. */
static bool is_assigned_at(const char *text, const char *at, size_t size)
{
	static const char function[] = "function", local[] = "local";
	const char *before = at, *after = at + size + strspn(at + size, " \t");

	while (before > text && (before[-1] == ' ' || before[-1] == '\t'))
		before--;
	const size_t room = (size_t)(before - text);
	if (room >= sizeof function - 1 && before < at &&
	    memcmp(before - (sizeof function - 1), function, sizeof function - 1) == 0)
		return true;
	if (room >= sizeof local - 1 && before < at &&
	    memcmp(before - (sizeof local - 1), local, sizeof local - 1) == 0)
		return false;
	return after[0] == '=' && after[1] != '=';
}

/*
 * The line of a file on which a call's name is assigned to; 0: not found by looking at it. A search
 * in the text, without strings and long comments: it only makes a message better.
 */
static int assigned_line(const struct rb_source_file *file, const char *name)
{
	const size_t size = strlen(name);
	int line = 1;

	for (const char *at = file->text; *at; at++) {
		line += *at == '\n';
		const bool comment = at[0] == '-' && at[1] == '-' && at[2] != '[';
		at += comment ? strcspn(at, "\n") : 0;
		if (comment && *at == '\0')
			break;
		line += comment;
		if (!comment && strncmp(at, name, size) == 0 && !is_word(at[size]) &&
		    (at == file->text || (!is_word(at[-1]) && at[-1] != '.')) &&
		    is_assigned_at(file->text, at, size))
			return line;
	}
	return 0;
}

/*
 * In protected mode, after the script has run or has failed: notes which calls are no longer what
 * they were.
 */
static int check_originals(lua_State *L)
{
	struct rb_script *script = rb_script_of(L);

	if (lua_getfield(L, LUA_REGISTRYINDEX, originals_key) != LUA_TTABLE)
		return 0;
	lua_pushglobaltable(L);
	for (int i = 0; i < call_count(); i++) {
		const char *const name = call_name(i);

		lua_rawgeti(L, 1, i + 1);
		lua_pushstring(L, name);
		lua_rawget(L, 2);
		if (!lua_rawequal(L, -1, -2))
			rb_script_mistake(
				script,
				assigned_line(&script->scene->files[script->source_file], name),
				"'%s' is a call of the scene language: write %s%s", name,
				i < CALL_COUNT ? calls[i].written : name,
				i < CALL_COUNT ? "" : " { ... }");
		lua_pop(L, 2);
	}
	return 0;
}

/*
 * In protected mode: warns of globals with the name of a key of world { } that the call does not
 * have, which nobody reads, and of those that nothing assigns.
 */
static int warn_of_globals(lua_State *L)
{
	const struct rb_script *script = rb_script_of(L);

	lua_pushglobaltable(L);
	for (int i = 0; i < rb_rows_world.count; i++) {
		const char *key = rb_rows_world.rows[i].key;

		lua_pushstring(L, key);
		if (lua_rawget(L, 1) != LUA_TNIL && !(script->world_given & UINT64_C(1) << i))
			rb_log(RB_LOG_WARNING,
			       "%s: nothing reads the global '%s'; it is a key of world { }: world "
			       "{ %s = ... }",
			       script->source, key, key);
		lua_pop(L, 1);
	}
	rb_globals_warn(L);
	return 0;
}

/* What follows is in protected mode: it may be left by a jump, and owns nothing. */

/* In protected mode, as all that follows: it may be left by a jump, and owns nothing. */
static void run_source(lua_State *L)
{
	struct rb_script *script = rb_script_of(L);
	const struct rb_source_file *file = &script->scene->files[script->source_file];
	size_t size = file->size_bytes;
	const char *body = rb_files_body(file->text, &size);

	lua_pushfstring(L, "@%s", script->source);
	if (luaL_loadbufferx(L, body, size, lua_tostring(L, -1),
	                     script->sandbox.trust ? NULL : "t") != LUA_OK)
		lua_error(L);
	lua_call(L, 0, 0);
}

/* Opens everything that a scene finds, then runs it. */
static int run_scene(lua_State *L)
{
	rb_library_open(L);
	rb_bind_open(L);
	rb_expects_open(L);
	rb_measures_open(L);
	rb_hooks_open(L);
	rb_files_open(L);
	keep_originals(L);
	if (!rb_script_of(L)->options->files) /* that of a recording has been told before */
		rb_globals_watch(L);
	run_source(L);
	rb_functions_prepare(L);
	return 0;
}

/*
 * Runs a file that may only add cameras. Names that are taken are those of the cameras that are
 * left.
 */
static int run_cameras(lua_State *L)
{
	rb_camera_names(L);
	run_source(L);
	return 0;
}

/* A message of Lua's, and the hint that find_misspelt has for it. */
struct misspelt {
	const char *message;
	char hint[160];
};

/*
 * In protected mode: "attempt to call a nil value (global 'shpere')": advice, or the nearest of the
 * globals that could be meant.
 */
static int find_misspelt(lua_State *L)
{
	static const char mark[] = "(global '";
	struct misspelt *misspelt = lua_touserdata(L, 1);
	const char *found = strstr(misspelt->message, mark);
	char name[64];

	if (!found)
		return 0;
	found += sizeof mark - 1;
	const size_t size = strcspn(found, "'");
	if (size == 0 || size >= sizeof name)
		return 0;
	memcpy(name, found, size);
	name[size] = '\0';
	lua_pushglobaltable(L);
	lua_pushstring(L, name);
	if (lua_rawget(L, -2) != LUA_TNIL) /* spelt well, but of another type */
		return 0;
	const char *advice = rb_advice_for_global(name);
	if (advice) {
		snprintf(misspelt->hint, sizeof misspelt->hint, " (%s)", advice);
		return 0;
	}
	const int wanted = strstr(misspelt->message, "attempt to call") ? LUA_TFUNCTION
	                                                                : LUA_TTABLE;
	struct rb_nearest nearest = rb_nearest_to(name);
	lua_pushglobaltable(L);
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
		size_t candidate_size;
		if (lua_type(L, -2) != LUA_TSTRING || lua_type(L, -1) != wanted)
			continue;
		const char *candidate = lua_tolstring(L, -2, &candidate_size);
		rb_nearest_offer(&nearest, candidate, candidate_size);
	}
	char hint[96];
	snprintf(misspelt->hint, sizeof misspelt->hint, "%s", rb_nearest_hint(&nearest, hint));
	return 0;
}

/*
 * Bytes of the scene's name before the first colon of a message, where it begins with one: whole,
 * or as Lua writes what is long, "..." and its end. 0: it begins with something else.
 */
static size_t name_size(const char *text, const char *source)
{
	const bool cut = strncmp(text, "...", 3) == 0;
	const char *const name = text + (cut ? 3 : 0);

	for (const char *end = source; *end; end++) {
		const size_t size = strlen(end);
		if (strncmp(name, end, size) == 0 && name[size] == ':')
			return size + (size_t)(name - text);
		if (!cut)
			break;
	}
	return 0;
}

/* Notes a message of Lua's as a mistake like the others: it has its place in front, or none. */
static void note_error(struct rb_script *script, const struct rb_error *err)
{
	lua_State *L = script->sandbox.L;
	const char *text = err->text;
	const size_t size = name_size(text, script->source);
	struct misspelt misspelt = {.message = text};
	long line = 0;

	lua_pushcfunction(L, find_misspelt);
	lua_pushlightuserdata(L, &misspelt);
	if (lua_pcall(L, 1, 0, 0) != LUA_OK)
		lua_pop(L, 1);
	if (size > 0) {
		char *rest;
		line = strtol(text + size + 1, &rest, 10);
		if (line > 0 && line < INT_MAX && rest[0] == ':')
			text = rest + 1 + (rest[1] == ' ');
		else
			line = 0;
	}
	rb_script_mistake(script, (int)line, "%s%s", text, misspelt.hint);
}

/*
 * Whether a file is a recording or another binary that was taken for a scene; its first 512 bytes
 * show it.
 */
static bool looks_binary(const char *text, size_t size)
{
	for (size_t i = 0; i < size && i < 512; i++) {
		const unsigned char c = (unsigned char)text[i];
		if ((c < ' ' && !strchr("\t\n\v\f\r", c)) || c == '\0')
			return true;
	}
	return false;
}

/* Keeps the folder of a path, where the source looks for files. False: no memory. */
static bool set_folder(struct rb_script *script, const char *path)
{
	const char *slash = strrchr(path, '/');

	rb_memory_free(script->folder);
	script->folder = rb_memory_copy_text(slash ? path : ".");
	if (script->folder && slash) /* "/" itself stays */
		script->folder[slash == path ? 1 : slash - path] = '\0';
	return script->folder != NULL;
}

/*
 * Makes the text of a source the next of the scene's files; messages name it as its path does.
 * `what`: what it should be, for messages.
 */
static enum rb_status take_source(struct rb_script *script, const char *what, struct rb_error *err)
{
	const struct rb_script_options *options = script->options;
	const char *slash = strrchr(options->path, '/');
	char hex[65];

	script->source = rb_scene_text(script->scene, options->path);
	if (!script->source || !set_folder(script, options->path))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory",
		               options->path);

	const char *text;
	size_t size;
	if (options->files) {
		text = options->files[0].text;
		size = options->files[0].size_bytes;
	} else {
		const enum rb_status status = rb_disk_read(script, options->path, &rb_disk_scene,
		                                           err);
		if (status != RB_OK)
			return status;
		text = script->reading;
		size = script->reading_size;
		if (looks_binary(text, size)) {
			rb_disk_forget(script);
			return RB_FAIL(
				err, RB_ERR_INPUT,
				"'%s' is not a %s: it begins with bytes that are not text (a "
				"recording? see rbsim info)",
				options->path, what);
		}
	}
	rb_hash_sha256(text, size, hex);
	script->source_file = script->scene->file_count;
	const enum rb_status status = rb_scene_add_file(
		script->scene, slash ? slash + 1 : options->path, text, size, hex, err);
	rb_disk_forget(script);
	return status;
}

/*
 * Asks all motions where their bodies are at the start; a function that fails is a mistake like
 * others.
 */
static enum rb_status start_driven(struct rb_script *script)
{
	struct rb_error err;

	for (int id = 0; id < script->scene->body_count; id++) {
		if (!rb_body_is_driven(&script->scene->bodies[id]))
			continue;
		const enum rb_status status = rb_functions_start(script, id, &err);
		if (status == RB_ERR_SCENE)
			note_error(script, &err);
		else if (status != RB_OK)
			return status;
	}
	return RB_OK;
}

/*
 * Whether what a motor follows begins where the joint is at the start: at 0, to 1e-9 of the size of
 * its body, or rad.
 */
static bool begins_at_start(const struct rb_scene *scene, const struct rb_joint_def *joint,
                            double way)
{
	const bool turns = rb_joint_type(joint->kind)->linkage.coordinate == RB_COORDINATE_ANGLE;

	if (turns || joint->a < 0)
		return fabs(way) <= 1e-9;
	return fabs(way) <= 1e-9 * rb_shape_reach(scene->solids, &scene->bodies[joint->a].shape);
}

/* Asks all functions that motors follow for the start. */
static enum rb_status start_motors(struct rb_script *script)
{
	const struct rb_scene *scene = script->scene;
	struct rb_error err;
	double way[2];

	for (int k = 0; k < scene->joint_count; k++) {
		const struct rb_joint_def *joint = &scene->joints[k];

		if (joint->motor_function < 0)
			continue;
		const enum rb_status status = rb_functions_follow(script, k, 0, way, &err);
		if (status == RB_ERR_SCENE)
			note_error(script, &err);
		else if (status != RB_OK)
			return status;
		else if (!begins_at_start(scene, joint, way[0]))
			rb_script_mistake(
				script, joint->line,
				"joint%s%s%s: motor: '%s' must be 0 at t = 0, as that of the "
				"joint is at the start (got %.12g)",
				joint->name ? " '" : "", joint->name ? joint->name : "",
				joint->name ? "'" : "", rb_joint_way_name(joint->kind), way[0]);
	}
	return RB_OK;
}

/* Runs the source with a budget; what stops it becomes a mistake. */
static enum rb_status run(struct rb_script *script, lua_CFunction part, struct rb_error *err)
{
	const struct rb_script_options *options = script->options;

	lua_pushcfunction(script->sandbox.L, part);
	enum rb_status status = rb_sandbox_call(&script->sandbox, 0, 0,
	                                        options->load_instructions
	                                                ? options->load_instructions
	                                                : rb_sandbox_load_instructions,
	                                        err);
	lua_State *L = script->sandbox.L; /* may be another one now */
	rb_disk_forget(script);
	if (status != RB_OK && status != RB_ERR_SCENE)
		return status;
	lua_pushcfunction(L, check_originals);
	if (lua_pcall(L, 0, 0, 0) != LUA_OK)
		lua_pop(L, 1);
	if (status == RB_ERR_SCENE) {
		rb_globals_explain(script, err);
		note_error(script, err);
	}
	if (status != RB_OK || part != run_scene)
		return status;
	lua_pushcfunction(L, warn_of_globals);
	if (lua_pcall(L, 0, 0, 0) != LUA_OK)
		lua_pop(L, 1);
	return status;
}

/* The status of all that was noted: RB_ERR_USAGE where all is of the command line. */
static enum rb_status conclude(const struct rb_script *script, struct rb_error *err)
{
	const bool usage = script->usage_mistake_count == script->mistake_count;

	if (script->mistake_count == 0)
		return RB_OK;
	return RB_FAIL(err, usage ? RB_ERR_USAGE : RB_ERR_SCENE, "%s", script->first_mistake);
}

/*
 * Bytes that bodies may take: more than a million of them, or a quarter of a smaller machine's
 * memory.
 */
static size_t most_for_bodies(void)
{
	const size_t most = (size_t)2 << 30;
	const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
	const size_t share = pages > 0 && size > 0 ? (size_t)pages / 4 * (size_t)size : 0;

	return share < most ? share : most;
}

/* Of groups to collide with that have no body: misspelt ones let bodies fall through. */
static void warn_of_empty_groups(const struct rb_script *script)
{
	const struct rb_scene *const scene = script->scene;
	uint64_t told = 0;

	for (int i = 0; i < scene->body_count; i++)
		if (scene->bodies[i].group >= 0)
			told |= (uint64_t)1 << scene->bodies[i].group;
	for (int i = 0; i < scene->body_count; i++) {
		const uint64_t empty = scene->bodies[i].filters
		                               ? scene->bodies[i].collides_with & ~told
		                               : 0;
		char label[64], source[96];

		for (int g = 0; empty && g < scene->group_count; g++) {
			if (!(empty & (uint64_t)1 << g))
				continue;
			struct rb_nearest nearest = rb_nearest_to(scene->groups[g]);
			char hint[96];
			for (int k = 0; k < scene->body_count; k++)
				if (scene->bodies[k].group >= 0)
					rb_nearest_offer(
						&nearest, scene->groups[scene->bodies[k].group],
						strlen(scene->groups[scene->bodies[k].group]));
			rb_log(RB_LOG_WARNING,
			       "%s'%s' collides with group '%s', which has no body%s",
			       rb_scene_body_source(scene, i, source),
			       rb_scene_body_label(scene, i, label), scene->groups[g],
			       rb_nearest_hint(&nearest, hint));
		}
		told |= empty;
	}
}

/* Loads the scene of the options. */
static enum rb_status load(struct rb_script *script, struct rb_error *err)
{
	const struct rb_script_options *options = script->options;
	struct rb_scene *scene = script->scene;
	enum rb_status status = rb_scene_init(scene, err);

	if (status != RB_OK)
		return status;
	status = take_source(script, "scene", err);
	scene->file = script->source ? script->source : "";
	if (status != RB_OK)
		return status;
	const size_t bytes = options->memory_bytes ? options->memory_bytes
	                                           : rb_sandbox_memory_bytes;
	status = rb_sandbox_init(&script->sandbox, bytes, options->trust, err);
	if (status != RB_OK)
		return status;
	script->sandbox.user = script;
	if (!options->memory_bytes)
		script->sandbox.bytes_most = most_for_bodies();
	if (options->has_seed)
		script->sandbox.seed = scene->world.seed = options->seed;

	script->sandbox.stop = options->stop;
	script->sandbox.stop_user = options->stop_user;
	status = run(script, run_scene, err);
	script->sandbox.stop = NULL;
	const bool whole = status == RB_OK;
	if (status == RB_OK)
		status = start_driven(script);
	if (status == RB_OK)
		status = start_motors(script);
	if (status != RB_OK && status != RB_ERR_SCENE)
		return status;
	rb_params_check(script, whole);
	status = conclude(script, err);
	if (status != RB_OK)
		return status;
	const size_t count = scene->expect_count > 0 ? (size_t)scene->expect_count : 1;
	warn_of_empty_groups(script);
	/* what films of the recording show between frames, and their arrows */
	for (int i = 0; i < scene->camera_count && !scene->record.fields_given; i++)
		scene->record.fields |= RB_FIELD_EVENTS | rb_camera_mark_fields(&scene->cameras[i]);
	script->expects = rb_memory_take(count, sizeof *script->expects);
	if (!script->expects)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory", scene->file);
	return RB_OK;
}

/* Calls `part` with the options in place; all that is borrowed is given back. */
static enum rb_status with_options(struct rb_script *script, enum rb_script_phase phase,
                                   const struct rb_script_options *options,
                                   enum rb_status (*part)(struct rb_script *, struct rb_error *),
                                   struct rb_error *err)
{
	struct rb_error own;

	script->options = options;
	script->phase = phase;
	const enum rb_status status = part(script, err ? err : &own);
	script->phase = RB_PHASE_REST;
	script->options = NULL;
	script->mistakes = NULL;
	return status;
}

enum rb_status rb_script_load(struct rb_script **script, struct rb_scene *scene,
                              struct rb_mistakes *mistakes, const struct rb_script_options *options,
                              struct rb_error *err)
{
	*scene = (struct rb_scene){0};
	*script = rb_memory_take(1, sizeof **script);
	if (!*script)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory",
		               options->path);
	struct rb_script *it = *script;
	it->scene = scene;
	it->mistakes = mistakes;
	it->callback_instructions = options->callback_instructions
	                                    ? options->callback_instructions
	                                    : rb_sandbox_callback_instructions;
	return with_options(it, RB_PHASE_LOAD, options, load, err);
}

/* Loads the file of cameras of the options. */
static enum rb_status add_cameras(struct rb_script *script, struct rb_error *err)
{
	enum rb_status status = take_source(script, "file of cameras", err);

	if (status != RB_OK)
		return status;
	status = run(script, run_cameras, err);
	return status != RB_OK && status != RB_ERR_SCENE ? status : conclude(script, err);
}

enum rb_status rb_script_add_cameras(struct rb_script *script, const char *path,
                                     struct rb_mistakes *mistakes, struct rb_error *err)
{
	const struct rb_script_options options = {.path = path, .trust = script->sandbox.trust};
	struct rb_scene *const scene = script->scene;
	const int camera_count = scene->camera_count, film_count = scene->film_count,
		  file_count = scene->file_count;

	RB_ASSERT(script->phase == RB_PHASE_REST);
	script->mistakes = mistakes;
	script->mistake_count = script->usage_mistake_count = 0;
	script->last_mistake = 0;
	const enum rb_status status = with_options(script, RB_PHASE_ADD, &options, add_cameras,
	                                           err);
	script->source = scene->file;
	script->source_file = 0;
	scene->file_count = file_count; /* what cameras are made of is no part of the scene */
	if (status != RB_OK)
		scene->camera_count = camera_count, scene->film_count = film_count;
	return status;
}

void rb_script_destroy(struct rb_script *script)
{
	if (!script)
		return;
	rb_sandbox_release(&script->sandbox);
	rb_memory_free(script->folder);
	rb_memory_free(script->reading);
	rb_memory_free(script->expects);
	rb_memory_free(script);
}

const char *rb_script_traceback(const struct rb_script *script)
{
	return script->sandbox.traceback ? script->sandbox.traceback : "";
}

enum rb_status rb_script_check_param(const struct rb_scene *scene, const char *name,
                                     const char *text, struct rb_error *err)
{
	return rb_params_check_value(scene, name, text, err);
}

void rb_build_text(char *out, size_t size)
{
#if defined(__clang__)
	snprintf(out, size, "clang %d.%d.%d, %s", __clang_major__, __clang_minor__,
	         __clang_patchlevel__, LUA_RELEASE);
#elif defined(__GNUC__)
	snprintf(out, size, "gcc %d.%d.%d, %s", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__,
	         LUA_RELEASE);
#else
	snprintf(out, size, "%s", LUA_RELEASE);
#endif
}
