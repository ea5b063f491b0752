/* SPDX-License-Identifier: MIT */
/* src/film/extents.c, apart.c: how large bodies are in pictures, how far away, and which spheres overlap. */
#include "film/extents.h"

#include "film/isolated.h"
#include "math/vec3.h"
#include "solids.h"
#include "worlds.h"

static const rb_vec3 corners[5] = {{2, 0, 0}, {0, 1, 0}, {0, 0, 3}, {-1, -1, 0}, {0, 0, -0.5}};

static struct rb_shape hull_of(struct lab *lab)
{
	struct rb_shape shape = {.kind = RB_SHAPE_HULL};

	assert_int_equal(rb_scene_add_hull(&lab->scene, corners, 5, &shape.solid, &lab->error),
	                 RB_OK);
	return shape;
}

static void sizes_are_those_of_the_smallest_box(void **state)
{
	static const struct {
		struct rb_shape shape;
		rb_vec3 high;
		double reach;
	} rows[] = {
		{{.kind = RB_SHAPE_SPHERE, .radius = 0.7}, {0.7, 0.7, 0.7}, 0.7},
		{{.kind = RB_SHAPE_BOX, .size = {2, 4, 4}}, {1, 2, 2}, 3},
		{{.kind = RB_SHAPE_BOX, .size = {12, 6, 4}}, {6, 3, 2}, 7},
		{{.kind = RB_SHAPE_CAPSULE, .radius = 0.5, .size = {0, 0, 3}}, {0.5, 0.5, 2}, 2},
		{{.kind = RB_SHAPE_CYLINDER, .radius = 3, .size = {0, 0, 8}}, {3, 3, 4}, 5},
	};
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const struct rb_part_size size = rb_part_size(&lab.scene, &rows[i].shape);
		assert_vector(size.high, rows[i].high, 1e-15);
		assert_vector(size.low, rb_vec3_neg(rows[i].high), 1e-15);
		assert_vector(size.middle, ((rb_vec3){0, 0, 0}), 0);
		assert_near(size.reach, rows[i].reach, 1e-15);
	}
	const struct rb_shape shape = hull_of(&lab);
	const rb_vec3 at = lab.scene.solids[shape.solid].centroid;
	const struct rb_part_size size = rb_part_size(&lab.scene, &shape);
	double reach = 0;
	for (int i = 0; i < 5; i++)
		reach = fmax(reach, rb_vec3_length(rb_vec3_sub(corners[i], at)));
	/* a hull's own coordinates may begin elsewhere than those of its points: only differences are told */
	assert_vector(rb_vec3_sub(size.high, size.low), ((rb_vec3){3, 2, 3.5}), 1e-14);
	assert_near(size.reach, reach, 1e-14);
	lab_close(&lab);
}

/* The nearest point of a solid to one that lies outside. */
static rb_vec3 nearest(const struct rb_shape *shape, rb_vec3 p)
{
	const double half = shape->size[2] / 2, r = shape->radius;
	const rb_vec3 inner = {0, 0, p.z > half ? half : p.z < -half ? -half : p.z};
	const double off = sqrt(p.x * p.x + p.y * p.y), in = off > r ? r / off : 1;

	switch (shape->kind) {
	case RB_SHAPE_BOX:
		return (rb_vec3){fmax(-shape->size[0] / 2, fmin(shape->size[0] / 2, p.x)),
		                 fmax(-shape->size[1] / 2, fmin(shape->size[1] / 2, p.y)), inner.z};
	case RB_SHAPE_CYLINDER:
		return (rb_vec3){in * p.x, in * p.y, inner.z};
	default: /* all that is within r of the axis */
		return rb_vec3_add_scaled(inner, r,
		                          rb_vec3_unit(rb_vec3_sub(p, inner), (rb_vec3){1, 0, 0}));
	}
}

static bool is_outside(const struct rb_shape *shape, rb_vec3 p)
{
	const double off = sqrt(p.x * p.x + p.y * p.y);
	const double rest = fmax(fabs(p.z) - shape->size[2] / 2, 0);

	switch (shape->kind) {
	case RB_SHAPE_BOX:
		return fabs(p.x) > shape->size[0] / 2 || fabs(p.y) > shape->size[1] / 2 ||
		       fabs(p.z) > shape->size[2] / 2;
	case RB_SHAPE_CYLINDER:
		return off > shape->radius || fabs(p.z) > shape->size[2] / 2;
	default:
		return off * off + rest * rest > shape->radius * shape->radius;
	}
}

