/* SPDX-License-Identifier: MIT */
/* math/gauss: closed forms, dense output, refusals, bits. */
#include "math/gauss.h"

#include <float.h>

#include "support.h"

enum { MOST = 8 };

static const double pi = 3.14159265358979323846;

struct course {
	struct rb_gauss_problem problem;
	double value[MOST], rest[MOST], coefficient[RB_GAUSS_NODES * MOST], scratch[20 * MOST];
	double time_s, try_s, least_s;
	struct rb_gauss_piece piece;
	int steps;
	uint64_t calls;
};

static void begin(struct course *c, int n, rb_gauss_rates *rates, void *user, const double *scale)
{
	memset(c, 0, sizeof *c);
	c->problem = (struct rb_gauss_problem){.n = n,
	                                       .rates = rates,
	                                       .user = user,
	                                       .scale = scale,
	                                       .tolerance = 1e-14,
	                                       .scratch = c->scratch,
	                                       .calls = &c->calls};
	c->try_s = 1;
	c->piece.n = n;
	c->piece.start = c->value;
	c->piece.coefficient = c->coefficient;
	assert_true(rb_gauss_scratch_size(n) <= sizeof c->scratch / sizeof *c->scratch);
	for (size_t i = 0; i < sizeof c->scratch / sizeof *c->scratch; i++)
		c->scratch[i] = (double)NAN; /* what is left in there must not matter */
}

/* One step, no further than `end`; its piece can be looked at until `next`. */
static enum rb_status step(struct course *c, double end, struct rb_error *err)
{
	c->try_s = fmin(c->try_s, end - c->time_s);
	c->steps++;
	const enum rb_status status = rb_gauss_step(&c->problem, c->time_s, &c->try_s, c->least_s,
	                                            &c->piece, err);
	for (size_t i = rb_gauss_scratch_size(c->problem.n);
	     i < sizeof c->scratch / sizeof *c->scratch; i++)
		assert_true(isnan(c->scratch[i])); /* that room is nobody's */
	return status;
}

static void next(struct course *c)
{
	double value[MOST];

	rb_gauss_values(&c->piece, c->piece.length_s, value);
	for (int i = 0; i < c->problem.n; i++)
		c->value[i] = value[i];
	c->time_s += c->piece.length_s;
}

static void go(struct course *c, double end)
{
	struct rb_error err;

	while (c->time_s < end) {
		assert_ok(step(c, end, &err));
		next(c);
	}
}

/* ---- x' = v, v' = f: the second half of the rows are the rates of the first ---- */

static const int halves[2][MOST] = {{1, -1}, {2, 3, -1, -1}};

static void begin_second(struct course *c, int n, rb_gauss_rates *rates, void *user,
                         const double *scale)
{
	begin(c, n, rates, user, scale);
	c->problem.rate_row = halves[n / 4];
	c->piece.rest = c->rest;
}

/* From a moment of the piece on: what rounding leaves goes on too, and the piece is the guess. */
static void next_from(struct course *c, double t)
{
	double value[MOST], rest[MOST];

	rb_gauss_values(&c->piece, t, value);
	for (int i = 0; i < c->problem.n; i++)
		rb_gauss_rests(&c->piece, i, 1, &c->problem.rate_row[i], t, &rest[i]);
	memcpy(c->value, value, sizeof value);
	memcpy(c->rest, rest, sizeof rest);
	c->problem.guess = (struct rb_gauss_guess){c->coefficient, c->piece.length_s, t};
	c->time_s += t;
}

static void go_on(struct course *c, double end)
{
	struct rb_error err;

	while (c->time_s < end) {
		assert_ok(step(c, end, &err));
		next_from(c, c->piece.length_s);
	}
}

static enum rb_status oscillator(void *user, double t, const double *y, double *rate,
                                 struct rb_error *err)
{
	const double omega = *(double *)user;

	(void)t, (void)err;
	rate[0] = y[1];
	rate[1] = -omega * omega * y[0];
	return RB_OK;
}

static void an_oscillator_keeps_its_phase_for_a_thousand_periods(void **state)
{
	const double scale[2] = {1, 1}, end = 2000 * pi;
	double omega = 1;
	struct course c;

	(void)state;
	begin(&c, 2, oscillator, &omega, scale);
	c.value[0] = 1;
	go(&c, end);
	assert_near(hypot(c.value[0], c.value[1]), 1, 1e-13);
	assert_near(atan2(-c.value[1], c.value[0]), remainder(end, 2 * pi), 2e-12);
	assert_true(c.calls < 2000u * 1000);
}

