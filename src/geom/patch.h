/* SPDX-License-Identifier: MIT */
/*
 * What of a core lies outermost along a direction, to within a depth: a point, a segment, a
 * polygon, a disc, a plane. And where two such patches lie over each other. Pure functions of
 * values; no allocation.
 */
#ifndef RB_GEOM_PATCH_H
#define RB_GEOM_PATCH_H

#include <stdint.h>

#include "geom/core.h"

/* A feature of a core: its kind in the upper 8 bits, below which one of them. */
typedef uint32_t rb_part;
typedef enum {
	RB_PART_VERTEX = 1,
	RB_PART_EDGE,
	RB_PART_FACE,
	RB_PART_DIAGONAL, /* between vertices of several faces that are nearly one */
	RB_PART_SEVERAL,  /* such faces */
	/*
	 * of a cylinder: bit 0 says which; above it where: 0 anywhere, 1 to 4 a quarter, 5, 6 a
	 * crossing, 7 all round (constraint/contact_name), 8 to 15 eighths from the outermost
	 */
	RB_PART_RIM,
	RB_PART_END,    /* of a cylinder: 0 at +z, 1 at -z */
	RB_PART_MANTLE, /* of a cylinder: 0 whole, 1 + the end at which a point is */
	RB_PART_SURFACE /* a half space's */
} rb_part_kind;

static inline rb_part rb_part_of(rb_part_kind kind, int index)
{
	return (rb_part)kind << 24 | (rb_part)index;
}

typedef enum {
	RB_PATCH_POINT,
	RB_PATCH_SEGMENT,
	RB_PATCH_POLYGON,
	RB_PATCH_DISC,
	RB_PATCH_PLANE
} rb_patch_kind;

/* More vertices than these on one face: every so many of them, from the first on. */
enum { RB_PATCH_MAX = 64 };

typedef struct {
	rb_patch_kind kind;
	int count;       /* points: 1, 2, a polygon's, 1 (its centre) of a disc, 1 of a plane */
	rb_part feature; /* the whole */
	rb_vec3 normal;  /* unit, outward: of the plane it lies in */
	double curve;    /* m: radius of what a segment is the outermost line of */
	double round;    /* m: a disc's radius */
	/* unit: of a disc that tilts, from its centre to the outermost of its rim; else zero */
	rb_vec3 low;
	rb_vec3 axis; /* unit, of the body: where the quarters of a disc on it are counted from */
	rb_vec3 point[RB_PATCH_MAX]; /* m; a polygon's in order round it */
	rb_part id[RB_PATCH_MAX];    /* of the point */
	rb_part side[RB_PATCH_MAX];  /* a polygon's from this point to the next */
} rb_patch;

/*
 * `outward`: unit. What lies no deeper than `depth` below the outermost belongs to it; and the
 * whole of a polytope's face of which some does, if all of the face lies no deeper than `tilt`: its
 * own plane says how deep. With a `tilt`, the whole of a cylinder's end if an eighth of its rim
 * lies within the depth; it has a lowest point where it tilts by more.
 */
void rb_patch_of(rb_patch *patch, const rb_placed *placed, rb_vec3 outward, double depth,
                 double tilt);

#endif
