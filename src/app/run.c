/* SPDX-License-Identifier: MIT */
/*
 * A run is an attempt: scene, outputs, films, and where it continues from. A restart ends one
 * attempt and begins the next with the same clients; therefore everything that belongs to one is in
 * one struct that is released as a whole. Order of beginning: everything that can be refused is
 * checked before anything is created or overwritten.
 */
#include "app/run.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/film_summary.h"
#include "app/help.h"
#include "app/json.h"
#include "app/listen.h"
#include "app/progress.h"
#include "app/render.h"
#include "app/simulate.h"
#include "app/summary.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"

/*
 * Whether the summary may be coloured: on a capable terminal, unless NO_COLOR is set
 * (no-color.org).
 */
static bool color_wanted(void)
{
	const char *no_color = getenv("NO_COLOR");

	return rb_terminal_is_capable(STDERR_FILENO) && !(no_color && *no_color);
}

/*
 * Prints the summary, then the result; the exit status. Errors of the run go before those of its
 * films, and these before its expectations.
 */
static int report(const struct rb_run_result *result, const struct rb_loaded *loaded,
                  const struct rb_options *options, const struct rb_run_info *info,
                  const struct rb_films *films)
{
	const bool started = result->frames > 0;
	int exit_code = 0;

	if (result->status && !started)
		return rb_app_refuse_scene(options, loaded, &result->error);
	if (!options->quiet && !options->json && started) {
		rb_summary_print(stderr, result, loaded, info, color_wanted());
		rb_films_print(stderr, films);
	} else if (result->expect_failures > 0 && !options->json) {
		rb_summary_print_expects(stderr, result, true, color_wanted());
	}

	if (result->status)
		exit_code = rb_app_fail_scene(options, loaded, &result->error);
	else if (result->film_status)
		exit_code = rb_app_fail_scene(options, loaded, &result->film_error);
	else if (result->expect_status)
		exit_code = rb_app_fail_scene(options, loaded, &result->expect_error);
	else if (loaded->scene.expect_refused)
		exit_code = rb_app_not_refused(loaded);
	else if (result->expect_failures > 0)
		exit_code = rb_status_exit_code(RB_ERR_EXPECT);
	if (options->json)
		rb_summary_print_json(stdout, result, loaded, info, films, exit_code);
	return exit_code;
}

/* Makes the films that the scene's cameras ask for, checked before anything is simulated. */
static enum rb_status prepare_films(struct rb_films **films, struct rb_loaded *loaded,
                                    const struct rb_options *options, struct rb_error *err)
{
	const struct rb_films_wish wish = rb_films_wish_of_run(loaded, options);

	rb_films_tell_unrecorded(loaded);
	return options->no_render ? RB_OK : rb_films_create(films, loaded, &wish, err);
}

/* A run and what it is made of; another one for each restart. */
struct attempt {
	struct rb_loaded *loaded; /* owned */
	struct rb_run_texts texts;
	struct rb_run_info info;
	struct rb_films *films;
	struct rb_resume resume; /* of the first attempt alone */
	struct rb_run_result result;
};

/* Frees an attempt, also one that never began. */
static void release(struct attempt *attempt)
{
	rb_films_destroy(attempt->films);
	rb_resume_release(&attempt->resume);
	rb_run_result_release(&attempt->result);
	rb_run_texts_release(&attempt->texts);
	if (attempt->loaded)
		rb_loaded_release(attempt->loaded);
	rb_memory_free(attempt->loaded);
	*attempt = (struct attempt){0};
}

/* Makes what the outputs of a loaded scene need. */
static enum rb_status prepare(struct attempt *attempt, const struct rb_options *options,
                              struct rb_error *err)
{
	const enum rb_status status = rb_simulate_info(&attempt->info, &attempt->texts,
	                                               attempt->loaded, options, err);

	RB_ASSERT(attempt->loaded != NULL);
	return status ? status : prepare_films(&attempt->films, attempt->loaded, options, err);
}

/* Everything up to the first step; nothing was touched where it fails. */
static enum rb_status begin(struct attempt *attempt, struct rb_listen **listen,
                            const struct rb_options *options, struct rb_error *err)
{
	enum rb_status status = rb_loaded_init(attempt->loaded, options, err);

	if (!status)
		status = rb_simulate_check_output(attempt->loaded, options, err);
	if (!status)
		status = rb_resume_look(&attempt->resume, attempt->loaded, options, err);
	if (status || attempt->resume.kind == RB_RESUME_DONE)
		return status;
	status = prepare(attempt, options, err);
	if (!status && attempt->resume.kind != RB_RESUME_NEW)
		memcpy(attempt->info.started, attempt->resume.started,
		       sizeof attempt->info.started);
	if (!status)
		status = rb_listen_create(listen, options, attempt->loaded, &attempt->info, err);
	return status;
}

