/* SPDX-License-Identifier: MIT */
/*
 * Each panel reads the viewer and the source, and prints its lines; it keeps nothing. All rows of
 * an area are written at every drawing, also empty ones, because curses sends only what has changed
 * and nothing else clears what was there before.
 */
#include "control/panels.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "control/charts.h"
#include "control/keys.h"
#include "control/orders.h"

/* CHART_MAX, TIMELINE_MAX: columns; wider screens leave the rest empty. */
enum { LINE_SIZE = 512, CHART_MAX = 128, TIMELINE_MAX = 1024 };

/* ---- one line each ---- */

/* The speed as people say it: as a fraction where it is one of a whole number. */
static void print_speed(char out[48], const struct rb_viewer *viewer)
{
	const double slower = 1 / viewer->speed;

	if (viewer->live)
		snprintf(out, 48, "newest frames");
	else if (slower > 1 && fabs(slower - nearbyint(slower)) < 1e-9 * slower && slower < 1e6)
		snprintf(out, 48, "speed 1/%.0f", slower);
	else
		snprintf(out, 48, "speed %.4g", viewer->speed);
}

void rb_panel_transport(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const char *const late = viewer->starved ? "  cannot keep up" : "";
	const char *const stops = viewer->stops || status->stops_at_collision
	                                  ? "  stops at collisions"
	                                  : "";
	char first[LINE_SIZE], second[LINE_SIZE], speed[48];
	const uint64_t last = status->frame_count > 0 ? status->frame_count - 1 : 0;

	print_speed(speed, viewer);
	const struct rb_unit_def unit = viewer->camera.time_unit.name
	                                        ? viewer->camera.time_unit
	                                        : (struct rb_unit_def){"s", 1};
	snprintf(first, sizeof first, " %-11s t %.4f of %.6g %s  %s", rb_viewer_state(viewer),
	         viewer->frame.time_s / unit.size, status->duration_s / unit.size, unit.name,
	         speed);
	snprintf(second, sizeof second, " frame %" PRIu64 " of %" PRIu64 "%s%s  %s: %s",
	         viewer->frame.index, last, late, stops, viewer->options.name, status->state);
	if (area.height == 1) {
		snprintf(first + strlen(first), sizeof first - strlen(first), " %.200s", second);
		rb_screen_text(screen, area, 0, viewer->starved ? RB_STYLE_WARNING : RB_STYLE_BAR,
		               first);
		return;
	}
	rb_screen_text(screen, area, 0, RB_STYLE_BAR, first);
	rb_screen_text(screen, area, 1, viewer->starved ? RB_STYLE_WARNING : RB_STYLE_PLAIN,
	               second);
}

void rb_panel_timeline(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const double whole = status->duration_s > 0 ? status->duration_s : 1;
	const struct rb_timeline line = {
		.position = viewer->frame.time_s / whole,
		.available = status->end_s / whole,
		.marks = rb_source_bins(viewer->options.source)->collisions,
		.mark_count = RB_SOURCE_BINS,
	};
	uint32_t glyphs[TIMELINE_MAX];
	const int width = area.width < TIMELINE_MAX ? area.width : TIMELINE_MAX;

	rb_chart_timeline(glyphs, width, &line, rb_screen_blocks(screen));
	for (int i = 0; i < width; i++)
		rb_screen_glyph(screen, area.x + i, area.y, glyphs[i], RB_STYLE_PLAIN);
}

/* ---- beside the picture ---- */

/* A size in decimal units with three digits. */
static const char *print_bytes(uint64_t bytes, char out[32])
{
	static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB"};
	double value = (double)bytes;
	int unit = 0;

	while (value >= 999.5 && unit < 4) {
		value /= 1000;
		unit++;
	}
	snprintf(out, 32, "%.3g %s", value, units[unit]);
	return out;
}

void rb_panel_numbers(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const s = rb_source_status(viewer->options.source);
	char line[9][64], size[32];
	int rows = 0;

	snprintf(line[rows++], 64, "%s", s->is_run ? "run" : "recording");
	snprintf(line[rows], 64, "real time  -");
	if (s->real_time_factor > 0)
		snprintf(line[rows], 64, "real time  %.4g x", s->real_time_factor);
	rows++;
	snprintf(line[rows++], 64, "collisions %" PRIu64, s->collisions);
	snprintf(line[rows++], 64, "contacts   %" PRIu64, viewer->frame.numbers.contacts);
	snprintf(line[rows++], 64, "rollbacks  %" PRIu64, s->rollbacks);
	snprintf(line[rows], 64, "least step -");
	if (s->smallest_step_s > 0)
		snprintf(line[rows], 64, "least step %.3g s", s->smallest_step_s);
	rows++;
	snprintf(line[rows], 64, "buffer     -");
	if (s->ring_slots > 0)
		snprintf(line[rows], 64, "buffer     %d of %d frames", s->ring_used, s->ring_slots);
	rows++;
	snprintf(line[rows++], 64, "disk       %s",
	         s->bytes > 0 ? print_bytes(s->bytes, size) : "-");
	for (int i = 0; i < area.height; i++)
		rb_screen_text(screen, area, i, i == 0 ? RB_STYLE_STRONG : RB_STYLE_PLAIN,
		               i < rows ? line[i] : "");
}

