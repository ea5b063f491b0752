/* SPDX-License-Identifier: MIT */
#include "app/overview.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "app/common.h"
#include "app/progress.h"
#include "base/error.h"
#include "base/visible.h"

/*
 * REDRAW_EVERY_MS on a terminal, LINE_EVERY_MS in a log. FAILURES_TOLD: the rest is counted;
 * --status lists all. BAR_MOST, BAR_LEAST: columns of the bar; a shorter one is left out.
 */
enum {
	REDRAW_EVERY_MS = 100,
	LINE_EVERY_MS = 60000,
	FAILURES_TOLD = 10,
	BAR_MOST = 30,
	BAR_LEAST = 8
};

void rb_overview_init(struct rb_overview *overview, const struct rb_plan *plan, const char *folder,
                      bool quiet)
{
	*overview = (struct rb_overview){.plan = plan,
	                                 .folder = folder,
	                                 .quiet = quiet,
	                                 .redraw = rb_terminal_is_capable(STDERR_FILENO)};
}

int rb_overview_tick_ms(const struct rb_overview *overview)
{
	if (overview->quiet)
		return 0;
	return overview->redraw ? REDRAW_EVERY_MS : LINE_EVERY_MS;
}

void rb_overview_line(char *line, size_t size, int width, const struct rb_jobs_tally *tally)
{
	const uint64_t ready = tally->done + tally->failed;
	const double fraction = tally->total > 0 ? (double)ready / (double)tally->total : 1;
	RB_ASSERT(tally->done + tally->failed <= tally->total || tally->total == 0);
	char text[160], left[32], bar[BAR_MOST + 4] = "";
	int used = snprintf(text, sizeof text,
	                    "%" PRIu64 " of %" PRIu64 " done, %" PRIu64 " running", tally->done,
	                    tally->total, tally->running + tally->elsewhere);

	RB_ASSERT(width > 0 && size > 0);
	if (tally->failed > 0)
		used += snprintf(text + used, sizeof text - (size_t)used, ", %" PRIu64 " failed",
		                 tally->failed);
	if (tally->signal != 0) {
		used += snprintf(text + used, sizeof text - (size_t)used, ", stopping");
	} else if (tally->ended > 0) {
		const double each_s = tally->wall_s / (double)tally->ended;
		rb_progress_duration(left, sizeof left,
		                     each_s * (double)(tally->due + tally->running));
		used += snprintf(text + used, sizeof text - (size_t)used, ", %s left", left);
	}
	int columns = width - used - 3;
	if (columns > BAR_MOST)
		columns = BAR_MOST;
	if (columns >= BAR_LEAST) {
		const int filled = (int)(fraction * columns);
		bar[0] = '[';
		memset(bar + 1, '=', (size_t)filled);
		memset(bar + 1 + filled, ' ', (size_t)(columns - filled));
		strcpy(bar + 1 + columns, "] ");
	}
	snprintf(line, size, "%s%.*s", bar, width, text);
}

/* Clears the line, so that another one can be printed. */
static void hide(struct rb_overview *overview)
{
	if (overview->shown)
		fputs("\r\033[K", stderr);
	overview->shown = false;
}

void rb_overview_tick(void *user, const struct rb_jobs_tally *tally)
{
	struct rb_overview *const overview = user;
	char line[256];
	int width = 79;
	struct winsize window;

	if (overview->redraw && ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
		width = window.ws_col - 1;
	rb_overview_line(line, sizeof line, width, tally);
	if (overview->redraw)
		rb_print(stderr, "\r\033[K%s", line);
	else
		rb_print(stderr, "rbsim: %s\n", line);
	fflush(stderr);
	overview->shown = overview->redraw;
}

void rb_overview_told(void *user, uint64_t index, const struct rb_point *point)
{
	struct rb_overview *const overview = user;
	char label[160], log[RB_FOLDER_PATH_SIZE];

	if (point->state != RB_POINT_FAILED || overview->quiet)
		return;
	hide(overview);
	if (++overview->failures <= FAILURES_TOLD)
		rb_print(stderr,
		         "rbsim: point %" PRIu64 " (%s) failed, exit status %d: %s; see '%s'\n",
		         index, rb_plan_label(overview->plan, index, label, sizeof label),
		         point->exit_code, *point->reason ? point->reason : "it gave no reason",
		         rb_folder_path(overview->plan, overview->folder, index, ".log", log));
	else if (overview->failures == FAILURES_TOLD + 1)
		rb_print(stderr,
		         "rbsim: more points failed: 'rbsim sweep %s --status' lists them all\n",
		         overview->folder);
}

void rb_overview_end(struct rb_overview *overview, const struct rb_jobs_tally *tally, int jobs)
{
	const uint64_t left = tally->total - tally->done - tally->failed;
	char wall[32];

	if (overview->quiet)
		return;
	hide(overview);
	rb_progress_duration(wall, sizeof wall, tally->wall_s);
	rb_print(stderr, "rbsim: %s: %" PRIu64 " of %" PRIu64 " %s done", overview->folder,
	         tally->done, tally->total, rb_text_plural(tally->total, "point", "points"));
	if (tally->failed > 0)
		rb_print(stderr, ", %" PRIu64 " failed", tally->failed);
	if (left > 0)
		rb_print(stderr, ", %" PRIu64 " left", left);
	if (tally->ended > 0)
		rb_print(stderr, "; %" PRIu64 " %s in %s, %.3g of %d %s busy", tally->ended,
		         rb_text_plural(tally->ended, "run", "runs"), wall,
		         tally->cpu_s / tally->wall_s, jobs,
		         rb_text_plural((uint64_t)jobs, "processor", "processors"));
	fputc('\n', stderr);
	if (tally->elsewhere > 0)
		rb_print(stderr, "rbsim: %" PRIu64 " of them are being run by another process\n",
		         tally->elsewhere);
	else if (left > 0)
		rb_print(stderr, "rbsim: 'rbsim sweep %s' goes on\n", overview->folder);
}
