/* SPDX-License-Identifier: MIT */
/*
 * The table of options is the only list: parsing, help, manual, completion and the options that a
 * sweep hands on read it. A row says where its value goes in struct rb_options, so most options
 * need no code. A name may have two rows, for different verbs; whether an option belongs to the
 * verb is checked when the whole line was read, because the verb may come after it.
 */
#include "app/options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <rbsim/scene.h>

#include "base/error.h"
#include "base/memory.h"
#include "script/nearest.h"

#define VERB(name) (1u << RB_VERB_##name)
#define ALL                                                                                       \
	(VERB(RUN) | VERB(CHECK) | VERB(INFO) | VERB(RENDER) | VERB(DIFF) | VERB(REPLAY) |        \
	 VERB(REPAIR) | VERB(CONVERGE) | VERB(VERIFY) | VERB(METHODS) | VERB(CTL) | VERB(SWEEP) | \
	 VERB(COLLECT) | VERB(PLOT) | VERB(EXPORT))
#define EVERY (ALL | VERB(CONSOLE) | VERB(ATTACH))
#define SCENE (VERB(RUN) | VERB(CHECK) | VERB(CONSOLE))
/* what a sweep hands on to its runs (app/sweep) */
#define EACH VERB(SWEEP)
#define AT(field) offsetof(struct rb_options, field)

const struct rb_verb_row rb_verbs[RB_VERB_COUNT] = {
	[RB_VERB_RUN] = {"run", "SCENE.lua", 1, "simulate a scene and record every frame",
                         "rbsim bounce.lua\tsimulate; the recording is bounce.h5\n"
                         "rbsim bounce.lua --help\tthe scene's own parameters\n"
                         "rbsim bounce.lua --param e=0.5 -o half.h5\tanother value, another file\n"
                         "rbsim bounce.lua --no-record --json\tonly the result, for a script\n"},
	[RB_VERB_CHECK] = {"check", "SCENE.lua", 1,
                           "validate a scene and print what a run will do and take",
                           "rbsim check bounce.lua\tplan, memory and disk\n"
                           "rbsim check bounce.lua --json\tthe same for a script\n"},
	[RB_VERB_INFO] = {"info", "RUN.h5", 1, "what is in a recording and how the run went",
                          "rbsim info bounce.h5\tat a glance\n"
                          "rbsim info bounce.h5 --scene >again.lua\tthe scene it was made from\n"},
	[RB_VERB_RENDER] =
		{"render", "RUN.h5", 1, "pictures and video from a recording",
                 "rbsim render bounce.h5\tthe films that the scene's cameras ask for\n"
                 "rbsim render bounce.h5 --camera main -o slow.mp4 --speed 0.25\tslow motion\n"
                 "rbsim render bounce.h5 --frame 30 -o picture.png\tone picture\n"
                 "rbsim render bounce.h5 --contact-sheet -o sheet.png\tthe whole run at a glance\n"
                 "rbsim render bounce.h5 --with cameras.lua -o 'frames/%05d.png'\tother cameras\n"},
	[RB_VERB_DIFF] = {"diff", "A.h5 B.h5", 2,
                          "the first frame and body at which two recordings differ",
                          "rbsim diff before.h5 after.h5\texit status 0: the same to the bit\n"},
	[RB_VERB_REPLAY] =
		{"replay", "RUN.h5", 1, "run a recording's scene again and compare every frame",
                 "rbsim replay bounce.h5\texit status 0: the same bits; 1: where they differ\n"},
	[RB_VERB_REPAIR] =
		{"repair", "RUN.h5", 1,
                 "make the recording of a run that was killed a plain file again",
                 "rbsim repair bounce.h5\tfor readers that do not follow growing files\n"},
	[RB_VERB_CONVERGE] =
		{"converge", "SCENE.lua", 1, "error against run time, over methods and time steps",
                 "rbsim converge bounce.lua\ta table, a picture and advice\n"
                 "rbsim converge bounce.lua -o bounce.svg\tthe picture in a file\n"
                 "rbsim converge bounce.lua --error 1e-9\twhat is the cheapest for that?\n"
                 "rbsim converge bounce.lua --methods classic --dt 0.01,0.001\tonly these\n"},
	[RB_VERB_VERIFY] = {"verify", "[CASE...]", -1,
                            "problems with known answers: measured, bound, pass or fail",
                            "rbsim verify\tall cases in all variations\n"
                            "rbsim verify --quick\ta subset, in less than a minute\n"
                            "rbsim verify s03 s10\tthese, by the beginning of their names\n"
                            "rbsim verify s03 --json\twith the numbers of every variation\n"},
	[RB_VERB_METHODS] = {"methods", "", 0, "the methods and what each is good for",
                             "rbsim methods\ta table\n"},
	[RB_VERB_CTL] = {"ctl", "SOCKET COMMAND...", -1, "one command to a run that listens",
                         "rbsim bounce.lua --listen run.sock &\ta run that takes commands\n"
                         "rbsim ctl run.sock pause\tit stands still\n"
                         "rbsim ctl run.sock status\twhere, and its numbers\n"
                         "rbsim ctl run.sock help\tall commands\n"},
	[RB_VERB_CONSOLE] =
		{"console", "SCENE.lua|RUN.h5", 1, "watch and steer a run, or watch a recording",
                 "rbsim console bounce.h5\ta recording, also one that still grows\n"
                 "rbsim console bounce.lua --force\ta run of its own; it ends with the console\n"
                 "rbsim console bounce.h5 --speed 0.1\tin slow motion\n"},
	[RB_VERB_ATTACH] =
		{"attach", "SOCKET", 1, "a console over a run that is going on",
                 "rbsim attach run.sock\tthe run of --listen run.sock; q leaves it as it is\n"},
	[RB_VERB_SWEEP] =
		{"sweep", "SCENE.lua|DIR", 1, "one run for each point of a range of parameters",
                 "rbsim sweep bounce.lua --param e=0:1:0.1 -o bounces\televen runs; again: goes "
                 "on\n"
                 "rbsim sweep pile.lua --param mu=0.2,0.5 --seeds 20 -o piles\tforty\n"
                 "rbsim sweep gas.lua --param v=1:5 --sample latin:100 -o gas\ta hundred\n"
                 "rbsim sweep bounces --status\tdone, running, failed, missing\n"
                 "rbsim sweep bounces --slurm --time 1:00:00\tthe same as a job array\n"
                 "rbsim sweep bounces --task 3 --tasks 10\tits fourth tenth, under any "
                 "scheduler\n"},
	[RB_VERB_COLLECT] = {"collect", "DIR", 1, "one file over all runs of a sweep",
                             "rbsim collect bounces\tbounces/sweep.h5\n"
                             "rbsim collect bounces --csv >bounces.csv\ta table\n"},
	[RB_VERB_PLOT] =
		{"plot", "RUN.h5|SWEEP.h5 QUANTITY...", -1,
                 "a recording against time, or results of a sweep against a parameter",
                 "rbsim plot bounce.h5 energy kinetic_energy\tin the terminal\n"
                 "rbsim plot bounce.h5 ball.z -o height.svg\tthe height of body 'ball'\n"
                 "rbsim plot bounce.h5 ball.vz --against ball.z\ta phase plot\n"
                 "rbsim plot bounces/sweep.h5 energy_drift --against e\ta cross for each run\n"},
	[RB_VERB_EXPORT] =
		{"export", "RUN.h5", 1, "a recording for other programs: tables, glTF, VTK, a dump",
                 "rbsim export bounce.h5 --to csv\ttables: bounce-bodies.csv, bounce-frames.csv, "
                 "...\n"
                 "rbsim export bounce.h5 -o bounce.glb\tan animated scene for browsers and "
                 "Blender\n"
                 "rbsim export bounce.h5 --to vtk\tsurfaces for ParaView: open bounce.pvd\n"
                 "rbsim export bounce.h5 --to dump\ta dump of LAMMPS's form, for OVITO\n"},
};

