/* SPDX-License-Identifier: MIT */
/*
 * Order of work: ladder of settings, reference, then each method from coarse to fine within its
 * share of the budget. A setting is not begun if the time that it will take, by how times grew so
 * far, does not fit; coarser results are then complete, and what is missing is said. The reference
 * is found with the located method where there is one, because its error does not come from the
 * time step.
 */
#include "app/converge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/chart.h"
#include "app/common.h"
#include "app/progress.h"
#include "app/refine.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "base/visible.h"
#include "script/reference.h"
#include "method/method.h"

/*
 * LIST_MOST: settings of a list. DEFAULT_STEPS: of the ladder, three decades. RUNS_DEFAULT:
 * repetitions, of which the fastest counts.
 */
enum { LIST_MOST = 64, DEFAULT_STEPS = 7, RUNS_DEFAULT = 5 };
static const double budget_default_s = 60, error_default = 1e-6;
/* Part of the budget that looking for a reference may take. */
static const double reference_share = 0.4;
static const double half_decade = 3.1622776601683795;

enum output { TERMINAL, SVG, PNG, CSV, JSON };
static const char *const endings[] = {
	[TERMINAL] = "", [SVG] = ".svg", [PNG] = ".png", [CSV] = ".csv", [JSON] = ".json"};

/* All of one call of the verb. */
struct converge {
	const struct rb_options *options;
	struct rb_loaded loaded; /* for what a run of it would be; nothing runs in this process */
	struct rb_report report;
	struct rb_refined refined;
	enum output output;
	double interval_s;
	double steps_s[LIST_MOST], tolerances_m[LIST_MOST]; /* coarse to fine */
	int step_count, tolerance_count;
	bool bar; /* standard error takes a line that is redrawn */
	uint64_t start_ns;
};

/* ---- what is asked for ---- */

/* Reads a list of positive numbers. */
static enum rb_status take_list(const char *name, const char *text, double *values, int *count,
                                struct rb_error *err)
{
	char word[64];

	*count = 0;
	while (text) {
		const size_t length = strcspn(text, ",");
		snprintf(word, sizeof word, "%.*s", (int)fmin((double)length, 63), text);
		if (*count == LIST_MOST)
			return RB_FAIL(err, RB_ERR_USAGE, "option '--%s': more than %d values",
			               name, LIST_MOST);
		if (length >= sizeof word || !rb_text_number(word, &values[*count]) ||
		    values[*count] <= 0)
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--%s': '%s' is not a finite number above 0 "
			               "(wanted: a list like 0.01,0.001)",
			               name, word);
		(*count)++;
		text = text[length] ? text + length + 1 : NULL;
	}
	return RB_OK;
}

/* For qsort: the largest first. */
static int falling(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x < y) - (x > y);
}

/* Whether this version has a method, as the row of --method says. */
static bool available(const char *method)
{
	const size_t length = strlen(method);

	for (int i = 0; i < rb_option_row_count; i++) {
		if (strcmp(rb_option_rows[i].name, "method") != 0)
			continue;
		for (const char *at = rb_option_rows[i].choices; at;) {
			const size_t one = strcspn(at, ",");
			if (one == length && memcmp(at, method, one) == 0)
				return true;
			at = at[one] ? at + one + 2 : NULL;
		}
	}
	return false;
}

/* The method of this name; NULL: none. */
static const struct rb_ladder_method *method_named(const char *name, size_t length)
{
	for (int i = 0; i < rb_ladder_method_count; i++)
		if (strlen(rb_ladder_methods[i].name) == length &&
		    memcmp(rb_ladder_methods[i].name, name, length) == 0)
			return &rb_ladder_methods[i];
	return NULL;
}

/* Fails with the names that there are. */
static enum rb_status unknown_method(const char *name, size_t length, struct rb_error *err)
{
	char names[120];
	int used = 0;

