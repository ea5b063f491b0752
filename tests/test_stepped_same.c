/* SPDX-License-Identifier: MIT */
/*
 * src/stepped: what must not change a bit, or hardly more: mirrors in the coordinate planes, units
 * of mass.
 */
#include "jointed.h"
#include "worlds.h"

enum { BODIES = 24, BOXES = 12, ROW = 9 };

/* A fixed number in [0, 1) for each k: golden ratio. */
static double share(int k)
{
	return fmod(0.5 + 0.6180339887498949 * k, 1);
}

static void add_body(struct lab *lab, int k, bool heavy, int mirror)
{
	struct rb_body_def def = lab_sphere_def(
		0.5, heavy && k % 4 == 3 ? 1000 : 1 + k % 3,
		mirrored((rb_vec3){1.1 * (k % 3) - 1.1 + 0.03 * share(k), 1.1 * (k / 3 % 2) - 0.5,
	                           0.6 + 1.1 * (k / 6)},
	                 mirror),
		mirrored((rb_vec3){share(3 * k) - 0.5, share(5 * k) - 0.5, -2}, mirror));

	def.angular_velocity = mirrored_spin((rb_vec3){share(7 * k), 0, share(11 * k)}, mirror);
	lab_add(lab, &def);
}

/* A heap in a box of planes; rows mirrored back. */
static void cook(bool heavy, double restitution, int mirror, double row[BODIES][ROW])
{
	struct lab lab;

	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1.0 / 120;
	lab.scene.world.gravity = mirrored((rb_vec3){0.5, 0.25, -9.81}, mirror);
	lab_surface(&lab, 0.4, restitution);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, mirrored((rb_vec3){0, 0, 1}, mirror));
	for (int k = 0; k < 4; k++) {
		const double sign = k % 2 ? 1 : -1;
		const rb_vec3 n = {k < 2 ? sign : 0, k < 2 ? 0 : sign, 0};

		lab_plane(&lab, mirrored(rb_vec3_scale(-1.8, n), mirror), mirrored(n, mirror));
	}
	for (int k = 0; k < BODIES; k++)
		add_body(&lab, k, heavy, mirror);
	lab_seal(&lab, 1);
	lab_run(&lab);
	for (int k = 0; k < BODIES; k++) {
		rb_vec3_to(row[k], mirrored(rb_world_position(lab.world, 5 + k), mirror));
		rb_vec3_to(row[k] + 3, mirrored(rb_world_velocity(lab.world, 5 + k), mirror));
		rb_vec3_to(row[k] + 6,
		           mirrored_spin(rb_world_angular_velocity(lab.world, 5 + k), mirror));
	}
	assert_true(rb_world_totals(lab.world).collisions > BODIES);
	lab_close(&lab);
}

static void assert_mirrored(bool heavy, double restitution)
{
	double wanted[BODIES][ROW], found[BODIES][ROW];

	cook(heavy, restitution, -1, wanted);
	for (int mirror = 0; mirror < 3; mirror++) {
		double most = 0;

		cook(heavy, restitution, mirror, found);
		for (int k = 0; k < BODIES; k++)
			for (int c = 0; c < ROW; c++)
				most = fmax(most, fabs(found[k][c] - wanted[k][c]));
		if (most > 0)
			fail_msg("mirrored in %c: off by up to %.3g", "xyz"[mirror], most);
	}
}

/*
 * Boxes are not to the bit: the points of a touch come in the order of features, and sweeps go in
 * that order.
 */
static void mirrored_heaps_of_spheres_are_the_same_to_the_bit(void **state)
{
	(void)state;
	assert_mirrored(false, 0);
	assert_mirrored(false, 0.6);
}

/* Masses so unequal that factors are used. */
static void mirrored_heaps_of_unequal_masses_are_too(void **state)
{
	(void)state;
	assert_mirrored(true, 0.3);
}

enum { SLIDING = 4 };

/*
 * Boxes that are far from each other: one slides and tips over its front edge, one slides and spins
 * on its face, one topples, and one lands tilted and bounces.
 */
