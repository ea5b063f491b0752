/* SPDX-License-Identifier: MIT */
#include "sweep/plan.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* ---- what is asked for ---- */

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot plan the sweep: out of memory");
}

static enum rb_status take_sample(struct rb_plan *plan, const char *text, struct rb_error *err)
{
	static const char kind[] = "latin:";
	char *end;

	if (!text)
		return RB_OK;
	const char *const number = text + sizeof kind - 1;
	if (strncmp(text, kind, sizeof kind - 1) == 0 && *number >= '1' && *number <= '9') {
		plan->sample_count = strtoull(number, &end, 10);
		if (*end == '\0' && plan->sample_count <= RB_PLAN_POINTS_MAX)
			return RB_OK;
	}
	return RB_FAIL(err, RB_ERR_USAGE,
	               "option '--sample': '%s' is not latin:N, with N from 1 to %u", text,
	               RB_PLAN_POINTS_MAX);
}

static enum rb_status take_axes(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                struct rb_error *err)
{
	plan->axes = rb_memory_take((size_t)wish->param_count + 1, sizeof *plan->axes);
	if (!plan->axes)
		return no_memory(err);
	for (int i = 0; i < wish->param_count; i++) {
		struct rb_axis *const axis = &plan->axes[plan->axis_count++];
		const enum rb_status status = rb_axis_init(axis, wish->params[i],
		                                           RB_PLAN_POINTS_MAX, err);
		if (status)
			return status;
		if (axis->count == 0 && plan->sample_count == 0)
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--param': '%s' is a range without a step (wanted: "
			               "low:high:step, or --sample latin:N)",
			               wish->params[i]);
		for (int k = 0; k < i; k++)
			if (strcmp(plan->axes[k].name, axis->name) == 0)
				return RB_FAIL(err, RB_ERR_USAGE,
				               "option '--param': '%s' is given twice (wanted: "
				               "%s=A,B,...)",
				               axis->name, axis->name);
	}
	return RB_OK;
}

static enum rb_status count_points(struct rb_plan *plan, struct rb_error *err)
{
	uint64_t count = plan->sample_count > 0 ? plan->sample_count : 1;
	double wanted = (double)count * (double)plan->seeds;

	for (int i = 0; plan->sample_count == 0 && i < plan->axis_count; i++) {
		wanted *= (double)plan->axes[i].count;
		if (wanted <= RB_PLAN_POINTS_MAX)
			count *= plan->axes[i].count;
	}
	if (wanted > RB_PLAN_POINTS_MAX)
		return RB_FAIL(err, RB_ERR_USAGE, "the sweep would have %.8g points (at most %u)",
		               wanted, RB_PLAN_POINTS_MAX);
	plan->count = count * plan->seeds;
	return RB_OK;
}

static enum rb_status take_texts(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                 const struct rb_source_file *files, int file_count,
                                 struct rb_error *err)
{
	plan->scene = rb_memory_copy_text(wish->scene);
	plan->words = rb_memory_take((size_t)wish->word_count + 1, sizeof *plan->words);
	plan->files = rb_memory_take((size_t)file_count + 1, sizeof *plan->files);
	bool right = plan->scene && plan->words && plan->files;
	for (int i = 0; right && i < wish->word_count; i++) {
		for (const char *c = wish->words[i]; *c; c++)
			if ((unsigned char)*c < ' ')
				return RB_FAIL(err, RB_ERR_USAGE,
				               "option '%.*s' holds a line break or another "
				               "control character",
				               (int)strcspn(wish->words[i], "="), wish->words[i]);
		right = (plan->words[plan->word_count++] = rb_memory_copy_text(wish->words[i])) !=
		        NULL;
	}
	for (int i = 0; right && i < file_count; i++) {
		struct rb_plan_file *const file = &plan->files[plan->file_count++];
		memcpy(file->sha256, files[i].sha256, sizeof file->sha256);
		right = (file->name = rb_memory_copy_text(files[i].name)) != NULL;
	}
	return right ? RB_OK : no_memory(err);
}

/* ---- the head of plan.csv ---- */

static bool add_line(struct rb_plan *plan, const char *key, const char *value, const char *more)
{
	const size_t size = strlen(key) + strlen(value) + strlen(more) + 8;
	char *const line = rb_memory_take(size, 1);

	if (!line)
		return false;
	snprintf(line, size, "# %s %s%s%s", key, value, *more ? " " : "", more);
	plan->lines[plan->line_count++] = line;
	return true;
}

static bool add_number(struct rb_plan *plan, const char *key, uint64_t number)
{
	char text[24];

	snprintf(text, sizeof text, "%" PRIu64, number);
	return add_line(plan, key, text, "");
}

static enum rb_status write_head(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                 struct rb_error *err)
{
	const size_t most = (size_t)(plan->axis_count + plan->word_count + plan->file_count) + 16;
	bool right = (plan->lines = rb_memory_take(most, sizeof *plan->lines)) != NULL;

