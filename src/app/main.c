/* SPDX-License-Identifier: MIT */
/*
 * Parses, sets up logging and signals, calls the verb. All exit statuses come from rb_app_finish,
 * which also checks that standard output could be written.
 */
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/check.h"
#include "app/collect.h"
#include "app/common.h"
#include "app/console.h"
#include "app/converge.h"
#include "app/ctl.h"
#include "app/diff.h"
#include "app/export.h"
#include "app/graph.h"
#include "app/help.h"
#include "app/info.h"
#include "app/libraries.h"
#include "app/methods.h"
#include "app/progress.h"
#include "app/render.h"
#include "app/repair.h"
#include "app/replay.h"
#include "app/run.h"
#include "app/simulate.h"
#include "app/sweep.h"
#include "app/verify.h"
#include "base/address_space.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/visible.h"
#include "control/command.h"
#include "control/keys.h"
#include "script/rows.h"

static int (*const verb_main[RB_VERB_COUNT])(const struct rb_options *options) = {
	[RB_VERB_RUN] = rb_run_main,         [RB_VERB_CHECK] = rb_check_main,
	[RB_VERB_INFO] = rb_info_main,       [RB_VERB_DIFF] = rb_diff_main,
	[RB_VERB_REPLAY] = rb_replay_main,   [RB_VERB_REPAIR] = rb_repair_main,
	[RB_VERB_RENDER] = rb_render_main,   [RB_VERB_CONVERGE] = rb_converge_main,
	[RB_VERB_VERIFY] = rb_verify_main,   [RB_VERB_METHODS] = rb_methods_main,
	[RB_VERB_CTL] = rb_ctl_main,         [RB_VERB_CONSOLE] = rb_console_main,
	[RB_VERB_ATTACH] = rb_attach_main,   [RB_VERB_SWEEP] = rb_sweep_main,
	[RB_VERB_COLLECT] = rb_collect_main, [RB_VERB_PLOT] = rb_graph_main,
	[RB_VERB_EXPORT] = rb_export_main,
};

/* For base/log: one message in one write, over a progress bar that may stand there. */
static void tell(enum rb_log_level level, const char *text, void *user)
{
	const bool *const bar = user;

	const char *const before = level == RB_LOG_WARNING ? "rbsim: warning: " : "";

	if (*bar)
		rb_print(stderr, "\r\033[K%s%s\n", before, text);
	else
		rb_print(stderr, "%s%s\n", before, text);
}

/* Serves --version. */
static int print_version(const struct rb_options *options)
{
	char build[128];

	rb_build_text(build, sizeof build);
	printf("rbsim %s\nbuilt with %s\n", RB_VERSION, build);
	rb_libraries_print(stdout);
	return rb_app_finish(options, 0);
}

/* Serves --help; with a scene, also its parameters. */
static int print_help(const struct rb_options *options)
{
	if (options->operand_count > 0 && options->verb == RB_VERB_RUN)
		return rb_run_help(options);
	rb_help_print(stdout, options);
	return rb_app_finish(options, 0);
}

/* Serves --print-tables, for the manuals and completions. */
static int print_table(const struct rb_options *options)
{
	switch (*options->print_tables) {
	case 's':
		rb_fields_print(stdout);
		break;
	case 'o':
		rb_help_print_options(stdout);
		break;
	case 'c':
		rb_command_print_manual(stdout);
		break;
	case 'k':
		rb_keys_print_manual(stdout);
		break;
	default:
		rb_help_print_completion(stdout, options->print_tables);
		break;
	}
	return rb_app_finish(options, 0);
}

/* Serves the options that go before any verb, or the verb. */
static int run_verb(const struct rb_options *options)
{
	RB_ASSERT(options->verb < RB_VERB_COUNT && verb_main[options->verb]);
	if (options->print_tables)
		return print_table(options);
	if (options->version)
		return print_version(options);
	if (options->help)
		return print_help(options);
	return verb_main[options->verb](options);
}

/* For tests, by the environment: a run that ends with blocks of memory has a bug. */
static int check_memory(int exit_code)
{
	const struct rb_memory_counts counts = rb_memory_counts();

	if (!getenv("RBSIM_CHECK_MEMORY") || counts.taken == counts.freed)
		return exit_code;
	rb_print(stderr, "rbsim: %" PRIu64 " %s of memory not given back\n",
	         counts.taken - counts.freed,
	         rb_text_plural(counts.taken - counts.freed, "block", "blocks"));
	return rb_status_exit_code(RB_ERR_BUG);
}

/*
 * Whether this is `rbsim` alone on a terminal, or `rbsim help`; a scene may still be called help.
 */
static bool wants_overview(int argc, char **argv)
{
	if (argc == 1)
		return isatty(STDOUT_FILENO);
	return argc == 2 && strcmp(argv[1], "help") == 0 && access("help", F_OK) != 0;
}

/* Whether a command line that is wrong asks for JSON further on. */
static bool asks_json(int argc, char **argv)
{
	bool asks = false;

	for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
		asks |= strcmp(argv[i], "--json") == 0;
	return asks;
}

/* Prints the verbs in a line or two each. */
static int print_overview(void)
{
	static const struct rb_options options = {.verb = RB_VERB_RUN};

	rb_help_print_overview(stdout);
	return rb_app_finish(&options, 0);
}

/* Ends with the status of SIGTERM, which their own would not be: nothing is written yet. */
static void end_at_once(int signal)
{
	(void)signal;
	_exit(128 + SIGTERM);
}

int main(int argc, char **argv)
{
	struct rb_options options;
	struct rb_error err;
	bool bar = rb_terminal_is_capable(STDERR_FILENO);
	int exit_code;

	rb_address_space_share_arenas();
	/* A reader that goes away or a file at its limit is an error of a write, not an end. */
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	/* inherited as ignored, the ends of children would be told to nobody */
	signal(SIGCHLD, SIG_DFL);
	/* until a run blocks them to wait for them; nohup(1) ignores SIGHUP, and it stays so */
	signal(SIGUSR1, end_at_once);
	if (signal(SIGHUP, end_at_once) == SIG_IGN)
		signal(SIGHUP, SIG_IGN);

	if (wants_overview(argc, argv))
		return check_memory(print_overview());
	char help[] = "--help", *of_verb[] = {argv[0], argc == 3 ? argv[2] : NULL, help, NULL};
	if (argc >= 3 && strcmp(argv[1], "help") == 0 && access("help", F_OK) != 0) {
		if (argc > 3)
			rb_print(stderr, "rbsim: 'help' takes one verb (got '%s' as well)\n",
			         argv[3]);
		if (argc > 3)
			return check_memory(64);
		argv = of_verb;
	}
	if (rb_options_parse(&options, argc, argv, &err)) {
		options.json = options.json || asks_json(argc, argv);
		exit_code = rb_app_refuse(&options, &err);
		if (err.status == RB_ERR_USAGE)
			rb_print(stderr, "rbsim: see 'rbsim %s%s--help'\n",
			         options.verb_given ? rb_verbs[options.verb].name : "",
			         options.verb_given ? " " : "");
		exit_code = rb_app_finish(&options, exit_code);
	} else {
		if (!options.quiet)
			rb_log_to(tell, &bar, options.debug ? RB_LOG_DEBUG : RB_LOG_NOTE);
		exit_code = run_verb(&options);
	}
	rb_options_release(&options);
	return check_memory(exit_code);
}
