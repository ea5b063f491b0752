/* SPDX-License-Identifier: MIT */
/* src/event: driven floors and bodies against closed forms. */
#include "worlds.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 origin = {0, 0, 0};
static const double g = 9.81;

static rb_vec3 at(double x, double y, double z)
{
	return (rb_vec3){x, y, z};
}

/* ---- driven ---- */

enum drive {
	DRIVE_LIFT,
	DRIVE_BELT,
	DRIVE_SHAKE,
	DRIVE_TURN,
	DRIVE_TURN_BACK,
	DRIVE_PUSH,
	DRIVE_RISE,
	DRIVE_SHAKE_DOWN,
	DRIVE_START,
	DRIVE_WRAP,
	DRIVE_WHIRL
};
static const double drive_speed = 0.5, shake_size = 0.02, shake_rate = 30, turn_rate = 3;
static const double rise = 3;                             /* m/s^2 */
static const double drive_start = 0.3456, whirl_jerk = 2; /* s, m/s^3 */
static const double pi = 3.14159265358979323846;

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
	case DRIVE_SHAKE_DOWN:
		pose->velocity = at(0, 0, -shake_size * shake_rate * sin(shake_rate * t));
		pose->position = at(0, 0, shake_size * cos(shake_rate * t));
		break;
	case DRIVE_START:
		pose->velocity = at(0, 0, t < drive_start ? 0 : drive_speed);
		pose->position = at(0, 0, drive_speed * fmax(t - drive_start, 0));
		break;
	case DRIVE_RISE:
		pose->velocity = at(0, 0, rise * t);
		pose->position = at(0, 0, 0.5 * rise * t * t);
		break;
	case DRIVE_TURN:
		pose->angular_velocity = at(0, 0, turn_rate);
		pose->orientation = (rb_quat){cos(0.5 * turn_rate * t), 0, 0,
		                              sin(0.5 * turn_rate * t)};
		break;
	case DRIVE_TURN_BACK:
		pose->angular_velocity = at(0, 0, -turn_rate);
		pose->orientation = (rb_quat){cos(0.5 * turn_rate * t), 0, 0,
		                              -sin(0.5 * turn_rate * t)};
		break;
	case DRIVE_WHIRL: { /* acceleration j t (cos w t, sin w t) */
		const double j = whirl_jerk, w = turn_rate, c = cos(w * t), d = sin(w * t);

		pose->position = at(j * (2 / w * d - t * c) / (w * w) - j * t / (w * w),
		                    j * (2 / w * (1 - c) - t * d) / (w * w), 0);
		pose->velocity = at(j * (c / w + t * d) / w - j / (w * w), j * (d / w - t * c) / w,
		                    0);
		break;
	}
	case DRIVE_WRAP: { /* the same, the angle modulo a turn: the quaternion changes its sign */
		const double half = 0.5 * fmod(turn_rate * t, 2 * pi);

		pose->angular_velocity = at(0, 0, turn_rate);
		pose->orientation = (rb_quat){cos(half), 0, 0, sin(half)};
		break;
	}
	}
	return RB_OK;
}

