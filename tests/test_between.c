/* SPDX-License-Identifier: MIT */
/* src/flow/between.c */
#include "worlds.h"

#include "base/memory.h"
#include "flow/between.h"
#include "flow/frame.h"
#include "math/quat.h"
#include "math/vec3.h"

/* Two bodies whose moments are equal; as many as are asked for are looked at. */
static const struct rb_model plain = {
	.body_count = 2,
	.inverse_mass = (double[]){1, 1},
	.inertia = (rb_mat3[]){{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
	.inverse_inertia = (rb_mat3[]){{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
	.inertia_of = (int[]){0, 0},
};

static struct rb_frame frame_of(int bodies, rb_features features, unsigned fields)
{
	const struct rb_model model = {.body_count = bodies, .features = features};
	struct rb_frame frame;

	assert_int_equal(rb_frame_init(&frame, &model, fields, NULL), RB_OK);
	return frame;
}

/* One body that turns with `spin` and is at `turn` from its start. */
static struct rb_frame turned(double time_s, rb_vec3 turn, rb_vec3 spin)
{
	struct rb_frame frame = frame_of(1, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT);

	frame.time_s = time_s;
	rb_quat_to(frame.orientation, rb_quat_from_turn(turn));
	rb_vec3_to(frame.angular_velocity, spin);
	return frame;
}

/* How far the orientations are apart, rad, whichever sign they have. */
static double apart(const double *p, rb_quat b)
{
	const rb_quat a = rb_quat_from(p);
	const double sign = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0 ? -1 : 1;
	const rb_quat difference = {a.w - sign * b.w, a.x - sign * b.x, a.y - sign * b.y,
	                            a.z - sign * b.z};

	return 2 * rb_quat_length(difference);
}

/* A quaternion that rounding has left a little off unit length, as recordings hold them, is not made a unit there. */
static void a_frame_at_the_moment_of_both_ends_is_the_earlier_to_the_bit(void **state)
{
	struct rb_frame a = turned(1, (rb_vec3){0.1, 0.2, 0.3}, (rb_vec3){1, 2, 3});
	struct rb_frame b = turned(1, (rb_vec3){0.7, 0.1, 0.2}, (rb_vec3){3, 2, 1});
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	for (int i = 0; i < 4; i++)
		a.orientation[i] *= 1 + 1e-12, b.orientation[i] *= 1 - 1e-12;
	for (int later = 0; later < 2; later++) {
		b.time_s = 1 + later;
		assert_ok(rb_frame_between(&out, &plain, &a, &b, 1, &err));
		assert_memory_equal(out.frame.orientation, a.orientation, 4 * sizeof(double));
		assert_memory_equal(out.frame.angular_velocity, a.angular_velocity,
		                    3 * sizeof(double));
	}
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 2, &err));
	assert_memory_equal(out.frame.orientation, b.orientation, 4 * sizeof(double));
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

static void either_end_is_that_frame_to_the_bit(void **state)
{
	struct rb_frame a = turned(1, (rb_vec3){0.1, 0.2, 0.3}, (rb_vec3){0, 0, 3});
	struct rb_frame b = turned(2, (rb_vec3){0.7, 0.1, 0.2}, (rb_vec3){1, 0, 3});
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	a.position[0] = 0.1, b.position[0] = 0.3;
	a.index = 60, b.index = 120;
	a.numbers.kinetic_energy = 5, b.numbers.kinetic_energy = 7;
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 1, &err));
	assert_memory_equal(out.frame.orientation, a.orientation, 4 * sizeof(double));
	assert_true(out.frame.position[0] == 0.1 && out.frame.index == 60 && out.frame.time_s == 1);
	assert_true(out.frame.numbers.kinetic_energy == 5);
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 2, &err));
	assert_memory_equal(out.frame.orientation, b.orientation, 4 * sizeof(double));
	assert_true(out.frame.position[0] == 0.3 && out.frame.index == 120 &&
	            out.frame.time_s == 2);
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