static void a_stiff_spring_keeps_its_phase_for_a_second(void **state)
{
	double omega = 31622.7766;
	const double scale[2] = {1e-3, 1e-3 * omega};
	struct course c;

	(void)state;
	begin(&c, 2, oscillator, &omega, scale);
	c.value[0] = 1e-3;
	go(&c, 1);
	assert_near(hypot(c.value[0], c.value[1] / omega), 1e-3, 1e-15);
	assert_near(remainder(atan2(-c.value[1] / omega, c.value[0]) - omega, 2 * pi), 0, 1e-11);
}

/* sin and cos in the piece, not only at its end, and for tolerances that matter. */
static void the_polynomial_is_right_within_a_step(void **state)
{
	const double scale[2] = {1, 1}, tolerances[3] = {1e-8, 1e-11, 1e-14};
	double omega = 1, worst[3] = {0, 0, 0};

	(void)state;
	for (int k = 0; k < 3; k++) {
		struct course c;
		struct rb_error err;

		begin(&c, 2, oscillator, &omega, scale);
		c.problem.tolerance = tolerances[k];
		c.value[0] = 1;
		while (c.time_s < 10) {
			double both[2];

			assert_ok(step(&c, 10, &err));
			for (int j = 0; j <= 50; j++) {
				const double t = c.piece.length_s * j / 50, at = c.time_s + t;
				const double x = rb_gauss_value(&c.piece, 0, t);

				worst[k] = fmax(worst[k], fabs(x - cos(at)));
				rb_gauss_values(&c.piece, t, both);
				assert_true(both[0] == x);
				assert_true(both[1] == rb_gauss_value(&c.piece, 1, t));
				/* rates lose an order */
				const double rate = rb_gauss_rate(&c.piece, 0, t);
				assert_near(rate, -sin(at), 400 * tolerances[k]);
				assert_true(fabs(rate) <= rb_gauss_rate_bound(&c.piece, 0));
			}
			assert_true(rb_gauss_rate_bound(&c.piece, 0) < 2);
			assert_true(rb_gauss_value(&c.piece, 0, 0) == c.value[0]);
			next(&c);
		}
		assert_true(worst[k] <= tolerances[k] + 3e-15);
	}
	assert_true(worst[0] > 10 * worst[2]); /* the tolerance is what decides */
}

static enum rb_status kepler(void *user, double t, const double *y, double *rate,
                             struct rb_error *err)
{
	const double square = y[0] * y[0] + y[1] * y[1], cube = square * sqrt(square);

	(void)user, (void)t, (void)err;
	rate[0] = y[2];
	rate[1] = y[3];
	rate[2] = -y[0] / cube;
	rate[3] = -y[1] / cube;
	return RB_OK;
}

static void an_orbit_comes_back(void **state)
{
	const double scale[4] = {1, 1, 1, 1};
	struct course c;

	(void)state;
	begin(&c, 4, kepler, NULL, scale);
	c.value[0] = 0.5;
	c.value[3] = sqrt(3);
	go(&c, 2 * pi);
	assert_near(c.value[0], 0.5, 1e-13);
	assert_near(c.value[1], 0, 1e-13);
	assert_near(c.value[2], 0, 4e-13); /* 4/sqrt(3) of the angle's error each */
	assert_near(c.value[3], sqrt(3), 1e-13);
}

static enum rb_status drag(void *user, double t, const double *y, double *rate,
                           struct rb_error *err)
{
	(void)t, (void)err;
	rate[0] = -*(double *)user * fabs(y[0]) * y[0];
	return RB_OK;
}

static void drag_follows_its_closed_form(void **state)
{
	const double scale[1] = {10};
	double c0 = 0.7;
	struct course c;

	(void)state;
	begin(&c, 1, drag, &c0, scale);
	c.value[0] = 10;
	go(&c, 100);
	assert_near(c.value[0] * (1 + c0 * 10 * 100) / 10, 1, 1e-12);
}

/* A body that turns about its own x axis while this is carried about z: the spin in world axes turns with time. */
static enum rb_status coning(void *user, double t, const double *y, double *rate,
                             struct rb_error *err)
{
	const double x = 3 * cos(2 * t), v = 3 * sin(2 * t), z = 2;

