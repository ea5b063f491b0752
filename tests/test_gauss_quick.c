/* SPDX-License-Identifier: MIT */
/* math/gauss: rates that follow from values alone, beside those that cost something. */
#include "math/gauss.h"

#include "support.h"

enum { ROWS = 2 };

/* q' = w, w' = -q */
static enum rb_status oscillator(void *user, double t, const double *y, double *rate,
                                 struct rb_error *err)
{
	(void)user, (void)t, (void)err;
	rate[0] = y[1];
	rate[1] = -y[0];
	return RB_OK;
}

static void turn(void *user, const double *y, double *rate)
{
	(void)user;
	rate[0] = y[1];
}

/* Ten periods; returns the calls of the rates. */
static uint64_t go(const struct rb_gauss_problem *asked, double *value)
{
	const double end = 20 * 3.14159265358979323846;
	double scratch[20 * ROWS], coefficient[RB_GAUSS_NODES * ROWS], try_s = 1, t = 0;
	struct rb_gauss_piece piece = {.n = ROWS, .start = value, .coefficient = coefficient};
	struct rb_gauss_problem problem = *asked;
	uint64_t calls = 0;

	assert_true(rb_gauss_scratch_size(ROWS) <= sizeof scratch / sizeof *scratch);
	problem.scratch = scratch;
	problem.calls = &calls;
	while (t < end) {
		double next[ROWS];
		struct rb_error err;

		try_s = fmin(try_s, end - t);
		assert_ok(rb_gauss_step(&problem, t, &try_s, 0, &piece, &err));
		rb_gauss_values(&piece, piece.length_s, next);
		memcpy(value, next, sizeof next);
		t += piece.length_s;
	}
	return calls;
}

/* What the last visit has changed of the speed is in the place before the next one. */
static void a_chain_of_quick_rates_costs_fewer_visits(void **state)
{
	static const int quick[ROWS] = {RB_GAUSS_QUICK, -1};
	static const double scale[ROWS] = {1, 1};
	uint64_t calls[2];

	(void)state;
	for (int q = 0; q < 2; q++) {
		const struct rb_gauss_problem problem = {.n = ROWS,
		                                         .rates = oscillator,
		                                         .rate_row = q ? quick : NULL,
		                                         .quick_rates = q ? turn : NULL,
		                                         .scale = scale,
		                                         .tolerance = 1e-14};
		double value[ROWS] = {1, 0};

		calls[q] = go(&problem, value);
		assert_near(value[0], 1, 1e-12);
		assert_near(value[1], 0, 1e-12);
	}
	assert_true((double)calls[1] < 0.8 * (double)calls[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_chain_of_quick_rates_costs_fewer_visits)};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