static void positions_go_straight_and_counts_are_those_of_the_later_frame(void **state)
{
	struct rb_frame a = frame_of(2, 0, RB_FIELD_DEFAULT), b = frame_of(2, 0, RB_FIELD_DEFAULT);
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	a.time_s = 1, b.time_s = 3;
	for (int i = 0; i < 6; i++) {
		a.position[i] = i, b.position[i] = 10 * i;
		a.velocity[i] = -i, b.velocity[i] = i;
	}
	a.numbers = (struct rb_frame_numbers){.kinetic_energy = 8, .collisions = 1};
	b.numbers = (struct rb_frame_numbers){.kinetic_energy = 4, .collisions = 5};
	a.numbers.potential_energy = -2, b.numbers.potential_energy = 6;
	a.numbers.momentum = (rb_vec3){1, -2, 4}, b.numbers.momentum = (rb_vec3){5, 2, 16};
	a.numbers.angular_momentum = (rb_vec3){8, 3, -1};
	b.numbers.angular_momentum = (rb_vec3){0, -5, 7};
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 1.5, &err));
	for (int i = 0; i < 6; i++) {
		assert_near(out.frame.position[i], 0.75 * i + 0.25 * 10 * i, 1e-14);
		assert_near(out.frame.velocity[i], -0.5 * i, 1e-14);
	}
	assert_null(out.frame.orientation);
	assert_near(out.frame.numbers.kinetic_energy, 7, 1e-14);
	assert_near(out.frame.numbers.potential_energy, 0, 1e-14);
	assert_near(rb_vec3_length(rb_vec3_sub(out.frame.numbers.momentum, (rb_vec3){2, -1, 7})), 0,
	            1e-14);
	assert_near(
		rb_vec3_length(rb_vec3_sub(out.frame.numbers.angular_momentum, (rb_vec3){6, 1, 1})),
		0, 1e-14);
	assert_int_equal(out.frame.numbers.collisions, 5);
	assert_true(out.frame.time_s == 1.5);
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

/* Two bodies about axes of their own, from poses of their own. */
static const rb_vec3 start_turn[2] = {{0.3, -0.8, 0.5}, {-1.1, 0.2, 0.7}};
static const rb_vec3 way_turn[2] = {{1.2, -0.7, 1.4}, {-0.4, 2.1, -0.9}};

/* Where body i is when it has gone `part` of its way about its axis, which does not move. */
static rb_quat gone(int i, double part)
{
	return rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(part, way_turn[i])),
	                        rb_quat_from_turn(start_turn[i]));
}

/* Without spins the way is the shortest, whatever the signs of the quaternions. */
static void orientations_without_spins_follow_the_great_circle(void **state)
{
	const unsigned fields = RB_FIELD_POSITION | RB_FIELD_ORIENTATION;
	struct rb_frame a = frame_of(2, RB_FEATURE_ROTATION, fields);
	struct rb_frame b = frame_of(2, RB_FEATURE_ROTATION, fields);
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	b.time_s = 4;
	for (int i = 0; i < 2; i++) {
		rb_quat_to(a.orientation + 4 * i, gone(i, 0));
		rb_quat_to(b.orientation + 4 * i, gone(i, 1));
	}
	for (int sign = 0; sign < 2; sign++) {
		assert_ok(rb_frame_between(&out, &plain, &a, &b, 1, &err));
		for (int i = 0; i < 2; i++) {
			assert_near(apart(out.frame.orientation + 4 * i, gone(i, 0.25)), 0, 1e-14);
			assert_near(rb_quat_length(rb_quat_from(out.frame.orientation + 4 * i)), 1,
			            1e-15);
		}
		for (int i = 0; i < 8; i++)
			b.orientation[i] = -b.orientation[i];
	}
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

/* The axes do not move, so constant spins are exact, also over an interval that is no second long. */
static void every_body_follows_its_own_spin(void **state)
{
	struct rb_frame a = frame_of(2, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT);
	struct rb_frame b = frame_of(2, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT);
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	a.time_s = 1, b.time_s = 5;
	for (int i = 0; i < 2; i++) {
		const double turns = i ? 5
		                       : -3; /* of the way, in the interval: several times round */
		rb_quat_to(a.orientation + 4 * i, gone(i, 0));
		rb_quat_to(b.orientation + 4 * i, gone(i, turns));
		rb_vec3_to(a.angular_velocity + 3 * i, rb_vec3_scale(turns / 4, way_turn[i]));
		rb_vec3_to(b.angular_velocity + 3 * i, rb_vec3_scale(turns / 4, way_turn[i]));
	}
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 2.5, &err));
	for (int i = 0; i < 2; i++) {
		const double turns = i ? 5 : -3;
		assert_near(apart(out.frame.orientation + 4 * i, gone(i, 0.375 * turns)), 0, 1e-13);
	}
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