const struct rb_option_row rb_option_rows[] = {
	{"output", 'o', "FILE", RB_OPTION_TEXT, AT(output), SCENE, 0, 0, false, NULL,
         "record to FILE (default: the scene's record file, else its name with .h5, here)"},
	{"output", 'o', "FILM", RB_OPTION_TEXT, AT(output), VERB(RENDER), 0, 0, false, NULL,
         "film (.mp4, .webm, .gif) or pictures (frames/%05d.png), instead of what the camera says"},
	{"output", 'o', "REPORT", RB_OPTION_TEXT, AT(output), VERB(CONVERGE), 0, 0, false, NULL,
         "write the report to REPORT: a picture (.svg, .png) or all numbers (.csv, .json)"},
	{"output", 'o', "DIR", RB_OPTION_TEXT, AT(output), VERB(SWEEP), 0, 0, false, NULL,
         "folder of the sweep; if it already holds this sweep, the sweep is resumed"},
	{"output", 'o', "FILE", RB_OPTION_TEXT, AT(output), VERB(COLLECT), 0, 0, false, NULL,
         "write to FILE, HDF5 or a table (.csv) (default: sweep.h5 in the sweep's folder)"},
	{"output", 'o', "PICTURE", RB_OPTION_TEXT, AT(output), VERB(PLOT), 0, 0, false, NULL,
         "draw to PICTURE (.svg, .png) instead of the terminal"},
	{"output", 'o', "FILE", RB_OPTION_TEXT, AT(output), VERB(EXPORT), 0, 0, false, NULL,
         "write to FILE (.glb, .pvd, .dump; for tables the beginning of their names) (default: the "
         "recording's name, here)"},
	{"to", 0, "FORM", RB_OPTION_CHOICE, AT(form), VERB(EXPORT), 0, 0, false,
         "csv, glb, vtk, dump",
         "form: tables (csv), animated glTF (glb), surfaces for VTK (vtk), a dump as LAMMPS writes "
         "it (default: by the ending of --output)"},
	{"against", 0, "NAME", RB_OPTION_TEXT, AT(against), VERB(PLOT), 0, 0, false, NULL,
         "what the horizontal axis shows: a quantity of the recording (default: the time), a "
         "parameter or result of the sweep (default: the index)"},
	{"csv", 0, NULL, RB_OPTION_FLAG, AT(csv), VERB(COLLECT), 0, 0, false, NULL,
         "a table of comma-separated values, without --output on standard output"},
	{"param", 'p', "NAME=VALUES", RB_OPTION_LIST, AT(params), VERB(SWEEP), 0, 0, false, NULL,
         "values of a parameter: a list A,B,C, a range low:high:step, for a sample also low:high; "
         "may be given again"},
	{"seeds", 0, "N", RB_OPTION_INTEGER, AT(seeds), VERB(SWEEP), 1, 10000000, false, NULL,
         "runs for each combination of values, each with a seed of its own (default: 1)"},
	{"sample", 0, "latin:N", RB_OPTION_TEXT, AT(sample), VERB(SWEEP), 0, 0, false, NULL,
         "points of a Latin hypercube instead of all combinations, N of them"},
	{"task", 0, "K", RB_OPTION_INTEGER, AT(task), VERB(SWEEP), 0, 9999999, false, NULL,
         "run one share only, the K-th of --tasks, from 0"},
	{"tasks", 0, "N", RB_OPTION_INTEGER, AT(tasks), VERB(SWEEP), 1, 10000000, false, NULL,
         "number of shares that the points are divided into"},
	{"status", 0, NULL, RB_OPTION_FLAG, AT(sweep_status), VERB(SWEEP), 0, 0, false, NULL,
         "report which points are done, running, failed and missing, and run nothing"},
	{"plan", 0, NULL, RB_OPTION_FLAG, AT(sweep_plan), VERB(SWEEP), 0, 0, false, NULL,
         "write the plan of the sweep, print what its points will take, and run nothing"},
	{"retry-failed", 0, NULL, RB_OPTION_FLAG, AT(retry), VERB(SWEEP), 0, 0, false, NULL,
         "run all failed points again (otherwise only those that lacked memory, disk or a program, "
         "or crashed)"},
	{"slurm", 0, NULL, RB_OPTION_FLAG, AT(slurm), VERB(SWEEP), 0, 0, false, NULL,
         "submit the remaining points to Slurm as a job array, instead of running them here"},
	{"time", 0, "LIMIT", RB_OPTION_TEXT, AT(slurm_time), VERB(SWEEP), 0, 0, false, NULL,
         "time limit of a task, as sbatch takes it: 1:30:00"},
	{"mem", 0, "SIZE", RB_OPTION_TEXT, AT(slurm_memory), VERB(SWEEP), 0, 0, false, NULL,
         "memory of a task, as sbatch takes it: 2G"},
	{"partition", 0, "NAME", RB_OPTION_TEXT, AT(slurm_partition), VERB(SWEEP), 0, 0, false,
         NULL, "partition that the tasks run in"},
	{"slurm-option", 0, "OPTION", RB_OPTION_WORDS, AT(slurm_options), VERB(SWEEP), 0, 0, false,
         NULL, "any other option of sbatch, like --account=physics; may be given again"},
	{"seed", 0, "N", RB_OPTION_SEED, AT(seed), VERB(SWEEP), 0, 0, false, NULL,
         "base seed from which the seeds of all runs are derived (default: the scene's)"},
	{"param", 'p', "NAME=VALUE", RB_OPTION_LIST, AT(params), SCENE | VERB(CONVERGE), 0, 0,
         false, NULL, "set a parameter of the scene; may be given again"},
	{"duration", 0, "SECONDS", RB_OPTION_NUMBER, AT(duration_s), SCENE | EACH | VERB(CONVERGE),
         0, (double)INFINITY, true, NULL, "simulated time, instead of the scene's"},
	{"steps", 0, "N", RB_OPTION_INTEGER, AT(step_count), SCENE | EACH | VERB(CONVERGE), 1,
         INT_MAX, false, NULL,
         "simulated time as a whole number of time steps, instead of the scene's"},
	{"time-step", 0, "SECONDS", RB_OPTION_NUMBER, AT(time_step_s), SCENE | EACH, 0,
         (double)INFINITY, true, NULL, "longest step of the solver, instead of the scene's"},
	{"tolerance", 0, "METRES", RB_OPTION_NUMBER, AT(tolerance_m), SCENE | EACH, 0,
         (double)INFINITY, true, NULL,
         "largest overlap that a frame may show, instead of the scene's"},
	{"methods", 0, "LIST", RB_OPTION_TEXT, AT(methods), VERB(CONVERGE), 0, 0, false, NULL,
         "methods to compare: classic, classic-global, classic-none, located, located-global, "
         "stepped"},
	{"dt", 0, "LIST", RB_OPTION_TEXT, AT(steps), VERB(CONVERGE), 0, 0, false, NULL,
         "time steps in seconds, like 0.01,0.001 (default: half decades from 10 to 1/100 of the "
         "scene's)"},
	{"tolerance", 0, "LIST", RB_OPTION_TEXT, AT(tolerances), VERB(CONVERGE), 0, 0, false, NULL,
         "tolerances in metres, as the ladder instead of time steps"},
	{"quantity", 0, "NAME", RB_OPTION_CHOICE, AT(quantity), VERB(CONVERGE), 0, 0, false,
         "position, velocity, orientation, angular_velocity, energy, penetration",
         "whose error counts (default: position)"},
	{"error", 0, "VALUE", RB_OPTION_NUMBER, AT(error), VERB(CONVERGE), 0, (double)INFINITY,
         true, NULL,
         "error, in the unit of the quantity, for which the cheapest setting is printed "
         "(default: 1e-6)"},
	{"runs", 0, "N", RB_OPTION_INTEGER, AT(runs), VERB(CONVERGE), 1, 1000, false, NULL,
         "runs of each setting, of which the shortest counts (default: up to 5)"},
	{"budget", 0, "SECONDS", RB_OPTION_NUMBER, AT(budget_s), VERB(CONVERGE), 0,
         (double)INFINITY, true, NULL,
         "wall time for the whole ladder; settings that would exceed it are omitted (default: 60)"},
	{"method", 0, "NAME", RB_OPTION_CHOICE, AT(method), SCENE | EACH | VERB(VERIFY), 0, 0,
         false, RB_METHOD_NAMES, "method of the solver (see rbsim methods)"},
	{"rollback", 0, "KIND", RB_OPTION_CHOICE, AT(rollback), SCENE | EACH | VERB(VERIFY), 0, 0,
         false, "selective, global, none",
         "what is restored when an overlap is found (the bodies concerned, the whole scene, "
         "nothing)"},
	{"seed", 0, "N", RB_OPTION_SEED, AT(seed), SCENE | VERB(CONVERGE), 0, 0, false, NULL,
         "seed of the scene's random numbers"},
	{"threads", 0, "N", RB_OPTION_INTEGER, AT(threads), VERB(SWEEP), 1, 1024, false, NULL,
         "workers of the simulator in each run (default: 1)"},
	{"threads", 0, "N", RB_OPTION_INTEGER, AT(threads), SCENE | VERB(CONVERGE) | VERB(REPLAY),
         1, 1024, false, NULL,
         "workers of the simulator (default: the processors this process may use)"},
	{"no-record", 0, NULL, RB_OPTION_FLAG, AT(no_record), SCENE | EACH, 0, 0, false, NULL,
         "write no recording"},
	{"no-render", 0, NULL, RB_OPTION_FLAG, AT(no_render), SCENE | EACH, 0, 0, false, NULL,
         "make none of the films and pictures that cameras ask for"},
	{"camera", 0, "NAMES", RB_OPTION_TEXT, AT(camera),
         VERB(RUN) | VERB(RENDER) | VERB(CONSOLE) | EACH, 0, 0, false, NULL,
         "film with these cameras only: names separated by commas"},
	{"with", 0, "CAMERAS.lua", RB_OPTION_TEXT, AT(with), VERB(RENDER), 0, 0, false, NULL,
         "take the cameras from this file instead of the recorded scene"},
	{"from", 0, "SECONDS", RB_OPTION_NUMBER, AT(from_s), VERB(RENDER), 0, (double)INFINITY,
         false, NULL, "simulated time of the first picture"},
	{"to", 0, "SECONDS", RB_OPTION_NUMBER, AT(to_s), VERB(RENDER), 0, (double)INFINITY, false,
         NULL, "simulated time of the last picture"},
	{"fps", 0, "N", RB_OPTION_NUMBER, AT(fps), VERB(RENDER), 0, 1e6, true, NULL,
         "pictures per second of film"},
	{"fps", 0, "N", RB_OPTION_NUMBER, AT(fps), VERB(CONSOLE) | VERB(ATTACH), 0, 1000, true,
         NULL, "at most this many pictures per second on the screen (default: 30)"},
	{"speed", 0, "FACTOR", RB_OPTION_NUMBER, AT(speed), VERB(CONSOLE) | VERB(ATTACH), 0,
         (double)INFINITY, true, NULL,
         "simulated seconds shown in a second (default: 1; of attach: the newest frames)"},
	{"detach", 0, NULL, RB_OPTION_FLAG, AT(detach), VERB(CONSOLE), 0, 0, false, NULL,
         "let the run continue when the console ends"},
	{"speed", 0, "FACTOR", RB_OPTION_NUMBER, AT(speed), VERB(RENDER), 0, (double)INFINITY, true,
         NULL, "simulated seconds in a second of film: 0.25 is slow motion, 10 time lapse"},
	{"size", 0, "WxH", RB_OPTION_TEXT, AT(size), VERB(RENDER), 0, 0, false, NULL,
         "pixels of the pictures, like 1920x1080"},
	{"frame", 0, "N", RB_OPTION_INTEGER, AT(frame), VERB(RENDER), 0, INT_MAX, false, NULL,
         "one picture, of this frame, to --output PICTURE.png"},
	{"contact-sheet", 0, NULL, RB_OPTION_FLAG, AT(contact_sheet), VERB(RENDER), 0, 0, false,
         NULL, "sixteen pictures in one, with their times, to --output SHEET.png"},
	{"point-time", 0, "SECONDS", RB_OPTION_NUMBER, AT(point_time_s), VERB(SWEEP), 0,
         (double)INFINITY, true, NULL,
         "end a run that takes longer (wall time, at a checkpoint); its point has failed"},
	{"point-disk", 0, "BYTES", RB_OPTION_NUMBER, AT(point_disk_bytes), VERB(SWEEP), 1, 1e18,
         false, NULL, "end a run whose files exceed this size; its point has failed"},
	{"film-timeout", 0, "SECONDS", RB_OPTION_NUMBER, AT(film_timeout_s),
         VERB(RUN) | VERB(RENDER) | EACH, 0, (double)INFINITY, true, NULL,
         "abandon a film whose encoder does not react for so long; the run continues (default: "
         "60)"},
	{"checkpoint-every", 0, "SECONDS", RB_OPTION_NUMBER, AT(checkpoint_every_s),
         VERB(RUN) | EACH, 0, (double)INFINITY, false, NULL,
         "wall time between checkpoints, 0: only on a signal or command (default: 60)"},
	{"resume", 0, NULL, RB_OPTION_FLAG, AT(resume), VERB(RUN), 0, 0, false, NULL,
         "continue from the recording's checkpoint, or from the start without one; a complete "
         "run is not changed"},
	{"listen", 0, "SOCKET", RB_OPTION_TEXT, AT(listen), VERB(RUN), 0, 0, false, NULL,
         "take commands at a Unix socket, see rbsim-control(7)"},
	{"commands", 0, "FILE", RB_OPTION_TEXT, AT(commands), VERB(RUN), 0, 0, false, NULL,
         "execute commands from FILE, each when it is due; -: from standard input"},
	{"force", 0, NULL, RB_OPTION_FLAG, AT(force),
         SCENE | VERB(RENDER) | VERB(CONVERGE) | VERB(COLLECT) | VERB(PLOT) | VERB(EXPORT), 0, 0,
         false, NULL, "replace existing recordings, films and reports"},
	{"trust", 0, NULL, RB_OPTION_FLAG, AT(trust),
         SCENE | EACH | VERB(RENDER) | VERB(REPLAY) | VERB(REPAIR) | VERB(CONVERGE) | VERB(ATTACH) |
                 VERB(EXPORT),
         0, 0, false, NULL,
         "run the scene's script without the sandbox: only for scripts that you trust"},
	{"quick", 0, NULL, RB_OPTION_FLAG, AT(quick), VERB(VERIFY), 0, 0, false, NULL,
         "a subset of cases and variations that takes less than a minute"},
	{"scenes", 0, "DIR", RB_OPTION_TEXT, AT(scenes), VERB(VERIFY), 0, 0, false, NULL,
         "folder with the cases, instead of the shipped one"},
	{"jobs", 0, "N", RB_OPTION_INTEGER, AT(jobs), VERB(VERIFY) | VERB(SWEEP), 1, 1024, false,
         NULL, "runs at a time (default: the processors this process may use)"},
	{"scene", 0, NULL, RB_OPTION_FLAG, AT(scene_text), VERB(INFO), 0, 0, false, NULL,
         "print the text of the recorded scene and nothing else"},
	{"quiet", 'q', NULL, RB_OPTION_FLAG, AT(quiet), ALL, 0, 0, false, NULL,
         "no progress and no summary; errors are still reported"},
	{"json", 0, NULL, RB_OPTION_FLAG, AT(json), ALL, 0, 0, false, NULL,
         "one JSON object on standard output"},
	{"debug", 0, NULL, RB_OPTION_FLAG, AT(debug), EVERY, 0, 0, false, NULL,
         "show where in the program and in the script an error arose"},
	{"help", 'h', NULL, RB_OPTION_FLAG, AT(help), EVERY, 0, 0, false, NULL,
         "this text; with a scene also its parameters"},
	{"version", 'V', NULL, RB_OPTION_FLAG, AT(version), EVERY, 0, 0, false, NULL,
         "version and libraries"},
	{"print-tables", 0, "WHICH", RB_OPTION_CHOICE, AT(print_tables), EVERY, 0, 0, false,
         "scene, options, commands, keys, bash, zsh", NULL},
};
const int rb_option_row_count = sizeof rb_option_rows / sizeof *rb_option_rows;

