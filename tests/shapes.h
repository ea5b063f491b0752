/* SPDX-License-Identifier: MIT */
/*
 * Convex shapes for tests of geometry: cores of every kind, random places, a hull of few points, and the gap by trying
 * every direction that could matter. Header only, used by one thread.
 */
#ifndef RB_TESTS_SHAPES_H
#define RB_TESTS_SHAPES_H

#include <float.h>

#include "support.h"

#include "geom/convex.h"
#include "math/quat.h"
#include "math/random.h"

enum { SHAPES_HULL_MAX = 24, SHAPES_FACES_MAX = 64 };

/* A core with the polytope that it stands on, if any. */
typedef struct {
	struct rb_polytope *polytope;
	rb_core core;
} shape;

static inline double shapes_random(uint64_t stream, uint64_t index)
{
	return rb_random_unit(11, stream, index);
}

static inline rb_vec3 shapes_vector(uint64_t stream, uint64_t index, double scale)
{
	return (rb_vec3){scale * (2 * shapes_random(stream, 3 * index) - 1),
	                 scale * (2 * shapes_random(stream, 3 * index + 1) - 1),
	                 scale * (2 * shapes_random(stream, 3 * index + 2) - 1)};
}

static inline rb_mat3 shapes_turn(uint64_t stream, uint64_t index)
{
	const rb_vec3 v = shapes_vector(stream, index, 1);
	const rb_quat q = {shapes_random(stream + 1000, index) + 0.01, v.x, v.y, v.z};

	return rb_quat_to_mat3(rb_quat_unit(q));
}

static inline rb_mat3 shapes_turned(rb_vec3 turn)
{
	return rb_quat_to_mat3(rb_quat_from_turn(turn));
}

static const rb_mat3 shapes_upright = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

static inline shape shapes_box(double x, double y, double z)
{
	struct rb_error err = {0};
	shape s;

	assert_ok(rb_polytope_create_box(&s.polytope, (rb_vec3){x, y, z}, &err));
	s.core = rb_core_of_polytope(s.polytope, 0);
	return s;
}

/* A sphere where half_length is 0. */
static inline shape shapes_capsule(double half_length, double radius)
{
	struct rb_error err = {0};
	shape s;

	assert_ok(rb_polytope_create_segment(&s.polytope, half_length, &err));
	s.core = rb_core_of_polytope(s.polytope, radius);
	return s;
}

static inline shape shapes_rectangle(double half_x, double half_y)
{
	struct rb_error err = {0};
	shape s;

	assert_ok(rb_polytope_create_rectangle(&s.polytope, half_x, half_y, &err));
	s.core = rb_core_of_polytope(s.polytope, 0);
	return s;
}

static inline shape shapes_cylinder(double radius, double half_height)
{
	return (shape){NULL, rb_core_of_cylinder(radius, half_height)};
}

/* The hull of points in general position: every triple that has all others on one side. */
static inline shape shapes_hull(const rb_vec3 *points, int count)
{
	int counts[SHAPES_FACES_MAX], loop[3 * SHAPES_FACES_MAX], faces = 0;
	struct rb_error err = {0};
	shape s;

	for (int i = 0; i < count; i++)
		for (int j = 0; j < count; j++)
			for (int k = 0; k < count; k++) {
				bool out = i < j && i < k && j != k;
				const rb_vec3 n = rb_vec3_cross(rb_vec3_sub(points[j], points[i]),
				                                rb_vec3_sub(points[k], points[i]));
				for (int m = 0; m < count && out; m++)
					if (m != i && m != j && m != k)
						out = rb_vec3_dot(n, rb_vec3_sub(points[m],
						                                 points[i])) < 0;
				if (!out)
					continue;
				assert_true(faces < SHAPES_FACES_MAX);
				loop[3 * faces] = i;
				loop[3 * faces + 1] = j;
				loop[3 * faces + 2] = k;
				counts[faces++] = 3;
			}
	const rb_polytope_def def = {count, faces, points, counts, loop};
	assert_ok(rb_polytope_create(&s.polytope, &def, &err));
	s.core = rb_core_of_polytope(s.polytope, 0);
	return s;
}

/* Points on a random ellipsoid. */
static inline shape shapes_random_hull(uint64_t index, int count)
{
	rb_vec3 points[SHAPES_HULL_MAX];
	const rb_vec3 size = {0.3 + shapes_random(20, index), 0.3 + shapes_random(21, index),
	                      0.3 + shapes_random(22, index)};

	for (int i = 0; i < count; i++) {
		const rb_vec3 p = rb_vec3_unit(
			shapes_vector(23, index * SHAPES_HULL_MAX + (uint64_t)i, 1),
			(rb_vec3){1, 0, 0});
		points[i] = (rb_vec3){size.x * p.x, size.y * p.y, size.z * p.z};
	}
	return shapes_hull(points, count);
}

