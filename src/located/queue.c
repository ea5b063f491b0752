/* SPDX-License-Identifier: MIT */
/*
 * A calendar queue with a heap for the present. Days are equally long and hold unordered lists;
 * events of today or earlier are in the heap, those beyond the last day in one more list. When the
 * heap is empty, the next day that has events is moved into it; when the days run out, new ones are
 * laid out over the remaining events, with a length that follows from the median of their times. So
 * setting a later time costs the same for any number of bodies (Brown, "Calendar queues", CACM
 * 31:1220 (1988); the heap for the present is from Paul, "A complexity O(1) priority queue for
 * event driven molecular dynamics simulations", J. Comput. Phys. 221:615 (2007)), and unsuitable
 * lengths of days cost a heap's logarithm at most. Measured with the hold model at 4,000 and at
 * 100,000 bodies: two thirds of the time of a winner tree, a third of that of a heap of two or four
 * children.
 *
 * The order is right for any length of days: the day of a time never decreases with the time,
 * despite rounding, and equal times fall on one day.
 */
#include "located/queue.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

enum {
	NOWHERE = -1,  /* `day` of a body without event */
	TODAY = -2,    /* `day` of a body in the heap; `next` is then its index there */
	HEAP_MAX = 64, /* number of events up to which the heap is as good as a calendar */
	SAMPLES = 63,
};

static const double never = (double)INFINITY;

/* Mean number of events per day: with fewer, empty days cost time, with more, the heap does. */
static const double day_load = 8.0;

/* A body's event and where it is kept. */
struct slot {
	double time;
	int32_t next, prev; /* in the list of a day, -1: none */
	int32_t day;
	int32_t unused;
};

struct entry {
	double time;
	int32_t body;
};

struct rb_queue {
	struct slot *slots; /* by body */
	struct entry *heap;
	int32_t *head; /* first body of each day; at [day_count], of the times beyond */
	int32_t *gathered;
	int32_t count, heap_count, finite;
	int32_t day_count, today;
	int32_t later, later_day; /* for hints: next body, -1: none; last day visited */
	int64_t sets;             /* calls of rb_queue_set since days were laid out */
	double start, per_s;      /* days per second; 0: every day is today */
};

/* Order of events: time, then body. */
static bool before(struct entry a, struct entry b)
{
	return a.time < b.time || (a.time == b.time && a.body < b.body);
}

/* Writes an entry and its body's place in the heap. */
static void heap_put(struct rb_queue *queue, int32_t at, struct entry entry)
{
	queue->heap[at] = entry;
	queue->slots[entry.body].next = at;
}

/* Moves an entry up from `at`. */
static void heap_up(struct rb_queue *queue, int32_t at, struct entry entry)
{
	while (at > 0) {
		const int32_t parent = (at - 1) / 2;

		if (!before(entry, queue->heap[parent]))
			break;
		heap_put(queue, at, queue->heap[parent]);
		at = parent;
	}
	heap_put(queue, at, entry);
}

/* Places an entry at `at`, below or above it. */
static void heap_restore(struct rb_queue *queue, int32_t at, struct entry entry)
{
	for (;;) {
		int32_t child = 2 * at + 1;

		if (child >= queue->heap_count)
			break;
		if (child + 1 < queue->heap_count &&
		    before(queue->heap[child + 1], queue->heap[child]))
			child++;
		if (!before(queue->heap[child], entry))
			break;
		heap_put(queue, at, queue->heap[child]);
		at = child;
	}
	heap_up(queue, at, entry);
}

static void heap_add(struct rb_queue *queue, int32_t body)
{
	struct slot *slot = &queue->slots[body];

	slot->day = TODAY;
	heap_up(queue, queue->heap_count++, (struct entry){slot->time, body});
}

static void heap_remove(struct rb_queue *queue, int32_t at)
{
	const struct entry last = queue->heap[--queue->heap_count];

	if (at < queue->heap_count)
		heap_restore(queue, at, last);
}