static void a_body_that_spins_several_times_a_frame_does_not_seem_to_turn_slowly(void **state)
{
	const double speeds[] = {1, -7, 20, 6.283185307179586 * 3, 100.5};
	struct rb_error err;

	(void)state;
	for (size_t k = 0; k < sizeof speeds / sizeof *speeds; k++) {
		const rb_vec3 axis = {0.6, 0, -0.8};
		const rb_vec3 spin = rb_vec3_scale(speeds[k], axis);
		struct rb_frame a = turned(2, (rb_vec3){0, 0, 0}, spin);
		struct rb_frame b = turned(3, spin, spin);
		struct rb_between out = {0};

		for (int i = 1; i < 10; i++) {
			assert_ok(rb_frame_between(&out, &plain, &a, &b, 2 + 0.1 * i, &err));
			assert_near(apart(out.frame.orientation,
			                  rb_quat_from_turn(rb_vec3_scale(0.1 * i, spin))),
			            0, 1e-12);
		}
		rb_frame_release(&a);
		rb_frame_release(&b);
		rb_between_release(&out);
	}
}

/* Spin about z, nearly one turn, and a small tilt: the turn is about z and not about the axis of the tilt. */
static void nearly_whole_turns_keep_their_axis(void **state)
{
	const rb_vec3 spin = {0, 0, 6.283185307179586};
	struct rb_frame a = turned(0, (rb_vec3){0, 0, 0}, spin);
	struct rb_frame b = turned(1, (rb_vec3){0.01, 0, 0}, spin);
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 0.25, &err));
	assert_near(apart(out.frame.orientation, rb_quat_from_turn((rb_vec3){0, 0, 0.25 * spin.z})),
	            0, 0.011);
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

/* The spins at both ends say nothing true about the interval: the ends are still met, continuously. */
static void a_wrong_spin_still_arrives_where_the_frames_are(void **state)
{
	struct rb_frame a = turned(0, (rb_vec3){0, 0, 0}, (rb_vec3){9, -3, 2});
	struct rb_frame b = turned(1, (rb_vec3){0, 2, 1}, (rb_vec3){-4, 5, 0.5});
	struct rb_between out = {0};
	struct rb_error err;

	(void)state;
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 1e-9, &err));
	assert_near(apart(out.frame.orientation, rb_quat_from(a.orientation)), 0, 1e-7);
	assert_ok(rb_frame_between(&out, &plain, &a, &b, 1 - 1e-9, &err));
	assert_near(apart(out.frame.orientation, rb_quat_from(b.orientation)), 0, 1e-7);
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_between_release(&out);
}

static void a_copy_follows_frames_of_any_shape_and_keeps_its_lists(void **state)
{
	struct rb_frame big = frame_of(5, RB_FEATURE_ROTATION,
	                               RB_FIELD_DEFAULT | RB_FIELD_EVENTS | RB_FIELD_CONTACTS);
	struct rb_frame small = frame_of(2, 0, RB_FIELD_POSITION);
	struct rb_frame copy = {0};
	struct rb_error err;

	(void)state;
	big.event_count = 3, big.events[2].approach_speed = 7;
	big.contact_count = 1, big.contacts[0].gap = 0.5;
	big.position[14] = 3;
	small.position[5] = 4;
	for (int round = 0; round < 2; round++) {
		assert_ok(rb_frame_copy(&copy, &big, &err));
		assert_int_equal(copy.body_count, 5);
		assert_true(copy.position[14] == 3 && copy.events[2].approach_speed == 7);
		assert_true(copy.contact_count == 1 && copy.contacts[0].gap == 0.5);
		assert_true(copy.position != big.position && copy.events != big.events);
		const double *const kept = copy.position;
		assert_ok(rb_frame_copy(&copy, &big, &err));
		assert_ptr_equal(copy.position, kept);
		assert_ok(rb_frame_copy(&copy, &small, &err));
		assert_int_equal(copy.body_count, 2);
		assert_true(copy.position[5] == 4);
		assert_null(copy.orientation);
		assert_null(copy.velocity);
		assert_int_equal(copy.event_count, 0);
	}
	rb_frame_release(&copy);
	rb_frame_release(&big);
	rb_frame_release(&small);
}

