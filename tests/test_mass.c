/* SPDX-License-Identifier: MIT */
/* src/geom/mass.c */
#include "support.h"

#include "geom/mass.h"
#include "model/shape.h"
#include "math/quat.h"
#include "solids.h"

static void a_sphere_has_the_volume_and_inertia_of_the_books(void **slot)
{
	const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 2};

	(void)slot;
	assert_near(rb_shape_volume(NULL, &ball), 33.510321638291124, 1e-14);
	const rb_mat3 inertia = rb_shape_inertia(NULL, &ball, 5);
	for (int i = 0; i < 9; i++)
		assert_near(inertia.m[i / 3][i % 3], i % 4 == 0 ? 8 : 0, 1e-15);
	assert_true(rb_inertia_is_scalar(&inertia));
}

static void a_plane_has_no_volume_and_no_inertia(void **slot)
{
	const struct rb_shape sheet = {.kind = RB_SHAPE_RECTANGLE, .size = {1, 2}};

	(void)slot;
	assert_near(rb_shape_volume(NULL, &sheet), 0, 0);
	assert_near(rb_shape_inertia(NULL, &sheet, 1).m[0][0], 0, 0);
}

static rb_mat3 turned(double x, double y, double z, rb_vec3 turn)
{
	const rb_mat3 r = rb_quat_to_mat3(rb_quat_from_turn(turn)), d = rb_mat3_diagonal(x, y, z);
	const rb_mat3 back = rb_mat3_transposed(&r), rd = rb_mat3_multiply(&r, &d);

	return rb_mat3_multiply(&rd, &back);
}

static void principal_moments_do_not_depend_on_how_the_axes_stand(void **slot)
{
	(void)slot;
	for (int k = 0; k < 20; k++) {
		const rb_mat3 inertia = turned(3e-9, 1e-9, 2.5e-9,
		                               (rb_vec3){0.3 * k, 1 - 0.1 * k, 0.7});
		double moments[3];

		rb_inertia_principal(&inertia, moments);
		assert_near(moments[0], 1e-9, 1e-23);
		assert_near(moments[1], 2.5e-9, 1e-23);
		assert_near(moments[2], 3e-9, 1e-23);
		assert_null(rb_inertia_fault(&inertia));
		assert_false(rb_inertia_is_scalar(&inertia));
	}
}

static void a_flat_body_is_possible_and_anything_beyond_is_not(void **slot)
{
	const rb_mat3 flat = turned(1, 2, 3, (rb_vec3){0.5, 0.6, 0.7});
	const rb_mat3 beyond = turned(1, 2, 3.01, (rb_vec3){0.5, 0.6, 0.7});

	(void)slot;
	assert_null(rb_inertia_fault(&flat));
	assert_non_null(strstr(rb_inertia_fault(&beyond), "above the sum"));
}

static void a_tensor_that_is_lopsided_negative_or_not_finite_is_refused(void **slot)
{
	rb_mat3 inertia = rb_mat3_diagonal(1, 1, 1);

	(void)slot;
	inertia.m[0][1] = 0.1;
	assert_non_null(strstr(rb_inertia_fault(&inertia), "symmetric"));
	inertia = rb_mat3_diagonal(1, 1, -1);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "positive"));
	inertia = rb_mat3_diagonal(0, 0, 0);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "positive"));
	inertia = rb_mat3_diagonal(1, (double)NAN, 1);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "finite"));
}

static void assert_tensor(rb_mat3 found, rb_mat3 wanted, double tolerance)
{
	for (int i = 0; i < 9; i++)
		assert_near(found.m[i / 3][i % 3], wanted.m[i / 3][i % 3], tolerance);
}

static void boxes_and_cylinders_have_the_inertia_of_the_books(void **slot)
{
	const struct rb_shape box = {.kind = RB_SHAPE_BOX, .size = {1, 2, 3}};
	const struct rb_shape rod = {.kind = RB_SHAPE_CYLINDER, .radius = 0.5, .size = {0, 0, 4}};

	(void)slot;
	assert_near(rb_shape_volume(NULL, &box), 6, 0);
	assert_tensor(rb_shape_inertia(NULL, &box, 12), rb_mat3_diagonal(13, 10, 5), 1e-14);
	assert_near(rb_shape_reach(NULL, &box), sqrt(3.5), 1e-15);
	assert_near(rb_shape_half_width(NULL, &box), 0.5, 0);
	assert_near(rb_shape_volume(NULL, &rod), 3.14159265358979323846, 1e-15);
	assert_tensor(rb_shape_inertia(NULL, &rod, 12), rb_mat3_diagonal(16.75, 16.75, 1.5), 1e-14);
}

