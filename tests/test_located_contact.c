/* SPDX-License-Identifier: MIT */
/* src/event: lasting contacts, and how they change, against closed forms. */
#include "worlds.h"

#include "runge.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const rb_vec3 earth = {0, 0, -9.81};
static const double g = 9.81;

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

/* ---- straight on a plane ---- */

static void sliding_ends_in_rolling(void **slot)
{
	const double radius = 0.1, mu = 0.3;
	/* without spin, with top spin (faster than rolling), with back spin so strong that it comes back */
	const double spin[] = {0, 60, -80};

	(void)slot;
	for (int k = 0; k < 3; k++) {
		const double v0 = 2, u0 = v0 - radius * spin[k], sign = u0 > 0 ? 1 : -1;
		const double rolls = sign * 2 * u0 / (7 * mu * g), v1 = v0 - 2.0 / 7 * u0;
		struct bench bench;

		bench_open(&bench, 4, 7);
		lab_surface(&bench.lab, mu, 0);
		struct rb_body_def def = lab_sphere_def(radius, 1, at(0, 0, radius), at(v0, 0, 0));
		def.angular_velocity = at(0, spin[k], 0);
		const int ball = lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, origin, up);
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_near(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s, rolls, 1e-12);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_SLIDE), 0);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_COLLISION), 0);
		const double x = v0 * rolls - sign * 0.5 * mu * g * rolls * rolls +
		                 v1 * (4 - rolls);
		assert_vector(rb_world_position(bench.lab.world, ball), at(x, 0, radius), 1e-12);
		assert_vector(rb_world_velocity(bench.lab.world, ball), at(v1, 0, 0), 1e-13);
		assert_vector(rb_world_angular_velocity(bench.lab.world, ball),
		              at(0, v1 / radius, 0), 1e-11);
		bench_close(&bench);
	}
}

/*
 * Along a slope, x downhill: s = g sin, n = mu g cos. The contact point's velocity u = v - R w changes by s -+ 7/2 n, v by
 * s -+ n; at u = 0 it rolls with 5/7 s if 7/2 n >= s, else it slips on downhill.
 */
static void a_ball_on_a_slope_slides_rolls_and_turns_back(void **slot)
{
	static const struct {
		double slope, mu, v0, spin;
	} table[] = {
		{0.3, 0.4, 0, 0},    {0.3, 0.05, 0, 0},   {0.3, 0.4, -3, 0},  {0.3, 0.4, 1, -40},
		{0.3, 0.05, -3, 50}, {0.3, 0.05, 1, -40}, {1.2, 0.9, -2, 20},
	};
	const double radius = 0.1, t = 3;

	(void)slot;
	for (int k = 0; k < 7; k++) {
		const double s = g * sin(table[k].slope), n = table[k].mu * g * cos(table[k].slope);
		const double v0 = table[k].v0, u0 = v0 - radius * table[k].spin;
		const rb_vec3 normal = {sin(table[k].slope), 0, cos(table[k].slope)};
		const rb_vec3 down = {cos(table[k].slope), 0, -sin(table[k].slope)};
		const double sign = u0 > 0 || (u0 == 0 && s > 3.5 * n) ? 1 : u0 < 0 ? -1 : 0;
		const double slip_rate = s - sign * 3.5 * n, rate = s - sign * n;
		const double ends = sign == 0 ? 0 : u0 * slip_rate < 0 ? -u0 / slip_rate : HUGE_VAL;
		const double before = fmin(ends, t), after = t - before;
		const double then = s > 3.5 * n ? s - n : 5.0 / 7 * s;
		const double v1 = v0 + rate * before;
		const double x = v0 * before + 0.5 * rate * before * before + v1 * after +
		                 0.5 * then * after * after;
		const double w0 = table[k].spin + sign * 2.5 * n / radius * before;
		const double w = w0 + (s > 3.5 * n ? 2.5 * n : then) / radius * after;
		struct bench bench;

		bench_open(&bench, t, 7);
		lab_surface(&bench.lab, table[k].mu, 0);
		struct rb_body_def def = lab_sphere_def(radius, 1, rb_vec3_scale(radius, normal),
		                                        rb_vec3_scale(v0, down));
		def.angular_velocity = at(0, table[k].spin, 0);
		const int ball = lab_add(&bench.lab, &def);
		lab_plane(&bench.lab, origin, normal);
		bench_seal(&bench);
		lab_run(&bench.lab);
		const rb_vec3 place = rb_world_position(bench.lab.world, ball);
		assert_near(rb_vec3_dot(place, down), x, 1e-12 * (1 + fabs(x)));
		assert_near(rb_vec3_dot(place, normal), radius, 1e-13);
		assert_near(place.y, 0, 1e-14);
		assert_near(rb_vec3_dot(rb_world_velocity(bench.lab.world, ball), down),
		            v1 + then * after, 1e-12 * (1 + fabs(v1)));
		assert_near(rb_world_angular_velocity(bench.lab.world, ball).y, w,
		            1e-12 * (1 + fabs(w)));
		if (isfinite(ends) && ends > 0 && s <= 3.5 * n)
			assert_near(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s, ends, 1e-12);
		bench_close(&bench);
	}
}