/* One command line being read. */
struct parse {
	struct rb_options *options;
	char *const *argv;
	int argc, next;
	bool given[128]; /* by row, to be held against the verb once that is known */
	struct rb_error *err;
};
_Static_assert(sizeof rb_option_rows / sizeof *rb_option_rows <= 128, "parse.given is too short");

bool rb_text_number(const char *text, double *value)
{
	char *end;

	if (*text == '\0' || strchr(" \t\n\v\f\r", *text)) /* which strtod would skip */
		return false;
	*value = strtod(text, &end);
	return *end == '\0' && isfinite(*value);
}

/* Whether the verb, as far as it is known, has the option. */
static bool is_of_verb(const struct parse *parse, const char *name)
{
	for (int i = 0; i < rb_option_row_count; i++)
		if (strcmp(rb_option_rows[i].name, name) == 0 &&
		    rb_option_rows[i].verbs & 1u << parse->options->verb)
			return true;
	return false;
}

static enum rb_status unknown_option(struct parse *parse, const char *name, size_t length)
{
	char word[64];

	snprintf(word, sizeof word, "%.*s", (int)length, name);
	struct rb_nearest nearest = rb_nearest_to(word);
	for (int i = 0; i < rb_option_row_count; i++)
		if (rb_option_rows[i].help && rb_option_rows[i].verbs & 1u << parse->options->verb)
			rb_nearest_offer(&nearest, rb_option_rows[i].name,
			                 strlen(rb_option_rows[i].name));
	if (*nearest.best)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "unknown option '--%s' (did you mean '--%s'?)", word, nearest.best);
	const bool has_parameters = is_of_verb(parse, "param");
	return RB_FAIL(parse->err, RB_ERR_USAGE, "unknown option '--%s'%s", word,
	               has_parameters ? " (parameters of scenes are given by --param NAME=VALUE)"
	                              : "");
}