	(void)user, (void)err;
	rate[0] = 0.5 * (-x * y[1] - v * y[2] - z * y[3]);
	rate[1] = 0.5 * (x * y[0] + v * y[3] - z * y[2]);
	rate[2] = 0.5 * (v * y[0] + z * y[1] - x * y[3]);
	rate[3] = 0.5 * (z * y[0] + x * y[2] - v * y[1]);
	return RB_OK;
}

static void a_quaternion_follows_a_given_turn(void **state)
{
	const double scale[4] = {1, 1, 1, 1}, end = 100;
	struct course c;

	(void)state;
	begin(&c, 4, coning, NULL, scale);
	c.value[0] = 1;
	go(&c, end);
	/* exp(z 2t/2) exp(x 3t/2) */
	assert_near(c.value[0], cos(end) * cos(1.5 * end), 2e-13);
	assert_near(c.value[1], cos(end) * sin(1.5 * end), 2e-13);
	assert_near(c.value[2], sin(end) * sin(1.5 * end), 2e-13);
	assert_near(c.value[3], sin(end) * cos(1.5 * end), 2e-13);
}

static enum rb_status kink(void *user, double t, const double *y, double *rate,
                           struct rb_error *err)
{
	(void)user, (void)y, (void)err;
	rate[0] = fabs(t - 0.3);
	return RB_OK;
}

static void a_kink_is_closed_in_on(void **state)
{
	const double scale[1] = {1};
	struct course c;

	(void)state;
	begin(&c, 1, kink, NULL, scale);
	c.problem.tolerance = 1e-13;
	go(&c, 1);
	assert_near(c.value[0], 0.5 * (0.09 + 0.49), 2e-12);
	assert_true(c.steps < 200);
}

static enum rb_status jump(void *user, double t, const double *y, double *rate,
                           struct rb_error *err)
{
	const double *const at = user;

	(void)y;
	(void)err;
	rate[0] = t < *at ? 1 : -1;
	return RB_OK;
}

/* Also where no node sees it: between an end of a step and the node next to it. */
static void a_jump_near_the_end_of_a_step_is_seen(void **state)
{
	const double scale[1] = {1};

	(void)state;
	for (int k = 0; k < 8; k++) {
		double at = k < 4 ? 1 - 0.004 * (k + 1) : 0.004 * (k - 3);
		struct course c;

		begin(&c, 1, jump, &at, scale);
		c.problem.jumps = true;
		go(&c, 2);
		assert_true(fabs(c.value[0] - (2 * at - 2)) < 1e-11);
	}
}

static void a_first_step_that_is_too_long_is_halved(void **state)
{
	const double scale[2] = {1, 1};
	double omega = 1;
	struct rb_error err;
	struct course c;

	(void)state;
	begin(&c, 2, oscillator, &omega, scale);
	c.try_s = 0x1p40;
	c.value[0] = 1;
	assert_ok(step(&c, (double)INFINITY, &err));
	assert_true(c.piece.length_s < 1 && c.piece.length_s > 0.05);
	assert_near(rb_gauss_value(&c.piece, 0, c.piece.length_s), cos(c.piece.length_s), 1e-14);
	int exponent;
	const double digits = 0x1p8 * frexp(c.try_s, &exponent);
	assert_true(digits == floor(digits)); /* so that times add up exactly */
	assert_true(c.try_s <= 4 * c.piece.length_s);
}

/* Where nothing changes nothing limits a step but this. */
static void steps_grow_to_four_times_the_last_one_at_most(void **state)
{
	static const double scale[2] = {1, 1};
	struct rb_error err;
	struct course c;
	double omega = 0; /* nothing moves */

	(void)state;
	begin(&c, 2, oscillator, &omega, scale);
	for (double tried = c.try_s = 0x1p-20; tried < 0x1p60; tried *= 4) {
		assert_ok(step(&c, (double)INFINITY, &err));
		assert_true(c.piece.length_s == tried && c.try_s == 4 * tried);
	}
}

