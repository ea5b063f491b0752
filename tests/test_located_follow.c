/* SPDX-License-Identifier: MIT */
/* Motors that follow, by the located method: src/located/follow.c, joint_rows.c, mode_checks.c. */
#include "jointed.h"

#include "located/follow.h"
#include "method/numbers.h"
#include "model/joints.h"

static const double gravity = 9.81;

/* What motors follow: a sin(w t); with `speeds` its rate, too; a `kink` at that time. */
struct path {
	double a, w, kink_s;
	bool speeds;
	struct lab_log log;
};

static double value_of(const struct path *path, double t)
{
	return path->kink_s > 0 ? fabs(t - path->kink_s) - path->kink_s
	                        : path->a * sin(path->w * t);
}

static enum rb_status ask(void *user, int joint, double time_s, double value[2],
                          struct rb_error *err)
{
	const struct path *path = user;

	(void)joint, (void)err;
	value[0] = value_of(path, time_s);
	value[1] = path->speeds ? path->a * path->w * cos(path->w * time_s) : (double)NAN;
	return RB_OK;
}

static enum rb_status hear(void *user, struct rb_world *world, const struct rb_event *event,
                           struct rb_error *err)
{
	struct path *path = user;

	return lab_log_event(&path->log, world, event, err);
}

/* The joint has a motor that follows, with at most that torque or force. */
static void add_motor(struct lab *lab, struct rb_joint_def def, double max)
{
	def.motor_function = 0;
	def.motor_max = max;
	jointed_add(lab, def);
}

static void seal(struct lab *lab, struct path *path)
{
	const struct rb_world_options options = {.threads = 1, .keep_events = true};
	struct rb_world_hooks hooks = lab_log_open(&path->log);

	hooks.user = path;
	hooks.transition = hear;
	hooks.collision = NULL;
	hooks.follow = ask;
	lab_seal_with(lab, &options, &hooks);
}

static void frame(struct lab *lab)
{
	if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
}

static void to_end(struct lab *lab)
{
	while (lab->world->state.frame + 1 < lab->model->frame_count)
		frame(lab);
}

static struct rb_joint_reading read_joint(struct lab *lab)
{
	struct rb_joint_reading reading;

