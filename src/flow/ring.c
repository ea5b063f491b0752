/* SPDX-License-Identifier: MIT */
/*
 * One mutex and one condition variable for all: frames come some hundred times a second, at most
 * some ten thousand, and a lock that nobody contends for costs less than a copy of the smallest
 * frame. What matters is not to wake sleepers for nothing, so a consumer states in `wake_at` what
 * it waits for, and publish signals only then.
 *
 * Protocol: slots in [tail, head) belong to readers, tail being the smallest `next` of the lossless
 * cursors; the producer waits while head - tail is the number of slots. A consumer that skips
 * frames is not counted in tail; what it reads may be in the slot that the producer wants next,
 * which is why each of them brings one spare frame: the slot's storage is exchanged, never the
 * reader's.
 */
#include "flow/ring.h"

#include <errno.h>
#include <pthread.h>
#include <time.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"

/*
 * Slots are used in turn, so all of a ring is written to again and again: a larger one would be out
 * of the processor's cache. Half of it still makes writes that are worth their calls
 * (sink/h5frames).
 */
static const size_t bytes_wanted = (size_t)4 << 20;

/* Where a consumer is. Protected by the ring's lock. */
struct cursor {
	bool lossless, attached;
	const char *name;            /* NULL: nobody has said */
	uint64_t next;               /* frames below this number are done with */
	uint64_t read;               /* frames below this number were handed out */
	const struct rb_frame *held; /* one that skips: being read, NULL: none */
	uint64_t wake_at;            /* asleep until so many frames are published; 0: awake */
};

struct rb_ring {
	/* set before any thread starts, then only read */
	const struct rb_model *model;
	unsigned fields;
	int slot_count;

	/* the frames: those of [tail, head) belong to the consumers, the rest to the producer */
	struct rb_frame frame[RB_RING_SLOTS_MAX + RB_RING_CONSUMERS_MAX];

	/* protected by lock */
	pthread_mutex_t lock;
	pthread_cond_t changed;
	struct rb_frame *slot[RB_RING_SLOTS_MAX]; /* frame number n is in slot[n % slot_count] */
	struct rb_frame *spare[RB_RING_CONSUMERS_MAX];
	int spare_count;
	uint64_t head; /* frames published so far */
	bool closed, aborted;
	int consumer_count;
	struct cursor cursor[RB_RING_CONSUMERS_MAX];
};

int rb_ring_slots_for(const struct rb_model *model, unsigned fields)
{
	const size_t bytes = rb_frame_bytes(model, fields);
	const size_t fitting = bytes > 0 ? bytes_wanted / bytes : RB_RING_SLOTS_MAX;

	if (fitting < RB_RING_SLOTS_MIN)
		return RB_RING_SLOTS_MIN;
	return fitting > RB_RING_SLOTS_MAX ? RB_RING_SLOTS_MAX : (int)fitting;
}

enum rb_status rb_ring_create(struct rb_ring **ring, const struct rb_model *model, unsigned fields,
                              int slot_count, struct rb_error *err)
{
	RB_ASSERT(slot_count >= 0 && slot_count <= RB_RING_SLOTS_MAX);
	*ring = NULL;
	struct rb_ring *r = rb_memory_take(1, sizeof *r);
	if (!r)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot make the ring of frames: out of memory");
	r->model = model;
	r->fields = fields;

	pthread_condattr_t attributes;
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_mutex_init(&r->lock, NULL);
	pthread_cond_init(&r->changed, &attributes);
	pthread_condattr_destroy(&attributes);

	const int wanted = slot_count > 0 ? slot_count : rb_ring_slots_for(model, fields);
	const enum rb_status status = rb_frame_init_all(r->frame, wanted, model, fields, err);
	if (status) {
		rb_ring_destroy(r);
		return status;
	}
	r->slot_count = wanted;
	for (int i = 0; i < wanted; i++)
		r->slot[i] = &r->frame[i];
	*ring = r;
	return RB_OK;
}

void rb_ring_destroy(struct rb_ring *ring)
{
	if (!ring)
		return;
	rb_frame_release_all(ring->frame, ring->slot_count);
	for (int i = 0; i < ring->spare_count; i++)
		rb_frame_release(&ring->frame[ring->slot_count + i]);
	pthread_cond_destroy(&ring->changed);
	pthread_mutex_destroy(&ring->lock);
	rb_memory_free(ring);
}