static void a_mirrored_problem_has_mirrored_bits(void **state)
{
	const double scale[4] = {1, 1, 1, 1};

	(void)state;
	for (int signs = 1; signs < 4; signs++) {
		const double x = signs & 1 ? -1 : 1, y = signs & 2 ? -1 : 1;
		const double sign[4] = {x, y, x, y};
		struct course a, b;

		begin(&a, 4, kepler, NULL, scale);
		begin(&b, 4, kepler, NULL, scale);
		for (int i = 0; i < 4; i++) {
			a.value[i] = 0.4 + 0.1 * i;
			b.value[i] = sign[i] * a.value[i];
		}
		go(&a, 2);
		go(&b, 2);
		assert_true(a.steps > 3 && a.steps == b.steps && a.calls == b.calls);
		for (int i = 0; i < 4; i++)
			assert_true(a.value[i] == sign[i] * b.value[i]);
	}
}

static enum rb_status blow_up(void *user, double t, const double *y, double *rate,
                              struct rb_error *err)
{
	(void)user, (void)t, (void)err;
	rate[0] = y[0] * y[0];
	return RB_OK;
}

static enum rb_status no_number(void *user, double t, const double *y, double *rate,
                                struct rb_error *err)
{
	(void)user, (void)y, (void)err;
	rate[0] = 0;
	rate[1] = t < 0.3 ? 1 : (double)NAN;
	return RB_OK;
}

static enum rb_status refusal(void *user, double t, const double *y, double *rate,
                              struct rb_error *err)
{
	(void)user, (void)y;
	rate[0] = 1;
	return t > 0.5 ? RB_FAIL(err, RB_ERR_SCENE, "'field' says no") : RB_OK;
}

/* Beyond what numbers hold as soon as it is extrapolated: nobody is asked there. */
static enum rb_status steep(void *user, double t, const double *y, double *rate,
                            struct rb_error *err)
{
	(void)user, (void)t, (void)err;
	assert_true(isfinite(y[0]));
	rate[0] = 1.5e308 * (y[0] > 0 ? -1 : 1);
	return RB_OK;
}

static void nobody_is_asked_for_rates_at_infinity(void **state)
{
	const double scale = 1;
	struct rb_error err = {0};
	struct course c;

	(void)state;
	begin(&c, 1, steep, NULL, &scale);
	c.least_s = 1e-9;
	c.value[0] = 1;
	assert_int_equal(step(&c, 2, &err), RB_ERR_PHYSICS);
}

static void what_cannot_be_integrated_is_refused(void **state)
{
	const double scale[2] = {1, 1};
	struct rb_error err = {0};
	enum rb_status status;
	struct course c;

	(void)state;
	begin(&c, 1, blow_up, NULL, scale); /* 1 / (1 - t) */
	c.value[0] = 1;
	c.least_s = 1e-9;
	while ((status = step(&c, 2, &err)) == RB_OK)
		next(&c);
	assert_int_equal(status, RB_ERR_PHYSICS);
	assert_near(c.time_s, 1, 1e-6);

	begin(&c, 2, no_number, NULL, scale);
	c.least_s = 1e-9;
	while ((status = step(&c, 2, &err)) == RB_OK)
		next(&c);
	assert_int_equal(status, RB_ERR_PHYSICS);
	assert_near(c.time_s, 0.3, 1e-8);
	c.time_s = 0.4;
	assert_int_equal(step(&c, 2, &err), RB_ERR_PHYSICS);
	c.try_s = (double)NAN;
	assert_int_equal(step(&c, 2, &err), RB_ERR_PHYSICS);

	begin(&c, 1, refusal, NULL, scale);
	assert_int_equal(step(&c, 2, &err), RB_ERR_SCENE);
	assert_string_equal(err.text, "'field' says no");
}

/* What a coefficient adds: P_k for rates, its integral for values. */
static void the_basis_is_that_of_legendre(void **slot)
{
	double value[RB_GAUSS_NODES], rate[RB_GAUSS_NODES];
	double coefficient[RB_GAUSS_NODES] = {0}, start = 0;
	const struct rb_gauss_piece piece = {
		.n = 1, .length_s = 2, .start = &start, .coefficient = coefficient};

	(void)slot;
	for (int k = 0; k < RB_GAUSS_NODES; k++) {
		coefficient[k] = 1;
		for (double x = 0; x <= 1; x += 0.125) {
			rb_gauss_basis(x, value, rate);
			assert_near(value[k], rb_gauss_value(&piece, 0, 2 * x), 1e-15);
			assert_near(rate[k], 2 * rb_gauss_rate(&piece, 0, 2 * x), 1e-15);
		}
		assert_near(rate[k], 1, 1e-15);
		assert_near(value[k], k == 0, 1e-15);
		coefficient[k] = 0;
	}
}

