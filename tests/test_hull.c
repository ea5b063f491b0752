/* SPDX-License-Identifier: MIT */
/* src/geom/hull.c */
#include "support.h"

#include "base/memory.h"
#include "geom/hull.h"
#include "solids.h"

static const double unit[3] = {1, 1, 1};

static struct rb_hull hull_of(const rb_vec3 *points, size_t count)
{
	struct rb_hull hull;
	struct rb_error err = {0};

	assert_ok(rb_hull_make(&hull, points, count, &err));
	return hull;
}

/* Every corner lies on or below every face, to `slack`. */
static void assert_convex(const struct rb_hull *hull, double slack)
{
	for (int f = 0; f < hull->face_count; f++) {
		const int *loop = hull->loops + hull->face_first[f];
		const int count = hull->face_first[f + 1] - hull->face_first[f];
		const rb_vec3 base = hull->vertices[loop[0]];
		rb_vec3 normal = {0, 0, 0};

		for (int k = 1; k + 1 < count; k++)
			normal = rb_vec3_add(
				normal,
				rb_vec3_cross(rb_vec3_sub(hull->vertices[loop[k]], base),
			                      rb_vec3_sub(hull->vertices[loop[k + 1]], base)));
		normal = rb_vec3_unit(normal, normal);
		for (int i = 0; i < hull->vertex_count; i++)
			if (!(rb_vec3_dot(rb_vec3_sub(hull->vertices[i], base), normal) <= slack))
				fail_msg("corner %d is %g beyond face %d, more than %g", i,
				         rb_vec3_dot(rb_vec3_sub(hull->vertices[i], base), normal),
				         f, slack);
	}
}

static void assert_box(const struct rb_hull *hull)
{
	assert_int_equal(hull->vertex_count, 8);
	assert_int_equal(hull->face_count, 6);
	assert_int_equal(hull->edge_count, 12);
	for (int f = 0; f < 6; f++)
		assert_int_equal(hull->face_first[f + 1] - hull->face_first[f], 4);
}

static void what_lies_within_on_faces_or_twice_is_no_corner(void **slot)
{
	rb_vec3 points[8 + 8 + 6];

	(void)slot;
	solids_box(points, unit, rb_quat_identity, (rb_vec3){0.5, 0.5, 0.5});
	solids_box(points + 8, unit, rb_quat_identity, (rb_vec3){0.5, 0.5, 0.5});
	points[16] = (rb_vec3){0.5, 0.5, 0.5};
	points[17] = (rb_vec3){0.5, 0.25, 0};
	points[18] = (rb_vec3){0.5, 0, 0};
	points[19] = (rb_vec3){1, 1, 0.3};
	points[20] = (rb_vec3){0.1, 0.2, 0.3};
	points[21] = (rb_vec3){0.7, 1, 0.7};
	struct rb_hull hull = hull_of(points, 22);
	assert_box(&hull);
	assert_convex(&hull, 0);
	/* loops begin at their smallest corner and stand in order */
	for (int f = 0; f < 6; f++) {
		const int *loop = hull.loops + hull.face_first[f];
		for (int k = 1; k < 4; k++)
			assert_true(loop[k] > loop[0]);
		assert_true(f == 0 || loop[0] >= hull.loops[hull.face_first[f - 1]]);
	}
	rb_hull_release(&hull);
}

static void a_box_has_six_faces_wherever_it_is_and_however_thin(void **slot)
{
	static const double sizes[][3] = {{1, 1, 1},       {1, 1e-6, 1e-6},    {1, 1, 1e-6},
	                                  {1e-6, 1e-3, 1}, {1e-9, 2e-9, 3e-9}, {1e9, 3e9, 2e3}};
	static const double away[] = {0, 1, 1e3, 1e6};
	rb_vec3 points[8];

	(void)slot;
	for (int s = 0; s < 6; s++)
		for (int a = 0; a < 4; a++)
			for (uint64_t k = 0; k < 40; k++) {
				const double *size = sizes[s];
				const double far = away[a] * size[s == 0 ? 0 : 1];
				const rb_vec3 at = {far, -0.7 * far, 0.3 * far};

				solids_box(points, size, k ? solids_turn(k) : rb_quat_identity, at);
				struct rb_hull hull = hull_of(points, 8);
				assert_box(&hull);
				rb_hull_release(&hull);
			}
}

