/* SPDX-License-Identifier: MIT */
/*
 * Runs go through a pool of processes; cases are printed in their order as soon as all runs of one
 * are there. Each expectation is one line, at the run where it did worst. A run without any
 * expectation fails: it proves nothing.
 */
#include "app/verify.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/cases.h"
#include "app/json.h"
#include "app/progress.h"
#include "app/trial.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/visible.h"

/* A run under way, in its place of the pool; which one it is. */
struct place {
	struct rb_trial trial;
	struct rb_trial_job job;
	int one, run;
	bool taken;
};

struct verify {
	const struct rb_options *options;
	struct rb_cases cases;
	struct rb_trial_result **results; /* [case][run], owned */
	int *missing;                     /* [case]: runs that have not ended */
	struct place *places;
	struct pollfd *polls;
	int place_count;
	int told;                /* cases that have been printed */
	int next_case, next_run; /* to be started */
	int run_count, run_failures, case_failures;
	bool color;
	struct rb_json json;
};

/* ---- what it comes to ---- */

/* Whether a run passed: a scene that states nothing proves nothing. */
static bool run_passed(const struct rb_trial_result *result)
{
	/* a scene that states nothing proves nothing */
	return result->exit_code == 0 && (result->refused || result->expect_count > 0);
}

/* How bad a measured value is, relative to its bound: above 1 fails. */
static double badness(const struct rb_trial_expect *expect)
{
	if (!expect->has_numbers || isnan(expect->measured) || isnan(expect->bound))
		return expect->ok ? 0 : (double)INFINITY;
	if (expect->measured <= 0)
		return expect->ok ? 0 : (double)INFINITY;
	return expect->bound > 0 ? expect->measured / expect->bound : (double)INFINITY;
}

/* The run with the worst k-th expectation; -1: none came so far. */
static int worst_run(const struct verify *verify, int one, int k)
{
	int worst = -1;

	RB_ASSERT(k >= 0);
	for (int run = 0; run < verify->cases.cases[one].run_count; run++) {
		const struct rb_trial_result *const result = &verify->results[one][run];
		if (k < result->expect_count &&
		    (worst < 0 || badness(&result->expects[k]) >
		                          badness(&verify->results[one][worst].expects[k])))
			worst = run;
	}
	return worst;
}

/* The largest number of expectations of the case's runs. */
static int expect_count(const struct verify *verify, int one)
{
	int count = 0;

	for (int run = 0; run < verify->cases.cases[one].run_count; run++)
		if (verify->results[one][run].expect_count > count)
			count = verify->results[one][run].expect_count;
	return count;
}

/* ---- the table ---- */

/* Ends a line. */
static void print_verdict(const struct verify *verify, bool passed)
{
	const char *const paint = passed ? "\033[32m" : "\033[31m";

	printf("  %s%s%s\n", verify->color ? paint : "", passed ? "pass" : "FAIL",
	       verify->color ? "\033[0m" : "");
}

enum { NAME_COLUMNS = 22, TEXT_COLUMNS = 48, LABEL_COLUMNS = 30 };

/* The columns of a line before its numbers. */
static void print_line(const char *name, const char *text, const char *label)
{
	rb_print(stdout, "%-*.*s %-*.*s %-*.*s", NAME_COLUMNS, NAME_COLUMNS, name, TEXT_COLUMNS,
	         TEXT_COLUMNS, text, LABEL_COLUMNS, LABEL_COLUMNS, label);
}

/* Prints the table's head. */
static void print_head(void)
{
	print_line("case", "what", "worst at");
	rb_print(stdout, " %10s %10s\n", "measured", "bound");
}

/*
 * Prints the worst run of an expectation. Returns the name that the next line of this case has:
 * none.
 */
static const char *print_expect(const struct verify *verify, int one, int k, const char *name)
{
	const int run = worst_run(verify, one, k);
	const struct rb_trial_expect *const expect = &verify->results[one][run].expects[k];

	if (verify->options->quiet && expect->ok)
		return name;
	print_line(name, expect->text, verify->cases.cases[one].runs[run].label);
	if (expect->has_numbers)
		rb_print(stdout, " %10.3g %10.3g", expect->measured, expect->bound);
	else
		rb_print(stdout, " %21.21s", expect->ok ? "holds" : expect->message);
	print_verdict(verify, expect->ok);
	return "";
}

