/* SPDX-License-Identifier: MIT */
#include "app/graph.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/json.h"
#include "app/plot.h"
#include "app/recorded_quantity.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "flow/quantity.h"
#include "sink/module.h"

enum { LABEL_SIZE = 256 };

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
	const char *x_name, *x_units;
	const char **units;                  /* owned: of each quantity, the texts borrowed */
	char (*texts)[RB_COLUMN_UNITS_SIZE]; /* owned: of a sweep's columns, x last */
	char (*names)[LABEL_SIZE];           /* owned: of each series */
	char x_label[LABEL_SIZE], y_label[LABEL_SIZE];
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

/* ---- a run: quantities against time, or against each other ---- */

/* Reads all quantities of a recording. */
static enum rb_status read_run(struct graph *graph, struct rb_error *err)
{
	const struct rb_reading *const reading = graph->module->reader_reading(graph->reader);
	const struct rb_quantity_source source = {graph->module, graph->reader, graph->file};
	enum rb_status status = RB_OK;

	graph->count = reading->frame_count;
	graph->x_name = graph->options->against ? graph->options->against : "time";
	graph->x = rb_memory_take(graph->count + 1, sizeof *graph->x);
	if (!graph->x)
		return no_memory(err);
	status = rb_quantity_read(&source, graph->x_name, graph->x, &graph->x_units, err);
	for (int k = 0; k < graph->quantity_count && !status; k++) {
		graph->y[k] = rb_memory_take(graph->count + 1, sizeof *graph->y[k]);
		if (!graph->y[k])
			return no_memory(err);
		status = rb_quantity_read(&source, quantity(graph, k), graph->y[k],
		                          &graph->units[k], err);
	}
	return status;
}

/* ---- a collected sweep: results against a parameter ---- */

/* Reads a column of a collected sweep, looked for in its groups one after the other. */
static enum rb_status read_column(struct graph *graph, const char *name, double **out, char *units,
                                  struct rb_error *err)
{
	static const char *const groups[] = {"results", "probes", "parameters", "expectations",
	                                     "points"};
	uint64_t count;

	for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
		const struct rb_column_name column = {graph->file, groups[i], name};
		const enum rb_status status = graph->module->column(&column, out, &count, units,
		                                                    err);
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
	const int count = graph->quantity_count;

