/* SPDX-License-Identifier: MIT */
/* Impacts without restitution by steps: what they leave and what is told, against the located method. */
#include <stdio.h>
#include "solids.h"
#include "worlds.h"

#include "world/world.h"

enum { SERIES = 16 };

static double draw(uint64_t series, int number, double low, double high)
{
	return solids_random(7000 + series, (uint64_t)number, low, high);
}

static int throw(struct lab * lab, uint64_t series, int number)
{
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_BOX, RB_SHAPE_CAPSULE,
	                                           RB_SHAPE_CYLINDER, RB_SHAPE_BOX};
	struct rb_body_def def = rb_body_def_default();
	const double side = number == 0 ? -1 : 1;
	const int of = 20 * number;

	def.call = "body";
	def.shape.kind = kinds[(series + 2 * (uint64_t)number) % 4];
	def.shape.radius = draw(series, of + 4, 0.1, 0.3);
	for (int k = 0; k < 3; k++)
		def.shape.size[k] = draw(series, of + 5 + k, 0.2, 0.8);
	def.mass = draw(series, of + 8, 0.5, 3);
	def.position = (rb_vec3){0.9 * side, draw(series, of + 9, -0.1, 0.1), 0};
	def.orientation = solids_turn(7000 + 2 * series + (uint64_t)number);
	def.velocity = (rb_vec3){-side * draw(series, of + 10, 1, 3),
	                         draw(series, of + 11, -0.3, 0.3),
	                         draw(series, of + 12, -0.3, 0.3)};
	def.angular_velocity = (rb_vec3){draw(series, of + 13, -4, 4), draw(series, of + 14, -4, 4),
	                                 draw(series, of + 15, -4, 4)};
	return lab_add(lab, &def);
}

/* What a throw has come to. */
struct outcome {
	rb_vec3 velocity[2], impulse; /* the sum of all that have been told */
	double first_s;
};

/* Until `end_s`, m/s and N s. */
static struct outcome meet(uint64_t series, double friction, double end_s, double time_step)
{
	struct outcome outcome = {.first_s = end_s};
	struct lab lab;
	struct lab_log log;
	const struct rb_world_options options = {.threads = 1, .keep_events = true};
	const struct rb_world_hooks hooks = lab_log_open(&log);

	lab_open(&lab, end_s, 1 / end_s);
	if (time_step > 0) {
		lab.scene.world.method = RB_METHOD_STEPPED;
		lab.scene.world.time_step_s = time_step;
	} else {
		lab.scene.world.method = RB_METHOD_LOCATED;
	}
	lab_surface(&lab, friction, 0);
	const int of[2] = {throw(&lab, series, 0), throw(&lab, series, 1)};
	lab_seal_with(&lab, &options, &hooks);
	lab_run(&lab);
	for (int e = 0; e < 2; e++)
		outcome.velocity[e] = rb_world_velocity(lab.world, of[e]);
	for (int k = 0; k < log.count; k++)
		outcome.impulse = rb_vec3_add(outcome.impulse, log.row[k].impulse);
	if (log.count > 0)
		outcome.first_s = log.row[0].time_s;
	lab_log_close(&log);
	lab_close(&lab);
	return outcome;
}

struct errors {
	double velocity, impulse; /* shares of the impulse */
};

static struct errors errors_of(uint64_t series, double friction, double time_step)
{
	const double first_s = meet(series, friction, 1, 0).first_s;

	if (!(first_s < 0.9))
		return (struct errors){0, 0};
	const double end_s = first_s + 0.01;
	const struct outcome right = meet(series, friction, end_s, 0);
	const struct outcome found = meet(series, friction, end_s, time_step);
	const double size = rb_vec3_length(right.impulse);
	struct errors errors = {
		.impulse = rb_vec3_length(rb_vec3_sub(found.impulse, right.impulse)) / size};
	for (int e = 0; e < 2; e++)
		errors.velocity = fmax(
			errors.velocity,
			draw(series, 20 * e + 8, 0.5, 3) / size *
				rb_vec3_length(rb_vec3_sub(found.velocity[e], right.velocity[e])));
	return errors;
}

/*
 * Bodies are seen as they stand when a step begins: turned by at most the angle of a step, by 7 rad/s
 * at most, from where they meet. What meets in the middle of a step and goes on in it with the new
 * spin, and not for all of it, is off by a few of these angles (eight at most), and has one impulse.
 */
static void assert_whole(double friction)
{
	const double time_step = 1.0 / 3840, most = 8 * 7 * time_step;

	for (uint64_t series = 0; series < SERIES; series++) {
		const struct errors errors = errors_of(series, friction, time_step);

		if (!(errors.velocity <= most && errors.impulse <= most))
			fail_msg("series %d: velocities off by %.2g, impulses told by %.2g",
			         (int)series, errors.velocity, errors.impulse);
	}
}

static void what_meets_with_friction_goes_on_with_its_new_spin(void **state)
{
	(void)state;
	assert_whole(0.5);
}

static void what_meets_without_friction_is_told_of_all_of_its_impulse(void **state)
{
	(void)state;
	assert_whole(0);
}

