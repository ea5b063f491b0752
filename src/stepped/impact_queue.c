/* SPDX-License-Identifier: MIT */
/*
 * Binary min-heap in an array. Elements are moved into the hole, not swapped, on the way up and
 * down. A point may have several entries: to decrease a key in place would need the index of each
 * point's entry, while stale entries cost the caller one comparison, and a sweep when they
 * outnumber the others.
 */
#include "stepped/impact_queue.h"

#include <stdbool.h>

#include "base/error.h"
#include "base/memory.h"

/*
 * A total order, since ties go by point: which of two simultaneous impacts comes first does not
 * depend on the history of the heap.
 */
static bool is_sooner(const struct rb_queued_impact *x, const struct rb_queued_impact *y)
{
	return x->t_s < y->t_s || (x->t_s == y->t_s && x->point < y->point);
}

enum rb_status rb_impact_queue_add(struct rb_impact_queue *queue, struct rb_queued_impact due,
                                   struct rb_error *err)
{
	size_t at = queue->count;

	RB_ASSERT_COSTLY(due.t_s >= 0);
	if (!rb_memory_reserve(&queue->row, &queue->capacity, at + 1, sizeof *queue->row))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	for (; at > 0 && is_sooner(&due, &queue->row[(at - 1) / 2]); at = (at - 1) / 2)
		queue->row[at] = queue->row[(at - 1) / 2];
	queue->row[at] = due;
	queue->count++;
	return RB_OK;
}

/* Moves a hole at `at` down to where the element belongs. */
static void sink(struct rb_impact_queue *queue, size_t at, struct rb_queued_impact due)
{
	struct rb_queued_impact *const row = queue->row;

	for (;;) {
		size_t next = 2 * at + 1;

		if (next >= queue->count)
			break;
		if (next + 1 < queue->count && is_sooner(&row[next + 1], &row[next]))
			next++;
		if (!is_sooner(&row[next], &due))
			break;
		row[at] = row[next];
		at = next;
	}
	row[at] = due;
}

struct rb_queued_impact rb_impact_queue_next(struct rb_impact_queue *queue)
{
	RB_ASSERT(queue->count > 0);
	const struct rb_queued_impact first = queue->row[0], last = queue->row[--queue->count];

	sink(queue, 0, last);
	return first;
}

void rb_impact_queue_keep(struct rb_impact_queue *queue, const double *next_s)
{
	struct rb_queued_impact *const row = queue->row;
	size_t count = 0;

	for (size_t k = 0; k < queue->count; k++)
		if (row[k].t_s == next_s[row[k].point])
			row[count++] = row[k];
	queue->count = count;
	for (size_t k = count / 2; k-- > 0;)
		sink(queue, k, row[k]);
}
