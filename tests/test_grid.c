/* SPDX-License-Identifier: MIT */
/* src/geom/grid.c: boxes -> pairs of boxes that overlap */
#include "support.h"

#include "base/team.h"
#include "geom/grid.h"
#include "math/random.h"

enum { MOVING = 300, FIXED = 60, ALL = MOVING + FIXED };

struct boxes {
	rb_aabb box[ALL];
	uint64_t group[ALL], collides[ALL];
	bool pair[ALL][ALL]; /* by trying all */
};

static double in(double low, double high, uint64_t stream, uint64_t k)
{
	return low + (high - low) * rb_random_unit(5, stream, k);
}

/* Sizes over `octaves` powers of two, places over `space`. */
static void make(struct boxes *b, double octaves, double space, uint64_t stream)
{
	for (uint64_t i = 0; i < ALL; i++) {
		const double size = exp2(-octaves * rb_random_unit(6, stream, i));
		const rb_vec3 at = {in(-space, space, stream + 10, i),
		                    in(-space, space, stream + 20, i),
		                    in(-space, space, stream + 30, i)};

		b->box[i] = (rb_aabb){at, {at.x + size, at.y + 0.7 * size, at.z + 1.3 * size}};
		b->group[i] = UINT64_C(1) << (i % 3);
		b->collides[i] = i % 5 == 0 ? 3 : UINT64_MAX;
	}
}

static void find(struct rb_grid *grid, struct boxes *b, bool filters)
{
	const struct rb_grid_boxes boxes = {.moving = b->box,
	                                    .fixed = b->box + MOVING,
	                                    .moving_count = MOVING,
	                                    .fixed_count = FIXED,
	                                    .group_bit = filters ? b->group : NULL,
	                                    .collides = filters ? b->collides : NULL};
	struct rb_error err;
	size_t wanted = 0;

	for (int i = 0; i < ALL; i++)
		for (int j = i + 1; j < ALL; j++) {
			const rb_aabb *const p = &b->box[i], *const q = &b->box[j];

			b->pair[i][j] = i < MOVING && p->low.x <= q->high.x &&
			                q->low.x <= p->high.x && p->low.y <= q->high.y &&
			                q->low.y <= p->high.y && p->low.z <= q->high.z &&
			                q->low.z <= p->high.z &&
			                (!filters || ((b->collides[i] & b->group[j]) &&
			                              (b->collides[j] & b->group[i])));
			wanted += b->pair[i][j];
		}
	assert_ok(rb_grid_find(grid, &boxes, &err));
	assert_ok(rb_grid_sort(grid, ALL, &err));
	assert_int_equal(grid->pair_count, wanted);
	for (size_t k = 0; k < grid->pair_count; k++) {
		const struct rb_pair pair = grid->pairs[k];

		assert_true(pair.a < pair.b && b->pair[pair.a][pair.b]);
		if (k > 0)
			assert_true(
				grid->pairs[k - 1].a < pair.a ||
				(grid->pairs[k - 1].a == pair.a && grid->pairs[k - 1].b < pair.b));
	}
}

static struct boxes b;

static void pairs_are_those_that_trying_all_finds_whatever_the_sizes(void **state)
{
	static const double octaves[] = {0, 2, 10, 30}, space[] = {0, 1, 6, 40, 1e6};
	struct rb_error err;

	(void)state;
	for (int workers = 0; workers <= 3; workers += 3) { /* 0: without a team */
		struct rb_grid grid;
		size_t found = 0;

		rb_grid_init(&grid);
		if (workers > 0)
			assert_ok(rb_team_create(&grid.team, workers, &err));
		for (uint64_t k = 0; k < 20; k++) {
			const uint64_t tests = grid.tests;

			make(&b, octaves[k % 4], space[k / 4], k);
			find(&grid, &b, k % 2);
			found += grid.pair_count;
			assert_true(grid.tests > tests || grid.pair_count == 0);
		}
		assert_true(found > 1000);
		rb_team_destroy(grid.team);
		rb_grid_release(&grid);
		rb_grid_release(&grid);
	}
}

