/* SPDX-License-Identifier: MIT */
/* src/geom/polytope.c: vertices, faces, edges of a convex body */
#include "shapes.h"

#include "geom/polytope.h"

/* A pyramid over a square: five faces, eight edges. */
static const rb_vec3 pyramid[] = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 2}};
static const int counts[] = {4, 3, 3, 3, 3};
static const int loop[] = {3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
static const rb_polytope_def def = {5, 5, pyramid, counts, loop};

static struct rb_polytope *made(const rb_polytope_def *from)
{
	struct rb_polytope *p = NULL;
	struct rb_error err;

	assert_ok(rb_polytope_create(&p, from, &err));
	return p;
}

/* V - E + F = 2, and what lies at each other. */
static void assert_closed(const struct rb_polytope *p)
{
	assert_int_equal(p->vertex_count - p->edge_count + p->face_count, 2);
	for (int e = 0; e < p->edge_count; e++) {
		const int v = p->edges[e][0], w = p->edges[e][1];

		assert_true(v < w && p->flanks[e][0] < p->flanks[e][1]);
		assert_int_equal(rb_polytope_edge(p, v, w), e);
		assert_int_equal(rb_polytope_edge(p, w, v), e);
	}
	for (int f = 0; f < p->face_count; f++) {
		const rb_polytope_face *const face = &p->faces[f];
		const rb_vec3 on = p->vertices[p->loop[face->first]];

		assert_near(rb_vec3_length(face->normal), 1, 1e-15);
		for (int v = 0; v < p->vertex_count; v++) /* all below its plane */
			assert_true(rb_vec3_dot(face->normal, rb_vec3_sub(p->vertices[v], on)) <
			            1e-14);
		/* anticlockwise seen from outside */
		const rb_vec3 q = p->vertices[p->loop[face->first + 1]],
			      r = p->vertices[p->loop[face->first + 2]];
		assert_true(rb_vec3_dot(face->normal,
		                        rb_vec3_cross(rb_vec3_sub(q, on), rb_vec3_sub(r, q))) > 0);
	}
}

static void a_closed_surface_has_its_edges_and_outward_faces(void **state)
{
	struct rb_polytope *p = made(&def);
	struct rb_error err;

	(void)state;
	assert_int_equal(p->edge_count, 8);
	assert_closed(p);
	assert_near(p->reach, 2, 0);
	assert_near(rb_vec3_length(rb_vec3_sub(p->middle, (rb_vec3){0, 0, 0.4})), 0, 1e-15);
	assert_int_equal(rb_polytope_edge(p, 0, 2), -1); /* a diagonal */
	rb_polytope_destroy(p);
	assert_ok(rb_polytope_create_box(&p, (rb_vec3){1, 2, 3}, &err));
	assert_int_equal(p->edge_count, 12);
	assert_closed(p);
	for (int v = 0; v < 8; v++) {
		const rb_vec3 c = p->vertices[v];

		assert_true(p->box && c.x == (v & 1 ? -1 : 1) && c.y == (v & 2 ? -2 : 2) &&
		            c.z == (v & 4 ? -3 : 3));
	}
	rb_polytope_destroy(p);
}

/* An arc is where its edge is outermost: no other vertex is farther. */
static void along_an_arc_its_edge_is_outermost(void **state)
{
	struct rb_polytope *p = made(&def);
	int tried = 0;

	(void)state;
	assert_int_equal(p->arc_count, p->edge_count);
	for (int k = 0; k < p->arc_count; k++) {
		const rb_polytope_arc *const arc = &p->arcs[k];
		const rb_vec3 across = rb_vec3_across(arc->along),
			      other = rb_vec3_cross(arc->along, across);

		for (int i = 0; i < 100; i++) {
			const double angle = 0.0628 * i + 0.001;
			const rb_vec3 n = rb_vec3_add(rb_vec3_scale(cos(angle), across),
			                              rb_vec3_scale(sin(angle), other));
			const bool in = rb_vec3_dot(n, arc->inner[0]) >= 0 &&
			                rb_vec3_dot(n, arc->inner[1]) >= 0;
			double most = -(double)INFINITY;

			for (int v = 0; v < p->vertex_count; v++)
				most = fmax(most, rb_vec3_dot(n, p->vertices[v]));
			const double here = rb_vec3_dot(n, p->vertices[arc->vertex[0]]);
			assert_int_equal(in, here > most - 1e-12);
			tried += in;
		}
	}
	assert_true(tried > 50);
	rb_polytope_destroy(p);
}

static void the_support_is_the_first_farthest_vertex(void **state)
{
	struct rb_polytope *p = made(&def);

	(void)state;
	for (uint64_t k = 0; k < 500; k++) {
		const rb_vec3 n = k < 27 ? (rb_vec3){(double)(k % 3) - 1, (double)(k / 3 % 3) - 1,
		                                     (double)(k / 9) - 1}
		                         : shapes_vector(9, k, 1);
		int best = 0;

		for (int v = 1; v < p->vertex_count; v++)
			if (rb_vec3_dot(n, p->vertices[v]) > rb_vec3_dot(n, p->vertices[best]))
				best = v;
		assert_int_equal(rb_polytope_support(p, n), best);
	}
	rb_polytope_destroy(p);
}

static void flat_thin_and_tiny_ones_have_what_they_have(void **state)
{
	struct rb_polytope *p;
	struct rb_error err;

	(void)state;
	assert_ok(rb_polytope_create_rectangle(&p, 2, 1, &err));
	assert_true(p->vertex_count == 4 && p->edge_count == 4 && p->face_count == 2);
	assert_int_equal(p->arc_count, 8);
	assert_near(p->faces[0].normal.z + p->faces[1].normal.z, 0, 0);
	rb_polytope_destroy(p);
	assert_ok(rb_polytope_create_segment(&p, 3, &err));
	assert_true(p->vertex_count == 2 && p->edge_count == 1 && p->face_count == 0);
	assert_int_equal(p->arc_count, 3);
	assert_near(p->reach, 3, 0);
	rb_polytope_destroy(p);
	assert_ok(rb_polytope_create_segment(&p, 0, &err));
	assert_true(p->vertex_count == 1 && p->edge_count == 0 && p->face_count == 0);
	rb_polytope_destroy(p);
	rb_polytope_destroy(NULL);
}

static void what_is_not_closed_or_has_no_extent_is_refused(void **state)
{
	static const rb_vec3 doubled[] = {{1, 1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 2}};
	static const int twice[] = {3, 2, 1, 0, 0, 1, 4, 0, 1, 4, 2, 3, 4, 3, 0, 4};
	static const int outside[] = {3, 2, 1, 0, 0, 1, 5, 1, 2, 4, 2, 3, 4, 3, 0, 4};
	const rb_polytope_def wrong[] = {
		{5, 4, pyramid, counts, loop},    /* a face is missing */
		{5, 5, doubled, counts, loop},    /* an edge without a length */
		{5, 5, pyramid, counts, twice},   /* a face that stands twice */
		{5, 5, pyramid, counts, outside}, /* a vertex that is not there */
	};

	(void)state;
	for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
		struct rb_polytope *p = NULL;
		struct rb_error err;

		assert_int_equal(rb_polytope_create(&p, &wrong[k], &err), RB_ERR_SCENE);
		assert_null(p);
		assert_true(*err.text);
	}
}

static void every_allocation_may_fail(void **state)
{
	enum rb_status status = RB_ERR_MEMORY;

	(void)state;
	for (uint64_t k = 1; status != RB_OK; k++) {
		struct rb_polytope *p = NULL;
		struct rb_error err;

		rb_memory_fail_at(k);
		status = rb_polytope_create(&p, &def, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || (status == RB_ERR_MEMORY && !p));
		rb_polytope_destroy(p);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_closed_surface_has_its_edges_and_outward_faces),
		cmocka_unit_test(along_an_arc_its_edge_is_outermost),
		cmocka_unit_test(the_support_is_the_first_farthest_vertex),
		cmocka_unit_test(flat_thin_and_tiny_ones_have_what_they_have),
		cmocka_unit_test(what_is_not_closed_or_has_no_extent_is_refused),
		cmocka_unit_test(every_allocation_may_fail),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
