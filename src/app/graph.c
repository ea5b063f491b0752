/* SPDX-License-Identifier: MIT */
#include "app/graph.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/plot.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "math/vec3.h"
#include "sink/module.h"

/* All of one call of the verb. */
struct graph {
	const struct rb_options *options;
	const struct rb_hdf5_module *module;
	const char *file;
	struct rb_reader *reader;      /* NULL: a collected sweep */
	double *x;                     /* owned: [count] */
	double **y;                    /* owned, each too: a column for each quantity */
	struct rb_plot_series *series; /* owned */
	uint64_t count;
	int quantity_count;
	const char *x_label;
};

/* Fails. */
static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot plot: out of memory");
}

/* The k-th quantity as the command line names it. */
static const char *quantity(const struct graph *graph, int k)
{
	RB_ASSERT(k >= 0 && k < graph->quantity_count);
	return graph->options->words[1 + k];
}

/* ---- a run: quantities against time ---- */

/* What of a body can be told, behind its name and a point. */
#define VECTOR(x, y, z, length, column)                                                       \
	{x, 0, offsetof(struct rb_frame, column)}, {y, 1, offsetof(struct rb_frame, column)}, \
		{z, 2, offsetof(struct rb_frame, column)},                                    \
	{                                                                                     \
		length, -1, offsetof(struct rb_frame, column)                                 \
	}
static const struct {
	const char *name;
	int axis;      /* -1: the length */
	size_t column; /* of struct rb_frame */
} parts[] = {{"x", 0, offsetof(struct rb_frame, position)},
             {"y", 1, offsetof(struct rb_frame, position)},
             {"z", 2, offsetof(struct rb_frame, position)},
             VECTOR("vx", "vy", "vz", "speed", velocity),
             VECTOR("wx", "wy", "wz", "spin", angular_velocity),
             VECTOR("ax", "ay", "az", "acceleration", acceleration),
             VECTOR("fx", "fy", "fz", "force", force),
             VECTOR("tx", "ty", "tz", "torque", torque)};
enum { PART_COUNT = sizeof parts / sizeof *parts };

/* What messages call a body: its name, or "#ID". */
static const char *label_of(const struct rb_reading *reading, int id, char out[16])
{
	if (*reading->names[id])
		return reading->names[id];
	snprintf(out, 16, "#%d", id);
	return out;
}

/*
 * Takes "NAME.z" or "#ID.z" apart; false: it is not of that form, or there is no such body that
 * moves.
 */
static bool find_body(const struct rb_reading *reading, const char *text, int *body, int *part)
{
	const char *const dot = strrchr(text, '.');

	if (!dot)
		return false;
	for (int k = 0; k < PART_COUNT; k++)
		for (int i = 0; i < reading->body_count; i++) {
			char number[16];
			const char *const name = label_of(reading, reading->id[i], number);
			if (strcmp(dot + 1, parts[k].name) != 0 ||
			    strlen(name) != (size_t)(dot - text) ||
			    strncmp(name, text, (size_t)(dot - text)) != 0)
				continue;
			*body = i;
			*part = k;
			return true;
		}
	return false;
}

/* Reads a quantity of a body at all frames. */
static enum rb_status read_body(struct graph *graph, int body, int part, double *out,
                                struct rb_error *err)
{
	struct rb_frame frame;

	for (uint64_t row = 0; row < graph->count; row++) {
		const enum rb_status status = graph->module->reader_frame(graph->reader, row,
		                                                          &frame, err);
		if (status)
			return status;
		const double *from;
		memcpy(&from, (const char *)&frame + parts[part].column, sizeof from);
		if (!from)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' does not record what '%s' needs",
			               graph->file, parts[part].name);
		out[row] = parts[part].axis < 0 ? rb_vec3_length(rb_vec3_from(from + 3 * body))
		                                : from[3 * body + parts[part].axis];
	}
	return RB_OK;
}

/* Reads a number for each frame; of vectors their length; the energy is the sum of both. */
static enum rb_status read_observable(struct graph *graph, const char *name, double *out,
                                      struct rb_error *err)
{
	const struct rb_hdf5_module *const module = graph->module;
	double *const more = rb_memory_take(graph->count, 3 * sizeof *more);
	enum rb_status status;