	for (int i = 0; i < rb_ladder_method_count; i++)
		if (available(rb_ladder_methods[i].method))
			used += snprintf(names + used, sizeof names - (size_t)used, "%s%s",
			                 used > 0 ? ", " : "", rb_ladder_methods[i].name);
	return RB_FAIL(err, RB_ERR_USAGE, "option '--methods': '%.*s' is not one of: %s",
	               (int)fmin((double)length, 40), name, names);
}

/* Reads --methods. */
static enum rb_status take_methods(struct converge *converge, struct rb_error *err)
{
	struct rb_report *const report = &converge->report;
	const char *text = converge->options->methods;

	if (!text)
		text = available("located") ? "classic,classic-global,located"
		                            : "classic,classic-global";
	report->methods = rb_memory_take((size_t)rb_ladder_method_count, sizeof *report->methods);
	if (!report->methods)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot list methods: out of memory");
	while (text) {
		const size_t length = strcspn(text, ",");
		const struct rb_ladder_method *const method = method_named(text, length);
		bool listed = false;
		if (!method || !available(method->method))
			return unknown_method(text, length, err);
		for (int i = 0; i < report->method_count; i++)
			listed = listed || report->methods[i].method == method;
		if (!listed)
			report->methods[report->method_count++].method = method;
		text = text[length] ? text + length + 1 : NULL;
	}
	return RB_OK;
}

/* Reads --output and checks that it can be made. */
static enum rb_status take_output(struct converge *converge, struct rb_error *err)
{
	const char *const name = converge->options->output;
	struct rb_outfile out;

	if (!name)
		return RB_OK;
	for (int i = SVG; i <= JSON; i++) {
		const size_t length = strlen(name), ending = strlen(endings[i]);
		if (length > ending && strcmp(name + length - ending, endings[i]) == 0)
			converge->output = (enum output)i;
	}
	if (converge->output == TERMINAL)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--output': '%s' must end in .svg, .png, .csv or .json",
		               name);
	/* before the runs, which take a minute or more */
	const enum rb_status status = rb_outfile_open(&out, name, converge->options->force, err);
	if (!status)
		rb_outfile_release(&out);
	if (!status && (converge->output == SVG || converge->output == PNG))
		return rb_plot_available(", or ask for .csv or .json", err);
	return status;
}

/* Takes all that the command line says. */
static enum rb_status take_options(struct converge *converge, struct rb_error *err)
{
	const struct rb_options *const options = converge->options;
	struct rb_report *const report = &converge->report;
	enum rb_status status = take_list("dt", options->steps, converge->steps_s,
	                                  &converge->step_count, err);

	if (!status)
		status = take_list("tolerance", options->tolerances, converge->tolerances_m,
		                   &converge->tolerance_count, err);
	if (!status && converge->tolerance_count > 0 && converge->step_count > 1)
		status = RB_FAIL(err, RB_ERR_USAGE,
		                 "options '--dt' and '--tolerance' cannot both be lists: one of "
		                 "them is the ladder");
	if (!status)
		status = take_methods(converge, err);
	if (!status)
		status = take_output(converge, err);
	for (int i = 0; options->quantity && i < RB_QUANTITY_COUNT; i++)
		if (strcmp(options->quantity, rb_quantities[i].name) == 0)
			report->quantity = (enum rb_quantity)i;
	report->error = isnan(options->error) ? error_default : options->error;
	report->budget_s = isnan(options->budget_s) ? budget_default_s : options->budget_s;
	report->threads = options->threads > 0 ? options->threads : 1;
	report->by_tolerance = converge->tolerance_count > 0;
	return status;
}

/* ---- the ladder ---- */

/*
 * Makes the ladder: steps as they are made, whole parts of a frame's interval; each once, coarse to
 * fine.
 */
