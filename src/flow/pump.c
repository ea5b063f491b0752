/* SPDX-License-Identifier: MIT */
/*
 * A sink knows nothing of threads: the pump gives it one and calls it in order. Two flags pass
 * between the threads, both one way: `opened`, so that rb_pump_start returns only when the output
 * exists, and `must_stop`, which the producer asks for after each frame. Everything else becomes
 * visible to the owner by pthread_join.
 */
#include "flow/pump.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/thread.h"

/*
 * s: how often a sink may work when nothing comes (flush, show progress): a quarter of a second is
 * not felt as a delay and costs four wake-ups a second.
 */
static const double idle_s = 0.25;

struct rb_pump {
	/* set before the thread starts, then only read */
	struct rb_sink sink;
	struct rb_ring *ring;
	int consumer;
	const struct rb_outcome *outcome;
	pthread_t thread;

	/* protected by lock */
	pthread_mutex_t lock;
	pthread_cond_t opened_changed;
	bool opened; /* the sink's `open` has returned */
	enum rb_status open_status;

	atomic_bool must_stop;

	/* the thread's until it is joined */
	enum rb_status status;
	struct rb_error error;
};

/* Tells rb_pump_start that `open` has returned, with its status. */
static void say_opened(struct rb_pump *pump)
{
	pthread_mutex_lock(&pump->lock);
	RB_ASSERT(!pump->opened);
	pump->opened = true;
	pump->open_status = pump->status;
	pthread_cond_signal(&pump->opened_changed);
	pthread_mutex_unlock(&pump->lock);
}

/* Gives back what the sink has read and does not keep; how many frames it has still. */
static int give_back(struct rb_pump *pump, int had)
{
	const int kept = pump->sink.kept ? pump->sink.kept(pump->sink.self) : 0;

	RB_ASSERT(kept >= 0 && kept <= had && kept <= rb_ring_keep_most(pump->ring));
	for (; had > kept; had--)
		rb_ring_give_back(pump->ring, pump->consumer);
	return kept;
}

/*
 * Hands frames and pauses to the sink until the ring is closed or the sink fails. A frame is given
 * back even if the sink failed on it.
 */
static enum rb_status feed(struct rb_pump *pump)
{
	const struct rb_sink *const sink = &pump->sink;
	const struct rb_frame *frame;
	int had = 0;

	for (;;) {
		enum rb_status status = RB_OK;

		switch (rb_ring_wait(pump->ring, pump->consumer, idle_s, &frame)) {
		case RB_RING_FRAME:
			status = sink->frame(sink->self, frame, &pump->error);
			had = give_back(pump, had + 1);
			break;
		case RB_RING_IDLE:
			if (sink->idle)
				status = sink->idle(sink->self, &pump->error);
			had = give_back(pump, had);
			break;
		case RB_RING_CLOSED:
			return RB_OK;
		}
		if (status)
			return status;
	}
}

/* The pump's thread: the whole life of the sink. */
static void *run(void *argument)
{
	struct rb_pump *const pump = argument;
	const struct rb_sink *const sink = &pump->sink;

	rb_thread_name(sink->name);
	if (sink->may_keep)
		sink->may_keep(sink->self, rb_ring_keep_most(pump->ring));
	pump->status = sink->open(sink->self, &pump->error);
	if (pump->status) {
		rb_ring_detach(pump->ring, pump->consumer);
		say_opened(pump);
		return NULL;
	}
	say_opened(pump);

	pump->status = feed(pump);
	/*
	 * Before the sink is closed, which may take long: the producer must neither work in vain
	 * nor wait for it.
	 */
	if (pump->status && sink->essential)
		atomic_store(&pump->must_stop, true);
	rb_ring_detach(pump->ring, pump->consumer);
	if (pump->status) {
		const struct rb_outcome failed = {.status = pump->status,
		                                  .reason = pump->error.text};
		(void)sink->close(sink->self, &failed,
		                  NULL); /* the first failure is the one to tell */
	} else {
		pump->status = sink->close(sink->self, pump->outcome, &pump->error);
	}
	return NULL;
}

/* Frees a pump whose thread has ended or never began. */
static void destroy(struct rb_pump *pump)
{
	pthread_cond_destroy(&pump->opened_changed);
	pthread_mutex_destroy(&pump->lock);
	rb_memory_free(pump);
}

enum rb_status rb_pump_start(struct rb_pump **pump, struct rb_ring *ring,
                             const struct rb_sink *sink, const struct rb_outcome *outcome,
                             struct rb_error *err)
{
	RB_ASSERT(sink->open && sink->frame && sink->close);
	*pump = NULL;
	struct rb_pump *p = rb_memory_take(1, sizeof *p);
	if (!p)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot start '%s': out of memory", sink->name);
	p->sink = *sink;
	p->ring = ring;
	p->outcome = outcome;
	pthread_mutex_init(&p->lock, NULL);
	pthread_cond_init(&p->opened_changed, NULL);

	enum rb_status status = rb_ring_add_consumer(ring, sink->lossless, &p->consumer, err);
	if (status) {
		destroy(p);
		return status;
	}
	rb_ring_name(ring, p->consumer, sink->name);
	const int failed = rb_thread_start(&p->thread, run, p);
	if (failed) {
		rb_ring_detach(ring, p->consumer);
		destroy(p);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a thread for '%s': %s",
		               sink->name, strerror(failed));
	}

	pthread_mutex_lock(&p->lock);
	while (!p->opened)
		pthread_cond_wait(&p->opened_changed, &p->lock);
	status = p->open_status;
	pthread_mutex_unlock(&p->lock);
	if (status)
		return rb_pump_join(p, err);
	*pump = p;
	return RB_OK;
}

bool rb_pump_must_stop(const struct rb_pump *pump)
{
	RB_ASSERT(pump != NULL);
	return atomic_load(&pump->must_stop);
}

enum rb_status rb_pump_join(struct rb_pump *pump, struct rb_error *err)
{
	if (!pump)
		return RB_OK;
	pthread_join(pump->thread, NULL);
	const enum rb_status status = pump->status;
	if (status && err)
		*err = pump->error;
	destroy(pump);
	return status;
}
