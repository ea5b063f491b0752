/* SPDX-License-Identifier: MIT */
#include "sink/h5output.h"

#include "base/memory.h"
#include "base/outfile.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LINKS_MAX = 40 };

static const uint64_t ahead_min = (uint64_t)1 << 20, ahead_max = (uint64_t)64 << 20;

/* `to`, seen from the folder of `path`. */
static char *beside(const char *path, const char *to)
{
	const char *slash = strrchr(path, '/');
	const size_t folder = to[0] == '/' || !slash ? 0 : (size_t)(slash - path) + 1;
	char *joined = rb_memory_take(folder + strlen(to) + 1, 1);

	if (joined) {
		memcpy(joined, path, folder);
		strcpy(joined + folder, to);
	}
	return joined;
}

/* What `name` means in the end, by the links on its last part; NULL: errno says why. */
static char *follow(const char *name)
{
	char target[4096];
	char *path = rb_memory_copy_text(name);

	for (int i = 0; path && i < LINKS_MAX; i++) {
		const ssize_t size = readlink(path, target, sizeof target - 1);
		if (size < 0)
			return path; /* not a link, or not there */
		target[size] = '\0';
		char *next = beside(path, target);
		rb_memory_free(path);
		path = next;
	}
	errno = path ? ELOOP : ENOMEM;
	rb_memory_free(path);
	return NULL;
}

static enum rb_status check_name(const struct rb_output *output, const char *name,
                                 struct rb_error *err)
{
	struct stat found;

