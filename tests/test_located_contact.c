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

/* A lab whose events are logged. */
struct bench {
	struct lab lab;
	struct lab_log log;
	struct rb_world_hooks hooks;
};

static void bench_open(struct bench *bench, double duration, double frame_rate)
{
	lab_open_located(&bench->lab, duration, frame_rate);
	bench->hooks = lab_log_open(&bench->log);
	bench->lab.scene.world.gravity = earth;
}

static void bench_seal(struct bench *bench)
{
	const struct rb_world_options options = {.threads = 1};

	lab_seal_with(&bench->lab, &options, &bench->hooks);
}

static void bench_close(struct bench *bench)
{
	lab_log_close(&bench->log);
	lab_close(&bench->lab);
}

static const struct rb_event *bench_event(const struct bench *bench, enum rb_event_kind kind, int n)
{
	const struct rb_event *event = lab_log_find(&bench->log, kind, n);

	if (!event)
		fail_msg("no '%s' number %d among %d events", rb_event_kind_name(kind), n,
		         bench->log.count);
	return event;
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
	lab_open_promise("friction of a slip round a sphere keeps its direction for a whole piece");
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

/* ---- driven ---- */

enum drive { DRIVE_LIFT, DRIVE_BELT, DRIVE_SHAKE, DRIVE_TURN, DRIVE_PUSH };
static const double drive_speed = 0.5, shake_size = 0.02, shake_rate = 30, turn_rate = 3;

struct driver {
	enum drive drive;
	bool differenced; /* velocities are left out */
};

static enum rb_status motion(void *user, int id, double t, struct rb_driven_pose *pose,
                             struct rb_error *err)
{
	const struct driver *driver = user;

	(void)id, (void)err;
	pose->position = origin;
	pose->velocity = pose->angular_velocity = origin;
	pose->has_velocity = pose->has_angular_velocity = !driver->differenced;
	switch (driver->drive) {
	case DRIVE_LIFT:
		pose->velocity = at(0, 0, drive_speed);
		pose->position = at(0, 0, drive_speed * t);
		break;
	case DRIVE_BELT:
	case DRIVE_PUSH:
		pose->velocity = at(drive_speed, 0, 0);
		pose->position = at(drive_speed * t, 0, 0);
		break;
	case DRIVE_SHAKE:
		pose->velocity = at(0, 0, shake_size * shake_rate * cos(shake_rate * t));
		pose->position = at(0, 0, shake_size * sin(shake_rate * t));
		break;
	case DRIVE_TURN:
		pose->angular_velocity = at(0, 0, turn_rate);
		pose->orientation = (rb_quat){cos(0.5 * turn_rate * t), 0, 0,
		                              sin(0.5 * turn_rate * t)};
		break;
	}
	return RB_OK;
}

static void open_driven(struct bench *bench, struct driver *driver, double duration)
{
	const rb_vec3 speed[] = {[DRIVE_LIFT] = {0, 0, drive_speed},
	                         [DRIVE_BELT] = {drive_speed, 0, 0},
	                         [DRIVE_SHAKE] = {0, 0, shake_size * shake_rate},
	                         [DRIVE_TURN] = {0, 0, 0},
	                         [DRIVE_PUSH] = {drive_speed, 0, 0}};
	struct rb_body_def def = lab_sphere_def(0.2, 1, origin, speed[driver->drive]);

	bench_open(bench, duration, 10);
	/* one hook set for events and motion: the log is its user, the driver is reached through it */
	if (driver->drive != DRIVE_PUSH) {
		def.call = "plane";
		def.shape = (struct rb_shape){.kind = RB_SHAPE_PLANE};
		def.orientation = rb_plane_orientation(up, at(NAN, 0, 0));
	} else {
		bench->lab.scene.world.gravity = origin;
	}
	def.mass = NAN;
	def.motion = 0;
	def.motion_turns = driver->drive == DRIVE_TURN;
	def.motion_gives_velocity = def.motion_gives_angular_velocity = !driver->differenced;
	if (driver->drive == DRIVE_TURN)
		def.angular_velocity = at(0, 0, turn_rate);
	lab_add(&bench->lab, &def);
}

/* The hooks have one user: events go to the log, motions come from the driver. */
struct both {
	struct lab_log *log;
	struct driver *driver;
};

static enum rb_status both_event(void *user, struct rb_world *world, const struct rb_event *event,
                                 struct rb_error *err)
{
	const struct both *both = user;

	return lab_log_event(both->log, world, event, err);
}

static enum rb_status both_motion(void *user, int id, double t, struct rb_driven_pose *pose,
                                  struct rb_error *err)
{
	const struct both *both = user;

	return motion(both->driver, id, t, pose, err);
}

static void seal_driven(struct bench *bench, struct both *both, struct driver *driver)
{
	*both = (struct both){&bench->log, driver};
	bench->hooks = (struct rb_world_hooks){.user = both,
	                                       .collision = both_event,
	                                       .transition = both_event,
	                                       .motion = both_motion};
	bench_seal(bench);
}

/* Seen from the floor that rises, a ball falls with an extra speed; everything else is as ever. */
static void a_ball_bounces_on_a_rising_floor(void **slot)
{
	const double e = 0.8, h = 1;

	(void)slot;
	for (int differenced = 0; differenced < 2; differenced++) {
		struct driver driver = {DRIVE_LIFT, differenced};
		struct both both;
		struct bench bench;

		open_driven(&bench, &driver, 2);
		lab_surface(&bench.lab, 0, e);
		const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0, 0, h + 0.1), origin);
		seal_driven(&bench, &both, &driver);
		lab_run(&bench.lab);
		/* relative to the floor: from h at -u */
		double v = -drive_speed, z = h, t = 0;
		for (int n = 0;; n++) {
			const double s = (v + sqrt(v * v + 2 * g * z)) / g;

			if (t + s > 2) {
				z += v * (2 - t) - 0.5 * g * (2 - t) * (2 - t);
				break;
			}
			t += s;
			v = e * (g * s - v);
			z = 0;
			assert_near(bench_event(&bench, RB_EVENT_COLLISION, n)->time_s, t,
			            differenced ? 1e-8 : 1e-12);
		}
		assert_near(rb_world_position(bench.lab.world, ball).z, z + drive_speed * 2 + 0.1,
		            differenced ? 1e-8 : 1e-12);
		bench_close(&bench);
	}
}

