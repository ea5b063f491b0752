/* SPDX-License-Identifier: MIT */
/* Limits of joints and ropes by the located method, against closed forms. */
#include "jointed.h"

#include "method/numbers.h"
#include "world/joint_state.h"

static const double gravity = 9.81;

static void seal(struct lab *lab, struct lab_log *log)
{
	const struct rb_world_options options = {
		.threads = 1, .keep_events = true, .keep_contacts = true};
	const struct rb_world_hooks hooks = lab_log_open(log);

	lab_seal_with(lab, &options, &hooks);
}

static rb_vec3 place(const struct lab *lab, int i)
{
	return rb_vec3_from(lab->world->state.position + 3 * i);
}

/* Energy is explained to 1e-14 of what moved. */
static void balances(struct lab *lab)
{
	struct rb_frame_numbers numbers = {0};

	rb_numbers_measure(lab->world, &numbers);
	assert_true(numbers.has_ledger);
	assert_near(numbers.ledger.energy[RB_ENERGY_CAUSES], 0,
	            1e-14 * numbers.ledger.energy_scale);
}

/*
 * A wheel with a constant torque against its stop: with a = torque/I it is met at t0 with a t0, and
 * rests after t0 + 2 t0 e/(1 - e), at the stop. `side`: which limit; `way`: of the axis.
 */
static void rebounds_end(int kind, int side, double way)
{
	const double e = 0.5, limit = 0.5, most = 2, radius = 0.5, mass = 3;
	const double inertia = kind == RB_JOINT_HINGE ? 0.4 * mass * radius * radius : mass;
	const double a = most / inertia, first = sqrt(2 * limit / a);
	const double rest = first + 2 * first * e / (1 - e);
	struct lab lab;
	struct lab_log log;

	lab_open_located(&lab, rest + 0.5, 4);
	const int body = lab_sphere(&lab, radius, mass, (rb_vec3){0.3, -2, 1}, (rb_vec3){0, 0, 0});
	struct rb_joint_def def = jointed_def(kind, body, -1);

	if (kind == RB_JOINT_HINGE)
		def.at = (rb_vec3){0.3, -2, 1};
	def.axis = rb_vec3_scale(way, (rb_vec3){0.6, 0, 0.8});
	def.limits[0] = side < 0 ? -limit : -1;
	def.limits[1] = side > 0 ? limit : 1;
	def.restitution = e;
	def.motor_speed = side * 100;
	def.motor_max = most;
	jointed_add(&lab, def);
	seal(&lab, &log);
	lab_run(&lab);
	for (int k = 0; k < 20; k++) {
		const struct rb_event *event = lab_log_find(&log, RB_EVENT_LIMIT, k);
		const double met = first + 2 * first * e * (1 - pow(e, k)) / (1 - e);
		/* a place of 2 m is rounded, and passed with that speed, as those before were */
		const double late_s = 16 * 0x1p-51 / (a * first * pow(e, k));

		assert_non_null(event);
		assert_near(event->time_s, met, 1e-14 * met + late_s);
		assert_near(event->approach_speed, a * first * pow(e, k),
		            1e-13 * a * first + a * late_s);
		assert_near(rb_vec3_dot(event->impulse, event->normal),
		            -side * (1 + e) * inertia * a * first * pow(e, k),
		            2 * inertia * (1e-13 * a * first + a * late_s));
	}
	/* rebounds below rounding are none */
	assert_true(lab_log_count(&log, RB_EVENT_LIMIT) < 60);
	const struct rb_joint_reading now = rb_joint_state_now(lab.world, 0);

	assert_near(now.angle, side * limit, 1e-15);
	assert_near(now.speed, 0, 1e-15);
	balances(&lab);
	lab_log_close(&log);
	lab_close(&lab);
}

static void rebounds_at_a_limit_end_where_the_series_does(void **state)
{
	(void)state;
	for (int side = -1; side <= 1; side += 2)
		for (double way = -1; way <= 1; way += 2) {
			rebounds_end(RB_JOINT_HINGE, side, way);
			rebounds_end(RB_JOINT_SLIDER, side, way);
		}
}

/*
 * A ball falls beside the point that its rope of 1 m is fixed to, 0.6 m away, until this is taut,
 * 0.8 m below: then e of the 0.8 v along the rope come back. Turned about the vertical.
 */
static void catches(double e, double angle)
{
	const double taut = sqrt(2 * 0.8 / gravity), v = gravity * taut;
	const rb_vec3 away = {cos(angle), sin(angle), 0};
	struct lab lab;
	struct lab_log log;

	lab_open_located(&lab, 1, 10);
	lab.scene.world.gravity = (rb_vec3){0, 0, -gravity};
	const int ball = lab_sphere(&lab, 0.1, 2, rb_vec3_scale(0.6, away), (rb_vec3){0, 0, 0});
	struct rb_joint_def def = jointed_def(RB_JOINT_ROPE, ball, -1);

	def.at_b = (rb_vec3){0, 0, 0};
	def.length_m = 1;
	def.restitution = e;
	jointed_add(&lab, def);
	seal(&lab, &log);
	lab_run(&lab);
	const struct rb_event *event = lab_log_find(&log, RB_EVENT_TAUT, 0);

	assert_non_null(event);
	assert_near(event->time_s, taut, 4e-16);
	assert_near(event->approach_speed, 0.8 * v, 1e-14);
	/* on b, the world, which the ball pulls down */
	assert_near(rb_vec3_length(event->impulse), 2 * (1 + e) * 0.8 * v, 1e-13);
	assert_near(rb_vec3_dot(event->impulse, event->normal), -2 * (1 + e) * 0.8 * v, 1e-13);
	if (e == 0) {
		/* a pendulum with 0.6 v along its circle */
		const rb_vec3 x = place(&lab, ball),
			      u = rb_vec3_from(lab.world->state.velocity + 3 * ball);

		assert_near(rb_vec3_length(x), 1, 4e-16);
		assert_near(0.5 * rb_vec3_dot(u, u) + gravity * x.z,
		            0.5 * 0.36 * v * v - 0.8 * gravity, 1e-13);
		assert_int_equal(lab_log_count(&log, RB_EVENT_TAUT), 1);
	} else {
		assert_true(lab_log_count(&log, RB_EVENT_TAUT) > 1);
	}
	balances(&lab);
	lab_log_close(&log);
	lab_close(&lab);
}

