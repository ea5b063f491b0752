/* SPDX-License-Identifier: MIT */
/* src/sweep/sample.c: Latin hypercubes, seeds of runs */
#include "support.h"

#include "sweep/sample.h"

/* Each of so many equal parts of every axis holds one point, whatever their number. */
static void every_part_of_every_axis_holds_one_point(void **state)
{
	static const uint64_t counts[] = {1, 2, 3, 7, 49, 64, 1000, 65537};
	enum { AXES = 3 };
	struct rb_error err;

	(void)state;
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		const uint64_t count = counts[c];
		unsigned char *const seen = rb_memory_take(AXES * count, 1);
		struct rb_sample sample;

		assert_non_null(seen);
		assert_ok(rb_sample_init(&sample, 5, count, AXES, &err));
		for (int axis = 0; axis < AXES; axis++) {
			for (uint64_t k = 0; k < count; k++) {
				const double unit = rb_sample_unit(&sample, axis, k);
				/* a part's lower end is rounded as well */
				const uint64_t part = (uint64_t)(unit * (double)count *
				                                 (1 + 0x1p-52));

				assert_true(unit >= 0 && unit < 1);
				assert_true(part < count);
				seen[(uint64_t)axis * count + part]++;
			}
		}
		for (uint64_t i = 0; i < AXES * count; i++)
			assert_int_equal(seen[i], 1);
		rb_sample_release(&sample);
		rb_memory_free(seen);
	}
}

/* How often point k has part p, over many seeds: a binomial number, within five deviations. */
static void every_order_of_the_parts_is_as_likely(void **state)
{
	enum { COUNT = 5, SEEDS = 10000 };
	int found[COUNT][COUNT] = {{0}}, same = 0;
	struct rb_sample sample;
	struct rb_error err;

	(void)state;
	for (uint64_t seed = 0; seed < SEEDS; seed++) {
		bool equal = true;

		assert_ok(rb_sample_init(&sample, seed, COUNT, 2, &err));
		for (uint64_t k = 0; k < COUNT; k++) {
			const int part = (int)(rb_sample_unit(&sample, 0, k) * COUNT);

			found[k][part]++;
			equal = equal && part == (int)(rb_sample_unit(&sample, 1, k) * COUNT);
		}
		same += equal;
		rb_sample_release(&sample);
	}
	const double mean = SEEDS / (double)COUNT, deviation = sqrt(mean * (1 - 1.0 / COUNT));
	for (int k = 0; k < COUNT; k++)
		for (int p = 0; p < COUNT; p++)
			assert_near(found[k][p], mean, 5 * deviation);
	/* the second axis has an order of its own: one of 120 */
	assert_near(same, SEEDS / 120.0, 5 * sqrt(SEEDS / 120.0));
}

/* Within its part a point is anywhere: n uniform numbers have a mean of deviation 1/sqrt(12 n). */
static void points_lie_anywhere_within_their_parts(void **state)
{
	enum { COUNT = 4000 };
	struct rb_sample sample;
	struct rb_error err;
	double sum[2] = {0}, product = 0;

	(void)state;
	assert_ok(rb_sample_init(&sample, 11, COUNT, 2, &err));
	for (uint64_t k = 0; k < COUNT; k++) {
		double within[2];

		for (int axis = 0; axis < 2; axis++) {
			const double place = rb_sample_unit(&sample, axis, k) * COUNT;
			within[axis] = place - floor(place);
			sum[axis] += within[axis];
		}
		product += (within[0] - 0.5) * (within[1] - 0.5);
	}
	for (int axis = 0; axis < 2; axis++)
		assert_near(sum[axis] / COUNT, 0.5, 5 / sqrt(12.0 * COUNT));
	/* those of two axes have nothing to do with each other: the product's deviation is 1/12 */
	assert_near(product / COUNT, 0, 5 / 12.0 / sqrt((double)COUNT));
	rb_sample_release(&sample);
}

static void a_seed_gives_its_sample_again(void **state)
{
	enum { COUNT = 50 };
	struct rb_sample a, b, c;
	struct rb_error err;
	int same = 0;

	(void)state;
	assert_ok(rb_sample_init(&a, 3, COUNT, 2, &err));
	assert_ok(rb_sample_init(&b, 3, COUNT, 2, &err));
	assert_ok(rb_sample_init(&c, 4, COUNT, 2, &err));
	for (uint64_t k = 0; k < COUNT; k++) {
		assert_true(rb_sample_unit(&a, 1, k) == rb_sample_unit(&b, 1, k));
		same += rb_sample_unit(&a, 1, k) == rb_sample_unit(&c, 1, k);
	}
	assert_int_equal(same, 0);
	rb_sample_release(&a);
	rb_sample_release(&b);
	rb_sample_release(&c);
	rb_sample_release(&c);
}

static int by_number(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

	return (x > y) - (x < y);
}

static void seeds_of_runs_differ_and_fit_a_signed_integer(void **state)
{
	enum { BASES = 20, RUNS = 5000 };
	static uint64_t seeds[BASES * RUNS];
	int bits[63] = {0};

	(void)state;
	for (uint64_t i = 0; i < BASES * RUNS; i++) {
		seeds[i] = rb_sample_seed(i / RUNS, i % RUNS);
		assert_true(seeds[i] <= INT64_MAX);
		assert_true(seeds[i] == rb_sample_seed(i / RUNS, i % RUNS));
		for (int b = 0; b < 63; b++)
			bits[b] += (int)(seeds[i] >> b & 1);
	}
	for (int b = 0; b < 63; b++)
		assert_near(bits[b], BASES * RUNS / 2.0, 5 * sqrt(BASES * RUNS / 4.0));
	qsort(seeds, BASES * RUNS, sizeof *seeds, by_number);
	for (size_t i = 1; i < BASES * RUNS; i++)
		assert_true(seeds[i] != seeds[i - 1]);
	assert_true(rb_sample_seed(UINT64_MAX, UINT64_MAX) <= INT64_MAX);
}

static void no_memory_is_told_as_such(void **state)
{
	struct rb_sample sample;
	struct rb_error err;

	(void)state;
	rb_memory_fail_at(1);
	const enum rb_status status = rb_sample_init(&sample, 1, 1000, 2, &err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_string_equal(err.text, "cannot draw a sample of 1000 points: out of memory");
	rb_sample_release(&sample);
	/* without axes there is nothing to draw from, and nothing wrong */
	assert_ok(rb_sample_init(&sample, 1, 10, 0, &err));
	rb_sample_release(&sample);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_part_of_every_axis_holds_one_point),
		cmocka_unit_test(every_order_of_the_parts_is_as_likely),
		cmocka_unit_test(points_lie_anywhere_within_their_parts),
		cmocka_unit_test(a_seed_gives_its_sample_again),
		cmocka_unit_test(seeds_of_runs_differ_and_fit_a_signed_integer),
		cmocka_unit_test(no_memory_is_told_as_such),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
