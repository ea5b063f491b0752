/* SPDX-License-Identifier: MIT */
/* src/stepped/force, src/stepped/driven_bodies: springs, drag, fields and driven bodies under steps. */
#include "worlds.h"

#include "force/drag.h"
#include "force/spring.h"
#include "geom/distance.h"

#include "base/pack.h"
#include "step/force_stages.h"
#include "method/save.h"
#include "stepped/stepped_state.h"

static const double g = 9.81;
static const rb_vec3 origin = {0, 0, 0}, up = {0, 0, 1};

enum drive { BELT, LIFT, SHAKE, PADDLE, FAN };
static const double speed = 1, size = 0.05, rate = 12, turn_rate = 4;

static enum rb_status motion(void *user, int id, double t, struct rb_driven_pose *pose,
                             struct rb_error *err)
{
	const enum drive *drive = user;

	(void)id, (void)err;
	if (*drive == BELT) {
		pose->position = (rb_vec3){speed * t, 0, 0};
	} else if (*drive == LIFT) {
		pose->position = (rb_vec3){0, 0, 2 * t};
	} else if (*drive == SHAKE) {
		pose->position = (rb_vec3){0, 0, size * sin(rate * t)};
		pose->velocity = (rb_vec3){0, 0, size * rate * cos(rate * t)};
		pose->has_velocity = true;
	} else if (*drive == FAN) {
		/* planes about one axis, solid behind, as the blades of a fan */
		const rb_vec3 turn = {0, 0, 0.5 * id + turn_rate * t};

		pose->position = origin;
		pose->orientation = rb_quat_multiply(
			rb_quat_from_turn(turn),
			rb_plane_orientation((rb_vec3){0, 1, 0}, (rb_vec3){(double)NAN, 0, 0}));
	} else {
		pose->position = origin;
		pose->orientation = rb_quat_from_turn((rb_vec3){0, 0, turn_rate * t});
	}
	return RB_OK;
}

/* A pull towards the origin, N, of a body of 1 kg that swings with 10 rad/s. */
static enum rb_status field(void *user, int id, double t, const rb_vec3 at[2], rb_vec3 force[2],
                            struct rb_error *err)
{
	(void)user, (void)id, (void)t, (void)err;
	*force = rb_vec3_scale(-100, at[0]);
	return RB_OK;
}

static void open_stepped(struct lab *lab, double duration, double time_step)
{
	lab_open(lab, duration, 10);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = time_step;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
}

static void seal(struct lab *lab, enum drive *drive, int threads)
{
	const struct rb_world_hooks hooks = {.user = drive, .motion = motion, .field = field};
	const struct rb_world_options options = {.threads = threads};

	lab_seal_with(lab, &options, &hooks);
}

static int add_box(struct lab *lab, rb_vec3 edges, rb_vec3 position)
{
	struct rb_body_def def = lab_box_def(edges, 1, position);

	return lab_add(lab, &def);
}

static int add_driven(struct lab *lab, enum rb_shape_kind kind, const double *edges, bool turns)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = kind == RB_SHAPE_BOX ? "box" : "plane";
	def.shape.kind = kind;
	for (int k = 0; edges && k < 3; k++)
		def.shape.size[k] = edges[k];
	if (kind != RB_SHAPE_BOX) {
		def.shape.radius = 0;
		def.orientation = rb_plane_orientation(up, (rb_vec3){(double)NAN, 0, 0});
	}
	def.mass = (double)NAN;
	def.motion = 0;
	def.motion_turns = turns;
	return lab_add(lab, &def);
}

static void add_spring(struct lab *lab, int a, int b, double stiffness, double rest)
{
	struct rb_spring_def def = rb_spring_def_default();

	def.a = a;
	def.b = b;
	def.stiffness = stiffness;
	def.rest_length_m = rest;
	assert_int_equal(rb_scene_add_spring(&lab->scene, &def, &lab->error), RB_OK);
}

static int add_hook(struct lab *lab, rb_vec3 at)
{
	struct rb_body_def def = lab_sphere_def(0.01, 1, at, origin);

	def.is_static = true;
	return lab_add(lab, &def);
}

/* ---- driven bodies ---- */