static void lay_steps(struct converge *converge)
{
	double *const steps = converge->steps_s;
	const double own_s = converge->loaded.model->time_step_s;
	int kept = 0;

	if (converge->step_count == 0 && converge->tolerance_count > 0)
		steps[converge->step_count++] = own_s;
	for (int i = 0; converge->step_count < DEFAULT_STEPS && !converge->options->steps &&
	                converge->tolerance_count == 0;
	     i++)
		steps[converge->step_count++] = own_s * 10 * pow(half_decade, -i);
	qsort(steps, (size_t)converge->step_count, sizeof *steps, falling);
	for (int i = 0; i < converge->step_count; i++) {
		const double step_s = converge->interval_s /
		                      (double)rb_step_count(converge->interval_s, steps[i]);
		if (kept == 0 || step_s < steps[kept - 1])
			steps[kept++] = step_s;
	}
	converge->step_count = kept;
	qsort(converge->tolerances_m, (size_t)converge->tolerance_count, sizeof(double), falling);
}

/* Number of settings of a method. */
static int rung_count(const struct converge *converge)
{
	return converge->tolerance_count > 0 ? converge->tolerance_count : converge->step_count;
}

static double seconds_since(uint64_t start_ns)
{
	return (double)(rb_clock_now_ns() - start_ns) * 1e-9;
}

/* Shows what is under way. */
static void show(const struct converge *converge, const char *what, double time_step_s)
{
	if (converge->bar)
		rb_print(stderr, "\r\033[K%s, time step %.3g s (%.0f of %.0f s)", what, time_step_s,
		         seconds_since(converge->start_ns), converge->report.budget_s);
}

static void show_reference(double time_step_s, void *user)
{
	show(user, "looking for a reference", time_step_s);
}

/* ---- the reference ---- */

/* Looks for a reference with a method. */
static enum rb_status refine_with(struct converge *converge, const struct rb_ladder_method *method,
                                  struct rb_error *err)
{
	const struct rb_report *const report = &converge->report;
	const double finest_s = converge->steps_s[converge->step_count - 1];
	const bool by_step = strcmp(method->method, "located") != 0;
	const struct rb_refine_order order = {
		.options = converge->options,
		.method = method,
		.interval_s = converge->interval_s,
		.time_step_s = fmax(fmin(converge->loaded.model->time_step_s, converge->interval_s),
	                            finest_s),
		/* what is measured must not be finer than what it is measured against */
		.fine_s = by_step ? finest_s / 2 : (double)INFINITY,
		.tolerance_m = report->by_tolerance
	                               ? converge->tolerances_m[converge->tolerance_count - 1]
	                               : (double)NAN,
		.quantity = report->quantity,
		.error = report->error,
		.budget_s = reference_share * report->budget_s,
		.growth = by_step ? half_decade : 1,
		.tell = show_reference,
		.user = converge,
	};

	RB_ASSERT(converge->step_count > 0);
	rb_refined_release(&converge->refined);
	return rb_refine(&converge->refined, &order, converge->loaded.model, err);
}

/* Puts into words what the reference is worth. */
static void describe_reference(struct converge *converge, const struct rb_ladder_method *method)
{
	struct rb_report *const report = &converge->report;
	const struct rb_refined *const refined = &converge->refined;
	const char *const unit = rb_quantities[report->quantity].unit;
	const char *const space = *unit ? " " : "";

	report->reference_error = refined->estimate;
	report->reference_agrees = refined->agrees;
	report->diverges = refined->diverges;
	if (!refined->found) {
		snprintf(report->reference, sizeof report->reference,
		         "nothing: no run came to its end");
		snprintf(report->warning, sizeof report->warning, "no reference run: %.150s",
		         refined->text);
		return;
	}
	snprintf(report->reference, sizeof report->reference,
	         "a run of %s, time step %.3g s; a finer one and rounding make a difference of "
	         "%.2g%s%s",
	         method->name, refined->time_step_s, refined->estimate, space, unit);
	if (isnan(refined->estimate))
		snprintf(report->reference, sizeof report->reference,
		         "a run of %s, time step %.3g s, of unknown error: there was no time for a "
		         "finer one",
		         method->name, refined->time_step_s);
	if (refined->diverges && refined->horizon_s > 0) {
		report->horizon_s = refined->horizon_s;
		snprintf(report->warning, sizeof report->warning,
		         "finer steps or rounding do not lead to one answer: runs agree within "
		         "%.3g%s%s up to %.4g s only, and errors are taken up to there",
		         report->error, space, unit, refined->horizon_s);
	} else if (refined->diverges) {
		snprintf(report->warning, sizeof report->warning,
		         "finer steps or rounding do not lead to one answer: no two runs agree "
		         "within %.3g%s%s",
		         report->error, space, unit);
	} else if (!refined->agrees) {
		snprintf(report->warning, sizeof report->warning,
		         "the reference is not settled to a tenth of %.3g%s%s; a larger --budget "
		         "allows a finer one",
		         report->error, space, unit);
	}
}