static enum rb_status bad_number(struct parse *parse, const struct rb_option_row *row,
                                 const char *text)
{
	const char *kind = row->type == RB_OPTION_NUMBER ? "number" : "whole number";

	if (row->type == RB_OPTION_SEED)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--%s': '%s' is not a whole number from 0 to %lld",
		               row->name, text, LLONG_MAX);
	if (row->above_low && isfinite(row->high))
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--%s': '%s' is not a %s above %g, at most %.19g", row->name,
		               text, kind, row->low, row->high);
	if (row->above_low)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--%s': '%s' is not a finite %s above %g", row->name, text,
		               kind, row->low);
	if (!isfinite(row->high))
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--%s': '%s' is not a finite %s, %g or more", row->name,
		               text, kind, row->low);
	return RB_FAIL(parse->err, RB_ERR_USAGE, "option '--%s': '%s' is not a %s from %g to %.19g",
	               row->name, text, kind, row->low, row->high);
}

/* Digits alone; false when they do not fit. */
static bool whole_number(const char *text, uint64_t high, uint64_t *value)
{
	if (text[0] == '\0' || text[strspn(text, "0123456789")] != '\0')
		return false;
	errno = 0;
	*value = strtoull(text, NULL, 10);
	return errno == 0 && *value <= high;
}

