/* SPDX-License-Identifier: MIT */
/* src/math/quat.h */
#include "turns.h"

static const double pi = 3.14159265358979323846;

static void a_turn_of_a_quarter_about_z_takes_x_to_y(void **state)
{
	const rb_quat q = rb_quat_from_turn(rb_vec3_of(0, 0, pi / 2));

	(void)state;
	assert_same_vector(rb_quat_rotate(q, rb_vec3_of(1, 0, 0)), rb_vec3_of(0, 1, 0), 1e-15);
	assert_same_vector(rb_quat_rotate_back(q, rb_vec3_of(0, 1, 0)), rb_vec3_of(1, 0, 0), 1e-15);
}

static void the_matrix_of_a_quaternion_rotates_alike(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_quat q = some_rotation(k);
		const rb_mat3 r = rb_quat_to_mat3(q);
		assert_same_vector(rb_mat3_apply(&r, some_vector(k)),
		                   rb_quat_rotate(q, some_vector(k)), 1e-14);
	}
}

static void a_product_rotates_by_the_right_factor_first(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_quat a = some_rotation(k), b = some_rotation(k + 1000);
		assert_same_vector(rb_quat_rotate(rb_quat_multiply(a, b), some_vector(k)),
		                   rb_quat_rotate(a, rb_quat_rotate(b, some_vector(k))), 1e-14);
	}
}

static void a_quaternion_survives_its_matrix_in_every_branch(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 1000; k++) {
		rb_quat q = some_rotation(k);
		if (k % 5 == 1)
			q = rb_quat_unit((rb_quat){1e-9, 1, 0.1, 0});
		else if (k % 5 == 2)
			q = rb_quat_unit((rb_quat){0, 0.1, 1, 1e-9});
		else if (k % 5 == 3)
			q = (rb_quat){0, 0, 0, 1};
		const rb_mat3 r = rb_quat_to_mat3(q);
		const rb_quat p = rb_quat_from_mat3(&r);
		/* q and -q are the same rotation */
		const double sign = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
		assert_near(sign * p.w, q.w, 1e-15 * 4);
		assert_near(sign * p.x, q.x, 1e-15 * 4);
		assert_near(sign * p.y, q.y, 1e-15 * 4);
		assert_near(sign * p.z, q.z, 1e-15 * 4);
	}
}

static void small_turns_join_large_ones_without_a_jump(void **state)
{
	(void)state;
	for (int e = -40; e <= 2; e++) {
		for (int side = 0; side < 3; side++) {
			const double angle = side == 0 ? ldexp(1, e)
			                               : 1e-4 * (side == 1 ? 1 - 1e-12 : 1 + 1e-12);
			const rb_quat q = rb_quat_from_turn(rb_vec3_of(0, angle, 0));
			assert_near(q.y / sin(angle / 2), 1, 4e-16);
			assert_near(rb_quat_length(q), 1, 4e-16);
		}
	}
	const rb_quat none = rb_quat_from_turn(rb_vec3_of(0, 0, 0));
	assert_near(none.w, 1, 0);
	assert_near(none.x, 0, 0);
}

static void columns_round_trip(void **state)
{
	double p[4];

	(void)state;
	rb_quat_to(p, (rb_quat){1, 2, 3, 4});
	const rb_quat q = rb_quat_from(p);
	assert_true(p[0] == 1 && p[3] == 4 && q.w == 1 && q.x == 2 && q.y == 3 && q.z == 4);
	rb_vec3_to(p, rb_vec3_of(5, 6, 7));
	assert_same_vector(rb_vec3_from(p), rb_vec3_of(5, 6, 7), 0);
}

/* By Rodrigues' formula: v cos + (u x v) sin + u (u.v)(1 - cos). */
static void a_turn_rotates_by_its_length_about_its_direction(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_vec3 turn = some_vector(k + 3000), v = some_vector(k);
		const double angle = rb_vec3_length(turn);
		const rb_vec3 u = rb_vec3_scale(1 / angle, turn);
		const rb_vec3 wanted = rb_vec3_add(
			rb_vec3_add_scaled(rb_vec3_scale(cos(angle), v), sin(angle),
		                           rb_vec3_cross(u, v)),
			rb_vec3_scale(rb_vec3_dot(u, v) * (1 - cos(angle)), u));

		assert_same_vector(rb_quat_rotate(rb_quat_from_turn(turn), v), wanted, 1e-14);
	}
}

static void rotating_back_undoes_a_rotation_and_keeps_lengths(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_quat q = some_rotation(k);
		const rb_vec3 v = some_vector(k), turned = rb_quat_rotate(q, v);

		assert_same_vector(rb_quat_rotate_back(q, turned), v, 1e-14);
		assert_near(rb_vec3_length(turned), rb_vec3_length(v), 4e-15);
	}
	assert_same_vector(rb_quat_rotate(rb_quat_identity, rb_vec3_of(1, 2, 3)),
	                   rb_vec3_of(1, 2, 3), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_turn_of_a_quarter_about_z_takes_x_to_y),
		cmocka_unit_test(the_matrix_of_a_quaternion_rotates_alike),
		cmocka_unit_test(a_product_rotates_by_the_right_factor_first),
		cmocka_unit_test(a_quaternion_survives_its_matrix_in_every_branch),
		cmocka_unit_test(small_turns_join_large_ones_without_a_jump),
		cmocka_unit_test(columns_round_trip),
		cmocka_unit_test(a_turn_rotates_by_its_length_about_its_direction),
		cmocka_unit_test(rotating_back_undoes_a_rotation_and_keeps_lengths),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
