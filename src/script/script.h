/* SPDX-License-Identifier: MIT */
/* The script behind a scene, as the modules of this layer share it; everybody else sees load.h and
 * hooks.h. */
#ifndef RB_SCRIPT_SCRIPT_H
#define RB_SCRIPT_SCRIPT_H

#include <rbsim/model.h>
#include <rbsim/scene.h>
#include <rbsim/world.h>

#include "base/field_list.h"
#include "script/sandbox.h"
#include "script/types.h"

enum rb_script_phase {
	RB_PHASE_LOAD,   /* definitions are taken */
	RB_PHASE_ADD,    /* a file that may only add cameras is read */
	RB_PHASE_REST,   /* nothing is called */
	RB_PHASE_CHANGE, /* on_step, on_collision, on_transition, on_frame: bodies can be changed */
	RB_PHASE_LOOK,   /* expects and functions of time: bodies can be read */
};

/* Lists of functions, by callback. */
enum rb_callback { RB_ON_STEP, RB_ON_FRAME, RB_ON_COLLISION, RB_ON_TRANSITION, RB_CALLBACK_COUNT };

/* What is known of an expectation while the run goes on. */
#define RB_EXPECT_STATE_FIELDS(X)                                                \
	X(bool, seen, , "", "its function was called", RB_FLAG)                  \
	X(bool, failed, , "", "at failed_s, for the first time", RB_FLAG)        \
	X(bool, has_numbers, , "", "`measured` and `bound` are given", RB_FLAG)  \
	X(double, measured, , "", "by the function, in its own unit", RB_NUMBER) \
	X(double, bound, , "", "of the same", RB_NUMBER)                         \
	X(double, failed_s, , "s", "when it failed", RB_NUMBER)                  \
	X(char, message, [RB_EXPECT_MESSAGE_SIZE], "", "of the failure", RB_ANY_BITS)
struct rb_expect_state {
	RB_EXPECT_STATE_FIELDS(RB_FIELD_MEMBER)
};

/* A global that was undefined when the scene read it, while it was loaded. */
struct rb_undefined {
	char name[64], helper[80], hint[160];
	int line; /* in the scene's own file, 0: unknown */
};
enum { RB_UNDEFINED_MAX = 16 }; /* told of one scene */

struct rb_script {
	struct rb_sandbox sandbox;
	enum rb_script_phase phase;
	struct rb_scene *scene; /* borrowed: the caller's, which must stay where it is */
	struct rb_world *world; /* borrowed, while a call from outside goes on */
	/*
	 * borrowed, while a camera's function is called: what handles show; goes before the world
	 */
	const struct rb_frame *frame;
	const struct rb_model *frame_model;
	uint64_t callback_instructions;
	bool traceback_kept;
	bool has_displaced; /* in this call: see script/displaced.h */

	/* while loading */
	const char *
		/* borrowed: the file whose lines mistakes name, as it is told to the user */
		source;
	int source_file;                         /* its place in scene->files */
	struct rb_mistakes *mistakes;            /* borrowed */
	const struct rb_script_options *options; /* borrowed */
	int mistake_count, usage_mistake_count;
	uint64_t last_mistake; /* hash of its text */
	char first_mistake[1024];
	struct rb_undefined undefined[RB_UNDEFINED_MAX];
	int undefined_count;
	int world_line, record_line; /* of their only call, 0: none yet */
	uint64_t world_given;        /* bits: rows of world { } that were */
	char *folder;                /* owned: of the source, "." for the current one */
	char *reading;               /* owned: a file between disk and Lua */
	size_t reading_size;

	/* while running */
	struct rb_expect_state *expects; /* owned: [scene->expect_count] */
	int function_count;              /* stored under numbers, from 1 */
	int callback_count[RB_CALLBACK_COUNT];
	/* references in the registry */
	int field_closure, potential_closure, motion_closure, follow_closure;
};

static inline struct rb_script *rb_script_of(lua_State *L)
{
	return rb_sandbox_user(L);
}

/* Raises a Lua error for a status of ours: "not enough memory", or its text. RB_OK does nothing. */
void rb_script_need(lua_State *L, enum rb_status status, const struct rb_error *err);

/* Stores the function at `index`; its number, from 1. */
int rb_script_keep_function(lua_State *L, int index);
/* Pushes the table of all functions by number, or one of them. */
void rb_script_push_functions(lua_State *L);
void rb_script_push_function(lua_State *L, int number);

/* Raises an error where a definition, `call`, can't be taken. */
void rb_script_while_loading(lua_State *L, const char *call);

#endif