/* Where a box is after 1 s on a belt, over what Coulomb says: mu g until it is as fast, then with it. */
static double miss_on_belt(enum rb_shape_kind kind, bool ball, double time_step)
{
	static const double edges[3] = {20, 20, 0.5};
	const double mu = 0.3, top = kind == RB_SHAPE_BOX ? 0.25 : 0;
	enum drive drive = BELT;
	struct lab lab;
	int rider;

	open_stepped(&lab, 1, time_step);
	lab_surface(&lab, mu, 0);
	add_driven(&lab, kind, kind == RB_SHAPE_PLANE ? NULL : edges, false);
	if (ball)
		rider = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, top + 0.1}, origin);
	else
		rider = add_box(&lab, (rb_vec3){0.2, 0.2, 0.2}, (rb_vec3){0, 0, top + 0.1});
	seal(&lab, &drive, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	const rb_vec3 at = rb_world_position(lab.world, rider);
	const rb_vec3 v = rb_world_velocity(lab.world, rider);
	/* a ball slides until it rolls, at 2/7 of the speed */
	const double end = ball ? 2.0 / 7 * speed : speed, slides = end / (mu * g);
	const double x = 0.5 * mu * g * slides * slides + end * (1 - slides);
	assert_near(v.x, end, 1e-6);
	assert_near(at.z, top + 0.1, 1e-6);
	lab_close(&lab);
	return fabs(at.x - x);
}

static void a_belt_carries_along_at_mu_g_and_then_at_its_speed(void **state)
{
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_PLANE, RB_SHAPE_RECTANGLE,
	                                           RB_SHAPE_BOX};

	(void)state;
	for (int k = 0; k < 3; k++)
		for (int ball = 0; ball < 2; ball++)
			for (double h = 0.01; h > 1e-3; h *= 0.25)
				assert_near(miss_on_belt(kinds[k], ball, h), 0, speed * h);
}

/* The floor does work: seen from it, a ball has e times its speed after an impact, though that is more energy. */
static void a_ball_bounces_on_a_floor_that_rises(void **state)
{
	const double e = 0.8, time_step = 1e-3, duration = 0.4;
	enum drive drive = LIFT;
	struct lab lab;

	(void)state;
	open_stepped(&lab, duration, time_step);
	lab_surface(&lab, 0.3, e);
	add_driven(&lab, RB_SHAPE_PLANE, NULL, false);
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 1.1}, origin);
	seal(&lab, &drive, 1);
	lab_run(&lab);
	/* from 1 m at 2 m/s */
	const double fast = sqrt(4 + 2 * g), met = (fast - 2) / g;
	assert_near(rb_world_velocity(lab.world, ball).z, 2 + e * fast - g * (duration - met),
	            2 * g * time_step);
	assert_int_equal(rb_world_totals(lab.world).collisions, 1);
	lab_close(&lab);
}

static uint64_t shaken(int threads, enum rb_rollback_kind rollback)
{
	enum drive drive = SHAKE;
	struct lab lab;
	double highest = 0;

	open_stepped(&lab, 1, 1.0 / 120);
	lab.scene.world.rollback = rollback;
	lab_surface(&lab, 0.5, 0.3);
	for (int k = 0; k < 12; k++) {
		const rb_vec3 at = {1.03 * (k % 2), 1.04 * (k / 2 % 2), 0.55 + 1.05 * (k / 4)};

		if (k % 3)
			add_box(&lab, (rb_vec3){1, 1, 1}, at);
		else
			lab_sphere(&lab, 0.5, 1, at, origin);
	}
	const int floor = add_driven(&lab, RB_SHAPE_PLANE, NULL, false);
	seal(&lab, &drive, threads);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		const double before = rb_world_position(lab.world, floor).z;

		lab_step(&lab);
		assert_near(rb_world_position(lab.world, floor).z,
		            size * sin(rate * rb_world_time(lab.world)), 1e-12);
		assert_near(rb_world_velocity(lab.world, floor).z,
		            size * rate * cos(rate * rb_world_time(lab.world)), 1e-9);
		assert_true(rb_world_position(lab.world, floor).z != before);
		for (int id = 0; id < 12; id++) {
			const double z = rb_world_position(lab.world, id).z -
			                 rb_world_position(lab.world, floor).z;

			assert_true(z > 0.5 - lab.model->tolerance_m);
			highest = fmax(highest, z);
		}
	}
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	/* at 7.2 m/s^2 it is shaken, but not thrown up */
	assert_true(highest < 4);
	const uint64_t hash = rb_world_hash(lab.world);
	lab_close(&lab);
	return hash;
}

