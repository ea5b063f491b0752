/* SPDX-License-Identifier: MIT */
/*
 * require is ours and not Lua's: modules come from the scene's folder, from the shipped helpers,
 * or, when a recording is loaded again, from the files stored in it, and from nowhere else; each
 * becomes a file of the scene. A module under way is marked in the table of modules, by which
 * circles are noticed.
 */
#include "script/files.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include <lauxlib.h>

#include "base/hash.h"
#include "base/program.h"
#include "script/call.h"
#include "script/disk.h"

enum { PATH_BYTES = RB_DISK_PATH_SIZE };

const char *rb_files_body(const char *text, size_t *size)
{
	if (*size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) {
		text += 3;
		*size -= 3;
	}
	if (*size == 0 || *text != '#')
		return text;
	const char *end = memchr(text, '\n', *size);
	if (!end)
		end = text + *size;
	*size -= (size_t)(end - text);
	return end;
}

/* ---- require ---- */

/*
 * Whether a name is words of letters, digits, '_' and '-', parted by single dots: nothing that
 * could lead out of a folder. Not as textures are called, because both are files of the scene by
 * name.
 */
static bool is_module_name(const char *name, size_t size)
{
	if (size == 0 || size > 100 || name[0] == '.' || name[size - 1] == '.')
		return false;
	for (size_t i = 0; i < size; i++) {
		const unsigned char c = (unsigned char)name[i];
		if (!(isalnum(c) && c < 128) && c != '_' && c != '-' &&
		    !(c == '.' && name[i - 1] != '.'))
			return false;
	}
	return size < 4 || strcasecmp(name + size - 4, ".png") != 0;
}

/* FOLDER/a/b.lua for "a.b"; false: too long. */
static bool module_path(char path[PATH_BYTES], const char *folder, size_t folder_size,
                        const char *name)
{
	const int size = snprintf(path, PATH_BYTES, "%.*s/%s.lua", (int)folder_size, folder, name);

	if (size < 0 || size >= PATH_BYTES)
		return false;
	for (char *c = path + folder_size; c < path + size - 4; c++)
		if (*c == '.')
			*c = '/';
	return true;
}

/* Whether there is such a module that can be read; its path. */
static bool found_in(char path[PATH_BYTES], const char *folder, size_t folder_size,
                     const char *name)
{
	return module_path(path, folder, folder_size, name) && access(path, R_OK) == 0;
}

/*
 * Finds a shipped helper: in the folders of the options, else in those of RBSIM_LUA_PATH, else
 * beside the program (build tree or installation). A user's choice is final: folders that are named
 * and do not have it are not supplemented.
 */
static bool find_shipped(const struct rb_script *script, const char *name, char path[PATH_BYTES])
{
	static const char *const beside[] = {"../lua", "../../lua", "../share/rbsim/lua"};
	const struct rb_script_options *options = script->options;
	const char *folders = getenv("RBSIM_LUA_PATH");
	char folder[PATH_BYTES];

	for (int i = 0; i < options->lua_folder_count; i++)
		if (found_in(path, options->lua_folders[i], strlen(options->lua_folders[i]), name))
			return true;
	if (options->lua_folder_count > 0)
		return false;
	while (folders && *folders) {
		const size_t size = strcspn(folders, ":");
		if (size > 0 && found_in(path, folders, size, name))
			return true;
		folders += size + (folders[size] == ':');
		if (!*folders)
			return false;
	}
	for (size_t i = 0; i < sizeof beside / sizeof *beside; i++)
		if (rb_program_beside(beside[i], folder, sizeof folder) &&
		    found_in(path, folder, strlen(folder), name))
			return true;
	return false;
}

/* Whether a name is that of a shipped helper. */
static bool is_shipped(const char *name)
{
	return strncmp(name, "rbsim.", 6) == 0;
}

/* The stored file of that name; NULL: none. The first one is the scene itself. */
static const struct rb_source_file *stored_file(const struct rb_script_options *options,
                                                const char *name)
{
	for (int i = 1; i < options->file_count; i++)
		if (strcmp(options->files[i].name, name) == 0)
			return &options->files[i];
	return NULL;
}

/*
 * Finds and reads the file of a module: its text, borrowed, and the name that messages have for it.
 * False: there is none.
 */