/*
 * Values of a chart's columns from the source's bins, and `more` added (NULL: nothing): of those
 * that fall into one column the last one that is known, or the largest.
 */
static void gather(double *out, int width, const double *bins, const double *more, bool largest)
{
	RB_ASSERT(width > 0 && width <= CHART_MAX);
	for (int x = 0; x < width; x++) {
		double value = (double)NAN;
		const int from = x * RB_SOURCE_BINS / width;
		const int to = (x + 1) * RB_SOURCE_BINS / width;
		for (int i = from; i < to || i == from; i++) {
			const double bin = bins[i] + (more ? more[i] : 0);
			if (isfinite(bin))
				value = largest ? fmax(value, bin) : bin;
		}
		/* a run of few frames has bins between them */
		out[x] = isfinite(value) || x == 0 || largest ? value : out[x - 1];
	}
}

/* Blanks the columns of what has not been simulated yet. */
static void leave_open(double *values, int width, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const double share = status->duration_s > 0 ? status->end_s / status->duration_s : 1;

	for (int x = (int)fmin(floor(share * width), width - 1) + 1; x < width; x++)
		values[x] = (double)NAN;
}

/*
 * Draws a chart in row `row` of the area: name, curve from 0 (or the least value below it) to the
 * largest, and the largest as text. Nothing where it does not fit.
 */
static void chart(struct rb_screen *screen, rb_area area, int row, const char *name,
                  const double *values)
{
	enum { NAME = 10, NUMBER = 9 };
	const int width = area.width - NAME - NUMBER;
	uint32_t glyphs[CHART_MAX];
	double low, high;
	char text[64];

	if (row >= area.height || width < 4)
		return;
	rb_chart_range(values, width, &low, &high);
	rb_chart_spark(glyphs, values, width, fmin(low, 0), high, rb_screen_blocks(screen));
	rb_screen_text(screen, (rb_area){area.x, area.y + row, NAME, 1}, 0, RB_STYLE_PLAIN, name);
	for (int i = 0; i < width; i++)
		rb_screen_glyph(screen, area.x + NAME + i, area.y + row, glyphs[i], RB_STYLE_PLAIN);
	snprintf(text, sizeof text, " %.3g", high);
	rb_screen_text(screen, (rb_area){area.x + NAME + width, area.y + row, NUMBER, 1}, 0,
	               RB_STYLE_FAINT, text);
}

void rb_panel_charts(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_bins *const bins = rb_source_bins(viewer->options.source);
	const int width = area.width - 19 < CHART_MAX ? area.width - 19 : CHART_MAX;
	double values[CHART_MAX];

	if (width < 4)
		return;
	rb_screen_text(screen, area, 0, RB_STYLE_STRONG, "energy (J), overlap (m)");
	gather(values, width, bins->kinetic, NULL, false);
	leave_open(values, width, viewer);
	chart(screen, area, 1, "kinetic", values);
	gather(values, width, bins->kinetic, bins->potential, false);
	leave_open(values, width, viewer);
	chart(screen, area, 2, "total", values);
	gather(values, width, bins->penetration, NULL, true);
	chart(screen, area, 3, "overlap", values);
	rb_screen_text(screen, area, 4, RB_STYLE_PLAIN, "");
}

void rb_panel_body(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	char line[96];
	int row = 0;

	if (viewer->inspected < 0)
		rb_screen_text(screen, area, row++, RB_STYLE_FAINT, "/ looks for a body");
	for (; viewer->inspected >= 0 && row < area.height &&
	       rb_order_body_line(viewer, viewer->inspected, row, line);
	     row++)
		rb_screen_text(screen, area, row, row == 0 ? RB_STYLE_STRONG : RB_STYLE_PLAIN,
		               line);
	for (; row < area.height; row++)
		rb_screen_text(screen, area, row, RB_STYLE_PLAIN, "");
}

/* ---- log and help ---- */

/* The byte behind `count` characters of UTF-8, or the end. */
static const char *behind(const char *text, int count)
{
	while (*text && count > 0) {
		do
			text++;
		while (((unsigned char)*text & 0xc0) == 0x80);
		count--;
	}
	return text;
}