	graph->texts = rb_memory_take((size_t)count + 1, sizeof *graph->texts);
	if (!graph->texts)
		return no_memory(err);
	graph->x_name = against;
	graph->x_units = graph->texts[count];
	enum rb_status status = read_column(graph, against, &graph->x, graph->texts[count], err);
	for (int k = 0; k < count && !status; k++) {
		graph->units[k] = graph->texts[k];
		status = read_column(graph, quantity(graph, k), &graph->y[k], graph->texts[k], err);
	}
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

/*
 * Adds room around a range, so that no cross hides in the frame, and what varies by rounding alone
 * is seen to be constant.
 */
static void add_room(double *low, double *high)
{
	const double size = fmax(fabs(*low), fabs(*high));
	const double span = rb_quantity_is_flat(*low, *high, 0) ? size : *high - *low;
	const double room = span > 0 ? 0.04 * span : 1;

	*low -= room;
	*high += room;
}

/* "height [m]", "bounces", "[m]", "". */
static const char *label_of(const char *name, const char *units, char out[LABEL_SIZE])
{
	snprintf(out, LABEL_SIZE, "%s%s%s%s%s", name, *name && *units ? " " : "", *units ? "[" : "",
	         units, *units ? "]" : "");
	return out;
}

/* Units that all quantities share; NULL: they differ. */
static const char *common_units(const struct graph *graph)
{
	for (int k = 1; k < graph->quantity_count; k++)
		if (strcmp(graph->units[k], graph->units[0]) != 0)
			return NULL;
	return graph->units[0];
}

/* Writes the labels: the units at the axis where all share them, else at each name. */
static void write_labels(struct graph *graph)
{
	const char *const units = common_units(graph);

	label_of(graph->x_name, graph->x_units, graph->x_label);
	label_of(graph->quantity_count == 1 ? quantity(graph, 0) : "", units ? units : "",
	         graph->y_label);
	for (int k = 0; k < graph->quantity_count; k++)
		graph->series[k].name = label_of(quantity(graph, k), units ? "" : graph->units[k],
		                                 graph->names[k]);
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
	                       .y_label = graph->y_label,
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
	for (int k = 0; k < graph->quantity_count; k++)
		widen(graph->y[k], graph->count, &plot.y_low, &plot.y_high);
	if (!graph->reader || graph->options->against) {
		widen(graph->x, graph->count, &plot.x_low, &plot.x_high);
		add_room(&plot.x_low, &plot.x_high);
		add_room(&plot.y_low, &plot.y_high);
	} else if (rb_quantity_is_flat(plot.y_low, plot.y_high, 0)) {
		add_room(&plot.y_low, &plot.y_high);
	} else { /* the usual range, which ends at round numbers */
		plot.y_low = plot.y_high = (double)NAN;
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
	graph->units = rb_memory_take((size_t)graph->quantity_count, sizeof *graph->units);
	graph->names = rb_memory_take((size_t)graph->quantity_count, sizeof *graph->names);
	if (!graph->y || !graph->series || !graph->units || !graph->names)
		return no_memory(err);
	const struct rb_column_name first = {graph->file, "points", "index"};
	const bool sweep = graph->module->column(&first, &index, &count, NULL, &other) == RB_OK;
	if (sweep)
		rb_memory_free(index);
	status = sweep ? RB_OK : graph->module->reader_open(&graph->reader, graph->file, err);
	if (!status)
		status = sweep ? read_sweep(graph, err) : read_run(graph, err);
	for (int k = 0; k < graph->quantity_count && !status; k++)
		graph->series[k] = (struct rb_plot_series){.x = graph->x,
		                                           .y = graph->y[k],
		                                           .count = (int)graph->count,
		                                           .crosses = sweep,
		                                           .plain = !sweep,
		                                           .like = k};
	if (!status)
		write_labels(graph);
	return status;
}

/* Writes a column with its name. */
static void print_column(struct rb_json *json, const struct graph *graph, const char *key, int k)
{
	const double *const values = k < 0 ? graph->x : graph->y[k];

	rb_json_open(json, key, '{');
	rb_json_text(json, "name", k < 0 ? graph->x_name : quantity(graph, k));
	rb_json_text(json, "unit", k < 0 ? graph->x_units : graph->units[k]);
	rb_json_open(json, "values", '[');
	for (uint64_t i = 0; i < graph->count; i++)
		rb_json_number(json, NULL, values[i]);
	rb_json_close(json, ']');
	rb_json_close(json, '}');
}

/* Prints what is drawn as numbers. */
static void print_json(const struct graph *graph)
{
	struct rb_json json = {.file = stdout};

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "file", graph->file);
	print_column(&json, graph, "against", -1);
	rb_json_open(&json, "quantities", '[');
	for (int k = 0; k < graph->quantity_count; k++)
		print_column(&json, graph, NULL, k);
	rb_json_close(&json, ']');
	rb_json_text(&json, "picture", graph->options->output);
	rb_json_count(&json, "exit_status", 0);
	rb_json_close(&json, '}');
	putchar('\n');
}

int rb_graph_main(const struct rb_options *options)
{
	struct graph graph = {.options = options, .file = options->words[0]};
	const bool draws = !options->json || options->output;
	struct rb_error err;
	enum rb_status status = draws ? rb_plot_available("", &err) : RB_OK;

	graph.quantity_count = options->word_count - 1;
	if (!status)
		status = read_all(&graph, &err);
	if (!status && draws)
		status = draw(&graph, &err);
	if (!status && options->json)
		print_json(&graph);
	for (int k = 0; graph.y && k < graph.quantity_count; k++)
		rb_memory_free(graph.y[k]);
	rb_memory_free(graph.y);
	rb_memory_free(graph.x);
	rb_memory_free(graph.series);
	rb_memory_free(graph.units);
	rb_memory_free(graph.texts);
	rb_memory_free(graph.names);
	if (graph.reader)
		graph.module->reader_close(graph.reader);
	return rb_app_finish(options, status ? rb_app_refuse(options, &err) : 0);
}
