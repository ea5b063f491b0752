/* SPDX-License-Identifier: MIT */
/* src/flow/pump.c */
#include "support.h"

#include "flow/pump.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <time.h>

/* A sink that notes its calls and fails where it is told to. */
struct notes {
	enum rb_status open_gives, frame_gives, close_gives;
	uint64_t fail_at; /* the frame at which frame_gives counts */
	long open_ms;
	uint64_t frames;
	atomic_int idles, closes;
	atomic_int opened;
	enum rb_status closed_as;
	char closed_why[64];
	pthread_t thread;
	bool one_thread, signals_blocked;
};

static enum rb_status fake_open(void *self, struct rb_error *err)
{
	struct notes *notes = self;
	sigset_t mask;
	const struct timespec wait = {0, notes->open_ms * 1000000};

	nanosleep(&wait, NULL);
	notes->thread = pthread_self();
	notes->one_thread = true;
	pthread_sigmask(SIG_BLOCK, NULL, &mask);
	notes->signals_blocked = sigismember(&mask, SIGINT) && sigismember(&mask, SIGTERM) &&
	                         sigismember(&mask, SIGUSR1);
	atomic_store(&notes->opened, 1);
	if (notes->open_gives)
		return RB_FAIL(err, notes->open_gives, "cannot open 'it'");
	return RB_OK;
}

static enum rb_status fake_frame(void *self, const struct rb_frame *frame, struct rb_error *err)
{
	struct notes *notes = self;

	notes->one_thread &= pthread_equal(notes->thread, pthread_self()) != 0;
	if (notes->frame_gives && frame->index == notes->fail_at)
		return RB_FAIL(err, notes->frame_gives, "cannot write 'it'");
	notes->frames++;
	return RB_OK;
}

static enum rb_status fake_idle(void *self, struct rb_error *err)
{
	struct notes *notes = self;

	(void)err;
	atomic_fetch_add(&notes->idles, 1);
	return RB_OK;
}

static enum rb_status fake_close(void *self, const struct rb_outcome *outcome, struct rb_error *err)
{
	struct notes *notes = self;

	notes->one_thread &= pthread_equal(notes->thread, pthread_self()) != 0;
	notes->closed_as = outcome->status;
	snprintf(notes->closed_why, sizeof notes->closed_why, "%s", outcome->reason);
	atomic_fetch_add(&notes->closes, 1);
	if (notes->close_gives)
		return RB_FAIL(err, notes->close_gives, "cannot close 'it'");
	return RB_OK;
}

static struct rb_sink sink_of(struct notes *notes, bool essential)
{
	return (struct rb_sink){
		.name = "notes",
		.lossless = true,
		.essential = essential,
		.self = notes,
		.open = fake_open,
		.frame = fake_frame,
		.idle = fake_idle,
		.close = fake_close,
	};
}

static const struct rb_model model = {.body_count = 2};

static struct rb_ring *ring_of_four(void)
{
	struct rb_ring *ring;

	assert_int_equal(rb_ring_create(&ring, &model, RB_FIELD_POSITION, 4, NULL), RB_OK);
	return ring;
}

static void produce(struct rb_ring *ring, uint64_t count)
{
	for (uint64_t k = 0; k < count; k++) {
		struct rb_frame *frame = rb_ring_acquire(ring);
		assert_non_null(frame);
		frame->index = k;
		rb_ring_publish(ring);
	}
}

static void a_sink_gets_all_frames_and_then_the_outcome(void **state)
{
	struct notes notes = {0};
	struct rb_outcome outcome = {.reason = ""};
	struct rb_ring *ring = ring_of_four();
	const struct rb_sink sink = sink_of(&notes, true);
	struct rb_pump *pump;

	(void)state;
	assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, NULL), RB_OK);
	produce(ring, 100);
	outcome = (struct rb_outcome){.status = RB_ERR_INTERRUPT, .reason = "by a test"};
	rb_ring_close(ring);
	assert_int_equal(rb_pump_join(pump, NULL), RB_OK);
	assert_int_equal(notes.frames, 100);
	assert_int_equal(notes.closes, 1);
	assert_int_equal(notes.closed_as, RB_ERR_INTERRUPT);
	assert_string_equal(notes.closed_why, "by a test");
	assert_true(notes.one_thread);
	assert_true(notes.signals_blocked);
	rb_ring_destroy(ring);
}

