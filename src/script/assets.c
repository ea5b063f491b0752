/* SPDX-License-Identifier: MIT */
#include "script/assets.h"

#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "script/disk.h"

/* Names in a recording stay shorter than its readers take. */
enum { NAME_MAX_BYTES = 120 };

/* The file of that name; NULL: none. The first one of a list is the scene itself. */
static const struct rb_source_file *named(const struct rb_source_file *files, int count,
                                          const char *name)
{
	for (int i = 1; i < count; i++)
		if (strcmp(files[i].name, name) == 0)
			return &files[i];
	return NULL;
}

/* What a call asks for. */
struct wanted {
	struct rb_call *call;
	const char *key, *name;
	rb_asset_check *check;
};

/* Checks the bytes and copies them into the scene; false: a mistake was noted. */
static bool add(const struct wanted *wanted, const char *bytes, size_t size)
{
	struct rb_call *const call = wanted->call;
	const char *const name = wanted->name;
	struct rb_error err;
	char hex[65];

	rb_sandbox_charge(call->L, size / 16);
	if (!wanted->check(call, wanted->key, name, bytes, size))
		return false;
	rb_sandbox_charge_bytes(call->L, size + sizeof(struct rb_source_file));
	rb_hash_sha256(bytes, size, hex);
	rb_script_need(call->L,
	               rb_scene_add_file(call->script->scene, name, bytes, size, hex, &err), &err);
	return true;
}

/* Takes the file from those that came with a recorded scene; false: a mistake was noted. */
static bool take_stored(const struct wanted *wanted)
{
	const struct rb_script_options *options = wanted->call->script->options;
	const struct rb_source_file *file = named(options->files, options->file_count,
	                                          wanted->name);

	if (file)
		return add(wanted, file->text, file->size_bytes);
	rb_call_mistake(wanted->call,
	                "'%s': there is no file '%s' among those stored with the scene",
	                wanted->key, wanted->name);
	return false;
}

/* Takes the file from the scene's folder; false: a mistake was noted. */
static bool take_from_disk(const struct wanted *wanted)
{
	struct rb_call *const call = wanted->call;
	const char *const key = wanted->key, *const name = wanted->name;
	struct rb_script *script = call->script;
	char path[RB_DISK_PATH_SIZE];
	struct rb_error err;

	if (!rb_disk_find(script, name, path)) {
		rb_call_mistake(call, "'%s': there is no file '%s' in the scene's folder", key,
		                name);
		return false;
	}
	const enum rb_status status = rb_disk_read(script, path, &rb_disk_texture, &err);
	if (status == RB_ERR_MEMORY)
		rb_script_need(call->L, status, &err);
	if (status != RB_OK) {
		rb_call_mistake(call, "'%s': %s", key, err.text);
		return false;
	}
	/* a jump out of here leaves the bytes to the script, which forgets them at its end */
	const bool right = add(wanted, script->reading, script->reading_size);
	rb_disk_forget(script);
	return right;
}

const struct rb_source_file *rb_asset_take(struct rb_call *call, const char *key, const char *name,
                                           rb_asset_check *check)
{
	const struct rb_scene *scene = call->script->scene;
	const struct wanted wanted = {call, key, name, check};

	RB_ASSERT(key && name);
	if (strlen(name) > NAME_MAX_BYTES) {
		rb_call_mistake(call, "'%s' must be a path of at most %d bytes (got %zu)", key,
		                NAME_MAX_BYTES, strlen(name));
		return NULL;
	}
	rb_sandbox_charge(call->L, (uint64_t)scene->file_count);
	const struct rb_source_file *known = named(scene->files, scene->file_count, name);
	if (known) /* a module of such a name is not what is wanted */
		return check(call, key, name, known->text, known->size_bytes) ? known : NULL;
	const bool right = call->script->options->files ? take_stored(&wanted)
	                                                : take_from_disk(&wanted);
	return right ? named(scene->files, scene->file_count, name) : NULL;
}