/* x'' = (k + 1)(k + 2) t^k */
static enum rb_status power(void *user, double t, const double *y, double *rate,
                            struct rb_error *err)
{
	const int k = *(const int *)user;

	(void)y, (void)err;
	rate[0] = (double)NAN; /* it is a row */
	rate[1] = (k + 1) * (k + 2) * pow(t, k);
	return RB_OK;
}

/*
 * Quadrature with 8 nodes: v to degree 15 of f, x = integral of (h - t) f to 14; within the step v to
 * degree 7, and x, whose rate is of degree 7, to 6.
 */
static void polynomials_are_exact_up_to_the_order(void **state)
{
	const double scale[2] = {1, 1}, length = 1.5;

	(void)state;
	for (int k = 0; k <= 18; k++) {
		struct rb_error err;
		struct course c;

		begin_second(&c, 2, power, &k, scale);
		c.problem.tolerance = 1e9; /* one step */
		c.try_s = length;
		assert_ok(step(&c, length, &err));
		assert_true(c.piece.length_s == length && c.calls <= 25);
		const double x = pow(length, k + 2), v = (k + 2) * pow(length, k + 1);
		const double off[2] = {fabs(rb_gauss_value(&c.piece, 0, length) / x - 1),
		                       fabs(rb_gauss_value(&c.piece, 1, length) / v - 1)};
		assert_true((off[0] < 4e-15) == (k <= 14));
		assert_true((off[1] < 4e-15) == (k <= 15));
		/* at the first node and the last */
		for (double t = 0.0198550717512318842 * length; t < length; t = length - t) {
			assert_near(rb_gauss_rate(&c.piece, 0, t), rb_gauss_value(&c.piece, 1, t),
			            4e-15 * v);
			if (t > 0.5 * length)
				break;
		}
		for (double t = 0.1; t < length; t += 0.2) {
			if (k <= 6)
				assert_near(rb_gauss_value(&c.piece, 0, t), pow(t, k + 2),
				            4e-15 * x);
			if (k <= 7)
				assert_near(rb_gauss_value(&c.piece, 1, t), (k + 2) * pow(t, k + 1),
				            4e-15 * v);
		}
	}
}

static double phase_error(int steps)
{
	const double scale[2] = {1, 1}, end = 18;
	double omega = 1;
	struct course c;

	begin_second(&c, 2, oscillator, &omega, scale);
	c.problem.tolerance = 1e3;
	c.value[0] = 1;
	for (int k = 0; k < steps; k++) {
		struct rb_error err;

		c.try_s = end / steps;
		assert_ok(step(&c, end, &err));
		next_from(&c, c.piece.length_s);
	}
	assert_true(c.time_s == end);
	return fabs(remainder(atan2(-c.value[1], c.value[0]) - end, 2 * pi));
}

static void the_order_is_sixteen(void **state)
{
	const double order = log(phase_error(3) / phase_error(4)) / log(4.0 / 3);

	(void)state;
	assert_true(order > 15 && order < 17);
}

/* Also beside what a step misses, which the tolerance bounds, within and at the end. */
static void the_polynomial_of_the_second_order_is_right_within_a_step(void **state)
{
	const double scale[2] = {1, 1}, tolerances[3] = {1e-8, 1e-11, 1e-14};
	double omega = 1, worst[3] = {0, 0, 0};

	(void)state;
	for (int k = 0; k < 3; k++) {
		struct course c;
		struct rb_error err;

		begin_second(&c, 2, oscillator, &omega, scale);
		c.problem.tolerance = tolerances[k];
		c.value[0] = 1;
		while (c.time_s < 10) {
			assert_ok(step(&c, 10, &err));
			for (int j = 0; j <= 50; j++) {
				const double t = c.piece.length_s * j / 50, at = c.time_s + t;
				const double off[2] = {
					fabs(rb_gauss_value(&c.piece, 0, t) - cos(at)),
					fabs(rb_gauss_value(&c.piece, 1, t) + sin(at))};

				worst[k] = fmax(worst[k], fmax(off[0], off[1]));
				assert_near(rb_gauss_rate(&c.piece, 0, t), -sin(at),
				            400 * tolerances[k]);
			}
			next_from(&c, c.piece.length_s);
		}
		assert_true(worst[k] <= tolerances[k] + 3e-15);
	}
	assert_true(worst[0] > 10 * worst[2]);
}

