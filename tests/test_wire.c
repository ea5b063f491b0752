/* SPDX-License-Identifier: MIT */
/* src/control/wire.c */
#include "support.h"

#include <float.h>

#include "base/memory.h"
#include "control/wire.h"
#include "flow/frame.h"

enum { BODIES = 5 };

/* A frame with numbers of its own everywhere. */
static struct rb_frame frame_of(int body_count, rb_features features, unsigned fields)
{
	const struct rb_model model = {.body_count = body_count, .features = features};
	struct rb_frame frame;

	assert_int_equal(rb_frame_init(&frame, &model, fields, NULL), RB_OK);
	frame.index = 123456789012;
	frame.time_s = 1.0 / 3;
	frame.numbers = (struct rb_frame_numbers){
		.kinetic_energy = 0.1,
		.potential_energy = -1e300,
		.momentum = {1, 2, 3},
		.angular_momentum = {4, 5, 6},
		.max_penetration = 1e-9,
		.contacts = 7,
		.collisions = 8,
		.rollbacks = 9,
		.substeps = 10,
		.smallest_step = 1e-5,
		.gravitation_error = 3e-4,
		.gravitation_energy_error = 7e-6,
		.stepped = 0.25,
	};
	for (int i = 0; i < 3 * body_count; i++) {
		if (frame.position)
			frame.position[i] = 0.5 * i - 2;
		if (frame.velocity)
			frame.velocity[i] = 1.0 / (i + 1);
	}
	for (int i = 0; frame.orientation && i < 4 * body_count; i++)
		frame.orientation[i] = i % 4 == 0;
	return frame;
}

static void write_frame(const struct rb_frame *frame, char **text, size_t *size)
{
	size_t capacity = 0;
	struct rb_error err;

	*text = NULL;
	assert_ok(rb_wire_write_frame(text, &capacity, size, frame, &err));
	assert_int_equal(strlen(*text), *size);
	assert_null(strchr(*text, '\n'));
}

static void base64_is_that_of_the_standard(void **state)
{
	/* RFC 4648, section 10 */
	static const char *const pairs[][2] = {{"", ""},
	                                       {"f", "Zg=="},
	                                       {"fo", "Zm8="},
	                                       {"foo", "Zm9v"},
	                                       {"foob", "Zm9vYg=="},
	                                       {"fooba", "Zm9vYmE="},
	                                       {"foobar", "Zm9vYmFy"}};
	char text[16] = "", bytes[16];

	(void)state;
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		const size_t size = strlen(pairs[i][0]), text_size = strlen(pairs[i][1]);
		assert_int_equal(rb_wire_base64_size(size), text_size);
		rb_wire_base64_write(text, pairs[i][0], size);
		assert_memory_equal(text, pairs[i][1], text_size);
		assert_true(rb_wire_base64_read(bytes, size, text, text_size));
		assert_memory_equal(bytes, pairs[i][0], size);
		assert_false(rb_wire_base64_read(bytes, size, text, text_size + 1));
		assert_false(rb_wire_base64_read(bytes, size + 3, text, text_size));
	}
	assert_false(rb_wire_base64_read(bytes, 1, "Zh==", 4)); /* bits that nothing stands for */
	assert_false(rb_wire_base64_read(bytes, 2, "Zm9=", 4));
	assert_false(rb_wire_base64_read(bytes, 3, "Zm9*", 4));
	assert_false(rb_wire_base64_read(bytes, 3, "Zm8=", 4));
	assert_false(rb_wire_base64_read(bytes, 1, "Zg=a", 4));
}

static void a_frame_comes_back_as_single_precision_and_its_numbers_in_full(void **state)
{
	static const unsigned fields[] = {RB_FIELD_DEFAULT, RB_FIELD_POSITION,
	                                  RB_FIELD_POSITION | RB_FIELD_VELOCITY, 0};
	struct rb_frame back = {0};

	(void)state;
	/* the same frame is read into again, with other columns each time */
	for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
		struct rb_frame frame = frame_of(BODIES, RB_FEATURE_ROTATION, fields[k]);
		struct rb_error err;
		char *text;
		size_t size;

		write_frame(&frame, &text, &size);
		assert_ok(rb_wire_read_frame(&back, BODIES, text, size, &err));
		assert_int_equal(back.index, frame.index);
		assert_near(back.time_s, frame.time_s, 0);
		assert_memory_equal(&back.numbers, &frame.numbers, sizeof frame.numbers);
		assert_true(!back.position == !frame.position);
		assert_true(!back.orientation == !frame.orientation);
		assert_true(!back.velocity == !frame.velocity);
		assert_true(!back.angular_velocity == !frame.angular_velocity);
		for (int i = 0; i < 3 * BODIES; i++) {
			if (frame.position)
				assert_near(back.position[i], frame.position[i], 0);
			if (frame.velocity)
				assert_near(back.velocity[i], (double)(float)frame.velocity[i], 0);
		}
		rb_memory_free(text);
		rb_frame_release(&frame);
	}
	rb_frame_release(&back);
}

static void what_single_precision_does_not_hold_is_as_far_away_as_it_goes(void **state)
{
	struct rb_frame frame = frame_of(1, 0, RB_FIELD_POSITION), back = {0};
	struct rb_error err;
	char *text;
	size_t size;

	(void)state;
	frame.position[0] = 1e200;
	frame.position[1] = -(double)INFINITY;
	frame.position[2] = 1e-300;
	frame.numbers.kinetic_energy = (double)INFINITY;
	write_frame(&frame, &text, &size);
	assert_ok(rb_wire_read_frame(&back, 1, text, size, &err));
	assert_near(back.position[0], (double)FLT_MAX, 0);
	assert_near(back.position[1], -(double)FLT_MAX, 0);
	assert_near(back.position[2], 0, 0);
	assert_true(isinf(back.numbers.kinetic_energy));
	rb_memory_free(text);
	rb_frame_release(&frame);
	rb_frame_release(&back);
}

