/* SPDX-License-Identifier: MIT */
#include "support.h"

#include <math.h>
#include <string.h>

#include "app/chart.h"
#include "app/report.h"

/* A report over classic and located with rows of our own; errors of position. */
struct made {
	struct rb_report report;
	struct rb_report_method methods[2];
	struct rb_report_row rows[16];
};

static struct made *made_of(void)
{
	static struct made made;

	made = (struct made){
		.methods = {{.method = &rb_ladder_methods[0]}, {.method = &rb_ladder_methods[3]}}};
	made.report = (struct rb_report){.scene = "scene.lua",
	                                 .title = "",
	                                 .body_count = 1,
	                                 .frame_count = 2,
	                                 .quantity = RB_QUANTITY_POSITION,
	                                 .error = 1e-6,
	                                 .own_reference = true,
	                                 .horizon_s = (double)INFINITY,
	                                 .methods = made.methods,
	                                 .method_count = 2,
	                                 .rows = made.rows};
	return &made;
}

static struct rb_report_row *add(struct made *made, int method, double step_s, double error,
                                 double wall_s)
{
	struct rb_report_row *const row = &made->rows[made->report.row_count++];

	*row = (struct rb_report_row){.method = method,
	                              .time_step_s = step_s,
	                              .tolerance_m = (double)NAN,
	                              .result = {.state = RB_RUNG_OK, .wall_s = wall_s}};
	row->result.of[RB_QUANTITY_POSITION] = (struct rb_deviation){
		.count = 1, .max = error, .rms = error, .final = error, .largest = 1};
	return row;
}

static void says(const char *text, const char *part)
{
	if (!strstr(text, part))
		fail_msg("'%s' does not say '%s'", text, part);
}

static void an_order_is_the_slope_above_rounding(void **state)
{
	struct made *const made = made_of();
	(void)state;

	for (int i = 0; i < 4; i++)
		add(made, 0, pow(10, -1 - i), 3 * pow(10, -2 * (1 + i)), 0.001);
	add(made, 0, 1e-7, 2e-16, 10); /* rounding: would flatten the line */
	add(made, 0, 1e-8, 1, 10)->result.state = RB_RUNG_FAILED; /* no error at all */
	add(made, 1, 0.1, 1e-16, 1);
	add(made, 1, 0.01, 1e-16, 1);
	rb_report_conclude(&made->report);
	assert_true(fabs(made->methods[0].order - 2) < 1e-9);
	assert_int_equal(made->methods[0].order_points, 4);
	assert_true(isnan(made->methods[1].order));
	says(made->methods[1].order_note, "rounding");
}

static void errors_below_that_of_the_reference_have_no_order(void **state)
{
	struct made *const made = made_of();
	(void)state;

	made->report.own_reference = false;
	made->report.reference_error = 3e-6;
	for (int i = 0; i < 4; i++)
		add(made, 0, pow(10, -1 - i), 0.5 * pow(10, -3 - i), 1);
	rb_report_conclude(&made->report);
	assert_true(fabs(made->methods[0].order - 1) < 1e-9);
	assert_int_equal(made->methods[0].order_points, 2); /* above 3e-5 */
	says(made->report.advice, "cannot be judged");
}

static void scattered_errors_have_no_order(void **state)
{
	struct made *const made = made_of();
	static const double errors[] = {1e-4, 3e-6, 2e-4, 1e-6, 5e-5};
	(void)state;

	for (int i = 0; i < 5; i++)
		add(made, 0, pow(10, -1 - i), errors[i], 1);
	rb_report_conclude(&made->report);
	assert_true(isnan(made->methods[0].order));
	says(made->methods[0].order_note, "no power of the time step");
}

static void errors_that_do_not_fall_have_no_order(void **state)
{
	struct made *const made = made_of();
	(void)state;

	for (int i = 0; i < 4; i++) {
		add(made, 0, pow(10, -1 - i), pow(10, -5 + 0.3 * i), 1);
		add(made, 1, pow(10, -1 - i), 1e-5 * (1 - 0.02 * i), 1);
	}
	rb_report_conclude(&made->report);
	for (int m = 0; m < 2; m++) {
		assert_true(isnan(made->methods[m].order));
		says(made->methods[m].order_note, "do not fall with the time step");
	}
}

static void where_nothing_converges_there_is_no_order(void **state)
{
	struct made *const made = made_of();
	(void)state;

	made->report.own_reference = false;
	made->report.diverges = true;
	made->report.reference_error = 3;
	made->report.horizon_s = 1.5;
	for (int i = 0; i < 4; i++)
		add(made, 0, pow(10, -1 - i), pow(10, -1 - i), 1);
	add(made, 1, 0.1, 0, 1);
	rb_report_conclude(&made->report);
	assert_true(isnan(made->methods[0].order));
	says(made->methods[0].order_note, "one answer");
	/* up to the horizon runs agree within the wanted error, no better */
	assert_true(rb_report_least_error(&made->report, &made->rows[4]) == made->report.error);
	says(made->report.advice, "up to 1.5 s: ");
}

static void the_advice_is_the_cheapest_that_is_good_enough(void **state)
{
	struct made *const made = made_of();
	(void)state;

	add(made, 0, 0.1, 1e-3, 0.001);
	add(made, 0, 0.01, 1e-7, 0.5);
	add(made, 1, 0.1, 1e-9, 0.1);
	add(made, 1, 0.01, 1e-9, 0.099); /* equal, as machines go: the coarser one will do */
	add(made, 1, 0.001, 0, 0.2);
	rb_report_conclude(&made->report);
	assert_int_equal(made->report.advised, 2);
	says(made->report.advice,
	     "for an error of 1e-06 m the cheapest is method located, rollback selective, time "
	     "step 0.1 s: 100 ms a run, error 1e-09 m");
}