static enum rb_status take_choice(struct parse *parse, const struct rb_option_row *row,
                                  const char *text, const char **value)
{
	const size_t length = strlen(text);

	for (const char *at = row->choices; at;) {
		const size_t one = strcspn(at, ",");
		if (one == length && memcmp(at, text, one) == 0) {
			*value = text;
			return RB_OK;
		}
		at = at[one] ? at + one + 2 : NULL;
	}
	return RB_FAIL(parse->err, RB_ERR_USAGE, "option '--%s': '%s' is not one of: %s", row->name,
	               text, row->choices);
}

static enum rb_status take_value(struct parse *parse, const struct rb_option_row *row,
                                 const char *text)
{
	void *const field = (char *)parse->options + row->offset;
	uint64_t whole;

	parse->given[row - rb_option_rows] = true;
	switch (row->type) {
	case RB_OPTION_FLAG:
		*(bool *)field = true;
		return RB_OK;
	case RB_OPTION_TEXT:
		if (*text == '\0')
			return RB_FAIL(parse->err, RB_ERR_USAGE,
			               "option '--%s' needs a %s that is not empty", row->name,
			               row->argument);
		*(const char **)field = text;
		return RB_OK;
	case RB_OPTION_CHOICE:
		return take_choice(parse, row, text, field);
	case RB_OPTION_NUMBER: {
		double number;
		if (!rb_text_number(text, &number) || number < row->low || number > row->high ||
		    (row->above_low && number == row->low))
			return bad_number(parse, row, text);
		*(double *)field = number;
		return RB_OK;
	}
	case RB_OPTION_INTEGER:
		if (!whole_number(text, (uint64_t)row->high, &whole) || (double)whole < row->low)
			return bad_number(parse, row, text);
		*(int *)field = (int)whole;
		return RB_OK;
	case RB_OPTION_SEED:
		if (!whole_number(text, INT64_MAX, &whole))
			return bad_number(parse, row, text);
		*(uint64_t *)field = whole;
		parse->options->has_seed = true;
		return RB_OK;
	case RB_OPTION_LIST:
		if (*text == '=' || !strchr(text, '='))
			return RB_FAIL(parse->err, RB_ERR_USAGE,
			               "option '--%s': '%s' is not of the form %s", row->name, text,
			               row->argument);
		parse->options->params[parse->options->param_count++] = text;
		return RB_OK;
	case RB_OPTION_WORDS:
		parse->options->slurm_options[parse->options->slurm_option_count++] = text;
		return RB_OK;
	}
	return RB_OK;
}