/* Each up at a speed, and round at a rate, of its own; of every other one both are given. */
static enum rb_status own_motion(void *user, int id, double t, struct rb_driven_pose *pose,
                                 struct rb_error *err)
{
	(void)user, (void)err;
	pose->position = (rb_vec3){5.0 * id, 0, (1 + id) * t};
	pose->orientation = rb_quat_from_turn((rb_vec3){0, 0, (0.5 + id) * t});
	pose->velocity = (rb_vec3){0, 0, 1 + id};
	pose->angular_velocity = (rb_vec3){0, 0, 0.5 + id};
	pose->has_velocity = pose->has_angular_velocity = id % 2;
	return RB_OK;
}

static void each_driven_body_goes_its_own_way(void **state)
{
	const double edges[3] = {1, 1, 1};
	const struct rb_world_hooks hooks = {.motion = own_motion};
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;

	(void)state;
	open_stepped(&lab, 0.5, 0.01);
	lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 5, 0}, origin);
	for (int id = 1; id < 4; id++) {
		assert_int_equal(add_driven(&lab, RB_SHAPE_BOX, edges, true), id);
		struct rb_body_def *const def = &lab.scene.bodies[id];
		def->position = (rb_vec3){5.0 * id, 0, 0};
		def->motion_gives_velocity = def->motion_gives_angular_velocity = id % 2;
	}
	lab_seal_with(&lab, &options, &hooks);
	for (int frame = 1; frame <= 5; frame++) {
		lab_step(&lab);
		const double t = rb_world_time(lab.world);
		for (int id = 1; id < 4; id++) {
			const rb_vec3 there = {5.0 * id, 0, (1 + id) * t};
			const rb_quat q = rb_world_orientation(lab.world, id);

			assert_vector(rb_world_position(lab.world, id), there, 1e-13);
			assert_vector(rb_world_velocity(lab.world, id), ((rb_vec3){0, 0, 1 + id}),
			              1e-11);
			assert_vector(rb_world_angular_velocity(lab.world, id),
			              ((rb_vec3){0, 0, 0.5 + id}), 1e-11);
			assert_near(fabs(q.z), fabs(sin(0.5 * (0.5 + id) * t)), 1e-13);
		}
	}
	lab_close(&lab);
}

static void a_pile_on_a_shaken_floor_keeps_the_tolerance(void **state)
{
	(void)state;
	const uint64_t one = shaken(1, RB_ROLLBACK_SELECTIVE);

	assert_true(shaken(3, RB_ROLLBACK_SELECTIVE) == one);
	(void)shaken(1, RB_ROLLBACK_GLOBAL);
}

/*
 * Planes without end that turn about an axis near which nothing moves: what they cannot reach yet is no candidate, and
 * nothing is missed that they turn to. The overlap is measured here, as that of a pair that is missed would not be.
 */
static void planes_meet_all_that_they_turn_to(void **state)
{
	enum { PLANES = 2, BALLS = 32 };
	enum drive drive = FAN;
	struct lab lab;
	size_t least = SIZE_MAX;

	(void)state;
	open_stepped(&lab, 0.5, 1.0 / 240);
	lab.scene.world.gravity = origin;
	lab_surface(&lab, 0, 0);
	for (int k = 0; k < PLANES; k++) {
		struct rb_driven_pose pose;

		add_driven(&lab, RB_SHAPE_PLANE, NULL, true);
		assert_int_equal(motion(&drive, k, 0, &pose, NULL), RB_OK);
		lab.scene.bodies[k].orientation = pose.orientation;
	}
	for (int k = 0; k < BALLS; k++) {
		const double r = 1 + 0.5 * (k % 4), angle = 1 + 0.25 * floor(k / 4.0);

		lab_sphere(&lab, 0.05, 1, (rb_vec3){r * cos(angle), r * sin(angle), 0.3 * (k % 4)},
		           origin);
	}
	seal(&lab, &drive, 1);
	while (rb_world_time(lab.world) < 0.5 - 1e-9) {
		lab_step(&lab);
		const size_t pairs = lab.world->stepped->candidates.pair_count;
		least = pairs < least ? pairs : least;
		for (int k = 0; k < PLANES * BALLS; k++) {
			const int plane = k % PLANES, ball = PLANES + k / PLANES;
			const rb_vec3 n = rb_plane_normal(rb_world_orientation(lab.world, plane));
			const double gap = rb_vec3_dot(rb_world_position(lab.world, ball), n) -
			                   0.05;

			assert_true(gap >= -1.01 * lab.model->tolerance_m);
		}
	}
	assert_true(rb_world_totals(lab.world).collisions > BALLS / 2);
	assert_true(least < PLANES * BALLS / 2);
	lab_close(&lab);
}