static void a_ball_on_a_belt_comes_to_roll(void **slot)
{
	const double mu = 0.3, rolls = 2 * drive_speed / (7 * mu * g);
	struct driver driver = {DRIVE_BELT, false};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, 2);
	lab_surface(&bench.lab, mu, 0);
	const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	assert_near(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s, rolls, 1e-11);
	assert_vector(rb_world_velocity(bench.lab.world, ball), at(2.0 / 7 * drive_speed, 0, 0),
	              1e-11);
	assert_vector(rb_world_position(bench.lab.world, ball),
	              at(0.5 * mu * g * rolls * rolls + mu * g * rolls * (2 - rolls), 0, 0.1),
	              1e-11);
	bench_close(&bench);
}

/* On A sin(w t), A w^2 > g: it leaves where A w^2 sin(w t) = g, flies, and lands without a bounce. */
static void a_ball_leaves_a_shaken_floor_in_time(void **slot)
{
	const double a = shake_size, w = shake_rate;
	const double leaves = asin(g / (a * w * w)) / w;
	const double z0 = a * sin(w * leaves), v0 = a * w * cos(w * leaves);
	double low = leaves + 1e-3, high = leaves + 0.25;
	struct driver driver = {DRIVE_SHAKE, false};
	struct both both;
	struct bench bench;

	(void)slot;
	lab_open_promise(
		"a floor's velocity jumps by rounding at the end of a piece, and throws off the ball");
	open_driven(&bench, &driver, 0.4);
	lab_surface(&bench.lab, 0, 0);
	lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
	/* it starts with the floor's speed */
	bench.lab.scene.bodies[1].velocity = at(0, 0, a * w);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	for (double t = low; t < high; t += 1e-4) { /* the first time below the floor */
		const double s = t - leaves;

		if (z0 + v0 * s - 0.5 * g * s * s < a * sin(w * t)) {
			high = t;
			break;
		}
	}
	for (int k = 0; k < 100; k++) {
		const double t = 0.5 * (low + high), s = t - leaves;

		if (z0 + v0 * s - 0.5 * g * s * s < a * sin(w * t))
			high = t;
		else
			low = t;
	}
	assert_near(bench_event(&bench, RB_EVENT_LIFT, 0)->time_s, leaves, 1e-11);
	assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s, low, 1e-11);
	bench_close(&bench);
}