	if (!more)
		return no_memory(err);
	if (strcmp(name, "energy") == 0) {
		status = module->reader_observable(graph->reader, "kinetic_energy", 1, out, err);
		if (!status)
			status = module->reader_observable(graph->reader, "potential_energy", 1,
			                                   more, err);
		for (uint64_t i = 0; i < graph->count && !status; i++)
			out[i] += more[i];
	} else if (module->reader_observable(graph->reader, name, 1, out, NULL) == RB_OK) {
		status = RB_OK;
	} else {
		status = module->reader_observable(graph->reader, name, 3, more, NULL);
		for (uint64_t i = 0; i < graph->count && !status; i++)
			out[i] = rb_vec3_length(rb_vec3_from(more + 3 * i));
		if (status)
			status = RB_FAIL(
				err, RB_ERR_USAGE,
				"'%s' has no quantity '%s' (wanted: energy, kinetic_energy, "
				"momentum, max_penetration, ..., or BODY.x, .vx, .wx, .ax, .fx, "
				".tx and so for y and z, .speed, .spin, .acceleration, .force, "
				".torque; BODY: a name, or #ID of one without)",
				graph->file, name);
	}
	rb_memory_free(more);
	return status;
}

/* Reads all quantities of a recording. */
static enum rb_status read_run(struct graph *graph, struct rb_error *err)
{
	const struct rb_reading *const reading = graph->module->reader_reading(graph->reader);
	enum rb_status status = RB_OK;
	int body, part;

	graph->count = reading->frame_count;
	graph->x_label = "time [s]";
	graph->x = rb_memory_take(graph->count + 1, sizeof *graph->x);
	if (!graph->x)
		return no_memory(err);
	for (uint64_t row = 0; row < graph->count && !status; row++) {
		struct rb_frame frame;
		status = graph->module->reader_frame(graph->reader, row, &frame, err);
		graph->x[row] = frame.time_s;
	}
	for (int k = 0; k < graph->quantity_count && !status; k++) {
		graph->y[k] = rb_memory_take(graph->count + 1, sizeof *graph->y[k]);
		if (!graph->y[k])
			return no_memory(err);
		if (find_body(reading, quantity(graph, k), &body, &part))
			status = read_body(graph, body, part, graph->y[k], err);
		else
			status = read_observable(graph, quantity(graph, k), graph->y[k], err);
	}
	return status;
}

/* ---- a collected sweep: results against a parameter ---- */

/* Reads a column of a collected sweep, looked for in its groups one after the other. */
static enum rb_status read_column(struct graph *graph, const char *name, double **out,
                                  struct rb_error *err)
{
	static const char *const groups[] = {"results", "parameters", "expectations", "points"};
	uint64_t count;

	for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
		const enum rb_status status = graph->module->column(graph->file, groups[i], name,
		                                                    out, &count, err);
		if (status != RB_ERR_INPUT || i + 1 == sizeof groups / sizeof *groups) {
			if (!status && graph->count != 0 && count != graph->count)
				return RB_FAIL(err, RB_ERR_INPUT,
				               "'%s' is damaged: '%s' has %" PRIu64 " values",
				               graph->file, name, count);
			graph->count = count;
			return status;
		}
	}
	return RB_OK;
}

/* Reads the parameter and all quantities of a collected sweep. */
static enum rb_status read_sweep(struct graph *graph, struct rb_error *err)
{
	const char *const against = graph->options->against ? graph->options->against : "index";
	enum rb_status status = read_column(graph, against, &graph->x, err);

	graph->x_label = against;
	for (int k = 0; k < graph->quantity_count && !status; k++)
		status = read_column(graph, quantity(graph, k), &graph->y[k], err);
	return status;
}

/* ---- the picture ---- */

/* Extends a range by the finite values of a column. */
static void widen(const double *values, uint64_t count, double *low, double *high)
{
	for (uint64_t i = 0; i < count; i++) {
		if (!isfinite(values[i]))
			continue;
		*low = fmin(*low, values[i]);
		*high = fmax(*high, values[i]);
	}
}

/* Adds room around a range, so that no cross hides in the frame. */
static void add_room(double *low, double *high)
{
	const double span = *high - *low;
	const double room = span > 0 ? 0.04 * span : *high != 0 ? 0.04 * fabs(*high) : 1;

	*low -= room;
	*high += room;
}