static void a_paddle_that_turns_sweeps_a_ball_along(void **state)
{
	static const double edges[3] = {2, 0.2, 0.4};
	enum drive drive = PADDLE;
	struct lab lab;

	(void)state;
	open_stepped(&lab, 0.3, 1.0 / 240);
	lab.scene.world.gravity = origin;
	lab_surface(&lab, 0, 0);
	const int paddle = add_driven(&lab, RB_SHAPE_BOX, edges, true);
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0.8, 0.5, 0}, origin);
	seal(&lab, &drive, 1);
	lab_run(&lab);
	assert_true(rb_world_totals(lab.world).max_penetration <= lab.model->tolerance_m);
	assert_vector(rb_world_angular_velocity(lab.world, paddle), ((rb_vec3){0, 0, turn_rate}),
	              1e-9);
	/* it has the speed of the place where it was met, at least */
	assert_true(rb_vec3_length(rb_world_velocity(lab.world, ball)) > 0.8 * turn_rate);
	lab_close(&lab);
}

/* ---- springs ---- */

/* How far a box on a spring is from its cosine after nine tenths of a second, m. */
static double miss_on_spring(double time_step)
{
	const double k = 100;
	struct lab lab;

	open_stepped(&lab, 0.9, time_step);
	const int hook = add_hook(&lab, (rb_vec3){0, 0, 2});
	const int box = add_box(&lab, (rb_vec3){0.2, 0.2, 0.2}, origin);
	add_spring(&lab, hook, box, k, 2);
	seal(&lab, NULL, 1);
	lab_run(&lab);
	const double z = rb_world_position(lab.world, box).z;
	lab_close(&lab);
	return fabs(z + g / k * (1 - cos(sqrt(k) * 0.9)));
}

static void a_box_on_a_spring_swings_to_first_order(void **state)
{
	(void)state;
	const double coarse = miss_on_spring(1e-3), fine = miss_on_spring(2.5e-4);

	assert_true(coarse < 1e-3);
	assert_true(fine < 0.3 * coarse);
}

static void a_spring_that_is_resolved_keeps_its_oscillation(void **state)
{
	struct lab lab;
	double lowest = 0;

	(void)state;
	open_stepped(&lab, 60, 0.02);
	lab.scene.world.gravity = origin;
	const int hook = add_hook(&lab, (rb_vec3){0, 0, 2});
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0.1}, origin);
	add_spring(&lab, hook, ball, 100, 2);
	seal(&lab, NULL, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		if (rb_world_time(lab.world) > 50)
			lowest = fmin(lowest, rb_world_position(lab.world, ball).z);
	}
	assert_near(lowest, -0.1, 0.02);
	lab_close(&lab);
}

/* Springs of 1e9 N/m on 1 kg, three at each ball: at 1/60 s far beyond what a step resolves. */
static double rest_of(const struct rb_model *model, int k)
{
	const struct rb_elements *springs = rb_model_elements(model, &rb_force_spring);
	const struct rb_spring_def *spring = rb_elements_row(springs, k);

	return spring->rest_length_m;
}