static void a_rope_catches_a_falling_ball(void **state)
{
	(void)state;
	for (int k = 0; k < 3; k++) {
		catches(0, 0.7 * k);
		catches(1, 0.7 * k);
	}
}

/*
 * From below with v^2 = 3.5 g L it goes slack where v^2 = g z, z = L/2, and flies until it is taut
 * again after t = 4 v cos/g (the parabola's four points in common with the circle: three are here).
 */
static void a_rope_goes_slack_above_its_point(void **state)
{
	const double v = sqrt(0.5 * gravity), flight = 4 * v * sqrt(0.75) / gravity;

	(void)state;
	for (int way = -1; way <= 1; way += 2) {
		struct lab lab;
		struct lab_log log;

		lab_open_located(&lab, 1.5, 10);
		lab.scene.world.gravity = (rb_vec3){0, 0, -gravity};
		const int ball = lab_sphere(&lab, 0.1, 2, (rb_vec3){0, 0, -1},
		                            (rb_vec3){0, way * sqrt(3.5 * gravity), 0});
		struct rb_joint_def def = jointed_def(RB_JOINT_ROPE, ball, -1);

		def.at_b = (rb_vec3){0, 0, 0};
		jointed_add(&lab, def);
		seal(&lab, &log);
		lab_run(&lab);
		const struct rb_event *slack = lab_log_find(&log, RB_EVENT_SLACK, 0);
		const struct rb_event *taut = lab_log_find(&log, RB_EVENT_TAUT, 0);

		assert_non_null(slack);
		assert_non_null(taut);
		/* the normal points from the ball to where the rope is fixed */
		assert_near(slack->normal.z, -0.5, 1e-11);
		assert_near(slack->normal.y, -way * sqrt(0.75), 1e-11);
		assert_near(taut->time_s - slack->time_s, flight, 1e-11);
		balances(&lab);
		lab_log_close(&log);
		lab_close(&lab);
	}
}

/* Two balls that part at a rope's end exchange what an elastic impact does. */
static void a_rope_between_two_balls_turns_their_velocity_round(void **state)
{
	struct lab lab;
	struct lab_log log;

	(void)state;
	lab_open_located(&lab, 1, 10);
	lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){-1, 0, 0});
	lab_sphere(&lab, 0.1, 3, (rb_vec3){1, 0, 0}, (rb_vec3){1, 0, 0});
	struct rb_joint_def def = jointed_def(RB_JOINT_ROPE, 0, 1);

	def.length_m = 2;
	def.restitution = 1;
	jointed_add(&lab, def);
	seal(&lab, &log);
	lab_run(&lab);
	const struct rb_event *event = lab_log_find(&log, RB_EVENT_TAUT, 0);

	assert_non_null(event);
	assert_near(event->time_s, 0.5, 4e-16);
	/* relative velocity 2 to -2 with the effective mass 3/4: impulse 3 */
	assert_near(event->impulse.x, -3, 1e-14);
	assert_near(lab.world->state.velocity[0], 2, 1e-14);
	assert_near(lab.world->state.velocity[3], 0, 1e-14);
	assert_near(place(&lab, 0).x, -0.5 + 1, 1e-14);
	balances(&lab);
	lab_log_close(&log);
	lab_close(&lab);
}

/* A friction that a motor overcomes, and one that it does not: events of what holds. */
static void a_brake_tells_when_it_holds(void **state)
{
	struct lab lab;
	struct lab_log log;

	(void)state;
	lab_open_located(&lab, 2, 10);
	struct rb_body_def wheel = lab_sphere_def(0.5, 4, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});

	wheel.angular_velocity = (rb_vec3){0, 0, -3};
	struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, lab_add(&lab, &wheel), -1);

	def.at = (rb_vec3){0, 0, 0};
	def.axis = (rb_vec3){0, 0, 1};
	def.friction = 1.2; /* I = 0.4: stops after 1 s */
	jointed_add(&lab, def);
	seal(&lab, &log);
	lab_run(&lab);
	assert_int_equal(lab_log_count(&log, RB_EVENT_DRIVES), 1);
	assert_int_equal(lab_log_count(&log, RB_EVENT_SLIPS), 0);
	assert_near(lab_log_find(&log, RB_EVENT_DRIVES, 0)->time_s, 1, 1e-13);
	balances(&lab);
	lab_log_close(&log);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rebounds_at_a_limit_end_where_the_series_does),
		cmocka_unit_test(a_rope_catches_a_falling_ball),
		cmocka_unit_test(a_rope_goes_slack_above_its_point),
		cmocka_unit_test(a_rope_between_two_balls_turns_their_velocity_round),
		cmocka_unit_test(a_brake_tells_when_it_holds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
