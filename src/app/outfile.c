/* SPDX-License-Identifier: MIT */
#include "app/outfile.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

static enum rb_status taken(const char *name, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it exists (--force replaces it)",
	               name);
}

enum rb_status rb_outfile_check(const char *name, bool replace, struct rb_error *err)
{
	struct stat found;

	if (stat(name, &found) != 0)
		return RB_OK; /* what else is wrong with the name shows when it is created */
	if (!S_ISREG(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is not a regular file",
		               name);
	return replace ? RB_OK : taken(name, err);
}

enum rb_status rb_outfile_open(struct rb_outfile *out, const char *name, bool replace,
                               struct rb_error *err)
{
	const size_t size = strlen(name) + 40;
	int descriptor;

	*out = (struct rb_outfile){.name = name, .replace = replace};
	const enum rb_status status = rb_outfile_check(name, replace, err);
	if (status)
		return status;
	out->partial = rb_memory_take(size, 1);
	if (!out->partial)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", name);
	snprintf(out->partial, size, "%s.partial-%ld", name, (long)getpid());
	descriptor = open(out->partial, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
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
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name, strerror(number));
}

/* A name that somebody took in the meantime is theirs. */
static int put_in_place(const struct rb_outfile *out)
{
	if (out->replace)
		return rename(out->partial, out->name);
	const int failed = renameat2(AT_FDCWD, out->partial, AT_FDCWD, out->name, RENAME_NOREPLACE);
	if (!failed || errno == EEXIST)
		return failed;
	/* not every file system can do that in one go */
	if (access(out->name, F_OK) == 0) {
		errno = EEXIST;
		return -1;
	}
	return rename(out->partial, out->name);
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
	if (!status && put_in_place(out) != 0)
		status = errno == EEXIST ? taken(out->name, err)
		                         : RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s",
		                                   out->name, strerror(errno));
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