static void stiff_springs_hold_and_do_not_explode(void **state)
{
	struct lab lab;
	int ball[3];

	(void)state;
	open_stepped(&lab, 20, 1.0 / 60);
	for (int k = 0; k < 3; k++) {
		ball[k] = lab_sphere(&lab, 0.1, 1, (rb_vec3){cos(2.1 * k), sin(2.1 * k), 0},
		                     (rb_vec3){sin(3.0 * k), 1, 0});
		const int hook = add_hook(&lab, (rb_vec3){2 * cos(2.1 * k), 2 * sin(2.1 * k), 2});
		add_spring(&lab, hook, ball[k], 1e9, (double)NAN);
	}
	for (int k = 0; k < 3; k++)
		add_spring(&lab, ball[k], ball[(k + 1) % 3], 1e9, (double)NAN);
	seal(&lab, NULL, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		for (int k = 0; k < 3; k++) {
			assert_true(rb_vec3_length(rb_world_position(lab.world, ball[k])) < 5);
			assert_true(rb_vec3_length(rb_world_velocity(lab.world, ball[k])) < 20);
		}
	}
	for (int k = 0; k < 3; k++) {
		const rb_vec3 d = rb_vec3_sub(rb_world_position(lab.world, ball[k]),
		                              rb_world_position(lab.world, ball[(k + 1) % 3]));
		const double rest = rest_of(lab.model, 3 + k);

		assert_near(rb_vec3_length(d), rest, 0.01 * rest);
	}
	lab_close(&lab);
}

/* ---- drag and fields ---- */

static double fall_speed(double linear, double quadratic)
{
	const struct rb_drag_def drag = {.linear = linear, .quadratic = quadratic};
	struct lab lab;

	open_stepped(&lab, 20, 1.0 / 30);
	const int ball = lab_sphere(&lab, 0.1, 2, origin, origin);
	assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
	seal(&lab, NULL, 1);
	lab_run(&lab);
	const double v = -rb_world_velocity(lab.world, ball).z;
	lab_close(&lab);
	return v;
}

static void drag_has_its_terminal_speed_at_any_step(void **state)
{
	(void)state;
	assert_near(fall_speed(4, 0), 2 * g / 4, 1e-9);
	assert_near(fall_speed(0, 0.5), sqrt(2 * g / 0.5), 1e-9);
	/* so strong that an explicit step would turn the motion round */
	assert_near(fall_speed(1000, 0), 2 * g / 1000, 1e-9);
	assert_near(fall_speed(0, 1e6), sqrt(2 * g / 1e6), 1e-9);
}

/* Thrown up and caught by drag that a step does not resolve, or hardly does: kinetic and potential energy only fall. */
static void drag_and_gravity_give_no_energy(void **state)
{
	const double linear[] = {0.01, 1, 60, 4e3, 4e7, 0}, quadratic[] = {0, 0, 0, 0, 0, 1e4};

	(void)state;
	for (int k = 0; k < 6; k++)
		for (int rise = 0; rise < 3; rise++) {
			const struct rb_drag_def drag = {.linear = linear[k],
			                                 .quadratic = quadratic[k]};
			const rb_vec3 thrown = {0.3, 0, 4 * rise};
			struct lab lab;

			open_stepped(&lab, 1, 1.0 / 30);
			const int ball = lab_sphere(&lab, 0.1, 2, origin, thrown);
			assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
			seal(&lab, NULL, 1);
			double before = HUGE_VAL;
			for (int frame = 0; frame < 10; frame++) {
				assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
				const rb_vec3 v = rb_world_velocity(lab.world, ball);
				const double energy = 0.5 * rb_vec3_dot(v, v) +
				                      g * rb_world_position(lab.world, ball).z;

				assert_true(energy <= before + 1e-12);
				before = energy;
			}
			lab_close(&lab);
		}
}

static double miss_in_field(double time_step)
{
	const struct rb_field_def def = {.function = 0};
	struct lab lab;

	open_stepped(&lab, 0.9, time_step);
	lab.scene.world.gravity = origin;
	const int ball = lab_sphere(&lab, 0.1, 1, (rb_vec3){1, 0, 0}, origin);
	assert_int_equal(rb_scene_add_field(&lab.scene, &def, &lab.error), RB_OK);
	seal(&lab, NULL, 1);
	lab_run(&lab);
	const double x = rb_world_position(lab.world, ball).x;
	lab_close(&lab);
	return fabs(x - cos(10 * 0.9));
}

