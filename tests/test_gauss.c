/* SPDX-License-Identifier: MIT */
/* math/gauss: closed forms, dense output, refusals, bits. */
#include "math/gauss.h"

#include "support.h"

enum { MOST = 8 };

static const double pi = 3.14159265358979323846;

struct course {
	struct rb_gauss_problem problem;
	double value[MOST], coefficient[RB_GAUSS_NODES * MOST], scratch[20 * MOST];
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
	assert_true(rb_gauss_room(n) <= sizeof c->scratch / sizeof *c->scratch);
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
	for (size_t i = rb_gauss_room(c->problem.n); i < sizeof c->scratch / sizeof *c->scratch;
	     i++)
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
		cmocka_unit_test(a_mirrored_problem_has_mirrored_bits),
		cmocka_unit_test(the_basis_is_that_of_legendre),
		cmocka_unit_test(nobody_is_asked_for_rates_at_infinity),
		cmocka_unit_test(what_cannot_be_integrated_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
