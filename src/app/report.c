/* SPDX-License-Identifier: MIT */
/*
 * An order is the slope of log error over log dial, by least squares over the points above the
 * floor of rounding and of the reference's own error; it is stated only where the points lie on a
 * line and the error falls at all. Advice names the setting with the least wall time that reaches
 * the wanted error; times within ten percent count as equal, because machines are not quieter than
 * that.
 */
#include "app/report.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/common.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"

/*
 * Ratio of wall time to processor time above which the machine was too busy for times to be taken
 * at face value.
 */
static const double busy_most = 1.3;
/* Squared correlation below which points do not lie on a line. */
static const double line_least = 0.7;

double rb_report_error(const struct rb_report *report, const struct rb_report_row *row)
{
	const struct rb_deviation *const of = &row->result.of[report->quantity];

	return row->result.state == RB_RUNG_OK && of->count > 0 ? of->max : (double)NAN;
}

double rb_report_least_error(const struct rb_report *report, const struct rb_report_row *row)
{
	const double error = rb_report_error(report, row);
	/*
	 * up to the horizon, runs agree within the wanted error: that is all that is known of them
	 */
	const double known = isfinite(report->horizon_s) ? report->error : report->reference_error;
	const bool judged = !report->diverges || isfinite(report->horizon_s);

	return !report->own_reference && judged && error < known ? known : error;
}

/* The setting that a ladder varies. */
static double dial(const struct rb_report *report, const struct rb_report_row *row)
{
	return report->by_tolerance ? row->tolerance_m : row->time_step_s;
}

/* ---- conclusions ---- */

/* Below this, what is seen is rounding, or the reference. */
static double floor_of(const struct rb_report *report, const struct rb_report_row *row)
{
	const double rounding = 256 * DBL_EPSILON * row->result.of[report->quantity].largest;
	const double reference = report->own_reference ? 0 : 10 * report->reference_error;

	return isnan(reference) ? rounding : fmax(rounding, reference);
}

/* Of the logarithms of dial and error; an order is their slope where they lie on a line. */
struct sums {
	double n, x, y, xx, xy, yy;
	double least, most; /* of x */
};

/*
 * Takes the slope as the order, or notes why there is none. `known`: points with an error at all.
 */
static void judge_fit(const struct rb_report *report, struct rb_report_method *of,
                      const struct sums *s, int known)
{
	const double spread = s->n * s->xx - s->x * s->x, height = s->n * s->yy - s->y * s->y;
	const double both = s->n * s->xy - s->x * s->y;
	const char *const reference = report->own_reference ? "" : " or those of the reference";
	const char *const dial_name = report->by_tolerance ? "tolerance" : "time step";

	if (report->diverges)
		snprintf(of->order_note, sizeof of->order_note,
		         "none: refining does not lead to one answer");
	else if (known > 0 && s->n == 0)
		snprintf(of->order_note, sizeof of->order_note,
		         "none: all errors are those of rounding%s", reference);
	else if (s->n < 2 || !(spread > 1e-9 * s->n * s->xx))
		snprintf(of->order_note, sizeof of->order_note,
		         "none: it takes two points with errors above those of rounding%s",
		         reference);
	else if (!(both / spread * (s->most - s->least) >= log(2))) /* by half, over all points */
		snprintf(of->order_note, sizeof of->order_note,
		         "none: the errors do not fall with the %s", dial_name);
	else if (both * both < line_least * spread * height)
		snprintf(of->order_note, sizeof of->order_note,
		         "none: the errors follow no power of the %s", dial_name);
	else {
		of->order = both / spread;
		of->order_points = (int)s->n;
	}
}