static void a_field_acts_to_first_order(void **state)
{
	(void)state;
	const double coarse = miss_in_field(1e-3), fine = miss_in_field(2.5e-4);

	assert_true(coarse < 1e-2);
	assert_true(fine < 0.3 * coarse);
}

/* ---- all of it ---- */

static void lay_all(struct lab *lab)
{
	const struct rb_drag_def drag = {.linear = 0.1};

	open_stepped(lab, 1, 1.0 / 120);
	lab_surface(lab, 0.5, 0.4);
	add_driven(lab, RB_SHAPE_PLANE, NULL, false);
	for (int k = 0; k < 8; k++)
		lab_sphere(lab, 0.5, 1, (rb_vec3){1.1 * (k % 2), 0, 0.7 + 1.1 * (k / 2)}, origin);
	const int hook = add_hook(lab, (rb_vec3){0, 3, 8});
	add_spring(lab, hook, 8, 50, (double)NAN);
	add_spring(lab, 5, 6, 1e7, (double)NAN);
	assert_int_equal(rb_scene_add_drag(&lab->scene, &drag, &lab->error), RB_OK);
}

static void a_restored_world_goes_on_in_the_same_bits(void **state)
{
	enum drive drive = SHAKE;
	struct rb_pack saved = {0};
	struct lab lab, again;

	(void)state;
	lay_all(&lab);
	seal(&lab, &drive, 1);
	for (int k = 0; k < 5; k++)
		lab_step(&lab);
	assert_int_equal(rb_world_pack(lab.world, &saved, &lab.error), RB_OK);
	lab_run(&lab);
	lay_all(&again);
	seal(&again, &drive, 2);
	struct rb_pack pack = {.loading = true, .bytes = saved.bytes, .size = saved.size};
	assert_int_equal(rb_world_pack(again.world, &pack, &again.error), RB_OK);
	lab_run(&again);
	assert_true(rb_world_hash(again.world) == rb_world_hash(lab.world));
	assert_true(rb_world_totals(lab.world).collisions > 0);
	lab_close(&again);
	lab_close(&lab);
	rb_pack_release(&saved);
}

/* ---- arms, potentials, bounds ---- */

/*
 * A damper from far away along y to a point r off a box's centre along x, in small motion: its end's speed u falls as
 * exp(-c y t), y = 1/m + r^2/I, and takes c y^-1 u of momentum. Steps resolve the first damper, and not the second, which
 * stops the end altogether.
 */
static void a_damper_at_an_arm_slows_spin_and_body(void **state)
{
	const double spin = 1e-3, r = 0.1, inertia = 0.04 / 6, yield = 1 + r * r / inertia;
	const double damping[2] = {0.5, 5000};

	(void)state;
	for (int k = 0; k < 4; k++) {
		const bool swapped = k & 1;
		const double c = damping[k / 2];
		struct rb_spring_def def = rb_spring_def_default();
		struct lab lab;

		open_stepped(&lab, 0.2, 1e-3);
		lab.scene.world.gravity = origin;
		const int hook = add_hook(&lab, (rb_vec3){r, 5, 0});
		struct rb_body_def box = lab_sphere_def(0, 1, origin, origin);
		box.call = "box";
		box.shape.kind = RB_SHAPE_BOX;
		rb_vec3_to(box.shape.size, (rb_vec3){0.2, 0.2, 0.2});
		box.angular_velocity = (rb_vec3){0, 0, spin};
		const int body = lab_add(&lab, &box);
		def.a = swapped ? body : hook;
		def.b = swapped ? hook : body;
		*(swapped ? &def.at_a : &def.at_b) = (rb_vec3){r, 0, 0};
		def.stiffness = 0;
		def.damping = c;
		assert_int_equal(rb_scene_add_spring(&lab.scene, &def, &lab.error), RB_OK);
		seal(&lab, NULL, 1);
		lab_run(&lab);
		const double t = rb_world_time(lab.world);
		const double taken = spin * r * (1 - exp(-c * yield * t)) / yield;
		/* first order in c y dt = 1.25e-3, and in the angle of 2e-4 */
		const rb_vec3 v = rb_world_velocity(lab.world, body);
		const rb_vec3 w = rb_world_angular_velocity(lab.world, body);
		assert_near(v.y, -taken, 4e-3 * taken);
		assert_near(w.z, spin - r * taken / inertia, 4e-3 * r * taken / inertia);
		lab_close(&lab);
	}
}

