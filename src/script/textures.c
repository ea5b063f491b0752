/* SPDX-License-Identifier: MIT */
/*
 * A texture becomes a file of the scene, so that a recording holds it and can be filmed elsewhere.
 * Only the first bytes are looked at here: enough to refuse what is no PNG file or has more pixels
 * than any graphics library takes; decoding is left to film/, which checks everything.
 */
#include "script/textures.h"

#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "film/png.h"
#include "script/disk.h"

/* Names in a recording stay shorter than its readers take. */
enum { NAME_MAX_BYTES = 120 };

/*
 * Beginning of a PNG file: signature, length and name of the first chunk, width, height (PNG
 * specification, 5.2, 11.2.2).
 */
enum { SIGNATURE_SIZE = 8, WIDTH_AT = 16, HEIGHT_AT = 20, HEAD_SIZE = 33 };

/* Four bytes as PNG has them. */
static uint32_t big_endian(const char *bytes)
{
	uint32_t value = 0;

	for (int i = 0; i < 4; i++)
		value = value << 8 | (unsigned char)bytes[i];
	return value;
}

/* Whether the bytes begin with the signature of PNG. */
static bool is_png(const char *bytes, size_t size)
{
	return size >= SIGNATURE_SIZE && memcmp(bytes, "\x89PNG\r\n\x1a\n", SIGNATURE_SIZE) == 0;
}

/* Looks at bytes that nobody vouches for; false: a mistake was noted. */
static bool check(const struct rb_call *call, const char *key, const char *name, const char *bytes,
                  size_t size)
{
	static const char header[] = "\0\0\0\x0dIHDR";

	if (!is_png(bytes, size)) {
		rb_call_mistake(
			call,
			"'%s' must be a PNG file ('%s' is not one: it begins with other bytes)",
			key, name);
		return false;
	}
	if (size < HEAD_SIZE || memcmp(bytes + SIGNATURE_SIZE, header, sizeof header - 1) != 0) {
		rb_call_mistake(call, "'%s' must be a whole PNG file ('%s' is damaged or cut off)",
		                key, name);
		return false;
	}
	const uint32_t width = big_endian(bytes + WIDTH_AT), height = big_endian(bytes + HEIGHT_AT);
	if (width >= 1 && height >= 1 && width <= RB_TEXTURE_SIDE_MAX &&
	    height <= RB_TEXTURE_SIDE_MAX)
		return true;
	rb_call_mistake(call, "'%s' must have from 1 to %d pixels a side ('%s' has %lu x %lu)", key,
	                RB_TEXTURE_SIDE_MAX, name, (unsigned long)width, (unsigned long)height);
	return false;
}

/* The file of that name; NULL: none. The first one of a list is the scene itself. */
static const struct rb_source_file *named(const struct rb_source_file *files, int count,
                                          const char *name)
{
	for (int i = 1; i < count; i++)
		if (strcmp(files[i].name, name) == 0)
			return &files[i];
	return NULL;
}

/* Checks the bytes and copies them into the scene; false: a mistake was noted. */
static bool add(struct rb_call *call, const char *key, const char *name, const char *bytes,
                size_t size)
{
	struct rb_error err;
	char hex[65];

	rb_sandbox_charge(call->L, size / 16);
	if (!check(call, key, name, bytes, size))
		return false;
	rb_sandbox_charge_bytes(call->L, size + sizeof(struct rb_source_file));
	rb_hash_sha256(bytes, size, hex);
	rb_script_need(call->L,
	               rb_scene_add_file(call->script->scene, name, bytes, size, hex, &err), &err);
	return true;
}

/* Takes the file from those that came with a recorded scene; false: a mistake was noted. */
static bool take_stored(struct rb_call *call, const char *key, const char *name)
{
	const struct rb_script_options *options = call->script->options;
	const struct rb_source_file *file = named(options->files, options->file_count, name);

	if (file)
		return add(call, key, name, file->text, file->size_bytes);
	rb_call_mistake(call, "'%s': there is no file '%s' among those stored with the scene", key,
	                name);
	return false;
}

/* Takes the file from the scene's folder; false: a mistake was noted. */
static bool take_from_disk(struct rb_call *call, const char *key, const char *name)
{
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
	const bool right = add(call, key, name, script->reading, script->reading_size);
	rb_disk_forget(script);
	return right;
}

bool rb_texture_take(struct rb_call *call, const char *key, const char *name)
{
	const struct rb_scene *scene = call->script->scene;

	RB_ASSERT(key && name);
	if (strlen(name) > NAME_MAX_BYTES) {
		rb_call_mistake(call, "'%s' must be a path of at most %d bytes (got %zu)", key,
		                NAME_MAX_BYTES, strlen(name));
		return false;
	}
	rb_sandbox_charge(call->L, (uint64_t)scene->file_count);
	const struct rb_source_file *known = named(scene->files, scene->file_count, name);
	if (known) /* a module of such a name is no picture */
		return check(call, key, name, known->text, known->size_bytes);
	return call->script->options->files ? take_stored(call, key, name)
	                                    : take_from_disk(call, key, name);
}