/* Least squares through the logarithms of what lies above the floor. */
static void fit(struct rb_report *report, int method)
{
	struct rb_report_method *const of = &report->methods[method];
	struct sums s = {0};
	int known = 0;

	RB_ASSERT(method >= 0 && method < report->method_count);
	of->order = (double)NAN;
	of->order_points = 0;
	for (int i = 0; i < report->row_count; i++) {
		const struct rb_report_row *const row = &report->rows[i];
		const double error = rb_report_error(report, row);
		if (row->method != method || !isfinite(error))
			continue;
		known++;
		if (error <= floor_of(report, row))
			continue;
		const double u = log(dial(report, row)), v = log(error);
		s.least = s.n > 0 ? fmin(s.least, u) : u;
		s.most = s.n > 0 ? fmax(s.most, u) : u;
		s.n += 1;
		s.x += u;
		s.y += v;
		s.xx += u * u;
		s.xy += u * v;
		s.yy += v * v;
	}
	judge_fit(report, of, &s, known);
}

/* A time in s, ms or us. */
static const char *seconds(double value, char out[32])
{
	if (value < 1e-3)
		snprintf(out, 32, "%.3g us", value * 1e6);
	else if (value < 1)
		snprintf(out, 32, "%.3g ms", value * 1e3);
	else
		snprintf(out, 32, "%.3g s", value);
	return out;
}

/* A value of the quantity with its unit: "1e-06 m". */
static const char *measure(const struct rb_report *report, double value, char out[64])
{
	const char *unit = rb_quantities[report->quantity].unit;

	snprintf(out, 64, "%.3g%s%s", value, *unit ? " " : "", unit);
	return out;
}

/* A setting in words. */
static const char *setting(const struct rb_report *report, const struct rb_report_row *row,
                           char out[160])
{
	const struct rb_ladder_method *const method = report->methods[row->method].method;

	if (isnan(row->tolerance_m))
		snprintf(out, 160, "method %s, rollback %s, time step %.6g s", method->method,
		         method->rollback, row->time_step_s);
	else
		snprintf(out, 160, "method %s, rollback %s, time step %.6g s, tolerance %.6g m",
		         method->method, method->rollback, row->time_step_s, row->tolerance_m);
	return out;
}

/* Walls that differ by less are equal: machines are not that quiet. */
static const double wall_noise = 1.1;

/*
 * The least wall time of those that reach the wanted error; of equal ones the most accurate, then
 * the coarsest. -1: none does.
 */
static int find_cheapest(const struct rb_report *report)
{
	double least_s = (double)INFINITY;
	int cheapest = -1;

	for (int i = 0; i < report->row_count; i++)
		if (rb_report_error(report, &report->rows[i]) <= report->error)
			least_s = fmin(least_s, report->rows[i].result.wall_s);
	for (int i = 0; i < report->row_count; i++) {
		const struct rb_report_row *const row = &report->rows[i];
		if (rb_report_error(report, row) <= report->error &&
		    row->result.wall_s <= wall_noise * least_s &&
		    (cheapest < 0 || rb_report_error(report, row) <
		                             rb_report_error(report, &report->rows[cheapest])))
			cheapest = i;
	}
	return cheapest;
}

/* Composes the advice. */
static void advise(struct rb_report *report)
{
	const int cheapest = find_cheapest(report);
	int closest = -1;
	char text[160], wanted[64], error[64], wall[32], until[64] = "";
	const char *hidden = "";

	for (int i = 0; i < report->row_count; i++) {
		const struct rb_report_row *const row = &report->rows[i];
		const double e = rb_report_error(report, row);
		if (!isfinite(e))
			continue;
		if (closest < 0 || e < rb_report_error(report, &report->rows[closest]))
			closest = i;
	}
	report->advised = cheapest;
	measure(report, report->error, wanted);
	if (closest < 0) {
		snprintf(report->advice, sizeof report->advice,
		         "no error of %s is available for a recommendation",
		         rb_quantities[report->quantity].name);
		return;
	}
	const struct rb_report_row *const row = &report->rows[cheapest >= 0 ? cheapest : closest];
	const double e = rb_report_least_error(report, row);
	if (e > rb_report_error(report, row))
		hidden = "at most ";
	measure(report, e, error);
	seconds(row->result.wall_s, wall);
	setting(report, row, text);
	if (isfinite(report->horizon_s))
		snprintf(until, sizeof until, "up to %.4g s: ", report->horizon_s);
	if (cheapest < 0)
		snprintf(report->advice, sizeof report->advice,
		         "%sno setting reaches an error of %s: %s comes closest, with %s, which is "
		         "%.3g times too much, in %s a run",
		         until, wanted, text, error, e / report->error, wall);
	else if (!report->own_reference && !*until && !(report->reference_error <= report->error))
		snprintf(report->advice, sizeof report->advice,
		         "an error of %s cannot be judged, since that of the reference is %s; the "
		         "cheapest that agrees with it so far is %s: %s a run",
		         wanted,
		         isnan(report->reference_error)
		                 ? "not known"
		                 : measure(report, report->reference_error, error),
		         text, wall);
	else
		snprintf(report->advice, sizeof report->advice,
		         "%sfor an error of %s the cheapest is %s: %s a run, error %s%s", until,
		         wanted, text, wall, hidden, error);
}

