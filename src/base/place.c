/* SPDX-License-Identifier: MIT */
/*
 * A walk opens each folder of the path relative to the one before (openat with O_NOFOLLOW for paths
 * of scenes), so that no check can be invalidated between its time and that of the use. openat2
 * with RESOLVE_BENEATH would do the same in one call, but it needs Linux 5.6 and fails in sandboxes
 * that do not know it.
 *
 * A new file gets a random name and O_EXCL and is renamed over the final name. Without permission
 * to replace, renameat2 with RENAME_NOREPLACE makes check and rename one operation; file systems
 * without it (NFS, some FUSE) get a hard link instead.
 */
#include "base/place.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <linux/magic.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"

/* Random names tried: each collides only by design of somebody. Descriptors 0, 1, 2. */
enum { TRIES_MAX = 100, STANDARD = 3 };

static const char partial_mark[] = ".partial-";

/* A walk down the folders of a path. */
struct walk {
	const char *path; /* all of it, for messages */
	unsigned how;
	int folder; /* owned: where it has come to */
	bool ended; /* a folder is missing, and could be made */
};

static enum rb_status refused(const char *path, int number, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", path, strerror(number));
}

static enum rb_status taken(const char *path, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it exists (--force replaces it)",
	               path);
}

static enum rb_status leads_up(const char *path, struct rb_error *err)
{
	return RB_FAIL(
		err, RB_ERR_CREATE,
		"cannot create '%s': a scene names no folder above its own (--trust lifts this)",
		path);
}

/*
 * What may be done in a folder does not depend on who may list it, so it is opened for names only.
 */
static int open_folder(int from, const char *name, bool follow)
{
	return openat(from, name, O_PATH | O_DIRECTORY | O_CLOEXEC | (follow ? 0 : O_NOFOLLOW));
}

