/* SPDX-License-Identifier: MIT */
/* math/gauss: no step is accepted with a rate or an error estimate that is not a number. */
#include <float.h>

#include "math/gauss.h"
#include "math/gauss_error.h"
#include "math/gauss_newton.h"
#include "math/gauss_tables.h"
#include "support.h"

enum { ROWS = 6, NODES = RB_GAUSS_NODES };

/* A step of smooth rates that is accepted, and grows. */
static const double length_s = 0x1p-4;

/* y' = -speed y, where `row` is not a number from `from_s` to `to_s`, and in that call. */
struct decay {
	double speed[ROWS], from_s, to_s;
	int row, call, calls;
};

static enum rb_status rates(void *user, double t, const double *y, double *rate,
                            struct rb_error *err)
{
	struct decay *const d = user;

	(void)err;
	for (int i = 0; i < ROWS; i++) {
		assert_true(isfinite(y[i]));
		rate[i] = -d->speed[i] * y[i];
	}
	if (++d->calls == d->call || (t >= d->from_s && t <= d->to_s))
		rate[d->row] = (double)NAN;
	return RB_OK;
}

/* A step that begins with `try_s`; one that is accepted is right everywhere. */
static enum rb_status step(struct decay *d, struct rb_gauss_problem problem, double *try_s,
                           struct rb_error *err)
{
	static const double scale[ROWS] = {1, 1, 1, 1, 1, 1};
	double start[ROWS] = {1, 2, 3, 4, 5, 6}, coefficient[ROWS * NODES], value[ROWS];
	double scratch[20 * ROWS];
	struct rb_gauss_piece piece = {.n = ROWS, .start = start, .coefficient = coefficient};
	uint64_t calls = 0;

	assert_true(rb_gauss_scratch_size(ROWS) <= sizeof scratch / sizeof *scratch);
	problem.n = ROWS;
	problem.rates = rates;
	problem.user = d;
	problem.scale = scale;
	problem.tolerance = 1e-13;
	problem.scratch = scratch;
	problem.calls = &calls;
	const enum rb_status status = rb_gauss_step(&problem, 0, try_s, 1e-9, &piece, err);
	for (int k = 0; k <= 8 && status == RB_OK; k++) {
		const double t = k * piece.length_s / 8;

		rb_gauss_values(&piece, t, value);
		for (int i = 0; i < ROWS; i++)
			assert_near(value[i], start[i] * exp(-d->speed[i] * t), 1e-11);
	}
	return status;
}

static struct decay slow(int row, double from_s, double to_s)
{
	return (struct decay){.speed = {0.5, 0.625, 0.75, 0.875, 1, 1.125},
	                      .from_s = from_s,
	                      .to_s = to_s,
	                      .row = row};
}

static void one_row_at_one_node_is_enough(void **state)
{
	(void)state;
	for (int row = 0; row < ROWS; row++)
		for (int k = 0; k < NODES; k++) {
			struct decay d = slow(row, node[k] * length_s * (1 - 1e-6),
			                      node[k] * length_s * (1 + 1e-6));
			struct rb_error err;
			double try_s = length_s;

			assert_ok(step(&d, (struct rb_gauss_problem){0}, &try_s, &err));
			assert_true(try_s <= 0.5 * length_s);
		}
}

/* Whichever call that is: also one whose result no later one begins from. */
static void one_row_of_one_call_is_enough(void **state)
{
	static double room[4096];

	(void)state;
	for (int stiff = 0; stiff < 2; stiff++)
		for (int row = 0; row < ROWS; row++)
			for (int call = 2, calls = call; call <= calls; call++) {
				struct decay d = slow(row, (double)INFINITY, 0);
				struct rb_gauss_problem problem = {0};
				uint64_t products = 0;
				struct rb_error err;
				double try_s = length_s;

				for (int i = 1; i < ROWS && stiff; i += 2)
					d.speed[i] = 1e3;
				if (stiff)
					problem.newton = room, problem.products = &products;
				d.call = call;
				assert_ok(step(&d, problem, &try_s, &err));
				calls = d.calls;
			}
}