void rb_report_conclude(struct rb_report *report)
{
	for (int i = 0; i < report->method_count; i++)
		fit(report, i);
	advise(report);
}

/* ---- the table ---- */

enum { CELL_SIZE = 32 };

/* A cell with an error. */
static void number(char *out, double value)
{
	if (isnan(value))
		snprintf(out, CELL_SIZE, "-");
	else if (value == 0)
		snprintf(out, CELL_SIZE, "0");
	else
		snprintf(out, CELL_SIZE, "%.2e", value);
}

enum column_id {
	METHOD,
	STEP,
	TOLERANCE,
	ERROR_MAX,
	ERROR_RMS,
	ERROR_FINAL,
	OVERLAP,
	ENERGY,
	EVENTS,
	ROLLBACKS,
	BODY_STEPS,
	DISCARDED,
	DISCARDED_SHARE,
	WALL,
	CPU,
	RUNS,
	COLUMN_COUNT
};

/* The lower the rank, the sooner a column is left out of a narrow table. */
static const struct {
	const char *head, *unit; /* NULL: that of the quantity */
	int rank;
} columns[COLUMN_COUNT] = {
	[METHOD] = {"method", "", 99},
	[STEP] = {"time step", "s", 99},
	[TOLERANCE] = {"tolerance", "m", 99},
	[ERROR_MAX] = {"max error", NULL, 99},
	[ERROR_RMS] = {"rms", NULL, 9},
	[ERROR_FINAL] = {"final", NULL, 3},
	[OVERLAP] = {"overlap", "m", 5},
	[ENERGY] = {"energy", "", 7},
	[EVENTS] = {"events", "", 4},
	[ROLLBACKS] = {"rollbacks", "", 6},
	[BODY_STEPS] = {"body steps", "", 8},
	[DISCARDED] = {"discarded", "", 1},
	[DISCARDED_SHARE] = {"discarded", "%", 8},
	[WALL] = {"wall", "s", 99},
	[CPU] = {"cpu", "s", 2},
	[RUNS] = {"runs", "", 0},
};

double rb_report_discarded(const struct rb_rung_result *result)
{
	const double tried = (double)result->body_steps + (double)result->discarded_body_steps;

	return tried > 0 ? (double)result->discarded_body_steps / tried : 0;
}

/* The text of a cell. */
static void fill_cell(const struct rb_report *report, const struct rb_report_row *row,
                      enum column_id column, char *out)
{
	const struct rb_rung_result *const result = &row->result;
	const struct rb_deviation *const of = &result->of[report->quantity];
	const bool known = of->count > 0;