static void every_failed_allocation_leaves_a_copy_that_can_be_released(void **state)
{
	struct rb_frame from = frame_of(5, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT | RB_FIELD_EVENTS);
	int failures = 0;

	(void)state;
	from.event_count = 9;
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1;; k++) {
		struct rb_frame copy = {0};

		rb_memory_fail_at(k);
		const enum rb_status status = rb_frame_copy(&copy, &from, NULL);
		rb_memory_fail_at(0);
		rb_frame_release(&copy);
		if (!status)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
		failures++;
	}
	assert_int_equal(failures, 5);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
	rb_frame_release(&from);
}

/* ---- against the run itself ---- */

enum { COARSE = 20, FINE = 20 * COARSE }; /* frames per second */

/* Balls that bounce, one that spins fast, a body with three moments that turns many times a frame, a box that falls. */
static void add_bouncers(struct lab *lab)
{
	struct rb_body_def def = lab_sphere_def(0.1, 2, (rb_vec3){0, 0, 0.4}, (rb_vec3){1, 0, 0});

	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.3, 0.9);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	lab_add(lab, &def);
	def.position = (rb_vec3){0, 1, 0.3};
	def.angular_velocity = (rb_vec3){0, 0, 200};
	lab_add(lab, &def);
	def.position = (rb_vec3){0, 2, 0.2};
	def.angular_velocity = (rb_vec3){40, -90, 10};
	lab_add(lab, &def);
	def.position = (rb_vec3){0, 9, 20};
	def.inertia = &(rb_mat3){{{0.004, 0, 0}, {0, 0.006, 0}, {0, 0, 0.009}}};
	def.angular_velocity = (rb_vec3){1, 150, 2};
	lab_add(lab, &def);
	/* two in flight, off the line of their centres */
	def = lab_sphere_def(0.1, 1, (rb_vec3){0, 20, 9}, (rb_vec3){3, 0, 0});
	lab_add(lab, &def);
	def = lab_sphere_def(0.2, 3, (rb_vec3){1, 20.1, 9.1}, (rb_vec3){-2, 0, 0});
	lab_add(lab, &def);
}

static void seal_bouncers(struct lab *lab, double frame_rate, const struct rb_world_hooks *hooks)
{
	const struct rb_world_options options = {.threads = 1, .keep_events = true};

	lab_open_located(lab, 1, frame_rate);
	add_bouncers(lab);
	lab_seal_with(lab, &options, hooks);
}

static void fill(struct lab *lab, struct rb_frame *frame)
{
	assert_int_equal(rb_world_fill_frame(lab->world, frame, &lab->error), RB_OK);
}

/*
 * A run at a low frame rate, looked at between its frames, against the same at a high one; returns
 * how many events of each kind there were. Accelerations are constant between them, so nothing is
 * off but by rounding; the spin of the body of unequal moments by the steps of its turn.
 */
static void compare_runs(struct lab *coarse, struct lab *fine, int events[RB_EVENT_KIND_COUNT])
{
	const unsigned fields = RB_FIELD_DEFAULT | RB_FIELD_EVENTS;
	struct rb_frame a, b, truth;
	struct rb_between out = {0};
	struct rb_error err;

	const int n = coarse->model->body_count;
	assert_ok(rb_frame_init(&a, coarse->model, fields, &err));
	assert_ok(rb_frame_init(&b, coarse->model, fields, &err));
	assert_ok(rb_frame_init(&truth, fine->model, fields, &err));
	fill(coarse, &a);
	for (int k = 1; k <= COARSE; k++) {
		assert_ok(rb_world_step_frame(coarse->world, &err));
		fill(coarse, &b);
		for (int j = 1; j < FINE / COARSE; j++) {
			assert_ok(rb_world_step_frame(fine->world, &err));
			fill(fine, &truth);
			assert_ok(
				rb_frame_between(&out, coarse->model, &a, &b, truth.time_s, &err));
			for (int i = 0; i < 3 * n; i++) {
				assert_near(out.frame.position[i], truth.position[i], 1e-12);
				assert_near(out.frame.velocity[i], truth.velocity[i], 1e-10);
			}
			for (int i = 0; i < n; i++)
				assert_near(apart(out.frame.orientation + 4 * i,
				                  rb_quat_from(truth.orientation + 4 * i)),
				            0, i == 3 ? 2e-3 : 1e-10);
		}
		assert_ok(rb_world_step_frame(fine->world, &err));
		for (int i = 0; i < b.event_count; i++)
			events[b.events[i].kind]++;
		assert_ok(rb_frame_copy(&a, &b, &err));
	}
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_frame_release(&truth);
	rb_between_release(&out);
}

