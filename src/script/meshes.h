/* SPDX-License-Identifier: MIT */
/*
 * Terrains: triangles of a file, or of a height over a grid, which the script's function is asked
 * for while the scene is read. Owns nothing; memory in between is Lua's.
 */
#ifndef RB_SCRIPT_MESHES_H
#define RB_SCRIPT_MESHES_H

#include "geom/meshfile.h"
#include "script/call.h"

/*
 * The mesh that the call's key `file` names, with a zero behind its bytes, and the call's `scale`;
 * the key's value is at `text`. NULL: a mistake was noted.
 */
const struct rb_source_file *rb_mesh_file(struct rb_call *call, int text,
                                          enum rb_meshfile_kind *kind, double *scale);

/* Puts the terrain into the scene; false: a mistake was noted. */
bool rb_terrain_read(struct rb_call *call, struct rb_shape *shape);

#endif
