/* SPDX-License-Identifier: MIT */
/*
 * Where a file is made: its folder, held open, and its name in there. Every output goes through
 * here.
 *
 * The folder is looked up once, part by part. From then on all is done relative to it, so that
 * nobody can lead a file elsewhere by changing a folder on the way. The last part is never followed
 * where it is a symbolic link, and a file is made under a new name that nobody can foretell. What a
 * scene names (RB_PLACE_BENEATH) stays below the current folder: no link leads on, nothing leads
 * up. What users name themselves may go through links in its folders.
 *
 * Owned by the caller; one thread at a time. Descriptors close on exec.
 */
#ifndef RB_BASE_PLACE_H
#define RB_BASE_PLACE_H

#include <limits.h>
#include <stdbool.h>

#include <rbsim/error.h>

enum {
	RB_PLACE_REPLACE = 1, /* what is there already may be replaced; a bool `true` is the same */
	RB_PLACE_BENEATH = 2, /* a scene has named it */
	RB_PLACE_MAKE = 4,    /* folders that are missing are made */
	RB_PLACE_NAME_SIZE = NAME_MAX + 1,
	RB_PLACE_LINK_SIZE = 40 + RB_PLACE_NAME_SIZE,
	RB_PLACE_OWN_SHIFT = 8
};

/*
 * RB_PLACE_BENEATH behind the first `size` bytes of the path, which the user has named: for a
 * folder of ours, and below.
 */
#define RB_PLACE_BELOW(size) (RB_PLACE_BENEATH | (unsigned)(size) << RB_PLACE_OWN_SHIFT)

struct rb_place {
	int folder;       /* owned; only to look up names in; -1: none */
	char *path;       /* owned; as it was named */
	const char *name; /* the last part of it */
	unsigned how;
};

/* RB_ERR_CREATE: there is no such folder, or it may not be gone to. */
RB_CHECKED enum rb_status rb_place_open(struct rb_place *place, const char *path, unsigned how,
                                        struct rb_error *err);
/* Whether such a place is there or could be made; leaves nothing behind. `there`: the folder is. */
RB_CHECKED enum rb_status rb_place_probe(const char *path, unsigned how, bool *there,
                                         struct rb_error *err);
void rb_place_release(struct rb_place *place); /* safe on a zeroed one */

/* RB_ERR_CREATE: the name is taken and may not be replaced, or is not that of a regular file. */
RB_CHECKED enum rb_status rb_place_check(const struct rb_place *place, struct rb_error *err);

/*
 * The place's name and `ending`, shortened in the middle where the system has no such long names:
 * always the same.
 */
const char *rb_place_beside(const struct rb_place *place, const char *ending,
                            char out[RB_PLACE_NAME_SIZE]);

/*
 * A new empty file for reading and writing that is to become what rb_place_beside calls so; `name`
 * says what it is called until then. A descriptor above the standard three, or -1 with errno.
 */
int rb_place_create(const struct rb_place *place, const char *ending,
                    char name[RB_PLACE_NAME_SIZE]);
/*
 * A file of that name that is there; flags as of open. -1 with errno: ELOOP, it is a symbolic link.
 */
int rb_place_reach(const struct rb_place *place, const char *name, int flags);
/*
 * Whether a process that lives writes the file: whoever makes a recording has a lock on it
 * (sink/h5output). False where the file system knows no locks, or not those of another machine.
 */
bool rb_place_is_written(int descriptor);
void rb_place_remove(const struct rb_place *place, const char *name);
/*
 * Removes what rb_place_create has left behind, of processes that were killed, for the place's name
 * with this ending.
 */
void rb_place_tidy(const struct rb_place *place, const char *ending);
/* From one name in the folder to another, which is replaced. 0, or -1 with errno. */
int rb_place_rename(const struct rb_place *place, const char *from, const char *to);
/*
 * Whatever was renamed in the folder is so also after a power cut, as far as the file system knows
 * of that.
 */
void rb_place_sync(const struct rb_place *place);

/*
 * Gives what rb_place_create made the place's name; without RB_PLACE_REPLACE never over another
 * one. RB_ERR_CREATE.
 */
RB_CHECKED enum rb_status rb_place_publish(const struct rb_place *place, const char *name,
                                           struct rb_error *err);

/*
 * A path for libraries and programs that take nothing else: of an open file, or of `name` in an
 * open folder (NULL: none). RB_ERR_CREATE without /proc, which is the only way.
 */
RB_CHECKED enum rb_status rb_place_link(int descriptor, const char *name,
                                        char out[RB_PLACE_LINK_SIZE], struct rb_error *err);

#endif