static void the_sink_is_open_before_the_first_frame_is_made(void **state)
{
	struct notes notes = {.open_ms = 50};
	const struct rb_outcome outcome = {.reason = ""};
	struct rb_ring *ring = ring_of_four();
	const struct rb_sink sink = sink_of(&notes, true);
	struct rb_pump *pump;

	(void)state;
	assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, NULL), RB_OK);
	assert_int_equal(atomic_load(&notes.opened), 1);
	rb_ring_close(ring);
	assert_int_equal(rb_pump_join(pump, NULL), RB_OK);
	rb_ring_destroy(ring);
}

static void a_sink_that_cannot_be_opened_is_told_at_once_and_not_closed(void **state)
{
	struct notes notes = {.open_gives = RB_ERR_CREATE};
	const struct rb_outcome outcome = {.reason = ""};
	struct rb_ring *ring = ring_of_four();
	const struct rb_sink sink = sink_of(&notes, true);
	struct rb_pump *pump;
	struct rb_error err;

	(void)state;
	assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, &err), RB_ERR_CREATE);
	assert_null(pump);
	assert_string_equal(err.text, "cannot open 'it'");
	assert_int_equal(notes.closes, 0);
	produce(ring, 100); /* would hang if the ring still waited for the sink */
	rb_ring_destroy(ring);
}

static void a_failing_sink_is_closed_as_failed_and_holds_nobody_back(void **state)
{
	for (int essential = 0; essential < 2; essential++) {
		struct notes notes = {.frame_gives = RB_ERR_IO, .fail_at = 10};
		const struct rb_outcome outcome = {.reason = ""};
		struct rb_ring *ring = ring_of_four();
		const struct rb_sink sink = sink_of(&notes, essential);
		struct rb_pump *pump;
		struct rb_error err;

		(void)state;
		assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, NULL), RB_OK);
		produce(ring, 100);
		assert_true(rb_pump_must_stop(pump) == essential);
		rb_ring_close(ring);
		assert_int_equal(rb_pump_join(pump, &err), RB_ERR_IO);
		assert_string_equal(err.text, "cannot write 'it'");
		assert_int_equal(notes.frames, 10);
		assert_int_equal(notes.closes, 1);
		assert_int_equal(notes.closed_as, RB_ERR_IO);
		assert_string_equal(notes.closed_why, "cannot write 'it'");
		rb_ring_destroy(ring);
	}
}

static void a_failure_to_close_is_told_by_join(void **state)
{
	struct notes notes = {.close_gives = RB_ERR_IO};
	const struct rb_outcome outcome = {.reason = ""};
	struct rb_ring *ring = ring_of_four();
	const struct rb_sink sink = sink_of(&notes, true);
	struct rb_pump *pump;
	struct rb_error err;

	(void)state;
	assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, NULL), RB_OK);
	produce(ring, 3);
	rb_ring_close(ring);
	assert_int_equal(rb_pump_join(pump, &err), RB_ERR_IO);
	assert_string_equal(err.text, "cannot close 'it'");
	assert_int_equal(notes.frames, 3);
	rb_ring_destroy(ring);
}

static void a_sink_without_frames_is_given_time_to_flush(void **state)
{
	struct notes notes = {0};
	const struct rb_outcome outcome = {.reason = ""};
	struct rb_ring *ring = ring_of_four();
	const struct rb_sink sink = sink_of(&notes, true);
	const struct timespec step = {0, 20000000};
	struct rb_pump *pump;

	(void)state;
	assert_int_equal(rb_pump_start(&pump, ring, &sink, &outcome, NULL), RB_OK);
	while (atomic_load(&notes.idles) < 2)
		nanosleep(&step, NULL);
	rb_ring_close(ring);
	assert_int_equal(rb_pump_join(pump, NULL), RB_OK);
	rb_ring_destroy(ring);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sink_gets_all_frames_and_then_the_outcome),
		cmocka_unit_test(the_sink_is_open_before_the_first_frame_is_made),
		cmocka_unit_test(a_sink_that_cannot_be_opened_is_told_at_once_and_not_closed),
		cmocka_unit_test(a_failing_sink_is_closed_as_failed_and_holds_nobody_back),
		cmocka_unit_test(a_failure_to_close_is_told_by_join),
		cmocka_unit_test(a_sink_without_frames_is_given_time_to_flush),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
