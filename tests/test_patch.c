/* SPDX-License-Identifier: MIT */
/* src/geom/patch.c: what of a core lies outermost */
#include "shapes.h"

#include "geom/patch.h"

static rb_patch patch;

static void of(const rb_core *core, rb_mat3 turn, rb_vec3 outward, double depth, double tilt)
{
	const rb_placed placed = {core, {0.5, 0, -1}, turn};

	rb_patch_of(&patch, &placed, outward, depth, tilt);
}

static rb_part_kind kind_of_part(rb_part part)
{
	return (rb_part_kind)(part >> 24 & 15);
}

/* Along a face, an edge, a corner of a box: four, two, one of its corners, which lie outermost. */
static void a_box_shows_a_face_an_edge_or_a_corner(void **state)
{
	static const rb_vec3 along[] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}};
	static const rb_patch_kind kinds[] = {RB_PATCH_POLYGON, RB_PATCH_SEGMENT, RB_PATCH_POINT};
	static const rb_part_kind features[] = {RB_PART_FACE, RB_PART_EDGE, RB_PART_VERTEX};
	static const int counts[] = {4, 2, 1};
	shape s = shapes_box(1, 1, 1);

	(void)state;
	for (uint64_t k = 0; k < 60; k++) {
		const int which = (int)(k % 3);
		const rb_mat3 turn = shapes_turn(2, k);
		const rb_vec3 n = rb_mat3_apply(&turn, rb_vec3_unit(along[which], along[0]));
		const rb_placed placed = {&s.core, {0.5, 0, -1}, turn};
		const double height = rb_placed_height(&placed, n);

		of(&s.core, turn, n, 1e-9, 0);
		assert_int_equal(patch.kind, kinds[which]);
		assert_int_equal(patch.count, counts[which]);
		assert_int_equal(kind_of_part(patch.feature), features[which]);
		for (int i = 0; i < patch.count; i++) {
			assert_int_equal(kind_of_part(patch.id[i]), RB_PART_VERTEX);
			const rb_vec3 p = rb_placed_point(
				&placed, s.polytope->vertices[patch.id[i] & 0xffffff]);
			assert_near(rb_vec3_length(rb_vec3_sub(p, patch.point[i])), 0, 4e-15);
			assert_near(rb_vec3_dot(n, rb_vec3_sub(p, placed.at)), height, 1e-9);
		}
	}
	rb_polytope_destroy(s.polytope);
}

/* Corners go round in order: sides of length 2, diagonals longer. */
static void the_corners_of_a_face_go_round_it(void **state)
{
	shape s = shapes_box(1, 1, 1);

	(void)state;
	of(&s.core, shapes_upright, (rb_vec3){0, 0, 1}, 1e-9, 0);
	assert_int_equal(patch.count, 4);
	for (int i = 0; i < 4; i++) {
		const rb_vec3 side = rb_vec3_sub(patch.point[(i + 1) % 4], patch.point[i]);

		assert_near(rb_vec3_length(side), 2, 1e-15);
		assert_int_equal(kind_of_part(patch.side[i]), RB_PART_EDGE);
	}
	assert_near(patch.normal.z, 1, 0);
	rb_polytope_destroy(s.polytope);
}

/* A face that tilts by 0.01: with a depth of less than its rise only the edge, with more all of it. */
static void the_depth_says_what_still_belongs_to_it(void **state)
{
	shape s = shapes_box(1, 1, 1);
	const rb_mat3 turn = shapes_turned((rb_vec3){0.01, 0, 0});
	const double rise = 2 * sin(0.01);

	(void)state;
	of(&s.core, turn, (rb_vec3){0, 0, 1}, 0.9 * rise, 0);
	assert_int_equal(patch.kind, RB_PATCH_SEGMENT);
	of(&s.core, turn, (rb_vec3){0, 0, 1}, 1.1 * rise, 0);
	assert_int_equal(patch.kind, RB_PATCH_POLYGON);
	/* of a face of which some lies so deep, all that is not deeper than the tilt */
	of(&s.core, turn, (rb_vec3){0, 0, 1}, 0.1 * rise, 1.1 * rise);
	assert_int_equal(patch.kind, RB_PATCH_POLYGON);
	of(&s.core, turn, (rb_vec3){0, 0, 1}, 0.1 * rise, 0.9 * rise);
	assert_int_equal(patch.kind, RB_PATCH_SEGMENT);
	rb_polytope_destroy(s.polytope);
}

static void a_cylinder_shows_an_end_a_line_or_a_point_of_its_rim(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.5, 2);

	(void)state;
	of(&drum, shapes_upright, (rb_vec3){0, 0, -1}, 1e-9, 0);
	assert_int_equal(patch.kind, RB_PATCH_DISC);
	assert_near(patch.round, 0.5, 0);
	assert_near(rb_vec3_length(rb_vec3_sub(patch.point[0], (rb_vec3){0.5, 0, -3})), 0, 0);
	assert_int_equal(patch.feature, rb_part_of(RB_PART_END, 1));
	of(&drum, shapes_upright, (rb_vec3){1, 0, 0}, 1e-9, 0);
	assert_int_equal(patch.kind, RB_PATCH_SEGMENT);
	assert_near(rb_vec3_length(rb_vec3_sub(patch.point[0], patch.point[1])), 4, 1e-15);
	assert_near(patch.curve, 0.5, 0);
	of(&drum, shapes_upright, (rb_vec3){0.6, 0, 0.8}, 1e-9, 0);
	assert_int_equal(patch.kind, RB_PATCH_POINT);
	assert_near(rb_vec3_length(rb_vec3_sub(patch.point[0], (rb_vec3){1, 0, 1})), 0, 1e-15);
	assert_int_equal(kind_of_part(patch.feature), RB_PART_RIM);
}

static void a_half_space_shows_its_plane(void **state)
{
	const rb_core ground = rb_core_of_half_space();

	(void)state;
	of(&ground, shapes_upright, (rb_vec3){0, 0, 1}, 1e-9, 0);
	assert_int_equal(patch.kind, RB_PATCH_PLANE);
	assert_int_equal(kind_of_part(patch.feature), RB_PART_SURFACE);
	assert_near(patch.point[0].z, -1, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_box_shows_a_face_an_edge_or_a_corner),
		cmocka_unit_test(the_corners_of_a_face_go_round_it),
		cmocka_unit_test(the_depth_says_what_still_belongs_to_it),
		cmocka_unit_test(a_cylinder_shows_an_end_a_line_or_a_point_of_its_rim),
		cmocka_unit_test(a_half_space_shows_its_plane),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