	right = right && add_line(plan, "sweep", "of rbsim", wish->version);
	right = right && add_line(plan, "scene", plan->scene, "");
	for (int i = 0; i < plan->file_count; i++)
		right = right && add_line(plan, "file", plan->files[i].sha256, plan->files[i].name);
	for (int i = 0; i < plan->axis_count; i++)
		right = right && add_line(plan, "param", plan->axes[i].text, "");
	if (wish->sample)
		right = right && add_line(plan, "sample", wish->sample, "");
	right = right && add_number(plan, "seeds", plan->seeds);
	right = right && add_number(plan, "seed", plan->base_seed);
	for (int i = 0; i < plan->word_count; i++)
		right = right && add_line(plan, "option", plan->words[i], "");
	right = right && add_line(plan, "recordings", plan->records ? "yes" : "no", "");
	right = right && add_line(plan, "films", plan->films ? "yes" : "no", "");
	right = right && add_number(plan, "points", plan->count);
	return right ? RB_OK : no_memory(err);
}

enum rb_status rb_plan_init(struct rb_plan *plan, const struct rb_plan_wish *wish,
                            const struct rb_source_file *files, int file_count,
                            struct rb_error *err)
{
	*plan = (struct rb_plan){.seeds = wish->seeds,
	                         .base_seed = wish->base_seed,
	                         .records = wish->records,
	                         .films = wish->films};
	enum rb_status status = take_sample(plan, wish->sample, err);

	if (!status)
		status = take_axes(plan, wish, err);
	if (!status)
		status = count_points(plan, err);
	if (!status && plan->sample_count > 0)
		status = rb_sample_init(&plan->sample, plan->base_seed, plan->sample_count,
		                        plan->axis_count, err);
	if (!status)
		status = take_texts(plan, wish, files, file_count, err);
	if (!status)
		status = write_head(plan, wish, err);
	plan->row_size = 64;
	for (int i = 0; !status && i < plan->axis_count; i++) {
		const size_t name = strlen(plan->axes[i].name);
		/* quoted, every character twice */
		plan->row_size += 2 * (name > plan->axes[i].room ? name : plan->axes[i].room) + 4;
	}
	return status;
}

void rb_plan_release(struct rb_plan *plan)
{
	for (int i = 0; i < plan->axis_count; i++)
		rb_axis_release(&plan->axes[i]);
	for (int i = 0; i < plan->word_count; i++)
		rb_memory_free(plan->words[i]);
	for (int i = 0; i < plan->file_count; i++)
		rb_memory_free(plan->files[i].name);
	for (int i = 0; i < plan->line_count; i++)
		rb_memory_free(plan->lines[i]);
	rb_sample_release(&plan->sample);
	rb_memory_free(plan->scene);
	rb_memory_free(plan->axes);
	rb_memory_free(plan->words);
	rb_memory_free(plan->files);
	rb_memory_free(plan->lines);
	*plan = (struct rb_plan){0};
}

/* ---- points ---- */

const char *rb_plan_value(const struct rb_plan *plan, uint64_t index, int axis,
                          char out[RB_AXIS_NUMBER_SIZE])
{
	uint64_t k = index / plan->seeds;

	if (plan->sample_count > 0)
		return rb_axis_at(&plan->axes[axis], rb_sample_unit(&plan->sample, axis, k), out);
	for (int i = plan->axis_count - 1; i > axis; i--)
		k /= plan->axes[i].count;
	return rb_axis_value(&plan->axes[axis], k % plan->axes[axis].count, out);
}

uint64_t rb_plan_seed(const struct rb_plan *plan, uint64_t index)
{
	return rb_sample_seed(plan->base_seed, index);
}

const char *rb_plan_label(const struct rb_plan *plan, uint64_t index, char *out, size_t size)
{
	char number[RB_AXIS_NUMBER_SIZE];
	size_t used = 0;

	out[0] = '\0';
	for (int i = 0; i < plan->axis_count && used < size; i++)
		used += (size_t)snprintf(out + used, size - used, "%s%s=%s", i > 0 ? ", " : "",
		                         plan->axes[i].name, rb_plan_value(plan, index, i, number));
	if (plan->axis_count == 0 || (plan->seeds > 1 && used < size))
		snprintf(out + used, size - used, "%sseed %" PRIu64, used > 0 ? ", " : "",
		         rb_plan_seed(plan, index));
	return out;
}

/* As RFC 4180 has it: quotes around what could be taken for something else, doubled within. */
static char *put_cell(char *to, const char *text)
{
	const bool quoted = *text == '\0' || text[strcspn(text, ",\"# ")] != '\0';

	*to++ = ',';
	if (quoted)
		*to++ = '"';
	for (; *text; text++) {
		if (*text == '"')
			*to++ = '"';
		*to++ = *text;
	}
	if (quoted)
		*to++ = '"';
	*to = '\0';
	return to;
}

void rb_plan_row(const struct rb_plan *plan, uint64_t index, char *out)
{
	char number[RB_AXIS_NUMBER_SIZE];

	out += sprintf(out, "%" PRIu64 ",%" PRIu64, index, rb_plan_seed(plan, index));
	for (int i = 0; i < plan->axis_count; i++)
		out = put_cell(out, rb_plan_value(plan, index, i, number));
}

void rb_plan_titles(const struct rb_plan *plan, char *out)
{
	out += sprintf(out, "index,seed");
	for (int i = 0; i < plan->axis_count; i++)
		out = put_cell(out, plan->axes[i].name);
}