	if (rb_world_joint(lab->world, 0, &reading, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
	return reading;
}

static struct rb_frame_numbers numbers(const struct lab *lab)
{
	struct rb_frame_numbers n = {0};

	rb_numbers_measure(lab->world, &n);
	assert_true(n.has_ledger);
	return n;
}

static void balances_within(const struct lab *lab, double energy)
{
	const struct rb_ledger_values l = numbers(lab).ledger;

	assert_near(l.energy[RB_ENERGY_CAUSES], 0, energy);
}

static void balances(const struct lab *lab)
{
	/* of some joules */
	balances_within(lab, 1e-13);
}

/* A ball of inertia I about the axis -y of a hinge on the world, `below` it. */
static void add_ball(struct lab *lab, double mass, double inertia, double below, double speed)
{
	struct rb_body_def def = lab_sphere_def(0.1, mass, (rb_vec3){0, 0, -below},
	                                        (rb_vec3){below * speed, 0, 0});

	const rb_mat3 moments = rb_mat3_diagonal(inertia, inertia, inertia);
	def.inertia = &moments;
	def.angular_velocity = (rb_vec3){0, -speed, 0};
	lab_add(lab, &def);
}

/* The hinge; the angle is that of the world against the ball, about y. */
static struct rb_joint_def hinge(void)
{
	struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, 0, -1);

	def.at = (rb_vec3){0, 0, 0};
	def.axis = (rb_vec3){0, 1, 0};
	return def;
}

/*
 * A pendulum is led through q = a sin(w t): the torque is (I + m L^2) q'' + m g L sin q. With the
 * rate given to rounding; differenced, to what second derivatives of rounded values are.
 */
static void a_pendulum_is_led_with_the_torque_that_it_needs(void **state)
{
	const double mass = 2, inertia = 0.05, length = 0.7;

	(void)state;
	for (int speeds = 0; speeds < 2; speeds++) {
		struct path path = {.a = 0.8, .w = 3, .speeds = speeds};
		struct lab lab;

		lab_open_located(&lab, 5, 20);
		lab.scene.world.gravity = (rb_vec3){0, 0, -gravity};
		add_ball(&lab, mass, inertia, length, path.a * path.w);
		add_motor(&lab, hinge(), 1e3);
		seal(&lab, &path);
		while (lab.world->state.frame + 1 < lab.model->frame_count) {
			const double t = lab.world->state.time_s, q = value_of(&path, t);
			const struct rb_joint_reading r = read_joint(&lab);
			const double torque = (inertia + mass * length * length) * -9 * q +
			                      mass * gravity * length * sin(q);

			assert_near(r.angle, q, 1e-14);
			assert_near(r.speed, 2.4 * cos(3 * t), speeds ? 1e-13 : 1e-11);
			/* what the joint exerts is on the world */
			assert_near(r.torque.y, torque, speeds ? 1e-11 : 1e-8);
			frame(&lab);
		}
		/* the motor's work is what the energy has grown by */
		balances(&lab);
		assert_int_equal(path.log.count, 0);
		lab_log_close(&path.log);
		lab_close(&lab);
	}
}

/* The root of a function that is negative at `low`, positive at `high`. */
static double root(double (*f)(double, const double *), const double *with, double low, double high)
{
	for (int k = 0; k < 100; k++) {
		const double middle = 0.5 * (low + high);

		*(f(middle, with) < 0 ? &low : &high) = middle;
	}
	return low;
}

/* with: a, w, M/I, t1, q1, v1. How far it is off after the slip begins, its rate. */
static double off(double t, const double *with)
{
	const double s = t - with[3];

	return with[4] + with[5] * s - 0.5 * with[2] * s * s - with[0] * sin(with[1] * t);
}
static double off_rate(double t, const double *with)
{
	return with[5] - with[2] * (t - with[3]) - with[0] * with[1] * cos(with[1] * t);
}
/* What braking needs, so that both vanish at its end, less half of what M leaves beside I f''. */
static double brake(double t, const double *with)
{
	const double e = off(t, with), v = off_rate(t, with);
	const double wanted = -with[0] * with[1] * with[1] * sin(with[1] * t);

	return v * v / (2 * e) - 0.5 * (with[2] - wanted);
}

/*
 * I q'' = torque. The bound M is met where I a w^2 sin(w t) = M; then it is off along a parabola,
 * and comes back along another one as soon as half of what M leaves is needed to brake, and is told of.
 */
static void a_motor_slips_and_comes_back_at_located_moments(void **state)
{
	const double inertia = 0.5, max = 3.4;
	struct path path = {.a = 0.8, .w = 3, .speeds = true};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 1.4, 20);
	add_ball(&lab, 1, inertia, 0, path.a * path.w);
	add_motor(&lab, hinge(), max);
	seal(&lab, &path);
	const double slips = asin(max / (inertia * 7.2)) / 3;
	const double with[] = {
		0.8, 3, max / inertia, slips, 0.8 * sin(3 * slips), 2.4 * cos(3 * slips)};
	const double turns = root(off_rate, with, 0.7, slips + 1e-3); /* its rate falls */
	const double back = root(brake, with, turns + 1e-3, 0.87);
	const double length = -2 * off(back, with) / off_rate(back, with);

	while (lab.world->state.frame + 1 < lab.model->frame_count) {
		const double t = lab.world->state.time_s;
		const double left = 1 - (t - back) / length;
		const struct rb_joint_reading r = read_joint(&lab);
		double e = 0;

		if (t > slips && t < back) {
			e = off(t, with);
			assert_near(r.torque.y, -max, 1e-14);
		} else if (t > back && left > 0) {
			e = off(back, with) * left * left;
		}
		assert_near(r.angle, value_of(&path, t) + e, 1e-13);
		frame(&lab);
	}
	balances(&lab);
	assert_int_equal(path.log.count, 2);
	assert_int_equal(path.log.row[0].kind, RB_EVENT_SLIPS);
	assert_int_equal(path.log.row[1].kind, RB_EVENT_DRIVES);
	print_message("slips %.3g, drives %.3g late\n", path.log.row[0].time_s - slips,
	              path.log.row[1].time_s - back - length);
	/* where the torque's rate is 4.3 N m/s, 1e-11 of it is 1e-11 s */
	assert_near(path.log.row[0].time_s, slips, 4e-11);
	assert_near(path.log.row[1].time_s, back + length, 1e-12);
	lab_log_close(&path.log);
	lab_close(&lab);
}

