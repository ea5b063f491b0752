/* SPDX-License-Identifier: MIT */
#include "base/outfile.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

enum { TRIES_MAX = 100 };

static enum rb_status taken(const char *name, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it exists (--force replaces it)",
	               name);
}

static enum rb_status refused(const char *name, int number, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name, strerror(number));
}

enum rb_status rb_outfile_check(const char *name, bool replace, struct rb_error *err)
{
	struct stat found;

	if (stat(name, &found) != 0 && lstat(name, &found) == 0)
		return replace ? RB_OK
		               : taken(name, err); /* a link to nothing takes the name too */
	if (stat(name, &found) != 0)
		return RB_OK; /* what else is wrong with the name shows when it is created */
	if (!S_ISREG(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is not a regular file",
		               name);
	return replace ? RB_OK : taken(name, err);
}

/* Cuts `path` down to the folder of its last part; "" where that is the current one. */
static void cut_to_folder(char *path)
{
	char *slash = strrchr(path, '/');

	if (!slash)
		slash = path;
	while (slash > path && slash[-1] == '/')
		slash--;
	*(slash == path && *path == '/' ? path + 1 : slash) = '\0';
}

/* The first folder on the way to `path` (a folder that is not there; changed here) is made and removed again. */
static enum rb_status probe_folder(const char *name, char *path, struct rb_error *err)
{
	struct stat found;
	size_t first = 0;

	while (*path && stat(path, &found) != 0) {
		first = strlen(path);
		cut_to_folder(path);
	}
	if (*path && !S_ISDIR(found.st_mode))
		return refused(name, ENOTDIR, err);
	memcpy(path, name, first);
	path[first] = '\0';
	if (mkdir(path, 0777) != 0)
		return refused(name, errno, err);
	rmdir(path);
	return RB_OK;
}

enum rb_status rb_outfile_probe(const char *name, bool replace, struct rb_error *err)
{
	struct rb_outfile out;
	struct stat found;
	enum rb_status status = rb_outfile_check(name, replace, err);
	char *const path = status ? NULL : rb_memory_copy_text(name);

	if (status)
		return status;
	if (!path)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", name);
	cut_to_folder(path);
	if (*path && stat(path, &found) != 0) {
		status = errno == ENOENT ? probe_folder(name, path, err)
		                         : refused(name, errno, err);
	} else {
		status = rb_outfile_open(&out, name, replace, err);
		if (!status)
			rb_outfile_release(&out);
	}
	rb_memory_free(path);
	return status;
}

enum rb_status rb_outfile_folders(const char *name, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	struct stat found;
	char *const path = rb_memory_copy_text(name);

	if (!path)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", name);
	for (char *slash = strchr(path, '/'); slash && !status; slash = strchr(slash + 1, '/')) {
		if (slash == path)
			continue;
		*slash = '\0';
		if (mkdir(path, 0777) != 0) {
			const int number = errno;
			/* there already, or on the way to what can't be written to anyway */
			if (stat(path, &found) != 0)
				status = refused(path, number, err);
		}
		*slash = '/';
	}
	rb_memory_free(path);
	return status;
}

/* Another number where the same process makes two, or a dead one left its own behind. */
static int open_partial(char *partial, size_t size, const char *name)
{
	int descriptor = -1;

	for (int k = 0; k < TRIES_MAX && descriptor < 0; k++) {
		const int end = snprintf(partial, size, "%s.partial-%ld", name, (long)getpid());
		if (k > 0)
			snprintf(partial + end, size - (size_t)end, "-%d", k);
		descriptor = open(partial, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
		if (descriptor < 0 && errno != EEXIST)
			break;
	}
	return descriptor;
}

enum rb_status rb_outfile_open(struct rb_outfile *out, const char *name, bool replace,
                               struct rb_error *err)
{
	const size_t size = strlen(name) + 40;

	*out = (struct rb_outfile){.name = name, .replace = replace};
	const enum rb_status status = rb_outfile_check(name, replace, err);
	if (status)
		return status;
	out->partial = rb_memory_take(size, 1);
	if (!out->partial)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", name);
	const int descriptor = open_partial(out->partial, size, name);
	if (descriptor >= 0)
		out->file = fdopen(descriptor, "w");
	if (out->file)
		return RB_OK;
	const int number = errno;
	if (descriptor >= 0) {
		close(descriptor);
		unlink(out->partial);
	}
	rb_memory_free(out->partial);
	out->partial = NULL;
	return refused(name, number, err);
}

/* For file systems that cannot rename without replacing: a second name, then the first one goes. */
static int link_over(const char *from, const char *to)
{
	struct stat found;

	if (link(from, to) == 0) {
		unlink(from);
		return 0;
	}
	if (errno == EEXIST)
		return -1;
	/* no hard links either: the last resort has a gap between the look and the rename */
	if (lstat(to, &found) == 0) {
		errno = EEXIST;
		return -1;
	}
	return rename(from, to);
}

enum rb_status rb_outfile_place(const char *partial, const char *name, bool replace,
                                struct rb_error *err)
{
	int failed;

	if (replace) {
		failed = rename(partial, name);
	} else {
		failed = renameat2(AT_FDCWD, partial, AT_FDCWD, name, RENAME_NOREPLACE);
		if (failed && errno != EEXIST)
			failed = link_over(partial, name);
	}
	if (failed)
		return errno == EEXIST ? taken(name, err) : refused(name, errno, err);
	return RB_OK;
}

enum rb_status rb_outfile_publish(struct rb_outfile *out, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	const bool broken = ferror(out->file) != 0;

	errno = 0;
	if (fclose(out->file) != 0 || broken)
		status = RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", out->name,
		                 errno ? strerror(errno) : "an earlier write failed");
	out->file = NULL;
	if (!status)
		status = rb_outfile_place(out->partial, out->name, out->replace, err);
	if (!status) {
		rb_memory_free(out->partial);
		out->partial = NULL;
	}
	rb_outfile_release(out);
	return status;
}

void rb_outfile_release(struct rb_outfile *out)
{
	if (out->file)
		fclose(out->file);
	if (out->partial)
		unlink(out->partial);
	rb_memory_free(out->partial);
	*out = (struct rb_outfile){0};
}
