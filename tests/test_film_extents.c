/* SPDX-License-Identifier: MIT */
/* src/film/extents.c: parts, faces, sizes and distances of random hulls and of unions */
#include "worlds.h"

#include <float.h>

#include "film/extents.h"
#include "model/shape.h"
#include "solids.h"

enum { POINTS = 14 };

/* A hull of random points; where they are. */
static struct rb_shape random_hull(struct lab *lab, uint64_t series, rb_vec3 points[POINTS])
{
	struct rb_shape shape = {.kind = RB_SHAPE_HULL};

	for (uint64_t k = 0; k < POINTS; k++)
		points[k] = (rb_vec3){solids_random(series, 3 * k, -2, 3),
		                      solids_random(series, 3 * k + 1, 5, 6),
		                      solids_random(series, 3 * k + 2, -1, 1)};
	assert_int_equal(rb_scene_add_hull(&lab->scene, points, POINTS, &shape.solid, &lab->error),
	                 RB_OK);
	return shape;
}

static void what_is_no_union_is_its_only_part(void **state)
{
	const struct rb_shape capsule = {.kind = RB_SHAPE_CAPSULE, .radius = 2, .size = {0, 0, 5}};
	struct rb_solid_part own;
	struct lab lab;
	int count = 0;

	(void)state;
	lab_open(&lab, 1, 10);
	const struct rb_solid_part *parts = rb_parts_of(&lab.scene, &capsule, &own, &count);
	assert_int_equal(count, 1);
	assert_ptr_equal(parts, &own);
	assert_int_equal(own.shape.kind, RB_SHAPE_CAPSULE);
	assert_true(own.shape.radius == 2 && own.shape.size[2] == 5);
	assert_true(own.orientation.w == 1 && own.share == 1);
	assert_vector(own.position, ((rb_vec3){0, 0, 0}), 0);

	const struct rb_solid_part two[2] = {
		{.shape = capsule, .orientation = {1, 0, 0, 0}, .share = 1},
		{.shape = {.kind = RB_SHAPE_SPHERE, .radius = 1},
	         .position = {9, 0, 0},
	         .orientation = {1, 0, 0, 0},
	         .share = 1}};
	struct rb_shape joined = {.kind = RB_SHAPE_UNION};
	assert_int_equal(rb_scene_add_union(&lab.scene, two, 2, &joined.solid, &lab.error), RB_OK);
	parts = rb_parts_of(&lab.scene, &joined, &own, &count);
	assert_int_equal(count, 2);
	assert_ptr_equal(parts, lab.scene.solids[joined.solid].parts);
	lab_close(&lab);
}

/* All points of the hull lie behind each face, and its corners on it. */
static void normals_of_faces_look_outwards(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t series = 0; series < 40; series++) {
		rb_vec3 points[POINTS];
		const struct rb_shape shape = random_hull(&lab, series, points);
		const struct rb_solid *solid = rb_part_faces(&lab.scene, &shape);

		assert_non_null(solid);
		assert_int_equal(solid->vertex_count - solid->edge_count + solid->face_count, 2);
		for (int f = 0; f < solid->face_count; f++) {
			const rb_vec3 normal = rb_part_normal(solid, f);
			const int *loop = solid->loops + solid->face_first[f];
			const rb_vec3 on = solid->vertices[loop[0]];

			assert_near(rb_vec3_length(normal), 1, 4 * DBL_EPSILON);
			/* coordinates up to 6 m, and faces that may be slivers */
			for (int k = 0; k < solid->vertex_count; k++)
				assert_true(rb_vec3_dot(normal, rb_vec3_sub(solid->vertices[k],
				                                            on)) <= 1e-11);
			for (int k = solid->face_first[f]; k < solid->face_first[f + 1]; k++)
				assert_near(
					rb_vec3_dot(
						normal,
						rb_vec3_sub(solid->vertices[solid->loops[k]], on)),
					0, 1e-11);
		}
	}
	lab_close(&lab);
}

