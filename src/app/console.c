/* SPDX-License-Identifier: MIT */
/*
 * A console is a loop of viewers: each shows one source with one model until it is left, or until
 * the run begins anew with what may be another scene; then everything is loaded again and the next
 * viewer goes on with the same speed. A scene is run in a process of its own, so that the picture
 * never costs the simulation time, and a crash of one does not end the other.
 */
#include "app/console.h"

#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/attached.h"
#include "app/common.h"
#include "app/recorded.h"
#include "app/simulate.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/visible.h"
#include "control/viewer.h"

/* fps: what terminals can draw over most lines. connect_s: to find a run's socket, s. */
static const double usual_fps = 30, connect_s = 2;
/*
 * nice value of an attached console: on a busy machine the picture comes after the run that it
 * shows.
 */
enum { POLITENESS = 5 };

/* One call of the verb. */
struct console {
	const struct rb_options *options;
	const char *name; /* of what is viewed */
	const struct rb_console_module *module;
	struct rb_loaded loaded;
	struct rb_client *client; /* NULL: no run */
	char *recording;          /* owned; NULL: there is none */
	bool is_older;            /* it stood there before the run of one's own was started */
	struct rb_process child;
	struct rb_viewer_run run;
	struct rb_source *source;
	struct rb_viewer *viewer;
	double speed; /* of the viewer before this one; NAN: there was none */
	int signal;
};

/* Fails unless there is a terminal to draw on. */
static enum rb_status need_terminal(struct rb_error *err)
{
	if (isatty(STDIN_FILENO) && isatty(STDOUT_FILENO))
		return RB_OK;
	return RB_FAIL(err, RB_ERR_USAGE,
	               "a console needs a terminal, but standard %s is not one (rbsim ctl sends "
	               "single commands to a run)",
	               isatty(STDIN_FILENO) ? "output" : "input");
}

/* Whether a name is that of a scene. */
static bool is_scene(const char *path)
{
	const size_t size = strlen(path);

	return size > 4 && strcmp(path + size - 4, ".lua") == 0;
}

/* ---- one viewer ---- */

/* Opens what is to be viewed: a run, or a recording. */
static enum rb_status open_source(struct console *c, struct rb_error *err)
{
	const struct rb_model *const model = c->loaded.model;

	if (c->client)
		return rb_source_of_run(&c->source, c->client, c->recording, model, err);
	if (c->recording && !c->is_older)
		return rb_source_of_recording(&c->source, c->recording, model, err);
	return RB_FAIL(err, RB_ERR_INPUT,
	               "the run was over before it could be watched, and made no recording");
}

/* Whether the run of one's own has ended; how. */
static bool has_ended(void *user, int *exit_code)
{
	struct rb_process *const child = user;
	const bool lives = rb_process_lives(child);

	*exit_code = child->exit_code;
	return !lives;
}

/* One viewer from beginning to end; `*wish`: why it ended. */
static enum rb_status show(struct console *c, enum rb_viewer_wish *wish, struct rb_error *err)
{
	const struct rb_options *const options = c->options;
	const bool own = c->child.address[0] != '\0';

	c->run.ended = has_ended;
	c->run.user = &c->child;
	const double wanted = isnan(options->speed) ? 1 : options->speed;
	enum rb_status status = open_source(c, err);

	*wish = RB_VIEWER_QUITS;
	if (!status) {
		const struct rb_viewer_options viewer = {
			.source = c->source,
			.model = c->loaded.model,
			.script = c->loaded.script,
			.name = c->name,
			.fps = isnan(options->fps) ? usual_fps : options->fps,
			.speed = isnan(c->speed) ? wanted : c->speed,
			.live = c->client && !own && isnan(options->speed) && isnan(c->speed),
			.run = own ? &c->run : NULL,
		};
		status = rb_viewer_create(&c->viewer, &viewer, rb_clock_now_ns(), err);
	}
	if (!status)
		status = c->module->run(c->viewer, own ? c->child.errors : -1, &c->signal, err);
	if (!status) {
		*wish = c->signal ? RB_VIEWER_QUITS : c->viewer->wish;
		c->speed = c->viewer->speed;
	}
	rb_viewer_destroy(c->viewer);
	rb_source_destroy(c->source);
	c->viewer = NULL;
	c->source = NULL;
	return status;
}