/* Takes an option; `text` NULL: its value is the next word. */
static enum rb_status take_option(struct parse *parse, const struct rb_option_row *row,
                                  const char *text)
{
	if (row->type == RB_OPTION_FLAG) {
		if (text)
			return RB_FAIL(parse->err, RB_ERR_USAGE,
			               "option '--%s' takes no value (got '%s')", row->name, text);
	} else if (!text) {
		if (parse->next >= parse->argc)
			return RB_FAIL(parse->err, RB_ERR_USAGE, "option '--%s' needs a %s",
			               row->name, row->argument);
		text = parse->argv[parse->next++];
	}
	return take_value(parse, row, text);
}

/*
 * The row of a name or letter, that of the verb, as far as that is known, where there are two;
 * NULL: none.
 */
static const struct rb_option_row *row_of(const struct parse *parse, const char *name,
                                          size_t length, char letter)
{
	const struct rb_option_row *found = NULL;

	for (int i = 0; i < rb_option_row_count; i++) {
		const struct rb_option_row *row = &rb_option_rows[i];
		const bool named = name ? strlen(row->name) == length &&
		                                   memcmp(row->name, name, length) == 0
		                        : row->letter == letter;
		if (named && (!found || row->verbs & 1u << parse->options->verb))
			found = row;
	}
	return found;
}