static inline void shapes_release(shape *s)
{
	rb_polytope_destroy(s->polytope);
	*s = (shape){0};
}

/* What a direction proves of the gap, radii included; by all vertices one after the other. */
static inline double shapes_proof(const rb_placed *a, const rb_placed *b, rb_vec3 n)
{
	return rb_vec3_dot(n, rb_vec3_sub(b->at, a->at)) - rb_placed_height(a, n) -
	       rb_placed_height(b, rb_vec3_neg(n)) - a->core->radius - b->core->radius;
}

static inline void shapes_offer(const rb_placed *a, const rb_placed *b, rb_vec3 n, double *best)
{
	if (rb_vec3_length(n) > 1e-12) {
		n = rb_vec3_unit(n, n);
		*best = fmax(*best, shapes_proof(a, b, n));
		*best = fmax(*best, shapes_proof(a, b, rb_vec3_neg(n)));
	}
}

static inline rb_vec3 shapes_vertex(const rb_placed *p, int i)
{
	return rb_placed_point(p, p->core->polytope->vertices[i]);
}

static inline rb_vec3 shapes_edge(const rb_placed *p, int i)
{
	const int *edge = p->core->polytope->edges[i];

	return rb_vec3_sub(shapes_vertex(p, edge[1]), shapes_vertex(p, edge[0]));
}

static inline void shapes_faces(const rb_placed *p, const rb_placed *a, const rb_placed *b,
                                double *best)
{
	for (int f = 0; f < p->core->polytope->face_count; f++)
		shapes_offer(a, b, rb_mat3_apply(&p->turn, p->core->polytope->faces[f].normal),
		             best);
}

/* From vertices of p to vertices and edges of q. */
static inline void shapes_ways(const rb_placed *p, const rb_placed *q, const rb_placed *a,
                               const rb_placed *b, double *best)
{
	for (int i = 0; i < p->core->polytope->vertex_count; i++) {
		const rb_vec3 v = shapes_vertex(p, i);
		for (int j = 0; j < q->core->polytope->vertex_count; j++)
			shapes_offer(a, b, rb_vec3_sub(shapes_vertex(q, j), v), best);
		for (int j = 0; j < q->core->polytope->edge_count; j++) {
			const rb_vec3 c = shapes_vertex(q, q->core->polytope->edges[j][0]);
			const rb_vec3 e = rb_vec3_unit(shapes_edge(q, j), c);
			shapes_offer(a, b, rb_vec3_reject(rb_vec3_sub(c, v), e), best);
		}
	}
}

/* Signed gap of two polytopes by every direction there is: nothing left out, no order, no bounds. */
static inline double shapes_gap(const rb_placed *a, const rb_placed *b)
{
	double best = -(double)INFINITY;

	shapes_faces(a, a, b, &best);
	shapes_faces(b, a, b, &best);
	for (int i = 0; i < a->core->polytope->edge_count; i++)
		for (int j = 0; j < b->core->polytope->edge_count; j++)
			shapes_offer(a, b, rb_vec3_cross(shapes_edge(a, i), shapes_edge(b, j)),
			             &best);
	shapes_ways(a, b, a, b, &best);
	shapes_ways(b, a, a, b, &best);
	return best;
}

/* How far outside its body a point is: above 0 outside, only a bound then. */
static inline double shapes_outside(const rb_placed *p, rb_vec3 point)
{
	const rb_vec3 v = rb_mat3_apply_transposed(&p->turn, rb_vec3_sub(point, p->at));
	const rb_core *core = p->core;
	double most = -(double)INFINITY;

	if (core->kind == RB_CORE_HALF_SPACE)
		return v.z;
	if (core->kind == RB_CORE_CYLINDER)
		return fmax(fabs(v.z) - core->half_height, hypot(v.x, v.y) - core->round);
	if (core->polytope->face_count == 0) {
		const double half = core->polytope->reach, z = v.z - fmin(fmax(v.z, -half), half);
		return rb_vec3_length((rb_vec3){v.x, v.y, z}) - core->radius;
	}
	for (int f = 0; f < core->polytope->face_count; f++) {
		const rb_polytope_face *face = &core->polytope->faces[f];
		const rb_vec3 d = rb_vec3_sub(
			v, core->polytope->vertices[core->polytope->loop[face->first]]);
		most = fmax(most, rb_vec3_dot(face->normal, d));
	}
	return most - core->radius;
}

#endif
