/* SPDX-License-Identifier: MIT */
/*
 * src/app/converge.c, refine.c: what the budget allows is run, and nothing else. Runs are made up, and so is the clock: the
 * linker puts ours in the place of both.
 */
#include "support.h"

#include <fcntl.h>

#include <rbsim/model.h>

#include "app/converge.h"
#include "app/refine.h"

static double now_s;   /* of our clock */
static double fixed_s; /* what each run takes; 0: 0.1 s over its time step, s */
static int runs_made;
static double first_error; /* of the second run; halved with each run after it */

uint64_t __wrap_rb_clock_now_ns(void);
enum rb_status __wrap_rb_rung_run(struct rb_rung_result *result, const struct rb_rung_order *order,
                                  struct rb_error *err);

uint64_t __wrap_rb_clock_now_ns(void)
{
	return (uint64_t)(1e9 * now_s + 0.5);
}

enum rb_status __wrap_rb_rung_run(struct rb_rung_result *result, const struct rb_rung_order *order,
                                  struct rb_error *err)
{
	const double took_s = fixed_s > 0 ? fixed_s : 0.1 / order->time_step_s;

	(void)err;
	*result = (struct rb_rung_result){
		.state = RB_RUNG_OK, .runs = 1, .wall_s = took_s, .spent_s = took_s};
	for (int q = 0; q < RB_QUANTITY_COUNT; q++)
		result->of[q] = (struct rb_deviation){
			.count = 1, .max = first_error * pow(0.5, runs_made), .largest = 1};
	runs_made++;
	now_s += took_s;
	return RB_OK;
}

/* The verb, by these steps; what it prints is not looked at. */
static void converge(const char *scene, const char *budget)
{
	const char *const words[] = {
		"rbsim",     "converge", scene,      "--dt", "0.1,0.05,0.025,0.0125",
		"--methods", "classic",  "--budget", budget, "--json"};
	const int count = (int)(sizeof words / sizeof *words);
	struct rb_options options;
	struct rb_error err;

	assert_ok(rb_options_parse(&options, count, (char *const *)words, &err));
	fflush(stdout);
	const int out = dup(STDOUT_FILENO), none = open("/dev/null", O_WRONLY);
	dup2(none, STDOUT_FILENO);
	const int status = rb_converge_main(&options);
	fflush(stdout);
	dup2(out, STDOUT_FILENO);
	close(none);
	close(out);
	rb_options_release(&options);
	assert_int_equal(status, 0);
}

/* Settings that take 1, 2, 4, 8 s: each is foreseen to the second from the one before, and run if it fits in what is left. */
static void settings_are_run_as_far_as_their_time_fits(void **state)
{
	static const char text[] =
		"world { duration = 1, frame_rate = 10 } sphere { radius = 1, mass = 1, name = 'a' "
		"}\n"
		"reference(function(t) return {a = {position = {0, 0, 0}}} end)\n";
	char folder[256], scene[300], budget[32];

	(void)state;
	snprintf(scene, sizeof scene, "%s/s.lua", support_folder(folder));
	FILE *const file = fopen(scene, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	for (double allowed_s = 1.5; allowed_s < 20; allowed_s += 1) {
		int wanted = 0;

		for (double spent_s = 0; wanted < 4 && spent_s + (1 << wanted) <= allowed_s;)
			spent_s += 1 << wanted++;
		snprintf(budget, sizeof budget, "%g", allowed_s);
		now_s = fixed_s = 0;
		runs_made = 0;
		first_error = 1e-3;
		converge(scene, budget);
		assert_int_equal(runs_made, wanted);
	}
}

/* Runs that all take a second do not agree: as many are made as there are seconds, the last of them the one with rounding. */
static void a_reference_takes_what_it_may_and_no_more(void **state)
{
	const struct rb_ladder_method *const method = &rb_ladder_methods[0];
	const struct rb_model model = {.body_count = 1, .frame_count = 2};

	(void)state;
	for (int allowed = 4; allowed < 14; allowed++) {
		const struct rb_refine_order order = {.method = method,
		                                      .interval_s = 1,
		                                      .time_step_s = 1,
		                                      .fine_s = 0,
		                                      .tolerance_m = (double)NAN,
		                                      .error = 1e-12,
		                                      .budget_s = allowed,
		                                      .growth = 1};
		struct rb_refined refined;
		struct rb_error err;

		runs_made = 0;
		fixed_s = 1;
		first_error = 1;
		assert_ok(rb_refine(&refined, &order, &model, &err));
		assert_true(refined.found && !refined.agrees);
		assert_int_equal(refined.runs, allowed);
		assert_int_equal(runs_made, allowed);
		rb_refined_release(&refined);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(settings_are_run_as_far_as_their_time_fits),
		cmocka_unit_test(a_reference_takes_what_it_may_and_no_more),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