/* Sums over slices across z (Simpson's rule in the angle, which is smooth at the poles). */
static void a_capsule_has_what_its_slices_have_together(void **slot)
{
	enum { SLICES = 20000 };
	const double pi = 3.14159265358979323846;
	static const double lengths[] = {1e-9, 0.3, 2, 50};

	(void)slot;
	for (int n = 0; n < 4; n++) {
		const double r = 0.7, half = 0.5 * lengths[n];
		const struct rb_shape capsule = {
			.kind = RB_SHAPE_CAPSULE, .radius = r, .size = {0, 0, lengths[n]}};
		double volume = pi * r * r * lengths[n], along = 0.5 * r * r * volume;
		double across = volume * (0.25 * r * r + lengths[n] * lengths[n] / 12);

		for (int k = 0; k <= SLICES; k++) {
			const double a = 0.5 * pi * k / SLICES;
			const double weight = (k == 0 || k == SLICES ? 1
			                       : k % 2               ? 4
			                                             : 2) *
			                      (0.5 * pi / SLICES) / 3;
			const double radius = r * cos(a), z = half + r * sin(a);
			const double slice = 2 * weight * pi * radius * radius * r * cos(a);

			volume += slice;
			along += 0.5 * radius * radius * slice;
			across += (0.25 * radius * radius + z * z) * slice;
		}
		const rb_mat3 inertia = rb_shape_inertia(NULL, &capsule, volume);
		assert_near(rb_shape_volume(NULL, &capsule), volume, 1e-13 * volume);
		assert_near(inertia.m[2][2], along, 1e-13 * along);
		assert_near(inertia.m[0][0], across, 1e-13 * across);
		assert_near(inertia.m[1][1], across, 1e-13 * across);
	}
}

static struct rb_scene scene_of(void)
{
	struct rb_scene scene;
	struct rb_error err;

	assert_ok(rb_scene_init(&scene, &err));
	return scene;
}

static int add_hull(struct rb_scene *scene, const rb_vec3 *points, size_t count)
{
	struct rb_error err = {0};
	int solid;

	assert_ok(rb_scene_add_hull(scene, points, count, &solid, &err));
	return solid;
}

static rb_mat3 turned_by(rb_mat3 inertia, rb_quat turn)
{
	const rb_mat3 r = rb_quat_to_mat3(turn), back = rb_mat3_transposed(&r);
	const rb_mat3 half = rb_mat3_multiply(&r, &inertia);

	return rb_mat3_multiply(&half, &back);
}

/* Relative to each entry's own size, also where it is 1e-12 of the others. */
static void a_needle_or_foil_as_a_hull_is_the_box_to_rounding(void **slot)
{
	static const double sizes[][3] = {
		{1, 1e-6, 1e-6}, {1, 1, 1e-6}, {1e-6, 1e-3, 1}, {2, 3, 4}};
	struct rb_scene scene = scene_of();

	(void)slot;
	for (int s = 0; s < 4; s++) {
		struct rb_shape box = {.kind = RB_SHAPE_BOX};
		rb_vec3 points[8];

		memcpy(box.size, sizes[s], sizeof box.size);
		solids_box(points, box.size, rb_quat_identity, (rb_vec3){0, 0, 0});
		const struct rb_shape hull = {.kind = RB_SHAPE_HULL,
		                              .solid = add_hull(&scene, points, 8)};
		const double volume = rb_shape_volume(NULL, &box);
		const rb_mat3 wanted = rb_shape_inertia(NULL, &box, 1);
		const rb_mat3 found = rb_shape_inertia(scene.solids, &hull, 1);

		assert_near(rb_shape_volume(scene.solids, &hull), volume, 1e-15 * volume);
		assert_near(rb_shape_half_width(scene.solids, &hull),
		            rb_shape_half_width(NULL, &box), 1e-15);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				assert_near(found.m[i][j], wanted.m[i][j],
				            4e-16 * sqrt(wanted.m[i][i] * wanted.m[j][j]));
	}
	rb_scene_release(&scene);
}