static void bodies_that_bounce_and_spin_are_between_frames_where_the_run_has_them(void **state)
{
	struct lab coarse, fine;
	int events[RB_EVENT_KIND_COUNT] = {0};

	(void)state;
	seal_bouncers(&coarse, COARSE, NULL);
	seal_bouncers(&fine, FINE, NULL);
	compare_runs(&coarse, &fine, events);
	assert_true(events[RB_EVENT_COLLISION] > 6);
	lab_close(&coarse);
	lab_close(&fine);
}

/* Another change at each impact with the ground; times of impacts are the same at any frame rate. */
static enum rb_status change_something(void *user, struct rb_world *world,
                                       const struct rb_event *event, struct rb_error *err)
{
	int *const count = user;
	const int id = event->b;
	const rb_vec3 at = rb_world_position(world, id);
	const rb_vec3 edge = rb_vec3_add(at, (rb_vec3){0.03, -0.05, 0.02});
	const rb_vec3 aside = rb_vec3_add(at, (rb_vec3){0.5, 0.25, 0.125});

	(void)err;
	if (!rb_world_is_static(world, event->a))
		return RB_OK;
	switch ((*count)++ % 4) {
	case 0:
		rb_world_set_velocity(world, id, (rb_vec3){0.5, -0.25, 1.5});
		break;
	case 1:
		rb_world_set_position(world, id, aside);
		rb_world_set_velocity(world, id, (rb_vec3){0, 0, 1});
		break;
	case 2:
		rb_world_set_angular_velocity(world, id, (rb_vec3){10, 20, -30});
		break;
	default:
		rb_world_apply_impulse(world, id, (rb_vec3){1, 2, 3}, edge);
		rb_world_apply_impulse(world, id, (rb_vec3){-1, 0.5, 2}, at);
	}
	return RB_OK;
}

static void what_callbacks_change_is_between_frames_where_the_run_has_it(void **state)
{
	struct lab coarse, fine;
	int events[RB_EVENT_KIND_COUNT] = {0}, changes[2] = {0};

	(void)state;
	seal_bouncers(&coarse, COARSE,
	              &(struct rb_world_hooks){.user = &changes[0], .collision = change_something});
	seal_bouncers(&fine, FINE,
	              &(struct rb_world_hooks){.user = &changes[1], .collision = change_something});
	compare_runs(&coarse, &fine, events);
	assert_true(changes[0] >= 8 && changes[0] == changes[1]);
	/* two impulses of one moment are one event */
	assert_in_range(events[RB_EVENT_IMPULSE], changes[0] / 2, changes[0]);
	assert_in_range(events[RB_EVENT_ANGULAR_IMPULSE], changes[0] / 4, changes[0] / 2 + 1);
	assert_in_range(events[RB_EVENT_DISPLACEMENT], changes[0] / 4, changes[0] / 4 + 1);
	lab_close(&coarse);
	lab_close(&fine);
}

static void begin_steps(struct lab *lab, double frame_rate)
{
	lab_open(lab, 0.6, frame_rate);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / FINE;
	lab->scene.world.tolerance_m = 1e-7; /* what is between frames is judged, not overlaps */
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.4, 0.5);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
}

static void add_box(struct lab *lab, double x, double y, double z)
{
	struct rb_body_def def = rb_body_def_default();

	def.shape.kind = RB_SHAPE_BOX;
	def.shape.size[0] = def.shape.size[1] = def.shape.size[2] = 0.2;
	def.shape.radius = 0.1 * sqrt(3);
	def.mass = 6.4;
	def.position = (rb_vec3){x, y, z};
	lab_add(lab, &def);
}

static void drop_ball(struct lab *lab, double x, double y)
{
	const struct rb_world_options options = {.threads = 1, .keep_events = true};
	struct rb_body_def def = lab_sphere_def(0.15, 11, (rb_vec3){x, y, 1.6},
	                                        (rb_vec3){0, 0, -2});

	lab_add(lab, &def);
	lab_seal_with(lab, &options, NULL);
}

/* A ball falls on a stack of boxes at rest, by steps. */
static void seal_stack(struct lab *lab, double frame_rate)
{
	begin_steps(lab, frame_rate);
	for (int k = 0; k < 5; k++)
		add_box(lab, 0, 0, 0.1 + 0.2 * k);
	drop_ball(lab, 0.02, 0.01);
}

