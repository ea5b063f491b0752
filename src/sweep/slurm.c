/* SPDX-License-Identifier: MIT */
/*
 * The job script is the only interface with Slurm: it calls this program again with the number of
 * its task, so nothing about points is known to Slurm, and a task that is requeued finds by itself
 * what is left to do. Slurm sends USR1 to the shell one minute ahead of the time limit; the shell
 * passes it on, the sweep stops its runs at checkpoints and ends with status 75, and the script
 * puts itself in the queue again.
 */
#include "sweep/slurm.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "base/program.h"
#include "base/visible.h"

/*
 * ARRAY_SIZE_DEFAULT: MaxArraySize of slurm.conf(5), one more than the largest index. OUTPUT_SIZE:
 * room for all that "scontrol show config" prints; what is beyond is cut.
 */
enum { ARRAY_SIZE_DEFAULT = 1001, OUTPUT_SIZE = 16384 };
static const char tasks_line[] = "tasks=";

/* ---- other programs ---- */

/*
 * Runs a program (words[0], found in PATH) in a folder (NULL: the current one) and takes what it
 * prints on both outputs, cut to `size` with the zero; the rest is read and dropped, so that it
 * never blocks. `*outcome`: as of waitpid. False with errno: there was no process.
 */
static bool run_program(const char *const *words, const char *folder, char *said, size_t size,
                        int *outcome)
{
	size_t used = 0;
	int ends[2];

	RB_ASSERT(size > 0 && words[0]);
	said[0] = '\0';
	if (pipe2(ends, O_CLOEXEC) != 0)
		return false;
	const pid_t process = fork();
	if (process == 0) {
		const int nothing = open("/dev/null", O_RDONLY);
		signal(SIGPIPE, SIG_DFL);
		signal(SIGXFSZ, SIG_DFL);
		if (dup2(nothing, STDIN_FILENO) < 0 || dup2(ends[1], STDOUT_FILENO) < 0 ||
		    dup2(ends[1], STDERR_FILENO) < 0 || (folder && chdir(folder) != 0))
			_exit(126);
		execvp(words[0], (char *const *)(uintptr_t)words);
		_exit(127);
	}
	close(ends[1]);
	while (process > 0) {
		char rest[256];
		const bool fits = used + 1 < size;
		const ssize_t got = read(ends[0], fits ? said + used : rest,
		                         fits ? size - used - 1 : sizeof rest);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			break;
		used += fits ? (size_t)got : 0;
	}
	said[used] = '\0';
	close(ends[0]);
	while (process > 0 && waitpid(process, outcome, 0) < 0)
		if (errno != EINTR)
			return false;
	return process > 0;
}

uint64_t rb_slurm_tasks_max(void)
{
	static const char key[] = "MaxArraySize";
	const char *const words[] = {"scontrol", "show", "config", NULL};
	char said[OUTPUT_SIZE];
	int outcome;

	if (!run_program(words, NULL, said, sizeof said, &outcome) || outcome != 0)
		return ARRAY_SIZE_DEFAULT;
	const char *const at = strstr(said, key);
	const char *const equals = at ? strchr(at, '=') : NULL;
	const uint64_t value = equals ? strtoull(equals + 1, NULL, 10) : 0;
	return value > 0 ? value : ARRAY_SIZE_DEFAULT;
}

/* ---- the script ---- */

/* In a shell's single quotes, in which nothing but a quote itself has a meaning. */
static void put_quoted(FILE *file, const char *text)
{
	putc('\'', file);
	for (; *text; text++) {
		if (*text == '\'')
			fputs("'\\'", file);
		putc(*text, file);
	}
	putc('\'', file);
}

/*
 * A line of sbatch, which parts it at spaces unless they stand in double quotes. NULL: no line. A
 * double quote within the value cannot be expressed.
 */
static void put_directive(FILE *file, const char *option, const char *value)
{
	if (!value)
		return;
	const bool quoted = value[strcspn(value, " \t#'\"")] != '\0';
	rb_print(file, "#SBATCH %s%s%s%s\n", option, quoted ? "\"" : "", value, quoted ? "\"" : "");
}

/* Refuses control characters, above all line breaks, which would end a directive. NULL is right. */
static enum rb_status check_text(const char *option, const char *text, struct rb_error *err)
{
	for (const char *at = text; at && *at; at += rb_visible_size(at))
		if (rb_visible_size(at) == 0)
			return RB_FAIL(err, RB_ERR_USAGE, "option '--%s' holds a control character",
			               option);
	return RB_OK;
}

/*
 * Checks all that comes from the command line into the script. Further options must begin with '-',
 * because sbatch ignores anything else silently.
 */
static enum rb_status check_texts(const struct rb_slurm_order *order, struct rb_error *err)
{
	enum rb_status status = check_text("time", order->time, err);

	if (!status)
		status = check_text("mem", order->memory, err);
	if (!status)
		status = check_text("partition", order->partition, err);
	for (int i = 0; i < order->option_count && !status; i++) {
		status = check_text("slurm-option", order->options[i], err);
		if (!status && order->options[i][0] != '-')
			status = RB_FAIL(err, RB_ERR_USAGE,
			                 "option '--slurm-option': '%s' does not begin with '-' "
			                 "(wanted: like --account=x)",
			                 order->options[i]);
	}
	return status;
}

/*
 * Writes the script. The sweep runs in the background because a shell handles a trap only after its
 * foreground command has ended.
 */