/* Draws the diagram to where it is wanted. */
static enum rb_status draw(const struct graph *graph, struct rb_error *err)
{
	const char *const output = graph->options->output;
	const size_t size = output ? strlen(output) : 0;
	const bool svg = size > 4 && strcmp(output + size - 4, ".svg") == 0;
	const bool png = size > 4 && strcmp(output + size - 4, ".png") == 0;
	struct rb_plot plot = {.title = graph->file,
	                       .x_label = graph->x_label,
	                       .y_label = graph->quantity_count == 1 ? quantity(graph, 0) : "",
	                       .x_low = (double)NAN,
	                       .x_high = (double)NAN,
	                       .y_low = (double)NAN,
	                       .y_high = (double)NAN,
	                       .series = graph->series,
	                       .series_count = graph->quantity_count};
	struct rb_outfile out;

	for (int k = 0; k < graph->quantity_count; k++) {
		bool any = false;
		for (uint64_t i = 0; i < graph->count; i++)
			any = any || (isfinite(graph->x[i]) && isfinite(graph->y[k][i]));
		if (!any)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' has no values of '%s'", graph->file,
			               quantity(graph, k));
	}
	if (!graph->reader) {
		widen(graph->x, graph->count, &plot.x_low, &plot.x_high);
		for (int k = 0; k < graph->quantity_count; k++)
			widen(graph->y[k], graph->count, &plot.y_low, &plot.y_high);
		add_room(&plot.x_low, &plot.x_high);
		add_room(&plot.y_low, &plot.y_high);
	}
	if (!output)
		return rb_plot_draw(&plot, RB_PLOT_TEXT, rb_plot_text_size(), stdout, err);
	if (!svg && !png)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--output': '%s' must end in .svg or .png", output);
	enum rb_status status = rb_outfile_open(&out, output, graph->options->force, err);
	if (status)
		return status;
	status = rb_plot_draw(&plot, svg ? RB_PLOT_SVG : RB_PLOT_PNG,
	                      (struct rb_plot_size){.width = 900, .height = 650}, out.file, err);
	if (!status)
		return rb_outfile_publish(&out, err);
	rb_outfile_release(&out);
	return status;
}

static enum rb_status read_all(struct graph *graph, struct rb_error *err)
{
	struct rb_error other;
	double *index;
	uint64_t count;
	enum rb_status status = rb_module_hdf5(&graph->module, err);

	if (status)
		return status;
	graph->y = rb_memory_take((size_t)graph->quantity_count, sizeof *graph->y);
	graph->series = rb_memory_take((size_t)graph->quantity_count, sizeof *graph->series);
	if (!graph->y || !graph->series)
		return no_memory(err);
	const bool sweep = graph->module->column(graph->file, "points", "index", &index, &count,
	                                         &other) == RB_OK;
	if (sweep)
		rb_memory_free(index);
	if (!sweep && graph->options->against)
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--against' is for collected sweeps; '%s' is plotted against time",
			graph->file);
	status = sweep ? RB_OK : graph->module->reader_open(&graph->reader, graph->file, err);
	if (!status)
		status = sweep ? read_sweep(graph, err) : read_run(graph, err);
	for (int k = 0; k < graph->quantity_count && !status; k++)
		graph->series[k] = (struct rb_plot_series){.name = quantity(graph, k),
		                                           .x = graph->x,
		                                           .y = graph->y[k],
		                                           .count = (int)graph->count,
		                                           .crosses = sweep,
		                                           .plain = !sweep,
		                                           .like = k};
	return status;
}

int rb_graph_main(const struct rb_options *options)
{
	struct graph graph = {.options = options, .file = options->words[0]};
	struct rb_error err;
	enum rb_status status = rb_plot_available("", &err);

	graph.quantity_count = options->word_count - 1;
	if (!status)
		status = read_all(&graph, &err);
	if (!status)
		status = draw(&graph, &err);
	for (int k = 0; graph.y && k < graph.quantity_count; k++)
		rb_memory_free(graph.y[k]);
	rb_memory_free(graph.y);
	rb_memory_free(graph.x);
	rb_memory_free(graph.series);
	if (graph.reader)
		graph.module->reader_close(graph.reader);
	return rb_app_finish(options, status ? rb_app_refuse(options, &err) : 0);
}