static void a_missed_error_is_told_with_its_factor(void **state)
{
	struct made *const made = made_of();
	(void)state;

	add(made, 0, 0.1, 1e-3, 0.001);
	add(made, 0, 0.01, 4e-5, 0.01);
	rb_report_conclude(&made->report);
	assert_int_equal(made->report.advised, -1);
	says(made->report.advice, "no setting reaches an error of 1e-06 m");
	says(made->report.advice, "which is 40 times too much, in 10 ms a run");
}

static void a_run_against_itself_has_no_better_error_than_the_reference(void **state)
{
	struct made *const made = made_of();
	(void)state;

	made->report.own_reference = false;
	made->report.reference_agrees = true;
	made->report.reference_error = 1e-14;
	add(made, 1, 0.1, 0, 0.001);
	rb_report_conclude(&made->report);
	says(made->report.advice, "error at most 1e-14 m");
}

static void an_error_that_is_no_number_reaches_nothing(void **state)
{
	struct made *const made = made_of();
	(void)state;

	add(made, 0, 0.1, (double)NAN, 0.001);
	rb_report_conclude(&made->report);
	assert_int_equal(made->report.advised, -1);
	says(made->report.advice, "no error of position is available");
}

static void a_narrow_table_keeps_what_matters(void **state)
{
	struct made *const made = made_of();
	char text[4096];
	struct rb_error err;
	(void)state;

	add(made, 0, 0.1, 1e-3, 0.001);
	rb_report_conclude(&made->report);
	FILE *const file = fmemopen(text, sizeof text, "w");
	assert_non_null(file);
	assert_int_equal(rb_report_print(file, &made->report, 60, &err), RB_OK);
	fclose(file);
	const char *const head = strstr(text, "  method ");
	assert_non_null(head);
	assert_true(strcspn(head, "\n") <= 60);
	for (int i = 0; i < 4; i++)
		assert_non_null(strstr(
			head, ((const char *[]){"time step", "max error", "wall", "classic"})[i]));
	assert_null(strstr(head, "cpu"));
}

/* A run that has failed says so over the columns of its results, which are as wide as the others need them. */
static void columns_are_as_wide_as_what_stands_in_them(void **state)
{
	struct made *const made = made_of();
	char text[4096];
	struct rb_error err;
	(void)state;

	add(made, 0, 0.1, 1e-3, 0.001);
	add(made, 1, 1.25e-5, 1.234567e-13, 123456.789);
	struct rb_report_row *const failed = add(made, 1, 1.23e-7, 1, 1);
	failed->result.state = RB_RUNG_CRASHED;
	rb_report_conclude(&made->report);
	FILE *const file = fmemopen(text, sizeof text, "w");
	assert_non_null(file);
	assert_int_equal(rb_report_print(file, &made->report, 0, &err), RB_OK);
	fclose(file);
	const char *line = strstr(text, "  method ");
	assert_non_null(line);
	const size_t width = strcspn(line, "\n");
	for (int row = 0; row < 4; row++, line += strcspn(line, "\n") + 1)
		if (row != 1) /* units */
			assert_int_equal(strcspn(line, "\n"), width);
	assert_memory_equal(line, "  located   1.23e-07  ", 22);
}

/* Whole decades around all points, which gnuplot marks; without gnuplot there is no picture to look at. */
static void a_picture_has_room_for_all_its_points(void **state)
{
	struct made *const made = made_of();
	char text[65536] = "";
	struct rb_error err;
	(void)state;

	add(made, 0, 0.1, 1e-3, 0.002);
	add(made, 0, 0.01, 1e-5, 300);
	add(made, 1, 0.01, 2e-9, 0.5);
	FILE *const file = tmpfile();
	assert_non_null(file);
	const enum rb_status status = rb_chart_draw(file, &made->report, RB_PLOT_TEXT,
	                                            (struct rb_plot_size){120, 40, false}, &err);
	rewind(file);
	(void)!fread(text, 1, sizeof text - 1, file);
	fclose(file);
	if (status == RB_ERR_MISSING)
		skip();
	assert_int_equal(status, RB_OK);
	for (int i = 0; i < 4; i++) /* the ends of both axes */
		says(text, ((const char *[]){"1e+03 +--", "1e-03 +--", " 1e-09 ", " 1e-02 "})[i]);
	int marks[2] = {0, 0};
	for (const char *at = text; *at; at++)
		for (int k = 0; k < 2; k++)
			marks[k] += *at == "AB"[k];
	/* and one each in the key */
	assert_int_equal(marks[0], 3);
	assert_int_equal(marks[1], 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_order_is_the_slope_above_rounding),
		cmocka_unit_test(errors_below_that_of_the_reference_have_no_order),
		cmocka_unit_test(scattered_errors_have_no_order),
		cmocka_unit_test(errors_that_do_not_fall_have_no_order),
		cmocka_unit_test(where_nothing_converges_there_is_no_order),
		cmocka_unit_test(the_advice_is_the_cheapest_that_is_good_enough),
		cmocka_unit_test(a_missed_error_is_told_with_its_factor),
		cmocka_unit_test(a_run_against_itself_has_no_better_error_than_the_reference),
		cmocka_unit_test(an_error_that_is_no_number_reaches_nothing),
		cmocka_unit_test(columns_are_as_wide_as_what_stands_in_them),
		cmocka_unit_test(a_picture_has_room_for_all_its_points),
		cmocka_unit_test(a_narrow_table_keeps_what_matters),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
