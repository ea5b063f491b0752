/* SPDX-License-Identifier: MIT */
/*
 * A socket's name is a file that outlives its owner. Whether the owner lives is found by
 * connecting: a refused connection is the only sure sign of a stale socket. Between this look and
 * the binding of our own, another run may do the same; therefore both happen under a lock on the
 * folder. The inode is remembered, so that at the end only our own socket is removed, not that of a
 * run which has replaced it.
 */
#include "control/address.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"

/*
 * BACKLOG: as many clients as the server has places. LOCK_TRIES times LOCK_EVERY_MS is 5 s: the
 * lock is held for a few system calls, longer only by something that is stuck.
 */
enum { BACKLOG = 128, LOCK_TRIES = 250, LOCK_EVERY_MS = 20 };

enum rb_status rb_address_of(struct sockaddr_un *address, const char *path, enum rb_status failure,
                             struct rb_error *err)
{
	const size_t size = strlen(path);

	*address = (struct sockaddr_un){.sun_family = AF_UNIX};
	if (size == 0 || size >= sizeof address->sun_path)
		return RB_FAIL(err, failure,
		               "socket '%.100s%s' has a name of %zu bytes, wanted 1 to %zu", path,
		               size > 100 ? "..." : "", size, sizeof address->sun_path - 1);
	memcpy(address->sun_path, path, size);
	return RB_OK;
}

/* ---- taking a name ---- */

/*
 * Locks the folder of `path` against other runs that take a name there. `*folder` is to be closed,
 * which releases the lock. Two runs that find the same stale socket must not both replace it: the
 * second would remove what the first has just made.
 */
static enum rb_status lock_folder(int *folder, const char *path, struct rb_error *err)
{
	char name[sizeof((struct sockaddr_un *)0)->sun_path];
	const struct timespec wait = {.tv_nsec = LOCK_EVERY_MS * 1000000L};
	const char *const slash = strrchr(path, '/');

	if (!slash)
		snprintf(name, sizeof name, ".");
	else
		snprintf(name, sizeof name, "%.*s", (int)(slash > path ? slash - path : 1), path);
	*folder = open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (*folder < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot make socket '%s': %s", path,
		               strerror(errno));
	for (int i = 0; i < LOCK_TRIES; i++) {
		/* where folders can't be locked, two runs that start at once must be luckier */
		if (flock(*folder, LOCK_EX | LOCK_NB) == 0 ||
		    (errno != EWOULDBLOCK && errno != EINTR))
			return RB_OK;
		nanosleep(&wait, NULL);
	}
	close(*folder);
	return RB_FAIL(err, RB_ERR_CREATE, "cannot make socket '%s': another process locks '%s'",
	               path, name);
}

/*
 * Makes sure that the name is free: nothing is there, or a socket on which nobody listens, which is
 * removed.
 */
static enum rb_status clear(const char *path, const struct sockaddr_un *address,
                            struct rb_error *err)
{
	struct stat file;

	if (lstat(path, &file) != 0)
		return RB_OK; /* what else is wrong with it shows when it is bound */
	if (!S_ISSOCK(file.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot make socket '%s': a file that is not a socket has that name",
		               path);
	const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (probe < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot make socket '%s': %s", path,
		               strerror(errno));
	const int failed = connect(probe, (const struct sockaddr *)address, sizeof *address) ? errno
	                                                                                     : 0;
	close(probe);
	if (failed == 0 || failed == EAGAIN || failed == EINPROGRESS)
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot make socket '%s': a process that runs listens there", path);
	if (failed == ENOENT)
		return RB_OK;
	if (failed != ECONNREFUSED)
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot make socket '%s': there is one already: %s", path,
		               strerror(failed));
	if (unlink(path) != 0 && errno != ENOENT)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot replace socket '%s': %s", path,
		               strerror(errno));
	return RB_OK;
}

/* Makes a socket at `path` that only its owner can connect to. `*fd` is the caller's on success. */
static enum rb_status bind_private(int *fd, const char *path, const struct sockaddr_un *address,
                                   struct rb_error *err)
{
	const int made = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);

	if (made < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot make socket '%s': %s", path,
		               strerror(errno));
	/*
	 * the file takes its mode from the socket and the mask: neither may let others in, not even
	 * for a moment
	 */
	(void)fchmod(made, S_IRUSR | S_IWUSR);
	const mode_t mask = umask(S_IRWXG | S_IRWXO | S_IXUSR);
	const bool bound = bind(made, (const struct sockaddr *)address, sizeof *address) == 0;
	const int failed = errno;
	umask(mask);
	if (!bound) {
		close(made);
		return RB_FAIL(err, RB_ERR_CREATE, "cannot make socket '%s': %s", path,
		               strerror(failed));
	}
	*fd = made;
	return RB_OK;
}

enum rb_status rb_address_listen(int *fd, struct rb_address_file *file, const char *path,
                                 struct rb_error *err)
{
	struct sockaddr_un address;
	struct stat made;
	int folder;

	*fd = -1;
	enum rb_status status = rb_address_of(&address, path, RB_ERR_CREATE, err);
	if (status)
		return status;
	status = lock_folder(&folder, path, err);
	if (status)
		return status;
	status = clear(path, &address, err);
	if (!status)
		status = bind_private(fd, path, &address, err);
	if (!status && (lstat(path, &made) != 0 || listen(*fd, BACKLOG) != 0)) {
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot listen on '%s': %s", path,
		                 strerror(errno));
		unlink(path);
		close(*fd);
		*fd = -1;
	}
	close(folder);
	if (!status)
		*file = (struct rb_address_file){.device = made.st_dev, .inode = made.st_ino};
	return status;
}

void rb_address_remove(const char *path, const struct rb_address_file *file)
{
	struct stat now;

	if (lstat(path, &now) == 0 && now.st_dev == file->device && now.st_ino == file->inode)
		unlink(path);
}