/* Loads the scene that the run has now. */
static enum rb_status load_run(struct console *c, struct rb_error *err)
{
	RB_ASSERT(c->client != NULL);
	rb_loaded_release(&c->loaded);
	rb_memory_free(c->recording);
	c->recording = NULL;
	return rb_attached_load(&c->loaded, &c->recording, c->client, c->options->trust, err);
}

/* Loads the scene of a recording. */
static enum rb_status load_recording(struct console *c, const char *path, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	enum rb_status status = rb_module_hdf5(&module, err);

	if (!status)
		status = module->reader_open(&reader, path, err);
	if (status)
		return status;
	status = rb_recorded_load(&c->loaded, module->reader_reading(reader), path,
	                          c->options->trust, err);
	module->reader_close(reader);
	return status;
}

/*
 * Starts a run of one's own, or starts it again. What it says before it can be watched is reported
 * as if it had been started alone.
 */
static enum rb_status start_run(struct console *c, bool again, struct rb_error *err)
{
	struct stat before, after;
	const bool was = c->recording && stat(c->recording, &before) == 0;

	rb_client_close(c->client);
	c->client = NULL;
	rb_process_release(&c->child);
	enum rb_status status = rb_process_start(&c->child, c->options, again ? &c->run : NULL,
	                                         err);
	if (!status)
		status = rb_process_connect(&c->child, &c->client, err);
	c->is_older = was && !c->client && stat(c->recording, &after) == 0 &&
	              before.st_ino == after.st_ino && before.st_dev == after.st_dev;
	return status;
}

/* Starts the run of one's own again: with other values it may have another scene. */
static enum rb_status start_again(struct console *c, struct rb_error *err)
{
	enum rb_status status = start_run(c, true, err);

	if (status || (!c->client && (!c->recording || c->is_older)))
		return status;
	if (c->client)
		return load_run(c, err);
	rb_loaded_release(&c->loaded);
	return load_recording(c, c->recording, err);
}

/* Viewers, until one is left for good. */
static enum rb_status watch(struct console *c, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	enum rb_viewer_wish wish;

	do {
		status = show(c, &wish, err);
		if (!status && wish == RB_VIEWER_RESTARTS)
			status = start_again(c, err);
		else if (!status && wish == RB_VIEWER_RELOADS)
			status = load_run(c, err);
	} while (!status && wish != RB_VIEWER_QUITS);
	return status;
}

/* ---- what there is to be viewed ---- */

/* Loads the scene of the recording that is named. */
static enum rb_status open_recording(struct console *c, struct rb_error *err)
{
	const char *const path = c->options->operand[0];
	const enum rb_status status = load_recording(c, path, err);

	c->recording = rb_memory_copy_text(path);
	if (!status && !c->recording)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot view '%s': out of memory", path);
	return status;
}

/* Refuses options of a run, which have no meaning for a recording. */
static enum rb_status check_options(const struct rb_options *options, struct rb_error *err)
{
	static const char *const flags[] = {
		"--param",  "--duration",  "--steps",     "--time-step", "--tolerance",
		"--method", "--rollback",  "--seed",      "--threads",   "--output",
		"--force",  "--no-record", "--no-render", "--camera",    "--detach"};
	const bool given[] = {options->param_count > 0,
	                      !isnan(options->duration_s),
	                      options->step_count > 0,
	                      !isnan(options->time_step_s),
	                      !isnan(options->tolerance_m),
	                      options->method != NULL,
	                      options->rollback != NULL,
	                      options->has_seed,
	                      options->threads > 0,
	                      options->output != NULL,
	                      options->force,
	                      options->no_record,
	                      options->no_render,
	                      options->camera != NULL,
	                      options->detach};

