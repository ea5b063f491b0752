/* SPDX-License-Identifier: MIT */
/* math/top: principal axes, closed forms, elliptic functions, an independent integration, order of queries, mirrors. */
#include "math/top.h"

#include <float.h>

#include "math/gauss.h"
#include "sanitized.h"

static const double pi = 3.14159265358979323846;
static const rb_vec3 none = {0, 0, 0};

static rb_quat some_orientation(void)
{
	return rb_quat_unit((rb_quat){0.6, -0.3, 0.5, 0.2});
}

/* R diag(moments) R^T */
static rb_mat3 turned_tensor(rb_quat q, double x, double y, double z)
{
	const rb_mat3 r = rb_quat_to_mat3(q), back = rb_mat3_transposed(&r);
	const rb_mat3 d = rb_mat3_diagonal(x, y, z), part = rb_mat3_multiply(&r, &d);
	rb_mat3 a = rb_mat3_multiply(&part, &back);

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < i; j++)
			a.m[i][j] = a.m[j][i];
	return a;
}

static double angle_between(rb_quat a, rb_quat b)
{
	const rb_quat d = rb_quat_multiply((rb_quat){a.w, -a.x, -a.y, -a.z}, b);

	return 2 * asin(fmin(1, sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
}

static bool same_quat(rb_quat a, rb_quat b)
{
	return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_vec(rb_vec3 a, rb_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* ---- principal axes ---- */

static void a_diagonal_tensor_keeps_its_axes(void **state)
{
	(void)state;
	rb_mat3 a = rb_mat3_diagonal(3, 1, 2);
	struct rb_top_body body = rb_top_body_of(&a);
	assert_int_equal(body.kind, RB_TOP_FREE);
	assert_true(same_quat(body.principal, rb_quat_identity));
	assert_true(same_vec(body.moments, (rb_vec3){3, 1, 2}));

	a = rb_mat3_diagonal(0.7, 0.7 * (1 + 2 * DBL_EPSILON), 0.7);
	assert_int_equal(rb_top_body_of(&a).kind, RB_TOP_CONSTANT);

	for (int k = 0; k < 3; k++) {
		const double e[3] = {k == 0, k == 1, k == 2};

		a = rb_mat3_diagonal(1 + e[0], 1 + e[1], 1 + e[2]);
		body = rb_top_body_of(&a);
		assert_int_equal(body.kind, RB_TOP_SYMMETRIC);
		assert_true(same_vec(body.moments, (rb_vec3){1, 1, 2}));
		const rb_vec3 axis = rb_quat_rotate(body.principal, (rb_vec3){0, 0, 1});
		assert_true(same_vec(axis, rb_vec3_from(e)));
	}
	a = rb_mat3_diagonal(1, 1, 1 + 1e-12); /* small, but not rounding */
	assert_int_equal(rb_top_body_of(&a).kind, RB_TOP_SYMMETRIC);
}

static void a_turned_tensor_gives_its_moments_and_axes(void **state)
{
	static const double moments[4][3] = {
		{2.5, 5, 6.5}, {1, 1, 2}, {3, 2, 2}, {4e-40, 4e-40, 4e-40}};
	static const enum rb_top_kind kinds[4] = {RB_TOP_FREE, RB_TOP_SYMMETRIC, RB_TOP_SYMMETRIC,
	                                          RB_TOP_CONSTANT};

	(void)state;
	for (int k = 0; k < 4; k++) {
		const double *m = moments[k];
		const rb_mat3 a = turned_tensor(some_orientation(), m[0], m[1], m[2]);
		const struct rb_top_body body = rb_top_body_of(&a);

		assert_int_equal(body.kind, kinds[k]);
		const rb_mat3 b = turned_tensor(body.principal, body.moments.x, body.moments.y,
		                                body.moments.z);
		for (int i = 0; i < 9; i++)
			assert_near(b.m[i / 3][i % 3], a.m[i / 3][i % 3], 2e-15 * (m[0] + m[1]));
	}
}

/* ---- closed forms ---- */

/* sqrt(3) rad/s for 2^20 s: an angle of 1.8e6, whose rounding alone would be worth 2e-10. */
static void a_constant_spin_keeps_its_angle(void **state)
{
	const rb_mat3 a = rb_mat3_diagonal(1, 1, 1);
	const struct rb_top_body body = rb_top_body_of(&a);
	struct rb_top top = rb_top_start(&body, rb_quat_identity, (rb_vec3){1, 1, -1}, none);
	const long double half = sqrtl(3) * 0x1p19L;
	rb_quat q;
	rb_vec3 w;

	(void)state;
	rb_top_at(&top, 0x1p20, &q, &w);
	assert_near(q.w, (double)cosl(half), 5e-13);
	assert_near(q.x, (double)(sinl(half) / sqrtl(3)), 5e-13);
	assert_near(q.z, (double)(-sinl(half) / sqrtl(3)), 5e-13);
	assert_true(same_vec(w, top.spin));

	/* and 1e13 rad about one axis cost no more */
	top = rb_top_start(&body, rb_quat_identity, (rb_vec3){0, 1e4, 0}, none);
	rb_top_at(&top, 1e9, &q, NULL);
	assert_near(q.w, cos(5e12), 4e-16);
	assert_near(q.y, sin(5e12), 4e-16);
}

static void a_steady_spin_up_about_its_own_axis_is_in_closed_form(void **state)
{
	const rb_mat3 a = rb_mat3_diagonal(1, 1, 1);
	const struct rb_top_body body = rb_top_body_of(&a);
	const rb_vec3 spin = {6, 0, -8}, acceleration = {-3, 0, 4};
	struct rb_top top = rb_top_start(&body, rb_quat_identity, spin, acceleration);
	rb_quat q;
	rb_vec3 w;

	(void)state;
	assert_int_equal(top.kind, RB_TOP_STEADY);
	for (double t = 0.5; t < 1e6; t *= 1.5) {
		const double half = 0.5 * (10 * t - 2.5 * t * t);

		rb_top_at(&top, t, &q, &w);
		assert_near(q.w, cos(half), 1e-15 * (1 + fabs(half)));
		assert_near(q.x, 0.6 * sin(half), 1e-15 * (1 + fabs(half)));
		assert_near(w.z, -8 + 4 * t, 0);
	}
	top = rb_top_start(&body, rb_quat_identity, none, acceleration);
	rb_top_at(&top, 2, &q, NULL);
	assert_near(q.w, cos(5), 1e-15);
}

/* Euler's angles of a free symmetric body about its angular momentum, in long doubles. */
static void a_disc_at_ten_thousand_radians_a_second(void **state)
{
	const double i1 = (3 * 0.25 + 1e-4) / 12, i3 = 0.125, t = 1;
	const rb_mat3 a = rb_mat3_diagonal(i3, i1, i1); /* its axis is x */
	const struct rb_top_body body = rb_top_body_of(&a);
	struct rb_top top = rb_top_start(&body, rb_quat_identity, (rb_vec3){1e4, 1, 0}, none);
	rb_quat q;
	rb_vec3 w;

	(void)state;
	rb_top_at(&top, t, &q, &w);
	const long double l3 = (long double)i3 * 1e4L, l1 = (long double)i1,
			  l = sqrtl(l3 * l3 + l1 * l1);
	const long double about = l / l1 * (long double)t;
	const long double own = -((long double)i3 - l1) / l1 * 1e4L * (long double)t;
	/* the body's axis: x turned about L = (l3, l1, 0) */
	const long double lx = l3 / l, ly = l1 / l;
	const rb_vec3 axis = rb_quat_rotate(q, (rb_vec3){1, 0, 0});
	const long double along = lx, px = 1 - along * lx, py = -along * ly; /* across L */
	assert_near(axis.x, (double)(along * lx + px * cosl(about)), 1e-15);
	assert_near(axis.y, (double)(along * ly + py * cosl(about)), 1e-15);
	assert_near(axis.z, (double)(-ly * sinl(about)), 1e-15);
	const double nutation = asin(
		rb_vec3_length(rb_vec3_cross(axis, (rb_vec3){(double)lx, (double)ly, 0})));
	assert_near(nutation, 5.000666662e-5, 1e-14);
	/* the whole turn: about L, then about the own axis */
	const rb_quat outer = {(double)cosl(about / 2), (double)(lx * sinl(about / 2)),
	                       (double)(ly * sinl(about / 2)), 0};
	const rb_quat inner = {(double)cosl(own / 2), (double)sinl(own / 2), 0, 0};
	assert_near(angle_between(q, rb_quat_multiply(outer, inner)), 0, 1e-11);
	const rb_vec3 expected = rb_quat_rotate(outer, (rb_vec3){1e4, 1, 0});
	assert_near(rb_vec3_length(rb_vec3_sub(w, expected)), 0, 1e-11);
}

/* ---- the intermediate axis ---- */

static double agm(double a, double b)
{
	for (int i = 0; i < 12; i++) {
		const double mean = 0.5 * (a + b);

		b = sqrt(a * b);
		a = mean;
	}
	return a;
}

/* Full period 4 K(m) / lambda (Landau, Lifshitz, Mechanics, section 37), differences written out. */
static double period_of(const double i[3], const double w[3])
{
	const double x = i[1] * (i[1] - i[0]) * w[1] * w[1] + i[2] * (i[2] - i[0]) * w[2] * w[2];
	const double z = i[2] * (i[2] - i[1]) * w[2] * w[2] - i[0] * (i[1] - i[0]) * w[0] * w[0];
	const double rest = (i[2] - i[0]) * z / ((i[2] - i[1]) * x); /* 1 - m */

	return 2 * pi / agm(1, sqrt(rest)) / sqrt((i[2] - i[1]) * x / (i[0] * i[1] * i[2]));
}

static void a_body_about_its_intermediate_axis_keeps_time_for_a_hundred_periods(void **state)
{
	const double i[3] = {2.5, 5, 6.5}, w0[3] = {0.01, 5, 0.01};
	const double period = period_of(i, w0), start_l[3] = {0.025, 25, 0.065};
	const rb_mat3 a = rb_mat3_diagonal(i[0], i[1], i[2]);
	const struct rb_top_body body = rb_top_body_of(&a);
	const double energy = 62.50045, l0 = 25.0000969998118;
	double worst_energy = 0, worst_l = 0, worst_direction = 0, least = 5;
	struct rb_top top = rb_top_start(&body, rb_quat_identity, rb_vec3_from(w0), none);

	(void)state;
	assert_near(period, 12.9012460037936, 2e-13);
	rb_vec3 b;
	for (int k = 1; k <= 1000; k++) {
		rb_quat q;
		rb_vec3 w;

		rb_top_at(&top, 0.1 * k * period, &q, &w);
		b = rb_quat_rotate_back(q, w);
		const rb_vec3 l = rb_quat_rotate(q, (rb_vec3){i[0] * b.x, i[1] * b.y, i[2] * b.z});
		const double e = 0.5 * rb_vec3_dot(l, w);
		worst_energy = fmax(worst_energy, fabs(e / energy - 1));
		worst_l = fmax(worst_l, fabs(rb_vec3_length(l) / l0 - 1));
		worst_direction = fmax(worst_direction,
		                       rb_vec3_length(rb_vec3_sub(l, rb_vec3_from(start_l))));
		least = fmin(least, b.y);
	}
	assert_true(least < -4.9); /* it did tumble */
	assert_near(worst_energy, 0, 2e-13);
	assert_near(worst_l, 0, 2e-13);
	assert_near(worst_direction / l0, 0, 2e-13);
	/* near the start components change by Euler's equations, which makes them clocks */
	const double late_z = (b.z - 0.01) / ((i[0] - i[1]) / i[2] * 0.05) / period;
	const double late_x = (b.x - 0.01) / ((i[1] - i[2]) / i[0] * 0.05) / period;
	assert_near(late_z, 0, 1e-8);
	assert_near(late_x, 0, 1e-8);
}

/* ---- against an integration that shares no code ---- */

struct reference {
	double inertia[3]; /* about the axes of the frame */
	rb_quat frame;     /* of the moments, to object coordinates */
	rb_vec3 acceleration;
};

/* Orientation, and spin in the frame of the moments; or, with equal moments, in world axes. */
static enum rb_status turning(void *user, double t, const double *y, double *rate,
                              struct rb_error *err)
{
	const struct reference *r = user;
	const double *i = r->inertia, *w = y + 4;
	const rb_quat q = rb_quat_from(y);
	const bool steady = r->acceleration.x != 0;
	rb_vec3 world = rb_vec3_from(w);

	(void)t, (void)err;
	if (!steady)
		world = rb_quat_rotate(rb_quat_multiply(q, r->frame), world);
	const rb_quat d = rb_quat_multiply((rb_quat){0, world.x, world.y, world.z}, q);
	rb_quat_to(rate, (rb_quat){0.5 * d.w, 0.5 * d.x, 0.5 * d.y, 0.5 * d.z});
	rb_vec3_to(rate + 4, r->acceleration);
	for (int k = 0; k < 3 && !steady; k++)
		rate[4 + k] = (i[(k + 1) % 3] - i[(k + 2) % 3]) / i[k] * w[(k + 1) % 3] *
		              w[(k + 2) % 3];
	return RB_OK;
}

static void integrate(struct reference *r, double *y, double end)
{
	static const double scale[7] = {1, 1, 1, 1, 1, 1, 1};
	double coefficient[7 * RB_GAUSS_NODES], scratch[256], t = 0, h = 0.1, after[7];
	uint64_t calls = 0;
	const struct rb_gauss_problem problem = {.n = 7,
	                                         .rates = turning,
	                                         .user = r,
	                                         .scale = scale,
	                                         .tolerance = 1e-14,
	                                         .scratch = scratch,
	                                         .calls = &calls};
	struct rb_gauss_piece piece = {7, 0, y, coefficient, NULL};
	struct rb_error err;

	assert_true(rb_gauss_scratch_size(7) <= 256);
	for (; t < end; t += piece.length_s) {
		h = fmin(h, end - t);
		assert_ok(rb_gauss_step(&problem, t, &h, 0, &piece, &err));
		rb_gauss_values(&piece, piece.length_s, after);
		memcpy(y, after, sizeof after);
	}
}

static void every_kind_agrees_with_an_integration(void **state)
{
	static const double moments[5][3] = {
		{2.5, 5, 6.5}, {1, 1, 1.9}, {1e-3, 2, 2.0005}, {2, 2, 2}, {3, 3, 0.1}};

	(void)state;
	for (int k = 0; k < 10; k++) {
		const double *m = moments[k / 2];
		struct reference r = {{m[0], m[1], m[2]}, rb_quat_identity, none};
		const rb_quat q0 = rb_quat_unit((rb_quat){0.1, 0.2, -0.7, 0.4});
		const rb_vec3 w0 = {1.5, -2, 0.7};
		double y[7];

		if (k % 2)
			r.frame = some_orientation();
		if (m[0] == 2)
			r.acceleration = (rb_vec3){0.3, 0.9, k % 2 ? 40 : -0.2};
		const rb_mat3 a = turned_tensor(r.frame, m[0], m[1], m[2]);
		const struct rb_top_body body = rb_top_body_of(&a);
		struct rb_top top = rb_top_start(&body, q0, w0, r.acceleration);
		rb_quat_to(y, q0);
		const rb_quat p0 = rb_quat_multiply(q0, r.frame);
		rb_vec3_to(y + 4, m[0] == 2 ? w0 : rb_quat_rotate_back(p0, w0));
		integrate(&r, y, 10);
		rb_quat q;
		rb_vec3 w;
		rb_top_at(&top, 10, &q, &w);
		rb_vec3 expected = rb_vec3_from(y + 4);
		if (m[0] != 2)
			expected = rb_quat_rotate(rb_quat_multiply(rb_quat_from(y), r.frame),
			                          expected);
		/* turned, a slender body's tensor holds its smallest moment to 2000 roundings only */
		const double bar = k == 5 ? 2e-11 : 3e-13;
		assert_near(angle_between(q, rb_quat_unit(rb_quat_from(y))), 0, bar);
		assert_near(rb_vec3_length(rb_vec3_sub(w, expected)), 0, bar);
		assert_near(rb_quat_length(q), 1, 4e-16);
	}
}

/* ---- bits ---- */

/* Bodies of all kinds; mirrored in what `sign` says (-1 in one place), also their tensors. */
enum { CASES = 9 };

static rb_vec3 mirrored_turn(rb_vec3 w, const double s[3])
{
	const double all = s[0] * s[1] * s[2];

	return (rb_vec3){all * s[0] * w.x, all * s[1] * w.y, all * s[2] * w.z};
}

static rb_quat mirrored_quat(rb_quat q, const double s[3])
{
	const rb_vec3 v = mirrored_turn((rb_vec3){q.x, q.y, q.z}, s);

	return (rb_quat){q.w, v.x, v.y, v.z};
}

static struct rb_top sample(int k, const double s[3])
{
	static const double moments[CASES][3] = {{2.5, 5, 6.5}, {2.5, 5, 6.5}, {1, 1, 1.9},
	                                         {1, 1, 1.9},   {1.9, 1, 1},   {1, 1.9, 1},
	                                         {2, 2, 2},     {2, 2, 2},     {2, 2, 3}};
	const rb_quat frame = k == 1 || k == 3 ? some_orientation() : rb_quat_identity;
	const rb_vec3 acceleration = k == 7 ? (rb_vec3){0.3, 0.9, -0.2} : none;
	const rb_quat q = rb_quat_unit((rb_quat){0.1, 0.2, -0.7, 0.4});
	rb_mat3 a = turned_tensor(frame, moments[k][0], moments[k][1], moments[k][2]);

	if (k == 8)
		a.m[0][1] = a.m[1][0] = 0.3; /* which way to turn equal moments? */
	for (int i = 0; i < 9; i++)
		a.m[i / 3][i % 3] *= s[i / 3] * s[i % 3];
	const struct rb_top_body body = rb_top_body_of(&a);
	return rb_top_start(&body, mirrored_quat(q, s), mirrored_turn((rb_vec3){1.5, -2, 0.7}, s),
	                    mirrored_turn(acceleration, s));
}

static void what_was_asked_before_does_not_matter(void **state)
{
	static const double plain[3] = {1, 1, 1};
	uint64_t random = 1;

	(void)state;
	for (int k = 0; k < CASES; k++) {
		struct rb_top asked = sample(k, plain);

		for (int n = 0; n < 300; n++) {
			random = random * 6364136223846793005u + 1442695040888963407u;
			const double t = (double)(random >> 40) * 0x1p-20;
			struct rb_top fresh = sample(k, plain);
			rb_quat q, p;
			rb_vec3 w, v;

			rb_top_at(&asked, t, &q, &w);
			rb_top_at(&fresh, t, &p, &v);
			assert_true(same_quat(p, q) && same_vec(v, w));
			rb_top_at(&asked, t, NULL, &v);
			rb_top_at(&asked, t, &p, NULL);
			assert_true(same_quat(p, q) && same_vec(v, w));
		}
		rb_quat q;
		rb_vec3 w;
		rb_top_at(&asked, 0, &q, &w); /* nothing moves at the anchor, not by a bit */
		assert_true(same_quat(q, asked.orientation) && same_vec(w, asked.spin));
	}
}

static void mirror_images_have_mirrored_bits(void **state)
{
	static const double plain[3] = {1, 1, 1};

	(void)state;
	for (int k = 0; k < CASES; k++)
		for (int signs = 1; signs < 8; signs++) {
			const double s[3] = {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1,
			                     signs & 4 ? -1 : 1};
			struct rb_top a = sample(k, plain), b = sample(k, s);

			for (double t = 0.01; t < 30; t *= 1.7) {
				rb_quat q, p;
				rb_vec3 w, v;

				rb_top_at(&a, t, &q, &w);
				rb_top_at(&b, t, &p, &v);
				assert_true(same_quat(mirrored_quat(q, s), p));
				assert_true(same_vec(mirrored_turn(w, s), v));
			}
		}
}

/* A clock that runs 2^30 times faster, moments 2^-100 of theirs: the same turn, to the bit. */
static void a_power_of_two_changes_no_bit(void **state)
{
	static const double plain[3] = {1, 1, 1};

	(void)state;
	for (int k = 0; k < 2; k++) {
		struct rb_top slow = sample(k, plain), fast;
		const struct rb_top_body body = {slow.kind, slow.principal,
		                                 rb_vec3_scale(0x1p-100, slow.moments)};
		rb_quat q, p;
		rb_vec3 w, v;

		fast = rb_top_start(&body, slow.orientation, rb_vec3_scale(0x1p30, slow.spin),
		                    none);
		rb_top_at(&slow, 9.7, &q, &w);
		rb_top_at(&fast, 9.7 * 0x1p-30, &p, &v);
		assert_true(same_quat(q, p) && same_vec(rb_vec3_scale(0x1p30, w), v));
	}
}

/* ---- extremes ---- */

static void extremes_end_and_say_so(void **state)
{
	static const double times[] = {1e-300, 1e9, 1e300, (double)INFINITY, (double)NAN};
	static const double spins[] = {0,     1e-320,           1e-170,     1e4,
	                               1e170, (double)INFINITY, (double)NAN};
	const double long_time = 1e9;

	(void)state;
	for (int k = 0; k < 3; k++)
		for (size_t s = 0; s < sizeof spins / sizeof *spins; s++)
			for (size_t n = 0; n < sizeof times / sizeof *times; n++) {
				const rb_mat3 a = rb_mat3_diagonal(1 + 0.5 * (k == 2), 1,
				                                   1 + 0.7 * k);
				const struct rb_top_body body = rb_top_body_of(&a);
				const rb_vec3 spin = {spins[s], 0.5 * spins[s], -spins[s]};
				struct rb_top top = rb_top_start(&body, rb_quat_identity, spin,
				                                 none);
				rb_quat q;
				rb_vec3 w;

				rb_top_at(&top, times[n], &q, &w);
				if (times[n] <= long_time && spins[s] <= 1e4) {
					assert_near(rb_quat_length(q), 1, 1e-15);
					assert_near(rb_vec3_length(w), 1.5 * spins[s],
					            1.5 * spins[s]);
				}
				assert_true(!isfinite(q.w) || fabs(q.w) < 1 + 1e-15);
			}
	/* about a principal axis, however unstable, the spin stays; ages are no work then */
	const rb_mat3 a = rb_mat3_diagonal(1, 2, 2.5);
	const struct rb_top_body body = rb_top_body_of(&a);
	struct rb_top top = rb_top_start(&body, rb_quat_identity, (rb_vec3){0, 1e4, 0}, none);
	rb_quat q;
	rb_vec3 w;
	rb_top_at(&top, long_time, &q, &w);
	assert_near(q.y, sin(5e12), 4e-16);
	assert_true(same_vec(w, (rb_vec3){0, 1e4, 0}));
}

/* The spin, in the body's axes, is what it was after it, and for the first time: halfway it is on the other side. */
static void assert_period(const struct rb_top *first, double period)
{
	struct rb_top top = *first;
	rb_vec3 w[3];
	rb_quat q;

	for (int k = 0; k < 3; k++) {
		rb_top_at(&top, 0.5 * k * period, &q, &w[k]);
		w[k] = rb_quat_rotate_back(q, w[k]);
	}
	assert_near(rb_vec3_length(rb_vec3_sub(w[2], w[0])), 0, 1e-9 * rb_vec3_length(w[0]));
	assert_true(rb_vec3_length(rb_vec3_sub(w[1], w[0])) > 1e-3 * rb_vec3_length(w[0]));
}

/* Whole periods are leapt from 65,536 steps on: from an anchor on the way there the same moment is walked to. */
static void a_leap_comes_to_where_a_walk_comes(void **state)
{
	static const double moments[][3] = {{1, 2, 2.5}, {2.5, 1, 2},      {2, 2.5, 1},
	                                    {2.5, 2, 1}, {1e-2, 1, 1.001}, {1, 1.5, 1.5001}};
	static const rb_vec3 spins[] = {{3, 0.5, 0.1}, {0.1, 0.5, 3}, {0.1, 3, -0.2}, {-1, 1, 1}};

	(void)state;
	for (size_t m = 0; m < sizeof moments / sizeof *moments; m += tried(1, 3, 3))
		for (size_t k = 0; k < sizeof spins / sizeof *spins; k += tried(1, 2, 2)) {
			const rb_mat3 a = rb_mat3_diagonal(moments[m][0], moments[m][1],
			                                   moments[m][2]);
			const struct rb_top_body body = rb_top_body_of(&a);
			const rb_quat start = rb_quat_unit((rb_quat){0.3, -0.5, 0.7, 0.2});
			struct rb_top whole = rb_top_start(&body, start, spins[k], none);
			struct rb_top half = whole;
			const struct rb_top first = whole;
			const double t = 60000 * whole.grid_s;
			rb_quat q, p;
			rb_vec3 w, v;

			rb_top_at(&half, t, &q, &w);
			half = rb_top_start(&body, q, w, none);
			assert_true(t / half.grid_s < 65536);
			rb_top_at(&half, t, &q, &w);
			rb_top_at(&whole, 2 * t, &p, &v);
			assert_true(whole.period_s > 0 && whole.at < 60000);
			assert_period(&first, whole.period_s);
			assert_near(rb_quat_length(
					    (rb_quat){q.w - p.w, q.x - p.x, q.y - p.y, q.z - p.z}),
			            0, 1e-9);
			assert_near(rb_vec3_length(rb_vec3_sub(w, v)), 0, 1e-9 * rb_vec3_length(w));
		}
}

/* What is steady is walked bit by bit where a caller asks for it, and comes to the same bits. */
static void a_steady_spin_is_followed_bit_by_bit(void **state)
{
	const rb_mat3 a = rb_mat3_diagonal(2, 2, 2);
	const struct rb_top_body body = rb_top_body_of(&a);
	struct rb_top top = rb_top_start(&body, rb_quat_identity, (rb_vec3){1e4, 0, 0},
	                                 (rb_vec3){0, 3, 0});
	struct rb_top other = top;
	rb_quat q, p;
	int calls = 0;

	(void)state;
	for (; !rb_top_follow(&top, 1, 300); calls++)
		assert_int_equal(top.at, 300 * (calls + 1));
	assert_int_equal(calls, 33); /* of 10,000 radians */
	rb_top_at(&top, 1, &q, NULL);
	rb_top_at(&other, 1, &p, NULL);
	assert_true(same_quat(q, p));
	assert_near(rb_top_step_s(&top), 1e-4, 1e-10);
}

/* ---- angular acceleration ---- */

static void the_turning_is_how_the_spin_changes(void **state)
{
	const rb_quat q = some_orientation();
	const rb_mat3 tensors[3] = {rb_mat3_diagonal(3, 1, 2.5), rb_mat3_diagonal(3, 1, 3),
	                            turned_tensor(q, 2, 3, 4)};
	const double h = 0x1p-12;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const struct rb_top_body body = rb_top_body_of(&tensors[k]);
		struct rb_top top = rb_top_start(&body, q, (rb_vec3){1, -2, 0.5}, none);
		rb_quat middle;
		rb_vec3 spin[3];

		for (int n = 0; n < 3; n++)
			rb_top_at(&top, 0.5 + (n - 1) * h, n == 1 ? &middle : NULL, &spin[n]);
		const rb_vec3 found = rb_top_turning(&body, &tensors[k], middle, spin[1]);
		const rb_vec3 rate = rb_vec3_scale(0.5 / h, rb_vec3_sub(spin[2], spin[0]));
		assert_near(rb_vec3_length(rb_vec3_sub(found, rate)), 0, 1e-6);
		assert_true(rb_vec3_length(rate) > 0.1);
	}
}

/* Its moments are 1e12 apart: w x I w would leave 1e12 times the rounding about its axis. */
static void a_needle_turns_over_without_noise_about_its_axis(void **state)
{
	const rb_mat3 inertia = rb_mat3_diagonal(1e-12 / 6, (1 + 1e-12) / 12, (1 + 1e-12) / 12);
	const struct rb_top_body body = rb_top_body_of(&inertia);
	const rb_quat q = some_orientation();
	const rb_vec3 spin = rb_quat_rotate(q, (rb_vec3){0, 6, 8});

	(void)state;
	assert_near(rb_vec3_length(rb_top_turning(&body, &inertia, q, spin)), 0, 1e-12);
}

/* ---- steps ---- */

static rb_vec3 momentum_of(const rb_mat3 *inertia, rb_quat q, rb_vec3 spin)
{
	return rb_quat_rotate(q, rb_mat3_apply(inertia, rb_quat_rotate_back(q, spin)));
}

/* Over thousands of steps only rounding adds up: some units in the last place in each. */
static void steps_keep_energy_and_angular_momentum(void **state)
{
	const rb_mat3 tensors[4] = {rb_mat3_diagonal(3, 1, 2.5), rb_mat3_diagonal(1e-3, 1, 1.0005),
	                            turned_tensor(some_orientation(), 2, 3, 4),
	                            rb_mat3_diagonal(1, 1, 1.9)};
	const double steps[3] = {1e-3, 0.04, 3}; /* up to a whole turn and more */
	enum { COUNT = 4000 };

	(void)state;
	for (int k = 0; k < 4; k++)
		for (int s = 0; s < 3; s++) {
			const struct rb_top_body body = rb_top_body_of(&tensors[k]);
			rb_quat q = some_orientation();
			rb_vec3 spin = {1, -2, 0.5};
			const rb_vec3 l = momentum_of(&tensors[k], q, spin);
			const double energy = rb_vec3_dot(l, spin);

			for (int n = 0; n < COUNT; n++)
				rb_top_step(&body, steps[s], &q, &spin);
			const rb_vec3 now = momentum_of(&tensors[k], q, spin);
			const double bound = 4 * COUNT * DBL_EPSILON;
			assert_near(rb_vec3_length(rb_vec3_sub(now, l)) / rb_vec3_length(l), 0,
			            bound);
			assert_near(rb_vec3_dot(now, spin) / energy, 1, bound);
		}
}

/* Beside the series: the error of one step is of its third order, so half the step leaves an eighth. */
static void a_step_is_right_but_for_its_third_order(void **state)
{
	const rb_mat3 inertia = turned_tensor(some_orientation(), 3, 1, 2.5);
	const struct rb_top_body body = rb_top_body_of(&inertia);
	const rb_vec3 spin = {1, -2, 0.5};
	double off[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		const double h = k == 0 ? 0.02 : 0.01;
		struct rb_top top = rb_top_start(&body, some_orientation(), spin, none);
		rb_quat q = some_orientation(), right;
		rb_vec3 w = spin;

		rb_top_at(&top, h, &right, NULL);
		rb_top_step(&body, h, &q, &w);
		off[k] = angle_between(q, right);
		assert_true(off[k] < pow(h * rb_vec3_length(spin), 3) / 12);
	}
	assert_near(off[0] / off[1], 8, 0.5);
}

static void about_a_principal_axis_a_step_of_any_length_is_right(void **state)
{
	const rb_mat3 inertia = rb_mat3_diagonal(3, 1, 2.5);
	const struct rb_top_body body = rb_top_body_of(&inertia);

	(void)state;
	for (double h = 0.001; h < 10; h *= 1.7) {
		rb_quat q = rb_quat_identity;
		rb_vec3 spin = {0, 0, 1.5};

		rb_top_step(&body, h, &q, &spin);
		const rb_quat right = rb_quat_from_turn((rb_vec3){0, 0, 1.5 * h});
		assert_near(angle_between(q, right), 0, 16 * DBL_EPSILON);
		assert_near(spin.z, 1.5, 4 * DBL_EPSILON);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_diagonal_tensor_keeps_its_axes),
		cmocka_unit_test(a_turned_tensor_gives_its_moments_and_axes),
		cmocka_unit_test(a_constant_spin_keeps_its_angle),
		cmocka_unit_test(a_steady_spin_up_about_its_own_axis_is_in_closed_form),
		cmocka_unit_test(a_disc_at_ten_thousand_radians_a_second),
		cmocka_unit_test(
			a_body_about_its_intermediate_axis_keeps_time_for_a_hundred_periods),
		cmocka_unit_test(every_kind_agrees_with_an_integration),
		cmocka_unit_test(what_was_asked_before_does_not_matter),
		cmocka_unit_test(mirror_images_have_mirrored_bits),
		cmocka_unit_test(a_power_of_two_changes_no_bit),
		cmocka_unit_test(extremes_end_and_say_so),
		cmocka_unit_test(a_leap_comes_to_where_a_walk_comes),
		cmocka_unit_test(a_steady_spin_is_followed_bit_by_bit),
		cmocka_unit_test(the_turning_is_how_the_spin_changes),
		cmocka_unit_test(a_needle_turns_over_without_noise_about_its_axis),
		cmocka_unit_test(steps_keep_energy_and_angular_momentum),
		cmocka_unit_test(a_step_is_right_but_for_its_third_order),
		cmocka_unit_test(about_a_principal_axis_a_step_of_any_length_is_right),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