/* Puts a body at the head of a day's list. */
static void list_add(struct rb_queue *queue, int32_t body, int32_t day)
{
	RB_ASSERT_COSTLY(day >= 0 && day <= queue->day_count);

	struct slot *slot = &queue->slots[body];
	const int32_t second = queue->head[day];

	slot->day = day;
	slot->prev = -1;
	slot->next = second;
	if (second >= 0)
		queue->slots[second].prev = body;
	queue->head[day] = body;
}

static void list_remove(struct rb_queue *queue, int32_t body)
{
	const struct slot *slot = &queue->slots[body];

	if (slot->prev >= 0)
		queue->slots[slot->prev].next = slot->next;
	else
		queue->head[slot->day] = slot->next;
	if (slot->next >= 0)
		queue->slots[slot->next].prev = slot->prev;
}

/*
 * Day of a time: TODAY for times that are not later; NaN, which days without length give, is TODAY
 * too.
 */
static int32_t day_of(const struct rb_queue *queue, double time)
{
	const double day = (time - queue->start) * queue->per_s;

	if (!(day >= (double)queue->today + 1))
		return TODAY;
	return day < (double)queue->day_count ? (int32_t)day : queue->day_count;
}

/* Puts a body into the heap or list of its time. */
static void add(struct rb_queue *queue, int32_t body)
{
	const int32_t day = day_of(queue, queue->slots[body].time);

	if (day == TODAY)
		heap_add(queue, body);
	else
		list_add(queue, body, day);
}

/* Empties a day's list into `gathered`. */
static int32_t gather_list(struct rb_queue *queue, int32_t day, int32_t count)
{
	for (int32_t body = queue->head[day]; body >= 0; body = queue->slots[body].next)
		queue->gathered[count++] = body;
	queue->head[day] = -1;
	return count;
}

/* Median of a sample of waiting times from `start`; their mean if more than half are zero. */
static double typical_wait(const struct rb_queue *queue, int32_t count, double start)
{
	double wait[SAMPLES], sum = 0;
	const int32_t max = count < SAMPLES ? count : SAMPLES;

	for (int32_t i = 0; i < max; i++) {
		const int64_t at = (int64_t)i * count / max;
		const double x = queue->slots[queue->gathered[at]].time - start;
		int32_t j = i;

		for (; j > 0 && wait[j - 1] > x; j--)
			wait[j] = wait[j - 1];
		wait[j] = x;
		sum += x;
	}
	return wait[max / 2] > 0 ? wait[max / 2] : sum / max;
}

/*
 * Lays out new days over all events. The cost is proportional to the number of events and days, so
 * it is rare: see its callers.
 */
static void lay_out(struct rb_queue *queue)
{
	int32_t count = 0, days = 1;
	double start = never;

	for (int32_t i = 0; i < queue->heap_count; i++)
		queue->gathered[count++] = queue->heap[i].body;
	for (int32_t day = queue->today; day <= queue->day_count; day++)
		count = gather_list(queue, day, count);
	RB_ASSERT(count == queue->finite);
	for (int32_t i = 0; i < count; i++)
		start = fmin(start, queue->slots[queue->gathered[i]].time);

	queue->sets = 0;
	queue->heap_count = 0;
	queue->today = queue->later_day = 0;
	queue->later = -1;
	queue->start = start;
	queue->per_s = 0;
	if (count > HEAP_MAX) {
		/*
		 * of n exponential waiting times with mean T, the first come at intervals T / n; T
		 * = median / ln 2
		 */
		queue->per_s = count * M_LN2 / (typical_wait(queue, count, start) * day_load);
		while (days < count)
			days *= 2;
	}
	queue->day_count = days;
	for (int32_t day = 0; day <= days; day++)
		queue->head[day] = -1;
	for (int32_t i = 0; i < count; i++)
		add(queue, queue->gathered[i]);
}

/*
 * Moves the next day that has events into the empty heap. New days are laid out after at least half
 * of the events were set to other times, which amortizes the cost.
 */