static bool get_module(lua_State *L, const char *name, const char **text, size_t *size,
                       char chunk[PATH_BYTES])
{
	struct rb_script *script = rb_script_of(L);
	struct rb_error err;
	char path[PATH_BYTES];

	if (script->options->files) {
		const struct rb_source_file *file = stored_file(script->options, name);
		if (!file)
			return false;
		*text = file->text;
		*size = file->size_bytes;
		snprintf(chunk, PATH_BYTES, "@%s.lua", name);
		return true;
	}
	if (is_shipped(name)) {
		if (!find_shipped(script, name, path))
			return false;
		snprintf(chunk, PATH_BYTES, "@%s", name);
	} else {
		char inside[PATH_BYTES];
		if (!module_path(inside, "", 0, name) || !rb_disk_find(script, inside + 1, path))
			return false;
		snprintf(chunk, PATH_BYTES, "@%.*s", PATH_BYTES - 2, path);
	}
	const enum rb_status status = rb_disk_read(script, path, &rb_disk_module, &err);
	if (status == RB_ERR_MEMORY)
		rb_script_need(L, status, &err);
	if (status != RB_OK)
		luaL_error(L, "require '%s': %s", name, err.text);
	*text = script->reading;
	*size = script->reading_size;
	return true;
}

/* Adds the file to the scene and pushes the module's function. */
static void load_module(lua_State *L, const char *name, const char *text, size_t size,
                        const char *chunk)
{
	struct rb_script *script = rb_script_of(L);
	struct rb_error err;
	char hex[65];

	rb_sandbox_charge_bytes(L, size + sizeof(struct rb_source_file));
	rb_hash_sha256(text, size, hex);
	rb_script_need(L, rb_scene_add_file(script->scene, name, text, size, hex, &err), &err);
	size_t body_size = size;
	const char *body = rb_files_body(text, &body_size);
	const int status = luaL_loadbufferx(L, body, body_size, chunk,
	                                    script->sandbox.trust ? NULL : "t");
	rb_disk_forget(script);
	if (status != LUA_OK)
		lua_error(L);
}

/*
 * Asks a trusted script's own require (upvalue 1) for what ours did not find, or raises an error.
 */
static int require_elsewhere(lua_State *L, const char *name)
{
	if (lua_type(L, lua_upvalueindex(1)) == LUA_TFUNCTION) {
		lua_pushvalue(L, lua_upvalueindex(1));
		lua_pushvalue(L, 1);
		lua_call(L, 1, 1);
		return 1;
	}
	if (is_shipped(name))
		return luaL_error(L, "require '%s': no such helper is shipped with rbsim", name);
	return luaL_error(L, "require '%s': there is no such file in the scene's folder", name);
}

/*
 * Pushes the table of modules that the source has, then what it has under the name at index 1;
 * returns the type of that. A file of cameras has a table of its own: what a scene has found beside
 * it is not what the file finds beside itself. Functions of both may ask later.
 */
static int push_known(lua_State *L)
{
	static const char *const tables[] = {"rbsim.modules", "rbsim.modules.added"};
	const enum rb_script_phase phase = rb_script_of(L)->phase;
	int type = LUA_TNIL;

	for (int i = phase == RB_PHASE_ADD; i < (phase == RB_PHASE_LOAD ? 1 : 2); i++) {
		lua_settop(L, 1);
		luaL_getsubtable(L, LUA_REGISTRYINDEX, tables[i]);
		lua_pushvalue(L, 1);
		type = lua_rawget(L, 2);
		if (type != LUA_TNIL)
			break;
	}
	return type;
}

static int l_require(lua_State *L)
{
	size_t name_size, size;
	const char *text;
	char chunk[PATH_BYTES], found[80];

	lua_settop(L, 1);
	if (lua_type(L, 1) != LUA_TSTRING)
		return luaL_error(L, "require: expected a name (got %s)", rb_describe(L, 1, found));
	const char *name = lua_tolstring(L, 1, &name_size);
	const int known = push_known(L);
	if (known == LUA_TLIGHTUSERDATA)
		return luaL_error(L, "require '%s': it requires itself, in a circle", name);
	if (known != LUA_TNIL)
		return 1;
	lua_pop(L, 1);
	if (!is_module_name(name, name_size)) {
		if (rb_sandbox_of(L)->trust)
			return require_elsewhere(L, name);
		return luaL_error(L,
		                  "require '%s': a name is a file beside the scene, without "
		                  "'.lua', or rbsim.NAME",
		                  name);
	}
	rb_script_while_loading(L, "require");
	if (!get_module(L, name, &text, &size, chunk))
		return require_elsewhere(L, name);
	lua_pushvalue(L, 1);
	lua_pushlightuserdata(L, L);
	lua_rawset(L, 2);
	load_module(L, name, text, size, chunk);
	lua_pushvalue(L, 1);
	lua_call(L, 1, 1);
	if (lua_isnil(L, -1)) {
		lua_pop(L, 1);
		lua_pushboolean(L, 1);
	}
	lua_pushvalue(L, 1);
	lua_pushvalue(L, -2);
	lua_rawset(L, 2);
	return 1;
}

void rb_files_open(lua_State *L)
{
	lua_pushglobaltable(L);
	lua_pushliteral(L, "require");
	lua_rawget(L, -2);
	lua_pushcclosure(L, l_require, 1);
	lua_setfield(L, -2, "require");
	lua_pop(L, 1);
}
