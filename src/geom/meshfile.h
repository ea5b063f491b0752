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

/* Triangles by the numbers of their corners; memory is the caller's. */
struct rb_meshfile_triangles {
	rb_vec3 *points;   /* [count]; room for twice as many as rb_meshfile_corners_max */
	int (*corners)[3]; /* [triangle_count] */
	size_t count, triangle_count;
	size_t triangles_max; /* room in `corners`, set before */
};

/*
 * Faces of more than three corners are divided from their first. RB_ERR_SCENE also where there is
 * none, or no room for all.
 */
RB_CHECKED enum rb_status rb_meshfile_read_triangles(enum rb_meshfile_kind kind, const char *bytes,
                                                     size_t size,
                                                     struct rb_meshfile_triangles *mesh,
                                                     struct rb_error *err);

#endif
