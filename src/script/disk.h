/* SPDX-License-Identifier: MIT */
/* Files of a scene on disk: where they may be, and their bytes. */
#ifndef RB_SCRIPT_DISK_H
#define RB_SCRIPT_DISK_H

#include "script/script.h"

enum { RB_DISK_PATH_SIZE = 4096 };

/* What a file may be. */
struct rb_disk_limit {
	size_t bytes_max; /* a whole number of MiB */
	/* also a pipe or a device: what waits for the other end, without end if it must */
	bool pipes;
};
extern const struct rb_disk_limit rb_disk_scene, rb_disk_module, rb_disk_texture;

/*
 * A whole file into script->reading, with a zero behind it; RB_ERR_INPUT where it can't be read or
 * is too large.
 */
RB_CHECKED enum rb_status rb_disk_read(struct rb_script *script, const char *path,
                                       const struct rb_disk_limit *limit, struct rb_error *err);
void rb_disk_forget(struct rb_script *script); /* frees script->reading */

/* A path that can't leave the folder it is in: relative, without "..". */
bool rb_disk_path_stays(const char *path);

/*
 * Where a file that a scene names is: in its folder. Not found where it can't be read, or is behind
 * a link that leads out of the folder (trusted scripts may lead out, and name any place).
 */
bool rb_disk_find(const struct rb_script *script, const char *name, char path[RB_DISK_PATH_SIZE]);

#endif