/* What stands for a run that came to no expectation; NULL: it came to some. */
static const char *end_of(const struct rb_trial_result *result)
{
	if (result->refused)
		return "refused, as it must be";
	if (result->reason[0])
		return result->reason;
	return result->expect_count == 0 ? "expects nothing" : NULL;
}

/* Such runs, one line for those that ended alike. */
static const char *print_ends(const struct verify *verify, int one, const char *name)
{
	const struct rb_case *const the_case = &verify->cases.cases[one];
	const struct rb_trial_result *const results = verify->results[one];

	for (int run = 0; run < the_case->run_count; run++) {
		const char *const reason = end_of(&results[run]);
		const bool passed = run_passed(&results[run]);
		bool told = false;
		int alike = -1;
		char status[32];
		if (!reason || (verify->options->quiet && passed))
			continue;
		for (int other = 0; other < the_case->run_count; other++) {
			const char *const another = end_of(&results[other]);
			const bool same = another && strcmp(another, reason) == 0;
			told = told || (same && other < run);
			alike += same;
		}
		if (told)
			continue;
		const bool is_long = strlen(reason) > TEXT_COLUMNS;
		snprintf(status, sizeof status, "exit status %d:", results[run].exit_code);
		print_line(name, is_long ? status : reason, the_case->runs[run].label);
		if (alike > 0)
			rb_print(stdout, " and %3d more like it ", alike);
		else
			rb_print(stdout, " %21s", "");
		print_verdict(verify, passed);
		if (is_long)
			rb_print(stdout, "%*s %s\n", NAME_COLUMNS, "", reason);
		name = "";
	}
	return name;
}

static void json_run(struct rb_json *json, const struct rb_case_run *run,
                     const struct rb_trial_result *result)
{
	rb_json_open(json, NULL, '{');
	rb_json_text(json, "variation", run->label);
	rb_json_bool(json, "passed", run_passed(result));
	rb_json_count(json, "exit_status", (uint64_t)result->exit_code);
	rb_json_bool(json, "refused", result->refused);
	rb_json_text(json, "reason", result->reason);
	rb_json_number(json, "wall_time", result->wall_s);
	rb_json_count(json, "frames", result->frames);
	rb_json_count(json, "collisions", result->collisions);
	rb_json_number(json, "stepped", result->stepped_s);
	rb_json_number(json, "unexplained_share",
	               result->balance.kept ? rb_balance_energy_share(&result->balance)
	                                    : (double)NAN);
	rb_json_number(json, "unexplained_momentum_share",
	               result->balance.kept ? rb_balance_momentum_share(&result->balance)
	                                    : (double)NAN);
	rb_json_open(json, "expectations", '[');
	for (int k = 0; k < result->expect_count; k++) {
		const struct rb_trial_expect *const expect = &result->expects[k];
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "text", expect->text);
		rb_json_bool(json, "ok", expect->ok);
		rb_json_number(json, "measured",
		               expect->has_numbers ? expect->measured : (double)NAN);
		rb_json_number(json, "bound", expect->has_numbers ? expect->bound : (double)NAN);
		rb_json_text(json, "message", expect->message);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
	rb_json_close(json, '}');
}

static void tell_json(struct verify *verify, int one, bool passed)
{
	const struct rb_case *const the_case = &verify->cases.cases[one];
	struct rb_json *const json = &verify->json;

	rb_json_open(json, NULL, '{');
	rb_json_text(json, "case", the_case->name);
	rb_json_text(json, "title", the_case->title);
	rb_json_text(json, "scene", the_case->path);
	rb_json_bool(json, "passed", passed);
	rb_json_text(json, "not_varied", the_case->left_out);
	rb_json_open(json, "runs", '[');
	for (int run = 0; run < the_case->run_count; run++)
		json_run(json, &the_case->runs[run], &verify->results[one][run]);
	rb_json_close(json, ']');
	rb_json_close(json, '}');
}