static void rolling_and_frictionless_sliding_go_on_for_ever(void **slot)
{
	const double radius = 0.1, t = 1e4;

	(void)slot;
	for (int rough = 0; rough < 2; rough++) {
		const rb_vec3 v = {1.3, -0.7, 0}, w = {7, 13, rough ? 0 : 11};
		struct lab lab;

		lab_open_located(&lab, t, 0.01);
		lab.scene.world.gravity = earth;
		lab_surface(&lab, rough ? 0.5 : 0, 0);
		struct rb_body_def def = lab_sphere_def(radius, 1, at(0, 0, radius), v);
		def.angular_velocity = w; /* that of rolling */
		const int ball = lab_add(&lab, &def);
		lab_plane(&lab, origin, up);
		lab_seal(&lab, 1);
		lab_run(&lab);
		assert_vector(rb_world_velocity(lab.world, ball), v, 1e-12);
		assert_vector(rb_world_angular_velocity(lab.world, ball), w, 1e-11);
		assert_vector(rb_world_position(lab.world, ball), at(v.x * t, v.y * t, radius),
		              1e-12 * t);
		lab_close(&lab);
	}
}

/* ---- a slide that curves ---- */

struct curve {
	double pull, rub, end_s; /* g sin, mu g cos, when the slip ends */
};

/* y: position, v, u (2 each) and t; the independent variable s makes the end of the slip far away: dt = (T - t) ds */
static void curved(const void *user, double s, const double *y, double *rate)
{
	const struct curve *c = user;
	const double speed = hypot(y[4], y[5]), left = c->end_s * exp(-s);

	rate[0] = left * y[2];
	rate[1] = left * y[3];
	for (int m = 0; m < 2; m++) {
		const double pull = m == 0 ? c->pull : 0, along = y[4 + m] / speed;

		rate[2 + m] = left * (pull - c->rub * along);
		rate[4 + m] = left * (pull - 3.5 * c->rub * along);
	}
}

/*
 * With u the contact point's velocity, A = 7/2 mu g cos, s = g sin: (A |u| + s u_x)' = s^2 - A^2, so the slip ends after
 * (A |u0| + s u0x)/(A^2 - s^2); and v - 2/7 u gains 5/7 s t.
 */
