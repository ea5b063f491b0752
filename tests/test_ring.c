/* SPDX-License-Identifier: MIT */
/* src/flow/ring.c, src/flow/frame.c */
#include "support.h"

#include "base/memory.h"
#include "flow/frame.h"
#include "flow/ring.h"

#include <pthread.h>
#include <time.h>

enum { FRAMES = 2000 };

static struct rb_model model_of(int body_count, rb_features features)
{
	return (struct rb_model){.body_count = body_count, .features = features};
}

static void sleep_ms(long ms)
{
	const struct timespec wait = {ms / 1000, ms % 1000 * 1000000};

	nanosleep(&wait, NULL);
}

static struct rb_ring *ring_of(const struct rb_model *model, int slots)
{
	struct rb_ring *ring;

	assert_int_equal(rb_ring_create(&ring, model, RB_FIELD_DEFAULT, slots, NULL), RB_OK);
	return ring;
}

static void a_frame_has_no_column_that_the_scene_cannot_change_or_nobody_wants(void **state)
{
	const struct rb_model turning = model_of(3, RB_FEATURE_ROTATION), plain = model_of(3, 0);
	struct rb_frame frame;

	(void)state;
	assert_int_equal(rb_frame_init(&frame, &turning, RB_FIELD_DEFAULT, NULL), RB_OK);
	assert_non_null(frame.position);
	assert_non_null(frame.orientation);
	assert_non_null(frame.angular_velocity);
	assert_null(frame.events);
	rb_frame_release(&frame);

	assert_int_equal(rb_frame_init(&frame, &plain, RB_FIELD_DEFAULT | RB_FIELD_EVENTS, NULL),
	                 RB_OK);
	assert_non_null(frame.velocity);
	assert_null(frame.orientation);
	assert_null(frame.angular_velocity);
	assert_non_null(frame.events);
	assert_true(frame.event_capacity > 0);
	rb_frame_release(&frame);
	assert_null(frame.position);

	assert_int_equal(rb_frame_init(&frame, &turning, 0, NULL), RB_OK);
	assert_null(frame.position);
	rb_frame_release(&frame);
	rb_frame_release(&frame); /* safe twice */

	assert_int_equal(rb_frame_bytes(&turning, RB_FIELD_DEFAULT), 3 * 13 * sizeof(double));
	assert_int_equal(rb_frame_bytes(&plain, RB_FIELD_DEFAULT), 3 * 6 * sizeof(double));
}

static void slots_follow_the_bytes_of_a_frame(void **state)
{
	const struct rb_model small = model_of(1, 0), medium = model_of(10000, RB_FEATURE_ROTATION),
			      large = model_of(10000000, RB_FEATURE_ROTATION);
	const int slots = rb_ring_slots_for(&medium, RB_FIELD_DEFAULT);

	(void)state;
	assert_int_equal(rb_ring_slots_for(&small, RB_FIELD_DEFAULT), RB_RING_SLOTS_MAX);
	assert_int_equal(rb_ring_slots_for(&large, RB_FIELD_DEFAULT), RB_RING_SLOTS_MIN);
	assert_true((size_t)slots * rb_frame_bytes(&medium, RB_FIELD_DEFAULT) <= 4u << 20);
	assert_true((size_t)(slots + 1) * rb_frame_bytes(&medium, RB_FIELD_DEFAULT) > 4u << 20);
}

/* A consumer on a thread of its own that notes what it sees. */
struct reader {
	struct rb_ring *ring;
	int consumer;
	long pause_ms, pause_every;
	uint64_t seen, last;
	bool in_order, whole;
	pthread_t thread;
};

static void *read_all(void *argument)
{
	struct reader *reader = argument;
	const struct rb_frame *frame;

	reader->in_order = reader->whole = true;
	for (;;) {
		const enum rb_ring_news news = rb_ring_wait(reader->ring, reader->consumer, 10,
		                                            &frame);
		if (news != RB_RING_FRAME)
			return NULL;
		reader->in_order &= reader->seen == 0 || frame->index > reader->last;
		if (reader->pause_every && frame->index % (uint64_t)reader->pause_every == 0)
			sleep_ms(reader->pause_ms);
		/* after the pause: the producer must not have written into it */
		for (int i = 0; i < 3 * frame->body_count; i++)
			reader->whole &= frame->position[i] == (double)frame->index;
		reader->last = frame->index;
		reader->seen++;
		rb_ring_give_back(reader->ring, reader->consumer);
	}
}