/* Without slip on a table that turns at W, the centre of a solid ball goes round a circle at 2/7 W. */
static void a_ball_on_a_turntable_goes_in_circles(void **slot)
{
	const double radius = 0.1, x0 = 0.4, rate = 2.0 / 7 * turn_rate, t = 10;
	const rb_vec3 v = {0.1, 0.3, 0};
	struct driver driver = {DRIVE_TURN, false};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, t);
	lab_surface(&bench.lab, 0.9, 0);
	struct rb_body_def def = lab_sphere_def(radius, 1, at(x0, 0, radius), v);
	def.angular_velocity = at((turn_rate * x0 - v.y) / radius, v.x / radius, 0.7);
	const int ball = lab_add(&bench.lab, &def);
	seal_driven(&bench, &both, &driver);
	while (rb_world_frame(bench.lab.world) + 1 < rb_world_frame_count(bench.lab.world)) {
		lab_step(&bench.lab);
		const double s = rb_world_time(bench.lab.world);
		const double c = cos(rate * s), d = sin(rate * s);
		const rb_vec3 wanted = {x0 + (v.x * d - v.y * (1 - c)) / rate,
		                        (v.x * (1 - c) + v.y * d) / rate, radius};

		assert_vector(rb_world_position(bench.lab.world, ball), wanted, 1e-10);
		assert_vector(rb_world_velocity(bench.lab.world, ball),
		              at(v.x * c - v.y * d, v.x * d + v.y * c, 0), 1e-10);
		assert_near(rb_world_angular_velocity(bench.lab.world, ball).z, 0.7, 1e-11);
	}
	assert_int_equal(bench.log.count, 0);
	bench_close(&bench);
}

/* A driven sphere is not pushed back: with e = 1 what it meets leaves at twice its speed. */
static void a_driven_sphere_hits_like_a_wall(void **slot)
{
	struct driver driver = {DRIVE_PUSH, false};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, 3);
	lab_surface(&bench.lab, 0, 1);
	const int ball = lab_sphere(&bench.lab, 0.1, 5, at(0.8, 0, 0), origin);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s, 1, 1e-12);
	assert_near(rb_world_velocity(bench.lab.world, ball).x, 2 * drive_speed, 1e-12);
	assert_near(rb_world_position(bench.lab.world, ball).x, 0.8 + 4 * drive_speed, 1e-11);
	assert_near(rb_world_position(bench.lab.world, 0).x, 3 * drive_speed, 1e-12);
	bench_close(&bench);
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
		cmocka_unit_test(a_ball_leaves_a_fixed_sphere_where_it_should),
		cmocka_unit_test(a_ball_on_a_sphere_rolls_slips_and_lifts),
		cmocka_unit_test(a_ball_slides_off_a_free_one),
		cmocka_unit_test(what_rests_does_not_move_at_all),
		cmocka_unit_test(contacts_of_a_frame_carry_the_weight),
		cmocka_unit_test(a_ball_bounces_on_a_rising_floor),
		cmocka_unit_test(a_ball_on_a_belt_comes_to_roll),
		cmocka_unit_test(a_ball_leaves_a_shaken_floor_in_time),
		cmocka_unit_test(a_ball_on_a_turntable_goes_in_circles),
		cmocka_unit_test(a_driven_sphere_hits_like_a_wall),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
