/* SPDX-License-Identifier: MIT */
/*
 * What a command takes, run after run: measure RUNS COMMAND [ARGUMENT]...
 *
 * One line per run on descriptor 3: wall seconds, seconds of processor (user and system, all
 * threads), largest resident set in kB, exit status. Time counts from before the process exists to
 * after its end, so it bounds from above whatever happens in between. The command keeps its
 * standard output and error.
 */
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

extern char **environ;

static double now_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double seconds(struct timeval t)
{
	return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

int main(int count, char **arguments)
{
	if (count < 3 || atoi(arguments[1]) < 1) {
		fputs("usage: measure RUNS COMMAND [ARGUMENT]... 3>FILE\n", stderr);
		return 64;
	}
	FILE *const out = fdopen(3, "w");
	if (!out) {
		fputs("measure: descriptor 3 is not open\n", stderr);
		return 64;
	}
	for (int k = atoi(arguments[1]); k > 0; k--) {
		struct rusage used;
		pid_t child;
		int status;
		const double start = now_s();
		const int error = posix_spawnp(&child, arguments[2], NULL, NULL, arguments + 2,
		                               environ);

		if (error) {
			fprintf(stderr, "measure: '%s': %s\n", arguments[2], strerror(error));
			return 66;
		}
		if (wait4(child, &status, 0, &used) != child)
			return 70;
		fprintf(out, "%.6f %.6f %ld %d\n", now_s() - start,
		        seconds(used.ru_utime) + seconds(used.ru_stime), used.ru_maxrss,
		        WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
	}
	return fclose(out) ? 74 : 0;
}
