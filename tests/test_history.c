/* SPDX-License-Identifier: MIT */
/* src/control/history.c: the last frames of a run, of any number, copied by any thread */
#include "support.h"

#include <pthread.h>
#include <stdatomic.h>

#include "control/history.h"
#include "flow/frame.h"

/* Body i of frame k is at (k, i, -k). */
static void fill(struct rb_frame *frame, uint64_t k)
{
	frame->index = k;
	frame->time_s = (double)k / 8;
	frame->numbers.kinetic_energy = 2 * (double)k;
	for (int i = 0; i < frame->body_count; i++) {
		frame->position[3 * i] = (double)k;
		frame->position[3 * i + 1] = i;
		frame->position[3 * i + 2] = -(double)k;
		frame->velocity[3 * i] = (double)k / 2;
	}
}

static bool is_frame(const struct rb_frame *frame, uint64_t k, int bodies)
{
	bool right = frame->index == k && frame->time_s == (double)k / 8 &&
	             frame->body_count == bodies && frame->numbers.kinetic_energy == 2 * (double)k;

	for (int i = 0; right && i < bodies; i++)
		right = frame->position[3 * i] == (double)k && frame->position[3 * i + 1] == i &&
		        frame->position[3 * i + 2] == -(double)k &&
		        frame->velocity[3 * i] == (double)k / 2;
	return right;
}

struct stage {
	struct rb_model model;
	struct rb_history *history;
	struct rb_frame frame, copy;
	struct rb_error err;
};

static void open_stage(struct stage *stage, int bodies)
{
	*stage = (struct stage){.model = {.body_count = bodies}};
	if (rb_history_create(&stage->history, &stage->model, &stage->err) ||
	    rb_frame_init(&stage->frame, &stage->model,
	                  RB_HISTORY_FIELDS | RB_FIELD_EVENTS | RB_FIELD_CONTACTS, &stage->err))
		fail_msg("%s", stage->err.text);
}

static void keep(struct stage *stage, uint64_t k)
{
	fill(&stage->frame, k);
	if (rb_history_keep(stage->history, &stage->frame, &stage->err) != RB_OK)
		fail_msg("frame %d: %s", (int)k, stage->err.text);
}

static void close_stage(struct stage *stage)
{
	rb_history_destroy(stage->history);
	rb_history_destroy(NULL);
	rb_frame_release(&stage->frame);
	rb_frame_release(&stage->copy);
}

static void assert_kept(struct stage *stage, uint64_t index, uint64_t is)
{
	if (rb_history_copy(stage->history, index, &stage->copy, &stage->err) != RB_OK)
		fail_msg("%s", stage->err.text);
	assert_true(is_frame(&stage->copy, is, stage->model.body_count));
}

static void the_last_six_hundred_frames_are_kept(void **state)
{
	struct stage stage;
	uint64_t first = 7, last = 7;

	(void)state;
	open_stage(&stage, 2);
	assert_false(rb_history_range(stage.history, &first, &last));
	assert_int_equal(rb_history_copy(stage.history, RB_HISTORY_NEWEST, &stage.copy, &stage.err),
	                 RB_ERR_INPUT);
	assert_string_equal(stage.err.text, "there is no frame yet");
	for (uint64_t k = 0; k < 1500; k++) {
		keep(&stage, k);
		assert_true(rb_history_range(stage.history, &first, &last));
		assert_int_equal(last, k);
		assert_int_equal(first, k < 600 ? 0 : k - 599);
		if (k % 37 != 0)
			continue;
		assert_kept(&stage, RB_HISTORY_NEWEST, k);
		assert_kept(&stage, first, first);
		assert_kept(&stage, (first + last) / 2, (first + last) / 2);
	}
	static const uint64_t none[] = {0, 899, 1500, UINT64_MAX - 1};
	for (int i = 0; i < 4; i++)
		assert_int_equal(rb_history_copy(stage.history, none[i], &stage.copy, &stage.err),
		                 RB_ERR_INPUT);
	assert_int_equal(rb_history_copy(stage.history, 899, &stage.copy, &stage.err),
	                 RB_ERR_INPUT);
	assert_string_equal(stage.err.text, "frame 899 is not kept, wanted one from 900 to 1499");
	close_stage(&stage);
}

