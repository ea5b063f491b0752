/* SPDX-License-Identifier: MIT */
/*
 * gnuplot draws; we compose its script and hand it down a pipe. Every text of ours is in single
 * quotes with control characters made visible, so that names in scenes cannot be commands of
 * gnuplot. Drawing and complaints go to temporary files, so that neither program waits for the
 * other.
 */
#include "app/plot.h"

#include "app/progress.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "base/visible.h"

static const char program[] = "gnuplot";

enum rb_status rb_plot_available(const char *instead, struct rb_error *err)
{
	const char *path = getenv("PATH");
	char file[4096];

	for (path = path ? path : ""; *path;) {
		const int length = (int)strcspn(path, ":");
		const int size = snprintf(file, sizeof file, "%.*s/%s", length, path, program);
		if (length > 0 && size < (int)sizeof file && access(file, X_OK) == 0)
			return RB_OK;
		path += length + (path[length] == ':');
	}
	return RB_FAIL(err, RB_ERR_MISSING,
	               "cannot draw: there is no '%s' in PATH (install the package gnuplot-nox%s)",
	               program, instead);
}

/* ---- what gnuplot is told ---- */

/*
 * A text in single quotes, in which nothing but the quote has a meaning; a line ends with the line.
 */
static void put_text(FILE *script, const char *text)
{
	putc('\'', script);
	while (*text) {
		char escape[16];
		size_t size = rb_visible_size(text);
		if (size > 0) {
			fprintf(script, "%s%.*s", *text == '\'' ? "'" : "", (int)size, text);
		} else {
			size = rb_visible_escape(text, escape);
			fputs(escape, script);
		}
		text += size;
	}
	putc('\'', script);
}

static void put_terminal(FILE *script, enum rb_plot_kind kind, struct rb_plot_size size)
{
	switch (kind) {
	case RB_PLOT_TEXT:
		fprintf(script, "set terminal dumb size %d,%d %s noenhanced\n", size.width,
		        size.height, size.color ? "ansi" : "mono");
		break;
	case RB_PLOT_SVG:
		fprintf(script,
		        "set terminal svg size %d,%d dynamic background rgb 'white' noenhanced\n",
		        size.width, size.height);
		break;
	case RB_PLOT_PNG: /* the cairo one is not in every build */
		fprintf(script,
		        "if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) {\n"
		        "set terminal pngcairo size %d,%d noenhanced\n} else {\n"
		        "set terminal png size %d,%d noenhanced\n}\n",
		        size.width, size.height, size.width, size.height);
		break;
	}
}

/* The range of an axis; what is not finite is left to gnuplot. */
static void put_range(FILE *script, const char *axis, bool logarithmic, double low, double high)
{
	if (logarithmic)
		fprintf(script, "set logscale %s\nset format %s '1e%%+03T'\n", axis, axis);
	fprintf(script, "set %srange [", axis);
	if (isfinite(low))
		fprintf(script, "%.17g", low);
	putc(':', script);
	if (isfinite(high))
		fprintf(script, "%.17g", high);
	fputs("]\n", script);
}

/* A label; NULL: an empty one. */
static void put_label(FILE *script, const char *what, const char *text)
{
	fprintf(script, "set %s ", what);
	put_text(script, text ? text : "");
	putc('\n', script);
}

/* gnuplot leaves out what does not fit beside the axis of a text: there it stands above it. */
static void put_y_label(FILE *script, const char *text, enum rb_plot_kind kind)
{
	if (kind != RB_PLOT_TEXT) {
		put_label(script, "ylabel", text);
		return;
	}
	fputs("set label 1 ", script);
	put_text(script, text ? text : "");
	fputs(" at screen 0, screen 1 left offset character 0, -1\n", script);
}

/*
 * Number of points that can be drawn. A series may have none at all; gnuplot would refuse to draw
 * it.
 */
static int drawn(const struct rb_plot_series *series)
{
	int count = 0;

	RB_ASSERT(series->count >= 0);
	for (int i = 0; i < series->count; i++)
		count += isfinite(series->x[i]) && isfinite(series->y[i]);
	return count;
}

static void put_data(FILE *script, const struct rb_plot *plot)
{
	for (int k = 0; k < plot->series_count; k++) {
		const struct rb_plot_series *const series = &plot->series[k];
		fprintf(script, "$data%d << END\n", k);
		for (int i = 0; i < series->count; i++)
			if (isfinite(series->x[i]) && isfinite(series->y[i]))
				fprintf(script, "%.17g %.17g\n", series->x[i], series->y[i]);
		fputs("END\n", script);
	}
}

static void put_series(FILE *script, const struct rb_plot *plot, enum rb_plot_kind kind)
{
	const char *comma = "plot ";

	for (int k = 0; k < plot->series_count; k++) {
		const struct rb_plot_series *const series = &plot->series[k];
		const int color = series->like + 1;
		if (drawn(series) == 0)
			continue;
		fprintf(script, "%s$data%d using 1:2 with ", comma, k);
		if (series->crosses)
			/* the 24th mark of a text is an X */
			fprintf(script, "points pointtype %d linecolor %d",
			        kind == RB_PLOT_TEXT ? 24 : 2, color);
		else if (series->plain)
			fprintf(script,
			        kind == RB_PLOT_TEXT ? "lines linetype %d"
			                             : "lines linewidth 2 linecolor %d",
			        color);
		else if (kind == RB_PLOT_TEXT)
			fprintf(script, "linespoints pointtype %d linetype %d", color, color);
		else
			fprintf(script,
			        "linespoints linewidth 2 pointtype %d linecolor %d dashtype %d",
			        2 * color + 3, color, color);
		fputs(kind == RB_PLOT_TEXT || series->plain ? " title " : " pointsize 1.2 title ",
		      script);
		put_text(script, series->name);
		comma = ", ";
	}
	putc('\n', script);
}