/* A cloud that is pressed flat, or to a needle, and turned has the same corners and faces. */
static void a_cloud_keeps_its_faces_however_it_is_pressed(void **slot)
{
	static const double sizes[][2] = {{1, 1},      {1, 1e-8},    {1e-4, 1e-4},
	                                  {0.1, 1e-8}, {1e-4, 1e-8}, {1e-8, 1e-8}};
	rb_vec3 points[36];

	(void)slot;
	for (uint64_t k = 0; k < 40; k++) {
		struct rb_hull first = {0};

		for (int s = 0; s < 6; s++) {
			const rb_quat turn = s ? solids_turn(k) : rb_quat_identity;

			for (uint64_t i = 0; i < 36; i++)
				points[i] = rb_quat_rotate(
					turn,
					(rb_vec3){solids_random(k, 3 * i, -1, 1),
				                  sizes[s][0] * solids_random(k, 3 * i + 1, -1, 1),
				                  sizes[s][1] *
				                          solids_random(k, 3 * i + 2, -1, 1)});
			struct rb_hull hull = hull_of(points, 36);
			if (s == 0) {
				first = hull;
				continue;
			}
			assert_int_equal(hull.vertex_count, first.vertex_count);
			assert_int_equal(hull.face_count, first.face_count);
			assert_int_equal(hull.edge_count, first.edge_count);
			rb_hull_release(&hull);
		}
		rb_hull_release(&first);
	}
}

static void of_points_on_a_ball_all_are_corners_and_faces_are_triangles(void **slot)
{
	enum { COUNT = 5000 };
	rb_vec3 *points = malloc(COUNT * sizeof *points);

	(void)slot;
	for (int i = 0; i < COUNT; i++) {
		/* a spiral of equal areas */
		const double z = 1 - (2 * i + 1.0) / COUNT, r = sqrt(1 - z * z);

		points[i] = (rb_vec3){r * cos(2.399963 * i), r * sin(2.399963 * i), z};
	}
	struct rb_hull hull = hull_of(points, COUNT);
	assert_int_equal(hull.vertex_count, COUNT);
	assert_int_equal(hull.edge_count, 3 * COUNT - 6);
	assert_int_equal(hull.face_count, 2 * COUNT - 4);
	rb_hull_release(&hull);
	free(points);
}

/* Rings of points whose ends are polygons of 64 corners, merged from triangles. */
static void a_prism_of_many_sides_keeps_its_ends_whole(void **slot)
{
	enum { SIDES = 64 };
	rb_vec3 points[2 * SIDES];

	(void)slot;
	for (uint64_t k = 0; k < 30; k++) {
		const rb_quat turn = k ? solids_turn(100 + k) : rb_quat_identity;

		for (int i = 0; i < SIDES; i++) {
			const double a = 6.283185307179586 * i / SIDES;

			for (int end = 0; end < 2; end++)
				points[2 * i + end] = rb_vec3_add(
					(rb_vec3){5, 6, 7},
					rb_quat_rotate(turn, (rb_vec3){cos(a), sin(a), end}));
		}
		struct rb_hull hull = hull_of(points, 2 * SIDES);
		assert_int_equal(hull.vertex_count, 2 * SIDES);
		assert_int_equal(hull.face_count, SIDES + 2);
		assert_int_equal(hull.edge_count, 3 * SIDES);
		assert_convex(&hull, 1e-13);
		rb_hull_release(&hull);
	}
}

static void clouds_of_all_kinds_close(void **slot)
{
	enum { MOST = 300 };
	rb_vec3 points[MOST];

	(void)slot;
	for (uint64_t series = 0; series < 300; series++) {
		const int count = 4 + (int)solids_random(series, 0, 0, MOST - 4);
		/* from coarse grids, which are full of coplanar points, to fine ones */
		const double grid = pow(2, 1 + (double)(series % 20));
		const double flat = pow(10, -(double)(series % 7));
		const rb_quat turn = series % 3 ? solids_turn(series) : rb_quat_identity;

		for (int i = 0; i < count; i++) {
			const uint64_t k = 10 + 3 * (uint64_t)i;
			const rb_vec3 p = {
				nearbyint(solids_random(series, k, -1, 1) * grid),
				nearbyint(solids_random(series, k + 1, -1, 1) * grid),
				flat * nearbyint(solids_random(series, k + 2, -1, 1) * grid)};
			points[i] = rb_quat_rotate(turn, p);
		}
		/* a body in any case */
		for (int i = 0; i < 4; i++)
			points[i] = rb_quat_rotate(turn,
			                           (rb_vec3){i == 1 ? grid : 0, i == 2 ? grid : 0,
			                                     i == 3 ? flat * grid : 0});
		struct rb_hull hull = hull_of(points, (size_t)count);
		/* the rounding of turned coordinates tilts a face that is thin across it */
		assert_convex(&hull, 1e-13 * grid / flat);
		rb_hull_release(&hull);
	}
}