static void slide_boxes(int mirror, double row[SLIDING][ROW])
{
	static const struct {
		rb_vec3 size, at, v, w;
		double turn;
	} box[SLIDING] = {
		{{0.19, 0.19, 0.19}, {0, 0.02, 0.095}, {1.5, -1.1, 0}, {0, 0, 0}, 0},
		{{0.3, 0.22, 0.1}, {9, 0.1, 0.05}, {-1.4, 0.3, 0}, {0, 0, 7.6}, 0},
		{{0.2, 0.3, 0.5}, {18, 0, 0.25}, {0.3, 1.2, 0}, {0, 0, 0}, 0},
		{{0.3, 0.2, 0.15}, {27, 0, 0.4}, {0.7, -0.4, -1}, {2, 1, 4}, 0.7},
	};
	struct lab lab;

	lab_open(&lab, 0.8, 60);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1.0 / 240;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(&lab, 0.6, 0.4);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < SLIDING; k++) {
		struct rb_body_def def = lab_box_def(box[k].size, 1, mirrored(box[k].at, mirror));
		const rb_vec3 turn = mirrored_spin((rb_vec3){0.3, 0.5, 0.8}, mirror);

		def.orientation = rb_quat_from_turn(rb_vec3_scale(box[k].turn, turn));
		def.velocity = mirrored(box[k].v, mirror);
		def.angular_velocity = mirrored_spin(box[k].w, mirror);
		lab_add(&lab, &def);
	}
	lab_seal(&lab, 1);
	lab_run(&lab);
	for (int k = 0; k < SLIDING; k++) {
		rb_vec3_to(row[k], mirrored(rb_world_position(lab.world, 1 + k), mirror));
		rb_vec3_to(row[k] + 3, mirrored(rb_world_velocity(lab.world, 1 + k), mirror));
		rb_vec3_to(row[k] + 6,
		           mirrored_spin(rb_world_angular_velocity(lab.world, 1 + k), mirror));
	}
	lab_close(&lab);
}

/*
 * What steps leave is a ten millionth of what the tolerance, 1e-4 of sizes, lets gaps close by in a
 * step, 1e-5 m / 4 ms: 3e-10 m/s, 200 times; and which corner bears how much is not left to order.
 */
static void mirrored_boxes_slide_topple_and_land_alike(void **state)
{
	double wanted[SLIDING][ROW], found[SLIDING][ROW];

	(void)state;
	slide_boxes(-1, wanted);
	for (int mirror = 0; mirror < 2; mirror++) {
		double most = 0;

		slide_boxes(mirror, found);
		for (int k = 0; k < SLIDING; k++)
			for (int c = 0; c < ROW; c++)
				most = fmax(most, fabs(found[k][c] - wanted[k][c]));
		if (!(most <= 6e-8))
			fail_msg("mirrored in %c: off by up to %.3g", "xyz"[mirror], most);
	}
}

/* A heap of boxes of unequal masses, two of them on a rod; positions and velocities. */
static void cook_boxes(double mass, double row[BOXES][6])
{
	struct lab lab;

	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1.0 / 120;
	lab.scene.world.gravity = (rb_vec3){0.5, 0.25, -9.81};
	lab_surface(&lab, 0.4, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < BOXES; k++) {
		const rb_vec3 at = {1.2 * (k % 2) + 0.3 * share(k), 1.2 * (k / 2 % 2),
		                    0.6 + 1.1 * (k / 4)};

		lab_box(&lab, (rb_vec3){0.5 + 0.3 * share(3 * k), 0.5, 0.6},
		        mass * (k % 8 == 7 ? 500 : 1 + share(k)), at,
		        rb_quat_unit((rb_quat){1, 0.2 * share(5 * k), 0.1, 0.3 * share(7 * k)}));
	}
	jointed_add(&lab, jointed_def(RB_JOINT_ROD, 1 + 4, 1 + 5));
	lab_seal(&lab, 1);
	lab_run(&lab);
	for (int k = 0; k < BOXES; k++) {
		rb_vec3_to(row[k], rb_world_position(lab.world, 1 + k));
		rb_vec3_to(row[k] + 3, rb_world_velocity(lab.world, 1 + k));
	}
	lab_close(&lab);
}

/* The unit of mass cancels; powers of two are exact, their roots are not. */
static void all_masses_times_a_power_of_two_move_to_the_same_bits(void **state)
{
	static const double factor[] = {2, 1.0 / 8, 1024, 0x1p-31};
	double wanted[BOXES][6], found[BOXES][6];

	(void)state;
	cook_boxes(1, wanted);
	for (int f = 0; f < 4; f++) {
		double most = 0;

		cook_boxes(factor[f], found);
		for (int k = 0; k < BOXES; k++)
			for (int c = 0; c < 6; c++)
				most = fmax(most, fabs(found[k][c] - wanted[k][c]));
		if (most > 0)
			fail_msg("masses times %g: off by up to %.3g", factor[f], most);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mirrored_heaps_of_spheres_are_the_same_to_the_bit),
		cmocka_unit_test(mirrored_heaps_of_unequal_masses_are_too),
		cmocka_unit_test(mirrored_boxes_slide_topple_and_land_alike),
		cmocka_unit_test(all_masses_times_a_power_of_two_move_to_the_same_bits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