	switch (column) {
	case METHOD:
		snprintf(out, CELL_SIZE, "%s", report->methods[row->method].method->name);
		break;
	case STEP:
		snprintf(out, CELL_SIZE, "%.6g", row->time_step_s);
		break;
	case TOLERANCE:
		snprintf(out, CELL_SIZE, "%.6g", row->tolerance_m);
		break;
	case ERROR_MAX:
		number(out, known ? of->max : (double)NAN);
		break;
	case ERROR_RMS:
		number(out, known ? of->rms : (double)NAN);
		break;
	case ERROR_FINAL:
		number(out, known ? of->final : (double)NAN);
		break;
	case OVERLAP:
		number(out, result->max_penetration_m);
		break;
	case ENERGY:
		number(out, result->of[RB_QUANTITY_ENERGY].count > 0
		                    ? result->of[RB_QUANTITY_ENERGY].max
		                    : (double)NAN);
		break;
	case EVENTS:
		snprintf(out, CELL_SIZE, "%" PRIu64, result->events);
		break;
	case ROLLBACKS:
		snprintf(out, CELL_SIZE, "%" PRIu64, result->rollbacks);
		break;
	case BODY_STEPS:
		snprintf(out, CELL_SIZE, "%" PRIu64, result->body_steps);
		break;
	case DISCARDED:
		snprintf(out, CELL_SIZE, "%" PRIu64, result->discarded_body_steps);
		break;
	case DISCARDED_SHARE:
		snprintf(out, CELL_SIZE, "%.1f", 100 * rb_report_discarded(result));
		break;
	case WALL:
		snprintf(out, CELL_SIZE, "%.3g", result->wall_s);
		break;
	case CPU:
		snprintf(out, CELL_SIZE, "%.3g", result->cpu_s);
		break;
	case RUNS:
		snprintf(out, CELL_SIZE, "%d", result->runs);
		break;
	case COLUMN_COUNT:
		break;
	}
}

/* Cells by row and column, and how wide each column is; 0: left out. */
struct table {
	char (*cells)[COLUMN_COUNT][CELL_SIZE]; /* owned */
	int width[COLUMN_COUNT];
};

/* The unit below a column's head. */
static const char *unit_of(const struct rb_report *report, enum column_id column)
{
	return columns[column].unit ? columns[column].unit : rb_quantities[report->quantity].unit;
}

/* Columns that the table takes. */
static int total_width(const struct table *table)
{
	int total = 0;

	for (int c = 0; c < COLUMN_COUNT; c++)
		total += table->width[c] > 0 ? table->width[c] + 2 : 0;
	return total;
}

/* Takes columns out, the least important first, until the table fits. */
static void narrow(struct table *table, int width)
{
	while (width > 0 && total_width(table) > width) {
		int least = -1;
		for (int c = 0; c < COLUMN_COUNT; c++)
			if (table->width[c] > 0 && columns[c].rank < 99 &&
			    (least < 0 || columns[c].rank < columns[least].rank))
				least = c;
		if (least < 0)
			return;
		table->width[least] = 0;
	}
}

/* Fills all cells and finds the widths of the columns. */
static void lay_out(const struct rb_report *report, struct table *table, int width)
{
	for (int c = 0; c < COLUMN_COUNT; c++) {
		const int head = (int)strlen(columns[c].head);
		const int unit = (int)strlen(unit_of(report, (enum column_id)c));
		if (c == TOLERANCE && !report->by_tolerance)
			continue;
		table->width[c] = head > unit ? head : unit;
		for (int i = 0; i < report->row_count; i++) {
			fill_cell(report, &report->rows[i], (enum column_id)c, table->cells[i][c]);
			const int length = (int)strlen(table->cells[i][c]);
			const bool counts = report->rows[i].result.state == RB_RUNG_OK ||
			                    c <= TOLERANCE;
			if (counts && length > table->width[c])
				table->width[c] = length;
		}
	}
	narrow(table, width);
}

static void print_cell(FILE *file, const struct table *table, int column, const char *text)
{
	if (table->width[column] == 0)
		return;
	if (column == METHOD)
		rb_print(file, "  %-*s", table->width[column], text);
	else
		rb_print(file, "  %*s", table->width[column], text);
}

static void print_head(FILE *file, const struct rb_report *report, const struct table *table)
{
	for (int c = 0; c < COLUMN_COUNT; c++)
		print_cell(file, table, c, columns[c].head);
	putc('\n', file);
	for (int c = 0; c < COLUMN_COUNT; c++)
		print_cell(file, table, c, unit_of(report, (enum column_id)c));
	putc('\n', file);
}

