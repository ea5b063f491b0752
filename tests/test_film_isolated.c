/* SPDX-License-Identifier: MIT */
/* src/film/isolated.c: which spheres overlap others or rectangles, against trying all of them */
#include "support.h"

#include "film/isolated.h"
#include "math/quat.h"
#include "math/random.h"
#include "math/vec3.h"

enum { MOST = 200 };

static double uniform(uint64_t series, uint64_t k, double low, double high)
{
	return low + (high - low) * rb_random_unit(17, series, k);
}

static void spheres_that_overlap_are_found_by_trying_all_pairs(void **state)
{
	struct rb_apart apart;
	struct rb_error err;
	int alone = 0, together = 0;

	(void)state;
	rb_apart_init(&apart);
	for (uint64_t k = 0; k < 60; k++) {
		struct rb_apart_ball balls[MOST];
		const int count = (int)(k * 3) % MOST + 1;
		/* all of a size, or from small to a hundred times as large */
		const double spread = k % 2 ? 0 : 2, room = 1 + (double)(k % 7);

		for (int i = 0; i < count; i++) {
			const uint64_t at = 1000 * k + 4 * (uint64_t)i;

			balls[i] = (struct rb_apart_ball){
				.centre = {room * uniform(1, at, -5, 5),
			                   room * uniform(1, at + 1, -5, 5),
			                   uniform(1, at + 2, -5, 5)},
				.radius = 0.3 * pow(10, spread * uniform(1, at + 3, -0.5, 0.5))};
		}
		assert_ok(rb_apart_find(&apart, balls, count, &err));
		for (int i = 0; i < count; i++) {
			bool cuts = false;

			for (int j = 0; j < count; j++)
				cuts = cuts ||
				       (i != j && rb_vec3_length(rb_vec3_sub(balls[i].centre,
				                                             balls[j].centre)) <
				                          rb_apart_part * (balls[i].radius +
				                                           balls[j].radius));
			assert_int_equal(balls[i].cuts, cuts);
			alone += !cuts;
			together += cuts;
		}
	}
	assert_true(alone > 300 && together > 300);
	rb_apart_release(&apart);
	rb_apart_release(&apart);
}

/* A thousandth of a radius is not seen; more is. */
static void touching_is_not_overlapping(void **state)
{
	struct rb_apart apart;
	struct rb_error err;

	(void)state;
	rb_apart_init(&apart);
	for (int k = 0; k < 4; k++) {
		static const double gaps[] = {0.1, 0, -0.0009, -0.0011};
		struct rb_apart_ball balls[2] = {
			{.centre = {100, 0, 0}, .radius = 1},
			{.centre = {102 + 2 * gaps[k], 0, 0}, .radius = 1}};

		assert_ok(rb_apart_find(&apart, balls, 2, &err));
		assert_int_equal(balls[0].cuts, k == 3);
		assert_int_equal(balls[1].cuts, k == 3);
	}
	/* what was set before stays */
	struct rb_apart_ball one = {.radius = 1, .cuts = true};
	assert_ok(rb_apart_find(&apart, &one, 1, &err));
	assert_true(one.cuts);
	assert_ok(rb_apart_find(&apart, NULL, 0, &err));
	rb_apart_release(&apart);
}

/* The nearest of many points of it is at most half a step farther than the nearest of all. */
static void a_rectangle_is_cut_where_a_point_of_it_is_within(void **state)
{
	enum { STEPS = 60 };
	int cut = 0, missed = 0;

	(void)state;
	for (uint64_t k = 0; k < 400; k++) {
		const rb_quat turn = rb_quat_unit(
			(rb_quat){uniform(2, 9 * k, 0.1, 1), uniform(2, 9 * k + 1, -1, 1),
		                  uniform(2, 9 * k + 2, -1, 1), uniform(2, 9 * k + 3, -1, 1)});
		const double width = uniform(2, 9 * k + 4, 0.5, 4),
			     height = uniform(2, 9 * k + 5, 0.5, 4);
		const rb_vec3 u = rb_quat_rotate(turn, (rb_vec3){width, 0, 0}),
			      v = rb_quat_rotate(turn, (rb_vec3){0, height, 0}),
			      corner = {1, -2, 3};
		struct rb_apart_ball ball = {
			.centre = rb_vec3_add(corner, (rb_vec3){uniform(2, 9 * k + 6, -4, 4),
		                                                uniform(2, 9 * k + 7, -4, 4),
		                                                uniform(2, 9 * k + 8, -4, 4)})};
		double least = 1e9;

		for (int i = 0; i <= STEPS; i++)
			for (int j = 0; j <= STEPS; j++) {
				const rb_vec3 at = rb_vec3_add_scaled(
					rb_vec3_add_scaled(corner, (double)i / STEPS, u),
					(double)j / STEPS, v);
				least = fmin(least, rb_vec3_length(rb_vec3_sub(at, ball.centre)));
			}
		const double step = 0.5 * sqrt(width * width + height * height) / STEPS;
		ball.radius = (least + 1e-9) / rb_apart_part;
		assert_true(rb_apart_cuts_rectangle(&ball, corner, u, v));
		ball.radius = fmax(least - step - 1e-9, 0) / rb_apart_part;
		assert_false(rb_apart_cuts_rectangle(&ball, corner, u, v));
		ball.radius = 1;
		cut += rb_apart_cuts_rectangle(&ball, corner, u, v);
		missed += !rb_apart_cuts_rectangle(&ball, corner, u, v);
	}
	if (cut <= 10 || missed <= 10)
		fail_msg("%d cut, %d missed", cut, missed);
}

static void any_lack_of_memory_is_told(void **state)
{
	struct rb_apart_ball balls[MOST];
	enum rb_status status = RB_ERR_MEMORY;
	struct rb_error err;
	uint64_t k;

	(void)state;
	for (int i = 0; i < MOST; i++)
		balls[i] = (struct rb_apart_ball){.centre = {0.1 * i, 0, 0}, .radius = 1};
	for (k = 1; status != RB_OK; k++) {
		struct rb_apart apart;

		rb_apart_init(&apart);
		rb_memory_fail_at(k);
		status = rb_apart_find(&apart, balls, MOST, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		rb_apart_release(&apart);
	}
	assert_true(k > 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spheres_that_overlap_are_found_by_trying_all_pairs),
		cmocka_unit_test(touching_is_not_overlapping),
		cmocka_unit_test(a_rectangle_is_cut_where_a_point_of_it_is_within),
		cmocka_unit_test(any_lack_of_memory_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
