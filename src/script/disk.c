/* SPDX-License-Identifier: MIT */
/*
 * A scene may name files, so where they are is checked twice: by the name (relative, no ".."), and
 * by the real path after all links have been followed. Reading goes through one buffer that the
 * script owns, because a Lua error may jump out of whoever uses it.
 */
#include "script/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

/*
 * 16 MiB of text is a scene of some hundred thousand bodies written out; textures are larger. Only
 * the scene itself may come through a pipe: a module that is a pipe without a writer would hang.
 */
const struct rb_disk_limit rb_disk_scene = {(size_t)16 << 20, true};
const struct rb_disk_limit rb_disk_module = {(size_t)16 << 20, false};
const struct rb_disk_limit rb_disk_texture = {(size_t)64 << 20, false};

void rb_disk_forget(struct rb_script *script)
{
	rb_memory_free(script->reading);
	script->reading = NULL;
	script->reading_size = 0;
}

/*
 * Reads all of an open file into script->reading, with a zero behind it; the size of a pipe is not
 * known beforehand.
 */
static enum rb_status read_all(struct rb_script *script, int file, const char *path,
                               size_t bytes_max, struct rb_error *err)
{
	size_t capacity = 0, used = 0;

	for (;;) {
		if (!rb_memory_reserve(&script->reading, &capacity, used + 16384, 1))
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
		const ssize_t got = read(file, script->reading + used, capacity - used - 1);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", path,
			               strerror(errno));
		if (got == 0)
			break;
		used += (size_t)got;
		if (used > bytes_max)
			return RB_FAIL(err, RB_ERR_INPUT,
			               "cannot read '%s': it has more than %zu MiB", path,
			               bytes_max >> 20);
	}
	script->reading[used] = '\0';
	script->reading_size = used;
	return RB_OK;
}

enum rb_status rb_disk_read(struct rb_script *script, const char *path,
                            const struct rb_disk_limit *limit, struct rb_error *err)
{
	struct stat status;

	rb_disk_forget(script);
	const int file = open(path, O_RDONLY | O_CLOEXEC | (limit->pipes ? 0 : O_NONBLOCK));
	if (file < 0)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", path, strerror(errno));
	enum rb_status result;
	if (fstat(file, &status) != 0)
		result = RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", path, strerror(errno));
	else if (S_ISDIR(status.st_mode))
		result = RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", path, strerror(EISDIR));
	else if (!limit->pipes && !S_ISREG(status.st_mode))
		result = RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': it is not a regular file",
		                 path);
	else
		result = read_all(script, file, path, limit->bytes_max, err);
	close(file);
	if (result != RB_OK)
		rb_disk_forget(script);
	return result;
}

bool rb_disk_path_stays(const char *path)
{
	RB_ASSERT(path != NULL);
	if (path[0] == '/' || path[0] == '\0')
		return false;
	for (const char *part = path; part; part = strchr(part, '/')) {
		part += *part == '/';
		if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == '\0'))
			return false;
	}
	return true;
}

bool rb_disk_find(const struct rb_script *script, const char *name, char path[RB_DISK_PATH_SIZE])
{
	/* as the scene's folder is named on the command line, so that messages can be clicked */
	const bool bare = name[0] == '/' || strcmp(script->folder, ".") == 0;
	char real[PATH_MAX], folder[PATH_MAX];

	if (snprintf(path, RB_DISK_PATH_SIZE, "%s%s%s", bare ? "" : script->folder, bare ? "" : "/",
	             name) >= RB_DISK_PATH_SIZE)
		return false;
	if (access(path, R_OK) != 0)
		return false;
	if (script->sandbox.trust)
		return true;
	if (!realpath(path, real) || !realpath(script->folder, folder))
		return false;
	/* "/" has no name before its slash */
	const size_t size = strcmp(folder, "/") == 0 ? 0 : strlen(folder);
	return strncmp(real, folder, size) == 0 && real[size] == '/';
}