static bool is_link(int folder, const char *name)
{
	struct stat found;

	return fstatat(folder, name, &found, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(found.st_mode);
}

/* Checks by making and removing it whether the missing folder `part` could be made. */
static enum rb_status try_folder(struct walk *walk, const char *part, struct rb_error *err)
{
	if (mkdirat(walk->folder, part, 0777) != 0 && errno != EEXIST)
		return refused(walk->path, errno, err);
	(void)unlinkat(walk->folder, part, AT_REMOVEDIR);
	walk->ended = true;
	return RB_OK;
}

/* Enters `part`; makes it where RB_PLACE_MAKE asks for it and `probe` does not forbid it. */
static enum rb_status step(struct walk *walk, const char *part, bool beneath, bool probe,
                           struct rb_error *err)
{
	RB_ASSERT(walk->folder >= 0 && *part);

	if (beneath && strcmp(part, "..") == 0)
		return leads_up(walk->path, err);
	int next = open_folder(walk->folder, part, !beneath);
	if (next < 0 && errno == ENOENT && walk->how & RB_PLACE_MAKE) {
		if (probe)
			return try_folder(walk, part, err);
		if (mkdirat(walk->folder, part, 0777) == 0 || errno == EEXIST)
			next = open_folder(walk->folder, part, !beneath);
	}
	if (next < 0) {
		const int number = errno;
		if (beneath && is_link(walk->folder, part))
			return RB_FAIL(err, RB_ERR_CREATE,
			               "cannot create '%s': '%.80s' is a symbolic link, which is "
			               "not followed here%s",
			               walk->path, part,
			               walk->how >> RB_PLACE_OWN_SHIFT ? ""
			                                               : " (--trust lifts this)");
		return refused(walk->path, number, err);
	}
	close(walk->folder);
	walk->folder = next;
	return RB_OK;
}

/*
 * Walks down the folders of `path`, which is cut into parts in place; its last part is not touched.
 * The first `own` bytes of the path are the user's, for which rules for scenes do not hold.
 */
static enum rb_status go(struct walk *walk, char *path, bool probe, struct rb_error *err)
{
	char *const last = strrchr(path, '/');
	enum rb_status status = RB_OK;

	const size_t own = walk->how >> RB_PLACE_OWN_SHIFT;
	if (*path == '/' && walk->how & RB_PLACE_BENEATH && own == 0)
		return leads_up(walk->path, err);
	walk->folder = open_folder(AT_FDCWD, *path == '/' ? "/" : ".", true);
	if (walk->folder < 0)
		return refused(walk->path, errno, err);
	if (!last)
		return RB_OK;
	*last = '\0';
	for (char *part = path; part && !status && !walk->ended;) {
		char *const slash = strchr(part, '/');
		if (slash)
			*slash = '\0';
		if (*part && strcmp(part, ".") != 0)
			status = step(walk, part,
			              walk->how & RB_PLACE_BENEATH && (size_t)(part - path) >= own,
			              probe, err);
		part = slash ? slash + 1 : NULL;
	}
	return status;
}

/* On success walk->folder is open and the caller's; on failure it is -1. */
static enum rb_status walk_to(struct walk *walk, const char *path, unsigned how, bool probe,
                              struct rb_error *err)
{
	char *const copy = rb_memory_copy_text(path);

	*walk = (struct walk){.path = path, .how = how, .folder = -1};
	if (!copy)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", path);
	const enum rb_status status = go(walk, copy, probe, err);
	rb_memory_free(copy);
	if (status && walk->folder >= 0) {
		close(walk->folder);
		walk->folder = -1;
	}
	return status;
}

enum rb_status rb_place_open(struct rb_place *place, const char *path, unsigned how,
                             struct rb_error *err)
{
	struct walk walk;

	*place = (struct rb_place){.folder = -1, .how = how};
	const enum rb_status status = walk_to(&walk, path, how, false, err);
	if (status)
		return status;
	place->path = rb_memory_copy_text(path);
	if (!place->path) {
		close(walk.folder);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot create '%s': out of memory", path);
	}
	place->folder = walk.folder;
	const char *const slash = strrchr(place->path, '/');
	place->name = slash ? slash + 1 : place->path;
	if (strlen(place->name) > NAME_MAX) {
		rb_place_release(place);
		return refused(path, ENAMETOOLONG, err);
	}
	if (!*place->name || strcmp(place->name, ".") == 0 || strcmp(place->name, "..") == 0) {
		rb_place_release(place);
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is a folder", path);
	}
	return RB_OK;
}

enum rb_status rb_place_probe(const char *path, unsigned how, bool *there, struct rb_error *err)
{
	struct walk walk;
	const enum rb_status status = walk_to(&walk, path, how, true, err);

	*there = !status && !walk.ended;
	if (!status)
		close(walk.folder);
	return status;
}

void rb_place_release(struct rb_place *place)
{
	if (place->path && place->folder >= 0)
		close(place->folder);
	rb_memory_free(place->path);
	*place = (struct rb_place){.folder = -1};
}

enum rb_status rb_place_check(const struct rb_place *place, struct rb_error *err)
{
	RB_ASSERT(place->folder >= 0 && place->name);

	struct stat found;

	if (fstatat(place->folder, place->name, &found, AT_SYMLINK_NOFOLLOW) != 0)
		return errno == ENOENT ? RB_OK : refused(place->path, errno, err);
	if (S_ISDIR(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is a folder",
		               place->path);
	/* a link is replaced as what it is: what it points to stays */
	if (!S_ISREG(found.st_mode) && !S_ISLNK(found.st_mode))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': it is not a regular file",
		               place->path);
	return place->how & RB_PLACE_REPLACE ? RB_OK : taken(place->path, err);
}

/* ---- names ---- */

/* Longest name in the place's file system, bytes: NAME_MAX is 255, but eCryptfs has 143. */
static size_t name_most(const struct rb_place *place)
{
	struct statfs about;

	return fstatfs(place->folder, &about) == 0 && about.f_namelen > 0 &&
	                       about.f_namelen < NAME_MAX
	               ? (size_t)about.f_namelen
	               : NAME_MAX;
}

/*
 * Length of the longest prefix of the place's name within `size` bytes that ends with a whole UTF-8
 * character. `size` is less than the name's length.
 */
static int cut(const struct rb_place *place, size_t size)
{
	while (size > 0 && ((unsigned char)place->name[size] & 0xc0) == 0x80)
		size--;
	return (int)size;
}

const char *rb_place_beside(const struct rb_place *place, const char *ending,
                            char out[RB_PLACE_NAME_SIZE])
{
	enum { HASH_SIZE = 17 };
	const size_t size = strlen(place->name), more = strlen(ending), most = name_most(place);

	if (size + more <= most)
		snprintf(out, RB_PLACE_NAME_SIZE, "%s%s", place->name, ending);
	else
		snprintf(out, RB_PLACE_NAME_SIZE, "%.*s-%016" PRIx64 "%s",
		         cut(place, most > more + HASH_SIZE ? most - more - HASH_SIZE : 0),
		         place->name, rb_hash_bytes(place->name, size, 0), ending);
	return out;
}

/*
 * Unpredictable number for a temporary name. Early in boot, getrandom may have none; the clock then
 * gives one that is guessable, and O_EXCL alone protects.
 */
static uint64_t unforeseen(void)
{
	uint64_t number;

	if (getrandom(&number, sizeof number, GRND_NONBLOCK) == (ssize_t)sizeof number)
		return number;
	number = rb_clock_now_ns() ^ (uint64_t)getpid() << 40;
	return rb_hash_bytes(&number, sizeof number, 0);
}

int rb_place_create(const struct rb_place *place, const char *ending, char name[RB_PLACE_NAME_SIZE])
{
	RB_ASSERT(place->folder >= 0);

	char whole[64];
	int descriptor = -1;

	for (int k = 0; k < TRIES_MAX && descriptor < 0; k++) {
		RB_ASSERT_COSTLY(strlen(ending) + sizeof partial_mark + 16 <= sizeof whole);
		snprintf(whole, sizeof whole, "%s%s%016" PRIx64, ending, partial_mark,
		         unforeseen());
		rb_place_beside(place, whole, name);
		descriptor = openat(place->folder, name,
		                    O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
		if (descriptor < 0 && errno != EEXIST)
			return -1;
	}
	if (descriptor < 0 || descriptor >= STANDARD)
		return descriptor;
	/* a standard stream was closed: what is written there must not come here */
	const int higher = fcntl(descriptor, F_DUPFD_CLOEXEC, STANDARD), number = errno;
	close(descriptor);
	if (higher < 0)
		rb_place_remove(place, name);
	errno = number;
	return higher;
}

int rb_place_reach(const struct rb_place *place, const char *name, int flags)
{
	return openat(place->folder, name, flags | O_NOFOLLOW | O_CLOEXEC, 0666);
}

bool rb_place_is_written(int descriptor)
{
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};

	RB_ASSERT(descriptor >= 0);
	return fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

void rb_place_remove(const struct rb_place *place, const char *name)
{
	(void)unlinkat(place->folder, name, 0);
}

void rb_place_tidy(const struct rb_place *place, const char *ending)
{
	char whole[64], begin[RB_PLACE_NAME_SIZE];

	snprintf(whole, sizeof whole, "%s%s0123456789abcdef", ending, partial_mark);
	rb_place_beside(place, whole, begin);
	const size_t size = strlen(begin) - 16;
	const int listed = openat(place->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *const folder = listed < 0 ? NULL : fdopendir(listed);
	if (!folder) {
		if (listed >= 0)
			close(listed);
		return;
	}
	for (const struct dirent *entry; (entry = readdir(folder)) != NULL;)
		if (strncmp(entry->d_name, begin, size) == 0 && strlen(entry->d_name) == size + 16)
			rb_place_remove(place, entry->d_name);
	closedir(folder);
}

int rb_place_rename(const struct rb_place *place, const char *from, const char *to)
{
	return renameat(place->folder, from, place->folder, to);
}

void rb_place_sync(const struct rb_place *place)
{
	const int folder = openat(place->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);

	if (folder < 0)
		return;
	(void)!fsync(folder);
	close(folder);
}

/*
 * Renames without replacing on file systems that lack RENAME_NOREPLACE: adds a hard link under the
 * final name, which fails if that is taken, and removes the temporary one.
 */
static int link_over(const struct rb_place *place, const char *from)
{
	const int folder = place->folder;
	struct stat found;

	if (linkat(folder, from, folder, place->name, 0) == 0) {
		rb_place_remove(place, from);
		return 0;
	}
	if (errno == EEXIST)
		return -1;
	/* no hard links either: the last resort has a gap between the look and the rename */
	if (fstatat(folder, place->name, &found, AT_SYMLINK_NOFOLLOW) == 0) {
		errno = EEXIST;
		return -1;
	}
	return renameat(folder, from, folder, place->name);
}

enum rb_status rb_place_publish(const struct rb_place *place, const char *name,
                                struct rb_error *err)
{
	RB_ASSERT(place->folder >= 0 && *name);

	int failed;

	if (place->how & RB_PLACE_REPLACE) {
		failed = rb_place_rename(place, name, place->name);
	} else {
		failed = renameat2(place->folder, name, place->folder, place->name,
		                   RENAME_NOREPLACE);
		if (failed && errno != EEXIST)
			failed = link_over(place, name);
	}
	if (failed)
		return errno == EEXIST ? taken(place->path, err) : refused(place->path, errno, err);
	return RB_OK;
}

enum rb_status rb_place_link(int descriptor, const char *name, char out[RB_PLACE_LINK_SIZE],
                             struct rb_error *err)
{
	static const char links[] = "/proc/self/fd";
	struct statfs about;

	if (statfs(links, &about) != 0 || about.f_type != PROC_SUPER_MAGIC)
		return RB_FAIL(err, RB_ERR_CREATE,
		               "cannot create recordings or videos here: '%s' is missing or not "
		               "the system's own (mount /proc)",
		               links);
	snprintf(out, RB_PLACE_LINK_SIZE, "%s/%d%s%s", links, descriptor, name ? "/" : "",
	         name ? name : "");
	return RB_OK;
}
