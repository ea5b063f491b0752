/* SPDX-License-Identifier: MIT */
/* src/step/broadphase.c, src/geom/grid.c */
#include "support.h"

#include "base/memory.h"
#include "geom/distance.h"
#include "math/random.h"
#include "step/broadphase.h"

enum { MOST = 100000 };

/* A model made by hand, of just the columns that a broadphase reads. */
struct lot {
	struct rb_model model;
	rb_aabb *box; /* of all that are bounded, by index; planes: unused */
	struct rb_shape *shape;
	rb_vec3 *position;
	rb_quat *orientation;
	uint64_t *group_bit, *collides;
};

static struct rb_error err;
static uint64_t draws;

static double draw(double low, double high)
{
	return low + (high - low) * rb_random_unit(11, 0, draws++);
}

static void lot_open(struct lot *lot, int moving, int statics)
{
	const size_t n = (size_t)(moving + statics);

	*lot = (struct lot){0};
	lot->box = rb_memory_take(n, sizeof *lot->box);
	lot->shape = rb_memory_take(n, sizeof *lot->shape);
	lot->position = rb_memory_take(n, sizeof *lot->position);
	lot->orientation = rb_memory_take(n, sizeof *lot->orientation);
	lot->group_bit = rb_memory_take(n, sizeof *lot->group_bit);
	lot->collides = rb_memory_take(n, sizeof *lot->collides);
	assert_true(lot->box && lot->shape && lot->position && lot->orientation && lot->group_bit &&
	            lot->collides);
	lot->model.body_count = moving;
	lot->model.static_count = statics;
	lot->model.shape = lot->shape;
	lot->model.position = lot->position;
	lot->model.orientation = lot->orientation;
}

static void lot_close(struct lot *lot)
{
	rb_memory_free(lot->box);
	rb_memory_free(lot->shape);
	rb_memory_free(lot->position);
	rb_memory_free(lot->orientation);
	rb_memory_free(lot->group_bit);
	rb_memory_free(lot->collides);
}

static void put_sphere(struct lot *lot, int i, rb_vec3 p, double r)
{
	lot->shape[i] = (struct rb_shape){.kind = RB_SHAPE_SPHERE, .radius = r};
	lot->position[i] = p;
	lot->orientation[i] = rb_quat_identity;
	lot->box[i] = (rb_aabb){{p.x - r, p.y - r, p.z - r}, {p.x + r, p.y + r, p.z + r}};
}

static void put_sheet(struct lot *lot, int i, rb_vec3 p, rb_quat q, double w, double h)
{
	const double size[2] = {w, h};
	const rb_rectangle r = rb_rectangle_of(p, q, size);

	lot->shape[i] = (struct rb_shape){.kind = RB_SHAPE_RECTANGLE, .size = {w, h}};
	lot->position[i] = p;
	lot->orientation[i] = q;
	lot->box[i] = (rb_aabb){p, p};
	/* the box of the four corners */
	for (int k = 0; k < 4; k++) {
		rb_vec3 c = rb_vec3_add_scaled(p, (k & 1) ? 0.5 * w : -0.5 * w, r.axis_x);
		c = rb_vec3_add_scaled(c, (k & 2) ? 0.5 * h : -0.5 * h, r.axis_y);
		rb_aabb *box = &lot->box[i];
		box->low = (rb_vec3){fmin(box->low.x, c.x), fmin(box->low.y, c.y),
		                     fmin(box->low.z, c.z)};
		box->high = (rb_vec3){fmax(box->high.x, c.x), fmax(box->high.y, c.y),
		                      fmax(box->high.z, c.z)};
	}
}

static void put_plane(struct lot *lot, int i, rb_vec3 p, rb_quat q)
{
	lot->shape[i] = (struct rb_shape){.kind = RB_SHAPE_PLANE};
	lot->position[i] = p;
	lot->orientation[i] = q;
}