static void open_driven(struct bench *bench, struct driver *driver, double duration)
{
	const rb_vec3 speed[] = {[DRIVE_LIFT] = {0, 0, drive_speed},
	                         [DRIVE_BELT] = {drive_speed, 0, 0},
	                         [DRIVE_SHAKE] = {0, 0, shake_size * shake_rate},
	                         [DRIVE_TURN] = {0, 0, 0},
	                         [DRIVE_PUSH] = {drive_speed, 0, 0},
	                         [DRIVE_RISE] = {0, 0, 0},
	                         [DRIVE_SHAKE_DOWN] = {0, 0, 0},
	                         [DRIVE_START] = {0, 0, 0},
	                         [DRIVE_WRAP] = {0, 0, 0},
	                         [DRIVE_TURN_BACK] = {0, 0, 0},
	                         [DRIVE_WHIRL] = {0, 0, 0}};
	const rb_vec3 place = {0, 0, driver->drive == DRIVE_SHAKE_DOWN ? shake_size : 0};
	struct rb_body_def def = lab_sphere_def(0.2, 1, place, speed[driver->drive]);

	bench_open(bench, duration, 10);
	if (driver->drive != DRIVE_PUSH) {
		def.call = "plane";
		def.shape = (struct rb_shape){.kind = RB_SHAPE_PLANE};
		def.orientation = rb_plane_orientation(up, at((double)NAN, 0, 0));
	} else {
		bench->lab.scene.world.gravity = origin;
	}
	def.mass = (double)NAN;
	def.motion = 0;
	const bool turns = driver->drive == DRIVE_TURN || driver->drive == DRIVE_WRAP ||
	                   driver->drive == DRIVE_TURN_BACK;
	def.motion_turns = turns;
	def.motion_gives_velocity = def.motion_gives_angular_velocity = !driver->differenced;
	if (turns)
		def.angular_velocity = at(
			0, 0, driver->drive == DRIVE_TURN_BACK ? -turn_rate : turn_rate);
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
			assert_near(bench_event(&bench, RB_EVENT_COLLISION, n)->time_s, t, 1e-12);
		}
		assert_near(rb_world_position(bench.lab.world, ball).z, z + drive_speed * 2 + 0.1,
		            1e-12);
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

/* When a floor at A sin(w t + from) first meets what left it at `leaves`. */
static double lands_at(double leaves, double from)
{
	const double a = shake_size, w = shake_rate;
	const double z0 = a * sin(w * leaves + from), v0 = a * w * cos(w * leaves + from);
	double low = leaves + 1e-3, high = leaves + 0.25;

	for (double t = low; t < high; t += 1e-4) { /* the first time below the floor */
		const double s = t - leaves;

		if (z0 + v0 * s - 0.5 * g * s * s < a * sin(w * t + from))
			high = t;
	}
	for (int k = 0; k < 100; k++) {
		const double t = 0.5 * (low + high), s = t - leaves;

		if (z0 + v0 * s - 0.5 * g * s * s < a * sin(w * t + from))
			high = t;
		else
			low = t;
	}
	return low;
}

/* On A sin(w t), A w^2 > g: it leaves where A w^2 sin(w t) = g, flies, and lands without a bounce. */
static void a_ball_leaves_a_shaken_floor_in_time(void **slot)
{
	const double a = shake_size, w = shake_rate;
	const double leaves = asin(g / (a * w * w)) / w;

	(void)slot;
	for (int k = 0; k < 4; k++) {
		struct driver driver = {DRIVE_SHAKE, k % 2};
		struct both both;
		struct bench bench;

		/* pieces are not longer than a frame, so that they end elsewhere */
		open_driven(&bench, &driver, 0.4);
		bench.lab.scene.world.frame_rate = k < 2 ? 10 : 1000;
		lab_surface(&bench.lab, 0, 0);
		lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
		/* it starts with the floor's speed */
		bench.lab.scene.bodies[1].velocity = at(0, 0, a * w);
		seal_driven(&bench, &both, &driver);
		lab_run(&bench.lab);
		assert_near(bench_event(&bench, RB_EVENT_LIFT, 0)->time_s, leaves, 1e-11);
		assert_near(bench_event(&bench, RB_EVENT_COLLISION, 0)->time_s, lands_at(leaves, 0),
		            1e-11);
		assert_near(bench_event(&bench, RB_EVENT_LIFT, 1)->time_s, leaves + 2 * pi / w,
		            1e-11);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_LIFT), 2);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_COLLISION), 2);
		bench_close(&bench);
	}
}