/* A lift whose way has a kink: it is let go there, and caught by the force that it has. */
static void a_kink_lets_go_of_a_lift(void **state)
{
	struct path path = {.kink_s = 1};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 2, 20);
	lab.scene.world.gravity = (rb_vec3){0, 0, -gravity};
	lab_sphere(&lab, 0.1, 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	struct rb_joint_def def = jointed_def(RB_JOINT_SLIDER, 0, -1);

	def.at = (rb_vec3){0, 0, 0};
	def.axis = (rb_vec3){0, 0, 1}; /* the way of the world against the lift: -z */
	add_motor(&lab, def, 50);
	seal(&lab, &path);
	while (lab.world->state.time_s < 1) {
		assert_near(read_joint(&lab).angle, -lab.world->state.time_s, 1e-14);
		frame(&lab);
	}
	to_end(&lab);
	assert_near(lab.world->state.position[2], 0, 1e-13);
	balances(&lab);
	assert_int_equal(path.log.count, 2);
	assert_near(path.log.row[0].time_s, 1, 1e-12);
	assert_int_equal(path.log.row[1].kind, RB_EVENT_DRIVES);
	lab_log_close(&path.log);
	lab_close(&lab);
}

/*
 * At rest, told to turn by 1 rad: M/I for 1/3 rad, then half of it for 2/3 rad, and it stands there
 * against its weight's torque, which is none above the hinge.
 */
static void a_motor_goes_to_where_it_is_told(void **state)
{
	const double ratio = 6, first = sqrt(2.0 / 3 / ratio);
	const double second = 2 * (2.0 / 3) / sqrt(2.0 / 3 * ratio);
	struct path path = {.a = 0};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 2, 20);
	add_ball(&lab, 1, 0.5, 0, 0);
	struct rb_joint_def def = hinge();

	def.motor_speed = 0;
	def.motor_max = 0.5 * ratio;
	jointed_add(&lab, def);
	seal(&lab, &path);
	while (lab.world->state.time_s < 0.25)
		frame(&lab);
	assert_near(read_joint(&lab).angle, 0, 0);
	rb_world_joint_follow(lab.world, 0, 1);
	while (lab.world->state.frame + 1 < lab.model->frame_count) {
		frame(&lab);
		const double s = lab.world->state.time_s - 0.25, left = 1 - (s - first) / second;
		const double wanted = s < first  ? 0.5 * ratio * s * s
		                      : left > 0 ? 1 - 2.0 / 3 * left * left
		                                 : 1;

		assert_near(read_joint(&lab).angle, wanted, 1e-13);
	}
	assert_near(lab.world->state.spin[1], 0, 1e-15);
	balances(&lab);
	assert_int_equal(path.log.count, 1); /* that the brake before had slipped is told, too */
	lab_log_close(&path.log);
	lab_close(&lab);
}

/* Until its wheel has the speed that a motor keeps it exerts what it can, then nothing. */
static void a_frame_within_a_piece_shows_the_torque_of_then(void **state)
{
	struct path path = {.a = 0};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 1, 16);
	add_ball(&lab, 1, 0.5, 0, 0);
	struct rb_joint_def def = hinge();

	def.motor_speed = 2;
	def.motor_max = 2; /* 0.5 s */
	jointed_add(&lab, def);
	seal(&lab, &path);
	while (lab.world->state.frame + 1 < lab.model->frame_count) {
		const double t = lab.world->state.time_s;

		if (t != 0.5)
			assert_near(read_joint(&lab).torque.y, t < 0.5 ? 2 : 0, 1e-13);
		frame(&lab);
	}
	lab_log_close(&path.log);
	lab_close(&lab);
}