static void put_script(FILE *file, const struct rb_slurm_order *order, const char *program)
{
	RB_ASSERT(order->tasks > 0 && order->jobs > 0 && order->threads > 0);
	fputs("#!/bin/sh\n"
	      "# The points of this folder as a job array, made by rbsim sweep --slurm. To submit "
	      "it by hand, here:\n"
	      "#   sbatch " RB_SLURM_SCRIPT "\n",
	      file);
	put_directive(file, "--job-name=", order->name);
	fprintf(file, "#SBATCH --array=0-%" PRIu64 "\n", order->tasks - 1);
	fprintf(file, "#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=%d\n",
	        order->jobs * order->threads);
	put_directive(file, "--time=", order->time);
	put_directive(file, "--mem=", order->memory);
	put_directive(file, "--partition=", order->partition);
	fputs("# ahead of the time limit, to this shell\n"
	      "#SBATCH --signal=B:USR1@60\n"
	      "#SBATCH --requeue\n"
	      "#SBATCH --open-mode=append\n"
	      "#SBATCH --output=task-%a.log\n",
	      file);
	for (int i = 0; i < order->option_count; i++)
		fprintf(file, "#SBATCH %s\n", order->options[i]);
	fprintf(file, "\n%s%" PRIu64 "\nrbsim=", tasks_line, order->tasks);
	put_quoted(file, program);
	fprintf(file,
	        "\n\n\"$rbsim\" sweep . --task \"$SLURM_ARRAY_TASK_ID\" --tasks \"$tasks\" --jobs "
	        "%d --threads %d",
	        order->jobs, order->threads);
	if (!isnan(order->checkpoint_every_s))
		fprintf(file, " --checkpoint-every %.17g", order->checkpoint_every_s);
	fputs(" &\n"
	      "sweep=$!\n"
	      "asked=\n"
	      "trap 'asked=yes; kill -USR1 $sweep' USR1\n"
	      "trap 'kill -TERM $sweep' TERM INT\n"
	      "wait $sweep\n"
	      "status=$?\n"
	      "# a trap ends the first wait, not the sweep\n"
	      "while kill -0 $sweep 2>/dev/null; do\n"
	      "\twait $sweep\n"
	      "\tstatus=$?\n"
	      "done\n"
	      "# 75: there is more to do\n"
	      "if [ \"$status\" -eq 75 ] && [ -n \"$asked\" ]; then\n"
	      "\tscontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"\n"
	      "fi\n"
	      "exit $status\n",
	      file);
}

enum rb_status rb_slurm_write(const struct rb_slurm_order *order, struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE], program[PATH_MAX];
	struct rb_outfile out;
	enum rb_status status = check_texts(order, err);

	if (!status)
		status = rb_folder_name(order->folder, RB_SLURM_SCRIPT, path, err);
	if (!status)
		status = rb_program_path(program, err);
	if (!status)
		status = rb_outfile_open(&out, path, true, err);
	if (status)
		return status;
	put_script(out.file, order, program);
	return rb_outfile_publish(&out, err);
}

uint64_t rb_slurm_tasks(const char *folder)
{
	char path[RB_FOLDER_PATH_SIZE], *text;
	size_t size;
	uint64_t tasks = 0;

	if (rb_folder_name(folder, RB_SLURM_SCRIPT, path, NULL) ||
	    rb_folder_read(path, 1 << 20, &text, &size, NULL))
		return 0;
	const char *at = strstr(text, "\ntasks=");
	if (at)
		/*
		 * sizeof counts the zero of tasks_line, which makes up for the line break before it
		 */
		tasks = strtoull(at + sizeof tasks_line, NULL, 10);
	rb_memory_free(text);
	return tasks <= RB_PLAN_POINTS_MAX ? tasks : 0;
}

/*
 * The last line of the form JOBID or JOBID;CLUSTER; warnings may stand around it. `id` is left
 * alone where there is none.
 */
static void take_id(const char *said, char id[RB_SLURM_ID_SIZE])
{
	for (const char *line = said; *line;
	     line += line[strcspn(line, "\n")] ? strcspn(line, "\n") + 1 : strcspn(line, "\n")) {
		const size_t digits = strspn(line, "0123456789");
		if (digits > 0 && digits < RB_SLURM_ID_SIZE && strchr(";\n", line[digits]))
			snprintf(id, RB_SLURM_ID_SIZE, "%.*s", (int)digits, line);
	}
}

enum rb_status rb_slurm_submit(const char *folder, const char *array, char id[RB_SLURM_ID_SIZE],
                               struct rb_error *err)
{
	const size_t size = strlen(array) + 16;
	char *const option = rb_memory_take(size, 1);
	const char *const words[] = {"sbatch", "--parsable", option, RB_SLURM_SCRIPT, NULL};
	char said[OUTPUT_SIZE];
	int outcome = 0;

	id[0] = '\0';
	if (!option)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot submit the sweep: out of memory");
	snprintf(option, size, "--array=%s", array);
	const bool ran = run_program(words, folder, said, sizeof said, &outcome);
	rb_memory_free(option);
	if (!ran)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start 'sbatch': %s", strerror(errno));
	if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == 127 && !*said)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot submit: there is no 'sbatch' in PATH (the script is "
		               "'%s/" RB_SLURM_SCRIPT "')",
		               folder);
	if (outcome == 0)
		take_id(said, id);
	if (*id)
		return RB_OK;
	said[strcspn(said, "\n")] = '\0';
	return RB_FAIL(err, RB_ERR_MISSING, "sbatch refused the job: %.150s",
	               *said ? said : "it said nothing");
}