/* At A cos(w t) it is left behind at once, is caught, and leaves where A w^2 cos(w t) = g. */
static void a_ball_is_caught_by_a_shaken_floor_and_leaves_it_in_time(void **slot)
{
	const double a = shake_size, w = shake_rate;
	const double leaves = (2 * pi - acos(g / (a * w * w))) / w;

	(void)slot;
	for (int differenced = 0; differenced < 2; differenced++) {
		struct driver driver = {DRIVE_SHAKE_DOWN, differenced};
		struct both both;
		struct bench bench;

		open_driven(&bench, &driver, leaves + 0.02);
		lab_surface(&bench.lab, 0, 0);
		lab_sphere(&bench.lab, 0.1, 1, at(0, 0, a + 0.1), origin);
		seal_driven(&bench, &both, &driver);
		lab_run(&bench.lab);
		/* without a velocity the very beginning may be a hit by its rounding */
		const int hits = lab_log_count(&bench.log, RB_EVENT_COLLISION);
		assert_true(hits == 1 || (hits == 2 && differenced));
		assert_near(bench_event(&bench, RB_EVENT_COLLISION, hits - 1)->time_s,
		            lands_at(0, 0.5 * pi), 1e-11);
		assert_near(bench_event(&bench, RB_EVENT_LIFT, 0)->time_s, leaves, 1e-11);
		assert_int_equal(lab_log_count(&bench.log, RB_EVENT_LIFT), 1);
		bench_close(&bench);
	}
}

/* A floor that sets out all at once, in the midst of a piece, takes along what lies on it; a bouncing ball is hit. */
static void a_kink_in_a_motion_is_no_obstacle(void **slot)
{
	struct driver driver = {DRIVE_START, true};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, 1);
	lab_surface(&bench.lab, 0, 0);
	const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	assert_near(rb_world_position(bench.lab.world, ball).z,
	            0.1 + drive_speed * (1 - drive_start), 1e-8);
	assert_near(rb_world_velocity(bench.lab.world, ball).z, drive_speed, 1e-8);
	bench_close(&bench);
}

/* Without slip on a table that turns at W, the centre of a solid ball goes round a circle at 2/7 W. */
static void goes_in_circles(struct driver driver, double most)
{
	const double radius = 0.1, x0 = 0.4, rate = 2.0 / 7 * turn_rate, t = 10;
	const rb_vec3 v = {0.1, 0.3, 0};
	struct both both;
	struct bench bench;

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

		assert_vector(rb_world_position(bench.lab.world, ball), wanted, most);
		assert_vector(rb_world_velocity(bench.lab.world, ball),
		              at(v.x * c - v.y * d, v.x * d + v.y * c, 0), most);
		assert_near(rb_world_angular_velocity(bench.lab.world, ball).z, 0.7, most);
	}
	assert_int_equal(bench.log.count, 0);
	bench_close(&bench);
}

static void a_ball_on_a_turntable_goes_in_circles(void **slot)
{
	(void)slot;
	goes_in_circles((struct driver){DRIVE_TURN, false}, 1e-10);
	goes_in_circles((struct driver){DRIVE_WRAP, false}, 1e-10);
}

/* Spins are the derivative of a polynomial there: fewer digits, and no kick where the angle begins again. */
static void an_angle_that_begins_again_does_not_kick(void **slot)
{
	(void)slot;
	goes_in_circles((struct driver){DRIVE_TURN, true}, 1e-9);
	goes_in_circles((struct driver){DRIVE_WRAP, true}, 1e-9);
}

/*
 * Put on a turntable at rest, a ball slips in a spiral whose direction turns ever faster up to its end. Expected: the
 * equations in log of slip and angle for time, with 30 digits (extrapolated midpoint rule), then a circle at 2/7 W.
 */