static void the_least_half_width_is_found_along_any_axis(void **state)
{
	static const double sizes[][3] = {{1, 5, 7}, {5, 1, 7}, {7, 5, 1},
	                                  {1, 7, 5}, {5, 7, 1}, {7, 1, 5}};
	struct rb_scene scene = scene_of();

	(void)state;
	for (uint64_t k = 0; k < 24; k++) {
		rb_vec3 points[8];

		solids_box(points, sizes[k % 6], k < 6 ? rb_quat_identity : solids_turn(k),
		           (rb_vec3){3, 1, -2});
		const struct rb_shape hull = {.kind = RB_SHAPE_HULL,
		                              .solid = add_hull(&scene, points, 8)};
		assert_near(rb_shape_half_width(scene.solids, &hull), 0.5, 1e-14);
	}
	rb_scene_release(&scene);
}

static void a_box_as_a_hull_turned_and_far_away_is_still_that_box(void **slot)
{
	struct rb_scene scene = scene_of();

	(void)slot;
	for (uint64_t k = 0; k < 50; k++) {
		const struct rb_shape box = {.kind = RB_SHAPE_BOX,
		                             .size = {solids_random(k, 4, 0.1, 9),
		                                      solids_random(k, 5, 0.1, 9),
		                                      solids_random(k, 6, 0.1, 9)}};
		const double size = 2 * rb_shape_reach(NULL, &box);
		const double far = k < 25 ? 10 : 1e6;
		const rb_vec3 at = {far, -far, 0.5 * far};
		const rb_quat turn = solids_turn(k);
		/* the corners themselves are no better than their coordinates */
		const double slack = 8 * (1 + far / size) * 2.2e-16;
		rb_vec3 points[8];

		solids_box(points, box.size, turn, at);
		const struct rb_shape hull = {.kind = RB_SHAPE_HULL,
		                              .solid = add_hull(&scene, points, 8)};
		const double volume = rb_shape_volume(NULL, &box);
		const rb_vec3 centroid = rb_shape_centroid(scene.solids, &hull);
		assert_near(rb_shape_volume(scene.solids, &hull), volume, 20 * slack * volume);
		assert_near(rb_vec3_length(rb_vec3_sub(centroid, at)), 0, slack * size);
		assert_tensor(rb_shape_inertia(scene.solids, &hull, 3),
		              turned_by(rb_shape_inertia(NULL, &box, 3), turn),
		              3 * slack * size * size);
	}
	rb_scene_release(&scene);
}

