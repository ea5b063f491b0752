/* SPDX-License-Identifier: MIT */
#include "app/chart.h"

#include <inttypes.h>
#include <math.h>

#include "app/common.h"
#include "app/json.h"
#include "base/memory.h"

/* ---- the picture ---- */

/* Range of both axes; both are logarithmic. */
struct frame_of_axes {
	double x_low, x_high, y_low, y_high;
	bool has_zero;
};

/* The next whole decade below a value, with room, so that no point hides in the frame. */
static double decade_below(double value)
{
	return pow(10, floor(log10(value / 1.5)));
}

/* The same above. */
static double decade_above(double value)
{
	return pow(10, ceil(log10(value * 1.5)));
}

/*
 * Whole decades around all points; one more to the left where an error is 0, which has no
 * logarithm.
 */
static struct frame_of_axes axes_of(const struct rb_report *report)
{
	double x_low = (double)INFINITY, x_high = 0, y_low = (double)INFINITY, y_high = 0;
	bool has_zero = false;

	for (int i = 0; i < report->row_count; i++) {
		const struct rb_report_row *const row = &report->rows[i];
		const double error = rb_report_least_error(report, row), wall = row->result.wall_s;
		if (!isfinite(error))
			continue;
		y_low = fmin(y_low, wall);
		y_high = fmax(y_high, wall);
		has_zero = has_zero || error == 0;
		if (error > 0) {
			x_low = fmin(x_low, error);
			x_high = fmax(x_high, error);
		}
	}
	if (x_high == 0) /* all are 0: around what a double can tell from 1 */
		x_low = x_high = 3e-16;
	if (y_high == 0)
		y_low = y_high = 3e-3;
	return (struct frame_of_axes){.x_low = decade_below(has_zero ? x_low / 10 : x_low),
	                              .x_high = decade_above(x_high),
	                              .y_low = decade_below(y_low),
	                              .y_high = decade_above(y_high),
	                              .has_zero = has_zero};
}

/* A line and its crosses for each method. */
struct drawing {
	struct rb_plot_series *series; /* owned, as all below */
	double *numbers;
	char (*names)[64];
};

/* Takes memory for a line and its crosses for each method. False: no memory. */
static bool drawing_init(struct drawing *drawing, const struct rb_report *report)
{
	const size_t methods = (size_t)report->method_count;

	drawing->series = rb_memory_take(2 * methods, sizeof *drawing->series);
	drawing->names = rb_memory_take(methods, sizeof *drawing->names);
	drawing->numbers = rb_memory_take(4 * methods * ((size_t)report->row_count + 1),
	                                  sizeof *drawing->numbers);
	return drawing->series && drawing->names && drawing->numbers;
}

static void drawing_release(struct drawing *drawing)
{
	rb_memory_free(drawing->series);
	rb_memory_free(drawing->names);
	rb_memory_free(drawing->numbers);
}

/*
 * Of what failed no error is known: its cross stands at the top edge, counted from the right one,
 * so that none hides another.
 */
static void place_cross(const struct frame_of_axes *axes, int number, double *x, double *y)
{
	const double decades = log10(axes->x_high / axes->x_low);
	const double rise = log10(axes->y_high / axes->y_low);

	*x = axes->x_high * pow(10, -decades * 0.03 * (1 + number % 32));
	*y = axes->y_high * pow(10, -rise * 0.07);
}

/* Makes the series from the rows. */
static void fill(struct drawing *drawing, const struct rb_report *report,
                 const struct frame_of_axes *axes)
{
	const size_t rows = (size_t)report->row_count;
	int failed = 0;

	for (int m = 0; m < report->method_count; m++) {
		double *const x = drawing->numbers + 4 * (size_t)m * rows;
		double *const y = x + rows, *const cross_x = y + rows,
			      *const cross_y = cross_x + rows;
		int points = 0, crosses = 0;
		for (int i = 0; i < report->row_count; i++) {
			const struct rb_report_row *const row = &report->rows[i];
			const double error = rb_report_least_error(report, row);
			if (row->method != m)
				continue;
			if (row->result.state != RB_RUNG_OK) {
				place_cross(axes, failed++, &cross_x[crosses], &cross_y[crosses]);
				crosses++;
			} else {
				x[points] = error == 0 ? axes->x_low : error;
				y[points++] = row->result.wall_s;
			}
		}
		snprintf(drawing->names[m], sizeof drawing->names[m], "%s, failed",
		         report->methods[m].method->name);
		drawing->series[2 * m] = (struct rb_plot_series){
			.name = report->methods[m].method->name,
			.x = x,
			.y = y,
			.count = points,
			.like = m};
		drawing->series[2 * m + 1] = (struct rb_plot_series){.name = drawing->names[m],
		                                                     .x = cross_x,
		                                                     .y = cross_y,
		                                                     .count = crosses,
		                                                     .crosses = true,
		                                                     .like = m};
	}
}