static bool behind(const struct lot *lot, int plane, const rb_aabb *box)
{
	const rb_vec3 n = rb_plane_normal(lot->orientation[plane]);
	double lowest = (double)INFINITY;

	for (int k = 0; k < 8; k++) {
		const rb_vec3 c = {(k & 1) ? box->low.x : box->high.x,
		                   (k & 2) ? box->low.y : box->high.y,
		                   (k & 4) ? box->low.z : box->high.z};
		lowest = fmin(lowest, rb_vec3_dot(rb_vec3_sub(c, lot->position[plane]), n));
	}
	return lowest <= 0;
}

static bool expected(const struct lot *lot, int a, int b)
{
	if (lot->model.group_bit &&
	    (!(lot->collides[a] & lot->group_bit[b]) || !(lot->collides[b] & lot->group_bit[a])))
		return false;
	if (lot->shape[b].kind == RB_SHAPE_PLANE)
		return behind(lot, b, &lot->box[a]);
	return rb_aabb_overlap(&lot->box[a], &lot->box[b]) != 0;
}

/* All pairs by the plain double loop, which is also the order that is promised. */
static size_t assert_same_as_brute_force(const struct lot *lot)
{
	const int all = lot->model.body_count + lot->model.static_count;
	struct rb_broadphase *broadphase;
	const struct rb_pair *pairs;
	size_t count, k = 0;

	assert_ok(rb_broadphase_create(&broadphase, &lot->model, &err));
	for (int round = 0; round < 2; round++) {
		assert_ok(rb_broadphase_find(broadphase, lot->box, &pairs, &count, &err));
		k = 0;
		for (int a = 0; a < lot->model.body_count; a++) {
			for (int b = a + 1; b < all; b++) {
				const bool found = k < count && pairs[k].a == a && pairs[k].b == b;
				if (found != expected(lot, a, b))
					fail_msg("pair %d, %d: %s", a, b,
					         found ? "too much" : "missing");
				k += found;
			}
		}
		assert_int_equal(k, count);
	}
	rb_broadphase_destroy(broadphase);
	return k;
}

static rb_vec3 draw_point(double size)
{
	const double x = draw(-size, size), y = draw(-size, size);

	return (rb_vec3){x, y, draw(-size, size)};
}

static rb_quat draw_turn(void)
{
	return rb_quat_from_turn(draw_point(3));
}

/* Sizes over `decades` decades, statics of all kinds mixed. */
static void fill_lot(struct lot *lot, double decades)
{
	const int moving = lot->model.body_count, all = moving + lot->model.static_count;

	for (int i = 0; i < all; i++) {
		const double r = pow(10, draw(-decades, 0));
		const double spread = cbrt(all) * 0.8;

		if (i < moving || i % 4 == 0)
			put_sphere(lot, i, draw_point(spread), r);
		else if (i % 4 == 1)
			put_sheet(lot, i, draw_point(spread), draw_turn(), 4 * r, r);
		else if (i % 4 == 2)
			put_plane(lot, i, draw_point(spread), draw_turn());
		else
			put_sheet(lot, i, draw_point(spread), rb_quat_identity, 50 * r, r);
		lot->group_bit[i] = UINT64_C(1) << (int)draw(0, 3.999);
		lot->collides[i] = (uint64_t)draw(0, 15.999);
	}
}

static void random_boxes_of_mixed_sizes_give_the_pairs_of_brute_force(void **slot)
{
	static const int counts[][2] = {{1, 0},  {2, 0},   {0, 3},   {1, 1},    {20, 4},
	                                {33, 0}, {60, 40}, {400, 9}, {500, 300}};

	(void)slot;
	for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
		for (int k = 0; k < 8; k++) {
			struct lot lot;

			lot_open(&lot, counts[c][0], counts[c][1]);
			fill_lot(&lot, 0.6 * k);
			assert_same_as_brute_force(&lot);
			lot.model.group_bit = lot.group_bit;
			lot.model.collides = lot.collides;
			assert_same_as_brute_force(&lot);
			lot_close(&lot);
		}
	}
}