/* Takes the scene's own reference, or makes one. */
static enum rb_status find_reference(struct converge *converge, struct rb_error *err)
{
	struct rb_report *const report = &converge->report;
	const struct rb_ladder_method *method = method_named("classic", strlen("classic"));
	enum rb_status status = RB_OK;

	report->horizon_s = (double)INFINITY;
	report->own_reference = rb_script_has_reference(converge->loaded.script);
	if (report->own_reference) {
		report->reference_agrees = true;
		snprintf(report->reference, sizeof report->reference, "the scene's own reference");
		return RB_OK;
	}
	if (available("located")) {
		method = method_named("located", strlen("located"));
		status = refine_with(converge, method, err);
	}
	if (!status && !converge->refined.found) {
		method = method_named("classic", strlen("classic"));
		status = refine_with(converge, method, err);
	}
	if (!status)
		describe_reference(converge, method);
	return status;
}

/* ---- running ---- */

/* The order for one setting. */
static struct rb_rung_order order_of(const struct converge *converge,
                                     const struct rb_report_row *row, double left_s)
{
	const struct rb_options *const options = converge->options;
	const struct rb_report *const report = &converge->report;

	return (struct rb_rung_order){
		.options = options,
		.method = report->methods[row->method].method,
		.time_step_s = row->time_step_s,
		.tolerance_m = row->tolerance_m,
		.runs = options->runs > 0 ? options->runs : RUNS_DEFAULT,
		.repeat_s = options->runs > 0 ? left_s : left_s / (2 * rung_count(converge)),
		.deadline_s = fmax(left_s, 1),
		.by_reference = report->own_reference,
		.against = converge->refined.found ? &converge->refined.path : NULL,
		.until_s = report->horizon_s,
		.agree_quantity = report->quantity,
		.agree = report->error,
	};
}

/*
 * Notes that finer settings are left out: what would go beyond its method's part of the budget is
 * not begun. NAN: not for its time.
 */
static void leave_out(struct converge *converge, int method, int rung, double expected_s)
{
	struct rb_report_method *const of = &converge->report.methods[method];
	const int count = rung_count(converge) - rung;
	const double *const dial = converge->report.by_tolerance ? converge->tolerances_m
	                                                         : converge->steps_s;
	char why[96] = "no time is left for them (--budget allows more)";

	if (isnan(expected_s))
		snprintf(why, sizeof why, "the method cannot do this scene");
	else if (expected_s > 0)
		snprintf(why, sizeof why, "about %.2g s a run (--budget allows more)", expected_s);
	snprintf(of->left_out, sizeof of->left_out, "%d finer %s left out, from %.3g %s on: %s",
	         count, count == 1 ? "setting is" : "settings are", dial[rung],
	         converge->report.by_tolerance ? "m" : "s", why);
}