static void a_ball_thrown_across_a_slope_curves_as_it_should(void **slot)
{
	const double slope = 0.4, mu = 0.3, radius = 0.1, t = 3;
	const rb_vec3 normal = {sin(slope), 0, cos(slope)}, down = {cos(slope), 0, -sin(slope)};
	const rb_vec3 across = {0, 1, 0};
	const double v0[2] = {-1, 2}, w0[2] = {15, 5}; /* spin about `across`, about `down` */
	const double u0[2] = {v0[0] - radius * w0[0], v0[1] + radius * w0[1]};
	struct curve curve = {.pull = g * sin(slope), .rub = mu * g * cos(slope)};
	const double a = 3.5 * curve.rub, s = curve.pull;
	const double end = (a * hypot(u0[0], u0[1]) + s * u0[0]) / (a * a - s * s);
	double y[6] = {0, 0, v0[0], v0[1], u0[0], u0[1]};
	struct bench bench;

	(void)slot;
	curve.end_s = end;
	bench_open(&bench, t, 10);
	lab_surface(&bench.lab, mu, 0);
	struct rb_body_def def = lab_sphere_def(
		radius, 1, rb_vec3_scale(radius, normal),
		rb_vec3_add(rb_vec3_scale(v0[0], down), rb_vec3_scale(v0[1], across)));
	def.angular_velocity = rb_vec3_add(rb_vec3_scale(w0[0], across),
	                                   rb_vec3_scale(w0[1], down));
	const int ball = lab_add(&bench.lab, &def);
	lab_plane(&bench.lab, origin, normal);
	bench_seal(&bench);
	assert_true(end > 0.2 && end < 2);
	/* in the middle of it: s = -log(1 - t / end) */
	lab_step(&bench.lab);
	runge_solve(curved, &curve, 6, y, 0, -log1p(-0.1 / end), 4000);
	rb_vec3 x = rb_world_position(bench.lab.world, ball);
	rb_vec3 v = rb_world_velocity(bench.lab.world, ball);
	assert_near(rb_vec3_dot(x, down), y[0], 1e-12);
	assert_near(x.y, y[1], 1e-12);
	assert_near(rb_vec3_dot(v, down), y[2], 1e-12);
	assert_near(v.y, y[3], 1e-12);
	/* and after it */
	lab_run(&bench.lab);
	runge_solve(curved, &curve, 6, y, -log1p(-0.1 / end), 36, 40000);
	const double v1[2] = {v0[0] - 2.0 / 7 * u0[0] + 5.0 / 7 * s * end, v0[1] - 2.0 / 7 * u0[1]};
	const double after = t - end;
	x = rb_world_position(bench.lab.world, ball);
	v = rb_world_velocity(bench.lab.world, ball);
	assert_near(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s, end, 1e-9);
	assert_near(rb_vec3_dot(v, down), v1[0] + 5.0 / 7 * s * after, 1e-9);
	assert_near(v.y, v1[1], 1e-9);
	assert_near(rb_vec3_dot(x, down), y[0] + v1[0] * after + 0.5 * 5.0 / 7 * s * after * after,
	            1e-9);
	assert_near(x.y, y[1] + v1[1] * after, 1e-9);
	assert_near(rb_vec3_dot(x, normal), radius, 1e-12);
	bench_close(&bench);
}

/* ---- over an edge, off a sphere ---- */

/* Too fast to stay on it (v^2 > g R): a parabola from the moment when its centre is above the edge. */
static void a_fast_ball_flies_off_an_edge(void **slot)
{
	const double radius = 0.1, v = 2;
	struct bench bench;

	(void)slot;
	bench_open(&bench, 1, 7);
	lab_surface(&bench.lab, 0.5, 0);
	struct rb_body_def def = lab_sphere_def(radius, 1, at(0, 0, radius), at(v, 0, 0));
	def.angular_velocity = at(0, v / radius, 0);
	const int ball = lab_add(&bench.lab, &def);
	lab_rectangle(&bench.lab, origin, up, 1.4, 2);
	bench_seal(&bench);
	lab_run(&bench.lab);
	const double s = 1 - 0.35;
	assert_near(bench_event(&bench, RB_EVENT_LIFT, 0)->time_s, 0.35, 1e-13);
	assert_vector(rb_world_position(bench.lab.world, ball), at(v, 0, radius - 0.5 * g * s * s),
	              1e-12);
	assert_vector(rb_world_angular_velocity(bench.lab.world, ball), at(0, v / radius, 0),
	              1e-12);
	bench_close(&bench);
}

/*
 * Slow, it turns round the edge: without slip v^2 = v0^2 + 10/7 g R (1 - c), without friction v0^2 + 2 g R (1 - c), and
 * leaves where v^2 = g R c.
 */
static void a_slow_ball_turns_round_an_edge_and_leaves_it(void **slot)
{
	const double radius = 0.1, v0 = 0.3;

	(void)slot;
	for (int rough = 0; rough < 2; rough++) {
		const double slow = v0 * v0 / (g * radius);
		const double wanted = rough ? (10 + 7 * slow) / 17 : (2 + slow) / 3;
		struct bench bench;

		bench_open(&bench, 2, 7);
		lab_surface(&bench.lab, rough ? 1e12 : 0, 0);
		struct rb_body_def def = lab_sphere_def(radius, 1, at(0, 0, radius), at(v0, 0, 0));
		def.angular_velocity = at(0, rough ? v0 / radius : 0, 0);
		lab_add(&bench.lab, &def);
		lab_rectangle(&bench.lab, origin, up, 0.3, 2);
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_near(bench_event(&bench, RB_EVENT_EDGE, 0)->time_s, 0.5, 1e-12);
		/* the normal points from the ball to the edge */
		assert_near(-bench_event(&bench, RB_EVENT_LIFT, 0)->normal.z, wanted, 1e-9);
		bench_close(&bench);
	}
}

