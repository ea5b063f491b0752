/* SPDX-License-Identifier: MIT */
/* src/flow/frame.c: storage of a frame, by what is wanted and what can change */
#include "support.h"

#include "flow/frame.h"
#include "model/joints.h"

static const struct {
	unsigned field;
	size_t offset, width;
	bool turns;
} columns[] = {
	{RB_FIELD_POSITION, offsetof(struct rb_frame, position), 3, false},
	{RB_FIELD_ORIENTATION, offsetof(struct rb_frame, orientation), 4, true},
	{RB_FIELD_VELOCITY, offsetof(struct rb_frame, velocity), 3, false},
	{RB_FIELD_ANGULAR_VELOCITY, offsetof(struct rb_frame, angular_velocity), 3, true},
	{RB_FIELD_ACCELERATION, offsetof(struct rb_frame, acceleration), 3, false},
	{RB_FIELD_ANGULAR_ACCELERATION, offsetof(struct rb_frame, angular_acceleration), 3, true},
	{RB_FIELD_FORCE, offsetof(struct rb_frame, force), 3, false},
	{RB_FIELD_TORQUE, offsetof(struct rb_frame, torque), 3, true},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

static double *column_of(const struct rb_frame *frame, int c)
{
	double *column;

	memcpy(&column, (const unsigned char *)frame + columns[c].offset, sizeof column);
	return column;
}

/* For every choice of fields, of a scene that can turn and of one that cannot. */
static void columns_are_there_where_they_are_wanted_and_can_change(void **state)
{
	struct rb_error err;

	(void)state;
	for (unsigned k = 0; k < 2048; k++) {
		const bool turns = k & 1;
		const unsigned fields = k >> 1; /* the ten fields that there are */
		const struct rb_model model = {.body_count = 7,
		                               .features = turns ? RB_FEATURE_ROTATION : 0};
		struct rb_frame frame;
		size_t bytes = 0;

		assert_ok(rb_frame_init(&frame, &model, fields, &err));
		assert_int_equal(frame.body_count, 7);
		for (int c = 0; c < COLUMNS; c++) {
			const bool wanted = (fields & columns[c].field) &&
			                    (turns || !columns[c].turns);
			double *column = column_of(&frame, c);

			assert_int_equal(column != NULL, wanted);
			assert_int_equal((rb_frame_fields(&model, fields) & columns[c].field) != 0,
			                 wanted);
			if (!wanted)
				continue;
			bytes += 7 * columns[c].width * sizeof(double);
			for (size_t i = 0; i < 7 * columns[c].width; i++) {
				assert_true(column[i] == 0);
				column[i] = 1; /* the block is so long: its end is watched */
			}
		}
		assert_int_equal(rb_frame_bytes(&model, fields), bytes);
		assert_int_equal(frame.events != NULL, (fields & RB_FIELD_EVENTS) != 0);
		assert_int_equal(frame.event_capacity > 0, (fields & RB_FIELD_EVENTS) != 0);
		assert_int_equal(frame.contacts != NULL, (fields & RB_FIELD_CONTACTS) != 0);
		assert_int_equal(frame.contact_capacity > 0, (fields & RB_FIELD_CONTACTS) != 0);
		assert_int_equal(frame.event_count + frame.contact_count + frame.shot_count, 0);
		rb_frame_release(&frame);
		rb_frame_release(&frame);
		assert_null(frame.position);
	}
}

static void a_scene_without_bodies_has_frames_too(void **state)
{
	const struct rb_model model = {.body_count = 0, .features = RB_FEATURE_ROTATION};
	struct rb_frame frame;
	struct rb_error err;

	(void)state;
	assert_ok(rb_frame_init(&frame, &model, RB_FIELD_DEFAULT, &err));
	assert_int_equal(frame.body_count, 0);
	assert_int_equal(rb_frame_bytes(&model, RB_FIELD_DEFAULT), 0);
	rb_frame_release(&frame);
}

static void any_lack_of_memory_leaves_nothing(void **state)
{
	const struct rb_model model = {.body_count = 3, .features = RB_FEATURE_ROTATION};
	const unsigned all = RB_FIELD_DEFAULT | RB_FIELD_LOADS | RB_FIELD_EVENTS |
	                     RB_FIELD_CONTACTS;
	const uint64_t before = rb_memory_counts().taken - rb_memory_counts().freed;
	struct rb_frame frame;
	struct rb_error err;

	(void)state;
	for (uint64_t k = 1; k <= 10; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_frame_init(&frame, &model, all, &err);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_string_equal(err.text, "cannot hold a frame of 3 bodies: out of memory");
		assert_null(frame.position);
		assert_int_equal(rb_memory_counts().taken - rb_memory_counts().freed, before);
		rb_frame_release(&frame);
	}
	assert_ok(rb_frame_init(&frame, &model, all, &err));
	rb_frame_release(&frame);
}

static void shots_are_added_one_by_one(void **state)
{
	struct rb_frame frame = {0};
	struct rb_frame_shot shot = {.enlarged = 1};
	struct rb_error err;

	(void)state;
	for (int k = 0; k < 100; k++) {
		shot.camera = k / 10;
		shot.picture = (uint64_t)(k % 10);
		shot.position.x = k;
		assert_ok(rb_frame_add_shot(&frame, &shot, &err));
		assert_int_equal(frame.shot_count, k + 1);
		assert_true(frame.shot_capacity >= frame.shot_count);
	}
	for (int k = 0; k < 100; k++) {
		assert_int_equal(frame.shots[k].camera, k / 10);
		assert_int_equal(frame.shots[k].picture, k % 10);
		assert_true(frame.shots[k].position.x == k);
	}
	/* without memory it is as it was */
	frame.shot_count = frame.shot_capacity;
	rb_memory_fail_at(1);
	const enum rb_status status = rb_frame_add_shot(&frame, &shot, &err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_int_equal(frame.shot_count, frame.shot_capacity);
	assert_true(frame.shots[99].position.x == 99);
	rb_frame_release(&frame);
}

static void every_kind_of_event_has_a_name_of_its_own(void **state)
{
	(void)state;
	assert_string_equal(rb_event_kind_name(RB_EVENT_COLLISION), "collision");
	assert_string_equal(rb_event_kind_name(RB_EVENT_DISPLACEMENT), "displacement");
	for (int k = 0; k < RB_EVENT_KIND_COUNT; k++) {
		const char *name = rb_event_kind_name((enum rb_event_kind)k);

		assert_non_null(name);
		assert_int_equal(strspn(name, "abcdefghijklmnopqrstuvwxyz_"), strlen(name));
		for (int i = 0; i < k; i++)
			assert_string_not_equal(name, rb_event_kind_name((enum rb_event_kind)i));
	}
}

static void joints_have_columns_of_their_own_where_there_are_any(void **state)
{
	struct rb_joints joints = {.count = 5};
	const struct rb_model model = {.body_count = 2, .joints = &joints},
			      bare = {.body_count = 2};
	struct rb_frame frame;
	struct rb_error err;

	(void)state;
	assert_ok(rb_frame_init(&frame, &model, RB_FIELD_JOINTS, &err));
	assert_int_equal(frame.joint_count, 5);
	assert_true(frame.joint_value && frame.joint_speed && frame.joint_force &&
	            frame.joint_torque);
	frame.joint_value[4] = frame.joint_speed[4] = 1;
	frame.joint_force[14] = frame.joint_torque[14] = 1; /* the blocks' ends are watched */
	assert_int_equal(rb_frame_bytes(&model, RB_FIELD_JOINTS), 8 * 5 * sizeof(double));
	rb_frame_release(&frame);
	assert_null(frame.joint_value);
	assert_ok(rb_frame_init(&frame, &bare, RB_FIELD_JOINTS, &err));
	assert_null(frame.joint_value);
	assert_int_equal(rb_frame_fields(&bare, RB_FIELD_JOINTS), 0);
	assert_int_equal(rb_frame_bytes(&bare, RB_FIELD_JOINTS), 0);
	rb_frame_release(&frame);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(joints_have_columns_of_their_own_where_there_are_any),
		cmocka_unit_test(columns_are_there_where_they_are_wanted_and_can_change),
		cmocka_unit_test(a_scene_without_bodies_has_frames_too),
		cmocka_unit_test(any_lack_of_memory_leaves_nothing),
		cmocka_unit_test(shots_are_added_one_by_one),
		cmocka_unit_test(every_kind_of_event_has_a_name_of_its_own),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
