/* SPDX-License-Identifier: MIT */
/*
 * Convex polytopes as geometry needs them: vertices, faces, edges, and what is worth working out
 * only once.
 *
 * One is made when a scene is sealed, is constant from then on, may be read by any thread, and
 * belongs to whoever made it. It may be flat (one face with two sides), a segment or a point;
 * coordinates are those of its body.
 */
#ifndef RB_GEOM_POLYTOPE_H
#define RB_GEOM_POLYTOPE_H

#include <stdbool.h>

#include "math/vec3.h"

#include <rbsim/error.h>

typedef struct {
	rb_vec3 normal; /* unit, outward */
	int first;      /* into loop: its vertices, anticlockwise seen from outside */
	int count;
} rb_polytope_face;

/*
 * An edge with some of the directions in which it is outermost: those across `along` between two
 * normals less than half a turn apart. n is one of them where n.inner[0] >= 0 and n.inner[1] >= 0.
 * The edge of a solid is one arc, that of a flat two, a segment alone three, all round.
 */
typedef struct {
	int vertex[2];
	rb_vec3 along; /* unit */
	rb_vec3 inner[2];
} rb_polytope_arc;

struct rb_polytope {
	int vertex_count, face_count, edge_count, arc_count, loop_count;
	rb_vec3 *vertices;       /* m */
	rb_polytope_face *faces; /* none for a segment or a point */
	int *loop;               /* vertices of the faces, one face after the other */
	int (*edges)[2];         /* vertices of each edge, the lower first */
	int (*flanks)[2];        /* faces at each edge, the lower first; a segment's has none */
	rb_polytope_arc *arcs;
	double reach;   /* m: of its farthest vertex from the origin */
	rb_vec3 middle; /* m: mean of its vertices */
	bool box;       /* vertex i is half, with x, y, z turned round by the bits 1, 2, 4 of i */
	rb_vec3 half;
};

enum { RB_POLYTOPE_VERTICES_MAX = 1 << 20 };

/*
 * Faces as loops of vertices, anticlockwise seen from outside; `counts` has the number of vertices
 * of each.
 */
typedef struct {
	int vertex_count, face_count;
	const rb_vec3 *vertices;
	const int *counts;
	const int *loop;
} rb_polytope_def;

/*
 * Everything is copied. The vertices of a face must lie in a plane, and each edge belong to two
 * faces; whether the whole is convex is not checked. RB_ERR_SCENE for what is not closed or has a
 * face or edge without extent.
 */
enum rb_status rb_polytope_create(struct rb_polytope **polytope, const rb_polytope_def *def,
                                  struct rb_error *err);
/* About the origin; half extents above zero. */
enum rb_status rb_polytope_create_box(struct rb_polytope **polytope, rb_vec3 half,
                                      struct rb_error *err);
/* In the plane z = 0, both of its sides solid faces. */
enum rb_status rb_polytope_create_rectangle(struct rb_polytope **polytope, double half_x,
                                            double half_y, struct rb_error *err);
/* Along z; a point where half_length is zero. */
enum rb_status rb_polytope_create_segment(struct rb_polytope **polytope, double half_length,
                                          struct rb_error *err);
void rb_polytope_destroy(struct rb_polytope *polytope);

/* The edge between two vertices, in any order; -1: there is none. */
int rb_polytope_edge(const struct rb_polytope *polytope, int v, int w);

/* The vertex farthest along `direction`, the first of several. */
int rb_polytope_support(const struct rb_polytope *polytope, rb_vec3 direction);

#endif