/* A case of which all runs have ended. */
static void tell_case(struct verify *verify, int one)
{
	const struct rb_case *const the_case = &verify->cases.cases[one];
	int failures = 0;

	for (int run = 0; run < the_case->run_count; run++)
		failures += !run_passed(&verify->results[one][run]);
	verify->run_count += the_case->run_count;
	verify->run_failures += failures;
	verify->case_failures += failures > 0;
	if (verify->options->json) {
		tell_json(verify, one, failures == 0);
		return;
	}
	const char *name = the_case->name;
	for (int k = 0; k < expect_count(verify, one); k++)
		name = print_expect(verify, one, k, name);
	name = print_ends(verify, one, name);
	if (*the_case->left_out && !verify->options->quiet && !verify->options->quick)
		rb_print(stdout, "%*s (not varied: %s)\n", NAME_COLUMNS, "", the_case->left_out);
	fflush(stdout);
}

/* ---- the pool ---- */

static enum rb_status start_next(struct verify *verify, struct place *place, struct rb_error *err)
{
	const struct rb_case *const one = &verify->cases.cases[verify->next_case];
	const struct rb_case_run *const run = &one->runs[verify->next_run];

	place->one = verify->next_case;
	place->run = verify->next_run;
	place->job = (struct rb_trial_job){.path = one->path,
	                                   .params = run->params,
	                                   .param_count = run->param_count,
	                                   .limit_s = one->limit_s,
	                                   .options = verify->options};
	const enum rb_status status = rb_trial_start(&place->trial, &place->job, err);
	place->taken = !status;
	if (++verify->next_run == one->run_count) {
		verify->next_run = 0;
		verify->next_case++;
	}
	return status;
}

static enum rb_status end_place(struct verify *verify, struct place *place, struct rb_error *err)
{
	struct rb_trial_result *const result = &verify->results[place->one][place->run];
	const enum rb_status status = rb_trial_end(&place->trial, &place->job, result, err);

	place->taken = false;
	verify->missing[place->one]--;
	while (!status && verify->told < verify->cases.count && verify->missing[verify->told] == 0)
		tell_case(verify, verify->told++);
	return status;
}

/* Waits until a run has something to say or its time is up. */
static enum rb_status wait_for_some(struct verify *verify, struct rb_error *err)
{
	const uint64_t now_ns = rb_clock_now_ns();
	uint64_t first_ns = now_ns + 3600000000000;

	for (int i = 0; i < verify->place_count; i++) {
		const struct place *const place = &verify->places[i];
		verify->polls[i] = (struct pollfd){.fd = place->taken ? place->trial.fd : -1,
		                                   .events = POLLIN};
		if (place->taken && place->trial.deadline_ns < first_ns)
			first_ns = place->trial.deadline_ns;
	}
	const int wait_ms = first_ns > now_ns ? (int)((first_ns - now_ns) / 1000000) + 1 : 0;
	if (poll(verify->polls, (nfds_t)verify->place_count, wait_ms) < 0 && errno != EINTR)
		return RB_FAIL(err, RB_ERR_BUG, "cannot wait for a run: %s", strerror(errno));
	return RB_OK;
}

static enum rb_status run_all(struct verify *verify, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	bool any = true;

	while (!status && any) {
		any = false;
		for (int i = 0; i < verify->place_count && !status; i++) {
			struct place *const place = &verify->places[i];
			bool ended = false;
			if (place->taken)
				status = rb_trial_read(&place->trial, &ended, err);
			if (place->taken && !status &&
			    (ended || rb_trial_is_over(&place->trial, &place->job)))
				status = end_place(verify, place, err);
			if (!place->taken && !status && verify->next_case < verify->cases.count)
				status = start_next(verify, place, err);
			any = any || place->taken;
		}
		if (!status && any)
			status = wait_for_some(verify, err);
	}
	return status;
}

/* ---- the verb ---- */

static enum rb_status prepare(struct verify *verify, struct rb_error *err)
{
	const struct rb_options *const options = verify->options;
	enum rb_status status = rb_cases_init(&verify->cases, options, err);