	for (size_t i = 0; i < sizeof given / sizeof *given; i++)
		if (given[i])
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '%s' is for a run, and '%s' is a recording",
			               flags[i], options->operand[0]);
	return RB_OK;
}

/* Checks the scene here, before there is a screen or a process, and starts its run. */
static enum rb_status open_scene(struct console *c, struct rb_error *err)
{
	enum rb_status status = rb_loaded_init(&c->loaded, c->options, err);

	if (!status)
		status = rb_simulate_check_output(&c->loaded, c->options, err);
	if (!status && c->loaded.output) {
		c->recording = rb_memory_copy_text(c->loaded.output);
		if (!c->recording)
			status = RB_FAIL(err, RB_ERR_MEMORY,
			                 "cannot open a console: out of memory");
	}
	return status ? status : start_run(c, false, err);
}

/* Prints what a run of one's own said last, where it could not be watched. */
static void tell_child(struct rb_process *child)
{
	char bytes[512];
	ssize_t size;

	while (child->errors >= 0 && (size = read(child->errors, bytes, sizeof bytes)) > 0)
		rb_print_lines(stderr, bytes, (size_t)size);
}

/* Ends a run of one's own, unless it is to go on alone. */
static void end_child(struct console *c)
{
	if (c->child.address[0] == '\0')
		return;
	if (c->options->detach && rb_process_lives(&c->child)) {
		rb_print(stderr, "rbsim: the run goes on: rbsim attach %s\n", c->child.address);
		return;
	}
	if (rb_process_lives(&c->child)) {
		rb_process_end(&c->child);
		if (c->recording)
			rb_print(stderr, "rbsim: the run was ended; '%s' holds it up to there\n",
			         c->recording);
	}
}

/* Reports, frees all, and ends by the signal that ended the console, if one did. */
static int finish(struct console *c, enum rb_status status, const struct rb_error *err)
{
	int exit_code = 0;

	end_child(c);
	if (status == RB_ERR_INPUT && c->child.exit_code != 0) {
		/* it says itself what was wrong */
		tell_child(&c->child);
		exit_code = c->child.exit_code;
	} else if (status) {
		exit_code = c->loaded.mistakes.count > 0
		                    ? rb_app_fail_scene(c->options, &c->loaded, err)
		                    : rb_app_fail(c->options, err);
	}
	rb_client_close(c->client);
	rb_process_release(&c->child);
	rb_loaded_release(&c->loaded);
	rb_memory_free(c->recording);
	if (c->signal) {
		signal(c->signal, SIG_DFL);
		raise(c->signal);
	}
	return rb_app_finish(c->options, exit_code);
}

/* The state at the start. Warnings go nowhere: they would spoil the screen. */
static struct console begin(const struct rb_options *options)
{
	/* what the program has to say would spoil the screen */
	rb_log_to(NULL, NULL, RB_LOG_WARNING);
	return (struct console){.options = options,
	                        .name = options->operand[0],
	                        .child = {.errors = -1},
	                        .speed = (double)NAN};
}

int rb_console_main(const struct rb_options *options)
{
	struct console c = begin(options);
	struct rb_error err = {0};
	enum rb_status status = need_terminal(&err);

	if (!status)
		status = rb_module_console(&c.module, &err);
	if (!status && !is_scene(options->operand[0]))
		status = check_options(options, &err);
	if (!status)
		status = is_scene(options->operand[0]) ? open_scene(&c, &err)
		                                       : open_recording(&c, &err);
	if (!status)
		status = watch(&c, &err);
	return finish(&c, status, &err);
}

int rb_attach_main(const struct rb_options *options)
{
	struct console c = begin(options);
	struct rb_error err = {0};
	enum rb_status status = need_terminal(&err);

	if (!status)
		status = rb_module_console(&c.module, &err);
	/* on a busy machine the picture comes after the run that it shows */
	setpriority(PRIO_PROCESS, 0, POLITENESS);
	if (!status)
		status = rb_client_connect(&c.client, options->operand[0], connect_s, &err);
	if (!status)
		status = load_run(&c, &err);
	if (!status)
		status = watch(&c, &err);
	return finish(&c, status, &err);
}
