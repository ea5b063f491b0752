/* SPDX-License-Identifier: MIT */
/* math/gauss_newton: steps of stiff rates. */
#include "math/gauss_newton.h"

#include <float.h>

#include "math/gauss.h"
#include "support.h"

/* x'' = g - k x' - s x */
struct damper {
	double g, k, s;
};

static enum rb_status damped(void *user, double t, const double *y, double *rate,
                             struct rb_error *err)
{
	const struct damper *const d = user;

	(void)t, (void)err;
	rate[0] = y[1];
	rate[1] = d->g - d->k * y[1] - d->s * y[0];
	return RB_OK;
}

/*
 * x and v after a second; fails where that takes more than some tens of steps, or many calls in
 * them.
 */
static void damp(struct damper *d, double value[2])
{
	static double room[1024], scratch[64];
	const double scale[2] = {1, 1};
	const int rate_row[2] = {1, -1};
	double rest[2] = {0, 0}, coefficient[2 * RB_GAUSS_NODES], next[2];
	struct rb_gauss_piece piece = {
		.n = 2, .start = value, .coefficient = coefficient, .rest = rest};
	uint64_t products = 0, calls = 0;
	double time_s = 0, try_s = 0.25 / d->k;
	struct rb_error err;
	int steps = 0;

	assert_true(rb_gauss_newton_size(2) <= sizeof room / sizeof *room);
	assert_true(rb_gauss_scratch_size(2) <= sizeof scratch / sizeof *scratch);
	for (size_t i = 0; i < sizeof room / sizeof *room; i++)
		room[i] = (double)NAN; /* what is left in there must not matter */
	const struct rb_gauss_problem problem = {.n = 2,
	                                         .rates = damped,
	                                         .user = d,
	                                         .rate_row = rate_row,
	                                         .scale = scale,
	                                         .tolerance = 1e-14,
	                                         .scratch = scratch,
	                                         .newton = room,
	                                         .products = &products,
	                                         .calls = &calls};
	for (; time_s < 1 && steps < 150; steps++) {
		double more[2];

		try_s = fmin(try_s, 1 - time_s);
		assert_ok(rb_gauss_step(&problem, time_s, &try_s, 0, &piece, &err));
		rb_gauss_values(&piece, piece.length_s, next);
		for (int i = 0; i < 2; i++)
			rb_gauss_rests(&piece, i, 1, &rate_row[i], piece.length_s, &more[i]);
		memcpy(value, next, sizeof next);
		memcpy(rest, more, sizeof more);
		time_s += piece.length_s;
	}
	assert_near(time_s, 1, 0);
	assert_true(calls < 256 * (uint64_t)steps);
	assert_true(products > 0);
}

/* A transient of 1e-9 s, and then what is smooth. */
static void stiff_drag_is_followed_by_its_motion(void **state)
{
	struct damper d = {9.81, 1e9, 0};
	double value[2] = {0, 1};

	(void)state;
	damp(&d, value);
	assert_near(value[1], d.g / d.k, DBL_EPSILON);
	assert_near(value[0], (1 + d.g) / d.k, 1e-14);
}

/* Of r^2 + k r + s = 0 the slow root is left: x falls by it alone. */
static void an_overdamped_spring_is_followed_by_its_motion(void **state)
{
	struct damper d = {0, 1e8, 2e8};
	const double slow = -2 * d.s / (d.k + sqrt(d.k * d.k - 4 * d.s));
	const double fast = -0.5 * (d.k + sqrt(d.k * d.k - 4 * d.s));
	double value[2] = {1, 0}, mirrored[2] = {-1, 0};

	(void)state;
	damp(&d, value);
	/* x = (fast e^(slow t) - slow e^(fast t)) / (fast - slow), whose second part is gone */
	const double x = fast / (fast - slow) * exp(slow);
	assert_near(value[0], x, 1e-12);
	assert_near(value[1], slow * x, 1e-12);
	damp(&d, mirrored);
	assert_near(mirrored[0], -value[0], 0);
	assert_near(mirrored[1], -value[1], 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stiff_drag_is_followed_by_its_motion),
		cmocka_unit_test(an_overdamped_spring_is_followed_by_its_motion),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
