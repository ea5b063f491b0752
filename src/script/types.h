/* SPDX-License-Identifier: MIT */
/* What goes into the loading of a scene, and what comes out of its expectations. Plain values. */
#ifndef RB_SCRIPT_TYPES_H
#define RB_SCRIPT_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/scene.h>

/* All texts are borrowed for the time of the call. Zeroed is a good start: only `path` must be set.
 */
struct rb_script_options {
	const char *path;          /* of the scene, as named on the command line */
	const char *const *params; /* "K=V" each; of two with one name the last holds */
	int param_count;
	bool has_seed; /* then world.seed is not looked at */
	uint64_t seed;
	bool trust; /* all of Lua's libraries, no budgets */
	/*
	 * asked again and again while the script is loaded, unless it is trusted: whether to give
	 * it up, which is an error of the scene; NULL: never
	 */
	bool (*stop)(void *user);
	void *stop_user;

	/* Where `require "rbsim.NAME"` looks for rbsim/NAME.lua; none: RBSIM_LUA_PATH (folders
	 * parted by ':') if set, else ../lua, ../../lua and ../share/rbsim/lua beside the program.
	 */
	const char *const *lua_folders;
	int lua_folder_count;

	/*
	 * Stored files instead of those on disk: [0] is the scene, the others what it required and
	 * the pictures that its bodies wear. No file is then opened. NULL: files on disk.
	 */
	const struct rb_source_file *files;
	int file_count;

	/* Budgets; 0: the defaults of rbsim-scene(5). */
	uint64_t load_instructions, callback_instructions;
	size_t memory_bytes;
};

enum { RB_EXPECT_MESSAGE_SIZE = 160 };

struct rb_expect_result {
	const char *text; /* the scene's */
	int line;
	bool always, ok;
	bool has_numbers; /* the function gave measured and bound; for `always` the worst of all
	                     frames */
	double measured, bound;
	double failed_s; /* `always`: the first frame that failed; NAN: none did, or a plain expect
	                  */
	char message[RB_EXPECT_MESSAGE_SIZE]; /* why it failed, "" when ok */
};

#endif