/* A random walk of at most a quarter of an ulp a step. */
static double walk(uint64_t pieces)
{
	return 0.25 * DBL_EPSILON * sqrt((double)pieces);
}

static long double energy_of(const struct course *c, bool springs)
{
	const long double x = (long double)c->value[0] + c->rest[0];
	const long double y = (long double)c->value[1] + c->rest[1];
	const long double u = (long double)c->value[2] + c->rest[2];
	const long double v = (long double)c->value[3] + c->rest[3];

	return 0.5L * (u * u + v * v) +
	       (springs ? 0.5L * (x * x + y * y) : -1 / sqrtl(x * x + y * y));
}

static enum rb_status round_a_spring(void *user, double t, const double *y, double *rate,
                                     struct rb_error *err)
{
	(void)user, (void)t, (void)err;
	rate[2] = -y[0];
	rate[3] = -y[1];
	return RB_OK;
}

/*
 * Brouwer's law: the energy's error is that of a random walk. Without what rounding leaves of
 * velocities it is more; with coefficients that are one double each it grows with the steps.
 */
static void energy_errs_as_a_random_walk(void **state)
{
	const double scale[4] = {1, 1, 1, 1};

	(void)state;
	for (int k = 0; k < 6; k++) {
		const bool springs = k >= 3;
		struct course c;

		begin_second(&c, 4, springs ? round_a_spring : kepler, NULL, scale);
		c.problem.tolerance = 3e-15;
		c.try_s = 0.125;
		c.value[0] = 1.5 + 0.01 * (k % 3);
		c.value[3] = springs ? 0.7 : sqrt(1.0 / 3);
		const long double before = energy_of(&c, springs);
		go_on(&c, (springs ? 3000 : 600) * 2 * pi);
		assert_true(c.steps > 30000);
		const double off = (double)fabsl(energy_of(&c, springs) / before - 1);
		assert_true(off <= walk((uint64_t)c.steps));
	}
}

/* The phase of a thousand periods: a hundred times nearer than the bound of the first order's. */
static void an_oscillator_of_the_second_order_keeps_its_phase(void **state)
{
	const double scale[2] = {1, 1}, end = 2000 * pi;
	double omega = 1;
	struct course c;

	(void)state;
	begin_second(&c, 2, oscillator, &omega, scale);
	c.value[0] = 1;
	go_on(&c, end);
	assert_near(hypot(c.value[0], c.value[1]), 1, 1e-14);
	/* 2 pi has more digits than a double's */
	const long double phase = remainderl(end, 6.28318530717958647692528676656L);
	assert_near(atan2(-c.value[1], c.value[0]), (double)phase, 2e-14);
}

static void an_orbit_of_the_second_order_comes_back(void **state)
{
	const double scale[4] = {1, 1, 1, 1};
	struct course c;

	(void)state;
	begin_second(&c, 4, kepler, NULL, scale);
	c.problem.tolerance = 3e-15;
	c.value[0] = 1.5;
	c.value[3] = sqrt(1.0 / 3);
	go_on(&c, 200 * pi);
	/* the time is off by a rounding of 200 pi, 1e-13/2, the period by 3/2 of the energy */
	assert_near(c.value[0], 1.5, 1e-12);
	assert_near(c.value[1], 0, 1e-12);
	assert_true((double)c.calls / c.steps < 20); /* two visits, and the beginning */
}

/* From where the one before is cut, with it as the guess; the guess does not enter the result. */
static void a_step_begins_anew_in_the_middle_of_a_piece(void **state)
{
	const double scale[2] = {1, 1};
	double omega = 1;
	struct rb_error err;

	(void)state;
	for (int k = 1; k < 16; k++) {
		struct course c, d;
		double ends[2];

		begin_second(&c, 2, oscillator, &omega, scale);
		c.value[0] = 1;
		assert_ok(step(&c, 10, &err));
		c.try_s = c.piece.length_s;
		next_from(&c, c.piece.length_s * k / 16);
		assert_near(c.value[0], cos(c.time_s), 1e-14);
		d = c;
		d.piece.start = d.value;
		d.piece.rest = d.rest;
		d.piece.coefficient = d.coefficient;
		d.problem.scratch = d.scratch;
		d.problem.calls = &d.calls;
		d.problem.guess.coefficient = NULL;
		assert_ok(step(&c, 10, &err));
		assert_ok(step(&d, 10, &err));
		assert_true(c.piece.length_s == d.piece.length_s);
		assert_true(c.calls + 16 <= d.calls);
		rb_gauss_values(&c.piece, c.piece.length_s, ends);
		assert_near(ends[0], cos(c.time_s + c.piece.length_s), 2e-14);
		assert_near(ends[0], rb_gauss_value(&d.piece, 0, d.piece.length_s), DBL_EPSILON);
		assert_near(ends[1], rb_gauss_value(&d.piece, 1, d.piece.length_s), DBL_EPSILON);
	}
}

