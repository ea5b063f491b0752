/* SPDX-License-Identifier: MIT */
/*
 * Corners and triangles of a mesh from the bytes of a file that nobody vouches for: STL, binary or
 * text, and Wavefront OBJ. Pure functions.
 *
 * STL has no index: each triangle repeats its corners, so that corners that are equal to the bit
 * are made one. Of OBJ the lines `v x y z` and, for triangles, `f a b c ...` are read, and nothing
 * else. Whether the triangles close a surface is not looked at.
 */
#ifndef RB_GEOM_MESHFILE_H
#define RB_GEOM_MESHFILE_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

enum rb_meshfile_kind { RB_MESHFILE_NONE, RB_MESHFILE_STL, RB_MESHFILE_OBJ };

/* By the ending of its name, in upper or lower case. */
enum rb_meshfile_kind rb_meshfile_kind(const char *name);

/* No more corners are in so many bytes: room for rb_meshfile_read. */
size_t rb_meshfile_corners_max(enum rb_meshfile_kind kind, size_t size);

/*
 * Distinct corners, in the order of their coordinates (x first). `bytes` ends with a zero behind
 * `size` of them. RB_ERR_SCENE, with what is wrong where: it is cut off, a coordinate is no finite
 * number, or there is none.
 */
RB_CHECKED enum rb_status rb_meshfile_read(enum rb_meshfile_kind kind, const char *bytes,
                                           size_t size, rb_vec3 *points, size_t *count,
                                           struct rb_error *err);

/*
 * Triangles, by their corners in `points`, which has room for twice as many as above: the first
 * `count` are set. Faces of more corners are divided from their first. RB_ERR_SCENE also where
 * there are more than `most`, which `corners` has room for, or none.
 */
RB_CHECKED enum rb_status rb_meshfile_read_triangles(enum rb_meshfile_kind kind, const char *bytes,
                                                     size_t size, rb_vec3 *points, size_t *count,
                                                     int (*corners)[3], size_t most,
                                                     size_t *triangles, struct rb_error *err);

#endif