/* Prints a row; of a run that failed, its settings and why. */
static void print_row(FILE *file, const struct rb_report *report, const struct table *table, int i)
{
	const struct rb_rung_result *const result = &report->rows[i].result;

	for (int c = 0; c < COLUMN_COUNT; c++)
		if (result->state == RB_RUNG_OK || c <= TOLERANCE)
			print_cell(file, table, c, table->cells[i][c]);
	if (result->state != RB_RUNG_OK)
		rb_print(file, "  %s: %s", rb_rung_state_name(result->state), result->text);
	putc('\n', file);
}

/*
 * Largest ratio of a run's wall time to its processor time: what else goes on in the machine. 0
 * where threads hide it.
 */
static double busy(const struct rb_report *report)
{
	double most = 0;

	for (int i = 0; i < report->row_count && report->threads == 1; i++) {
		const struct rb_rung_result *const result = &report->rows[i].result;
		if (result->state == RB_RUNG_OK && result->cpu_s > 0)
			most = fmax(most, result->wall_s / result->cpu_s);
	}
	return most;
}

static void print_facts(FILE *file, const struct rb_report *report)
{
	const bool titled = report->title && *report->title;

	rb_print(file, "%s%s%s\n", report->scene, titled ? ": " : "", titled ? report->title : "");
	rb_print(file, "  error of   %s, over %" PRIu64 " %s (%.6g s) and %d %s\n",
	         rb_quantities[report->quantity].what, report->frame_count,
	         rb_text_plural(report->frame_count, "frame", "frames"), report->duration_s,
	         report->body_count,
	         rb_text_plural((uint64_t)report->body_count, "body", "bodies"));
	rb_print(file, "  against    %s\n", report->reference);
	if (*report->warning)
		rb_print(file, "  mind       %s\n", report->warning);
	if (busy(report) > busy_most)
		rb_print(file,
		         "  mind       the machine was busy: wall times are up to %.2g times the "
		         "processor's\n",
		         busy(report));
	rb_print(file,
	         "  energy     %s, relative to the largest kinetic energy\n"
	         "  wall, cpu  the least of all runs of a setting, without recording, %d %s\n"
	         "  took       %.3g s of the %.3g s that --budget allows\n",
	         report->energy_drifts ? "change since the start" : "largest error",
	         report->threads, rb_text_plural((uint64_t)report->threads, "thread", "threads"),
	         report->spent_s, report->budget_s);
}

enum rb_status rb_report_print(FILE *file, const struct rb_report *report, int width,
                               struct rb_error *err)
{
	struct table table = {
		.cells = rb_memory_take((size_t)report->row_count, sizeof *table.cells)};

	if (!table.cells)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot print %d rows: out of memory",
		               report->row_count);
	print_facts(file, report);
	lay_out(report, &table, width);
	print_head(file, report, &table);
	for (int i = 0; i < report->row_count; i++)
		print_row(file, report, &table, i);
	rb_memory_free(table.cells);
	for (int i = 0; i < report->method_count; i++) {
		const struct rb_report_method *const of = &report->methods[i];
		if (isnan(of->order))
			rb_print(file, "  %s: order %s\n", of->method->name, of->order_note);
		else
			rb_print(file, "  %s: order %.2f in the %s, from %d points\n",
			         of->method->name, of->order,
			         report->by_tolerance ? "tolerance" : "time step",
			         of->order_points);
		if (*of->left_out)
			rb_print(file, "  %s: %s\n", of->method->name, of->left_out);
	}
	return RB_OK;
}

void rb_report_print_end(FILE *file, const struct rb_report *report)
{
	rb_print(file, "%s\n", report->advice);
}

void rb_report_release(struct rb_report *report)
{
	rb_memory_free(report->methods);
	rb_memory_free(report->rows);
	*report = (struct rb_report){0};
}