static void assert_refused(const rb_vec3 *points, size_t count, const char *what)
{
	struct rb_hull hull;
	struct rb_error err = {0};

	assert_int_equal(rb_hull_make(&hull, points, count, &err), RB_ERR_SCENE);
	if (!strstr(err.text, what))
		fail_msg("'%s' does not say '%s'", err.text, what);
	assert_null(hull.vertices);
}

static void points_without_a_volume_are_refused(void **slot)
{
	enum { COUNT = 1000 };
	rb_vec3 points[COUNT] = {{0}};

	(void)slot;
	assert_refused(points, 0, "0 points have no hull");
	assert_refused(points, 1, "1 point has no hull");
	assert_refused(points, 3, "3 points have no hull");
	assert_refused(points, COUNT, "in a plane"); /* all the same */
	for (int i = 0; i < COUNT; i++)
		points[i] = (rb_vec3){0.1 * i, 0.3 * i, -0.7 * i};
	assert_refused(points, COUNT, "in a plane"); /* on a line */
	for (uint64_t k = 0; k < 50; k++) {
		const rb_quat turn = solids_turn(k);

		for (int i = 0; i < COUNT; i++)
			points[i] = rb_vec3_add((rb_vec3){3, 4, 5},
			                        rb_quat_rotate(turn, (rb_vec3){i % 17, i % 23, 0}));
		assert_refused(points, COUNT, "in a plane");
	}
	points[7].y = (double)NAN;
	assert_refused(points, COUNT, "point 8 is not finite");
	points[7].y = (double)INFINITY;
	assert_refused(points, COUNT, "point 8 is not finite");
}

static void a_million_points_are_refused_and_65536_are_not(void **slot)
{
	const size_t million = 1000000;
	rb_vec3 *points = calloc(million, sizeof *points);

	(void)slot;
	assert_refused(points, million, "1000000 points are too many (wanted at most 65536)");
	for (size_t i = 0; i < 65536; i++)
		points[i] = rb_vec3_of(solids_random(1, 3 * i, -1, 1),
		                       solids_random(1, 3 * i + 1, -1, 1),
		                       solids_random(1, 3 * i + 2, -1, 1));
	struct rb_hull hull = hull_of(points, 65536);
	assert_convex(&hull, 1e-14);
	rb_hull_release(&hull);
	free(points);
}

static void huge_and_tiny_coordinates_have_hulls(void **slot)
{
	static const double scale[] = {1e-150, 1e-300, 1e150, 1e300};
	rb_vec3 points[8];

	(void)slot;
	for (int k = 0; k < 4; k++) {
		const double size[3] = {scale[k], 2 * scale[k], scale[k]};

		solids_box(points, size, rb_quat_identity, (rb_vec3){scale[k], 0, 0});
		struct rb_hull hull = hull_of(points, 8);
		assert_box(&hull);
		rb_hull_release(&hull);
	}
}

static void without_memory_nothing_is_left_behind(void **slot)
{
	rb_vec3 points[8];
	struct rb_hull hull;
	struct rb_error err;
	enum rb_status status = RB_ERR_MEMORY;

	(void)slot;
	solids_box(points, unit, rb_quat_identity, (rb_vec3){0, 0, 0});
	for (uint64_t k = 1; status == RB_ERR_MEMORY; k++) {
		const struct rb_memory_counts before = rb_memory_counts();

		rb_memory_fail_at(k);
		status = rb_hull_make(&hull, points, 8, &err);
		rb_memory_fail_at(0);
		if (status == RB_OK)
			rb_hull_release(&hull);
		const struct rb_memory_counts after = rb_memory_counts();
		assert_int_equal(after.taken - before.taken, after.freed - before.freed);
		assert_true(k < 100);
	}
	assert_int_equal(status, RB_OK);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_lies_within_on_faces_or_twice_is_no_corner),
		cmocka_unit_test(a_box_has_six_faces_wherever_it_is_and_however_thin),
		cmocka_unit_test(a_cloud_keeps_its_faces_however_it_is_pressed),
		cmocka_unit_test(of_points_on_a_ball_all_are_corners_and_faces_are_triangles),
		cmocka_unit_test(a_prism_of_many_sides_keeps_its_ends_whole),
		cmocka_unit_test(clouds_of_all_kinds_close),
		cmocka_unit_test(points_without_a_volume_are_refused),
		cmocka_unit_test(a_million_points_are_refused_and_65536_are_not),
		cmocka_unit_test(huge_and_tiny_coordinates_have_hulls),
		cmocka_unit_test(without_memory_nothing_is_left_behind),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