static void next_day(struct rb_queue *queue)
{
	while (queue->today + 1 < queue->day_count) {
		int32_t body = queue->head[++queue->today];

		if (body < 0)
			continue;
		queue->head[queue->today] = -1;
		while (body >= 0) {
			const int32_t next = queue->slots[body].next;

			heap_add(queue, body);
			body = next;
		}
		return;
	}
	if (queue->finite > 0)
		lay_out(queue);
}

void rb_queue_set(struct rb_queue *queue, int body, double time_s)
{
	RB_ASSERT(body >= 0 && body < queue->count && !isnan(time_s));
	struct slot *slot = &queue->slots[body];
	const int32_t day = time_s < never ? day_of(queue, time_s) : NOWHERE;

	queue->finite += (day != NOWHERE) - (slot->day != NOWHERE);
	queue->sets++;
	slot->time = time_s;
	if (slot->day == TODAY && day == TODAY) {
		heap_restore(queue, slot->next, (struct entry){time_s, body});
	} else {
		if (slot->day == TODAY)
			heap_remove(queue, slot->next);
		else if (slot->day != NOWHERE)
			list_remove(queue, body);
		if (day == TODAY)
			heap_add(queue, body);
		else if (day == NOWHERE)
			slot->day = NOWHERE;
		else
			list_add(queue, body, day);
	}
	if (queue->heap_count == 0)
		next_day(queue);
	else if (queue->heap_count > HEAP_MAX && queue->sets > 2 * (int64_t)queue->finite)
		lay_out(queue);
}

double rb_queue_time(const struct rb_queue *queue, int body)
{
	RB_ASSERT(body >= 0 && body < queue->count);
	return queue->slots[body].time;
}

int rb_queue_first(const struct rb_queue *queue, double *time_s)
{
	if (queue->heap_count == 0) {
		*time_s = never;
		return -1;
	}
	*time_s = queue->heap[0].time;
	return queue->heap[0].body;
}

int rb_queue_soon(const struct rb_queue *queue, int k)
{
	return k < queue->heap_count ? queue->heap[k].body : -1;
}

int rb_queue_later(struct rb_queue *queue)
{
	const int32_t body = queue->later;

	if (body < 0) {
		/* the next day, once */
		if (queue->later_day < queue->today)
			queue->later_day = queue->today;
		if (queue->later_day >= queue->day_count - 1 || queue->later_day > queue->today + 1)
			return -1;
		queue->later = queue->head[++queue->later_day];
	} else {
		/*
		 * the body may have been moved meanwhile: then this is another body, or an index of
		 * the heap
		 */
		queue->later = queue->slots[body].next;
	}
	if (queue->later >= 0)
		__builtin_prefetch(&queue->slots[queue->later]);
	return body;
}

void rb_queue_prefetch(const struct rb_queue *queue, int body)
{
	__builtin_prefetch(&queue->slots[body]);
}

enum rb_status rb_queue_create(struct rb_queue **queue, int body_count, struct rb_error *err)
{
	struct rb_queue *made = rb_memory_take(1, sizeof *made);
	const size_t count = (size_t)body_count;

	*queue = NULL;
	if (made) {
		made->slots = rb_memory_take(count, sizeof *made->slots);
		made->heap = rb_memory_take(count, sizeof *made->heap);
		made->head = rb_memory_take(2 * count + 2, sizeof *made->head);
		made->gathered = rb_memory_take(count, sizeof *made->gathered);
	}
	if (!made || !made->slots || !made->heap || !made->head || !made->gathered) {
		rb_queue_destroy(made);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the events of %d bodies",
		               body_count);
	}
	made->count = body_count;
	made->day_count = 1;
	made->later = -1;
	made->head[0] = made->head[1] = -1;
	for (int body = 0; body < body_count; body++)
		made->slots[body] = (struct slot){.time = never, .day = NOWHERE};
	*queue = made;
	return RB_OK;
}

void rb_queue_destroy(struct rb_queue *queue)
{
	if (!queue)
		return;
	rb_memory_free(queue->slots);
	rb_memory_free(queue->heap);
	rb_memory_free(queue->head);
	rb_memory_free(queue->gathered);
	rb_memory_free(queue);
}