static void start(struct reader *reader, struct rb_ring *ring, bool lossless)
{
	reader->ring = ring;
	assert_int_equal(rb_ring_add_consumer(ring, lossless, &reader->consumer, NULL), RB_OK);
	assert_int_equal(pthread_create(&reader->thread, NULL, read_all, reader), 0);
}

static bool produce(struct rb_ring *ring, uint64_t index)
{
	struct rb_frame *frame = rb_ring_acquire(ring);

	if (!frame)
		return false;
	frame->index = index;
	for (int i = 0; i < 3 * frame->body_count; i++)
		frame->position[i] = (double)index;
	rb_ring_publish(ring);
	return true;
}

static void lossless_consumers_see_every_frame_in_order(void **state)
{
	const struct rb_model model = model_of(5, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	struct reader fast = {0}, slow = {.pause_ms = 1, .pause_every = 40};

	(void)state;
	start(&fast, ring, true);
	start(&slow, ring, true);
	for (uint64_t k = 0; k < FRAMES; k++)
		assert_true(produce(ring, k));
	rb_ring_close(ring);
	pthread_join(fast.thread, NULL);
	pthread_join(slow.thread, NULL);
	assert_int_equal(fast.seen, FRAMES);
	assert_int_equal(slow.seen, FRAMES);
	assert_true(fast.in_order && fast.whole && slow.in_order && slow.whole);
	rb_ring_destroy(ring);
}

static void a_lossless_consumer_holds_the_producer_back(void **state)
{
	const struct rb_model model = model_of(1, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	struct reader stuck = {.pause_ms = 200, .pause_every = FRAMES};
	struct timespec before, after;

	(void)state;
	start(&stuck, ring, true); /* sleeps at frame 0 */
	clock_gettime(CLOCK_MONOTONIC, &before);
	for (uint64_t k = 0; k < 5; k++)
		assert_true(produce(ring, k));
	clock_gettime(CLOCK_MONOTONIC, &after);
	const double waited = (double)(after.tv_sec - before.tv_sec) +
	                      1e-9 * (double)(after.tv_nsec - before.tv_nsec);
	assert_true(waited > 0.1);
	rb_ring_close(ring);
	pthread_join(stuck.thread, NULL);
	assert_int_equal(stuck.seen, 5);
	rb_ring_destroy(ring);
}

static void a_viewer_takes_the_newest_and_never_holds_the_producer_back(void **state)
{
	const struct rb_model model = model_of(1, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	const struct rb_frame *frame;
	int viewer;

	(void)state;
	assert_int_equal(rb_ring_add_consumer(ring, false, &viewer, NULL), RB_OK);
	assert_true(produce(ring, 0));
	assert_int_equal(rb_ring_wait(ring, viewer, 1, &frame), RB_RING_FRAME);
	/* All on one thread: were the producer held back, this would hang. */
	for (uint64_t k = 1; k < 100; k++)
		assert_true(produce(ring, k));
	assert_int_equal(frame->index, 0);
	assert_near(frame->position[0], 0, 0);
	rb_ring_give_back(ring, viewer);
	assert_int_equal(rb_ring_wait(ring, viewer, 1, &frame), RB_RING_FRAME);
	assert_int_equal(frame->index, 99);
	rb_ring_give_back(ring, viewer);
	assert_int_equal(rb_ring_wait(ring, viewer, 0.01, &frame), RB_RING_IDLE);
	rb_ring_close(ring);
	assert_int_equal(rb_ring_wait(ring, viewer, 0.01, &frame), RB_RING_CLOSED);
	rb_ring_destroy(ring);
}

static void viewers_and_a_recorder_read_whole_frames_side_by_side(void **state)
{
	const struct rb_model model = model_of(7, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	struct reader recorder = {0}, viewer[2] = {{.pause_ms = 2, .pause_every = 1},
	                                           {.pause_ms = 5, .pause_every = 1}};

	(void)state;
	start(&viewer[0], ring, false);
	start(&recorder, ring, true);
	start(&viewer[1], ring, false);
	for (uint64_t k = 0; k < FRAMES; k++)
		assert_true(produce(ring, k));
	rb_ring_close(ring);
	pthread_join(recorder.thread, NULL);
	assert_int_equal(recorder.seen, FRAMES);
	assert_true(recorder.whole);
	for (int i = 0; i < 2; i++) {
		pthread_join(viewer[i].thread, NULL);
		assert_true(viewer[i].in_order && viewer[i].whole);
		assert_int_equal(viewer[i].last, FRAMES - 1);
	}
	rb_ring_destroy(ring);
}

static void a_closed_ring_is_read_to_its_end(void **state)
{
	const struct rb_model model = model_of(1, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	const struct rb_frame *frame;
	int consumer;

	(void)state;
	assert_int_equal(rb_ring_add_consumer(ring, true, &consumer, NULL), RB_OK);
	assert_true(produce(ring, 0));
	assert_true(produce(ring, 1));
	rb_ring_close(ring);
	for (uint64_t k = 0; k < 2; k++) {
		assert_int_equal(rb_ring_wait(ring, consumer, 0, &frame), RB_RING_FRAME);
		assert_int_equal(frame->index, k);
		rb_ring_give_back(ring, consumer);
	}
	assert_int_equal(rb_ring_wait(ring, consumer, 0, &frame), RB_RING_CLOSED);
	rb_ring_destroy(ring);
}

/* Frames that a consumer has not given back stay as they are, and lie one after another. */
static void a_consumer_may_keep_half_of_the_slots(void **state)
{
	enum { SLOTS = 6, BODIES = 3, ROUNDS = 20 };
	const struct rb_model model = model_of(BODIES, 0);
	struct rb_ring *ring = ring_of(&model, SLOTS);
	const struct rb_frame *kept[SLOTS / 2];
	int consumer, slots, most = rb_ring_keep_most(ring);
	uint64_t made = 0;

	(void)state;
	assert_int_equal(most, SLOTS / 2);
	assert_int_equal(rb_ring_add_consumer(ring, true, &consumer, NULL), RB_OK);
	for (int round = 0; round < ROUNDS; round++) {
		while (rb_ring_used(ring, &slots) < SLOTS) {
			struct rb_frame *const frame = rb_ring_acquire(ring);

			frame->index = made++;
			for (int i = 0; i < 3 * BODIES; i++)
				frame->velocity[i] = (double)frame->index;
			rb_ring_publish(ring);
		}
		for (int k = 0; k < most; k++)
			assert_int_equal(rb_ring_wait(ring, consumer, 0, &kept[k]), RB_RING_FRAME);
		for (int k = 0; k < most; k++) {
			const uint64_t index = (uint64_t)round * (uint64_t)most + (uint64_t)k;

			assert_int_equal(kept[k]->index, index);
			assert_true(kept[k]->velocity[3 * BODIES - 1] == (double)index);
			if (index % SLOTS != 0 && k > 0)
				assert_true(kept[k]->velocity ==
				            kept[k - 1]->velocity + 3 * (size_t)BODIES);
		}
		for (int k = 0; k < most; k++)
			rb_ring_give_back(ring, consumer);
	}
	rb_ring_destroy(ring);
}

/* When the producer has filled the ring, and may be waiting already. */
static void *abort_later(void *ring)
{
	int slots = 1;

	while (rb_ring_used(ring, &slots) < slots)
		sleep_ms(1);
	sleep_ms(20);
	rb_ring_abort(ring);
	return NULL;
}

static void an_abort_wakes_a_producer_that_waits(void **state)
{
	const struct rb_model model = model_of(1, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	const struct rb_frame *frame;
	pthread_t thread;
	int consumer;

	(void)state;
	assert_int_equal(rb_ring_add_consumer(ring, true, &consumer, NULL), RB_OK);
	assert_int_equal(pthread_create(&thread, NULL, abort_later, ring), 0);
	uint64_t k = 0;
	while (produce(ring, k))
		k++;
	assert_int_equal(k, 4);
	pthread_join(thread, NULL);
	assert_int_equal(rb_ring_wait(ring, consumer, 0, &frame), RB_RING_CLOSED);
	rb_ring_destroy(ring);
}

static void *detach_later(void *argument)
{
	const struct reader *reader = argument;

	sleep_ms(50);
	rb_ring_detach(reader->ring, reader->consumer);
	return NULL;
}

static void nobody_waits_for_a_consumer_that_has_detached(void **state)
{
	const struct rb_model model = model_of(1, 0);
	struct rb_ring *ring = ring_of(&model, 4);
	struct reader reader = {.ring = ring};

	(void)state;
	assert_int_equal(rb_ring_add_consumer(ring, true, &reader.consumer, NULL), RB_OK);
	assert_int_equal(pthread_create(&reader.thread, NULL, detach_later, &reader), 0);
	for (uint64_t k = 0; k < 100; k++)
		assert_true(produce(ring, k));
	pthread_join(reader.thread, NULL);
	rb_ring_destroy(ring);
}

static void no_allocation_is_made_once_the_ring_stands(void **state)
{
	const struct rb_model model = model_of(9, RB_FEATURE_ROTATION);
	struct rb_ring *ring = ring_of(&model, 8);
	struct reader reader = {0};

	(void)state;
	start(&reader, ring, true);
	const uint64_t before = rb_memory_counts().taken;
	for (uint64_t k = 0; k < FRAMES; k++)
		assert_true(produce(ring, k));
	rb_ring_close(ring);
	pthread_join(reader.thread, NULL);
	assert_int_equal(rb_memory_counts().taken, before);
	rb_ring_destroy(ring);
}

static void every_allocation_of_a_ring_may_fail(void **state)
{
	const struct rb_model model = model_of(2, RB_FEATURE_ROTATION);
	const uint64_t bytes = rb_memory_counts().bytes_now;
	enum rb_status status = RB_ERR_MEMORY;
	int failures = 0;

	(void)state;
	for (uint64_t k = 1; status == RB_ERR_MEMORY; k++) {
		struct rb_ring *ring;
		struct rb_error err = {0};
		int consumer;
		rb_memory_fail_at(k);
		status = rb_ring_create(&ring, &model, RB_FIELD_DEFAULT | RB_FIELD_EVENTS, 4, &err);
		if (!status)
			status = rb_ring_add_consumer(ring, false, &consumer, &err);
		rb_memory_fail_at(0);
		if (status) {
			failures++;
			assert_int_equal(err.status, RB_ERR_MEMORY);
			assert_non_null(strstr(err.text, "out of memory"));
		}
		rb_ring_destroy(ring);
		assert_int_equal(rb_memory_counts().bytes_now, bytes);
	}
	assert_int_equal(status, RB_OK);
	assert_true(failures >= 5);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			a_frame_has_no_column_that_the_scene_cannot_change_or_nobody_wants),
		cmocka_unit_test(slots_follow_the_bytes_of_a_frame),
		cmocka_unit_test(lossless_consumers_see_every_frame_in_order),
		cmocka_unit_test(a_lossless_consumer_holds_the_producer_back),
		cmocka_unit_test(a_viewer_takes_the_newest_and_never_holds_the_producer_back),
		cmocka_unit_test(viewers_and_a_recorder_read_whole_frames_side_by_side),
		cmocka_unit_test(a_closed_ring_is_read_to_its_end),
		cmocka_unit_test(a_consumer_may_keep_half_of_the_slots),
		cmocka_unit_test(an_abort_wakes_a_producer_that_waits),
		cmocka_unit_test(nobody_waits_for_a_consumer_that_has_detached),
		cmocka_unit_test(no_allocation_is_made_once_the_ring_stands),
		cmocka_unit_test(every_allocation_of_a_ring_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