/* Among these is one that fills the block it was given to the last byte, and one that just fits no more. */
static void frames_of_any_size_come_back(void **state)
{
	(void)state;
	for (int bodies = 1; bodies <= 300; bodies++) {
		struct rb_frame frame = frame_of(bodies, RB_FEATURE_ROTATION, RB_FIELD_POSITION),
				back = {0};
		struct rb_error err;
		char *text;
		size_t size;

		write_frame(&frame, &text, &size);
		assert_ok(rb_wire_read_frame(&back, bodies, text, size, &err));
		for (int i = 0; i < 3 * bodies; i++)
			assert_near(back.position[i], frame.position[i], 0);
		rb_memory_free(text);
		rb_frame_release(&frame);
		rb_frame_release(&back);
	}
}

static void a_frame_of_nothing_is_a_frame(void **state)
{
	struct rb_frame frame = frame_of(0, 0, RB_FIELD_DEFAULT), back = {0};
	struct rb_error err;
	char *text;
	size_t size;

	(void)state;
	write_frame(&frame, &text, &size);
	assert_ok(rb_wire_read_frame(&back, 0, text, size, &err));
	assert_int_equal(back.body_count, 0);
	rb_memory_free(text);
	rb_frame_release(&frame);
	rb_frame_release(&back);
}

static void no_line_that_was_cut_or_changed_in_its_structure_is_taken(void **state)
{
	struct rb_frame frame = frame_of(BODIES, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT), back = {0};
	char *text;
	size_t size;

	(void)state;
	write_frame(&frame, &text, &size);
	for (size_t cut = 0; cut < size; cut++)
		assert_int_equal(rb_wire_read_frame(&back, BODIES, text, cut, NULL), RB_ERR_INPUT);
	assert_int_equal(rb_wire_read_frame(&back, BODIES + 1, text, size, NULL), RB_ERR_INPUT);
	assert_int_equal(rb_wire_read_frame(&back, -1, text, size, NULL), RB_ERR_INPUT);
	/* none of these bytes may stand anywhere in it */
	static const char bytes[] = {'\0', '\n', '\x1b', '*', '\xff', '\t'};
	for (size_t i = 0; i < size; i++) {
		const char before = text[i];
		for (size_t k = 0; k < sizeof bytes; k++) {
			text[i] = bytes[k];
			assert_int_equal(rb_wire_read_frame(&back, BODIES, text, size, NULL),
			                 RB_ERR_INPUT);
		}
		text[i] = before;
	}
	assert_int_equal(rb_wire_read_frame(&back, BODIES, text, size, NULL), RB_OK);
	rb_memory_free(text);
	rb_frame_release(&frame);
	rb_frame_release(&back);
}

static void a_pose_that_is_not_finite_is_refused(void **state)
{
	struct rb_frame frame = frame_of(1, 0, RB_FIELD_POSITION), back = {0};
	static const unsigned char infinite[12] = {0, 0, 0x80, 0x7f};
	char *text;
	size_t size;

	(void)state;
	write_frame(&frame, &text, &size);
	rb_wire_base64_write(text + size - 16, infinite, sizeof infinite);
	assert_int_equal(rb_wire_read_frame(&back, 1, text, size, NULL), RB_ERR_INPUT);
	rb_memory_free(text);
	rb_frame_release(&frame);
	rb_frame_release(&back);
}

static void memory_that_is_out_is_told(void **state)
{
	struct rb_frame frame = frame_of(BODIES, RB_FEATURE_ROTATION, RB_FIELD_DEFAULT), back = {0};
	char *text;
	size_t size, capacity = 0;
	enum rb_status status = RB_ERR_MEMORY;

	(void)state;
	write_frame(&frame, &text, &size);
	for (uint64_t k = 1; status == RB_ERR_MEMORY; k++) {
		rb_memory_fail_at(k);
		status = rb_wire_read_frame(&back, BODIES, text, size, NULL);
		rb_memory_fail_at(0);
		rb_frame_release(&back);
		assert_true(status == RB_ERR_MEMORY || (status == RB_OK && k > 4));
	}
	rb_memory_free(text);
	text = NULL;
	rb_memory_fail_at(1);
	assert_int_equal(rb_wire_write_frame(&text, &capacity, &size, &frame, NULL), RB_ERR_MEMORY);
	rb_memory_fail_at(0);
	rb_memory_free(text);
	rb_frame_release(&frame);
	rb_frame_release(&back);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(base64_is_that_of_the_standard),
		cmocka_unit_test(a_frame_comes_back_as_single_precision_and_its_numbers_in_full),
		cmocka_unit_test(what_single_precision_does_not_hold_is_as_far_away_as_it_goes),
		cmocka_unit_test(frames_of_any_size_come_back),
		cmocka_unit_test(a_frame_of_nothing_is_a_frame),
		cmocka_unit_test(no_line_that_was_cut_or_changed_in_its_structure_is_taken),
		cmocka_unit_test(a_pose_that_is_not_finite_is_refused),
		cmocka_unit_test(memory_that_is_out_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