/* Makes the next attempt of a run that has ended to begin anew. Who watches it stays. */
static enum rb_status begin_again(struct attempt *attempt, struct rb_listen *listen,
                                  struct rb_error *err)
{
	rb_listen_run_ends(listen);
	release(attempt);
	attempt->loaded = rb_listen_next(listen);
	const enum rb_status status = prepare(attempt, rb_listen_options(listen), err);

	return status ? status
	              : rb_listen_begin_again(listen, attempt->loaded, &attempt->info, err);
}

/* Says that nothing is left to be done, and removes a checkpoint that is of no more use. */
static int tell_done(const struct rb_loaded *loaded, const struct rb_options *options)
{
	struct rb_json json = {.file = stdout};

	rb_checkpoints_remove(loaded->output, loaded->how);
	if (options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "scene", loaded->scene.file);
		rb_json_text(&json, "status", "complete");
		rb_json_text(&json, "recording", loaded->output);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!options->quiet) {
		rb_print(stderr, "rbsim: '%s' is complete: nothing is left to be done\n",
		         loaded->output);
	}
	return 0;
}

/* The parts of an attempt that the simulation needs. */
static struct rb_simulate_parts parts_of(struct attempt *attempt, struct rb_listen *listen)
{
	return (struct rb_simulate_parts){
		.films = attempt->films,
		.listen = listen,
		.resume = attempt->resume.kind == RB_RESUME_GO_ON ? &attempt->resume : NULL,
		.again = attempt->resume.kind == RB_RESUME_AGAIN};
}

/*
 * Makes the films that need the whole run, of one that was not broken off, as far as it has come.
 */
static void make_late_films(struct attempt *attempt, const struct rb_options *options)
{
	struct rb_run_result *const result = &attempt->result;
	struct rb_error err;

	if (result->frames == 0 || (result->status && result->status != RB_ERR_PHYSICS))
		return;
	const enum rb_status status = rb_render_late(attempt->films, attempt->loaded, options,
	                                             &err);
	if (status && !result->film_status) {
		result->film_status = status;
		result->film_error = err;
	}
}

int rb_run_main(const struct rb_options *options)
{
	struct attempt attempt = {.loaded = rb_memory_take(1, sizeof *attempt.loaded)};
	const struct rb_options *wanted = options;
	struct rb_listen *listen = NULL;
	struct rb_error err;
	enum rb_status status;
	int exit_code;

	if (!attempt.loaded) {
		(void)RB_FAIL(&err, RB_ERR_MEMORY, "cannot load '%s': out of memory",
		              options->operand[0]);
		return rb_app_finish(options, rb_app_refuse(options, &err));
	}
	status = begin(&attempt, &listen, options, &err);
	const bool done = !status && attempt.resume.kind == RB_RESUME_DONE;
	while (!status && !done) {
		const struct rb_simulate_parts parts = parts_of(&attempt, listen);

		(void)rb_simulate(&attempt.result, attempt.loaded, wanted, &attempt.info, &parts);
		if (!attempt.result.restart || attempt.result.status != RB_ERR_INTERRUPT)
			break;
		status = begin_again(&attempt, listen, &err);
		wanted = rb_listen_options(listen);
	}
	rb_listen_destroy(listen);
	if (!status && !done)
		make_late_films(&attempt, wanted);
	exit_code = status ? rb_app_refuse_scene(options, attempt.loaded, &err)
	            : done ? tell_done(attempt.loaded, options)
	                   : report(&attempt.result, attempt.loaded, options, &attempt.info,
	                            attempt.films);
	release(&attempt);
	return rb_app_finish(options, exit_code);
}

int rb_run_help(const struct rb_options *options)
{
	struct rb_loaded loaded;
	struct rb_error err;
	struct rb_options scene_only = *options;
	int exit_code = 0;

	/*
	 * A scene that lacks a duration or a body still has parameters to show, so only its script
	 * counts here.
	 */
	scene_only.no_record = true;
	rb_help_print(stdout, options);
	const enum rb_status status = rb_loaded_init(&loaded, &scene_only, &err);
	if (loaded.scene.param_count > 0 || !status)
		rb_help_print_params(stdout, &loaded.scene);
	else
		exit_code = rb_app_fail_scene(options, &loaded, &err);
	rb_loaded_release(&loaded);
	return rb_app_finish(options, exit_code);
}
