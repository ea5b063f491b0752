/* SPDX-License-Identifier: MIT */
/*
 * Points that are tried lie evenly over the plan, its first and its last among them; between two of
 * them what a run takes is taken to change evenly. That is exact where nothing or one parameter
 * matters linearly. Trials cost what `check` costs, so that no further one begins after some time.
 */
#include "app/sweep_needs.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/needs.h"
#include "app/simulate.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/team.h"

/* Points in order of their trial, by quarters of the plan; s after which none is begun. */
enum { QUARTERS = 4 };
static const uint64_t order[] = {0, QUARTERS, 2, 1, 3};
static const double patience_s = 10;

/* One point that was tried. */
struct sample {
	uint64_t index;
	bool known;
	double run_s;
	double disk_bytes;
};

/* The words NAME=VALUE of a point, to be freed with what they point into; NULL: no memory. */
static char **make_params(const struct rb_plan *plan, uint64_t index)
{
	char number[RB_AXIS_NUMBER_SIZE];
	size_t size = 0;

	for (int i = 0; i < plan->axis_count; i++)
		size += strlen(plan->axes[i].name) + strlen(rb_plan_value(plan, index, i, number)) +
		        2;
	const size_t table = ((size_t)plan->axis_count + 1) * sizeof(char *);
	char **const params = rb_memory_take(table + size, 1);
	if (!params)
		return NULL;
	char *text = (char *)params + table;
	for (int i = 0; i < plan->axis_count; i++) {
		params[i] = text;
		text += 1 + sprintf(text, "%s=%s", plan->axes[i].name,
		                    rb_plan_value(plan, index, i, number));
	}
	return params;
}

/* Tries one point; a point that does not load, or whose trial does not stand, tells nothing. */
static enum rb_status try_point(struct sample *sample, struct rb_sweep_needs *needs,
                                const struct rb_planned *sweep, struct rb_error *err)
{
	struct rb_options options = *sweep->options;
	char **const params = make_params(&sweep->plan, sample->index);
	struct rb_run_texts texts = {0};
	struct rb_run_info info;
	struct rb_loaded loaded;
	struct rb_needs run;

	if (!params)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot try the sweep: out of memory");
	options.params = (const char **)params;
	options.param_count = sweep->plan.axis_count;
	options.has_seed = true;
	options.seed = rb_plan_seed(&sweep->plan, sample->index);
	options.output = NULL;
	options.quiet = true; /* the scene has spoken when it was planned */
	options.threads = options.threads > 0 ? options.threads : 1;
	if (!rb_loaded_init(&loaded, &options, NULL) &&
	    !rb_simulate_info(&info, &texts, &loaded, &options, NULL) &&
	    !rb_needs_take(&run, &loaded, &info, NULL) && !isnan(run.run.run_s)) {
		sample->known = true;
		sample->run_s = run.run.run_s;
		sample->disk_bytes = (double)run.disk_bytes;
		needs->at_least |= run.run.at_least;
		if (run.run.memory_bytes > needs->run_bytes)
			needs->run_bytes = run.run.memory_bytes;
		needs->shortest_s = needs->tried == 0 ? run.run.run_s
		                                      : fmin(needs->shortest_s, run.run.run_s);
		needs->longest_s = fmax(needs->longest_s, run.run.run_s);
		needs->tried++;
	}
	rb_run_texts_release(&texts);
	rb_loaded_release(&loaded);
	rb_memory_free(params);
	return RB_OK;
}

/* Sum of n values that go evenly from a on to b, which is not among them. */
static double sum_between(double a, double b, double n)
{
	return n * a + (b - a) * (n - 1) / 2;
}

/* Adds up all points: before the first that is known and behind the last they are like these. */
static void add_up(struct rb_sweep_needs *needs, const struct sample samples[QUARTERS + 1],
                   uint64_t count)
{
	const struct sample *before = NULL;
	double run_s = 0, disk_bytes = 0;

	for (int k = 0; k <= QUARTERS; k++) {
		const struct sample *const now = &samples[k];
		if (!now->known || (before && now->index == before->index))
			continue;
		const struct sample *const from = before ? before : now;
		const double n = (double)(now->index - (before ? before->index : 0));
		run_s += sum_between(from->run_s, now->run_s, n);
		disk_bytes += sum_between(from->disk_bytes, now->disk_bytes, n);
		before = now;
	}
	if (!before)
		return;
	const double rest = (double)(count - before->index);
	run_s += rest * before->run_s;
	disk_bytes += rest * before->disk_bytes;
	/* the last one of all may be alone at its end */
	needs->wall_s = fmax(run_s / needs->jobs, needs->longest_s);
	needs->disk_bytes = (uint64_t)disk_bytes;
}

enum rb_status rb_sweep_needs_take(struct rb_sweep_needs *needs, const struct rb_planned *sweep,
                                   struct rb_error *err)
{
	const struct rb_options *const options = sweep->options;
	const int threads = options->threads > 0 ? options->threads : 1;
	const uint64_t count = sweep->plan.count, begin_ns = rb_clock_now_ns();
	struct sample samples[QUARTERS + 1] = {0};
	enum rb_status status = RB_OK;

	RB_ASSERT(count > 0);
	*needs = (struct rb_sweep_needs){.jobs = options->jobs, .wall_s = (double)NAN};
	if (needs->jobs < 1)
		needs->jobs = rb_team_processors() / threads;
	if (needs->jobs < 1)
		needs->jobs = 1;
	if ((uint64_t)needs->jobs > count)
		needs->jobs = (int)count;
	for (size_t k = 0; k < sizeof order / sizeof *order && !status; k++) {
		struct sample *const sample = &samples[order[k]];
		bool known = false;
		sample->index = order[k] * (count - 1) / QUARTERS;
		for (int i = 0; i <= QUARTERS; i++)
			known |= samples[i].known && samples[i].index == sample->index;
		if (known || (double)(rb_clock_now_ns() - begin_ns) * 1e-9 > patience_s)
			continue;
		status = try_point(sample, needs, sweep, err);
	}
	add_up(needs, samples, count);
	needs->memory_bytes = (uint64_t)needs->jobs * needs->run_bytes;
	return status;
}