static void boxes_that_touch_and_boxes_of_no_size_count(void **slot)
{
	struct lot lot;

	(void)slot;
	/* a lattice of unit cubes: each touches the 26 around it */
	lot_open(&lot, 6 * 6 * 6, 0);
	for (int i = 0; i < 216; i++)
		put_sphere(&lot, i, (rb_vec3){i % 6, i / 6 % 6, i / 36}, 0.5);
	assert_int_equal(assert_same_as_brute_force(&lot), (16 * 16 * 16 - 216) / 2);
	/* points, ten of them at each place */
	for (int i = 0; i < 216; i++)
		put_sphere(&lot, i, (rb_vec3){i / 10, 0, -0.0}, 0);
	assert_int_equal(assert_same_as_brute_force(&lot), 21 * 45 + 15);
	lot_close(&lot);
}

static void extreme_coordinates_and_sizes_neither_hang_nor_lose_a_pair(void **slot)
{
	static const double scales[] = {0, 1e-308, 1e-300, 1e-150, 1e-9,
	                                1, 1e9,    1e15,   1e150,  1e300};
	enum { SCALES = sizeof scales / sizeof scales[0] };
	struct lot lot;

	(void)slot;
	lot_open(&lot, 300, 0);
	for (int k = 0; k < 20; k++) {
		for (int i = 0; i < 300; i++)
			put_sphere(&lot, i, draw_point(scales[(int)draw(0, SCALES)]),
			           scales[(int)draw(0, SCALES)] * draw(0, 1));
		assert_same_as_brute_force(&lot);
	}
	/* all far from the origin, where a coordinate's ulp is larger than the smaller ones */
	for (int i = 0; i < 300; i++)
		put_sphere(&lot, i,
		           (rb_vec3){1e15 + (int)draw(0, 20), -1e15 - (int)draw(0, 20), 1e15},
		           draw(0, 2));
	assert_true(assert_same_as_brute_force(&lot) > 1000);
	for (int i = 0; i < 300; i++)
		lot.box[i] = (rb_aabb){{-1.7e308, -1.7e308, -1.7e308},
		                       {1.7e308, 1.7e308, i % 2 ? 1 : 1.7e308}};
	assert_int_equal(assert_same_as_brute_force(&lot), 300 * 299 / 2);
	lot_close(&lot);
}

static void a_box_that_is_not_finite_is_an_error(void **slot)
{
	struct rb_broadphase *broadphase;
	const struct rb_pair *pairs;
	struct lot lot;
	size_t count;

	(void)slot;
	lot_open(&lot, 100, 0);
	for (int i = 0; i < 100; i++)
		put_sphere(&lot, i, draw_point(10), 1);
	assert_ok(rb_broadphase_create(&broadphase, &lot.model, &err));
	lot.box[50].low.y = (double)NAN;
	assert_int_equal(rb_broadphase_find(broadphase, lot.box, &pairs, &count, &err),
	                 RB_ERR_PHYSICS);
	lot.box[50].low.y = -(double)INFINITY;
	assert_int_equal(rb_broadphase_find(broadphase, lot.box, &pairs, &count, &err),
	                 RB_ERR_PHYSICS);
	assert_int_equal(count, 0);
	rb_broadphase_destroy(broadphase);
	lot_close(&lot);
}

/* Box tests of one call per body. */
static double tests_per_body(const struct lot *lot)
{
	struct rb_broadphase *broadphase;
	const struct rb_pair *pairs;
	size_t count;

	assert_ok(rb_broadphase_create(&broadphase, &lot->model, &err));
	assert_ok(rb_broadphase_find(broadphase, lot->box, &pairs, &count, &err));
	const double tests = (double)rb_broadphase_tests(broadphase);
	rb_broadphase_destroy(broadphase);
	return tests / lot->model.body_count;
}

enum scatter { ONE_SIZE, TWO_SIZES, ON_A_LINE, ON_A_PLANE, SPACED_LINE, SCATTER_COUNT };

