/* SPDX-License-Identifier: MIT */
/*
 * A ring without readers' cursors: a frame is overwritten by the one `slots` later, whoever may
 * want it, and readers get copies. The lock is held for one copy of a frame; that is the longest
 * that the simulator can wait for a client.
 */
#include "control/history.h"

#include <inttypes.h>
#include <pthread.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/between.h"
#include "flow/frame.h"

/*
 * 64 MiB, as in flow/ring: bounded, and small beside the world of a scene with frames that large.
 */
static const size_t bytes_wanted = (size_t)64 << 20;

struct rb_history {
	/* set before any thread starts, then only read */
	uint64_t slots;

	/* protected by lock */
	pthread_mutex_t lock;
	uint64_t count;      /* frames that have come: the last is count - 1 */
	uint64_t whole_from; /* memory was out for the frame before this one */
	struct rb_frame frame[RB_HISTORY_FRAMES_MAX]; /* frame k is in [k % slots] */
};

enum rb_status rb_history_create(struct rb_history **history, const struct rb_model *model,
                                 struct rb_error *err)
{
	const size_t bytes = rb_frame_bytes(model, RB_HISTORY_FIELDS) + sizeof(struct rb_frame);
	const size_t fitting = bytes_wanted / bytes;
	struct rb_history *const h = rb_memory_take(1, sizeof *h);

	*history = h;
	if (!h)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep the last frames: out of memory");
	/* one at least: it is the newest */
	h->slots = fitting < 1 ? 1 : fitting;
	if (h->slots > RB_HISTORY_FRAMES_MAX)
		h->slots = RB_HISTORY_FRAMES_MAX;
	pthread_mutex_init(&h->lock, NULL);
	return RB_OK;
}

void rb_history_destroy(struct rb_history *history)
{
	if (!history)
		return;
	for (int i = 0; i < RB_HISTORY_FRAMES_MAX; i++)
		rb_frame_release(&history->frame[i]);
	pthread_mutex_destroy(&history->lock);
	rb_memory_free(history);
}

enum rb_status rb_history_keep(struct rb_history *history, const struct rb_frame *frame,
                               struct rb_error *err)
{
	struct rb_frame kept = *frame;

	/* their number has no bound */
	kept.events = NULL;
	kept.contacts = NULL;
	kept.shots = NULL;
	kept.event_count = kept.contact_count = kept.shot_count = 0;
	pthread_mutex_lock(&history->lock);
	/*
	 * without memory the frame counts as come, and all before it as gone: a gap would be
	 * answered with a wrong frame
	 */
	const enum rb_status status = rb_frame_copy(&history->frame[frame->index % history->slots],
	                                            &kept, err);
	RB_ASSERT(frame->index >= history->count);
	history->count = frame->index + 1;
	if (status)
		history->whole_from = frame->index + 1;
	pthread_mutex_unlock(&history->lock);
	return status;
}

/* Index of the oldest frame that is kept; not less than `count` where there is none. */
static uint64_t first_locked(const struct rb_history *history)
{
	const uint64_t first = history->count > history->slots ? history->count - history->slots
	                                                       : 0;

	return first > history->whole_from ? first : history->whole_from;
}

bool rb_history_range(struct rb_history *history, uint64_t *first, uint64_t *last)
{
	pthread_mutex_lock(&history->lock);
	const uint64_t count = history->count;
	*first = first_locked(history);
	*last = count > 0 ? count - 1 : 0;
	pthread_mutex_unlock(&history->lock);
	return *first < count;
}

enum rb_status rb_history_copy(struct rb_history *history, uint64_t index, struct rb_frame *to,
                               struct rb_error *err)
{
	enum rb_status status;

	RB_ASSERT(to != NULL);
	pthread_mutex_lock(&history->lock);
	const uint64_t first = first_locked(history), count = history->count;
	if (first >= count)
		status = RB_FAIL(err, RB_ERR_INPUT, "there is no frame yet");
	else if (index == RB_HISTORY_NEWEST)
		status = rb_frame_copy(to, &history->frame[(count - 1) % history->slots], err);
	else if (index < first || index >= count)
		status = RB_FAIL(err, RB_ERR_INPUT,
		                 "frame %" PRIu64 " is not kept, wanted one from %" PRIu64
		                 " to %" PRIu64,
		                 index, first, count - 1);
	else
		status = rb_frame_copy(to, &history->frame[index % history->slots], err);
	pthread_mutex_unlock(&history->lock);
	return status;
}