/* 0.5 (1 - cos 2 t), which passes a limit of 0.5 at pi/4 and comes back at 3 pi/4. */
static enum rb_status ask_beyond(void *user, int joint, double time_s, double value[2],
                                 struct rb_error *err)
{
	(void)user, (void)joint, (void)err;
	value[0] = 0.5 * (1 - cos(2 * time_s));
	value[1] = sin(2 * time_s);
	return RB_OK;
}

/*
 * A motor that is led beyond a limit presses its joint against it with all that it has, and leaves
 * it to meet what it follows when that comes back. The body is on the axis of its hinge: all of
 * that are couples, which cancel but for rounding of their size, not of the motion's; some torques
 * round where others do not. Friction that stands at the stop is not found to move by that.
 */
static void a_motor_led_beyond_a_limit_presses_and_comes_back(void **state)
{
	static const double max[] = {0.2, 0.5, 0.7, 1, 2, 3, 5, 8, 100, 1000};

	(void)state;
	for (size_t k = 0; k < 4 * sizeof max / sizeof *max; k++) {
		const double torque = max[k / 4], friction = k & 2 ? 0.02 : 0;
		struct path path = {.a = 0};
		const struct rb_world_options options = {.threads = 1, .keep_events = true};
		struct rb_world_hooks hooks = lab_log_open(&path.log);
		struct rb_joint_def def = hinge();
		struct lab lab;

		lab_open_located(&lab, 3, 60);
		add_ball(&lab, 1, 0.016, 0, 0);
		def.limits[0] = -0.5;
		def.limits[1] = 0.5;
		def.restitution = k & 1 ? 0.5 : 0;
		def.friction = friction;
		add_motor(&lab, def, torque);
		hooks.user = &path;
		hooks.transition = hear;
		hooks.collision = NULL;
		hooks.follow = ask_beyond;
		lab_seal_with(&lab, &options, &hooks);
		while (lab.world->state.frame + 1 < lab.model->frame_count) {
			const double t = lab.world->state.time_s, q = read_joint(&lab).angle;

			assert_true(q <= 0.5 + 1e-14 + 1e-16 * torque);
			if (t > 1.6 && t < 2.1) {
				/* their rounding turns it a little, until the next piece */
				assert_near(q, 0.5, 1e-14 + 1e-16 * torque);
				/* motor and stop */
				assert_near(read_joint(&lab).torque.y, 0, 1e-14 * torque);
			} else if (t < 0.785 || t > 2.7) {
				assert_near(q, 0.5 * (1 - cos(2 * t)), 1e-13);
			}
			frame(&lab);
		}
		/* of that turn */
		balances_within(&lab, 1e-13 + 1e-15 * torque * torque);
		lab_log_close(&path.log);
		lab_close(&lab);
	}
}

/* However little it is off and moves: the product of both is not a number above 0. */
static void a_way_back_may_be_as_short_as_numbers_are(void **state)
{
	struct path path = {.a = 0.3, .w = 2, .speeds = true};
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 1, 16);
	add_ball(&lab, 1, 0.5, 0, 0);
	add_motor(&lab, hinge(), 50);
	seal(&lab, &path);
	frame(&lab);
	rb_follow_begin_return(lab.world->located, 0, 0.0625, 1e-200, -1e-198);
	assert_near(rb_follow_end(lab.world->located, 0, 0.0625), 0.0825, 1e-15);
	lab_log_close(&path.log);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pendulum_is_led_with_the_torque_that_it_needs),
		cmocka_unit_test(a_motor_slips_and_comes_back_at_located_moments),
		cmocka_unit_test(a_kink_lets_go_of_a_lift),
		cmocka_unit_test(a_motor_goes_to_where_it_is_told),
		cmocka_unit_test(a_frame_within_a_piece_shows_the_torque_of_then),
		cmocka_unit_test(a_motor_led_beyond_a_limit_presses_and_comes_back),
		cmocka_unit_test(a_way_back_may_be_as_short_as_numbers_are),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