/* On a pyramid, whose boxes stand on four each: one group of more than 200 contacts. */
static void seal_pyramid(struct lab *lab, double frame_rate)
{
	begin_steps(lab, frame_rate);
	for (int k = 0; k < 5; k++)
		for (int i = 0; i < (6 - k) * (6 - k); i++)
			add_box(lab, 0.21 * (i % (6 - k)) + 0.105 * k,
			        0.21 * (i / (6 - k)) + 0.105 * k, 0.1 + 0.2 * k);
	drop_ball(lab, 0.52, 0.53);
}

/* The same run of steps, a frame at each and at each twentieth: m, the worst of all bodies. */
static double worst_of_steps(void (*seal)(struct lab *lab, double frame_rate))
{
	const unsigned fields = RB_FIELD_DEFAULT | RB_FIELD_EVENTS;
	struct lab coarse, fine;
	struct rb_frame a, b, truth;
	struct rb_between out = {0};
	struct rb_error err;
	double worst = 0;
	int events = 0;

	seal(&coarse, COARSE);
	seal(&fine, FINE);
	assert_ok(rb_frame_init(&a, coarse.model, fields, &err));
	assert_ok(rb_frame_init(&b, coarse.model, fields, &err));
	assert_ok(rb_frame_init(&truth, fine.model, fields, &err));
	fill(&coarse, &a);
	for (int k = 0; k < 12 * FINE / COARSE; k++) {
		if (k % (FINE / COARSE) == 0) {
			if (k > 0)
				assert_ok(rb_frame_copy(&a, &b, &err));
			assert_ok(rb_world_step_frame(coarse.world, &err));
			fill(&coarse, &b);
			events += b.event_count;
		}
		assert_ok(rb_world_step_frame(fine.world, &err));
		fill(&fine, &truth);
		assert_ok(rb_frame_between(&out, coarse.model, &a, &b, fmin(truth.time_s, b.time_s),
		                           &err));
		for (int i = 0; i < 3 * coarse.model->body_count; i++)
			worst = fmax(worst, fabs(out.frame.position[i] - truth.position[i]));
	}
	print_message("at most %.2g m away, %d impacts, %d of large groups\n", worst, events,
	              (int)rb_world_work(coarse.world).crowded_impacts);
	assert_true(events >= 2 && rb_world_work(coarse.world).crowded_impacts >= 2);
	rb_frame_release(&a);
	rb_frame_release(&b);
	rb_frame_release(&truth);
	rb_between_release(&out);
	lab_close(&coarse);
	lab_close(&fine);
	return worst;
}

static void what_a_pile_presses_back_does_not_throw_bodies_about_between_frames(void **state)
{
	(void)state;
	assert_true(worst_of_steps(seal_stack) < 5e-4);
}

/* A step at 3.5 m/s is 9 mm, and its impact is told at its end. */
static void impacts_of_large_groups_are_between_frames_where_the_steps_have_them(void **state)
{
	(void)state;
	assert_true(worst_of_steps(seal_pyramid) < 5e-4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(either_end_is_that_frame_to_the_bit),
		cmocka_unit_test(a_frame_at_the_moment_of_both_ends_is_the_earlier_to_the_bit),
		cmocka_unit_test(positions_go_straight_and_counts_are_those_of_the_later_frame),
		cmocka_unit_test(orientations_without_spins_follow_the_great_circle),
		cmocka_unit_test(every_body_follows_its_own_spin),
		cmocka_unit_test(
			a_body_that_spins_several_times_a_frame_does_not_seem_to_turn_slowly),
		cmocka_unit_test(nearly_whole_turns_keep_their_axis),
		cmocka_unit_test(a_wrong_spin_still_arrives_where_the_frames_are),
		cmocka_unit_test(
			bodies_that_bounce_and_spin_are_between_frames_where_the_run_has_them),
		cmocka_unit_test(what_callbacks_change_is_between_frames_where_the_run_has_it),
		cmocka_unit_test(
			what_a_pile_presses_back_does_not_throw_bodies_about_between_frames),
		cmocka_unit_test(
			impacts_of_large_groups_are_between_frames_where_the_steps_have_them),
		cmocka_unit_test(a_copy_follows_frames_of_any_shape_and_keeps_its_lists),
		cmocka_unit_test(every_failed_allocation_leaves_a_copy_that_can_be_released),
	};

	return cmocka_run_group_tests_name("between", tests, NULL, NULL);
}