enum rb_status rb_ring_add_consumer(struct rb_ring *ring, bool lossless, int *consumer,
                                    struct rb_error *err)
{
	enum rb_status status = RB_OK;

	pthread_mutex_lock(&ring->lock);
	RB_ASSERT(ring->consumer_count < RB_RING_CONSUMERS_MAX && (lossless || ring->head == 0));
	if (!lossless) {
		struct rb_frame *frame = &ring->frame[ring->slot_count + ring->spare_count];
		status = rb_frame_init(frame, ring->model, ring->fields, err);
		if (!status)
			ring->spare[ring->spare_count++] = frame;
	}
	if (!status) {
		*consumer = ring->consumer_count++;
		ring->cursor[*consumer] = (struct cursor){.lossless = lossless,
		                                          .attached = true,
		                                          .next = ring->head,
		                                          .read = ring->head};
	}
	pthread_mutex_unlock(&ring->lock);
	return status;
}

/* The oldest frame that a lossless consumer still needs; `head` where there is none. */
static uint64_t tail_locked(const struct rb_ring *ring)
{
	uint64_t tail = ring->head;

	for (int i = 0; i < ring->consumer_count; i++) {
		const struct cursor *cursor = &ring->cursor[i];
		if (cursor->attached && cursor->lossless && cursor->next < tail)
			tail = cursor->next;
		RB_ASSERT(ring->head - tail <= (uint64_t)ring->slot_count);
	}
	return tail;
}

/* Whether some consumer is reading this frame. */
static bool held_locked(const struct rb_ring *ring, const struct rb_frame *frame)
{
	for (int i = 0; i < ring->consumer_count; i++)
		if (ring->cursor[i].held == frame)
			return true;
	return false;
}

/*
 * The slot for the next frame. If a skipping consumer still reads its storage, that is exchanged
 * for a spare one: there is one spare per consumer that skips, and each holds one frame, so one of
 * the spares is not held.
 */
static struct rb_frame *free_slot_locked(struct rb_ring *ring)
{
	struct rb_frame **slot = &ring->slot[ring->head % (uint64_t)ring->slot_count];

	for (int i = 0; i < ring->spare_count && held_locked(ring, *slot); i++) {
		struct rb_frame *const spare = ring->spare[i];
		ring->spare[i] = *slot;
		*slot = spare;
	}
	RB_ASSERT(!held_locked(ring, *slot));
	return *slot;
}

struct rb_frame *rb_ring_acquire(struct rb_ring *ring)
{
	struct rb_frame *frame = NULL;

	pthread_mutex_lock(&ring->lock);
	while (!ring->aborted && ring->head - tail_locked(ring) >= (uint64_t)ring->slot_count)
		pthread_cond_wait(&ring->changed, &ring->lock);
	if (!ring->aborted)
		frame = free_slot_locked(ring);
	pthread_mutex_unlock(&ring->lock);
	return frame;
}

void rb_ring_publish(struct rb_ring *ring)
{
	pthread_mutex_lock(&ring->lock);
	RB_ASSERT(ring->aborted || ring->head - tail_locked(ring) < (uint64_t)ring->slot_count);
	RB_ASSERT(!ring->closed);
	ring->head++;
	for (int i = 0; i < ring->consumer_count; i++)
		if (ring->cursor[i].wake_at > 0 && ring->head >= ring->cursor[i].wake_at)
			pthread_cond_broadcast(&ring->changed);
	pthread_mutex_unlock(&ring->lock);
}

int rb_ring_keep_most(const struct rb_ring *ring)
{
	return ring->slot_count / 2;
}

int rb_ring_used(struct rb_ring *ring, int *slot_count)
{
	pthread_mutex_lock(&ring->lock);
	const uint64_t used = ring->head - tail_locked(ring);
	RB_ASSERT(used <= (uint64_t)ring->slot_count);
	pthread_mutex_unlock(&ring->lock);
	*slot_count = ring->slot_count;
	return (int)used;
}

void rb_ring_name(struct rb_ring *ring, int consumer, const char *name)
{
	RB_ASSERT(consumer >= 0 && consumer < ring->consumer_count);
	pthread_mutex_lock(&ring->lock);
	ring->cursor[consumer].name = name;
	pthread_mutex_unlock(&ring->lock);
}