static void a_ball_put_on_a_turntable_rolls_in_time(void **slot)
{
	static const struct {
		double friction, rolls;
		rb_vec3 position, velocity;
	} cases[] = {{0.3,
	              0.11465449470668045,
	              {-0.03775241283026665, 0.3983760700464611, 0.1},
	              {-0.3414652028969667, -0.03235921099737141, 0}},
	             {0.05,
	              0.80382137525829339,
	              {0.06367107670882559, 0.4025568361473017, 0.1},
	              {-0.3450487166976872, 0.05457520860756479, 0}}};

	(void)slot;
	for (int k = 0; k < 4; k++) {
		const rb_vec3 mirror = {1, k < 2 ? 1 : -1, 1};
		struct driver driver = {k < 2 ? DRIVE_TURN : DRIVE_TURN_BACK, false};
		struct both both;
		struct bench bench;

		open_driven(&bench, &driver, 2);
		bench.lab.scene.world.gravity = at(0, 0, -10);
		lab_surface(&bench.lab, cases[k % 2].friction, 0);
		const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0.4, 0, 0.1), origin);
		seal_driven(&bench, &both, &driver);
		lab_run(&bench.lab);
		const rb_vec3 x = cases[k % 2].position, v = cases[k % 2].velocity;
		assert_near(bench_event(&bench, RB_EVENT_ROLL, 0)->time_s, cases[k % 2].rolls,
		            1e-11);
		assert_vector(rb_world_position(bench.lab.world, ball),
		              at(x.x, mirror.y * x.y, x.z), 1e-11);
		assert_vector(rb_world_velocity(bench.lab.world, ball),
		              at(v.x, mirror.y * v.y, v.z), 1e-11);
		bench_close(&bench);
	}
}

/*
 * On a floor whose acceleration j t turns at w, a ball rolls from rest until 2/7 j t = mu g, and then slips from no slip at
 * all, in a direction that turns. Expected: the slip's equation by two methods (Radau IIA, then DOP853 at 1e-13).
 */
static void a_slip_that_begins_in_a_turn_begins_right(void **slot)
{
	struct driver driver = {DRIVE_WHIRL, false};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, 3);
	bench.lab.scene.world.gravity = at(0, 0, -10);
	lab_surface(&bench.lab, 0.1, 0);
	const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	assert_near(bench_event(&bench, RB_EVENT_SLIDE, 0)->time_s, 1.75, 1e-9);
	/* while slip creeps, its direction is that of balance: 1e-5 of the speed times the time for that */
	assert_vector(rb_world_velocity(bench.lab.world, ball),
	              at(0.3217242574803, 0.2403457257655, 0), 1e-9);
	assert_vector(rb_world_position(bench.lab.world, ball),
	              at(-0.0223023438387, -0.1357314931018, 0.1), 2e-9);
	bench_close(&bench);
}

/* Two floors in one place: what each of them carries is not determined, but where the ball goes is. */
static void a_ball_on_two_rising_floors_rises_with_them(void **slot)
{
	struct driver driver = {DRIVE_RISE, false};
	struct both both;
	struct bench bench;

	(void)slot;
	open_driven(&bench, &driver, 2);
	const struct rb_body_def second = bench.lab.scene.bodies[0];
	lab_add(&bench.lab, &second);
	lab_surface(&bench.lab, 0, 0);
	const int ball = lab_sphere(&bench.lab, 0.1, 1, at(0, 0, 0.1), origin);
	seal_driven(&bench, &both, &driver);
	lab_run(&bench.lab);
	assert_near(rb_world_velocity(bench.lab.world, ball).z, 2 * rise, 1e-12);
	assert_near(rb_world_position(bench.lab.world, ball).z, 0.1 + 2 * rise, 1e-12);
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
		cmocka_unit_test(a_ball_bounces_on_a_rising_floor),
		cmocka_unit_test(a_ball_on_a_belt_comes_to_roll),
		cmocka_unit_test(a_ball_leaves_a_shaken_floor_in_time),
		cmocka_unit_test(a_ball_is_caught_by_a_shaken_floor_and_leaves_it_in_time),
		cmocka_unit_test(a_kink_in_a_motion_is_no_obstacle),
		cmocka_unit_test(a_ball_on_a_turntable_goes_in_circles),
		cmocka_unit_test(a_ball_put_on_a_turntable_rolls_in_time),
		cmocka_unit_test(a_slip_that_begins_in_a_turn_begins_right),
		cmocka_unit_test(an_angle_that_begins_again_does_not_kick),
		cmocka_unit_test(a_ball_on_two_rising_floors_rises_with_them),
		cmocka_unit_test(a_driven_sphere_hits_like_a_wall),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
