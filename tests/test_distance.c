/* SPDX-License-Identifier: MIT */
/* src/geom/distance.h */
#include "support.h"

#include "geom/distance.h"
#include "math/random.h"

static const rb_vec3 origin = {0, 0, 0};

static void assert_vector(rb_vec3 a, rb_vec3 b, double tol)
{
	assert_near(a.x, b.x, tol);
	assert_near(a.y, b.y, tol);
	assert_near(a.z, b.z, tol);
}

static void the_gap_of_two_spheres_is_what_lies_between_them(void **slot)
{
	rb_vec3 normal;

	(void)slot;
	const double gap = rb_distance_sphere_sphere((rb_vec3){1, 2, 3}, 0.5, (rb_vec3){1, 6, 6},
	                                             1.5, &normal);
	assert_near(gap, 3, 1e-15);
	assert_vector(normal, (rb_vec3){0, 0.8, 0.6}, 1e-15);
}

static void spheres_with_one_centre_overlap_by_both_radii_and_have_a_unit_normal(void **slot)
{
	rb_vec3 normal;

	(void)slot;
	assert_near(rb_distance_sphere_sphere(origin, 1, origin, 2, &normal), -3, 0);
	assert_near(rb_vec3_length(normal), 1, 0);
}

static void far_and_tiny_spheres_neither_overflow_nor_underflow(void **slot)
{
	rb_vec3 normal;

	(void)slot;
	const double far = rb_distance_sphere_sphere((rb_vec3){-4e299, 0, 0}, 1,
	                                             (rb_vec3){4e299, 0, 0}, 1, &normal);
	assert_near(far / 8e299, 1, 1e-15);
	const double near = rb_distance_sphere_sphere(origin, 1e-300, (rb_vec3){0, 4e-300, 0},
	                                              1e-300, &normal);
	assert_near(near / 2e-300, 1, 1e-12);
	assert_vector(normal, (rb_vec3){0, 1, 0}, 1e-15);
}

static void behind_a_plane_is_solid_however_deep(void **slot)
{
	const rb_vec3 point = {5, 5, 1}, up = {0, 0, 1};
	rb_vec3 normal;

	(void)slot;
	assert_near(rb_distance_sphere_plane((rb_vec3){0, 0, 3}, 0.5, point, up, &normal), 1.5, 0);
	assert_vector(normal, (rb_vec3){0, 0, -1}, 0);
	assert_near(rb_distance_sphere_plane((rb_vec3){0, 0, -9}, 0.5, point, up, &normal), -10.5,
	            0);
	assert_vector(normal, (rb_vec3){0, 0, -1}, 0);
}

static void a_rectangle_is_met_on_its_faces_its_rim_and_its_corners(void **slot)
{
	const double size[2] = {4, 2};
	const rb_rectangle sheet = rb_rectangle_of(origin, rb_quat_identity, size);
	rb_vec3 normal, closest;

	(void)slot;
	assert_near(
		rb_distance_sphere_rectangle((rb_vec3){1, 0.5, 3}, 1, &sheet, &normal, &closest), 2,
		0);
	assert_vector(normal, (rb_vec3){0, 0, -1}, 0);
	assert_vector(closest, (rb_vec3){1, 0.5, 0}, 0);
	assert_near(rb_distance_sphere_rectangle((rb_vec3){1, 0.5, -3}, 1, &sheet, &normal, NULL),
	            2, 0);
	assert_vector(normal, (rb_vec3){0, 0, 1}, 0);
	assert_near(rb_distance_sphere_rectangle((rb_vec3){5, 0, 4}, 1, &sheet, &normal, &closest),
	            4, 1e-15);
	assert_vector(normal, (rb_vec3){-0.6, 0, -0.8}, 1e-15);
	assert_vector(closest, (rb_vec3){2, 0, 0}, 0);
	assert_near(rb_distance_sphere_rectangle((rb_vec3){4, 3, 1}, 1, &sheet, &normal, &closest),
	            2, 1e-15);
	assert_vector(closest, (rb_vec3){2, 1, 0}, 0);
	assert_vector(normal, (rb_vec3){-2.0 / 3, -2.0 / 3, -1.0 / 3}, 1e-15);
}

static void a_centre_on_the_sheet_counts_as_above_it(void **slot)
{
	const double size[2] = {2, 2};
	const rb_rectangle sheet = rb_rectangle_of(origin, rb_quat_identity, size);
	rb_vec3 normal;

	(void)slot;
	assert_near(rb_distance_sphere_rectangle(origin, 0.5, &sheet, &normal, NULL), -0.5, 0);
	assert_vector(normal, (rb_vec3){0, 0, -1}, 0);
}

static rb_vec3 random_vector(uint64_t stream, uint64_t index, double scale)
{
	return (rb_vec3){scale * (rb_random_unit(7, stream, 3 * index) - 0.5),
	                 scale * (rb_random_unit(7, stream, 3 * index + 1) - 0.5),
	                 scale * (rb_random_unit(7, stream, 3 * index + 2) - 0.5)};
}

/* Against points all over the sheet: none is nearer, and one of them is nearly as near. */
static void no_point_of_a_turned_rectangle_is_nearer_than_the_closest(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 50; k++) {
		const double size[2] = {0.5 + rb_random_unit(7, 3, k),
		                        0.5 + rb_random_unit(7, 4, k)};
		const rb_rectangle sheet = rb_rectangle_of(
			random_vector(0, k, 4), rb_quat_from_turn(random_vector(1, k, 6)), size);
		const rb_vec3 c = random_vector(2, k, 6);
		double nearest = (double)INFINITY;
		rb_vec3 normal, closest;

		const double gap = rb_distance_sphere_rectangle(c, 0.25, &sheet, &normal, &closest);
		for (int i = 0; i <= 100; i++) {
			for (int j = 0; j <= 100; j++) {
				rb_vec3 p = rb_vec3_add_scaled(
					sheet.center, sheet.half_x * (i / 50.0 - 1), sheet.axis_x);
				p = rb_vec3_add_scaled(p, sheet.half_y * (j / 50.0 - 1),
				                       sheet.axis_y);
				nearest = fmin(nearest, rb_vec3_length(rb_vec3_sub(c, p)));
			}
		}
		assert_true(gap + 0.25 <= nearest + 1e-12);
		assert_near(gap + 0.25, nearest, 0.02);
		assert_near(rb_vec3_length(normal), 1, 1e-14);
		assert_vector(rb_vec3_add_scaled(c, gap + 0.25, normal), closest, 1e-13);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_gap_of_two_spheres_is_what_lies_between_them),
		cmocka_unit_test(
			spheres_with_one_centre_overlap_by_both_radii_and_have_a_unit_normal),
		cmocka_unit_test(far_and_tiny_spheres_neither_overflow_nor_underflow),
		cmocka_unit_test(behind_a_plane_is_solid_however_deep),
		cmocka_unit_test(a_rectangle_is_met_on_its_faces_its_rim_and_its_corners),
		cmocka_unit_test(a_centre_on_the_sheet_counts_as_above_it),
		cmocka_unit_test(no_point_of_a_turned_rectangle_is_nearer_than_the_closest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