/* Another force than before joins in; or nothing is as it was. */
static void a_guess_that_is_wrong_costs_visits_only(void **state)
{
	const double scale[2] = {1, 1};
	double omega = 1;
	struct rb_error err;

	(void)state;
	for (int k = 0; k < 4; k++) {
		struct course c;

		begin_second(&c, 2, oscillator, &omega, scale);
		c.value[0] = 1;
		assert_ok(step(&c, 10, &err));
		next_from(&c, c.piece.length_s);
		for (int i = 0; i < RB_GAUSS_NODES; i++)
			c.coefficient[2 * i + 1] += k == 0 ? (i == 0) * 1e-5
			                                   : (k == 3 ? HUGE_VAL
			                                             : pow(10, -8 + 4 * k));
		assert_ok(step(&c, 10, &err));
		assert_near(rb_gauss_value(&c.piece, 0, c.piece.length_s),
		            cos(c.time_s + c.piece.length_s), 2e-14);
	}
}

/* Value and rest together are what the polynomial says, to a twentieth of an ulp of 1. */
static void what_rounding_leaves_is_kept(void **state)
{
	const double scale[2] = {1, 1};
	double omega = 1;
	struct rb_error err;
	struct course c;

	(void)state;
	begin_second(&c, 2, oscillator, &omega, scale);
	c.value[0] = 1;
	for (int k = 0; k < 50; k++) {
		assert_ok(step(&c, HUGE_VAL, &err));
		const double h = c.piece.length_s;
		const double *const d = c.coefficient + 1;
		const long double v = (long double)c.value[1] + (c.rest[1] + (long double)d[0]);
		const long double x = (long double)c.value[0] + c.rest[0] +
		                      (long double)h * c.value[1] +
		                      (long double)h * (c.rest[1] + (0.5L * d[0] - d[2] / 6.0L));

		next_from(&c, h);
		assert_near((double)((long double)c.value[0] - x + c.rest[0]), 0, 1e-17);
		assert_near((double)((long double)c.value[1] - v + c.rest[1]), 0, 1e-17);
		assert_true(fabs(c.rest[0]) <= DBL_EPSILON && fabs(c.rest[1]) <= DBL_EPSILON);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_oscillator_keeps_its_phase_for_a_thousand_periods),
		cmocka_unit_test(a_stiff_spring_keeps_its_phase_for_a_second),
		cmocka_unit_test(the_polynomial_is_right_within_a_step),
		cmocka_unit_test(an_orbit_comes_back),
		cmocka_unit_test(drag_follows_its_closed_form),
		cmocka_unit_test(a_quaternion_follows_a_given_turn),
		cmocka_unit_test(a_kink_is_closed_in_on),
		cmocka_unit_test(a_jump_near_the_end_of_a_step_is_seen),
		cmocka_unit_test(a_first_step_that_is_too_long_is_halved),
		cmocka_unit_test(steps_grow_to_four_times_the_last_one_at_most),
		cmocka_unit_test(a_mirrored_problem_has_mirrored_bits),
		cmocka_unit_test(the_basis_is_that_of_legendre),
		cmocka_unit_test(nobody_is_asked_for_rates_at_infinity),
		cmocka_unit_test(what_cannot_be_integrated_is_refused),
		cmocka_unit_test(polynomials_are_exact_up_to_the_order),
		cmocka_unit_test(the_order_is_sixteen),
		cmocka_unit_test(the_polynomial_of_the_second_order_is_right_within_a_step),
		cmocka_unit_test(energy_errs_as_a_random_walk),
		cmocka_unit_test(an_oscillator_of_the_second_order_keeps_its_phase),
		cmocka_unit_test(an_orbit_of_the_second_order_comes_back),
		cmocka_unit_test(a_step_begins_anew_in_the_middle_of_a_piece),
		cmocka_unit_test(a_guess_that_is_wrong_costs_visits_only),
		cmocka_unit_test(what_rounding_leaves_is_kept),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