/* A ball that leaves a sheet at its four edges, and one that begins over an edge and moves outwards: turned, to the bit. */
static void all_edges_of_a_sheet_are_alike(void **slot)
{
	const double radius = 0.125, v = 0.5, half = 0.25;

	(void)slot;
	for (int begins = 0; begins < 2; begins++) {
		rb_vec3 place = origin, speed = origin;

		for (int way = 0; way < 4; way++) {
			const double sign = way % 2 ? -1 : 1, from = begins ? sign * half : 0;
			const bool along_y = way > 1;
			struct bench bench;

			bench_open(&bench, 0.75, 7);
			lab_surface(&bench.lab, 0.5, 0);
			struct rb_body_def def = lab_sphere_def(
				radius, 1, along_y ? at(0, from, radius) : at(from, 0, radius),
				along_y ? at(0, sign * v, 0) : at(sign * v, 0, 0));
			def.angular_velocity = along_y ? at(-sign * v / radius, 0, 0)
			                               : at(0, sign * v / radius, 0);
			const int ball = lab_add(&bench.lab, &def);
			lab_rectangle(&bench.lab, origin, up, 2 * half, 2 * half);
			bench_seal(&bench);
			lab_run(&bench.lab);
			const rb_vec3 x = rb_world_position(bench.lab.world, ball);
			const rb_vec3 u = rb_world_velocity(bench.lab.world, ball);
			const rb_vec3 here = at(sign * (along_y ? x.y : x.x), along_y ? x.x : x.y,
			                        x.z);
			const rb_vec3 goes = at(sign * (along_y ? u.y : u.x), along_y ? u.x : u.y,
			                        u.z);
			assert_true(here.x > half && here.z < radius && goes.z < 0);
			if (way == 0)
				place = here, speed = goes;
			assert_vector(here, place, 0);
			assert_vector(goes, speed, 0);
			bench_close(&bench);
		}
	}
}

/* On top of a fixed sphere, let go at angle a: lifts off at cos = 10/17 cos(a) rolling, 2/3 cos(a) without friction. */
static void a_ball_leaves_a_fixed_sphere_where_it_should(void **slot)
{
	const double big = 0.5, radius = 0.1, start = 0.05;

	(void)slot;
	for (int rough = 0; rough < 2; rough++) {
		const double wanted = (rough ? 10.0 / 17 : 2.0 / 3) * cos(start);
		struct bench bench;

		bench_open(&bench, 3, 7);
		lab_surface(&bench.lab, rough ? 1e12 : 0, 0);
		struct rb_body_def def = lab_sphere_def(big, 1, origin, origin);
		def.is_static = true;
		lab_add(&bench.lab, &def);
		lab_sphere(&bench.lab, radius, 1,
		           at((big + radius) * sin(start), 0, (big + radius) * cos(start)), origin);
		bench_seal(&bench);
		lab_run(&bench.lab);
		const struct rb_event *event = bench_event(&bench, RB_EVENT_LIFT, 0);
		assert_near(event->normal.z, wanted, 1e-9);
		assert_near(event->point.z, big * wanted, 1e-9);
		assert_near(event->normal.y, 0, 1e-15);
		bench_close(&bench);
	}
}

struct hill {
	double reach, mu; /* sum of radii */
};

/* Slipping down a fixed sphere. */
static void slipping(const void *user, double t, const double *y, double *rate)
{
	const struct hill *hill = user;
	const double press = g * cos(y[0]) - hill->reach * y[1] * y[1];

	(void)t;
	rate[0] = y[1];
	rate[1] = (g * sin(y[0]) - hill->mu * press) / hill->reach;
}

/*
 * Rolling, L a'^2 = 10/7 g (cos a0 - cos a) needs friction 2/7 g sin a; it slips where that exceeds mu times the
 * pressure g cos a - L a'^2, and slips on until there is none.
 */
