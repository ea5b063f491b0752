/* SPDX-License-Identifier: MIT */
/* math/turn: closed forms, and the integrator that knows nothing of q' being linear. */
#include "math/turn.h"

#include "support.h"

enum { N = 3 };

/* A piece on which the spin is that of `rates`, integrated. */
struct spun {
	double start[N], coefficient[RB_GAUSS_NODES * N];
	struct rb_gauss_piece piece;
};

static double off(rb_quat a, rb_quat b)
{
	return rb_quat_length((rb_quat){a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z});
}

static void spin(struct spun *s, double length, rb_vec3 start, rb_vec3 wave)
{
	double rate[RB_GAUSS_NODES * N];

	*s = (struct spun){.piece = {.n = N, .length_s = length}};
	s->piece.start = s->start;
	s->piece.coefficient = s->coefficient;
	for (int k = 0; k < RB_GAUSS_NODES; k++) {
		const double x = 0.4 * k;

		rate[k * N] = wave.x * cos(x);
		rate[k * N + 1] = wave.y * sin(2 * x);
		rate[k * N + 2] = wave.z * x;
	}
	rb_gauss_integrate(&s->piece, length, rate);
	rb_vec3_to(s->start, start);
}

static void an_even_spin_turns_about_its_axis(void **state)
{
	const rb_quat begin = rb_quat_unit((rb_quat){1, 2, -3, 4});
	const rb_vec3 w = {30, -40, 120};
	struct spun s;

	(void)state;
	spin(&s, 2, w, (rb_vec3){0, 0, 0});
	for (double t = 0; t <= 2; t += 0.25) {
		const rb_quat turn = rb_quat_from_turn(rb_vec3_scale(t, w));
		const rb_quat now = rb_turn_through(&s.piece, 0, begin, t);

		assert_near(off(now, rb_quat_multiply(turn, begin)), 0, 2e-13);
	}
}

/* About one axis it is the angle: followed radian by radian it would take hours. */
static void a_fast_spin_about_one_axis_is_an_angle(void **state)
{
	enum { PARTS = 2000 };
	const rb_quat begin = rb_quat_unit((rb_quat){1, 2, -3, 4});
	const rb_vec3 fast = {0, 0x1p30, 0}, axis = {0, 0, 1};
	double angle = 0, w[N];
	struct spun s;

	(void)state;
	spin(&s, 2, fast, (rb_vec3){0, 0, 0});
	assert_near(off(rb_turn_through(&s.piece, 0, begin, 2),
	                rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(2, fast)), begin)),
	            0, 1e-15);
	/* one that changes, by Simpson's rule */
	spin(&s, 2, (rb_vec3){0, 0, 30}, (rb_vec3){0, 0, 25});
	for (int k = 0; k <= 2 * PARTS; k++) {
		rb_gauss_values(&s.piece, 1.5 * k / (2 * PARTS), w);
		angle += w[2] * (k % (2 * PARTS) == 0 ? 1 : k % 2 ? 4 : 2) * 1.5 / (6 * PARTS);
	}
	assert_near(off(rb_turn_through(&s.piece, 0, begin, 1.5),
	                rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(angle, axis)), begin)),
	            0, 1e-12);
}

static enum rb_status turning(void *user, double t, const double *value, double *rate,
                              struct rb_error *err)
{
	const struct spun *s = user;
	const rb_quat q = rb_quat_from(value);
	double w[N];

	(void)err;
	rb_gauss_values(&s->piece, t, w);
	const rb_quat turned = rb_quat_multiply((rb_quat){0, w[0], w[1], w[2]}, q);
	rb_quat_to(rate, (rb_quat){0.5 * turned.w, 0.5 * turned.x, 0.5 * turned.y, 0.5 * turned.z});
	return RB_OK;
}

static void a_spin_that_wanders_is_followed(void **state)
{
	const double scale[4] = {1, 1, 1, 1};
	double value[4], coefficient[RB_GAUSS_NODES * 4], scratch[128], time_s = 0, try_s = 0.01;
	uint64_t calls = 0;
	struct spun s;
	struct rb_error err;

	(void)state;
	spin(&s, 1.5, (rb_vec3){3, -20, 7}, (rb_vec3){40, -30, 25});
	const struct rb_gauss_problem problem = {.n = 4,
	                                         .rates = turning,
	                                         .user = &s,
	                                         .scale = scale,
	                                         .tolerance = 1e-15,
	                                         .scratch = scratch,
	                                         .calls = &calls};
	struct rb_gauss_piece piece = {4, 0, value, coefficient, NULL};
	assert_true(rb_gauss_scratch_size(4) <= sizeof scratch / sizeof *scratch);
	rb_quat_to(value, rb_quat_identity);
	while (time_s < 1.5) {
		double end[4];

		try_s = fmin(try_s, 1.5 - time_s);
		assert_ok(rb_gauss_step(&problem, time_s, &try_s, 0, &piece, &err));
		rb_gauss_values(&piece, piece.length_s, end);
		memcpy(value, end, sizeof end);
		time_s += piece.length_s;
		const rb_quat now = rb_turn_through(&s.piece, 0, rb_quat_identity, time_s);
		assert_near(off(now, rb_quat_from(value)), 0, 2e-13);
	}
}

static void nothing_is_left_at_the_beginning(void **state)
{
	const rb_quat begin = rb_quat_unit((rb_quat){1, 2, -3, 4});
	struct spun s;

	(void)state;
	spin(&s, 1, (rb_vec3){1e3, 0, 0}, (rb_vec3){1, 1, 1});
	assert_near(off(rb_turn_through(&s.piece, 0, begin, 0), begin), 0, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_even_spin_turns_about_its_axis),
		cmocka_unit_test(a_fast_spin_about_one_axis_is_an_angle),
		cmocka_unit_test(a_spin_that_wanders_is_followed),
		cmocka_unit_test(nothing_is_left_at_the_beginning),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
