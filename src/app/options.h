/* SPDX-License-Identifier: MIT */
/*
 * The command line, from two tables: verbs and options. The parser, `--help`, the shell
 * completions and the check of the manual page read the same rows.
 *
 * The result borrows the texts of argv. Nothing here prints.
 */
#ifndef RB_APP_OPTIONS_H
#define RB_APP_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

enum rb_verb {
	RB_VERB_RUN,
	RB_VERB_CHECK,
	RB_VERB_INFO,
	RB_VERB_RENDER,
	RB_VERB_DIFF,
	RB_VERB_REPLAY,
	RB_VERB_REPAIR,
	RB_VERB_CONVERGE,
	RB_VERB_VERIFY,
	RB_VERB_METHODS,
	RB_VERB_CTL,
	RB_VERB_CONSOLE,
	RB_VERB_ATTACH,
	RB_VERB_SWEEP,
	RB_VERB_COLLECT,
	RB_VERB_PLOT,
	RB_VERB_EXPORT,
	RB_VERB_COUNT
};

struct rb_verb_row {
	const char *name;
	const char *operands; /* as in the usage line, "" without */
	int operand_count;    /* -1: any number, kept as words */
	const char *help;
	const char *examples; /* for --help: lines "command\tremark\n" */
};
extern const struct rb_verb_row rb_verbs[RB_VERB_COUNT];

enum rb_option_type {
	RB_OPTION_FLAG,
	RB_OPTION_TEXT,
	RB_OPTION_CHOICE,
	RB_OPTION_NUMBER,  /* double, finite */
	RB_OPTION_INTEGER, /* int */
	RB_OPTION_SEED,    /* uint64_t */
	RB_OPTION_LIST,    /* K=V, may be given again */
	RB_OPTION_WORDS    /* text, may be given again */
};

/* Values of a parsed command line. */
struct rb_options {
	enum rb_verb verb;
	bool verb_given; /* by name, not by default */
	const char *operand[2];
	int operand_count;
	const char **words; /* owned: operands of a verb that takes any number */
	int word_count;

	/* of no option: whatever the number of bodies, unless the scene says no */
	bool keep_ledger;
	bool help, version, quiet, json, debug, force, trust, no_record, scene_text, has_seed;
	bool no_render, resume;                /* run */
	double checkpoint_every_s;             /* run; NAN: not given */
	double point_time_s, point_disk_bytes; /* sweep; NAN: not given */
	double film_timeout_s;                 /* run, render; NAN: not given */
	const char *listen, *commands;         /* run; NULL: not given */
	const char *camera;                    /* run, render: names; NULL: not given */
	const char *with, *size;               /* render; NULL: not given */
	double from_s, to_s, fps,
		speed;      /* render; the last two console, attach too; NAN: not given */
	bool detach;        /* console */
	int frame;          /* render; -1: not given */
	bool contact_sheet; /* render */
	bool quick;         /* verify */
	const char *scenes; /* verify: folder, NULL: the shipped one */
	int jobs;           /* verify, sweep: runs at a time, 0: not given */
	const char *methods, *steps, *tolerances, *quantity; /* converge; NULL: not given */
	double error, budget_s;                              /* converge; NAN: not given */
	int runs;                                            /* converge; 0: not given */
	const char *sample, *slurm_time, *slurm_memory,
		*slurm_partition;                              /* sweep; NULL: not given */
	const char **slurm_options;                            /* sweep; owned */
	int slurm_option_count, seeds, tasks;                  /* sweep; 0: not given */
	int task;                                              /* sweep; -1: not given */
	bool csv;                                              /* collect */
	const char *against;                                   /* plot; NULL: not given */
	const char *form;                                      /* export; NULL: not given */
	bool sweep_status, sweep_plan, slurm, retry;           /* sweep */
	const char *output, *method, *rollback, *print_tables; /* NULL: not given */
	double duration_s, time_step_s, tolerance_m;           /* NAN: not given */
	int step_count;                                        /* 0: not given */
	uint64_t seed;
	int threads;         /* 0: not given */
	const char **params; /* owned: K=V each */
	int param_count;
	int argc; /* the command line itself */
	char *const *argv;
};

/* Two rows may share a name where no verb takes both. */
struct rb_option_row {
	const char *name;     /* long, without dashes */
	char letter;          /* 0: none */
	const char *argument; /* its name in the help, NULL: a flag */
	enum rb_option_type type;
	size_t offset;       /* in struct rb_options */
	unsigned verbs;      /* bit k: verb k takes it */
	double low, high;    /* of numbers */
	bool above_low;      /* the range leaves out `low` */
	const char *choices; /* "a, b" */
	const char *help;    /* NULL: not shown */
};
extern const struct rb_option_row rb_option_rows[];
extern const int rb_option_row_count;

/*
 * RB_ERR_USAGE with the nearest name for what is not known. --help and --version excuse missing
 * operands. Release with rb_options_release in any case.
 */
RB_CHECKED enum rb_status rb_options_parse(struct rb_options *options, int argc, char *const *argv,
                                           struct rb_error *err);
void rb_options_release(struct rb_options *options);

/* A whole text that is a finite number; false for anything else. */
bool rb_text_number(const char *text, double *value);

#endif
