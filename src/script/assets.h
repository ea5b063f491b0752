/* SPDX-License-Identifier: MIT */
/*
 * Files that a scene names by a key: pictures, meshes. They become files of the scene, so that a
 * recording holds them and can be used elsewhere.
 */
#ifndef RB_SCRIPT_ASSETS_H
#define RB_SCRIPT_ASSETS_H

#include "script/call.h"

/* Looks at bytes that nobody vouches for; false: a mistake was noted. */
typedef bool rb_asset_check(const struct rb_call *call, const char *key, const char *name,
                            const char *bytes, size_t size);

/*
 * Puts the file among those of the scene, under its name, once for all that name it; `key` is that
 * of the call. The file, with a zero behind its bytes; NULL: a mistake was noted: it is not there,
 * too large, or not what `check` wants.
 */
const struct rb_source_file *rb_asset_take(struct rb_call *call, const char *key, const char *name,
                                           rb_asset_check *check);

#endif
