/* SPDX-License-Identifier: MIT */
#include "app/run.h"

#include <stdlib.h>
#include <unistd.h>

#include "app/help.h"
#include "app/progress.h"
#include "app/simulate.h"
#include "app/summary.h"

static bool color_wanted(void)
{
	const char *no_color = getenv("NO_COLOR");

	return rb_terminal_is_capable(STDERR_FILENO) && !(no_color && *no_color);
}

/* Talk first, then the result: whoever reads both has them in order. */
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

/* The films that the scene's cameras ask for, checked before anything is simulated. */
static enum rb_status prepare_films(struct rb_films **films, struct rb_loaded *loaded,
                                    const struct rb_options *options, struct rb_error *err)
{
	const struct rb_films_wish wish = rb_films_wish_of_run(loaded, options);

	return options->no_render ? RB_OK : rb_films_create(films, loaded, &wish, err);
}

int rb_run_main(const struct rb_options *options)
{
	struct rb_loaded loaded;
	struct rb_run_texts texts = {0};
	struct rb_run_info info;
	struct rb_run_result result = {0};
	struct rb_films *films = NULL;
	struct rb_error err;
	enum rb_status status = rb_loaded_init(&loaded, options, &err);
	int exit_code;

	if (!status)
		status = rb_simulate_check_output(&loaded, options, &err);
	if (!status)
		status = rb_simulate_info(&info, &texts, &loaded, options, &err);
	if (!status)
		status = prepare_films(&films, &loaded, options, &err);
	if (status) {
		exit_code = rb_app_refuse_scene(options, &loaded, &err);
	} else {
		(void)rb_simulate(&result, &loaded, options, &info, films);
		exit_code = report(&result, &loaded, options, &info, films);
	}
	rb_films_destroy(films);
	rb_run_result_release(&result);
	rb_run_texts_release(&texts);
	rb_loaded_release(&loaded);
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