const char *rb_ring_awaited(struct rb_ring *ring)
{
	const char *name = NULL;

	pthread_mutex_lock(&ring->lock);
	const uint64_t tail = tail_locked(ring);
	for (int i = 0; i < ring->consumer_count; i++) {
		const struct cursor *const cursor = &ring->cursor[i];
		if (cursor->attached && cursor->lossless && cursor->next == tail &&
		    ring->head - tail >= (uint64_t)ring->slot_count)
			name = cursor->name;
	}
	pthread_mutex_unlock(&ring->lock);
	return name;
}

void rb_ring_close(struct rb_ring *ring)
{
	pthread_mutex_lock(&ring->lock);
	ring->closed = true;
	pthread_cond_broadcast(&ring->changed);
	pthread_mutex_unlock(&ring->lock);
}

void rb_ring_abort(struct rb_ring *ring)
{
	pthread_mutex_lock(&ring->lock);
	ring->aborted = true;
	pthread_cond_broadcast(&ring->changed);
	pthread_mutex_unlock(&ring->lock);
}

/* A point of the monotonic clock, for pthread_cond_timedwait. `timeout_s` is not negative. */
static struct timespec deadline_after(double timeout_s)
{
	struct timespec at;

	RB_ASSERT(timeout_s >= 0);
	clock_gettime(CLOCK_MONOTONIC, &at);
	at.tv_sec += (time_t)timeout_s;
	at.tv_nsec += (long)((timeout_s - (double)(time_t)timeout_s) * 1e9);
	if (at.tv_nsec >= 1000000000) {
		at.tv_nsec -= 1000000000;
		at.tv_sec++;
	}
	return at;
}

enum rb_ring_news rb_ring_wait(struct rb_ring *ring, int consumer, double timeout_s,
                               const struct rb_frame **frame)
{
	struct cursor *const cursor = &ring->cursor[consumer];
	const struct timespec deadline = deadline_after(timeout_s);
	enum rb_ring_news news = RB_RING_CLOSED;

	*frame = NULL;
	pthread_mutex_lock(&ring->lock);
	RB_ASSERT(cursor->attached && !cursor->held &&
	          cursor->read - cursor->next <= (uint64_t)rb_ring_keep_most(ring));
	/*
	 * A lossless consumer that has run dry sleeps until a quarter of the ring is full, or the
	 * time is out: waking it for every frame costs more than the frame.
	 */
	const uint64_t batch = cursor->lossless ? ((uint64_t)ring->slot_count + 3) / 4 : 1;
	const uint64_t enough = cursor->read + (cursor->read == ring->head ? batch : 1);
	int waited = 0;
	cursor->wake_at = enough;
	while (!ring->aborted && !ring->closed && ring->head < enough && waited != ETIMEDOUT)
		waited = pthread_cond_timedwait(&ring->changed, &ring->lock, &deadline);
	cursor->wake_at = 0;
	if (ring->aborted) {
		news = RB_RING_CLOSED;
	} else if (cursor->read < ring->head) {
		/* one who skips reads the newest frame */
		if (!cursor->lossless)
			cursor->next = cursor->read = ring->head - 1;
		*frame = ring->slot[cursor->read++ % (uint64_t)ring->slot_count];
		cursor->held = cursor->lossless ? NULL : *frame;
		news = RB_RING_FRAME;
	} else if (!ring->closed) {
		news = RB_RING_IDLE;
	}
	pthread_mutex_unlock(&ring->lock);
	return news;
}

void rb_ring_give_back(struct rb_ring *ring, int consumer)
{
	struct cursor *const cursor = &ring->cursor[consumer];

	pthread_mutex_lock(&ring->lock);
	RB_ASSERT(cursor->next < cursor->read && cursor->read <= ring->head);
	cursor->held = NULL;
	cursor->next++;
	pthread_cond_broadcast(&ring->changed);
	pthread_mutex_unlock(&ring->lock);
}

void rb_ring_detach(struct rb_ring *ring, int consumer)
{
	pthread_mutex_lock(&ring->lock);
	RB_ASSERT(consumer >= 0 && consumer < ring->consumer_count);
	ring->cursor[consumer].attached = false;
	/* wakes a producer that waits for this consumer */
	ring->cursor[consumer].held = NULL;
	pthread_cond_broadcast(&ring->changed);
	pthread_mutex_unlock(&ring->lock);
}