/* Takes --NAME or --NAME=VALUE. */
static enum rb_status take_long(struct parse *parse, const char *word)
{
	const size_t length = strcspn(word, "=");
	const struct rb_option_row *row = row_of(parse, word, length, 0);

	if (!row)
		return unknown_option(parse, word, length);
	return take_option(parse, row, word[length] ? word + length + 1 : NULL);
}

/* Takes -q, -qo FILE, -oFILE. */
static enum rb_status take_short(struct parse *parse, const char *letters)
{
	for (; *letters; letters++) {
		const struct rb_option_row *row = row_of(parse, NULL, 0, *letters);
		if (!row)
			return RB_FAIL(parse->err, RB_ERR_USAGE, "unknown option '-%c'", *letters);
		const bool flag = row->type == RB_OPTION_FLAG;
		const enum rb_status status = take_option(parse, row,
		                                          !flag && letters[1] ? letters + 1 : NULL);
		if (status || !flag)
			return status;
	}
	return RB_OK;
}

/* Fails where a word is no file and looks like a verb that is not known. */
static enum rb_status check_not_verb(struct parse *parse, const char *word)
{
	char hint[96];

	if (strpbrk(word, "./") || access(word, F_OK) == 0)
		return RB_OK;
	struct rb_nearest nearest = rb_nearest_to(word);
	for (int i = 0; i < RB_VERB_COUNT; i++)
		rb_nearest_offer(&nearest, rb_verbs[i].name, strlen(rb_verbs[i].name));
	if (*nearest.best)
		return RB_FAIL(parse->err, RB_ERR_USAGE, "unknown verb '%s'%s", word,
		               rb_nearest_hint(&nearest, hint));
	char scene[128];
	snprintf(scene, sizeof scene, "%.100s.lua", word);
	if (access(scene, F_OK) == 0)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "'%s' is neither a verb nor a scene (did you mean '%s'?)", word,
		               scene);
	return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s' is neither a verb nor a scene", word);
}

/* Takes a verb, a file, or a word of a command. */
static enum rb_status take_operand(struct parse *parse, const char *word, bool may_be_verb)
{
	struct rb_options *const options = parse->options;