static void distances_are_those_to_the_nearest_point(void **state)
{
	static const struct rb_shape shapes[] = {
		{.kind = RB_SHAPE_SPHERE, .radius = 0.7},
		{.kind = RB_SHAPE_BOX, .size = {1.2, 0.5, 0.9}},
		{.kind = RB_SHAPE_CAPSULE, .radius = 0.4, .size = {0, 0, 1.1}},
		{.kind = RB_SHAPE_CYLINDER, .radius = 0.4, .size = {0, 0, 1.1}},
	};
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t i = 0; i < 4; i++)
		for (uint64_t k = 0; k < 400; k++) {
			const rb_vec3 p = {solids_random(i, 3 * k, -1.5, 1.5),
			                   solids_random(i, 3 * k + 1, -1.5, 1.5),
			                   solids_random(i, 3 * k + 2, -1.5, 1.5)};
			const double d = rb_parts_distance(&lab.scene, &shapes[i], p);
			const rb_vec3 on = nearest(&shapes[i], p);
			if (is_outside(&shapes[i], p))
				assert_near(d, rb_vec3_length(rb_vec3_sub(p, on)), 1e-14);
			else
				assert_true(d <= 0);
		}
	/* inside: how deep, to the nearest side */
	assert_near(rb_parts_distance(&lab.scene, &shapes[1], (rb_vec3){0.5, 0.1, 0.1}), -0.1,
	            1e-15);
	assert_near(rb_parts_distance(&lab.scene, &shapes[1], (rb_vec3){0.1, -0.2, 0.1}), -0.05,
	            1e-15);
	assert_near(rb_parts_distance(&lab.scene, &shapes[3], (rb_vec3){0.05, 0, -0.5}), -0.05,
	            1e-15);
	assert_near(rb_parts_distance(&lab.scene, &shapes[3], (rb_vec3){0, 0.39, 0}), -0.01, 1e-15);
	const struct rb_shape plane = {.kind = RB_SHAPE_PLANE};
	assert_true(rb_parts_distance(&lab.scene, &plane, (rb_vec3){0, 0, 0}) == (double)INFINITY);
	lab_close(&lab);
}

/* Never more than it is, negative inside only, and right before a face. */
static void distances_to_hulls_are_no_larger_than_they_are(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	const struct rb_shape shape = hull_of(&lab);
	const struct rb_solid *const solid = &lab.scene.solids[shape.solid];
	assert_ptr_equal(rb_part_faces(&lab.scene, &shape), solid);
	for (int f = 0; f < solid->face_count; f++) {
		const int first = solid->face_first[f], size = solid->face_first[f + 1] - first;
		const rb_vec3 n = rb_part_normal(solid, f);
		rb_vec3 middle = {0, 0, 0};

		assert_near(rb_vec3_length(n), 1, 1e-15);
		for (int k = 0; k < size; k++)
			middle = rb_vec3_add_scaled(middle, 1.0 / size,
			                            solid->vertices[solid->loops[first + k]]);
		for (int k = 0; k < solid->vertex_count; k++)
			assert_true(rb_vec3_dot(n, rb_vec3_sub(solid->vertices[k], middle)) <
			            1e-14);
		for (double way = -0.01; way < 0.5; way += 0.02) {
			const rb_vec3 p = rb_vec3_add_scaled(middle, way, n);
			assert_near(rb_parts_distance(&lab.scene, &shape, p), way, 1e-14);
		}
		/* far away, a point is at least as far from each corner */
		const rb_vec3 far = rb_vec3_add_scaled(middle, 50, n);
		const double d = rb_parts_distance(&lab.scene, &shape, far);
		assert_true(d > 40 && d <= 50 + 1e-12);
	}
	lab_close(&lab);
}

static void boxes_have_six_faces_that_look_outwards(void **state)
{
	const struct rb_shape box = {.kind = RB_SHAPE_BOX, .size = {1, 1, 1}};
	const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 1};
	struct lab lab;
	rb_vec3 sum = {0, 0, 0};

	(void)state;
	lab_open(&lab, 1, 10);
	const struct rb_solid *const solid = rb_part_faces(&lab.scene, &box);
	assert_null(rb_part_faces(&lab.scene, &ball));
	assert_int_equal(solid->face_count, 6);
	for (int f = 0; f < 6; f++) {
		const rb_vec3 n = rb_part_normal(solid, f);
		for (int k = solid->face_first[f]; k < solid->face_first[f + 1]; k++)
			assert_near(rb_vec3_dot(n, solid->vertices[solid->loops[k]]), 1, 0);
		sum = rb_vec3_add(sum, (rb_vec3){fabs(n.x), fabs(n.y), fabs(n.z)});
	}
	assert_vector(sum, ((rb_vec3){2, 2, 2}), 0);
	for (int e = 0; e < 12; e++) {
		const rb_vec3 way = rb_vec3_sub(solid->vertices[solid->edges[e][1]],
		                                solid->vertices[solid->edges[e][0]]);
		assert_near(rb_vec3_length(way), 2, 0);
	}
	lab_close(&lab);
}