/* Runs the settings of a method from coarse to fine. */
static enum rb_status run_method(struct converge *converge, int method, double budget_s,
                                 struct rb_error *err)
{
	struct rb_report *const report = &converge->report;
	const uint64_t start_ns = rb_clock_now_ns();
	double last_s = 0, last_dial = 0, observed = (double)INFINITY;

	for (int i = 0; i < rung_count(converge); i++) {
		struct rb_report_row row = {.method = method,
		                            .time_step_s = converge->steps_s[0],
		                            .tolerance_m = (double)NAN};
		if (report->by_tolerance)
			row.tolerance_m = converge->tolerances_m[i];
		else
			row.time_step_s = converge->steps_s[i];
		const double left_s = budget_s - seconds_since(start_ns);
		const double growth = report->by_tolerance
		                              ? 1
		                              : fmin(last_dial / row.time_step_s, observed);
		if (i > 0 && (left_s <= 0 || last_s * growth > left_s)) {
			leave_out(converge, method, i, last_s * growth);
			break;
		}
		const struct rb_rung_order order = order_of(converge, &row, left_s);
		show(converge, report->methods[method].method->name, row.time_step_s);
		const enum rb_status status = rb_rung_run(&row.result, &order, err);
		if (status)
			return status;
		report->rows[report->row_count++] = row;
		if (row.result.state == RB_RUNG_OK) {
			if (last_s > 0)
				observed = fmax(1.2 * row.result.wall_s / last_s, 1);
			last_s = row.result.wall_s;
			last_dial = row.time_step_s;
			report->energy_drifts = report->energy_drifts || row.result.energy_drifts;
		} else if (i + 1 < rung_count(converge) &&
		           (row.result.state == RB_RUNG_TOO_LONG || row.result.refused)) {
			leave_out(converge, method, i + 1,
			          row.result.refused ? (double)NAN : order.deadline_s);
			break;
		}
	}
	return RB_OK;
}

/*
 * Warns where the reference differs from the scene at its very start, which is a mistake more often
 * than not.
 */
static void check_start(struct rb_report *report)
{
	for (int i = 0; i < report->row_count; i++) {
		const struct rb_rung_result *const result = &report->rows[i].result;
		if (result->state != RB_RUNG_OK)
			continue;
		if (report->own_reference && result->start > report->error)
			snprintf(report->warning, sizeof report->warning,
			         "at the start the reference is %.3g m away from the scene",
			         result->start);
		if (result->of[report->quantity].count == 0)
			snprintf(report->warning, sizeof report->warning,
			         "the reference does not contain '%s'",
			         rb_quantities[report->quantity].name);
		return;
	}
}

/* Runs everything and draws conclusions. */
static enum rb_status run_all(struct converge *converge, struct rb_error *err)
{
	struct rb_report *const report = &converge->report;
	enum rb_status status = RB_OK;

	lay_steps(converge);
	report->rows = rb_memory_take((size_t)(report->method_count * rung_count(converge)),
	                              sizeof *report->rows);
	if (!report->rows)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep the results: out of memory");
	status = find_reference(converge, err);
	for (int m = 0; m < report->method_count && !status; m++) {
		const double left_s = report->budget_s - seconds_since(converge->start_ns);
		status = run_method(converge, m, left_s / (report->method_count - m), err);
	}
	if (converge->bar)
		fputs("\r\033[K", stderr);
	report->spent_s = seconds_since(converge->start_ns);
	check_start(report);
	rb_report_conclude(report);
	return status;
}

/* ---- telling ---- */

/* A report of failures alone is a failure, with the status of the first. */
static int exit_code_of(const struct rb_report *report)
{
	for (int i = 0; i < report->row_count; i++)
		if (report->rows[i].result.state == RB_RUNG_OK)
			return 0;
	return report->row_count > 0 ? report->rows[0].result.exit_status : 0;
}