/* 48 bytes a body: of 500,000 bodies two frames in 64 MiB, of more one at least. */
static void of_many_bodies_as_many_frames_as_fit(void **state)
{
	static const struct {
		int bodies;
		uint64_t frames;
	} cases[] = {{500000, 2}, {1400000, 1}};

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct stage stage;
		uint64_t first, last;

		open_stage(&stage, cases[i].bodies);
		for (uint64_t k = 0; k < 4; k++)
			keep(&stage, k);
		assert_true(rb_history_range(stage.history, &first, &last));
		assert_int_equal(last, 3);
		assert_int_equal(first, 4 - cases[i].frames);
		assert_kept(&stage, RB_HISTORY_NEWEST, 3);
		close_stage(&stage);
	}
}

/* Their number has no bound. */
static void events_and_contacts_are_not_kept(void **state)
{
	struct stage stage;

	(void)state;
	open_stage(&stage, 1);
	stage.frame.event_count = 3;
	stage.frame.contact_count = 2;
	keep(&stage, 0);
	assert_int_equal(stage.frame.event_count, 3);
	assert_non_null(stage.frame.events);
	assert_kept(&stage, 0, 0);
	assert_int_equal(stage.copy.event_count + stage.copy.contact_count, 0);
	close_stage(&stage);
}

static void a_frame_that_was_lost_is_not_given_out(void **state)
{
	struct stage stage;
	uint64_t first, last;

	(void)state;
	open_stage(&stage, 100);
	for (uint64_t k = 0; k < 5; k++)
		keep(&stage, k);
	fill(&stage.frame, 5);
	rb_memory_fail_at(1);
	const enum rb_status status = rb_history_keep(stage.history, &stage.frame, &stage.err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_false(rb_history_range(stage.history, &first, &last));
	assert_int_equal(rb_history_copy(stage.history, 4, &stage.copy, &stage.err), RB_ERR_INPUT);
	keep(&stage, 6);
	assert_true(rb_history_range(stage.history, &first, &last));
	assert_true(first == 6 && last == 6);
	assert_kept(&stage, RB_HISTORY_NEWEST, 6);
	assert_int_equal(rb_history_copy(stage.history, 5, &stage.copy, &stage.err), RB_ERR_INPUT);
	close_stage(&stage);
	rb_memory_fail_at(1);
	const enum rb_status made = rb_history_create(&stage.history, &stage.model, &stage.err);
	rb_memory_fail_at(0);
	assert_int_equal(made, RB_ERR_MEMORY);
	assert_null(stage.history);
}

struct reader {
	struct stage *stage;
	atomic_bool done;
	int copies, wrong;
};

static void *copy_frames(void *user)
{
	struct reader *reader = user;
	struct rb_frame copy = {0};

	while (!atomic_load(&reader->done) || reader->copies == 0) {
		if (rb_history_copy(reader->stage->history, RB_HISTORY_NEWEST, &copy, NULL) !=
		    RB_OK)
			continue;
		reader->copies++;
		reader->wrong += !is_frame(&copy, copy.index, 50);
	}
	rb_frame_release(&copy);
	return NULL;
}

/* A copy is of one frame, while others come. */
static void copies_are_whole_whatever_comes_meanwhile(void **state)
{
	struct stage stage;
	struct reader readers[2];
	pthread_t threads[2];

	(void)state;
	open_stage(&stage, 50);
	for (int i = 0; i < 2; i++) {
		readers[i] = (struct reader){.stage = &stage};
		assert_int_equal(pthread_create(&threads[i], NULL, copy_frames, &readers[i]), 0);
	}
	for (uint64_t k = 0; k < 5000; k++)
		keep(&stage, k);
	for (int i = 0; i < 2; i++) {
		atomic_store(&readers[i].done, true);
		pthread_join(threads[i], NULL);
		assert_true(readers[i].copies > 0);
		assert_int_equal(readers[i].wrong, 0);
	}
	close_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_last_six_hundred_frames_are_kept),
		cmocka_unit_test(of_many_bodies_as_many_frames_as_fit),
		cmocka_unit_test(events_and_contacts_are_not_kept),
		cmocka_unit_test(a_frame_that_was_lost_is_not_given_out),
		cmocka_unit_test(copies_are_whole_whatever_comes_meanwhile),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