static void a_union_is_as_far_as_its_nearest_part(void **state)
{
	struct lab lab;
	struct rb_shape shape = {.kind = RB_SHAPE_UNION};

	(void)state;
	lab_open(&lab, 1, 10);
	const struct rb_solid_part parts[2] = {
		{.shape = {.kind = RB_SHAPE_BOX, .size = {2, 0.2, 0.4}},
	         .position = {1, 2, 3},
	         .orientation = rb_quat_from_turn((rb_vec3){0, 0, 1.5707963267948966}),
	         .share = 0.5},
		{.shape = {.kind = RB_SHAPE_SPHERE, .radius = 0.5},
	         .position = {1, -2, 3},
	         .orientation = {1, 0, 0, 0},
	         .share = 0.5}};
	assert_int_equal(rb_scene_add_union(&lab.scene, parts, 2, &shape.solid, &lab.error), RB_OK);
	const struct rb_solid_part *const kept = lab.scene.solids[shape.solid].parts;
	const rb_vec3 box = kept[0].position, ball = kept[1].position;
	/* the box is long in y now */
	assert_near(rb_parts_distance(&lab.scene, &shape, rb_vec3_add(box, (rb_vec3){0, 1.5, 0})),
	            0.5, 1e-14);
	assert_near(rb_parts_distance(&lab.scene, &shape, rb_vec3_add(box, (rb_vec3){0.5, 0, 0})),
	            0.4, 1e-14);
	assert_near(rb_parts_distance(&lab.scene, &shape, rb_vec3_add(box, (rb_vec3){0, 0, 0.5})),
	            0.3, 1e-14);
	assert_near(rb_parts_distance(&lab.scene, &shape, rb_vec3_add(ball, (rb_vec3){0, -1, 0})),
	            0.5, 1e-14);
	struct rb_solid_part own;
	int count;
	assert_ptr_equal(rb_parts_of(&lab.scene, &shape, &own, &count), kept);
	assert_int_equal(count, 2);
	assert_ptr_equal(rb_parts_of(&lab.scene, &parts[1].shape, &own, &count), &own);
	assert_int_equal(count, 1);
	lab_close(&lab);
}

/* Spheres touch without being told; what overlaps by more than a thousandth is. */
static void spheres_that_overlap_are_found(void **state)
{
	struct rb_apart apart;
	struct rb_apart_ball balls[5] = {
		{.centre = {0, 0, 0}, .radius = 1},      {.centre = {1.5, 2, 0}, .radius = 1.5},
		{.centre = {0, 0, 2.9}, .radius = 1},    {.centre = {0, 0.5, 4.5}, .radius = 0.8},
		{.centre = {5, 5, 5}, .radius = 0.0001},
	};
	struct rb_error err;

	(void)state;
	rb_apart_init(&apart);
	assert_ok(rb_apart_find(&apart, balls, 5, &err));
	assert_false(balls[0].cuts || balls[1].cuts || balls[4].cuts);
	assert_true(balls[2].cuts && balls[3].cuts);
	balls[2].cuts = balls[3].cuts = false;
	balls[0].centre.x = 0.1, balls[3].centre.z = 4.8;
	assert_ok(rb_apart_find(&apart, balls, 5, &err));
	assert_true(balls[0].cuts && balls[1].cuts);
	assert_false(balls[2].cuts || balls[3].cuts || balls[4].cuts);
	rb_apart_release(&apart);
}

static void a_sphere_cuts_a_rectangle_where_it_is_and_not_beyond(void **state)
{
	const rb_vec3 corner = {1, 2, 3}, u = {0, 4, 0}, v = {0, 0, 2};
	static const struct {
		rb_vec3 at; /* from the corner, along u and v; the last is the height */
		double radius;
		bool cuts;
	} rows[] = {
		{{2, 1, 0.5}, 0.6, true},       {{2, 1, 0.5}, 0.4, false},
		{{2, 1, -0.5}, 0.6, true},      {{-0.5, 1, 0}, 0.6, true},
		{{-0.5, 1, 0}, 0.4, false},     {{4.5, 1, 0}, 0.6, true},
		{{4.5, 1, 0}, 0.4, false},      {{2, -0.5, 0}, 0.6, true},
		{{2, -0.5, 0}, 0.4, false},     {{2, 2.5, 0}, 0.6, true},
		{{2, 2.5, 0}, 0.4, false},      {{4.3, 2.4, 0}, 0.51, true},
		{{4.3, 2.4, 0}, 0.49, false},   {{-0.3, -0.4, 0}, 0.51, true},
		{{-0.3, -0.4, 0}, 0.49, false},
	};

	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const rb_vec3 at = {rows[i].at.z, rows[i].at.x, rows[i].at.y};
		const struct rb_apart_ball ball = {.centre = rb_vec3_add(corner, at),
		                                   .radius = rows[i].radius};
		assert_int_equal(rb_apart_cuts_rectangle(&ball, corner, u, v), rows[i].cuts);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sizes_are_those_of_the_smallest_box),
		cmocka_unit_test(distances_are_those_to_the_nearest_point),
		cmocka_unit_test(distances_to_hulls_are_no_larger_than_they_are),
		cmocka_unit_test(boxes_have_six_faces_that_look_outwards),
		cmocka_unit_test(a_union_is_as_far_as_its_nearest_part),
		cmocka_unit_test(spheres_that_overlap_are_found),
		cmocka_unit_test(a_sphere_cuts_a_rectangle_where_it_is_and_not_beyond),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
