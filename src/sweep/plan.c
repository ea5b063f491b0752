/* SPDX-License-Identifier: MIT */
/*
 * A point's index is a number in mixed radix: the seed is its lowest digit, then the axes from the
 * last to the first, so that the first parameter given varies slowest and the runs that differ only
 * in their seed stand together. Values are computed from the index whenever they are wanted.
 *
 * The plan keeps the head of plan.csv as the lines it will write, because comparing two plans then
 * is comparing their texts: two sweeps are the same exactly if these lines are.
 */
#include "sweep/plan.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

/* ---- what is asked for ---- */

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot plan the sweep: out of memory");
}

/*
 * Reads "latin:N" (NULL: no sample) into plan->sample_count. The first digit may not be 0 or a
 * sign: strtoull would accept both.
 */
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

/*
 * Makes an axis of every NAME=VALUES. A range without a step (count 0) is allowed only with a
 * sample, which alone can choose values from it.
 */
static enum rb_status take_axes(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                struct rb_error *err)
{
	RB_ASSERT(plan->axis_count == 0);
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

/*
 * Sets plan->count to the product of all choices, or fails above RB_PLAN_POINTS_MAX. The product is
 * formed in floating point, where it cannot wrap; the integer one follows only while it fits.
 */
static enum rb_status count_points(struct rb_plan *plan, struct rb_error *err)
{
	uint64_t count = plan->sample_count > 0 ? plan->sample_count : 1;
	double wanted = (double)count * (double)plan->seeds;

	RB_ASSERT(plan->seeds > 0);
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

/* True if a text would not stay on its line of the plan. */
static bool is_broken(const char *text)
{
	for (const char *c = text; *c; c++)
		if ((unsigned char)*c < ' ')
			return true;
	return false;
}

/*
 * Copies what the plan needs of the wish and the scene's files. Control characters are refused: the
 * words are lines of plan.csv and of a shell script.
 */
static enum rb_status take_texts(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                 const struct rb_source_file *files, int file_count,
                                 struct rb_error *err)
{
	RB_ASSERT(wish->word_count >= 0 && file_count >= 0);
	plan->scene = rb_memory_copy_text(wish->scene);
	plan->words = rb_memory_take((size_t)wish->word_count + 1, sizeof *plan->words);
	plan->files = rb_memory_take((size_t)file_count + 1, sizeof *plan->files);
	bool right = plan->scene && plan->words && plan->files;
	for (int i = 0; right && i < wish->word_count; i++) {
		if (is_broken(wish->words[i]))
			return RB_FAIL(
				err, RB_ERR_USAGE,
				"option '%.*s' holds a line break or another control character",
				(int)strcspn(wish->words[i], "="), wish->words[i]);
		right = (plan->words[plan->word_count++] = rb_memory_copy_text(wish->words[i])) !=
		        NULL;
	}
	for (int i = 0; right && i < file_count; i++) {
		struct rb_plan_file *const file = &plan->files[plan->file_count++];
		if (is_broken(files[i].name))
			return RB_FAIL(err, RB_ERR_USAGE,
			               "cannot sweep '%s': its name holds a line break or another "
			               "control character",
			               files[i].name);
		memcpy(file->sha256, files[i].sha256, sizeof file->sha256);
		right = (file->name = rb_memory_copy_text(files[i].name)) != NULL;
	}
	return right ? RB_OK : no_memory(err);
}

/* ---- the head of plan.csv ---- */

/*
 * Appends "# KEY VALUE MORE" to the head; `more` may be "". False: no memory. write_head has
 * reserved the place.
 */
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

/* Composes the head of plan.csv in the order in which it is written and compared. */
static enum rb_status write_head(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                 struct rb_error *err)
{
	const size_t most = (size_t)(plan->axis_count + plan->word_count + plan->file_count) + 16;
	/*
	 * 16: more than the lines that do not depend on counts (sweep, scene, sample, seeds, seed,
	 * recordings, films, points)
	 */
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
	RB_ASSERT(!right || (size_t)plan->line_count <= most);
	return right ? RB_OK : no_memory(err);
}

enum rb_status rb_plan_init(struct rb_plan *plan, const struct rb_plan_wish *wish,
                            const struct rb_source_file *files, int file_count,
                            struct rb_error *err)
{
	RB_ASSERT(file_count >= 0 && (files || file_count == 0));
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
	/* index and seed, of 20 digits each at most, their comma and the final zero */
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

	RB_ASSERT(index < plan->count && axis >= 0 && axis < plan->axis_count);
	if (plan->sample_count > 0)
		/* with a sample the digits above the seed are the number of the sample's point */
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

/*
 * Appends a comma and the cell as RFC 4180 has it: in quotes where it could be taken for something
 * else ('#' begins a line of the head), quotes doubled within. Returns the end; the caller's room
 * is rb_plan.row_size.
 */
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

	RB_ASSERT(index < plan->count);
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