	if (may_be_verb) {
		for (int i = 0; i < RB_VERB_COUNT; i++)
			if (strcmp(rb_verbs[i].name, word) == 0) {
				options->verb = (enum rb_verb)i;
				options->verb_given = true;
				return RB_OK;
			}
		const enum rb_status status = check_not_verb(parse, word);
		if (status)
			return status;
	}
	const struct rb_verb_row *verb = &rb_verbs[options->verb];
	if (verb->operand_count < 0) {
		options->words[options->word_count++] = word;
		return RB_OK;
	}
	if (options->operand_count >= verb->operand_count)
		return RB_FAIL(parse->err, RB_ERR_USAGE, "unexpected operand '%s': %s takes %s",
		               word, verb->name,
		               verb->operand_count == 0 ? "none" : verb->operands);
	options->operand[options->operand_count++] = word;
	return RB_OK;
}

/* Checks what only the whole line tells. */
static enum rb_status check_whole(const struct parse *parse)
{
	const struct rb_options *const options = parse->options;
	const struct rb_verb_row *verb = &rb_verbs[options->verb];

	for (int i = 0; i < rb_option_row_count; i++)
		if (parse->given[i] && !(rb_option_rows[i].verbs & 1u << options->verb))
			return RB_FAIL(parse->err, RB_ERR_USAGE,
			               "option '--%s' does not belong to '%s'%s",
			               rb_option_rows[i].name, verb->name,
			               strcmp(rb_option_rows[i].name, "dt") == 0
			                       ? " (did you mean '--time-step'?)"
			                       : "");
	if (options->help || options->version || options->print_tables)
		return RB_OK;
	if (options->operand_count < verb->operand_count)
		return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s' needs %s%s", verb->name,
		               verb->operands, options->operand_count == 0 ? "" : " (two files)");
	if ((options->verb == RB_VERB_CTL || options->verb == RB_VERB_PLOT) &&
	    options->word_count < 2)
		return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s' needs %s", verb->name,
		               verb->operands);
	if (options->no_record && options->output && options->verb != RB_VERB_SWEEP)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--output' contradicts '--no-record'");
	if (options->output && strcmp(options->output, "-") == 0 &&
	    options->verb != RB_VERB_COLLECT)
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--output': only 'collect' writes to standard output (got "
		               "'-'; './-' is a file)");
	if (options->step_count > 0 && !isnan(options->duration_s))
		return RB_FAIL(parse->err, RB_ERR_USAGE,
		               "option '--steps' contradicts '--duration'");
	if (options->resume && (options->no_record || options->force))
		return RB_FAIL(parse->err, RB_ERR_USAGE, "option '--resume' contradicts '--%s'",
		               options->no_record ? "no-record" : "force");
	return RB_OK;
}

enum rb_status rb_options_parse(struct rb_options *options, int argc, char *const *argv,
                                struct rb_error *err)
{
	struct parse parse = {
		.options = options, .argv = argv, .argc = argc, .next = 1, .err = err};
	bool first = true, only_operands = false;

	RB_ASSERT(argc >= 1 && argv[0]);
	*options = (struct rb_options){.duration_s = (double)NAN,
	                               .time_step_s = (double)NAN,
	                               .tolerance_m = (double)NAN,
	                               .from_s = (double)NAN,
	                               .to_s = (double)NAN,
	                               .fps = (double)NAN,
	                               .speed = (double)NAN,
	                               .frame = -1,
	                               .task = -1,
	                               .error = (double)NAN,
	                               .budget_s = (double)NAN,
	                               .checkpoint_every_s = (double)NAN,
	                               .film_timeout_s = (double)NAN,
	                               .point_time_s = (double)NAN,
	                               .point_disk_bytes = (double)NAN,
	                               .argc = argc,
	                               .argv = argv};
	options->params = rb_memory_take((size_t)argc + 1, sizeof *options->params);
	options->words = rb_memory_take((size_t)argc + 1, sizeof *options->words);
	options->slurm_options = rb_memory_take((size_t)argc + 1, sizeof *options->slurm_options);
	if (!options->params || !options->words || !options->slurm_options)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read the command line: out of memory");
	while (parse.next < argc) {
		const char *const word = argv[parse.next++];
		enum rb_status status = RB_OK;

		if (only_operands || word[0] != '-' || word[1] == '\0') {
			/* behind -- a word is a file, even if it is called 'check' */
			status = take_operand(&parse, word, first && !only_operands);
			first = false;
			/* "camera move 1 -2 0": what follows the socket is the command */
			only_operands |= options->verb == RB_VERB_CTL && options->word_count > 0;
		} else if (strcmp(word, "--") == 0) {
			only_operands = true;
		} else if (word[1] == '-') {
			status = take_long(&parse, word + 2);
		} else {
			status = take_short(&parse, word + 1);
		}
		if (status)
			return status;
	}
	return check_whole(&parse);
}

void rb_options_release(struct rb_options *options)
{
	rb_memory_free(options->params);
	rb_memory_free(options->words);
	rb_memory_free(options->slurm_options);
	*options = (struct rb_options){0};
}
