/* SPDX-License-Identifier: MIT */
/*
 * Surfaces of bodies in every frame, for VTK, whose format knows no bodies that move as a whole:
 * the points of all that moves stand there once a frame, in world coordinates and 32-bit numbers;
 * their triangles, and all of what never moves, stand there once. Made from the columns of a
 * recording when it is closed, and only where the scene asks for it: a ball takes 3 kB a frame.
 */
#ifndef RB_SINK_H5SURFACES_H
#define RB_SINK_H5SURFACES_H

#include <rbsim/model.h>

#include "sink/h5file.h"

/* Triangles of several bodies; corners that lie on each other are one point. */
struct rb_surface_mesh {
	float *points;    /* owned, like what follows: [point_count][3], m, object coordinates */
	int64_t *corners; /* [triangle_count][3] points, of the type of offsets */
	int32_t *ids;     /* [triangle_count] of the body */
	uint8_t *colours; /* [triangle_count][3] sRGB */
	size_t *first;    /* [body_count + 1]: the first point of each body */
	size_t point_count, point_room, triangle_count;
	size_t corner_room, id_room, colour_room;
	int body_first, body_count; /* by index */
};

struct rb_surfaces {
	const struct rb_model *model; /* borrowed; so is its scene */
	struct rb_surface_mesh moving, fixed;
};

/* Makes the triangles. Released in any case. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_surfaces_make(struct rb_surfaces *surfaces,
                                           const struct rb_model *model, struct rb_error *err);
void rb_surfaces_release(struct rb_surfaces *surfaces); /* safe on a zeroed one */

/* Bytes of all their numbers in that many frames, without what is around them. */
uint64_t rb_surfaces_bytes(const struct rb_surfaces *surfaces, uint64_t frames);

/* Of a recording: fields stored per frame, path of their times. */
struct rb_surfaces_frames {
	unsigned fields;
	uint64_t frames;
	const char *time;
	bool pretend;
};
/*
 * Writes /VTKHDF/surfaces and /VTKHDF/statics, each if it has triangles, as parts of the collection
 * from `index` on. `pretend`: for estimates, no points are written.
 */
void rb_surfaces_write(struct rb_h5 *h5, struct rb_surfaces *surfaces,
                       const struct rb_surfaces_frames *frames, int index);

#endif