/*
 * A ball flies up against a capsule that lies on the floor: what the impact has stopped, gravity would
 * part. That is no second impact at the same moment, and those that follow in the step are resolved
 * in their time.
 */
static void what_forces_part_again_has_met_once(void **state)
{
	const double gravity = 10, up = 3, across = 4, met_s = 0.023, then_s = 0.028, gap = 0.056;
	const double height = 0.3 - up * met_s + 0.5 * gravity * met_s * met_s;
	struct lab lab;
	struct lab_log log;
	const struct rb_world_options options = {.threads = 1, .keep_events = true};
	const struct rb_world_hooks hooks = lab_log_open(&log);
	const struct rb_event *last = NULL;

	(void)state;
	lab_open(&lab, 0.03, 1 / 0.03);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 0.01;
	lab.scene.world.gravity = (rb_vec3){0, 0, -gravity};
	lab_surface(&lab, 0.5, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	struct rb_body_def lies = lab_sphere_def(0.5, 1, (rb_vec3){0, 0, 0.5}, (rb_vec3){0, 0, 0});
	lies.call = "capsule";
	lies.shape.kind = RB_SHAPE_CAPSULE;
	lies.shape.size[2] = 0.4;
	lies.orientation = rb_quat_turned(rb_quat_identity, (rb_vec3){acos(0), 0, 0});
	lab_add(&lab, &lies);
	/* it meets that 0.2 m below its middle */
	lab_sphere(&lab, 0.1, 0.1, (rb_vec3){-sqrt(0.36 - 0.04) - across * met_s, 0, height},
	           (rb_vec3){across, 0, up});
	const int a = lab_sphere(&lab, 0.1, 1, (rb_vec3){5, 0, 2}, (rb_vec3){1, 0, 0});
	const int b = lab_sphere(&lab, 0.1, 1, (rb_vec3){5.2 + gap, 0, 2}, (rb_vec3){-1, 0, 0});
	lab_seal_with(&lab, &options, &hooks);
	lab_run(&lab);
	for (int k = 0; k < log.count; k++)
		if (log.row[k].a == a && log.row[k].b == b)
			last = &log.row[k];
	assert_non_null(last);
	assert_true(fabs(last->time_s - then_s) <= 1e-12);
	lab_log_close(&log);
	lab_close(&lab);
}

/*
 * What is round turns about its axis by three radians in the step in which it meets a box, 0.02 m
 * beside the middle, without friction: that spin stays, since the impulse goes through the axis, and
 * all else is as the located method has it.
 */
static void what_is_round_meets_with_its_side_however_it_spins(void **state)
{
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_SPHERE, RB_SHAPE_CAPSULE,
	                                           RB_SHAPE_CYLINDER};
	const double time_step = 0.1, spin = 30, speed = 2, met_s = 0.04, radius = 0.1;
	const struct rb_world_options options = {.threads = 1, .keep_events = true};

	(void)state;
	for (int k = 0; k < 3; k++) {
		rb_vec3 velocity[2];

		for (int steps = 0; steps < 2; steps++) {
			struct lab lab;
			struct lab_log log;
			const struct rb_world_hooks hooks = lab_log_open(&log);

			lab_open(&lab, time_step, 1 / time_step);
			lab.scene.world.method = steps ? RB_METHOD_STEPPED : RB_METHOD_LOCATED;
			lab.scene.world.time_step_s = time_step;
			lab_surface(&lab, 0, 1);
			struct rb_body_def def = lab_sphere_def(
				radius, 1, (rb_vec3){-0.25 - radius - speed * met_s, 0.02, 0},
				(rb_vec3){speed, 0, 0});
			def.call = "body";
			def.shape.kind = kinds[k];
			def.shape.size[2] = 0.2;
			def.angular_velocity = (rb_vec3){0, 0, spin};
			const int round = lab_add(&lab, &def);
			struct rb_body_def box = rb_body_def_default();
			box.call = "box";
			box.shape.kind = RB_SHAPE_BOX;
			box.shape.size[0] = box.shape.size[1] = box.shape.size[2] = 0.5;
			box.mass = 8;
			lab_add(&lab, &box);
			lab_seal_with(&lab, &options, &hooks);
			lab_run(&lab);
			velocity[steps] = rb_world_velocity(lab.world, round);
			assert_true(fabs(rb_world_angular_velocity(lab.world, round).z - spin) <=
			            1e-10 * spin);
			assert_int_equal(log.count, 1);
			assert_true(fabs(log.row[0].time_s - met_s) <= 1e-10);
			assert_true(fabs(log.row[0].point.y - 0.02) <= 1e-10);
			lab_log_close(&log);
			lab_close(&lab);
		}
		assert_true(rb_vec3_length(rb_vec3_sub(velocity[0], velocity[1])) <= 1e-10 * speed);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_meets_with_friction_goes_on_with_its_new_spin),
		cmocka_unit_test(what_meets_without_friction_is_told_of_all_of_its_impulse),
		cmocka_unit_test(what_forces_part_again_has_met_once),
		cmocka_unit_test(what_is_round_meets_with_its_side_however_it_spins),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