enum rb_status rb_chart_draw(FILE *file, const struct rb_report *report, enum rb_plot_kind kind,
                             struct rb_plot_size size, struct rb_error *err)
{
	const struct rb_quantity_row *const quantity = &rb_quantities[report->quantity];
	const struct frame_of_axes axes = axes_of(report);
	struct drawing drawing = {0};
	char label[160];
	enum rb_status status = RB_OK;

	snprintf(label, sizeof label, "largest error of %s%s%s%s", quantity->name,
	         *quantity->unit ? " / " : "", quantity->unit,
	         axes.has_zero ? " (left edge: error 0)" : "");
	if (!drawing_init(&drawing, report)) {
		status = RB_FAIL(err, RB_ERR_MEMORY, "cannot draw %d rows: out of memory",
		                 report->row_count);
	} else {
		fill(&drawing, report, &axes);
		const bool titled = report->title && *report->title;
		const struct rb_plot plot = {.title = titled ? report->title : report->scene,
		                             .x_label = label,
		                             .y_label = "wall time / s",
		                             .x_log = true,
		                             .y_log = true,
		                             .x_low = axes.x_low,
		                             .x_high = axes.x_high,
		                             .y_low = axes.y_low,
		                             .y_high = axes.y_high,
		                             .series = drawing.series,
		                             .series_count = 2 * report->method_count};
		status = rb_plot_draw(&plot, kind, size, file, err);
	}
	drawing_release(&drawing);
	return status;
}

/* ---- CSV ---- */

/* A cell with a number; empty where there is none. */
static void put_number(FILE *file, double value)
{
	if (isfinite(value))
		fprintf(file, ",%.17g", value);
	else
		putc(',', file);
}

/* A cell with a text. */
static void put_quoted(FILE *file, const char *text)
{
	fputs(",\"", file);
	for (; *text; text++) {
		if (*text == '"')
			putc('"', file);
		putc(*text, file);
	}
	putc('"', file);
}

void rb_chart_print_csv(FILE *file, const struct rb_report *report)
{
	fputs("method,rollback,time_step,tolerance,status,exit_status", file);
	for (int q = 0; q < RB_QUANTITY_COUNT; q++)
		fprintf(file, ",%s_max,%s_rms,%s_final", rb_quantities[q].name,
		        rb_quantities[q].name, rb_quantities[q].name);
	fputs(",events,rollbacks,body_steps,discarded_body_steps,discarded_share,"
	      "wall_time,cpu_time,runs,message\n",
	      file);
	for (int i = 0; i < report->row_count; i++) {
		const struct rb_report_row *const row = &report->rows[i];
		const struct rb_rung_result *const result = &row->result;
		const struct rb_ladder_method *const method = report->methods[row->method].method;
		const bool ok = result->state == RB_RUNG_OK;
		fprintf(file, "%s,%s", method->method, method->rollback);
		put_number(file, row->time_step_s);
		put_number(file, row->tolerance_m);
		fprintf(file, ",%s,%d", rb_rung_state_name(result->state), result->exit_status);
		for (int q = 0; q < RB_QUANTITY_COUNT; q++) {
			const struct rb_deviation *const of = &result->of[q];
			const bool known = ok && of->count > 0;
			put_number(file, known ? of->max : (double)NAN);
			put_number(file, known ? of->rms : (double)NAN);
			put_number(file, known ? of->final : (double)NAN);
		}
		if (ok) {
			fprintf(file, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64,
			        result->events, result->rollbacks, result->body_steps,
			        result->discarded_body_steps);
			put_number(file, rb_report_discarded(result));
			put_number(file, result->wall_s);
			put_number(file, result->cpu_s);
			fprintf(file, ",%d", result->runs);
		} else {
			fputs(",,,,,,,,", file);
		}
		put_quoted(file, result->text);
		putc('\n', file);
	}
}

/* ---- JSON ---- */