	if (status)
		return status;
	const size_t count = (size_t)verify->cases.count;
	verify->place_count = options->jobs > 0 ? options->jobs : rb_team_processors();
	verify->results = rb_memory_take(count, sizeof(void *));
	verify->missing = rb_memory_take(count, sizeof *verify->missing);
	verify->places = rb_memory_take((size_t)verify->place_count, sizeof *verify->places);
	verify->polls = rb_memory_take((size_t)verify->place_count, sizeof *verify->polls);
	bool right = verify->results && verify->missing && verify->places && verify->polls;
	for (size_t i = 0; right && i < count; i++) {
		verify->missing[i] = verify->cases.cases[i].run_count;
		verify->results[i] = rb_memory_take((size_t)verify->missing[i],
		                                    sizeof **verify->results);
		right = verify->results[i] != NULL;
	}
	if (!right)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep the results: out of memory");
	return RB_OK;
}

static void release(struct verify *verify)
{
	for (int i = 0; verify->places && i < verify->place_count; i++)
		if (verify->places[i].taken) {
			struct rb_trial_result result;
			(void)!rb_trial_end(&verify->places[i].trial, &verify->places[i].job,
			                    &result, NULL);
			rb_trial_result_release(&result);
		}
	for (int i = 0; verify->results && i < verify->cases.count; i++)
		for (int k = 0; verify->results[i] && k < verify->cases.cases[i].run_count; k++)
			rb_trial_result_release(&verify->results[i][k]);
	for (int i = 0; verify->results && i < verify->cases.count; i++)
		rb_memory_free(verify->results[i]);
	rb_memory_free(verify->results);
	rb_memory_free(verify->missing);
	rb_memory_free(verify->places);
	rb_memory_free(verify->polls);
	rb_cases_release(&verify->cases);
}

static void begin(struct verify *verify)
{
	const char *const no_color = getenv("NO_COLOR");

	verify->color = rb_terminal_is_capable(STDOUT_FILENO) && !(no_color && *no_color);
	if (verify->options->json) {
		rb_json_open(&verify->json, NULL, '{');
		rb_json_open(&verify->json, "cases", '[');
	} else if (!verify->options->quiet) {
		print_head();
	}
}

static void end(struct verify *verify, double wall_s, int exit_code, const struct rb_error *err)
{
	const int cases = verify->told;

	if (verify->options->json) {
		rb_json_close(&verify->json, ']');
		rb_json_text(&verify->json, "error", err ? err->text : NULL);
		rb_json_count(&verify->json, "case_count", (uint64_t)cases);
		rb_json_count(&verify->json, "case_failures", (uint64_t)verify->case_failures);
		rb_json_count(&verify->json, "run_count", (uint64_t)verify->run_count);
		rb_json_count(&verify->json, "run_failures", (uint64_t)verify->run_failures);
		rb_json_number(&verify->json, "wall_time", wall_s);
		rb_json_count(&verify->json, "exit_status", (uint64_t)exit_code);
		rb_json_close(&verify->json, '}');
		putchar('\n');
	} else if (!verify->options->quiet) {
		rb_print(stdout, "%d of %d %s pass; %d of %d %s in %.3g s\n",
		         cases - verify->case_failures, cases,
		         rb_text_plural((uint64_t)cases, "case", "cases"),
		         verify->run_count - verify->run_failures, verify->run_count,
		         rb_text_plural((uint64_t)verify->run_count, "run", "runs"), wall_s);
	}
}

int rb_verify_main(const struct rb_options *options)
{
	struct verify verify = {.options = options, .json = {.file = stdout}};
	const uint64_t start_ns = rb_clock_now_ns();
	struct rb_error err;
	int exit_code = 0;
	enum rb_status status = prepare(&verify, &err);

	if (status) {
		exit_code = rb_app_refuse(options, &err);
	} else {
		begin(&verify);
		status = run_all(&verify, &err);
		if (status)
			exit_code = rb_app_fail(options, &err);
		else if (verify.case_failures > 0)
			exit_code = rb_status_exit_code(RB_ERR_EXPECT);
		end(&verify, (double)(rb_clock_now_ns() - start_ns) * 1e-9, exit_code,
		    status ? &err : NULL);
	}
	release(&verify);
	return rb_app_finish(options, exit_code);
}
