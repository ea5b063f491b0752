/* SPDX-License-Identifier: MIT */
/*
 * Room is reserved before a write because HDF5 cannot cope with a full disk: a failed write in the
 * middle of a flush leaves it with changes that it can neither write nor forget. fallocate asks the
 * file system for blocks beforehand, so a full disk is noticed while nothing has happened yet.
 * Reservations go ahead by a quarter of the file, between 1 and 64 MiB, so that they are few.
 */
#include "sink/h5output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

/* Bytes that are reserved ahead of what is needed, at least and at most. */
static const uint64_t ahead_min = (uint64_t)1 << 20, ahead_max = (uint64_t)64 << 20;

/* Fails. */
static enum rb_status still_written(const char *name, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot write to '%s': the run that writes it goes on",
	               name);
}

/* A recording that is replaced while it grows would be lost to its run, which may take hours. */
static enum rb_status check_idle(const struct rb_place *place, struct rb_error *err)
{
	const int fd = rb_place_reach(place, place->name, O_RDONLY | O_NONBLOCK);
	const bool is_written = fd >= 0 && rb_place_is_written(fd);

	if (fd >= 0)
		close(fd);
	return is_written ? still_written(place->path, err) : RB_OK;
}

enum rb_status rb_output_open(struct rb_output *output, const char *name, unsigned how,
                              struct rb_error *err)
{
	*output = (struct rb_output){.fd = -1};
	enum rb_status status = rb_place_open(&output->place, name, how, err);
	if (!status)
		status = rb_place_check(&output->place, err);
	if (!status)
		status = check_idle(&output->place, err);
	if (!status) {
		const int fd = rb_place_create(&output->place, "", output->partial);
		if (fd < 0) {
			output->partial[0] = '\0';
			status = RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name,
			                 strerror(errno));
		} else {
			/*
			 * It can be made, and the system has said so or why not; the library makes
			 * it itself. Were it to truncate this one, ext4 would write all of it to
			 * disk when it is closed (auto_da_alloc).
			 */
			close(fd);
			rb_place_remove(&output->place, output->partial);
		}
	}
	if (!status)
		status = rb_place_link(output->place.folder, output->partial, output->library, err);
	if (status)
		rb_output_release(output);
	return status;
}

bool rb_output_lock(const struct rb_output *output)
{
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};

	RB_ASSERT(output->fd >= 0);
	return fcntl(output->fd, F_OFD_SETLK, &lock) == 0 || (errno != EAGAIN && errno != EACCES);
}

enum rb_status rb_output_attach(struct rb_output *output, struct rb_error *err)
{
	output->fd = rb_place_reach(&output->place, output->partial, O_RDWR);
	if (output->fd < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", output->place.path,
		               strerror(errno));
	return rb_place_link(output->fd, NULL, output->library, err);
}

/* Text for an errno of opening a file. */
static const char *why_not(int number)
{
	return number == ELOOP ? "it is a symbolic link" : strerror(number);
}

enum rb_status rb_output_reopen(struct rb_output *output, const char *name, unsigned how,
                                struct rb_error *err)
{
	*output = (struct rb_output){.fd = -1};
	enum rb_status status = rb_place_open(&output->place, name, how, err);
	if (status)
		return status;
	output->fd = rb_place_reach(&output->place, output->place.name, O_RDWR);
	if (output->fd < 0)
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot write to '%s': %s", name,
		                 why_not(errno));
	else
		status = rb_place_link(output->fd, NULL, output->library, err);
	if (!status && !rb_output_lock(output))
		status = still_written(name, err);
	output->published = true;
	if (status)
		rb_output_release(output);
	return status;
}

enum rb_status rb_output_publish(struct rb_output *output, struct rb_error *err)
{
	RB_ASSERT(output->partial[0] || output->published);
	if (output->published)
		return RB_OK;
	const enum rb_status status = rb_place_publish(&output->place, output->partial, err);
	output->published = !status;
	return status;
}

/*
 * Takes blocks up to `end`, without the file growing: its length stays what HDF5 makes it. 0, or an
 * errno.
 */
static int take(struct rb_output *output, uint64_t end)
{
	RB_ASSERT(output->fd >= 0);
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

	RB_ASSERT(end <= UINT64_MAX - need);
	/*
	 * Where the kernel does not ask (KEEP_SIZE), the limit is ours to keep: a write over it
	 * would come too late.
	 */
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

/* Writes all bytes; 0, or an errno. */
static int write_all(int fd, const unsigned char *bytes, size_t size)
{
	while (size > 0) {
		const ssize_t written = write(fd, bytes, size);

		if (written < 0 && errno != EINTR)
			return errno;
		if (written == 0)
			return EIO;
		bytes += written < 0 ? 0 : written;
		size -= written < 0 ? 0 : (size_t)written;
	}
	return 0;
}

int rb_output_replace(struct rb_output *output, const void *bytes, size_t size)
{
	char name[RB_PLACE_NAME_SIZE];
	const int fd = rb_place_create(&output->place, "", name);
	int number = fd < 0 ? errno : write_all(fd, bytes, size);

	if (fd < 0)
		return number;
	if (close(fd) != 0 && number == 0)
		number = errno;
	if (number == 0 && rb_place_rename(&output->place, name, output->place.name) != 0)
		number = errno;
	if (number != 0)
		rb_place_remove(&output->place, name);
	return number;
}

bool rb_output_is_ours(const struct rb_output *output)
{
	struct stat named, open_file;

	return fstat(output->fd, &open_file) == 0 &&
	       fstatat(output->place.folder, output->place.name, &named, AT_SYMLINK_NOFOLLOW) ==
	               0 &&
	       named.st_dev == open_file.st_dev && named.st_ino == open_file.st_ino;
}

void rb_output_release(struct rb_output *output)
{
	struct stat found;

	if (!output->place.path)
		return;
	if (output->fd >= 0) {
		if (output->published && fstat(output->fd, &found) == 0 &&
		    (uint64_t)found.st_size < output->reserved_bytes &&
		    ftruncate(output->fd, found.st_size) != 0)
			output->reserved_bytes =
				0; /* blocks beyond the end stay taken: nothing is lost but room */
		close(output->fd);
	}
	if (output->partial[0] && !output->published)
		rb_place_remove(&output->place, output->partial);
	rb_place_release(&output->place);
	*output = (struct rb_output){.fd = -1};
}