static void the_potential_of_uniform_forces_is_theirs(void **state)
{
	const rb_vec3 gravity = {1, 2, -9}, force = {0.5, -3, 4};
	struct lab lab;
	double wanted = 0;

	(void)state;
	open_stepped(&lab, 1, 0.1);
	lab.scene.world.gravity = gravity;
	lab.scene.world.gravity_force = force;
	const int ball[2] = {lab_sphere(&lab, 0.1, 2, (rb_vec3){1, 2, 3}, origin),
	                     lab_sphere(&lab, 0.1, 5, (rb_vec3){-4, 1, -2}, (rb_vec3){1, 0, 2})};
	seal(&lab, NULL, 1);
	lab_step(&lab);
	for (int k = 0; k < 2; k++) {
		const rb_vec3 at = rb_world_position(lab.world, ball[k]);

		wanted -= (k ? 5 : 2) * rb_vec3_dot(gravity, at) + rb_vec3_dot(force, at);
	}
	/* a sum of twelve products, the largest below 100 */
	assert_near(rb_world_totals(lab.world).potential_energy, wanted, 1e-12);
	lab_close(&lab);
}

static enum rb_status push_nothing(void *user, struct rb_world *world, double time_s, double dt_s,
                                   struct rb_error *err)
{
	(void)user, (void)world, (void)time_s, (void)dt_s, (void)err;
	return RB_OK;
}

/* Were one missing, groups of the classic method could meet unseen. */
static void the_bound_on_forces_has_all_of_them(void **state)
{
	struct rb_force_def force = {.vector = {0, 6, 8}, .duration_s = (double)INFINITY};
	const struct rb_world_hooks hooks = {.step = push_nothing};
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	lab.scene.world.method = RB_METHOD_CLASSIC;
	lab.scene.world.time_step_s = 0.1;
	lab.scene.world.gravity = (rb_vec3){0, 3, 4};
	lab.scene.world.gravity_force = (rb_vec3){0, 0, -20};
	const int ball = lab_sphere(&lab, 0.1, 4, origin, origin);
	force.point.x = (double)NAN;
	assert_int_equal(rb_scene_add_force(&lab.scene, &force, &lab.error), RB_OK);
	lab_seal_with(&lab, &options, &hooks);
	assert_near(rb_forces_bound(lab.world, 0), 5 + 30.0 / 4, 1e-14);
	rb_world_apply_force(lab.world, ball, (rb_vec3){50, 0, 0}, origin);
	assert_near(rb_forces_bound(lab.world, 0), 5 + 80.0 / 4, 1e-14);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_belt_carries_along_at_mu_g_and_then_at_its_speed),
		cmocka_unit_test(a_ball_bounces_on_a_floor_that_rises),
		cmocka_unit_test(each_driven_body_goes_its_own_way),
		cmocka_unit_test(a_pile_on_a_shaken_floor_keeps_the_tolerance),
		cmocka_unit_test(planes_meet_all_that_they_turn_to),
		cmocka_unit_test(a_paddle_that_turns_sweeps_a_ball_along),
		cmocka_unit_test(a_box_on_a_spring_swings_to_first_order),
		cmocka_unit_test(a_spring_that_is_resolved_keeps_its_oscillation),
		cmocka_unit_test(stiff_springs_hold_and_do_not_explode),
		cmocka_unit_test(drag_has_its_terminal_speed_at_any_step),
		cmocka_unit_test(drag_and_gravity_give_no_energy),
		cmocka_unit_test(a_field_acts_to_first_order),
		cmocka_unit_test(a_restored_world_goes_on_in_the_same_bits),
		cmocka_unit_test(a_damper_at_an_arm_slows_spin_and_body),
		cmocka_unit_test(the_potential_of_uniform_forces_is_theirs),
		cmocka_unit_test(the_bound_on_forces_has_all_of_them),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