static void put_plot(FILE *script, const struct rb_plot *plot, enum rb_plot_kind kind,
                     struct rb_plot_size size)
{
	fputs("set encoding utf8\n", script);
	put_terminal(script, kind, size);
	put_label(script, "title", plot->title);
	put_label(script, "xlabel", plot->x_label);
	put_y_label(script, plot->y_label, kind);
	put_range(script, "x", plot->x_log, plot->x_low, plot->x_high);
	put_range(script, "y", plot->y_log, plot->y_low, plot->y_high);
	fprintf(script, "set grid\nset key %s\n",
	        kind == RB_PLOT_TEXT ? "outside below" : "tmargin center horizontal");
	put_data(script, plot);
	put_series(script, plot, kind);
}

/* ---- the child ---- */

/* The child after fork. Without start-up files of the user. */
static _Noreturn void become_gnuplot(int in, int out, int complaints)
{
	char name[] = "gnuplot", plain[] = "-d"; /* no start-up files of the user */
	char *const words[] = {name, plain, NULL};

	signal(SIGPIPE, SIG_DFL);
	if (dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
	    dup2(complaints, STDERR_FILENO) < 0)
		_exit(126);
	execvp(name, words);
	_exit(127);
}

/* The line of gnuplot's that says what is wrong, not the echo of what it was given. */
static void read_complaint(FILE *complaints, char *out, size_t size)
{
	char line[160];

	*out = '\0';
	rewind(complaints);
	while (fgets(line, sizeof line, complaints)) {
		line[strcspn(line, "\n")] = '\0';
		if (strstr(line, "line ") || (*line && *out == '\0'))
			snprintf(out, size, "%s", line);
	}
}

/* Runs gnuplot on the script of a plot. */
static enum rb_status feed(const struct rb_plot *plot, enum rb_plot_kind kind,
                           struct rb_plot_size size, FILE *drawing, FILE *complaints,
                           struct rb_error *err)
{
	int ends[2], status = 0;
	char complaint[160];

	if (pipe2(ends, O_CLOEXEC) != 0)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot make a pipe: %s", strerror(errno));
	fflush(NULL);
	const pid_t pid = fork();
	if (pid == 0)
		become_gnuplot(ends[0], fileno(drawing), fileno(complaints));
	close(ends[0]);
	FILE *const script = pid > 0 ? fdopen(ends[1], "w") : NULL;
	if (script) {
		put_plot(script, plot, kind, size);
		fclose(script); /* a pipe that broke shows in the status below */
	} else {
		close(ends[1]);
	}
	if (pid < 0)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start '%s': %s", program,
		               strerror(errno));
	while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
		continue;
	if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && script)
		return RB_OK;
	read_complaint(complaints, complaint, sizeof complaint);
	return RB_FAIL(err, RB_ERR_MISSING, "cannot draw: '%s' failed%s%s", program,
	               *complaint ? ": " : "", complaint);
}

/* Copies a drawing. A text begins with a form feed, which means nothing to whoever reads on. */
static bool copy(FILE *from, FILE *to, bool text)
{
	char block[8192];
	size_t size;

	rewind(from);
	while ((size = fread(block, 1, sizeof block, from)) > 0) {
		const size_t skip = text && block[0] == '\f';
		if (fwrite(block + skip, 1, size - skip, to) != size - skip)
			return true;
		text = false;
	}
	return !ferror(from);
}

enum rb_status rb_plot_draw(const struct rb_plot *plot, enum rb_plot_kind kind,
                            struct rb_plot_size size, FILE *to, struct rb_error *err)
{
	FILE *const drawing = tmpfile();
	FILE *const complaints = tmpfile();
	enum rb_status status = RB_OK;

	RB_ASSERT(plot->series_count > 0 && to);
	if (!drawing || !complaints)
		status = RB_FAIL(err, RB_ERR_CREATE, "cannot make a temporary file: %s",
		                 strerror(errno));
	if (!status)
		status = feed(plot, kind, size, drawing, complaints, err);
	if (!status && !copy(drawing, to, kind == RB_PLOT_TEXT))
		status = RB_FAIL(err, RB_ERR_IO, "cannot read a temporary file: %s",
		                 strerror(errno));
	if (drawing)
		fclose(drawing);
	if (complaints)
		fclose(complaints);
	return status;
}

struct rb_plot_size rb_plot_text_size(void)
{
	struct rb_plot_size size = {.width = 79, .height = 24};
	const char *no_color = getenv("NO_COLOR");
	struct winsize window;

	if (!isatty(STDOUT_FILENO))
		return size;
	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col >= 40 &&
	    window.ws_row >= 12) {
		size.width = window.ws_col - 1;
		size.height = window.ws_row < 44 ? window.ws_row - 4 : 40;
	}
	size.color = rb_terminal_is_capable(STDOUT_FILENO) && !(no_color && *no_color);
	return size;
}