static void scatter(struct lot *lot, int n, enum scatter how)
{
	lot_open(lot, n, 0);
	for (int i = 0; i < n; i++) {
		const double u = draw(0, 1), v = draw(0, 1), w = draw(0, 1);
		const double cube = cbrt(n * 2.0), square = sqrt(n * 1.0), wide = cbrt(n * 20.0);

		switch (how) {
		case TWO_SIZES:
			put_sphere(lot, i, (rb_vec3){wide * u, wide * v, wide * w},
			           i % 2 ? 1 : 1e-3);
			break;
		case ON_A_LINE:
			put_sphere(lot, i, (rb_vec3){0, n * u, 0}, 0.3);
			break;
		case ON_A_PLANE:
			put_sphere(lot, i, (rb_vec3){square * u, 5, square * w}, 0.3);
			break;
		case SPACED_LINE:
			put_sphere(lot, i, (rb_vec3){1024.0 * i, 0, 0}, 0.4);
			break;
		default:
			put_sphere(lot, i, (rb_vec3){cube * u, cube * v, cube * w}, 0.3);
		}
	}
}

static void tests_per_body_stay_within_twice_from_1000_to_100000_bodies(void **slot)
{
	(void)slot;
	for (int how = 0; how < SCATTER_COUNT; how++) {
		struct lot few, many;

		scatter(&few, 1000, (enum scatter)how);
		scatter(&many, MOST, (enum scatter)how);
		const double a = tests_per_body(&few), b = tests_per_body(&many);
		print_message("arrangement %d: %.3f and %.3f tests per body\n", how, a, b);
		/* the few have more of their neighbourhood outside */
		assert_true(b <= 2 * a + 1e-3);
		lot_close(&few);
		lot_close(&many);
	}
}

static void after_the_first_calls_nothing_is_allocated(void **slot)
{
	struct rb_broadphase *broadphase;
	const struct rb_pair *pairs;
	struct lot lot;
	size_t count;

	(void)slot;
	lot_open(&lot, 500, 0);
	for (int i = 0; i < 500; i++)
		put_sphere(&lot, i, draw_point(4), 0.5);
	assert_ok(rb_broadphase_create(&broadphase, &lot.model, &err));
	assert_ok(rb_broadphase_find(broadphase, lot.box, &pairs, &count, &err));
	const uint64_t before = rb_memory_counts().taken;
	for (int k = 0; k < 10; k++)
		assert_ok(rb_broadphase_find(broadphase, lot.box, &pairs, &count, &err));
	assert_int_equal(rb_memory_counts().taken, before);
	rb_broadphase_destroy(broadphase);
	lot_close(&lot);
}

static void running_out_of_memory_is_an_error_at_every_allocation(void **slot)
{
	const struct rb_pair *pairs;
	struct lot lot;
	size_t count;
	bool whole = false;

	(void)slot;
	lot_open(&lot, 200, 20);
	fill_lot(&lot, 1);
	lot.model.group_bit = lot.group_bit;
	lot.model.collides = lot.collides;
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1; !whole && k < 100; k++) {
		struct rb_broadphase *broadphase;

		rb_memory_fail_at(k);
		enum rb_status status = rb_broadphase_create(&broadphase, &lot.model, &err);
		if (status == RB_OK)
			status = rb_broadphase_find(broadphase, lot.box, &pairs, &count, &err);
		rb_memory_fail_at(0);
		whole = status == RB_OK;
		assert_true(whole || status == RB_ERR_MEMORY);
		rb_broadphase_destroy(broadphase);
	}
	assert_true(whole);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
	lot_close(&lot);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(random_boxes_of_mixed_sizes_give_the_pairs_of_brute_force),
		cmocka_unit_test(boxes_that_touch_and_boxes_of_no_size_count),
		cmocka_unit_test(extreme_coordinates_and_sizes_neither_hang_nor_lose_a_pair),
		cmocka_unit_test(a_box_that_is_not_finite_is_an_error),
		cmocka_unit_test(tests_per_body_stay_within_twice_from_1000_to_100000_bodies),
		cmocka_unit_test(after_the_first_calls_nothing_is_allocated),
		cmocka_unit_test(running_out_of_memory_is_an_error_at_every_allocation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