static void json_errors(struct rb_json *json, const struct rb_rung_result *result)
{
	rb_json_open(json, "errors", '{');
	for (int q = 0; q < RB_QUANTITY_COUNT; q++) {
		const struct rb_deviation *const of = &result->of[q];
		if (of->count == 0)
			continue;
		rb_json_open(json, rb_quantities[q].name, '{');
		rb_json_number(json, "max", of->max);
		rb_json_number(json, "rms", of->rms);
		rb_json_number(json, "final", of->final);
		rb_json_close(json, '}');
	}
	rb_json_close(json, '}');
}

static void json_row(struct rb_json *json, const struct rb_report *report,
                     const struct rb_report_row *row)
{
	const struct rb_rung_result *const result = &row->result;
	const struct rb_ladder_method *const method = report->methods[row->method].method;

	rb_json_open(json, NULL, '{');
	rb_json_text(json, "method", method->method);
	rb_json_text(json, "rollback", method->rollback);
	rb_json_number(json, "time_step", row->time_step_s);
	rb_json_number(json, "tolerance", row->tolerance_m);
	rb_json_text(json, "status", rb_rung_state_name(result->state));
	rb_json_count(json, "exit_status", (uint64_t)result->exit_status);
	rb_json_text(json, "message", result->text);
	if (result->state == RB_RUNG_OK) {
		rb_json_number(json, "error", rb_report_error(report, row));
		json_errors(json, result);
		rb_json_number(json, "max_penetration", result->max_penetration_m);
		rb_json_count(json, "events", result->events);
		rb_json_count(json, "rollbacks", result->rollbacks);
		rb_json_count(json, "body_steps", result->body_steps);
		rb_json_count(json, "discarded_body_steps", result->discarded_body_steps);
		rb_json_number(json, "discarded_share", rb_report_discarded(result));
		rb_json_number(json, "wall_time", result->wall_s);
		rb_json_number(json, "cpu_time", result->cpu_s);
		rb_json_count(json, "runs", (uint64_t)result->runs);
	}
	rb_json_close(json, '}');
}

static void json_methods(struct rb_json *json, const struct rb_report *report)
{
	rb_json_open(json, "methods", '[');
	for (int i = 0; i < report->method_count; i++) {
		const struct rb_report_method *const of = &report->methods[i];
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "name", of->method->name);
		rb_json_text(json, "method", of->method->method);
		rb_json_text(json, "rollback", of->method->rollback);
		rb_json_number(json, "order", of->order);
		rb_json_count(json, "order_points", (uint64_t)of->order_points);
		rb_json_text(json, "order_note", of->order_note);
		rb_json_text(json, "left_out", of->left_out);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}

void rb_chart_print_json(FILE *file, const struct rb_report *report, int exit_code)
{
	struct rb_json json = {.file = file};

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "scene", report->scene);
	rb_json_text(&json, "title", report->title);
	rb_json_count(&json, "bodies", (uint64_t)report->body_count);
	rb_json_count(&json, "frame_count", report->frame_count);
	rb_json_number(&json, "duration", report->duration_s);
	rb_json_text(&json, "quantity", rb_quantities[report->quantity].name);
	rb_json_text(&json, "unit", rb_quantities[report->quantity].unit);
	rb_json_number(&json, "wanted_error", report->error);
	rb_json_text(&json, "dial", report->by_tolerance ? "tolerance" : "time_step");
	rb_json_count(&json, "threads", (uint64_t)report->threads);
	rb_json_number(&json, "budget", report->budget_s);
	rb_json_number(&json, "spent", report->spent_s);
	rb_json_open(&json, "reference", '{');
	rb_json_text(&json, "kind", report->own_reference ? "scene" : "run");
	rb_json_text(&json, "what", report->reference);
	rb_json_number(&json, "error", report->reference_error);
	rb_json_bool(&json, "agrees", report->reference_agrees);
	rb_json_bool(&json, "diverges", report->diverges);
	rb_json_number(&json, "horizon", report->horizon_s);
	rb_json_text(&json, "warning", report->warning);
	rb_json_close(&json, '}');
	rb_json_bool(&json, "energy_is_drift", report->energy_drifts);
	json_methods(&json, report);
	rb_json_open(&json, "rows", '[');
	for (int i = 0; i < report->row_count; i++)
		json_row(&json, report, &report->rows[i]);
	rb_json_close(&json, ']');
	rb_json_open(&json, "advice", '{');
	rb_json_text(&json, "text", report->advice);
	rb_json_number(&json, "row", report->advised >= 0 ? (double)report->advised : (double)NAN);
	rb_json_close(&json, '}');
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_close(&json, '}');
	putc('\n', file);
}