static void boxes_that_touch_overlap(void **state)
{
	const rb_aabb box[] = {{{0, 0, 0}, {1, 1, 1}},
	                       {{1, 1, 1}, {2, 2, 2}},                 /* at a corner */
	                       {{-1, 0, 0}, {nextafter(0, -1), 1, 1}}, /* just not */
	                       {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}};    /* a point */
	const struct rb_grid_boxes boxes = {.moving = box, .moving_count = 4};
	struct rb_error err;
	struct rb_grid grid;

	(void)state;
	rb_grid_init(&grid);
	assert_ok(rb_grid_find(&grid, &boxes, &err));
	assert_ok(rb_grid_sort(&grid, 4, &err));
	assert_int_equal(grid.pair_count, 2);
	assert_true(grid.pairs[0].a == 0 && grid.pairs[0].b == 1);
	assert_true(grid.pairs[1].a == 0 && grid.pairs[1].b == 3);
	rb_grid_release(&grid);
}

/* A hundred times as many boxes at the same density: about a hundred times as many tests, not ten thousand. */
static void tests_do_not_grow_with_the_square_of_the_boxes(void **state)
{
	uint64_t tests[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		const int side = k == 0 ? 6 : 28, count = side * side * side;
		rb_aabb *const box = malloc((size_t)count * sizeof *box);
		struct rb_error err;
		struct rb_grid grid;

		assert_non_null(box);
		for (int i = 0; i < count; i++) {
			const rb_vec3 at = {i % side, i / side % side, i / side / side};

			box[i] = (rb_aabb){at, {at.x + 0.9, at.y + 0.9, at.z + 0.9}};
		}
		const struct rb_grid_boxes boxes = {.moving = box, .moving_count = count};
		rb_grid_init(&grid);
		assert_ok(rb_grid_find(&grid, &boxes, &err));
		assert_int_equal(grid.pair_count, 0);
		tests[k] = grid.tests / (uint64_t)count;
		rb_grid_release(&grid);
		free(box);
	}
	assert_true(tests[1] <= 2 * tests[0] + 2);
}

static void pairs_from_elsewhere_are_sorted_among_the_others(void **state)
{
	const rb_aabb box[] = {
		{{0, 0, 0}, {1, 1, 1}}, {{9, 9, 9}, {10, 10, 10}}, {{0, 0, 0}, {1, 1, 1}}};
	const struct rb_grid_boxes boxes = {.moving = box, .moving_count = 3};
	struct rb_error err;
	struct rb_grid grid;

	(void)state;
	rb_grid_init(&grid);
	assert_ok(rb_grid_find(&grid, &boxes, &err));
	assert_ok(rb_grid_add_pair(&grid, 1, 2, &err));
	assert_ok(rb_grid_add_pair(&grid, 0, 1, &err));
	assert_ok(rb_grid_sort(&grid, 3, &err));
	assert_int_equal(grid.pair_count, 3);
	assert_true(grid.pairs[0].a == 0 && grid.pairs[0].b == 1);
	assert_true(grid.pairs[1].a == 0 && grid.pairs[1].b == 2);
	assert_true(grid.pairs[2].a == 1 && grid.pairs[2].b == 2);
	rb_grid_release(&grid);
}

static void every_allocation_may_fail(void **state)
{
	const struct rb_grid_boxes boxes = {.moving = b.box,
	                                    .fixed = b.box + MOVING,
	                                    .moving_count = MOVING,
	                                    .fixed_count = FIXED};
	enum rb_status status = RB_ERR_MEMORY;
	int failures = 0;

	(void)state;
	make(&b, 5, 2, 77);
	for (uint64_t k = 1; status != RB_OK; k++) {
		struct rb_error err;
		struct rb_grid grid;

		rb_grid_init(&grid);
		rb_memory_fail_at(k);
		status = rb_grid_find(&grid, &boxes, &err);
		if (status == RB_OK)
			status = rb_grid_sort(&grid, ALL, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		failures += status != RB_OK;
		rb_grid_release(&grid);
	}
	assert_true(failures >= 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pairs_are_those_that_trying_all_finds_whatever_the_sizes),
		cmocka_unit_test(boxes_that_touch_overlap),
		cmocka_unit_test(tests_do_not_grow_with_the_square_of_the_boxes),
		cmocka_unit_test(pairs_from_elsewhere_are_sorted_among_the_others),
		cmocka_unit_test(every_allocation_may_fail),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