	if (stat(output->name, &found) != 0) {
		if (errno == ENOENT)
			return RB_OK;
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name, strerror(errno));
	}
	if (S_ISDIR(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is a folder", name);
	if (!S_ISREG(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is not a regular file",
		               name);
	if (!output->replace)
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot create '%s': it exists (--force replaces it)", name);
	return RB_OK;
}

enum rb_status rb_output_open(struct rb_output *output, const char *name, bool replace,
                              struct rb_error *err)
{
	*output = (struct rb_output){.fd = -1, .replace = replace};
	errno = 0;
	output->name = follow(name);
	if (!output->name)
		return RB_FAIL(err, errno == ENOMEM ? RB_ERR_MEMORY : RB_ERR_CREATE,
		               "cannot create '%s': %s", name, strerror(errno ? errno : ENOMEM));
	const enum rb_status status = check_name(output, name, err);
	if (status) {
		rb_output_release(output);
		return status;
	}
	const size_t size = strlen(output->name) + 40;
	output->partial = rb_memory_take(size, 1);
	if (!output->partial) {
		rb_output_release(output);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", name);
	}

	/* Another number where the same process makes two, or a dead one left its own behind. */
	for (int k = 0; k < 100 && output->fd < 0; k++) {
		const int end = snprintf(output->partial, size, "%s.partial-%ld", output->name,
		                         (long)getpid());
		if (k > 0)
			snprintf(output->partial + end, size - (size_t)end, "-%d", k);
		output->fd = open(output->partial, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
		if (output->fd < 0 && errno != EEXIST)
			break;
	}
	if (output->fd < 0) {
		const int number = errno;
		rb_memory_free(output->partial);
		output->partial = NULL;
		rb_output_release(output);
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name,
		               strerror(number));
	}
	/*
	 * It can be made, and the system has said so or why not; the library makes it itself. Were it to truncate this
	 * one, ext4 would write all of it to disk when it is closed (auto_da_alloc).
	 */
	close(output->fd);
	unlink(output->partial);
	output->fd = -1;
	return RB_OK;
}

/*
 * Tells other processes that this file is being written: the library's own lock (flock) does not hold while readers are
 * let in, and this kind has nothing to do with it. False: somebody else does.
 */
static bool take_lock(int fd)
{
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};

	return fcntl(fd, F_OFD_SETLK, &lock) == 0 || (errno != EAGAIN && errno != EACCES);
}

enum rb_status rb_output_attach(struct rb_output *output, struct rb_error *err)
{
	output->fd = open(output->partial, O_RDWR | O_CLOEXEC);
	if (output->fd < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", output->name,
		               strerror(errno));
	(void)take_lock(output->fd);
	return RB_OK;
}

enum rb_status rb_output_reopen(struct rb_output *output, const char *name, struct rb_error *err)
{
	*output = (struct rb_output){.fd = -1};
	errno = 0;
	output->name = follow(name);
	if (output->name)
		output->fd = open(output->name, O_RDWR | O_CLOEXEC);
	if (output->fd < 0) {
		const int number = errno ? errno : ENOMEM;

		rb_output_release(output);
		return RB_FAIL(err, RB_ERR_CREATE, "cannot write to '%s': %s", name,
		               strerror(number));
	}
	output->published = true;
	if (take_lock(output->fd))
		return RB_OK;
	rb_output_release(output);
	return RB_FAIL(err, RB_ERR_CREATE, "cannot write to '%s': the run that writes it goes on",
	               name);
}

enum rb_status rb_output_publish(struct rb_output *output, struct rb_error *err)
{
	if (output->published)
		return RB_OK;
	const enum rb_status status = rb_outfile_place(output->partial, output->name,
	                                               output->replace, err);
	output->published = !status;
	return status;
}

/* Blocks are taken without the file growing: its length stays what HDF5 makes it. */
static int take(struct rb_output *output, uint64_t end)
{
	if (end <= output->reserved_bytes)
		return 0;
	while (fallocate(output->fd, FALLOC_FL_KEEP_SIZE, (off_t)output->reserved_bytes,
	                 (off_t)(end - output->reserved_bytes)) != 0)
		if (errno != EINTR)
			return errno;
	output->reserved_bytes = end;
	return 0;
}

int rb_output_reserve(struct rb_output *output, uint64_t end, uint64_t need)
{
	const uint64_t wanted = end + need;
	struct rlimit limit;

	/* Where the kernel does not ask (KEEP_SIZE), the limit is ours to keep: a write over it would come too late. */
	if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
	    wanted > limit.rlim_cur)
		return EFBIG;
	if (output->cannot_reserve || wanted <= output->reserved_bytes)
		return 0;

	uint64_t ahead = wanted / 4;
	ahead = ahead < ahead_min ? ahead_min : ahead > ahead_max ? ahead_max : ahead;
	int number = take(output, wanted + ahead);
	if (number != 0)
		number = take(output, wanted);
	if (number == EOPNOTSUPP || number == ENOSYS || number == EINVAL) {
		output->cannot_reserve = true;
		return 0;
	}
	return number;
}

void rb_output_lengthen(struct rb_output *output, uint64_t end)
{
	struct stat found;

	/* Where it fails, the library's own attempt will, and tell. */
	if (fstat(output->fd, &found) == 0 && (uint64_t)found.st_size < end &&
	    ftruncate(output->fd, (off_t)end) != 0)
		return;
}

bool rb_output_is_ours(const struct rb_output *output)
{
	struct stat named, open_file;

	return fstat(output->fd, &open_file) == 0 && stat(output->name, &named) == 0 &&
	       named.st_dev == open_file.st_dev && named.st_ino == open_file.st_ino;
}

void rb_output_release(struct rb_output *output)
{
	struct stat found;

	if (!output->name)
		return;
	if (output->fd >= 0) {
		if (output->published && fstat(output->fd, &found) == 0 &&
		    (uint64_t)found.st_size < output->reserved_bytes &&
		    ftruncate(output->fd, found.st_size) != 0)
			output->reserved_bytes =
				0; /* blocks beyond the end stay taken: nothing is lost but room */
		close(output->fd);
	}
	if (output->partial && !output->published)
		unlink(output->partial);
	rb_memory_free(output->name);
	rb_memory_free(output->partial);
	*output = (struct rb_output){.fd = -1};
}