static void a_ball_on_a_sphere_rolls_slips_and_lifts(void **slot)
{
	const struct hill hill = {0.6, 0.5};
	const double start = 0.05;
	double low = start, high = 1, y[2];
	struct bench bench;

	(void)slot;
	for (int k = 0; k < 200; k++) {
		const double a = 0.5 * (low + high);
		const double press = 17.0 / 7 * cos(a) - 10.0 / 7 * cos(start);

		if (2.0 / 7 * sin(a) > hill.mu * press)
			high = a;
		else
			low = a;
	}
	const double slips = low;
	y[0] = slips;
	y[1] = sqrt(10.0 / 7 * g * (cos(start) - cos(slips)) / hill.reach);
	/* a step too far, then back to the moment: no pressure is a simple root in t */
	double step = 1e-4, left[2];
	for (int k = 0; k < 36; k++) {
		memcpy(left, y, sizeof left);
		do {
			memcpy(y, left, sizeof y);
			runge_solve(slipping, &hill, 2, left, 0, step, 1);
		} while (g * cos(left[0]) > hill.reach * left[1] * left[1]);
		step /= 2;
	}
	bench_open(&bench, 3, 7);
	lab_surface(&bench.lab, hill.mu, 0);
	struct rb_body_def def = lab_sphere_def(0.5, 1, origin, origin);
	def.is_static = true;
	lab_add(&bench.lab, &def);
	lab_sphere(&bench.lab, 0.1, 1, at(0.6 * sin(start), 0, 0.6 * cos(start)), origin);
	bench_seal(&bench);
	lab_run(&bench.lab);
	const rb_vec3 first = bench_event(&bench, RB_EVENT_SLIDE, 0)->normal;
	const rb_vec3 last = bench_event(&bench, RB_EVENT_LIFT, 0)->normal;
	assert_near(atan2(first.x, first.z), slips, 1e-9);
	assert_near(atan2(last.x, last.z), y[0], 1e-9);
	bench_close(&bench);
}

/*
 * Both free, no friction, the large one on a plane: with k = m/(m + M) they part where k c^3 - 3 c + 2 = 0 (energy and
 * momentum along the plane, and no force between them).
 */
static void a_ball_slides_off_a_free_one(void **slot)
{
	const double big = 0.5, radius = 0.1, heavy = 3, light = 2, start = 1e-5;
	const double k = light / (light + heavy);
	double low = 0.5, high = 1;
	struct bench bench;

	(void)slot;
	for (int n = 0; n < 200; n++) {
		const double c = 0.5 * (low + high);

		if (k * c * c * c - 3 * c + 2 > 0)
			low = c;
		else
			high = c;
	}
	bench_open(&bench, 5, 7);
	lab_surface(&bench.lab, 0, 0);
	const int lower = lab_sphere(&bench.lab, big, heavy, at(0, 0, big), origin);
	const int upper = lab_sphere(
		&bench.lab, radius, light,
		at((big + radius) * sin(start), 0, big + (big + radius) * cos(start)), origin);
	lab_plane(&bench.lab, origin, up);
	bench_seal(&bench);
	const struct rb_frame_numbers before = rb_world_totals(bench.lab.world);
	double worst = 0;
	while (rb_world_time(bench.lab.world) < 5 &&
	       lab_log_count(&bench.log, RB_EVENT_LIFT) == 0) {
		const struct rb_frame_numbers now = rb_world_totals(bench.lab.world);

		worst = fmax(worst, fabs(now.kinetic_energy + now.potential_energy -
		                         before.potential_energy));
		lab_step(&bench.lab);
	}
	const struct rb_event *event = bench_event(&bench, RB_EVENT_LIFT, 0);
	assert_int_equal(event->a, lower);
	assert_int_equal(event->b, upper);
	assert_near(event->normal.z, low, 1e-9);
	assert_near(worst / before.potential_energy, 0, 1e-13);
	assert_near(heavy * rb_world_velocity(bench.lab.world, lower).x +
	                    light * rb_world_velocity(bench.lab.world, upper).x,
	            0, 1e-13);
	bench_close(&bench);
}

/* ---- at rest ---- */