static void only_what_is_flat_has_faces(void **state)
{
	static const struct rb_shape round[] = {
		{.kind = RB_SHAPE_SPHERE, .radius = 1},
		{.kind = RB_SHAPE_CAPSULE, .radius = 1, .size = {0, 0, 1}},
		{.kind = RB_SHAPE_CYLINDER, .radius = 1, .size = {0, 0, 1}},
		{.kind = RB_SHAPE_PLANE},
		{.kind = RB_SHAPE_RECTANGLE, .size = {1, 1}}};
	const struct rb_shape box = {.kind = RB_SHAPE_BOX, .size = {1, 2, 3}};
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (size_t i = 0; i < sizeof round / sizeof *round; i++)
		assert_null(rb_part_faces(&lab.scene, &round[i]));
	/* each edge belongs to two faces, which go along it in opposite directions */
	const struct rb_solid *solid = rb_part_faces(&lab.scene, &box);
	assert_true(solid->vertex_count == 8 && solid->edge_count == 12 && solid->face_count == 6);
	for (int e = 0; e < 12; e++) {
		int forth = 0, back = 0;

		for (int f = 0; f < 6; f++)
			for (int k = 0; k < 4; k++) {
				const int a = solid->loops[4 * f + k],
					  b = solid->loops[4 * f + (k + 1) % 4];
				forth += a == solid->edges[e][0] && b == solid->edges[e][1];
				back += b == solid->edges[e][0] && a == solid->edges[e][1];
			}
		assert_true(forth == 1 && back == 1);
	}
	lab_close(&lab);
}

/* The box and the ball round a hull hold all of its points, and no smaller ones would. */
static void sizes_of_hulls_are_those_of_their_points(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t series = 100; series < 140; series++) {
		rb_vec3 points[POINTS], low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};
		const struct rb_shape shape = random_hull(&lab, series, points);
		const struct rb_part_size size = rb_part_size(&lab.scene, &shape);
		double reach = 0;

		for (int k = 0; k < POINTS; k++) {
			low = (rb_vec3){fmin(low.x, points[k].x), fmin(low.y, points[k].y),
			                fmin(low.z, points[k].z)};
			high = (rb_vec3){fmax(high.x, points[k].x), fmax(high.y, points[k].y),
			                 fmax(high.z, points[k].z)};
			reach = fmax(reach, rb_vec3_length(rb_vec3_sub(points[k], size.middle)));
		}
		assert_vector(size.low, low, 0);
		assert_vector(size.high, high, 0);
		assert_near(size.reach, reach, 4 * DBL_EPSILON * reach);
		/* the middle is inside */
		assert_true(rb_parts_distance(&lab.scene, &shape, size.middle) < 0);
	}
	lab_close(&lab);
}

/*
 * The sign says on which side a point is; outside, what is said is no more than the way to any
 * point of the body.
 */
static void a_point_is_no_farther_than_the_way_to_the_body(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t series = 200; series < 230; series++) {
		rb_vec3 points[POINTS];
		const struct rb_shape shape = random_hull(&lab, series, points);

		for (uint64_t k = 0; k < 40; k++) {
			const rb_vec3 p = {solids_random(series, 1000 + 3 * k, -9, 9),
			                   solids_random(series, 1001 + 3 * k, -4, 15),
			                   solids_random(series, 1002 + 3 * k, -9, 9)};
			const double d = rb_parts_distance(&lab.scene, &shape, p);

			for (int i = 0; i < POINTS; i++) {
				const double way = rb_vec3_length(rb_vec3_sub(points[i], p));
				assert_true(d <= way + 1e-12);
				/* halfway there */
				const rb_vec3 half = rb_vec3_scale(0.5, rb_vec3_add(points[i], p));
				if (d < 0) /* from a point inside to a corner all is inside */
					assert_true(rb_parts_distance(&lab.scene, &shape, half) <
					            1e-12);
			}
		}
	}
	const struct rb_shape plane = {.kind = RB_SHAPE_PLANE};
	assert_true(isinf(rb_parts_distance(&lab.scene, &plane, (rb_vec3){0, 0, 0})));
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_no_union_is_its_only_part),
		cmocka_unit_test(normals_of_faces_look_outwards),
		cmocka_unit_test(only_what_is_flat_has_faces),
		cmocka_unit_test(sizes_of_hulls_are_those_of_their_points),
		cmocka_unit_test(a_point_is_no_farther_than_the_way_to_the_body),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