/* Volume 1/6, centroid at a quarter, products of inertia: the corner of a cube, in rational numbers. */
static void a_corner_of_a_cube_has_its_rational_numbers(void **slot)
{
	struct rb_scene scene = scene_of();
	const rb_vec3 points[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const struct rb_shape hull = {.kind = RB_SHAPE_HULL, .solid = add_hull(&scene, points, 4)};
	const double d = 3.0 / 40, o = 1.0 / 80;

	(void)slot;
	assert_near(rb_shape_volume(scene.solids, &hull), 1.0 / 6, 1e-16);
	assert_near(rb_shape_centroid(scene.solids, &hull).z, 0.25, 1e-16);
	assert_tensor(rb_shape_inertia(scene.solids, &hull, 1),
	              (rb_mat3){{{d, o, o}, {o, d, o}, {o, o, d}}}, 1e-16);
	assert_near(rb_shape_reach(scene.solids, &hull), 1, 0);
	/* the same points make no second solid */
	assert_int_equal(add_hull(&scene, points, 4), hull.solid);
	assert_int_equal(scene.solid_count, 1);
	rb_scene_release(&scene);
}

static struct rb_solid_part part_of(const struct rb_shape *shape, rb_vec3 position, rb_quat turn)
{
	return (struct rb_solid_part){*shape, position, turn, 1};
}

static void a_box_is_the_union_of_its_halves_however_they_are_made(void **slot)
{
	struct rb_scene scene = scene_of();
	struct rb_error err = {0};

	(void)slot;
	for (uint64_t k = 0; k < 50; k++) {
		const double cut = solids_random(k, 7, 0.1, 0.9);
		const struct rb_shape box = {.kind = RB_SHAPE_BOX, .size = {2, 1, 4}};
		const struct rb_shape low = {.kind = RB_SHAPE_BOX, .size = {2, 1, 4 * cut}};
		const double high[3] = {2, 1, 4 * (1 - cut)};
		const rb_quat turn = solids_turn(k);
		const rb_vec3 at = {solids_random(k, 8, -9, 9), 3, 4};
		rb_vec3 points[8];

		/* one half is a box that is turned, the other a hull that was turned before */
		solids_box(points, high, turn,
		           rb_vec3_add(at, rb_quat_rotate(turn, (rb_vec3){0, 0, 2 * cut})));
		const struct rb_shape hull = {.kind = RB_SHAPE_HULL,
		                              .solid = add_hull(&scene, points, 8)};
		const struct rb_solid_part parts[2] = {
			part_of(&low,
		                rb_vec3_add(at, rb_quat_rotate(turn, (rb_vec3){0, 0, 2 * cut - 2})),
		                turn),
			part_of(&hull, (rb_vec3){0, 0, 0}, rb_quat_identity)};
		struct rb_shape both = {.kind = RB_SHAPE_UNION};

		assert_ok(rb_scene_add_union(&scene, parts, 2, &both.solid, &err));
		assert_near(rb_shape_volume(scene.solids, &both), 8, 1e-13);
		assert_near(rb_vec3_length(rb_vec3_sub(rb_shape_centroid(scene.solids, &both), at)),
		            0, 1e-14);
		assert_tensor(rb_shape_inertia(scene.solids, &both, 6),
		              turned_by(rb_shape_inertia(NULL, &box, 6), turn), 2e-13);
	}
	rb_scene_release(&scene);
}

/* Two balls on a stick without weight: masses by their shares, the inertia of points besides their own. */
static void the_parts_of_a_union_weigh_by_their_shares(void **slot)
{
	struct rb_scene scene = scene_of();
	struct rb_error err = {0};
	const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 0.1};
	struct rb_solid_part parts[2] = {part_of(&ball, (rb_vec3){-1, 0, 0}, rb_quat_identity),
	                                 part_of(&ball, (rb_vec3){2, 0, 0}, rb_quat_identity)};
	struct rb_shape both = {.kind = RB_SHAPE_UNION};

	(void)slot;
	parts[1].share = 2;
	assert_ok(rb_scene_add_union(&scene, parts, 2, &both.solid, &err));
	const double volume = rb_shape_volume(NULL, &ball), own = 0.4 * 0.01;
	assert_near(rb_shape_volume(scene.solids, &both), 3 * volume, 1e-17);
	assert_near(scene.solids[both.solid].volume, 2 * volume, 1e-17);
	assert_near(rb_shape_centroid(scene.solids, &both).x, 1, 1e-15);
	assert_tensor(rb_shape_inertia(scene.solids, &both, 3),
	              rb_mat3_diagonal(3 * own, 6 + 3 * own, 6 + 3 * own), 1e-14);
	assert_near(rb_shape_reach(scene.solids, &both), 2.1, 1e-15);
	parts[1].share = 0;
	assert_int_equal(rb_scene_add_union(&scene, parts, 2, &both.solid, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "shape 2 must have a positive share"));
	parts[0].shape.kind = RB_SHAPE_PLANE;
	assert_int_equal(rb_scene_add_union(&scene, parts, 1, &both.solid, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "shape 1 cannot be part of a union"));
	rb_scene_release(&scene);
}

/* About the axes through the points' own mean: sums of m (y^2 + z^2), -m x y and the like, by pairs (Lagrange's identity:
 * the sum over pairs of m_i m_j d_ij^2 / M), so by another way than the function's. */