static void one_row_at_the_beginning_is_refused(void **state)
{
	(void)state;
	for (int row = 0; row < ROWS; row++) {
		struct decay d = slow(row, 0, 0);
		struct rb_error err;
		double try_s = length_s;

		assert_int_equal(step(&d, (struct rb_gauss_problem){0}, &try_s, &err),
		                 RB_ERR_PHYSICS);
	}
}

/* The end is looked at where rates may jump. */
static void one_row_at_the_end_is_enough(void **state)
{
	(void)state;
	for (int row = 0; row < ROWS; row++) {
		struct decay d = slow(row, length_s, length_s);
		struct rb_error err;
		double try_s = length_s;

		assert_ok(step(&d, (struct rb_gauss_problem){.jumps = true}, &try_s, &err));
		assert_true(try_s <= 0.5 * length_s);
	}
}

/* Stiff rates: visits do not converge, and Newton's method meets what is not a number. */
static void one_row_of_stiff_rates_is_enough(void **state)
{
	(void)state;
	for (int row = 0; row < ROWS; row++)
		for (int k = 0; k < NODES; k++) {
			struct decay d = {.speed = {1, 1e3, 1, 1e3, 1, 1e3},
			                  .from_s = node[k] * 0x1p-7 * (1 - 1e-6),
			                  .to_s = node[k] * 0x1p-7 * (1 + 1e-6),
			                  .row = row};
			static double room[4096];
			uint64_t products = 0;
			struct rb_error err;
			double try_s = 0x1p-7;

			assert_true(rb_gauss_newton_size(ROWS) <= sizeof room / sizeof *room);
			assert_ok(step(
				&d,
				(struct rb_gauss_problem){.newton = room, .products = &products},
				&try_s, &err));
			assert_true(try_s <= 0x1p-8);
			assert_true(products > 0);
		}
}

static double noise(void *user, const double *coefficient)
{
	(void)coefficient;
	return ((const struct decay *)user)->to_s;
}

static void no_step_is_accepted_for_noise_without_bounds(void **state)
{
	static const double none[] = {(double)NAN, (double)INFINITY};

	(void)state;
	for (int k = 0; k < 2; k++) {
		struct decay d = slow(0, (double)INFINITY, none[k]);
		struct rb_error err;
		double try_s = length_s;

		assert_int_equal(step(&d, (struct rb_gauss_problem){.noise = noise}, &try_s, &err),
		                 RB_ERR_PHYSICS);
	}
}

/* Of polynomials of which one is not a number, too. */
static void the_tail_of_one_row_is_that_of_all(void **state)
{
	static const double scale[ROWS] = {1, 1, 1, 1, 1, 1};
	const struct rb_gauss_problem problem = {.n = ROWS, .scale = scale};

	(void)state;
	for (int row = 0; row < ROWS; row++)
		for (int k = 6; k < NODES; k++) {
			double coefficient[ROWS * NODES];

			for (int i = 0; i < ROWS * NODES; i++)
				coefficient[i] = 1;
			assert_true(isfinite(rb_gauss_tail(&problem, coefficient)));
			coefficient[k * ROWS + row] = (double)NAN;
			assert_true(isnan(rb_gauss_tail(&problem, coefficient)));
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_row_at_one_node_is_enough),
		cmocka_unit_test(one_row_of_one_call_is_enough),
		cmocka_unit_test(one_row_at_the_beginning_is_refused),
		cmocka_unit_test(one_row_at_the_end_is_enough),
		cmocka_unit_test(one_row_of_stiff_rates_is_enough),
		cmocka_unit_test(no_step_is_accepted_for_noise_without_bounds),
		cmocka_unit_test(the_tail_of_one_row_is_that_of_all)};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