/* Writes the file of --output. */
static enum rb_status write_output(const struct converge *converge, struct rb_error *err)
{
	const struct rb_report *const report = &converge->report;
	const struct rb_plot_size size = {.width = 900, .height = 650};
	struct rb_outfile out;
	enum rb_status status = rb_outfile_open(&out, converge->options->output,
	                                        converge->options->force, err);

	if (status)
		return status;
	switch (converge->output) {
	case CSV:
		rb_chart_print_csv(out.file, report);
		break;
	case JSON:
		rb_chart_print_json(out.file, report, exit_code_of(report));
		break;
	case SVG:
	case PNG:
		status = rb_chart_draw(out.file, report,
		                       converge->output == SVG ? RB_PLOT_SVG : RB_PLOT_PNG, size,
		                       err);
		break;
	case TERMINAL:
		break;
	}
	if (!status)
		return rb_outfile_publish(&out, err);
	rb_outfile_release(&out);
	return status;
}

/* Prints table, picture and advice. */
static enum rb_status print_all(const struct converge *converge, struct rb_error *err)
{
	const struct rb_report *const report = &converge->report;
	const struct rb_plot_size size = rb_plot_text_size();
	const int width = isatty(STDOUT_FILENO) ? size.width + 1 : 0;
	struct rb_error missing;
	enum rb_status status = rb_report_print(stdout, report, width, err);

	if (!status && converge->output == TERMINAL) {
		if (rb_plot_available("", &missing) ||
		    rb_chart_draw(stdout, report, RB_PLOT_TEXT, size, &missing))
			rb_print(stdout, "  no picture: %s\n", missing.text);
	}
	if (!status && converge->output != TERMINAL)
		rb_print(stdout, "  written    %s\n", converge->options->output);
	if (!status)
		rb_report_print_end(stdout, report);
	return status;
}

/* Writes and prints the report; the exit status. */
static int tell(const struct converge *converge)
{
	struct rb_error err;
	int exit_code = exit_code_of(&converge->report);
	enum rb_status failed = RB_OK;

	if (converge->options->output && write_output(converge, &err)) {
		exit_code = rb_app_fail(converge->options, &err);
		failed = err.status;
	}
	if (converge->options->json) {
		rb_chart_print_json(stdout, &converge->report, exit_code);
	} else {
		struct converge shown = *converge;
		if (failed)
			shown.output = TERMINAL;
		if (print_all(&shown, &err))
			exit_code = rb_app_fail(converge->options, &err);
	}
	return exit_code;
}

int rb_converge_main(const struct rb_options *options)
{
	struct rb_options no_record = *options, held = *options;
	struct converge converge = {.options = &held, .start_ns = rb_clock_now_ns()};
	struct rb_error err;
	int exit_code;

	no_record.no_record = true;
	no_record.output = NULL;
	converge.bar = rb_terminal_is_capable(STDERR_FILENO) && !options->quiet && !options->json;
	enum rb_status status = take_options(&converge, &err);
	if (status) {
		exit_code = rb_app_refuse(options, &err);
	} else if ((status = rb_loaded_init(&converge.loaded, &no_record, &err))) {
		exit_code = rb_app_refuse_scene(options, &converge.loaded, &err);
	} else {
		const struct rb_model *const model = converge.loaded.model;
		/* every setting runs as long, also where the scene counts time steps */
		held.duration_s = model->duration_s;
		held.step_count = 0;
		converge.interval_s = fmin(1 / model->frame_rate, model->duration_s);
		converge.report.scene = converge.loaded.scene.file;
		converge.report.title = converge.loaded.scene.world.title;
		converge.report.body_count = model->body_count;
		converge.report.frame_count = model->frame_count;
		converge.report.duration_s = model->duration_s;
		status = run_all(&converge, &err);
		exit_code = status ? rb_app_refuse(options, &err) : tell(&converge);
	}
	rb_refined_release(&converge.refined);
	rb_report_release(&converge.report);
	rb_loaded_release(&converge.loaded);
	return rb_app_finish(options, exit_code);
}
