/* SPDX-License-Identifier: MIT */
/*
 * Looks at every point once; the tasks of a job array are the remainders of the indices, so a task
 * is marked as soon as one of its points is due. Marks take one byte each, which at
 * RB_PLAN_POINTS_MAX is 10 MB and needs no sorting.
 */
#include "sweep/status.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/error.h"
#include "base/memory.h"

const char *const rb_point_state_names[RB_POINT_STATE_COUNT] = {
	[RB_POINT_MISSING] = "missing", [RB_POINT_BEGUN] = "unfinished",
	[RB_POINT_RUNNING] = "running", [RB_POINT_DONE] = "done",
	[RB_POINT_FAILED] = "failed",
};

/*
 * Composes status->array, "3,7-9", from the marked tasks, and counts these. Ranges keep the text
 * short: Slurm limits the length of a command line, and usually nearly all or nearly none are left.
 */
static enum rb_status write_array(struct rb_sweep_status *status, const unsigned char *marked,
                                  uint64_t count, struct rb_error *err)
{
	enum { RANGE_SIZE = 48 };
	size_t used = 0, capacity = 0;

	if (!rb_memory_reserve(&status->array, &capacity, RANGE_SIZE, 1))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot list what is left: out of memory");
	for (uint64_t first = 0; first < count; first++) {
		uint64_t last = first;
		if (!marked[first])
			continue;
		while (last + 1 < count && marked[last + 1])
			last++;
		status->tasks += last - first + 1;
		if (!rb_memory_reserve(&status->array, &capacity, used + RANGE_SIZE, 1))
			return RB_FAIL(err, RB_ERR_MEMORY,
			               "cannot list what is left: out of memory");
		used += (size_t)snprintf(status->array + used, RANGE_SIZE, "%s%" PRIu64,
		                         used > 0 ? "," : "", first);
		if (last > first)
			used += (size_t)snprintf(status->array + used, RANGE_SIZE / 2, "-%" PRIu64,
			                         last);
		RB_ASSERT(used < capacity);
		first = last;
	}
	return RB_OK;
}

enum rb_status rb_status_take(struct rb_sweep_status *status, const struct rb_status_wish *wish,
                              struct rb_error *err)
{
	const uint64_t tasks = wish->tasks > 0 ? wish->tasks : wish->plan->count;
	unsigned char *const marked = rb_memory_take((size_t)tasks, 1);
	enum rb_status failed = RB_OK;
	struct rb_point point;

	*status = (struct rb_sweep_status){0};
	if (!marked)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot look at the sweep: out of memory");
	for (uint64_t i = 0; i < wish->plan->count && !failed; i++) {
		failed = rb_point_look(wish->folder, wish->plan, i, wish->module, &point, err);
		RB_ASSERT(failed || point.state < RB_POINT_STATE_COUNT);
		if (failed)
			break;
		status->points[point.state]++;
		if (rb_point_is_due(&point, wish->retry)) {
			status->due++;
			marked[i % tasks] = 1;
		}
		if (point.state == RB_POINT_FAILED && wish->failed)
			wish->failed(wish->user, i, &point);
	}
	if (!failed)
		failed = write_array(status, marked, tasks, err);
	rb_memory_free(marked);
	return failed;
}

void rb_status_release(struct rb_sweep_status *status)
{
	rb_memory_free(status->array);
	*status = (struct rb_sweep_status){0};
}