/*
 * Where the next row of a line goes on: behind the last word that fits; within it where it is
 * longer than a row. Spaces at the beginning of a line stay with what follows.
 */
static const char *next_row(const char *text, int width)
{
	const char *const end = behind(text, width);
	const char *const word = text + strspn(text, " ");
	const char *at = end;

	if (*end == ' ' || !*end)
		return end + strspn(end, " ");
	while (at > word && at[-1] != ' ')
		at--;
	return at > word ? at : end;
}

/*
 * The newest lines, from the bottom up; long ones go on in the next row, where there is more than
 * one.
 */
void rb_panel_log(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	int bottom = area.height;

	for (uint64_t back = 1; bottom > 0; back++) {
		const bool there = back <= viewer->log_count && back <= RB_VIEWER_LOG_LINES;
		const char *text =
			there ? viewer->log[(viewer->log_count - back) % RB_VIEWER_LOG_LINES] : "";
		int rows = 1;
		for (const char *at = next_row(text, area.width); *at;
		     at = next_row(at, area.width))
			rows++;
		/* of one that is longer than all there is, the beginning */
		const int first = rows < bottom ? bottom - rows : 0;
		for (int k = bottom; back > 1 && k < rows; k++)
			text = next_row(text, area.width);
		for (int row = first; row < bottom; row++) {
			const char *const next = next_row(text, area.width);
			char shown[RB_VIEWER_LOG_SIZE];
			snprintf(shown, sizeof shown, "%.*s", (int)(next - text), text);
			rb_screen_text(screen, area, row,
			               back == 1 ? RB_STYLE_PLAIN : RB_STYLE_FAINT, shown);
			text = next;
		}
		bottom = first;
	}
}

/* Rows of the help, counted, and shown where there is a screen. */
struct help {
	struct rb_screen *screen;
	rb_area area;
	int first, row;
};

/* One row of the help: counted, and drawn if it is on the page. */
static void help_row(struct help *help, enum rb_style style, const char *text)
{
	const int row = help->row++ - help->first;

	if (help->screen && row >= 0 && row < help->area.height)
		rb_screen_text(help->screen, help->area, row, style, text);
}

/*
 * Rows for a text, broken at spaces to fit, behind `indent` columns of which the first hold `lead`;
 * where `lead` is longer, it has a row of its own.
 */
static void help_entry(struct help *help, const char *lead, int indent, const char *text)
{
	const int room = help->area.width - indent > 10 ? help->area.width - indent : 10;
	char line[LINE_SIZE];

	RB_ASSERT(indent > 0);
	if ((int)strlen(lead) >= indent) {
		help_row(help, RB_STYLE_PLAIN, lead);
		lead = "";
	}
	while (*text) {
		int size = (int)strlen(text);
		if (size > room) {
			size = room;
			while (size > 0 && text[size] != ' ')
				size--;
			size = size > 0 ? size : room;
		}
		snprintf(line, sizeof line, "%-*s%.*s", indent, lead, size, text);
		help_row(help, RB_STYLE_PLAIN, line);
		lead = "";
		text += size;
		text += strspn(text, " ");
	}
}

/* All rows of the help, from the tables of keys and commands. */
static void help_rows(struct help *help)
{
	enum { KEYS = 14, COMMANDS = 31, NARROW = 6, WIDE = 80 };
	const int indent = help->area.width >= WIDE ? COMMANDS : NARROW;
	char lead[LINE_SIZE];

	help_row(help, RB_STYLE_STRONG, "Keys (up, down: more; ?: back)");
	for (int i = 0; i < rb_key_row_count; i++) {
		snprintf(lead, sizeof lead, "  %s", rb_key_rows[i].name);
		help_entry(help, lead, KEYS, rb_key_rows[i].help);
	}
	help_row(help, RB_STYLE_PLAIN, "");
	help_row(help, RB_STYLE_STRONG, "Commands, behind :");
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		snprintf(lead, sizeof lead, "  %s %s", rb_commands[i].name,
		         rb_commands[i].arguments);
		help_entry(help, lead, indent, rb_commands[i].help);
	}
}

void rb_panel_help(struct rb_screen *screen, rb_area area, int *first)
{
	struct help help = {.area = area};

	/* twice: once to count, so that `first` can be put right, once to draw */
	help_rows(&help);
	const int last = help.row > area.height ? help.row - area.height : 0;
	*first = *first < 0 ? 0 : *first > last ? last : *first;
	help = (struct help){.screen = screen, .area = area, .first = *first};
	help_rows(&help);
	while (help.row < *first + area.height)
		help_row(&help, RB_STYLE_PLAIN, "");
}
