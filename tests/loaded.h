/* SPDX-License-Identifier: MIT */
/* A scene's text, loaded as if it were the file "t.lua", for the tests of what scenes write. */
#ifndef RB_TESTS_LOADED_H
#define RB_TESTS_LOADED_H

#include "support.h"

#include <rbsim/model.h>

#include "script/load.h"

/* Released with unload, whatever came of it. */
struct loaded {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_mistakes mistakes;
	struct rb_error err;
	enum rb_status status;
};

/* With up to four values as on the command line; NULL: none. */
static inline void load_with(struct loaded *it, const char *text, const char *const params[4])
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	struct rb_script_options options = {
		.path = "t.lua", .files = &file, .file_count = 1, .params = params};

	while (params && options.param_count < 4 && params[options.param_count])
		options.param_count++;
	*it = (struct loaded){0};
	it->status = rb_script_load(&it->script, &it->scene, &it->mistakes, &options, &it->err);
}

static inline void load(struct loaded *it, const char *text)
{
	load_with(it, text, NULL);
}

static inline void must_load(struct loaded *it, const char *text)
{
	load(it, text);
	if (it->status != RB_OK)
		fail_msg("'%s': %s", text, it->err.text);
}

static inline void unload(struct loaded *it)
{
	rb_script_destroy(it->script);
	rb_scene_release(&it->scene);
	rb_mistakes_release(&it->mistakes);
}

/* One mistake, with that in its text. */
static inline void assert_mistake(const char *text, const char *part)
{
	struct loaded it;

	load(&it, text);
	assert_int_equal(it.status, RB_ERR_SCENE);
	if (it.mistakes.count != 1 || !strstr(it.mistakes.line[0], part))
		fail_msg("'%s': %d mistakes, '%s' has no '%s'", text, it.mistakes.count,
		         it.mistakes.line[0], part);
	unload(&it);
}

#endif
