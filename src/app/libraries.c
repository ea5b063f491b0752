/* SPDX-License-Identifier: MIT */
/*
 * Loads every module only to ask it for its libraries: --version then also shows what is not
 * installed, and why.
 */
#include "app/libraries.h"

#include <string.h>

#include <lua.h>

#include "base/error.h"
#include "base/visible.h"
#include "geom/hull.h"
#include "sink/module.h"

/* Bytes that a module's function may fill. */
enum { TEXT_SIZE = 512 };

/* The libraries that are linked into the program itself. */
static void print_own(FILE *out)
{
	char hull[TEXT_SIZE];

	/* "$LuaVersion: Lua 5.4.4  Copyright ...": the release, which no function of Lua tells */
	const char *const lua = strstr(lua_ident, "Lua ");
	const char *const end = lua ? strstr(lua, "  ") : NULL;
	rb_hull_library(hull, sizeof hull);
	rb_print(out, "scenes: %.*s, %s\n", end ? (int)(end - lua) : 3, end ? lua : "Lua", hull);
}

/* The line of a module; `libraries` is its function, NULL where it could not be loaded. */
static void print_module(FILE *out, const char *what, enum rb_status status,
                         const struct rb_error *err, void (*libraries)(char *out, size_t size))
{
	char text[TEXT_SIZE];

	RB_ASSERT(status || libraries);
	if (status) {
		rb_print(out, "%s: not installed (%s)\n", what, err->text);
		return;
	}
	libraries(text, sizeof text);
	rb_print(out, "%s: %s\n", what, text);
}

void rb_libraries_print(FILE *out)
{
	const struct rb_hdf5_module *hdf5;
	const struct rb_film_module *film;
	const struct rb_console_module *console;
	struct rb_error err;
	enum rb_status status;

	print_own(out);
	status = rb_module_hdf5(&hdf5, &err);
	print_module(out, "recordings", status, &err, status ? NULL : hdf5->libraries);
	status = rb_module_film(&film, &err);
	print_module(out, "films", status, &err, status ? NULL : film->libraries);
	status = rb_module_console(&console, &err);
	print_module(out, "console", status, &err, status ? NULL : console->libraries);
}