static void particles_weigh_what_their_pairs_say_wherever_they_are(void **slot)
{
	enum { COUNT = 9 };
	struct rb_particle p[COUNT];
	uint64_t seed = 1;

	(void)slot;
	for (int i = 0; i < COUNT; i++) {
		double x[4];

		for (int k = 0; k < 4; k++) {
			seed = seed * 6364136223846793005u + 1442695040888963407u;
			x[k] = (double)(seed >> 40) / (1 << 24);
		}
		p[i] = (struct rb_particle){0.5 + x[3], {x[0] + 3, x[1] - 7, x[2]}};
	}
	const struct rb_particles all = rb_particles_measure(p, COUNT);
	double mass = 0;
	rb_mat3 wanted = rb_mat3_diagonal(0, 0, 0);
	rb_vec3 pull = {0, 0, 0};

	for (int i = 0; i < COUNT; i++)
		mass += p[i].mass;
	for (int i = 0; i < COUNT; i++) {
		pull = rb_vec3_add_scaled(pull, p[i].mass, rb_vec3_sub(p[i].position, all.center));
		for (int j = 0; j < i; j++) {
			const rb_vec3 d = rb_vec3_sub(p[i].position, p[j].position);
			const double m = p[i].mass * p[j].mass / mass, x[3] = {d.x, d.y, d.z};

			for (int k = 0; k < 9; k++)
				wanted.m[k / 3][k % 3] += m * ((k / 3 == k % 3 ? rb_vec3_dot(d, d)
				                                               : 0) -
				                               x[k / 3] * x[k % 3]);
		}
	}
	assert_near(all.mass, mass, 1e-15 * mass);
	assert_near(rb_vec3_max_abs(pull), 0, 1e-14 * mass * 8);
	assert_tensor(all.inertia, wanted, 1e-14 * mass);
	assert_false(rb_particles_in_line(&all.inertia, COUNT));

	/* turned as a whole, the tensor turns with them */
	const rb_quat q = rb_quat_unit((rb_quat){0.3, -0.8, 0.4, 0.2});
	const rb_mat3 turn = rb_quat_to_mat3(q), back = rb_mat3_transposed(&turn);
	const rb_mat3 half = rb_mat3_multiply(&turn, &all.inertia);
	for (int i = 0; i < COUNT; i++)
		p[i].position = rb_quat_rotate(q, p[i].position);
	const struct rb_particles turned = rb_particles_measure(p, COUNT);
	assert_near(rb_vec3_length(rb_vec3_sub(turned.center, rb_quat_rotate(q, all.center))), 0,
	            1e-14 * 8);
	assert_tensor(turned.inertia, rb_mat3_multiply(&half, &back), 1e-13 * mass);
}

static bool in_line(const struct rb_particle *particles, size_t count)
{
	const struct rb_particles all = rb_particles_measure(particles, count);

	return rb_particles_in_line(&all.inertia, count);
}

static void particles_on_a_line_are_known_in_any_direction(void **slot)
{
	struct rb_particle p[4];

	(void)slot;
	for (int k = 0; k < 50; k++) {
		const rb_vec3 along = {cos(k), sin(k), 0.1 * k}, from = {k, -2, 1.0 / (k + 1)};

		for (int i = 0; i < 4; i++)
			p[i] = (struct rb_particle){i + 1, rb_vec3_add_scaled(from, i * i, along)};
		for (size_t count = 1; count <= 4; count++)
			assert_true(in_line(p, count));
		/* a thousandth of its length beside the line counts */
		p[1].position.z += 0.01;
		p[1].position.x += 0.01;
		assert_false(in_line(p, 4));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sphere_has_the_volume_and_inertia_of_the_books),
		cmocka_unit_test(a_plane_has_no_volume_and_no_inertia),
		cmocka_unit_test(principal_moments_do_not_depend_on_how_the_axes_stand),
		cmocka_unit_test(a_flat_body_is_possible_and_anything_beyond_is_not),
		cmocka_unit_test(a_tensor_that_is_lopsided_negative_or_not_finite_is_refused),
		cmocka_unit_test(boxes_and_cylinders_have_the_inertia_of_the_books),
		cmocka_unit_test(a_capsule_has_what_its_slices_have_together),
		cmocka_unit_test(a_needle_or_foil_as_a_hull_is_the_box_to_rounding),
		cmocka_unit_test(the_least_half_width_is_found_along_any_axis),
		cmocka_unit_test(a_box_as_a_hull_turned_and_far_away_is_still_that_box),
		cmocka_unit_test(a_corner_of_a_cube_has_its_rational_numbers),
		cmocka_unit_test(a_box_is_the_union_of_its_halves_however_they_are_made),
		cmocka_unit_test(the_parts_of_a_union_weigh_by_their_shares),
		cmocka_unit_test(particles_weigh_what_their_pairs_say_wherever_they_are),
		cmocka_unit_test(particles_on_a_line_are_known_in_any_direction),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