static void what_rests_does_not_move_at_all(void **slot)
{
	const double r = 0.1, apart = 2 * r / sqrt(3), high = 2 * r * sqrt(2.0 / 3);
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 100, 1);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.5, 0);
	/* three, and one on top: held by friction alone */
	for (int k = 0; k < 3; k++)
		lab_sphere(&lab, r, 1,
		           at(apart * cos(2.0943951023931953 * k),
		              apart * sin(2.0943951023931953 * k), r),
		           origin);
	lab_sphere(&lab, r, 1, at(0, 0, r + high), origin);
	/* a column of ten */
	for (int k = 0; k < 10; k++)
		lab_sphere(&lab, r, pow(10, k % 4), at(3, 0, r + 2 * r * k), origin);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	double before[14][3];
	for (int k = 0; k < 14; k++)
		rb_vec3_to(before[k], rb_world_position(lab.world, k));
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).kinetic_energy == 0);
	for (int k = 0; k < 14; k++)
		assert_vector(rb_world_position(lab.world, k), rb_vec3_from(before[k]), 1e-15);
	assert_int_equal(rb_world_totals(lab.world).collisions, 0);
	lab_close(&lab);
}

/* The forces of a column carry all above: as seen at a frame. */
static void contacts_of_a_frame_carry_the_weight(void **slot)
{
	struct rb_frame_contact contacts[8];
	struct rb_frame frame = {.contacts = contacts, .contact_capacity = 8};
	struct lab lab;

	(void)slot;
	lab_open_located(&lab, 1, 10);
	lab.scene.world.gravity = earth;
	lab_surface(&lab, 0.5, 0);
	for (int k = 0; k < 3; k++)
		lab_sphere(&lab, 0.1, 1 + k, at(0, 0, 0.1 + 0.2 * k), origin);
	lab_plane(&lab, origin, up);
	lab_seal(&lab, 1);
	lab_step(&lab);
	assert_int_equal(rb_world_fill_frame(lab.world, &frame, &lab.error), RB_OK);
	assert_int_equal(frame.contact_count, 3);
	assert_int_equal(frame.numbers.contacts, 3);
	/* by pair: 0-1 carries 2 and 3 kg, 0-plane all, 1-2 3 kg */
	const double wanted[] = {5 * g, -6 * g, 3 * g};
	for (int k = 0; k < 3; k++) {
		assert_true(contacts[k].a < contacts[k].b);
		assert_vector(contacts[k].force, at(0, 0, wanted[k]), 1e-12);
	}
	lab_close(&lab);
}

/*
 * A push that begins at 0.1 s sets off without slip: a box tips where it is pushed over at half its
 * width, F h/2 > m g w/2, a ball rolls. Either is told when the push begins, whatever the frames.
 */
static void what_a_force_sets_off_rolls_from_then_on(void **slot)
{
	const double mass = 2, half = 0.25;

	(void)slot;
	for (int k = 0; k < 4; k++) {
		const rb_vec3 size = at(0.2, 0.3, 2 * half), position = at(0, 0, half);
		struct rb_force_def force = rb_force_def_default();
		struct bench bench;

		bench_open(&bench, 0.3, k % 2 == 0 ? 7 : 100);
		lab_surface(&bench.lab, 2, 0);
		force.vector = at(0.9 * mass * g, 0, 0);
		force.start_s = 0.1;
		const struct rb_body_def def = k < 2 ? lab_box_def(size, mass, position)
		                                     : lab_sphere_def(half, mass, position, origin);
		lab_add(&bench.lab, &def);
		assert_int_equal(rb_scene_add_force(&bench.lab.scene, &force, &bench.lab.error),
		                 RB_OK);
		lab_plane(&bench.lab, origin, up);
		bench_seal(&bench);
		lab_run(&bench.lab);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_ROLL), 1);
		assert_true(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s == 0.1);
		bench_close(&bench);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sliding_ends_in_rolling),
		cmocka_unit_test(a_ball_on_a_slope_slides_rolls_and_turns_back),
		cmocka_unit_test(rolling_and_frictionless_sliding_go_on_for_ever),
		cmocka_unit_test(a_ball_thrown_across_a_slope_curves_as_it_should),
		cmocka_unit_test(a_fast_ball_flies_off_an_edge),
		cmocka_unit_test(a_slow_ball_turns_round_an_edge_and_leaves_it),
		cmocka_unit_test(all_edges_of_a_sheet_are_alike),
		cmocka_unit_test(a_ball_leaves_a_fixed_sphere_where_it_should),
		cmocka_unit_test(a_ball_on_a_sphere_rolls_slips_and_lifts),
		cmocka_unit_test(a_ball_slides_off_a_free_one),
		cmocka_unit_test(what_rests_does_not_move_at_all),
		cmocka_unit_test(contacts_of_a_frame_carry_the_weight),
		cmocka_unit_test(what_a_force_sets_off_rolls_from_then_on),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
